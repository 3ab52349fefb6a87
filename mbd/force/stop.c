/* Stop: limits of a joint's coordinate that push back like a contact and never pull. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/laws.h"

#include <string.h>

typedef struct {
  mbd_contact contact;
  double range[2]; /* lower and upper limit of the coordinate [m, rad] */
} stop;

static void read(mbd_force *f, tdm_object *o, const mbd_model *model) {
  stop *s = f->own;
  f->joint = mbd_read_joint_coordinate(o, model, &f->coordinate);
  if (!f->joint)
    return;
  memcpy(f->body, f->joint->body, sizeof f->body);
  bool lower = tdm_has(o, "lower"), upper = tdm_has(o, "upper");
  s->range[0] = lower ? tdm_get_number(o, "lower", TDM_REQUIRED, TDM_ANY) : -INFINITY;
  s->range[1] = upper ? tdm_get_number(o, "upper", TDM_REQUIRED, TDM_ANY) : INFINITY;
  if (!o->err->status && !lower && !upper)
    tdm_object_fail(o, "upper", "is missing; give \"lower\", \"upper\" or both");
  else if (!o->err->status && !(s->range[0] < s->range[1]))
    tdm_object_fail(o, "upper", "is %g, not above \"lower\", %g", s->range[1], s->range[0]);
  mbd_contact_read(&s->contact, o);
}

static void eval(const mbd_force *f, const mbd_kin *a, const mbd_kin *b, mbd_force_value *out) {
  const stop *s = f->own;
  double rate, x = mbd_force_coordinate(f, a, b, out, &rate);
  mbd_scalar law = mbd_contact_law(&s->contact, x - s->range[1], rate);
  if (x < s->range[0]) {
    law = mbd_contact_law(&s->contact, s->range[0] - x, -rate);
    law.f = -law.f;
  }
  mbd_force_apply_scalar(out, a, b, x, rate, &law);
}

extern const mbd_force_ops mbd_force_stop;
const mbd_force_ops mbd_force_stop = {
    .name = "stop",
    .size = sizeof(stop),
    .read = read,
    .eval = eval,
};
