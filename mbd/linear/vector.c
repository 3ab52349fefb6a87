/* The vector operations that IDA spends its time in, compiled here: see vector.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/linear/vector.h"

#include <math.h>

static inline sunindextype length(N_Vector v) {
  return NV_LENGTH_S(v);
}
static inline realtype *data(N_Vector v) {
  return NV_DATA_S(v);
}

/* ---- one result of one or two vectors; the result may be one of them ---- */

static void linear_sum(realtype a, N_Vector x, realtype b, N_Vector y, N_Vector z) {
  const realtype *xd = data(x), *yd = data(y);
  realtype *zd = data(z);
  for (sunindextype i = 0; i < length(z); i++)
    zd[i] = a * xd[i] + b * yd[i];
}

static void scale(realtype c, N_Vector x, N_Vector z) {
  const realtype *xd = data(x);
  realtype *zd = data(z);
  for (sunindextype i = 0; i < length(z); i++)
    zd[i] = c * xd[i];
}

static void constant(realtype c, N_Vector z) {
  realtype *zd = data(z);
  for (sunindextype i = 0; i < length(z); i++)
    zd[i] = c;
}

static void absolute(N_Vector x, N_Vector z) {
  const realtype *xd = data(x);
  realtype *zd = data(z);
  for (sunindextype i = 0; i < length(z); i++)
    zd[i] = fabs(xd[i]);
}

static void inverse(N_Vector x, N_Vector z) {
  const realtype *xd = data(x);
  realtype *zd = data(z);
  for (sunindextype i = 0; i < length(z); i++)
    zd[i] = 1 / xd[i];
}

static void add_constant(N_Vector x, realtype b, N_Vector z) {
  const realtype *xd = data(x);
  realtype *zd = data(z);
  for (sunindextype i = 0; i < length(z); i++)
    zd[i] = xd[i] + b;
}

/* ---- several vectors ---- */

/* z = sum c_j x_j; z may be x_0 */
static int linear_combination(int n, realtype *c, N_Vector *x, N_Vector z) {
  realtype *zd = data(z);
  const realtype *first = data(x[0]);
  for (sunindextype i = 0; i < length(z); i++)
    zd[i] = c[0] * first[i];
  for (int j = 1; j < n; j++) {
    const realtype *xd = data(x[j]);
    for (sunindextype i = 0; i < length(z); i++)
      zd[i] += c[j] * xd[i];
  }
  return 0;
}

/* z_j = a_j x + y_j */
static int scale_add_multi(int n, realtype *a, N_Vector x, N_Vector *y, N_Vector *z) {
  for (int j = 0; j < n; j++)
    linear_sum(a[j], x, 1, y[j], z[j]);
  return 0;
}

static int linear_sums(int n, realtype a, N_Vector *x, realtype b, N_Vector *y, N_Vector *z) {
  for (int j = 0; j < n; j++)
    linear_sum(a, x[j], b, y[j], z[j]);
  return 0;
}

static int scales(int n, realtype *c, N_Vector *x, N_Vector *z) {
  for (int j = 0; j < n; j++)
    scale(c[j], x[j], z[j]);
  return 0;
}

/* ---- norms: four sums, added in a fixed order ---- */

static realtype weighted_norm(N_Vector x, N_Vector w, N_Vector mask) {
  const sunindextype n = length(x);
  const realtype *xd = data(x), *wd = data(w), *md = mask ? data(mask) : NULL;
  realtype sum[4] = {0, 0, 0, 0};
  for (sunindextype i = 0; i < n; i++) {
    realtype p = xd[i] * wd[i];
    sum[i & 3] += !md || md[i] > 0 ? p * p : 0;
  }
  return sqrt(((sum[0] + sum[1]) + (sum[2] + sum[3])) / (realtype)n);
}

static realtype norm(N_Vector x, N_Vector w) {
  return weighted_norm(x, w, NULL);
}

static realtype masked_norm(N_Vector x, N_Vector w, N_Vector mask) {
  return weighted_norm(x, w, mask);
}

N_Vector mbd_vector_create(sunindextype n, SUNContext context) {
  N_Vector v = N_VNew_Serial(n, context);
  if (!v)
    return NULL;
  v->ops->nvlinearsum = linear_sum;
  v->ops->nvscale = scale;
  v->ops->nvconst = constant;
  v->ops->nvabs = absolute;
  v->ops->nvinv = inverse;
  v->ops->nvaddconst = add_constant;
  v->ops->nvwrmsnorm = norm;
  v->ops->nvwrmsnormmask = masked_norm;
  v->ops->nvlinearcombination = linear_combination;
  v->ops->nvscaleaddmulti = scale_add_multi;
  v->ops->nvlinearsumvectorarray = linear_sums;
  v->ops->nvscalevectorarray = scales;
  constant(0, v);
  return v;
}
