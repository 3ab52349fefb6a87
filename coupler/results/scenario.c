/* The table of scenarios: see scenario.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/results/scenario.h"

#include <string.h>

const cpl_scenario *cpl_scenario_of(const cpl_scenario *table, const json_t *scene, tdm_error *err) {
  const char *name = json_string_value(json_object_get(scene, "scenario")), *known[256];
  int nknown = 0;
  if (!name)
    return NULL;
  for (const cpl_scenario *s = table; s->name && nknown < 256; s++) {
    if (strcmp(s->name, name) == 0)
      return s;
    known[nknown++] = s->name;
  }
  const char *near = tdm_nearest(name, known, nknown);
  tdm_fail(err, TDM_ERR_SCENE, "scenario", "\"%s\" is no scenario%s%s%s", name, near ? "; did you mean \"" : "",
           near ? near : "", near ? "\"?" : "; leave the key out if none fits");
  return NULL;
}
