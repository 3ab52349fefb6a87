/* Constant value: a lock. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/motion/motion.h"

typedef struct {
  double value; /* [rad] or [m] */
} law;

static void read(void *own, tdm_object *o, tdm_motion_range *range) {
  law *l = own;
  (void)range;
  l->value = tdm_get_number(o, "value", 0, TDM_ANY);
}

static tdm_motion_value at(const void *own, double t) {
  const law *l = own;
  (void)t;
  return (tdm_motion_value){l->value, 0, 0};
}

extern const tdm_motion_ops tdm_motion_constant;
const tdm_motion_ops tdm_motion_constant = {
    .name = "constant",
    .size = sizeof(law),
    .read = read,
    .at = at,
};
