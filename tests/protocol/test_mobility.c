/* Accelerations and the reduced model over the wire: only where ASSIGN asks for them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/adapter/solver.h"
#include "tests/protocol/wire.h"

static const char slider[] =
    "{\"bodies\":[{\"name\":\"box\",\"mass\":4,\"inertia\":[1,1,1],\"position\":[0,0,0]}],\"joints\":[{\"name\":"
    "\"guide\",\"type\":\"prismatic\",\"bodies\":[\"ground\",\"box\"],\"point\":[0,0,0],\"axis\":[0,0,1]}],"
    "\"forces\":[{\"name\":\"spring\",\"type\":\"spring_damper\",\"bodies\":[\"ground\",\"box\"],\"points\":[[0,0,1],"
    "[0,0,0]],\"stiffness\":100,\"damping\":8}]}";

/* READY after an ASSIGN with "results" */
static json_t *assign(wire *w, json_t *results) {
  open_wire(w, &mbd_solver_ops, "inproc://test_mobility", "mobility");
  json_t *message = json_pack("{s:o, s:f, s:f, s:i, s:f, s:[{s:s}]}", "scene", json_loads(slider, 0, NULL), "end", 1.0,
                              "dt", 1e-3, "n", 1, "timeout", 5.0, "bodies", "name", "box");
  if (results)
    json_object_set_new(message, "results", results);
  return say(w, TDM_ASSIGN, message, TDM_READY);
}

static tdm_result window(wire *w, double force) {
  tdm_wrench load = {{0, 0, force}, {0, 0, 0}};
  tdm_step step = {.t1 = 1e-3, .nstep = 1, .nbody = 1, .nload = 1, .load = &load};
  return step_over(w, &step);
}

#define CLOSE(x, y) ck_assert_double_eq_tol(x, y, 1e-6)

START_TEST(test_asked_for) {
  wire w;
  json_t *ready = assign(&w, json_pack("[s, s, s]", "acceleration", "mobility", "something later"));
  json_t *rate = json_object_get(ready, "acceleration"), *mobility = json_object_get(ready, "mobility");
  ck_assert_uint_eq(json_array_size(rate), 6);
  CLOSE(json_number_value(json_array_get(rate, 2)), -9.81);
  ck_assert_int_eq(json_integer_value(json_object_get(mobility, "nfree")), 1);
  ck_assert_uint_eq(json_array_size(json_object_get(mobility, "numbers")), 36 + 2 + 4 * 6 + 2);
  CLOSE(json_number_value(json_array_get(json_object_get(mobility, "numbers"), 14)), 0.25);
  json_decref(ready);
  tdm_result r = window(&w, 40);
  ck_assert_int_eq(r.nacceleration, 1);
  ck_assert(r.has_mobility);
  const tdm_mobility *m = &r.mobility;
  ck_assert_int_eq(m->nfree, 1);
  double z = r.state[0].pose.position.z, v = r.state[0].twist.velocity.z, a = -9.81 + (40 - 100 * z - 8 * v) / 4;
  CLOSE(r.acceleration[2], a);
  for (int i = 0; i < 36; i++)
    CLOSE(m->Y[i], i == 14 ? 0.25 : 0);
  CLOSE(m->J[2] * m->acceleration[0], a);
  CLOSE(m->J[2] * m->velocity[0], v);
  CLOSE(m->J[2] * m->B[2], 0.25);
  CLOSE(m->stiffness[0], 25);
  CLOSE(m->damping[0], 2);
  close_wire(&w, true);
  ck_assert_int_eq(w.ended, TDM_OK);
}
END_TEST

START_TEST(test_not_asked_for) {
  wire w;
  json_t *ready = assign(&w, NULL);
  ck_assert_ptr_null(json_object_get(ready, "acceleration"));
  ck_assert_ptr_null(json_object_get(ready, "mobility"));
  json_decref(ready);
  tdm_result r = window(&w, 40);
  ck_assert_int_eq(r.nacceleration, 0);
  ck_assert(!r.has_mobility);
  close_wire(&w, true);
}
END_TEST

START_TEST(test_acceleration_alone) {
  wire w;
  json_decref(assign(&w, json_pack("[s]", "acceleration")));
  tdm_result r = window(&w, 0);
  ck_assert_int_eq(r.nacceleration, 1);
  ck_assert(!r.has_mobility);
  ck_assert(r.acceleration[2] < -9);
  close_wire(&w, true);
}
END_TEST

TEST_MAIN("mobility", test_asked_for, test_not_asked_for, test_acceleration_alone)
