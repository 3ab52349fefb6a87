/* The solver process tandem-dem, and its commands. */
#include "dem/bench.h"
#include "dem/solver.h"

#include <string.h>

int main(int argc, char **argv) {
  if (argc > 1 && strcmp(argv[1], "bench") == 0)
    return dem_bench_main(argc - 2, argv + 2);
  return tdm_solver_main(&dem_solver_ops, argc, argv);
}
