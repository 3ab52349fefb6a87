/* The benchmark of the engine: see bench.h. A bed in a box without a lid, given as a file or made here. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/app/bench.h"

#include "dem/contact/table.h"
#include "dem/particles/create.h"
#include "dem/particles/field.h"
#include "dem/particles/particles.h"
#include "dem/scene/scene.h"
#include "dem/search/pairs.h"
#include "dem/state/data.h"
#include "dem/step/forces.h"
#include "dem/step/step.h"
#include "dem/store/state_file.h"
#include "dem/watch/energy_balance.h"
#include "protocol/base/log.h"
#include "protocol/base/status.h"
#include "protocol/math/gsl_errors.h"
#include "protocol/math/random.h"
#include "protocol/results/results.h"
#include "protocol/scene/json.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

static const char usage[] =
    "usage: tandem-dem bench [--particles N [--radius R] | --bed FILE] [--box L] [--mesh FILE] [--dt S] [--steps N]\n"
    "                        [--skin M] [--threads N] [--law NORMAL[/TANGENTIAL[/ROLLING[/COHESION]]]] [--simd NAME] "
    "[--search NAME] "
    "[--frozen]\n"
    "                        [--json FILE]\n"
    "  --bed FILE   lines \"x y z r\" [m], # starts a comment; without it N particles settle first (kept in the cache\n"
    "               folder)\n"
    "  --radius     of these: R or SMALLEST,LARGEST [m] (0.005)\n"
    "  --box L      side of the floor [m]; walls at 0 and L (default: what a made bed has, else from the particles)\n"
    "  --mesh FILE  an STL file [m] in place of the floor and the walls\n"
    "  --frozen     forces and histories only, particles do not move\n";

enum { LAW_PARTS = 4 };
static const dem_family part_family[LAW_PARTS] = {DEM_FAMILY_NORMAL, DEM_FAMILY_TANGENTIAL, DEM_FAMILY_ROLLING,
                                                  DEM_FAMILY_COHESION};

typedef struct {
  const char *bed, *json, *simd, *search, *mesh;
  char law[LAW_PARTS][32]; /* by part_family, empty: not given */
  int particles, threads;
  double radius[2]; /* of a made bed [m] */
  long steps;
  double box, dt, skin;
  bool frozen;
} options;

typedef struct {
  tdm_vec3 position;
  double radius;
} ball;

/* Particles, one after the other: from a file, or a lattice. */
typedef struct {
  FILE *file;
  const char *name;
  long line;
  int n; /* how many there are */
  double mean, side;
  double radius[2]; /* of a lattice */
  int next;
} bed;

/* ---- options ---- */

static bool number(const char *text, double low, double high, double *out) {
  char *end;
  *out = strtod(text, &end);
  return end != text && !*end && *out >= low && *out <= high;
}

/* "normal/tangential/…" into its parts; false: an empty, long or fifth one */
static bool split_law(options *o, const char *value) {
  memset(o->law, 0, sizeof o->law);
  for (int k = 0; k < LAW_PARTS; k++) {
    size_t n = strcspn(value, "/");
    if (n == 0 || n >= sizeof o->law[k])
      return false;
    memcpy(o->law[k], value, n);
    if (!value[n])
      return true;
    value += n + 1;
  }
  return false;
}

static bool whole(const char *text, double high, double *out) {
  return number(text, 1, high, out) && *out == floor(*out);
}

static bool read_option(options *o, const char *key, const char *value) {
  double x;
  if (!strcmp(key, "--bed"))
    o->bed = value;
  else if (!strcmp(key, "--json"))
    o->json = value;
  else if (!strcmp(key, "--mesh"))
    o->mesh = value;
  else if (!strcmp(key, "--law"))
    return split_law(o, value);
  else if (!strcmp(key, "--simd"))
    o->simd = value;
  else if (!strcmp(key, "--search"))
    o->search = value;
  else if (!strcmp(key, "--radius")) {
    int n = sscanf(value, "%lf,%lf", &o->radius[0], &o->radius[1]);
    if (n == 1)
      o->radius[1] = o->radius[0];
    return n >= 1 && o->radius[0] > 1e-6 && o->radius[1] >= o->radius[0] && o->radius[1] < 1;
  } else if (!strcmp(key, "--box"))
    return number(value, 1e-9, 1e9, &o->box);
  else if (!strcmp(key, "--dt"))
    return number(value, 1e-15, 1, &o->dt);
  else if (!strcmp(key, "--skin"))
    return number(value, 1e-12, 1e9, &o->skin);
  else if (!strcmp(key, "--particles") && whole(value, 1e8, &x))
    o->particles = (int)x;
  else if (!strcmp(key, "--steps") && whole(value, 1e12, &x))
    o->steps = (long)x;
  else if (!strcmp(key, "--threads") && whole(value, 1024, &x))
    o->threads = (int)x;
  else
    return false;
  return true;
}

/* false: wrong, told */
static bool read_options(options *o, int argc, char **argv) {
  for (int k = 0; k < argc; k++) {
    if (!strcmp(argv[k], "--frozen")) {
      o->frozen = true;
      continue;
    }
    if (k + 1 < argc && read_option(o, argv[k], argv[k + 1])) {
      k++;
      continue;
    }
    fprintf(stderr, "tandem-dem bench: \"%s%s%s\" is not understood\n%s", argv[k], k + 1 < argc ? " " : "",
            k + 1 < argc ? argv[k + 1] : "", usage);
    return false;
  }
  return true;
}

/* ---- beds ---- */

/* the next particle of a file; *s has the radius 0 at its end */
static tdm_status next_line(bed *b, ball *s, tdm_error *err) {
  char line[512];
  *s = (ball){0};
  while (fgets(line, sizeof line, b->file)) {
    b->line++;
    char *comment = strchr(line, '#');
    if (comment)
      *comment = 0;
    if (!line[strspn(line, " \t\r\n")])
      continue;
    if (sscanf(line, "%lf %lf %lf %lf", &s->position.x, &s->position.y, &s->position.z, &s->radius) == 4 &&
        tdm_finite(&s->position.x, 3) && s->radius > 0 && isfinite(s->radius))
      return TDM_OK;
    return tdm_fail(err, TDM_ERR_FILE, NULL, "\"%s\", line %ld: not \"x y z r\" with a radius greater than 0", b->name,
                    b->line);
  }
  return TDM_OK;
}

static void rewind_bed(bed *b) {
  if (b->file)
    rewind(b->file);
  b->line = 0;
  b->next = 0;
}

/* open a file and look through it: the number, the mean radius, the smallest square floor */
static tdm_status open_bed(bed *b, const char *name, tdm_error *err) {
  *b = (bed){.name = name, .file = fopen(name, "r")};
  if (!b->file)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "\"%s\" cannot be read: %s", name, strerror(errno));
  ball s;
  double sum = 0;
  for (; next_line(b, &s, err) == TDM_OK && s.radius > 0; b->n++) {
    sum += s.radius;
    b->side = fmax(b->side, fmax(s.position.x, s.position.y) + s.radius);
  }
  if (!err->status && b->n == 0)
    tdm_fail(err, TDM_ERR_FILE, NULL, "\"%s\" has no particles; lines are \"x y z r\"", name);
  b->mean = b->n > 0 ? sum / b->n : 1;
  return err->status;
}

/* spheres on a loose lattice, each a little off its place */
static ball next_of_lattice(bed *b) {
  double pitch = 2.1 * b->radius[1], off[4], gap;
  int side = (int)(b->side / pitch), k = b->next++;
  gap = b->side / side;
  for (int a = 0; a < 4; a++)
    off[a] = tdm_random(0, (uint64_t)k, (uint64_t)a);
  tdm_vec3 x = {k % side + 0.5, k / side % side + 0.5, 0.6 + k / (side * side)};
  tdm_vec3 shake = tdm_scale(pitch - 2 * b->radius[1], tdm_v3(off[0] - 0.5, off[1] - 0.5, off[2] - 0.5));
  return (ball){tdm_add(tdm_v3(gap * x.x, gap * x.y, pitch * x.z), shake),
                b->radius[0] + off[3] * (b->radius[1] - b->radius[0])};
}

/* a law, and what it asks of the pair; the reader of the scene tells of a name that no law has */
static void add_law(json_t *scene, dem_family family, const char *name) {
  json_t *contact = json_object_get(scene, "contact"), *pair = json_array_get(json_object_get(scene, "pairs"), 0);
  int place = dem_law_place(family, name);
  const dem_law_head *law = place < 0 ? NULL : dem_law_at(family, place);
  json_object_set_new(contact, dem_family_names[family], json_string(name));
  for (int q = 0; law && law->keys[q].name; q++)
    if (law->keys[q].example > 0)
      json_object_set_new(pair, law->keys[q].name, json_real(law->keys[q].example));
  if (law && family == DEM_FAMILY_TANGENTIAL && ((const dem_tangential_law *)law)->friction)
    json_object_set_new(pair, "friction", json_real(0.5));
}

/* the floor and four walls of side L, or a mesh */
static json_t *walls_of(const options *o) {
  if (o->mesh)
    return json_pack("{s:s, s:s}", "type", "mesh", "file", o->mesh);
  return json_pack("{s:s, s:s, s:[f,f,f], s:[f,f,f], s:[s]}", "type", "box", "side", "inside", "size", o->box, o->box,
                   1e3, "center", 0.5 * o->box, 0.5 * o->box, 500.0, "open", "+z");
}

/* The walls with the material of the peers' bed, no particles. */
static json_t *box_scene(const options *o) {
  static const char *const without[LAW_PARTS] = {"hertz", "mindlin", "none", "none"};
  json_t *s = json_pack("{s:[f,f,f], s:[{s:s, s:f, s:f, s:f}], s:[{s:[s,s], s:f}], s:{}}", "gravity", 0.0, 0.0, -9.81,
                        "materials", "name", "a", "density", 2500.0, "young_modulus", 1e7, "poisson_ratio", 0.3,
                        "pairs", "materials", "a", "a", "restitution", 0.5, "contact");
  for (int k = 0; k < LAW_PARTS; k++)
    add_law(s, part_family[k], o->law[k][0] ? o->law[k] : o->law[0][0] ? "none" : without[k]);
  json_object_set_new(s, "threads", json_integer(o->threads));
  if (o->skin > 0)
    json_object_set_new(s, "skin", json_real(o->skin));
  json_object_set_new(s, "bodies",
                      json_pack("[{s:s, s:s, s:[o]}]", "name", "box", "material", "a", "shapes", walls_of(o)));
  if (o->simd)
    json_object_set_new(s, "simd", json_string(o->simd));
  if (o->search)
    json_object_set_new(s, "search", json_string(o->search));
  return s;
}

typedef struct {
  dem_model *model;
  dem_data *data;
} engine;

static void engine_destroy(engine *e) {
  dem_data_destroy(&e->data);
  dem_model_destroy(&e->model);
}

static tdm_status add_ball(engine *e, ball s) {
  double mass = dem_sphere_mass(e->model->material[0].density, s.radius);
  return dem_data_add(e->data, &(dem_newcomer){.position = s.position, .radius = s.radius, .mass = mass});
}

/* the line of sphere number n of a file */
static long line_of(bed *b, uint64_t n) {
  ball s;
  tdm_error unused = {0};
  rewind_bed(b);
  for (uint64_t k = 0; k <= n && next_line(b, &s, &unused) == TDM_OK && s.radius > 0;)
    k++;
  return b->line;
}

/* spheres of a file that lie in one another would only fly apart */
static tdm_status refuse_coincident(const dem_data *d, bed *b, tdm_error *err) {
  for (size_t k = 0; b->file && k < d->lists.pairs.count; k++) {
    int i = d->lists.pairs.one[k], j = d->lists.pairs.other[k];
    if (j >= d->state.nparticle)
      continue;
    double radius = fmin(d->state.sphere[i].radius, d->state.sphere[j].radius);
    double depth = d->state.sphere[i].radius + d->state.sphere[j].radius -
                   tdm_norm(tdm_sub(d->state.sphere[i].position, d->state.sphere[j].position));
    if (depth > 0.5 * radius)
      return tdm_fail(err, TDM_ERR_FILE, NULL,
                      "\"%s\", lines %ld and %ld: the spheres overlap by %.3g m, more than half a radius; remove one",
                      b->name, line_of(b, d->state.id[i] < d->state.id[j] ? d->state.id[i] : d->state.id[j]),
                      line_of(b, d->state.id[i] < d->state.id[j] ? d->state.id[j] : d->state.id[i]), depth);
  }
  return TDM_OK;
}

static tdm_status load_model(engine *e, const options *o, tdm_error *err) {
  tdm_assignment assignment = {.scene = box_scene(o), .dt = o->dt, .n = 1};
  dem_model_read(&e->model, &assignment, err);
  json_decref(assignment.scene);
  return err->status;
}

static tdm_status engine_create(engine *e, const options *o, bed *b, tdm_error *err) {
  if (load_model(e, o, err))
    return err->status;
  e->data = dem_data_create(e->model);
  bool good = e->data && !dem_data_reserve(e->data, b->n);
  if (e->data && !(o->skin > 0)) /* the scene has no particles to choose a skin by */
    dem_skin_begin(e->data, b->mean);
  rewind_bed(b);
  for (int i = 0; good && i < b->n; i++) {
    ball s = {0};
    if (!b->file)
      s = next_of_lattice(b);
    else if (next_line(b, &s, err) || s.radius == 0)
      return err->status ? err->status : tdm_fail(err, TDM_ERR_FILE, NULL, "\"%s\" changed while it was read", b->name);
    good = !add_ball(e, s);
  }
  if (!good)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %d particles", b->n);
  if (dem_forces_begin(e->data, err))
    return err->status;
  return refuse_coincident(e->data, b, err);
}

/* let the bed fall, with a drag that leaves it at rest */
static tdm_status settle(engine *e, const options *o, tdm_error *err) {
  dem_data *d = e->data;
  double height = 0, mass = 0, drag = exp(-10 * o->dt);
  for (int i = 0; i < d->state.nparticle; i++) {
    height = fmax(height, d->state.sphere[i].position.z);
    mass += d->state.mass[i];
  }
  double quiet = 1e-7 * mass * 9.81 * d->state.sphere[0].radius;
  long most = (long)((1 + 8 * sqrt(2 * height / 9.81)) / o->dt);
  for (long k = 1; k <= most; k++) {
    if (dem_step(d, &(dem_step_task){.dt = o->dt}, err))
      return err->status;
    for (int i = 0; i < d->state.nparticle; i++) {
      d->state.pace[i].velocity = tdm_scale(drag, d->state.pace[i].velocity);
      d->state.pace[i].spin = tdm_scale(drag, d->state.pace[i].spin);
    }
    if (k % 100 == 0 && (double)k * o->dt > 0.1 && dem_kinetic_energy(d) < quiet)
      break;
  }
  return TDM_OK;
}

/* the file in which a made bed is kept: in the cache folder, else a temporary one */
static void cache_name(char name[PATH_MAX], const options *o) {
  const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
  char folder[PATH_MAX / 2] = "/tmp";
  if (cache && cache[0])
    snprintf(folder, sizeof folder, "%s", cache);
  else if (home && home[0])
    snprintf(folder, sizeof folder, "%s/.cache", home);
  strncat(folder, "/tandem", sizeof folder - strlen(folder) - 1);
  tdm_make_directory(folder, NULL); /* where that fails, writing the bed says so */
  snprintf(name, PATH_MAX, "%s/bed_%d_%g_%g_%g.txt", folder, o->particles, o->radius[0], o->radius[1], o->box);
}

/* beside it first, then renamed */
static tdm_status keep_bed(const dem_data *d, const char *name, tdm_error *err) {
  char temporary[PATH_MAX + 32];
  snprintf(temporary, sizeof temporary, "%s.%ld", name, (long)getpid());
  FILE *f = fopen(temporary, "w");
  if (f) {
    fprintf(f, "# settled bed: x y z r [m]\n");
    for (int i = 0; i < d->state.nparticle; i++) {
      tdm_vec3 x = d->state.sphere[i].position;
      fprintf(f, "%.12g %.12g %.12g %.12g\n", x.x, x.y, x.z, d->state.sphere[i].radius);
    }
  }
  if (f && fclose(f) == 0 && rename(temporary, name) == 0)
    return TDM_OK;
  int error = errno;
  remove(temporary);
  return tdm_fail(err, TDM_ERR_FILE, NULL, "\"%s\", where the bed is kept, cannot be written: %s; set XDG_CACHE_HOME",
                  name, strerror(error));
}

/* Settle a bed in a process's own engine and keep it, unless it is kept already. */
static tdm_status make_bed(bed *b, char name[PATH_MAX], const options *o, tdm_error *err) {
  cache_name(name, o);
  if (access(name, R_OK) == 0 && open_bed(b, name, err) == TDM_OK && b->n == o->particles)
    return TDM_OK;
  if (b->file)
    fclose(b->file);
  *err = (tdm_error){0};
  *b = (bed){.n = o->particles, .side = o->box, .radius = {o->radius[0], o->radius[1]}};
  b->mean = 0.5 * (o->radius[0] + o->radius[1]);
  if (o->box < 2.1 * o->radius[1])
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "--box %g m has no room for particles of %g m", o->box, o->radius[1]);
  fprintf(stderr, "settling %d particles; the bed is kept in %s\n", o->particles, name);
  options plain = *o;
  memset(plain.law, 0, sizeof plain.law);
  plain.simd = plain.search = plain.mesh = NULL;
  plain.skin = 0;
  plain.dt = 0.0172 * o->radius[0]; /* a fifth of the Rayleigh step */
  engine e = {0};
  if (engine_create(&e, &plain, b, err) == TDM_OK && settle(&e, &plain, err) == TDM_OK)
    keep_bed(e.data, name, err);
  engine_destroy(&e);
  return err->status ? err->status : open_bed(b, name, err);
}

/* ---- measuring ---- */

static tdm_status run_steps(dem_data *d, const options *o, long n, tdm_error *err) {
  for (long k = 0; k < n; k++) {
    if (o->frozen)
      dem_forces_frozen(d, o->dt);
    else if (dem_step(d, &(dem_step_task){.dt = o->dt}, err))
      return err->status;
  }
  return TDM_OK;
}

/* An engine in the same state that looks at every pair, one contact at a time. */
static tdm_status make_referee(engine *referee, dem_data *d, const options *o, tdm_error *err) {
  options plain = *o;
  plain.simd = "plain";
  plain.search = "all";
  plain.threads = 1;
  void *bytes = NULL;
  size_t size = 0;
  if (load_model(referee, &plain, err))
    return err->status;
  referee->data = dem_data_create(referee->model);
  if (!referee->data || dem_state_save(d, &bytes, &size))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %d particles", d->state.nparticle);
  if (dem_state_load(referee->data, bytes, size, err) == TDM_OK)
    dem_forces_again(referee->data, false, 0);
  free(bytes);
  return err->status;
}

/* Largest difference of a force or of a torque by the radius against the referee, as a share of the largest force.
 * NAN: too many particles. */
static tdm_status find_force_error(dem_data *d, const options *o, double *error, tdm_error *err) {
  *error = NAN;
  if (d->state.nparticle > 20000)
    return TDM_OK;
  engine referee = {0};
  if (make_referee(&referee, d, o, err) == TDM_OK) {
    double worst = 0, largest = 0;
    dem_forces_again(d, false, 0);
    for (int i = 0; i < d->state.nparticle; i++) {
      const dem_push *all = &referee.data->state.push[i];
      largest = fmax(largest, tdm_norm(all->force));
      worst = fmax(worst, tdm_norm(tdm_sub(all->force, d->state.push[i].force)));
      worst = fmax(worst, tdm_norm(tdm_sub(all->twist, d->state.push[i].twist)));
    }
    *error = largest > 0 ? worst / largest : worst;
  }
  engine_destroy(&referee);
  return err->status;
}

static long peak_memory(void) {
  struct rusage use;
  getrusage(RUSAGE_SELF, &use);
  return use.ru_maxrss * 1024L;
}

static double cpu_clock(void) {
  struct rusage use;
  getrusage(RUSAGE_SELF, &use);
  return (double)(use.ru_utime.tv_sec + use.ru_stime.tv_sec) +
         1e-6 * (double)(use.ru_utime.tv_usec + use.ru_stime.tv_usec);
}

/* pairs of particles: each counts for two particles, a contact with a wall for one */
static long touching_pairs(const dem_data *d) {
  long many = 0;
  for (size_t k = 0; k < d->lists.pairs.count; k++) {
    if (d->lists.pairs.other[k] >= d->state.nparticle)
      continue;
    const dem_sphere *a = &d->state.sphere[d->lists.pairs.one[k]], *b = &d->state.sphere[d->lists.pairs.other[k]];
    many += tdm_norm(tdm_sub(a->position, b->position)) < a->radius + b->radius;
  }
  return many;
}

static tdm_status measure(const options *o, bed *b, json_t **out, tdm_error *err) {
  engine e = {0};
  if (engine_create(&e, o, b, err) || run_steps(e.data, o, (o->steps + 9) / 10, err)) {
    engine_destroy(&e);
    return err->status;
  }
  dem_data *d = e.data;
  uint64_t rebuilds = d->lists.nrebuild;
  double cpu = cpu_clock(), wall = tdm_clock();
  if (run_steps(d, o, o->steps, err) == TDM_OK) {
    wall = tdm_clock() - wall;
    cpu = cpu_clock() - cpu;
    long rss = peak_memory(), listed = 0, touching = touching_pairs(d);
    for (size_t k = 0; k < d->lists.pairs.count; k++)
      listed += d->lists.pairs.other[k] < d->state.nparticle;
    double n = d->state.nparticle, energy = dem_kinetic_energy(d);
    char law[128];
    snprintf(law, sizeof law, "%s/%s/%s/%s", e.model->normal->head.name, e.model->tangential->head.name,
             e.model->rolling->head.name, e.model->cohesion->head.name);
    *out =
        json_pack("{s:i, s:I, s:i, s:s, s:s, s:f, s:f, s:f, s:f, s:f, s:I, s:I, s:f}", "particles", d->state.nparticle,
                  "steps", (json_int_t)o->steps, "threads", d->work.nthread, "law", law, "simd", e.model->simd, "cpu_s",
                  cpu, "wall_s", wall, "particle_steps_per_s", n * (double)o->steps / wall, "coordination",
                  (double)(touching + d->state.ncontact) / n, "pairs_per_particle", (double)listed / n, "rebuilds",
                  (json_int_t)(d->lists.nrebuild - rebuilds), "rss_bytes", (json_int_t)rss, "kinetic_energy", energy);
    double error;
    if (find_force_error(d, o, &error, err) == TDM_OK)
      json_object_set_new(*out, "force_error", tdm_number_to_json(error));
  }
  engine_destroy(&e);
  return err->status;
}

int dem_bench_main(int argc, char **argv) {
  tdm_gsl_return_errors();
  options o = {.particles = 10000, .threads = 1, .dt = 8.6e-5, .radius = {0.005, 0.005}};
  tdm_error err = {0};
  bed b = {0};
  json_t *out = NULL;
  if (argc > 0 && (!strcmp(argv[0], "--help") || !strcmp(argv[0], "-h"))) {
    fputs(usage, stdout);
    return EXIT_SUCCESS;
  }
  if (!read_options(&o, argc, argv))
    return EXIT_FAILURE;
  char name[PATH_MAX];
  if (o.bed) {
    open_bed(&b, o.bed, &err);
    o.box = o.box > 0 ? o.box : b.side;
  } else {
    double side = (o.radius[0] + o.radius[1]) * cbrt(o.particles);
    o.box = o.box > 0 ? o.box : fmax(side, 2.2 * o.radius[1]);
    make_bed(&b, name, &o, &err);
  }
  if (o.steps == 0)
    o.steps = (long)fmax(100, 2e7 / fmax(1, b.n));
  if (!err.status)
    measure(&o, &b, &out, &err);
  if (b.file)
    fclose(b.file);
  if (err.status) {
    fprintf(stderr, "tandem-dem bench: %s%s%s\n", err.path, err.path[0] ? ": " : "", err.message);
    return EXIT_FAILURE;
  }
  char *text = out ? json_dumps(out, JSON_INDENT(2) | JSON_REAL_PRECISION(6)) : NULL;
  if (!text) {
    fputs("tandem-dem bench: no memory for the result\n", stderr);
    json_decref(out);
    return EXIT_FAILURE;
  }
  puts(text);
  int status = EXIT_SUCCESS;
  if (o.json && json_dump_file(out, o.json, JSON_INDENT(2)) != 0) {
    fprintf(stderr, "tandem-dem bench: \"%s\" cannot be written: %s\n", o.json, strerror(errno));
    status = EXIT_FAILURE;
  }
  free(text);
  json_decref(out);
  return status;
}
