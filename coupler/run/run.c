/* One co-simulation from a scene file to a result directory: see run.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/run/run.h"

#include "coupler/loop/window.h"
#include "coupler/observe/observers.h"
#include "coupler/run/check.h"
#include "coupler/run/private.h"
#include "coupler/scheme/schemes.h"
#include "protocol/base/log.h"
#include "protocol/base/progress.h"
#include "protocol/parameters/load.h"
#include "protocol/scene/remark.h"
#include "protocol/version.h"

#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

/* What a run holds, so that one place can let go of it whatever happened. */
typedef struct {
  const cpl_run_options *options;
  tdm_scene scene;
  cpl_settings settings;
  tdm_results results;
  cpl_session session;
  cpl_loop loop;
  cpl_observers observers;
  tdm_remarks remarks; /* the server's own */
  cpl_observer remarks_row;
  tdm_teller teller;
  uint64_t told;   /* changes of all remarks that were told */
  void *context;   /* ZeroMQ context shared with threads */
  cpl_private own; /* of the ipc socket, and of the logs of a check that leaves none */
  tdm_recorder *recorder;
  bool session_open, thread_hangs;
} run_state;

static const double grace = 3; /* time that solvers get to end after FINISH [s] */

/* ---- start ---- */

static tdm_status load(run_state *run, tdm_error *err) {
  const cpl_run_options *o = run->options;
  if (tdm_scene_load(&run->scene, o->scene, o->set, err) != TDM_OK)
    return err->status;
  tdm_scene_remark_unused(&run->scene);
  if (cpl_settings_read(&run->settings, &run->scene, o->schemes ? o->schemes : cpl_schemes, err) != TDM_OK)
    return err->status;
  if ((!o->out || run->settings.transport == CPL_IPC) && cpl_private_make(&run->own, err) != TDM_OK)
    return err->status;
  const tdm_results_def def = {.dir = o->out ? o->out : run->own.dir,
                               .scene = o->scene,
                               .log = "server.log",
                               .force = o->force || !o->out,
                               .beside = o->check};
  if (tdm_results_open(&run->results, &def, err) != TDM_OK)
    return err->status;
  tdm_log_open(run->results.log, "server");
  if (tdm_results_json(&run->results, "scene.json", run->scene.written, err) == TDM_OK && o->loaded)
    o->loaded(o->context);
  return err->status;
}

/* Where the server listens. ipc: a socket in a directory that only this user can enter. */
static void choose_endpoint(const run_state *run, char *endpoint, size_t size) {
  switch (run->settings.transport) {
  case CPL_INPROC:
    snprintf(endpoint, size, "inproc://tandem");
    break;
  case CPL_TCP:
    snprintf(endpoint, size, "%s", run->settings.address);
    break;
  case CPL_IPC:
    snprintf(endpoint, size, "ipc://%s/server", run->own.dir);
    break;
  }
}

static tdm_status launch(run_state *run, cpl_role role, tdm_error *err) {
  const cpl_settings *s = &run->settings;
  const char *endpoint = tdm_transport_endpoint(run->session.transport), *name = cpl_role_names[role];
  cpl_child **child = &run->session.partner[role].child;
  char log[4096], file[16], text[256];
  if (s->by_hand[role]) {
    if (!run->options->quiet)
      fprintf(stderr, "tandem: waiting for %s: start it with --connect %s\n", name, endpoint);
    return TDM_OK;
  }
  snprintf(file, sizeof file, "%s.log", name);
  tdm_results_claim(&run->results, file, log, sizeof log);
  if (s->transport == CPL_INPROC) {
    if (s->command[role] || !run->options->solver[role].ops)
      return tdm_fail(err, TDM_ERR_SCENE, s->command[role] ? s->solver_path[role] : "coupling.transport",
                      "a foreign solver cannot run as a thread; take \"ipc\" as coupling.transport");
    return cpl_launch_thread(child, run->options->solver[role].ops, endpoint, run->context, log, s->timeout, err);
  }
  const char *command = cpl_launch_command(s, role, run->options->solver[role].executable, text, sizeof text);
  cpl_launch_process(child, command, endpoint, name, log, s->timeout, err);
  if (err->status != TDM_OK && s->command[role])
    snprintf(err->path, sizeof err->path, "%s", s->solver_path[role]);
  return err->status;
}

static tdm_status start(run_state *run, tdm_error *err) {
  char endpoint[256];
  choose_endpoint(run, endpoint, sizeof endpoint);
  if (run->settings.transport == CPL_INPROC)
    run->context = tdm_context_create();
  run->session_open = true;
  if (cpl_session_open(&run->session, &run->settings, endpoint, run->context, err) != TDM_OK)
    return err->status;
  tdm_warning doubt;
  for (int k = 0; tdm_outputs_doubt(&run->settings.outputs, run->settings.time_end, k, &doubt); k++)
    json_array_append_new(run->session.warnings, json_pack("{s:s, s:s}", "path", doubt.path, "message", doubt.message));
  if (run->options->record && tdm_recorder_open(&run->recorder, run->options->record, err) != TDM_OK)
    return err->status;
  run->session.recorder = run->recorder;
  tdm_progress_begin(&run->session.progress, 0, "", run->options->quiet);
  for (int r = 0; r < CPL_NROLE; r++)
    if (launch(run, (cpl_role)r, err) != TDM_OK)
      return err->status;
  cpl_session_start(&run->session, &run->scene, err);
  tdm_progress_end(&run->session.progress);
  return err->status;
}

/* A warning of a solver: printed, or refused when strict. From now on its places are named as the scene was written. */
static tdm_status heed(run_state *run, json_t *warning, tdm_error *err) {
  tdm_error place = {0};
  char quoted[TDM_MESSAGE_MAX];
  const char *path = json_string_value(json_object_get(warning, "path"));
  const char *message = json_string_value(json_object_get(warning, "message"));
  tdm_fail(&place, TDM_ERR_SCENE, path, "%s", message ? message : "a warning without words");
  tdm_error told = place;
  tdm_scene_as_written(&run->scene, &place);
  tdm_log(TDM_LOG_WARNING, "doubtful", "path=%s message=%s", place.path,
          tdm_log_quote(quoted, sizeof quoted, place.message));
  if (run->options->strict)
    return tdm_fail(err, TDM_ERR_SCENE, told.path, "%s (refused because of --strict)", told.message);
  tdm_scene_locate(&run->scene, &told);
  if (!run->options->quiet)
    fprintf(stderr, "tandem: warning: %s\n", told.message);
  if (run->scene.kept) {
    json_object_set_new(warning, "path", json_string(place.path));
    json_object_set_new(warning, "message", json_string(place.message));
  }
  return TDM_OK;
}

static tdm_status heed_warnings(run_state *run, cpl_run_result *result, tdm_error *err) {
  size_t i;
  json_t *warning;
  json_array_foreach(run->session.warnings, i, warning) {
    result->warnings++;
    if (heed(run, warning, err) != TDM_OK)
      break;
  }
  return err->status;
}

/* ---- remarks ---- */

/* Those of both solvers and the server's own (new reference). */
static json_t *all_remarks(const run_state *run) {
  json_t *all = json_array(), *own = tdm_remarks_to_json(&run->remarks, "server");
  for (int r = 0; r < CPL_NROLE; r++)
    if (run->session.partner[r].remarks)
      json_array_extend(all, run->session.partner[r].remarks);
  json_array_extend(all, own);
  json_decref(own);
  return all;
}

/* What is new goes to the terminal at once. */
static void tell_remarks(run_state *run) {
  uint64_t changes = run->remarks.changes + run->session.remarks_taken;
  if (run->options->quiet || changes == run->told)
    return;
  run->told = changes;
  json_t *all = all_remarks(run);
  tdm_remarks_tell(&run->teller, all, run->session.progress.terminal ? TDM_PROGRESS_CLEAR : NULL);
  json_decref(all);
}

/* the observer of remarks: its row's context is the run */
static tdm_status remarks_open(const cpl_observer *self, const cpl_loop *loop, const cpl_outlet *outlet, void **own,
                               tdm_error *err) {
  (void)loop, (void)outlet, (void)err;
  *own = self->context;
  return TDM_OK;
}

static tdm_status remarks_window(void *own, const cpl_loop *loop, tdm_error *err) {
  (void)loop, (void)err;
  tell_remarks(own);
  return TDM_OK;
}

/* ---- the loop ---- */

static tdm_status open_observers(run_state *run, tdm_error *err) {
  const cpl_observer *const own[] = {&run->remarks_row, NULL}, *const none[] = {NULL};
  const cpl_observer *const *const tables[] = {cpl_observer_table, own,
                                               run->options->observers ? run->options->observers : none};
  const cpl_outlet outlet = {.results = &run->results, .scene = run->options->scene, .quiet = run->options->quiet};
  for (size_t t = 0; t < sizeof tables / sizeof tables[0]; t++)
    for (const cpl_observer *const *row = tables[t]; *row; row++)
      if (cpl_observers_open(&run->observers, *row, &run->loop, &outlet, err) != TDM_OK)
        return err->status;
  return TDM_OK;
}

static tdm_status solve(run_state *run, cpl_run_result *result, tdm_error *err) {
  if (tdm_results_start(&run->results, err) != TDM_OK ||
      cpl_loop_init(&run->loop, &run->settings, &run->session, err) != TDM_OK || open_observers(run, err) != TDM_OK)
    return err->status;
  double begin = tdm_clock();
  while (!cpl_loop_done(&run->loop) && cpl_loop_advance(&run->loop, &run->observers, err) == TDM_OK) {
    result->simulated = run->loop.t1;
    result->windows = run->loop.window;
    result->n_least = run->loop.n_least;
    result->n_most = run->loop.n_most;
  }
  result->adapts = run->settings.adapt.on;
  result->too_long = run->loop.too_long;
  if (run->loop.scheme->tell)
    run->loop.scheme->tell(&run->loop, result->scheme_line, sizeof result->scheme_line);
  result->loop = tdm_clock() - begin;
  for (int r = 0; r < CPL_NROLE; r++) {
    const cpl_partner *p = &run->session.partner[r];
    result->step[r] = p->step_time;
    result->exchange[r] = fmax(0, p->trip_time - p->step_time);
  }
  return err->status;
}

/* ---- end ---- */

double cpl_run_coupling(const cpl_run_result *r) {
  return r->loop - r->step[CPL_MBD] - r->step[CPL_DEM];
}

static void print_lengths(const cpl_run_result *r) {
  const cpl_too_long *t = &r->too_long;
  printf("  windows of %ld to %ld steps", r->n_least, r->n_most);
  if (t->taken_back > 0)
    printf("; %llu were taken back and solved again, shorter", (unsigned long long)t->taken_back);
  if (t->kept > 0)
    printf("; %llu stayed with a mismatch that was far too large", (unsigned long long)t->kept);
  if (t->taken_back + t->kept > 0)
    printf("; the first at %.6g s", t->first);
  putchar('\n');
}

void cpl_run_print(const cpl_run_result *r, const char *out) {
  double exchange = 0, own = cpl_run_coupling(r);
  printf("%.6g s simulated in %llu windows; %.2f s wall, %.2f s of it until the solvers were ready; results in %s\n",
         r->simulated, (unsigned long long)r->windows, r->wall, r->setup, out);
  if (r->adapts)
    print_lengths(r);
  if (r->scheme_line[0])
    printf("  %s\n", r->scheme_line);
  if (r->error_line[0])
    printf("  %s\n", r->error_line);
  if (r->error_large)
    printf("  that is large: %s\n",
           r->error_coupling < 0.5 * r->error
               ? "it comes from colliding particles and no step makes it smaller; trust mean values, not single paths"
               : "take shorter windows (coupling.n), or the scheme proxy or iterative");
  printf("  %-8s %10s %10s %12s\n", "part", "step [s]", "wait [s]", "exchange [s]");
  for (int role = 0; role < CPL_NROLE; role++) {
    printf("  %-8s %10.3f %10.3f %12.3f\n", cpl_role_names[role], r->step[role],
           fmax(0, r->loop - r->step[role] - r->exchange[role]), r->exchange[role]);
    exchange += r->exchange[role];
    own -= r->exchange[role];
  }
  printf("  %-8s %10.3f %10.3f %12.3f\n", "server", fmax(0, own), r->step[CPL_MBD] + r->step[CPL_DEM], exchange);
}

/* What became of the windows of "n": "auto" (new reference). */
static json_t *lengths(const cpl_run_result *r) {
  const cpl_too_long *t = &r->too_long;
  json_t *json = json_pack("{s:I, s:I, s:I, s:I}", "least", (json_int_t)r->n_least, "most", (json_int_t)r->n_most,
                           "taken_back", (json_int_t)t->taken_back, "kept", (json_int_t)t->kept);
  if (t->taken_back + t->kept > 0)
    json_object_set_new(json, "first_s", json_real(t->first));
  return json;
}

static json_t *summary(run_state *run, const cpl_run_result *r, const json_t *remarks, const tdm_error *err) {
  const cpl_settings *s = &run->settings;
  const cpl_scheme *scheme = run->session.scheme ? run->session.scheme : s->scheme;
  struct utsname machine = {0};
  uname(&machine);
  char name[4096];
  snprintf(name, sizeof name, "%s", run->options->scene);
  tdm_utf8_clean(name);
  json_t *json = json_pack(
      "{s:s, s:s, s:{s:f, s:f, s:o, s:s, s:f}, s:{s:s, s:s, s:i}, s:I, s:f, s:{s:f, s:f, s:f, s:f, s:f, s:f, s:f}}",
      "tandem", TDM_VERSION, "scene", name, "settings", "time.end", s->time_end, "time.dt", s->dt, "coupling.n",
      s->adapt.on ? json_string("auto") : json_integer(s->n), "coupling.scheme", scheme ? scheme->name : "",
      "output.interval", s->output_interval, "machine", "system", machine.sysname, "processor", machine.machine,
      "cores", (int)sysconf(_SC_NPROCESSORS_ONLN), "windows", (json_int_t)r->windows, "simulated_s", r->simulated,
      "wall_s", "all", r->wall, "setup", r->setup, "dem", r->step[CPL_DEM], "mbd", r->step[CPL_MBD], "coupling",
      cpl_run_coupling(r), "dem_exchange", r->exchange[CPL_DEM], "mbd_exchange", r->exchange[CPL_MBD]);
  if (s->adapt.on)
    json_object_set_new(json, "n", lengths(r));
  if (run->loop.scheme && run->loop.scheme->enter && r->windows > 0)
    run->loop.scheme->enter(&run->loop, json);
  if (tdm_scene_parameters(&run->scene))
    json_object_set(json, "parameters", (json_t *)tdm_scene_parameters(&run->scene));
  json_t *solvers = json_object();
  for (int role = 0; role < CPL_NROLE; role++) {
    const cpl_partner *p = &run->session.partner[role];
    json_t *report = p->report ? json_incref(p->report) : json_null();
    json_object_set_new(solvers, cpl_role_names[role],
                        json_pack("{s:s, s:o}", "software", p->software, "report", report));
  }
  json_object_set_new(json, "solvers", solvers);
  json_object_set_new(json, "warnings", run->session.warnings ? json_copy(run->session.warnings) : json_array());
  tdm_remarks_enter(json, remarks, &run->scene);
  cpl_observers_enter(&run->observers, json);
  json_object_set_new(json, "status", json_string(tdm_status_name(err->status)));
  if (err->status != TDM_OK)
    json_object_set_new(json, "error", json_string(err->message));
  return json;
}

/* The estimate of the error, from the summary, for who started the run. */
static void take_error(const json_t *estimate, cpl_run_result *r) {
  const json_t *worst = json_object_get(estimate, "worst");
  const char *name = json_string_value(json_object_get(estimate, "worst_body"));
  const json_t *body = name ? json_object_get(json_object_get(estimate, "bodies"), name) : NULL;
  const char *comma = "";
  int n = 0;
  const json_t *coupling = json_object_get(estimate, "worst_coupling");
  r->error = json_is_number(worst) ? json_number_value(worst) : NAN;
  r->error_coupling = json_is_number(coupling) ? json_number_value(coupling) : NAN;
  if (r->windows == 0 || !estimate)
    return;
  if (!body) {
    snprintf(r->error_line, sizeof r->error_line, "error, estimated: unknown (%s)",
             json_string_value(json_object_get(estimate, "unknown")));
    return;
  }
  n = snprintf(r->error_line, sizeof r->error_line, "error, estimated, of body \"%.60s\":", name);
  for (int q = 0; q < CPL_QUANTITIES; q++) {
    const json_t *of = json_object_get(body, cpl_quantity_names[q]), *share = json_object_get(of, "share");
    if (!json_is_number(share) || n >= (int)sizeof r->error_line)
      continue;
    n += snprintf(r->error_line + n, sizeof r->error_line - (size_t)n, "%s %.2g %s (%.2g %%)", comma,
                  json_number_value(json_object_get(of, "rms")), cpl_quantity_units[q], 100 * json_number_value(share));
    comma = ",";
  }
  if (r->error_coupling < 0.5 * r->error && n < (int)sizeof r->error_line)
    snprintf(r->error_line + n, sizeof r->error_line - (size_t)n,
             "; most of it is the rattle of the particles, of the exchange are %.2g %%", 100 * r->error_coupling);
  r->error_large = json_is_true(json_object_get(estimate, "large"));
}

/* End the solvers: a word to each, then time to end, then force. */
static void stop(run_state *run, const tdm_error *err) {
  cpl_child *child[CPL_NROLE];
  for (int r = 0; r < CPL_NROLE; r++)
    child[r] = run->session.partner[r].child;
  if (run->session_open)
    cpl_session_close(&run->session, err);
  for (int r = 0; r < CPL_NROLE; r++)
    if (!cpl_child_stop(&child[r], grace))
      run->thread_hangs = true;
  if (!run->thread_hangs) /* a thread that hangs keeps its socket: terminating the context would wait for it */
    tdm_context_destroy(&run->context);
}

static void finish(run_state *run, cpl_run_result *result, double begin, tdm_error *err) {
  tdm_error cut = {0}; /* an error of the run is worth more than that its record is not whole */
  run->session.recorder = NULL;
  if (tdm_recorder_close(&run->recorder, &cut) != TDM_OK && err->status == TDM_OK)
    *err = cut;
  char quoted[TDM_MESSAGE_MAX];
  tdm_scene_locate(&run->scene, err);
  cpl_observers_end(&run->observers, &run->loop, err);
  json_t *remarks = all_remarks(run);
  if (!run->options->quiet)
    tdm_remarks_tell_end(&run->teller, remarks, result->windows > 0 ? (size_t)result->warnings : 0);
  if (run->results.log) {
    result->wall = tdm_clock() - begin;
    json_t *json = summary(run, result, remarks, err);
    take_error(json_object_get(json, "error_estimate"), result);
    tdm_results_summary(&run->results, json, err);
    json_decref(json);
    if (err->status != TDM_OK)
      tdm_log(TDM_LOG_ERROR, "failed", "status=%s message=%s", tdm_status_name(err->status),
              tdm_log_quote(quoted, sizeof quoted, err->message));
    else
      tdm_log(TDM_LOG_INFO, "finished", "windows=%llu simulated=%g wall=%.3f", (unsigned long long)result->windows,
              result->simulated, result->wall);
  }
  json_decref(remarks);
  tdm_remarks_open(NULL);
  tdm_teller_free(&run->teller);
  if (run->results.staged && !run->options->quiet)
    fprintf(stderr, "tandem: notice: the results in %s stay as they are; the logs of this start are in %s\n",
            run->results.home, run->results.dir);
  stop(run, err);
  result->wall = tdm_clock() - begin;
  cpl_observers_free(&run->observers);
  cpl_loop_free(&run->loop);
  cpl_settings_free(&run->settings);
  tdm_scene_destroy(&run->scene);
  tdm_log_open(NULL, "server");
  tdm_results_close(&run->results);
  cpl_private_remove(&run->own);
}

tdm_status cpl_run(const cpl_run_options *options, cpl_run_result *result, tdm_error *err) {
  double begin = tdm_clock();
  run_state run = {.options = options, .teller = {.program = "tandem"}};
  run.teller.scene = &run.scene;
  run.remarks_row = (cpl_observer){.name = "remarks", .context = &run, .open = remarks_open, .window = remarks_window};
  tdm_remarks_open(&run.remarks);
  *result = (cpl_run_result){.error = NAN, .error_coupling = NAN};
  if (load(&run, err) == TDM_OK && start(&run, err) == TDM_OK && heed_warnings(&run, result, err) == TDM_OK) {
    result->setup = tdm_clock() - begin;
    if (!options->check)
      solve(&run, result, err);
    else if (!options->quiet)
      cpl_check_print(&run.scene, &run.settings, &run.session);
  }
  finish(&run, result, begin, err);
  result->thread_hangs = run.thread_hangs;
  if (run.thread_hangs)
    tdm_fail(err, TDM_ERR_SYSTEM, NULL, "a solver's thread does not end");
  return err->status;
}
