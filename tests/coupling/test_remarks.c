/* What a run should tell its user reaches the terminal, summary.json and the report, from all three programs. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/adapter/solver.h"
#include "protocol/results/results.h"
#include "protocol/scene/remark.h"
#include "tests/command.h"
#include "tests/protocol/wire.h"

static const char *dir;

/* ---- the table ---- */

START_TEST(the_first_is_kept_and_all_are_counted) {
  static tdm_remarks table, saved;
  tdm_remarks_open(&table);
  for (int k = 1; k <= 12; k++)
    tdm_remark(TDM_WARNING, "deep", "dem.particles[0]", 0.1 * k, "particle %d is deep", k);
  tdm_remarks_copy(&saved, &table);
  tdm_remark(TDM_NOTICE, "late", NULL, 3, "late");
  ck_assert_int_eq(table.count, 2);
  ck_assert_uint_eq(table.entry[0].count, 12);
  ck_assert_str_eq(table.entry[0].message, "particle 1 is deep");
  ck_assert_double_eq(table.entry[0].first, 0.1);
  ck_assert_double_eq_tol(table.entry[0].last, 1.2, 1e-15);
  uint64_t changes = table.changes;
  tdm_remarks_copy(&table, &saved); /* a window is tried again */
  ck_assert_int_eq(table.count, 1);
  ck_assert_uint_gt(table.changes, changes);
  for (int k = 0; k < 2 * TDM_REMARKS_MAX; k++) { /* too many kinds: the last entry stands for the rest */
    char event[32];
    snprintf(event, sizeof event, "kind%d", k);
    tdm_remark(TDM_NOTICE, event, NULL, 0, "kind %d", k);
  }
  ck_assert_int_eq(table.count, TDM_REMARKS_MAX);
  ck_assert_str_eq(table.entry[TDM_REMARKS_MAX - 1].event, "further");
  ck_assert_uint_eq(table.entry[TDM_REMARKS_MAX - 1].count, TDM_REMARKS_MAX + 2);
  tdm_remarks_open(NULL);
}
END_TEST

START_TEST(from_elsewhere_nothing_steers_the_terminal) {
  tdm_error err = {0};
  json_t *foreign = json_pack("[{s:s, s:s, s:s, s:s, s:i, s:f, s:n}]", "event", "e\x1b[2J", "level", "warning", "path",
                              "a", "message", "one\ntwo\x1b[31m", "count", 3, "first_s", 0.5, "last_s");
  json_t *read = tdm_remarks_from_json(foreign, "dem", &err);
  json_t *summary = json_object();
  ck_assert_msg(read != NULL, "%s", err.message);
  tdm_remarks_enter(summary, read, NULL);
  ck_assert_uint_eq(json_array_size(json_object_get(summary, "notices")), 0);
  json_t *entry = json_array_get(json_object_get(summary, "warnings"), 0);
  ck_assert_str_eq(json_string_value(json_object_get(entry, "message")), "one two [31m");
  ck_assert_str_eq(json_string_value(json_object_get(entry, "event")), "e [2J");
  ck_assert_str_eq(json_string_value(json_object_get(entry, "from")), "dem");
  ck_assert(json_is_null(json_object_get(entry, "last_s")));
  json_decref(summary);
  json_decref(read);
  json_object_set_new(json_array_get(foreign, 0), "count", json_integer(0));
  ck_assert_ptr_null(tdm_remarks_from_json(foreign, "dem", &err));
  ck_assert_int_eq(err.status, TDM_ERR_PROTOCOL);
  json_decref(foreign);
}
END_TEST

/* ---- on the wire ---- */

/* two grains that fall on a floor */
static const char falling[] =
    "{\"materials\": [{\"name\": \"a\", \"density\": 1000, \"young_modulus\": 1e7, \"poisson_ratio\": 0.25}], "
    "\"pairs\": [{\"materials\": [\"a\", \"a\"], \"restitution\": 0.5, \"friction\": 0.4}], \"bodies\": "
    "[{\"name\": \"floor\", \"material\": \"a\", \"shapes\": [{\"type\": \"plane\", \"normal\": [0, 0, 1]}]}], "
    "\"particles\": [{\"type\": \"list\", \"material\": \"a\", \"radius\": 0.01, \"positions\": [[0, 0, 0.02], "
    "[0.1, 0, 0.02]]}], \"settle\": {}}";

/* messages REMARKS that say how the settling goes, until the solver is READY */
static int count_progress(bool asked) {
  wire w;
  int told = 0;
  open_wire(&w, &dem_solver_ops, "inproc://test_remarks", "restore");
  json_t *assign = json_pack("{s:o, s:f, s:f, s:i, s:f, s:[], s:b}", "scene", json_loads(falling, 0, NULL), "end", 1.0,
                             "dt", 1e-4, "n", 1, "timeout", 5.0, "bodies", "remarks", (int)asked);
  ck_assert_int_eq(tdm_control_write(&w.out, TDM_ASSIGN, 0, assign, &w.err), TDM_OK);
  json_decref(assign);
  ck_assert_int_eq(tdm_transport_send(w.transport, &w.peer, &w.out, &w.err), TDM_OK);
  tdm_header header = hear(&w);
  for (; header.type == TDM_REMARKS; header = hear(&w)) {
    json_t *json;
    ck_assert_int_eq(tdm_control_read(&header, &json, &w.err), TDM_OK);
    const char *progress = json_string_value(json_object_get(json, "progress"));
    ck_assert(json_is_array(json_object_get(json, "remarks")));
    told += progress && strstr(progress, "settling: ") == progress;
    json_decref(json);
  }
  ck_assert_int_eq(header.type, TDM_READY);
  close_wire(&w, true);
  ck_assert_int_eq(w.ended, TDM_OK);
  return told;
}

START_TEST(settling_is_not_silent) {
  ck_assert_int_ge(count_progress(true), 1);
  ck_assert_int_eq(count_progress(false), 0); /* a server that does not know the message */
}
END_TEST

/* ---- whole runs ---- */

/* a plate presses a ball on the floor until it overlaps by a third */
static const char press[] =
    "{\"time\": {\"end\": 0.1, \"dt\": 1e-5}, \"coupling\": {\"n\": 10, \"bodies\": [{\"mbd\": \"press\", \"dem\": "
    "\"press\"}]}, \"mbd\": {\"gravity\": [0, 0, 0], \"bodies\": [{\"name\": \"press\", \"mass\": 1, \"inertia\": "
    "[0.01, 0.01, 0.01], \"position\": [0, 0, 0.03]}], \"joints\": [{\"name\": \"rail\", \"type\": \"prismatic\", "
    "\"bodies\": [\"ground\", \"press\"], \"point\": [0, 0, 0.03], \"axis\": [0, 0, 1]}], \"drivers\": [{\"name\": "
    "\"push\", \"type\": \"linear_motor\", \"joint\": \"rail\", \"motion\": {\"type\": \"step\", \"to\": -0.0105, "
    "\"rise\": 0.1}}]}, \"dem\": {\"gravity\": [0, 0, 0], \"materials\": [{\"name\": \"grain\", \"density\": 2500, "
    "\"young_modulus\": 5e6, \"poisson_ratio\": 0.3}], \"pairs\": [{\"materials\": [\"grain\", \"grain\"], "
    "\"restitution\": 0.5, \"friction\": 0.3}], \"bodies\": [{\"name\": \"press\", \"material\": \"grain\", "
    "\"shapes\": [{\"type\": \"plane\", \"normal\": [0, 0, -1]}]}, {\"name\": \"floor\", \"material\": \"grain\", "
    "\"shapes\": [{\"type\": \"plane\", \"normal\": [0, 0, 1]}]}], \"particles\": [{\"type\": \"list\", \"material\": "
    "\"grain\", \"radius\": 0.015, \"positions\": [[0, 0, 0.015]]}]}}";

/* the entry of an event in a list of summary.json; the caller frees *summary */
static const json_t *entry_of(const char *out, const char *list, const char *event, json_t **summary) {
  char path[256];
  tdm_error err = {0};
  snprintf(path, sizeof path, "%s/%s", dir, out);
  *summary = tdm_results_read(path, "summary.json", &err);
  ck_assert_msg(*summary != NULL, "%s", err.message);
  const json_t *all = json_object_get(*summary, list);
  ck_assert(json_is_array(all));
  for (size_t i = 0; i < json_array_size(all); i++) {
    const json_t *entry = json_array_get(all, i);
    const char *name = json_string_value(json_object_get(entry, "event"));
    if (name && strcmp(name, event) == 0)
      return entry;
  }
  return NULL;
}

static long long count_of(const char *out, const char *list, const char *event) {
  json_t *summary;
  long long count = json_integer_value(json_object_get(entry_of(out, list, event, &summary), "count"));
  json_decref(summary);
  return count;
}

static int run(const char *program, const char *out, const char *options) {
  return command("%s run %s/scene.json --out %s/%s %s", program, dir, dir, out, options);
}

START_TEST(what_the_solver_warns_of_is_told) {
  json_t *summary;
  dir = directory_make();
  write_file(dir, "scene.json", press);
  ck_assert_msg(run("tandem", "out", "") == 0, "%s", command_output);
  expect_output("tandem: warning: dem: ");
  expect_output("dem.particles[0]: particle 0 (id 0)");
  expect_output("t = 0.072 s");
  expect_output("dem: guard.overlap: 29 times, from t = 0.072 s to 0.1 s");
  const json_t *entry = entry_of("out", "warnings", "guard.overlap", &summary);
  ck_assert_int_eq(json_integer_value(json_object_get(entry, "count")), 29);
  ck_assert_double_eq_tol(json_number_value(json_object_get(entry, "first_s")), 0.072, 1e-12);
  ck_assert_str_eq(json_string_value(json_object_get(entry, "path")), "dem.particles[0]");
  json_decref(summary);
  ck_assert_int_eq(command("tandem report %s/out", dir), 0);
  expect_output("(29 times, from t = 0.072 s to 0.1 s)");
  ck_assert_int_eq(command("grep -c 'overlaps a wall of' %s/out/index.html", dir), 0);
  /* windows that are tried several times count once */
  ck_assert_msg(run("tandem", "again", "--set coupling.scheme=iterative") == 0, "%s", command_output);
  ck_assert_int_eq(count_of("again", "warnings", "guard.overlap"), 29);
  ck_assert_msg(run("tandem", "calm", "--set mbd.drivers[0].motion.to=0.001") == 0, "%s", command_output);
  ck_assert_ptr_null(strstr(command_output, "warning"));
  ck_assert_int_eq(count_of("calm", "warnings", "guard.overlap"), 0);
  directory_remove(dir);
}
END_TEST

/* a source whose particles stay where they come */
static const char choked[] =
    "{\"time\": {\"end\": 0.05, \"dt\": 1e-4}, \"dem\": {\"gravity\": [0, 0, 0], \"materials\": [{\"name\": \"m\", "
    "\"density\": 1000, \"young_modulus\": 1e7, \"poisson_ratio\": 0.3}], \"pairs\": [{\"materials\": [\"m\", \"m\"], "
    "\"restitution\": 0.8, \"friction\": 0.4}], \"sources\": [{\"name\": \"inlet\", \"material\": \"m\", \"radius\": "
    "0.01, \"rate\": 200, \"position\": [0, 0, 0]}]}}";

START_TEST(particles_alone_say_who_waits) {
  json_t *summary;
  dir = directory_make();
  write_file(dir, "scene.json", choked);
  ck_assert_msg(run("tandem-dem", "out", "") == 0, "%s", command_output);
  expect_output("notice: ");
  expect_output("\"inlet\" waits with particle 1 from t = 0.005 s on");
  expect_output("10 of the 11 particles that the source \"inlet\" should have made still wait at the end");
  ck_assert_int_eq(count_of("out", "notices", "source_waits.inlet"), 1);
  const json_t *entry = entry_of("out", "warnings", "source_behind.inlet", &summary);
  ck_assert_str_eq(json_string_value(json_object_get(entry, "path")), "dem.sources[0]");
  json_decref(summary);
  ck_assert_msg(run("tandem-dem", "room", "--set 'dem.sources[0].velocity=[5,0,0]'") == 0, "%s", command_output);
  ck_assert_ptr_null(strstr(command_output, "notice"));
  ck_assert_ptr_null(strstr(command_output, "warning"));
  directory_remove(dir);
}
END_TEST

/* two grains over a slab, one of them beside it */
static const char slab[] =
    "{\"time\": {\"end\": 0.3, \"dt\": 1e-4}, \"dem\": {\"materials\": [{\"name\": \"m\", \"density\": 1000, "
    "\"young_modulus\": 1e7, \"poisson_ratio\": 0.3}], \"pairs\": [{\"materials\": [\"m\", \"m\"], \"restitution\": "
    "0.2, "
    "\"friction\": 0.4}], \"bodies\": [{\"name\": \"slab\", \"material\": \"m\", \"shapes\": [{\"type\": \"box\", "
    "\"side\": "
    "\"outside\", \"size\": [0.1, 0.1, 0.1], \"center\": [0, 0, -0.05]}]}], \"particles\": [{\"type\": \"list\", "
    "\"material\": \"m\", \"radius\": 0.01, \"positions\": [[0, 0, 0.02], [0.1, 0, 0.02]]}]}}";

START_TEST(what_falls_out_of_the_scene_is_told) {
  dir = directory_make();
  write_file(dir, "scene.json", slab);
  ck_assert_msg(run("tandem-dem", "out", "") == 0, "%s", command_output);
  expect_output("1 particles fall below every wall at the end, one of them (id 1) at [0.1, 0, ");
  ck_assert_int_eq(count_of("out", "warnings", "fallen"), 1);
  /* a sink that it is on its way to, and a floor, catch it */
  static const char *const caught[] = {
      "--set 'dem.sinks=[{\"name\": \"s\", \"type\": \"box\", \"min\": [-1, -1, -2], \"max\": [1, 1, -1]}]'",
      "--set 'dem.bodies[0].shapes[1]={\"type\": \"plane\", \"point\": [0, 0, -2], \"normal\": [0, 0, 1]}'"};
  for (int k = 0; k < 2; k++) {
    ck_assert_msg(run("tandem-dem", k == 0 ? "sink" : "floor", caught[k]) == 0, "%s", command_output);
    ck_assert_int_eq(count_of(k == 0 ? "sink" : "floor", "warnings", "fallen"), 0);
  }
  directory_remove(dir);
}
END_TEST

/* Nothing went wrong: the lists are there, and empty. */
START_TEST(bodies_alone_have_both_lists) {
  json_t *summary;
  dir = directory_make();
  write_file(dir, "scene.json",
             "{\"time\": {\"end\": 0.1}, \"mbd\": {\"bodies\": [{\"name\": \"a\", \"mass\": 1, \"inertia\": [1, 1, 1], "
             "\"position\": [0, 0, 0]}]}}");
  ck_assert_msg(run("tandem-mbd", "out", "") == 0, "%s", command_output);
  ck_assert_ptr_null(entry_of("out", "notices", "integrator_failed", &summary));
  ck_assert(json_is_array(json_object_get(summary, "warnings")));
  json_decref(summary);
  directory_remove(dir);
}
END_TEST

/* ---- at the end of a run ---- */

/* What tdm_remarks_tell_end says of the table, as a text in `out` (size bytes). */
static void tell_end(tdm_teller *teller, const tdm_remarks *table, size_t doubts, char *out, size_t size) {
  FILE *file = tmpfile();
  const int before = dup(2);
  json_t *json = tdm_remarks_to_json(table, "dem");
  fflush(stderr);
  dup2(fileno(file), 2);
  tdm_remarks_tell_end(teller, json, doubts);
  fflush(stderr);
  dup2(before, 2);
  close(before);
  rewind(file);
  out[fread(out, 1, size - 1, file)] = 0;
  fclose(file);
  json_decref(json);
}

START_TEST(the_end_says_it_again) {
  static tdm_remarks table;
  static char text[8192];
  tdm_teller teller = {.program = "tandem"};
  tdm_remarks_open(&table);
  tdm_remark(TDM_WARNING, "deep", "dem.particles[0]", 0.1, "particle 1 is deep");
  tdm_remark(TDM_NOTICE, "late", NULL, 0.2, "it is late");
  json_t *early = tdm_remarks_to_json(&table, "dem");
  tdm_remarks_tell(&teller, early, NULL);
  json_decref(early);
  tdm_remark(TDM_WARNING, "wide", "", 0.3, "particle 2 is wide");
  tdm_remark(TDM_WARNING, "wide", "", 0.4, "particle 2 is wide");
  tdm_remark(TDM_WARNING, "new", "", 0.5, "particle 3 is new");
  tell_end(&teller, &table, 2, text, sizeof text);
  ck_assert_str_eq(text, "tandem: warning: dem: particle 2 is wide\n"
                         "tandem: warning: dem: particle 3 is new\n"
                         "tandem: warning: dem: deep: once, at t = 0.1 s, first at dem.particles[0]\n"
                         "tandem: warning: dem: wide: 2 times, from t = 0.3 s to 0.4 s\n"
                         "tandem: warning: 2 doubts about the scene from before the start; summary.json has them\n");
  tdm_remarks_open(NULL);
  tdm_teller_free(&teller);
}
END_TEST

/* Runs with all sorts of warnings: whatever a log warns of is in summary.json, on the terminal and on top of the
 * report. */
static const struct {
  const char *program, *scene, *options, *event;
} doubtful_runs[] = {
    {"tandem-mbd", "hoist", "--set mbd.bodies[0].velocity=[1,0,0]", "doubtful"},
    {"tandem-mbd", "door",
     "--set 'mbd.guard={\"action\":\"warn\",\"energy\":1e-5}' --set "
     "'mbd.solver={\"relative_tolerance\":1e-2,\"absolute_tolerance\":1e-2}'",
     "guard.balance"},
    {"tandem-dem", "vibrated", "--set dem.bodies[0].motion.oscillation.amplitude=[0,0,0.2]", "guard.step"},
    {"tandem-dem", "shear", "--set dem.bodies[1].motion.velocity=[4,0,0]", "fallen"},
    {"tandem-dem", "belt", "--set time.end=0.2 --set dem.sources[0].rate=5000 --set dem.sources[0].count=5000",
     "source_behind.chute"},
    {"tandem", "swing", "--set 'coupling.iterative={\"max\":1,\"tolerance\":1e-9,\"absolute\":1e-15}'",
     "not_converging"},
    {"tandem", "box_on_spring",
     "--set 'coupling.scheme=\"lommen\"' --set coupling.n=1000 --set mbd.bodies[0].mass=0.1 --set "
     "'coupling.guard={\"action\":\"warn\"}'",
     "guard.lost"},
};
enum { NDOUBTFUL = sizeof doubtful_runs / sizeof doubtful_runs[0] };

START_TEST(nothing_stays_in_the_log) {
  const char *event = doubtful_runs[_i].event;
  dir = directory_make();
  ck_assert_msg(command("%s run " TANDEM_SOURCE_DIR "/tests/healthy/scenes/%s.json --out %s/out %s > /dev/null 2> "
                        "%s/terminal",
                        doubtful_runs[_i].program, doubtful_runs[_i].scene, dir, doubtful_runs[_i].options, dir) == 0,
                "%s", doubtful_runs[_i].scene);
  write_file(dir, "script",
             "tandem report out > /dev/null && sed '/id=.run/q' out/index.html > top\n"
             "sed -n 's/.*level=warning .*event=\\([^ ]*\\) .*/\\1/p' out/*.log | sort -u > events\n"
             "for e in $(cat events); do echo \"$e\"\n"
             "  test $e = doubtful || grep -q \"\\\"event\\\": \\\"$e\\\"\" out/summary.json || exit 1\n"
             "done\n"
             /* each message's first words, as often as summary.json has it */
             "grep -o '\"message\": \"[^\"\\\\]*' out/summary.json | cut -c13-52 > messages\n"
             "while read -r m; do grep -qF \"$m\" terminal && sed 's/&gt;/>/g; s/&#39;/\"/g' top | grep -qF \"$m\" || "
             "{ echo \"untold: $m\"; exit 2; }; done < messages\n");
  const int status = command("sh -c 'cd %s && sh ./script'", dir);
  ck_assert_msg(status == 0, "%d: %s", status, command_output);
  expect_output(event);
  directory_remove(dir);
}
END_TEST

/* ---- what was told nowhere ---- */

/* A chain of 14 bodies and more freedom than a reduced model holds. */
START_TEST(too_much_freedom_is_told) {
  dir = directory_make();
  char path[512];
  snprintf(path, sizeof path, "%s/scene.json", dir);
  FILE *f = fopen(path, "w");
  fputs("{\"time\": {\"end\": 1e-3, \"dt\": 1e-4}, \"coupling\": {\"n\": 1, \"bodies\": [{\"mbd\": \"b0\", \"dem\": "
        "\"b0\"}]}, \"mbd\": {\"bodies\": [",
        f);
  for (int k = 0; k < 14; k++)
    fprintf(f, "%s{\"name\": \"b%d\", \"mass\": 1, \"inertia\": [1, 1, 1], \"position\": [%d, 0, 0]}", k ? ", " : "", k,
            k);
  fputs("], \"joints\": [", f);
  for (int k = 1; k < 14; k++)
    fprintf(f, "%s{\"name\": \"j%d\", \"type\": \"spherical\", \"bodies\": [\"b%d\", \"b%d\"], \"point\": [%d, 0, 0]}",
            k > 1 ? ", " : "", k, k - 1, k, k);
  fputs("]}, \"dem\": {\"materials\": [{\"name\": \"m\", \"density\": 1000, \"young_modulus\": 1e7, \"poisson_ratio\": "
        "0.3}], \"pairs\": [{\"materials\": [\"m\", \"m\"], \"restitution\": 0.5, \"friction\": 0.5}], \"bodies\": "
        "[{\"name\": "
        "\"b0\", \"material\": \"m\", \"shapes\": [{\"type\": \"plane\", \"normal\": [0, 0, 1], \"point\": [0, 0, "
        "-5]}]}]}}",
        f);
  fclose(f);
  ck_assert_msg(run("tandem", "out", "") == 0, "%s", command_output);
  expect_output("tandem: notice: mbd: ");
  expect_output("45 degrees of freedom, more than the 32");
  ck_assert_int_eq(count_of("out", "notices", "mobility_alone"), 1);
  directory_remove(dir);
}
END_TEST

/* Twenty bodies that move too fast: the last of the doubts says that there are more. */
START_TEST(many_doubts_are_not_dropped) {
  dir = directory_make();
  char path[512];
  snprintf(path, sizeof path, "%s/scene.json", dir);
  FILE *f = fopen(path, "w");
  fputs("{\"time\": {\"end\": 1e-3, \"dt\": 1e-4}, \"dem\": {\"materials\": [{\"name\": \"m\", \"density\": 1000, "
        "\"young_modulus\": 1e7, \"poisson_ratio\": 0.3}], \"pairs\": [{\"materials\": [\"m\", \"m\"], "
        "\"restitution\": 0.5, "
        "\"friction\": 0.5}], \"expected_speed\": 1e-3, \"particles\": [{\"type\": \"list\", \"material\": \"m\", "
        "\"radius\": 0.01, "
        "\"positions\": [[0, 0, 1]]}], \"bodies\": [",
        f);
  for (int k = 0; k < 20; k++)
    fprintf(
        f,
        "%s{\"name\": \"b%d\", \"material\": \"m\", \"motion\": {\"velocity\": [300, 0, 0]}, \"shapes\": [{\"type\": "
        "\"box\", \"side\": \"outside\", \"size\": [0.1, 0.1, 0.1], \"center\": [5, %d, 0]}]}",
        k ? ", " : "", k, k);
  fputs("]}}", f);
  fclose(f);
  ck_assert_msg(run("tandem-dem", "out", "--no-plots") == 0, "%s", command_output);
  expect_output("there are more than 15 doubts about this scene");
  directory_remove(dir);
}
END_TEST

TEST_MAIN_ROWS("remarks", {the_first_is_kept_and_all_are_counted, 1}, {from_elsewhere_nothing_steers_the_terminal, 1},
               {settling_is_not_silent, 1}, {what_the_solver_warns_of_is_told, 1}, {particles_alone_say_who_waits, 1},
               {what_falls_out_of_the_scene_is_told, 1}, {bodies_alone_have_both_lists, 1}, {the_end_says_it_again, 1},
               {nothing_stays_in_the_log, NDOUBTFUL}, {too_much_freedom_is_told, 1}, {many_doubts_are_not_dropped, 1})
