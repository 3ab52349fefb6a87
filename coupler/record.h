/* The result directory of a run: time histories as CSV, the scene as it ran, summary.json, the logs.
 *
 *   body_<name>.csv  per coupled body (mbd's name): pose, twist, and the mean load since the row before
 *   mbd.csv, dem.csv further outputs that the solvers announce (joint reactions, energies, particle sums)
 *   scene.json       the scene with all overrides
 *   summary.json     settings, versions, wall times, warnings, how the run ended
 *   server.log, mbd.log, dem.log
 *
 * The CSV files hold nothing that differs between two runs of the same scene: no wall times, no dates. Numbers are
 * written with 17 digits, so that they read back as the same doubles.
 */
#ifndef CPL_RECORD_H
#define CPL_RECORD_H

#include "coupler/session.h"

typedef struct cpl_record {
  char dir[4096];
  FILE **body;              /* (nbody) */
  FILE *channel[CPL_NROLE]; /* NULL when a solver has no channels */
  int nbody, nchannel[CPL_NROLE];
  double interval;
  double last_flush;
} cpl_record;

/* Make a directory and its parents; one that is there is fine. */
tdm_status cpl_make_directory(const char *dir, tdm_error *err);

/* Make the directory (and its parents), remove what an earlier run left there, and open *log (server.log; the caller
 * closes it). The log is locked until then: a second run into the same directory is refused, and so is a directory
 * whose scene.json is the scene `scene` itself, which would be overwritten. */
tdm_status cpl_record_open(cpl_record *record, const char *dir, const char *scene, FILE **log, tdm_error *err);

/* dir/name into out (size bytes). */
const char *cpl_record_path(const cpl_record *record, const char *name, char *out, size_t size);

/* Open the time histories and write the row of t = 0. */
tdm_status cpl_record_begin(cpl_record *record, const cpl_session *session, tdm_error *err);

/* Rows for the output times first … first + nsample - 1 of the grid, from the results of both solvers. */
tdm_status cpl_record_samples(cpl_record *record, uint64_t first, int nsample, const tdm_result *result,
                              tdm_error *err);

/* Write `json` (borrowed) as a file of the directory. */
tdm_status cpl_record_json(const cpl_record *record, const char *name, const json_t *json, tdm_error *err);

/* Read a JSON file of a result directory (new reference); NULL and an error when `dir` is none. */
json_t *cpl_record_read(const char *dir, const char *name, tdm_error *err);

/* Close the time histories. An error of the disk that came up late is reported here. */
tdm_status cpl_record_close(cpl_record *record, tdm_error *err);

#endif
