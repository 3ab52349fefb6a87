/* Adams data sets: imported models against Adams' own tables, what becomes of each statement, and wrong files. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/adams/model.h"
#include "protocol/motion/motion.h"
#include "scenarios/adams/adams.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <math.h>

#define DATA TANDEM_SOURCE_DIR "/tests/reference/mbd/adams"
#define TABLES TANDEM_SOURCE_DIR "/scenarios/adams"

static const char *dir;

/* A data set of a pendulum on a hinge at the origin, along z, with more statements behind it. */
#define START                                                                                          \
  "title\nUNITS/FORCE=NEWTON, MASS=KILOGRAM, LENGTH=METER, TIME=SECOND\nPART/1, GROUND\nMARKER/1\n"    \
  "MARKER/2, REULER = 0, 90D, 0\nPART/2, MASS = 2, CM = 21, IP = 1, 2, 2.5\nMARKER/21, QP = 1, 0, 0\n" \
  "MARKER/22\nMARKER/23, REULER = 0, 90D, 0\nACCGRAV/JGRAV = -9.81\n"
#define HINGE "JOINT/1, REVOLUTE, I = 22, J = 1\n"

static json_t *scene; /* of the last import; NULL: refused */
static adm_model model;
static tdm_error error;

static void forget(void) {
  json_decref(scene);
  scene = NULL;
  adm_model_free(&model);
  error = (tdm_error){0};
}

/* Import a text: a scene, or an error. */
static void import(const char *text) {
  char file[256];
  forget();
  write_file(dir, "a.adm", text);
  snprintf(file, sizeof file, "%s/a.adm", dir);
  adm_import(&model, file, 1, &scene, &error);
}

static void import_good(const char *text) {
  import(text);
  ck_assert_msg(scene && !error.status, "%s", error.message);
}

/* The value at a path such as "joints.0.point" of the section mbd. */
static const json_t *at(const char *path) {
  const json_t *value = json_object_get(scene, "mbd");
  char word[64];
  while (*path) {
    const int n = (int)strcspn(path, ".");
    snprintf(word, sizeof word, "%.*s", n, path);
    value = isdigit((unsigned char)word[0]) ? json_array_get(value, (size_t)atoi(word)) : json_object_get(value, word);
    ck_assert_msg(value != NULL, "no %s", path);
    path += n + (path[n] == '.');
  }
  return value;
}

static void expect_number(const char *path, double x) {
  ck_assert_double_eq_tol(json_number_value(at(path)), x, 1e-13 * fmax(1, fabs(x)));
}

#define WORD(path, text) ck_assert_str_eq(json_string_value(at(path)), text)

static void expect_left_out(const char *text) {
  const char *first = json_string_value(json_array_get(model.left_out, 0));
  ck_assert_msg(json_array_size(model.left_out) == 1 && strstr(first, text), "%zu left out: %s",
                json_array_size(model.left_out), first);
}

static void expect_error(const char *place, const char *text) {
  ck_assert_msg(!scene, "no error at %s: %s", place, text);
  ck_assert_msg(strstr(error.message, place) && strstr(error.message, text), "%s", error.message);
}

static void expect_note(const char *text) {
  size_t i;
  json_t *note;
  json_array_foreach(model.notes, i, note) if (strcmp(json_string_value(note), text) == 0) return;
  ck_abort_msg("no note \"%s\"", text);
}

/* Axis k of an orientation by Euler angles: x, 0, z in the world. */
static void expect_axis(const char *path, int k, double x, double z) {
  const json_t *e = at(path);
  const tdm_mat3 a = tdm_quat_to_matrix(tdm_euler313_to_quat((tdm_euler313){json_number_value(json_array_get(e, 0)),
                                                                            json_number_value(json_array_get(e, 1)),
                                                                            json_number_value(json_array_get(e, 2))}));
  ck_assert_double_eq_tol(a.m[0][k], x, 1e-13);
  ck_assert_double_eq_tol(a.m[1][k], 0, 1e-13);
  ck_assert_double_eq_tol(a.m[2][k], z, 1e-13);
}

/* ---- against Adams' tables ---- */

static const char *const published[] = {
    "Cylindrical_Case01", "Cylindrical_Case02",  "Cylindrical_Case03",  "Distance_Case01",     "Distance_Case02",
    "Distance_Case03",    "LinActuator_Case01",  "LinActuator_Case02",  "Prismatic_Case01",    "Prismatic_Case02",
    "Prismatic_Case03",   "RevSpherical_Case01", "RevSpherical_Case02", "Revolute_Case01",     "Revolute_Case02",
    "RotSpring_Case01",   "RotSpring_Case02",    "TranSpringCB_Case03", "TranSpringCB_Case04", "Spherical_Case01",
    "Spherical_Case02",   "TranSpring_Case01",   "TranSpring_Case02",   "TranSpringCB_Case01", "TranSpringCB_Case02",
    "Universal_Case01",   "Universal_Case02",    "Universal_Case03"};
enum { NPUBLISHED = sizeof published / sizeof published[0] };

START_TEST(test_published) {
  const char *name = published[_i];
  scn_adams_difference d;
  char command_line[1024];
  dir = directory_make();
  ck_assert_msg(command("tandem-mbd import " DATA "/%s.adm --out %s/scene.json --end 5 --strict", name, dir) == 0, "%s",
                command_output);
  snprintf(command_line, sizeof command_line, "cp " TABLES "/%s/reference.csv " TABLES "/%s/error.csv %s", name, name,
           dir);
  ck_assert_int_eq(system(command_line), 0);
  ck_assert_msg(scn_adams_compare(&d, dir, 1e-10, &error) == TDM_OK, "%s", error.message);
  printf("%-20s %.4f of the table's own error (%s); positions %.2g, reactions %.2g\n", name, d.share, d.quantity,
         d.position, d.reaction);
  ck_assert_msg(d.share <= 1.1, "%s: %s is off by %g of the table's own error", name, d.quantity, d.share);
  ck_assert_double_le(d.position, 1e-5);
  ck_assert_double_le(d.reaction, 1e-4);
  directory_remove(dir);
}
END_TEST

/* ---- what becomes of statements ---- */

START_TEST(test_units) {
  dir = directory_make();
  import_good("x\nUNITS/SYSTEM = IPS\nPART/1,GROUND\nPART/2,MASS=10,CM=3,IP=1,2,2.5,VX=4,WZ=30D\nMARKER/3,QP=10,0,0\n"
              "MARKER/4,PART=1\nMARKER/5,PART=2\nSPRINGDAMPER/1,TRANS,I=5,J=4,K=100,C=2,LENGTH=3,FORCE=50\nEND\n");
  const double inch = 0.0254, pound = 0.45359237, force = pound * 9.80665;
  expect_number("bodies.0.mass", 10 * pound);
  expect_number("bodies.0.inertia.2", 2.5 * pound * inch * inch);
  expect_number("bodies.0.position.0", 10 * inch);
  expect_number("bodies.0.velocity.0", 4 * inch);
  expect_number("bodies.0.angular_velocity.2", M_PI / 6);
  expect_number("forces.0.stiffness", 100 * force / inch);
  expect_number("forces.0.damping", 2 * force / inch);
  expect_number("forces.0.free_length", 3.5 * inch); /* 50/100 longer for the force at LENGTH */
  import_good("x\nUNITS/FORCE=KNEW,MASS=TONNE,LENGTH=MILLIMETER,TIME=MILLI\nPART/1,GROUND\nMARKER/1\nPART/2,MASS=1\n"
              ",CM=2,IP=3,4,5\nMARKER/2\nACCGRAV/KGRAV=-9.81E-3\nJOINT/1,SCREW,I=2,J=1,PITCH=7\nEND\n");
  expect_number("gravity.2", -9.81);
  expect_number("bodies.0.inertia.0", 3e3 * 1e-6);
  expect_number("joints.0.pitch", 7e-3);
  import("x\nPART/1,GROUND\nEND\n");
  expect_error("a.adm:1", "UNITS");
  import("x\nUNITS/FORCE=NEWTON,MASS=STONE,LENGTH=METER,TIME=SECOND\nEND\n");
  expect_error("a.adm:2", "STONE");
  forget();
  directory_remove(dir);
}
END_TEST

/* A part that stands somewhere, its inertia about another point and axes, velocities along markers */
START_TEST(test_part) {
  dir = directory_make();
  import_good("x\nUNITS/SYSTEM=MKS\nPART/1,GROUND\nMARKER/1\nPART/7,MASS=2,CM=71,IM=72,IP=3,5,9,QG=1,2,3\n"
              ",REULER=90D,0,0,VX=1,VM=72,WX=2\nMARKER/71,QP=1,0,0\nMARKER/72,QP=1,0,1,REULER=90D,0D,0D\n"
              "JOINT/1,SPHERICAL,I=72,J=1\nEND\n");
  expect_number("bodies.0.position.0", 1); /* (1, 2, 3) + (0, 1, 0) */
  expect_number("bodies.0.position.1", 3);
  expect_number("bodies.0.orientation.euler313.0", M_PI / 2);
  /* about IM, a metre along z: 2 kg m2 more about x and y, x of IM is y of CM */
  expect_number("bodies.0.inertia.0", 5 - 2);
  expect_number("bodies.0.inertia.1", 3 - 2);
  expect_number("bodies.0.inertia.2", 9);
  expect_number("bodies.0.velocity.0", -1); /* x of IM: 180 degrees in the world */
  expect_number("bodies.0.angular_velocity.1", 2);
  expect_number("bodies.0.markers.0.point.2", 4);
  expect_number("bodies.0.markers.0.orientation.euler313.0", M_PI);
  WORD("joints.0.bodies.0", "ground");
  WORD("joints.0.points.1", "part_7.m72");
  import_good("x\nUNITS/SYS=MKS\nPART/2,MASS=1,CM=3,IP=3,4,5,1,0,0\nMARKER/3,ZP=0,0,-1,XP=1,0,0\nEND\n");
  expect_number("bodies.0.inertia.3", -1); /* a scene has the elements of the matrix */
  expect_number("bodies.0.orientation.euler313.1", M_PI);
  /* x and z points not at right angles: z keeps its direction, with USEXP x does */
  import_good(START "MARKER/24, ZP = 0, 0, -3, XP = 1, 0, 1\nJOINT/1, HOOKE, I = 24, J = 1\nEND\n");
  expect_axis("bodies.0.markers.0.orientation.euler313", 0, 1, 0);
  expect_axis("bodies.0.markers.0.orientation.euler313", 2, 0, -1);
  import_good(START "MARKER/24, ZP = 0, 0, -3, XP = 1, 0, 1, USEXP\nJOINT/1, HOOKE, I = 24, J = 1\nEND\n");
  expect_axis("bodies.0.markers.0.orientation.euler313", 0, sqrt(0.5), sqrt(0.5));
  expect_axis("bodies.0.markers.0.orientation.euler313", 2, sqrt(0.5), -sqrt(0.5));
  import_good(START "MARKER/24, ZP = 0, 0, 3, NODE_ID = 4\nSPLINE/1, X=1,2,3,4, Y=1,2,3,4, LINEAR\nEND\n");
  expect_note("line 11: MARKER/24: its NODE_ID is left out");
  expect_note("line 12: SPLINE/1: its LINEAR is left out");
  forget();
  directory_remove(dir);
}
END_TEST

START_TEST(test_joints) {
  static const char *const types[][2] = {{"JOINT/2, FIXED", "fixed"},
                                         {"JOINT/2, PLAN", "planar"},
                                         {"JOINT/2, CYL", "cylindrical"},
                                         {"JOINT/2, SPH", "spherical"},
                                         {"JPRIM/2, INPLANE", "point_in_plane"},
                                         {"JPRIM/2, INLINE", "point_on_line"},
                                         {"JPRIM/2, PARALLEL", "parallel_axes"},
                                         {"JPRIM/2, ATPOINT", "spherical"}};
  char text[1024];
  dir = directory_make();
  for (size_t k = 0; k < sizeof types / sizeof types[0]; k++) {
    snprintf(text, sizeof text, START "%s, I = 22, J = 1\nEND\n", types[k][0]);
    import_good(text);
    WORD("joints.0.type", types[k][1]);
    WORD("joints.0.bodies.0", "ground");
    ck_assert_int_eq((int)json_array_size(model.left_out), 0);
  }
  import_good(START "JPRIM/2, ORIENTATION, I = 22, J = 1\nEND\n");
  expect_left_out("line 11: JPRIM/2: a scene has no joint of the type ORIENTATION");
  import_good(START "JOINT/2, UNIV, I = 23, J = 1\nEND\n");
  WORD("joints.0.axes.1", "part_2.m23.z");
  expect_number("joints.0.axes.0.2", 1);
  import_good(START "GCON/1, I = 1, FUNCTION = 2*(DM(21, 1) - 1)\nEND\n");
  WORD("joints.0.type", "rod");
  expect_number("joints.0.length", 1);
  import_good(START "GCON/1, I = 1, FUNCTION = DX(21, 1)\nEND\n");
  expect_left_out("the function DX");
  forget();
  directory_remove(dir);
}
END_TEST

START_TEST(test_couplers) {
  static const char more[] = START HINGE "PART/3,MASS=1,CM=31,IP=1,1,1\nMARKER/31\nJOINT/2,CYL,I=31,J=1\n";
  char text[2048];
  dir = directory_make();
  snprintf(text, sizeof text, "%sCOUPLER/1, JOINTS = 1, 2, TYPE = R:R, SCALES = 2, -3\nEND\n", more);
  import_good(text);
  WORD("joints.2.type", "gear");
  expect_number("joints.2.ratio", -1.5);
  snprintf(text, sizeof text, "%sCOUPLER/1, JOINTS = 2, 1, TYPE = T:R, SCALES = 4\nEND\n", more);
  import_good(text);
  WORD("joints.2.type", "rack_and_pinion");
  WORD("joints.2.joints.0", "joint_1");
  expect_number("joints.2.radius", -4);
  snprintf(text, sizeof text, "%sCOUPLER/1, JOINTS = 2, 9, SCALES = 4\nEND\n", more);
  import(text);
  expect_error("a.adm:15", "JOINT/9");
  static const char third[] = "PART/4,MASS=1,CM=41,IP=1,1,1\nMARKER/41\nJOINT/3,TRANS,I=41,J=1\n";
  snprintf(text, sizeof text, "%s%sCOUPLER/1, JOINTS = 1, 2, 3, TYPE = R:R:T, SCALES = 1, 2, -3\nEND\n", more, third);
  import_good(text);
  WORD("joints.3.type", "coupler");
  WORD("joints.3.joints.2", "joint_3");
  WORD("joints.3.coordinates.1", "angle");
  WORD("joints.3.coordinates.2", "translation");
  expect_number("joints.3.scales.2", -3);
  snprintf(text, sizeof text, "%s%sCOUPLER/1, JOINTS = 2, 3, TYPE = T:T, SCALES = 2\nEND\n", more, third);
  import_good(text);
  WORD("joints.3.type", "coupler");
  expect_number("joints.3.scales.1", 2);
  snprintf(text, sizeof text, "%s%sCOUPLER/1, JOINTS = 1, 2, 3, SCALES = 1, 2\nEND\n", more, third);
  import(text);
  expect_error("a.adm:18", "2 scales for 3 joints");
  /* a rack 0.5 m below a pinion that turns about z and is the second body of its joint: x = 0.5 theta */
  import_good(START HINGE "PART/3,MASS=1,CM=31,IP=1,1,1\nMARKER/31,QP=0,-0.5,0,REULER=90D,90D,0\n"
                          "MARKER/3,PART=1,REULER=90D,90D,0\nJOINT/2,TRANS,I=31,J=3\n"
                          "JOINT/3,RACKPIN,I=22,J=31,PD=1\nEND\n");
  WORD("joints.2.type", "rack_and_pinion");
  expect_number("joints.2.radius", 0.5);
  forget();
  directory_remove(dir);
}
END_TEST

/* The law of MOTION/1 on the hinge against Adams' function at some times; its derivative where it gives the rate. */
static void expect_law(const char *function, int derivative, double (*value)(double)) {
  char text[2048];
  tdm_motion law = {0};
  tdm_error err = {0};
  snprintf(text, sizeof text, START HINGE "MOTION/1, JOINT = 1, ROT%s, FUNCTION = %s\nEND\n",
           derivative == 1   ? ", VELOCITY"
           : derivative == 2 ? ", ACCEL"
                             : "",
           function);
  import_good(text);
  ck_assert_msg(json_array_size(model.left_out) == 0, "%s", json_string_value(json_array_get(model.left_out, 0)));
  WORD("drivers.0.type", "rotational_motor");
  tdm_object o = tdm_object_open((json_t *)at("drivers.0"), "driver", &err);
  tdm_motion_read(&law, &o, "motion");
  ck_assert_msg(!err.status, "%s: %s", function, err.message);
  for (double t = 0; t < 3; t += 0.07) {
    const tdm_motion_value x = tdm_motion_at(&law, t);
    ck_assert_double_eq_tol(derivative == 0 ? x.value : derivative == 1 ? x.rate : x.acceleration, value(t), 1e-12);
  }
  if (derivative > 0)
    ck_assert_double_eq_tol(tdm_motion_at(&law, 0).value, 0, 1e-13);
  tdm_motion_clear(&law);
}

static double line(double t) {
  return M_PI / 6 * t;
}
static double sine(double t) {
  return 0.3 * sin(2 * t - 0.4) - 0.3 * sin(-0.4);
}
static double wave(double t) {
  return 0.3 * cos(2 * t - 0.4) + 0.1;
}
static double cubic(double t) {
  const double s = fmin(1, fmax(0, (t - 0.5) / 1.5));
  return 2 + (5 - 2) * s * s * (3 - 2 * s);
}
static double quintic(double t) {
  const double s = fmin(1, fmax(0, (t - 0.5) / 1.5));
  return t + 7 * s * s * s * (10 - 15 * s + 6 * s * s);
}
static double polynomial(double t) {
  return 1 + 2 * (t - 1) - 3 * (t - 1) * (t - 1);
}

START_TEST(test_laws) {
  dir = directory_make();
  expect_law("30.0d * time", 0, line);
  expect_law("30D*TIME", 1, line);
  expect_law("0.3*SIN(2*TIME-0.4)\n, - 0.3*SIN(-0.4)", 0, sine);
  expect_law("SHF(TIME, 0.2, 0.3, 2, -PI/2, 0.1)", 0, wave);
  expect_law("3E-1*COS(2*TIME-.4) + 0.1", 1, wave);
  expect_law("0.3*COS(2*TIME-0.4) + 0.1", 2, wave);
  expect_law("STEP(TIME, 0.5, 2, 2, 5)", 0, cubic);
  expect_law("STEP(TIME, 0.5, 2, 2, 5)", 1, cubic);
  expect_law("TIME + STEP5(2*TIME-1, 0, 0, 3, 7)", 0, quintic);
  expect_law("TIME + STEP5(2*TIME-1, 0, 0, 3, 7)", 1, quintic);
  expect_law("POLY(TIME, 1, 1, 2, -3)", 0, polynomial);
  expect_law("IF(2-1: 0, 0, 1) + 2*(TIME-1) - MAX(3, 1)*(TIME - 1)**2", 0, polynomial);
  forget();
  directory_remove(dir);
}
END_TEST

/* Angles are counted from the markers' axes in Adams, from the start in a scene; splines; what has no law */
START_TEST(test_motions) {
  dir = directory_make();
  import_good(START "MARKER/24, REULER = 20D, 0, 0\nJOINT/1, REV, I = 24, J = 1\n"
                    "MOTION/1, JOINT = 1, ROTATION, FUNCTION = 50D\nEND\n");
  expect_number("drivers.0.motion.value", M_PI / 6);
  import_good(START HINGE "SPLINE/4, X = 0, 1, 2, 3\n, Y = 0, 1,\n, 4, 9\n"
                          "MOTION/1, JOINT = 1, ROTATION, FUNCTION = 2*CUBSPL(TIME, 0, 4)\nEND\n");
  WORD("drivers.0.motion.interpolation", "cspline");
  expect_number("drivers.0.motion.values.3", 18);
  import_good(START "MOTION/1, I = 21, J = 1, X, FUNCTION = 1 + TIME\nEND\n");
  WORD("drivers.0.type", "point_motion");
  expect_number("drivers.0.motion.rate", 1); /* DX is 1 at the start */
  import_good(START HINGE "MOTION/1, JOINT = 1, ROT, FUNCTION = TIME*SIN(TIME)\nEND\n");
  expect_left_out("line 12: MOTION/1: its FUNCTION multiplies");
  import_good(START HINGE "MOTION/1, JOINT = 1, ROT, FUNCTION = USER(1, 2)\nEND\n");
  expect_left_out("the function USER");
  import_good(START HINGE "MOTION/1, JOINT = 1, ROT, FUNCTION = AZ(22, 1)\nEND\n");
  expect_left_out("depends on where bodies are");
  forget();
  directory_remove(dir);
}
END_TEST

START_TEST(test_forces) {
  dir = directory_make();
  import_good(START HINGE "SFORCE/1, TRANS, I=21, J=1, FUNCTION = -100*(DM(21,1)-0.5) - 3*VR(1,21) + 7\nEND\n");
  expect_number("forces.0.stiffness", 100);
  expect_number("forces.0.damping", 3);
  expect_number("forces.0.free_length", 0.57);
  import_good(START "MARKER/24, REULER = 20D, 0, 0\nJOINT/1, REV, I = 24, J = 1\n"
                    "SFORCE/1, ROT, I=24, J=1, FUNCTION = -50*(AZ(24,1)-30D) + 2*WZ(1,24,24)\nEND\n");
  expect_number("forces.0.stiffness", 50);
  expect_number("forces.0.damping", 2);
  expect_number("forces.0.free_angle", M_PI / 18);
  import_good(START HINGE "SPLINE/1, X=0,1,2,3, Y=0,-5,-20,-45\n"
                          "SFORCE/1, TRANS, I=21, J=1, FUNCTION = AKISPL(DM(21,1)-0.5, 0, 1)\nEND\n");
  expect_number("forces.0.stiffness_table.0.1", 1.5);
  expect_number("forces.0.stiffness_table.1.3", 45);
  import_good(START HINGE "SFORCE/1, TRANS, ACTIONONLY, I=21, J=2, FUNCTION = 4 + STEP5(TIME,0,0,1,2)\nEND\n");
  WORD("forces.0.type", "wrench");
  expect_number("forces.0.force.1", -1); /* z of marker 2 is -y */
  expect_number("forces.0.factor.to", 6);
  import_good(START HINGE "SFORCE/1, TRANS, ACTIONONLY, I=21, J=23, FUNCTION = 5\nEND\n");
  WORD("forces.0.axes", "body");
  expect_number("forces.0.force.1", -5);
  import_good(START HINGE "SFORCE/1, ROT, I=1, J=22, FUNCTION = 3*TIME\nEND\n");
  expect_number("forces.0.moment.2", -1);
  import_good(START "BUSHING/1, I=22, J=1, K=1,2,3, KT=4,5,6, C=.1,.2,.3, FORCE=7,0,0\nEND\n");
  expect_number("forces.0.stiffness.5", 6);
  expect_number("forces.0.damping.2", 0.3);
  expect_number("forces.0.preload.0", -7);
  import_good(START "SFORCE/1, TRANS, I=21, J=1, FUNCTION = IMPACT(DM(21,1),VR(21,1),1,1E5,1.5,1,1E-3)\nEND\n");
  expect_left_out("line 11: SFORCE/1: its FUNCTION has IMPACT with damping");
  import_good(START "SFORCE/1, TRANS, I=21, J=1, FUNCTION = -IMPACT(DM(21,1),VR(21,1),1,1E5,1.5,0,1)\nEND\n");
  expect_left_out("pulls where a scene's stops push");
  import_good(START "SFORCE/1, ROT, I=22, J=1, FUNCTION = IMPACT(AZ(22,1),WZ(22,1,1),1,1E5,1.5,0,1)\nEND\n");
  expect_left_out("no joint of its two parts has");
  forget();
  directory_remove(dir);
}
END_TEST

/* Limits of distances and angles: on either side, of markers that are turned and joints that count the other way */
START_TEST(test_stops) {
  dir = directory_make();
  import_good("x\nUNITS/FORCE=NEWTON,MASS=KILOGRAM,LENGTH=MILLIMETER,TIME=SECOND\nPART/1,GROUND\nMARKER/1\n"
              "PART/2,MASS=2,CM=21,IP=1E6,2E6,2.5E6\nMARKER/21,QP=1000,0,0\nSFORCE/1, TRANS, I=21, J=1\n"
              ", FUNCTION = -3*VR(21,1) + BISTOP(DM(1,21), VR(1,21), 800, 1500, 1E-4, 2, 0, 1)\nEND\n");
  WORD("forces.0.type", "spring_damper");
  WORD("forces.1.type", "bump");
  expect_number("forces.1.radii.0", 0.4);
  expect_number("forces.1.stiffness", 100);
  expect_number("forces.1.exponent", 2);
  WORD("forces.2.type", "cable");
  expect_number("forces.2.free_length", 1.5);
  const double smoothing = json_number_value(at("forces.2.smoothing")); /* k s^2/2e */
  ck_assert_double_eq_tol(json_number_value(at("forces.2.stiffness")) / (2 * smoothing), 100, 1e-10);
  /* the joint counts from part 2 to the ground, and its markers are 20 degrees apart at the start */
  import_good(START
              "MARKER/24, REULER = 20D, 0, 0\nJOINT/1, REV, I = 1, J = 24\n"
              "SFORCE/1, ROT, I=24, J=1, FUNCTION = BISTOP(AZ(24,1), WZ(24,1,1), -10D, 50D, 7, 1.5, 0, 1)\nEND\n");
  WORD("forces.0.type", "stop");
  WORD("forces.0.joint", "joint_1");
  expect_number("forces.0.upper", M_PI / 6);
  WORD("forces.1.type", "stop");
  expect_number("forces.1.lower", -M_PI / 6);
  expect_number("forces.1.stiffness", 7);
  import_good(START HINGE "SFORCE/1, ROT, I=22, J=1, FUNCTION = -IMPACT(-AZ(22,1), 0, -1, 7, 1, 0, 1)\nEND\n");
  expect_number("forces.0.upper", 1);
  import_good(START "SFORCE/1, TRANS, I=21, J=1, FUNCTION = -IMPACT(-DM(21,1),-VR(21,1),-1,7,1.5,0,1)\nEND\n");
  expect_left_out("exponent other than 2");
  forget();
  directory_remove(dir);
}
END_TEST

START_TEST(test_contact_is_left_out) {
  dir = directory_make();
  import_good(START HINGE "CONTACT/1, IGEOM=1, JGEOM=2\nEND\n");
  expect_left_out("CONTACT/1");
  forget();
  directory_remove(dir);
}
END_TEST

/* ---- wrong files ---- */

/* A statement of too many attributes, a file of too many bytes */
static void expect_bounds(void) {
  static char text[8192];
  char file[256];
  strcpy(text, START "MARKER/9");
  for (int k = 0; k < 1001; k++)
    strcat(text, k == 1000 ? "\n, Q" : ", Q");
  strcat(text, "\nEND\n");
  import(text);
  expect_error("a.adm:12", "more than 1000 attributes");
  forget();
  snprintf(file, sizeof file, "%s/a.adm", dir);
  ck_assert_int_eq(truncate(file, 300 << 20), 0);
  adm_import(&model, file, 1, &scene, &error);
  expect_error("a.adm", "more than 256 MB");
}

START_TEST(test_wrong) {
  static const struct {
    const char *text, *place, *says;
  } wrong[] = {
      {START "JOINT/1, REVOLUTE, I = 99, J = 1\nEND\n", "a.adm:11", "MARKER/99"},
      {START "JOINT/1, REVOLUTE\n, J = 1\nEND\n", "a.adm:11", "has no I"},
      {START "JOINT/1, REVOLUTE, I = 22, J = 21\nEND\n", "a.adm:11", "both on PART/2"},
      {START "JOINT/1, REVOLVING, I = 22, J = 1\nEND\n", "a.adm:11", "no type"},
      {START "MARKER/21\nEND\n", "a.adm:11", "line 7"},
      {START HINGE "JOINT/1, FIXED, I = 23, J = 2\nEND\n", "a.adm:12", "JOINT/1 is there already, at line 11"},
      {START "SPLINE/1, X=1,2,3,4, Y=1,2,3,4\nSPLINE/1, X=1,2,3,4, Y=1,2,3,4\nEND\n", "a.adm:12", "line 11"},
      {START "MARKER/9, PART = 8\nEND\n", "a.adm:11", "PART/8"},
      {START "PART/3\n, MASS = 1.2.3\n! a comment\n, CM = 1\nEND\n", "a.adm:12", "1.2.3"},
      {START "PART/3, MASS = 1, CM = 1, IP = 1, 2\nEND\n", "a.adm:11", "IP has 2"},
      {START "PART/3, MASS = 1E999, CM = 1, IP = 1, 2, 2\nEND\n", "a.adm:11", "1E999"},
      {"x\nUNITS/FORCE=NEWTON,MASS=TONNE,LENGTH=METER,TIME=SECOND\nPART/2,MASS=1E308,CM=3,IP=1,1,1\n"
       "MARKER/3\nEND\n",
       "a.adm:3", "1E308"},
      {START "PART/3, MASS=1, CM=31, IM=32, IP=1,2,2\nMARKER/31\nMARKER/32, QP=1E200,0,0\n"
             "JOINT/1, FIXED, I=31, J=1\nEND\n",
       "a.adm:13", "1E200"},
      {START "SPRINGDAMPER/1, TRANS, I=21, J=1, K=1E-300, FORCE=1E50\nEND\n", "a.adm", "\"spring_1\" has a number"},
      {"x\nUNITS/FORCE=NEWTON,MASS=KILOGRAM,LENGTH=KILOMETER,TIME=SECOND\nPART/1,GROUND\nMARKER/1\n"
       "PART/2,MASS=1,CM=3,IP=1,1,1\nMARKER/3\nJOINT/1,TRANS,I=3,J=1\n"
       "MOTION/1,JOINT=1,TRANS,FUNCTION=1+STEP(TIME,0,0,1,1E7*1E50**6)\nEND\n",
       "a.adm", "\"motion_1\" has a number"},
      {START HINGE "COUPLER/1, JOINTS = 1E50, 2, SCALES = 4\nEND\n", "a.adm:12", "1e+50 in JOINTS"},
      {START HINGE "COUPLER/1, JOINTS = 1E300, 2, SCALES = 4\nEND\n", "a.adm:12", "1E300"},
      {START HINGE "COUPLER/1, JOINTS = 1, 1.7, SCALES = 4\nEND\n", "a.adm:12", "1.7 in JOINTS"},
      {START "PART/3\nEND\n", "a.adm:11", "no mass"},
      {START "MARKER/12X\nEND\n", "a.adm:11", "whole number"},
      {START "MARKER/99999999999999999999\nEND\n", "a.adm:11", "whole number"},
      {START "MARKER\nEND\n", "a.adm:11", "no identifier"},
      {START "(garbled)\nEND\n", "a.adm:11", "no statement"},
      {START "JOINT 1\nEND\n", "a.adm:11", "a / must follow"},
      {START "SPLINE/1, X = 0, 1, 1, 2, Y = 1, 2, 3, 4\nEND\n", "a.adm:11", "must rise"},
      {START "MARKER/9, QP = 1, 2, 3, QP = 1, 2, 3\nEND\n", "a.adm:11", "twice"},
      {START, "a.adm:10", "without END"},
      {"", "a.adm:0", "without END"},
      {"title\n, I = 3\nEND\n", "a.adm:2", "none stands before"}};
  dir = directory_make();
  for (size_t k = 0; k < sizeof wrong / sizeof wrong[0]; k++) {
    import(wrong[k].text);
    expect_error(wrong[k].place, wrong[k].says);
  }
  expect_bounds();
  forget();
  directory_remove(dir);
}
END_TEST

/* The command: exit status, summary, and that nothing is written where something is wrong */
START_TEST(test_command) {
  dir = directory_make();
  write_file(dir, "good.adm", START HINGE "GFORCE/3, I=22\nREQUEST/1, D, I=22\nEND\n");
  write_file(dir, "bad.adm", START "JOINT/1, REV, I=99, J=1\nEND\n");
  write_file(dir, "light.adm", "x\nUNITS/SYSTEM=MKS\nPART/2,MASS=1,CM=3,IP=1,2,9\nMARKER/3\nEND\n");
  ck_assert_int_eq(command("tandem-mbd import %s/good.adm --strict", dir), 1);
  expect_output("line 12: GFORCE/3");
  ck_assert(!is_there(dir, ".", "good.json"));
  ck_assert_msg(command("tandem-mbd import %s/good.adm", dir) == 0, "%s", command_output);
  expect_output("left out: line 12: GFORCE/3");
  expect_output(
      "1 bodies, 1 joints, 0 drivers, 0 forces; 10 statements read, 1 not needed (they move nothing), 1 left");
  ck_assert_msg(command("tandem-mbd run %s/good.json --out %s/out --no-plots", dir, dir) == 0, "%s", command_output);
  ck_assert_int_eq(command("tandem-mbd import %s/good.adm", dir), 2);
  expect_output("--force");
  ck_assert_int_eq(command("tandem-mbd import %s/bad.adm", dir), 1);
  expect_output("bad.adm:11: JOINT/1 names MARKER/99");
  ck_assert(!is_there(dir, ".", "bad.json"));
  ck_assert_int_eq(command("tandem-mbd import %s/light.adm", dir), 1);
  expect_output("no rigid body");
  ck_assert(!is_there(dir, ".", "light.json"));
  ck_assert_int_eq(command("tandem-mbd import %s/none.adm", dir), 1);
  ck_assert_int_eq(command("tandem-mbd import"), 2);
  ck_assert_int_eq(command("tandem-mbd import %s/good.adm --end -1", dir), 2);
  ck_assert_int_eq(command("tandem-mbd import --help"), 0);
  directory_remove(dir);
}
END_TEST

/* The scene's file: what was there stays where it cannot be written; a title's last backslash is a part of it */
START_TEST(test_file) {
  dir = directory_make();
  write_file(dir, "a.adm", "a\\\nUNITS/SYSTEM=MKS\nPART/2,MASS=1,CM=3,IP=2,2,2\nMARKER/3\nEND\n");
  write_file(dir, "a.json", "old\n");
  ck_assert_int_ne(command("sh -c \"trap '' XFSZ; ulimit -f 0; tandem-mbd import %s/a.adm --force\"", dir), 0);
  expect_output("a.json: cannot be written: ");
  ck_assert(!is_there(dir, ".", "a.json.part"));
  command("cat %s/a.json", dir);
  ck_assert_str_eq(command_output, "old\n");
  ck_assert_int_ne(command("sh -c \"trap '' XFSZ; ulimit -f 0; tandem-mbd import %s/a.adm --out %s/b\"", dir, dir), 0);
  ck_assert(!is_there(dir, ".", "b"));
  ck_assert_int_eq(command("ln -s /dev/full %s/full", dir), 0);
  ck_assert_int_eq(command("tandem-mbd import %s/a.adm --out %s/full --force", dir, dir), 1);
  ck_assert_int_eq(command("test -L %s/full", dir), 0);
  ck_assert_msg(command("tandem-mbd import %s/a.adm --force", dir) == 0, "%s", command_output);
  ck_assert(!is_there(dir, ".", "a.json.part"));
  command("cat %s/a.json", dir);
  expect_output("\"title\": \"a\\\\\"");
  expect_output("\"inertia\": [2, 2, 2]");
  directory_remove(dir);
}
END_TEST

/* Truncated and garbled data sets: a scene or an error, never a crash */
START_TEST(test_garbled) {
  static char text[8192], garbled[8192];
  static const char letters[] = "\n,/=()!&*D9.E- \x80z";
  unsigned long seed = 12345;
  dir = directory_make();
  FILE *f = fopen(DATA "/RotSpring_Case01.adm", "r");
  ck_assert_ptr_nonnull(f);
  const size_t length = fread(text, 1, sizeof text - 400, f);
  fclose(f);
  text[length - 4] = 0; /* END */
  strcat(text, "BUSHING/7, I=207, J=208, K=1,2,3\nMOTION/7, JOINT=1, ROT, FUNCTION=STEP(TIME,0,0,1,SIN(3*PI)**2)\n"
               "COUPLER/1, JOINTS=1,1, SCALES=2\nSPLINE/2, X=1,2,3,4, Y=1,2,3,4\nEND\n");
  const size_t n = strlen(text);
  for (size_t cut = 0; cut < n; cut += 7) {
    snprintf(garbled, sizeof garbled, "%.*s", (int)cut, text);
    import(garbled);
    ck_assert(!scene && error.status);
    snprintf(garbled, sizeof garbled, "%.*s\nEND\n", (int)cut, text);
    import(garbled);
    ck_assert(!scene == (error.status != 0));
  }
  for (int k = 0; k < 3000; k++) {
    strcpy(garbled, text);
    for (int changes = 1 + k % 5; changes > 0; changes--) {
      seed = seed * 6364136223846793005UL + 1442695040888963407UL;
      garbled[(seed >> 33) % n] = letters[(seed >> 20) % (sizeof letters - 1)];
    }
    import(garbled);
    ck_assert(!scene == (error.status != 0));
  }
  snprintf(garbled, sizeof garbled, START HINGE "MOTION/1, JOINT=1, ROT, FUNCTION=");
  const size_t head = strlen(garbled);
  memset(garbled + head, '(', 4000);
  garbled[head + 4000] = 0;
  strcat(garbled, "\nEND\n");
  import(garbled);
  forget();
  directory_remove(dir);
}
END_TEST

TEST_MAIN_ROWS("mbd_adams", {test_published, NPUBLISHED}, {test_units, 1}, {test_part, 1}, {test_joints, 1},
               {test_couplers, 1}, {test_laws, 1}, {test_motions, 1}, {test_forces, 1}, {test_stops, 1},
               {test_contact_is_left_out, 1}, {test_wrong, 1}, {test_command, 1}, {test_file, 1}, {test_garbled, 1})
