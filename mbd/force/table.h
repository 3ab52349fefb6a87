/* The force types that a scene may name. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_FORCE_TABLE_H
#define MBD_FORCE_TABLE_H

#include "mbd/model/model.h"

extern tdm_types mbd_force_types; /* rows: mbd_force_ops */

/* Add a type that stands outside of this folder (tdm_type_add). */
tdm_status mbd_force_add(const mbd_force_ops *ops, tdm_error *err);

#endif
