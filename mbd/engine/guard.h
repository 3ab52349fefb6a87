/* The guard: judges the balance of energies at the end of every window.
 *
 *   balance  kinetic + potential + springs + dissipated - supplied, less what there was at the start: zero but for
 * errors of the integration, with every load, driver and friction (energy.h) scale    largest kinetic energy so far,
 * the range of what is stored otherwise, and what was supplied and turned into heat: what has passed through the
 * mechanism, without the zero of the potentials
 *
 * Off by more than guard.energy of the scale the run stops, or is warned of; by more than a tenth of that it is warned
 * of at any rate. Mechanisms that creep or stand still have no scale: a millionth of a joule per kilogram is the least.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_ENGINE_GUARD_H
#define MBD_ENGINE_GUARD_H

#include "mbd/mechanics/energy.h"

/* The state is that of time t, with the energies e. TDM_ERR_NUMERIC: stop. */
tdm_status mbd_guard_look(const mbd_model *model, mbd_data *data, double t, mbd_energies e, tdm_error *err);

#endif
