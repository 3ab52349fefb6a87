/* How far two states of a body, or what two solvers make of a window, are apart: all as lengths; and the length of the
 * next window that follows from it ("n": "auto"; docs/theory/coupling.md). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_STATE_MISMATCH_H
#define CPL_STATE_MISMATCH_H

#include "coupler/state/loop.h"

enum { CPL_APART = 12 };

/* Radius by which turns of a body count as ways: that of gyration, of the mean of its moments of inertia; 1 m where the
 * body has none. */
double cpl_body_radius(const tdm_assigned_body *body);

/* a - b: way; turn (world axes) times radius; differences of velocity times H, of angular velocity times radius H [m].
 */
void cpl_apart(const tdm_state *a, const tdm_state *b, double radius, double H, double out[CPL_APART]);

/* Speed of the centre of mass and of what lies at the radius [m/s]. */
double cpl_speed(const tdm_state *state, double radius);

/* Root of the sum of squares. */
double cpl_length(int n, const double *values);

/* The way [m] that a body makes in the window at its largest speed until t1; turns count at its radius. */
double cpl_motion(const cpl_loop *loop, int body);

/* DEM steps of the window after one of n steps, whose mismatch was `excess` times what is allowed and grows with the
 * power `order` of the window. */
long cpl_adapt_next(const cpl_auto *settings, int order, long n, double excess);

/* Whether a window with this mismatch, beside what is allowed, is to be taken back. */
bool cpl_adapt_too_long(double excess);

#endif
