/* The path ahead: where the coupled bodies will go in the next window, as far as the mechanism knows.
 *
 * What drivers prescribe is known for all times, and what moves freely follows from the load at the window's start,
 * held. Who goes through a window before this solver does needs more of it than the accelerations at the start where
 * drivers' laws bend within the window: half a period of a vibrating deck is no parabola.
 *
 * The path is integrated with the formulation one_step, whatever the run's own is, on a state of its own: at the ends
 * of its steps drivers and joints hold exactly. Nodes are even, 4 to TDM_NODES_MAX, their number doubled until
 * Hermite's cubics between them follow every law within 1e-5 of its range in the window, and no body turns by more than
 * 0.3 rad from one to the next. No nodes are needed, and none made, where every law stays within 1e-3 of its range of
 * the parabola of its start, and no body turns by more than 0.1 rad. A force that a law of time scales is no part of
 * the reduced model: where it changes by more than 1e-3 of its size there are nodes, so many that cubics follow its law
 * within 1e-3 of its range.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_REDUCED_AHEAD_H
#define MBD_REDUCED_AHEAD_H

#include "mbd/consistent/consistent.h"
#include "mbd/integrate/integrator.h"
#include "protocol/wire/nodes.h"

typedef struct mbd_ahead mbd_ahead;

/* For an assembled state, at rest in `data` at its time; `freedom`: the degrees of freedom that joints and drivers
 * leave. Borrows the model. `stop` may be NULL. *out is set also after an error; the caller destroys it. */
tdm_status mbd_ahead_create(mbd_ahead **out, const mbd_model *model, const mbd_data *data, int freedom,
                            mbd_stop_fn stop, void *context, tdm_error *err);
void mbd_ahead_destroy(mbd_ahead **ahead);

/* (ncoupled) whether joints and drivers alone determine a coupled body's motion, whatever the loads. */
const bool *mbd_ahead_prescribed(const mbd_ahead *ahead);

/* The path of the coupled bodies from data's state at t1 until t2 under its load at t1, held; *path points into
 * `ahead`. It ends before t2 where TDM_NODES_MAX nodes cannot follow a law until then. TDM_ERR_NUMERIC: the motion
 * cannot be integrated. */
tdm_status mbd_ahead_path(mbd_ahead *ahead, const mbd_data *data, double t1, double t2, tdm_nodes *path,
                          tdm_error *err);

#endif
