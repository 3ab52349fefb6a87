/* Containers whose walls end, and warnings of what is probably another size or shape than meant. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/adapter/report.h"
#include "dem/watch/guard.h"
#include "protocol/scene/remark.h"
#include "protocol/surface/stl.h"
#include "test_dem_support.h"
#include "tests/test_main.h"

#include <unistd.h>

#define HEAD                                                                                               \
  "{'materials':[{'name':'m','density':2500,'young_modulus':5e6,'poisson_ratio':0.3}],'expected_speed':1," \
  "'pairs':[{'materials':['m','m'],'restitution':0.5,'friction':0.5}],'bodies':[{'name':'b','material':'m',"
#define BUCKET "'shapes':[{'type':'box','side':'inside','size':[0.2,0.2,0.2],'open':['+z']%s}]}],"
#define GRAIN "'particles':[{'type':'list','material':'m','radius':0.01,'positions':[[%s]],'velocity':[%s]}]}"

static rig *bucket(const char *more, const char *position, const char *velocity, const char *gravity) {
  return rig_make(scene_json(HEAD BUCKET "'gravity':%s," GRAIN, more, gravity, position, velocity), 2e-5, 0, NULL);
}

/* Over the rim a grain flies on where the wall ends, and comes back where it does not. */
START_TEST(over_the_rim) {
  rig *ends = bucket(",'edges':true", "0,0,0.15", "1,0,0", "[0,0,0]");
  rig *endless = bucket("", "0,0,0.15", "1,0,0", "[0,0,0]");
  rig_steps(ends, 10000);
  rig_steps(endless, 10000);
  ck_near(ends->data->state.sphere[0].position.x, 0.2, 1e-12);
  ck_assert_double_lt(endless->data->state.sphere[0].position.x, 0.09);
  ck_assert_int_eq(ends->model->nwall, 1);
  rig_free(ends);
  rig_free(endless);
}
END_TEST

/* beside it a grain falls past, and one that flies against it from outside meets it */
START_TEST(from_outside) {
  rig *r = bucket(",'edges':true", "0.3,0,0", "-1,0,0", "[0,0,0]");
  rig_steps(r, 20000);
  ck_assert_double_gt(r->data->state.sphere[0].position.x, 0.11);
  ck_assert_double_gt(r->data->state.pace[0].velocity.x, 0.1);
  rig_free(r);
  r = bucket(",'edges':true", "0.1105,0,0.3", "0,0,0", "[0,0,-9.81]");
  rig_steps(r, 15000);
  ck_near(r->data->state.sphere[0].position.x, 0.1105, 1e-15);
  ck_near(r->data->state.sphere[0].position.z, 0.3 - 4.905 * 0.09, 1e-9);
  rig_free(r);
}
END_TEST

/* Inside it is what the planes are: a grain that bounces and rolls into a corner takes the same path. */
START_TEST(inside_it_is_the_same) {
  rig *plates = bucket(",'edges':true", "0.05,0.03,-0.05", "0.7,0.4,0", "[0,0,-9.81]");
  rig *planes = bucket(",'edges':false", "0.05,0.03,-0.05", "0.7,0.4,0", "[0,0,-9.81]");
  for (int k = 0; k < 5; k++) {
    rig_steps(plates, 5000);
    rig_steps(planes, 5000);
    tdm_vec3 off = tdm_sub(plates->data->state.sphere[0].position, planes->data->state.sphere[0].position);
    ck_assert_msg(tdm_norm(off) < 1e-9, "after %d steps: %g m apart", 5000 * (k + 1), tdm_norm(off));
  }
  ck_assert_double_gt(tdm_norm(planes->data->state.body_load[0].force), 0);
  rig_free(plates);
  rig_free(planes);
}
END_TEST

/* ---- warnings ---- */

/* how many warnings of this scene's report have the path and the words */
static int count_warnings(json_t *json, const char *path, const char *words) {
  rig *r = rig_make(json, 2e-5, 0, NULL);
  dem_report report;
  int n = 0;
  tdm_error err = {0};
  ck_assert(!dem_report_make(&report, r->data, &(dem_settled){.rest = true, .pressed = true}, 0, &err));
  for (int k = 0; k < report.nwarning; k++)
    n += strstr(report.warning[k].path, path) && strstr(report.warning[k].message, words);
  json_decref(report.json);
  rig_free(r);
  return n;
}

/* A wall that is met beyond the rim is told of while running; not inside, nor where the scene says what its walls are.
 */
START_TEST(beyond_the_rim) {
  static const struct {
    const char *more, *position;
    int remarks;
  } cases[] = {{"", "0.0905,0,0.15", 1},
               {"", "0.0905,0,0.05", 0},
               {"", "0.0905,0,0.105", 0}, /* on the rim */
               {"", "0.3,0,-0.0905", 1},  /* beside it, on the plane of its floor */
               {",'edges':false", "0.0905,0,0.15", 0},
               {",'edges':true", "0.0905,0,0.15", 0}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    rig *r = bucket(cases[k].more, cases[k].position, "0,0,0", "[0,0,0]");
    tdm_remarks said = {0};
    tdm_error err = {0};
    tdm_remarks_open(&said);
    rig_steps(r, 1);
    r->data->state.nstep = (uint64_t)r->model->guard.every;
    ck_assert(dem_guard(r->data, 1, 2e-5, &err) == TDM_OK);
    tdm_remarks_open(NULL);
    int n = 0;
    for (int i = 0; i < said.count; i++)
      n += strcmp(said.entry[i].event, "rim") == 0;
    ck_assert_msg(n == cases[k].remarks, "case %zu: %d", k, n);
    if (n)
      ck_assert(strstr(said.entry[0].message, "beyond its rim") && !strcmp(said.entry[0].path, "dem.bodies[0].shapes"));
    rig_free(r);
  }
}
END_TEST

/* A file in millimetres, one that was scaled twice, and one that is right. */
START_TEST(sizes_of_files) {
  char file[256];
  tdm_vec3 corner[3] = {{0, 0, -5}, {100, 0, -5}, {0, 100, -5}};
  tdm_error err = {0};
  snprintf(file, sizeof file, "%s/bucket_%d.stl", TANDEM_TEST_DIR, (int)getpid());
  ck_assert(!tdm_stl_write(&(tdm_stl){1, corner}, file, &err));
  static const struct {
    double scale;
    const char *words;
    int warnings;
  } cases[] = {
      {1, "100 m wide, 5e+03 diameters of the largest particle; is the file in millimetres? Give \"scale\": 0.001", 1},
      {0.001, "wide", 0},
      {1e-6, "0.0001 m wide, 0.005 diameters", 1}};
  for (int k = 0; k < 3; k++) {
    json_t *json = scene_json(HEAD "'shapes':[{'type':'mesh','file':'%s','scale':%g}]}]," GRAIN, file, cases[k].scale,
                              "0,0,3", "0,0,0");
    int n = count_warnings(json, "dem.bodies[0].shapes[0].scale", cases[k].words);
    ck_assert_msg(n == cases[k].warnings, "scale %g: %d", cases[k].scale, n);
  }
  unlink(file);
}
END_TEST

START_TEST(refused) {
  static const char *const boxes[][2] = {
      {"'side':'outside','edges':true", "edges"},
      {"'side':'inside','edges':true,'lid':{'face':'+z','gap':0}", "edges"},
      {"'side':'inside','edges':1", "edges"},
      {"'side':'inside','edges':true,'open':['-x','+x','-y','+y','-z','+z']", "open"}};
  for (size_t k = 0; k < sizeof boxes / sizeof *boxes; k++) {
    json_t *json = scene_json(HEAD "'shapes':[{'type':'box','size':[1,1,1],%s}]}]}", boxes[k][0]);
    tdm_error err = rig_refused(json, NULL);
    ck_assert_msg(strstr(err.path, boxes[k][1]), "%s: %s", err.path, err.message);
  }
}
END_TEST

TEST_MAIN("dem_bucket", over_the_rim, from_outside, inside_it_is_the_same, beyond_the_rim, sizes_of_files, refused)
