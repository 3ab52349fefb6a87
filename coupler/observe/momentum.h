/* The momentum of the coupled bodies against the impulse of the loads that the multibody solver was given.
 *
 * A solver may tell, for a body, directions d in which nothing but the coupling load and gravity moves it (READY,
 * "free"). In each of them, at the end of every window, off = | d (P - m (v - v0) + m g t) |,   P = sum over windows of
 * the integral of the load polynomial, is zero but for errors of that solver's integration: it has spread an impulse
 * over other windows, or lost it. Joints and forces make it nothing that can be known from outside, so of other bodies
 * nothing is said.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_OBSERVE_MOMENTUM_H
#define CPL_OBSERVE_MOMENTUM_H

#include "coupler/state/loop.h"

/* of one body */
typedef struct {
  tdm_vec3 given; /* P [N s] */
  double off;     /* largest so far [N s] */
  double most;    /* largest of the terms so far [N s] */
  double at;      /* end of the window of the largest share [s] */
} cpl_momentum;

/* Enter the window that the loop has solved, for body i. */
void cpl_momentum_window(cpl_momentum *momentum, const cpl_loop *loop, int i);

/* off/most; NaN: nothing can be said. */
double cpl_momentum_share(const cpl_momentum *momentum, const tdm_assigned_body *body);

/* The run has come to its end: warn if a body's share is above 1e-6. */
void cpl_momentum_end(const cpl_momentum *momentum, const cpl_loop *loop, int i);

#endif
