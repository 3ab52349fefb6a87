/* The reference of the impact cases: a sphere that meets a plane (or two spheres their common plane) as ordinary
 * differential equations in one dimension along the normal and one across it, integrated here, without the engine.
 *
 *   m delta'' = -F_n,   F_n = k delta^p + c delta^q delta'
 *   m v' = F_t,   I w'/R = F_t (R - delta)/R,   slip u = v + w (R - delta)/R,   w = R omega
 *   F_t = f - d delta^1/4 u, |F_t| <= mu max(F_n, 0),   f: a spring of stiffness s sqrt(delta)
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_IMPACT_H
#define SCN_IMPACT_H

#include <stdbool.h>

/* What codes take the spring across for: the engine's (f falls with sqrt(delta) when the contact unloads, f' = -s
 * sqrt(delta) u), the incremental one (the latter alone), the total one (f = -s sqrt(delta) times the sum of u dt). */
typedef enum { SCN_SPRING_RESCALED, SCN_SPRING_INCREMENTAL, SCN_SPRING_TOTAL } scn_spring;

typedef struct {
  double mass;       /* effective, normal [kg] */
  double k, p, c, q; /* normal force */
  bool clip;         /* ends when F_n is 0 */
  double mu, s, d;   /* across: friction, spring, damping */
  scn_spring spring;
  bool full_arm; /* the force across acts at the arm R, not R - delta */
  double radius; /* [m] */
} scn_law;

typedef struct {
  double overlap, time; /* largest [m]; duration [s] */
  double normal;        /* speed along the normal afterwards [m/s] */
  double v, w;          /* across and R omega afterwards [m/s] */
} scn_outcome;

/* From first touch with speed u_n along the normal, v across, no spin unless w = R omega. */
scn_outcome scn_solve_impact(const scn_law *law, double u_n, double v, double w);

/* Hertz with the damping of Tsuji et al. (1992), ratio beta, and Mindlin's spring. Effective mass, radius, E*, G*. */
scn_law scn_law_hertz(double mass, double radius, double young, double shear, double beta, double mu);

/* -ln e/sqrt(pi^2 + ln^2 e) */
double scn_beta(double restitution);

/* The same for a Hertz contact that ends when its force is 0, by bisection of impacts. */
double scn_beta_clipped(double restitution);

#endif
