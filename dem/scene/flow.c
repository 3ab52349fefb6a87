/* Reading dem.sources, dem.sinks and dem.containers: see docs/scene.md for their keys. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/base/sphere.h"
#include "dem/scene/keys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { NAME_MAX_LENGTH = 40 }; /* so that "source.NAME.waiting" is a channel's name */

static void refuse_same(tdm_object *o, const char *name, int same, const char *array) {
  if (same >= 0)
    tdm_object_fail(o, "name", "\"%s\" is the name of %s[%d] already; give each its own", name, array, same);
}

/* {"min", "max"} with min <= max */
static void read_region(tdm_object *o, tdm_vec3 *low, tdm_vec3 *high) {
  *low = tdm_get_vec3(o, "min", NULL);
  *high = tdm_get_vec3(o, "max", NULL);
  if (!o->err->status && !(high->x >= low->x && high->y >= low->y && high->z >= low->z))
    tdm_object_fail(o, "max", "must not be smaller than min in x, y or z");
}

/* ---- sources ---- */

static void read_rate(const dem_model *m, tdm_object *o, dem_source *s) {
  bool by_number = tdm_has(o, "rate"), by_mass = tdm_has(o, "mass_rate");
  s->rate = tdm_get_number(o, "rate", 0, by_number ? TDM_POSITIVE : TDM_ANY);
  s->mass_rate = tdm_get_number(o, "mass_rate", 0, by_mass ? TDM_POSITIVE : TDM_ANY);
  if (by_number && by_mass)
    tdm_object_fail(o, "mass_rate", "excludes \"rate\"; give particles per second or kg per second");
  if (!by_number && !by_mass)
    tdm_object_fail(o, "rate", "missing; give \"rate\" [1/s] or \"mass_rate\" [kg/s]");
  /* equal masses: exact multiples of 1/rate */
  if (by_mass && (s->mass > 0 || s->sizes.min == s->sizes.max)) {
    s->rate = s->mass_rate / (s->mass > 0 ? s->mass : dem_sphere_mass(m->material[s->material].density, s->sizes.min));
    s->mass_rate = 0;
  }
}

/* Particles that are due are counted one by one. */
static void check_rate(const dem_model *m, tdm_object *o, const dem_source *s) {
  const double most = 1e6; /* a step */
  double mass = s->mass > 0 ? s->mass : dem_sphere_mass(m->material[s->material].density, s->sizes.min);
  double a_step = m->dt * (s->mass_rate > 0 ? s->mass_rate / mass : s->rate);
  if (!o->err->status && !(a_step <= most))
    tdm_object_fail(o, tdm_has(o, "rate") ? "rate" : "mass_rate",
                    "makes %.3g particles in a step of %g s; give a rate of at most %g a step: no region has room for "
                    "more",
                    a_step, m->dt, most);
}

static void read_place(tdm_object *o, dem_source *s) {
  bool point = tdm_has(o, "position"), region = tdm_has(o, "region");
  if (point == region) {
    tdm_object_fail(o, point ? "region" : "position",
                    point ? "excludes \"position\"; give a point or a region"
                          : "missing; give \"position\" [x, y, z] or \"region\" {\"min\", \"max\"}");
    return;
  }
  if (point) {
    s->low = s->high = tdm_get_vec3(o, "position", NULL);
    return;
  }
  tdm_object r = tdm_get_object(o, "region", true);
  read_region(&r, &s->low, &s->high);
  tdm_object_close(&r);
}

static void read_relative(const dem_model *m, tdm_object *o, dem_source *s) {
  s->relative = -1;
  s->factor = 1;
  if (!tdm_has(o, "relative_to"))
    return;
  tdm_object r = tdm_get_object(o, "relative_to", true);
  s->relative = dem_read_body(m, &r, "body");
  s->factor = tdm_get_number(&r, "factor", 1, TDM_ANY);
  tdm_object_close(&r);
}

static void read_source(dem_model *m, tdm_object *o) {
  dem_source *s = &m->source[m->nsource];
  s->name = dem_read_name(o, NAME_MAX_LENGTH);
  int same = -1;
  for (int k = 0; k < m->nsource; k++)
    if (s->name && strcmp(m->source[k].name, s->name) == 0)
      same = k;
  m->nsource++;
  refuse_same(o, s->name, same, "dem.sources");
  s->material = dem_read_material(m, o);
  dem_sizes_read(o, &s->sizes);
  s->mass = tdm_get_number(o, "mass", 0, tdm_has(o, "mass") ? TDM_POSITIVE : TDM_ANY);
  dem_check_mass(o, s->mass > 0 ? "mass" : "radius",
                 s->mass > 0 ? s->mass : dem_sphere_mass(m->material[s->material].density, s->sizes.min));
  dem_check_mass(o, s->mass > 0 ? "mass" : "radius",
                 s->mass > 0 ? s->mass : dem_sphere_mass(m->material[s->material].density, s->sizes.max));
  read_place(o, s);
  s->velocity = dem_read_vector(o, "velocity", &(tdm_vec3){0, 0, 0});
  if (m->flat >= 0 && (&s->velocity.x)[m->flat] != 0)
    tdm_object_fail(o, "velocity", "moves out of the plane of dem.plane; with dem.dimension 2 give one in it");
  read_relative(m, o, s);
  s->start = tdm_get_number(o, "start", m->time_start, TDM_ANY);
  s->end = tdm_get_number(o, "end", INFINITY, TDM_ANY);
  if (s->end <= s->start)
    tdm_object_fail(o, "end", "is %g s but must be after start, %g s", s->end, s->start);
  s->count = tdm_has(o, "count") ? (uint64_t)tdm_get_integer(o, "count", TDM_REQUIRED_INT, 0) : UINT64_MAX;
  s->total_mass = tdm_has(o, "total_mass") ? tdm_get_number(o, "total_mass", TDM_REQUIRED, TDM_POSITIVE) : INFINITY;
  s->seed = (uint64_t)tdm_get_integer(o, "seed", 1, 0);
  if (!o->err->status)
    read_rate(m, o, s);
  check_rate(m, o, s);
  dem_check_place(o, tdm_has(o, "position") ? "position" : "region", s->low, s->sizes.max);
  dem_check_place(o, tdm_has(o, "position") ? "position" : "region", s->high, s->sizes.max);
  tdm_object_close(o);
}

void dem_sources_read(dem_model *m, json_t *sources, tdm_error *err) {
  size_t n = json_array_size(sources);
  m->source = calloc(n + 1, sizeof *m->source);
  if (!m->source)
    tdm_fail(err, TDM_ERR_MEMORY, "dem.sources", "no memory");
  for (size_t i = 0; i < n && !err->status; i++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.sources[%zu]", i);
    tdm_object o = tdm_object_open(json_array_get(sources, i), path, err);
    read_source(m, &o);
  }
}

/* ---- sinks ---- */

/* edges of the size classes, ascending radii */
static void read_classes(tdm_object *o, dem_sink *s) {
  if (!tdm_has(o, "classes"))
    return;
  json_t *edges = tdm_get_array(o, "classes", true);
  size_t n = json_array_size(edges);
  if (!o->err->status && (n == 0 || n > DEM_EDGES_MAX))
    tdm_object_fail(o, "classes", "has %zu radii; give 1 to %d, the edges between the classes", n, DEM_EDGES_MAX);
  for (size_t k = 0; k < n && !o->err->status; k++) {
    json_t *value = json_array_get(edges, k);
    double r = json_number_value(value), least = k > 0 ? s->edge[k - 1] : 0;
    char path[TDM_PATH_MAX];
    if (!json_is_number(value) || !(r > least))
      tdm_fail(o->err, TDM_ERR_SCENE, tdm_path(path, o, "classes", (int)k), "must be a radius greater than %g m",
               least);
    else
      s->edge[s->nedge++] = r;
  }
}

/* a direction of a sink's place, made a unit vector; `what` it is for */
static tdm_vec3 read_direction(tdm_object *o, const char *key, const tdm_vec3 *fallback, const char *what) {
  const tdm_vec3 v = dem_read_vector(o, key, fallback);
  if (!o->err->status && tdm_norm(v) < 1e-9)
    tdm_object_fail(o, key, "is the zero vector; give the direction %s", what);
  return tdm_unit(v);
}

/* [from, to] with from < to, by at most `widest` */
static void read_range(tdm_object *o, const char *key, double widest, double out[2]) {
  tdm_get_numbers(o, key, out, 2, true);
  if (!o->err->status && !(out[1] > out[0]))
    tdm_object_fail(o, key, "goes from %g to %g; give [from, to] with the smaller first", out[0], out[1]);
  if (!o->err->status && !(out[1] - out[0] <= widest))
    tdm_object_fail(o, key, "is wider than a turn: from %g to %g rad; give at most 2 pi", out[0], out[1]);
}

/* Part of a ring. Angles count from the x axis of the sink's frame, seen along the axis; where the axis is x, from y.
 */
static void read_sector(tdm_object *o, dem_sink *s) {
  s->point = dem_read_vector(o, "point", &(tdm_vec3){0, 0, 0});
  s->normal = read_direction(o, "axis", &(tdm_vec3){0, 0, 1}, "of the ring's axis");
  s->across = dem_zero_angle(s->normal);
  read_range(o, "radii", INFINITY, s->radius);
  if (!o->err->status && s->radius[0] < 0)
    tdm_object_fail(o, "radii", "begin at %g m; a radius is not negative", s->radius[0]);
  read_range(o, "height", INFINITY, s->height);
  s->angle[0] = -M_PI;
  s->angle[1] = M_PI;
  if (tdm_has(o, "angle"))
    read_range(o, "angle", 2 * M_PI * (1 + 1e-12), s->angle);
  if (!o->err->status && !(fabs(s->angle[0]) <= 4 * M_PI))
    tdm_object_fail(o, "angle", "begins at %g rad; give angles between two turns back and two on", s->angle[0]);
}

static void read_sink(dem_model *m, tdm_object *o) {
  static const char *const types[] = {"after_contact", "box", "plane", "sector"};
  dem_sink *s = &m->sink[m->nsink];
  s->name = dem_read_name(o, NAME_MAX_LENGTH);
  int same = -1;
  for (int k = 0; k < m->nsink; k++)
    if (s->name && strcmp(m->sink[k].name, s->name) == 0)
      same = k;
  m->nsink++;
  refuse_same(o, s->name, same, "dem.sinks");
  int type = tdm_get_choice(o, "type", types, 4, -1);
  if (type < 0)
    return;
  s->type = (dem_sink_type)type;
  s->frame = -1;
  if (s->type == DEM_SINK_AFTER_CONTACT)
    s->body = dem_read_body(m, o, "body");
  else if (tdm_has(o, "body"))
    s->frame = dem_read_body(m, o, "body");
  if (s->type == DEM_SINK_BOX)
    read_region(o, &s->low, &s->high);
  if (s->type == DEM_SINK_PLANE) {
    s->point = tdm_get_vec3(o, "point", NULL);
    s->normal = read_direction(o, "normal", NULL, "from the plane towards the side that stays");
  }
  if (s->type == DEM_SINK_SECTOR)
    read_sector(o, s);
  read_classes(o, s);
  tdm_object_close(o);
}

void dem_sinks_read(dem_model *m, json_t *sinks, tdm_error *err) {
  size_t n = json_array_size(sinks);
  if (n > DEM_SINKS_MAX) {
    tdm_fail(err, TDM_ERR_SCENE, "dem.sinks", "has %zu entries; at most %d are supported", n, DEM_SINKS_MAX);
    return;
  }
  m->sink = calloc(n + 1, sizeof *m->sink);
  if (!m->sink)
    tdm_fail(err, TDM_ERR_MEMORY, "dem.sinks", "no memory");
  for (size_t i = 0; i < n && !err->status; i++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.sinks[%zu]", i);
    tdm_object o = tdm_object_open(json_array_get(sinks, i), path, err);
    read_sink(m, &o);
  }
}

/* ---- containers ---- */

static void read_container(dem_model *m, tdm_object *o) {
  dem_container *c = &m->container[m->ncontainer];
  c->name = dem_read_name(o, NAME_MAX_LENGTH);
  int same = -1;
  for (int k = 0; k < m->ncontainer; k++)
    if (c->name && strcmp(m->container[k].name, c->name) == 0)
      same = k;
  m->ncontainer++;
  refuse_same(o, c->name, same, "dem.containers");
  c->frame = tdm_has(o, "body") ? dem_read_body(m, o, "body") : -1;
  read_region(o, &c->low, &c->high);
  c->jam_time = tdm_get_number(o, "jam_time", 1, TDM_POSITIVE);
  c->jam_start = tdm_get_number(o, "jam_start", INFINITY, TDM_ANY);
  tdm_object_close(o);
}

void dem_containers_read(dem_model *m, json_t *containers, tdm_error *err) {
  size_t n = json_array_size(containers);
  if (n > DEM_CONTAINERS_MAX) {
    tdm_fail(err, TDM_ERR_SCENE, "dem.containers", "has %zu entries; at most %d are supported", n, DEM_CONTAINERS_MAX);
    return;
  }
  m->container = dem_allocate(n, sizeof *m->container, err);
  for (size_t i = 0; i < n && !err->status; i++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.containers[%zu]", i);
    tdm_object o = tdm_object_open(json_array_get(containers, i), path, err);
    read_container(m, &o);
  }
}
