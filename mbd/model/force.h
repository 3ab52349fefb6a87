/* Forces between two bodies.
 *
 * A force gives the wrenches Q on its two bodies (12 entries as in kin.h, about each centre of mass) and, when asked,
 * the derivatives of Q with respect to the pair's coordinates and twist.
 *
 * Most act along coordinates of the pair: rows of rows.h, whose violation is the coordinate x and whose G and
 * H are its derivatives. Then Q = -G^T f(x, xdot) and everything else follows in mbd_force_apply (force/force.h), with
 * an exact potential where f has one. A new force is one file in force/ and one row in force/table.c.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MODEL_FORCE_H
#define MBD_MODEL_FORCE_H

#include "mbd/model/joint.h"
#include "protocol/view/view.h"

typedef struct mbd_force mbd_force;

/* what a force is at one instant; numbers are zero on entry to eval */
typedef struct {
  bool second;                  /* fill K and C as well */
  double near;                  /* its coordinate a moment ago: angles come out within half a turn of it */
  double now;                   /* time of the evaluation [s] */
  int way;                      /* friction: sign of the rate that it resists, 0: it has no force but the viscous one */
  double normal;                /* friction: the force that its coefficient multiplies [N], of a torque [N m] */
  double Q[MBD_PAIR];           /* wrenches on the first and second body [N, N m] */
  double K[MBD_PAIR][MBD_PAIR]; /* dQ/dq */
  double C[MBD_PAIR][MBD_PAIR]; /* dQ/dV */
  double value;                 /* tension [N] or torque [N m] */
  double coordinate, rate;      /* length [m] or continuous angle [rad], and its rate */
  double rotation;              /* of forces that have one [rad], 0 to pi */
  double potential;             /* energy stored [J] */
  double dissipated;            /* power turned into heat, not negative [W] */
  double supplied;              /* power brought in from outside [W] */
  mbd_rows rows;                /* coordinates along which it acts; none on entry */
} mbd_force_value;

typedef struct {
  const char *name;            /* first: as tdm_types asks */
  size_t size;                 /* of the force's own parameters [bytes], 0: it has none */
  const char *value_unit;      /* "N" or "N m"; NULL: as its joint coordinate has it, also the two below */
  const char *coordinate_name; /* "length" or "angle" */
  const char *coordinate_unit; /* "m" or "rad" */
  /* Read the keys behind name and type into the force and force->own, which is zero. */
  void (*read)(mbd_force *force, tdm_object *o, const mbd_model *model);
  void (*eval)(const mbd_force *force, const mbd_kin *a, const mbd_kin *b, mbd_force_value *value);
  bool spans;  /* in pictures it is a line between the points of force->frame, of the kind below */
  bool twists; /* in pictures it is a short line along the axis of its joint, if that is one of the scene's */
  tdm_view_line_kind line;
  bool turns; /* its rows are the three ways and three rotations between two frames, which are outputs; the rotation
                 must stay below half a turn */
  /* Friction, which has force->rubbing: the coefficient (or limit) at which it slides at `rate`, and its derivative by
   * it. NULL: the force is no friction. */
  double (*level)(const mbd_force *force, double rate, double *slope);
  /* Refuse a law over time that has no value at some time of [t0, t1] [s]; NULL: it has none. `path` is the force's. */
  tdm_status (*check_times)(const mbd_force *force, double t0, double t1, const char *path, tdm_error *err);
  /* The law of time that scales it, borrowed; NULL, or returns NULL: it does not depend on time by itself. */
  const tdm_motion *(*law)(const mbd_force *force);
  void (*clear)(mbd_force *force); /* free what its own parameters own; NULL: nothing */
} mbd_force_ops;

/* Friction, as far as the modes of sticking and sliding know it (consistent/stick.h): its force is level(rate) times a
 * normal force, which is `base` and what the joint's own reaction adds. */
typedef struct {
  double hold; /* coefficient of friction at rest [1]; or the limit itself [N, N m] */
  double base; /* normal force without the reaction [N], of a torque times the radius [N m]; of limits 1 */
  bool reacts; /* the joint's reaction adds to it */
  double across, along, about; /* factors of the reaction's force across and along the axis and moment about it */
  double length;               /* of the bearing, whose ends take the moment across the axis [m]; 0: they do not */
  int stick, part, row; /* places in mbd_data.stick, of the joint in mbd_model.part, and of its own row; the model's */
} mbd_rubbing;

struct mbd_force {
  char name[40];
  const mbd_force_ops *ops;
  int body[2];               /* MBD_GROUND: the fixed world */
  const mbd_joint *joint;    /* whose coordinate it acts on: one of the model's (borrowed), or `frame` */
  mbd_joint frame;           /* points and axes of a force without a joint */
  mbd_coordinate coordinate; /* of the joint */
  mbd_rubbing *rubbing;      /* of a friction, in `own`; NULL: it is none */
  void *own;                 /* (ops->size) the type's own parameters, known to its file alone; owned by the model */
};

#endif
