/* What comes from somebody else is data: names in results, rows and scenes reach gnuplot, pages and file names as such.
 * And what waits for gnuplot, or was killed, leaves nothing running. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/command.h"
#include "tests/test_main.h"

#define SCENE TANDEM_SOURCE_DIR "/scenarios/collision/scene.json"
#define CRANK TANDEM_SOURCE_DIR "/scenarios/mbd/slider_crank/scene.json"
#define SHORT "--set time.end=1e-3"

static const char *dir;

static void setup(void) {
  dir = directory_make();
}

/* A script in the test's directory, run there. Returns its exit status. */
static int script(const char *text) {
  write_file(dir, "script", text);
  return command("sh -c 'cd %s && sh ./script'", dir);
}

static void expect_script(int status, const char *text) {
  int got = script(text);
  ck_assert_msg(got == status, "%d of: %s\n%s", got, text, command_output);
}

static void expect_no_harm(void) {
  ck_assert_msg(command("sh -c 'find %s -name \"pwned*\" | grep .'", dir) != 0, "executed: %s", command_output);
}

START_TEST(results_of_somebody_else) {
  setup();
  expect_script(0, "tandem run " SCENE " --out out " SHORT);
  /* heads with commands, a body whose name is a command and its file, a summary with markup */
  expect_script(
      0, "cat > head <<'END'\n"
         "time [s],`touch pwned1` [N],$(touch pwned2) [m],'; system(\"touch pwned3\"); ' [m],@a [`touch pwned4`],"
         "<script>alert(1)</script> [<b>],\"; !touch pwned5 [\"]\n"
         "END\n"
         "(cat head; printf '0,1,2,3,4,5,6\\n1,2,3,4,5,6,7\\n') > out/mbd.csv; cp out/mbd.csv out/dem.csv\n"
         "cp out/mbd.csv \"out/body_'; touch pwned6; '.csv\"; cp out/mbd.csv 'out/body_<b>.csv'\n"
         "sed -i 's|\"mbd\": \"cube\"|\"mbd\": \"'\"'\"'; touch pwned6; '\"'\"'\"|' out/scene.json\n"
         "sed -i 's|\"scene\": \".*\"|\"scene\": \"<script>alert(2)</script> `touch pwned7` \\\\\" onload=x\"|' "
         "out/summary.json\n"
         "grep -q pwned6 out/scene.json && grep -q 'alert(2)' out/summary.json\n");
  expect_script(0, "tandem report out");
  expect_no_harm();
  expect_script(1, "grep -i '<script\\|<b>\\|\" onload' out/index.html");
  expect_script(0, "grep -q '&lt;script&gt;alert(2)' out/index.html && ls out/report_*.png");
  expect_script(0, "grep -q '`touch pwned4`' out/index.html && grep -q '140touch pwned4' out/report.gp");
  directory_remove(dir);
}
END_TEST

START_TEST(names_of_a_sweep) {
  setup();
  expect_script(0, "tandem sweep " SCENE " " SHORT " --out s "
                   "--set 'title=<script>alert(1)</script>,`touch pwned1`,\"; touch pwned2; \\\"'");
  expect_no_harm();
  expect_script(1, "grep -i '<script' s/table.html");
  expect_script(0, "grep -q '&lt;script&gt;' s/table.html");
  /* rows that are read back */
  expect_script(
      0, "for f in s/cells/*/row.json; do\n"
         "sed -i 's|\"scheme\": \".*\"|\"scheme\": \"x'\"'\"' ? system(\\\\\"touch pwned3\\\\\") : '\"'\"'\"|; "
         "s|\"r2\": {|\"r2\": {\"`touch pwned4`\": 1, \"../../a\": 1,|' $f; done; grep -q pwned3 s/cells/*/row.json");
  expect_script(0, "tandem sweep " SCENE " " SHORT " --out s --resume "
                   "--set 'title=<script>alert(1)</script>,`touch pwned1`,\"; touch pwned2; \\\"'");
  expect_no_harm();
  expect_script(1, "grep pwned3 s/sweep.json s/sweep.csv s/table.html s/*.gp");
  directory_remove(dir);
}
END_TEST

START_TEST(values_that_differ_in_a_blank_are_two_cells) {
  setup();
  expect_script(0, "tandem sweep " SCENE " " SHORT " --out s --set 'title=a b,a_b,ab'");
  expect_script(0, "test $(ls s/cells | wc -l) = 3");
  expect_script(2, "tandem sweep " SCENE " --out t --set 'coupling.auto={\"n_max\": 5},{\"n_max\":5}'");
  expect_output("twice");
  expect_script(2, "tandem sweep " SCENE " --out t --n '5, 5'");
  directory_remove(dir);
}
END_TEST

/* ---- signals ---- */

static void deaf_gnuplot(void) {
  char path[4096];
  write_file(dir, "gnuplot", "#!/bin/sh\ntrap '' INT TERM HUP\nsleep 1000 & sleep 1000\nsleep 1000\n");
  ck_assert_int_eq(command("chmod +x %s/gnuplot", dir), 0);
  snprintf(path, sizeof path, "%s:%s", dir, getenv("PATH"));
  setenv("PATH", path, 1);
}

static int count_processes(const char *name) {
  char text[128];
  snprintf(text, sizeof text, "%s/%s", dir, name);
  return find_processes(text, NULL);
}

/* Wait until this many processes have the text in their command line. They are not counted again: a shell that starts
 * others shows them under its own name until they are something else. */
static void expect_processes(const char *name, int number) {
  WAIT_FOR(count_processes(name) == number);
}

START_TEST(a_report_can_be_ended) {
  static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
  char out[128];
  setup();
  expect_script(0, "tandem run " SCENE " --out out " SHORT);
  deaf_gnuplot();
  snprintf(out, sizeof out, "%s/out", dir);
  const char *const arguments[] = {"report", out, NULL};
  pid_t pid = background(dir, arguments);
  expect_processes("gnuplot", 1);
  kill(pid, signals[_i]);
  ck_assert_int_eq(background_end(pid), 130);
  expect_processes("gnuplot", 0);
  directory_remove(dir);
}
END_TEST

START_TEST(plots_after_a_run_can_be_ended) {
  setup();
  deaf_gnuplot();
  char out[128];
  snprintf(out, sizeof out, "%s/out", dir);
  pid_t pid = fork();
  if (pid == 0) {
    execl(TANDEM_BIN_DIR "/tandem-mbd", "tandem-mbd", "run", CRANK, "--out", out, "--set", "time.end=0.1", NULL);
    _exit(127);
  }
  expect_processes("gnuplot", 1);
  kill(pid, SIGTERM);
  ck_assert_int_eq(background_end(pid), 130);
  expect_script(0, "grep -q TDM_OK out/summary.json");
  directory_remove(dir);
}
END_TEST

START_TEST(a_killed_report_takes_gnuplot_with_it) {
  char out[128], path[256];
  setup();
  expect_script(0, "tandem run " SCENE " --out out " SHORT);
  write_file(dir, "gnuplot", "#!/bin/sh\nexec sleep 987654\n");
  ck_assert_int_eq(command("chmod +x %s/gnuplot", dir), 0);
  snprintf(path, sizeof path, "%s:/usr/bin:/bin", dir);
  setenv("PATH", path, 1);
  snprintf(out, sizeof out, "%s/out", dir);
  const char *const arguments[] = {"report", out, NULL};
  pid_t pid = background(dir, arguments);
  WAIT_FOR(find_processes("sleep 987654", NULL) == 1);
  kill(pid, SIGKILL);
  waitpid(pid, NULL, 0);
  WAIT_FOR(find_processes("sleep 987654", NULL) == 0);
  directory_remove(dir);
}
END_TEST

START_TEST(cells_of_a_killed_sweep_end) {
  char out[128];
  setup();
  snprintf(out, sizeof out, "%s/s", dir);
  const char *const arguments[] = {
      "sweep", SCENE, "--out", out, "--n", "1,2", "--jobs", "2", "--set", "time.end=1e5", "--set", "output.interval=10",
      NULL};
  pid_t pid = background(dir, arguments);
  expect_processes("tandem-", 4); /* two cells with two solvers each have it in --connect */
  ck_assert_int_eq(command("tandem sweep " SCENE " --out %s --resume --n 1", out), 1); /* one sweep a directory */
  expect_output("another run writes into this directory");
  kill(pid, SIGKILL);
  waitpid(pid, NULL, 0);
  expect_processes("tandem-", 0);
  expect_processes("s", 0); /* the cells' own processes have the sweep's command line */
  directory_remove(dir);
}
END_TEST

static int ipc_directories(void) {
  command("sh -c 'ls -d %s/tandem-?????? 2>&- | wc -l'", dir);
  return atoi(command_output);
}

START_TEST(directories_of_dead_servers_go) {
  setup();
  pid_t pid[2];
  for (int i = 0; i < 2; i++) {
    char out[128];
    snprintf(out, sizeof out, "%s/out%d", dir, i);
    const char *const arguments[] = {"run", SCENE, "--out", out, "--set", "time.end=1e5", "--set", "output.interval=10",
                                     NULL};
    pid[i] = background(dir, arguments);
  }
  expect_processes("tandem-", 4);
  ck_assert_int_eq(ipc_directories(), 2);
  kill(pid[0], SIGKILL);
  waitpid(pid[0], NULL, 0);
  expect_processes("tandem-", 2);
  ck_assert_int_eq(ipc_directories(), 2);
  expect_script(0, "mkdir tandem-abcdef && touch tandem-abcdef/mine");
  ck_assert_int_eq(command("tandem check " SCENE), 0);
  ck_assert_int_eq(ipc_directories(), 2); /* that of the living one, and one that is nobody's */
  expect_script(0, "test -e tandem-abcdef/mine");
  kill(pid[1], SIGINT);
  ck_assert_int_eq(background_end(pid[1]), 130);
  ck_assert_int_eq(ipc_directories(), 1);
  directory_remove(dir);
}
END_TEST

TEST_MAIN_ROWS("hostile", {results_of_somebody_else, 1}, {names_of_a_sweep, 1},
               {values_that_differ_in_a_blank_are_two_cells, 1}, {a_report_can_be_ended, 3},
               {plots_after_a_run_can_be_ended, 1}, {a_killed_report_takes_gnuplot_with_it, 1},
               {cells_of_a_killed_sweep_end, 1}, {directories_of_dead_servers_go, 1})
