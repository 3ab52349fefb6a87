/* What is stored in the particles, and what sources, sinks, an open box and driven bodies have supplied. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/flow/flow.h"
#include "dem/particles/create.h"
#include "dem/particles/domain.h"
#include "dem/watch/energy_balance.h"
#include "tests/test_main.h"

/* no friction, no damping */
#define BALL                                                                            \
  "'materials':[{'name':'a','density':1000,'young_modulus':1e6,'poisson_ratio':0.25}]," \
  "'pairs':[{'materials':['a','a'],'restitution':1,'friction':0}],'guard':{'every':10}"

static void steps(rig *r, long n) {
  dem_data *d = r->data;
  for (long k = 0; k < n; k++) {
    one_step(d, NULL, r->model->dt);
    flow_now(d, (double)d->state.nstep * r->model->dt, r->model->dt);
  }
}

/* now, whatever was looked at before */
static tdm_energy look(dem_data *d) {
  d->state.energy_balance.next_look = 0;
  return dem_energy_balance_look(d);
}

START_TEST(a_driven_plate_supplies_what_particles_gain) {
  rig *r = rig_make(scene_json("{'gravity':[0,0,-9.81]," BALL
                               ",'bodies':[{'name':'plate','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}],"
                               "'motion':{'oscillation':{'amplitude':[0,0,5e-3],'frequency':11}}}],"
                               "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0.02],"
                               "[0.05,0,0.03]]}]}"),
                    2e-6, 0, NULL);
  dem_energy_balance_begin(r->data);
  tdm_energy start = look(r->data);
  double most = 0;
  for (int k = 0; k < 250; k++) {
    steps(r, 1000);
    tdm_energy now = look(r->data);
    most = fmax(most, fabs(now.supplied));
    ck_near(now.stored - now.supplied, start.stored, 2e-5 * start.stored + 1e-3 * most);
  }
  ck_assert(most > 0.2 * start.stored); /* the plate did work */
  ck_assert(look(r->data).supplied != 0);
  rig_free(r);
}
END_TEST

START_TEST(sources_and_sinks_are_accounted_for) {
  rig *r = rig_make(scene_json("{'gravity':[0,0,-9.81]," BALL ",'domain':{'min':[-1,-1,-1],'max':[1,1,1]},"
                               "'sources':[{'name':'s','material':'a','radius':0.01,'rate':100,"
                               "'position':[0,0,0.5],'velocity':[1,0,-1]}],"
                               "'sinks':[{'name':'k','type':'plane','point':[0,0,0.2],'normal':[0,0,1]}]}"),
                    1e-4, 0, NULL);
  flow_now(r->data, 0, r->model->dt);
  dem_energy_balance_begin(r->data);
  double start = look(r->data).stored, least = 0, most = 0;
  for (int k = 0; k < 50; k++) {
    steps(r, 100);
    tdm_energy now = look(r->data);
    ck_near(now.stored - now.supplied, start, 1e-9);
    least = fmin(least, now.supplied);
    most = fmax(most, now.supplied);
  }
  ck_assert(r->data->state.ledger.removed > 10 && most > 0);
  rig_free(r);
}
END_TEST

START_TEST(looks_are_some_steps_apart) {
  rig *r = rig_make(scene_json("{" BALL ",'particles':[{'type':'list','material':'a','radius':0.01,"
                               "'positions':[[0,0,0]]}]}"),
                    1e-5, 0, NULL);
  dem_energy_balance_begin(r->data);
  ck_assert(!isnan(dem_energy_balance_look(r->data).stored));
  steps(r, 9);
  ck_assert(isnan(dem_energy_balance_look(r->data).stored) && isnan(dem_energy_balance_look(r->data).kinetic));
  steps(r, 1);
  ck_assert(!isnan(dem_energy_balance_look(r->data).stored));
  /* a copy looks when the original does */
  dem_data *copy = dem_data_create(r->model);
  ck_assert_int_eq(dem_data_copy(copy, r->data), TDM_OK);
  ck_assert(isnan(dem_energy_balance_look(copy).stored));
  dem_data_destroy(&copy);
  rig_free(r);
}
END_TEST

START_TEST(what_cannot_be_accounted_for_is_not_told) {
  static const char *const extra[] = {"'domain':{'min':[0,0,0],'max':[1,1,1],'x':'periodic','strain_rate':[0.1,0,0]}",
                                      "'domain':{'min':[0,0,0],'max':[1,1,1],'z':'periodic'},'gravity':[0,0,-9.81]",
                                      "'bodies':[{'name':'belt','material':'a','shapes':[{'type':'plane','normal':[0,0,"
                                      "1],'surface_velocity':[1,0,0]}]}]"};
  for (int i = 0; i < 3; i++) {
    rig *r = rig_make(scene_json("{%s," BALL ",'particles':[{'type':'list','material':'a','radius':0.01,"
                                 "'positions':[[0.5,0.5,0.5]]}]}",
                                 extra[i]),
                      1e-5, 0, NULL);
    dem_energy_balance_begin(r->data);
    ck_assert_msg(isnan(dem_energy_balance_look(r->data).stored), "scene %d", i);
    rig_free(r);
  }
}
END_TEST

TEST_MAIN("energy_balance", a_driven_plate_supplies_what_particles_gain, sources_and_sinks_are_accounted_for,
          looks_are_some_steps_apart, what_cannot_be_accounted_for_is_not_told)
