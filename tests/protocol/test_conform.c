/* tandem conform: own solvers keep the rules; a lie that looks right breaks the one that it is about. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plate.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <jansson.h>

static const char *dir;

/* An arm on a hinge, that swings and tumbles a box on a ball joint at its tip: all of the reduced model changes. */
static const char arm_scene[] =
    "{'time':{'end':0.3,'dt':1e-4},'coupling':{'n':5,'bodies':[{'mbd':'arm','dem':'arm'},{'mbd':'box','dem':'box'}]},\n"
    "'mbd':{'bodies':[{'name':'arm','mass':2,'inertia':[0.1,0.2,0.3],'position':[0.5,0,0],'velocity':[0,0,-1],\n"
    "'angular_velocity':[0,2,0]},{'name':'box','mass':1,'inertia':[0.02,0.03,0.01],'position':[1.2,0,0],\n"
    "'velocity':[0,0,-2],'angular_velocity':[1,0,3]}],\n"
    "'joints':[{'name':'hinge','type':'revolute','bodies':['ground','arm'],'point':[0,0,0],'axis':[0,1,0]},\n"
    "{'name':'ball','type':'spherical','bodies':['arm','box'],'point':[1,0,0]}]},'dem':{}}\n";

/* A deck that a motor shakes, and a plate on a spring on it: the path ahead takes nodes. */
static const char shaken_scene[] =
    "{'time':{'end':0.1,'dt':1e-4},'coupling':{'n':5,'bodies':[{'mbd':'deck','dem':'deck'},"
    "{'mbd':'plate','dem':'plate'}]},\n"
    "'mbd':{'bodies':[{'name':'deck','mass':20,'inertia':[1,1,1],'position':[0,0,0]},\n"
    "{'name':'plate','mass':2,'inertia':[0.1,0.1,0.1],'position':[0.5,0,0]}],\n"
    "'joints':[{'name':'hinge','type':'revolute','bodies':['ground','deck'],'point':[0,0,0],'axis':[0,1,0]},\n"
    "{'name':'slide','type':'prismatic','bodies':['deck','plate'],'point':[0.5,0,0],'axis':[0,0,1]}],\n"
    "'drivers':[{'name':'shake','type':'rotational_motor','joint':'hinge','motion':{'type':'harmonic',"
    "'amplitude':0.01,'frequency':40}}],\n"
    "'forces':[{'name':'spring','type':'spring_damper','bodies':['deck','plate'],'points':[[0.5,0,-1],[0.5,0,0]],\n"
    "'stiffness':2000,'damping':1}]},'dem':{}}\n";

/* nothing holds the plate */
static const char without_spring[] = "--set 'mbd.joints=[]' --set 'mbd.forces=[]'";

static void setup(void) {
  dir = directory_with_scene(plate_scene);
}

static void teardown(void) {
  expect_nothing_left(dir);
  directory_remove(dir);
}

/* Test a solver under a scene; its exit status. */
static int conform(const char *words) {
  return command("tandem conform %s/scene.json --json %s/report.json %s", dir, dir, words);
}

/* The verdict on a rule, from the report. */
static const char *verdict(const char *rule) {
  static char text[32];
  char path[128];
  snprintf(path, sizeof path, "%s/report.json", dir);
  json_t *report = json_load_file(path, 0, NULL), *row;
  size_t i;
  snprintf(text, sizeof text, "no such rule");
  json_array_foreach(json_object_get(report, "rules"), i, row) {
    const char *name = json_string_value(json_object_get(row, "name"));
    if (name && strcmp(name, rule) == 0)
      snprintf(text, sizeof text, "%s", json_string_value(json_object_get(row, "verdict")));
  }
  json_decref(report);
  return text;
}

START_TEST(own_solvers_conform) {
  setup();
  ck_assert_msg(conform("-- tandem-mbd") == 0, "%s", command_output);
  expect_output("0 broken, 2 not claimed");
  ck_assert_str_eq(verdict("mobility"), "kept");
  ck_assert_msg(conform("--role dem -- tandem-dem") == 0, "%s", command_output);
  expect_output("0 broken, 2 not claimed, 0 not seen");
  teardown();
}
END_TEST

/* two bodies, whose places and numbers are not to be mixed up */
static const char second_plate[] =
    "--set 'coupling.bodies=[{\"mbd\":\"plate\",\"dem\":\"plate\"},{\"mbd\":\"other\",\"dem\":\"other\"}]' "
    "--set 'mbd.bodies=[{\"name\":\"plate\",\"mass\":2,\"inertia\":[0.1,0.2,0.3],\"position\":[0,0,0]},"
    "{\"name\":\"other\",\"mass\":3,\"inertia\":[0.2,0.2,0.3],\"position\":[0,0,0.0996]}]' "
    "--set 'dem.bodies=[{\"name\":\"plate\",\"material\":\"a\",\"shapes\":[{\"type\":\"plane\",\"normal\":[0,0,1]}]},"
    "{\"name\":\"other\",\"material\":\"a\",\"shapes\":[{\"type\":\"plane\",\"normal\":[0,0,-1]}]}]' ";

START_TEST(own_solvers_conform_with_two_bodies) {
  char words[2000];
  setup();
  snprintf(words, sizeof words, "%s --role dem -- tandem-dem", second_plate);
  ck_assert_msg(conform(words) == 0, "%s", command_output);
  expect_output("0 broken, 2 not claimed");
  teardown();
  dir = directory_with_scene(arm_scene);
  ck_assert_msg(conform("-- tandem-mbd") == 0, "%s", command_output);
  expect_output("0 broken, 2 not claimed");
  ck_assert_str_eq(verdict("mobility.motion"), "kept");
  ck_assert_str_eq(verdict("mobility.rates"), "kept");
  teardown();
}
END_TEST

/* What a scene must have for some rules to be seen: drivers, a body that nothing holds. */
START_TEST(own_solvers_conform_where_it_is_seen) {
  char words[200];
  dir = directory_with_scene(shaken_scene);
  ck_assert_msg(conform("-- tandem-mbd") == 0, "%s", command_output);
  ck_assert_str_eq(verdict("ahead"), "kept");
  ck_assert_str_eq(verdict("ahead.prescribed"), "kept");
  teardown();
  setup();
  snprintf(words, sizeof words, "%s --rule gravity -- tandem-mbd", without_spring);
  ck_assert_msg(conform(words) == 0, "%s", command_output);
  ck_assert_str_eq(verdict("gravity"), "kept");
  teardown();
}
END_TEST

START_TEST(the_dummy_conforms) {
  /* the scene for who gives none; the role is found by HELLO */
  setup();
  ck_assert_msg(command("tandem conform --set dem.stiffness=100 -- dummy_solver") == 0, "%s", command_output);
  expect_output("dummy_solver as dem");
  expect_output("0 broken, 15 not claimed, 4 not seen");
  teardown();
}
END_TEST

static const struct {
  const char *role, *lie, *rule;
} lies[] = {
    {"mbd", "mirrored", "load"},
    {"mbd", "light", "load"},
    {"mbd", "flat", "load.polynomial"},
    {"mbd", "stays", "states"},
    {"mbd", "slack", "acceleration"},
    {"mbd", "works twice", "energy"},
    {"mbd", "sluggish", "mobility"},
    {"mbd", "forgets", "restore"},
    {"mbd", "ready zero quaternion", "ready"},
    {"dem", "attracts", "load"},
    {"dem", "strikes", "interface"},
    {"dem", "works twice", "interface"},
    {"dem", "strays", "interface"},
    {"dem", "pushes", "proxy"},
    {"dem", "straight", "path"},
    {"dem", "forgets", "restore"},
    {"mbd", "lone", "alone"},
    {"dem", "forgets samples", "load.samples"},
    {"dem", "has energy", "energy"},
    {"dem", "flattens", "interface"},
    {"dem", "stiff", "load.path"},
    {"dem", "starts", "load.start"},
    {"mbd", "accelerates late", "acceleration"},
    {"mbd", "weightless", "energy.stored"},
    {"mbd", "without J", "mobility.parts"},
    {"mbd", "twice B", "mobility.parts"},
    {"mbd", "without velocity", "mobility.parts"},
    {"dem", "ignores W(0)", "proxy"},
    {"dem", "ignores drivers", "proxy.model"},
    {"dem", "without dJ/dt", "proxy.model"},
    {"dem", "without dB/dt", "proxy.model"},
    {"dem", "ignores corrections", "proxy.correction"},
    {"dem", "corrects for nothing", "proxy.correction"},
    {"dem", "jumps", "proxy.drift"},
    {"dem", "feels the path", "sent_velocity"},
    {"dem", "leaves bodies", "restore"},
    {"dem", "pulls", "view.contacts"},
    {"dem", "is on the moon", "gravity"},
    {"dem", "turns at once", "path.turns"},
    {"mbd", "prescribes", "ahead.prescribed"},
};

static void find_lie(const char *role, const char *lie, const char *rule, const char *options, const char *scene) {
  char words[2000];
  dir = directory_with_scene(scene);
  snprintf(words, sizeof words, "%s --rule %s --role %s -- lying_solver", options, rule, role);
  setenv("LIE_ROLE", role, 1);
  setenv("LIE", lie, 1);
  ck_assert_int_eq(conform(words), 1);
  ck_assert_msg(strcmp(verdict(rule), "broken") == 0, "%s: %s\n%s", lie, verdict(rule), command_output);
  teardown();
}

START_TEST(lies_are_found) {
  find_lie(lies[_i].role, lies[_i].lie, lies[_i].rule, "", plate_scene);
}
END_TEST

/* lies that another scene shows, or the plate's with other values */
static const struct {
  const char *role, *lie, *rule, *options, *scene;
} elsewhere[] = {
    {"mbd", "without stiffness", "mobility.motion", "--set time.end=0.3", plate_scene},
    {"mbd", "without damping", "mobility.motion", "--set time.end=0.3 --set mbd.forces[0].damping=30", plate_scene},
    {"mbd", "without dB/dt", "mobility.rates", "", arm_scene},
    {"mbd", "without dJ/dt", "mobility.rates", "", arm_scene},
    {"dem", "swaps", "interface", second_plate, plate_scene},
    {"mbd", "is on the moon", "gravity", without_spring, plate_scene},
    {"mbd", "strays ahead", "ahead", "", shaken_scene},
    {"mbd", "turns ahead", "ahead", "", shaken_scene},
    {"mbd", "tells no path", "ahead", "", shaken_scene}};

START_TEST(lies_elsewhere_are_found) {
  find_lie(elsewhere[_i].role, elsewhere[_i].lie, elsewhere[_i].rule, elsewhere[_i].options, elsewhere[_i].scene);
}
END_TEST

static const struct {
  const char *fault, *rule;
  int timeout; /* short for those that do not answer; others may be late on a busy machine */
} faults[] = {{"version", "windows", 60}, {"garbage", "windows", 60}, {"silent", "ready", 1},
              {"quits", "ready", 60},     {"late", "windows", 60},    {"counts", "windows", 60},
              {"deaf", "finish", 1},      {"hangs", "windows", 1},    {"killed", "windows", 60}};

START_TEST(faults_are_found) {
  char words[96];
  setup();
  setenv("FAULT", faults[_i].fault, 1);
  setenv("FAULT_WINDOW", "1", 1);
  snprintf(words, sizeof words, "--rule %s --role dem --timeout %d -- faulty_solver", faults[_i].rule,
           faults[_i].timeout);
  ck_assert_int_eq(conform(words), 1);
  ck_assert_msg(strcmp(verdict(faults[_i].rule), "broken") == 0, "%s: %s\n%s", faults[_i].fault,
                verdict(faults[_i].rule), command_output);
  teardown();
}
END_TEST

static const struct {
  const char *text, *rule, *verdict;
} checkpoints[] = {{"", "checkpoint", "kept"},
                   {"", "checkpoint.none", "kept"},
                   {"forgets", "checkpoint", "broken"},
                   {"remembers", "checkpoint", "broken"},
                   {"lenient", "checkpoint.none", "broken"}};

START_TEST(checkpoints_are_looked_at) {
  char words[96];
  setup();
  setenv("FAULT", "checkpoint", 1);
  setenv("FAULT_TEXT", checkpoints[_i].text, 1);
  snprintf(words, sizeof words, "--rule %s --role dem -- faulty_solver", checkpoints[_i].rule);
  conform(words);
  ck_assert_msg(strcmp(verdict(checkpoints[_i].rule), checkpoints[_i].verdict) == 0, "%s: %s\n%s", checkpoints[_i].text,
                verdict(checkpoints[_i].rule), command_output);
  teardown();
}
END_TEST

START_TEST(wrong_commands) {
  setup();
  ck_assert_int_eq(conform(""), 2);
  expect_output("behind --");
  ck_assert_int_eq(conform("--role sieve -- tandem-dem"), 2);
  expect_output("give \"dem\" or \"mbd\"");
  ck_assert_int_eq(conform("--role dem -- no_such_solver"), 1);
  ck_assert_int_eq(conform("-- no_such_solver"), 1);
  expect_output("neither beside this program nor on PATH");
  ck_assert_int_eq(conform("-- true"), 1);
  expect_output("exit status 0");
  ck_assert_int_eq(conform("--rule interfase -- tandem-dem"), 2);
  expect_output("did you mean interface");
  ck_assert_int_eq(conform("--timeout 0 -- tandem-dem"), 2);
  expect_output("give a number of seconds");
  ck_assert_int_eq(command("tandem conform %s/none.json -- tandem-dem", dir), 1);
  ck_assert_int_eq(command("tandem run %s/scene.json -- tandem-dem", dir), 2);
  expect_output("does not go with this command");
  teardown();
}
END_TEST

TEST_MAIN_ROWS("conform", {own_solvers_conform, 1}, {own_solvers_conform_with_two_bodies, 1},
               {own_solvers_conform_where_it_is_seen, 1}, {the_dummy_conforms, 1},
               {lies_are_found, SOME_ROWS(sizeof lies / sizeof lies[0])},
               {lies_elsewhere_are_found, SOME_ROWS(sizeof elsewhere / sizeof elsewhere[0])},
               {faults_are_found, SOME_ROWS(sizeof faults / sizeof faults[0])},
               {checkpoints_are_looked_at, (int)(sizeof checkpoints / sizeof checkpoints[0])}, {wrong_commands, 1})
