/* Forces between two bodies.
 *
 * A force gives the wrenches Q on its two bodies (12 entries as in kin.h, about each centre of mass) and, when asked,
 * the derivatives of Q with respect to the pair's coordinates and twist.
 *
 * Most act along coordinates of the pair: rows of ../joint/rows.h, whose violation is the coordinate x and whose G and
 * H are its derivatives. Then Q = -G^T f(x, xdot) and everything else follows in mbd_force_apply, with an exact
 * potential where f has one. A new force is one file and one row in table.c.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_FORCE_H
#define MBD_FORCE_H

#include "mbd/joint/joint.h"
#include "protocol/motion/motion.h"
#include "protocol/motion/spline.h"

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
  const char *name;
  const char *value_unit;      /* "N" or "N m"; NULL: as its joint coordinate has it, also the two below */
  const char *coordinate_name; /* "length" or "angle" */
  const char *coordinate_unit; /* "m" or "rad" */
  /* Read the keys behind name and type. */
  void (*load)(mbd_force *force, tdm_object *o, const mbd_model *model);
  void (*eval)(const mbd_force *force, const mbd_kin *a, const mbd_kin *b, mbd_force_value *value);
  bool turns;  /* its rows are the three ways and three rotations between two frames, which are outputs; the rotation
                  must stay below half a turn */
  bool sticks; /* friction: a constraint row of its own holds its coordinate at times (../stick.h) */
} mbd_force_ops;

/* Friction: its force is level(rate) times a normal force, which is `base` and what the joint's own reaction adds. */
typedef struct {
  double hold, slide; /* coefficients of friction at rest and in motion [1]; or the limits themselves [N, N m] */
  double scale;       /* Stribeck velocity [m/s, rad/s], 0: `hold` counts at rest alone */
  double base;        /* normal force without the reaction [N], of a torque times the radius [N m]; of limits 1 */
  bool reacts;        /* the joint's reaction adds to it */
  double across, along, about; /* factors of the reaction's force across and along the axis and moment about it */
  double length;               /* of the bearing, whose ends take the moment across the axis [m]; 0: they do not */
  int stick, part, row;        /* places in mbd_data.stick, of the joint in mbd_model.part, and of its own row */
} mbd_rubbing;

struct mbd_force {
  char name[40];
  const mbd_force_ops *ops;
  int body[2];               /* MBD_GROUND: the fixed world */
  const mbd_joint *joint;    /* whose coordinate it acts on: one of the model's (borrowed), or `frame` */
  mbd_joint frame;           /* points and axes of a force without a joint */
  mbd_coordinate coordinate; /* of the joint */

  double stiffness;            /* [N/m], [N m/rad], contacts [N/m^exponent] */
  double damping;              /* [N s/m], [N m s/rad], contacts [s/m] or [s/rad] */
  double free;                 /* length [m] or angle [rad] without spring force */
  double preload;              /* tension [N] or torque [N m] at the free length or angle */
  tdm_spline *spring, *damper; /* tables that stand for stiffness and damping, NULL: none; owned */
  double smoothing;            /* cable: length over which its stiffness sets in [m] */
  mbd_rubbing rubbing;         /* friction */
  double range[2];             /* stop: lower and upper limit of the coordinate */
  double exponent;             /* contacts: of the penetration */
  double radius;               /* bump: distance of the points, or of point and plane, at contact [m] */
  bool plane;                  /* bump: a plane of the first body */
  double matrix[2][6][6];      /* bushing: stiffness and damping */
  double preloads[6];          /* bushing [N, N m] */
  tdm_vec3 force, moment;      /* wrench at factor 1 [N, N m] */
  bool follows;                /* wrench: it turns with the body */
  tdm_motion factor;           /* wrench: over time; no law: 1 */
};

/* a force along one coordinate x; a positive one pulls x down */
typedef struct {
  double f, by_x, by_rate; /* and its derivatives */
  double potential, dissipated;
} mbd_scalar;

/* Read "bodies" and "points" into body and frame. Returns their distance [m]; points nearer than mbd_force_no_length
 * have none, which is an error where a force must have a direction. */
double mbd_force_read_points(mbd_force *force, tdm_object *o, const mbd_model *model, bool must_part);

static const double mbd_force_no_length = 1e-9; /* [m] */

/* Read "stiffness" or "stiffness_table", "damping" or "damping_table", and "preload". */
void mbd_spring_read(mbd_force *force, tdm_object *o);

/* f = k (x - free) + c xdot + preload, or with the tables in place of k and c. */
mbd_scalar mbd_spring_law(const mbd_force *force, double x, double rate);

/* Read "stiffness", "exponent" and "damping" of a contact. */
void mbd_contact_read(mbd_force *force, tdm_object *o);

/* Push f = k d^n (1 + c ddot) at the penetration d, never negative (Hunt & Crossley, J. Appl. Mech. 42 (1975) 440-445);
 * derivatives are by d and ddot. */
mbd_scalar mbd_contact_law(const mbd_force *force, double penetration, double rate);

/* Coefficient of friction (or limit) of a friction that slides at `rate`, and its derivative by it. */
double mbd_friction_level(const mbd_force *force, double rate, double *slope);

/* Rates of the coordinates value->rows. */
void mbd_force_rates(const mbd_force_value *value, const mbd_kin *a, const mbd_kin *b, double *rate);

/* Add Q = -G^T f along all n coordinates of value->rows, with K and C if asked for; by_x and by_rate are (n x n). */
void mbd_force_apply(mbd_force_value *value, const mbd_kin *a, const mbd_kin *b, const double *f, const double *by_x,
                     const double *by_rate);

/* The same for one coordinate at x, with value, coordinate, rate, potential and dissipation. */
void mbd_force_apply_scalar(mbd_force_value *value, const mbd_kin *a, const mbd_kin *b, double x, double rate,
                            const mbd_scalar *law);

/* Append the distance of the force's two points, or the coordinate of its joint. Returns it, its rate in *rate. */
double mbd_force_distance(const mbd_force *force, const mbd_kin *a, const mbd_kin *b, mbd_force_value *value,
                          double *rate);
double mbd_force_coordinate(const mbd_force *force, const mbd_kin *a, const mbd_kin *b, mbd_force_value *value,
                            double *rate);

/* Free what it owns. */
void mbd_force_clear(mbd_force *force);

enum { MBD_FORCE_TYPES_MAX = 32 };
extern const mbd_force_ops *const mbd_force_table[];
extern const int mbd_force_ntype;

#endif
