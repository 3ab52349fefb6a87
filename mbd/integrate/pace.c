/* IDA's own clock: see pace.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/integrate/pace.h"

#include <math.h>

static const double same = 1e-6;  /* lengths of windows that differ by less are one */
static const double apart = 1e-7; /* of a window: what the clocks may differ by */

void mbd_pace_reset(mbd_pace *p, double t) {
  *p = (mbd_pace){.t = t, .tau = t};
}

/* Another of the windows that are as long as the step that IDA wants. */
static double equal_step(mbd_pace *p, double rest, double wanted) {
  if (p->count == 0)
    p->start = p->t, p->ahead = 0;
  p->count++;
  p->ahead += wanted - rest;
  const double mean = (p->t + rest - p->start) / (double)p->count;
  if (fabs(p->ahead) > apart * rest) {
    p->longest = mean - p->ahead; /* the next one */
    p->ahead = 0;
  } else if (fabs(p->longest - mean) > 0.1 * apart * rest) {
    p->longest = mean;
  }
  return wanted;
}

double mbd_pace_stop(mbd_pace *p, double t0, double t1, double wanted) {
  const double rest = t1 - p->t;
  p->end = t1;
  p->length = rest;
  if (p->longest > 0 && fabs(wanted - rest) < same * rest) {
    p->length = equal_step(p, rest, wanted);
  } else if (wanted > 0 && wanted < (1 - 1e-9) * rest) {
    p->count = 0;
    p->longest = 0;
    if (2 * wanted > rest) {
      p->end = p->t + 0.5 * rest;
      p->length = 0.5 * rest;
    }
  } else {
    p->count = 0;
    p->longest = wanted > 0 && p->t <= t0 ? rest : 0; /* so that the step does not grow out of such windows */
  }
  return p->tau + p->length;
}

double mbd_pace_reach(mbd_pace *p, double tau, int stopped) {
  p->t = stopped ? p->end : mbd_pace_true(p, tau);
  p->tau = stopped ? p->tau + p->length : tau;
  return p->t;
}
