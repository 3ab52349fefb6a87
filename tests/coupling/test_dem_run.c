/* tandem-dem run and check as a user calls them: the files of a run, bit-identity, wrong input, Ctrl-C. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/command.h"
#include "tests/result_table.h"
#include "tests/test_main.h"

#include <jansson.h>
#include <math.h>
#include <stdbool.h>
#include <stdint.h>

/* Seven balls drop into a tub; a ramp beside it. */
static const char scene[] =
    "{\"time\": {\"end\": 0.1, \"dt\": 2e-4},\n"
    " \"output\": {\"interval\": 0.01, \"particles_interval\": 0.05},\n"
    " \"dem\": {\"materials\": [{\"name\": \"m\", \"density\": 1000, \"young_modulus\": 1e7, \"poisson_ratio\": "
    "0.3}],\n"
    "  \"pairs\": [{\"materials\": [\"m\", \"m\"], \"restitution\": 0.8, \"friction\": 0.4}],\n"
    "  \"bodies\": [{\"name\": \"tub\", \"material\": \"m\", \"shapes\": [{\"type\": \"box\", \"size\": [0.5, 0.5, "
    "0.5],\n"
    "   \"side\": \"inside\", \"open\": [\"+z\"]}, {\"type\": \"box\", \"side\": \"outside\", \"size\": [0.1, 0.1, "
    "0.02],"
    "\n   \"center\": [0, 0, -0.24]}]}],\n"
    "  \"particles\": [{\"type\": \"random\", \"material\": \"m\", \"count\": 7, \"radius\": 0.05, \"seed\": 3,\n"
    "   \"region\": {\"min\": [-0.2, -0.2, -0.2], \"max\": [0.2, 0.2, -0.08]}}]}}\n";

static const char *dir;

static void setup(void) {
  dir = directory_with_scene(scene);
}

static void run(const char *out, const char *options) {
  int status = command("tandem-dem run %s/scene.json --out %s/%s %s", dir, dir, out, options);
  ck_assert_msg(status == 0, "%d: %s", status, command_output);
}

static char *read_all(const char *out, const char *name) {
  char path[512];
  snprintf(path, sizeof path, "%s/%s/%s", dir, out, name);
  FILE *f = fopen(path, "r");
  ck_assert_msg(f != NULL, "%s is not there", path);
  char *text = calloc(1, 1 << 20);
  ck_assert_uint_lt(fread(text, 1, (1 << 20) - 1, f), (1 << 20) - 1);
  fclose(f);
  return text;
}

/* ---- a little XML ---- */

/* the arrays behind the text; NULL: there are none */
static const char *data_of(const char *xml) {
  const char *at = strstr(xml, "<AppendedData encoding=\"raw\">");
  return at ? strchr(at, '_') + 1 : NULL;
}

static uint64_t bytes_at(const char *data) {
  uint64_t n;
  memcpy(&n, data, sizeof n);
  return n;
}

/* one array stands behind the other; the end of the last one */
static const char *behind_data(const char *xml) {
  const char *data = data_of(xml), *at = data;
  for (const char *p = strstr(xml, "offset=\""); p && p < data; p = strstr(p + 1, "offset=\"")) {
    ck_assert_uint_eq(strtoul(p + 8, NULL, 10), (size_t)(at - data));
    at += sizeof(uint64_t) + bytes_at(at);
  }
  return at;
}

/* every element is closed in its turn */
static void expect_balanced(const char *xml) {
  char open[32][32];
  int depth = 0;
  for (const char *p = strchr(xml, '<'); p; p = strchr(p + 1, '<')) {
    char name[32];
    const char *end = strchr(p, '>');
    ck_assert_ptr_nonnull(end);
    if (p[1] == '?' || end[-1] == '/')
      continue;
    ck_assert_int_eq(sscanf(p + 1 + (p[1] == '/'), "%31[A-Za-z]", name), 1);
    if (p[1] == '/') {
      ck_assert_int_gt(depth, 0);
      ck_assert_str_eq(open[--depth], name);
    } else {
      ck_assert_int_lt(depth, 32);
      strcpy(open[depth++], name);
      if (strcmp(name, "AppendedData") == 0)
        p = behind_data(xml);
    }
  }
  ck_assert_int_eq(depth, 0);
}

/* The bytes of a DataArray; returns their number. */
static size_t decode(const char *xml, const char *name, unsigned char *out, size_t size) {
  char what[64];
  snprintf(what, sizeof what, "Name=\"%s\"", name);
  const char *p = strstr(xml, what);
  ck_assert_msg(p != NULL, "no array %s", name);
  p = data_of(xml) + strtoul(strstr(p, "offset=\"") + 8, NULL, 10);
  const size_t n = bytes_at(p);
  ck_assert_uint_le(n, size);
  memcpy(out, p + sizeof(uint64_t), n);
  return n;
}

/* ---- tests ---- */

START_TEST(a_run_writes_its_files) {
  setup();
  run("out", "--set 'output.pictures={\"times\":[0,0.05],\"view\":\"yz\",\"color\":\"height0\"}'");
  cpl_table t;
  tdm_error err = {0};
  read_table(&t, dir, "out/channels.csv");
  ck_assert_int_eq(t.nrow, 11);
  const double *time = cpl_table_column(&t, "time", &err), *z = cpl_table_column(&t, "particles.com.z", &err);
  ck_assert_ptr_nonnull(z);
  ck_assert_double_eq_tol(time[10], 0.1, 1e-15);

  /* the particles of a frame are those of the time histories: equal masses, so their mean is the centre of mass */
  for (int frame = 0; frame < 3; frame++) {
    char name[64];
    snprintf(name, sizeof name, "particles_%06d.vtp", frame);
    char *xml = read_all("out", name);
    expect_balanced(xml);
    ck_assert_ptr_nonnull(strstr(xml, "NumberOfPoints=\"7\""));
    double x[7][3], mean = 0, radius[7 + 1];
    unsigned char bytes[512];
    ck_assert_uint_eq(decode(xml, "position", bytes, sizeof bytes), sizeof x);
    memcpy(x, bytes, sizeof x);
    for (int i = 0; i < 7; i++)
      mean += x[i][2] / 7;
    ck_assert_double_eq_tol(mean, z[5 * frame], 1e-14);
    ck_assert_uint_eq(decode(xml, "radius", bytes, sizeof bytes), 7 * sizeof(double));
    memcpy(radius, bytes, 7 * sizeof(double));
    ck_assert_double_eq(radius[6], 0.05);
    free(xml);
  }
  cpl_table_free(&t);

  /* the five faces of the tub, cut to its size, and the six of the block */
  char *xml = read_all("out", "walls_000000.vtp");
  expect_balanced(xml);
  ck_assert_ptr_nonnull(strstr(xml, "NumberOfPolys=\"11\""));
  static unsigned char bytes[11 * 12 * 24 + 64];
  size_t n = decode(xml, "position", bytes, sizeof bytes) / sizeof(double);
  double largest = 0;
  for (size_t i = 0; i < n; i++) {
    double x;
    memcpy(&x, bytes + i * sizeof x, sizeof x);
    largest = fmax(largest, fabs(x));
  }
  ck_assert_double_eq_tol(largest, 0.25, 1e-8);
  free(xml);
  xml = read_all("out", "scene.pvd");
  expect_balanced(xml);
  ck_assert_ptr_nonnull(strstr(xml, "timestep=\"0.05\" part=\"0\" name=\"particles\" file=\"particles_000001.vtp\""));
  free(xml);

  char *text = read_all("out", "summary.json");
  json_t *summary = json_loads(text, 0, NULL);
  ck_assert_str_eq(json_string_value(json_object_get(summary, "status")), "TDM_OK");
  ck_assert_int_eq(json_integer_value(json_object_get(summary, "particles")), 7);
  ck_assert_int_eq(json_integer_value(json_object_get(summary, "steps")), 500);
  ck_assert_double_eq(json_number_value(json_object_get(summary, "particle_steps")), 3500);
  ck_assert_int_eq(json_integer_value(json_object_get(summary, "pictures")), 2);
  json_decref(summary);
  free(text);
  static const char *const pictures[] = {"picture_000.png", "picture_001.png", "pictures.png", "channels.png"};
  for (int i = 0; i < 4; i++)
    ck_assert_msg(is_there(dir, "out", pictures[i]), "%s", pictures[i]);
  directory_remove(dir);
}
END_TEST

START_TEST(runs_are_bit_identical) {
  setup();
  run("one", "");
  run("two", "--set output.interval=0.01");
  static const char *const files[] = {"channels.csv",         "particles_000000.vtp", "particles_000001.vtp",
                                      "particles_000002.vtp", "walls_000002.vtp",     "scene.pvd"};
  for (int i = 0; i < 6; i++)
    ck_assert_msg(command("cmp %s/one/%s %s/two/%s", dir, files[i], dir, files[i]) == 0, "%s", command_output);
  directory_remove(dir);
}
END_TEST

/* Frames between rows change no byte of the rows, whatever the threads: enough balls for two chunks of particles. */
START_TEST(frames_do_not_change_the_run) {
  static const char *const options[] = {"", "--set output.particles_interval=0.0034",
                                        "--set output.particles_interval=0.0034 --set dem.threads=2"};
  setup();
  for (int k = 0; k < 3; k++) {
    char out[8], all[256];
    snprintf(out, sizeof out, "%d", k);
    snprintf(all, sizeof all,
             "--set output.particles_interval=1 --set time.end=0.02 --set time.dt=2e-5 --set output.interval=0.005 "
             "--set dem.particles[0].count=2500 --set dem.particles[0].radius=0.007 %s",
             options[k]);
    run(out, all);
  }
  ck_assert(is_there(dir, "1", "particles_000006.vtp") && !is_there(dir, "0", "particles_000003.vtp"));
  for (int k = 1; k < 3; k++)
    ck_assert_int_eq(command("cmp %s/0/channels.csv %s/%d/channels.csv", dir, dir, k), 0);
  ck_assert_int_eq(command("cmp %s/1/frames.tdv %s/2/frames.tdv", dir, dir), 0);
  directory_remove(dir);
}
END_TEST

START_TEST(outputs_do_not_change_the_run) {
  setup();
  run("one", "");
  run("two", "--set output.interval=0.1 --set output.particles_interval=0.0166");
  char *a = read_all("one", "channels.csv"), *b = read_all("two", "channels.csv");
  size_t n = 0; /* of the last row; the loads behind the particles' channels are means over the interval */
  const char *row = strstr(a, "\n0.1,");
  for (int comma = 0; comma < 12; n++)
    comma += row[n] == ',';
  ck_assert_mem_eq(row, strstr(b, "\n0.1,"), n);
  free(a);
  free(b);
  directory_remove(dir);
}
END_TEST

START_TEST(without_gnuplot_runs_work) {
  setup();
  int status = command("env PATH=/nowhere " TANDEM_BIN_DIR "/tandem-dem run %s/scene.json --out %s/out --set "
                       "'output.pictures={\"times\":[0,0.05,0.1]}'",
                       dir, dir);
  ck_assert_msg(status == 0, "%d: %s", status, command_output);
  expect_output("gnuplot is not installed");
  ck_assert(is_there(dir, "out", "picture_002.png") && is_there(dir, "out", "summary.json"));
  directory_remove(dir);
}
END_TEST

static const struct {
  const char *options, *path, *words;
} cases[] = {
    {"--set time.dt=0", "time.dt", "greater than 0"},
    {"--set time.edn=1", "time.edn", "did you mean \"end\""},
    {"--set output.interval=1e-9", "output.interval", "shorter than a DEM step"},
    {"--set output.particles_interval=0", "output.particles_interval", "greater than 0"},
    {"--set output.particles_intervall=1", "output.particles_intervall", "did you mean \"particles_interval\""},
    {"--set output.pictures.view=xz", "output.pictures.times", "missing"},
    {"--set 'output.pictures={\"times\":[]}'", "output.pictures.times", "1 to 1000"},
    {"--set 'output.pictures={\"times\":[0.1,0.05]}'", "output.pictures.times[1]", "later than"},
    {"--set 'output.pictures={\"times\":[\"soon\"]}'", "output.pictures.times[0]", "must be a time"},
    {"--set 'output.pictures={\"times\":[0],\"view\":\"up\"}'", "output.pictures.view", "\"xz\""},
    {"--set 'output.pictures={\"times\":[0],\"color\":\"sped\"}'", "output.pictures.color", "did you mean \"speed\""},
    {"--set 'output.pictures={\"times\":[0],\"min\":[0,0]}'", "output.pictures.max", "missing"},
    {"--set 'output.pictures={\"times\":[0],\"min\":[0,0],\"max\":[0,1]}'", "output.pictures.max", "greater than min"},
    {"--set 'output.repose={\"along\":\"z\"}'", "output.repose.along", "\"x\", \"y\""},
    {"--set coupling.n=3", "coupling", "tandem run"},
    {"--set mbd.bodies=[]", "mbd", "tandem run"},
    {"--set demm.gravity=1", "demm", "did you mean \"dem\""},
    {"--set dem.particles[0].radius=0", "dem.particles[0].radius", "greater than 0"},
    {"--set dem.pairs=[]", "dem.pairs", "can touch"},
    {"--set time.dt=5e-3 --set output.interval=0.01 --set dem.materials[0].young_modulus=5e11", "time.dt",
     "half of the shortest contact"},
    {"--set time.dt=5e-3 --set output.interval=0.01 --set dem.materials[0].young_modulus=5e11 --set "
     "dem.guard.action=warn --strict",
     "time.dt", "strict"},
    {"--set time.dt=1 --set time.end=10 --set output.interval=1 --set output.particles_interval=1", "time.dt",
     "use at most"},
    {"--set dem.gravity=[0,0,1e308]", "dem.gravity", "too large"},
    {"--set dem.particles[0].mass=1e-300", "dem.particles[0].mass", "1e-300 kg"},
    {"--set dem.materials[0].density=1e-300", "dem.particles[0].radius", "gives a particle of"},
    {"--set dem.particles[0].velocity=[1e200,0,0]", "dem.particles[0].velocity", "too large"},
    {"--set dem.bodies[0].name=a,b", "dem.bodies[0].name", "column names"},
    {"--set dem.triangle_forces=true", "dem.triangle_forces", "no mesh"},
};

START_TEST(values_of_the_scene) {
  setup();
  for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
    int status = command("tandem-dem run %s/scene.json --out %s/out --force %s", dir, dir, cases[i].options);
    ck_assert_msg(status == 1, "%s: exit status %d: %s", cases[i].options, status, command_output);
    char path[256];
    snprintf(path, sizeof path, ": %s: ", cases[i].path);
    ck_assert_msg(
        strstr(command_output, path) && strstr(command_output, cases[i].words) && strstr(command_output, "scene.json:"),
        "%s: expected place, \"%s\" and \"%s\" in: %s", cases[i].options, path, cases[i].words, command_output);
  }
  directory_remove(dir);
}
END_TEST

START_TEST(command_lines) {
  setup();
  static const struct {
    const char *words, *output;
    int status;
  } lines[] = {
      {"", "tandem-dem run SCENE", 2},
      {"--help", "tandem-dem check SCENE", 0},
      {"--version", "tandem-dem ", 0},
      {"rnu", "did you mean run", 2},
      {"run", "name one scene", 2},
      {"run a.json b.json", "name one scene", 2},
      {"run nothing.json", "nothing.json", 1},
      {"run nothing", "neither a scene file nor a scenario", 1},
      {"run --froce x", "did you mean --force", 2},
      {"run --out", "--out needs a value", 2},
      {"check x --out y", "--out does not go", 2},
      {"--connect", "wrong option or value", 2},
  };
  for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
    int status = command("tandem-dem %s", lines[i].words);
    ck_assert_msg(status == lines[i].status, "\"%s\": exit status %d: %s", lines[i].words, status, command_output);
    expect_output(lines[i].output);
  }
  directory_remove(dir);
}
END_TEST

START_TEST(result_directories) {
  setup();
  run("out", "");
  ck_assert_int_eq(command("tandem-dem run %s/scene.json --out %s/out", dir, dir), 1);
  expect_output("holds the results of an earlier run");
  expect_output("--force");
  run("out", "--force --set output.particles_interval=0.1");
  ck_assert(!is_there(dir, "out", "particles_000002.vtp")); /* of the run before */

  ck_assert_int_eq(command("tandem-dem run %s/scene.json --out %s/scene.json/out", dir, dir), 1);
  expect_output("scene.json: cannot be the result directory, as it is a file");
  ck_assert_int_eq(command("tandem-dem run %s/scene.json --out %s/scene.json", dir, dir), 1);
  expect_output("scene.json: cannot be the result directory, as it is a file");
  ck_assert_int_eq(command("tandem-dem run %s/scene.json --out %s", dir, dir), 1);
  expect_output("is the scene itself");
  char *text = read_all(".", "scene.json");
  ck_assert_str_eq(text, scene);
  free(text);
  directory_remove(dir);
}
END_TEST

START_TEST(an_interrupt_keeps_what_was_computed) {
  setup();
  int status =
      command("timeout -s INT --preserve-status 2 tandem-dem run %s/scene.json --out %s/out --set time.end=1e4 "
              "--set output.interval=0.5 --set output.particles_interval=100",
              dir, dir);
  ck_assert_msg(status == 130, "%d: %s", status, command_output);
  char *csv = read_all("out", "channels.csv");
  ck_assert_ptr_nonnull(strstr(csv, "\n0.5,"));
  ck_assert_int_eq(csv[strlen(csv) - 1], '\n');
  free(csv);
  char *text = read_all("out", "summary.json");
  ck_assert_ptr_nonnull(strstr(text, "TDM_ERR_INTERRUPTED"));
  free(text);
  directory_remove(dir);
}
END_TEST

START_TEST(a_check_says_what_would_run) {
  setup();
  ck_assert_int_eq(command("tandem-dem check %s/scene.json --set output.pictures.times=[0.1]", dir), 0);
  expect_output("0.1 s in 500 steps");
  expect_output("every 0.01 s: 11 rows");
  expect_output("limits.rayleigh.time");
  expect_output("0 warnings");
  ck_assert(!is_there(dir, ".", "run-out"));
  directory_remove(dir);
}
END_TEST

/* Every scene of scenarios/dem loads without doubts about its step, with the particles that its README names. Those
 * that settle do it for a moment only. */
START_TEST(the_scenes_load) {
  static const struct {
    const char *name, *what, *number, *options;
  } scenes[] = {{"hopper", "particles", "1911", "--set dem.settle.max_time=1e-3"},
                {"mixer", "particles", "1567", "--set dem.settle.max_time=1e-3"},
                {"nozzle", "particles", "3483", "--set dem.settle.max_time=1e-3"},
                {"zigzag", "sources", "1", "--strict"},
                {"repose", "sources", "1", "--strict"},
                {"lifted", "particles", "400", ""},
                {"showers", "particles", "4336", "--strict"},
                {"conveyor", "meshes[0].triangles", "40", "--strict"}};
  for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
    char line[64];
    ck_assert_msg(command("tandem-dem check %s %s", scenes[i].name, scenes[i].options) == 0, "%s: %s", scenes[i].name,
                  command_output);
    ck_assert_msg(strstr(command_output, "time.dt: ") == NULL, "%s", command_output);
    snprintf(line, sizeof line, "\n  %-28s %s\n", scenes[i].what, scenes[i].number);
    expect_output(line);
  }
}
END_TEST

/* The name of a mesh starts at the folder of the scene, not where the command runs; out/scene.json can be run again. */
START_TEST(meshes_are_beside_the_scene) {
  setup();
  write_file(dir, "part.stl",
             "solid s\nfacet normal 0 0 1\nouter loop\nvertex -200 -200 0\nvertex 200 -200 0\nvertex 0 200 0\n"
             "endloop\nendfacet\nendsolid s\n");
  char text[4096];
  const char *from = strstr(scene, "{\"type\": \"box\", \"side\": \"outside\""), *to = strstr(scene, "}]}]");
  ck_assert(from && to);
  snprintf(text, sizeof text, "%.*s{\"type\": \"mesh\", \"file\": \"part.stl\", \"scale\": 0.001%s",
           (int)(from - scene), scene, to);
  write_file(dir, "scene.json", text);
  run("out", "");
  int status = command("tandem-dem check %s/out/scene.json", dir);
  ck_assert_msg(status == 0, "%d: %s", status, command_output);
  ck_assert_int_eq(command("rm %s/part.stl", dir), 0);
  ck_assert_int_eq(command("tandem-dem check %s/scene.json", dir), 1);
  expect_output("dem.bodies[0].shapes[1].file");
  expect_output("part.stl\" cannot be opened");
  directory_remove(dir);
}
END_TEST

/* A part of a scene's time: what lies behind its end is left away with a word, and the last state is in the tables. */
START_TEST(a_shorter_run) {
  setup();
  run("out", "--set time.end=0.035 --set 'output.pictures={\"times\":[0.01,0.08]}'");
  expect_output("output.pictures.times: 1 of 2 are later");
  char *csv = read_all("out", "channels.csv");
  ck_assert_ptr_nonnull(strstr(csv, "\n0.03,"));
  ck_assert_ptr_nonnull(strstr(csv, "\n0.035,"));
  free(csv);
  run("short", "--set time.end=0.004");
  expect_output("output.interval: is 0.01 s but the run ends at 0.004 s");
  csv = read_all("short", "channels.csv");
  ck_assert_ptr_nonnull(strstr(csv, "\n0,"));
  ck_assert_ptr_nonnull(strstr(csv, "\n0.004,"));
  free(csv);
  run("whole", "--set time.end=0.03"); /* on the grid: once */
  csv = read_all("whole", "channels.csv");
  char *last = strstr(csv, "\n0.03,");
  ck_assert_ptr_nonnull(last);
  ck_assert_ptr_null(strstr(last + 1, "\n0.0"));
  free(csv);
  directory_remove(dir);
}
END_TEST

/* The forces on the triangles in walls_N.vtp are the load of the body in the time histories. */
START_TEST(forces_on_triangles) {
  setup();
  write_file(dir, "part.stl",
             "solid s\nfacet normal 0 0 1\nouter loop\nvertex -0.25 -0.25 -0.2\nvertex 0.25 -0.25 -0.2\n"
             "vertex 0.25 0.25 -0.2\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex -0.25 -0.25 -0.2\n"
             "vertex 0.25 0.25 -0.2\nvertex -0.25 0.25 -0.2\nendloop\nendfacet\nendsolid s\n");
  char text[4096];
  const char *from = strstr(scene, "{\"type\": \"box\", \"side\": \"outside\""), *to = strstr(scene, "}]}]");
  ck_assert(from && to);
  snprintf(text, sizeof text,
           "%.*s{\"type\": \"mesh\", \"file\": \"part.stl\"}]}],\n \"triangle_forces\": true, "
           "\"geometry_loads\": true%s",
           (int)(from - scene), scene, to + 4);
  write_file(dir, "scene.json", text);
  run("out", "--set output.interval=2e-4 --set output.particles_interval=0.02"); /* a sample is one step */
  cpl_table t;
  tdm_error err = {0};
  read_table(&t, dir, "out/channels.csv");
  const double *load[3] = {cpl_table_column(&t, "body.tub.shape1.fx", &err),
                           cpl_table_column(&t, "body.tub.shape1.fy", &err),
                           cpl_table_column(&t, "body.tub.shape1.fz", &err)};
  ck_assert_msg(load[0] && load[1] && load[2], "%s", err.message);
  int pushed = 0;
  for (int frame = 0; frame < 6; frame++) {
    char name[64];
    snprintf(name, sizeof name, "walls_%06d.vtp", frame);
    char *xml = read_all("out", name);
    expect_balanced(xml);
    double force[7][3], pressure[7], shear[7][3]; /* five faces, two triangles of 0.125 m2 */
    unsigned char bytes[512];
    ck_assert_uint_eq(decode(xml, "force", bytes, sizeof bytes), sizeof force);
    memcpy(force, bytes, sizeof force);
    ck_assert_uint_eq(decode(xml, "pressure", bytes, sizeof bytes), sizeof pressure);
    memcpy(pressure, bytes, sizeof pressure);
    ck_assert_uint_eq(decode(xml, "shear", bytes, sizeof bytes), sizeof shear);
    memcpy(shear, bytes, sizeof shear);
    for (int face = 0; face < 5; face++)
      ck_assert(isnan(force[face][0]) && isnan(pressure[face]) && isnan(shear[face][2]));
    double size = fabs(force[5][2]) + fabs(force[6][2]);
    for (int a = 0; a < 3; a++)
      ck_assert_double_eq_tol(force[5][a] + force[6][a], load[a][100 * frame], 1e-12 * size + 1e-300);
    for (int i = 5; i < 7; i++) {
      ck_assert_double_eq_tol(pressure[i], -force[i][2] / 0.125, 1e-12 * fabs(pressure[i]) + 1e-300);
      ck_assert_double_eq_tol(shear[i][0], force[i][0] / 0.125, 1e-12 * fabs(pressure[i]) + 1e-300);
      ck_assert_double_eq_tol(shear[i][2], 0, 1e-12 * fabs(pressure[i]) + 1e-300);
    }
    pushed += size > 10;
    free(xml);
  }
  ck_assert_int_ge(pushed, 2);
  cpl_table_free(&t);
  char *interval = strstr(text, ", \"particles_interval\": 0.05");
  memset(interval, ' ', strcspn(interval, "}"));
  write_file(dir, "scene.json", text);
  ck_assert_int_eq(command("tandem-dem run %s/scene.json --out %s/two", dir, dir), 1);
  expect_output("output.particles_interval: missing: dem.triangle_forces");
  directory_remove(dir);
}
END_TEST

/* What the guard logs and particles behind walls are said on the terminal too. */
START_TEST(doubts_are_told) {
  setup();
  run("out", "--set dem.particles[0].velocity=[0,0,-4000]");
  expect_output("tandem-dem: warning: ");
  expect_output("guard.leap: ");
  expect_output("7 particles are behind a plane");
  run("calm", "");
  ck_assert_msg(strstr(command_output, "warning") == NULL, "%s", command_output);
  directory_remove(dir);
}
END_TEST

/* The benchmark's options; the forces are those of a brute-force evaluation, bit by bit, with rolling too. */
START_TEST(the_benchmark) {
  setup();
  static const struct {
    const char *options, *says;
  } wrong[] = {{"--particles 2.5", "\"--particles 2.5\" is not understood"},
               {"--particles 0", "is not understood"},
               {"--steps 1e3.5", "is not understood"},
               {"--law hertz//none", "is not understood"},
               {"--law hertz/mindlin/none/", "is not understood"},
               {"--law hertz/mindlin/none/none/none", "is not understood"},
               {"--law /mindlin", "is not understood"}};
  for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
    ck_assert_int_eq(command("tandem-dem bench %s", wrong[i].options), 1);
    expect_output(wrong[i].says);
  }
  static const char *const laws[] = {"hertz/mindlin", "hertz/none", "hertz/mindlin/spring-dashpot",
                                     "hooke/spring/constant-torque/sjkr"};
  for (size_t i = 0; i < sizeof laws / sizeof laws[0]; i++) {
    int status =
        command("env XDG_CACHE_HOME=%s tandem-dem bench --particles 400 --box 0.06 --steps 200 --law %s", dir, laws[i]);
    ck_assert_msg(status == 0, "%s: %s", laws[i], command_output);
    expect_output("\"force_error\": 0.0");
  }
  int status = command("env XDG_CACHE_HOME=%s tandem-dem bench --particles 1 --steps 200", dir);
  ck_assert_msg(status == 0, "%s", command_output);
  expect_output("\"coordination\": 1.0"); /* the floor */
  write_file(dir, "bed.txt", "# x y z r\n0.01 0.01 0.01 0.01\n0.05 0.01 0.01 0.01\n\n0.01 0.01 0.01 0.01\n");
  ck_assert_int_eq(command("tandem-dem bench --bed %s/bed.txt --box 0.1 --steps 10", dir), 1);
  expect_output("bed.txt\", lines 2 and 5");
  directory_remove(dir);
}
END_TEST

/* What is installed has all that its scenes need. */
START_TEST(installed_scenes_are_whole) {
  const char *where = directory_make();
  ck_assert_msg(command("cmake --install " TANDEM_BIN_DIR "/.. --component scenarios --prefix %s/p", where) == 0, "%s",
                command_output);
  ck_assert_msg(command("tandem-dem check conveyor --scenarios %s/p/share/tandem/scenarios", where) == 0, "%s",
                command_output);
  expect_output("bin.stl");
  directory_remove(where);
}
END_TEST

TEST_MAIN("dem_run", a_run_writes_its_files, runs_are_bit_identical, frames_do_not_change_the_run,
          outputs_do_not_change_the_run, without_gnuplot_runs_work, values_of_the_scene, command_lines,
          result_directories, an_interrupt_keeps_what_was_computed, a_check_says_what_would_run, the_scenes_load,
          meshes_are_beside_the_scene, forces_on_triangles, a_shorter_run, doubts_are_told, the_benchmark,
          installed_scenes_are_whole)
