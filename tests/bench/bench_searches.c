/* [A07] Fig. 2.17 on the scene of Fig. 2.16, scenarios/dem/showers: what a step costs with each search, over the number
 * of discs, and the shares of forces, lists and integration. Prints a table that gnuplot reads. Not a test.
 *
 *   bench_searches SCENE [STEPS [NUMBER ...]]
 *
 * The mixture and the filled share of the container stay, so its radius goes with the root of the number. A run with
 * the engine's own search leads to the moment at which the discs splash up the wall (0.6 s in the scene's own size);
 * from there each search goes on for 15 rounds of STEPS steps (400), on one thread. Times are medians of the rounds: of
 * a step in processor time, of its phases (for the shares) by the engine's timers.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/particles/create.h"
#include "dem/scene/scene.h"
#include "dem/state/data.h"
#include "dem/step/forces.h"
#include "dem/step/step.h"
#include "dem/store/state_file.h"

#include <gsl/gsl_statistics_double.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { ROUNDS = 15, WARM = 40, IN_SCENE = 4336 };
static const double looked_at = 0.6;        /* [s] */
static const double to_there = 4e-5;        /* step on the way to it [s] */
static const double run_steps = 4.0 / 1e-5; /* of [A07]'s run */

typedef struct {
  json_t *scene; /* its section dem */
  dem_model *model;
  dem_data *data;
  tdm_error err;
} engine;

/* ---- the scene in another size ---- */

static json_t *at(json_t *json, const char *key) {
  return json_is_array(json) ? json_object_get(json_array_get(json, 0), key) : json_object_get(json, key);
}

/* `number` discs of the scene's mixture in as many cells, in a container of the same filling */
static json_t *resized(const json_t *dem, int number, const char *search) {
  json_t *json = json_deep_copy(dem), *fill = json_array_get(at(json, "particles"), 0);
  json_t *shape = json_array_get(at(at(json, "bodies"), "shapes"), 0), *counts = at(at(fill, "radius"), "counts");
  const double share = (double)number / IN_SCENE, half = 0.02 * ceil(sqrt(number));
  int left = number;
  for (size_t k = json_array_size(counts); k-- > 0;) {
    int n = k ? (int)(share * json_number_value(json_array_get(counts, k)) + 0.5) : left;
    json_array_set_new(counts, k, json_integer(n));
    left -= n;
  }
  json_object_set_new(shape, "radius", json_real(sqrt(share) * json_number_value(at(shape, "radius"))));
  json_object_set_new(fill, "region",
                      json_pack("{s:[f,f,f], s:[f,f,f]}", "min", -half, -0.02, -half, "max", half, 0.02, half));
  json_object_set_new(fill, "count", json_integer(number));
  json_object_set_new(json, "threads", json_integer(1));
  json_object_set_new(json, "search", json_string(search));
  json_object_set_new(json, "guard", json_pack("{s:i}", "every", 0));
  return json;
}

/* ---- runs ---- */

static bool begin(engine *e, const json_t *dem, int number, const char *search, double dt) {
  *e = (engine){.scene = resized(dem, number, search)};
  tdm_assignment assignment = {.scene = e->scene, .dt = dt, .n = 1};
  if (dem_model_read(&e->model, &assignment, &e->err) != TDM_OK)
    return false;
  e->data = dem_data_create(e->model);
  return e->data && dem_forces_begin(e->data, &e->err) == TDM_OK;
}

static bool go(engine *e, long steps) {
  for (long k = 0; k < steps && !e->err.status; k++)
    dem_step(e->data, &(dem_step_task){.dt = e->model->dt}, &e->err);
  return !e->err.status;
}

/* The engine ends; why it failed is told. */
static bool end(engine *e, bool good) {
  if (!good)
    fprintf(stderr, "%s: %s\n", e->err.path, e->err.message);
  dem_data_destroy(&e->data);
  dem_model_destroy(&e->model);
  json_decref(e->scene);
  return good;
}

static double processor_time(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Medians of the rounds [s]: of a step, and of its phases. */
typedef struct {
  double step[ROUNDS], phase[DEM_PHASES][ROUNDS];
} rounds;

static bool take(engine *e, long steps, int round, rounds *r) {
  dem_timers timers = {.mark = tdm_clock()};
  e->data->work.timers = &timers;
  double start = processor_time();
  bool good = go(e, steps);
  r->step[round] = (processor_time() - start) / (double)steps;
  for (int k = 0; k < DEM_PHASES; k++)
    r->phase[k][round] = timers.spent[k];
  e->data->work.timers = NULL;
  return good;
}

static void print(const char *search, const dem_data *d, rounds *r) {
  double all = 0, phase[DEM_PHASES], step = gsl_stats_median(r->step, 1, ROUNDS);
  for (int k = 0; k < DEM_PHASES; k++)
    all += phase[k] = gsl_stats_median(r->phase[k], 1, ROUNDS);
  int n = d->state.nparticle;
  printf("%-14s %6d %8.1f %9.1f", search, n, 1e9 * step / n, run_steps * step);
  for (int k = 0; k < DEM_PHASES; k++)
    printf(" %11.1f", 100 * phase[k] / all);
  printf(" %12.1f\n", (double)d->lists.pairs.count / n);
  fflush(stdout);
}

/* go on from a state with this search */
static bool measure(const json_t *dem, int number, const char *search, long steps, const void *state, size_t size) {
  engine e;
  rounds r;
  bool good = begin(&e, dem, number, search, 1e-5);
  double skin = good ? e.data->lists.skin : 0;
  good = good && dem_state_load(e.data, state, size, &e.err) == TDM_OK;
  if (good)
    e.data->lists.skin = skin; /* the state has that of the search which led to it */
  good = good && go(&e, WARM);
  for (int k = 0; k < ROUNDS && good; k++)
    good = take(&e, steps, k, &r);
  if (good)
    print(search, e.data, &r);
  return end(&e, good);
}

static bool compare(const json_t *dem, int number, long steps) {
  static const char *const searches[] = {"verlet-1967", "linked-linear", "sweep", "auto"};
  engine e;
  void *state = NULL;
  size_t size = 0;
  bool good = begin(&e, dem, number, "auto", to_there) &&
              go(&e, (long)(looked_at * sqrt((double)number / IN_SCENE) / to_there)) &&
              dem_state_save(e.data, &state, &size) == TDM_OK;
  good = end(&e, good);
  for (int s = 0; s < 4 && good; s++)
    good = measure(dem, number, searches[s], steps, state, size);
  free(state);
  return good;
}

int main(int argc, char **argv) {
  static const int numbers[] = {250, 500, 1000, 2000, 4336, 8000, 16000};
  json_t *scene = argc > 1 ? json_load_file(argv[1], 0, NULL) : NULL;
  long steps = argc > 2 ? atol(argv[2]) : 400;
  if (!scene || steps < 1) {
    fprintf(stderr, "bench_searches SCENE [STEPS [NUMBER ...]], with scenarios/dem/showers/scene.json\n");
    return EXIT_FAILURE;
  }
  printf("# search        discs ns/step,disc s/run");
#define X(phase, name) printf(" %10s%%", name);
  DEM_PHASE_LIST(X)
#undef X
  printf(" listed/disc\n");
  bool good = true;
  for (int k = 0; k < (argc > 3 ? argc - 3 : 7) && good; k++)
    good = compare(json_object_get(scene, "dem"), argc > 3 ? atoi(argv[k + 3]) : numbers[k], steps);
  json_decref(scene);
  return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
