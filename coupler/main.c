/* tandem: the command line. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/advise/advise.h"
#include "coupler/calibrate/calibrate.h"
#include "coupler/cells/jobs.h"
#include "coupler/conform/conform.h"
#include "coupler/export/export.h"
#include "coupler/help.h"
#include "coupler/live/live.h"
#include "coupler/page/view.h"
#include "coupler/report/report.h"
#include "coupler/run/run.h"
#include "coupler/session/session.h"
#include "coupler/study/study.h"
#include "coupler/sweep/sweep.h"
#include "coupler/trial/repeat.h"
#include "coupler/verify/verify.h"
#include "dem/adapter/solver.h"
#include "mbd/adapter/solver.h"
#include "protocol/app/command_line.h"
#include "protocol/app/find.h"
#include "protocol/math/gsl_errors.h"
#include "protocol/version.h"
#include "scenarios/table.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const cpl_solver solvers[CPL_NROLE] = {
    [CPL_MBD] = {.executable = "tandem-mbd", .ops = &mbd_solver_ops},
    [CPL_DEM] = {.executable = "tandem-dem", .ops = &dem_solver_ops},
};

static void usage(FILE *out) {
  fputs(cpl_help, out);
  int name = 0, group = 0; /* widths */
  for (const cpl_scenario *s = scn_table; s->name; s++) {
    name = (int)strlen(s->name) > name ? (int)strlen(s->name) : name;
    group = (int)strlen(s->group) > group ? (int)strlen(s->group) : group;
  }
  for (const cpl_scenario *s = scn_table; s->name; s++)
    fprintf(out, "  %-*s  %-*s  %s\n", name, s->name, group, s->group, s->summary);
}

/* ---- arguments ---- */

typedef struct {
  tdm_arguments given;
  const char *out, *budget, *json, *port, *share, *scenarios, *dt, *n, *scheme, *jobs, *repeat, *seeds, *error, *write,
      *tolerance, *tries, *role, *timeout, *record, *side, *fmi;
  tdm_words measure, cell, parameter, range, log, target, rule;
  bool force, strict, resume, full, live, estimate;
} arguments;

static tdm_status parse(arguments *a, int argc, char **argv, tdm_error *err) {
  const tdm_option options[] = {{.name = "--out", .value = &a->out},
                                {.name = "--json", .value = &a->json},
                                {.name = "--error", .value = &a->error},
                                {.name = "--write", .value = &a->write},
                                {.name = "--scenarios", .value = &a->scenarios},
                                {.name = "--set"},
                                {.name = "--dt", .value = &a->dt},
                                {.name = "--n", .value = &a->n},
                                {.name = "--scheme", .value = &a->scheme},
                                {.name = "--jobs", .value = &a->jobs},
                                {.name = "--measure", .words = &a->measure},
                                {.name = "--repeat", .value = &a->repeat},
                                {.name = "--cell", .words = &a->cell},
                                {.name = "--seeds", .value = &a->seeds},
                                {.name = "--parameter", .words = &a->parameter},
                                {.name = "--range", .words = &a->range, .each = 2},
                                {.name = "--log", .words = &a->log},
                                {.name = "--target", .words = &a->target},
                                {.name = "--tolerance", .value = &a->tolerance},
                                {.name = "--tries", .value = &a->tries},
                                {.name = "--rule", .words = &a->rule},
                                {.name = "--role", .value = &a->role},
                                {.name = "--record", .value = &a->record},
                                {.name = "--timeout", .value = &a->timeout},
                                {.name = "--side", .value = &a->side},
                                {.name = "--fmi", .value = &a->fmi},
                                {.name = "--strict", .flag = &a->strict},
                                {.name = "--resume", .flag = &a->resume},
                                {.name = "--budget", .value = &a->budget},
                                {.name = "--live", .flag = &a->live, .value = &a->port},
                                {.name = "--estimate", .flag = &a->estimate, .value = &a->share},
                                {.name = "--full", .flag = &a->full},
                                {.name = "--force", .flag = &a->force}};
  return tdm_arguments_read(&a->given, options, sizeof options / sizeof options[0], "tandem", argc, argv, err);
}

/* ---- commands ---- */

/* options that a command does not know */
static tdm_status refuse(const arguments *a, const char *command, bool run, bool sweep, bool verify, tdm_error *err) {
  const bool view = strcmp(command, "view") == 0, check = strcmp(command, "check") == 0;
  const bool advise = strcmp(command, "advise") == 0, calibrate = strcmp(command, "calibrate") == 0;
  const bool conform = strcmp(command, "conform") == 0, export = strcmp(command, "export") == 0;
  const struct {
    bool given, known;
    const char *name;
  } options[] = {
      {.name = "--set", .given = a->given.nset > 0, .known = run || sweep || advise || calibrate || conform || export},
      {.name = "--strict", .given = a->strict, .known = run},
      {.name = "--out",
       .given = a->out != NULL,
       .known = run || sweep || verify || view || advise || calibrate || export},
      {.name = "--budget", .given = a->budget != NULL, .known = view},
      {.name = "--force",
       .given = a->force,
       .known = (run && !check) || sweep || verify || advise || calibrate || export},
      {.name = "--live", .given = a->live, .known = run && !check},
      {.name = "--estimate", .given = a->estimate, .known = run && !check},
      {.name = "--json", .given = a->json != NULL, .known = sweep || verify || advise || calibrate || conform},
      {.name = "--error", .given = a->error != NULL, .known = advise},
      {.name = "--write", .given = a->write != NULL, .known = advise || calibrate},
      {.name = "--dt", .given = a->dt != NULL, .known = sweep},
      {.name = "--n", .given = a->n != NULL, .known = sweep},
      {.name = "--scheme", .given = a->scheme != NULL, .known = sweep},
      {.name = "--jobs", .given = a->jobs != NULL, .known = sweep || verify || calibrate},
      {.name = "--resume", .given = a->resume, .known = sweep || calibrate},
      {.name = "--measure", .given = a->measure.n > 0, .known = sweep || calibrate},
      {.name = "--repeat", .given = a->repeat != NULL, .known = sweep || calibrate},
      {.name = "--cell", .given = a->cell.n > 0, .known = sweep},
      {.name = "--seeds", .given = a->seeds != NULL, .known = sweep},
      {.name = "--parameter", .given = a->parameter.n > 0, .known = calibrate},
      {.name = "--range", .given = a->range.n > 0, .known = calibrate},
      {.name = "--log", .given = a->log.n > 0, .known = calibrate},
      {.name = "--target", .given = a->target.n > 0, .known = calibrate},
      {.name = "--tolerance", .given = a->tolerance != NULL, .known = calibrate},
      {.name = "--tries", .given = a->tries != NULL, .known = calibrate},
      {.name = "--rule", .given = a->rule.n > 0, .known = conform},
      {.name = "--record", .given = a->record != NULL, .known = run && !check},
      {.name = "--role", .given = a->role != NULL, .known = conform},
      {.name = "--timeout", .given = a->timeout != NULL, .known = conform},
      {.name = "--side", .given = a->side != NULL, .known = export},
      {.name = "--fmi", .given = a->fmi != NULL, .known = export},
      {.name = "--", .given = a->given.rest != NULL, .known = conform},
      {.name = "--full", .given = a->full, .known = verify}};
  for (size_t k = 0; k < sizeof options / sizeof options[0]; k++)
    if (options[k].given && !options[k].known)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s: %s does not go with this command; see tandem --help", command,
                      options[k].name);
  return TDM_OK;
}

/* the one scene that a command is given, as a file */
static tdm_status find_scene(const arguments *a, const char *command, char *scene, size_t size, tdm_error *err) {
  if (a->given.nword != 1)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s: name one scene; see tandem --help", command);
  return tdm_find_scene(scene, size, "", a->given.word[0], a->scenarios, err);
}

/* --live [PORT]: serve before the run begins */
static tdm_status open_live(const arguments *a, cpl_live **live, tdm_error *err) {
  char *end = NULL;
  long port = a->port ? strtol(a->port, &end, 10) : 0;
  if (port < 0 || port > 65535 || (end && *end))
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "run: --live %s: give a port from 1 to 65535, or none for a free one",
                    a->port);
  return cpl_live_open(live, (int)port, err);
}

/* --estimate [SHARE]: what is to be repeated after the run, looked at before it */
static tdm_status prepare_repeat(const arguments *a, const cpl_run_options *run, cpl_repeat_options *repeat,
                                 tdm_error *err) {
  char *end = NULL;
  *repeat = (cpl_repeat_options){
      .scene = run->scene, .set = run->set, .out = run->out, .share = a->share ? strtod(a->share, &end) : 0.1};
  memcpy(repeat->solver, run->solver, sizeof repeat->solver);
  if (!(repeat->share > 0 && repeat->share <= 1) || (end && *end))
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                    "run: --estimate %s: give the share of the run that is repeated, above 0, at most 1", a->share);
  return cpl_repeat_check(repeat, err);
}

/* run and check: one scene, up to its end or until both solvers are ready */
static tdm_status one_scene(const arguments *a, const char *command, bool check, tdm_error *err) {
  char scene[4096];
  cpl_run_result result = {0};
  cpl_repeat_options repeat = {0};
  cpl_live *live = NULL;
  const cpl_observer *observers[] = {NULL, NULL};
  if (refuse(a, command, true, false, false, err) != TDM_OK ||
      find_scene(a, command, scene, sizeof scene, err) != TDM_OK)
    return err->status;
  cpl_run_options options = {
      .scene = scene, .set = a->given.set, .record = a->record, .force = a->force, .strict = a->strict, .check = check};
  options.out = a->out ? a->out : check ? NULL : "run-out";
  memcpy(options.solver, solvers, sizeof solvers);
  if (a->estimate && prepare_repeat(a, &options, &repeat, err) != TDM_OK)
    return err->status;
  if (a->live && open_live(a, &live, err) == TDM_OK) {
    observers[0] = cpl_live_observer(live);
    options.observers = observers;
    options.loaded = cpl_live_tell;
    options.context = live;
  }
  if (err->status == TDM_OK)
    cpl_run(&options, &result, err);
  cpl_live_close(&live);
  if (result.windows > 0)
    cpl_run_print(&result, options.out);
  if (a->estimate && err->status == TDM_OK)
    cpl_repeat(&repeat, err);
  if (result.thread_hangs) { /* it cannot be ended, and its memory cannot be taken away */
    tdm_finish("tandem", err);
    fflush(NULL);
    _exit(1);
  }
  return err->status;
}

static tdm_status command_run(const arguments *a, tdm_error *err) {
  return one_scene(a, "run", false, err);
}

static tdm_status command_check(const arguments *a, tdm_error *err) {
  return one_scene(a, "check", true, err);
}

static tdm_status command_advise(const arguments *a, tdm_error *err) {
  char scene[4096], *end = NULL;
  const double error = a->error ? strtod(a->error, &end) : 0.01;
  if (refuse(a, "advise", false, false, false, err) != TDM_OK ||
      find_scene(a, "advise", scene, sizeof scene, err) != TDM_OK)
    return err->status;
  if (!(error > 0 && error < 1) || (end && *end))
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "advise: --error %s: give a share above 0 and below 1", a->error);
  cpl_advise_options options = {.scene = scene,
                                .set = a->given.set,
                                .out = a->out ? a->out : "advise-out",
                                .force = a->force,
                                .json = a->json,
                                .write = a->write,
                                .error = error};
  memcpy(options.solver, solvers, sizeof solvers);
  return cpl_advise(&options, err);
}

/* The words behind "--" as one command. */
static tdm_status join_command(const arguments *a, char *out, size_t size, tdm_error *err) {
  size_t used = 0;
  if (!a->given.rest || !a->given.rest[0])
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "conform: give the solver's command behind --; see tandem --help");
  for (char *const *word = a->given.rest; *word; word++) {
    if (strchr(*word, ' '))
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                      "conform: \"%s\": a word of the command has a blank, which parts words; write a script", *word);
    used += (size_t)snprintf(out + used, size - used, "%s%s", word == a->given.rest ? "" : " ", *word);
    if (used >= size)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "conform: the command is longer than %zu bytes", size);
  }
  return TDM_OK;
}

static tdm_status command_conform(const arguments *a, tdm_error *err) {
  char scene[4096], command[4096], *end = NULL;
  const double timeout = a->timeout ? strtod(a->timeout, &end) : 10;
  if (refuse(a, "conform", false, false, false, err) != TDM_OK ||
      join_command(a, command, sizeof command, err) != TDM_OK ||
      (a->given.nword > 0 && find_scene(a, "conform", scene, sizeof scene, err) != TDM_OK))
    return err->status;
  if (!(timeout > 0 && timeout < 1e6) || (end && *end))
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "conform: --timeout %s: give a number of seconds", a->timeout);
  cpl_conform_options options = {.scene = a->given.nword > 0 ? scene : NULL,
                                 .set = a->given.set,
                                 .command = command,
                                 .role = a->role,
                                 .rule = a->rule.n > 0 ? a->rule.word : NULL,
                                 .json = a->json,
                                 .timeout = timeout};
  memcpy(options.solver, solvers, sizeof solvers);
  return cpl_conform(&options, err);
}

static tdm_status command_export(const arguments *a, tdm_error *err) {
  char scene[4096];
  if (refuse(a, "export", false, false, false, err) != TDM_OK)
    return err->status;
  if (a->given.nword != 2 || strcmp(a->given.word[0], "fmu") != 0)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "export: write tandem export fmu SCENE; see tandem --help");
  if (tdm_find_scene(scene, sizeof scene, "", a->given.word[1], a->scenarios, err) != TDM_OK)
    return err->status;
#ifdef TANDEM_EXPORTS
  cpl_export_options options = {
      .scene = scene, .set = a->given.set, .out = a->out, .side = a->side, .version = a->fmi, .force = a->force};
  memcpy(options.solver, solvers, sizeof solvers);
  return cpl_export_fmu(&options, err);
#else
  return tdm_fail(
      err, TDM_ERR_ARGUMENT, NULL,
      "export: this tandem was built without libzip-dev and libexpat1-dev; install them and build it again");
#endif
}

static tdm_status command_report(const arguments *a, tdm_error *err) {
  if (refuse(a, "report", false, false, false, err) != TDM_OK)
    return err->status;
  if (a->given.nword != 1)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "report: name one result directory");
  return cpl_report(a->given.word[0], scn_table, err);
}

static tdm_status command_view(const arguments *a, tdm_error *err) {
  char *end = NULL;
  double budget = a->budget ? strtod(a->budget, &end) * 1e6 : CPL_VIEW_BUDGET;
  if (refuse(a, "view", false, false, false, err) != TDM_OK)
    return err->status;
  if (a->given.nword != 1)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "view: name one result directory");
  if (!(budget > 0) || (end && *end))
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "view: --budget %s: give a number of megabytes", a->budget);
  return cpl_view(a->given.word[0], a->out, budget, err);
}

/* --jobs, or as many as there are processors */
static tdm_status read_jobs(const arguments *a, const char *command, int *jobs, tdm_error *err) {
  char *end = NULL;
  long n = a->jobs ? strtol(a->jobs, &end, 10) : cpl_jobs_processors();
  if (n < 1 || n > CPL_JOBS_MAX || (end && *end))
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s: --jobs %s: give a number from 1 to %d", command, a->jobs,
                    CPL_JOBS_MAX);
  *jobs = (int)n;
  return TDM_OK;
}

static tdm_status command_verify(const arguments *a, tdm_error *err) {
  if (refuse(a, "verify", false, false, true, err) != TDM_OK)
    return err->status;
  cpl_verify_options options = {.scenario = scn_table,
                                .name = a->given.word,
                                .out = a->out ? a->out : "verify-out",
                                .json = a->json,
                                .scenarios = a->scenarios,
                                .force = a->force,
                                .full = a->full};
  if (read_jobs(a, "verify", &options.jobs, err) != TDM_OK)
    return err->status;
  memcpy(options.solver, solvers, sizeof solvers);
  return cpl_verify_all(&options, err);
}

/* PATH=LIST of an option: the path (TDM_PATH_MAX bytes), and where the list begins; NULL after an error */
static const char *read_list(const char *command, const char *option, const char *text, char *path, tdm_error *err) {
  const char *equals = strchr(text, '=');
  if (!equals || equals == text || equals - text >= TDM_PATH_MAX) {
    tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s: %s %s: write PATH=LIST", command, option, text);
    return NULL;
  }
  snprintf(path, TDM_PATH_MAX, "%.*s", (int)(equals - text), text);
  return equals + 1;
}

/* the axes of a sweep, in the order dt, n, scheme, --set, and its seeds */
static tdm_status read_axes(const arguments *a, cpl_sweep_options *o, tdm_error *err) {
  const char *const lists[] = {a->dt, a->n, a->scheme}, *const paths[] = {"time.dt", "coupling.n", "coupling.scheme"};
  char path[TDM_PATH_MAX];
  for (int i = 0; i < 3; i++)
    if (lists[i] && cpl_sweep_axis(o, paths[i], lists[i], err) != TDM_OK)
      return err->status;
  for (int i = 0; i < a->given.nset; i++) {
    const char *list = read_list("sweep", "--set", a->given.set[i], path, err);
    if (!list || cpl_sweep_axis(o, path, list, err) != TDM_OK)
      return err->status;
  }
  const char *seeds = a->repeat ? read_list("sweep", "--repeat", a->repeat, path, err) : NULL;
  if (seeds)
    cpl_sweep_repeat(o, path, seeds, err);
  return err->status;
}

/* The scene or study of a sweep, as a file: scenarios of particles alone or of bodies alone too, and files of scenarios
 * ("tumbler/studies/speed.json"). */
static tdm_status find_swept(const arguments *a, const char *command, char *file, size_t size, tdm_error *err) {
  static const char *const groups[] = {"dem", "mbd"};
  if (find_scene(a, command, file, size, err) == TDM_OK && access(file, F_OK) != 0) {
    char other[4096];
    if (tdm_find_scenario_file(other, sizeof other, file, a->scenarios, &(tdm_error){0}) == TDM_OK)
      snprintf(file, size, "%s", other);
  }
  if (err->status == TDM_OK || a->given.nword != 1)
    return err->status;
  for (int g = 0; g < 2; g++)
    if (tdm_find_scene(file, size, groups[g], a->given.word[0], a->scenarios, &(tdm_error){0}) == TDM_OK) {
      *err = (tdm_error){0};
      return TDM_OK;
    }
  return err->status;
}

/* what a file holds: a study, a scene for both solvers, or one for a solver alone */
static void look_into(const char *file, bool *study, bool *alone) {
  tdm_scene scene = {0};
  tdm_scene_read(&scene, file, &(tdm_error){0}); /* what is wrong is told by who reads it */
  *study = cpl_study_is(scene.root);
  *alone = !json_object_get(scene.root, "dem") != !json_object_get(scene.root, "mbd") &&
           !json_object_get(scene.root, "coupling");
  tdm_scene_destroy(&scene);
}

static tdm_status sweep_study(const arguments *a, cpl_sweep_options *o, tdm_error *err) {
  if (a->dt || a->n || a->scheme || a->repeat || a->measure.n > 0)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                    "sweep: %s: --dt, --n, --scheme, --repeat and --measure go with a scene; write them into the study",
                    o->scene);
  o->study = o->scene;
  o->set = a->given.set;
  return cpl_sweep_study(o, err);
}

static tdm_status command_sweep(const arguments *a, tdm_error *err) {
  char scene[4096];
  bool study = false, alone = false;
  cpl_sweep_options options = {
      .out = a->out ? a->out : "sweep-out", .json = a->json, .force = a->force, .resume = a->resume};
  if (refuse(a, "sweep", false, true, false, err) != TDM_OK ||
      find_swept(a, "sweep", scene, sizeof scene, err) != TDM_OK || read_jobs(a, "sweep", &options.jobs, err) != TDM_OK)
    return err->status;
  look_into(scene, &study, &alone);
  options.scene = scene;
  options.scenarios = scn_table;
  options.measure = a->measure.word;
  options.nmeasure = a->measure.n;
  options.only = a->cell.n > 0 ? a->cell.word : NULL;
  memcpy(options.solver, solvers, sizeof solvers);
  const bool good = !a->seeds || cpl_sweep_seeds(&options, a->seeds, err) == TDM_OK;
  if (good && study)
    sweep_study(a, &options, err);
  else if (good && read_axes(a, &options, err) == TDM_OK &&
           (alone || a->measure.n > 0 || a->repeat || a->cell.n > 0 || a->seeds))
    cpl_sweep_study(&options, err);
  else if (err->status == TDM_OK)
    cpl_sweep(&options, err);
  cpl_sweep_free(&options);
  return err->status;
}

/* --tolerance and --tries, or their defaults */
static tdm_status read_ends(const arguments *a, cpl_calibrate_options *o, tdm_error *err) {
  char *end = NULL;
  o->tolerance = a->tolerance ? strtod(a->tolerance, &end) : cpl_calibrate_tolerance;
  if (!(o->tolerance > 0 && o->tolerance < 1) || (end && *end))
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "calibrate: --tolerance %s: give a share above 0 and below 1",
                    a->tolerance);
  end = NULL;
  const long tries = a->tries ? strtol(a->tries, &end, 10) : CPL_CALIBRATE_TRIES;
  if (tries < 1 || tries > 100000 || (end && *end))
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "calibrate: --tries %s: give a number from 1 to 100000", a->tries);
  o->tries = (int)tries;
  return TDM_OK;
}

static tdm_status command_calibrate(const arguments *a, tdm_error *err) {
  char scene[4096], path[TDM_PATH_MAX];
  bool study = false, alone = false;
  cpl_calibrate_options options = {.scene = scene,
                                   .set = a->given.set,
                                   .parameter = a->parameter.word,
                                   .nparameter = a->parameter.n,
                                   .range = a->range.word,
                                   .nrange = a->range.n / 2,
                                   .log = a->log.word,
                                   .nlog = a->log.n,
                                   .target = a->target.word,
                                   .ntarget = a->target.n,
                                   .measure = a->measure.word,
                                   .nmeasure = a->measure.n,
                                   .force = a->force,
                                   .resume = a->resume,
                                   .out = a->out ? a->out : "calibrate-out",
                                   .json = a->json,
                                   .write = a->write,
                                   .scenarios = scn_table};
  memcpy(options.solver, solvers, sizeof solvers);
  if (refuse(a, "calibrate", false, false, false, err) != TDM_OK ||
      find_swept(a, "calibrate", scene, sizeof scene, err) != TDM_OK ||
      read_jobs(a, "calibrate", &options.jobs, err) != TDM_OK || read_ends(a, &options, err) != TDM_OK)
    return err->status;
  look_into(scene, &study, &alone);
  if (study)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "calibrate: %s is a study; name a scene", scene);
  const char *seeds = a->repeat ? read_list("calibrate", "--repeat", a->repeat, path, err) : NULL;
  if (err->status == TDM_OK && (!seeds || cpl_axis_read(&options.repeat, "calibrate", path, seeds, err) == TDM_OK))
    cpl_calibrate(&options, err);
  cpl_axis_free(&options.repeat);
  return err->status;
}

/* draw and movie: a program of its own takes over, with the words from the command on */
static tdm_status command_picture(char **argv, tdm_error *err) {
  char program[4096];
  if (tdm_find_program(program, sizeof program, "tandem-draw"))
    execv(program, argv);
  return tdm_fail(err, TDM_ERR_FILE, NULL,
                  "%s: tandem-draw is neither beside this program nor in PATH, or cannot be started; install it",
                  argv[1]);
}

int main(int argc, char **argv) {
  const struct {
    const char *name;
    tdm_status (*run)(const arguments *, tdm_error *); /* NULL: tandem-draw does it */
  } commands[] = {
      {.name = "run", .run = command_run},
      {.name = "check", .run = command_check},
      {.name = "advise", .run = command_advise},
      {.name = "report", .run = command_report},
      {.name = "view", .run = command_view},
      {.name = "draw"},
      {.name = "movie"},
      {.name = "sweep", .run = command_sweep},
      {.name = "calibrate", .run = command_calibrate},
      {.name = "verify", .run = command_verify},
      {.name = "conform", .run = command_conform},
      {.name = "export", .run = command_export},
  };
  enum { NCOMMAND = sizeof commands / sizeof commands[0] };
  const char *names[NCOMMAND];
  for (int i = 0; i < NCOMMAND; i++)
    names[i] = commands[i].name;
  tdm_error err = {0};
  arguments a = {0};
  for (int i = 1; i < argc && strcmp(argv[i], "--") != 0; i++) {
    if (strcmp(argv[i], "--help") == 0) {
      usage(stdout);
      return 0;
    }
    if (strcmp(argv[i], "--version") == 0) {
      printf("tandem %s\n", TDM_VERSION);
      return 0;
    }
  }
  if (argc < 2) {
    usage(stderr);
    return 2;
  }
  tdm_catch_signals();
  tdm_gsl_return_errors();
  size_t k = 0;
  while (k < NCOMMAND && strcmp(argv[1], commands[k].name) != 0)
    k++;
  if (k == NCOMMAND)
    tdm_unknown_command("tandem", argv[1], names, NCOMMAND, &err);
  else if (!commands[k].run)
    command_picture(argv, &err);
  else if (parse(&a, argc - 2, argv + 2, &err) == TDM_OK)
    commands[k].run(&a, &err);
  tdm_arguments_free(&a.given);
  return tdm_finish("tandem", &err);
}
