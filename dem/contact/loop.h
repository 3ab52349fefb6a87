/* The laws' loops, compiled once for each instruction set: see loop.c. */
#ifndef DEM_CONTACT_LOOP_H
#define DEM_CONTACT_LOOP_H

#include "dem/contact/table.h"

extern const dem_law dem_laws_avx512[], dem_laws_avx2[], dem_laws_plain[]; /* ended by a row of NULLs */

#endif
