/* The ledger: what goes through the interface in every window, whatever the scheme, and whether energy appears from
 * nowhere. README.md has the equations.
 *
 *   impulse    of the load on a body, m0 H from DEM's kicks (mean H from a DEM solver without "interface")
 *   work       of the load that DEM found along DEM's path of the body, and of the load that MBD felt along MBD's;
 *              the interface residual is what the second has more
 *   blending   work of the load along the closing of drift
 *   exchange   sum of residuals - blending: energy that the exchange has made, of both paths' works and loads that
 *              differ. Dissipation does not hide it. Bodies whose motion is prescribed are left out: no load moves
 *              them, and what the works differ by is the drivers'
 *   drift      between the two end states of a window
 *   balance    G = stored - supplied of both solvers, less what was left out of the exchange, from its first value on:
 *              friction and damping lower it, nothing may raise it
 *   momentum   of bodies that nothing holds: momentum.h
 *
 * ledger.csv has sums since the start, drifts as the largest since the row before, energies as last looked at, all as
 * of the end of the last window that was over at the row's time.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_LOOP_LEDGER_H
#define CPL_LOOP_LEDGER_H

#include "coupler/loop/momentum.h"

#include <stdio.h>

struct cpl_loop;

/* Sums since the start, of one body. */
typedef struct {
  tdm_wrench impulse;               /* [N s], [N m s] */
  double work[CPL_NROLE], blending; /* [J] */
  double drift, angle;              /* largest since the row before [m], [rad] */
  double most_drift, most_angle;    /* largest of the run */
  cpl_momentum momentum;            /* of the loads that MBD was given */
} cpl_ledger_body;

typedef struct {
  const cpl_settings *settings;
  const tdm_assigned_body *of; /* (nbody) as MBD told them, borrowed */
  FILE *file;                  /* ledger.csv, borrowed */
  int nbody;
  cpl_ledger_body *body; /* (nbody) */
  double *row;           /* of the file */
  bool has_energy[CPL_NROLE];
  tdm_energy energy[CPL_NROLE]; /* as last looked at */
  uint64_t looks;               /* at both */
  double size;                  /* of the sums of the last one, for round-off [J] */
  double start, balance;        /* G at the first look, and its growth since [J] */
  double lowest;                /* G so far [J] */
  double own[CPL_NROLE];        /* lowest so far of stored - supplied - work of the coupling load, of each solver [J] */
  double rest;                  /* of both: less energy than that is no motion to judge by [J] */
  double kinetic;               /* largest of both so far [J] */
  double potential[2];          /* least and greatest of what is stored otherwise [J] */
  double rise;                  /* largest of G over its lowest [J] */
  double exchange;              /* energy that the exchange has made [J] */
  double drivers;               /* residuals - blending of the bodies whose motion is prescribed [J] */
  double exchange_lowest;       /* [J] */
  double exchange_rise;         /* largest over its lowest [J] */
  double residual;              /* largest magnitude of the exchange so far [J] */
  double worked;                /* sum over windows and bodies of |work on DEM's side|, but for prescribed bodies [J] */
  int rises;                    /* looks in a row with more than the guard allows */
  double gained_at;             /* when the guard first would have spoken [s]; NaN: never */
} cpl_ledger;

/* Opens the books: writes the header and the row of t = 0 into `file` (borrowed). */
tdm_status cpl_ledger_begin(cpl_ledger *ledger, const cpl_settings *settings, const cpl_session *session, FILE *file,
                            tdm_error *err);
void cpl_ledger_free(cpl_ledger *ledger);

/* Enter the window that the loop has solved. TDM_ERR_NUMERIC: energy has appeared from nowhere (coupling.guard). */
tdm_status cpl_ledger_window(cpl_ledger *ledger, struct cpl_loop *loop, tdm_error *err);

/* What the exchange has made is more than coupling.guard.residual of the work that went through it (*share), and no
 * trifle: more than a tenth of the energy that the guard allows. False where a solver does not tell its energy. */
bool cpl_ledger_inexact(const cpl_ledger *ledger, double *share);

/* The run has come to its end: tell if it was inexact. */
void cpl_ledger_end(const cpl_ledger *ledger, const struct cpl_loop *loop);

/* The final figures for summary.json (new reference). */
json_t *cpl_ledger_summary(const cpl_ledger *ledger);

/* Work of W(s) = sum_j load[j] s^j, s = (t - t0)/duration, on a body that goes from start to end: its velocity is that
 * of the cubic Hermite path between the two states, its angular velocity likewise the parabola with the values at both
 * ends whose mean is the turn. In closed form; [J]. */
double cpl_work_along(const tdm_state *start, const tdm_state *end, double duration, const tdm_wrench *load, int nload);

/* The same on a body that goes from `start` at t0 to the last node of a path, through all of its nodes: by quadrature
 * between nodes, exact for positions where nload <= 5 [J]. */
double cpl_work_through(const tdm_nodes *path, int body, const tdm_state *start, double t0, const tdm_wrench *load,
                        int nload);

#endif
