/* The schema of studies against their reader: every key that it asks for is in the schema, every key of the schema is
 * asked for, and defaults are the same. Every study of scenarios/ can be read. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/study/study.h"
#include "tests/test_main.h"

#include <ftw.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

static json_t *schema;
static json_t *nodes; /* path of a key -> its node */
static json_t *asked; /* path of a key -> its default, or null */

static json_t *definition(json_t *node) {
  const char *ref = json_string_value(json_object_get(node, "$ref"));
  return ref ? json_object_get(json_object_get(schema, "definitions"), strrchr(ref, '/') + 1) : node;
}

/* Enter the keys of an object, of the entries of an array, and of choices between them. */
static void enter(json_t *node, const char *path) {
  const char *key;
  json_t *value, *choice;
  size_t i;
  node = definition(node);
  json_object_foreach(json_object_get(node, "properties"), key, value) {
    char below[256];
    snprintf(below, sizeof below, "%s%s%s", path, path[0] ? "." : "", key);
    if (json_is_object(value)) {
      json_object_set(nodes, below, value);
      enter(value, below);
    }
  }
  if (json_is_object(json_object_get(node, "items"))) {
    char below[256];
    snprintf(below, sizeof below, "%s[]", path);
    enter(json_object_get(node, "items"), below);
  }
  json_array_foreach(json_object_get(node, "oneOf"), i, choice) {
    enter(choice, path);
  }
}

/* "measures[0]" and "path" -> "measures[].path" */
static void hear(void *arg, const char *path, const char *key, const json_t *fallback) {
  (void)arg;
  char name[512];
  size_t n = 0;
  for (const char *c = path; *c && n + 1 < sizeof name; c++) {
    name[n++] = *c;
    if (*c == '[')
      c += strspn(c + 1, "0123456789");
  }
  snprintf(name + n, sizeof name - n, "%s%s", n ? "." : "", key);
  if (fallback || !json_object_get(asked, name))
    json_object_set(asked, name, fallback ? (json_t *)fallback : json_null());
}

static int nstudy;

static void read_study(const char *file) {
  cpl_study study;
  tdm_error err = {0};
  ck_assert_msg(cpl_study_read(&study, file, &err) == TDM_OK, "%s", err.message);
  cpl_study_free(&study);
  nstudy++;
}

static int visit(const char *path, const struct stat *status, int type, struct FTW *where) {
  (void)status;
  (void)where;
  size_t n = strlen(path);
  if (type == FTW_F && strstr(path + strlen(TANDEM_SOURCE_DIR), "/studies/") && n > 5 &&
      strcmp(path + n - 5, ".json") == 0)
    read_study(path);
  return 0;
}

/* once in a process, as checks may share one */
static void begin(void) {
  json_error_t error;
  if (schema)
    return;
  schema = json_load_file(TANDEM_SOURCE_DIR "/scenarios/study.schema.json", JSON_REJECT_DUPLICATES, &error);
  ck_assert_msg(schema != NULL, "%d: %s", error.line, error.text);
  nodes = json_object();
  asked = json_object();
  enter(schema, "");
  tdm_scene_listen(hear, NULL);
  ck_assert_int_eq(nftw(TANDEM_SOURCE_DIR "/scenarios", visit, 16, FTW_PHYS), 0);
  read_study(TANDEM_SOURCE_DIR "/tests/unit/study_keys.json");
  tdm_scene_listen(NULL, NULL);
}

START_TEST(keys_are_the_readers) {
  int fault = 0;
  const char *key;
  json_t *value;
  begin();
  json_object_foreach(asked, key, value) {
    if (json_object_get(nodes, key))
      continue;
    fprintf(stderr, "%s: read, but not in the schema\n", key);
    fault++;
  }
  json_object_foreach(nodes, key, value) {
    const char *text = json_string_value(json_object_get(value, "description"));
    if (!text)
      text = json_string_value(json_object_get(definition(value), "description"));
    if (json_object_get(asked, key) && text && text[0])
      continue;
    fprintf(stderr, "%s: in the schema, but no reader asks for it, or without a text\n", key);
    fault++;
  }
  ck_assert_int_eq(fault, 0);
  ck_assert_uint_gt(json_object_size(asked), 30);
}
END_TEST

START_TEST(defaults_are_the_readers) {
  int fault = 0;
  const char *key;
  json_t *value;
  begin();
  json_object_foreach(asked, key, value) {
    const json_t *node = json_object_get(nodes, key), *constant = json_object_get(node, "default");
    const bool in_words =
        json_object_get(node, "x-default") || json_object_get(definition((json_t *)node), "x-default");
    if (!constant)
      constant = json_object_get(definition((json_t *)node), "default");
    if (json_is_null(value) || in_words || strcmp(key, "$schema") == 0)
      continue;
    const bool same =
        json_is_number(value) ? json_number_value(value) == json_number_value(constant) : json_equal(value, constant);
    if (same)
      continue;
    fprintf(stderr, "%s: the reader's default is another one than the schema's\n", key);
    fault++;
  }
  ck_assert_int_eq(fault, 0);
}
END_TEST

TEST_MAIN("study_schema", keys_are_the_readers, defaults_are_the_readers)
