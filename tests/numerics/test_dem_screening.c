/* Measures of screening: numbers by hand, gaps, the balance, what is kept in states, what is refused. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/channels/channels.h"
#include "dem/dem.h"
#include "dem/store/state_file.h"
#include "protocol/scene/remark.h"
#include "tests/test_main.h"

#include <float.h>

/* ---- a scene whose particles fly through sinks one by one ---- */

#define MATERIALS                                                                                             \
  "'gravity':[0,0,0],'materials':[{'name':'grain','density':1000,'young_modulus':1e3,"                        \
  "'poisson_ratio':0.25},{'name':'rubber','density':1200,'young_modulus':1e3,'poisson_ratio':0.4}],'pairs':[" \
  "{'materials':['grain','grain'],'restitution':0.5,'friction':0.4},{'materials':['grain','rubber'],"         \
  "'restitution':0.5,'friction':0.4},{'materials':['rubber','rubber'],'restitution':0.5,'friction':0.4}]"
#define SINK(name, low, high) "{'name':'" name "','type':'box','min':[1," #low ",-1],'max':[2," #high ",1]}"
/* one that is at x = 1 at time t: at the middle of a step, it is taken at the end of that */
#define FLIES(material, radius, t, y)                                                             \
  "{'type':'list','material':'" material "','radius':" #radius ",'positions':[[" t "," #y ",0]]," \
  "'velocity':[1,0,0]}"
#define TOP "{'name':'top','outlets':['a','a2'],'sorted':0.02}"
#define LOW "{'name':'low','outlets':['b']}"
#define GRAINS "'materials':['grain'],"

static const double large = 1000 * 4.0 / 3 * M_PI * 8e-6, small = 1000 * 4.0 / 3 * M_PI * 1e-6; /* masses [kg] */

static json_t *scene(const char *screening) {
  return scene_json(
      "{" MATERIALS ",'sinks':[" SINK("a", -0.5, 0.5) "," SINK("a2", 0.5, 1.5) "," SINK("b", 1.5, 2.5) "," SINK("spill", 2.5, 3.5) "],'particles':[" FLIES(
          "grain", 0.02, "0.8995",
          0) "," FLIES("grain", 0.01, "0.7995",
                       0.2) "," FLIES("grain", 0.02, "0.6995",
                                      1) "," FLIES("grain", 0.01, "0.5995",
                                                   2) "," FLIES("grain", 0.02, "0.4995",
                                                                2.2) "," FLIES("rubber", 0.02, "0.8495",
                                                                               -0.3) "," FLIES("grain", 0.02, "0.3995",
                                                                                               3) ",{'type':'list','"
                                                                                                  "material':'grain','"
                                                                                                  "radius':0.02,"
                                                                                                  "'positions':[[-3,0,"
                                                                                                  "0]]}],'sources':[{'"
                                                                                                  "name':'late','"
                                                                                                  "material':'grain','"
                                                                                                  "radius':0.01,'rate':"
                                                                                                  "10,'count':2,"
                                                                                                  "'start':0.55,'"
                                                                                                  "position':[-3,2,0],'"
                                                                                                  "velocity':[-1,0,0]},"
                                                                                                  "{'name':'balls','"
                                                                                                  "material':'rubber','"
                                                                                                  "radius':0.01,'rate':"
                                                                                                  "10,"
                                                                                                  "'count':1,'position'"
                                                                                                  ":[-3,4,0]}],'"
                                                                                                  "screening':{%s}}",
      screening);
}

typedef struct {
  json_t *json;
  dem_engine *engine;
  const dem_start *start;
  uint64_t nstep;
  double value[128];
} run;

static run *run_begin(const char *screening) {
  run *r = calloc(1, sizeof *r);
  r->json = scene(screening);
  const tdm_assignment a = {.scene = r->json, .time_end = 1, .dt = 1e-3, .n = 1};
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

/* to step n, an output every 7 steps and at the end */
static void go(run *r, uint64_t n) {
  while (r->nstep < n) {
    const uint64_t to = r->nstep + 7 < n ? r->nstep + 7 : n;
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
}

static bool undefined(const run *r, const char *name) {
  return isnan(value(r, name));
}

/* ---- numbers ---- */

START_TEST(test_by_hand) {
  run *r = run_begin(GRAINS "'smoothing':0.5,'decks':[" TOP "," LOW "]");
  ck_assert(undefined(r, "screening.top.efficiency") && undefined(r, "screening.top.rate"));
  ck_assert(value(r, "screening.top.rate_now") == 0 && value(r, "screening.fed") == 7);
  go(r, 100);
  ck_assert(undefined(r, "screening.top.efficiency") && undefined(r, "screening.top.efficiency_mass"));
  ck_assert(undefined(r, "screening.top.share") && value(r, "screening.top.rate") == 0);
  go(r, 150); /* one left the upper deck, and a rubber ball */
  ck_assert(value(r, "screening.top.sorted") == 1 && value(r, "screening.top.undersized") == 0);
  ck_assert(value(r, "screening.top.efficiency") == 100 && value(r, "screening.top.share") == 0);
  ck_assert(undefined(r, "screening.low.efficiency") && undefined(r, "screening.efficiency"));
  ck_assert(undefined(r, "screening.efficiency_mass"));
  ck_relative(value(r, "screening.top.rate"), large / 0.15, 1e-12);
  go(r, 590);
  ck_assert(value(r, "screening.top.sorted") == 2 && value(r, "screening.top.undersized") == 1);
  ck_assert(value(r, "screening.low.sorted") == 2 && value(r, "screening.low.undersized") == 0);
  ck_relative(value(r, "screening.top.sorted_mass"), 2 * large, 1e-12);
  ck_relative(value(r, "screening.top.undersized_mass"), small, 1e-12);
  ck_relative(value(r, "screening.low.sorted_mass"), large + small, 1e-12);
  ck_relative(value(r, "screening.top.efficiency"), 200.0 / 3, 1e-14);
  ck_relative(value(r, "screening.top.efficiency_mass"), 100 * 16.0 / 17, 1e-12);
  ck_relative(value(r, "screening.top.share"), 100 / 17.0, 1e-12);
  ck_assert(value(r, "screening.low.efficiency") == 100 && value(r, "screening.low.share") == 0);
  ck_relative(value(r, "screening.efficiency"), (200.0 / 3 + 100) / 2, 1e-14);
  ck_relative(value(r, "screening.efficiency_mass"), 50 * (1 + 16.0 / 17), 1e-12); /* (4.39) */
  ck_relative(value(r, "screening.top.rate"), (2 * large + small) / 0.59, 1e-12);
  ck_relative(value(r, "screening.low.rate"), (large + small) / 0.59, 1e-12);
  const double of_late = large * exp(-0.489 / 0.5) + small * exp(-0.389 / 0.5) + large * exp(-0.289 / 0.5);
  ck_relative(value(r, "screening.top.rate_now"), of_late / 0.5, 1e-12);
  run_end(r);
}
END_TEST

START_TEST(test_all_materials) {
  /* without a choice the rubber ball counts too: by mass it is heavier than a grain */
  run *r = run_begin("'decks':[{'name':'top','outlets':['a','a2'],'sorted':0.015}," LOW "]");
  go(r, 590);
  ck_assert(value(r, "screening.top.sorted") == 3 && value(r, "screening.top.undersized") == 1);
  ck_relative(value(r, "screening.top.sorted_mass"), 3.2 * large, 1e-12);
  ck_assert(value(r, "screening.fed") == 8 + 1 + 1); /* with both sources */
  run_end(r);
}
END_TEST

START_TEST(test_later_start) {
  /* what left before the start counts nowhere */
  run *r = run_begin(GRAINS "'start':0.25,'decks':[" TOP "," LOW "]");
  go(r, 240);
  ck_assert(value(r, "screening.top.sorted") == 0 && undefined(r, "screening.top.rate"));
  ck_assert(value(r, "screening.fed") == 5 && value(r, "screening.inside") == 5);
  go(r, 500);
  ck_assert(value(r, "screening.top.sorted") == 1 && value(r, "screening.top.undersized") == 0);
  ck_relative(value(r, "screening.top.rate"), large / 0.25, 1e-12);
  ck_assert(value(r, "screening.fed") == 5 && value(r, "screening.out") == 2);
  run_end(r);
}
END_TEST

START_TEST(test_balance) {
  /* exact at every output; what spills is told of once, at the output after it */
  tdm_remarks remarks = {0};
  tdm_remarks_open(&remarks);
  run *r = run_begin(GRAINS "'decks':[" TOP "," LOW "]");
  for (uint64_t n = 1; n <= 800; n++) {
    go(r, n);
    const double fed = value(r, "screening.fed"), inside = value(r, "screening.inside");
    const double out = value(r, "screening.top.sorted") + value(r, "screening.top.undersized") +
                       value(r, "screening.low.sorted") + value(r, "screening.low.undersized");
    ck_assert(value(r, "screening.out") == out);
    ck_assert(value(r, "screening.lost") == (n > 600) && fed == inside + out + (n > 600));
    ck_assert(fed == 7 + (n >= 550) + (n >= 650));
    ck_assert_int_eq(remarks.count, n > 600);
  }
  ck_assert_str_eq(remarks.entry[0].event, "screening");
  ck_assert_uint_eq(remarks.entry[0].count, 1);
  ck_assert(strstr(remarks.entry[0].message, "1 left in another way") && remarks.entry[0].level == TDM_WARNING);
  tdm_remarks_open(NULL);
  run_end(r);
}
END_TEST

/* ---- states ---- */

START_TEST(test_restore) {
  run *r = run_begin(GRAINS "'smoothing':0.3,'decks':[" TOP "," LOW "]");
  tdm_error err = {0};
  const size_t size = (size_t)r->start->nchannel * sizeof *r->value;
  double before[128], after[128];
  go(r, 250);
  memcpy(before, r->value, size);
  ck_assert_int_eq(dem_engine_save(r->engine, 0, &err), TDM_OK);
  go(r, 700);
  memcpy(after, r->value, size);
  ck_assert_int_eq(dem_engine_restore(r->engine, 0, &err), TDM_OK);
  r->nstep = 250;
  go(r, 700);
  ck_assert_mem_eq(after, r->value, size);
  ck_assert(memcmp(before, after, size) != 0);
  run_end(r);
}
END_TEST

START_TEST(test_stored_state) {
  /* a whole state as bytes has the counts; a scene with other decks does not take it */
  const char *const decks = GRAINS "'decks':[" TOP "," LOW "]";
  run *r = run_begin(decks);
  rig *same = rig_make(scene(decks), 1e-3, 0, NULL);
  rig *other =
      rig_make(scene(GRAINS "'decks':[{'name':'top','outlets':['a','a2'],'sorted':0.01}," LOW "]"), 1e-3, 0, NULL);
  void *bytes;
  size_t size;
  tdm_error err = {0};
  go(r, 700);
  const dem_data *d = dem_engine_data(r->engine);
  ck_assert_int_eq(dem_state_save(d, &bytes, &size), TDM_OK);
  ck_assert_msg(dem_state_load(same->data, bytes, size, &err) == TDM_OK, "%s", err.message);
  ck_assert_mem_eq(same->data->state.deck, d->state.deck, 2 * sizeof *d->state.deck);
  ck_assert_mem_eq(same->data->state.screening, d->state.screening, sizeof *d->state.screening);
  ck_assert_int_eq(dem_state_load(other->data, bytes, size, &err), TDM_ERR_FILE);
  free(bytes);
  rig_free(same), rig_free(other);
  run_end(r);
}
END_TEST

START_TEST(test_unused) {
  /* without the key: no channels, no memory in the state */
  rig *r = rig_make(scene_json("{" MATERIALS "}"), 1e-3, 0, NULL);
  dem_channels c;
  ck_assert_int_eq(dem_channels_make(&c, r->model, &(tdm_error){0}), TDM_OK);
  for (int k = 0; k < c.count; k++)
    ck_assert(!strstr(c.channel[k].name, "screening") && !c.channel[k].gaps);
  ck_assert(r->data->state.deck == (void *)r->data->state.screening);
  dem_channels_free(&c);
  rig_free(r);
}
END_TEST

/* ---- what is refused ---- */

START_TEST(test_refused) {
  static const struct {
    const char *screening, *path, *says;
  } bad[] = {
      {"'decks':[]", "dem.screening.decks", "has 0 entries"},
      {"'start':0", "dem.screening.decks", "missing"},
      {"'decks':[{'name':'top','sorted':1}]", "dem.screening.decks[0].outlets", "missing"},
      {"'decks':[{'name':'top','outlets':[],'sorted':1}]", "dem.screening.decks[0].outlets", "is empty"},
      {"'decks':[{'name':'top','outlets':['a3']}]", "dem.screening.decks[0].outlets[0]", "did you mean \"a"},
      {"'decks':[{'name':'top','outlets':[3]}]", "dem.screening.decks[0].outlets[0]", "must be a name"},
      {"'decks':[{'name':'top','outlets':['a','a']}]", "dem.screening.decks[0].outlets", "already"},
      {"'decks':[" TOP ",{'name':'low','outlets':['a2']}]", "dem.screening.decks[1].outlets", "\"top\" already"},
      {"'decks':[" TOP ",{'name':'top','outlets':['b']}]", "dem.screening.decks[1].name", "each its own"},
      {"'decks':[{'name':'t.p','outlets':['b']}]", "dem.screening.decks[0].name", "letters, digits"},
      {"'decks':[{'name':'top','outlets':['a']}," LOW "]", "dem.screening.decks[0].sorted", "missing"},
      {"'decks':[" TOP ",{'name':'low','outlets':['b'],'sorted':0.03}]", "dem.screening.decks[1].sorted",
       "highest deck first"},
      {"'decks':[" TOP ",{'name':'low','outlets':['b'],'sorted':-1}]", "dem.screening.decks[1].sorted", "0 or greater"},
      {"'materials':[],'decks':[" TOP "]", "dem.screening.materials", "is empty"},
      {"'materials':['grian'],'decks':[" TOP "]", "dem.screening.materials[0]", "did you mean \"grain\""},
      {"'smoothing':0,'decks':[" TOP "]", "dem.screening.smoothing", "greater than 0"},
      {"'start':-1,'decks':[" TOP "]", "dem.screening.start", "before the run begins"},
      {"'by':'mass','decks':[" TOP "]", "dem.screening.by", "unknown"},
  };
  for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
    tdm_error err = rig_refused(scene(bad[k].screening), NULL);
    ck_assert_msg(strcmp(err.path, bad[k].path) == 0, "%zu: %s: %s", k, err.path, err.message);
    ck_assert_msg(strstr(err.message, bad[k].says), "%zu: %s: %s", k, err.path, err.message);
  }
}
END_TEST

TEST_MAIN("dem: screening", test_by_hand, test_all_materials, test_later_start, test_balance, test_restore,
          test_stored_state, test_unused, test_refused)
