/* What contacts that act on each other cost: the beds of [G21] Table 2 pressed together (514 hydrogel balls, 514 rubber
 * balls, 17 glass beads), with the classical law, mc-stress and mc-strain, step by step in turns, so that all have the
 * same machine.
 *
 * usage: bench_multi [all-terms] [BED|SCENE [STEPS [PATH=VALUE ...]]]
 * BED: hydrogel, rubber, glass; without it all of them. STEPS: of the plate's way down, which a bed does in so many.
 * all-terms: with energies, so that the loops of all laws have all terms. PATH=VALUE: of the scene, as with --set.
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

enum { LAWS = 6, TURN = 100, SETTINGS = 12 };

typedef struct {
  const char *name, *file;
  const char *set[SETTINGS]; /* "path=value", NULL-terminated */
  double dt, beta, gamma;
  double paper[2]; /* mc-stress, mc-strain: time over classical, [G21] Table 2; 0: not said */
} bed;

#define SCENES TANDEM_SOURCE_DIR "/scenarios/multicontact/"
static const bed beds[] = {
    {"hydrogel", SCENES "hydrogel.json", {NULL}, 1e-4, 1.65, 1.12, {216.0 / 38, 668.0 / 38}},
    {"rubber",
     SCENES "hydrogel.json",
     {"parameters.strain=0.28", "dem.materials[0].density=2000", "dem.materials[0].young_modulus=1.85e6",
      "dem.materials[0].poisson_ratio=0.46", "dem.pairs[0].restitution=0.7", "dem.pairs[0].friction=0.5", NULL},
     5e-5,
     1.71,
     0.55,
     {538.0 / 84, 1568.0 / 84}},
    {"glass", SCENES "glass.json", {NULL}, 2e-7, 5.17, 4.5, {29.0 / 22, 45.0 / 22}},
};
enum { BEDS = sizeof beds / sizeof *beds };

typedef struct {
  const char *name, *contact;
  bool strain; /* gamma instead of beta */
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

/* the scene's section "dem" with a law */
static void open_run(run *r, const bed *of, const json_t *scene, bool all_terms) {
  tdm_error err = {0};
  json_t *dem = json_deep_copy(json_object_get(scene, "dem"));
  json_t *pair = json_array_get(json_object_get(dem, "pairs"), 0), *contact = json_loads(r->contact, 0, NULL);
  json_object_del(pair, "beta");
  if (json_object_size(contact) > 0)
    json_object_set_new(pair, r->strain ? "gamma" : "beta", json_real(r->strain ? of->gamma : of->beta));
  json_object_set_new(dem, "contact", contact);
  if (all_terms)
    json_object_set_new(dem, "energy", json_true());
  const double dt = json_number_value(json_object_get(json_object_get(scene, "time"), "dt"));
  const tdm_assignment assignment = {.scene = dem, .time_end = 100, .dt = dt, .n = 1};
  if (dem_model_read(&r->model, &assignment, &err))
    stop(&err);
  r->data = dem_data_create(r->model);
  if (!r->data || dem_forces_begin(r->data, &err))
    stop(&err);
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

/* times of a bed, a line a law */
static void measure(const bed *of, long steps, bool all_terms, const char *const *more) {
  run runs[LAWS] = {
      {"classical", "{}", false, NULL, NULL, 0, 0},
      {"mc-stress", "{\"multi_contact\": \"mc-stress\"}", false, NULL, NULL, 0, 0},
      {"mc-strain", "{\"multi_contact\": \"mc-strain\"}", true, NULL, NULL, 0, 0},
      {"mc-strain, first_forces hertz", "{\"multi_contact\": \"mc-strain\", \"first_forces\": \"hertz\"}", true, NULL,
       NULL, 0, 0},
      {"mc-strain, 3 iterations", "{\"multi_contact\": \"mc-strain\", \"iterations\": 3}", true, NULL, NULL, 0, 0},
      {"mc-strain, tolerance 1e-3", "{\"multi_contact\": \"mc-strain\", \"tolerance\": 1e-3}", true, NULL, NULL, 0, 0},
  };
  char dt[64], stroke[64];
  const char *set[2 * SETTINGS] = {dt, stroke};
  int n = of->dt > 0 ? 2 : 0;
  tdm_scene scene = {0};
  tdm_error err = {0};
  snprintf(dt, sizeof dt, "time.dt=%.17g", of->dt);
  snprintf(stroke, sizeof stroke, "parameters.stroke=%.17g", of->dt * (double)steps);
  for (int k = 0; of->set[k]; k++)
    set[n++] = of->set[k];
  for (int k = 0; more && more[k] && n + 1 < 2 * SETTINGS; k++)
    set[n++] = more[k];
  set[n] = NULL;
  if (tdm_scene_load(&scene, of->file, set, &err))
    stop(&err);
  for (int k = 0; k < LAWS; k++)
    open_run(&runs[k], of, scene.root, all_terms);
  for (long step = 0; step < steps; step += TURN)
    for (int k = 0; k < LAWS; k++)
      take_turn(&runs[k], step);
  for (int k = 0; k < LAWS; k++) {
    printf("%-9s %-30s %8.3f us a step, %5.2f times classical", of->name, runs[k].name,
           1e6 * runs[k].seconds / (double)steps, runs[k].seconds / runs[0].seconds);
    if ((k == 1 || k == 2) && of->paper[k - 1] > 0)
      printf(" ([G21]: %.1f)", of->paper[k - 1]);
    printf("; %d contacts at the end, largest force %.4g N, %s\n", (int)runs[k].data->state.ncontact, runs[k].force,
           runs[k].model->simd);
    dem_data_destroy(&runs[k].data);
    dem_model_destroy(&runs[k].model);
  }
  tdm_scene_destroy(&scene);
}

int main(int argc, char **argv) {
  const bool all_terms = argc > 1 && strcmp(argv[1], "all-terms") == 0;
  const char *const *words = (const char *const *)argv + 1 + all_terms;
  const long steps = words[0] && words[1] ? atol(words[1]) : 20000;
  bool known = false;
  for (int k = 0; k < BEDS; k++)
    if (!words[0] || strcmp(words[0], beds[k].name) == 0) {
      measure(&beds[k], steps, all_terms, words[0] && words[1] ? words + 2 : NULL);
      known = true;
    }
  if (!known)
    measure(&(bed){.name = "scene", .file = words[0], .beta = 1.65, .gamma = 1.12}, steps, all_terms,
            words[1] ? words + 2 : NULL);
  return 0;
}
