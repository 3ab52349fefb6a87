/* Containers: counts and rates by hand, jams, containers that move, what is kept in states, what is refused. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/dem.h"
#include "dem/store/state_file.h"
#include "protocol/output/figures.h"
#include "protocol/scene/remark.h"
#include "tests/test_main.h"

#include <unistd.h>

/* ---- scenes: particles fly out of a box one by one ---- */

#define MATERIALS                                                                                        \
  "'gravity':[0,0,0],'materials':[{'name':'m','density':1000,'young_modulus':1e3,'poisson_ratio':0.3}]," \
  "'pairs':[{'materials':['m','m'],'restitution':0.5,'friction':0}]"
#define HOPPER "{'name':'hopper','min':[-20,-1,-1],'max':[0,1,1],'jam_time':1.5}"

enum { FEW = 10, MANY = 20, NEVER = 3 };

static const double mass = 1000 * 4.0 / 3 * M_PI * 1e-6;

/* when particle k leaves [s]: ten in half a second, ten more 2 s later */
static double leaves(int k) {
  return 0.0525 + 0.05 * k + (k < FEW ? 0 : 2);
}

/* `more` keys; containers. Particles at 1 m/s, and some that stay. */
static json_t *scene(const char *containers, const char *more) {
  char flying[4000] = "", *at = flying;
  for (int k = 0; k < MANY; k++)
    at += sprintf(at, "%s[%.4f,%.2f,0]", k ? "," : "", -leaves(k), 0.03 * (k % 8));
  return scene_json("{" MATERIALS ",'particles':[{'type':'list','material':'m','radius':0.01,'positions':[%s],"
                    "'velocity':[1,0,0]},{'type':'block','material':'m','radius':0.01,'spacing':0.1,"
                    "'corner':[-9,0.5,0],'count':[3,1,1]}],'containers':[%s]%s}",
                    flying, containers, more);
}

typedef struct {
  json_t *json;
  dem_engine *engine;
  const dem_start *start;
  uint64_t nstep;
  double value[128];
} run;

static run *run_begin(json_t *json) {
  run *r = calloc(1, sizeof *r);
  r->json = json;
  const tdm_assignment a = {.scene = r->json, .time_end = 5, .dt = 1e-3, .n = 1};
  tdm_error err = {0};
  dem_engine_create(&r->engine, &a, NULL, &err);
  ck_assert_msg(err.status == TDM_OK, "%s: %s", err.path, err.message);
  r->start = dem_engine_start(r->engine);
  ck_assert_int_le(r->start->nchannel, 128);
  memcpy(r->value, r->start->initial, (size_t)r->start->nchannel * sizeof *r->value);
  return r;
}

static void run_end(run *r) {
  dem_engine_destroy(&r->engine);
  json_decref(r->json);
  free(r);
}

/* to time `end` [s], with an output every `interval` */
static void go(run *r, double end, double interval) {
  const uint64_t last = (uint64_t)lround(1000 * end), every = (uint64_t)lround(1000 * interval);
  while (r->nstep < last) {
    const uint64_t to = r->nstep + every < last ? r->nstep + every : last;
    const double t = 1e-3 * (double)to;
    const dem_window w = {
        .t0 = 1e-3 * (double)r->nstep, .t1 = t, .nstep = to - r->nstep, .nsample = 1, .sample_time = &t};
    tdm_error err = {0};
    ck_assert_msg(dem_engine_advance(r->engine, &w, &(dem_outcome){.channel = r->value}, &err) == TDM_OK, "%s",
                  err.message);
    r->nstep = to;
  }
}

static double value(const run *r, const char *name) {
  for (int c = 0; c < r->start->nchannel; c++)
    if (strcmp(r->start->channel[c].name, name) == 0) {
      ck_assert(!isnan(r->value[c]) || r->start->channel[c].gaps);
      return r->value[c];
    }
  ck_abort_msg("no channel %s", name);
  return 0;
}

/* ---- counts ---- */

START_TEST(counts_and_rates_are_those_by_hand) {
  run *r = run_begin(scene(HOPPER, ""));
  ck_assert(value(r, "container.hopper.number") == MANY + NEVER);
  ck_near(value(r, "container.hopper.mass"), (MANY + NEVER) * mass, 1e-12);
  ck_assert(value(r, "container.hopper.left") == 0 && value(r, "container.hopper.rate") == 0);
  ck_assert(isnan(value(r, "container.hopper.mean_rate")));
  for (int k = 1; k <= 30; k++) {
    double t = 0.1 * k;
    int gone = 0, before = 0;
    for (int i = 0; i < MANY; i++)
      gone += leaves(i) < t, before += leaves(i) < t - 0.1;
    go(r, t, 0.1);
    ck_assert(value(r, "container.hopper.number") == MANY + NEVER - gone);
    ck_near(value(r, "container.hopper.mass"), (MANY + NEVER - gone) * mass, 1e-12);
    ck_assert(value(r, "container.hopper.left") == gone);
    ck_near(value(r, "container.hopper.rate"), (gone - before) / 0.1, 1e-9);
  }
  ck_assert(isnan(value(r, "container.hopper.mean_rate"))); /* 21 of 23 did not leave */
  run_end(r);
  /* without those that stay: from the second to the eighteenth of twenty */
  r = run_begin(scene("{'name':'hopper','min':[-8.5,-1,-1],'max':[0,1,1]}", ""));
  go(r, 3.2, 0.1);
  ck_assert(value(r, "container.hopper.number") == 0);
  ck_near(value(r, "container.hopper.mean_rate"), 16 / (leaves(17) - leaves(1)), 0.01);
  run_end(r);
}
END_TEST

/* A source fills the container while it flows; each particle counts once. */
START_TEST(what_comes_from_a_source_counts) {
  run *r = run_begin(scene(HOPPER, ",'sources':[{'name':'feed','material':'m','radius':0.01,'rate':10,'start':0.1005,"
                                   "'count':15,'position':[-0.5,-0.5,0],'velocity':[1,0,0]}],"
                                   "'sinks':[{'name':'out','type':'plane','point':[0.3,0,0],'normal':[-1,0,0]}]"));
  go(r, 4, 0.25);
  ck_assert(value(r, "container.hopper.left") == MANY + 15);
  ck_assert(value(r, "container.hopper.number") == NEVER);
  ck_assert(value(r, "sink.out.removed") == MANY + 15);
  run_end(r);
}
END_TEST

/* A box that swings to and fro past particles at rest: those that are left outside again and again have left once. A
 * box that moves on leaves all behind. */
START_TEST(containers_move_along) {
  static const char body[] = ",'bodies':[{'name':'b','material':'m','position':[1,2,3],'shapes':[],'motion':%s}]";
  char more[400];
  for (int k = 0; k < 2; k++) {
    snprintf(more, sizeof more, body,
             k ? "{'velocity':[0,0.5,0]}" : "{'oscillation':{'amplitude':[0,0.25,0],'frequency':1}}");
    run *r = run_begin(scene("{'name':'box','body':'b','min':[-12,-3,-4],'max':[-8,-1.4,-2]}", more));
    /* y below 0.6; of those at rest, at 0.5 */
    ck_assert(value(r, "container.box.number") == NEVER);
    go(r, 1.5, 0.1);
    if (k == 0) { /* |0.25 sin| > 0.1 below: outside at 0.75 s, inside again at 1.5 s */
      ck_assert(value(r, "container.box.number") == NEVER);
      ck_assert(value(r, "container.box.left") == NEVER);
    } else { /* up by 0.75: the lower face passes 0.5 after 3 s */
      ck_assert(value(r, "container.box.number") == NEVER);
      go(r, 3.2, 0.1);
      ck_assert(value(r, "container.box.number") == 0);
      ck_assert(value(r, "container.box.left") == NEVER);
    }
    run_end(r);
  }
}
END_TEST

/* ---- jams ---- */

/* A jam 1.5 s after the tenth has left, until the eleventh does; one more when the rest stays. */
START_TEST(jams_are_told_once) {
  tdm_remarks said = {0};
  tdm_remarks_open(&said);
  run *r = run_begin(scene(HOPPER, ""));
  const double tenth = leaves(FEW - 1), eleventh = leaves(FEW), last = leaves(MANY - 1);
  go(r, tenth + 1.49, 0.1);
  ck_assert(value(r, "container.hopper.jams") == 0 && said.count == 0);
  go(r, tenth + 1.52, 0.1);
  ck_assert(value(r, "container.hopper.jams") == 1);
  ck_assert_int_eq(said.count, 1);
  ck_assert_str_eq(said.entry[0].event, "jam.hopper");
  ck_assert_str_eq(said.entry[0].path, "dem.containers[0]");
  ck_assert(said.entry[0].level == TDM_WARNING);
  ck_near(said.entry[0].first, tenth + 1.5, 0.002);
  ck_assert(strstr(said.entry[0].message, "13 particles") != NULL);
  go(r, eleventh - 0.01, 0.1);
  ck_assert_int_eq(said.count, 1);
  go(r, eleventh + 0.01, 0.1);
  ck_assert_int_eq(said.count, 2);
  ck_assert_str_eq(said.entry[1].event, "flows_again.hopper");
  ck_assert(said.entry[1].level == TDM_NOTICE);
  go(r, last + 1.6, 0.1);
  ck_assert(value(r, "container.hopper.jams") == 2);
  ck_assert_uint_eq(said.entry[0].count, 2);
  ck_assert_uint_eq(said.entry[1].count, 1);
  json_t *summary = json_object();
  for (int c = 0; c < r->start->nchannel; c++)
    tdm_figure_enter(summary, &r->start->channel[c], r->value[c]);
  const json_t *hopper = json_object_get(json_object_get(summary, "containers"), "hopper");
  ck_assert_int_eq(json_integer_value(json_object_get(hopper, "jams")), 2);
  ck_assert_int_eq(json_integer_value(json_object_get(hopper, "number")), NEVER);
  ck_assert(json_is_null(json_object_get(hopper, "mean_rate")));
  json_decref(summary);
  run_end(r);
  tdm_remarks_open(NULL);
}
END_TEST

/* Who says from when on it should flow hears of a container that never did; an empty one is no jam, nor is one that was
 * empty for long when something comes. */
START_TEST(watching_may_begin_before_anything_leaves) {
  static const struct {
    const char *container, *more;
    int jams;
  } cases[] = {
      {"{'name':'c','min':[-9.5,0,-1],'max':[-8,1,1],'jam_time':0.5,'jam_start':1}", "", 1},
      {"{'name':'c','min':[-9.5,0,-1],'max':[-8,1,1],'jam_time':0.5}", "", 0},
      {"{'name':'c','min':[-9.5,0,-9],'max':[-8,1,-8],'jam_time':0.5,'jam_start':0}", "", 0},
      {"{'name':'c','min':[-9.5,0,-9],'max':[-8,1,-8],'jam_time':0.5,'jam_start':0}",
       ",'sources':[{'name':'s','material':'m','radius':0.01,'rate':1,'count':1,'start':1.8,'position':[-9,0.5,-8.5]}]",
       0},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    tdm_remarks said = {0};
    tdm_remarks_open(&said);
    run *r = run_begin(scene(cases[k].container, cases[k].more));
    go(r, 2, 0.1);
    ck_assert_int_eq((int)value(r, "container.c.jams"), cases[k].jams);
    ck_assert_int_eq(said.count, cases[k].jams);
    if (cases[k].jams)
      ck_near(said.entry[0].first, 1.5, 0.002);
    run_end(r);
    tdm_remarks_open(NULL);
  }
}
END_TEST

/* ---- states ---- */

/* Saved and restored, and stored as a whole, containers are as they were; a run goes on with the same values. Outputs
 * change nothing but the rate, which is of their interval. */
START_TEST(states_keep_containers) {
  static const char *const names[] = {"container.hopper.number", "container.hopper.left", "container.hopper.jams"};
  run *r = run_begin(scene(HOPPER, "")), *plain = run_begin(scene(HOPPER, ""));
  rig *same = rig_make(scene(HOPPER, ""), 1e-3, 0, NULL), *other = rig_make(scene("", ""), 1e-3, 0, NULL);
  tdm_error err = {0};
  void *bytes = NULL;
  size_t size = 0;
  go(r, 1.7, 0.1);
  const dem_data *d = dem_engine_data(r->engine);
  ck_assert_int_eq(dem_state_save(d, &bytes, &size), TDM_OK);
  ck_assert_msg(dem_state_load(same->data, bytes, size, &err) == TDM_OK, "%s", err.message);
  ck_assert_mem_eq(same->data->state.container, d->state.container, sizeof *d->state.container);
  ck_assert_mem_eq(same->data->state.held, d->state.held, (size_t)d->state.nparticle * sizeof *d->state.held);
  ck_assert_int_eq(dem_state_load(other->data, bytes, size, &err), TDM_ERR_FILE);
  free(bytes);

  err = (tdm_error){0};
  ck_assert_int_eq(dem_engine_save(r->engine, 0, &err), TDM_OK);
  dem_container_state once;
  for (int time = 0; time < 2; time++) {
    go(r, 3.5, 0.1);
    if (time == 0)
      once = *d->state.container;
    else
      ck_assert_mem_eq(&once, d->state.container, sizeof once);
    ck_assert_int_eq(dem_engine_restore(r->engine, 0, &err), TDM_OK);
    r->nstep = 1700;
  }
  go(r, 3.5, 0.1);
  go(plain, 3.5, 3.5);
  for (int k = 0; k < 3; k++)
    ck_assert(value(r, names[k]) == value(plain, names[k]));
  rig_free(same), rig_free(other);
  run_end(r), run_end(plain);
}
END_TEST

/* A run may start from the particles of one that had no container: counting begins anew. */
START_TEST(a_start_counts_anew) {
  char file[300], more[400];
  snprintf(file, sizeof file, "%s/containers_%d.state", TANDEM_TEST_DIR, (int)getpid());
  snprintf(more, sizeof more, ",'start':'%s'", file);
  tdm_error err = {0};
  rig *without = rig_make(scene("", ""), 1e-3, 0, NULL);
  rig_steps(without, 1000);
  ck_assert_int_eq(dem_state_write(without->data, file, "dem", NULL, 0, &err), TDM_OK);
  run *r = run_begin(scene(HOPPER, more));
  unlink(file);
  ck_assert(value(r, "container.hopper.number") == MANY - FEW + NEVER);
  ck_assert(value(r, "container.hopper.left") == 0);
  go(r, 2.2, 0.1);
  ck_assert(value(r, "container.hopper.left") == MANY - FEW);
  rig_free(without);
  run_end(r);
}
END_TEST

/* ---- what is refused ---- */

START_TEST(what_is_wrong_is_told) {
  static const struct {
    const char *containers, *path, *says;
  } cases[] = {
      {HOPPER "," HOPPER, "dem.containers[1].name", "already"},
      {"{'name':'a b','min':[0,0,0],'max':[1,1,1]}", "dem.containers[0].name", "letters"},
      {"{'name':'a','min':[0,0,0],'max':[1,-1,1]}", "dem.containers[0].max", "smaller than min"},
      {"{'name':'a','min':[0,0,0],'max':[1,1,1],'jam_time':0}", "dem.containers[0].jam_time", "greater than 0"},
      {"{'name':'a','min':[0,0,0],'max':[1,1,1],'body':'x'}", "dem.containers[0].body", "no body"},
      {"{'name':'a','min':[0,0,0],'max':[1,1,1],'radius':1}", "dem.containers[0].radius", "unknown"},
  };
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    tdm_error err = rig_refused(scene(cases[k].containers, ""), NULL);
    ck_assert_msg(strcmp(err.path, cases[k].path) == 0 && strstr(err.message, cases[k].says), "%s: %s", err.path,
                  err.message);
  }
}
END_TEST

TEST_MAIN("dem_containers", counts_and_rates_are_those_by_hand, what_comes_from_a_source_counts, containers_move_along,
          jams_are_told_once, watching_may_begin_before_anything_leaves, states_keep_containers, a_start_counts_anew,
          what_is_wrong_is_told)
