/* The linear systems of Newton's iteration in IDA: see linear_solver.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/linear/linear_solver.h"

#include <nvector/nvector_serial.h>
#include <string.h>

/* ---- the matrix: filled by mbd_jacobian, between begin and end ---- */

static SUNMatrix_ID matrix_id(SUNMatrix matrix) {
  (void)matrix;
  return SUNMATRIX_CUSTOM;
}

static int matrix_zero(SUNMatrix matrix) {
  (void)matrix; /* mbd_sparse_begin does */
  return 0;
}

static void matrix_destroy(SUNMatrix matrix) {
  SUNMatFreeEmpty(matrix);
}

SUNMatrix mbd_matrix_create(mbd_sparse *sparse, SUNContext context) {
  SUNMatrix matrix = SUNMatNewEmpty(context);
  if (!matrix)
    return NULL;
  matrix->content = sparse;
  matrix->ops->getid = matrix_id;
  matrix->ops->zero = matrix_zero;
  matrix->ops->destroy = matrix_destroy;
  return matrix;
}

/* ---- the solver ---- */

static SUNLinearSolver_Type solver_type(SUNLinearSolver solver) {
  (void)solver;
  return SUNLINEARSOLVER_DIRECT;
}

static SUNLinearSolver_ID solver_id(SUNLinearSolver solver) {
  (void)solver;
  return SUNLINEARSOLVER_CUSTOM;
}

static int solver_setup(SUNLinearSolver solver, SUNMatrix matrix) {
  (void)matrix;
  return mbd_sparse_factor(solver->content) ? SUNLS_SUCCESS : SUNLS_LUFACT_FAIL;
}

static int solver_solve(SUNLinearSolver solver, SUNMatrix matrix, N_Vector x, N_Vector b, realtype tolerance) {
  (void)matrix, (void)tolerance;
  if (x != b)
    memcpy(NV_DATA_S(x), NV_DATA_S(b), (size_t)NV_LENGTH_S(b) * sizeof(realtype));
  return mbd_sparse_solve(solver->content, NV_DATA_S(x)) ? SUNLS_SUCCESS : SUNLS_PACKAGE_FAIL_REC;
}

static int solver_free(SUNLinearSolver solver) {
  SUNLinSolFreeEmpty(solver);
  return SUNLS_SUCCESS;
}

SUNLinearSolver mbd_linear_solver_create(mbd_sparse *sparse, SUNContext context) {
  SUNLinearSolver solver = SUNLinSolNewEmpty(context);
  if (!solver)
    return NULL;
  solver->content = sparse;
  solver->ops->gettype = solver_type;
  solver->ops->getid = solver_id;
  solver->ops->setup = solver_setup;
  solver->ops->solve = solver_solve;
  solver->ops->free = solver_free;
  return solver;
}
