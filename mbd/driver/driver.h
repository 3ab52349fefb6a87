/* Drivers: a coordinate of a joint, or of two bodies without one, follows a motion law.
 *
 * A driver is one constraint row g = coordinate(q) - x(t), handled like a joint's rows; only its time derivatives are
 * its own (mbd_part_at sets them from the law). Its multiplier is the force or torque that it takes. A new driver
 * is one file that says which coordinate it is and one row in table.c.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_DRIVER_H
#define MBD_DRIVER_H

#include "mbd/joint/joint.h"
#include "protocol/motion/motion.h"

typedef struct mbd_driver mbd_driver;

typedef struct {
  const char *name;
  mbd_coordinate coordinate; /* of the joint */
  /* Read the type's own keys and set the joint; name, type and motion are read for it. */
  void (*load)(mbd_driver *driver, tdm_object *o, const mbd_model *model);
} mbd_driver_ops;

struct mbd_driver {
  char name[40];
  const mbd_driver_ops *ops;
  const mbd_joint *joint; /* whose coordinate it drives: one of the model's (borrowed), or `frame` */
  mbd_joint frame;        /* bodies, point and axis of a driver without a joint; it has no rows */
  int row;                /* its row among those of all joints and drivers */
  tdm_motion motion;
};

enum { MBD_DRIVER_TYPES_MAX = 32 };
extern const mbd_driver_ops *const mbd_driver_table[];
extern const int mbd_driver_ntype;

/* Append the row coordinate - x. The effort on the second body is -lambda. */
static inline void mbd_driver_row(const mbd_driver *driver, double x, const mbd_kin *a, const mbd_kin *b,
                                  mbd_rows *rows) {
  mbd_joint_coordinate(driver->joint, driver->ops->coordinate, a, b, x, rows);
}

#endif
