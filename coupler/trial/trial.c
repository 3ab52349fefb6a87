/* Trials: see trial.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE /* asprintf */
#include "coupler/trial/trial.h"

#include "coupler/observe/observers.h"
#include "protocol/parameters/load.h"
#include "protocol/results/results.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- a run ---- */

enum { OWN = 3 }; /* settings that a trial adds */

/* What its scene says of the bed and of outputs. */
typedef struct {
  bool settles; /* by tandem's own DEM, without a store */
  double interval;
} scene_facts;

static tdm_status look(const cpl_trial_options *o, scene_facts *facts, tdm_error *err) {
  tdm_scene scene = {0};
  if (tdm_scene_load(&scene, o->scene, o->set, err) == TDM_OK) {
    facts->settles = tdm_scene_value(scene.root, "dem.settle") && !tdm_scene_value(scene.root, "dem.settle.store") &&
                     !cpl_is_foreign(scene.root, CPL_DEM);
    const json_t *interval = tdm_scene_value(scene.root, "output.interval");
    facts->interval = json_is_number(interval) ? json_number_value(interval) : NAN;
  }
  tdm_scene_locate(&scene, err);
  tdm_scene_destroy(&scene);
  return err->status;
}

/* "path=value" of a trial's own, NULL-terminated: for it alone; freed by the caller. */
static int own_settings(const cpl_trial_options *o, const scene_facts *facts, char *own[OWN + 1]) {
  int n = 0, bad = 0;
  bad += asprintf(&own[n++], "time.end=%.17g", o->end) < 0;
  if (!isnan(facts->interval)) /* nothing is drawn */
    bad += asprintf(&own[n++], "output={\"interval\": %.17g}", facts->interval) < 0;
  if (facts->settles && o->bed)
    bad += asprintf(&own[n++], "dem.settle.store=%s", o->bed) < 0;
  own[n] = NULL;
  return bad ? -1 : n;
}

static tdm_status run(const cpl_trial_options *o, const char *const *set, cpl_trial *t, tdm_error *err) {
  tdm_error of_run = {0};
  cpl_run_options options = {.scene = o->scene, .set = set, .out = o->dir, .force = true, .quiet = true};
  memcpy(options.solver, o->solver, sizeof options.solver);
  t->status = cpl_run(&options, &t->run, &of_run);
  snprintf(t->reason, sizeof t->reason, "%s", of_run.message);
  t->summary = tdm_results_read(o->dir, "summary.json", &(tdm_error){0});
  if (t->status == TDM_ERR_INTERRUPTED || t->status == TDM_ERR_MEMORY)
    *err = of_run;
  return err->status;
}

tdm_status cpl_trial_run(const cpl_trial_options *o, cpl_trial *t, tdm_error *err) {
  scene_facts facts = {0};
  char *own[OWN + 1] = {NULL};
  int given = 0;
  *t = (cpl_trial){0};
  if (look(o, &facts, err) != TDM_OK || tdm_make_directory(o->dir, err) != TDM_OK)
    return err->status;
  while (o->set && o->set[given])
    given++;
  const int n = own_settings(o, &facts, own);
  const char **set = calloc((size_t)(given + OWN + 1), sizeof *set);
  if (n < 0 || !set)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  else {
    for (int k = 0; k < given; k++)
      set[k] = o->set[k];
    for (int k = 0; k < n; k++)
      set[given + k] = own[k];
    run(o, set, t, err);
  }
  free(set);
  for (int k = 0; k < OWN; k++)
    free(own[k]);
  return err->status;
}

void cpl_trial_free(cpl_trial *t) {
  json_decref(t->summary);
  *t = (cpl_trial){0};
}

/* ---- two runs ---- */

enum { AXES = 3 };
static const char *const columns[CPL_QUANTITIES][AXES] = {
    [CPL_POSITION] = {"x", "y", "z"}, [CPL_VELOCITY] = {"vx", "vy", "vz"}, [CPL_ANGULAR_VELOCITY] = {"wx", "wy", "wz"}};

static tdm_quat orientation(const double *const q[4], int row) {
  return (tdm_quat){q[0][row], q[1][row], q[2][row], q[3][row]};
}

/* The square of the difference of a quantity in a row; `of` NULL: of the first run to its own first row. */
typedef struct {
  const double *value[CPL_QUANTITIES][AXES], *turn[4];
} motion;

static bool columns_of(const cpl_table *t, motion *m, tdm_error *err) {
  static const char *const turn[4] = {"qw", "qx", "qy", "qz"};
  for (int q = 0; q < CPL_QUANTITIES; q++)
    for (int a = 0; q != CPL_ANGLE && a < AXES; a++)
      if (!(m->value[q][a] = cpl_table_column(t, columns[q][a], err)))
        return false;
  for (int k = 0; k < 4; k++)
    if (!(m->turn[k] = cpl_table_column(t, turn[k], err)))
      return false;
  return true;
}

/* a - b at these rows, (AXES) */
static tdm_vec3 difference(const motion *a, int row, const motion *b, int other, int quantity) {
  if (quantity == CPL_ANGLE)
    return tdm_quat_turn(orientation(b->turn, other), orientation(a->turn, row));
  const double *const *x = a->value[quantity], *const *y = b->value[quantity];
  return tdm_v3(x[0][row] - y[0][other], x[1][row] - y[1][other], x[2][row] - y[2][other]);
}

static void compare(const motion *a, const motion *b, int n, cpl_apart_runs *out) {
  for (int q = 0; q < CPL_QUANTITIES; q++) {
    double apart = 0, square = 0, quarter[4] = {0};
    tdm_vec3 mean = {0};
    for (int i = 0; i < n; i++) {
      const tdm_vec3 d = difference(b, i, a, i, q), from_start = difference(a, i, a, 0, q);
      apart += tdm_dot(d, d) / n;
      quarter[4 * i / n] += tdm_dot(d, d);
      mean = tdm_axpy(1. / n, from_start, mean);
      square += tdm_dot(from_start, from_start) / n;
    }
    out->rms[q] = sqrt(apart);
    out->spread[q] = sqrt(fmax(0, square - tdm_dot(mean, mean)));
    out->late[q] = quarter[2] > 0 ? sqrt(quarter[3] / quarter[2]) : NAN;
  }
}

tdm_status cpl_trial_compare(const char *dir, const char *other, const char *body, double end, cpl_apart_runs *apart,
                             tdm_error *err) {
  cpl_table table[2] = {{0}};
  motion of[2] = {0};
  int n = 0;
  *apart = (cpl_apart_runs){0};
  for (int k = 0; k < 2 && err->status == TDM_OK; k++) {
    char file[4608], name[256];
    snprintf(file, sizeof file, "%s/%s", k ? other : dir, cpl_record_body_file(body, name, sizeof name));
    if (cpl_table_read(&table[k], file, err) == TDM_OK)
      columns_of(&table[k], &of[k], err);
  }
  if (err->status == TDM_OK) {
    const double *a = cpl_table_column(&table[0], "time", err), *b = cpl_table_column(&table[1], "time", err);
    while (a && b && n < table[0].nrow && n < table[1].nrow && a[n] == b[n] && a[n] <= end)
      n++;
    apart->nrow = n;
    if (n >= 2)
      compare(&of[0], &of[1], n, apart);
  }
  for (int k = 0; k < 2; k++)
    cpl_table_free(&table[k]);
  return err->status;
}
