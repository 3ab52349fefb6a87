/* Output channels at a time inside a step, from their values at both ends. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_ADAPTER_WITHIN_H
#define DEM_ADAPTER_WITHIN_H

#include "protocol/wire/participant.h"

/* The channels (nchannel) at `share` (0 ... 1) of a step of length dt [s], from `before`, at its beginning, and `now`,
 * at its end, into `now`. Places go by a cubic, velocities and energies by a straight line, counts stay what they were;
 * loads, which are means of the output interval, stay what they are. Where particles came or went (channel 0 counts
 * them) all is as it was before, on its way from there. */
void dem_channels_within(int nchannel, const tdm_channel *channel, double share, double dt, const double *before,
                         double *now);

/* Where in a step from t - dt to t a time lies: 0 ... 1; 1 at its end, to round-off, and after it. */
double dem_share_of_step(double time, double t, double dt);

#endif
