/* Translational spring-damper between two points: tension f = k (l - l0) + c ldot + preload along the line through
 * them, or with tables for k and c. */
#include "mbd/force/force.h"
#include "mbd/load.h"

static void load(mbd_force *f, tdm_object *o, const mbd_model *model) {
  double length = mbd_force_load_points(f, o, model);
  mbd_spring_load(f, o);
  f->free = tdm_get_number(o, "free_length", length, TDM_NOT_NEGATIVE);
}

static void eval(const mbd_force *f, const mbd_kin *a, const mbd_kin *b, mbd_force_value *out) {
  double rate, length = mbd_force_distance(f, a, b, out, &rate);
  mbd_scalar law = mbd_spring_law(f, length, rate);
  mbd_force_apply_scalar(out, a, b, length, rate, &law);
}

extern const mbd_force_ops mbd_force_spring_damper;
const mbd_force_ops mbd_force_spring_damper = {"spring_damper", "N", "length", "m", load, eval, false, false};
