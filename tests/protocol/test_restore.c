/* SAVE and RESTORE: the DEM engine as a thread, spoken to over the wire and by a session. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/scheme/schemes.h"
#include "coupler/session/session.h"
#include "dem/adapter/solver.h"
#include "mbd/adapter/solver.h"
#include "tests/protocol/wire.h"

#include <stdio.h>
#include <string.h>

/* a box with grains that shakes */
static const char grains[] =
    "{\"materials\":[{\"name\":\"a\",\"density\":1000,\"young_modulus\":1e7,\"poisson_ratio\":0.25}],\"pairs\":[{"
    "\"materials\":[\"a\",\"a\"],\"restitution\":0.5,\"friction\":0.4}],\"bodies\":[{\"name\":\"box\",\"material\":"
    "\"a\",\"shapes\":[{\"type\":\"box\",\"side\":\"inside\",\"size\":[0.4,0.4,0.4]}]}],\"particles\":[{\"type\":"
    "\"random\",\"material\":\"a\",\"count\":60,\"radius\":[0.02,0.04],\"region\":{\"min\":[-0.2,-0.2,-0.2],\"max\":["
    "0.2,0.2,0.2]}}],\"sources\":[{\"name\":\"s\",\"material\":\"a\",\"radius\":0.01,\"rate\":300,\"region\":{\"min\":"
    "[-0.15,-0.15,0.15],\"max\":[0.15,0.15,0.19]}}]}";

static const char endpoint[] = "inproc://test_restore";

/* an ASSIGN for it */
static json_t *assignment(void) {
  json_t *assign =
      json_pack("{s:o, s:f, s:f, s:f, s:i, s:s, s:f, s:[{s:s, s:f, s:[f,f,f,f,f,f,f,f,f], s:[f,f,f,f,f,f,"
                "f,f,f,f,f,f,f]}]}",
                "scene", json_loads(grains, 0, NULL), "start", 0.0, "end", 1.0, "dt", 1e-4, "n", 100, "interpolation",
                "linear", "timeout", 5.0, "bodies", "name", "box", "mass", 10.0, "inertia", 1.0, 0.0, 0.0, 0.0, 1.0,
                0.0, 0.0, 0.0, 1.0, "state", 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
  ck_assert_ptr_nonnull(assign);
  return assign;
}

static void open_solver(wire *w) {
  open_wire(w, &dem_solver_ops, endpoint, "restore");
  json_t *ready = say(w, TDM_ASSIGN, assignment(), TDM_READY);
  w->nchannel = (int)json_array_size(json_object_get(ready, "channels"));
  json_decref(ready);
}

typedef struct {
  double value[64]; /* load, sample's load, channels */
} outcome;

/* window k, in which the box goes to a side, as far as `way` says */
static outcome window(wire *w, int k, double way) {
  double t1 = 0.01 * (k + 1);
  tdm_state ends[2] = {{.pose.orientation.w = 1}, {.pose.orientation.w = 1}};
  ends[0].pose.position.x = 0.01 * (k % 2);
  ends[1].pose.position.x = way * ((k + 1) % 2);
  ends[1].pose.position.y = way - 0.01;
  tdm_step step = {.window = (uint64_t)k,
                   .t0 = 0.01 * k,
                   .t1 = t1,
                   .nstep = 100,
                   .nbody = 1,
                   .nstate = 1,
                   .nsample = 1,
                   .start = ends,
                   .end = ends + 1,
                   .sample_time = &t1};
  tdm_result result = step_over(w, &step);
  outcome out = {{0}};
  memcpy(out.value, result.load, sizeof *result.load);
  memcpy(out.value + 6, result.sample_load, sizeof *result.sample_load);
  memcpy(out.value + 12, result.channel, (size_t)w->nchannel * sizeof(double));
  return out;
}

static void state(wire *w, tdm_message_type type, int slot) {
  json_t *answer = say(w, type, json_pack("{s:i}", "slot", slot), type);
  ck_assert_int_eq(json_integer_value(json_object_get(answer, "slot")), slot);
  json_decref(answer);
}

START_TEST(test_back_and_forth) {
  /* iterating on a window, with another path each time: in the end the same bits as without */
  wire w;
  outcome out[2][20];
  for (int run = 0; run < 2; run++) {
    open_solver(&w);
    for (int k = 0; k < 20; k++) {
      if (run == 1) {
        state(&w, TDM_SAVE, k % 3);
        for (int again = 0; again < 2; again++) {
          outcome other = window(&w, k, 0.012 + 0.001 * again);
          ck_assert(k < 10 || memcmp(&other, &out[0][k], sizeof other) != 0);
          state(&w, TDM_RESTORE, k % 3);
        }
      }
      out[run][k] = window(&w, k, 0.01);
    }
    close_wire(&w, true);
    ck_assert_int_eq(w.ended, TDM_OK);
  }
  ck_assert_mem_eq(out[0], out[1], sizeof out[0]);
  ck_assert(out[0][19].value[12] > 60); /* particles came meanwhile */
  ck_assert(out[0][19].value[0] != 0);
}
END_TEST

static void refused(json_t *slot) {
  wire w;
  open_solver(&w);
  json_t *answer = say(&w, TDM_RESTORE, json_pack("{s:o}", "slot", slot), TDM_ERROR);
  ck_assert_str_eq(json_string_value(json_object_get(answer, "status")), "TDM_ERR_PROTOCOL");
  ck_assert_ptr_nonnull(strstr(json_string_value(json_object_get(answer, "message")), "RESTORE"));
  json_decref(answer);
  close_wire(&w, false);
  ck_assert_int_eq(w.ended, TDM_ERR_PROTOCOL);
}

START_TEST(test_refused) {
  refused(json_integer(3)); /* nothing there */
  refused(json_integer(-1));
  refused(json_integer(16));
  refused(json_string("0"));
}
END_TEST

/* ---- a session ---- */

/* the load on the cube after `n` windows of 200 steps in which it stands still, from window k on */
static tdm_wrench session_windows(cpl_session *s, int k, int n) {
  tdm_wrench load = {0};
  tdm_state cube = s->body[0].state;
  tdm_error err = {0};
  for (int w = k; w < k + n; w++) {
    tdm_step step = {.window = (uint64_t)w,
                     .t0 = 1e-3 * w,
                     .t1 = 1e-3 * (w + 1),
                     .nstep = 200,
                     .nbody = 1,
                     .nstate = 1,
                     .start = &cube,
                     .end = &cube};
    tdm_result result;
    ck_assert_msg(!cpl_session_step(s, CPL_DEM, &step, &result, &err), "%s", err.message);
    load = result.load[0];
  }
  return load;
}

START_TEST(test_session) {
  tdm_scene scene;
  tdm_error err = {0};
  cpl_settings settings;
  cpl_session s;
  ck_assert_int_eq(tdm_scene_read(&scene, TANDEM_SOURCE_DIR "/scenarios/collision/scene.json", &err), TDM_OK);
  ck_assert_int_eq(tdm_scene_set(&scene, "coupling.transport=inproc", &err), TDM_OK);
  ck_assert_int_eq(cpl_settings_read(&settings, &scene, cpl_schemes, &err), TDM_OK);
  void *context = tdm_context_create();
  ck_assert_int_eq(cpl_session_open(&s, &settings, endpoint, context, &err), TDM_OK);
  const tdm_solver_ops *const ops[] = {[CPL_MBD] = &mbd_solver_ops, [CPL_DEM] = &dem_solver_ops};
  for (int r = 0; r < CPL_NROLE; r++) {
    char log[512];
    snprintf(log, sizeof log, "%s/test_restore.%d.log", TANDEM_TEST_DIR, r);
    ck_assert_int_eq(cpl_launch_thread(&s.partner[r].child, ops[r], endpoint, context, log, 5, &err), TDM_OK);
  }
  ck_assert_msg(!cpl_session_start(&s, &scene, &err), "%s", err.message);

  /* there, back, and there again */
  const tdm_wrench before = session_windows(&s, 0, 2);
  ck_assert_int_eq(cpl_session_save(&s, CPL_DEM, 5, &err), TDM_OK);
  const tdm_wrench first = session_windows(&s, 2, 2);
  ck_assert_int_eq(cpl_session_restore(&s, CPL_DEM, 5, &err), TDM_OK);
  const tdm_wrench again = session_windows(&s, 2, 2);
  ck_assert_mem_eq(&first, &again, sizeof first);
  ck_assert(memcmp(&before, &first, sizeof first) != 0);
  /* an empty slot is the solver's error, which names it */
  ck_assert_int_eq(cpl_session_restore(&s, CPL_DEM, 6, &err), TDM_ERR_PROTOCOL);
  ck_assert_ptr_nonnull(strstr(err.message, "slot 6"));

  cpl_child *child[CPL_NROLE];
  for (int r = 0; r < CPL_NROLE; r++)
    child[r] = s.partner[r].child;
  cpl_session_close(&s, &err);
  for (int r = 0; r < CPL_NROLE; r++)
    ck_assert(cpl_child_stop(&child[r], 5));
  tdm_context_destroy(&context);
  cpl_settings_free(&settings);
  tdm_scene_destroy(&scene);
}
END_TEST

/* What a foreign server should not ask for, or not send: an ERROR that says so, and an end in order. */
START_TEST(test_foreign_assignments) {
  static const char *const cases[][3] = {
      {"results", "[\"acceleration\"]", "asks for the capability \"acceleration\""},
      {"results", "[\"interface\", \"mobility\"]", "asks for the capability \"mobility\""},
      {"wall_velocity", "\"felt\"", "wall_velocity: \"felt\""},
      {"inertia", "[-1,0,0,0,1,0,0,0,1]", "inertia: is not symmetric, or negative"},
      {"state", "[0,0,0,0,0,0,0,0,0,0,0,0,0]", "state: has a quaternion that is not of norm 1"},
      {"state", "[0,0,0,100,0,0,0,0,0,0,0,0,0]", "state: has a quaternion that is not of norm 1"}};
  for (int i = 0; i < 6; i++) {
    wire w;
    json_t *assign = assignment(), *value = json_loads(cases[i][1], JSON_DECODE_ANY, NULL);
    json_t *to = i < 3 ? assign : json_array_get(json_object_get(assign, "bodies"), 0);
    json_object_set_new(to, cases[i][0], value);
    open_wire(&w, &dem_solver_ops, endpoint, "restore");
    json_t *error = say(&w, TDM_ASSIGN, assign, TDM_ERROR);
    const char *message = json_string_value(json_object_get(error, "message"));
    ck_assert_msg(message && strstr(message, "malformed ASSIGN") && strstr(message, cases[i][2]), "%s", message);
    json_decref(error);
    close_wire(&w, false);
    ck_assert_int_eq(w.ended, TDM_ERR_PROTOCOL);
  }
}
END_TEST

START_TEST(test_a_step_without_an_orientation) {
  wire w;
  open_solver(&w);
  tdm_state ends[2] = {{.pose.orientation.w = 1}};
  tdm_step step = {.t1 = 0.01, .nstep = 100, .nbody = 1, .nstate = 1, .start = ends, .end = ends + 1};
  ck_assert_int_eq(tdm_step_write(&w.out, &step, &w.err), TDM_OK);
  ck_assert_int_eq(tdm_transport_send(w.transport, &w.peer, &w.out, &w.err), TDM_OK);
  ck_assert_int_eq(hear(&w).type, TDM_ERROR);
  close_wire(&w, false);
  ck_assert_int_eq(w.ended, TDM_ERR_PROTOCOL);
}
END_TEST

TEST_MAIN("restore", test_foreign_assignments, test_a_step_without_an_orientation, test_back_and_forth, test_refused,
          test_session)
