/* Walls with another normal law than particles ("normal" of a pair): each contact meets the closed form of its own
 * law, in the loops of every tangential law and in those with all terms; and pairs that do not go together. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/adapter/report.h"
#include "dem/contact/law/theory.h"
#include "tests/test_main.h"

/* One disc falls on a plane, two meet head-on. [A07]: hysteretic particles, spring and dashpot walls. */
static rig *scene(const char *normal, const char *other, const char *grain, const char *wall, double dt) {
  return rig_make(
      scene_json("{'gravity':[0,0,0],'materials':[{'name':'a','density':2500,'young_modulus':1e8,"
                 "'poisson_ratio':0.3},{'name':'w','density':2500,'young_modulus':1e8,'poisson_ratio':0.3}],"
                 "'contact':{'normal':'%s'%s},'pairs':[{'materials':['a','a'],%s},{'materials':['a','w'],%s}],"
                 "'bodies':[{'name':'floor','material':'w','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                 "'particles':[{'type':'list','material':'a','radius':0.01,'mass':0.01,'positions':"
                 "[[0,0,0.0101],[1,0,1]],'velocity':[0,0,-1]},{'type':'list','material':'a','radius':0.01,"
                 "'mass':0.01,'positions':[[1,0,0.979]],'velocity':[0,0,0]}]}",
                 normal, other, grain, wall),
      dt, 0, NULL);
}

#define GRAIN "'stiffness':1e5,'unloading_stiffness':4e5"
#define WALL "'normal':'hooke','stiffness':2e5,'damping':5"

typedef struct {
  const char *normal, *other, *grain, *wall;
  double of_grains, of_wall; /* restitution */
} law;

START_TEST(test_each_has_its_own) {
  double ratio = 5 / (2 * sqrt(2e5 * 0.01)), linear = exp(-M_PI * ratio / sqrt(1 - ratio * ratio));
  const law laws[] = {
      {"hysteretic", ",'tangential':'none'", GRAIN, WALL, 0.5, linear},
      {"hysteretic", ",'tangential':'coulomb'", GRAIN ",'friction':0.3", WALL ",'friction':0.3", 0.5, linear},
      {"hysteretic", ",'tangential':'spring'", GRAIN ",'friction':0.3", WALL ",'friction':0.3", 0.5, linear},
      {"hysteretic", ",'tangential':'viscous'", GRAIN ",'tangential_damping':1", WALL ",'tangential_damping':1", 0.5,
       linear},
      {"hysteretic", ",'tangential':'none','rolling':'constant-torque'", GRAIN ",'rolling_friction':0.1",
       WALL ",'rolling_friction':0.1", 0.5, linear},
      {"hooke", ",'tangential':'spring'", "'stiffness':1e5,'restitution':0.6,'friction':0.3",
       "'normal':'hysteretic'," GRAIN ",'friction':0.3", 0.6, 0.5},
      {"hysteretic", ",'tangential':'none'", GRAIN, "'normal':'hunt-crossley','stiffness':1e7,'restitution':0.7", 0.5,
       0.7},
      {"hooke", ",'tangential':'none'", "'stiffness':1e5,'restitution':0.6", "'normal':'hertz','restitution':0.7", 0.6,
       0.7},
  };
  const law *l = &laws[_i];
  rig *r = scene(l->normal, l->other, l->grain, l->wall, 1e-6);
  const dem_model *m = r->model;
  ck_assert(m->wall_normal != m->normal);
  double falling = dem_normal_restitution(m, &m->pair[1], (dem_impact){.mass = 0.01, .radius = 0.01, .speed = 1});
  ck_near(falling, l->of_wall, 0.02);
  rig_steps(r, 5000);
  ck_near(r->data->state.pace[0].velocity.z, l->of_wall, 0.02);
  ck_near(r->data->state.pace[2].velocity.z - r->data->state.pace[1].velocity.z, -l->of_grains, 2e-3);
  rig_free(r);
}
END_TEST

/* energies of contacts go to the mechanism of the contact's own law */
START_TEST(test_energies) {
  rig *r = scene("hysteretic", ",'tangential':'none'},'energy':true,'guard':{'every':0", GRAIN, WALL, 1e-6);
  rig_steps(r, 5000);
  const dem_energy *e = &r->data->state.energy;
  ck_relative(e->dissipated[DEM_ENERGY_PLASTIC], 0.25 * 0.01 * (1 - 0.25), 1e-2);
  ck_near(e->dissipated[DEM_ENERGY_NORMAL], 0, 0);
  ck_assert(e->dissipated[DEM_ENERGY_WALL_NORMAL] > 1e-4);
  rig_free(r);
}
END_TEST

static void refused(const char *contact, const char *grain, const char *wall, const char *path, const char *says) {
  tdm_error err = rig_refused(
      scene_json(
          "{'materials':[{'name':'a','density':1,'young_modulus':1e7,'poisson_ratio':0.3},{'name':'w','density':1,"
          "'young_modulus':1e7,'poisson_ratio':0.3},{'name':'v','density':1,'young_modulus':1e7,'poisson_ratio':0.3}],"
          "'contact':{%s},'pairs':[{'materials':['a','a'],%s},%s],'bodies':[{'name':'f','material':'w','shapes':[{"
          "'type':'plane','normal':[0,0,1]}]},{'name':'g','material':'v','shapes':[{'type':'plane','normal':[0,0,1]}]"
          "}],'particles':[{'type':'list','material':'a','radius':1,'positions':[[0,0,1],[9,0,1]]}]}",
          contact, grain, wall),
      NULL);
  ck_assert_msg(strcmp(err.path, path) == 0 && strstr(err.message, says), "%s: %s", err.path, err.message);
}

START_TEST(test_pairs_that_do_not_go_together) {
  static const char hooke[] = "'stiffness':1e4,'restitution':0.5";
  char pair[1024];
#define PAIR(...) (snprintf(pair, sizeof pair, __VA_ARGS__), pair)
  const char *plain = "'normal':'hysteretic','tangential':'none'";
  refused(plain, "'normal':'hooke','stiffness':1e4,'restitution':0.5",
          PAIR("{'materials':['a','w'],'normal':'hooke',%s},{'materials':['a','v'],'normal':'hooke',%s}", hooke, hooke),
          "dem.pairs", "meet as particles");
  refused(plain, GRAIN, PAIR("{'materials':['a','w'],'normal':'hooke',%s},{'materials':['a','v']," GRAIN "}", hooke),
          "dem.pairs", "\"a\" and \"v\" meet at walls, whose normal law is \"hooke\"");
  refused(plain, GRAIN,
          PAIR("{'materials':['a','w'],'normal':'hooke',%s},{'materials':['a','v'],'normal':'hertz','restitution':0.5}",
               hooke),
          "dem.pairs[2].normal", "give all walls one");
  refused(plain, GRAIN, PAIR("{'materials':['a','w'],'normal':'hoke',%s},{'materials':['a','v'],%s}", hooke, hooke),
          "dem.pairs[1].normal", "hooke");
  refused(plain, GRAIN,
          PAIR("{'materials':['a','w'],'normal':'hooke','adhesion_stiffness':1,%s},{'materials':['a','v'],%s}", hooke,
               hooke),
          "dem.pairs[1].adhesion_stiffness", "none of the scene's laws (normal \"hooke\"");
  refused("'normal':'hertz','cohesion':'dmt','tangential':'none'", "'restitution':0.5,'adhesion_energy':0.1",
          PAIR("{'materials':['a','w'],'normal':'hooke','adhesion_energy':0.1,%s}", hooke), "dem.contact.cohesion",
          "\"hooke\"");
  refused("'normal':'hertz','tangential':'mindlin'", "'restitution':0.5,'friction':0.1",
          PAIR("{'materials':['a','w'],'normal':'hooke','friction':0.1,%s}", hooke), "dem.contact.tangential",
          "\"hooke\"");
}
END_TEST

TEST_MAIN_ROWS("dem wall law", {test_each_has_its_own, 8}, {test_energies, 1}, {test_pairs_that_do_not_go_together, 1})
