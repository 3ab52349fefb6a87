/* The ranks of a run as processes of MPI: the only place that knows it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_RANKS_MPI_H
#define DEM_RANKS_MPI_H

#include "dem/base/ranks.h"

/* Start MPI (once a process). All ranks must run the same version on machines of one kind: else it ends them with a
 * message. The ranks live until dem_mpi_end. */
const dem_ranks *dem_mpi_begin(int *argc, char ***argv);

/* All ranks end. */
void dem_mpi_end(void);

#endif
