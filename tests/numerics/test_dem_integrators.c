/* The integrators: order of convergence, reversal, conservation, windows with another step; body forces, fixed
 * particles and two dimensions. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/particles/particles.h"
#include "dem/step/integrate.h"
#include "tests/test_main.h"

#define MATERIAL "'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}]"
#define MULTI ",'integrator':'multi-step','multi_step':{'substeps':4,'mass':%g}"

static const char *const names[] = {"verlet", "leap-frog", "stormer-verlet", "multi-step"};
enum { NAMES = 4 };

/* keys for integrator k; multi-step takes contacts below `mass` for fast ones */
static const char *keys_of(int k, double mass) {
  static char text[128];
  if (k == 3)
    snprintf(text, sizeof text, MULTI, mass);
  else
    snprintf(text, sizeof text, ",'integrator':'%s'", names[k]);
  return text;
}

/* ---- order of convergence ---- */

/* A sphere that was dropped on another and a floor, pressed on both by gravity: contacts that never open. All vibrate.
 * Three masses, so that multi-step has fast contacts and slow ones. */
static rig *column(int k, double e, double mu, double dt) {
  tdm_assigned_body floor = {.name = "floor", .mass = INFINITY, .state = state_at(0, 0, 0)};
  return rig_make(
      scene_json("{" MATERIAL
                 ",'pairs':[{'materials':['a','a'],'restitution':%g,'friction':%g}],'gravity':[0.3,0,-500],"
                 "'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                 "'particles':[{'type':'list','material':'a','radius':0.1,'positions':[[0,0,0.098]],'spin':[0,0.2,0]},"
                 "{'type':'list','material':'a','radius':0.05,'positions':[[0,0,0.245]]}]%s}",
                 e, mu, keys_of(k, 1.0)),
      dt, 1, &floor);
}

/* positions and velocities after a time, in 2^level steps of each `coarse` */
static void state_after(int k, double e, double mu, int level, double out[8]) {
  const double coarse = 4e-5;
  long steps = 100L << level;
  rig *r = column(k, e, mu, coarse / (double)(1 << level));
  rig_steps(r, steps);
  ck_assert_int_eq(r->data->state.ncontact, 2);
  for (int i = 0; i < 2; i++) {
    out[4 * i] = r->data->state.sphere[i].position.z;
    out[4 * i + 1] = r->data->state.pace[i].velocity.z;
    out[4 * i + 2] = r->data->state.sphere[i].position.x;
    out[4 * i + 3] = r->data->state.pace[i].velocity.x;
  }
  rig_free(r);
}

/* the order from the differences of three steps, dt, dt/2, dt/4: for positions and for velocities */
static void check_order(int k, double e, double mu) {
  double x[3][8];
  for (int level = 0; level < 3; level++)
    state_after(k, e, mu, level + 1, x[level]);
  for (int q = 0; q < 8; q++) {
    double order = log2(fabs(x[0][q] - x[1][q]) / fabs(x[1][q] - x[2][q]));
    if (fabs(x[0][q] - x[1][q]) < 1e-13) /* no motion along x without friction but the fall */
      continue;
    ck_assert_msg(order > 1.85 && order < 2.3, "%s, e = %g, mu = %g: order %.3f of number %d", names[k], e, mu, order,
                  q);
  }
}

START_TEST(test_order) {
  for (int k = 0; k < NAMES; k++)
    check_order(k, 1, 0);
}
END_TEST

START_TEST(test_order_damped) {
  /* damping takes a velocity that does not lag: still of second order */
  for (int k = 0; k < NAMES; k++)
    check_order(k, 0.3, 0);
}
END_TEST

START_TEST(test_same_motion) {
  /* leap-frog and Störmer's form are velocity Verlet in other words: the same numbers but for round-off */
  double x[3][8];
  for (int k = 0; k < 3; k++)
    state_after(k, 0.8, 0.5, 0, x[k]);
  for (int q = 0; q < 8; q++)
    for (int k = 1; k < 3; k++)
      ck_near(x[k][q], x[0][q], q % 2 ? 1e-9 : 1e-13);
}
END_TEST

/* ---- reversal ---- */

static rig *gas(int k, double e, const char *more) {
  return rig_make(scene_json("{'gravity':[0,0,-1],'contact':{'tangential':'none'}," MATERIAL
                             ",'pairs':[{'materials':['a','a'],'restitution':%g}],"
                             "'bodies':[{'name':'b','material':'a','shapes':[{'type':'box','side':'inside',"
                             "'size':[0.5,0.5,0.5]}]}],"
                             "'particles':[{'type':'random','material':'a','count':60,'radius':[0.02,0.04],"
                             "'region':{'min':[-0.25,-0.25,-0.25],'max':[0.25,0.25,0.25]},'velocity':[1,-2,0.5]}]%s%s}",
                             e, keys_of(k, 0.04), more),
                  5e-5, 0, NULL);
}

START_TEST(test_reversal) {
  /* There and back: what is left is round-off (1e-16), which collisions amplify: by about 10 each, a few in this time.
   */
  static const int reversible[] = {0, 1, 3};
  for (int n = 0; n < 3; n++) {
    int k = reversible[n];
    rig *r = gas(k, 1, "");
    dem_data *d = r->data;
    tdm_vec3 x0[60];
    long most = 0;
    double way = 0, worst = 0;
    for (int i = 0; i < 60; i++)
      x0[i] = d->state.sphere[i].position;
    for (int s = 0; s < 2000; s++) {
      rig_steps(r, 1);
      most = d->state.ncontact > most ? d->state.ncontact : most;
    }
    for (int i = 0; i < 60; i++) {
      way = fmax(way, tdm_norm(tdm_sub(d->state.sphere[i].position, x0[i])));
      d->state.pace[i].velocity = tdm_scale(-1, d->state.pace[i].velocity);
    }
    d->state.restart = true;
    rig_steps(r, 2000);
    for (int i = 0; i < 60; i++)
      worst = fmax(worst, tdm_norm(tdm_sub(d->state.sphere[i].position, x0[i])));
    ck_assert_int_gt(most, 8);
    ck_assert(way > 0.1);
    ck_assert_msg(worst < 1e-11, "%s comes back within %.3g m", names[k], worst);
    rig_free(r);
  }
}
END_TEST

/* ---- conservation ---- */

START_TEST(test_energy) {
  /* e = 1, no friction: at contact-free instants the energy is that of the start within 1e-6 over 1e6 steps at
   * t_c/dt = 500. Three spheres between two walls. */
  rig *r =
      rig_make(scene_json("{'gravity':[0,0,0],'contact':{'tangential':'none'}," MATERIAL
                          ",'pairs':[{'materials':['a','a'],'restitution':1}],"
                          "'bodies':[{'name':'b','material':'a','shapes':[{'type':'box','side':'inside',"
                          "'size':[0.16,0.16,0.16]}]}],"
                          "'particles':[{'type':'list','material':'a','radius':0.02,'positions':[[-0.05,0,0]],"
                          "'velocity':[0.9,0.2,0.1]},{'type':'list','material':'a','radius':0.015,'positions':"
                          "[[0.01,0.005,0]],'velocity':[-0.2,0.5,-0.7]},{'type':'list','material':'a','radius':0.02,"
                          "'positions':[[0.05,0.01,0.04]],'velocity':[0.3,-0.6,0.2]}]}"),
               1, 0, NULL);
  dem_data *d = r->data;
  /* the shortest contact: of the smallest sphere with a wall, at the highest speed there can be */
  double tc =
      2.868 * pow(d->state.mass[1] * d->state.mass[1] / (0.015 * pow(r->model->pair[0].effective_young, 2) * 1.5), 0.2);
  double dt = tc / 500, energy0 = 0, worst = 0;
  long hits = 0, before = 0, instants = 0;
  for (int i = 0; i < 3; i++)
    energy0 += 0.5 * d->state.mass[i] * tdm_dot(d->state.pace[i].velocity, d->state.pace[i].velocity);
  for (long s = 0; s < 1000000; s++) {
    one_step(d, NULL, dt);
    hits += d->state.ncontact > before;
    before = d->state.ncontact;
    if (d->state.ncontact > 0 || s % 100)
      continue;
    double energy = 0;
    for (int i = 0; i < 3; i++)
      energy += 0.5 * d->state.mass[i] * tdm_dot(d->state.pace[i].velocity, d->state.pace[i].velocity);
    worst = fmax(worst, fabs(energy / energy0 - 1));
    instants++;
  }
  ck_assert_int_gt(hits, 50);
  ck_assert_int_gt(instants, 1000);
  ck_assert_msg(worst < 1e-6, "energy off by %.3g after %ld impacts", worst, hits);
  rig_free(r);
}
END_TEST

START_TEST(test_momentum) {
  /* with friction and damping, far from walls: momentum and angular momentum about the origin, to round-off */
  for (int k = 0; k < NAMES; k++) {
    rig *r = rig_make(scene_json("{'gravity':[0,0,0]," MATERIAL
                                 ",'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],"
                                 "'particles':[{'type':'random','material':'a','count':80,'radius':[0.03,0.05],"
                                 "'region':{'min':[-0.3,-0.3,-0.3],'max':[0.3,0.3,0.3]}}]%s}",
                                 keys_of(k, 0.15)),
                      1e-4, 0, NULL);
    dem_data *d = r->data;
    tdm_vec3 p[2], l[2];
    double p_sum = 0, l_sum = 0;
    long most = 0;
    for (int i = 0; i < d->state.nparticle; i++) {
      d->state.pace[i].velocity = tdm_scale(-5, d->state.sphere[i].position);
      d->state.pace[i].spin = tdm_v3(sin(i), cos(3 * i), sin(7 * i));
    }
    for (int n = 0; n < 2; n++) {
      p[n] = l[n] = tdm_v3(0, 0, 0);
      for (int i = 0; i < d->state.nparticle; i++) {
        tdm_vec3 mv = tdm_scale(d->state.mass[i], d->state.pace[i].velocity);
        p[n] = tdm_add(p[n], mv);
        l[n] = tdm_add(l[n], tdm_cross(d->state.sphere[i].position, mv));
        double inertia = 0.4 * d->state.mass[i] * d->state.sphere[i].radius * d->state.sphere[i].radius;
        l[n] = tdm_axpy(inertia, d->state.pace[i].spin, l[n]);
        p_sum += tdm_norm(mv);
        l_sum += tdm_norm(mv) * tdm_norm(d->state.sphere[i].position);
      }
      for (int s = 0; n == 0 && s < 2000; s++) {
        rig_steps(r, 1);
        most = d->state.ncontact > most ? d->state.ncontact : most;
      }
    }
    ck_assert_int_gt(most, 30);
    ck_assert_msg(tdm_norm(tdm_sub(p[1], p[0])) < 1e-12 * p_sum, "%s: momentum", names[k]);
    /* friction turns against a contact point that both share at the forces' instant: exact but for round-off */
    ck_assert_msg(tdm_norm(tdm_sub(l[1], l[0])) < 1e-11 * l_sum, "%s: angular momentum off by %.3g of %.3g", names[k],
                  tdm_norm(tdm_sub(l[1], l[0])), l_sum);
    rig_free(r);
  }
}
END_TEST

/* ---- steps ---- */

START_TEST(test_another_step) {
  /* windows end in a shorter step: free flight stays the parabola, whatever the integrator keeps; a copy goes on the
   * same */
  for (int k = 0; k < NAMES; k++) {
    rig *r =
        rig_make(scene_json("{'gravity':[0,0,-10]," MATERIAL ",'particles':[{'type':'list','material':'a','radius':"
                            "0.1,'positions':[[0,0,0]],'velocity':[1,0,2],'spin':[0,1,0]}]%s}",
                            keys_of(k, 1)),
                 1e-3, 0, NULL);
    double t = 0;
    for (int w = 0; w < 50; w++)
      for (int s = 0; s < 3; s++) {
        double dt = s < 2 ? 1e-3 : 0.4e-3;
        one_step(r->data, NULL, dt);
        t += dt;
        ck_near(r->data->state.sphere[0].position.z, 2 * t - 5 * t * t, 1e-13);
        ck_near(r->data->state.pace[0].velocity.z, 2 - 10 * t, 1e-10);
        ck_near(r->data->state.pace[0].spin.y, 1, 1e-12);
      }
    rig_free(r);
  }
}
END_TEST

START_TEST(test_newcomer) {
  /* one that comes during the run flies as if it had been there */
  for (int k = 0; k < NAMES; k++) {
    rig *r = gas(k, 0.5, "");
    rig_steps(r, 10);
    dem_newcomer one = {.position = {0, 0, 10}, .velocity = {1, 2, 3}, .radius = 0.01, .mass = 0.1, .material = 0};
    ck_assert_int_eq(dem_data_add(r->data, &one), TDM_OK);
    rig_steps(r, 100);
    int i = r->data->state.nparticle - 1;
    double t = 100 * 5e-5;
    ck_near(r->data->state.sphere[i].position.z, 10 + 3 * t - 0.5 * t * t, 1e-12);
    ck_near(r->data->state.sphere[i].position.x, t, 1e-12);
    rig_free(r);
  }
}
END_TEST

START_TEST(test_multi_step_is_cheaper_than_it_is_wrong) {
  /* A light sphere between heavy ones: multi-step at dt = 4 h follows Verlet at h much better than Verlet at 4 h does,
   * as it takes the stiff contacts at h. And with every contact fast or every contact slow it is Verlet at h or 4 h. */
  double z[5];
  const double h = 2e-5;
  static const struct {
    int k;
    double dt, mass;
  } run[5] = {{0, h, 0}, {0, 4 * h, 0}, {3, 4 * h, 0.05}, {3, 4 * h, 1e9}, {3, 4 * h, 1e-9}};
  for (int n = 0; n < 5; n++) {
    rig *r = rig_make(scene_json("{'gravity':[0,0,0],'contact':{'tangential':'none'}," MATERIAL
                                 ",'pairs':[{'materials':['a','a'],'restitution':1}],"
                                 "'particles':[{'type':'list','material':'a','radius':0.1,'positions':[[0,0,0],[0,0,"
                                 "0.2195]]},{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0.11]],"
                                 "'velocity':[0,0,0.5]}]%s}",
                                 keys_of(run[n].k, run[n].mass)),
                      run[n].dt, 0, NULL);
    rig_steps(r, lround(0.008 / run[n].dt));
    z[n] = r->data->state.sphere[2].position.z;
    rig_free(r);
  }
  ck_assert(fabs(z[1] - z[0]) > 1e-8);
  ck_assert_msg(fabs(z[2] - z[0]) < 0.1 * fabs(z[1] - z[0]), "%g %g", z[2] - z[0], z[1] - z[0]);
  ck_near(z[3], z[0], 1e-13);
  ck_near(z[4], z[1], 1e-13);
}
END_TEST

/* ---- two dimensions, body forces, fixed particles ---- */

static json_t *disc_json(const char *velocity, const char *more) {
  return scene_json("{" MATERIAL ",'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],"
                    "'bodies':[{'name':'b','material':'a','shapes':[{'type':'plane','normal':[0,0,1]},"
                    "{'type':'plane','normal':[1,0.3,0],'point':[-0.3,0,0]},{'type':'plane','normal':[-1,0,0],'point':"
                    "[0.3,0,0]}]}],'dimension':2,'plane_at':0.7,"
                    "'particles':[{'type':'random','material':'a','count':20,'radius':[0.02,0.04],'region':"
                    "{'min':[-0.1,0.66,0],'max':[0.28,0.741,1]},'velocity':%s,'spin':[0,3,0]}]%s}",
                    velocity, more);
}

START_TEST(test_discs) {
  for (int k = 0; k < NAMES; k++) {
    rig *r = rig_make(disc_json("[1,0,-3]", keys_of(k, 0.1)), 1e-4, 0, NULL);
    rig_steps(r, 5000);
    dem_data *d = r->data;
    double spin = 0;
    ck_assert_int_gt(d->state.ncontact, 3);
    for (int i = 0; i < d->state.nparticle; i++) {
      ck_assert(d->state.sphere[i].position.y == 0.7 && d->state.pace[i].velocity.y == 0);
      ck_assert(d->state.pace[i].spin.x == 0 && d->state.pace[i].spin.z == 0);
      spin = fmax(spin, fabs(d->state.pace[i].spin.y));
    }
    ck_assert(spin > 0.01);
    rig_free(r);
  }
  tdm_error err = rig_refused(disc_json("[1,0.1,0]", ""), NULL);
  ck_assert_str_eq(err.path, "dem.particles[0]");
}
END_TEST

START_TEST(test_body_force) {
  for (int k = 0; k < NAMES; k++) {
    rig *r = rig_make(scene_json("{'gravity':[0,0,-10]," MATERIAL
                                 ",'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],'particles':["
                                 "{'type':'list','material':'a','radius':0.1,'mass':2,'positions':[[0,0,0]],"
                                 "'force':[4,0,0],'acceleration':[0,3,10]},"
                                 "{'type':'list','material':'a','radius':0.1,'positions':[[5,0,0]]}]%s}",
                                 keys_of(k, 1)),
                      1e-3, 0, NULL);
    rig_steps(r, 1000);
    tdm_vec3 x = r->data->state.sphere[0].position;
    ck_near(x.x, 1, 1e-10);
    ck_near(x.y, 1.5, 1e-10);
    ck_near(x.z, 0, 1e-12);
    ck_near(r->data->state.sphere[1].position.z, -5, 1e-10);
    rig_free(r);
  }
}
END_TEST

START_TEST(test_fixed) {
  /* a sphere bounces on a fixed one as on one of infinite mass, with the right restitution; two fixed ones that overlap
   * do nothing; a fixed one in a wall neither */
  for (int k = 0; k < NAMES; k++) {
    rig *r = rig_make(scene_json("{'gravity':[0,0,-1]," MATERIAL
                                 ",'pairs':[{'materials':['a','a'],'restitution':0.6,'friction':0.4}],"
                                 "'bodies':[{'name':'b','material':'a','shapes':[{'type':'plane','normal':[0,0,1],"
                                 "'point':[0,0,-0.099]}]}],'particles':["
                                 "{'type':'list','material':'a','radius':0.1,'positions':[[0,0,0],[0.19,0,0]],"
                                 "'fixed':true},"
                                 "{'type':'list','material':'a','radius':0.05,'positions':[[0,0,0.16]],"
                                 "'velocity':[0,0,-2]}]%s}",
                                 keys_of(k, 1)),
                      1e-6, 0, NULL);
    dem_data *d = r->data;
    tdm_vec3 x0 = d->state.sphere[0].position, x1 = d->state.sphere[1].position;
    ck_assert_int_eq(d->state.ncontact, 0);
    bool met = false;
    for (int s = 0; s < 20000 && !(met && d->state.ncontact == 0); s++) {
      rig_steps(r, 1);
      met = met || d->state.ncontact > 0;
    }
    ck_assert(met && d->state.ncontact == 0);
    ck_near(d->state.pace[2].velocity.z, 0.6 * 2.005, 0.005);
    ck_assert_mem_eq(&x0, &d->state.sphere[0].position, sizeof x0);
    ck_assert_mem_eq(&x1, &d->state.sphere[1].position, sizeof x1);
    ck_assert(tdm_norm(d->state.pace[0].velocity) == 0 && tdm_norm(d->state.pace[0].spin) == 0);
    rig_free(r);
  }
}
END_TEST

START_TEST(test_load) {
  /* the impulse on a body is what the particles lost: over impacts that begin and end inside, whatever share of the
   * contacts is taken in substeps, also while the floor moves */
  static const double mass[] = {0, 0, 0, 1e9, 1e-9, 0.3};
  for (int n = 0; n < 6; n++) {
    int k = n < 3 ? n : 3;
    tdm_assigned_body floor = {.name = "floor", .mass = 100, .state = state_at(0, 0, 0)};
    rig *r = rig_make(
        scene_json("{'gravity':[0,0,0]," MATERIAL ",'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],"
                   "'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}"
                   "],'particles':[{'type':'list','material':'a','radius':0.05,'positions':[[0,0,0.06]],"
                   "'velocity':[1,0,-2],'spin':[0,3,0]},{'type':'list','material':'a','radius':0.03,"
                   "'positions':[[0.3,0,0.04]],'velocity':[0,1,-1]}]%s}",
                   keys_of(k, mass[n])),
        2e-5, 1, &floor);
    dem_data *d = r->data;
    tdm_vec3 impulse = {0, 0, 0}, gained = {0, 0, 0};
    long most = 0;
    for (int i = 0; i < 2; i++)
      gained = tdm_axpy(-d->state.mass[i], d->state.pace[i].velocity, gained);
    tdm_state now = state_at(0, 0, 0), next;
    for (int s = 0; s < 3000; s++) {
      next = now;
      next.pose.position.z += 2e-6; /* 0.1 m/s upward */
      dem_path path = dem_path_make(&now, &next, 2e-5, TDM_LINEAR);
      one_step(d, &path, 2e-5);
      now = next;
      impulse = tdm_axpy(2e-5, d->state.body_load[0].force, impulse);
      most = d->state.ncontact > most ? d->state.ncontact : most;
    }
    for (int i = 0; i < 2; i++) {
      gained = tdm_axpy(d->state.mass[i], d->state.pace[i].velocity, gained);
      ck_assert(d->state.pace[i].velocity.z > 0.3);
    }
    ck_assert_int_ge(most, 1);
    ck_assert_int_eq(d->state.ncontact, 0);
    ck_assert(gained.z > 1 && fabs(gained.x) > 0.01);
    ck_assert_msg(tdm_norm(tdm_add(gained, impulse)) < 1e-12, "%s, mass %g: off by %.3g", names[k], mass[n],
                  tdm_norm(tdm_add(gained, impulse)));
    rig_free(r);
  }
}
END_TEST

TEST_MAIN("dem integrators", test_order, test_order_damped, test_same_motion, test_reversal, test_energy, test_momentum,
          test_another_step, test_newcomer, test_multi_step_is_cheaper_than_it_is_wrong, test_discs, test_body_force,
          test_fixed, test_load)
