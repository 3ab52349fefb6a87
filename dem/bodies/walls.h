/* The walls of moving bodies: putting them in place, and counting the particles that went through. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_BODIES_WALLS_H
#define DEM_BODIES_WALLS_H

#include "dem/bodies/path.h"
#include "dem/state/data.h"

/* Bring the coupled bodies and their walls to step k of a window of n steps along `motion` (ncoupled). */
void dem_bodies_move(dem_data *data, const dem_path *motion, uint64_t k, uint64_t n);

/* Bring the driven bodies and their walls to time t [s]. */
void dem_bodies_drive(dem_data *data, double t);

/* Put the walls of the coupled bodies where their poses say. */
void dem_coupled_walls_put(dem_data *data);

/* Put the walls of all bodies where the poses say. */
void dem_walls_put(dem_data *data);

/* Mobility Y of coupled body `coupled` now, row by row. Used from the next force on; all zero: it cannot be moved.
 * Ignored when the scene gives contact.wall_mass. */
void dem_set_body_mobility(dem_data *data, int coupled, const double Y[36]);

/* Particles that are behind a plane that they began in front of: they went through it and feel it no more. All
 * ranks ask for it. */
long dem_count_lost(const dem_data *data);

/* Particles that nothing will stop any more: below every wall and sink by more than a diameter, along gravity. They
 * went through a hole or over an edge. `first` becomes the index of one of them. 0 without gravity, without walls,
 * where gravity's direction repeats, and for what a plane, an endless cylinder or a sink's plane is still to catch. All
 * ranks ask for it. */
long dem_count_fallen(dem_data *data, int *first);

/* Take the lids away, until dem_lids_place puts each at the highest particle in its box plus its gap (without
 * particles: at its face). Both leave the forces as they are; the lists are to be rebuilt after placing.
 * dem_lids_place returns whether there is any lid. */
void dem_lids_away(dem_data *data);
bool dem_lids_place(dem_data *data);

/* Largest overlap of a particle with wall w, as a share of its radius. All ranks ask for it. */
double dem_deepest(const dem_data *data, int w);

/* Largest overlap so far of entry k of the walls' list [m], if the normal law keeps it; else 0. */
double dem_wall_deepest_so_far(const dem_data *data, size_t k);

/* Elastic part of the force of the particles listed with a lid, along its outward normal [N]: of the normal law,
 * without cohesion. All ranks ask for it. */
double dem_lid_force(dem_data *data, const dem_box *box);

#endif
