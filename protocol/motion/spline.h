/* A function of one variable through given points: GSL splines for motion laws and for tables of forces.
 *
 * Two points make a straight line. Outside of its points it goes on as a straight line with the slope of its end, a
 * periodic one repeats.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_MOTION_SPLINE_H
#define TDM_MOTION_SPLINE_H

#include "protocol/scene/scene.h"

typedef struct tdm_spline tdm_spline;

/* value, first and second derivative */
typedef struct {
  double y, slope, second;
} tdm_spline_value;

/* Read "interpolation" and make the curve through (x, y) (n); errors are at `path`. "steffen" (default) keeps
 * between its points (continuous first derivative), "cspline" is a natural cubic spline with continuous second
 * derivative, which overshoots, and "periodic" a cubic spline whose ends fit. The caller destroys *curve. */
void tdm_spline_read(tdm_spline **curve, tdm_object *o, const double *x, const double *y, int n, const char *path);

/* Read a table `key`: [[x...], [y...]], with "cspline" or "steffen" between its points. */
void tdm_spline_read_table(tdm_spline **curve, tdm_object *o, const char *key, bool steffen);

tdm_spline_value tdm_spline_at(const tdm_spline *curve, double x);

/* Integral from 0 to x. */
double tdm_spline_integral(const tdm_spline *curve, double x);

/* First and last point; an infinite range when it is periodic. */
void tdm_spline_range(const tdm_spline *curve, double *first, double *last);

/* Its points (n), borrowed. */
int tdm_spline_points(const tdm_spline *curve, const double **x, const double **y);

/* NULL does nothing. */
void tdm_spline_destroy(tdm_spline **curve);

/* All numbers of the array `key` into a new array (NULL after an error) that the caller frees. */
double *tdm_get_all_numbers(tdm_object *o, const char *key, int *n);

/* The numbers of a JSON array, as above; errors are at `path`. */
double *tdm_numbers_from_json(json_t *array, const char *path, int *n, tdm_error *err);

#endif
