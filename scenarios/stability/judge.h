/* What became of a run, by its result directory: how far off it is, and whether it said so. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_STABILITY_JUDGE_H
#define SCN_STABILITY_JUDGE_H

#include "coupler/cells/cells.h"
#include "scenarios/stability/family.h"

/* What a run may come to, the best first. Limits: judge.c. */
typedef enum {
  SCN_OK,      /* at its end, accurate, without a warning */
  SCN_WARNED,  /* accurate, with a warning */
  SCN_INEXACT, /* not accurate, with a warning */
  SCN_STOPPED, /* the guard or a solver has ended it, with a reason */
  SCN_REFUSED, /* it cannot be run so, with a reason */
  SCN_SILENT,  /* not accurate, without a word */
  SCN_BROKEN,  /* a crash, a hang, a partner that was lost */
  SCN_OUTCOMES
} scn_outcome;

extern const char scn_auto[]; /* the column of runs whose windows choose their length */

extern const char *const scn_outcome_name[SCN_OUTCOMES];

/* The outcome of a row, by its name. */
scn_outcome scn_row_outcome(const json_t *row);

/* Runs with windows of one step that a case is compared with. */
enum {
  SCN_REFERENCE,
  SCN_TWIN,      /* the reference but for round-off */
  SCN_NEIGHBOUR, /* its start is off by so much that what grows is seen */
  SCN_TRIO
};

extern const double scn_nudge[SCN_TRIO]; /* relative, of the start */

/* The row of a cell (new reference): {"case", "scheme", "outcome", "error", "ceiling", "growth", "chaotic", "beyond",
 * "coarse", "estimate", "residual_share", "energy_residual", "ratio", "H", "said", "wall_s"}, null for numbers that
 * there are none of.
 *
 * error: rms of the difference from the reference, at the ends of the run's windows, over the reference's spread (or
 * the floor, when that is larger); of scn_auto, whose windows end anywhere, of means over the longest window; where the
 * motion is chaotic, the larger difference of mean and rms instead (of scn_auto over all rows). ceiling: the same of
 * the twin. estimate: what the run itself says of its error. growth: how much the neighbour's difference has grown.
 * beyond, coarse: the scene's parameters of these names (README.md). */
json_t *scn_judge(const scn_family *f, const scn_stability_case *c, const char *scheme, const cpl_cell *cell,
                  const cpl_cell trio[SCN_TRIO]);

#endif
