/* Motion laws: what a driver prescribes, as a function of the simulation time.
 *
 * A law must be continuous with its rate (a jump of the rate is only possible before the run starts), and its
 * acceleration should be. To add one: a file that defines its ops (constant_rate.c), its name in the table of
 * motion.c, and a line in ../CMakeLists.txt and in ../README.md.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MOTION_H
#define MBD_MOTION_H

#include "mbd/model/curve.h"

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
  double rate;                    /* constant rate [rad/s] or [m/s] */
  double rise;                    /* time in which it, or the step, is reached; 0: it is there at the start [s] */
  double from, to, start;         /* constant: from; harmonic: from is the mean; step [rad] or [m], [s] */
  double amplitude, omega, phase; /* harmonic [rad] or [m], [rad/s], [rad] */
  int ncoefficient;
  double *coefficient; /* (ncoefficient) of a polynomial, owned */
  mbd_curve *curve;    /* of a table, owned */
  bool limited;        /* the law has the times of `range` alone [s] */
  double range[2];
};

enum { MBD_MOTION_TYPES_MAX = 32 };
extern const mbd_motion_ops *const mbd_motion_table[];
extern const int mbd_motion_ntype;

/* Read the object `key`, which is there; the caller clears the motion (also after an error). */
void mbd_motion_read(mbd_motion *motion, tdm_object *o, const char *key);

/* Free what it owns. */
void mbd_motion_clear(mbd_motion *motion);

/* Refuse a law that has no value at some time of [t0, t1]; `path` and `name` are of what follows it. */
tdm_status mbd_motion_check(const mbd_motion *motion, double t0, double t1, const char *path, const char *name,
                            tdm_error *err);

static inline mbd_motion_value mbd_motion_at(const mbd_motion *motion, double t) {
  return motion->ops->eval(motion, t);
}

#endif
