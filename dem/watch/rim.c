/* Particles that touch a wall of an open container beyond its rim, where a real one has no wall: see rim.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/watch/rim.h"

#include "dem/seam/homes.h"
#include "dem/state/wall_gap.h"
#include "protocol/scene/remark.h"

#include <math.h>

/* the container whose plane the wall is, if its walls should perhaps end; NULL: none */
static const dem_box *open_box_of(const dem_model *m, int wall) {
  for (int k = 0; k < m->nbox; k++)
    if (m->box[k].unsaid && wall >= m->box[k].first_wall && wall < m->box[k].first_wall + m->box[k].nwall)
      return &m->box[k];
  return NULL;
}

/* how far a point of the box's own axes is out of it [m]: over an open face, or beside a wall on the plane of another
 */
static double beyond(const dem_box *box, tdm_vec3 own) {
  return fmax(fabs(own.x) - box->half.x, fmax(fabs(own.y) - box->half.y, fabs(own.z) - box->half.z));
}

static bool beyond_rim(const dem_data *d, const dem_wall_entry *e) {
  const dem_box *box = open_box_of(d->model, e->wall);
  const dem_sphere *s = &d->state.sphere[e->particle];
  if (!box || !dem_touches_at(d, e->wall, s->position, s->radius))
    return false;
  const tdm_pose *pose = &d->state.pose[box->body];
  tdm_vec3 body = tdm_quat_rotate(tdm_quat_conj(pose->orientation), tdm_sub(s->position, pose->position));
  tdm_vec3 own = tdm_quat_rotate(tdm_quat_conj(tdm_quat_unit(box->turn)), tdm_sub(body, box->center));
  return beyond(box, own) > s->radius;
}

/* the first such entry of begin ... end - 1; end: none */
static size_t first_beyond(const dem_data *d, size_t begin, size_t end) {
  while (begin < end && !beyond_rim(d, &d->lists.walls.entry[begin]))
    begin++;
  return begin;
}

void dem_rim_look(dem_data *d, double t) {
  const dem_wall_contacts *list = &d->lists.walls;
  const size_t home_end = list->chunk[dem_home_end(d)];
  if (!dem_homes_any(d, first_beyond(d, list->chunk[dem_home_first(d)], home_end) < home_end))
    return;
  dem_unite(d, DEM_PLACES | DEM_MOTION | DEM_LISTS);
  const dem_wall_entry *e = &list->entry[first_beyond(d, 0, list->count)];
  const dem_sphere *s = &d->state.sphere[e->particle];
  const int body = open_box_of(d->model, e->wall)->body;
  char path[TDM_PATH_MAX];
  snprintf(path, sizeof path, "dem.bodies[%d].shapes", body);
  tdm_remark(TDM_WARNING, "rim", path, t,
             "particle id %llu at [%.6g, %.6g, %.6g] m touches a wall of the open box of \"%s\" beyond its rim, at "
             "t = %.9g s: its walls are planes without end; give the box \"edges\": true for walls that end, or false "
             "if that is meant",
             (unsigned long long)d->state.id[e->particle], s->position.x, s->position.y, s->position.z,
             d->model->body[body].name, t);
}
