/* How many processes a launcher of MPI has started, as it tells them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_APP_LAUNCH_H
#define DEM_APP_LAUNCH_H

#include <stdlib.h>

/* By the environment: Open MPI's mpirun, others' mpiexec. 0: none says so. */
static inline int dem_launched_processes(void) {
  const char *open_mpi = getenv("OMPI_COMM_WORLD_SIZE"), *others = getenv("PMI_SIZE");
  return open_mpi ? atoi(open_mpi) : others ? atoi(others) : 0;
}

#endif
