/* What output.pictures may be, and what its errors say. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/draw/settings.h"
#include "tests/scene_json.h"
#include "tests/test_main.h"

#include <string.h>

/* Read output.pictures, single quotes for double ones, of a run that ends after 1 s. */
static json_t *read_pictures(tdm_pictures *all, const char *text, tdm_error *err) {
  json_t *json = scene_json("{'pictures': %s}", text);
  tdm_object output = tdm_object_open(json, "output", err);
  tdm_pictures_read(all, &output, 1.0);
  tdm_object_close(&output);
  return json;
}

START_TEST(what_pictures_may_be) {
  static const struct {
    const char *text;
    int count, ntime, late;
    bool flat;
  } rows[] = {
      {"{'times': [0, 0.5, 2]}", 1, 2, 1, true},
      {"{'interval': 0.1, 'view': 'space'}", 1, 11, 0, false},
      {"{'times': [0], 'view': {}}", 1, 1, 0, false},
      {"{'times': [0], 'view': {'from': [1, 0, 0], 'at': [0, 0, 0], 'up': [0, 1, 0], 'angle': 40}}", 1, 1, 0, false},
      {"{'times': [0], 'view': {'parallel': 2}, 'walls': 'hidden', 'size': [640, 480]}", 1, 1, 0, false},
      {"{'times': [0], 'view': {}, 'cut': {'point': [0, 1, 0], 'normal': [0, -2, 0]}}", 1, 1, 0, false},
      {"[{'times': [0, 1]}, {'name': 'top', 'times': [0, 1], 'view': 'xy', 'min': [0, 0], 'max': [1, 2]}]", 2, 2, 0,
       true}};
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    tdm_pictures all;
    tdm_error err = {0};
    json_t *json = read_pictures(&all, rows[i].text, &err);
    ck_assert_msg(err.status == TDM_OK, "%s: %s", rows[i].text, err.message);
    ck_assert_int_eq(all.count, rows[i].count);
    for (int k = 0; k < all.count; k++) {
      ck_assert_int_eq(all.picture[k].ntime, rows[i].ntime);
      ck_assert_int_eq(all.picture[k].late, rows[i].late);
      ck_assert(all.picture[k].view.flat == rows[i].flat);
      ck_assert(all.picture[k].mechanism);
    }
    tdm_pictures_free(&all);
    json_decref(json);
  }
}
END_TEST

START_TEST(files_have_names) {
  tdm_pictures all;
  tdm_error err = {0};
  char name[128];
  json_t *json = read_pictures(&all, "[{'times': [0]}, {'times': [0], 'name': 'top'}]", &err);
  ck_assert_str_eq(tdm_picture_prefix(&all.picture[0], name, sizeof name), "picture");
  ck_assert_str_eq(tdm_picture_row_name(&all.picture[0], name, sizeof name), "pictures.png");
  ck_assert_str_eq(tdm_picture_prefix(&all.picture[1], name, sizeof name), "picture_top");
  ck_assert_str_eq(tdm_picture_row_name(&all.picture[1], name, sizeof name), "pictures_top.png");
  tdm_pictures_free(&all);
  json_decref(json);
}
END_TEST

START_TEST(what_is_wrong_is_named) {
  static const struct {
    const char *text, *path, *words;
  } rows[] = {
      {"{'view': 'xz'}", "output.pictures.times", "missing"},
      {"{'times': [0], 'interval': 1}", "output.pictures.interval", "one of the two"},
      {"{'interval': 1e-9}", "output.pictures.interval", "give at least 1.00001e-05 s"},
      {"{'times': [0], 'view': 'upwards'}", "output.pictures.view", "\"space\""},
      {"{'times': [0], 'view': {'from': [1, 2, 3], 'at': [1, 2, 3]}}", "output.pictures.view.at", "away from the eye"},
      {"{'times': [0], 'view': {'from': [0, 0, 1], 'at': [0, 0, 0], 'up': [0, 0, 1]}}", "output.pictures.view.up",
       "across it"},
      {"{'times': [0], 'view': {'up': [0, 0, 0]}}", "output.pictures.view.up", "no length"},
      {"{'times': [0], 'view': {'angle': 170}}", "output.pictures.view.angle", "at most 150"},
      {"{'times': [0], 'view': {'angle': 30, 'parallel': 1}}", "output.pictures.view.parallel", "without it"},
      {"{'times': [0], 'view': {'parallel': 0}}", "output.pictures.view.parallel", "greater than 0"},
      {"{'times': [0], 'view': {'form': [0, 0, 1]}}", "output.pictures.view.form", "did you mean \"from\""},
      {"{'times': [0], 'view': 'space', 'min': [0, 0], 'max': [1, 1]}", "output.pictures.min", "flat views"},
      {"{'times': [0], 'color': 'size'}", "output.pictures.color", "size_class"},
      {"{'times': [0], 'color_range': [2, 1]}", "output.pictures.color_range", "smallest, largest"},
      {"{'times': [0], 'walls': 'glass'}", "output.pictures.walls", "translucent"},
      {"{'times': [0], 'size': [10, 10]}", "output.pictures.size", "from 64 to"},
      {"{'times': [0], 'cut': {'point': [0, 0, 0]}}", "output.pictures.cut.normal", "missing"},
      {"{'times': [0], 'cut': {'normal': [0, 0, 0]}}", "output.pictures.cut.normal", "no length"},
      {"{'times': [0], 'name': '../x'}", "output.pictures.name", "letters"},
      {"[]", "output.pictures", "1 to 16"},
      {"[{'times': [0]}, {'times': [0]}]", "output.pictures[1].name", "pictures[0]"},
      {"[{'times': [0]}, {'times': [0], 'name': 'a', 'colour': 'id'}]", "output.pictures[1].colour", "\"color\""},
  };
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    tdm_pictures all;
    tdm_error err = {0};
    json_t *json = read_pictures(&all, rows[i].text, &err);
    ck_assert_msg(err.status == TDM_ERR_SCENE, "%s", rows[i].text);
    ck_assert_str_eq(err.path, rows[i].path);
    ck_assert_msg(strstr(err.message, rows[i].words) != NULL, "%s: %s", rows[i].text, err.message);
    tdm_pictures_free(&all);
    json_decref(json);
  }
}
END_TEST

TEST_MAIN("draw_settings", what_pictures_may_be, files_have_names, what_is_wrong_is_named)
