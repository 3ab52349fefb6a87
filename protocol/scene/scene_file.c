/* The scene file: reading, "--set" overrides, and the place of a JSON path in the text. */
/* SPDX-License-Identifier: MIT */
#include "protocol/scene/scene.h"

#include "protocol/base/memory.h"
#include "protocol/scene/input.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- reading ---- */

enum { SCENE_MAX = 1 << 28 }; /* bytes */

static char *read_file(const char *file, size_t *size, tdm_error *err) {
  const char *why;
  FILE *f = tdm_open_input(file, true, &why);
  if (!f) {
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be opened: %s; check the name", file, why);
    return NULL;
  }
  char *text = NULL;
  size_t used = 0, capacity = 0, got;
  do {
    if (used + 4097 > capacity) {
      capacity = capacity ? 2 * capacity : 16384;
      char *larger = realloc(text, capacity);
      if (!larger) {
        tdm_fail(err, TDM_ERR_MEMORY, NULL, "%s: out of memory after %zu bytes", file, used);
        break;
      }
      text = larger;
    }
    got = fread(text + used, 1, capacity - used - 1, f);
    if (memchr(text + used, 0, got)) /* /dev/zero, and any binary file */
      tdm_fail(err, TDM_ERR_JSON, NULL, "%s: holds a byte of value 0, which no scene does; check the name", file);
    used += got;
    if (used > SCENE_MAX)
      tdm_fail(err, TDM_ERR_FILE, NULL, "%s: is larger than %d MiB, which no scene is; check the name", file,
               SCENE_MAX >> 20);
  } while (got > 0 && err->status == TDM_OK);
  if (ferror(f))
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be read: %s", file, strerror(errno));
  fclose(f);
  if (err->status != TDM_OK) {
    free(text);
    return NULL;
  }
  text[used] = 0;
  *size = used;
  return text;
}

/* Relative names of the key "file" start at the folder of the scene: make them absolute, also in what is below. */
static bool anchor(json_t *json, const char *folder) {
  bool good = true;
  const char *key;
  json_t *value;
  size_t k;
  if (json_is_array(json))
    json_array_foreach(json, k, value) good = anchor(value, folder) && good;
  else
    json_object_foreach(json, key, value) {
      const char *name = strcmp(key, "file") == 0 ? json_string_value(value) : NULL;
      if (!name)
        good = anchor(value, folder) && good;
      else if (*name && *name != '/')
        good = json_object_set_new(json, key, json_sprintf("%s/%s", folder, name)) == 0 && good;
    }
  return good;
}

static tdm_status anchor_files(tdm_scene *scene, tdm_error *err) {
  char *folder = realpath(scene->file, NULL), *last = folder ? strrchr(folder, '/') : NULL;
  if (last)
    *last = 0;
  bool good = !folder || anchor(scene->root, folder); /* no folder: a pipe */
  free(folder);
  return good ? TDM_OK
              : tdm_fail(err, TDM_ERR_MEMORY, NULL, "%s: its folder cannot be put before the files it names",
                         scene->file);
}

static tdm_status read_scene(tdm_scene *scene, const char *file, tdm_error *err) {
  *scene = (tdm_scene){.file = strdup(file)};
  if (!scene->file)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "%s: out of memory", file);
  size_t size = 0;
  scene->text = read_file(file, &size, err);
  if (!scene->text)
    return err->status;
  json_error_t json_error;
  scene->root = json_loadb(scene->text, size, JSON_REJECT_DUPLICATES, &json_error);
  if (!scene->root)
    return tdm_fail(err, TDM_ERR_JSON, NULL, "%s:%d:%d: not valid JSON: %s", file, json_error.line, json_error.column,
                    json_error.text);
  if (!json_is_object(scene->root))
    return tdm_fail(err, TDM_ERR_SCENE, NULL,
                    "%s:1:1: a scene is an object {…} with the sections time, coupling, mbd, dem", file);
  return anchor_files(scene, err);
}

tdm_status tdm_scene_read(tdm_scene *scene, const char *file, tdm_error *err) {
  tdm_memory_watch_json();
  const unsigned long before = tdm_memory_notes();
  read_scene(scene, file, err);
  return tdm_memory_since(before, NULL, err);
}

void tdm_scene_destroy(tdm_scene *scene) {
  free(scene->file);
  free(scene->text);
  json_decref(scene->root);
  json_decref(scene->written);
  json_decref(scene->kept);
  *scene = (tdm_scene){0};
}

/* ---- paths ---- */

/* One part of a path: a key, or an index in [brackets]. Returns the rest, or NULL when the path is malformed. */
static const char *next_part(const char *path, char *key, size_t size, long *index) {
  *index = -1;
  key[0] = 0;
  if (*path == '[') {
    char *end;
    *index = strtol(path + 1, &end, 10);
    if (end == path + 1 || *end != ']' || *index < 0)
      return NULL;
    path = end + 1;
  } else {
    size_t n = strcspn(path, ".[");
    if (n == 0 || n >= size)
      return NULL;
    memcpy(key, path, n);
    key[n] = 0;
    path += n;
  }
  if (*path == '.')
    return path[1] && path[1] != '.' && path[1] != '[' ? path + 1 : NULL;
  return path;
}

const json_t *tdm_scene_value(const json_t *root, const char *path) {
  char key[TDM_PATH_MAX];
  long index;
  while (root && *path) {
    path = next_part(path, key, sizeof key, &index);
    if (!path)
      return NULL;
    root = index < 0 ? json_object_get(root, key) : json_array_get(root, (size_t)index);
  }
  return root;
}

/* ---- overrides ---- */

/* Put value (stolen) at key or index of parent. */
static int put(json_t *parent, const char *key, long index, json_t *value) {
  if (index < 0)
    return json_object_set_new(parent, key, value);
  if ((size_t)index == json_array_size(parent))
    return json_array_append_new(parent, value);
  return json_array_set_new(parent, (size_t)index, value);
}

static tdm_status set_at(json_t *root, const char *path, json_t *value, tdm_error *err) {
  json_t *parent = root;
  const char *rest = path;
  char key[TDM_PATH_MAX];
  long index;
  while (true) {
    rest = next_part(rest, key, sizeof key, &index);
    if (!rest) {
      json_decref(value);
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                      "--set %s: not a path; write it as coupling.n or dem.materials[0].density", path);
    }
    bool fits = index < 0 ? json_is_object(parent) : json_is_array(parent);
    if (!fits || (index >= 0 && (size_t)index > json_array_size(parent))) {
      json_decref(value);
      return tdm_fail(err, TDM_ERR_ARGUMENT, path,
                      index < 0 ? "--set: \"%s\" is a key, but what it stands in is not an object"
                                : "--set: %s[%ld] is not an entry of the array it stands in",
                      index < 0 ? key : "", index);
    }
    if (*rest == 0)
      break;
    json_t *child = index < 0 ? json_object_get(parent, key) : json_array_get(parent, (size_t)index);
    if (!child) {
      put(parent, key, index, *rest == '[' ? json_array() : json_object());
      child = index < 0 ? json_object_get(parent, key) : json_array_get(parent, (size_t)index);
    }
    parent = child;
  }
  if (put(parent, key, index, value) != 0)
    return tdm_fail(err, TDM_ERR_MEMORY, path, "--set: out of memory");
  return TDM_OK;
}

/* A parameter that the scene does not have would change nothing. */
static tdm_status check_parameter(const json_t *root, const char *path, tdm_error *err) {
  static const char section[] = "parameters.";
  const size_t n = sizeof section - 1;
  json_t *there = json_object_get(root, "parameters");
  if (strncmp(path, section, n) != 0 || json_object_get(there, path + n))
    return TDM_OK;
  const char **names = calloc(json_object_size(there) + 1, sizeof *names), *name;
  int count = 0;
  json_t *value;
  if (!names)
    return tdm_fail(err, TDM_ERR_MEMORY, path, "--set: out of memory");
  json_object_foreach(there, name, value) names[count++] = name;
  const char *near = tdm_nearest(path + n, names, count);
  tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "--set %s: the scene has no such parameter%s%s%s", path,
           near        ? "; did you mean \""
           : count > 0 ? "; it has \""
                       : "s: it has no section parameters",
           near        ? near
           : count > 0 ? names[0]
                       : "",
           near        ? "\"?"
           : count > 0 ? "\" and others"
                       : "");
  free(names);
  return err->status;
}

tdm_status tdm_scene_set(tdm_scene *scene, const char *assignment, tdm_error *err) {
  const char *equals = strchr(assignment, '=');
  size_t n = equals ? (size_t)(equals - assignment) : 0;
  char path[TDM_PATH_MAX];
  if (n == 0 || n >= sizeof path)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "--set %s: write PATH=VALUE, for example --set coupling.n=25",
                    assignment);
  memcpy(path, assignment, n);
  path[n] = 0;
  if (check_parameter(scene->root, path, err) != TDM_OK)
    return err->status;
  json_t *value = json_loads(equals + 1, JSON_DECODE_ANY | JSON_REJECT_DUPLICATES, NULL);
  if (!value)
    value = json_string(equals + 1);
  if (!value)
    return tdm_fail(err, TDM_ERR_ARGUMENT, path, "--set: the value is neither JSON nor UTF-8 text");
  return set_at(scene->root, path, value, err);
}

/* ---- positions ---- */

/* A scanner over valid JSON text: it only has to skip. */
static const char *skip_space(const char *p) {
  while (*p && isspace((unsigned char)*p))
    p++;
  return p;
}

static const char *skip_string(const char *p) { /* p at the opening quote */
  for (p++; *p && *p != '"'; p++)
    if (*p == '\\' && p[1])
      p++;
  return *p ? p + 1 : p;
}

static const char *skip_value(const char *p) {
  p = skip_space(p);
  if (*p == '"')
    return skip_string(p);
  if (*p != '{' && *p != '[')
    return p + strcspn(p, ",]} \t\r\n");
  int depth = 0;
  do {
    if (*p == '"') {
      p = skip_string(p);
      continue;
    }
    depth += *p == '{' || *p == '[';
    depth -= *p == '}' || *p == ']';
    p++;
  } while (*p && depth > 0);
  return p;
}

/* The value of a key in the object at p, or NULL. *name is set to where the key stands. */
static const char *find_key(const char *p, const char *key, const char **name) {
  p = skip_space(p);
  if (*p != '{')
    return NULL;
  p = skip_space(p + 1);
  while (*p == '"') {
    const char *start = p;
    p = skip_string(p);
    size_t n = (size_t)(p - start) - 2;
    const char *value = skip_space(p);
    if (*value != ':')
      return NULL;
    value = skip_space(value + 1);
    if (n == strlen(key) && memcmp(start + 1, key, n) == 0) {
      *name = start;
      return value;
    }
    p = skip_space(skip_value(value));
    if (*p == ',')
      p = skip_space(p + 1);
  }
  return NULL;
}

static const char *find_index(const char *p, long index) {
  p = skip_space(p);
  if (*p != '[')
    return NULL;
  p = skip_space(p + 1);
  for (long i = 0; i < index && *p && *p != ']'; i++) {
    p = skip_space(skip_value(p));
    if (*p == ',')
      p = skip_space(p + 1);
  }
  return *p && *p != ']' ? p : NULL;
}

bool tdm_scene_place(const char *text, const char *path, int *line, int *column) {
  const char *value = skip_space(text), *place = value, *rest = path;
  bool found = false;
  char key[TDM_PATH_MAX];
  long index;
  while (rest && *rest) {
    rest = next_part(rest, key, sizeof key, &index);
    if (!rest)
      break;
    const char *name = NULL;
    value = index < 0 ? find_key(value, key, &name) : find_index(value, index);
    if (!value)
      break;
    place = index < 0 ? name : value;
    found = true;
  }
  *line = 1;
  *column = 1;
  for (const char *p = text; p < place; p++) {
    if (*p == '\n') {
      ++*line;
      *column = 1;
    } else if (((unsigned char)*p & 0xC0) != 0x80) { /* count characters, not the bytes of UTF-8 */
      ++*column;
    }
  }
  return found;
}

/* ---- the text with another value ---- */

/* `text` with `middle` for what stands from `from` to `to`; NULL: no memory. */
static char *replaced(const char *text, const char *from, const char *middle, const char *to) {
  const size_t before = (size_t)(from - text), size = before + strlen(middle) + strlen(to) + 1;
  char *out = malloc(size);
  if (out)
    snprintf(out, size, "%.*s%s%s", (int)before, text, middle, to);
  return out;
}

/* A member more for the object at p, behind its last one and written as its first one is. */
static char *added(const char *text, const char *p, const char *member) {
  const char *begin = p + 1, *first = skip_space(begin), *last = begin;
  for (const char *c = first; *c == '"';) {
    last = skip_value(skip_space(skip_string(c)) + 1); /* behind the colon */
    c = skip_space(last);
    if (*c == ',')
      c = skip_space(c + 1);
  }
  const size_t space = (size_t)(first - begin), size = space + strlen(member) + 4;
  char *middle = malloc(size);
  if (!middle)
    return NULL;
  snprintf(middle, size, "%s%.*s%s%s", last > begin ? "," : "", last > begin ? (int)space : 0, begin,
           last > begin && space == 0 ? " " : "", member);
  char *out = replaced(text, last, middle, last);
  free(middle);
  return out;
}

char *tdm_scene_text_with(const char *text, const char *path, const char *value) {
  const char *at = skip_space(text), *rest = path, *name = NULL;
  char key[TDM_PATH_MAX], *member = NULL;
  long index;
  while (rest && *rest) {
    const char *behind = next_part(rest, key, sizeof key, &index), *next = NULL;
    if (behind)
      next = index < 0 ? find_key(at, key, &name) : find_index(at, index);
    if (!next)
      break;
    at = next;
    rest = behind;
  }
  if (rest && !*rest)
    return replaced(text, at, value, skip_value(at));
  if (!rest || strchr(rest, '[') || *at != '{')
    return NULL;
  const size_t size = 6 * strlen(rest) + strlen(value) + 16; /* "a": {"b": value} */
  int objects = 0;
  size_t n = 0;
  if (!(member = malloc(size)))
    return NULL;
  for (; rest && *rest; objects++) {
    rest = next_part(rest, key, sizeof key, &index);
    n += (size_t)snprintf(member + n, size - n, "%s\"%s\": ", objects ? "{" : "", key);
  }
  n += (size_t)snprintf(member + n, size - n, "%s", value);
  for (; objects > 1; objects--)
    n += (size_t)snprintf(member + n, size - n, "}");
  char *out = added(text, at, member);
  free(member);
  return out;
}

/* ---- places as the scene was written ---- */

/* The index, as written, of entry i of the list at `path` (as written). */
static long written_index(const json_t *kept, const char *path, long i) {
  const json_t *index = json_array_get(json_object_get(kept, path), (size_t)i);
  return index ? (long)json_integer_value(index) : i;
}

/* Give the indices of all paths in `text` (size bytes) as they were written. */
static void name_as_written(const json_t *kept, char *text, size_t size) {
  char out[TDM_MESSAGE_MAX];
  size_t n = 0, word = 0; /* where the path begins that goes on here */
  for (const char *c = text; *c && n + 24 < sizeof out;) {
    char *end = NULL;
    const long i = *c == '[' && n > word && isdigit((unsigned char)c[1]) ? strtol(c + 1, &end, 10) : 0;
    out[n] = 0;
    if (end && *end == ']') {
      n += (size_t)snprintf(out + n, sizeof out - n, "[%ld]", written_index(kept, out + word, i));
      c = end + 1;
      continue;
    }
    out[n++] = *c;
    if (!isalnum((unsigned char)*c) && !strchr("_-.", *c))
      word = n;
    c++;
  }
  out[n] = 0;
  snprintf(text, size, "%s", out);
}

void tdm_scene_as_written(const tdm_scene *scene, tdm_error *err) {
  if (!scene->kept)
    return;
  name_as_written(scene->kept, err->path, sizeof err->path);
  name_as_written(scene->kept, err->message, sizeof err->message);
}

const json_t *tdm_scene_value_written_at(const tdm_scene *scene, const char *path) {
  char key[TDM_PATH_MAX], so_far[TDM_PATH_MAX];
  const json_t *value = scene->root;
  for (const char *rest = path; value && *rest;) {
    long index;
    snprintf(so_far, sizeof so_far, "%.*s", (int)(rest - path), path);
    rest = next_part(rest, key, sizeof key, &index);
    if (!rest)
      return NULL;
    const json_t *left = index < 0 ? NULL : json_object_get(scene->kept, so_far);
    size_t i = (size_t)index;
    for (size_t k = 0; left && k <= json_array_size(left); k++)
      if (json_integer_value(json_array_get(left, k)) == index || k == json_array_size(left)) {
        i = k;
        break;
      }
    value = index < 0 ? json_object_get(value, key) : json_array_get(value, i);
  }
  return value;
}

/* Say which expression gave the value at the error's place. */
static void add_expression(const tdm_scene *scene, tdm_error *err) {
  const json_t *value = tdm_scene_value(scene->written, err->path);
  const char *text = json_string_value(value);
  for (size_t i = 0; i < json_array_size(value) && !(text && text[0] == '='); i++)
    text = json_string_value(json_array_get(value, i)); /* of a vector: its first */
  if (!text || text[0] != '=' || strncmp(err->path, "parameters.", 11) == 0)
    return;
  const size_t n = strlen(err->message);
  snprintf(err->message + n, sizeof err->message - n, " (the value of \"%.150s\": change it or a parameter%s)", text,
           strstr(err->message, "must be a whole number") ? ", or take round(), floor() or ceil() of it" : "");
}

void tdm_scene_locate(const tdm_scene *scene, tdm_error *err) {
  if (err->status == TDM_OK || !err->path[0] || !scene->text)
    return;
  tdm_scene_as_written(scene, err);
  add_expression(scene, err);
  int line, column;
  char message[TDM_MESSAGE_MAX];
  tdm_scene_place(scene->text, err->path, &line, &column);
  snprintf(message, sizeof message, "%.200s:%d:%d: %.200s: %.600s", scene->file, line, column, err->path, err->message);
  tdm_utf8_clean(message);
  memcpy(err->message, message, sizeof message);
}
