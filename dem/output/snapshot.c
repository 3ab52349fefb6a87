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

tdm_status dem_snapshot_take(dem_snapshot *s, const dem_data *d, tdm_error *err) {
  if (!make_room(s, d->nparticle)) {
    dem_snapshot_free(s);
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d particles", d->nparticle);
  }
  s->count = d->nparticle;
  for (int i = 0; i < s->count; i++) {
    s->id[i] = (int64_t)d->id[i];
    s->material[i] = d->kind[i];
    s->radius[i] = d->radius[i];
    s->position[i] = d->position[i];
    s->velocity[i] = d->velocity[i];
    s->spin[i] = d->spin[i];
  }
  return TDM_OK;
}

static void include(dem_bounds *b, tdm_vec3 x, double margin) {
  b->low = tdm_v3(fmin(b->low.x, x.x - margin), fmin(b->low.y, x.y - margin), fmin(b->low.z, x.z - margin));
  b->high = tdm_v3(fmax(b->high.x, x.x + margin), fmax(b->high.y, x.y + margin), fmax(b->high.z, x.z + margin));
}

/* a box of edges 2 half around `center`, both in the axes of `pose` */
static void include_box(dem_bounds *b, const tdm_pose *pose, tdm_vec3 center, tdm_vec3 half) {
  for (int k = 0; k < 8; k++)
    include(b,
            tdm_pose_point(*pose, tdm_add(center, tdm_v3(k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y,
                                                         k & 4 ? half.z : -half.z))),
            0);
}

dem_bounds dem_scene_bounds(const dem_data *d, const dem_snapshot *s) {
  const dem_model *m = d->model;
  dem_bounds b = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (int i = 0; i < s->count; i++)
    include(&b, s->position[i], s->radius[i]);
  for (int k = 0; k < m->nbox; k++)
    include_box(&b, &d->pose[m->box[k].body], m->box[k].center, m->box[k].half);
  for (int w = 0; w < m->nwall; w++)
    if (m->wall[w].primitive == DEM_SOLID_BOX)
      include_box(&b, &d->pose[m->wall[w].body], m->wall[w].point, m->wall[w].half);
  for (int k = 0; k < m->nsource; k++) {
    include(&b, m->source[k].low, m->source[k].radius[1]);
    include(&b, m->source[k].high, m->source[k].radius[1]);
  }
  if (!(b.low.x <= b.high.x))
    b = (dem_bounds){{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};
  return b;
}
