/* Pouring: see pour.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/settle/pour.h"

#include "dem/flow/free_space.h"
#include "dem/model/cells.h"
#include "dem/particles/field.h"
#include "dem/particles/particles.h"
#include "dem/seam/homes.h"
#include "protocol/math/random.h"

#include <stdio.h>

enum { CELLS_MANY = 10000000 }; /* of a layer: looked at one by one, again and again */

static const uint64_t LAYERS = (uint64_t)1 << 32; /* numbers of layers among those of particles, for drawing */

bool dem_pour_over(const dem_data *d) {
  return d->state.ledger.created >= (uint64_t)d->model->nparticle;
}

/* the pouring that makes the next particle */
static const dem_pouring *present(const dem_data *d) {
  const dem_model *m = d->model;
  int k = 0;
  while (d->state.ledger.created >= (uint64_t)(m->pouring[k].first + m->pouring[k].count))
    k++;
  return &m->pouring[k];
}

/* the model's next particle, at x */
static tdm_status add(dem_data *d, tdm_vec3 x) {
  const dem_model *m = d->model;
  uint64_t id = d->state.ledger.created;
  dem_newcomer newcomer = {.position = x,
                           .velocity = m->velocity[id],
                           .radius = m->radius[id],
                           .mass = m->mass[id],
                           .material = m->particle_material[id]};
  if (dem_data_add(d, &newcomer))
    return TDM_ERR_MEMORY;
  int i = d->state.nparticle - 1;
  d->state.pace[i].spin = m->spin[id];
  d->state.rotor[i].surface = tdm_scale(m->radius[id], m->spin[id]);
  if (m->oriented)
    d->state.orientation[i] = m->orientation[id];
  return TDM_OK;
}

/* how long a particle takes to leave the region [s] */
static double fall_time(const dem_data *d, const dem_pouring *p) {
  const dem_model *m = d->model;
  double g = tdm_norm(m->gravity);
  tdm_vec3 v = m->velocity[p->first], down = tdm_unit(g > 0 ? m->gravity : v);
  tdm_vec3 along = tdm_quat_rotate(tdm_quat_conj(p->frame.orientation), down), size = tdm_sub(p->high, p->low);
  double way = fabs(along.x) * size.x + fabs(along.y) * size.y + fabs(along.z) * size.z, speed = tdm_dot(v, down);
  return g > 0 ? (sqrt(speed * speed + 2 * g * way) - speed) / g : way / speed;
}

/* ---- layers ---- */

/* the region's box along the world's axes */
static void world_box(const dem_pouring *p, tdm_vec3 *low, tdm_vec3 *high) {
  *low = tdm_v3(INFINITY, INFINITY, INFINITY);
  *high = tdm_v3(-INFINITY, -INFINITY, -INFINITY);
  for (int k = 0; k < 8; k++) {
    tdm_vec3 corner = tdm_v3(k & 1 ? p->high.x : p->low.x, k & 2 ? p->high.y : p->low.y, k & 4 ? p->high.z : p->low.z);
    tdm_vec3 x = tdm_pose_point(p->frame, corner);
    *low = tdm_v3(fmin(low->x, x.x), fmin(low->y, x.y), fmin(low->z, x.z));
    *high = tdm_v3(fmax(high->x, x.x), fmax(high->y, x.y), fmax(high->z, x.z));
  }
}

/* cells of the region in each direction; returns their product */
static uint64_t cells_of(const dem_pouring *p, uint64_t n[3]) {
  tdm_vec3 size = tdm_sub(p->high, p->low);
  const double length[3] = {size.x, size.y, size.z};
  double cells[3];
  for (int a = 0; a < 3; a++)
    cells[a] = fmax(1, floor(length[a] / (2 * p->largest) * (1 + 1e-12)));
  dem_fewer_cells(cells, fmax(CELLS_MANY, 2.0 * p->count));
  for (int a = 0; a < 3; a++)
    n[a] = (uint64_t)cells[a];
  return n[0] * n[1] * n[2];
}

/* a place for a particle of radius r in cell c of n, world */
static tdm_vec3 place_in(const dem_model *m, const dem_pouring *p, uint64_t c, const uint64_t n[3], uint64_t layer,
                         double r) {
  tdm_vec3 size = tdm_sub(p->high, p->low);
  const double length[3] = {size.x, size.y, size.z};
  const uint64_t at[3] = {c % n[0], c / n[0] % n[1], c / (n[0] * n[1])};
  double x[3];
  for (uint64_t a = 0; a < 3; a++) {
    double cell = length[a] / (double)n[a], play = fmax(0, cell - 2 * r);
    x[a] = (double)at[a] * cell + r + play * tdm_random(p->seed, LAYERS + layer, 4 * c + a);
  }
  return dem_flatten(m, tdm_pose_point(p->frame, tdm_add(p->low, tdm_v3(x[0], x[1], x[2]))), m->flat_at);
}

/* a particle in every free cell; when fewer are to come than there are cells, in some of them (Knuth, algorithm S) */
static tdm_status make_layer(dem_data *d, const dem_pouring *p, dem_free_space *room, uint64_t layer) {
  const dem_model *m = d->model;
  bool meet = m->flat >= 0 || m->domain.repeats; /* particles of two cells can: in the plane, or by their images */
  uint64_t n[3], ncell = cells_of(p, n), end = (uint64_t)(p->first + p->count), wanted = end - d->state.ledger.created;
  for (uint64_t c = 0; c < ncell && wanted > 0; c++) {
    if (tdm_random(p->seed, LAYERS + layer, 4 * c + 3) * (double)(ncell - c) >= (double)wanted)
      continue;
    wanted--;
    double r = m->radius[d->state.ledger.created];
    tdm_vec3 x = place_in(m, p, c, n, layer, r);
    if (!dem_free_space_free(room, d, x, r))
      continue;
    if (add(d, x) || (meet && dem_free_space_add(room, d, d->state.nparticle - 1)))
      return TDM_ERR_MEMORY;
  }
  return TDM_OK;
}

static tdm_status refuse(const dem_data *d, const dem_pouring *p, tdm_error *err) {
  char path[TDM_PATH_MAX];
  snprintf(path, sizeof path, "dem.particles[%d]", p->entry);
  return tdm_fail(
      err, TDM_ERR_SCENE, path,
      "only %llu of %d particles could be poured: there was no room in the region for %g s "
      "(dem.settle.max_time), because the container is full or a wall is there; enlarge the container, move "
      "the region, or pour less",
      (unsigned long long)(d->state.ledger.created - (uint64_t)p->first), p->count, d->model->settle.max_time);
}

tdm_status dem_pour_now(dem_data *d, dem_pour *pour, double t, tdm_error *err) {
  if (dem_pour_over(d) || t < pour->next)
    return TDM_OK;
  const dem_pouring *p = present(d);
  dem_free_space room;
  tdm_vec3 low, high;
  uint64_t before = d->state.ledger.created;
  dem_unite(d, DEM_PLACES | DEM_MOTION); /* dem_drive_particles needs masses */
  world_box(p, &low, &high);
  tdm_status status = dem_free_space_open(&room, d, low, high, p->largest);
  if (!status) {
    status = make_layer(d, p, &room, pour->layer++);
    dem_free_space_close(&room);
  }
  if (status)
    return tdm_fail(err, status, NULL, "no memory for particles that are poured");
  dem_drive_particles(d, 0, d->state.nparticle);
  pour->next = t + 1.05 * fall_time(d, p); /* drag slows the fall a little */
  if (d->state.ledger.created > before)
    pour->last = t;
  return t - pour->last > d->model->settle.max_time ? refuse(d, p, err) : TDM_OK;
}
