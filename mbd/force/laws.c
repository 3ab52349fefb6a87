/* Laws of one coordinate that several forces share: see laws.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/laws.h"

#include <math.h>

/* Heat only: the table has the sign of the rate, and goes through zero. */
static void check_damper(const mbd_spring *s, tdm_object *o) {
  const double *x, *y;
  int n = tdm_spline_points(s->damper, &x, &y);
  bool zero = false;
  for (int i = 0; i < n; i++) {
    zero = zero || (x[i] == 0 && y[i] == 0);
    if (x[i] * y[i] < 0)
      tdm_object_fail(o, "damping_table", "drives the motion at the rate %g; give forces with the sign of the rate",
                      x[i]);
  }
  if (!zero)
    tdm_object_fail(o, "damping_table", "must contain the point (0, 0): a damper at rest has no force");
}

void mbd_spring_read(mbd_spring *s, tdm_object *o) {
  static const char *const between[] = {"cspline", "steffen"};
  if (tdm_has(o, "stiffness_table"))
    tdm_spline_read_table(&s->spring, o, "stiffness_table", tdm_get_choice(o, "interpolation", between, 2, 1) == 1);
  else
    s->stiffness = tdm_get_number(o, "stiffness", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  if (tdm_has(o, "damping_table"))
    tdm_spline_read_table(&s->damper, o, "damping_table", true);
  else
    s->damping = tdm_get_number(o, "damping", 0, TDM_NOT_NEGATIVE);
  s->preload = tdm_get_number(o, "preload", 0, TDM_ANY);
  if (s->damper && !o->err->status)
    check_damper(s, o);
}

mbd_scalar mbd_spring_law(const mbd_spring *s, double x, double rate) {
  double stretch = x - s->free;
  tdm_spline_value spring = {s->stiffness * stretch, s->stiffness, 0}, damper = {s->damping * rate, s->damping, 0};
  double potential = 0.5 * s->stiffness * stretch * stretch;
  if (s->spring) {
    spring = tdm_spline_at(s->spring, stretch);
    potential = tdm_spline_integral(s->spring, stretch);
  }
  if (s->damper)
    damper = tdm_spline_at(s->damper, rate);
  return (mbd_scalar){.f = spring.y + damper.y + s->preload,
                      .by_x = spring.slope,
                      .by_rate = damper.slope,
                      .potential = potential + s->preload * stretch,
                      .dissipated = damper.y * rate};
}

void mbd_spring_clear(mbd_spring *s) {
  tdm_spline_destroy(&s->spring);
  tdm_spline_destroy(&s->damper);
}

void mbd_contact_read(mbd_contact *c, tdm_object *o) {
  c->stiffness = tdm_get_number(o, "stiffness", TDM_REQUIRED, TDM_POSITIVE);
  c->exponent = tdm_get_number(o, "exponent", 1, TDM_POSITIVE);
  c->damping = tdm_get_number(o, "damping", 0, TDM_NOT_NEGATIVE);
  if (!o->err->status && c->exponent < 1)
    tdm_object_fail(o, "exponent",
                    "is %g; give 1 (a spring), 1.5 (Hertz) or more: below 1 the contact would begin "
                    "with an infinite stiffness",
                    c->exponent);
}

mbd_scalar mbd_contact_law(const mbd_contact *c, double penetration, double rate) {
  if (!(penetration > 0))
    return (mbd_scalar){0, 0, 0, 0, 0};
  double slope = c->stiffness * (c->exponent == 1 ? 1 : c->exponent * pow(penetration, c->exponent - 1));
  double elastic = slope * penetration / c->exponent, grip = 1 + c->damping * rate;
  mbd_scalar law = {.potential = elastic * penetration / (c->exponent + 1)};
  if (grip > 0) {
    law.f = elastic * grip;
    law.by_x = slope * grip;
    law.by_rate = elastic * c->damping;
  }
  law.dissipated = (law.f - elastic) * rate;
  return law;
}
