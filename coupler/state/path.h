/* Paths of the coupled bodies through a window: what a multibody solver with the capability "ahead" has told of it
 * beforehand (drivers' laws, loads held), and what comes of that for DEM.
 *
 *   told      nodes from the window's start on, as MBD would go by itself
 *   through   told + the cubic that begins and ends where a path is wanted to: what MBD, or DEM, goes like when its
 *             ends are known
 *
 * Without nodes, accelerations and the states at the ends tell all that matters.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_STATE_PATH_H
#define CPL_STATE_PATH_H

#include "coupler/state/loop.h"

/* Where MBD is to tell the path to in this window's RESULT [s]; 0: nowhere. */
double cpl_path_ahead(const cpl_loop *loop);

/* Keep what RESULT told for the next window. */
void cpl_path_keep(cpl_loop *loop, const tdm_nodes *path);

/* The DEM steps of dt that the told path reaches; LONG_MAX without nodes. */
long cpl_path_reach(const cpl_loop *loop);

/* The next window is open: cut what was told of it at its end. An error where the path does not reach that far. */
tdm_status cpl_path_open(cpl_loop *loop, tdm_error *err);

/* The nodes, told for this window, of the path that goes from `start` to `end` (nbody each). Valid until the next
 * call; no nodes if none were told. */
tdm_nodes cpl_path_through(const cpl_loop *loop, const tdm_state *start, const tdm_state *end);

/* Pose and twist after the time h [s] under a constant acceleration (6: linear, angular). */
tdm_state cpl_predict(const tdm_state *state, const double *acceleration, double h);

/* DEM cannot take nodes: refuse the window if what it does instead, between `start` and `end` or (NULL) by the
 * accelerations that MBD told, is far from what was told. */
tdm_status cpl_path_check(cpl_loop *loop, const tdm_state *start, const tdm_state *end, tdm_error *err);

/* A multibody solver without the capability "ahead" has solved the window: a warning when it went another way than DEM
 * did, by more than a tenth of the way at its fastest at the window's end, or a fifth at an output time inside. */
void cpl_path_doubt(const cpl_loop *loop);

/* How far a body turns in the window at most, by its nodes [rad]; NaN: no nodes were told, or DEM does not take them.
 */
double cpl_path_turn(const cpl_loop *loop, int body);

#endif
