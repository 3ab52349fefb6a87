/* Out of memory: the n-th allocation fails, for n throughout reading a scene, computing it, saving and restoring. Each
 * time the work ends with a status, or as it would have ended with memory; nothing leaks and nothing crashes. The
 * allocator of this program stands in for the C library's, also where jansson, GSL and SUNDIALS allocate.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define _GNU_SOURCE
#include "dem/dem.h"
#include "dem/state/data.h"
#include "dem/store/state_file.h"
#include "mbd/mbd.h"
#include "protocol/base/memory.h"
#include "protocol/math/hash.h"
#include "protocol/parameters/load.h"
#include "tests/scene_json.h"
#include "tests/test_main.h"

#include <dlfcn.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- an allocator that fails once ---- */

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t n, size_t size);
void *__libc_realloc(void *p, size_t size);
void *__libc_memalign(size_t alignment, size_t size);
void __libc_free(void *p);

static atomic_long calls, fails_at, live; /* allocations so far; the one that fails, 0: none; blocks there are */

static atomic_bool excused; /* the one that failed was GSL's, which loses a matrix whose block it does not get */

/* Of a library that ends the process or runs through NULL when there is no memory: OpenMP's; SUNDIALS where it clones
 * vectors and makes its logger; GSL's where LU permutes; that of C++, whose exceptions C cannot catch (muParser). */
static bool is_fatal(void *caller) {
  static const char *const names[] = {"N_V", "SUNLogger_Create", "gsl_block_uint_alloc", "gsl_vector_uint_alloc"};
  Dl_info info;
  if (!dladdr(caller, &info) || !info.dli_fname)
    return false;
  excused = strstr(info.dli_fname, "libgsl.") != NULL;
  bool fatal = strstr(info.dli_fname, "libgomp.") || strstr(info.dli_fname, "libstdc++.") ||
               (strstr(info.dli_fname, "libsundials") && !info.dli_sname);
  for (size_t k = 0; k < sizeof names / sizeof *names; k++)
    fatal = fatal || (info.dli_sname && strncmp(info.dli_sname, names[k], strlen(names[k])) == 0);
  return fatal;
}

static bool fails(void *caller) {
  const long at = fails_at;
  if (at == 0 || ++calls != at || is_fatal(caller))
    return false;
  errno = ENOMEM;
  return true;
}

void *memalign(size_t alignment, size_t size);

static void *counted(void *p) {
  live += p != NULL;
  return p;
}

void *malloc(size_t size) {
  return fails(__builtin_return_address(0)) ? NULL : counted(__libc_malloc(size));
}

void *calloc(size_t n, size_t size) {
  return fails(__builtin_return_address(0)) ? NULL : counted(__libc_calloc(n, size));
}

void *realloc(void *p, size_t size) {
  if (fails(__builtin_return_address(0)))
    return NULL;
  void *moved = __libc_realloc(p, size);
  live += !p && moved;
  return moved;
}

void *aligned_alloc(size_t alignment, size_t size) {
  return fails(__builtin_return_address(0)) ? NULL : counted(__libc_memalign(alignment, size));
}

void *memalign(size_t alignment, size_t size) {
  return fails(__builtin_return_address(0)) ? NULL : counted(__libc_memalign(alignment, size));
}

int posix_memalign(void **p, size_t alignment, size_t size) {
  if (fails(__builtin_return_address(0)))
    return ENOMEM;
  *p = counted(__libc_memalign(alignment, size));
  return *p ? 0 : ENOMEM;
}

void free(void *p) {
  live -= p != NULL;
  __libc_free(p);
}

/* ---- a piece of work, again and again ---- */

/* Does all and frees it. *hash: of what came out, if it is TDM_OK. */
typedef tdm_status (*work)(uint64_t *hash, tdm_error *err);

/* How a process ends in which the n-th allocation fails. */
enum { FINE, DONE, WRONG_MESSAGE, LEAK, OTHER_RESULT };

static int fail_once(work what, long n, uint64_t wanted) {
  tdm_error err = {0};
  uint64_t hash = 0;
  long before = live;
  calls = 0;
  fails_at = n;
  tdm_status status = what(&hash, &err);
  fails_at = 0;
  long left = live - before;
  if (calls < n)
    return DONE;
  if (status != TDM_OK && !strstr(err.message, "memory")) /* a file that cannot be opened may say so too */
    return WRONG_MESSAGE;
  if (left != 0 && !excused)
    return LEAK;
  return status == TDM_OK && hash != wanted ? OTHER_RESULT : FINE;
}

static void fail_everywhere(work what) {
  tdm_error err = {0};
  uint64_t wanted, again;
  ck_assert_msg(what(&wanted, &err) == TDM_OK, "%s: %s", err.path, err.message); /* and what is made once is there */
  ck_assert(what(&again, &err) == TDM_OK && wanted == again);
  int bad = 0;
  for (long n = 1;; n += 1 + n / 200) { /* of many that are alike, some */
    fflush(NULL);
    pid_t child = fork();
    ck_assert_int_ge(child, 0);
    if (child == 0)
      _exit(fail_once(what, n, wanted));
    int how;
    ck_assert_int_eq(waitpid(child, &how, 0), child);
    if (WIFEXITED(how) && WEXITSTATUS(how) == DONE) {
      ck_assert_int_gt(n, 50);
      printf("%ld allocations\n", n);
      break;
    }
    if (!WIFEXITED(how) || WEXITSTATUS(how) != FINE) {
      printf("allocation %ld: %s %d\n", n, WIFEXITED(how) ? "ends" : "signal",
             WIFEXITED(how) ? WEXITSTATUS(how) : WTERMSIG(how));
      bad++;
    }
  }
  ck_assert_int_eq(bad, 0);
}

/* ---- the works ---- */

/* without an allocation that could fail */
static uint64_t hash_report(const json_t *report) {
  const long at = fails_at;
  fails_at = 0;
  char *text = json_dumps(report, JSON_SORT_KEYS);
  fails_at = at;
  uint64_t h = tdm_hash_bytes(TDM_HASH_START, text, strlen(text));
  free(text);
  return h;
}

/* grains that are made, roll and leave, on a mesh and a wall, with histories and energies */
static const char grains[] =
    "{'materials':[{'name':'a','density':1000,'young_modulus':1e6,'poisson_ratio':0.25},{'name':'b','density':2000,"
    "'young_modulus':1e6,'poisson_ratio':0.3}],'pairs':[{'materials':['a','a'],'restitution':0.3,'friction':0.4},"
    "{'materials':['a','b'],'restitution':0.3,'friction':0.4},{'materials':['b','b'],'restitution':0.3,'friction':0.4}]"
    ","
    "'bodies':[{'name':'plate','material':'a','shapes':[{'type':'plane','normal':[0,0,1]},{'type':'mesh','file':'%s'},{"
    "'type':'screen',"
    "'deck':'plate','hole':0.01,'bar':0.005,'radius':0.05,'center':[0,0,0.01]}]}"
    ","
    "{'name':'bin','material':'b','shapes':[{'type':'box','side':'inside','size':[0.3,0.3,0.4],'center':[0,0,0.2]}]}],"
    "'particles':[{'type':'random','material':'a','count':60,'radius':[0.008,0.012],'region':{'min':[-0.1,-0.1,0.02],"
    "'max':[0.1,0.1,0.2]},'velocity':[0,0,-1]}],"
    "'sources':[{'name':'tap','material':'b','radius':0.005,'rate':8000,'region':{'min':[-0.1,-0.1,0.2],'max':[0.1,0.1,"
    "0.3]},'velocity':[0,0,-2]}],'sinks':[{'name':'drain','type':'box','min':[-1,0.05,-1],'max':[1,0.2,0.05],'classes':"
    "[0.01]}],'screening':{'decks':[{'name':'deck','outlets':['drain'],'screen':{'body':'plate','shape':2}}]},"
    "'paths':[{'name':'one','particle':5,'source':'tap','body':'bin'}],'energy':true,'threads':1}";

/* a box on a rail with friction, a spring and a bushing, and a motor that turns a second body by a table of angles */
static const char mechanism[] =
    "{'parameters':{'m':'=50*two','two':2},'mbd':{'formulation':'%s','bodies':[{'if':0},{'name':'box','mass':'=m',"
    "'inertia':[10,10,10],'position':[0,0,0]},{'name':"
    "'arm','mass':10,'inertia':[1,1,1],'position':[0.5,0,0]},{'name':'bob','mass':1,'inertia':[0.1,0.1,0.1],'position':"
    "[2,0,0]}],'joints':[{'name':'rail','type':'prismatic','bodies':['ground','box'],'point':[0,0,0],'axis':[0,0,1]},"
    "{'name':'pin','type':'revolute','bodies':['box','arm'],'point':[0,0,0],'axis':[0,1,0]},{'name':'ball','type':"
    "'spherical','bodies':['arm','bob'],'point':[1,0,0]}],"
    "'drivers':[{'name':'motor','type':'rotational_motor','joint':'pin','motion':{'type':'harmonic','amplitude':'=m/"
    "1e3',"
    "'frequency':2}}],"
    "'forces':[{'name':'spring','type':'spring_damper','bodies':['ground','box'],'points':[[0,0,2],[0,0,0]],'stiffness'"
    ":5000,'damping':100,'preload':100},{'name':'rubs','type':'friction','joint':'rail','coefficient':0.1}]}}";

static tdm_status read_section(tdm_scene *scene, json_t **section, const char *file, const char *role, tdm_error *err) {
  if (tdm_scene_load(scene, file, NULL, err))
    return err->status;
  *section = tdm_scene_section(scene->root, role);
  return *section ? TDM_OK : tdm_fail(err, TDM_ERR_MEMORY, role, "no memory for the section");
}

enum { NCHANNEL_MAX = 256 };

static char dem_file[512], mbd_file[512];

/* windows, of which the second is gone back to; the state as bytes meanwhile */
static tdm_status move_grains(dem_engine *engine, uint64_t *hash, tdm_error *err) {
  double channel[NCHANNEL_MAX] = {0};
  for (int k = 0; k < 4; k++) {
    const double end = (k + 1) * 2e-3;
    const dem_window window = {.t0 = k * 2e-3, .t1 = end, .nstep = 20, .nsample = 1, .sample_time = &end};
    if (k == 1 && dem_engine_save(engine, 0, err))
      return err->status;
    if (dem_engine_advance(engine, &window, &(dem_outcome){.channel = channel}, err))
      return err->status;
    *hash = tdm_hash_bytes(*hash, channel, sizeof channel);
    void *bytes = NULL;
    size_t size = 0;
    if (k == 2 && dem_state_save(dem_engine_data(engine), &bytes, &size))
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the state");
    *hash = tdm_hash_bytes(*hash, bytes, size);
    free(bytes);
  }
  const double end = 4e-3;
  const dem_window again = {.t0 = 2e-3, .t1 = end, .nstep = 20, .nsample = 1, .sample_time = &end};
  if (dem_engine_restore(engine, 0, err) || dem_engine_advance(engine, &again, &(dem_outcome){.channel = channel}, err))
    return err->status;
  *hash = tdm_hash_bytes(*hash, channel, sizeof channel);
  return TDM_OK;
}

static tdm_status grains_work(uint64_t *hash, tdm_error *err) {
  tdm_scene scene = {0};
  json_t *section = NULL;
  dem_engine *engine = NULL;
  const tdm_assigned_body plate = {.name = "plate", .mass = 1, .state.pose.orientation.w = 1};
  *hash = TDM_HASH_START;
  if (!read_section(&scene, &section, dem_file, "dem", err)) {
    const tdm_assignment assignment = {
        .scene = section, .time_end = 0.01, .dt = 1e-4, .n = 1, .nbody = 1, .body = &plate, .matched_load = true};
    if (!dem_engine_create(&engine, &assignment, NULL, err)) {
      *hash = hash_report(dem_engine_start(engine)->report);
      move_grains(engine, hash, err);
    }
  }
  dem_engine_destroy(&engine);
  json_decref(section);
  tdm_scene_destroy(&scene);
  return err->status;
}

static tdm_status move_mechanism(mbd_engine *engine, uint64_t *hash, tdm_error *err) {
  double channel[NCHANNEL_MAX] = {0};
  for (int k = 0; k < 4; k++) {
    const double end = (k + 1) * 1e-3;
    const tdm_wrench load[3] = {{.force = {0, 1, -100.0 * k}}};
    const mbd_window window = {
        .t0 = k * 1e-3, .t1 = end, .nload = 3, .load = load, .nsample = 1, .sample_time = &end, .ahead = end + 1e-3};
    tdm_state state;
    tdm_nodes path;
    double acceleration[6];
    tdm_mobility mobility;
    const mbd_outcome out = {
        .state = &state, .acceleration = acceleration, .mobility = &mobility, .path = &path, .channel = channel};
    if ((k == 1 && mbd_engine_save(engine, 0, err)) || (k == 3 && mbd_engine_restore(engine, 0, err)))
      return err->status;
    mbd_window now = window;
    if (k == 3) {
      now.t0 = 1e-3;
      now.t1 = 2e-3;
      now.nsample = 0;
      now.ahead = 3e-3;
    }
    if (mbd_engine_advance(engine, &now, &out, err))
      return err->status;
    *hash = tdm_hash_bytes(*hash, channel, sizeof channel);
    *hash = tdm_hash_bytes(*hash, &state, sizeof state);
  }
  return TDM_OK;
}

static tdm_status mechanism_work(uint64_t *hash, tdm_error *err) {
  tdm_scene scene = {0};
  json_t *section = NULL;
  mbd_engine *engine = NULL;
  const tdm_assigned_body box = {.name = "box"};
  *hash = TDM_HASH_START;
  if (!read_section(&scene, &section, mbd_file, "mbd", err)) {
    const tdm_assignment assignment = {.scene = section,
                                       .time_end = 0.01,
                                       .dt = 1e-3,
                                       .n = 1,
                                       .nbody = 1,
                                       .body = &box,
                                       .acceleration = true,
                                       .mobility = true,
                                       .restores = true,
                                       .ahead = 1e-3};
    if (!mbd_engine_create(&engine, &assignment, NULL, err)) {
      *hash = hash_report(mbd_engine_start(engine)->report);
      move_mechanism(engine, hash, err);
    }
  }
  mbd_engine_destroy(&engine);
  json_decref(section);
  tdm_scene_destroy(&scene);
  return err->status;
}

/* a message that is made, written and read again */
static tdm_status message_work(uint64_t *hash, tdm_error *err) {
  double numbers[20] = {1, 2, 3};
  tdm_frame frame = {0};
  tdm_header header;
  json_t *back = NULL;
  tdm_memory_watch_json();
  json_t *json = json_pack("{s:o, s:o}", "a", tdm_numbers_to_json(numbers, 20), "b", tdm_numbers_to_json(numbers, 3));
  if (!tdm_control_write(&frame, TDM_READY, 0, json, err) && !tdm_header_read(&header, frame.data, frame.size, err) &&
      !tdm_control_read(&header, &back, err))
    *hash = hash_report(back);
  json_decref(back);
  json_decref(json);
  tdm_frame_free(&frame);
  return err->status;
}

/* ---- tests ---- */

static const char *formulation;

static void write_file(const char *name, const char *text) {
  FILE *f = fopen(name, "w");
  ck_assert(f && fputs(text, f) >= 0 && fclose(f) == 0);
}

START_TEST(test_dem) {
  char mesh[512], text[8192];
  snprintf(mesh, sizeof mesh, "%s/test_out_of_memory.stl", TANDEM_TEST_DIR);
  snprintf(dem_file, sizeof dem_file, "%s/test_out_of_memory.dem.json", TANDEM_TEST_DIR);
  write_file(mesh, "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0.02\nvertex 0.1 0 0.02\nvertex 0 0.1 0.02\n"
                   "endloop\nendfacet\nendsolid s\n");
  snprintf(text, sizeof text, "{'dem':");
  snprintf(text + strlen(text), sizeof text - strlen(text), grains, mesh);
  strcat(text, "}");
  double_quotes(text);
  write_file(dem_file, text);
  fail_everywhere(grains_work);
  unlink(mesh);
  unlink(dem_file);
}
END_TEST

START_TEST(test_message) {
  fail_everywhere(message_work);
}
END_TEST

START_TEST(test_mbd) {
  static const char *const formulations[] = {"ggl", "one_step"};
  char text[8192];
  formulation = formulations[_i];
  snprintf(mbd_file, sizeof mbd_file, "%s/test_out_of_memory.mbd.json", TANDEM_TEST_DIR);
  snprintf(text, sizeof text, mechanism, formulation);
  double_quotes(text);
  write_file(mbd_file, text);
  fail_everywhere(mechanism_work);
  unlink(mbd_file);
}
END_TEST

TEST_MAIN_ROWS("out of memory", {test_message, 1}, {test_dem, 1}, {test_mbd, 2})
