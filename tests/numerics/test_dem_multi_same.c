/* Contacts that act on each other: where mc-stress and mc-strain must be Hertz's law bit by bit, and the same bits
 * whatever threads, instruction set, search and lists are. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/numbers/simd_set.h"
#include "test_multi_support.h"
#include "tests/test_main.h"

/* ---- what must be Hertz's law ---- */

#define IMPACT                                                                                              \
  "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0]],'velocity':[0.5,0.1,0]}," \
  "{'type':'list','material':'a','radius':0.012,'positions':[[0.0225,0,0]],'velocity':[-0.5,0,0]}]"
/* Two particles: mc-strain, and mc-stress without a contact's own force, are the classical law, bit by bit. */
START_TEST(test_two_are_classical) {
  static const char *const laws[][2] = {{"'gamma':1.12", "'multi_contact':'mc-strain'"},
                                        {"'gamma':1.12", "'multi_contact':'mc-strain','iterations':3"},
                                        {"'gamma':1.12", "'multi_contact':'mc-strain','first_forces':'hertz'"},
                                        {"'beta':1.65", "'multi_contact':'mc-stress','self_contribution':'exclude'"}};
  static const char *const pairs[] = {"'restitution':0.8,'friction':0.3,", "'viscosity':300,'friction':0.3,"};
  char pair[200];
  for (int k = 0; k < 2; k++) {
    snprintf(pair, sizeof pair, "%s%s", pairs[k], laws[_i][0]);
    rig *r = make("", "0.5", pair, laws[_i][1], IMPACT, 1e-5);
    snprintf(pair, sizeof pair, "%.*s", (int)strlen(pairs[k]) - 1, pairs[k]);
    rig *classical = make("", "0.5", pair, "'multi_contact':'none'", IMPACT, 1e-5);
    ck_assert_int_eq(r->data->state.ncontact, 0);
    rig_steps(r, 200);
    rig_steps(classical, 200);
    ck_assert_int_eq(r->data->state.ncontact, 1);
    ck_same_run(r, classical, 3000);
  }
}
END_TEST

#define CORNER                                                                                                \
  "'bodies':[{'name':'box','material':'a','shapes':[{'type':'plane','normal':[0,0,1],'point':[0,0,-0.0095]}," \
  "{'type':'plane','normal':[1,0,0],'point':[-0.0095,0,0]}]}],%s"

static rig *crowd(const char *nu, const char *pair, const char *contact) {
  return rig_make(scene_json("{'gravity':[0,0,0],'materials':[{'name':'a','density':1150,'young_modulus':23300,"
                             "'poisson_ratio':%s}],'pairs':[{'materials':['a','a'],%s}],'contact':{%s}," CORNER "}",
                             nu, pair, contact, lattice((const int[]){8, 8, 8}, 0.0193, "")),
                  2e-5, 0, NULL);
}

/* Many: without a Poisson's ratio mc-stress is the classical law, as both laws are without their factors. */
START_TEST(test_many_are_classical) {
  static const char *const laws[][3] = {
      {"0", "'restitution':0.8,'friction':0.3,'beta':5", "'multi_contact':'mc-stress'"},
      {"0.5", "'restitution':0.8,'friction':0.3,'beta':0", "'multi_contact':'mc-stress'"},
      {"0.5", "'restitution':0.8,'friction':0.3,'gamma':0", "'multi_contact':'mc-strain'"}};
  rig *r = crowd(laws[_i][0], laws[_i][1], laws[_i][2]);
  rig *classical = crowd(laws[_i][0], "'restitution':0.8,'friction':0.3", "'normal':'hertz'");
  ck_same_run(r, classical, 300);
}
END_TEST

/* ---- same bits ---- */

static rig *thousands(const char *more, int law) {
  static const char *const laws[][2] = {
      {"'restitution':0.9,'friction':0.3,'gamma':1.12", "'multi_contact':'mc-strain'"},
      {"'restitution':0.9,'friction':0.3,'beta':1.65", "'multi_contact':'mc-stress'"},
      {"'restitution':0.9,'friction':0.3,'gamma':1.12", "'multi_contact':'mc-strain','tolerance':1e-6"}};
  json_t *scene = scene_json(
      SCENE, more, "0.46", laws[law][0], laws[law][1],
      "'bodies':[{'name':'box','material':'a','shapes':[{'type':'plane','normal':[0,0,1],'point':[0,0,-0.0095]},"
      "{'type':'cylinder','side':'inside','radius':0.18,'length':0.4,'point':[0.13,0.13,0.13],'axis':[0,0,1]}]}],"
      "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[]}]");
  json_t *positions = json_object_get(json_array_get(json_object_get(scene, "particles"), 0), "positions");
  for (int k = 0; k < 14 * 14 * 14; k++)
    json_array_append_new(positions,
                          json_pack("[f,f,f]", 0.0193 * (k % 14), 0.0193 * (k / 14 % 14), 0.0193 * (k / 196)));
  rig *r = rig_make(scene, 2e-5, 0, NULL);
  for (int i = 0; i < r->data->state.nparticle; i++)
    r->data->state.pace[i].velocity = tdm_v3(sin(3.0 * i), cos(5.0 * i), sin(7.0 * i));
  r->data->state.restart = true;
  return r;
}

START_TEST(test_same_bits) {
  static const char *const ways[] = {"'threads':2,", "'simd':'plain',", "'search':'sweep','skin':0.003,",
                                     "'energy':true,'threads':2,", "'simd':'avx2',"};
  const int law = _i / 5, way = _i % 5;
  if (way == 4 && !dem_simd_here("avx2"))
    return;
  rig *r = thousands("", law), *other = thousands(ways[way], law);
  ck_assert_int_gt(r->data->lists.crossings.count, 0);
  ck_same_run(r, other, law == 2 ? 20 : 60);
}
END_TEST

/* Particles that come and go: the same whatever the lists hold. */
static rig *flowing(const char *more, const char *pair, const char *law) {
  rig *r = rig_make(
      scene_json("{%s'materials':[{'name':'a','density':1150,'young_modulus':23300,'poisson_ratio':0.5}],'pairs':["
                 "{'materials':['a','a'],'restitution':0.5,'friction':0.3,%s}],'contact':{%s},'bodies':[{'name':"
                 "'funnel','material':'a','shapes':[{'type':'cylinder','side':'inside','radius':0.03,'length':0.4,"
                 "'point':[0,0,0.1],'axis':[0,0,1]}]}],'sources':[{'name':'s','material':'a','radius':0.01,"
                 "'rate':200,'region':{'min':[-0.01,-0.01,0.2],'max':[0.01,0.01,0.22]},'velocity':[0,0,-3]}],"
                 "'sinks':[{'name':'out','type':'plane','point':[0,0,0],'normal':[0,0,1]}],'particles':[]}",
                 more, pair, law),
      1e-4, 0, NULL);
  for (int k = 0; k < 4000; k++) {
    rig_steps(r, 1);
    flow_now(r->data, (double)(k + 1) * 1e-4, 1e-4);
  }
  return r;
}

START_TEST(test_come_and_go) {
  static const char *const laws[][2] = {{"'gamma':1.12", "'multi_contact':'mc-strain'"},
                                        {"'beta':1.65", "'multi_contact':'mc-stress'"}};
  rig *r = flowing("", laws[_i][0], laws[_i][1]), *other = flowing("'skin':0.004,", laws[_i][0], laws[_i][1]);
  ck_assert_uint_gt(r->data->state.ledger.removed, 20);
  ck_assert_int_eq(r->data->state.nparticle, other->data->state.nparticle);
  ck_assert_mem_eq(r->data->state.sphere, other->data->state.sphere,
                   (size_t)r->data->state.nparticle * sizeof *r->data->state.sphere);
  rig_free(r);
  rig_free(other);
}
END_TEST

/* A copy goes on as the one it was taken from. */
START_TEST(test_copy) {
  rig *r = heap("", _i ? "'multi_contact':'mc-stress'" : "'multi_contact':'mc-strain'", 1.12, 1e-5);
  rig_steps(r, 50);
  dem_data *copy = dem_data_create(r->model);
  ck_assert(copy != NULL);
  ck_assert_int_eq(dem_data_copy(copy, r->data), TDM_OK);
  rig_steps(r, 50);
  for (int k = 0; k < 50; k++)
    one_step(copy, NULL, r->model->dt);
  ck_assert_mem_eq(copy->state.sphere, r->data->state.sphere,
                   (size_t)copy->state.nparticle * sizeof *copy->state.sphere);
  dem_data_destroy(&copy);
  rig_free(r);
}
END_TEST

TEST_MAIN_ROWS("contacts that act on each other: the same bits", {test_two_are_classical, 4},
               {test_many_are_classical, 3}, {test_same_bits, 15}, {test_come_and_go, 2}, {test_copy, 2})
