/* Scenes of scenarios/, with more and smaller particles and shorter, have on several ranks the bits of a run on one:
 * particles in both orders, 2, 3, 5, 8 ranks, one and two threads each, with homes that stay and that move all the
 * time. Two runs for each number of ranks have each pair of these; with TANDEM_RANKS_ALL in the environment all are
 * run. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/parameters/load.h"
#include "test_ranks_runs.h"
#include "tests/test_main.h"

typedef struct {
  const char *file, *set[16]; /* in scenarios/; NULL-terminated */
  const char *axis;           /* of slices */
  int nwindow, nstep;
  bool carried;
} scenario;

/* eleven chunks, so that homes of eight ranks can move */
static const scenario scenarios[] = {
    {.file = "dem/hopper", /* half of the particles against the others */
     .set = {"dem.particles[0].count=11000", "dem.particles[0].radius=[0.00115,0.00135]",
             "dem.particles[0].velocity=[2,0,-1]", "dem.particles[0].region.max=[0,0.0014,1.1]",
             "dem.particles[0].region.min[1]=-0.0014",
             "dem.particles[1]={\"type\":\"random\",\"material\":\"grain\",\"count\":11000,\"radius\":0.00125,"
             "\"region\":{\"min\":[0.002,-0.0014,0.3],\"max\":[0.195,0.0014,1.1]},\"velocity\":[-2,0,0]}"},
     .axis = "z",
     .nwindow = 6,
     .nstep = 15},
    {.file = "dem/mixer",
     .set = {"dem.particles[0].count=11000", "dem.particles[0].radius=0.00086", "dem.particles[0].velocity=[2,0,-1]",
             "dem.particles[0].region.max=[0,0.0009,0.2]", "dem.particles[0].region.min[1]=-0.0009",
             "dem.particles[1]={\"type\":\"random\",\"material\":\"grain\",\"count\":11000,\"radius\":0.00086,"
             "\"region\":{\"min\":[0.002,-0.0009,-0.2],\"max\":[0.155,0.0009,0.2]},\"velocity\":[-2,0,0]}"},
     .axis = "x",
     .nwindow = 6,
     .nstep = 15},
    {.file = "tumbler/two_deck",
     .set = {"parameters.batch=1", "parameters.count=22000", "parameters.batch_radius=0.18",
             "parameters.batch_height=0.03", "dem.particles[0].velocity=[0,0,-1]"},
     .axis = "y",
     .nwindow = 6,
     .nstep = 20},
    {.file = "torsional", /* a bed that rests: its lists hold */
     .set = {"dem.particles[0].count=22000", "dem.particles[0].radius=0.014", "time.dt=5e-5",
             "dem.settle.max_time=0.001"},
     .axis = "x",
     .nwindow = 6,
     .nstep = 8,
     .carried = true},
};

#ifdef __SANITIZE_ADDRESS__
static const int numbers[] = {3}; /* slow there */
#else
static const int numbers[] = {2, 3, 5, 8};
#endif

static const char *order, *axis; /* of its particles */
static const json_t *section;    /* dem, as it was read */

static json_t *scene(int threads) {
  json_t *dem = json_deep_copy(section), *decomposition = json_pack("{s:s}", "order", order);
  if (strcmp(order, "slices") == 0)
    json_object_set_new(decomposition, "axis", json_string(axis));
  json_object_set_new(dem, "decomposition", decomposition);
  json_object_set_new(dem, "threads", json_integer(threads));
  return dem;
}

/* the place of the body that is coupled: of the mechanism before it moves */
static tdm_pose rest_of(const json_t *root, const char *name) {
  const json_t *bodies = json_object_get(json_object_get(root, "mbd"), "bodies");
  tdm_pose pose = state_at(0, 0, 0).pose;
  size_t i;
  json_t *body;
  json_array_foreach((json_t *)bodies, i, body) {
    if (strcmp(json_string_value(json_object_get(body, "name")), name) != 0)
      continue;
    tdm_error err = {0};
    tdm_object o = tdm_object_open(body, "mbd.bodies", &err);
    pose = (tdm_pose){.position = tdm_get_vec3(&o, "position", NULL),
                      .orientation = tdm_get_orientation(&o, "orientation")};
    ck_assert_msg(!err.status, "%s", err.message);
  }
  return pose;
}

/* run r of the pairs, or of all; false: there is none */
static bool way(int r, bool all, int *ranks, outcome *on) {
  /* threads and homes of the first of two runs for a number of ranks in this order; the other has the others' */
  static const bool first[2][4][2] = {{{0, 0}, {0, 1}, {1, 1}, {1, 0}}, {{1, 1}, {1, 0}, {0, 0}, {0, 1}}};
  const int each = all ? 4 : 1;
  if (r >= each * (int)(sizeof numbers / sizeof *numbers))
    return false;
  const bool *pair = first[strcmp(order, "slices") == 0][r / each];
  *ranks = numbers[r / each];
  on->threads = 1 + (all ? r % 2 : pair[0]);
  on->restless = all ? r / 2 % 2 : pair[1];
  return true;
}

START_TEST(scenario_on_ranks) {
  const scenario *s = &scenarios[_i];
  const bool all = getenv("TANDEM_RANKS_ALL") != NULL;
  char file[512];
  tdm_scene loaded = {0};
  tdm_error err = {0};
  axis = s->axis;
  snprintf(file, sizeof file, TANDEM_SOURCE_DIR "/scenarios/%s%s", s->file,
           strstr(s->file, "deck") ? ".json" : "/scene.json");
  ck_assert_msg(!tdm_scene_load(&loaded, file, s->set, &err), "%s", err.message);
  json_t *dem = tdm_scene_section(loaded.root, "dem");
  if (!s->carried) /* what is settled rests */
    json_object_del(dem, "settle");
  section = dem;
  const char *body = json_string_value(tdm_scene_value(loaded.root, "coupling.bodies[0].dem"));
  kind k = {.scene = scene, .nwindow = s->nwindow, .nstep = s->nstep, .carried = s->carried, .contacts = true};
  k.dt = json_number_value(tdm_scene_value(loaded.root, "time.dt"));
  k.ncoupled = body != NULL;
  k.body = body;
  if (body)
    k.rest = rest_of(loaded.root, body);
  for (int o = 0; o < 2; o++) {
    order = o ? "slices" : "curve";
    outcome alone = {.kind = &k, .threads = 1}, on = {.kind = &k};
    lead(&alone);
    ck_assert_int_gt(alone.nparticle, 2 * DEM_CHUNK);
    ck_assert_double_gt(alone.contact_force, 0);
    for (int r = 0, ranks; way(r, all, &ranks, &on); r++, on = (outcome){.kind = &k}) {
      run_on(ranks, &on);
      ck_same(&alone, &on, ranks);
      ck_assert_msg(!on.restless || s->carried || on.moves > 0, "homes of %d ranks did not move", ranks);
      if (all)
        printf("%s, %s: %d ranks of %d threads, homes moved %d times: the same bits\n", s->file, order, ranks,
               on.threads, on.moves);
      let_go(&on);
    }
    let_go(&alone);
  }
  json_decref(dem);
  tdm_scene_destroy(&loaded);
}
END_TEST

TEST_MAIN_ROWS("dem_ranks_scenes", {scenario_on_ranks, SOME_ROWS(sizeof scenarios / sizeof *scenarios)})
