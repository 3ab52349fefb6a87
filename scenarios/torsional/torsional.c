/* A box of particles on a torsional spring and damper, [L18] Section 3.4: angle and angular velocity against the
 * equation of motion of a rigid body, theta downward from the horizontal start:
 *
 *   I theta'' + C theta' + kappa theta = m g c_x(theta)                                                  [L18] Eq. 25
 *
 * with I of box and fill about the pivot and c their centre of mass. GSL integrates it.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/rigid_fill.h"
#include "scenarios/table.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdio.h>

static const double least_nse = 0.999;

typedef struct {
  scn_rigid_fill fill;
  double stiffness, damping; /* [N m/rad], [N m s/rad] */
} torsion;

/* y = (theta, theta'); turning down by theta turns the arm by -theta about z */
static int equation(double t, const double y[], double rate[], void *parameters) {
  (void)t;
  const torsion *p = parameters;
  double x = p->fill.x * cos(y[0]) + p->fill.y * sin(y[0]);
  rate[0] = y[1];
  rate[1] = (p->fill.mass * p->fill.gravity * x - p->damping * y[1] - p->stiffness * y[0]) / p->fill.inertia;
  return GSL_SUCCESS;
}

/* Angle and rate at the times of the grid. */
static tdm_status integrate(const torsion *p, int n, const double *time, double *theta, double *omega, tdm_error *err) {
  gsl_odeiv2_system system = {equation, NULL, 2, (void *)p};
  gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-4, 1e-12, 1e-12);
  double t = time[0], y[2] = {0, 0};
  for (int i = 0; i < n; i++) {
    if (time[i] > t && gsl_odeiv2_driver_apply(driver, &t, time[i], y) != GSL_SUCCESS) {
      tdm_fail(err, TDM_ERR_NUMERIC, NULL, "torsional: the reference cannot be integrated beyond %g s", t);
      break;
    }
    theta[i] = y[0];
    omega[i] = y[1];
  }
  gsl_odeiv2_driver_free(driver);
  return err->status;
}

/* Moment of the fill on the box about the pivot, downward, as a mean over each interval of the grid. */
static void moment(const scn_result *r, const torsion *p, const cpl_comparison *c, cpl_compared *m, tdm_error *err) {
  const char *const names[] = {"x", "y", "fx", "fy", "mz"};
  const double *column[5];
  for (int k = 0; k < 5; k++)
    if (!(column[k] = cpl_table_column(&r->body, names[k], err)))
      return;
  const double *x = column[0], *y = column[1], *fx = column[2], *fy = column[3], *mz = column[4];
  const scn_rigid_fill *f = &p->fill;
  for (int i = 0; i < c->nrow; i++) {
    int before = i > 0 ? i - 1 : 0;
    double xm = 0.5 * (x[i] + x[before]), ym = 0.5 * (y[i] + y[before]);
    m->simulation[i] = -(mz[i] + xm * fy[i] - ym * fx[i]);
    /* the fill as a rigid body: M = m_f g c_x - I_f theta'', theta'' as the mean over the interval */
    double angle = 0.5 * (c->curve[0].reference[i] + c->curve[0].reference[before]);
    double state[2] = {0, 0}, rate[2];
    equation(0, state, rate, (void *)p);
    if (i > 0)
      rate[1] = (c->curve[1].reference[i] - c->curve[1].reference[before]) / (c->time[i] - c->time[before]);
    m->reference[i] =
        f->fill_mass * f->gravity * (f->fill_x * cos(angle) + f->fill_y * sin(angle)) - f->fill_inertia * rate[1];
  }
}

static tdm_status compare(const scn_result *r, const torsion *p, cpl_comparison *c, tdm_error *err) {
  const double *time = cpl_table_column(&r->body, "time", err), *x = cpl_table_column(&r->body, "x", err),
               *y = cpl_table_column(&r->body, "y", err), *wz = cpl_table_column(&r->body, "wz", err);
  if (err->status != TDM_OK || cpl_comparison_init(c, r->body.nrow, time, err) != TDM_OK)
    return err->status;
  cpl_compared *theta = cpl_comparison_add(c, "theta", "rad", CPL_STATE, "Angle, downward from the horizontal", err);
  cpl_compared *omega = cpl_comparison_add(c, "omega", "rad/s", CPL_STATE, "Angular velocity, downward", err);
  cpl_compared *m =
      cpl_comparison_add(c, "M", "N m", CPL_LOAD, "Moment of the particles on the box about the pivot", err);
  if (err->status != TDM_OK || integrate(p, c->nrow, time, theta->reference, omega->reference, err) != TDM_OK)
    return err->status;
  double start = atan2(y[0], x[0]);
  for (int i = 0; i < c->nrow; i++) {
    theta->simulation[i] = -remainder(atan2(y[i], x[i]) - start, 2 * M_PI);
    omega->simulation[i] = -wz[i];
  }
  moment(r, p, c, m, err);
  return err->status;
}

static tdm_status read_torsion(const scn_result *r, torsion *p, tdm_error *err) {
  p->stiffness = scn_number(r->scene, "mbd.forces[0].stiffness", err);
  p->damping = scn_number_or(r->scene, "mbd.forces[0].damping", 0);
  return scn_rigid_fill_read(r, &p->fill, err);
}

tdm_status scn_torsional_compare(const char *dir, cpl_comparison *c, tdm_error *err) {
  scn_result r = {0};
  torsion p = {0};
  if (scn_result_read(&r, dir, err) == TDM_OK && read_torsion(&r, &p, err) == TDM_OK)
    compare(&r, &p, c, err);
  scn_result_free(&r);
  return err->status;
}

/* The paper does not define I; with m r^2 and all mass at r the agreement is worse. */
static void measure_point_mass(cpl_verify *v, const char *dir, tdm_error *err) {
  scn_result r = {0};
  torsion p = {0};
  cpl_comparison c = {0};
  if (scn_result_read(&r, dir, err) == TDM_OK && read_torsion(&r, &p, err) == TDM_OK) {
    p.fill.inertia = p.fill.mass * p.fill.radius * p.fill.radius;
    p.fill.x = p.fill.radius;
    p.fill.y = 0;
    if (compare(&r, &p, &c, err) == TDM_OK)
      for (int i = 0; i < 2; i++) {
        char name[64];
        snprintf(name, sizeof name, "nse_%s", c.curve[i].name);
        cpl_verify_measure(v, name, "I=m r^2", cpl_comparison_nse(&c, &c.curve[i]), CPL_NO_LIMIT, 0);
      }
  }
  cpl_comparison_free(&c);
  scn_result_free(&r);
}

tdm_status scn_torsional(cpl_verify *v, tdm_error *err) {
  char dir[4096];
  cpl_comparison c = {0};
  if (scn_verify_run_and_compare(v, true, least_nse, dir, sizeof dir, &c, err) == TDM_OK)
    measure_point_mass(v, dir, err);
  cpl_comparison_free(&c);
  return err->status;
}
