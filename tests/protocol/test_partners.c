/* The real server against a dummy solver that behaves, and one that does not. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/command.h"
#include "tests/result_table.h"
#include "tests/test_main.h"

#include <math.h>
#include <signal.h>

/* A free body of 1 kg, started at 1 m/s; dem is a foreign solver. */
static const char scene[] =
    "{\"time\": {\"end\": 0.2, \"dt\": 1e-4},\n"
    " \"coupling\": {\"n\": 1, \"fallback\": \"lommen\", \"bodies\": [{\"mbd\": \"mass\", \"dem\": \"mass\"}],\n"
    "  \"timeout\": 1.5, \"solvers\": {\"dem\": \"SOLVER\"}},\n"
    " \"mbd\": {\"gravity\": [0, 0, 0], \"bodies\": [{\"name\": \"mass\", \"mass\": 1,\n"
    "  \"inertia\": [1, 1, 1], \"position\": [0, 0, 0], \"velocity\": [1, 0, 0]}]},\n"
    " \"dem\": {\"stiffness\": 100}}\n";

static const char *dir;

static void setup(void) {
  dir = directory_with_scene(scene);
}

static int run_with(const char *fault, const char *window) {
  const char *section = strcmp(fault, "") == 0 ? "dummy_solver" : "faulty_solver";
  const bool answers = strcmp(fault, "silent") != 0 && strcmp(fault, "hangs") != 0; /* on a busy machine late */
  return command("env FAULT=%s %s%s tandem run %s/scene.json --out %s/out --force --set coupling.solvers.dem=%s --set "
                 "coupling.timeout=%s",
                 fault, window ? "FAULT_WINDOW=" : "", window ? window : "", dir, dir, section, answers ? "60" : "1.5");
}

START_TEST(dummy_is_an_oscillator) {
  setup();
  int status = run_with("", NULL);
  ck_assert_msg(status == 0, "%d: %s", status, command_output);
  cpl_table t;
  tdm_error err = {0};
  read_table(&t, dir, "out/body_mass.csv");
  const double *time = cpl_table_column(&t, "time", &err), *x = cpl_table_column(&t, "x", &err);
  const double *fx = cpl_table_column(&t, "fx", &err);
  ck_assert_int_eq(t.nrow, 201);
  for (int i = 0; i < t.nrow; i++) /* x = sin(w t)/w, w = 10 1/s; the load is a mean over 1e-3 s */
    ck_assert_double_eq_tol(x[i], sin(10 * time[i]) / 10, 2e-6);
  for (int i = 1; i < t.nrow; i++)
    ck_assert_double_eq_tol(fx[i], -10 * sin(10 * (time[i] - 0.45e-3)), 2e-3);
  cpl_table_free(&t);
  read_table(&t, dir, "out/dem.csv");
  ck_assert_double_eq_tol(cpl_table_column(&t, "dummy.time", &err)[200], 0.2, 1e-12);
  cpl_table_free(&t);
  expect_nothing_left(dir);
  directory_remove(dir);
}
END_TEST

START_TEST(unknown_key_of_a_foreign_section) {
  setup();
  ck_assert_int_eq(command("tandem run %s/scene.json --out %s/out --force --set coupling.solvers.dem=dummy_solver "
                           "--set dem.stifness=3",
                           dir, dir),
                   1);
  expect_output("dem.stifness");
  expect_output("did you mean \"stiffness\"");
  expect_output("scene.json:6:2:"); /* --set made it: the place is its parent's */
  directory_remove(dir);
}
END_TEST

/* The dummy has no capabilities: what a scheme needs is refused by name, or the scene's fallback is taken. */
START_TEST(a_scheme_that_a_solver_cannot_serve) {
  setup();
  const char *const run = "tandem run %s/scene.json --out %s/out --force --set coupling.solvers.dem=dummy_solver %s";
  ck_assert_int_eq(command(run, dir, dir, "--set coupling.fallback=proxy"), 1);
  expect_output("coupling.scheme: the scheme proxy needs the capability \"interface\", which");
  ck_assert_int_eq(command(run, dir, dir, ""), 0);
  ck_assert_int_eq(command("cat %s/out/summary.json %s/out/server.log", dir, dir), 0);
  expect_output("\"coupling.scheme\": \"lommen\"");
  expect_output("event=fallback");
  expect_output("\"from\": \"server\"");
  expect_output("lommen was taken instead");
  ck_assert_int_eq(command(run, dir, dir, "--set coupling.fallback=dem-first"), 0); /* needs mbd's accelerations only */
  ck_assert_int_eq(command(run, dir, dir, "--set coupling.fallback=none"), 1);
  expect_output("coupling.fallback");
  directory_remove(dir);
}
END_TEST

/* A fault, the window that it comes in (NULL: at HELLO), and words that the message must have. */
static const struct {
  const char *fault, *window, *words[3];
} faults[] = {
    {"version", NULL, {"protocol version 77", NULL}},
    {"garbage", NULL, {"dem: ", "refused: malformed frame: it does not begin with TNDM"}},
    {"silent", NULL, {"faulty (faulty 1.0): no answer for 1.5 s", "fault=silent"}},
    {"quits", NULL, {"faulty (faulty 1.0): the solver ended", "exit status 3", "reason=mood"}},
    {"garbage", "2", {"faulty (faulty 1.0): malformed frame", "fault=garbage"}},
    {"truncated", "2", {"faulty (faulty 1.0): malformed frame", NULL}},
    {"oversized", "2", {"faulty (faulty 1.0): oversized frame", NULL}},
    {"version", "2", {"faulty (faulty 1.0): it speaks protocol version 77", NULL}},
    {"counts", "2", {"faulty (faulty 1.0): malformed RESULT", NULL}},
    {"late", "2", {"faulty (faulty 1.0): malformed RESULT: window 3", NULL}},
    {"killed", "0", {"faulty (faulty 1.0): the solver ended", "killed by signal 9", "fault=killed"}},
    {"killed", "777", {"faulty (faulty 1.0): the solver ended", "killed by signal 9", "fault=killed"}},
    {"hangs", "5", {"faulty (faulty 1.0): no answer for 1.5 s; it hangs", "fault=hangs"}},
    {"nan", "5", {"faulty (faulty 1.0): returned a load of body \"mass\" that is not finite", "0.0005"}},
    {"huge", "5", {"faulty (faulty 1.0): returned a load of body \"mass\" that is too large to be squared", NULL}},
    {"sampled", "5", {"faulty (faulty 1.0): returned a recorded load of body \"mass\" that is not finite", NULL}},
    {"output", "5", {"faulty (faulty 1.0): returned inf for the channel \"belt.speed\" at 0.001 s", NULL}},
    {"wall", "5", {"faulty (faulty 1.0): malformed RESULT: a wall time of ", "nan s"}},
    {"moments", "5", {"faulty (faulty 1.0): returned moments of the load", "of body \"mass\" that is not finite"}},
    {"work", "5", {"faulty (faulty 1.0): returned moments of the load, an end or a work of body \"mass\"", NULL}},
    {"supplied", "5", {"faulty (faulty 1.0): returned a supplied energy that is not finite", NULL}},
    {"further", "5", {"faulty (faulty 1.0): returned a further coefficient of the load of body \"mass\"", NULL}},
    {"infinite", "5", {"faulty (faulty 1.0): returned an infinite energy", NULL}},
    {"makes",
     "5",
     {"scene.json:6:2: dem: energy without a source", "not come through the exchange", "from the particles"}},
    {"mumbles", "5", {"faulty (faulty 1.0): malformed REMARKS: entry 0 needs event, level", NULL}},
    {"wordy", "5", {"scene.json:6:2: dem.depth: faulty (faulty 1.0): too deep; raise it", "warning: dem: it is dusty"}},
};
enum { NFAULT = sizeof faults / sizeof faults[0] };

START_TEST(faults_are_named) {
  setup();
  for (int i = 0; i < NFAULT; i++) {
    int status = run_with(faults[i].fault, faults[i].window);
    ck_assert_msg(status == 1, "%s: exit status %d: %s", faults[i].fault, status, command_output);
    for (int w = 0; w < 3 && faults[i].words[w]; w++)
      ck_assert_msg(strstr(command_output, faults[i].words[w]) != NULL, "%s %s: no \"%s\" in: %s", faults[i].fault,
                    faults[i].window ? faults[i].window : "", faults[i].words[w], command_output);
    expect_nothing_left(dir);
  }
  directory_remove(dir);
}
END_TEST

/* What becomes a column's head, a plot's title and a page's text is looked at when it comes. */
START_TEST(names_of_channels_are_looked_at) {
  static const char *const bad[][2] = {{"channel", "`touch pwned`"},
                                       {"channel", "a'.system(1).'"},
                                       {"channel", "<script>"},
                                       {"channel", "x,y"},
                                       {"channel", "a b"},
                                       {"channel", ""},
                                       {"unit", "`touch pwned`"},
                                       {"unit", "m\" @x"},
                                       {"unit", "<b>"},
                                       {"unit", "a,b"},
                                       {"unit", "m\nm"},
                                       {"unit", "sixteen letters."},
                                       {"twin", ""}};
  setup();
  for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
    setenv("FAULT_TEXT", bad[i][1], 1);
    int status = run_with(bad[i][0], NULL);
    ck_assert_msg(status == 1, "%s %s: %d: %s", bad[i][0], bad[i][1], status, command_output);
    expect_output("faulty (faulty 1.0): malformed READY: READY.channels");
  }
  static const char *const good[][2] = {{"channel", "belt-2.roller_7.fx"}, {"unit", "kg m^2/s (°)"}, {"unit", ""}};
  for (int i = 0; i < 3; i++) {
    setenv("FAULT_TEXT", good[i][1], 1);
    run_with(good[i][0], NULL);
    ck_assert_msg(strstr(command_output, "malformed READY") == NULL, "%s", command_output);
  }
  directory_remove(dir);
}
END_TEST

START_TEST(remarks_of_a_foreign_solver) {
  setup();
  ck_assert_msg(run_with("chatty", "5") == 0, "%s", command_output);
  expect_output("tandem: warning: dem: it is dusty");
  ck_assert_int_eq(command("cat %s/out/summary.json", dir), 0);
  expect_output("\"event\": \"dust\"");
  expect_output("\"count\": 2000"); /* the last of 2000 windows said so */
  directory_remove(dir);
}
END_TEST

/* The multibody solver is the one who sent it, whoever stumbles over it. */
START_TEST(faults_of_mbd_are_named) {
  static const char *const cases[][3] = {
      {"zero", "5",
       "faulty (faulty 1.0): returned a state of body \"mass\" that has a quaternion that is not of norm 1"},
      {"sampled_state", "5", "faulty (faulty 1.0): returned a recorded state of body \"mass\" that is not finite"},
      {"norm", NULL,
       "faulty (faulty 1.0): malformed READY: the state of body \"mass\" has a quaternion that is not of"},
      {"place", NULL, "faulty (faulty 1.0): malformed READY: the state of body \"mass\" is too large to be squared"},
      {"inertia", NULL, "faulty (faulty 1.0): malformed READY: the inertia of body \"mass\" is not symmetric, or neg"}};
  setup();
  for (int i = 0; i < 5; i++) {
    int status = command("env FAULT_ROLE=mbd FAULT=%s %s%s tandem run %s/scene.json --out %s/out --force --set "
                         "coupling.solvers.mbd=faulty_solver --set coupling.solvers.dem=dummy_solver",
                         cases[i][0], cases[i][1] ? "FAULT_WINDOW=" : "", cases[i][1] ? cases[i][1] : "", dir, dir);
    ck_assert_msg(status == 1, "%s: %d: %s", cases[i][0], status, command_output);
    expect_output(cases[i][2]);
    ck_assert_int_eq(command("test -s %s/out/summary.json -o -s %s/out/start/summary.json", dir, dir), 0);
    expect_nothing_left(dir);
  }
  directory_remove(dir);
}
END_TEST

START_TEST(a_fast_turn_is_refused) {
  /* 100 rad/s: n = 90 is 0.9 rad a window, n = 110 is 1.1 rad */
  setup();
  static const char *const sets[] = {"90", "110"};
  for (int i = 0; i < 2; i++) {
    int status = command("tandem run %s/scene.json --out %s/out --force --set coupling.solvers.dem=dummy_solver "
                         "--set 'mbd.bodies[0].angular_velocity=[0,0,100]' --set coupling.n=%s",
                         dir, dir, sets[i]);
    ck_assert_msg(status == i, "%s", command_output);
  }
  expect_output("coupling.n: body \"mass\" turns by 1.1 rad");
  directory_remove(dir);
}
END_TEST

START_TEST(what_was_computed_is_kept) {
  setup();
  ck_assert_int_eq(run_with("killed", "1000"), 1);
  cpl_table t;
  read_table(&t, dir, "out/body_mass.csv");
  ck_assert_int_eq(t.nrow, 101); /* windows 0 ... 999 are 0.1 s, and the row of t = 0 */
  cpl_table_free(&t);
  ck_assert_int_eq(command("cat %s/out/summary.json", dir), 0);
  expect_output("\"status\": \"TDM_ERR_LOST\"");
  expect_output("\"windows\": 1000");
  directory_remove(dir);
}
END_TEST

START_TEST(a_deaf_solver_is_ended) {
  setup();
  int status = run_with("deaf", NULL);
  ck_assert_msg(status == 0, "%s", command_output);
  expect_nothing_left(dir);
  directory_remove(dir);
}
END_TEST

/* dem.solver: the rest of the section is that solver's, whatever tandem-dem would make of it. */
START_TEST(a_section_names_its_solver) {
  setup();
  const char *const run = "env PATH=/usr/bin:/bin " TANDEM_BIN_DIR "/tandem run %s/scene.json --out %s/out --force "
                          "--set 'coupling.solvers={}' --set time.end=0.01 %s";
  ck_assert_msg(command(run, dir, dir, "--set dem.solver=" TANDEM_TEST_DIR "/dummy_solver") == 0, "%s", command_output);
  ck_assert_int_eq(command(run, dir, dir, "--set dem.solver=" TANDEM_TEST_DIR "/dummy_solver --set dem.settle=1"), 1);
  expect_output("dem.settle: solver (dummy 1.0): unknown key \"settle\"; known here: stiffness");
  ck_assert_int_eq(command(run, dir, dir, "--set dem.solver=7"), 1);
  expect_output("dem.solver: must be a string");
  ck_assert_int_eq(command(run, dir, dir, "--set dem.solver=a --set coupling.solvers.dem=b"), 1);
  expect_output("coupling.solvers.dem: names the solver that dem.solver names too");
  ck_assert_int_eq(command(run, dir, dir, "--set dem.solver=null"), 1);
  expect_output("dem.solver: is null");
  ck_assert_int_eq(command(run, dir, dir, "--set dem.solver=no_such_solver"), 1);
  expect_output("dem.solver: the solver \"no_such_solver\"");
  /* the second word is beside tandem, which its PATH does not have */
  ck_assert_int_eq(command(run, dir, dir, "--set 'dem.solver=env tandem-dem'"), 1);
  expect_output("dem.materials: dem (tandem-dem ");
  directory_remove(dir);
}
END_TEST

/* mbd.solver as an object is the integrator's settings, coupled and alone. */
START_TEST(settings_of_the_integrator_are_no_command) {
  setup();
  ck_assert_msg(command("tandem run %s/scene.json --out %s/out --force --set coupling.solvers.dem=dummy_solver "
                        "--set time.end=0.01 --set mbd.solver.relative_tolerance=1e-9",
                        dir, dir) == 0,
                "%s", command_output);
  ck_assert_int_eq(command("tandem run %s/scene.json --out %s/out --force --set coupling.solvers.dem=dummy_solver "
                           "--set time.end=0.01 --set mbd.solver.relative_tolerance=7",
                           dir, dir),
                   1);
  expect_output("mbd.solver.relative_tolerance: mbd (tandem-mbd 0.1.0): is 7");
  write_file(dir, "alone.json",
             "{\"time\": {\"end\": 0.01, \"dt\": 1e-3}, \"mbd\": {\"solver\": {\"max_order\": 9},"
             "\"bodies\": [{\"name\": \"mass\", \"mass\": 1, \"inertia\": [1, 1, 1], "
             "\"position\": [0, 0, 0]}]}}\n");
  ck_assert_int_eq(command("tandem-mbd run %s/alone.json --out %s/out --force", dir, dir), 1);
  expect_output("mbd.solver.max_order: must be 1 to 5");
  directory_remove(dir);
}
END_TEST

START_TEST(a_solver_that_is_not_there) {
  setup();
  ck_assert_int_eq(
      command("tandem run %s/scene.json --out %s/out --force --set coupling.solvers.dem=no_such_solver", dir, dir), 1);
  expect_output("no_such_solver");
  expect_output("neither beside this program nor on PATH");
  expect_nothing_left(dir);
  directory_remove(dir);
}
END_TEST

START_TEST(a_server_that_dies_takes_its_solvers) {
  setup();
  pid_t pid = fork();
  if (pid == 0) {
    char file[256], out[256];
    setenv("FAULT", "hangs", 1);
    setenv("FAULT_WINDOW", "3", 1);
    snprintf(file, sizeof file, "%s/scene.json", dir);
    snprintf(out, sizeof out, "%s/out", dir);
    execl(TANDEM_BIN_DIR "/tandem", "tandem", "run", file, "--out", out, "--force", "--set",
          "coupling.solvers.dem=" TANDEM_TEST_DIR "/faulty_solver", "--set", "coupling.timeout=50", NULL);
    _exit(127);
  }
  char solver[128], partner[128];
  snprintf(solver, sizeof solver, "faulty_solver --connect ipc://%s", dir);
  snprintf(partner, sizeof partner, "tandem-mbd --connect ipc://%s", dir);
  WAIT_FOR(find_processes(solver, NULL) == 1 && find_processes(partner, NULL) == 1);
  ck_assert_int_eq(kill(pid, SIGKILL), 0);
  waitpid(pid, NULL, 0);
  WAIT_FOR(find_processes(solver, NULL) == 0 && find_processes(partner, NULL) == 0);
  directory_remove(dir);
}
END_TEST

START_TEST(a_solver_without_a_server_gives_up) {
  ck_assert_int_eq(command("tandem-mbd --connect ipc:///tmp/tandem-test-nobody --timeout 0.5"), 1);
  expect_output("nothing heard from the server");
  ck_assert_int_eq(command("tandem-dem --connect tcp://127.0.0.1:1 --timeout 0.5"), 1);
  expect_output("nothing heard from the server at tcp://127.0.0.1:1");
  ck_assert_int_eq(command("tandem-dem --connect nonsense"), 1);
  expect_output("cannot connect to nonsense");
  ck_assert_int_eq(command("tandem-dem --conect ipc:///tmp/x"), 2);
  expect_output("wrong option");
  ck_assert_int_eq(command("tandem-mbd --timeout 1"), 2);
  expect_output("no server given");
}
END_TEST

TEST_MAIN("partners", dummy_is_an_oscillator, unknown_key_of_a_foreign_section, a_scheme_that_a_solver_cannot_serve,
          faults_are_named, faults_of_mbd_are_named, names_of_channels_are_looked_at, remarks_of_a_foreign_solver,
          a_fast_turn_is_refused, what_was_computed_is_kept, a_deaf_solver_is_ended, a_section_names_its_solver,
          settings_of_the_integrator_are_no_command, a_solver_that_is_not_there, a_server_that_dies_takes_its_solvers,
          a_solver_without_a_server_gives_up)
