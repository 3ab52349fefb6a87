/* The result directory of a run: time histories as CSV, the scene as it ran, summary.json, the logs.
 *
 *   body_<name>.csv  per coupled body (mbd's name): pose, twist, and the mean load since the row before
 *   mbd.csv, dem.csv further outputs that the solvers announce (joint reactions, energies, particle sums)
 *   ledger.csv       impulse, work, drift and energy (ledger.h)
 *   scene.json       the scene with all overrides
 *   summary.json     settings, versions, wall times, warnings, how the run ended
 *   server.log, mbd.log, dem.log
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_LOOP_RECORD_H
#define CPL_LOOP_RECORD_H

#include "coupler/session/session.h"
#include "protocol/app/results.h"

typedef struct cpl_record {
  tdm_results results;      /* the directory; its log is server.log */
  FILE **body;              /* (nbody) */
  FILE *channel[CPL_NROLE]; /* NULL when a solver has no channels */
  FILE *ledger;             /* its rows are the ledger's */
  int nbody, nchannel[CPL_NROLE];
  double last_flush;
} cpl_record;

/* Open the result directory: see tdm_results_open. */
tdm_status cpl_record_open(cpl_record *record, const tdm_results_def *def, tdm_error *err);

/* The name of the file of a coupled body, by mbd's name for it. Returns out. */
const char *cpl_record_body_file(const char *body, char *out, size_t size);

/* The run begins (tdm_results_start): open the time histories and write the row of t = 0. */
tdm_status cpl_record_begin(cpl_record *record, const cpl_session *session, tdm_error *err);

/* Rows for the output times of a window, (nsample) at row_time [s], from the results of both solvers. */
tdm_status cpl_record_samples(cpl_record *record, int nsample, const double *row_time, const tdm_result *result,
                              tdm_error *err);

/* Close the time histories. An error of the disk that came up late is reported here. */
tdm_status cpl_record_close(cpl_record *record, tdm_error *err);

#endif
