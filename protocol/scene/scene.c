/* Scene objects: reading values with their path and range. The file, its overrides and positions are in scene_file.c.
 */
/* SPDX-License-Identifier: MIT */
#include "protocol/scene/scene.h"

#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const char *type_name(const json_t *value) {
  static const char *const names[] = {"an object",     "an array", "a string", "a whole number",
                                      "a real number", "true",     "false",    "null"};
  return value ? names[json_typeof(value)] : "nothing";
}

const char *tdm_path(char *out, const tdm_object *o, const char *key, int i) {
  int n = snprintf(out, TDM_PATH_MAX, "%s%s%s", o->path, o->path[0] && key ? "." : "", key ? key : "");
  if (i >= 0 && n >= 0 && n < TDM_PATH_MAX)
    snprintf(out + n, TDM_PATH_MAX - (size_t)n, "[%d]", i);
  return out;
}

tdm_status tdm_object_fail(tdm_object *o, const char *key, const char *format, ...) {
  char path[TDM_PATH_MAX], message[TDM_MESSAGE_MAX];
  va_list args;
  va_start(args, format);
  vsnprintf(message, sizeof message, format, args);
  va_end(args);
  return tdm_fail(o->err, TDM_ERR_SCENE, tdm_path(path, o, key, -1), "%s", message);
}

tdm_object tdm_object_open(json_t *json, const char *path, tdm_error *err) {
  tdm_object o = {.json = json, .err = err};
  snprintf(o.path, sizeof o.path, "%s", path);
  if (json && !json_is_object(json)) {
    tdm_object_fail(&o, NULL, "must be an object {…}, not %s", type_name(json));
    o.json = NULL;
  }
  return o;
}

/* ---- who hears what readers ask for ---- */

static _Thread_local struct {
  tdm_key_listener *tell;
  void *arg;
} listener;

void tdm_scene_listen(tdm_key_listener *tell, void *arg) {
  listener.tell = tell;
  listener.arg = arg;
}

/* Tell of a key; the reference to its default is stolen. */
static void tell(const tdm_object *o, const char *key, json_t *fallback) {
  listener.tell(listener.arg, o->path, key, fallback);
  json_decref(fallback);
}

/* ---- values ---- */

/* the value under key, or NULL; notes that the loader knows the key */
static json_t *ask(tdm_object *o, const char *key) {
  for (int i = 0; i < o->nasked; i++)
    if (strcmp(o->asked[i], key) == 0)
      return json_object_get(o->json, key);
  assert(o->nasked < TDM_KEYS_MAX);
  o->asked[o->nasked++] = key;
  if (listener.tell)
    tell(o, key, NULL);
  return json_object_get(o->json, key);
}

void tdm_object_close(tdm_object *o) {
  const char *key;
  json_t *value;
  json_object_foreach(o->json, key, value) {
    bool known = false;
    for (int i = 0; i < o->nasked && !known; i++)
      known = strcmp(o->asked[i], key) == 0;
    if (known)
      continue;
    const char *near = tdm_nearest(key, o->asked, o->nasked);
    if (near)
      tdm_object_fail(o, key, "unknown key \"%s\"; did you mean \"%s\"?", key, near);
    else {
      char list[512] = "";
      for (int i = 0; i < o->nasked; i++)
        snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s", i ? ", " : "", o->asked[i]);
      tdm_object_fail(o, key, "unknown key \"%s\"; known here: %s", key, list[0] ? list : "none");
    }
    return;
  }
}

bool tdm_has(tdm_object *o, const char *key) {
  return ask(o, key) != NULL;
}

/* A key that must be there is not; a key that nobody has asked for may be a slip of it. */
static void missing(tdm_object *o, const char *key, const char *what) {
  const char *candidates[TDM_KEYS_MAX], *there;
  int n = 0;
  json_t *value;
  json_object_foreach(o->json, there, value) {
    bool asked = false;
    for (int i = 0; i < o->nasked && !asked; i++)
      asked = strcmp(o->asked[i], there) == 0;
    if (!asked && n < TDM_KEYS_MAX)
      candidates[n++] = there;
  }
  const char *near = tdm_nearest(key, candidates, n);
  tdm_object_fail(o, key, "missing; give %s%s%s%s", what, near ? " (is \"" : "", near ? near : "",
                  near ? "\" a slip of it?)" : "");
}

static void wrong_type(tdm_object *o, const char *key, const char *what, const json_t *value) {
  tdm_object_fail(o, key, "must be %s, not %s", what, type_name(value));
}

tdm_object tdm_get_object(tdm_object *o, const char *key, bool required) {
  json_t *value = ask(o, key);
  char path[TDM_PATH_MAX];
  if (!value && required)
    missing(o, key, "an object {…}");
  return tdm_object_open(value, tdm_path(path, o, key, -1), o->err);
}

double tdm_get_number(tdm_object *o, const char *key, double fallback, tdm_range range) {
  if (listener.tell && isfinite(fallback))
    tell(o, key, json_real(fallback));
  json_t *value = ask(o, key);
  if (!value) {
    if (isnan(fallback))
      missing(o, key, "a number");
    return isnan(fallback) ? 1 : fallback; /* 1: a harmless value for the rest of a loader that fails anyway */
  }
  if (!json_is_number(value)) {
    wrong_type(o, key, "a number", value);
    return isnan(fallback) ? 1 : fallback;
  }
  double x = json_number_value(value);
  static const char *const rules[] = {"finite", "greater than 0", "0 or greater", "between 0 and 1"};
  bool good = isfinite(x);
  if (range == TDM_POSITIVE)
    good = good && x > 0;
  if (range == TDM_NOT_NEGATIVE)
    good = good && x >= 0;
  if (range == TDM_UNIT_INTERVAL)
    good = good && x >= 0 && x <= 1;
  if (!good) {
    tdm_object_fail(o, key, "is %g but must be %s", x, rules[range]);
    return isnan(fallback) ? 1 : fallback;
  }
  return x;
}

long tdm_get_integer(tdm_object *o, const char *key, long fallback, long least) {
  if (listener.tell && fallback != TDM_REQUIRED_INT)
    tell(o, key, json_integer(fallback));
  json_t *value = ask(o, key);
  if (!value) {
    if (fallback == TDM_REQUIRED_INT)
      missing(o, key, "a whole number");
    return fallback == TDM_REQUIRED_INT ? least : fallback;
  }
  double x = json_is_number(value) ? json_number_value(value) : NAN;
  if (!(fabs(x) < 1e15) || x != floor(x)) {
    if (json_is_number(value))
      tdm_object_fail(o, key, "is %g but must be a whole number%s", x, x == floor(x) ? " below 1e15" : "");
    else
      wrong_type(o, key, "a whole number", value);
    return least;
  }
  if (x < (double)least) {
    tdm_object_fail(o, key, "is %.0f but must be at least %ld", x, least);
    return least;
  }
  return (long)x;
}

bool tdm_get_bool(tdm_object *o, const char *key, bool fallback) {
  if (listener.tell)
    tell(o, key, json_boolean(fallback));
  json_t *value = ask(o, key);
  if (value && !json_is_boolean(value))
    wrong_type(o, key, "true or false", value);
  return value ? json_is_true(value) : fallback;
}

const char *tdm_get_string(tdm_object *o, const char *key, const char *fallback) {
  if (listener.tell && fallback)
    tell(o, key, json_string(fallback));
  json_t *value = ask(o, key);
  if (value && json_is_string(value))
    return json_string_value(value);
  if (value)
    wrong_type(o, key, "a string", value);
  else if (!fallback)
    missing(o, key, "a string");
  return fallback ? fallback : "";
}

int tdm_get_choice(tdm_object *o, const char *key, const char *const *choices, int nchoice, int fallback) {
  if (listener.tell && fallback >= 0)
    tell(o, key, json_string(choices[fallback]));
  if (!ask(o, key)) {
    if (fallback < 0) {
      char list[256] = "one of";
      for (int i = 0; i < nchoice; i++)
        snprintf(list + strlen(list), sizeof list - strlen(list), "%s \"%s\"", i ? "," : "", choices[i]);
      missing(o, key, list);
    }
    return fallback;
  }
  const char *text = tdm_get_string(o, key, NULL);
  for (int i = 0; i < nchoice; i++)
    if (strcmp(text, choices[i]) == 0)
      return i;
  char list[512] = "";
  for (int i = 0; i < nchoice; i++)
    snprintf(list + strlen(list), sizeof list - strlen(list), "%s\"%s\"", i ? ", " : "", choices[i]);
  const char *near = tdm_nearest(text, choices, nchoice);
  tdm_object_fail(o, key, "\"%s\" is not known; %s%s%sone of %s", text, near ? "did you mean \"" : "", near ? near : "",
                  near ? "\"? It is " : "give ", list);
  return -1;
}

static const char *name_of(const void *row) {
  return *(const char *const *)row;
}

const char *tdm_type_name(const tdm_types *types, int i) {
  return types->row[i] ? name_of(types->row[i]) : NULL;
}

const void *tdm_get_type(tdm_object *o, const tdm_types *types) {
  const char *names[TDM_TYPES_MAX];
  int n = 0;
  for (; types->row[n]; n++)
    names[n] = name_of(types->row[n]);
  int type = tdm_get_choice(o, "type", names, n, -1);
  return type < 0 || o->err->status ? NULL : types->row[type];
}

tdm_status tdm_type_add(tdm_types *types, const void *row, tdm_error *err) {
  int n = 0;
  for (; types->row[n]; n++)
    if (strcmp(name_of(types->row[n]), name_of(row)) == 0)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "there is a type \"%s\" already; give the new one another name",
                      name_of(row));
  if (n == TDM_TYPES_MAX)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "there is no room for the type \"%s\": a table has %d types at most",
                    name_of(row), TDM_TYPES_MAX);
  types->row[n] = row;
  return TDM_OK;
}

bool tdm_get_numbers(tdm_object *o, const char *key, double *out, int n, bool required) {
  json_t *value = ask(o, key);
  char path[TDM_PATH_MAX], what[64];
  snprintf(what, sizeof what, "an array of %d numbers", n);
  if (!value) {
    if (required)
      missing(o, key, what);
    return false;
  }
  if (!json_is_array(value)) {
    wrong_type(o, key, what, value);
    return false;
  }
  if (json_array_size(value) != (size_t)n) {
    tdm_object_fail(o, key, "has %zu entries but must have %d", json_array_size(value), n);
    return false;
  }
  for (int i = 0; i < n; i++) {
    json_t *entry = json_array_get(value, (size_t)i);
    double x = json_is_number(entry) ? json_number_value(entry) : NAN;
    if (!isfinite(x)) {
      tdm_fail(o->err, TDM_ERR_SCENE, tdm_path(path, o, key, i), "must be a finite number, not %s", type_name(entry));
      return false;
    }
    out[i] = x;
  }
  return true;
}

tdm_vec3 tdm_get_vec3(tdm_object *o, const char *key, const tdm_vec3 *fallback) {
  if (listener.tell && fallback)
    tell(o, key, json_pack("[f,f,f]", fallback->x, fallback->y, fallback->z));
  double v[3] = {0, 0, 0};
  if (tdm_get_numbers(o, key, v, 3, fallback == NULL) || !fallback)
    return tdm_v3(v[0], v[1], v[2]);
  return *fallback;
}

tdm_quat tdm_get_orientation(tdm_object *o, const char *key) {
  json_t *value = ask(o, key);
  if (!value)
    return tdm_quat_identity();
  if (json_is_object(value)) {
    tdm_object angles = tdm_get_object(o, key, true);
    double e[3] = {0, 0, 0};
    tdm_get_numbers(&angles, "euler313", e, 3, true);
    tdm_object_close(&angles);
    return tdm_euler313_to_quat((tdm_euler313){.phi = e[0], .theta = e[1], .psi = e[2]});
  }
  double q[4] = {1, 0, 0, 0};
  if (tdm_get_numbers(o, key, q, 4, true) && q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] < 1e-12)
    tdm_object_fail(o, key, "is the zero quaternion; give [w, x, y, z] of a rotation, [1, 0, 0, 0] for none");
  return tdm_quat_unit((tdm_quat){q[0], q[1], q[2], q[3]});
}

json_t *tdm_get_array(tdm_object *o, const char *key, bool required) {
  json_t *value = ask(o, key);
  if (!value && required)
    missing(o, key, "an array […]");
  if (value && !json_is_array(value)) {
    wrong_type(o, key, "an array […]", value);
    return NULL;
  }
  return value;
}

/* ---- gravity ---- */

static const char *const solvers[] = {"mbd", "dem"};

json_t *tdm_section_solver(const json_t *section) {
  json_t *solver = json_object_get(section, "solver");
  return json_is_object(solver) ? NULL : solver;
}

int tdm_section_ranks(const json_t *section) {
  const double ranks = json_number_value(json_object_get(section, "ranks"));
  return ranks >= 1 && ranks < 1e6 && ranks == floor(ranks) ? (int)ranks : 1;
}

json_t *tdm_scene_section(const json_t *root, const char *role) {
  json_t *section = json_object_get(root, role), *gravity = json_object_get(root, "gravity");
  const bool lacks_gravity = gravity && !json_object_get(section, "gravity");
  if (!json_is_object(section) || !(lacks_gravity || tdm_section_solver(section)))
    return json_incref(section);
  json_t *copy = json_copy(section);
  if (tdm_section_solver(section))
    json_object_del(copy, "solver");
  if (lacks_gravity)
    json_object_set(copy, "gravity", gravity);
  return copy;
}

void tdm_check_gravity(tdm_object *root) {
  if (!tdm_has(root, "gravity"))
    return;
  tdm_vec3 all = tdm_get_vec3(root, "gravity", NULL);
  for (int r = 0; r < 2 && !root->err->status; r++) {
    tdm_error none = {0}; /* what is wrong with a section is told by its reader */
    json_t *json = json_object_get(root->json, solvers[r]);
    if (json_is_string(tdm_section_solver(json))) /* then the section is that solver's own */
      continue;
    tdm_object section = tdm_object_open(json_is_object(json) ? json : NULL, solvers[r], &none);
    tdm_vec3 own = tdm_get_vec3(&section, "gravity", &all);
    if (!none.status && tdm_norm(tdm_sub(own, all)) > 0)
      tdm_fail(
          root->err, TDM_ERR_SCENE, r ? "dem.gravity" : "mbd.gravity",
          "is [%g, %g, %g] m/s2, but the scene's own \"gravity\", which is for all sections, is [%g, %g, %g]: remove "
          "one of them",
          own.x, own.y, own.z, all.x, all.y, all.z);
  }
}
