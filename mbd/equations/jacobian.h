/* The analytic Jacobian dF/dy + cj dF/dydot of the residual, entry by entry.
 *
 * Everything is differentiated with respect to twist coordinates first (rotation vector in world axes) and mapped to
 * Euler parameters by dtheta = T dp, T = 2/|p|^2 [-u | w 1 + [u]], p = (w, u). The rotation matrix belongs to p/|p|, so
 * this is exact off the unit sphere too, where Newton's iterates are.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_EQUATIONS_JACOBIAN_H
#define MBD_EQUATIONS_JACOBIAN_H

#include "mbd/linear/sparse.h"
#include "mbd/mechanics/state.h"

/* dF/dy + cj dF/dydot at (t, y, yp), added to a matrix between its begin and end. */
void mbd_jacobian(const mbd_model *model, mbd_data *data, double t, double cj, const double *y, const double *yp,
                  mbd_sparse *matrix);

#endif
