/* One co-simulation from a scene file to a result directory. */
#ifndef CPL_RUN_H
#define CPL_RUN_H

#include "coupler/launch.h"
#include "coupler/settings.h"

typedef struct {
  const char *scene;      /* file */
  const char *const *set; /* NULL-terminated "path=value" overrides, may be NULL */
  const char *out;        /* result directory */
  bool strict;            /* refuse a run whose solvers warn */
  bool quiet;             /* no progress, no warnings on standard error */
  cpl_solver solver[CPL_NROLE];
} cpl_run_options;

typedef struct {
  uint64_t windows;       /* solved */
  double simulated;       /* [s] */
  double wall;            /* all, from reading the scene to the last file [s] */
  double setup;           /* until both solvers are ready [s]: loading, settling */
  double step[CPL_NROLE]; /* the solvers' own work on windows [s] */
  double coupling;        /* the rest of the coupled loop: exchange, extrapolation, records [s] */
  int warnings;
} cpl_run_result;

/* Run. The result is filled as far as the run came, also after an error. The result directory holds what was computed.
 */
tdm_status cpl_run(const cpl_run_options *options, cpl_run_result *result, tdm_error *err);

#endif
