/* The processes of MPI (ranks): how many a launcher has started, and how this program has mpirun start them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_APP_LAUNCH_H
#define DEM_APP_LAUNCH_H

#include "protocol/base/status.h"

#include <stdbool.h>

/* By the environment: Open MPI's mpirun, others' mpiexec. 0: none says so. */
int dem_launched_processes(void);

/* Keep the command line (borrowed) for what is below, and take "--ranks P" out of it. Returns P; 0: it is not there.
 * Errors: TDM_ERR_ARGUMENT. */
int dem_launch_words(int *argc, char **argv, tdm_error *err);

/* Shall this program start that many, as its scene says? Not when the command line has said how many, or a launcher has
 * started it, or it is not tandem-dem. */
bool dem_launch_wanted(int ranks);

/* Under a launcher: become the program that knows MPI, with these words. Returns only with an error. */
tdm_status dem_launch_become(tdm_error *err);

/* Become mpirun with so many of that program, which get these words; `place` asks for them: "dem.ranks". Open MPI is
 * allowed what it refuses otherwise: to run as root, and more ranks than cores; that is told on standard error. Returns
 * only with an error. */
tdm_status dem_launch_ranks(int ranks, const char *place, tdm_error *err);

#endif
