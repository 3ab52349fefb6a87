/* What a joint's file includes: its shape (model/joint.h), frames, rows and readers. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_JOINT_JOINT_H
#define MBD_JOINT_JOINT_H

#include "mbd/joint/frame.h"
#include "mbd/joint/rows.h"
#include "mbd/model/read.h"

/* shared by the joints that it is a part of */
extern const mbd_joint_ops mbd_joint_cylindrical;

#endif
