var indexSectionsWithContent =
{
  0: "cr",
  1: "cr"
};

var indexSectionNames =
{
  0: "all",
  1: "pages"
};

var indexSectionLabels =
{
  0: "All",
  1: "Pages"
};

