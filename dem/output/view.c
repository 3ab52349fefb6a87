/* What there is to see of the engine: see view.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/output/view.h"

#include "dem/exchange/transfer.h"
#include "dem/output/contacts.h"
#include "dem/seam/homes.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

_Static_assert((int)DEM_CORNERS_MAX <= (int)TDM_VIEW_CORNERS_MAX, "a wall's polygons fit into a scenery");

/* ---- scenery ---- */

dem_bounds dem_fixed_bounds(const dem_data *d) {
  const dem_model *m = d->model;
  dem_bounds b = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (int k = 0; k < m->nbox; k++)
    dem_bounds_add_box(&b, dem_frame_at(&d->state.pose[m->box[k].body], m->box[k].center, m->box[k].turn),
                       m->box[k].half);
  for (int w = 0; w < m->nwall; w++)
    dem_wall_bounds(&m->wall[w], &d->state.pose[m->wall[w].body], &b);
  for (int k = 0; k < m->nsource; k++) {
    dem_bounds_add(&b, m->source[k].low, m->source[k].sizes.max);
    dem_bounds_add(&b, m->source[k].high, m->source[k].sizes.max);
  }
  return b;
}

dem_bounds dem_scene_bounds(const dem_data *d) {
  dem_bounds b = dem_fixed_bounds(d);
  for (int i = dem_home_first_particle(d); i < dem_home_end_particle(d); i++)
    dem_bounds_add(&b, d->state.sphere[i].position, d->state.sphere[i].radius);
  double most[6] = {b.high.x, b.high.y, b.high.z, -b.low.x, -b.low.y, -b.low.z};
  dem_homes_largest_of(d, most, 6);
  if (!(-most[3] <= most[0]))
    return (dem_bounds){{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};
  return (dem_bounds){{-most[3], -most[4], -most[5]}, {most[0], most[1], most[2]}};
}

/* What is drawn of a wall, in the axes of its body. A wall without end is cut to its container, or to the bounds. */
static tdm_status draw_wall(const dem_data *d, int w, const dem_bounds *bounds, dem_polygons *all, tdm_error *err) {
  const dem_model *m = d->model;
  const dem_wall *wall = &m->wall[w];
  const bool ends = dem_wall_ends(wall);
  const tdm_pose body_axes = {.orientation = {1, 0, 0, 0}}, *pose = ends ? &body_axes : &d->state.pose[wall->body];
  const dem_wall_place place = ends ? dem_wall_put(wall, pose) : d->state.wall[w];
  const dem_wall_view view = {
      .place = &place, .pose = pose, .bounds = bounds, .box = m->box, .nbox = m->nbox, .lid = d->state.lid[w]};
  const int first = all->count;
  if (wall->shape->polygons)
    wall->shape->polygons(wall, &view, all, err);
  const tdm_quat back = tdm_quat_conj(pose->orientation);
  for (int k = first; k < all->count && !ends; k++)
    for (int c = 0; c < all->polygon[k].ncorner; c++) {
      tdm_vec3 *x = &all->polygon[k].corner[c];
      *x = tdm_quat_rotate(back, tdm_sub(*x, pose->position));
    }
  return err->status;
}

tdm_status dem_polygons_make(dem_polygons *all, const dem_data *d, const dem_bounds *bounds, tdm_error *err) {
  all->count = 0;
  for (int w = 0; w < d->model->nwall; w++) {
    const int first = all->count;
    if (draw_wall(d, w, bounds, all, err) != TDM_OK)
      return err->status;
    for (int k = first; k < all->count; k++)
      all->polygon[k].wall = w;
  }
  return TDM_OK;
}

/* The triangle, or other part of a wall, that each polygon shows. */
static tdm_status number_triangles(dem_view *v, const dem_model *m, const dem_polygons *all, tdm_error *err) {
  int *triangle = realloc(v->triangle, ((size_t)all->count + 1) * sizeof *triangle);
  if (!triangle)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d walls", all->count);
  v->triangle = triangle;
  for (int k = 0; k < all->count; k++) {
    const dem_polygon *p = &all->polygon[k];
    const dem_wall *wall = &m->wall[p->wall];
    assert(!wall->shape->parts || p->part < wall->shape->parts(wall));
    triangle[k] = wall->shape->parts && p->part >= 0 ? m->first_triangle[p->wall] + p->part : -1;
  }
  return TDM_OK;
}

static tdm_status add_polygons(const dem_polygons *all, tdm_scenery *scenery, tdm_error *err) {
  for (int k = 0; k < all->count; k++) {
    const dem_polygon *p = &all->polygon[k];
    tdm_view_polygon polygon = {.body = p->body, .solid = p->solid, .ncorner = p->ncorner};
    memcpy(polygon.corner, p->corner, (size_t)p->ncorner * sizeof *p->corner);
    if (tdm_scenery_add_polygon(scenery, &polygon, err) != TDM_OK)
      return err->status;
    scenery->body[p->body].marked = false;
  }
  return TDM_OK;
}

/* the sink whose size classes are told of: the first that has some; NULL: none */
static const dem_sink *sorting_sink(const dem_model *m) {
  for (int k = 0; k < m->nsink; k++)
    if (m->sink[k].nedge > 0)
      return &m->sink[k];
  return NULL;
}

static tdm_status add_names(const dem_model *m, tdm_scenery *scenery, tdm_error *err) {
  for (int b = 0; b < m->nbody; b++) {
    const dem_body *body = &m->body[b];
    tdm_view_body out = {
        .dem = true, .mbd = body->coupled >= 0, .still = body->coupled < 0 && !body->drive.given, .marked = true};
    snprintf(out.name, sizeof out.name, "%s", body->name);
    tdm_utf8_clean(out.name);
    if (tdm_scenery_add_body(scenery, &out, err) != TDM_OK)
      return err->status;
  }
  for (int k = 0; k < m->nmaterial; k++)
    if (tdm_scenery_add_material(scenery, m->material[k].name, err) != TDM_OK)
      return err->status;
  const dem_sink *sink = sorting_sink(m);
  for (int k = 0; sink && k < sink->nedge; k++)
    if (tdm_scenery_add_edge(scenery, sink->edge[k], err) != TDM_OK)
      return err->status;
  return TDM_OK;
}

/* Planes without end that lie beside all the rest, but no farther away than that is wide: a floor onto which particles
 * will fall is to be seen. */
static void add_planes(dem_bounds *b, const dem_data *d) {
  const tdm_vec3 middle = tdm_scale(0.5, tdm_add(b->low, b->high));
  const double wide = tdm_norm(tdm_sub(b->high, b->low));
  for (int w = 0; w < d->model->nwall; w++) {
    const dem_wall_place *at = &d->state.wall[w];
    const double away = tdm_dot(tdm_sub(middle, at->point), at->normal);
    if (!dem_wall_ends(&d->model->wall[w]) && fabs(away) <= wide)
      dem_bounds_add(b, tdm_axpy(-away, at->normal, middle), 1e-3 * wide);
  }
}

static tdm_status make_scenery(dem_view *v, const dem_data *d, const dem_bounds *bounds, tdm_scenery *scenery,
                               tdm_error *err) {
  dem_polygons all = {0};
  tdm_scenery_clear(scenery);
  scenery->gravity = d->model->gravity;
  if (add_names(d->model, scenery, err) == TDM_OK && dem_polygons_make(&all, d, bounds, err) == TDM_OK &&
      (d->model->ntriangle == 0 || number_triangles(v, d->model, &all, err) == TDM_OK))
    add_polygons(&all, scenery, err);
  v->npolygon = scenery->npolygon;
  dem_polygons_free(&all);
  return err->status;
}

tdm_status dem_view_scenery(dem_view *v, const dem_data *d, tdm_scenery *scenery, tdm_error *err) {
  dem_bounds bounds = dem_scene_bounds(d);
  add_planes(&bounds, d);
  v->looks = true;
  if (dem_homes_writes(d) && make_scenery(v, d, &bounds, scenery, err) != TDM_OK)
    return err->status;
  return dem_view_watch(v, d, err);
}

/* ---- who keeps what of particles ----
 *
 * Blocks of ids go round the ranks: of a particle whose id is in a block, that rank remembers the first place, and
 * writes what there is to see. So a snapshot in the order of the ids has a few ranges of particles from each rank. */

enum { BLOCK = 2048 };

static uint64_t rank_count(const dem_data *d) {
  return dem_alone(d) ? 1 : (uint64_t)d->work.homes.ranks->size;
}

static int keeper(const dem_data *d, uint64_t id) {
  return (int)(id / BLOCK % rank_count(d));
}

/* number of an id among those that its keeper has */
static size_t kept_at(const dem_data *d, uint64_t id) {
  return (size_t)(id / BLOCK / rank_count(d) * BLOCK + id % BLOCK);
}

/* Where each home particle from id `least` on goes; NULL: no memory. */
static int *keepers(const dem_data *d, uint64_t least) {
  const int first = dem_home_first_particle(d), end = dem_home_end_particle(d);
  int *rank = malloc(((size_t)(end - first) + 1) * sizeof *rank);
  for (int i = first; rank && i < end; i++)
    rank[i - first] = d->state.id[i] >= least ? keeper(d, d->state.id[i]) : -1;
  return rank;
}

static tdm_status no_memory(const dem_data *d, tdm_error *err) {
  return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d particles", d->state.nparticle);
}

/* ---- first places ---- */

static tdm_status reserve_born(dem_view *v, const dem_data *d, uint64_t all, tdm_error *err) {
  const size_t need = (size_t)(all / (BLOCK * rank_count(d)) + 1) * BLOCK;
  if (need <= v->capacity)
    return TDM_OK;
  const size_t room = v->nborn > 0 ? 2 * need : need;
  tdm_vec3 *born = realloc(v->born, room * sizeof *born);
  if (!born)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the first places of %llu particles",
                    (unsigned long long)all);
  v->born = born;
  v->capacity = room;
  return TDM_OK;
}

tdm_status dem_view_watch(dem_view *v, const dem_data *d, tdm_error *err) {
  const uint64_t all = d->state.ledger.created; /* ids are given in the order of creation */
  if (!v->looks || all <= v->nborn)
    return TDM_OK;
  dem_transfer t = {0};
  int *rank = keepers(d, v->nborn);
  uint64_t *id = NULL;
  tdm_vec3 *place = NULL;
  tdm_status status = rank ? reserve_born(v, d, all, err) : TDM_ERR_MEMORY;
  if (!status)
    status = dem_transfer_open(&t, d->work.homes.ranks, dem_home_first_particle(d),
                               dem_home_end_particle(d) - dem_home_first_particle(d), rank);
  if (!status) {
    id = malloc((t.nin + 1) * sizeof *id);
    place = malloc((t.nin + 1) * sizeof *place);
    for (size_t k = 0; k < t.nin; k++)
      t.to[k] = (int)k;
    status = id && place ? dem_transfer_fetch(&t, d->state.id, sizeof *id, id) : TDM_ERR_MEMORY;
  }
  if (!status)
    status = dem_transfer_pick(&t, &d->state.sphere[0].position, sizeof *d->state.sphere, sizeof *place, place);
  for (size_t k = 0; !status && k < t.nin; k++)
    v->born[kept_at(d, id[k])] = place[k];
  v->nborn = all;
  dem_transfer_close(&t);
  free(rank);
  free(id);
  free(place);
  return status ? no_memory(d, err) : TDM_OK;
}

/* ---- particles in the order of their ids ---- */

typedef struct {
  uint64_t id;
  int arrival;
} numbered;

static int by_id(const void *a, const void *b) {
  const numbered *x = a, *y = b;
  return (x->id > y->id) - (x->id < y->id);
}

/* The things of a transfer come to places in the order of their ids, of which `id` is the array. */
static tdm_status sort(dem_transfer *t, const void *id) {
  uint64_t *came = malloc((t->nin + 1) * sizeof *came);
  numbered *order = malloc((t->nin + 1) * sizeof *order);
  tdm_status status = came && order ? dem_transfer_fetch(t, id, sizeof *came, came) : TDM_ERR_MEMORY;
  bool ascending = true;
  for (size_t k = 0; !status && k < t->nin; k++) {
    order[k] = (numbered){came[k], (int)k};
    ascending = ascending && (k == 0 || came[k] > came[k - 1]);
  }
  if (!status && !ascending)
    qsort(order, t->nin, sizeof *order, by_id);
  for (size_t k = 0; !status && k < t->nin; k++)
    t->to[order[k].arrival] = (int)k;
  free(came);
  free(order);
  return status;
}

/* Which of all particles those of the share are, from how many there are in each block. */
static tdm_status find_ranges(const dem_data *d, tdm_snapshot *s, tdm_error *err) {
  const size_t nblock = (size_t)(d->state.ledger.created / BLOCK + 1);
  double *count = calloc(nblock, sizeof *count);
  if (!count)
    return no_memory(d, err);
  for (int k = 0; k < s->nparticle; k++)
    count[s->id[k] / BLOCK]++;
  if (!dem_alone(d))
    d->work.homes.ranks->sum(count, (int)nblock);
  tdm_snapshot_share(s, d->state.nparticle);
  int first = 0;
  for (size_t b = 0, k = 0; b < nblock && !err->status; first += (int)count[b++])
    if (k < (size_t)s->nparticle && (size_t)s->id[k] / BLOCK == b) {
      tdm_snapshot_add_range(s, first, (int)count[b], err);
      k += (size_t)count[b];
    }
  free(count);
  return err->status;
}

static int size_class(const dem_sink *sink, double radius) {
  int k = 0;
  while (sink && k < sink->nedge && radius >= sink->edge[k])
    k++;
  return sink ? k : -1;
}

/* What the share has of particles that came from their homes by the transfer. */
static tdm_status fetch_particles(const dem_view *v, const dem_data *d, const dem_transfer *t, tdm_snapshot *s) {
  const dem_sink *sink = sorting_sink(d->model);
  tdm_vec3 *spare = d->state.spare_push ? malloc((t->nin + 1) * sizeof *spare) : NULL;
  tdm_status status = d->state.spare_push && !spare ? TDM_ERR_MEMORY : TDM_OK;
#define PICK(array, member, result) \
  status = status ? status : dem_transfer_pick(t, &(member), sizeof *(array), sizeof(member), result)
  PICK(d->state.id, *d->state.id, s->id);
  PICK(d->state.material, *d->state.material, s->material);
  PICK(d->state.sphere, d->state.sphere->radius, s->radius);
  PICK(d->state.sphere, d->state.sphere->position, s->position);
  PICK(d->state.pace, d->state.pace->velocity, s->velocity);
  PICK(d->state.pace, d->state.pace->spin, s->spin);
  PICK(d->state.push, d->state.push->force, s->force);
  if (spare)
    PICK(d->state.spare_push, d->state.spare_push->force, spare);
  if (s->oriented)
    PICK(d->state.orientation, *d->state.orientation, s->orientation);
#undef PICK
  for (int k = 0; !status && k < s->nparticle; k++) {
    s->size_class[k] = size_class(sink, s->radius[k]);
    s->born[k] = v->born[kept_at(d, (uint64_t)s->id[k])];
    if (spare)
      s->force[k] = tdm_add(s->force[k], spare[k]);
  }
  free(spare);
  return status;
}

/* polygons whose forces are known, on the rank that made the scenery */
static int forces_known(const dem_view *v, const dem_data *d) {
  return v->triangle && d->work.traction.force ? v->npolygon : 0;
}

/* The particles that this rank keeps. */
static tdm_status share_particles(dem_view *v, const dem_data *d, tdm_snapshot *s, tdm_error *err) {
  dem_transfer t = {0};
  int *rank = keepers(d, 0);
  tdm_status status = rank ? dem_transfer_open(&t, d->work.homes.ranks, dem_home_first_particle(d),
                                               dem_home_end_particle(d) - dem_home_first_particle(d), rank)
                           : TDM_ERR_MEMORY;
  free(rank);
  if (!status)
    status = sort(&t, d->state.id);
  if (!status)
    status = tdm_snapshot_resize(s, d->model->nbody, 0, forces_known(v, d), (int)t.nin, err);
  if (!status && d->model->oriented)
    status = tdm_snapshot_orient(s, err);
  if (!status)
    status = fetch_particles(v, d, &t, s);
  dem_transfer_close(&t);
  return status ? no_memory(d, err) : find_ranges(d, s, err);
}

/* All particles on rank 0, from the shares of all. */
static tdm_status join_particles(const dem_data *d, const tdm_snapshot *share, tdm_snapshot *s, tdm_error *err) {
  dem_transfer t = {0};
  int *first = calloc((size_t)share->nparticle + 1, sizeof *first);
  tdm_status status = first ? dem_transfer_open(&t, d->work.homes.ranks, 0, share->nparticle, first) : TDM_ERR_MEMORY;
  free(first);
  if (!status)
    status = sort(&t, share->id);
  if (!status)
    status = tdm_snapshot_resize(s, share->nbody, 0, share->nforce, (int)t.nin, err);
  if (!status && share->oriented)
    status = tdm_snapshot_orient(s, err);
#define X(type, name, n, unit, text) \
  status = status ? status : dem_transfer_pick(&t, share->name, sizeof(type), sizeof(type), s->name);
  TDM_VIEW_PARTICLE_LIST(X)
#undef X
  if (!status && s->oriented)
    status = dem_transfer_pick(&t, share->orientation, sizeof(tdm_quat), sizeof(tdm_quat), s->orientation);
  dem_transfer_close(&t);
  return status ? no_memory(d, err) : TDM_OK;
}

/* ---- snapshot ---- */

/* What a snapshot has besides particles. */
static tdm_status take_rest(const dem_view *v, const dem_data *d, double t, tdm_snapshot *s, tdm_error *err) {
  s->time = t;
  memcpy(s->pose, d->state.pose, (size_t)d->model->nbody * sizeof *s->pose);
  for (int k = 0; k < s->nforce; k++)
    s->force_on[k] = v->triangle[k] >= 0 ? d->work.traction.force[v->triangle[k]] : (tdm_vec3){NAN, NAN, NAN};
  return s->with_contacts && dem_homes_writes(d) ? dem_contacts_look(d, s, err) : TDM_OK;
}

tdm_status dem_view_share(dem_view *v, const dem_data *d, double t, tdm_snapshot *s, tdm_error *err) {
  v->looks = true;
  if (dem_view_watch(v, d, err) != TDM_OK || share_particles(v, d, s, err) != TDM_OK)
    return err->status;
  return take_rest(v, d, t, s, err);
}

tdm_status dem_view_snapshot(dem_view *v, const dem_data *d, double t, tdm_snapshot *s, tdm_error *err) {
  if (dem_alone(d))
    return dem_view_share(v, d, t, s, err);
  tdm_snapshot share = {0};
  v->looks = true;
  if (dem_view_watch(v, d, err) == TDM_OK && share_particles(v, d, &share, err) == TDM_OK &&
      join_particles(d, &share, s, err) == TDM_OK)
    take_rest(v, d, t, s, err);
  tdm_snapshot_free(&share);
  return err->status;
}

void dem_view_free(dem_view *v) {
  free(v->triangle);
  free(v->born);
  *v = (dem_view){0};
}
