/* The files of MOLDYN: the samples of [A07] Appendix A.1 there and back, every defect of a file with its message, walls
 * by normals and by end points, and the command that makes a scene of them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "../numerics/test_dem_support.h"
#include "dem/moldyn/control.h"
#include "dem/moldyn/particles.h"
#include "tests/command.h"
#include "tests/test_main.h"

#define DIR TANDEM_TEST_DIR "/moldyn"

/* a file of the tests' own folder; returns its name, which lives until the next but one */
static const char *put_file(const char *name, const char *text) {
  static char path[2][512];
  static int turn;
  char *p = path[turn++ % 2];
  snprintf(p, sizeof path[0], DIR "/%s", name);
  ck_assert_int_eq(system("mkdir -p " DIR), 0);
  write_file(DIR, name, text);
  return p;
}

/* the samples of the appendix; of the particles those that are printed */
static const char sample_cin[] = "times.t0          0.00\n"
                                 "times.tend        10.0\n"
                                 "times.dt          1.0e-5\n"
                                 "control.grav      -9.81\n"
                                 "control.rho       20.0\n"
                                 "control.mue_s     0.45\n"
                                 "control.mue_d     0.45\n"
                                 "sd.stiff_lo       7.25e3\n"
                                 "sd.stiff_k_un     7.25e3\n"
                                 "sd.stiff_adh      -3.00e2\n"
                                 "sd.damp_particle  0.00\n"
                                 "sd.damp_wall      0.38\n"
                                 "sd.e              0.27\n";
static const char sample_pin[] = "6\n"
                                 "-1.7  0.0  2.2  0.0  1.0  0.5  0.0  0.0  0.0  0.0  0.0  0.0  0.13  1\n"
                                 " 1.5  0.3  1.4  0.0  0.0  0.0  0.0  0.0  0.0  0.0  0.0  0.0  0.15  0\n"
                                 "-2.6  0.4  2.1  0.0  1.0  0.1  0.0  0.0  0.0  0.0  0.0  0.0  0.15  1\n"
                                 " 3.5  0.2  2.0  0.0  0.0  0.0  0.0  0.0  0.0  0.0  0.0  0.0  0.17  0\n"
                                 " 3.5  0.2  4.1  2.4  1.0  1.2  0.0  0.0  0.0  0.0  0.0  0.0  0.13  1\n"
                                 " 4.2  0.3  2.8  0.6  0.0  0.8  0.0  0.0  0.0  0.0  0.0  0.0  0.15  1\n";
#define WIN(thickness, first)                           \
  "6  " thickness "\n"                                  \
  " 1.0000  0.0000  0.0000 " first "  0.0855  0.0855\n" \
  "-1.0000  0.0000  0.0000  0.1715  0.0855  0.0855\n"   \
  " 0.0000  1.0000  0.0000  0.0855 -0.0005  0.0855\n"   \
  " 0.0000 -1.0000  0.0000  0.0855  0.1715  0.0855\n"   \
  " 0.0000  0.0000  1.0000  0.0855  0.0855 -0.0005\n"   \
  " 0.0000  0.0000 -1.0000  0.0855  0.0855  0.1715\n"

/* ---- defects ---- */

typedef struct {
  const char *text, *line, *says;
} bad;

static void refused(const tdm_error *err, const char *file, const bad *b) {
  char place[600];
  snprintf(place, sizeof place, "%s:%s: ", file, b->line);
  ck_assert_msg(err->status == TDM_ERR_FILE, "not refused:\n%s", b->text);
  ck_assert_msg(strncmp(err->message, place, strlen(place)) == 0 && strstr(err->message, b->says),
                "\"%s\" has no \"%s%s\"", err->message, place, b->says);
}

#define CIN_HEAD "times.t0 0\ntimes.tend 1\ntimes.dt 1e-5\n"
#define CIN_MID "control.grav -9.81\ncontrol.rho 20\ncontrol.mue_s 0.45\ncontrol.mue_d 0.45\n"
#define CIN_END "sd.stiff_lo 7e3\nsd.stiff_k_un 8e3\nsd.stiff_adh -300\nsd.damp_particle 0\nsd.damp_wall 0.38\n"

START_TEST(test_control_defects) {
  static const bad bads[] = {
      {"", "0", "ends without times.t0"},
      {CIN_HEAD CIN_MID CIN_END, "12", "ends without sd.e"},
      {"times.t1 0\n", "1", "did you mean \"times.t0\"?"},
      {"times.t0\n", "1", "is a key and a number, this one has 1 fields"},
      {"times.t0 zero\n", "1", "\"zero\" (field 2, times.t0) is no finite number"},
      {"times.t0 0\n\ntimes.t0 1\n", "3", "given in line 1 already"},
      {"times.dt 0\n", "1", "must be greater than 0"},
      {"control.rho -1\n", "1", "must be greater than 0"},
      {"control.mue_s -1\n", "1", "must be 0 or greater"},
      {"sd.stiff_adh 300\n", "1", "0 or less: an adhesive stiffness is negative"},
      {"times.t0 2\ntimes.tend 1\ntimes.dt 1e-5\n" CIN_MID CIN_END "sd.e 0.5\n", "2",
       "must be after times.t0 = 2 s (line 1)"},
      {"times.t0 0\ntimes.tend 1\ntimes.dt 2\n" CIN_MID CIN_END "sd.e 0.5\n", "3", "longer than the run"},
      {CIN_HEAD "control.grav -9.81\ncontrol.rho 20\ncontrol.mue_s 0.3\ncontrol.mue_d 0.45\n" CIN_END "sd.e 0.5\n", "6",
       "must be at least control.mue_d, 0.45 (line 7)"},
      {CIN_HEAD CIN_MID
       "sd.stiff_lo 7e3\nsd.stiff_k_un 6e3\nsd.stiff_adh 0\nsd.damp_particle 0\nsd.damp_wall 0\nsd.e 0.5\n",
       "9", "must be at least sd.stiff_lo, 7000 N/m (line 8)"},
      {CIN_HEAD CIN_MID CIN_END "sd.e 1.5\n", "13", "must be at most 1"},
      {CIN_HEAD CIN_MID
       "sd.stiff_lo 7e3\nsd.stiff_k_un 7e3\nsd.stiff_adh 0\nsd.damp_particle 0\nsd.damp_wall 1\nsd.e 0\n",
       "13", "must be greater than 0"},
  };
  const bad *b = &bads[_i];
  const char *file = put_file("bad.cin", b->text);
  tdm_error err = {0};
  json_t *notes, *scene = dem_cin_read(file, &(dem_cin_options){.particles = "p"}, &notes, &err);
  ck_assert_ptr_null(scene);
  json_decref(notes);
  refused(&err, file, b);
}
END_TEST

#define ROW(flag) "0 0 0  0 0 0  0 0 0  0 0 0  0.1 " flag "\n"

START_TEST(test_particle_defects) {
  static const bad bads[] = {
      {"", "1", "begin with the number of particles"},
      {"two\n", "1", "\"two\" (field 1, number of particles)"},
      {"1.5\n" ROW("1"), "1", "a whole number"},
      {"1 2\n", "1", "the number of particles alone"},
      {"2\n" ROW("1"), "1", "says 2 particles, but the file has 1"},
      {"1\n" ROW("1") "# more\n" ROW("1"), "4", "is a particle too many: line 1 says 1"},
      {"1\n0 0 0 0.1 1\n", "2", "has 14 numbers, this row 5"},
      {"1\n0 0 0  0 x 0  0 0 0  0 0 0  0.1 1\n", "2", "\"x\" (field 5, v_y)"},
      {"1\n0 0 nan  0 0 0  0 0 0  0 0 0  0.1 1\n", "2", "\"nan\" (field 3, z)"},
      {"1\n0 0 0  0 0 0  0 0 0  0 0 0  -0.1 1\n", "2", "the radius (field 13) is -0.1 m"},
      {"1\n" ROW("2"), "2", "the flag (field 14) is 2"},
      {"1\n0 0 0  0 0 1  0 0 0  0 0 0  0.1 0\n", "2", "never moves"},
      {"1\n0 0 0  0 0 0  0 0 0  0 0 1  0.1 0\n", "2", "never moves"},
  };
  const bad *b = &bads[_i];
  const char *file = put_file("bad.pin", b->text);
  tdm_error err = {0};
  dem_pin pin;
  dem_pin_read(&pin, file, NULL, &err);
  dem_pin_free(&pin);
  refused(&err, file, b);
}
END_TEST

/* "n": by normals, "e": by end points */
typedef struct {
  int form; /* dem_win_form */
  bad bad;
} bad_walls;

START_TEST(test_wall_defects) {
  enum { n = DEM_WIN_NORMALS, e = DEM_WIN_END_POINTS };
  static const bad_walls bads[] = {
      {n, {"", "1", "begin with the number of walls"}},
      {n, {"6\n", "1", "has 2 numbers, this one 1"}},
      {n, {"x 0.1\n", "1", "\"x\" (field 1, number of walls)"}},
      {n, {"1.5 0.1\n", "1", "a whole number"}},
      {n, {"1 -0.1\n", "1", "the thickness is -0.1 m"}},
      {n, {"1 0\n1 0 0 0 0\n", "2", "a wall has 6 numbers, this row 5"}},
      {n, {"1 0\n0 0 0.5 0 0 0\n", "2", "has the length 0.5"}},
      {n, {"1 0\n0 0 0.5 0 0 0\n", "2", "\"form\": \"end_points\""}},
      {n, {"2 0\n0 0 1 0 0 0\n", "1", "says 2 walls, but the file has 1"}},
      {n, {"1 0\n0 0 1 0 0 0\n0 0 1 0 0 1\n", "3", "is a wall too many"}},
      {n, {"2 0\n0 0 1 0 0 0\n0 0 1 0 0 0\n", "3", "is that of line 2 again"}},
      {n, {"2 0\n0 0 1 0 0 1\n0 0 -1 0 0 0\n", "3", "and that of line 2 look away from each other"}},
      /* the defect of the appendix's sample */
      {n, {WIN("0.0030", "-0.0050"), "2", "at [-0.005, 0.0855, 0.0855] m does not fit its neighbours"}},
      {n, {WIN("0.0030", "-0.0050"), "2", "move it to [-0.0005, 0.0855, 0.0855]"}},
      {e, {"1 0\n0 0 0\n", "2", "this row 3; give a_x a_y a_z b_x b_y b_z, or a_x a_z b_x b_z"}},
      {e, {"1 0\n0 0 0 1 1 0\n", "2", "the end points have y = 0 and 1 m"}},
      {e, {"1 0\n1 2 1 2\n", "2", "both ends are at [1, 2] m"}},
      {e, {"2 0\n0 0 1 0\n1.0005 0 2 0\n", "3", "misses that of line 2, [1, 0], by 0.0005 m"}},
      {e, {"2 0\n0 0 1 0\n2 0 1 0\n", "2", "all 2 walls at [1, 0] m end there"}},
      {e, {"2 0\n1 0 0 0\n1 0 2 0\n", "2", "all 2 walls at [1, 0] m begin there"}},
  };
  const bad_walls *b = &bads[_i];
  const char *file = put_file("bad.win", b->bad.text);
  tdm_error err = {0};
  dem_win win;
  dem_win_read(&win, file, (dem_win_form)b->form, true, NULL, &err);
  dem_win_free(&win);
  refused(&err, file, &b->bad);
}
END_TEST

/* what fits, and what is not to be checked */
START_TEST(test_walls_that_fit) {
  static const bad_walls good[] = {
      {DEM_WIN_NORMALS, {WIN("0.0030", "-0.0005"), "", ""}},
      {DEM_WIN_NORMALS,
       {"3 0.003\n1 0 0 0 0 0.5\n-1 0 0 1 0 0.5\n0 0 1 0.7 0 0\n", "", ""}}, /* one across says little */
      {DEM_WIN_END_POINTS, {"4 0\n0 0 1 0\n1 0 1 1\n1 1 0 1\n0 1 0 0\n", "", ""}},
      {DEM_WIN_END_POINTS, {"4 0\n0 0 1 0\n1 0 0 0\n1 0 2 0\n2 0 1 0\n", "", ""}}, /* two sides */
      {DEM_WIN_END_POINTS, {"2 0\n0 0 1 0\n1.05 0 2 0\n", "", ""}},                /* an outlet */
  };
  tdm_error err = {0};
  dem_win win;
  dem_win_read(&win, put_file("good.win", good[_i].bad.text), (dem_win_form)good[_i].form, true, NULL, &err);
  ck_assert_msg(err.status == TDM_OK, "%s", err.message);
  dem_win_free(&win);
  dem_win_read(&win, put_file("sample.win", WIN("0.0030", "-0.0050")), DEM_WIN_NORMALS, false, NULL, &err);
  ck_assert_msg(err.status == TDM_OK && win.count == 6, "%s", err.message);
  dem_win_free(&win);
}
END_TEST

START_TEST(test_files_that_are_not_there) {
  tdm_error err = {0};
  dem_pin pin;
  dem_pin_read(&pin, DIR "/none.pin", "dem.particles[0].file", &err);
  ck_assert_str_eq(err.path, "dem.particles[0].file");
  ck_assert_ptr_nonnull(strstr(err.message, "none.pin: cannot be opened"));
}
END_TEST

/* ---- the samples ---- */

START_TEST(test_sample_control) {
  tdm_error err = {0};
  json_t *notes, *scene = dem_cin_read(put_file("sample.cin", sample_cin),
                                       &(dem_cin_options){.particles = "a.pin", .walls = "a.win"}, &notes, &err);
  ck_assert_msg(scene != NULL, "%s", err.message);
  ck_assert(json_array_size(notes) == 1); /* no adhesion without hysteresis */
  json_t *expected = scene_json(
      "{'title':'MOLDYN: sample.cin','time':{'end':10.0,'dt':1e-5},'output':{'interval':0.01,'particles_interval':"
      "0.1},'dem':{'gravity':[0.0,0.0,-9.81],'contact':{'normal':'hooke','tangential':'coulomb'},'materials':[{"
      "'name':'particle','density':20.0},{'name':'wall','density':20.0}],'pairs':[{'materials':['particle',"
      "'particle'],'stiffness':7250.0,'restitution':0.27,'friction':0.45},{'materials':['particle','wall'],"
      "'stiffness':7250.0,'damping':0.38,'friction':0.45}],'orientation':true,'bodies':[{'name':'walls',"
      "'material':'wall','shapes':[{'type':'moldyn','file':'a.win','form':'normals'}]}],'particles':[{'type':"
      "'moldyn','material':'particle','file':'a.pin'}]}}");
  char *text = json_dumps(scene, JSON_INDENT(1));
  ck_assert_msg(json_equal(scene, expected), "%s", text);
  free(text);
  json_decref(expected);
  json_decref(scene);
  json_decref(notes);
}
END_TEST

START_TEST(test_hysteretic_control) {
  tdm_error err = {0};
  json_t *notes, *scene = dem_cin_read(put_file("h.cin", CIN_HEAD CIN_MID CIN_END "sd.e 0.5\n"),
                                       &(dem_cin_options){.particles = "a.pin", .flat = true}, &notes, &err);
  ck_assert_msg(scene != NULL, "%s", err.message);
  json_t *expected = scene_json(
      "[{'materials':['particle','particle'],'stiffness':7000.0,'unloading_stiffness':8000.0,'adhesion_stiffness':300."
      "0,"
      "'friction':0.45},{'materials':['particle','wall'],'stiffness':7000.0,'normal':'hooke','damping':0.38,'friction':"
      "0.45}]");
  json_t *dem = json_object_get(scene, "dem");
  ck_assert(json_equal(json_object_get(dem, "pairs"), expected));
  ck_assert_int_eq(json_integer_value(json_object_get(dem, "dimension")), 2);
  ck_assert_str_eq(json_string_value(json_object_get(json_object_get(dem, "contact"), "normal")), "hysteretic");
  json_decref(expected);
  json_decref(scene);
  json_decref(notes);
}
END_TEST

#define MATERIALS                                                                                                      \
  "'materials':[{'name':'a','density':20},{'name':'w','density':20}],'contact':{'normal':'hooke','tangential':'none'}" \
  ","                                                                                                                  \
  "'pairs':[{'materials':['a','a'],'stiffness':1e4,'damping':0},{'materials':['a','w'],'stiffness':2e4,'damping':0}],"

START_TEST(test_sample_particles) {
  rig *r = rig_make(scene_json("{" MATERIALS
                               "'orientation':true,'particles':[{'type':'moldyn','material':'a','file':'%s'}]}",
                               put_file("sample.pin", sample_pin)),
                    1e-5, 0, NULL);
  const dem_state *s = &r->data->state;
  static const tdm_vec3 x[6] = {{-1.7, 0, 2.2}, {1.5, 0.3, 1.4}, {-2.6, 0.4, 2.1},
                                {3.5, 0.2, 2},  {3.5, 0.2, 4.1}, {4.2, 0.3, 2.8}},
                        v[6] = {{0, 1, 0.5}, {0, 0, 0}, {0, 1, 0.1}, {0, 0, 0}, {2.4, 1, 1.2}, {0.6, 0, 0.8}};
  static const double radius[6] = {0.13, 0.15, 0.15, 0.17, 0.13, 0.15};
  ck_assert_int_eq(s->nparticle, 6);
  for (int i = 0; i < 6; i++) {
    ck_vector(s->sphere[i].position, x[i], 0);
    ck_vector(s->pace[i].velocity, v[i], 0);
    ck_near(s->sphere[i].radius, radius[i], 0);
    ck_near(s->mass[i], 20 * 4.0 / 3 * M_PI * pow(radius[i], 3), 1e-15);
    ck_assert((s->sphere[i].inverse_mass == 0) == (i == 1 || i == 3));
  }
  rig_steps(r, 100);
  for (int i = 0; i < 6; i++) {
    tdm_vec3 fall = i == 1 || i == 3 ? x[i] : tdm_axpy(1e-3, v[i], tdm_axpy(5e-7, tdm_v3(0, 0, -9.81), x[i]));
    ck_vector(s->sphere[i].position, fall, 1e-12);
  }
  rig_free(r);
}
END_TEST

/* the box of the corrected sample: surfaces half the thickness in front of the centres */
START_TEST(test_sample_walls) {
  rig *r = rig_make(
      scene_json("{" MATERIALS "'bodies':[{'name':'b','material':'w','shapes':[{'type':'moldyn','file':'%s'}]}],"
                 "'gravity':[0,0,0],'particles':[{'type':'list','material':'a','radius':0.004,'positions':"
                 "[[0.00499,0.05,0.05],[0.05,0.05,0.16602],[0.1,0.1,0.1]]}]}",
                 put_file("box.win", WIN("0.0030", "-0.0005"))),
      1e-5, 0, NULL);
  forces_now(r->data, false);
  ck_vector(r->data->state.push[0].force, tdm_v3(2e4 * 1e-5, 0, 0), 1e-9);
  ck_vector(r->data->state.push[1].force, tdm_v3(0, 0, -2e4 * 2e-5), 1e-9);
  ck_vector(r->data->state.push[2].force, tdm_v3(0, 0, 0), 0);
  rig_free(r);
}
END_TEST

/* ---- walls by end points ---- */

/* the force on a sphere of radius 0.1 at [x, 0, z] by these walls */
static tdm_vec3 force_at(const char *walls, double x, double z) {
  rig *r =
      rig_make(scene_json("{" MATERIALS "'bodies':[{'name':'b','material':'w','shapes':[{'type':'moldyn','form':"
                          "'end_points','file':'%s'}]}],'gravity':[0,0,0],'particles':[{'type':'list','material':'a',"
                          "'radius':0.1,'positions':[[%.17g,0.3,%.17g]]}]}",
                          put_file("segments.win", walls), x, z),
               1e-5, 0, NULL);
  forces_now(r->data, false);
  tdm_vec3 f = r->data->state.push[0].force;
  rig_free(r);
  return f;
}

START_TEST(test_segments) {
  const double k = 2e4, root = sqrt(0.5);
  const char *one = "1 0.02\n0 0 1 0\n", *both = "2 0.02\n0 0 1 0\n1 0 0 0\n", *flat = "2 0.02\n0 0 1 0\n1 0 2 0\n",
             *inside = "2 0.02\n0 1 0 0\n0 0 1 0\n", *outside = "2 0.02\n1 0 0 0\n0 0 0 1\n";
  /* the face, the round end, and nothing from behind */
  ck_vector(force_at(one, 0.5, 0.109), tdm_v3(0, 0, k * 1e-3), 1e-9);
  ck_vector(force_at(one, 0.5, 0.111), tdm_v3(0, 0, 0), 0);
  ck_vector(force_at(one, 1 + 0.109 * root, 0.109 * root), tdm_v3(root * k * 1e-3, 0, root * k * 1e-3), 1e-9);
  ck_vector(force_at(one, 0.5, -0.05), tdm_v3(0, 0, 0), 0);
  /* a wall with two sides */
  ck_vector(force_at(both, 0.5, 0.109), tdm_v3(0, 0, k * 1e-3), 1e-9);
  ck_vector(force_at(both, 0.5, -0.109), tdm_v3(0, 0, -k * 1e-3), 1e-9);
  /* over a joint one contact; in a corner two; about a corner one */
  ck_vector(force_at(flat, 1.01, 0.109), tdm_v3(0, 0, k * 1e-3), 1e-9);
  ck_vector(force_at(flat, 1, 0.109), tdm_v3(0, 0, k * 1e-3), 1e-9);
  ck_vector(force_at(inside, 0.109, 0.109), tdm_v3(k * 1e-3, 0, k * 1e-3), 1e-9);
  ck_vector(force_at(outside, -0.109 * root, -0.109 * root), tdm_v3(-root * k * 1e-3, 0, -root * k * 1e-3), 1e-9);
  ck_vector(force_at(outside, 0.01, -0.109), tdm_v3(0, 0, -k * 1e-3), 1e-9);
}
END_TEST

/* a disc that slides over a joint keeps its friction's history, and feels no bump */
START_TEST(test_joint_is_smooth) {
  rig *r = rig_make(
      scene_json(
          "{'materials':[{'name':'a','density':20}],'contact':{'normal':'hooke','tangential':'spring'},'pairs':[{"
          "'materials':['a','a'],'stiffness':1e4,'restitution':0.5,'friction':0.1}],'dimension':2,'bodies':[{'name':"
          "'b','material':'a','shapes':[{'type':'moldyn','form':'end_points','file':'%s'}]}],'particles':[{'type':"
          "'list','material':'a','radius':0.1,'positions':[[0.7,0,0.0999]],'velocity':[1,0,0]}]}",
          put_file("joint.win", "2 0\n0 0 1 0\n1 0 2 0\n")),
      1e-4, 0, NULL);
  double highest = 0;
  for (int k = 0; k < 5000; k++) {
    rig_steps(r, 1);
    highest = k > 2500 ? fmax(highest, fabs(r->data->state.pace[0].velocity.z)) : 0;
  }
  ck_assert(r->data->state.sphere[0].position.x > 1.05);
  ck_assert_msg(highest < 1e-8, "bumps at %g m/s", highest);
  rig_free(r);
}
END_TEST

/* ---- from the command line ---- */

static double number_after(char **at) {
  char *end;
  double x = strtod(*at, &end);
  ck_assert_msg(end != *at, "no number in \"%.40s\"", *at);
  *at = end;
  return x;
}

static char *read_text(const char *file) {
  static char text[65536];
  FILE *f = fopen(file, "r");
  ck_assert_msg(f != NULL, "%s", file);
  text[fread(text, 1, sizeof text - 1, f)] = 0;
  fclose(f);
  return text;
}

/* the particles of the appendix's .xb in its box: through import and run into .xb and .str */
START_TEST(test_there_and_back) {
  command("rm -rf " DIR "/a.*");
  put_file("a.cin", "times.t0 0\ntimes.tend 0.01\ntimes.dt 1e-5\n" CIN_MID CIN_END "sd.e 0.5\n");
  put_file("a.pin", "3\n"
                    "0.05 0 0.12  0 0 -0.000098  0 0.3 0  0 0 0  0.004 1\n"
                    "0.07 0 0.07  0 0 -0.000098  0 0 0  0 10 0  0.004 1\n"
                    "0.099996 0 0.004  0 0 0  0 0 0  0 0 0  0.004 0\n");
  put_file("a.win", WIN("0.0030", "-0.0050"));
  ck_assert(is_refusal(command("tandem-dem import " DIR "/a.cin --dimension 2")));
  expect_output("a.win:2: the wall at [-0.005, 0.0855, 0.0855] m does not fit its neighbours");
  put_file("a.win", "4 0.001\n1 0 0 -0.0005 0 0.0855\n-1 0 0 0.1715 0 0.0855\n0 0 1 0.0855 0 -0.0005\n"
                    "0 0 -1 0.0855 0 0.1715\n");
  ck_assert_msg(command("tandem-dem import " DIR "/a.cin --dimension 2") == 0, "%s", command_output);
  expect_output("3 particles and 4 walls");
  ck_assert(is_refusal(command("tandem-dem import " DIR "/a.cin")));
  expect_output("--force");
  ck_assert_msg(command("tandem-dem run " DIR "/a.json --out " DIR
                        "/a.out --force --no-plots --set output.moldyn='[\"xb\",\"str\"]' "
                        "--set output.particles_interval=0.005 --set dem.gravity=[0,0,0]") == 0,
                "%s", command_output);

  char *at = read_text(DIR "/a.out/particles.xb");
  static const double head[6] = {3, 0, 0, 0, 0.171, 0.171}, first[3][6] = {{0.05, 0.12, 0, -0.000098, 0.004, 0.3},
                                                                           {0.07, 0.07, 0, -0.000098, 0.004, 0},
                                                                           {0.099996, 0.004, 0, 0, 0.004, 0}};
  for (int frame = 0; frame < 3; frame++) {
    for (int k = 0; k < 6; k++)
      ck_near(number_after(&at), k == 1 ? 0.005 * frame : head[k], 1e-9);
    for (int i = 0; i < 3; i++)
      for (int k = 0; k < 6; k++) {
        double moved = k < 2 ? 0.005 * frame * first[i][2 + k] : k == 5 && i == 1 ? 10 * 0.005 * frame : 0;
        ck_near(number_after(&at), first[i][k] + moved, 1e-8);
      }
  }
  ck_assert_int_eq(at[strspn(at, " \n")], 0);

  at = read_text(DIR "/a.out/scene.str");
  ck_near(number_after(&at), 0.005, 0);
  ck_near(number_after(&at), 7, 0);
  ck_near(number_after(&at), 12, 0);
  double c = cos(0.3), s = sin(0.3);
  const double turned[12] = {c, 0, s, 0, 1, 0, -s, 0, c, 0.05, 0, 0.12};
  for (int k = 0; k < 12; k++)
    ck_near(number_after(&at), turned[k], 1e-8);
  for (int k = 0; k < (7 * 3 - 1) * 12; k++)
    number_after(&at);
  ck_assert_int_eq(at[strspn(at, " \n")], 0);
}
END_TEST

START_TEST(test_import_command) {
  ck_assert_int_eq(command("tandem-dem import --help"), 0);
  expect_output("BASE.cin");
  static const char *const wrong[][2] = {
      {"", "name ends in .cin"},         {"a.txt", "name ends in .cin"},
      {"a.cin b.cin", "one control"},    {"a.cin --form curves", "give normals or end_points"},
      {"a.cin --dimension 4", "3 or 2"}, {"a.cin --what", "no option"},
      {"a.cin --out", "name of a file"}, {"no/such.cin", "no/such.pin: cannot be opened"}};
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    ck_assert(is_refusal(command("tandem-dem import %s", wrong[k][0])));
    expect_output(wrong[k][1]);
  }
}
END_TEST

/* what the viewers' files cannot show */
START_TEST(test_viewers_files_refused) {
  static const char *const wrong[][2] = {
      {"--set output.moldyn='[\"abc\"]'", "give \"xb\" or \"str\""},
      {"--set output.moldyn='[\"str\"]' --set dem.orientation=false", "set dem.orientation to true"},
      {"--set output.moldyn='[\"xb\"]' --set dem.dimension=3", "set dem.dimension to 2"},
      {"--set output.moldyn='[\"str\"]' --set "
       "dem.sinks='[{\"name\":\"s\",\"type\":\"plane\",\"point\":[0,0,-9],\"normal\":[0,0,1]}]'",
       "the same particles at all times"}};
  put_file("v.win", "1 0\n0 0 1 0 0 0\n");
  const char *scene =
      "{\"time\":{\"end\":1e-3,\"dt\":1e-5},\"output\":{\"particles_interval\":1e-3},\"dem\":{\"orientation\":true,"
      "\"dimension\":2,\"materials\":[{\"name\":\"a\",\"density\":20}],\"contact\":{\"normal\":\"hooke\"},"
      "\"pairs\":[{\"materials\":[\"a\",\"a\"],\"stiffness\":1e4,\"restitution\":0.5,\"friction\":0}],"
      "\"particles\":[{\"type\":\"list\",\"material\":\"a\",\"radius\":0.1,\"positions\":[[0,0,0]]}]}}";
  const char *file = put_file("v.json", scene);
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    ck_assert_int_eq(command("tandem-dem run %s --out " DIR "/v.out --force --no-plots %s", file, wrong[k][0]), 1);
    expect_output(wrong[k][1]);
  }
}
END_TEST

TEST_MAIN_ROWS("dem moldyn", {test_control_defects, 16}, {test_particle_defects, 13}, {test_wall_defects, 20},
               {test_walls_that_fit, 5}, {test_files_that_are_not_there, 1}, {test_sample_control, 1},
               {test_hysteretic_control, 1}, {test_sample_particles, 1}, {test_sample_walls, 1}, {test_segments, 1},
               {test_joint_is_smooth, 1}, {test_there_and_back, 1}, {test_import_command, 1},
               {test_viewers_files_refused, 1})
