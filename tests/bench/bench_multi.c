/* What contacts that act on each other cost: 514 hydrogel balls pressed together ([G21] Section 4.1 and Table 2), or
 * another bed, with the classical law, mc-stress and mc-strain, step by step in turns, so that all three have the same
 * machine.
 *
 * usage: bench_multi [SCENE [STEPS [all-terms] [PATH=VALUE ...]]]   (scenarios/multicontact/hydrogel.json, 20000)
 * all-terms: with energies, so that the loops of all three have all terms. PATH=VALUE: of the scene, as with --set:
 * dem.materials[0].young_modulus=1.85e6
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/particles/create.h"
#include "dem/scene/scene.h"
#include "dem/settle/settle.h"
#include "dem/step/forces.h"
#include "dem/step/step.h"
#include "protocol/parameters/load.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { LAWS = 6, TURN = 100 };

typedef struct {
  const char *name, *contact, *pair;
  dem_model *model;
  dem_data *data;
  double seconds, force;
} run;

static void stop(const tdm_error *err) {
  fprintf(stderr, "bench_multi: %s: %s\n", err->path, err->message);
  exit(1);
}

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static json_t *object(const char *text) {
  json_t *json = json_loads(text, 0, NULL);
  if (!json)
    exit(1);
  return json;
}

/* the scene's section "dem" with a law */
static void open_run(run *r, const json_t *scene, double dt, bool all_terms) {
  tdm_error err = {0};
  json_t *dem = json_deep_copy(json_object_get(scene, "dem"));
  json_t *pair = json_array_get(json_object_get(dem, "pairs"), 0), *more = object(r->pair);
  json_object_del(pair, "beta");
  json_object_update(pair, more);
  json_object_set_new(dem, "contact", object(r->contact));
  if (all_terms)
    json_object_set_new(dem, "energy", json_true());
  const tdm_assignment assignment = {.scene = dem, .time_end = 100, .dt = dt, .n = 1};
  if (dem_model_read(&r->model, &assignment, &err))
    stop(&err);
  r->data = dem_data_create(r->model);
  if (!r->data || dem_forces_begin(r->data, &err))
    stop(&err);
  json_decref(more);
  json_decref(dem);
}

static void take_turn(run *r, long first) {
  tdm_error err = {0};
  double before = now();
  for (long k = 0; k < TURN; k++)
    if (dem_step(r->data, &(dem_step_task){.dt = r->model->dt, .time = (double)(first + k + 1) * r->model->dt}, &err))
      stop(&err);
  r->seconds += now() - before;
  r->force = fmax(r->force, r->data->state.body_load[0].force.z);
}

int main(int argc, char **argv) {
  run runs[LAWS] = {
      {"classical", "{}", "{}", NULL, NULL, 0, 0},
      {"mc-stress", "{\"multi_contact\": \"mc-stress\"}", "{\"beta\": 1.65}", NULL, NULL, 0, 0},
      {"mc-strain", "{\"multi_contact\": \"mc-strain\"}", "{\"gamma\": 1.12}", NULL, NULL, 0, 0},
      {"mc-strain, first_forces hertz", "{\"multi_contact\": \"mc-strain\", \"first_forces\": \"hertz\"}",
       "{\"gamma\": 1.12}", NULL, NULL, 0, 0},
      {"mc-strain, 3 iterations", "{\"multi_contact\": \"mc-strain\", \"iterations\": 3}", "{\"gamma\": 1.12}", NULL,
       NULL, 0, 0},
      {"mc-strain, tolerance 1e-3", "{\"multi_contact\": \"mc-strain\", \"tolerance\": 1e-3}", "{\"gamma\": 1.12}",
       NULL, NULL, 0, 0},
  };
  const char *file = argc > 1 ? argv[1] : TANDEM_SOURCE_DIR "/scenarios/multicontact/hydrogel.json";
  long steps = argc > 2 ? atol(argv[2]) : 20000;
  tdm_scene scene = {0};
  tdm_error err = {0};
  const bool all_terms = argc > 3 && strcmp(argv[3], "all-terms") == 0;
  const int first = all_terms ? 4 : 3;
  if (tdm_scene_load(&scene, file, argc > first ? (const char *const *)argv + first : NULL, &err))
    stop(&err);
  double dt = json_number_value(json_object_get(json_object_get(scene.root, "time"), "dt"));
  for (int k = 0; k < LAWS; k++)
    open_run(&runs[k], scene.root, dt, all_terms);
  for (long step = 0; step < steps; step += TURN)
    for (int k = 0; k < LAWS; k++)
      take_turn(&runs[k], step);
  for (int k = 0; k < LAWS; k++) {
    printf("%-30s %8.3f us a step, %5.2f times classical; %d contacts at the end, largest force %.4g N, %s\n",
           runs[k].name, 1e6 * runs[k].seconds / (double)steps, runs[k].seconds / runs[0].seconds,
           (int)runs[k].data->state.ncontact, runs[k].force, runs[k].model->simd);
    dem_data_destroy(&runs[k].data);
    dem_model_destroy(&runs[k].model);
  }
  tdm_scene_destroy(&scene);
  return 0;
}
