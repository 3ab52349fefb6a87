/* What goes from rank to rank when lists are made: places of particles that are near, and particles to new homes;
 * and with which particles each begins. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/base/pages.h"
#include "dem/exchange/keep.h"
#include "dem/exchange/near_chunks.h"
#include "dem/exchange/renewal.h"
#include "dem/scene/scene.h"
#include "dem/seam/visits.h"
#include "test_ranks_support.h"
#include "tests/test_main.h"

/* A lattice of 32 x 16 x 16 spheres, 1 m apart: in slices across x four chunks, of 8 layers each, which are the parts
 * that go together. Where it repeats, the last layer is 1 m from the first one's image. */
enum { LAYER = 256 };

static json_t *lattice(const char *repeats) {
  static const char scene[] =
      "{'gravity':[0,0,0],'contact':{'normal':'hooke','tangential':'none'},'decomposition':{'order':'slices'},"
      "'materials':[{'name':'a','density':1000}],'pairs':[{'materials':['a','a'],'stiffness':1,'damping':0}],"
      "'domain':{'min':[0,0,0],'max':[32,16,16]%s},"
      "'particles':[{'type':'block','material':'a','mass':1,'radius':0.4,'count':[32,16,16],'corner':[0.1,0.1,0.1],"
      "'spacing':1}]}";
  return scene_json(scene, repeats);
}

/* of the scene, which ranks share */
static rig *make(const json_t *scene) {
  return rig_make(json_deep_copy(scene), 1e-4, 0, NULL);
}

/* ---- layers that are near ---- */

typedef struct {
  const char *repeats;
  const json_t *scene;
  const dem_data *alone;
  double skin;
  int nrun[4], run[4][4]; /* of the rank that has chunk c: layers, first and end of each run */
  int ntogether;          /* runs of the rank that has the first two chunks */
} nearness;

static void look_for_near(const dem_ranks *ranks, void *context) {
  const nearness *expected = context;
  rig *r = make(expected->scene);
  dem_data *d = r->data;
  dem_homes_begin(d, ranks);
  ck_assert_int_eq(d->lists.nchunk, 4);
  const int first = dem_home_first(d), end = dem_home_end(d);
  dem_keep_home(d); /* poisoned: others are not there */
  dem_near_runs near;
  ck_assert(!dem_near_chunks(d, expected->skin, &near));
  if (first == end) {
    ck_assert_int_eq(near.nrun, 0);
  } else if (end == first + 1) {
    ck_assert_int_eq(near.nrun, expected->nrun[first]);
    for (int k = 0; k < 2 * near.nrun; k++)
      ck_assert_int_eq(near.run[k], expected->run[first][k] * LAYER);
  } else if (first == 0) {
    ck_assert_int_eq(near.nrun, expected->ntogether);
  }
  for (int k = 0; k < near.nrun; k++)
    ck_assert_mem_eq(&d->state.sphere[near.run[2 * k]], &expected->alone->state.sphere[near.run[2 * k]],
                     (size_t)(near.run[2 * k + 1] - near.run[2 * k]) * sizeof(dem_sphere));
  dem_scratch_done(&d->work.scratch);
  rig_free(r);
}

START_TEST(layers_that_are_near) {
  static const nearness cases[] = {
      {"", NULL, NULL, 0.1, {0}, {{0}}, 0},
      {"", NULL, NULL, 0.3, {1, 1, 1, 0}, {{8, 9}, {16, 17}, {24, 25}, {0}}, 1},
      {",\"x\":\"periodic\"", NULL, NULL, 0.1, {0}, {{0}}, 0},
      {",\"x\":\"periodic\"", NULL, NULL, 0.3, {2, 1, 1, 0}, {{8, 9, 31, 32}, {16, 17}, {24, 25}, {0}}, 2},
      {",\"x\":\"periodic\",\"y\":\"periodic\",\"z\":\"periodic\"",
       NULL,
       NULL,
       9,
       {2, 2, 1, 0},
       {{8, 17, 23, 32}, {16, 25, 31, 32}, {24, 32}, {0}},
       1},
  };
  dem_keep_poisons = true;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    nearness expected = cases[i];
    json_t *scene = lattice(expected.repeats);
    rig *alone = make(scene);
    expected.scene = scene;
    expected.alone = alone->data;
    for (int size = 2; size <= 7; size++)
      each_rank(size, look_for_near, &expected);
    rig_free(alone);
    json_decref(scene);
  }
}
END_TEST

/* ---- new homes ---- */

/* Particles come in the order of these, those of one code in the order that they had. */
static uint64_t code_of(int i) {
  return (uint64_t)(i * 7919 % 61) << 57 | (uint64_t)(i % 3);
}

static int by_code(const void *a, const void *b) {
  const int i = *(const int *)a, j = *(const int *)b;
  const uint64_t x = code_of(i), y = code_of(j);
  return x != y ? (x > y) - (x < y) : (i > j) - (i < j);
}

typedef struct {
  const json_t *scene;
  const dem_data *alone;
  bool sort;
  double part; /* where the second home is to begin; the others get nothing but what the last one has */
} moving;

/* Home particles are what particle from[i] was in a process that is alone. */
static void ck_moved(const dem_data *d, const dem_data *alone, const int *from) {
  for (int i = dem_home_first_particle(d); i < dem_home_end_particle(d); i++) {
#define X(field, n, name)                                                                              \
  if ((n) > 0)                                                                                         \
    ck_assert_mem_eq(&d->field[(size_t)i * (size_t)(n)], &alone->field[(size_t)from[i] * (size_t)(n)], \
                     (size_t)(n) * sizeof *d->field);
    DEM_PARTICLE_STATE(X)
#undef X
    ck_assert(d->state.push[i].force.x == 0 && d->state.push[i].twist.z == 0);
  }
}

static void move_homes(const dem_ranks *ranks, void *context) {
  const moving *m = context;
  rig *r = make(m->scene);
  dem_data *d = r->data;
  const int n = d->state.nparticle;
  int *from = calloc((size_t)n, sizeof *from);
  uint64_t *code = calloc((size_t)n, sizeof *code);
  double home[THREAD_RANKS_MAX + 1] = {0};
  dem_homes_begin(d, ranks);
  dem_keep_home(d);
  d->lists.valid = false;
  for (int h = 1; h <= ranks->size; h++)
    home[h] = h == ranks->size ? 1 : m->part;
  for (int i = 0; i < n; i++)
    from[i] = i;
  if (m->sort)
    qsort(from, (size_t)n, sizeof *from, by_code);
  for (int first = dem_home_first_particle(d), i = first; i < dem_home_end_particle(d); i++)
    code[i - first] = code_of(i);
  ck_assert(!dem_renew_homes(d, m->sort ? code : NULL, home));
  ck_assert_int_eq(dem_chunk_of_rank(d, 1), (int)(4 * m->part));
  ck_moved(d, m->alone, from);
  free(code);
  free(from);
  rig_free(r);
}

START_TEST(particles_in_new_homes) {
  static const struct {
    bool sort;
    double part;
  } cases[] = {{false, 0.25}, {true, 0.5}, {true, 0}, {true, 1}, {false, 0.75}};
  json_t *scene = lattice("");
  rig *alone = make(scene);
  dem_keep_poisons = true;
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++)
    for (int size = 2; size <= 7; size++) {
      moving how = {scene, alone->data, cases[i].sort, cases[i].part};
      each_rank(size, move_homes, &how);
    }
  rig_free(alone);
  json_decref(scene);
}
END_TEST

/* ---- the start ---- */

/* particles of several kinds, some of a common mass, in two entries that chunks and homes divide; with more keys */
static json_t *mixture(const char *more) {
  static const char scene[] =
      "{'materials':[{'name':'a','density':1000},{'name':'b','density':2000}],'orientation':true,'contact':{'normal':"
      "'hooke','tangential':'none'},'pairs':[{'materials':['a','a'],'stiffness':1,'damping':0},{'materials':['a','b'],"
      "'stiffness':1,'damping':0},{'materials':['b','b'],'stiffness':1,'damping':0}],'particles':[{'type':'block',"
      "'material':'a','radius':0.4,'count':[20,20,8],'corner':[0,0,0],'spacing':1,'velocity':[1,2,3]},{'type':'random',"
      "'material':'b','count':3000,'radius':[0.3,0.5],'total_mass':7,'region':{'min':[0,0,9],'max':[20,20,30]},"
      "'spin':[0,0,5]}]%s}";
  return scene_json(scene, more);
}

typedef struct {
  const json_t *scene;
  const dem_model *whole;
  const dem_data *alone;
  bool all; /* each rank has all */
} beginning;

/* A rank that has read no more than its home begins with the same particles there. */
static void begin_home(const dem_ranks *ranks, void *context) {
  const beginning *b = context;
  const dem_model *m = b->whole;
  json_t *scene = json_deep_copy(b->scene);
  const tdm_assignment assignment = {.scene = scene, .time_end = 1, .dt = 1e-4, .n = 1};
  dem_model *own;
  tdm_error err = {0};
  ck_assert_msg(!dem_model_read_on(&own, &assignment, ranks, &err), "%s: %s", err.path, err.message);
  ck_assert_int_eq(own->nparticle, m->nparticle);
  ck_assert_mem_eq(own->radius, m->radius, (size_t)m->nparticle * sizeof *m->radius);
  ck_assert_mem_eq(own->mass, m->mass, (size_t)m->nparticle * sizeof *m->mass);
  ck_assert(own->largest_radius == m->largest_radius && own->mean_radius == m->mean_radius);
  dem_data *d = dem_data_create_on(own, ranks);
  ck_assert_ptr_nonnull(d);
  const int first = dem_home_first_particle(d), end = dem_home_end_particle(d);
  ck_assert_int_eq(own->first_here, b->all ? 0 : first);
  ck_assert(b->all ? own->end_here >= m->nparticle : own->end_here == end);
  dem_model_forget_start(own);
#define X(field, n, name)                                                                                   \
  if ((n) > 0 && end > first)                                                                               \
    ck_assert_mem_eq(&d->field[(size_t)first * (size_t)(n)], &b->alone->field[(size_t)first * (size_t)(n)], \
                     (size_t)(end - first) * (size_t)(n) * sizeof *d->field);
  DEM_PARTICLE_STATE(X)
#undef X
  ck_assert_mem_eq(&d->state.ledger, &b->alone->state.ledger, sizeof d->state.ledger);
  dem_data_destroy(&d);
  dem_model_destroy(&own);
  json_decref(scene);
}

START_TEST(start_of_home) {
  static const struct {
    const char *more;
    bool all;
  } cases[] = {
      {"", false}, {",'settle':{'speed':1}", false}, {",'settle':{'store':'x'}", true}, {",'start':'x'", true}};
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    json_t *scene = mixture(cases[i].more);
    const tdm_assignment assignment = {.scene = scene, .time_end = 1, .dt = 1e-4, .n = 1};
    dem_model *whole;
    tdm_error err = {0};
    ck_assert_msg(!dem_model_read(&whole, &assignment, &err), "%s: %s", err.path, err.message);
    dem_data *alone = dem_data_create(whole);
    beginning b = {scene, whole, alone, cases[i].all};
    for (int size = 2; size <= 7; size++) /* more ranks than chunks, too */
      each_rank(size, begin_home, &b);
    dem_data_destroy(&alone);
    dem_model_destroy(&whole);
    json_decref(scene);
  }
}
END_TEST

/* ---- what a rank has saved ---- */

START_TEST(copies_of_what_is_partly_zero) {
  enum { SIZE = 200000 };
  static const size_t sizes[] = {0, 1, 4096, 16384, 16385, 100000, SIZE};
  char *from = malloc(SIZE), *to = malloc(SIZE + 64);
  for (int k = 0; k < SIZE; k++) /* some pieces are zero, some begin or end with zeros */
    from[k] = (char)(k / 10000 % 7 < 2 ? k % 251 : 0);
  for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
    for (size_t at = 0; at < 64; at += 21) {
      memset(to, 7, SIZE + 64);
      dem_pages_copy(to + at, from, sizes[i]);
      ck_assert_int_eq(memcmp(to + at, from, sizes[i]), 0);
      for (size_t k = 0; k < SIZE + 64; k++)
        if ((k < at || k >= at + sizes[i]) && to[k] != 7)
          ck_abort_msg("byte %zu behind %zu of %zu is touched", k, at, sizes[i]);
    }
  free(from);
  free(to);
}
END_TEST

TEST_MAIN("dem_exchange", layers_that_are_near, particles_in_new_homes, start_of_home, copies_of_what_is_partly_zero)
