/* What a coupled run writes to be looked at: the files, what is in them, that the run stays the same, and solvers that
 * cannot be seen or tell nonsense. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/view/frames.h"
#include "tests/command.h"
#include "tests/result_table.h"
#include "tests/test_main.h"

#include <math.h>

/* A tray on a spring, an arm without shape that swings from it, and a crate. */
#define MBD                                                                                                 \
  "{'gravity': [0, 0, -9.81], 'bodies': [\n"                                                                \
  "   {'name': 'tray', 'mass': 2, 'inertia': [0.1, 0.1, 0.1], 'position': [0, 0, 0]},\n"                    \
  "   {'name': 'arm', 'mass': 1, 'inertia': [0.1, 0.1, 0.1], 'position': [0.5, 0, 0]},\n"                   \
  "   {'name': 'crate', 'position': [2, 0, 0],\n"                                                           \
  "    'shape': {'type': 'box', 'density': 500, 'size': [0.1, 0.1, 0.1]}}],\n"                              \
  "  'joints': [{'name': 'slide', 'type': 'prismatic', 'bodies': ['ground', 'tray'], 'point': [0, 0, 0],\n" \
  "    'axis': [0, 0, 1]}, {'name': 'hinge', 'type': 'revolute', 'bodies': ['tray', 'arm'],\n"              \
  "    'point': [0.3, 0, 0], 'axis': [0, 1, 0]}],\n"                                                        \
  "  'forces': [{'name': 'spring', 'type': 'spring_damper', 'bodies': ['ground', 'tray'],\n"                \
  "    'points': [[0, 0, 1], [0, 0, 0]], 'stiffness': 2000, 'damping': 20}]}"

static const char alone[] = "{'time': {'end': 0.05}, 'output': {'interval': 1e-3}, 'mbd': " MBD "}\n";

/* Grains fall into the tray; a slab that only DEM has. */
static const char scene[] =
    "{'time': {'end': 0.05, 'dt': 1e-4}, 'output': {'interval': 1e-3},\n"
    " 'coupling': {'n': 7, 'bodies': [{'mbd': 'tray', 'dem': 'pan'}]},\n"
    " 'mbd': " MBD ",\n"
    " 'dem': {'gravity': [0, 0, -9.81],\n"
    "  'materials': [{'name': 'm', 'density': 1000, 'young_modulus': 1e7, 'poisson_ratio': 0.3}],\n"
    "  'pairs': [{'materials': ['m', 'm'], 'restitution': 0.5, 'friction': 0.4}],\n"
    "  'bodies': [{'name': 'pan', 'material': 'm', 'shapes': [{'type': 'box', 'side': 'inside',\n"
    "    'size': [0.4, 0.4, 0.4], 'open': ['+z']}]}, {'name': 'slab', 'material': 'm',\n"
    "    'shapes': [{'type': 'plane', 'normal': [0, 0, 1], 'point': [0, 0, -3]}]}],\n"
    "  'sinks': [{'name': 'below', 'type': 'plane', 'point': [0, 0, -2], 'normal': [0, 0, 1], 'classes': [0.03]}],\n"
    "  'particles': [{'type': 'random', 'material': 'm', 'count': 12, 'radius': 0.04, 'seed': 3,\n"
    "   'region': {'min': [-0.2, -0.2, -0.2], 'max': [0.2, 0.2, 0.1]}}]}}\n";

static const char *dir;

static void setup(void) {
  dir = directory_with_scene(scene);
}

static void run(const char *out, const char *options) {
  int status = command("tandem run %s/scene.json --out %s/%s %s", dir, dir, out, options);
  ck_assert_msg(status == 0, "%d: %s", status, command_output);
}

static int find_body(const tdm_scenery *s, const char *name) {
  for (int k = 0; k < s->nbody; k++)
    if (strcmp(s->body[k].name, name) == 0)
      return k;
  return -1;
}

static int polygons_of(const tdm_scenery *s, int body) {
  int n = 0;
  for (int k = 0; k < s->npolygon; k++)
    n += s->polygon[k].body == body;
  return n;
}

START_TEST(both_solvers_are_seen) {
  tdm_frames frames;
  tdm_error err = {0};
  tdm_snapshot s = {0};
  setup();
  run("out", "--set output.particles_interval=0.01");
  ck_assert_msg(tdm_frames_open(&frames,
                                (snprintf(command_output, sizeof command_output, "%s/out", dir), command_output),
                                &err) == TDM_OK,
                "%s", err.message);
  const tdm_scenery *sc = &frames.scenery;
  const int tray = find_body(sc, "tray"), arm = find_body(sc, "arm"), crate = find_body(sc, "crate"),
            slab = find_body(sc, "slab");
  ck_assert_int_eq(sc->nbody, 4); /* a coupled body is one */
  ck_assert(sc->body[tray].dem && sc->body[tray].mbd && !sc->body[tray].marked);
  ck_assert(!sc->body[arm].dem && sc->body[arm].mbd && sc->body[arm].marked);
  ck_assert(!sc->body[crate].dem && !sc->body[crate].marked);
  ck_assert(sc->body[slab].dem && sc->body[slab].still);
  ck_assert_int_eq(polygons_of(sc, tray), 5);
  ck_assert_int_eq(polygons_of(sc, crate), 6);
  ck_assert_int_eq(sc->nedge, 1);
  ck_assert_int_ge(sc->nline, 3);
  /* windows of 0.7 ms: the first ends at or after 0, 10, 20, ... ms, and the last */
  static const double times[] = {0, 0.0105, 0.0203, 0.0301, 0.0406, 0.05};
  ck_assert_int_eq(frames.count, 6);
  for (int k = 0; k < 6; k++) {
    ck_assert_double_eq_tol(frames.time[k], times[k], 1e-12);
    ck_assert_msg(tdm_frames_load(&frames, k, &s, &err) == TDM_OK, "%s", err.message);
    ck_assert_int_eq(s.nparticle, 12);
    for (int i = 0; i < s.nparticle; i++)
      ck_assert_int_eq(s.size_class[i], 1);
  }
  ck_assert_double_lt(s.pose[tray].position.z, -1e-4); /* it sank into its spring */
  double pushed = 0;
  for (int i = 0; i < s.nparticle; i++)
    pushed += tdm_norm(s.force[i]);
  ck_assert_double_gt(pushed, 1);
  static const char *const files[] = {"particles_000005.vtp", "walls_000005.vtp", "mechanism_000005.vtp", "scene.pvd"};
  for (int k = 0; k < 4; k++)
    ck_assert_msg(is_there(dir, "out", files[k]), "%s", files[k]);
  ck_assert(!is_there(dir, "out", "particles_000006.vtp"));
  ck_assert_int_eq(command("grep -c DataSet %s/out/scene.pvd", dir), 0);
  expect_output("18");
  tdm_snapshot_free(&s);
  tdm_frames_close(&frames);
  directory_remove(dir);
}
END_TEST

/* Every byte of every time history is the same with and without, whatever the scheme. */
START_TEST(looking_changes_nothing) {
  static const char *const options[] = {
      "",
      "--set coupling.scheme=iterative",
      "--set coupling.scheme=lommen --set coupling.n=2",
      "--set coupling.scheme=dem-first --set coupling.n=3",
      "--set coupling.n=auto --set coupling.auto.n_max=20", /* below the interval, which limits it */
      "--set coupling.transport=inproc",
      "--set dem.threads=2 --set dem.integrator=multi-step --set "
      "dem.multi_step.substeps=2 --set dem.multi_step.mass=0.01 --set "
      "coupling.scheme=dem-first --set coupling.n=3"};
  setup();
  for (size_t k = 0; k < sizeof options / sizeof options[0]; k++) {
    char with[256];
    snprintf(with, sizeof with, "%s --force --set output.particles_interval=3.3e-3", options[k]);
    run("with", with);
    snprintf(with, sizeof with, "%s --force", options[k]);
    run("without", with);
    ck_assert(is_there(dir, "with", "frames.tdv") && !is_there(dir, "without", "frames.tdv"));
    ck_assert_msg(command("sh -c 'cd %s/without && for f in *.csv; do cmp $f ../with/$f || exit 1; done'", dir) == 0,
                  "%s: %s", options[k], command_output);
  }
  directory_remove(dir);
}
END_TEST

/* Frames of a run that is killed are whole, and scene.pvd lists those that are there. */
START_TEST(a_killed_run) {
  setup();
  char file[256], out[256];
  snprintf(file, sizeof file, "%s/scene.json", dir);
  snprintf(out, sizeof out, "%s/out", dir);
  const pid_t pid = background(dir, (const char *const[]){"run", file, "--out", out, "--set", "time.end=1000", "--set",
                                                          "output.particles_interval=1e-3", NULL});
  WAIT_FOR(is_there(dir, "out", "mechanism_000009.vtp"));
  kill(pid, SIGKILL);
  background_end(pid);
  tdm_frames frames;
  tdm_error err = {0};
  tdm_snapshot s = {0};
  ck_assert_msg(tdm_frames_open(&frames, out, &err) == TDM_OK, "%s", err.message);
  ck_assert_int_ge(frames.count, 9);
  for (int k = 0; k < frames.count; k++)
    ck_assert_msg(tdm_frames_load(&frames, k, &s, &err) == TDM_OK, "%s", err.message);
  ck_assert_int_eq(
      command("sh -c 'cd %s && tail -n 1 scene.pvd && for f in $(grep -o \"[a-z]*_[0-9]*.vtp\" scene.pvd); "
              "do grep -q /VTKFile $f || exit 1; done'",
              out),
      0);
  expect_output("</VTKFile>");
  tdm_snapshot_free(&s);
  tdm_frames_close(&frames);
  WAIT_FOR(find_processes(dir, NULL) == 0); /* its solvers end with it */
  directory_remove(dir);
}
END_TEST

/* With windows of one step, what pushes the triangles in a frame is the load of the body in that row. */
START_TEST(forces_on_triangles) {
  static const char mesh[] = "solid s\nfacet normal 0 0 1\nouter loop\nvertex -0.2 -0.2 -0.2\nvertex 0.2 -0.2 -0.2\n"
                             "vertex 0.2 0.2 -0.2\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\n"
                             "vertex -0.2 -0.2 -0.2\nvertex 0.2 0.2 -0.2\nvertex -0.2 0.2 -0.2\nendloop\nendfacet\n"
                             "endsolid s\n";
  char text[8192], out[256];
  const char *from = strstr(scene, "{'type': 'box', 'side': 'inside'"), *to = strstr(scene, "]}, {'name': 'slab'");
  ck_assert(from && to);
  snprintf(text, sizeof text, "%.*s{'type': 'mesh', 'file': 'plate.stl'}%s", (int)(from - scene), scene, to);
  dir = directory_with_scene(text);
  write_file(dir, "plate.stl", mesh);
  run("out", "--set coupling.n=1 --set output.interval=1e-4 --set output.particles_interval=0.01 --set "
             "dem.triangle_forces=true");
  tdm_frames frames;
  tdm_error err = {0};
  tdm_snapshot s = {0};
  cpl_table t;
  snprintf(out, sizeof out, "%s/out", dir);
  read_table(&t, dir, "out/body_tray.csv");
  const double *fx = column(&t, "fx"), *fz = column(&t, "fz");
  ck_assert_msg(tdm_frames_open(&frames, out, &err) == TDM_OK, "%s", err.message);
  const int tray = find_body(&frames.scenery, "tray");
  double most = 0;
  for (int k = 0; k < frames.count; k++) {
    tdm_vec3 sum = {0, 0, 0};
    ck_assert_msg(tdm_frames_load(&frames, k, &s, &err) == TDM_OK, "%s", err.message);
    ck_assert_int_eq(s.nforce, frames.scenery.npolygon);
    for (int i = 0; i < s.nforce; i++)
      if (frames.scenery.polygon[i].body == tray)
        sum = tdm_add(sum, s.force_on[i]);
    ck_assert_double_eq_tol(sum.x, fx[100 * k], 1e-6 * fabs(fz[100 * k]) + 1e-9);
    ck_assert_double_eq_tol(sum.z, fz[100 * k], 1e-6 * fabs(fz[100 * k]) + 1e-9);
    most = fmax(most, fabs(sum.z));
  }
  ck_assert_double_gt(most, 1);
  cpl_table_free(&t);
  tdm_snapshot_free(&s);
  tdm_frames_close(&frames);
  directory_remove(dir);
}
END_TEST

/* Bodies alone: frames at rows, whatever the windows, which stay as they are. */
START_TEST(bodies_alone) {
  dir = directory_with_scene(alone);
  for (int k = 0; k < 2; k++) {
    int status = command("tandem-mbd run %s/scene.json --out %s/%s --no-plots %s", dir, dir, k ? "with" : "without",
                         k ? "--set output.particles_interval=0.0093" : "");
    ck_assert_msg(status == 0, "%d: %s", status, command_output);
  }
  ck_assert_int_eq(command("cmp %s/with/channels.csv %s/without/channels.csv", dir, dir), 0);
  ck_assert_int_eq(command("grep timestep %s/with/scene.pvd", dir), 0);
  static const char *const times[] = {"\"0\"",     "\"0.01\"",  "\"0.019\"", "\"0.028\"",
                                      "\"0.038\"", "\"0.047\"", "\"0.05\""};
  for (int k = 0; k < 7; k++)
    expect_output(times[k]);
  ck_assert(is_there(dir, "with", "mechanism_000006.vtp") && !is_there(dir, "with", "walls_000000.vtp"));
  directory_remove(dir);
}
END_TEST

/* A foreign DEM solver that has no capability "view", and one whose answers are of no use: the run goes on. */
START_TEST(solvers_that_cannot_be_seen) {
  static const struct {
    const char *environment, *solver, *said;
    bool mechanism;
  } cases[] = {{"A=1", "dummy_solver", "does not have the capability", true},
               {"FAULT=view FAULT_TEXT=garbage", "faulty_solver", "is of no use: no scenery", true},
               {"FAULT=view FAULT_TEXT=empty", "faulty_solver", NULL, true},
               {"FAULT=view FAULT_TEXT=kind", "faulty_solver", "is of no use: a snapshot where", true},
               {"FAULT=view FAULT_TEXT=bodies", "faulty_solver", "a snapshot has 1 bodies", true}};
  dir = directory_with_scene("{'time': {'end': 0.02, 'dt': 1e-4}, 'output': {'particles_interval': 0.005},\n"
                             " 'coupling': {'n': 10, 'scheme': 'lommen', 'bodies': [{'mbd': 'mass', 'dem': 'mass'}],\n"
                             "  'timeout': 5, 'solvers': {'dem': 'SOLVER'}},\n"
                             " 'mbd': {'gravity': [0, 0, 0], 'bodies': [{'name': 'mass', 'mass': 1,\n"
                             "  'inertia': [1, 1, 1], 'position': [0, 0, 0], 'velocity': [1, 0, 0]}]},\n"
                             " 'dem': {'stiffness': 100}}\n");
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    int status = command("env %s tandem run %s/scene.json --out %s/out --force --set coupling.solvers.dem=%s",
                         cases[k].environment, dir, dir, cases[k].solver);
    ck_assert_msg(status == 0, "%s: %d: %s", cases[k].environment, status, command_output);
    if (cases[k].said)
      expect_output(cases[k].said);
    ck_assert(is_there(dir, "out", "scene.pvd"));
    ck_assert(is_there(dir, "out", "body_mass.csv"));
  }
  directory_remove(dir);
}
END_TEST

START_TEST(wrong_settings) {
  setup();
  static const struct {
    const char *options, *said;
  } cases[] = {{"--set output.particles_interval=1e-5", "shorter than a DEM step"},
               {"--set output.particles_interval=-1", "output.particles_interval"},
               {"--set dem.triangle_forces=true", "go into the files for ParaView"},
               {"--strict --set output.particles_interval=3", "its start and its end only"}};
  for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
    ck_assert_int_eq(command("tandem run %s/scene.json --out %s/out --force %s", dir, dir, cases[k].options), 1);
    expect_output(cases[k].said);
  }
  directory_remove(dir);
}
END_TEST

TEST_MAIN("frames", both_solvers_are_seen, looking_changes_nothing, a_killed_run, forces_on_triangles, bodies_alone,
          solvers_that_cannot_be_seen, wrong_settings)
