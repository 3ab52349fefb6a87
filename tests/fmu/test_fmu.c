/* tandem-fmu: models that are packed as FMUs here conform, move as theory and tandem-mbd say, under all schemes that
 * they can go with; and whatever is wrong with an FMU or with its mapping is named. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/spring_damper/reference.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <math.h>

/* A plate on a spring, guided along z, and two particles on it; the model's x is downwards. */
static const char plate[] =
    "{'time':{'end':0.05,'dt':1e-4},'coupling':{'n':5,'bodies':[{'mbd':'plate','dem':'plate'}],\n"
    "'solvers':{'mbd':'tandem-fmu %s/m.fmu'}},'output':{'interval':1e-3},\n"
    "'mbd':{'parameters':{'mass':2,'stiffness':500,'damping':1,'gravity':1},'bodies':[{'name':'plate','mass':2,\n"
    "'inertia':[0.1,0.2,0.3],'inputs':{'force':[null,null,'-f']},\n"
    "'outputs':{'position':[0,0,'-x'],'velocity':[0,0,'-vx']}}],'channels':[{'name':'way','variable':'x','unit':'m'}]},"
    "\n"
    "'dem':{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],\n"
    "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],\n"
    "'bodies':[{'name':'plate','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],\n"
    "'particles':[{'type':'list','material':'a','radius':0.05,'positions':[[0,0,0.0498],[0.2,0.1,0.0499]]}]}}\n";

/* The same of tandem-mbd. */
#define OWN_MBD                                                                                                        \
  "--set coupling.solvers.mbd=tandem-mbd --set "                                                                       \
  "'mbd={\"gravity\":[0,0,-1],\"bodies\":[{\"name\":\"plate\",\"mass\":2,\"inertia\":[0.1,0.2,0.3],\"position\":[0,0," \
  "0]}],"                                                                                                              \
  "\"joints\":[{\"name\":\"guide\",\"type\":\"prismatic\",\"bodies\":[\"ground\",\"plate\"],\"point\":[0,0,0],"        \
  "\"axis\":[0,0,1]}],"                                                                                                \
  "\"forces\":[{\"name\":\"spring\",\"type\":\"spring_damper\",\"bodies\":[\"ground\",\"plate\"],\"points\":[[0,0,-1]" \
  ",[0,0,0]],"                                                                                                         \
  "\"stiffness\":500,\"damping\":1}]}' "

/* An arm of 1 m about the origin: the FMU is told the load at the centre of mass, or the moment about the pivot, or it
 * gets it as arrays. */
#define ARM                                                                                             \
  "--set 'mbd.parameters={\"mass\":2,\"inertia\":2.3,\"arm\":1,\"stiffness\":50,\"damping\":1}' --set " \
  "'mbd.channels=[]' "
#define ARM_CENTER                                                                                                 \
  ARM "--set 'mbd.bodies[0].inputs={\"force\":[\"fx\",\"fy\",null],\"moment\":[null,null,\"mz\"]}' "               \
      "--set 'mbd.bodies[0].outputs={\"position\":[\"x\",\"y\",0],\"velocity\":[\"vx\",\"vy\",0],\"orientation\":" \
      "{\"angle\":[\"phi\"],\"axis\":[0,0,1]},\"angular_velocity\":[0,0,\"w\"]}' "
#define ARM_POINT                                                                               \
  ARM "--set 'mbd.bodies[0].point=[-1,0,0]' "                                                   \
      "--set 'mbd.bodies[0].inputs={\"moment\":[null,null,\"m\"],\"moment_about\":\"point\"}' " \
      "--set 'mbd.bodies[0].outputs={\"orientation\":{\"euler313\":[\"phi\",0,0]},\"angular_velocity\":[0,0,\"w\"]}' "
#define ARM_ARRAYS                                                                                      \
  ARM "--set 'mbd.bodies[0].inputs={\"force\":\"force\",\"moment\":[null,null,\"mz\"]}' "               \
      "--set 'mbd.bodies[0].outputs={\"position\":\"place\",\"velocity\":\"velocity\",\"orientation\":" \
      "{\"angle\":[\"phi\"],\"axis\":[0,0,1]},\"angular_velocity\":[0,0,\"w\"]}' "
#define ARM_X "--set 'dem.bodies[0].shapes[0].normal=[0,1,0]' --set 'dem.particles[0].positions=[[1,0.0498,0]]' "

static const char *dir;

static void setup(void) {
  char text[4096];
  dir = directory_make();
  snprintf(text, sizeof text, plate, dir);
  double_quotes(text);
  write_file(dir, "scene.json", text);
}

static void teardown(void) {
  char unpacked[128];
  snprintf(unpacked, sizeof unpacked, "%s/tandem-", dir);
  WAIT_FOR(find_processes(unpacked, NULL) == 0); /* the one that removes what was unpacked is the last */
  expect_nothing_left(dir);                      /* tandem-fmu-XXXXXX among it */
  directory_remove(dir);
}

/* Pack a model: "2 spring states" is version, token and flags. */
static void pack(const char *words) {
  ck_assert_msg(command("make_fmu %s/m.fmu " TANDEM_TEST_DIR "/libfmu_model%c.so %s", dir, words[0], words) == 0, "%s",
                command_output);
}

static int run(const char *options) {
  return command("tandem run %s/scene.json --out %s/out --force %s", dir, dir, options);
}

/* The largest difference of column `c` of body_plate.csv in DIR/a and DIR/b, and the column's largest value. */
static double difference(const char *a, const char *b, int c, double *largest) {
  const char *const names[] = {a, b};
  char path[256], line[2][2048];
  double most = 0;
  FILE *f[2];
  *largest = 0;
  for (int i = 0; i < 2; i++) {
    snprintf(path, sizeof path, "%s/%s", dir, names[i]);
    f[i] = fopen(path, "r");
    ck_assert_ptr_nonnull(f[i]);
    ck_assert_ptr_nonnull(fgets(line[i], sizeof line[i], f[i]));
  }
  while (fgets(line[0], sizeof line[0], f[0]) && fgets(line[1], sizeof line[1], f[1])) {
    double value[2];
    for (int i = 0; i < 2; i++) {
      char *p = line[i];
      for (int k = 0; k < c; k++)
        p = strchr(p, ',') + 1;
      value[i] = atof(p);
    }
    most = fmax(most, fabs(value[0] - value[1]));
    *largest = fmax(*largest, fabs(value[1]));
  }
  fclose(f[0]);
  fclose(f[1]);
  return most;
}

static const struct {
  const char *fmu, *options, *claimed;
} models[] = {{"2 spring states derivatives", "", "0 broken, 7 not claimed, 4 not seen"},
              {"2 spring", "", "0 broken, 13 not claimed, 1 not seen"},
              {"2 'spring single' no-slopes once fixed", "", "0 broken, 13 not claimed, 1 not seen"},
              {"2 arm states", ARM_X ARM_CENTER, "0 broken, 7 not claimed, 4 not seen"},
              {"2 arm states derivatives", ARM_X ARM_POINT, "0 broken, 7 not claimed, 4 not seen"},
              {"3 spring states no-slopes", "", "0 broken, 7 not claimed, 4 not seen"},
              {"3 arm states derivatives", ARM_X ARM_ARRAYS, "0 broken, 7 not claimed, 4 not seen"},
              {"2 cylinder states",
               "--set 'mbd.parameters={\"mass\":2,\"area\":1e-3,\"supply\":2e4,\"valve\":1e-8,\"modulus\":1e9,"
               "\"volume\":1e-3,\"damping\":5}' --set 'mbd.channels[0]={\"name\":\"p\",\"variable\":\"pressure\"}'",
               "0 broken, 7 not claimed, 4 not seen"}};

START_TEST(conforms) {
  setup();
  pack(models[_i].fmu);
  ck_assert_msg(command("tandem conform %s/scene.json %s -- tandem-fmu %s/m.fmu", dir, models[_i].options, dir) == 0,
                "%s: %s", models[_i].fmu, command_output);
  expect_output(models[_i].claimed);
  teardown();
}
END_TEST

static const struct {
  const char *fmu, *options;
  double off; /* share of the largest value */
} twins[] = {{"2 spring states derivatives", "--set coupling.n=50", 1e-3},
             {"2 spring states no-slopes", "--set coupling.n=50", 1e-3},
             {"3 spring states", "--set coupling.n=50", 1e-3},
             {"3 spring", "--set coupling.scheme=dem-first", 1e-3},
             {"2 spring no-slopes", "--set coupling.scheme=lommen", 1e-3},
             {"2 spring no-slopes fixed", "--set coupling.scheme=dem-first", 1e-3}};

START_TEST(moves_as_tandem_mbd) {
  double largest;
  setup();
  pack(twins[_i].fmu);
  ck_assert_msg(run(twins[_i].options) == 0, "%s", command_output);
  ck_assert_msg(command("tandem run %s/scene.json --out %s/own --force %s %s", dir, dir, twins[_i].options, OWN_MBD) ==
                    0,
                "%s", command_output);
  for (int c = 3; c <= 10; c += 7) { /* z and vz */
    const double off = difference("out/body_plate.csv", "own/body_plate.csv", c, &largest);
    ck_assert_msg(largest > 0 && off < twins[_i].off * largest, "column %d: off by %g of %g", c, off, largest);
  }
  teardown();
}
END_TEST

/* The scenario spring_damper for 1.5 s with windows of 0.01 s, against its closed form. */
START_TEST(holds_in_long_windows) {
  static const char *const fmus[] = {"2 spring states derivatives", "2 spring states no-slopes"};
  const scn_spring_damper_parameters theory = {
      .mass = 361.8, .damping = 500, .stiffness = 5000, .preload = 100, .gravity = 9.81};
  char path[256], line[2048];
  double sum[2] = {0}, square[2] = {0}, off[2] = {0};
  int n = 0;
  setup();
  pack(fmus[_i]);
  ck_assert_msg(command("tandem run " TANDEM_SOURCE_DIR "/scenarios/spring_damper/scene.json --out %s/out --set "
                        "time.end=1.5 --set coupling.n=100 --set 'coupling.solvers.mbd=\"tandem-fmu %s/m.fmu\"' --set "
                        "'mbd={\"parameters\":{\"mass\":100,\"stiffness\":5000,\"damping\":500,\"preload\":100,"
                        "\"gravity\":9.81},\"bodies\":[{\"name\":\"box\",\"mass\":100,\"inertia\":[21.7,21.7,10.7],"
                        "\"inputs\":{\"force\":[null,null,\"-f\"]},\"outputs\":{\"position\":[0,0,\"-x\"],"
                        "\"velocity\":[0,0,\"-vx\"]}}]}'",
                        dir, dir) == 0,
                "%s", command_output);
  snprintf(path, sizeof path, "%s/out/body_box.csv", dir);
  FILE *f = fopen(path, "r");
  ck_assert_ptr_nonnull(f);
  ck_assert_ptr_nonnull(fgets(line, sizeof line, f));
  for (; fgets(line, sizeof line, f); n++) {
    double t, z, vz, exact[2];
    ck_assert_int_eq(sscanf(line, "%lf,%*f,%*f,%lf,%*f,%*f,%*f,%*f,%*f,%*f,%lf", &t, &z, &vz), 3);
    scn_spring_damper_exact(&theory, t, &exact[0], &exact[1]);
    for (int k = 0; k < 2; k++) {
      sum[k] += exact[k];
      square[k] += exact[k] * exact[k];
      off[k] += pow((k == 0 ? -z : -vz) - exact[k], 2);
    }
  }
  fclose(f);
  ck_assert_int_eq(n, 1501);
  for (int k = 0; k < 2; k++) {
    const double nse = 1 - off[k] / (square[k] - sum[k] * sum[k] / n);
    ck_assert_msg(nse >= 0.999, "nse of %s: %.6f", k == 0 ? "x" : "v", nse);
  }
  teardown();
}
END_TEST

/* ---- what is wrong is named ---- */

static const struct {
  const char *fmu, *said;
} faults[] = {
    {"2 'spring hang' states", "fmi2DoStep has not returned"},
    {"2 'spring crash' states", "crashed in fmi2DoStep"},
    {"2 'spring exit' states", "ended the process in fmi2DoStep"},
    {"2 'spring overflow' states", "crashed in fmi2DoStep"},
    {"2 'spring pending' states", "returned pending; it steps asynchronously"},
    {"2 'spring status7' states", "returned a status that the standard does not know"},
    {"2 'spring discard' states", "returned discard: the valve sticks"},
    {"2 'spring error' states", "returned error: the oil boils"},
    {"2 'spring fatal' states", "returned fatal: the pump burst"},
    {"2 'spring nan'", "an output is not a finite number"},
    {"3 'spring hang' states", "fmi3DoStep has not returned"},
    {"3 'spring crash' states", "crashed in fmi3DoStep"},
    {"3 'spring discard'", "returned discard: the valve sticks"},
    {"3 'spring fatal'", "returned fatal: the pump burst"},
    {"3 'spring ends'", "it asks to end the simulation at 0.00"},
    {"2 spring other-token", "this GUID is not mine"},
    {"3 spring other-token", "this token is not mine"},
    {"2 spring no-binary", "has no binary for this platform (binaries/linux64/model.so); export it"},
    {"2 spring other-platform", "has no binary for this platform (binaries/linux64/model.so), only for others"},
    {"2 spring exchange", "no co-simulation FMU"},
    {"2 spring broken", "modelDescription.xml, line"},
    {"2 spring version1", "its fmiVersion is 1.0"},
    {"2 spring no-description", "has no modelDescription.xml"},
    {"2 spring identifier", "its modelIdentifier \"../model\" is no C identifier"},
    {"2 spring escape", "would not lie in the FMU's own folder"}};

START_TEST(faults_are_named) {
  setup();
  pack(faults[_i].fmu);
  const bool answers = !strstr(faults[_i].fmu, "hang"); /* on a busy machine late */
  ck_assert_int_eq(run(answers ? "--set coupling.scheme=dem-first --set coupling.timeout=60"
                               : "--set coupling.scheme=dem-first --set coupling.timeout=2"),
                   1);
  ck_assert_msg(strstr(command_output, faults[_i].said) != NULL, "%s: no \"%s\" in\n%s", faults[_i].fmu,
                faults[_i].said, command_output);
  teardown();
}
END_TEST

#define OUTPUTS "--set 'mbd.bodies[0].outputs="
static const struct {
  const char *options, *said;
} mistakes[] = {
    {"--set 'mbd.bodies[0].inputs.force[2]=\"g\"'", "mbd.bodies[0].inputs.force[2]: mbd"},
    {"--set 'mbd.bodies[0].inputs.force[2]=\"presure\"'", "did you mean \"pressure\"?"},
    {"--set 'mbd.bodies[0].inputs.force[2]=\"x\"'", "has the causality \"output\"; here it must be an \"input\""},
    {"--set 'mbd.bodies[0].inputs.force[2]=1'", "give the name of a variable of the FMU or null"},
    {"--set 'mbd.bodies[0].outputs.position[2]=\"f\"'", "here it must be an \"output\""},
    {"--set 'mbd.channels[0].variable=\"count\"'", "has the causality \"parameter\""},
    {"--set 'mbd.parameters.count=1.5'", "is of type Integer: give a whole number"},
    {"--set 'mbd.parameters.on=1'", "is of type Boolean: give true or false"},
    {"--set 'mbd.parameters.text=1'", "is of type String: give text"},
    {"--set 'mbd.parameters.text=\"wrong\"'", "fmi2SetString at t = 0 s returned error: no such text"},
    {"--set 'mbd.parameters.mass=\"2\"'", "is of type Real: give a number"},
    {"--set 'mbd.parameters.mas=2'", "did you mean \"mass\"?"},
    {"--set 'mbd.bodies[0].outputs.velocity=null'", "give a list of 3"},
    {OUTPUTS "{\"position\":[0,0,\"-x\"]}'", "contacts need the velocity"},
    {OUTPUTS "{\"orientation\":{\"angle\":[\"phi\"],\"axis\":[0,0,1]}}'", "contacts need the angular velocity"},
    {OUTPUTS "{\"position\":[0,0,1]}'", "the body would never move"},
    {OUTPUTS "{\"orientation\":{}}'", "give one of euler313"},
    {"--set 'mbd.bodies[0].inputs={}'", "the loads of the particles would go nowhere"},
    {"--set mbd.bodies[0].name=deck", "there is no body \"plate\" in mbd.bodies"},
    {"--set mbd.colour=1", "colour"},
    {"--set 'mbd.bodies[0].inputs.force[1]=\"f\"'", "the input \"f\" of"},
    {"--set mbd.step=1e-30", "communication steps of 1e-30 s; give a longer step"},
    {"--set 'mbd.bodies[0].inputs.force[2]=\"f\"'", "no mechanism answers to loads as"}, /* a sign */
};

START_TEST(mistakes_are_named) {
  setup();
  pack("2 spring states no-slopes");
  ck_assert_int_eq(run(mistakes[_i].options), 1);
  ck_assert_msg(strstr(command_output, mistakes[_i].said) != NULL, "%s: no \"%s\" in\n%s", mistakes[_i].options,
                mistakes[_i].said, command_output);
  ck_assert_msg(command("grep crash %s/out/mbd.log", dir) != 0, "%s: %s", mistakes[_i].options, command_output);
  teardown();
}
END_TEST

START_TEST(schemes_that_it_can_go_with) {
  setup();
  pack("2 spring");
  ck_assert_int_eq(run(""), 1);
  expect_output("the scheme proxy needs the capability \"mobility\", which mbd does not have");
  expect_output("dem-first, ");
  ck_assert_msg(run("--set coupling.fallback=dem-first") == 0, "%s", command_output);
  expect_output("dem-first was taken instead");
  ck_assert_msg(command("tandem check %s/scene.json --set coupling.fallback=dem-first", dir) == 0, "%s",
                command_output);
  expect_output("cannot                       mobility, restore, energy");
  expect_output("schemes both support         dem-first");
  pack("2 spring derivatives no-slopes"); /* it could, were accelerations among the outputs */
  ck_assert_int_eq(run(""), 1);
  expect_output("must be among the outputs");
  pack("2 spring fixed");
  ck_assert_int_eq(run("--set coupling.scheme=dem-first --set mbd.step=3e-4"), 1);
  expect_output("takes communication steps of one length only");
  teardown();
}
END_TEST

/* The FMU is told of its folder by an absolute URI. */
START_TEST(unpacks_where_tmpdir_says) {
  setup();
  pack("2 spring states");
  ck_assert_msg(command("mkdir '%s/a b'", dir) == 0, "%s", command_output);
  ck_assert_msg(command("env -C %s TMPDIR='a b' tandem run scene.json --out out", dir) == 0, "%s", command_output);
  teardown();
}
END_TEST

START_TEST(tells_what_it_has) {
  setup();
  pack("3 spring states");
  ck_assert_int_eq(command("tandem-fmu %s/m.fmu", dir), 0);
  expect_output("\"spring\", FMI 3.0 co-simulation");
  expect_output("Float64      force[3]");
  expect_output("instances in a process       any number");
  write_file(dir, "m.fmu", "no archive");
  ck_assert_int_eq(command("tandem-fmu %s/m.fmu", dir), 1);
  expect_output("is no FMU that can be read");
  ck_assert_int_eq(command("tandem-fmu %s/none.fmu", dir), 1);
  ck_assert_int_eq(command("tandem-fmu"), 2);
  ck_assert_int_eq(command("tandem-fmu --connect x"), 2);
  teardown();
}
END_TEST

#define ROWS(table) (int)(sizeof table / sizeof table[0])
TEST_MAIN_ROWS("fmu", {conforms, SOME_ROWS(ROWS(models))}, {moves_as_tandem_mbd, ROWS(twins)},
               {holds_in_long_windows, 2}, {faults_are_named, SOME_ROWS(ROWS(faults))},
               {mistakes_are_named, SOME_ROWS(ROWS(mistakes))}, {schemes_that_it_can_go_with, 1},
               {unpacks_where_tmpdir_says, 1}, {tells_what_it_has, 1})
