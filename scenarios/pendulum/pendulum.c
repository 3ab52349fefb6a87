/* A motor turns a box of particles at constant rate, [L18] Section 3.2: joint forces and motor torque against those of
 * a rigid body on a circle, from 0.25 s on.
 *
 *   F_x = -m w^2 c_x,  F_y = -m w^2 c_y + m g,  T = m g c_x      with the centre of mass c(t) of box and fill
 *
 * For c = r (cos theta, sin theta) these are [L18] Eq. 20-22 with signs that agree for counter-clockwise theta.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/math/hermite.h"
#include "scenarios/rigid_fill.h"
#include "scenarios/table.h"

#include <math.h>
#include <stdio.h>

static const double least_nse = 0.999;
static const double skipped = 0.25; /* [s] the start-up, as in the paper */

typedef struct {
  double rate, rise; /* [rad/s], [s] */
} motion;

static motion read_motion(const scn_result *r, tdm_error *err) {
  return (motion){scn_number(r->scene, "mbd.drivers[0].motion.rate", err),
                  scn_number_or(r->scene, "mbd.drivers[0].motion.rise", 0)};
}

/* Angle after a smooth start: rate w (10 s^3 - 15 s^4 + 6 s^5), s = t/rise, then w. */
static double angle_at(motion m, double t) {
  if (t >= m.rise)
    return m.rate * (t - 0.5 * m.rise);
  double s = t / m.rise;
  return m.rate * m.rise * s * s * s * s * (2.5 - 3 * s + s * s);
}

/* How far a path inside a window is from the arc that the box's centre goes, for windows of n steps. */
static void path_errors(double radius, double rate, double h, double *linear, double *hermite) {
  *linear = *hermite = 0;
  double turn = rate * h; /* the window from angle -turn/2 to turn/2 */
  double x0 = radius * cos(turn / 2), y0 = -radius * sin(turn / 2), v = radius * rate;
  double vx0 = v * sin(turn / 2), vy0 = v * cos(turn / 2);
  for (double s = 0; s <= 1; s += 1.0 / 256) {
    double x = radius * cos(turn * (s - 0.5)), y = radius * sin(turn * (s - 0.5));
    const tdm_hermite_weights w = tdm_hermite_at(s, 1);
    *linear = fmax(*linear, hypot(x0 - x, y0 - 2 * s * y0 - y));
    *hermite =
        fmax(*hermite, hypot(x0 + h * vx0 * (w.d0 - w.d1) - x, y0 - 2 * w.f1 * y0 + h * vy0 * (w.d0 + w.d1) - y));
  }
}

/* The channels that are compared, and room for their curves. */
typedef struct {
  const double *time, *fx, *fy, *torque;
} channels;

static bool find_channels(const cpl_table *mbd, channels *c, tdm_error *err) {
  c->time = cpl_table_column(mbd, "time", err);
  c->fx = c->time ? cpl_table_column(mbd, "joint.pivot.fx", err) : NULL;
  c->fy = c->fx ? cpl_table_column(mbd, "joint.pivot.fy", err) : NULL;
  c->torque = c->fy ? cpl_table_column(mbd, "driver.motor.torque", err) : NULL;
  return c->torque != NULL;
}

static void fill_curves(const channels *ch, const scn_rigid_fill *f, motion m, cpl_comparison *c, tdm_error *err) {
  cpl_compared *torque = cpl_comparison_add(c, "torque", "N m", CPL_STATE, "Torque of the motor", err);
  cpl_compared *fx = cpl_comparison_add(c, "fx", "N", CPL_STATE, "Force of the joint on the box, x", err);
  cpl_compared *fy = cpl_comparison_add(c, "fy", "N", CPL_STATE, "Force of the joint on the box, y", err);
  for (int i = 0; err->status == TDM_OK && i < c->nrow; i++) {
    double angle = angle_at(m, ch->time[i]);
    double x = f->x * cos(angle) - f->y * sin(angle), y = f->x * sin(angle) + f->y * cos(angle);
    torque->simulation[i] = ch->torque[i];
    fx->simulation[i] = ch->fx[i];
    fy->simulation[i] = ch->fy[i];
    torque->reference[i] = f->mass * f->gravity * x;
    fx->reference[i] = -f->mass * m.rate * m.rate * x;
    fy->reference[i] = -f->mass * m.rate * m.rate * y + f->mass * f->gravity;
    if (ch->time[i] < skipped)
      c->first = i + 1;
  }
}

/* Distances of the paths inside the run's windows, for report. */
static json_t *notes(const scn_result *r, const scn_rigid_fill *f, motion m) {
  double h = scn_number_or(r->scene, "coupling.n", 0) * scn_number_or(r->scene, "time.dt", 0), linear, hermite;
  path_errors(f->radius, m.rate, h, &linear, &hermite);
  return json_pack("{s:f, s:f}", "largest distance of the linear path from the arc [m]", linear,
                   "largest distance of the Hermite path from the arc [m]", hermite);
}

tdm_status scn_pendulum_compare(const char *dir, cpl_comparison *c, tdm_error *err) {
  scn_result r = {0};
  scn_rigid_fill f = {0};
  channels ch;
  if (scn_result_read(&r, dir, err) == TDM_OK && scn_rigid_fill_read(&r, &f, err) == TDM_OK) {
    motion m = read_motion(&r, err);
    if (err->status == TDM_OK && find_channels(&r.mbd, &ch, err) &&
        cpl_comparison_init(c, r.mbd.nrow, ch.time, err) == TDM_OK) {
      fill_curves(&ch, &f, m, c, err);
      c->notes = notes(&r, &f, m);
    }
  }
  scn_result_free(&r);
  return err->status;
}

/* Eq. 22 as printed, the whole mass at r, beside the reference with the fill's own centre of mass. */
static void measure_at_r(cpl_verify *v, const char *dir, const cpl_comparison *c, tdm_error *err) {
  scn_result r = {0};
  scn_rigid_fill f = {0};
  cpl_comparison printed = {0};
  channels ch;
  if (scn_result_read(&r, dir, err) == TDM_OK && scn_rigid_fill_read(&r, &f, err) == TDM_OK &&
      find_channels(&r.mbd, &ch, err) && cpl_comparison_init(&printed, r.mbd.nrow, ch.time, err) == TDM_OK) {
    f.x = f.radius;
    f.y = 0;
    fill_curves(&ch, &f, read_motion(&r, err), &printed, err);
    printed.first = c->first;
    for (int i = 0; i < printed.ncurve; i++) {
      char name[64];
      snprintf(name, sizeof name, "nse_%s", printed.curve[i].name);
      cpl_verify_measure(v, name, "centre at r", cpl_comparison_nse(&printed, &printed.curve[i]), CPL_NO_LIMIT, 0);
    }
  }
  cpl_comparison_free(&printed);
  scn_result_free(&r);
}

/* A chord is not an arc: what windows of 10, 100 and 1000 steps would make of the box's path. */
static void measure_paths(cpl_verify *v) {
  static const int steps[] = {10, 100, 1000};
  const double radius = 1.5, rate = 72 * M_PI / 180, dt = 1e-4;
  for (int i = 0; i < 3; i++) {
    double linear, hermite;
    char name[32];
    snprintf(name, sizeof name, "n=%d", steps[i]);
    path_errors(radius, rate, steps[i] * dt, &linear, &hermite);
    cpl_verify_measure(v, "path_linear_m", name, linear, CPL_NO_LIMIT, 0);
    cpl_verify_measure(v, "path_hermite_m", name, hermite, CPL_NO_LIMIT, 0);
  }
}

tdm_status scn_pendulum(cpl_verify *v, tdm_error *err) {
  char dir[4096];
  cpl_comparison c = {0};
  if (scn_verify_run_and_compare(v, true, least_nse, dir, sizeof dir, &c, err) == TDM_OK) {
    measure_at_r(v, dir, &c, err);
    measure_paths(v);
  }
  cpl_comparison_free(&c);
  return err->status;
}
