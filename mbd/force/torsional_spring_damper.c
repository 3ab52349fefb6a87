/* Torsional spring-damper: torque k (theta - theta0) + c thetadot + preload on the rotation theta of the second body
 * against the first about an axis since the start, counted over turns; or with tables for k and c. A positive torque
 * turns the second body back. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/laws.h"

#include <string.h>

static void read(mbd_force *f, tdm_object *o, const mbd_model *model) {
  mbd_spring *s = f->own;
  f->coordinate = MBD_ANGLE;
  f->joint = &f->frame;
  if (tdm_has(o, "joint")) {
    f->joint = mbd_read_joint(o, "joint", model, MBD_HAS_ANGLE, ", or give \"bodies\" and \"axis\"");
    if (!f->joint)
      return;
    memcpy(f->body, f->joint->body, sizeof f->body);
  } else {
    mbd_read_bodies(o, model, f->body);
    memcpy(f->frame.body, f->body, sizeof f->body);
    mbd_joint_set_frame(&f->frame, model, tdm_v3(0, 0, 0), mbd_read_direction(o, model, "axis"));
  }
  mbd_spring_read(s, o);
  s->free = tdm_get_number(o, "free_angle", 0, TDM_ANY);
}

static void eval(const mbd_force *f, const mbd_kin *a, const mbd_kin *b, mbd_force_value *out) {
  double rate, angle = mbd_force_coordinate(f, a, b, out, &rate);
  mbd_scalar law = mbd_spring_law(f->own, angle, rate);
  mbd_force_apply_scalar(out, a, b, angle, rate, &law);
}

static void clear(mbd_force *f) {
  mbd_spring_clear(f->own);
}

extern const mbd_force_ops mbd_force_torsional_spring_damper;
const mbd_force_ops mbd_force_torsional_spring_damper = {
    .name = "torsional_spring_damper",
    .size = sizeof(mbd_spring),
    .value_unit = "N m",
    .coordinate_name = "angle",
    .coordinate_unit = "rad",
    .read = read,
    .eval = eval,
    .twists = true,
    .line = TDM_VIEW_LINE_spring,
    .clear = clear,
};
