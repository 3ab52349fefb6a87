/* Cable: a spring-damper that pulls but never pushes.
 *
 * Its stiffness sets in over the length e after the stretch s = l - l0 has passed 0: spring force k s^2/(2e) up to s =
 * e, k (s - e/2) after it. The damping grows with the stiffness, so that the tension k s^2/(2e) + c s/e ldot is
 * continuous; it is cut off at zero. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/force.h"

typedef struct {
  double stiffness, damping; /* [N/m], [N s/m] */
  double free;               /* length without tension [m] */
  double smoothing;          /* length over which the stiffness sets in [m] */
} cable;

static void read(mbd_force *f, tdm_object *o, const mbd_model *model) {
  cable *c = f->own;
  double length = mbd_force_read_points(f, o, model, true);
  c->stiffness = tdm_get_number(o, "stiffness", TDM_REQUIRED, TDM_POSITIVE);
  c->damping = tdm_get_number(o, "damping", 0, TDM_NOT_NEGATIVE);
  c->free = tdm_get_number(o, "free_length", length, TDM_POSITIVE);
  c->smoothing = tdm_get_number(o, "smoothing", 1e-3 * c->free, TDM_POSITIVE);
}

static mbd_scalar tension(const cable *c, double stretch, double rate) {
  const double e = c->smoothing, k = c->stiffness;
  mbd_scalar law = {0, 0, 0, 0, 0};
  if (!(stretch > 0))
    return law;
  double part = fmin(1, stretch / e), beyond = stretch - 0.5 * e;
  double elastic = stretch < e ? 0.5 * k * stretch * part : k * beyond, damping = c->damping * part;
  law.potential = stretch < e ? k * stretch * stretch * part / 6 : 0.5 * k * (beyond * beyond + e * e / 12);
  if (elastic + damping * rate > 0) {
    law.f = elastic + damping * rate;
    law.by_x = k * part + (stretch < e ? c->damping * rate / e : 0);
    law.by_rate = damping;
  }
  law.dissipated = (law.f - elastic) * rate;
  return law;
}

static void eval(const mbd_force *f, const mbd_kin *a, const mbd_kin *b, mbd_force_value *out) {
  const cable *c = f->own;
  double rate, length = mbd_force_distance(f, a, b, out, &rate);
  mbd_scalar law = tension(c, length - c->free, rate);
  mbd_force_apply_scalar(out, a, b, length, rate, &law);
}

extern const mbd_force_ops mbd_force_cable;
const mbd_force_ops mbd_force_cable = {
    .name = "cable",
    .size = sizeof(cable),
    .value_unit = "N",
    .coordinate_name = "length",
    .coordinate_unit = "m",
    .read = read,
    .eval = eval,
    .spans = true,
    .line = TDM_VIEW_LINE_cable,
};
