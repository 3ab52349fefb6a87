/* Windows in the wall of a cylinder or cone: rectangles in angle and height where there is no wall. What is left is a
 * thin shell, felt from both sides, whose edges are arcs at a window's heights and straight lines at its angles.
 *
 * Own axes as in frustum.h; angles from x on, anticlockwise as seen from the end of the axis. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_GEOMETRY_WINDOWS_H
#define DEM_GEOMETRY_WINDOWS_H

#include "protocol/scene/scene.h"

enum { DEM_WINDOWS_MAX = 100 }; /* of one wall */

typedef struct {
  double angle, width; /* where it begins, and how far it reaches from there, less than the whole turn [rad] */
  double height[2];    /* along the axis [m] */
  double side[2][2];   /* directions of its straight edges: cosine and sine of both angles */
  double middle[2];    /* direction of its middle */
  double least;        /* cosine between the middle and an edge: what is in the window has a greater one */
  bool open[2];        /* it reaches this end of the wall and has no edge there */
} dem_window;

typedef struct {
  int count;
  dem_window window[]; /* (count) no two touch */
} dem_windows;

/* Read "windows" of a wall of this length: the caller's to free; NULL where the key is missing, and after an error:
 * windows that are not in the wall, that reach around it, or that touch. */
dem_windows *dem_windows_read(tdm_object *o, double length);

/* Distance of x (>= 0) from the nearest point of what the windows leave of the shell (frustum.h), and the unit normal
 * from there to x. Over a window that is a point of its edges: the distance is the same from face and edge where one
 * passes into the other. It changes with x by no more than x does. */
double dem_windows_gap(const dem_windows *windows, const double radius[2], double length, tdm_vec3 x, tdm_vec3 *normal);

/* The wall along the line at `angle` from the height *low upwards: the next piece, from *low to *high. False: there is
 * none. */
bool dem_windows_piece(const dem_windows *windows, double length, double angle, double *low, double *high);

/* A number that depends on the windows, for fingerprints. */
unsigned long long dem_windows_hash(const dem_windows *windows);

#endif
