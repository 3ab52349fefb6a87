/* Box of particles on a spring and damper, [L18] Section 3.3: position and velocity of the box against the oscillator
 * that carries box and fill as one mass, and the load of the fill. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/spring_damper/reference.h"
#include "scenarios/support.h"
#include "scenarios/table.h"

#include <math.h>

static const double least_nse = 0.999;

/* The oscillator of the scene as it ran. */
static void read_parameters(const scn_result *r, scn_spring_damper_parameters *p, double *fill, tdm_error *err) {
  *fill = scn_number(r->summary, "solvers.dem.report.fill.mass", err);
  p->mass = scn_number(r->scene, "mbd.bodies[0].mass", err) + *fill;
  p->stiffness = scn_number(r->scene, "mbd.forces[0].stiffness", err);
  p->damping = scn_number_or(r->scene, "mbd.forces[0].damping", 0);
  p->preload = scn_number_or(r->scene, "mbd.forces[0].preload", 0);
  p->gravity = -scn_number_or(r->scene, "mbd.gravity[2]", -9.81);
  if (err->status == TDM_OK && p->damping * p->damping >= 4 * p->stiffness * p->mass)
    tdm_fail(err, TDM_ERR_SCENE, "mbd.forces[0].damping", "the reference is that of an underdamped oscillator");
}

tdm_status scn_spring_damper_compare(const char *dir, cpl_comparison *c, tdm_error *err) {
  scn_result r = {0};
  scn_spring_damper_parameters p = {0};
  double fill = 0;
  if (scn_result_read(&r, dir, err) == TDM_OK)
    read_parameters(&r, &p, &fill, err);
  const double *time = err->status == TDM_OK ? cpl_table_column(&r.body, "time", err) : NULL;
  const double *z = time ? cpl_table_column(&r.body, "z", err) : NULL;
  const double *vz = z ? cpl_table_column(&r.body, "vz", err) : NULL;
  const double *fz = vz ? cpl_table_column(&r.body, "fz", err) : NULL;
  if (fz && cpl_comparison_init(c, r.body.nrow, time, err) == TDM_OK) {
    cpl_compared *x = cpl_comparison_add(c, "x", "m", CPL_STATE, "Position of the box, downward from the start", err);
    cpl_compared *v = cpl_comparison_add(c, "v", "m/s", CPL_STATE, "Velocity of the box, downward", err);
    cpl_compared *f = cpl_comparison_add(c, "F", "N", CPL_LOAD, "Load of the particles on the box, downward", err);
    for (int i = 0; err->status == TDM_OK && i < c->nrow; i++) {
      x->simulation[i] = z[0] - z[i];
      v->simulation[i] = -vz[i];
      f->simulation[i] = -fz[i];
      scn_spring_damper_exact(&p, time[i], &x->reference[i], &v->reference[i]);
      /* the fill as a rigid mass: F = m (g - x''), x'' as the mean over the interval that the load is a mean of */
      double rate =
          i > 0 ? (v->reference[i] - v->reference[i - 1]) / (time[i] - time[i - 1]) : p.gravity - p.preload / p.mass;
      f->reference[i] = fill * (p.gravity - rate);
    }
  }
  scn_result_free(&r);
  return err->status;
}

tdm_status scn_spring_damper(cpl_verify *v, tdm_error *err) {
  return scn_verify_comparison(v, true, least_nse, err);
}
