/* The benchmark of the engine: see bench.h. A bed in a box without a lid, given as a file or made here. */
#include "dem/bench.h"

#include "dem/data.h"
#include "dem/search/pairs.h"
#include "dem/step.h"
#include "protocol/log.h"
#include "protocol/status.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

static const char usage[] =
    "usage: tandem-dem bench [--particles N | --bed FILE] [--box L] [--dt S] [--steps N] [--skin M] [--threads N]\n"
    "                        [--law NORMAL[/TANGENTIAL[/ROLLING[/COHESION]]]] [--simd NAME] [--search NAME] "
    "[--frozen]\n"
    "                        [--json FILE]\n"
    "  --bed FILE   lines \"x y z r\" [m], # starts a comment; without it N particles of 5 mm settle first (kept in\n"
    "               the cache folder)\n"
    "  --box L      side of the floor [m]; walls at 0 and L (default: what a made bed has, else from the particles)\n"
    "  --frozen     forces and histories only, particles do not move\n";

typedef struct {
  const char *bed, *json, *law, *simd, *search;
  int particles, threads;
  long steps;
  double box, dt, skin;
  bool frozen;
} options;

typedef struct {
  tdm_vec3 position;
  double radius;
} ball;

typedef struct {
  ball *ball;
  int n;
} bed;

/* ---- options ---- */

static bool number(const char *text, double low, double high, double *out) {
  char *end;
  *out = strtod(text, &end);
  return end != text && !*end && *out >= low && *out <= high;
}

static bool read_option(options *o, const char *key, const char *value) {
  double x;
  if (!strcmp(key, "--bed"))
    o->bed = value;
  else if (!strcmp(key, "--json"))
    o->json = value;
  else if (!strcmp(key, "--law"))
    o->law = value;
  else if (!strcmp(key, "--simd"))
    o->simd = value;
  else if (!strcmp(key, "--search"))
    o->search = value;
  else if (!strcmp(key, "--box"))
    return number(value, 1e-9, 1e9, &o->box);
  else if (!strcmp(key, "--dt"))
    return number(value, 1e-15, 1, &o->dt);
  else if (!strcmp(key, "--skin"))
    return number(value, 1e-12, 1e9, &o->skin);
  else if (!strcmp(key, "--particles") && number(value, 1, 1e8, &x))
    o->particles = (int)x;
  else if (!strcmp(key, "--steps") && number(value, 1, 1e12, &x))
    o->steps = (long)x;
  else if (!strcmp(key, "--threads") && number(value, 1, 1024, &x))
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

static tdm_status read_bed(bed *b, const char *name, tdm_error *err) {
  FILE *f = fopen(name, "r");
  if (!f)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "\"%s\" cannot be read: %s", name, strerror(errno));
  char line[512];
  int room = 0;
  for (long at = 1; !err->status && fgets(line, sizeof line, f); at++) {
    char *comment = strchr(line, '#');
    if (comment)
      *comment = 0;
    if (!line[strspn(line, " \t\r\n")])
      continue;
    ball s;
    if (sscanf(line, "%lf %lf %lf %lf", &s.position.x, &s.position.y, &s.position.z, &s.radius) != 4 ||
        !tdm_finite(&s.position.x, 3) || !(s.radius > 0 && isfinite(s.radius))) {
      tdm_fail(err, TDM_ERR_FILE, NULL, "\"%s\", line %ld: not \"x y z r\" with a radius greater than 0", name, at);
      break;
    }
    if (b->n == room) {
      room = 2 * room + 1024;
      ball *grown = realloc(b->ball, (size_t)room * sizeof *grown);
      if (!grown) {
        tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %d particles", room);
        break;
      }
      b->ball = grown;
    }
    b->ball[b->n++] = s;
  }
  fclose(f);
  if (!err->status && b->n == 0)
    tdm_fail(err, TDM_ERR_FILE, NULL, "\"%s\" has no particles; lines are \"x y z r\"", name);
  return err->status;
}

/* the law's other families, and what they and the linear laws ask of the pair */
static void add_coefficients(json_t *scene, const char *normal, const char *tangential, const char *rolling,
                             const char *cohesion) {
  json_t *contact = json_object_get(scene, "contact"), *pair = json_array_get(json_object_get(scene, "pairs"), 0);
  if (rolling[0])
    json_object_set_new(contact, "rolling", json_string(rolling));
  if (cohesion[0])
    json_object_set_new(contact, "cohesion", json_string(cohesion));
  if (!strcmp(normal, "hooke") || !strcmp(normal, "hysteretic"))
    json_object_set_new(pair, "stiffness", json_real(1e4));
  if (!strcmp(tangential, "spring"))
    json_object_set_new(pair, "tangential_stiffness", json_real(3e3));
  if (!strcmp(tangential, "viscous"))
    json_object_set_new(pair, "tangential_damping", json_real(0.1));
  if (rolling[0] && strcmp(rolling, "none"))
    json_object_set_new(pair, "rolling_friction", json_real(0.1));
  if (!strcmp(cohesion, "sjkr"))
    json_object_set_new(pair, "cohesion_density", json_real(1e3));
  if (!strcmp(cohesion, "jkr"))
    json_object_set_new(pair, "adhesion_energy", json_real(0.1));
}

/* The floor and four walls of side L with the material of the peers' bed, no particles. */
static json_t *box_scene(const options *o, double skin) {
  char normal[64] = "hertz", tangential[64] = "mindlin", rolling[64] = "", cohesion[64] = "";
  if (o->law) {
    tangential[0] = 0;
    sscanf(o->law, "%63[^/]/%63[^/]/%63[^/]/%63[^/]", normal, tangential, rolling, cohesion);
  }
  json_t *s = json_pack("{s:[f,f,f], s:[{s:s, s:f, s:f, s:f}], s:[{s:[s,s], s:f, s:f}], s:{s:s, s:s}, s:f}", "gravity",
                        0.0, 0.0, -9.81, "materials", "name", "a", "density", 2500.0, "young_modulus", 1e7,
                        "poisson_ratio", 0.3, "pairs", "materials", "a", "a", "restitution", 0.5, "friction", 0.5,
                        "contact", "normal", normal, "tangential", tangential[0] ? tangential : "none", "skin", skin);
  json_object_set_new(s, "bodies",
                      json_pack("[{s:s, s:s, s:[{s:s, s:s, s:[f,f,f], s:[f,f,f], s:[s]}]}]", "name", "box", "material",
                                "a", "shapes", "type", "box", "side", "inside", "size", o->box, o->box, 1e3, "center",
                                0.5 * o->box, 0.5 * o->box, 500.0, "open", "+z"));
  add_coefficients(s, normal, tangential, rolling, cohesion);
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

static tdm_status engine_create(engine *e, const options *o, const bed *b, tdm_error *err) {
  double mean = 0;
  for (int i = 0; i < b->n; i++)
    mean += b->ball[i].radius / b->n;
  tdm_assignment assignment = {.scene = box_scene(o, o->skin > 0 ? o->skin : 0.1 * mean), .dt = o->dt, .n = 1};
  tdm_status status = dem_model_load(&e->model, &assignment, err);
  json_decref(assignment.scene);
  if (status)
    return status;
  e->data = dem_data_create(e->model);
  bool good = e->data && dem_data_reserve(e->data, b->n);
  for (int i = 0; good && i < b->n; i++) {
    double r = b->ball[i].radius;
    good = dem_data_add(e->data, &(dem_newcomer){.position = b->ball[i].position,
                                                 .radius = r,
                                                 .mass = e->model->material[0].density * 4.0 / 3 * M_PI * r * r * r});
  }
  if (!good)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %d particles", b->n);
  e->data->nthread = o->threads;
  if (!dem_forces_now(e->data, false))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the neighbour lists");
  return TDM_OK;
}

static double kinetic_energy(const dem_data *d) {
  double sum = 0;
  for (int i = 0; i < d->nparticle; i++) {
    double inertia = 0.4 * d->mass[i] * d->sphere[i].radius * d->sphere[i].radius;
    sum += 0.5 * d->mass[i] * tdm_dot(d->pace[i].velocity, d->pace[i].velocity);
    sum += 0.5 * inertia * tdm_dot(d->pace[i].spin, d->pace[i].spin);
  }
  return sum;
}

/* N spheres of 5 mm on a loose lattice, each a little off its place */
static tdm_status lattice(bed *b, int n, double box, tdm_error *err) {
  const double r = 0.005, pitch = 2.1 * r;
  int side = (int)(box / pitch);
  b->ball = malloc((size_t)n * sizeof *b->ball);
  if (!b->ball)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %d particles", n);
  if (side < 1)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "--box %g m has no room for particles of 5 mm", box);
  uint64_t draw = 1;
  double off[3];
  for (b->n = 0; b->n < n; b->n++) {
    for (int a = 0; a < 3; a++) {
      draw = draw * 6364136223846793005u + 1442695040888963407u;
      off[a] = ((double)(draw >> 11) * 0x1p-53 - 0.5) * (pitch - 2 * r);
    }
    int k = b->n, layer = k / (side * side), row = k / side % side, at = k % side;
    double gap = box / side;
    b->ball[k] =
        (ball){tdm_v3((at + 0.5) * gap + off[0], (row + 0.5) * gap + off[1], (layer + 0.6) * pitch + off[2]), r};
  }
  return TDM_OK;
}

/* let the bed fall, with a drag that leaves it at rest */
static tdm_status settle(bed *b, const options *o, tdm_error *err) {
  engine e = {0};
  double height = 0, drag = exp(-10 * o->dt);
  if (engine_create(&e, o, b, err) == TDM_OK) {
    for (int i = 0; i < b->n; i++)
      height = fmax(height, b->ball[i].position.z);
    double mass = e.data->mass[0] * b->n, quiet = 1e-9 * mass * 9.81 * 0.005;
    long most = (long)((1 + 8 * sqrt(2 * height / 9.81)) / o->dt);
    for (long k = 1; k <= most; k++) {
      if (!dem_step(e.data, NULL, 0, 1, false, o->dt)) {
        tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the neighbour lists");
        break;
      }
      for (int i = 0; i < b->n && drag < 1; i++) {
        e.data->pace[i].velocity = tdm_scale(drag, e.data->pace[i].velocity);
        e.data->pace[i].spin = tdm_scale(drag, e.data->pace[i].spin);
      }
      if (k % 100 == 0 && (double)k * o->dt > 0.1 && kinetic_energy(e.data) < quiet)
        break;
    }
    for (int i = 0; i < b->n; i++) {
      ball *s = &b->ball[e.data->id[i]];
      s->position = e.data->sphere[i].position;
    }
  }
  engine_destroy(&e);
  return err->status;
}

/* the cache's file of a made bed; false: there is no cache folder */
static bool cache_name(char name[PATH_MAX], const options *o) {
  const char *cache = getenv("XDG_CACHE_HOME"), *home = getenv("HOME");
  char folder[PATH_MAX / 2];
  if (cache && cache[0])
    snprintf(folder, sizeof folder, "%s", cache);
  else if (home && home[0])
    snprintf(folder, sizeof folder, "%s/.cache", home);
  else
    return false;
  mkdir(folder, 0755);
  strncat(folder, "/tandem", sizeof folder - strlen(folder) - 1);
  mkdir(folder, 0755);
  snprintf(name, PATH_MAX, "%s/bed_%d_%.6g.txt", folder, o->particles, o->box);
  return access(folder, W_OK) == 0;
}

/* beside it first, then renamed; failing costs only time */
static void keep_bed(const bed *b, const char *name) {
  char temporary[PATH_MAX + 32];
  snprintf(temporary, sizeof temporary, "%s.%ld", name, (long)getpid());
  FILE *f = fopen(temporary, "w");
  if (!f)
    return;
  fprintf(f, "# settled bed: x y z r [m]\n");
  for (int i = 0; i < b->n; i++) {
    tdm_vec3 x = b->ball[i].position;
    fprintf(f, "%.9g %.9g %.9g %.9g\n", x.x, x.y, x.z, b->ball[i].radius);
  }
  if (fclose(f) != 0 || rename(temporary, name) != 0)
    remove(temporary);
}

static tdm_status make_bed(bed *b, const options *o, tdm_error *err) {
  char name[PATH_MAX];
  bool cache = cache_name(name, o);
  if (cache && access(name, R_OK) == 0 && read_bed(b, name, err) == TDM_OK && b->n == o->particles)
    return TDM_OK;
  *err = (tdm_error){0};
  free(b->ball);
  *b = (bed){0};
  fprintf(stderr, "settling %d particles\n", o->particles);
  options plain = *o;
  plain.law = NULL;
  plain.dt = 8.6e-5;
  if (lattice(b, o->particles, o->box, err) || settle(b, &plain, err))
    return err->status;
  if (cache)
    keep_bed(b, name);
  return TDM_OK;
}

/* ---- measuring ---- */

static tdm_status run_steps(dem_data *d, const options *o, long n, tdm_error *err) {
  for (long k = 0; k < n; k++) {
    if (o->frozen)
      dem_forces_again(d, false, o->dt);
    else if (!dem_step(d, NULL, 0, 1, false, o->dt))
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the neighbour lists");
  }
  return TDM_OK;
}

/* Largest difference of a force or of a torque by the radius against every pair looked at, one contact at a time, as a
 * share of the largest force. NAN: too many particles, or no memory. */
static double force_error(dem_data *d) {
  if (d->nparticle > 20000)
    return NAN;
  dem_model plain = *d->model;
  plain.simd = "plain";
  plain.law = dem_law_find("plain", plain.law->normal, plain.law->tangential, plain.law->more);
  dem_data *all = dem_data_create(d->model);
  double worst = 0, largest = 0;
  bool good = all && dem_data_copy(all, d);
  if (good) {
    all->model = &plain;
    dem_search_destroy(&all->search);
    all->search = dem_search_create("all");
    good = all->search && dem_forces_now(all, false);
  }
  dem_forces_again(d, false, 0);
  for (int i = 0; good && i < d->nparticle; i++) {
    largest = fmax(largest, tdm_norm(all->push[i].force));
    worst = fmax(worst, tdm_norm(tdm_sub(all->push[i].force, d->push[i].force)));
    worst = fmax(worst, tdm_norm(tdm_sub(all->push[i].twist, d->push[i].twist)));
  }
  if (all)
    all->model = d->model;
  dem_data_destroy(&all);
  return good ? (largest > 0 ? worst / largest : worst) : NAN;
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

static tdm_status measure(const options *o, const bed *b, json_t **out, tdm_error *err) {
  engine e = {0};
  if (engine_create(&e, o, b, err) || run_steps(e.data, o, (o->steps + 9) / 10, err)) {
    engine_destroy(&e);
    return err->status;
  }
  dem_data *d = e.data;
  uint64_t rebuilds = d->nrebuild;
  double cpu = cpu_clock(), wall = tdm_clock();
  if (run_steps(d, o, o->steps, err) == TDM_OK) {
    wall = tdm_clock() - wall;
    cpu = cpu_clock() - cpu;
    long rss = peak_memory(), listed = 0;
    for (size_t k = 0; k < d->pairs.count; k++)
      listed += d->pairs.other[k] < d->nparticle;
    double n = d->nparticle, energy = kinetic_energy(d);
    char law[128];
    snprintf(law, sizeof law, "%s/%s/%s/%s", dem_normals[e.model->law->normal].name,
             dem_tangentials[e.model->law->tangential].name, dem_rollings[e.model->rolling].name,
             dem_cohesions[e.model->cohesion].name);
    *out = json_pack("{s:i, s:I, s:i, s:s, s:s, s:f, s:f, s:f, s:f, s:f, s:I, s:I, s:f}", "particles", d->nparticle,
                     "steps", (json_int_t)o->steps, "threads", d->nthread, "law", law, "simd", e.model->simd, "cpu_s",
                     cpu, "wall_s", wall, "particle_steps_per_s", n * (double)o->steps / wall, "coordination",
                     2 * (double)d->ncontact / n, "pairs_per_particle", (double)listed / n, "rebuilds",
                     (json_int_t)(d->nrebuild - rebuilds), "rss_bytes", (json_int_t)rss, "kinetic_energy", energy);
    double error = force_error(d);
    json_object_set_new(*out, "force_error", isfinite(error) ? json_real(error) : json_null());
  }
  engine_destroy(&e);
  return err->status;
}

int dem_bench_main(int argc, char **argv) {
  options o = {.particles = 10000, .threads = 1, .dt = 8.6e-5};
  tdm_error err = {0};
  bed b = {0};
  json_t *out = NULL;
  if (argc > 0 && (!strcmp(argv[0], "--help") || !strcmp(argv[0], "-h"))) {
    fputs(usage, stdout);
    return EXIT_SUCCESS;
  }
  if (!read_options(&o, argc, argv))
    return EXIT_FAILURE;
  if (o.bed) {
    read_bed(&b, o.bed, &err);
    for (int i = 0; i < b.n && !(o.box > 0 && i == 0); i++) /* the smallest square that holds them */
      o.box = fmax(o.box, fmax(b.ball[i].position.x, b.ball[i].position.y) + b.ball[i].radius);
  } else {
    o.box = o.box > 0 ? o.box : 0.01 * cbrt(o.particles);
    make_bed(&b, &o, &err);
  }
  if (o.steps == 0)
    o.steps = (long)fmax(100, 2e7 / fmax(1, b.n));
  if (!err.status)
    measure(&o, &b, &out, &err);
  free(b.ball);
  if (err.status) {
    fprintf(stderr, "tandem-dem bench: %s%s%s\n", err.path, err.path[0] ? ": " : "", err.message);
    return EXIT_FAILURE;
  }
  char *text = json_dumps(out, JSON_INDENT(2) | JSON_REAL_PRECISION(6));
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
