/* Particles from a scene.
 *
 * Random filling never fails by chance: the region is divided into equal cells that hold a particle of the largest
 * radius each, as few cells as will do, so as large as possible. Particles get cells at random, and a random place
 * inside their cell, from GSL's Mersenne Twister: scenes keep the fillings that they were made with, which random.h
 * would draw otherwise. The densest filling is the simple cubic lattice; a region that is too small for it is refused.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/base/pages.h"
#include "dem/base/sphere.h"
#include "dem/model/cells.h"
#include "dem/moldyn/particles.h"
#include "dem/scene/keys.h"
#include "dem/seam/homes.h"

#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PARTICLES_MAX = 20000000, CELLS_MANY = 100000000 };

/* one row a way to make particles: its "type", read by read_<type> */
#define FILL_LIST(X) \
  X(list)            \
  X(block)           \
  X(random)          \
  X(poured)          \
  X(moldyn)

/* One entry of dem.particles while it is read. */
typedef struct {
  dem_model *m;
  tdm_object *o;
  int entry;    /* of dem.particles */
  int material; /* index of dem_model.material */
  dem_sizes sizes;
  uint64_t seed;
  tdm_pose frame;    /* positions of the entry to world */
  tdm_vec3 velocity; /* world [m/s] */
  tdm_vec3 spin;     /* world [rad/s] */
  double mass;       /* of one particle [kg], 0: from the density */
  double total_mass; /* of all [kg], 0: from the density */
  bool counting;     /* particles are not made, but counted */
} filler;

/* Let *array hold n items. */
static tdm_status grow(void *array, size_t n, size_t size) {
  void *p;
  memcpy(&p, array, sizeof p);
  p = realloc(p, n * size);
  if (p)
    memcpy(array, &p, sizeof p);
  return p ? TDM_OK : TDM_ERR_MEMORY;
}

/* The same with zeros from item `from` on, which take no memory as long as they are zero: most particles start at rest.
 */
static tdm_status grow_zero(tdm_vec3 **array, size_t from, size_t n) {
  if (grow(array, n, sizeof **array))
    return TDM_ERR_MEMORY;
  dem_pages_zero(*array + from, (n - from) * sizeof **array);
  return TDM_OK;
}

static void set_vector(tdm_vec3 *place, tdm_vec3 v) {
  static const tdm_vec3 zero;
  if (memcmp(&v, &zero, sizeof v) != 0)
    *place = v;
}

/* Room for n more particles, which are to be added now; false: they are not. */
static bool make_room(filler *f, long n) {
  dem_model *m = f->m;
  if (n > PARTICLES_MAX - m->nparticle) {
    tdm_object_fail(f->o, NULL, "makes %ld particles; at most %d in all are supported", n, PARTICLES_MAX);
    return false;
  }
  if (f->counting) {
    m->nparticle += (int)n;
    return false;
  }
  size_t before = (size_t)m->nparticle, total = before + (size_t)n + 1;
  if (grow(&m->radius, total, sizeof *m->radius) || grow(&m->mass, total, sizeof *m->mass) ||
      grow(&m->particle_material, total, sizeof *m->particle_material) ||
      grow(&m->position, total, sizeof *m->position) || grow_zero(&m->velocity, before, total) ||
      grow_zero(&m->spin, before, total) || (m->still && grow(&m->still, total, sizeof *m->still)) ||
      (m->oriented && grow(&m->orientation, total, sizeof *m->orientation)))
    tdm_fail(f->o->err, TDM_ERR_MEMORY, f->o->path, "no memory for %ld particles", n);
  return !f->o->err->status;
}

static double mass_of(const filler *f, double radius) {
  return f->mass > 0 ? f->mass : dem_sphere_mass(f->m->material[f->material].density, radius);
}

/* radius of the entry's particle k */
static double radius_of(const filler *f, uint64_t k) {
  return dem_sizes_draw(&f->sizes, f->seed, k);
}

/* Add a particle at x (coordinates of the entry). There is room. Others' places are not touched, so they take no
 * memory. */
static void add(filler *f, tdm_vec3 x, double radius) {
  dem_model *m = f->m;
  int i = m->nparticle++;
  m->radius[i] = radius;
  m->mass[i] = mass_of(f, radius);
  m->particle_material[i] = f->material;
  if (m->still)
    m->still[i] = false;
  if (i < m->first_here || i >= m->end_here)
    return;
  m->position[i] = dem_flatten(m, tdm_pose_point(f->frame, x), m->flat_at);
  set_vector(&m->velocity[i], f->velocity);
  set_vector(&m->spin[i], f->spin);
  if (m->oriented)
    m->orientation[i] = tdm_quat_identity();
}

/* ---- list ---- */

/* radius of particle i of a list: its own where the entry has "radii" */
static double radius_in_list(const filler *f, json_t *radii, size_t i) {
  char path[TDM_PATH_MAX];
  double r = radii ? json_number_value(json_array_get(radii, i)) : radius_of(f, i);
  if (!(r > 0) || !isfinite(r))
    tdm_fail(f->o->err, TDM_ERR_SCENE, tdm_path(path, f->o, "radii", (int)i), "must be a number greater than 0");
  return r;
}

static void read_list(filler *f) {
  tdm_object *o = f->o;
  json_t *positions = tdm_get_array(o, "positions", true), *radii = tdm_get_array(o, "radii", false);
  size_t n = json_array_size(positions);
  if (radii && json_array_size(radii) != n)
    tdm_object_fail(o, "radii", "has %zu entries but there are %zu positions; give each its radius",
                    json_array_size(radii), n);
  if (o->err->status || !make_room(f, (long)n))
    return;
  for (size_t i = 0; i < n; i++) {
    json_t *entry = json_array_get(positions, i);
    double x[3];
    bool good = json_array_size(entry) == 3;
    for (size_t a = 0; a < 3 && good; a++) {
      json_t *value = json_array_get(entry, a);
      x[a] = json_number_value(value);
      good = json_is_number(value) && isfinite(x[a]);
    }
    if (!good) {
      char path[TDM_PATH_MAX];
      tdm_fail(o->err, TDM_ERR_SCENE, tdm_path(path, o, "positions", (int)i), "must be three finite numbers [x, y, z]");
      return;
    }
    double radius = radius_in_list(f, radii, i);
    if (o->err->status)
      return;
    add(f, tdm_v3(x[0], x[1], x[2]), radius);
  }
}

/* ---- block ---- */

static void read_block(filler *f) {
  tdm_object *o = f->o;
  double radius = f->sizes.max;
  double spacing = tdm_get_number(o, "spacing", o->err->status ? 1 : 2 * radius, TDM_POSITIVE);
  tdm_vec3 corner = tdm_get_vec3(o, "corner", NULL);
  double count[3] = {0, 0, 0};
  tdm_get_numbers(o, "count", count, 3, true);
  for (int a = 0; a < 3 && !o->err->status; a++)
    if (count[a] != floor(count[a]) || count[a] < 0 || count[a] > PARTICLES_MAX)
      tdm_object_fail(o, "count", "has the entry %g; give three whole numbers of 0 or more", count[a]);
  if (!o->err->status && spacing < 2 * radius * (1 - 1e-9))
    tdm_object_fail(o, "spacing", "is %g m, so that particles of radius %g m overlap; give at least %g", spacing,
                    radius, 2 * radius);
  double n = count[0] * count[1] * count[2];
  if (o->err->status || !make_room(f, n > PARTICLES_MAX ? PARTICLES_MAX + 1L : (long)n))
    return;
  uint64_t number = 0;
  for (int k = 0; k < (int)count[2]; k++)
    for (int j = 0; j < (int)count[1]; j++)
      for (int i = 0; i < (int)count[0]; i++)
        add(f, tdm_axpy(spacing, tdm_v3(i, j, k), corner), radius_of(f, number++));
}

/* ---- random ---- */

/* Cells in each direction for edge length `edge`; returns their product. */
static double cells_of(const double size[3], double edge, double n[3]) {
  for (int a = 0; a < 3; a++)
    n[a] = floor(size[a] / edge * (1 + 1e-12));
  return n[0] * n[1] * n[2];
}

/* The largest cells of at least `least` of which there are `count`; false when even the smallest are too few. */
static bool choose_cells(const double size[3], double least, long count, double n[3]) {
  if (cells_of(size, least, n) < (double)count)
    return false;
  double low = least, high = size[0] + size[1] + size[2];
  for (int i = 0; i < 60; i++) {
    double edge = 0.5 * (low + high);
    if (cells_of(size, edge, n) >= (double)count)
      low = edge;
    else
      high = edge;
  }
  cells_of(size, low, n);
  return true;
}

static void scatter(filler *f, gsl_rng *rng, tdm_vec3 low, const double size[3], const double n[3], long count) {
  double cell[3] = {size[0] / n[0], size[1] / n[1], size[2] / n[2]};
  long ncell = (long)(n[0] * n[1] * n[2]), left = count;
  uint64_t number = 0;
  for (long c = 0; c < ncell && left > 0; c++) {
    /* choose `left` of the remaining cells, each as likely as any other (Knuth, algorithm S); order stays */
    if (gsl_rng_uniform(rng) * (double)(ncell - c) >= (double)left)
      continue;
    left--;
    double share = gsl_rng_uniform(rng);
    double radius = f->sizes.total > 0 ? radius_of(f, number++) : dem_sizes_quantile(&f->sizes, share);
    const double at[3] = {(double)(c % (long)n[0]), (double)(c / (long)n[0] % (long)n[1]),
                          (double)(c / ((long)n[0] * (long)n[1]))};
    double x[3];
    for (int a = 0; a < 3; a++) {
      double play = fmax(0, cell[a] - 2 * radius);
      x[a] = at[a] * cell[a] + radius + play * gsl_rng_uniform(rng);
    }
    add(f, tdm_add(low, tdm_v3(x[0], x[1], x[2])), radius);
  }
}

static void read_region(tdm_object *o, double radius, tdm_vec3 *low, tdm_vec3 *high) {
  tdm_object region = tdm_get_object(o, "region", true);
  *low = tdm_get_vec3(&region, "min", NULL);
  *high = tdm_get_vec3(&region, "max", NULL);
  if (!o->err->status && !(high->x > low->x && high->y > low->y && high->z > low->z))
    tdm_object_fail(&region, "max", "must be greater than min in x, y and z");
  dem_check_place(&region, "min", *low, radius);
  dem_check_place(&region, "max", *high, radius);
  tdm_object_close(&region);
}

static void read_random(filler *f) {
  tdm_object *o = f->o;
  long count = tdm_get_integer(o, "count", TDM_REQUIRED_INT, 0);
  double largest = f->sizes.max, n[3];
  tdm_vec3 low, high;
  read_region(o, largest, &low, &high);
  double size[3] = {high.x - low.x, high.y - low.y, high.z - low.z};
  if (o->err->status || count == 0 || !make_room(f, count))
    return;
  if (!choose_cells(size, 2 * largest, count, n)) {
    double room = cells_of(size, 2 * largest, n), layer = n[0] * n[1];
    if (layer > 0)
      tdm_object_fail(o, "region", "holds %.0f particles of radius %g m, not %ld; make it at least %g m high (z)", room,
                      largest, count, ceil((double)count / layer) * 2 * largest);
    else
      tdm_object_fail(o, "region", "is smaller than a particle of radius %g m; make it larger", largest);
    return;
  }
  dem_fewer_cells(n, fmax(CELLS_MANY, 2 * (double)count));
  gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
  if (!rng) {
    tdm_fail(o->err, TDM_ERR_MEMORY, NULL, "out of memory");
    return;
  }
  gsl_rng_set(rng, (unsigned long)f->seed);
  scatter(f, rng, low, size, n, count);
  gsl_rng_free(rng);
}

/* ---- poured ---- */

/* As many as make up total_mass at most; all together are not heavier than it but for the next one. */
static long count_of_mass(const filler *f) {
  double sum = 0;
  for (uint64_t k = 0; k < PARTICLES_MAX; k++) {
    sum += mass_of(f, radius_of(f, k));
    if (sum > f->total_mass * (1 + 1e-9)) /* sums are not exact */
      return (long)k;
  }
  return PARTICLES_MAX + 1L;
}

/* the number to pour, from "count" or "total_mass"; with both the masses are scaled */
static long read_amount(filler *f) {
  tdm_object *o = f->o;
  if (tdm_has(o, "count"))
    return tdm_get_integer(o, "count", TDM_REQUIRED_INT, 0);
  if (f->total_mass == 0 && !o->err->status)
    tdm_object_fail(o, "count", "missing; give \"count\" or \"total_mass\" [kg]");
  long n = o->err->status ? 0 : count_of_mass(f);
  if (n == 0 && !o->err->status)
    tdm_object_fail(o, "total_mass", "is %g kg, less than the first particle, %g kg", f->total_mass,
                    mass_of(f, radius_of(f, 0)));
  f->total_mass = 0;
  return n;
}

static void check_pouring(tdm_object *o, const filler *f, const dem_pouring *p) {
  tdm_vec3 size = tdm_sub(p->high, p->low);
  double least = fmin(size.x, fmin(size.y, size.z));
  if (!o->err->status && least < 2 * p->largest * (1 - 1e-9))
    tdm_object_fail(o, "region", "is smaller than a particle of radius %g m; make it larger", p->largest);
  if (!o->err->status && tdm_norm(f->m->gravity) == 0 && tdm_norm(f->velocity) == 0)
    tdm_object_fail(o, "velocity", "is zero, and so is gravity: the particles would never leave the region");
}

static void read_poured(filler *f) {
  tdm_object *o = f->o;
  dem_model *m = f->m;
  long count = read_amount(f);
  dem_pouring p = {.entry = f->entry, .first = m->nparticle, .frame = f->frame, .seed = f->seed};
  p.largest = f->sizes.max;
  read_region(o, p.largest, &p.low, &p.high);
  check_pouring(o, f, &p);
  if (o->err->status || !make_room(f, count))
    return;
  p.count = (int)count;
  for (int k = 0; k < p.count; k++)
    add(f, tdm_scale(0.5, tdm_add(p.low, p.high)), radius_of(f, (uint64_t)k));
  m->pouring[m->npouring++] = p;
  m->npoured += p.count;
}

/* ---- moldyn ---- */

/* particle i of the model never moves */
static void hold(filler *f, int i) {
  dem_model *m = f->m;
  if (!m->still)
    m->still = calloc((size_t)m->nparticle + 1, sizeof *m->still);
  if (!m->still) {
    tdm_fail(f->o->err, TDM_ERR_MEMORY, f->o->path, "no memory for fixed particles");
    return;
  }
  m->still[i] = true;
  m->driven = m->fixes = true;
}

/* refuse what no particle can do in two dimensions, or without rotation */
static void check_motion(const filler *f, tdm_vec3 velocity, tdm_vec3 spin) {
  const dem_model *m = f->m;
  if (m->unturned && tdm_dot(spin, spin) > 0)
    tdm_fail(f->o->err, TDM_ERR_SCENE, "dem.rotation",
             "is false, but a particle has a spin at the start; remove the spin");
  if (m->flat >= 0 && ((&velocity.x)[m->flat] != 0 || tdm_norm(dem_flatten(m, spin, 0)) > 0))
    tdm_fail(f->o->err, TDM_ERR_SCENE, f->o->path,
             "moves out of the plane of dem.plane; with dem.dimension 2 give velocities in it and spins about %c",
             "xyz"[m->flat]);
}

/* what a file says of each particle itself */
static void set_particle(filler *f, int i, const dem_pin_particle *p) {
  dem_model *m = f->m;
  m->velocity[i] = tdm_quat_rotate(f->frame.orientation, p->velocity);
  m->spin[i] = tdm_quat_rotate(f->frame.orientation, p->spin);
  if (m->oriented)
    m->orientation[i] = tdm_quat_mul(f->frame.orientation, p->orientation);
  check_motion(f, m->velocity[i], m->spin[i]);
  if (!p->moves)
    hold(f, i);
}

static void read_moldyn(filler *f) {
  tdm_object *o = f->o;
  static const char *const own[] = {"radius", "velocity", "spin", "fixed", "seed"};
  for (int k = 0; k < 5; k++)
    if (tdm_has(o, own[k]))
      tdm_object_fail(o, own[k], "comes from the file; remove it");
  const char *file = tdm_get_string(o, "file", NULL);
  dem_pin pin;
  char path[TDM_PATH_MAX];
  tdm_path(path, o, "file", -1);
  if (o->err->status)
    return;
  if (dem_pin_read(&pin, file, path, o->err) == TDM_OK && make_room(f, pin.count)) {
    int first = f->m->nparticle;
    for (int k = 0; k < pin.count; k++)
      add(f, pin.particle[k].position, pin.particle[k].radius);
    for (int k = 0; k < pin.count && !o->err->status; k++)
      set_particle(f, first + k, &pin.particle[k]);
  }
  dem_pin_free(&pin);
}

/* ---- entries ---- */

/* "material" and "body" by name */
static void read_names(filler *f) {
  tdm_object *o = f->o;
  f->material = dem_read_material(f->m, o);
  f->frame = (tdm_pose){{0, 0, 0}, tdm_quat_identity()};
  if (!tdm_has(o, "body"))
    return;
  const char *body = tdm_get_string(o, "body", NULL);
  int b = dem_find_body(f->m, body);
  if (b < 0)
    tdm_object_fail(o, "body", "\"%s\" is no body of dem.bodies; name one of them, or remove the key for world axes",
                    body);
  else
    f->frame = f->m->body[b].start.pose;
}

/* scale the masses of particles [first, nparticle) to an exact total */
static void scale_mass(dem_model *m, int first, double total) {
  double sum = 0;
  for (int i = first; i < m->nparticle; i++)
    sum += m->mass[i];
  for (int i = first; i < m->nparticle; i++)
    m->mass[i] *= total / sum;
}

/* refuse masses of particles [first, nparticle) that are no use as numbers, at the key they come from */
static void check_masses(const filler *f, int first) {
  const char *key = f->total_mass > 0 ? "total_mass" : f->mass > 0 ? "mass" : "radius";
  for (int i = first; i < f->m->nparticle && !f->o->err->status; i++)
    dem_check_mass(f->o, key, f->m->mass[i]);
}

/* What a group of particles has besides the rest: body forces, and particles that never move. */
static void read_extras(dem_model *m, dem_group *group, tdm_object *o) {
  const tdm_vec3 zero = {0, 0, 0};
  static const char *const keys[] = {"force", "acceleration", "velocity", "spin"};
  group->force = dem_read_vector(o, keys[0], &zero);
  group->acceleration = dem_read_vector(o, keys[1], &zero);
  group->fixed = tdm_get_bool(o, "fixed", false);
  for (int k = 0; group->fixed && k < 4; k++)
    if (tdm_norm(tdm_get_vec3(o, keys[k], &zero)) > 0)
      tdm_object_fail(o, keys[k], "moves particles that are fixed; remove it, or \"fixed\"");
  bool pushed = tdm_norm(group->force) > 0 || tdm_norm(group->acceleration) > 0;
  m->driven = m->driven || (group->count > 0 && (group->fixed || pushed));
  m->fixes = m->fixes || (group->count > 0 && group->fixed);
}

static void read_entry(dem_model *m, tdm_object *o, int entry, bool counting) {
  static const char *const types[] = {
#define X(name) #name,
      FILL_LIST(X)
#undef X
  };
  static void (*const read[])(filler *) = {
#define X(name) read_##name,
      FILL_LIST(X)
#undef X
  };
  filler f = {.m = m, .o = o, .entry = entry, .counting = counting};
  int type = tdm_get_choice(o, "type", types, sizeof types / sizeof types[0], -1);
  read_names(&f);
  const tdm_vec3 zero = {0, 0, 0};
  f.velocity = dem_read_vector(o, "velocity", &zero);
  f.spin = dem_read_vector(o, "spin", &zero);
  void (*reader)(filler *) = read[type < 0 ? 0 : type];
  bool own = reader == read_list && tdm_has(o, "radii");
  if (own && tdm_has(o, "radius"))
    tdm_object_fail(o, "radius", "excludes \"radii\"; give one radius for all, or each its own");
  if (reader != read_moldyn && !own)
    dem_sizes_read(o, &f.sizes);
  f.seed = (uint64_t)tdm_get_integer(o, "seed", 1, 0);
  f.mass = tdm_get_number(o, "mass", 0, tdm_has(o, "mass") ? TDM_POSITIVE : TDM_ANY);
  f.total_mass = tdm_get_number(o, "total_mass", 0, tdm_has(o, "total_mass") ? TDM_POSITIVE : TDM_ANY);
  if (f.mass > 0 && f.total_mass > 0)
    tdm_object_fail(o, "total_mass", "excludes \"mass\"; give the mass of one particle or of all");
  if (o->err->status)
    return;
  int first = m->nparticle;
  read[type](&f);
  if (counting)
    return;
  if (m->nparticle > first)
    check_motion(&f, f.velocity, f.spin);
  if (f.total_mass > 0 && m->nparticle > first)
    scale_mass(m, first, f.total_mass);
  check_masses(&f, first);
  dem_group *group = &m->group[entry];
  *group = (dem_group){.first = first, .count = m->nparticle - first};
  read_extras(m, group, o);
  if (group->fixed && m->npouring > 0 && m->pouring[m->npouring - 1].entry == entry)
    tdm_object_fail(o, "fixed", "holds particles that are to fall; remove it, or choose another \"type\"");
  tdm_object_close(o);
}

static bool is_of_type(json_t *particles, size_t entry, const char *type) {
  const char *own = json_string_value(json_object_get(json_array_get(particles, entry), "type"));
  return own && strcmp(own, type) == 0;
}

static void read_entries(dem_model *m, json_t *particles, bool counting, tdm_error *err) {
  for (int poured = 0; poured < 2; poured++) /* those that are poured are the last */
    for (size_t i = 0; i < json_array_size(particles) && !err->status; i++) {
      if (is_of_type(particles, i, "poured") != poured)
        continue;
      char path[TDM_PATH_MAX];
      snprintf(path, sizeof path, "dem.particles[%zu]", i);
      tdm_object o = tdm_object_open(json_array_get(particles, i), path, err);
      read_entry(m, &o, (int)i, counting);
    }
}

/* Which particles' places and motion this rank needs: those of its home. Of those that are poured all ranks need all; a
 * file is not worth reading twice. */
static void choose_home(dem_model *m, json_t *particles, const dem_ranks *ranks, tdm_error *err) {
  for (size_t i = 0; i < json_array_size(particles); i++)
    if (is_of_type(particles, i, "poured") || is_of_type(particles, i, "moldyn"))
      return;
  read_entries(m, particles, true, err);
  m->first_here = dem_first_at_start(m->nparticle, ranks->rank, ranks->size);
  m->end_here = dem_first_at_start(m->nparticle, ranks->rank + 1, ranks->size);
  m->nparticle = 0;
}

void dem_fill_read(dem_model *m, json_t *particles, const dem_ranks *ranks, tdm_error *err) {
  size_t n = json_array_size(particles);
  m->group = calloc(n + 1, sizeof *m->group);
  m->pouring = calloc(n + 1, sizeof *m->pouring);
  m->ngroup = (int)n;
  if (!m->group || !m->pouring)
    tdm_fail(err, TDM_ERR_MEMORY, "dem.particles", "no memory");
  m->end_here = PARTICLES_MAX;
  if (ranks)
    choose_home(m, particles, ranks, err);
  read_entries(m, particles, false, err);
}
