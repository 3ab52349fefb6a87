/* The path of the coupled bodies through a window, as states at a few times (nodes), and what lies between them.
 *
 * Between two nodes, a time h apart and with s from 0 to 1, the position goes by the cubic Hermite polynomial of both
 * positions and velocities. The orientation is exp(phi(s)) q0 with the rotation vector phi (world axes) by the Hermite
 * polynomial from 0 to phi1 = log(q1 q0*); its rates at the ends are those that make the angular velocities w0, w1:
 *   dphi/dt = w0 at the start,   D(phi1)^-1 w1 at the end,   w = D(phi) dphi/dt,
 *   D(phi) = 1 + (1 - cos a)/a^2 [phi] + (a - sin a)/a^3 [phi]^2,   a = |phi|,  [phi] x = phi x x
 * (D: the left derivative of the exponential). The twist is the derivative of the pose. Turns between two nodes are to
 * be below a radian or so; the error of a smooth motion is h^4/384 of its fourth derivative.
 */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_WIRE_NODES_H
#define TDM_WIRE_NODES_H

#include "protocol/math/pose.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { TDM_NODES_MAX = 64 }; /* of a window */

/* A path: states of the bodies at a few times. */
typedef struct {
  int nnode, nbody; /* numbers of nodes and of bodies */
  double *time;     /* (nnode) [s], ascending; where the path begins is known elsewhere and is no node */
  tdm_state *state; /* (nnode x nbody), row by row: a node's bodies */
} tdm_nodes;

/* The state at the share s in [0, 1] of the way from a to b, which takes the time h [s]; exactly a and b at the ends.
 */
tdm_state tdm_state_between(const tdm_state *a, const tdm_state *b, double h, double s);

/* The state of a body at time t [s] of a path, with at least one node, that begins with `start` at t0; its ends before
 * and behind. */
tdm_state tdm_nodes_at(const tdm_nodes *path, int body, const tdm_state *start, double t0, double t);

#ifdef __cplusplus
}
#endif

#endif
