/* A square matrix that is filled entry by entry, factored and solved with: dense for small ones, sparse (KLU) beyond.
 *
 * A factorisation depends on the matrix alone, not on what was factored before.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_LINEAR_LU_H
#define MBD_LINEAR_LU_H

#include <stdbool.h>

typedef struct mbd_lu mbd_lu;

mbd_lu *mbd_lu_create(int n); /* NULL: out of memory */
void mbd_lu_destroy(mbd_lu **lu);

/* All zero; then add entries, also more than once in one place. */
void mbd_lu_clear(mbd_lu *lu);
void mbd_lu_add(void *lu, int row, int col, double value);

/* false: singular, not a number, or out of memory. */
bool mbd_lu_factor(mbd_lu *lu);

/* x (n) becomes A^-1 x; A was factored. */
void mbd_lu_solve(mbd_lu *lu, double *x);

/* *to gets the factors of from, of the same size. false: out of memory. */
bool mbd_lu_copy(mbd_lu *to, const mbd_lu *from);

#endif
