/* What the readers of bodies, joints, drivers and forces share: names, references to bodies, joints and markers, points
 * and directions.
 *
 * Points and directions are world coordinates in the start configuration. Each may be given by a marker instead:
 * "body.marker" is its point, "body.marker.x", ".y" or ".z" a direction of its frame.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_MODEL_READ_H
#define MBD_MODEL_READ_H

#include "mbd/model/model.h"

/* Read and check "name": fit for a column of a CSV file. out has MBD_NAME_MAX bytes. */
void mbd_read_name(tdm_object *o, char *out);

/* Read "bodies": [first, second] into body; both must exist and differ. */
void mbd_read_bodies(tdm_object *o, const mbd_model *model, int body[2]);

/* Read "body": the name of a body that is not the ground; -1 after an error. */
int mbd_read_body(tdm_object *o, const mbd_model *model);

/* The joint that the string `key` names, borrowed from the model; it must have one of the coordinates (a set of
 * MBD_HAS_...). NULL after an error. `otherwise` ends the message that asks for one. */
const mbd_joint *mbd_read_joint(tdm_object *o, const char *key, const mbd_model *model, unsigned coordinates,
                                const char *otherwise);

/* Read "joint" and, where it has both coordinates, "coordinate": "angle" or "translation". NULL after an error. */
const mbd_joint *mbd_read_joint_coordinate(tdm_object *o, const mbd_model *model, mbd_coordinate *coordinate);

/* Read "joints": two of them, up to `most`, of which each must have a coordinate of its set. Returns how many. */
int mbd_read_joints(tdm_object *o, const mbd_model *model, int most, const unsigned coordinates[],
                    const mbd_joint *out[]);

/* A point, required. */
tdm_vec3 mbd_read_point(tdm_object *o, const mbd_model *model, const char *key);

/* A direction as a unit vector, required. */
tdm_vec3 mbd_read_direction(tdm_object *o, const mbd_model *model, const char *key);

/* One point `single` (may be NULL) for both bodies, or a pair `twice` with one each: "point" or "points". */
void mbd_read_points(tdm_object *o, const mbd_model *model, const char *single, const char *twice, tdm_vec3 out[2]);

/* The same for directions: unit vectors. */
void mbd_read_directions(tdm_object *o, const mbd_model *model, const char *single, const char *twice, tdm_vec3 out[2]);

#endif
