/* tandem export fmu: what it packs keeps the standard's rules and is complete; whatever is wrong is named, by the
 * command and by the FMU. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "master.h"
#include "protocol/fmi/fmi2.h"
#include "rules.h"
#include "tests/test_main.h"

#include <dlfcn.h>
#include <time.h>

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
  ck_assert_int_eq(setenv("TZ", "Asia/Tokyo", 1), 0);
  pack("");
  ck_assert_int_eq(command("cmp %s %s/first.fmu", file, dir), 0);
  teardown();
}
END_TEST

/* The licence of what is packed goes along. */
START_TEST(packs_the_licence) {
  char unpacked[TDM_FMI_DIR_MAX];
  tdm_error err = {0};
  setup();
  pack("");
  ck_assert_msg(tdm_archive_unpack(file, unpacked, &err) == TDM_OK, "%s", err.message);
  ck_assert_int_eq(command("cmp %s/documentation/licenses/license.txt " TANDEM_SOURCE_DIR "/LICENSE", unpacked), 0);
  tdm_archive_remove(unpacked);
  teardown();
}
END_TEST

/* Files that the scene names go along, and the token is of their contents. */
START_TEST(packs_files) {
  char options[512], token[64];
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
  open_fmu(&m);
  snprintf(token, sizeof token, "%s", m.fmu->description.token);
  close_fmu(&m);
  ck_assert_int_eq(command("echo >> %s/floor.stl", dir), 0);
  pack(options);
  ck_assert_int_eq(command("rm %s/floor.stl", dir), 0);
  ck_assert_int_eq(command("rm %s/bed", dir), 0);
  open_fmu(&m);
  ck_assert_str_ne(m.fmu->description.token, token);
  initialize(&m, 0.05);
  ck_assert_double_eq_tol(get(&m, "plate-1.force.z"), -10.27, 0.1); /* of 2 balls of 0.52 kg, at rest */
  step(&m, 5e-4);
  close_fmu(&m);
  open_fmu(&m);
  set(&m, "plate-1.position.z", 1e-3);
  ck_assert_int_ne(tdm_fmu_initialize(m.fmu, &(tdm_fmu_experiment){.stop = 0.05}, &m.err), TDM_OK);
  ck_assert_msg(strstr(m.fmu->said, "belongs to bodies that start where") != NULL, "%s", m.fmu->said);
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
    {"export fmu %s/scene.json --set coupling.solvers.mbd=null --set coupling.transport=tcp", "coupling.solvers.mbd"},
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
  char resources[256], deep[5000] = "";
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
  ck_assert_ptr_null(make("a", FMI2_CO_SIMULATION, fmu->description.token, "file:///no%77here%4", &callbacks, 0, 0));
  ck_assert_msg(strstr(told, "/nowhere%4/bin/tandem-serve cannot be executed") != NULL, "%s", told);
  memset(deep, '/', sizeof deep - 1);
  ck_assert_ptr_null(make("a", FMI2_CO_SIMULATION, fmu->description.token, deep, &callbacks, 0, 0));
  ck_assert_msg(strstr(told, "of 4095 that it may have") != NULL, "%s", told);
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
  expect_said(&m, "nothing was done");
  ck_assert_int_eq(v->step(m.fmu, 0, 5e-4, true), 0);
  if (_i == 0) {
    set(&m, "plate-1.angular_velocity.x", 1e4);
    ck_assert_int_eq(v->step(m.fmu, 5e-4, 5e-4, true), 2);
    expect_said(&m, "body \"plate-1\" turns by");
    set(&m, "plate-1.angular_velocity.x", 0);
    set(&m, "plate-1.orientation.w", 0);
    ck_assert_int_eq(v->step(m.fmu, 5e-4, 5e-4, true), 2);
    expect_said(&m, "give one of norm 1");
    set(&m, "plate-1.orientation.w", 1);
    ck_assert_int_eq(v->step(m.fmu, 5e-4, 5e-4, true), 0);
  }
  close_fmu(&m);
  teardown();
}
END_TEST

static const char *const sides[] = {"--side dem", "--side mbd", "--side both"};

/* A step beyond the tool's stop time is an error, after which a state that was kept can be gone back to. */
START_TEST(steps_beyond_the_stop_time) {
  void *kept = NULL;
  master m;
  setup();
  pack(sides[_i]);
  open_fmu(&m);
  initialize(&m, 0.01);
  step(&m, 5e-3);
  ck_assert_int_eq(m.fmu->version->keep(m.fmu, &kept), 0);
  ck_assert_int_eq(m.fmu->version->step(m.fmu, 5e-3, 6e-3, true), 3);
  expect_said(&m, "from 0.005 s to 0.011 s leads beyond the stop time of the experiment, 0.01 s");
  ck_assert_int_eq(m.fmu->version->go_back(m.fmu, kept), 0);
  step(&m, 5e-3);
  m.fmu->version->forget(m.fmu, &kept);
  close_fmu(&m);
  teardown();
}
END_TEST

/* Where the tool has no stop time, the scene ends; one that no run reaches is as good as none. */
START_TEST(without_a_stop_time) {
  fmi2_status (*set_up)(fmi2_instance, int, double, double, int, double);
  fmi2_status (*enter)(fmi2_instance), (*leave)(fmi2_instance);
  master m;
  setup();
  pack(sides[_i]);
  open_fmu(&m);
  *(void **)&set_up = dlsym(m.fmu->library, "fmi2SetupExperiment");
  *(void **)&enter = dlsym(m.fmu->library, "fmi2EnterInitializationMode");
  *(void **)&leave = dlsym(m.fmu->library, "fmi2ExitInitializationMode");
  ck_assert_int_eq(set_up(m.fmu->instance, 0, 0, 0, 0, 0), FMI2_OK);
  ck_assert_int_le(enter(m.fmu->instance), FMI2_WARNING);
  ck_assert_int_le(leave(m.fmu->instance), FMI2_WARNING);
  step(&m, 0.04);
  ck_assert_int_eq(m.fmu->version->step(m.fmu, 0.04, 0.02, true), 2);
  expect_said(&m, "beyond the end of the scene (time.end), 0.05 s after the start");
  step(&m, 0.01);
  close_fmu(&m);
  open_fmu(&m);
  initialize(&m, 1e20);
  step(&m, 0.06);
  close_fmu(&m);
  teardown();
}
END_TEST

/* States of solvers that were stopped are not mistaken for those of the solvers that run now. */
START_TEST(states_of_another_run) {
  fmi2_status (*reset)(fmi2_instance);
  const tdm_fmu_version *v;
  void *old[2] = {NULL}, *now[2] = {NULL};
  double load[2];
  master m;
  setup();
  pack("");
  open_fmu(&m);
  v = m.fmu->version;
  *(void **)&reset = dlsym(m.fmu->library, "fmi2Reset");
  initialize(&m, 0.05);
  step(&m, 2e-3);
  for (int k = 0; k < 2; k++)
    ck_assert_int_eq(v->keep(m.fmu, &old[k]), 0);
  ck_assert_int_eq(reset(m.fmu->instance), FMI2_OK);
  initialize(&m, 0.05);
  m.t = 0;
  for (int k = 0; k < 2; k++) { /* in the slots of the old ones */
    step(&m, 1e-3);
    load[k] = get(&m, "plate-1.force.z");
    ck_assert_int_eq(v->keep(m.fmu, &now[k]), 0);
    v->forget(m.fmu, &old[0]);
  }
  ck_assert_double_ne(load[0], load[1]);
  ck_assert_int_eq(v->go_back(m.fmu, old[1]), 3);
  expect_said(&m, "a run of the solvers that has ended");
  ck_assert_int_eq(v->keep(m.fmu, &old[1]), 0); /* overwritten, it is one of this run */
  ck_assert_int_eq(v->go_back(m.fmu, now[0]), 0);
  m.t = 1e-3;
  ck_assert_double_eq(get(&m, "plate-1.force.z"), load[0]);
  step(&m, 1e-3);
  ck_assert_double_eq(get(&m, "plate-1.force.z"), load[1]);
  ck_assert_int_eq(v->go_back(m.fmu, old[1]), 0);
  for (int k = 0; k < 2; k++) {
    v->forget(m.fmu, &old[k]);
    v->forget(m.fmu, &now[k]);
  }
  close_fmu(&m);
  teardown();
}
END_TEST

/* States from before the first step can be gone back to at any time. */
START_TEST(states_before_steps) {
  fmi2_status (*enter)(fmi2_instance), (*leave)(fmi2_instance);
  const tdm_fmu_version *v;
  const char *input = _i == 0 ? "plate-1.velocity.z" : "deck.force.z";
  const char *output = _i == 0 ? "plate-1.force.z" : "deck.velocity.z";
  void *made = NULL, *entered = NULL, *stepped = NULL;
  double first;
  master m;
  setup();
  pack(sides[_i]);
  open_fmu(&m);
  v = m.fmu->version;
  *(void **)&enter = dlsym(m.fmu->library, "fmi2EnterInitializationMode");
  *(void **)&leave = dlsym(m.fmu->library, "fmi2ExitInitializationMode");
  set(&m, input, 0.5);
  ck_assert_int_eq(v->keep(m.fmu, &made), 0);
  ck_assert_int_le(enter(m.fmu->instance), FMI2_WARNING);
  ck_assert_int_eq(v->keep(m.fmu, &entered), 0);
  ck_assert_int_le(leave(m.fmu->instance), FMI2_WARNING);
  step(&m, 5e-3);
  first = get(&m, output);
  ck_assert_int_eq(v->keep(m.fmu, &stepped), 0);
  for (int k = 0; k < 2; k++) {
    set(&m, input, 0);
    ck_assert_int_eq(v->go_back(m.fmu, k == 0 ? made : entered), 0);
    ck_assert_double_eq(get(&m, input), 0.5);
    if (k == 0)
      ck_assert_int_le(enter(m.fmu->instance), FMI2_WARNING);
    ck_assert_int_le(leave(m.fmu->instance), FMI2_WARNING);
    ck_assert_int_eq(v->go_back(m.fmu, stepped), 3);
    m.t = 0;
    step(&m, 5e-3);
    ck_assert_double_eq(get(&m, output), first);
  }
  v->forget(m.fmu, &made);
  v->forget(m.fmu, &entered);
  v->forget(m.fmu, &stepped);
  close_fmu(&m);
  teardown();
}
END_TEST

/* A tool forks while instances run: what it has forked holds their lines, too, and yet they end. */
START_TEST(tools_that_fork) {
  struct timespec from, to;
  master m;
  setup();
  pack("");
  open_fmu(&m);
  initialize(&m, 0.05);
  const pid_t forked = fork();
  if (forked == 0)
    while (true)
      pause();
  clock_gettime(CLOCK_MONOTONIC, &from);
  close_fmu(&m);
  clock_gettime(CLOCK_MONOTONIC, &to);
  ck_assert_int_lt(to.tv_sec - from.tv_sec, 8); /* after 10 s they would be killed */
  kill(forked, SIGKILL);
  ck_assert_int_eq(waitpid(forked, NULL, 0), forked);
  teardown();
}
END_TEST

/* Tools without standard files have no trouble. */
START_TEST(tools_without_standard_files) {
  int status = 1;
  setup();
  pack("");
  const pid_t tool = fork();
  if (tool == 0) {
    master m;
    for (int fd = 0; fd < 3; fd++)
      close(fd);
    open_fmu(&m);
    initialize(&m, 0.05);
    step(&m, 1e-3);
    close_fmu(&m);
    _exit(0);
  }
  ck_assert_int_eq(waitpid(tool, &status, 0), tool);
  ck_assert_int_eq(status, 0);
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
  char words[256];
  pid_t solver = 0;
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
    snprintf(words, sizeof words, "%s/resources/bin/tandem-dem", m.fmu->dir);
    ck_assert_int_eq(find_processes(words, &solver), 1);
    kill(solver, SIGKILL);
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
               {packs_the_licence, 1}, {packs_files, 1}, {mistakes_are_named, SOME_ROWS(ROWS(mistakes))},
               {no_instance, 1}, {steps_that_do_not_fit, 2}, {steps_beyond_the_stop_time, 3}, {without_a_stop_time, 3},
               {states_of_another_run, 1}, {states_before_steps, 3}, {tools_that_fork, 1},
               {tools_without_standard_files, 1}, {processes_that_die, 2}, {tools_that_die, 2}, {is_reset, 1})
