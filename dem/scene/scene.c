/* The section "dem": see scene.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/scene/scene.h"

#include "dem/base/ranks.h"
#include "dem/geometry/shape/shape.h"
#include "dem/model/integrator.h"
#include "dem/scene/contact.h"
#include "dem/scene/keys.h"
#include "dem/search/search.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *choose(tdm_object *o, const char *key, const char *const *names, int fallback) {
  int n = 0;
  while (names[n])
    n++;
  int i = tdm_get_choice(o, key, names, n, fallback);
  return names[i < 0 ? 0 : i];
}

static void read_rotation(dem_model *m, tdm_object *section) {
  m->unturned = !tdm_get_bool(section, "rotation", true);
  m->driven = m->driven || m->unturned;
  if (m->unturned && m->oriented)
    tdm_object_fail(section, "orientation", "is for particles that turn; remove it, or \"rotation\": false");
}

/* after the laws */
static void check_rotation(const dem_model *m, tdm_object *section) {
  if (m->unturned && m->couples)
    tdm_object_fail(section, "rotation",
                    "is false, but contact.rolling or contact.twisting resists rotation; set them "
                    "to \"none\"");
}

/* after the particles, which may have forces of their own */
static void read_integrator(dem_model *m, tdm_object *section) {
  m->integrator = dem_integrator_find(m->simd, choose(section, "integrator", dem_integrator_names, 0), m->driven);
  m->remembers = m->integrator->remember != NULL;
  m->settler = dem_integrator_find(m->simd, dem_integrator_names[0], m->driven);
  if (m->integrator->keeps != DEM_KEEPS_FAST_FORCES) {
    if (tdm_has(section, "multi_step"))
      tdm_object_fail(section, "multi_step", "is for \"integrator\": \"multi-step\" only; remove it");
    return;
  }
  tdm_object o = tdm_get_object(section, "multi_step", true);
  m->multi_step.substeps = tdm_get_integer(&o, "substeps", TDM_REQUIRED_INT, 1);
  m->multi_step.mass = tdm_get_number(&o, "mass", TDM_REQUIRED, TDM_POSITIVE);
  tdm_object_close(&o);
}

/* the search, and the skin, which may be the search's own */
static void read_search(dem_model *m, tdm_object *section) {
  const char *names[16] = {"auto"};
  for (int k = 0; dem_search_names[k]; k++)
    names[k + 1] = dem_search_names[k];
  const char *name = choose(section, "search", names, 0);
  dem_search *search = name != names[0] ? dem_search_create(name) : NULL;
  m->search = search ? name : NULL;
  if (search)
    m->skin = dem_search_skin(search, m->skin, m->largest_radius);
  dem_search_destroy(&search);
}

/* ---- bodies ---- */

/* tie the assignment's coupled bodies to bodies of the scene */
static void couple_bodies(dem_model *m, const tdm_assignment *assignment, tdm_error *err) {
  m->coupled_body = dem_allocate((size_t)assignment->nbody, sizeof *m->coupled_body, err);
  for (int i = 0; i < assignment->nbody && !err->status; i++) {
    const tdm_assigned_body *assigned = &assignment->body[i];
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "coupling.bodies[%d].dem", i);
    int b = dem_find_body(m, assigned->name);
    if (b < 0) {
      dem_fail_unknown_body(m, path, assigned->name, err);
      return;
    }
    dem_body *body = &m->body[b];
    if (body->coupled >= 0)
      tdm_fail(err, TDM_ERR_SCENE, path, "\"%s\" is coupled already by coupling.bodies[%d]; couple each body once",
               assigned->name, body->coupled);
    if (!(assigned->mass > 0))
      tdm_fail(err, TDM_ERR_SCENE, path, "the mass of \"%s\" is %g kg but must be greater than 0", assigned->name,
               assigned->mass);
    body->coupled = i;
    body->mass = assigned->mass;
    body->start = assigned->state;
    body->start.pose.orientation = tdm_quat_unit(body->start.pose.orientation);
    m->coupled_body[m->ncoupled++] = b;
  }
}

/* what the other solver says of a coupled body; NULL: it is not coupled */
static const tdm_assigned_body *coupled_as(const tdm_assignment *assignment, const char *name) {
  for (int i = 0; i < assignment->nbody; i++)
    if (strcmp(assignment->body[i].name, name) == 0)
      return &assignment->body[i];
  return NULL;
}

enum { NAME_LENGTH = 40 }; /* so that "body.NAME.shape99.fx" is a channel's name */

/* a body's name, which becomes part of channel names */
static const char *read_body_name(tdm_object *o) {
  const char *name = tdm_get_string(o, "name", NULL);
  size_t n = strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-");
  if (!o->err->status && (n == 0 || name[n] != 0 || n > NAME_LENGTH))
    tdm_object_fail(o, "name",
                    "\"%s\" must be 1 to %d letters, digits, '_' and '-': it becomes part of column names in the "
                    "results; rename it",
                    name, NAME_LENGTH);
  return name;
}

/* entry `number` of a body's shapes, whose walls are the last ones from `first` on */
static void append_geometry(dem_model *m, int body, int number, int first, int nwall, tdm_error *err) {
  dem_geometry *grown = realloc(m->geometry, (size_t)(m->ngeometry + 1) * sizeof *grown);
  if (!grown) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for geometry %d", m->ngeometry);
    return;
  }
  m->geometry = grown;
  m->geometry[m->ngeometry++] = (dem_geometry){body, number, first, nwall};
}

static void read_body(dem_model *m, tdm_object *o, const tdm_assignment *assignment, dem_wall_list *walls) {
  const char *name = read_body_name(o);
  int same = dem_find_body(m, name), index = m->nbody++;
  if (same >= 0)
    tdm_object_fail(o, "name", "\"%s\" is the name of dem.bodies[%d] already; give each body its own", name, same);
  dem_body *body = &m->body[index];
  body->name = dem_copy_text(name, o->err);
  body->material = dem_read_material(m, o);
  body->coupled = -1;
  body->mass = INFINITY;

  const tdm_assigned_body *coupled = coupled_as(assignment, name);
  static const char *const placing[] = {"position", "orientation", "motion"};
  for (int k = 0; k < 3; k++)
    if (tdm_has(o, placing[k]) && coupled)
      tdm_object_fail(o, placing[k],
                      "\"%s\" is coupled, so its pose and motion come from the body it is coupled to; remove this key, "
                      "and place or move the body there",
                      name);
  body->start.pose.position = tdm_get_vec3(o, "position", &(tdm_vec3){0, 0, 0});
  body->start.pose.orientation = tdm_get_orientation(o, "orientation");
  body->drive = dem_drive_read(o, &body->start.pose);
  m->ndriven += body->drive.given;

  walls->body_material = body->material;
  walls->part = (dem_part){coupled, coupled ? coupled->state.pose : body->start.pose};
  walls->part.start.orientation = tdm_quat_unit(walls->part.start.orientation);
  json_t *shapes = tdm_get_array(o, "shapes", true);
  for (size_t k = 0; k < json_array_size(shapes) && !o->err->status; k++) {
    char path[TDM_PATH_MAX];
    int first = walls->count;
    dem_shape_read(json_array_get(shapes, k), tdm_path(path, o, "shapes", (int)k), index, m->ngeometry, walls, o->err);
    append_geometry(m, index, (int)k, first, walls->count - first, o->err);
  }
}

static void read_bodies(dem_model *m, json_t *array, const tdm_assignment *assignment, tdm_error *err) {
  size_t n = json_array_size(array);
  m->body = dem_allocate(n, sizeof *m->body, err);
  const char **materials = dem_allocate((size_t)m->nmaterial, sizeof *materials, err);
  for (int k = 0; materials && k < m->nmaterial; k++)
    materials[k] = m->material[k].name;
  dem_wall_list walls = {.material = materials, .nmaterial = m->nmaterial};
  for (size_t i = 0; i < n && !err->status; i++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.bodies[%zu]", i);
    tdm_object o = tdm_object_open(json_array_get(array, i), path, err);
    read_body(m, &o, assignment, &walls);
    tdm_object_close(&o);
  }
  free(materials);
  m->wall = walls.wall;
  m->nwall = walls.count;
  m->box = walls.box;
  m->nbox = walls.nbox;
  if (!err->status)
    couple_bodies(m, assignment, err);
}

/* ---- loads for outputs ---- */

/* which triangles each mesh has among those of all */
static void number_triangles(dem_model *m, tdm_object *section) {
  m->first_triangle = dem_allocate((size_t)m->nwall, sizeof *m->first_triangle, section->err);
  for (int w = 0; w < m->nwall && !section->err->status; w++) {
    m->first_triangle[w] = m->ntriangle;
    m->ntriangle += m->wall[w].shape->parts ? m->wall[w].shape->parts(&m->wall[w]) : 0;
  }
  if (m->ntriangle == 0 && !section->err->status)
    tdm_object_fail(section, "triangle_forces", "there is no mesh in dem.bodies; remove the key, or add a mesh");
}

static void read_loads(dem_model *m, tdm_object *section) {
  m->geometry_loads = tdm_get_bool(section, "geometry_loads", false);
  m->triangle_forces = tdm_get_bool(section, "triangle_forces", false);
  m->nload = m->nbody + (m->geometry_loads ? m->ngeometry : 0);
  if (m->triangle_forces)
    number_triangles(m, section);
}

/* ---- settling ---- */

/* 1 m without particles */
static double mean_radius(const dem_model *m) {
  double sum = 0;
  for (int i = 0; i < m->nparticle; i++)
    sum += m->radius[i];
  return m->nparticle ? sum / m->nparticle : 1;
}

/* every source counts as one particle, so that a scene without particles has one too */
static double mean_radius_ahead(const dem_model *m) {
  double sum = 0;
  for (int i = 0; i < m->nparticle; i++)
    sum += m->radius[i];
  for (int s = 0; s < m->nsource; s++)
    sum += dem_sizes_mean(&m->source[s].sizes);
  int n = m->nparticle + m->nsource;
  return n ? sum / n : 1;
}

static double largest_radius(const dem_model *m) {
  double largest = 0;
  for (int i = 0; i < m->nparticle; i++)
    largest = fmax(largest, m->radius[i]);
  for (int s = 0; s < m->nsource; s++)
    largest = fmax(largest, m->source[s].sizes.max);
  return largest;
}

static void read_settle(dem_model *m, tdm_object *section) {
  m->settle.wanted = tdm_has(section, "settle");
  tdm_object o = tdm_get_object(section, "settle", false);
  dem_settle_pairs_read(m, &o);
  m->settle.speed = tdm_get_number(&o, "speed", 1e-3, TDM_POSITIVE);
  m->settle.max_time = tdm_get_number(&o, "max_time", 10, TDM_POSITIVE);
  m->settle.dt = tdm_get_number(&o, "dt", 0, tdm_has(&o, "dt") ? TDM_POSITIVE : TDM_ANY);
  /* a fifth of the rate at which a particle falls by its size: a short fall is not felt, rolling ends */
  m->settle.drag =
      tdm_get_number(&o, "drag", 0.2 * sqrt(tdm_norm(m->gravity) / (2 * mean_radius(m))), TDM_NOT_NEGATIVE);
  const char *store = tdm_has(&o, "store") ? tdm_get_string(&o, "store", NULL) : NULL;
  if (store && !store[0])
    tdm_object_fail(&o, "store", "is empty; give the file that keeps the settled bed, or remove the key");
  m->settle.store = store ? dem_copy_text(store, o.err) : NULL;
  tdm_object_close(&o);
}

static void read_guard(dem_model *m, tdm_object *section) {
  static const char *const actions[] = {"warn", "stop"};
  tdm_object o = tdm_get_object(section, "guard", false);
  m->guard.every = tdm_get_integer(&o, "every", 100, 0);
  m->guard.overlap = tdm_get_number(&o, "overlap", 0.3, TDM_POSITIVE);
  m->guard.energy = tdm_get_number(&o, "energy", 0.5, TDM_POSITIVE);
  m->guard.chosen = tdm_has(&o, "action");
  m->guard.action = (dem_guard_action)tdm_get_choice(&o, "action", actions, 2, DEM_GUARD_WARN);
  tdm_object_close(&o);
}

static void read_decomposition(dem_model *m, tdm_object *section) {
  static const char *const orders[] = {"curve", "slices"}, *const axes[] = {"x", "y", "z"};
  tdm_object o = tdm_get_object(section, "decomposition", false);
  const bool slices = tdm_get_choice(&o, "order", orders, 2, 0) == 1, has_axis = tdm_has(&o, "axis");
  const int axis = tdm_get_choice(&o, "axis", axes, 3, 0);
  if (has_axis && !slices)
    tdm_object_fail(&o, "axis", "is that of \"order\" \"slices\"; give the order, or remove the axis");
  m->slices = slices ? 1 + axis : 0;
  const bool balanced = tdm_has(&o, "balance");
  tdm_object b = tdm_get_object(&o, "balance", false);
  const long every = tdm_get_integer(&b, "every", 500, 1);
  m->balance = (dem_balance_def){.every = balanced ? every : 0,
                                 .tolerance = tdm_get_number(&b, "tolerance", 0.05, TDM_POSITIVE)};
  tdm_object_close(&b);
  tdm_object_close(&o);
}

/* Is more needed of how particles start than what becomes of it on the rank whose home they are? What a stored state is
 * of is all of them. */
static bool needs_all(const tdm_object *section) {
  return json_object_get(section->json, "start") || json_object_get(json_object_get(section->json, "settle"), "store");
}

static void read_model(dem_model *m, const tdm_assignment *assignment, const dem_ranks *ranks, tdm_error *err) {
  m->dt = assignment->dt;
  m->time_start = assignment->time_start;
  m->proxy = assignment->proxy;
  m->time_end = assignment->time_end;
  m->interpolation = assignment->interpolation;

  tdm_object o = tdm_object_open(assignment->scene, "dem", err);
  m->gravity = dem_read_vector(&o, "gravity", &(tdm_vec3){0, 0, -9.81});
  dem_contact_read(m, &o);
  m->energy = tdm_get_bool(&o, "energy", false);
  dem_materials_read(m, tdm_get_array(&o, "materials", true), err);
  dem_read_dimension(m, &o);
  json_t *pairs = tdm_get_array(&o, "pairs", false);
  if (!err->status)
    dem_pairs_read(m, pairs, err);
  json_t *bodies = tdm_get_array(&o, "bodies", false);
  if (!err->status)
    read_bodies(m, bodies, assignment, err);
  read_loads(m, &o);
  m->oriented = tdm_get_bool(&o, "orientation", false);
  read_rotation(m, &o);
  json_t *particles = tdm_get_array(&o, "particles", false);
  if (!err->status)
    dem_fill_read(m, particles, ranks && !needs_all(&o) ? ranks : NULL, err);
  read_integrator(m, &o);
  json_t *sources = tdm_get_array(&o, "sources", false), *sinks = tdm_get_array(&o, "sinks", false);
  if (!err->status)
    dem_sources_read(m, sources, err);
  if (!err->status)
    dem_sinks_read(m, sinks, err);
  m->largest_radius = largest_radius(m);
  json_t *containers = tdm_get_array(&o, "containers", false);
  if (!err->status)
    dem_containers_read(m, containers, err);
  dem_screening_read(m, &o);
  json_t *paths = tdm_get_array(&o, "paths", false);
  if (!err->status)
    dem_traces_read(m, paths, err);
  if (!err->status)
    dem_pairs_check(m, err);
  if (!err->status)
    read_settle(m, &o);
  if (!err->status)
    dem_contact_finish(m, err);
  if (!err->status)
    check_rotation(m, &o);
  tdm_has(&o, "settle");
  if (m->npouring > 0 && !m->settle.wanted)
    tdm_object_fail(&o, "settle", "missing: dem.particles[%d] is poured while settling; give \"settle\" {}",
                    m->pouring[0].entry);
  m->mean_radius = mean_radius_ahead(m);
  m->skin = tdm_get_number(&o, "skin", 0, tdm_has(&o, "skin") ? TDM_POSITIVE : TDM_ANY);
  read_search(m, &o);
  m->threads = (int)tdm_get_integer(&o, "threads", 1, 1);
  if (m->threads > 1024)
    tdm_object_fail(&o, "threads", "is %d but must be at most 1024; as many as the machine has cores are enough",
                    m->threads);
  m->ranks = tdm_has(&o, "ranks") ? (int)tdm_get_integer(&o, "ranks", 1, 1) : 0;
  if (m->ranks > DEM_RANKS_MAX)
    tdm_object_fail(&o, "ranks", "is %d but must be at most %d", m->ranks, DEM_RANKS_MAX);
  read_decomposition(m, &o);
  dem_domain_read(m, &o);
  if (!err->status)
    dem_domain_check(m, m->largest_radius, err);
  read_guard(m, &o);
  const char *start = tdm_has(&o, "start") ? tdm_get_string(&o, "start", NULL) : NULL;
  m->start = start ? dem_copy_text(start, err) : NULL;
  if (m->start && m->settle.store)
    tdm_object_fail(&o, "start", "excludes dem.settle.store, which would keep a bed of other particles; remove one");
  if (m->start && m->npouring > 0)
    tdm_object_fail(&o, "start", "brings the particles with it, but dem.particles[%d] is poured; remove one",
                    m->pouring[0].entry);
  bool has_speed = tdm_has(&o, "expected_speed");
  m->expected_speed = tdm_get_number(&o, "expected_speed", 0, has_speed ? TDM_POSITIVE : TDM_ANY);
  tdm_object_close(&o);
}

tdm_status dem_model_read(dem_model **model, const tdm_assignment *assignment, tdm_error *err) {
  return dem_model_read_on(model, assignment, NULL, err);
}

tdm_status dem_model_read_on(dem_model **model, const tdm_assignment *assignment, const dem_ranks *ranks,
                             tdm_error *err) {
  tdm_error own = {0}; /* so that err may be NULL */
  if (!err)
    err = &own;
  *model = calloc(1, sizeof **model);
  if (!*model)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the DEM model");
  read_model(*model, assignment, ranks, err);
  return err->status;
}
