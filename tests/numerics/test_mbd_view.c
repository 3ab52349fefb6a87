/* What there is to see of a mechanism: surfaces that enclose the shape's volume, lines between the right places, and a
 * run that is the same with and without a look. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/numerics/test_mbd_support.h"
#include "tests/test_main.h"

#include <math.h>

/* Volume and centre inside the polygons of a body, whose outer side must be where the corners run counterclockwise. */
static double enclosed(const tdm_scenery *s, int body, tdm_vec3 *centre) {
  double volume = 0;
  *centre = tdm_v3(0, 0, 0);
  for (int i = 0; i < s->npolygon; i++) {
    const tdm_view_polygon *p = &s->polygon[i];
    ck_assert(p->solid);
    for (int k = 1; p->body == body && k + 1 < p->ncorner; k++) {
      double part = tdm_dot(p->corner[0], tdm_cross(p->corner[k], p->corner[k + 1])) / 6;
      tdm_vec3 sum = tdm_add(p->corner[0], tdm_add(p->corner[k], p->corner[k + 1]));
      volume += part;
      *centre = tdm_axpy(part / 4, sum, *centre);
    }
  }
  *centre = tdm_scale(1 / volume, *centre);
  return volume;
}

static const struct {
  const char *shape;
  double volume; /* [m3] */
} solids[] = {
    {"'type':'sphere','radius':0.3", 4.0 / 3 * M_PI * 0.027},
    {"'type':'box','size':[0.2,0.3,0.5]", 0.03},
    {"'type':'cylinder','radius':0.3,'length':2", M_PI * 0.18},
    {"'type':'tube','radius':0.3,'inner_radius':0.2,'length':2", M_PI * 0.1},
    {"'type':'cone','radius':0.3,'length':1.2", M_PI * 0.036},
    {"'type':'capsule','radius':0.3,'length':1", M_PI *(0.09 + 0.036)},
};

/* 24 sides have a little less inside than a circle */
START_TEST(surfaces_enclose_the_shape) {
  char scene[512];
  run r;
  tdm_scenery s = {0};
  tdm_vec3 centre;
  snprintf(scene, sizeof scene, "{'bodies':[{'name':'a','shape':{%s},'mass':2,'position':[1,2,3]}]}", solids[_i].shape);
  run_open_good(&r, scene, "");
  ck_assert_int_eq(mbd_engine_scenery(r.self, &s, &r.err), TDM_OK);
  ck_assert_int_eq(s.nbody, 1);
  ck_assert_str_eq(s.body[0].name, "a");
  ck_assert(s.body[0].mbd && !s.body[0].dem && !s.body[0].marked);
  double volume = enclosed(&s, 0, &centre);
  ck_assert_double_le(volume, solids[_i].volume * (1 + 1e-12));
  ck_assert_double_ge(volume, solids[_i].volume * 0.95);
  ck_assert_double_lt(tdm_norm(centre), 1e-12);
  tdm_scenery_free(&s);
  run_close(&r);
}
END_TEST

static const char machine[] =
    "{'bodies':[{'name':'arm','mass':2,'inertia':[1,1,1],'position':[1,0,0]},"
    "{'name':'load','shape':{'type':'sphere','radius':0.1},'mass':3,'position':[2,0,-1]}],"
    "'joints':[{'name':'pin','type':'revolute','bodies':['ground','arm'],'point':[0,0,0],'axis':[0,1,0]}],"
    "'forces':[{'name':'coil','type':'torsional_spring_damper','joint':'pin','stiffness':0.01},"
    "{'name':'rope','type':'cable','bodies':['arm','load'],'points':[[2,0,0],[2,0,-0.9]],'stiffness':1e5}]}";

START_TEST(lines_follow_the_bodies) {
  run r, blind;
  tdm_scenery s = {0};
  tdm_snapshot now = {0};
  run_open_good(&r, machine, "");
  run_open_good(&blind, machine, "");
  ck_assert_int_eq(mbd_engine_scenery(r.self, &s, &r.err), TDM_OK);
  ck_assert_int_eq(s.nline, 5); /* pin, the arm's bar to it, coil, rope, the arm's bar to that */
  ck_assert(s.body[0].marked && !s.body[1].marked);
  ck_assert_str_eq(s.line[0].name, "pin");
  ck_assert_int_eq(s.line[1].kind, TDM_VIEW_LINE_bar);
  ck_assert_str_eq(s.line[2].name, "coil");
  ck_assert_int_eq(s.line[2].kind, TDM_VIEW_LINE_spring);
  ck_assert_str_eq(s.line[3].name, "rope");
  ck_assert_int_eq(s.line[3].kind, TDM_VIEW_LINE_cable);
  ck_assert_double_lt(s.gravity.z, -9);
  for (int k = 1; k <= 40; k++) {
    ck_assert_int_eq(mbd_engine_snapshot(r.self, &now, &r.err), TDM_OK);
    run_to(&r, 0.01 * k);
    run_to(&blind, 0.01 * k);
    ck_assert_mem_eq(mbd_engine_data(r.self)->y, mbd_engine_data(blind.self)->y, 14 * 2 * sizeof(double));
  }
  ck_assert_int_eq(mbd_engine_snapshot(r.self, &now, &r.err), TDM_OK);
  ck_assert_int_eq(tdm_snapshot_check(&now, &s, &r.err), TDM_OK);
  ck_assert_double_eq(now.time, 0.4);
  ck_assert_int_eq(now.line_end[0], 1); /* both ends of a pin coincide: a dot, which stays in the ground */
  ck_assert_double_lt(tdm_norm(now.point[0]), 1e-9);
  const tdm_vec3 *coil = &now.point[now.line_end[1]]; /* along the pin's axis, y, and through it */
  ck_assert_double_lt(tdm_norm(tdm_add(coil[0], coil[1])), 1e-9);
  ck_assert_double_gt(coil[1].y, 0.01);
  ck_assert_double_lt(fabs(coil[1].x) + fabs(coil[1].z), 1e-9);
  tdm_vec3 tip = now.point[now.line_end[2]], eye = now.point[now.line_end[2] + 1];
  ck_assert_double_lt(fabs(tdm_norm(tip) - 2), 1e-9); /* the arm has turned about the pin */
  ck_assert_double_lt(tip.z, -0.1);
  ck_assert_double_lt(fabs(tdm_norm(tdm_sub(eye, now.pose[1].position)) - 0.1), 1e-9);
  tdm_snapshot_free(&now);
  tdm_scenery_free(&s);
  run_close(&r);
  run_close(&blind);
}
END_TEST

TEST_MAIN_ROWS("mbd_view", {surfaces_enclose_the_shape, sizeof solids / sizeof *solids}, {lines_follow_the_bodies, 1})
