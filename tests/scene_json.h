/* JSON in C without backslashes: ' stands for ". */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_SCENE_JSON_H
#define TEST_SCENE_JSON_H

#include <check.h>
#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>

/* Single quotes into double ones, in place. */
static inline void double_quotes(char *text) {
  for (char *c = text; *c; c++)
    if (*c == '\'')
      *c = '"';
}

/* JSON by printf's format with single quotes for double ones; the caller's. */
__attribute__((format(printf, 1, 2))) static inline json_t *scene_json(const char *format, ...) {
  static char text[65536];
  va_list args;
  va_start(args, format);
  int length = vsnprintf(text, sizeof text, format, args);
  va_end(args);
  ck_assert_int_lt(length, (int)sizeof text);
  double_quotes(text);
  json_error_t error;
  json_t *json = json_loads(text, JSON_REJECT_DUPLICATES, &error);
  ck_assert_msg(json != NULL, "test scene: %s at line %d column %d of %s", error.text, error.line, error.column, text);
  return json;
}

#endif
