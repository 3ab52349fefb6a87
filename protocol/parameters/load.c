/* A scene as programs get it: see load.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/parameters/load.h"

#include "protocol/base/memory.h"
#include "protocol/parameters/expression.h"
#include "protocol/parameters/parameters.h"
#include "protocol/scene/remark.h"

#include <stdio.h>
#include <string.h>

/* keys of the root that hold no numbers */
static const char *const texts[] = {"$schema", "title", "scenario"};

static bool is_text(const char *key) {
  for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
    if (strcmp(texts[i], key) == 0)
      return true;
  return false;
}

/* ---- a way through the scene ---- */

typedef struct {
  char path[TDM_PATH_MAX];
  size_t length;
  tdm_parameters *parameters;
  json_t *kept; /* path of a list that lost entries -> the indices of those that are left */
  tdm_error *err;
} walk;

/* Go to a key or, with key NULL, to an entry; what is too long is cut. Returns the way back. */
static size_t step_to(walk *w, const char *key, size_t index) {
  const size_t back = w->length, room = sizeof w->path - back;
  const int n = key ? snprintf(w->path + back, room, "%s%s", back ? "." : "", key)
                    : snprintf(w->path + back, room, "[%zu]", index);
  w->length = back + ((size_t)n < room ? (size_t)n : room - 1);
  return back;
}

static void step_back(walk *w, size_t back) {
  w->length = back;
  w->path[back] = 0;
}

/* ---- does a scene use any of it? ---- */

static bool uses(walk *w, const json_t *json, bool in_list) {
  bool found = tdm_expression(json) != NULL;
  const char *key;
  size_t i;
  json_t *value;
  if (json_is_object(json)) {
    if (in_list) {
      tdm_object o = tdm_object_open((json_t *)json, w->path, w->err);
      found = tdm_has(&o, "if");
    }
    json_object_foreach((json_t *)json, key, value) {
      const size_t back = step_to(w, key, 0);
      found = uses(w, value, false) || found;
      step_back(w, back);
    }
  }
  json_array_foreach((json_t *)json, i, value) {
    const bool deep = json_is_object(value) || json_is_array(value);
    const size_t back = deep ? step_to(w, NULL, i) : w->length;
    found = uses(w, value, true) || found;
    step_back(w, back);
  }
  return found;
}

static bool scene_uses(walk *w, const json_t *root) {
  bool found = json_object_get(root, "parameters") != NULL;
  const char *key;
  json_t *value;
  json_object_foreach((json_t *)root, key, value) {
    const size_t back = step_to(w, key, 0);
    found = (!is_text(key) && uses(w, value, false)) || found;
    step_back(w, back);
  }
  return found;
}

/* ---- putting them in ---- */

static json_t *resolved(walk *w, json_t *json);

/* Whether an entry of a list is wanted: what its "if" says. */
static bool wanted(walk *w, const json_t *entry) {
  const json_t *condition = json_object_get(entry, "if");
  const char *text = tdm_expression(condition);
  if (!condition)
    return true;
  const size_t back = step_to(w, "if", 0);
  bool yes = json_is_true(condition) || (json_is_number(condition) && json_number_value(condition) != 0);
  if (text)
    yes = tdm_parameters_evaluate(w->parameters, text, w->path, w->err) != 0;
  else if (!json_is_number(condition) && !json_is_boolean(condition))
    tdm_fail(w->err, TDM_ERR_SCENE, w->path, "must be a number, true, false, or an expression \"=…\"%s",
             json_is_string(condition) ? "; put = before it" : "");
  step_back(w, back);
  return yes;
}

static json_t *resolved_object(walk *w, json_t *json, bool in_list) {
  json_t *made = json_object();
  const char *key;
  json_t *value;
  json_object_foreach(json, key, value) {
    if (in_list && strcmp(key, "if") == 0)
      continue;
    const size_t back = step_to(w, key, 0);
    json_object_set_new(made, key, resolved(w, value));
    step_back(w, back);
  }
  return made;
}

static json_t *resolved_list(walk *w, json_t *json) {
  json_t *made = json_array(), *left = json_array();
  size_t i;
  json_t *value;
  json_array_foreach(json, i, value) {
    const size_t back = step_to(w, NULL, i);
    const bool object = json_is_object(value);
    if (!object || wanted(w, value)) {
      json_array_append_new(made, object ? resolved_object(w, value, true) : resolved(w, value));
      json_array_append_new(left, json_integer((json_int_t)i));
    }
    step_back(w, back);
  }
  if (json_array_size(made) < json_array_size(json))
    json_object_set(w->kept, w->path, left);
  json_decref(left);
  return made;
}

/* The value at w->path with numbers for expressions (new reference); after the first error nothing is computed. */
static json_t *resolved(walk *w, json_t *json) {
  const char *text = tdm_expression(json);
  if (w->err->status != TDM_OK)
    return json_incref(json);
  if (text)
    return tdm_value_to_json(tdm_parameters_evaluate(w->parameters, text, w->path, w->err));
  if (json_is_object(json))
    return resolved_object(w, json, false);
  return json_is_array(json) ? resolved_list(w, json) : json_incref(json);
}

static json_t *resolved_scene(walk *w, json_t *root) {
  json_t *made = json_object();
  const char *key;
  json_t *value;
  json_object_foreach(root, key, value) {
    const size_t back = step_to(w, key, 0);
    if (is_text(key))
      json_object_set(made, key, value);
    else if (strcmp(key, "parameters") == 0)
      json_object_set_new(made, key, tdm_parameters_values(w->parameters));
    else
      json_object_set_new(made, key, resolved(w, value));
    step_back(w, back);
  }
  return made;
}

/* The scene is `root` (stolen), and what it was is how it was written. */
static void take(tdm_scene *scene, json_t *root, json_t *kept) {
  scene->written = scene->root;
  scene->root = root;
  scene->kept = json_object_size(kept) > 0 ? json_incref(kept) : NULL;
}

static tdm_status resolve(tdm_scene *scene, tdm_error *err) {
  walk w = {.err = err, .kept = json_object()};
  if (!scene_uses(&w, scene->root))
    take(scene, json_incref(scene->root), NULL);
  else if (tdm_parameters_read(&w.parameters, json_object_get(scene->root, "parameters"), err) == TDM_OK) {
    json_t *root = resolved_scene(&w, scene->root);
    if (err->status == TDM_OK)
      take(scene, root, w.kept);
    else
      json_decref(root);
  }
  tdm_parameters_destroy(&w.parameters);
  json_decref(w.kept);
  return err->status;
}

tdm_status tdm_scene_resolve(tdm_scene *scene, tdm_error *err) {
  const unsigned long before = tdm_memory_notes();
  if (scene->written)
    return TDM_OK; /* it is */
  resolve(scene, err);
  return tdm_memory_since(before, NULL, err);
}

tdm_status tdm_scene_load(tdm_scene *scene, const char *file, const char *const *set, tdm_error *err) {
  if (tdm_scene_read(scene, file, err) != TDM_OK)
    return err->status;
  for (; set && *set; set++)
    if (tdm_scene_set(scene, *set, err) != TDM_OK)
      return err->status;
  return tdm_scene_resolve(scene, err);
}

json_t *tdm_scene_as_run(json_t *written) {
  tdm_scene scene = {.root = written};
  tdm_error err = {0};
  if (json_is_object(written))
    tdm_scene_resolve(&scene, &err);
  json_t *root = json_incref(scene.root);
  tdm_scene_destroy(&scene);
  return root;
}

/* ---- what there is to say of them ---- */

const json_t *tdm_scene_parameters(const tdm_scene *scene) {
  return json_object_get(scene->root, "parameters");
}

/* Take the names that expressions use from `unused`. */
static void take_used(json_t *unused, const json_t *json) {
  const char *text = tdm_expression(json), *key;
  size_t i;
  json_t *value;
  tdm_name name;
  for (const char *at = text ? text + 1 : ""; tdm_expression_next_name(at, &name); at = name.at + strlen(name.text))
    json_object_del(unused, name.text);
  json_object_foreach((json_t *)json, key, value) take_used(unused, value);
  json_array_foreach((json_t *)json, i, value) take_used(unused, value);
}

void tdm_scene_remark_unused(const tdm_scene *scene) {
  char names[300] = "", path[TDM_PATH_MAX] = "";
  const char *name;
  json_t *value, *unused = json_copy((json_t *)json_object_get(scene->written, "parameters"));
  const size_t count = json_object_size(unused);
  if (count > 0)
    take_used(unused, scene->written);
  json_object_foreach(unused, name, value) {
    if (!path[0])
      snprintf(path, sizeof path, "parameters.%s", name);
    if (strlen(names) + strlen(name) + 8 < sizeof names)
      snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", *names ? ", " : "", name);
  }
  if (*path)
    tdm_remark(TDM_NOTICE, "unused_parameters", path, 0,
               "no expression uses %s of the %zu parameters; remove what is not needed, or look for a slip", names,
               count);
  json_decref(unused);
}

void tdm_scene_print_parameters(const tdm_scene *scene) {
  const json_t *values = tdm_scene_parameters(scene);
  const char *name;
  json_t *value;
  if (json_object_size(values) > 0)
    printf("parameters\n");
  json_object_foreach((json_t *)values, name, value) {
    const char *text = tdm_expression(json_object_get(json_object_get(scene->written, "parameters"), name));
    printf("  %-28s %.12g%s%.200s\n", name, json_number_value(value), text ? " " : "", text ? text : "");
  }
}
