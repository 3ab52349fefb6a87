/* Participants in Python: the two of a page conform, they run a co-simulation that theory knows, and what is wrong with
 * a scene or with themselves is told as of any solver. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/command.h"
#include "tests/test_main.h"

#include <math.h>

/* A ball of 2 kg at 1 m/s on a spring of 50 N/m: x = sin(5 t)/5. */
static const char scene[] =
    "{'time':{'end':2,'dt':1e-3},'coupling':{'bodies':[{'mbd':'ball','dem':'ball'}],'scheme':'lommen','n':1,\n"
    "'solvers':{'mbd':'" TANDEM_PYTHON " " TANDEM_PYTHON_DIR "/dummy_mbd.py','dem':'" TANDEM_PYTHON
    " " TANDEM_PYTHON_DIR "/dummy_dem.py'}},\n"
    "'output':{'interval':0.1},'mbd':{'bodies':[{'name':'ball','mass':2,'inertia':0.1,'position':[0,0,0],\n"
    "'velocity':[1,0,0]}]},'dem':{'stiffness':50}}\n";

static const char *dir;

static void setup(void) {
  dir = directory_with_scene(scene);
}

static void teardown(void) {
  expect_nothing_left(dir);
  directory_remove(dir);
}

static int run(const char *options) {
  return command("tandem run %s/scene.json --out %s/out --force %s", dir, dir, options);
}

/* x of the ball in the last row */
static double last_place(void) {
  char path[128], line[1024];
  double t = NAN, x = NAN;
  snprintf(path, sizeof path, "%s/out/body_ball.csv", dir);
  FILE *f = fopen(path, "r");
  ck_assert_ptr_nonnull(f);
  while (fgets(line, sizeof line, f))
    sscanf(line, "%lf,%lf", &t, &x);
  fclose(f);
  ck_assert_double_eq_tol(t, 2, 1e-9);
  return x;
}

START_TEST(dummies_conform) {
  setup();
  ck_assert_msg(command("tandem conform %s/scene.json -- " TANDEM_PYTHON " " TANDEM_PYTHON_DIR "/dummy_mbd.py", dir) ==
                    0,
                "%s", command_output);
  expect_output("as mbd");
  expect_output("0 broken, 7 not claimed, 4 not seen");
  ck_assert_msg(command("tandem conform %s/scene.json -- " TANDEM_PYTHON " " TANDEM_PYTHON_DIR "/dummy_dem.py", dir) ==
                    0,
                "%s", command_output);
  expect_output("as dem");
  expect_output("0 broken, 13 not claimed, 3 not seen");
  teardown();
}
END_TEST

START_TEST(a_run_of_two) {
  const double x = sin(10) / 5;
  setup();
  ck_assert_msg(run("") == 0, "%s", command_output);
  ck_assert_double_eq_tol(last_place(), x, 1e-3 * fabs(x));
  /* the mean of a window's loads, known one step late: (k/m) dt/2 of damping over 2 s */
  ck_assert_msg(run("--set coupling.scheme=dem-first") == 0, "%s", command_output);
  ck_assert_double_eq_tol(last_place(), x, 0.025 * fabs(x));
  teardown();
}
END_TEST

START_TEST(with_own_solvers) {
  /* a body of tandem-mbd on the spring in Python */
  setup();
  ck_assert_msg(run("--set coupling.solvers.mbd=tandem-mbd --set mbd.bodies[0].inertia=[0.1,0.1,0.1] --set "
                    "mbd.gravity=[0,0,0]") == 0,
                "%s", command_output);
  ck_assert_double_eq_tol(last_place(), sin(10) / 5, 1e-3);
  teardown();
}
END_TEST

START_TEST(faults_are_named) {
  setup();
  ck_assert_int_eq(run("--set mbd.bodies[0].mass=-1"), 1);
  expect_output("mbd.bodies[0].mass");
  expect_output("give a number above 0");
  ck_assert_int_eq(run("--set dem.stifness=1"), 1);
  expect_output("dem.stifness");
  expect_output("unknown key");
  ck_assert_int_eq(run("--set coupling.bodies[0].mbd=none"), 1);
  expect_output("there is no body");
  /* an exception that nobody thought of */
  ck_assert_int_eq(run("--set 'mbd.bodies[0].position=7'"), 1);
  expect_output("TypeError");
  ck_assert_int_eq(run("--set coupling.scheme=proxy"), 1);
  expect_output("needs the capability \"interface\"");
  teardown();
}
END_TEST

/* A solver that remarks something in each of its 20 windows. */
static const char chatty[] = "import sys\n"
                             "from tandem_participant import Participant\n"
                             "with Participant.from_arguments('dem', 'chatty 1') as p:\n"
                             "    a = p.initialize()\n"
                             "    p.ready(loads=[[0.0] * 6 for _ in a.bodies])\n"
                             "    for step in p.steps():\n"
                             "        p.remark('dust', 'it is dusty', 'warning', 'dem', step.t0)\n"
                             "        p.advance(p.result(step))\n";

START_TEST(remarks_are_told) {
  char options[512];
  setup();
  write_file(dir, "chatty.py", chatty);
  snprintf(options, sizeof options, "--set 'coupling.solvers.dem=" TANDEM_PYTHON " %s/chatty.py' --set coupling.n=100",
           dir);
  setenv("PYTHONPATH", TANDEM_PYTHON_DIR, 1);
  ck_assert_msg(run(options) == 0, "%s", command_output);
  expect_output("dem: it is dusty");
  expect_output("20 times, from t = 0 s to 1.9 s, first at dem");
  teardown();
}
END_TEST

START_TEST(poses) {
  ck_assert_msg(command("env PYTHONPATH=" TANDEM_PYTHON_DIR " " TANDEM_PYTHON " " TANDEM_TESTS_DIR
                        "/protocol/python_poses.py") == 0,
                "%s", command_output);
  expect_output("poses: good");
}
END_TEST

TEST_MAIN("python", dummies_conform, a_run_of_two, with_own_solvers, faults_are_named, remarks_are_told, poses)
