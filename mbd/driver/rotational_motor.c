/* Rotational motor: the angle of a revolute joint follows a motion law, and the torque that this takes is its output.
 *
 * The angle is the rotation of the second body against the first about the joint axis since the start configuration;
 * a positive torque turns the second body forward and the first back.
 */
#include "mbd/driver/driver.h"
#include "mbd/model.h"

static void load(mbd_driver *driver, tdm_object *o, const mbd_model *model) {
  driver->joint = mbd_load_joint(o, model, "revolute", "");
}

static void eval(const mbd_driver *driver, double x, const mbd_kin *a, const mbd_kin *b, mbd_rows *rows) {
  const mbd_joint *j = driver->joint;
  mbd_rows_angle(rows, mbd_joint_axis(j, 0, 0, a), mbd_joint_axis(j, 0, 1, a), mbd_joint_axis(j, 1, 0, b),
                 mbd_joint_axis(j, 1, 1, b), x);
}

extern const mbd_driver_ops mbd_driver_rotational_motor;
const mbd_driver_ops mbd_driver_rotational_motor = {
    .name = "rotational_motor",
    .effort = "torque",
    .effort_unit = "N m",
    .coordinate = "angle",
    .coordinate_unit = "rad",
    .rate_unit = "rad/s",
    .load = load,
    .eval = eval,
};
