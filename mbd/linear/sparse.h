/* A square sparse matrix that learns its pattern, with KLU's factors.
 *
 * The same code fills it again and again: it adds entries in the same order at every filling. So each call's place is
 * looked up once and known from then on, and a filling costs one addition a call. An entry that was zero whenever it
 * was added so far takes no place; the first value that is not zero makes the pattern grow. A planar mechanism, whose
 * out-of-plane entries are exact zeros, thus has the pattern of a planar one.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_LINEAR_SPARSE_H
#define MBD_LINEAR_SPARSE_H

#include <stdbool.h>

typedef struct {
  int call, row, col;
  double value;
} mbd_entry;

typedef struct {
  int n, nnz;
  int *column;   /* (n + 1) first entry of each column */
  int *row;      /* (nnz) */
  double *value; /* (nnz) */
  /* filling */
  int call;           /* calls so far in this filling */
  int nslot;          /* calls whose place is known */
  int *slot;          /* (nslot) entry of each call, -1: none */
  int nnew, new_room; /* entries outside the pattern */
  mbd_entry *new_entry;
  bool out_of_memory;
  struct mbd_factors *factors; /* KLU's, known to sparse.c alone */
} mbd_sparse;

/* NULL: out of memory. */
mbd_sparse *mbd_sparse_create(int n);
void mbd_sparse_destroy(mbd_sparse **matrix);

/* Forget the pattern. */
void mbd_sparse_reset(mbd_sparse *matrix);

/* Fill: begin (all entries are zero then), add in always the same order, end. */
void mbd_sparse_begin(mbd_sparse *matrix);
void mbd_sparse_note(mbd_sparse *matrix, int call, int row, int col, double value);
typedef enum { MBD_SPARSE_SAME, MBD_SPARSE_GREW, MBD_SPARSE_NO_MEMORY } mbd_sparse_end_state;
mbd_sparse_end_state mbd_sparse_end(mbd_sparse *matrix);

static inline void mbd_sparse_add(mbd_sparse *m, int row, int col, double value) {
  int call = m->call++;
  if (call < m->nslot && m->slot[call] >= 0)
    m->value[m->slot[call]] += value;
  else if (value != 0)
    mbd_sparse_note(m, call, row, col, value);
}

/* Factor the matrix as it is; false: singular, not finite, or out of memory. */
bool mbd_sparse_factor(mbd_sparse *matrix);

/* *to, of the same size, gets the entries of from and is factored, without its knowledge of calls. */
bool mbd_sparse_copy(mbd_sparse *to, const mbd_sparse *from);

/* Solve in place, x (n), with the last factors. */
bool mbd_sparse_solve(mbd_sparse *matrix, double *x);

/* r = b - A x and, row by row, the size of the largest term in it; all (n). */
void mbd_sparse_residual(const mbd_sparse *matrix, const double *x, const double *b, double *r, double *term);

/* The smallest over the largest pivot of the last factors. */
double mbd_sparse_spread(mbd_sparse *matrix);

#endif
