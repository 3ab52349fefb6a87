/* One cell: run it, compare it, decide whether it is ok, inexact, unstable or failed. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/cells/cells.h"

#include "coupler/results/table.h"
#include "coupler/scheme/schemes.h"
#include "protocol/base/log.h"
#include "protocol/results/results.h"
#include "protocol/scene/json.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double load_span = 0.02; /* [s] of the means of F_20ms */

/* The scene of a cell as it runs (the caller destroys it), and the scenario that it names. */
static const cpl_scenario *scene_of(const cpl_cells *cells, const cpl_cell *cell, tdm_scene *scene) {
  tdm_error err = {0};
  cpl_cell_scene(cell, scene, &err);
  return scene->root ? cpl_scenario_of(cells->scenarios, scene->root, &(tdm_error){0}) : NULL;
}

/* A copy of the value at a path, null when there is none. */
static json_t *value_at(const tdm_scene *scene, const char *path) {
  const json_t *value = tdm_scene_value_written_at(scene, path);
  return value ? json_deep_copy(value) : json_null();
}

/* The scheme that ran, which may be the fallback; without a run the scene's. */
static json_t *scheme_of(const cpl_cell *cell, const tdm_scene *scene) {
  json_t *summary = tdm_results_read(cell->dir, "summary.json", &(tdm_error){0});
  const char *ran = json_string_value(json_object_get(json_object_get(summary, "settings"), "coupling.scheme"));
  const char *wanted = json_string_value(tdm_scene_value(scene->root, "coupling.scheme"));
  json_t *scheme = json_string(ran && *ran ? ran : wanted ? wanted : cpl_schemes[0]->name);
  json_decref(summary);
  return scheme;
}

/* Its own settings with the values that the scene has. */
static json_t *settings_of(const cpl_cell *cell, const tdm_scene *scene) {
  json_t *settings = json_object();
  for (int k = 0; k < cell->nset; k++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "%.*s", (int)strcspn(cell->set[k], "="), cell->set[k]);
    json_object_set_new(settings, path, value_at(scene, path));
  }
  return settings;
}

/* What a row of a co-simulation has besides. */
static json_t *coupled_row(const cpl_cell *cell, const cpl_scenario *scenario, const tdm_scene *scene) {
  json_t *r2 = json_object(), *nse = json_object();
  for (int i = 0; scenario && i < 3 && scenario->state[i]; i++) {
    json_object_set_new(r2, scenario->state[i], json_null());
    json_object_set_new(nse, scenario->state[i], json_null());
  }
  if (scenario && scenario->load) {
    char mean[64];
    snprintf(mean, sizeof mean, "%s_20ms", scenario->load);
    json_object_set_new(r2, scenario->load, json_null());
    json_object_set_new(r2, mean, json_null());
  }
  return json_pack("{s:o, s:o, s:n, s:o, s:o, s:n, s:n, s:n}", "n", value_at(scene, "coupling.n"), "scheme",
                   scheme_of(cell, scene), "window_s", "r2", r2, "nse", nse, "energy_residual", "estimate",
                   "estimate_numeric");
}

json_t *cpl_cell_row(const cpl_cells *cells, const cpl_cell *cell, const char *status, const char *reason) {
  tdm_scene scene = {0};
  const cpl_scenario *scenario = scene_of(cells, cell, &scene);
  json_t *row = json_pack("{s:o, s:o, s:s, s:s, s:n, s:n}", "dt", value_at(&scene, "time.dt"), "settings",
                          settings_of(cell, &scene), "status", status, "reason", reason, "wall_s", "simulated_s");
  if (!cell->program)
    json_object_update_new(row, coupled_row(cell, scenario, &scene));
  tdm_scene_destroy(&scene);
  return row;
}

static void judge(json_t *row, const char *status, const char *reason) {
  json_object_set_new(row, "status", json_string(status));
  json_object_set_new(row, "reason", json_string(reason));
}

/* ---- what a run that came to its end may still have ---- */

/* The first time at which particles have left, or NAN. */
static double time_of_loss(const cpl_table *dem) {
  const double *time = cpl_table_column(dem, "time", NULL), *lost = cpl_table_column(dem, "particles.lost", NULL);
  for (int i = 0; time && lost && i < dem->nrow; i++)
    if (lost[i] > 0)
      return time[i];
  return NAN;
}

void cpl_cell_doubt(const cpl_cell *cell, json_t *row, const json_t *summary) {
  char file[4352], reason[160];
  cpl_table dem = {0};
  snprintf(file, sizeof file, "%s/%s", cell->dir, cell->program ? "channels.csv" : "dem.csv");
  cpl_table_read(&dem, file, NULL);
  double loss = time_of_loss(&dem);
  const json_t *gained = tdm_scene_value(summary, "ledger.gained_at_s");
  double growth = json_is_number(gained) ? json_number_value(gained) : NAN;
  if (!isnan(loss) && !(growth < loss)) {
    snprintf(reason, sizeof reason, "particles left at %.4g s", loss);
    judge(row, "unstable", reason);
  } else if (!isnan(growth)) {
    snprintf(reason, sizeof reason, "the energy grew without a source at %.4g s", growth);
    judge(row, "unstable", reason);
  } else if (json_is_true(tdm_scene_value(summary, "ledger.gained"))) {
    judge(row, "unstable", "the energy grew without a source, over less than three looks");
  } else if (json_is_true(tdm_scene_value(summary, "ledger.inexact"))) {
    snprintf(reason, sizeof reason, "the works of both sides differ by %.2g of what went through the interface",
             json_number_value(tdm_scene_value(summary, "ledger.residual_share")));
    judge(row, "inexact", reason);
  }
  cpl_table_free(&dem);
}

/* ---- numbers ---- */

static void add_numbers(json_t *row, const cpl_comparison *c) {
  json_t *r2 = json_object_get(row, "r2"), *nse = json_object_get(row, "nse");
  for (int i = 0; i < c->ncurve; i++) {
    const cpl_compared *curve = &c->curve[i];
    json_object_set_new(r2, curve->name, tdm_number_to_json(cpl_comparison_r2(c, curve)));
    if (curve->kind == CPL_STATE) {
      json_object_set_new(nse, curve->name, tdm_number_to_json(cpl_comparison_nse(c, curve)));
    } else {
      char name[64];
      snprintf(name, sizeof name, "%s_20ms", curve->name);
      json_object_set_new(r2, name, tdm_number_to_json(cpl_comparison_r2_mean(c, curve, load_span)));
    }
  }
}

/* The largest 1 - nse that the run expects of itself; `beside`: against a reference whose fill is rigid. NaN: unknown.
 */
static double expected(const json_t *summary, bool beside) {
  const char *name, *key;
  json_t *body, *of;
  double worst = NAN;
  json_object_foreach((json_t *)tdm_scene_value(summary, "error_estimate.bodies"), name, body)
      json_object_foreach(body, key, of) {
    const json_t *share = json_object_get(of, "share");
    const double spread = json_number_value(json_object_get(of, "spread"));
    const double fill = beside ? json_number_value(json_object_get(of, "fill")) / spread : 0;
    const double error = json_number_value(share) * json_number_value(share) + fill * fill;
    if (json_is_number(share) && !(error <= worst))
      worst = error;
  }
  return worst;
}

json_t *cpl_cell_run(const cpl_cells *cells, const cpl_cell *cell) {
  tdm_error err = {0};
  cpl_run_result result;
  cpl_run_options run = {
      .scene = cell->scene, .set = (const char *const *)cell->set, .out = cell->dir, .force = true, .quiet = true};
  memcpy(run.solver, cells->solver, sizeof run.solver);
  tdm_status status = cpl_run(&run, &result, &err);
  if (status == TDM_ERR_INTERRUPTED)
    return NULL;
  json_t *row = cpl_cell_row(cells, cell,
                             status == TDM_OK            ? "ok"
                             : status == TDM_ERR_NUMERIC ? "unstable"
                                                         : "failed",
                             err.message);
  json_object_set_new(row, "ended", json_string(tdm_status_name(status)));
  tdm_scene scene = {0};
  const cpl_scenario *scenario = scene_of(cells, cell, &scene);
  json_object_set_new(row, "wall_s", json_real(result.wall)); /* also of a failed cell: it was tried */
  json_object_set_new(row, "simulated_s", json_real(result.simulated));
  if (result.windows > 0 && (status == TDM_OK || status == TDM_ERR_NUMERIC)) {
    json_t *summary = tdm_results_read(cell->dir, "summary.json", &(tdm_error){0});
    const json_t *residual = tdm_scene_value(summary, "ledger.energy_residual");
    cpl_cell_doubt(cell, row, summary);
    json_object_set_new(row, "energy_residual", residual ? json_copy((json_t *)residual) : json_null());
    json_object_set_new(row, "window_s", json_real((result.loop - result.step[CPL_DEM]) / (double)result.windows));
    json_object_set_new(row, "estimate", tdm_number_to_json(expected(summary, scenario && scenario->rigid_fill)));
    json_object_set_new(row, "estimate_numeric", tdm_number_to_json(expected(summary, false)));
    json_decref(summary);
  }
  cpl_comparison c = {0};
  tdm_error compared = {0};
  if (scenario && scenario->compare && result.windows > 0 && scenario->compare(cell->dir, &c, &compared) == TDM_OK) {
    cpl_comparison_write(&c, cell->dir, &compared);
    cpl_comparison_plot(&c, cell->dir, &compared);
    if (status == TDM_OK) /* numbers over a part of the run would not compare */
      add_numbers(row, &c);
  }
  cpl_comparison_free(&c);
  tdm_scene_destroy(&scene);
  return row;
}
