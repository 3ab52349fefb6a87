/* IFToMM benchmark A02: N four-bar windows side by side, 2 N + 1 rods, through their singular positions.
 *
 * On the parallelogram's branch all cranks turn alike, and the couplers do not turn:
 *   phi'' = c sin(phi),  c = (g/l) ((N + 1)/2 + N)/((N + 1)/3 + N),  phi from upright, phi(0) = 0, phi'(0) = v/l
 * Where the rods are horizontal the joints' Jacobian loses rank, and another branch begins there on which energy is
 * kept as well: only the angle tells.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/app/command_line.h"
#include "scenarios/mbd/mechanism.h"
#include "scenarios/table.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static const double end = 10, gravity = 9.81; /* [s], [m/s2] */
static const double most_angle = 1e-6, most_energy = 1e-6, most_drift = 1e-9;
/* Near a singular position rounding errors in velocities grow as the square of the distance to it falls: the modified
 * corrector leaves them out of the error test, and an absolute tolerance as large as the relative one gives room. The
 * accuracy of the angle comes from the longest step. */
static const double absolute = 1, tolerance = 1e-11, longest_step = 1.2e-3; /* [1], [1], [s] */
static const int sizes[] = {1, 2, 10, 40, 100};
enum { NSIZE = sizeof sizes / sizeof sizes[0], STEPS = 100 };

/* ---- scene ---- */

static json_t *body(const char *kind, int i, double x, double y, double speed, double spin) {
  char name[32];
  snprintf(name, sizeof name, "%s%d", kind, i);
  bool upright = spin != 0;
  double slender = 1.0 / 12, along = 0.01;
  return json_pack("{s:s, s:f, s:[f, f, f], s:[f, f, f], s:[f, f, f], s:[f, f, f]}", "name", name, "mass", 1.0,
                   "inertia", upright ? slender : along, upright ? along : slender, slender, "position", x, y, 0.0,
                   "velocity", speed, 0.0, 0.0, "angular_velocity", 0.0, 0.0, spin);
}

static json_t *joint(const char *kind, const char *type, int i, const char *a, int ia, const char *b, int ib,
                     double y) {
  char name[32], first[32], second[32];
  snprintf(name, sizeof name, "%s%d", kind, i);
  snprintf(first, sizeof first, "%s%d", a, ia);
  snprintf(second, sizeof second, "%s%d", b, ib);
  return json_pack("{s:s, s:s, s:[s, s], s:[f, f, f], s:[f, f, f]}", "name", name, "type", type, "bodies",
                   ia < 0 ? a : first, second, "point", (double)i, y, 0.0, "axis", 0.0, 0.0, 1.0);
}

/* The section mbd for n windows, hinges throughout: each loop has three redundant rows. Window by window, so that the
 * matrices are banded. */
static json_t *fourbar(int n) {
  json_t *bodies = json_array(), *joints = json_array();
  for (int i = 0; i <= n; i++) {
    json_array_append_new(bodies, body("crank", i, i, 0.5, 0.5, -1));
    json_array_append_new(joints, joint("A", "revolute", i, "ground", -1, "crank", i, 0));
    if (i > 0)
      json_array_append_new(joints, joint("C", "revolute", i, "coupler", i - 1, "crank", i, 1));
    if (i == n)
      break;
    json_array_append_new(bodies, body("coupler", i, i + 0.5, 1, 1, 0));
    json_array_append_new(joints, joint("B", "revolute", i, "crank", i, "coupler", i, 1));
  }
  return json_pack("{s:[f, f, f], s:o, s:o}", "gravity", 0.0, -gravity, 0.0, "bodies", bodies, "joints", joints);
}

/* ---- reference ---- */

static int swing(double t, const double y[], double dydt[], void *c) {
  (void)t;
  dydt[0] = y[1];
  dydt[1] = *(double *)c * sin(y[0]);
  return GSL_SUCCESS;
}

/* phi at the samples */
static bool reference(int n, double phi[STEPS + 1]) {
  double c = gravity * (0.5 * (n + 1) + n) / ((n + 1) / 3.0 + n), y[2] = {0, 1}, t = 0;
  gsl_odeiv2_system system = {swing, NULL, 2, &c};
  gsl_odeiv2_driver *d = gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-4, 1e-14, 1e-14);
  bool good = d != NULL;
  for (int i = 0; i <= STEPS && good; i++) {
    good = gsl_odeiv2_driver_apply(d, &t, end * i / STEPS, y) == GSL_SUCCESS;
    phi[i] = y[0];
  }
  gsl_odeiv2_driver_free(d);
  return good;
}

/* ---- measures ---- */

/* the largest deviation of a crank from the reference */
static double angle_error(const scn_motion *m, int n) {
  double phi[STEPS + 1], *angle = calloc((size_t)m->nsample, sizeof *angle), worst = 0;
  bool good = angle && reference(n, phi);
  for (int k = 0; k <= n && good; k++) {
    char name[32];
    snprintf(name, sizeof name, "crank%d", k);
    good = scn_motion_angle(m, name, angle);
    for (int i = 0; i < m->nsample && good; i++)
      worst = fmax(worst, fabs(angle[i] + phi[i]));
  }
  free(angle);
  return good ? worst : NAN;
}

static void measure(cpl_verify *v, const char *label, int n, const scn_motion *m, bool done) {
  cpl_verify_alone(v, CPL_MBD, done ? end : 0, m->wall);
  cpl_verify_measure(v, "angle_error_rad", label, done ? angle_error(m, n) : NAN, CPL_AT_MOST, most_angle);
  cpl_verify_measure(v, "energy_drift", label, done ? scn_motion_energy_drift(m) : NAN, CPL_AT_MOST, most_energy);
  cpl_verify_measure(v, "constraint_drift_m", label, done ? scn_motion_drift(m) : NAN, CPL_AT_MOST, most_drift);
  cpl_verify_measure(v, "wall_s", label, done ? m->wall : NAN, CPL_NO_LIMIT, 0);
}

/* Run time of the loosest run of N = 2 whose error is at most `error` [rad], against 0.455 s of OpenSim 3.2 at accuracy
 * 1e-6 (IFToMM benchmark library, Intel i5-4570), whose error is not published. */
static void measure_speed(cpl_verify *v, double error) {
  const double published = 0.455;
  char label[32];
  json_t *mbd = fourbar(2);
  double wall = NAN;
  for (int k = 4; k <= 12 && isnan(wall) && !tdm_interrupted; k++) {
    scn_motion m = {0}, timed = {0};
    tdm_error failed = {0};
    if (scn_motion_run(&m, mbd, &scn_methods[SCN_GGL_MODIFIED], pow(10, -k), absolute, end, STEPS, 10, &failed) ==
            TDM_OK &&
        angle_error(&m, 2) <= error &&
        scn_motion_run(&timed, mbd, &scn_methods[SCN_GGL_MODIFIED], pow(10, -k), absolute, end, 1, 10, &failed) ==
            TDM_OK)
      wall = timed.wall;
    scn_motion_free(&m);
    scn_motion_free(&timed);
  }
  json_decref(mbd);
  cpl_verify_alone(v, CPL_MBD, isnan(wall) ? 0 : end, wall);
  snprintf(label, sizeof label, "N=2, error<=%g", error);
  cpl_verify_measure(v, "wall_s", label, wall, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "times_faster", label, published / wall, CPL_NO_LIMIT, 0);
}

tdm_status scn_fourbar_a02(cpl_verify *v, tdm_error *err) {
  double wall[NSIZE];
  tdm_error first = {0};
  measure_speed(v, 1e-3);
  measure_speed(v, 1e-6);
  for (int k = 0; k < NSIZE && first.status != TDM_ERR_INTERRUPTED; k++) {
    tdm_error failed = {0};
    scn_motion m = {0};
    char label[32];
    json_t *mbd = fourbar(sizes[k]);
    json_object_set_new(mbd, "solver", json_pack("{s:f}", "max_step", longest_step));
    snprintf(label, sizeof label, "N=%d", sizes[k]);
    bool done = scn_motion_run(&m, mbd, &scn_methods[SCN_GGL_MODIFIED], tolerance, absolute, end, STEPS, SCN_MOST_STEPS,
                               &failed) == TDM_OK;
    measure(v, label, sizes[k], &m, done);
    wall[k] = done ? m.wall : NAN;
    if (!done && first.status == TDM_OK)
      tdm_fail(&first, failed.status, NULL, "N = %d: %s", sizes[k], failed.message);
    scn_motion_free(&m);
    json_decref(mbd);
  }
  for (int k = 3; k < NSIZE && first.status != TDM_ERR_INTERRUPTED; k++) {
    char label[32];
    snprintf(label, sizeof label, "N=%d to %d", sizes[k - 1], sizes[k]);
    cpl_verify_measure(v, "growth", label, wall[k] / wall[k - 1] * sizes[k - 1] / sizes[k], CPL_NO_LIMIT, 0);
  }
  *err = first;
  return err->status;
}
