/* How particles are turned (dem.orientation): integrated from the spin, carried wherever particles go. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/output/view.h"
#include "dem/store/state_file.h"
#include "tests/test_main.h"

#define SCENE                                                                                     \
  "'materials':[{'name':'a','density':1000}],'contact':{'normal':'hooke','tangential':'spring'}," \
  "'pairs':[{'materials':['a','a'],'stiffness':1e4,'restitution':0.5,'friction':0.4}],"

/* without contacts the spin stays, and so many radians are turned about it; with every integrator */
START_TEST(test_free_spin) {
  static const char *const integrators[] = {"'verlet'", "'leap-frog'", "'stormer-verlet'",
                                            "'multi-step','multi_step':{'substeps':4,'mass':1}"};
  rig *r = rig_make(
      scene_json("{" SCENE
                 "'gravity':[0,0,0],'orientation':true,'integrator':%s,'particles':[{'type':'list','material':'a',"
                 "'radius':0.1,'positions':[[0,0,0],[1,0,0]],'spin':[3,-2,6]}]}",
                 integrators[_i]),
      1e-3, 0, NULL);
  rig_steps(r, 1000);
  tdm_quat expected = tdm_quat_from_rotvec(tdm_v3(3, -2, 6));
  for (int i = 0; i < 2; i++)
    ck_near(tdm_norm(tdm_quat_turn(expected, r->data->state.orientation[i])), 0, 1e-11);
  rig_free(r);
}
END_TEST

/* a sphere that rolls without slipping turns by its way over its radius */
START_TEST(test_rolling) {
  rig *r = rig_make(
      scene_json("{" SCENE "'gravity':[0,0,-0.1],'orientation':true,'bodies':[{'name':'f','material':'a','shapes':"
                 "[{'type':'plane','normal':[0,0,1]}]}],'particles':[{'type':'list','material':'a','radius':0.1,"
                 "'positions':[[0,0,0.09996]],'velocity':[1,0,0],'spin':[0,10,0]}]}"),
      1e-4, 0, NULL);
  rig_steps(r, 2000);
  double way = r->data->state.sphere[0].position.x;
  ck_relative(tdm_quat_to_rotvec(r->data->state.orientation[0]).y, way / 0.1, 2e-3);
  rig_free(r);
}
END_TEST

/* nothing without the key */
START_TEST(test_not_kept_unless_asked_for) {
  rig *r =
      rig_make(scene_json("{" SCENE "'particles':[{'type':'list','material':'a','radius':0.1,'positions':[[0,0,0]]}]}"),
               1e-3, 0, NULL);
  ck_assert(!r->model->oriented && r->model->orientation == NULL);
  tdm_snapshot snapshot = {0};
  dem_view view = {0};
  tdm_error err = {0};
  ck_assert(dem_view_snapshot(&view, r->data, 0, &snapshot, &err) == TDM_OK && snapshot.norientation == 0);
  tdm_snapshot_free(&snapshot);
  dem_view_free(&view);
  rig_free(r);
}
END_TEST

/* particles that come are not turned; those that are left keep theirs; snapshots and their bytes have them */
START_TEST(test_carried) {
  rig *r = rig_make(
      scene_json(
          "{" SCENE "'gravity':[0,0,0],'orientation':true,'particles':[{'type':'list','material':'a','radius':0.1,'"
          "positions':[[0,0,0],"
          "[1,0,0],[2,0,0]],'spin':[0,0,1],'velocity':[0,0,0]}],'sources':[{'name':'s','material':'a','radius':0.1,"
          "'rate':1000,'count':1,'start':0.5,'position':[5,5,5]}],'sinks':[{'name':'k','type':'box','min':"
          "[0.9,-1,-1],'max':[1.1,1,1]}]}"),
      1e-2, 0, NULL);
  for (int k = 0; k < 100; k++) {
    rig_steps(r, 1);
    flow_now(r->data, (k + 1) * 1e-2, 1e-2);
  }
  ck_assert_int_eq(r->data->state.nparticle, 3);
  tdm_snapshot snapshot = {0}, again = {0};
  dem_view view = {0};
  tdm_view_bytes bytes = {0};
  tdm_error err = {0};
  ck_assert(dem_view_snapshot(&view, r->data, 1, &snapshot, &err) == TDM_OK);
  ck_assert(tdm_snapshot_encode(&snapshot, false, &bytes, &err) == TDM_OK &&
            tdm_snapshot_decode(&again, bytes.data, bytes.size, &err) == TDM_OK);
  ck_assert(again.norientation == 3 && again.id[0] == 0 && again.id[1] == 2 && again.id[2] == 3);
  static const double turned[3] = {1, 1, 0};
  for (int i = 0; i < 3; i++)
    ck_near(tdm_quat_to_rotvec(again.orientation[i]).z, turned[i], 1e-11);
  tdm_view_bytes_free(&bytes);
  tdm_snapshot_free(&snapshot);
  tdm_snapshot_free(&again);
  dem_view_free(&view);
  rig_free(r);
}
END_TEST

/* a copy, and a state that was stored, go on with the same bits */
START_TEST(test_goes_on) {
  rig *r = rig_make(
      scene_json(
          "{" SCENE
          "'gravity':[0,0,-10],'orientation':true,'bodies':[{'name':'f','material':'a','shapes':[{'type':'plane',"
          "'normal':[0,0,1]}]}],'particles':[{'type':'list','material':'a','radius':0.1,'positions':[[0,0,0.11],"
          "[0.15,0,0.3],[0,0.15,0.5]],'spin':[1,2,3]}]}"),
      1e-4, 0, NULL);
  tdm_error err = {0};
  void *bytes;
  size_t size;
  rig_steps(r, 2000);
  dem_data *copy = dem_data_create(r->model), *stored = dem_data_create(r->model);
  ck_assert(dem_data_copy(copy, r->data) == TDM_OK && dem_state_save(r->data, &bytes, &size) == TDM_OK);
  ck_assert_msg(dem_state_load(stored, bytes, size, &err) == TDM_OK, "%s", err.message);
  rig_steps(r, 1000);
  for (int k = 0; k < 1000; k++) {
    one_step(copy, NULL, 1e-4);
    one_step(stored, NULL, 1e-4);
  }
  ck_assert(memcmp(copy->state.orientation, r->data->state.orientation, 3 * sizeof(tdm_quat)) == 0);
  ck_assert(memcmp(stored->state.orientation, r->data->state.orientation, 3 * sizeof(tdm_quat)) == 0);
  free(bytes);
  dem_data_destroy(&copy);
  dem_data_destroy(&stored);
  rig_free(r);
}
END_TEST

TEST_MAIN_ROWS("dem orientation", {test_free_spin, 4}, {test_rolling, 1}, {test_not_kept_unless_asked_for, 1},
               {test_carried, 1}, {test_goes_on, 1})
