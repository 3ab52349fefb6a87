/* Extreme cases: each ends accurate or with a clear error, never in silent garbage; and the guard that sees to it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/watch/check.h"
#include "dem/watch/guard.h"
#include "dem/watch/limits.h"
#include "tests/test_main.h"

/* A sphere of radius R, density, stiffness, restitution, friction and speed falls on a floor at a slant. */
typedef struct {
  double radius, density, young, restitution, friction, speed;
  const char *more;
} drop;

static rig *drop_make(drop c, double dt) {
  return rig_make(scene_json("{'materials':[{'name':'a','density':%g,'young_modulus':%g,'poisson_ratio':0.25}],"
                             "'pairs':[{'materials':['a','a'],'restitution':%g,'friction':%g}],'gravity':[0,0,0],"
                             "'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                             "'particles':[{'type':'list','material':'a','radius':%g,'positions':[[0,0,%.17g]],"
                             "'velocity':[%.17g,0,%.17g]}]%s}",
                             c.density, c.young, c.restitution, c.friction, c.radius, c.radius, 0.5 * c.speed, -c.speed,
                             c.more ? c.more : ""),
                  dt, 0, NULL);
}

static double contact_time(const rig *r, double speed) {
  return dem_contact_time(r->data->state.mass[0], r->data->state.sphere[0].radius, r->model->pair[0].effective_young,
                          speed);
}

/* Speed after the impact over the speed before, in 200 steps a contact or more; -1: it never left. */
static double restitution_of(drop c) {
  rig *r = drop_make(c, 1);
  double dt = contact_time(r, c.speed) / 200, e = -1;
  for (long k = 0; k < 100000 && e < 0; k++) {
    one_step(r->data, NULL, dt);
    if (k > 10 && r->data->state.ncontact == 0)
      e = r->data->state.pace[0].velocity.z / c.speed;
  }
  tdm_error err = {0};
  ck_assert_int_eq(dem_check_finite(r->data, 0, &err), TDM_OK);
  rig_free(r);
  return e;
}

START_TEST(test_stiffness_and_density) {
  /* 1e3 to 1e11 Pa, 1 to 2e4 kg/m3: the restitution is the given one */
  for (int s = 3; s <= 11; s += 2)
    for (int d = 0; d < 3; d++) {
      double density = d == 0 ? 1 : d == 1 ? 1000 : 2e4;
      /* not so fast that the sphere is squashed: 1 % of the wave speed */
      drop c = {0.01, density, pow(10, s), 0.6, 0.3, 0.01 * sqrt(pow(10, s) / density), NULL};
      ck_near(restitution_of(c), 0.6, 0.005);
    }
}
END_TEST

START_TEST(test_restitution) {
  const double e[] = {0.01, 0.1, 1};
  for (int k = 0; k < 3; k++) {
    drop c = {0.01, 2500, 1e8, e[k], 0.3, 0.5, NULL};
    ck_near(restitution_of(c), e[k], 0.01 * e[k] + 1e-3);
  }
}
END_TEST

START_TEST(test_friction) {
  /* none: the velocity along the floor stays. Ten: it sticks, and energy does not grow. */
  drop c = {0.01, 2500, 1e8, 0.8, 0, 0.5, NULL};
  for (int k = 0; k < 2; k++) {
    c.friction = 10 * k;
    rig *r = drop_make(c, 1);
    double dt = contact_time(r, c.speed) / 200;
    const dem_pace *pace = &r->data->state.pace[0];
    for (int s = 0; s < 1000; s++)
      one_step(r->data, NULL, dt);
    double spin = 0.01 * pace->spin.y, energy = tdm_dot(pace->velocity, pace->velocity) + 0.4 * spin * spin;
    ck_assert_int_eq(r->data->state.ncontact, 0);
    if (k == 0) {
      ck_assert(pace->velocity.x == 0.25 && spin == 0);
      ck_near(energy, 0.25 * 0.25 + 0.4 * 0.4, 2e-3);
    } else {
      ck_assert(spin > 0.05);
      ck_assert(energy < 1.25 * 0.25);
      /* angular momentum about the floor: v + 2/5 R w stays, as the force acts at the floor but for the overlap */
      ck_near(pace->velocity.x + 0.4 * spin, 0.25, 0.005);
    }
    rig_free(r);
  }
}
END_TEST

START_TEST(test_size_ratio) {
  /* 1 to 100, each search: the small one bounces off the large one at rest with the given restitution; mass ratio 1e6
   */
  static const char *const searches[] = {"auto", "cells", "sweep", "linked-linear", "grid", "all", "verlet-1967"};
  tdm_vec3 v[7];
  for (int k = 0; k < 7; k++) {
    rig *r = rig_make(scene_json("{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],"
                                 "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0}],'gravity':[0,0,0],"
                                 "'search':'%s','particles':["
                                 "{'type':'list','material':'a','radius':1,'positions':[[0,0,0]]},"
                                 "{'type':'list','material':'a','radius':0.01,'positions':[[0,0,1.012],[0,1.5,0],"
                                 "[0,-1.2,0.9],[3,3,3]],'velocity':[0,0,-1]}]}",
                                 searches[k]),
                      2e-6, 0, NULL);
    rig_steps(r, 2500);
    v[k] = r->data->state.pace[1].velocity;
    ck_near(v[k].z, 0.5, 0.005);
    ck_assert(v[k].x == v[0].x && v[k].y == v[0].y && v[k].z == v[0].z);
    ck_near(r->data->state.pace[0].velocity.z, -1.5e-6, 1e-7);
    rig_free(r);
  }
}
END_TEST

START_TEST(test_one_and_none) {
  rig *r = rig_make(scene_json("{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],"
                               "'particles':[{'type':'list','material':'a','radius':0.1,'positions':[[0,0,0]]}]}"),
                    1e-3, 0, NULL);
  rig_steps(r, 1000);
  ck_near(r->data->state.sphere[0].position.z, -0.5 * 9.81, 1e-10);
  rig_free(r);
  r = rig_make(scene_json("{'materials':[],'particles':[]}"), 1e-3, 0, NULL);
  rig_steps(r, 100);
  ck_assert_int_eq(r->data->state.nparticle, 0);
  rig_free(r);
}
END_TEST

START_TEST(test_absurd_places) {
  /* far apart, beyond what a cell's number holds: nothing touches, nothing is lost, and contacts far out still work */
  static const char *const searches[] = {"cells", "sweep", "grid", "all"};
  for (int k = 0; k < 4; k++) {
    rig *r = rig_make(scene_json("{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],"
                                 "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.3}],'gravity':[0,0,0],"
                                 "'search':'%s','particles':[{'type':'list','material':'a','radius':0.01,'positions':["
                                 "[0,0,0],[1e300,-1e300,1e300],[1e15,0,0],[0,-1e9,0],[0,-1e9,0.0199]]}]}",
                                 searches[k]),
                      1e-5, 0, NULL);
    ck_assert_int_eq(r->data->state.ncontact, 1);
    rig_steps(r, 100);
    tdm_error err = {0};
    ck_assert_int_eq(dem_check_finite(r->data, 0, &err), TDM_OK);
    ck_assert(r->data->state.sphere[1].position.x == 1e300);
    ck_assert(r->data->state.pace[4].velocity.z > 0 && r->data->state.pace[3].velocity.z < 0);
    rig_free(r);
  }
}
END_TEST

/* ---- refused at the start ---- */

static tdm_error start_error(const char *positions, double z) {
  rig *r = rig_make(scene_json("{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],"
                               "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.3}],"
                               "'bodies':[{'name':'block','material':'a','shapes':[{'type':'box','side':'outside',"
                               "'size':[1,1,1],'center':[0,0,%g]}]}],"
                               "'particles':[{'type':'list','material':'a','radius':0.1,'positions':[%s]}]}",
                               z, positions),
                    1e-5, 0, NULL);
  tdm_error err = {0};
  int behind;
  ck_assert_int_eq(dem_check_start(r->data, &behind, &err), TDM_ERR_SCENE);
  ck_assert_str_eq(err.path, "dem.particles[0]");
  rig_free(r);
  return err;
}

START_TEST(test_inside) {
  tdm_error err = start_error("[0,0,0],[0,0,0.01]", 10);
  ck_assert_ptr_nonnull(strstr(err.message, "particle 1 overlaps particle 0"));
  err = start_error("[0,0,0],[0,0,0]", 10); /* one in the place of the other */
  ck_assert_ptr_nonnull(strstr(err.message, "particle 1 overlaps particle 0"));
  err = start_error("[0,0,0]", 0); /* deep inside a solid */
  ck_assert_ptr_nonnull(strstr(err.message, "in a wall of \"block\""));
}
END_TEST

/* ---- the guard ---- */

START_TEST(test_through_a_wall) {
  /* a wall 1 mm thick, a particle that goes 50 mm a step: said at once, with particle, place, time and step */
  for (int stop = 0; stop < 2; stop++) {
    rig *r = rig_make(scene_json("{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],"
                                 "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.3}],'gravity':[0,0,0],"
                                 "'bodies':[{'name':'w','material':'a','shapes':[{'type':'box','side':'outside','size':"
                                 "[1,1,0.001]}]}],'guard':{'action':'%s'},'particles':["
                                 "{'type':'list','material':'a','radius':0.01,'positions':[[9,9,9]]},"
                                 "{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0.125]],'velocity':"
                                 "[0,0,-500]}]}",
                                 stop ? "stop" : "warn"),
                      1e-4, 0, NULL);
    long steps;
    tdm_error err = rig_guarded(r, 100, &steps);
    if (stop) {
      ck_assert_int_eq(err.status, TDM_ERR_NUMERIC);
      ck_assert_int_eq(steps, 1);
      ck_assert_str_eq(err.path, "dem.particles[1]");
      ck_assert_ptr_nonnull(strstr(err.message, "id 1"));
      ck_assert_ptr_nonnull(strstr(err.message, "0.05 m in a step"));
      ck_assert_ptr_nonnull(strstr(err.message, "step 1"));
    } else {
      ck_assert_int_eq(err.status, TDM_OK);
      ck_assert_uint_gt(r->data->state.guard.told[DEM_GUARD_LEAP], 5);
      ck_assert_uint_eq(r->data->state.guard.told[DEM_GUARD_OVERLAP], 0);
    }
    rig_free(r);
  }
}
END_TEST

/* A sphere of 10 mm that comes at `speed` towards what `bodies` has at z = 0. */
static rig *shot(const char *bodies, double speed, double dt) {
  return rig_make(scene_json("{'materials':[{'name':'a','density':2500,'young_modulus':1e7,'poisson_ratio':0.25}],"
                             "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.3}],'gravity':[0,0,0],"
                             "'guard':{'action':'stop'},'bodies':[%s],'particles':[{'type':'list','material':'a',"
                             "'radius':0.01,'positions':[[0,0,0.1003]],'velocity':[0,0,%g]}]}",
                             bodies, -speed),
                  dt, 0, NULL);
}

START_TEST(test_fast_but_no_leap) {
  /* through a thin wall between two of the regular looks: bounced, or said; never behind it without a word */
  static const char *const walls[] = {
      "{'name':'w','material':'a','shapes':[{'type':'box','side':'outside','size':[1,1,0.001]}]}",
      "{'name':'w','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}"};
  static const double speeds[] = {20, 35, 40, 60, 100, 200, 400, 700, 990};
  for (int w = 0; w < 2; w++)
    for (size_t k = 0; k < sizeof speeds / sizeof speeds[0]; k++) {
      rig *r = shot(walls[w], speeds[k], 1e-5);
      long steps;
      tdm_error err = rig_guarded(r, 2000, &steps);
      bool behind = r->data->state.sphere[0].position.z < 0.005;
      ck_assert_msg(err.status == TDM_ERR_NUMERIC || !behind, "wall %d, %g m/s: at %g m", w, speeds[k],
                    r->data->state.sphere[0].position.z);
      if (speeds[k] > 35)
        ck_assert_msg(err.status == TDM_ERR_NUMERIC && r->data->state.sphere[0].position.z > -0.02,
                      "wall %d, %g m/s: at %g m", w, speeds[k], r->data->state.sphere[0].position.z);
      rig_free(r);
    }
}
END_TEST

START_TEST(test_head_on) {
  rig *r =
      rig_make(scene_json("{'materials':[{'name':'a','density':2500,'young_modulus':1e7,'poisson_ratio':0.25}],"
                          "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.3}],'gravity':[0,0,0],"
                          "'guard':{'action':'stop'},'particles':["
                          "{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0]],'velocity':[50,0,0]},"
                          "{'type':'list','material':'a','radius':0.01,'positions':[[0.05,0,0]],'velocity':[-50,0,0]"
                          "}]}"),
               1e-5, 0, NULL);
  long steps;
  tdm_error err = rig_guarded(r, 500, &steps);
  ck_assert_int_eq(err.status, TDM_ERR_NUMERIC);
  ck_assert_ptr_nonnull(strstr(err.message, "overlaps particle id"));
  ck_assert(r->data->state.sphere[0].position.x < r->data->state.sphere[1].position.x);
  rig_free(r);
}
END_TEST

START_TEST(test_lost) {
  /* so soft that it goes through a plane slowly, with the overlap's guard out of the way */
  drop c = {0.01, 2500, 1e3, 0.9, 0, 5, ",'guard':{'action':'stop','overlap':3}"};
  rig *r = drop_make(c, 1e-5);
  dem_guard_begin(r->data);
  long steps;
  tdm_error err = rig_guarded(r, 5000, &steps);
  ck_assert_int_eq(err.status, TDM_ERR_NUMERIC);
  ck_assert_ptr_nonnull(strstr(err.message, "went through a plane of \"floor\""));
  ck_assert_str_eq(err.path, "dem.particles[0]");
  err = (tdm_error){0};
  err = rig_guarded(r, 300, &steps); /* once */
  ck_assert_int_eq(err.status, TDM_OK);
  rig_free(r);
}
END_TEST

START_TEST(test_fast_body) {
  /* ten periods in ten steps: at the ends of steps it always is where it was */
  rig *r = shot("{'name':'f','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}],'motion':{'oscillation':"
                "{'amplitude':[0,0,0.1],'frequency':1e5}}}",
                0, 1e-5);
  long steps;
  tdm_error err = rig_guarded(r, 200, &steps);
  ck_assert_int_eq(err.status, TDM_ERR_NUMERIC);
  ck_assert_ptr_nonnull(strstr(err.message, "\"f\" moves up to 0.628 m in a step"));
  rig_free(r);
}
END_TEST

START_TEST(test_energy_of_a_motion) {
  /* a floor that throws the particle up between two looks, or from one to another, is a source */
  static const char *const motions[] = {"'velocity':[0,0,2],'start':0.0102,'end':0.0108",
                                        "'velocity':[0,0,2],'start':0.0095,'end':0.0108",
                                        "'velocity':[0,0,2],'start':0.0102,'end':0.0205"};
  for (int k = 0; k < 3; k++) {
    rig *r =
        rig_make(scene_json("{'materials':[{'name':'a','density':2500,'young_modulus':1e7,'poisson_ratio':0.25}],"
                            "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.3}],"
                            "'guard':{'action':'stop'},'bodies':[{'name':'f','material':'a','shapes':[{'type':"
                            "'plane','normal':[0,0,1]}],'motion':{%s}}],'particles':[{'type':'list','material':'a',"
                            "'radius':0.01,'positions':[[0,0,0.01]]}]}",
                            motions[k]),
                 1e-5, 0, NULL);
    long steps;
    tdm_error err = rig_guarded(r, 5000, &steps);
    ck_assert_msg(err.status == TDM_OK, "%d: %s", k, err.message);
    ck_assert(r->data->state.sphere[0].position.z > 0.012);
    rig_free(r);
  }
}
END_TEST

START_TEST(test_overlap) {
  /* a soft sphere is squashed by half its radius */
  drop c = {0.01, 2500, 1e4, 0.9, 0, 1, ",'guard':{'action':'stop','every':1,'overlap':0.2}"};
  rig *r = drop_make(c, 1e-5);
  long steps;
  tdm_error err = rig_guarded(r, 5000, &steps);
  ck_assert_int_eq(err.status, TDM_ERR_NUMERIC);
  double share = 1 - r->data->state.sphere[0].position.z / 0.01;
  ck_assert(share > 0.2 && share < 0.202);
  ck_assert_ptr_nonnull(strstr(err.message, "a wall of \"floor\""));
  ck_assert_ptr_nonnull(strstr(err.message, "dem.guard.overlap"));
  rig_free(r);
  c.more = ",'guard':{'action':'stop','every':1,'overlap':2}"; /* as much as you like */
  r = drop_make(c, 1e-5);
  ck_assert_int_eq(rig_guarded(r, 5000, &steps).status, TDM_OK);
  rig_free(r);
}
END_TEST

START_TEST(test_step_and_energy) {
  /* A step beyond the stability limit: said by the step's guard; with it out of the way (every), the energy's. Within
   * the limit neither says anything. */
  static const char scene[] =
      "{'materials':[{'name':'a','density':2500,'young_modulus':1e7,'poisson_ratio':0.25}],'contact':{'tangential':"
      "'%s'},'pairs':[{'materials':['a','a'],'restitution':%g%s}],'bodies':[{'name':'box','material':'a',"
      "'shapes':[{'type':'box','side':'inside','size':[0.1,0.1,0.2]}]}],'guard':{'action':'stop','every':%d,"
      "'overlap':10,'energy':%g},'particles':[{'type':'random','material':'a','count':60,'radius':0.01,'region':{'min':"
      "["
      "-0.05,-0.05,-0.1],'max':[0.05,0.05,0.1]}}]}";
  static const struct {
    double dt, e, energy;
    int every;
    const char *tangential, *says;
  } cases[] = {{1e-5, 0.5, 0.5, 10, "mindlin", NULL},
               {1e-5, 1, 0.05, 10, "none", NULL},
               {1.2e-3, 0.5, 1e9, 1, "mindlin", "a step of"},
               {1.2e-3, 1, 0.5, 10, "none", "rose by"}};
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    rig *r = rig_make(scene_json(scene, cases[k].tangential, cases[k].e,
                                 strcmp(cases[k].tangential, "none") ? ",'friction':0.5" : "", cases[k].every,
                                 cases[k].energy),
                      cases[k].dt, 0, NULL);
    long steps;
    tdm_error err = rig_guarded(r, k < 2 ? 20000 : 3000, &steps);
    if (!cases[k].says)
      ck_assert_msg(err.status == TDM_OK, "%zu: %s", k, err.message);
    else if (cases[k].says[0] == 'a')
      ck_assert_msg(err.status && strstr(err.message, "a step of"), "%zu: %s", k, err.message);
    else /* whichever sees it first */
      ck_assert_msg(err.status && (strstr(err.message, "rose by") || strstr(err.message, "a step of")), "%zu: %s", k,
                    err.message);
    rig_free(r);
  }
}
END_TEST

START_TEST(test_limits_of_substeps) {
  /* what multi-step takes four times in a step may have a step four times as long */
  dem_limits limits[2];
  for (int k = 0; k < 2; k++) {
    drop c = {
        0.01, 2500, 1e8, 0.6, 0.3, 1, k ? ",'integrator':'multi-step','multi_step':{'substeps':4,'mass':1}" : NULL};
    rig *r = drop_make(c, 1e-6);
    rig_steps(r, 20);
    tdm_error err = {0};
    ck_assert(!dem_limits_now(r->data, &limits[k], &err));
    rig_free(r);
  }
  ck_relative(limits[1].rayleigh, 4 * limits[0].rayleigh, 1e-12);
  ck_relative(limits[1].contact, 4 * limits[0].contact, 1e-3);
  ck_relative(limits[1].eigen, 4 * limits[0].eigen, 1e-3);
}
END_TEST

START_TEST(test_energy_of_a_push) {
  /* energy out of nothing, put in by hand: told with its amount */
  rig *r = rig_make(scene_json("{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],"
                               "'guard':{'action':'stop','every':10},'particles':[{'type':'list','material':'a',"
                               "'radius':0.1,'mass':2,'positions':[[0,0,0]],'velocity':[1,0,0]}]}"),
                    1e-4, 0, NULL);
  long steps;
  ck_assert_int_eq(rig_guarded(r, 105, &steps).status, TDM_OK);
  r->data->state.pace[0].velocity.x = 3; /* 1 J becomes 9 J */
  tdm_error err = rig_guarded(r, 10, &steps);
  ck_assert_int_eq(err.status, TDM_ERR_NUMERIC);
  ck_assert_ptr_nonnull(strstr(err.message, "rose by 8 J"));
  rig_free(r);
}
END_TEST

START_TEST(test_no_number) {
  rig *r =
      rig_make(scene_json("{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],"
                          "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.3}],"
                          "'guard':{'every':10},'particles':[{'type':'list','material':'a','radius':0.1,'positions':"
                          "[[0,0,0],[0,0,0.2],[5,5,5]]}]}"),
               1e-4, 0, NULL);
  long steps;
  ck_assert_int_eq(rig_guarded(r, 15, &steps).status, TDM_OK);
  r->data->state.pace[0].velocity.y = NAN;
  tdm_error err = rig_guarded(r, 10, &steps);
  ck_assert_int_eq(err.status, TDM_ERR_NUMERIC);
  ck_assert_int_eq(steps, 5); /* at step 20 */
  ck_assert_ptr_nonnull(strstr(err.message, "no number at t = 0.002 s, step 20"));
  ck_assert_ptr_nonnull(strstr(err.message, "id 0"));
  rig_free(r);
}
END_TEST

TEST_MAIN("dem extreme cases", test_stiffness_and_density, test_restitution, test_friction, test_size_ratio,
          test_one_and_none, test_absurd_places, test_inside, test_through_a_wall, test_fast_but_no_leap, test_head_on,
          test_lost, test_fast_body, test_energy_of_a_motion, test_overlap, test_step_and_energy,
          test_limits_of_substeps, test_energy_of_a_push, test_no_number)
