/* The multibody solver as a participant of a co-simulation. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_ADAPTER_SOLVER_H
#define MBD_ADAPTER_SOLVER_H

#include "protocol/wire/participant.h"

extern const tdm_solver_ops mbd_solver_ops;

#endif
