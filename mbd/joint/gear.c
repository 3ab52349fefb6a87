/* Gear pair: theta_1 + ratio theta_2 = 0 for the angles of two joints, each counted over turns. One row.
 *
 * A positive ratio, teeth of the second over teeth of the first, is an external mesh: the wheels turn against each
 * other. A negative one is an internal mesh or a belt. Joints whose first body is a carrier make a planetary gear.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

typedef struct {
  double ratio; /* teeth of the second wheel over teeth of the first */
} gear;

static const char *const equation[] = {"mesh"};

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  gear *own = joint->own;
  const unsigned coordinates[2] = {MBD_HAS_ANGLE, MBD_HAS_ANGLE};
  own->ratio =
      mbd_joint_read_mesh(joint, o, model, coordinates, "ratio", "teeth of the second wheel over teeth of the first");
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  const gear *own = j->own;
  mbd_joint_coordinate(j->of[rows->part], MBD_ANGLE, a, b, rows->turn, rows);
  rows->g[0] += rows->turn;
  if (rows->part == 1)
    mbd_rows_scale(rows, own->ratio);
}

extern const mbd_joint_ops mbd_joint_gear;
const mbd_joint_ops mbd_joint_gear = {
    .name = "gear",
    .size = sizeof(gear),
    .nrow = 1,
    .equation = equation,
    .read = read,
    .eval = eval,
    .couples = true,
    .counts = true,
};
