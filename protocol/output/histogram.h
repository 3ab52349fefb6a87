/* How the normal forces of the contacts are distributed: the probability density of f/<f>, the forces of the contacts
 * that repel over their mean, at each frame that has contacts.
 *
 *   contact_forces.csv  a row a bin: time, mean [N], number of contacts, f/<f> in the middle of the bin, density; times
 *                       without contacts are left out
 *   contact_forces.png  the first and the last of these, and those between, if there is gnuplot
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_OUTPUT_HISTOGRAM_H
#define TDM_OUTPUT_HISTOGRAM_H

#include "protocol/results/results.h"
#include "protocol/view/view.h"

enum { TDM_FORCE_BINS = 40 };

/* Of one instant: bin k holds f/<f> from k to k + 1 widths; what lies beyond the last is counted in `n` alone. */
typedef struct {
  double width;                   /* of a bin, in <f> */
  long n;                         /* contacts that repel */
  double mean;                    /* <f> [N] */
  double density[TDM_FORCE_BINS]; /* the integral over all of f/<f> is 1 */
} tdm_force_bins;

tdm_force_bins tdm_force_bins_of(const tdm_snapshot *snapshot);

/* Zero-initialise; freed with tdm_force_histogram_close. */
typedef struct {
  const tdm_results *results; /* borrowed */
  FILE *file;
  int ntime, capacity;
  double *time; /* (ntime) of the frames that have contacts [s] */
} tdm_force_histogram;

tdm_status tdm_force_histogram_open(tdm_force_histogram *histogram, const tdm_results *results, tdm_error *err);
tdm_status tdm_force_histogram_add(tdm_force_histogram *histogram, const tdm_snapshot *snapshot, tdm_error *err);

/* Make the plot; that there is no gnuplot is no error. Does nothing the second time, or when nothing was added. */
void tdm_force_histogram_finish(tdm_force_histogram *histogram);
void tdm_force_histogram_close(tdm_force_histogram *histogram);

#endif
