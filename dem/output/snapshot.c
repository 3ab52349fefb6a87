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
  rank *order = malloc(((size_t)d->nparticle + 1) * sizeof *order);
  bool ascending = true;
  for (int i = 0; order && i < d->nparticle; i++) {
    order[i] = (rank){d->id[i], i};
    ascending = ascending && (i == 0 || d->id[i] > d->id[i - 1]);
  }
  if (order && !ascending)
    qsort(order, (size_t)d->nparticle, sizeof *order, by_id);
  return order;
}

tdm_status dem_snapshot_take(dem_snapshot *s, const dem_data *d, tdm_error *err) {
  rank *order = rank_particles(d);
  if (!order || !make_room(s, d->nparticle)) {
    free(order);
    dem_snapshot_free(s);
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d particles", d->nparticle);
  }
  s->count = d->nparticle;
  for (int k = 0; k < s->count; k++) {
    int i = order[k].particle;
    s->id[k] = (int64_t)d->id[i];
    s->material[k] = d->kind[i];
    s->radius[k] = d->sphere[i].radius;
    s->position[k] = d->sphere[i].position;
    s->velocity[k] = d->pace[i].velocity;
    s->spin[k] = d->pace[i].spin;
  }
  free(order);
  return TDM_OK;
}

static void include(dem_bounds *b, tdm_vec3 x, double margin) {
  b->low = tdm_v3(fmin(b->low.x, x.x - margin), fmin(b->low.y, x.y - margin), fmin(b->low.z, x.z - margin));
  b->high = tdm_v3(fmax(b->high.x, x.x + margin), fmax(b->high.y, x.y + margin), fmax(b->high.z, x.z + margin));
}

/* a box of edges 2 half around `center`, in axes that `frame` turns and moves to the world's */
static void include_box(dem_bounds *b, tdm_pose frame, tdm_vec3 half) {
  for (int k = 0; k < 8; k++) {
    tdm_vec3 corner = tdm_v3(k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z);
    include(b, tdm_pose_point(frame, corner), 0);
  }
}

/* the frame of a shape at `point` with `turn` on a body */
static tdm_pose frame_of(const tdm_pose *body, tdm_vec3 point, tdm_quat turn) {
  bool turned = turn.w != 0 || turn.x != 0 || turn.y != 0 || turn.z != 0;
  return (tdm_pose){tdm_pose_point(*body, point), turned ? tdm_quat_mul(body->orientation, turn) : body->orientation};
}

/* walls that end; planes have no size */
static void include_wall(dem_bounds *b, const dem_wall *w, const tdm_pose *pose) {
  tdm_pose frame = frame_of(pose, w->point, w->turn);
  double r = fmax(w->radius[0], w->radius[1]);
  if (w->primitive == DEM_SOLID_BOX)
    include_box(b, frame, w->half);
  else if (w->primitive == DEM_BALL)
    include(b, frame.position, r);
  else if (w->primitive == DEM_CYLINDER)
    include_box(b, frame, tdm_v3(r, r, 0));
  else if (w->primitive == DEM_SHELL || w->primitive == DEM_SOLID_FRUSTUM)
    include_box(b, frame_of(&frame, tdm_v3(0, 0, 0.5 * w->length), (tdm_quat){0}), tdm_v3(r, r, 0.5 * w->length));
  else if (w->primitive == DEM_MESH) {
    const dem_mesh_report *mesh = dem_mesh_figures(w->mesh);
    tdm_vec3 middle = tdm_scale(0.5, tdm_add(mesh->low, mesh->high));
    include_box(b, frame_of(pose, middle, (tdm_quat){0}), tdm_scale(0.5, tdm_sub(mesh->high, mesh->low)));
  }
}

dem_bounds dem_scene_bounds(const dem_data *d, const dem_snapshot *s) {
  const dem_model *m = d->model;
  dem_bounds b = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (int i = 0; i < s->count; i++)
    include(&b, s->position[i], s->radius[i]);
  for (int k = 0; k < m->nbox; k++)
    include_box(&b, frame_of(&d->pose[m->box[k].body], m->box[k].center, m->box[k].turn), m->box[k].half);
  for (int w = 0; w < m->nwall; w++)
    include_wall(&b, &m->wall[w], &d->pose[m->wall[w].body]);
  for (int k = 0; k < m->nsource; k++) {
    include(&b, m->source[k].low, m->source[k].sizes.max);
    include(&b, m->source[k].high, m->source[k].sizes.max);
  }
  if (!(b.low.x <= b.high.x))
    b = (dem_bounds){{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};
  return b;
}
