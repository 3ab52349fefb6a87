/* The analytic Jacobian dF/dy + cj dF/dydot of the residual, entry by entry into a sink.
 *
 * Everything is differentiated with respect to twist coordinates first (rotation vector in world axes) and mapped to
 * Euler parameters by dtheta = T dp, T = 2/|p|^2 [-u | w 1 + [u]], p = (w, u). The rotation matrix belongs to p/|p|, so
 * this is exact off the unit sphere too, where Newton's iterates are.
 */
#ifndef MBD_JACOBIAN_H
#define MBD_JACOBIAN_H

#include "mbd/state.h"

/* Where entries go: a dense column-major matrix, zeroed by the caller. A sparse matrix needs another add only. */
typedef struct {
  double *dense; /* (n x n) column-major */
  int n;
} mbd_sink;

static inline void mbd_jac_add(mbd_sink *sink, int row, int col, double value) {
  sink->dense[(size_t)col * (size_t)sink->n + (size_t)row] += value;
}

/* dF/dy + cj dF/dydot at (t, y, yp). */
void mbd_jacobian(const mbd_model *model, mbd_data *data, double t, double cj, const double *y, const double *yp,
                  mbd_sink *sink);

#endif
