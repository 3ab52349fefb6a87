/* Motion laws: what a driver prescribes, as a function of the simulation time.
 *
 * A law must be continuous with its rate (a jump of the rate is only possible before the run starts), and its
 * acceleration should be. To add one: a file that defines its ops (constant_rate.c), its name in the table of
 * motion.c, and a line in ../CMakeLists.txt and in ../README.md.
 */
#ifndef MBD_MOTION_H
#define MBD_MOTION_H

#include "protocol/scene.h"

/* a prescribed coordinate at one instant; [rad] and its rates, or [m] */
typedef struct {
  double value, rate, acceleration;
} mbd_motion_value;

typedef struct mbd_motion mbd_motion;

typedef struct {
  const char *name;
  /* Read the keys behind "type". */
  void (*load)(mbd_motion *motion, tdm_object *o);
  mbd_motion_value (*eval)(const mbd_motion *motion, double t);
} mbd_motion_ops;

struct mbd_motion {
  const mbd_motion_ops *ops;
  double rate; /* constant rate [rad/s] or [m/s] */
  double rise; /* time in which it is reached, 0: it is there at the start [s] */
};

enum { MBD_MOTION_TYPES_MAX = 32 };
extern const mbd_motion_ops *const mbd_motion_table[];
extern const int mbd_motion_ntype;

/* Read the object "motion" of a driver. */
void mbd_motion_load(mbd_motion *motion, tdm_object *driver);

static inline mbd_motion_value mbd_motion_at(const mbd_motion *motion, double t) {
  return motion->ops->eval(motion, t);
}

#endif
