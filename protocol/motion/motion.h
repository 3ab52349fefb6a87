/* Motion laws: a coordinate as a function of the simulation time, for both engines: what drivers of mbd/ prescribe,
 * what scales their applied forces, and the oscillations of driven bodies in dem/.
 *
 * A law must be continuous with its rate (a jump of the rate is only possible before the run starts), and its
 * acceleration should be. To add one: a file with its parameters, their reader and its ops, tdm_motion_NAME
 * (constant_rate.c is short), and its row in motion.c; its keys in scenarios/scene.schema.json.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_MOTION_MOTION_H
#define TDM_MOTION_MOTION_H

#include "protocol/scene/scene.h"

/* a prescribed coordinate at one instant; [rad] and its rates, or [m] */
typedef struct {
  double value, rate, acceleration;
} tdm_motion_value;

typedef struct {
  double first, last; /* [s]; -INFINITY, INFINITY: no limit */
} tdm_motion_range;

typedef struct {
  const char *name; /* first: as tdm_types asks */
  size_t size;      /* of the law's own parameters [bytes] */
  /* Read the keys behind "type" into the parameters, which are zero; narrow the range of times that it has values for,
   * which is all times. */
  void (*read)(void *own, tdm_object *o, tdm_motion_range *range);
  tdm_motion_value (*at)(const void *own, double t);
  void (*clear)(void *own); /* free what the parameters own; NULL: nothing */
  /* The first time after t at which a step should end that is to see all of the law, INFINITY: none. NULL: there are
   * none, or the steps' own error test finds them. */
  double (*knot)(const void *own, double t);
  /* Size of what the value at time t is put together from, for its rounding: a sum may cancel. NULL: the value's. */
  double (*magnitude)(const void *own, double t);
} tdm_motion_ops;

typedef struct {
  const tdm_motion_ops *ops; /* NULL: no law */
  void *own;                 /* (ops->size) the law's parameters, owned */
  tdm_motion_range range;
} tdm_motion;

extern tdm_types tdm_motion_types; /* rows: tdm_motion_ops */

/* Add a law that stands outside of this folder (tdm_type_add). */
tdm_status tdm_motion_add(const tdm_motion_ops *ops, tdm_error *err);

/* Read the object `key`, which is there; the caller clears the motion (also after an error). */
void tdm_motion_read(tdm_motion *motion, tdm_object *o, const char *key);

/* The same of an object that is open, which it closes. */
void tdm_motion_read_law(tdm_motion *motion, tdm_object *o);

/* Free what it owns; no law is left. */
void tdm_motion_clear(tdm_motion *motion);

/* Refuse a law that has no value at some time of [t0, t1]; `path` and `name` are of what follows it. */
tdm_status tdm_motion_check(const tdm_motion *motion, double t0, double t1, const char *path, const char *name,
                            tdm_error *err);

static inline tdm_motion_value tdm_motion_at(const tdm_motion *motion, double t) {
  return motion->ops->at(motion->own, t);
}

/* Size of what the value at time t is put together from: its rounding is some 1e-16 of that. */
static inline double tdm_motion_magnitude(const tdm_motion *motion, double t) {
  return motion->ops->magnitude ? motion->ops->magnitude(motion->own, t) : fabs(tdm_motion_at(motion, t).value);
}

/* The law's first knot after t, INFINITY: it has none. */
static inline double tdm_motion_knot(const tdm_motion *motion, double t) {
  return motion->ops && motion->ops->knot ? motion->ops->knot(motion->own, t) : INFINITY;
}

#endif
