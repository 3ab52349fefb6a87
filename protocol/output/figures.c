/* Last values of channels in summary.json: see figures.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/output/figures.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* the member of an object that is an object itself, made if it is not there */
static json_t *member(json_t *of, const char *key) {
  if (!json_object_get(of, key))
    json_object_set_new(of, key, json_object());
  return json_object_get(of, key);
}

static json_t *number(const tdm_channel *channel, double value) {
  if (!isfinite(value))
    return json_null();
  return strcmp(channel->unit, "1") == 0 ? json_integer((json_int_t)value) : json_real(value);
}

void tdm_figure_enter(json_t *summary, const tdm_channel *channel, double value) {
  static const char kind[] = "container.";
  const char *name = channel->name + strlen(kind), *dot = strrchr(channel->name, '.');
  char one[sizeof channel->name];
  if (strncmp(channel->name, kind, strlen(kind)) != 0 || dot <= name)
    return;
  snprintf(one, sizeof one, "%.*s", (int)(dot - name), name);
  json_object_set_new(member(member(summary, "containers"), one), dot + 1, number(channel, value));
}
