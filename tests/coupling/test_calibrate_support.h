/* Support for the tests of tandem calibrate: its results. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_CALIBRATE_SUPPORT_H
#define TEST_CALIBRATE_SUPPORT_H

#include "tests/command.h"

#include <math.h>

static const char *dir; /* of the test */

static inline json_t *load(const char *name) {
  char file[512];
  snprintf(file, sizeof file, "%s/%s", dir, name);
  json_t *json = json_load_file(file, 0, NULL);
  ck_assert_msg(json != NULL, "no %s; output:\n%s", file, command_output);
  return json;
}

static inline bool has(const char *name) {
  char file[512];
  snprintf(file, sizeof file, "%s/%s", dir, name);
  return access(file, R_OK) == 0;
}

static inline double number(const json_t *json, const char *key) {
  const json_t *value = json_object_get(json, key);
  ck_assert_msg(value != NULL, "no %s", key);
  return json_is_number(value) ? json_number_value(value) : NAN;
}

static inline const char *text(const json_t *json, const char *key) {
  const char *value = json_string_value(json_object_get(json, key));
  ck_assert_msg(value != NULL, "no %s", key);
  return value;
}

static inline const json_t *parameter(const json_t *json, size_t k) {
  return json_array_get(json_object_get(json, "parameters"), k);
}

/* It ended like this. */
static inline void expect_status(const json_t *json, const char *status) {
  ck_assert_msg(strcmp(text(json, "status"), status) == 0, "%s, not %s:\n%s", text(json, "status"), status,
                command_output);
}

#endif
