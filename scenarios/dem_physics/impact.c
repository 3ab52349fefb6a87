/* The reference of the impact cases: see impact.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/dem_physics/impact.h"

#include <math.h>

/* delta, delta', v, w, and f (total: the sum of u dt) */
enum { DELTA, RATE, V, W, F, N };

double scn_beta(double e) {
  return -log(e) / sqrt(M_PI * M_PI + log(e) * log(e));
}

scn_law scn_law_hertz(double mass, double radius, double young, double shear, double beta, double mu) {
  double root = sqrt(radius), normal = 2 * sqrt(5.0 / 6) * beta;
  return (scn_law){.mass = mass,
                   .k = 4.0 / 3 * young * root,
                   .p = 1.5,
                   .c = normal * sqrt(mass * 2 * young * root),
                   .q = 0.25,
                   .mu = mu,
                   .s = 8 * shear * root,
                   .d = normal * sqrt(mass * 8 * shear * root),
                   .radius = radius};
}

static double power(double x, double p) {
  return p == 0 ? 1 : p == 1 ? x : p == 0.5 ? sqrt(x) : p == 1.5 ? x * sqrt(x) : p == 0.25 ? sqrt(sqrt(x)) : pow(x, p);
}

static double push(const scn_law *law, const double *y) {
  double x = fmax(y[DELTA], 0);
  return law->k * power(x, law->p) + law->c * power(x, law->q) * y[RATE];
}

static double clip(double x, double limit) {
  return fmax(-limit, fmin(limit, x));
}

static void slope(const scn_law *law, const double *y, double *out) {
  double x = fmax(y[DELTA], 1e-30), normal = push(law, y);
  out[DELTA] = y[RATE];
  out[RATE] = -normal / law->mass;
  out[V] = out[W] = out[F] = 0;
  if (law->mu == 0)
    return;
  double arm = law->full_arm ? 1 : 1 - x / law->radius, slip = y[V] + arm * y[W], stiffness = law->s * sqrt(x),
         limit = law->mu * fmax(normal, 0);
  double spring = law->spring == SCN_SPRING_TOTAL ? -stiffness * y[F] : y[F];
  double force = clip(clip(spring, limit) - law->d * power(x, 0.25) * slip, limit);
  out[V] = force / law->mass;
  out[W] = 2.5 * arm * force / law->mass;
  out[F] = law->spring == SCN_SPRING_TOTAL ? slip : -stiffness * slip;
  if (law->spring == SCN_SPRING_RESCALED && y[RATE] < 0)
    out[F] += 0.5 * y[F] * y[RATE] / x;
}

/* the spring lets go at Coulomb's limit */
static void slide(const scn_law *law, double *y) {
  double limit = law->mu * fmax(push(law, y), 0), stiffness = law->s * sqrt(fmax(y[DELTA], 1e-30));
  if (law->mu > 0)
    y[F] = clip(y[F], law->spring == SCN_SPRING_TOTAL ? limit / stiffness : limit);
}

/* Runge-Kutta's step of fourth order */
static void advance(const scn_law *law, double *y, double dt) {
  double k[4][N], z[N];
  slope(law, y, k[0]);
  for (int stage = 1; stage < 4; stage++) {
    for (int i = 0; i < N; i++)
      z[i] = y[i] + (stage < 3 ? 0.5 : 1) * dt * k[stage - 1][i];
    slope(law, z, k[stage]);
  }
  for (int i = 0; i < N; i++)
    y[i] += dt / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
  slide(law, y);
}

scn_outcome scn_solve_impact(const scn_law *law, double u_n, double v, double w) {
  const int per_impact = 20000;
  double depth = pow((law->p + 1) * law->mass * u_n * u_n / (2 * law->k), 1 / (law->p + 1)); /* undamped */
  double dt = 3 * depth / u_n / per_impact, t = 0, y[N] = {0, u_n, v, w, 0};
  scn_outcome out = {0};
  for (int k = 0; k < 20 * per_impact; k++) {
    double before[N], force = push(law, y);
    for (int i = 0; i < N; i++)
      before[i] = y[i];
    advance(law, y, dt);
    t += dt;
    out.overlap = fmax(out.overlap, y[DELTA]);
    double now = push(law, y), share = 1; /* of the step, when it is the last */
    if (law->clip && now <= 0)
      share = force / (force - now);
    else if (y[DELTA] <= 0)
      share = before[DELTA] / (before[DELTA] - y[DELTA]);
    else
      continue;
    for (int i = 0; i < N; i++)
      y[i] = before[i] + share * (y[i] - before[i]);
    out.time = t - (1 - share) * dt;
    break;
  }
  out.normal = -y[RATE], out.v = y[V], out.w = y[W];
  return out;
}

double scn_beta_clipped(double e) {
  double low = 0, high = 1;
  for (int i = 0; i < 40; i++) {
    double beta = 0.5 * (low + high);
    scn_law law = scn_law_hertz(1, 1, 1, 0, beta, 0); /* whatever its size */
    law.clip = true;
    *(scn_solve_impact(&law, 1, 0, 0).normal > e ? &low : &high) = beta;
  }
  return low;
}
