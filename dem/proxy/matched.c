/* The load that ends where the proxy ended: see matched.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/proxy/matched.h"

#include "protocol/math/legendre.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
  PARABOLA = 3,                      /* functions that the moments take care of */
  FUNCTIONS = PARABOLA + TDM_FURTHER /* P_0 ... P_8 */
};

/* omega H below which the parabola is as good as exact (its error is of order (omega H)^5) */
static const double least_swing = 0.1;
/* share of what a direction feels that polynomials must be able to say */
static const double least_share = 0.01;
/* of <phi, phi>: what is round-off there */
static const double round_off = 1e-12;
/* of the largest mobility: components that move less are blocked */
static const double blocked = 1e-10;

struct dem_matched {
  int k6, f;
  bool on;       /* this window is matched */
  uint64_t n;    /* its steps */
  uint64_t step; /* that are over */
  double dt;     /* [s] */
  const double *E;
  double *scale;                               /* (k6) sqrt(Y_ii); 0: blocked */
  double *B;                                   /* (f x k6) half a kick: dt^2/2 B */
  double *y;                                   /* (2f) what the kicks have led to so far */
  double *next;                                /* (2f) scratch; at the end what the polynomial leaves of delta u' */
  double *moment;                              /* (k6 x TDM_FURTHER) <P_j, W>, j = 3, ... */
  double *coefficient;                         /* (k6 x FUNCTIONS) c_j, of loads times `scale` */
  gsl_matrix *X;                               /* (2f x k6) a kick, of loads times `scale` */
  gsl_matrix *power;                           /* (2f x 2f) E^N */
  gsl_matrix *gram;                            /* (2f x 2f) sum of phi phi^T */
  gsl_matrix *square[2];                       /* (2f x 2f) scratch */
  gsl_matrix *sum[FUNCTIONS];                  /* (2f x k6) sums of phi times powers of s, then <phi, Q_j> */
  gsl_matrix *tall;                            /* (2f x k6) scratch */
  gsl_vector *mu, *residual, *inverse, *image; /* (2f) */
  gsl_eigen_gensymmv_workspace *eigen;
};

/* ---- memory ---- */

static void release(dem_matched *m) {
  gsl_matrix **const matrices[] = {&m->X, &m->power, &m->gram, &m->square[0], &m->square[1], &m->tall};
  gsl_vector **const vectors[] = {&m->mu, &m->residual, &m->inverse, &m->image};
  for (size_t i = 0; i < sizeof matrices / sizeof matrices[0]; i++) {
    gsl_matrix_free(*matrices[i]);
    *matrices[i] = NULL;
  }
  for (int j = 0; j < FUNCTIONS; j++) {
    gsl_matrix_free(m->sum[j]);
    m->sum[j] = NULL;
  }
  for (size_t i = 0; i < sizeof vectors / sizeof vectors[0]; i++) {
    gsl_vector_free(*vectors[i]);
    *vectors[i] = NULL;
  }
  gsl_eigen_gensymmv_free(m->eigen);
  m->eigen = NULL;
  free(m->B);
  free(m->y);
  m->B = m->y = NULL;
  m->f = 0;
}

/* Room for f independent velocities. */
static tdm_status reserve(dem_matched *m, int f) {
  if (m->f == f)
    return TDM_OK;
  release(m);
  const size_t two = 2 * (size_t)f, k = (size_t)m->k6;
  m->B = calloc((size_t)f * k, sizeof *m->B);
  m->y = calloc(2 * two, sizeof *m->y);
  m->X = gsl_matrix_calloc(two, k);
  m->tall = gsl_matrix_alloc(two, k);
  m->power = gsl_matrix_alloc(two, two);
  m->gram = gsl_matrix_alloc(two, two);
  m->square[0] = gsl_matrix_alloc(two, two);
  m->square[1] = gsl_matrix_alloc(two, two);
  m->mu = gsl_vector_alloc(two);
  m->residual = gsl_vector_alloc(two);
  m->inverse = gsl_vector_alloc(two);
  m->image = gsl_vector_alloc(two);
  m->eigen = gsl_eigen_gensymmv_alloc(two);
  bool good = m->B && m->y && m->X && m->tall && m->power && m->gram && m->square[0] && m->square[1] && m->mu &&
              m->residual && m->inverse && m->image && m->eigen;
  for (int j = 0; j < FUNCTIONS; j++) {
    m->sum[j] = gsl_matrix_alloc(two, k);
    good = good && m->sum[j];
  }
  m->next = m->y + two;
  m->f = good ? f : 0;
  return good ? TDM_OK : TDM_ERR_MEMORY;
}

dem_matched *dem_matched_create(int k) {
  dem_matched *m = calloc(1, sizeof *m);
  if (!m)
    return NULL;
  m->k6 = 6 * k;
  m->scale = calloc((size_t)m->k6 + 1, sizeof *m->scale);
  m->moment = calloc((size_t)m->k6 * TDM_FURTHER + 1, sizeof *m->moment);
  m->coefficient = calloc((size_t)m->k6 * FUNCTIONS + 1, sizeof *m->coefficient);
  if (!m->scale || !m->moment || !m->coefficient)
    dem_matched_destroy(&m);
  return m;
}

void dem_matched_destroy(dem_matched **matched) {
  dem_matched *m = *matched;
  if (!m)
    return;
  release(m);
  free(m->scale);
  free(m->moment);
  free(m->coefficient);
  free(m);
  *matched = NULL;
}

/* ---- the window's kicks ---- */

/* largest sum of the magnitudes in a row of an n x n matrix */
static double row_norm(int n, const double *a) {
  double most = 0;
  for (int i = 0; i < n; i++) {
    double sum = 0;
    for (int j = 0; j < n; j++)
      sum += fabs(a[i * n + j]);
    most = fmax(most, sum);
  }
  return most;
}

/* how far the mechanism swings, or comes to rest, within H [rad] */
static double swing(const tdm_mobility *model, double H) {
  const int f = model->nfree;
  return H * fmax(sqrt(row_norm(f, model->stiffness)), row_norm(f, model->damping));
}

tdm_status dem_matched_begin(dem_matched *m, const tdm_mobility *model, uint64_t n, double dt, const double *E) {
  const int f = model->nfree, k = m->k6;
  const double H = (double)n * dt;
  double most = 0;
  m->on = f > 0 && k > 0 && n > PARABOLA + 1 && swing(model, H) > least_swing;
  if (!m->on)
    return TDM_OK;
  if (reserve(m, f)) {
    m->on = false;
    return TDM_ERR_MEMORY;
  }
  m->n = n;
  m->step = 0;
  m->dt = dt;
  memset(m->moment, 0, (size_t)k * TDM_FURTHER * sizeof *m->moment);
  m->E = E;
  memset(m->y, 0, 2 * (size_t)f * sizeof *m->y);
  for (int i = 0; i < k; i++)
    most = fmax(most, model->Y[i * k + i]);
  for (int i = 0; i < k; i++) {
    const double Y = model->Y[i * k + i];
    m->scale[i] = Y > blocked * most ? sqrt(Y) : 0;
    for (int j = 0; j < f; j++) {
      const double kick = dt * dt * (model->B[j * k + i] + 0.5 * H * model->B_rate[j * k + i]);
      m->B[j * k + i] = 0.5 * kick;
      gsl_matrix_set(m->X, (size_t)(f + j), (size_t)i, m->scale[i] > 0 ? kick / m->scale[i] : 0);
    }
  }
  return TDM_OK;
}

/* P_0 ... P_8 at x */
static void legendre(double x, double *P) {
  P[0] = 1;
  P[1] = x;
  for (int j = 1; j < FUNCTIONS - 1; j++)
    P[j + 1] = ((2 * j + 1) * x * P[j] - j * P[j - 1]) / (j + 1);
}

void dem_matched_half_kick(dem_matched *m, const double *W) {
  double P[FUNCTIONS];
  if (!m->on)
    return;
  for (int j = 0; j < m->f; j++) {
    double sum = 0;
    for (int i = 0; i < m->k6; i++)
      sum += m->scale[i] > 0 ? m->B[j * m->k6 + i] * W[i] : 0;
    m->y[m->f + j] += sum;
  }
  legendre(2 * (double)m->step / (double)m->n - 1, P);
  for (int i = 0; i < m->k6; i++)
    for (int j = 0; j < TDM_FURTHER; j++)
      m->moment[i * TDM_FURTHER + j] += 0.5 / (double)m->n * P[PARABOLA + j] * W[i];
}

void dem_matched_flow(dem_matched *m) {
  const int two = 2 * m->f;
  if (!m->on)
    return;
  for (int i = 0; i < two; i++) {
    m->next[i] = 0;
    for (int j = 0; j < two; j++)
      m->next[i] += m->E[i * two + j] * m->y[j];
  }
  memcpy(m->y, m->next, (size_t)two * sizeof *m->y);
  m->step++;
}

/* ---- sums over the steps ---- */

/* gram <- gram + (or, with a sign, less) A A^T */
static void add_square(gsl_matrix *gram, double sign, const gsl_matrix *A) {
  gsl_blas_dgemm(CblasNoTrans, CblasTrans, sign, A, A, 1, gram);
}

/* A <- P A P^T */
static void carry(const dem_matched *m, const gsl_matrix *P, gsl_matrix *A) {
  gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, P, A, 0, m->square[0]);
  gsl_blas_dgemm(CblasNoTrans, CblasTrans, 1, m->square[0], P, 0, A);
}

static void multiply_power(dem_matched *m, const gsl_matrix *by) {
  gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, m->power, by, 0, m->square[0]);
  gsl_matrix_memcpy(m->power, m->square[0]);
}

/* sum[p] <- by sum[p] */
static void carry_sum(dem_matched *m, const gsl_matrix *by, int p) {
  gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, by, m->sum[p], 0, m->tall);
  gsl_matrix_memcpy(m->sum[p], m->tall);
}

/* a <- a + s b */
static void add(gsl_matrix *a, double s, const gsl_matrix *b) {
  for (size_t i = 0; i < a->size1; i++)
    for (size_t j = 0; j < a->size2; j++)
      *gsl_matrix_ptr(a, i, j) += s * gsl_matrix_get(b, i, j);
}

/* From sums over N steps to those over 2N:  S_p <- E^N S_p + sum_q (p over q) (N/n)^(p-q) S_q. */
static void twice(dem_matched *m, int nfunction, double at) {
  for (int p = nfunction - 1; p >= 0; p--) {
    double factor = 1; /* (p over q) at^(p-q) */
    gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, m->power, m->sum[p], 0, m->tall);
    for (int q = p; q >= 0; q--) {
      add(m->tall, factor, m->sum[q]);
      factor *= at * q / (p - q + 1);
    }
    gsl_matrix_memcpy(m->sum[p], m->tall);
  }
  gsl_matrix_memcpy(m->square[1], m->gram);
  carry(m, m->power, m->square[1]);
  gsl_matrix_add(m->gram, m->square[1]);
  gsl_matrix_memcpy(m->square[1], m->power);
  multiply_power(m, m->square[1]);
}

/* ... and to those over N + 1. */
static void one_more(dem_matched *m, const gsl_matrix *E, int nfunction, double at) {
  double factor = 1;
  for (int p = 0; p < nfunction; p++, factor *= at) {
    carry_sum(m, E, p);
    add(m->sum[p], factor, m->X);
  }
  carry(m, E, m->gram);
  add_square(m->gram, 1, m->X);
  multiply_power(m, E);
}

/* n <phi, s^p>, p < nfunction, and n <phi, phi^T>: sums over i < n by doubling, with half weights at both ends. */
static void sum_up(dem_matched *m, int nfunction) {
  const size_t two = 2 * (size_t)m->f;
  gsl_matrix_const_view E = gsl_matrix_const_view_array(m->E, two, two);
  uint64_t bit = 1, N = 1;
  while (bit <= m->n / 2)
    bit *= 2;
  gsl_matrix_memcpy(m->power, &E.matrix);
  gsl_matrix_set_zero(m->gram);
  add_square(m->gram, 1, m->X);
  for (int p = 0; p < nfunction; p++)
    gsl_matrix_set_zero(m->sum[p]);
  gsl_matrix_memcpy(m->sum[0], m->X);
  for (bit /= 2; bit > 0; bit /= 2) {
    twice(m, nfunction, (double)N / (double)m->n);
    N *= 2;
    if (m->n & bit)
      one_more(m, &E.matrix, nfunction, (double)N++ / (double)m->n);
  }
  /* so far E^(n-1-i) X: a step more, less half the first kick, and half the last */
  carry(m, &E.matrix, m->gram);
  for (int p = 0; p < nfunction; p++) {
    carry_sum(m, &E.matrix, p);
    add(m->sum[p], 0.5, m->X);
  }
  add_square(m->gram, 0.5, m->X);
  gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, m->power, m->X, 0, m->tall);
  add(m->sum[0], -0.5, m->tall);
  add_square(m->gram, -0.5, m->tall);
}

/* ---- the functions ---- */

/* <1, P_j>, <x, P_j>, <Q_2, P_j> for the kicks of n steps. */
typedef struct {
  double one[FUNCTIONS], x[FUNCTIONS], bend[FUNCTIONS];
} products;

static products of_kicks(uint64_t n) {
  products of = {0};
  for (uint64_t i = 0; i <= n; i++) {
    const double x = 2 * (double)i / (double)n - 1, w = (i == 0 || i == n ? 0.5 : 1) / (double)n;
    double P[FUNCTIONS];
    legendre(x, P);
    for (int j = 0; j < FUNCTIONS; j++) {
      of.one[j] += w * P[j];
      of.x[j] += w * x * P[j];
      of.bend[j] += w * P[2] * P[j];
    }
  }
  for (int j = FUNCTIONS - 1; j >= 0; j--)
    of.bend[j] -= of.one[2] * of.one[j];
  return of;
}

/* From sums with powers of s to <phi, Q_j>. */
static void to_functions(dem_matched *m, int nfunction, const products *of) {
  for (int j = nfunction - 1; j >= 0; j--) { /* downwards: P_j needs powers up to j only */
    double c[FUNCTIONS];
    tdm_legendre_powers(j, c);
    gsl_matrix_scale(m->sum[j], c[j]);
    for (int p = 0; p < j; p++)
      add(m->sum[j], c[p], m->sum[p]);
  }
  for (int j = 0; j < nfunction; j++) {
    gsl_matrix_scale(m->sum[j], 1 / (double)m->n);
    if (j > 1 && j % 2 == 0)
      add(m->sum[j], -of->one[j], m->sum[0]);
    else if (j > 1)
      add(m->sum[j], -of->x[j] / of->x[1], m->sum[1]);
  }
}

/* The polynomial nearest to the load (c_j of Q_j, of loads times `scale`), and r, what it leaves of the end. */
static void fit(dem_matched *m, int nfunction, const products *of, const tdm_interface *body) {
  memset(m->coefficient, 0, (size_t)m->k6 * FUNCTIONS * sizeof *m->coefficient);
  for (int l = 0; l < m->k6; l++) {
    double *c = m->coefficient + l * FUNCTIONS, moment[PARABOLA];
    for (int j = 0; j < PARABOLA; j++)
      moment[j] = m->scale[l] * ((const double *)(const void *)&body[l / 6].moment[j])[l % 6];
    c[0] = moment[0];
    c[1] = moment[1] / of->x[1];
    c[2] = (moment[2] - of->one[2] * moment[0]) / of->bend[2];
    for (int j = PARABOLA; j < nfunction; j++) {
      const double beside = j % 2 ? of->x[j] * c[1] : of->one[j] * c[0] + of->bend[j] * c[2];
      c[j] = (2 * j + 1) * (m->scale[l] * m->moment[l * TDM_FURTHER + j - PARABOLA] - beside);
    }
  }
  for (int i = 0; i < 2 * m->f; i++) {
    double r = m->y[i] / (double)m->n;
    for (int l = 0; l < m->k6; l++)
      for (int j = 0; j < nfunction; j++)
        r -= gsl_matrix_get(m->sum[j], (size_t)i, (size_t)l) * m->coefficient[l * FUNCTIONS + j];
    gsl_vector_set(m->residual, (size_t)i, r);
    if (i >= m->f)
      m->next[i - m->f] = r * (double)m->n / m->dt;
  }
}

/* Rows and columns of A over sqrt(<phi, phi>) of theirs. */
static void to_shares(const dem_matched *m, gsl_matrix *A) {
  for (size_t i = 0; i < A->size1; i++)
    for (size_t j = 0; j < A->size2; j++)
      *gsl_matrix_ptr(A, i, j) *= gsl_vector_get(m->inverse, i) * gsl_vector_get(m->inverse, j);
}

/* N in `gram` and G G^T in `kept`, both in shares. */
static void take_shares(dem_matched *m, int nfunction, const products *of, gsl_matrix *kept) {
  const double square[PARABOLA] = {1, of->x[1], of->bend[2]}; /* <Q_j, Q_j> */
  gsl_matrix_scale(m->gram, 1 / (double)m->n);
  for (size_t i = 0; i < m->gram->size1; i++) {
    const double all = gsl_matrix_get(m->gram, i, i);
    gsl_vector_set(m->inverse, i, all > 0 ? 1 / sqrt(all) : 0);
  }
  for (int j = 0; j < PARABOLA; j++)
    add_square(m->gram, -1 / square[j], m->sum[j]);
  gsl_matrix_set_zero(kept);
  for (int j = PARABOLA; j < nfunction; j++)
    add_square(kept, 2 * j + 1, m->sum[j]);
  to_shares(m, kept);
  to_shares(m, m->gram);
  for (size_t i = 0; i < m->gram->size1; i++)
    *gsl_matrix_ptr(m->gram, i, i) += round_off;
}

/* The least load that makes up for r, direction by direction, on top of the fit. */
static void make_up(dem_matched *m, int nfunction, const gsl_matrix *kept) {
  gsl_matrix *A = m->square[0], *v = m->square[1];
  const int square = (int)(kept->size1 * kept->size2);
  if (!tdm_finite(kept->data, square) || !tdm_finite(m->gram->data, square))
    return;                   /* a mechanism that has run away; the decomposition would not end */
  gsl_matrix_memcpy(A, kept); /* the decomposition destroys it */
  if (gsl_eigen_gensymmv(A, m->gram, m->mu, v, m->eigen) != GSL_SUCCESS)
    return;
  gsl_vector_mul(m->residual, m->inverse);
  for (size_t e = 0; e < v->size1; e++) {
    double along, size;
    gsl_vector_view column = gsl_matrix_column(v, e);
    if (!(gsl_vector_get(m->mu, e) >= least_share))
      continue;
    gsl_blas_dgemv(CblasNoTrans, 1, kept, &column.vector, 0, m->image);
    gsl_blas_ddot(&column.vector, m->image, &size);
    gsl_blas_ddot(&column.vector, m->residual, &along);
    gsl_vector_memcpy(m->image, &column.vector);
    gsl_vector_mul(m->image, m->inverse);
    for (int l = 0; l < m->k6; l++)
      for (int j = PARABOLA; j < nfunction; j++) {
        double g;
        gsl_vector_view of = gsl_matrix_column(m->sum[j], (size_t)l);
        gsl_blas_ddot(&of.vector, m->image, &g);
        m->coefficient[l * FUNCTIONS + j] += (2 * j + 1) * g * along / size;
      }
  }
}

void dem_matched_end(dem_matched *m, const tdm_interface *body, tdm_wrench *further) {
  memset(further, 0, (size_t)(m->k6 / 6) * TDM_FURTHER * sizeof *further);
  if (!m->on)
    return;
  const int nfunction = m->n < FUNCTIONS ? (int)m->n : FUNCTIONS; /* so many differ at the kicks */
  const products of = of_kicks(m->n);
  gsl_matrix *kept = m->power; /* which is not needed any more */
  sum_up(m, nfunction);
  to_functions(m, nfunction, &of);
  fit(m, nfunction, &of, body);
  take_shares(m, nfunction, &of, kept);
  make_up(m, nfunction, kept);
  for (int l = 0; l < m->k6; l++)
    for (int j = 0; j < TDM_FURTHER; j++) {
      double *to = (double *)(void *)&further[(l / 6) * TDM_FURTHER + j] + l % 6;
      *to = m->scale[l] > 0 ? m->coefficient[l * FUNCTIONS + PARABOLA + j] / m->scale[l] : 0;
    }
}

const double *dem_matched_rest(const dem_matched *m) {
  return m->on ? m->next : NULL;
}
