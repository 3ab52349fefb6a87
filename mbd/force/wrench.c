/* Wrench: a force and a moment from outside on one body, in axes of the world or of the body, times a factor that may
 * be a function of time. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/force.h"
#include "protocol/motion/motion.h"

#include <stdio.h>

typedef struct {
  tdm_vec3 force, moment; /* at factor 1 [N, N m] */
  bool follows;           /* it turns with the body */
  tdm_motion factor;      /* over time; no law: 1 */
} wrench;

static void read(mbd_force *f, tdm_object *o, const mbd_model *model) {
  wrench *w = f->own;
  static const char *const axes[] = {"world", "body"};
  const tdm_vec3 zero = {0, 0, 0};
  f->body[0] = MBD_GROUND;
  f->body[1] = mbd_read_body(o, model);
  if (tdm_has(o, "point"))
    f->frame.arm[1] = mbd_model_arm(model, f->body[1], mbd_read_point(o, model, "point"));
  w->force = tdm_get_vec3(o, "force", &zero);
  w->moment = tdm_get_vec3(o, "moment", &zero);
  w->follows = tdm_get_choice(o, "axes", axes, 2, 0) == 1;
  if (tdm_has(o, "factor"))
    tdm_motion_read(&w->factor, o, "factor");
  if (!o->err->status && !(tdm_norm(w->force) + tdm_norm(w->moment) > 0))
    tdm_object_fail(o, "force", "and \"moment\" are zero; give one of them");
}

static void eval(const mbd_force *f, const mbd_kin *a, const mbd_kin *b, mbd_force_value *out) {
  const wrench *w = f->own;
  (void)a;
  double factor = w->factor.ops ? tdm_motion_at(&w->factor, out->now).value : 1;
  tdm_vec3 arm = mbd_joint_arm(&f->frame, 1, b), force = tdm_scale(factor, w->force);
  tdm_vec3 moment = tdm_scale(factor, w->moment);
  if (w->follows) {
    force = tdm_m3_mul(b->A, force);
    moment = tdm_m3_mul(b->A, moment);
  }
  tdm_vec3 total = tdm_add(moment, tdm_cross(arm, force));
  mbd_put3(out->Q + MBD_RB, 1, force);
  mbd_put3(out->Q + MBD_TB, 1, total);
  out->value = factor * tdm_norm(w->force);
  out->coordinate = factor;
  out->supplied = tdm_dot(force, b->v) + tdm_dot(total, b->w);
  if (!out->second)
    return;
  if (w->follows) { /* d(a) = -[a] dtheta of a body-fixed vector a */
    mbd_put33(out->K, MBD_RB, MBD_TB, -1, tdm_m3_skew(force));
    mbd_put33(out->K, MBD_TB, MBD_TB, -1, tdm_m3_skew(total));
  } else /* d(s x f) = [f][s] dtheta */
    mbd_put33(out->K, MBD_TB, MBD_TB, 1, mbd_skew2(force, arm));
}

static tdm_status check_times(const mbd_force *f, double t0, double t1, const char *path, tdm_error *err) {
  char at[TDM_PATH_MAX];
  snprintf(at, sizeof at, "%s.factor", path);
  return tdm_motion_check(&((const wrench *)f->own)->factor, t0, t1, at, f->name, err);
}

static const tdm_motion *law(const mbd_force *f) {
  const tdm_motion *factor = &((const wrench *)f->own)->factor;
  return factor->ops ? factor : NULL;
}

static void clear(mbd_force *f) {
  tdm_motion_clear(&((wrench *)f->own)->factor);
}

extern const mbd_force_ops mbd_force_wrench;
const mbd_force_ops mbd_force_wrench = {
    .name = "wrench",
    .size = sizeof(wrench),
    .value_unit = "N",
    .coordinate_name = "factor",
    .coordinate_unit = "1",
    .read = read,
    .eval = eval,
    .check_times = check_times,
    .law = law,
    .clear = clear,
};
