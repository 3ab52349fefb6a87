/* What the scenarios share: see support.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/support.h"

#include "coupler/observe/observers.h"
#include "protocol/parameters/load.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

tdm_status scn_result_read(scn_result *r, const char *dir, tdm_error *err) {
  char file[4352];
  r->scene = tdm_scene_as_run(tdm_results_read(dir, "scene.json", err));
  r->summary = r->scene ? tdm_results_read(dir, "summary.json", err) : NULL;
  if (!r->summary)
    return err->status;
  const json_t *bodies = json_object_get(json_object_get(r->scene, "coupling"), "bodies");
  const char *name = json_string_value(json_object_get(json_array_get(bodies, 0), "mbd"));
  if (!name)
    return tdm_fail(err, TDM_ERR_SCENE, "coupling.bodies", "no coupled body: nothing to compare");
  snprintf(file, sizeof file, "%s/body_%.200s.csv", dir, name);
  if (cpl_table_read(&r->body, file, err) != TDM_OK)
    return err->status;
  snprintf(file, sizeof file, "%s/mbd.csv", dir);
  if (cpl_table_read(&r->mbd, file, err) != TDM_OK)
    return err->status;
  snprintf(file, sizeof file, "%s/dem.csv", dir);
  return cpl_table_read(&r->dem, file, err);
}

void scn_result_free(scn_result *r) {
  json_decref(r->scene);
  json_decref(r->summary);
  cpl_table_free(&r->body);
  cpl_table_free(&r->mbd);
  cpl_table_free(&r->dem);
  *r = (scn_result){0};
}

double scn_number(const json_t *json, const char *path, tdm_error *err) {
  double x = scn_number_or(json, path, NAN);
  if (isnan(x))
    tdm_fail(err, TDM_ERR_SCENE, path, "no number here; the reference needs it");
  return x;
}

double scn_number_or(const json_t *json, const char *path, double fallback) {
  const json_t *value = tdm_scene_value(json, path);
  return json_is_number(value) ? json_number_value(value) : fallback;
}

tdm_status scn_verify_measure(cpl_verify *v, const cpl_verify_case *run, double least_nse, cpl_comparison *c,
                              tdm_error *err) {
  char name[64];
  cpl_verify_about(v, run);
  if (run->err.status != TDM_OK)
    *err = run->err;
  else
    cpl_verify_compare(v, run->dir, c, err);
  for (int i = 0; err->status == TDM_OK && i < c->ncurve; i++) {
    const cpl_compared *curve = &c->curve[i];
    if (curve->kind == CPL_STATE) {
      snprintf(name, sizeof name, "nse_%s", curve->name);
      cpl_verify_measure(v, name, run->name, cpl_comparison_nse(c, curve), CPL_AT_LEAST, least_nse);
    }
    snprintf(name, sizeof name, "r2_%s", curve->name);
    cpl_verify_measure(v, name, run->name, cpl_comparison_r2(c, curve), CPL_NO_LIMIT, 0);
  }
  return err->status;
}

tdm_status scn_verify_run_and_compare(cpl_verify *v, bool settles, double least_nse, char *dir, size_t size,
                                      cpl_comparison *c, tdm_error *err) {
  cpl_verify_case run[] = {{.name = "", .shares_bed = settles}, {.name = "scheme=proxy", .shares_bed = settles}};
  cpl_comparison proxy = {0};
  cpl_verify_case_set(&run[0], "coupling.scheme=lommen");
  cpl_verify_case_set(&run[1], "coupling.scheme=proxy");
  if (cpl_verify_run_many(v, 2, run, 0, err) == TDM_OK &&
      scn_verify_measure(v, &run[1], least_nse, &proxy, err) == TDM_OK)
    scn_verify_measure(v, &run[0], least_nse, c, err);
  cpl_comparison_free(&proxy);
  snprintf(dir, size, "%s", run[0].dir);
  return err->status;
}

tdm_status scn_verify_comparison(cpl_verify *v, bool settles, double least_nse, tdm_error *err) {
  char dir[4096];
  cpl_comparison c = {0};
  scn_verify_run_and_compare(v, settles, least_nse, dir, sizeof dir, &c, err);
  cpl_comparison_free(&c);
  return err->status;
}
