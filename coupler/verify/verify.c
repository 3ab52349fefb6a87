/* The verification runner: see verify.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/verify/verify.h"

#include "coupler/cells/jobs.h"
#include "protocol/app/command_line.h"
#include "protocol/app/find.h"
#include "protocol/base/log.h"
#include "protocol/results/results.h"

#include <assert.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

struct cpl_verify {
  const cpl_verify_options *options;
  cpl_outcome *now;    /* scenario under way */
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

tdm_status cpl_verify_find_file(const cpl_verify *v, const char *name, char *file, size_t size, tdm_error *err) {
  return tdm_find_scenario_file(file, size, name, v->options->scenarios, err);
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

const char *cpl_verify_name(const cpl_verify *v) {
  return v->now->scenario->name;
}

void cpl_verify_detail(cpl_verify *v, json_t *detail) {
  json_decref(v->now->detail);
  v->now->detail = detail;
}

bool cpl_verify_full(const cpl_verify *v) {
  return v->options->full;
}

int cpl_verify_jobs(const cpl_verify *v) {
  return v->options->jobs ? v->options->jobs : cpl_jobs_processors();
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
  int jobs = at_once ? at_once : cpl_verify_jobs(v);
  cpl_jobs_run(&(cpl_jobs){n, jobs, &m, begin_case, work_case, end_case});
  munmap(left, size);
  return tdm_interrupted ? tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted") : TDM_OK;
}

/* ---- studies ---- */

/* What the runs of cells took, together. */
static cpl_run_result total_of(const cpl_cells *cells) {
  cpl_run_result total = {0};
  for (int i = 0; i < cells->ncell; i++) {
    const json_t *row = cells->cell[i].row;
    total.wall += json_number_value(json_object_get(row, "wall_s"));
    total.simulated += json_number_value(json_object_get(row, "simulated_s"));
  }
  return total;
}

tdm_status cpl_verify_cells(cpl_verify *v, cpl_cells *cells, tdm_error *err) {
  cells->out = v->dir;
  cells->jobs = cpl_verify_jobs(v);
  cells->quiet = true;
  cells->scenarios = v->options->scenario;
  memcpy(cells->solver, v->options->solver, sizeof cells->solver);
  cpl_cells_run(cells, err);
  v->last = total_of(cells);
  count_last(v);
  return err->status;
}

/* "studies/speed.json" -> the directory "speed" of the scenario's. */
static void study_dir(const cpl_verify *v, const char *file, char *out, size_t size) {
  const char *name = strrchr(file, '/') ? strrchr(file, '/') + 1 : file;
  snprintf(out, size, "%s/%.*s", v->dir, (int)strcspn(name, "."), name);
}

tdm_status cpl_verify_study(cpl_verify *v, const char *file, const cpl_verify_part *part, cpl_study *study,
                            tdm_error *err) {
  char name[512], path[4096], dir[4352];
  cpl_study_options options = {.out = dir,
                               .jobs = cpl_verify_jobs(v),
                               .scenarios = v->options->scenario,
                               .set = part->set,
                               .only = part->only,
                               .seeds = part->seeds};
  memcpy(options.solver, v->options->solver, sizeof options.solver);
  *study = (cpl_study){0};
  study_dir(v, file, dir, sizeof dir);
  snprintf(name, sizeof name, "%s/%s", v->now->scenario->name, file);
  if (tdm_find_scenario_file(path, sizeof path, name, v->options->scenarios, err) != TDM_OK ||
      cpl_study_read(study, path, err) != TDM_OK || tdm_make_directory(dir, err) != TDM_OK ||
      cpl_study_run(study, &options, err) != TDM_OK)
    return err->status;
  v->last = total_of(&study->cells);
  count_last(v);
  return cpl_study_write(study, dir, NULL, err);
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

void cpl_verify_measure(cpl_verify *v, const char *name, const char *case_name, double value, cpl_limit_kind kind,
                        double limit) {
  cpl_outcome *o = v->now;
  cpl_measure *grown = realloc(o->measure, (size_t)(o->nmeasure + 1) * sizeof *grown);
  if (!grown) {
    tdm_fail(&o->err, TDM_ERR_MEMORY, NULL, "out of memory");
    return;
  }
  o->measure = grown;
  cpl_measure *m = &o->measure[o->nmeasure++];
  *m = (cpl_measure){.value = value, .limit = limit, .kind = kind, .run = v->last};
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

static void run_scenario(cpl_verify *v, cpl_outcome *o) {
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
  cpl_outcome_print(o);
}

/* The chosen scenarios, into a directory that is open. */
static tdm_status verify_chosen(const cpl_verify_options *options, tdm_error *err) {
  double begin = tdm_clock();
  cpl_verify v = {.options = options};
  int nscenario = 0, n = 0;
  while (options->scenario[nscenario].name)
    nscenario++;
  cpl_outcome *outcomes = calloc((size_t)nscenario + 1, sizeof *outcomes);
  if (!outcomes)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  bool pass = true, interrupted = false;
  cpl_outcome_head();
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
    cpl_outcomes_write(options->json, outcomes, n, pass, wall, err);
  for (int i = 0; i < n; i++) {
    free(outcomes[i].measure);
    json_decref(outcomes[i].detail);
  }
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
