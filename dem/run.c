#include "dem/run.h"

#include "dem/check.h"
#include "dem/geometry/walls.h"
#include "dem/output/repose.h"
#include "dem/output/vtp.h"
#include "dem/solver.h"
#include "protocol/log.h"
#include "protocol/plot.h"
#include "protocol/print.h"
#include "protocol/progress.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

/* What a run holds, so that one place can let go of it whatever happened. */
typedef struct {
  const dem_run_options *options;
  tdm_scene scene;
  dem_run_settings settings;
  tdm_results results;
  void *solver;
  tdm_ready ready;
  json_t *warnings;

  FILE *channels;
  double last_flush;          /* wall clock [s] */
  uint64_t nrow;              /* rows of the time histories */
  double *values;             /* (nchannel) */
  int nframe, frame_capacity; /* times written for ParaView */
  double *frame_time;         /* (nframe) [s] */
  dem_snapshot snapshot;
  dem_bounds bounds; /* of the start */
  dem_polygons polygons;
  dem_pictures pictures;
  tdm_error picture_notice; /* the first thing that went wrong with gnuplot */

  uint64_t nstep; /* done */
  double particle_steps;
  double setup, loop, step; /* wall times: until the start, the loop, the solver's part of it [s] */
} run_state;

static const double flush_interval = 1; /* of the time histories, wall clock [s] */

/* ---- start ---- */

static tdm_status load_scene(run_state *run, tdm_error *err) {
  const dem_run_options *o = run->options;
  if (tdm_scene_read(&run->scene, o->scene, err) != TDM_OK)
    return err->status;
  for (const char *const *set = o->set; set && *set; set++)
    if (tdm_scene_set(&run->scene, *set, err) != TDM_OK)
      return err->status;
  return dem_run_settings_read(&run->settings, &run->scene, err);
}

static tdm_status open_results(run_state *run, tdm_error *err) {
  static const char *const old[] = {"channels.*", "particles_*.vtp", "walls_*.vtp",  "scene.pvd",
                                    "picture_*",  "pictures.*",      "summary.json", NULL};
  const dem_run_options *o = run->options;
  char log[4352];
  snprintf(log, sizeof log, "%s/dem.log", o->out);
  if (!o->force && access(log, F_OK) == 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL,
                    "%s: holds the results of an earlier run; give another directory with --out, or replace them with "
                    "--force",
                    o->out);
  if (tdm_results_open(&run->results, o->out, o->scene, "dem.log", old, err) != TDM_OK)
    return err->status;
  tdm_log_open(run->results.log, "dem");
  return tdm_results_json(&run->results, "scene.json", run->scene.root, err);
}

static tdm_status heed(run_state *run, const tdm_warning *w, tdm_error *err) {
  char quoted[TDM_MESSAGE_MAX];
  tdm_error place = {0};
  tdm_fail(&place, TDM_ERR_SCENE, w->path, "%s", w->message);
  json_array_append_new(run->warnings, json_pack("{s:s, s:s}", "path", place.path, "message", place.message));
  tdm_log(TDM_LOG_WARNING, "doubtful", "path=%s message=%s", place.path,
          tdm_log_quote(quoted, sizeof quoted, place.message));
  if (run->options->strict)
    return tdm_fail(err, TDM_ERR_SCENE, w->path, "%s (refused because of --strict)", w->message);
  tdm_scene_locate(&run->scene, &place);
  fprintf(stderr, "tandem-dem: warning: %s\n", place.message);
  return TDM_OK;
}

/* Doubts about the settings, and the solver's: printed, or refused when strict. */
static tdm_status heed_warnings(run_state *run, tdm_error *err) {
  for (int k = 0; k < run->settings.nwarning && err->status == TDM_OK; k++)
    heed(run, &run->settings.warning[k], err);
  for (int k = 0; k < run->ready.nwarning && err->status == TDM_OK; k++)
    heed(run, &run->ready.warning[k], err);
  return err->status;
}

/* the solver loaded and settled, as a participant without a server and without coupled bodies */
static tdm_status start_solver(run_state *run, tdm_error *err) {
  const tdm_assignment assignment = {.scene = json_object_get(run->scene.root, "dem"),
                                     .time_end = run->settings.time.end,
                                     .dt = run->settings.time.dt,
                                     .n = 1};
  run->warnings = json_array();
  if (dem_solver_ops.create(&run->solver, &assignment, &run->ready, NULL, err) != TDM_OK)
    return err->status;
  run->values = calloc((size_t)run->ready.nchannel + 1, sizeof *run->values);
  if (!run->values || !run->warnings)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  return heed_warnings(run, err);
}

/* ---- outputs ---- */

static tdm_status take_snapshot(run_state *run, tdm_error *err) {
  return dem_snapshot_take(&run->snapshot, dem_solver_data(run->solver), err);
}

static tdm_status make_polygons(run_state *run, tdm_error *err) {
  return dem_polygons_make(&run->polygons, dem_solver_data(run->solver), &run->bounds, err);
}

static tdm_status begin_outputs(run_state *run, tdm_error *err) {
  run->channels = tdm_results_file(&run->results, "channels.csv", err);
  if (!run->channels || take_snapshot(run, err) != TDM_OK)
    return err->status;
  fputs("time [s]", run->channels);
  for (int c = 0; c < run->ready.nchannel; c++)
    fprintf(run->channels, ",%s [%s]", run->ready.channel[c].name, run->ready.channel[c].unit);
  fputc('\n', run->channels);
  memcpy(run->values, run->ready.initial, (size_t)run->ready.nchannel * sizeof *run->values);
  run->bounds = dem_scene_bounds(dem_solver_data(run->solver), &run->snapshot);
  dem_pictures_begin(&run->pictures, &run->settings.pictures, &run->results, &run->bounds);
  return TDM_OK;
}

static tdm_status write_row(run_state *run, double time, tdm_error *err) {
  tdm_write_row(run->channels, time, run->values, run->ready.nchannel);
  run->nrow++;
  double now = tdm_clock();
  if (now - run->last_flush > flush_interval) {
    run->last_flush = now;
    fflush(run->channels);
  }
  if (ferror(run->channels))
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s/channels.csv: cannot be written: %s; what is there stays readable",
             run->results.dir, strerror(errno));
  return err->status;
}

static tdm_status write_frame(run_state *run, tdm_error *err) {
  if (run->nframe == run->frame_capacity) {
    int room = 2 * run->frame_capacity + 64;
    double *time = realloc(run->frame_time, (size_t)room * sizeof *time);
    if (!time)
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    run->frame_time = time;
    run->frame_capacity = room;
  }
  run->frame_time[run->nframe] = run->nframe * run->settings.particles_interval;
  if (make_polygons(run, err) != TDM_OK ||
      dem_vtp_particles(&run->results, run->nframe, &run->snapshot, err) != TDM_OK ||
      dem_vtp_walls(&run->results, run->nframe, &run->polygons, err) != TDM_OK)
    return err->status;
  run->nframe++;
  return dem_pvd_write(&run->results, run->frame_time, run->nframe, err);
}

/* Pictures need gnuplot: without it the run goes on, but not when their data cannot be written. */
static tdm_status draw(run_state *run, tdm_error *err) {
  tdm_error notice = {0};
  int before = run->pictures.drawn;
  if (make_polygons(run, err) != TDM_OK)
    return err->status;
  if (dem_picture_draw(&run->pictures, &run->snapshot, &run->polygons, &notice) != TDM_OK)
    tdm_fail(run->pictures.drawn > before ? &run->picture_notice : err, notice.status, NULL, "%s", notice.message);
  return err->status;
}

/* ---- when outputs are due ---- */

/* the step that ends at time t or first after it */
static uint64_t step_at(const run_state *run, double t) {
  return (uint64_t)fmax(0, ceil(t / run->settings.time.dt - 1e-6));
}

static bool picture_left(const run_state *run) {
  return run->pictures.drawn < run->settings.pictures.ntime;
}

static uint64_t row_step(const run_state *run) {
  return step_at(run, (double)run->nrow * run->settings.interval);
}

static uint64_t frame_step(const run_state *run) {
  return run->settings.particles_interval > 0 ? step_at(run, run->nframe * run->settings.particles_interval)
                                              : UINT64_MAX;
}

static uint64_t picture_step(const run_state *run) {
  return picture_left(run) ? step_at(run, run->settings.pictures.time[run->pictures.drawn]) : UINT64_MAX;
}

static uint64_t least(uint64_t a, uint64_t b) {
  return a < b ? a : b;
}

/* a row on the grid; and one of the last state, which need not lie on it */
static tdm_status write_due(run_state *run, tdm_error *err) {
  double on_grid = (double)run->nrow * run->settings.interval, now = (double)run->nstep * run->settings.time.dt;
  bool due = run->nstep >= row_step(run), last = run->nstep == tdm_total_steps(&run->settings.time);
  if ((due || last) && write_row(run, due ? on_grid : now, err) != TDM_OK)
    return err->status;
  bool frame = run->nstep >= frame_step(run), picture = run->nstep >= picture_step(run);
  if (frame || picture || run->settings.pictures.ntime > 0)
    if (take_snapshot(run, err) != TDM_OK || dem_pictures_watch(&run->pictures, &run->snapshot, err) != TDM_OK)
      return err->status;
  if (frame && write_frame(run, err) != TDM_OK)
    return err->status;
  while (picture && run->nstep >= picture_step(run) && draw(run, err) == TDM_OK)
    ;
  return err->status;
}

/* ---- the loop ---- */

/* from the step reached to step `end`; the time histories are sampled there if they are due */
static tdm_status advance(run_state *run, uint64_t end, tdm_error *err) {
  const dem_data *d = dem_solver_data(run->solver);
  double dt = run->settings.time.dt, sample = (double)run->nrow * run->settings.interval, begin = tdm_clock();
  const tdm_step step = {.t0 = (double)run->nstep * dt,
                         .t1 = (double)end * dt,
                         .nstep = end - run->nstep,
                         .nsample = end >= row_step(run) || end == tdm_total_steps(&run->settings.time),
                         .sample_time = &sample};
  tdm_result result = {.nsample = step.nsample, .nchannel = run->ready.nchannel, .channel = run->values};
  double nparticle = d->nparticle;
  if (dem_solver_ops.step(run->solver, &step, &result, err) != TDM_OK)
    return err->status;
  run->particle_steps += 0.5 * (nparticle + d->nparticle) * (double)step.nstep;
  run->step += tdm_clock() - begin;
  run->nstep = end;
  return TDM_OK;
}

static tdm_status solve(run_state *run, tdm_error *err) {
  tdm_progress progress;
  uint64_t total = tdm_total_steps(&run->settings.time);
  double begin = tdm_clock(), dt = run->settings.time.dt;
  if (begin_outputs(run, err) != TDM_OK || write_due(run, err) != TDM_OK)
    return err->status;
  tdm_progress_begin(&progress, (double)total * dt, "steps", false);
  while (run->nstep < total && err->status == TDM_OK) {
    uint64_t next = least(least(row_step(run), frame_step(run)), least(picture_step(run), total));
    if (advance(run, next, err) == TDM_OK)
      write_due(run, err);
    tdm_progress_update(&progress, (double)run->nstep * dt, run->nstep);
  }
  tdm_progress_end(&progress);
  run->loop = tdm_clock() - begin;
  return err->status;
}

/* ---- end ---- */

static json_t *real_or_null(double x) {
  return isfinite(x) ? json_real(x) : json_null();
}

static json_t *repose(const run_state *run) {
  dem_repose r = dem_repose_of(&run->snapshot, run->settings.repose_along);
  return json_pack("{s:o, s:o, s:o}", "mean_deg", real_or_null(r.mean), "low_side_deg", real_or_null(r.low),
                   "high_side_deg", real_or_null(r.high));
}

static json_t *summary(const run_state *run, double wall, const tdm_error *err) {
  const dem_run_settings *s = &run->settings;
  const dem_data *d = run->solver ? dem_solver_data(run->solver) : NULL;
  struct utsname machine = {0};
  char name[4096];
  uname(&machine);
  snprintf(name, sizeof name, "%s", run->options->scene);
  tdm_utf8_clean(name);
  json_t *json = json_pack(
      "{s:s, s:s, s:s, s:{s:f, s:f, s:f}, s:{s:s, s:s, s:i}, s:I, s:f, s:i, s:f, s:o, s:{s:f, s:f, s:f, s:f}}",
      "tandem", TANDEM_VERSION, "software", dem_solver_ops.software, "scene", name, "settings", "time.end", s->time.end,
      "time.dt", s->time.dt, "output.interval", s->interval, "machine", "system", machine.sysname, "processor",
      machine.machine, "cores", (int)sysconf(_SC_NPROCESSORS_ONLN), "steps", (json_int_t)run->nstep, "simulated_s",
      (double)run->nstep * s->time.dt, "particles", d ? d->nparticle : 0, "particle_steps", run->particle_steps,
      "particle_steps_per_s", real_or_null(run->particle_steps / run->step), "wall_s", "all", wall, "setup", run->setup,
      "dem", run->step, "output", fmax(0, run->loop - run->step));
  if (s->repose_along >= 0)
    json_object_set_new(json, "repose", repose(run));
  json_object_set_new(json, "pictures", json_integer(run->pictures.drawn));
  json_object_set(json, "report", run->ready.report ? run->ready.report : json_null());
  json_object_set(json, "warnings", run->warnings ? run->warnings : json_null());
  json_object_set_new(json, "status", json_string(tdm_status_name(err->status)));
  if (err->status != TDM_OK)
    json_object_set_new(json, "error", json_string(err->message));
  return json;
}

/* channels.png: a panel a unit */
static tdm_status plot_channels(const run_state *run, tdm_error *err) {
  enum { PANELS = 16, CURVES = 64 };
  tdm_plot plot[PANELS] = {0};
  tdm_curve curve[PANELS][CURVES];
  char using[CURVES][16];
  int nplot = 0, n = run->ready.nchannel < CURVES ? run->ready.nchannel : CURVES;
  for (int c = 0; c < n; c++) {
    const tdm_channel *channel = &run->ready.channel[c];
    int k = 0;
    while (k < nplot && strcmp(plot[k].ylabel, channel->unit) != 0)
      k++;
    if (k == PANELS)
      continue;
    if (k == nplot)
      plot[nplot++] = (tdm_plot){.title = "", .xlabel = "time [s]", .ylabel = channel->unit, .curve = curve[k]};
    snprintf(using[c], sizeof using[c], "1:%d", c + 2);
    curve[k][plot[k].ncurve++] = (tdm_curve){"channels.csv", using[c], channel -> name, "lines lw 2"};
  }
  return tdm_plot_write(run->results.dir, "channels", nplot, plot, err);
}

static void close_channels(run_state *run, tdm_error *err) {
  bool bad = ferror(run->channels);
  if (fclose(run->channels) != 0 || bad)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s/channels.csv: cannot be written: %s", run->results.dir, strerror(errno));
  run->channels = NULL;
}

/* what makes the results doubtful and is in the log alone otherwise */
static void doubt(const run_state *run) {
  const dem_data *d = dem_solver_data(run->solver);
  uint64_t told = 0;
  for (int k = 0; k < DEM_GUARD_KINDS; k++)
    told += d->guard.told[k];
  long lost = dem_count_lost(d);
  if (told > 0)
    fprintf(stderr,
            "tandem-dem: warning: the guard saw %llu doubtful states; %s/dem.log says which. With dem.guard.action "
            "\"stop\" a run ends at the first\n",
            (unsigned long long)told, run->results.dir);
  if (lost > 0)
    fprintf(
        stderr,
        "tandem-dem: warning: %ld particles are behind a plane at the end (particles.lost); reduce time.dt or their "
        "speed if they went through it\n",
        lost);
}

/* the files of the end: plots, summary.json, the last line of the log */
static void conclude(run_state *run, double begin, tdm_error *err) {
  char quoted[TDM_MESSAGE_MAX];
  tdm_error late = {0};
  if (run->channels) {
    close_channels(run, err);
    if (run->solver && take_snapshot(run, &late) == TDM_OK)
      plot_channels(run, &run->picture_notice);
  }
  if (run->pictures.drawn > 1)
    dem_pictures_row(&run->pictures, &run->picture_notice);
  if (run->picture_notice.status != TDM_OK)
    fprintf(stderr, "tandem-dem: notice: %s\n", run->picture_notice.message);
  if (run->nstep > 0)
    doubt(run);
  double wall = tdm_clock() - begin;
  json_t *json = summary(run, wall, err);
  tdm_results_json(&run->results, "summary.json", json, err);
  json_decref(json);
  if (err->status != TDM_OK)
    tdm_log(TDM_LOG_ERROR, "failed", "status=%s message=%s", tdm_status_name(err->status),
            tdm_log_quote(quoted, sizeof quoted, err->message));
  else
    tdm_log(TDM_LOG_INFO, "finished", "steps=%llu simulated=%g wall=%.3f", (unsigned long long)run->nstep,
            (double)run->nstep * run->settings.time.dt, wall);
  if (run->nstep > 0)
    printf("%.6g s simulated in %llu steps, %d particles at the end; %.2f s wall, %.2f s of it until the start; %.3g "
           "particle-steps/s; results in %s\n",
           (double)run->nstep * run->settings.time.dt, (unsigned long long)run->nstep, run->snapshot.count, wall,
           run->setup, run->particle_steps / run->step, run->results.dir);
}

static void let_go(run_state *run) {
  tdm_log_open(NULL, "dem");
  tdm_results_close(&run->results);
  dem_solver_ops.destroy(run->solver);
  dem_snapshot_free(&run->snapshot);
  dem_polygons_free(&run->polygons);
  dem_pictures_free(&run->pictures);
  dem_run_settings_free(&run->settings);
  json_decref(run->warnings);
  free(run->values);
  free(run->frame_time);
  tdm_scene_destroy(&run->scene);
}

tdm_status dem_run(const dem_run_options *options, tdm_error *err) {
  double begin = tdm_clock();
  run_state run = {.options = options};
  if (load_scene(&run, err) == TDM_OK && open_results(&run, err) == TDM_OK && start_solver(&run, err) == TDM_OK) {
    run.setup = tdm_clock() - begin;
    solve(&run, err);
  }
  tdm_scene_locate(&run.scene, err);
  if (run.results.log)
    conclude(&run, begin, err);
  let_go(&run);
  return err->status;
}

/* ---- check ---- */

static void print_scene(const run_state *run) {
  const dem_run_settings *s = &run->settings;
  uint64_t total = tdm_total_steps(&s->time);
  printf("run\n");
  printf("  %-28s %g s in %llu steps of %g s\n", "time", s->time.end, (unsigned long long)total, s->time.dt);
  printf("  %-28s every %g s: %.0f rows\n", "time histories", s->interval, floor(s->time.end / s->interval + 1e-6) + 1);
  if (s->particles_interval > 0)
    printf("  %-28s every %g s: %.0f files\n", "particles for ParaView", s->particles_interval,
           floor(s->time.end / s->particles_interval + 1e-6) + 1);
  if (s->pictures.ntime > 0)
    printf("  %-28s %d\n", "pictures", s->pictures.ntime);
  printf("dem: %s\n", dem_solver_ops.software);
  tdm_print_json(run->ready.report);
  printf("%d warning%s\n", run->ready.nwarning, run->ready.nwarning == 1 ? "" : "s");
}

tdm_status dem_run_check(const dem_run_options *options, tdm_error *err) {
  run_state run = {.options = options};
  if (load_scene(&run, err) == TDM_OK && start_solver(&run, err) == TDM_OK)
    print_scene(&run);
  tdm_scene_locate(&run.scene, err);
  let_go(&run);
  return err->status;
}
