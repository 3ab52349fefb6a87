/* Closed form of the spring-damper of [L18] Eq: see reference.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/spring_damper/reference.h"

#include <assert.h>
#include <math.h>

void scn_spring_damper_exact(const scn_spring_damper_parameters *p, double t, double *x, double *v) {
  double decay = p->damping / (2 * p->mass);
  double square = p->stiffness / p->mass - decay * decay;
  assert(square > 0);
  double frequency = sqrt(square), rest = (p->mass * p->gravity - p->preload) / p->stiffness;
  /* x = rest (1 - e^(-d t) (cos w t + d/w sin w t)),  x' = rest e^(-d t) (w + d^2/w) sin w t */
  double shrink = exp(-decay * t), c = cos(frequency * t), s = sin(frequency * t);
  *x = rest * (1 - shrink * (c + decay / frequency * s));
  *v = rest * shrink * (frequency + decay * decay / frequency) * s;
}
