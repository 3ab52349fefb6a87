/* Contacts that act on each other: the laws mc-stress and mc-strain of [G21] against their closed forms, and against
 * the printed equations taken by brute force. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_multi_support.h"
#include "tests/test_main.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_roots.h>

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

TEST_MAIN_ROWS("contacts that act on each other", {test_own_force, 1}, {test_two_materials, 1}, {test_lattice, 4},
               {test_five_in_a_box, 3}, {test_opposite_contacts, 3}, {test_against_brute_force, 4})
