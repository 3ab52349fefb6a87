/* The Markdown files: lines that fit a terminal, READMEs that are read to their end, links and names of files that
 * exist. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* nftw's actions, asprintf */
#include "tests/test_main.h"

#include <ctype.h>
#include <ftw.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { COLUMNS_MAX = 120, README_LINES_MAX = 120 };

/* ---- the files of the source tree: names from its root, folders end with a slash ---- */

static char **files;
static size_t nfile;

static int visit(const char *path, const struct stat *status, int type, struct FTW *where) {
  (void)status;
  const char *name = path + where->base;
  if (where->level > 0 && type == FTW_D && (strncmp(name, "build", 5) == 0 || strcmp(name, ".git") == 0))
    return FTW_SKIP_SUBTREE;
  if (where->level == 0)
    return FTW_CONTINUE;
  char **grown = realloc(files, (nfile + 1) * sizeof *files);
  ck_assert_ptr_nonnull(grown);
  files = grown;
  ck_assert_int_gt(asprintf(&files[nfile++], "%s%s", path + strlen(TANDEM_SOURCE_DIR), type == FTW_D ? "/" : ""), 0);
  return FTW_CONTINUE;
}

static void list_files(void) {
  ck_assert_int_eq(nftw(TANDEM_SOURCE_DIR, visit, 16, FTW_PHYS | FTW_ACTIONRETVAL), 0);
  ck_assert_uint_gt(nfile, 100);
}

static bool ends_with(const char *text, const char *end) {
  size_t n = strlen(text), m = strlen(end);
  return n >= m && strcmp(text + n - m, end) == 0;
}

/* ---- what is wrong, of all files at once ---- */

static int nfault;

__attribute__((format(printf, 3, 4))) static void fault(const char *file, int line, const char *format, ...) {
  va_list args;
  va_start(args, format);
  fprintf(stderr, "%s:%d: ", file + 1, line);
  vfprintf(stderr, format, args);
  fputc('\n', stderr);
  va_end(args);
  nfault++;
}

/* ---- every line of every Markdown file ---- */

typedef void look_at_line(const char *file, int number, char *line);

/* Calls look for each line (without its end) of the Markdown files; returns the number of lines of the last one. */
static void each_line(look_at_line *look, bool code_too) {
  for (size_t i = 0; i < nfile; i++) {
    if (!ends_with(files[i], ".md"))
      continue;
    char path[4096], *line = NULL;
    snprintf(path, sizeof path, "%s%s", TANDEM_SOURCE_DIR, files[i]);
    FILE *f = fopen(path, "r");
    ck_assert_ptr_nonnull(f);
    size_t room = 0;
    bool fence = false;
    for (int number = 1; getline(&line, &room, f) >= 0; number++) {
      line[strcspn(line, "\n")] = '\0';
      if (strncmp(line, "```", 3) == 0)
        fence = !fence;
      if (code_too || (!fence && strncmp(line, "    ", 4) != 0))
        look(files[i], number, line);
    }
    free(line);
    fclose(f);
  }
}

/* columns of UTF-8 text; combining marks (U+0300 to U+036F) take none */
static int columns(const char *text) {
  int n = 0;
  for (const unsigned char *c = (const unsigned char *)text; *c; c++)
    if ((*c & 0xC0) != 0x80 && *c != 0xCC && !(*c == 0xCD && c[1] < 0xB0))
      n++;
  return n;
}

static void fits(const char *file, int number, char *line) {
  if (columns(line) > COLUMNS_MAX)
    fault(file, number, "%d columns, more than %d", columns(line), COLUMNS_MAX);
  if (ends_with(file, "/README.md") && number == README_LINES_MAX + 1)
    fault(file, number, "a README has at most %d lines; move the rest to docs/", README_LINES_MAX);
}

START_TEST(lines_and_readmes_are_short) {
  list_files();
  each_line(fits, true);
  ck_assert_int_eq(nfault, 0);
}
END_TEST

/* ---- links ---- */

/* GitHub's anchor of a heading: lower case, blanks as hyphens, other punctuation left out. */
static void anchor_of(char *out, const char *heading) {
  for (const char *c = heading; *c; c++)
    if (isalnum((unsigned char)*c) || *c == '-' || *c == '_' || (*c & 0x80))
      *out++ = (char)tolower((unsigned char)*c);
    else if (*c == ' ')
      *out++ = '-';
  *out = '\0';
}

static bool has_anchor(const char *path, const char *anchor) {
  FILE *f = fopen(path, "r");
  char line[1024], slug[1024];
  bool found = false;
  while (f && !found && fgets(line, sizeof line, f)) {
    line[strcspn(line, "\n")] = '\0';
    size_t depth = strspn(line, "#");
    if (depth > 0 && line[depth] == ' ') {
      anchor_of(slug, line + depth + 1);
      found = strcmp(slug, anchor) == 0;
    }
  }
  if (f)
    fclose(f);
  return found;
}

static void follow(const char *file, int number, const char *target) {
  char name[1024], path[4096];
  snprintf(name, sizeof name, "%s", target);
  char *anchor = strchr(name, '#');
  if (anchor)
    *anchor++ = '\0';
  if (name[0])
    snprintf(path, sizeof path, "%s%.*s/%s", TANDEM_SOURCE_DIR, (int)(strrchr(file, '/') - file), file, name);
  else
    snprintf(path, sizeof path, "%s%s", TANDEM_SOURCE_DIR, file);
  struct stat there;
  if (stat(path, &there))
    fault(file, number, "link to \"%s\": there is no such file", target);
  else if (anchor && !has_anchor(path, anchor))
    fault(file, number, "link to \"%s\": there is no such heading", target);
}

static void follow_links(const char *file, int number, char *line) {
  for (char *link = strstr(line, "]("); link; link = strstr(link, "](")) {
    link += 2;
    char target[1024];
    snprintf(target, sizeof target, "%.*s", (int)strcspn(link, ")"), link);
    if (!strstr(target, "://"))
      follow(file, number, target);
  }
}

START_TEST(links_lead_somewhere) {
  list_files();
  each_line(follow_links, false);
  ck_assert_int_eq(nfault, 0);
}
END_TEST

/* ---- names of files in backquotes ---- */

/* true when a file or folder of the tree has that name, or a path that ends so */
static bool is_there(const char *name) {
  char end[1024];
  snprintf(end, sizeof end, "/%s", name);
  for (size_t i = 0; i < nfile; i++)
    if (ends_with(files[i], end))
      return true;
  return false;
}

/* Is a word in backquotes the name of a source file or of a folder? Results of runs, placeholders (in capitals) and
 * what is built are not. */
static bool names_source(const char *word) {
  if (word[strspn(word, "abcdefghijklmnopqrstuvwxyz0123456789_/.-[]")] || word[0] == '/' || word[0] == '-')
    return false;
  static const char *const ends[] = {".c", ".h", ".[ch]"};
  for (size_t i = 0; i < sizeof ends / sizeof *ends; i++)
    if (ends_with(word, ends[i]) && word[0] != '.')
      return true;
  const char *slash = strchr(word, '/');
  static const char *const more[] = {".md", ".json", ".csv", ".sh", ".svg"};
  for (size_t i = 0; slash && i < sizeof more / sizeof *more; i++)
    if (ends_with(word, more[i]))
      return true;
  return ends_with(word, "/") && strlen(word) > 1;
}

static void look_up(const char *file, int number, char *word) {
  if (!names_source(word))
    return;
  char *both = strstr(word, ".[ch]");
  bool good;
  if (both) {
    strcpy(both, ".c");
    good = is_there(word);
    strcpy(both, ".h");
    good = good && is_there(word);
  } else
    good = is_there(word) || (strncmp(word, "../", 3) == 0 && is_there(word + 3));
  if (!good)
    fault(file, number, "`%s`: there is no such file", word);
}

static void look_up_names(const char *file, int number, char *line) {
  if (ends_with(file, "/CHANGELOG.md"))
    return; /* tells of files as they were */
  for (char *c = strchr(line, '`'); c; c = strchr(c + 1, '`')) {
    char *word = ++c;
    c = strchr(word, '`');
    if (!c)
      return;
    *c = '\0';
    look_up(file, number, word);
  }
}

START_TEST(named_files_are_there) {
  list_files();
  each_line(look_up_names, false);
  ck_assert_int_eq(nfault, 0);
}
END_TEST

TEST_MAIN("prose", lines_and_readmes_are_short, links_lead_somewhere, named_files_are_there)
