/* How a coupled body goes through a window, as velocities that LIGGGHTS' mesh movers take from step to step.
 *
 * LIGGGHTS moves a mesh by velocity times step, so a velocity is the way of one step over its length: after the n steps
 * of the window the mesh is where the path ends, to rounding, whatever the path. With h = 1/n and the position
 *
 *   x(s) = x_0 + p_1 s + p_2 s^2 + p_3 s^3      linear: p_1 = x_1 - x_0, p_2 = p_3 = 0
 *                                               Hermite: p_1 = H v_0, p_2 = 3 (x_1 - x_0) - H (2 v_0 + v_1),
 *                                                        p_3 = 2 (x_0 - x_1) + H (v_0 + v_1)
 *
 * the way of step k = 1 ... n is a parabola in k:
 *
 *   x(k h) - x((k - 1) h) = (p_1 h - p_2 h^2 + p_3 h^3) + (2 p_2 h^2 - 3 p_3 h^3) k + 3 p_3 h^3 k^2
 *
 * The mesh begins where the window before has left it; what that differs from x_0 is spread over the steps. SLERP turns
 * the body by the same rotation in each step. Movers turn a mesh about one fixed axis each, so that rotation is done as
 * R_z(c) R_y(b) R_x(a), about x first.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_FOREIGN_LIGGGHTS_MOTION_H
#define DEM_FOREIGN_LIGGGHTS_MOTION_H

#include "protocol/wire/participant.h"

/* The velocity of step k = 1 ... n is c[0] + k c[1] + k^2 c[2]. */
typedef struct {
  tdm_vec3 c[3]; /* [m/s] */
  tdm_vec3 rate; /* about x, then y, then z, world axes, the same in all steps [rad/s] */
  bool turns;    /* else the rates are zero */
} lig_motion;

/* The motion through a window of n steps of dt [s], of a body that is at `place` now and shall go from `start` to `end`
 * (borrowed). */
lig_motion lig_motion_make(tdm_pose place, const tdm_state *start, const tdm_state *end, tdm_interpolation way,
                           double n, double dt);

/* The angles a, b, c of q = q_z(c) q_y(b) q_x(a) [rad]; |b| must be below a right angle. */
tdm_vec3 lig_motion_angles(tdm_quat q);

#endif
