/* Rubber balls under a deck: what they can do to particles on a deck of [A07]'s reduced holes, and to those that are
 * stuck in the holes of real wires. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"
#include "tests/test_main.h"

/* Holes of 22 mm between wires of 6 mm, 28 mm apart: a particle of radius 11.4 mm hangs in one, 3.4 mm above the
 * middle of the deck, self-locking for friction above 0.24 (rise over run of the line to a wire). */
static const double near_size = 0.0114, wire = 0.003, across = 0.014;

#define WIRES "{'type':'screen','deck':'wires','layers':1,'hole':0.022,'bar':0.006,'radius':0.12}"
#define REDUCED "{'type':'screen','deck':'reduced','hole':0.022,'bar':0.006,'radius':0.12}"

static rig *under_deck(const char *gravity, const char *shapes, const char *motion, const char *particles) {
  return rig_make(scene_json("{'gravity':%s,'contact':{'normal':'hooke','tangential':'spring'},"
                             "'materials':[{'name':'m','density':2700},{'name':'rubber','density':1100}],"
                             "'pairs':[{'materials':['m','m'],'restitution':0.5,'stiffness':1e5,'friction':0.6,"
                             "'tangential_stiffness':3e4},"
                             "{'materials':['m','rubber'],'restitution':0.7,'stiffness':2e4,'friction':0.5,"
                             "'tangential_stiffness':6e3},"
                             "{'materials':['rubber','rubber'],'restitution':0.7,'stiffness':1e4,'friction':0.5,"
                             "'tangential_stiffness':3e3}],"
                             "'bodies':[{'name':'deck','material':'m','shapes':[%s]%s}],'particles':[%s]}",
                             gravity, shapes, motion, particles),
                  2e-5, 0, NULL);
}

static tdm_vec3 place_of(const rig *r, uint64_t id) {
  for (int i = 0; i < r->data->state.nparticle; i++)
    if (r->data->state.id[i] == id)
      return r->data->state.sphere[i].position;
  ck_abort_msg("no particle %d", (int)id);
  return tdm_v3(0, 0, 0);
}

#define STUCK "{'type':'list','material':'m','radius':0.0114,'positions':[[0,0,0.005]],'velocity':[0,0,-1]}"
#define BALL(z, v) \
  ",{'type':'list','material':'rubber','radius':0.02,'positions':[[0.001,0.002," z "]],'velocity':[0,0," v "]}"

/* A particle that fell into a hole of wires and is stuck there stays, until a ball from below knocks it out. */
START_TEST(a_ball_frees_a_stuck_particle) {
  rig *alone = under_deck("[0,0,-9.81]", WIRES, "", STUCK);
  rig *both = under_deck("[0,0,-9.81]", WIRES, "", STUCK BALL("-0.3", "3"));
  const double hangs = sqrt((near_size + wire) * (near_size + wire) - across * across);
  rig_steps(alone, 10000);
  tdm_vec3 stuck = place_of(alone, 0);
  ck_near(hypot(stuck.x, stuck.y), 0, 1e-4);
  ck_assert(fabs(stuck.z) < hangs); /* it was driven in deeper than it rests */
  double highest = 0;
  for (int k = 0; k < 10000; k++) {
    rig_steps(both, 1);
    highest = fmax(highest, place_of(both, 0).z);
  }
  ck_assert_double_gt(highest, near_size + wire); /* over the wires */
  rig_steps(alone, 10000);
  ck_vector(place_of(alone, 0), stuck, 1e-5);
  rig_free(both);
  rig_free(alone);
}
END_TEST

/* A reduced deck throws the ball back, and what lies on it feels nothing of that: it has no holes that anything could
 * hang in, and a deck that does not move does not shake. */
START_TEST(a_reduced_deck_hides_its_balls) {
  static const char lies[] = "{'type':'list','material':'m','radius':0.0114,'positions':[[0.03,0,0.0114]]}";
  rig *alone = under_deck("[0,0,-9.81]", REDUCED, "", lies);
  rig *both =
      under_deck("[0,0,-9.81]", REDUCED, "",
                 "{'type':'list','material':'m','radius':0.0114,'positions':[[0.03,0,0.0114]]}" BALL("-0.1", "2"));
  double fastest = 0, slowest = 0;
  for (int k = 0; k < 5000; k++) {
    rig_steps(alone, 1);
    rig_steps(both, 1);
    double v = both->data->state.pace[1].velocity.z;
    fastest = place_of(both, 1).z < -0.0201 && v > 0 ? v : fastest; /* before it hits */
    slowest = fmin(slowest, v);
    tdm_vec3 a = place_of(alone, 0), b = place_of(both, 0);
    ck_assert(a.x == b.x && a.y == b.y && a.z == b.z);
  }
  const dem_data *d = both->data;
  ck_assert_double_lt(place_of(both, 1).z, -0.02);
  ck_assert_double_gt(fastest, 1);
  ck_assert_double_lt(slowest, -0.5 * fastest);
  ck_assert(d->state.id[1] == 1);
  rig_free(both);
  rig_free(alone);
}
END_TEST

/* Nine stuck particles in a deck that shakes by 1.7 g, over a support grid that the product would fall through and the
 * balls do not: with balls most get free, without none; and no ball passes deck, grid or wall. */
START_TEST(balls_work_in_a_machine) {
  static const char grid[] = WIRES ",{'type':'screen','deck':'wires','layers':1,'hole':0.026,'bar':0.004,'radius':0.12,"
                                   "'center':[0.015,0.015,-0.06]},"
                                   "{'type':'cylinder','side':'inside','radius':0.1,'length':0.14,'point':[0,0,-0.08]}";
  static const char shake[] =
      ",'motion':{'start':0.2,'oscillation':{'amplitude':[0.004,0,0.003],'frequency':12,'phase':1.5707963267948966}}";
  static const char stuck[] = "{'type':'block','material':'m','radius':0.0114,'spacing':0.028,"
                              "'corner':[-0.028,-0.028,0.005],'count':[3,3,1],'velocity':[0,0,-1]}";
  static const char balls[] = ",{'type':'block','material':'rubber','radius':0.0165,'spacing':0.035,"
                              "'corner':[-0.035,-0.035,-0.03],'count':[3,3,1]}";
  int freed[2];
  for (int with = 0; with < 2; with++) {
    char all[1000];
    snprintf(all, sizeof all, "%s%s", stuck, with ? balls : "");
    rig *r = under_deck("[0,0,-9.81]", grid, shake, all);
    const dem_data *d = r->data;
    rig_steps(r, 200000);
    freed[with] = 0;
    for (uint64_t id = 0; id < 9; id++) {
      tdm_vec3 hole = tdm_v3(0.028 * ((double)(id % 3) - 1), 0.028 * ((double)(id / 3) - 1), 0.005);
      tdm_vec3 x = tdm_sub(place_of(r, id), d->state.pose[0].position);
      freed[with] += tdm_norm(tdm_sub(x, hole)) > 0.014;
    }
    for (uint64_t id = 9; id < (uint64_t)d->state.nparticle; id++) {
      tdm_vec3 x = tdm_sub(place_of(r, id), d->state.pose[0].position);
      ck_assert_msg(x.z < 0 && x.z > -0.06 && hypot(x.x, x.y) < 0.1, "ball at [%g, %g, %g]", x.x, x.y, x.z);
    }
    rig_free(r);
  }
  ck_assert_int_eq(freed[0], 0);
  ck_assert_int_gt(freed[1], 4);
}
END_TEST

TEST_MAIN("dem_rubber", a_ball_frees_a_stuck_particle, a_reduced_deck_hides_its_balls, balls_work_in_a_machine)
