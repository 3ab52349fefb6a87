/* `tandem check`: what would run, from the settings and from what the solvers report of themselves. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_RUN_CHECK_H
#define CPL_RUN_CHECK_H

#include "coupler/session/session.h"
#include "protocol/scene/scene.h"

/* Print to standard output, once both solvers are READY. Warnings are printed by the run itself. */
void cpl_check_print(const tdm_scene *scene, const cpl_settings *settings, const cpl_session *session);

#endif
