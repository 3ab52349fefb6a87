/* The mechanism that DEM carries through a window: momentum, work and moments, stiff bushings, hinges, drift. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/numerics/test_dem_support.h"
#include "tests/test_main.h"

/* A solver with a cube of side 0.2 m and 10 kg at the origin, and maybe a particle of 1 kg on its way to it. */
typedef struct {
  void *self;
  json_t *json;
  tdm_assigned_body body[2];
  int nbody;
  double time, block[4096];
  tdm_step step;
  tdm_state start[2];
  tdm_interface seen[2];
  tdm_wrench load[2];
  tdm_result result;
} wagon;

static const double dt = 1e-5;

static const char cubes[] =
    "{'gravity': [0,0,0], 'materials': [{'name': 'm', 'density': 1000, 'young_modulus': 1e7, 'poisson_ratio': 0.3}],"
    "'pairs': [{'materials': ['m','m'], 'restitution': 0.6, 'friction': 0.3}],"
    "'bodies': [{'name': 'a', 'material': 'm', 'shapes': [{'type': 'box', 'size': [0.2,0.2,0.2], 'side': 'outside'}]},"
    " {'name': 'b', 'material': 'm', 'shapes': [{'type': 'box', 'size': [0.2,0.2,0.2], 'side': 'outside'}]}],"
    "'particles': [%s]}";
static const char ball[] = "{'type': 'list', 'material': 'm', 'radius': 0.02, 'mass': 1, 'positions': "
                           "[[-0.1201,0.05,0.03]], 'velocity': [2,0.5,0], 'spin': [0,0,9]}";

/* `nbody` cubes, the second at y = 5 m */
static wagon *wagon_make(int nbody, bool with_ball) {
  wagon *w = calloc(1, sizeof *w);
  tdm_error err = {0};
  tdm_ready ready = {0};
  w->json = scene_json(cubes, with_ball ? ball : "");
  w->nbody = nbody;
  if (nbody == 1)
    json_array_remove(json_object_get(w->json, "bodies"), 1);
  for (int i = 0; i < nbody; i++) {
    w->start[i] = state_at(0, 5 * i, 0);
    w->body[i] = (tdm_assigned_body){.name = i ? "b" : "a", .mass = 10, .state = w->start[i]};
    w->body[i].inertia.m[0][0] = w->body[i].inertia.m[1][1] = w->body[i].inertia.m[2][2] = 0.0667;
  }
  tdm_assignment a = {.scene = w->json, .time_end = 10, .dt = dt, .n = 1, .nbody = nbody, .body = w->body};
  dem_solver_ops.create(&w->self, &a, &ready, NULL, &err);
  ck_assert_msg(err.status == TDM_OK, "%s: %s", err.path, err.message);
  /* block: accelerations, loads, correction, reduced model; all zero */
  int k6 = 6 * nbody;
  w->step.proxy = (tdm_proxy){.acceleration = w->block,
                              .load = (tdm_wrench *)(void *)(w->block + k6),
                              .correction = w->block + 2 * k6,
                              .mobility = {.nbody = nbody}};
  tdm_mobility_point(&w->step.proxy.mobility, w->block + 4 * k6);
  return w;
}

static void wagon_free(wagon *w) {
  dem_solver_ops.destroy(w->self);
  json_decref(w->json);
  free(w);
}

/* f independent velocities */
static tdm_mobility *freedom(wagon *w, int f) {
  w->step.proxy.mobility.nfree = f;
  tdm_mobility_point(&w->step.proxy.mobility, w->block + 24 * w->nbody);
  return &w->step.proxy.mobility;
}

/* the first cube free: u' its twist */
static void set_free(wagon *w) {
  tdm_mobility *m = freedom(w, 6);
  for (int i = 0; i < 6; i++) {
    m->J[i * 6 + i] = 1;
    m->B[i * 6 + i] = m->Y[i * 6 + i] = i < 3 ? 1.0 / 10 : 1 / 0.0667;
  }
}

static double *velocities(tdm_state *s) {
  return (double *)(void *)&s->twist;
}

/* One window; the bodies go on from where the proxy went. */
static void roll(wagon *w, uint64_t n) {
  tdm_error err = {0};
  memset(w->seen, 0, sizeof w->seen);
  tdm_step *s = &w->step;
  s->t0 = w->time;
  s->t1 = w->time + (double)n * dt;
  s->nstep = n;
  s->nbody = s->nstate = w->nbody;
  s->start = s->end = w->start;
  s->has_proxy = true;
  for (int j = 0; j < s->proxy.mobility.nfree && s->proxy.mobility.nfree == 6; j++)
    s->proxy.mobility.velocity[j] = velocities(&w->start[0])[j];
  w->result = (tdm_result){.nbody = w->nbody, .nload = 1, .load = w->load, .ninterface = w->nbody, .body = w->seen};
  dem_solver_ops.step(w->self, s, &w->result, &err);
  ck_assert_msg(err.status == TDM_OK, "%s: %s", err.path, err.message);
  for (int i = 0; i < w->nbody; i++)
    w->start[i] = w->seen[i].end;
  w->time = s->t1;
}

static const dem_data *inside(const wagon *w) {
  return dem_solver_data(w->self);
}

START_TEST(momentum_goes_over_without_loss) {
  static const uint64_t windows[] = {1, 7, 100, 2000};
  for (int i = 0; i < 4; i++) {
    wagon *w = wagon_make(1, true);
    set_free(w);
    tdm_vec3 before = inside(w)->state.pace[0].velocity;
    double way = 0;
    for (uint64_t k = 0; k < 2000; k += windows[i]) {
      tdm_state start = w->start[0];
      roll(w, windows[i]);
      const tdm_interface *b = &w->seen[0];
      const double H = (double)windows[i] * dt;
      /* as a free body under the polynomial with these moments */
      ck_near(b->end.twist.velocity.x, start.twist.velocity.x + H * b->moment[0].force.x / 10, 1e-14);
      ck_near(b->end.twist.angular.z, start.twist.angular.z + H * b->moment[0].moment.z / 0.0667, 1e-13);
      ck_near(b->end.pose.position.x,
              start.pose.position.x + H * start.twist.velocity.x +
                  H * H * 0.5 * (b->moment[0].force.x - b->moment[1].force.x) / 10,
              1e-15);
      tdm_vec3 v0 = start.twist.velocity, v1 = b->end.twist.velocity, o0 = start.twist.angular,
               o1 = b->end.twist.angular;
      double gained = 5 * (tdm_dot(v1, v1) - tdm_dot(v0, v0)) + 0.5 * 0.0667 * (tdm_dot(o1, o1) - tdm_dot(o0, o0));
      ck_near(b->work, gained, 1e-13);
      way += b->moment[0].force.x * H;
    }
    ck_assert_double_gt(way, 2); /* it did hit */
    tdm_vec3 lost = tdm_sub(before, inside(w)->state.pace[0].velocity);
    ck_near(lost.x, 10 * w->start[0].twist.velocity.x, 1e-12);
    ck_near(lost.y, 10 * w->start[0].twist.velocity.y, 1e-12);
    ck_near(lost.z, 10 * w->start[0].twist.velocity.z, 1e-12);
    wagon_free(w);
  }
}
END_TEST

/* A load of 300 N is on the cube at the start, whatever its contacts do then: what DEM says they did is what the cube
 * has gained, whether the impact comes in steps of a window that begins so or not. */
START_TEST(work_is_what_the_body_gains) {
  static const uint64_t windows[] = {1, 5, 50, 500};
  for (int i = 0; i < 4; i++) {
    wagon *w = wagon_make(1, true);
    set_free(w);
    double all = 0, energy = 0;
    for (uint64_t k = 0; k < 1500; k += windows[i]) {
      w->block[0] = 30; /* under the load at the start */
      w->block[6] = 300;
      roll(w, windows[i]);
      const tdm_twist end = w->seen[0].end.twist;
      const double now = 5 * tdm_dot(end.velocity, end.velocity) + 0.5 * 0.0667 * tdm_dot(end.angular, end.angular);
      ck_near(w->seen[0].work, now - energy, 1e-13);
      all += w->seen[0].work;
      energy = now;
    }
    ck_assert_double_gt(all, 0.01);
    wagon_free(w);
  }
}
END_TEST

START_TEST(mobility_alone_moves_a_free_body_alike) {
  wagon *a = wagon_make(1, true), *b = wagon_make(1, true);
  set_free(a);
  for (int i = 0; i < 6; i++)
    freedom(b, 0)->Y[i * 7] = i < 3 ? 1.0 / 10 : 1 / 0.0667;
  roll(a, 1000);
  roll(b, 1000);
  ck_assert_double_ne(a->start[0].twist.velocity.x, 0);
  ck_assert_mem_eq(&a->start[0], &b->start[0], sizeof a->start[0]);
  wagon_free(a);
  wagon_free(b);
}
END_TEST

/* a bushing of 1e11 N/m holds the cube: its period is a fifth of the step */
START_TEST(stiff_springs_are_exact) {
  wagon *w = wagon_make(1, false);
  tdm_mobility *m = freedom(w, 1);
  const double omega = 1e6, decay = 2e3, v = 3;
  m->J[0] = 1;
  m->B[0] = m->Y[0] = 0.1;
  m->velocity[0] = w->start[0].twist.velocity.x = v;
  m->stiffness[0] = omega * omega + decay * decay;
  m->damping[0] = 2 * decay;
  m->acceleration[0] = -2 * decay * v;
  w->block[0] = m->acceleration[0];
  roll(w, 100);
  const double t = 100 * dt, x = v / omega * sin(omega * t) * exp(-decay * t);
  ck_near(w->start[0].pose.position.x, x, 1e-15);
  ck_near(w->start[0].twist.velocity.x, v * exp(-decay * t) * (cos(omega * t) - decay / omega * sin(omega * t)), 1e-9);
  wagon_free(w);
}
END_TEST

/* an arm of 2 m on a hinge about z, at the origin; at rest first and pushed, or on its way */
START_TEST(a_hinged_body_stays_on_its_circle) {
  for (int moving = 0; moving < 2; moving++) {
    wagon *w = wagon_make(1, false);
    w->start[0].pose.position = (tdm_vec3){2, 0, 0};
    ((dem_data *)(uintptr_t)inside(w))->state.pose[0] = w->start[0].pose;
    tdm_mobility *m = freedom(w, 1);
    const double rate = 3 * moving, push = 2 * (1 - moving);
    m->J[1] = 2;
    m->J[5] = 1;
    m->J_rate[0] = -2 * rate;
    m->velocity[0] = rate;
    m->acceleration[0] = push;
    w->start[0].twist = (tdm_twist){{0, 2 * rate, 0}, {0, 0, rate}};
    w->block[0] = -2 * rate * rate;
    w->block[1] = 2 * push;
    w->block[5] = push;
    roll(w, 20000);
    const double t = 20000 * dt, angle = rate * t + 0.5 * push * t * t, speed = rate + push * t;
    ck_near(w->start[0].pose.position.x, 2 * cos(angle), 1e-9);
    ck_near(w->start[0].pose.position.y, 2 * sin(angle), 1e-9);
    ck_near(w->start[0].twist.velocity.x, -2 * sin(angle) * speed, 1e-9);
    ck_near(w->start[0].pose.orientation.z, sin(angle / 2), 1e-9);
    wagon_free(w);
  }
}
END_TEST

/* The cube slides along a rod, which turns about z: at rest at first, and then pushed, or on its way. */
static void set_rod(wagon *w, double rate, double push) {
  tdm_mobility *m = freedom(w, 2);
  m->J[0] = m->J[2 * 5 + 1] = 1;
  m->J_rate[2] = rate;
  m->velocity[0] = 1;
  m->velocity[1] = rate;
  m->acceleration[1] = push;
  w->start[0].twist = (tdm_twist){{1, 0, 0}, {0, 0, rate}};
  w->block[1] = rate;
  w->block[5] = push;
}

/* That freedoms turn with a body is learnt when it turns; a state from before does not know it. */
START_TEST(a_window_that_is_repeated) {
  wagon *w = wagon_make(1, false);
  tdm_error err = {0};
  const tdm_state first = w->start[0];
  tdm_state end;
  ck_assert_int_eq(dem_solver_ops.save(w->self, 0, &err), TDM_OK);
  for (int again = 0; again < 2; again++) {
    w->start[0] = first;
    w->time = 0;
    set_rod(w, 0, 2);
    roll(w, 1000);
    if (again)
      ck_assert_mem_eq(&w->start[0], &end, sizeof end);
    end = w->start[0];
    set_rod(w, 3, 0);
    roll(w, 1000);
    ck_assert_int_eq(dem_solver_ops.restore(w->self, 0, &err), TDM_OK);
  }
  wagon_free(w);
}
END_TEST

/* Two parallel arms of 2 m carry the cube on a circle, and it does not turn: J goes along with the arms, not with the
 * cube. What is left is the line's own error, (rate t)^3/3. */
START_TEST(a_body_on_a_circle_that_does_not_turn) {
  wagon *w = wagon_make(1, false);
  const double rate = 3, t = 1000 * dt;
  tdm_mobility *m = freedom(w, 1);
  w->start[0].pose.position = (tdm_vec3){2, 0, 0};
  ((dem_data *)(uintptr_t)inside(w))->state.pose[0] = w->start[0].pose;
  m->J[1] = 2;
  m->J_rate[0] = -2 * rate;
  m->velocity[0] = rate;
  w->start[0].twist.velocity = (tdm_vec3){0, 2 * rate, 0};
  w->block[0] = -2 * rate * rate;
  roll(w, 1000);
  ck_near(w->start[0].pose.position.x, 2 * cos(rate * t), 1e-6);
  ck_near(w->start[0].pose.position.y, 2 * sin(rate * t), 1e-5);
  ck_near(w->start[0].twist.velocity.x, -2 * rate * sin(rate * t), 1e-4);
  wagon_free(w);
}
END_TEST

/* a motor turns the arm: no freedom */
START_TEST(a_driven_body_follows_its_driver) {
  wagon *w = wagon_make(1, true);
  w->start[0].twist.velocity = (tdm_vec3){0, 0, 1};
  w->block[2] = -4;
  roll(w, 10000);
  ck_near(w->start[0].pose.position.z, 0.1 - 2 * 0.01, 1e-9);
  ck_near(w->start[0].twist.velocity.z, 0.6, 1e-12);
  ck_assert_double_gt(fabs(w->seen[0].moment[0].force.x), 0); /* whatever hits it */
  ck_near(w->start[0].twist.velocity.x, 0, 0);
  wagon_free(w);
}
END_TEST

START_TEST(a_body_never_jumps) {
  wagon *w = wagon_make(1, false);
  set_free(w);
  roll(w, 50);
  /* the multibody solver has it elsewhere */
  const double off = 1e-4, rate = 0.02, turn = 1e-3;
  w->start[0].pose.position.x += off;
  w->start[0].twist.velocity.y += rate;
  w->start[0].pose.orientation = tdm_quat_from_rotvec((tdm_vec3){0, 0, turn});
  tdm_pose last = inside(w)->state.pose[0];
  double farthest = 0;
  tdm_state ahead = w->start[0];
  for (int k = 0; k < 400; k++) {
    roll(w, 1); /* windows of a step each */
    tdm_pose now = inside(w)->state.pose[0];
    tdm_vec3 v = tdm_scale(1 / dt, tdm_sub(now.position, last.position));
    farthest = fmax(farthest, tdm_norm(tdm_sub(now.position, last.position)));
    if (k > 0)
      ck_near(inside(w)->state.twist[0].velocity.x, v.x, 0.3);
    last = now;
  }
  ck_assert_double_lt(farthest, off / 4);
  ck_near(last.position.x, ahead.pose.position.x, 1e-12);
  ck_near(last.position.y, ahead.pose.position.y + rate * 400 * dt, 1e-12);
  ck_near(last.orientation.z, sin(turn / 2), 1e-12);
  ck_near(inside(w)->state.twist[0].velocity.y, rate, 1e-9);
  /* one window that is longer than ten steps closes it by its end */
  w->start[0].pose.position.x += off;
  roll(w, 30);
  ck_near(inside(w)->state.pose[0].position.x, w->start[0].pose.position.x, 1e-15);
  wagon_free(w);
}
END_TEST

START_TEST(a_correction_is_reached_at_the_end) {
  wagon *w = wagon_make(1, false);
  set_free(w);
  const double way[] = {1e-3, 0, 0, 0, 2e-3, 0, 0.1, 0, 0, 0, 0, 0.3};
  memcpy((double *)(uintptr_t)w->step.proxy.correction, way, sizeof way);
  roll(w, 50);
  ck_near(w->start[0].pose.position.x, 0, 0); /* the proxy does not know */
  ck_near(inside(w)->state.pose[0].position.x, 1e-3, 1e-16);
  ck_near(inside(w)->state.pose[0].orientation.y, sin(1e-3), 1e-15);
  ck_near(inside(w)->state.twist[0].velocity.x, 0.1, 1e-13);
  ck_near(inside(w)->state.twist[0].angular.z, 0.3, 1e-13);
  wagon_free(w);
}
END_TEST

/* two cubes on one rod along x: what hits one moves both */
START_TEST(bodies_move_together) {
  wagon *w = wagon_make(2, true);
  tdm_mobility *m = freedom(w, 1);
  m->J[0] = m->J[6] = 1;
  m->B[0] = m->B[6] = m->Y[0] = m->Y[6] = m->Y[72] = m->Y[78] = 1.0 / 20;
  double velocity = inside(w)->state.pace[0].velocity.x;
  roll(w, 2000);
  ck_near(velocity - inside(w)->state.pace[0].velocity.x, 20 * w->start[0].twist.velocity.x, 1e-12);
  ck_assert_double_gt(w->start[0].twist.velocity.x, 0.1);
  ck_near(w->start[1].twist.velocity.x, w->start[0].twist.velocity.x, 0);
  ck_near(inside(w)->state.pose[1].position.x, inside(w)->state.pose[0].position.x, 0);
  wagon_free(w);
}
END_TEST

/* a cube that is too light for the step on the springs of its contacts */
START_TEST(a_step_too_long_for_the_bodies) {
  for (int light = 0; light < 2; light++) {
    wagon *w = wagon_make(1, true);
    tdm_error err = {0};
    dem_guard_def *guard = &((dem_model *)(uintptr_t)inside(w)->model)->guard;
    guard->action = DEM_GUARD_STOP;
    guard->every = 1;
    tdm_mobility *m = freedom(w, 1);
    m->J[0] = 1;
    m->B[0] = m->Y[0] = light ? 1e7 : 1e3;
    tdm_step *s = &w->step;
    *s = (tdm_step){.t1 = 1e-3,
                    .nstep = 100,
                    .nbody = 1,
                    .nstate = 1,
                    .start = w->start,
                    .end = w->start,
                    .has_proxy = true,
                    .proxy = s->proxy};
    w->result = (tdm_result){.nbody = 1, .nload = 1, .load = w->load, .ninterface = 1, .body = w->seen};
    ck_assert_int_eq(dem_solver_ops.step(w->self, s, &w->result, &err), light ? TDM_ERR_NUMERIC : TDM_OK);
    ck_assert(!light || strstr(err.message, "stable step of the coupled bodies"));
    wagon_free(w);
  }
}
END_TEST

/* without a proxy, too: moments by kicks, work along the path */
START_TEST(the_interface_of_a_path) {
  wagon *w = wagon_make(1, true);
  tdm_error err = {0};
  tdm_state end = w->start[0];
  end.pose.position.x = -1e-3;
  tdm_vec3 before = inside(w)->state.pace[0].velocity;
  tdm_step s = {.t1 = 2e-3, .nstep = 200, .nbody = 1, .nstate = 1, .start = w->start, .end = &end};
  w->result = (tdm_result){.nbody = 1, .nload = 1, .load = w->load, .ninterface = 1, .body = w->seen};
  ck_assert_int_eq(dem_solver_ops.step(w->self, &s, &w->result, &err), TDM_OK);
  double given = before.x - inside(w)->state.pace[0].velocity.x; /* 1 kg */
  ck_assert_double_gt(given, 0.1);
  ck_near(w->seen[0].moment[0].force.x * 2e-3, given, 1e-14);
  ck_near(w->seen[0].work, given * -0.5, 1e-14);
  ck_near(w->seen[0].end.pose.position.x, -1e-3, 0);
  ck_assert_double_ne(w->seen[0].moment[0].force.x, w->load[0].force.x); /* [L18] Eq. 2 is another mean */
  wagon_free(w);
}
END_TEST

TEST_MAIN("dem_proxy", momentum_goes_over_without_loss, work_is_what_the_body_gains,
          mobility_alone_moves_a_free_body_alike, stiff_springs_are_exact, a_hinged_body_stays_on_its_circle,
          a_window_that_is_repeated, a_body_on_a_circle_that_does_not_turn, a_driven_body_follows_its_driver,
          a_body_never_jumps, a_correction_is_reached_at_the_end, bodies_move_together, a_step_too_long_for_the_bodies,
          the_interface_of_a_path)
