/* Verlet's lists as [A07] Section 2.3.1 describes them: every pair is looked at, and listed if it is nearer than
 * r_v = 5 r_max (Eq. 2.64; a skin of 3 r_max between the largest); made anew every 20 steps. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/method/method.h"

const dem_search_method dem_search_verlet_1967 = {.find = dem_find_all, .skin_radii = 3, .interval = 20};
