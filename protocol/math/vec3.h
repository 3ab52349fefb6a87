/* Vectors and 3x3 matrices. Values are passed and returned; everything is inline. SI units, frames as the caller says.
 */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_MATH_VEC3_H
#define TDM_MATH_VEC3_H

#include <math.h>

/* A vector. */
typedef struct {
  double x, y, z; /* components */
} tdm_vec3;

/* A matrix. */
typedef struct {
  double m[3][3]; /* row, column */
} tdm_mat3;

static inline tdm_vec3 tdm_v3(double x, double y, double z) {
  tdm_vec3 v = {x, y, z}; /* no compound literal: C++ has none */
  return v;
}
static inline tdm_vec3 tdm_add(tdm_vec3 a, tdm_vec3 b) {
  return tdm_v3(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline tdm_vec3 tdm_sub(tdm_vec3 a, tdm_vec3 b) {
  return tdm_v3(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline tdm_vec3 tdm_scale(double s, tdm_vec3 a) {
  return tdm_v3(s * a.x, s * a.y, s * a.z);
}
/* a + s b */
static inline tdm_vec3 tdm_axpy(double s, tdm_vec3 b, tdm_vec3 a) {
  return tdm_v3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}
static inline double tdm_dot(tdm_vec3 a, tdm_vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline tdm_vec3 tdm_cross(tdm_vec3 a, tdm_vec3 b) {
  return tdm_v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline double tdm_norm(tdm_vec3 a) {
  return sqrt(tdm_dot(a, a));
}
/* a / |a|; a zero vector stays zero */
static inline tdm_vec3 tdm_unit(tdm_vec3 a) {
  double n = tdm_norm(a);
  return n > 0 ? tdm_scale(1 / n, a) : a;
}

static inline tdm_mat3 tdm_m3_identity(void) {
  tdm_mat3 a = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  return a;
}
static inline tdm_vec3 tdm_m3_mul(tdm_mat3 a, tdm_vec3 v) {
  return tdm_v3(a.m[0][0] * v.x + a.m[0][1] * v.y + a.m[0][2] * v.z,
                a.m[1][0] * v.x + a.m[1][1] * v.y + a.m[1][2] * v.z,
                a.m[2][0] * v.x + a.m[2][1] * v.y + a.m[2][2] * v.z);
}
/* transpose(a) v */
static inline tdm_vec3 tdm_m3_tmul(tdm_mat3 a, tdm_vec3 v) {
  return tdm_v3(a.m[0][0] * v.x + a.m[1][0] * v.y + a.m[2][0] * v.z,
                a.m[0][1] * v.x + a.m[1][1] * v.y + a.m[2][1] * v.z,
                a.m[0][2] * v.x + a.m[1][2] * v.y + a.m[2][2] * v.z);
}
static inline tdm_mat3 tdm_m3_mat(tdm_mat3 a, tdm_mat3 b) {
  tdm_mat3 c;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      c.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j];
  return c;
}
static inline tdm_mat3 tdm_m3_transpose(tdm_mat3 a) {
  tdm_mat3 t;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      t.m[i][j] = a.m[j][i];
  return t;
}

/* The inverse; entries are not finite when there is none. */
static inline tdm_mat3 tdm_m3_inverse(tdm_mat3 a) {
  tdm_vec3 r0 = {a.m[0][0], a.m[0][1], a.m[0][2]}, r1 = {a.m[1][0], a.m[1][1], a.m[1][2]};
  tdm_vec3 r2 = {a.m[2][0], a.m[2][1], a.m[2][2]};
  double det = tdm_dot(r0, tdm_cross(r1, r2));
  tdm_vec3 c0 = tdm_scale(1 / det, tdm_cross(r1, r2)), c1 = tdm_scale(1 / det, tdm_cross(r2, r0));
  tdm_vec3 c2 = tdm_scale(1 / det, tdm_cross(r0, r1));
  tdm_mat3 inverse = {{{c0.x, c1.x, c2.x}, {c0.y, c1.y, c2.y}, {c0.z, c1.z, c2.z}}};
  return inverse;
}

/* the matrix [v]x with [v]x w = v x w */
static inline tdm_mat3 tdm_m3_skew(tdm_vec3 v) {
  tdm_mat3 a = {{{0, -v.z, v.y}, {v.z, 0, -v.x}, {-v.y, v.x, 0}}};
  return a;
}

#endif
