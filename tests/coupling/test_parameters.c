/* Parameters as a user meets them: runs, checks, results, the report, pictures, sweeps. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/command.h"
#include "tests/test_main.h"

#include <jansson.h>
#include <math.h>

static const char *dir;

static json_t *read_json(const char *name) {
  char file[256];
  snprintf(file, sizeof file, "%s/%s", dir, name);
  json_t *json = json_load_file(file, 0, NULL);
  ck_assert_msg(json != NULL, "no %s", name);
  return json;
}

static double number(const json_t *json, const char *section, const char *key) {
  const json_t *value = json_object_get(json_object_get(json, section), key);
  ck_assert_msg(json_is_number(value), "%s.%s is no number", section, key);
  return json_number_value(value);
}

/* A bob on a pivot, driven or falling; the same with numbers. */
static const char swing[] =
    "{'title': 'a swing', 'parameters': {'omega': '=rpm*2*pi/60', 'rpm': 30, 'mode': 1, 'l': 0.5, 'spare': 7},\n"
    " 'time': {'end': '=0.1*5'}, 'output': {'interval': 0.01, 'particles_interval': '=l/5',\n"
    "  'pictures': [{'if': '=mode == 2', 'name': 'no', 'times': [0]}, {'name': 'yes', 'times': ['=l/10']}]},\n"
    " 'mbd': {'gravity': [0, '=-9.81', 0],\n"
    "  'bodies': [\n"
    "   {'if': '=mode == 2', 'name': 'other', 'mass': 1, 'inertia': [1, 1, 1], 'position': [0, 0, 0]},\n"
    "   {'name': 'bob', 'mass': '=4*l', 'inertia': [0.1, 0.1, 0.1], 'position': ['=l', 0, 0]}],\n"
    "  'joints': [{'name': 'pivot', 'type': 'revolute', 'bodies': ['ground', 'bob'], 'point': [0, 0, 0],\n"
    "   'axis': [0, 0, 1]}],\n"
    "  'drivers': [{'if': '=mode == 1', 'name': 'motor', 'type': 'rotational_motor', 'joint': 'pivot',\n"
    "   'motion': {'type': 'constant_rate', 'start': 'smooth', 'rise': 0.1, 'rate': '=omega'}}]}}\n";
static const char plain[] =
    "{'title': 'a swing', 'time': {'end': 0.5}, 'output': {'interval': 0.01},\n"
    " 'mbd': {'gravity': [0, -9.81, 0],\n"
    "  'bodies': [{'name': 'bob', 'mass': 2, 'inertia': [0.1, 0.1, 0.1], 'position': [0.5, 0, 0]}],\n"
    "  'joints': [{'name': 'pivot', 'type': 'revolute', 'bodies': ['ground', 'bob'], 'point': [0, 0, 0],\n"
    "   'axis': [0, 0, 1]}],\n"
    "  'drivers': [{'name': 'motor', 'type': 'rotational_motor', 'joint': 'pivot',\n"
    "   'motion': {'type': 'constant_rate', 'start': 'smooth', 'rise': 0.1, 'rate': 3.141592653589793}}]}}\n";

START_TEST(a_run_with_expressions_has_the_bits_of_one_with_numbers) {
  dir = directory_with_scene(plain);
  ck_assert_int_eq(command("tandem-mbd run %s/scene.json --out %s/plain --no-plots", dir, dir), 0);
  char text[4096];
  strcpy(text, swing);
  double_quotes(text);
  write_file(dir, "swing.json", text);
  ck_assert_msg(command("tandem-mbd run %s/swing.json --out %s/out --no-plots", dir, dir) == 0, "%s", command_output);
  expect_output("notice: ");
  expect_output("swing.json:1:94: parameters.spare: no expression uses spare of the 5 parameters");
  ck_assert_int_eq(command("cmp %s/plain/channels.csv %s/out/channels.csv", dir, dir), 0);
  /* what is stored: the scene as written, the values beside it */
  json_t *scene = read_json("out/scene.json"), *summary = read_json("out/summary.json");
  ck_assert_str_eq(json_string_value(json_object_get(json_object_get(scene, "parameters"), "omega")), "=rpm*2*pi/60");
  ck_assert_double_eq_tol(number(summary, "parameters", "omega"), M_PI, 1e-15);
  ck_assert_double_eq(number(summary, "parameters", "rpm"), 30);
  ck_assert_uint_eq(json_array_size(json_object_get(json_object_get(scene, "mbd"), "bodies")), 2);
  json_decref(scene);
  json_decref(summary);
  ck_assert(is_there(dir, "out", "picture_yes_000.png"));
  ck_assert(!is_there(dir, "out", "picture_no_000.png"));
  /* it runs again from there, draws its pictures, and has a report */
  ck_assert_int_eq(command("tandem-mbd run %s/out/scene.json --out %s/again --no-plots", dir, dir), 0);
  ck_assert_int_eq(command("cmp %s/plain/channels.csv %s/again/channels.csv", dir, dir), 0);
  ck_assert_msg(command("tandem draw %s/out --view yes --out %s/drawn.png", dir, dir) == 0, "%s", command_output);
  ck_assert_int_eq(command("tandem report %s/out", dir), 0);
  ck_assert_int_eq(command("grep -q '<h3>Parameters</h3>' %s/out/index.html", dir), 0);
  ck_assert_int_eq(command("grep -q '>omega</td><td class=\"text\">3.14159</td><td class=\"text\">=rpm\\*2\\*pi/60<' "
                           "%s/out/index.html",
                           dir),
                   0);
  directory_remove(dir);
}
END_TEST

START_TEST(overrides_and_checks) {
  dir = directory_with_scene(swing);
  ck_assert_int_eq(command("tandem-mbd check %s/scene.json --set parameters.rpm=150", dir), 0);
  expect_output("parameters\n");
  expect_output("  omega                        15.7079632679 =rpm*2*pi/60\n");
  expect_output("  rpm                          150\n");
  ck_assert_int_eq(command("tandem-mbd check %s/scene.json --set 'parameters.rpm==l*100'", dir), 0);
  expect_output("  rpm                          50 =l*100\n");
  ck_assert_int_eq(command("tandem-mbd check %s/scene.json --set parameters.rmp=150", dir), 2);
  expect_output("--set parameters.rmp: the scene has no such parameter; did you mean \"rpm\"?");
  ck_assert_int_eq(command("tandem-mbd check %s/scene.json --set 'mbd.bodies[1].mass==-l'", dir), 1);
  expect_output("scene.json:7:20: mbd.bodies[1].mass: ");
  expect_output("must be greater than 0");
  expect_output("(the value of \"=-l\": change it or a parameter)");
  ck_assert_int_eq(command("tandem-mbd check %s/scene.json --set parameters.rpm==omega", dir), 1);
  expect_output("scene.json:1:37: parameters.omega: \"=rpm*2*pi/60\" needs itself (omega needs rpm needs omega)");
  directory_remove(dir);
}
END_TEST

/* A box on a spring with particles in it; a plate and a body are left out. */
static const char shaken[] =
    "{'scenario': 'spring_damper', 'parameters': {'k': 500, 'n': 5, 'plate': 0, 'mu': '=min(0.5, k/1000)'},\n"
    " 'time': {'end': 0.1, 'dt': 2e-4},\n"
    " 'coupling': {'n': '=n', 'bodies': [{'mbd': 'box', 'dem': 'box'}]},\n"
    " 'mbd': {'bodies': [\n"
    "   {'if': '=plate', 'name': 'plate', 'mass': 1, 'inertia': [1, 1, 1], 'position': [0, 0, 9]},\n"
    "   {'name': 'box', 'mass': 10, 'inertia': [1, 1, 1], 'position': [0, 0, 0]}],\n"
    "  'joints': [{'name': 'guide', 'type': 'prismatic', 'bodies': ['ground', 'box'], 'point': [0, 0, 0],\n"
    "   'axis': [0, 0, 1]}],\n"
    "  'forces': [{'name': 'spring', 'type': 'spring_damper', 'bodies': ['ground', 'box'],\n"
    "   'points': [[0, 0, 3], [0, 0, 0]], 'stiffness': '=k', 'damping': '=k/10', 'preload': 10}]},\n"
    " 'dem': {'materials': [{'name': 'm', 'density': 1000, 'young_modulus': 1e7, 'poisson_ratio': 0.2}],\n"
    "  'pairs': [{'materials': ['m', 'm'], 'restitution': 0.9, 'friction': '=mu'}],\n"
    "  'bodies': [\n"
    "   {'if': '=plate', 'name': 'plate', 'material': 'm', 'shapes': [{'type': 'plane'}]},\n"
    "   {'name': 'box', 'material': 'm',\n"
    "    'shapes': [{'type': 'box', 'size': [0.3, 0.3, 0.8], 'side': 'inside'}]}],\n"
    "  'particles': [{'type': 'random', 'material': 'm', 'count': 20, 'radius': 0.05, 'total_mass': 20,\n"
    "   'region': {'min': [-0.15, -0.15, -0.4], 'max': [0.15, 0.15, 0.4]}}],\n"
    "  'settle': {'speed': 5e-3}}}\n";

START_TEST(coupled_runs) {
  dir = directory_with_scene(shaken);
  ck_assert_msg(command("tandem run %s/scene.json --out %s/out", dir, dir) == 0, "%s", command_output);
  json_t *summary = read_json("out/summary.json");
  ck_assert_double_eq(number(summary, "settings", "coupling.n"), 5);
  ck_assert_double_eq(number(summary, "parameters", "mu"), 0.5);
  json_decref(summary);
  ck_assert_int_eq(command("tandem report %s/out", dir), 0); /* with its comparison: it reads the stored scene */
  expect_output("shows the run");
  ck_assert(is_there(dir, "out", "comparison.png"));
  ck_assert_int_eq(command("tandem check %s/scene.json", dir), 0);
  expect_output("  mu                           0.5 =min(0.5, k/1000)");
  /* errors of both solvers' processes and of the server name the line, with the index as written */
  static const char *const cases[][3] = {
      {"'dem.bodies[1].shapes[0].size[0]==-k'",
       "scene.json:16:32: dem.bodies[1].shapes[0].size: ", "lengths must be greater than 0 (the value of \"=-k\""},
      {"'mbd.bodies[1].mass==-k'", "scene.json:6:20: mbd.bodies[1].mass: ", "(the value of \"=-k\""},
      {"'parameters.n=2.5'", "scene.json:3:15: coupling.n: is 2.5 but must be a whole number", "round(), floor()"},
      {"'dem.bodies[1].colour=1'", "scene.json:15:4: dem.bodies[1].colour: ", "unknown key"}};
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    ck_assert_int_eq(command("tandem check %s/scene.json --set %s", dir, cases[i][0]), 1);
    expect_output(cases[i][1]);
    expect_output(cases[i][2]);
  }
  directory_remove(dir);
}
END_TEST

START_TEST(a_sweep_over_a_parameter) {
  dir = directory_with_scene(shaken);
  ck_assert_msg(command("tandem sweep %s/scene.json --set 'parameters.k=500,=max(600, 700)' --set parameters.n=5,10 "
                        "--out %s/s",
                        dir, dir) == 0,
                "%s", command_output);
  expect_output("k=500 n=5: ");
  json_t *sweep = read_json("s/sweep.json"), *rows = json_object_get(sweep, "rows");
  ck_assert_uint_eq(json_array_size(rows), 4);
  for (size_t i = 0; i < 4; i++) {
    const json_t *row = json_array_get(rows, i);
    ck_assert_msg(strcmp(json_string_value(json_object_get(row, "status")), "failed") != 0, "%s", command_output);
    ck_assert_double_eq(number(row, "settings", "parameters.k"), i < 2 ? 500 : 700);
    ck_assert_double_eq(number(row, "settings", "parameters.n"), i % 2 == 0 ? 5 : 10);
    ck_assert_int_eq(json_integer_value(json_object_get(row, "n")), i % 2 == 0 ? 5 : 10);
  }
  json_decref(sweep);
  /* k decides friction only where it is below 500: all beds are the same */
  ck_assert_int_eq(command("sh -c 'test $(ls -d %s/s/bed_* | wc -l) = 2'", dir), 0);
  ck_assert_int_eq(command("tandem sweep %s/scene.json --set 'parameters.k=500,=max(600, 700)' --set parameters.n=5,10 "
                           "--out %s/s --resume",
                           dir, dir),
                   0);
  expect_output("4 of 4 cells are there already");
  ck_assert_int_eq(command("tandem sweep %s/scene.json --set parameters.kk=500,700 --out %s/t", dir, dir), 2);
  expect_output("--set parameters.kk: the scene has no such parameter; it has \"k\"");
  ck_assert(!is_there(dir, "t", "sweep.json"));
  directory_remove(dir);
}
END_TEST

TEST_MAIN("parameters", a_run_with_expressions_has_the_bits_of_one_with_numbers, overrides_and_checks, coupled_runs,
          a_sweep_over_a_parameter)
