/* `tandem sweep` of a study: its file, or the same from options. See sweep.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/sweep/sweep.h"

#include "coupler/study/study.h"
#include "protocol/results/results.h"

#include <stdlib.h>
#include <string.h>

/* ---- a study from options ---- */

static json_t *options_to_json(const cpl_sweep_options *o) {
  json_t *axes = json_array(), *measures = json_array(), *study = json_pack("{s:s}", "scene", o->scene);
  for (int a = 0; a < o->naxis; a++)
    json_array_append_new(axes, cpl_axis_to_json(&o->axis[a]));
  for (int m = 0; m < o->nmeasure; m++)
    json_array_append_new(measures, cpl_measure_to_json(o->measure[m]));
  if (o->naxis > 0)
    json_object_set(study, "axes", axes);
  if (o->nmeasure > 0)
    json_object_set(study, "measures", measures);
  if (o->repeat.nvalue > 0)
    json_object_set_new(study, "seeds", cpl_axis_to_json(&o->repeat));
  json_decref(axes);
  json_decref(measures);
  return study;
}

/* ---- running it ---- */

/* Into a directory that is open. */
static tdm_status run_study(const cpl_sweep_options *o, const cpl_study_options *options, cpl_study *study,
                            tdm_error *err) {
  cpl_study_run(study, options, err);
  if (err->status != TDM_OK && err->status != TDM_ERR_INTERRUPTED)
    return err->status;
  tdm_error late = {0};
  cpl_study_print(study);
  if (cpl_study_write(study, o->out, o->json, &late) != TDM_OK)
    tdm_fail(err, late.status, NULL, "%s", late.message);
  printf("study.json, study.csv, plots and the runs' directories in %s (table.html shows them)\n", o->out);
  return err->status;
}

tdm_status cpl_sweep_study(const cpl_sweep_options *o, tdm_error *err) {
  cpl_study study = {0};
  tdm_results results;
  const tdm_results_def def = {
      .dir = o->out, .force = o->force, .beside = o->resume, .instead = "go on with it with --resume, "};
  const char *seeds[CPL_VALUES_MAX + 1] = {NULL};
  cpl_study_options options = {.out = o->out,
                               .jobs = o->jobs,
                               .resume = o->resume,
                               .scenarios = o->scenarios,
                               .set = o->set,
                               .only = o->only,
                               .seeds = o->seeds.nvalue > 0 ? seeds : NULL};
  memcpy(options.solver, o->solver, sizeof options.solver);
  for (int s = 0; s < o->seeds.nvalue; s++)
    seeds[s] = o->seeds.value[s];
  json_t *json = o->study ? NULL : options_to_json(o);
  if (o->study)
    cpl_study_read(&study, o->study, err);
  else
    cpl_study_read_json(&study, json, err);
  if (err->status == TDM_OK && cpl_study_check(&study, &options, err) == TDM_OK &&
      tdm_results_open(&results, &def, err) == TDM_OK) {
    if (tdm_check_writable(o->json, err) == TDM_OK && tdm_results_start(&results, err) == TDM_OK)
      run_study(o, &options, &study, err);
    tdm_results_close(&results);
  }
  cpl_study_free(&study);
  json_decref(json);
  return err->status;
}
