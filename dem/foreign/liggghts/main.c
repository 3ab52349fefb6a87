/* tandem-liggghts: LIGGGHTS as the DEM side of a co-simulation, also on several ranks (mpirun -n N tandem-liggghts). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/foreign/liggghts/host.h"
#include "dem/foreign/liggghts/solver.h"

#include <signal.h>

int main(int argc, char **argv) {
  int ranks, status = 0;
  signal(SIGINT, SIG_IGN); /* mpirun hands it on; the server ends all in order */
  if (lig_host_begin(&argc, &argv, &ranks) > 0) {
    lig_host_follow();
  } else {
    const tdm_solver_ops ops = lig_solver_ops(ranks);
    status = tdm_solver_main(&ops, argc, argv);
    lig_host_end();
  }
  return status;
}
