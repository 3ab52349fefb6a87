/* The guard: looks at a running simulation every dem.guard.every steps, and warns (remarks "guard.overlap" ...) or
 * stops.
 *
 *   overlap  of two particles, or of one and a wall, above a share of the smaller radius. Looked at more often when
 *            something is so fast that a particle could begin to pass through a wall or another particle meanwhile:
 *            the speeds are looked at every tenth step at least, and with them the way they make
 *   leap     a particle moves more than its radius in a step: it may pass through a thin wall or another particle. Seen
 *            in every step in which lists are made, and lists are made when a particle has moved by half the skin. Or
 *            a body moves more than the smallest radius
 *   lost     a particle is behind a plane that it was in front of; looked at with the overlaps
 *   step     time.dt above the stability limit of the contacts there are (DEM_EIGEN_SHARE of 2/omega), or above a tenth
 *            of the contact time at the present fastest speed (limits.h); every tenth look. At every look: above the
 *            stability limit of bodies that DEM moves itself on the springs of their contacts (proxy.h)
 *   energy   kinetic + potential + elastic has risen from its lowest value by more than a share of all energy there was
 *            (at the first look, and what gravity has given since; at least that of all particles at the speed of rest,
 *            dem.settle.speed). Judged while nothing but contacts, gravity and
 *            constant forces acts: no body moves or has moved since the last look, no surface (belt) moves, no particle
 *            came or went since, the box is not strained, no force acts along a periodic direction. Elastic is
 *            what the scene's laws store (energy_balance.h); cohesion is not judged
 *   numbers  positions and velocities that are no numbers always stop
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_WATCH_GUARD_H
#define DEM_WATCH_GUARD_H

#include "dem/proxy/proxy.h"
#include "dem/state/data.h"

/* At the start of the run: what is there already is no reason to tell. */
void dem_guard_begin(dem_data *data);

/* Note a particle that moved more than its radius in the step of dt under way. */
void dem_guard_note_leap(dem_data *data, double dt);

/* After a step of dt that ended at t. TDM_ERR_NUMERIC: stop. */
tdm_status dem_guard(dem_data *data, double t, double dt, tdm_error *err);

/* At the end of the run, t [s]: remarks on particles that are lost behind planes, or fall below every wall. All ranks
 * ask for it. */
void dem_guard_end(dem_data *data, double t);

/* The same for bodies that DEM moves itself: looks, every dem.guard.every steps, whether dt [s] is short enough for
 * them on the springs of their contacts. */
tdm_status dem_guard_proxy(dem_data *data, const dem_proxy *proxy, double t, double dt, tdm_error *err);

#endif
