/* The table of motion laws, and reading one. */
#include "mbd/driver/motion.h"

extern const mbd_motion_ops mbd_motion_constant_rate;

const mbd_motion_ops *const mbd_motion_table[] = {&mbd_motion_constant_rate};
const int mbd_motion_ntype = sizeof mbd_motion_table / sizeof mbd_motion_table[0];

void mbd_motion_load(mbd_motion *motion, tdm_object *driver) {
  tdm_object o = tdm_get_object(driver, "motion", true);
  const char *names[MBD_MOTION_TYPES_MAX];
  for (int i = 0; i < mbd_motion_ntype; i++)
    names[i] = mbd_motion_table[i]->name;
  int type = tdm_get_choice(&o, "type", names, mbd_motion_ntype, -1);
  if (o.err->status)
    return;
  motion->ops = mbd_motion_table[type];
  motion->ops->load(motion, &o);
  tdm_object_close(&o);
}
