/* The schema of scenes against the readers: every key that a reader asks for is in the schema, every key of the schema
 * is asked for by a reader, and constant defaults are the same.
 *
 * The readers read all scenes of scenarios/ and tests/healthy/, and those of tests/unit/scene_keys/, in which each kind
 * of object stands once. A key of a definition that stands in several places (an orientation, a motion law) must be
 * asked for in one of them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/scheme/schemes.h"
#include "coupler/settings/settings.h"
#include "dem/app/run.h"
#include "dem/scene/scene.h"
#include "mbd/app/run.h"
#include "mbd/scene/scene.h"
#include "protocol/parameters/load.h"
#include "tests/test_main.h"

#include <ftw.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

/* ---- the schema: path of a key -> its node, and its path in the definition that it belongs to ---- */

static json_t *schema, *nodes, *places;

static void enter(json_t *node, const char *path, const char *place);

static void enter_keys(json_t *node, const char *path, const char *place) {
  const char *key;
  json_t *value;
  json_object_foreach(json_object_get(node, "properties"), key, value) {
    char below[512], there[512];
    if (json_is_false(value))
      continue;
    snprintf(below, sizeof below, "%s%s%s", path, path[0] ? "." : "", key);
    snprintf(there, sizeof there, "%s%s%s", place, place[0] ? "." : "", key);
    json_object_set(nodes, below, value);
    json_object_set_new(places, below, json_string(there));
    enter(value, below, there);
  }
}

/* Does a path lead through the same list twice? So it does in a definition that holds itself. */
static bool goes_round(const char *path) {
  const char *last = strrchr(path, '.');
  if (!last || !strstr(last, "[]"))
    return false;
  char with_dot[512];
  snprintf(with_dot, sizeof with_dot, "%s.", last);
  return strstr(path, with_dot) != NULL;
}

static void enter(json_t *node, const char *path, const char *place) {
  if (json_object_get(node, "else")) /* a section of tandem's own solver, not of another's */
    node = json_object_get(node, "else");
  const char *ref = json_string_value(json_object_get(node, "$ref"));
  if (ref && goes_round(path))
    return;
  if (ref) {
    place = strrchr(ref, '/') + 1;
    node = json_object_get(json_object_get(schema, "definitions"), place);
    ck_assert_msg(node != NULL, "%s: there is no definition %s", path, ref);
  }
  enter_keys(node, path, place);
  if (json_object_get(node, "items")) {
    char below[512], there[512];
    snprintf(below, sizeof below, "%s[]", path);
    snprintf(there, sizeof there, "%s[]", place);
    enter(json_object_get(node, "items"), below, there);
  }
  static const char *const choices[] = {"oneOf", "anyOf"};
  for (size_t k = 0; k < sizeof choices / sizeof *choices; k++) {
    size_t i;
    json_t *choice;
    if (!path[0])
      continue; /* of the whole scene: which sections go together */
    json_array_foreach(json_object_get(node, choices[k]), i, choice) {
      enter(choice, path, place);
    }
  }
}

/* once in a process, as checks may share one */
static void read_schema(void) {
  json_error_t error;
  if (schema)
    return;
  schema = json_load_file(TANDEM_SOURCE_DIR "/scenarios/scene.schema.json", JSON_REJECT_DUPLICATES, &error);
  ck_assert_msg(schema != NULL, "%d: %s", error.line, error.text);
  nodes = json_object();
  places = json_object();
  enter(schema, "", "");
}

/* ---- what readers ask for ---- */

static json_t *asked;  /* path of a key -> true */
static json_t *wanted; /* path of a key -> {default as text: default} */

/* "dem.bodies[3].shapes[0]" and "type" -> "dem.bodies[].shapes[].type" */
static void without_indices(char *out, size_t size, const char *path, const char *key) {
  size_t n = 0;
  for (const char *c = path; *c && n + 1 < size; c++) {
    out[n++] = *c;
    if (*c == '[')
      c += strspn(c + 1, "0123456789");
  }
  snprintf(out + n, size - n, "%s%s", n ? "." : "", key);
}

static void hear(void *arg, const char *path, const char *key, const json_t *fallback) {
  (void)arg;
  if (path[0] == '(')
    return; /* a single value, wrapped by its reader */
  char name[512];
  without_indices(name, sizeof name, path, key);
  json_object_set_new(asked, name, json_true());
  if (!fallback)
    return;
  if (!json_object_get(wanted, name))
    json_object_set_new(wanted, name, json_object());
  char *text = json_dumps(fallback, JSON_ENCODE_ANY);
  json_object_set(json_object_get(wanted, name), text, (json_t *)fallback);
  free(text);
}

/* ---- the readers ---- */

/* The bodies that a solver is given by the other: at the origin, of one kilogram. */
static int assign(tdm_assigned_body *bodies, int most, const json_t *root, const char *role) {
  const json_t *list = json_object_get(json_object_get(root, "coupling"), "bodies");
  int n = 0;
  for (; n < (int)json_array_size(list) && n < most; n++) {
    const json_t *entry = json_array_get(list, (size_t)n);
    bodies[n] = (tdm_assigned_body){.name = json_string_value(json_object_get(entry, role)), .mass = 1, .scale = 1};
    bodies[n].inertia = tdm_m3_identity();
    bodies[n].state.pose.orientation = tdm_quat_identity();
  }
  return n;
}

static tdm_status read_dem(const json_t *root, tdm_error *err) {
  tdm_assigned_body bodies[8];
  json_t *section = tdm_scene_section(root, "dem");
  tdm_assignment assignment = {.scene = section, .time_end = 1, .dt = 1e-6, .n = 1, .body = bodies};
  assignment.nbody = assign(bodies, 8, root, "dem");
  dem_model *model = NULL;
  tdm_status status = dem_model_read(&model, &assignment, err);
  dem_model_destroy(&model);
  json_decref(section);
  return status;
}

static tdm_status read_mbd(const json_t *root, tdm_error *err) {
  json_t *section = tdm_scene_section(root, "mbd");
  mbd_model *model = NULL;
  tdm_status status = mbd_model_read(&model, section, false, err);
  mbd_model_destroy(&model);
  json_decref(section);
  return status;
}

static tdm_status read_alone(const tdm_scene *scene, tdm_error *err) {
  if (!json_object_get(scene->root, "dem")) {
    mbd_run_settings bodies;
    return mbd_run_settings_read(&bodies, scene, err);
  }
  dem_run_settings settings;
  tdm_status status = dem_run_settings_read(&settings, scene, err);
  dem_run_settings_free(&settings);
  return status;
}

static void read_scene(const char *file) {
  tdm_scene scene = {0};
  tdm_error err = {0};
  tdm_scene_load(&scene, file, NULL, &err);
  ck_assert_msg(err.status == TDM_OK, "%s: %s", file, err.message);
  if (json_object_get(scene.root, "coupling")) {
    cpl_settings settings = {0};
    cpl_settings_read(&settings, &scene, cpl_schemes, &err);
    cpl_settings_free(&settings);
  } else
    read_alone(&scene, &err);
  if (json_object_get(scene.root, "dem") && !err.status)
    read_dem(scene.root, &err);
  if (json_object_get(scene.root, "mbd") && !err.status)
    read_mbd(scene.root, &err);
  ck_assert_msg(err.status == TDM_OK, "%s: %s: %s", file, err.path, err.message);
  tdm_scene_destroy(&scene);
}

static int visit(const char *path, const struct stat *status, int type, struct FTW *where) {
  (void)status;
  (void)where;
  size_t n = strlen(path);
  bool scene = n > 5 && strcmp(path + n - 5, ".json") == 0 && !strstr(path, "schema") && !strstr(path, "cases.json") &&
               !strstr(path + strlen(TANDEM_SOURCE_DIR), "/studies/") &&
               !strstr(path + strlen(TANDEM_SOURCE_DIR), "/families/");
  if (type == FTW_F && scene)
    read_scene(path);
  return 0;
}

static void read_scenes(void) {
  if (asked)
    return;
  asked = json_object();
  wanted = json_object();
  tdm_scene_listen(hear, NULL);
  static const char *const folders[] = {"/scenarios", "/tests/healthy/scenes", "/tests/unit/scene_keys"};
  for (size_t i = 0; i < sizeof folders / sizeof *folders; i++) {
    char path[4096];
    snprintf(path, sizeof path, "%s%s", TANDEM_SOURCE_DIR, folders[i]);
    ck_assert_int_eq(nftw(path, visit, 16, FTW_PHYS), 0);
  }
  tdm_scene_listen(NULL, NULL);
  ck_assert_uint_gt(json_object_size(asked), 200);
}

/* ---- tests ---- */

START_TEST(what_readers_ask_for_is_in_the_schema) {
  read_schema();
  read_scenes();
  int fault = 0;
  const char *key;
  json_t *value;
  json_object_foreach(asked, key, value) {
    if (json_object_get(nodes, key))
      continue;
    fprintf(stderr, "%s: read, but not in the schema\n", key);
    fault++;
  }
  ck_assert_int_eq(fault, 0);
}
END_TEST

START_TEST(what_is_in_the_schema_is_asked_for) {
  read_schema();
  read_scenes();
  json_t *heard = json_object();
  const char *key;
  json_t *place;
  json_object_foreach(places, key, place) {
    if (json_object_get(asked, key))
      json_object_set_new(heard, json_string_value(place), json_true());
  }
  int fault = 0;
  json_object_foreach(places, key, place) {
    if (json_object_get(heard, json_string_value(place)))
      continue;
    fprintf(stderr, "%s: in the schema, but no reader asks for it\n", key);
    fault++;
  }
  json_decref(heard);
  ck_assert_int_eq(fault, 0);
}
END_TEST

static bool same(const json_t *a, const json_t *b) {
  if (json_is_number(a) && json_is_number(b))
    return json_number_value(a) == json_number_value(b);
  if (json_is_array(a) && json_is_array(b) && json_array_size(a) == json_array_size(b)) {
    for (size_t i = 0; i < json_array_size(a); i++)
      if (!same(json_array_get(a, i), json_array_get(b, i)))
        return false;
    return true;
  }
  return json_equal(a, b);
}

START_TEST(defaults_are_the_readers) {
  read_schema();
  read_scenes();
  int fault = 0, compared = 0;
  const char *key, *text;
  json_t *defaults, *fallback;
  json_object_foreach(wanted, key, defaults) {
    const json_t *node = json_object_get(nodes, key), *constant = json_object_get(node, "default");
    json_object_foreach(defaults, text, fallback) {
      compared += constant != NULL;
      if (constant ? same(constant, fallback) : json_object_get(node, "x-default") != NULL)
        continue;
      fprintf(stderr, "%s: the reader's default is %s, which the schema does not say\n", key, text);
      fault++;
    }
  }
  ck_assert_int_eq(fault, 0);
  ck_assert_int_gt(compared, 60);
}
END_TEST

/* of a key, or of the definition that it refers to */
static const char *text_of(const json_t *node) {
  const char *own = json_string_value(json_object_get(node, "description"));
  const char *ref = json_string_value(json_object_get(node, "$ref"));
  return own || !ref ? own : text_of(json_object_get(json_object_get(schema, "definitions"), strrchr(ref, '/') + 1));
}

START_TEST(every_key_has_a_text) {
  read_schema();
  int fault = 0;
  const char *key;
  json_t *node;
  json_object_foreach(nodes, key, node) {
    const char *text = text_of(node);
    if (!text || !text[0]) {
      fprintf(stderr, "%s: has no text\n", key);
      fault++;
    }
  }
  ck_assert_int_eq(fault, 0);
}
END_TEST

/* May the value be a number that is no count, or an array of such? An orientation says its own units. */
static bool has_numbers(const json_t *node) {
  static const char *const choices[] = {"oneOf", "anyOf"};
  const char *ref = json_string_value(json_object_get(node, "$ref"));
  if (ref && strcmp(ref, "#/definitions/orientation") == 0)
    return false;
  if (ref)
    return has_numbers(json_object_get(json_object_get(schema, "definitions"), strrchr(ref, '/') + 1));
  const json_t *types = json_object_get(node, "type"); /* a number or an expression: ["number", "string"] */
  const char *type = json_string_value(json_is_array(types) ? json_array_get(types, 0) : types);
  if (type)
    return strcmp(type, "number") == 0 || (strcmp(type, "array") == 0 && has_numbers(json_object_get(node, "items")));
  for (size_t k = 0; k < sizeof choices / sizeof *choices; k++) {
    size_t i;
    json_t *choice;
    json_array_foreach(json_object_get(node, choices[k]), i, choice) {
      if (has_numbers(choice))
        return true;
    }
  }
  return false;
}

START_TEST(every_number_has_a_unit) {
  read_schema();
  int fault = 0, count = 0;
  const char *key;
  json_t *node;
  json_object_foreach(nodes, key, node) {
    if (!has_numbers(node))
      continue;
    count++;
    if (json_object_get(node, "x-unit"))
      continue;
    fprintf(stderr, "%s: a number without a unit; give \"x-unit\", which is \"1\" for ratios and directions\n", key);
    fault++;
  }
  ck_assert_int_eq(fault, 0);
  ck_assert_int_gt(count, 150);
}
END_TEST

/* Count the places of the schema that take numbers, and those that take no expression in their stead. */
static void count_numbers(const json_t *node, const char *path, int *count, int *fault) {
  const json_t *type = json_object_get(node, "type"), *constant = json_array_get(json_object_get(node, "enum"), 0);
  const char *pattern = json_string_value(json_object_get(node, "pattern")), *key;
  const char *first = json_string_value(json_is_array(type) ? json_array_get(type, 0) : type);
  const bool number = first && (strcmp(first, "number") == 0 || strcmp(first, "integer") == 0);
  const char *last = json_is_array(type) ? json_string_value(json_array_get(type, json_array_size(type) - 1)) : NULL;
  size_t i;
  json_t *value;
  *count += number;
  if ((number && !(last && strcmp(last, "string") == 0 && pattern && strcmp(pattern, "^=") == 0)) ||
      (json_is_number(constant) && !strstr(path, "anyOf"))) {
    fprintf(stderr, "%s: takes a number, but no expression\n", path);
    ++*fault;
  }
  json_object_foreach((json_t *)node, key, value) {
    char below[1024];
    snprintf(below, sizeof below, "%s.%s", path, key);
    count_numbers(value, below, count, fault);
  }
  json_array_foreach(node, i, value) {
    count_numbers(value, path, count, fault);
  }
}

START_TEST(every_number_may_be_an_expression) {
  read_schema();
  int count = 0, fault = 0;
  count_numbers(schema, "", &count, &fault);
  ck_assert_int_eq(fault, 0);
  ck_assert_int_gt(count, 50);
}
END_TEST

TEST_MAIN("scene_schema", every_number_may_be_an_expression, what_readers_ask_for_is_in_the_schema,
          what_is_in_the_schema_is_asked_for, defaults_are_the_readers, every_key_has_a_text, every_number_has_a_unit)
