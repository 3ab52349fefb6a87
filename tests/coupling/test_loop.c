/* The loop goes back: after cpl_loop_restore the same windows come, bit for bit, whatever the fields that are set
 * WITHIN a window hold meanwhile. A field that is carried from window to window, but not listed so, fails here. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/window.h"
#include "coupler/scheme/schemes.h"
#include "dem/adapter/solver.h"
#include "mbd/adapter/solver.h"
#include "protocol/math/gsl_errors.h"
#include "tests/coupling/seam_run.h"
#include "tests/test_main.h"

enum { SLOT = 3, WINDOWS = 4 };
static const char endpoint[] = "inproc://loop";

/* A deck on a spring on a vibrating base, and a grain on it: MBD tells the path ahead. Output times and windows are out
 * of step. */
static const char vibrating[] =
    "{'time': {'end': 0.15, 'dt': 2e-5},\n"
    " 'coupling': {'n': 100, 'transport': 'inproc', 'bodies': [{'mbd': 'deck', 'dem': 'deck'}]},\n"
    " 'output': {'interval': 1.3e-3},\n"
    " 'mbd': {'bodies': [{'name': 'deck', 'mass': 2, 'inertia': [1, 1, 1], 'position': [0, 0, 0]},\n"
    "   {'name': 'base', 'mass': 5, 'inertia': [1, 1, 1], 'position': [0, 0, -0.2]}],\n"
    "  'joints': [{'name': 'rail', 'type': 'prismatic', 'bodies': ['ground', 'base'], 'point': [0, 0, 0],\n"
    "    'axis': [0, 0, 1]},\n"
    "   {'name': 'slide', 'type': 'prismatic', 'bodies': ['base', 'deck'], 'point': [0, 0, 0], 'axis': [0, 0, 1]}],\n"
    "  'forces': [{'name': 'spring', 'type': 'spring_damper', 'bodies': ['base', 'deck'],\n"
    "   'points': [[0, 0, -0.2], [0, 0, 0]], 'stiffness': 20000, 'damping': 20}],\n"
    "  'drivers': [{'name': 'shake', 'type': 'linear_motor', 'joint': 'rail',\n"
    "   'motion': {'type': 'harmonic', 'amplitude': 0.0015, 'frequency': 40}}]},\n"
    " 'dem': {'materials': [{'name': 'grain', 'density': 2500, 'young_modulus': 1e7, 'poisson_ratio': 0.3}],\n"
    "  'pairs': [{'materials': ['grain', 'grain'], 'restitution': 0.3, 'friction': 0.3}],\n"
    "  'bodies': [{'name': 'deck', 'material': 'grain', 'shapes': [{'type': 'plane', 'normal': [0, 0, 1]}]}],\n"
    "  'particles': [{'type': 'list', 'material': 'grain', 'radius': 0.02, 'positions': [[0, 0, 0.0199]]}]}}\n";

/* ---- a loop with its session ---- */

typedef struct {
  const char *dir;
  tdm_scene scene;
  cpl_settings settings;
  cpl_session session;
  cpl_loop loop;
  void *context;
  tdm_error err;
} stage;

#define OK(call) ck_assert_msg((call) == TDM_OK, "%s", s->err.message)

static void set_up(stage *s, const cpl_scheme *const *schemes, const char *set) {
  char file[256];
  const tdm_solver_ops *const ops[] = {[CPL_MBD] = &mbd_solver_ops, [CPL_DEM] = &dem_solver_ops};
  tdm_gsl_return_errors();
  *s = (stage){.dir = directory_with_scene(vibrating), .context = tdm_context_create()};
  snprintf(file, sizeof file, "%s/scene.json", s->dir);
  OK(tdm_scene_read(&s->scene, file, &s->err));
  if (set)
    OK(tdm_scene_set(&s->scene, set, &s->err));
  OK(cpl_settings_read(&s->settings, &s->scene, schemes, &s->err));
  OK(cpl_session_open(&s->session, &s->settings, endpoint, s->context, &s->err));
  for (int r = 0; r < CPL_NROLE; r++) {
    snprintf(file, sizeof file, "%s/%s.log", s->dir, cpl_role_names[r]);
    OK(cpl_launch_thread(&s->session.partner[r].child, ops[r], endpoint, s->context, file, 30, &s->err));
  }
  OK(cpl_session_start(&s->session, &s->scene, &s->err));
  OK(cpl_loop_init(&s->loop, &s->settings, &s->session, &s->err));
}

static void clean_up(stage *s) {
  cpl_child *child[CPL_NROLE];
  for (int r = 0; r < CPL_NROLE; r++)
    child[r] = s->session.partner[r].child;
  cpl_session_close(&s->session, &s->err);
  for (int r = 0; r < CPL_NROLE; r++)
    ck_assert(cpl_child_stop(&child[r], 30));
  tdm_context_destroy(&s->context);
  cpl_loop_free(&s->loop);
  cpl_settings_free(&s->settings);
  tdm_scene_destroy(&s->scene);
  directory_remove(s->dir);
}

/* ---- there and back ---- */

typedef enum { FIXED, WITHIN, CARRIED } field_kind;

/* Fill what is set within a window with this byte: 0xff makes NaNs, 0x44 numbers of 1e20. */
static void scramble(cpl_loop *loop, int byte) {
#define VALUE(kind, type, name) \
  if (kind == WITHIN)           \
    memset(&loop->name, byte, sizeof loop->name);
#define ARRAY(kind, type, name, count) \
  if (kind == WITHIN)                  \
    memset(loop->name, byte, (size_t)(count) * sizeof *loop->name);
#define PATH(kind, name)    \
  if (kind == WITHIN)       \
    loop->name.nnode = -77, \
    memset(loop->name.state, byte, TDM_NODES_MAX * (size_t)loop->nbody * sizeof *loop->name.state);
  CPL_LOOP_FIELDS(VALUE, ARRAY, PATH)
#undef VALUE
#undef ARRAY
#undef PATH
}

/* What a window leaves behind. */
typedef struct {
  uint64_t window, step1, next_sample;
  long n;
  int nload, nsample;
  double row;
  tdm_state state;
  tdm_wrench mean;
} trace;

static void go(stage *s, trace out[WINDOWS]) {
  const cpl_observers none = {0};
  memset(out, 0, WINDOWS * sizeof *out);
  for (int k = 0; k < WINDOWS; k++) {
    OK(cpl_loop_advance(&s->loop, &none, &s->err));
    const cpl_loop *loop = &s->loop;
    out[k].window = loop->window;
    out[k].step1 = loop->step1;
    out[k].next_sample = loop->next_sample;
    out[k].n = loop->n;
    out[k].nload = loop->nload;
    out[k].nsample = loop->nsample;
    out[k].row = loop->nsample > 0 ? loop->row_time[0] : 0;
    out[k].state = loop->state_start[0];
    out[k].mean = loop->mean[0];
  }
}

static void expect_return(const cpl_scheme *scheme, const char *set) {
  cpl_scheme row = *scheme;
  for (int r = 0; r < CPL_NROLE; r++)
    row.needs[r] |= CPL_RESTORE;
  const cpl_scheme *const schemes[] = {&row, NULL};
  stage stage_of, *s = &stage_of;
  trace before[WINDOWS], first[WINDOWS], again[WINDOWS];
  set_up(s, schemes, set);
  go(s, before);
  ck_assert(set || s->loop.coming.nnode > 0); /* in long windows a path is told: nodes are carried too */
  OK(cpl_loop_save(&s->loop, SLOT, &s->err));
  go(s, first);
  for (int k = 0; k < 2; k++) {
    OK(cpl_loop_restore(&s->loop, SLOT, &s->err));
    scramble(&s->loop, k ? 0x44 : 0xff);
    go(s, again);
    ck_assert_msg(memcmp(first, again, sizeof first) == 0, "%s %s", scheme->name, set ? set : "");
  }
  ck_assert(memcmp(&before[3].state, &first[3].state, sizeof first[3].state) != 0);
  clean_up(s);
}

START_TEST(the_same_windows_come_again) {
  const struct {
    const cpl_scheme *scheme;
    const char *set;
  } cases[] = {{&cpl_scheme_lommen, NULL},    {&cpl_scheme_hold, NULL},
               {&cpl_scheme_dem_first, NULL}, {&cpl_scheme_dem_first, "coupling.n=\"auto\""},
               {&cpl_scheme_proxy, NULL},     {&cpl_scheme_proxy, "coupling.n=\"auto\""}};
  expect_return(cases[_i].scheme, cases[_i].set);
}
END_TEST

TEST_MAIN_ROWS("loop", {the_same_windows_come_again, 6})
