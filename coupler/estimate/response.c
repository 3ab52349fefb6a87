/* How coupled bodies answer to a force: see response.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/estimate/response.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit.h>
#include <math.h>
#include <stdlib.h>

enum { DRIVEN = 4 };                 /* powers of the time from 0 on */
static const double good_fit = 0.95; /* share of what the force varies by that stiffness and damping must tell */
static const double too_large = 1e100;
static const double same_way = 1e-8; /* directions of the least squares below this share of the largest are left out */
static const double same_length = 1e-9; /* of rows */

cpl_part cpl_part_of(const cpl_trace *t, int k) {
  return (cpl_part){t, k, t->nrow + (t->last.t > t->row[t->nrow - 1].t)};
}

const cpl_trace_row *cpl_part_row(const cpl_part *p, int i) {
  return i < p->trace->nrow ? &p->trace->row[i] : &p->trace->last;
}

/* ---- what the mechanism holds the bodies by ---- */

/* Means from row i to the next: of the load that MBD got, of the mechanism's force G = M x'' - F, of way and rate (the
 * way by the cubic of both ends, from the start of the run). */
static void means_at(const cpl_part *p, int i, double *load, double *force, double *way, double *rate) {
  const cpl_trace_row *a = cpl_part_row(p, i), *b = cpl_part_row(p, i + 1);
  const double h = b->t - a->t;
  *load = (b->got[p->k] - a->got[p->k]) / h;
  *force = p->trace->mass[p->k] * (b->rate[p->k] - a->rate[p->k]) / h - *load;
  *way = 0.5 * (a->way[p->k] + b->way[p->k]) + h / 12 * (a->rate[p->k] - b->rate[p->k]);
  *rate = (b->way[p->k] - a->way[p->k]) / h;
}

/* Row i of the least squares: differences of the means from one row to the next, in which weight does not count, and
 * powers of the time for drivers that are slow. */
static void differences_at(int n, const cpl_part *part, int i, gsl_matrix *x, gsl_matrix *force, gsl_matrix *load) {
  const double end = cpl_part_row(part, part->n - 1)->t, time = 2 * cpl_part_row(part, i + 1)->t / end - 1;
  for (int j = 0; j < DRIVEN; j++)
    gsl_matrix_set(x, (size_t)i, (size_t)(2 * n + j), pow(time, j));
  for (int j = 0; j < n; j++) {
    double l[2], g[2], w[2], r[2];
    for (int s = 0; s < 2; s++)
      means_at(&part[j], i + s, &l[s], &g[s], &w[s], &r[s]);
    gsl_matrix_set(x, (size_t)i, (size_t)j, w[0] - w[1]);
    gsl_matrix_set(x, (size_t)i, (size_t)(n + j), r[0] - r[1]);
    gsl_matrix_set(force, (size_t)j, (size_t)i, g[1] - g[0]);
    gsl_matrix_set(load, (size_t)j, (size_t)i, l[1] - l[0]);
  }
}

/* Springs push back on both ends alike: is the stiffness symmetric (scaled by inertias), as far as a good fit is? What
 * a driver makes of a motion, and least squares of too few frequencies, are not. */
static bool reciprocal(int n, const cpl_part *part, double stiffness[][CPL_RESPONSE_PARTS]) {
  double all = 0, skew = 0;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      const double inertia = part[i].trace->mass[part[i].k] * part[j].trace->mass[part[j].k];
      all += stiffness[i][j] * stiffness[i][j] / inertia;
      skew += pow(stiffness[i][j] - stiffness[j][i], 2) / inertia;
    }
  return skew <= pow(1 - good_fit, 2) * all;
}

bool cpl_response_mechanism(int n, const cpl_part *part, double stiffness[][CPL_RESPONSE_PARTS],
                            double damping[][CPL_RESPONSE_PARTS], bool *known) {
  const size_t rows = (size_t)(part[0].n > 2 ? part[0].n - 2 : 0), terms = 2 * (size_t)n + DRIVEN;
  *known = rows > 2 * terms;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++)
      stiffness[i][j] = damping[i][j] = 0;
  if (!*known)
    return true;
  gsl_matrix *x = gsl_matrix_alloc(rows, terms), *covariance = gsl_matrix_alloc(terms, terms);
  gsl_matrix *force = gsl_matrix_alloc((size_t)n, rows), *load = gsl_matrix_alloc((size_t)n, rows);
  gsl_vector *c = gsl_vector_alloc(terms);
  gsl_multifit_linear_workspace *work = gsl_multifit_linear_alloc(rows, terms);
  const bool room = x && covariance && force && load && c && work;
  for (size_t i = 0; room && i < rows; i++)
    differences_at(n, part, (int)i, x, force, load);
  for (size_t j = 0; room && j < terms; j++) { /* a run that blew up has no numbers to decompose */
    const gsl_vector_view column = gsl_matrix_column(x, j);
    *known = *known && gsl_blas_dnrm2(&column.vector) < too_large;
  }
  for (int i = 0; room && *known && i < n; i++) {
    const gsl_vector_view y = gsl_matrix_row(force, (size_t)i), f = gsl_matrix_row(load, (size_t)i);
    const double varies = fmax(gsl_blas_dnrm2(&y.vector), gsl_blas_dnrm2(&f.vector));
    double rest;
    size_t rank;
    gsl_multifit_linear_tsvd(x, &y.vector, same_way, c, covariance, &rest, &rank, work);
    *known = rest <= (1 - good_fit) * varies * varies; /* false for NaN */
    for (int j = 0; j < n; j++) {
      stiffness[i][j] = gsl_vector_get(c, (size_t)j);
      damping[i][j] = gsl_vector_get(c, (size_t)(n + j));
    }
  }
  *known = *known && room && reciprocal(n, part, stiffness);
  gsl_matrix_free(x);
  gsl_matrix_free(covariance);
  gsl_matrix_free(force);
  gsl_matrix_free(load);
  gsl_vector_free(c);
  gsl_multifit_linear_free(work);
  return room;
}

/* ---- what comes of it ---- */

/* (e, e')' = A (e, e'), into the upper left of `a`. */
static void system_of(const cpl_response *r, gsl_matrix *a) {
  gsl_matrix_set_zero(a);
  for (int i = 0; i < r->n; i++) {
    gsl_matrix_set(a, (size_t)i, (size_t)(r->n + i), 1);
    for (int j = 0; j < r->n; j++) {
      gsl_matrix_set(a, (size_t)(r->n + i), (size_t)j, -r->stiffness[i][j]);
      gsl_matrix_set(a, (size_t)(r->n + i), (size_t)(r->n + j), -r->damping[i][j]);
    }
  }
}

bool cpl_response_stable(const cpl_response *r, double time) {
  const size_t size = 2 * (size_t)r->n;
  gsl_matrix *a = gsl_matrix_alloc(size, size);
  gsl_vector_complex *value = gsl_vector_complex_alloc(size);
  gsl_eigen_nonsymm_workspace *work = gsl_eigen_nonsymm_alloc(size);
  bool stable = a && value && work;
  if (stable) {
    system_of(r, a);
    stable = gsl_eigen_nonsymm(a, value, work) == GSL_SUCCESS;
  }
  for (size_t i = 0; stable && i < size; i++)
    stable = GSL_REAL(gsl_vector_complex_get(value, i)) * time < 1;
  gsl_matrix_free(a);
  gsl_vector_complex_free(value);
  gsl_eigen_nonsymm_free(work);
  return stable;
}

struct cpl_carrier {
  cpl_response response;
  double h;                   /* of the solution that there is [s] */
  gsl_matrix *scaled, *after; /* A h with a column for each constant force, and its exponential */
  gsl_vector *from, *to;
};

cpl_carrier *cpl_carrier_create(const cpl_response *r) {
  cpl_carrier *c = calloc(1, sizeof *c);
  const size_t size = 3 * (size_t)r->n;
  if (!c)
    return NULL;
  c->response = *r;
  c->scaled = gsl_matrix_alloc(size, size);
  c->after = gsl_matrix_alloc(size, size);
  c->from = gsl_vector_alloc(size);
  c->to = gsl_vector_alloc(size);
  if (!c->scaled || !c->after || !c->from || !c->to)
    cpl_carrier_destroy(&c);
  return c;
}

void cpl_carrier_destroy(cpl_carrier **carrier) {
  cpl_carrier *c = *carrier;
  *carrier = NULL;
  if (!c)
    return;
  gsl_matrix_free(c->scaled);
  gsl_matrix_free(c->after);
  gsl_vector_free(c->from);
  gsl_vector_free(c->to);
  free(c);
}

static void solve_for(cpl_carrier *c, double h) {
  const size_t n = (size_t)c->response.n;
  system_of(&c->response, c->scaled);
  for (size_t i = 0; i < n; i++)
    gsl_matrix_set(c->scaled, n + i, 2 * n + i, 1); /* accelerations, which do not change */
  gsl_matrix_scale(c->scaled, h);
  gsl_linalg_exponential_ss(c->scaled, c->after, GSL_PREC_DOUBLE);
  c->h = h;
}

void cpl_carrier_go(cpl_carrier *c, double h, const double *impulse, double *e) {
  const size_t n = (size_t)c->response.n;
  if (!(fabs(h - c->h) <= same_length * h))
    solve_for(c, h);
  for (size_t i = 0; i < 2 * n; i++)
    gsl_vector_set(c->from, i, e[i]);
  for (size_t i = 0; i < n; i++)
    gsl_vector_set(c->from, 2 * n + i, impulse[i] / (h * c->response.inertia[i]));
  gsl_blas_dgemv(CblasNoTrans, 1, c->after, c->from, 0, c->to);
  for (size_t i = 0; i < 2 * n; i++)
    e[i] = gsl_vector_get(c->to, i);
}
