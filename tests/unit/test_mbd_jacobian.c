/* The analytic Jacobian against central differences of the residual, on random states (off the constraints and off the
 * unit sphere), for every joint, driver and force, between two bodies and against the ground.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/driver/table.h"
#include "mbd/equations/jacobian.h"
#include "mbd/equations/residual.h"
#include "mbd/equations/tangent.h"
#include "mbd/force/table.h"
#include "mbd/joint/table.h"
#include "mbd/scene/scene.h"
#include "protocol/math/random.h"
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

#define BODIES                                                                                      \
  "'bodies':[{'name':'a','mass':2,'inertia':[1.1,1.4,1.9,0.1,-0.2,0.05],'position':[0.3,-0.2,0.5]," \
  "'orientation':[0.9,0.1,-0.3,0.2]},{'name':'b','mass':3,'inertia':[0.7,0.8,0.6],'position':[-1,0.4,0.2]}]"
#define JOINT(type, rest) "{" BODIES ",'joints':[{'name':'j','type':'" type "','bodies':" rest "}]}"
#define PAIR(first, second, type, rest)                                                                          \
  "{" BODIES ",'joints':[{'name':'j','type':'" first "','bodies':['ground','a'],'point':[0.1,0.2,0.3],"          \
  "'axis':[1,2,-1]},{'name':'k','type':'" second "','bodies':['a','b'],'point':[0.3,0.1,-0.3],'axis':[0,2,-1]}," \
  "{'name':'p','type':'" type "','joints':['j','k']," rest "}]}"
#define TRIO(rest)                                                                                                \
  "{" BODIES ",'joints':[{'name':'j','type':'revolute','bodies':['ground','a'],'point':[0.1,0.2,0.3],"            \
  "'axis':[1,2,-1]},{'name':'k','type':'cylindrical','bodies':['a','b'],'point':[0.3,0.1,-0.3],'axis':[0,2,-1]}," \
  "{'name':'l','type':'prismatic','bodies':['ground','b'],'point':[0.3,0.1,-0.3],'axis':[0,2,-1]},"               \
  "{'name':'p','type':'coupler'," rest "}]}"
#define DRIVER(type, bodies, axes, motion)                                                                    \
  "{" BODIES ",'joints':[{'name':'j','type':'revolute','bodies':" bodies ",'point':[0.1,0.2,0.3]," axes "}]," \
  "'drivers':[{'name':'d','type':'" type "','joint':'j','motion':{" motion "}}]}"
#define FORCE(type, rest) \
  "{" BODIES ",'forces':[{'name':'f','type':'" type "','stiffness':40,'damping':3,'preload':5," rest "}]}"
#define PLAIN(type, rest) "{" BODIES ",'forces':[{'name':'f','type':'" type "'," rest "}]}"
#define ON_JOINT(type, rest)                                                                                           \
  "{" BODIES ",'joints':[{'name':'j','type':'cylindrical','bodies':['a','b'],'point':[0.1,0.2,0.3],'axis':[1,2,-1]}]," \
  "'forces':[{'name':'f','type':'" type "','joint':'j'," rest "}]}"

static const char *const scenes[] = {
    "{" BODIES "}",
    JOINT("fixed", "['a','b'],'point':[0.1,0.2,0.3]"),
    JOINT("fixed", "['ground','b'],'point':[0.1,0.2,0.3]"),
    JOINT("revolute", "['a','b'],'point':[0.1,0.2,0.3],'axis':[1,2,-1]"),
    JOINT("revolute", "['b','ground'],'point':[0.1,0.2,0.3],'axis':[1,2,-1]"),
    JOINT("prismatic", "['a','b'],'point':[0.1,0.2,0.3],'axis':[1,-2,1]"),
    JOINT("prismatic", "['ground','a'],'point':[0.1,0.2,0.3],'axis':[0,0,1]"),
    JOINT("prismatic", "['a','ground'],'point':[0.1,0.2,0.3],'axis':[0,0,1]"),
    JOINT("spherical", "['a','b'],'point':[0.1,0.2,0.3]"),
    JOINT("cylindrical", "['a','b'],'point':[0.1,0.2,0.3],'axis':[1,2,-1]"),
    JOINT("universal", "['a','b'],'point':[0.1,0.2,0.3],'axes':[[1,2,-1],[1,0,1]]"),
    JOINT("universal", "['ground','b'],'point':[0.1,0.2,0.3],'axes':[[1,2,-1],[1,0,1]]"),
    JOINT("planar", "['a','b'],'point':[0.1,0.2,0.3],'axis':[1,2,-1]"),
    JOINT("planar", "['b','ground'],'point':[0.1,0.2,0.3],'axis':[1,2,-1]"),
    JOINT("point_in_plane", "['a','b'],'points':[[0.1,0.2,0.3],[0.3,0.3,0.3]],'axis':[1,2,-1]"),
    JOINT("parallel_axes", "['a','b'],'point':[0.1,0.2,0.3],'axis':[1,2,-1]"),
    JOINT("revolute_spherical", "['a','b'],'points':[[0.1,0.2,0.3],[0.4,0.9,0.5]],'axis':[1,0.5,-1]"),
    JOINT("point_on_line", "['a','b'],'points':[[0.1,0.2,0.3],[0.3,0.3,0.3]],'axis':[1,2,-1]"),
    JOINT("rod", "['a','b'],'points':[[0.1,0.2,0.3],[2,0.4,0.3]]"),
    JOINT("rod", "['ground','b'],'points':[[0.1,0.2,0.3],[2,0.4,0.3]],'length':0.7"),
    JOINT("screw", "['a','b'],'point':[0.1,0.2,0.3],'axis':[1,2,-1],'pitch':0.8"),
    JOINT("screw", "['b','ground'],'point':[0.1,0.2,0.3],'axis':[1,2,-1],'pitch':-3"),
    PAIR("revolute", "cylindrical", "gear", "'ratio':1.7"),
    PAIR("cylindrical", "revolute", "gear", "'ratio':-2"),
    PAIR("revolute", "prismatic", "rack_and_pinion", "'radius':0.3"),
    TRIO("'joints':['j','k','l'],'coordinates':['angle','translation','translation'],'scales':[2,-1.5,0.7]"),
    TRIO("'joints':['k','j'],'coordinates':['angle','angle'],'scales':[3,1]"),
    DRIVER("rotational_motor", "['a','b']", "'axis':[1,2,-1]",
           "'type':'constant_rate','rate':3,'start':'smooth','rise':0.5"),
    DRIVER("rotational_motor", "['ground','b']", "'axis':[1,2,-1]", "'type':'constant_rate','rate':-7,'start':'step'"),
    DRIVER("rotational_motor", "['b','ground']", "'axes':[[1,2,-1],[0,1,-1]]",
           "'type':'constant_rate','rate':20,'start':'step'"),
    DRIVER("rotational_motor", "['a','b']", "'axis':[1,2,-1]", "'type':'constant','value':0.3"),
    DRIVER("rotational_motor", "['a','b']", "'axis':[1,2,-1]", "'type':'polynomial','coefficients':[0.3,2,-4]"),
    DRIVER("rotational_motor", "['a','b']", "'axis':[1,2,-1]", "'type':'harmonic','amplitude':2,'frequency':1"),
    DRIVER("rotational_motor", "['a','b']", "'axis':[1,2,-1]", "'type':'step','to':2,'rise':0.7"),
    DRIVER("rotational_motor", "['a','b']", "'axis':[1,2,-1]", "'type':'step','to':2,'rise':0.7,'shape':'cubic'"),
    DRIVER("rotational_motor", "['a','b']", "'axis':[1,2,-1]", "'type':'ramp','rate':2,'rise':0.7"),
    DRIVER("rotational_motor", "['a','b']", "'axis':[1,2,-1]", "'type':'ramp','rate':2,'rise':0.7,'shape':'cubic'"),
    DRIVER("rotational_motor", "['a','b']", "'axis':[1,2,-1]",
           "'type':'table','times':[0,0.2,0.4,1],'values':[0,0.1,0.3,-0.2]"),
    DRIVER("rotational_motor", "['a','b']", "'axis':[1,2,-1]",
           "'type':'sum','laws':[{'type':'constant_rate','rate':-3,'start':'step'},"
           "{'type':'triangle','rate':4,'period':0.6,'corner':0.2}]"),
    "{" BODIES ",'joints':[{'name':'j','type':'cylindrical','bodies':['a','b'],'point':[0.1,0.2,0.3],'axis':[1,2,-1]}],"
    "'drivers':[{'name':'d','type':'linear_motor','joint':'j','motion':{'type':'constant_rate','rate':2,'start':'step'}"
    "},"
    "{'name':'e','type':'point_motion','bodies':['a','b'],'point':[1,2,3],'direction':[1,0,1],'motion':{'type':"
    "'constant_rate','rate':2,'start':'step'}},"
    "{'name':'f','type':'orientation_motion','bodies':['b','ground'],'axis':[1,0,1],'motion':{'type':"
    "'constant_rate','rate':2,'start':'step'}}]}",
    FORCE("spring_damper", "'bodies':['a','b'],'points':[[0.1,0.2,0.3],[1,0,2]],'free_length':0.7"),
    FORCE("spring_damper", "'bodies':['ground','b'],'points':[[0.1,0.2,0.3],[1,0,2]]"),
    FORCE("spring_damper", "'bodies':['a','ground'],'points':[[0.1,0.2,0.3],[1,0,2]]"),
    FORCE("torsional_spring_damper", "'bodies':['a','b'],'axis':[1,1,0.5],'free_angle':0.4"),
    FORCE("torsional_spring_damper", "'bodies':['ground','b'],'axis':[0,1,0]"),
    FORCE("torsional_spring_damper", "'bodies':['b','ground'],'axis':[0,1,0]"),
    PLAIN("spring_damper", "'bodies':['a','b'],'points':[[0.1,0.2,0.3],[1,0,2]],"
                           "'stiffness_table':[[-2,-1,0,1,2],[-9,-2,0,1,4]],'damping_table':[[-4,-1,0,1,4],"
                           "[-2,-1,0,3,5]]"),
    PLAIN("torsional_spring_damper", "'bodies':['a','b'],'axis':[1,1,0.5],"
                                     "'stiffness_table':[[-2,-1,0,1,2],[-9,-2,0,1,4]],'interpolation':'steffen'"),
    PLAIN("cable", "'bodies':['a','b'],'points':[[0.1,0.2,0.3],[1,0,2]],'free_length':0.01,'stiffness':50,"
                   "'damping':1"),
    PLAIN("cable", "'bodies':['ground','b'],'points':[[0.1,0.2,0.3],[1,0,2]],'free_length':0.01,'stiffness':50,"
                   "'damping':0.3,'smoothing':20"),
    PLAIN("bushing", "'bodies':['a','b'],'points':[[0.1,0.2,0.3],[0.3,0.2,0.4]],'stiffness':[30,20,10,7,5,8],"
                     "'damping':[3,2,1,0.7,0.5,0.8],'preload':[1,2,3,4,5,6]"),
    PLAIN("bushing",
          "'bodies':['ground','b'],'point':[0.1,0.2,0.3],'orientation':[1,0.3,0.2,0.1],'stiffness':"
          "[[30,2,1,3,2,1],[2,20,4,1,2,3],[1,4,10,1,1,1],[3,1,1,9,2,1],[2,2,1,2,8,1],[1,3,1,1,1,7]],'damping':"
          "[[3,1,0,0,1,0],[1,2,0,0,0,0],[0,0,1,0,0,0],[0,0,0,1,0,0],[1,0,0,0,1,0],[0,0,0,0,0,1]]"),
    PLAIN("bump", "'bodies':['a','b'],'point':[0.1,0.2,0.3],'radius':40,'plane_point':[1,0,2],'normal':[1,2,1],"
                  "'stiffness':20,'exponent':1.5,'damping':0.01"),
    PLAIN("bump", "'bodies':['ground','b'],'points':[[0.1,0.2,0.3],[1,1,1]],'radii':[10,30],'stiffness':20,"
                  "'damping':0.01"),
    PLAIN("wrench", "'body':'b','point':[0.1,0.2,0.3],'force':[1,2,3],'moment':[4,5,6],'axes':'body'"),
    PLAIN("wrench", "'body':'a','point':[0.1,0.2,0.3],'force':[1,2,3],'moment':[4,5,6],"
                    "'factor':{'type':'harmonic','amplitude':1,'frequency':1}"),
    ON_JOINT("friction", "'coordinate':'angle','limit':{'static':5,'dynamic':3},'velocity_scale':2,'viscous':0.4"),
    ON_JOINT("friction", "'coordinate':'translation','coefficient':0.3,'preload':10,'reaction':false"),
    ON_JOINT("friction", "'coordinate':'translation','coefficient':{'static':0.7,'dynamic':0.4},'velocity_scale':2,"
                         "'length':0.7,'radius':0.4"),
    ON_JOINT("friction", "'coordinate':'angle','coefficient':0.3,'preload':4,'radius':0.3,'thrust_radius':0.5"),
    ON_JOINT("friction", "'coordinate':'angle','coefficient':0.3,'radius':0.3,'length':1.4"),
    ON_JOINT("stop", "'coordinate':'angle','upper':-50,'stiffness':20,'damping':0.01"),
    ON_JOINT("stop", "'coordinate':'translation','lower':50,'stiffness':20,'damping':0.01,'exponent':1.5"),
};

static double uniform(uint64_t *draw) {
  return 2 * tdm_random_next(draw) - 1;
}

/* Frictions slide, this way or that, under a normal force. */
static void slide(const mbd_model *m, mbd_data *d, unsigned seed) {
  for (int k = 0; k < m->nfriction; k++) {
    d->stick[k].way = seed % 4 < 2 ? 1 : -1;
    d->stick[k].normal = 2.5;
  }
}

/* Largest |J - J_fd| relative to the largest entry of its row. */
static double deviation(const mbd_model *m, mbd_data *d, uint64_t draw) {
  const int n = mbd_nunknown(m);
  const double cj = 3.7, eps = 1e-6;
  double *y = calloc((size_t)n, 8), *yp = calloc((size_t)n, 8), *up = calloc((size_t)n, 8),
         *down = calloc((size_t)n, 8);
  double *J = calloc((size_t)(n * n), 8), *D = calloc((size_t)(n * n), 8), worst = 0;
  for (int i = 0; i < n; i++) {
    y[i] = uniform(&draw);
    yp[i] = 2 * uniform(&draw);
  }
  for (int b = 0; b < m->nbody; b++) /* away from the zero quaternion */
    y[MBD_BODY_UNKNOWNS * b + MBD_P] += 1.5;
  mbd_sparse *matrix = mbd_sparse_create(n);
  mbd_sparse_begin(matrix);
  mbd_jacobian(m, d, 0.3, cj, y, yp, matrix);
  ck_assert_int_eq(mbd_sparse_end(matrix), MBD_SPARSE_GREW);
  for (int col = 0; col < n; col++)
    for (int i = matrix->column[col]; i < matrix->column[col + 1]; i++)
      J[col * n + matrix->row[i]] += matrix->value[i];
  mbd_sparse_destroy(&matrix);
  for (int k = 0; k < n; k++) {
    double yk = y[k], ypk = yp[k];
    y[k] = yk + eps, yp[k] = ypk + cj * eps;
    mbd_residual(m, d, 0.3, y, yp, up);
    y[k] = yk - eps, yp[k] = ypk - cj * eps;
    mbd_residual(m, d, 0.3, y, yp, down);
    y[k] = yk, yp[k] = ypk;
    for (int i = 0; i < n; i++)
      D[k * n + i] = (up[i] - down[i]) / (2 * eps);
  }
  for (int i = 0; i < n; i++) {
    double size = 1;
    for (int k = 0; k < n; k++)
      size = fmax(size, fabs(D[k * n + i]));
    for (int k = 0; k < n; k++)
      worst = fmax(worst, fabs(D[k * n + i] - J[k * n + i]) / size);
  }
  free(y), free(yp), free(up), free(down), free(J), free(D);
  return worst;
}

START_TEST(test_jacobian) {
  json_t *json = scene_json("%s", scenes[_i]);
  mbd_model *m = NULL;
  tdm_error err = {0};
  ck_assert_msg(mbd_model_read(&m, json, false, &err) == TDM_OK, "%s: %s", err.path, err.message);
  mbd_data *d = mbd_data_create(m);
  for (unsigned seed = 1; seed <= 20; seed++) {
    d->index3 = seed % 2 == 0;
    slide(m, d, seed);
    double worst = deviation(m, d, seed);
    ck_assert_msg(worst < 1e-7, "scene %s, seed %u: %g", scenes[_i], seed, worst);
  }
  mbd_data_destroy(&d);
  mbd_model_destroy(&m);
  json_decref(json);
}
END_TEST

/* Sum of the forces' power Q.V, potential, and power dissipated and supplied at y. */
static void powers(const mbd_model *m, mbd_data *d, const double *y, double out[4]) {
  memset(out, 0, 4 * sizeof *out);
  mbd_kinematics(m, d, 0.3, y);
  for (int i = 0; i < m->nforce; i++) {
    const mbd_force_value *f = mbd_force_at(m, d, i, false);
    double twist[MBD_PAIR];
    mbd_pair_twist(&d->kin[m->force[i].body[0] + 1], &d->kin[m->force[i].body[1] + 1], twist);
    for (int k = 0; k < MBD_PAIR; k++)
      out[0] += f->Q[k] * twist[k];
    out[1] += f->potential;
    out[2] += f->dissipated;
    out[3] += f->supplied;
  }
}

/* y moved on along its velocities by the time h */
static void move_on(const mbd_model *m, double *y, double h) {
  for (int b = 0; b < m->nbody; b++) {
    tdm_state s = mbd_body_state(y, b);
    s.pose.position = tdm_axpy(h, s.twist.velocity, s.pose.position);
    s.pose.orientation = tdm_quat_mul(tdm_quat_from_rotvec(tdm_scale(h, s.twist.angular)), s.pose.orientation);
    mbd_set_body_state(y, b, &s);
  }
}

/* what forces do is what their potential loses, less heat, plus what comes from outside; heat is not negative */
START_TEST(test_power) {
  json_t *json = scene_json("%s", scenes[_i]);
  mbd_model *m = NULL;
  tdm_error err = {0};
  ck_assert_msg(mbd_model_read(&m, json, false, &err) == TDM_OK, "%s: %s", err.path, err.message);
  mbd_data *d = mbd_data_create(m);
  double *y = calloc((size_t)mbd_nunknown(m), 8), before[4], now[4], after[4];
  for (unsigned s = 1; s <= 20; s++) {
    uint64_t draw = s;
    for (int i = 0; i < MBD_BODY_UNKNOWNS * m->nbody; i++)
      y[i] = uniform(&draw) + (i % MBD_BODY_UNKNOWNS == MBD_P ? 1.5 : 0);
    powers(m, d, y, now);
    move_on(m, y, -1e-6);
    powers(m, d, y, before);
    move_on(m, y, 2e-6);
    powers(m, d, y, after);
    double rate = (after[1] - before[1]) / 2e-6, size = 1 + fabs(now[0]) + fabs(now[1]);
    ck_assert_msg(fabs(now[0] + rate + now[2] - now[3]) < 1e-8 * size, "scene %s, seed %u: %g of %g W missing",
                  scenes[_i], s, now[0] + rate + now[2] - now[3], now[0]);
    ck_assert_double_ge(now[2], 0);
  }
  free(y);
  mbd_data_destroy(&d);
  mbd_model_destroy(&m);
  json_decref(json);
}
END_TEST

/* ---- in twist coordinates ---- */

/* M a - Q + G^T lambda at y (nv) */
static void twist_residual(const mbd_model *m, mbd_data *d, const double *y, const double *a, const double *lambda,
                           double *out) {
  mbd_kinematics(m, d, 0.3, y);
  mbd_generalised_forces(m, d, 0.3, out);
  for (int b = 0; b < m->nbody; b++) {
    tdm_vec3 torque = mbd_inertia_mul(&m->body[b], &d->kin[b + 1], mbd_get3(a + 6 * b + 3));
    for (int i = 0; i < 3; i++)
      out[6 * b + i] = m->body[b].mass * a[6 * b + i] - out[6 * b + i];
    mbd_set3(out + 6 * b + 3, tdm_sub(torque, mbd_get3(out + 6 * b + 3)));
  }
  for (int i = 0; i < m->npart; i++) {
    const mbd_rows *rows = mbd_part_at(m, d, i, false);
    for (int k = 0; k < rows->n; k++)
      for (int c = 0; c < MBD_PAIR; c++)
        if (rows->body[c / 6] != MBD_GROUND)
          out[6 * rows->body[c / 6] + c % 6] += rows->G[k][c] * lambda[rows->first + k];
  }
}

/* coordinate k of the twist `which` (0 acceleration, 1 velocity, 2 pose) changed by eps */
static void nudge(double *y, double *a, int which, int k, double eps) {
  double *u = y + MBD_BODY_UNKNOWNS * (k / 6);
  if (which == 0)
    a[k] += eps;
  else if (which == 1)
    u[MBD_V + k % 6] += eps;
  else if (k % 6 < 3)
    u[MBD_R + k % 6] += eps;
  else {
    tdm_state s = mbd_body_state(y, k / 6);
    double turn[3] = {0};
    turn[k % 6 - 3] = eps;
    s.pose.orientation = tdm_quat_mul(tdm_quat_from_rotvec(mbd_get3(turn)), s.pose.orientation);
    mbd_set_body_state(y, k / 6, &s);
  }
}

enum { NV = 12 };

static void add_entry(void *matrix, int row, int col, double value) {
  ((double *)matrix)[row * NV + col] += value;
}

START_TEST(test_tangent) {
  json_t *json = scene_json("%s", scenes[_i]);
  mbd_model *m = NULL;
  tdm_error err = {0};
  ck_assert_msg(mbd_model_read(&m, json, false, &err) == TDM_OK, "%s: %s", err.path, err.message);
  mbd_data *d = mbd_data_create(m);
  uint64_t draw = 1;
  const double eps = 1e-6;
  double *y = calloc((size_t)mbd_nunknown(m), 8), *lambda = calloc((size_t)m->nrow + 1, 8), a[NV], up[NV], down[NV];
  ck_assert_int_eq(6 * m->nbody, NV);
  slide(m, d, 5);
  for (int i = 0; i < mbd_nunknown(m); i++)
    y[i] = uniform(&draw);
  for (int i = 0; i < m->nrow; i++)
    lambda[i] = uniform(&draw);
  for (int i = 0; i < NV; i++)
    a[i] = uniform(&draw);
  for (int which = 0; which < 3; which++) {
    double matrix[NV * NV] = {0};
    mbd_weights w = {which == 0, which == 1, which == 2};
    mbd_kinematics(m, d, 0.3, y);
    mbd_tangent(m, d, a, lambda, w, add_entry, matrix);
    for (int k = 0; k < NV; k++) {
      tdm_state before = mbd_body_state(y, k / 6);
      for (int side = 1; side >= -1; side -= 2) {
        nudge(y, a, which, k, side * eps);
        twist_residual(m, d, y, a, lambda, side > 0 ? up : down);
        mbd_set_body_state(y, k / 6, &before);
        a[k] -= which == 0 ? side * eps : 0;
      }
      double size = 0; /* rounding of the residuals, over eps */
      for (int i = 0; i < NV; i++)
        size = fmax(size, fabs(up[i]));
      for (int i = 0; i < NV; i++)
        CLOSE(matrix[i * NV + k], (up[i] - down[i]) / (2 * eps), 2e-7 + 5e-10 * size + 1e-8 * fabs(matrix[i * NV + k]));
    }
  }
  free(y);
  free(lambda);
  mbd_data_destroy(&d);
  mbd_model_destroy(&m);
  json_decref(json);
}
END_TEST

/* every type of every table stands in a scene above */
START_TEST(test_all_types) {
  const int nscene = sizeof scenes / sizeof scenes[0];
  const tdm_types *const tables[] = {&mbd_joint_types, &mbd_force_types, &mbd_driver_types, &tdm_motion_types};
  const char *names[4 * TDM_TYPES_MAX];
  int n = 0;
  for (int k = 0; k < 4; k++)
    for (int t = 0; tdm_type_name(tables[k], t); t++)
      names[n++] = tdm_type_name(tables[k], t);
  for (int t = 0; t < n; t++) {
    char quoted[64];
    snprintf(quoted, sizeof quoted, "'type':'%s'", names[t]);
    int found = 0;
    for (int i = 0; i < nscene; i++)
      found += strstr(scenes[i], quoted) != NULL;
    ck_assert_msg(found > 0, "no scene for %s", names[t]);
  }
}
END_TEST

TEST_MAIN_ROWS("mbd_jacobian", {test_jacobian, sizeof scenes / sizeof scenes[0]},
               {test_power, sizeof scenes / sizeof scenes[0]}, {test_tangent, sizeof scenes / sizeof scenes[0]},
               {test_all_types, 1})
