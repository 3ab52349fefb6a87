#include "mbd/reduced.h"

#include "mbd/tangent.h"

#include <gsl/gsl_linalg.h>
#include <stdlib.h>
#include <string.h>

struct mbd_reduced {
  int nv, nrow, nfree, rank, k6; /* 6 nbody; rows; f; rank of G; 6 ncoupled */
  double *G, *E1, *E2;           /* (nrow x nv) G; V^T H_i; H_i V */
  double *bias, *scale;          /* (nrow) V^T H V + g_tt; 1/|G_i| */
  gsl_matrix *A, *Q, *R;         /* (nv x nrow) G^T scaled; its QR decomposition */
  gsl_vector *tau, *norm;
  gsl_permutation *order;
  double *N, *MN, *X;                    /* (nv x nfree) N, M N, D or dN/dt */
  double *Mr;                            /* (nfree x nfree) M_r, its Cholesky factor in the lower half */
  double *V, *acc, *b, *Mb, *x, *z;      /* (nv) */
  double *lambda;                        /* (nrow) */
  double *K, *C;                         /* (nv x nv) */
  double *Y, *J, *J_rate, *B, *B_rate;   /* as in tdm_mobility, J and B for any nfree */
  double *stiffness, *damping, *u1, *u2; /* (nfree x nfree), (nfree) */
};

static double *array(size_t n) {
  return calloc(n + 1, sizeof(double));
}

mbd_reduced *mbd_reduced_create(const mbd_model *model) {
  mbd_reduced *r = calloc(1, sizeof *r);
  if (!r)
    return NULL;
  const size_t nv = 6 * (size_t)model->nbody, nrow = (size_t)model->nrow, k6 = 6 * (size_t)model->ncoupled;
  r->nv = (int)nv;
  r->nrow = (int)nrow;
  r->k6 = (int)k6;
  const struct {
    double **at;
    size_t n;
  } arrays[] = {{&r->G, nrow * nv},     {&r->E1, nrow * nv}, {&r->E2, nrow * nv},   {&r->bias, nrow},
                {&r->scale, nrow},      {&r->N, nv * nv},    {&r->MN, nv * nv},     {&r->X, nv * nv},
                {&r->Mr, nv * nv},      {&r->V, nv},         {&r->acc, nv},         {&r->b, nv},
                {&r->Mb, nv},           {&r->x, nv},         {&r->z, nv + nrow},    {&r->lambda, nrow},
                {&r->K, nv * nv},       {&r->C, nv * nv},    {&r->Y, k6 * k6},      {&r->J, k6 * nv},
                {&r->J_rate, k6 * nv},  {&r->B, nv * k6},    {&r->B_rate, nv * k6}, {&r->stiffness, nv * nv},
                {&r->damping, nv * nv}, {&r->u1, nv},        {&r->u2, nv}};
  bool good = true;
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    good = (*arrays[i].at = array(arrays[i].n)) && good;
  const size_t small = nv < nrow ? nv : nrow;
  if (nrow > 0) {
    r->A = gsl_matrix_alloc(nv, nrow);
    r->Q = gsl_matrix_alloc(nv, nv);
    r->R = gsl_matrix_alloc(nv, nrow);
    r->tau = gsl_vector_alloc(small);
    r->norm = gsl_vector_alloc(nrow);
    r->order = gsl_permutation_alloc(nrow);
    good = good && r->A && r->Q && r->R && r->tau && r->norm && r->order;
  }
  if (!good)
    mbd_reduced_destroy(&r);
  return r;
}

void mbd_reduced_destroy(mbd_reduced **reduced) {
  mbd_reduced *r = reduced ? *reduced : NULL;
  if (!r)
    return;
  double *arrays[] = {r->G, r->E1,     r->E2, r->bias,   r->scale,     r->N,       r->MN, r->X,  r->Mr,
                      r->V, r->acc,    r->b,  r->Mb,     r->x,         r->z,       r->K,  r->C,  r->Y,
                      r->J, r->J_rate, r->B,  r->B_rate, r->stiffness, r->damping, r->u1, r->u2, r->lambda};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    free(arrays[i]);
  gsl_matrix_free(r->A);
  gsl_matrix_free(r->Q);
  gsl_matrix_free(r->R);
  gsl_vector_free(r->tau);
  gsl_vector_free(r->norm);
  gsl_permutation_free(r->order);
  free(r);
  *reduced = NULL;
}

const double *mbd_reduced_basis(const mbd_reduced *reduced, int *nfree) {
  *nfree = reduced->nfree;
  return reduced->N;
}

/* ---- constraints ---- */

/* G, V^T H, H V and V^T H V + g_tt of all rows. */
static void collect(const mbd_model *model, mbd_data *data, mbd_reduced *r) {
  const size_t size = (size_t)r->nrow * (size_t)r->nv * sizeof(double);
  memset(r->G, 0, size);
  memset(r->E1, 0, size);
  memset(r->E2, 0, size);
  memset(r->bias, 0, (size_t)r->nrow * sizeof(double));
  for (int p = 0; p < model->npart; p++) {
    const mbd_rows *rows = mbd_part_at(model, data, p, true);
    double V[MBD_PAIR];
    mbd_pair_twist(&data->kin[rows->body[0] + 1], &data->kin[rows->body[1] + 1], V);
    for (int k = 0; k < rows->n; k++) {
      const int row = rows->first + k;
      r->bias[row] += rows->g_tt[k];
      for (int i = 0; i < MBD_PAIR; i++) {
        double left = 0, right = 0;
        for (int l = 0; l < MBD_PAIR; l++) {
          left += V[l] * rows->H[k][l][i];
          right += rows->H[k][i][l] * V[l];
        }
        r->bias[row] += V[i] * right;
        if (rows->body[i / 6] == MBD_GROUND)
          continue;
        const int at = row * r->nv + 6 * rows->body[i / 6] + i % 6;
        r->G[at] += rows->G[k][i];
        r->E1[at] += left;
        r->E2[at] += right;
      }
    }
  }
}

/* Rank and null space of G from the QR decomposition, with pivoting, of G^T; its rows scaled to length 1. */
static void decompose(mbd_reduced *r) {
  int sign;
  r->rank = 0;
  for (int i = 0; i < r->nrow; i++) {
    double length = 0;
    for (int k = 0; k < r->nv; k++)
      length += r->G[i * r->nv + k] * r->G[i * r->nv + k];
    r->scale[i] = length > 0 ? 1 / sqrt(length) : 1;
    for (int k = 0; k < r->nv; k++)
      gsl_matrix_set(r->A, (size_t)k, (size_t)i, r->scale[i] * r->G[i * r->nv + k]);
  }
  if (r->nrow > 0) {
    gsl_linalg_QRPT_decomp(r->A, r->tau, r->order, &sign, r->norm);
    gsl_linalg_QR_unpack(r->A, r->tau, r->Q, r->R);
  }
  for (int i = 0; i < r->nrow && i < r->nv; i++)
    r->rank += fabs(gsl_matrix_get(r->R, (size_t)i, (size_t)i)) > 1e-9;
  r->nfree = r->nv - r->rank;
  for (int i = 0; i < r->nv; i++)
    for (int j = 0; j < r->nfree; j++)
      r->N[i * r->nfree + j] = r->nrow > 0 ? gsl_matrix_get(r->Q, (size_t)i, (size_t)(r->rank + j)) : i == j;
}

/* ---- linear algebra ---- */

/* M x of all bodies at data->kin; x and out of stride `stride` */
static void mass_times(const mbd_model *model, const mbd_data *data, const double *x, double *out, int stride) {
  for (int b = 0; b < model->nbody; b++) {
    double in[6], to[6];
    for (int i = 0; i < 6; i++)
      in[i] = x[(6 * b + i) * stride];
    mbd_set3(to, tdm_scale(model->body[b].mass, mbd_get3(in)));
    mbd_set3(to + 3, mbd_inertia_mul(&model->body[b], &data->kin[b + 1], mbd_get3(in + 3)));
    for (int i = 0; i < 6; i++)
      out[(6 * b + i) * stride] = to[i];
  }
}

/* Cholesky factor of M_r = N^T M N. */
static void factor_mass(const mbd_model *model, const mbd_data *data, mbd_reduced *r) {
  const int f = r->nfree;
  for (int j = 0; j < f; j++)
    mass_times(model, data, r->N + j, r->MN + j, f);
  for (int i = 0; i < f; i++)
    for (int j = 0; j <= i; j++) {
      double sum = 0;
      for (int k = 0; k < r->nv; k++)
        sum += r->N[k * f + i] * r->MN[k * f + j];
      for (int k = 0; k < j; k++)
        sum -= r->Mr[i * f + k] * r->Mr[j * f + k];
      r->Mr[i * f + j] = i == j ? sqrt(sum) : sum / r->Mr[j * f + j];
    }
}

/* x (nfree, of stride `stride`) becomes M_r^-1 x */
static void solve_reduced(const mbd_reduced *r, double *x, int stride) {
  const int f = r->nfree;
  for (int i = 0; i < f; i++) {
    for (int k = 0; k < i; k++)
      x[i * stride] -= r->Mr[i * f + k] * x[k * stride];
    x[i * stride] /= r->Mr[i * f + i];
  }
  for (int i = f - 1; i >= 0; i--) {
    for (int k = i + 1; k < f; k++)
      x[i * stride] -= r->Mr[k * f + i] * x[k * stride];
    x[i * stride] /= r->Mr[i * f + i];
  }
}

/* u (nfree) = M_r^-1 N^T M x */
static void independent_part(mbd_reduced *r, const double *x, double *u) {
  for (int j = 0; j < r->nfree; j++) {
    u[j] = 0;
    for (int k = 0; k < r->nv; k++)
      u[j] += r->MN[k * r->nfree + j] * x[k];
  }
  solve_reduced(r, u, 1);
}

/* x (nv) with G x = -rhs (nrow) and N^T M x = 0 */
static void particular(mbd_reduced *r, const double *rhs, double *x) {
  memset(x, 0, (size_t)r->nv * sizeof(double));
  for (int j = 0; j < r->rank; j++) {
    const int row = (int)gsl_permutation_get(r->order, (size_t)j);
    double sum = -r->scale[row] * rhs[row];
    for (int i = 0; i < j; i++)
      sum -= gsl_matrix_get(r->R, (size_t)i, (size_t)j) * r->z[i];
    r->z[j] = sum / gsl_matrix_get(r->R, (size_t)j, (size_t)j);
    for (int k = 0; k < r->nv; k++)
      x[k] += gsl_matrix_get(r->Q, (size_t)k, (size_t)j) * r->z[j];
  }
  independent_part(r, x, r->u1);
  for (int k = 0; k < r->nv; k++)
    for (int j = 0; j < r->nfree; j++)
      x[k] -= r->N[k * r->nfree + j] * r->u1[j];
}

/* Subtract from lambda (nrow) the nu with M b + G^T nu = 0; of redundant rows the last take nothing. */
static void subtract_reaction(mbd_reduced *r, const double *Mb, double *lambda) {
  for (int j = r->rank - 1; j >= 0; j--) {
    double sum = 0;
    for (int k = 0; k < r->nv; k++)
      sum -= gsl_matrix_get(r->Q, (size_t)k, (size_t)j) * Mb[k];
    for (int i = j + 1; i < r->rank; i++)
      sum -= gsl_matrix_get(r->R, (size_t)j, (size_t)i) * r->z[i];
    r->z[j] = sum / gsl_matrix_get(r->R, (size_t)j, (size_t)j);
    const int row = (int)gsl_permutation_get(r->order, (size_t)j);
    lambda[row] -= r->scale[row] * r->z[j];
  }
}

/* X (nv x nfree) with G X = -E N and N^T M X = 0 */
static void follow(mbd_reduced *r, const double *E) {
  const int f = r->nfree;
  double *rhs = r->z + r->nv; /* (nrow) */
  for (int j = 0; j < f; j++) {
    for (int i = 0; i < r->nrow; i++) {
      rhs[i] = 0;
      for (int k = 0; k < r->nv; k++)
        rhs[i] += E[i * r->nv + k] * r->N[k * f + j];
    }
    particular(r, rhs, r->x);
    for (int k = 0; k < r->nv; k++)
      r->X[k * f + j] = r->x[k];
  }
}

/* out (nfree x nfree) = M_r^-1 N^T (A N + B X); B NULL: A N alone */
static void reduce(mbd_reduced *r, const double *A, const double *B, double *out) {
  const int f = r->nfree, nv = r->nv;
  for (int j = 0; j < f; j++) {
    for (int i = 0; i < nv; i++) {
      r->x[i] = 0;
      for (int k = 0; k < nv; k++)
        r->x[i] += A[i * nv + k] * r->N[k * f + j] + (B ? B[i * nv + k] * r->X[k * f + j] : 0);
    }
    for (int i = 0; i < f; i++) {
      out[i * f + j] = 0;
      for (int k = 0; k < nv; k++)
        out[i * f + j] += r->N[k * f + i] * r->x[k];
    }
    solve_reduced(r, out + j, f);
  }
}

/* ---- the parts of the reduced model ---- */

/* J_r, B and Y */
static void mobility(const mbd_model *model, mbd_reduced *r) {
  const int f = r->nfree, k6 = r->k6;
  for (int c = 0; c < k6; c++)
    for (int j = 0; j < f; j++)
      r->J[c * f + j] = r->B[j * k6 + c] = r->N[(6 * model->coupled[c / 6] + c % 6) * f + j];
  for (int c = 0; c < k6; c++)
    solve_reduced(r, r->B + c, k6);
  for (int c = 0; c < k6; c++)
    for (int e = 0; e <= c; e++) {
      double sum = 0;
      for (int j = 0; j < f; j++)
        sum += 0.5 * (r->J[c * f + j] * r->B[j * k6 + e] + r->J[e * f + j] * r->B[j * k6 + c]);
      r->Y[c * k6 + e] = r->Y[e * k6 + c] = sum;
    }
}

static void add_entry_K(void *context, int row, int col, double value) {
  mbd_reduced *r = context;
  r->K[row * r->nv + col] += value;
}

static void add_entry_C(void *context, int row, int col, double value) {
  mbd_reduced *r = context;
  r->C[row * r->nv + col] += value;
}

/* A_k and A_c */
static void linearise(const mbd_model *model, mbd_data *data, mbd_reduced *r) {
  const size_t size = (size_t)r->nv * (size_t)r->nv * sizeof(double);
  particular(r, r->bias, r->b);
  mass_times(model, data, r->b, r->Mb, 1);
  memcpy(r->lambda, data->lambda, (size_t)r->nrow * sizeof(double));
  subtract_reaction(r, r->Mb, r->lambda);
  for (int k = 0; k < r->nv; k++)
    r->acc[k] = data->acceleration[k] - r->b[k];
  memset(r->K, 0, size);
  memset(r->C, 0, size);
  mbd_tangent(model, data, r->acc, r->lambda, (mbd_weights){.stiffness = 1}, add_entry_K, r);
  mbd_tangent(model, data, r->acc, r->lambda, (mbd_weights){.damping = 1}, add_entry_C, r);
  follow(r, r->E1);
  reduce(r, r->K, r->C, r->stiffness);
  reduce(r, r->C, NULL, r->damping);
}

/* dJ_r/dt, and dB/dt = M_r^-1 (dJ_r/dt^T - dM_r/dt B) with dM_r/dt = N^T ([w] J - J [w]) N */
static void rates(const mbd_model *model, const mbd_data *data, mbd_reduced *r) {
  const int f = r->nfree, k6 = r->k6;
  memset(r->K, 0, (size_t)r->nv * (size_t)r->nv * sizeof(double));
  for (int b = 0; b < model->nbody; b++) {
    tdm_mat3 J = mbd_inertia_world(&model->body[b], &data->kin[b + 1]), W = tdm_m3_skew(data->kin[b + 1].w);
    tdm_mat3 WJ = tdm_m3_mat(W, J), JW = tdm_m3_mat(J, W);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        r->K[(6 * b + 3 + i) * r->nv + 6 * b + 3 + j] = WJ.m[i][j] - JW.m[i][j];
  }
  follow(r, r->E2);
  for (int c = 0; c < k6; c++)
    for (int j = 0; j < f; j++)
      r->J_rate[c * f + j] = r->B_rate[j * k6 + c] = r->X[(6 * model->coupled[c / 6] + c % 6) * f + j];
  for (int c = 0; c < k6; c++)
    solve_reduced(r, r->B_rate + c, k6);
  double *by_mass = r->X; /* (nfree x nfree) */
  reduce(r, r->K, NULL, by_mass);
  for (int j = 0; j < f; j++)
    for (int c = 0; c < k6; c++)
      for (int i = 0; i < f; i++)
        r->B_rate[j * k6 + c] -= by_mass[j * f + i] * r->B[i * k6 + c];
}

bool mbd_reduced_at(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, mbd_reduced *r, double t, const double *y,
                    tdm_mobility *out) {
  if (!mbd_accelerations(model, data, kkt, t, y)) /* sets data->kin and data->now */
    return false;
  collect(model, data, r);
  decompose(r);
  factor_mass(model, data, r);
  mobility(model, r);
  *out = (tdm_mobility){.nbody = model->ncoupled, .Y = r->Y};
  if (r->nfree > TDM_FREE_MAX)
    return true;
  for (int b = 0; b < model->nbody; b++)
    memcpy(r->V + 6 * b, y + MBD_BODY_UNKNOWNS * b + MBD_V, 6 * sizeof(double));
  linearise(model, data, r);
  rates(model, data, r);
  independent_part(r, r->V, r->u1);
  independent_part(r, data->acceleration, r->u2);
  *out = (tdm_mobility){model->ncoupled, r->nfree,   r->Y,      r->u1,    r->u2, r->J, r->B,
                        r->stiffness,    r->damping, r->J_rate, r->B_rate};
  return true;
}
