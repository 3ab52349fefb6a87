/* All sets of contact laws together: the energy balance of a closed box, momentum and angular momentum, the same bits
 * on all instruction sets, and histories that turn round with their pair. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/contact/law/law.h"
#include "dem/particles/create.h"
#include "dem/particles/field.h"
#include "dem/search/search.h"
#include "dem/store/state_file.h"
#include "dem/watch/energy_balance.h"
#include "tests/test_main.h"

/* ---- every set of laws ---- */

enum { HOOKE, HERTZ, HUNT_CROSSLEY, HYSTERETIC, NORMALS };
enum { SLIPPERY, COULOMB, VISCOUS, SPRING, MINDLIN, TANGENTIALS };
enum { FREE, CONSTANT_TORQUE, SPRING_DASHPOT, ROLLINGS };
enum { TWISTINGS = 2 };
enum { DRY, SJKR, JKR, DMT, COHESIONS };

/* To try a new law with all others: its name here, its coefficients in pair_of. */
static const char *const names[DEM_FAMILIES][8] = {
    [DEM_FAMILY_NORMAL] = {"hooke", "hertz", "hunt-crossley", "hysteretic"},
    [DEM_FAMILY_TANGENTIAL] = {"none", "coulomb", "viscous", "spring", "mindlin"},
    [DEM_FAMILY_ROLLING] = {"none", "constant-torque", "spring-dashpot"},
    [DEM_FAMILY_TWISTING] = {"none", "constant-torque"},
    [DEM_FAMILY_COHESION] = {"none", "sjkr", "jkr", "dmt"}};

typedef struct {
  int normal, tangential, rolling, twisting, cohesion;
} laws;

static const laws rows[] = {
#define WITH_ALL(n)                                              \
  {.normal = n}, {n, COULOMB, 0, 0, 0}, {n, VISCOUS, 0, 0, 0}, { \
    n, SPRING, 0, 0, 0                                           \
  }
    WITH_ALL(HOOKE),
    WITH_ALL(HERTZ),
    {HERTZ, MINDLIN, 0, 0, 0},
    WITH_ALL(HUNT_CROSSLEY),
    {HUNT_CROSSLEY, MINDLIN, 0, 0, 0},
    WITH_ALL(HYSTERETIC)};
enum { NROW = sizeof rows / sizeof rows[0], NMORE = ROLLINGS * TWISTINGS * COHESIONS };

/* number k < NROW * NMORE; false: jkr or dmt without hertz */
static bool pick(laws *l, int k) {
  *l = rows[k / NMORE];
  int rest = k % NMORE;
  l->rolling = rest % ROLLINGS;
  l->twisting = rest / ROLLINGS % TWISTINGS;
  l->cohesion = rest / ROLLINGS / TWISTINGS;
  return l->cohesion < JKR || l->normal == HERTZ;
}

static const char *name_of(const laws *l) {
  static char name[128];
  snprintf(name, sizeof name, "%s/%s/%s/%s/%s", names[DEM_FAMILY_NORMAL][l->normal],
           names[DEM_FAMILY_TANGENTIAL][l->tangential], names[DEM_FAMILY_ROLLING][l->rolling],
           names[DEM_FAMILY_TWISTING][l->twisting], names[DEM_FAMILY_COHESION][l->cohesion]);
  return name;
}

static const char *pair_of(const laws *l) {
  static char pair[512];
  static const char *const normal[] = {"'stiffness':2000,'restitution':0.7", "'restitution':0.7", "'restitution':0.7",
                                       "'stiffness':2000,'unloading_stiffness':4000,'adhesion_stiffness':200"};
  static const char *const tangential[] = {"", ",'friction':0.4", ",'tangential_damping':0.05",
                                           ",'friction':{'static':0.5,'dynamic':0.4},'tangential_stiffness':600",
                                           ",'friction':0.4"};
  static const char *const rolling[] = {"", ",'rolling_friction':0.1", ",'rolling_friction':0.1,'rolling_damping':0.2"};
  static const char *const twisting[] = {"", ",'twisting_friction':0.05"};
  static const char *const cohesion[] = {"", ",'cohesion_density':5e3", ",'adhesion_energy':0.05",
                                         ",'adhesion_energy':0.05"};
  snprintf(pair, sizeof pair, "%s%s%s%s%s", normal[l->normal], tangential[l->tangential], rolling[l->rolling],
           twisting[l->twisting], cohesion[l->cohesion]);
  return pair;
}

/* Eleven spheres of two sizes, five of them in a heap with spins; `walls`: in a closed box of 60 mm, with gravity. */
static rig *scene_of(const laws *l, bool walls, bool energy, const char *simd, double dt) {
  return rig_make(
      scene_json(
          "{'gravity':[0,0,%g],'energy':%s,'simd':'%s','skin':0.002,"
          "'materials':[{'name':'a','density':2500,'young_modulus':2e6,'poisson_ratio':0.3}],"
          "'pairs':[{'materials':['a','a'],%s}],"
          "'contact':{'normal':'%s','tangential':'%s','rolling':'%s','twisting':'%s','cohesion':'%s'},"
          "'bodies':[%s],'particles':["
          "{'type':'list','material':'a','radius':0.005,'positions':[[0.001,0,-0.0245],[0.0105,0.001,-0.024]],"
          " 'velocity':[0.2,0.1,-0.1],'spin':[10,-20,30]},"
          "{'type':'list','material':'a','radius':0.007,'positions':[[0.006,0.002,-0.0125],[-0.012,0.003,-0.018]],"
          " 'velocity':[-0.3,0.05,-0.2],'spin':[-5,8,-12]},"
          "{'type':'list','material':'a','radius':0.005,'positions':[[0.005,0.0125,-0.0128]],"
          " 'velocity':[0.1,-0.4,0],'spin':[0,0,40]}]}",
          walls ? -9.81 : 0.0, energy ? "true" : "false", simd, pair_of(l), names[DEM_FAMILY_NORMAL][l->normal],
          names[DEM_FAMILY_TANGENTIAL][l->tangential], names[DEM_FAMILY_ROLLING][l->rolling],
          names[DEM_FAMILY_TWISTING][l->twisting], names[DEM_FAMILY_COHESION][l->cohesion],
          walls ? "{'name':'box','material':'a','shapes':[{'type':'box','size':[0.06,0.06,0.06],'side':'inside'}]}"
                : ""),
      dt, 0, NULL);
}

/* ---- energy ---- */

static double total_energy(const dem_data *d) {
  double e = dem_energy_elastic(&d->state.energy) - d->state.energy.wall_work - d->state.energy.supplied;
  for (int k = 0; k < DEM_ENERGIES; k++)
    e += d->state.energy.dissipated[k];
  for (int i = 0; i < d->state.nparticle; i++) {
    double m = d->state.mass[i], inertia = 0.4 * m * d->state.sphere[i].radius * d->state.sphere[i].radius;
    e += 0.5 * m * tdm_dot(d->state.pace[i].velocity, d->state.pace[i].velocity) +
         0.5 * inertia * tdm_dot(d->state.pace[i].spin, d->state.pace[i].spin) -
         m * tdm_dot(dem_field(d, i), d->state.sphere[i].position);
  }
  return e;
}

static double mechanical(const dem_data *d, const double low) {
  double e = 0;
  for (int i = 0; i < d->state.nparticle; i++)
    e += d->state.mass[i] * (0.5 * tdm_dot(d->state.pace[i].velocity, d->state.pace[i].velocity) +
                             9.81 * (d->state.sphere[i].position.z - low));
  return e;
}

/* largest change of the total over 30 ms, as a share of what can be lost at the start */
static double imbalance(const laws *l, double dt) {
  rig *r = scene_of(l, true, true, "plain", dt);
  double start = total_energy(r->data), scale = mechanical(r->data, -0.025), worst = 0;
  for (int k = 0; k < 10; k++) {
    rig_steps(r, (long)(0.003 / dt + 0.5));
    worst = fmax(worst, fabs(total_energy(r->data) - start));
  }
  rig_free(r);
  return worst / scale;
}

START_TEST(test_energy) {
  laws l = rows[_i];
  static const int more[][3] = {{0, 0, 0}, {1, 1, 1}, {2, 0, 2}};
  for (int k = 0; k < 3; k++) {
    l.rolling = more[k][0], l.twisting = more[k][1], l.cohesion = more[k][2];
    if (l.cohesion == JKR && l.normal != HERTZ)
      l.cohesion = DRY;
    /* second order; nearly first where a contact without a spring stops: coulomb, constant torque */
    double coarse = imbalance(&l, 4e-6), fine = imbalance(&l, 1e-6);
    bool stops = l.tangential == COULOMB || l.rolling == CONSTANT_TORQUE;
    double falls = stops ? 2.5 : 12;
    ck_assert_msg(coarse < 1e-3, "%s: %g", name_of(&l), coarse);
    ck_assert_msg(fine < coarse / falls, "%s: %g, %g", name_of(&l), coarse, fine);
  }
}
END_TEST

/* What is stored, told from the state alone, is what the loops add up: normal parts, tangential and rolling springs, of
 * pairs and of walls. */
START_TEST(test_stored_from_the_state) {
  laws l = rows[_i];
  double most = 0;
  for (l.rolling = 0; l.rolling < ROLLINGS; l.rolling++) {
    rig *r = scene_of(&l, true, true, "plain", 2e-6);
    for (int k = 0; k < 30; k++) {
      rig_steps(r, 250);
      double loops = dem_energy_elastic(&r->data->state.energy), state = dem_stored_energy_now(r->data).elastic;
      most = fmax(most, loops);
      ck_assert_msg(fabs(state - loops) <= 1e-9 * loops + 1e-20, "%s: %.12g in the loops, %.12g", name_of(&l), loops,
                    state);
    }
    rig_free(r);
  }
  ck_assert(most > 1e-6);
}
END_TEST

static double kinetic(const dem_data *d) {
  double e = 0;
  for (int i = 0; i < d->state.nparticle; i++)
    e += d->state.mass[i] * (0.5 * tdm_dot(d->state.pace[i].velocity, d->state.pace[i].velocity) +
                             0.2 * d->state.sphere[i].radius * d->state.sphere[i].radius *
                                 tdm_dot(d->state.pace[i].spin, d->state.pace[i].spin));
  return e;
}

/* Two spheres collide, e = 0.5: three quarters of the energy are lost, whatever is taken how often; in the middle of
 * the contact the rest is elastic. */
START_TEST(test_energy_of_substeps) {
  static const double masses[] = {1, 1e-9}; /* all fast, all slow */
  for (int k = 0; k < 2; k++) {
    rig *r =
        rig_make(scene_json("{'gravity':[0,0,0],'energy':true,'integrator':'multi-step','multi_step':{'substeps':5,"
                            "'mass':%g},'materials':[{'name':'a','density':2500,'young_modulus':1e7,"
                            "'poisson_ratio':0.25}],'pairs':[{'materials':['a','a'],'restitution':0.5}],"
                            "'contact':{'tangential':'none'},'particles':["
                            "{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0]],'velocity':[0.5,0,0]},"
                            "{'type':'list','material':'a','radius':0.01,'positions':[[0.0201,0,0]],"
                            "'velocity':[-0.5,0,0]}]}",
                            masses[k]),
                 2e-6, 0, NULL);
    double start = total_energy(r->data), elastic = 0;
    for (int s = 0; s < 4000; s++) {
      rig_steps(r, 1);
      elastic = fmax(elastic, dem_energy_elastic(&r->data->state.energy));
      ck_relative(total_energy(r->data), start, 1e-3);
    }
    ck_assert_int_eq(r->data->state.ncontact, 0);
    ck_assert(elastic > 0.3 * start && elastic < 0.9 * start);
    ck_relative(r->data->state.energy.dissipated[DEM_ENERGY_NORMAL], start - kinetic(r->data), 1e-3);
    ck_relative(kinetic(r->data), 0.25 * start, 5e-3);
    rig_free(r);
  }
}
END_TEST

#define GRAINS                                                                                       \
  "'energy':true,'materials':[{'name':'a','density':2500,'young_modulus':2e6,'poisson_ratio':0.3}]," \
  "'pairs':[{'materials':['a','a'],'restitution':0.6,'friction':0.4}],"

/* Forces and accelerations on particles, gravity along a direction that repeats, a box that is strained: what they put
 * in is booked, so that the balance stays what it was, to second order in the step. */
START_TEST(test_energy_from_outside) {
  static const struct {
    const char *what, *scene;
    double gain; /* least change of kinetic energy, as a share of the start's */
  } cases[] = {
      {"force",
       "{" GRAINS "'bodies':[{'name':'f','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],'particles':["
       "{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0.0105],[0.05,0,0.012]],'velocity':[0.1,0,0],"
       "'force':[0.05,0.01,0]},{'type':'list','material':'a','radius':0.01,'positions':[[0,0.03,0.02]],"
       "'acceleration':[0,0,15]}]}",
       1},
      {"fall",
       "{'gravity':[0,0,-200]," GRAINS "'domain':{'min':[0,0,0],'max':[0.1,0.1,0.1],'x':'periodic','y':'periodic',"
       "'z':'periodic'},'particles':[{'type':'random','material':'a','count':30,'radius':0.01,'region':{'min':[0,0,0],"
       "'max':[0.1,0.1,0.1]},'velocity':[0.5,0,-1]},{'type':'list','material':'a','radius':0.005,"
       "'positions':[[0.05,0.05,0.05]],'fixed':true}]}",
       1},
      {"strain",
       "{'gravity':[0,0,0]," GRAINS "'domain':{'min':[0,0,0],'max':[0.1,0.1,0.1],'x':'periodic','y':'periodic',"
       "'z':'periodic','strain_rate':[-0.5,3,-0.5]},'particles':[{'type':'random','material':'a','count':60,"
       "'radius':0.01,'region':{'min':[0,0,0],'max':[0.1,0.1,0.1]},'velocity':[0.2,0.3,-0.1]}]}",
       0}};
  static const char *const ways[] = {"{}", "{\"integrator\":\"leap-frog\"}", "{\"integrator\":\"stormer-verlet\"}",
                                     "{\"integrator\":\"multi-step\",\"multi_step\":{\"substeps\":2,\"mass\":0.003}}"};
  for (size_t c = 0; c < 3; c++) {
    double off[2];
    for (int k = 0; k < 2; k++) {
      double dt = k ? 1e-5 : 4e-5;
      json_t *json = scene_json("%s", cases[c].scene), *way = json_loads(ways[_i], 0, NULL);
      json_object_update(json, way);
      json_decref(way);
      rig *r = rig_make(json, dt, 0, NULL);
      for (int i = 0; c == 2 && i < r->data->state.nparticle; i++)
        r->data->state.pace[i].velocity = tdm_scale(0.5, tdm_v3(sin(3 * i), cos(5 * i), sin(7 * i)));
      r->data->state.restart = true;
      double start = total_energy(r->data), before = kinetic(r->data), most = before;
      off[k] = 0;
      for (int s = 0; s < 30; s++) {
        rig_steps(r, (long)(1e-3 / dt + 0.5));
        most = fmax(most, kinetic(r->data));
        off[k] = fmax(off[k], fabs(total_energy(r->data) - start));
      }
      off[k] /= most;
      if (c > 0)
        ck_assert_double_gt(fabs(r->data->state.energy.supplied), 0.02 * before);
      ck_assert_msg(most >= (1 + cases[c].gain) * before, "%s: %g, %g J", cases[c].what, before, most);
      rig_free(r);
    }
    ck_assert_msg(off[0] < 2e-3 && off[1] < off[0] / 3, "%s, %s: off by %g, %g", cases[c].what, ways[_i], off[0],
                  off[1]);
  }
}
END_TEST

/* ---- momentum ---- */

static void momenta(const dem_data *d, tdm_vec3 out[2]) {
  out[0] = out[1] = tdm_v3(0, 0, 0);
  for (int i = 0; i < d->state.nparticle; i++) {
    tdm_vec3 p = tdm_scale(d->state.mass[i], d->state.pace[i].velocity);
    out[0] = tdm_add(out[0], p);
    out[1] = tdm_add(out[1], tdm_cross(d->state.sphere[i].position, p));
    out[1] = tdm_axpy(0.4 * d->state.mass[i] * d->state.sphere[i].radius * d->state.sphere[i].radius,
                      d->state.pace[i].spin, out[1]);
  }
}

START_TEST(test_momentum) {
  for (int k = _i * NMORE; k < (_i + 1) * NMORE; k++) {
    laws l;
    if (!pick(&l, k))
      continue;
    rig *r = scene_of(&l, false, false, "plain", 2e-5);
    tdm_vec3 before[2], after[2];
    momenta(r->data, before);
    rig_steps(r, 300);
    momenta(r->data, after);
    const double scale[2] = {5e-4, 5e-6};
    for (int q = 0; q < 2; q++)
      ck_assert_msg(tdm_norm(tdm_sub(after[q], before[q])) < 1e-12 * scale[q], "%s: %d off by %g", name_of(&l), q,
                    tdm_norm(tdm_sub(after[q], before[q])));
    rig_free(r);
  }
}
END_TEST

/* ---- instruction sets ---- */

START_TEST(test_same_bits) {
  for (int k = _i * NMORE; k < (_i + 1) * NMORE; k++) {
    laws l;
    if (!pick(&l, k))
      continue;
    for (int energy = k % NMORE > 0; energy < 2; energy++) {
      rig *plain = scene_of(&l, true, energy, "plain", 2e-5);
      rig_steps(plain, 150);
      for (int s = 0; s < 2; s++) {
        if (!dem_simd_here(dem_simd_names[s]))
          continue;
        rig *r = scene_of(&l, true, energy, dem_simd_names[s], 2e-5);
        rig_steps(r, 150);
        size_t n = (size_t)r->data->state.nparticle;
        ck_assert_msg(memcmp(r->data->state.sphere, plain->data->state.sphere, n * sizeof *r->data->state.sphere) ==
                              0 &&
                          memcmp(r->data->state.pace, plain->data->state.pace, n * sizeof *r->data->state.pace) == 0,
                      "%s on %s", name_of(&l), dem_simd_names[s]);
        ck_assert_msg(memcmp(&r->data->state.energy, &plain->data->state.energy, sizeof plain->data->state.energy) == 0,
                      "%s on %s: energies", name_of(&l), dem_simd_names[s]);
        rig_free(r);
      }
      rig_free(plain);
    }
  }
}
END_TEST

/* ---- lists ---- */

/* A heap of 125 that roll and twist; `more`: how its lists are made. */
static rig *heap(int set, const char *more) {
  rig *r = rig_make(
      scene_json("{'materials':[{'name':'a','density':2500,'young_modulus':2e6,'poisson_ratio':0.3}],'energy':true,"
                 "'pairs':[{'materials':['a','a'],'restitution':0.7,'friction':0.4%s%s}],"
                 "'contact':{'rolling':'%s','twisting':'%s'},'bodies':[{'name':'box','material':'a',"
                 "'shapes':[{'type':'box','size':[0.0478,0.0478,0.0478],'side':'inside','center':[0.02,0.02,0.02]}]}],"
                 "'particles':[{'type':'block','material':'a','radius':[0.0047,0.005],'count':[5,5,5],"
                 "'corner':[0,0,0],'spacing':0.01}]%s}",
                 set / 2 ? ",'rolling_friction':0.1" : "", set % 2 ? ",'twisting_friction':0.05" : "",
                 names[DEM_FAMILY_ROLLING][set / 2], names[DEM_FAMILY_TWISTING][set % 2], more),
      2e-5, 0, NULL);
  for (int i = 0; i < r->data->state.nparticle; i++) {
    double a = (double)(i * 7919 % 101) / 50 - 1, b = (double)(i * 6007 % 97) / 48 - 1;
    r->data->state.pace[i].velocity = tdm_v3(0.3 * a, 0.3 * b, -0.3 * a * b);
    r->data->state.pace[i].spin = tdm_v3(40 * b, -40 * a, 20 * a);
  }
  return r;
}

static void ck_same(const dem_data *a, const dem_data *b, int set, const char *what) {
  size_t n = (size_t)a->state.nparticle;
  ck_assert_msg(memcmp(a->state.sphere, b->state.sphere, n * sizeof *a->state.sphere) == 0 &&
                    memcmp(a->state.pace, b->state.pace, n * sizeof *a->state.pace) == 0 &&
                    memcmp(a->state.push, b->state.push, n * sizeof *a->state.push) == 0 &&
                    memcmp(a->state.body_load, b->state.body_load, sizeof *a->state.body_load) == 0,
                "%s/%s: %s", names[DEM_FAMILY_ROLLING][set / 2], names[DEM_FAMILY_TWISTING][set % 2], what);
  ck_assert_msg(memcmp(&a->state.energy, &b->state.energy, sizeof a->state.energy) == 0, "%s/%s: energies, %s",
                names[DEM_FAMILY_ROLLING][set / 2], names[DEM_FAMILY_TWISTING][set % 2], what);
}

/* Pairs share a batch as the lists have them: neither skin, search nor instruction set may be seen in the results. */
START_TEST(test_lists_do_not_matter) {
  static const char *const ways[] = {",'search':'sweep'",        ",'search':'grid'", ",'search':'all','skin':0.02",
                                     ",'search':'verlet-1967'",  ",'skin':0.004",    ",'skin':0.0001",
                                     ",'simd':'plain'",          ",'simd':'avx2'",   ",'simd':'plain','skin':0.003",
                                     ",'search':'linked-linear'"};
  rig *plain = heap(_i, "");
  rig_steps(plain, 400);
  ck_assert_int_gt(plain->data->state.ncontact, 100);
  for (size_t k = 0; k < sizeof ways / sizeof ways[0]; k++) {
    if (strstr(ways[k], "avx2") && !dem_simd_here("avx2"))
      continue;
    rig *r = heap(_i, ways[k]);
    rig_steps(r, 400);
    ck_same(plain->data, r->data, _i, ways[k]);
    rig_free(r);
  }
  rig *half = heap(_i, ""), *restored = heap(_i, "");
  void *bytes;
  size_t size;
  tdm_error err = {0};
  rig_steps(half, 203);
  ck_assert_int_eq(dem_state_save(half->data, &bytes, &size), TDM_OK);
  ck_assert_msg(!dem_state_load(restored->data, bytes, size, &err), "%s", err.message);
  rig_steps(restored, 197);
  ck_same(plain->data, restored->data, _i, "restored");
  free(bytes);
  rig_free(half);
  rig_free(restored);
  rig_free(plain);
}
END_TEST

/* ---- histories ---- */

START_TEST(test_histories_turn) {
  /* Sorting changes the order of pairs; forces and couples stay. (No damping that ends at the limit of a spring: an
   * evaluation without a step may find it on either side.) */
  rig *r = rig_make(scene_json("{'gravity':[0,0,0],'materials':[{'name':'a','density':2500}],'skin':0.001,"
                               "'pairs':[{'materials':['a','a'],'stiffness':2000,'restitution':0.8,"
                               "'friction':0.3,'rolling_friction':0.2,'rolling_damping':0}],"
                               "'contact':{'normal':'hooke','tangential':'spring','rolling':'spring-dashpot'},"
                               "'particles':[{'type':'block','material':'a','radius':0.005,'count':[14,13,13],"
                               "'corner':[0,0,0],'spacing':0.01},"
                               "{'type':'list','material':'a','radius':0.005,'positions':[[-0.05,0,0]]}]}"),
                    2e-5, 0, NULL);
  dem_data *d = r->data;
  for (int i = 0; i < d->state.nparticle; i++) {
    double a = (double)(d->state.id[i] * 7919 % 101) / 50 - 1, b = (double)(d->state.id[i] * 104729 % 97) / 48 - 1;
    d->state.pace[i].velocity = tdm_v3(0.1 * a, 0.1 * b, -0.1 * a * b);
    d->state.pace[i].spin = tdm_v3(40 * b, -40 * a, 20 * a);
  }
  rig_steps(r, 100);
  forces_now(d, false);
  int n = d->state.nparticle;
  dem_push *before = calloc((size_t)n, sizeof *before);
  int *place = calloc((size_t)n, sizeof *place), swapped = 0;
  double largest = 0;
  for (int i = 0; i < n; i++) {
    before[d->state.id[i]] = d->state.push[i];
    place[d->state.id[i]] = i;
    largest = fmax(largest, tdm_norm(d->state.push[i].force));
  }
  dem_data *moved = dem_data_create(r->model);
  ck_assert(moved != NULL && !dem_data_copy(moved, d));
  moved->state.since_sort = 1u << 30;
  for (int i = 0; i < n; i++) /* the one that is alone shifts the cells by which they are sorted */
    if (d->state.id[i] == (uint64_t)n - 1)
      moved->state.sphere[i].position.x -= 0.03;
  forces_now(moved, false);
  for (int i = 0; i < n; i++) {
    swapped += place[moved->state.id[i]] != i;
    const dem_push *b = &before[moved->state.id[i]];
    ck_assert_double_le(tdm_norm(tdm_sub(moved->state.push[i].force, b->force)), 1e-11 * largest);
    ck_assert_double_le(tdm_norm(tdm_sub(moved->state.push[i].twist, b->twist)), 1e-11 * largest);
  }
  ck_assert_int_gt(swapped, 100);
  free(before);
  free(place);
  dem_data_destroy(&moved);
  rig_free(r);
}
END_TEST

TEST_MAIN_ROWS("dem energy", {test_energy, NROW}, {test_stored_from_the_state, NROW}, {test_energy_of_substeps, 1},
               {test_energy_from_outside, 4}, {test_momentum, NROW}, {test_same_bits, NROW},
               {test_lists_do_not_matter, ROLLINGS *TWISTINGS}, {test_histories_turn, 1})
