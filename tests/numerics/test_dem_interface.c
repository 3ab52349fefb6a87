/* dem/dem.h: the engine as others use it, without a server and without looking inside. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/dem.h"
#include "tests/test_main.h"

enum { STEPS = 60, NCHANNEL_MAX = 64 };

static const double dt = 1e-4, gravity = 9.81, particle_mass = 0.02;

/* Three balls that fall onto a coupled plate, a source above and a sink beside it. */
static json_t *scene(const char *more) {
  return scene_json("{'materials': [{'name':'a','density':1000,'young_modulus':1e6,'poisson_ratio':0.25}],"
                    "'pairs': [{'materials':['a','a'],'restitution':0.3,'friction':0.4}],"
                    "'bodies': [{'name':'plate','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                    "'particles': [{'type':'list','material':'a','radius':0.01,'mass':%g,'velocity':[0.1,0,-0.5],"
                    "   'positions':[[0,0,0.0101],[0.03,0,0.0102],[0.06,0,0.011]]}],"
                    "'energy':true%s}",
                    particle_mass, more);
}

static const char flows[] = ",'sources': [{'name':'tap','material':'a','radius':0.005,'rate':1000,"
                            "'position':[0,0.1,0.2],'velocity':[0,0,-2]}],"
                            "'sinks': [{'name':'drain','type':'box','min':[-1,0.05,0.15],'max':[1,0.2,0.19],"
                            "'classes':[0.01]}]";

static dem_engine *make(const char *more, double mass) {
  const tdm_assigned_body plate = {.name = "plate", .mass = mass, .state = state_at(0, 0, 0)};
  const tdm_assignment assignment = {
      .scene = scene(more), .time_end = STEPS * dt, .dt = dt, .n = 1, .nbody = 1, .body = &plate};
  dem_engine *engine = NULL;
  tdm_error err = {0};
  ck_assert_msg(dem_engine_create(&engine, &assignment, NULL, &err) == TDM_OK, "%s: %s", err.path, err.message);
  ck_assert_int_le(dem_engine_start(engine)->nchannel, NCHANNEL_MAX);
  json_decref(assignment.scene);
  return engine;
}

/* from step `from` to step `to`, the plate at rest; the channels at the end into out */
static void advance(dem_engine *engine, int from, int to, double out[NCHANNEL_MAX]) {
  const double end = to * dt;
  const dem_window window = {
      .t0 = from * dt, .t1 = end, .nstep = (uint64_t)(to - from), .nsample = 1, .sample_time = &end};
  tdm_error err = {0};
  ck_assert_msg(dem_engine_advance(engine, &window, &(dem_outcome){.channel = out}, &err) == TDM_OK, "%s", err.message);
}

START_TEST(windows_do_not_change_a_run) {
  /* bit for bit, with particles that come and go */
  dem_engine *whole = make(flows, 1), *cut = make(flows, 1);
  double a[NCHANNEL_MAX], b[NCHANNEL_MAX];
  const size_t n = (size_t)dem_engine_start(whole)->nchannel * sizeof *a;
  ck_assert_mem_eq(dem_engine_start(whole)->initial, dem_engine_start(cut)->initial, n);
  advance(whole, 0, STEPS / 2, a);
  advance(whole, STEPS / 2, STEPS, a);
  advance(cut, 0, 7, b);
  advance(cut, 7, STEPS / 2, b); /* loads are means of the output interval: samples at the same times */
  advance(cut, STEPS / 2, STEPS, b);
  ck_assert_mem_eq(a, b, n);
  dem_engine_destroy(&whole);
  dem_engine_destroy(&cut);
  ck_assert_ptr_null(whole);
}
END_TEST

START_TEST(a_slot_brings_back_every_bit) {
  dem_engine *engine = make(flows, 1);
  double at_save[NCHANNEL_MAX], first[NCHANNEL_MAX], again[NCHANNEL_MAX];
  const size_t n = (size_t)dem_engine_start(engine)->nchannel * sizeof *first;
  tdm_error err = {0};
  advance(engine, 0, 20, at_save);
  ck_assert(!dem_engine_save(engine, TDM_SLOTS_MAX - 1, &err));
  advance(engine, 20, 40, first);
  ck_assert_mem_ne(at_save, first, n);
  ck_assert(!dem_engine_restore(engine, TDM_SLOTS_MAX - 1, &err));
  advance(engine, 20, 40, again);
  ck_assert_mem_eq(first, again, n);
  ck_assert_int_eq(dem_engine_restore(engine, 0, &err), TDM_ERR_PROTOCOL);
  dem_engine_destroy(&engine);
}
END_TEST

START_TEST(loads_are_what_particles_lose) {
  /* on a plate that is lowered at constant speed: impulse, moments and work of one window */
  dem_engine *engine = make("", 1e9);
  const double T = STEPS * dt, speed = -0.05;
  tdm_state end = state_at(0, 0, speed * T), start = state_at(0, 0, 0);
  start.twist.velocity.z = end.twist.velocity.z = speed;
  const dem_path path = dem_path_make(&start, &end, T, TDM_LINEAR);
  tdm_wrench load;
  tdm_interface body = {0};
  const double before = dem_engine_start(engine)->initial[6]; /* particles.velocity.z */
  double values[NCHANNEL_MAX];
  const dem_window window = {.t1 = T, .nstep = STEPS, .path = &path, .nsample = 1, .sample_time = &T};
  tdm_error err = {0};
  ck_assert_str_eq(dem_engine_start(engine)->channel[6].name, "particles.velocity.z");
  ck_assert(
      !dem_engine_advance(engine, &window, &(dem_outcome){.load = &load, .body = &body, .channel = values}, &err));
  const double lost = 3 * particle_mass * (before - gravity * T - values[6]);
  ck_assert_double_lt(lost, -0.01); /* they rebounded */
  ck_relative(body.moment[0].force.z * T, lost, 1e-9);
  ck_relative(body.work, speed * lost, 1e-9);
  ck_relative(load.force.z, body.moment[0].force.z, 0.05); /* the mean of samples, not of kicks */
  dem_engine_destroy(&engine);
}
END_TEST

/* Contacts may feel another velocity than that of the path: the damping's share of the load says which. */
START_TEST(contacts_feel_the_velocity_that_is_sent) {
  const double stiffness = 1e4, damping = 30, overlap = 1e-4, h = 1e-6, T = 10 * h;
  json_t *json = scene_json(
      "{'gravity':[0,0,0],'contact':{'normal':'hooke','tangential':'none'},"
      "'materials':[{'name':'a','density':1000}],'pairs':[{'materials':['a','a'],'stiffness':%g,'damping':%g}],"
      "'bodies':[{'name':'plate','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
      "'particles':[{'type':'list','material':'a','radius':0.01,'mass':1e6,'positions':[[0,0,%g]]}]}",
      stiffness, damping, 0.01 - overlap);
  const tdm_assigned_body plate = {.name = "plate", .mass = 1e9, .state = state_at(0, 0, 0)};
  static const struct {
    double path, sent; /* velocities along the normal [m/s] */
  } cases[] = {{0, 0.4}, {0.1, 0.4}, {0.1, -0.2}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    double load[2];
    for (int sent = 0; sent < 2; sent++) {
      const tdm_assignment assignment = {.scene = json, .time_end = 1, .dt = h, .n = 1, .nbody = 1, .body = &plate};
      const tdm_state start = state_at(0, 0, 0);
      tdm_state end = state_at(0, 0, cases[i].path * T);
      end.twist.velocity.z = cases[i].sent;
      dem_path path = dem_path_make(&start, &end, T, TDM_LINEAR);
      path.sent = sent;
      const dem_window window = {.t1 = T, .nstep = 10, .path = &path};
      tdm_wrench mean;
      tdm_interface body = {0};
      dem_engine *engine = NULL;
      tdm_error err = {0};
      ck_assert_msg(!dem_engine_create(&engine, &assignment, NULL, &err), "%s: %s", err.path, err.message);
      ck_assert(!dem_engine_advance(engine, &window, &(dem_outcome){.load = &mean, .body = &body}, &err));
      load[sent] = -mean.force.z;
      ck_near(load[sent], stiffness * overlap + damping * (sent ? cases[i].sent : cases[i].path), 0.02);
      ck_near(body.work, cases[i].path * body.moment[0].force.z * T, 1e-12); /* along the path all the same */
      dem_engine_destroy(&engine);
    }
    ck_near(load[1] - load[0], damping * (cases[i].sent - cases[i].path), 1e-8);
  }
  json_decref(json);
}
END_TEST

START_TEST(what_is_not_wanted_need_not_be_given) {
  dem_engine *engine = make(flows, 1);
  const double end = 10 * dt;
  const dem_window window = {.t1 = end, .nstep = 10, .nsample = 1, .sample_time = &end};
  tdm_error err = {0};
  ck_assert(!dem_engine_advance(engine, &window, &(dem_outcome){0}, &err));
  dem_engine_destroy(&engine);
  dem_engine_destroy(&engine);
}
END_TEST

START_TEST(channels_come_in_the_order_of_the_table) {
  static const char *const expected[] = {
      "particles.count [1]",        "particles.com.x [m]",          "particles.com.y [m]",
      "particles.com.z [m]",        "particles.velocity.x [m/s]",   "particles.velocity.y [m/s]",
      "particles.velocity.z [m/s]", "particles.kinetic_energy [J]", "particles.contacts [1]",
      "particles.lost [1]",         "particles.mass [kg]",          "particles.impact_speed [m/s]",
      "energy.potential [J]"};
  static const char *const last[] = {"source.tap.created [1]",
                                     "source.tap.waiting [1]",
                                     "sink.drain.removed [1]",
                                     "sink.drain.mass [kg]",
                                     "sink.drain.class0.removed [1]",
                                     "sink.drain.class0.mass [kg]",
                                     "sink.drain.class1.removed [1]",
                                     "sink.drain.class1.mass [kg]",
                                     "balance.number [1]",
                                     "balance.mass [kg]"};
  enum { FIRST = sizeof expected / sizeof *expected, LAST = sizeof last / sizeof *last };
  dem_engine *engine = make(flows, 1);
  const dem_start *start = dem_engine_start(engine);
  for (int k = 0; k < start->nchannel; k++) {
    char name[128];
    snprintf(name, sizeof name, "%s [%s]", start->channel[k].name, start->channel[k].unit);
    if (k < FIRST)
      ck_assert_str_eq(name, expected[k]);
    if (k >= start->nchannel - LAST)
      ck_assert_str_eq(name, last[k - start->nchannel + LAST]);
  }
  dem_engine_destroy(&engine);
}
END_TEST

START_TEST(a_bad_scene_makes_no_engine) {
  const tdm_assigned_body plate = {.name = "plate", .mass = 1, .state = state_at(0, 0, 0)};
  const tdm_assignment assignment = {
      .scene = scene(",'gravitation':3"), .time_end = 1, .dt = dt, .n = 1, .nbody = 1, .body = &plate};
  dem_engine *engine = NULL;
  tdm_error err = {0};
  ck_assert_int_eq(dem_engine_create(&engine, &assignment, NULL, &err), TDM_ERR_SCENE);
  ck_assert_str_eq(err.path, "dem.gravitation");
  ck_assert_ptr_null(engine);
  json_decref(assignment.scene);
}
END_TEST

TEST_MAIN("dem interface", windows_do_not_change_a_run, a_slot_brings_back_every_bit, loads_are_what_particles_lose,
          contacts_feel_the_velocity_that_is_sent, what_is_not_wanted_need_not_be_given,
          channels_come_in_the_order_of_the_table, a_bad_scene_makes_no_engine)
