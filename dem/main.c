/* tandem-dem: the solver process of a co-simulation, and the command line of scenes of particles alone. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/app/bench.h"
#include "dem/app/import.h"
#include "dem/app/launch.h"
#include "dem/app/run.h"
#include "protocol/app/find.h"

#include <errno.h>
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Under mpirun with several processes: become the program for that. Returns the exit status when there is none. */
static int become_ranks(char **argv) {
  char path[4096];
  if (tdm_find_program(path, sizeof path, "tandem-dem-mpi")) {
    execv(path, argv);
    fprintf(stderr, "tandem-dem: error: %s cannot be executed: %s\n", path, strerror(errno));
  } else {
    fprintf(stderr,
            "tandem-dem: error: several processes need tandem-dem-mpi, which is neither beside this program nor "
            "on PATH; install libopenmpi-dev and build again, or take one process and dem.threads\n");
  }
  return 1;
}

int main(int argc, char **argv) {
  if (dem_launched_processes() > 1)
    return become_ranks(argv);
  /* Large arrays in pages of their own, also after some were freed: they grow without a copy, and what is freed goes.
   */
  mallopt(M_MMAP_THRESHOLD, 1 << 18);
  if (argc > 1 && strcmp(argv[1], "bench") == 0)
    return dem_bench_main(argc - 2, argv + 2);
  if (argc > 1 && strcmp(argv[1], "import") == 0)
    return dem_import_main(argc - 2, argv + 2);
  return tdm_standalone_main(&dem_program, argc, argv);
}
