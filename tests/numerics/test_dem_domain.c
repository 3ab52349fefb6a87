/* The box dem.domain: open, periodic, strained; and the searches by name. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/flow/flow.h"
#include "tests/test_main.h"

#define MATERIAL                                                                                 \
  "'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],'pairs':[" \
  "{'materials':['a','a'],'restitution':%g,'friction':0.4}],'gravity':[0,0,0]"

/* a gas in a box of 0.5 m that repeats; it moves as a whole, so that all of it passes the boundaries */
static rig *gas(int n, double e, const char *more) {
  rig *r = rig_make(scene_json("{" MATERIAL ",'domain':{'min':[-0.1,0,0],'max':[0.4,0.5,0.5],'x':'periodic','y':"
                               "'periodic','z':'periodic'},'particles':[{'type':'random','material':'a','count':%d,"
                               "'radius':[0.02,0.04],'region':{'min':[-0.1,0,0],'max':[0.4,0.5,0.5]},"
                               "'velocity':[3,-5,2]}]%s}",
                               e, n, more),
                    5e-5, 0, NULL);
  for (int i = 0; i < n; i++)
    r->data->state.pace[i].velocity =
        tdm_axpy(2, tdm_v3(sin(3 * i), cos(5 * i), sin(7 * i)), r->data->state.pace[i].velocity);
  r->data->state.restart = true;
  return r;
}

START_TEST(test_repeats) {
  /* momentum stays, positions stay inside, energy of an elastic gas without contacts is kept */
  rig *r = gas(100, 0.9, "");
  dem_data *d = r->data;
  tdm_vec3 p[2];
  double sum = 0, far = 0;
  long most = 0;
  for (int n = 0; n < 2; n++) {
    p[n] = tdm_v3(0, 0, 0);
    for (int i = 0; i < 100; i++) {
      p[n] = tdm_axpy(d->state.mass[i], d->state.pace[i].velocity, p[n]);
      sum += d->state.mass[i] * tdm_norm(d->state.pace[i].velocity);
    }
    for (int s = 0; n == 0 && s < 6000; s++) {
      rig_steps(r, 1);
      most = d->state.ncontact > most ? d->state.ncontact : most;
      for (int i = 0; i < 100; i++)
        for (int a = 0; a < 3; a++)
          far = fmax(far, fabs((&d->state.sphere[i].position.x)[a] - (a == 0 ? 0.15 : 0.25)));
    }
  }
  ck_assert_int_gt(most, 10);
  ck_assert(far > 0.2499 && far <= 0.25);
  ck_assert(tdm_norm(tdm_sub(p[1], p[0])) < 1e-12 * sum);
  ck_assert_int_eq(d->state.nparticle, 100);
  rig_free(r);
}
END_TEST

START_TEST(test_bits) {
  /* neither the search nor the skin changes a bit, for any integrator */
  static const char *const ways[] = {"",
                                     ",'search':'cells'",
                                     ",'search':'sweep'",
                                     ",'search':'grid'",
                                     ",'search':'all'",
                                     ",'skin':0.0005",
                                     ",'skin':0.02"};
  static const char *const integrators[] = {"", ",'integrator':'leap-frog'", ",'integrator':'stormer-verlet'",
                                            ",'integrator':'multi-step','multi_step':{'substeps':2,'mass':0.05}"};
  for (int k = 0; k < 4; k++) {
    rig *reference = NULL;
    for (size_t w = 0; w < sizeof ways / sizeof ways[0]; w++) {
      char more[256];
      snprintf(more, sizeof more, "%s%s", ways[w], integrators[k]);
      rig *r = gas(100, 0.5, more);
      rig_steps(r, 1500);
      if (!reference) {
        reference = r;
        continue;
      }
      ck_assert_msg(!memcmp(r->data->state.sphere, reference->data->state.sphere, 100 * sizeof(dem_sphere)), "%s",
                    more);
      ck_assert_mem_eq(r->data->state.pace, reference->data->state.pace, 100 * sizeof(dem_pace));
      rig_free(r);
    }
    rig_free(reference);
  }
}
END_TEST

START_TEST(test_threads) {
  /* several chunks: the same bits for any number of threads, and no reaction over chunks or boundaries is lost */
  static const char *const integrators[] = {"", ",'integrator':'multi-step','multi_step':{'substeps':2,'mass':0.02}"};
  for (int k = 0; k < 2; k++) {
    rig *r[2];
    for (int t = 0; t < 2; t++) {
      r[t] =
          rig_make(scene_json("{" MATERIAL ",'domain':{'min':[0,0,0],'max':[1,1,1],'x':'periodic','y':'periodic','z':"
                              "'periodic'},'particles':[{'type':'random','material':'a','count':4500,'radius':[0.02,"
                              "0.028],'region':{'min':[0,0,0],'max':[1,1,1]}}],'threads':%d%s}",
                              0.5, t + 1, integrators[k]),
                   5e-5, 0, NULL);
      dem_data *d = r[t]->data;
      for (int i = 0; i < 4500; i++)
        d->state.pace[i].velocity = tdm_v3(sin(3 * (double)d->state.id[i]), 5, cos((double)d->state.id[i]));
      tdm_vec3 before = {0, 0, 0}, after = {0, 0, 0};
      double sum = 0;
      for (int i = 0; i < 4500; i++) {
        before = tdm_axpy(d->state.mass[i], d->state.pace[i].velocity, before);
        sum += d->state.mass[i] * tdm_norm(d->state.pace[i].velocity);
      }
      d->state.since_sort = 960; /* so that the order is renewed on the way */
      rig_steps(r[t], 120);
      for (int i = 0; i < 4500; i++)
        after = tdm_axpy(d->state.mass[i], d->state.pace[i].velocity, after);
      ck_assert_int_gt(d->state.ncontact, 200);
      ck_assert_uint_eq(d->state.since_sort, 80);
      ck_assert_int_gt(d->lists.crossings.count, 100);
      ck_assert(tdm_norm(tdm_sub(after, before)) < 1e-12 * sum);
    }
    ck_assert_mem_eq(r[0]->data->state.sphere, r[1]->data->state.sphere, 4500 * sizeof(dem_sphere));
    ck_assert_mem_eq(r[0]->data->state.pace, r[1]->data->state.pace, 4500 * sizeof(dem_pace));
    rig_free(r[0]);
    rig_free(r[1]);
  }
}
END_TEST

START_TEST(test_verlet_1967) {
  /* its own skin and interval */
  rig *r = rig_make(scene_json("{" MATERIAL ",'search':'verlet-1967','particles':[{'type':'block','material':'a',"
                               "'radius':0.02,'count':[5,5,5],'corner':[0,0,0],'spacing':0.05}]}",
                               0.5),
                    1e-4, 0, NULL);
  ck_near(r->model->skin, 0.06, 1e-15);
  rig_steps(r, 100);
  ck_assert_uint_eq(r->data->lists.nrebuild, 1 + 4); /* at steps 21, 41, 61, 81 */
  rig_free(r);
}
END_TEST

/* two spheres that meet over a boundary (across) or in the middle of the box, a little off centre, spinning */
static void meet(bool across, const char *integrator, double rate, tdm_vec3 v[2], tdm_vec3 w[2], double *gap) {
  double x = across ? 0.95 : 0.4, y = across ? 0.05 : 0.5;
  rig *r =
      rig_make(scene_json("{" MATERIAL ",%s 'particles':["
                          "{'type':'list','material':'a','radius':0.04,'positions':[[%.17g,0.01,0]],'velocity':"
                          "[1,0,0.1],'spin':[0,0,5]},"
                          "{'type':'list','material':'a','radius':0.04,'positions':[[%.17g,0,0]],'velocity':"
                          "[%.17g,0,0]}]%s}",
                          0.6,
                          across ? rate != 0 ? "'domain':{'min':[0,-1,-1],'max':[1,1,1],'x':'periodic','strain_rate':"
                                               "[-0.5,0,0]},"
                                             : "'domain':{'min':[0,-1,-1],'max':[1,1,1],'x':'periodic'},"
                                 : "",
                          x, y, across ? -1.0 : -1.0 + rate, integrator),
               1e-5, 0, NULL);
  rig_steps(r, 3000);
  for (int i = 0; i < 2; i++) {
    v[i] = r->data->state.pace[i].velocity;
    w[i] = r->data->state.pace[i].spin;
  }
  *gap = r->data->state.sphere[0].position.x - r->data->state.sphere[1].position.x;
  if (across) /* what passed the boundary goes on with the image's velocity: as seen from particle 0 */
    *gap -= r->data->state.domain.length[0] * rint(*gap / r->data->state.domain.length[0]);
  rig_free(r);
}

static void same_meeting(const char *integrator, double rate) {
  tdm_vec3 v[2][2], w[2][2];
  double gap[2];
  for (int across = 0; across < 2; across++)
    meet(across, integrator, rate, v[across], w[across], &gap[across]);
  ck_assert(fabs(v[0][0].x - 1) > 0.5);
  ck_assert(tdm_norm(w[0][1]) > 0.1);
  for (int i = 0; i < 2; i++) {
    ck_near(v[1][i].y, v[0][i].y, 1e-8);
    ck_near(v[1][i].z, v[0][i].z, 1e-8);
    ck_near(w[1][i].z, w[0][i].z, 1e-6);
    /* a particle that passed the boundary has the velocity of its image */
    double off = v[1][i].x - v[0][i].x;
    ck_near(off - rate * rint(rate != 0 ? off / rate : 0), 0, 1e-8);
  }
  ck_near(gap[1], gap[0], 1e-9);
}

START_TEST(test_over_the_boundary) {
  same_meeting("", 0);
  same_meeting(",'integrator':'stormer-verlet'", 0);
  same_meeting(",'integrator':'leap-frog'", 0);
}
END_TEST

START_TEST(test_strained) {
  /* the length is linear in time; the image moves with the boundary */
  same_meeting("", -0.5);
  same_meeting(",'integrator':'stormer-verlet'", -0.5);
  rig *r = rig_make(scene_json("{" MATERIAL ",'domain':{'min':[-1,-1,-1],'max':[1,3,1],'y':'periodic','x':'periodic',"
                               "'strain_rate':[0.5,-0.25,0]},'particles':[]}",
                               0.5),
                    1e-3, 0, NULL);
  rig_steps(r, 500);
  ck_near(r->data->state.domain.length[0], 2.5, 1e-14);
  ck_near(r->data->state.domain.low[0], -1.25, 1e-14);
  ck_near(r->data->state.domain.length[1], 3.5, 1e-14);
  ck_near(r->data->state.domain.low[1], -0.75, 1e-14);
  rig_free(r);
}
END_TEST

START_TEST(test_squeezed) {
  /* a gas without motion in a box that shrinks from all sides touches in the end: none is lost, and its stress does
   * work on it */
  rig *r = rig_make(scene_json("{" MATERIAL ",'domain':{'min':[0,0,0],'max':[1,1,1],'x':'periodic','y':'periodic','z':"
                               "'periodic','strain_rate':[-0.5,-0.5,-0.5]},'particles':[{'type':'block','material':'a',"
                               "'radius':0.05,'count':[8,8,8],'corner':[0.0625,0.0625,0.0625],'spacing':0.125}]}",
                               0.5),
                    1e-4, 0, NULL);
  rig_steps(r, 1500);
  ck_assert_int_eq(r->data->state.nparticle, 512);
  ck_near(r->data->state.domain.length[2], 0.925, 1e-12);
  rig_steps(r, 1000); /* the outermost are pushed in by the images of their opposites */
  ck_assert_int_gt(r->data->state.ncontact, 100);
  rig_free(r);
}
END_TEST

START_TEST(test_open) {
  rig *r = rig_make(scene_json("{" MATERIAL ",'domain':{'min':[0,0,0],'max':[1,1,1],'y':'periodic'},'particles':["
                               "{'type':'block','material':'a','radius':0.05,'count':[4,4,4],'corner':[0.1,0.1,0.1],"
                               "'spacing':0.2,'velocity':[1,3,0]}]}",
                               0.5),
                    1e-3, 0, NULL);
  dem_data *d = r->data;
  rig_steps(r, 250); /* the columns at 0.7 are 0.05 before the edge, those at 0.1 at 0.35 */
  ck_assert_int_eq(d->state.nparticle, 64);
  rig_steps(r, 100);
  ck_assert_int_eq(d->state.nparticle, 48);
  ck_assert_uint_eq(d->state.ledger.left, 16);
  rig_steps(r, 1000);
  ck_assert_int_eq(d->state.nparticle, 0);
  ck_assert_uint_eq(d->state.ledger.left, 64);
  ck_assert(dem_balance_number(d) == 0 && dem_balance_mass(d) == 0);
  rig_free(r);
}
END_TEST

START_TEST(test_channels) {
  /* through the solver: the channel of what left, and a balance that closes; the guard's stop ends a window */
  json_t *json = scene_json("{" MATERIAL ",'guard':{'action':'stop','every':10,'overlap':0.01},'domain':{'min':[0,0,0],"
                            "'max':[1,1,1]},'particles':[{'type':'list','material':'a','radius':0.05,'positions':["
                            "[0.999,0.5,0.5],[0.5,0.2,0.5],[0.5,0.31,0.5]],'velocity':[1,0,0]}]}",
                            0.5);
  for (int squeeze = 0; squeeze < 2; squeeze++) {
    tdm_assignment a = {.scene = json, .time_end = 1, .dt = 1e-4, .n = 50};
    if (squeeze) {
      json_t *groups = json_object_get(json, "particles");
      json_array_append_new(groups,
                            scene_json("{'type':'list','material':'a','radius':0.05,'positions':[[0.1,0.5,0.5]],"
                                       "'velocity':[3,0,0]}"));
      json_array_append_new(groups,
                            scene_json("{'type':'list','material':'a','radius':0.05,'positions':[[0.202,0.5,0.5]]"
                                       ",'velocity':[-3,0,0]}"));
    }
    void *self = NULL;
    tdm_ready ready = {0};
    tdm_error err = {0};
    ck_assert_msg(!dem_solver_ops.create(&self, &a, &ready, NULL, &err), "%s", err.message);
    double t1 = 5e-3, values[64] = {0};
    tdm_step step = {.t1 = t1, .nstep = 50, .nsample = 1, .sample_time = &t1};
    tdm_result result = {.nload = 1, .nsample = 1, .nchannel = ready.nchannel, .channel = values};
    tdm_status status = dem_solver_ops.step(self, &step, &result, &err);
    if (squeeze) {
      ck_assert_int_eq(status, TDM_ERR_NUMERIC);
      ck_assert_ptr_nonnull(strstr(err.message, "dem.guard.overlap"));
    } else {
      ck_assert_msg(status == TDM_OK, "%s", err.message);
      int found = 0;
      for (int c = 0; c < ready.nchannel; c++) {
        bool left = !strcmp(ready.channel[c].name, "particles.left");
        bool balance = !strncmp(ready.channel[c].name, "balance.", 8);
        ck_assert(!(left && values[c] != 1) && !(balance && values[c] != 0));
        found += left + balance;
      }
      ck_assert_int_eq(found, 3);
      ck_assert(values[0] == 2);
    }
    dem_solver_ops.destroy(self);
  }
  json_decref(json);
}
END_TEST

/* load what must be refused; the error */
static tdm_error refused(const char *domain, const char *more) {
  return rig_refused(scene_json("{" MATERIAL ",'domain':{'min':[0,0,0],'max':[1,1,1]%s},'particles':[{'type':'list',"
                                "'material':'a','radius':0.1,'positions':[[0.5,0.5,0.5]]}]%s}",
                                0.5, domain, more),
                     NULL);
}

START_TEST(test_refused) {
  tdm_error err = refused(",'x':'periodic'", ",'skin':0.4");
  ck_assert_str_eq(err.path, "dem.domain");
  ck_assert(strstr(err.message, "1.2 m") && strstr(err.message, "1 m wide in x"));
  err = refused(",'x':'periodic','strain_rate':[-0.6,0,0]", "");
  ck_assert(strstr(err.message, "0.4 m at the end"));
  err = refused(",'strain_rate':[1,0,0]", "");
  ck_assert_str_eq(err.path, "dem.domain.strain_rate");
}
END_TEST

START_TEST(test_plane_across) {
  tdm_error err = refused(",'x':'periodic'", ",'bodies':[{'name':'b','material':'a','shapes':[{'type':'plane','normal':"
                                             "[0.1,0,1]}]}]");
  ck_assert(strstr(err.message, "plane of \"b\""));
}
END_TEST

TEST_MAIN("dem domain", test_repeats, test_bits, test_threads, test_verlet_1967, test_over_the_boundary, test_strained,
          test_squeezed, test_open, test_channels, test_refused, test_plane_across)
