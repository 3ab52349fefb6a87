/* Rows of a sweep, and cells against each other. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_SWEEP_SWEEP_ROWS_H
#define CPL_SWEEP_SWEEP_ROWS_H

#include "coupler/cells/cells.h"

enum { CPL_SCHEMES_MAX = 8 };

extern const double cpl_good_nse; /* of the cells among which the cheapest is named */

/* A row's text, "" when it has none; its number (group NULL: in the row itself), NaN when it has none. */
const char *cpl_row_text(const json_t *row, const char *key);
double cpl_row_number(const json_t *row, const char *group, const char *key);

/* The names of the numbers that rows have: from any row, they are the same in all. */
typedef struct {
  const char *name[8]; /* of r2: states, load, load_20ms */
  int nname;
  const char *state[4]; /* of nse */
  int nstate;
} cpl_columns;

cpl_columns cpl_columns_find(const cpl_cell *cell, int ncell);

/* The largest 1 - nse of a row's states; NaN without numbers. */
double cpl_row_error(const json_t *row, const cpl_columns *c);

/* The cell of least wall time among those whose states all have an nse of at least cpl_good_nse; -1: none. */
int cpl_cheapest(const cpl_cell *cell, int ncell, const cpl_columns *c);

/* No other cell is both cheaper and better. */
bool cpl_on_front(const cpl_cell *cell, int ncell, int k, const cpl_columns *c);

/* Schemes of the rows that have a number, without repeats, in order of appearance; returns how many. */
int cpl_distinct_schemes(const cpl_cell *cell, int ncell, const char *group, const char *key, const char **out);

/* The price of a window of a scheme [s]: median of its cells. */
double cpl_price(const cpl_cell *cell, int ncell, const char *scheme);

#endif
