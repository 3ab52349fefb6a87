/* Damping ratio from restitution: see restitution.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/contact/law/restitution.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gsl/gsl_roots.h>
#include <math.h>

double dem_beta_keep(double restitution) {
  double l = log(restitution);
  return -l / sqrt(l * l + M_PI * M_PI);
}

/* dimensionless force on the particle */
static double impact_force(double beta, double x, double v) {
  double root4 = sqrt(sqrt(fmax(x, 0)));
  return root4 * root4 * root4 * root4 * root4 * root4 + sqrt(5) * beta * root4 * v;
}

static int impact_rate(double t, const double y[], double dydt[], void *params) {
  (void)t;
  dydt[0] = y[1];
  dydt[1] = -impact_force(*(double *)params, y[0], y[1]);
  return GSL_SUCCESS;
}

/* Speed at the end of the impact: adaptive steps until the force is negative; then back, with steps that halve until
 * they vanish. */
static double end_speed(double beta, gsl_odeiv2_step *step, gsl_odeiv2_control *control, gsl_odeiv2_evolve *evolve) {
  gsl_odeiv2_system system = {impact_rate, NULL, 2, &beta};
  double t = 0, y[2] = {0, 1}, h = 1e-8;
  bool closing = false;
  for (int i = 0; i < 100000 && h > 1e-13; i++) {
    double t_old = t, y_old[2] = {y[0], y[1]};
    gsl_odeiv2_evolve_apply(evolve, control, step, &system, &t, t + (closing ? h : 100), &h, y);
    double taken = t - t_old;
    if (impact_force(beta, y[0], y[1]) <= 0) {
      t = t_old, y[0] = y_old[0], y[1] = y_old[1];
      gsl_odeiv2_evolve_reset(evolve);
      gsl_odeiv2_step_reset(step);
      closing = true;
    }
    if (closing)
      h = taken / 2;
  }
  return -y[1];
}

double dem_restitution_clip(double beta) {
  if (beta <= 0)
    return 1;
  gsl_odeiv2_step *step = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, 2);
  gsl_odeiv2_control *control = gsl_odeiv2_control_y_new(1e-12, 1e-12);
  gsl_odeiv2_evolve *evolve = gsl_odeiv2_evolve_alloc(2);
  double e = step && control && evolve ? end_speed(beta, step, control, evolve) : NAN;
  if (evolve)
    gsl_odeiv2_evolve_free(evolve);
  if (control)
    gsl_odeiv2_control_free(control);
  if (step)
    gsl_odeiv2_step_free(step);
  return e;
}

static double miss(double beta, void *params) {
  return dem_restitution_clip(beta) - *(double *)params;
}

tdm_status dem_beta_clip(double restitution, double *beta) {
  *beta = 0;
  if (restitution >= 1)
    return TDM_OK;
  /* clipping raises e, so the beta with tail is too small: search upwards from there */
  double low = dem_beta_keep(restitution), high = 2 * low;
  if (dem_restitution_clip(low) <= restitution) { /* e so near 1 that the two do not differ */
    *beta = low;
    return TDM_OK;
  }
  while (high < 1000 && dem_restitution_clip(high) > restitution) {
    low = high;
    high *= 2;
  }
  if (high >= 1000)
    return TDM_ERR_NUMERIC;
  gsl_function f = {miss, &restitution};
  gsl_root_fsolver *solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
  if (!solver)
    return TDM_ERR_MEMORY;
  gsl_root_fsolver_set(solver, &f, low, high);
  for (int i = 0; i < 100; i++) {
    gsl_root_fsolver_iterate(solver);
    *beta = gsl_root_fsolver_root(solver);
    if (fabs(miss(*beta, &restitution)) < 1e-10)
      break;
  }
  gsl_root_fsolver_free(solver);
  double off = fabs(miss(*beta, &restitution));
  return isnan(off) ? TDM_ERR_MEMORY : off < 1e-8 ? TDM_OK : TDM_ERR_NUMERIC;
}

/* ---- linear, and Hunt and Crossley ---- */

/* x'' + 2 zeta x' + x = 0, x(0) = 0, x'(0) = 1. Kept, it ends at x = 0; clipped, at x'' = 0, where with zeta = sin a
 * the phase is pi - 2a and the speed exp(-zeta t). */
double dem_linear_time(double zeta, bool clip) {
  if (zeta < 1)
    return (clip ? M_PI - 2 * asin(zeta) : M_PI) / sqrt(1 - zeta * zeta);
  if (!clip)
    return INFINITY;
  double b = acosh(zeta);
  return b > 0 ? 2 * b / sinh(b) : 2;
}

double dem_linear_restitution(double zeta, bool clip) {
  return exp(-zeta * dem_linear_time(zeta, clip));
}

/* the root of f, which falls, in [low, high], by bisection to the last bit */
static double falling_root(double (*f)(double x, double e), double e, double low, double high) {
  for (int i = 0; i < 200; i++) {
    double middle = 0.5 * (low + high);
    if (f(middle, e) > 0)
      low = middle;
    else
      high = middle;
  }
  return 0.5 * (low + high);
}

static double linear_miss(double zeta, double e) {
  return dem_linear_restitution(zeta, true) - e;
}

double dem_linear_ratio(double restitution, bool clip) {
  if (!clip || restitution >= 1)
    return dem_beta_keep(restitution);
  return falling_root(linear_miss, restitution, 0, 1 + 1 / restitution);
}

/* The speed e after an impact with X: X - ln(1+X) = -eX - ln(1 - eX), in terms of both; > 0 when X is too small. */
static double hunt_miss(double x, double e) {
  return -e * x - log1p(-e * x) < x - log1p(x) ? 1 : -1;
}

static double hunt_speed_miss(double e, double x) {
  return hunt_miss(x, e);
}

double dem_hunt_damping(double restitution) {
  return restitution >= 1 ? 0 : falling_root(hunt_miss, restitution, 0, 1 / restitution);
}

double dem_hunt_restitution(double damping) {
  return damping <= 0 ? 1 : falling_root(hunt_speed_miss, damping, 0, fmin(1, 1 / damping));
}
