/* Pouring: exact numbers and masses, beds at rest inside their box, order of entries, errors, stored beds. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/flow/flow.h"
#include "dem/particles/domain.h"
#include "dem/settle/pour.h"
#include "dem/settle/settle.h"
#include "tests/test_main.h"

#include <unistd.h>

#define GRAIN                                                                           \
  "'materials':[{'name':'a','density':1000,'young_modulus':1e6,'poisson_ratio':0.25}]," \
  "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}]"
#define BOX                                                                                                            \
  "'bodies':[{'name':'box','material':'a','shapes':[{'type':'box','side':'inside','size':[0.2,0.2,0.2],'open':['+z']}" \
  "]}]"
#define LOGNORMAL "'radius':{'distribution':'lognormal','median':0.01,'sigma':0.3,'min':0.006,'max':0.02}"

/* material, what comes, settle's further keys */
static json_t *pour_json(const char *entries, const char *settle) {
  return scene_json("{" GRAIN "," BOX ",'particles':[%s],'settle':{'speed':0.01%s}}", entries, settle);
}

static rig *poured(const char *entries, const char *settle) {
  rig *r = rig_make(pour_json(entries, settle), 1e-4, 0, NULL);
  dem_settled settled;
  tdm_error err = {0};
  dem_settle(r->data, NULL, &settled, &err);
  ck_assert_msg(!err.status, "%s: %s", err.path, err.message);
  ck_assert(settled.rest);
  return r;
}

static double mass_of(const dem_data *d) {
  double sum = 0;
  for (int i = 0; i < d->state.nparticle; i++)
    sum += d->state.mass[i];
  return sum;
}

/* all particles of the model are there, each the model's, in the box, without much overlap; nothing is missing */
static void complete(const rig *r) {
  const dem_data *d = r->data;
  const dem_model *m = r->model;
  ck_assert(dem_pour_over(d));
  ck_assert_int_eq(d->state.nparticle, m->nparticle);
  ck_assert(dem_balance_number(d) == 0 && dem_balance_mass(d) == 0);
  for (int i = 0; i < d->state.nparticle; i++) {
    tdm_vec3 x = d->state.sphere[i].position;
    double radius = d->state.sphere[i].radius, slack = 0.1 * radius;
    ck_assert(radius == m->radius[d->state.id[i]] && d->state.mass[i] == m->mass[d->state.id[i]]);
    ck_assert(fabs(x.x) < 0.1 - radius + slack && fabs(x.y) < 0.1 - radius + slack && x.z > radius - slack - 0.1);
    for (int j = 0; j < i; j++)
      ck_assert(tdm_norm(tdm_sub(x, d->state.sphere[j].position)) > 0.9 * (radius + d->state.sphere[j].radius));
  }
}

START_TEST(test_number) {
  const char *entry = "{'type':'poured','material':'a'," LOGNORMAL ",'count':120,'seed':2,"
                      "'region':{'min':[-0.08,-0.08,0.2],'max':[0.08,0.08,0.3]}}";
  rig *r = poured(entry, ""), *again = poured(entry, "");
  complete(r);
  ck_assert_int_eq(r->data->state.nparticle, 120);
  for (int i = 0; i < 120; i++)
    ck_assert(r->data->state.sphere[i].position.z < 0.2); /* the bed is below the region: all of them fell */
  ck_assert_mem_eq(r->data->state.sphere, again->data->state.sphere, 120 * sizeof(dem_sphere));
  ck_assert_mem_eq(r->data->state.push, again->data->state.push, 120 * sizeof(dem_push));
  rig_free(r), rig_free(again);
}
END_TEST

START_TEST(test_mass) {
  /* as much as is asked for, but for the next particle; with a number as well the masses are scaled */
  const char *region = "'region':{'min':[-0.08,-0.08,0.2],'max':[0.08,0.08,0.26]}}";
  char entry[1000];
  snprintf(entry, sizeof entry, "{'type':'poured','material':'a'," LOGNORMAL ",'total_mass':0.8,%s", region);
  rig *r = poured(entry, "");
  complete(r);
  const dem_data *d = r->data;
  json_t *radius = json_object_get(json_array_get(json_object_get(r->json, "particles"), 0), "radius");
  json_t *own = json_pack("{s:O}", "radius", radius);
  tdm_error err = {0};
  tdm_object o = tdm_object_open(own, "e", &err);
  dem_sizes sizes;
  dem_sizes_read(&o, &sizes);
  json_decref(own);
  double next = 1000 * 4.0 / 3 * M_PI * pow(dem_sizes_draw(&sizes, 1, (uint64_t)d->state.nparticle), 3);
  ck_assert_msg(mass_of(d) <= 0.8 && mass_of(d) + next > 0.8, "%g and %g", mass_of(d), next);
  rig_free(r);

  snprintf(entry, sizeof entry, "{'type':'poured','material':'a'," LOGNORMAL ",'count':60,'total_mass':0.5,%s", region);
  r = poured(entry, "");
  complete(r);
  ck_assert_int_eq(r->data->state.nparticle, 60);
  ck_relative(mass_of(r->data), 0.5, 1e-12);
  rig_free(r);
}
END_TEST

START_TEST(test_entries) {
  /* poured entries come after the others and one after the other, in a body's axes if asked; block and list have
   * distributions too */
  rig *r = poured("{'type':'poured','material':'a','radius':0.01,'count':30,'body':'box','velocity':[0,0,-1],"
                  "'region':{'min':[-0.08,-0.08,0.15],'max':[0.08,0.08,0.18]}},"
                  "{'type':'block','material':'a','radius':[0.005,0.01],'count':[4,3,2],'corner':[-0.05,-0.05,-0.08]},"
                  "{'type':'poured','material':'a','radius':0.012,'count':20,'mass':0.02,"
                  "'region':{'min':[-0.08,-0.08,0.15],'max':[0.08,0.08,0.2]}},"
                  "{'type':'list','material':'a','radius':{'distribution':'list','radii':[0.004,0.005],"
                  "'shares':[1,1]},'positions':[[0.05,0.05,-0.05],[0.05,0.07,-0.05],[0.05,0.05,0],[0.05,0.07,0]]}",
                  "");
  complete(r);
  const dem_model *m = r->model;
  ck_assert_int_eq(m->nparticle, 30 + 24 + 20 + 4);
  const int first[] = {28, 0, 58, 24}, count[] = {30, 24, 20, 4};
  for (int g = 0; g < 4; g++) {
    ck_assert_int_eq(m->group[g].first, first[g]);
    ck_assert_int_eq(m->group[g].count, count[g]);
  }
  ck_near(m->radius[28], 0.01, 0);
  ck_near(m->mass[58], 0.02, 0);
  int different = 0;
  for (int i = 1; i < 24; i++) {
    ck_assert(m->radius[i] >= 0.005 && m->radius[i] <= 0.01);
    different += m->radius[i] != m->radius[0];
  }
  ck_assert_int_eq(different, 23);
  for (int i = 24; i < 28; i++)
    ck_assert(m->radius[i] == 0.004 || m->radius[i] == 0.005);
  rig_free(r);
}
END_TEST

START_TEST(test_stored) {
  char name[64], settle[128];
  snprintf(name, sizeof name, "/tmp/test_dem_pour.%ld.bed", (long)getpid());
  snprintf(settle, sizeof settle, ",'store':'%s'", name);
  const char *entry = "{'type':'poured','material':'a','radius':[0.008,0.012],'count':120,%s"
                      "'region':{'min':[-0.08,-0.08,0.15],'max':[0.08,0.08,0.19]}}";
  char entries[400];
  snprintf(entries, sizeof entries, entry, "");
  rig *wrote = poured(entries, settle), *read = poured(entries, settle);
  complete(read);
  for (int part = 0; part < 5; part++) {
    size_t n = (size_t)wrote->data->state.nparticle;
    ck_assert_mem_eq(wrote->data->state.id, read->data->state.id, n * sizeof(uint64_t));
    ck_assert_mem_eq(wrote->data->state.sphere, read->data->state.sphere, n * sizeof(dem_sphere));
    ck_assert_mem_eq(wrote->data->state.pace, read->data->state.pace, n * sizeof(dem_pace));
    rig_steps(wrote, 50);
    rig_steps(read, 50);
  }
  /* the way of pouring decides the bed */
  snprintf(entries, sizeof entries, entry, "'seed':4,");
  rig *other = rig_make(pour_json(entries, settle), 1e-4, 0, NULL);
  dem_settled settled;
  tdm_error err = {0};
  dem_settle(other->data, NULL, &settled, &err);
  ck_assert_str_eq(err.path, "dem.settle.store");
  unlink(name);
  rig_free(wrote), rig_free(read), rig_free(other);
}
END_TEST

START_TEST(test_full) {
  /* more than there is room for ends with an error that says how many there were */
  rig *r = rig_make(pour_json("{'type':'list','material':'a','radius':0.01,'positions':[]},"
                              "{'type':'poured','material':'a','radius':0.04,'count':50,"
                              "'region':{'min':[-0.1,-0.1,0],'max':[0.1,0.1,0.1]}}",
                              ",'max_time':0.5"),
                    1e-4, 0, NULL);
  dem_settled settled;
  tdm_error err = {0};
  ck_assert_int_eq(dem_settle(r->data, NULL, &settled, &err), TDM_ERR_SCENE);
  ck_assert_str_eq(err.path, "dem.particles[1]");
  int some = 0;
  ck_assert_int_eq(sscanf(err.message, "only %d of 50", &some), 1);
  ck_assert_int_eq(some, r->data->state.nparticle);
  ck_assert(some >= 8 && some < 50);
  rig_free(r);
}
END_TEST

START_TEST(test_ready) {
  /* the solver starts with the poured bed; sources and their particles' ids come after it */
  json_t *json = scene_json(
      "{" GRAIN "," BOX ",'settle':{'speed':0.01},'particles':[{'type':'poured','material':'a',"
      "'radius':0.012,'count':40,'region':{'min':[-0.08,-0.08,0.12],'max':[0.08,0.08,0.16]}}],"
      "'sources':[{'name':'s','material':'a','radius':0.01,'rate':1,'position':[0,0,0.3]}],'guard':{'overlap':1}}");
  tdm_assignment a = {.scene = json, .time_end = 1, .dt = 1e-4, .n = 1};
  void *self = NULL;
  tdm_ready ready = {0};
  tdm_error err = {0};
  ck_assert_msg(!dem_solver_ops.create(&self, &a, &ready, NULL, &err), "%s: %s", err.path, err.message);
  ck_assert_int_eq(ready.nwarning, 0);
  ck_assert_int_eq((int)json_integer_value(json_object_get(json_object_get(ready.report, "fill"), "number")), 40);
  ck_assert_str_eq(ready.channel[0].name, "particles.count");
  ck_near(ready.initial[0], 41.0, 0);
  int nbalance = 0;
  for (int c = 0; c < ready.nchannel; c++)
    if (strncmp(ready.channel[c].name, "balance.", 8) == 0) {
      ck_near(ready.initial[c], 0.0, 0);
      nbalance++;
    }
  ck_assert_int_eq(nbalance, 2);
  dem_solver_ops.destroy(self);
  json_decref(json);
}
END_TEST

/* smallest gap between two particles just poured, as a share of the sum of their radii; every one is in its place */
static double first_layer(const char *section, rig **out) {
  rig *r = rig_make(scene_json("{" GRAIN ",'settle':{},%s,'particles':[{'type':'poured','material':'a','radius':"
                               "[0.02,0.03],'count':200,'acceleration':[0,0,-3],"
                               "'region':{'min':[-0.1,-0.1,0],'max':[0.91,0.4,0.3]}}]}",
                               section),
                    1e-4, 0, NULL);
  dem_pour pour = {0};
  tdm_error err = {0};
  for (int k = 0; k < 2; k++) { /* two at once: the second finds those of the first */
    pour.next = 0;
    ck_assert(!dem_pour_now(r->data, &pour, 0, &err));
  }
  double least = INFINITY;
  for (int i = 0; i < r->data->state.nparticle; i++) {
    const dem_sphere *a = &r->data->state.sphere[i];
    ck_near(r->data->state.drive[i].velocity.z, -3, 1e-12);
    for (int j = 0; j < i; j++) {
      const dem_sphere *b = &r->data->state.sphere[j];
      least = fmin(least, tdm_norm(dem_between(r->data, a->position, b->position)) / (a->radius + b->radius) - 1);
    }
  }
  *out = r;
  return least;
}

START_TEST(test_images) {
  /* the region reaches round the box: places are free of the images of others too */
  rig *r;
  double gap = first_layer("'domain':{'min':[0,0,-1],'max':[0.9,0.5,1],'x':'periodic'}", &r);
  ck_assert_int_gt(r->data->state.nparticle, 80);
  ck_assert_msg(gap >= -1e-12, "%g", gap);
  rig_free(r);
}
END_TEST

START_TEST(test_plane) {
  /* in two dimensions all are in the plane, where they have room */
  rig *r;
  double gap = first_layer("'dimension':2,'plane':'xz','plane_at':0.7", &r);
  ck_assert_int_gt(r->data->state.nparticle, 20);
  ck_assert_msg(gap >= -1e-12, "%g", gap);
  for (int i = 0; i < r->data->state.nparticle; i++)
    ck_assert(r->data->state.sphere[i].position.y == 0.7);
  rig_free(r);
}
END_TEST

START_TEST(test_errors) {
  static const struct {
    const char *entry, *path, *says;
  } rows[] = {
      {"'radius':0.01,'region':{'min':[0,0,0],'max':[1,1,1]}", "dem.particles[0].count", "total_mass"},
      {"'radius':0.01,'total_mass':1e-6,'region':{'min':[0,0,0],'max':[1,1,1]}", "dem.particles[0].total_mass",
       "less than the first"},
      {"'radius':0.01,'count':1", "dem.particles[0].region", "missing"},
      {"'radius':0.01,'count':1,'region':{'min':[0,0,0],'max':[1,0.01,1]}", "dem.particles[0].region", "smaller"},
      {"'radius':0.01,'count':-1,'region':{'min':[0,0,0],'max':[1,1,1]}", "dem.particles[0].count", "at least 0"},
      {"'radius':1e-6,'total_mass':1e6,'region':{'min':[0,0,0],'max':[1,1,1]}", "dem.particles[0]", "at most"},
      {"'radius':0.01,'count':1,'region':{'min':[0,0,0],'max':[1,1,1]}", "dem.settle", "missing"},
      {"'radius':0.01,'count':1,'fixed':true,'region':{'min':[0,0,0],'max':[1,1,1]}", "dem.particles[0].fixed", "fall"},
      {"'radius':0.01,'count':1,'region':{'min':[0,0,0],'max':[1,1,1]}}],'settle':{},'start':'x','bodies':[],"
       "'sinks':[{'name':'s','type':'plane','point':[0,0,0],'normal':[0,0,1]",
       "dem.start", "poured"},
  };
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    tdm_error err =
        rig_refused(scene_json("{" GRAIN ",'particles':[{'type':'poured','material':'a',%s}]}", rows[i].entry), NULL);
    ck_assert_str_eq(err.path, rows[i].path);
    ck_assert_msg(strstr(err.message, rows[i].says) != NULL, "%s: %s", err.path, err.message);
  }
}
END_TEST

TEST_MAIN("dem pour", test_number, test_mass, test_entries, test_stored, test_full, test_ready, test_images, test_plane,
          test_errors)
