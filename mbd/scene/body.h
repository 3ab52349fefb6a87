/* Reading a body of a scene: mass and inertia (given, or of a shape), start, markers. docs/scene.md lists the keys. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_SCENE_BODY_H
#define MBD_SCENE_BODY_H

#include "mbd/model/model.h"

/* Read one element of mbd.bodies and append it to the model, which has room. */
void mbd_body_read(mbd_model *model, json_t *json, const char *path, tdm_error *err);

#endif
