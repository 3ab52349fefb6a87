/* The driver types that a scene may name. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_DRIVER_TABLE_H
#define MBD_DRIVER_TABLE_H

#include "mbd/model/model.h"

enum { MBD_DRIVER_TYPES_MAX = 32 };
extern const mbd_driver_ops *mbd_driver_table[MBD_DRIVER_TYPES_MAX]; /* (mbd_driver_ntype) */
extern int mbd_driver_ntype;

/* Add a type that stands outside of this folder; before any scene is read, and from one thread. The ops must live on.
 * false: the table is full, or has the name already. */
bool mbd_driver_register(const mbd_driver_ops *ops);

#endif
