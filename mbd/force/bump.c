/* Bump: unilateral contact without friction between a sphere of the second body and a plane of the first (that body is
 * on the side against the normal), or between two spheres. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/force/laws.h"

#include <string.h>

typedef struct {
  mbd_contact contact;
  double radius; /* distance of the points, or of point and plane, at contact [m] */
  bool plane;    /* a plane of the first body */
} bump;

static void read_plane(mbd_force *f, tdm_object *o, const mbd_model *model) {
  bump *u = f->own;
  tdm_vec3 point = mbd_read_point(o, model, "point"), foot = mbd_read_point(o, model, "plane_point");
  mbd_joint_set_frame(&f->frame, model, foot, mbd_read_direction(o, model, "normal"));
  f->frame.arm[1] = mbd_model_arm(model, f->body[1], point);
  u->radius = tdm_get_number(o, "radius", 0, TDM_NOT_NEGATIVE);
  u->plane = true;
}

static void read_spheres(mbd_force *f, tdm_object *o, const mbd_model *model) {
  bump *u = f->own;
  double radii[2] = {0, 0};
  mbd_force_read_points(f, o, model, true);
  tdm_get_numbers(o, "radii", radii, 2, true);
  u->radius = radii[0] + radii[1];
  if (!o->err->status && (radii[0] < 0 || radii[1] < 0 || !(u->radius > 0)))
    tdm_object_fail(o, "radii", "are %g and %g m; give radii of which one is positive and none negative", radii[0],
                    radii[1]);
}

static void read(mbd_force *f, tdm_object *o, const mbd_model *model) {
  if (tdm_has(o, "normal")) {
    mbd_read_bodies(o, model, f->body);
    memcpy(f->frame.body, f->body, sizeof f->body);
    read_plane(f, o, model);
  } else
    read_spheres(f, o, model);
  mbd_contact_read(&((bump *)f->own)->contact, o);
}

static void eval(const mbd_force *f, const mbd_kin *a, const mbd_kin *b, mbd_force_value *out) {
  const bump *u = f->own;
  double rate, gap;
  if (u->plane) {
    mbd_joint_coordinate(&f->frame, MBD_TRANSLATION, a, b, 0, &out->rows);
    mbd_force_rates(out, a, b, &rate);
    gap = out->rows.g[0] - u->radius;
  } else
    gap = mbd_force_distance(f, a, b, out, &rate) - u->radius;
  mbd_scalar law = mbd_contact_law(&u->contact, -gap, -rate);
  law.f = -law.f;
  mbd_force_apply_scalar(out, a, b, gap, rate, &law);
  out->value = -law.f;
}

extern const mbd_force_ops mbd_force_bump;
const mbd_force_ops mbd_force_bump = {
    .name = "bump",
    .size = sizeof(bump),
    .value_unit = "N",
    .coordinate_name = "gap",
    .coordinate_unit = "m",
    .read = read,
    .eval = eval,
};
