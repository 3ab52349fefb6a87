/* tandem-dem: the solver process of a co-simulation, and the command line of scenes of particles alone. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/app/bench.h"
#include "dem/app/import.h"
#include "dem/app/launch.h"
#include "dem/app/run.h"
#include "protocol/app/command_line.h"

#include <malloc.h>
#include <string.h>

/* On several processes: become mpirun, or what mpirun has started. Returns with an error, or if this one is alone. */
static tdm_status become_ranks(int *argc, char **argv, tdm_error *err) {
  const int wanted = dem_launch_words(argc, argv, err), started = dem_launched_processes();
  if (err->status)
    return err->status;
  if (wanted && started && wanted != started)
    return tdm_fail(
        err, TDM_ERR_ARGUMENT, NULL,
        "%d processes are wanted (dem.ranks of the scene, or --ranks), but a launcher of MPI has started %d, "
        "as OMPI_COMM_WORLD_SIZE or PMI_SIZE in the environment says; leave dem.ranks to mpirun, or remove "
        "the variable",
        wanted, started);
  return started > 1 ? dem_launch_become(err) : wanted > 1 ? dem_launch_ranks(wanted, NULL, err) : TDM_OK;
}

int main(int argc, char **argv) {
  tdm_error err = {0};
  if (become_ranks(&argc, argv, &err))
    return tdm_finish("tandem-dem", &err);
  /* Large arrays in pages of their own, also after some were freed: they grow without a copy, and what is freed goes.
   */
  mallopt(M_MMAP_THRESHOLD, 1 << 18);
  if (argc > 1 && strcmp(argv[1], "bench") == 0)
    return dem_bench_main(argc - 2, argv + 2);
  if (argc > 1 && strcmp(argv[1], "import") == 0)
    return dem_import_main(argc - 2, argv + 2);
  return tdm_standalone_main(&dem_program, argc, argv);
}
