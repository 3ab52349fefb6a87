/* The walls of moving bodies: see walls.h. The contacts with them are in contact/loop/. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/bodies/walls.h"

#include "dem/bodies/zone.h"
#include "dem/contact/law/theory.h"
#include "dem/seam/homes.h"
#include "dem/seam/sums.h"
#include "dem/state/wall_gap.h"

#include <assert.h>

/* where wall w is now */
static void put(dem_data *d, int w) {
  dem_wall wall = d->model->wall[w];
  if (d->state.lid[w] != 0)
    wall.point = tdm_axpy(-d->state.lid[w], wall.normal, wall.point);
  d->state.wall[w] = dem_wall_put(&wall, &d->state.pose[wall.body]);
}

void dem_walls_put(dem_data *d) {
  for (int w = 0; w < d->model->nwall; w++)
    put(d, w);
}

void dem_coupled_walls_put(dem_data *d) {
  const dem_model *m = d->model;
  for (int w = 0; w < m->nwall; w++)
    if (m->body[m->wall[w].body].coupled >= 0)
      put(d, w);
}

void dem_bodies_move(dem_data *d, const dem_path *motion, uint64_t k, uint64_t n) {
  const dem_model *m = d->model;
  double s = (double)k / (double)n;
  for (int c = 0; c < m->ncoupled; c++) {
    int b = m->coupled_body[c];
    d->state.pose[b] = dem_path_pose(&motion[c], s);
    d->state.twist[b] = dem_path_felt(&motion[c], s);
  }
  dem_coupled_walls_put(d);
}

void dem_bodies_drive(dem_data *d, double t) {
  const dem_model *m = d->model;
  if (m->ndriven == 0)
    return;
  for (int b = 0; b < m->nbody; b++)
    if (m->body[b].drive.given) {
      tdm_state now = dem_driven_state(&m->body[b].drive, &m->body[b].start, t);
      d->state.pose[b] = now.pose;
      d->state.twist[b] = now.twist;
    }
  for (int w = 0; w < m->nwall; w++)
    if (m->body[m->wall[w].body].drive.given)
      put(d, w);
}

void dem_set_body_mobility(dem_data *d, int coupled, const double Y[36]) {
  const dem_model *m = d->model;
  assert(coupled >= 0 && coupled < m->ncoupled);
  if (m->wall_mass > 0)
    return;
  int b = m->coupled_body[coupled];
  dem_mobility *y = &d->state.mobility[b];
  y->full = false;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      y->vv.m[i][j] = Y[6 * i + j];
      y->wv.m[i][j] = Y[6 * (3 + i) + j];
      y->ww.m[i][j] = Y[6 * (3 + i) + 3 + j];
      y->full = y->full || y->vv.m[i][j] != 0 || y->wv.m[i][j] != 0 || y->ww.m[i][j] != 0;
    }
  y->per_mass = y->full ? 1 / m->body[b].mass : 0;
}

long dem_count_lost(const dem_data *d) {
  const int first = dem_home_first_particle(d), end = dem_home_end_particle(d);
  long lost = 0;
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1) reduction(+ : lost)
  for (int i = first; i < end; i++) {
    bool through = false;
    for (int w = 0; w < d->model->nwall && !through; w++)
      through = dem_through(d, i, w);
    lost += through;
  }
  return dem_homes_sum(d, lost);
}

/* The lowest place of walls and sinks along `up`; -INFINITY: a wall without end or a sink catches what falls. */
static double lowest(const dem_data *d, tdm_vec3 up) {
  const dem_model *m = d->model;
  const double level = 1e-9; /* of a normal's part along `up`: a plane that stands upright catches nothing */
  double least = INFINITY;
  for (int w = 0; w < m->nwall; w++) {
    double low, high;
    const bool plane = m->wall[w].shape->half_space;
    if (dem_wall_extent(&m->wall[w], &d->state.wall[w], up, &low, &high))
      least = fmin(least, low);
    else if (!plane || tdm_dot(d->state.wall[w].normal, up) > level)
      return -INFINITY;
  }
  for (int k = 0; k < m->nsink; k++) {
    const dem_zone zone = dem_zone_now(d, k);
    least = fmin(least, dem_zone_lowest(&zone, up));
  }
  return least;
}

static bool has_fallen(const dem_data *d, int i, tdm_vec3 up, double low) {
  return tdm_dot(up, d->state.sphere[i].position) + 3 * d->state.sphere[i].radius < low;
}

long dem_count_fallen(dem_data *d, int *first) {
  const dem_model *m = d->model;
  const double g = tdm_norm(m->gravity);
  bool repeats = false;
  for (int a = 0; a < 3; a++)
    repeats = repeats || (d->state.domain.periodic[a] && (&m->gravity.x)[a] != 0);
  if (g == 0 || repeats)
    return 0;
  const tdm_vec3 up = tdm_scale(-1 / g, m->gravity);
  const double low = lowest(d, up);
  if (!isfinite(low))
    return 0;
  long fallen = 0;
  for (int i = dem_home_first_particle(d); i < dem_home_end_particle(d); i++)
    fallen += has_fallen(d, i, up, low);
  fallen = dem_homes_sum(d, fallen);
  if (fallen > 0)
    dem_unite(d, DEM_PLACES | DEM_MOTION);
  for (*first = 0; fallen > 0 && !has_fallen(d, *first, up, low);)
    ++*first;
  return fallen;
}

/* ---- lids ---- */

/* A lid that is away is a plane so far out that nothing reaches it: no loop needs to know. */
static const double lid_away = 1e9; /* [m] */

void dem_lids_away(dem_data *d) {
  for (int k = 0; k < d->model->nbox; k++)
    if (d->model->box[k].lid >= 0)
      d->state.lid[d->model->box[k].lid] = lid_away;
}

/* is particle i over the box's face that the lid closes: between the side faces, not below the opposite one? */
static bool over_box(const dem_data *d, const dem_box *box, tdm_vec3 outward, int i) {
  tdm_pose pose = d->state.pose[box->body];
  tdm_vec3 x = tdm_quat_rotate(tdm_quat_conj(pose.orientation), tdm_sub(d->state.sphere[i].position, pose.position));
  tdm_quat back = tdm_quat_conj(box->turn);
  x = tdm_quat_rotate(back, tdm_sub(x, box->center));
  outward = tdm_quat_rotate(back, outward);
  const double at[3] = {x.x, x.y, x.z}, half[3] = {box->half.x, box->half.y, box->half.z};
  const double out[3] = {outward.x, outward.y, outward.z};
  for (int a = 0; a < 3; a++)
    if (fabs(out[a]) > 0.5 ? out[a] * at[a] < -half[a] : fabs(at[a]) > half[a])
      return false;
  return true;
}

bool dem_lids_place(dem_data *d) {
  const dem_model *m = d->model;
  bool any = false;
  for (int k = 0; k < m->nbox; k++) {
    const dem_box *box = &m->box[k];
    if (box->lid < 0)
      continue;
    any = true;
    const dem_wall *wall = &m->wall[box->lid];
    tdm_pose pose = d->state.pose[box->body];
    tdm_vec3 outward = tdm_scale(-1, wall->normal), axis = tdm_quat_rotate(pose.orientation, outward);
    tdm_vec3 face = tdm_pose_point(pose, wall->point);
    double highest = -INFINITY; /* over the nominal face */
    for (int i = dem_home_first_particle(d), end = dem_home_end_particle(d); i < end; i++)
      if (over_box(d, box, outward, i))
        highest = fmax(highest, tdm_dot(tdm_sub(d->state.sphere[i].position, face), axis) + d->state.sphere[i].radius);
    highest = dem_homes_largest(d, highest);
    d->state.lid[box->lid] = isfinite(highest) ? highest + box->gap : 0;
  }
  dem_walls_put(d);
  return any;
}

double dem_deepest(const dem_data *d, int w) {
  double deepest = 0;
  for (int i = dem_home_first_particle(d); i < dem_home_end_particle(d); i++)
    deepest = fmax(deepest, 1 - dem_gap(d, i, w, NULL) / d->state.sphere[i].radius);
  return dem_homes_largest(d, deepest);
}

double dem_wall_deepest_so_far(const dem_data *d, size_t k) {
  const dem_wall_contacts *list = &d->lists.walls;
  bool keeps = d->model->wall_normal->keeps_deepest;
  return keeps ? list->history[(size_t)d->model->columns.normal * list->capacity + k] : 0;
}

/* the normal forces of a chunk on a lid */
static void add_lid_force(const dem_data *d, int chunk, const void *of, double *sum) {
  const dem_model *m = d->model;
  const dem_wall_contacts *list = &d->lists.walls;
  const int lid = *(const int *)of;
  for (size_t k = list->chunk[chunk]; k < list->chunk[chunk + 1]; k++) {
    int w = list->entry[k].wall, i = list->entry[k].particle;
    if (w != lid)
      continue;
    double radius = d->state.sphere[i].radius, gap = dem_gap(d, i, w, NULL);
    const dem_pair *pair = &m->settle_pair[d->state.material[i] * m->nmaterial + m->wall[w].material];
    dem_impact at = {.mass = d->state.mass[i], .radius = radius, .deepest = dem_wall_deepest_so_far(d, k)};
    if (dem_surface_cuts(gap, radius))
      *sum += dem_normal_force(m, pair, at, radius - gap);
  }
}

double dem_lid_force(dem_data *d, const dem_box *box) {
  double sum;
  dem_sum_chunks(d, 1, add_lid_force, &box->lid, &sum);
  return sum;
}
