/* tandem calibrate: factors of the laws for contacts that act on each other, for which a scene may have no value, are
 * found back from curves that the scene itself makes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_calibrate_support.h"
#include "tests/test_main.h"

/* A rubber sphere between plates that come together, with neither law nor factor written. */
static const char pressed[] =
    "{'time': {'end': 0.1, 'dt': 1e-4}, 'output': {'interval': 0.005},\n"
    " 'dem': {'gravity': [0, 0, 0], 'guard': {'overlap': 0.9},\n"
    "  'materials': [{'name': 'm', 'density': 2000, 'young_modulus': 1.85e6, 'poisson_ratio': 0.46},\n"
    "   {'name': 's', 'density': 7800, 'young_modulus': 2e11, 'poisson_ratio': 0.3}],\n"
    "  'pairs': [{'materials': ['m', 's'], 'restitution': 0.5}],\n"
    "  'contact': {'tangential': 'none'},\n"
    "  'bodies': [{'name': 'floor', 'material': 's', 'shapes': [{'type': 'plane', 'normal': [0, 0, 1]}]},\n"
    "   {'name': 'plate', 'material': 's', 'position': [0, 0, 0.02], 'shapes': [{'type': 'plane', 'normal': [0, 0, "
    "-1]}],\n"
    "    'motion': {'velocity': [0, 0, -0.06]}}],\n"
    "  'particles': [{'type': 'list', 'material': 'm', 'radius': 0.01, 'positions': [[0, 0, 0.01]]}]}}\n";

/* The curve of force over way that the scene itself has with these settings. */
static void write_own_curve(const char *settings) {
  char file[512], line[8192];
  ck_assert_msg(command("tandem-dem run %s/scene.json %s --out %s/own --force", dir, settings, dir) == 0, "%s",
                command_output);
  snprintf(file, sizeof file, "%s/own/channels.csv", dir);
  FILE *in = fopen(file, "r");
  ck_assert_ptr_nonnull(in);
  int way = -1, force = -1;
  char out[8192] = "dem:body.plate.uz [m],dem:body.plate.fz [N]\n";
  while (fgets(line, sizeof line, in)) {
    double value[2] = {0};
    int k = 0, found = 0;
    for (char *at = strtok(line, ",\n"); at; at = strtok(NULL, ",\n"), k++) {
      way = strncmp(at, "body.plate.uz", 13) == 0 ? k : way;
      force = strncmp(at, "body.plate.fz", 13) == 0 ? k : force;
      if (k == way || k == force) {
        value[k == force] = strtod(at, NULL);
        found += at[0] != 'b';
      }
    }
    if (found == 2)
      snprintf(out + strlen(out), sizeof out - strlen(out), "%.12g,%.12g\n", value[0], value[1]);
  }
  fclose(in);
  write_file(dir, "curve.csv", out);
}

/* gamma and beta, for which the scene has no value: found back from the scene's own curve, and written. */
START_TEST(gamma_and_beta) {
  static const struct {
    const char *law, *key;
    double value;
  } cases[] = {{"mc-strain", "gamma", 0.55}, {"mc-stress", "beta", 1.71}};
  char settings[200];
  dir = directory_with_scene(pressed);
  snprintf(settings, sizeof settings, "--set dem.contact.multi_contact=%s --set dem.pairs[0].%s=%g", cases[_i].law,
           cases[_i].key, cases[_i].value);
  write_own_curve(settings);
  const int status = command("tandem calibrate %s/scene.json --set dem.contact.multi_contact=%s --parameter "
                             "dem.pairs[0].%s --range 0 4 --target %s/curve.csv --out %s/c --write %s/found.json",
                             dir, cases[_i].law, cases[_i].key, dir, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  json_t *c = load("c/calibration.json"), *found = load("found.json");
  expect_status(c, "converged");
  ck_assert_double_eq_tol(number(parameter(c, 0), "value"), cases[_i].value, 0.01);
  ck_assert_double_eq(number(parameter(c, 0), "start"), 2);
  ck_assert_str_eq(text(parameter(c, 0), "determined"), "well");
  ck_assert_double_gt(number(parameter(c, 0), "sensitivity"), 0.1);
  ck_assert(has("c/path.png") && has("c/sensitivity.png"));
  const json_t *pair = json_array_get(json_object_get(json_object_get(found, "dem"), "pairs"), 0);
  ck_assert_double_eq(number(pair, cases[_i].key), number(parameter(c, 0), "value"));
  json_decref(c);
  json_decref(found);
  directory_remove(dir);
}
END_TEST

/* Two at once, one of them in its logarithm. */
START_TEST(gamma_and_modulus) {
  dir = directory_with_scene(pressed);
  write_own_curve("--set dem.contact.multi_contact=mc-strain --set dem.pairs[0].gamma=0.9 --set "
                  "dem.materials[0].young_modulus=1.2e6");
  int status =
      command("tandem calibrate %s/scene.json --set dem.contact.multi_contact=mc-strain --parameter "
              "dem.pairs[0].gamma --range 0 2 --parameter dem.materials[0].young_modulus --range 5e5 5e6 --log "
              "dem.materials[0].young_modulus --target %s/curve.csv --tolerance 1e-3 --out %s/c",
              dir, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  json_t *c = load("c/calibration.json");
  expect_status(c, "converged");
  ck_assert_double_eq_tol(number(parameter(c, 0), "value"), 0.9, 0.02);
  ck_assert_double_eq_tol(number(parameter(c, 1), "value"), 1.2e6, 0.01e6);
  json_decref(c);
  directory_remove(dir);
}
END_TEST

/* A number in a list of lists: how high the second of two balls that nothing touches lies. */
START_TEST(place_in_a_list) {
  dir = directory_with_scene(pressed);
  write_file(dir, "z.csv", "time,dem:particles.com.z\n0,0.125\n0.1,0.125\n");
  const int status =
      command("tandem calibrate %s/scene.json --set dem.bodies=[] --set dem.pairs[0].materials[1]=m --set "
              "dem.particles[0].positions=[[0,0,0.05],[1,0,0.1]] --parameter "
              "dem.particles[0].positions[1][2] --range 0 0.5 --target %s/z.csv --out %s/c",
              dir, dir, dir);
  ck_assert_msg(status == 0, "%s", command_output);
  json_t *c = load("c/calibration.json");
  ck_assert_double_eq_tol(number(parameter(c, 0), "value"), 0.2, 2e-3);
  ck_assert_double_eq(number(parameter(c, 0), "start"), 0.1);
  json_decref(c);
  directory_remove(dir);
}
END_TEST

TEST_MAIN_ROWS("calibrate factors of contacts", {gamma_and_beta, 2}, {gamma_and_modulus, 1}, {place_in_a_list, 1})
