/* Forces between two bodies.
 *
 * A force gives the wrenches Q on its two bodies (12 entries as in kin.h, about each centre of mass) and, when asked,
 * the derivatives of Q with respect to the pair's coordinates and twist. A new force is one file and one row in
 * table.c.
 */
#ifndef MBD_FORCE_H
#define MBD_FORCE_H

#include "mbd/kin.h"
#include "protocol/scene.h"

typedef struct mbd_force mbd_force;

/* what a force is at one instant */
typedef struct {
  bool second;                  /* fill K and C as well (they are zero on entry then) */
  double Q[MBD_PAIR];           /* wrenches on the first and second body [N, N m] */
  double K[MBD_PAIR][MBD_PAIR]; /* dQ/dq */
  double C[MBD_PAIR][MBD_PAIR]; /* dQ/dV */
  double value;                 /* tension [N] or torque [N m] */
  double coordinate, rate;      /* length [m] or continuous angle [rad], and its rate */
  double potential;             /* energy stored [J] */
} mbd_force_value;

typedef struct {
  const char *name;
  const char *value_unit;      /* "N" or "N m" */
  const char *coordinate_name; /* "length" or "angle" */
  const char *coordinate_unit; /* "m" or "rad" */
  /* Read the keys behind name and type. */
  void (*load)(mbd_force *force, tdm_object *o, const mbd_model *model);
  /* Q, K and C are zero on entry. `near` is the continuous angle a moment ago: angles come out within half a turn. */
  void (*eval)(const mbd_force *force, const mbd_kin *a, const mbd_kin *b, double near, mbd_force_value *value);
} mbd_force_ops;

struct mbd_force {
  char name[40];
  const mbd_force_ops *ops;
  int body[2];      /* MBD_GROUND: the fixed world */
  double stiffness; /* [N/m] or [N m/rad] */
  double damping;   /* [N s/m] or [N m s/rad] */
  double free;      /* length [m] or angle [rad] without spring force */
  double preload;   /* tension [N] or torque [N m] at the free length or angle */
  tdm_vec3 arm[2];  /* attachment points from each centre of mass, body axes [m] */
  tdm_mat3 axes;    /* torsional: triad on the first body, columns e1, e2, e3 = axis, body axes */
  tdm_vec3 pointer; /* torsional: e1 at the start, axes of the second body */
};

enum { MBD_FORCE_TYPES_MAX = 32 };
extern const mbd_force_ops *const mbd_force_table[];
extern const int mbd_force_ntype;

#endif
