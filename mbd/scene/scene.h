/* Reading the scene section "mbd" into a model, by the tables of joints, drivers, forces and formulations.
 *
 * It stands above the rooms of these, and of mechanics/: what a thin rod's inertia is depends on what its joints hold
 * (mechanics/slim.h).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_SCENE_SCENE_H
#define MBD_SCENE_SCENE_H

#include "mbd/model/model.h"

/* Read the scene section `json` (borrowed, JSON path "mbd"). `restores`: the run saves and restores states, so that
 * one_step stands for a formulation and a corrector that the scene does not name. The model belongs to the caller, also
 * after an error: destroy it. */
tdm_status mbd_model_read(mbd_model **model, json_t *json, bool restores, tdm_error *err);

#endif
