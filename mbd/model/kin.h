/* Kinematics of one body as joints and forces see it, and the 12 coordinates of a pair of bodies.
 *
 * A pair's vectors have 12 entries: first body (3 translations, 3 rotations), second body (3, 3), world axes.
 * Rotations are the infinitesimal rotation vector in world axes: a body-fixed vector a changes by dtheta x a.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MODEL_KIN_H
#define MBD_MODEL_KIN_H

#include "protocol/math/pose.h"

typedef struct {
  tdm_vec3 r; /* centre of mass [m] */
  tdm_vec3 v; /* its velocity [m/s] */
  tdm_vec3 w; /* angular velocity [rad/s] */
  tdm_mat3 A; /* body axes to world axes */
} mbd_kin;

typedef struct mbd_model mbd_model;

/* offsets in a pair's vectors */
enum { MBD_RA = 0, MBD_TA = 3, MBD_RB = 6, MBD_TB = 9, MBD_PAIR = 12 };

static inline void mbd_put3(double *to, double s, tdm_vec3 v) {
  to[0] += s * v.x;
  to[1] += s * v.y;
  to[2] += s * v.z;
}

static inline tdm_vec3 mbd_get3(const double *from) {
  return tdm_v3(from[0], from[1], from[2]);
}

static inline void mbd_set3(double *to, tdm_vec3 v) {
  to[0] = v.x;
  to[1] = v.y;
  to[2] = v.z;
}

/* block(row, col) += s m */
static inline void mbd_put33(double block[MBD_PAIR][MBD_PAIR], int row, int col, double s, tdm_mat3 m) {
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      block[row + i][col + j] += s * m.m[i][j];
}

/* [a]x [b]x */
static inline tdm_mat3 mbd_skew2(tdm_vec3 a, tdm_vec3 b) {
  return tdm_m3_mat(tdm_m3_skew(a), tdm_m3_skew(b));
}

/* twist of a pair in its 12 coordinates */
static inline void mbd_pair_twist(const mbd_kin *a, const mbd_kin *b, double twist[MBD_PAIR]) {
  mbd_set3(twist + MBD_RA, a->v);
  mbd_set3(twist + MBD_TA, a->w);
  mbd_set3(twist + MBD_RB, b->v);
  mbd_set3(twist + MBD_TB, b->w);
}

#endif
