/* Cylinders and cones against a search for the nearest point, driven bodies against differences, shapes from scenes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/adapter/report.h"
#include "dem/bodies/walls.h"
#include "dem/geometry/frustum.h"
#include "dem/geometry/mesh/mesh_contact.h"
#include "dem/geometry/shape/rows.h"
#include "dem/model/driven.h"
#include "dem/watch/limits.h"
#include "test_dem_support.h"
#include "test_random.h"
#include "tests/test_main.h"

#include <unistd.h>

/* ---- cylinders and cones ---- */

/* Smallest distance of x from a surface point(s, angle), s in [0, 1]: a grid, refined around its best point. */
static double search(tdm_vec3 (*point)(const void *, double, double), const void *of, tdm_vec3 x) {
  double s0 = 0.5, a0 = 0, ds = 0.5, da = M_PI, best = INFINITY;
  for (int level = 0; level < 70; level++) {
    double s1 = s0, a1 = a0;
    for (int i = -8; i <= 8; i++)
      for (int j = -8; j <= 8; j++) {
        double s = fmax(0, fmin(1, s0 + ds * i / 8)), a = a0 + da * j / 8;
        double distance = tdm_norm(tdm_sub(x, point(of, s, a)));
        if (distance < best) {
          best = distance;
          s1 = s;
          a1 = a;
        }
      }
    s0 = s1;
    a0 = a1;
    ds *= 0.7;
    da *= 0.85; /* slower: near an apex the angle matters only when s is right */
  }
  return best;
}

typedef struct {
  double radius[2], length;
} round_shape;

static tdm_vec3 on_side(const void *of, double s, double a) {
  const round_shape *c = of;
  double r = (1 - s) * c->radius[0] + s * c->radius[1];
  return tdm_v3(r * cos(a), r * sin(a), s * c->length);
}

static tdm_vec3 on_end(const void *of, double s, double a) {
  const round_shape *c = of;
  return tdm_v3(s * c->radius[0] * cos(a), s * c->radius[0] * sin(a), 0);
}

static tdm_vec3 on_other_end(const void *of, double s, double a) {
  const round_shape *c = of;
  return tdm_v3(s * c->radius[1] * cos(a), s * c->radius[1] * sin(a), c->length);
}

static bool is_in(const round_shape *c, tdm_vec3 x) {
  double r = c->radius[0] + x.z / c->length * (c->radius[1] - c->radius[0]);
  return x.z >= 0 && x.z <= c->length && x.x * x.x + x.y * x.y <= r * r;
}

static const round_shape shapes[] = {{{1, 1}, 2}, {{0.3, 1}, 0.7}, {{1, 0.2}, 3}, {{0, 0.8}, 1}, {{0.9, 0}, 0.5}};

START_TEST(test_shell) {
  const round_shape *c = &shapes[_i];
  random_state = 1;
  for (int trial = 0; trial < 200; trial++) {
    tdm_vec3 n, m, x = tdm_v3(between(-1.5, 1.5), between(-1.5, 1.5), between(-1, c->length + 1));
    double gap = dem_shell_gap(c->radius, c->length, x, &n);
    ck_near(gap, search(on_side, c, x), 1e-7);
    ck_near(tdm_norm(n), 1, 1e-14);
    /* the point that gap and normal name lies on the surface, so the normal is right, too */
    ck_near(dem_shell_gap(c->radius, c->length, tdm_axpy(-gap, n, x), &m), 0, 1e-14);
  }
}
END_TEST

START_TEST(test_solid) {
  const round_shape *c = &shapes[_i];
  random_state = 2;
  int inside = 0;
  for (int trial = 0; trial < 400; trial++) {
    tdm_vec3 n, m, x = tdm_v3(between(-1.2, 1.2), between(-1.2, 1.2), between(-0.3, c->length + 0.3));
    double gap = dem_frustum_gap(c->radius, c->length, x, &n), sign = is_in(c, x) ? -1 : 1;
    double least = fmin(search(on_side, c, x), fmin(search(on_end, c, x), search(on_other_end, c, x)));
    inside += sign < 0;
    ck_near(gap, sign * least, 1e-7);
    ck_near(tdm_norm(n), 1, 1e-14);
    ck_near(dem_frustum_gap(c->radius, c->length, tdm_axpy(-gap, n, x), &m), 0, 1e-14);
  }
  ck_assert_int_gt(inside, 10);
}
END_TEST

/* Exact values, on the axis and on the rims included. */
START_TEST(test_round_exact) {
  const double r[2] = {0.5, 0.5}, cone[2] = {0, 1};
  tdm_vec3 n;
  ck_assert_double_eq(dem_shell_gap(r, 2, tdm_v3(0, 0, 1), &n), 0.5);
  ck_assert_double_eq(tdm_norm(n), 1);
  ck_assert_double_eq(dem_shell_gap(r, 2, tdm_v3(0, 0.25, 1), &n), 0.25);
  ck_vector(n, tdm_v3(0, -1, 0), 0);
  ck_assert_double_eq(dem_shell_gap(r, 2, tdm_v3(-0.75, 0, 1), &n), 0.25); /* felt from outside, too */
  ck_vector(n, tdm_v3(-1, 0, 0), 0);
  ck_near(dem_shell_gap(r, 2, tdm_v3(0.5 + 0.3, 0, 2.4), &n), 0.5, 1e-15); /* rim: 3-4-5 */
  ck_vector(n, tdm_v3(0.6, 0, 0.8), 1e-15);
  ck_assert_double_eq(dem_shell_gap(r, 2, tdm_v3(0.5, 0, 2), &n), 0);
  ck_assert_double_eq(tdm_norm(n), 1);
  ck_assert_double_eq(dem_shell_gap(cone, 1, tdm_v3(0, 0, 0), &n), 0); /* the apex */
  ck_near(tdm_norm(n), 1, 1e-15);
  ck_assert_double_eq(dem_shell_gap(cone, 1, tdm_v3(0, 0, -0.25), &n), 0.25);
  ck_vector(n, tdm_v3(0, 0, -1), 0);
  ck_assert_double_eq(dem_frustum_gap(r, 2, tdm_v3(0, 0, 2.125), &n), 0.125);
  ck_vector(n, tdm_v3(0, 0, 1), 0);
  ck_assert_double_eq(dem_frustum_gap(r, 2, tdm_v3(0, 0, 0.125), &n), -0.125);
  ck_vector(n, tdm_v3(0, 0, -1), 0);
  ck_assert_double_eq(dem_frustum_gap(r, 2, tdm_v3(0, 0, 1), &n), -0.5);
  ck_assert_double_eq(tdm_norm(n), 1);
  ck_assert_double_eq(dem_cylinder_gap(0.5, true, tdm_v3(0, 0, 9), &n), 0.5);
  ck_assert_double_eq(dem_cylinder_gap(0.5, true, tdm_v3(0, 0.75, 9), &n), -0.25);
  ck_vector(n, tdm_v3(0, -1, 0), 0);
  ck_assert_double_eq(dem_cylinder_gap(0.5, false, tdm_v3(0, 0.75, 9), &n), 0.25);
  ck_vector(n, tdm_v3(0, 1, 0), 0);
  ck_assert_double_eq(dem_cylinder_gap(0.5, true, tdm_v3(1e-300, 1e-300, 9), &n), 0.5);
  ck_assert_double_eq(tdm_norm(n), 1);
}
END_TEST

/* ---- driven bodies ---- */

/* The twist is the derivative of the pose; the start is the body's own pose; the rest is rest. */
START_TEST(test_driven) {
  dem_drive d = {.given = true,
                 .velocity = {0.3, -0.2, 0.1},
                 .angular = {0.5, 2, -1},
                 .center = {1, 0, 2},
                 .amplitude = {0, 0.02, 0.05},
                 .swing = {.amplitude = 1, .omega = 2 * M_PI * 3, .phase = 0.7},
                 .start = 0.5,
                 .end = 4};
  tdm_state at = state_at(2, 3, 4);
  at.pose.orientation = tdm_quat_from_rotvec(tdm_v3(0.1, 0.2, 0.3));
  tdm_state begin = dem_driven_state(&d, &at, 0.5), before = dem_driven_state(&d, &at, 0.2);
  ck_assert(memcmp(&begin.pose, &at.pose, sizeof at.pose) == 0 && memcmp(&before, &at, sizeof at) == 0);
  const double h = 1e-5;
  for (double t = 0.6; t < 3.9; t += 0.37) {
    tdm_state a = dem_driven_state(&d, &at, t - h), b = dem_driven_state(&d, &at, t + h),
              now = dem_driven_state(&d, &at, t);
    ck_vector(now.twist.velocity, tdm_scale(0.5 / h, tdm_sub(b.pose.position, a.pose.position)), 1e-7);
    tdm_vec3 turn = tdm_quat_to_rotvec(tdm_quat_mul(b.pose.orientation, tdm_quat_conj(a.pose.orientation)));
    ck_vector(now.twist.angular, tdm_scale(0.5 / h, turn), 1e-9);
    /* the centre goes with velocity and oscillation, the body stays as far from it as it was */
    tdm_vec3 center = tdm_axpy(t - d.start, d.velocity, d.center);
    center = tdm_axpy(sin(d.swing.omega * (t - d.start) + d.swing.phase) - sin(d.swing.phase), d.amplitude, center);
    ck_near(tdm_norm(tdm_sub(now.pose.position, center)), tdm_norm(tdm_sub(at.pose.position, d.center)), 1e-12);
    ck_assert_double_le(tdm_norm(now.twist.velocity),
                        dem_drive_speed(&d, tdm_norm(tdm_sub(at.pose.position, d.center))));
  }
  tdm_state end = dem_driven_state(&d, &at, 4), later = dem_driven_state(&d, &at, 1e6);
  ck_assert(memcmp(&end, &later, sizeof end) == 0);
  ck_vector(end.twist.velocity, tdm_v3(0, 0, 0), 0);
  ck_vector(end.pose.position, dem_driven_state(&d, &at, 4 - 1e-12).pose.position, 1e-10);
}
END_TEST

/* ---- scenes ---- */

#define SCENE(body)                                                                                               \
  "{'materials':[{'name':'m','density':1000,'young_modulus':1e7,'poisson_ratio':0.2}],"                           \
  "'pairs':[{'materials':['m','m'],'restitution':0.5,'friction':0.4}],'bodies':[{'name':'b','material':'m'," body \
  "}]}"

static void ck_refused(const char *body, const char *path, const char *says) {
  char text[4096];
  snprintf(text, sizeof text, SCENE("%s"), body);
  json_t *json = scene_json("%s", text);
  tdm_assigned_body coupled = {.name = (char *)"b", .mass = 1, .state = state_at(0, 0, 0)};
  tdm_error err = rig_refused(json, strstr(says, "coupled") ? &coupled : NULL);
  ck_assert_msg(strcmp(err.path, path) == 0 && strstr(err.message, says), "%s: %s", err.path, err.message);
}

#define SHAPE(x) "'shapes':[{" x "}]"
#define AT "dem.bodies[0].shapes[0]."

START_TEST(test_refused) {
  ck_refused(SHAPE("'type':'cylinder','side':'inside'"), AT "radius", "missing");
  ck_refused(SHAPE("'type':'cylinder','radius':1"), AT "side", "missing");
  ck_refused(SHAPE("'type':'cylinder','radius':-1,'side':'inside'"), AT "radius", "greater than 0");
  ck_refused(SHAPE("'type':'cylinder','radius':1,'length':0,'side':'inside'"), AT "length", "greater than 0");
  ck_refused(SHAPE("'type':'cylinder','radius':1,'side':'inside','axis':[0,0,0]"), AT "axis", "zero");
  ck_refused(SHAPE("'type':'cylinder','radius':1,'side':'inside','ends':true"), AT "ends", "length");
  ck_refused(SHAPE("'type':'cylinder','radius':1,'side':'outside','length':1,'ends':true"), AT "ends", "solid");
  ck_refused(SHAPE("'type':'cylinder','radius':1,'side':'inside','length':1,'ends':1"), AT "ends", "true or false");
  ck_refused(SHAPE("'type':'cone','radii':[0,0],'side':'inside','length':1"), AT "radii", "both");
  ck_refused(SHAPE("'type':'cone','radii':[1],'side':'inside','length':1"), AT "radii", "2");
  ck_refused(SHAPE("'type':'cone','radii':[1,2],'side':'inside'"), AT "length", "missing");
  ck_refused(SHAPE("'type':'mesh','file':'/nowhere.stl'"), AT "file", "/nowhere.stl");
  ck_refused(SHAPE("'type':'mesh','file':'x.stl','scale':0"), AT "scale", "greater than 0");
  ck_refused(SHAPE("'type':'mesh','file':'x.stl','facet_angle':2"), AT "facet_angle", "right angle");
  ck_refused(SHAPE("'type':'plane','normal':[0,0,1],'surface_velocity':[1,2]"), AT "surface_velocity", "3");
  ck_refused(SHAPE("'type':'plane','normal':[0,0,1],'surface_spin':1"), AT "surface_spin", "unknown");
  ck_refused(SHAPE("'type':'plane','normal':[0,0,1],'surface_rotation':{'rate':1}"), AT "surface_rotation.axis",
             "missing");
  ck_refused(SHAPE("'type':'plane','normal':[0,0,1],'surface_rotation':{'axis':[0,0,0],'rate':1}"),
             AT "surface_rotation.axis", "zero");
  ck_refused("'shapes':[],'motion':{}", "dem.bodies[0].motion", "moves nothing");
  ck_refused("'shapes':[],'motion':{'velocity':[1,0,0],'start':1,'end':1}", "dem.bodies[0].motion.end", "after start");
  ck_refused("'shapes':[],'motion':{'velocity':[1,0,0],'center':[0,0,0]}", "dem.bodies[0].motion.center", "rotation");
  ck_refused("'shapes':[],'motion':{'oscillation':{'amplitude':[0,0,1]}}", "dem.bodies[0].motion.oscillation.frequency",
             "missing");
  ck_refused("'shapes':[],'motion':{'velocity':[1,0,0]}", "dem.bodies[0].motion", "coupled");
}
END_TEST

static rig *load(const char *body) {
  char text[4096];
  snprintf(text, sizeof text, SCENE("%s"), body);
  return rig_make(scene_json("%s", text), 1e-5, 0, NULL);
}

static double gap_at(const rig *r, int w, double x, double y, double z, tdm_vec3 *n) {
  return dem_wall_gap(&r->model->wall[w], &r->data->state.wall[w], tdm_v3(x, y, z), n);
}

/* Shapes in a body that is turned by 90 degrees about z and moved by 10 along x: body x is world y. */
START_TEST(test_read) {
  rig *r = load("'position':[10,0,0],'orientation':[0.7071067811865476,0,0,0.7071067811865476],'shapes':["
                "{'type':'cylinder','point':[1,0,0],'axis':[3,0,0],'radius':0.5,'length':2,'side':'outside',"
                "'surface_spin':4,'surface_velocity':[0.5,0,0]},"
                "{'type':'cylinder','axis':[0,0,-1],'radius':2,'length':3,'side':'inside','ends':true},"
                "{'type':'cone','radii':[1,0.25],'length':1,'side':'inside'},"
                "{'type':'box','size':[2,1,1],'orientation':[0.7071067811865476,0,0,0.7071067811865476],"
                "'side':'outside'},"
                "{'type':'box','size':[2,4,6],'center':[0,0,1],'orientation':[0.7071067811865476,0,0,"
                "0.7071067811865476],'side':'inside','open':['-y','+y','-z','+z','-x']}],"
                "'motion':{'velocity':[0,0,2],'angular_velocity':[0,0,1],'start':1}");
  const dem_model *m = r->model;
  tdm_vec3 n;
  ck_assert_int_eq(m->nwall, 7);
  /* the solid reaches from y = 1 to y = 3 around (10, y, 0) */
  ck_near(gap_at(r, 0, 10, 3.25, 0, &n), 0.25, 1e-14);
  ck_vector(n, tdm_v3(0, 1, 0), 1e-15);
  ck_near(gap_at(r, 0, 10, 2, 0.75, &n), 0.25, 1e-14);
  ck_vector(n, tdm_v3(0, 0, 1), 1e-15);
  /* a spin of 4 about the axis, world +y, and a velocity along it: at the top +x */
  ck_vector(dem_wall_surface(&m->wall[0], &r->data->state.wall[0], tdm_v3(10, 2, 0.5), tdm_v3(0, 0, 1)),
            tdm_v3(2, 0.5, 0), 1e-14);
  /* a container: an endless cylinder and two planes */
  ck_assert(m->wall[1].shape == &dem_shape_cylinder && m->wall[1].endless);
  ck_near(gap_at(r, 1, 10, 1.5, 7, &n), 0.5, 1e-14);
  ck_vector(n, tdm_v3(0, -1, 0), 1e-15);
  ck_near(gap_at(r, 2, 10, 0, -1, &n), 1, 1e-14);
  ck_vector(n, tdm_v3(0, 0, -1), 1e-15);
  ck_near(gap_at(r, 3, 10, 0, -1, &n), 2, 1e-14);
  ck_vector(n, tdm_v3(0, 0, 1), 1e-15);
  /* the cone's outlet at z = 1 */
  ck_near(gap_at(r, 4, 10, 0.25, 1.5, &n), 0.5, 1e-14);
  ck_vector(n, tdm_v3(0, 0, 1), 1e-15);
  double low, high;
  ck_assert(dem_wall_extent(&m->wall[4], &r->data->state.wall[4], tdm_v3(0, 1, 0), &low, &high));
  ck_near(low, -1, 1e-14);
  ck_near(high, 1, 1e-14);
  ck_assert(!dem_wall_extent(&m->wall[1], &r->data->state.wall[1], tdm_v3(0, 1, 0), &low, &high));
  /* the box's long edge: its x is body y, world -x */
  ck_near(gap_at(r, 5, 8, 0, 0, &n), 1, 1e-14);
  ck_vector(n, tdm_v3(-1, 0, 0), 1e-15);
  /* a container's only face: its +x at world x = 9, seen from the right */
  ck_near(gap_at(r, 6, 9.5, 0, 0, &n), 0.5, 1e-14);
  ck_vector(n, tdm_v3(1, 0, 0), 1e-15);
  ck_assert(m->body[0].drive.given);
  tdm_state now = dem_driven_state(&m->body[0].drive, &m->body[0].start, 2);
  ck_vector(now.pose.position, tdm_v3(10, 0, 2), 0); /* the centre is the body's own */
  ck_vector(now.twist.velocity, tdm_v3(0, 0, 2), 0);
  rig_free(r);
}
END_TEST

/* A mesh in millimetres, moved and turned inside its body. */
START_TEST(test_read_mesh) {
  char file[256], body[1024];
  snprintf(file, sizeof file, "%s/geometry_%d.stl", TANDEM_TEST_DIR, (int)getpid());
  tdm_vec3 corner[3] = {{-100, -100, 0}, {100, -100, 0}, {0, 200, 0}};
  tdm_error err = {0};
  ck_assert(!tdm_stl_write(&(tdm_stl){1, corner}, file, &err));
  snprintf(body, sizeof body,
           "'position':[1,0,0],'shapes':[{'type':'mesh','file':'%s','scale':0.001,'position':[0,0,0.5],"
           "'orientation':[0.7071067811865476,0.7071067811865476,0,0],'surface_velocity':[0,0,3]}]",
           file);
  rig *r = load(body);
  unlink(file);
  const dem_wall *wall = &r->model->wall[0];
  ck_assert(wall->shape == &dem_shape_mesh);
  /* turned by 90 degrees about x: its plane is y = 0 */
  tdm_vec3 n, x = tdm_v3(1, 0.25, 0.5);
  ck_near(gap_at(r, 0, x.x, x.y, x.z, &n), 0.25, 1e-15);
  ck_vector(n, tdm_v3(0, 1, 0), 1e-15);
  ck_near(gap_at(r, 0, 1, 0, 0.75, &n), 0.05, 1e-8);
  ck_vector(dem_wall_surface(wall, &r->data->state.wall[0], x, tdm_v3(0, 1, 0)), tdm_v3(0, 0, 3), 0);
  int near[1];
  dem_touch c;
  tdm_vec3 own = dem_wall_own(&r->data->state.wall[0], x);
  ck_assert_int_eq(wall->shape->near(wall, 0, own, 0.3, near, 1), 1);
  ck_assert_int_eq(dem_mesh_contacts(wall->data, near, 1, 1, own, 0.3, &c, 1), 1);
  ck_near(c.gap, 0.25, 1e-15);
  dem_report report;
  ck_assert(!dem_report_make(&report, r->data, &(dem_settled){.rest = true, .pressed = true}, 0, &err));
  const json_t *of = json_array_get(json_object_get(report.json, "meshes"), 0);
  ck_assert_int_eq(json_integer_value(json_object_get(of, "open_edges")), 3);
  ck_near(json_real_value(json_object_get(of, "area")), 0.03, 1e-9);
  json_decref(report.json);
  rig_free(r);
}
END_TEST

/* ---- rolling ---- */

/* One sphere of radius 0.1 at x = (-1, 0.013, 0.1) on the shapes, sliding at 1 m/s, after n steps. */
static rig *slide(const char *shape, long n) {
  char body[1024];
  snprintf(
      body, sizeof body,
      "'shapes':[%s]}],'particles':[{'type':'list','material':'m','radius':0.1,'positions':[[-1,0.013,0.0999]],"
      "'velocity':[1,0.11,0],'spin':[0,0,3]}],'sinks':[{'name':'s','type':'plane','point':[0,0,-9],'normal':[0,0,1]",
      shape);
  rig *r = load(body);
  rig_steps(r, n);
  return r;
}

/* A sphere that bounces, slides and rolls over the inner edges of a meshed plane takes the plane's path. */
START_TEST(test_rolling) {
  enum { N = 16 };
  char file[256], shape[512];
  snprintf(file, sizeof file, "%s/rolling_%d.stl", TANDEM_TEST_DIR, (int)getpid());
  tdm_vec3 corner[6 * N * N];
  tdm_stl stl = {0, corner};
  for (int i = 0; i < N; i++)
    for (int j = 0; j < N; j++) {
      double x = i / 4. - 2, y = j / 4. - 2, h = 0.25;
      tdm_vec3 c[] = {{x, y, 0}, {x + h, y, 0}, {x + h, y + h, 0}, {x, y + h, 0}};
      int k = (i * 5 + j * 3) % 4; /* diagonals and corners in turn */
      const int order[] = {k, k + 1, k + 2, k, k + 2, k + 3};
      for (int o = 0; o < 6; o++)
        corner[3 * stl.count + o] = c[order[o] % 4];
      stl.count += 2;
    }
  tdm_error err = {0};
  ck_assert(!tdm_stl_write(&stl, file, &err));
  snprintf(shape, sizeof shape, "{'type':'mesh','file':'%s'}", file);
  for (long n = 20000; n <= 120000; n += 50000) {
    rig *plane = slide("{'type':'plane','normal':[0,0,1]}", n), *mesh = slide(shape, n);
    const dem_data *a = plane->data, *b = mesh->data;
    ck_assert_double_gt(a->state.sphere[0].position.x, -0.9);
    ck_vector(b->state.sphere[0].position, a->state.sphere[0].position, 1e-10);
    ck_vector(b->state.pace[0].velocity, a->state.pace[0].velocity, 1e-10);
    ck_vector(b->state.pace[0].spin, a->state.pace[0].spin, 1e-9);
    ck_vector(b->state.body_load[0].force, a->state.body_load[0].force, 1e-10 * tdm_norm(a->state.body_load[0].force));
    rig_free(plane);
    rig_free(mesh);
  }
  unlink(file);
}
END_TEST

static rig *on_moving(const char *shape, const char *motion, double x, double z) {
  char text[2048];
  snprintf(text, sizeof text,
           "{'materials':[{'name':'m','density':2500,'young_modulus':2e6,'poisson_ratio':0.25}],"
           "'pairs':[{'materials':['m','m'],'restitution':0.5,'friction':0.5}],"
           "'bodies':[{'name':'b','material':'m','shapes':[%s]%s}],"
           "'particles':[{'type':'list','material':'m','radius':0.01,'positions':[[%g,0,%g]]}]}",
           shape, motion, x, z);
  rig *r = rig_make(scene_json("%s", text), 1e-4, 0, NULL);
  rig_steps(r, 10000);
  return r;
}

/* A sphere in a groove of four triangles comes to rest on both sides of it, as between two planes. */
START_TEST(test_groove) {
  char file[256], shape[512];
  snprintf(file, sizeof file, "%s/groove_%d.stl", TANDEM_TEST_DIR, (int)getpid());
  tdm_vec3 corner[] = {{-1, -1, 1}, {0, -1, 0}, {0, 1, 0}, {-1, -1, 1}, {0, 1, 0}, {-1, 1, 1},
                       {0, -1, 0},  {1, -1, 1}, {1, 1, 1}, {0, -1, 0},  {1, 1, 1}, {0, 1, 0}};
  tdm_stl stl = {4, corner};
  tdm_error err = {0};
  ck_assert(!tdm_stl_write(&stl, file, &err));
  snprintf(shape, sizeof shape, "{'type':'mesh','file':'%s'}", file);
  rig *mesh = on_moving(shape, "", 0.003, 0.02);
  rig *planes = on_moving("{'type':'plane','normal':[1,0,1]},{'type':'plane','normal':[-1,0,1]}", "", 0.003, 0.02);
  ck_assert_int_eq(mesh->data->state.ncontact, 2);
  ck_assert_int_eq(planes->data->state.ncontact, 2);
  ck_vector(mesh->data->state.sphere[0].position, planes->data->state.sphere[0].position, 1e-9);
  ck_assert_double_lt(tdm_norm(mesh->data->state.pace[0].velocity), 1e-6);
  rig_free(mesh);
  rig_free(planes);
  unlink(file);
}
END_TEST

/* A sphere put on a belt slides until its lowest point has the belt's speed: 2/7 of that for the centre, but that the
 * overlap shortens the arm. A plane that moves as a whole does the same. */
START_TEST(test_belt) {
  static const char *const belts[] = {
      "{'type':'plane','normal':[0,0,1],'surface_velocity':[0.5,0.25,0]}",
      "{'type':'box','side':'outside','size':[4,4,1],'center':[0,0,-0.5],'surface_velocity':[0.5,0.25,0]}"};
  rig *belt = on_moving(belts[_i], "", 0, 0.01);
  rig *whole = on_moving("{'type':'plane','normal':[0,0,1]}", ",'motion':{'velocity':[0.5,0.25,0]}", 0, 0.01);
  const dem_data *d = belt->data;
  double arm = d->state.sphere[0].position.z / 0.01, share = 1 / (1 + 2.5 * arm * arm), turn = 2.5 * arm * share;
  ck_vector(d->state.pace[0].velocity, tdm_v3(0.5 * share, 0.25 * share, 0), 1e-4);
  ck_vector(tdm_scale(0.01, d->state.pace[0].spin), tdm_v3(0.25 * turn, -0.5 * turn, 0), 1e-4);
  ck_vector(d->state.sphere[0].position, whole->data->state.sphere[0].position, 1e-12);
  ck_vector(d->state.pace[0].velocity, whole->data->state.pace[0].velocity, 1e-12);
  ck_vector(d->state.pace[0].spin, whole->data->state.pace[0].spin, 1e-10);
  rig_free(belt);
  rig_free(whole);
}
END_TEST

/* A drum whose surface spins does what a drum that turns does. */
START_TEST(test_spinning_surface) {
  rig *spin =
      on_moving("{'type':'cylinder','side':'inside','axis':[0,1,0],'radius':0.2,'surface_spin':3}", "", 0, -0.19);
  rig *turn = on_moving("{'type':'cylinder','side':'inside','axis':[0,1,0],'radius':0.2}",
                        ",'motion':{'angular_velocity':[0,3,0]}", 0, -0.19);
  ck_assert_double_gt(tdm_norm(turn->data->state.pace[0].spin), 1);
  ck_vector(spin->data->state.sphere[0].position, turn->data->state.sphere[0].position, 1e-9);
  ck_vector(spin->data->state.pace[0].spin, turn->data->state.pace[0].spin, 1e-6);
  rig_free(spin);
  rig_free(turn);
}
END_TEST

/* A mesh of one square, corners in order around it; the caller unlinks the file. */
static void write_square(char file[256], const char *name, const tdm_vec3 c[4]) {
  tdm_vec3 corner[6] = {c[0], c[1], c[2], c[0], c[2], c[3]};
  tdm_error err = {0};
  snprintf(file, 256, "%s/%s_%d.stl", TANDEM_TEST_DIR, name, (int)getpid());
  ck_assert(!tdm_stl_write(&(tdm_stl){2, corner}, file, &err));
}

/* ramps at 45 degrees towards +x, z = x; the belt's velocity is given along x, [0.8, 0.6, 0] or along the slope */
static const char *const ramps[] = {
    "{'type':'mesh','file':'%s','surface_velocity':[1,0,0]}",
    "{'type':'plane','normal':[-1,0,1],'surface_velocity':[1,0,0]}",
    "{'type':'box','side':'outside','size':[4,4,1],'center':[0.35355339059327379,0,-0.35355339059327379],"
    "'orientation':[0.92387953251128674,0,-0.38268343236508977,0],'surface_velocity':[1,0,0]}",
    "{'type':'plane','normal':[-1,0,1],'surface_velocity':[0.70710678118654752,0,0.70710678118654752]}",
};

/* A belt keeps its speed on a slope, whatever the shape and however its velocity is given: the surface moves with 1 m/s
 * along the slope, not with the part of it that lies along x. */
START_TEST(test_belt_slope) {
  char file[256], shape[512];
  write_square(file, "ramp", (tdm_vec3[]){{-2, -2, -2}, {2, -2, 2}, {2, 2, 2}, {-2, 2, -2}});
  snprintf(shape, sizeof shape, ramps[_i], file);
  char body[1024];
  snprintf(body, sizeof body, "'shapes':[%s]", shape);
  rig *r = load(body);
  unlink(file);
  const double s = sqrt(0.5);
  tdm_vec3 n, x = {0.3, 0.1, 0.4};
  gap_at(r, 0, x.x, x.y, x.z, &n);
  ck_vector(n, tdm_v3(-s, 0, s), 1e-7);
  ck_vector(dem_wall_surface(&r->model->wall[0], &r->data->state.wall[0], x, n), tdm_v3(s, 0, s), 1e-7);
  /* where the surface stands across the velocity there is none */
  tdm_vec3 across = dem_wall_belt(&r->model->wall[0], tdm_v3(0, 0, 0));
  across = tdm_unit(tdm_m3_mul(r->data->state.wall[0].axes, across));
  ck_vector(dem_wall_surface(&r->model->wall[0], &r->data->state.wall[0], x, across), tdm_v3(0, 0, 0), 0);
  rig_free(r);
}
END_TEST

/* A sphere that cannot roll is carried up a ramp of 45 degrees: at the belt's speed, along the slope. */
START_TEST(test_belt_carries) {
  char file[256], text[2048];
  write_square(file, "carry", (tdm_vec3[]){{-2, -2, -2}, {2, -2, 2}, {2, 2, 2}, {-2, 2, -2}});
  snprintf(text, sizeof text,
           "{'contact':{'rolling':'constant-torque'},'materials':[{'name':'m','density':2500,'young_modulus':5e6,"
           "'poisson_ratio':0.3}],'pairs':[{'materials':['m','m'],'restitution':0.2,'friction':1.5,'rolling_friction':"
           "2}],'bodies':[{'name':'b','material':'m','shapes':[{'type':'mesh','file':'%s','surface_velocity':[1,0,0]}]}"
           "],'particles':[{'type':'list','material':'m','radius':0.02,'positions':[[-0.01414,0,0.01414]]}]}",
           file);
  rig *r = rig_make(scene_json("%s", text), 2e-5, 0, NULL);
  unlink(file);
  rig_steps(r, 25000);
  tdm_vec3 v = r->data->state.pace[0].velocity;
  ck_near(tdm_norm(v), 1, 1e-3);
  ck_near(v.x, v.z, 1e-9);
  rig_free(r);
}
END_TEST

/* A belt that turns in plan is a disc that turns about the same axis, on any shape; what is put on it is carried round.
 * At 0.1 m and 3 rad/s friction of 0.5 holds it. */
START_TEST(test_belt_turns) {
#define TURNS ",'surface_rotation':{'point':[0.1,0,0],'axis':[0,0,2],'rate':3}}"
  static const char *const belts[] = {
      "{'type':'plane','normal':[0,0,1],'point':[0.3,-0.2,0]" TURNS,
      "{'type':'box','side':'outside','size':[4,4,1],'center':[0.2,0.1,-0.5],"
      "'orientation':[0.70710678118654752,0,0,0.70710678118654752]" TURNS,
      "{'type':'cylinder','side':'outside','point':[0.2,0.1,0],'axis':[0,0,-1],'radius':2,'length':1" TURNS,
      "{'type':'cylinder','side':'outside','point':[0.1,0,0],'axis':[0,0,-1],'radius':2,'length':1,'surface_spin':-3}",
      "{'type':'mesh','file':'%s'" TURNS};
#undef TURNS
  char file[256], shape[512];
  write_square(file, "turns", (tdm_vec3[]){{-2, -2, 0}, {2, -2, 0}, {2, 2, 0}, {-2, 2, 0}});
  snprintf(shape, sizeof shape, belts[_i], file);
  rig *belt = on_moving(shape, "", 0, 0.01);
  unlink(file);
  rig *whole = on_moving("{'type':'plane','normal':[0,0,1]}",
                         ",'motion':{'angular_velocity':[0,0,3],'center':[0.1,0,0]}", 0, 0.01);
  ck_assert_double_gt(tdm_norm(whole->data->state.pace[0].velocity), 0.05);
  ck_vector(belt->data->state.sphere[0].position, whole->data->state.sphere[0].position, 1e-9);
  ck_vector(belt->data->state.pace[0].velocity, whole->data->state.pace[0].velocity, 1e-8);
  double fastest = dem_expected_speed(belt->data);
  ck_assert_double_gt(fastest, 0.29);
  rig_free(belt);
  rig_free(whole);
}
END_TEST

TEST_MAIN_ROWS("dem_geometry", {test_shell, 5}, {test_solid, 5}, {test_round_exact, 1}, {test_driven, 1},
               {test_belt, 2}, {test_spinning_surface, 1}, {test_belt_slope, 4}, {test_belt_carries, 1},
               {test_belt_turns, 5}, {test_refused, 1}, {test_read, 1}, {test_read_mesh, 1}, {test_rolling, 1},
               {test_groove, 1})
