/* Sceneries and snapshots: their memory. See view.h. */
/* SPDX-License-Identifier: MIT */
#include "protocol/view/view.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static tdm_status no_memory(tdm_error *err) {
  return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for what there is to see");
}

/* Room for n items of `size` bytes in *array; what is there is kept. */
static tdm_status make_room(void **array, size_t *capacity, size_t n, size_t size, tdm_error *err) {
  if (*array && n <= *capacity)
    return TDM_OK;
  size_t room = n + n / 2 + 16;
  void *more = realloc(*array, room * size);
  if (!more)
    return no_memory(err);
  *array = more;
  *capacity = room;
  return TDM_OK;
}

/* ---- scenery ---- */

enum { BODIES, POLYGONS, LINES, MATERIALS, EDGES };

#define APPEND(s, which, array, count, item)                                                                 \
  do {                                                                                                       \
    void *grown = (s)->array;                                                                                \
    if (make_room(&grown, &(s)->capacity[which], (size_t)(s)->count + 1, sizeof *(s)->array, err) != TDM_OK) \
      return err ? err->status : TDM_ERR_MEMORY;                                                             \
    (s)->array = grown;                                                                                      \
    (s)->array[(s)->count++] = (item);                                                                       \
  } while (0)

tdm_status tdm_scenery_add_body(tdm_scenery *s, const tdm_view_body *body, tdm_error *err) {
  APPEND(s, BODIES, body, nbody, *body);
  return TDM_OK;
}

tdm_status tdm_scenery_add_polygon(tdm_scenery *s, const tdm_view_polygon *polygon, tdm_error *err) {
  APPEND(s, POLYGONS, polygon, npolygon, *polygon);
  return TDM_OK;
}

tdm_status tdm_scenery_add_line(tdm_scenery *s, const char *name, tdm_view_line_kind kind, tdm_error *err) {
  tdm_view_line line = {.kind = kind};
  snprintf(line.name, sizeof line.name, "%s", name);
  tdm_utf8_clean(line.name);
  APPEND(s, LINES, line, nline, line);
  return TDM_OK;
}

tdm_status tdm_scenery_add_material(tdm_scenery *s, const char *name, tdm_error *err) {
  tdm_view_material material = {0};
  snprintf(material.name, sizeof material.name, "%s", name);
  tdm_utf8_clean(material.name);
  APPEND(s, MATERIALS, material, nmaterial, material);
  return TDM_OK;
}

tdm_status tdm_scenery_add_edge(tdm_scenery *s, double radius, tdm_error *err) {
  APPEND(s, EDGES, edge, nedge, radius);
  return TDM_OK;
}

void tdm_scenery_clear(tdm_scenery *s) {
  s->nbody = s->npolygon = s->nline = s->nmaterial = s->nedge = 0;
  s->gravity = (tdm_vec3){0, 0, 0};
}

void tdm_scenery_free(tdm_scenery *s) {
  free(s->body);
  free(s->polygon);
  free(s->line);
  free(s->material);
  free(s->edge);
  *s = (tdm_scenery){0};
}

/* ---- snapshot ---- */

enum { POSES, ENDS, POINTS, FORCES, PARTICLES, ORIENTATIONS, CONTACTS, RANGES };

#define GROW(s, which, array, n)                                                                  \
  do {                                                                                            \
    void *grown = (s)->array;                                                                     \
    if (make_room(&grown, &(s)->capacity[which], (size_t)(n), sizeof *(s)->array, err) != TDM_OK) \
      return err ? err->status : TDM_ERR_MEMORY;                                                  \
    (s)->array = grown;                                                                           \
  } while (0)

/* Every array of the particles, which share one capacity. */
static tdm_status resize_particles(tdm_snapshot *s, int n, tdm_error *err) {
  size_t old = s->capacity[PARTICLES], room = old;
#define X(type, name, numbers, unit, text)    \
  s->capacity[PARTICLES] = s->name ? old : 0; \
  GROW(s, PARTICLES, name, n);                \
  room = s->capacity[PARTICLES];
  TDM_VIEW_PARTICLE_LIST(X)
#undef X
  s->capacity[PARTICLES] = room;
  return TDM_OK;
}

tdm_status tdm_snapshot_resize(tdm_snapshot *s, int nbody, int nline, int nforce, int nparticle, tdm_error *err) {
  s->nbody = s->nline = s->npoint = s->nforce = s->nparticle = s->norientation = s->ncontact = 0;
  s->oriented = false;
  tdm_snapshot_share(s, 0);
  GROW(s, POSES, pose, nbody);
  GROW(s, ENDS, line_end, nline);
  GROW(s, FORCES, force_on, nforce);
  if (resize_particles(s, nparticle, err) != TDM_OK) {
    tdm_snapshot_free(s); /* arrays of unlike length are of no use */
    return err ? err->status : TDM_ERR_MEMORY;
  }
  s->nbody = nbody;
  s->nline = nline;
  s->nforce = nforce;
  s->nparticle = s->nall = nparticle;
  return tdm_snapshot_add_range(s, 0, nparticle, err);
}

void tdm_snapshot_share(tdm_snapshot *s, int nall) {
  s->nall = nall;
  s->nrange = 0;
}

tdm_status tdm_snapshot_add_range(tdm_snapshot *s, int first, int count, tdm_error *err) {
  tdm_view_range *last = s->nrange > 0 ? &s->range[s->nrange - 1] : NULL;
  if (last && last->first + last->count == first)
    last->count += count;
  else
    APPEND(s, RANGES, range, nrange, ((tdm_view_range){first, count}));
  return TDM_OK;
}

tdm_status tdm_snapshot_orient(tdm_snapshot *s, tdm_error *err) {
  GROW(s, ORIENTATIONS, orientation, s->nparticle);
  s->oriented = true;
  s->norientation = s->nparticle;
  return TDM_OK;
}

tdm_status tdm_snapshot_add_point(tdm_snapshot *s, tdm_vec3 point, tdm_error *err) {
  GROW(s, POINTS, point, s->npoint + 1);
  s->point[s->npoint++] = point;
  return TDM_OK;
}

void tdm_snapshot_end_line(tdm_snapshot *s, int k) {
  s->line_end[k] = s->npoint;
}

tdm_status tdm_snapshot_add_contact(tdm_snapshot *s, const tdm_view_contact *contact, tdm_error *err) {
  APPEND(s, CONTACTS, contact, ncontact, *contact);
  return TDM_OK;
}

void tdm_snapshot_free(tdm_snapshot *s) {
  free(s->pose);
  free(s->line_end);
  free(s->point);
  free(s->force_on);
  free(s->orientation);
  free(s->contact);
  free(s->range);
#define X(type, name, n, unit, text) free(s->name);
  TDM_VIEW_PARTICLE_LIST(X)
#undef X
  *s = (tdm_snapshot){0};
}

tdm_status tdm_snapshot_check(const tdm_snapshot *s, const tdm_scenery *scenery, tdm_error *err) {
  if (s->nbody != scenery->nbody || s->nline != scenery->nline || (s->nforce != 0 && s->nforce != scenery->npolygon))
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL,
                    "a snapshot has %d bodies, %d lines and %d forces on polygons, the scenery %d, %d and %d", s->nbody,
                    s->nline, s->nforce, scenery->nbody, scenery->nline, scenery->npolygon);
  return TDM_OK;
}
