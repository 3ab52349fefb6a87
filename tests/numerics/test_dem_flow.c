/* Sources and sinks together: removal, classes of sizes, balances, copies. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_flow_support.h"

#include "dem/bodies/walls.h"
#include "tests/test_main.h"

#include <math.h>

START_TEST(test_classes) {
  /* a sink's classes hold what the sink got, sorted by the radii of those that came */
  rig *r = rig_make(
      scene_json("{" GRAIN ",'sources':[{'name':'s','material':'a','rate':3000,'seed':5,'velocity':[0,0,-1],'radius':"
                 "{'distribution':'list','radii':[0.002,0.003,0.004,0.006],'shares':[4,3,2,1]},"
                 "'region':{'min':[0,0,1],'max':[1,1,1.1]}}],"
                 "'sinks':[{'name':'low','type':'plane','point':[0,0,0.8],'normal':[0,0,1],"
                 "'classes':[0.001,0.003,0.005]},"
                 "{'name':'fine','type':'box','min':[0,0,0.9],'max':[0.5,1,0.95],'classes':[0.0025]}]}"),
      1e-3, 0, NULL);
  begin(r);
  many_steps(r, 600);
  const dem_data *d = r->data;
  const dem_source *s = &r->model->source[0];
  uint64_t came[4] = {0}, out[4] = {0}; /* below 1, 3, 5 mm, and above: an edge belongs to the class above it */
  for (uint64_t k = 0; k < d->state.source[0].made; k++) {
    double radius = dem_sizes_draw(&s->sizes, 5, k);
    came[radius < 0.003 ? 1 : radius < 0.005 ? 2 : 3]++;
  }
  for (int i = 0; i < d->state.nparticle; i++)
    came[d->state.sphere[i].radius < 0.003 ? 1 : d->state.sphere[i].radius < 0.005 ? 2 : 3]--;
  for (int k = 0; k < 2; k++) {
    const dem_sink_state *sink = &d->state.sink[k];
    uint64_t number = 0;
    double mass = 0;
    for (int c = 0; c <= DEM_EDGES_MAX; c++) {
      number += sink->class_removed[c];
      mass += sink->class_mass[c];
    }
    ck_assert_uint_gt(number, 200);
    ck_assert_uint_eq(number, sink->removed);
    ck_relative(mass, sink->mass, 1e-12);
  }
  const dem_sink_state *low = &d->state.sink[0], *fine = &d->state.sink[1];
  ck_assert_uint_eq(low->class_removed[0], 0);
  const double small = 1000 * 4.0 / 3 * M_PI * 8e-9, large = small * 27;
  ck_relative(low->class_mass[1], (double)low->class_removed[1] * small, 1e-10);
  ck_relative(low->class_mass[3], (double)low->class_removed[3] * large, 1e-10);
  ck_relative(fine->class_mass[0], (double)fine->class_removed[0] * small, 1e-10);
  for (int c = 1; c < 4; c++)
    out[c] = low->class_removed[c];
  ck_assert_uint_eq(came[1], out[1] + fine->class_removed[0]);
  ck_assert_uint_eq(came[2] + came[3], out[2] + out[3] + fine->class_removed[1]);
  rig_free(r);
}
END_TEST

/* a stream of drops on a floor, with one sink */
static rig *stream(const char *sink, const char *skin) {
  return rig_make(scene_json("{" GRAIN "," FLOOR ",'particles':[{'type':'list','material':'a','radius':0.02,"
                             "'positions':[[1,0,0.02],[1,0.03,0.05]]}],"
                             "'sources':[{'name':'rain','material':'a','radius':[0.01,0.02],'rate':200,'seed':2,"
                             "'region':{'min':[0,0,0.3],'max':[0.2,0.2,0.4]},'velocity':[0,0,-1]},"
                             "{'name':'jet','material':'a','radius':0.01,'rate':30,'position':[-1,0,0.1],"
                             "'velocity':[4,0,1]}],'sinks':[%s]%s}",
                             sink, skin),
                  1e-4, 0, NULL);
}

START_TEST(test_balances) {
  static const char *const sinks[] = {
      "{'name':'out','type':'after_contact','body':'floor'}",
      "{'name':'out','type':'box','min':[-1,-1,-1],'max':[0.1,1,0.2]}",
      "{'name':'out','type':'plane','point':[0,0,0.06],'normal':[0,0,1]}",
      "{'name':'out','type':'after_contact','body':'floor'},"
      "{'name':'side','type':'plane','point':[0.15,0,0],'normal':[-1,0,0]}",
  };
  for (int k = 0; k < 4; k++) {
    rig *r = stream(sinks[k], ""), *brute = stream(sinks[k], ",'skin':50"), *thin = stream(sinks[k], ",'skin':2e-4");
    begin(r), begin(brute), begin(thin);
    for (int part = 0; part < 10; part++) {
      steps(r, NULL, 300);
      steps(brute, NULL, 300);
      steps(thin, NULL, 300);
      same(r->data, brute->data); /* whatever the lists, also when they are made shorter in place */
      same(r->data, thin->data);
    }
    dem_data *d = r->data;
    ck_assert_uint_gt(d->state.ledger.removed, 5);
    ck_assert_int_gt(d->state.nparticle, 2);
    ck_assert_uint_eq(d->state.ledger.created, d->state.source[0].made + d->state.source[1].made + 2);
    ck_assert_uint_ge(d->state.source[0].made, 55);
    rig_free(r), rig_free(brute), rig_free(thin);
  }
}
END_TEST

START_TEST(test_after_contact) {
  /* a particle is there until its rebound has ended, and has then the speed of a free rebound */
  const char *scene = "{" GRAIN "," FLOOR ",'gravity':[0,0,0],'sources':[{'name':'s','material':'a','radius':0.01,"
                      "'rate':1,'count':1,'position':[0,0,0.02],'velocity':[0.1,0,-1]}]%s}";
  rig *r =
      rig_make(scene_json(scene, ",'sinks':[{'name':'out','type':'after_contact','body':'floor'}]"), 1e-5, 0, NULL);
  rig *stays = rig_make(scene_json(scene, ""), 1e-5, 0, NULL);
  begin(r), begin(stays);
  bool touched = false;
  int k = 0;
  for (; r->data->state.nparticle == 1 && k < 10000; k++) {
    same(r->data, stays->data);
    steps(r, NULL, 1);
    steps(stays, NULL, 1);
    touched = touched || stays->data->state.ncontact > 0;
    ck_assert_int_eq(r->data->state.nparticle, !(touched && stays->data->state.ncontact == 0));
  }
  ck_assert(touched && k < 10000);
  ck_relative(stays->data->state.pace[0].velocity.z, 0.5, 2e-3);
  ck_assert_uint_eq(r->data->state.sink[0].removed, 1);
  ck_assert(r->data->state.sink[0].mass == stays->data->state.mass[0]);
  rig_free(r), rig_free(stays);
}
END_TEST

/* is x, in a body's axes, in the zone number k of the test below? */
static bool expected(int k, tdm_vec3 x) {
  const double r = hypot(x.x - 0.1, x.y), angle = atan2(x.y, x.x - 0.1);
  if (k == 0) /* from 2.5 rad over pi to 4 rad */
    return r >= 0.2 && r <= 0.5 && x.z >= -0.1 && x.z <= 0.3 && (angle >= 2.5 || angle <= 4 - 2 * M_PI);
  if (k == 1) /* about x: angles count from y */
    return hypot(x.y, x.z) <= 0.4 && x.x >= -0.5 && x.x <= 0 && fabs(atan2(x.z, x.y)) <= 0.3;
  if (k == 2)
    return hypot(x.x, x.y) >= 0.3 && hypot(x.x, x.y) <= 0.6 && fabs(x.z) <= 0.2;
  return k == 3 ? fabs(x.x) <= 0.2 && fabs(x.y) <= 0.3 && fabs(x.z) <= 0.4 : x.x + x.y < 0.1;
}

START_TEST(test_moving_zones) {
  /* zones in the axes of a body that turns and moves take what is in them, and nothing else */
  static const char *const sinks[] = {
      "'type':'sector','point':[0.1,0,0],'radii':[0.2,0.5],'height':[-0.1,0.3],'angle':[2.5,4]",
      "'type':'sector','axis':[2,0,0],'radii':[0,0.4],'height':[-0.5,0],'angle':[-0.3,0.3]",
      "'type':'sector','radii':[0.3,0.6],'height':[-0.2,0.2]",
      "'type':'box','min':[-0.2,-0.3,-0.4],'max':[0.2,0.3,0.4]",
      "'type':'plane','point':[0.1,0,3],'normal':[1,1,0]",
  };
  for (int k = 0; k < 5; k++) {
    rig *r = rig_make(scene_json("{" GRAIN
                                 ",'gravity':[0,0,0],'bodies':[{'name':'b','material':'a','position':[0.2,-0.1,0.1],"
                                 "'orientation':{'euler313':[0.4,0.7,-1.1]},'shapes':[],"
                                 "'motion':{'velocity':[1,2,-1],'angular_velocity':[3,-2,5]}}],"
                                 "'particles':[{'type':'random','material':'a','radius':0.002,'count':2000,"
                                 "'region':{'min':[-0.8,-0.8,-0.8],'max':[0.8,0.8,0.8]}}],"
                                 "'sinks':[{'name':'out','body':'b',%s}]}",
                                 sinks[k]),
                      1e-3, 0, NULL);
    begin(r);
    const dem_data *d = r->data;
    for (int step = 0; step < 20; step++) {
      static tdm_vec3 at[2000]; /* they rest */
      const int before = d->state.nparticle;
      const uint64_t taken = d->state.sink[0].removed;
      for (int i = 0; i < before; i++)
        at[i] = d->state.sphere[i].position;
      steps(r, NULL, 1);
      int right = 0;
      for (int i = 0; i < before; i++)
        right += expected(k, tdm_m3_tmul(tdm_quat_to_matrix(d->state.pose[0].orientation),
                                         tdm_sub(at[i], d->state.pose[0].position)));
      ck_assert_uint_eq(d->state.sink[0].removed - taken, (uint64_t)right);
      ck_assert_int_eq(before - d->state.nparticle, right);
    }
    ck_assert_uint_gt(d->state.sink[0].removed, 10);
    ck_assert_int_gt(d->state.nparticle, 500);
    rig_free(r);
  }
}
END_TEST

START_TEST(test_through_is_no_rebound) {
  /* a particle that goes through the floor is lost, not removed */
  rig *r = rig_make(scene_json("{" GRAIN "," FLOOR ",'particles':[{'type':'list','material':'a','radius':0.01,"
                               "'positions':[[0,0,0.0099]]}],"
                               "'sinks':[{'name':'out','type':'after_contact','body':'floor'}]}"),
                    1e-5, 0, NULL);
  begin(r);
  ck_assert_uint_eq(r->data->state.touched[0], 1);
  r->data->state.sphere[0].position.z = -0.5;
  steps(r, NULL, 10);
  ck_assert_int_eq(r->data->state.nparticle, 1);
  ck_assert_int_eq(dem_count_lost(r->data), 1);
  rig_free(r);
}
END_TEST

START_TEST(test_neighbours_keep_histories) {
  /* two particles that slide and roll on the floor do not notice that a third, listed before them, is taken away */
  const char *pair = "{'type':'list','material':'a','radius':0.02,'positions':[[0,0,0.02],[0.0399,0,0.02]],"
                     "'velocity':[0.3,0.2,0],'spin':[1,2,3]}";
  const char *scene = "{" GRAIN "," FLOOR ",'particles':[%s%s],"
                      "'skin':0.5,'sinks':[{'name':'out','type':'box','min':[4,-1,-1],'max':[5,1,1]}]}";
  const char *third =
      "{'type':'list','material':'a','radius':0.02,'positions':[[3.9992,0,0.02]],'velocity':[0.5,0,0]},";
  rig *with = rig_make(scene_json(scene, third, pair), 1e-5, 0, NULL);
  rig *without = rig_make(scene_json(scene, "", pair), 1e-5, 0, NULL);
  begin(with), begin(without);
  steps(with, NULL, 150);
  steps(without, NULL, 150);
  ck_assert_int_eq(with->data->state.nparticle, 3);
  uint64_t rebuilds = with->data->lists.nrebuild;
  for (int part = 0; part < 20; part++) {
    steps(with, NULL, 50);
    steps(without, NULL, 50);
    ck_assert_uint_eq(with->data->lists.nrebuild, rebuilds); /* taken out of the lists in place */
    ck_assert_int_eq(with->data->state.nparticle, 2);
    ck_assert_mem_eq(with->data->state.sphere, without->data->state.sphere, 2 * sizeof(dem_sphere));
    ck_assert_mem_eq(with->data->state.pace, without->data->state.pace, 2 * sizeof(dem_pace));
    ck_assert_mem_eq(with->data->state.push, without->data->state.push, 2 * sizeof(dem_push));
  }
  ck_assert_int_gt(without->data->state.ncontact, 1);
  ck_assert_uint_eq(with->data->state.id[0], 1);
  rig_free(with), rig_free(without);
}
END_TEST

START_TEST(test_copy) {
  /* a copy, into data that have less room, goes on bit-identically; so does a second run */
  const char *sink = "{'name':'out','type':'after_contact','body':'floor'},"
                     "{'name':'side','type':'plane','point':[0.19,0,0],'normal':[-1,0,0]}";
  rig *r = stream(sink, ""), *again = stream(sink, "");
  begin(r), begin(again);
  steps(r, NULL, 2000);
  steps(again, NULL, 2000);
  same(r->data, again->data);
  dem_data *copy = dem_data_create(r->model), *first = r->data;
  ck_assert_int_lt(copy->work.capacity, first->state.nparticle);
  ck_assert_int_eq(dem_data_copy(copy, first), TDM_OK);
  steps(r, NULL, 2000);
  r->data = copy;
  steps(r, NULL, 2000);
  same(first, copy);
  ck_assert_mem_eq(first->state.source, copy->state.source, 2 * sizeof *copy->state.source);
  ck_assert_mem_eq(first->state.sink, copy->state.sink, 2 * sizeof *copy->state.sink);
  ck_assert_mem_eq(&first->state.ledger, &copy->state.ledger, sizeof copy->state.ledger);
  ck_assert_uint_eq(first->lists.nrebuild, copy->lists.nrebuild);
  ck_assert_uint_gt(copy->state.ledger.removed, 30);
  dem_data_destroy(&first);
  rig_free(r), rig_free(again);
}
END_TEST

START_TEST(test_exact_sum) {
  /* what is added and taken away again in any order leaves nothing, where a plain sum leaves round-off */
  dem_exact_sum sum = {0};
  double plain = 0, x[1000];
  for (int i = 0; i < 1000; i++) {
    x[i] = pow(10, i % 600 - 300) / 3 * (1 + 0.1 * sin(i));
    dem_exact_sum_add(&sum, x[i]);
    plain += x[i];
  }
  for (int i = 0; i < 1000; i++) {
    dem_exact_sum_add(&sum, -x[(i * 383) % 1000]);
    plain -= x[(i * 383) % 1000];
    ck_assert_int_le(sum.n, DEM_EXACT_PARTS);
  }
  ck_assert(plain != 0);
  ck_assert(dem_exact_sum_value(&sum) == 0 && sum.n == 0);
}
END_TEST

/* 2800 grains that fall onto a floor, some into a sink, some out of the box, others from a source */
static rig *crowd(const char *integrator) {
  return rig_make(scene_json("{'materials':[{'name':'a','density':2500,'young_modulus':1e6,'poisson_ratio':0.25}],"
                             "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.3}],'bodies':[{'name':'f',"
                             "'material':'a','shapes':[{'type':'plane','normal':[0,0,1]}]}],'domain':{'min':[-1,-1,-1],"
                             "'max':[1,0.1905,0.2]},'particles':[{'type':'block','material':'a','radius':[0.004,0.005],"
                             "'count':[20,20,7],'corner':[0,0,0.005],'spacing':0.01,'velocity':[0,0.1,-1]}],"
                             "'sources':[{'name':'s','material':'a','radius':0.005,'rate':2000,'region':{'min':"
                             "[-0.5,-0.5,0.1],'max':[-0.1,-0.1,0.15]}}],'sinks':[{'name':'k','type':'box','min':"
                             "[0.05,0.05,0],'max':[0.1,0.1,0.03]}]%s}",
                             integrator),
                  5e-5, 0, NULL);
}

START_TEST(test_many_with_substeps) {
  /* no contact is fast here, so multi-step is velocity Verlet but for round-off, whoever comes and goes; the crossings
   * between chunks must follow */
  rig *plain = crowd(""), *multi = crowd(",'integrator':'multi-step','multi_step':{'substeps':2,'mass':1e-9}");
  const rig *both[2] = {plain, multi};
  tdm_vec3 *at[2];
  for (int k = 0; k < 2; k++) {
    dem_data *d = both[k]->data;
    at[k] = calloc(4000, sizeof *at[k]);
    for (int s = 0; s < 200; s++) {
      one_step(d, NULL, 5e-5);
      flow_now(d, (double)d->state.nstep * 5e-5, 5e-5);
    }
    for (int i = 0; i < d->state.nparticle; i++)
      at[k][d->state.id[i]] = d->state.sphere[i].position;
  }
  ck_assert_int_gt(plain->data->state.nparticle, DEM_CHUNK);
  ck_assert_uint_gt(plain->data->state.sink[0].removed, 20);
  ck_assert_uint_gt(plain->data->state.ledger.left, 20);
  ck_assert_uint_gt(plain->data->state.source[0].made, 10);
  ck_assert_int_eq(plain->data->state.nparticle, multi->data->state.nparticle);
  for (int i = 0; i < 4000; i++)
    ck_assert(tdm_norm(tdm_sub(at[0][i], at[1][i])) < 1e-9);
  free(at[0]);
  free(at[1]);
  rig_free(plain);
  rig_free(multi);
}
END_TEST

/* 4732 grains in three chunks that fall through each other onto a floor, of which half is a sink */
static rig *drain(void) {
  return rig_make(scene_json("{'materials':[{'name':'a','density':2500,'young_modulus':1e6,'poisson_ratio':0.25}],"
                             "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.3}],'bodies':[{'name':'f',"
                             "'material':'a','shapes':[{'type':'plane','normal':[0,0,1]},{'type':'plane','normal':"
                             "[1,0,0]},{'type':'plane','normal':[-1,0,0],'point':[0.261,0,0]}]}],"
                             "'particles':[{'type':'block','material':'a','radius':[0.004,0.005],'count':[26,26,7],"
                             "'corner':[0,0,0.005],'spacing':0.01,'velocity':[0.3,0.1,-1]}],'skin':0.004,"
                             "'sinks':[{'name':'k','type':'box','min':[-1,0.05,-1],'max':[1,1,0.012]}]}"),
                  5e-5, 0, NULL);
}

START_TEST(test_removal_parts_the_lists) {
  /* lists from which entries were taken away in place are as good, to the bit, as those built anew after each step;
   * from three chunks of particles down to one */
  rig *kept = drain(), *anew = drain();
  begin(kept), begin(anew);
  uint64_t most = 0;
  for (int s = 0; s < 1500; s++) {
    rig *const both[2] = {kept, anew};
    for (int k = 0; k < 2; k++) {
      dem_data *d = both[k]->data;
      d->lists.stale = d->lists.stale || k == 1;
      one_step(d, NULL, 5e-5);
      flow_now(d, (double)d->state.nstep * 5e-5, 5e-5);
    }
    most = kept->data->lists.crossings.count > (int)most ? (uint64_t)kept->data->lists.crossings.count : most;
    if (s % 100 == 99)
      same(kept->data, anew->data);
  }
  ck_assert_uint_gt(most, 100);
  ck_assert_int_lt(kept->data->state.nparticle, DEM_CHUNK);
  ck_assert_int_eq(kept->data->lists.nchunk, 1);
  ck_assert_uint_lt(5 * kept->data->lists.nrebuild, anew->data->lists.nrebuild);
  ck_assert_uint_gt(kept->data->state.sink[0].removed, 5 * kept->data->lists.nrebuild);
  rig_free(kept), rig_free(anew);
}
END_TEST

TEST_MAIN("dem flow", test_classes, test_balances, test_after_contact, test_moving_zones, test_through_is_no_rebound,
          test_neighbours_keep_histories, test_copy, test_exact_sum, test_many_with_substeps,
          test_removal_parts_the_lists)
