/* A square sparse matrix that learns its pattern, with KLU's factors: see sparse.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/linear/sparse.h"

#include "protocol/base/memory.h"

#include <klu.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct mbd_factors {
  klu_common common;
  klu_symbolic *symbolic;
  klu_numeric *numeric;
};

mbd_sparse *mbd_sparse_create(int n) {
  mbd_sparse *m = calloc(1, sizeof *m);
  if (!m)
    return NULL;
  m->n = n;
  m->column = calloc((size_t)n + 1, sizeof *m->column);
  m->factors = calloc(1, sizeof *m->factors);
  if (!m->column || !m->factors)
    mbd_sparse_destroy(&m);
  else
    klu_defaults(&m->factors->common);
  return m;
}

static void drop_factors(mbd_sparse *m) {
  if (!m->factors)
    return;
  if (m->factors->numeric)
    klu_free_numeric(&m->factors->numeric, &m->factors->common);
  if (m->factors->symbolic)
    klu_free_symbolic(&m->factors->symbolic, &m->factors->common);
}

void mbd_sparse_destroy(mbd_sparse **matrix) {
  mbd_sparse *m = *matrix;
  if (!m)
    return;
  drop_factors(m);
  free(m->column);
  free(m->row);
  free(m->value);
  free(m->slot);
  free(m->new_entry);
  free(m->factors);
  free(m);
  *matrix = NULL;
}

void mbd_sparse_reset(mbd_sparse *m) {
  drop_factors(m);
  m->nnz = m->nslot = m->nnew = 0;
  memset(m->column, 0, ((size_t)m->n + 1) * sizeof *m->column);
}

void mbd_sparse_begin(mbd_sparse *m) {
  m->call = m->nnew = 0;
  m->out_of_memory = false;
  for (int i = 0; i < m->nnz; i++)
    m->value[i] = 0;
}

void mbd_sparse_note(mbd_sparse *m, int call, int row, int col, double value) {
  if (m->nnew == m->new_room) {
    int room = m->new_room ? 2 * m->new_room : 256;
    mbd_entry *more = realloc(m->new_entry, (size_t)room * sizeof *more);
    if (!more) {
      m->out_of_memory = true;
      tdm_memory_note();
      return;
    }
    m->new_entry = more;
    m->new_room = room;
  }
  m->new_entry[m->nnew++] = (mbd_entry){call, row, col, value};
}

/* Give calls up to n a slot (none yet). */
static bool more_slots(mbd_sparse *m, int n) {
  if (n <= m->nslot)
    return true;
  int *slot = realloc(m->slot, (size_t)n * sizeof *slot);
  if (!slot)
    return false;
  for (int i = m->nslot; i < n; i++)
    slot[i] = -1;
  m->slot = slot;
  m->nslot = n;
  return true;
}

/* by place, then in the order of the calls */
static int by_place(const void *left, const void *right) {
  const mbd_entry *a = left, *b = right;
  if (a->col != b->col)
    return a->col < b->col ? -1 : 1;
  if (a->row != b->row)
    return a->row < b->row ? -1 : 1;
  return a->call < b->call ? -1 : a->call > b->call;
}

static int find(const mbd_sparse *m, int row, int col) {
  for (int i = m->column[col]; i < m->column[col + 1]; i++)
    if (m->row[i] == row)
      return i;
  return -1;
}

/* The sorted new entries' places that the pattern does not have, each once, into fresh (nnew indices). */
static int fresh_places(const mbd_sparse *m, int *fresh) {
  int n = 0;
  for (int i = 0; i < m->nnew; i++) {
    const mbd_entry *e = &m->new_entry[i];
    bool again = i > 0 && e[-1].row == e->row && e[-1].col == e->col;
    if (!again && find(m, e->row, e->col) < 0)
      fresh[n++] = i;
  }
  return n;
}

/* Make room for the new entries, behind the old ones of their columns. */
static bool grow(mbd_sparse *m) {
  int *fresh = malloc((size_t)m->nnew * sizeof *fresh);
  int n = fresh ? fresh_places(m, fresh) : 0, at = 0, next = 0;
  size_t room = (size_t)(m->nnz + n) + 1;
  int *column = malloc(((size_t)m->n + 1) * sizeof *column), *row = malloc(room * sizeof *row);
  int *moved = malloc(room * sizeof *moved);
  double *value = calloc(room, sizeof *value);
  bool good = fresh && column && row && moved && value;
  for (int col = 0; col < m->n && good; col++) {
    column[col] = at;
    for (int i = m->column[col]; i < m->column[col + 1]; i++) {
      moved[i] = at;
      row[at] = m->row[i];
      value[at++] = m->value[i];
    }
    for (; next < n && m->new_entry[fresh[next]].col == col; next++)
      row[at++] = m->new_entry[fresh[next]].row;
  }
  if (good) {
    column[m->n] = m->nnz = at;
    for (int i = 0; i < m->nslot; i++)
      if (m->slot[i] >= 0)
        m->slot[i] = moved[m->slot[i]];
    int *old_column = m->column, *old_row = m->row;
    double *old_value = m->value;
    m->column = column, m->row = row, m->value = value;
    column = old_column, row = old_row, value = old_value;
  }
  free(fresh), free(column), free(row), free(moved), free(value);
  return good;
}

mbd_sparse_end_state mbd_sparse_end(mbd_sparse *m) {
  if (m->out_of_memory)
    return MBD_SPARSE_NO_MEMORY;
  if (m->nnew == 0)
    return MBD_SPARSE_SAME;
  qsort(m->new_entry, (size_t)m->nnew, sizeof *m->new_entry, by_place);
  if (!more_slots(m, m->call) || !grow(m)) {
    tdm_memory_note();
    return MBD_SPARSE_NO_MEMORY;
  }
  for (int i = 0; i < m->nnew; i++) {
    const mbd_entry *e = &m->new_entry[i];
    int at = m->slot[e->call] = find(m, e->row, e->col);
    m->value[at] += e->value;
  }
  m->nnew = 0;
  drop_factors(m);
  return MBD_SPARSE_GREW;
}

static bool factor(mbd_sparse *m) {
  const double worst = 1e-12; /* reciprocal pivot growth below which old pivots are given up */
  if (!m->factors->symbolic && !(m->factors->symbolic = klu_analyze(m->n, m->column, m->row, &m->factors->common)))
    return false;
  if (m->factors->numeric &&
      klu_refactor(m->column, m->row, m->value, m->factors->symbolic, m->factors->numeric, &m->factors->common) &&
      klu_rgrowth(m->column, m->row, m->value, m->factors->symbolic, m->factors->numeric, &m->factors->common) &&
      m->factors->common.rgrowth > worst)
    return true;
  if (m->factors->numeric)
    klu_free_numeric(&m->factors->numeric, &m->factors->common);
  m->factors->numeric = klu_factor(m->column, m->row, m->value, m->factors->symbolic, &m->factors->common);
  return m->factors->numeric && m->factors->common.status == KLU_OK;
}

bool mbd_sparse_factor(mbd_sparse *m) {
  const bool good = factor(m);
  if (m->factors->common.status == KLU_OUT_OF_MEMORY)
    tdm_memory_note();
  return good;
}

bool mbd_sparse_copy(mbd_sparse *to, const mbd_sparse *from) {
  const size_t n = (size_t)from->n, nnz = (size_t)from->nnz;
  mbd_sparse_reset(to);
  int *row = realloc(to->row, (nnz + 1) * sizeof *row);
  to->row = row ? row : to->row;
  double *value = realloc(to->value, (nnz + 1) * sizeof *value);
  to->value = value ? value : to->value;
  if (!row || !value) {
    tdm_memory_note();
    return false;
  }
  to->nnz = from->nnz;
  memcpy(to->column, from->column, (n + 1) * sizeof *to->column);
  memcpy(to->row, from->row, nnz * sizeof *to->row);
  memcpy(to->value, from->value, nnz * sizeof *to->value);
  return mbd_sparse_factor(to);
}

bool mbd_sparse_solve(mbd_sparse *m, double *x) {
  if (!klu_solve(m->factors->symbolic, m->factors->numeric, m->n, 1, x, &m->factors->common))
    return false;
  for (int i = 0; i < m->n; i++)
    if (!isfinite(x[i]))
      return false;
  return true;
}

void mbd_sparse_residual(const mbd_sparse *m, const double *x, const double *b, double *r, double *term) {
  for (int i = 0; i < m->n; i++) {
    r[i] = b[i];
    term[i] = fabs(b[i]);
  }
  for (int col = 0; col < m->n; col++)
    for (int i = m->column[col]; i < m->column[col + 1]; i++) {
      double part = m->value[i] * x[col];
      r[m->row[i]] -= part;
      term[m->row[i]] = fmax(term[m->row[i]], fabs(part));
    }
}

double mbd_sparse_spread(mbd_sparse *m) {
  return m->factors->numeric && klu_rcond(m->factors->symbolic, m->factors->numeric, &m->factors->common)
             ? m->factors->common.rcond
             : 0;
}
