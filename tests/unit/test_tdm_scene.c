/* Scene reading: errors with path and place, overrides, nearest names. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/scene/scene.h"
#include "tests/test_main.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static char file[64];

/* Write a scene file and read it. */
static tdm_status read_text(tdm_scene *scene, const char *text, tdm_error *err) {
  strcpy(file, "/tmp/tandem-test-XXXXXX");
  int fd = mkstemp(file);
  ck_assert_int_ge(fd, 0);
  ck_assert_int_eq(write(fd, text, strlen(text)), (int)strlen(text));
  close(fd);
  tdm_status status = tdm_scene_read(scene, file, err);
  unlink(file);
  return status;
}

/* The error of loading an object with the keys name (string), size (number > 0), count (integer), point (3 numbers). */
static tdm_error load(const char *text) {
  tdm_error err = {0};
  tdm_scene scene;
  if (read_text(&scene, text, &err) == TDM_OK) {
    tdm_object o = tdm_object_open(json_object_get(scene.root, "thing"), "thing", &err);
    tdm_get_string(&o, "name", "x");
    tdm_get_number(&o, "size", TDM_REQUIRED, TDM_POSITIVE);
    tdm_get_integer(&o, "count", 1, 1);
    tdm_vec3 zero = {0, 0, 0};
    tdm_get_vec3(&o, "point", &zero);
    tdm_get_orientation(&o, "orientation");
    tdm_object_close(&o);
    tdm_scene_locate(&scene, &err);
  }
  tdm_scene_destroy(&scene);
  return err;
}

static void expect(const char *text, tdm_status status, const char *path, const char *words) {
  tdm_error err = load(text);
  ck_assert_msg(err.status == status, "%s: %s: %s", text, tdm_status_name(err.status), err.message);
  ck_assert_str_eq(err.path, path);
  ck_assert_msg(strstr(err.message, words) != NULL, "\"%s\" has no \"%s\"", err.message, words);
}

START_TEST(a_good_scene_loads) {
  tdm_error err = load("{\"thing\": {\"name\": \"a\", \"size\": 2, \"count\": 3.0, \"point\": [1, 2, 3.5]}}");
  ck_assert_msg(err.status == TDM_OK, "%s", err.message);
}
END_TEST

START_TEST(what_is_not_json) {
  expect("{\"thing\": {\"size\": 2", TDM_ERR_JSON, "", ":1:");
  expect("size = 2", TDM_ERR_JSON, "", "not valid JSON");
  expect("", TDM_ERR_JSON, "", "not valid JSON");
  expect("{\"thing\": {\"size\": NaN}}", TDM_ERR_JSON, "", "not valid JSON");
  expect("{\"thing\":\n {\"size\": 1, \"size\": 2}}", TDM_ERR_JSON, "", ":2:");
  expect("{\"thing\": {\"size\": 1e999}}", TDM_ERR_JSON, "", "not valid JSON");
  expect("[1, 2]", TDM_ERR_SCENE, "", "object");
}
END_TEST

START_TEST(a_missing_file) {
  tdm_error err = {0};
  tdm_scene scene;
  ck_assert_int_eq(tdm_scene_read(&scene, "/nowhere/scene.json", &err), TDM_ERR_FILE);
  ck_assert_ptr_nonnull(strstr(err.message, "/nowhere/scene.json"));
  tdm_scene_destroy(&scene);
}
END_TEST

START_TEST(wrong_values_name_their_place) {
  expect("{\"thing\": {}}", TDM_ERR_SCENE, "thing.size", "missing");
  expect("{\"thing\": {\"sice\": 2}}", TDM_ERR_SCENE, "thing.size", "is \"sice\" a slip of it?");
  expect("{\"thing\": 3}", TDM_ERR_SCENE, "thing", "must be an object");
  expect("{\"thing\": {\n  \"name\": \"a\",\n  \"size\": -2}}", TDM_ERR_SCENE, "thing.size", ":3:3: thing.size: is -2");
  expect("{\"thing\": {\"size\": \"2\"}}", TDM_ERR_SCENE, "thing.size", "must be a number, not a string");
  expect("{\"thing\": {\"size\": 1, \"count\": 1.5}}", TDM_ERR_SCENE, "thing.count", "whole number");
  expect("{\"thing\": {\"size\": 1, \"count\": 0}}", TDM_ERR_SCENE, "thing.count", "at least 1");
  expect("{\"thing\": {\"size\": 1, \"point\": [1, 2]}}", TDM_ERR_SCENE, "thing.point", "must have 3");
  expect("{\"thing\": {\"size\": 1, \"point\": [1, \"b\", 2]}}", TDM_ERR_SCENE, "thing.point[1]", ":1:36:");
  expect("{\"thing\": {\"size\": 1, \"orientation\": [0, 0, 0, 0]}}", TDM_ERR_SCENE, "thing.orientation", "zero");
}
END_TEST

START_TEST(unknown_keys_get_the_nearest_name) {
  expect("{\"thing\": {\"size\": 1, \"naem\": \"a\"}}", TDM_ERR_SCENE, "thing.naem", "did you mean \"name\"?");
  expect("{\"thing\": {\"size\": 1, \"zzzzzzz\": 1}}", TDM_ERR_SCENE, "thing.zzzzzzz", "known here: name, size");
}
END_TEST

START_TEST(the_first_error_sticks) {
  expect("{\"thing\": {\"size\": -1, \"count\": -1, \"foo\": 1}}", TDM_ERR_SCENE, "thing.size", "greater than 0");
}
END_TEST

START_TEST(orientation_from_euler_angles) {
  tdm_error err = {0};
  json_t *json = json_loads("{\"o\": {\"euler313\": [0.1, 0.2, 0.3]}}", 0, NULL);
  tdm_object o = tdm_object_open(json, "", &err);
  tdm_quat q = tdm_get_orientation(&o, "o"), exact = tdm_euler313_to_quat((tdm_euler313){0.1, 0.2, 0.3});
  ck_assert_int_eq(err.status, TDM_OK);
  ck_assert_double_eq(q.w, exact.w);
  ck_assert_double_eq(q.z, exact.z);
  json_decref(json);
}
END_TEST

START_TEST(places_in_the_text) {
  const char *text = "{\n \"a\": {\"b\": [10,\n   {\"c\": \"x,}]\\\"\", \"d\": 1}]},\n \"e\": 5}";
  int line, column;
  ck_assert(tdm_scene_place(text, "a.b[1].d", &line, &column));
  ck_assert_int_eq(line, 3);
  ck_assert_int_eq(column, 20);
  ck_assert(tdm_scene_place(text, "e", &line, &column));
  ck_assert_int_eq(line, 4);
  ck_assert_int_eq(column, 2);
  ck_assert(tdm_scene_place(text, "a.b[0]", &line, &column));
  ck_assert_int_eq(line, 2);
  ck_assert_int_eq(column, 14);
  /* what is not there: the nearest parent */
  ck_assert(tdm_scene_place(text, "a.b[1].missing", &line, &column));
  ck_assert_int_eq(line, 3);
  ck_assert_int_eq(column, 4);
  ck_assert(!tdm_scene_place(text, "missing", &line, &column));
  ck_assert_int_eq(line, 1);
}
END_TEST

static tdm_status set(tdm_scene *scene, const char *assignment, tdm_error *err) {
  *err = (tdm_error){0};
  return tdm_scene_set(scene, assignment, err);
}

START_TEST(overrides) {
  tdm_error err = {0};
  tdm_scene scene;
  ck_assert_int_eq(read_text(&scene, "{\"a\": {\"n\": 1, \"list\": [1, 2]}}", &err), TDM_OK);
  ck_assert_int_eq(set(&scene, "a.n=25", &err), TDM_OK);
  ck_assert_int_eq(set(&scene, "a.name=two words", &err), TDM_OK);
  ck_assert_int_eq(set(&scene, "a.list[1]=[7]", &err), TDM_OK);
  ck_assert_int_eq(set(&scene, "a.list[2]=true", &err), TDM_OK);
  ck_assert_int_eq(set(&scene, "new.deep.er=1e-3", &err), TDM_OK);
  ck_assert_int_eq(set(&scene, "quoted=\"5\"", &err), TDM_OK);
  char *text = json_dumps(scene.root, JSON_COMPACT | JSON_SORT_KEYS | JSON_REAL_PRECISION(3));
  ck_assert_str_eq(text,
                   "{\"a\":{\"list\":[1,[7],true],\"n\":25,\"name\":\"two words\"},\"new\":{\"deep\":{\"er\":0.001}},"
                   "\"quoted\":\"5\"}");
  free(text);
  ck_assert_int_eq(set(&scene, "a.n", &err), TDM_ERR_ARGUMENT);
  ck_assert_int_eq(set(&scene, "=5", &err), TDM_ERR_ARGUMENT);
  ck_assert_int_eq(set(&scene, "a..n=5", &err), TDM_ERR_ARGUMENT);
  ck_assert_int_eq(set(&scene, "a.list[9]=5", &err), TDM_ERR_ARGUMENT);
  ck_assert_int_eq(set(&scene, "a.list[x]=5", &err), TDM_ERR_ARGUMENT);
  ck_assert_int_eq(set(&scene, "a.n.m=5", &err), TDM_ERR_ARGUMENT);
  ck_assert_int_eq(set(&scene, "a[0]=5", &err), TDM_ERR_ARGUMENT);
  tdm_scene_destroy(&scene);
}
END_TEST

START_TEST(nearest_names) {
  const char *const names[] = {"restitution", "friction", NULL, "tail"};
  ck_assert_str_eq(tdm_nearest("restituton", names, 4), "restitution");
  ck_assert_str_eq(tdm_nearest("Friction", names, 4), "friction");
  ck_assert_ptr_null(tdm_nearest("mass", names, 4));
  ck_assert_ptr_null(tdm_nearest("", names, 4));
}
END_TEST

START_TEST(status_names) {
  ck_assert_str_eq(tdm_status_name(TDM_ERR_SCENE), "TDM_ERR_SCENE");
  ck_assert_str_eq(tdm_status_name((tdm_status)999), "TDM_ERR_UNKNOWN");
  ck_assert_ptr_nonnull(tdm_status_text((tdm_status)-1));
}
END_TEST

TEST_MAIN("scene", a_good_scene_loads, what_is_not_json, a_missing_file, wrong_values_name_their_place,
          unknown_keys_get_the_nearest_name, the_first_error_sticks, orientation_from_euler_angles, places_in_the_text,
          overrides, nearest_names, status_names)
