/* What users get wrong: each case must end with exit status 1 or 2 and a message that names place, cause and cure. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/version.h"
#include "tests/command.h"
#include "tests/test_main.h"

static const char *dir;

/* The collision scenario's scene with overrides. */
static int run(const char *options) {
  return command("tandem run " TANDEM_SOURCE_DIR
                 "/scenarios/collision/scene.json --out %s/out --force --set time.end=1e-4 %s",
                 dir, options);
}

static const struct {
  const char *options, *path, *words;
} cases[] = {
    /* the server's own sections */
    {"--set coupling.n=0", "coupling.n", "at least 1"},
    {"--set coupling.n=1.5", "coupling.n", "whole number"},
    {"--set coupling.n=many", "coupling.n", "neither a whole number of DEM steps nor \"auto\""},
    {"--set coupling.shceme=hold", "coupling.shceme", "did you mean \"scheme\""},
    {"--set coupling.scheme=lomen", "coupling.scheme", "did you mean \"lommen\""},
    {"--set coupling.transport=pigeon", "coupling.transport", "\"ipc\", \"tcp\", \"inproc\""},
    {"--set coupling.timeout=0", "coupling.timeout", "greater than 0"},
    {"--set coupling.timeout=0.2", "coupling.timeout", "at least 1"},
    {"--set coupling.transport=tcp --set coupling.address=tcp://10.0.0.1:5555", "coupling.address",
     "no address on this machine"},
    {"--set coupling.transport=tcp --set coupling.address=tcp://127.0.0.1:99999", "coupling.address",
     "no address on this machine"},
    {"--set coupling.address=tcp://127.0.0.1:5555", "coupling.address", "goes with"},
    {"--set coupling.solvers.dem=null", "coupling.solvers.dem", "started by hand"},
    {"--set coupling.solvers.dem=/tmp", "coupling.solvers.dem", "neither beside this program"},
    {"--set time.dt=-1", "time.dt", "greater than 0"},
    {"--set time.dt=1", "time.dt", "longer than the whole run"},
    {"--set time.dt=1e-30", "time.dt", "larger step"},
    {"--set time.end=NaN", "time.end", "must be a number, not a string"},
    {"--set tiem.end=1", "tiem", "did you mean \"time\""},
    {"--set output.interval=1e-9", "output.interval", "shorter than a DEM step"},
    {"--set output.interval=0", "output.interval", "greater than 0"},
    {"--set 'coupling.bodies[1]={\"mbd\":\"cube2\",\"dem\":\"cube\"}'", "coupling.bodies[1].dem", "coupled twice"},
    {"--set 'coupling.bodies[1]={\"mbd\":\"cube\",\"dem\":\"other\"}'", "coupling.bodies[1].mbd", "coupled twice"},
    {"--set 'coupling.bodies[0].mbd=../x'", "coupling.bodies[0].mbd", "does not fit a file name"},
    {"--set coupling.bodies=3", "coupling.bodies", "must be an array"},
    /* the solvers' sections: the path is theirs, the place the server's */
    {"--set coupling.bodies[0].mbd=cub", "coupling.bodies[0].mbd", "cube"},
    {"--set coupling.bodies[0].dem=kube", "coupling.bodies[0].dem", "cube"},
    {"--set mbd.bodies[0].mass=-1", "mbd.bodies[0].mass", "greater than 0"},
    {"--set mbd.bodies[0].mas=1", "mbd.bodies[0].mas", "did you mean \"mass\""},
    {"--set mbd.joints[0].type=prismtic", "mbd.joints[0].type", "prismatic"},
    {"--set dem.particles[0].mass=-1", "dem.particles[0].mass", "greater than 0"},
    {"--set dem.particles[0].radius=0", "dem.particles[0].radius", "greater than 0"},
    {"--set dem.particles[0].radius=NaN", "dem.particles[0].radius", "must be"},
    {"--set dem.materials[0].densty=1", "dem.materials[0].densty", "did you mean \"density\""},
    {"--set dem.materials[0].density=-2500", "dem.materials[0].density", "greater than 0"},
    {"--set dem.pairs=[]", "dem.pairs", "soft"},
    {"--set dem.settle.speed=1 --set dem.settle.store=/dev/zero", "dem.settle.store", "a device or a pipe"},
    {"--set dem.start=/dev/zero", "dem.start", "a device or a pipe"},
    {"--set time.dt=9e-5 --set output.interval=1e-4 --set dem.materials[0].young_modulus=5e11", "time.dt",
     "half of the shortest contact"},
    {"--set time.dt=9e-5 --set output.interval=1e-4 --set dem.materials[0].young_modulus=5e11 --set "
     "dem.guard.action=warn --strict",
     "time.dt", "strict"},
};
enum { NCASE = sizeof cases / sizeof cases[0] };

START_TEST(values_of_the_scene) {
  dir = directory_make();
  for (int i = 0; i < NCASE; i++) {
    int status = run(cases[i].options);
    ck_assert_msg(status == 1, "%s: exit status %d: %s", cases[i].options, status, command_output);
    char path[256];
    snprintf(path, sizeof path, ": %s: ", cases[i].path);
    ck_assert_msg(strstr(command_output, path) && strstr(command_output, cases[i].words) &&
                      strstr(command_output, "collision/scene.json:"),
                  "%s: expected place, \"%s\" and \"%s\" in: %s", cases[i].options, path, cases[i].words,
                  command_output);
  }
  expect_nothing_left(dir);
  directory_remove(dir);
}
END_TEST

START_TEST(a_step_above_the_limit_warns) {
  dir = directory_make();
  int status = run("--set time.dt=9e-5 --set output.interval=1e-4 --set dem.materials[0].young_modulus=5e11 --set "
                   "dem.guard.action=warn");
  expect_output("tandem: warning: ");
  expect_output("time.dt");
  ck_assert_msg(status == 0 || strstr(command_output, "not finite"), "%d: %s", status, command_output);
  directory_remove(dir);
}
END_TEST

START_TEST(files) {
  dir = directory_make();
  ck_assert_int_eq(command("tandem run %s/nothing.json --out %s/out", dir, dir), 1);
  expect_output("nothing.json: cannot be opened");
  write_file(dir, "cut.json", "{\"time\": {\"end\": 1,");
  ck_assert_int_eq(command("tandem run %s/cut.json --out %s/out", dir, dir), 1);
  expect_output("cut.json:1:");
  expect_output("not valid JSON");
  write_file(dir, "text.json", "time.end = 1\n");
  ck_assert_int_eq(command("tandem run %s/text.json --out %s/out", dir, dir), 1);
  expect_output("not valid JSON");
  write_file(dir, "twice.json", "{\"time\": {},\n \"time\": {}}");
  ck_assert_int_eq(command("tandem run %s/twice.json --out %s/out", dir, dir), 1);
  expect_output("twice.json:2:");
  expect_output("duplicate");
  ck_assert_int_eq(command("tandem run /dev/zero --out %s/out", dir), 1);
  expect_output("a byte of value 0");
  ck_assert_int_eq(command("tandem run %s --out %s/out", dir, dir), 1);
  expect_output("it is a folder");
  write_file(dir, "empty.json", "{}");
  ck_assert_int_eq(command("tandem run %s/empty.json --out %s/out", dir, dir), 1);
  expect_output("time: missing");
  directory_remove(dir);
}
END_TEST

START_TEST(result_directories) {
  dir = directory_make();
  write_file(dir, "file", "in the way");
  ck_assert_int_eq(command("tandem run collision --scenarios " TANDEM_SOURCE_DIR "/scenarios --out %s/file/out", dir),
                   1);
  expect_output("cannot be");
  expect_output("--out");
  ck_assert_int_eq(command("tandem run collision --scenarios " TANDEM_SOURCE_DIR "/scenarios --out /proc/out"), 1);
  expect_output("/proc/out");
  ck_assert_int_eq(command("tandem verify collision --json %s/file/x.json --out %s/v", dir, dir), 1);
  expect_output("cannot be written");
  directory_remove(dir);
}
END_TEST

/* A scene of n coupled bodies, as text for the scene that is asked about. */
static void write_many(const char *name, int n) {
  char path[256];
  snprintf(path, sizeof path, "%s/%s", dir, name);
  FILE *f = fopen(path, "w");
  ck_assert_ptr_nonnull(f);
  fputs("{\"time\": {\"end\": 0.001, \"dt\": 1e-4}, \"coupling\": {\"n\": 1, \"bodies\": [", f);
  for (int i = 0; i < n; i++)
    fprintf(f, "%s{\"mbd\": \"b%d\", \"dem\": \"d%d\"}", i ? "," : "", i, i);
  fputs("]},\n \"mbd\": {\"bodies\": [", f);
  for (int i = 0; i < n; i++)
    fprintf(f, "%s{\"name\": \"b%d\", \"mass\": 1, \"inertia\": [1, 1, 1], \"position\": [%d, 0, 0]}", i ? "," : "", i,
            2 * i);
  fputs("]},\n \"dem\": {}}\n", f);
  fclose(f);
}

START_TEST(more_bodies_than_a_message_holds) {
  dir = directory_make();
  write_many("many.json", 600);
  ck_assert_int_eq(command("tandem run %s/many.json --out %s/out", dir, dir), 1);
  expect_output("many.json:1:");
  expect_output("coupling.bodies: has 600 entries, but the scheme proxy sends");
  expect_output("has room for 468");
  expect_output("take dem-first, lommen or hold as coupling.scheme");
  write_many("many.json", 40000);
  ck_assert_int_eq(command("tandem run %s/many.json --out %s/out --set coupling.scheme=lommen", dir, dir), 1);
  expect_output("coupling.bodies: has 40000 entries; at most 10000 bodies can be coupled");
  directory_remove(dir);
}
END_TEST

START_TEST(command_lines) {
  ck_assert_int_eq(command("tandem"), 2);
  expect_output("tandem run SCENE");
  ck_assert_int_eq(command("tandem rum x"), 2);
  expect_output("did you mean run");
  ck_assert_int_eq(command("tandem run"), 2);
  expect_output("name one scene");
  ck_assert_int_eq(command("tandem run a b"), 2);
  ck_assert_int_eq(command("tandem run a --ouut x"), 2);
  expect_output("did you mean --out");
  ck_assert_int_eq(command("tandem run a --out"), 2);
  expect_output("--out needs a value");
  ck_assert_int_eq(command("tandem run collision --scenarios " TANDEM_SOURCE_DIR "/scenarios --set coupling.n"), 2);
  expect_output("PATH=VALUE");
  /* scenes that are not called scene.json */
  ck_assert_int_eq(command("tandem check tumbler/two_deck.json --scenarios " TANDEM_SOURCE_DIR "/scenarios"), 0);
  ck_assert_int_eq(command("tandem check tumbler/no_deck.json --scenarios " TANDEM_SOURCE_DIR "/scenarios"), 1);
  expect_output("tumbler/no_deck.json: cannot be opened");
  ck_assert_int_eq(command("tandem run no_such_scenario"), 1);
  expect_output("neither a scene file nor a scenario");
  ck_assert_int_eq(command("tandem run andrews"), 1);
  expect_output("run it with: tandem-mbd run andrews");
  ck_assert_int_eq(command("tandem-dem check spring_damper"), 1);
  expect_output("run it with: tandem run spring_damper");
  ck_assert_int_eq(command("tandem check " TANDEM_SOURCE_DIR "/scenarios/mbd/fourbar_a02/scene.json"), 1);
  expect_output("bodies alone are for tandem-mbd run and tandem-mbd check");
  ck_assert_int_eq(command("tandem verify colision"), 2);
  expect_output("did you mean \"collision\"");
  ck_assert_int_eq(command("tandem --help"), 0);
  expect_output("spring_damper");
  ck_assert_int_eq(command("tandem --version"), 0);
  expect_output(TDM_VERSION);
}
END_TEST

TEST_MAIN("bad input", values_of_the_scene, a_step_above_the_limit_warns, files, result_directories, command_lines,
          more_bodies_than_a_message_holds)
