/* A function of one variable through given points: GSL splines for motion laws and for tables of forces.
 *
 * Two points make a straight line. Outside of its points it goes on as a straight line with the slope of its end, a
 * periodic one repeats.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MODEL_CURVE_H
#define MBD_MODEL_CURVE_H

#include "protocol/base/scene.h"

typedef struct mbd_curve mbd_curve;

/* value, first and second derivative */
typedef struct {
  double y, slope, second;
} mbd_curve_value;

/* Read "interpolation" and make the curve through (x, y) (n); errors are at `path`. "steffen" (default) keeps
 * between its points (continuous first derivative), "cspline" is a natural cubic spline with continuous second
 * derivative, which overshoots, and "periodic" a cubic spline whose ends fit. The caller destroys *curve. */
void mbd_curve_read(mbd_curve **curve, tdm_object *o, const double *x, const double *y, int n, const char *path);

/* Read a table `key`: [[x...], [y...]], with "cspline" or "steffen" between its points. */
void mbd_curve_read_table(mbd_curve **curve, tdm_object *o, const char *key, bool steffen);

mbd_curve_value mbd_curve_at(const mbd_curve *curve, double x);

/* Integral from 0 to x. */
double mbd_curve_integral(const mbd_curve *curve, double x);

/* First and last point; an infinite range when it is periodic. */
void mbd_curve_range(const mbd_curve *curve, double range[2]);

/* Its points (n), borrowed. */
int mbd_curve_points(const mbd_curve *curve, const double **x, const double **y);

/* NULL does nothing. */
void mbd_curve_destroy(mbd_curve **curve);

/* All numbers of the array `key` into a new array (NULL after an error) that the caller frees. */
double *mbd_read_numbers(tdm_object *o, const char *key, int *n);

/* The numbers of a JSON array, as above; errors are at `path`. */
double *mbd_numbers(json_t *array, const char *path, int *n, tdm_error *err);

#endif
