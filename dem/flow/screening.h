/* Measures of screening ([A07] 4.4): what the decks of a screen give, and how well they sort.
 *
 * A deck is known by its outlets, which are sinks. A particle that leaves by one of them is sorted if it is at least as
 * large as the deck's material is meant to be, else undersized ([A07]: gangue). Only materials of the product count.
 *
 *   efficiency of a deck      c_i = 100 s_i/(s_i + g_i) %, by number or by mass
 *   efficiency of the screen  the mean over its decks                                     (4.33), (4.35)
 *   output rate               mass that left a deck / time since the start of counting    (4.40)
 *   share of undersized       G = 100 g_i/(s_i + g_i) %, by mass                          (4.41)
 *
 * with the masses of the particles themselves (Eq. 4.36 has the density twice). What is 0/0 as long as a deck has given
 * nothing is NaN, and so is the efficiency of a screen of which a deck has given nothing.
 *
 * Particles that leave by an outlet before counting starts count nowhere: not as fed either. So at any time
 * fed = inside + sorted + undersized, unless particles of the product leave in other ways.
 *
 * [A07]: N. Alkhaldi, dissertation, chapter 4 (tumbler screening machines).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_FLOW_SCREENING_H
#define DEM_FLOW_SCREENING_H

#include "dem/state/data.h"

/* The run begins with the particles that are there; sources have made nothing yet. All ranks ask for it. */
void dem_screening_begin(dem_data *data);

/* A step boundary at time t [s]: before sinks act. */
void dem_screening_step(dem_data *data, double t);

/* Particle i leaves by this sink. */
void dem_screening_count(dem_data *data, int sink, int i);

/* Warn of particles of the product that left by no outlet since the last call; t [s]: for the message. All ranks
 * ask for it. */
void dem_screening_watch(dem_data *data, double t);

/* ---- measures: of the present state ---- */

/* In percent; NaN: the deck has given nothing yet. */
double dem_deck_efficiency(const dem_deck_state *deck, bool by_mass);
double dem_deck_share(const dem_deck_state *deck);

/* Mean output rate since the start of counting [kg/s]; NaN until then. */
double dem_deck_rate(const dem_data *data, int deck);

/* The same of late: each mass m that left counts m/T exp(-age/T), T: dem.screening.smoothing [kg/s]. */
double dem_deck_rate_now(const dem_data *data, int deck);

/* Mean efficiency of the decks in percent; NaN: one of them has given nothing yet. */
double dem_screening_efficiency(const dem_data *data, bool by_mass);

/* Particles of the product: that came in, are inside, left by outlets, left otherwise. */
typedef struct {
  uint64_t fed, inside, out;
  int64_t lost; /* fed - inside - out */
} dem_screening_balance;

/* All ranks ask for it. */
dem_screening_balance dem_screening_balance_of(const dem_data *data);

#endif
