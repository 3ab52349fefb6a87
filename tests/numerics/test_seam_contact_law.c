/* A normal contact law that is added from outside: all of it is in this file, its loops included.
 *
 * "confined" is a conservative multi-contact law. With the overlaps δ of the contacts of a particle, summed before the
 * forces, S = Σ δ,
 *   E = k/2 Σ δ² + α k Σ δ_a δ_b over pairs of contacts of one particle,   F = k (δ + α (S_i − δ) + α (S_j − δ));
 * a wall has no other contacts. Two bodies alone feel F = k δ.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define DEM_SIMD 0 /* the loops below in plain C; the law has no others */
#include "dem/contact/law/contact.h"
#include "dem/contact/law/law.h"

/* of pair.normal; pair.stiffness is k [N/m] */
enum { CONFINEMENT }; /* α */

DEM_KERNEL void sum_overlaps(const dem_contact *c, vd sum[]) {
  sum[0] = c->overlap;
}

DEM_KERNEL void kernel(dem_contact *c, vd *history) {
  (void)history;
  vd wall = vd_pick(vm_less(c->radii[1], vd_set(INFINITY)), vd_set(0), c->overlap);
  vd others = c->own_sums[0] - c->overlap + (c->other_sums[0] + wall - c->overlap);
  c->stiffness = DEM_OF(c, stiffness);
  c->damping = vd_sqrt(c->stiffness * c->mass);
  c->force = c->stiffness * (c->overlap + DEM_OF(c, normal[CONFINEMENT]) * others);
  c->elastic = vd_set(0.5) * c->force * c->overlap;
}

#define DEM_LAW confined
#define DEM_LAW_KERNEL kernel
#define DEM_LAW_SUMS 1
#define DEM_LAW_SUMS_KERNEL sum_overlaps
#include "dem/contact/loop/loops.h"

static void read_confined(const dem_model *m, tdm_object *o, dem_pair *p) {
  (void)m;
  p->stiffness = dem_need(o, "stiffness", "normal", "confined", TDM_POSITIVE);
  p->normal[CONFINEMENT] = dem_need(o, "confinement", "normal", "confined", TDM_NOT_NEGATIVE);
}

static double time_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m;
  return M_PI * sqrt(i.mass / p->stiffness);
}

static double overlap_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m;
  return i.speed * sqrt(i.mass / p->stiffness);
}

static double restitution_of(const dem_model *m, const dem_pair *p, dem_impact i) {
  (void)m, (void)p, (void)i;
  return 1;
}

static double force_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  (void)m, (void)i;
  return p->stiffness * overlap;
}

static double stiffness_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  (void)m, (void)i, (void)overlap;
  return p->stiffness;
}

static double elastic_of(const dem_model *m, const dem_pair *p, dem_impact i, double overlap) {
  (void)m, (void)i;
  return 0.5 * p->stiffness * overlap * overlap;
}

static const dem_normal_law confined = {
    .head = {.name = "confined",
             .keys = {{.name = "stiffness", .example = 1e4}, {.name = "confinement", .example = 0.3}}},
    .tangential = "spring",
    .why_not_clip = "which does not attract",
    .read = read_confined,
    .time = time_of,
    .overlap = overlap_of,
    .restitution = restitution_of,
    .force = force_of,
    .stiffness = stiffness_of,
    .elastic = elastic_of,
    .loops = {[DEM_PLAIN] = &dem_loops_confined_plain},
};

/* ---- the expected forces, from closed forms ---- */

#include "test_dem_support.h"

#include "dem/contact/table.h"
#include "dem/scene/scene.h"
#include "tests/test_main.h"

static const double k = 2e4, alpha = 0.3; /* as in MATERIAL */
#define MATERIAL                               \
  "'materials':[{'name':'a','density':2500}]," \
  "'pairs':[{'materials':['a','a'],'stiffness':2e4,'confinement':0.3%s}],'contact':{'normal':'confined'%s},"

static void add(void) {
  if (dem_law_place(DEM_FAMILY_NORMAL, "confined") < 0)
    ck_assert_int_eq(dem_law_add(DEM_FAMILY_NORMAL, &confined.head, NULL), TDM_OK);
  ck_assert_int_eq(dem_law_add(DEM_FAMILY_NORMAL, &confined.head, NULL), TDM_ERR_ARGUMENT); /* a name is there once */
}

/* Two alone: no energy is lost, and the contact takes half a period. */
START_TEST(test_impact) {
  add();
  rig *r = rig_make(scene_json("{'gravity':[0,0,0]," MATERIAL
                               "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[-0.011,0,0]],"
                               "'velocity':[0.5,0,0]},{'type':'list','material':'a','radius':0.01,"
                               "'positions':[[0.011,0,0]],'velocity':[-0.5,0,0]}]}",
                               "", ",'tangential':'none'"),
                    1e-7, 0, NULL);
  ck_assert_str_eq(r->model->normal->head.name, "confined");
  double time = 0, m = r->data->state.mass[0];
  for (int step = 0; step < 100000 && (time == 0 || r->data->state.ncontact > 0); step++) {
    rig_steps(r, 1);
    time += r->data->state.ncontact > 0 ? r->model->dt : 0;
  }
  ck_near(time, M_PI * sqrt(m / 2 / k), 3e-7);
  ck_relative(r->data->state.pace[1].velocity.x, 0.5, 1e-5);
  rig_free(r);
}
END_TEST

/* A sphere between two walls, or between two that are fixed, 0.1 mm from its place: both contacts have the overlap 0.5
 * mm ± x, and the force is −2 k (1 − α) x. */
START_TEST(test_period_of_one_that_is_held) {
  static const char *const holders[] = {
      "'bodies':[{'name':'box','material':'a','shapes':[{'type':'plane','normal':[1,0,0],'point':[-0.0095,0,0]},"
      "{'type':'plane','normal':[-1,0,0],'point':[0.0095,0,0]}]}],'particles':[",
      "'particles':[{'type':'list','material':'a','radius':0.01,'positions':[[-0.0195,0,0],[0.0195,0,0]],"
      "'fixed':true},"};
  add();
  rig *r = rig_make(scene_json("{'gravity':[0,0,0],'energy':%s," MATERIAL
                               "%s{'type':'list','material':'a','radius':0.01,'positions':[[0.0001,0,0]]}]}",
                               _i / 2 ? "true" : "false", "", ",'tangential':'none'", holders[_i % 2]),
                    1e-6, 0, NULL);
  const dem_data *d = r->data;
  int i = d->state.nparticle - 1;
  double m = d->state.mass[i], crossed[2] = {0, 0};
  for (int half = 0, step = 1; half < 2; step++) { /* half a period between the first two passages */
    double before = d->state.sphere[i].position.x;
    rig_steps(r, 1);
    double now = d->state.sphere[i].position.x;
    if (before * now <= 0)
      crossed[half++] = (step - 1 + before / (before - now)) * r->model->dt;
    ck_assert_int_lt(step, 100000);
  }
  ck_relative(crossed[1] - crossed[0], M_PI * sqrt(m / (2 * k * (1 - alpha))), 1e-6);
  ck_assert_int_eq(d->state.ncontact, 2);
  rig_free(r);
}
END_TEST

/* 2744 spheres, more than one chunk of them, a tenth of a millimetre apart, that fly at each other. */
static rig *crowd(int threads) {
  rig *r = rig_make(scene_json("{'gravity':[0,0,0],'energy':true,'threads':%d," MATERIAL
                               "'particles':[{'type':'block','material':'a','radius':0.01,'count':[14,14,14],"
                               "'corner':[0,0,0],'spacing':0.0201}]}",
                               threads, "", ",'tangential':'none'"),
                    5e-6, 0, NULL);
  for (int i = 0; i < r->data->state.nparticle; i++)
    r->data->state.pace[i].velocity = tdm_v3(sin(3.0 * i), cos(5.0 * i), sin(7.0 * i));
  r->data->state.restart = true;
  return r;
}

static double kinetic(const dem_data *d) {
  double e = 0;
  for (int i = 0; i < d->state.nparticle; i++)
    e += 0.5 * d->state.mass[i] * tdm_dot(d->state.pace[i].velocity, d->state.pace[i].velocity);
  return e;
}

/* of two spheres [m], and the normal towards the first */
static double overlap_in(const dem_data *d, int i, int j, tdm_vec3 *n) {
  tdm_vec3 x = tdm_sub(d->state.sphere[i].position, d->state.sphere[j].position);
  *n = tdm_unit(x);
  return d->state.sphere[i].radius + d->state.sphere[j].radius - tdm_norm(x);
}

/* The forces that follow from the head of this file, by looking at every pair twice. */
static void brute_force(const dem_data *d, double *sum, tdm_vec3 *force) {
  tdm_vec3 n;
  for (int pass = 0; pass < 2; pass++)
    for (int i = 0; i < d->state.nparticle; i++)
      for (int j = i + 1; j < d->state.nparticle; j++) {
        double overlap = overlap_in(d, i, j, &n);
        if (overlap <= 0)
          continue;
        if (pass == 0) {
          sum[i] += overlap, sum[j] += overlap;
        } else {
          double f = k * (overlap + alpha * (sum[i] + sum[j] - 2 * overlap));
          force[i] = tdm_axpy(f, n, force[i]);
          force[j] = tdm_axpy(-f, n, force[j]);
        }
      }
}

START_TEST(test_many) {
  add();
  rig *r = crowd(1), *two = crowd(2);
  const dem_data *d = r->data;
  size_t n = (size_t)d->state.nparticle;
  double start = kinetic(d) + dem_energy_elastic(&d->state.energy), moved = 0, largest = 0;
  for (int step = 0; step < 40; step++) {
    rig_steps(r, 5);
    moved = fmax(moved, fabs(kinetic(d) + dem_energy_elastic(&d->state.energy) - start));
  }
  ck_assert_double_lt(kinetic(d), 0.7 * start);
  ck_assert_double_lt(moved, 1e-4 * start);

  /* reactions on the next chunk are there, and what threads share is the same */
  ck_assert_int_gt(d->lists.crossings.count, 0);
  rig_steps(two, 200);
  ck_assert_mem_eq(d->state.sphere, two->data->state.sphere, n * sizeof *d->state.sphere);

  double *sum = calloc(n, sizeof *sum);
  tdm_vec3 *force = calloc(n, sizeof *force);
  brute_force(d, sum, force);
  for (size_t i = 0; i < n; i++)
    largest = fmax(largest, tdm_norm(force[i]));
  for (size_t i = 0; i < n; i++)
    ck_assert_double_lt(tdm_norm(tdm_sub(force[i], d->state.push[i].force)), 1e-12 * largest);
  free(sum);
  free(force);
  rig_free(two);
  rig_free(r);
}
END_TEST

/* The law's own coefficient: it must be there, and other laws refuse it by name. */
START_TEST(test_reading) {
  static const struct {
    const char *pair, *contact, *says;
  } cases[] = {{"'stiffness':1", "'normal':'confined'", "(normal \"confined\" needs it)"},
               {"'stiffness':1,'confinement':-1", "'normal':'confined'", "confinement"},
               {"'stiffness':1,'confinement':0.1", "'normal':'confined','tail':'clip'", "which does not attract"},
               {"'stiffness':1,'confinement':0.1,'restitution':1", "'normal':'hooke'", "none of the scene's laws"}};
  add();
  for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
    tdm_error err = {0};
    dem_model *model = NULL;
    json_t *scene = scene_json("{'materials':[{'name':'a','density':2500}],'pairs':[{'materials':['a','a'],%s}],"
                               "'contact':{%s,'tangential':'none'},'particles':[{'type':'list','material':'a',"
                               "'radius':0.01,'positions':[[0,0,0]]}]}",
                               cases[c].pair, cases[c].contact);
    const tdm_assignment assignment = {.scene = scene, .time_end = 1, .dt = 1e-6, .n = 1};
    dem_model_read(&model, &assignment, &err);
    ck_assert_int_eq(err.status, TDM_ERR_SCENE);
    ck_assert_msg(strstr(err.message, cases[c].says) || strstr(err.path, cases[c].says), "%s: %s", err.path,
                  err.message);
    dem_model_destroy(&model);
    json_decref(scene);
  }
}
END_TEST

TEST_MAIN_ROWS("seam: a contact law", {test_impact, 1}, {test_period_of_one_that_is_held, 4}, {test_many, 1},
               {test_reading, 1})
