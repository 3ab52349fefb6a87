/* Sources: when and where particles are made, and when they wait. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_flow_support.h"

#include "dem/flow/free_space.h"
#include "dem/search/search.h"
#include "protocol/base/log.h"
#include "protocol/math/random.h"
#include "tests/test_main.h"

#include <unistd.h>

START_TEST(test_creation_times) {
  /* particle k is due at start + k/rate, on no grid; it appears at the next step, where free flight has brought it */
  const double dt = 1e-3, start = 0.0123, rate = 37.3;
  rig *r = rig_make(scene_json("{" GRAIN ",'sources':[{'name':'s','material':'a','radius':0.01,'mass':0.2,"
                               "'rate':%.17g,'start':%.17g,'end':0.8,'position':[1,2,3],'velocity':[3,-1,0.5]}]}",
                               rate, start),
                    dt, 0, NULL);
  begin(r);
  for (long k = 1; k <= 1000; k++) {
    steps(r, NULL, 1);
    double t = (double)k * dt;
    int expected = t < start ? 0 : (int)floor((fmin(t, 0.8) - start) * rate) + 1;
    ck_assert_int_eq(r->data->state.nparticle, expected);
    for (int i = 0; i < expected; i++) {
      double s = t - (start + i / rate);
      ck_near(r->data->state.sphere[i].position.x, 1 + 3 * s, 1e-12);
      ck_near(r->data->state.sphere[i].position.z, 3 + 0.5 * s - 0.5 * 9.81 * s * s, 1e-11);
      ck_near(r->data->state.pace[i].velocity.z, 0.5 - 9.81 * s, 1e-11);
    }
  }
  ck_assert_int_eq(r->data->state.nparticle, 30); /* 0.7877 s * 37.3/s = 29.4, and the first */
  ck_near(r->data->state.mass[29], 0.2, 0);
  ck_assert_uint_eq(r->data->state.id[29], 29);
  rig_free(r);

  /* times on the grid of steps: exactly there, in spite of round-off; the first at the start; count ends it */
  r = rig_make(scene_json("{" GRAIN ",'gravity':[0,0,0],'sources':[{'name':'s','material':'a','radius':0.01,"
                          "'rate':10,'count':4,'position':[0,0,0],'velocity':[1,0,0]}]}"),
               dt, 0, NULL);
  begin(r);
  ck_assert_int_eq(r->data->state.nparticle, 1);
  for (long k = 1; k <= 600; k++) {
    steps(r, NULL, 1);
    ck_assert_int_eq(r->data->state.nparticle, k < 300 ? 1 + (int)k / 100 : 4);
  }
  for (int i = 0; i < 4; i++)
    ck_near(r->data->state.sphere[i].position.x, 0.6 - 0.1 * i, 1e-12);
  rig_free(r);
}
END_TEST

START_TEST(test_mass_rate) {
  /* radii and places from the seed; as much mass as asked for, to one particle */
  rig *r = rig_make(scene_json("{" GRAIN ",'gravity':[0,0,0],'sources':[{'name':'s','material':'a',"
                               "'radius':[0.01,0.02],'mass_rate':5,'seed':4,'velocity':[0,0,-2],"
                               "'region':{'min':[-0.5,-0.5,1],'max':[0.5,0.5,1]}}]}"),
                    1e-3, 0, NULL);
  begin(r);
  steps(r, NULL, 1000);
  dem_data *d = r->data;
  double most = 1000 * 4.0 / 3 * M_PI * 8e-6, mean = 0, x = 0;
  ck_assert_int_gt(d->state.nparticle, 200);
  for (int i = 0; i < d->state.nparticle; i++) {
    ck_assert(d->state.sphere[i].radius >= 0.01 && d->state.sphere[i].radius <= 0.02 &&
              fabs(d->state.sphere[i].position.x) <= 0.5);
    ck_relative(d->state.mass[i], 1000 * 4.0 / 3 * M_PI * pow(d->state.sphere[i].radius, 3), 1e-12);
    mean += d->state.sphere[i].radius / d->state.nparticle;
    x += d->state.sphere[i].position.x / d->state.nparticle;
  }
  ck_near(mean, 0.015, 1e-3);
  ck_near(x, 0, 0.05);
  ck_assert(d->state.source[0].made_mass >= 5 && d->state.source[0].made_mass - 5 <= most);
  rig_free(r);
}
END_TEST

START_TEST(test_limits) {
  /* until a number or a mass is reached, whichever is first; a mass is never exceeded, and the next would exceed it */
  static const char *const limits[] = {"'count':37,'total_mass':100", "'count':1000,'total_mass':0.6",
                                       "'total_mass':0.6"};
  for (int k = 0; k < 3; k++) {
    rig *r = rig_make(scene_json("{" GRAIN ",'gravity':[0,0,0],'sources':[{'name':'s','material':'a','rate':900,"
                                 "'radius':{'distribution':'lognormal','median':0.01,'sigma':0.3,'min':0.005,"
                                 "'max':0.03},%s,'seed':3,'region':{'min':[0,0,0],'max':[1,1,1]}}]}",
                                 limits[k]),
                      1e-3, 0, NULL);
    begin(r);
    many_steps(r, 1000);
    const dem_data *d = r->data;
    const dem_source *s = &r->model->source[0];
    double sum = 0, next = 1000 * 4.0 / 3 * M_PI * pow(dem_sizes_draw(&s->sizes, 3, (uint64_t)d->state.nparticle), 3);
    for (int i = 0; i < d->state.nparticle; i++) {
      ck_assert(d->state.sphere[i].radius == dem_sizes_draw(&s->sizes, 3, (uint64_t)i));
      sum += d->state.mass[i];
    }
    ck_assert_uint_eq(d->state.source[0].due, d->state.source[0].made);
    if (k == 0)
      ck_assert_int_eq(d->state.nparticle, 37);
    else
      ck_assert_msg(sum <= 0.6 && sum + next > 0.6, "%.17g and %g", sum, next);
    rig_free(r);
  }
  /* ten of 0.1 kg are 1 kg, in spite of round-off */
  rig *r = rig_make(scene_json("{" GRAIN ",'gravity':[0,0,0],'sources':[{'name':'s','material':'a','radius':0.01,"
                               "'mass':0.1,'mass_rate':100,'total_mass':1,'position':[0,0,0],'velocity':[50,0,0]}]}"),
                    1e-3, 0, NULL);
  begin(r);
  steps(r, NULL, 100);
  ck_assert_int_eq(r->data->state.nparticle, 10);
  rig_free(r);
}
END_TEST

START_TEST(test_room) {
  /* the cells find what a look at all particles finds, sizes 1 : 20, places outside the box's rim included */
  json_t *json = scene_json("{" GRAIN "," FLOOR ",'gravity':[0,0,0],'sources':[{'name':'s','material':'a',"
                            "'rate':1e5,'count':1500,'radius':{'distribution':'lognormal','median':0.02,'sigma':0.8,"
                            "'min':0.01,'max':0.2},'region':{'min':[-1,-1,0.01],'max':[1,1,2]}}]}");
  rig *r = rig_make(json, 1e-3, 0, NULL);
  begin(r);
  steps(r, NULL, 60);
  const dem_data *d = r->data;
  ck_assert_int_gt(d->state.nparticle, 1000);
  dem_free_space room;
  tdm_vec3 low = {-0.6, -0.7, 0}, high = {0.8, 0.3, 1.5};
  ck_assert_int_eq(dem_free_space_open(&room, d, low, high, 0.05), TDM_OK);
  int frees = 0;
  for (uint64_t k = 0; k < 20000; k++) {
    double radius = 0.05 * tdm_random(1, k, 0), u[3];
    for (uint64_t a = 0; a < 3; a++)
      u[a] = tdm_random(1, k, a + 1);
    tdm_vec3 x = tdm_v3(low.x + 1.4 * u[0], low.y + u[1], low.z + 1.5 * u[2]);
    bool free = x.z >= radius;
    for (int i = 0; i < d->state.nparticle; i++) {
      double sum = radius + d->state.sphere[i].radius;
      tdm_vec3 c = tdm_sub(x, d->state.sphere[i].position);
      free = free && !(tdm_dot(c, c) < sum * sum);
    }
    ck_assert_int_eq(dem_free_space_free(&room, d, x, radius), free);
    frees += free;
  }
  ck_assert(frees > 2000 && frees < 18000);
  dem_free_space_close(&room);
  rig_free(r);
}
END_TEST

START_TEST(test_many) {
  /* more than one chunk, whose particles are sorted by place, with a sink: balances, the same again, no overlap made */
  rig *r[2];
  for (int k = 0; k < 2; k++) {
    r[k] = rig_make(scene_json("{" GRAIN ",'skin':0.01,'gravity':[0,0,-1],'sources':[{'name':'s','material':'a',"
                               "'rate':50000,'count':6000,'radius':[0.005,0.02],'velocity':[0,0,-0.5],"
                               "'region':{'min':[-1,-1,0],'max':[1,1,0.5]}}],'sinks':[{'name':'out','type':'plane',"
                               "'point':[0,0,-0.02],'normal':[0,0,1],'classes':[0.01]}]}"),
                    5e-4, 0, NULL);
    begin(r[k]);
    many_steps(r[k], 450);
  }
  const dem_data *d = r[0]->data;
  ck_assert_int_gt(d->state.nparticle, DEM_CHUNK);
  ck_assert_uint_gt(d->state.sink[0].removed, 500);
  ck_assert_uint_gt(d->state.sink[0].class_removed[0], 100);
  bool ascend = true;
  for (int i = 1; i < d->state.nparticle; i++)
    ascend = ascend && d->state.id[i] > d->state.id[i - 1];
  ck_assert(!ascend);
  same(d, r[1]->data);
  ck_assert_mem_eq(d->state.sink, r[1]->data->state.sink, sizeof *d->state.sink);
  rig_free(r[0]), rig_free(r[1]);
}
END_TEST

START_TEST(test_search_follows_sizes) {
  /* grains rain on a boulder: few of them are searched with cells, many with a grid a size; the bits are the same */
  static const char *const search[] = {"", ",'search':'cells'", ",'search':'grid'"};
  rig *r[3];
  for (int k = 0; k < 3; k++) {
    r[k] = rig_make(scene_json("{" GRAIN "," FLOOR ",'particles':[{'type':'list','material':'a','radius':0.2,"
                               "'positions':[[0,0,0.2]]}],'sources':[{'name':'rain','material':'a','rate':10000,"
                               "'radius':0.02,'count':300,'region':{'min':[-1,-1,0.5],'max':[1,1,1.5]},"
                               "'velocity':[0,0,-1]}]%s}",
                               search[k]),
                    2e-4, 0, NULL);
    begin(r[k]);
  }
  ck_assert_str_eq(dem_search_name(r[0]->data->work.search), "cells");
  long contacts = 0;
  for (int part = 0; part < 12; part++) {
    for (int k = 0; k < 3; k++)
      many_steps(r[k], 200);
    same(r[0]->data, r[1]->data);
    same(r[0]->data, r[2]->data);
    contacts += r[0]->data->state.ncontact;
  }
  ck_assert_int_gt(r[0]->data->state.nparticle, 250);
  ck_assert_int_gt(contacts, 20);
  ck_assert_str_eq(dem_search_name(r[0]->data->work.search), "grid");
  ck_assert_str_eq(dem_search_name(r[1]->data->work.search), "cells");
  for (int k = 0; k < 3; k++)
    rig_free(r[k]);
}
END_TEST

START_TEST(test_waiting) {
  /* the place of the source is taken until the particle there moves off; the queue is kept, and told */
  char *text = NULL;
  size_t size;
  FILE *log = open_memstream(&text, &size);
  tdm_log_open(log, "dem");
  rig *r = rig_make(scene_json("{" GRAIN ",'gravity':[0,0,0],'particles':[{'type':'list','material':'a',"
                               "'radius':0.02,'positions':[[0,0,0]]}],'sources':[{'name':'feed','material':'a',"
                               "'radius':0.01,'rate':10,'position':[0.01,0,0],'velocity':[1,0,0]}]}"),
                    1e-3, 0, NULL);
  dem_data *d = r->data;
  begin(r);
  steps(r, NULL, 250);
  ck_assert_int_eq(d->state.nparticle, 1);
  ck_assert_uint_eq(d->state.source[0].made, 0);
  ck_assert_uint_eq(d->state.source[0].due, 3);
  ck_assert_ptr_nonnull(strstr(text, "event=source_waits.feed t=0 message=\"the source 'feed' waits with particle 0"));
  ck_assert_ptr_null(strstr(text, "source_resumes"));
  d->state.sphere[0].position.y = 1;
  steps(r, NULL, 1);
  ck_assert_uint_eq(d->state.source[0].made, 1);
  ck_near(d->state.sphere[1].position.x, 0.01, 0); /* where the source is: it waited */
  ck_assert_ptr_nonnull(strstr(text, "source_resumes t=0.251 source=feed particle=0"));
  steps(r, NULL, 50); /* one diameter, 20 ms, apart */
  ck_assert_uint_eq(d->state.source[0].made, 3);
  ck_near(d->state.sphere[1].position.x - d->state.sphere[2].position.x, 0.02, 1.001e-3);
  ck_assert(d->state.sphere[1].position.x - d->state.sphere[2].position.x >= 0.02);
  steps(r, NULL, 700);
  ck_assert_uint_eq(d->state.source[0].made, 11);
  ck_assert_uint_eq(d->state.source[0].due, 11);
  ck_near(d->state.sphere[11].position.x, 0.011, 1e-12); /* on time again: t = 1.001 */
  tdm_log_open(NULL, "dem");
  fclose(log);
  free(text);
  rig_free(r);
}
END_TEST

START_TEST(test_waits_for_walls) {
  rig *r = rig_make(scene_json("{" GRAIN "," FLOOR ",'sources':[{'name':'feed','material':'a','radius':0.01,"
                               "'rate':10,'position':[0,0,0.009]}]}"),
                    1e-3, 0, NULL);
  begin(r);
  steps(r, NULL, 250);
  ck_assert_int_eq(r->data->state.nparticle, 0);
  ck_assert_uint_eq(r->data->state.source[0].due, 3);
  rig_free(r);
}
END_TEST

START_TEST(test_waits_for_meshes) {
  /* a triangle at z = 0: near its middle there is no room on either side, above and below it there is */
  char file[] = "/tmp/test_dem_flow_XXXXXX";
  FILE *f = fdopen(mkstemp(file), "w");
  fputs("solid t\nfacet normal 0 0 1\nouter loop\nvertex -1 -1 0\nvertex 1 -1 0\nvertex 0 1 0\nendloop\nendfacet\n"
        "endsolid t\n",
        f);
  fclose(f);
  static const struct {
    double z;
    int made;
  } rows[] = {{0.009, 0}, {-0.009, 0}, {0.011, 1}, {-0.011, 1}};
  for (size_t k = 0; k < sizeof rows / sizeof rows[0]; k++) {
    rig *r = rig_make(scene_json("{" GRAIN ",'gravity':[0,0,0],'bodies':[{'name':'m','material':'a','shapes':[{'type':"
                                 "'mesh','file':'%s'}]}],'sources':[{'name':'feed','material':'a','radius':0.01,"
                                 "'rate':10,'count':1,'position':[0,0,%g]}]}",
                                 file, rows[k].z),
                      1e-3, 0, NULL);
    begin(r);
    steps(r, NULL, 20);
    ck_assert_int_eq(r->data->state.nparticle, rows[k].made);
    rig_free(r);
  }
  remove(file);
}
END_TEST

START_TEST(test_relative_velocity) {
  tdm_assigned_body cube = {.name = "cube", .mass = 10, .state = state_at(1, 0, 0)};
  cube.state.twist.velocity = tdm_v3(0.25, 0, 0);
  rig *r = rig_make(scene_json("{" GRAIN ",'gravity':[0,0,0],'bodies':[{'name':'cube','material':'a','shapes':"
                               "[{'type':'box','side':'outside','size':[0.2,0.2,0.2]}]}],"
                               "'sources':[{'name':'s','material':'a','radius':0.01,'rate':10,'position':[0,0,0],"
                               "'velocity':[2,0,0],'relative_to':{'body':'cube','factor':-1}},"
                               "{'name':'with','material':'a','radius':0.01,'rate':10,'position':[0,1,0],"
                               "'velocity':[0,1,0],'relative_to':{'body':'cube'}}]}"),
                    1e-3, 1, &cube);
  begin(r);
  ck_near(r->data->state.pace[0].velocity.x, 1.75, 1e-15);
  ck_near(r->data->state.pace[1].velocity.x, 0.25, 1e-15);
  tdm_state next = cube.state;
  for (int k = 0; k < 100; k++) { /* accelerates: 0.25 + 3 t in the step to t */
    tdm_state now = next;
    next.pose.position.x += 1e-3 * (0.25 + 3e-3 * (k + 1));
    dem_path path = dem_path_make(&now, &next, 1e-3, TDM_LINEAR);
    steps(r, &path, 1);
  }
  ck_assert_int_eq(r->data->state.nparticle, 4);
  ck_near(r->data->state.pace[2].velocity.x, 2 - 0.55, 1e-9);
  ck_near(r->data->state.pace[3].velocity.x, 0.55, 1e-9);
  ck_near(r->data->state.pace[3].velocity.y, 1, 0);
  rig_free(r);
}
END_TEST

TEST_MAIN("dem sources", test_creation_times, test_mass_rate, test_limits, test_room, test_many,
          test_search_follows_sizes, test_waiting, test_waits_for_walls, test_waits_for_meshes, test_relative_velocity)
