/* Text files of rows: fields between blanks, an error by file and line.
 *
 *   dem_text t;
 *   dem_text_open(&t, file, path, err);
 *   while (dem_text_row(&t))
 *     x = dem_text_number(&t, 0, "x");
 *   dem_text_close(&t);
 *
 * Empty rows, and what follows a # in a row, are left out. The first error sticks, and ends the rows.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_MOLDYN_TEXT_H
#define DEM_MOLDYN_TEXT_H

#include "protocol/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { DEM_FIELDS_MAX = 24 };

typedef struct {
  const char *file, *path; /* borrowed: name; JSON path for errors, may be NULL */
  tdm_error *err;          /* borrowed */
  FILE *stream;
  char *text; /* of the row */
  size_t size;
  long line;                   /* of the row, from 1 */
  int nfield;                  /* more than DEM_FIELDS_MAX are counted only */
  char *field[DEM_FIELDS_MAX]; /* (nfield) */
} dem_text;

tdm_status dem_text_open(dem_text *text, const char *file, const char *path, tdm_error *err);

/* The next row. False: there is none, or there was an error. */
bool dem_text_row(dem_text *text);

/* Fail at a line: FILE:LINE: and the message. */
tdm_status dem_text_fail(dem_text *text, long line, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Field k of the row as a finite number; 0 after an error. `what` it is, for the message. */
double dem_text_number(dem_text *text, int k, const char *what);

void dem_text_close(dem_text *text);

#endif
