/* How particles move from step to step: the integrators, chunk by chunk, compiled once for each instruction set.
 *
 * To add one: a row of DEM_INTEGRATOR_LIST, and begin_, end_ and (if it keeps something) remember_ in integrate.c.
 *
 * verlet          velocity Verlet: v += a dt/2, x += v dt; with the new forces v += a dt/2.
 * leap-frog       keeps the velocity of mid-step: w += a dt, x += w dt.
 * stormer-verlet  keeps the position of the step before: x(t+dt) = 2 x - x(t-dt) + a dt^2, [A07] Eq. 2.3; for the spin
 *                 the angle of the last step in its place.
 * multi-step      velocity Verlet in two levels (r-RESPA: Tuckerman, Berne & Martyna 1992): half a kick of the slow
 *                 forces, `substeps` steps of velocity Verlet with the fast ones alone, the other half. Fast are the
 *                 contacts whose effective mass is below multi_step.mass (walls: whose particle's is); slow are the
 *                 others, gravity and body forces.
 * All are of second order and reversible in time for forces that depend on positions alone.
 *
 * What contacts see as velocity, and laws with damping or history take: the one predicted for the end of the step,
 *   verlet v + a dt; leap-frog w + a dt/2 (w at the new mid-step); stormer-verlet (x(t+dt) - x)/dt + a dt/2;
 *   multi-step, substep j of length h: v + a_fast h/2 after its first kick, + a_slow (j h - dt/2), as the whole half
 *   kick of the slow forces came at once,
 * with the accelerations of the last evaluation: an error of dt^2 in the velocity, of second order in the motion. With
 * the mid-step velocity damping would lag by half a step, which is of first order.
 *
 * dem_state.pace is the velocity at the step boundary for all of them (w + a dt/2, (x - x(t-dt))/dt + a dt/2), so
 * whoever reads or changes velocities between two steps need not know the integrator; after a change, or when dt is
 * another one, what is kept is made anew (dem_state.restart, dem_state.memory_dt).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_STEP_INTEGRATE_H
#define DEM_STEP_INTEGRATE_H

#include "dem/model/integrator.h"
#include "dem/state/data.h"

/* name in a scene, its functions' names, what it keeps */
#define DEM_INTEGRATOR_LIST(X)                  \
  X("verlet", verlet, DEM_KEEPS_NOTHING)        \
  X("leap-frog", leap_frog, DEM_KEEPS_VELOCITY) \
  X("stormer-verlet", stormer, DEM_KEEPS_PLACE) \
  X("multi-step", multi, DEM_KEEPS_FAST_FORCES)

typedef struct dem_stride {
  double dt;      /* [s] */
  double lead;    /* multi-step: how long the slow forces still act until the end of the substep, j h - dt/2 [s] */
  tdm_vec3 shift; /* of dem_lists_shift [m] */
} dem_stride;

/* each ended by a row of NULLs */
extern const dem_integrator dem_integrators_avx512[], dem_integrators_avx2[], dem_integrators_plain[];

#endif
