/* The last states without trouble, and the polynomial through them: see past.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/integrate/past.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool mbd_past_create(mbd_past *p, int size) {
  bool good = true;
  *p = (mbd_past){.size = size};
  for (int i = 0; i < MBD_PAST_MAX; i++)
    good = (p->y[i] = malloc((size_t)size * sizeof(double) + 1)) && good;
  return good;
}

void mbd_past_free(mbd_past *p) {
  for (int i = 0; i < MBD_PAST_MAX; i++)
    free(p->y[i]);
  *p = (mbd_past){0};
}

void mbd_past_add(mbd_past *p, double t, const double *y, double mu) {
  if (p->n == MBD_PAST_MAX) {
    double *oldest = p->y[0];
    memmove(p->t, p->t + 1, (MBD_PAST_MAX - 1) * sizeof *p->t);
    memmove(p->y, p->y + 1, (MBD_PAST_MAX - 1) * sizeof *p->y);
    memmove(p->mu, p->mu + 1, (MBD_PAST_MAX - 1) * sizeof *p->mu);
    p->y[--p->n] = oldest;
  }
  p->t[p->n] = t;
  p->mu[p->n] = mu;
  memcpy(p->y[p->n++], y, (size_t)p->size * sizeof(double));
}

void mbd_past_at(const mbd_past *p, double t, double *out) {
  memset(out, 0, (size_t)p->size * sizeof(double));
  for (int i = 0; i < p->n; i++) {
    double weight = 1;
    for (int j = 0; j < p->n; j++)
      weight *= j == i ? 1 : (t - p->t[j]) / (p->t[i] - p->t[j]);
    for (int k = 0; k < p->size; k++)
      out[k] += weight * p->y[i][k];
  }
}

double mbd_past_step(const mbd_past *p) {
  return p->n > 1 ? p->t[p->n - 1] - p->t[p->n - 2] : 0;
}

double mbd_past_mu(const mbd_past *p) {
  double mu = 0;
  for (int i = 0; i < p->n; i++)
    mu = fmax(mu, p->mu[i]);
  return mu;
}
