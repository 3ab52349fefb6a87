/* Homes as long as makes the measured times of their chunks alike, if the scene asks for that
 * (dem.decomposition.balance). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_EXCHANGE_BALANCE_H
#define DEM_EXCHANGE_BALANCE_H

#include "dem/state/data.h"

/* Before lists are built: look, if it is time for it, at what chunks cost. Homes are to move if the busiest one costs
 * more than the mean by the tolerance, and would cost less by as much. home (ranks + 1): the shares where they will
 * begin, or do; returns whether they are to move. */
bool dem_homes_balance(dem_data *data, double *home);

/* By how much the busiest rank worked longer than the mean, as a share of it, between looks since the start. */
double dem_homes_imbalance(const dem_data *data);

#endif
