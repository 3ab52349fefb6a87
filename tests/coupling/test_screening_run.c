/* Runs that measure screening, as a user sees them: histories with gaps, summary.json, the table at the end, the report
 * with paths, of DEM alone and of a mechanism. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/command.h"
#include "tests/result_table.h"
#include "tests/test_main.h"

#include <jansson.h>
#include <math.h>

/* Five grains fly through outlets, one stays; a deck moves to and fro below them. M: mass of the larger, eight times
 * that of the smaller. */
#define SINK(name, low, high) "{'name':'" name "','type':'box','min':[1," low ",-1],'max':[2," high ",1]}"
#define GRAIN(radius, x, y, vy) \
  "{'type':'list','material':'g','radius':" radius ",'positions':[[" x "," y ",0]],'velocity':[1," vy ",0]}"
#define DEM                                                                                                            \
  "'dem':{'gravity':[0,0,0],'materials':[{'name':'g','density':1000,'young_modulus':1e3,'poisson_ratio':0.3}],"        \
  "'pairs':[{'materials':['g','g'],'restitution':0.5,'friction':0}],'sinks':[" SINK("a", "-0.5", "0.5") "," SINK(      \
      "b", "0.5",                                                                                                      \
      "1.5") "],'particles':[" GRAIN("0.02", "0.8995", "0",                                                            \
                                     "0") "," GRAIN("0.01", "0.7995", "0.2",                                           \
                                                    "0") "," GRAIN("0.02", "0.6995", "-0.2",                           \
                                                                   "-0.5") "," GRAIN("0.02", "0.4995", "1",            \
                                                                                     "0") "," GRAIN("0.01", "-0.5",    \
                                                                                                    "1",               \
                                                                                                    "0") "],'bodies':" \
                                                                                                         "[{'name':'"  \
                                                                                                         "deck','"     \
                                                                                                         "material':'" \
                                                                                                         "g',"         \
                                                                                                         "'shapes':[{" \
                                                                                                         "'type':'"    \
                                                                                                         "screen','"   \
                                                                                                         "deck':'"     \
                                                                                                         "plate','"    \
                                                                                                         "hole':0.02," \
                                                                                                         "'bar':0.01," \
                                                                                                         "'radius':0." \
                                                                                                         "2,'center':" \
                                                                                                         "[0,0,-1]}]}" \
                                                                                                         "],"          \
                                                                                                         "'screening'" \
                                                                                                         ":{'decks':[" \
                                                                                                         "{'name':'"   \
                                                                                                         "top','"      \
                                                                                                         "outlets':['" \
                                                                                                         "a'],'"       \
                                                                                                         "sorted':0."  \
                                                                                                         "02,'screen'" \
                                                                                                         ":{'body':'"  \
                                                                                                         "deck'}},{'"  \
                                                                                                         "name':'low'" \
                                                                                                         ","           \
                                                                                                         "'outlets':[" \
                                                                                                         "'b']}]},'"   \
                                                                                                         "paths':[{'"  \
                                                                                                         "name':'p','" \
                                                                                                         "particle':"  \
                                                                                                         "2,'body':'"  \
                                                                                                         "deck'}]}"
#define TIME "'time':{'end':0.7,'dt':1e-3},'output':{'interval':0.05}"

static const char alone[] = "{" TIME "," DEM "}";
static const char coupled[] =
    "{" TIME ",'coupling':{'n':1,'bodies':[{'mbd':'deck','dem':'deck'}]},'mbd':{'gravity':[0,0,0],'bodies':[{'name':"
    "'deck','mass':1,'inertia':[1,1,1],'position':[0,0,0],'angular_velocity':[0,0,2]}],'joints':[{'name':'axle','type':"
    "'revolute',"
    "'bodies':['ground','deck'],'point':[0,0,0],'axis':[0,0,1]}]}," DEM "}";

static void expect_histories(const char *dir, const char *file, bool turns) {
  cpl_table t;
  read_table(&t, dir, file);
  ck_assert_int_eq(t.nrow, 15);
  const double *time = column(&t, "time"), *top = column(&t, "screening.top.efficiency");
  const double *low = column(&t, "screening.low.efficiency"), *all = column(&t, "screening.efficiency");
  const double *fed = column(&t, "screening.fed"), *inside = column(&t, "screening.inside");
  const double *out = column(&t, "screening.out"), *x = column(&t, "path.p.x"), *y = column(&t, "path.p.y");
  for (int i = 0; i < t.nrow; i++) {
    const double at = time[i], turned = turns ? 2 * at : 0;
    const double expected = at < 0.101 ? NAN : at < 0.201 ? 100 : at < 0.301 ? 50 : 200.0 / 3;
    ck_assert(isnan(expected) ? isnan(top[i]) : fabs(top[i] - expected) < 1e-9);
    ck_assert(at < 0.501 ? isnan(low[i]) && isnan(all[i]) : low[i] == 100 && fabs(all[i] - 250.0 / 3) < 1e-9);
    ck_assert(fed[i] == 5 && inside[i] + out[i] == 5);
    ck_assert(isnan(x[i]) == (at > 0.301 - 1e-9));
    const double along = 0.6995 + at, across = -0.2 - 0.5 * at;
    if (!isnan(x[i])) {
      ck_assert(fabs(x[i] - (cos(turned) * along + across * sin(turned))) < 1e-6);
      ck_assert(fabs(y[i] - (-sin(turned) * along + across * cos(turned))) < 1e-6);
    }
  }
  cpl_table_free(&t);
  char path[512];
  snprintf(path, sizeof path, "grep -q -e -nan %s/%s", dir, file);
  ck_assert_int_eq(command("%s", path), 1); /* gaps have no sign */
}

static const json_t *value(const json_t *json, const char *a, const char *b, const char *c) {
  const json_t *at = json_object_get(json, a);
  at = b ? json_object_get(at, b) : at;
  return c ? json_object_get(at, c) : at;
}

/* `early`: until 0.4 s, when the lower deck has given nothing yet */
static void expect_summary(const char *dir, bool early) {
  char path[512];
  snprintf(path, sizeof path, "%s/summary.json", dir);
  json_t *summary = json_load_file(path, 0, NULL);
  const json_t *s = json_object_get(summary, "screening");
  ck_assert_int_eq(json_integer_value(value(s, "decks", "top", "sorted")), 2);
  ck_assert_int_eq(json_integer_value(value(s, "decks", "top", "undersized")), 1);
  ck_assert(fabs(json_real_value(value(s, "decks", "top", "efficiency_mass")) - 100 * 16.0 / 17) < 1e-9);
  ck_assert_int_eq(json_integer_value(value(s, "decks", "top", "blocked_most")), 0);
  ck_assert(json_is_null(value(s, "decks", "low", "efficiency")) == early);
  ck_assert(json_is_null(value(s, "efficiency", NULL, NULL)) == early);
  ck_assert_int_eq(json_integer_value(value(s, "fed", NULL, NULL)), 5);
  ck_assert_int_eq(json_integer_value(value(s, "inside", NULL, NULL)), early ? 2 : 1);
  ck_assert_int_eq(json_integer_value(value(s, "lost", NULL, NULL)), 0);
  json_decref(summary);
}

/* both programs on a scene: at 0.7 s, at 0.4 s, on two threads */
static void look(const char *scene, const char *program, const char *file, bool turns) {
  const char *dir = directory_with_scene(scene);
  char out[256];
  ck_assert_msg(command("%s run %s/scene.json --out %s/a", program, dir, dir) == 0, "%s", command_output);
  expect_output("5 particles fed, 1 inside, 0 lost; efficiency 83.33 % by number, 97.06 % by mass");
  expect_output("top                       2          1        66.67        94.12");
  expect_output("low                       1          0       100.00       100.00");
  snprintf(out, sizeof out, "%s/a", dir);
  expect_histories(out, file, turns);
  expect_summary(out, false);
  ck_assert_msg(command("%s run %s/scene.json --out %s/b --set dem.threads=2", program, dir, dir) == 0, "%s",
                command_output);
  ck_assert_int_eq(command("cmp %s/a/%s %s/b/%s", dir, file, dir, file), 0);
  ck_assert_msg(command("%s run %s/scene.json --out %s/c --set time.end=0.4", program, dir, dir) == 0, "%s",
                command_output);
  expect_output("efficiency - % by number, - % by mass");
  snprintf(out, sizeof out, "%s/c", dir);
  expect_summary(out, true);

  /* the report: a heading each, gaps are no numbers, the path in its plane */
  ck_assert_msg(command("tandem report %s/a", dir) == 0, "%s", command_output);
  static const char *const words[] = {"screening: top", "screening: low", "screening: all decks", "path p"};
  for (int k = 0; k < 4; k++)
    ck_assert_msg(command("grep -q '%s' %s/a/index.html", words[k], dir) == 0, "no %s", words[k]);
  ck_assert_int_eq(command("grep -q 'x \\[m\\]' %s/a/report.gp", dir), 0);
  ck_assert_int_eq(command("grep -q 'particles that left' %s/a/report.gp", dir), 0);
  ck_assert_int_eq(command("grep -q -i 'nan' %s/a/index.html", dir), 1);
  ck_assert_msg(command("sh -c 'ls %s/a/report_*_path_p.png && ! ls %s/a/*.gnuplot'", dir, dir) == 0, "%s",
                command_output);
  directory_remove(dir);
}

START_TEST(particles_alone) {
  look(alone, "tandem-dem", "channels.csv", false);
}
END_TEST

START_TEST(with_a_mechanism) {
  look(coupled, "tandem", "dem.csv", true);
}
END_TEST

/* ---- options of the tumbler screening machine ---- */

#define FIVE_DECK "tumbler/five_deck.json --scenarios " TANDEM_SOURCE_DIR "/scenarios "

/* Each option is a scene without doubts, with the particles that it says; all of the grain is the product, balls are
 * not, and each deck's screen is the one that is watched, whatever other shapes there are. */
static const struct {
  const char *set, *fill; /* particles at the start */
  int fed;                /* of these and of the source, 0.02 s later */
} options[] = {
    {"", "0", 3},
    {"--set parameters.batch=1", "3483", 3483},
    {"--set parameters.feeder=1", "3483", 3483},
    {"--set parameters.feeder=1 --set parameters.nozzle=0.03 --set parameters.count=500", "500", 500},
    {"--set parameters.balls=40", "160", 3},
    {"--set parameters.balls=40 --set parameters.deck_kind=1 --set parameters.lower_radius=0.6", "160", 3},
    {"--set parameters.lower_radius=0.9 --set parameters.batch=1", "3483", 3483},
    {"--set parameters.deflector=0.15", "0", 3},
};

START_TEST(options_of_the_tumbler) {
  const char *dir = directory_with_scene("{}");
  char file[512], text[128];
  ck_assert_msg(command("tandem check " FIVE_DECK "%s", options[_i].set) == 0, "%s", command_output);
  snprintf(text, sizeof text, "fill.number                  %s\n", options[_i].fill);
  expect_output(text);
  expect_output("\n0 warnings");
  ck_assert_msg(command("tandem run " FIVE_DECK "%s --set parameters.end=0.02 --out %s/a", options[_i].set, dir) == 0,
                "%s", command_output);
  snprintf(file, sizeof file, "%s/a/summary.json", dir);
  json_t *summary = json_load_file(file, 0, NULL);
  const json_t *s = json_object_get(summary, "screening");
  ck_assert_int_eq(json_integer_value(value(s, "fed", NULL, NULL)), options[_i].fed);
  ck_assert_int_eq(json_integer_value(value(s, "inside", NULL, NULL)), options[_i].fed);
  ck_assert_int_eq(json_integer_value(value(s, "decks", "deck2", "blocked_most")), 0);
  ck_assert_int_eq(json_object_get(summary, "containers") != NULL, strstr(options[_i].set, "feeder") != NULL);
  json_decref(summary);
  cpl_table t;
  snprintf(file, sizeof file, "%s/a", dir);
  read_table(&t, file, "dem.csv");
  ck_assert(isfinite(column(&t, "path.followed.x")[t.nrow - 1])); /* the first grain, in the barrel's axes */
  ck_assert_double_lt(fabs(column(&t, "path.followed.x")[t.nrow - 1]), 0.6);
  cpl_table_free(&t);
  directory_remove(dir);
}
END_TEST

TEST_MAIN_ROWS("runs that measure screening", {particles_alone, 1}, {with_a_mechanism, 1},
               {options_of_the_tumbler, SOME_ROWS(sizeof options / sizeof *options)})
