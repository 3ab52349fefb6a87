/* The files of frames are the same bytes on any number of ranks, each of which writes its share; a rank that cannot is
 * told of. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/dem.h"
#include "dem/exchange/keep.h"
#include "protocol/output/outputs.h"
#include "test_ranks_support.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <errno.h>
#include <sys/stat.h>
#include <unistd.h>

enum { WINDOWS = 5, STEPS = 60 };
static const double dt = 2e-5;

/* A run with frames, which go to a folder of their own. */
typedef struct {
  const char *name;
  bool lost;    /* other ranks are told of a folder that is not there */
  bool blocked; /* rank 0 cannot write the walls */
  tdm_error err;
  int nparticle, nranges; /* at the end; ranges of rank 0's last share */
} frames_run;

/* Particles of three blocks of ids, which turn; they come, out of a box and of a sink they go, many of the first. */
static json_t *shower(void) {
  return scene_json(
      "{'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}],'orientation':true,"
      "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],'bodies':[{'name':'floor','material':'a',"
      "'shapes':[{'type':'plane','normal':[0,0,1],'point':[0,0,-0.25]}]}],'domain':{'min':[-0.11,-0.11,-0.3],"
      "'max':[0.11,0.11,0.3]},'particles':[{'type':'random','material':'a','count':2500,'radius':0.003,'region':"
      "{'min':[-0.1,-0.1,-0.24],'max':[0.1,0.1,-0.1]},'velocity':[4,0,-1]},{'type':'random','material':'a',"
      "'count':3000,'radius':[0.0035,0.004],'region':{'min':[-0.1,-0.1,-0.09],'max':[0.1,0.1,0.1]},'velocity':"
      "[0,0,-3]}],'sources':[{'name':'tap','material':'a','radius':0.003,'rate':150000,'region':{'min':[-0.1,-0.1,0.2],"
      "'max':[0.1,0.1,0.29]},'velocity':[0,0,-5]}],'sinks':[{'name':'hole','type':'box','min':[-0.05,-0.1,-0.26],"
      "'max':[0.05,0.1,-0.15],'classes':[0.0032]}]}");
}

typedef struct {
  dem_engine *engine;
  tdm_snapshot *share;
  bool lost;
} sharers;

static tdm_status write_shares(void *self, const tdm_shared_frame *frame, tdm_error *err) {
  const sharers *s = self;
  tdm_shared_frame there = *frame;
  if (s->lost)
    snprintf(there.dir, sizeof there.dir, "%s", TANDEM_TEST_DIR "/nowhere");
  return dem_engine_write_shares(s->engine, s->share, &there, err);
}

static void make_windows(frames_run *run, dem_engine *e, tdm_outputs *o) {
  const double h = STEPS * dt;
  for (int w = 0; w <= WINDOWS && !run->err.status; w++) {
    const dem_window window = {.t0 = (w - 1) * h, .t1 = w * h, .nstep = STEPS};
    if (w > 0)
      dem_engine_advance(e, &window, &(dem_outcome){0}, &run->err);
    if (!run->err.status && !dem_engine_share(e, &o->snapshot, &run->err))
      tdm_outputs_write(o, &o->snapshot, &run->err);
  }
}

static void lead(void *context) {
  frames_run *run = context;
  char dir[256];
  snprintf(dir, sizeof dir, TANDEM_TEST_DIR "/%s", run->name);
  directory_remove(dir);
  dem_keep_poisons = true;
  const tdm_results_def def = {.dir = dir, .log = "log", .force = true};
  const tdm_outputs_settings settings = {.particles_interval = STEPS * dt};
  const tdm_assignment assignment = {.scene = shower(), .time_end = WINDOWS * STEPS * dt, .dt = dt, .n = STEPS};
  tdm_results results = {0};
  tdm_outputs o = {0};
  dem_engine *e = NULL;
  ck_assert_msg(!tdm_results_open(&results, &def, &run->err) && !tdm_results_start(&results, &run->err), "%s",
                run->err.message);
  if (run->blocked) {
    strcat(dir, "/walls_000000.vtp");
    ck_assert(mkdir(dir, 0777) == 0 || errno == EEXIST);
  }
  ck_assert_msg(!dem_engine_create(&e, &assignment, NULL, &run->err), "%s: %s", run->err.path, run->err.message);
  sharers with = {e, &o.snapshot, run->lost};
  o.sharers = (tdm_sharers){write_shares, &with};
  ck_assert(!dem_engine_scenery(e, &o.scenery, &run->err) &&
            !tdm_outputs_begin(&o, &settings, &results, WINDOWS * STEPS * dt, dt, &run->err));
  make_windows(run, e, &o);
  run->nparticle = dem_engine_data(e)->state.nparticle;
  run->nranges = o.snapshot.nrange;
  ck_assert(o.snapshot.nall == run->nparticle);
  tdm_outputs_end(&o);
  tdm_results_close(&results);
  dem_engine_destroy(&e);
  json_decref(assignment.scene);
}

static char *read_file(const char *dir, const char *name, size_t *size) {
  char path[512];
  snprintf(path, sizeof path, TANDEM_TEST_DIR "/%s/%s", dir, name);
  FILE *f = fopen(path, "rb");
  ck_assert_msg(f != NULL, "%s is not there", path);
  fseek(f, 0, SEEK_END);
  *size = (size_t)ftell(f);
  rewind(f);
  char *bytes = malloc(*size + 1);
  ck_assert_uint_eq(fread(bytes, 1, *size, f), *size);
  fclose(f);
  return bytes;
}

/* A later run may remove the files of particles: the mark of the folder names them. */
static void ck_owned(const char *dir) {
  size_t size;
  char *mark = read_file(dir, ".tandem", &size);
  mark[size] = '\0';
  ck_assert_ptr_nonnull(strstr(mark, "file particles_000000.vtp\n"));
  free(mark);
}

static void ck_same_file(const char *a, const char *b, const char *name) {
  size_t na, nb;
  char *x = read_file(a, name, &na), *y = read_file(b, name, &nb);
  ck_assert_msg(na == nb && memcmp(x, y, na) == 0, "%s: %zu bytes in %s, %zu others in %s", name, na, a, nb, b);
  free(x);
  free(y);
}

START_TEST(the_same_files) {
  static const int sizes[] = {2, 3, 5};
  static const char *const names[] = {"frames-2", "frames-3", "frames-5"};
  frames_run alone = {.name = "frames-1"};
  lead(&alone);
  ck_assert_msg(!alone.err.status, "%s", alone.err.message);
  ck_assert_int_eq(alone.nranges, 1);
  ck_assert_int_ne(alone.nparticle, 5500);
  for (int k = 0; k < 3; k++) {
    frames_run on = {.name = names[k]};
    on_ranks(sizes[k], lead, &on);
    ck_assert_msg(!on.err.status, "%s", on.err.message);
    for (int w = 0; w <= WINDOWS; w++) {
      char name[64];
      snprintf(name, sizeof name, "particles_%06d.vtp", w);
      ck_same_file(alone.name, on.name, name);
      snprintf(name, sizeof name, "walls_%06d.vtp", w);
      ck_same_file(alone.name, on.name, name);
    }
    ck_same_file(alone.name, on.name, TDM_FRAMES_FILE);
    ck_same_file(alone.name, on.name, "scene.pvd");
    ck_owned(on.name);
  }
  tdm_frames frames;
  tdm_error err = {0};
  ck_assert_msg(!tdm_frames_open(&frames, TANDEM_TEST_DIR "/frames-5", &err), "%s", err.message);
  ck_assert(frames.count == WINDOWS + 1 && !frames.cut);
  tdm_frames_close(&frames);
}
END_TEST

static void ck_no_particles(const char *dir) {
  char path[512];
  for (int part = 0; part < 2; part++) {
    snprintf(path, sizeof path, TANDEM_TEST_DIR "/%s/particles_000000.vtp%s", dir, part ? ".part" : "");
    ck_assert_int_ne(access(path, F_OK), 0);
  }
}

/* The run ends; of the frame that is not whole nothing is left or listed, and what was there before can be read. */
START_TEST(a_rank_that_cannot_write) {
  frames_run run = {.name = "frames-lost", .lost = true};
  on_ranks(3, lead, &run);
  ck_assert_int_eq(run.err.status, TDM_ERR_FILE);
  ck_assert_msg(strncmp(run.err.message, "rank 1 of 3: ", 13) == 0, "%s", run.err.message);
  ck_no_particles("frames-lost");
  size_t size;
  char *list = read_file(run.name, "scene.pvd", &size);
  list[size] = '\0';
  ck_assert_ptr_null(strstr(list, "particles_000000"));
  free(list);
  tdm_frames frames;
  tdm_error err = {0};
  ck_assert_msg(!tdm_frames_open(&frames, TANDEM_TEST_DIR "/frames-lost", &err), "%s", err.message);
  ck_assert(frames.count == 0 && frames.cut);
  tdm_frames_close(&frames);
}
END_TEST

/* Of what the others did not write nothing is left when another file of the frame cannot be written. */
START_TEST(walls_that_cannot_be_written) {
  frames_run run = {.name = "frames-blocked", .blocked = true};
  on_ranks(3, lead, &run);
  ck_assert_int_eq(run.err.status, TDM_ERR_FILE);
  ck_assert_ptr_nonnull(strstr(run.err.message, "walls_000000.vtp"));
  ck_no_particles("frames-blocked");
}
END_TEST

TEST_MAIN("dem_ranks_frames", the_same_files, a_rank_that_cannot_write, walls_that_cannot_be_written)
