/* The table of tandem's coupling schemes (settings/scheme.h says how to add one). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_SCHEME_SCHEMES_H
#define CPL_SCHEME_SCHEMES_H

#include "coupler/settings/scheme.h"

/* proxy: DEM carries the mechanism through the window; iterative: the same, over and over until both solvers agree;
 * dem_first: DEM first on a predicted path; lommen: quadratic extrapolation of window means, MBD first; hold: the last
 * window mean held, MBD first */
#define CPL_SCHEME_LIST(X) \
  X(proxy)                 \
  X(iterative)             \
  X(dem_first)             \
  X(lommen)                \
  X(hold)

#define X(name) extern const cpl_scheme cpl_scheme_##name;
CPL_SCHEME_LIST(X)
#undef X

extern const cpl_scheme *const cpl_schemes[]; /* NULL-terminated; the first is the default */

#endif
