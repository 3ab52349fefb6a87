/* What the laws' readers share: see law.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/contact/law/law.h"

#include "dem/contact/law/restitution.h"

#include <stdio.h>
#include <string.h>

double dem_need(tdm_object *o, const char *key, const char *family, const char *law, tdm_range range) {
  bool before = o->err->status != TDM_OK, missing = !tdm_has(o, key);
  double value = tdm_get_number(o, key, TDM_REQUIRED, range);
  if (missing && !before) {
    char *message = o->err->message;
    size_t used = strlen(message);
    snprintf(message + used, sizeof o->err->message - used, " (%s \"%s\" needs it)", family, law);
  }
  return value;
}

bool dem_one_of(tdm_object *o, const char *first, const char *second, const char *law) {
  if (tdm_has(o, first) && tdm_has(o, second))
    tdm_object_fail(o, second, "excludes \"%s\"; normal \"%s\" takes one of them", first, law);
  return tdm_has(o, first) || !tdm_has(o, second);
}

double dem_get_restitution(tdm_object *o, double fallback) {
  double e = tdm_get_number(o, "restitution", fallback, TDM_UNIT_INTERVAL);
  if (e <= 0)
    tdm_object_fail(o, "restitution",
                    "is 0 but must be greater than 0 and at most 1; a small value such as 0.01 "
                    "takes nearly all the energy");
  return e > 0 ? e : 1;
}

void dem_set_restitution(const dem_model *m, dem_pair *p, double e, tdm_error *err, const char *path) {
  p->restitution = e;
  p->beta = dem_beta_keep(e);
  p->viscosity = 0;
  const dem_normal_law *law = dem_normal_of(m, p);
  tdm_status status = law->damp ? law->damp(m, p) : TDM_OK;
  if (status == TDM_ERR_MEMORY)
    tdm_fail(err, status, path, "no memory to find the damping");
  else if (status)
    tdm_fail(err, TDM_ERR_SCENE, path, "is %g, too small for \"tail\": \"clip\"; give at least 0.001", e);
  if (m->tangential->damp)
    m->tangential->damp(m, p);
}

void dem_read_restitution(const dem_model *m, tdm_object *o, dem_pair *p) {
  char place[TDM_PATH_MAX];
  double e = dem_get_restitution(o, TDM_REQUIRED);
  if (!o->err->status)
    dem_set_restitution(m, p, e, o->err, tdm_path(place, o, "restitution", -1));
}
