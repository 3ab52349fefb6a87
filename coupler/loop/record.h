/* The result directory of a run: time histories as CSV, the scene as it ran, summary.json, the logs. Its rows are
 * written by an observer (observer.h).
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
  tdm_results results; /* the directory; its log is server.log */
  FILE **file;         /* (nfile) all time histories, those of bodies first: flushed and closed together */
  int nfile, room;
  FILE *channel[CPL_NROLE]; /* NULL when a solver has no channels */
  int nbody, nchannel[CPL_NROLE];
  double last_flush;
} cpl_record;

/* Open the result directory: see tdm_results_open. */
tdm_status cpl_record_open(cpl_record *record, const tdm_results_def *def, tdm_error *err);

/* The name of the file of a coupled body, by mbd's name for it. Returns out. */
const char *cpl_record_body_file(const char *body, char *out, size_t size);

/* A further time history in the directory: flushed and closed with the others. NULL: err says why. */
FILE *cpl_record_file(cpl_record *record, const char *name, tdm_error *err);

/* Close the time histories. An error of the disk that came up late is reported here. */
tdm_status cpl_record_close(cpl_record *record, tdm_error *err);

#endif
