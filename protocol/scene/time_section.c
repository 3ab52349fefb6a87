/* The section "time" of a scene, and the grid of the outputs: see time_section.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/scene/time_section.h"

uint64_t tdm_total_steps(const tdm_time *t) {
  return (uint64_t)ceil(t->end / t->dt - 1e-6); /* 1e-6: 5 s in steps of 1e-4 s are 50000 steps, not 50001 */
}

tdm_time tdm_read_time(tdm_object *root) {
  const double most_steps = 1e15; /* step numbers stay exact in a double */
  tdm_object o = tdm_get_object(root, "time", true);
  tdm_time t = {0};
  t.end = tdm_get_number(&o, "end", TDM_REQUIRED, TDM_POSITIVE);
  t.dt = tdm_get_number(&o, "dt", TDM_REQUIRED, TDM_POSITIVE);
  if (t.dt > t.end)
    tdm_object_fail(&o, "dt", "is %g s, longer than the whole run (time.end = %g s)", t.dt, t.end);
  if (t.end / t.dt > most_steps)
    tdm_object_fail(&o, "dt", "is %g s: %g steps until time.end; take a larger step", t.dt, t.end / t.dt);
  tdm_object_close(&o);
  return t;
}

double tdm_read_interval(tdm_object *o, const char *key, double fallback, double dt) {
  double interval = tdm_get_number(o, key, fallback, TDM_POSITIVE);
  if (interval < dt * (1 - 1e-9))
    tdm_object_fail(o, key, "is %g s, shorter than a DEM step (time.dt = %g s); take at least that", interval, dt);
  return interval;
}
