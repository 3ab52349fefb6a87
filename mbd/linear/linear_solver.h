/* The linear systems of Newton's iteration in IDA: an mbd_sparse as SUNDIALS' matrix and linear solver. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_LINEAR_LINEAR_SOLVER_H
#define MBD_LINEAR_LINEAR_SOLVER_H

#include "mbd/linear/sparse.h"

#include <sundials/sundials_linearsolver.h>
#include <sundials/sundials_matrix.h>

/* A matrix that stands for `sparse`, and a solver with its factors; both borrow it. NULL: out of memory. */
SUNMatrix mbd_matrix_create(mbd_sparse *sparse, SUNContext context);
SUNLinearSolver mbd_linear_solver_create(mbd_sparse *sparse, SUNContext context);

#endif
