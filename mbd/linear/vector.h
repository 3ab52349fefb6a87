/* The vector operations that IDA spends its time in, compiled here: distributions ship SUNDIALS without optimisation,
 * and then they take as long as everything else together. Serial vectors otherwise. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_LINEAR_VECTOR_H
#define MBD_LINEAR_VECTOR_H

#include <nvector/nvector_serial.h>

/* A serial vector of n zeros with these operations, which vectors cloned from it inherit; NULL: out of memory. */
N_Vector mbd_vector_create(sunindextype n, SUNContext context);

#endif
