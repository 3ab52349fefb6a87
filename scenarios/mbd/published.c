/* Mechanisms of the literature with a reference solution: digits, drift of joints, energy and angular momentum, run
 * time at the tightest tolerance that the default formulation gets through; error over run time of all formulations.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/mbd/mechanism.h"
#include "scenarios/table.h"

#include "protocol/results/results.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double least_digits = 8, most_drift = 1e-9; /* [m] */

/* ---- the mechanisms ---- */

#define CHANNEL(column, name) \
  { column, SCN_CHANNEL, name, NULL, 0 }
#define POINT(body) CHANNEL("x", "body." body ".x"), CHANNEL("y", "body." body ".y"), CHANNEL("z", "body." body ".z")
#define ROTATION(body) \
  { "q0", SCN_ROTATION, body, NULL, 0 }

static const scn_mechanism pendulum_a01 = {
    .name = "pendulum_a01",
    .at = 10,
    .absolute = 0,
    .coordinate = {CHANNEL("x", "body.mass.x"), CHANNEL("y", "body.mass.y")},
};

static const scn_mechanism double_pendulum = {
    .name = "double_pendulum",
    .at = 2,
    .absolute = 0,
    .coordinate = {{"phi1", SCN_ANGLE, "upper", NULL, M_PI / 2}, {"phi2", SCN_ANGLE, "lower", NULL, M_PI / 2}},
};

static const scn_mechanism slider_crank = {
    .name = "slider_crank",
    .at = 1,
    .absolute = 0,
    .coordinate = {{"theta", SCN_ANGLE, "crank", NULL, 0}, CHANNEL("x_slider", "body.slider.x")},
};

static const scn_mechanism car_axis = {
    .name = "car_axis",
    .at = 3,
    .absolute = 0,
    .coordinate = {CHANNEL("xl", "body.left.x"), CHANNEL("yl", "body.left.y"), CHANNEL("xr", "body.right.x"),
                   CHANNEL("yr", "body.right.y")},
};

static const scn_mechanism heavy_top = {
    .name = "heavy_top",
    .at = 2,
    .absolute = 10,
    .coordinate = {POINT("top"), ROTATION("top")},
    .body = "top",
    .momentum = SCN_VERTICAL_MOMENTUM,
    .turns = 100 * 2 * M_PI / 150,
};

static const scn_mechanism regular_precession = {
    .name = "regular_precession",
    .at = 4,
    .absolute = 1,
    .coordinate = {POINT("top"), ROTATION("top")},
    .body = "top",
    .momentum = SCN_VERTICAL_MOMENTUM,
    .turns = 100 * 2 * M_PI / 200,
};

static const scn_mechanism torque_free = {
    .name = "torque_free",
    .at = 4, /* after the first flip; later errors grow a hundredfold a flip */
    .absolute = 0,
    .coordinate = {ROTATION("body")},
    .body = "body",
    .momentum = SCN_WHOLE_MOMENTUM,
    .turns = 100,
};

/* seven bodies, angles as in Hairer & Wanner II, chapter VII.7 */
static const scn_mechanism andrews = {
    .name = "andrews",
    .at = 0.03,
    .absolute = 1,
    .coordinate = {{"q_beta", SCN_ANGLE, "K1", NULL, 0},
                   {"q_theta", SCN_ANGLE, "K2", "K1", 0},
                   {"q_gamma", SCN_ANGLE, "K3", NULL, 0},
                   {"q_phi", SCN_ANGLE, "K4", "K5", 0},
                   {"q_delta", SCN_ANGLE, "K5", NULL, 0},
                   {"q_omega", SCN_ANGLE, "K6", "K7", 0},
                   {"q_eps", SCN_ANGLE, "K7", NULL, 0}},
};

/* ---- angular momentum ---- */

static tdm_vec3 vector_at(const scn_motion *m, const char *body, const char *x, const char *y, const char *z, int i) {
  int at = i * m->nchannel;
  return tdm_v3(scn_motion_channel(m, "body.%s.%s", body, x)[at], scn_motion_channel(m, "body.%s.%s", body, y)[at],
                scn_motion_channel(m, "body.%s.%s", body, z)[at]);
}

/* of the scene's only body about the origin, at sample i [kg m2/s] */
static tdm_vec3 momentum_at(const scn_motion *m, const json_t *body, int i) {
  const char *name = json_string_value(json_object_get(body, "name"));
  const json_t *inertia = json_object_get(body, "inertia");
  double mass = json_number_value(json_object_get(body, "mass"));
  tdm_vec3 r = vector_at(m, name, "x", "y", "z", i), v = vector_at(m, name, "vx", "vy", "vz", i);
  tdm_vec3 w = vector_at(m, name, "wx", "wy", "wz", i), u = vector_at(m, name, "qx", "qy", "qz", i);
  tdm_quat q = {scn_motion_channel(m, "body.%s.qw", name)[i * m->nchannel], u.x, u.y, u.z};
  tdm_vec3 own = tdm_quat_rotate(tdm_quat_conj(q), w);
  own.x *= json_number_value(json_array_get(inertia, 0));
  own.y *= json_number_value(json_array_get(inertia, 1));
  own.z *= json_number_value(json_array_get(inertia, 2));
  return tdm_axpy(mass, tdm_cross(r, v), tdm_quat_rotate(q, own));
}

static double momentum_drift(const scn_case *c, const scn_motion *m) {
  const json_t *body = json_array_get(json_object_get(c->mbd, "bodies"), 0);
  tdm_vec3 start = momentum_at(m, body, 0);
  bool whole = c->of->momentum == SCN_WHOLE_MOMENTUM;
  double worst = 0;
  for (int i = 0; i < m->nsample; i++) {
    tdm_vec3 change = tdm_sub(momentum_at(m, body, i), start);
    worst = fmax(worst, whole ? tdm_norm(change) : fabs(change.z));
  }
  return worst / (whole ? tdm_norm(start) : fabs(start.z));
}

/* energy and angular momentum over 100 turns */
static tdm_status measure_turns(const scn_case *c, cpl_verify *v, double tolerance, double absolute, double limit,
                                tdm_error *err) {
  scn_motion m = {0};
  char label[64];
  snprintf(label, sizeof label, "100 turns, rtol=%g", tolerance);
  if (scn_motion_run(&m, c->mbd, &scn_methods[SCN_GGL], tolerance, absolute, c->of->turns, 1000, SCN_MOST_STEPS, err) ==
      TDM_OK) {
    cpl_verify_alone(v, CPL_MBD, c->of->turns, m.wall);
    cpl_verify_measure(v, "energy_drift", label, scn_motion_energy_drift(&m), CPL_AT_MOST, limit);
    cpl_verify_measure(v, "momentum_drift", label, momentum_drift(c, &m), CPL_AT_MOST, limit);
  }
  scn_motion_free(&m);
  return err->status;
}

/* ---- what all have ---- */

/* Digits against the reference and drifts at the tightest tolerance, and the run time there. */
static tdm_status measure(const scn_case *c, cpl_verify *v, double digits, double *tolerance, tdm_error *err) {
  scn_motion m = {0}, end = {0};
  char label[32];
  double wall = NAN;
  if (scn_case_tightest(c, v, &m, tolerance, err) == TDM_OK) {
    snprintf(label, sizeof label, "rtol=%g", *tolerance);
    if (scn_case_time(c, &scn_methods[SCN_GGL], *tolerance, c->of->at, SCN_MOST_STEPS, &end, &wall, err) == TDM_OK) {
      cpl_verify_measure(v, "digits", label, scn_digits(scn_case_error(c, &end, c->row, false)), CPL_AT_LEAST, digits);
      cpl_verify_measure(v, "digits_path", label, scn_digits(scn_case_path_error(c, &m)), CPL_NO_LIMIT, 0);
      cpl_verify_measure(v, "constraint_drift_m", label, scn_motion_drift(&m), CPL_AT_MOST, most_drift);
      if (!json_object_get(c->mbd, "drivers") || scn_motion_channel(&m, "energy.supplied")) /* else work is unknown */
        cpl_verify_measure(v, "energy_drift", label, scn_motion_energy_drift(&m), CPL_NO_LIMIT, 0);
      cpl_verify_measure(v, "wall_s", label, wall, CPL_NO_LIMIT, 0);
      cpl_verify_measure(v, "steps", label, (double)end.stats.steps, CPL_NO_LIMIT, 0);
    }
  }
  scn_motion_free(&m);
  scn_motion_free(&end);
  return err->status;
}

static tdm_status verify(cpl_verify *v, const scn_mechanism *of, tdm_error *err) {
  scn_case c = {0};
  double tolerance;
  if (scn_case_read(&c, v, of, err) == TDM_OK && tdm_make_directory(cpl_verify_dir(v), err) == TDM_OK &&
      measure(&c, v, least_digits, &tolerance, err) == TDM_OK &&
      (of->turns == 0 || (measure_turns(&c, v, 1e-10, 0.01, 1e-7, err) == TDM_OK &&
                          measure_turns(&c, v, tolerance, of->absolute, 2e-9, err) == TDM_OK)))
    scn_work_precision(&c, v, err);
  scn_case_free(&c);
  return err->status;
}

tdm_status scn_pendulum_a01(cpl_verify *v, tdm_error *err) {
  return verify(v, &pendulum_a01, err);
}

tdm_status scn_double_pendulum(cpl_verify *v, tdm_error *err) {
  return verify(v, &double_pendulum, err);
}

tdm_status scn_slider_crank(cpl_verify *v, tdm_error *err) {
  return verify(v, &slider_crank, err);
}

tdm_status scn_car_axis(cpl_verify *v, tdm_error *err) {
  return verify(v, &car_axis, err);
}

tdm_status scn_heavy_top(cpl_verify *v, tdm_error *err) {
  return verify(v, &heavy_top, err);
}

tdm_status scn_regular_precession(cpl_verify *v, tdm_error *err) {
  return verify(v, &regular_precession, err);
}

tdm_status scn_torque_free(cpl_verify *v, tdm_error *err) {
  return verify(v, &torque_free, err);
}

/* ---- Andrews' mechanism ---- */

/* angles at 0.03 s as the IVP test set gives them (PSIDE, tolerance 1e-14) */
static const double published_angles[] = {15.81077119629904,   -15.75637105984298, 0.04082224013073101,
                                          -0.5347301163226948, 0.5244099658805303, 0.5347301163226948,
                                          1.048080741042263};

/* Put the published angles in the place of those of the reference, or back. */
static tdm_status swap_reference(scn_case *c, double angle[7], tdm_error *err) {
  for (int k = 0; k < 7; k++) {
    double *column = (double *)cpl_table_column(&c->reference, c->of->coordinate[k].column, err), old;
    if (!column)
      return err->status;
    old = column[c->row];
    column[c->row] = angle[k];
    angle[k] = old;
  }
  return TDM_OK;
}

/* the best that one method reaches at any tolerance, against the computed reference */
static void measure_best(const scn_case *c, cpl_verify *v, const scn_method *method, double least) {
  double best = 0, wall = 0;
  for (int k = 4; k <= 10; k++) {
    scn_motion m = {0};
    tdm_error failed = {0};
    double now;
    if (scn_case_time(c, method, pow(10, -k), c->of->at, SCN_MOST_STEPS, &m, &now, &failed) == TDM_OK) {
      best = fmax(best, scn_digits(scn_case_error(c, &m, c->row, false)));
      wall = now;
    }
    scn_motion_free(&m);
    if (failed.status != TDM_OK)
      break;
  }
  cpl_verify_alone(v, CPL_MBD, c->of->at, wall);
  cpl_verify_measure(v, "digits", method->name, best, CPL_AT_LEAST, least);
}

/* Run time to 0.05 s of the loosest run whose error there is at most `error`, against 0.384 s of OpenSim 3.2 at
 * accuracy 1e-8 (IFToMM benchmark library, Intel i5-4570), whose error is not published. */
static void measure_speed(const scn_case *c, cpl_verify *v, double published, double error) {
  const int row = c->reference.nrow - 1;
  const double last = 0.05;
  double wall = NAN;
  char label[32];
  for (int k = 6; k <= 13; k++) {
    scn_motion m = {0};
    tdm_error failed = {0};
    bool good =
        scn_case_time(c, &scn_methods[SCN_GGL], pow(10, -k), last, SCN_MOST_STEPS, &m, &wall, &failed) == TDM_OK &&
        scn_case_error(c, &m, row, false) <= error;
    scn_motion_free(&m);
    if (good)
      break;
    wall = NAN;
  }
  cpl_verify_alone(v, CPL_MBD, last, wall);
  snprintf(label, sizeof label, "error<=%g", error);
  cpl_verify_measure(v, "wall_s", label, wall, CPL_NO_LIMIT, 0);
  cpl_verify_measure(v, "times_faster", label, published / wall, CPL_NO_LIMIT, 0);
}

tdm_status scn_andrews(cpl_verify *v, tdm_error *err) {
  scn_case c = {0};
  double tolerance, angle[7];
  memcpy(angle, published_angles, sizeof angle);
  if (scn_case_read(&c, v, &andrews, err) == TDM_OK && tdm_make_directory(cpl_verify_dir(v), err) == TDM_OK &&
      measure(&c, v, 9.5, &tolerance, err) == TDM_OK && swap_reference(&c, angle, err) == TDM_OK) {
    scn_motion m = {0};
    if (scn_motion_run(&m, c.mbd, &scn_methods[SCN_GGL], tolerance, andrews.absolute, andrews.at, 1, SCN_MOST_STEPS,
                       err) == TDM_OK)
      cpl_verify_measure(v, "digits", "published", scn_digits(scn_case_error(&c, &m, c.row, false)), CPL_AT_LEAST, 8);
    scn_motion_free(&m);
    swap_reference(&c, angle, err);
    measure_best(&c, v, &scn_methods[SCN_INDEX3_MODIFIED], 4);
    measure_speed(&c, v, 0.384, 1e-6);
    measure_speed(&c, v, 0.384, 1e-8);
    scn_work_precision(&c, v, err);
  }
  scn_case_free(&c);
  return err->status;
}
