/* Runs on several ranks have the bits of a run on one, whatever happens in them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_ranks_runs.h"
#include "tests/test_main.h"

#include <unistd.h>

static char folder[] = "/tmp/tandem-test-XXXXXX"; /* for files; main removes it, whatever becomes of the tests */

/* Every scene is run on some numbers of ranks, one of them on more. On two ranks homes move all the time. */
#ifdef __SANITIZE_ADDRESS__
static const int some[] = {2, 0}, more[] = {2, 5, 0}; /* slow there */
#else
static const int some[] = {2, 5, 0}, more[] = {2, 3, 5, 8, 0};
#endif

static void compare(const kind *k, void (*check)(const outcome *)) {
  compare_on(some, k, check);
}

/* ---- scenes ---- */

#define TWO                                                                                                       \
  "'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25},{'name':'b','density':2000," \
  "'young_modulus':2e7,'poisson_ratio':0.3}],'threads':%d,'pairs':["
#define PAIRS                                                                                         \
  "{'materials':['a','a'],'restitution':0.5,'friction':0.4},{'materials':['a','b'],'restitution':0.6" \
  ",'friction':0.3},{'materials':['b','b'],'restitution':0.4,'friction':0.5}]"
#define ROLL ",'rolling_friction':0.05,'rolling_damping':0.1}"
#define PAIRS_THAT_ROLL                                                                                       \
  "{'materials':['a','a'],'restitution':0.5,'friction':0.4" ROLL ",{'materials':['a','b'],'restitution':0.6," \
  "'friction':0.3" ROLL ",{'materials':['b','b'],'restitution':0.4,'friction':0.5" ROLL "]"
/* a box, named "box", with more of its keys; particles fill it from below: more than two chunks */
#define OPEN ",'open':['+z']"
#define BOX(more)                                                                                      \
  "{'name':'box','material':'b','shapes':[{'type':'box','side':'inside','size':[0.2,0.2,0.5]" more "}" \
  "]}"
#define MANY(z0, z1)                                                                                             \
  "{'type':'random','material':'a','count':4500,'radius':[0.0035,0.005],'region':{'min':[-0.099,-0.099," z0 "]," \
  "'max':[0.099,0.099," z1 "]},'velocity':[0,0,-1]}"

/* a bed in a box that is led, stirred by a driven paddle: springs, energies, contacts for the view */
static json_t *bed(int threads) {
  return scene_json(
      "{" TWO PAIRS_THAT_ROLL ",'energy':true,'contact':{'rolling':'spring-dashpot'},'bodies':[" BOX(
          OPEN) ",{'name':'paddle','material':'b','shapes':[{'type':'box','side':'outside','size':[0.15,"
                "0.01,0.06]}],'position':[0,0,-0.215],'motion':{'angular_velocity':[0,0,40]}}],"
                "'particles':[" MANY(
                    "-0.175",
                    "0.1") ",{'type':'random','material':'b','count':200,"
                           "'radius':0.004,'region':{'min':[-0.09,-0.09,0.11],'max':[0.09,0.09,0.25]},'velocity':"
                           "[0,0,-2]}]}",
      threads);
}

static void ck_bed(const outcome *out) {
  ck_assert_int_gt(out->nparticle, 2 * DEM_CHUNK);
  ck_assert_double_gt(out->contact_force, 1);
}

START_TEST(bed_that_is_stirred) {
  /* over 1000 steps, after which particles are put in a new order */
  const kind k = {.scene = bed, .dt = 2e-5, .nwindow = 11, .nstep = 100, .ncoupled = 1, .contacts = true};
  compare_on(more, &k, ck_bed);
}
END_TEST

static json_t *box_and_bed(int threads) {
  return scene_json("{" TWO PAIRS ",'bodies':[" BOX(OPEN) "],'particles':[" MANY("-0.245", "0") "]}", threads);
}

START_TEST(windows_that_are_tried_twice) {
  compare(&(kind){.scene = bed, .dt = 2e-5, .nwindow = 6, .nstep = 20, .ncoupled = 1, .tries = true, .contacts = true},
          ck_bed);
}
END_TEST

static void ck_carried(const outcome *out) {
  ck_bed(out);
  ck_assert_double_gt(tdm_norm(out->body[out->kind->nwindow - 1].end.pose.position), 1e-6);
}

START_TEST(box_that_is_carried) {
  compare(&(kind){.scene = box_and_bed,
                  .dt = 2e-5,
                  .nwindow = 12,
                  .nstep = 25,
                  .ncoupled = 1,
                  .carried = true,
                  .contacts = true},
          ck_carried);
}
END_TEST

START_TEST(windows_without_samples) {
  /* somebody looked at the scene: rank 0 wants to see new particles after each window, snapshot or not */
  compare(
      &(kind){
          .scene = box_and_bed, .dt = 2e-5, .nwindow = 4, .nstep = 20, .ncoupled = 1, .silent = true, .stays = true},
      NULL);
}
END_TEST

/* ---- meshes ---- */

static char floor_file[64];

/* a floor of triangles, in waves */
static void write_floor(void) {
  enum { N = 12 };
  snprintf(floor_file, sizeof floor_file, "%s/floor.stl", folder);
  FILE *f = fopen(floor_file, "w");
  ck_assert_ptr_nonnull(f);
  fprintf(f, "solid floor\n");
  for (int i = 0; i < N; i++)
    for (int j = 0; j < N; j++)
      for (int half = 0; half < 2; half++) {
        const int corner[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
        fprintf(f, "facet normal 0 0 0\nouter loop\n");
        for (int c = 0; c < 3; c++) {
          const int a = i + corner[half][c][0], b = j + corner[half][c][1];
          fprintf(f, "vertex %g %g %g\n", 0.22 * a / N - 0.11, 0.22 * b / N - 0.11, 0.003 * ((a + b) % 2));
        }
        fprintf(f, "endloop\nendfacet\n");
      }
  fprintf(f, "endsolid floor\n");
  ck_assert_int_eq(fclose(f), 0);
}

static json_t *mesh(int threads) {
  return scene_json(
      "{" TWO PAIRS ",'triangle_forces':true,'geometry_loads':true,'bodies':[" BOX(
          OPEN) ",{'name':"
                "'floor','material':'a','shapes':[{'type':'mesh','file':'%s'},{'type':'sphere','side':'outside',"
                "'radius':0.02,'center':[0,0,-0.02]}],'position':[0,0,-0.24],'motion':{'oscillation':{'amplitude':"
                "[0,0,0.002],'frequency':50}}}],'particles':[" MANY("-0.23", "0.05") "]}",
      threads, floor_file);
}

static void ck_mesh(const outcome *out) {
  ck_assert_double_gt(out->triangle_force, 0.1);
}

START_TEST(bed_on_triangles) {
  write_floor();
  compare(&(kind){.scene = mesh, .dt = 2e-5, .nwindow = 6, .nstep = 100, .ncoupled = 1}, ck_mesh);
}
END_TEST

/* ---- particles that come and go ---- */

/* particles come, are counted, and go: by places, by contact, out of the box */
static json_t *flow(int threads) {
  return scene_json(
      "{" TWO PAIRS ",'bodies':[{'name':'floor','material':'b','shapes':[{'type':'plane','normal':[0,0,1],'point':"
      "[0,0,-0.25]}]},{'name':'plate','material':'b','shapes':[{'type':'box','side':'outside','size':[0.08,0.08,0.02]"
      "}],'position':[0.05,0.05,-0.23]}],'particles':[" MANY(
          "-0.21",
          "0.035") "],'domain':{'min':[-0.11,-0.11,-0.3],"
                   "'max':[0.11,0.11,0.3]},'sources':[{'name':'tap','material':'b','radius':[0.003,0.004],'rate':20000,"
                   "'region':{"
                   "'min':[-0.09,-0.09,0.06],'max':[0.09,0.09,0.11]},'velocity':[0,0,-3]}],'sinks':[{'name':'hole','"
                   "type':'box',"
                   "'min':[-0.02,-0.1,-0.26],'max':[0.02,0.1,-0.23],'classes':[0.0038,0.0045]},{'name':'plate','type':"
                   "'after_contact','body':'plate'}],'containers':[{'name':'heap','min':[-0.1,-0.1,-0.25],'max':[0,0.1,"
                   "0]}]}",
      threads);
}

static void ck_flow(const outcome *out) {
  ck_assert_int_ne(out->nparticle, 4500);
}

START_TEST(particles_that_come_and_go) {
  compare(&(kind){.scene = flow, .dt = 2e-5, .nwindow = 11, .nstep = 100}, ck_flow);
}
END_TEST

/* a deck lets go at once what falls through its holes: what it has let go, and what blocks it, is known to all ranks */
static json_t *sieve(int threads) {
  return scene_json(
      "{" TWO PAIRS ",'bodies':[" BOX(
          OPEN) ",{'name':'sieve','material':'b','shapes':[{'type':'screen','deck':'reduced',"
                "'zeta':0.2,'passing':'at_once','hole':0.016,'bar':0.003,'radius':0.15}],'position':[0,0,-0.18]}],'"
                "particles':[" MANY("-0.174", "0.06") "],'sinks':[{'name':'out','type':'plane','point':[0,0,-0.186],'"
                                                      "normal':[0,0,1]}],'screening':"
                                                      "{'decks':[{'name':'top','outlets':['out'],'blocking_time':0.002,"
                                                      "'screen':{'body':'sieve','shape':0}}]}}",
      threads);
}

static void ck_sieve(const outcome *out) {
  ck_assert_int_lt(out->nparticle, 4500);
}

START_TEST(particles_that_are_screened) {
  compare(&(kind){.scene = sieve, .dt = 2e-5, .nwindow = 11, .nstep = 100}, ck_sieve);
}
END_TEST

/* a box that repeats and is strained, with particles that are fixed or pushed, for each integrator */
static const char *integrator;

static json_t *repeating(int threads) {
  return scene_json(
      "{" TWO PAIRS
      ",'energy':true,'gravity':[0,0,0],'integrator':'%s'%s,'domain':{'min':[-0.1,-0.1,-0.1],'max':[0.1,0.1,0.1],'x':"
      "'periodic','y':'periodic','z':'periodic','strain_rate':[-2,1,0]},'particles':[{'type':'random','material':'a',"
      "'count':4300,'radius':[0.0045,0.0055],'region':{'min':[-0.1,-0.1,-0.1],'max':[0.1,0.1,0.06]},'velocity':"
      "[3,2,1]},{'type':'random','material':'b','count':20,'radius':0.005,'region':{'min':[-0.1,-0.1,0.065],'max':"
      "[0.1,0.1,0.078]},'fixed':true},{'type':'random','material':'b','count':40,'radius':0.004,'region':{'min':"
      "[-0.1,-0.1,0.083],'max':[0.1,0.1,0.095]},'force':[0,0,-0.5]}]}",
      threads, integrator, strcmp(integrator, "multi-step") == 0 ? ",'multi_step':{'substeps':3,'mass':3e-4}" : "");
}

START_TEST(box_that_repeats) {
  static const char *const integrators[] = {"verlet", "leap-frog", "stormer-verlet", "multi-step"};
  integrator = integrators[_i];
  compare(&(kind){.scene = repeating, .dt = 2e-5, .nwindow = 4, .nstep = 50, .stays = true}, NULL);
}
END_TEST

/* particles of a stored state that lie outside the box, which repeats: each is put inside, on whichever rank it is */
static char start_file[64];

#define REPEATING_BOX(low, high)                                                                \
  "'domain':{'min':[" low "," low "," low "],'max':[" high "," high "," high "],'x':'periodic'" \
  ",'y':'periodic','z':'periodic'}"

static json_t *shifted_box(int threads) {
  return scene_json("{" TWO PAIRS ",'gravity':[0,0,0]," REPEATING_BOX("0.07", "0.27") ",'start':'%s','particles':[]}",
                    threads, start_file);
}

static void ck_shifted(const outcome *out) {
  ck_assert_int_eq(out->nparticle, 4300);
}

START_TEST(start_outside_the_box) {
  static const int sizes[] = {2, 3, 8, 0};
  rig *r = rig_make(scene_json("{" TWO PAIRS ",'gravity':[0,0,0]," REPEATING_BOX(
                                   "-0.1", "0.1") ",'particles':[{'type':'random','material':'a','count':4300,'radius':"
                                                  "[0.0045,0.0055],'region':{'min':[-0.1,-0.1,-0.1],'max':[0.1,0.1,0.1]"
                                                  "},'velocity':[1,2,3]}]}",
                               1),
                    1e-5, 0, NULL);
  tdm_error err = {0};
  snprintf(start_file, sizeof start_file, "%s/shifted.start", folder);
  ck_assert_msg(!dem_state_write(r->data, start_file, "dem.start", NULL, 0, &err), "%s", err.message);
  compare_on(sizes, &(kind){.scene = shifted_box, .dt = 1e-5, .nwindow = 2, .nstep = 30, .stays = true}, ck_shifted);
  rig_free(r);
}
END_TEST

/* a heap that slides along a box: in slices across two axes, with nobody who looks at all particles, and with a search
 * that looks at all pairs */
static const char *heap_key;

static json_t *heap(int threads) {
  return scene_json("{" TWO PAIRS ",'gravity':[6,0,-6],%s,'bodies':[{'name':'box','material':"
                    "'b','shapes':[{'type':'box','side':'inside','size':[0.6,0.1,0.5],'open':['+z']}]}],'"
                    "particles':[{'type':'random','material':'a','count':4500,'radius':[0.0035,0.005],'"
                    "region':{'min':[-0.299,-0.049,-0.249],'max':[-0.05,0.049,-0.035]},'velocity':[2,0,-4]}"
                    "]}",
                    threads, heap_key);
}

START_TEST(heap_that_slides) {
  static const char *const keys[] = {"'decomposition':{'order':'slices','axis':'y'}",
                                     "'decomposition':{'order':'slices'}", "'guard':{'every':0}",
                                     "'search':'verlet-1967'"};
  static const int three[] = {3, 0};
  heap_key = keys[_i];
  const kind often = {.scene = heap, .dt = 2e-5, .nwindow = 6, .nstep = 100, .ncoupled = 1, .contacts = true},
             few = {.scene = heap, .dt = 2e-5, .nwindow = 2, .nstep = 50, .ncoupled = 1, .contacts = true},
             once = {.scene = heap, .dt = 2e-5, .nwindow = 1, .nstep = 1100, .ncoupled = 1, .contacts = true};
  if (_i >= 2)
    compare_on(three, _i == 2 ? &once : &few, ck_bed);
  else
    compare(&often, ck_bed);
}
END_TEST

/* a bed that settles under a pressing lid before the run, is stored, and read again */
static char store[64];

static json_t *settled(int threads) {
  return scene_json("{" TWO PAIRS
                    ",'bodies':[" BOX(",'lid':{'face':'+z','gap':0.002,'press':20}") "],'particles':[" MANY(
                        "-0.245", "0") "],'settle':{'speed':0.05,'max_time':0.01,'drag':100,'store':'%s'}}",
                    threads, store);
}

START_TEST(bed_that_settles) {
  /* alone, and on three ranks: each settles and stores, the other reads it */
  const kind k = {.scene = settled, .dt = 2e-5, .nwindow = 2, .nstep = 20, .ncoupled = 1};
  outcome out[4] = {{0}};
  static const int ranks[] = {1, 3, 3, 1};
  for (int i = 0; i < 4; i++) {
    out[i] = (outcome){.kind = &k, .threads = 1};
    snprintf(store, sizeof store, "%s/%d.bed", folder, i / 2);
    on_ranks(ranks[i], lead, &out[i]);
  }
  ck_same(&out[0], &out[2], 3);
  ck_same(&out[3], &out[1], 3);
  for (int i = 0; i < 4; i++) {
    snprintf(store, sizeof store, "%s/%d.bed", folder, i / 2);
    ck_assert_int_eq(remove(store), i % 2 ? -1 : 0);
    let_go(&out[i]);
  }
}
END_TEST

/* ---- laws of contacts that act on each other ---- */

/* sums over a particle's contacts; what each contact tells the others, once and over again; in a box that is carried,
 * with walls that turn, and in one that repeats */
static const struct {
  const char *contact, *key;
} among[] = {{"'multi_contact':'mc-stress','self_contribution':'exclude'", ",'beta':2}"},
             {"'multi_contact':'mc-strain'", ",'gamma':0.5}"},
             {"'multi_contact':'mc-strain','first_forces':'hertz','iterations':4,'tolerance':1e-3", ",'gamma':0.5}"}};
static int law;

static json_t *pairs_among(void) {
  char text[512];
  const char *key = among[law].key;
  snprintf(text, sizeof text,
           "[{'materials':['a','a'],'restitution':0.5,'friction':0.4%s,{'materials':['a','b'],'restitution':0.6,"
           "'friction':0.3%s,{'materials':['b','b'],'restitution':0.4,'friction':0.5%s]",
           key, key, key);
  return scene_json("%s", text);
}

static json_t *soft_bed(int threads) {
  json_t *scene = scene_json(
      "{" TWO "],'contact':{%s},'energy':true,'bodies':[" BOX(
          OPEN) ",{'name':'paddle','material':'b','shapes':[{'type':'box','side':'outside','size':[0.15,0.01,0.06]}],"
                "'position':[0,0,-0.215],'motion':{'angular_velocity':[0,0,40]}}],'particles':[" MANY("-0.175",
                                                                                                      "0.03") "]}",
      threads, among[law].contact);
  json_object_set_new(scene, "pairs", pairs_among());
  return scene;
}

#define THROWN(low, high, v)                                                                                          \
  "{'type':'random','material':'a','count':2300,'radius':[0.0045,0.0055],'region':{'min':[-0.1,-0.1," low "],'max':[" \
  "0.1,0.1," high "]},'velocity':[3,2," v "]}"

static json_t *soft_box(int threads) {
  json_t *scene =
      scene_json("{" TWO "],'contact':{%s},'energy':true,'gravity':[0,0,0],'domain':{'min':[-0.1,-0.1,"
                 "-0.1],'max':[0.1,0.1,0.1],'x':'periodic','y':'periodic','z':'periodic'},'particles':[" THROWN(
                     "-0.1", "-0.006", "3") "," THROWN("0.006", "0.1", "-3") "]}",
                 threads, among[law].contact);
  json_object_set_new(scene, "pairs", pairs_among());
  return scene;
}

START_TEST(contacts_that_act_on_each_other) {
  law = _i / 2;
  if (_i % 2 == 0)
    compare(
        &(kind){
            .scene = soft_bed, .dt = 2e-5, .nwindow = 8, .nstep = 25, .ncoupled = 1, .carried = true, .contacts = true},
        ck_carried);
  else
    compare(&(kind){.scene = soft_box, .dt = 2e-5, .nwindow = 4, .nstep = 50, .contacts = true, .stays = true}, ck_bed);
}
END_TEST

/* ---- what is refused ---- */

typedef struct {
  json_t *scene;
  tdm_error err;
} refusal;

static void lead_refused(void *context) {
  refusal *r = context;
  const tdm_assignment assignment = {.scene = r->scene, .time_end = 1, .dt = 1e-5, .n = 1};
  dem_engine *e = NULL;
  dem_engine_create(&e, &assignment, NULL, &r->err);
  ck_assert_ptr_null(e);
}

START_TEST(what_is_refused) {
  static const struct {
    const char *more, *path;
  } cases[] = {
      {",'ranks':2", "dem.ranks"},
      {",'ranks':5000", "dem.ranks"},
      {",'no_such_key':1", "dem.no_such_key"}, /* as alone */
  };
  for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
    refusal r = {.scene = scene_json("{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25"
                                     "}],'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],"
                                     "'particles':[]%s}",
                                     cases[i].more)};
    on_ranks(3, lead_refused, &r);
    ck_assert_int_eq(r.err.status, TDM_ERR_SCENE);
    ck_assert_str_eq(r.err.path, cases[i].path);
    json_decref(r.scene);
  }
}
END_TEST

/* Ranks that were not built alike: what rank 1 has instead. */
typedef struct {
  void (*change)(dem_rank_build *build);
  const char *said[3];
} unlike;

static void no_change(dem_rank_build *build) {
  (void)build;
}

static void other_version(dem_rank_build *build) {
  build->version[0]++;
}

static void other_program(dem_rank_build *build) {
  build->program = dem_rank_build_program();
}

static void other_order(dem_rank_build *build) {
  build->order = __builtin_bswap32(build->order);
}

static void other_numbers(dem_rank_build *build) {
  build->number = (float)build->number;
}

static void other_records(dem_rank_build *build) {
  build->size += 8;
}

static void compare_builds(const dem_ranks *ranks, void *context) {
  unlike *u = context;
  dem_rank_build build = dem_rank_build_here();
  if (ranks->rank == 1)
    u->change(&build);
  u->said[ranks->rank] = dem_ranks_differ(ranks, &build);
}

START_TEST(ranks_that_differ) {
  void (*const changes[])(dem_rank_build *) = {no_change,   other_version, other_program,
                                               other_order, other_numbers, other_records};
  unlike u = {.change = changes[_i]};
  each_rank(3, compare_builds, &u);
  for (int r = 0; r < 3; r++) { /* all of them end, and none waits for another */
    ck_assert((u.said[r] == NULL) == (_i == 0));
    ck_assert(_i == 0 || strstr(u.said[r], "different builds of tandem, or on machines of different kinds"));
  }
}
END_TEST

int main(void) {
  const test_row rows[] = {{bed_that_is_stirred, 1},
                           {windows_that_are_tried_twice, 1},
                           {windows_without_samples, 1},
                           {start_outside_the_box, 1},
                           {box_that_is_carried, 1},
                           {bed_on_triangles, 1},
                           {particles_that_come_and_go, 1},
                           {particles_that_are_screened, 1},
                           {box_that_repeats, 4},
                           {heap_that_slides, 4},
                           {bed_that_settles, 1},
                           {contacts_that_act_on_each_other, 6},
                           {what_is_refused, 1},
                           {ranks_that_differ, 6}};
  char clear[64];
  if (!mkdtemp(folder))
    return EXIT_FAILURE;
  const int status = test_run("dem_ranks", rows, sizeof rows / sizeof *rows);
  snprintf(clear, sizeof clear, "rm -r '%s'", folder);
  return system(clear) == 0 ? status : EXIT_FAILURE;
}
