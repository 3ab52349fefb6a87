/* The particles at one instant, as outputs need them: see snapshot.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/output/snapshot.h"

#include <stdlib.h>

void dem_snapshot_free(dem_snapshot *s) {
  void *arrays[] = {s->id, s->material, s->radius, s->position, s->velocity, s->spin};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    free(arrays[i]);
  *s = (dem_snapshot){0};
}

static bool make_room(dem_snapshot *s, int n) {
  if (s->id && n <= s->capacity)
    return true;
  dem_snapshot_free(s);
  size_t room = (size_t)n + (size_t)n / 8 + 1;
  s->id = malloc(room * sizeof *s->id);
  s->material = malloc(room * sizeof *s->material);
  s->radius = malloc(room * sizeof *s->radius);
  s->position = malloc(room * sizeof *s->position);
  s->velocity = malloc(room * sizeof *s->velocity);
  s->spin = malloc(room * sizeof *s->spin);
  s->capacity = (int)room;
  return s->id && s->material && s->radius && s->position && s->velocity && s->spin;
}

typedef struct {
  uint64_t id;
  int particle;
} rank;

static int by_id(const void *a, const void *b) {
  const rank *x = a, *y = b;
  return (x->id > y->id) - (x->id < y->id);
}

/* The particles in the order of their ids, whatever the order in which the engine keeps them; NULL: no memory. */
static rank *rank_particles(const dem_data *d) {
  rank *order = malloc(((size_t)d->state.nparticle + 1) * sizeof *order);
  bool ascending = true;
  for (int i = 0; order && i < d->state.nparticle; i++) {
    order[i] = (rank){d->state.id[i], i};
    ascending = ascending && (i == 0 || d->state.id[i] > d->state.id[i - 1]);
  }
  if (order && !ascending)
    qsort(order, (size_t)d->state.nparticle, sizeof *order, by_id);
  return order;
}

tdm_status dem_snapshot_take(dem_snapshot *s, const dem_data *d, tdm_error *err) {
  rank *order = rank_particles(d);
  if (!order || !make_room(s, d->state.nparticle)) {
    free(order);
    dem_snapshot_free(s);
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d particles", d->state.nparticle);
  }
  s->count = d->state.nparticle;
  for (int k = 0; k < s->count; k++) {
    int i = order[k].particle;
    s->id[k] = (int64_t)d->state.id[i];
    s->material[k] = d->state.material[i];
    s->radius[k] = d->state.sphere[i].radius;
    s->position[k] = d->state.sphere[i].position;
    s->velocity[k] = d->state.pace[i].velocity;
    s->spin[k] = d->state.pace[i].spin;
  }
  free(order);
  return TDM_OK;
}

dem_bounds dem_scene_bounds(const dem_data *d, const dem_snapshot *s) {
  const dem_model *m = d->model;
  dem_bounds b = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (int i = 0; i < s->count; i++)
    dem_bounds_add(&b, s->position[i], s->radius[i]);
  for (int k = 0; k < m->nbox; k++)
    dem_bounds_add_box(&b, dem_frame_at(&d->state.pose[m->box[k].body], m->box[k].center, m->box[k].turn),
                       m->box[k].half);
  for (int w = 0; w < m->nwall; w++)
    dem_wall_bounds(&m->wall[w], &d->state.pose[m->wall[w].body], &b);
  for (int k = 0; k < m->nsource; k++) {
    dem_bounds_add(&b, m->source[k].low, m->source[k].sizes.max);
    dem_bounds_add(&b, m->source[k].high, m->source[k].sizes.max);
  }
  if (!(b.low.x <= b.high.x))
    b = (dem_bounds){{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};
  return b;
}
