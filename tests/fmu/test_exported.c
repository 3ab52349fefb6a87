/* FMUs that tandem export has made move and push as tandem run does. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "master.h"
#include "protocol/record/record.h"
#include "protocol/wire/message.h"
#include "scenarios/spring_damper/reference.h"
#include "tests/test_main.h"

/* ---- dem ---- */

static void set_state(master *m, const char *body, const tdm_state *state) {
  static const char *const names[] = {"position.x",        "position.y",    "position.z",         "orientation.w",
                                      "orientation.x",     "orientation.y", "orientation.z",      "velocity.x",
                                      "velocity.y",        "velocity.z",    "angular_velocity.x", "angular_velocity.y",
                                      "angular_velocity.z"};
  char name[128];
  for (int i = 0; i < TDM_STATE_DOUBLES; i++) {
    snprintf(name, sizeof name, "%s.%s", body, names[i]);
    set(m, name, ((const double *)(const void *)state)[i]);
  }
}

static void get_load(master *m, const char *body, double *load) {
  static const char *const names[] = {"force.x", "force.y", "force.z", "moment.x", "moment.y", "moment.z"};
  char name[128];
  for (int i = 0; i < TDM_WRENCH_DOUBLES; i++) {
    snprintf(name, sizeof name, "%s.%s", body, names[i]);
    load[i] = get(m, name);
  }
}

/* Motions that tandem run sent to tandem-dem, and the loads that came, from its record. */
typedef struct {
  tdm_record record;
  tdm_frame store[2];
  tdm_step step;
  tdm_result result;
} exchange;

static bool next_window(exchange *x) {
  tdm_recorded frame;
  tdm_header header;
  tdm_error err = {0};
  while (tdm_record_next(&x->record, 1, &frame, &err)) {
    ck_assert_int_eq(tdm_header_read(&header, frame.frame, frame.size, &err), TDM_OK);
    if (header.type == TDM_STEP)
      ck_assert_int_eq(tdm_step_read(&x->step, &header, &x->store[0], &err), TDM_OK);
    if (header.type == TDM_RESULT) {
      ck_assert_int_eq(tdm_result_read(&x->result, &header, &x->store[1], &err), TDM_OK);
      return true;
    }
  }
  ck_assert_msg(err.status == TDM_OK, "%s", err.message);
  return false;
}

static void record(exchange *x, const char *options) {
  static char path[128];
  tdm_error err = {0};
  *x = (exchange){0};
  snprintf(path, sizeof path, "%s/record", dir);
  ck_assert_msg(command("tandem run %s/scene.json --out %s/out --force --record %s %s", dir, dir, path, options) == 0,
                "%s", command_output);
  ck_assert_msg(tdm_record_open(&x->record, path, &err) == TDM_OK, "%s", err.message);
}

static void forget(exchange *x) {
  tdm_record_close(&x->record);
  tdm_frame_free(&x->store[0]);
  tdm_frame_free(&x->store[1]);
}

static void set_flag(master *m) {
  const tdm_fmi_variable *v = tdm_description_find(&m->fmu->description, "inputs_at_end");
  json_t *value = json_true();
  ck_assert_ptr_nonnull(v);
  ck_assert_msg(tdm_fmu_set_start(m->fmu, v, value, "", &m->err) == TDM_OK, "%s", m->err.message);
}

/* A master that moves the bodies as tandem run did gets the same loads, bit for bit, whatever the scene says of paths.
 */
START_TEST(dem_pushes_as_in_a_run) {
  exchange x;
  master m;
  int windows = 0;
  double most = 0;
  setup();
  record(&x, "");
  pack(_i == 0 ? "--fmi 2" : "--fmi 3 --set coupling.interpolation=linear");
  open_fmu(&m);
  set_flag(&m);
  initialize(&m, 0.05);
  while (next_window(&x)) {
    double load[TDM_WRENCH_DOUBLES];
    set_state(&m, "plate-1", x.step.end);
    step(&m, x.step.t1 - x.step.t0);
    get_load(&m, "plate-1", load);
    ck_assert_int_eq(x.result.ninterface, 1);
    ck_assert_msg(memcmp(load, &x.result.body[0].moment[0], sizeof load) == 0, "window %d: %.17g, in the run %.17g",
                  windows, load[2], x.result.body[0].moment[0].force.z);
    most = fmax(most, fabs(load[2]));
    windows++;
  }
  ck_assert_int_eq(windows, 100);
  ck_assert_double_gt(most, 5); /* the particles weigh 10 N */
  close_fmu(&m);
  forget(&x);
  teardown();
}
END_TEST

/* A master that owns the mechanism, and knows its motion at the start of a step: the box of the scenario spring_damper
 * with its 500 particles, against the closed form. */
START_TEST(dem_in_a_masters_mechanism) {
  const scn_spring_damper_parameters theory = {
      .mass = 361.8, .damping = 500, .stiffness = 5000, .preload = 100, .gravity = 9.81};
  const double h = 5e-4, mass = 100;
  double x = 0, v = 0, sum[2] = {0}, square[2] = {0}, off[2] = {0};
  const int n = 3000;
  master m;
  setup();
  ck_assert_msg(
      command("tandem export fmu " TANDEM_SOURCE_DIR "/scenarios/spring_damper/scene.json --out %s --fmi 3", file) == 0,
      "%s", command_output);
  open_fmu(&m);
  initialize(&m, n * h);
  for (int k = 0; k < n; k++) { /* x is downwards; the particles' load is known when the step is done */
    const double a = (mass * 9.81 - 500 * v - 5000 * x - 100 - get(&m, "box.force.z")) / mass;
    set(&m, "box.position.z", -x);
    set(&m, "box.velocity.z", -v);
    set(&m, "box.acceleration.z", -a);
    step(&m, h);
    const double f = -get(&m, "box.force.z");
    for (int j = 0; j < 10; j++) { /* implicit midpoint */
      const double d = h / 10, force = f + mass * 9.81 - 100;
      const double vm = (v + d / 2 / mass * (force - 5000 * x)) / (1 + d / 2 / mass * (500 + 5000 * d / 2));
      x += d * vm;
      v = 2 * vm - v;
    }
    double exact[2];
    scn_spring_damper_exact(&theory, (k + 1) * h, &exact[0], &exact[1]);
    for (int c = 0; c < 2; c++) {
      sum[c] += exact[c];
      square[c] += exact[c] * exact[c];
      off[c] += pow((c == 0 ? x : v) - exact[c], 2);
    }
  }
  for (int c = 0; c < 2; c++) {
    const double nse = 1 - off[c] / (square[c] - sum[c] * sum[c] / n);
    ck_assert_msg(nse >= 0.999, "nse of %s: %.6f", c == 0 ? "x" : "v", nse);
  }
  close_fmu(&m);
  teardown();
}
END_TEST

/* ---- mbd ---- */

/* The body of spring_damper as one of tandem-fmu, by the names that export gives to its variables. clang-format off,
 * which would tear the strings. */
/* clang-format off */
#define VECTOR(name) "\"" name "\": [\"box." name ".x\", \"box." name ".y\", \"box." name ".z\"]"
#define QUATERNION "\"orientation\": {\"quaternion\": [\"box.orientation.w\", \"box.orientation.x\", " \
                   "\"box.orientation.y\", \"box.orientation.z\"]}"
#define BOX_AS_FMU \
  "'mbd={\"bodies\": [{\"name\": \"box\", \"mass\": 100, \"inertia\": [21.7, 21.7, 10.7], " \
  "\"inputs\": {" VECTOR("force") ", " VECTOR("moment") "}, " \
  "\"outputs\": {" VECTOR("position") ", " QUATERNION ", " VECTOR("velocity") ", " VECTOR("angular_velocity") ", " \
                  VECTOR("acceleration") ", " VECTOR("angular_acceleration") "}}]}'"
/* clang-format on */

/* nse of columns z and vz of body_box.csv against the closed form. */
static void judge_box(double nse[2]) {
  const scn_spring_damper_parameters theory = {
      .mass = 361.8, .damping = 500, .stiffness = 5000, .preload = 100, .gravity = 9.81};
  double sum[2] = {0}, square[2] = {0}, off[2] = {0};
  char path[256], line[2048];
  int n = 0;
  snprintf(path, sizeof path, "%s/out/body_box.csv", dir);
  FILE *f = fopen(path, "r");
  ck_assert_ptr_nonnull(f);
  ck_assert_ptr_nonnull(fgets(line, sizeof line, f));
  for (; fgets(line, sizeof line, f); n++) {
    double t, z, vz, exact[2];
    ck_assert_int_eq(sscanf(line, "%lf,%*f,%*f,%lf,%*f,%*f,%*f,%*f,%*f,%*f,%lf", &t, &z, &vz), 3);
    scn_spring_damper_exact(&theory, t, &exact[0], &exact[1]);
    for (int k = 0; k < 2; k++) {
      sum[k] += exact[k];
      square[k] += exact[k] * exact[k];
      off[k] += pow((k == 0 ? -z : -vz) - exact[k], 2);
    }
  }
  fclose(f);
  for (int k = 0; k < 2; k++)
    nse[k] = 1 - off[k] / (square[k] - sum[k] * sum[k] / n);
}

/* The bodies of spring_damper as an FMU, in the place of tandem-mbd, in windows of 0.01 s, scheme proxy. */
START_TEST(mbd_in_tandems_own_run) {
  double nse[2];
  setup();
  ck_assert_msg(
      command("tandem export fmu " TANDEM_SOURCE_DIR "/scenarios/spring_damper/scene.json --side mbd --out %s", file) ==
          0,
      "%s", command_output);
  ck_assert_msg(command("tandem run " TANDEM_SOURCE_DIR "/scenarios/spring_damper/scene.json --out %s/out --set "
                        "time.end=1.5 --set coupling.n=100 --set 'coupling.solvers.mbd=\"tandem-fmu %s\"' --set %s",
                        dir, file, BOX_AS_FMU) == 0,
                "%s", command_output);
  judge_box(nse);
  ck_assert_msg(nse[0] >= 0.999 && nse[1] >= 0.999, "nse of x %.6f, of v %.6f", nse[0], nse[1]);
  teardown();
}
END_TEST

/* It keeps the rules of the protocol with all capabilities that an FMU can have. */
START_TEST(mbd_conforms) {
  setup();
  ck_assert_msg(command("tandem export fmu " TANDEM_SOURCE_DIR
                        "/scenarios/spring_damper/scene.json --side mbd --fmi 3 --out %s",
                        file) == 0,
                "%s", command_output);
  ck_assert_msg(command("tandem conform " TANDEM_SOURCE_DIR
                        "/scenarios/spring_damper/scene.json --set %s -- tandem-fmu "
                        "%s",
                        BOX_AS_FMU, file) == 0,
                "%s", command_output);
  expect_output("0 broken, 7 not claimed, 4 not seen");
  teardown();
}
END_TEST

/* ---- both ---- */

/* The last row of body_plate.csv: time, position, orientation, velocity. */
static void last_row(double row[11]) {
  char path[256], line[2048];
  snprintf(path, sizeof path, "%s/out/body_deck.csv", dir);
  FILE *f = fopen(path, "r");
  ck_assert_ptr_nonnull(f);
  while (fgets(line, sizeof line, f))
    ;
  fclose(f);
  char *at = line;
  for (int i = 0; i < 11; i++)
    row[i] = strtod(at + (i > 0), &at);
}

static const char *const couplings[] = {"coupling.scheme=hold", "coupling.scheme=proxy", "coupling.scheme=dem-first",
                                        "coupling.scheme=iterative"};

/* The whole co-simulation moves as in tandem run, bit for bit; in steps of several windows. */
START_TEST(both_moves_as_in_a_run) {
  char options[128];
  double row[11];
  master m;
  setup();
  snprintf(options, sizeof options, "--side both --set %s", couplings[_i]);
  pack(options);
  ck_assert_msg(command("tandem run %s/scene.json --out %s/out --set %s", dir, dir, couplings[_i]) == 0, "%s",
                command_output);
  last_row(row);
  open_fmu(&m);
  initialize(&m, 0.05);
  for (int k = 0; k < 25; k++)
    step(&m, 2e-3);
  ck_assert_double_eq(get(&m, "deck.position.z"), row[3]);
  ck_assert_double_eq(get(&m, "deck.velocity.z"), row[10]);
  ck_assert_double_gt(fabs(row[3]), 1e-4);
  close_fmu(&m);
  teardown();
}
END_TEST

/* A force from outside acts as one of the scene's own does. */
START_TEST(both_takes_loads) {
  char options[128];
  double row[11];
  master m;
  setup();
  snprintf(options, sizeof options, "--side both --set %s", couplings[_i]);
  pack(options);
  ck_assert_msg(command("tandem run %s/scene.json --out %s/out --set %s --set "
                        "'mbd.forces[1]={\"name\":\"push\",\"type\":\"wrench\",\"body\":\"deck\",\"force\":[0,0,3]}'",
                        dir, dir, couplings[_i]) == 0,
                "%s", command_output);
  last_row(row);
  open_fmu(&m);
  set(&m, "deck.force.z", 3);
  initialize(&m, 0.05);
  for (int k = 0; k < 100; k++)
    step(&m, 5e-4);
  ck_assert_double_eq_tol(get(&m, "deck.position.z"), row[3], 2e-4 * fabs(row[3]));
  ck_assert_double_eq_tol(get(&m, "deck.velocity.z"), row[10], 2e-4 * fabs(row[10]) + 1e-5);
  close_fmu(&m);
  teardown();
}
END_TEST

/* ---- instances and states ---- */

/* Two instances in a process do not know of each other, and a state that is brought back goes on as it did. */
START_TEST(instances_and_states) {
  static const char *const sides[] = {"--side dem", "--side mbd", "--side both",
                                      "--side both --set coupling.scheme=proxy"};
  const char *output = _i == 0 ? "plate-1.force.z" : "deck.velocity.z", *body = _i == 0 ? "plate-1" : "deck";
  char input[64];
  double first[3];
  void *kept = NULL;
  master a, b;
  setup();
  pack(sides[_i]);
  open_fmu(&a);
  open_fmu(&b);
  snprintf(input, sizeof input, "%s.%s.z", body, _i == 0 ? "velocity" : "force");
  set(&a, input, _i == 0 ? 0.1 : 5); /* the deck weighs 2 N */
  initialize(&a, 0.05);
  initialize(&b, 0.05);
  step(&a, 1e-3);
  ck_assert_msg(tdm_fmu_keep(a.fmu, &kept, &a.err) == TDM_OK, "%s", a.err.message);
  for (int again = 0; again < 2; again++) {
    for (int k = 0; k < 3; k++) {
      step(&a, 2e-3);
      step(&b, 1e-3);
      if (again == 0)
        first[k] = get(&a, output);
      ck_assert_double_eq(get(&a, output), first[k]);
    }
    ck_assert_msg(tdm_fmu_go_back(a.fmu, kept, &a.err) == TDM_OK, "%s", a.err.message);
    a.t = 1e-3;
  }
  ck_assert_double_ne(first[2], first[0]);
  ck_assert_double_ne(get(&b, output), first[2]);
  tdm_fmu_forget(a.fmu, &kept);
  close_fmu(&a);
  close_fmu(&b);
  teardown();
}
END_TEST

/* Accelerations follow loads before a step is made; derivatives say how. */
START_TEST(accelerations_follow_loads) {
  master m;
  setup();
  pack(_i == 0 ? "--side mbd" : "--side both --set coupling.scheme=proxy");
  open_fmu(&m);
  initialize(&m, 0.05);
  const double before = get(&m, "deck.acceleration.z");
  set(&m, "deck.force.z", 3);
  ck_assert_double_eq_tol(get(&m, "deck.acceleration.z") - before, 1.5, 1e-9); /* 3 N on 2 kg */
  double derivative[2];
  const uint32_t unknown[] = {reference_of(&m, "deck.acceleration.z"), reference_of(&m, "deck.velocity.z")};
  const uint32_t known = reference_of(&m, "deck.force.z");
  ck_assert_int_eq(tdm_fmu_derivative(m.fmu, unknown, 2, &known, 1, &(double){2}, 1, derivative, 2, &m.err), TDM_OK);
  ck_assert_double_eq_tol(derivative[0], 1, 1e-9);
  ck_assert_double_eq(derivative[1], 0);
  close_fmu(&m);
  teardown();
}
END_TEST

/* From now on lacking_mbd, which FMUs find on PATH, lacks a capability. */
static void lack(const char *capability) {
  char path[4096];
  snprintf(path, sizeof path, TANDEM_TEST_DIR ":%s", getenv("PATH"));
  ck_assert_int_eq(setenv("LACKS", capability, 1) | setenv("PATH", path, 1), 0);
}

/* Multibody solvers that tell a part of what tandem-mbd does: outputs are where the FMU says that they are. */
START_TEST(solvers_that_lack_something) {
  static const char *const lacks[] = {"acceleration", "mobility", "restore"};
  static const char *const sides[] = {"mbd", "both", "both --set coupling.scheme=hold"};
  char options[256];
  master m;
  setup();
  lack(lacks[_i % 3]);
  snprintf(options, sizeof options, "--side %s --set coupling.solvers.mbd=lacking_mbd", sides[_i / 3]);
  pack(options);
  open_fmu(&m);
  ck_assert_int_eq(m.fmu->description.keeps_states, _i % 3 != 2);
  ck_assert_int_eq(m.fmu->description.gives_derivatives, _i % 3 == 2);
  set(&m, "deck.force.z", 3);
  initialize(&m, 0.05);
  step(&m, 1e-3);
  step(&m, 1e-3);
  ck_assert_double_lt(fabs(get(&m, "deck.position.z")), 1e-5);
  ck_assert_double_eq(get(&m, "deck.orientation.w"), 1);
  ck_assert_double_gt(fabs(get(&m, "deck.velocity.z")), 1e-4);
  ck_assert_ptr_null(_i % 3 == 0 ? tdm_description_find(&m.fmu->description, "deck.acceleration.z") : NULL);
  close_fmu(&m);
  teardown();
}
END_TEST

/* What the multibody solver lacks does not matter to the particles. */
START_TEST(particles_keep_states_without_mbd) {
  master m;
  void *kept = NULL;
  setup();
  lack("restore");
  pack("--set coupling.solvers.mbd=lacking_mbd");
  open_fmu(&m);
  initialize(&m, 0.05);
  step(&m, 1e-3);
  ck_assert_msg(tdm_fmu_keep(m.fmu, &kept, &m.err) == TDM_OK, "%s", m.err.message);
  tdm_fmu_forget(m.fmu, &kept);
  close_fmu(&m);
  teardown();
}
END_TEST

#define ROWS(table) (int)(sizeof table / sizeof table[0])
TEST_MAIN_ROWS("exported", {dem_pushes_as_in_a_run, 2}, {dem_in_a_masters_mechanism, 1}, {mbd_in_tandems_own_run, 1},
               {mbd_conforms, 1}, {both_moves_as_in_a_run, SOME_ROWS(ROWS(couplings))},
               {both_takes_loads, SOME_ROWS(ROWS(couplings))}, {instances_and_states, 4},
               {accelerations_follow_loads, 2}, {solvers_that_lack_something, SOME_ROWS(9)},
               {particles_keep_states_without_mbd, 1})
