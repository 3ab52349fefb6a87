/* What became of a verified scenario: see outcome.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/verify/outcome.h"

#include "protocol/scene/json.h"
#include "protocol/version.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

void cpl_outcome_head(void) {
  printf("%-22s %-22s %-36s %12s %9s %10s %8s %15s  %s\n", "scenario", "measure", "case", "value", "limit", "simulated",
         "wall", "DEM/MBD/coupling", "ok");
}

static void print_measure(const char *scenario, const cpl_measure *m) {
  char limit[32] = "-", share[32] = "-";
  double loop = m->run.loop;
  if (m->kind != CPL_NO_LIMIT)
    snprintf(limit, sizeof limit, "%s%g", m->kind == CPL_AT_LEAST ? ">= " : "<= ", m->limit);
  if (loop > 0)
    snprintf(share, sizeof share, "%.0f/%.0f/%.0f %%", 100 * m->run.step[CPL_DEM] / loop,
             100 * m->run.step[CPL_MBD] / loop, 100 * cpl_run_coupling(&m->run) / loop);
  printf("%-22s %-22s %-36s %12.6g %9s %8.4g s %6.2f s %16s  %s\n", scenario, m->name, m->case_name, m->value, limit,
         m->run.simulated, m->run.wall, share,
         m->kind == CPL_NO_LIMIT ? "-"
         : m->pass               ? "ok"
                                 : "MISSED");
}

void cpl_outcome_print(const cpl_outcome *o) {
  if (isatty(2))
    fprintf(stderr, "\r\033[K");
  for (int i = 0; i < o->nmeasure; i++)
    print_measure(o->scenario->name, &o->measure[i]);
  if (o->err.status != TDM_OK)
    printf("%-22s FAILED: %s\n", o->scenario->name, o->err.message);
  fflush(stdout);
}

/* ---- the JSON file ---- */

static json_t *outcome_to_json(const cpl_outcome *o) {
  json_t *measures = json_array();
  for (int i = 0; i < o->nmeasure; i++) {
    const cpl_measure *m = &o->measure[i];
    json_array_append_new(measures,
                          json_pack("{s:s, s:s, s:o, s:o, s:b}", "name", m->name, "case", m->case_name, "value",
                                    tdm_number_to_json(m->value), "limit",
                                    m->kind == CPL_NO_LIMIT ? json_null() : json_real(m->limit), "pass", (int)m->pass));
  }
  json_t *json =
      json_pack("{s:s, s:b, s:f, s:f, s:I, s:f, s:f, s:f, s:o}", "name", o->scenario->name, "pass", (int)o->pass,
                "wall_s", o->wall, "simulated_s", o->total.simulated, "windows", (json_int_t)o->total.windows,
                "time_dem_s", o->total.step[CPL_DEM], "time_mbd_s", o->total.step[CPL_MBD], "time_coupling_s",
                cpl_run_coupling(&o->total), "measures", measures);
  if (o->detail)
    json_object_set(json, "detail", o->detail);
  if (o->err.status != TDM_OK)
    json_object_set_new(json, "error", json_string(o->err.message));
  return json;
}

tdm_status cpl_outcomes_write(const char *file, const cpl_outcome *outcomes, int n, bool pass, double wall,
                              tdm_error *err) {
  json_t *scenarios = json_array();
  for (int i = 0; i < n; i++)
    json_array_append_new(scenarios, outcome_to_json(&outcomes[i]));
  json_t *json = json_pack("{s:s, s:b, s:f, s:o}", "tandem", TDM_VERSION, "pass", (int)pass, "wall_s", wall,
                           "scenarios", scenarios);
  int failed = json_dump_file(json, file, JSON_INDENT(2));
  json_decref(json);
  return failed ? tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno)) : TDM_OK;
}
