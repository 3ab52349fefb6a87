/* The scenarios' reference solutions: against their own equations, and against hand-made cases. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/rigid_fill.h"
#include "scenarios/spring_damper/reference.h"
#include "scenarios/table.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <math.h>

START_TEST(the_oscillator_obeys_its_equation) {
  const scn_spring_damper_parameters p = {
      .mass = 361.8, .damping = 500, .stiffness = 5000, .preload = 100, .gravity = 9.81};
  double x, v;
  scn_spring_damper_exact(&p, 0, &x, &v);
  ck_assert_double_eq_tol(x, 0, 1e-15);
  ck_assert_double_eq_tol(v, 0, 1e-15);
  for (double t = 0.05; t < 5; t += 0.37) {
    const double h = 1e-4;
    double before[2], after[2];
    scn_spring_damper_exact(&p, t, &x, &v);
    scn_spring_damper_exact(&p, t - h, &before[0], &before[1]);
    scn_spring_damper_exact(&p, t + h, &after[0], &after[1]);
    ck_assert_double_eq_tol((after[0] - before[0]) / (2 * h), v, 1e-6);
    double acceleration = (after[1] - before[1]) / (2 * h);
    double rest = p.mass * p.gravity - p.preload - p.damping * v - p.stiffness * x;
    ck_assert_double_eq_tol(p.mass * acceleration, rest, 1e-3);
  }
  scn_spring_damper_exact(&p, 100, &x, &v);
  ck_assert_double_eq_tol(x, (361.8 * 9.81 - 100) / 5000, 1e-9); /* 0.6899 m */
}
END_TEST

START_TEST(a_rigid_fill_is_box_and_fill_about_the_pivot) {
  /* two point-like particles of 1 kg at (2, 0) and (1, 1); box of 3 kg at (1.5, 0) with I = 0.5 */
  tdm_error err = {0};
  scn_rigid_fill f = {0};
  scn_result r = {0};
  r.scene = json_loads("{\"mbd\": {\"gravity\": [0, -9.81, 0], \"bodies\": [{\"mass\": 3, \"inertia\": [1, 1, 0.5],"
                       "\"position\": [1.5, 0, 0]}]}}",
                       0, NULL);
  r.summary = json_loads("{\"solvers\": {\"dem\": {\"report\": {\"fill\": {\"mass\": 2, \"com\": [1.5, 0.5, 0],"
                         "\"inertia\": [0,0,0, 0,0,0, 0,0,1.0]}}}}}",
                         0, NULL);
  ck_assert_int_eq(scn_rigid_fill_read(&r, &f, &err), TDM_OK);
  ck_assert_double_eq_tol(f.mass, 5, 1e-14);
  ck_assert_double_eq_tol(f.x, 1.5, 1e-14);
  ck_assert_double_eq_tol(f.y, 0.2, 1e-14);
  ck_assert_double_eq_tol(f.fill_inertia, 4 + 2, 1e-14); /* sum of m |x|^2 */
  ck_assert_double_eq_tol(f.inertia, 0.5 + 3 * 2.25 + 6, 1e-14);
  ck_assert_double_eq_tol(f.gravity, 9.81, 1e-14);
  scn_result_free(&r);
}
END_TEST

/* A result directory with what the stream's comparison reads; the histories are those of a cube that never moved. */
static const char *stream_result(void) {
  const char *dir = directory_make();
  write_file(
      dir, "scene.json",
      "{\"coupling\": {\"bodies\": [{\"mbd\": \"cube\"}]}, \"mbd\": {\"bodies\": [{\"mass\": 1, \"position\": [0.5, 0, "
      "0]}]},"
      "\"dem\": {\"pairs\": [{\"restitution\": 1}], \"bodies\": [{\"shapes\": [{\"size\": [1, 1, 1]}]}],"
      "\"sources\": [{\"mass\": 1, \"radius\": 0.1, \"rate\": 1, \"velocity\": [2, 0, 0], \"position\": [-1.1, 0, 0],"
      "\"relative_to\": {\"factor\": -1}}]}}");
  write_file(dir, "summary.json", "{}");
  write_file(dir, "body_cube.csv", "time [s],x [m],vx [m/s]\n0,0.5,0\n0.4,0.5,0\n0.6,0.5,0\n0.9,0.5,0\n2,0.5,0\n");
  write_file(dir, "mbd.csv", "time [s],a [1]\n0,0\n");
  write_file(dir, "dem.csv", "time [s],source.feeder.waiting [1]\n0,0\n");
  return dir;
}

START_TEST(the_stream_is_the_exact_sequence) {
  /* equal masses, e = 1: the first particle (2 m/s, 1 m of way) hits at 0.5 s and gives the cube its whole speed. The
   * second starts at 1 s with 2 - 2 = 0 m/s and never arrives. */
  const char *dir = stream_result();
  tdm_error err = {0};
  cpl_comparison c = {0};
  ck_assert_msg(scn_stream_compare(dir, &c, &err) == TDM_OK, "%s", err.message);
  const double x[] = {0, 0, 0.2, 0.8, 3}, v[] = {0, 0, 2, 2, 2};
  for (int i = 0; i < 5; i++) {
    ck_assert_double_eq_tol(c.curve[0].reference[i], x[i], 1e-12);
    ck_assert_double_eq_tol(c.curve[1].reference[i], v[i], 1e-12);
  }
  cpl_comparison_free(&c);
  write_file(dir, "dem.csv", "time [s],source.feeder.waiting [1]\n0,1\n");
  ck_assert_int_eq(scn_stream_compare(dir, &c, &err), TDM_ERR_SCENE); /* particles that wait are not in it */
  cpl_comparison_free(&c);
  directory_remove(dir);
}
END_TEST

/* Both readings of "their own initial speed of 2 m/s minus the current speed of the cube", with the scene's numbers. */
START_TEST(two_readings_of_the_stream) {
  static const struct {
    const char *factor;
    double v;                                     /* at 20 s [m/s] */
  } readings[] = {{"-1", 0.1749}, {"0", 0.1830}}; /* launched at 2 m/s less the cube's speed; at 2 m/s */
  for (int k = 0; k < 2; k++) {
    const char *dir = stream_result();
    char scene[640];
    tdm_error err = {0};
    cpl_comparison c = {0};
    snprintf(scene, sizeof scene,
             "{\"coupling\": {\"bodies\": [{\"mbd\": \"cube\"}]}, \"mbd\": {\"bodies\": [{\"mass\": 10, \"position\": "
             "[0.1, 0, 0]}]}, \"dem\": {\"pairs\": [{\"restitution\": 0.5}], \"bodies\": [{\"shapes\": [{\"size\": "
             "[0.2, 0.2, 0.2]}]}], \"sources\": [{\"mass\": 0.01, \"radius\": 0.01, \"rate\": 3.3333333333333335, "
             "\"velocity\": [2, 0, 0], \"position\": [-0.1, 0, 0], \"relative_to\": {\"factor\": %s}}]}}",
             readings[k].factor);
    write_file(dir, "scene.json", scene);
    write_file(dir, "body_cube.csv", "time [s],x [m],vx [m/s]\n0,0.1,0\n20,0.1,0\n");
    ck_assert_msg(scn_stream_compare(dir, &c, &err) == TDM_OK, "%s", err.message);
    ck_assert_double_eq_tol(c.curve[1].reference[1], readings[k].v, 5e-5);
    cpl_comparison_free(&c);
    directory_remove(dir);
  }
}
END_TEST

START_TEST(the_paper_s_table_stands_beside_ours) {
  cpl_table t;
  tdm_error err = {0};
  ck_assert_int_eq(cpl_table_read(&t, TANDEM_SOURCE_DIR "/scenarios/spring_damper/published.csv", &err), TDM_OK);
  ck_assert_int_eq(t.nrow, 14);
  int good = 0; /* r2 of x and of v above 0.99 in 8 and 7 cells, as the paper marks */
  const double *x = cpl_table_column(&t, "r2_x", &err), *v = cpl_table_column(&t, "r2_v", &err);
  for (int i = 0; i < 14; i++)
    good += (x[i] > 0.99) + (v[i] > 0.99);
  ck_assert_int_eq(good, 8 + 7);
  cpl_table_free(&t);
}
END_TEST

TEST_MAIN("references", the_oscillator_obeys_its_equation, a_rigid_fill_is_box_and_fill_about_the_pivot,
          the_stream_is_the_exact_sequence, two_readings_of_the_stream, the_paper_s_table_stands_beside_ours)
