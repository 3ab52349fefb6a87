/* The joint types that a scene may name. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_JOINT_TABLE_H
#define MBD_JOINT_TABLE_H

#include "mbd/model/model.h"

enum { MBD_JOINT_TYPES_MAX = 32 };
extern const mbd_joint_ops *mbd_joint_table[MBD_JOINT_TYPES_MAX]; /* (mbd_joint_ntype) */
extern int mbd_joint_ntype;

/* Add a type that stands outside of this folder; before any scene is read, and from one thread. The ops must live on.
 * false: the table is full, or has the name already. */
bool mbd_joint_register(const mbd_joint_ops *ops);

#endif
