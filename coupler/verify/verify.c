/* The verification runner: see verify.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/verify/verify.h"

#include "coupler/verify/jobs.h"
#include "protocol/app/command_line.h"
#include "protocol/app/find.h"
#include "protocol/base/log.h"
#include "protocol/results/results.h"
#include "protocol/scene/json.h"
#include "protocol/version.h"

#include <assert.h>
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

typedef struct {
  char name[64], case_name[64];
  double value, limit;
  cpl_limit_kind kind;
  bool pass;
  cpl_run_result run; /* of the run that it was measured in */
} measure;

typedef struct {
  const cpl_scenario *scenario;
  measure *measure;
  int nmeasure;
  double wall;
  cpl_run_result total; /* sum over the scenario's runs */
  tdm_error err;
  bool pass;
} outcome;

struct cpl_verify {
  const cpl_verify_options *options;
  outcome *now;        /* scenario under way */
  cpl_run_result last; /* its last run */
  char dir[4096];      /* its directory */
  bool plot_notice;    /* printed once */
};

/* ---- for scenarios ---- */

const char *cpl_verify_dir(const cpl_verify *v) {
  return v->dir;
}

/* A case's name as a directory: "m_p=0.01 wall_mass=1e8" -> "m_p=0.01_wall_mass=1e8". */
static void case_dir(const cpl_verify *v, const char *case_name, char *out, size_t size) {
  int n = snprintf(out, size, "%s%s%s", v->dir, *case_name ? "/" : "", case_name);
  for (int i = (int)strlen(v->dir) + 1; i < n && i < (int)size; i++)
    if (out[i] == ' ' || out[i] == '/')
      out[i] = '_';
}

/* the last run into the scenario's total */
static void count_last(cpl_verify *v) {
  cpl_run_result *total = &v->now->total;
  total->windows += v->last.windows;
  total->simulated += v->last.simulated;
  total->wall += v->last.wall;
  total->setup += v->last.setup;
  total->loop += v->last.loop;
  for (int r = 0; r < CPL_NROLE; r++)
    total->step[r] += v->last.step[r];
}

tdm_status cpl_verify_find(const cpl_verify *v, const char *group, const char *name, char *scene, size_t size,
                           tdm_error *err) {
  return tdm_find_scene(scene, size, group, name, v->options->scenarios, err);
}

tdm_status cpl_verify_run(cpl_verify *v, const char *case_name, const char *const *set, char *dir, size_t size,
                          tdm_error *err) {
  char scene[4096];
  case_dir(v, case_name, dir, size);
  if (cpl_verify_find(v, "", v->now->scenario->name, scene, sizeof scene, err) != TDM_OK)
    return err->status;
  cpl_run_options run = {.scene = scene, .set = set, .out = dir, .force = true};
  run.quiet = !isatty(2);
  memcpy(run.solver, v->options->solver, sizeof run.solver);
  if (isatty(2))
    fprintf(stderr, "\r\033[K%s %s", v->now->scenario->name, case_name);
  cpl_run(&run, &v->last, err);
  count_last(v);
  return err->status;
}

bool cpl_verify_full(const cpl_verify *v) {
  return v->options->full;
}

/* ---- many runs ---- */

void cpl_verify_case_set(cpl_verify_case *c, const char *format, ...) {
  va_list list;
  assert(c->nset < CPL_CASE_SETTINGS);
  va_start(list, format);
  int n = vsnprintf(c->set[c->nset++], CPL_SETTING_MAX, format, list);
  va_end(list);
  assert(n < CPL_SETTING_MAX);
  (void)n;
}

void cpl_verify_about(cpl_verify *v, const cpl_verify_case *c) {
  v->last = c->result;
}

/* What a run's process leaves for this one, in shared memory. */
typedef struct {
  cpl_run_result result;
  tdm_error err;
} left_behind;

typedef struct {
  cpl_verify *v;
  int n, done;
  cpl_verify_case *c;
  left_behind *left; /* (n) */
} many;

/* Run a case, or only settle its bed and stop (check). */
static void run_case(const cpl_verify *v, const cpl_verify_case *c, bool check, left_behind *left) {
  const char *set[CPL_CASE_SETTINGS + 2], *name = c->scene ? c->scene : v->now->scenario->name;
  char scene[4096], store[4352], out[4352];
  int n = 0;
  for (; n < c->nset; n++)
    set[n] = c->set[n];
  snprintf(store, sizeof store, "dem.settle.store=\"%s/bed\"", v->dir);
  if (c->shares_bed)
    set[n++] = store;
  set[n] = NULL;
  snprintf(out, sizeof out, "%s/bed-out", v->dir);
  if (cpl_verify_find(v, "", name, scene, sizeof scene, &left->err) != TDM_OK)
    return;
  cpl_run_options run = {
      .scene = scene, .set = set, .out = check ? out : c->dir, .force = true, .quiet = true, .check = check};
  memcpy(run.solver, v->options->solver, sizeof run.solver);
  cpl_run(&run, &left->result, &left->err);
}

/* Settle the bed once, before runs share it. One that cannot be made fails in its cases, with words. */
static void make_bed(const cpl_verify *v, int n, const cpl_verify_case *c) {
  char file[4352];
  int i = 0;
  snprintf(file, sizeof file, "%s/bed", v->dir);
  while (i < n && !c[i].shares_bed)
    i++;
  if (i < n && access(file, F_OK) != 0 && tdm_make_directory(v->dir, NULL) == TDM_OK)
    run_case(v, &c[i], true, &(left_behind){0});
}

static bool begin_case(void *context, int i) {
  many *m = context;
  tdm_fail(&m->left[i].err, TDM_ERR_LOST, NULL, "%s: the run's process ended without a word", m->c[i].name);
  return true;
}

static int work_case(void *context, int i) {
  many *m = context;
  left_behind left = {0};
  run_case(m->v, &m->c[i], false, &left);
  m->left[i] = left;
  return 0;
}

static void end_case(void *context, int i, int status, double seconds) {
  many *m = context;
  cpl_verify_case *c = &m->c[i];
  (void)status;
  c->result = m->left[i].result;
  c->err = m->left[i].err;
  m->v->last = c->result;
  count_last(m->v);
  m->done++;
  if (isatty(2))
    fprintf(stderr, "\r\033[K%s [%d/%d] %s, %.1f s", m->v->now->scenario->name, m->done, m->n, c->name, seconds);
}

tdm_status cpl_verify_run_many(cpl_verify *v, int n, cpl_verify_case *c, int at_once, tdm_error *err) {
  size_t size = (size_t)n * sizeof(left_behind);
  left_behind *left = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (left == MAP_FAILED)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  many m = {v, n, 0, c, left};
  for (int i = 0; i < n; i++)
    case_dir(v, c[i].name, c[i].dir, sizeof c[i].dir);
  make_bed(v, n, c);
  int jobs = at_once ? at_once : v->options->jobs ? v->options->jobs : cpl_jobs_processors();
  cpl_jobs_run(&(cpl_jobs){n, jobs, &m, begin_case, work_case, end_case});
  munmap(left, size);
  return tdm_interrupted ? tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted") : TDM_OK;
}

void cpl_verify_alone(cpl_verify *v, cpl_role role, double simulated, double wall) {
  v->last = (cpl_run_result){.simulated = simulated, .wall = wall, .loop = wall};
  v->last.step[role] = wall;
  count_last(v);
}

/* What goes wrong with a plot is a notice, once. */
static void notice(cpl_verify *v, const tdm_error *err) {
  if (err->status != TDM_OK && err->status != TDM_ERR_INTERRUPTED && !v->plot_notice)
    fprintf(stderr, "tandem: notice: %s\n", err->message);
  v->plot_notice = v->plot_notice || err->status != TDM_OK;
}

tdm_status cpl_verify_compare(cpl_verify *v, const char *dir, cpl_comparison *c, tdm_error *err) {
  tdm_error plot = {0};
  if (v->now->scenario->compare(dir, c, err) != TDM_OK || cpl_comparison_write(c, dir, err) != TDM_OK)
    return err->status;
  cpl_comparison_plot(c, dir, &plot);
  notice(v, &plot);
  return TDM_OK;
}

const cpl_scenario *cpl_scenario_of(const cpl_scenario *table, const json_t *scene, tdm_error *err) {
  const char *name = json_string_value(json_object_get(scene, "scenario")), *known[256];
  int nknown = 0;
  if (!name)
    return NULL;
  for (const cpl_scenario *s = table; s->name && nknown < 256; s++) {
    if (strcmp(s->name, name) == 0)
      return s;
    known[nknown++] = s->name;
  }
  const char *near = tdm_nearest(name, known, nknown);
  tdm_fail(err, TDM_ERR_SCENE, "scenario", "\"%s\" is no scenario%s%s%s", name, near ? "; did you mean \"" : "",
           near ? near : "", near ? "\"?" : "; leave the key out if none fits");
  return NULL;
}

void cpl_verify_measure(cpl_verify *v, const char *name, const char *case_name, double value, cpl_limit_kind kind,
                        double limit) {
  outcome *o = v->now;
  measure *grown = realloc(o->measure, (size_t)(o->nmeasure + 1) * sizeof *grown);
  if (!grown) {
    tdm_fail(&o->err, TDM_ERR_MEMORY, NULL, "out of memory");
    return;
  }
  o->measure = grown;
  measure *m = &o->measure[o->nmeasure++];
  *m = (measure){.value = value, .limit = limit, .kind = kind, .run = v->last};
  snprintf(m->name, sizeof m->name, "%s", name);
  snprintf(m->case_name, sizeof m->case_name, "%s", case_name);
  m->pass = kind == CPL_NO_LIMIT || (kind == CPL_AT_LEAST && value >= limit) ||
            (kind == CPL_AT_MOST && (value < 0 ? -value : value) <= limit);
}

void cpl_verify_plot(cpl_verify *v, const char *name, int nplot, const tdm_plot *plot) {
  tdm_error err = {0};
  tdm_plot_write(v->dir, name, nplot, plot, &err);
  notice(v, &err);
}

/* ---- the table ---- */

static void print_head(void) {
  printf("%-22s %-22s %-36s %12s %9s %10s %8s %15s  %s\n", "scenario", "measure", "case", "value", "limit", "simulated",
         "wall", "DEM/MBD/coupling", "ok");
}

static void print_measure(const char *scenario, const measure *m) {
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

static void print_outcome(const outcome *o) {
  if (isatty(2))
    fprintf(stderr, "\r\033[K");
  for (int i = 0; i < o->nmeasure; i++)
    print_measure(o->scenario->name, &o->measure[i]);
  if (o->err.status != TDM_OK)
    printf("%-22s FAILED: %s\n", o->scenario->name, o->err.message);
  fflush(stdout);
}

/* ---- the JSON file ---- */

static json_t *outcome_to_json(const outcome *o) {
  json_t *measures = json_array();
  for (int i = 0; i < o->nmeasure; i++) {
    const measure *m = &o->measure[i];
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
  if (o->err.status != TDM_OK)
    json_object_set_new(json, "error", json_string(o->err.message));
  return json;
}

static tdm_status write_json(const char *file, const outcome *outcomes, int n, bool pass, double wall, tdm_error *err) {
  json_t *scenarios = json_array();
  for (int i = 0; i < n; i++)
    json_array_append_new(scenarios, outcome_to_json(&outcomes[i]));
  json_t *json = json_pack("{s:s, s:b, s:f, s:o}", "tandem", TDM_VERSION, "pass", (int)pass, "wall_s", wall,
                           "scenarios", scenarios);
  int failed = json_dump_file(json, file, JSON_INDENT(2));
  json_decref(json);
  return failed ? tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno)) : TDM_OK;
}

/* ---- choosing and running ---- */

static bool chosen(const cpl_scenario *s, const char *const *names) {
  if (!*names)
    return strcmp(s->group, "scenarios") == 0;
  for (; *names; names++)
    if (strcmp(*names, s->name) == 0 || strcmp(*names, s->group) == 0 || strcmp(*names, "all") == 0)
      return true;
  return false;
}

/* Every name must be a scenario, a group or "all". */
static tdm_status check_names(const cpl_verify_options *o, tdm_error *err) {
  for (const char *const *name = o->name; *name; name++) {
    const char *known[256] = {"all"};
    int nknown = 1;
    bool found = strcmp(*name, "all") == 0;
    for (const cpl_scenario *s = o->scenario; s->name && nknown < 254; s++) {
      found = found || strcmp(*name, s->name) == 0 || strcmp(*name, s->group) == 0;
      known[nknown++] = s->name;
      known[nknown++] = s->group;
    }
    if (found)
      continue;
    const char *near = tdm_nearest(*name, known, nknown);
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "verify: \"%s\" is neither a scenario nor a group%s%s%s", *name,
                    near ? "; did you mean \"" : "; see tandem --help", near ? near : "", near ? "\"?" : "");
  }
  return TDM_OK;
}

static void run_scenario(cpl_verify *v, outcome *o) {
  double begin = tdm_clock();
  v->now = o;
  v->last = (cpl_run_result){0};
  snprintf(v->dir, sizeof v->dir, "%s/%s", v->options->out, o->scenario->name);
  char bed[4352];
  snprintf(bed, sizeof bed, "%s/bed", v->dir);
  unlink(bed); /* of an earlier verification, whose scene may have been another */
  tdm_error err = {0};
  if (o->scenario->verify(v, &err) != TDM_OK)
    o->err = err;
  o->wall = tdm_clock() - begin;
  o->pass = o->err.status == TDM_OK;
  for (int i = 0; i < o->nmeasure; i++)
    o->pass = o->pass && o->measure[i].pass;
  print_outcome(o);
}

/* The chosen scenarios, into a directory that is open. */
static tdm_status verify_chosen(const cpl_verify_options *options, tdm_error *err) {
  double begin = tdm_clock();
  cpl_verify v = {.options = options};
  int nscenario = 0, n = 0;
  while (options->scenario[nscenario].name)
    nscenario++;
  outcome *outcomes = calloc((size_t)nscenario + 1, sizeof *outcomes);
  if (!outcomes)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  bool pass = true, interrupted = false;
  print_head();
  for (int i = 0; i < nscenario && !interrupted; i++) {
    if (!chosen(&options->scenario[i], options->name))
      continue;
    outcomes[n].scenario = &options->scenario[i];
    run_scenario(&v, &outcomes[n]);
    pass = pass && outcomes[n].pass;
    interrupted = outcomes[n].err.status == TDM_ERR_INTERRUPTED || tdm_interrupted;
    n++;
  }
  double wall = tdm_clock() - begin;
  printf("%s in %.1f s; curves and plots in %s\n", pass ? "all limits met" : "limits were MISSED or scenarios failed",
         wall, options->out);
  if (options->json)
    write_json(options->json, outcomes, n, pass, wall, err);
  for (int i = 0; i < n; i++)
    free(outcomes[i].measure);
  free(outcomes);
  if (interrupted)
    return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted");
  if (!pass)
    return tdm_fail(err, TDM_ERR_LIMIT, NULL, "verification failed: see the table above");
  return err->status;
}

tdm_status cpl_verify_all(const cpl_verify_options *options, tdm_error *err) {
  tdm_results results;
  const tdm_results_def def = {.dir = options->out, .force = options->force, .beside = true};
  if (check_names(options, err) != TDM_OK || tdm_results_open(&results, &def, err) != TDM_OK)
    return err->status;
  if (tdm_check_writable(options->json, err) == TDM_OK && tdm_results_start(&results, err) == TDM_OK)
    verify_chosen(options, err);
  tdm_results_close(&results);
  return err->status;
}
