/* The joint types that a scene may name. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_JOINT_TABLE_H
#define MBD_JOINT_TABLE_H

#include "mbd/model/model.h"

extern tdm_types mbd_joint_types; /* rows: mbd_joint_ops */

/* Add a type that stands outside of this folder (tdm_type_add). */
tdm_status mbd_joint_add(const mbd_joint_ops *ops, tdm_error *err);

#endif
