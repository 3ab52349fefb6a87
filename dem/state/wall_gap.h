/* The gap between particles and walls, where they are now. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_STATE_WALL_GAP_H
#define DEM_STATE_WALL_GAP_H

#include "dem/state/data.h"

/* Signed distance of the point x (world) from the surface of wall w [m], and the unit normal there (world, towards x;
 * NULL: not wanted): see dem_wall_gap. */
static inline double dem_gap_at(const dem_data *d, int w, tdm_vec3 x, tdm_vec3 *normal) {
  tdm_vec3 n;
  return dem_wall_gap(&d->model->wall[w], &d->state.wall[w], x, normal ? normal : &n);
}

/* Does wall w, which particle i touches, not act on it (dem_shape.lets_go)? */
static inline bool dem_let_go(const dem_data *d, int i, int w) {
  const dem_wall *wall = &d->model->wall[w];
  const dem_sphere *s = &d->state.sphere[i];
  if (!wall->shape->lets_go)
    return false;
  return (d->state.front[(size_t)i * (size_t)d->model->nwall + (size_t)w] & DEM_LET_GO) ||
         wall->shape->lets_go(wall, dem_wall_own(&d->state.wall[w], s->position), s->radius) != DEM_HOLDS;
}

/* The same of the centre of particle i, as wall w is to spheres of its size; the radius where the wall has let it go.
 */
static inline double dem_gap(const dem_data *d, int i, int w, tdm_vec3 *normal) {
  const dem_sphere *s = &d->state.sphere[i];
  tdm_vec3 n;
  const double gap =
      dem_wall_sphere_gap(&d->model->wall[w], &d->state.wall[w], s->position, s->radius, normal ? normal : &n);
  return dem_let_go(d, i, w) ? s->radius : gap;
}

/* Does a sphere of this radius at x touch wall w? One that is altogether behind a wall without end does not. */
static inline bool dem_touches_at(const dem_data *d, int w, tdm_vec3 x, double radius) {
  const dem_wall *wall = &d->model->wall[w];
  tdm_vec3 n;
  return dem_wall_touches(wall, dem_wall_sphere_gap(wall, &d->state.wall[w], x, radius, &n), radius);
}

/* Is particle i altogether behind wall w? Only walls without end have a side behind them: planes, cylinders without
 * end, and spheres seen from inside. */
static inline bool dem_behind(const dem_data *d, int i, int w) {
  return d->model->wall[w].endless &&
         dem_wall_behind(&d->model->wall[w], dem_gap(d, i, w, NULL), d->state.sphere[i].radius);
}

/* Is particle i behind wall w, which it began in front of? */
static inline bool dem_through(const dem_data *d, int i, int w) {
  return (d->state.front[(size_t)i * (size_t)d->model->nwall + (size_t)w] & DEM_IN_FRONT) && dem_behind(d, i, w);
}

/* Note which walls the particles first ... end - 1 are in front of: the reference for dem_through. */
static inline void dem_mark_front(dem_data *d, int first, int end) {
  int nwall = d->model->nwall;
  for (int i = first; i < end; i++)
    for (int w = 0; w < nwall; w++)
      d->state.front[(size_t)i * (size_t)nwall + (size_t)w] = dem_behind(d, i, w) ? 0 : DEM_IN_FRONT;
}

#endif
