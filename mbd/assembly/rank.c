/* Dependent constraint rows: see rank.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/assembly/rank.h"
#include "protocol/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* a row of which elimination leaves less than this share is dependent */
static const double least_share = 1e-9;

/* and one of which it leaves less than this nearly so */
static const double near_share = 1e-4;

/* a row in echelon form: its entries, the largest of which is 1 and stands at `pivot` */
typedef struct {
  int pivot, n;
  int *column;
  double *value;
} echelon_row;

typedef struct {
  int nv;
  echelon_row *row; /* (nrow) those that are independent so far */
  int nindependent;
  double length; /* [m], rotations count as ways at it */
  int near;      /* the row of least share below near_share, -1: none */
  double share;  /* its share */
} elimination;

/* Subtract earlier rows until nothing stands at their pivots. */
static void reduce(const elimination *e, double *w) {
  for (int i = 0; i < e->nindependent; i++) {
    const echelon_row *r = &e->row[i];
    double factor = w[r->pivot];
    if (factor == 0)
      continue;
    for (int k = 0; k < r->n; k++)
      w[r->column[k]] -= factor * r->value[k];
    w[r->pivot] = 0;
  }
}

/* Keep w, whose largest entry stands at `pivot`. */
static bool keep(elimination *e, const double *w, int pivot) {
  echelon_row *r = &e->row[e->nindependent];
  int n = 0;
  for (int k = 0; k < e->nv; k++)
    n += w[k] != 0;
  r->column = malloc((size_t)n * sizeof *r->column);
  r->value = malloc((size_t)n * sizeof *r->value);
  r->pivot = pivot;
  e->nindependent++;
  for (int k = 0; k < e->nv && r->column && r->value; k++)
    if (w[k] != 0) {
      r->column[r->n] = k;
      r->value[r->n++] = w[k] / w[pivot];
    }
  if (!r->column || !r->value)
    tdm_memory_note();
  return r->column && r->value;
}

static double largest_entry(const double *w, int n, int *where) {
  double most = 0;
  for (int k = 0; k < n; k++)
    if (fabs(w[k]) > most) {
      most = fabs(w[k]);
      *where = k;
    }
  return most;
}

/* Rows of the constraint whose first part is `part` into w (MBD_ROWS_MAX x nv, zeroed here); returns its parts. */
static int constraint_rows(const mbd_model *model, mbd_data *data, int part, double *w, const elimination *e,
                           int *nrow) {
  int parts = 0, nv = e->nv;
  memset(w, 0, MBD_ROWS_MAX * (size_t)nv * sizeof *w);
  for (int first = model->part[part].row; part + parts < model->npart; parts++) {
    if (model->part[part + parts].row != first)
      break;
    const mbd_rows *rows = mbd_part_at(model, data, part + parts, false);
    *nrow = rows->n;
    for (int k = 0; k < rows->n; k++)
      for (int side = 0; side < 2; side++)
        for (int c = 0; c < 6 && rows->body[side] != MBD_GROUND; c++)
          w[k * nv + 6 * rows->body[side] + c] += rows->G[k][6 * side + c] / (c < 3 ? 1 : e->length);
  }
  return parts;
}

/* Sort the rows of all constraints but `without` into independent and dependent ones. */
static bool eliminate(const mbd_model *model, mbd_data *data, int without, elimination *e, double *w, bool *dependent) {
  for (int part = 0, nrow = 0; part < model->npart;) {
    int first = model->part[part].row;
    part += constraint_rows(model, data, part, w, e, &nrow);
    for (int k = 0; k < nrow; k++) {
      int pivot = 0;
      double *row = w + k * e->nv, before = largest_entry(row, e->nv, &pivot);
      reduce(e, row);
      double left = largest_entry(row, e->nv, &pivot);
      dependent[first + k] = first + k == without || !(left > least_share * before);
      if (!dependent[first + k] && left < e->share * before) {
        e->near = first + k;
        e->share = left / before;
      }
      if (!dependent[first + k] && !keep(e, row, pivot))
        return false;
    }
  }
  return true;
}

bool mbd_rank_without(const mbd_model *model, mbd_data *data, int without, bool *dependent, int *number, int *near) {
  double extent = mbd_model_extent(model);
  elimination e = {.nv = 6 * model->nbody, .length = extent > 0 ? extent : 1, .near = -1, .share = near_share};
  double *w = malloc((MBD_ROWS_MAX * (size_t)e.nv + 1) * sizeof *w);
  e.row = calloc((size_t)model->nrow + 1, sizeof *e.row);
  if (!w || !e.row)
    tdm_memory_note();
  bool good = w && e.row && eliminate(model, data, without, &e, w, dependent);
  const int friction_rows = model->nrow - model->nfriction; /* nothing sticks yet */
  for (int i = friction_rows; i < model->nrow; i++)
    dependent[i] = true;
  *number = friction_rows - e.nindependent;
  *near = e.near;
  for (int i = 0; i < e.nindependent && e.row; i++) {
    free(e.row[i].column);
    free(e.row[i].value);
  }
  free(e.row);
  free(w);
  return good;
}

bool mbd_rank(const mbd_model *model, mbd_data *data, bool *dependent, int *number, int *near) {
  return mbd_rank_without(model, data, -1, dependent, number, near);
}
