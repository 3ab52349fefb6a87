/* The contacts of the present state with their forces, for those who look: force chains, histograms.
 *
 * The loops keep no forces of single contacts, so a run that nobody looks at pays nothing. Here all forces are
 * evaluated once more, on a copy of the state, in which each pair has a place of its own for its reaction.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_OUTPUT_CONTACTS_H
#define DEM_OUTPUT_CONTACTS_H

#include "dem/state/data.h"
#include "protocol/view/view.h"

/* Append the contacts at the present positions and velocities to the snapshot. Forces are those of these: in a step,
 * damping sees velocities half a step older, and mc-strain that starts from the last forces is one iteration behind.
 * Nothing of the data changes. Errors: TDM_ERR_MEMORY. */
tdm_status dem_contacts_look(const dem_data *data, tdm_snapshot *snapshot, tdm_error *err);

#endif
