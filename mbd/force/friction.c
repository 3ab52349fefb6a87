/* Dry friction on the coordinate of a joint: Coulomb's law, which sticks (stick.h), with Stribeck's fall from the
 * coefficient at rest to that in motion,
 *   f = way level(rate) normal + viscous rate,   level = slide + (hold - slide) exp(-(rate/scale)^2)
 * (Armstrong-Helouvry, Dupont & Canudas de Wit 1994, Automatica 30, 1083-1138, Eq. 3). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/force.h"

#include <string.h>

typedef struct {
  mbd_rubbing rubbing;
  double slide;   /* coefficient of friction in motion [1]; or the limit itself [N, N m] */
  double scale;   /* Stribeck velocity [m/s, rad/s], 0: the coefficient at rest counts there alone */
  double viscous; /* [N s/m, N m s/rad] */
} friction;

/* `key`: one number, or {"static", "dynamic"} */
static void read_levels(friction *own, tdm_object *o, const char *key) {
  if (!json_is_object(json_object_get(o->json, key))) {
    own->rubbing.hold = own->slide = tdm_get_number(o, key, TDM_REQUIRED, TDM_NOT_NEGATIVE);
    return;
  }
  tdm_object both = tdm_get_object(o, key, true);
  own->rubbing.hold = tdm_get_number(&both, "static", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  own->slide = tdm_get_number(&both, "dynamic", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  if (!o->err->status && own->rubbing.hold < own->slide)
    tdm_object_fail(&both, "static", "is %g but must be at least the dynamic one, %g", own->rubbing.hold, own->slide);
  tdm_object_close(&both);
}

/* What the coefficient multiplies: a preload, and the joint's own reaction. */
static void read_normal(mbd_force *f, tdm_object *o) {
  mbd_rubbing *r = f->rubbing;
  const bool torque = f->coordinate == MBD_ANGLE;
  r->reacts = tdm_get_bool(o, "reaction", true);
  r->base = tdm_get_number(o, "preload", r->reacts ? 0 : TDM_REQUIRED, TDM_NOT_NEGATIVE);
  double radius = torque || tdm_has(o, "radius") ? tdm_get_number(o, "radius", TDM_REQUIRED, TDM_POSITIVE) : 0;
  r->base *= torque ? radius : 1;
  if (!r->reacts)
    return;
  r->across = torque ? radius : 1;
  r->along = torque ? tdm_get_number(o, "thrust_radius", radius, TDM_NOT_NEGATIVE) : 0;
  r->about = torque || radius == 0 ? 0 : 1 / radius;
  r->length = tdm_has(o, "length") ? tdm_get_number(o, "length", TDM_REQUIRED, TDM_POSITIVE) : 0;
}

static void read(mbd_force *f, tdm_object *o, const mbd_model *model) {
  friction *own = f->own;
  mbd_rubbing *r = f->rubbing = &own->rubbing;
  f->joint = mbd_read_joint_coordinate(o, model, &f->coordinate);
  if (!f->joint)
    return;
  memcpy(f->body, f->joint->body, sizeof f->body);
  r->base = 1;
  if (!tdm_has(o, "coefficient")) {
    read_levels(own, o, "limit");
  } else if (tdm_has(o, "limit")) {
    tdm_object_fail(o, "limit", "stands beside \"coefficient\"; keep one of the two");
  } else {
    read_levels(own, o, "coefficient");
    read_normal(f, o);
  }
  own->scale = tdm_has(o, "velocity_scale") ? tdm_get_number(o, "velocity_scale", TDM_REQUIRED, TDM_POSITIVE) : 0;
  own->viscous = tdm_get_number(o, "viscous", 0, TDM_NOT_NEGATIVE);
}

static double level(const mbd_force *f, double rate, double *slope) {
  const friction *own = f->own;
  double x = own->scale > 0 ? rate / own->scale : 0,
         more = own->scale > 0 ? (own->rubbing.hold - own->slide) * exp(-x * x) : 0;
  *slope = own->scale > 0 ? -2 * x / own->scale * more : 0;
  return own->slide + more;
}

static void eval(const mbd_force *f, const mbd_kin *a, const mbd_kin *b, mbd_force_value *out) {
  const friction *own = f->own;
  double rate, slope, x = mbd_force_coordinate(f, a, b, out, &rate), size = out->way * out->normal;
  mbd_scalar law = {.f = size * level(f, rate, &slope) + own->viscous * rate};
  law.by_rate = size * slope + own->viscous;
  law.dissipated = law.f * rate;
  mbd_force_apply_scalar(out, a, b, x, rate, &law);
}

extern const mbd_force_ops mbd_force_friction;
const mbd_force_ops mbd_force_friction = {
    .name = "friction",
    .size = sizeof(friction),
    .read = read,
    .eval = eval,
    .level = level,
};
