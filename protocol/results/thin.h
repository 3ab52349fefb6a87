/* Time histories thinned for plots: a bounded number of rows that look like all of them.
 *
 * Rows are gathered in bins of 1, 2, 4 ... rows; a bin keeps the least and the greatest value of each column in the
 * order in which they came, so that peaks and fast oscillations stay where a picture has no more pixels than bins.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_RESULTS_THIN_H
#define TDM_RESULTS_THIN_H

#include <stdbool.h>
#include <stdint.h>

enum { TDM_THIN_BINS = 900 }; /* about a plot's width in pixels */

typedef struct {
  int ncolumn;
  uint64_t per_bin; /* rows */
  int nbin;         /* full ones, and one that is being filled if filled > 0 */
  uint64_t filled;
  double *time; /* (2 x bins) of a bin's first and last row */
  double *low, *high;
  bool *falls; /* (bins x ncolumn) the greatest value came first */
} tdm_thin;

/* false: out of memory. tdm_thin_free afterwards in any case. */
bool tdm_thin_begin(tdm_thin *thin, int ncolumn);
void tdm_thin_add(tdm_thin *thin, double t, const double *values);

/* Rows that are kept (at most 4 TDM_THIN_BINS), and row i: its time, and column c. One a row as long as none is left
 * out. Values that are not finite count only where a bin has no other. */
int tdm_thin_rows(const tdm_thin *thin);
double tdm_thin_time(const tdm_thin *thin, int i);
double tdm_thin_value(const tdm_thin *thin, int i, int c);

/* The rows that are kept, each with its time and the values of the columns `column` (n), row-major; for the caller to
 * free. NULL: out of memory, or no column has a finite number (gnuplot refuses a panel without one). */
double *tdm_thin_table(const tdm_thin *thin, const int *column, int n);

void tdm_thin_free(tdm_thin *thin);

#endif
