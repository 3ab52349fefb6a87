/* One step of generalised-alpha on the group of poses (Arnold & Bruls 2007, Multibody Syst. Dyn. 18, 185-202;
 * Bruls & Cardona 2010, J. Comput. Nonlinear Dyn. 5, 031002).
 *
 * Loads come as a polynomial over a window, and the next window's need not go on where this one ends. The mechanism's
 * response to it at the window's start, [M G^T; G 0] [X; l] = [W(t); 0], is a polynomial too and integrated as one; the
 * method has what is left of the accelerations, w = Vdot - X, which does not jump where loads do. A step of length h
 * from (q, V) with w and the method's own a:
 *   (1 - am) a1 + am a = (1 - af) w1 + af w,
 *   q1 = exp(D) o q,  D = h V + h^2 ((1/2 - beta) a + beta a1) + S,   V1 = V + h ((1 - gamma) a + gamma a1) + P,
 *   P = int X dt,  S = int int X dt dt,
 *   M (w1 + X1) - Q + G^T lambda1 = 0 and g = 0 at (q1, V1),
 * with am, af, beta, gamma from the spectral radius at infinity (Chung & Hulbert 1993, J. Appl. Mech. 60, 371-375):
 * second order, and a free body ends where the impulse puts it, whatever the step. exp turns by the rotation vector in
 * world axes. Newton's unknowns are Vdot1 and lambda1; g is divided by dq1/dVdot1 = b h^2, so that the matrix stays
 * well scaled as h goes to zero (Bottasso, Bauchau & Cardona 2007, SIAM J. Sci. Comput. 29, 397-414). Then V1 is put
 * onto G V + g_t = 0 by the smallest change in the sense of kinetic energy.
 *
 * Steps may change: a = w + (am - af) h dw/dt to first order, and the second term is changed with h.
 *
 * Newton starts from w1 = w + h slope, slope the mean dw/dt of the step before. What it changes is the third derivative
 * of V, and with it comes the local error of V1 (Milne's device); that of q1 comes from dw/dt (Zienkiewicz & Xie 1991,
 * Earthquake Eng. Struct. Dyn. 20, 871-887):
 *   e_V = c3 h 2h/(h + h') (w1 - w - h slope),   h' the length of the step before,
 *   e_q = c2 h^2 (w1 - w),
 *   c2 = (am - af)/2 + beta - 1/6,   c3 = (1 - af)/2 - (1 - am - gamma)(1/2 + am - af) - 1/6.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_INTEGRATE_ALPHA_ALPHA_H
#define MBD_INTEGRATE_ALPHA_ALPHA_H

#include "mbd/integrate/integrator.h"
#include "mbd/linear/lu.h"

/* the rows of one part at the last evaluation */
typedef struct {
  int body[2], first, n;
  double G[MBD_ROWS_MAX][MBD_PAIR];
} mbd_alpha_rows;

/* What the next step needs beside data's state, in two lists as those of mbd_data (mechanics/state.h): kept and given
 * back by save and restore. `m` is the model. */
#define MBD_ALPHA_SCALARS(X)                                                  \
  X(double, last)   /* length of the last step [s], 0: none */                \
  X(double, wanted) /* the longest next step by the error test [s], 0: any */ \
  X(bool, started)  /* no step was made since the start: slope is that of there yet */

#define MBD_ALPHA_ARRAYS(X)                                                              \
  X(double, w, 6 * m->nbody)       /* at the end of the last step */                     \
  X(double, slope, 6 * m->nbody)   /* its mean rate in it; after a start: there */       \
  X(double, a, 6 * m->nbody)       /* the method's own, of a step as long as the last */ \
  X(double, lambda, m->nrow)       /* as w: reactions without l */                       \
  X(double, lambda_slope, m->nrow) /* as slope */                                        \
  X(double, speed, m->nbody)       /* largest so far, turns by their kinetic energy [m/s] */

typedef struct {
  MBD_ALPHA_SCALARS(MBD_SCALAR_FIELD)
  MBD_ALPHA_ARRAYS(MBD_ARRAY_FIELD)
  mbd_lu *step;       /* factors of Newton's matrix */
  mbd_lu *mass;       /* of [M G^T; G 0] */
  double step_length; /* of `step` [s], 0: to be made anew */
  bool mass_made;
} mbd_alpha_memory;

typedef struct {
  const mbd_model *model; /* borrowed */
  mbd_data *data;         /* borrowed */
  mbd_kkt *kkt;           /* borrowed */
  mbd_stop_fn stop_fn;
  void *stop_context;
  double am, af, beta, gamma;
  double c2, c3; /* of the local errors */
  int nv, n;     /* 6 nbody; with the constraint rows */
  mbd_alpha_memory now;
  mbd_alpha_memory before; /* `now` at the start of the step under way, without the factors */
  double *X;      /* (TDM_LOAD_MAX x n) X and l by powers of (t - load_t0)/(load_t1 - load_t0) of data's window */
  bool responded; /* X is that of the window under way */
  /* workspace */
  double *y0, *y1, *work;  /* (nunknown) */
  double from, to;         /* the step that was just accepted [s] */
  int failures;            /* of Newton's since then */
  long since;              /* steps since the mark */
  double mark;             /* a time [s] */
  double *vdot1, *lambda1; /* (nv), (nrow) */
  double *guess;           /* (nv) vdot1 where Newton starts */
  double *lambda0;         /* (nrow) at the start of the step */
  double *X0, *X1, *P, *S; /* (n), (n), (nv), (nv) of the step */
  double *move;            /* (nv) D */
  double *Q;               /* (nv) */
  double *g, *g_t;         /* (nrow) */
  double *r, *x, *dx;      /* (n) */
  tdm_mat3 *inertia;       /* (nbody) world axes */
  tdm_mat3 *turned;        /* (nbody) dtheta = T dD */
  bool turns;              /* T is not 1 to speak of */
  mbd_alpha_rows *rows;    /* (npart) */
  double rounding[2];      /* of positions and angles [m, rad] */
  double *normal;          /* (nfriction) normal forces of frictions in the pass before */
} mbd_alpha;

/* Find the response to data's load at (t, y0), the start of a window: s->X. */
bool mbd_alpha_respond(mbd_alpha *s, double t);

/* X and l at time t into out (n). */
void mbd_alpha_response(const mbd_alpha *s, double t, double *out);

/* how far a body may turn in a step [rad] */
static const double mbd_turn_most = 1.5;

/* From y0 at t to y1 at t1; false: Newton's iteration failed or a body turned too far. */
bool mbd_alpha_step(mbd_alpha *s, double t, double t1);

/* All but the factors, which fit any state. */
void mbd_alpha_copy(const mbd_alpha *s, mbd_alpha_memory *to, const mbd_alpha_memory *from);

/* The local errors in the step of h that mbd_alpha_step has made, of the worst body, over what they may be: of the
 * velocity relative_tolerance of the largest speed so far and absolute_tolerance, of the place that to the power of 2/3
 * of the way that this speed makes in the step. Both go with the step alike then, and places are right to that share of
 * the way. Motions that are too stiff for the step and not excited do not count. */
double mbd_alpha_error(mbd_alpha *s, double h);

/* out = [M x + G^T l; G x] with (x, l) = in, at the last evaluation */
void mbd_alpha_multiply(const mbd_alpha *s, const double *in, double *out);

/* x M x of body b's part x (6), at the last evaluation */
double mbd_alpha_by_mass(const mbd_alpha *s, int b, const double *x);

/* Speed of body b in y, its turn counted by its kinetic energy [m/s] */
double mbd_alpha_speed(const mbd_alpha *s, int b, const double *y);

/* The step is over: y1 is the state, its accelerations the next step's past. Keeps Vdot of the start in s->Q, its
 * lambda in s->lambda0. */
void mbd_alpha_accept(mbd_alpha *s, double t1, double h);

/* y's poses are those of y0 moved by (dr, dtheta) (nv) */
void mbd_alpha_place(const mbd_model *model, double *y, const double *y0, const double *move);

#endif
