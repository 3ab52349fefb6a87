/* Constraint rows from which joints are built (primitives as in Haug 1989, chapter 9, here with rotations in world
 * axes).
 *
 * All arguments are world axes: arms from the centres of mass, body-fixed directions turned into the world.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_JOINT_ROWS_H
#define MBD_JOINT_ROWS_H

#include "mbd/model/rows.h"

/* Three rows: the points at the ends of both arms coincide. */
void mbd_rows_point(mbd_rows *rows, const mbd_kin *a, const mbd_kin *b, tdm_vec3 arm_a, tdm_vec3 arm_b);

/* One row: a direction of the first and one of the second body are perpendicular. */
void mbd_rows_perpendicular(mbd_rows *rows, tdm_vec3 of_a, tdm_vec3 of_b);

/* One row: the vector from the first to the second body's point is perpendicular to a direction of the first body. */
void mbd_rows_plane(mbd_rows *rows, const mbd_kin *a, const mbd_kin *b, tdm_vec3 of_a, tdm_vec3 arm_a, tdm_vec3 arm_b);

/* One row: the distance between the points at the ends of both arms is `length` [m]. */
void mbd_rows_distance(mbd_rows *rows, const mbd_kin *a, const mbd_kin *b, tdm_vec3 arm_a, tdm_vec3 arm_b,
                       double length);

/* One row: b1, b2 of the second body are a1, a2 of the first turned by `angle` [rad] about a1 x a2. The pairs are
 * orthonormal; any number of turns, and any tilt between the axes but half a turn. g lies in [-pi, pi]. */
void mbd_rows_angle(mbd_rows *rows, tdm_vec3 a1, tdm_vec3 a2, tdm_vec3 b1, tdm_vec3 b2, double angle);

/* Three rows: the rotation vector that turns the first body's triad into the second's, in axes of the first (columns of
 * the triads in world axes) [rad]; regular below a full turn, |g| <= pi. */
void mbd_rows_rotation(mbd_rows *rows, tdm_mat3 triad_a, tdm_mat3 triad_b);

/* One row of zeros. */
void mbd_rows_zero(mbd_rows *rows);

/* The last row times `factor`. */
void mbd_rows_scale(mbd_rows *rows, double factor);

/* Add `factor` times the last row to the one before it, and drop the last. */
void mbd_rows_merge(mbd_rows *rows, double factor);

#endif
