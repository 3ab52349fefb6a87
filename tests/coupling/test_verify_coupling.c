/* The verification of the coupling schemes: runs side by side, cells of the grids, --full. The group itself takes
 * minutes: `tandem verify coupling`. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/cells/jobs.h"
#include "scenarios/coupling/cell.h"
#include "scenarios/table.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <math.h>

/* ---- jobs ---- */

enum { PIECES = 7 };

typedef struct {
  int begun, ended, status[PIECES], running, most;
} tally;

static bool begin_piece(void *context, int i) {
  tally *t = context;
  if (i == 2)
    return false;
  t->begun++;
  t->running++;
  t->most = t->running > t->most ? t->running : t->most;
  return true;
}

static int work_piece(void *context, int i) {
  (void)context;
  if (i == 5)
    raise(SIGKILL);
  return i;
}

static void end_piece(void *context, int i, int status, double seconds) {
  tally *t = context;
  ck_assert(seconds >= 0);
  t->status[i] = status;
  t->ended++;
  t->running--;
}

START_TEST(jobs_are_independent) {
  for (int at_once = 1; at_once <= 3; at_once++) {
    tally t = {0};
    cpl_jobs_run(&(cpl_jobs){PIECES, at_once, &t, begin_piece, work_piece, end_piece});
    ck_assert_int_eq(t.begun, PIECES - 1);
    ck_assert_int_eq(t.ended, PIECES - 1);
    ck_assert_int_eq(t.most, at_once);
    for (int i = 0; i < PIECES; i++)
      if (i != 2 && i != 5)
        ck_assert_int_eq(WEXITSTATUS(t.status[i]), i);
    ck_assert(WIFSIGNALED(t.status[5]));
    ck_assert_int_eq(WTERMSIG(t.status[5]), SIGKILL);
  }
}
END_TEST

/* ---- many runs ---- */

enum { NRUN = 4 };
static double windows[NRUN], shifts[NRUN];
static tdm_status became[NRUN];
static char words[TDM_MESSAGE_MAX];

static tdm_status several(cpl_verify *v, tdm_error *err) {
  static const char *const more[NRUN] = {"coupling.n=4", "coupling.n=8", "coupling.n=0", "coupling.n=4"};
  cpl_verify_case run[NRUN] = {0};
  for (int i = 0; i < NRUN; i++) {
    snprintf(run[i].name, sizeof run[i].name, "run %d", i);
    run[i].scene = "spring_damper";
    run[i].shares_bed = true;
    cpl_verify_case_set(&run[i], "dem.particles[0].count=3");
    cpl_verify_case_set(&run[i], "time.end=%g", 0.01);
    cpl_verify_case_set(&run[i], "%s", more[i]);
  }
  if (cpl_verify_run_many(v, NRUN, run, 2, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < NRUN; i++) {
    became[i] = run[i].err.status;
    windows[i] = (double)run[i].result.windows;
    cpl_comparison c = {0};
    if (became[i] == TDM_OK && scn_spring_damper_compare(run[i].dir, &c, err) == TDM_OK)
      shifts[i] = c.curve[0].simulation[c.nrow - 1];
    cpl_comparison_free(&c);
  }
  snprintf(words, sizeof words, "%s", run[2].err.message);
  cpl_verify_about(v, &run[1]);
  cpl_verify_measure(v, "full", "", cpl_verify_full(v), CPL_NO_LIMIT, 0);
  return err->status;
}

START_TEST(runs_side_by_side) {
  static const cpl_scenario table[] = {{.name = "several", .group = "scenarios", .verify = several}, {0}};
  static const char *const names[] = {NULL};
  const char *dir = directory_make();
  char path[4096], file[256];
  snprintf(path, sizeof path, "%s:%s", TANDEM_BIN_DIR, getenv("PATH"));
  setenv("PATH", path, 1);
  snprintf(file, sizeof file, "%s/verify.json", dir);
  cpl_verify_options options = {.scenario = table,
                                .name = names,
                                .out = dir,
                                .json = file,
                                .scenarios = TANDEM_SOURCE_DIR "/scenarios",
                                .full = true,
                                .solver = {[CPL_MBD] = {"tandem-mbd", NULL}, [CPL_DEM] = {"tandem-dem", NULL}}};
  tdm_error err = {0};
  ck_assert_msg(cpl_verify_all(&options, &err) == TDM_OK, "%s", err.message);
  ck_assert_int_eq(became[0], TDM_OK);
  ck_assert_int_eq(became[1], TDM_OK);
  ck_assert_int_eq(became[2], TDM_ERR_SCENE);
  ck_assert_ptr_nonnull(strstr(words, "coupling.n"));
  ck_assert_int_eq(became[3], TDM_OK);
  ck_assert_double_eq(windows[0], 25);
  ck_assert_double_eq(windows[1], 13);
  ck_assert(shifts[0] > 0);
  ck_assert_double_eq(shifts[0], shifts[3]); /* the same bed, whatever ran beside */
  json_t *json = json_load_file(file, 0, NULL), *scenario = json_array_get(json_object_get(json, "scenarios"), 0);
  json_t *full = json_array_get(json_object_get(scenario, "measures"), 0);
  ck_assert_double_eq(json_number_value(json_object_get(full, "value")), 1);
  ck_assert_int_eq(json_integer_value(json_object_get(scenario, "windows")), 25 + 13 + 25);
  ck_assert(access(dir, F_OK) == 0);
  json_decref(json);
  directory_remove(dir);
}
END_TEST

/* ---- cells ---- */

START_TEST(cells_are_named_as_the_paper_has_them) {
  cpl_verify_case run;
  scn_cell cell = {.scheme = "proxy", .dt = "1e-5", .n = 25};
  scn_cell_prepare(&cell, "spring_damper", &run);
  ck_assert_str_eq(run.name, "scheme=proxy dt=1e-5 n=25");
  ck_assert_double_eq_tol(scn_cell_window(&cell), 2.5e-4, 1e-18);
  cell.more = "e=0.5";
  scn_cell_prepare(&cell, "spring_damper", &run);
  ck_assert_str_eq(run.name, "scheme=proxy dt=1e-5 n=25 e=0.5");
}
END_TEST

static tdm_status no_compare(const char *dir, cpl_comparison *c, tdm_error *err) {
  (void)c;
  return tdm_fail(err, TDM_ERR_FILE, NULL, "%s was compared", dir);
}

START_TEST(an_unstable_cell_is_a_result) {
  scn_cell cell = {.scheme = "lommen", .dt = "1e-4", .n = 1000};
  cpl_verify_case run = {.dir = "/nowhere", .err = {.status = TDM_ERR_NUMERIC, .message = "it flew away"}};
  tdm_error err = {0};
  ck_assert_int_eq(scn_cell_judge(&cell, &run, no_compare, &err), TDM_OK);
  ck_assert(!cell.stable);
  ck_assert(isnan(cell.nse[0]) && isnan(cell.nse[1]) && isnan(cell.r2_load) && isnan(cell.r2_load_20ms));
  run.err.status = TDM_ERR_SCENE; /* a scene that is refused is not */
  ck_assert_int_eq(scn_cell_judge(&cell, &run, no_compare, &err), TDM_ERR_SCENE);
}
END_TEST

START_TEST(the_group_is_there) {
  static const char *const names[] = {"coupling_collision",  "coupling_spring_damper", "coupling_torsional",
                                      "coupling_heavy_fill", "coupling_stiff_support", "coupling_stiff_hinge"};
  int found = 0;
  for (const cpl_scenario *s = scn_table; s->name; s++)
    if (strcmp(s->group, "coupling") == 0) {
      ck_assert_int_lt(found, 6);
      ck_assert_str_eq(s->name, names[found++]);
    }
  ck_assert_int_eq(found, 6);
}
END_TEST

START_TEST(full_and_jobs_go_with_verify) {
  const char *dir = directory_make();
  ck_assert_int_eq(command("tandem verify torque_free --full --jobs 1 --out %s --json %s/v.json", dir, dir), 0);
  ck_assert(is_refusal(command("tandem run collision --full --out %s", dir)));
  expect_output("--full does not go with this command");
  ck_assert(is_refusal(command("tandem verify torque_free --jobs 0 --out %s", dir)));
  expect_output("--jobs 0: give a number");
  directory_remove(dir);
}
END_TEST

TEST_MAIN("verify coupling", jobs_are_independent, runs_side_by_side, cells_are_named_as_the_paper_has_them,
          an_unstable_cell_is_a_result, the_group_is_there, full_and_jobs_go_with_verify)
