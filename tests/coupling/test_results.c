/* Result directories: what a run removes, what it leaves, where it refuses to write. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/results/results.h"
#include "tests/command.h"
#include "tests/test_main.h"

#define SCENE TANDEM_SOURCE_DIR "/scenarios/collision/scene.json"
#define SHORT "--set time.end=1e-3"

static const char *dir;

static void setup(void) {
  dir = directory_make();
}

/* A shell line in the test's directory. Returns its exit status. */
static int in_dir(const char *line) {
  return command("sh -c \"cd %s && %s\"", dir, line);
}

static void expect_in_dir(int status, const char *line) {
  int got = in_dir(line);
  ck_assert_msg(got == status, "%d of: %s\n%s", got, line, command_output);
}

START_TEST(only_tandems_own_files_are_removed) {
  static const char *const others[] = {"dem.json", "time.txt", "body_parts.stl", "body_other.csv", "comparison.docx"};
  setup();
  expect_in_dir(0, "cp " SCENE " dem.json && touch time.txt body_parts.stl body_other.csv comparison.docx");
  expect_in_dir(1, "tandem run dem.json --out . " SHORT);
  expect_output("none of them says that they are tandem's");
  expect_output("--force");
  expect_in_dir(1, "test -e .tandem || test -e server.log");
  expect_in_dir(0, "tandem run dem.json --out . --force " SHORT);
  expect_in_dir(1, "tandem run dem.json --out . " SHORT);
  expect_output("holds the results of an earlier run");
  expect_in_dir(0, "tandem run dem.json --out . --force " SHORT);
  for (int i = 0; i < 5; i++)
    ck_assert_msg(command("test -e %s/%s", dir, others[i]) == 0, "%s is gone", others[i]);
  /* of another scene, but tandem's */
  expect_in_dir(0, "mv body_cube.csv kept && touch mbd.csv dem.csv && tandem report . && test -e index.html");
  expect_in_dir(0, "tandem-dem run " TANDEM_SOURCE_DIR "/scenarios/dem/hopper/scene.json --out . --force --set "
                   "time.end=1e-3 && test -e channels.csv");
  expect_in_dir(1, "ls mbd.csv dem.csv ledger.csv index.html report.gp server.log 2>&- | grep .");
  expect_in_dir(0, "test -e kept && test -e body_parts.stl && test -e dem.json");
  directory_remove(dir);
}
END_TEST

START_TEST(a_name_is_no_pattern) {
  setup();
  expect_in_dir(0, "mkdir run1 && touch run1/body_a.csv run1/summary.json");
  expect_in_dir(0, "tandem run " SCENE " --out 'run*' " SHORT);
  expect_in_dir(0, "tandem run " SCENE " --out 'run*' --force " SHORT);
  expect_in_dir(0, "test -e run1/body_a.csv && test -e run1/summary.json && test -e 'run*/summary.json'");
  directory_remove(dir);
}
END_TEST

/* The results of a run that was good are those that they were. */
static void expect_kept(void) {
  expect_in_dir(0, "diff -r before out --exclude start --exclude .tandem");
}

START_TEST(a_run_that_is_refused_removes_nothing) {
  static const char *const refused[] = {
      "--set dem.bodies[0].material=xx", /* by the solver that starts last */
      "--set mbd.bodies[0].mass=-1",     /* by the first */
      "--set time.dt=-1",                /* by the server */
      "--strict --set time.dt=1e-3 --set output.interval=1e-3 --set dem.guard.action=warn", /* a doubt */
      "--set coupling.solvers.dem=no_such_solver",
  };
  char line[512];
  setup();
  expect_in_dir(0, "tandem run " SCENE " --out out " SHORT " && cp -r out before");
  for (int i = 0; i < 5; i++) {
    snprintf(line, sizeof line, "tandem run " SCENE " --out out --force " SHORT " %s", refused[i]);
    expect_in_dir(1, line);
    if (i != 2)
      expect_output("the results in out stay as they are; the logs of this start are in out/start");
    expect_kept();
  }
  expect_in_dir(0, "grep -q no_such_solver out/start/summary.json && test -s out/start/server.log");
  expect_in_dir(0, "tandem check " SCENE " --out out");
  expect_kept();
  expect_in_dir(0, "tandem run " SCENE " --out out --force --set time.end=2e-3");
  expect_in_dir(1, "test -e out/start || cmp before/body_cube.csv out/body_cube.csv");
  directory_remove(dir);
}
END_TEST

START_TEST(a_solver_alone_keeps_them_too) {
  setup();
  expect_in_dir(0, "tandem-mbd run " TANDEM_SOURCE_DIR "/scenarios/mbd/slider_crank/scene.json --out out --set "
                   "time.end=0.01 && cp -r out before");
  expect_in_dir(1, "tandem-mbd run " TANDEM_SOURCE_DIR "/scenarios/mbd/slider_crank/scene.json --out out --force --set "
                   "mbd.bodies[0].mass=-1");
  expect_output("the results in out stay as they are");
  expect_kept();
  directory_remove(dir);
}
END_TEST

START_TEST(a_check_leaves_nothing) {
  setup();
  expect_in_dir(0, "tandem check " SCENE);
  expect_in_dir(2, "tandem check " SCENE " --force");
  expect_in_dir(1, "ls -A | grep .");
  expect_in_dir(0, "tandem check " SCENE " --out logs && test -e logs/dem.log");
  expect_in_dir(0, "tandem run " SCENE " --out logs " SHORT); /* a check's logs are no results */
  directory_remove(dir);
}
END_TEST

START_TEST(a_foreign_mark_removes_nothing_elsewhere) {
  setup();
  expect_in_dir(0, "mkdir out && touch out/mine victim && echo notes > out/.tandem");
  expect_in_dir(1, "tandem run " SCENE " --out out --force " SHORT);
  expect_output("is no mark of tandem's");
  expect_in_dir(0, "rm -r out && tandem run " SCENE " --out out " SHORT);
  expect_in_dir(0, "echo file ../victim >> out/.tandem; echo file $PWD/victim >> out/.tandem");
  expect_in_dir(0, "tandem run " SCENE " --out out --force " SHORT);
  expect_in_dir(0, "test -e victim");
  directory_remove(dir);
}
END_TEST

START_TEST(a_directory_that_is_removed_ends_the_run) {
  static const char *const how[] = {"rm -r out", "mv out old", "mv out old && mkdir out"};
  char out[128];
  setup();
  snprintf(out, sizeof out, "%s/out", dir);
  for (int i = 0; i < 3; i++) {
    const char *const arguments[] = {"run", SCENE, "--out", out, "--set", "time.end=1e5", NULL};
    pid_t pid = background(dir, arguments);
    WAIT_FOR(command("test -s %s/body_cube.csv", out) == 0);
    expect_in_dir(0, how[i]);
    ck_assert_int_eq(background_end(pid), 1);
    background_output(dir);
    expect_output("the result directory was removed or replaced while the run wrote into it");
    expect_in_dir(0, "rm -rf out old");
  }
  directory_remove(dir);
}
END_TEST

START_TEST(a_report_without_a_summary) {
  static const char *const harm[] = {": > out/summary.json", "rm out/summary.json",
                                     "echo '{\"scene\":' > out/summary.json", "ln -sf /dev/zero out/summary.json"};
  setup();
  expect_in_dir(0, "tandem run " SCENE " --out out " SHORT);
  for (int i = 0; i < 4; i++) {
    ck_assert_int_eq(command("sh -c 'cd %s && %s'", dir, harm[i]), 0);
    expect_in_dir(0, "rm -f out/report_*; tandem report out && ls out/report_*.png && test -s out/index.html");
    expect_output("no figures of the run");
  }
  directory_remove(dir);
}
END_TEST

START_TEST(a_run_that_was_killed_says_so) {
  char out[128];
  setup();
  snprintf(out, sizeof out, "%s/out", dir);
  const char *const arguments[] = {"run", SCENE, "--out", out, "--set", "time.end=1e5", NULL};
  pid_t pid = background(dir, arguments);
  WAIT_FOR(command("test -s %s/body_cube.csv", out) == 0);
  kill(pid, SIGKILL);
  waitpid(pid, NULL, 0);
  expect_in_dir(0, "tandem report out && grep -q 'status: unfinished' out/index.html");
  directory_remove(dir);
}
END_TEST

/* The new file cannot be written, as on a full disk: the summary takes the room that was kept for it. */
START_TEST(a_summary_on_a_full_disk) {
  char link[256], out[128];
  tdm_results r;
  tdm_error err = {0};
  setup();
  snprintf(out, sizeof out, "%s/out", dir);
  const tdm_results_def def = {.dir = out, .log = "server.log"};
  ck_assert_int_eq(tdm_results_open(&r, &def, &err), TDM_OK);
  ck_assert_int_eq(tdm_results_start(&r, &err), TDM_OK);
  snprintf(link, sizeof link, "%s/summary.json.part", out);
  ck_assert_int_eq(symlink("/dev/full", link), 0);
  json_t *json = json_pack("{s:s, s:f}", "status", "TDM_ERR_FILE", "simulated_s", 0.25);
  ck_assert_msg(tdm_results_summary(&r, json, &err) == TDM_OK, "%s", err.message);
  json_t *read = tdm_results_read(out, "summary.json", &err);
  ck_assert_msg(read && json_equal(read, json), "%s", err.message);
  json_decref(json);
  json_decref(read);
  tdm_results_close(&r);
  directory_remove(dir);
}
END_TEST

TEST_MAIN("results", only_tandems_own_files_are_removed, a_name_is_no_pattern, a_run_that_is_refused_removes_nothing,
          a_solver_alone_keeps_them_too, a_check_leaves_nothing, a_foreign_mark_removes_nothing_elsewhere,
          a_directory_that_is_removed_ends_the_run, a_report_without_a_summary, a_run_that_was_killed_says_so,
          a_summary_on_a_full_disk)
