/* tandem-dem-mpi: tandem-dem on the ranks of mpirun. Rank 0 has the command line, the server, the files; the others do
 * what its engine does. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/adapter/orders.h"
#include "dem/app/launch.h"
#include "dem/app/run.h"
#include "dem/ranks/mpi.h"
#include "protocol/app/command_line.h"

#include <malloc.h>
#include <stdio.h>
#include <string.h>

int main(int argc, char **argv) {
  mallopt(M_MMAP_THRESHOLD, 1 << 18); /* as in dem/main.c */
  const dem_ranks *ranks = dem_mpi_begin(&argc, &argv);
  int code = 0;
  if (ranks->size == 1 && dem_launched_processes() > 1)
    ranks->abandon(
        "started by another MPI's mpirun, so that each process would run the whole scene; use that of the MPI "
        "with which tandem was built");
  if (ranks->size > 1)
    dem_orders_join(ranks);
  if (ranks->rank == 0) {
    if (argc > 1 && (strcmp(argv[1], "bench") == 0 || strcmp(argv[1], "import") == 0)) {
      fprintf(stderr, "tandem-dem: error: %s works on one process; start it without mpirun\n", argv[1]);
      code = 2;
    } else {
      code = tdm_standalone_main(&dem_program, argc, argv);
    }
    dem_orders_give(DEM_ORDER_END, 0);
  } else {
    tdm_catch_signals();
    dem_orders_follow();
  }
  dem_mpi_end();
  return code;
}
