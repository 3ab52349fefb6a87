/* Windows in round walls, and discs: distances against a search, edges and corners, bounces, what is refused. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/frustum.h"
#include "dem/geometry/shape/rows.h"
#include "dem/geometry/windows.h"
#include "dem/output/view.h"
#include "dem/state/wall_gap.h"
#include "dem/store/fingerprint.h"
#include "dem/watch/energy_balance.h"
#include "test_dem_support.h"
#include "test_random.h"
#include "tests/test_main.h"

/* ---- scenes ---- */

/* Particles of radius r and shapes of a body at the origin; friction mu, restitution e. */
static json_t *scene_of(const char *tangential, double mu, double e, const char *shapes, const char *particles) {
  return scene_json("{'gravity':[0,0,0],'contact':{'normal':'hooke','tangential':'%s'},"
                    "'materials':[{'name':'m','density':2500}],"
                    "'pairs':[{'materials':['m','m'],'restitution':%g,'stiffness':1e6%s}],"
                    "'bodies':[{'name':'b','material':'m','shapes':[%s]}],"
                    "'particles':[{'type':'list','material':'m','radius':0.05,'positions':[%s]}]}",
                    tangential, e, mu > 0 ? ",'friction':0.5,'tangential_stiffness':3e5" : "", shapes, particles);
}

static rig *smooth(const char *shapes, const char *particles, double dt) {
  return rig_make(scene_of("none", 0, 1, shapes, particles), dt, 0, NULL);
}

#define TUBE "{'type':'cylinder','side':'inside','radius':1,'length':2,"
#define WINDOW "'windows':[{'angle':[-0.5,0.5],'height':[0.5,1.2]}]}"

static void place(rig *r, tdm_vec3 x, tdm_vec3 v) {
  dem_data *d = r->data;
  d->state.sphere[0].position = x;
  d->state.sphere[0].velocity = v;
  d->state.pace[0].velocity = v;
  d->lists.stale = true;
}

static double gap_at(const rig *r, tdm_vec3 x, tdm_vec3 *normal) {
  return dem_wall_gap(&r->model->wall[0], &r->data->state.wall[0], x, normal);
}

static tdm_vec3 at_angle(double r, double angle, double z) {
  return tdm_v3(r * cos(angle), r * sin(angle), z);
}

/* ---- distances ---- */

/* is the angle strictly between those of a window, by going around? */
static bool between_angles(double angle, double from, double to) {
  const double eps = 1e-9;
  while (to <= from)
    to += 2 * M_PI;
  while (angle < from)
    angle += 2 * M_PI;
  while (angle >= from + 2 * M_PI)
    angle -= 2 * M_PI;
  return angle > from + eps && angle < to - eps;
}

typedef struct {
  double angle[2], height[2];
} window;

static bool in_window(const window *w, int n, double angle, double z, double length) {
  const double eps = 1e-9;
  for (int k = 0; k < n; k++)
    if (between_angles(angle, w[k].angle[0], w[k].angle[1]) && (z > w[k].height[0] + eps || w[k].height[0] == 0) &&
        (z < w[k].height[1] - eps || w[k].height[1] == length))
      return true;
  return false;
}

enum { AROUND = 720, UP = 240 };

/* the smallest distance from points of a grid on what is left of the wall */
static double search(const double radius[2], double length, const window *w, int n, tdm_vec3 x) {
  double best = INFINITY;
  for (int j = 0; j <= UP; j++)
    for (int i = 0; i < AROUND; i++) {
      double a = 2 * M_PI * i / AROUND, z = length * j / UP, r = radius[0] + (radius[1] - radius[0]) * z / length;
      tdm_vec3 p = at_angle(r, a, z);
      double near = tdm_norm(tdm_sub(x, p));
      if (near < best && !in_window(w, n, a, z, length))
        best = near;
    }
  return best;
}

static const struct {
  const char *shape;
  double radius[2], length;
  window window[3];
  int n;
} walls[] = {
    {TUBE WINDOW, {1, 1}, 2, {{{-0.5, 0.5}, {0.5, 1.2}}}, 1},
    /* across the angle pi, by names of the angles that differ; one wider than half a turn */
    {TUBE "'windows':[{'angle':[3,-2.8],'height':[0,0.4]},{'angle':[2.5,3.5],'height':[0.5,2]},"
          "{'angle':[4,8],'height':[0.8,1.1]}]}",
     {1, 1},
     2,
     {{{3, -2.8}, {0, 0.4}}, {{2.5, 3.5}, {0.5, 2}}, {{4, 8}, {0.8, 1.1}}},
     3},
    /* a sector is left */
    {TUBE "'windows':[{'angle':[1,6],'height':[0,2]}]}", {1, 1}, 2, {{{1, 6}, {0, 2}}}, 1},
    {"{'type':'cone','side':'inside','radii':[0.3,1.2],'length':0.8,"
     "'windows':[{'angle':[0,1.4],'height':[0.2,0.5]},{'angle':[-9,-8],'height':[0.1,0.8]}]}",
     {0.3, 1.2},
     0.8,
     {{{0, 1.4}, {0.2, 0.5}}, {{-9, -8}, {0.1, 0.8}}},
     2},
};

/* The gap is the distance from the nearest of what is left: it is that of a point of the wall, which no point of a grid
 * undercuts and some point comes near. It changes by no more than the place. */
START_TEST(the_gap_is_a_distance) {
  const double *radius = walls[_i].radius, length = walls[_i].length;
  const double mesh =
      hypot(M_PI * fmax(radius[0], radius[1]) / AROUND, 0.5 * hypot(length, radius[1] - radius[0]) / UP);
  rig *r = smooth(walls[_i].shape, "[9,9,9]", 1e-5);
  random_state = 7;
  int over = 0;
  for (int trial = 0; trial < 300; trial++) {
    tdm_vec3 n, m, x = tdm_v3(between(-1.4, 1.4), between(-1.4, 1.4), between(-0.3, length + 0.3));
    double gap = gap_at(r, x, &n), least = search(radius, length, walls[_i].window, walls[_i].n, x);
    ck_assert_double_le(gap, least + 1e-12);
    ck_assert_double_ge(gap, least - 2 * mesh);
    ck_near(tdm_norm(n), 1, 1e-14);
    tdm_vec3 foot = tdm_axpy(-gap, n, x);
    ck_near(dem_shell_gap(radius, length, foot, &m), 0, 1e-14);
    ck_assert(!in_window(walls[_i].window, walls[_i].n, atan2(foot.y, foot.x), foot.z, length));
    over += gap > dem_shell_gap(radius, length, x, &m) + 1e-9;
    tdm_vec3 y = tdm_add(x, tdm_v3(between(-0.05, 0.05), between(-0.05, 0.05), between(-0.05, 0.05)));
    ck_assert_double_le(fabs(gap_at(r, y, &m) - gap), tdm_norm(tdm_sub(y, x)) * (1 + 1e-9));
  }
  ck_assert_int_gt(over, 5);
  rig_free(r);
}
END_TEST

/* Exact values: beside a straight edge, over the sill, at a corner, outside, and where two edges are as near. */
START_TEST(edges_are_where_they_are_said_to_be) {
  rig *r = smooth(TUBE WINDOW, "[9,9,9]", 1e-5);
  tdm_vec3 n;
  ck_near(gap_at(r, at_angle(0.97, 0.3, 0.54), &n), 0.05, 1e-15); /* the sill: 3-4-5 */
  ck_vector(n, tdm_v3(-0.6 * cos(0.3), -0.6 * sin(0.3), 0.8), 1e-14);
  ck_near(gap_at(r, at_angle(1.03, -0.2, 1.16), &n), 0.05, 1e-15); /* the lintel, from outside */
  ck_vector(n, tdm_v3(0.6 * cos(-0.2), 0.6 * sin(-0.2), -0.8), 1e-14);
  tdm_vec3 side = tdm_axpy(0.01, tdm_v3(sin(0.5), -cos(0.5), 0), at_angle(1, 0.5, 0.8));
  ck_near(gap_at(r, side, &n), 0.01, 1e-14); /* straight into the window from the edge at 0.5 */
  ck_vector(n, tdm_v3(sin(0.5), -cos(0.5), 0), 1e-12);
  ck_near(gap_at(r, at_angle(1, 0.5, 0.5), &n), 0, 1e-15); /* the corner itself is wall */
  ck_near(gap_at(r, at_angle(1, 0.5 + 1e-9, 0.7), &n), 0, 1e-15);
  ck_near(gap_at(r, at_angle(0.96, 0.7, 0.7), &n), 0.04, 1e-15); /* beside the window: the face */
  ck_near(gap_at(r, at_angle(0.9, 0, 2), &n), 0.1, 1e-15);
  /* below the wall's end, over a window that reaches it: no edge there */
  rig *notch = smooth(TUBE "'windows':[{'angle':[-0.5,0.5],'height':[0,1]}]}", "[9,9,9]", 1e-5);
  ck_near(gap_at(notch, at_angle(1, 0, -0.2), &n), tdm_norm(tdm_sub(at_angle(1, 0, -0.2), at_angle(1, 0.5, 0))), 1e-14);
  rig_free(notch);
  rig_free(r);
}
END_TEST

/* Angles are about the axis, from the body's x as seen along it, and from its y where the axis is along x. */
START_TEST(angles_count_from_the_x_axis) {
  static const struct {
    const char *axis;
    tdm_vec3 in, out; /* through the middle of the window, and through the wall at the other side */
  } cases[] = {{"[0,0,1]", {1, 0, 1}, {-1, 0, 1}},
               {"[0,0,-2]", {1, 0, -1}, {-1, 0, -1}},
               {"[1,0,0]", {1, 1, 0}, {1, -1, 0}},
               {"[0,1,0]", {1, 1, 0}, {-1, 1, 0}},
               {"[-1,0,0]", {-1, 1, 0}, {-1, -1, 0}}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    char shape[300];
    tdm_vec3 n;
    snprintf(shape, sizeof shape, TUBE "'axis':%s,'windows':[{'angle':[-0.1,0.1],'height':[0.9,1.1]}]}", cases[k].axis);
    rig *r = smooth(shape, "[9,9,9]", 1e-5);
    ck_near(gap_at(r, cases[k].in, &n), 2 * sin(0.05), 1e-14);
    ck_near(gap_at(r, cases[k].out, &n), 0, 1e-15);
    rig_free(r);
  }
  /* which way they grow: anticlockwise as seen against the axis */
  rig *r = smooth(TUBE "'axis':[0,0,-1],'windows':[{'angle':[1.4,1.8],'height':[0.8,1.2]}]}", "[9,9,9]", 1e-5);
  tdm_vec3 n;
  ck_near(gap_at(r, tdm_v3(0, 1, -1), &n), 0, 1e-15);
  ck_assert_double_gt(gap_at(r, tdm_v3(0, -1, -1), &n), 0.1);
  rig_free(r);
}
END_TEST

/* ---- forces ---- */

/* A sphere pushed into the wall goes down into the window over the sill, and across a straight edge: the force changes
 * by no more than the stiffness times the way. At the edge it is k (r - distance) along the distance. */
START_TEST(the_force_is_continuous_over_an_edge) {
  rig *r = smooth(TUBE WINDOW, "[9,9,9]", 1e-5);
  const dem_data *d = r->data;
  for (int way = 0; way < 2; way++) {
    tdm_vec3 before = {0, 0, 0};
    double step = 1e-4;
    for (int k = -400; k <= 400; k++) {
      double s = k * step;
      tdm_vec3 x = way ? at_angle(0.98, 0.5 - s, 0.8) : at_angle(0.98, 0.1, 0.5 + s);
      place(r, x, tdm_v3(0, 0, 0));
      forces_now(r->data, false);
      tdm_vec3 force = d->state.push[0].force, n;
      double gap = gap_at(r, x, &n);
      ck_vector(force, tdm_scale(1e6 * fmax(0, 0.05 - gap), n), 1e-6);
      if (k > -400) /* the normal turns by the way over the distance */
        ck_assert_double_le(tdm_norm(tdm_sub(force, before)), 1e6 * step * (1 + 0.05 / 0.02));
      before = force;
    }
    double from = way ? sqrt(0.98 * 0.98 + 1 - 2 * 0.98 * cos(0.04)) : hypot(0.02, 0.04);
    ck_near(tdm_norm(before), 1e6 * (0.05 - from), 1e-6);
  }
  rig_free(r);
}
END_TEST

/* In a corner of the window the nearer edge alone is touched: on both sides of the bisector the force is that of one
 * contact, of the same size, along that edge's normal. */
START_TEST(a_corner_is_one_contact) {
  rig *r = smooth(TUBE WINDOW, "[9,9,9]", 1e-5);
  const dem_data *d = r->data;
  const tdm_vec3 along = tdm_v3(sin(0.5), -cos(0.5), 0), up = tdm_v3(0, 0, 1); /* from the straight edge, the sill */
  for (int k = 0; k < 5; k++) {
    const double away = 0.01 * k + 0.005;
    for (int side = 0; side < 2; side++) {
      tdm_vec3 x = tdm_axpy(away, along, at_angle(1, 0.5, 0.5));
      x = tdm_scale(1 / hypot(x.x, x.y), tdm_v3(x.x, x.y, 0)); /* on the wall's surface */
      const double edge = tdm_norm(tdm_sub(x, at_angle(1, 0.5, 0)));
      x.z = 0.5 + edge * (side ? 1 - 1e-9 : 1 + 1e-9);
      place(r, x, tdm_v3(0, 0, 0));
      forces_now(r->data, false);
      tdm_vec3 normal = side ? up : tdm_scale(1 / edge, tdm_sub(tdm_v3(x.x, x.y, 0), at_angle(1, 0.5, 0)));
      ck_vector(d->state.push[0].force, tdm_scale(1e6 * (0.05 - edge), normal), 1e-3);
    }
  }
  rig_free(r);
}
END_TEST

static double energy_of(dem_data *d) {
  return dem_stored_energy_now(d).kinetic;
}

/* Spheres thrown at the edges and corners of a window, from inside and outside, leave with their speed. */
START_TEST(bounces_keep_energy) {
  rig *r = smooth(TUBE WINDOW, "[9,9,9]", 5e-6);
  random_state = 11;
  int passed = 0, bounced = 0;
  for (int trial = 0; trial < 40; trial++) {
    double angle = trial % 2 ? 0.5 : 0, z = trial % 4 < 2 ? 0.5 : 0.9, from = trial % 3 ? 0.8 : 1.2;
    tdm_vec3 x = at_angle(from, angle + between(-0.08, 0.08), z + between(-0.08, 0.08));
    tdm_vec3 v = tdm_scale(from < 1 ? 1 : -1, at_angle(2, between(-0.4, 0.4), between(-0.5, 0.5)));
    place(r, x, v);
    double before = energy_of(r->data);
    rig_steps(r, 40000);
    ck_relative(energy_of(r->data), before, 2e-4);
    tdm_vec3 now = r->data->state.pace[0].velocity;
    bounced += tdm_norm(tdm_sub(now, v)) > 1e-3;
    passed += (hypot(r->data->state.sphere[0].position.x, r->data->state.sphere[0].position.y) > 1) == (from < 1);
  }
  ck_assert_int_gt(passed, 5);
  ck_assert_int_gt(bounced, 15);
  rig_free(r);
}
END_TEST

/* Forces and moments on particle and wall are equal and opposite, with friction: the angular momentum that the sphere
 * gets is what the wall loses. */
START_TEST(moments_balance) {
  rig *r = rig_make(scene_of("spring", 0.5, 0.6, TUBE WINDOW, "[9,9,9]"), 2e-6, 0, NULL);
  const double mass = r->data->state.mass[0], inertia = 0.4 * mass * 0.05 * 0.05;
  place(r, at_angle(0.9, 0.46, 0.53), at_angle(3, -0.3, -0.4));
  dem_data *d = r->data;
  tdm_vec3 momentum = tdm_scale(mass, d->state.pace[0].velocity);
  tdm_vec3 turning = tdm_cross(d->state.sphere[0].position, momentum), wall = {0, 0, 0}, wall_turning = {0, 0, 0};
  double most = 0;
  for (int k = 0; k < 60000; k++) {
    rig_steps(r, 1);
    wall = tdm_axpy(r->model->dt, d->state.body_load[0].force, wall);
    wall_turning = tdm_axpy(r->model->dt, d->state.body_load[0].moment, wall_turning);
    most = fmax(most, tdm_norm(d->state.body_load[0].force));
  }
  tdm_vec3 after = tdm_scale(mass, d->state.pace[0].velocity);
  tdm_vec3 turned = tdm_add(tdm_cross(d->state.sphere[0].position, after), tdm_scale(inertia, d->state.pace[0].spin));
  ck_assert_double_gt(most, 100);
  ck_assert_double_gt(tdm_norm(d->state.pace[0].spin), 1);
  ck_vector(wall, tdm_sub(momentum, after), 1e-6 * tdm_norm(momentum));
  ck_vector(wall_turning, tdm_sub(turning, turned), 1e-4 * tdm_norm(turning));
  rig_free(r);
}
END_TEST

/* Who leaves by a window is outside, and did not go through a wall. */
START_TEST(who_leaves_is_not_lost) {
  rig *r = smooth(TUBE "'ends':true," WINDOW, "[9,9,9]", 1e-5);
  place(r, tdm_v3(0, 0, 0.85), tdm_v3(4, 0, 0));
  rig_steps(r, 50000);
  ck_near(r->data->state.sphere[0].position.x, 2, 1e-9);
  ck_assert(!r->model->wall[0].endless);
  ck_assert_int_eq(r->model->nwall, 3);
  for (int w = 0; w < r->model->nwall; w++)
    ck_assert(!dem_through(r->data, 0, w));
  rig_free(r);
}
END_TEST

/* ---- what is drawn ---- */

static double area_of(const rig *r, int *count) {
  dem_polygons all = {0};
  tdm_error err = {0};
  dem_bounds bounds = {{-1, -1, -1}, {1, 1, 1}};
  ck_assert_int_eq(dem_polygons_make(&all, r->data, &bounds, &err), TDM_OK);
  double area = 0;
  for (int k = 0; k < all.count; k++) {
    const dem_polygon *p = &all.polygon[k];
    tdm_vec3 twice = {0, 0, 0};
    for (int c = 2; c < p->ncorner; c++)
      twice = tdm_add(twice, tdm_cross(tdm_sub(p->corner[c - 1], p->corner[0]), tdm_sub(p->corner[c], p->corner[0])));
    area += 0.5 * tdm_norm(twice);
  }
  *count = all.count;
  dem_polygons_free(&all);
  return area;
}

/* The panels leave the windows out: their area is that of the facets without the windows, whose angles are facets'
 * here; a disc is a ring. */
START_TEST(holes_are_seen) {
  const double facet = 2 * sin(M_PI / 60), ring = 0.5 * 72 * sin(2 * M_PI / 72);
  int count;
  rig *r = smooth(TUBE "'windows':[{'angle':[-0.5235987755982988,0.5235987755982988],'height':[0.5,1.2]},"
                       "{'angle':[0,1.0471975511965976],'height':[0,0.25]},"
                       "{'angle':[3.141592653589793,4.1887902047863905],'height':[1.5,2]}]}",
                  "[9,9,9]", 1e-5);
  ck_near(area_of(r, &count), facet * (60 * 2 - 10 * 0.7 - 10 * 0.25 - 10 * 0.5), 1e-9);
  rig_free(r);
  r = smooth("{'type':'disc','radius':0.5,'inner_radius':0.2}", "[9,9,9]", 1e-5);
  ck_near(area_of(r, &count), ring * (0.25 - 0.04), 1e-12);
  rig_free(r);
}
END_TEST

/* ---- stored beds ---- */

/* A bed that settled beside other windows is another one. */
START_TEST(windows_belong_to_the_bed) {
  static const char *const shapes[] = {TUBE WINDOW, TUBE "'windows':[{'angle':[-0.5,0.5],'height':[0.5,1.3]}]}",
                                       TUBE "'windows':[{'angle':[-0.5,0.6],'height':[0.5,1.2]}]}"};
  unsigned long long hash[3];
  for (int k = 0; k < 3; k++) {
    rig *r = smooth(shapes[k], "[9,9,9]", 1e-5);
    hash[k] = dem_fingerprint_bed(r->model);
    rig_free(r);
  }
  ck_assert(hash[0] != hash[1] && hash[0] != hash[2] && hash[1] != hash[2]);
}
END_TEST

/* ---- what is refused ---- */

START_TEST(what_is_no_window_is_refused) {
  static const struct {
    const char *shape, *path, *says;
  } cases[] = {
      {TUBE "'windows':[{'angle':[0,7],'height':[0,1]}]}", "windows[0].angle", "two cylinders"},
      {TUBE "'windows':[{'angle':[1,1],'height':[0,1]}]}", "windows[0].angle", "no part of a turn"},
      {TUBE "'windows':[{'angle':[0,1],'height':[-0.1,1]}]}", "windows[0].height", "not in the wall"},
      {TUBE "'windows':[{'angle':[0,1],'height':[1,2.1]}]}", "windows[0].height", "not in the wall"},
      {TUBE "'windows':[{'angle':[0,1],'height':[1,1]}]}", "windows[0].height", "not in the wall"},
      {TUBE "'windows':[{'angle':[0,1],'height':[0,1]},{'angle':[0.9,2],'height':[1,2]}]}", "windows[1]",
       "touches windows[0]"},
      {TUBE "'windows':[{'angle':[0,1],'height':[0,1]},{'angle':[6,6.3],'height':[0.5,2]}]}", "windows[1]",
       "touches windows[0]"},
      {TUBE "'windows':[{'angle':[0,1],'height':[0,1],'hole':2}]}", "windows[0].hole", "unknown"},
      {"{'type':'cylinder','side':'inside','radius':1," WINDOW, "windows", "length"},
      {"{'type':'cylinder','side':'outside','radius':1,'length':2," WINDOW, "windows", "inside"},
      {"{'type':'disc','radius':1,'inner_radius':1}", "inner_radius", "less than"},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    tdm_error err = rig_refused(scene_of("none", 0, 1, cases[k].shape, "[9,9,9]"), NULL);
    ck_assert_msg(strstr(err.path, cases[k].path) && strstr(err.message, cases[k].says), "%s: %s", err.path,
                  err.message);
  }
}
END_TEST

/* ---- discs ---- */

static double ring_search(double inner, double outer, tdm_vec3 x) {
  double best = INFINITY;
  for (int i = 0; i < AROUND; i++)
    for (int j = 0; j <= UP; j++)
      best = fmin(best, tdm_norm(tdm_sub(x, at_angle(inner + (outer - inner) * j / UP, 2 * M_PI * i / AROUND, 0))));
  return best;
}

/* The gap is the distance from the ring; a sphere bounces off from both sides, off the rims, and passes the hole. */
START_TEST(discs_are_rings) {
  random_state = 3;
  for (int trial = 0; trial < 100; trial++) {
    double inner = trial % 3 ? between(0, 0.6) : 0, outer = inner + between(0.05, 1);
    tdm_vec3 n, m, x = tdm_v3(between(-1.8, 1.8), between(-1.8, 1.8), between(-0.5, 0.5));
    if (trial % 10 == 0)
      x.x = x.y = 0;
    double gap = dem_ring_gap(inner, outer, x, &n), least = ring_search(inner, outer, x);
    ck_assert(gap <= least + 1e-12 && gap >= least - 0.01);
    ck_near(tdm_norm(n), 1, 1e-14);
    ck_near(dem_ring_gap(inner, outer, tdm_axpy(-gap, n, x), &m), 0, 1e-15);
  }
  rig *r = smooth("{'type':'disc','radius':0.5,'inner_radius':0.2,'center':[0,0,1],"
                  "'orientation':[0.7071067811865476,0.7071067811865476,0,0]}",
                  "[9,9,9]", 5e-6); /* in the plane y = 0, around (0, 0, 1) */
  for (int k = 0; k < 4; k++) {
    double side = k % 2 ? 1 : -1;
    place(r, tdm_v3(k < 2 ? 0.3 : 0.1, 0.2 * side, 1), tdm_v3(0, -side, 0));
    rig_steps(r, 60000);
    ck_vector(r->data->state.pace[0].velocity, tdm_v3(0, k < 2 ? side : -side, 0), 1e-4);
  }
  place(r, tdm_v3(0.53, 0.2, 1), tdm_v3(0, -1, 0)); /* over the rim, by 0.03 of a radius of 0.05: 3-4-5 */
  rig_steps(r, 60000);
  ck_near(tdm_norm(r->data->state.pace[0].velocity), 1, 1e-4);
  ck_assert_double_gt(r->data->state.pace[0].velocity.x, 0.5);
  rig_free(r);
}
END_TEST

TEST_MAIN_ROWS("dem_windows", {the_gap_is_a_distance, 4}, {edges_are_where_they_are_said_to_be, 1},
               {angles_count_from_the_x_axis, 1}, {the_force_is_continuous_over_an_edge, 1},
               {a_corner_is_one_contact, 1}, {bounces_keep_energy, 1}, {moments_balance, 1},
               {who_leaves_is_not_lost, 1}, {holes_are_seen, 1}, {windows_belong_to_the_bed, 1},
               {what_is_no_window_is_refused, 1}, {discs_are_rings, 1})
