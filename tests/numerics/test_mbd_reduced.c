/* The reduced model: against finite differences of the full model, and against closed forms. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/assembly/assemble.h"
#include "mbd/reduced/reduced.h"
#include "mbd/scene/scene.h"
#include "test_mbd_support.h"
#include "tests/test_main.h"

typedef struct {
  json_t *json;
  mbd_model *model;
  mbd_data *data;
  mbd_kkt *kkt;
  mbd_reduced *reduced;
  tdm_mobility m;
  int nv, nfree;
} mechanism;

/* Load, couple the bodies named (at most 3), assemble. */
static void open_mechanism(mechanism *q, const char *scene, int ncoupled, const char *const *names) {
  tdm_assigned_body body[3] = {{0}};
  mbd_assembly assembly;
  tdm_error err = {0};
  memset(q, 0, sizeof *q);
  for (int i = 0; i < ncoupled; i++)
    body[i].name = names[i];
  q->json = scene_json("%s", scene);
  ck_assert_msg(!mbd_model_read(&q->model, q->json, false, &err), "%s: %s", err.path, err.message);
  ck_assert_msg(!mbd_model_couple(q->model, body, ncoupled, &err), "%s: %s", err.path, err.message);
  q->data = mbd_data_create(q->model);
  q->kkt = mbd_kkt_create(q->model);
  q->nv = 6 * q->model->nbody;
  ck_assert_msg(!mbd_assemble(q->model, q->data, q->kkt, &assembly, &err), "%s: %s", err.path, err.message);
  q->reduced = mbd_reduced_create(q->model, q->data);
}

static void evaluate(mechanism *q) {
  ck_assert(mbd_reduced_at(q->model, q->data, q->kkt, q->reduced, q->data->t, q->data->y, &q->m));
  mbd_reduced_basis(q->reduced, &q->nfree);
}

static void close_mechanism(mechanism *q) {
  mbd_reduced_destroy(&q->reduced);
  mbd_kkt_destroy(&q->kkt);
  mbd_data_destroy(&q->data);
  mbd_model_destroy(&q->model);
  json_decref(q->json);
}

/* ---- closed forms ---- */

START_TEST(test_free_body) {
  /* Y = diag(1/m, J^-1) in world axes, symmetric; no stiffness */
  mechanism q;
  const char *names[] = {"a"};
  open_mechanism(
      &q,
      "{'bodies':[{'name':'a','mass':4,'inertia':[1,2,2.5],'position':[1,2,3],'orientation':[0.7071067811865476,"
      "0,0,0.7071067811865476]}]}",
      1, names);
  evaluate(&q);
  const double diagonal[6] = {0.25, 0.25, 0.25, 0.5, 1, 0.4}; /* a quarter turn about z swaps x and y */
  ck_assert_int_eq(q.m.nfree, 6);
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 6; j++) {
      CLOSE(q.m.Y[6 * i + j], i == j ? diagonal[i] : 0, 1e-14);
      CLOSE(q.m.stiffness[6 * i + j], 0, 1e-12);
      CLOSE(q.m.damping[6 * i + j], 0, 1e-12);
    }
  close_mechanism(&q);
}
END_TEST

START_TEST(test_prismatic) {
  mechanism q;
  const char *names[] = {"a"};
  open_mechanism(
      &q,
      "{'bodies':[{'name':'a','mass':4,'inertia':[1,2,2.5],'position':[0,0,0],'velocity':[0,0,2]}],'joints':[{"
      "'name':'j','type':'prismatic','bodies':['ground','a'],'point':[0,0,0],'axis':[0,0,1]}],'forces':[{"
      "'name':'s','type':'spring_damper','bodies':['ground','a'],'points':[[0,0,1],[0,0,0]],'stiffness':100,"
      "'damping':8}]}",
      1, names);
  evaluate(&q);
  ck_assert_int_eq(q.m.nfree, 1);
  for (int i = 0; i < 36; i++)
    CLOSE(q.m.Y[i], i == 14 ? 0.25 : 0, 1e-14);
  CLOSE(q.m.stiffness[0], 25, 1e-11);
  CLOSE(q.m.damping[0], 2, 1e-12);
  CLOSE(q.m.J[2] * q.m.velocity[0], 2, 1e-13);
  CLOSE(q.m.J[2] * q.m.acceleration[0], -9.81 - 8 * 2 / 4.0, 1e-12);
  close_mechanism(&q);
}
END_TEST

/* an arm of length L on a torsional spring, hanging out at an angle a: gravity's part of the stiffness is -m g L sin a
 * for the height's second derivative */
START_TEST(test_arm) {
  mechanism q;
  const char *names[] = {"a"};
  const double m = 50, L = 3, angle = 0.6, g = 9.81, I = 5, k = 2292, rate = 1.7;
  char scene[1024];
  snprintf(scene, sizeof scene,
           "{'bodies':[{'name':'a','mass':%g,'inertia':[5,5,5],'position':[%.17g,0,%.17g],'angular_velocity':[0,%g,0],"
           "'velocity':[%.17g,0,%.17g]}],'joints':[{'name':'j','type':'revolute','bodies':['ground','a'],'point':["
           "0,0,0],'axis':[0,1,0]}],'forces':[{'name':'s','type':'torsional_spring_damper','joint':'j','stiffness':"
           "%g,'damping':11}]}",
           m, L * cos(angle), L * sin(angle), rate, rate * L * sin(angle), -rate * L * cos(angle), k);
  open_mechanism(&q, scene, 1, names);
  evaluate(&q);
  /* turning by theta about +y takes the elevation to angle - theta: z = L sin(angle - theta) */
  double inertia = I + m * L * L, gravity = -m * g * L * sin(angle);
  ck_assert_int_eq(q.m.nfree, 1);
  CLOSE(q.m.stiffness[0], (k + gravity) / inertia, 1e-10);
  CLOSE(q.m.damping[0], 11 / inertia, 1e-12);
  CLOSE(q.m.Y[6 * 4 + 4], 1 / inertia, 1e-14);
  CLOSE(fabs(q.m.velocity[0] * q.m.J[4]), rate, 1e-12);
  /* the column of J turns with the arm */
  tdm_vec3 w = {0, rate, 0};
  tdm_vec3 turned = tdm_cross(w, tdm_v3(q.m.J[0], q.m.J[1], q.m.J[2]));
  CLOSE(q.m.J_rate[0], turned.x, 1e-12);
  CLOSE(q.m.J_rate[2], turned.z, 1e-12);
  CLOSE(q.m.J_rate[4], 0, 1e-12);
  close_mechanism(&q);
}
END_TEST

/* a motor holds the only freedom: no mobility, nothing else */
START_TEST(test_driven) {
  mechanism q;
  const char *names[] = {"a"};
  open_mechanism(
      &q,
      "{'bodies':[{'name':'a','mass':4,'inertia':[1,2,2.5],'position':[1,0,0]}],'joints':[{'name':'j','type':"
      "'revolute','bodies':['ground','a'],'point':[0,0,0],'axis':[0,1,0]}],'drivers':[{'name':'d','type':"
      "'rotational_motor','joint':'j','motion':{'type':'constant_rate','rate':3,'start':'step'}}]}",
      1, names);
  evaluate(&q);
  ck_assert_int_eq(q.m.nfree, 0);
  for (int i = 0; i < 36; i++)
    ck_assert_double_eq(q.m.Y[i], 0);
  close_mechanism(&q);
}
END_TEST

/* the box of scenarios/torsional with its fill, hanging: 4656 N m/rad from gravity beside the spring's 2292 */
START_TEST(test_torsional) {
  mechanism q;
  const char *names[] = {"box"};
  open_mechanism(
      &q,
      "{'gravity':[0,-9.81,0],'bodies':[{'name':'box','mass':316.4,'inertia':[5.5,5.5,5.5],'position':[0,-1.5,"
      "0]}],'joints':[{'name':'pivot','type':'revolute','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,"
      "1]}],'forces':[{'name':'spring','type':'torsional_spring_damper','joint':'pivot','stiffness':"
      "2291.8311805232927,'damping':1145.9}]}",
      1, names);
  evaluate(&q);
  double inertia = 5.5 + 316.4 * 1.5 * 1.5;
  CLOSE(q.m.stiffness[0] * inertia, 2291.8311805232927 + 316.4 * 9.81 * 1.5, 1e-8);
  CLOSE(316.4 * 9.81 * 1.5, 4656, 1);
  close_mechanism(&q);
}
END_TEST

/* seven bodies that springs tie have more freedom than a linear model is sent for */
START_TEST(test_cap) {
  mechanism q;
  const char *names[] = {"b0", "b6"};
  char scene[4096] = "{'bodies':[";
  for (int i = 0; i < 7; i++)
    sprintf(scene + strlen(scene), "%s{'name':'b%d','mass':%d,'inertia':[1,1,1],'position':[%d,0,0]}", i ? "," : "", i,
            i + 1, i);
  strcat(scene, "],'forces':[");
  for (int i = 0; i < 6; i++)
    sprintf(scene + strlen(scene),
            "%s{'name':'s%d','type':'spring_damper','bodies':['b%d','b%d'],'points':[[%d,0,0],[%d,0,0]],'stiffness':"
            "9}",
            i ? "," : "", i, i, i + 1, i, i + 1);
  strcat(scene, "]}");
  open_mechanism(&q, scene, 2, names);
  evaluate(&q);
  ck_assert_int_eq(mbd_reduced_freedom(q.reduced), 42);
  ck_assert_int_eq(q.m.nfree, 0);
  CLOSE(q.m.Y[0], 1, 1e-14);
  CLOSE(q.m.Y[12 * 6 + 6], 1 / 7.0, 1e-14);
  CLOSE(q.m.Y[6], 0, 1e-14);
  close_mechanism(&q);
}
END_TEST

/* ---- finite differences ---- */

#define CHAIN                                                                                                      \
  "'bodies':[{'name':'a','mass':2,'inertia':[0.3,0.2,0.4,0.05,0.02,-0.03],'position':[0.5,0.1,0],'velocity':[1,2," \
  "-1],'angular_velocity':[1,2,3]},{'name':'b','mass':3,'inertia':[0.5,0.4,0.2],'position':[1.2,0.3,0.1],"         \
  "'orientation':[0.9,0.1,-0.3,0.2],'velocity':[0,-1,1],'angular_velocity':[-2,1,1]}]"

static const char *const scenes[] = {
    "{" CHAIN ",'joints':[{'name':'j','type':'revolute','bodies':['ground','a'],'point':[0,0,0],'axis':[0,1,0.3]},{"
    "'name':'k','type':'spherical','bodies':['a','b'],'point':[1,0.2,0]}],'forces':[{'name':'s','type':"
    "'spring_damper','bodies':['ground','b'],'points':[[2,0,2],[1.5,0,0]],'stiffness':300,'damping':7}]}",
    "{" CHAIN ",'joints':[{'name':'j','type':'prismatic','bodies':['ground','a'],'point':[0,0,0],'axis':[0,1,0.3]},{"
    "'name':'k','type':'revolute','bodies':['a','b'],'point':[1,0.2,0],'axis':[1,0,0.4]}],'forces':[{'name':'s',"
    "'type':'torsional_spring_damper','joint':'k','stiffness':300,'damping':7,'preload':4}]}",
    /* a driver on the first joint */
    "{" CHAIN ",'joints':[{'name':'j','type':'revolute','bodies':['ground','a'],'point':[0,0,0],'axis':[0,1,0.3]},{"
    "'name':'k','type':'spherical','bodies':['a','b'],'point':[1,0.2,0]}],'drivers':[{'name':'d','type':"
    "'rotational_motor','joint':'j','motion':{'type':'constant_rate','rate':3,'start':'step'}}]}",
    /* a planar four-bar: three rows follow from the others */
    "{'gravity':[0,-9.81,0],'bodies':[{'name':'a','mass':1,'inertia':[0.01,0.08,0.08],'position':[0,0.5,0],'velocity':"
    "[0.5,0,0],'angular_velocity':[0,0,-1]},{'name':'b','mass':1,'inertia':[0.01,0.08,0.08],'position':[0.5,1,0],"
    "'velocity':[1,0,0]},{'name':'c','mass':1,'inertia':[0.01,0.08,0.08],'position':[1,0.4,0]}],'joints':[{'name':'p',"
    "'type':'revolute','bodies':['ground','a'],'point':[0,0,0],'axis':[0,0,1]},{'name':'q','type':'revolute','bodies':["
    "'a','b'],'point':[0,1,0],'axis':[0,0,1]},{'name':'r','type':'revolute','bodies':['b','c'],'point':[1,1,0],'axis':["
    "0,0,1]},{'name':'s','type':'revolute','bodies':['c','ground'],'point':[1.2,-0.2,0],'axis':[0,0,1]}]}",
    /* no joints: gyroscopic terms alone */
    "{" CHAIN "}",
};

/* velocities of y (nv) */
static void get_twists(const mechanism *q, const double *y, double *V) {
  for (int k = 0; k < q->nv; k++)
    V[k] = y[MBD_BODY_UNKNOWNS * (k / 6) + MBD_V + k % 6];
}

static void set_twists(const mechanism *q, double *y, const double *V) {
  for (int k = 0; k < q->nv; k++)
    y[MBD_BODY_UNKNOWNS * (k / 6) + MBD_V + k % 6] = V[k];
}

/* y with poses moved by eps d (nv) and put onto the constraints; velocities V projected there */
static void moved(mechanism *q, double *y, double eps, const double *d, const double *V) {
  memcpy(y, q->data->y, (size_t)mbd_nunknown(q->model) * sizeof(double));
  for (int b = 0; b < q->model->nbody; b++) {
    tdm_state s = mbd_body_state(y, b);
    s.pose.position = tdm_axpy(eps, mbd_get3(d + 6 * b), s.pose.position);
    tdm_quat turn = tdm_quat_from_rotvec(tdm_scale(eps, mbd_get3(d + 6 * b + 3)));
    s.pose.orientation = tdm_quat_unit(tdm_quat_mul(turn, s.pose.orientation));
    mbd_set_body_state(y, b, &s);
  }
  set_twists(q, y, V);
  ck_assert(mbd_project(q->model, q->data, q->kkt, q->data->t, y));
}

static void times_mass(const mechanism *q, const double *x, double *out) {
  for (int b = 0; b < q->model->nbody; b++) {
    mbd_set3(out + 6 * b, tdm_scale(q->model->body[b].mass, mbd_get3(x + 6 * b)));
    mbd_set3(out + 6 * b + 3, mbd_inertia_mul(&q->model->body[b], &q->data->kin[b + 1], mbd_get3(x + 6 * b + 3)));
  }
}

/* u = M_r^-1 N^T x for a given N (nv x f), by Gauss without pivoting: M_r is positive definite */
static void reduced_solve(const mechanism *q, const double *N, const double *x, double *u) {
  const int f = q->nfree, nv = q->nv;
  double Mr[24 * 24], column[24], Mc[24];
  for (int j = 0; j < f; j++) {
    for (int k = 0; k < nv; k++)
      column[k] = N[k * f + j];
    times_mass(q, column, Mc);
    u[j] = 0;
    for (int i = 0; i < f; i++)
      Mr[i * f + j] = 0;
    for (int k = 0; k < nv; k++) {
      u[j] += column[k] * x[k];
      for (int i = 0; i < f; i++)
        Mr[i * f + j] += N[k * f + i] * Mc[k];
    }
  }
  for (int i = 0; i < f; i++)
    for (int k = i + 1; k < f; k++) {
      double factor = Mr[k * f + i] / Mr[i * f + i];
      for (int j = i; j < f; j++)
        Mr[k * f + j] -= factor * Mr[i * f + j];
      u[k] -= factor * u[i];
    }
  for (int i = f - 1; i >= 0; i--) {
    for (int k = i + 1; k < f; k++)
      u[i] -= Mr[i * f + k] * u[k];
    u[i] /= Mr[i * f + i];
  }
}

/* The basis N0 carried to poses moved by eps d: each column projected there, without what drivers prescribe. */
static void carry(mechanism *q, const double *N0, double eps, const double *d, double *N) {
  double y[128], zero[24] = {0}, still[24], column[24];
  moved(q, y, eps, d, zero);
  get_twists(q, y, still);
  for (int j = 0; j < q->nfree; j++) {
    for (int k = 0; k < q->nv; k++)
      column[k] = N0[k * q->nfree + j];
    moved(q, y, eps, d, column);
    get_twists(q, y, column);
    for (int k = 0; k < q->nv; k++)
      N[k * q->nfree + j] = column[k] - still[k];
  }
}

/* u'' with poses moved by eps d, and velocities V projected there */
static void acceleration(mechanism *q, const double *N0, double eps, const double *d, const double *V, double *u) {
  double y[128], N[24 * 24], Ma[24];
  carry(q, N0, eps, d, N);
  moved(q, y, eps, d, V);
  ck_assert(mbd_accelerations(q->model, q->data, q->kkt, q->data->t, y));
  times_mass(q, q->data->acceleration, Ma);
  reduced_solve(q, N, Ma, u);
}

START_TEST(test_differences) {
  mechanism q;
  const char *names[] = {"a", "b"};
  open_mechanism(&q, scenes[_i], 2, names);
  tdm_wrench load[2] = {{{30, -20, 10}, {1, 2, 3}}, {{5, 6, -7}, {-4, 2, 1}}};
  tdm_error err = {0};
  ck_assert_int_eq(mbd_data_set_load(q.data, q.model, 0, 1, 1, load, &err), TDM_OK);
  evaluate(&q);
  ck_assert_int_lt(mbd_nunknown(q.model), 128);
  const int f = q.nfree, nv = q.nv;
  const double eps = 1e-5;
  double N0[24 * 24], V[24], d[24], up[24], down[24];
  ck_assert_int_gt(f, 0);
  memcpy(N0, mbd_reduced_basis(q.reduced, &q.nfree), (size_t)(nv * f) * sizeof(double));
  get_twists(&q, q.data->y, V);
  const double scale = 100;
  for (int j = 0; j < f; j++) {
    for (int k = 0; k < nv; k++)
      d[k] = N0[k * f + j];
    acceleration(&q, N0, eps, d, V, up);
    acceleration(&q, N0, -eps, d, V, down);
    for (int i = 0; i < f; i++)
      CLOSE(q.m.stiffness[i * f + j], -(up[i] - down[i]) / (2 * eps), 1e-7 * scale);
    double faster[24], slower[24];
    for (int k = 0; k < nv; k++) {
      faster[k] = V[k] + eps * d[k];
      slower[k] = V[k] - eps * d[k];
    }
    acceleration(&q, N0, 0, d, faster, up);
    acceleration(&q, N0, 0, d, slower, down);
    for (int i = 0; i < f; i++)
      CLOSE(q.m.damping[i * f + j], -(up[i] - down[i]) / (2 * eps), 1e-7 * scale);
  }
  /* along the motion */
  double N1[24 * 24], N2[24 * 24], y[128];
  q.data->t = eps; /* drivers move on */
  carry(&q, N0, eps, V, N1);
  q.data->t = -eps;
  carry(&q, N0, -eps, V, N2);
  for (int c = 0; c < 12; c++)
    for (int j = 0; j < f; j++)
      CLOSE(q.m.J_rate[c * f + j], (N1[c * f + j] - N2[c * f + j]) / (2 * eps), 1e-7);
  for (int c = 0; c < 12; c++) {
    double unit[24] = {0};
    unit[c] = 1;
    q.data->t = eps;
    moved(&q, y, eps, V, V);
    mbd_kinematics(q.model, q.data, 0, y);
    reduced_solve(&q, N1, unit, up);
    q.data->t = -eps;
    moved(&q, y, -eps, V, V);
    mbd_kinematics(q.model, q.data, 0, y);
    reduced_solve(&q, N2, unit, down);
    for (int j = 0; j < f; j++)
      CLOSE(q.m.B_rate[j * 12 + c], (up[j] - down[j]) / (2 * eps), 1e-6);
  }
  close_mechanism(&q);
}
END_TEST

/* the accelerations answer to a load by Y; twists and accelerations are those of u' where nothing drives */
START_TEST(test_mobility) {
  mechanism q;
  const char *names[] = {"b", "a"};
  open_mechanism(&q, scenes[_i], 2, names);
  evaluate(&q);
  double free[12], u[32];
  for (int c = 0; c < 12; c++)
    free[c] = q.data->acceleration[6 * q.model->coupled[c / 6] + c % 6];
  memcpy(u, q.m.acceleration, (size_t)q.m.nfree * sizeof(double));
  for (int c = 0; c < 12 && q.model->ndriver == 0; c++) { /* V = J u', so its rate is J u'' + dJ/dt u' */
    double v = q.data->kin[q.model->coupled[c / 6] + 1].v.x, V = 0, rate = 0;
    for (int j = 0; j < q.m.nfree; j++) {
      V += q.m.J[c * q.m.nfree + j] * q.m.velocity[j];
      rate += q.m.J[c * q.m.nfree + j] * q.m.acceleration[j] + q.m.J_rate[c * q.m.nfree + j] * q.m.velocity[j];
    }
    if (c % 6 == 0)
      CLOSE(V, v, 1e-11);
    CLOSE(rate, free[c], 1e-10);
  }
  for (int e = 0; e < 12; e++) {
    double load[12] = {0};
    tdm_error err = {0};
    load[e] = 1;
    ck_assert_int_eq(mbd_data_set_load(q.data, q.model, 0, 1, 1, (tdm_wrench *)(void *)load, &err), TDM_OK);
    evaluate(&q);
    for (int c = 0; c < 12; c++) {
      CLOSE(q.data->acceleration[6 * q.model->coupled[c / 6] + c % 6] - free[c], q.m.Y[12 * c + e], 1e-11);
      ck_assert_double_eq(q.m.Y[12 * c + e], q.m.Y[12 * e + c]);
    }
    for (int j = 0; j < q.m.nfree; j++)
      CLOSE(q.m.acceleration[j] - u[j], q.m.B[12 * j + e], 1e-11);
  }
  close_mechanism(&q);
}
END_TEST

/* the same with a light and a heavy body, as a share of what each direction gives: mass ratios 1e-10, 1e-5, 1e5, 1e10
 */
START_TEST(test_light_and_heavy) {
  mechanism q;
  const char *names[] = {"a", "b"};
  char scene[2048];
  const double mass = 1e3, other = mass * pow(10, 5 * (_i < 2 ? _i - 2 : _i - 1));
  snprintf(scene, sizeof scene,
           "{'gravity':[0,0,0],'bodies':[{'name':'a','mass':%.17g,'inertia':[%.17g,%.17g,%.17g],'position':[1,0,0]},"
           "{'name':'b','mass':%.17g,'inertia':[%.17g,%.17g,%.17g],'position':[2,0,1]}],'joints':[{'name':'p','type':"
           "'spherical','bodies':['ground','a'],'point':[0,0,0]},{'name':'q','type':'universal','bodies':['a','b'],"
           "'point':[2,0,0],'axes':[[1,0,0],[0,1,0]]}]}",
           mass, mass, 2 * mass, 2.5 * mass, other, other, 2 * other, 2.5 * other);
  open_mechanism(&q, scene, 2, names);
  evaluate(&q);
  double Y[144];
  memcpy(Y, q.m.Y, sizeof Y);
  for (int e = 0; e < 12; e++) {
    double load[12] = {0};
    tdm_error err = {0};
    load[e] = mass;
    ck_assert_int_eq(mbd_data_set_load(q.data, q.model, 0, 1, 1, (tdm_wrench *)(void *)load, &err), TDM_OK);
    ck_assert(mbd_accelerations(q.model, q.data, q.kkt, 0, q.data->y));
    for (int c = 0; c < 12; c++)
      CLOSE(q.data->acceleration[c] / mass, Y[12 * c + e], 1e-6 * sqrt(Y[13 * c] * Y[13 * e]));
  }
  close_mechanism(&q);
}
END_TEST

/* ---- who takes part ---- */

/* A scene of n links of a chain that hangs from the ground by spherical joints, bent and turning, with what else is
 * given: before, behind the links; joints, forces. Links are l0, l1, ... */
static void write_chain(char *scene, int n, const char *before, const char *behind, const char *joints,
                        const char *forces) {
  sprintf(scene, "{'bodies':[%s", before);
  for (int i = 0; i < n; i++)
    sprintf(scene + strlen(scene),
            "%s{'name':'l%d','mass':%g,'inertia':[0.3,0.2,0.4,0.05,0.02,-0.03],'position':[%d.5,%g,0.1],"
            "'angular_velocity':[1,%d,3]}",
            i ? "," : "", i, 2 + 0.1 * i, i, 0.2 * (i % 3), i % 2);
  sprintf(scene + strlen(scene), "%s],'joints':[", behind);
  for (int i = 0; i < n; i++) {
    char last[16];
    snprintf(last, sizeof last, i ? "l%d" : "ground", i - 1);
    sprintf(scene + strlen(scene),
            "%s{'name':'j%d','type':'spherical','bodies':['%s','l%d'],'point':[%d,%g,"
            "0]}",
            i ? "," : "", i, last, i, i, 0.1 * (i % 2));
  }
  sprintf(scene + strlen(scene),
          "%s],'forces':[{'name':'s','type':'spring_damper','bodies':['ground','l0'],'points':[[2,0,2],[0.5,0,"
          "0]],'stiffness':300,'damping':7}%s]}",
          joints, forces);
}

/* the arrays of a reduced model do not differ from others: tolerance relative to the largest of each */
static void expect_same(const tdm_mobility *a, const tdm_mobility *b) {
  ck_assert_int_eq(a->nbody, b->nbody);
  ck_assert_int_eq(a->nfree, b->nfree);
  const int k6 = 6 * a->nbody, f = a->nfree;
  const struct {
    const double *a, *b;
    int n;
  } arrays[] = {{a->Y, b->Y, k6 * k6},
                {a->velocity, b->velocity, f},
                {a->acceleration, b->acceleration, f},
                {a->J, b->J, k6 * f},
                {a->B, b->B, f * k6},
                {a->stiffness, b->stiffness, f * f},
                {a->damping, b->damping, f * f},
                {a->J_rate, b->J_rate, k6 * f},
                {a->B_rate, b->B_rate, f * k6}};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++) {
    double largest = 0;
    for (int k = 0; k < arrays[i].n; k++)
      largest = fmax(largest, fabs(arrays[i].b[k]));
    ck_assert_double_gt(largest, 0);
    for (int k = 0; k < arrays[i].n; k++)
      CLOSE(arrays[i].a[k], arrays[i].b[k], 1e-11 * largest);
  }
}

#define OTHER "{'name':'%s','mass':3,'inertia':[0.5,0.4,0.2],'position':[%d,5,0],'angular_velocity':[-2,1,1]}"

/* bodies that nothing ties to the coupled ones change nothing: free, hinged, tied among themselves, whatever their
 * place in the list, beyond the limit or not */
START_TEST(test_component) {
  const char *names[] = {"l1", "l0"};
  const int nother = _i + 1;
  char scene[16384], before[4096] = "", behind[4096] = "", ties[4096] = "", joints[1024] = "";
  for (int i = 0; i < nother; i++) {
    char name[8], *to = i % 2 ? before : behind;
    snprintf(name, sizeof name, "o%d", i);
    sprintf(to + strlen(to), i % 2 ? OTHER "," : "," OTHER, name, i);
    if (i % 3 == 2)
      continue; /* free */
    sprintf(ties + strlen(ties),
            ",{'name':'t%d','type':'spring_damper','bodies':['%s','o%d'],'points':[[%d,5,0],[%d,5,0]],'stiffness':80}",
            i, i ? "o0" : "ground", i, i ? 0 : 9, i);
  }
  sprintf(joints, ",{'name':'k','type':'revolute','bodies':['ground','o0'],'point':[0,4,0],'axis':[0,1,0.3]}");
  mechanism alone, q;
  write_chain(scene, 3, "", "", "", "");
  open_mechanism(&alone, scene, 2, names);
  evaluate(&alone);
  ck_assert_int_eq(alone.m.nfree, 9);
  write_chain(scene, 3, before, behind, joints, ties);
  open_mechanism(&q, scene, 2, names);
  evaluate(&q);
  expect_same(&q.m, &alone.m);
  close_mechanism(&q);
  close_mechanism(&alone);
}
END_TEST

/* what ties a body to a coupled one brings it in: a spring, a gear whose joints stand on the ground, a driver's row.
 * The answer to a moment about the hinge: 1 / (1 + 1/4) with the gear, 1 / (1 + 3 * 1^2) with the slider driven */
START_TEST(test_ties) {
  static const struct {
    const char *joints, *rest;
    int freedom;
    double answer;
  } cases[] = {
      {"", "", 1, 1},
      {"",
       ",'forces':[{'name':'s','type':'spring_damper','bodies':['a','c'],'points':[[0,1,0],[4,1,0]],'stiffness':5}]", 3,
       1},
      {",{'name':'g','type':'gear','joints':['p','q'],'ratio':2}", "", 1, 0.8},
      {"",
       ",'drivers':[{'name':'d','type':'point_motion','bodies':['a','c'],'point':[4,1,0],'direction':[1,0,0],"
       "'motion':{'type':'constant','value':0}}]",
       2, 0.25},
  };
  char scene[2048];
  snprintf(scene, sizeof scene,
           "{'bodies':[{'name':'a','mass':1,'inertia':[1,1,1],'position':[0,0,0]},{'name':'b','mass':2,'inertia':[1,1,"
           "1],'position':[2,0,0]},{'name':'c','mass':3,'inertia':[1,1,1],'position':[4,0,0]}],'joints':[{'name':'p',"
           "'type':'revolute','bodies':['ground','a'],'point':[0,0,0],'axis':[0,0,1]},{'name':'q','type':'revolute',"
           "'bodies':['ground','b'],'point':[2,0,0],'axis':[0,0,1]},{'name':'r','type':'cylindrical','bodies':["
           "'ground','c'],'point':[4,0,0],'axis':[1,0,0]}%s]%s}",
           cases[_i].joints, cases[_i].rest);
  mechanism q;
  const char *names[] = {"a"};
  open_mechanism(&q, scene, 1, names);
  evaluate(&q);
  ck_assert_int_eq(q.m.nfree, cases[_i].freedom);
  ck_assert_int_eq(mbd_reduced_freedom(q.reduced), cases[_i].freedom);
  CLOSE(q.m.Y[35], cases[_i].answer, 1e-13);
  close_mechanism(&q);
}
END_TEST

/* A chain of 30 freedoms with a body that a spring ties to it has 36: Y comes another way then. The spring does not
 * change it. */
START_TEST(test_many_freedoms) {
  const char *names[] = {"l9", "l0", "l4"};
  char scene[16384], behind[512], ties[512];
  mechanism dense, q;
  write_chain(scene, 10, "", "", "", "");
  open_mechanism(&dense, scene, 3, names);
  evaluate(&dense);
  ck_assert_int_eq(dense.m.nfree, 30);
  snprintf(behind, sizeof behind, "," OTHER, "o", 9);
  snprintf(ties, sizeof ties,
           ",{'name':'t','type':'spring_damper','bodies':['l9','o'],'points':[[9.5,0,0],[9,5,0]],'stiffness':80}");
  write_chain(scene, 10, "", behind, "", ties);
  open_mechanism(&q, scene, 3, names);
  evaluate(&q);
  ck_assert_int_eq(mbd_reduced_freedom(q.reduced), 36);
  ck_assert_int_eq(q.m.nfree, 0);
  for (int c = 0; c < 18; c++)
    for (int e = 0; e < 18; e++) {
      double sum = 0;
      for (int j = 0; j < 30; j++)
        sum += dense.m.J[c * 30 + j] * dense.m.B[j * 18 + e];
      CLOSE(q.m.Y[c * 18 + e], sum, 1e-11);
      ck_assert_double_eq(q.m.Y[c * 18 + e], q.m.Y[e * 18 + c]);
    }
  ck_assert_double_gt(fabs(q.m.Y[6 * 18]), 1e-6); /* the ends feel each other */
  close_mechanism(&q);
  close_mechanism(&dense);
}
END_TEST

enum { NSCENE = sizeof scenes / sizeof scenes[0] };

TEST_MAIN_ROWS("mbd_reduced", {test_free_body, 1}, {test_prismatic, 1}, {test_arm, 1}, {test_torsional, 1},
               {test_driven, 1}, {test_cap, 1}, {test_differences, NSCENE}, {test_light_and_heavy, 4},
               {test_mobility, NSCENE}, {test_component, 8}, {test_ties, 4}, {test_many_freedoms, 1})
