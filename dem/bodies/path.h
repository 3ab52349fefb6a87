/* How coupled bodies move inside a window: along paths, from the states at the start to those at the end, or by the
 * mechanism that holds them (proxy/proxy.h).
 *
 * With s = (t - t0)/H: the orientation goes by SLERP, q(s) = q0 exp(s phi/2), |phi| <= pi, so the angular velocity is
 * the constant R(q0) phi/H; the position goes linearly, as in [L18], or as the cubic Hermite polynomial of the two
 * ends' positions and velocities. The twist is the derivative of the path, not the solver's own twist at the ends:
 * otherwise the works of the two sides disagree.
 *
 * Where the path comes with nodes it goes through them instead (protocol/wire/nodes.h), its angular velocity too.
 *
 * With `sent` contacts feel another twist than that of the path: the solver's own at the end, all through the window
 * ([L18] Section 2.2).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_BODIES_PATH_H
#define DEM_BODIES_PATH_H

#include "protocol/wire/participant.h"

typedef struct {
  tdm_interpolation interpolation;
  double duration; /* H [s] */
  tdm_state start, end;
  tdm_vec3 turn;    /* phi: rotation vector from start to end, body axes [rad] */
  tdm_vec3 angular; /* of the path, world [rad/s] */
  tdm_nodes path;   /* borrowed; no nodes: none */
  int body;         /* in path */
  double t0;        /* when the window begins [s] */
  bool sent;        /* contacts feel end.twist */
} dem_path;

dem_path dem_path_make(const tdm_state *start, const tdm_state *end, double duration, tdm_interpolation interpolation);

/* The path of coupled body `body` through the nodes that a STEP has; its arrays are borrowed. */
dem_path dem_path_through(const tdm_step *step, int body);

/* The mechanism that holds the coupled bodies, as a window begins. Arrays are borrowed. */
typedef struct {
  const tdm_state *start; /* (ncoupled) states of the bodies */
  tdm_proxy proxy;        /* how it answers to loads */
  tdm_nodes path;         /* what drivers prescribe; no nodes: nothing that bends within the window */
} dem_mechanism;

/* Pose at s in [0, 1]: exactly the given pose at 0 and 1. */
tdm_pose dem_path_pose(const dem_path *motion, double s);

/* Twist at s in [0, 1]. */
tdm_twist dem_path_twist(const dem_path *motion, double s);

/* Twist that contacts feel there. */
tdm_twist dem_path_felt(const dem_path *motion, double s);

#endif
