/* Coupler: s_1 q_1 + s_2 q_2 (+ s_3 q_3) = 0 for coordinates of two or three joints, each an angle, counted over turns,
 * or a translation. One row. Three angles make a differential, two translations a pulley block.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

#include <string.h>

typedef struct {
  mbd_coordinate which[MBD_COUPLED_MAX];
  double scale[MBD_COUPLED_MAX]; /* [1/rad] or [1/m], up to a common factor */
} coupler;

static const char *const equation[] = {"coupling"};

/* "coordinates", needed where a joint has both. */
static void read_coordinates(coupler *own, tdm_object *o, const mbd_joint *const of[], int n) {
  static const char *const names[] = {[MBD_ANGLE] = "angle", [MBD_TRANSLATION] = "translation"};
  json_t *list = tdm_get_array(o, "coordinates", false);
  if (list && (int)json_array_size(list) != n)
    tdm_object_fail(o, "coordinates", "has %zu entries, but there are %d joints; give one for each",
                    json_array_size(list), n);
  for (int k = 0; k < n && !o->err->status; k++) {
    const char *name = json_string_value(json_array_get(list, (size_t)k));
    const unsigned has = of[k]->ops->coordinates;
    unsigned wanted = 0;
    for (int i = 0; i < 2; i++)
      wanted |= !list || (name && strcmp(name, names[i]) == 0) ? has & 1u << i : 0;
    own->which[k] = wanted == MBD_HAS_TRANSLATION ? MBD_TRANSLATION : MBD_ANGLE;
    if (wanted != MBD_HAS_ANGLE && wanted != MBD_HAS_TRANSLATION)
      tdm_object_fail(o, "coordinates", "give \"angle\" or \"translation\" for each joint, as it has it: \"%s\" is %s",
                      of[k]->name, of[k]->ops->name);
  }
}

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  static const unsigned any[MBD_COUPLED_MAX] = {
      MBD_HAS_ANGLE | MBD_HAS_TRANSLATION, MBD_HAS_ANGLE | MBD_HAS_TRANSLATION, MBD_HAS_ANGLE | MBD_HAS_TRANSLATION};
  coupler *own = joint->own;
  const int n = mbd_read_joints(o, model, MBD_COUPLED_MAX, any, joint->of);
  if (o->err->status)
    return;
  read_coordinates(own, o, joint->of, n);
  tdm_get_numbers(o, "scales", own->scale, n, true);
  for (int k = 0; k < n && !o->err->status; k++)
    if (own->scale[k] == 0)
      tdm_object_fail(o, "scales", "that of \"%s\" is zero; give another number, or leave the joint away",
                      joint->of[k]->name);
  if (!o->err->status)
    mbd_joint_between(joint);
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  const coupler *own = j->own;
  const int k = rows->part;
  const double from = own->which[k] == MBD_ANGLE ? rows->turn : 0; /* the angle is found near it */
  mbd_joint_coordinate(j->of[k], own->which[k], a, b, from, rows);
  rows->g[0] += from;
  mbd_rows_scale(rows, own->scale[k]);
}

extern const mbd_joint_ops mbd_joint_coupler;
const mbd_joint_ops mbd_joint_coupler = {
    .name = "coupler",
    .size = sizeof(coupler),
    .nrow = 1,
    .equation = equation,
    .read = read,
    .eval = eval,
    .couples = true,
    .counts = true,
};
