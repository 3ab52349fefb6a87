/* A scene of particles alone: see run.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/app/run.h"

#include "dem/adapter/solver.h"
#include "dem/app/launch.h"
#include "dem/bodies/walls.h"
#include "dem/dem.h"
#include "dem/exchange/balance.h"
#include "dem/output/moldyn_files.h"
#include "dem/output/repose.h"
#include "dem/seam/homes.h"
#include "dem/watch/check.h"
#include "protocol/app/plot.h"
#include "protocol/base/log.h"
#include "protocol/base/progress.h"
#include "protocol/output/figures.h"
#include "protocol/results/screening.h"
#include "protocol/scene/json.h"

#include <stdlib.h>
#include <string.h>

/* What a run holds, so that one place can let go of it whatever happened. */
typedef struct {
  tdm_standalone alone;
  dem_engine *engine;
  dem_run_settings settings;

  int ndue;      /* rows of the time histories that the last window made */
  double due[2]; /* (ndue) their times [s] */
  double *rows;  /* (ndue x nchannel) */

  tdm_outputs outputs;
  dem_moldyn_files moldyn;

  uint64_t nstep; /* done */
  double particle_steps;
  bool reposed;      /* the last state is in outputs.snapshot, of all particles */
  double loop, step; /* wall times: the loop, the solver's part of it [s] */
} run_state;

/* ---- start ---- */

static tdm_status load(tdm_standalone *alone, tdm_error *err) {
  run_state *run = (run_state *)alone;
  const dem_run_settings *s = &run->settings;
  if (dem_run_settings_read(&run->settings, &run->alone.scene, err) != TDM_OK)
    return err->status;
  if (dem_launch_wanted(s->ranks)) /* mpirun starts again with the command line */
    return dem_launch_ranks(s->ranks, "dem.ranks", err);
  tdm_standalone_doubt_interval(&run->alone, s->interval, s->time.end);
  tdm_warning doubt;
  for (int k = 0; tdm_outputs_doubt(&s->outputs, s->time.end, k, &doubt); k++)
    tdm_standalone_doubt(&run->alone, doubt.path, "%s", doubt.message);
  return TDM_OK;
}

static tdm_status start(tdm_standalone *alone, tdm_error *err) {
  run_state *run = (run_state *)alone;
  const tdm_assignment assignment = {.scene = tdm_standalone_section(&run->alone),
                                     .time_end = run->settings.time.end,
                                     .dt = run->settings.time.dt,
                                     .n = 1};
  if (dem_engine_create(&run->engine, &assignment, NULL, err) != TDM_OK)
    return err->status;
  const dem_start *start = dem_engine_start(run->engine);
  const tdm_standalone_figures figures = {.nchannel = start->nchannel,
                                          .channel = start->channel,
                                          .initial = start->initial,
                                          .nwarning = start->nwarning,
                                          .warning = start->warning,
                                          .report = start->report};
  return tdm_standalone_loaded(&run->alone, &figures, err);
}

/* ---- outputs ---- */

/* time reached [s] */
static double now(const run_state *run) {
  return (double)run->nstep * run->settings.time.dt;
}

/* all: also on several ranks, with all particles in this one */
static tdm_status take_snapshot(run_state *run, bool all, tdm_error *err) {
  run->outputs.snapshot.with_contacts = tdm_outputs_want_contacts(&run->outputs, now(run));
  return (all ? dem_engine_snapshot : dem_engine_share)(run->engine, &run->outputs.snapshot, err);
}

static tdm_status write_shares(void *self, const tdm_shared_frame *frame, tdm_error *err) {
  run_state *run = self;
  return dem_engine_write_shares(run->engine, &run->outputs.snapshot, frame, err);
}

static tdm_status begin_outputs(run_state *run, tdm_error *err) {
  const size_t n = (size_t)run->alone.figures.nchannel;
  run->rows = calloc(2 * n + 1, sizeof *run->rows);
  if (!run->rows)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  memcpy(run->rows, run->alone.figures.initial, n * sizeof *run->rows);
  run->ndue = 1;
  const dem_run_settings *set = &run->settings;
  if (tdm_standalone_begin(&run->alone, err) != TDM_OK ||
      (tdm_outputs_wanted(&set->outputs) && dem_engine_scenery(run->engine, &run->outputs.scenery, err) != TDM_OK))
    return err->status;
  if (dem_moldyn_open(&run->moldyn, set->xb, set->str, dem_engine_data(run->engine), set->outputs.particles_interval,
                      &run->alone.results, err) != TDM_OK)
    return err->status;
  run->outputs.sharers = (tdm_sharers){write_shares, run};
  return tdm_outputs_begin(&run->outputs, &set->outputs, &run->alone.results,
                           (double)tdm_total_steps(&set->time) * set->time.dt, set->time.dt, err);
}

static double row_time(const run_state *run) {
  return (double)run->alone.nrow * run->settings.interval;
}

/* ---- when outputs are due ---- */

/* the step that ends at time t or first after it */
static uint64_t step_at(const run_state *run, double t) {
  return (uint64_t)fmax(0, ceil(t / run->settings.time.dt - 1e-6));
}

static uint64_t row_step(const run_state *run) {
  return step_at(run, row_time(run));
}

static uint64_t least(uint64_t a, uint64_t b) {
  return a < b ? a : b;
}

/* of a frame or a picture */
static uint64_t look_step(const run_state *run) {
  const double next = tdm_outputs_next(&run->outputs);
  return isfinite(next) ? step_at(run, next) : UINT64_MAX;
}

static tdm_status write_due(run_state *run, tdm_error *err) {
  for (int k = 0; k < run->ndue; k++)
    if (tdm_standalone_row(&run->alone, run->due[k], run->rows + k * run->alone.figures.nchannel, err) != TDM_OK)
      return err->status;
  const int frames = run->outputs.pvd.number;
  const bool all = tdm_outputs_want_all(&run->outputs, now(run)) || dem_moldyn_wanted(&run->moldyn);
  if (run->nstep >= look_step(run) && take_snapshot(run, all, err) == TDM_OK)
    tdm_outputs_write(&run->outputs, &run->outputs.snapshot, err);
  if (err->status == TDM_OK && run->outputs.pvd.number > frames)
    dem_moldyn_write(&run->moldyn, dem_engine_data(run->engine), &run->outputs.snapshot, err);
  return err->status;
}

/* ---- the loop ---- */

/* the rows of a window that ends with step `end`: one of the grid, and one of the last state, on the grid or not */
static void find_due(run_state *run, uint64_t end) {
  const double dt = run->settings.time.dt, row = row_time(run), t1 = (double)end * dt;
  run->ndue = 0;
  if (end >= row_step(run))
    run->due[run->ndue++] = row;
  if (end == tdm_total_steps(&run->settings.time) && (run->ndue == 0 || row < t1 - 1e-6 * dt))
    run->due[run->ndue++] = t1;
}

/* from the step reached to step `end`; the time histories are sampled there if they are due */
static tdm_status advance(run_state *run, uint64_t end, tdm_error *err) {
  const dem_data *d = dem_engine_data(run->engine);
  double dt = run->settings.time.dt, begin = tdm_clock();
  find_due(run, end);
  const dem_window window = {.t0 = now(run),
                             .t1 = (double)end * dt,
                             .nstep = end - run->nstep,
                             .seen = end >= look_step(run),
                             .nsample = run->ndue,
                             .sample_time = run->due};
  double nparticle = d->state.nparticle;
  if (dem_engine_advance(run->engine, &window, &(dem_outcome){.channel = run->rows}, err) != TDM_OK)
    return err->status;
  run->particle_steps += 0.5 * (nparticle + d->state.nparticle) * (double)window.nstep;
  run->step += tdm_clock() - begin;
  run->nstep = end;
  return TDM_OK;
}

static tdm_status solve(tdm_standalone *alone, tdm_error *err) {
  run_state *run = (run_state *)alone;
  tdm_progress progress;
  uint64_t total = tdm_total_steps(&run->settings.time);
  double begin = tdm_clock(), dt = run->settings.time.dt;
  if (begin_outputs(run, err) != TDM_OK || write_due(run, err) != TDM_OK)
    return err->status;
  tdm_progress_begin(&progress, (double)total * dt, "steps", false);
  while (run->nstep < total && err->status == TDM_OK) {
    uint64_t next = least(least(row_step(run), look_step(run)), total);
    if (advance(run, next, err) == TDM_OK)
      write_due(run, err);
    tdm_progress_update(&progress, (double)run->nstep * dt, run->nstep);
    tdm_standalone_tell(&run->alone, progress.terminal);
  }
  tdm_progress_end(&progress);
  run->loop = tdm_clock() - begin;
  return err->status;
}

/* ---- end ---- */

static json_t *repose(const run_state *run) {
  dem_repose r = dem_repose_of(&run->outputs.snapshot, run->settings.repose_along);
  return json_pack("{s:o, s:o, s:o}", "mean_deg", tdm_number_to_json(r.mean), "low_side_deg", tdm_number_to_json(r.low),
                   "high_side_deg", tdm_number_to_json(r.high));
}

/* "ranks": how they share the run; of each its work, a step */
static json_t *ranks_summary(const run_state *run) {
  const dem_data *d = dem_engine_data(run->engine);
  const int size = d->work.homes.ranks->size;
  dem_rank_work *work = calloc((size_t)size, sizeof *work);
  json_t *each = json_array();
  tdm_error late = {0};
  if (work)
    dem_engine_work(run->engine, work, &late);
  for (int r = 0; work && !late.status && r < size; r++) {
    const dem_rank_work *w = &work[r];
    const double steps = fmax(1, w->steps);
    json_array_append_new(
        each, json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "particles", w->particles / steps,
                        "near", w->near / steps, "contacts", w->contacts / steps, "visitors", w->visitors / steps,
                        "messages", w->exchanged.messages / steps, "message_bytes", w->exchanged.message_bytes / steps,
                        "gathers", w->exchanged.gathers / steps, "gathered_bytes", w->exchanged.gathered_bytes / steps,
                        "reductions", w->exchanged.reductions / steps, "compute_s", w->seconds - w->exchanged.seconds,
                        "exchange_s", w->exchanged.seconds));
  }
  free(work);
  return json_pack("{s:i, s:f, s:i, s:I, s:o}", "number", size, "imbalance", dem_homes_imbalance(d), "moves",
                   d->work.homes.nmove, "lists", (json_int_t)d->lists.nrebuild, "work", each);
}

static json_t *summary(run_state *run, double wall, const tdm_error *err) {
  const dem_run_settings *s = &run->settings;
  const dem_data *d = run->engine ? dem_engine_data(run->engine) : NULL;
  json_t *json = tdm_standalone_summary(&run->alone, err);
  json_t *own = json_pack("{s:{s:f, s:f, s:f}, s:I, s:f, s:i, s:f, s:o, s:{s:f, s:f, s:f, s:f}, s:i}", "settings",
                          "time.end", s->time.end, "time.dt", s->time.dt, "output.interval", s->interval, "steps",
                          (json_int_t)run->nstep, "simulated_s", (double)run->nstep * s->time.dt, "particles",
                          d ? d->state.nparticle : 0, "particle_steps", run->particle_steps, "particle_steps_per_s",
                          tdm_number_to_json(run->particle_steps / run->step), "wall_s", "all", wall, "setup",
                          run->alone.setup, "dem", run->step, "output", fmax(0, run->loop - run->step), "pictures",
                          tdm_outputs_pictures(&run->outputs));
  json_object_update_new(json, own);
  if (run->reposed)
    json_object_set_new(json, "repose", repose(run));
  if (d && !dem_alone(d))
    json_object_set_new(json, "ranks", ranks_summary(run));
  const tdm_standalone_figures *figures = &run->alone.figures;
  for (int c = 0; run->alone.values && c < figures->nchannel; c++) {
    tdm_screening_enter(json, figures->channel[c].name, figures->channel[c].unit, run->alone.values[c]);
    tdm_figure_enter(json, &figures->channel[c], run->alone.values[c]);
  }
  return json;
}

/* the files of the end: plots, summary.json, the last line of the log */
static void conclude(tdm_standalone *alone, tdm_error *err) {
  run_state *run = (run_state *)alone;
  char pairs[128];
  tdm_error late = {0}, notice = {0};
  const double t = (double)run->nstep * run->settings.time.dt;
  dem_moldyn_close(&run->moldyn, err);
  if (run->alone.channels) {
    tdm_standalone_close(&run->alone, err);
    if (run->settings.repose_along >= 0 && run->engine)
      run->reposed = take_snapshot(run, true, &late) == TDM_OK;
    if (!late.status)
      tdm_standalone_plot(&run->alone, "channels", NULL, &notice);
  }
  if (notice.status != TDM_OK && !tdm_plot_interrupted())
    tdm_remark(TDM_NOTICE, "plots", NULL, t, "%s", notice.message);
  tdm_outputs_finish(&run->outputs, t);
  double wall = tdm_clock() - alone->begin;
  json_t *json = summary(run, wall, err);
  tdm_results_summary(&run->alone.results, json, err);
  tdm_screening_print(stdout, json);
  json_decref(json);
  snprintf(pairs, sizeof pairs, "steps=%llu simulated=%g wall=%.3f", (unsigned long long)run->nstep, t, wall);
  tdm_standalone_log_end(pairs, err);
  if (run->nstep > 0)
    printf("%.6g s simulated in %llu steps, %d particles at the end; %.2f s wall, %.2f s of it until the start; %.3g "
           "particle-steps/s; results in %s\n",
           (double)run->nstep * run->settings.time.dt, (unsigned long long)run->nstep,
           dem_engine_data(run->engine)->state.nparticle, wall, run->alone.setup, run->particle_steps / run->step,
           run->alone.results.dir);
}

static void let_go(tdm_standalone *alone) {
  run_state *run = (run_state *)alone;
  tdm_outputs_end(&run->outputs);
  dem_run_settings_free(&run->settings);
  free(run->rows);
  dem_engine_destroy(&run->engine);
}

/* ---- check ---- */

static void print(const tdm_standalone *alone) {
  const run_state *run = (const run_state *)alone;
  const dem_run_settings *s = &run->settings;
  uint64_t total = tdm_total_steps(&s->time);
  printf("run\n");
  printf("  %-28s %g s in %llu steps of %g s\n", "time", s->time.end, (unsigned long long)total, s->time.dt);
  printf("  %-28s every %g s: %.0f rows\n", "time histories", s->interval, ceil(s->time.end / s->interval - 1e-6) + 1);
  tdm_outputs_print(&s->outputs, s->time.end);
  printf("dem: %s\n", dem_solver_ops.software);
}

const tdm_standalone_program dem_program = {
    .name = "tandem-dem",
    .help = "tandem-dem: the discrete element engine of tandem\n\n"
            "  tandem-dem run SCENE [--out DIR] [--force] [--set PATH=VALUE ...] [--strict] [--no-plots]\n"
            "      Run a scene that has only particles: a JSON file, or the name of a scene in scenarios/dem.\n"
            "      Results go to DIR (default: run-out): time histories, particles for ParaView, pictures.\n"
            "      --force            replace the results of an earlier run in DIR\n"
            "      --set PATH=VALUE   override a value of the scene: --set time.end=2 --set dem.pairs[0].friction=0.3\n"
            "      --strict           refuse a run that the solver has doubts about\n"
            "      --no-plots         leave out the plots of time histories\n\n"
            "  tandem-dem check SCENE [--set PATH=VALUE ...] [--strict]\n"
            "      Load and settle the scene, print what would run, step limits and doubts, and end.\n\n"
            "      --ranks P, of run, check and --connect: on P processes (MPI), as dem.ranks of a scene says; mpirun\n"
            "      must be installed.\n\n"
            "  tandem-dem import BASE.cin [OPTIONS]\n"
            "      Make a scene of the files of MOLDYN; see tandem-dem import --help.\n\n"
            "  tandem-dem bench [OPTIONS]\n"
            "      Measure the engine's speed; see tandem-dem bench --help.\n\n"
            "  tandem-dem --connect ENDPOINT [--name NAME] [--timeout SECONDS]\n"
            "      Take part in a co-simulation; \"tandem run SCENE\" starts it so by itself.\n"
            "      --connect ENDPOINT  where the server listens, for example ipc:///tmp/dir/tandem\n"
            "      --name NAME         the name in messages and logs (default: dem)\n"
            "      --timeout SECONDS   give up when the server is silent for so long (default: 30)\n\n"
            "  --scenarios DIR   where scenarios are (default: ./scenarios, the installed ones, those of the source)\n"
            "  --help, --version\n",
    .ops = &dem_solver_ops,
    .size = sizeof(run_state),
    .load = load,
    .start = start,
    .solve = solve,
    .conclude = conclude,
    .print = print,
    .let_go = let_go,
};
