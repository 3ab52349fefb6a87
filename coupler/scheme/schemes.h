/* The table of tandem's coupling schemes (session/scheme.h says how to add one). */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_SCHEME_SCHEMES_H
#define CPL_SCHEME_SCHEMES_H

#include "coupler/session/scheme.h"

extern const cpl_scheme *const cpl_schemes[]; /* NULL-terminated; the first is the default */

extern const cpl_scheme cpl_scheme_lommen, cpl_scheme_hold, cpl_scheme_dem_first, cpl_scheme_proxy,
    cpl_scheme_iterative;

#endif
