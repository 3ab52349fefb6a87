/* A wall shape in a file of its own: a torus is added here, without a change anywhere else, read from scenes and used
 * by the engine. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/flow/free_space.h"
#include "dem/geometry/shape/shape.h"
#include "dem/output/view.h"
#include "dem/settle/settle.h"
#include "dem/store/fingerprint.h"
#include "dem/watch/energy_balance.h"
#include "test_dem_support.h"
#include "tests/test_main.h"

/* ---- the shape ---- */

/* "torus": a tube of radius radii[1] whose axis is the circle of radius radii[0] in the own x-y plane; solid, or with
 * "side": "inside" a channel that the particles are in */

static const dem_shape torus;

static void read_torus(tdm_object *o, int body, dem_wall_list *list) {
  dem_wall wall = {.shape = &torus, .body = body};
  tdm_get_numbers(o, "radii", wall.radius, 2, true);
  if (!o->err->status && !(wall.radius[1] > 0 && wall.radius[0] > wall.radius[1]))
    tdm_object_fail(o, "radii", "are [%g, %g] m but the first must be greater than the second, and that than 0",
                    wall.radius[0], wall.radius[1]);
  wall.point = tdm_get_vec3(o, "center", &(tdm_vec3){0, 0, 0});
  wall.turn = tdm_get_orientation(o, "orientation");
  wall.inside = tdm_get_choice(o, "side", dem_sides, 2, 1) == 0;
  wall.endless = wall.inside;
  wall.solid = !wall.inside;
  dem_walls_append(list, wall, o->err);
}

static double gap_of_torus(const dem_wall *wall, tdm_vec3 x, tdm_vec3 *normal) {
  const double rho = hypot(x.x, x.y), across = rho - wall->radius[0], from = hypot(across, x.z);
  const tdm_vec3 outward = rho > 0 ? tdm_v3(x.x / rho, x.y / rho, 0) : tdm_v3(1, 0, 0);
  tdm_vec3 n = from > 0 ? tdm_axpy(x.z / from, tdm_v3(0, 0, 1), tdm_scale(across / from, outward)) : outward;
  *normal = wall->inside ? tdm_scale(-1, n) : n;
  return wall->inside ? wall->radius[1] - from : from - wall->radius[1];
}

static void box_of_torus(const dem_wall *wall, tdm_vec3 *low, tdm_vec3 *high) {
  const double wide = wall->radius[0] + wall->radius[1];
  *high = tdm_v3(wide, wide, wall->radius[1]);
  *low = tdm_scale(-1, *high);
}

static tdm_vec3 on_torus(const dem_wall *wall, double around, double across) {
  const double rho = wall->radius[0] + wall->radius[1] * cos(across);
  return tdm_v3(rho * cos(around), rho * sin(around), wall->radius[1] * sin(across));
}

static void draw_torus(const dem_wall *wall, const dem_wall_view *view, dem_polygons *all, tdm_error *err) {
  enum { SIDES = 48 };
  const double step = 2 * M_PI / SIDES;
  for (int k = 0; k < SIDES * SIDES; k++) {
    dem_polygon p = {.body = wall->body, .solid = wall->solid, .ncorner = 4};
    const int a = k / SIDES, b = k % SIDES;
    const int corner[4][2] = {{a, b}, {a + 1, b}, {a + 1, b + 1}, {a, b + 1}};
    for (int c = 0; c < 4; c++)
      p.corner[c] = dem_wall_world(view->place, on_torus(wall, corner[c][0] * step, corner[c][1] * step));
    dem_polygons_add(all, &p, err);
  }
}

static const dem_shape torus = {
    .type = "torus",
    .number = 1000,
    .read = read_torus,
    .gap = gap_of_torus,
    .box = box_of_torus,
    .polygons = draw_torus,
};

static void add_torus(void) {
  static bool added = false;
  if (!added)
    ck_assert_int_eq(dem_shape_add(&torus, NULL), TDM_OK);
  added = true;
  ck_assert_msg(dem_shape_add(&torus, NULL) == TDM_ERR_ARGUMENT, "a type of a shape is there once");
}

/* ---- the tests ---- */

/* One ball of radius 0.01 and the torus, of radii 0.2 and 0.03, on a body at (0, 0, 1). */
static rig *rig_of(const char *gravity, const char *shape, const char *ball, const char *more) {
  add_torus();
  return rig_make(scene_json("{'gravity':%s,'contact':{'normal':'hooke','tangential':'none'},"
                             "'materials':[{'name':'m','density':2500}],"
                             "'pairs':[{'materials':['m','m'],'restitution':1,'stiffness':1e6}],"
                             "'bodies':[{'name':'b','material':'m','position':[0,0,1],'shapes':[{'type':'torus',%s}]}],"
                             "'particles':[{'type':'list','material':'m','radius':0.01,'positions':[%s]}]%s}",
                             gravity, shape, ball, more),
                  1e-5, 0, NULL);
}

#define UPRIGHT "'radii':[0.2,0.03],'side':'inside','orientation':[0.7071067811865476,0.7071067811865476,0,0]"
static const double length = 0.2 + 0.03 - 0.01; /* of the pendulum that a ball in the upright channel is [m] */

/* In the upright channel a smooth ball swings as a pendulum does, and loses no energy. */
START_TEST(a_ball_swings_in_it) {
  rig *r = rig_of("[0,0,-9.81]", UPRIGHT, "[0.002,0,0.78001]", "");
  dem_data *d = r->data;
  rig_steps(r, 1);
  const dem_stored_energy start = dem_stored_energy_now(d);
  const double height = start.potential / (d->state.mass[0] * 9.81) - 1 + length,
               whole = d->state.mass[0] * 9.81 * height;
  double crossing[3] = {0};
  int n = 0;
  for (long k = 1; k < 300000 && n < 3; k++) {
    double before = d->state.sphere[0].position.x;
    rig_steps(r, 1);
    double now = d->state.sphere[0].position.x;
    if (before > 0 && now <= 0)
      crossing[n++] = ((double)k + before / (before - now)) * 1e-5;
    const dem_stored_energy e = dem_stored_energy_now(d);
    double change = e.kinetic + e.potential + e.elastic - start.kinetic - start.potential - start.elastic;
    ck_assert_double_lt(fabs(change), 1e-2 * whole);
  }
  ck_assert_int_eq(n, 3);
  ck_relative(crossing[2] - crossing[1], 2 * M_PI * sqrt(length / 9.81), 1e-3);
  rig_free(r);
}
END_TEST

/* Settling brings it to rest at the lowest place, on the wall. */
START_TEST(a_ball_rests_in_it) {
  rig *r = rig_of("[0,0,-9.81]", UPRIGHT, "[0.05,0.005,0.8]", ",'settle':{'drag':10}");
  dem_settled settled;
  tdm_error err = {0};
  ck_assert(dem_settle(r->data, NULL, &settled, &err) == TDM_OK && settled.rest);
  const dem_data *d = r->data;
  ck_near(d->state.sphere[0].position.x, 0, 1e-3);
  ck_near(d->state.sphere[0].position.y, 0, 1e-3);
  ck_near(d->state.sphere[0].position.z, 1 - length, 1e-5);
  forces_now(r->data, false);
  ck_relative(d->state.body_load[0].force.z, -9.81 * d->state.mass[0], 0.02);
  rig_free(r);
}
END_TEST

/* No particle is put into the solid; the hole is free. */
START_TEST(there_is_no_room_in_it) {
  rig *r = rig_of("[0,0,0]", "'radii':[0.2,0.03]", "[9,9,9]", "");
  dem_free_space space;
  ck_assert_int_eq(dem_free_space_open(&space, r->data, tdm_v3(-1, -1, 0), tdm_v3(1, 1, 2), 0.01), TDM_OK);
  ck_assert(dem_free_space_free(&space, r->data, tdm_v3(0, 0, 1), 0.01));
  ck_assert(!dem_free_space_free(&space, r->data, tdm_v3(0, 0.2, 1), 0.01));
  ck_assert(!dem_free_space_free(&space, r->data, tdm_v3(0.2 - 0.0399, 0, 1), 0.01));
  ck_assert(dem_free_space_free(&space, r->data, tdm_v3(0.2 - 0.0401, 0, 1), 0.01));
  dem_free_space_close(&space);
  rig_free(r);
}
END_TEST

/* Polygons lie on it and cover it; the bounds of a picture and its extent are those of its box. */
START_TEST(it_is_drawn) {
  rig *r = rig_of("[0,0,0]", "'radii':[0.2,0.03]", "[0,0,1]", "");
  dem_bounds bounds = dem_scene_bounds(r->data);
  ck_near(bounds.low.x, -0.23, 1e-15);
  ck_near(bounds.high.z, 1.03, 1e-15);
  double low, high;
  ck_assert(dem_wall_extent(&r->model->wall[0], &r->data->state.wall[0], tdm_v3(0, 0, 1), &low, &high));
  ck_near(low, 0.97, 1e-15);
  ck_near(high, 1.03, 1e-15);
  dem_polygons all = {0};
  tdm_error err = {0};
  ck_assert(dem_polygons_make(&all, r->data, &bounds, &err) == TDM_OK);
  double area = 0;
  for (int k = 0; k < all.count; k++) {
    tdm_vec3 c[4];
    for (int i = 0; i < 4; i++)
      c[i] = tdm_pose_point(r->data->state.pose[all.polygon[k].body], all.polygon[k].corner[i]);
    tdm_vec3 n;
    ck_near(dem_wall_gap(&r->model->wall[0], &r->data->state.wall[0], c[0], &n), 0, 1e-15);
    area += 0.5 * tdm_norm(tdm_cross(tdm_sub(c[2], c[0]), tdm_sub(c[3], c[1])));
  }
  ck_relative(area, 4 * M_PI * M_PI * 0.2 * 0.03, 0.01);
  dem_polygons_free(&all);
  rig_free(r);
}
END_TEST

static uint64_t fingerprint_of(const char *shape) {
  rig *r = rig_of("[0,0,0]", shape, "[9,9,9]", "");
  uint64_t whole = dem_fingerprint_bed(r->model);
  rig_free(r);
  return whole;
}

START_TEST(its_sizes_are_in_the_fingerprint) {
  uint64_t one = fingerprint_of("'radii':[0.2,0.03]");
  ck_assert(one == fingerprint_of("'radii':[0.2,0.03]"));
  ck_assert(one != fingerprint_of("'radii':[0.2,0.031]"));
  ck_assert(one != fingerprint_of("'radii':[0.21,0.03]"));
  ck_assert(one != fingerprint_of("'radii':[0.2,0.03],'side':'inside'"));
}
END_TEST

/* The reader's own errors, and those of all shapes. */
START_TEST(what_is_wrong_is_told) {
  static const char *const wrong[][3] = {{"'type':'torus','radii':[0.03,0.2]", "radii", "greater than the second"},
                                         {"'type':'torus'", "radii", "missing"},
                                         {"'type':'torus','radii':[0.2,0.03],'ends':true", "ends", "unknown"},
                                         {"'type':'torsus'", "type", "torus"}};
  add_torus();
  for (int k = 0; k < 4; k++) {
    json_t *json = scene_json("{'materials':[{'name':'m','density':1,'young_modulus':1e7,'poisson_ratio':0.3}],"
                              "'bodies':[{'name':'b','material':'m','shapes':[{%s}]}]}",
                              wrong[k][0]);
    tdm_error err = rig_refused(json, NULL);
    ck_assert_msg(strstr(err.path, wrong[k][1]) && strstr(err.message, wrong[k][2]), "%s: %s", err.path, err.message);
  }
}
END_TEST

TEST_MAIN("seam_wall_shape", a_ball_swings_in_it, a_ball_rests_in_it, there_is_no_room_in_it, it_is_drawn,
          its_sizes_are_in_the_fingerprint, what_is_wrong_is_told)
