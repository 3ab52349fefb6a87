/* A scene of bodies alone: see run.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/app/run.h"

#include "mbd/adapter/solver.h"
#include "mbd/integrate/integrator.h"
#include "mbd/mbd.h"
#include "protocol/app/plot.h"
#include "protocol/base/log.h"
#include "protocol/base/progress.h"
#include "protocol/results/print.h"
#include "protocol/scene/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The plots of a run: a file each, with the channels whose names begin so, a panel a unit. */
static const struct {
  const char *name, *of[4];
} plots[] = {{"motion", {"body.", "marker.", NULL}},
             {"reactions", {"joint.", "driver.", "force.", NULL}},
             {"energies", {"energy.", NULL}},
             {"drift", {"constraint.", NULL}}};

enum { WINDOW_ROWS = 64 }; /* output intervals a window, unless time.dt says otherwise */

/* what a channel was at the start, is at the end, and lay between */
typedef struct {
  double start, end, least, greatest;
} course;

typedef struct {
  tdm_standalone alone;
  mbd_engine *engine;
  mbd_run_settings settings;
  uint64_t total_rows;
  int room;            /* rows a window at most */
  double *sample_time; /* (room) [s] */
  double *sample;      /* (room x nchannel) */
  course *course;      /* (nchannel) */
  tdm_outputs outputs;
  double t; /* reached [s] */
  uint64_t windows;
  double loop, step; /* wall times: the loop, the solver's part of it [s] */
  double looked;     /* of the latter: writing what is looked at [s] */
} run_state;

/* ---- settings ---- */

tdm_status mbd_run_settings_read(mbd_run_settings *s, const tdm_scene *scene, tdm_error *err) {
  const double most_rows = 1e9;
  tdm_object root = tdm_object_open(scene->root, "", err);
  tdm_has(&root, "$schema");    /* for editors */
  tdm_has(&root, "parameters"); /* which expressions have used */
  tdm_get_string(&root, "title", "");
  tdm_standalone_refuse_coupling(&root, "dem", "bodies");
  tdm_check_gravity(&root);
  tdm_object o = tdm_get_object(&root, "time", true);
  s->end = tdm_get_number(&o, "end", TDM_REQUIRED, TDM_POSITIVE);
  s->window = tdm_has(&o, "dt") ? tdm_get_number(&o, "dt", TDM_REQUIRED, TDM_POSITIVE) : 0;
  if (s->window > s->end)
    tdm_object_fail(&o, "dt", "is %g s, longer than the whole run (time.end = %g s)", s->window, s->end);
  tdm_object_close(&o);
  o = tdm_get_object(&root, "output", false);
  s->interval = tdm_get_number(&o, "interval", 1e-3, TDM_POSITIVE);
  if (s->end / s->interval > most_rows || (s->window > 0 && s->end / s->window > most_rows))
    tdm_object_fail(&o, "interval", "time.end = %g s has more than %g output intervals or steps; take longer ones",
                    s->end, most_rows);
  tdm_outputs_settings_read(&s->outputs, &o, scene->root, 0, s->end);
  tdm_object_close(&o);
  if (s->window == 0)
    s->window = WINDOW_ROWS * s->interval;
  tdm_get_object(&root, "mbd", true);
  tdm_object_close(&root);
  return err->status;
}

/* ---- start ---- */

static tdm_status load(tdm_standalone *alone, tdm_error *err) {
  run_state *run = (run_state *)alone;
  if (mbd_run_settings_read(&run->settings, &run->alone.scene, err) != TDM_OK)
    return err->status;
  const mbd_run_settings *s = &run->settings;
  run->total_rows = (uint64_t)fmax(1, ceil(s->end / s->interval - 1e-6)) + 1;
  run->room = (int)fmin(s->window / s->interval + 2, (double)run->total_rows);
  tdm_standalone_doubt_interval(&run->alone, s->interval, s->end);
  tdm_warning doubt;
  for (int k = 0; tdm_outputs_doubt(&s->outputs, s->end, k, &doubt); k++)
    tdm_standalone_doubt(&run->alone, doubt.path, "%s", doubt.message);
  return TDM_OK;
}

static tdm_status start(tdm_standalone *alone, tdm_error *err) {
  run_state *run = (run_state *)alone;
  const tdm_assignment assignment = {
      .scene = tdm_standalone_section(&run->alone), .time_end = run->settings.end, .dt = run->settings.window, .n = 1};
  if (mbd_engine_create(&run->engine, &assignment, NULL, err) != TDM_OK)
    return err->status;
  const mbd_start *start = mbd_engine_start(run->engine);
  const tdm_standalone_figures figures = {.nchannel = start->nchannel,
                                          .channel = start->channel,
                                          .initial = start->initial,
                                          .nwarning = start->nwarning,
                                          .warning = start->warning,
                                          .report = start->report};
  return tdm_standalone_loaded(&run->alone, &figures, err);
}

/* ---- outputs ---- */

/* the time of a row: the last one lies on the end, on the grid or not */
static double row_time(const run_state *run, uint64_t row) {
  return fmin((double)row * run->settings.interval, run->settings.end);
}

static tdm_status write_row(run_state *run, const double *values, tdm_error *err) {
  for (int c = 0; c < run->alone.figures.nchannel; c++) {
    course *k = &run->course[c];
    if (run->alone.nrow == 0)
      *k = (course){values[c], values[c], values[c], values[c]};
    k->end = values[c];
    k->least = fmin(k->least, values[c]);
    k->greatest = fmax(k->greatest, values[c]);
  }
  return tdm_standalone_row(&run->alone, row_time(run, run->alone.nrow), values, err);
}

/* The state of a row, of time t [s], if a frame is due then. */
static tdm_status look(run_state *run, double t, tdm_error *err) {
  const double begin = tdm_clock();
  if (!tdm_outputs_due(&run->outputs, t))
    return TDM_OK;
  if (mbd_engine_snapshot(run->engine, &run->outputs.snapshot, err) != TDM_OK)
    return err->status;
  run->outputs.snapshot.time = t;
  tdm_outputs_write(&run->outputs, &run->outputs.snapshot, err);
  run->looked += tdm_clock() - begin;
  return err->status;
}

static tdm_status look_at_sample(void *looker, int sample, tdm_error *err) {
  run_state *run = looker;
  return look(run, run->sample_time[sample], err);
}

static tdm_status begin_frames(run_state *run, tdm_error *err) {
  const mbd_run_settings *s = &run->settings;
  if (tdm_outputs_wanted(&s->outputs) && mbd_engine_scenery(run->engine, &run->outputs.scenery, err) != TDM_OK)
    return err->status;
  if (tdm_outputs_begin(&run->outputs, &s->outputs, &run->alone.results, s->end, s->interval, err) != TDM_OK)
    return err->status;
  return look(run, 0, err);
}

static tdm_status begin_outputs(run_state *run, tdm_error *err) {
  size_t nchannel = (size_t)run->alone.figures.nchannel;
  run->sample_time = calloc((size_t)run->room, sizeof *run->sample_time);
  run->sample = calloc((size_t)run->room * nchannel, sizeof *run->sample);
  run->course = calloc(nchannel, sizeof *run->course);
  if (!run->sample_time || !run->sample || !run->course)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %d rows of outputs; take a smaller time.dt", run->room);
  if (tdm_standalone_begin(&run->alone, err) != TDM_OK || write_row(run, run->alone.values, err) != TDM_OK)
    return err->status;
  return begin_frames(run, err);
}

/* ---- the loop ---- */

/* one window and the rows in it */
static tdm_status advance(run_state *run, tdm_error *err) {
  double begin = tdm_clock() - run->looked;
  mbd_window window = {.t0 = run->t, .sample_time = run->sample_time};
  window.t1 = fmin((double)(run->windows + 1) * run->settings.window, run->settings.end);
  if (run->settings.end - window.t1 < 1e-9 * run->settings.window)
    window.t1 = run->settings.end;
  for (uint64_t row = run->alone.nrow; row < run->total_rows && row_time(run, row) <= window.t1; row++)
    run->sample_time[window.nsample++] = row_time(run, row);
  const mbd_outcome outcome = {.channel = run->sample,
                               .look = tdm_outputs_wanted(&run->settings.outputs) ? look_at_sample : NULL,
                               .looker = run};
  if (mbd_engine_advance(run->engine, &window, &outcome, err) != TDM_OK)
    return err->status;
  run->step += tdm_clock() - run->looked - begin;
  run->t = window.t1;
  run->windows++;
  for (int i = 0; i < window.nsample && err->status == TDM_OK; i++)
    write_row(run, run->sample + i * run->alone.figures.nchannel, err);
  return err->status;
}

static tdm_status solve(tdm_standalone *alone, tdm_error *err) {
  run_state *run = (run_state *)alone;
  tdm_progress progress;
  double begin = tdm_clock();
  if (begin_outputs(run, err) != TDM_OK)
    return err->status;
  tdm_progress_begin(&progress, run->settings.end, "steps", false);
  while (run->t < run->settings.end && advance(run, err) == TDM_OK) {
    tdm_progress_update(&progress, run->t, (uint64_t)mbd_engine_stats(run->engine)->steps);
    tdm_standalone_tell(&run->alone, progress.terminal);
  }
  tdm_progress_end(&progress);
  run->loop = tdm_clock() - begin;
  return err->status;
}

/* ---- end ---- */

/* course of every channel whose name begins so */
static json_t *courses(const run_state *run, const char *of) {
  json_t *json = json_object();
  for (int c = 0; run->alone.nrow > 0 && c < run->alone.figures.nchannel; c++) {
    const char *name = run->alone.figures.channel[c].name;
    const course *k = &run->course[c];
    if (strncmp(name, of, strlen(of)) == 0)
      json_object_set_new(json, name,
                          json_pack("{s:o, s:o, s:o, s:o}", "start", tdm_number_to_json(k->start), "end",
                                    tdm_number_to_json(k->end), "least", tdm_number_to_json(k->least), "greatest",
                                    tdm_number_to_json(k->greatest)));
  }
  return json;
}

static double largest_drift(const run_state *run) {
  for (int c = 0; run->alone.nrow > 0 && c < run->alone.figures.nchannel; c++)
    if (strcmp(run->alone.figures.channel[c].name, "constraint.drift") == 0)
      return run->course[c].greatest;
  return 0;
}

static json_t *solver_settings(const mbd_model *model) {
  const mbd_settings *s = &model->solver;
  return json_pack("{s:s, s:s, s:f, s:f, s:i, s:f}", "formulation", mbd_formulation_table[s->formulation].name,
                   "corrector", s->modified ? "modified" : "original", "relative_tolerance", s->relative_tolerance,
                   "absolute_tolerance", s->absolute_tolerance, "max_order", s->max_order, "max_step", s->max_step);
}

static json_t *summary(run_state *run, double wall, const tdm_error *err) {
  const mbd_run_settings *s = &run->settings;
  json_t *json = tdm_standalone_summary(&run->alone, err);
  json_t *own = json_pack("{s:{s:f, s:f, s:f}, s:f, s:{s:f, s:f, s:f, s:f}}", "settings", "time.end", s->end, "window",
                          s->window, "output.interval", s->interval, "simulated_s", run->t, "wall_s", "all", wall,
                          "setup", run->alone.setup, "mbd", run->step, "output", fmax(0, run->loop - run->step));
  json_object_update_new(json, own);
  if (run->windows == 0)
    return json;
  const mbd_stats *c = mbd_engine_stats(run->engine);
  json_object_set_new(json, "solver", solver_settings(mbd_engine_model(run->engine)));
  json_object_set_new(json, "integrator",
                      json_pack("{s:I, s:I, s:I, s:I, s:I, s:I}", "steps", (json_int_t)c->steps, "residuals",
                                (json_int_t)c->residuals, "jacobians", (json_int_t)c->jacobians, "error_failures",
                                (json_int_t)c->error_failures, "convergence_failures",
                                (json_int_t)c->convergence_failures, "restarts", (json_int_t)c->restarts));
  json_object_set_new(json, "energies", courses(run, "energy."));
  double share, off = mbd_engine_energy_off(run->engine, &share);
  json_object_set_new(json, "energy_off",
                      json_pack("{s:o, s:o}", "J", tdm_number_to_json(off), "share", tdm_number_to_json(share)));
  json_object_set_new(json, "constraint_drift", tdm_number_to_json(largest_drift(run)));
  return json;
}

/* the files of the end: plots, summary.json, the last line of the log */
static void conclude(tdm_standalone *alone, tdm_error *err) {
  run_state *run = (run_state *)alone;
  tdm_error notice = {0};
  char pairs[128];
  if (run->alone.channels) {
    tdm_standalone_close(&run->alone, err);
    for (size_t k = 0; k < sizeof plots / sizeof plots[0] && notice.status == TDM_OK; k++)
      tdm_standalone_plot(&run->alone, plots[k].name, plots[k].of, &notice);
  }
  if (notice.status != TDM_OK && !tdm_plot_interrupted())
    tdm_remark(TDM_NOTICE, "plots", NULL, run->t, "%s", notice.message);
  tdm_outputs_finish(&run->outputs, run->t);
  double wall = tdm_clock() - alone->begin;
  json_t *json = summary(run, wall, err);
  tdm_results_summary(&run->alone.results, json, err);
  json_decref(json);
  long steps = run->windows > 0 ? mbd_engine_stats(run->engine)->steps : 0;
  snprintf(pairs, sizeof pairs, "steps=%ld simulated=%g wall=%.3f", steps, run->t, wall);
  tdm_standalone_log_end(pairs, err);
  if (run->windows > 0)
    printf("%.6g s simulated in %ld steps; joints open by %.2g m at most; %.2f s wall, %.3g s of it in the solver; "
           "results in %s\n",
           run->t, steps, largest_drift(run), wall, run->step, run->alone.results.dir);
}

static void let_go(tdm_standalone *alone) {
  run_state *run = (run_state *)alone;
  free(run->sample_time);
  free(run->sample);
  free(run->course);
  tdm_outputs_end(&run->outputs);
  tdm_outputs_settings_free(&run->settings.outputs);
  mbd_engine_destroy(&run->engine);
}

/* ---- check ---- */

static void print(const tdm_standalone *alone) {
  const run_state *run = (const run_state *)alone;
  const mbd_run_settings *s = &run->settings;
  printf("run\n  %-28s %g s\n", "time", s->end);
  printf("  %-28s every %g s: %llu rows of %d channels\n", "time histories", s->interval,
         (unsigned long long)run->total_rows, run->alone.figures.nchannel);
  tdm_outputs_print(&s->outputs, s->end);
  printf("mbd: %s\n", mbd_solver_ops.software);
  json_t *solver = solver_settings(mbd_engine_model(run->engine));
  json_object_del(solver, "formulation"); /* the report has it */
  tdm_print_json(solver);
  json_decref(solver);
}

const tdm_standalone_program mbd_program = {
    .name = "tandem-mbd",
    .help = "tandem-mbd: the multibody solver of tandem\n\n"
            "  tandem-mbd run SCENE [--out DIR] [--force] [--set PATH=VALUE ...] [--strict] [--no-plots]\n"
            "      Run a scene that has only bodies: a JSON file, or the name of a scene in scenarios/mbd.\n"
            "      Results go to DIR (default: run-out): time histories, plots, frames.\n"
            "      --force            replace the results of an earlier run in DIR\n"
            "      --set PATH=VALUE   override a value of the scene: --set time.end=2 --set mbd.bodies[0].mass=3\n"
            "      --strict           refuse a run that the solver has doubts about\n"
            "      --no-plots         leave out the plots of time histories\n\n"
            "  tandem-mbd check SCENE [--set PATH=VALUE ...] [--strict]\n"
            "      Load and assemble the scene, print what would run, degrees of freedom and doubts, and end.\n\n"
            "  tandem-mbd import FILE.adm [OPTIONS]\n"
            "      Make a scene of an Adams data set; see tandem-mbd import --help.\n\n"
            "  tandem-mbd --connect ENDPOINT [--name NAME] [--timeout SECONDS]\n"
            "      Take part in a co-simulation; \"tandem run SCENE\" starts it so by itself.\n"
            "      --connect ENDPOINT  where the server listens, for example ipc:///tmp/dir/tandem\n"
            "      --name NAME         the name in messages and logs (default: mbd)\n"
            "      --timeout SECONDS   give up when the server is silent for so long (default: 30)\n\n"
            "  --scenarios DIR   where scenarios are (default: ./scenarios, the installed ones, those of the source)\n"
            "  --help, --version\n",
    .ops = &mbd_solver_ops,
    .size = sizeof(run_state),
    .load = load,
    .start = start,
    .solve = solve,
    .conclude = conclude,
    .print = print,
    .let_go = let_go,
};
