/* The last states without trouble, and the polynomial through them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_INTEGRATE_PAST_H
#define MBD_INTEGRATE_PAST_H

#include <stdbool.h>

enum { MBD_PAST_MAX = 6 };

typedef struct {
  int size;                /* unknowns of a state */
  int n;                   /* states, oldest first */
  double t[MBD_PAST_MAX];  /* [s] */
  double *y[MBD_PAST_MAX]; /* (size) */
  double mu[MBD_PAST_MAX]; /* largest |position multiplier| */
} mbd_past;

/* Make room for states of `size` unknowns; false: out of memory. */
bool mbd_past_create(mbd_past *past, int size);
void mbd_past_free(mbd_past *past);

/* Add the state y at t, in place of the oldest if there is no room. */
void mbd_past_add(mbd_past *past, double t, const double *y, double mu);

/* The states continued to t by their polynomial (Lagrange), into out (size). */
void mbd_past_at(const mbd_past *past, double t, double *out);

/* Length of the last step [s]; 0: there is none. */
double mbd_past_step(const mbd_past *past);

/* The largest of mu. */
double mbd_past_mu(const mbd_past *past);

#endif
