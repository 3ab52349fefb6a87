/* The table of motion laws, and reading one. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/driver/motion.h"

#include <stdlib.h>

extern const mbd_motion_ops mbd_motion_constant_rate, mbd_motion_constant, mbd_motion_polynomial, mbd_motion_harmonic,
    mbd_motion_table_law, mbd_motion_step;

const mbd_motion_ops *const mbd_motion_table[] = {&mbd_motion_constant_rate, &mbd_motion_constant,
                                                  &mbd_motion_polynomial,    &mbd_motion_harmonic,
                                                  &mbd_motion_table_law,     &mbd_motion_step};
const int mbd_motion_ntype = sizeof mbd_motion_table / sizeof mbd_motion_table[0];

void mbd_motion_read(mbd_motion *motion, tdm_object *owner, const char *key) {
  tdm_object o = tdm_get_object(owner, key, true);
  const char *names[MBD_MOTION_TYPES_MAX];
  for (int i = 0; i < mbd_motion_ntype; i++)
    names[i] = mbd_motion_table[i]->name;
  int type = tdm_get_choice(&o, "type", names, mbd_motion_ntype, -1);
  if (o.err->status)
    return;
  motion->ops = mbd_motion_table[type];
  motion->ops->load(motion, &o);
  tdm_object_close(&o);
}

void mbd_motion_clear(mbd_motion *motion) {
  free(motion->coefficient);
  motion->coefficient = NULL;
  mbd_curve_destroy(&motion->curve);
}

tdm_status mbd_motion_check(const mbd_motion *motion, double t0, double t1, const char *path, const char *name,
                            tdm_error *err) {
  const double *range = motion->range, slack = 1e-9 * (fabs(t0) + fabs(t1));
  if (!motion->limited || (t0 >= range[0] - slack && t1 <= range[1] + slack))
    return TDM_OK;
  if (t0 < range[0] - slack)
    return tdm_fail(err, TDM_ERR_SCENE, path,
                    "the table of \"%s\" begins at t = %.9g s, after %.9g s; begin it earlier", name, range[0], t0);
  return tdm_fail(
      err, TDM_ERR_SCENE, path,
      "the table of \"%s\" ends at t = %.9g s, before %.9g s; go on with it, end the run earlier, or let it "
      "end at rest and set \"after\": \"hold\"",
      name, range[1], t1);
}
