/* Remarks: see remark.h. */
/* SPDX-License-Identifier: MIT */
#include "protocol/scene/remark.h"

#include "protocol/base/log.h"
#include "protocol/scene/json.h"

#include <math.h>
#include <string.h>

enum { LOGGED = 10, WIRE_MAX = 256 /* entries of a message */ };

static const char *const levels[] = {"notice", "warning"};
static const char further[] = "further";

static _Thread_local tdm_remarks *sink;

void tdm_remarks_open(tdm_remarks *table) {
  sink = table;
}

/* ---- the table ---- */

/* The entry of an event, a new one if it is not there; in a full table the last one stands for the rest. */
static tdm_remark_entry *entry_of(tdm_remarks *table, tdm_remark_level level, const char *event) {
  for (int i = 0; i < table->count; i++)
    if (strcmp(table->entry[i].event, event) == 0)
      return &table->entry[i];
  bool full = table->count >= TDM_REMARKS_MAX - 1;
  if (full && table->count == TDM_REMARKS_MAX)
    return &table->entry[TDM_REMARKS_MAX - 1];
  tdm_remark_entry *entry = &table->entry[table->count++];
  *entry = (tdm_remark_entry){.level = full ? TDM_WARNING : level};
  snprintf(entry->event, sizeof entry->event, "%s", full ? further : event);
  return entry;
}

void tdm_remark(tdm_remark_level level, const char *event, const char *path, double t, const char *format, ...) {
  char message[TDM_MESSAGE_MAX], quoted[TDM_MESSAGE_MAX];
  va_list args;
  va_start(args, format);
  vsnprintf(message, sizeof message, format, args);
  va_end(args);
  tdm_utf8_clean(message);
  uint64_t count = 1;
  if (sink) {
    tdm_remark_entry *entry = entry_of(sink, level, event);
    count = ++entry->count;
    entry->last = t;
    sink->changes++;
    if (count == 1) {
      entry->first = t;
      snprintf(entry->path, sizeof entry->path, "%s", path ? path : "");
      memcpy(entry->message, message, sizeof message);
    }
  }
  if (count <= LOGGED)
    tdm_log(level == TDM_WARNING ? TDM_LOG_WARNING : TDM_LOG_INFO, event, "t=%.9g message=%s%s", t,
            tdm_log_quote(quoted, sizeof quoted, message), count == LOGGED ? " further=not_logged" : "");
}

void tdm_remarks_copy(tdm_remarks *dst, const tdm_remarks *src) {
  dst->changes++;
  dst->count = src->count;
  memcpy(dst->entry, src->entry, (size_t)src->count * sizeof *src->entry);
}

void tdm_warning_vset(tdm_warning *warning, const char *path, const char *format, va_list args) {
  snprintf(warning->path, sizeof warning->path, "%s", path);
  vsnprintf(warning->message, sizeof warning->message, format, args);
}

void tdm_warning_set(tdm_warning *warning, const char *path, const char *format, ...) {
  va_list args;
  va_start(args, format);
  tdm_warning_vset(warning, path, format, args);
  va_end(args);
}

/* ---- as JSON ---- */

json_t *tdm_remarks_to_json(const tdm_remarks *table, const char *from) {
  json_t *all = json_array();
  for (int i = 0; i < table->count; i++) {
    const tdm_remark_entry *e = &table->entry[i];
    json_t *entry = json_pack("{s:s, s:s, s:s, s:s, s:I, s:o, s:o}", "event", e->event, "level", levels[e->level],
                              "path", e->path, "message", e->message, "count", (json_int_t)e->count, "first_s",
                              tdm_number_to_json(e->first), "last_s", tdm_number_to_json(e->last));
    if (entry && from)
      json_object_set_new(entry, "from", json_string(from));
    json_array_append_new(all, entry);
  }
  return all;
}

static const char *text_of(const json_t *entry, const char *key) {
  const char *text = json_string_value(json_object_get(entry, key));
  return text ? text : "";
}

/* A text from elsewhere without what would steer a terminal. */
static void copy_text(json_t *to, const json_t *entry, const char *key) {
  char text[TDM_MESSAGE_MAX];
  snprintf(text, sizeof text, "%s", text_of(entry, key));
  for (char *c = text; *c; c++)
    if ((unsigned char)*c < ' ' || *c == 127)
      *c = ' ';
  tdm_utf8_clean(text);
  json_object_set_new(to, key, json_string(text));
}

/* NULL: not as it should be */
static json_t *read_entry(const json_t *entry, const char *from) {
  const char *level = text_of(entry, "level");
  json_t *count = json_object_get(entry, "count");
  if (!*text_of(entry, "event") || !*text_of(entry, "message") || !json_is_integer(count) ||
      json_integer_value(count) < 1 || (strcmp(level, levels[0]) != 0 && strcmp(level, levels[1]) != 0))
    return NULL;
  json_t *read = json_pack("{s:s, s:I}", "level", level, "count", json_integer_value(count));
  for (int k = 0; k < 3; k++)
    copy_text(read, entry, (const char *const[]){"event", "path", "message"}[k]);
  for (int k = 0; k < 2; k++) {
    const char *key = (const char *const[]){"first_s", "last_s"}[k];
    const json_t *time = json_object_get(entry, key);
    json_object_set_new(read, key, json_is_number(time) ? json_real(json_number_value(time)) : json_null());
  }
  if (from)
    json_object_set_new(read, "from", json_string(from));
  return read;
}

json_t *tdm_remarks_from_json(const json_t *remarks, const char *from, tdm_error *err) {
  if (!json_is_array(remarks) || json_array_size(remarks) > WIRE_MAX) {
    tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed REMARKS: no array of at most %d entries", WIRE_MAX);
    return NULL;
  }
  json_t *all = json_array();
  for (size_t i = 0; i < json_array_size(remarks); i++) {
    json_t *entry = read_entry(json_array_get(remarks, i), from);
    if (!entry) {
      tdm_fail(err, TDM_ERR_PROTOCOL, NULL,
               "malformed REMARKS: entry %zu needs event, level (\"warning\" or \"notice\"), message and count", i);
      json_decref(all);
      return NULL;
    }
    json_array_append_new(all, entry);
  }
  return all;
}

/* A copy of an entry whose places are named as the scene was written. */
static json_t *as_written(const json_t *entry, const tdm_scene *scene) {
  tdm_error place = {0};
  json_t *copy = json_copy((json_t *)entry);
  tdm_fail(&place, TDM_ERR_NUMERIC, text_of(entry, "path"), "%s", text_of(entry, "message"));
  tdm_scene_as_written(scene, &place);
  json_object_set_new(copy, "path", json_string(place.path));
  json_object_set_new(copy, "message", json_string(place.message));
  return copy;
}

void tdm_remarks_enter(json_t *summary, const json_t *remarks, const tdm_scene *scene) {
  static const char *const lists[] = {"notices", "warnings"};
  for (int level = 0; level < 2; level++) {
    json_t *list = json_object_get(summary, lists[level]);
    if (!json_is_array(list)) {
      list = json_array();
      json_object_set_new(summary, lists[level], list);
    }
    for (size_t i = 0; i < json_array_size(remarks); i++) {
      json_t *entry = json_array_get(remarks, i);
      if (strcmp(text_of(entry, "level"), levels[level]) == 0)
        json_array_append_new(list, scene && scene->kept ? as_written(entry, scene) : json_incref(entry));
    }
  }
}

/* ---- on a terminal ---- */

/* what identifies an entry among those of all programs */
static void key_of(const json_t *entry, char *key, size_t size) {
  snprintf(key, size, "%s%s%s", text_of(entry, "from"), *text_of(entry, "from") ? ": " : "", text_of(entry, "event"));
}

void tdm_remarks_tell(tdm_teller *teller, const json_t *remarks, const char *before) {
  if (!teller->told)
    teller->told = json_object();
  for (size_t i = 0; i < json_array_size(remarks); i++) {
    const json_t *entry = json_array_get(remarks, i);
    char key[256];
    key_of(entry, key, sizeof key);
    if (json_object_get(teller->told, key))
      continue;
    json_object_set_new(teller->told, key, json_true());
    tdm_error place = {0};
    tdm_fail(&place, TDM_ERR_NUMERIC, text_of(entry, "path"), "%s", text_of(entry, "message"));
    if (teller->scene)
      tdm_scene_locate(teller->scene, &place);
    const char *from = text_of(entry, "from");
    fprintf(stderr, "%s%s: %s: %s%s%s\n", before ? before : "", teller->program, text_of(entry, "level"), from,
            *from ? ": " : "", place.message);
    before = NULL;
  }
}

/* How often an entry came, when, and where first. */
static void tell_count(const tdm_teller *teller, const json_t *entry, const char *key) {
  const long long count = json_integer_value(json_object_get(entry, "count"));
  const json_t *first = json_object_get(entry, "first_s"), *last = json_object_get(entry, "last_s");
  tdm_error place = {0};
  tdm_fail(&place, TDM_ERR_NUMERIC, text_of(entry, "path"), "first");
  if (teller->scene)
    tdm_scene_as_written(teller->scene, &place);
  fprintf(stderr, "%s: %s: %s: ", teller->program, text_of(entry, "level"), key);
  if (count > 1)
    fprintf(stderr, "%lld times", count);
  else
    fputs("once", stderr);
  if (json_is_number(first) && count > 1)
    fprintf(stderr, ", from t = %.6g s to %.6g s", json_number_value(first), json_number_value(last));
  else if (json_is_number(first))
    fprintf(stderr, ", at t = %.6g s", json_number_value(first));
  fprintf(stderr, *place.path ? ", first at %s\n" : "\n", place.path);
}

void tdm_remarks_tell_end(tdm_teller *teller, const json_t *remarks, size_t doubts) {
  json_t *before = teller->told ? json_copy(teller->told) : json_object();
  tdm_remarks_tell(teller, remarks, NULL);
  for (size_t i = 0; i < json_array_size(remarks); i++) {
    const json_t *entry = json_array_get(remarks, i);
    const bool many = json_integer_value(json_object_get(entry, "count")) > 1;
    char key[256];
    key_of(entry, key, sizeof key);
    if (many || (json_object_get(before, key) && strcmp(text_of(entry, "level"), levels[TDM_WARNING]) == 0))
      tell_count(teller, entry, key);
  }
  if (doubts > 0)
    fprintf(stderr, "%s: warning: %zu doubt%s about the scene from before the start; summary.json has %s\n",
            teller->program, doubts, doubts == 1 ? "" : "s", doubts == 1 ? "it" : "them");
  json_decref(before);
}

void tdm_teller_free(tdm_teller *teller) {
  json_decref(teller->told);
  teller->told = NULL;
}
