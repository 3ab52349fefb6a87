/* What a force's file includes: its shape (model/force.h), and forces along coordinates of a pair of bodies. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_FORCE_FORCE_H
#define MBD_FORCE_FORCE_H

#include "mbd/joint/frame.h"
#include "mbd/joint/rows.h"
#include "mbd/model/read.h"

/* a force along one coordinate x; a positive one pulls x down */
typedef struct {
  double f, by_x, by_rate; /* and its derivatives */
  double potential, dissipated;
} mbd_scalar;

/* Read "bodies" and "points" into body and frame. Returns their distance [m]; points nearer than mbd_force_no_length
 * have none, which is an error where a force must have a direction. */
double mbd_force_read_points(mbd_force *force, tdm_object *o, const mbd_model *model, bool must_part);

static const double mbd_force_no_length = 1e-9; /* [m] */

/* Rates of the coordinates value->rows. */
void mbd_force_rates(const mbd_force_value *value, const mbd_kin *a, const mbd_kin *b, double *rate);

/* Add Q = -G^T f along all n coordinates of value->rows, with K and C if asked for; by_x and by_rate are (n x n). */
void mbd_force_apply(mbd_force_value *value, const mbd_kin *a, const mbd_kin *b, const double *f, const double *by_x,
                     const double *by_rate);

/* The same for one coordinate at x, with value, coordinate, rate, potential and dissipation. */
void mbd_force_apply_scalar(mbd_force_value *value, const mbd_kin *a, const mbd_kin *b, double x, double rate,
                            const mbd_scalar *law);

/* Append the distance of the force's two points, or the coordinate of its joint. Returns it, its rate in *rate. */
double mbd_force_distance(const mbd_force *force, const mbd_kin *a, const mbd_kin *b, mbd_force_value *value,
                          double *rate);
double mbd_force_coordinate(const mbd_force *force, const mbd_kin *a, const mbd_kin *b, mbd_force_value *value,
                            double *rate);

#endif
