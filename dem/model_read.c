/* Reading the scene section "dem": see README.md for its keys. */
#include "dem/model_read.h"

#include "dem/contact/restitution.h"
#include "dem/fill.h"
#include "dem/integrate.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *allocate(size_t n, size_t size, tdm_error *err) {
  void *p = calloc(n ? n : 1, size);
  if (!p)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %zu items of the DEM model", n);
  return p;
}

/* ---- materials and pairs ---- */

static void read_materials(dem_model *m, json_t *array, tdm_error *err) {
  size_t n = json_array_size(array);
  m->material = allocate(n, sizeof *m->material, err);
  for (size_t i = 0; i < n && !err->status; i++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.materials[%zu]", i);
    tdm_object o = tdm_object_open(json_array_get(array, i), path, err);
    const char *name = tdm_get_string(&o, "name", NULL);
    int same = dem_find_material(m, name);
    if (same >= 0)
      tdm_object_fail(&o, "name", "\"%s\" is the name of dem.materials[%d] already; give each material its own", name,
                      same);
    dem_material *material = &m->material[m->nmaterial++];
    material->name = strdup(name);
    material->density = tdm_get_number(&o, "density", TDM_REQUIRED, TDM_POSITIVE);
    material->young = tdm_get_number(&o, "young_modulus", TDM_REQUIRED, TDM_POSITIVE);
    material->poisson = tdm_get_number(&o, "poisson_ratio", TDM_REQUIRED, TDM_NOT_NEGATIVE);
    if (material->poisson >= 0.5)
      tdm_object_fail(&o, "poisson_ratio", "is %g but must be less than 0.5", material->poisson);
    material->shear = material->young / (2 * (1 + material->poisson));
    tdm_object_close(&o);
  }
}

int dem_read_material(const dem_model *m, tdm_object *o) {
  const char *name = tdm_get_string(o, "material", NULL);
  int i = dem_find_material(m, name);
  if (i >= 0 || o->err->status)
    return i >= 0 ? i : 0;
  const char *names[64];
  int n = 0;
  for (; n < m->nmaterial && n < 64; n++)
    names[n] = m->material[n].name;
  const char *near = tdm_nearest(name, names, n);
  tdm_object_fail(o, "material", "\"%s\" is no material of dem.materials; %s%s%s", name,
                  near ? "did you mean \"" : "add it there or use one of them", near ? near : "", near ? "\"?" : "");
  return 0;
}

/* damping of a pair from its restitution */
static void set_damping(dem_pair *pair, bool clip, tdm_error *err, const char *path) {
  double beta = 0;
  if (!clip)
    beta = dem_beta_keep(pair->restitution);
  else if (!dem_beta_clip(pair->restitution, &beta))
    tdm_fail(err, TDM_ERR_SCENE, path, "is %g, too small for \"tail\": \"clip\"; give at least 0.001",
             pair->restitution);
  pair->floor = clip ? 0 : -INFINITY;
  pair->normal_damping = 2 * sqrt(5.0 / 6) * beta;
  pair->tangential_damping = pair->normal_damping * sqrt(8 * pair->shear / (2 * pair->young));
}

static double read_restitution(tdm_object *o, double fallback) {
  double e = tdm_get_number(o, "restitution", fallback, TDM_UNIT_INTERVAL);
  if (e <= 0)
    tdm_object_fail(o, "restitution",
                    "is 0 but must be greater than 0 and at most 1; a small value such as 0.01 "
                    "takes nearly all the energy");
  return e > 0 ? e : 1;
}

/* the two materials of a pair; false after an error */
static bool read_pair_names(const dem_model *m, tdm_object *o, int which[2]) {
  json_t *names = tdm_get_array(o, "materials", true);
  if (!o->err->status && json_array_size(names) != 2)
    tdm_object_fail(o, "materials", "has %zu entries but a pair needs two material names", json_array_size(names));
  for (int k = 0; k < 2 && !o->err->status; k++) {
    const char *name = json_string_value(json_array_get(names, (size_t)k));
    which[k] = name ? dem_find_material(m, name) : -1;
    char path[TDM_PATH_MAX];
    if (which[k] < 0)
      tdm_fail(o->err, TDM_ERR_SCENE, tdm_path(path, o, "materials", k), "\"%s\" is no material of dem.materials",
               name ? name : "(not a string)");
  }
  return !o->err->status;
}

static void read_pairs(dem_model *m, json_t *array, tdm_error *err) {
  size_t n = (size_t)m->nmaterial;
  m->pair = allocate(n * n, sizeof *m->pair, err);
  m->settle_pair = allocate(n * n, sizeof *m->settle_pair, err);
  for (size_t i = 0; i < json_array_size(array) && !err->status; i++) {
    char path[TDM_PATH_MAX], place[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.pairs[%zu]", i);
    tdm_object o = tdm_object_open(json_array_get(array, i), path, err);
    int which[2] = {0, 0};
    if (!read_pair_names(m, &o, which))
      return;
    const dem_material *a = &m->material[which[0]], *b = &m->material[which[1]];
    dem_pair pair = {.given = true};
    pair.restitution = read_restitution(&o, TDM_REQUIRED);
    pair.friction = tdm_get_number(&o, "friction", TDM_REQUIRED, TDM_NOT_NEGATIVE);
    pair.young = 1 / ((1 - a->poisson * a->poisson) / a->young + (1 - b->poisson * b->poisson) / b->young);
    pair.shear = 1 / ((2 - a->poisson) / a->shear + (2 - b->poisson) / b->shear);
    if (m->pair[(size_t)which[0] * n + (size_t)which[1]].given)
      tdm_object_fail(&o, NULL, "the pair \"%s\", \"%s\" is given twice; remove one", a->name, b->name);
    set_damping(&pair, m->clip, err, tdm_path(place, &o, "restitution", -1));
    m->pair[(size_t)which[0] * n + (size_t)which[1]] = pair;
    m->pair[(size_t)which[1] * n + (size_t)which[0]] = pair;
    tdm_object_close(&o);
  }
}

/* every pair that can meet must be given */
static void check_pairs(const dem_model *m, tdm_error *err) {
  int *many = allocate((size_t)m->nmaterial, sizeof *many, err); /* particles of a material */
  for (int i = 0; many && i < m->nparticle; i++)
    many[m->kind[i]]++;
  for (int s = 0; many && s < m->nsource; s++)
    many[m->source[s].kind] += m->source[s].count > 1 ? 2 : (int)m->source[s].count;
  for (int a = 0; many && a < m->nmaterial; a++)
    for (int b = a; b < m->nmaterial; b++) {
      bool meet = a == b ? many[a] > 1 : many[a] > 0 && many[b] > 0;
      for (int w = 0; w < m->nwall; w++) {
        int of_wall = m->body[m->wall[w].body].material;
        meet = meet || (of_wall == a && many[b] > 0) || (of_wall == b && many[a] > 0);
      }
      if (meet && !m->pair[a * m->nmaterial + b].given)
        tdm_fail(err, TDM_ERR_SCENE, "dem.pairs",
                 "\"%s\" and \"%s\" can touch but have no entry; add {\"materials\": [\"%s\", \"%s\"], "
                 "\"restitution\": …, \"friction\": …}",
                 m->material[a].name, m->material[b].name, m->material[a].name, m->material[b].name);
    }
  free(many);
}

/* ---- contact laws ---- */

static const char *choose(tdm_object *o, const char *key, const char *const *names, int fallback) {
  int n = 0;
  while (names[n])
    n++;
  int i = tdm_get_choice(o, key, names, n, fallback);
  return names[i < 0 ? 0 : i];
}

/* the instruction set: the best of this machine unless the scene names one */
static void read_simd(dem_model *m, tdm_object *section) {
  m->simd = tdm_has(section, "simd") ? choose(section, "simd", dem_simd_names, 0) : dem_simd_best();
  m->integrator = dem_integrator_find(m->simd);
  if (dem_law_find(m->simd, "hertz", "none"))
    return;
  tdm_object_fail(section, "simd", "this machine has no \"%s\"; remove the key, or use \"%s\"", m->simd,
                  dem_simd_best());
  m->simd = "plain";
}

static void read_contact(dem_model *m, tdm_object *section) {
  tdm_object o = tdm_get_object(section, "contact", false);
  const char *normal = choose(&o, "normal", dem_normal_names, 0);
  const char *tangential = choose(&o, "tangential", dem_tangential_names, 1);
  const char *tail = choose(&o, "tail", dem_tail_names, 0);
  m->clip = tail == dem_tail_names[1];
  m->law = dem_law_find(m->simd, normal, tangential);
  if (!m->law) {
    tdm_object_fail(&o, NULL, "the laws normal \"%s\" and tangential \"%s\" do not go together", normal, tangential);
    m->law = dem_law_find(m->simd, "hertz", "none");
  }
  if (tdm_has(&o, "wall_mass") && json_is_string(json_object_get(o.json, "wall_mass"))) {
    static const char *const body[] = {"body"};
    tdm_get_choice(&o, "wall_mass", body, 1, 0);
  } else {
    m->wall_mass = tdm_get_number(&o, "wall_mass", 0, tdm_has(&o, "wall_mass") ? TDM_POSITIVE : TDM_ANY);
  }
  tdm_object_close(&o);
}

/* ---- bodies ---- */

/* name the nearest body for a coupled name that is none */
static void unknown_body(const dem_model *m, const char *path, const char *name, tdm_error *err) {
  const char **names = allocate((size_t)m->nbody, sizeof *names, err);
  for (int b = 0; names && b < m->nbody; b++)
    names[b] = m->body[b].name;
  const char *near = names ? tdm_nearest(name, names, m->nbody) : NULL;
  if (near)
    tdm_fail(err, TDM_ERR_SCENE, path, "\"%s\" is no body of dem.bodies; did you mean \"%s\"?", name, near);
  else
    tdm_fail(err, TDM_ERR_SCENE, path, "\"%s\" is no body of dem.bodies; add it there%s%s%s", name,
             m->nbody ? " or name one of them, such as \"" : "", m->nbody ? m->body[0].name : "", m->nbody ? "\"" : "");
  free(names);
}

int dem_read_body(const dem_model *m, tdm_object *o, const char *key) {
  const char *name = tdm_get_string(o, key, NULL);
  int b = dem_find_body(m, name);
  char path[TDM_PATH_MAX];
  if (b < 0 && !o->err->status)
    unknown_body(m, tdm_path(path, o, key, -1), name, o->err);
  return b < 0 ? 0 : b;
}

/* tie the assignment's coupled bodies to bodies of the scene */
static void couple_bodies(dem_model *m, const tdm_assignment *assignment, tdm_error *err) {
  m->coupled_body = allocate((size_t)assignment->nbody, sizeof *m->coupled_body, err);
  for (int i = 0; i < assignment->nbody && !err->status; i++) {
    const tdm_assigned_body *assigned = &assignment->body[i];
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "coupling.bodies[%d].dem", i);
    int b = dem_find_body(m, assigned->name);
    if (b < 0) {
      unknown_body(m, path, assigned->name, err);
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

static bool is_coupled(const tdm_assignment *assignment, const char *name) {
  for (int i = 0; i < assignment->nbody; i++)
    if (strcmp(assignment->body[i].name, name) == 0)
      return true;
  return false;
}

static void read_body(dem_model *m, tdm_object *o, const tdm_assignment *assignment, dem_wall_list *walls) {
  const char *name = tdm_get_string(o, "name", NULL);
  int same = dem_find_body(m, name), index = m->nbody++;
  if (same >= 0)
    tdm_object_fail(o, "name", "\"%s\" is the name of dem.bodies[%d] already; give each body its own", name, same);
  dem_body *body = &m->body[index];
  body->name = strdup(name);
  body->material = dem_read_material(m, o);
  body->coupled = -1;
  body->mass = INFINITY;

  static const char *const placing[] = {"position", "orientation"};
  for (int k = 0; k < 2; k++)
    if (tdm_has(o, placing[k]) && is_coupled(assignment, name))
      tdm_object_fail(o, placing[k],
                      "\"%s\" is coupled, so its pose comes from the body it is coupled to; remove this key, and place "
                      "the body there",
                      name);
  body->start.pose.position = tdm_get_vec3(o, "position", &(tdm_vec3){0, 0, 0});
  body->start.pose.orientation = tdm_get_orientation(o, "orientation");

  json_t *shapes = tdm_get_array(o, "shapes", true);
  for (size_t k = 0; k < json_array_size(shapes) && !o->err->status; k++) {
    char path[TDM_PATH_MAX];
    dem_shape_read(json_array_get(shapes, k), tdm_path(path, o, "shapes", (int)k), index, walls, o->err);
  }
}

static void read_bodies(dem_model *m, json_t *array, const tdm_assignment *assignment, tdm_error *err) {
  size_t n = json_array_size(array);
  m->body = allocate(n, sizeof *m->body, err);
  dem_wall_list walls = {0};
  for (size_t i = 0; i < n && !err->status; i++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.bodies[%zu]", i);
    tdm_object o = tdm_object_open(json_array_get(array, i), path, err);
    read_body(m, &o, assignment, &walls);
    tdm_object_close(&o);
  }
  m->wall = walls.wall;
  m->nwall = walls.count;
  m->box = walls.box;
  m->nbox = walls.nbox;
  if (!err->status)
    couple_bodies(m, assignment, err);
}

/* ---- settling ---- */

/* 1 m without particles */
static double mean_radius(const dem_model *m) {
  double sum = 0;
  for (int i = 0; i < m->nparticle; i++)
    sum += m->radius[i];
  return m->nparticle ? sum / m->nparticle : 1;
}

/* for the skin: every source counts as one particle, so that a scene without particles has one too */
static double mean_radius_ahead(const dem_model *m) {
  double sum = 0;
  for (int i = 0; i < m->nparticle; i++)
    sum += m->radius[i];
  for (int s = 0; s < m->nsource; s++)
    sum += dem_sizes_mean(&m->source[s].sizes);
  int n = m->nparticle + m->nsource;
  return n ? sum / n : 1;
}

static void read_settle(dem_model *m, tdm_object *section) {
  m->settle.wanted = tdm_has(section, "settle");
  tdm_object o = tdm_get_object(section, "settle", false);
  double restitution = read_restitution(&o, 0.3);
  bool has_friction = tdm_has(&o, "friction");
  double friction = tdm_get_number(&o, "friction", 0, TDM_NOT_NEGATIVE);
  m->settle.speed = tdm_get_number(&o, "speed", 1e-3, TDM_POSITIVE);
  m->settle.max_time = tdm_get_number(&o, "max_time", 10, TDM_POSITIVE);
  m->settle.dt = tdm_get_number(&o, "dt", 0, tdm_has(&o, "dt") ? TDM_POSITIVE : TDM_ANY);
  /* a fifth of the rate at which a particle falls by its size: a short fall is not felt, rolling ends */
  m->settle.drag =
      tdm_get_number(&o, "drag", 0.2 * sqrt(tdm_norm(m->gravity) / (2 * mean_radius(m))), TDM_NOT_NEGATIVE);
  const char *store = tdm_has(&o, "store") ? tdm_get_string(&o, "store", NULL) : NULL;
  if (store && !store[0])
    tdm_object_fail(&o, "store", "is empty; give the file that keeps the settled bed, or remove the key");
  m->settle.store = store ? strdup(store) : NULL;
  tdm_object_close(&o);

  /* all pairs have the same restitution: solve for the damping once */
  dem_pair damped = {.restitution = restitution, .young = 1, .shear = 1};
  set_damping(&damped, m->clip, section->err, "dem.settle.restitution");
  for (int k = 0; k < m->nmaterial * m->nmaterial; k++) {
    dem_pair *pair = &m->settle_pair[k];
    *pair = m->pair[k];
    pair->restitution = restitution;
    if (has_friction)
      pair->friction = friction;
    pair->normal_damping = damped.normal_damping;
    pair->tangential_damping = damped.normal_damping * sqrt(8 * pair->shear / (2 * pair->young));
  }
}

void dem_model_read(dem_model *m, const tdm_assignment *assignment, tdm_error *err) {
  m->dt = assignment->dt;
  m->time_start = assignment->time_start;
  m->interpolation = assignment->interpolation;

  tdm_object o = tdm_object_open(assignment->scene, "dem", err);
  m->gravity = tdm_get_vec3(&o, "gravity", &(tdm_vec3){0, 0, -9.81});
  read_simd(m, &o);
  read_contact(m, &o);
  read_materials(m, tdm_get_array(&o, "materials", true), err);
  json_t *pairs = tdm_get_array(&o, "pairs", false);
  if (!err->status)
    read_pairs(m, pairs, err);
  json_t *bodies = tdm_get_array(&o, "bodies", false);
  if (!err->status)
    read_bodies(m, bodies, assignment, err);
  json_t *particles = tdm_get_array(&o, "particles", false);
  if (!err->status)
    dem_fill_read(m, particles, err);
  json_t *sources = tdm_get_array(&o, "sources", false), *sinks = tdm_get_array(&o, "sinks", false);
  if (!err->status)
    dem_sources_read(m, sources, err);
  if (!err->status)
    dem_sinks_read(m, sinks, err);
  if (!err->status)
    check_pairs(m, err);
  if (!err->status)
    read_settle(m, &o);
  tdm_has(&o, "settle");
  if (m->npouring > 0 && !m->settle.wanted)
    tdm_object_fail(&o, "settle", "missing: dem.particles[%d] is poured while settling; give \"settle\" {}",
                    m->pouring[0].entry);
  m->skin = tdm_get_number(&o, "skin", 0.1 * mean_radius_ahead(m), TDM_POSITIVE);
  bool has_speed = tdm_has(&o, "expected_speed");
  m->expected_speed = tdm_get_number(&o, "expected_speed", 0, has_speed ? TDM_POSITIVE : TDM_ANY);
  tdm_object_close(&o);
}
