/* What a group of particles has besides the rest: body forces, and particles that never move; and two dimensions. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_MODEL_GROUP_OPTIONS_H
#define DEM_MODEL_GROUP_OPTIONS_H

#include "dem/model/model.h"

/* Read "force", "acceleration" and "fixed" of an entry of dem.particles into its group, whose particles are there. */
void dem_read_group_extras(dem_model *model, dem_group *group, tdm_object *entry);

/* Read "dimension", "plane" and "plane_at". */
void dem_read_dimension(dem_model *model, tdm_object *section);

/* Put the particles at the start into the plane; refuse motion out of it. */
void dem_put_in_plane(dem_model *model, tdm_error *err);

/* v with `at` for the component along which particles do not move. */
static inline tdm_vec3 dem_flatten(const dem_model *m, tdm_vec3 v, double at) {
  if (m->flat >= 0)
    (&v.x)[m->flat] = at;
  return v;
}

#endif
