/* What follows from the server's settings: see settings.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/settings/settings.h"

#include "protocol/scene/time_section.h"

#include <ctype.h>
#include <string.h>

const char *const cpl_role_names[CPL_NROLE] = {"mbd", "dem"};

uint64_t cpl_total_steps(const cpl_settings *s) {
  return tdm_total_steps(&(tdm_time){s->time_end, s->dt});
}

double cpl_first_window(const cpl_settings *s) {
  const uint64_t n = (uint64_t)(s->adapt.on ? s->adapt.n_min : s->n), total = cpl_total_steps(s);
  return (double)(n < total ? n : total) * s->dt;
}

uint64_t cpl_total_windows(const cpl_settings *s) {
  uint64_t n = (uint64_t)s->n;
  return (cpl_total_steps(s) + n - 1) / n;
}

bool cpl_name_fits_file(const char *name) {
  for (const char *c = name; *c; c++)
    if (!isalnum((unsigned char)*c) && !strchr("_-.", *c))
      return false;
  return *name && *name != '.';
}
