/* Forces: the contact loops over all chunks, and what they come to for particles and bodies. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_STEP_FORCES_H
#define DEM_STEP_FORCES_H

#include "dem/contact/law/task.h"
#include "dem/state/data.h"
#include "dem/step/integrate.h"

/* The start of a run, after dem_data_create: driven bodies and walls in their places, lids away, lists built, forces
 * evaluated with closed histories. TDM_ERR_MEMORY. */
tdm_status dem_forces_begin(dem_data *data, tdm_error *err);

/* Evaluate the forces at the present positions and velocities without advancing anything. `settling`: with the
 * restitution and friction of the settle phase. Errors: TDM_ERR_MEMORY. */
tdm_status dem_forces_now(dem_data *data, bool settling, tdm_error *err);

/* The same on the lists as they are, histories advanced by dt [s] (0: only evaluate). Particles stay where they are. */
void dem_forces_again(dem_data *data, bool settling, double dt);

/* For benchmarks: the contact loops alone, on the lists as they are, histories advanced by dt. Sums over chunks stay
 * unfinished: dem_forces_again is to follow. */
void dem_forces_frozen(dem_data *data, double dt);

/* ---- parts of a step ---- */

/* Add the forces of a share of the contacts to those on particles (push, zeroed before), and put their sums in the
 * bodies' loads; then, with an integrator (NULL: none), end its step. */
void dem_forces_add(dem_data *data, dem_share share, bool settling, double dt, const dem_integrator *integrator);

/* No forces on home particles. push: state.push or state.spare_push */
void dem_forces_clear(const dem_data *data, dem_push *push);

/* Multi-step has two sets of forces: push becomes the other one. */
void dem_forces_swap(dem_data *data);

/* Add the slow forces of multi-step (push, zeroed before) and their loads to the fast ones' (fast_load). */
void dem_forces_add_slow(dem_data *data, bool settling, double dt);

/* to += share * from, over the loads of the model (nload) */
void dem_loads_add(const dem_data *data, double share, const tdm_wrench *from, tdm_wrench *to);

#endif
