/* Mobility of bodies: the effective mass in the damping of contacts with them, against closed forms and in an impact on
 * a hinged body; the stiffness with which contacts hold the bodies, against closed forms. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/numerics/test_dem_support.h"
#include "tests/test_main.h"

#include "dem/bodies/wall_stiffness.h"
#include "dem/bodies/walls.h"
#include "dem/numbers/simd_set.h"
#include "dem/particles/create.h"

#include <unistd.h>

enum { N = 9 }; /* particles: the loops take four or eight of a plane at a time, and one is left */

static const double stiffness = 1e5, restitution = 0.3, depth = 1e-4;
static const tdm_vec3 center = {0.1, -0.2, 0.3}; /* of the body's mass; its upper face is at z = 0 */

/* ---- scenes ---- */

typedef enum { PLANE, BOX, MESH, SHAPES } shape;

static const char *mesh_file(void) {
  static char path[256];
  snprintf(path, sizeof path, "%s/mobility_%d.stl", TANDEM_TEST_DIR, (int)getpid());
  return path;
}

/* two squares that meet at the y axis of the body, raised by `rise` [m] one metre away from it */
static void write_mesh(double rise) {
  FILE *f = fopen(mesh_file(), "w");
  ck_assert_ptr_nonnull(f);
  fprintf(f, "solid a\n");
  for (int side = -1; side <= 1; side += 2)
    for (int half = 0; half < 2; half++) {
      const double corner[4][3] = {{0, -1, 0}, {side, -1, rise}, {side, 1, rise}, {0, 1, 0}};
      fprintf(f, "facet normal 0 0 1\nouter loop\n");
      for (int k = 0; k < 3; k++) {
        const double *c = corner[half == 0 ? k : (k + 2) % 4];
        fprintf(f, "vertex %.17g %.17g %.17g\n", c[0], c[1], c[2]);
      }
      fprintf(f, "endloop\nendfacet\n");
    }
  fprintf(f, "endsolid a\n");
  fclose(f);
}

static const char *shape_of(shape s) {
  static char text[512];
  tdm_vec3 up = tdm_scale(-1, center); /* the origin in body axes */
  if (s == PLANE)
    snprintf(text, sizeof text, "{'type':'plane','normal':[0,0,1],'point':[%g,%g,%g]}", up.x, up.y, up.z);
  if (s == BOX)
    snprintf(text, sizeof text, "{'type':'box','side':'outside','size':[2,2,2],'center':[%g,%g,%g]}", up.x, up.y,
             up.z - 1);
  if (s == MESH)
    snprintf(text, sizeof text, "{'type':'mesh','file':'%s','position':[%g,%g,%g]}", mesh_file(), up.x, up.y, up.z);
  return text;
}

/* N particles of 1 kg that have come `depth` into the upper face, at places in a row; extra: more keys of the scene */
static rig *bed_on(shape s, const char *contact, const char *extra, double mass) {
  char places[1024] = "";
  for (int i = 0; i < N; i++)
    snprintf(places + strlen(places), sizeof places - strlen(places), "%s[%g,%g,%.17g]", i ? "," : "", 0.15 * i - 0.63,
             0.1 * (i % 3) - 0.13, 0.05 - depth);
  tdm_assigned_body body = {.name = "body", .mass = mass, .state = state_at(center.x, center.y, center.z)};
  json_t *json =
      scene_json("{'gravity':[0,0,0],'materials':[{'name':'a','density':1e3,'young_modulus':1e7,'poisson_ratio':0.3}],"
                 "'pairs':[{'materials':['a','a'],'restitution':%g,%s}],"
                 "'bodies':[{'name':'body','material':'a','shapes':[%s]}],"
                 "'particles':[{'type':'list','material':'a','radius':0.05,'mass':1,'positions':[%s]}]%s}",
                 restitution, contact, shape_of(s), places, extra);
  return rig_make(json, 1e-5, 1, &body);
}

#define HOOKE "'contact':{'normal':'hooke','tangential':'none'}"
#define HOOKE_PAIR "'stiffness':1e5"
#define MINDLIN_PAIR "'friction':0.5"

/* Y = D + c c^T: of a body that turns about an axis, and more */
static void matrix(double Y[36], const double diagonal[6], const double c[6]) {
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 6; j++)
      Y[6 * i + j] = (i == j ? diagonal[i] : 0) + c[i] * c[j];
}

/* of a body that turns about the axis through `pivot`, with this inertia about it */
static void hinge(double Y[36], tdm_vec3 axis, tdm_vec3 pivot, double inertia) {
  tdm_vec3 v = tdm_scale(sqrt(1 / inertia), tdm_cross(axis, tdm_sub(center, pivot)));
  tdm_vec3 w = tdm_scale(sqrt(1 / inertia), axis);
  matrix(Y, (double[6]){0}, (double[6]){v.x, v.y, v.z, w.x, w.y, w.z});
}

/* what the approach with speed `rate` along z adds to the force on particle i [N] */
static double damping_force(rig *r, int i, double rate) {
  double force[2];
  for (int k = 0; k < 2; k++) {
    r->data->state.pace[i].velocity.z = k ? -rate : 0;
    forces_now(r->data, false);
    force[k] = r->data->state.push[i].force.z;
  }
  return force[1] - force[0];
}

/* 2 zeta sqrt(k m*), zeta from e */
static double hooke_damping(double per_mass) {
  double l = log(restitution), zeta = -l / sqrt(M_PI * M_PI + l * l);
  return 2 * zeta * sqrt(stiffness / per_mass);
}

/* ---- the damping ---- */

static void check_damping(rig *r, double (*per_mass)(tdm_vec3 contact), const char *what) {
  for (int i = 0; i < N; i++) {
    tdm_vec3 x = r->data->state.sphere[i].position;
    double force = damping_force(r, i, 0.2), expected = 0.2 * hooke_damping(per_mass(tdm_v3(x.x, x.y, 0)));
    ck_assert_msg(fabs(force - expected) < 1e-9 * expected, "%s, particle %d: %.15g instead of %.15g N", what, i, force,
                  expected);
  }
}

/* closed forms of 1/m* at a point of the face, normal z */
static const double body_mass = 0.7, inertia[3] = {0.02, 0.03, 0.05}, hinge_inertia = 0.3;
static const tdm_vec3 pivot = {-0.4, 0.5, 0.2};

static double per_own_mass(tdm_vec3 x) {
  (void)x;
  return 1 + 1 / body_mass;
}

static double per_particle(tdm_vec3 x) {
  (void)x;
  return 1;
}

static double per_heavy(tdm_vec3 x) {
  (void)x;
  return 1 + 1e-8;
}

static double per_free(tdm_vec3 x) {
  double rx = x.x - center.x, ry = x.y - center.y;
  return 1 + 1 / body_mass + ry * ry / inertia[0] + rx * rx / inertia[1];
}

/* about y through the pivot: the point moves along z by the way from the pivot along x */
static double per_hinged(tdm_vec3 x) {
  return 1 + (x.x - pivot.x) * (x.x - pivot.x) / hinge_inertia;
}

START_TEST(test_damping) {
  static const char *const names[] = {"plane", "box", "mesh"};
  double Y[36];
  write_mesh(0);
  for (int energy = 0; energy < 2; energy++)
    for (shape s = PLANE; s < SHAPES; s++) {
      rig *r = bed_on(s, HOOKE_PAIR, energy ? "," HOOKE ",'energy':true" : "," HOOKE, body_mass);
      check_damping(r, per_own_mass, names[s]); /* until there is a mobility */
      const double one[6] = {1 / body_mass,  1 / body_mass,  1 / body_mass,
                             1 / inertia[0], 1 / inertia[1], 1 / inertia[2]};
      matrix(Y, one, (double[6]){0});
      dem_set_body_mobility(r->data, 0, Y);
      check_damping(r, per_free, names[s]);
      hinge(Y, tdm_v3(0, 1, 0), pivot, hinge_inertia);
      dem_set_body_mobility(r->data, 0, Y);
      check_damping(r, per_hinged, names[s]);
      matrix(Y, (double[6]){1 / body_mass, 1 / body_mass, 1 / body_mass}, (double[6]){0});
      dem_set_body_mobility(r->data, 0, Y);
      check_damping(r, per_own_mass, names[s]);
      matrix(Y, (double[6]){3, 4}, (double[6]){0}); /* blocked along the normal */
      dem_set_body_mobility(r->data, 0, Y);
      check_damping(r, per_particle, names[s]);
      dem_set_body_mobility(r->data, 0, (double[36]){0});
      check_damping(r, per_particle, names[s]);
      hinge(Y, tdm_v3(0, 1, 0), pivot, hinge_inertia);
      dem_set_body_mobility(r->data, 0, Y);
      check_damping(r, per_hinged, names[s]);
      rig_free(r);
    }
  unlink(mesh_file());
}
END_TEST

START_TEST(test_bodies_without_mobility) {
  double Y[36];
  hinge(Y, tdm_v3(0, 1, 0), pivot, hinge_inertia);
  /* a wall mass of the scene's is taken instead */
  rig *r = bed_on(PLANE, HOOKE_PAIR, ",'contact':{'normal':'hooke','tangential':'none','wall_mass':1e8}", body_mass);
  dem_set_body_mobility(r->data, 0, Y);
  check_damping(r, per_heavy, "wall mass");
  rig_free(r);
  /* bodies that the scene moves, or that stand still */
  for (int moves = 0; moves < 2; moves++) {
    r = rig_make(
        scene_json("{'gravity':[0,0,0],'materials':[{'name':'a','density':1e3,'young_modulus':1e7,"
                   "'poisson_ratio':0.3}],'pairs':[{'materials':['a','a'],'restitution':%g,'stiffness':1e5}]," HOOKE ","
                   "'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]%s}],"
                   "'particles':[{'type':'block','material':'a','radius':0.05,'mass':1,'count':[9,1,1],"
                   "'corner':[0,0,%g]}]}",
                   restitution, moves ? ",'motion':{'velocity':[1,0,0]}" : "", 0.05 - depth),
        1e-5, 0, NULL);
    check_damping(r, per_particle, moves ? "driven" : "fixed");
    rig_free(r);
  }
}
END_TEST

START_TEST(test_same_bits) {
  /* planes eight or four at a time, one at a time (energy), each instruction set, a copy; friction, normal askew */
  const double diagonal[6] = {0.3, 0.7, 1.1, 5, 9, 2}, c[6] = {0.5, -0.3, 0.8, 1.7, -2.3, 0.9};
  double Y[36];
  matrix(Y, diagonal, c);
  tdm_wrench load[2] = {0};
  tdm_vec3 force[2][N];
  for (int way = 0; dem_simd_names[way / 2]; way++) {
    if (!dem_simd_here(dem_simd_names[way / 2]))
      continue;
    char extra[128];
    snprintf(extra, sizeof extra, ",'simd':'%s'%s", dem_simd_names[way / 2], way % 2 ? ",'energy':true" : "");
    rig *r = bed_on(PLANE, MINDLIN_PAIR, extra, body_mass);
    r->data->state.pose[0].orientation = tdm_quat_from_rotvec(tdm_v3(1e-4, 2e-4, 0.3));
    r->data->state.twist[0] = (tdm_twist){{0.1, 0.2, 0.3}, {-0.1, 0.4, 0.2}};
    dem_set_body_mobility(r->data, 0, Y);
    dem_data *copy = dem_data_create(r->model);
    ck_assert(copy && !dem_data_copy(copy, r->data));
    for (int k = 0; k < 2; k++) {
      dem_data *d = k ? copy : r->data;
      int to = load[0].force.z != 0;
      forces_now(d, false);
      ck_assert_int_eq(d->state.ncontact, N);
      load[to] = d->state.body_load[0];
      for (int i = 0; i < N; i++)
        force[to][i] = d->state.push[i].force;
      ck_assert_msg(!to ||
                        (!memcmp(&load[0], &load[1], sizeof load[0]) && !memcmp(force[0], force[1], sizeof force[0])),
                    "%s%s", extra, k ? ", copy" : "");
    }
    dem_data_destroy(&copy);
    rig_free(r);
  }
  ck_assert_double_gt(-load[1].force.z, 0);
}
END_TEST

START_TEST(test_fixed_particles) {
  /* against a body that a joint keeps from giving way the damping stays finite; against one that cannot move at all
   * there is no contact */
  rig *r = bed_on(PLANE, HOOKE_PAIR, "," HOOKE, body_mass);
  json_t *scene = json_deep_copy(r->json), *group = json_array_get(json_object_get(scene, "particles"), 0);
  rig_free(r);
  json_object_set_new(group, "fixed", json_true());
  tdm_assigned_body body = {.name = "body", .mass = body_mass, .state = state_at(center.x, center.y, center.z)};
  r = rig_make(scene, 1e-5, 1, &body);
  dem_data *d = r->data;
  double force[2], Y[36];
  matrix(Y, (double[6]){3, 4}, (double[6]){0});
  dem_set_body_mobility(d, 0, Y);
  for (int k = 0; k < 2; k++) {
    d->state.twist[0].velocity.z = 0.2 * k;
    forces_now(d, false);
    force[k] = d->state.body_load[0].force.z;
  }
  ck_relative(force[0], -N * stiffness * depth, 1e-9);
  ck_relative(force[1] - force[0], -N * 0.2 * hooke_damping(1e-3 / body_mass), 1e-9);
  dem_set_body_mobility(d, 0, (double[36]){0});
  forces_now(d, false);
  ck_assert_double_eq(d->state.body_load[0].force.z, 0);
  rig_free(r);
}
END_TEST

/* e of a particle of 1 kg that hits a hinged block off its centre; steps of the block here, with n = 1 */
static double hit_hinged(bool sets) {
  const double dt = 2e-6, about = 0.1 + body_mass * (0.3 * 0.3 + 0.1 * 0.1); /* hinge at the origin, axis y */
  tdm_assigned_body body = {.name = "body", .mass = body_mass, .state = state_at(0.3, 0, -0.1)};
  rig *r = rig_make(
      scene_json(
          "{'gravity':[0,0,0],'materials':[{'name':'a','density':1e3,'young_modulus':1e7,'poisson_ratio':0.3}],"
          "'pairs':[{'materials':['a','a'],'restitution':0.5}],'contact':{'tangential':'none'},"
          "'bodies':[{'name':'body','material':'a','shapes':[{'type':'box','side':'outside','size':[2,1,0.2]}]}],"
          "'particles':[{'type':'list','material':'a','radius':0.05,'mass':1,'positions':[[0.8,0,0.05]],"
          "'velocity':[0,0,-0.1]}]}"),
      dt, 1, &body);
  tdm_vec3 arm = body.state.pose.position;
  double angle = 0, speed = 0, torque = 0, Y[36];
  tdm_state now = body.state;
  do {
    speed += 0.5 * dt * torque / about;
    angle += dt * speed;
    tdm_state next;
    next.pose.orientation = tdm_quat_from_rotvec(tdm_v3(0, angle, 0));
    next.pose.position = tdm_quat_rotate(next.pose.orientation, arm);
    next.twist.angular = tdm_v3(0, speed + 0.5 * dt * torque / about, 0);
    next.twist.velocity = tdm_cross(next.twist.angular, next.pose.position);
    tdm_vec3 c = tdm_scale(sqrt(1 / about), tdm_cross(tdm_v3(0, 1, 0), next.pose.position));
    matrix(Y, (double[6]){0}, (double[6]){c.x, c.y, c.z, 0, sqrt(1 / about), 0});
    if (sets)
      dem_set_body_mobility(r->data, 0, Y);
    dem_path path = dem_path_make(&now, &next, dt, TDM_LINEAR);
    one_step(r->data, &path, dt);
    tdm_wrench load = r->data->state.body_load[0];
    torque = load.moment.y + tdm_cross(next.pose.position, load.force).y;
    speed += 0.5 * dt * torque / about;
    now = next;
  } while (r->data->state.ncontact > 0);
  double e = (r->data->state.pace[0].velocity.z + 0.8 * speed) / 0.1;
  rig_free(r);
  return e;
}

START_TEST(test_impact_on_hinge) {
  ck_near(hit_hinged(true), 0.5, 1e-3);
  ck_assert_double_gt(fabs(hit_hinged(false) - 0.5), 0.02); /* the mass alone is not what the particle feels */
}
END_TEST

/* ---- the stiffness that holds the bodies ---- */

static double walls_rate2(dem_data *d, int nfree, const double *J, const double *B) {
  tdm_error err = {0};
  double out;
  ck_assert(!dem_walls_rate2(d, nfree, J, B, &out, &err));
  return out;
}

/* by f independent velocities J (6 x f) with the inertias M of each, B = M^-1 J^T */
static double rate2(const rig *r, int f, const double *J, const double *M) {
  double B[36];
  for (int i = 0; i < f; i++)
    for (int q = 0; q < 6; q++)
      B[6 * i + q] = J[f * q + i] / M[i];
  return walls_rate2(r->data, f, J, B);
}

START_TEST(test_rate_of_slider) {
  static const double up[6] = {0, 0, 1}, along[6] = {1}, mass = 0.7;
  write_mesh(0);
  for (shape s = PLANE; s < SHAPES; s++) {
    rig *r = bed_on(s, HOOKE_PAIR, "," HOOKE, body_mass);
    ck_relative(rate2(r, 1, up, &mass), N * stiffness / mass, 1e-9);
    ck_near(rate2(r, 1, along, &mass), 0, 1e-6);
    /* what is no contact any more does not count */
    r->data->state.sphere[0].position.z += 2 * depth;
    ck_relative(rate2(r, 1, up, &mass), (N - 1) * stiffness / mass, 1e-9);
    for (int i = 1; i < N; i++)
      r->data->state.sphere[i].position.z += 2 * depth;
    ck_assert_double_eq(rate2(r, 1, up, &mass), 0);
    ck_assert_double_eq(walls_rate2(r->data, 0, NULL, NULL), 0);
    rig_free(r);
  }
  unlink(mesh_file());
  rig *r = bed_on(PLANE, MINDLIN_PAIR, "", body_mass); /* S_n = 2 E* a, S_t = 8 G* a with the circle a */
  const double a = sqrt(0.05 * depth), young = 1e7 / (2 * (1 - 0.09)), shear = 1e7 / (2 * 1.3) / (2 * 1.7);
  ck_relative(rate2(r, 1, up, &mass), N * 2 * young * a / mass, 1e-9);
  ck_relative(rate2(r, 1, along, &mass), N * 8 * shear * a / mass, 1e-9);
  rig_free(r);
}
END_TEST

START_TEST(test_rate_of_hinge) {
  rig *r = bed_on(PLANE, HOOKE_PAIR, "," HOOKE, body_mass);
  tdm_vec3 v = tdm_cross(tdm_v3(0, 1, 0), tdm_sub(center, pivot));
  const double J[6] = {v.x, v.y, v.z, 0, 1, 0}, M = hinge_inertia;
  double sum = 0;
  for (int i = 0; i < N; i++)
    sum += pow(r->data->state.sphere[i].position.x - pivot.x, 2);
  ck_relative(rate2(r, 1, J, &M), stiffness * sum / M, 1e-9);
  rig_free(r);
}
END_TEST

START_TEST(test_rate_of_free_body) {
  /* one contact: k n Y_c n; two directions at once: the larger root; inertias and units far apart */
  rig *r = bed_on(PLANE, HOOKE_PAIR, "," HOOKE, body_mass);
  double identity[36] = {0}, M[6] = {body_mass, body_mass, body_mass, inertia[0], inertia[1], inertia[2]};
  for (int i = 0; i < 6; i++)
    identity[7 * i] = 1;
  for (int i = 0; i < N; i++)
    if (i != 2)
      r->data->state.sphere[i].position.z += 1;
  tdm_vec3 x = r->data->state.sphere[2].position;
  double per_mass = per_free(tdm_v3(x.x, x.y, 0)) - 1;
  ck_relative(rate2(r, 6, identity, M), stiffness * per_mass, 1e-9);
  for (int i = 0; i < 6; i++) { /* the same body in other units of its velocities */
    identity[7 * i] *= pow(10, 2 * i - 5);
    M[i] *= pow(100, 2 * i - 5);
  }
  ck_relative(rate2(r, 6, identity, M), stiffness * per_mass, 1e-9);

  r->data->state.sphere[7].position.z -= 1;
  double x1 = x.x - center.x, x2 = r->data->state.sphere[7].position.x - center.x, m = body_mass, i = inertia[1];
  const double J[12] = {0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0}; /* up; about y, so that x rises by -x */
  double a = 2 * stiffness / m, b = stiffness * (x1 + x2) / sqrt(m * i), c = stiffness * (x1 * x1 + x2 * x2) / i;
  double root = 0.5 * (a + c) + sqrt(0.25 * (a - c) * (a - c) + b * b);
  ck_relative(rate2(r, 2, J, (double[2]){m, i}), root, 1e-9);
  rig_free(r);
}
END_TEST

START_TEST(test_rate_of_two_bodies) {
  /* two plates that a linkage moves against each other, one at twice the other's way; a floor that is not coupled
   * touches as well and holds nothing */
  tdm_assigned_body body[2] = {{.name = "low", .mass = 1, .state = state_at(0, 0, 0)},
                               {.name = "high", .mass = 2, .state = state_at(0, 0, 0.1 - 2 * depth)}};
  rig *r = rig_make(
      scene_json("{'gravity':[0,0,0],'materials':[{'name':'a','density':1e3,'young_modulus':1e7,'poisson_ratio':0.3}],"
                 "'pairs':[{'materials':['a','a'],'restitution':0.5,'stiffness':1e5}]," HOOKE ",'bodies':["
                 "{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]},"
                 "{'name':'high','material':'a','shapes':[{'type':'plane','normal':[0,0,-1]}]},"
                 "{'name':'low','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                 "'particles':[{'type':'list','material':'a','radius':0.05,'positions':[[0,0,%g],[1,0,%g]]}]}",
                 0.05 - depth, 0.05 - depth),
      1e-5, 2, body);
  const double mass = 1 + 4 * 2; /* of the linkage */
  double J[12] = {[2] = 1, [8] = -2}, B[12] = {[2] = 1 / mass, [8] = -2 / mass};
  ck_relative(walls_rate2(r->data, 1, J, B), 2 * stiffness * (1 + 4) / mass, 1e-9);
  /* each on its own: the stiffer of the two, and J with two columns */
  double J2[24] = {[2 * 2] = 1, [2 * 8 + 1] = 1}, B2[24] = {[2] = 1, [12 + 8] = 0.5};
  ck_relative(walls_rate2(r->data, 2, J2, B2), 2 * stiffness, 1e-9);
  rig_free(r);
}
END_TEST

START_TEST(test_rate_in_groove) {
  /* a ball in a groove of a mesh: both of its contacts hold the body across it */
  const double rise = 0.5, radius = 0.05, slope = atan(rise), mass = 0.7;
  write_mesh(rise);
  tdm_assigned_body body = {.name = "body", .mass = mass, .state = state_at(0, 0, 0)};
  rig *r = rig_make(
      scene_json("{'gravity':[0,0,0],'materials':[{'name':'a','density':1e3,'young_modulus':1e7,'poisson_ratio':0.3}],"
                 "'pairs':[{'materials':['a','a'],'restitution':0.5,'stiffness':1e5}]," HOOKE ",'bodies':["
                 "{'name':'body','material':'a','shapes':[{'type':'mesh','file':'%s'}]}],'particles':["
                 "{'type':'list','material':'a','radius':0.05,'positions':[[0,0,%.17g]]}]}",
                 mesh_file(), (radius - depth) / cos(slope)),
      1e-5, 1, &body);
  ck_assert_int_eq(r->data->state.ncontact, 2);
  ck_relative(rate2(r, 1, (double[6]){1}, &mass), 2 * stiffness * pow(sin(slope), 2) / mass, 1e-9);
  ck_relative(rate2(r, 1, (double[6]){0, 0, 1}, &mass), 2 * stiffness * pow(cos(slope), 2) / mass, 1e-9);
  rig_free(r);
  unlink(mesh_file());
}
END_TEST

TEST_MAIN("dem mobility", test_damping, test_bodies_without_mobility, test_same_bits, test_fixed_particles,
          test_impact_on_hinge, test_rate_of_slider, test_rate_of_hinge, test_rate_of_free_body,
          test_rate_of_two_bodies, test_rate_in_groove)
