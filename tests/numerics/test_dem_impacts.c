/* Each normal contact law against its closed form: impacts of two free spheres. Equations: docs/theory/dem.md. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/contact/law/restitution.h"
#include "dem/contact/law/theory.h"
#include "tests/test_main.h"

/* radii and masses of two spheres that touch at the origin and approach along x */
typedef struct {
  double radius[2], mass[2], speed;
} spheres;

static const spheres usual = {{0.01, 0.015}, {0.01, 0.03}, 0.5};

static rig *head_on(const spheres *s, const char *contact, const char *pair, double dt) {
  return rig_make(scene_json("{'gravity':[0,0,0],'materials':[{'name':'a','density':2500,'young_modulus':1e7,"
                             "'poisson_ratio':0.3}],'pairs':[{'materials':['a','a'],%s}],'contact':{%s},'particles':["
                             "{'type':'list','material':'a','radius':%.17g,'mass':%.17g,'positions':[[%.17g,0,0]],"
                             "'velocity':[%.17g,0,0]},"
                             "{'type':'list','material':'a','radius':%.17g,'mass':%.17g,'positions':[[%.17g,0,0]]}]}",
                             pair, contact, s->radius[0], s->mass[0], -s->radius[0], s->speed, s->radius[1], s->mass[1],
                             s->radius[1]),
                  dt, 0, NULL);
}

static dem_impact impact_of(const spheres *s) {
  return (dem_impact){.mass = 1 / (1 / s->mass[0] + 1 / s->mass[1]),
                      .radius = 1 / (1 / s->radius[0] + 1 / s->radius[1]),
                      .speed = s->speed};
}

typedef struct {
  double time, overlap, restitution;
  bool parted; /* within the steps that were given */
} measured;

static measured measure(rig *r, long most) {
  measured out = {0};
  const dem_data *d = r->data;
  double v0 = d->state.pace[0].velocity.x - d->state.pace[1].velocity.x;
  long k = 0;
  do {
    rig_steps(r, 1);
    k++;
    double gap = d->state.sphere[1].position.x - d->state.sphere[0].position.x - d->state.sphere[0].radius -
                 d->state.sphere[1].radius;
    out.overlap = fmax(out.overlap, -gap);
    out.parted = gap > 0;
  } while (!out.parted && k < most);
  out.time = (double)k * r->model->dt;
  out.restitution = (d->state.pace[1].velocity.x - d->state.pace[0].velocity.x) / v0;
  return out;
}

START_TEST(test_glass_balls) {
  /* [A07] Eq. 2.25-2.31 */
  const spheres glass = {{0.0015, 0.002}, {0.0383e-3, 0.09e-3}, 0.05};
  rig *r = head_on(&glass, "'normal':'hooke','tangential':'none'", "'stiffness':7.36,'damping':8.96e-4", 1e-6);
  const dem_pair *pair = &r->model->pair[0];
  dem_impact printed = {.mass = 2.69e-5, .radius = 1e-3, .speed = 0.05};
  double omega = sqrt(dem_normal_stiffness(r->model, pair, printed, 1e-6) / printed.mass);
  ck_near(omega, 523.07, 0.01);
  ck_near(dem_normal_contact_time(r->model, pair, printed), 0.00601, 5e-6);
  ck_near(dem_normal_restitution(r->model, pair, printed), 0.905, 5e-4);
  dem_impact exact = impact_of(&glass);
  measured m = measure(r, 100000);
  ck_relative(m.restitution, dem_normal_restitution(r->model, pair, exact), 1e-4);
  ck_near(m.time, dem_normal_contact_time(r->model, pair, exact), 2e-6);
  ck_relative(m.overlap, dem_normal_overlap(r->model, pair, exact), 1e-4);
  rig_free(r);
}
END_TEST

typedef struct {
  const char *contact, *pair;
  double restitution; /* 0: what theory.h says */
  bool damped;        /* there is no closed form of time and overlap */
} impact_case;

static const impact_case impacts[] = {
    {"'normal':'hooke'", "'stiffness':2e4,'restitution':0.5", 0.5, false},
    {"'normal':'hooke'", "'stiffness':2e4,'restitution':0.95", 0.95, false},
    {"'normal':'hooke'", "'contact_time':2e-3,'restitution':0.7", 0.7, false},
    {"'normal':'hooke'", "'stiffness':2e4,'damping':5", 0, false},
    {"'normal':'hertz'", "'restitution':1", 1, false},
    {"'normal':'hertz'", "'restitution':0.6", 0.6, true},
    {"'normal':'hertz','tail':'clip'", "'restitution':0.6", 0.6, true},
    {"'normal':'hunt-crossley'", "'restitution':1", 1, false},
    {"'normal':'hunt-crossley','exponent':1", "'stiffness':2e4,'restitution':1", 1, false},
    {"'normal':'hunt-crossley','exponent':2.3", "'stiffness':2e8,'restitution':1", 1, false},
    {"'normal':'hysteretic'", "'stiffness':2e4,'restitution':0.7", 0.7, false},
    {"'normal':'hysteretic'", "'stiffness':2e4,'unloading_stiffness':5e4", 0.63245553203367587, false},
};

START_TEST(test_impacts) {
  const impact_case *c = &impacts[_i];
  char pair[256], contact[256];
  snprintf(pair, sizeof pair, "%s", c->pair);
  snprintf(contact, sizeof contact, "%s,'tangential':'none'", c->contact);
  rig *r = head_on(&usual, contact, pair, 1e-7);
  dem_impact impact = impact_of(&usual);
  const dem_pair *p = &r->model->pair[0];
  double e = dem_normal_restitution(r->model, p, impact);
  if (c->restitution > 0)
    ck_near(e, c->restitution, 1e-9);
  bool plastic = r->model->normal->plastic;
  const dem_data *d = r->data;
  double deepest = 0, v0 = usual.speed, time = 0;
  do { /* the plastic contact ends where its force does */
    rig_steps(r, 1);
    time += r->model->dt;
    deepest = fmax(deepest, d->state.sphere[0].radius + d->state.sphere[1].radius - d->state.sphere[1].position.x +
                                d->state.sphere[0].position.x);
  } while (d->state.ncontact > 0 && (!plastic || d->state.push[0].force.x < 0 || time < 1e-6));
  ck_near((d->state.pace[1].velocity.x - d->state.pace[0].velocity.x) / v0, e, 2e-4);
  if (!c->damped) {
    ck_near(time, dem_normal_contact_time(r->model, p, impact), 4e-7);
    /* first order: the damper's force begins inside a step */
    ck_relative(deepest, dem_normal_overlap(r->model, p, impact), 5e-5);
  }
  rig_free(r);
}
END_TEST

START_TEST(test_contact_time_given) {
  /* whatever the masses */
  for (int k = 0; k < 2; k++) {
    spheres s = usual;
    s.mass[0] *= k ? 50 : 1;
    for (int clip = 0; clip < 2; clip++) {
      rig *r = head_on(
          &s, clip ? "'normal':'hooke','tangential':'none','tail':'clip'" : "'normal':'hooke','tangential':'none'",
          "'contact_time':3e-3,'restitution':0.6", 1e-7);
      ck_relative(dem_normal_contact_time(r->model, &r->model->pair[0], impact_of(&s)), 3e-3, 1e-9);
      ck_near(measure(r, 100000).restitution, 0.6, 2e-4);
      rig_free(r);
    }
  }
}
END_TEST

START_TEST(test_linear_clip) {
  /* the damping is solved for e with the tail cut, beyond critical damping as well */
  static const double es[] = {0.02, 0.1, 0.135335283, 0.3, 0.5, 0.9, 1};
  for (int k = 0; k < 7; k++) {
    char pair[128];
    snprintf(pair, sizeof pair, "'stiffness':2e4,'restitution':%.17g", es[k]);
    rig *r = head_on(&usual, "'normal':'hooke','tangential':'none','tail':'clip'", pair, 2e-7);
    rig_steps(r, 60000);
    ck_near((r->data->state.pace[1].velocity.x - r->data->state.pace[0].velocity.x) / usual.speed, es[k], 2e-4);
    rig_free(r);
  }
  /* critical, [A07] Eq. 2.40: the bodies stay together when the tail is kept */
  rig *r = head_on(&usual, "'normal':'hooke','tangential':'none'", "'stiffness':2e4,'damping':'critical'", 1e-7);
  ck_relative(r->model->pair[0].normal_damping, 2.0, 1e-15);
  ck_assert(isinf(dem_normal_contact_time(r->model, &r->model->pair[0], impact_of(&usual))));
  measured m = measure(r, 100000);
  ck_assert(!m.parted);
  ck_near(m.restitution, 0, 1e-5);
  ck_relative(m.overlap, dem_normal_overlap(r->model, &r->model->pair[0], impact_of(&usual)), 2e-4);
  rig_free(r);
}
END_TEST

START_TEST(test_hunt_crossley) {
  /* X of e, exact; e of X as printed, 3/4 (1 - e^2), for any exponent and speed */
  ck_near(dem_hunt_damping(0.8), 0.37315, 5e-6);
  ck_near(dem_hunt_damping(0.5), 1.43275, 5e-6);
  ck_near(dem_hunt_damping(0.2), 4.9192, 5e-5);
  ck_near(dem_hunt_restitution(0.75 * (1 - 0.25)), 0.725, 5e-4);
  ck_near(dem_hunt_restitution(0.75 * (1 - 0.04)), 0.672, 5e-4);
  static const struct {
    const char *contact, *pair;
    double e;
  } cases[] = {{"", "'restitution':0.5", 0.5},
               {"'exponent':1,", "'restitution':0.5,'stiffness':2e4", 0.5},
               {"'exponent':2,", "'restitution':0.2,'stiffness':2e7", 0.2},
               {"'lambda':'printed',", "'restitution':0.5", 0.7249},
               {"'lambda':'printed','exponent':1,", "'restitution':0.2,'stiffness':2e4", 0.6720}};
  for (int k = 0; k < 5; k++)
    for (int fast = 0; fast < 2; fast++) {
      char contact[128];
      snprintf(contact, sizeof contact, "%s'normal':'hunt-crossley','tangential':'none'", cases[k].contact);
      spheres s = usual;
      s.speed = fast ? 2 : 0.1;
      rig *r = head_on(&s, contact, cases[k].pair, 2e-7);
      measured m = measure(r, 1000000);
      ck_near(m.restitution, cases[k].e, 4e-4);
      ck_near(m.restitution, dem_normal_restitution(r->model, &r->model->pair[0], impact_of(&s)), 3e-4);
      ck_relative(m.overlap, dem_normal_overlap(r->model, &r->model->pair[0], impact_of(&s)), 1e-4);
      rig_free(r);
    }
}
END_TEST

START_TEST(test_hunt_crossley_floor) {
  /* a contact that begins slowly is damped as one at the floor */
  spheres s = usual;
  s.speed = 0.05;
  rig *r = head_on(&s, "'normal':'hunt-crossley','tangential':'none'", "'restitution':0.5,'speed_floor':0.1", 1e-6);
  double e = measure(r, 1000000).restitution;
  ck_near(e, dem_hunt_restitution(0.5 * dem_hunt_damping(0.5)), 3e-4);
  rig_free(r);
}
END_TEST

START_TEST(test_hysteretic_adhesion) {
  static const double slopes[] = {0.1, 0.2}, es[] = {0.44173, 0.37796};
  for (int k = 0; k < 2; k++) {
    char pair[200];
    snprintf(pair, sizeof pair, "'stiffness':1e4,'unloading_stiffness':4e4,'adhesion_stiffness':%g", slopes[k] * 1e4);
    rig *r = head_on(&usual, "'normal':'hysteretic','tangential':'none'", pair, 2e-7);
    ck_near(dem_normal_restitution(r->model, &r->model->pair[0], impact_of(&usual)), es[k], 1e-5);
    ck_near(measure(r, 1000000).restitution, es[k], 1e-4);
    rig_free(r);
  }
  rig *r = head_on(&usual, "'normal':'hysteretic','tangential':'none'",
                   "'stiffness':1e4,'unloading_stiffness':4e4,'adhesion_stiffness':6e3", 1e-6);
  ck_near(dem_normal_restitution(r->model, &r->model->pair[0], impact_of(&usual)), 0, 0);
  ck_assert(!measure(r, 100000).parted);
  rig_free(r);
}
END_TEST

/* force between the spheres at an overlap, histories going on */
static double force_at(rig *r, double overlap) {
  r->data->state.sphere[0].position.x = -r->data->state.sphere[0].radius + overlap;
  forces_now(r->data, false);
  return -r->data->state.push[0].force.x;
}

START_TEST(test_hysteretic_path) {
  const double kl = 1e4, kun = 4e4, kad = 2e3, top = 1e-4, rest = 0.75 * top;
  rig *r = head_on(&usual, "'normal':'hysteretic','tangential':'none'",
                   "'stiffness':1e4,'unloading_stiffness':4e4,'adhesion_stiffness':2e3", 1e-6);
  ck_relative(force_at(r, 0.5 * top), kl * 0.5 * top, 1e-9);
  ck_relative(force_at(r, top), kl * top, 1e-9);
  ck_relative(force_at(r, 0.9 * top), kun * (0.9 * top - rest), 1e-9); /* Eq. 2.41, 2.44 */
  ck_relative(force_at(r, 0.95 * top), kun * (0.95 * top - rest), 1e-9);
  ck_near(force_at(r, rest), 0, 1e-9);
  double tip = 0.75 * kl / (kl + 0.25 * kad) * top; /* Eq. 2.49 */
  ck_relative(force_at(r, 1.0001 * tip), kun * (1.0001 * tip - rest), 1e-6);
  ck_relative(force_at(r, 0.8 * tip), -kad * 0.8 * tip, 1e-9);
  double from = 0.5 * tip;
  ck_relative(force_at(r, from), -kad * from, 1e-9);
  /* reloading from there climbs on the steep slope up to the loading line, and on along that */
  double up = 1e-6;
  ck_relative(force_at(r, from + up), -kad * from + kun * up, 1e-9);
  double zero = from * (1 + kad / kun), meets = zero / 0.75;
  ck_relative(force_at(r, 0.999 * meets), kun * (0.999 * meets - zero), 1e-9);
  ck_relative(force_at(r, 1.2 * meets), kl * 1.2 * meets, 1e-9);
  rig_free(r);
}
END_TEST

START_TEST(test_constant_viscosity) {
  /* [G21] Eq. 3: eta sqrt(R* delta) delta' */
  rig *r = head_on(&usual, "'tangential':'none'", "'viscosity':30", 1e-6);
  double elastic, moving, overlap = 1e-4, R = impact_of(&usual).radius;
  moving = force_at(r, overlap);
  r->data->state.pace[0].velocity.x = 0;
  elastic = force_at(r, overlap);
  ck_relative(elastic, dem_normal_force(r->model, &r->model->pair[0], impact_of(&usual), overlap), 1e-9);
  ck_relative(moving - elastic, 30 * sqrt(R * overlap) * usual.speed, 1e-9);
  rig_free(r);
}
END_TEST

START_TEST(test_settle_overrides) {
  /* restitution and friction of dem.settle, for each normal law */
  static const struct {
    const char *contact, *pair;
    double e;
  } cases[] = {{"'normal':'hooke'", "'stiffness':1e4,'damping':3,'friction':0.5", 0.4},
               {"'normal':'hertz'", "'restitution':0.9,'friction':0.5", 0.4},
               {"'normal':'hunt-crossley'", "'restitution':0.9,'friction':0.5", 0.4},
               {"'normal':'hysteretic'", "'stiffness':1e4,'unloading_stiffness':2e4,'friction':0.5", 0.4}};
  for (int k = 0; k < 4; k++) {
    rig *r = rig_make(scene_json("{'materials':[{'name':'a','density':2500,'young_modulus':1e7,'poisson_ratio':0.3}],"
                                 "'contact':{%s},'pairs':[{'materials':['a','a'],%s}],"
                                 "'settle':{'restitution':0.4,'friction':{'static':0.3,'dynamic':0.2}}}",
                                 cases[k].contact, cases[k].pair),
                      1e-5, 0, NULL);
    const dem_pair *pair = &r->model->settle_pair[0];
    ck_near(dem_normal_restitution(r->model, pair, impact_of(&usual)), cases[k].e, 1e-9);
    ck_near(pair->friction, 0.2, 0);
    ck_near(pair->static_friction, 0.3, 0);
    ck_near(r->model->pair[0].friction, 0.5, 0);
    ck_assert_int_ge(r->model->columns.sliding, 0);
    rig_free(r);
  }
}
END_TEST

TEST_MAIN_ROWS("dem impacts", {test_glass_balls, 1}, {test_impacts, sizeof impacts / sizeof impacts[0]},
               {test_contact_time_given, 1}, {test_linear_clip, 1}, {test_hunt_crossley, 1},
               {test_hunt_crossley_floor, 1}, {test_hysteretic_adhesion, 1}, {test_hysteretic_path, 1},
               {test_constant_viscosity, 1}, {test_settle_overrides, 1})
