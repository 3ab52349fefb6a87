/* The table of motion laws, and reading one. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/motion/motion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

extern const tdm_motion_ops tdm_motion_constant_rate, tdm_motion_constant, tdm_motion_polynomial, tdm_motion_harmonic,
    tdm_motion_of_table, tdm_motion_step;

const tdm_motion_ops *tdm_motion_table[TDM_MOTION_TYPES_MAX] = {
    &tdm_motion_constant_rate, &tdm_motion_constant, &tdm_motion_polynomial,
    &tdm_motion_harmonic,      &tdm_motion_of_table, &tdm_motion_step,
};
int tdm_motion_ntype = 6;

bool tdm_motion_register(const tdm_motion_ops *ops) {
  for (int i = 0; i < tdm_motion_ntype; i++)
    if (strcmp(tdm_motion_table[i]->name, ops->name) == 0)
      return false;
  if (tdm_motion_ntype == TDM_MOTION_TYPES_MAX)
    return false;
  tdm_motion_table[tdm_motion_ntype++] = ops;
  return true;
}

void tdm_motion_read(tdm_motion *motion, tdm_object *owner, const char *key) {
  tdm_object o = tdm_get_object(owner, key, true);
  const char *names[TDM_MOTION_TYPES_MAX];
  for (int i = 0; i < tdm_motion_ntype; i++)
    names[i] = tdm_motion_table[i]->name;
  int type = tdm_get_choice(&o, "type", names, tdm_motion_ntype, -1);
  if (o.err->status)
    return;
  motion->own = calloc(1, tdm_motion_table[type]->size);
  if (!motion->own) {
    tdm_object_fail(&o, NULL, "no memory for the motion law");
    o.err->status = TDM_ERR_MEMORY;
    return;
  }
  motion->ops = tdm_motion_table[type];
  motion->range = (tdm_motion_range){-INFINITY, INFINITY};
  motion->ops->read(motion->own, &o, &motion->range);
  tdm_object_close(&o);
}

void tdm_motion_clear(tdm_motion *motion) {
  if (motion->ops && motion->ops->clear)
    motion->ops->clear(motion->own);
  free(motion->own);
  *motion = (tdm_motion){0};
}

tdm_status tdm_motion_check(const tdm_motion *motion, double t0, double t1, const char *path, const char *name,
                            tdm_error *err) {
  const double first = motion->range.first, last = motion->range.last, slack = 1e-9 * (fabs(t0) + fabs(t1));
  if (!motion->ops || (t0 >= first - slack && t1 <= last + slack))
    return TDM_OK;
  if (t0 < first - slack)
    return tdm_fail(err, TDM_ERR_SCENE, path,
                    "the table of \"%s\" begins at t = %.9g s, after %.9g s; begin it earlier", name, first, t0);
  return tdm_fail(
      err, TDM_ERR_SCENE, path,
      "the table of \"%s\" ends at t = %.9g s, before %.9g s; go on with it, end the run earlier, or let it "
      "end at rest and set \"after\": \"hold\"",
      name, last, t1);
}
