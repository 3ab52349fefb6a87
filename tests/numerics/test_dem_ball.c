/* Spheres as walls: geometry, impacts, motion inside one, outputs. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/bodies/walls.h"
#include "dem/geometry/shape/rows.h"
#include "dem/output/view.h"
#include "dem/watch/limits.h"
#include "test_dem_support.h"
#include "tests/test_main.h"

#define SCENE(gravity, contact, body, particle)                                                                     \
  "{'gravity':" gravity ",'contact':{" contact "},'materials':[{'name':'m','density':2500}],"                       \
  "'pairs':[{'materials':['m','m'],'restitution':1,'stiffness':1e7}],'bodies':[{'name':'b','material':'m',"         \
  "'position':[1,2,3],'shapes':[{'type':'sphere'," body "}]}],'particles':[{'type':'list','material':'m','radius':" \
  "0.01," particle "}]}"
#define SMOOTH "'normal':'hooke','tangential':'none'"

START_TEST(geometry) {
  rig *r = rig_make(
      scene_json(SCENE("[0,0,0]", SMOOTH, "'radius':0.5,'center':[0,0,1],'surface_rotation':{'axis':[0,0,1],'rate':2}",
                       "'positions':[[9,9,9]]")),
      1e-5, 0, NULL);
  const dem_wall *w = &r->model->wall[0];
  const dem_wall_place *at = &r->data->state.wall[0];
  tdm_vec3 n;
  ck_assert_ptr_eq(w->shape, &dem_shape_sphere);
  ck_near(dem_wall_gap(w, at, tdm_v3(1 + 0.6, 2, 4 + 0.8), &n), 0.5, 1e-14);
  ck_vector(n, tdm_v3(0.6, 0, 0.8), 1e-14);
  ck_near(dem_wall_gap(w, at, tdm_v3(1, 2.25, 4), &n), -0.25, 1e-14);
  ck_vector(n, tdm_v3(0, 1, 0), 1e-14);
  ck_near(dem_wall_gap(w, at, tdm_v3(1, 2, 4), &n), -0.5, 1e-14);
  ck_near(tdm_norm(n), 1, 1e-14);
  ck_assert(!w->endless && w->solid);
  double low, high;
  ck_assert(dem_wall_extent(w, at, tdm_v3(0, 0.6, 0.8), &low, &high));
  ck_near(low, 0.6 * 2 + 0.8 * 4 - 0.5, 1e-14);
  ck_near(high, 0.6 * 2 + 0.8 * 4 + 0.5, 1e-14);
  /* a belt round its axis */
  ck_vector(dem_wall_surface(w, at, tdm_v3(1.5, 2, 4), tdm_v3(1, 0, 0)), tdm_v3(0, 1, 0), 1e-14);
  ck_near(dem_wall_belt_speed(w), 1, 1e-14);
  /* outputs */
  dem_bounds b = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  dem_wall_bounds(w, &r->data->state.pose[w->body], &b);
  ck_vector(b.low, tdm_v3(0.5, 1.5, 3.5), 1e-14);
  ck_vector(b.high, tdm_v3(1.5, 2.5, 4.5), 1e-14);
  dem_polygons all = {0};
  tdm_error err = {0};
  ck_assert(dem_polygons_make(&all, r->data, &b, &err) == TDM_OK);
  double area = 0;
  for (int k = 0; k < all.count; k++) {
    tdm_vec3 c[4];
    for (int i = 0; i < 4; i++)
      c[i] = tdm_pose_point(r->data->state.pose[all.polygon[k].body], all.polygon[k].corner[i]);
    ck_assert(all.polygon[k].solid);
    for (int i = 0; i < 4; i++)
      ck_near(tdm_norm(tdm_sub(c[i], tdm_v3(1, 2, 4))), 0.5, 1e-14);
    area += 0.5 * tdm_norm(tdm_cross(tdm_sub(c[2], c[0]), tdm_sub(c[3], c[1])));
  }
  ck_relative(area, M_PI, 0.01);
  dem_polygons_free(&all);
  rig_free(r);
}
END_TEST

/* A ball that is hit off its middle turns the velocity round the line of centres; the force goes through its centre. */
START_TEST(oblique_impact) {
  rig *r =
      rig_make(scene_json(SCENE("[0,0,0]", SMOOTH, "'radius':0.05", "'positions':[[1.036,2,3.1]],'velocity':[0,0,-1]")),
               1e-6, 0, NULL);
  const dem_data *d = r->data;
  bool touched = false;
  for (int k = 0; k < 100000; k++) {
    rig_steps(r, 1);
    if (tdm_norm(d->state.body_load[0].force) > 0) {
      touched = true;
      ck_near(tdm_norm(d->state.body_load[0].moment), 0, 1e-12 * tdm_norm(d->state.body_load[0].force));
    }
  }
  ck_assert(touched);
  /* centres are 0.06 m apart at first touch: n = (0.6, 0, 0.8), v' = v - 2 (v n) n */
  ck_vector(d->state.pace[0].velocity, tdm_v3(0.96, 0, 0.28), 1e-3);
  ck_near(tdm_norm(d->state.pace[0].velocity), 1, 2e-4);
  rig_free(r);
}
END_TEST

/* Inside a hollow ball a smooth particle is a pendulum of the length R - r. */
START_TEST(swings_inside) {
  rig *r = rig_make(
      scene_json(SCENE("[0,0,-9.81]", SMOOTH, "'radius':0.21,'side':'inside'", "'positions':[[1.002,2,2.80001]]")),
      1e-5, 0, NULL);
  const dem_data *d = r->data;
  ck_assert(r->model->wall[0].endless && !r->model->wall[0].solid);
  double before = 0, crossing[3] = {0};
  int n = 0;
  for (long k = 1; k < 400000 && n < 3; k++) {
    double x = d->state.sphere[0].position.x - 1;
    rig_steps(r, 1);
    double now = d->state.sphere[0].position.x - 1;
    before = x;
    if (before > 0 && now <= 0)
      crossing[n++] = ((double)k - 1 + before / (before - now)) * 1e-5;
  }
  ck_assert_int_eq(n, 3);
  ck_relative(crossing[2] - crossing[1], 2 * M_PI * sqrt(0.2 / 9.81), 1e-3);
  rig_free(r);
}
END_TEST

/* a ball may be coupled: its load is the reaction, at its centre of mass */
START_TEST(a_coupled_ball) {
  tdm_assigned_body ball = {.name = "b", .mass = 1, .state = state_at(0, 0, 0)};
  rig *r =
      rig_make(scene_json("{'contact':{" SMOOTH "},'materials':[{'name':'m','density':2500}],'pairs':["
                          "{'materials':['m','m'],'restitution':1,'stiffness':1e5}],'bodies':[{'name':'b',"
                          "'material':'m','shapes':[{'type':'sphere','radius':0.05,'center':[0,0,0.1]}]}],"
                          "'particles':[{'type':'list','material':'m','radius':0.01,'positions':[[0.0599,0,0.1]]}]}"),
               1e-5, 1, &ball);
  rig_steps(r, 1);
  const tdm_wrench *load = &r->data->state.body_load[0];
  ck_assert_double_lt(load->force.x, -1);
  ck_near(load->moment.y, 0.1 * load->force.x, 1e-5 * fabs(load->force.x));
  rig_free(r);
}
END_TEST

static void ck_refused(const char *body, const char *path, const char *words) {
  json_t *json = scene_json("{'contact':{" SMOOTH
                            "},'materials':[{'name':'m','density':1}],'bodies':[{'name':'b','material':'m','shapes':["
                            "{'type':'sphere',%s}]}]}",
                            body);
  tdm_error err = rig_refused(json, NULL);
  ck_assert_msg(strstr(err.path, path) && strstr(err.message, words), "%s: %s", err.path, err.message);
}

START_TEST(refused) {
  ck_refused("'radius':0", "radius", "greater than 0");
  ck_refused("'center':[0,0,0]", "radius", "missing");
  ck_refused("'radius':1,'side':'beside'", "side", "inside");
  ck_refused("'radius':1,'size':[1,1,1]", "size", "unknown");
}
END_TEST

TEST_MAIN("dem_ball", geometry, oblique_impact, swings_inside, a_coupled_ball, refused)
