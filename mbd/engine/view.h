/* What there is to see of a mechanism: its bodies' shapes, or marks; joints, springs, cables and drives as lines. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_ENGINE_VIEW_H
#define MBD_ENGINE_VIEW_H

#include "mbd/mechanics/state.h"
#include "protocol/view/view.h"

/* Fill *scenery (cleared first): body k of the model is body k of the scenery. A mesh whose file can no longer be read
 * is a notice, and its body a mark. */
tdm_status mbd_view_scenery(const mbd_model *model, tdm_scenery *scenery, tdm_error *err);

/* Fill *snapshot with the poses and lines of the unknowns y at time t [s]. Changes nothing of the run. */
tdm_status mbd_view_snapshot(const mbd_model *model, double t, const double *y, tdm_snapshot *snapshot, tdm_error *err);

#endif
