/* tandem-dem: the solver process of a co-simulation, and the command line of scenes of particles alone. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/app/bench.h"
#include "dem/app/import.h"
#include "dem/app/run.h"

#include <malloc.h>
#include <string.h>

int main(int argc, char **argv) {
  /* Large arrays in pages of their own, also after some were freed: they grow without a copy, and what is freed goes.
   */
  mallopt(M_MMAP_THRESHOLD, 1 << 18);
  if (argc > 1 && strcmp(argv[1], "bench") == 0)
    return dem_bench_main(argc - 2, argv + 2);
  if (argc > 1 && strcmp(argv[1], "import") == 0)
    return dem_import_main(argc - 2, argv + 2);
  return tdm_standalone_main(&dem_program, argc, argv);
}
