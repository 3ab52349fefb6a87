/* An FMU as the multibody side of a co-simulation. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_FOREIGN_FMU_SOLVER_H
#define MBD_FOREIGN_FMU_SOLVER_H

#include "protocol/fmi/fmu.h"
#include "protocol/wire/participant.h"

enum { FMU_CAPABILITIES_MAX = 4 };

/* The operations of a solver that has this FMU; the process has one. `capability` (FMU_CAPABILITIES_MAX) gets those
 * that it can have. Borrows both. */
tdm_solver_ops fmu_solver_ops(tdm_fmu *fmu, const char **capability);

#endif
