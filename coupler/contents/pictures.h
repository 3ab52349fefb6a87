/* Pictures of time histories for a report: the panels of a section, at most eight a picture. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_CONTENTS_PICTURES_H
#define CPL_CONTENTS_PICTURES_H

#include "coupler/contents/contents.h"

enum { CPL_PICTURE_PANELS = 8 };

typedef struct {
  int section;
  char name[160]; /* of its file in the directory, without .png */
  bool there;     /* the file was made */
} cpl_picture;

typedef struct {
  int n;
  cpl_picture *picture; /* (n) in the order of the sections */
} cpl_pictures;

/* Plot all that varies, by one gnuplot. After an error (no gnuplot, interrupted) some pictures, or none, are there.
 * cpl_pictures_free afterwards in any case. */
tdm_status cpl_pictures_make(cpl_pictures *p, const char *dir, const cpl_contents *c, tdm_error *err);
void cpl_pictures_free(cpl_pictures *p);

#endif
