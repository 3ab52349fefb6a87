/* A scene for one solver alone: see standalone.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/app/standalone.h"

#include "protocol/app/plot.h"
#include "protocol/base/log.h"
#include "protocol/base/progress.h"
#include "protocol/parameters/load.h"
#include "protocol/results/print.h"
#include "protocol/version.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

static const double flush_interval = 1; /* of the time histories, wall clock [s] */

/* ---- start ---- */

static tdm_status read_scene(tdm_standalone *run, tdm_error *err) {
  const tdm_standalone_options *o = run->options;
  run->teller = (tdm_teller){.program = run->program->name, .scene = &run->scene};
  tdm_remarks_open(&run->remarks);
  if (tdm_scene_load(&run->scene, o->scene, o->set, err) != TDM_OK)
    return err->status;
  tdm_scene_remark_unused(&run->scene);
  return TDM_OK;
}

/* The result directory with ROLE.log as its log; an earlier run's results stay unless --force was given, and then until
 * tdm_standalone_begin. */
static tdm_status open_results(tdm_standalone *run, tdm_error *err) {
  const tdm_standalone_options *o = run->options;
  const char *role = run->program->ops->role;
  char name[64];
  snprintf(name, sizeof name, "%s.log", role);
  const tdm_results_def def = {.dir = o->out, .scene = o->scene, .log = name, .force = o->force};
  if (tdm_results_open(&run->results, &def, err) != TDM_OK)
    return err->status;
  tdm_log_open(run->results.log, role);
  return tdm_results_json(&run->results, "scene.json", run->scene.written, err);
}

void tdm_standalone_refuse_coupling(tdm_object *root, const char *other, const char *what) {
  const char *const sections[] = {other, "coupling"};
  for (int k = 0; k < 2; k++)
    if (tdm_has(root, sections[k]))
      tdm_object_fail(root, sections[k],
                      "belongs to a co-simulation; run this scene with tandem run, or remove the section to run its "
                      "%s alone",
                      what);
}

void tdm_standalone_doubt(tdm_standalone *run, const char *path, const char *format, ...) {
  assert(run->ndoubt < TDM_STANDALONE_DOUBTS);
  va_list args;
  va_start(args, format);
  tdm_warning_vset(&run->doubt[run->ndoubt++], path, format, args);
  va_end(args);
}

void tdm_standalone_doubt_interval(tdm_standalone *run, double interval, double end) {
  if (interval > end * (1 + 1e-9))
    tdm_standalone_doubt(run, "output.interval",
                         "is %g s but the run ends at %g s: the time histories have its start and its end only",
                         interval, end);
}

static tdm_status heed(tdm_standalone *run, const tdm_warning *w, tdm_error *err) {
  char quoted[TDM_MESSAGE_MAX];
  tdm_error place = {0};
  tdm_fail(&place, TDM_ERR_SCENE, w->path, "%s", w->message);
  tdm_error told = place;
  tdm_scene_as_written(&run->scene, &place);
  json_array_append_new(run->warnings, json_pack("{s:s, s:s}", "path", place.path, "message", place.message));
  tdm_log(TDM_LOG_WARNING, "doubtful", "path=%s message=%s", place.path,
          tdm_log_quote(quoted, sizeof quoted, place.message));
  if (run->options->strict)
    return tdm_fail(err, TDM_ERR_SCENE, w->path, "%s (refused because of --strict)", w->message);
  tdm_scene_locate(&run->scene, &told);
  fprintf(stderr, "%s: warning: %s\n", run->program->name, told.message);
  return TDM_OK;
}

/* Doubts about the settings, and the solver's: printed, or refused when strict. */
static tdm_status heed_warnings(tdm_standalone *run, tdm_error *err) {
  for (int k = 0; k < run->ndoubt && err->status == TDM_OK; k++)
    heed(run, &run->doubt[k], err);
  for (int k = 0; k < run->figures.nwarning && err->status == TDM_OK; k++)
    heed(run, &run->figures.warning[k], err);
  return err->status;
}

json_t *tdm_standalone_section(tdm_standalone *run) {
  if (!run->section)
    run->section = tdm_scene_section(run->scene.root, run->program->ops->role);
  return run->section;
}

tdm_status tdm_standalone_loaded(tdm_standalone *run, const tdm_standalone_figures *figures, tdm_error *err) {
  const size_t n = (size_t)figures->nchannel;
  run->figures = *figures;
  run->warnings = json_array();
  run->values = calloc(n + 1, sizeof *run->values);
  if (!run->values || !run->warnings)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  memcpy(run->values, figures->initial, n * sizeof *run->values);
  return heed_warnings(run, err);
}

/* ---- remarks ---- */

void tdm_standalone_tell(tdm_standalone *run, bool bar) {
  if (run->told == run->remarks.changes)
    return;
  run->told = run->remarks.changes;
  json_t *remarks = tdm_remarks_to_json(&run->remarks, NULL);
  tdm_remarks_tell(&run->teller, remarks, bar ? TDM_PROGRESS_CLEAR : NULL);
  json_decref(remarks);
}

/* ---- time histories ---- */

tdm_status tdm_standalone_begin(tdm_standalone *run, tdm_error *err) {
  if (tdm_results_start(&run->results, err) != TDM_OK)
    return err->status;
  run->channels = tdm_results_file(&run->results, "channels.csv", err);
  if (!run->channels)
    return err->status;
  fputs("time [s]", run->channels);
  for (int c = 0; c < run->figures.nchannel; c++)
    fprintf(run->channels, ",%s [%s]", run->figures.channel[c].name, run->figures.channel[c].unit);
  fputc('\n', run->channels);
  run->moved = calloc((size_t)run->figures.nchannel + 1, sizeof *run->moved);
  run->plots = !run->options->no_plots;
  if (!run->moved || (run->plots && !tdm_thin_begin(&run->thin, run->figures.nchannel)))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  return TDM_OK;
}

tdm_status tdm_standalone_row(tdm_standalone *run, double t, const double *values, tdm_error *err) {
  tdm_write_row(run->channels, t, values, run->figures.nchannel);
  run->nrow++;
  memcpy(run->values, values, (size_t)run->figures.nchannel * sizeof *run->values);
  if (run->plots)
    tdm_thin_add(&run->thin, t, values);
  for (int c = 0; c < run->figures.nchannel && run->moved; c++)
    run->moved[c] = run->moved[c] || (values[c] != 0 && !isnan(values[c]));
  double now = tdm_clock();
  if (now - run->last_flush > flush_interval) {
    run->last_flush = now;
    fflush(run->channels);
    tdm_results_there(&run->results, err);
  }
  if (ferror(run->channels))
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s/channels.csv: cannot be written: %s; what is there stays readable",
             run->results.dir, strerror(errno));
  return err->status;
}

void tdm_standalone_close(tdm_standalone *run, tdm_error *err) {
  bool bad = ferror(run->channels);
  if (fclose(run->channels) != 0 || bad)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s/channels.csv: cannot be written: %s", run->results.dir, strerror(errno));
  run->channels = NULL;
}

static bool wanted(const char *channel, const char *const *of) {
  for (; of && *of; of++)
    if (strncmp(channel, *of, strlen(*of)) == 0)
      return true;
  return !of;
}

/* Some channel of the plot is not zero throughout. */
static bool any_moved(const tdm_standalone *run, const char *const *of) {
  bool any = false;
  for (int c = 0; c < run->figures.nchannel && run->moved; c++)
    any = any || (run->moved[c] && wanted(run->figures.channel[c].name, of));
  return any;
}

enum { PANELS = 16, CURVES = 24 };

/* the panels of one file of plots */
typedef struct {
  tdm_plot plot[PANELS];
  tdm_plot_data data[PANELS];
  tdm_curve curve[PANELS][CURVES];
  char using[PANELS][CURVES][16];
  int channel[PANELS][CURVES], nplot;
} panels;

/* what a panel of channels with one unit shows */
static const char *axis_of(const char *unit) {
  static const char *const axes[][2] = {{"m", "length [m]"},
                                        {"m/s", "velocity [m/s]"},
                                        {"m/s2", "acceleration [m/s\u00b2]"},
                                        {"rad", "angle [rad]"},
                                        {"rad/s", "angular velocity [rad/s]"},
                                        {"rad/s2", "angular acceleration [rad/s\u00b2]"},
                                        {"N", "force [N]"},
                                        {"N m", "moment [N m]"},
                                        {"J", "energy [J]"},
                                        {"W", "power [W]"},
                                        {"kg", "mass [kg]"},
                                        {"kg/s", "mass rate [kg/s]"},
                                        {"%", "share [%]"},
                                        {"1", "number [-]"}};
  for (size_t k = 0; k < sizeof axes / sizeof axes[0]; k++)
    if (strcmp(unit, axes[k][0]) == 0)
      return axes[k][1];
  return unit;
}

static void add_channel(panels *p, const tdm_standalone *run, int c) {
  const tdm_channel *channel = &run->figures.channel[c];
  int k = 0;
  const char *axis = axis_of(channel->unit);
  while (k < p->nplot && strcmp(p->plot[k].ylabel, axis) != 0)
    k++;
  if (k == PANELS)
    return;
  if (k == p->nplot)
    p->plot[p->nplot++] = (tdm_plot){.title = "", .xlabel = "time [s]", .ylabel = axis, .curve = p->curve[k]};
  int i = p->plot[k].ncurve;
  if (i == CURVES)
    return;
  snprintf(p->using[k][i], sizeof p->using[k][i], "1:%d", i + 2);
  p->curve[k][i] = (tdm_curve){NULL, p->using[k][i], channel -> name, "lines lw 2"};
  p->channel[k][p->plot[k].ncurve++] = c;
}

/* Give the panels their data; those without a number are dropped. */
static void add_data(panels *p, const tdm_standalone *run) {
  int kept = 0;
  for (int k = 0; k < p->nplot; k++) {
    const int n = p->plot[k].ncurve;
    double *table = tdm_thin_table(&run->thin, p->channel[k], n);
    p->plot[kept] = p->plot[k];
    p->data[kept] = (tdm_plot_data){table, tdm_thin_rows(&run->thin), n + 1};
    kept += table != NULL;
  }
  p->nplot = kept;
}

tdm_status tdm_standalone_plot(const tdm_standalone *run, const char *name, const char *const *of, tdm_error *err) {
  bool some = any_moved(run, of); /* then what is zero throughout is left out */
  if (!run->plots)
    return TDM_OK;
  panels *p = calloc(1, sizeof *p);
  if (!p)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int c = 0; c < run->figures.nchannel; c++)
    if (wanted(run->figures.channel[c].name, of) && (!some || run->moved[c]))
      add_channel(p, run, c);
  add_data(p, run);
  if (p->nplot > 0)
    tdm_plot_write_data(run->results.dir, name, p->nplot, p->plot, p->data, err);
  for (int k = 0; k < p->nplot; k++)
    free(p->data[k].value);
  free(p);
  return err->status;
}

/* ---- end ---- */

json_t *tdm_standalone_summary(tdm_standalone *run, const tdm_error *err) {
  struct utsname machine = {0};
  char name[4096];
  uname(&machine);
  snprintf(name, sizeof name, "%s", run->options->scene);
  tdm_utf8_clean(name);
  json_t *json = json_pack("{s:s, s:s, s:s, s:{s:s, s:s, s:i}}", "tandem", TDM_VERSION, "software",
                           run->program->ops->software, "scene", name, "machine", "system", machine.sysname,
                           "processor", machine.machine, "cores", (int)sysconf(_SC_NPROCESSORS_ONLN));
  if (tdm_scene_parameters(&run->scene))
    json_object_set(json, "parameters", (json_t *)tdm_scene_parameters(&run->scene));
  json_object_set(json, "report", run->figures.report ? run->figures.report : json_null());
  json_object_set_new(json, "warnings", run->warnings ? json_copy(run->warnings) : json_array());
  json_t *remarks = tdm_remarks_to_json(&run->remarks, NULL);
  tdm_remarks_enter(json, remarks, &run->scene);
  tdm_remarks_tell_end(&run->teller, remarks, run->nrow > 0 ? json_array_size(run->warnings) : 0);
  json_decref(remarks);
  json_object_set_new(json, "status", json_string(tdm_status_name(err->status)));
  if (err->status != TDM_OK)
    json_object_set_new(json, "error", json_string(err->message));
  return json;
}

void tdm_standalone_log_end(const char *pairs, const tdm_error *err) {
  char quoted[TDM_MESSAGE_MAX];
  if (err->status != TDM_OK)
    tdm_log(TDM_LOG_ERROR, "failed", "status=%s message=%s", tdm_status_name(err->status),
            tdm_log_quote(quoted, sizeof quoted, err->message));
  else
    tdm_log(TDM_LOG_INFO, "finished", "%s", pairs);
}

static void let_go(tdm_standalone *run) {
  tdm_remarks_open(NULL);
  tdm_teller_free(&run->teller);
  if (run->results.staged)
    fprintf(stderr, "%s: notice: the results in %s stay as they are; the log of this start is in %s\n",
            run->program->name, run->results.home, run->results.dir);
  free(run->moved);
  tdm_thin_free(&run->thin);
  tdm_log_open(NULL, run->program->ops->role);
  tdm_results_close(&run->results);
  json_decref(run->section);
  json_decref(run->warnings);
  free(run->values);
  tdm_scene_destroy(&run->scene);
}

/* ---- all of it ---- */

static void print(const tdm_standalone *run) {
  tdm_scene_print_parameters(&run->scene);
  run->program->print(run);
  tdm_print_json(run->figures.report);
  printf("%d warning%s\n", run->figures.nwarning, run->figures.nwarning == 1 ? "" : "s");
}

tdm_status tdm_standalone_perform(const tdm_standalone_program *program, const tdm_standalone_options *options,
                                  bool check, tdm_error *err) {
  tdm_standalone *run = calloc(1, program->size);
  if (!run)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  run->program = program;
  run->options = options;
  run->begin = tdm_clock();
  if (read_scene(run, err) == TDM_OK && program->load(run, err) == TDM_OK &&
      (check || open_results(run, err) == TDM_OK) && program->start(run, err) == TDM_OK) {
    run->setup = tdm_clock() - run->begin;
    if (check)
      print(run);
    else
      program->solve(run, err);
  }
  tdm_scene_locate(&run->scene, err);
  if (run->results.log)
    program->conclude(run, err);
  program->let_go(run);
  let_go(run);
  free(run);
  return err->status;
}
