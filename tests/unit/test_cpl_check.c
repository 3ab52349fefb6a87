/* What the server takes from a partner for a number, a mobility, an inertia. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/scheme/schemes.h"
#include "coupler/session/session.h"
#include "tests/test_main.h"

#include <math.h>
#include <string.h>

START_TEST(inertias) {
  static const struct {
    double m[9];
    int good;
  } cases[] = {
      {{1, 0, 0, 0, 2, 0, 0, 0, 3}, 1},
      {{0, 0, 0, 0, 2, 0, 0, 0, 2}, 1}, /* a rod */
      {{0, 0, 0, 0, 0, 0, 0, 0, 0}, 1}, /* a point */
      {{2, -1, 0, -1, 2, 0, 0, 0, 1}, 1},
      {{1e-14, 0, 0, 0, 1e-14, 0, 0, 0, 1e-14}, 1},
      {{-1, 0, 0, 0, 1, 0, 0, 0, 1}, 0},
      {{-1, 0, 0, 0, -1, 0, 0, 0, -1}, 0},
      {{1, 2, 0, 2, 1, 0, 0, 0, 1}, 0},                   /* negative about [1, -1, 0] */
      {{1, 0, 0, 0, 1, 2, 0, 2, 1}, 0},                   /* and others */
      {{1, 0, 2, 0, 1, 0, 2, 0, 1}, 0},                   /* */
      {{1, -0.9, -0.9, -0.9, 1, -0.9, -0.9, -0.9, 1}, 0}, /* about [1, 1, 1], though every pair is good */
      {{1, 0.1, 0, 0, 1, 0, 0, 0, 1}, 0},                 /* not symmetric */
      {{NAN, 0, 0, 0, 1, 0, 0, 0, 1}, 0},
      {{1e200, 0, 0, 0, 1e200, 0, 0, 0, 1e200}, 0},
  };
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    tdm_mat3 m;
    memcpy(&m, cases[k].m, sizeof m);
    ck_assert_msg(tdm_is_inertia(&m) == cases[k].good, "case %zu", k);
  }
}
END_TEST

/* A session of one body under the scheme proxy, and a RESULT of mbd that is good. */
typedef struct {
  cpl_settings settings;
  cpl_body_names names;
  cpl_session session;
  tdm_assigned_body body;
  tdm_step step;
  tdm_state state, sample;
  double acceleration[6], Y[36], sample_time, channel;
  tdm_channel announced;
  tdm_energy energy;
  tdm_result result;
} stage;

static void set_up(stage *s) {
  *s = (stage){.names = {{"arm", "bucket"}}, .announced = {.name = "joint.pin.fx", .unit = "N"}};
  s->settings.nbody = 1;
  s->settings.body = &s->names;
  s->settings.scheme = cpl_schemes[0];
  s->session = (cpl_session){.settings = &s->settings, .scheme = cpl_schemes[0], .body = &s->body};
  cpl_partner *p = &s->session.partner[CPL_MBD];
  p->capabilities = json_pack("[s, s, s]", "acceleration", "mobility", "energy");
  p->nchannel = 1;
  p->channel = &s->announced;
  s->state.pose.orientation.w = s->sample.pose.orientation.w = 1;
  for (int i = 0; i < 6; i++)
    s->Y[7 * i] = i < 3 ? 1 : 1e-6;
  s->sample_time = 0.5;
  s->step = (tdm_step){.t1 = 1, .nstep = 10, .nbody = 1, .nsample = 1, .sample_time = &s->sample_time};
  s->result = (tdm_result){.t = 1,
                           .nbody = 1,
                           .nstate = 1,
                           .nsample = 1,
                           .nchannel = 1,
                           .nacceleration = 1,
                           .has_mobility = true,
                           .has_energy = true,
                           .state = &s->state,
                           .sample_state = &s->sample,
                           .channel = &s->channel,
                           .acceleration = s->acceleration,
                           .energy = &s->energy,
                           .mobility = {.nbody = 1, .Y = s->Y}};
}

/* The check's word; "" when the result is taken. */
static const char *word_of(stage *s) {
  static tdm_error err;
  err = (tdm_error){0};
  cpl_session_check_result(&s->session, CPL_MBD, &s->step, &s->result, &err);
  json_decref(s->session.partner[CPL_MBD].capabilities);
  s->session.partner[CPL_MBD].capabilities = NULL;
  return err.message;
}

#define EXPECT(change, word)                                                         \
  do {                                                                               \
    stage s;                                                                         \
    set_up(&s);                                                                      \
    change;                                                                          \
    const char *is = word_of(&s);                                                    \
    ck_assert_msg(*(word) ? strstr(is, word) != NULL : !*is, "%s: %s", #change, is); \
  } while (0)

START_TEST(results) {
  EXPECT((void)0, "");
  EXPECT(s.state.pose.position.x = NAN, "a state of body \"arm\" that is not finite");
  EXPECT(s.state.twist.velocity.y = -1e151, "a state of body \"arm\" that is too large to be squared");
  EXPECT(s.state.pose.orientation.w = 0, "a state of body \"arm\" that has a quaternion that is not of norm 1");
  EXPECT(s.state.pose.orientation.x = 1e-7, "");
  EXPECT(s.sample.twist.angular.z = INFINITY, "a recorded state of body \"arm\" that is not finite");
  EXPECT(s.sample.pose.orientation.w = 100, "a recorded state of body \"arm\" that has a quaternion");
  EXPECT(s.channel = NAN, "for the channel \"joint.pin.fx\" at 0.5 s, which is not finite");
  EXPECT(s.channel = 1e200, "for the channel \"joint.pin.fx\" at 0.5 s, which is too large to be squared");
  EXPECT((s.announced.gaps = true, s.channel = NAN), "");
  EXPECT((s.announced.gaps = true, s.channel = INFINITY), "for the channel \"joint.pin.fx\" at 0.5 s, which is not");
  EXPECT(s.acceleration[5] = 1e300, "an acceleration of body \"arm\" that is too large");
  EXPECT(s.energy.supplied = NAN, "a supplied energy");
  EXPECT(s.energy.kinetic = 1e200, "energy");
  EXPECT((s.energy.kinetic = NAN, s.energy.stored = NAN), ""); /* it did not look */
  EXPECT(s.result.wall = NAN, "a wall time");
  EXPECT(s.result.wall = -1, "a wall time");
  EXPECT(s.result.t = 0.5, "it reached 0.5 s");
}
END_TEST

START_TEST(mobilities) {
  EXPECT(s.Y[0] = -1, "a mobility that has a negative number on its diagonal");
  EXPECT(s.Y[0] = 0, ""); /* a joint blocks it */
  EXPECT(s.Y[1] = 0.5, "a mobility that is not symmetric");
  EXPECT((s.Y[1] = 0.5, s.Y[6] = 0.5), "");
  EXPECT((s.Y[1] = 2, s.Y[6] = 2), "a mobility that is not positive");
  EXPECT((s.Y[3] = 1e-5, s.Y[18] = 1e-5), "");
  EXPECT(s.Y[35] = NAN, "a mobility that is not finite");
  EXPECT((s.Y[1] = 0.5, s.Y[6] = 0.5 + 1e-12), ""); /* rounding */
}
END_TEST

START_TEST(what_ready_says) {
  static const struct {
    double w, x, mass, inertia;
    const char *word;
  } cases[] = {{1, 0, 2, 1, ""},
               {1, 0, INFINITY, 1, ""},
               {100, 0, 2, 1, "the state of body \"arm\" has a quaternion"},
               {1, 1e160, 2, 1, "the state of body \"arm\" is too large"},
               {1, 0, 1e200, 1, "the mass of body \"arm\" is too large"},
               {1, 0, 2, -1, "the inertia of body \"arm\" is not symmetric, or negative about some axis"}};
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    stage s;
    tdm_error err = {0};
    double initial = NAN;
    set_up(&s);
    s.session.partner[CPL_MBD].initial = &initial;
    s.session.mobility = s.result.mobility;
    s.body.mass = cases[k].mass;
    s.body.inertia.m[0][0] = cases[k].inertia;
    s.body.inertia.m[1][1] = s.body.inertia.m[2][2] = 1;
    s.body.state.pose.orientation.w = cases[k].w;
    s.body.state.pose.position.x = cases[k].x;
    cpl_session_check_ready(&s.session, CPL_MBD, &err);
    ck_assert_msg(*cases[k].word ? strstr(err.message, cases[k].word) != NULL : !err.status, "%s", err.message);
    err = (tdm_error){0};
    s.Y[7] = -2;
    s.body.state = s.state;
    s.body.mass = 1;
    s.body.inertia.m[0][0] = 1;
    cpl_session_check_ready(&s.session, CPL_MBD, &err);
    ck_assert_msg(strstr(err.message, "malformed READY: the mobility has a negative") != NULL, "%s", err.message);
    word_of(&s);
  }
}
END_TEST

TEST_MAIN("checks of what partners send", inertias, results, mobilities, what_ready_says)
