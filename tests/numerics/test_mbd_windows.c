/* A preloaded spring-damper box against its closed form, whole and cut into windows with a load that is a quadratic in
 * time; IDA's history over windows; dense output; load jumps.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

static const char box[] =
    "{'bodies':[{'name':'box','mass':100,'inertia':[10,10,10],'position':[0,0,0]}],"
    "'joints':[{'name':'guide','type':'prismatic','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,1]}],"
    "'forces':[{'name':'spring','type':'spring_damper','bodies':['ground','box'],'points':[[0,0,2],[0,0,1]],"
    "'stiffness':5000,'damping':100,'preload':100}]}";

static const double mass = 100, k = 5000, c = 100, g = 9.81, preload = 100;

/* Stretch u and rate of m u'' + c u' + k u = m g - preload - F(t), F = F[0] + F[1] t + F[2] t^2, from rest at u = 0. */
static void closed_form(const double F[3], double t, double *u, double *rate) {
  double f[3] = {mass * g - preload - F[0], -F[1], -F[2]};
  double a2 = f[2] / k, a1 = (f[1] - 2 * c * a2) / k, a0 = (f[0] - c * a1 - 2 * mass * a2) / k;
  double s = c / (2 * mass), w = sqrt(k / mass - s * s);
  double A = -a0, B = (-a1 - s * a0) / w; /* u_h = exp(-s t)(A cos + B sin) */
  double e = exp(-s * t), C = cos(w * t), S = sin(w * t);
  *u = a0 + a1 * t + a2 * t * t + e * (A * C + B * S);
  *rate = a1 + 2 * a2 * t + e * (-s * (A * C + B * S) + w * (B * C - A * S));
}

/* F over [t0, t1] as a polynomial in s, on the box along z */
static void cut(const double F[3], double t0, double t1, tdm_wrench load[3]) {
  double H = t1 - t0;
  memset(load, 0, 3 * sizeof *load);
  load[0].force.z = F[0] + F[1] * t0 + F[2] * t0 * t0;
  load[1].force.z = (F[1] + 2 * F[2] * t0) * H;
  load[2].force.z = F[2] * H * H;
}

static long steps_total; /* of the last `follow` */

/* Largest error of u over the ends of `n` windows of H. */
static double follow(const double F[3], double H, long n) {
  run r;
  double worst = 0, u, rate;
  run_open_good(&r, box, "box");
  for (long i = 0; i < n; i++) {
    tdm_wrench load[3];
    cut(F, (double)i * H, (double)(i + 1) * H, load);
    run_window(&r, (double)(i + 1) * H, load, 3, 0, NULL);
    closed_form(F, (double)(i + 1) * H, &u, &rate);
    worst = fmax(worst, fabs(-r.state[0].pose.position.z - u));
    worst = fmax(worst, fabs(-r.state[0].twist.velocity.z - rate) / 10); /* w = 7 1/s */
  }
  steps_total = run_close_steps(&r);
  return worst;
}

START_TEST(test_oscillator) {
  const double none[3] = {0, 0, 0};
  ck_assert_double_lt(follow(none, 5, 1), 1e-7);
}
END_TEST

START_TEST(test_cut_into_windows) {
  const double F[3] = {-300, 400, -70};
  double whole = follow(F, 2, 1);
  long steps = steps_total;
  double coarse = follow(F, 0.05, 40);
  long steps_coarse = steps_total;
  double fine = follow(F, 1e-3, 2000);
  long steps_fine = steps_total;
  ck_assert_msg(whole < 2e-7 && coarse < 2e-7 && fine < 1e-8, "errors %g, %g, %g", whole, coarse, fine);
  /* the history goes on over windows: hardly more steps than without, or about one a window */
  ck_assert_msg(steps_coarse < 1.5 * (double)steps + 40, "%ld steps in one window, %ld in 40", steps, steps_coarse);
  ck_assert_msg(steps_fine < 2000 + 300, "%ld steps in 2000 windows of 1e-3 s", steps_fine);
}
END_TEST

START_TEST(test_tiny_windows) {
  const double F[3] = {-300, 400, -70};
  double worst = follow(F, 1e-5, 20000);
  ck_assert_msg(worst < 1e-8, "error %g", worst);
  ck_assert_msg(steps_total < 20000 + 300, "%ld steps in 20000 windows", steps_total);
}
END_TEST

/* samples inside windows, and the same whatever the windows */
START_TEST(test_samples) {
  const double none[3] = {0, 0, 0}, H[2] = {0.05, 0.0171}, at[4] = {0.0123, 0.1, 0.34567, 0.49};
  for (int i = 0; i < 2; i++) {
    run r;
    int next = 0;
    run_open_good(&r, box, "box");
    for (int w = 1; next < 4; w++) {
      int n = 0;
      while (next + n < 4 && at[next + n] <= w * H[i])
        n++;
      run_window(&r, w * H[i], NULL, 0, n, at + next);
      for (int s = 0; s < n; s++) {
        double u, rate;
        closed_form(none, at[next + s], &u, &rate);
        const double *channel = r.channel + s * r.ready.nchannel;
        CLOSE(-r.sample[s].pose.position.z, u, 1e-7);
        CLOSE(-r.sample[s].twist.velocity.z, rate, 1e-6);
        CLOSE(channel[run_channel(&r, "force.spring.length")], 1 + u, 1e-7);
        CLOSE(channel[run_channel(&r, "force.spring.value")], k * u + c * rate + preload, 1e-3);
      }
      next += n;
    }
    run_close(&r);
  }
}
END_TEST

/* a load that jumps by many times the weight at every window: impulse and work still come out right */
START_TEST(test_jumps) {
  run r;
  double t = 0, v = 0, x = 0;
  run_open_good(&r, "{'gravity':[0,0,0],'bodies':[{'name':'box','mass':2,'inertia':[1,1,1],'position':[0,0,0]}]}",
                "box");
  for (int i = 1; i <= 300; i++) {
    double F = 1e5 * sin(i * i), H = i % 3 ? 1e-4 : 7e-4;
    tdm_wrench load = {{F, 0, 0}, {0, 0, 0}};
    t += H;
    run_window(&r, t, &load, 1, 0, NULL);
    x += v * H + 0.5 * F / 2 * H * H;
    v += F / 2 * H;
  }
  CLOSE(r.state[0].twist.velocity.x, v, 1e-11);
  CLOSE(r.state[0].pose.position.x, x, 1e-5);
  run_close(&r);
}
END_TEST

/* Nothing holds these two bodies, that a hinge and a spring tie together: under another polynomial in each window their
 * momentum is the impulse of the loads, whatever the formulation, the window and the number of its steps. */
START_TEST(test_momentum) {
  static const char *const formulations[] = {"ggl", "index3", "one_step"};
  static const double windows[] = {1e-5, 1e-3, 2e-2};
  static const double masses[2] = {2, 0.5};
  char scene[1024];
  snprintf(scene, sizeof scene,
           "{'gravity':[0,0,0],'formulation':'%s','bodies':[{'name':'a','mass':2,'inertia':[0.3,0.2,0.4],'position':"
           "[0,0,0],'velocity':[1,0,0]},{'name':'b','mass':0.5,'inertia':[0.1,0.1,0.1],'position':[1,0,0],'velocity':"
           "[1,0,0]}],'joints':[{'name':'h','type':'revolute','bodies':['a','b'],'point':[0.6,0,0],'axis':[0,1,0.3]}],"
           "'forces':[{'name':'s','type':'torsional_spring_damper','joint':'h','stiffness':50,'damping':1}]}",
           formulations[_i % 3]);
  run r;
  uint64_t draw = 11;
  const double H = windows[_i / 3], force = fmin(50, 0.2 / H);
  tdm_vec3 momentum = {2.5, 0, 0};
  double most = 0;
  run_open_good(&r, scene, "a b");
  for (int i = 0; i < 120; i++) {
    tdm_wrench load[2 * 3];
    int n = 1 + i / 40; /* constants first, up to parabolas */
    for (int b = 0; b < 2; b++)
      for (int j = 0; j < n; j++) {
        double size = i % 40 < 30 ? force : 0; /* the load ends as suddenly as it changes */
        tdm_vec3 f = tdm_scale(size, tdm_v3(1 + noise(&draw), noise(&draw), noise(&draw)));
        load[b * n + j] = (tdm_wrench){f, {0, 0.1 * size * noise(&draw), 0}};
        momentum = tdm_axpy(H / (j + 1), f, momentum);
      }
    run_window(&r, H * (i + 1), load, n, 0, NULL);
    most = fmax(most, tdm_norm(momentum));
    tdm_vec3 is = {0, 0, 0};
    for (int b = 0; b < 2; b++)
      is = tdm_axpy(masses[b], r.state[b].twist.velocity, is);
    double off = tdm_norm(tdm_sub(is, momentum));
    ck_assert_msg(off < 1e-11 * most, "%s, H = %g s, window %d: %g of %g N s", formulations[_i % 3], H, i, off, most);
  }
  run_close(&r);
}
END_TEST

/* A body on a rail under a load that lasts long: what the load has given is taken out of IDA's unknowns, and must not
 * grow until its rounding shows. A spring holds against it. */
START_TEST(test_long_load) {
  run r;
  run_open_good(&r, box, "box");
  const tdm_wrench load = {{0, 0, -1e5}, {0, 0, 0}}; /* 1000 m/s^2 */
  double u, rate, worst = 0;
  const double F[3] = {-1e5, 0, 0};
  for (int i = 1; i <= 300; i++) {
    run_window(&r, 0.5 * i, &load, 1, 0, NULL);
    closed_form(F, 0.5 * i, &u, &rate);
    worst = fmax(worst, fabs(-r.state[0].pose.position.z - u));
  }
  ck_assert_msg(worst < 1e-5, "error %g of 20 m", worst);
  run_close(&r);
}
END_TEST

TEST_MAIN_ROWS("mbd windows", {test_oscillator, 1}, {test_cut_into_windows, 1}, {test_tiny_windows, 1},
               {test_samples, 1}, {test_jumps, 1}, {test_momentum, 9}, {test_long_load, 1})
