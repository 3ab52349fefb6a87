/* Poses, twists, wrenches and the conversions of [L18] Section 2.2.
 *
 * World frame everywhere on the wire. A pose is the position of the body's centre of mass and the unit quaternion that
 * turns body axes into world axes (v_world = q v_body q*). A twist is velocity and angular velocity, a wrench is force
 * and moment about the centre of mass, all in world axes.
 */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_MATH_POSE_H
#define TDM_MATH_POSE_H

#include "protocol/math/vec3.h"

#include <assert.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A quaternion. */
typedef struct {
  double w;       /* scalar part */
  double x, y, z; /* vector part */
} tdm_quat;

/* Where a body is, and how it is turned. */
typedef struct {
  tdm_vec3 position;    /* [m] */
  tdm_quat orientation; /* unit */
} tdm_pose;

/* How a body moves. */
typedef struct {
  tdm_vec3 velocity; /* [m/s] */
  tdm_vec3 angular;  /* [rad/s] */
} tdm_twist;

/* A load on a body. */
typedef struct {
  tdm_vec3 force;  /* [N] */
  tdm_vec3 moment; /* about the centre of mass [N m] */
} tdm_wrench;

/* pose and twist, 13 doubles in wire order: x y z, qw qx qy qz, vx vy vz, wx wy wz */
typedef struct {
  tdm_pose pose;   /* of the centre of mass */
  tdm_twist twist; /* likewise, world axes */
} tdm_state;

enum { TDM_STATE_DOUBLES = 13, TDM_WRENCH_DOUBLES = 6 };
static_assert(sizeof(tdm_state) == TDM_STATE_DOUBLES * sizeof(double), "tdm_state is 13 doubles on the wire");
static_assert(sizeof(tdm_wrench) == TDM_WRENCH_DOUBLES * sizeof(double), "tdm_wrench is 6 doubles on the wire");

/* Euler angles of the 3-1-3 body sequence, O = Rz(phi) Rx(theta) Rz(psi) ([L18] Eq. 16 with its bottom row mended). */
typedef struct {
  double phi;   /* first body rotation, precession [rad] */
  double theta; /* second, nutation [rad] */
  double psi;   /* last, spin [rad] */
} tdm_euler313;

/* No rotation; the product, which turns by b first; the conjugate, which is the inverse of a unit quaternion; a vector
 * turned. */
tdm_quat tdm_quat_identity(void);
tdm_quat tdm_quat_mul(tdm_quat a, tdm_quat b);
tdm_quat tdm_quat_conj(tdm_quat q);
tdm_vec3 tdm_quat_rotate(tdm_quat q, tdm_vec3 v);

tdm_quat tdm_quat_unit(tdm_quat q);                  /* normalised; a zero quaternion becomes the identity */
tdm_quat tdm_quat_from_rotvec(tdm_vec3 r);           /* rotation vector: axis times angle [rad] */
tdm_vec3 tdm_quat_to_rotvec(tdm_quat q);             /* the short way, |r| <= pi */
tdm_vec3 tdm_quat_turn(tdm_quat from, tdm_quat to);  /* rotation vector between two orientations, world axes */
tdm_quat tdm_quat_turned(tdm_quat q, tdm_vec3 turn); /* q turned by a rotation vector in world axes; unit */
tdm_mat3 tdm_quat_to_matrix(tdm_quat q);             /* v_world = m v_body */
tdm_quat tdm_quat_from_matrix(tdm_mat3 m);           /* m orthonormal; w >= 0 */

/* SLERP (Shoemake 1985), s in [0,1], the short way; equal and opposite quaternions are handled. */
tdm_quat tdm_quat_slerp(tdm_quat a, tdm_quat b, double s);

/* The rotation with these angles. */
tdm_mat3 tdm_euler313_to_matrix(tdm_euler313 e);
tdm_quat tdm_euler313_to_quat(tdm_euler313 e);

/* The angles of a rotation: theta in [0, pi], phi and psi in (-pi, pi]. At theta = 0 only phi + psi is defined, at
 * theta = pi only phi - psi: psi = 0 is returned there. */
tdm_euler313 tdm_euler313_from_matrix(tdm_mat3 m);
tdm_euler313 tdm_euler313_from_quat(tdm_quat q);

/* [L18] Eq. 15: translation from the start position x0 to x. */
static inline tdm_vec3 tdm_translation(tdm_vec3 x, tdm_vec3 x0) {
  return tdm_sub(x, x0);
}

/* [L18] Eq. 16: an angle [rad] in degrees. */
static inline double tdm_degrees(double angle) {
  return angle * 180 / 3.14159265358979323846; /* strict C has no M_PI */
}

/* Body point (body axes, from the centre of mass) to world. */
tdm_vec3 tdm_pose_point(tdm_pose pose, tdm_vec3 body_point);

/* Velocity of the point of a body that is at `world_point` now. */
tdm_vec3 tdm_point_velocity(const tdm_state *state, tdm_vec3 world_point);

/* true if every number of the array is finite */
int tdm_finite(const double *values, int n);

/* true if every number can be squared in double precision: finite, and at most 1e150 */
int tdm_usable(const double *values, int n);

/* true if the norm is 1, to the digits of single precision */
int tdm_quat_is_unit(tdm_quat q);

/* true if a matrix can be an inertia: finite, symmetric, not negative about any axis (zero is a rod's own) */
int tdm_is_inertia(const tdm_mat3 *inertia);

#ifdef __cplusplus
}
#endif

#endif
