/* Body forces, fixed particles, two dimensions: see group_options.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/model/group_options.h"

#include "dem/model/read_keys.h"

#include <stdio.h>

void dem_read_group_extras(dem_model *m, dem_group *group, tdm_object *o) {
  const tdm_vec3 zero = {0, 0, 0};
  static const char *const keys[] = {"force", "acceleration", "velocity", "spin"};
  group->force = dem_read_vector(o, keys[0], &zero);
  group->acceleration = dem_read_vector(o, keys[1], &zero);
  group->fixed = tdm_get_bool(o, "fixed", false);
  for (int k = 0; group->fixed && k < 4; k++)
    if (tdm_norm(tdm_get_vec3(o, keys[k], &zero)) > 0)
      tdm_object_fail(o, keys[k], "moves particles that are fixed; remove it, or \"fixed\"");
  bool pushed = tdm_norm(group->force) > 0 || tdm_norm(group->acceleration) > 0;
  m->driven = m->driven || (group->count > 0 && (group->fixed || pushed));
  m->fixes = m->fixes || (group->count > 0 && group->fixed);
}

void dem_read_dimension(dem_model *m, tdm_object *section) {
  static const char *const planes[] = {"yz", "xz", "xy"}; /* by the axis that is left out */
  long dimension = tdm_get_integer(section, "dimension", 3, 2);
  if (dimension > 3)
    tdm_object_fail(section, "dimension", "is %ld; give 3, or 2 for particles in a plane", dimension);
  m->flat = -1;
  static const char *const keys[] = {"plane", "plane_at"};
  for (int k = 0; k < 2 && dimension != 2; k++)
    if (tdm_has(section, keys[k]))
      tdm_object_fail(section, keys[k], "is for \"dimension\": 2 only; remove it, or give that");
  if (dimension != 2)
    return;
  m->driven = true;
  m->flat = tdm_get_choice(section, "plane", planes, 3, 1);
  m->flat_at = tdm_get_number(section, "plane_at", 0, TDM_ANY);
}

void dem_put_in_plane(dem_model *m, tdm_error *err) {
  for (int g = 0; m->flat >= 0 && g < m->ngroup; g++)
    for (int i = m->group[g].first; i < m->group[g].first + m->group[g].count; i++) {
      m->position[i] = dem_flatten(m, m->position[i], m->flat_at);
      tdm_vec3 turn = m->spin[i];
      (&turn.x)[m->flat] = 0;
      char path[TDM_PATH_MAX];
      snprintf(path, sizeof path, "dem.particles[%d]", g);
      if ((&m->velocity[i].x)[m->flat] != 0 || tdm_norm(turn) > 0) {
        tdm_fail(err, TDM_ERR_SCENE, path,
                 "moves out of the plane of dem.plane; with dem.dimension 2 give velocities in it and spins about %c",
                 "xyz"[m->flat]);
        return;
      }
    }
}
