/* The mechanism as its coupled bodies feel it: see reduced.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/reduced/reduced.h"

#include "mbd/equations/tangent.h"

#include <gsl/gsl_linalg.h>
#include <stdlib.h>
#include <string.h>

struct mbd_reduced {
  int nbody, *body;          /* (nbody) the bodies that take part */
  int *place;                /* (bodies of the model) where each stands among these, -1: nowhere */
  int npart, *part;          /* (npart) parts of the constraints that take part */
  int *row, *row_place;      /* (nrow) their rows, (rows of the model) where each stands among these */
  int freedom;               /* that the rows found independent at the assembly leave */
  int nv, nrow, nfree, rank; /* 6 nbody; rows; f; rank of G */
  int k6;                    /* 6 ncoupled */
  double *acc, *lambda;      /* (6 bodies), (rows) of the model */
  double *Y;                 /* as in tdm_mobility; all that there is when freedom > TDM_FREE_MAX */
  double *G, *E1, *E2;       /* (nrow x nv) G; V^T H_i; H_i V */
  double *bias, *scale;      /* (nrow) V^T H V + g_tt; 1/|G_i| */
  gsl_matrix *A;             /* (nv x nrow) G^T scaled; its QR decomposition */
  gsl_vector *tau, *norm;
  gsl_permutation *order;
  double *N, *MN, *X;                    /* (nv x nfree) N, M N, D or dN/dt */
  double *Mr;                            /* (nfree x nfree) M_r, its Cholesky factor in the lower half */
  double *V, *a, *b, *Mb, *x, *z;        /* (nv), z (nv or nrow, the larger) */
  double *K, *C;                         /* (nv x nv) */
  double *J, *J_rate, *B, *B_rate;       /* as in tdm_mobility */
  double *stiffness, *damping, *u1, *u2; /* (nfree x nfree), (nfree) */
};

/* ---- who takes part ---- */

static int root(int *up, int body) {
  while (up[body] != body)
    body = up[body] = up[up[body]];
  return body;
}

static void tie(int *up, int a, int b) {
  if (a != MBD_GROUND && b != MBD_GROUND)
    up[root(up, a)] = root(up, b);
}

/* Tie bodies with a constraint or a force between them; up (nbody) leads from each to one that its whole component
 * shares. */
static void tie_all(const mbd_model *model, int *up) {
  for (int b = 0; b < model->nbody; b++)
    up[b] = b;
  for (int p = 0; p < model->npart; p++) {
    const mbd_part *part = &model->part[p];
    tie(up, part->body[0], part->body[1]);
    for (int i = 0; i < 4 && part->index > 0; i++) /* with the pair before it, whose rows it shares */
      tie(up, part->body[i / 2], part[-1].body[i % 2]);
  }
  for (int i = 0; i < model->nforce; i++)
    tie(up, model->force[i].body[0], model->force[i].body[1]);
}

/* wanted (nbody): zeroed */
static void list_bodies(const mbd_model *model, mbd_reduced *r, int *up, bool *wanted) {
  tie_all(model, up);
  for (int k = 0; k < model->ncoupled; k++)
    wanted[root(up, model->coupled[k])] = true;
  for (int b = 0; b < model->nbody; b++) {
    r->place[b] = wanted[root(up, b)] ? r->nbody : -1;
    if (r->place[b] >= 0)
      r->body[r->nbody++] = b;
  }
}

/* Parts and rows of the bodies listed, and their freedom. */
static void list_rows(const mbd_model *model, const mbd_data *data, mbd_reduced *r) {
  r->freedom = 6 * r->nbody;
  for (int p = 0; p < model->npart; p++) {
    const mbd_part *part = &model->part[p];
    const int nrow = part->index > 0                  ? 0 /* further pairs have none new */
                     : part->driver || part->friction ? 1
                                                      : part->joint->ops->nrow;
    if (r->place[part->body[part->body[0] == MBD_GROUND]] < 0)
      continue;
    r->part[r->npart++] = p;
    for (int row = part->row; row < part->row + nrow; row++) {
      r->row_place[row] = r->nrow;
      r->row[r->nrow++] = row;
      r->freedom -= !part->friction && !data->dependent[row]; /* what sticks may slide later */
    }
  }
}

static bool select_component(const mbd_model *model, const mbd_data *data, mbd_reduced *r) {
  const size_t nbody = (size_t)model->nbody + 1, npart = (size_t)model->npart + 1, nrow = (size_t)model->nrow + 1;
  int *up = calloc(nbody, sizeof *up);
  bool *wanted = calloc(nbody, sizeof *wanted); /* of roots */
  r->body = calloc(nbody, sizeof *r->body);
  r->place = calloc(nbody, sizeof *r->place);
  r->part = calloc(npart, sizeof *r->part);
  r->row = calloc(nrow, sizeof *r->row);
  r->row_place = calloc(nrow, sizeof *r->row_place);
  const bool good = up && wanted && r->body && r->place && r->part && r->row && r->row_place;
  if (good) {
    list_bodies(model, r, up, wanted);
    list_rows(model, data, r);
  }
  free(up);
  free(wanted);
  return good;
}

/* ---- memory ---- */

static double *array(size_t n) {
  return calloc(n + 1, sizeof(double));
}

/* What all but Y is made in. */
static bool allocate_dense(mbd_reduced *r) {
  const size_t nv = (size_t)r->nv, nrow = (size_t)r->nrow, k6 = (size_t)r->k6;
  const size_t f = nv < TDM_FREE_MAX ? nv : TDM_FREE_MAX, small = nv < nrow ? nv : nrow;
  const struct {
    double **at;
    size_t n;
  } arrays[] = {{&r->G, nrow * nv},
                {&r->E1, nrow * nv},
                {&r->E2, nrow * nv},
                {&r->bias, nrow},
                {&r->scale, nrow},
                {&r->N, nv * f},
                {&r->MN, nv * f},
                {&r->X, nv * f},
                {&r->Mr, f * f},
                {&r->V, nv},
                {&r->a, nv},
                {&r->b, nv},
                {&r->Mb, nv},
                {&r->x, nv},
                {&r->z, nv > nrow ? nv : nrow},
                {&r->K, nv * nv},
                {&r->C, nv * nv},
                {&r->J, k6 * f},
                {&r->J_rate, k6 * f},
                {&r->B, f * k6},
                {&r->B_rate, f * k6},
                {&r->stiffness, f * f},
                {&r->damping, f * f},
                {&r->u1, f},
                {&r->u2, f}};
  bool good = true;
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    good = (*arrays[i].at = array(arrays[i].n)) && good;
  if (nrow > 0) {
    r->A = gsl_matrix_alloc(nv, nrow);
    r->tau = gsl_vector_alloc(small);
    r->norm = gsl_vector_alloc(nrow);
    r->order = gsl_permutation_alloc(nrow);
    good = good && r->A && r->tau && r->norm && r->order;
  }
  return good;
}

mbd_reduced *mbd_reduced_create(const mbd_model *model, const mbd_data *data) {
  mbd_reduced *r = calloc(1, sizeof *r);
  if (!r)
    return NULL;
  r->k6 = 6 * model->ncoupled;
  r->acc = array(6 * (size_t)model->nbody);
  r->lambda = array((size_t)model->nrow);
  r->Y = array((size_t)r->k6 * (size_t)r->k6);
  bool good = select_component(model, data, r) && r->acc && r->lambda && r->Y;
  r->nv = 6 * r->nbody;
  good = good && (r->freedom > TDM_FREE_MAX || allocate_dense(r));
  if (!good)
    mbd_reduced_destroy(&r);
  return r;
}

void mbd_reduced_destroy(mbd_reduced **reduced) {
  mbd_reduced *r = reduced ? *reduced : NULL;
  if (!r)
    return;
  int *lists[] = {r->body, r->place, r->part, r->row, r->row_place};
  for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++)
    free(lists[i]);
  double *arrays[] = {r->G,      r->E1,        r->E2,      r->bias, r->scale, r->N,      r->MN,  r->X,     r->Mr, r->V,
                      r->a,      r->b,         r->Mb,      r->x,    r->z,     r->K,      r->C,   r->Y,     r->J,  r->B,
                      r->J_rate, r->stiffness, r->damping, r->u1,   r->u2,    r->B_rate, r->acc, r->lambda};
  for (size_t i = 0; i < sizeof arrays / sizeof arrays[0]; i++)
    free(arrays[i]);
  gsl_matrix_free(r->A);
  gsl_vector_free(r->tau);
  gsl_vector_free(r->norm);
  gsl_permutation_free(r->order);
  free(r);
  *reduced = NULL;
}

int mbd_reduced_freedom(const mbd_reduced *reduced) {
  return reduced->freedom;
}

const double *mbd_reduced_basis(const mbd_reduced *reduced, int *nfree) {
  *nfree = reduced->nfree;
  return reduced->N;
}

/* ---- constraints ---- */

/* G, V^T H, H V and V^T H V + g_tt of the rows. */
static void collect(const mbd_model *model, mbd_data *data, mbd_reduced *r) {
  const size_t size = (size_t)r->nrow * (size_t)r->nv * sizeof(double);
  memset(r->G, 0, size);
  memset(r->E1, 0, size);
  memset(r->E2, 0, size);
  memset(r->bias, 0, (size_t)r->nrow * sizeof(double));
  for (int p = 0; p < r->npart; p++) {
    const mbd_rows *rows = mbd_part_at(model, data, r->part[p], true);
    double V[MBD_PAIR];
    mbd_pair_twist(&data->kin[rows->body[0] + 1], &data->kin[rows->body[1] + 1], V);
    for (int k = 0; k < rows->n; k++) {
      const int row = r->row_place[rows->first + k];
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
        const int at = row * r->nv + 6 * r->place[rows->body[i / 6]] + i % 6;
        r->G[at] += rows->G[k][i];
        r->E1[at] += left;
        r->E2[at] += right;
      }
    }
  }
}

/* R */
static double factor(const mbd_reduced *r, int i, int j) {
  return gsl_matrix_get(r->A, (size_t)i, (size_t)j);
}

/* Rank and null space of G from the QR decomposition, with pivoting, of G^T; its rows scaled to length 1. false: more
 * freedom than there is room for. */
static bool decompose(mbd_reduced *r) {
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
  if (r->nrow > 0)
    gsl_linalg_QRPT_decomp(r->A, r->tau, r->order, &sign, r->norm);
  for (int i = 0; i < r->nrow && i < r->nv; i++)
    r->rank += fabs(factor(r, i, i)) > 1e-9;
  r->nfree = r->nv - r->rank;
  if (r->nfree > TDM_FREE_MAX)
    return false;
  for (int j = 0; j < r->nfree; j++) {
    gsl_vector_view column = gsl_vector_view_array_with_stride(r->N + j, (size_t)r->nfree, (size_t)r->nv);
    gsl_vector_set_basis(&column.vector, (size_t)(r->rank + j));
    if (r->nrow > 0)
      gsl_linalg_QR_Qvec(r->A, r->tau, &column.vector);
  }
  return true;
}

/* ---- linear algebra ---- */

/* M x (nv) at data->kin; x and out of stride `stride` */
static void mass_times(const mbd_model *model, const mbd_data *data, const mbd_reduced *r, const double *x, double *out,
                       int stride) {
  for (int b = 0; b < r->nbody; b++) {
    const int body = r->body[b];
    double in[6], to[6];
    for (int i = 0; i < 6; i++)
      in[i] = x[(6 * b + i) * stride];
    mbd_set3(to, tdm_scale(model->body[body].mass, mbd_get3(in)));
    mbd_set3(to + 3, mbd_inertia_mul(&model->body[body], &data->kin[body + 1], mbd_get3(in + 3)));
    for (int i = 0; i < 6; i++)
      out[(6 * b + i) * stride] = to[i];
  }
}

/* Cholesky factor of M_r = N^T M N. */
static void factor_mass(const mbd_model *model, const mbd_data *data, mbd_reduced *r) {
  const int f = r->nfree;
  for (int j = 0; j < f; j++)
    mass_times(model, data, r, r->N + j, r->MN + j, f);
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
      sum -= factor(r, i, j) * x[i];
    x[j] = sum / factor(r, j, j);
  }
  if (r->rank > 0) {
    gsl_vector_view all = gsl_vector_view_array(x, (size_t)r->nv);
    gsl_linalg_QR_Qvec(r->A, r->tau, &all.vector);
  }
  independent_part(r, x, r->u1);
  for (int k = 0; k < r->nv; k++)
    for (int j = 0; j < r->nfree; j++)
      x[k] -= r->N[k * r->nfree + j] * r->u1[j];
}

/* Subtract from lambda (of the model) the nu with M b + G^T nu = 0; of redundant rows the last take nothing. */
static void subtract_reaction(mbd_reduced *r, const double *Mb, double *lambda) {
  if (r->rank == 0)
    return;
  gsl_vector_view z = gsl_vector_view_array(r->z, (size_t)r->nv);
  memcpy(r->z, Mb, (size_t)r->nv * sizeof(double));
  gsl_linalg_QR_QTvec(r->A, r->tau, &z.vector);
  for (int j = r->rank - 1; j >= 0; j--) {
    double sum = -r->z[j];
    for (int i = j + 1; i < r->rank; i++)
      sum -= factor(r, j, i) * r->z[i];
    r->z[j] = sum / factor(r, j, j);
    const int row = (int)gsl_permutation_get(r->order, (size_t)j);
    lambda[r->row[row]] -= r->scale[row] * r->z[j];
  }
}

/* X (nv x nfree) with G X = -E N and N^T M X = 0 */
static void follow(mbd_reduced *r, const double *E) {
  const int f = r->nfree;
  double *rhs = r->z; /* (nrow) */
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

/* the row of N of a coupled body's velocity c */
static int coupled_row(const mbd_model *model, const mbd_reduced *r, int c) {
  return 6 * r->place[model->coupled[c / 6]] + c % 6;
}

/* J_r, B and Y */
static void mobility(const mbd_model *model, mbd_reduced *r) {
  const int f = r->nfree, k6 = r->k6;
  for (int c = 0; c < k6; c++)
    for (int j = 0; j < f; j++)
      r->J[c * f + j] = r->B[j * k6 + c] = r->N[coupled_row(model, r, c) * f + j];
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

/* Y alone, column by column, from the factors of the last accelerations */
static bool mobility_alone(const mbd_model *model, mbd_kkt *kkt, mbd_reduced *r) {
  const int k6 = r->k6;
  memset(mbd_kkt_b(kkt), 0, (size_t)model->nrow * sizeof(double));
  memset(r->acc, 0, 6 * (size_t)model->nbody * sizeof(double));
  for (int c = 0; c < k6; c++) {
    double *load = &r->acc[6 * model->coupled[c / 6] + c % 6];
    *load = 1;
    const double *x = mbd_kkt_solve(kkt, r->acc);
    *load = 0;
    if (!x)
      return false;
    for (int e = 0; e < k6; e++)
      r->Y[e * k6 + c] = x[6 * model->coupled[e / 6] + e % 6];
  }
  for (int c = 0; c < k6; c++)
    for (int e = 0; e < c; e++)
      r->Y[c * k6 + e] = r->Y[e * k6 + c] = 0.5 * (r->Y[c * k6 + e] + r->Y[e * k6 + c]);
  return true;
}

/* an entry of K or C; bodies that it ties both take part, or neither */
static void add_entry(const mbd_reduced *r, double *matrix, int row, int col, double value) {
  const int a = r->place[row / 6], b = r->place[col / 6];
  if (a >= 0)
    matrix[(6 * a + row % 6) * r->nv + 6 * b + col % 6] += value;
}

static void add_entry_K(void *context, int row, int col, double value) {
  mbd_reduced *r = context;
  add_entry(r, r->K, row, col, value);
}

static void add_entry_C(void *context, int row, int col, double value) {
  mbd_reduced *r = context;
  add_entry(r, r->C, row, col, value);
}

/* A_k and A_c */
static void linearise(const mbd_model *model, mbd_data *data, mbd_reduced *r) {
  const size_t size = (size_t)r->nv * (size_t)r->nv * sizeof(double);
  particular(r, r->bias, r->b);
  mass_times(model, data, r, r->b, r->Mb, 1);
  memcpy(r->lambda, data->lambda, (size_t)model->nrow * sizeof(double));
  subtract_reaction(r, r->Mb, r->lambda);
  memcpy(r->acc, data->acceleration, 6 * (size_t)model->nbody * sizeof(double));
  for (int k = 0; k < r->nv; k++)
    r->acc[6 * r->body[k / 6] + k % 6] -= r->b[k];
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
  for (int b = 0; b < r->nbody; b++) {
    const mbd_kin *kin = &data->kin[r->body[b] + 1];
    tdm_mat3 J = mbd_inertia_world(&model->body[r->body[b]], kin), W = tdm_m3_skew(kin->w);
    tdm_mat3 WJ = tdm_m3_mat(W, J), JW = tdm_m3_mat(J, W);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        r->K[(6 * b + 3 + i) * r->nv + 6 * b + 3 + j] = WJ.m[i][j] - JW.m[i][j];
  }
  follow(r, r->E2);
  for (int c = 0; c < k6; c++)
    for (int j = 0; j < f; j++)
      r->J_rate[c * f + j] = r->B_rate[j * k6 + c] = r->X[coupled_row(model, r, c) * f + j];
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
  *out = (tdm_mobility){.nbody = model->ncoupled, .Y = r->Y};
  if (r->freedom > TDM_FREE_MAX)
    return mobility_alone(model, kkt, r);
  collect(model, data, r);
  if (!decompose(r))
    return mobility_alone(model, kkt, r);
  factor_mass(model, data, r);
  mobility(model, r);
  linearise(model, data, r);
  rates(model, data, r);
  for (int b = 0; b < r->nbody; b++) {
    memcpy(r->V + 6 * b, y + MBD_BODY_UNKNOWNS * r->body[b] + MBD_V, 6 * sizeof(double));
    memcpy(r->a + 6 * b, data->acceleration + 6 * r->body[b], 6 * sizeof(double));
  }
  independent_part(r, r->V, r->u1);
  independent_part(r, r->a, r->u2);
  *out = (tdm_mobility){model->ncoupled, r->nfree,   r->Y,      r->u1,    r->u2, r->J, r->B,
                        r->stiffness,    r->damping, r->J_rate, r->B_rate};
  return true;
}
