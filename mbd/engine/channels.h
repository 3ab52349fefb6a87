/* Output channels: what the solver reports beside the coupled bodies' states. docs/mbd.md lists them.
 *
 * Reactions come from an acceleration-level solve at the sample's own state and load, not from interpolated
 * multipliers: these are a derivative order less accurate than the positions.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_ENGINE_CHANNELS_H
#define MBD_ENGINE_CHANNELS_H

#include "mbd/consistent/consistent.h"

int mbd_channel_count(const mbd_model *model);

/* Names and units into channel (mbd_channel_count). */
void mbd_channel_names(const mbd_model *model, tdm_channel *channel);

/* Values at the state y and time t into out (mbd_channel_count). TDM_ERR_NUMERIC: accelerations cannot be solved for,
 * or the forces on a body do not add up (balance.h). */
tdm_status mbd_channel_values(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, const double *y,
                              double *out, tdm_error *err);

#endif
