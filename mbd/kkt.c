#include "mbd/kkt.h"

#include "mbd/sparse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct mbd_kkt {
  int nv, nrow, n;              /* 6 nbody, nrow, their sum */
  mbd_sparse *matrix, *sharing; /* the system, and that of mbd_kkt_share */
  double *x, *b, *size;         /* (n), (nrow), (nrow) s_i */
};

/* share of (G M^-1 G^T)_ii on the diagonal where the rank is not known */
static const double regularisation = 1e-7;
/* share of M beside G in mbd_kkt_share, which makes motions that no row resists determinate */
static const double mass_share = 1e-9;

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
  if (!k->matrix || !k->sharing || !k->x || !k->b || !k->size)
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

/* M times `share`. */
static void add_masses(mbd_sparse *matrix, const mbd_model *model, const mbd_data *data, double share) {
  for (int b = 0; b < model->nbody; b++) {
    tdm_mat3 J = mbd_inertia_world(&model->body[b], &data->kin[b + 1]);
    for (int i = 0; i < 3; i++) {
      int row = 6 * b + i;
      mbd_sparse_add(matrix, row, row, share * model->body[b].mass);
      for (int k = 0; k < 3; k++)
        mbd_sparse_add(matrix, row + 3, 6 * b + 3 + k, share * J.m[i][k]);
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
  add_masses(kkt->matrix, model, data, 1);
  for (int i = 0; i < model->npart; i++) {
    const mbd_rows *rows = mbd_part_at(model, data, i, level == MBD_ACCELERATION);
    add_rows(kkt->matrix, kkt->nv, rows, all ? NULL : data->dependent);
    add_right_hand_side(kkt, data, rows, level);
    if (all)
      add_size(kkt, model, data, rows);
  }
  for (int i = 0; i < kkt->nrow; i++)
    mbd_sparse_add(kkt->matrix, kkt->nv + i, kkt->nv + i,
                   all                  ? -regularisation * (kkt->size[i] > 0 ? kkt->size[i] : 1)
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

const double *mbd_kkt_solve(mbd_kkt *kkt, const double *f) {
  for (int i = 0; i < kkt->nv; i++)
    kkt->x[i] = f ? f[i] : 0;
  memcpy(kkt->x + kkt->nv, kkt->b, (size_t)kkt->nrow * sizeof(double));
  return mbd_sparse_solve(kkt->matrix, kkt->x) ? kkt->x : NULL;
}

/* l = S^-1 G z with G^T l = R, R the reaction: [d M, G^T; G, -S] [z; l] = [R; 0], d small because motions that no row
 * resists are not in R. */
bool mbd_kkt_share(mbd_kkt *kkt, const mbd_model *model, mbd_data *data, double *l) {
  memset(kkt->x, 0, (size_t)kkt->n * sizeof(double));
  memset(kkt->size, 0, (size_t)kkt->nrow * sizeof(double));
  mbd_sparse_begin(kkt->sharing);
  add_masses(kkt->sharing, model, data, mass_share);
  for (int i = 0; i < model->npart; i++) {
    const mbd_rows *rows = mbd_part_at(model, data, i, false);
    add_rows(kkt->sharing, kkt->nv, rows, NULL);
    add_size(kkt, model, data, rows);
    for (int k = 0; k < rows->n; k++)
      for (int side = 0; side < 2; side++)
        for (int c = 0; c < 6 && rows->body[side] != MBD_GROUND; c++)
          kkt->x[6 * rows->body[side] + c] += rows->G[k][6 * side + c] * l[rows->first + k];
  }
  for (int i = 0; i < kkt->nrow; i++)
    mbd_sparse_add(kkt->sharing, kkt->nv + i, kkt->nv + i, kkt->size[i] > 0 ? -kkt->size[i] : -1);
  if (mbd_sparse_end(kkt->sharing) == MBD_SPARSE_NO_MEMORY || !mbd_sparse_factor(kkt->sharing) ||
      !mbd_sparse_solve(kkt->sharing, kkt->x))
    return false;
  memcpy(l, kkt->x + kkt->nv, (size_t)kkt->nrow * sizeof(double));
  return true;
}

double mbd_kkt_spread(mbd_kkt *kkt) {
  return mbd_sparse_spread(kkt->matrix);
}
