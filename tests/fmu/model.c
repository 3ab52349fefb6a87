/* Small models that the tests make FMUs of: see model.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model.h"

#include <math.h>
#include <signal.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const names[] = {"spring", "arm", "cylinder"};

int model_make(model *m, const char *token) {
  static bool made;
  *m = (model){.kind = SPRING};
  for (int k = 0; k < 3; k++) {
    const size_t n = strlen(names[k]);
    if (strncmp(token, names[k], n) != 0 || (token[n] != 0 && token[n] != ' '))
      continue;
    m->kind = (model_kind)k;
    if (token[n])
      strncpy(m->fault, token + n + 1, sizeof m->fault - 1);
    if (made && strcmp(m->fault, "single") == 0)
      return 0;
    made = true;
    m->value[V_MASS] = 1;
    m->value[V_INERTIA] = 1;
    m->value[V_ARM] = 1;
    m->value[V_VOLUME] = 1;
    return 1;
  }
  return 0;
}

/* Rates of the states. */
static void rates(const model *m, const double *s, double *rate) {
  const double *v = m->value;
  rate[0] = s[1];
  rate[2] = 0;
  if (m->kind == SPRING) {
    rate[1] = (v[V_F] - v[V_PRELOAD] - v[V_STIFFNESS] * s[0] - v[V_DAMPING] * s[1]) / v[V_MASS] + v[V_GRAVITY];
  } else if (m->kind == ARM) {
    const double x = v[V_ARM] * cos(s[0]), y = v[V_ARM] * sin(s[0]);
    const double moment = v[V_M] + v[V_MZ] + x * v[V_FY] - y * v[V_FX] + v[V_MASS] * v[V_GRAVITY] * x;
    rate[1] = (moment - v[V_STIFFNESS] * s[0] - v[V_DAMPING] * s[1]) / v[V_INERTIA];
  } else {
    const double over = v[V_SUPPLY] - s[2];
    const double flow = v[V_VALVE] * copysign(sqrt(fabs(over)), over);
    rate[1] = (v[V_F] + v[V_AREA] * s[2] - v[V_DAMPING] * s[1]) / v[V_MASS];
    rate[2] = v[V_MODULUS] / (v[V_VOLUME] + v[V_AREA] * s[0]) * (flow - v[V_AREA] * s[1]);
  }
}

void model_look(model *m) {
  double rate[3], *v = m->value;
  rates(m, m->state, rate);
  if (m->kind == ARM) {
    const double c = v[V_ARM] * cos(m->state[0]), s = v[V_ARM] * sin(m->state[0]), w = m->state[1];
    v[V_PHI] = m->state[0];
    v[V_DEGREES] = m->state[0] * 180 / acos(-1.0);
    v[V_W] = w;
    v[V_ALPHA] = rate[1];
    v[V_X] = c;
    v[V_Y] = s;
    v[V_VX] = -s * w;
    v[V_VY] = c * w;
    v[V_AX] = -s * rate[1] - c * w * w;
    v[V_AY] = c * rate[1] - s * w * w;
  } else {
    v[V_X] = m->state[0];
    v[V_VX] = m->state[1];
    v[V_AX] = rate[1];
    v[V_PRESSURE] = m->state[2];
  }
}

/* Runge and Kutta's classical steps. */
void model_step(model *m, double h) {
  const long n = (long)ceil(h / 1e-4 - 1e-6);
  const double dt = h / (double)n;
  for (long k = 0; k < n; k++) {
    double a[3], b[3], c[3], d[3], s[3];
    rates(m, m->state, a);
    for (int i = 0; i < 3; i++)
      s[i] = m->state[i] + dt / 2 * a[i];
    rates(m, s, b);
    for (int i = 0; i < 3; i++)
      s[i] = m->state[i] + dt / 2 * b[i];
    rates(m, s, c);
    for (int i = 0; i < 3; i++)
      s[i] = m->state[i] + dt * c[i];
    rates(m, s, d);
    for (int i = 0; i < 3; i++)
      m->state[i] += dt / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
  }
  m->t += h;
  model_look(m);
}

double model_derivative(const model *m, unsigned output, unsigned input) {
  model one = *m, other = *m; /* accelerations are linear in the inputs */
  one.value[input] += 1;
  model_look(&one);
  model_look(&other);
  return one.value[output] - other.value[output];
}

/* Uses up the stack; each call needs the one above it. */
static int use_stack(unsigned n, const volatile char *above) {
  volatile char room[4096];
  room[0] = *above;
  return n == 0 ? 0 : use_stack(n - 1, room) + room[0];
}

int model_fails(const model *m, const char *fault) {
  if (strcmp(m->fault, fault) != 0 || m->t < 0.004)
    return 0;
  if (strcmp(fault, "crash") == 0)
    raise(SIGSEGV);
  if (strcmp(fault, "overflow") == 0)
    return use_stack(1u << 30, m->fault);
  if (strcmp(fault, "exit") == 0)
    exit(0);
  while (strcmp(fault, "hang") == 0)
    pause();
  return 1;
}
