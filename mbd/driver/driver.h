/* Drivers: a coordinate of a joint follows a motion law.
 *
 * A driver is one constraint row g = coordinate(q) - x(t), handled like a joint's rows; only its time derivatives are
 * its own (mbd_part_at sets them from the law). Its multiplier is the force or torque that it takes. A new driver
 * is one file that composes the row (../joint/rows.h) and one row in table.c.
 */
#ifndef MBD_DRIVER_H
#define MBD_DRIVER_H

#include "mbd/driver/motion.h"
#include "mbd/joint/joint.h"

typedef struct mbd_driver mbd_driver;

typedef struct {
  const char *name;
  const char *effort, *effort_unit;         /* "torque", "N m" */
  const char *coordinate, *coordinate_unit; /* "angle", "rad" */
  const char *rate_unit;
  /* Read "joint" and the type's own keys; name, type and motion are read for it. */
  void (*load)(mbd_driver *driver, tdm_object *o, const mbd_model *model);
  /* Append the row coordinate - x. Its Jacobian must not depend on x: the effort on the second body is -lambda. */
  void (*eval)(const mbd_driver *driver, double x, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows);
} mbd_driver_ops;

struct mbd_driver {
  char name[40];
  const mbd_driver_ops *ops;
  const mbd_joint *joint; /* the one it drives, borrowed from the model */
  int row;                /* its row among those of all joints and drivers */
  mbd_motion motion;
};

enum { MBD_DRIVER_TYPES_MAX = 32 };
extern const mbd_driver_ops *const mbd_driver_table[];
extern const int mbd_driver_ntype;

#endif
