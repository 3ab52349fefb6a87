/* Machines and beds in order, and a sabotaged twin of each (cases.json): a run in order says nothing and ends where
 * it should; its twin is refused, stopped or warned of, in words that name the cause.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/results/table.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <jansson.h>
#include <math.h>

static json_t *cases;
static const char *dir;

static const char *text(const json_t *json, const char *key) {
  const char *value = json_string_value(json_object_get(json, key));
  ck_assert_msg(value != NULL, "no \"%s\" in a case", key);
  return value;
}

/* Run the scene of a case with the overrides `set` (may be NULL), its results in dir/out. Returns the exit status. */
static int run(const json_t *c, const json_t *set) {
  char line[4096];
  const char *program = text(c, "program"), *plots = strcmp(program, "tandem") == 0 ? "" : " --no-plots";
  int n = snprintf(line, sizeof line, "%s run %s/tests/healthy/scenes/%s.json --out %s/out%s", program,
                   TANDEM_SOURCE_DIR, text(c, "name"), dir, plots);
  size_t i;
  json_t *one;
  json_array_foreach(set, i, one) n +=
      snprintf(line + n, sizeof line - (size_t)n, " --set '%s'", json_string_value(one));
  ck_assert_int_lt(n, (int)sizeof line);
  return command("%s", line);
}

static json_t *summary(void) {
  char path[512];
  json_error_t error;
  snprintf(path, sizeof path, "%s/out/summary.json", dir);
  json_t *json = json_load_file(path, 0, &error);
  ck_assert_msg(json != NULL, "%s: %s", path, error.text);
  return json;
}

/* The last row of a result file lies in the ranges. */
static void check_end(const char *file, const json_t *ranges) {
  char path[512];
  cpl_table table = {0};
  tdm_error err = {0};
  const char *name;
  json_t *range;
  snprintf(path, sizeof path, "%s/out/%s", dir, file);
  ck_assert_msg(cpl_table_read(&table, path, &err) == TDM_OK, "%s", err.message);
  json_object_foreach((json_t *)ranges, name, range) {
    const double *column = cpl_table_column(&table, name, &err);
    ck_assert_msg(column != NULL, "%s", err.message);
    double low = json_number_value(json_array_get(range, 0)), high = json_number_value(json_array_get(range, 1));
    double end = column[table.nrow - 1];
    ck_assert_msg(end >= low && end <= high, "%s ends at %.9g, not within %g to %g", name, end, low, high);
  }
  cpl_table_free(&table);
}

START_TEST(in_order) {
  const json_t *c = json_array_get(cases, (size_t)_i);
  dir = directory_make();
  int status = run(c, NULL);
  ck_assert_msg(status == 0, "%s: exit status %d\n%s", text(c, "name"), status, command_output);
  static const char *const alarms[] = {"warning", "notice", "error:"};
  for (int k = 0; k < 3; k++)
    ck_assert_msg(!strstr(command_output, alarms[k]), "%s:\n%s", text(c, "name"), command_output);
  json_t *said = summary();
  ck_assert_str_eq(text(said, "status"), "TDM_OK");
  ck_assert_int_eq(json_array_size(json_object_get(said, "warnings")), 0);
  json_decref(said);
  const char *file;
  json_t *ranges;
  json_object_foreach(json_object_get(c, "ends"), file, ranges) check_end(file, ranges);
  directory_remove(dir);
}
END_TEST

START_TEST(sabotaged) {
  const json_t *c = json_array_get(cases, (size_t)_i), *twin = json_object_get(c, "twin");
  const char *warned = json_string_value(json_object_get(twin, "warned"));
  const char *words = warned ? warned : text(twin, "refused");
  dir = directory_make();
  int status = run(c, json_object_get(twin, "set"));
  ck_assert_msg(warned ? status == 0 : status == 1, "%s: exit status %d\n%s", text(c, "name"), status, command_output);
  ck_assert_msg(strstr(command_output, words) != NULL, "%s: no \"%s\" in\n%s", text(c, "name"), words, command_output);
  expect_output(warned ? ": warning: " : ": error: ");
  if (warned) {
    json_t *said = summary();
    size_t i, found = 0;
    json_t *warning;
    json_array_foreach(json_object_get(said, "warnings"), i, warning) found +=
        strstr(text(warning, "message"), words) != NULL;
    ck_assert_msg(found > 0, "%s: no \"%s\" in summary.json", text(c, "name"), words);
    json_decref(said);
  }
  directory_remove(dir);
}
END_TEST

int main(void) {
  json_error_t error;
  cases = json_load_file(TANDEM_SOURCE_DIR "/tests/healthy/cases.json", 0, &error);
  if (!json_is_array(cases)) {
    fprintf(stderr, "cases.json:%d: %s\n", error.line, error.text);
    return EXIT_FAILURE;
  }
  const int ncase = (int)json_array_size(cases);
  const test_row rows[] = {{in_order, ncase}, {sabotaged, ncase}};
  int status = test_run("healthy", rows, sizeof rows / sizeof *rows);
  json_decref(cases);
  return status;
}
