/* The table of coupling schemes: see session/scheme.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/scheme/schemes.h"

#include <stddef.h>

const cpl_scheme *const cpl_schemes[] = {
    &cpl_scheme_proxy,     /* DEM carries the mechanism through the window */
    &cpl_scheme_iterative, /* the same, over and over until both solvers agree */
    &cpl_scheme_dem_first, /* DEM first on a predicted path */
    &cpl_scheme_lommen,    /* quadratic extrapolation of window means, MBD first */
    &cpl_scheme_hold,      /* the last window mean held, MBD first */
    NULL,
};
