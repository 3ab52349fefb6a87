/* The driver types that a scene may name. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_DRIVER_TABLE_H
#define MBD_DRIVER_TABLE_H

#include "mbd/model/model.h"

extern tdm_types mbd_driver_types; /* rows: mbd_driver_ops */

/* Add a type that stands outside of this folder (tdm_type_add). */
tdm_status mbd_driver_add(const mbd_driver_ops *ops, tdm_error *err);

#endif
