/* Reading the scene section "mbd" into a model, by the tables of joints, drivers, forces and formulations.
 *
 * It stands above the rooms of these, and of mechanics/: what a thin rod's inertia is depends on what its joints hold
 * (mechanics/slim.h).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_SCENE_SCENE_H
#define MBD_SCENE_SCENE_H

#include "mbd/model/model.h"

/* Read the scene section `json` (borrowed, JSON path "mbd"). `coupled`: bodies take loads from outside, or
 * states are restored, so that one_step stands for a formulation that the scene does not choose. The model belongs to
 * the caller, also after an error: destroy it. */
tdm_status mbd_model_read(mbd_model **model, json_t *json, bool coupled, tdm_error *err);

#endif
