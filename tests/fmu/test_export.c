/* tandem export fmu: what it packs keeps the standard's rules and is complete; whatever is wrong is named, by the
 * command and by the FMU. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "master.h"
#include "protocol/fmi/fmi2.h"
#include "rules.h"
#include "tests/test_main.h"

#include <dlfcn.h>

static const struct {
  const char *options;
  int ninput, noutput; /* of the body; channels come on top */
} kinds[] = {{"--fmi 2 --side dem", 19, 6},
             {"--fmi 3 --side dem", 19, 6},
             {"--fmi 2 --side mbd", 6, 19},
             {"--fmi 3 --side mbd", 6, 19},
             {"--fmi 2 --side both --set coupling.scheme=proxy", 6, 25},
             {"--fmi 3 --side both", 6, 25}};

static char *read_text(const char *path) {
  FILE *f = fopen(path, "r");
  ck_assert_msg(f != NULL, "%s", path);
  char *text = calloc(1, 1 << 20);
  const size_t n = fread(text, 1, (1 << 20) - 1, f);
  text[n] = 0;
  fclose(f);
  return text;
}

START_TEST(keeps_the_rules) {
  char path[256], why[512], unpacked[TDM_FMI_DIR_MAX];
  tdm_error err = {0};
  setup();
  pack(kinds[_i].options);
  ck_assert_msg(tdm_archive_unpack(file, unpacked, &err) == TDM_OK, "%s", err.message);
  snprintf(path, sizeof path, "%s/modelDescription.xml", unpacked);
  char *text = read_text(path);
  ck_assert_str_eq(fmu_rules_broken(text, why, sizeof why), "");
  ck_assert_msg(strstr(text, "description=\"A plate &amp; &lt;two&gt; particles\"") != NULL, "%s", text);
  ck_assert_ptr_null(strstr(text, dir)); /* no paths of this machine */
  tdm_fmi_description d = {0};
  ck_assert_msg(tdm_description_read(&d, path, file, &err) == TDM_OK, "%s", err.message);
  int count[TDM_FMI_STRUCTURAL_PARAMETER + 1] = {0};
  for (int i = 0; i < d.nvariable; i++)
    count[d.variable[i].causality]++;
  ck_assert_int_eq(count[TDM_FMI_INPUT], kinds[_i].ninput);
  ck_assert_int_ge(count[TDM_FMI_OUTPUT], kinds[_i].noutput);
  ck_assert_int_eq(count[TDM_FMI_INDEPENDENT], 1);
  ck_assert_int_eq(d.once_per_process, 0);
  ck_assert_int_eq(d.keeps_states, 1);
  tdm_description_free(&d);
  free(text);
  tdm_archive_remove(unpacked);
  teardown();
}
END_TEST

/* The rules can be broken. */
static const struct {
  const char *from, *to, *why;
} slips[] = {{"<Unit name=\"m/s\">", "<Unit name=\"mm/s\">", "the unit \"m/s\" of"},
             {"valueReference=\"2\"", "valueReference=\"1\"", "one name or value reference"},
             {".position.y\"", ".position.x\"", "one name or value reference"},
             {"index=\"21\"", "index=\"20\"", "is no output"},
             {"<InitialUnknowns>", "<Unknowns>", "mismatched tag"},
             {" guid=", " gui=", "may not have the attribute"},
             {" start=\"0\"/>", "/>", "must be continuous, have a start"},
             {"initial=\"calculated\"", "initial=\"exact\"", "with a start only"},
             {"modelIdentifier=\"", "modelIdentifier=\"1-", "is no C identifier"},
             {"<UnitDefinitions>\n", "<Units/><UnitDefinitions>\n", "has no place"}};

START_TEST(rules_are_looked_at) {
  char path[256], why[512], unpacked[TDM_FMI_DIR_MAX];
  tdm_error err = {0};
  setup();
  pack("");
  ck_assert_msg(tdm_archive_unpack(file, unpacked, &err) == TDM_OK, "%s", err.message);
  snprintf(path, sizeof path, "%s/modelDescription.xml", unpacked);
  char *text = read_text(path), *changed = calloc(1, 1 << 20);
  for (size_t i = 0; i < sizeof slips / sizeof slips[0]; i++) {
    char *at = strstr(text, slips[i].from);
    ck_assert_msg(at != NULL, "no %s in %s", slips[i].from, text);
    snprintf(changed, 1 << 20, "%.*s%s%s", (int)(at - text), text, slips[i].to, at + strlen(slips[i].from));
    fmu_rules_broken(changed, why, sizeof why);
    ck_assert_msg(strstr(why, slips[i].why) != NULL, "%s: \"%s\"", slips[i].to, why);
  }
  free(text);
  free(changed);
  tdm_archive_remove(unpacked);
  teardown();
}
END_TEST

/* The same scene gives the same bytes. */
START_TEST(is_reproducible) {
  setup();
  pack("");
  ck_assert_int_eq(command("cp %s %s/first.fmu", file, dir), 0);
  pack("");
  ck_assert_int_eq(command("cmp %s %s/first.fmu", file, dir), 0);
  teardown();
}
END_TEST

/* Files that the scene names go along. */
START_TEST(packs_files) {
  char options[512];
  master m;
  setup();
  write_file(dir, "floor.stl",
             "solid floor\n facet normal 0 0 1\n  outer loop\n   vertex -2 -2 0\n   vertex 2 -2 0\n   vertex 2 2 0\n"
             "  endloop\n endfacet\n facet normal 0 0 1\n  outer loop\n   vertex -2 -2 0\n   vertex 2 2 0\n"
             "   vertex -2 2 0\n  endloop\n endfacet\nendsolid floor\n");
  snprintf(options, sizeof options,
           "--set 'dem.bodies[0].shapes[0]={\"type\":\"mesh\",\"file\":\"%s/floor.stl\"}' --set dem.settle.speed=1e-4 "
           "--set dem.settle.store=%s/bed",
           dir, dir);
  pack(options);
  ck_assert_int_eq(command("rm %s/floor.stl", dir), 0);
  ck_assert_int_eq(command("rm %s/bed", dir), 0);
  open_fmu(&m);
  initialize(&m, 0.05);
  ck_assert_double_eq_tol(get(&m, "plate-1.force.z"), -10.27, 0.1); /* of 2 balls of 0.52 kg, at rest */
  step(&m, 5e-4);
  close_fmu(&m);
  teardown();
}
END_TEST

static const struct {
  const char *words, *said;
} mistakes[] = {
    {"export", "write tandem export fmu SCENE"},
    {"export fmi %s/scene.json", "write tandem export fmu SCENE"},
    {"export fmu %s/scene.json --side left", "--side left: give \"dem\", \"mbd\" or \"both\""},
    {"export fmu %s/scene.json --fmi 1", "--fmi 1: give 2 or 3"},
    {"export fmu %s/scene.json --jobs 2", "--jobs does not go with this command"},
    {"export fmu %s/none.json", "none.json"},
    {"export fmu %s/scene.json --out /dev/null/m.fmu", "/dev/null/m.fmu: cannot be written"},
    {"export fmu %s/scene.json --out /tmp", "/tmp is there already; give --force"},
    {"export fmu %s/scene.json --set mbd.bodies[0].mass=-1", "mbd.bodies[0].mass"},
    {"export fmu %s/scene.json --side mbd --set coupling.solvers.mbd=none", "coupling.solvers.mbd"},
    {"export fmu %s/scene.json --set coupling.solvers.dem=null --set coupling.transport=tcp", "coupling.solvers.dem"},
    {"export fmu %s/scene.json --set 'dem.start=\"none\"'", "none"},
};

START_TEST(mistakes_are_named) {
  char words[512], line[640];
  setup();
  snprintf(words, sizeof words, mistakes[_i].words, dir);
  snprintf(line, sizeof line, "env -C %s $(which tandem) %s", dir, words);
  ck_assert_msg(is_refusal(command("%s", line)), "%s", command_output);
  expect_output(mistakes[_i].said);
  ck_assert_msg(command("ls %s/*.fmu", dir) != 0, "%s", command_output);
  teardown();
}
END_TEST

static char told[4096];

static void keep_told(void *environment, const char *instance, fmi2_status status, const char *category,
                      const char *message, ...) {
  va_list args;
  (void)environment, (void)instance, (void)status, (void)category;
  va_start(args, message);
  vsnprintf(told, sizeof told, message, args);
  va_end(args);
}

typedef fmi2_instance instantiate(const char *, int, const char *, const char *, const fmi2_callbacks *, int, int);

/* What a tool is told when it gets no instance. */
START_TEST(no_instance) {
  const fmi2_callbacks callbacks = {.logger = keep_told, .allocate = calloc, .release = free};
  char resources[256];
  tdm_error err = {0};
  tdm_fmu *fmu;
  setup();
  pack("");
  ck_assert_msg(tdm_fmu_open(&fmu, file, &err) == TDM_OK, "%s", err.message);
  instantiate *make = NULL;
  *(void **)&make = dlsym(fmu->library, "fmi2Instantiate");
  snprintf(resources, sizeof resources, "file://%s/resources", fmu->dir);
  ck_assert_ptr_null(make("a", FMI2_CO_SIMULATION, "{other}", resources, &callbacks, 0, 0));
  ck_assert_msg(strstr(told, "the token \"{other}\" is not that of this FMU") != NULL, "%s", told);
  ck_assert_ptr_null(make("a", 0, fmu->description.token, resources, &callbacks, 0, 0));
  ck_assert_msg(strstr(told, "not for model exchange") != NULL, "%s", told);
  ck_assert_ptr_null(make("a", FMI2_CO_SIMULATION, fmu->description.token, "file:///nowhere", &callbacks, 0, 0));
  ck_assert_msg(strstr(told, "/nowhere/bin/tandem-serve cannot be executed") != NULL, "%s", told);
  setenv("TANDEM_PROGRAMS", "/nowhere", 1);
  ck_assert_ptr_null(make("a", FMI2_CO_SIMULATION, fmu->description.token, resources, &callbacks, 0, 0));
  ck_assert_msg(strstr(told, "/nowhere/tandem-serve cannot be executed") != NULL, "%s", told);
  setenv("TANDEM_PROGRAMS", TANDEM_BIN_DIR, 1);
  ck_assert_int_eq(command("rm -r %s/resources/bin", fmu->dir), 0);
  fmu->instance = make("a", FMI2_CO_SIMULATION, fmu->description.token, resources, &callbacks, 0, 0);
  ck_assert_msg(fmu->instance != NULL, "%s", told);
  ck_assert_int_eq(command("rm %s/resources/scene.json", fmu->dir), 0);
  ck_assert_ptr_null(make("a", FMI2_CO_SIMULATION, fmu->description.token, resources, &callbacks, 0, 0));
  ck_assert_msg(strstr(told, "scene.json") != NULL, "%s", told);
  tdm_fmu_close(&fmu);
  unsetenv("TANDEM_PROGRAMS");
  teardown();
}
END_TEST

/* ---- what goes wrong is named ---- */

static void expect_said(const master *m, const char *text) {
  ck_assert_msg(strstr(m->fmu->said, text) != NULL, "no \"%s\" in \"%s\"", text, m->fmu->said);
}

/* A step that does not fit is discarded, and another may be tried. */
START_TEST(steps_that_do_not_fit) {
  const tdm_fmu_version *v;
  master m;
  setup();
  pack(_i == 0 ? "--side dem" : "--side both");
  open_fmu(&m);
  initialize(&m, 0.05);
  v = m.fmu->version;
  ck_assert_int_eq(v->step(m.fmu, 0, 1.5e-4, true), 2);
  expect_said(&m, "no whole number of DEM steps of 0.0001 s (time.dt)");
  ck_assert_int_eq(v->step(m.fmu, 0, 0, true), 2);
  ck_assert_int_eq(v->step(m.fmu, 0, NAN, true), 2);
  ck_assert_int_eq(v->step(m.fmu, 1e-3, 1e-3, true), 2);
  expect_said(&m, "begins 0.001 s after the start, but the last one ended 0 s after it");
  ck_assert_int_eq(v->step(m.fmu, 0, 0.1, true), 2);
  expect_said(&m, "beyond the end of the experiment");
  ck_assert_int_eq(v->step(m.fmu, 0, 5e-4, true), 0);
  if (_i == 0) {
    set(&m, "plate-1.angular_velocity.x", 1e4);
    ck_assert_int_eq(v->step(m.fmu, 5e-4, 5e-4, true), 2);
    expect_said(&m, "body \"plate-1\" turns by");
    set(&m, "plate-1.angular_velocity.x", 0);
    set(&m, "plate-1.orientation.w", 0);
    ck_assert_int_eq(v->step(m.fmu, 5e-4, 5e-4, true), 3);
    expect_said(&m, "give one of norm 1");
  }
  close_fmu(&m);
  teardown();
}
END_TEST

/* Processes that die end the step, and nothing is left. */
START_TEST(processes_that_die) {
  static const char *const programs[] = {"tandem-dem", "tandem-serve"};
  static const char *const said[] = {"killed by signal 9", "tandem-serve has ended"};
  char words[256];
  pid_t pid = 0;
  master m;
  setup();
  pack("");
  open_fmu(&m);
  initialize(&m, 0.05);
  step(&m, 1e-3);
  snprintf(words, sizeof words, "%s/resources/bin/%s", m.fmu->dir, programs[_i]);
  ck_assert_int_eq(find_processes(words, &pid), 1);
  kill(pid, SIGKILL);
  ck_assert_int_eq(m.fmu->version->step(m.fmu, 1e-3, 1e-3, true), 3);
  expect_said(&m, said[_i]);
  ck_assert_int_eq(m.fmu->version->step(m.fmu, 1e-3, 1e-3, true), 3);
  expect_said(&m, "this instance has failed");
  close_fmu(&m);
  pack(""); /* what a server that was killed has left is removed by the next one */
  teardown();
}
END_TEST

/* The tool dies, between steps or (its solver hanging) in one: all that it had started ends. */
START_TEST(tools_that_die) {
  char words[256];
  int line[2], go[2];
  pid_t solver = 0;
  setup();
  pack("");
  ck_assert_int_eq(pipe(line) | pipe(go), 0);
  const pid_t tool = fork();
  if (tool == 0) {
    master m;
    open_fmu(&m);
    initialize(&m, 0.05);
    if (write(line[1], m.fmu->dir, sizeof m.fmu->dir) < 0 || read(go[0], words, 1) < 0)
      _exit(1);
    if (_i == 1) /* its solver was stopped */
      m.fmu->version->step(m.fmu, 0, 1e-2, true);
    while (true)
      pause();
  }
  ck_assert_int_eq(read(line[0], words, TDM_FMI_DIR_MAX), TDM_FMI_DIR_MAX);
  strcat(words, "/resources/bin/tandem-dem");
  ck_assert_int_eq(find_processes(words, &solver), 1);
  if (_i == 1)
    kill(solver, SIGSTOP);
  ck_assert_int_eq(write(go[1], "", 1), 1);
  usleep(300000);
  kill(tool, SIGKILL);
  ck_assert_int_eq(waitpid(tool, NULL, 0), tool);
  teardown(); /* waits for the end of all, and for what was unpacked to go */
}
END_TEST

/* An instance that has failed can be reset, and runs as at first. */
START_TEST(is_reset) {
  fmi2_status (*reset)(fmi2_instance);
  double first[2];
  master m;
  setup();
  pack("");
  open_fmu(&m);
  *(void **)&reset = dlsym(m.fmu->library, "fmi2Reset");
  for (int k = 0; k < 2; k++) {
    initialize(&m, 0.05);
    m.t = 0;
    step(&m, 2e-3);
    first[k] = get(&m, "plate-1.force.z");
    set(&m, "plate-1.orientation.w", 0);
    ck_assert_int_eq(m.fmu->version->step(m.fmu, 2e-3, 1e-3, true), 3);
    ck_assert_int_eq(reset(m.fmu->instance), FMI2_OK);
  }
  ck_assert_double_eq(first[0], first[1]);
  ck_assert_double_lt(first[0], -5);
  m.fmu->running = false;
  close_fmu(&m);
  teardown();
}
END_TEST

#define ROWS(table) (int)(sizeof table / sizeof table[0])
TEST_MAIN_ROWS("export", {keeps_the_rules, ROWS(kinds)}, {rules_are_looked_at, 1}, {is_reproducible, 1},
               {packs_files, 1}, {mistakes_are_named, ROWS(mistakes)}, {no_instance, 1}, {steps_that_do_not_fit, 2},
               {processes_that_die, 2}, {tools_that_die, 2}, {is_reset, 1})
