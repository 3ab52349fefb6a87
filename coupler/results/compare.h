/* A run against its reference: curves of both on the output grid, how well they agree, files and plots of them.
 *
 * A scenario fills a cpl_comparison from a result directory; verify, report and sweep take their numbers from it.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_RESULTS_COMPARE_H
#define CPL_RESULTS_COMPARE_H

#include "protocol/base/status.h"

#include <jansson.h>
#include <stdbool.h>

enum { CPL_CURVES_MAX = 8 };

typedef enum {
  CPL_STATE, /* a state: nse and r2 */
  CPL_LOAD   /* a load, noisy by nature: r2 as it is, and of means over 20 ms */
} cpl_curve_kind;

typedef struct {
  char name[24];  /* "x": the measures are nse_x, r2_x */
  char unit[16];  /* "m" */
  char title[96]; /* "position of the box, downward from the start" */
  cpl_curve_kind kind;
  double *simulation, *reference; /* (nrow) */
} cpl_compared;

typedef struct {
  int nrow;        /* of the output grid */
  int first;       /* first row that counts: what comes before is shown, not measured */
  double interval; /* of the grid [s] */
  double *time;    /* (nrow) [s] */
  int ncurve;
  cpl_compared curve[CPL_CURVES_MAX];
  json_t *notes; /* object of further figures (mass, inertia ...), may be NULL */
} cpl_comparison;

/* Room for nrow rows; the times are copied. */
tdm_status cpl_comparison_init(cpl_comparison *c, int nrow, const double *time, tdm_error *err);
void cpl_comparison_free(cpl_comparison *c);

/* Add a curve with zeroed arrays; NULL when memory ran out. */
cpl_compared *cpl_comparison_add(cpl_comparison *c, const char *name, const char *unit, cpl_curve_kind kind,
                                 const char *title, tdm_error *err);

/* Agreement of a curve over the rows that count. */
double cpl_comparison_nse(const cpl_comparison *c, const cpl_compared *curve);
double cpl_comparison_r2(const cpl_comparison *c, const cpl_compared *curve);
/* r2 of means over `span` seconds (whole numbers of rows, at least one). */
double cpl_comparison_r2_mean(const cpl_comparison *c, const cpl_compared *curve, double span);

/* dir/comparison.csv, and comparison.png beside it (a missing gnuplot is an error that may be a notice). */
tdm_status cpl_comparison_write(const cpl_comparison *c, const char *dir, tdm_error *err);
tdm_status cpl_comparison_plot(const cpl_comparison *c, const char *dir, tdm_error *err);

#endif
