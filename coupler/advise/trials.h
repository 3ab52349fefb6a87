/* Trials of candidates: short runs on a copy of the scene's settled bed, what they cost and what they show. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_ADVISE_TRIALS_H
#define CPL_ADVISE_TRIALS_H

#include "coupler/choice/choice.h"
#include "coupler/run/run.h"

enum { CPL_CANDIDATE_SETTINGS = 8, CPL_SETTING_LENGTH = 96 };

enum { CPL_AUTO_N = 0 }; /* as n: "auto" */

/* Settings that are to be tried. */
typedef struct {
  double dt; /* [s] */
  long n;    /* CPL_AUTO_N: windows choose their length */
  const char *scheme;
  cpl_formulation formulation;
  double tolerance; /* mbd.solver.relative_tolerance */
} cpl_candidate;

/* What trials of a scene share. */
typedef struct {
  const char *scene;      /* file */
  const char *const *set; /* of the user, NULL-terminated, may be NULL */
  const char *dir;        /* a folder for the bed and the trials */
  cpl_solver solver[CPL_NROLE];
  tdm_scene loaded; /* the scene with the user's settings */
  cpl_settings settings;
  char bed[4300];
  double start;         /* processor time until both solvers are ready, without settling [s] */
  double settled;       /* the same with settling [s] */
  double setup;         /* until both solvers are ready, with settling, by the clock [s] */
  double budget, spent; /* processor time of trials, without settling [s] */
  double *radius;       /* (bodies) of gyration, at which turns count beside ways [m] */
  int ntrial;
  json_t *rows; /* a row a trial */
} cpl_trials;

typedef struct {
  cpl_candidate of;
  char dir[4300];
  bool good; /* it came to its end, no particle left, no energy came from nowhere */
  char reason[TDM_MESSAGE_MAX];
  double simulated, interval; /* as far as it came, between rows [s] */
  double length;              /* of its windows, the mean [s] */
  double step, window;        /* what a step of DEM costs, and a window without that, of processor time [s] */
  double processor;           /* of both solvers and the server, without the start [s] */
  double loop, mbd;           /* the loop, the MBD solver's part of it [s] */
  double speed;               /* highest at which contacts began [m/s] */
  double half, last;          /* particles at the half and at the end */
  bool prescribed;            /* no load moves any coupled body */
  double acceleration;        /* largest of a coupled body [m/s2] */
  double gap;                 /* velocity against the derivative of position: the largest of all bodies; NaN */
  double estimate;            /* of the exchange's part of its own error (error_estimate.worst_coupling); NaN */
} cpl_tried;

/* Load the scene and look at what trials need. The caller closes also after an error. */
tdm_status cpl_trials_open(cpl_trials *trials, tdm_error *err);
void cpl_trials_close(cpl_trials *trials);

/* What the scene says of mbd.solver.relative_tolerance, or its default. */
double cpl_trials_tolerance(const cpl_trials *trials);

/* The n of a candidate as scenes have it: a number, or "auto"; in out. */
enum { CPL_N_LENGTH = 24 };
const char *cpl_candidate_n(const cpl_candidate *of, char out[CPL_N_LENGTH]);

/* "path=value" of a candidate, (CPL_CANDIDATE_SETTINGS + 1); returns how many. `root`: of the scene, whose keys that
 * would contradict get values, too. */
int cpl_candidate_settings(const cpl_candidate *of, const json_t *root,
                           char out[CPL_CANDIDATE_SETTINGS + 1][CPL_SETTING_LENGTH]);

/* Settle the bed, if that has not been done, and take what the solvers report. speed > 0: the contact time at that
 * [m/s]. */
tdm_status cpl_trials_check(cpl_trials *trials, const cpl_candidate *of, double speed, cpl_limits *limits,
                            cpl_facts *facts, tdm_error *err);

/* Run for `end` seconds with rows every `interval` (0: the scene's own). Round-off: the mass of a coupled body is
 * changed by some units in its last place. A trial that fails is no error, but tried->reason. */
tdm_status cpl_trials_run(cpl_trials *trials, const cpl_candidate *of, double end, double interval, bool round_off,
                          cpl_tried *tried, tdm_error *err);

/* How far two trials are apart, the largest over bodies, of position and of velocity (with turns at the radius of
 * gyration), as a share of its spread over the whole of a; differences that are at most twice those of the twins (may
 * be NULL), which differ by round-off, do not count. NaN: nothing to compare, or no load moves the bodies. */
double cpl_trials_apart(const cpl_trials *trials, const cpl_tried *a, const cpl_tried *b, const cpl_tried twins[2]);

/* The smallest radius of particles that the scene names [m]; inf: it names none. */
double cpl_trials_smallest(const cpl_trials *trials);

/* The variance ratio of the loads on the bodies, the largest of all; NaN: unknown. */
double cpl_trials_erratic(const cpl_trials *trials, const cpl_tried *tried, double window);

#endif
