/* The state of a run, saved and restored: every field of its lists is copied, and nothing beside the lists and the
 * workspace is state. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/integrate/alpha/alpha.h"
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

#include <stddef.h>

/* two bodies, a hinge, a motor, a spring, friction: no list is empty */
static const char *const full_scene =
    "{'bodies':[{'name':'a','mass':1,'inertia':[1,1,1],'position':[0,0,0]},"
    "{'name':'b','mass':2,'inertia':[1,2,2],'position':[1,0,0]}],"
    "'joints':[{'name':'hinge','type':'revolute','bodies':['ground','a'],'point':[0,0,0],'axis':[0,0,1]},"
    "{'name':'guide','type':'prismatic','bodies':['a','b'],'point':[1,0,0],'axis':[1,0,0]}],"
    "'drivers':[{'name':'motor','type':'rotational_motor','joint':'hinge','motion':{'type':'constant_rate','rate':2,"
    "'start':'smooth','rise':0.1}}],"
    "'forces':[{'name':'rub','type':'friction','joint':'guide','coefficient':0.2,'preload':3},"
    "{'name':'spring','type':'spring_damper','bodies':['ground','b'],'points':[[0,2,0],[1,0,0]],'stiffness':40}],"
    "'formulation':'one_step'}";

/* Another value in every byte but those of truth values. */
static void disturb(void *bytes, size_t size, bool truth) {
  unsigned char *at = bytes;
  for (size_t i = 0; i < size; i++)
    at[i] = truth ? !at[i] : (unsigned char)(at[i] ^ 0x15);
}

/* A field that a copy forgets keeps what the other state had. */
START_TEST(every_field_is_copied) {
  run r;
  run_open_good(&r, full_scene, "b");
  const mbd_model *m = mbd_engine_model(r.self);
  mbd_data *from = mbd_data_create(m), *to = mbd_data_create(m);
  ck_assert(from && to && m->nforce > 0 && m->nfriction > 0 && m->ncoupled > 0 && m->nrow > 0);
#define DISTURB_SCALAR(type, name) disturb(&from->name, sizeof from->name, false);
#define DISTURB_ARRAY(type, name, count) \
  disturb(from->name, (size_t)(count) * sizeof *from->name, sizeof *from->name == sizeof(bool));
  MBD_STATE_SCALARS(DISTURB_SCALAR)
  MBD_STATE_ARRAYS(DISTURB_ARRAY)
  mbd_data_copy(m, to, from);
#define CHECK_SCALAR(type, name) ck_assert_msg(memcmp(&to->name, &from->name, sizeof to->name) == 0, "%s", #name);
#define CHECK_ARRAY(type, name, count)                               \
  ck_assert_msg((count) > 0 && to->name != from->name, "%s", #name); \
  ck_assert_msg(memcmp(to->name, from->name, (size_t)(count) * sizeof *to->name) == 0, "%s", #name);
  MBD_STATE_SCALARS(CHECK_SCALAR)
  MBD_STATE_ARRAYS(CHECK_ARRAY)
  mbd_data_destroy(&from);
  mbd_data_destroy(&to);
  run_close(&r);
}
END_TEST

/* What mbd_data has beside its lists: workspace. Who adds a field there decides that it is none of the state. */
typedef struct {
  MBD_STATE_SCALARS(MBD_SCALAR_FIELD)
  MBD_STATE_ARRAYS(MBD_ARRAY_FIELD)
  MBD_WORK_ARRAYS(MBD_ARRAY_FIELD)
  bool index3;
  double now;
  mbd_rows rows;
  mbd_force_value force;
  mbd_stats stats;
} known_data;

typedef struct {
  MBD_ALPHA_SCALARS(MBD_SCALAR_FIELD)
  MBD_ALPHA_ARRAYS(MBD_ARRAY_FIELD)
  mbd_lu *step, *mass;
  double step_length;
  bool mass_made;
} known_memory;

START_TEST(nothing_stands_beside_the_lists) {
  ck_assert_uint_eq(sizeof(mbd_data), sizeof(known_data));
  ck_assert_uint_eq(offsetof(mbd_data, stats), offsetof(known_data, stats));
  ck_assert_uint_eq(sizeof(mbd_alpha_memory), sizeof(known_memory));
}
END_TEST

/* A run that goes on from a saved state has the bits of one that went straight on, friction and motor and all. */
START_TEST(a_restored_run_has_the_same_bits) {
  run r;
  tdm_state straight;
  run_open_good(&r, full_scene, "b");
  run_on(&r, 0.2, 0.01);
  ck_assert_int_eq(mbd_engine_save(r.self, 0, &r.err), TDM_OK);
  const double t = r.t;
  const int n = r.ready.nchannel;
  double *values = calloc((size_t)n, sizeof *values);
  ck_assert_ptr_nonnull(values);
  run_on(&r, 0.4, 0.01);
  straight = r.state[0];
  memcpy(values, r.channel, (size_t)n * sizeof *values);
  tdm_wrench load = {{5, 1, 0}, {0, 0, 2}};
  run_window(&r, r.t + 0.05, &load, 1, 0, NULL); /* astray */
  ck_assert_int_eq(mbd_engine_restore(r.self, 0, &r.err), TDM_OK);
  r.t = t;
  run_on(&r, 0.4, 0.01);
  ck_assert_mem_eq(&straight, &r.state[0], sizeof straight);
  ck_assert_mem_eq(values, r.channel, (size_t)n * sizeof *values);
  free(values);
  run_close(&r);
}
END_TEST

#define SPINNER                                                                                                  \
  "'bodies':[{'name':'a','mass':1,'inertia':[0.1,0.1,0.1],'position':[0.5,0,0],'angular_velocity':[0,20,0],"     \
  "'velocity':[0,0,-10]},{'name':'b','mass':1,'inertia':[0.1,0.1,0.1],'position':[1.5,0,0],'velocity':[0,0,"     \
  "-30],'angular_velocity':[0,20,0]}],'joints':[{'name':'h1','type':'revolute','bodies':['ground','a'],'point'"  \
  ":[0,0,0],'axis':[0,1,0]},{'name':'h2','type':'revolute','bodies':['a','b'],'point':[1,0,0],'axis':[0,1,0]}]," \
  "'forces':[{'name':'t','type':'torsional_spring_damper','joint':'h1','stiffness':1,'damping':0.01}]"

/* window k with a load of its own */
static void random_window(run *r, int k, double extra) {
  uint64_t draw = (unsigned)k * 77u + 1;
  double t1 = 1e-3 * (k + 1);
  tdm_wrench load[2];
  for (int j = 0; j < 2; j++)
    load[j] = (tdm_wrench){{10 * noise(&draw) + extra, 0, 10 * noise(&draw)}, {0, noise(&draw), 0}};
  r->t = 1e-3 * k;
  run_window(r, t1, load, 2, 1, &t1);
}

/* Back and forth between windows, with wrong loads in between: the same bits as without. IDA starts again at each SAVE,
 * so there the other run saves as often. */
START_TEST(back_and_forth_between_windows) {
  static const char *const formulations[] = {"one_step", "ggl"};
  char scene[1024];
  double channels[2][200][8];
  snprintf(scene, sizeof scene, "{" SPINNER ",'formulation':'%s'}", formulations[_i]);
  for (int detour = 0; detour < 2; detour++) {
    run r;
    tdm_error err = {0};
    run_open_good(&r, scene, "b");
    int angle = run_channel(&r, "force.t.angle"), drift = run_channel(&r, "constraint.drift");
    for (int k = 0; k < 200; k++) {
      if (k % 7 == 0 && (detour || _i > 0))
        ck_assert_int_eq(mbd_engine_save(r.self, k % 3, &err), TDM_OK);
      if (k % 7 == 0 && detour) {
        random_window(&r, k, 5);
        random_window(&r, k + 1, 5);
        ck_assert_int_eq(mbd_engine_restore(r.self, k % 3, &err), TDM_OK);
      }
      random_window(&r, k, 0);
      double *to = channels[detour][k];
      mbd_set3(to, r.state[0].pose.position);
      mbd_set3(to + 3, r.state[0].twist.velocity);
      to[6] = r.channel[angle];
      to[7] = r.channel[drift];
    }
    ck_assert_int_eq(mbd_engine_restore(r.self, 9, &err), TDM_ERR_PROTOCOL);
    run_close(&r);
  }
  ck_assert_mem_eq(channels[0], channels[1], sizeof channels[0]);
  ck_assert_double_gt(fabs(channels[0][199][6]), 3); /* it turned */
}
END_TEST

/* a chain of links, long enough for the sparse linear solver */
static char *chain_scene(int nlink, const char *settings) {
  char *text = calloc(1, 400 * (size_t)nlink + 500), *at = text + sprintf(text, "{'bodies':[");
  for (int i = 0; i < nlink; i++)
    at += sprintf(at, "%s{'name':'b%d','mass':1,'inertia':[0.01,0.08,0.09],'position':[%.1f,0,0]}", i ? "," : "", i,
                  i + 0.5);
  at += sprintf(at, "],'joints':[");
  for (int i = 0; i < nlink; i++) {
    at += sprintf(at, "%s{'name':'j%d','type':'revolute','point':[%d,0,0],'axis':[0,1,%g],", i ? "," : "", i, i,
                  i % 2 ? 0.2 : -0.1);
    at += i ? sprintf(at, "'bodies':['b%d','b%d']}", i - 1, i) : sprintf(at, "'bodies':['ground','b0']}");
  }
  sprintf(at, "],%s}", settings);
  return text;
}

START_TEST(a_chain_of_links_and_its_factors) {
  enum { NLINK = 12 };
  char *one_step = chain_scene(NLINK, "'formulation':'one_step'");
  char *ida = chain_scene(NLINK, "'solver':{'relative_tolerance':1e-9}");
  run a, b;
  run_open_good(&a, one_step, "b11");
  run_open_good(&b, ida, "b11");
  run_to(&b, 0.3);
  tdm_state saved = {0};
  for (int k = 0; k < 300; k++) {
    if (k == 250)
      ck_assert_int_eq(mbd_engine_save(a.self, 2, &a.err), TDM_OK);
    run_to(&a, 1e-3 * (k + 1));
    ck_assert_double_lt(run_value(&a, "constraint.drift"), 1e-10);
  }
  ck_assert_double_lt(apart(a.state[0], b.state[0]), 1e-3);
  saved = a.state[0];
  ck_assert_int_eq(mbd_engine_restore(a.self, 2, &a.err), TDM_OK);
  a.t = 0.25;
  for (int k = 250; k < 300; k++)
    run_to(&a, 1e-3 * (k + 1));
  ck_assert_mem_eq(&saved, &a.state[0], sizeof saved);
  run_close(&a);
  run_close(&b);
  free(one_step);
  free(ida);
}
END_TEST

TEST_MAIN_ROWS("mbd_state", {every_field_is_copied, 1}, {nothing_stands_beside_the_lists, 1},
               {a_restored_run_has_the_same_bits, 1}, {back_and_forth_between_windows, 2},
               {a_chain_of_links_and_its_factors, 1})
