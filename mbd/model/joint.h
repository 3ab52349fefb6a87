/* Joints: constraint equations between two bodies.
 *
 * A joint gives, row by row, its violation g, its Jacobian G with respect to the pair's twist coordinates (gdot = G V)
 * and the derivative H of each row of G (dG_i = (H_i dq)^T). Everything else follows from these in one place: reactions
 * G^T lambda and their derivative sum lambda_i H_i, the derivative of G V, which is V^T H_i, and the acceleration term
 * Gdot V = V^T H_i V. So a new joint is one file in joint/ that composes rows (joint/rows.h) and one row in
 * joint/table.c.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MODEL_JOINT_H
#define MBD_MODEL_JOINT_H

#include "mbd/model/rows.h"
#include "protocol/scene/scene.h"

typedef struct mbd_joint mbd_joint;

/* Coordinates of the second body against the first that a joint may leave free, zero in the start configuration: the
 * angle about its axis [rad], counted over turns, and the way of its point along the axis [m]. */
typedef enum { MBD_ANGLE, MBD_TRANSLATION } mbd_coordinate;
/* what outputs and messages call them, with the effort on the second body that belongs to each */
typedef struct {
  const char *effort, *effort_unit; /* "torque", "N m" */
  const char *name, *unit;          /* "angle", "rad" */
  const char *rate, *rate_unit;     /* "rate", "rad/s" */
} mbd_coordinate_words;

extern const mbd_coordinate_words mbd_coordinate_table[]; /* indexed by mbd_coordinate */

enum { MBD_HAS_ANGLE = 1 << MBD_ANGLE, MBD_HAS_TRANSLATION = 1 << MBD_TRANSLATION };

enum { MBD_COUPLED_MAX = 3 }; /* joints that one joint couples */

typedef struct {
  const char *name;            /* first: as tdm_types asks */
  size_t size;                 /* of the joint's own parameters [bytes], 0: it has none */
  int nrow;                    /* at most MBD_ROWS_MAX */
  const char *const *equation; /* (nrow) what each row holds, for messages */
  /* Read the joint's own keys (after name, type and bodies, which are set), fill the geometry and joint->own. One that
   * couples others reads these, and names the bodies that it stands between. */
  void (*read)(mbd_joint *joint, tdm_object *o, const mbd_model *model);
  /* Append nrow rows; a and b are the joint's first and second body. A joint that couples others is asked once for
   * each of them (rows->part), with that one's bodies; the rows add up. */
  void (*eval)(const mbd_joint *joint, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows);
  unsigned coordinates; /* set of MBD_HAS_... that outputs, drivers and forces may name */
  bool couples;         /* stands between other joints and has no bodies of its own */
  bool counts;          /* its rows have an angle that is counted over turns */
  bool guides;          /* a body that it holds to the ground is free to move along its axis, which stays where it is */
} mbd_joint_ops;

struct mbd_joint {
  char name[40];
  const mbd_joint_ops *ops;
  int body[2];                          /* MBD_GROUND: the fixed world */
  int row;                              /* its first row among those of all joints */
  const mbd_joint *of[MBD_COUPLED_MAX]; /* the joints whose coordinates it couples, borrowed from the model, NULL behind
                                         * them; none: its own bodies */
  tdm_vec3 arm[2];                      /* joint point from each centre of mass, body axes [m] */
  tdm_mat3 axes[2]; /* columns e1, e2, e3 of the joint's triad in each body's axes; e3 is the joint axis */
  void *own;        /* (ops->size) the type's own parameters, known to its file alone; owned by the model */
};

/* e1, e2 or e3 (k = 0, 1, 2) of side 0 or 1 in world axes, and the joint point's arm. */
static inline tdm_vec3 mbd_joint_axis(const mbd_joint *joint, int side, int k, const mbd_kin *body) {
  const tdm_mat3 *e = &joint->axes[side];
  return tdm_m3_mul(body->A, tdm_v3(e->m[0][k], e->m[1][k], e->m[2][k]));
}
static inline tdm_vec3 mbd_joint_arm(const mbd_joint *joint, int side, const mbd_kin *body) {
  return tdm_m3_mul(body->A, joint->arm[side]);
}

#endif
