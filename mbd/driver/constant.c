/* Constant value: a lock. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/driver/motion.h"

static void load(mbd_motion *motion, tdm_object *o) {
  motion->from = tdm_get_number(o, "value", 0, TDM_ANY);
}

static mbd_motion_value eval(const mbd_motion *motion, double t) {
  (void)t;
  return (mbd_motion_value){motion->from, 0, 0};
}

extern const mbd_motion_ops mbd_motion_constant;
const mbd_motion_ops mbd_motion_constant = {"constant", load, eval};
