/* Translational spring-damper between two points: tension f = k (l - l0) + c ldot + preload along the line through
 * them, or with tables for k and c. Where the points coincide, a spring without free length and preload pulls nowhere
 * and its damper works along the velocity v of the points: force -(k d + c v) there, d from point to point. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/laws.h"

static void read(mbd_force *f, tdm_object *o, const mbd_model *model) {
  mbd_spring *s = f->own;
  double length = mbd_force_read_points(f, o, model, false);
  bool part = length > mbd_force_no_length;
  mbd_spring_read(s, o);
  s->free = tdm_get_number(o, "free_length", part ? length : 0, TDM_NOT_NEGATIVE);
  if (o->err->status || part)
    return;
  double rest = mbd_spring_law(s, 0, 0).f;
  if (s->free > 0)
    tdm_object_fail(o, "points",
                    "coincide, so that the spring, whose free length is %g m, has no direction to push in; move one of "
                    "them, or give \"free_length\": 0",
                    s->free);
  else if (rest != 0)
    tdm_object_fail(o, "points",
                    "coincide, so that the force of %g N that the spring has there has no direction; move one of them, "
                    "or take the preload away",
                    rest);
}

/* at coinciding points, along three axes of the world */
static void without_length(const mbd_force *f, const mbd_kin *a, const mbd_kin *b, mbd_force_value *out) {
  const mbd_spring *s = f->own;
  mbd_rows_point(&out->rows, a, b, mbd_joint_arm(&f->frame, 0, a), mbd_joint_arm(&f->frame, 1, b));
  double rate[3], force[3], by_x[9] = {0}, by_rate[9] = {0}, *d = out->rows.g;
  mbd_force_rates(out, a, b, rate);
  double length = tdm_norm(mbd_get3(d)), speed = tdm_norm(mbd_get3(rate));
  mbd_scalar spring = mbd_spring_law(s, length, 0), both = mbd_spring_law(s, length, speed);
  double damping = speed > 0 ? (both.f - spring.f) / speed : spring.by_rate;
  for (int i = 0; i < 3; i++) {
    force[i] = spring.by_x * d[i] + damping * rate[i];
    by_x[4 * i] = spring.by_x;
    by_rate[4 * i] = damping;
  }
  mbd_force_apply(out, a, b, force, by_x, by_rate);
  out->value = both.f;
  out->coordinate = length;
  out->rate = speed;
  out->potential = spring.potential;
  out->dissipated = both.dissipated;
}

static void eval(const mbd_force *f, const mbd_kin *a, const mbd_kin *b, mbd_force_value *out) {
  const mbd_spring *s = f->own;
  double rate, length = mbd_force_distance(f, a, b, out, &rate);
  if (s->free == 0 && !(length > mbd_force_no_length)) {
    out->rows.n = 0;
    without_length(f, a, b, out);
    return;
  }
  mbd_scalar law = mbd_spring_law(s, length, rate);
  mbd_force_apply_scalar(out, a, b, length, rate, &law);
}

static void clear(mbd_force *f) {
  mbd_spring_clear(f->own);
}

extern const mbd_force_ops mbd_force_spring_damper;
const mbd_force_ops mbd_force_spring_damper = {
    .name = "spring_damper",
    .size = sizeof(mbd_spring),
    .value_unit = "N",
    .coordinate_name = "length",
    .coordinate_unit = "m",
    .read = read,
    .eval = eval,
    .spans = true,
    .line = TDM_VIEW_LINE_spring,
    .clear = clear,
};
