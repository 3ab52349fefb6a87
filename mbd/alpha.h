/* One step of generalised-alpha on the group of poses (Arnold & Bruls 2007, Multibody Syst. Dyn. 18, 185-202;
 * Bruls & Cardona 2010, J. Comput. Nonlinear Dyn. 5, 031002).
 *
 * A step of length h from (q, V) with the accelerations Vdot and the method's own a:
 *   (1 - am) a1 + am a = (1 - af) Vdot1 + af Vdot,
 *   q1 = exp(D) o q,  D = h V + h^2 ((1/2 - beta) a + beta a1),   V1 = V + h ((1 - gamma) a + gamma a1),
 *   M Vdot1 - Q + G^T lambda1 = 0 and g = 0 at (q1, V1),
 * with am, af, beta, gamma from the spectral radius at infinity (Chung & Hulbert 1993, J. Appl. Mech. 60, 371-375):
 * second order. exp turns by the rotation vector in world axes. Newton's unknowns are Vdot1 and lambda1; g is divided
 * by dq1/dVdot1 = b h^2, so that the matrix stays well scaled as h goes to zero (Bottasso, Bauchau & Cardona 2007, SIAM
 * J. Sci. Comput. 29, 397-414). Then V1 is put onto G V + g_t = 0 by the smallest change in the sense of kinetic
 * energy.
 *
 * Loads come as a polynomial over a window, and the next window's need not go on where this one ends. Within a step the
 * load is the straight line with its mean and first moment, so that the impulse is exact. Where the load or its slope
 * jumps between steps, Vdot and a jump by the response of the mechanism: the load's past does not ring on.
 *
 * a is kept as rise = (a - Vdot)/h, which is (am - af) d(Vdot)/dt and so does not depend on the step: steps may change.
 */
#ifndef MBD_ALPHA_H
#define MBD_ALPHA_H

#include "mbd/integrator.h"
#include "mbd/lu.h"

/* the rows of one part at the last evaluation */
typedef struct {
  int body[2], first, n;
  double G[MBD_ROWS_MAX][MBD_PAIR];
} mbd_alpha_rows;

/* what the next step needs beside data's state; kept and given back by save and restore */
typedef struct {
  double *vdot;       /* (nv) */
  double *rise;       /* (nv) */
  double *lambda;     /* (nrow) */
  tdm_wrench *load;   /* (2 ncoupled) at the end of the last step, and its slope [1/s] */
  mbd_lu *step;       /* factors of Newton's matrix */
  mbd_lu *mass;       /* of [M G^T; G 0] */
  double step_length; /* of `step` [s], 0: to be made anew */
  bool mass_made;
  bool started; /* no step was made since the start: rise is d(Vdot)/dt yet */
} mbd_alpha_memory;

/* a load on all coupled bodies, as in mbd_data */
typedef struct {
  double t0, t1;
  int n;
  tdm_wrench *load;
} mbd_alpha_load;

typedef struct {
  const mbd_model *model; /* borrowed */
  mbd_data *data;         /* borrowed */
  mbd_kkt *kkt;           /* borrowed */
  mbd_stop_fn stop_fn;
  void *stop_context;
  double am, af, beta, gamma;
  int nv, n; /* 6 nbody; with the constraint rows */
  mbd_alpha_memory now;
  mbd_alpha_load line; /* the load of a step */
  /* workspace */
  double *y0, *y1, *work;  /* (nunknown) */
  double from, to;         /* the step that was just accepted [s] */
  double *vdot1, *lambda1; /* (nv), (nrow) */
  double *lambda0;         /* (nrow) at the start of the step */
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

/* how far a body may turn in a step [rad] */
static const double mbd_turn_most = 1.5;

static inline tdm_wrench mbd_alpha_along(tdm_wrench a, double s, tdm_wrench b) {
  return (tdm_wrench){tdm_axpy(s, b.force, a.force), tdm_axpy(s, b.moment, a.moment)};
}

/* From y0 at t to y1 at t1; false: Newton's iteration failed or a body turned too far, only the response to the load is
 * kept. */
bool mbd_alpha_step(mbd_alpha *s, double t, double t1);

/* The step is over: y1 is the state, its accelerations the next step's past. Keeps vdot of the start in s->Q, its
 * lambda in s->lambda0. */
void mbd_alpha_accept(mbd_alpha *s, double t1, double h);

/* y's poses are those of y0 moved by (dr, dtheta) (nv) */
void mbd_alpha_place(const mbd_model *model, double *y, const double *y0, const double *move);

#endif
