/* The engine as a whole: conservation, neighbour lists, copies, windows, wrenches, settling, paths. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/bodies/walls.h"
#include "dem/geometry/shape/rows.h"
#include "dem/particles/create.h"
#include "dem/search/pairs.h"
#include "dem/settle/settle.h"
#include "dem/watch/check.h"
#include "dem/watch/limits.h"
#include "tests/test_main.h"

/* A cloud of spheres of two sizes in a closed box that turns and moves. */
static json_t *cloud_json(int n, double e, const char *more) {
  return scene_json("{'materials': [{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],"
                    "'pairs': [{'materials':['a','a'],'restitution':%g,'friction':0.4}],"
                    "'bodies': [{'name':'box','material':'a','shapes':["
                    "   {'type':'box','side':'inside','size':[1,1,1]},"
                    "   {'type':'box','side':'outside','size':[0.2,0.3,0.2],'center':[0.1,0,-0.3]}]}],"
                    "'particles': [{'type':'random','material':'a','count':%d,'radius':[0.03,0.05],'seed':3,"
                    "   'region':{'min':[-0.5,-0.5,-0.15],'max':[0.5,0.5,0.5]},'velocity':[1,0.5,-2]}]%s}",
                    e, n, more);
}

static rig *cloud(int n, double e, const char *more) {
  tdm_assigned_body box = {.name = "box", .mass = 50, .state = state_at(0, 0, 0)};
  return rig_make(cloud_json(n, e, more), 1e-4, 1, &box);
}

/* step k of a moving box: an oscillation and a turn */
static void shake(rig *r, long k0, long n) {
  for (long k = k0; k < k0 + n; k++) {
    tdm_state ends[2];
    for (int i = 0; i < 2; i++) {
      double t = (double)(k + i) * r->model->dt;
      ends[i] = state_at(0.1 * sin(9 * t), 0.05 * (1 - cos(11 * t)), 0.03 * sin(20 * t));
      ends[i].pose.orientation = tdm_quat_from_rotvec(tdm_v3(0.5 * sin(5 * t), 0.2 * t, 0.1 * sin(3 * t)));
    }
    dem_path path = dem_path_make(&ends[0], &ends[1], r->model->dt, TDM_LINEAR);
    one_step(r->data, &path, r->model->dt);
  }
}

static void same_particles(const dem_data *a, const dem_data *b) {
  size_t n = (size_t)a->model->nparticle;
  ck_assert_mem_eq(a->state.sphere, b->state.sphere, n * sizeof *a->state.sphere);
  ck_assert_mem_eq(a->state.pace, b->state.pace, n * sizeof *a->state.pace);
  ck_assert_mem_eq(a->state.push, b->state.push, n * sizeof *a->state.push);
  ck_assert_mem_eq(a->state.body_load, b->state.body_load, (size_t)a->model->nbody * sizeof(tdm_wrench));
  ck_assert_int_eq(a->state.ncontact, b->state.ncontact);
}

START_TEST(test_lists_miss_nothing) {
  /* a skin so wide that every pair is listed: brute force. Bit-identical, over many rebuilds. */
  rig *lists = cloud(200, 0.3, ""), *brute = cloud(200, 0.3, ",'skin':50"), *thin = cloud(200, 0.3, ",'skin':0.001");
  ck_assert_int_eq(brute->data->lists.pairs.first[199], 200 * 199 / 2);
  ck_assert_int_eq((int)brute->data->lists.walls.count, 200 * 7);
  long most = 0;
  for (int part = 0; part < 12; part++) {
    shake(lists, 100 * part, 100);
    shake(brute, 100 * part, 100);
    shake(thin, 100 * part, 100);
    most = lists->data->state.ncontact > most ? lists->data->state.ncontact : most;
    same_particles(lists->data, brute->data);
    same_particles(lists->data, thin->data);
  }
  ck_assert_int_gt(most, 15);
  ck_assert_uint_gt(lists->data->lists.nrebuild, 10);
  ck_assert_uint_gt(thin->data->lists.nrebuild, 2 * lists->data->lists.nrebuild);
  ck_assert_uint_eq(brute->data->lists.nrebuild, 1);
  rig_free(lists);
  rig_free(brute);
  rig_free(thin);
}
END_TEST

START_TEST(test_far_particle) {
  /* a particle very far away neither breaks the cells nor touches anything */
  rig *r = rig_make(scene_json("{'gravity':[0,0,0],"
                               "'materials': [{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],"
                               "'pairs': [{'materials':['a','a'],'restitution':1,'friction':0}],"
                               "'particles': [{'type':'block','material':'a','radius':0.01,'count':[4,4,4],"
                               "  'spacing':0.019999999998,'corner':[0,0,0]},"
                               " {'type':'list','material':'a','radius':0.02,'positions':[[1e9,-1e9,3]]}]}"),
                    1e-5, 0, NULL);
  ck_assert_int_eq(r->data->state.ncontact, 3 * 4 * 4 * 3);
  rig_free(r);
}
END_TEST

START_TEST(test_common_motion) {
  /* a bed that moves with its box needs no new lists */
  tdm_assigned_body box = {.name = "box", .mass = 50, .state = state_at(0, 0, 0)};
  rig *full = rig_make(cloud_json(50, 1, ",'gravity':[0,0,0]"), 1e-4, 1, &box);
  tdm_state now = box.state, next;
  for (int i = 0; i < 50; i++)
    full->data->state.pace[i].velocity = tdm_v3(1, 0, 0);
  for (int k = 0; k < 1000; k++) {
    next = now;
    next.pose.position.x += 1e-4;
    dem_path path = dem_path_make(&now, &next, 1e-4, TDM_LINEAR);
    one_step(full->data, &path, 1e-4);
    now = next;
  }
  ck_near(full->data->state.pose[0].position.x, 0.1, 1e-12);
  ck_assert_uint_eq(full->data->lists.nrebuild, 1);
  rig_free(full);
}
END_TEST

START_TEST(test_copy) {
  rig *r = cloud(100, 0.3, "");
  long k = 1000;
  shake(r, 0, k);
  while (r->data->state.ncontact < 10) /* histories matter */
    shake(r, k++, 1);
  ck_assert_int_lt(k, 5000);
  dem_data *copy = dem_data_create(r->model);
  ck_assert_int_eq(dem_data_copy(copy, r->data), TDM_OK);
  shake(r, k, 600);
  dem_data *first = r->data;
  r->data = copy;
  shake(r, k, 600);
  same_particles(first, copy);
  ck_assert_uint_eq(first->lists.nrebuild, copy->lists.nrebuild);
  ck_assert_uint_eq(first->state.nstep, copy->state.nstep);
  dem_data_destroy(&first);
  ck_assert_ptr_null(first);
  rig_free(r);
}
END_TEST

/* a gas of spheres without walls or gravity that runs into itself */
static rig *gas(double e, double mu) {
  rig *r = rig_make(scene_json("{'gravity':[0,0,0],"
                               "'materials': [{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],"
                               "'pairs': [{'materials':['a','a'],'restitution':%g,'friction':%g}],"
                               "'particles': [{'type':'random','material':'a','count':80,'radius':[0.03,0.05],"
                               "   'region':{'min':[-0.3,-0.3,-0.3],'max':[0.3,0.3,0.3]}}]}",
                               e, mu),
                    2e-5, 0, NULL);
  for (int i = 0; i < r->model->nparticle; i++) {
    tdm_vec3 x = r->model->position[i];
    r->data->state.pace[i].velocity = tdm_add(tdm_scale(-3, x), tdm_v3(0.1 * sin(i), -x.z, x.y));
    r->data->state.pace[i].spin = tdm_v3(cos(i), 2, sin(3 * i));
  }
  return r;
}

typedef struct {
  tdm_vec3 momentum, angular;
  double energy;
} totals;

static totals add_up(const rig *r) {
  totals t = {0};
  for (int i = 0; i < r->model->nparticle; i++) {
    double m = r->model->mass[i], inertia = 0.4 * m * r->model->radius[i] * r->model->radius[i];
    tdm_vec3 p = tdm_scale(m, r->data->state.pace[i].velocity), w = r->data->state.pace[i].spin;
    t.momentum = tdm_add(t.momentum, p);
    t.angular = tdm_add(t.angular, tdm_axpy(inertia, w, tdm_cross(r->data->state.sphere[i].position, p)));
    t.energy += 0.5 * tdm_dot(p, r->data->state.pace[i].velocity) + 0.5 * inertia * tdm_dot(w, w);
  }
  return t;
}

START_TEST(test_momentum) {
  rig *r = gas(0.7, 0.5);
  totals before = add_up(r);
  rig_steps(r, 10000);
  totals after = add_up(r);
  ck_near(tdm_norm(tdm_sub(after.momentum, before.momentum)), 0, 1e-12);
  ck_near(tdm_norm(tdm_sub(after.angular, before.angular)), 0, 1e-12);
  ck_assert(after.energy < 0.9 * before.energy); /* they did meet */
  rig_free(r);
}
END_TEST

START_TEST(test_energy) {
  rig *r = gas(1, 0);
  totals before = add_up(r);
  double least = before.energy;
  for (int k = 0; k < 200; k++) {
    rig_steps(r, 100);
    least = fmin(least, add_up(r).energy);
  }
  ck_assert(least < 0.999 * before.energy); /* some of it was in the contacts */
  ck_assert_int_eq(r->data->state.ncontact, 0);
  ck_relative(add_up(r).energy, before.energy, 1e-4);
  rig_free(r);
}
END_TEST

/* about the centre of particle i [N m] */
static tdm_vec3 torque(const dem_data *d, int i) {
  return tdm_scale(-d->state.sphere[i].radius, d->state.push[i].twist);
}

START_TEST(test_wrench) {
  /* without gravity the load on the body is minus the change of the particles' momentum, for force and moment */
  rig *r = cloud(300, 0.6, ",'gravity':[0,0,0]");
  shake(r, 0, 600);
  long most = 0;
  for (int k = 0; k < 50; k++) {
    tdm_vec3 force = {0, 0, 0}, moment = {0, 0, 0};
    for (int i = 0; i < r->model->nparticle; i++) {
      force = tdm_add(force, r->data->state.push[i].force);
      tdm_vec3 lever = tdm_sub(r->data->state.sphere[i].position, r->data->state.pose[0].position);
      moment = tdm_add(moment, tdm_add(torque(r->data, i), tdm_cross(lever, r->data->state.push[i].force)));
    }
    tdm_wrench load = r->data->state.body_load[0];
    double scale = 1 + tdm_norm(force) + tdm_norm(moment);
    ck_near(tdm_norm(tdm_add(force, load.force)), 0, 1e-10 * scale);
    ck_near(tdm_norm(tdm_add(moment, load.moment)), 0, 1e-10 * scale);
    shake(r, 600 + k, 1);
    most = r->data->state.ncontact > most ? r->data->state.ncontact : most;
  }
  ck_assert_int_gt(most, 3);
  rig_free(r);
}
END_TEST

START_TEST(test_path) {
  tdm_state a = state_at(1, 2, 3), b = state_at(1.1, 1.9, 3.3);
  a.pose.orientation = tdm_quat_unit((tdm_quat){0.7, 0.1, -0.3, 0.5});
  b.pose.orientation = tdm_quat_mul(tdm_quat_from_rotvec(tdm_v3(0.3, -0.2, 0.5)), a.pose.orientation);
  a.twist.velocity = tdm_v3(1, -2, 0.5);
  b.twist.velocity = tdm_v3(-1, 0, 3);
  const double H = 0.2, h = 1e-5;
  for (int kind = TDM_LINEAR; kind <= TDM_HERMITE; kind++) {
    dem_path m = dem_path_make(&a, &b, H, (tdm_interpolation)kind);
    for (int k = 0; k <= 4; k++) {
      double s = k / 4.0, s0 = fmax(0, s - h), s1 = fmin(1, s + h);
      tdm_pose p0 = dem_path_pose(&m, s0), p1 = dem_path_pose(&m, s1), p = dem_path_pose(&m, s);
      tdm_twist twist = dem_path_twist(&m, s), middle = dem_path_twist(&m, 0.5 * (s0 + s1));
      tdm_vec3 v = tdm_scale(1 / ((s1 - s0) * H), tdm_sub(p1.position, p0.position));
      tdm_vec3 turn = tdm_quat_to_rotvec(tdm_quat_mul(p1.orientation, tdm_quat_conj(p0.orientation)));
      ck_near(tdm_norm(tdm_sub(v, middle.velocity)), 0, 1e-7);
      ck_near(tdm_norm(tdm_sub(tdm_scale(1 / ((s1 - s0) * H), turn), twist.angular)), 0, 1e-7);
      tdm_quat slerp = tdm_quat_slerp(a.pose.orientation, b.pose.orientation, s);
      tdm_quat off = tdm_quat_mul(tdm_quat_conj(slerp), p.orientation);
      ck_near(tdm_norm(tdm_quat_to_rotvec(off)), 0, 1e-12);
    }
    ck_assert_mem_eq(&m.end.pose, &b.pose, sizeof b.pose);
    tdm_pose last = dem_path_pose(&m, 1);
    ck_assert_mem_eq(&last, &b.pose, sizeof last);
  }
  dem_path hermite = dem_path_make(&a, &b, H, TDM_HERMITE);
  ck_near(tdm_norm(tdm_sub(dem_path_twist(&hermite, 0).velocity, a.twist.velocity)), 0, 1e-12);
  ck_near(tdm_norm(tdm_sub(dem_path_twist(&hermite, 1).velocity, b.twist.velocity)), 0, 1e-12);
  dem_path linear = dem_path_make(&a, &b, H, TDM_LINEAR);
  ck_near(dem_path_pose(&linear, 0.25).position.x, 1.025, 1e-15);
}
END_TEST

START_TEST(test_settling) {
  tdm_assigned_body box = {.name = "box", .mass = 50, .state = state_at(1, 2, 3)};
  rig *r =
      rig_make(scene_json("{'materials': [{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],"
                          "'pairs': [{'materials':['a','a'],'restitution':1,'friction':0.4}],"
                          "'bodies': [{'name':'box','material':'a','shapes':["
                          "   {'type':'box','side':'inside','size':[0.3,0.3,1.5],'open':['+z']}]}],"
                          "'settle':{'restitution':0.3,'speed':1e-3},"
                          "'particles': [{'type':'random','body':'box','material':'a','count':60,"
                          "   'radius':[0.03,0.05],'region':{'min':[-0.15,-0.15,-0.75],'max':[0.15,0.15,0.75]}}]}"),
               1e-4, 1, &box);
  tdm_error err = {0};
  dem_settled settled;
  ck_assert_int_eq(dem_settle(r->data, NULL, &settled, &err), TDM_OK);
  ck_assert_msg(settled.rest, "%g m/s after %g s", settled.speed, settled.time);
  ck_assert(settled.speed < 1e-3);
  double weight = 0;
  for (int i = 0; i < r->model->nparticle; i++) {
    weight += 9.81 * r->model->mass[i];
    ck_assert(tdm_norm(r->data->state.pace[i].velocity) == 0 && tdm_norm(r->data->state.pace[i].spin) == 0);
  }
  tdm_wrench load = r->data->state.body_load[0];
  ck_relative(load.force.z, -weight, 5e-3);
  ck_near(load.force.x, 0, 5e-3 * weight);
  ck_near(load.force.y, 0, 5e-3 * weight);
  ck_assert_uint_eq(r->data->state.nstep, 0);
  ck_assert_int_eq(dem_count_lost(r->data), 0);
  /* with the histories kept it stays where it is */
  tdm_vec3 *x = malloc(60 * sizeof *x);
  for (int i = 0; i < 60; i++)
    x[i] = r->data->state.sphere[i].position;
  rig_steps(r, 1000);
  for (int i = 0; i < 60; i++)
    ck_near(tdm_norm(tdm_sub(r->data->state.sphere[i].position, x[i])), 0, 1e-3);
  ck_relative(r->data->state.body_load[0].force.z, -weight, 2e-2);
  free(x);
  rig_free(r);
}
END_TEST

START_TEST(test_shapes) {
  /* a solid box: faces, edges, corners, and a centre inside */
  dem_wall box = {.shape = &dem_shape_box, .half = {1, 2, 3}};
  tdm_pose pose = {{10, 0, 0}, tdm_quat_from_rotvec(tdm_v3(0, 0, M_PI / 2))};
  dem_wall_place at = dem_wall_put(&box, &pose);
  tdm_vec3 n;
  ck_near(dem_wall_gap(&box, &at, tdm_v3(12.5, 0.5, 1), &n), 0.5, 1e-12); /* body +y is world -x */
  ck_near(n.x, 1, 1e-12);
  ck_near(dem_wall_gap(&box, &at, tdm_v3(15, 5, 1), &n), 5, 1e-12); /* edge: 3-4-5 */
  ck_near(n.x, 0.6, 1e-12);
  ck_near(n.y, 0.8, 1e-12);
  ck_near(dem_wall_gap(&box, &at, tdm_v3(13, 2, 4), &n), sqrt(3), 1e-12); /* corner */
  ck_near(dem_wall_gap(&box, &at, tdm_v3(10, 0.9, 0), &n), -0.1, 1e-12);  /* inside */
  ck_near(n.y, 1, 1e-12);
}
END_TEST

START_TEST(test_lost) {
  rig *r = cloud(30, 0.6, "");
  ck_assert_int_eq(dem_count_lost(r->data), 0);
  r->data->state.sphere[3].position = tdm_v3(0, 0, -0.6);
  r->data->state.sphere[4].position = tdm_v3(0.9, 0, 0);
  ck_assert_int_eq(dem_count_lost(r->data), 2);
  tdm_error err = {0};
  ck_assert_int_eq(dem_check_finite(r->data, 0.5, &err), TDM_OK);
  r->data->state.pace[7].velocity.y = NAN;
  ck_assert_int_eq(dem_check_finite(r->data, 0.5, &err), TDM_ERR_NUMERIC);
  ck_assert_str_eq(err.path, "dem.particles[0]");
  ck_assert_msg(strstr(err.message, "particle 7") && strstr(err.message, "0.5"), "%s", err.message);
  rig_free(r);
}
END_TEST

TEST_MAIN("dem engine", test_lists_miss_nothing, test_far_particle, test_common_motion, test_copy, test_momentum,
          test_energy, test_wrench, test_path, test_settling, test_shapes, test_lost)
