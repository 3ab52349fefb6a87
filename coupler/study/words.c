/* Parts of a study from the words of a command line: see words.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/study/words.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- lists ---- */

/* A copy of the text from `start` to before `end`, without blanks at its ends. */
static char *trimmed(const char *start, const char *end) {
  while (start < end && isspace((unsigned char)*start))
    start++;
  while (end > start && isspace((unsigned char)end[-1]))
    end--;
  return strndup(start, (size_t)(end - start));
}

/* The same text, or JSON that means the same. */
static bool same_value(const char *a, const char *b) {
  json_t *one = json_loads(a, JSON_DECODE_ANY, NULL), *other = json_loads(b, JSON_DECODE_ANY, NULL);
  bool same = strcmp(a, b) == 0 || (one && other && json_equal(one, other));
  json_decref(one);
  json_decref(other);
  return same;
}

tdm_status cpl_axis_read(cpl_axis *axis, const char *command, const char *path, const char *list, tdm_error *err) {
  snprintf(axis->path, sizeof axis->path, "%s", path);
  const char *start = list;
  int depth = 0;
  bool quoted = false;
  for (const char *c = list;; c++) {
    if (quoted && *c == '\\' && c[1]) {
      c++;
      continue;
    }
    quoted = *c == '"' ? !quoted : quoted;
    depth += !quoted && (*c == '[' || *c == '{' || *c == '(');
    depth -= !quoted && (*c == ']' || *c == '}' || *c == ')');
    if (*c && (*c != ',' || depth > 0 || quoted))
      continue;
    if (c == start || axis->nvalue == CPL_VALUES_MAX)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s: %s=%s: %s", command, path, list,
                      c == start ? "an empty value" : "too many values");
    char *value = trimmed(start, c);
    for (int i = 0; value && i < axis->nvalue; i++)
      if (same_value(axis->value[i], value))
        tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s: %s has the value %.100s twice", command, path, value);
    axis->value[axis->nvalue] = value;
    if (!value)
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    axis->nvalue++;
    if (err->status != TDM_OK)
      return err->status;
    start = c + 1;
    if (!*c)
      return TDM_OK;
  }
}

void cpl_axis_free(cpl_axis *axis) {
  for (int i = 0; i < axis->nvalue; i++)
    free(axis->value[i]);
  axis->nvalue = 0;
}

/* ---- as JSON ---- */

/* A value as --set takes it: JSON, or a text. */
static json_t *value_of(const char *text) {
  json_t *value = json_loads(text, JSON_DECODE_ANY, NULL);
  return value ? value : json_string(text);
}

json_t *cpl_axis_to_json(const cpl_axis *axis) {
  json_t *values = json_array();
  for (int i = 0; i < axis->nvalue; i++)
    json_array_append_new(values, value_of(axis->value[i]));
  return json_pack("{s:s, s:o}", "path", axis->path, "values", values);
}

json_t *cpl_measure_to_json(const char *text) {
  static const char summary[] = "summary.";
  const char *at = strchr(text, '@');
  if (!strchr(text, ':'))
    return json_pack("{s:s+}", "path", strncmp(text, summary, strlen(summary)) == 0 ? "" : summary, text);
  json_t *measure = json_pack("{s:s#}", "channel", text, (int)strcspn(text, "@"));
  if (at)
    json_object_set_new(measure, "at", value_of(at + 1));
  return measure;
}
