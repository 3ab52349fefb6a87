/* The table of coupling schemes: see scheme.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/session/scheme.h"

#include <string.h>

const cpl_scheme *cpl_schemes[CPL_SCHEMES_MAX + 1] = {
    &cpl_scheme_proxy,     /* DEM carries the mechanism through the window */
    &cpl_scheme_iterative, /* the same, over and over until both solvers agree */
    &cpl_scheme_dem_first, /* DEM first on a predicted path */
    &cpl_scheme_lommen,    /* quadratic extrapolation of window means, MBD first */
    &cpl_scheme_hold,      /* the last window mean held, MBD first */
};

bool cpl_scheme_register(const cpl_scheme *scheme) {
  for (int i = 0; i < CPL_SCHEMES_MAX; i++) {
    if (!cpl_schemes[i]) {
      cpl_schemes[i] = scheme;
      return true;
    }
    if (strcmp(cpl_schemes[i]->name, scheme->name) == 0)
      return false;
  }
  return false;
}
