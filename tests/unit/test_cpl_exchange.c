/* The energy that the exchange of a window has made, with loads from outside that change from window to window. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/window.h"
#include "tests/test_main.h"

/* A body that particles push by a constant force along x and turn by a moment about z, and somebody else by `external`:
 * MBD tells the work of both, DEM that of the particles. */
static cpl_exchange exchange_after(const tdm_wrench *external, int nwindow, bool prescribed) {
  const tdm_wrench particles = {.force = {3, 0, 0}, .moment = {0, 0, 2}};
  const double way = 0.1, turn = 0.02; /* of a window */
  tdm_state start = {.pose.orientation = {1, 0, 0, 0}}, end;
  tdm_energy energy = {0};
  tdm_interface body = {0};
  tdm_wrench held;
  cpl_loop loop = {.nbody = 1, .state_start = &start, .state_end = &end, .external = &held, .prescribed = &prescribed};
  loop.result[CPL_MBD] = (tdm_result){.has_energy = true, .energy = &energy};
  loop.result[CPL_DEM] = (tdm_result){.ninterface = 1, .body = &body};
  for (int k = 0; k < nwindow; k++) {
    end = start;
    end.pose.position.x += way;
    end.pose.orientation = tdm_quat_turned(start.pose.orientation, tdm_v3(0, 0, turn));
    held = external[k];
    body.work = particles.force.x * way + particles.moment.z * turn;
    energy.exchanged += body.work + held.force.x * way + held.moment.z * turn;
    loop.exchange = cpl_loop_exchange(&loop);
    start = end;
  }
  return loop.exchange;
}

static const tdm_wrench loads[3][4] = {
    {{.force = {0}, .moment = {0}}},
    {{.force = {50, 7, -2}}, {.force = {-20, 1, 0}}, {.force = {5, 0, 0}}, {.force = {0, 0, 1}}},
    {{.moment = {1, 2, 30}}, {.force = {9, 0, 0}, .moment = {0, 0, -8}}, {.moment = {0, 5, 0}}, {.moment = {0, 0, 4}}}};

START_TEST(loads_from_outside_make_nothing) {
  const cpl_exchange x = exchange_after(loads[_i], 4, false);
  ck_assert_double_eq_tol(x.made, 0, 1e-12);
  ck_assert_double_eq_tol(x.worked, 4 * (0.3 + 0.04), 1e-12);
}
END_TEST

START_TEST(prescribed_bodies_are_left_out) {
  const cpl_exchange x = exchange_after(loads[1], 4, true);
  ck_assert_double_eq(x.made, 0);
  ck_assert_double_eq(x.worked, 0);
}
END_TEST

TEST_MAIN_ROWS("exchange", {loads_from_outside_make_nothing, 3}, {prescribed_bodies_are_left_out, 1})
