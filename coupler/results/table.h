/* Time histories read back, and how well two of them agree. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_RESULTS_TABLE_H
#define CPL_RESULTS_TABLE_H

#include "protocol/base/status.h"

/* A CSV file with one header line; columns are kept one after the other. A last row without its line break is left out.
 */
typedef struct {
  int ncolumn, nrow;
  char **name;  /* (ncolumn) without the unit: "x" of "x [m]" */
  double *data; /* (ncolumn x nrow) */
} cpl_table;

tdm_status cpl_table_read(cpl_table *table, const char *file, tdm_error *err);
/* The same of a file that people made: it has `ncolumn` columns and as many numbers in each row; a last row counts
 * without its line break, empty lines do not. */
tdm_status cpl_table_read_given(cpl_table *table, const char *file, int ncolumn, tdm_error *err);
void cpl_table_free(cpl_table *table);

/* (nrow) numbers of a column; NULL, and an error that names the nearest column, when there is none. */
const double *cpl_table_column(const cpl_table *table, const char *name, tdm_error *err);

/* 1 - SSE/SST of a simulation against a reference (Nash-Sutcliffe efficiency): 1 is perfect agreement. NaN when a
 * number is not finite. */
double cpl_nse(const double *simulation, const double *reference, int n);

/* The squared correlation, the paper's R^2: blind to offset and scale. */
double cpl_r2(const double *simulation, const double *reference, int n);

#endif
