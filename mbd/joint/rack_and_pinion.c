/* Rack and pinion: the second joint's translation is radius times the first joint's angle, counted over turns. One row.
 * A negative radius turns the direction round. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

typedef struct {
  double ratio; /* radius of the pinion [m/rad] */
} rack;

static const char *const equation[] = {"mesh"};

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  rack *own = joint->own;
  const unsigned coordinates[2] = {MBD_HAS_ANGLE, MBD_HAS_TRANSLATION};
  own->ratio = mbd_joint_read_mesh(joint, o, model, coordinates, "radius", "the radius of the pinion's pitch circle");
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  const rack *own = j->own;
  if (rows->part == 0) {
    mbd_joint_coordinate(j->of[0], MBD_ANGLE, a, b, rows->turn, rows);
    rows->g[0] += rows->turn;
    mbd_rows_scale(rows, -own->ratio);
  } else
    mbd_joint_coordinate(j->of[1], MBD_TRANSLATION, a, b, 0, rows);
}

extern const mbd_joint_ops mbd_joint_rack_and_pinion;
const mbd_joint_ops mbd_joint_rack_and_pinion = {
    .name = "rack_and_pinion",
    .size = sizeof(rack),
    .nrow = 1,
    .equation = equation,
    .read = read,
    .eval = eval,
    .couples = true,
    .counts = true,
};
