/* Contact laws of all families but the normal one that are added from outside: all of each is in this file.
 *
 *   tangential "bond"     a spring without friction or limit, F = -k ξ
 *   rolling "oil"         a couple against the rolling spin, M = -c w
 *   twisting "oil"        likewise about the normal
 *   twisting "coil"       a spring without a limit, M = -k θ
 *   cohesion "gum"        a constant pull f, over the gap d too once the contact has touched
 * Then every law of the sources, called as one from outside: its results are the same, bit for bit.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define DEM_SIMD 0 /* laws from outside are in plain C */
#include "dem/contact/families.h"
#include "dem/contact/table.h"

#include "dem/watch/energy_balance.h"
#include "test_dem_support.h"

#include "tests/test_main.h"

/* ---- tangential ---- */

enum { BOND_STIFFNESS }; /* k [N/m] */

/* as sticking.h: the history is the force in the middle of the coming step */
static void bond(dem_call *call) {
  dem_contact *c = &call->contact;
  vd *history = call->history, k = DEM_OF(c, tangential[BOND_STIFFNESS]);
  vd3 grow = vd3_scale(-(k * vd_set(0.5 * c->dt)), c->slip);
  vd3 f = vd3_add(dem_turn_history(c, (vd3){history[0], history[1], history[2]}), grow);
  vd3 next = vd3_add(f, grow);
  history[0] = next.x, history[1] = next.y, history[2] = next.z;
  call->tangential = (dem_tangential){f, vd_set(0.5) * vd3_dot(f, f) / k};
}

static void read_bond(const dem_model *m, tdm_object *o, dem_pair *p) {
  (void)m;
  p->tangential[BOND_STIFFNESS] = dem_need(o, "bond", "tangential", "bond", TDM_POSITIVE);
}

static const dem_tangential_law bond_row = {
    .head = {.name = "bond", .ncolumn = 3, .vectors = 7, .keys = {{.name = "bond", .example = 3e3}}, .kernel = bond},
    .read = read_bond};

/* ---- rolling and twisting ---- */

enum { OIL }; /* c [N m s] */

static void rolling_oil(dem_call *call) {
  call->couple = (dem_couple){vd3_scale(-DEM_OF(&call->contact, rolling[OIL]), call->spin), vd_set(0)};
}

static void read_rolling_oil(const dem_model *m, tdm_object *o, dem_pair *p) {
  (void)m;
  p->rolling[OIL] = dem_need(o, "rolling_oil", "rolling", "oil", TDM_NOT_NEGATIVE);
}

static const dem_rolling_law rolling_row = {
    .head = {.name = "oil", .keys = {{.name = "rolling_oil", .example = 1e-6}}, .kernel = rolling_oil},
    .read = read_rolling_oil};

static void twisting_oil(dem_call *call) {
  call->couple = (dem_couple){vd3_scale(-DEM_OF(&call->contact, twisting[OIL]), call->spin), vd_set(0)};
}

static void read_twisting_oil(const dem_model *m, tdm_object *o, dem_pair *p) {
  (void)m;
  p->twisting[OIL] = dem_need(o, "twisting_oil", "twisting", "oil", TDM_NOT_NEGATIVE);
}

static const dem_twisting_law twisting_row = {
    .head = {.name = "oil", .keys = {{.name = "twisting_oil", .example = 1e-6}}, .kernel = twisting_oil},
    .read = read_twisting_oil};

enum { COIL }; /* k [N m] */

/* history: the couple about the normal in the middle of the coming step, in one column */
static void coil(dem_call *call) {
  dem_contact *c = &call->contact;
  vd k = DEM_OF(c, twisting[COIL]), grow = -(k * vd_set(0.5 * c->dt)) * vd3_dot(call->spin, c->normal);
  vd couple = call->history[0] + grow;
  call->history[0] = couple + grow;
  call->couple = (dem_couple){vd3_scale(couple, c->normal), vd_set(0.5) * couple * couple / k};
}

static void read_coil(const dem_model *m, tdm_object *o, dem_pair *p) {
  (void)m;
  p->twisting[COIL] = dem_need(o, "coil", "twisting", "coil", TDM_POSITIVE);
}

static double coil_stiffness(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  (void)m, (void)i, (void)overlap;
  return p->twisting[COIL];
}

static const dem_twisting_law coil_row = {
    .head = {.name = "coil", .ncolumn = 1, .keys = {{.name = "coil", .example = 1e-3}}, .kernel = coil},
    .read = read_coil,
    .stiffness = coil_stiffness};

/* remembers more than there is room for */
static const dem_twisting_law diary_row = {.head = {.name = "diary", .ncolumn = DEM_HISTORY_MAX + 1, .kernel = coil}};

/* ---- cohesion ---- */

enum { GUM_PULL, GUM_GAP }; /* f [N], d [m] */

/* history: 1 while the contact holds */
static void gum(dem_call *call) {
  dem_contact *c = &call->contact;
  vd gap = DEM_OF(c, cohesion[GUM_GAP]), pull = DEM_OF(c, cohesion[GUM_PULL]);
  vm pressed = vm_less(vd_set(0), c->overlap), holds = vm_less(vd_set(0), call->history[0]);
  c->touching = vm_and(c->touching, vm_or(pressed, holds));
  call->history[0] = vd_set(1);
  c->force = vd_only(pressed, c->force);
  c->pull = -pull;
  c->elastic = vd_only(pressed, c->elastic) - pull * (c->overlap + gap);
}

static void read_gum(const dem_model *m, tdm_object *o, dem_pair *p) {
  (void)m;
  p->cohesion[GUM_PULL] = dem_need(o, "gum_pull", "cohesion", "gum", TDM_NOT_NEGATIVE);
  p->cohesion[GUM_GAP] = dem_need(o, "gum_gap", "cohesion", "gum", TDM_NOT_NEGATIVE);
}

static double gum_reach(const dem_pair *p, double radius) {
  (void)radius;
  return p->cohesion[GUM_GAP];
}

static const dem_cohesion_law gum_row = {
    .head = {.name = "gum",
             .ncolumn = 1,
             .keys = {{.name = "gum_pull", .example = 1e-3}, {.name = "gum_gap", .example = 1e-4}},
             .kernel = gum},
    .read = read_gum,
    .reach = gum_reach};

static void add(dem_family family, const dem_law_head *law) {
  if (dem_law_place(family, law->name) < 0)
    ck_assert_int_eq(dem_law_add(family, law, NULL), TDM_OK);
  ck_assert_int_eq(dem_law_add(family, law, NULL), TDM_ERR_ARGUMENT); /* a name is there once */
}

static void add_all(void) {
  add(DEM_FAMILY_TANGENTIAL, &bond_row.head);
  add(DEM_FAMILY_ROLLING, &rolling_row.head);
  add(DEM_FAMILY_TWISTING, &twisting_row.head);
  add(DEM_FAMILY_TWISTING, &coil_row.head);
  add(DEM_FAMILY_TWISTING, &diary_row.head);
  add(DEM_FAMILY_COHESION, &gum_row.head);
}

/* ---- what they do ---- */

static const double stiffness = 1e5, radius = 0.01; /* as in PAIR and ON_FLOOR */
#define PAIR                                   \
  "'materials':[{'name':'a','density':2500}]," \
  "'pairs':[{'materials':['a','a'],'stiffness':1e5,'restitution':1%s}],'contact':{'normal':'hooke'%s},"
#define ON_FLOOR                                                                         \
  "{'gravity':[0,0,-10],'energy':true," PAIR                                             \
  "'bodies':[{'name':'floor','material':'a','shapes':[{'type':'plane','normal':[0,0,1]," \
  "'point':[0,0,0]}]}],'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[0,0,%.17g]]}]}"

/* a sphere at rest on the floor: its weight presses */
static rig *on_floor(const char *pair, const char *laws) {
  double mass = 2500 * 4.0 / 3 * M_PI * radius * radius * radius;
  add_all();
  return rig_make(scene_json(ON_FLOOR, pair, laws, radius - mass * 10 / stiffness), 1e-6, 0, NULL);
}

/* A bond at the foot of a sphere that may turn: 1/m + r²/I = 7/(2m), so its slip has the frequency sqrt(7k/(2m)), and
 * half a period later the slip is the opposite. */
START_TEST(test_bond) {
  rig *r = on_floor(",'bond':2e4", ",'tangential':'bond','rolling':'none'");
  dem_data *d = r->data;
  double m = d->state.mass[0], half = M_PI / sqrt(3.5 * 2e4 / m);
  d->state.pace[0].velocity.x = 0.01;
  d->state.restart = true;
  double before = 0.01, now = before, most = 0;
  for (long step = 0; step < lround(half / r->model->dt); step++) {
    rig_steps(r, 1);
    now = d->state.pace[0].velocity.x - radius * d->state.pace[0].spin.y;
    most = fmax(most, fabs(d->state.push[0].force.x));
  }
  ck_near(now, -before, 3e-4 * before); /* the arm is the radius less the overlap */
  ck_relative(most, before * sqrt(2e4 * m / 3.5), 1e-3);
  rig_free(r);
}
END_TEST

/* Both spins die out as exp(-c t/I), each with its own c, also beside a law of the sources. */
START_TEST(test_oil) {
  rig *r = on_floor(_i ? ",'rolling_oil':1e-6,'twisting_friction':0" : ",'rolling_oil':1e-6,'twisting_oil':3e-6",
                    _i ? ",'tangential':'none','rolling':'oil','twisting':'constant-torque'"
                       : ",'tangential':'none','rolling':'oil','twisting':'oil'");
  dem_data *d = r->data;
  double inertia = 0.4 * d->state.mass[0] * radius * radius, t = 2e4 * r->model->dt;
  d->state.pace[0].spin = tdm_v3(3, -4, 5);
  d->state.restart = true;
  rig_steps(r, 20000);
  double rolls = exp(-1e-6 * t / inertia), twists = _i ? 1 : exp(-3e-6 * t / inertia);
  ck_vector(d->state.pace[0].spin, tdm_v3(3 * rolls, -4 * rolls, 5 * twists), 1e-4);
  rig_free(r);
}
END_TEST

/* The spin about the normal swings with sqrt(k/I), whatever the other laws remember: the tangential spring, the rolling
 * one, and a sliding contact. Energy goes to the spring, all of it, and comes back: as the balance finds it in the
 * present state, and as the contacts add it up. */
static const struct {
  const char *pair, *laws;
  int column; /* of the twisting law's history */
} coils[] = {
    {",'coil':1e-3", ",'tangential':'none','twisting':'coil'", 0},
    {",'coil':1e-3,'friction':{'static':0.5,'dynamic':0.3},'rolling_friction':0.1",
     ",'tangential':'spring','rolling':'spring-dashpot','twisting':'coil'", 6},
    {",'coil':1e-3,'bond':2e4,'gum_pull':0,'gum_gap':1e-4", ",'tangential':'bond','twisting':'coil','cohesion':'gum'",
     3},
};

START_TEST(test_coil) {
  rig *r = on_floor(coils[_i].pair, coils[_i].laws);
  dem_data *d = r->data;
  ck_assert_int_eq(r->model->columns.twisting, coils[_i].column);
  double inertia = 0.4 * d->state.mass[0] * radius * radius, omega = sqrt(1e-3 / inertia);
  long quarter = lround(0.5 * M_PI / omega / r->model->dt);
  d->state.pace[0].spin = tdm_v3(0, 0, 5);
  d->state.restart = true;
  dem_stored_energy rest = dem_stored_energy_now(d);
  double swing = 0.5 * inertia * 25;
  rig_steps(r, quarter);
  dem_stored_energy wound = dem_stored_energy_now(d);
  ck_near(d->state.pace[0].spin.z, 0, 5e-3);
  ck_relative(wound.elastic - rest.elastic, swing, 1e-3);
  ck_relative(dem_energy_elastic(&d->state.energy), wound.elastic, 1e-6);
  rig_steps(r, quarter);
  ck_near(d->state.pace[0].spin.z, -5, 5e-3);
  rig_free(r);
}
END_TEST

/* Two spheres that meet: no pull before they touch, then one up to the gap d. It takes the energy f d, which energies
 * find as lost in the normal direction. */
START_TEST(test_gum) {
  const double f = 20, gap = 1e-4, speed = 0.5;
  add_all();
  rig *r = rig_make(scene_json("{'gravity':[0,0,0],'energy':true," PAIR
                               "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[-0.011,0,0]],"
                               "'velocity':[0.5,0,0]},{'type':'list','material':'a','radius':0.01,"
                               "'positions':[[0.011,0,0]],'velocity':[-0.5,0,0]}]}",
                               ",'gum_pull':20,'gum_gap':1e-4", ",'tangential':'none','cohesion':'gum'"),
                    1e-7, 0, NULL);
  dem_data *d = r->data;
  double m = d->state.mass[0];
  bool touched = false;
  for (int step = 0; step < 100000 && (!touched || d->state.ncontact > 0); step++) {
    rig_steps(r, 1);
    touched = touched || d->state.ncontact > 0;
    if (!touched)
      ck_assert(d->state.pace[0].velocity.x == speed);
  }
  ck_assert(touched && d->state.ncontact == 0);
  ck_relative(m * (speed * speed - d->state.pace[1].velocity.x * d->state.pace[1].velocity.x), f * gap, 1e-3);
  ck_relative(d->state.energy.dissipated[DEM_ENERGY_NORMAL], f * gap, 1e-3);
  rig_free(r);
}
END_TEST

/* ---- laws of the sources, called ---- */

#define TANGENTIAL(law)                                            \
  static void call_tangential_##law(dem_call *c) {                 \
    c->tangential = dem_tangential_##law(&c->contact, c->history); \
  }
#define ROLLING(law)                                                 \
  static void call_rolling_##law(dem_call *c) {                      \
    c->couple = dem_rolling_##law(&c->contact, c->spin, c->history); \
  }
#define TWISTING(law)                                                 \
  static void call_twisting_##law(dem_call *c) {                      \
    c->couple = dem_twisting_##law(&c->contact, c->spin, c->history); \
  }
#define COHESION(law)                            \
  static void call_cohesion_##law(dem_call *c) { \
    dem_cohesion_##law(&c->contact, c->history); \
  }
DEM_TANGENTIALS(TANGENTIAL)
DEM_ROLLINGS(ROLLING)
DEM_TWISTINGS(TWISTING)
DEM_COHESIONS(COHESION)
#undef TANGENTIAL
#undef ROLLING
#undef TWISTING
#undef COHESION

/* in the order of the tables */
#define TANGENTIAL(law) call_tangential_##law,
#define ROLLING(law) call_rolling_##law,
#define TWISTING(law) call_twisting_##law,
#define COHESION(law) call_cohesion_##law,
static dem_called_kernel *const kernels[DEM_FAMILIES][8] = {
    [DEM_FAMILY_TANGENTIAL] = {DEM_TANGENTIALS(TANGENTIAL)},
    [DEM_FAMILY_ROLLING] = {DEM_ROLLINGS(ROLLING)},
    [DEM_FAMILY_TWISTING] = {DEM_TWISTINGS(TWISTING)},
    [DEM_FAMILY_COHESION] = {DEM_COHESIONS(COHESION)},
};

/* Add a law of the sources once more, as "NAME again". */
static void add_again(dem_family family, const char *name) {
  static union {
    dem_law_head head;
    dem_tangential_law tangential;
    dem_rolling_law rolling;
    dem_twisting_law twisting;
    dem_cohesion_law cohesion;
  } rows[16];
  static char names[16][40];
  static int n;
  static const size_t sizes[DEM_FAMILIES] = {[DEM_FAMILY_TANGENTIAL] = sizeof(dem_tangential_law),
                                             [DEM_FAMILY_ROLLING] = sizeof(dem_rolling_law),
                                             [DEM_FAMILY_TWISTING] = sizeof(dem_twisting_law),
                                             [DEM_FAMILY_COHESION] = sizeof(dem_cohesion_law)};
  int place = dem_law_place(family, name);
  snprintf(names[n], sizeof names[n], "%s again", name);
  if (dem_law_place(family, names[n]) >= 0)
    return;
  memcpy(&rows[n], dem_law_at(family, place), sizes[family]);
  rows[n].head.name = names[n];
  rows[n].head.kernel = kernels[family][place];
  add(family, &rows[n++].head);
}

/* a shaken box of spheres of two sizes, in several chunks */
static rig *crowd(const char *tangential, const char *rolling, const char *twisting, const char *cohesion,
                  int threads) {
  rig *r = rig_make(
      scene_json("{'gravity':[0,0,-10],'energy':true,'threads':%d,'materials':[{'name':'a','density':2500,"
                 "'young_modulus':1e7,'poisson_ratio':0.3}],'pairs':[{'materials':['a','a'],'restitution':0.7,"
                 "'friction':{'static':0.5,'dynamic':0.3},'rolling_friction':0.1,'twisting_friction':0.05,"
                 "'adhesion_energy':0.5}],'contact':{'normal':'hertz','tangential':'%s','rolling':'%s','twisting':'%s',"
                 "'cohesion':'%s'},'bodies':[{'name':'box','material':'a','shapes':[{'type':'box','side':'inside',"
                 "'size':[0.3,0.3,0.3],'center':[0.14,0.14,0.14]}]}],'particles':[{'type':'block','material':'a',"
                 "'radius':[0.008,0.01],'count':[14,14,14],'corner':[0,0,0],'spacing':0.0201}]}",
                 threads, tangential, rolling, twisting, cohesion),
      5e-6, 0, NULL);
  for (int i = 0; i < r->data->state.nparticle; i++) {
    r->data->state.pace[i].velocity = tdm_v3(sin(3.0 * i), cos(5.0 * i), sin(7.0 * i));
    r->data->state.pace[i].spin = tdm_v3(9 * sin(5.0 * i), 9 * cos(2.0 * i), 9 * sin(4.0 * i));
  }
  r->data->state.restart = true;
  return r;
}

START_TEST(test_again) {
  static const struct {
    const char *law[DEM_FAMILIES]; /* by family */
    unsigned again;                /* bit f: this one is called */
  } cases[] = {
      {{NULL, "mindlin", "spring-dashpot", "constant-torque", "jkr"}, 1U << DEM_FAMILY_TANGENTIAL},
      {{NULL, "mindlin", "spring-dashpot", "constant-torque", "jkr"}, 1U << DEM_FAMILY_ROLLING},
      {{NULL, "mindlin", "spring-dashpot", "constant-torque", "jkr"}, 1U << DEM_FAMILY_TWISTING},
      {{NULL, "mindlin", "spring-dashpot", "constant-torque", "jkr"}, 1U << DEM_FAMILY_COHESION},
      {{NULL, "mindlin", "constant-torque", "constant-torque", "dmt"}, ~1U},
  };
  const char *as_it_is[DEM_FAMILIES], *again[DEM_FAMILIES];
  char name[DEM_FAMILIES][40];
  for (dem_family f = DEM_FAMILY_TANGENTIAL; f <= DEM_FAMILY_COHESION; f++) { /* those that are called */
    as_it_is[f] = again[f] = cases[_i].law[f];
    if (!(cases[_i].again >> f & 1))
      continue;
    add_again(f, as_it_is[f]);
    snprintf(name[f], sizeof name[f], "%s again", as_it_is[f]);
    again[f] = name[f];
  }
  rig *r = crowd(as_it_is[1], as_it_is[2], as_it_is[3], as_it_is[4], 1);
  rig *called = crowd(again[1], again[2], again[3], again[4], 2);
  rig_steps(r, 150);
  rig_steps(called, 150);
  size_t n = (size_t)r->data->state.nparticle;
  ck_assert_int_gt(r->data->state.ncontact, 300);
  ck_assert_mem_eq(r->data->state.sphere, called->data->state.sphere, n * sizeof *r->data->state.sphere);
  ck_assert_mem_eq(r->data->state.rotor, called->data->state.rotor, n * sizeof *r->data->state.rotor);
  ck_assert_mem_eq(&r->data->state.energy, &called->data->state.energy, sizeof r->data->state.energy);
  rig_free(called);
  rig_free(r);
}
END_TEST

/* A law's own coefficients: they must be there, and other laws refuse them by name. */
START_TEST(test_reading) {
  static const struct {
    const char *pair, *laws, *says;
  } cases[] = {
      {"", ",'tangential':'bond'", "(tangential \"bond\" needs it)"},
      {",'rolling_oil':-1", ",'tangential':'none','rolling':'oil'", "rolling_oil"},
      {",'gum_pull':1", ",'tangential':'none','cohesion':'gum'", "(cohesion \"gum\" needs it)"},
      {",'twisting_oil':1", ",'tangential':'none'", "none of the scene's laws"},
      {"", ",'tangential':'none','twisting':'honey'", "\"oil\""},
      {"", ",'tangential':'none','twisting':'diary'", "has 11 numbers a contact, more than the 10"},
  };
  add_all();
  tdm_error err = rig_refused(scene_json(ON_FLOOR, cases[_i].pair, cases[_i].laws, 0.01), NULL);
  ck_assert_msg(strstr(err.message, cases[_i].says) || strstr(err.path, cases[_i].says), "%s: %s", err.path,
                err.message);
}
END_TEST

TEST_MAIN_ROWS("seam: contact laws of all families", {test_bond, 1}, {test_oil, 2}, {test_coil, 3}, {test_gum, 1},
               {test_again, 5}, {test_reading, 6})
