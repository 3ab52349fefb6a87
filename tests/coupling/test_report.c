/* The report of a run: by body, joint and scheme, with names and units on its axes, what does not change in a table,
 * warnings on top; for runs of both solvers and of one, whole, failed and damaged. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/contents/words.h"
#include "tests/command.h"
#include "tests/test_main.h"

#define SCENES TANDEM_SOURCE_DIR "/tests/healthy/scenes"

static const char *dir;

/* A shell script in the test's directory. */
static int script(const char *text) {
  write_file(dir, "script", text);
  return command("sh -c 'cd %s && sh ./script'", dir);
}

#define expect_script(status, text)                                           \
  do {                                                                        \
    const int got = script(text);                                             \
    ck_assert_msg(got == status, "%d of: %s\n%s", got, text, command_output); \
  } while (0)

START_TEST(what_channels_are_called) {
  static const struct {
    const char *name, *unit, *quantity, *component;
    bool vector;
  } cases[] = {
      {"x", "m", "position", "x", true},
      {"qw", "1", "orientation (quaternion)", "w", true},
      {"wz", "rad/s", "angular velocity", "z", true},
      {"ax", "m/s2", "acceleration", "x", true},
      {"alphay", "rad/s2", "angular acceleration", "y", true},
      {"com.z", "m", "centre of mass", "z", true},
      {"flow.x", "kg/s", "flow", "x", true}, /* of another solver */
      {"vw", "m/s", "vw", "vw", false},
      {"max", "N", "max", "max", false},
      {"rate", "rad/s", "angular velocity", "rate", false},
      {"value", "N m", "torque", "value", false},
      {"kinetic_energy", "J", "energy", "kinetic energy", false},
      {"", "", "", "", false},
  };
  char unit[16];
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    const cpl_words w = cpl_words_of(cases[i].name, cases[i].unit);
    ck_assert_str_eq(w.quantity, cases[i].quantity);
    ck_assert_str_eq(w.component, cases[i].component);
    ck_assert_int_eq(w.vector, cases[i].vector);
  }
  ck_assert_str_eq(cpl_words_unit("rad/s2", unit, sizeof unit), "rad/s\u00b2");
  ck_assert_str_eq(cpl_words_unit("1", unit, sizeof unit), "-");
  ck_assert_str_eq(cpl_words_unit("N m", unit, sizeof unit), "N m");
}
END_TEST

START_TEST(a_coupled_run) {
  dir = directory_make();
  expect_script(0, "tandem run " SCENES "/tip.json --out out --set time.end=0.1 && tandem report out");
  /* the index, by body, joint, driver and scheme */
  expect_script(0, "for t in '>Bodies<' '>Joints<' '>Drivers<' '>Particles<' '>Exchange<' '>bucket</a>' '>axle</a>' "
                   "'body bucket</h3>' 'joint axle</h3>' '>energy ledger</a>'; do grep -q \"$t\" out/index.html || "
                   "{ echo no $t; exit 1; }; done");
  /* axes have names and units, plots no channel that does not change */
  expect_script(0, "for t in 'angular velocity .rad/s.' 'reaction force .N.' 'angle .rad.' 'torque .N m.'; do "
                   "grep -q \"set ylabel .$t\" out/report.gp || { echo no $t; exit 1; }; done");
  expect_script(0, "grep -A1000 'id=.constants' out/index.html | grep -q 'body.bucket.y<'");
  expect_script(1, "grep -B1000 'id=.constants' out/index.html | grep -q 'body.bucket.y<'");
  /* no picture has more than eight panels */
  expect_script(0, "awk '/^set output/{n=0; pictures++} /^plot/{if (++n > 8) exit 1} "
                   "END{exit pictures < 5}' out/report.gp");
  expect_script(0, "n=$(grep -c '^set output .*png' out/report.gp) && test $n = $(ls out/report_*.png | wc -l)");
  /* every link of the page is there, also after a move */
  expect_script(0, "mv out moved; cd moved && for f in $(grep -o '\\(src\\|href\\)=\"[^#\"]*' index.html | cut -d'\"' "
                   "-f2); do test -e \"$f\" || { echo no $f; exit 1; }; done");
  directory_remove(dir);
}
END_TEST

START_TEST(runs_of_one_solver) {
  dir = directory_make();
  expect_script(0, "tandem-mbd run " SCENES "/hoist.json --out mbd --no-plots && tandem report mbd");
  expect_script(0, "for t in 'joint beam</h3>' 'driver drive</h3>' 'force cable</h3>' 'body load</h3>' "
                   "'mechanism as a whole' 'tandem-mbd'; do grep -q \"$t\" mbd/index.html || "
                   "{ echo no $t; exit 1; }; done");
  expect_script(0, "tandem-dem run " SCENES "/heap.json --out dem --no-plots --set time.end=0.1 --set "
                   "'output.pictures={\"times\": [0, 0.1]}' && tandem report dem");
  expect_script(0, "for t in 'particles as a whole' 'source pour' 'sink spilt' 'picture_000.png' 'picture_001.png' "
                   "'tandem-dem'; do grep -q \"$t\" dem/index.html || { echo no $t; exit 1; }; done");
  /* views and an animation, when they are there */
  expect_script(
      0, "cd dem && touch picture_side_000.png picture_side_001.png picture_x.png movie.mp4 view.html && tandem "
         "report . && for t in 'src=.picture_side_001.png' 'src=.movie.mp4' 'href=.view.html'; do grep -q \"$t\" "
         "index.html || { echo no $t; exit 1; }; done");
  expect_script(1, "grep -q 'src=.picture_x' dem/index.html");
  /* those of an earlier report that are no longer made go with a new run */
  expect_script(0, "tandem-mbd run " SCENES "/slope.json --out dem --no-plots --force");
  expect_script(1, "ls dem | grep 'report\\|index'");
  directory_remove(dir);
}
END_TEST

START_TEST(warnings_stand_first) {
  dir = directory_make();
  expect_script(0, "tandem run " SCENES "/press.json --out out --set mbd.drivers[0].motion.to=-0.048 && "
                   "tandem report out");
  expect_output("overlaps");
  expect_script(0, "sed -n '1,/id=.run/p' out/index.html | grep 'overlaps.*times, from t = '");
  directory_remove(dir);
}
END_TEST

START_TEST(without_gnuplot_there_are_numbers) {
  dir = directory_make();
  expect_script(0, "tandem-mbd run " SCENES "/hoist.json --out out --no-plots");
  expect_script(0, "t=$(which tandem); PATH=/nowhere $t report out");
  expect_output("gnuplot is not installed");
  expect_script(0, "grep -q 'gnuplot is not installed' out/index.html && grep -q '<details open>' out/index.html && "
                   "grep -q 'force.cable.value' out/index.html");
  expect_script(1, "grep -q '<img' out/index.html || ls out | grep 'png\\|gnuplot'");
  directory_remove(dir);
}
END_TEST

START_TEST(a_run_that_failed_half_way) {
  dir = directory_make();
  expect_script(1, "tandem run " SCENES "/box_on_spring.json --out out --set 'coupling.scheme=\"lommen\"' --set "
                   "coupling.n=1000 --set mbd.bodies[0].mass=0.1");
  expect_script(0, "tandem report out");
  expect_output("the run failed: ");
  expect_output("energy without a source");
  expect_script(0, "sed -n '1,/id=.run/p' out/index.html > top; grep -q 'did not come to its end' top && grep -q "
                   "'energy without a source' top && grep -q 'The end of .*dem.log' top");
  expect_script(0, "ls out/report_*.png && grep -q 'body box</h3>' out/index.html");
  /* refused at its start: nothing but the reason */
  expect_script(1, "tandem-dem run " SCENES "/bed.json --out none --set time.dt=2e-3");
  expect_script(0, "tandem report none && grep -q 'more than half of the shortest contact' none/index.html");
  directory_remove(dir);
}
END_TEST

START_TEST(no_result_directory) {
  dir = directory_make();
  expect_script(1, "mkdir empty && tandem report empty");
  expect_output("holds no results of a run");
  expect_script(1, "mkdir other && touch other/index.html other/x.csv && tandem report other");
  expect_output("holds no results of a run");
  expect_script(1, "test -s other/index.html");
  expect_script(1, "mkdir scene && cp " SCENES "/tip.json scene/scene.json && tandem report scene");
  expect_output("holds no results of a run");
  expect_script(1, "tandem report nowhere");
  expect_output("No such file");
  expect_script(1, "tandem report script");
  expect_output("Not a directory");
  directory_remove(dir);
}
END_TEST

START_TEST(damaged_files) {
  dir = directory_make();
  expect_script(0, "tandem run " SCENES "/tip.json --out out --set time.end=0.05");
  /* cut off in a line */
  expect_script(0, "head -c $(($(stat -c %s out/mbd.csv) - 37)) out/mbd.csv > cut && mv cut out/mbd.csv && "
                   "tandem report out && grep -q 'joint axle</h3>' out/index.html");
  /* no numbers, no rows, nothing: the others are shown, and the page says what is missing */
  expect_script(0, "sed -i '3s/.*/rubbish/' out/dem.csv; head -1 out/ledger.csv > head && mv head out/ledger.csv; "
                   ": > out/body_bucket.csv; tandem report out");
  expect_output("dem.csv:3: not a row of numbers");
  expect_script(0, "grep -q 'dem.csv:3: not a row' out/index.html && grep -q 'joint axle</h3>' out/index.html");
  /* numbers that gnuplot could stumble over */
  expect_script(0,
                "printf 'time [s],joint.a.fx [N],joint.b.fx [N],c [1],d [1]\\n0,nan,1e308,0,5\\n1,nan,-1e308,inf,5\\n"
                "2,nan,0,1,5\\n' > out/mbd.csv && tandem report out && test -s out/index.html");
  expect_script(0, "rm out/scene.json && tandem report out && grep -q 'no scene' out/index.html");
  expect_script(
      0, "tandem run " SCENES "/tip.json --out whole --set time.end=0.02 && rm whole/scene.json && tandem report "
         "whole && grep -q 'body bucket</h3>' whole/index.html && grep -q 'exchange: bucket' whole/index.html");
  expect_script(0, "echo '[1]' > out/summary.json && tandem report out");
  expect_output("no figures of the run");
  directory_remove(dir);
}
END_TEST

TEST_MAIN("report", what_channels_are_called, a_coupled_run, runs_of_one_solver, warnings_stand_first,
          without_gnuplot_there_are_numbers, a_run_that_failed_half_way, no_result_directory, damaged_files)
