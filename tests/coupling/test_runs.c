/* Whole runs with tandem's own solvers: bit-identity, the output grid, the last window, Ctrl-C. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/math/random.h"
#include "tests/command.h"
#include "tests/result_table.h"
#include "tests/test_main.h"

#include <math.h>
#include <pty.h>
#include <signal.h>

/* Eight balls drop into a sprung box. */
static const char scene[] =
    "{\"time\": {\"end\": 0.1, \"dt\": 2e-4},\n"
    " \"coupling\": {\"n\": 5, \"bodies\": [{\"mbd\": \"box\", \"dem\": \"tub\"}]},\n"
    " \"mbd\": {\"bodies\": [{\"name\": \"box\", \"mass\": 5, \"inertia\": [1, 1, 1], \"position\": [0, 0, 0]}],\n"
    "  \"joints\": [{\"name\": \"guide\", \"type\": \"prismatic\", \"bodies\": [\"ground\", \"box\"],\n"
    "   \"point\": [0, 0, 0], \"axis\": [0, 0, 1]}],\n"
    "  \"forces\": [{\"name\": \"spring\", \"type\": \"spring_damper\", \"bodies\": [\"ground\", \"box\"],\n"
    "   \"points\": [[0, 0, 2], [0, 0, 0]], \"stiffness\": 2000, \"damping\": 10}]},\n"
    " \"dem\": {\"materials\": [{\"name\": \"m\", \"density\": 1000, \"young_modulus\": 1e7, \"poisson_ratio\": "
    "0.3}],\n"
    "  \"pairs\": [{\"materials\": [\"m\", \"m\"], \"restitution\": 0.8, \"friction\": 0.4}],\n"
    "  \"bodies\": [{\"name\": \"tub\", \"material\": \"m\", \"shapes\": [{\"type\": \"box\", \"size\": [0.5, 0.5, "
    "0.5],\n"
    "   \"side\": \"inside\"}]}],\n"
    "  \"particles\": [{\"type\": \"random\", \"material\": \"m\", \"count\": 8, \"radius\": 0.05, \"seed\": 3,\n"
    "   \"region\": {\"min\": [-0.2, -0.2, -0.24], \"max\": [0.2, 0.2, -0.12]}}]}}\n";

static const char *dir;

static void setup(void) {
  dir = directory_with_scene(scene);
}

static void run(const char *out, const char *options) {
  int status = command("tandem run %s/scene.json --out %s/%s %s", dir, dir, out, options);
  ck_assert_msg(status == 0, "%d: %s", status, command_output);
}

static void expect_same(const char *a, const char *b, const char *file) {
  ck_assert_msg(command("cmp %s/%s/%s %s/%s/%s", dir, a, file, dir, b, file) == 0, "%s", command_output);
}

static void read_body(cpl_table *t, const char *out) {
  char file[64];
  snprintf(file, sizeof file, "%s/body_box.csv", out);
  read_table(t, dir, file);
}

/* largest difference of the box's height in two runs [m] */
static double apart(const char *a, const char *b) {
  cpl_table one, two;
  tdm_error err = {0};
  double most = 0;
  read_body(&one, a);
  read_body(&two, b);
  const double *z1 = cpl_table_column(&one, "z", &err), *z2 = cpl_table_column(&two, "z", &err);
  ck_assert_msg(z1 && z2 && one.nrow == two.nrow, "%s", err.message);
  for (int i = 0; i < one.nrow; i++)
    most = fmax(most, fabs(z1[i] - z2[i]));
  cpl_table_free(&one);
  cpl_table_free(&two);
  return most;
}

/* The scheme that lets DEM go first comes to the same motion, the nearer the shorter its windows. */
START_TEST(dem_first_follows_the_same_motion) {
  setup();
  run("fine", "--set coupling.n=1");
  run("first1", "--set coupling.n=1 --set coupling.scheme=dem-first");
  run("first5", "--set coupling.n=5 --set coupling.scheme=dem-first");
  run("again", "--set coupling.n=5 --set coupling.scheme=dem-first --set coupling.transport=inproc");
  expect_same("first5", "again", "body_box.csv");
  ck_assert_double_lt(apart("fine", "first1"), 2e-5);
  ck_assert_double_lt(apart("fine", "first5"), 5e-5);
  ck_assert_int_eq(command("tandem check %s/scene.json --set coupling.scheme=dem-first", dir), 0);
}
END_TEST

START_TEST(runs_are_bit_identical) {
  setup();
  run("one", "");
  run("two", "");
  run("thread", "--set coupling.transport=inproc");
  run("tcp", "--set coupling.transport=tcp");
  static const char *const files[] = {"body_box.csv", "mbd.csv", "dem.csv"};
  static const char *const others[] = {"two", "thread", "tcp"};
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++)
      expect_same("one", others[j], files[i]);
  cpl_table t;
  tdm_error err = {0};
  read_body(&t, "one");
  const double *fz = cpl_table_column(&t, "fz", &err);
  double largest = 0;
  for (int i = 0; i < t.nrow; i++)
    largest = fmax(largest, fabs(fz[i]));
  ck_assert_double_gt(largest, 10); /* the balls did hit the box */
  cpl_table_free(&t);
  directory_remove(dir);
}
END_TEST

START_TEST(iterations_are_bit_identical_and_recorded_once) {
  setup();
  run("one", "--set coupling.scheme=iterative --set coupling.n=50 --set coupling.iterative.tolerance=1e-7");
  run("thread", "--set coupling.scheme=iterative --set coupling.n=50 --set coupling.iterative.tolerance=1e-7 --set "
                "coupling.transport=inproc");
  static const char *const files[] = {"body_box.csv", "mbd.csv", "dem.csv"};
  for (int i = 0; i < 3; i++)
    expect_same("one", "thread", files[i]);
  ck_assert_int_eq(command("grep -A3 iterations %s/one/summary.json", dir), 0);
  expect_output("\"windows_not_converged\": 0");
  ck_assert_int_eq(command("grep -q '\"mean\": 1\\.0' %s/one/summary.json", dir), 1); /* windows were repeated */
  ck_assert_int_eq(command("grep -q one_step %s/one/summary.json", dir), 0);
  cpl_table t;
  tdm_error err = {0};
  read_body(&t, "one");
  ck_assert_int_eq(t.nrow, 101);
  const double *time = cpl_table_column(&t, "time", &err);
  for (int k = 0; k < t.nrow; k++)
    ck_assert_double_eq_tol(time[k], k * 1e-3, 1e-12);
  cpl_table_free(&t);
  /* short windows of proxy come to the same motion */
  run("fine", "--set coupling.n=1");
  ck_assert_double_lt(apart("fine", "one"), 2e-5);
  directory_remove(dir);
}
END_TEST

START_TEST(the_grid_does_not_depend_on_n) {
  setup();
  run("n1", "--set coupling.n=1");
  run("n7", "--set coupling.n=7");
  run("n500", "--set coupling.n=500");
  run("fine", "--set coupling.n=50 --set output.interval=3e-4");
  static const char *const outs[] = {"n1", "n7", "n500"};
  for (int i = 0; i < 3; i++) {
    cpl_table t;
    tdm_error err = {0};
    read_body(&t, outs[i]);
    ck_assert_int_eq(t.nrow, 101);
    const double *time = cpl_table_column(&t, "time", &err);
    for (int k = 0; k < t.nrow; k++)
      ck_assert_double_eq_tol(time[k], k * 1e-3, 1e-12);
    cpl_table_free(&t);
  }
  cpl_table t;
  read_body(&t, "fine");
  ck_assert_int_eq(t.nrow, 335); /* 0, 3e-4, ... 0.0999, and the last state at 0.1 */
  cpl_table_free(&t);
  directory_remove(dir);
}
END_TEST

START_TEST(the_last_window_is_shorter) {
  setup();
  run("out", "--set coupling.n=300"); /* 500 steps: windows of 300 and 200 */
  expect_output("0.1 s simulated in 2 windows");
  run("odd", "--set time.end=0.0101 --set coupling.n=20"); /* 51 steps of 2e-4 s: the run goes on to 0.0102 s */
  expect_output("0.0102 s simulated in 3 windows");
  directory_remove(dir);
}
END_TEST

START_TEST(loads_are_means_between_output_times) {
  /* one load mean over 4e-3 s equals the average of the four means over 1e-3 s */
  setup();
  cpl_table fine, coarse;
  tdm_error err = {0};
  run("fine", "");
  run("coarse", "--set output.interval=4e-3");
  read_body(&fine, "fine");
  read_body(&coarse, "coarse");
  const double *f = cpl_table_column(&fine, "fz", &err), *c = cpl_table_column(&coarse, "fz", &err);
  const double *zf = cpl_table_column(&fine, "z", &err), *zc = cpl_table_column(&coarse, "z", &err);
  for (int i = 1; i < coarse.nrow; i++) {
    double mean = (f[4 * i] + f[4 * i - 1] + f[4 * i - 2] + f[4 * i - 3]) / 4;
    ck_assert_double_eq_tol(c[i], mean, 1e-9 * (1 + fabs(mean)));
    ck_assert_double_eq_tol(zc[i], zf[4 * i], 1e-12);
  }
  cpl_table_free(&fine);
  cpl_table_free(&coarse);
  directory_remove(dir);
}
END_TEST

START_TEST(an_empty_box_is_an_oscillator) {
  setup();
  run("out", "--set dem.particles=[] --set mbd.formulation=ggl");
  cpl_table t;
  tdm_error err = {0};
  read_body(&t, "out");
  const double *time = cpl_table_column(&t, "time", &err), *z = cpl_table_column(&t, "z", &err);
  double decay = 1, frequency = sqrt(2000.0 / 5 - 1), rest = 5 * 9.81 / 2000;
  for (int i = 0; i < t.nrow; i++) {
    double c = cos(frequency * time[i]), s = sin(frequency * time[i]);
    double exact = -rest * (1 - exp(-decay * time[i]) * (c + decay / frequency * s));
    ck_assert_double_eq_tol(z[i], exact, 1e-8);
  }
  cpl_table_free(&t);
  directory_remove(dir);
}
END_TEST

/* Start a run that would take long, with two overrides. */
static pid_t long_run(const char *first, const char *second) {
  char file[256], out[256];
  snprintf(file, sizeof file, "%s/scene.json", dir);
  snprintf(out, sizeof out, "%s/out", dir);
  const char *const arguments[] = {"run",          file,    "--out", out,     "--force", "--set",
                                   "time.end=1e5", "--set", first,   "--set", second,    NULL};
  return background(dir, arguments);
}

/* Wait until a run has written so many more rows. */
static void wait_for_rows(int more) {
  int rows = lines_of(dir, "out/body_box.csv") + more;
  WAIT_FOR(lines_of(dir, "out/body_box.csv") > rows);
}

/* The solvers of the run under way, once they are there. */
static void find_solvers(pid_t solver[2]) {
  static const char *const names[] = {"tandem-mbd", "tandem-dem"};
  for (int i = 0; i < 2; i++) {
    char text[128];
    snprintf(text, sizeof text, "%s --connect ipc://%s", names[i], dir);
    WAIT_FOR(find_processes(text, &solver[i]) == 1);
  }
}

START_TEST(ctrl_c_keeps_what_was_computed) {
  setup();
  static const char *const options[] = {"coupling.transport=ipc", "coupling.transport=inproc", "coupling.n=100000000"};
  static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
  for (int i = 0; i < 3; i++) {
    pid_t pid = long_run(options[i], i == 2 ? "output.interval=10" : "output.interval=0.01"), solver[2];
    if (i == 2) { /* in the middle of the first window, which never ends */
      find_solvers(solver);
      WAIT_FOR(processor_time(solver[1]) > 0.5);
    } else {
      wait_for_rows(12);
    }
    kill(pid, signals[i]);
    ck_assert_int_eq(background_end(pid), 130);
    expect_nothing_left(dir);
    ck_assert_int_eq(command("cat %s/out/summary.json", dir), 0);
    expect_output("TDM_ERR_INTERRUPTED");
    if (i == 2)
      continue;
    cpl_table t;
    read_body(&t, "out");
    ck_assert_int_gt(t.nrow, 10);
    cpl_table_free(&t);
  }
  directory_remove(dir);
}
END_TEST

START_TEST(ctrl_c_while_settling_as_threads) {
  setup();
  pid_t pid = long_run("coupling.transport=inproc", "dem.settle={\"speed\": 1e-12, \"max_time\": 1e6}");
  WAIT_FOR(processor_time(pid) > 0.5);
  kill(pid, SIGINT);
  ck_assert_int_eq(background_end(pid), 130); /* the thread is asked and ends */
  directory_remove(dir);
}
END_TEST

/* Send a signal to the server and to its solvers, as a terminal does: at once. */
static void signal_all(pid_t server, const pid_t solver[2], int number) {
  kill(server, number);
  kill(solver[0], number);
  kill(solver[1], number);
}

START_TEST(a_stopped_run_goes_on) {
  setup();
  pid_t pid = long_run("coupling.timeout=4", "output.interval=0.01");
  pid_t solver[2];
  find_solvers(solver);
  wait_for_rows(1);
  signal_all(pid, solver, SIGSTOP);
  sleep(6); /* longer than the time-out: what is tested */
  signal_all(pid, solver, SIGCONT);
  wait_for_rows(10);
  ck_assert(background_runs(pid));
  kill(pid, SIGINT);
  ck_assert_int_eq(background_end(pid), 130);
  directory_remove(dir);
}
END_TEST

/* resident memory [kB] of the one process whose command line has this text */
static long resident(const char *text) {
  pid_t pid;
  char path[64], line[256];
  long size = -1;
  ck_assert_int_eq(find_processes(text, &pid), 1);
  snprintf(path, sizeof path, "/proc/%d/status", (int)pid);
  FILE *f = fopen(path, "r");
  while (f && fgets(line, sizeof line, f))
    sscanf(line, "VmRSS: %ld", &size);
  if (f)
    fclose(f);
  return size;
}

START_TEST(memory_is_constant) {
#ifdef __SANITIZE_ADDRESS__
  return; /* its quarantine grows */
#endif
  setup();
  pid_t pid = long_run("coupling.n=1", "output.interval=0.01");
  char text[3][160];
  long before[3];
  wait_for_rows(10);
  snprintf(text[0], sizeof text[0], "tandem run %s", dir);
  snprintf(text[1], sizeof text[1], "tandem-mbd --connect ipc://%s", dir);
  snprintf(text[2], sizeof text[2], "tandem-dem --connect ipc://%s", dir);
  for (int i = 0; i < 3; i++)
    before[i] = resident(text[i]);
  wait_for_rows(200); /* tens of thousands of windows */
  for (int i = 0; i < 3; i++)
    ck_assert_msg(resident(text[i]) <= before[i] + 64, "%s grew from %ld to %ld kB", text[i], before[i],
                  resident(text[i]));
  kill(pid, SIGINT);
  ck_assert_int_eq(background_end(pid), 130);
  directory_remove(dir);
}
END_TEST

START_TEST(a_bar_on_a_terminal) {
  setup();
  int terminal;
  char file[256], out[256];
  snprintf(file, sizeof file, "%s/scene.json", dir);
  snprintf(out, sizeof out, "%s/out", dir);
  pid_t pid = forkpty(&terminal, NULL, NULL, NULL);
  if (pid < 0) { /* no terminals to be had (a chroot without devpts): nothing to see */
    directory_remove(dir);
    return;
  }
  if (pid == 0) {
    execl(TANDEM_BIN_DIR "/tandem", "tandem", "run", file, "--out", out, "--set", "time.end=2", "--set", "coupling.n=1",
          NULL);
    _exit(127);
  }
  size_t used = 0;
  ssize_t n;
  while ((n = read(terminal, command_output + used, sizeof command_output - used - 1)) >
         0) /* fails when it has ended */
    used = used + (size_t)n < sizeof command_output / 2 ? used + (size_t)n : used;
  command_output[used] = 0;
  ck_assert_int_eq(background_end(pid), 0);
  expect_output("[==");
  expect_output("windows/s");
  expect_output("left");
  close(terminal);
  directory_remove(dir);
}
END_TEST

START_TEST(an_installed_tandem_finds_its_own) {
  setup();
  ck_assert_int_eq(
      command("sh -c 'mkdir -p %s/p/bin %s/p/share/tandem/scenarios/mine %s/elsewhere && cp " TANDEM_BIN_DIR
              "/tandem " TANDEM_BIN_DIR "/tandem-mbd %s/p/bin && cp " TANDEM_BIN_DIR
              "/tandem-dem %s/elsewhere && cp %s/scene.json %s/p/share/tandem/scenarios/mine'",
              dir, dir, dir, dir, dir, dir, dir),
      0);
  /* the scenario from the share folder, mbd from beside the program, dem from PATH */
  int status = command("env PATH=%s/elsewhere:/usr/bin:/bin %s/p/bin/tandem run mine --out %s/out", dir, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  /* ./scenarios comes first */
  ck_assert_int_eq(command("sh -c 'mkdir -p %s/scenarios/mine && echo {} >%s/scenarios/mine/scene.json'", dir, dir), 0);
  ck_assert_int_eq(command("sh -c 'cd %s && p/bin/tandem run mine --out out'", dir), 1);
  expect_output("scenarios/mine/scene.json");
  directory_remove(dir);
}
END_TEST

START_TEST(result_directories_are_guarded) {
  setup();
  ck_assert_int_eq(command("tandem run %s/scene.json --out %s", dir, dir), 1);
  expect_output("is the scene itself");
  pid_t pid = long_run("coupling.n=1", "output.interval=0.01");
  wait_for_rows(1);
  ck_assert_int_eq(command("tandem run %s/scene.json --out %s/out", dir, dir), 1);
  expect_output("another run writes into this directory");
  kill(pid, SIGINT);
  ck_assert_int_eq(background_end(pid), 130);
  ck_assert_int_eq(command("tandem run %s/scene.json --out %s/out", dir, dir), 1);
  expect_output("holds the results of an earlier run");
  expect_output("--force");
  run("out", "--force");
  directory_remove(dir);
}
END_TEST

START_TEST(a_report_plots_and_keeps_the_logs) {
  setup();
  run("out", "");
  ck_assert_int_eq(command("tandem report %s/out", dir), 0);
  static const char *const files[] = {"report_01_body_box.png", "index.html", "dem.log", "mbd.log", "server.log"};
  for (int i = 0; i < 5; i++)
    ck_assert_msg(command("test -s %s/out/%s", dir, files[i]) == 0, "no %s", files[i]);
  ck_assert_int_eq(command("tandem report %s", dir), 1);
  expect_output("give the directory of a run");
  directory_remove(dir);
}
END_TEST

START_TEST(a_full_disk_leaves_readable_results) {
  /* a limit on the size of files makes writes fail as a full disk does */
  setup();
  int status = command(
      "sh -c 'ulimit -f 200; tandem run %s/scene.json --out %s/out --set time.end=20 --set coupling.n=50'", dir, dir);
  ck_assert_msg(status == 1, "%d: %s", status, command_output);
  expect_output("a time history cannot be written");
  expect_output("what is there stays readable");
  cpl_table t;
  tdm_error err = {0};
  read_body(&t, "out");
  ck_assert_int_gt(t.nrow, 100);
  const double *time = cpl_table_column(&t, "time", &err), *z = cpl_table_column(&t, "z", &err);
  for (int i = 0; i < t.nrow; i++) {
    ck_assert_double_eq_tol(time[i], i * 1e-3, 1e-9);
    ck_assert_double_lt(fabs(z[i]), 1);
  }
  cpl_table_free(&t);
  expect_nothing_left(dir);
  directory_remove(dir);
}
END_TEST

START_TEST(check_tells_what_would_run) {
  setup();
  ck_assert_int_eq(command("tandem check %s/scene.json --out %s/out", dir, dir), 0);
  static const char *const words[] = {"500 DEM steps",      "100 windows",   "proxy",
                                      "degrees_of_freedom", "rayleigh_step", "\"box\" (mbd) is \"tub\" (dem), 5 kg",
                                      "0 warnings"};
  for (int i = 0; i < 7; i++)
    expect_output(words[i]);
  directory_remove(dir);
}
END_TEST

START_TEST(a_solver_killed_at_a_random_window) {
  setup();
  uint64_t draw = (uint64_t)getpid();
  static const char *const solvers[] = {"dem", "mbd"};
  for (int i = 0; i < 4; i++) {
    char find[128], named[64];
    snprintf(find, sizeof find, "tandem-%s --connect ipc://%s", solvers[i % 2], dir);
    snprintf(named, sizeof named, "error: %s", solvers[i % 2]); /* its software is known only after HELLO */
    int delay = (int)(400000 * tdm_random_next(&draw));         /* [us] */
    pid_t killer = fork();
    if (killer == 0) {
      pid_t victim;
      WAIT_FOR(find_processes(find, &victim) == 1);
      usleep((useconds_t)delay); /* at random: what is tested */
      _exit(find_processes(find, &victim) == 1 ? kill(victim, SIGKILL) != 0 : 2);
    }
    int status = command("tandem run %s/scene.json --out %s/out --force --set time.end=1e5", dir, dir), killed;
    waitpid(killer, &killed, 0);
    ck_assert_int_eq(killed, 0);
    ck_assert_msg(status == 1, "%d after %d us: %s", status, delay, command_output);
    expect_output(named);
    expect_output("killed by signal 9");
    expect_nothing_left(dir);
  }
  directory_remove(dir);
}
END_TEST

START_TEST(the_summary_tells_how_it_went) {
  setup();
  run("out", "");
  static const char *const parts[] = {"part", "step [s]", "wait [s]", "exchange [s]", "  mbd ", "  dem ", "  server "};
  for (int i = 0; i < 7; i++)
    expect_output(parts[i]);
  ck_assert_int_eq(command("cat %s/out/summary.json", dir), 0);
  static const char *const words[] = {"\"status\": \"TDM_OK\"",
                                      "\"windows\": 100",
                                      "\"coupling.scheme\": \"proxy\"",
                                      "tandem-dem",
                                      "tandem-mbd",
                                      "\"setup\"",
                                      "\"coupling\""};
  for (int i = 0; i < 7; i++)
    expect_output(words[i]);
  directory_remove(dir);
}
END_TEST

/* A container of a coupled body, which the particle leaves after it has rebounded: counted, and a jam until then, in
 * summary.json, also where windows are tried again. */
START_TEST(a_coupled_container_is_watched) {
  static const char *const schemes[] = {"proxy", "iterative"};
  setup();
  for (int k = 0; k < 2; k++) {
    ck_assert_msg(command("tandem run collision --out %s/%s --set time.end=0.01 --set coupling.n=5 --set "
                          "coupling.scheme=%s --set 'dem.containers=[{\"name\": \"front\", \"body\": \"cube\", "
                          "\"min\": [-0.113, -1, -1], \"max\": [0, 1, 1], \"jam_time\": 1e-3, \"jam_start\": 0}]'",
                          dir, schemes[k], schemes[k]) == 0,
                  "%s", command_output);
    char file[256];
    json_error_t error;
    snprintf(file, sizeof file, "%s/%s/summary.json", dir, schemes[k]);
    json_t *summary = json_load_file(file, 0, &error), *warnings = json_object_get(summary, "warnings");
    ck_assert_msg(summary != NULL, "%s", error.text);
    const json_t *front = json_object_get(json_object_get(summary, "containers"), "front");
    ck_assert_int_eq(json_integer_value(json_object_get(front, "left")), 1);
    ck_assert_int_eq(json_integer_value(json_object_get(front, "number")), 0);
    ck_assert_int_eq(json_integer_value(json_object_get(front, "jams")), 1);
    ck_assert_int_eq((int)json_array_size(warnings), 1);
    const json_t *jam = json_array_get(warnings, 0);
    ck_assert_str_eq(json_string_value(json_object_get(jam, "event")), "jam.front");
    ck_assert_int_eq(json_integer_value(json_object_get(jam, "count")), 1);
    json_decref(summary);
  }
  directory_remove(dir);
}
END_TEST

TEST_MAIN("runs", runs_are_bit_identical, iterations_are_bit_identical_and_recorded_once,
          dem_first_follows_the_same_motion, the_grid_does_not_depend_on_n, the_last_window_is_shorter,
          loads_are_means_between_output_times, an_empty_box_is_an_oscillator, ctrl_c_keeps_what_was_computed,
          a_solver_killed_at_a_random_window, the_summary_tells_how_it_went, a_coupled_container_is_watched,
          ctrl_c_while_settling_as_threads, a_stopped_run_goes_on, memory_is_constant, a_bar_on_a_terminal,
          an_installed_tandem_finds_its_own, result_directories_are_guarded, a_report_plots_and_keeps_the_logs,
          check_tells_what_would_run, a_full_disk_leaves_readable_results)
