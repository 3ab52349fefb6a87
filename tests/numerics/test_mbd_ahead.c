/* The path ahead: what drivers prescribe, exactly; what moves on springs beside them; when no nodes are needed. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/assembly/assemble.h"
#include "mbd/consistent/kkt.h"
#include "mbd/reduced/ahead.h"
#include "mbd/scene/scene.h"
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

static const double amplitude = 0.0015, omega = 2 * M_PI * 40;

#define DECK "{'name':'deck','mass':2,'inertia':[1,1,1],'position':[0,0,0]}"
#define RAIL(body) "{'name':'rail','type':'prismatic','bodies':['ground','" body "'],'point':[0,0,0],'axis':[0,0,1]}"
#define SHAKE(law) "'drivers':[{'name':'shake','type':'linear_motor','joint':'rail','motion':{" law "}}]"
#define HARMONIC "'type':'harmonic','amplitude':0.0015,'frequency':40"

static const char shaken[] = "{'bodies':[" DECK "],'joints':[" RAIL("deck") "]," SHAKE(HARMONIC) "}";

/* a deck on a spring of w0 = 100 1/s on a shaken base; without gravity */
static const char sprung[] =
    "{'gravity':[0,0,0],'bodies':[{'name':'base','mass':5,'inertia':[1,1,1],'position':[0,0,-1]}," DECK "],"
    "'joints':[" RAIL(
        "base") ",{'name':'slide','type':'prismatic','bodies':['base','deck'],'point':[0,0,0],"
                "'axis':[0,0,1]}],'forces':[{'name':'spring','type':'spring_damper','bodies':['base','deck'],"
                "'points':[[0,0,-1],[0,0,0]],'stiffness':20000}]," SHAKE(HARMONIC) "}";

/* an arm of 0.5 m at 4 rad/s */
static const char turning[] =
    "{'bodies':[{'name':'arm','mass':2,'inertia':[1,1,1],'position':[0.5,0,0]}],"
    "'joints':[{'name':'pivot','type':'revolute','bodies':['ground','arm'],'point':[0,0,0],'axis':[0,0,1]}],"
    "'drivers':[{'name':'motor','type':'rotational_motor','joint':'pivot','motion':{'type':'constant_rate','rate':4,"
    "'start':'step'}}]}";

typedef struct {
  json_t *scene;
  mbd_model *model;
  mbd_data *data;
  mbd_kkt *kkt;
  mbd_ahead *ahead;
  tdm_nodes path;
  tdm_error err;
} rig;

static void rig_open(rig *r, const char *text, const char *body, const char *second) {
  tdm_assigned_body coupled[2] = {{.name = body}, {.name = second}};
  mbd_assembly assembly;
  memset(r, 0, sizeof *r);
  r->scene = scene_json("%s", text);
  ck_assert_msg(mbd_model_read(&r->model, r->scene, false, &r->err) == TDM_OK, "%s", r->err.message);
  ck_assert_int_eq(mbd_model_couple(r->model, coupled, second ? 2 : 1, &r->err), TDM_OK);
  r->data = mbd_data_create(r->model);
  r->kkt = mbd_kkt_create(r->model);
  ck_assert_int_eq(mbd_assemble(r->model, r->data, r->kkt, &assembly, &r->err), TDM_OK);
  ck_assert_int_eq(mbd_ahead_create(&r->ahead, r->model, r->data, assembly.freedom, NULL, NULL, &r->err), TDM_OK);
}

/* nodes to t2 */
static int look(rig *r, double t2) {
  ck_assert_msg(mbd_ahead_path(r->ahead, r->data, 0, t2, &r->path, &r->err) == TDM_OK, "%s", r->err.message);
  return r->path.nnode;
}

static void rig_close(rig *r) {
  mbd_ahead_destroy(&r->ahead);
  mbd_kkt_destroy(&r->kkt);
  mbd_data_destroy(&r->data);
  mbd_model_destroy(&r->model);
  json_decref(r->scene);
}

/* The law holds at the nodes, and between them within what they are made for. */
START_TEST(a_law_is_followed) {
  rig r;
  rig_open(&r, shaken, "deck", NULL);
  ck_assert(mbd_ahead_prescribed(r.ahead)[0]);
  tdm_state start = mbd_body_state(r.data->y, 0);
  static const double windows[] = {0.25, 0.5, 1, 2}; /* periods */
  for (int i = 0; i < 4; i++) {
    const double H = windows[i] / 40;
    int n = look(&r, H);
    ck_assert_int_ge(n, 4);
    ck_assert_double_eq(r.path.time[n - 1], H);
    for (int k = 0; k < n; k++) {
      const tdm_state *s = &r.path.state[k];
      ck_assert_double_eq_tol(s->pose.position.z, amplitude * sin(omega * r.path.time[k]), 1e-12);
      ck_assert_double_eq_tol(s->twist.velocity.z, amplitude * omega * cos(omega * r.path.time[k]), 1e-9);
    }
    for (double t = 0.01 * H; t < H; t += 0.013 * H) {
      tdm_state s = tdm_nodes_at(&r.path, 0, &start, 0, t);
      ck_assert_double_eq_tol(s.pose.position.z, amplitude * sin(omega * t), 2e-5 * amplitude);
    }
  }
  rig_close(&r);
}
END_TEST

/* Parabolas need no nodes, nor do short windows; a law of the third power does. */
START_TEST(what_the_acceleration_tells_has_no_nodes) {
  static const struct {
    const char *law;
    double H;
    bool bends;
  } cases[] = {{HARMONIC, 1e-4, false},
               {HARMONIC, 2e-3, true},
               {"'type':'polynomial','coefficients':[0,0.1,5]", 1, false},
               {"'type':'polynomial','coefficients':[0,0.1,5,2]", 1, true},
               {"'type':'constant'", 1, false},
               {"'type':'constant_rate','rate':3,'start':'step'", 1, false},
               {"'type':'step','to':1,'start':0.4,'rise':0.4", 0.4, false},
               {"'type':'step','to':1,'start':0.4,'rise':0.4", 1, true}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    char scene[1024];
    rig r;
    snprintf(scene, sizeof scene, "{'bodies':[" DECK "],'joints':[" RAIL("deck") "]," SHAKE("%s") "}", cases[i].law);
    rig_open(&r, scene, "deck", NULL);
    int n = look(&r, cases[i].H);
    ck_assert_msg((n > 0) == cases[i].bends, "%s over %g s: %d nodes", cases[i].law, cases[i].H, n);
    rig_close(&r);
  }
}
END_TEST

/* Many periods are told as far as nodes reach. */
START_TEST(what_cancels_has_no_nodes) {
  /* a rate and a triangle that goes the other way for the first half of its period: what is left is rounding */
  rig r;
  rig_open(
      &r,
      "{'bodies':[" DECK "],'joints':[" RAIL("deck") "]," SHAKE(
          "'type':'sum','laws':[{'type':'constant_rate','rate':-15.7,'start':'step'},{'type':'triangle','rate':15.7,"
          "'period':0.02,'corner':0.002}]") "}",
      "deck", NULL);
  ck_assert_int_eq(look(&r, 0.006), 0);
  ck_assert_int_gt(look(&r, 0.0105), 0); /* the first corner, which bends */
  rig_close(&r);
}
END_TEST

START_TEST(a_path_ends_where_nodes_run_out) {
  rig r;
  rig_open(&r, shaken, "deck", NULL);
  int n = look(&r, 10);
  double end = r.path.time[n - 1];
  ck_assert_int_le(n, TDM_NODES_MAX);
  ck_assert_double_gt(end, 2.0 / 40);
  ck_assert_double_lt(end, 4.0 / 40);
  ck_assert_double_eq_tol(r.path.state[n - 1].pose.position.z, amplitude * sin(omega * end), 1e-12);
  rig_close(&r);
  /* also where that part is at rest: a step too steep for nodes over 100 s, far behind */
  rig_open(&r,
           "{'bodies':[" DECK "],'joints':[" RAIL("deck") "]," SHAKE("'type':'step','to':1,'start':90,'rise':0.1") "}",
           "deck", NULL);
  n = look(&r, 100);
  ck_assert_int_gt(n, 0);
  ck_assert_double_lt(r.path.time[n - 1], 90.1);
  rig_close(&r);
}
END_TEST

/* y'' = w0^2 (A sin wt - y) + F/m with the load at the start, F, held: what the base shakes, and the load. */
START_TEST(a_spring_on_a_shaken_base) {
  const double w0 = 100, force = 30, share = w0 * w0 / (w0 * w0 - omega * omega), H = 0.5 / 40;
  rig r;
  rig_open(&r, sprung, "deck", "base");
  ck_assert(!mbd_ahead_prescribed(r.ahead)[0]);
  ck_assert(mbd_ahead_prescribed(r.ahead)[1]);
  r.data->nload = 2; /* 30 N, and a slope that is not held */
  r.data->load[0].force.z = force;
  r.data->load[1].force.z = 1000;
  r.data->load_t0 = 0;
  r.data->load_t1 = H;
  int n = look(&r, H);
  ck_assert_int_ge(n, 8);
  for (int k = 0; k < n; k++) {
    const double t = r.path.time[k], still = force / 2 / (w0 * w0);
    const double y = share * amplitude * (sin(omega * t) - omega / w0 * sin(w0 * t)) + still * (1 - cos(w0 * t));
    const double v = share * amplitude * omega * (cos(omega * t) - cos(w0 * t)) + still * w0 * sin(w0 * t);
    ck_assert_double_eq_tol(r.path.state[2 * k].pose.position.z, y, 1e-3 * amplitude);
    ck_assert_double_eq_tol(r.path.state[2 * k].twist.velocity.z, v, 1e-3 * amplitude * omega);
    ck_assert_double_eq_tol(r.path.state[2 * k + 1].pose.position.z, amplitude * sin(omega * t) - 1, 1e-12);
  }
  rig_close(&r);
}
END_TEST

START_TEST(a_turn_is_followed) {
  rig r;
  rig_open(&r, turning, "arm", NULL);
  ck_assert_int_eq(look(&r, 0.02), 0);
  int n = look(&r, 1); /* 4 rad */
  ck_assert_int_gt(n, 4 / 0.3);
  tdm_state start = mbd_body_state(r.data->y, 0);
  for (double t = 0.007; t < 1; t += 0.031) {
    tdm_state s = tdm_nodes_at(&r.path, 0, &start, 0, t);
    tdm_quat exact = tdm_quat_from_rotvec(tdm_v3(0, 0, 4 * t));
    ck_assert_double_lt(tdm_norm(tdm_quat_turn(exact, s.pose.orientation)), 1e-9);
    ck_assert_double_lt(tdm_norm(tdm_sub(s.pose.position, tdm_v3(0.5 * cos(4 * t), 0.5 * sin(4 * t), 0))), 2e-5);
    ck_assert_double_eq_tol(s.twist.angular.z, 4, 1e-9);
  }
  rig_close(&r);
}
END_TEST

/* The run itself goes on as if nobody had looked ahead, to the bit. */
START_TEST(looking_changes_nothing) {
  tdm_state end[2];
  for (int looks = 0; looks < 2; looks++) {
    run r = {0};
    json_t *scene = scene_json("%s", sprung);
    tdm_assigned_body body = {.name = "deck"};
    tdm_assignment a = {
        .scene = scene, .time_end = 1, .dt = 1e-3, .n = 1, .nbody = 1, .body = &body, .ahead = looks ? 0.0125 : 0};
    ck_assert_int_eq(mbd_engine_create(&r.self, &a, NULL, &r.err), TDM_OK);
    ck_assert_int_eq(mbd_engine_start(r.self)->path->nnode > 0, looks);
    for (int k = 0; k < 8; k++) {
      tdm_wrench load = {{0, 0, 10.0 * k}, {0, 0, 0}};
      tdm_nodes path = {0};
      mbd_window in = {.t0 = 0.0125 * k, .t1 = 0.0125 * (k + 1), .nload = 1, .load = &load};
      const mbd_outcome out = {.state = &end[looks], .path = &path};
      in.ahead = looks ? in.t1 + 0.0125 : 0;
      ck_assert_msg(mbd_engine_advance(r.self, &in, &out, &r.err) == TDM_OK, "%s", r.err.message);
      ck_assert_int_eq(path.nnode > 0, looks);
    }
    mbd_engine_destroy(&r.self);
    json_decref(scene);
  }
  ck_assert_mem_eq(&end[0], &end[1], sizeof end[0]);
}
END_TEST

TEST_MAIN("mbd_ahead", a_law_is_followed, what_the_acceleration_tells_has_no_nodes, what_cancels_has_no_nodes,
          a_path_ends_where_nodes_run_out, a_spring_on_a_shaken_base, a_turn_is_followed, looking_changes_nothing)
