/* A solver's report, or another JSON object, for people: see print.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/app/print.h"

#include "protocol/base/status.h"

#include <stdio.h>

/* Without what a terminal would obey. */
static void print_text(const char *text) {
  char clean[1024];
  snprintf(clean, sizeof clean, "%s", text);
  tdm_utf8_clean(clean);
  printf("%s", clean);
}

/* One line: a path and its value; objects go down, arrays of numbers stay on a line. */
static void print_value(char *path, const json_t *value) {
  char deeper[TDM_PATH_MAX];
  const char *key;
  size_t i;
  json_t *child;
  if (json_is_object(value)) {
    json_object_foreach((json_t *)value, key, child) {
      snprintf(deeper, sizeof deeper, "%s%s%s", path, *path ? "." : "", key);
      print_value(deeper, child);
    }
    return;
  }
  if (json_is_array(value) && json_array_size(value) > 0 && !json_is_number(json_array_get(value, 0))) {
    json_array_foreach(value, i, child) {
      snprintf(deeper, sizeof deeper, "%s[%zu]", path, i);
      print_value(deeper, child);
    }
    return;
  }
  tdm_utf8_clean(path);
  printf("  %-28s ", path);
  if (json_is_string(value))
    print_text(json_string_value(value));
  else if (json_is_integer(value))
    printf("%lld", (long long)json_integer_value(value));
  else if (json_is_real(value))
    printf("%.6g", json_real_value(value));
  else if (json_is_boolean(value))
    printf("%s", json_is_true(value) ? "yes" : "no");
  else if (json_is_array(value))
    json_array_foreach(value, i, child) printf("%s%.6g", i ? " " : "", json_number_value(child));
  else
    printf("-");
  printf("\n");
}

void tdm_print_json(const json_t *json) {
  char path[TDM_PATH_MAX] = "";
  print_value(path, json);
}
