/* Looks at all particles: energies, limits of the step, the fill, checks, stiffness of bodies. On ranks that know only
 * their home and its visitors they have the bits of one process. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/adapter/report.h"
#include "dem/bodies/wall_stiffness.h"
#include "dem/bodies/walls.h"
#include "dem/channels/channels.h"
#include "dem/exchange/keep.h"
#include "dem/particles/field.h"
#include "dem/seam/visits.h"
#include "dem/watch/check.h"
#include "dem/watch/energy_balance.h"
#include "dem/watch/limits.h"
#include "test_ranks_support.h"
#include "tests/test_main.h"

/* Two kinds of spheres in a lattice of 32 x 16 x 16, pressed together, in slices across x: four chunks, of which two
 * sink into each other so far that the start is refused, unless the second half begins at 16. The body below is
 * coupled; one sphere is below it, one is fixed, one is traced. */
#define PLANE "{'type':'plane','point':[0,0,0],'normal':[0,0,1]}"
#define PLATE "{'type':'box','side':'outside','size':[40,40,0.5],'center':[16,8,-0.25]}"

static json_t *scene(const char *law, const char *pair, const char *floor, double corner) {
  static const char text[] =
      "{'gravity':[0,0,-9.81],'contact':{%s},'decomposition':{'order':'slices'},'materials':[{'name':'a',"
      "'density':1000,'young_modulus':1e7,'poisson_ratio':0.3},{'name':'b','density':3000,'young_modulus':5e7,"
      "'poisson_ratio':0.2}],'pairs':[{'materials':['a','a'],'restitution':0.5,%s},{'materials':['a','b'],"
      "'restitution':0.6,%s},{'materials':['b','b'],'restitution':0.4,%s}],"
      "'bodies':[{'name':'body','material':'b','shapes':[%s,{'type':"
      "'cylinder','axis':[0,1,0],'point':[3,0,-0.27],'radius':0.3,'length':20,'side':'outside'}]}],"
      "'particles':[{'type':'block','material':'a','radius':[0.49,0.5],'mass':50000,'count':[16,16,16],'corner':[0,0,0."
      "51],'spacing':1,"
      "'velocity':[0.3,0.1,0]},{'type':'block','material':'b','radius':0.5,'count':[16,16,16],'corner':[%g,0,0.51],"
      "'spacing':1},{'type':'list','material':'a','radius':0.25,'positions':[[2,2,17.5]],'fixed':true},{'type':'list',"
      "'material':'b','radius':[0.2,0.3],'positions':[[30,1,18],[1,30,-22]],'velocity':[0,0,-4]}],"
      "'paths':[{'name':'grain','particle':4000}]}";
  return scene_json(text, law, pair, pair, pair, floor, corner);
}

/* Spheres of one mass and material in slices across x, two chunks; the deepest impact is that of the one small sphere,
 * which is the first of the second chunk. */
#define BLOCK(x, layers)                                                                                         \
  "{'type':'block','material':'a','radius':0.5,'mass':1000,'count':[" layers ",16,16],'corner':[" x ",0,0.51],'" \
  "spacing':1.01,'velocity':[0,0,-4]}"

static json_t *equal_masses(void) {
  return scene_json("{'gravity':[0,0,-9.81],'decomposition':{'order':'slices'},'materials':[{'name':'a','density':1000,"
                    "'young_modulus':1e7,'poisson_ratio':0.3}],'pairs':[{'materials':['a','a'],'restitution':0.5,"
                    "'friction':0.4}],'bodies':[{'name':'body','material':'a','shapes':[" PLANE "]}],'particles':"
                    "[" BLOCK("0", "8") ",{'type':'list','material':'a','radius':0.2,'mass':1000,'positions':"
                                        "[[8.08,0,0.51]],'velocity':[0,0,-4]}," BLOCK("9.09", "7") "]}");
}

static rig *make(const json_t *json) {
  const tdm_assigned_body body = {.name = "body", .mass = 0.7, .state = state_at(0, 0, 0)};
  rig *r = rig_make(json_deep_copy(json), 1e-5, 1, &body);
  for (int i = 0; i < r->data->state.nparticle; i++)
    r->data->state.sphere[i].position = tdm_scale(0.98, r->data->state.sphere[i].position);
  return r;
}

enum { MANY_CHANNELS = 200 };

/* what is found */
typedef struct {
  dem_stored_energy energy;
  dem_limits now, expected;
  dem_fill fill;
  double mass, impact, rate2, deepest, channel[MANY_CHANNELS];
  long lost, fallen;
  tdm_vec3 fixed;
  int nbehind, first_fallen;
  tdm_error refused;
  char report[20000]; /* its figures, then its warnings */
} looks;

static void take_report(dem_data *d, looks *l) {
  const dem_settled settled = {.rest = true, .pressed = true};
  dem_report report;
  tdm_error err = {0};
  ck_assert(!dem_report_make(&report, d, &settled, l->nbehind, &err));
  char *text = json_dumps(report.json, JSON_SORT_KEYS);
  int n = snprintf(l->report, sizeof l->report, "%s", text);
  for (int k = 0; k < report.nwarning; k++)
    n += snprintf(l->report + n, sizeof l->report - (size_t)n, "\n%s: %s", report.warning[k].path,
                  report.warning[k].message);
  ck_assert_int_lt(n, (int)sizeof l->report);
  free(text);
  json_decref(report.json);
}

static void look(rig *r, looks *l) {
  static const double J[12] = {1, 0, 0, 1, 0.2, 0, 0, 0.3, 0.1, 0, 0, 0}; /* two velocities */
  double B[12];
  dem_data *d = r->data;
  tdm_error err = {0};
  dem_channels channels;
  memset(l, 0, sizeof *l);
  for (int f = 0; f < 2; f++)
    for (int q = 0; q < 6; q++)
      B[6 * f + q] = J[2 * q + f] / (1 + f);
  l->energy = dem_stored_energy_now(d);
  ck_assert(!dem_limits_now(d, &l->now, &err) && !dem_limits_expected(d, &l->expected, &err));
  l->fill = dem_fill_now(d);
  l->mass = dem_total_mass(d);
  l->impact = dem_impact_speed(d);
  ck_assert(!dem_walls_rate2(d, 2, J, B, &l->rate2, &err));
  l->deepest = dem_deepest(d, 0);
  l->lost = dem_count_lost(d);
  l->fixed = dem_fixed_force(d);
  ck_assert(!dem_channels_make(&channels, r->model, &err) && channels.count <= MANY_CHANNELS);
  dem_channels_sample(&channels, d, l->channel);
  dem_channels_free(&channels);
  take_report(d, l);
  dem_check_start(d, &l->nbehind, &l->refused);
  l->fallen = dem_count_fallen(d, &l->first_fallen);
}

typedef struct {
  const json_t *scene;
  const looks *alone;
} sharing;

static void look_on_rank(const dem_ranks *ranks, void *context) {
  const sharing *s = context;
  rig *r = make(s->scene);
  looks found;
  dem_homes_begin(r->data, ranks);
  r->data->lists.stale = true; /* lists of home, visitors; the rest is no number */
  rig_steps(r, 2);
  look(r, &found);
  ck_assert_mem_eq(&found, s->alone, sizeof found);
  rig_free(r);
}

START_TEST(looks_on_ranks) {
  static const struct {
    const char *law, *pair, *floor;
  } laws[] = {{"'normal':'hertz','tangential':'mindlin'", "'friction':0.4", PLATE},
              {"'tangential':'none','multi_contact':'mc-stress'", "'beta':1.2", PLANE},
              {"'tangential':'none','multi_contact':'mc-strain'", "'gamma':1.1", PLATE}};
  json_t *json = scene(laws[_i].law, laws[_i].pair, laws[_i].floor, _i == 1 ? 16 : 15.7);
  rig *r = make(json);
  looks alone;
  r->data->lists.stale = true;
  rig_steps(r, 2);
  look(r, &alone);
  dem_keep_poisons = true;
  ck_assert_double_gt(alone.energy.elastic, 0);
  ck_assert_double_gt(alone.rate2, 0);
  ck_assert_msg(strstr(alone.report, "dem.guard.overlap: is") != NULL, "%s", alone.report);
  ck_assert_double_gt(alone.deepest, 0);
  ck_assert(alone.now.eigen > 0 && alone.now.eigen < 1 && alone.now.coordination > 4);
  ck_assert_int_eq(alone.fallen, _i != 1); /* a plane has no end */
  ck_assert_msg(alone.refused.status == (_i == 1 ? TDM_OK : TDM_ERR_SCENE), "%s", alone.refused.message);
  ck_assert_int_eq(_i == 1 ? alone.nbehind : 1, 1);
  for (int size = 2; size <= 6; size++)
    each_rank(size, look_on_rank, &(sharing){json, &alone});
  rig_free(r);
  json_decref(json);
}
END_TEST

static void report_on_rank(const dem_ranks *ranks, void *context) {
  const sharing *s = context;
  rig *r = make(s->scene);
  looks found = {0};
  dem_homes_begin(r->data, ranks);
  r->data->lists.stale = true;
  rig_steps(r, 1);
  take_report(r->data, &found);
  ck_assert_str_eq(found.report, s->alone->report);
  rig_free(r);
}

START_TEST(deepest_impact_on_ranks) {
  json_t *json = equal_masses();
  rig *r = make(json);
  looks alone = {0};
  rig_steps(r, 1);
  take_report(r->data, &alone);
  ck_assert_double_eq(r->data->state.sphere[DEM_CHUNK].radius, 0.2);
  ck_assert_msg(strstr(alone.report, "a particle of radius 0.2 m that arrives") != NULL, "%s", alone.report);
  for (int size = 2; size <= 3; size++)
    each_rank(size, report_on_rank, &(sharing){json, &alone});
  rig_free(r);
  json_decref(json);
}
END_TEST

TEST_MAIN_ROWS("dem_looks", {looks_on_ranks, 3}, {deepest_impact_on_ranks, 1})
