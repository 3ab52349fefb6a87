/* The estimate of a run's error, from traces of motions that are known. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/estimate/error.h"
#include "tests/test_main.h"

#include <math.h>

static const double mass = 2;
static const tdm_mat3 inertia = {{{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}};

static tdm_state at(double z, double vz) {
  return (tdm_state){.pose = {.position = {0, 0, z}, .orientation.w = 1}, .twist.velocity.z = vz};
}

/* A body of 2 kg with a fill of 4 kg fixed to it, on a spring of 600 N/m, let go at z = 0.1 m: w = 10 rad/s. */
static const double fill = 4, w = 10, start = 0.1;

static double place(double t) {
  return start * cos(w * t);
}

static double rate(double t) {
  return -start * w * sin(w * t);
}

/* mean load of the fill on the body over [a, b]: -fill z'' */
static double load(double a, double b) {
  return -fill * (rate(b) - rate(a)) / (b - a);
}

typedef struct {
  double delay;       /* of the load that the body was given [s] */
  double noise;       /* of the rate: a step of that either way in each window [m/s] */
  double other_speed; /* what DEM's body has less at the windows' ends [m/s] */
} faults;

static void follow(cpl_trace *trace, int n, double h, const faults *f) {
  tdm_state from = at(place(0), rate(0));
  double last = 0;
  ck_assert(cpl_trace_init(trace, mass, &inertia, &from));
  for (int i = 0; i < n; i++) {
    const double t0 = i * h, t1 = (i + 1) * h;
    const double jump = f->noise * ((i * 7L + (long)i * i * 3) % 11 < 5 ? 1 : -1); /* the impulse's own, bounded */
    const tdm_state to = at(place(t1), rate(t1)), other = at(place(t1), rate(t1) - f->other_speed);
    cpl_trace_window window = {.t0 = t0, .t1 = t1, .start = &from, .end = &to};
    window.found.force.z = load(t0, t1) + mass * (jump - last) / h;
    window.given.force.z = load(t0 - f->delay, t1 - f->delay) + mass * (jump - last) / h;
    window.other_end = f->other_speed != 0 ? &other : NULL;
    cpl_trace_add(trace, &window);
    last = jump;
    from = to;
  }
}

static cpl_error estimate(int n, double h, faults f) {
  cpl_trace trace;
  cpl_error error;
  follow(&trace, n, h, &f);
  ck_assert(cpl_error_estimate(1, &trace, &error));
  cpl_trace_free(&trace);
  return error;
}

START_TEST(a_run_without_faults) {
  const cpl_error e = estimate(5000, 1e-3, (faults){0});
  ck_assert_double_eq_tol(e.added[2], fill, 0.01 * fill);
  ck_assert_double_eq_tol(e.of[CPL_POSITION].spread, start / sqrt(2), 0.01 * start);
  ck_assert_double_eq_tol(e.of[CPL_VELOCITY].spread, start * w / sqrt(2), 0.01 * start * w);
  ck_assert_double_lt(e.of[CPL_VELOCITY].coupling, 1e-15);
  ck_assert_double_lt(e.of[CPL_VELOCITY].fill, 0.01 * start * w);
  ck_assert_double_lt(e.of[CPL_VELOCITY].share, 1e-3);
  ck_assert(isnan(e.of[CPL_ANGLE].share)); /* it does not turn */
}
END_TEST

START_TEST(a_load_that_is_late) {
  /* 6 z'' + 600 z = owed': the body was given fill * w^2 z(t - d) instead of ... z(t): the swing answers in resonance,
   * e = fill w d / (2 * 6) * start * w t ... in amplitude, over T seconds its rms is that of T / sqrt(6) */
  const double d = 1e-3, T = 5, grows = fill * w * w * d / (2 * 6);
  const cpl_error e = estimate(5000, T / 5000, (faults){.delay = d});
  const double expected = start * grows * T / sqrt(6);
  ck_assert_msg(fabs(e.of[CPL_POSITION].coupling / expected - 1) < 0.2, "%g, expected %g", e.of[CPL_POSITION].coupling,
                expected);
  ck_assert_msg(fabs(e.of[CPL_VELOCITY].coupling / (w * expected) - 1) < 0.2, "%g, expected %g",
                e.of[CPL_VELOCITY].coupling, w * expected);
}
END_TEST

START_TEST(jitter_of_the_load) {
  const double noise = 1e-3;
  const cpl_error e = estimate(4000, 1e-3, (faults){.noise = noise});
  ck_assert_msg(fabs(e.of[CPL_VELOCITY].rattle / (noise * sqrt(2)) - 1) < 0.3, "%g", e.of[CPL_VELOCITY].rattle);
  ck_assert_double_lt(e.of[CPL_VELOCITY].coupling, 1e-15);
  ck_assert_double_gt(e.of[CPL_POSITION].rattle, 0);
}
END_TEST

START_TEST(ends_that_are_apart) {
  const double apart = 0.01;
  const cpl_error e = estimate(4000, 1e-3, (faults){.other_speed = apart});
  ck_assert_double_gt(e.of[CPL_VELOCITY].coupling, 0.1 * apart);
  ck_assert_double_lt(e.of[CPL_VELOCITY].coupling, 2 * apart);
}
END_TEST

/* Ends ten times as far apart as the body is fast: neither it nor the right one, which has no more energy (the exchange
 * made none), goes so fast. */
START_TEST(no_error_is_more_than_both_motions) {
  const cpl_error e = estimate(4000, 1e-3, (faults){.other_speed = 10 * start * w});
  ck_assert_double_le(e.of[CPL_VELOCITY].coupling, 2.1 * start * w / sqrt(2));
  ck_assert_double_ge(e.of[CPL_VELOCITY].coupling, start * w / sqrt(2));
  ck_assert_double_le(e.of[CPL_POSITION].coupling, 2.1 * start * sqrt(1.5)); /* from where it starts */
}
END_TEST

START_TEST(rows_are_left_out_without_a_change) {
  /* the same run in 4000 windows and in 64000, of which every 16th is kept */
  const faults late = {.delay = 1e-3};
  const cpl_error few = estimate(4000, 1e-3, late), many = estimate(64000, 1e-3 / 16, late);
  for (int q = CPL_POSITION; q <= CPL_VELOCITY; q++)
    ck_assert_double_eq_tol(many.of[q].coupling, few.of[q].coupling, 0.02 * few.of[q].coupling);
}
END_TEST

START_TEST(rows_at_output_times) {
  /* one window with ten output times in it, then another */
  cpl_trace trace;
  tdm_state from = at(0, 1), to, inside[10];
  tdm_wrench mean[10];
  double time[10];
  ck_assert(cpl_trace_init(&trace, mass, &inertia, &from));
  for (int window = 0; window < 2; window++) {
    to = at(0.5 * (window + 1), 1);
    for (int k = 0; k < 10; k++) {
      time[k] = 0.5 * window + 0.05 * (k + 1);
      inside[k] = at(time[k], 1);
      mean[k] = (tdm_wrench){.force = {0, 0, 3}};
    }
    const tdm_wrench given = {.force = {0, 0, 4}}, found = {.force = {0, 0, 3}};
    cpl_trace_add(&trace, &(cpl_trace_window){.t0 = 0.5 * window,
                                              .t1 = 0.5 * (window + 1),
                                              .start = &from,
                                              .end = &to,
                                              .given = given,
                                              .found = found,
                                              .nsample = 10,
                                              .sample_time = time,
                                              .sample = inside,
                                              .sample_load = mean,
                                              .stride = 1});
    from = to;
  }
  ck_assert_int_eq(trace.nrow, 21);
  for (int i = 0; i < 21; i++) {
    ck_assert_double_eq_tol(trace.row[i].t, 0.05 * i, 1e-12);
    ck_assert_double_eq_tol(trace.row[i].way[2], 0.05 * i, 1e-12);
    ck_assert_double_eq_tol(trace.row[i].given[2], 3 * 0.05 * i, 1e-12);
    ck_assert_double_eq_tol(trace.row[i].owed[2], 0.05 * i, 1e-12);
  }
  cpl_trace_free(&trace);
}
END_TEST

/* A body that hardly resists a turn about its own y, turned so that y is world x, and given an impulse of moment about
 * that in a window in the middle: its rate is off by M h / I_y from then on, whatever its other moments are; so it is
 * when its own frame is not the principal one. */
START_TEST(an_axis_of_its_own) {
  static const tdm_mat3 own[2] = {{{{1e-3, 0, 0}, {0, 1e-6, 0}, {0, 0, 2e-3}}},
                                  {{{0.5e-3 + 0.5e-6, 0.5e-3 - 0.5e-6, 0},
                                    {0.5e-3 - 0.5e-6, 0.5e-3 + 0.5e-6, 0},
                                    {0, 0, 2e-3}}}}; /* the first, turned by 45 degrees about z: small along (1, -1) */
  const double h = 1e-3, moment = 1e-4, turned[2] = {-M_PI / 2, M_PI / 4};
  for (int k = 0; k < 2; k++) {
    cpl_trace trace;
    cpl_error e;
    tdm_state from = at(0, 0);
    from.pose.orientation = tdm_quat_from_rotvec(tdm_v3(0, 0, turned[k]));
    from.twist.angular = tdm_v3(1, 0, 0);
    ck_assert(cpl_trace_init(&trace, mass, &own[k], &from));
    for (int i = 0; i < 1000; i++) {
      tdm_state to = from;
      to.pose.orientation = tdm_quat_turned(from.pose.orientation, tdm_v3(h * from.twist.angular.x, 0, 0));
      to.twist.angular.x = 1 + 0.1 * sin(0.01 * i);
      const tdm_wrench given = {.moment.x = i == 500 ? moment : 0};
      cpl_trace_add(&trace,
                    &(cpl_trace_window){.t0 = i * h, .t1 = (i + 1) * h, .start = &from, .end = &to, .given = given});
      from = to;
    }
    ck_assert(cpl_error_estimate(1, &trace, &e));
    const double expected = moment * h / 1e-6 / sqrt(2); /* rms: nothing in the first half */
    ck_assert_msg(fabs(e.of[CPL_ANGULAR_VELOCITY].coupling / expected - 1.05) < 0.1, "%d: %g, expected %g", k,
                  e.of[CPL_ANGULAR_VELOCITY].coupling, expected);
    ck_assert_double_lt(e.of[CPL_VELOCITY].coupling, 1e-15);
    cpl_trace_free(&trace);
  }
}
END_TEST

/* A ball that bounces on the ground. The exchange gives it energy all the time: impulses too much cancel from bounce to
 * bounce, but the blows come ever later. The right one does without. */
static void bounce(tdm_state *s, double gain, double h) {
  double *z = &s->pose.position.z, *vz = &s->twist.velocity.z;
  *vz += h * ((*vz > 0 ? gain : -gain) - 9.81);
  *z += h * *vz;
  if (*z < 0) {
    *z = -*z;
    *vz = -*vz;
  }
}

START_TEST(blows_at_other_times) {
  const double h = 2e-4, gain = 0.1;
  double place = 0, rate = 0;
  const int n = 5000;
  cpl_trace trace;
  cpl_error e;
  tdm_state from = at(0, 1), right = from;
  ck_assert(cpl_trace_init(&trace, mass, &inertia, &from));
  for (int i = 0; i < n; i++) {
    tdm_state to = from;
    bounce(&to, gain, h);
    bounce(&right, 0, h);
    const tdm_wrench given = {.force.z = mass * (from.twist.velocity.z > 0 ? gain : -gain)};
    const double made = given.force.z * (to.pose.position.z - from.pose.position.z);
    cpl_trace_add(
        &trace,
        &(cpl_trace_window){.t0 = i * h, .t1 = (i + 1) * h, .start = &from, .end = &to, .given = given, .made = made});
    place += pow(to.pose.position.z - right.pose.position.z, 2) / n;
    rate += pow(to.twist.velocity.z - right.twist.velocity.z, 2) / n;
    from = to;
  }
  ck_assert(cpl_error_estimate(1, &trace, &e));
  const double of_place = e.of[CPL_POSITION].coupling / sqrt(place), of_rate = e.of[CPL_VELOCITY].coupling / sqrt(rate);
  ck_assert_msg(of_place > 1. / 3 && of_place < 3, "%g", of_place);
  ck_assert_msg(of_rate > 1. / 3 && of_rate < 3, "%g", of_rate);
  /* a driver that gives as much energy as the motion has sets the pace: the cancelling impulses alone are left */
  const double free_rate = e.of[CPL_VELOCITY].coupling;
  trace.driven = 10 * mass;
  ck_assert(cpl_error_estimate(1, &trace, &e));
  ck_assert_double_lt(e.of[CPL_VELOCITY].coupling, 0.5 * free_rate);
  cpl_trace_free(&trace);
}
END_TEST

/* Bodies of 2 kg: the first on a damper, pushed into a bed that is a spring, with another one on a stiff spring. */
typedef struct {
  double bed, damper, tie, push; /* [N/m, N s/m, N/m, N] */
  int nbody;
} machine;

typedef struct {
  double place[2], rate[2];
} motion;

/* Over h from t, under a held load, or (held: NULL) that of the bed as it is. Returns the mean of the bed's. */
static double go_on(const machine *m, double t, double h, const double *held, motion *now) {
  enum { STEPS = 40 };
  const double dt = h / STEPS;
  double mean = 0;
  for (int i = 0; i < STEPS; i++, t += dt) {
    const double bed = -m->bed * now->place[0], tie = m->tie * (now->place[1] - now->place[0]);
    now->rate[0] += dt / mass * ((held ? *held : bed) - m->damper * now->rate[0] + tie + m->push * t * t * (3 - 2 * t));
    now->rate[1] -= dt / mass * tie;
    for (int k = 0; k < m->nbody; k++)
      now->place[k] += dt * now->rate[k];
    mean += bed / STEPS;
  }
  return mean;
}

/* Estimate over error, of place and rate of each body, where loads are those of the window before. */
static void beside_the_right_one(const machine *m, double ratio[2][2]) {
  enum { WINDOWS = 1000 };
  const double h = 1e-3;
  cpl_trace trace[2];
  cpl_error e[2];
  motion late = {.rate = {0.1, 0.1}}, right = late;
  double given = 0, square[2][2] = {{0}};
  tdm_state from = at(0, 0.1);
  for (int k = 0; k < m->nbody; k++)
    ck_assert(cpl_trace_init(&trace[k], mass, &inertia, &from));
  for (int i = 0; i < WINDOWS; i++) {
    const motion before = late;
    const double found = go_on(m, i * h, h, &given, &late);
    go_on(m, i * h, h, NULL, &right);
    for (int k = 0; k < m->nbody; k++) {
      const tdm_state start_of = at(before.place[k], before.rate[k]), end_of = at(late.place[k], late.rate[k]);
      cpl_trace_window window = {.t0 = i * h, .t1 = (i + 1) * h, .start = &start_of, .end = &end_of};
      window.found.force.z = k == 0 ? found : 0;
      window.given.force.z = k == 0 ? given : 0;
      cpl_trace_add(&trace[k], &window);
      square[k][0] += pow(late.place[k] - right.place[k], 2) / WINDOWS;
      square[k][1] += pow(late.rate[k] - right.rate[k], 2) / WINDOWS;
    }
    given = found;
  }
  ck_assert(cpl_error_estimate(m->nbody, trace, e));
  for (int k = 0; k < m->nbody; k++) {
    for (int j = 0; j < 2; j++)
      ratio[k][j] = e[k].of[CPL_POSITION + j].coupling / sqrt(square[k][j]);
    cpl_trace_free(&trace[k]);
  }
}

/* The throttle of a press and the bed under it leave little of what a late load does: without them the error of the
 * place would be that of a free body, some hundred times as much. */
START_TEST(a_bed_that_pushes_back) {
  double ratio[2][2];
  beside_the_right_one(&(machine){.bed = 2e4, .damper = 600, .push = 500, .nbody = 1}, ratio);
  for (int j = 0; j < 2; j++)
    ck_assert_msg(ratio[0][j] > 0.5 && ratio[0][j] < 2, "%d: %g", j, ratio[0][j]);
}
END_TEST

/* Only the first body feels a load that is late; the other goes with it. */
START_TEST(a_body_that_is_tied_to_another) {
  static const double ties[] = {1e4, 1e8}; /* the rows show how stiff the first is, and not the second */
  for (int i = 0; i < 2; i++) {
    double ratio[2][2];
    beside_the_right_one(&(machine){.bed = 500, .damper = 1, .tie = ties[i], .nbody = 2}, ratio);
    for (int k = 0; k < 2; k++)
      ck_assert_msg(ratio[k][0] > 1. / 3 && ratio[k][0] < 3, "tie %g, body %d: %g", ties[i], k, ratio[k][0]);
  }
}
END_TEST

/* Grains that come one by one are no jitter. */
START_TEST(blows_of_single_grains) {
  const double h = 1e-3;
  cpl_trace trace;
  cpl_error e;
  tdm_state from = at(0, 0);
  ck_assert(cpl_trace_init(&trace, mass, &inertia, &from));
  for (int i = 0; i < 2000; i++) {
    const double blow = i % 50 < 4 ? 1 + sin(i) / 4 : 0, rate_to = from.twist.velocity.z + h * blow / mass;
    const tdm_state to = at(from.pose.position.z + h * rate_to, rate_to);
    const tdm_wrench load_now = {.force.z = blow};
    cpl_trace_add(
        &trace, &(cpl_trace_window){
                    .t0 = i * h, .t1 = (i + 1) * h, .start = &from, .end = &to, .found = load_now, .given = load_now});
    from = to;
  }
  ck_assert(cpl_error_estimate(1, &trace, &e));
  ck_assert_double_eq(e.of[CPL_VELOCITY].rattle, 0);
  cpl_trace_free(&trace);
}
END_TEST

START_TEST(too_little_to_say) {
  const cpl_error e = estimate(5, 1e-3, (faults){0});
  for (int q = 0; q < CPL_QUANTITIES; q++)
    ck_assert(isnan(e.of[q].rms) && isnan(e.of[q].share));
}
END_TEST

TEST_MAIN("estimate", a_run_without_faults, a_load_that_is_late, jitter_of_the_load, ends_that_are_apart,
          no_error_is_more_than_both_motions, rows_are_left_out_without_a_change, rows_at_output_times,
          an_axis_of_its_own, blows_at_other_times, a_bed_that_pushes_back, a_body_that_is_tied_to_another,
          blows_of_single_grains, too_little_to_say)
