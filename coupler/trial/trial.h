/* A trial: a short run of a scene with settings of its own, for what it costs and how good it is, and how far two of
 * them are apart. For those that choose settings, or repeat a part of a run.
 *
 *   cpl_trial t;
 *   cpl_trial_run(&options, &t, &err);          a run that ends badly is a result: t.status, t.reason
 *   cost:  t.run.setup + time.end * t.run.loop / t.run.simulated       [s], of a whole run to time.end
 *   error: t.run.error, t.run.error_coupling     beside the spread of the motion; the second without the particles'
 *                                                rattle, which no setting of the exchange changes; NaN: unknown
 *   cpl_trial_free(&t);
 *
 * Trials of a scene begin from one settled bed, a file: the first one to settle writes it, the others read it. So they
 * differ by their settings alone.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_TRIAL_TRIAL_H
#define CPL_TRIAL_TRIAL_H

#include "coupler/results/table.h"
#include "coupler/run/run.h"

typedef struct {
  const char *scene;      /* file */
  const char *const *set; /* NULL-terminated "path=value", may be NULL */
  const char *dir;        /* result directory of the trial; what an earlier trial left there is replaced */
  const char *bed;        /* file of the settled bed, in a folder that is there; NULL: it settles for itself */
  double end;             /* how long to simulate [s]; a whole number of windows is not needed */
  cpl_solver solver[CPL_NROLE];
} cpl_trial_options;

typedef struct {
  tdm_status status; /* of the run: TDM_OK, TDM_ERR_NUMERIC where it blew up or gained energy ... */
  char reason[TDM_MESSAGE_MAX];
  cpl_run_result run; /* what it cost, as far as it came; with the error that it estimates (run.error) */
  json_t *summary;    /* its summary.json, NULL: none */
} cpl_trial;

/* Run. An error only where no trial could be made (memory, a folder), or TDM_ERR_INTERRUPTED. */
tdm_status cpl_trial_run(const cpl_trial_options *options, cpl_trial *trial, tdm_error *err);
void cpl_trial_free(cpl_trial *trial);

/* How far two runs of a scene are apart, in the motion of one body. */
typedef struct {
  double rms[CPL_QUANTITIES];    /* of the difference over the rows that both have [m, m/s, rad, rad/s] */
  double spread[CPL_QUANTITIES]; /* standard deviation of the first one's over them */
  double late[CPL_QUANTITIES];   /* rms over the last quarter of them, beside that over the third: > 1 where it grows */
  int nrow;                      /* rows compared, less than 2: nothing is */
} cpl_apart_runs;

/* Of mbd's body `body`, from two result directories, until `end` [s]. */
tdm_status cpl_trial_compare(const char *dir, const char *other, const char *body, double end, cpl_apart_runs *apart,
                             tdm_error *err);

#endif
