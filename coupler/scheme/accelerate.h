/* Acceleration of a fixed-point iteration c = H(c) over the windows of a run.
 *
 * In each window: cpl_accelerator_begin, then a step after each evaluation of the residual R(c) = H(c) - c, which gives
 * the c to try next. Aitken scales the residual by one factor for all components; IQN-ILS learns the inverse of R's
 * Jacobian from the differences that the iterations have shown, and keeps them over a few windows (equations at the
 * functions in accelerate.c). Components are to be of one unit and of comparable size.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_SCHEME_ACCELERATE_H
#define CPL_SCHEME_ACCELERATE_H

typedef enum { CPL_IQN_ILS, CPL_AITKEN } cpl_accelerator_kind;

typedef struct cpl_accelerator cpl_accelerator;

/* For c of `size` components; NULL: out of memory. IQN-ILS keeps the differences of `reuse` >= 0 windows before.
 * Switches off GSL's error handler, which would end the process. */
cpl_accelerator *cpl_accelerator_create(cpl_accelerator_kind kind, int size, int reuse);
void cpl_accelerator_destroy(cpl_accelerator **accelerator);

/* A new window: what the last one's iterations have shown becomes older by one window. */
void cpl_accelerator_begin(cpl_accelerator *accelerator);

/* The next c (size) after R(c) = residual (size). `next` may be `c`. */
void cpl_accelerator_step(cpl_accelerator *accelerator, const double *c, const double *residual, double *next);

#endif
