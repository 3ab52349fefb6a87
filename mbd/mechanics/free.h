/* Directions in which nothing holds a body. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MECHANICS_FREE_H
#define MBD_MECHANICS_FREE_H

#include "mbd/mechanics/state.h"

/* World directions (unit, perpendicular to each other) in which a body's centre of mass is moved by the coupling load
 * and gravity alone, throughout the run, into out; how many. Three for a body without joints, drivers and forces; one,
 * the axis, for a body that a prismatic or cylindrical joint to the ground alone holds; else none is told. At
 * data->y, the start. */
int mbd_free_directions(const mbd_model *model, const mbd_data *data, int body, tdm_vec3 out[3]);

#endif
