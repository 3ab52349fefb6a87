/* What changes of the step cost a BDF. Not a test: bench_mbd_steps
 *
 * 1. Three ways to keep the past of a BDF of order k when the step changes, on y' = z y, whose solution is known. Each
 *    step corrects a prediction p, the polynomial of degree k from before:
 *      variable coefficients        w interpolates y_n+1 and the last k values where they are
 *      fixed leading coefficient    w = p + c (y_n+1 - p_n+1), p interpolates the last k + 1 values where they are
 *      fixed coefficients           the same, but p is the w of the step before
 *    with c of degree k, 1 at t_n+1 and 0 at t_n+1 - i h, i = 1 ... k; then w'(t_n+1) = z w(t_n+1). On equal steps all
 *    three are the same method (Jackson & Sacks-Davis, ACM Trans. Math. Softw. 6 (1980)).
 * 2. IDA (fixed leading coefficient) on a mass that bounces on a stiff stop, by order and tolerance: steps, rejected
 *    steps, error against the exact solution.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/mbd.h"
#include "protocol/base/log.h"

#include <complex.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- three formulas ---- */

enum { ORDER_MAX = 5 };
typedef enum { VARIABLE, FIXED_LEADING, FIXED, FORMULAS } formula;
typedef double complex number;

/* value and derivative at t of the polynomial through (x, y), n points (Lagrange) */
static void polynomial(int n, const double *x, const number *y, double t, number *value, number *rate) {
  *value = *rate = 0;
  for (int i = 0; i < n; i++) {
    double l = 1, dl = 0;
    for (int j = 0; j < n; j++) {
      if (j == i)
        continue;
      dl = (dl * (t - x[j]) + l) / (x[i] - x[j]);
      l *= (t - x[j]) / (x[i] - x[j]);
    }
    *value += l * y[i];
    *rate += dl * y[i];
  }
}

/* Error at the end, relative to the largest value, of order k with steps h and ratio h in turn, `run` steps each. The
 * polynomial of fixed coefficients is kept by its values at k + 1 equidistant points, which is exact. */
static double integrate(formula of, int k, number z, double end, double h, double ratio, int run) {
  double x[ORDER_MAX + 2], t = 0;
  number y[ORDER_MAX + 2];
  for (int i = 0; i <= k; i++) { /* newest first; an exact past */
    x[i] = -i * h;
    y[i] = cexp(z * x[i]);
  }
  for (long step = 0; t < end; step++) {
    double now = step / run % 2 ? ratio * h : h, next = t + now, leading = 0;
    number p, dp, new;
    if (of == VARIABLE) { /* w'(next) = a y + b, b from the past with a zero at `next` */
      double at[ORDER_MAX + 2] = {next};
      number past[ORDER_MAX + 2] = {0}, unit[ORDER_MAX + 2] = {1}, none, a;
      for (int i = 0; i < k; i++)
        at[i + 1] = x[i], past[i + 1] = y[i];
      polynomial(k + 1, at, past, next, &none, &dp);
      polynomial(k + 1, at, unit, next, &none, &a);
      new = dp / (z - a);
    } else {
      for (int i = 1; i <= k; i++)
        leading += 1.0 / (i * now);
      polynomial(k + 1, x, y, next, &p, &dp);
      new = (dp - leading * p) / (z - leading);
    }
    if (of == FIXED) { /* w at next - i h */
      number w[ORDER_MAX + 2] = {new};
      for (int i = 1; i <= k; i++)
        polynomial(k + 1, x, y, next - i * now, &w[i], &dp);
      for (int i = 0; i <= k; i++)
        x[i] = next - i * now, y[i] = w[i];
    } else {
      for (int i = k; i > 0; i--)
        x[i] = x[i - 1], y[i] = y[i - 1];
      x[0] = next, y[0] = new;
    }
    t = next;
  }
  return cabs(y[0] - cexp(z * t));
}

/* The largest ratio up to which the error stays within ten times that of variable coefficients. */
static double bearable(formula of, int k, number z, int run) {
  double ratio = 1;
  for (double r = 1.1; r < 20; r *= 1.1, ratio = r / 1.1)
    if (!(integrate(of, k, z, 3, 0.002, r, run) <= 10 * integrate(VARIABLE, k, z, 3, 0.002, r, run)))
      return ratio;
  return INFINITY;
}

static void compare_formulas(void) {
  static const int runs[] = {1, 2, 4, 8};
  const number z = -1 + 10 * I;
  printf("y' = (-1 + 10 i) y to t = 3, n steps of 0.002 and n steps of r 0.002 in turn\n\nerror at the end, n = 2:\n");
  printf("%6s %6s %14s %14s %14s\n", "order", "r", "variable", "fixed leading", "fixed");
  for (int k = 2; k <= ORDER_MAX; k++)
    for (int r = 1; r <= 3; r++) {
      printf("%6d %6d", k, r);
      for (int of = 0; of < FORMULAS; of++)
        printf(" %14.2e", integrate((formula)of, k, z, 3, 0.002, r, 2));
      printf("\n");
    }
  printf("\nlargest r with an error within ten times that of variable coefficients (inf: 20 and more):\n");
  printf("%6s %6s %14s %14s\n", "order", "n", "fixed leading", "fixed");
  for (int k = 2; k <= ORDER_MAX; k++)
    for (int n = 0; n < 4; n++)
      printf("%6d %6d %14.2f %14.2f\n", k, runs[n], bearable(FIXED_LEADING, k, z, runs[n]),
             bearable(FIXED, k, z, runs[n]));
}

/* ---- IDA on impacts ---- */

static const double mass = 1, stiffness = 1e6, gravity = 9.81, height = 0.1, end_time = 5;

static const char scene_text[] =
    "{\"gravity\":[0,0,-9.81],\"bodies\":[{\"name\":\"ball\",\"mass\":1,\"inertia\":[1,1,1],\"position\":[0,0,0.1]}],"
    "\"joints\":[{\"name\":\"guide\",\"type\":\"prismatic\",\"bodies\":[\"ground\",\"ball\"],\"point\":[0,0,0.1],"
    "\"axis\":[0,0,1]}],\"forces\":[{\"name\":\"floor\",\"type\":\"bump\",\"bodies\":[\"ground\",\"ball\"],"
    "\"point\":[0,0,0.1],\"plane_point\":[0,0,0],\"normal\":[0,0,1],\"stiffness\":1e6}]}";

/* height at t of the exact motion: parabolas and, in contact, z = -m g/k + r cos(w (t - middle)) */
static double exact(double t, int *impacts) {
  double w = sqrt(stiffness / mass), sag = mass * gravity / stiffness, speed = sqrt(2 * gravity * height);
  double fall = speed / gravity, contact = 2 * (M_PI - atan2(speed / w, sag)) / w;
  double period = 2 * fall + contact;
  *impacts = (int)((t + fall + contact) / period);
  double phase = remainder(t, period); /* from the top of a flight */
  if (fabs(phase) <= fall)
    return height - 0.5 * gravity * phase * phase;
  double radius = hypot(sag, speed / w);
  return -sag - radius * cos(w * (0.5 * period - fabs(phase)));
}

static void bounce(int order, double tolerance) {
  tdm_error err = {0};
  json_t *scene = json_loads(scene_text, 0, NULL);
  json_object_set_new(scene, "solver", json_pack("{s:i, s:f}", "max_order", order, "relative_tolerance", tolerance));
  tdm_assignment a = {.scene = scene, .time_end = end_time, .dt = end_time, .n = 1};
  mbd_engine *self = NULL;
  if (mbd_engine_create(&self, &a, NULL, &err) == TDM_OK) {
    const mbd_start ready = *mbd_engine_start(self);
    double *channel = calloc((size_t)ready.nchannel, sizeof *channel), begin = tdm_clock();
    const mbd_window in = {.t1 = end_time, .nsample = 1, .sample_time = &end_time};
    const mbd_outcome out = {.channel = channel};
    if (mbd_engine_advance(self, &in, &out, &err) == TDM_OK) {
      const mbd_stats *s = mbd_engine_stats(self);
      double wall = tdm_clock() - begin, z = NAN;
      int impacts;
      for (int c = 0; c < ready.nchannel; c++)
        if (strcmp(ready.channel[c].name, "body.ball.z") == 0)
          z = channel[c];
      double reference = exact(end_time, &impacts);
      printf("%6d %8g %8ld %10.1f %9ld %9ld %10ld %10.2e %8.3f\n", order, tolerance, s->steps,
             (double)s->steps / impacts, s->error_failures, s->convergence_failures, s->jacobians, fabs(z - reference),
             wall);
    }
    free(channel);
  }
  if (err.status != TDM_OK)
    printf("%6d %8g %s\n", order, tolerance, err.message);
  mbd_engine_destroy(&self);
  json_decref(scene);
}

int main(void) {
  compare_formulas();
  printf("\nIDA: a mass falls %g m onto a spring of %g N/m again and again, %g s\n", height, stiffness, end_time);
  printf("%6s %8s %8s %10s %9s %9s %10s %10s %8s\n", "order", "rtol", "steps", "an impact", "rejected", "diverged",
         "Jacobians", "error [m]", "wall [s]");
  for (int order = 1; order <= ORDER_MAX; order++)
    for (double tolerance = 1e-6; tolerance > 5e-11; tolerance *= 0.01)
      if (order > 1 || tolerance > 5e-7) /* order 1 takes a million steps */
        bounce(order, tolerance);
  return 0;
}
