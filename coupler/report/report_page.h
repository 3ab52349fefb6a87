/* The page of a report: what it shows, and the parts of index.html in their order. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_REPORT_REPORT_PAGE_H
#define CPL_REPORT_REPORT_PAGE_H

#include "coupler/contents/contents.h"
#include "coupler/contents/pictures.h"
#include "coupler/results/compare.h"

enum { CPL_REPORT_LACKS = 16 };

typedef struct {
  const char *dir;
  json_t *scene, *summary; /* NULL: not there, or not readable; the scene as it ran */
  json_t *written;         /* the scene with its expressions; NULL: as above */
  cpl_contents contents;
  cpl_pictures pictures;
  cpl_comparison comparison;
  bool compared, comparison_drawn;
  int nlack;
  char lack[CPL_REPORT_LACKS][1024]; /* (nlack) what the report is without, and why */
} cpl_report_data;

/* The run came to its end without an error. */
bool cpl_report_good(const cpl_report_data *r);

/* A warning or notice of summary.json in words, into out (size bytes). Returns out. */
const char *cpl_report_remark(const json_t *entry, char *out, size_t size);

/* Write all of the page. */
void cpl_report_page(FILE *page, const cpl_report_data *r);

/* ---- report_files.c: the directory's files ---- */

/* Whether the directory has a file of this name. */
bool cpl_report_has(const char *dir, const char *name);

/* The pictures, movie and viewer page of the run, where there are some. */
void cpl_report_shots(FILE *page, const char *dir);

/* The last lines of the logs, for a run that failed. */
void cpl_report_logs(FILE *page, const char *dir);

/* A table of all files; many of a kind are one row. */
void cpl_report_files(FILE *page, const char *dir);

#endif
