/* Dry friction on the coordinate of a joint: f = limit tanh(rate/scale) + viscous rate, Coulomb's law made smooth. It
 * creeps under a load below the limit instead of sticking, at a rate that goes to zero with the scale. */
#include "mbd/force/force.h"
#include "mbd/load.h"

#include <string.h>

/* "limit", or coefficient times preload (times the radius at which it acts for a torque) */
static double load_limit(const mbd_force *f, tdm_object *o) {
  if (!tdm_has(o, "coefficient"))
    return tdm_get_number(o, "limit", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  if (tdm_has(o, "limit"))
    tdm_object_fail(o, "limit", "stands beside \"coefficient\"; keep one of the two");
  double limit = tdm_get_number(o, "coefficient", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  limit *= tdm_get_number(o, "preload", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  return f->coordinate == MBD_ANGLE ? limit * tdm_get_number(o, "radius", TDM_REQUIRED, TDM_POSITIVE) : limit;
}

static void load(mbd_force *f, tdm_object *o, const mbd_model *model) {
  f->joint = mbd_load_joint_coordinate(o, model, &f->coordinate);
  if (!f->joint)
    return;
  memcpy(f->body, f->joint->body, sizeof f->body);
  f->limit = load_limit(f, o);
  f->scale = tdm_get_number(o, "velocity_scale", TDM_REQUIRED, TDM_POSITIVE);
  f->damping = tdm_get_number(o, "viscous", 0, TDM_NOT_NEGATIVE);
}

static void eval(const mbd_force *f, const mbd_kin *a, const mbd_kin *b, mbd_force_value *out) {
  double rate, x = mbd_force_coordinate(f, a, b, out, &rate), part = tanh(rate / f->scale);
  mbd_scalar law = {.f = f->limit * part + f->damping * rate,
                    .by_rate = f->limit * (1 - part * part) / f->scale + f->damping};
  law.dissipated = law.f * rate;
  mbd_force_apply_scalar(out, a, b, x, rate, &law);
}

extern const mbd_force_ops mbd_force_friction;
const mbd_force_ops mbd_force_friction = {"friction", NULL, NULL, NULL, load, eval, false};
