/* The table of motion laws, and reading one. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/motion/motion.h"

#include <math.h>
#include <stdlib.h>

#define TDM_MOTION_LIST(X) \
  X(constant_rate)         \
  X(constant)              \
  X(polynomial)            \
  X(harmonic)              \
  X(table)                 \
  X(step)                  \
  X(ramp)                  \
  X(triangle)              \
  X(sum)

#define X(name) extern const tdm_motion_ops tdm_motion_##name;
TDM_MOTION_LIST(X)
#undef X

#define X(name) &tdm_motion_##name,
tdm_types tdm_motion_types = {{TDM_MOTION_LIST(X)}};
#undef X

tdm_status tdm_motion_add(const tdm_motion_ops *ops, tdm_error *err) {
  return tdm_type_add(&tdm_motion_types, ops, err);
}

void tdm_motion_read_law(tdm_motion *motion, tdm_object *o) {
  const tdm_motion_ops *ops = tdm_get_type(o, &tdm_motion_types);
  if (o->err->status)
    return;
  motion->own = calloc(1, ops->size);
  if (!motion->own) {
    tdm_object_fail(o, NULL, "no memory for the motion law");
    o->err->status = TDM_ERR_MEMORY;
    return;
  }
  motion->ops = ops;
  motion->range = (tdm_motion_range){-INFINITY, INFINITY};
  motion->ops->read(motion->own, o, &motion->range);
  tdm_object_close(o);
}

void tdm_motion_read(tdm_motion *motion, tdm_object *owner, const char *key) {
  tdm_object o = tdm_get_object(owner, key, true);
  tdm_motion_read_law(motion, &o);
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
