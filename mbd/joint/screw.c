/* Screw: a cylindrical joint whose translation is pitch/2pi times its angle, counted over turns. Five rows. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/joint/joint.h"

typedef struct {
  double ratio; /* way over angle [m/rad] */
} screw;

static const char *const equation[] = {"offset 1", "offset 2", "tilt 1", "tilt 2", "lead"};

static void read(mbd_joint *joint, tdm_object *o, const mbd_model *model) {
  screw *own = joint->own;
  mbd_joint_read_frame(joint, o, model, true);
  own->ratio = tdm_get_number(o, "pitch", TDM_REQUIRED, TDM_ANY) / (2 * M_PI);
  if (own->ratio == 0)
    tdm_object_fail(o, "pitch", "is zero; give the way of a turn, or use a revolute joint");
}

static void eval(const mbd_joint *j, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  const screw *own = j->own;
  mbd_joint_cylindrical.eval(j, a, b, rows);
  mbd_joint_coordinate(j, MBD_TRANSLATION, a, b, own->ratio * rows->turn, rows);
  mbd_joint_coordinate(j, MBD_ANGLE, a, b, rows->turn, rows);
  mbd_rows_merge(rows, -own->ratio);
}

extern const mbd_joint_ops mbd_joint_screw;
const mbd_joint_ops mbd_joint_screw = {
    .name = "screw",
    .size = sizeof(screw),
    .nrow = 5,
    .equation = equation,
    .read = read,
    .eval = eval,
    .coordinates = MBD_HAS_ANGLE | MBD_HAS_TRANSLATION,
    .counts = true,
};
