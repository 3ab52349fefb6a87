/* Friction that sticks: which joints hold, which slide and which way, and when that changes.
 *
 * Coulomb's law is exact here, not smoothed. A friction that sticks is a constraint row of its own (state.h), whose
 * multiplier is the friction's force; one that slides has the force of force/friction.c against its way. A mode ends
 *   - sticking, when the multiplier exceeds the limit at rest: hold * normal,
 *   - sliding, when the rate changes its sign.
 * The integrators look for such ends in each step, end the step there, have the modes settled and go on from consistent
 * accelerations (Haug, Wu & Yang 1986, Mech. Mach. Theory 21, 401-406).
 *
 * Of several frictions that hold the same freedom one has a row; the others push with their limits, or not at all.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_CONSISTENT_STICK_H
#define MBD_CONSISTENT_STICK_H

#include "mbd/consistent/work.h"

/* How far all frictions are from the end of their modes at (t, y): negative once one is past it. Reactions to the load
 * of the moment. Changes data->kin and what mbd_accelerations does. -1 when these fail; infinite without frictions. */
double mbd_stick_margin(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, const double *y);

/* The time in (from, to], where the margin is negative and at `from` it is not, just after it becomes so: the states in
 * between by `unknowns`. */
double mbd_stick_locate(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double from, double to,
                        mbd_unknowns_fn unknowns, void *context);

/* The first time in a step from `from` to `to`, where the state is y, at which a friction ends its mode; INFINITY:
 * there is none. Looks in the middle and at the samples (nsample) as well: what sticks hinders an integrator from
 * seeing how the load goes. context NULL: nothing is known of the states in between. */
double mbd_stick_end(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double from, double to, int nsample,
                     const double *sample_time, const double *y, mbd_unknowns_fn unknowns, void *context);

/* The error of a settling or a start thereafter that fails. */
tdm_status mbd_stick_refuse(double t, tdm_error *err);

/* Choose the modes at (t, y), where some have ended or the load has jumped. What newly sticks is put onto its row: y's
 * velocities change by what rates there were below the threshold. *changed (NULL: not asked for): a mode is another.
 * false: no consistent accelerations. */
bool mbd_stick_settle(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y, bool *changed);

/* The force of friction k: the multiplier where it sticks, of the last accelerations. */
double mbd_stick_force(const mbd_model *model, const mbd_data *data, int k, const mbd_force_value *value);

#endif
