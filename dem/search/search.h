/* The searches: each makes the same list of pairs that are near, in its own way.
 *
 * A search is a row of the table in search.c. It gets the spheres and a distance, and returns for every particle i the
 * particles j > i, ascending, whose surfaces are nearer than `skin`:
 *   |x_i - x_j| < r_i + r_j + skin
 * (the nearest images when the box repeats). So results do not depend on the search, only the time does: "verlet-1967"
 * lists more, which does not touch. A sphere whose position is not finite has no partners.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEARCH_SEARCH_H
#define DEM_SEARCH_SEARCH_H

#include "dem/search/method/method.h"

#include <stdbool.h>
#include <stddef.h>

/* What a search keeps between calls to speed the next one up ("sweep": as long as particles keep their numbers).
 * Nothing in it decides the result. */
typedef struct dem_search dem_search;

/* The searches' names, NULL-terminated: "cells", "sweep", "linked-linear", "grid", "verlet-1967", "all" (every pair,
 * for tests); "auto" is not among them. */
extern const char *const dem_search_names[];

/* The search that "auto" takes for these spheres: "cells", or "grid" when the radii differ widely. Much cheaper than a
 * search. */
const char *dem_search_choose(const dem_search_input *input);

/* NULL: no memory, or no such search. */
dem_search *dem_search_create(const char *name);
void dem_search_destroy(dem_search **search);
const char *dem_search_name(const dem_search *search);

/* The rows that are wanted, which lie in the scratch memory until it is given back; in the search's own until its next
 * call. False: no memory. */
tdm_status dem_search_run(dem_search *search, const dem_search_input *input, dem_rows *rows);

/* Are the lists of this search to be made anew after so many steps even if nothing moved? 0: no. */
int dem_search_interval(const dem_search *search);

/* Does this search want all spheres, whichever rows are asked for? */
bool dem_search_wants_all(const dem_search *search);

/* The skin of this search: the one that the scene asks for, or the search's own (verlet-1967: 5 r_max -
 * 2 r_max; linked-linear: next to none). */
double dem_search_skin(const dem_search *search, double asked, double largest_radius);

#endif
