/* Bodies that move as the scene says: a constant velocity, a rotation about a centre and an oscillation, together.
 *
 * With tau = the time since `start`, at most end - start:
 *   centre   c(tau) = c0 + v tau + A (sin(2 pi f tau + phase) - sin(phase))
 *   position x(tau) = c(tau) + R(omega tau) (x0 - c0), orientation q(tau) = exp(omega tau) q0
 * so the motion begins at the body's own pose. Before `start` and from `end` on the body rests.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_MODEL_DRIVEN_H
#define DEM_MODEL_DRIVEN_H

#include "protocol/motion/harmonic.h"

typedef struct {
  bool given;         /* the body is driven */
  tdm_vec3 velocity;  /* world [m/s] */
  tdm_vec3 angular;   /* world [rad/s] */
  tdm_vec3 center;    /* c0: of the rotation, world, at the start [m] */
  tdm_vec3 amplitude; /* world [m] */
  tdm_harmonic swing; /* of `amplitude` [1]: sin(2 pi f tau + phase) */
  double start, end;  /* [s]; inf: no end */
} dem_drive;

/* Read the key "motion" of a body at `pose` (not given when it is missing). */
dem_drive dem_drive_read(tdm_object *body, const tdm_pose *pose);

/* Pose and twist at time t of the body that is at `at_start` (its twist is not used) until the drive starts; the twist
 * is the derivative of the pose. A body without a drive rests. */
tdm_state dem_driven_state(const dem_drive *drive, const tdm_state *at_start, double t);

/* The largest speed that a point no further than `reach` from the centre gets [m/s]. */
double dem_drive_speed(const dem_drive *drive, double reach);

#endif
