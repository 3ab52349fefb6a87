/* Recorded exchanges, and either solver played from them: the same bits, and a word when the other side does something
 * else. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plate.h"
#include "tests/command.h"
#include "tests/test_main.h"

static const char *dir;

static int run(const char *out, const char *options) {
  return command("tandem run %s/scene.json --out %s/%s --force %s", dir, dir, out, options);
}

static int run_played(const char *out, const char *role, const char *options) {
  char all[512];
  snprintf(all, sizeof all, "--set 'coupling.solvers.%s=tandem-player %s/record.tnd' %s", role, dir, options);
  return run(out, all);
}

static void setup(const char *options) {
  char all[512];
  dir = directory_with_scene(plate_scene);
  snprintf(all, sizeof all, "--record %s/record.tnd %s", dir, options);
  ck_assert_msg(run("live", all) == 0, "%s", command_output);
}

static void teardown(void) {
  expect_nothing_left(dir);
  directory_remove(dir);
}

static void expect_same(const char *name) {
  ck_assert_msg(command("cmp %s/live/%s %s/played/%s", dir, name, dir, name) == 0, "%s", command_output);
}

static const char *const roles[] = {"dem", "mbd"};
static const char *const settings[] = {"", "--set 'coupling.n=\"auto\"'", "--set coupling.scheme=iterative",
                                       "--set output.particles_interval=0.01"};

START_TEST(either_side_is_played) {
  const char *role = roles[_i % 2], *options = settings[_i / 2];
  setup(options);
  ck_assert_msg(run_played("played", role, options) == 0, "%s", command_output);
  ck_assert_ptr_null(strstr(command_output, "not as it was recorded"));
  expect_same("body_plate.csv");
  expect_same("dem.csv");
  expect_same("mbd.csv");
  expect_same("ledger.csv");
  teardown();
}
END_TEST

START_TEST(another_side_is_told) {
  setup("");
  ck_assert_msg(run_played("played", "dem", "--set mbd.forces[0].stiffness=600") == 0, "%s", command_output);
  expect_output("dem.solver");
  expect_output("what the other solver does is not as it was recorded");
  ck_assert_int_eq(command("grep -q '\"replay\"' %s/played/summary.json", dir), 0);
  teardown();
}
END_TEST

START_TEST(other_settings_are_refused) {
  setup("");
  ck_assert_int_eq(run_played("played", "dem", "--set coupling.n=10"), 1);
  expect_output("record the run with the same settings");
  ck_assert_int_eq(run_played("played", "mbd", "--set output.interval=5e-4"), 1);
  expect_output("record the run with the same settings");
  ck_assert_int_eq(run_played("played", "mbd", "--set time.end=0.1"), 1);
  expect_output("the record ends where the server sends STEP");
  ck_assert_int_eq(run_played("played", "mbd", "--set time.end=0.04"), 0); /* a part of it may be played */
  teardown();
}
END_TEST

START_TEST(bad_records) {
  setup("");
  /* in the middle: whose message is the last one depends on time */
  ck_assert_int_eq(command("sh -c 'cd %s && truncate -s $(($(stat -c %%s record.tnd) / 2 + 3)) record.tnd'", dir), 0);
  ck_assert_int_eq(run_played("played", "dem", "--set coupling.timeout=5"), 1);
  expect_output("the record is cut, or damaged");
  write_file(dir, "record.tnd", "nothing");
  ck_assert_int_eq(run_played("played", "dem", "--set coupling.timeout=5"), 1);
  expect_output("is no record of an exchange");
  ck_assert_int_eq(command("rm %s/record.tnd", dir), 0);
  ck_assert_int_eq(run_played("played", "dem", "--set coupling.timeout=5"), 1);
  expect_output("cannot be read");
  ck_assert_int_eq(run("live", "--record /no/such/folder/file"), 1);
  expect_output("cannot be written");
  ck_assert_int_eq(command("tandem-player"), 2);
  expect_output("give one record");
  teardown();
}
END_TEST

START_TEST(a_full_disk_is_told) {
  dir = directory_with_scene(plate_scene);
  ck_assert_int_eq(run("live", "--record /dev/full"), 1);
  expect_output("the record ends before the run does");
  ck_assert(is_there(dir, "live", "body_plate.csv"));
  teardown();
}
END_TEST

TEST_MAIN_ROWS("record", {either_side_is_played, 8}, {another_side_is_told, 1}, {other_settings_are_refused, 1},
               {bad_records, 1}, {a_full_disk_is_told, 1})
