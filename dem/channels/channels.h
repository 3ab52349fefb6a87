/* The output channels of the engine: what READY names, what time histories hold. All of it comes from one table in
 * channels.c: a row is a name, a unit, the items that have such a channel, and the value. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CHANNELS_CHANNELS_H
#define DEM_CHANNELS_CHANNELS_H

#include "dem/state/data.h"

/* The channels of a scene, in the order of the table. */
typedef struct {
  int count;
  tdm_channel *channel; /* (count) names and units */
  struct dem_channel_place {
    const struct dem_channel_row *row;
    int item;
  } * place; /* (count) where their values come from */
} dem_channels;

/* Errors: TDM_ERR_MEMORY. Freed with dem_channels_free, also after an error. */
tdm_status dem_channels_make(dem_channels *channels, const dem_model *model, tdm_error *err);
void dem_channels_free(dem_channels *channels);

/* The values of the present state into out (count); loads are the means of the last output interval. All ranks
 * ask for it. */
void dem_channels_sample(const dem_channels *channels, dem_data *data, double *out);

/* Values at `share` in [0, 1) of a step of dt [s], into now (count), from those at both ends: `before` it and `now`,
 * after it. Places go along a cubic, velocities and energies along a line; counts, and sums over what came and went,
 * are those of before. Where particles came or went in the step, all goes on from before. */
void dem_channels_within(const dem_channels *channels, double share, double dt, const double *before, double *now);

/* Which share of the step that ends at t, dt long, lies before `time` [s]; 1 within round-off of the end. */
double dem_share_of_step(double time, double t, double dt);

#endif
