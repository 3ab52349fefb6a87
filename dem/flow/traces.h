/* Paths of chosen particles, in the axes of a body: [A07] Eq. (4.8)-(4.10).
 *
 * With A_lg the rotation from world axes to the body's, r_c, v_c and w the body's place, velocity and angular velocity,
 *
 *   r_l = A_lg (r - r_c),   v_l = A_lg (v - v_c) + dA_lg/dt (r - r_c) = A_lg (v - v_c - w x (r - r_c)),
 *
 * the velocity that is seen by who turns along. Particles are known by their id, the order of creation, so nothing is
 * kept for any other particle.
 *
 * [A07]: N. Alkhaldi, dissertation, chapter 4 (tumbler screening machines).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_FLOW_TRACES_H
#define DEM_FLOW_TRACES_H

#include "dem/state/data.h"

/* Source s has made its particle k (from 0), which is the newest of all. */
void dem_traces_made(dem_data *data, int s, uint64_t k);

/* Where a point that moves is in the axes of a body. */
typedef struct {
  tdm_vec3 position; /* from the body's centre of mass or place, its axes [m] */
  tdm_vec3 velocity; /* relative to the turning axes, in them [m/s] */
} dem_relative;

dem_relative dem_relative_to(const tdm_pose *pose, const tdm_twist *twist, tdm_vec3 position, tdm_vec3 velocity);

/* Path k now; all NaN before its particle is made, and after it has left. All ranks ask for it. */
dem_relative dem_trace_now(const dem_data *data, int k);

#endif
