/* One co-simulation from a scene file to a result directory. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_RUN_RUN_H
#define CPL_RUN_RUN_H

#include "coupler/estimate/error.h"
#include "coupler/loop/observer.h"
#include "coupler/session/launch.h"

typedef struct {
  const char *scene;      /* file */
  const char *const *set; /* NULL-terminated "path=value" overrides, may be NULL */
  const char *out;        /* result directory; NULL for a check that leaves nothing */
  const char *record;     /* file for all frames of the exchange (protocol/record/record.h); NULL: none */
  bool force;             /* replace the results of an earlier run there */
  bool strict;            /* refuse a run whose solvers warn */
  bool quiet;             /* no progress, no warnings on standard error */
  bool check;             /* stop when both solvers are ready, and print what would run (not when quiet) */
  cpl_solver solver[CPL_NROLE];
  const cpl_scheme *const *schemes;     /* that the scene may name, NULL-terminated; NULL: tandem's own */
  const cpl_observer *const *observers; /* beside tandem's own, NULL-terminated; NULL: none */
  void (*loaded)(void *context); /* called when the scene has been read, before solvers start; NULL: nobody wants it */
  void *context;                 /* borrowed */
} cpl_run_options;

typedef struct {
  double error; /* estimated: the largest of the bodies' motions, rms beside their spread over the run (the root
                 * of 1 - nse); NaN: unknown */
  double error_coupling; /* the part of it that the exchange makes, without the rattle of the particles */
  bool error_large;      /* it is so large that the run says so */
  char error_line[320];  /* the same in words, "" where no window was solved */

  uint64_t windows;           /* solved */
  double simulated;           /* [s] */
  double wall;                /* all, from reading the scene to the last file [s] */
  double setup;               /* until both solvers are ready [s]: loading, settling */
  double loop;                /* the coupled loop [s] */
  double step[CPL_NROLE];     /* the solvers' own work on windows [s] */
  double exchange[CPL_NROLE]; /* messages to each solver and back, without its work [s] */
  long n_least, n_most;       /* DEM steps of the shortest and the longest window */
  bool adapts;                /* "n": "auto" */
  cpl_too_long too_long;
  char scheme_line[160]; /* the scheme's own line on its windows, "" for none */
  bool thread_hangs;     /* inproc: a solver's thread does not end; the process must leave by _exit */
  int warnings;
} cpl_run_result;

/* What is neither solver's own work in the loop [s]: exchange, extrapolation, records. */
double cpl_run_coupling(const cpl_run_result *result);

/* Print where the loop's time went: a row a part with its work, its waiting and its exchange. */
void cpl_run_print(const cpl_run_result *result, const char *out);

/* Run. The result is filled as far as the run came, also after an error. The result directory holds what was computed.
 */
tdm_status cpl_run(const cpl_run_options *options, cpl_run_result *result, tdm_error *err);

#endif
