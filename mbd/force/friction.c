/* Dry friction on the coordinate of a joint: Coulomb's law, which sticks (stick.h), with Stribeck's fall from the
 * coefficient at rest to that in motion,
 *   f = way level(rate) normal + viscous rate,   level = slide + (hold - slide) exp(-(rate/scale)^2)
 * (Armstrong-Helouvry, Dupont & Canudas de Wit 1994, Automatica 30, 1083-1138, Eq. 3). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/force.h"
#include "mbd/model/read.h"

#include <string.h>

/* `key`: one number, or {"static", "dynamic"} */
static void load_levels(mbd_rubbing *r, tdm_object *o, const char *key) {
  if (!json_is_object(json_object_get(o->json, key))) {
    r->hold = r->slide = tdm_get_number(o, key, TDM_REQUIRED, TDM_NOT_NEGATIVE);
    return;
  }
  tdm_object both = tdm_get_object(o, key, true);
  r->hold = tdm_get_number(&both, "static", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  r->slide = tdm_get_number(&both, "dynamic", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  if (!o->err->status && r->hold < r->slide)
    tdm_object_fail(&both, "static", "is %g but must be at least the dynamic one, %g", r->hold, r->slide);
  tdm_object_close(&both);
}

/* What the coefficient multiplies: a preload, and the joint's own reaction. */
static void load_normal(mbd_force *f, tdm_object *o) {
  mbd_rubbing *r = &f->rubbing;
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

static void load(mbd_force *f, tdm_object *o, const mbd_model *model) {
  mbd_rubbing *r = &f->rubbing;
  f->joint = mbd_read_joint_coordinate(o, model, &f->coordinate);
  if (!f->joint)
    return;
  memcpy(f->body, f->joint->body, sizeof f->body);
  r->base = 1;
  if (!tdm_has(o, "coefficient")) {
    load_levels(r, o, "limit");
  } else if (tdm_has(o, "limit")) {
    tdm_object_fail(o, "limit", "stands beside \"coefficient\"; keep one of the two");
  } else {
    load_levels(r, o, "coefficient");
    load_normal(f, o);
  }
  r->scale = tdm_has(o, "velocity_scale") ? tdm_get_number(o, "velocity_scale", TDM_REQUIRED, TDM_POSITIVE) : 0;
  f->damping = tdm_get_number(o, "viscous", 0, TDM_NOT_NEGATIVE);
}

double mbd_friction_level(const mbd_force *f, double rate, double *slope) {
  const mbd_rubbing *r = &f->rubbing;
  double x = r->scale > 0 ? rate / r->scale : 0, more = r->scale > 0 ? (r->hold - r->slide) * exp(-x * x) : 0;
  *slope = r->scale > 0 ? -2 * x / r->scale * more : 0;
  return r->slide + more;
}

static void eval(const mbd_force *f, const mbd_kin *a, const mbd_kin *b, mbd_force_value *out) {
  double rate, slope, x = mbd_force_coordinate(f, a, b, out, &rate), size = out->way * out->normal;
  mbd_scalar law = {.f = size * mbd_friction_level(f, rate, &slope) + f->damping * rate};
  law.by_rate = size * slope + f->damping;
  law.dissipated = law.f * rate;
  mbd_force_apply_scalar(out, a, b, x, rate, &law);
}

extern const mbd_force_ops mbd_force_friction;
const mbd_force_ops mbd_force_friction = {.name = "friction", .load = load, .eval = eval, .sticks = true};
