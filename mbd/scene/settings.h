/* Reading the settings of the integrator and of the guard: "formulation", "corrector", "solver", "guard". */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_SCENE_SETTINGS_H
#define MBD_SCENE_SETTINGS_H

#include "mbd/model/model.h"

/* Read them from the section, for a model whose bodies and joints are read; `coupled` as in mbd_model_read. */
void mbd_settings_read(mbd_settings *settings, tdm_object *section, const mbd_model *model, bool coupled);

#endif
