/* Drivers: a coordinate of a joint, or of two bodies without one, follows a motion law.
 *
 * A driver is one constraint row g = coordinate(q) - x(t), handled like a joint's rows; only its time derivatives are
 * its own (mbd_part_at sets them from the law). Its multiplier is the force or torque that it takes. A new driver
 * is one file in driver/ that says which coordinate it is and one row in driver/table.c.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MODEL_DRIVER_H
#define MBD_MODEL_DRIVER_H

#include "mbd/model/joint.h"
#include "protocol/motion/motion.h"

typedef struct mbd_driver mbd_driver;

typedef struct {
  const char *name;          /* first: as tdm_types asks */
  mbd_coordinate coordinate; /* of the joint */
  /* Read the type's own keys and set the joint; name, type and motion are read for it. */
  void (*read)(mbd_driver *driver, tdm_object *o, const mbd_model *model);
} mbd_driver_ops;

struct mbd_driver {
  char name[40];
  const mbd_driver_ops *ops;
  const mbd_joint *joint; /* whose coordinate it drives: one of the model's (borrowed), or `frame` */
  mbd_joint frame;        /* bodies, point and axis of a driver without a joint; it has no rows */
  int row;                /* its row among those of all joints and drivers */
  tdm_motion motion;
};

#endif
