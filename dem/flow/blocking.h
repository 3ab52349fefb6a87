/* Blocked holes: particles that stay in or on the holes of a screen.
 *
 * Every model.screening.every steps each particle of the product is looked at. It lies on the screen of a deck while it
 * touches it, or is nearer to that than 5 % of its radius: contacts that are lost for a moment end nothing. It blocks a
 * hole when its centre has been over the same hole at every look for the deck's blocking time, and is held when it has
 * been on the same spot for so long: within half the width of a hole of where it was. Whoever lies on a bar may be
 * held, but blocks nothing.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_FLOW_BLOCKING_H
#define DEM_FLOW_BLOCKING_H

#include "dem/state/data.h"

/* Look, if it is time to; at the step boundary at time t [s]. */
void dem_blocking_look(dem_data *data, double t);

/* The screen of a deck; NULL: it has none. */
const struct dem_screen *dem_deck_screen(const dem_model *model, int deck);

#endif
