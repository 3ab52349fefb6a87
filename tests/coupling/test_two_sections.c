/* What only both sections of a scene together can get wrong: one file in two places, two gravities. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/surface/stl.h"
#include "tests/command.h"
#include "tests/result_table.h"
#include "tests/test_main.h"

#include <math.h>

static const char *dir;

/* a plate of 0.5 x 0.12 x 0.012 m, drawn from the middle of its upper edge: its centre of mass is far from its origin
 */
static void write_plate(void) {
  static const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  static const int order[6] = {0, 1, 2, 0, 2, 3};
  tdm_vec3 corner[36];
  tdm_error err = {0};
  char file[512];
  for (int k = 0; k < 36; k++) {
    int v = faces[k / 6][order[k % 6]];
    corner[k] = tdm_v3(v & 1 ? 0.5 : 0, v & 2 ? 0.0625 : -0.0625, v & 4 ? 0 : -0.0125);
  }
  snprintf(file, sizeof file, "%s/plate.stl", dir);
  ck_assert_msg(tdm_stl_write(&(tdm_stl){12, corner}, file, &err) == TDM_OK, "%s", err.message);
}

/* a grain that lies on the plate 60 mm from its origin, with some overlap; the plate hangs on a hinge */
static const char scene[] =
    "{\"time\": {\"end\": 0.002, \"dt\": 2e-5},\n"
    " \"coupling\": {\"n\": 5, \"bodies\": [{\"mbd\": \"plate\", \"dem\": \"plate\"}]},\n"
    " \"mbd\": {\"bodies\": [{\"name\": \"plate\", \"shape\": {\"type\": \"mesh\", \"file\": \"plate.stl\", "
    "\"density\": 7800}}],\n"
    "  \"joints\": [{\"name\": \"hold\", \"type\": \"revolute\", \"bodies\": [\"ground\", \"plate\"], \"axis\": [0, 1, "
    "0], \"point\": [0, 0, "
    "0]}]},\n"
    " \"dem\": {\"materials\": [{\"name\": \"m\", \"density\": 2500, \"young_modulus\": 5e6, \"poisson_ratio\": "
    "0.3}],\n"
    "  \"expected_speed\": 0.1,\n"
    "  \"pairs\": [{\"materials\": [\"m\", \"m\"], \"restitution\": 0.1, \"friction\": 0.5}],\n"
    "  \"bodies\": [{\"name\": \"plate\", \"material\": \"m\", \"shapes\": [{\"type\": \"mesh\", \"file\": "
    "\"plate.stl\"}]}],\n"
    "  \"particles\": [{\"type\": \"list\", \"material\": \"m\", \"radius\": 0.01, \"positions\": [[0.06, 0, 0.0098]]}]"
    "}}\n";

static void setup(void) {
  dir = directory_make();
  write_plate();
  write_file(dir, "scene.json", scene);
}

/* The load at the start: the grain pushes the plate down, at its distance from the centre of mass. */
static void expect_held(const char *options, double arm) {
  cpl_table t;
  tdm_error err = {0};
  int status = command("tandem run %s/scene.json --force --strict --out %s/out %s", dir, dir, options);
  ck_assert_msg(status == 0, "%s", command_output);
  read_table(&t, dir, "out/body_plate.csv");
  double fz = cpl_table_column(&t, "fz", &err)[0], my = cpl_table_column(&t, "my", &err)[0];
  ck_assert_msg(fz < -0.5 && fabs(my / fz + arm) < 1e-6, "%s: the load is %g N with the arm %g m, expected %g m",
                options, fz, -my / fz, arm);
  cpl_table_free(&t);
}

/* The file without a placement is one part in both sections, wherever mbd puts and turns its body. */
START_TEST(one_file_is_one_part) {
  setup();
  expect_held("", 0.06 - 0.25);
  expect_held("--set 'mbd.bodies[0].orientation=[0,0,0,1]' --set 'dem.particles[0].positions=[[-0.06,0,0.0098]]'",
              0.25 - 0.06);
  expect_held("--set 'mbd.bodies[0].position=[1.25,2,2.99375]' --set 'dem.particles[0].positions=[[1.06,2,3.0098]]'",
              0.06 - 0.25);
  directory_remove(dir);
}
END_TEST

/* Other ways to say the same place. */
START_TEST(frames_of_a_mesh) {
  setup();
#define MESH "--set dem.bodies[0].shapes[0]."
  expect_held(MESH "frame=world", 0.06 - 0.25);
  expect_held(MESH "frame=body " MESH "'position=[-0.25,0,0.00625]'", 0.06 - 0.25);
  expect_held(MESH "frame=world --set 'mbd.bodies[0].orientation=[0,0,0,1]' " MESH "'orientation=[0,0,0,1]' --set "
                   "'dem.particles[0].positions=[[-0.06,0,0.0098]]'",
              0.25 - 0.06);
  /* the part's origin is where the plate's is, whatever else is drawn from there: this one is 0.1 m further */
  expect_held(MESH "'position=[-0.1,0,0]' " MESH "elsewhere=true", 0.06 - 0.25);
  directory_remove(dir);
}
END_TEST

static void expect_refused(const char *options, const char *words) {
  int status = command("tandem check %s/scene.json %s", dir, options);
  ck_assert_msg(status == 1, "%d: %s", status, command_output);
  expect_output("dem.bodies[0].shapes[0]");
  expect_output(words);
}

/* Another placement of the same file has to be asked for; so it is refused what cannot be meant. */
START_TEST(another_place_is_refused) {
  setup();
  expect_refused(MESH "'position=[-0.1,0,0]'", "stands up to 0.1 m from where mbd has this body");
  expect_refused(MESH "scale=0.5", "from where mbd has this body");
  expect_refused(MESH "frame=body", "from where mbd has this body");
  expect_refused(MESH "'orientation=[0,0,0,1]'", "elsewhere");
  ck_assert_int_eq(command("cp %s/plate.stl %s/copy.stl", dir, dir), 0);
  char options[512];
  snprintf(options, sizeof options, MESH "file=%s/copy.stl " MESH "elsewhere=true", dir);
  expect_refused(options, "remove it");
  directory_remove(dir);
}
END_TEST

/* What is needed to see where a part is. */
START_TEST(check_tells_the_centre) {
  setup();
  ck_assert_int_eq(command("tandem check %s/scene.json", dir), 0);
  expect_output("6.09375 kg");
  expect_output("centre of mass at [0.25, ");
  expect_output("inertia 0.00801392 0.127032 0.134888");
  expect_output("origin of");
  expect_output("at [-0.25, ");
  directory_remove(dir);
}
END_TEST

/* a file in millimetres, in the multibody section alone */
START_TEST(a_part_in_millimetres_is_doubted) {
  setup();
  write_file(dir, "alone.json",
             "{\"time\": {\"end\": 0.1}, \"mbd\": {\"bodies\": [{\"name\": \"plate\", \"shape\": {\"type\": \"mesh\", "
             "\"file\": \"plate.stl\", \"density\": 7800, \"scale\": 1000}}]}}");
  ck_assert_int_eq(command("tandem-mbd check %s/alone.json", dir), 0);
  expect_output("mbd.bodies[0].shape: the mesh gives body \"plate\" a radius of gyration of 149 m and a mass of "
                "6.09e+09 kg; is the file in millimetres?");
  ck_assert_int_eq(command("tandem-mbd check %s/alone.json --strict", dir), 1);
  ck_assert_int_eq(command("tandem-mbd check %s/alone.json --strict --set mbd.bodies[0].shape.scale=1", dir), 0);
  directory_remove(dir);
}
END_TEST

/* Two gravities are doubtful; one at the root of the scene is for both sections. */
START_TEST(one_gravity) {
  setup();
#define RUN "tandem run %s/scene.json --force --out %s/out --set time.end=4e-4 "
  ck_assert_int_eq(command(RUN "--set 'mbd.gravity=[0,-9.81,0]'", dir, dir), 0);
  expect_output("dem.gravity: gravity is [0, 0, -9.81] m/s2 for the particles, but [0, -9.81, 0] for the bodies");
  ck_assert_int_eq(command(RUN "--strict --set 'mbd.gravity=[0,-9.81,0]'", dir, dir), 1);
  expect_output("refused because of --strict");
  ck_assert_int_eq(command(RUN "--strict --set 'mbd.gravity=[0,-9.81,0]' --set 'dem.gravity=[0,-9.81,0]'", dir, dir),
                   0);

  ck_assert_int_eq(command(RUN "--strict --set 'gravity=[0,0,-1.62]'", dir, dir), 0);
  ck_assert_int_eq(command("grep -q '\"gravity\": *\\[' %s/out/scene.json", dir), 0);
  ck_assert_int_eq(command(RUN "--strict --set 'gravity=[0,0,-1.62]' --set 'mbd.gravity=[0,0,-1.62]'", dir, dir), 0);
  ck_assert_int_eq(command(RUN "--set 'gravity=[0,0,-1.62]' --set 'dem.gravity=[0,0,-9.81]'", dir, dir), 1);
  expect_output("dem.gravity: is [0, 0, -9.81] m/s2, but the scene's own");
  ck_assert_int_eq(command(RUN "--set 'gravity=[0,0]'", dir, dir), 1);
  expect_output("gravity: has 2 entries but must have 3");
  directory_remove(dir);
}
END_TEST

/* It is what both solvers fall by: a grain in the air, and the plate on a vertical guide. */
START_TEST(both_fall_by_it) {
  setup();
  cpl_table t;
  tdm_error err = {0};
  ck_assert_int_eq(command("tandem run %s/scene.json --force --out %s/out --set time.end=0.02 --set 'gravity=[0,0,-2]' "
                           "--set 'mbd.joints=[]' --set 'dem.particles[0].positions=[[0,0,5]]'",
                           dir, dir),
                   0);
  read_table(&t, dir, "out/dem.csv");
  ck_assert_double_lt(fabs(cpl_table_column(&t, "particles.velocity.z", &err)[t.nrow - 1] + 0.04), 1e-12);
  cpl_table_free(&t);
  read_table(&t, dir, "out/body_plate.csv");
  ck_assert_double_lt(fabs(cpl_table_column(&t, "vz", &err)[t.nrow - 1] + 0.04), 1e-8);
  cpl_table_free(&t);
  write_file(dir, "alone.json",
             "{\"time\": {\"end\": 0.02, \"dt\": 1e-4}, \"gravity\": [0, 0, -2], \"dem\": {\"materials\": [{\"name\": "
             "\"m\", \"density\": 2500, \"young_modulus\": 5e6, \"poisson_ratio\": 0.3}], \"pairs\": [{\"materials\": "
             "[\"m\", \"m\"], \"restitution\": 0.1, \"friction\": 0.5}], \"particles\": [{\"type\": \"list\", "
             "\"material\": \"m\", \"radius\": 0.01, \"positions\": [[0, 0, 1]]}]}}");
  ck_assert_int_eq(command("tandem-dem run %s/alone.json --out %s/alone", dir, dir), 0);
  read_table(&t, dir, "alone/channels.csv");
  ck_assert_double_lt(fabs(cpl_table_column(&t, "particles.velocity.z", &err)[t.nrow - 1] + 0.04), 1e-12);
  cpl_table_free(&t);
  directory_remove(dir);
}
END_TEST

TEST_MAIN("two sections", one_file_is_one_part, frames_of_a_mesh, another_place_is_refused, check_tells_the_centre,
          a_part_in_millimetres_is_doubted, one_gravity, both_fall_by_it)
