/* What there is to see of the engine: see view.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/output/view.h"

#include "dem/output/contacts.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

_Static_assert((int)DEM_CORNERS_MAX <= (int)TDM_VIEW_CORNERS_MAX, "a wall's polygons fit into a scenery");

/* ---- scenery ---- */

dem_bounds dem_scene_bounds(const dem_data *d) {
  const dem_model *m = d->model;
  dem_bounds b = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (int i = 0; i < d->state.nparticle; i++)
    dem_bounds_add(&b, d->state.sphere[i].position, d->state.sphere[i].radius);
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

tdm_status dem_view_scenery(dem_view *v, const dem_data *d, tdm_scenery *scenery, tdm_error *err) {
  dem_polygons all = {0};
  dem_bounds bounds = dem_scene_bounds(d);
  add_planes(&bounds, d);
  v->looks = true;
  tdm_scenery_clear(scenery);
  scenery->gravity = d->model->gravity;
  if (add_names(d->model, scenery, err) == TDM_OK && dem_polygons_make(&all, d, &bounds, err) == TDM_OK &&
      (d->model->ntriangle == 0 || number_triangles(v, d->model, &all, err) == TDM_OK))
    add_polygons(&all, scenery, err);
  v->npolygon = scenery->npolygon;
  dem_polygons_free(&all);
  return err->status != TDM_OK ? err->status : dem_view_watch(v, d, err);
}

/* ---- snapshot ---- */

tdm_status dem_view_watch(dem_view *v, const dem_data *d, tdm_error *err) {
  const uint64_t all = d->state.ledger.created; /* ids are given in the order of creation */
  if (!v->looks || all <= v->nborn)
    return TDM_OK;
  if ((size_t)all > v->capacity) {
    size_t room = 2 * (size_t)all;
    tdm_vec3 *born = realloc(v->born, room * sizeof *born);
    if (!born)
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the first places of %llu particles",
                      (unsigned long long)all);
    v->born = born;
    v->capacity = room;
  }
  for (int i = 0; i < d->state.nparticle; i++)
    if (d->state.id[i] >= v->nborn)
      v->born[d->state.id[i]] = d->state.sphere[i].position;
  v->nborn = all;
  return TDM_OK;
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

static int size_class(const dem_sink *sink, double radius) {
  int k = 0;
  while (sink && k < sink->nedge && radius >= sink->edge[k])
    k++;
  return sink ? k : -1;
}

static tdm_vec3 contact_force(const dem_data *d, int i) {
  const tdm_vec3 force = d->state.push[i].force;
  return d->state.spare_push ? tdm_add(force, d->state.spare_push[i].force) : force;
}

static void take_particles(const dem_view *v, const dem_data *d, const rank *order, tdm_snapshot *s) {
  const dem_sink *sink = sorting_sink(d->model);
  for (int k = 0; k < s->nparticle; k++) {
    int i = order[k].particle;
    s->id[k] = (int64_t)d->state.id[i];
    s->material[k] = d->state.material[i];
    s->radius[k] = d->state.sphere[i].radius;
    s->size_class[k] = size_class(sink, s->radius[k]);
    s->position[k] = d->state.sphere[i].position;
    s->velocity[k] = d->state.pace[i].velocity;
    s->spin[k] = d->state.pace[i].spin;
    s->force[k] = contact_force(d, i);
    s->born[k] = v->born[d->state.id[i]];
    if (s->norientation > 0)
      s->orientation[k] = d->state.orientation[i];
  }
}

static void take_forces(const dem_view *v, const dem_data *d, tdm_snapshot *s) {
  for (int k = 0; k < s->nforce; k++)
    s->force_on[k] = v->triangle[k] >= 0 ? d->work.traction.force[v->triangle[k]] : (tdm_vec3){NAN, NAN, NAN};
}

tdm_status dem_view_snapshot(dem_view *v, const dem_data *d, double t, tdm_snapshot *s, tdm_error *err) {
  v->looks = true;
  const int nforce = v->triangle && d->work.traction.force ? v->npolygon : 0;
  if (dem_view_watch(v, d, err) != TDM_OK ||
      tdm_snapshot_resize(s, d->model->nbody, 0, nforce, d->state.nparticle, err) != TDM_OK)
    return err->status;
  rank *order = rank_particles(d);
  if (!order)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d particles", d->state.nparticle);
  if (d->model->oriented && tdm_snapshot_orient(s, err) != TDM_OK) {
    free(order);
    return err->status;
  }
  s->time = t;
  memcpy(s->pose, d->state.pose, (size_t)d->model->nbody * sizeof *s->pose);
  take_particles(v, d, order, s);
  take_forces(v, d, s);
  free(order);
  return s->with_contacts ? dem_contacts_look(d, s, err) : TDM_OK;
}

void dem_view_free(dem_view *v) {
  free(v->triangle);
  free(v->born);
  *v = (dem_view){0};
}
