/* `tandem report DIR`: see report.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/report/report.h"

#include "coupler/report/report_page.h"
#include "protocol/parameters/load.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

/* What the report is without goes to the terminal and onto the page. */
static void lack(cpl_report_data *r, const char *why) {
  fprintf(stderr, "tandem: notice: %s\n", why);
  if (r->nlack < CPL_REPORT_LACKS)
    snprintf(r->lack[r->nlack++], sizeof r->lack[0], "%.1000s", why);
}

/* ---- the directory ---- */

/* Whether it has anything of a run. */
static tdm_status look_at(const char *dir, tdm_error *err) {
  static const char *const files[] = {"summary.json", "channels.csv", "ledger.csv"};
  DIR *open = opendir(dir);
  if (!open)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be read: %s; give the directory of a run (--out of its run)",
                    dir, strerror(errno));
  closedir(open);
  for (size_t k = 0; k < sizeof files / sizeof files[0]; k++)
    if (cpl_report_has(dir, files[k]))
      return TDM_OK;
  if (cpl_report_has(dir, "scene.json") && tdm_mark_has(dir))
    return TDM_OK;
  if (cpl_report_has(dir, "start"))
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s holds no results, only the start of a run; report on %s/start", dir,
                    dir);
  return tdm_fail(err, TDM_ERR_FILE, NULL,
                  "%s holds no results of a run (no summary.json); give the directory of a run (--out of "
                  "its run)",
                  dir);
}

static json_t *read_json(cpl_report_data *r, const char *name, const char *without) {
  char why[1024];
  tdm_error bad = {0};
  json_t *json = tdm_results_read(r->dir, name, &bad);
  if (json && !json_is_object(json)) {
    tdm_fail(&bad, TDM_ERR_FILE, NULL, "it is no JSON object");
    json_decref(json);
    json = NULL;
  }
  if (!json) {
    snprintf(why, sizeof why, "%s: %s/%s cannot be read", without, r->dir, name);
    lack(r, why);
  }
  return json;
}

/* ---- agreement with the reference ---- */

static void print_agreement(const cpl_comparison *c) {
  const char *key;
  json_t *value;
  printf("%-8s %12s %12s %18s\n", "curve", "nse", "r2", "r2, 20 ms means");
  for (int i = 0; i < c->ncurve; i++) {
    const cpl_compared *curve = &c->curve[i];
    printf("%-8s %12.6f %12.6f %18.6f\n", curve->name, cpl_comparison_nse(c, curve), cpl_comparison_r2(c, curve),
           cpl_comparison_r2_mean(c, curve, 0.02));
  }
  json_object_foreach(c->notes, key, value) printf("%s: %.6g\n", key, json_number_value(value));
}

/* A comparison that cannot be made (a run that was cut short, other parameters) is a notice: the rest is still worth
 * it. */
static void compare(cpl_report_data *r, const cpl_scenario *scenario) {
  char why[1024];
  tdm_error err = {0};
  if (!scenario || !scenario->compare)
    return;
  if (scenario->compare(r->dir, &r->comparison, &err) == TDM_OK &&
      cpl_comparison_write(&r->comparison, r->dir, &err) == TDM_OK) {
    r->compared = true;
    print_agreement(&r->comparison);
    r->comparison_drawn = cpl_comparison_plot(&r->comparison, r->dir, &err) == TDM_OK;
  }
  if (err.status == TDM_OK || err.status == TDM_ERR_INTERRUPTED)
    return;
  snprintf(why, sizeof why, "%s%.900s", r->compared ? "" : "no comparison: ", err.message);
  lack(r, why);
}

/* ---- the whole ---- */

static void print_remarks(const cpl_report_data *r) {
  static const char *const lists[] = {"warnings", "notices"}, *const names[] = {"warning", "notice"};
  const char *error = json_string_value(json_object_get(r->summary, "error"));
  const char *status = json_string_value(json_object_get(r->summary, "status"));
  char text[2048];
  size_t i;
  json_t *entry;
  if (error)
    printf(status && strcmp(status, "unfinished") == 0 ? "%s\n" : "the run failed: %s\n", error);
  for (int l = 0; l < 2; l++)
    json_array_foreach(json_object_get(r->summary, lists[l]), i, entry)
        printf("%s: %s\n", names[l], cpl_report_remark(entry, text, sizeof text));
}

static void make_pictures(cpl_report_data *r) {
  tdm_error err = {0};
  cpl_pictures_make(&r->pictures, r->dir, &r->contents, &err);
  if (err.status != TDM_OK && err.status != TDM_ERR_INTERRUPTED)
    lack(r, err.message);
}

static tdm_status write_page(const cpl_report_data *r, tdm_error *err) {
  char path[4352];
  int made = 0;
  snprintf(path, sizeof path, "%s/index.html", r->dir);
  tdm_mark_add_in(r->dir, "index.html");
  FILE *page = fopen(path, "w");
  if (!page)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, strerror(errno));
  cpl_report_page(page, r);
  const bool bad = ferror(page);
  if (fclose(page) != 0 || bad)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, strerror(errno));
  if (tdm_plot_interrupted())
    return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted; %s shows the pictures that were made", path);
  for (int i = 0; i < r->pictures.n; i++)
    made += r->pictures.picture[i].there;
  made += r->comparison_drawn;
  if (made > 0)
    printf("%s shows the run; %d picture%s of its time histories\n", path, made, made == 1 ? "" : "s");
  else
    printf("%s shows the run, without pictures of its time histories\n", path);
  return TDM_OK;
}

tdm_status cpl_report(const char *dir, const cpl_scenario *scenarios, tdm_error *err) {
  if (look_at(dir, err) != TDM_OK)
    return err->status;
  cpl_report_data *r = calloc(1, sizeof *r);
  if (!r)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  r->dir = dir;
  r->written = read_json(r, "scene.json", "no scene");
  r->scene = tdm_scene_as_run(json_incref(r->written));
  r->summary = read_json(r, "summary.json", "no figures of the run");
  print_remarks(r);
  tdm_error no_scenario = {0};
  compare(r, r->scene ? cpl_scenario_of(scenarios, r->scene, &no_scenario) : NULL);
  if (no_scenario.status != TDM_OK)
    lack(r, no_scenario.message);
  if (cpl_contents_read(&r->contents, dir, r->scene, r->summary, err) == TDM_OK) {
    for (int i = 0; i < r->contents.nlack; i++)
      lack(r, r->contents.lack[i]);
    make_pictures(r);
    write_page(r, err);
  }
  cpl_pictures_free(&r->pictures);
  cpl_contents_free(&r->contents);
  cpl_comparison_free(&r->comparison);
  json_decref(r->scene);
  json_decref(r->written);
  json_decref(r->summary);
  free(r);
  return err->status;
}
