/* What can be chosen before any trial: the first boxes of [L18] Fig. 12, from what the DEM engine reports of its limits
 * and from what the scene says of its mechanism. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_CHOICE_CHOICE_H
#define CPL_CHOICE_CHOICE_H

#include <stdbool.h>

/* ---- the DEM step ---- */

typedef enum { CPL_RAYLEIGH, CPL_EIGENFREQUENCY, CPL_CONTACT, CPL_LIMITS } cpl_limit;

extern const char *const cpl_limit_names[CPL_LIMITS]; /* as reports have them, "limits.rayleigh" without "limits." */

/* Of the settled bed. */
typedef struct {
  double time[CPL_LIMITS]; /* Rayleigh step, stable step of the stiffest particle, shortest contact [s]; inf: none */
  double speed;            /* at which the contact was taken [m/s] */
  double coordination;     /* contacts of a particle, the mean over all */
} cpl_limits;

typedef struct {
  double share[CPL_LIMITS]; /* of each time that a step may take */
  double exact;             /* the step that keeps all of them [s] */
  double dt;                /* the next one below it with a round number [s]; 0: nothing limits it */
  cpl_limit by;             /* the limit that decides */
} cpl_step;

/* [L18] Section 4.1: 0.2 of the Rayleigh step above a coordination number of 4, else 0.4; 0.8 of the stable step; a
 * twentieth of the contact. */
cpl_step cpl_choose_step(const cpl_limits *limits);

/* The largest of 1, 1.2, 1.5, 2, 2.5, 3, 4 to 9 times a power of ten that is not above x > 0. */
double cpl_round_down(double x);

/* ---- the mechanism ---- */

/* Formulations in the order in which they are tried as remedies. */
typedef enum {
  CPL_ONE_STEP,  /* for loads that jump: what WSTIFF is for */
  CPL_LOW_ORDER, /* "ggl" with orders up to 2, positions alone in the error test: what the modified corrector is for */
  CPL_SMOOTH,    /* "ggl" as it is, for loads that hardly jump */
  CPL_FORMULATIONS
} cpl_formulation;

extern const char *const cpl_formulation_words[CPL_FORMULATIONS]; /* as people read it */

typedef struct {
  const char *abrupt;  /* the first force that sets in at once, by its type ("stop", "cable" ...); NULL: none */
  bool flows;          /* particles come or go */
  double coordination; /* as above */
  double body, heaviest, particles; /* masses of the lightest coupled body, the heaviest particle, all particles [kg] */
} cpl_facts;

/* The formulation for contacts that come and go, or stay. */
cpl_formulation cpl_choose_formulation(const cpl_facts *facts);

/* The n of the first trial: 5; more where the step is a small part of the Rayleigh step's share and the body is heavy
 * beside a particle (100 times), so that the windows are no shorter than with a step of that share; at most 50. */
long cpl_first_n(const cpl_facts *facts, double dt, double rayleigh_share);

/* The largest n with which the straight path within a window of a body that is driven leaves its true path by less than
 * a hundredth of the smallest radius [m]: a H^2 / 8 with the acceleration a [m/s2]. */
double cpl_path_n(double acceleration, double radius, double dt);

/* Whether a run's own estimate of the exchange's error is more than what is wanted, and more than twice that of the run
 * with n = 1, which no n can better. NaN: unknown, not too large. */
bool cpl_estimate_too_large(double estimate, double single, double wanted);

/* The n from which on longer windows save less than a twentieth of the run: a window costs `window`, a step `step` [s].
 */
long cpl_cheap_n(double window, double step);

/* The search for the largest n that does well: first the largest that could save anything, then in the middle, by their
 * ratio, of the largest that did well and the smallest that did not. */
typedef struct {
  long good;   /* the largest so far that did well, at least 1 */
  double bad;  /* the smallest that did not; inf: none did badly */
  double most; /* larger ones save nothing */
  int left;    /* trials that the search may still take */
} cpl_n_search;

cpl_n_search cpl_n_search_from(long good, double most);

/* The next n to try, a round number; 0: the search is over, and `good` is what it found. */
long cpl_n_search_next(const cpl_n_search *search);

/* What came of it. */
void cpl_n_search_tell(cpl_n_search *search, long n, bool did_well);

#endif
