/* tandem advise: settings, reasons, the scene that it writes, and what it refuses. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/command.h"
#include "tests/test_main.h"

#include <jansson.h>
#include <math.h>

/* a box on a spring with 20 particles, and names for numbers */
static const char scene[] =
    "{'parameters': {'mass': 10, 'end': 0.3},\n"
    " 'time': {'end': '=end', 'dt': 2e-5},\n"
    " 'coupling': {'n': 3, 'scheme': 'lommen', 'bodies': [{'mbd': 'box', 'dem': 'box'}]},\n"
    " 'output': {'interval': 1e-3},\n"
    " 'mbd': {'bodies': [{'name': 'box', 'mass': '=mass', 'inertia': [1, 1, 1], 'position': [0, 0, 0]}],\n"
    "  'joints': [{'name': 'guide', 'type': 'prismatic', 'bodies': ['ground', 'box'], 'point': [0, 0, 0],\n"
    "   'axis': [0, 0, 1]}],\n"
    "  'forces': [{'name': 'spring', 'type': 'spring_damper', 'bodies': ['ground', 'box'],\n"
    "   'points': [[0, 0, 3], [0, 0, 0]], 'stiffness': 500, 'damping': 50, 'preload': 10}]},\n"
    " 'dem': {'materials': [{'name': 'm', 'density': 1000, 'young_modulus': 1e7, 'poisson_ratio': 0.2}],\n"
    "  'pairs': [{'materials': ['m', 'm'], 'restitution': 0.5, 'friction': 0.5}],\n"
    "  'bodies': [{'name': 'box', 'material': 'm', 'shapes': [{'type': 'box', 'size': [0.3, 0.3, 0.8],\n"
    "   'side': 'inside'}]}],\n"
    "  'particles': [{'type': 'random', 'material': 'm', 'count': 20, 'radius': 0.05, 'total_mass': 20,\n"
    "   'region': {'min': [-0.15, -0.15, -0.4], 'max': [0.15, 0.15, 0.4]}}],\n"
    "  'settle': {'speed': 5e-3}}}\n";

static json_t *read_json(const char *dir, const char *name) {
  char file[256];
  snprintf(file, sizeof file, "%s/%s", dir, name);
  json_t *json = json_load_file(file, 0, NULL);
  ck_assert_msg(json != NULL, "no %s", name);
  return json;
}

static bool some_reason_has(const json_t *advice, const char *word) {
  const json_t *reasons = json_object_get(advice, "reasons");
  bool found = false;
  for (size_t i = 0; i < json_array_size(reasons); i++)
    found = found || strstr(json_string_value(json_array_get(reasons, i)), word);
  return found;
}

static double number(const json_t *json, const char *group, const char *key) {
  return json_number_value(json_object_get(json_object_get(json, group), key));
}

START_TEST(settings_with_reasons_and_a_scene) {
  const char *dir = directory_with_scene(scene);
  int status =
      command("tandem advise %s/scene.json --out %s/a --json %s/advice.json --write %s/new.json", dir, dir, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  json_t *advice = read_json(dir, "advice.json"), *written = read_json(dir, "new.json");
  json_t *first = read_json(dir, "scene.json");
  ck_assert(json_is_true(json_object_get(advice, "found")));
  static const char *const words[] = {"Rayleigh", "eigenfrequency", "contact time", "coordination number", "WSTIFF"};
  for (int k = 0; k < 5; k++)
    ck_assert_msg(some_reason_has(advice, words[k]), "no reason has %s", words[k]);
  const double dt = number(advice, "settings", "time.dt");
  const json_t *n = json_object_get(json_object_get(advice, "settings"), "coupling.n");
  for (int k = 0; k < 3; k++) {
    static const char *const limits[] = {"rayleigh", "eigenfrequency", "contact"};
    const json_t *limit = json_object_get(json_object_get(advice, "limits"), limits[k]);
    const double time = json_number_value(json_object_get(limit, "time"));
    ck_assert_double_le(dt, time * json_number_value(json_object_get(limit, "share")) * (1 + 1e-9));
  }
  ck_assert_double_gt(dt, 1e-5);
  ck_assert(json_integer_value(n) >= 1 || (json_is_string(n) && strcmp(json_string_value(n), "auto") == 0));
  ck_assert_msg(some_reason_has(advice, "n = \"auto\"") && some_reason_has(advice, "tolerance of the MBD solver"), "%s",
                command_output);
  const double tolerance = number(advice, "settings", "mbd.solver.relative_tolerance");
  ck_assert(tolerance >= 1e-12 && tolerance <= 1e-4);
  ck_assert_str_eq(json_string_value(json_object_get(json_object_get(advice, "settings"), "coupling.scheme")), "proxy");
  ck_assert_double_gt(number(advice, "cost", "wall_s"), 0);
  ck_assert_double_gt(number(advice, "cost", "processor_s"), 0);
  ck_assert_double_le(number(advice, "error", "coupling"), 0.01);
  ck_assert_uint_ge(json_array_size(json_object_get(advice, "trials")), 4);
  size_t i;
  json_t *trial;
  json_array_foreach(json_object_get(advice, "trials"), i, trial)
      ck_assert_double_gt(json_number_value(json_object_get(trial, "processor_s")), 0);
  /* the scene: changed keys alone */
  ck_assert_str_eq(json_string_value(json_object_get(json_object_get(written, "time"), "end")), "=end");
  ck_assert_double_eq(number(written, "time", "dt"), dt);
  ck_assert(json_equal(json_object_get(json_object_get(written, "coupling"), "n"), n));
  ck_assert(json_equal(json_object_get(written, "dem"), json_object_get(first, "dem")));
  ck_assert_msg(command("tandem check %s/new.json", dir) == 0, "%s", command_output);
  expect_output("0 warnings");
  json_decref(first);
  json_decref(advice);
  json_decref(written);
  directory_remove(dir);
}
END_TEST

START_TEST(what_cannot_be_advised) {
  const char *dir = directory_make();
  write_file(dir, "dem.json", "{\"time\": {\"end\": 1, \"dt\": 1e-4}, \"dem\": {\"materials\": []}}");
  ck_assert_int_eq(command("tandem advise %s/dem.json --out %s/a", dir, dir), 1);
  expect_output("tandem-dem check");
  ck_assert_int_eq(command("tandem advise %s/none.json --out %s/a", dir, dir), 1);
  write_file(dir, "bad.json", "{\"time\": ");
  ck_assert_int_eq(command("tandem advise %s/bad.json --out %s/a", dir, dir), 1);
  expect_output("bad.json:1");
  ck_assert_int_eq(command("tandem advise %s/bad.json --error 2", dir), 2);
  expect_output("--error 2");
  ck_assert_int_eq(command("test -e %s/a", dir), 1);
  directory_remove(dir);
}
END_TEST

/* a body without a joint under a heavy fill falls for ever; a scene whose solver ends at once fails in its trials */
START_TEST(a_scene_that_fails_says_why) {
  const char *dir = directory_with_scene(scene);
  ck_assert_int_eq(command("tandem advise %s/scene.json --out %s/a --set coupling.solvers.mbd=/bin/false", dir, dir),
                   1);
  expect_output("mbd");
  directory_remove(dir);
}
END_TEST

/* A body on a strong damper, particles first on a path foreseen (MBD cannot tell its mobility): n = 5 is near n = 1,
 * but jumps at the ends of its windows, which it tells itself; that alone refuses it, and shorter windows are the
 * remedy. */
START_TEST(a_trial_that_expects_too_much_of_an_error_is_refused) {
  const char *dir = directory_make();
  const int status =
      command("env LACKS=mobility tandem advise %s/stability/box.json --out %s/a --error 0.1 "
              "--set coupling.transport=ipc --set coupling.solvers.mbd=lacking_mbd --set parameters.speed=0 "
              "--set parameters.damping=1000",
              TANDEM_SOURCE_DIR "/scenarios", dir);
  ck_assert_msg(status == 0, "%s", command_output);
  json_t *advice = read_json(dir, "a/advice.json");
  ck_assert_msg(some_reason_has(advice, "its own estimate of what the exchange is off"), "%s", command_output);
  ck_assert_msg(some_reason_has(advice, "remedy: n ="), "%s", command_output);
  ck_assert_str_eq(json_string_value(json_object_get(json_object_get(advice, "settings"), "coupling.scheme")),
                   "dem-first");
  ck_assert_double_lt(number(advice, "settings", "coupling.n"), 5);
  json_decref(advice);
  directory_remove(dir);
}
END_TEST

TEST_MAIN("advise", settings_with_reasons_and_a_scene, what_cannot_be_advised, a_scene_that_fails_says_why,
          a_trial_that_expects_too_much_of_an_error_is_refused)
