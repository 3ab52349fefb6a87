/* The verification runner: a table of scenarios, each with runs, measures and limits.
 *
 * A scenario's function runs its scene as often as it needs (cpl_verify_run), compares with its reference and reports
 * numbers (cpl_verify_measure); this file prints the table, writes the JSON and decides on pass or fail.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_VERIFY_VERIFY_H
#define CPL_VERIFY_VERIFY_H

#include "coupler/study/study.h"
#include "coupler/verify/outcome.h"
#include "protocol/app/plot.h"

typedef struct cpl_verify cpl_verify;

/* Run the scenario's scene with overrides (NULL-terminated, may be NULL) into a directory of its own for this case ("":
 * the scenario's). On success `dir` (size bytes) is that directory. */
tdm_status cpl_verify_run(cpl_verify *v, const char *case_name, const char *const *set, char *dir, size_t size,
                          tdm_error *err);

/* ---- many runs ---- */

enum { CPL_CASE_SETTINGS = 12, CPL_SETTING_MAX = 192 };

/* One of many runs, zero-initialised. */
typedef struct {
  char name[64];     /* of the case and of its directory; "": the scenario's directory */
  const char *scene; /* scenario whose scene it runs; NULL: the one under way */
  bool shares_bed;   /* all cases of the scenario that do have one settled bed (dem.settle.store) */
  char set[CPL_CASE_SETTINGS][CPL_SETTING_MAX]; /* overrides, "path=value" */
  int nset;
  /* after the run */
  char dir[4096];
  cpl_run_result result;
  tdm_error err;
} cpl_verify_case;

void cpl_verify_case_set(cpl_verify_case *c, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Run n cases, `at_once` at a time in processes of their own (0: as many as the command says). What became of each is
 * in its err; the return value is an error only when none can go on (interrupted, no memory). */
tdm_status cpl_verify_run_many(cpl_verify *v, int n, cpl_verify_case *c, int at_once, tdm_error *err);

/* ---- studies ---- */

/* What of a study is run, zero-initialised: all of it. */
typedef struct {
  const char *const *only;  /* names of the cells that are wanted ("rpm=50"); NULL-terminated, NULL: all */
  const char *const *set;   /* further "path=value" for all cells; NULL-terminated, may be NULL */
  const char *const *seeds; /* values of the seeds that are wanted ("1"); NULL-terminated, NULL: all */
} cpl_verify_part;

/* Run a study of this scenario, `file` in its folder ("studies/speed.json"), into a directory of the study's name, as
 * many runs at a time as the command says; its files and pictures are written there. *study holds its numbers then
 * (cpl_study_mean, cpl_study_value); the caller frees it also after an error. What became of each cell is no error of
 * this call. What is measured after it was measured in all of its runs. */
tdm_status cpl_verify_study(cpl_verify *v, const char *file, const cpl_verify_part *part, cpl_study *study,
                            tdm_error *err);

/* ---- cells ---- */

/* Run cells (their names, scenes and settings are there) in the scenario's directory, as many at a time as the command
 * says; what became of each is in its row. `cells` gets what the command knows: solvers, jobs, scenarios. */
tdm_status cpl_verify_cells(cpl_verify *v, cpl_cells *cells, tdm_error *err);

/* Hand over what the scenario has found beside its measures, for the JSON file ("detail"); takes the reference. */
void cpl_verify_detail(cpl_verify *v, json_t *detail);

/* Name of the scenario under way. */
const char *cpl_verify_name(const cpl_verify *v);

/* What is measured from now on was measured in this run. */
void cpl_verify_about(cpl_verify *v, const cpl_verify_case *c);

/* How many runs at a time the command says: --jobs, or as many as there are processors. */
int cpl_verify_jobs(const cpl_verify *v);

/* --full: everything, however long it takes. */
bool cpl_verify_full(const cpl_verify *v);

/* The scene file GROUP/NAME/scene.json of the scenarios that are verified, into `scene` (size bytes). */
tdm_status cpl_verify_find(const cpl_verify *v, const char *group, const char *name, char *scene, size_t size,
                           tdm_error *err);

/* A file of the scenarios that are verified, such as "tumbler/five_deck.json", into `file` (size bytes). */
tdm_status cpl_verify_find_file(const cpl_verify *v, const char *name, char *file, size_t size, tdm_error *err);

/* Say that this scenario ran one solver without the coupler: `simulated` [s] in `wall` [s]. */
void cpl_verify_alone(cpl_verify *v, cpl_role role, double simulated, double wall);

/* Compare a run of this scenario with its reference; writes comparison.csv and its plot into the run's directory. */
tdm_status cpl_verify_compare(cpl_verify *v, const char *dir, cpl_comparison *c, tdm_error *err);

/* Report a number of the last run. NaN fails a limit. Strings are copied. */
void cpl_verify_measure(cpl_verify *v, const char *name, const char *case_name, double value, cpl_limit_kind kind,
                        double limit);

/* The scenario's directory under --out. */
const char *cpl_verify_dir(const cpl_verify *v);

/* As tdm_plot_write in the scenario's directory; what goes wrong is a notice, not a failure. */
void cpl_verify_plot(cpl_verify *v, const char *name, int nplot, const tdm_plot *plot);

typedef struct {
  const cpl_scenario *scenario; /* table ended by a NULL name */
  const char *const *name;      /* NULL-terminated: scenarios or groups; empty: the group "scenarios" */
  const char *out;              /* directory of results */
  const char *json;             /* file, NULL: none */
  const char *scenarios;        /* --scenarios DIR or NULL */
  bool force;                   /* write also between files that are not tandem's */
  bool full;                    /* --full */
  int jobs;                     /* runs at a time, 0: processors */
  cpl_solver solver[CPL_NROLE];
} cpl_verify_options;

/* Run and print. TDM_ERR_LIMIT when a limit was missed or a scenario failed. */
tdm_status cpl_verify_all(const cpl_verify_options *options, tdm_error *err);

#endif
