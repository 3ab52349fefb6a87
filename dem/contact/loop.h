/* The laws' loops, compiled once for each instruction set and normal law: see loop.c. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LOOP_H
#define DEM_CONTACT_LOOP_H

#include "dem/contact/table.h"

/* ended by a row of zeros */
#define X(law, name, ncolumn, vectors, keys) \
  extern const dem_law dem_laws_##law##_avx512[], dem_laws_##law##_avx2[], dem_laws_##law##_plain[];
DEM_NORMAL_LIST(X)
#undef X

#endif
