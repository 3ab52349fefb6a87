/* The unknowns and the run's state.
 *
 * Unknowns y (nunknown = 14 nbody + 2 nrow):
 *   per body   r (3) position, p (4) Euler parameters w x y z, v (3) velocity, w (3) angular velocity; world axes
 *   per row    lambda (reactions), then per row mu (position multipliers of the GGL form, zero in exact arithmetic)
 *   per body   eta (multiplier of the Euler-parameter norm, zero in exact arithmetic)
 * Equations stand in the same order: kinematics (7) and dynamics (6) of each body, then the velocity constraints, the
 * position constraints and the norms.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MECHANICS_STATE_H
#define MBD_MECHANICS_STATE_H

#include "mbd/model/model.h"

enum { MBD_BODY_UNKNOWNS = 13, MBD_R = 0, MBD_P = 3, MBD_V = 7, MBD_W = 10 };

/* the run's counters, reported when the solver ends */
typedef struct {
  long steps, residuals, jacobians, error_failures, convergence_failures, restarts;
} mbd_stats;

/* done on the mechanism since the start [J], or a power [W] */
typedef struct {
  double supplied;   /* by drivers, applied forces, loads on coupled bodies */
  double coupled;    /* the share of the latter */
  double dissipated; /* turned into heat */
} mbd_work;

/* What the guard has seen (guard.h). */
typedef struct {
  bool looks;
  double kinetic, stored[2], passed; /* largest, range, largest [J] */
  double off, share;                 /* largest balance [J], and of the scale then */
} mbd_guard_state;

/* What a friction does (force/friction.c, stick.h): its row holds the coordinate, or it slides, or others hold the
 * coordinate. A row that is not in use has no equation, as a dependent one. */
typedef struct {
  bool stuck;
  int way;       /* when not stuck: sign of the rate that it resists, 0: none */
  double hold;   /* coordinate at which it sticks [m, rad] */
  double normal; /* the force that its coefficient multiplies, at the last evaluation [N], of a torque [N m] */
} mbd_stick;

/* Three lists make mbd_data. What a run goes on from stands in the first two, X(type, name) and X(type, name, count),
 * by which it is allocated, copied (saved, restored) and freed; `m` is the model. A field that is in none of them but
 * in mbd_data itself is workspace, which every evaluation makes anew. */
#define MBD_STATE_SCALARS(X)                                                                                        \
  X(double, t)              /* [s] */                                                                               \
  X(int, ndependent)        /* constraint rows that others imply, but rows of frictions; mbd_assemble finds them */ \
  X(int, open_row)          /* a dependent row that the motion has opened: not implied after all; -1: none */       \
  X(int, turned)            /* the first force whose rotation came near half a turn, -1: none */                    \
  X(double, turned_at)      /* when [s] */                                                                          \
  X(double, energy_start)   /* all energies at the start [J] */                                                     \
  X(mbd_guard_state, guard) /* what the guard has seen */                                                           \
  X(mbd_work, work)         /* up to t, or up to the sample that is being handed out */                             \
  X(double, drift)          /* largest constraint violation |g| over the steps since it was last read */            \
  X(double, load_t0)        /* load from outside: W(s) = sum_j load[i nload + j] s^j, s = (t - t0)/(t1 - t0) [s] */ \
  X(double, load_t1)        /* [s] */                                                                               \
  X(int, nload)             /* coefficients, 0: no load */

#define MBD_STATE_ARRAYS(X)                                                                                       \
  X(double, y, mbd_nunknown(m))                  /* at t */                                                       \
  X(double, yp, mbd_nunknown(m))                 /* their time derivatives */                                     \
  X(double, angle, m->nforce)                    /* continuous angle of torsional forces at t [rad] */            \
  X(double, turn, m->njoint)                     /* about each joint's axis at t, counted over turns [rad] */     \
  X(mbd_stick, stick, m->nfriction)              /* modes of the frictions */                                     \
  X(bool, dependent, m->nrow)                    /* rows that others imply, and of frictions that do not stick */ \
  X(tdm_wrench, load, m->ncoupled *TDM_LOAD_MAX) /* (ncoupled x nload) */                                         \
  X(double, acceleration, 6 * m->nbody)          /* of the last acceleration-level solve */                       \
  X(double, lambda, m->nrow)                     /* of the same */

#define MBD_WORK_ARRAYS(X)                                                                             \
  X(mbd_kin, kin, m->nbody + 1)                               /* ground first; body b is kin[b + 1] */ \
  X(double, wrench, 6 * m->nbody)                             /* generalised forces */                 \
  X(double, shift, 6 * m->nbody)                              /* G^T mu */                             \
  X(double, g, m->nrow)                                       /* constraint violations */              \
  X(mbd_turn_map, quaternion, m->nbody)                       /* dtheta = T dp */                      \
  X(double, response, m->nreacting *(6 * m->nbody + m->nrow)) /* accelerations and lambda by 1 N of a friction */

typedef double mbd_turn_map[3][4];

#define MBD_SCALAR_FIELD(type, name) type name;
#define MBD_ARRAY_FIELD(type, name, count) type *name;

/* The mutable state of a run with its workspace. */
typedef struct {
  MBD_STATE_SCALARS(MBD_SCALAR_FIELD)
  MBD_STATE_ARRAYS(MBD_ARRAY_FIELD)
  MBD_WORK_ARRAYS(MBD_ARRAY_FIELD)
  bool index3;           /* the residual leaves the velocity constraints out: formulation "index3", where it can */
  double now;            /* time of the evaluation [s] */
  mbd_rows rows;         /* of one joint or driver */
  mbd_force_value force; /* of one force */
  mbd_stats stats;
} mbd_data;

static inline int mbd_nunknown(const mbd_model *m) {
  return 14 * m->nbody + 2 * m->nrow;
}
static inline int mbd_index_lambda(const mbd_model *m, int row) {
  return MBD_BODY_UNKNOWNS * m->nbody + row;
}
static inline int mbd_index_mu(const mbd_model *m, int row) {
  return MBD_BODY_UNKNOWNS * m->nbody + m->nrow + row;
}
static inline int mbd_index_eta(const mbd_model *m, int body) {
  return MBD_BODY_UNKNOWNS * m->nbody + 2 * m->nrow + body;
}

/* Allocate for a model; NULL when memory is out. The state is the model's start, without multipliers. */
mbd_data *mbd_data_create(const mbd_model *model);
void mbd_data_destroy(mbd_data **data);

/* All that a run goes on from, into another data of the same model. The counters stay: they count what was done. */
void mbd_data_copy(const mbd_model *model, mbd_data *to, const mbd_data *from);

/* Copy the load (ncoupled x nload) of a window from t0 to t1 [s], as in mbd_window (mbd/mbd.h). TDM_ERR_PROTOCOL when
 * the polynomial has too many coefficients. */
tdm_status mbd_data_set_load(mbd_data *data, const mbd_model *model, double t0, double t1, int nload,
                             const tdm_wrench *load, tdm_error *err);

/* Load on coupled body i at time t. */
tdm_wrench mbd_load_at(const mbd_data *data, int i, double t);

/* Fill data->kin from unknowns y at time t (data->now); the rotation matrix belongs to the normalised Euler parameters.
 */
void mbd_kinematics(const mbd_model *model, mbd_data *data, double t, const double *y);

/* Pose (normalised) and twist of a body in y. */
tdm_state mbd_body_state(const double *y, int body);
void mbd_set_body_state(double *y, int body, const tdm_state *state);

/* Euler parameters of a body in y, as they stand. */
static inline tdm_quat mbd_quat_of(const double *y, int body) {
  const double *p = y + MBD_BODY_UNKNOWNS * body + MBD_P;
  return (tdm_quat){p[0], p[1], p[2], p[3]};
}

/* A J A^T x: world inertia times a vector. */
static inline tdm_vec3 mbd_inertia_mul(const mbd_body *body, const mbd_kin *k, tdm_vec3 x) {
  return tdm_m3_mul(k->A, tdm_m3_mul(body->inertia, tdm_m3_tmul(k->A, x)));
}
static inline tdm_mat3 mbd_inertia_world(const mbd_body *body, const mbd_kin *k) {
  return tdm_m3_mat(k->A, tdm_m3_mat(body->inertia, tdm_m3_transpose(k->A)));
}

/* Evaluate force i at data->kin into data->force (with derivatives if second). */
const mbd_force_value *mbd_force_at(const mbd_model *model, mbd_data *data, int i, bool second);

/* Evaluate part i of the constraints (model->part) at data->kin and data->now into data->rows (with H if second). What
 * parts give for the same row adds up. A friction that does not stick gives a row of
 * zeros: matrices are filled in always the same order. */
const mbd_rows *mbd_part_at(const mbd_model *model, mbd_data *data, int i, bool second);

/* (G M^-1 G^T)_ii of row k of a part. Two parts with a body in common count as if they had none. */
double mbd_row_mobility(const mbd_model *model, const mbd_data *data, const mbd_rows *rows, int k);

/* Largest distance of a body in y from the world's origin, 1 m at least [m]. */
double mbd_reach(const mbd_model *model, const double *y);

/* After an accepted step to y at time t: count angles on and note the drift. */
void mbd_accept(const mbd_model *model, mbd_data *data, double t, const double *y);

#endif
