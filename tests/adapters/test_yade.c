/* tandem-yade: a plate with two balls conforms and moves as with tandem-dem; the box of [L18] Section 3.3 moves as
 * theory says; and what is wrong with a script is named. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/table.h"
#include "tests/command.h"
#include "tests/result_table.h"
#include "tests/test_main.h"

#include <math.h>

/* A plate on a hinge and a torsional spring, and two balls on it, neither above the hinge. */
static const char plate[] =
    "{'time':{'end':0.4,'dt':1e-4},'gravity':[0,0,-9.81],\n"
    "'coupling':{'n':5,'scheme':'dem-first','bodies':[{'mbd':'plate','dem':'plate'}]},\n"
    "'output':{'interval':1e-3},\n"
    "'mbd':{'bodies':[{'name':'plate','mass':2,'inertia':[0.1,0.2,0.3],'position':[0.1,0,0]}],\n"
    "'joints':[{'name':'hinge','type':'revolute','bodies':['ground','plate'],'point':[0,0,0],'axis':[0,1,0]}],\n"
    "'forces':[{'name':'spring','type':'torsional_spring_damper','joint':'hinge','stiffness':100,'damping':1}]},\n"
    "'dem':{'solver':'tandem-yade','script':{'file':'plate.py','variables':{'friction':0.5}}}}\n";

static const char script[] =
    "plate, p = tandem.bodies['plate'], tandem.variables\n"
    "m = O.materials.append(FrictMat(young=1e7, poisson=0.25, density=1000, frictionAngle=atan(p['friction'])))\n"
    "corners = [plate.position + Vector3(x, y, 0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]\n"
    "ids = O.bodies.append([facet([corners[k] for k in c], material=m) for c in ((0, 1, 2), (0, 2, 3))])\n"
    "for at in ((0.2, 0.3, 0.0498), (0.4, -0.15, 0.06)):\n"
    "    O.bodies.append(sphere(at, 0.05, material=m))\n"
    "O.engines = [ForceResetter(), InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Facet_Aabb()]),\n"
    "    InteractionLoop([Ig2_Sphere_Sphere_ScGeom(), Ig2_Facet_Sphere_ScGeom()],\n"
    "        [Ip2_FrictMat_FrictMat_MindlinPhys(en=0.2, es=0.2)], [Law2_ScGeom_MindlinPhys_Mindlin()]),\n"
    "    NewtonIntegrator(damping=0, gravity=tandem.gravity)]\n"
    "coupled = {'plate': ids}\n"
    "channels = {'height': ('m', lambda: O.bodies[2].state.pos[2])}\n";

/* The same of tandem-dem. */
#define OWN_DEM                                                                                                  \
  "--set "                                                                                                       \
  "'dem={\"materials\":[{\"name\":\"a\",\"density\":1000,\"young_modulus\":1e7,\"poisson_ratio\":0.25}],"        \
  "\"pairs\":[{\"materials\":[\"a\",\"a\"],\"restitution\":0.2,\"friction\":0.5}],"                              \
  "\"contact\":{\"wall_mass\":1e8},\"bodies\":[{\"name\":\"plate\",\"material\":\"a\",\"shapes\":[{\"type\":"    \
  "\"plane\",\"normal\":[0,0,1]}]}],"                                                                            \
  "\"particles\":[{\"type\":\"list\",\"material\":\"a\",\"radius\":0.05,\"positions\":[[0.2,0.3,0.0498],[0.4,-0" \
  ".15,0.06]]}]}' "

static const char *dir;

static void setup(void) {
  dir = directory_with_scene(plate);
  write_file(dir, "plate.py", script);
}

static void teardown(void) {
  expect_nothing_left(dir);
  directory_remove(dir);
}

static int run(const char *options) {
  return command("tandem run %s/scene.json --out %s/out --force %s", dir, dir, options);
}

START_TEST(conforms) {
  setup();
  ck_assert_msg(command("tandem conform %s/scene.json --timeout 120 -- tandem-yade", dir) == 0, "%s", command_output);
  expect_output("as dem");
  expect_output("0 broken, 14 not claimed, 1 not seen");
  teardown();
}
END_TEST

/* The means of a column of body_plate.csv in DIR/out and DIR/own, and the largest difference of its values. */
typedef struct {
  double mean[2], apart;
} pair;

static pair compare(const char *name) {
  char path[2][256];
  cpl_table table[2];
  pair p = {0};
  for (int i = 0; i < 2; i++) {
    snprintf(path[i], sizeof path[i], "%s/%s", dir, i ? "own" : "out");
    read_table(&table[i], path[i], "body_plate.csv");
  }
  ck_assert_int_eq(table[0].nrow, table[1].nrow);
  const double *value[] = {column(&table[0], name), column(&table[1], name)};
  for (int k = 0; k < table[0].nrow; k++) {
    p.apart = fmax(p.apart, fabs(value[0][k] - value[1][k]));
    for (int i = 0; i < 2; i++)
      p.mean[i] += value[i][k] / table[i].nrow;
  }
  for (int i = 0; i < 2; i++)
    cpl_table_free(&table[i]);
  return p;
}

/* Loads, their moments among them, and the path of a body that turns: as with tandem-dem. Yade takes a facet for a
 * sphere of twice the radius, so that the balls lie 14 % deeper on it: of loads the means are compared. */
START_TEST(moves_as_with_own_dem) {
  setup();
  ck_assert_msg(run("") == 0, "%s", command_output);
  expect_output("Yade's contact laws take coupled bodies for walls of infinite mass");
  ck_assert_msg(is_there(dir, "out", "dem.csv"), "no channels");
  ck_assert_msg(command("tandem run %s/scene.json --out %s/own " OWN_DEM, dir, dir) == 0, "%s", command_output);
  static const char *const loads[] = {"fz", "mx", "my"};
  for (int k = 0; k < 3; k++) {
    const pair p = compare(loads[k]);
    ck_assert_double_gt(fabs(p.mean[1]), 0.1);
    ck_assert_double_eq_tol(p.mean[0], p.mean[1], 0.02 * fabs(p.mean[1]));
  }
  ck_assert_double_lt(compare("z").apart, 1e-4);
  ck_assert_double_lt(compare("qy").apart, 5e-4);
  teardown();
}
END_TEST

/* Two runs have the same bits. */
START_TEST(repeats) {
  setup();
  ck_assert_msg(run("") == 0, "%s", command_output);
  ck_assert_msg(command("tandem run %s/scene.json --out %s/again", dir, dir) == 0, "%s", command_output);
  ck_assert_int_eq(command("cmp %s/out/body_plate.csv %s/again/body_plate.csv", dir, dir), 0);
  teardown();
}
END_TEST

static const struct {
  const char *add, *options, *told[3]; /* lines behind the script's */
} faults[] = {
    {"", "--set dem.script.file=none.py", {"dem.script.file", "there is no such file"}},
    {"", "--set dem.scrpt=1", {"dem.scrpt", "unknown key"}},
    {"", "--set coupling.bodies[0].dem=none", {"dem.script", "line 1", "none is called \"plate\""}},
    {"coupled = {'other': ids}\n", "", {"coupling.bodies[0].dem", "not in the dictionary coupled"}},
    {"", "--set coupling.scheme=proxy", {"needs the capability"}},
    {"x = no_such_name\n", "", {"dem.script", "plate.py, line 13", "NameError"}},
    {"if\n", "", {"dem.script", "plate.py, line 13", "SyntaxError"}},
    {"import no_such_module\n", "", {"dem.script", "line 13", "ModuleNotFoundError"}},
    {"exit()\n", "", {"dem.script", "ends by itself"}},
    {"coupled = {'plate': [99]}\n", "", {"dem.script", "names body 99"}},
    {"coupled = {'plate': []}\n", "", {"dem.script", "is empty"}},
    {"coupled = 7\n", "", {"dem.script", "coupled = {"}},
    {"channels = {'a': 'm'}\n", "", {"dem.script", "channels must be"}},
    {"O.engines = O.engines[:3]\n", "", {"dem.script", "NewtonIntegrator"}},
    {"O.run()\n", "", {"dem.script", "leaves Yade running"}},
    {"O.engines[3].mask = 8\n", "", {"coupling.bodies[0].dem", "not where it was moved to"}},
    {"O.engines += [PyRunner(command='1 / 0', iterPeriod=20)]\n", "", {"an engine of Yade failed", "ZeroDivision"}},
    {"O.engines += [PyRunner(command='O.pause()', iterPeriod=20)]\n", "", {"Yade has ended the simulation"}},
    /* one member among others, in a list and in a clump */
    {"O.engines += [PyRunner(command='O.bodies[ids[1]].state.pos += (0, 0, 1e-3)', iterPeriod=1)]\n",
     "",
     {"coupling.bodies[0].dem", "has body 1 of", "not where it was moved to"}},
    {"two = [sphere((x, 0, -1), 0.05, material=m) for x in (0, 0.2)]\nids, parts = O.bodies.appendClumped(two)\n"
     "coupled = {'plate': [0, ids]}\n"
     "O.engines += [PyRunner(command='O.bodies[parts[1]].state.pos += (0, 0, 1e-3)', iterPeriod=1)]\n",
     "",
     {"coupling.bodies[0].dem", "not where it was moved to"}},
    {"O.bodies[2].state.pos = Vector3(0.2, 0.3, float('nan'))\n", "", {"finite"}},
    {"ids = O.bodies.append(wall(0, axis=2))\ncoupled = {'plate': [ids]}\n", "", {"it turns", "Wall"}},
    {"while True: pass\n", "--set coupling.timeout=5", {"no answer for 5 s"}},
    {"import os\nos.kill(os.getpid(), 11)\n", "", {"killed by signal 11"}},
};

START_TEST(faults_are_named) {
  char text[4096];
  setup();
  snprintf(text, sizeof text, "%s%s", script, faults[_i].add);
  write_file(dir, "plate.py", text);
  ck_assert_msg(is_refusal(run(faults[_i].options)), "%s: %s", faults[_i].add, command_output);
  for (int k = 0; k < 3 && faults[_i].told[k]; k++)
    ck_assert_msg(strstr(command_output, faults[_i].told[k]) != NULL, "%s %s: no \"%s\" in: %s", faults[_i].add,
                  faults[_i].options, faults[_i].told[k], command_output);
  teardown();
}
END_TEST

/* Position and velocity of the box of [L18] Section 3.3, all 5 s. */
static const char *const schemes[] = {"dem-first", "lommen"};

START_TEST(spring_damper) {
  char out[128];
  cpl_comparison c = {0};
  tdm_error err = {0};
  setup();
  snprintf(out, sizeof out, "%s/out", dir);
  ck_assert_msg(command("env -C " TANDEM_SOURCE_DIR " tandem run dem/foreign/yade/scenes/spring_damper.json --out %s "
                        "--set coupling.scheme=%s",
                        out, schemes[_i]) == 0,
                "%s", command_output);
  ck_assert_msg(scn_spring_damper_compare(out, &c, &err) == TDM_OK, "%s", err.message);
  for (int k = 0; k < 2; k++) {
    printf("%s: nse of %s: %.6f\n", schemes[_i], c.curve[k].name, cpl_comparison_nse(&c, &c.curve[k]));
    ck_assert_double_gt(cpl_comparison_nse(&c, &c.curve[k]), 0.999);
  }
  cpl_comparison_free(&c);
  teardown();
}
END_TEST

TEST_MAIN_ROWS("yade", {conforms, 1}, {moves_as_with_own_dem, 1}, {repeats, 1},
               {faults_are_named, sizeof faults / sizeof faults[0]}, {spring_damper, 2})
