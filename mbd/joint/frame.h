/* The frame of a joint: reading it, and the coordinates of the second body in it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_JOINT_FRAME_H
#define MBD_JOINT_FRAME_H

#include "mbd/model/model.h"

/* Read "point" (or "points") and, if asked, "axis" (or "axes") into arm and axes. */
void mbd_joint_read_frame(mbd_joint *joint, tdm_object *o, const mbd_model *model, bool with_axis);

/* Bodies' arms and axes of a frame at one point with its axis along a unit vector. */
void mbd_joint_set_frame(mbd_joint *joint, const mbd_model *model, tdm_vec3 point, tdm_vec3 axis);

/* A joint that couples joint->of stands between the second bodies of the first two; its reaction counts at the second
 * joint's point. */
void mbd_joint_between(mbd_joint *joint);

/* Read a joint that couples two others by a ratio: "joints", which have these coordinates, and the number `key`, which
 * is returned. It is not zero; `what` says in the message what to give. */
double mbd_joint_read_mesh(mbd_joint *joint, tdm_object *o, const mbd_model *model, const unsigned coordinates[2],
                           const char *key, const char *what);

/* Angle of the second body against the first about the joint axis since the start configuration, within half a turn of
 * `near` [rad]. */
double mbd_joint_angle(const mbd_joint *joint, const mbd_kin *a, const mbd_kin *b, double near);

/* Append the row g = coordinate - from; the angle is the one within half a turn of `from`. */
void mbd_joint_coordinate(const mbd_joint *joint, mbd_coordinate which, const mbd_kin *a, const mbd_kin *b, double from,
                          mbd_rows *rows);

/* A right-handed triad whose e3 is along `axis` (unit); columns e1, e2, e3. */
tdm_mat3 mbd_triad(tdm_vec3 axis);

#endif
