/* What a run starts from: lids, the fill's report, stored beds, limits and mass ratios in the report. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/adapter/report.h"
#include "dem/bodies/walls.h"
#include "dem/settle/bed.h"
#include "dem/settle/settle.h"
#include "dem/watch/limits.h"
#include "test_session_support.h"
#include "tests/test_main.h"

#include <sys/stat.h>
#include <unistd.h>

#define MATERIAL "'materials':[{'name':'a','density':1000,'young_modulus':1e7,'poisson_ratio':0.25}]"

/* 40 grains in a turned box with a lid; e, friction while settling, seed, further keys */
static json_t *bed_json(double e, double friction, int seed, const char *store, const char *more) {
  return scene_json("{" MATERIAL ",'pairs':[{'materials':['a','a'],'restitution':%g,'friction':0.4}],"
                    "'bodies':[{'name':'box','material':'a','shapes':[{'type':'box','side':'inside',"
                    "'size':[0.3,0.6,0.3],'center':[0,0.05,0],'lid':{'face':'+y','gap':1e-3}}]}],"
                    "'gravity':[0,-9.81,0],'settle':{'friction':%g,'speed':5e-3%s%s%s},"
                    "'particles':[{'type':'random','body':'box','material':'a','count':40,'radius':[0.03,0.05],"
                    "'seed':%d,'region':{'min':[-0.15,-0.25,-0.15],'max':[0.15,0.95,0.15]}}]%s}",
                    e, friction, store ? ",'store':'" : "", store ? store : "", store ? "'" : "", seed, more);
}

static session *prepare_box(json_t *json, double dt) {
  tdm_assigned_body box = {.name = "box", .mass = 10, .state = state_at(0.1, 0.2, 0.3)};
  box.state.pose.orientation = tdm_quat_from_rotvec(tdm_v3(0, 0.4, 0.02));
  return prepare_session(json, box, dt);
}

static session *open_session_with(json_t *json, double dt, bool proxy) {
  session *s = prepare_box(json, dt);
  s->assignment.proxy = proxy;
  start_session(s);
  return s;
}

static session *open_session(json_t *json, double dt) {
  return open_session_with(json, dt, false);
}

static double figure(const session *s, const char *group, const char *key) {
  json_t *in = group ? json_object_get(s->ready.report, group) : s->ready.report;
  json_t *value = json_object_get(in, key);
  ck_assert_msg(json_is_number(value), "%s.%s", group ? group : "", key);
  return json_number_value(value);
}

typedef struct {
  tdm_wrench load;
  double channel[32];
} outcome;

/* windows of 50 steps in which the box moves; the last one's loads and channels */
static outcome run(session *s, int windows) {
  double dt = s->assignment.dt, t1 = 0;
  outcome out = {0};
  for (int k = 0; k < windows; k++) {
    double t0 = t1;
    t1 = 50 * (k + 1) * dt;
    tdm_state ends[2] = {s->body.state, s->body.state};
    ends[0].pose.position.x += 0.02 * sin(30 * t0);
    ends[1].pose.position.x += 0.02 * sin(30 * t1);
    tdm_step step = {.t0 = t0,
                     .t1 = t1,
                     .nstep = 50,
                     .nbody = 1,
                     .nstate = 1,
                     .nsample = 1,
                     .start = ends,
                     .end = ends + 1,
                     .sample_time = &t1};
    tdm_wrench sample;
    tdm_result result = {.nbody = 1,
                         .nload = 1,
                         .nsample = 1,
                         .nchannel = s->ready.nchannel,
                         .load = &out.load,
                         .sample_load = &sample,
                         .channel = out.channel};
    tdm_error err = {0};
    ck_assert_int_eq(dem_solver_ops.step(s->self, &step, &result, &err), TDM_OK);
  }
  return out;
}

static const char *store_name(void) {
  static char name[512];
  snprintf(name, sizeof name, "%s/test_dem_bed.%ld.bed", TANDEM_TEST_DIR, (long)getpid());
  unlink(name);
  return name;
}

START_TEST(test_lid) {
  tdm_assigned_body box = {.name = "box", .mass = 10, .state = state_at(0.1, 0.2, 0.3)};
  box.state.pose.orientation = tdm_quat_from_rotvec(tdm_v3(0, 0.4, 0.02));
  rig *r = rig_make(bed_json(0.5, 0.4, 1, NULL, ""), 1e-4, 1, &box);
  dem_data *d = r->data;
  ck_assert_int_eq(r->model->nwall, 6);
  int w = r->model->box[0].lid;
  ck_assert_int_eq(w, 3);
  dem_settled settled;
  tdm_error err = {0};
  ck_assert_int_eq(dem_settle(d, NULL, &settled, &err), TDM_OK);
  ck_assert(settled.rest);
  /* the highest point along the box's +y, not the world's */
  double highest = -1, smallest = 1;
  for (int i = 0; i < d->state.nparticle; i++) {
    tdm_vec3 x = tdm_quat_rotate(tdm_quat_conj(box.state.pose.orientation),
                                 tdm_sub(d->state.sphere[i].position, box.state.pose.position));
    highest = fmax(highest, x.y + d->state.sphere[i].radius);
    tdm_vec3 n;
    smallest = fmin(smallest, dem_wall_gap(&r->model->wall[w], &d->state.wall[w], d->state.sphere[i].position, &n) -
                                  d->state.sphere[i].radius);
  }
  ck_near(0.05 + 0.3 + d->state.lid[w], highest + 1e-3, 1e-12);
  ck_near(smallest, 1e-3, 1e-12);
  ck_assert(d->state.lid[w] < -0.05); /* below the nominal face */
  ck_near(tdm_dot(d->state.wall[w].normal, tdm_quat_rotate(box.state.pose.orientation, tdm_v3(0, 1, 0))), -1, 1e-12);
  rig_free(r);

  /* it holds the fill when the box is shaken upwards: no grain comes higher than it */
  session *s = open_session(bed_json(0.5, 0.4, 1, NULL, ",'skin':0.003"), 1e-4);
  ck_assert_msg(!s->err.status, "%s: %s", s->err.path, s->err.message);
  json_t *lid = json_array_get(json_object_get(s->ready.report, "lids"), 0);
  ck_assert_str_eq(json_string_value(json_object_get(lid, "body")), "box");
  double y = json_number_value(json_array_get(json_object_get(lid, "point"), 1));
  ck_near(y, highest + 1e-3, 1e-12);
  ck_near(json_number_value(json_object_get(lid, "over_face")), y - 0.35, 1e-12);
  outcome out = run(s, 40);
  ck_near(out.channel[0], 40, 0);
  ck_near(out.channel[9], 0, 0);
  close_session(s);
}
END_TEST

START_TEST(test_lid_that_presses) {
  /* the bed is at rest under the lid's force, and turning gravity over does not move it: no free play */
  const char *scene = "{" MATERIAL ",'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],"
                      "'bodies':[{'name':'box','material':'a','shapes':[{'type':'box','side':'inside',"
                      "'size':[0.3,1.2,0.3],'lid':{'face':'+y','gap':1e-3%s}}]}],"
                      "'gravity':[0,-9.81,0],'settle':{'friction':0,'speed':5e-3},"
                      "'particles':[{'type':'random','body':'box','material':'a','count':40,'radius':0.04,"
                      "'seed':1,'region':{'min':[-0.15,-0.6,-0.15],'max':[0.15,0.6,0.15]}}]}";
  const double wanted = 200; /* [N]; the particles weigh 105 N */
  double moved[2];
  for (int pressed = 0; pressed < 2; pressed++) {
    tdm_assigned_body box = {.name = "box", .mass = 10, .state = state_at(0, 0, 0)};
    rig *r = rig_make(scene_json(scene, pressed ? ",'press':200" : ""), 1e-4, 1, &box);
    dem_data *d = r->data;
    dem_settled settled;
    tdm_error err = {0};
    ck_assert_int_eq(dem_settle(d, NULL, &settled, &err), TDM_OK);
    ck_assert(settled.rest);
    ck_near(dem_lid_force(d, &r->model->box[0]), pressed ? wanted : 0, 0.02 * wanted);
    double before = 0, after = 0;
    for (int i = 0; i < d->state.nparticle; i++)
      before += d->state.sphere[i].position.y / d->state.nparticle;
    dem_model *upside_down = r->model;
    upside_down->gravity.y = 9.81;
    for (int k = 0; k < 10000; k++)
      one_step(d, NULL, 1e-4);
    for (int i = 0; i < d->state.nparticle; i++)
      after += d->state.sphere[i].position.y / d->state.nparticle;
    moved[pressed] = after - before;
    rig_free(r);
  }
  ck_assert_msg(moved[0] > 0.01 && fabs(moved[1]) < 0.1 * moved[0], "moved by %g and %g m", moved[0], moved[1]);
}
END_TEST

START_TEST(test_lid_without_settling) {
  /* on what is there at once; only what is in its own box counts; without particles it stays at the face */
  const char *scene =
      "{" MATERIAL ",'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],'gravity':[0,0,0],"
      "'bodies':[{'name':'box','material':'a','shapes':[{'type':'box','side':'inside','size':[1,1,1],"
      "'open':['-x','+x'],'lid':{'face':'+z','gap':0.01}}]}],'particles':[%s]}";
  session *s = open_session(scene_json(scene, "{'type':'list','material':'a','radius':0.1,'body':'box','positions':"
                                              "[[0,0,0],[0,0.3,0.6],[2,0,3]]}"),
                            1e-4);
  ck_assert_msg(!s->err.status, "%s: %s", s->err.path, s->err.message);
  json_t *lid = json_array_get(json_object_get(s->ready.report, "lids"), 0);
  ck_near(json_number_value(json_object_get(lid, "over_face")), 0.6 + 0.1 + 0.01 - 0.5, 1e-12);
  close_session(s);
  s = open_session(scene_json(scene, ""), 1e-4);
  lid = json_array_get(json_object_get(s->ready.report, "lids"), 0);
  ck_near(json_number_value(json_object_get(lid, "over_face")), 0, 0);
  close_session(s);
}
END_TEST

START_TEST(test_fill) {
  rig *r =
      rig_make(scene_json("{" MATERIAL ",'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],"
                          "'particles':[{'type':'list','material':'a','radius':0.1,'mass':3,'positions':[[0,0,0]]},"
                          "{'type':'list','material':'a','radius':0.2,'mass':1,'positions':[[4,0,2]]}]}"),
               1e-4, 0, NULL);
  dem_fill f = dem_fill_now(r->data);
  ck_near(f.mass, 4, 0);
  ck_near(f.com.x, 1, 1e-15);
  ck_near(f.com.z, 0.5, 1e-15);
  /* 3 kg at (-1, 0, -0.5), 1 kg at (3, 0, 1.5), own 0.4 (3*0.01 + 0.04) */
  double own = 0.4 * (3 * 0.01 + 0.04);
  const double expected[9] = {3 * 0.25 + 2.25 + own, 0, -(3 * 0.5 + 4.5), 0, 3 * 1.25 + 11.25 + own, 0,
                              -(3 * 0.5 + 4.5),      0, 3 * 1 + 9 + own};
  for (int k = 0; k < 9; k++)
    ck_near(f.inertia.m[k / 3][k % 3], expected[k], 1e-13);
  rig_free(r);

  session *s = open_session(bed_json(0.5, 0.4, 1, NULL, ""), 1e-4);
  json_t *fill = json_object_get(s->ready.report, "fill");
  ck_near(figure(s, "fill", "number"), 40, 0);
  ck_near(figure(s, "fill", "mass"), s->ready.initial[10], 0);
  for (int a = 0; a < 3; a++)
    ck_near(json_number_value(json_array_get(json_object_get(fill, "com"), (size_t)a)), s->ready.initial[1 + a], 1e-12);
  ck_assert_uint_eq(json_array_size(json_object_get(fill, "inertia")), 9);
  close_session(s);
}
END_TEST

/* Bodies are held while settling: how fast they will move decides neither the bed nor whether a stored one fits. */
START_TEST(test_bed_of_a_body_that_moves) {
  const char *name = store_name();
  outcome out[3];
  for (int k = 0; k < 3; k++) { /* at rest, fast with the stored bed, fast with a bed of its own */
    json_t *json = bed_json(0.5, 0.4, 1, k < 2 ? name : NULL, "");
    session *s = prepare_box(json, 1e-4);
    if (k > 0)
      s->body.state.twist = (tdm_twist){{3, -4, 5}, {1, 2, 3}};
    start_session(s);
    ck_assert_msg(!s->err.status, "%s: %s", s->err.path, s->err.message);
    ck_assert_int_eq(json_is_true(json_object_get(json_object_get(s->ready.report, "settle"), "stored")), k == 1);
    out[k] = run(s, 20);
    close_session(s);
  }
  ck_assert_mem_eq(&out[1], &out[2], sizeof out[1]);
  unlink(name);
}
END_TEST

START_TEST(test_stored_bed) {
  /* settling and storing, the stored bed, and settling without a store: bit-identical runs */
  const char *name = store_name();
  outcome out[4];
  json_t *report[4];
  for (int k = 0; k < 4; k++) {
    session *s = open_session(bed_json(0.5, 0.4, 1, k == 3 ? NULL : name, ""), 1e-4);
    ck_assert_msg(!s->err.status, "%s: %s", s->err.path, s->err.message);
    report[k] = json_deep_copy(s->ready.report);
    json_t *settle = json_object_get(report[k], "settle");
    ck_assert_int_eq(json_is_true(json_object_get(settle, "stored")), k == 1 || k == 2);
    json_object_del(settle, "stored");
    ck_assert(json_equal(report[k], report[0]));
    out[k] = run(s, 20);
    ck_assert_mem_eq(&out[k], &out[0], sizeof out[0]);
    close_session(s);
  }
  for (int k = 0; k < 4; k++)
    json_decref(report[k]);
  ck_assert(out[0].channel[7] > 1e-3); /* it moves */

  /* what does not decide the bed may change: time.dt, restitution of the run, sources, sinks */
  session *s = open_session(bed_json(0.9, 0.4, 1, name,
                                     ",'sources':[{'name':'s','material':'a','radius':0.01,'rate':1,"
                                     "'position':[9,9,9]}],'expected_speed':2"),
                            5e-5);
  ck_assert_msg(!s->err.status, "%s: %s", s->err.path, s->err.message);
  ck_assert(json_is_true(json_object_get(json_object_get(s->ready.report, "settle"), "stored")));
  close_session(s);
  unlink(name);
}
END_TEST

static void refused(json_t *json, const char *says) {
  session *s = open_session(json, 1e-4);
  ck_assert_int_eq(s->err.status, TDM_ERR_FILE);
  ck_assert_str_eq(s->err.path, "dem.settle.store");
  ck_assert_msg(strstr(s->err.message, says) != NULL, "%s", s->err.message);
  close_session(s);
}

START_TEST(test_bad_store) {
  const char *name = store_name();
  session *s = open_session(bed_json(0.5, 0.4, 1, name, ""), 1e-4);
  ck_assert_msg(!s->err.status, "%s: %s", s->err.path, s->err.message);
  close_session(s);

  /* of other settling */
  refused(bed_json(0.5, 0.3, 1, name, ""), "another scene: what differs is dem.pairs while settling; delete the file");
  refused(bed_json(0.5, 0.4, 2, name, ""), "particles (number, sizes, masses, start or order); delete the file");
  refused(bed_json(0.5, 0.4, 1, name, ",'contact':{'tangential':'coulomb'}"), "dem.contact, dem.pairs");

  /* cut short anywhere, and every way of damage */
  struct stat st;
  ck_assert_int_eq(stat(name, &st), 0);
  char *whole = malloc((size_t)st.st_size);
  FILE *f = fopen(name, "rb");
  ck_assert_uint_eq(fread(whole, 1, (size_t)st.st_size, f), (size_t)st.st_size);
  fclose(f);
  const long cuts[] = {0, 7, 79, 80, 500, st.st_size - 60, st.st_size - 1};
  for (size_t k = 0; k < sizeof cuts / sizeof cuts[0]; k++) {
    ck_assert_int_eq(truncate(name, cuts[k]), 0);
    refused(bed_json(0.5, 0.4, 1, name, ""), "cut short");
    f = fopen(name, "wb");
    fwrite(whole, 1, (size_t)st.st_size, f);
    fclose(f);
  }
  const struct {
    long at;
    const char *says;
  } damages[] = {
      {0, "no stored bed"},         {8, "another version"},     {16, "another scene"}, {24, "another scene"},
      {32, "delete the file"},      {32 + 7, "cut short"},      {90, "damaged"},       {st.st_size - 20, "damaged"},
      {st.st_size - 48, "damaged"}, {st.st_size - 1, "damaged"}};
  for (size_t k = 0; k < sizeof damages / sizeof damages[0]; k++) {
    whole[damages[k].at] ^= 0x41;
    f = fopen(name, "wb");
    fwrite(whole, 1, (size_t)st.st_size, f);
    fclose(f);
    whole[damages[k].at] ^= 0x41;
    refused(bed_json(0.5, 0.4, 1, name, ""), damages[k].says);
  }
  free(whole);
  unlink(name);

  refused(bed_json(0.5, 0.4, 1, "/no/such/folder/bed", ""), "make the folder");
  refused(bed_json(0.5, 0.4, 1, TANDEM_TEST_DIR, ""), "cannot be");
}
END_TEST

START_TEST(test_limits) {
  /* a fall over the closed box's height; the contact of two grains at that speed */
  const char *scene =
      "{" MATERIAL ",'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],"
      "'bodies':[{'name':'box','material':'a','shapes':[{'type':'box','side':'inside',"
      "'size':[1,1,1.4]}]}],'guard':{'overlap':1},'particles':[{'type':'list','material':'a','radius':0.05,'mass':12,"
      "'positions':[[0,0,0.2]]}]%s}";
  tdm_assigned_body box = {.name = "box", .mass = 10, .state = state_at(0, 0, 0)};
  rig *r = rig_make(scene_json(scene, ""), 1e-4, 1, &box);
  ck_near(dem_expected_speed(r->data), sqrt(2 * 9.81 * 0.1 + 2 * 9.81 * 1.4), 1e-12);
  dem_limits l;
  tdm_error err = {0};
  ck_assert(!dem_limits_expected(r->data, &l, &err));
  ck_relative(l.contact, dem_contact_time(6, 0.025, r->model->pair[0].effective_young, l.speed), 1e-12);
  ck_relative(l.step, fmin(l.contact / 20, 0.4 * l.rayleigh), 1e-12);
  rig_free(r);
  r = rig_make(scene_json(scene, ",'expected_speed':0.25"), 1e-4, 1, &box);
  ck_near(dem_expected_speed(r->data), 0.25, 0);
  rig_free(r);

  /* sources count: their speed, their height, their smallest particle */
  r = rig_make(scene_json(scene, ",'sources':[{'name':'s','material':'a','radius':[0.001,0.01],'rate':1,"
                                 "'position':[0,0,2.3],'velocity':[0,0,-30]}]"),
               1e-4, 1, &box);
  ck_near(dem_expected_speed(r->data), sqrt(900 + 2 * 9.81 * 3), 1e-12);
  ck_assert(!dem_limits_expected(r->data, &l, &err));
  ck_relative(l.rayleigh, dem_rayleigh(0.001, 1000, 4e6, 0.25), 1e-12);
  rig_free(r);
}
END_TEST

START_TEST(test_ratios) {
  const char *scene =
      "{" MATERIAL ",'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0.4}],%s"
      "'bodies':[{'name':'box','material':'a','shapes':[{'type':'box','side':'inside',"
      "'size':[1,1,1.4]}]}],'guard':{'overlap':1},'particles':[{'type':'list','material':'a','radius':0.05,'mass':12,"
      "'positions':[[0,0,0.2],[0.3,0,0.2]]}]}";
  session *s = open_session(scene_json(scene, ""), 1e-4);
  json_t *ratio = json_array_get(json_object_get(s->ready.report, "mass_ratios"), 0);
  ck_near(json_number_value(json_object_get(ratio, "all_particles")), 2.4, 1e-15);
  ck_near(json_number_value(json_object_get(ratio, "heaviest_particle")), 1.2, 1e-15);
  const char *note = json_string_value(json_array_get(json_object_get(s->ready.report, "notes"), 0));
  ck_assert(note && strstr(note, "heavier than \"box\""));
  ck_assert_int_eq(s->ready.nwarning, 0);
  close_session(s);
  s = open_session_with(scene_json(scene, ""), 1e-4, true); /* the proxy feels the mass within the window */
  ck_assert_ptr_null(json_array_get(json_object_get(s->ready.report, "notes"), 0));
  close_session(s);
  s = open_session(scene_json(scene, "'contact':{'wall_mass':1e8},"), 1e-4);
  ck_assert_int_eq(s->ready.nwarning, 1);
  ck_assert_str_eq(s->ready.warning[0].path, "dem.contact.wall_mass");
  close_session(s);
  s = open_session(scene_json(scene, ""), 8e-3);
  ck_assert_int_eq(s->ready.nwarning, 1);
  ck_assert_str_eq(s->ready.warning[0].path, "time.dt");
  json_t *limit = json_object_get(json_object_get(s->ready.report, "limits"), "rayleigh");
  ck_assert(json_is_false(json_object_get(limit, "kept")));
  ck_near(json_number_value(json_object_get(limit, "recommended")), 0.4, 0);
  close_session(s);
}
END_TEST

TEST_MAIN("dem bed", test_lid, test_lid_that_presses, test_lid_without_settling, test_fill, test_stored_bed,
          test_bed_of_a_body_that_moves, test_bad_store, test_limits, test_ratios)
