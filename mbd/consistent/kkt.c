/* The linear system of consistent states, in twist coordinates: see kkt.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/consistent/kkt.h"

#include "mbd/linear/sparse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct mbd_kkt {
  int nv, nrow, n;              /* 6 nbody, nrow, their sum */
  mbd_sparse *matrix, *sharing; /* the system, and that of mbd_kkt_share */
  double *x, *b, *size;         /* (n), (nrow), (nrow) s_i */
  double *rhs, *r, *dx, *term;  /* (n) right-hand side, residual, correction, largest term of each equation */
  double length;                /* [m] rotations count as ways at it */
  double regularisation;        /* share of (G M^-1 G^T)_ii on the diagonal where the rank is not known */
};

/* Beside G in mbd_kkt_share: makes motions that no row resists determinate. */
static const double resistance = 1e-9;

/* The share of (G M^-1 G^T)_ii that stands on the diagonal where the rank is not known: well below what light and heavy
 * bodies (or thin ones, about their axis) make of the smallest eigenvalue, or Newton's iteration would creep. */
static double regularisation_for(const mbd_model *model, double length) {
  double least = INFINITY, most = 0;
  for (int b = 0; b < model->nbody; b++) {
    const tdm_mat3 *inverse = &model->body[b].inverse_inertia;
    double along = 1 / model->body[b].mass;
    double about = length * length * (inverse->m[0][0] + inverse->m[1][1] + inverse->m[2][2]) / 3;
    least = fmin(least, fmin(along, about));
    most = fmax(most, fmax(along, about));
  }
  return most > 0 ? 1e-7 * fmin(1, 1e4 * least / most) : 1e-7;
}

mbd_kkt *mbd_kkt_create(const mbd_model *model) {
  mbd_kkt *k = calloc(1, sizeof *k);
  if (!k)
    return NULL;
  k->nv = 6 * model->nbody;
  k->nrow = model->nrow;
  k->n = k->nv + model->nrow;
  k->matrix = mbd_sparse_create(k->n);
  k->sharing = mbd_sparse_create(k->n);
  k->x = calloc((size_t)k->n + 1, sizeof(double));
  k->b = calloc((size_t)k->nrow + 1, sizeof(double));
  k->size = calloc((size_t)k->nrow + 1, sizeof(double));
  k->rhs = calloc((size_t)k->n + 1, sizeof(double));
  k->r = calloc((size_t)k->n + 1, sizeof(double));
  k->dx = calloc((size_t)k->n + 1, sizeof(double));
  k->term = calloc((size_t)k->n + 1, sizeof(double));
  double extent = mbd_model_extent(model);
  k->length = extent > 0 ? extent : 1;
  k->regularisation = regularisation_for(model, k->length);
  if (!k->matrix || !k->sharing || !k->x || !k->b || !k->size || !k->rhs || !k->r || !k->dx || !k->term)
    mbd_kkt_destroy(&k);
  return k;
}

void mbd_kkt_destroy(mbd_kkt **kkt) {
  mbd_kkt *k = kkt ? *kkt : NULL;
  if (!k)
    return;
  mbd_sparse_destroy(&k->matrix);
  mbd_sparse_destroy(&k->sharing);
  free(k->x);
  free(k->b);
  free(k->size);
  free(k->rhs);
  free(k->r);
  free(k->dx);
  free(k->term);
  free(k);
  *kkt = NULL;
}

void mbd_kkt_reset(mbd_kkt *k) {
  mbd_sparse_reset(k->matrix);
  mbd_sparse_reset(k->sharing);
}

double *mbd_kkt_b(mbd_kkt *k) {
  return k->b;
}

/* ---- filling ---- */

static void add_masses(mbd_sparse *matrix, const mbd_model *model, const mbd_data *data) {
  for (int b = 0; b < model->nbody; b++) {
    tdm_mat3 J = mbd_inertia_world(&model->body[b], &data->kin[b + 1]);
    for (int i = 0; i < 3; i++) {
      int row = 6 * b + i;
      mbd_sparse_add(matrix, row, row, model->body[b].mass);
      for (int k = 0; k < 3; k++)
        mbd_sparse_add(matrix, row + 3, 6 * b + 3 + k, J.m[i][k]);
    }
  }
}

/* G and G^T of one part. */
static void add_rows(mbd_sparse *matrix, int nv, const mbd_rows *rows, const bool *dependent) {
  for (int k = 0; k < rows->n; k++) {
    int row = nv + rows->first + k;
    double keep = dependent && dependent[rows->first + k] ? 0 : 1;
    for (int side = 0; side < 2; side++)
      for (int i = 0; i < 6 && rows->body[side] != MBD_GROUND; i++) {
        double value = keep * rows->G[k][6 * side + i];
        mbd_sparse_add(matrix, row, 6 * rows->body[side] + i, value);
        mbd_sparse_add(matrix, 6 * rows->body[side] + i, row, value);
      }
  }
}

/* -g, -G V - g_t or -V^T H V - g_tt of one part into b. */
static void add_right_hand_side(mbd_kkt *kkt, const mbd_data *data, const mbd_rows *rows, mbd_level level) {
  double twist[MBD_PAIR];
  mbd_pair_twist(&data->kin[rows->body[0] + 1], &data->kin[rows->body[1] + 1], twist);
  for (int k = 0; k < rows->n; k++) {
    double sum = level == MBD_POSITION ? rows->g[k] : level == MBD_VELOCITY ? rows->g_t[k] : rows->g_tt[k];
    for (int i = 0; i < MBD_PAIR && level != MBD_POSITION; i++) {
      double rate = 0;
      for (int l = 0; l < MBD_PAIR && level == MBD_ACCELERATION; l++)
        rate += rows->H[k][i][l] * twist[l];
      sum += twist[i] * (level == MBD_VELOCITY ? rows->G[k][i] : rate);
    }
    kkt->b[rows->first + k] -= sum;
  }
}

static void add_size(mbd_kkt *kkt, const mbd_model *model, const mbd_data *data, const mbd_rows *rows) {
  for (int k = 0; k < rows->n; k++)
    kkt->size[rows->first + k] += mbd_row_mobility(model, data, rows, k);
}

static bool fill(mbd_kkt *kkt, const mbd_model *model, mbd_data *data, mbd_level level, bool all) {
  memset(kkt->b, 0, (size_t)kkt->nrow * sizeof(double));
  memset(kkt->size, 0, (size_t)kkt->nrow * sizeof(double));
  mbd_sparse_begin(kkt->matrix);
  add_masses(kkt->matrix, model, data);
  for (int i = 0; i < model->npart; i++) {
    const mbd_rows *rows = mbd_part_at(model, data, i, level == MBD_ACCELERATION);
    add_rows(kkt->matrix, kkt->nv, rows, all ? NULL : data->dependent);
    add_right_hand_side(kkt, data, rows, level);
    if (all)
      add_size(kkt, model, data, rows);
  }
  for (int i = 0; i < kkt->nrow; i++)
    mbd_sparse_add(kkt->matrix, kkt->nv + i, kkt->nv + i,
                   all                  ? -kkt->regularisation * (kkt->size[i] > 0 ? kkt->size[i] : 1)
                   : data->dependent[i] ? 1
                                        : 0);
  for (int i = 0; i < kkt->nrow && !all; i++)
    if (data->dependent[i])
      kkt->b[i] = 0;
  return mbd_sparse_end(kkt->matrix) != MBD_SPARSE_NO_MEMORY && mbd_sparse_factor(kkt->matrix);
}

bool mbd_kkt_fill(mbd_kkt *kkt, const mbd_model *model, mbd_data *data, mbd_level level) {
  return fill(kkt, model, data, level, false);
}

bool mbd_kkt_fill_all(mbd_kkt *kkt, const mbd_model *model, mbd_data *data, mbd_level level) {
  return fill(kkt, model, data, level, true);
}

/* ---- solving ---- */

static double largest3(const double *x) {
  return fmax(fabs(x[0]), fmax(fabs(x[1]), fabs(x[2])));
}

/* Of the residual: what is left of the sum of forces, or of moments, on a body, over the largest of them; the worst.
 * What is below the rounding of the largest force (moment) of all is none. */
static double unbalance(const mbd_kkt *kkt) {
  double most[2] = {0, 0}, worst = 0;
  for (int k = 0; k < kkt->nv; k += 3)
    most[k % 2] = fmax(most[k % 2], largest3(kkt->term + k));
  for (int k = 0; k < kkt->nv; k += 3) {
    double left = largest3(kkt->r + k), size = largest3(kkt->term + k);
    if (left > 1e-16 * most[k % 2] && !(left <= worst * size))
      worst = left / size;
  }
  return worst;
}

const double *mbd_kkt_solve(mbd_kkt *kkt, const double *f) {
  enum { REFINEMENTS_MAX = 3 };
  const double good = 4e-16;
  for (int i = 0; i < kkt->nv; i++)
    kkt->rhs[i] = f ? f[i] : 0;
  memcpy(kkt->rhs + kkt->nv, kkt->b, (size_t)kkt->nrow * sizeof(double));
  memcpy(kkt->x, kkt->rhs, (size_t)kkt->n * sizeof(double));
  if (!mbd_sparse_solve(kkt->matrix, kkt->x))
    return NULL;
  for (int i = 0; i <= REFINEMENTS_MAX; i++) {
    mbd_sparse_residual(kkt->matrix, kkt->x, kkt->rhs, kkt->r, kkt->term);
    if (i == REFINEMENTS_MAX || unbalance(kkt) <= good)
      break;
    memcpy(kkt->dx, kkt->r, (size_t)kkt->n * sizeof(double));
    if (!mbd_sparse_solve(kkt->matrix, kkt->dx))
      break;
    for (int k = 0; k < kkt->n; k++)
      kkt->x[k] += kkt->dx[k];
  }
  return kkt->x;
}

/* ---- sharing out ---- */

/* The matrix of sharing, [d D, G^T; G, -S], with G and G^T l (into rhs) of all rows on the way. */
static bool fill_sharing(mbd_kkt *kkt, const mbd_model *model, mbd_data *data, const double *l) {
  const double by_turn = 1 / (kkt->length * kkt->length);
  memset(kkt->rhs, 0, (size_t)kkt->n * sizeof(double));
  memset(kkt->size, 0, (size_t)kkt->nrow * sizeof(double));
  mbd_sparse_begin(kkt->sharing);
  for (int k = 0; k < kkt->nv; k++)
    mbd_sparse_add(kkt->sharing, k, k, resistance / (k % 6 < 3 ? 1 : by_turn));
  for (int i = 0; i < model->npart; i++) {
    const mbd_rows *rows = mbd_part_at(model, data, i, false);
    add_rows(kkt->sharing, kkt->nv, rows, NULL);
    for (int k = 0; k < rows->n; k++)
      for (int c = 0; c < MBD_PAIR; c++) {
        const int body = rows->body[c / 6], row = rows->first + k;
        if (body == MBD_GROUND)
          continue;
        kkt->size[row] += rows->G[k][c] * rows->G[k][c] * (c % 6 < 3 ? 1 : by_turn);
        kkt->rhs[6 * body + c % 6] += rows->G[k][c] * l[row];
      }
  }
  for (int i = 0; i < kkt->nrow; i++)
    mbd_sparse_add(kkt->sharing, kkt->nv + i, kkt->nv + i, kkt->size[i] > 0 ? -kkt->size[i] : -1);
  return mbd_sparse_end(kkt->sharing) != MBD_SPARSE_NO_MEMORY && mbd_sparse_factor(kkt->sharing);
}

/* r = R - G^T l with R in rhs and l in x, and the largest terms. The sharing matrix with x = (0, l) gives just that. */
static double reaction_left(mbd_kkt *kkt) {
  memset(kkt->x, 0, (size_t)kkt->nv * sizeof(double));
  mbd_sparse_residual(kkt->sharing, kkt->x, kkt->rhs, kkt->r, kkt->term);
  return unbalance(kkt);
}

/* l = S^-1 G z with G^T l = R, R the reaction. [d D, G^T; G, -S] [z; l] = [R; 0] leaves d D z of it, d small; the same
 * for what is left, and so on, adds what is missing and stays of the form S^-1 G z. Lengths only, no masses: light
 * parts that hold heavy ones do not change how much is left. */
bool mbd_kkt_share(mbd_kkt *kkt, const mbd_model *model, mbd_data *data, double *l) {
  enum { ROUNDS_MAX = 8 };
  const double good = 1e-14, enough = 1e-9;
  double left = INFINITY, last;
  if (!fill_sharing(kkt, model, data, l))
    return false;
  memset(kkt->x, 0, (size_t)kkt->n * sizeof(double));
  for (int i = 0; i < ROUNDS_MAX; i++) {
    last = left;
    left = reaction_left(kkt);
    memcpy(kkt->dx, kkt->r, (size_t)kkt->nv * sizeof(double));
    memset(kkt->dx + kkt->nv, 0, (size_t)kkt->nrow * sizeof(double));
    if (left <= good || left > 0.5 * last || !mbd_sparse_solve(kkt->sharing, kkt->dx))
      break;
    for (int k = kkt->nv; k < kkt->n; k++)
      kkt->x[k] += kkt->dx[k];
  }
  if (left <= enough)
    memcpy(l, kkt->x + kkt->nv, (size_t)kkt->nrow * sizeof(double));
  return true;
}

double mbd_kkt_spread(mbd_kkt *kkt) {
  return mbd_sparse_spread(kkt->matrix);
}
