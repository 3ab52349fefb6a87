/* Signs in time histories that a window is too long or too short ([L18] Section 4.3). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_CHOICE_SIGNS_H
#define CPL_CHOICE_SIGNS_H

/* By how much a velocity is not the derivative of its position: the rms of what Simpson's rule over it lacks of the
 * way, over each two intervals h [s] of a grid, beside that of the velocity about its mean. Of exact histories it is of
 * the order (h w)^4 for a motion of angular frequency w. NaN: less than 5 rows, or nothing moves. Shapes: (n). */
double cpl_velocity_gap(const double *position, const double *velocity, int n, double h);

/* A load's variance above the frequency of blocks of `width` rows, beside that below: within blocks, and of their
 * means. NaN: width below 2, less than 4 blocks, or no variance below. */
double cpl_variance_ratio(const double *load, int n, int width);

#endif
