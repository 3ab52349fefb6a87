/* Each contact law against its closed form: friction, rolling, adhesion; and sets of laws that are refused.
 * Equations and sources: docs/theory/dem.md. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/contact/law/theory.h"
#include "dem/contact/tangential/spring.h"
#include "tests/test_main.h"

/* ---- a sphere on a floor ---- */

/* radius 10 mm, mass 0.01 kg; g along -z turned by `slope` about y */
static rig *on_floor(const char *contact, const char *pair, double slope, double depth, const char *motion, double dt) {
  return rig_make(scene_json("{'gravity':[%.17g,0,%.17g],'materials':[{'name':'a','density':2500,'young_modulus':1e8,"
                             "'poisson_ratio':0.3}],'pairs':[{'materials':['a','a'],%s}],'contact':{%s},"
                             "'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                             "'particles':[{'type':'list','material':'a','radius':0.01,'mass':0.01,"
                             "'positions':[[0,0,%.17g]],%s}]}",
                             10 * sin(slope), -10 * cos(slope), pair, contact, 0.01 - depth, motion),
                  dt, 0, NULL);
}

START_TEST(test_rolling_from_sliding) {
  /* v ends at 5/7 v0 and omega R as well, with every law of friction and normal law */
  static const char *const laws[][2] = {
      {"'normal':'hooke','tangential':'spring'", "'stiffness':1e5,'restitution':0.3,'friction':0.2"},
      {"'normal':'hooke','tangential':'coulomb'", "'stiffness':1e5,'restitution':0.3,'friction':0.2"},
      {"'normal':'hertz','tangential':'spring'", "'tangential_stiffness':3e4,'restitution':0.3,'friction':0.2"},
      {"'normal':'hunt-crossley','tangential':'mindlin'", "'restitution':0.3,'friction':0.2"},
      {"'normal':'hysteretic','tangential':'spring'", "'stiffness':1e5,'restitution':0.5,'friction':0.2"},
      {"'normal':'hysteretic','tangential':'viscous'", "'stiffness':1e5,'restitution':0.5,'tangential_damping':2"}};
  const char *const *law = laws[_i];
  rig *r = on_floor(law[0], law[1], 0, 1e-6, "'velocity':[0.1,0,0]", 2e-6);
  rig_steps(r, 30000);
  ck_relative(r->data->state.pace[0].velocity.x, 0.1 * 5 / 7, 1e-3);
  ck_relative(r->data->state.pace[0].spin.y * 0.01, 0.1 * 5 / 7, 2e-3);
  rig_free(r);
}
END_TEST

START_TEST(test_coulomb) {
  /* dynamic only: mu F_n against the slip, none at none */
  rig *r = on_floor("'normal':'hooke','tangential':'coulomb'", "'stiffness':1e4,'restitution':0.3,'friction':0.4", 0,
                    1e-5, "'velocity':[0.03,0.04,0]", 1e-6);
  const dem_push *push = &r->data->state.push[0];
  ck_relative(push->force.x, -0.4 * 0.6 * push->force.z, 1e-12);
  ck_relative(push->force.y, -0.4 * 0.8 * push->force.z, 1e-12);
  r->data->state.pace[0].velocity = tdm_v3(0, 0, 0);
  forces_now(r->data, false);
  ck_near(push->force.x, 0, 0);
  rig_free(r);
}
END_TEST

START_TEST(test_viscous) {
  /* [A07] Eq. 2.56, without a limit */
  rig *r = on_floor("'normal':'hooke','tangential':'viscous'",
                    "'stiffness':1e4,'restitution':0.3,'tangential_damping':7", 0, 1e-7, "'velocity':[0.3,0,0]", 1e-6);
  ck_relative(r->data->state.push[0].force.x, -7 * 0.3, 1e-12);
  rig_free(r);
}
END_TEST

START_TEST(test_static_friction) {
  /* held in place and dragged: the spring grows to mu_s F_n, slides at mu_d F_n, sticks again when the drag turns */
  static const char *const laws[][2] = {
      {"'normal':'hooke','tangential':'spring'",
       "'stiffness':1e4,'tangential_damping':0,'tangential_stiffness':1e3,'restitution':1"},
      {"'normal':'hertz','tangential':'mindlin'", "'restitution':1"}};
  for (int k = 0; k < 2; k++) {
    char pair[300];
    snprintf(pair, sizeof pair, "%s,'friction':{'static':0.6,'dynamic':0.4}", laws[k][1]);
    rig *r = on_floor(laws[k][0], pair, 0, 1e-5, "'velocity':[0.02,0,0]", 1e-6);
    const dem_push *push = &r->data->state.push[0];
    double most = 0, press = push->force.z;
    for (int step = 0; step < 6000; step++) {
      dem_forces_again(r->data, false, 1e-6);
      most = fmax(most, -push->force.x);
      if (step > 4000)
        ck_relative(push->force.x, -0.4 * press, 1e-12);
    }
    ck_relative(most, 0.6 * press, 0.02);
    ck_assert_double_le(most, 0.6 * press * (1 + 1e-12));
    r->data->state.pace[0].velocity.x = -0.02;
    double least = 0;
    for (int step = 0; step < 6000; step++) {
      dem_forces_again(r->data, false, 1e-6);
      least = fmax(least, push->force.x);
    }
    ck_relative(least, 0.6 * press, 0.02);
    ck_relative(push->force.x, 0.4 * press, 1e-12);
    rig_free(r);
  }
}
END_TEST

START_TEST(test_rolling_resistance) {
  /* a ball that rolls: M = mu_r R F_n, so a = 5/7 mu_r g, and it stops after v0^2/(2a) */
  static const char *const laws[] = {"constant-torque", "spring-dashpot"};
  const double v0 = 0.05, a = 5.0 / 7 * 0.05 * 10;
  for (int k = 0; k < 2; k++) {
    char contact[200];
    snprintf(contact, sizeof contact, "'normal':'hooke','tangential':'spring','rolling':'%s'", laws[k]);
    rig *r = on_floor(contact,
                      k ? "'stiffness':1e5,'restitution':0.3,'friction':0.5,'rolling_friction':0.05,'rolling_damping':0"
                        : "'stiffness':1e5,'restitution':0.3,'friction':0.5,'rolling_friction':0.05",
                      0, 1e-6, "'velocity':[0.05,0,0],'spin':[0,5,0]", 2e-6);
    rig_steps(r, (long)(1.5 * v0 / a / 2e-6));
    ck_relative(r->data->state.sphere[0].position.x, v0 * v0 / (2 * a), 5e-3);
    if (k == 0) /* the spring without damping rolls it to and fro */
      ck_near(r->data->state.pace[0].velocity.x, 0, 1e-7);
    rig_free(r);
  }
}
END_TEST

START_TEST(test_rolling_on_incline) {
  /* spring-dashpot holds a ball below tan = mu_r; above it rolls with 5/7 (g sin - mu_r g cos) */
  for (int k = 0; k < 2; k++) {
    double slope = atan(k ? 0.15 : 0.09);
    rig *r = on_floor("'normal':'hooke','tangential':'spring','rolling':'spring-dashpot'",
                      "'stiffness':1e4,'restitution':0.3,'friction':0.8,'rolling_friction':0.1", slope, 1e-5,
                      "'velocity':[0,0,0]", 5e-6);
    rig_steps(r, 100000);
    double x = r->data->state.sphere[0].position.x, v = r->data->state.pace[0].velocity.x;
    rig_steps(r, 20000);
    if (k) {
      ck_relative((r->data->state.pace[0].velocity.x - v) / 0.1, 50.0 / 7 * (sin(slope) - 0.1 * cos(slope)), 5e-3);
    } else {
      ck_near(r->data->state.sphere[0].position.x, x, 1e-9);
      ck_near(v, 0, 1e-7);
    }
    rig_free(r);
  }
}
END_TEST

START_TEST(test_twisting) {
  /* a ball that spins on its spot: M = mu_t R F_n, so it stops after 2/5 R w/(mu_t g) */
  rig *r = on_floor("'normal':'hooke','tangential':'spring','twisting':'constant-torque'",
                    "'stiffness':1e4,'restitution':0.3,'friction':0.5,'twisting_friction':0.02", 0, 1e-5,
                    "'spin':[0,0,10]", 5e-6);
  double end = 0.4 * 0.01 * 10 / (0.02 * 10);
  rig_steps(r, (long)(0.5 * end / 5e-6));
  ck_relative(r->data->state.pace[0].spin.z, 5.0, 5e-3);
  rig_steps(r, (long)(0.6 * end / 5e-6));
  ck_near(r->data->state.pace[0].spin.z, 0, 1e-2);
  rig_free(r);
}
END_TEST

/* ---- cohesion ---- */

/* force on the sphere at an overlap with the floor, without damping */
static double lift(rig *r, double overlap) {
  r->data->state.sphere[0].position.z = 0.01 - overlap;
  forces_now(r->data, false);
  return r->data->state.push[0].force.z;
}

START_TEST(test_jkr) {
  const double w = 5, R = 0.01;
  rig *r = on_floor("'tangential':'none','cohesion':'jkr'", "'restitution':1,'adhesion_energy':5", 0, 0,
                    "'velocity':[0,0,0]", 1e-6);
  double young = r->model->pair[0].effective_young, unit = M_PI * w * R, length = cbrt(M_PI * w * R * R / young);
  double depth = length * length / R, reach = dem_jkr_reach(R, young, w);
  ck_relative(reach, 0.75 * depth, 1e-12);
  ck_relative(r->model->reach, reach, 1e-12);
  ck_near(lift(r, -0.2 * depth), 0, 0);                      /* nothing before they touch */
  ck_relative(lift(r, 1e-9 * depth), -4.0 / 3 * unit, 1e-6); /* snap-in */
  /* out: largest pull 3/2 pi w R, the work of all of it 1.0524 pi w L^2, the end at the reach */
  const int n = 20000;
  double most = 0, work = 0, last = lift(r, 0);
  for (int k = 1; k < n; k++) {
    double now = lift(r, -reach * k / n);
    work -= 0.5 * (last + now) * reach / n;
    most = fmax(most, -now);
    last = now;
  }
  ck_relative(most, dem_jkr_pull(R, w), 1e-6);
  ck_relative(last, -5.0 / 6 * unit, 2e-2);
  double s = pow(2, 1.0 / 6), whole = 1.0 / 60 - 1.0 / 6 + 0.25 + 0.6 * M_SQRT2 * s;
  ck_relative(work, whole * unit * depth, 1e-4);
  ck_near(lift(r, -1.001 * reach), 0, 0);
  ck_near(lift(r, -0.9 * reach), 0, 0); /* open, until it touches again */
  /* far inside: Hertz */
  ck_relative(lift(r, 1e-3), 4.0 / 3 * young * sqrt(R) * pow(1e-3, 1.5), 0.1);
  rig_free(r);
}
END_TEST

START_TEST(test_jkr_impact) {
  /* e = 1: what an impact loses is the work of pulling off; too slow, it sticks */
  const double w = 5, R = 0.01, m = 0.01;
  double young = 1e8 / (2 * (1 - 0.09)), length = cbrt(M_PI * w * R * R / young);
  double lost = (1.0 / 60 - 1.0 / 6 + 0.25 + 0.6 * M_SQRT2 * pow(2, 1.0 / 6)) * M_PI * w * length * length;
  double escape = sqrt(2 * lost / m);
  for (int k = 0; k < 2; k++) {
    double v = (k ? 1.2 : 0.95) * escape;
    char motion[100];
    snprintf(motion, sizeof motion, "'velocity':[0,0,%.17g]", -v);
    rig *r =
        on_floor("'tangential':'none','cohesion':'jkr'", "'restitution':1,'adhesion_energy':5", 0, 0, motion, 1e-7);
    r->model->gravity = tdm_v3(0, 0, 0);
    rig_steps(r, 1);
    ck_assert_int_eq(r->data->state.ncontact, 1);
    long steps = 0;
    while (r->data->state.ncontact > 0 && steps++ < 100000)
      rig_steps(r, 1);
    ck_assert_int_eq(r->data->state.ncontact, k ? 0 : 1);
    if (k)
      ck_relative(r->data->state.pace[0].velocity.z, sqrt(v * v - escape * escape), 2e-3);
    rig_free(r);
  }
}
END_TEST

START_TEST(test_dmt) {
  /* Hertz's force less 2 pi w R while they touch; friction goes by Hertz's force */
  const double w = 5, R = 0.01;
  rig *r = on_floor("'tangential':'coulomb','cohesion':'dmt'", "'restitution':1,'friction':0.5,'adhesion_energy':5", 0,
                    1e-4, "'velocity':[0.1,0,0]", 1e-6);
  double hertz = 4.0 / 3 * r->model->pair[0].effective_young * sqrt(R) * pow(1e-4, 1.5), pull = 2 * M_PI * w * R;
  ck_relative(r->data->state.push[0].force.z, hertz - pull, 1e-9);
  ck_relative(r->data->state.push[0].force.x, -0.5 * hertz, 1e-9);
  ck_relative(lift(r, 1e-12), -pull, 1e-6);
  ck_near(lift(r, -1e-9), 0, 0);
  ck_near(r->model->reach, 0, 0);
  rig_free(r);
}
END_TEST

START_TEST(test_sjkr) {
  rig *r = on_floor("'normal':'hooke','tangential':'coulomb','cohesion':'sjkr'",
                    "'stiffness':1e4,'restitution':1,'friction':0.5,'cohesion_density':2e4", 0, 1e-5,
                    "'velocity':[0.1,0,0]", 1e-6);
  double area = 2 * M_PI * 0.01 * 1e-5;
  ck_relative(r->data->state.push[0].force.z, 1e4 * 1e-5 - 2e4 * area, 1e-9);
  ck_relative(r->data->state.push[0].force.x, -0.5 * 1e4 * 1e-5, 1e-9);
  rig_free(r);
}
END_TEST

/* ---- walls that move ---- */

START_TEST(test_wall_work) {
  /* a floor that rises at 0.2 m/s hits a ball at rest without loss: 1/2 m (2 v)^2 is the work of the wall */
  const double dt = 1e-6;
  tdm_assigned_body body = {.name = "floor", .mass = 1e9, .state = state_at(0, 0, 0)};
  body.state.twist.velocity = tdm_v3(0, 0, 0.2);
  rig *r =
      rig_make(scene_json("{'gravity':[0,0,0],'energy':true,'materials':[{'name':'a','density':2500}],"
                          "'pairs':[{'materials':['a','a'],'stiffness':1e4,'restitution':1}],"
                          "'contact':{'normal':'hooke','tangential':'none'},"
                          "'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
                          "'particles':[{'type':'list','material':'a','radius':0.01,'mass':0.01,"
                          "'positions':[[0,0,0.01]]}]}"),
               dt, 1, &body);
  tdm_state now = body.state;
  for (int k = 0; k < 6000; k++) {
    tdm_state next = now;
    next.pose.position.z += dt * 0.2;
    dem_path path = dem_path_make(&now, &next, dt, TDM_LINEAR);
    one_step(r->data, &path, dt);
    now = next;
  }
  ck_assert_int_eq(r->data->state.ncontact, 0);
  ck_relative(r->data->state.pace[0].velocity.z, 0.4, 1e-5);
  ck_relative(r->data->state.energy.wall_work, 0.5 * 0.01 * 0.16, 1e-5);
  for (int k = 0; k < DEM_ENERGIES; k++)
    ck_near(r->data->state.energy.dissipated[k], 0, 1e-8);
  rig_free(r);
}
END_TEST

/* ---- scenes ---- */

static const struct {
  const char *contact, *pair, *path, *says;
} refused[] = {
    {"'normal':'hooke','tangential':'mindlin'", "'stiffness':1,'restitution':1,'friction':0", "dem.contact.tangential",
     "contact circle"},
    {"'normal':'hysteretic','tangential':'mindlin'", "'stiffness':1", "dem.contact.tangential", "\"spring\""},
    {"'normal':'hunt-crossley','exponent':2", "'stiffness':1", "dem.contact.tangential", "exponent"},
    {"'normal':'hunt-crossley'", "'stiffness':1,'restitution':1,'friction':0", "dem.pairs[0].stiffness", "spring"},
    {"'normal':'hooke','cohesion':'jkr'", "'stiffness':1", "dem.contact.cohesion", "Hertz"},
    {"'cohesion':'jkr','tail':'clip'", "'restitution':1", "dem.contact.tail", "jkr"},
    {"'normal':'hysteretic','tail':'clip'", "'stiffness':1", "dem.contact.tail", "adhesion_stiffness"},
    {"'exponent':2", "'restitution':1,'friction':0", "dem.contact.exponent", "hunt-crossley"},
    {"'lambda':'exact'", "'restitution':1,'friction':0", "dem.contact.lambda", "hunt-crossley"},
    {"'normal':'hunt-crossley','tail':'clip'", "'restitution':1,'friction':0", "dem.contact.tail", "does not attract"},
    {"'tangential':'none'", "'restitution':1,'friction':0.3", "dem.pairs[0].friction", "none of the scene's laws"},
    {"'tangential':'viscous'", "'restitution':1,'tangential_damping':1,'friction':0.3", "dem.pairs[0].friction",
     "none of the scene's laws"},
    {"'normal':'hooke'", "'restitution':1,'friction':0", "dem.pairs[0].stiffness", "normal \"hooke\" needs it"},
    {"'normal':'hooke'", "'stiffness':1,'friction':0", "dem.pairs[0].restitution", "missing"},
    {"'normal':'hooke'", "'stiffness':1,'contact_time':1,'restitution':1", "dem.pairs[0].contact_time", "excludes"},
    {"'normal':'hooke'", "'stiffness':1,'damping':1,'restitution':1", "dem.pairs[0].damping", "excludes"},
    {"'normal':'hooke'", "'contact_time':1,'damping':1,'friction':0", "dem.pairs[0].damping", "contact_time"},
    {"'normal':'hysteretic'", "'stiffness':2,'unloading_stiffness':1,'friction':0", "dem.pairs[0].unloading_stiffness",
     "at least"},
    {"'tangential':'spring'", "'restitution':1,'friction':0", "dem.pairs[0].tangential_stiffness", "spring"},
    {"'tangential':'viscous'", "'restitution':1", "dem.pairs[0].tangential_damping", "viscous"},
    {"'rolling':'spring-dashpot'", "'restitution':1,'friction':0", "dem.pairs[0].rolling_friction", "spring-dashpot"},
    {"'cohesion':'sjkr'", "'restitution':1,'friction':0", "dem.pairs[0].cohesion_density", "sjkr"},
    {"", "'restitution':1,'friction':0,'stiffness':5", "dem.pairs[0].stiffness", "none of the scene's laws"},
    {"", "'restitution':1,'friction':{'static':0.1,'dynamic':0.2}", "dem.pairs[0].friction.static", "at least"},
    {"'tangential':'coulomb'", "'restitution':1,'friction':{'static':0.3,'dynamic':0.2}",
     "dem.pairs[0].friction.static", "never sticks"},
    {"'rolling':'epsd'", "'restitution':1,'friction':0", "dem.contact.rolling", "spring-dashpot"},
};

START_TEST(test_refused) {
  json_t *json = scene_json("{'materials':[{'name':'a','density':1,'young_modulus':1e6,'poisson_ratio':0}],"
                            "'contact':{%s},'pairs':[{'materials':['a','a'],%s}]}",
                            refused[_i].contact, refused[_i].pair);
  tdm_error err = rig_refused(json, NULL);
  ck_assert_str_eq(err.path, refused[_i].path);
  ck_assert_msg(strstr(err.message, refused[_i].says) != NULL, "%s: %s", err.path, err.message);
}
END_TEST

START_TEST(test_no_elastic_constants) {
  /* linear laws do without Young's modulus; all contact limits of the step are theirs */
  json_t *json = scene_json("{'materials':[{'name':'a','density':1000}],'contact':{'normal':'hooke'},"
                            "'pairs':[{'materials':['a','a'],'stiffness':100,'restitution':0.5,'friction':0.1}],"
                            "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0]]}]}");
  rig *r = rig_make(json, 1e-4, 0, NULL);
  ck_assert_str_eq(r->model->tangential->head.name, "spring");
  ck_relative(r->model->pair[0].tangential[DEM_SPRING_STIFFNESS], 200.0 / 7, 1e-12);
  rig_free(r);
}
END_TEST

TEST_MAIN_ROWS("dem laws", {test_coulomb, 1}, {test_viscous, 1}, {test_static_friction, 1},
               {test_rolling_resistance, 1}, {test_rolling_on_incline, 1}, {test_twisting, 1}, {test_jkr, 1},
               {test_jkr_impact, 1}, {test_dmt, 1}, {test_sjkr, 1}, {test_wall_work, 1}, {test_no_elastic_constants, 1},
               {test_rolling_from_sliding, 6}, {test_refused, sizeof refused / sizeof refused[0]})
