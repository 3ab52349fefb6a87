/* Contacts that act on each other: momentum, energy and the work of a press, friction, limits of the step, what is
 * told and what is refused. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/watch/check.h"
#include "dem/watch/energy_balance.h"
#include "dem/watch/limits.h"
#include "protocol/scene/remark.h"
#include "test_multi_support.h"
#include "tests/test_main.h"

/* ---- what is kept ---- */

typedef struct {
  tdm_vec3 linear, angular;
  double size; /* sum of magnitudes, what round-off is measured by */
} momenta;

static momenta momenta_of(const dem_data *d) {
  momenta p = {0};
  for (int i = 0; i < d->state.nparticle; i++) {
    double m = d->state.mass[i], r = d->state.sphere[i].radius;
    tdm_vec3 v = tdm_scale(m, d->state.pace[i].velocity), x = d->state.sphere[i].position;
    p.linear = tdm_add(p.linear, v);
    p.angular = tdm_add(p.angular, tdm_axpy(0.4 * m * r * r, d->state.pace[i].spin, tdm_cross(x, v)));
    p.size += tdm_norm(v);
  }
  return p;
}

/* 514 balls that rub and fly apart: no force on all of them. */
START_TEST(test_momenta) {
  static const char *const laws[][2] = {{"'gamma':1.12", "'multi_contact':'mc-strain'"},
                                        {"'beta':1.65", "'multi_contact':'mc-stress'"}};
  char pair[100];
  snprintf(pair, sizeof pair, "'restitution':0.9,'friction':0.3,%s", laws[_i][0]);
  rig *r = make("", "0.5", pair, laws[_i][1],
                lattice((const int[]){8, 8, 8}, 0.0193,
                        ",{'type':'list','material':'a','radius':0.01,'positions':[[0.01,0.01,-0.016],"
                        "[0.05,0.05,-0.016]],'velocity':[0.3,0.2,0.1]}"),
                1e-5);
  for (int i = 0; i < 512; i++)
    r->data->state.pace[i].velocity = tdm_v3(0.3 * sin(3.0 * i), 0.3 * cos(5.0 * i), 0.3 * sin(7.0 * i));
  r->data->state.restart = true;
  ck_assert_int_eq(r->data->state.nparticle, 514);
  momenta before = momenta_of(r->data);
  rig_steps(r, 2000);
  momenta after = momenta_of(r->data);
  ck_assert_double_lt(tdm_norm(tdm_sub(after.linear, before.linear)), 1e-13 * after.size);
  ck_assert_double_lt(tdm_norm(tdm_sub(after.angular, before.angular)), 1e-13 * after.size * 0.15);
  rig_free(r);
}
END_TEST

/* One that two others meet, whose contacts grow alike: no energy is lost or made. */
START_TEST(test_energy) {
  static const char *const laws[][2] = {
      {"'restitution':1,'beta':1.65", FREE ",'multi_contact':'mc-stress'"},
      {"'restitution':1,'gamma':1.12", FREE ",'multi_contact':'mc-strain','first_forces':'hertz','tolerance':1e-12"}};
  rig *r = make("'energy':true,", "0.46", laws[_i][0], laws[_i][1],
                "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0]]},{'type':'list',"
                "'material':'a','radius':0.01,'positions':[[-0.0201,0,0]],'velocity':[0.5,0,0]},{'type':'list',"
                "'material':'a','radius':0.01,'positions':[[0.0201,0,0]],'velocity':[-0.5,0,0]}]",
                2e-6);
  dem_data *d = r->data;
  double start = dem_stored_energy_now(d).kinetic, most = 0, off = 0;
  for (int k = 0; k < 200000 && !(most > 0 && d->state.ncontact == 0); k++) {
    rig_steps(r, 1);
    dem_stored_energy e = dem_stored_energy_now(d);
    most = fmax(most, e.elastic);
    off = fmax(off, fabs(e.kinetic + e.elastic - start));
    ck_near(dem_energy_elastic(&d->state.energy), e.elastic, 1e-12 * start);
  }
  ck_assert_int_eq(d->state.ncontact, 0);
  ck_assert_double_gt(most, 0.999 * start);
  ck_assert_double_lt(off, (_i == 0 ? 1e-6 : 0.02) * start); /* mc-strain: places of contacts move */
  ck_near(dem_stored_energy_now(d).kinetic, start, (_i == 0 ? 1e-6 : 1e-5) * start); /* there and back */
  rig_free(r);
}
END_TEST

/* Friction is limited by the whole force: a sphere that slides between two plates. */
START_TEST(test_friction) {
  static const char *const laws[][2] = {{"'restitution':1,'friction':0.3,'beta':5", "'multi_contact':'mc-stress'"},
                                        {"'restitution':1,'friction':0.3,'gamma':1.12", "'multi_contact':'mc-strain'"}};
  rig *r =
      make("", "0.46", laws[_i][0], laws[_i][1],
           "'bodies':[{'name':'below','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]},{'name':'above',"
           "'material':'a','shapes':[{'type':'plane','normal':[0,0,-1],'point':[0,0,0.0188]}]}],'particles':["
           "{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0.0094]],'velocity':[5,0,0]}]",
           1e-6);
  rig_steps(r, 200);
  const tdm_wrench *load = r->data->state.body_load;
  ck_assert_double_gt(fabs(load[1].force.z), 1.1 * hertz(radius, 6e-4));
  ck_relative(load[1].force.x, 0.3 * fabs(load[1].force.z), 1e-12);
  ck_relative(load[0].force.x, 0.3 * fabs(load[0].force.z), 1e-12);
  rig_free(r);
}
END_TEST

/* Coulomb's limit from both sides: a spring that pulls more than the friction of Hertz's force allows holds, up to that
 * of the whole force. k_t is 8 G* times the radius of the contact's circle: of delta with mc-stress, of the corrected
 * overlap with mc-strain. */
START_TEST(test_friction_holds) {
  static const char *const laws[][2] = {
      {"'restitution':1,'friction':0.3,'beta':5", "'multi_contact':'mc-stress'"},
      {"'restitution':1,'friction':0.3,'gamma':1.12", "'multi_contact':'mc-strain','first_forces':'hertz'"}};
  const double overlap = 6e-4, friction = 0.3, modulus = young / (2 * (1 + poisson)) / (2 * (2 - poisson));
  const double of_hertz = hertz(radius, overlap), dt = 1e-6;
  const bool holds = _i / 2 == 0;
  rig *r = make("", "0.46", laws[_i % 2][0], laws[_i % 2][1],
                "'bodies':[{'name':'below','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]},{'name':"
                "'above','material':'a','shapes':[{'type':'plane','normal':[0,0,-1],'point':[0,0,0.0188]}]}],"
                "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0.0094]]}]",
                dt);
  const tdm_wrench *load = r->data->state.body_load;
  const double force = fabs(load[1].force.z);
  ck_assert_double_gt(force, 1.05 * of_hertz);
  const double wide = _i % 2 == 0 ? overlap : pow(force / hertz(radius, 1), 2.0 / 3);
  const double stiffness = 8 * modulus * sqrt(radius * wide);
  const double pull = friction * (holds ? 0.5 * (of_hertz + force) : 1.1 * force);
  r->data->state.pace[0].velocity.x = pull / stiffness / (19.5 * dt); /* the first step stretches by half of its way */
  r->data->state.restart = true;
  rig_steps(r, 20);
  ck_relative(load[1].force.x, holds ? pull : friction * force, 1e-4);
  ck_relative(load[0].force.x, holds ? pull : friction * force, 1e-4);
  rig_free(r);
}
END_TEST

/* What a press puts in is what the balls store and lose: pressed together and let go, by the scene's own plates. */
START_TEST(test_work_of_a_press) {
  static const char *const laws[][2] = {
      {"'restitution':0.7,'friction':0.3,'beta':1.65", "'multi_contact':'mc-stress'"},
      {"'restitution':0.7,'friction':0.3,'gamma':1.12", "'multi_contact':'mc-strain'"},
      {"'restitution':0.7,'friction':0.3,'gamma':1.12", "'multi_contact':'mc-strain','first_forces':'hertz'"}};
  rig *r =
      make("'energy':true,", "0.46", laws[_i][0], laws[_i][1],
           lattice((const int[]){3, 3, 3}, 0.0199,
                   "],'bodies':[{'name':'plate','material':'a','shapes':[{'type':'plane','normal':[0,0,-1]}],"
                   "'position':[0,0,0.0499],'motion':{'oscillation':{'amplitude':[0,0,0.002],'frequency':10,"
                   "'phase':1.5707963267948966}}},"
                   "{'name':'box','material':'a','shapes':[{'type':'plane','normal':[0,0,1],'point':[0,0,-0.0099]},"
                   "{'type':'plane','normal':[1,0,0],'point':[-0.0099,0,0]},{'type':'plane','normal':[-1,0,0],"
                   "'point':[0.0497,0,0]},{'type':'plane','normal':[0,1,0],'point':[0,-0.0099,0]},{'type':'plane',"
                   "'normal':[0,-1,0],'point':[0,0.0497,0]}]}"),
           1e-5);
  dem_data *d = r->data;
  dem_energy_balance_begin(r->data);
  dem_energy_begin(&r->data->state.energy);
  const dem_stored_energy start = dem_stored_energy_now(d);
  double most = 0, off = 0, loss = 0;
  for (int k = 0; k < 10000; k++) {
    rig_steps(r, 1);
    const dem_stored_energy now = dem_stored_energy_now(d);
    loss = 0;
    for (int m = 0; m < DEM_ENERGIES; m++)
      loss += d->state.energy.dissipated[m];
    const double stored = now.kinetic + now.elastic - start.kinetic - start.elastic;
    off = fmax(off, fabs(d->state.energy_balance.driven - stored - loss));
    most = fmax(most, stored);
  }
  ck_assert_double_gt(most, 1e-4);
  ck_assert_double_lt(off, 1e-4 * most);
  ck_assert_double_gt(loss, 0.01 * most);
  rig_free(r);
}
END_TEST

/* [G21] Eq. 5: a tangential viscosity instead of the damping of the restitution */
START_TEST(test_tangential_viscosity) {
  rig *r = make("", "0.46", "'viscosity':10,'friction':1e6,'tangential_viscosity':0.7", "'tangential':'mindlin'",
                "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0]]},{'type':'list',"
                "'material':'a','radius':0.01,'positions':[[0.0192,0,0]],'velocity':[0,0.25,0]}]",
                1e-6);
  ck_assert(r->model->all_terms);
  ck_relative(r->data->state.push[1].force.y, -0.7 * 0.25, 1e-14);
  rig_free(r);
}
END_TEST

/* ---- limits and readers ---- */

/* A bed that is pressed together may begin so where the guard is told of deep overlaps. */
START_TEST(test_deep_start) {
  static const char *const guards[] = {"", "'guard':{'overlap':0.2},", "'guard':{'overlap':0.9},"};
  tdm_error err = {0};
  int behind;
  rig *r = make(guards[_i], "0.5", ELASTIC ",'beta':1.65", FREE ",'multi_contact':'mc-stress'",
                "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0],[0.0185,0,0]]}]", 1e-5);
  tdm_status status = dem_check_start(r->data, &behind, &err);
  ck_assert_int_eq(status, _i == 2 ? TDM_OK : TDM_ERR_SCENE);
  rig_free(r);
}
END_TEST

/* The stable step knows how stiff contacts have become. */
START_TEST(test_limits) {
  static const char *const laws[] = {"'multi_contact':'mc-stress'",
                                     "'multi_contact':'mc-strain','first_forces':'hertz'"};
  dem_limits classical, now;
  tdm_error err = {0};
  rig *r = heap("", "'multi_contact':'mc-stress'", 0, 1e-6);
  ck_assert_int_eq(dem_limits_now(r->data, &classical, &err), TDM_OK);
  rig_free(r);
  r = heap("", laws[_i], 1.12, 1e-6);
  ck_assert_int_eq(dem_limits_now(r->data, &now, &err), TDM_OK);
  ck_assert_double_lt(now.eigen, 0.95 * classical.eigen);
  ck_assert_double_eq(now.rayleigh, classical.rayleigh);
  rig_free(r);
}
END_TEST

/* Iterations that are used up before forces keep still are told of: once a look of the guard, or as an error. */
START_TEST(test_iterations) {
  static const struct {
    const char *guard, *law;
    bool told, stops;
  } cases[] = {{"", "'tolerance':1e-12,'iterations':3", true, false},
               {"'guard':{'action':'stop'},", "'tolerance':1e-12,'iterations':3", true, true},
               {"", "'tolerance':1e-6", false, false},
               {"", "'iterations':3", false, false}};
  char law[200];
  tdm_remarks remarks = {0};
  snprintf(law, sizeof law, "'multi_contact':'mc-strain','first_forces':'hertz',%s", cases[_i].law);
  rig *r = heap(cases[_i].guard, law, 0.6, 1e-5);
  tdm_remarks_open(&remarks);
  dem_guard_begin(r->data);
  tdm_error err = {0};
  for (int k = 1; k <= 250 && err.status == TDM_OK; k++)
    dem_step(r->data, &(dem_step_task){.dt = r->model->dt, .time = k * r->model->dt, .guard = true}, &err);
  int found = -1;
  for (int k = 0; k < remarks.count; k++)
    found = strcmp(remarks.entry[k].event, "guard.iterations") == 0 ? k : found;
  ck_assert_int_eq(err.status, cases[_i].stops ? TDM_ERR_NUMERIC : TDM_OK);
  ck_assert_int_eq(found >= 0, cases[_i].told && !cases[_i].stops);
  if (found >= 0) {
    ck_assert_int_eq(remarks.entry[found].level, TDM_WARNING);
    ck_assert_uint_eq(remarks.entry[found].count, 2);
    ck_assert_str_eq(remarks.entry[found].path, "dem.contact.iterations");
  }
  if (cases[_i].told)
    ck_assert(strstr(found >= 0 ? remarks.entry[found].message : err.message,
                     "dem.contact.iterations = 3 one more would still change"));
  tdm_remarks_open(NULL);
  rig_free(r);
}
END_TEST

START_TEST(test_refused) {
  static const struct {
    const char *more, *pair, *contact, *path, *says;
  } cases[] = {
      {"", "'restitution':1,'friction':0", "'multi_contact':'mc-stress'", "dem.pairs[0].beta", "needs it"},
      {"", "'restitution':1,'friction':0", "'multi_contact':'mc-strain'", "dem.pairs[0].gamma", "needs it"},
      {"", "'restitution':1,'friction':0,'beta':1", "'multi_contact':'mc-strain'", "dem.pairs[0].gamma", "needs it"},
      {"", "'restitution':1,'friction':0,'beta':1", "'normal':'hertz'", "dem.pairs[0].beta",
       "none of the scene's laws"},
      {"", "'restitution':1,'friction':0,'beta':1,'stiffness':1", "'normal':'hooke','multi_contact':'mc-stress'",
       "dem.contact.multi_contact", "corrects Hertz's force"},
      {"", "'restitution':1,'friction':0,'gamma':1", "'normal':'hunt-crossley','multi_contact':'mc-strain'",
       "dem.contact.multi_contact", "use \"hertz\""},
      {"", "'restitution':1,'friction':0,'beta':1,'cohesion_density':1",
       "'cohesion':'sjkr','multi_contact':'mc-stress'", "dem.contact.multi_contact", "cohesion"},
      {"", "'restitution':1,'friction':0,'beta':1", "'multi_contact':'mc-stress','iterations':2",
       "dem.contact.iterations", "\"mc-strain\" only"},
      {"", "'restitution':1,'friction':0,'gamma':1", "'multi_contact':'mc-strain','iterations':1,'tolerance':1e-3",
       "dem.contact.tolerance", "2 iterations"},
      {"", "'restitution':1,'friction':0", "'self_contribution':'exclude'", "dem.contact.self_contribution",
       "\"mc-stress\" only"},
      {"'integrator':'multi-step','multi_step':{'substeps':2,'mass':1},", "'restitution':1,'friction':0,'beta':1",
       "'multi_contact':'mc-stress'", "dem.contact.multi_contact", "multi_step"},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    tdm_error err = rig_refused(
        scene_json(SCENE, cases[k].more, "0.5", cases[k].pair, cases[k].contact,
                   "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0],[1,0,0]]}]"),
        NULL);
    ck_assert_msg(strcmp(err.path, cases[k].path) == 0 && strstr(err.message, cases[k].says), "%zu: %s: %s", k,
                  err.path, err.message);
  }
}
END_TEST

TEST_MAIN_ROWS("contacts that act on each other: what is kept", {test_momenta, 2}, {test_energy, 2}, {test_friction, 2},
               {test_friction_holds, 4}, {test_work_of_a_press, 3}, {test_iterations, 4},
               {test_tangential_viscosity, 1}, {test_limits, 2}, {test_deep_start, 3}, {test_refused, 1})
