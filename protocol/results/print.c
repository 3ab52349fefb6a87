/* A solver's report, or another JSON object, for people: see print.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/results/print.h"

#include "protocol/base/status.h"

#include <stdio.h>

const char *tdm_json_text(const json_t *value, char *out, size_t size) {
  if (json_is_string(value))
    snprintf(out, size, "%s", json_string_value(value));
  else if (json_is_integer(value))
    snprintf(out, size, "%lld", (long long)json_integer_value(value));
  else if (json_is_real(value))
    snprintf(out, size, "%.6g", json_real_value(value));
  else
    snprintf(out, size, "%s", json_is_true(value) ? "yes" : json_is_false(value) ? "no" : "-");
  return out;
}

static void visit_rows(const char *path, const json_t *value, tdm_row_visitor *visit, void *arg) {
  char deeper[TDM_PATH_MAX];
  const char *key;
  size_t i;
  json_t *child;
  if (json_is_object(value))
    json_object_foreach((json_t *)value, key, child) {
      snprintf(deeper, sizeof deeper, "%s%s%s", path, *path ? "." : "", key);
      visit_rows(deeper, child, visit, arg);
    }
  else if (json_array_size(value) > 0 && !json_is_number(json_array_get(value, 0)))
    json_array_foreach(value, i, child) {
      snprintf(deeper, sizeof deeper, "%s[%zu]", path, i);
      visit_rows(deeper, child, visit, arg);
    }
  else
    visit(arg, path, value);
}

void tdm_json_rows(const json_t *json, tdm_row_visitor *visit, void *arg) {
  visit_rows("", json, visit, arg);
}

/* without what a terminal would obey */
static void print_text(int width, const char *text) {
  char clean[1024];
  snprintf(clean, sizeof clean, "%s", text);
  tdm_utf8_clean(clean);
  printf("%-*s", width, clean);
}

static void print_row(void *arg, const char *path, const json_t *value) {
  char text[1024];
  size_t i;
  json_t *number;
  (void)arg;
  printf("  ");
  print_text(28, path);
  printf(" ");
  if (json_is_array(value))
    json_array_foreach(value, i, number) printf("%s%s", i ? " " : "", tdm_json_text(number, text, sizeof text));
  else
    print_text(0, tdm_json_text(value, text, sizeof text));
  printf("\n");
}

void tdm_print_json(const json_t *json) {
  tdm_json_rows(json, print_row, NULL);
}
