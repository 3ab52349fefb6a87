/* The force types that a scene may name. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_FORCE_TABLE_H
#define MBD_FORCE_TABLE_H

#include "mbd/model/model.h"

enum { MBD_FORCE_TYPES_MAX = 32 };
extern const mbd_force_ops *mbd_force_table[MBD_FORCE_TYPES_MAX]; /* (mbd_force_ntype) */
extern int mbd_force_ntype;

/* Add a type that stands outside of this folder; before any scene is read, and from one thread. The ops must live on.
 * false: the table is full, or has the name already. */
bool mbd_force_register(const mbd_force_ops *ops);

#endif
