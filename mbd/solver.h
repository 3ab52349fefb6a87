/* The multibody solver as a participant of a co-simulation. */
#ifndef MBD_SOLVER_H
#define MBD_SOLVER_H

#include "protocol/participant.h"

extern const tdm_solver_ops mbd_solver_ops;

#endif
