/* Contacts that act on each other: the laws mc-stress and mc-strain of [G21], against their closed forms, against the
 * printed equations taken by brute force, and against themselves where they must be what Hertz's law is. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/particles/domain.h"
#include "dem/watch/check.h"
#include "dem/watch/energy_balance.h"
#include "dem/watch/limits.h"
#include "protocol/math/random.h"
#include "tests/test_main.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>

static const double radius = 0.01, young = 23300, poisson = 0.46;
#define VOLUME (4.0 / 3 * M_PI * radius * radius * radius)

/* one material of particles and walls; %s: poisson ratio, keys of the pair, keys of contact, what there is */
#define SCENE                                                                                                \
  "{'gravity':[0,0,0],%s'materials':[{'name':'a','density':1150,'young_modulus':23300,'poisson_ratio':%s}]," \
  "'pairs':[{'materials':['a','a'],%s}],'contact':{%s},%s}"

static rig *make(const char *more, const char *nu, const char *pair, const char *contact, const char *there,
                 double dt) {
  return rig_make(scene_json(SCENE, more, nu, pair, contact, there), dt, 0, NULL);
}

/* "particles": a lattice of nx, ny, nz spheres from the origin on; `more`: further entries */
static const char *lattice(const int n[3], double spacing, const char *more) {
  static char text[400000];
  size_t at =
      (size_t)snprintf(text, sizeof text, "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[");
  for (int k = 0; k < n[0] * n[1] * n[2]; k++)
    at += (size_t)snprintf(text + at, sizeof text - at, "%s[%.17g,%.17g,%.17g]", k > 0 ? "," : "", spacing * (k % n[0]),
                           spacing * (k / n[0] % n[1]), spacing * (k / n[0] / n[1]));
  snprintf(text + at, sizeof text - at, "]}%s]", more);
  return text;
}

static double hertz(double effective_radius, double overlap) {
  double effective_young = young / (2 * (1 - poisson * poisson));
  return 4.0 / 3 * effective_young * sqrt(effective_radius * overlap) * overlap;
}

#define ELASTIC "'restitution':1"
#define FREE "'tangential':'none'"

/* ---- mc-stress ---- */

#define TWO "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0],[0.0192,0,0]]}]"

/* The contact's own force counts: f = f_H (1 + 2 beta nu A r/V), at a wall, which has no stress, half as much more. */
START_TEST(test_own_force) {
  const double beta = 1.65, overlap = 8e-4;
  rig *r = make("", "0.46", ELASTIC ",'beta':1.65", FREE ",'multi_contact':'mc-stress'", TWO, 1e-5);
  double area = M_PI * radius / 2 * overlap, f = hertz(radius / 2, overlap);
  ck_relative(r->data->state.push[1].force.x, f * (1 + 2 * beta * poisson * area * radius / VOLUME), 1e-12);
  ck_assert_double_eq(r->data->state.push[0].force.x, -r->data->state.push[1].force.x);
  rig_free(r);

  r = make("", "0.46", ELASTIC ",'beta':1.65", FREE ",'multi_contact':'mc-stress','pressure':'mean'", TWO, 1e-5);
  ck_relative(r->data->state.push[1].force.x, f * (1 + 2 * beta / 6 * poisson * area * radius / VOLUME), 1e-12);
  rig_free(r);

  r = make("", "0.46", ELASTIC ",'beta':1.65", FREE ",'multi_contact':'mc-stress'",
           "'bodies':[{'name':'w','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],"
           "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0.0092]]}]",
           1e-5);
  ck_relative(r->data->state.push[0].force.z,
              hertz(radius, overlap) * (1 + beta * poisson * M_PI * radius * overlap * radius / VOLUME), 1e-12);
  rig_free(r);
}
END_TEST

/* Two materials: each particle's stress counts with its own Poisson's ratio. */
START_TEST(test_two_materials) {
  rig *r = rig_make(
      scene_json("{'gravity':[0,0,0],'materials':[{'name':'a','density':1000,'young_modulus':1e6,'poisson_ratio':0.5},"
                 "{'name':'b','density':1000,'young_modulus':1e6,'poisson_ratio':0.1}],'pairs':[{'materials':['a','b'],"
                 "'restitution':1,'beta':2}],'contact':{'tangential':'none','multi_contact':'mc-stress'},'particles':["
                 "{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0]]},"
                 "{'type':'list','material':'b','radius':0.02,'positions':[[0.0295,0,0]]}]}"),
      1e-6, 0, NULL);
  double of = 1 / ((1 - 0.25) / 1e6 + (1 - 0.01) / 1e6), overlap = 5e-4, both = 0.01 * 0.02 / 0.03;
  double f = 4.0 / 3 * of * sqrt(both * overlap) * overlap, per = 3 / (4 * M_PI);
  double pressure = per * f * (0.5 / 1e-4 + 0.1 / 4e-4);
  ck_relative(r->data->state.push[1].force.x, f + 2 * M_PI * both * overlap * pressure, 1e-12);
  rig_free(r);
}
END_TEST

/* A square lattice that repeats, [G21] Eq. 11: f = f_H (1 + 4 d beta nu A/V). The power of straining the box along x
 * shows the force of the contacts that cross its side. */
START_TEST(test_lattice) {
  enum { SIDE = 6 };
  static const double overlaps[] = {1e-5, 4e-4, 1e-3, 3e-3};
  const double beta = 1.65, overlap = overlaps[_i], spacing = 2 * radius - overlap, rate = -1e-3;
  rig *r = rig_make(
      scene_json("{'gravity':[0,0,0],'energy':true,'materials':[{'name':'a','density':1150,'young_modulus':23300,"
                 "'poisson_ratio':0.46}],'pairs':[{'materials':['a','a'],'restitution':1,'beta':1.65}],"
                 "'contact':{'tangential':'none','multi_contact':'mc-stress'},'domain':{'min':[0,0,-1],"
                 "'max':[%.17g,%.17g,1],'x':'periodic','y':'periodic','strain_rate':[%.17g,0,0]},%s}",
                 SIDE * spacing, SIDE * spacing, rate, lattice((const int[]){SIDE, SIDE, 1}, spacing, "")),
      1e-9, 0, NULL);
  dem_data *d = r->data;
  ck_assert_int_eq(d->state.ncontact, 2 * SIDE * SIDE);
  double power = d->state.energy.now.box_power, force = fabs(power / (SIDE * rate * SIDE * spacing));
  double area = M_PI * radius / 2 * overlap;
  ck_relative(force, hertz(radius / 2, overlap) * (1 + 4 * 2 * radius * beta * poisson * area / VOLUME), 1e-10);
  for (int i = 0; i < d->state.nparticle; i++)
    ck_assert_double_lt(tdm_norm(d->state.push[i].force), 1e-10 * force);
  rig_free(r);
}
END_TEST

/* ---- five in a box ---- */

typedef struct {
  double wall, beta;
} box;

/* The outer ones lie at x from the middle one, between it and walls: the force on them outward, and that of the wall.
 */
static double forces_in_box(const box *b, double x, double *at_wall) {
  double inner = 2 * radius - x, outer = x + radius - b->wall;
  double of_inner = hertz(radius / 2, inner), of_outer = hertz(radius, outer), per = radius / VOLUME;
  double middle = 4 * of_inner * per, side = (of_inner + of_outer) * per;
  *at_wall = of_outer + b->beta * poisson * M_PI * radius * outer * side;
  return of_inner + b->beta * poisson * M_PI * radius / 2 * inner * (middle + side) - *at_wall;
}

static double miss(double x, void *of) {
  double at_wall;
  return forces_in_box(of, x, &at_wall);
}

static double balance_in_box(box *b) {
  gsl_function f = {miss, b};
  gsl_root_fsolver *solver = gsl_root_fsolver_alloc(gsl_root_fsolver_brent);
  ck_assert(solver != NULL);
  gsl_root_fsolver_set(solver, &f, b->wall - radius + 1e-9, 2 * radius - 1e-9);
  for (int k = 0; k < 200; k++)
    gsl_root_fsolver_iterate(solver);
  double x = gsl_root_fsolver_root(solver);
  gsl_root_fsolver_free(solver);
  return x;
}

/* The five of [G21] 3.4.3, which are no lattice: at the balance that GSL finds all forces vanish, and the walls feel
 * what was expected. */
START_TEST(test_five_in_a_box) {
  static const double walls[] = {0.0295, 0.0275, 0.025};
  box b = {walls[_i], 1.65};
  double x = balance_in_box(&b), at_wall;
  forces_in_box(&b, x, &at_wall);
  rig *r = rig_make(
      scene_json("{'gravity':[0,0,0],'materials':[{'name':'a','density':1150,'young_modulus':23300,'poisson_ratio':"
                 "0.46}],'pairs':[{'materials':['a','a'],'restitution':1,'beta':1.65}],'contact':{'tangential':'none',"
                 "'multi_contact':'mc-stress'},'bodies':[{'name':'east','material':'a','shapes':[{'type':'plane',"
                 "'normal':[-1,0,0],'point':[%.17g,0,0]}]},{'name':'rest','material':'a','shapes':[{'type':'plane',"
                 "'normal':[1,0,0],'point':[%.17g,0,0]},{'type':'plane','normal':[0,1,0],'point':[0,%.17g,0]},"
                 "{'type':'plane','normal':[0,-1,0],'point':[0,%.17g,0]}]}],'particles':[{'type':'list','material':'a',"
                 "'radius':0.01,'positions':[[0,0,0],[%.17g,0,0],[%.17g,0,0],[0,%.17g,0],[0,%.17g,0]]}]}",
                 b.wall, -b.wall, -b.wall, b.wall, x, -x, x, -x),
      1e-6, 0, NULL);
  const dem_data *d = r->data;
  for (int i = 0; i < 5; i++)
    ck_assert_double_lt(tdm_norm(d->state.push[i].force), 1e-11 * at_wall);
  ck_relative(d->state.body_load[0].force.x, at_wall, 1e-10);
  rig_free(r);
}
END_TEST

/* ---- mc-strain ---- */

#define PLATES                                                                                              \
  "'bodies':[{'name':'below','material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]},{'name':'above'," \
  "'material':'a','shapes':[{'type':'plane','normal':[0,0,-1],'point':[0,0,%.17g]}]}],'particles':["        \
  "{'type':'list','material':'a','radius':0.01,'positions':[[0,0,%.17g]]}]"

static rig *between_plates(const char *contact, double gap) {
  return rig_make(
      scene_json("{'gravity':[0,0,0],'materials':[{'name':'a','density':1150,'young_modulus':23300,'poisson_ratio':"
                 "0.46}],'pairs':[{'materials':['a','a'],'restitution':1,'gamma':0.55}],'contact':{'tangential':"
                 "'none','multi_contact':'mc-strain'%s}," PLATES "}",
                 contact, gap, gap / 2),
      1e-7, 0, NULL);
}

/* by how much more than the overlap a plate's force needs */
static double shift_at(const dem_data *d, double overlap) {
  double f = fabs(d->state.body_load[1].force.z), one = hertz(radius, 1);
  return pow(f / one, 2.0 / 3) - overlap;
}

/* Two opposite contacts: delta = gamma (1+nu)(3-2nu) f/(2 pi E d), with Hertz's force, and, with a tolerance, with the
 * force itself. */
START_TEST(test_opposite_contacts) {
  static const double overlaps[] = {1e-6, 1e-4, 2e-3};
  const double overlap = overlaps[_i], d = 2 * (radius - overlap);
  const double per = 0.55 * (1 + poisson) * (3 - 2 * poisson) / (2 * M_PI * young * d);
  rig *r = between_plates(",'first_forces':'hertz'", d);
  ck_near(shift_at(r->data, overlap), per * hertz(radius, overlap), 1e-12 * overlap);
  rig_free(r);
  r = between_plates(",'first_forces':'hertz','tolerance':1e-15", d);
  ck_near(shift_at(r->data, overlap), per * fabs(r->data->state.body_load[1].force.z), 2e-12 * overlap);
  rig_free(r);

  /* from the forces of the step before: the same after many steps, as nothing moves */
  r = between_plates("", d);
  ck_near(fabs(r->data->state.body_load[1].force.z), hertz(radius, overlap), 1e-11 * hertz(radius, overlap));
  rig_steps(r, 200);
  ck_near(shift_at(r->data, overlap), per * fabs(r->data->state.body_load[1].force.z), 2e-12 * overlap);
  rig_free(r);
}
END_TEST

/* ---- what must be Hertz's law ---- */

#define IMPACT                                                                                              \
  "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[0,0,0]],'velocity':[0.5,0.1,0]}," \
  "{'type':'list','material':'a','radius':0.012,'positions':[[0.0225,0,0]],'velocity':[-0.5,0,0]}]"

static void ck_same_run(rig *a, rig *b, long steps) {
  size_t n = (size_t)a->data->state.nparticle;
  for (long k = 0; k < steps; k++) {
    rig_steps(a, 1);
    rig_steps(b, 1);
    ck_assert_mem_eq(a->data->state.sphere, b->data->state.sphere, n * sizeof *a->data->state.sphere);
    ck_assert_mem_eq(a->data->state.rotor, b->data->state.rotor, n * sizeof *a->data->state.rotor);
  }
  rig_free(a);
  rig_free(b);
}

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

/* ---- many, by brute force ---- */

/* A contact of the brute force: its particles, -1: the wall; the normal into the first one, where it is. */
typedef struct {
  int of[2];
  tdm_vec3 normal, point;
  double effective_radius, overlap, hertz, force;
} touch;

enum { TOUCHES = 20000 };

static int find_touches(const dem_data *d, touch *t) {
  int n = 0;
  const dem_sphere *s = d->state.sphere;
  for (int i = 0; i < d->state.nparticle; i++) {
    for (int j = i + 1; j < d->state.nparticle; j++) {
      tdm_vec3 x = tdm_sub(s[i].position, s[j].position);
      double sum = s[i].radius + s[j].radius, r = tdm_norm(x);
      if (r < sum)
        t[n++] = (touch){{i, j},
                         tdm_scale(1 / r, x),
                         tdm_axpy(-s[i].radius / sum, x, s[i].position),
                         s[i].radius * s[j].radius / sum,
                         sum - r,
                         0,
                         0};
    }
    for (int w = 0; w < d->model->nwall; w++) {
      tdm_vec3 n_w = d->state.wall[w].normal;
      double gap = tdm_dot(tdm_sub(s[i].position, d->state.wall[w].point), n_w);
      if (gap < s[i].radius)
        t[n++] = (touch){{i, -1}, n_w, tdm_axpy(-gap, n_w, s[i].position), s[i].radius, s[i].radius - gap, 0, 0};
    }
  }
  ck_assert_int_lt(n, TOUCHES);
  for (int c = 0; c < n; c++)
    t[c].hertz = t[c].force = hertz(t[c].effective_radius, t[c].overlap);
  return n;
}

/* [G21] Eq. 7 as printed, on particle p */
static double influence(const touch *k, const touch *c, int p) {
  double side_k = k->of[0] == p ? 1 : -1, side_c = c->of[0] == p ? 1 : -1;
  tdm_vec3 n_k = tdm_scale(side_k, k->normal), n_c = tdm_scale(side_c, c->normal), way = tdm_sub(c->point, k->point);
  double far = tdm_norm(way), g = tdm_dot(n_k, n_c);
  tdm_vec3 u = tdm_scale(1 / far, way);
  double bracket = tdm_dot(n_k, u) * tdm_dot(n_c, u) + (3 - 4 * poisson) * g -
                   (1 - 2 * poisson) * tdm_dot(tdm_add(n_k, u), n_c) / (1 + tdm_dot(n_k, u));
  return -(1 + poisson) * k->force / (2 * M_PI * young * far) * bracket;
}

static void strain_forces(touch *t, int n, double gamma) {
  static double force[TOUCHES];
  for (int c = 0; c < n; c++) {
    double sum = 0;
    for (int k = 0; k < n; k++)
      for (int side = 0; side < 2 && k != c; side++)
        if (t[c].of[side] >= 0 && (t[k].of[0] == t[c].of[side] || t[k].of[1] == t[c].of[side]))
          sum += influence(&t[k], &t[c], t[c].of[side]);
    force[c] = hertz(t[c].effective_radius, fmax(t[c].overlap + gamma * sum, 0));
  }
  for (int c = 0; c < n; c++)
    t[c].force = force[c];
}

static void stress_forces(touch *t, int n, const dem_data *d, double beta, bool exclude) {
  static double trace[TOUCHES];
  for (int i = 0; i < d->state.nparticle; i++)
    trace[i] = 0;
  for (int c = 0; c < n; c++)
    for (int side = 0; side < 2; side++)
      if (t[c].of[side] >= 0)
        trace[t[c].of[side]] += t[c].hertz;
  for (int c = 0; c < n; c++)
    for (int side = 0; side < 2; side++)
      if (t[c].of[side] >= 0) {
        double r = d->state.sphere[t[c].of[side]].radius, volume = 4.0 / 3 * M_PI * r * r * r;
        double stress = r * (trace[t[c].of[side]] - (exclude ? t[c].hertz : 0)) / volume;
        t[c].force += beta * poisson * M_PI * t[c].effective_radius * t[c].overlap * stress;
      }
}

/* 514 of several sizes, pressed together and into two walls */
static rig *heap(const char *more, const char *law, double factor, double dt) {
  json_t *scene = scene_json(
      "{'gravity':[0,0,0],%s'materials':[{'name':'a','density':1150,'young_modulus':23300,'poisson_ratio':0.46}],"
      "'pairs':[{'materials':['a','a'],'restitution':1,%s:%.17g}],'contact':{'tangential':'none',%s},"
      "'bodies':[{'name':'box','material':'a','shapes':[{'type':'plane','normal':[0,0,1],'point':[0,0,-0.0095]},"
      "{'type':'plane','normal':[1,0,0],'point':[-0.0095,0,0]}]}],'particles':[]}",
      more, strstr(law, "strain") ? "'gamma'" : "'beta'", factor, law);
  json_t *all = json_object_get(scene, "particles");
  for (int i = 0; i < 514; i++) {
    double x[3];
    const int at[] = {i % 8, i / 8 % 8, i / 64};
    for (int a = 0; a < 3; a++)
      x[a] = 0.0193 * at[a] + 0.001 * (tdm_random(3, (uint64_t)i, (uint64_t)a) - 0.5);
    json_array_append_new(all,
                          json_pack("{s:s, s:s, s:f, s:[[f,f,f]], s:[f,f,f]}", "type", "list", "material", "a",
                                    "radius", 0.0095 + 0.001 * tdm_random(3, (uint64_t)i, 7), "positions", x[0], x[1],
                                    x[2], "velocity", 0.1 * sin(3.0 * i), 0.1 * cos(5.0 * i), 0.1 * sin(7.0 * i)));
  }
  return rig_make(scene, dt, 0, NULL);
}

START_TEST(test_against_brute_force) {
  static const char *const laws[] = {"'multi_contact':'mc-strain','first_forces':'hertz'",
                                     "'multi_contact':'mc-strain','first_forces':'hertz','iterations':3",
                                     "'multi_contact':'mc-stress'",
                                     "'multi_contact':'mc-stress','self_contribution':'exclude'"};
  static touch t[TOUCHES];
  rig *r = heap(_i == 1 ? "'energy':true," : "", laws[_i], 1.12, 1e-6);
  const dem_data *d = r->data;
  int n = find_touches(d, t);
  ck_assert_int_eq(n, (int)d->state.ncontact);
  if (_i >= 2)
    stress_forces(t, n, d, 1.12, _i == 3);
  for (int k = 0; _i < 2 && k < (_i == 1 ? 3 : 1); k++)
    strain_forces(t, n, 1.12);
  tdm_vec3 *sum = calloc((size_t)d->state.nparticle, sizeof *sum);
  double largest = 0, different = 0;
  for (int c = 0; c < n; c++) {
    sum[t[c].of[0]] = tdm_axpy(t[c].force, t[c].normal, sum[t[c].of[0]]);
    if (t[c].of[1] >= 0)
      sum[t[c].of[1]] = tdm_axpy(-t[c].force, t[c].normal, sum[t[c].of[1]]);
    largest = fmax(largest, t[c].force);
    different = fmax(different, fabs(t[c].force - t[c].hertz));
  }
  ck_assert_double_gt(different, 0.1 * largest);
  for (int i = 0; i < d->state.nparticle; i++)
    ck_assert_double_lt(tdm_norm(tdm_sub(sum[i], d->state.push[i].force)), 1e-11 * largest);
  free(sum);
  rig_free(r);
}
END_TEST

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
  const dem_data *d = r->data;
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

TEST_MAIN_ROWS("contacts that act on each other", {test_own_force, 1}, {test_two_materials, 1}, {test_lattice, 4},
               {test_five_in_a_box, 3}, {test_opposite_contacts, 3}, {test_two_are_classical, 4},
               {test_many_are_classical, 3}, {test_against_brute_force, 4}, {test_momenta, 2}, {test_energy, 2},
               {test_friction, 2}, {test_tangential_viscosity, 1}, {test_same_bits, 15}, {test_come_and_go, 2},
               {test_copy, 2}, {test_limits, 2}, {test_deep_start, 3}, {test_refused, 1})
