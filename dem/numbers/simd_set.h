/* The instruction sets that loops are compiled for, and which of them this machine has. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_NUMBERS_SIMD_SET_H
#define DEM_NUMBERS_SIMD_SET_H

#include <stdbool.h>

/* Fastest first; the last is plain C. */
typedef enum { DEM_AVX512, DEM_AVX2, DEM_PLAIN, DEM_SIMD_SETS } dem_simd_set;

/* Their names in a scene, NULL-terminated. */
extern const char *const dem_simd_names[];

/* The fastest that this machine has. */
const char *dem_simd_best(void);

/* The set of a name; DEM_SIMD_SETS: this machine, or this build, has none. */
dem_simd_set dem_simd_find(const char *name);

static inline bool dem_simd_here(const char *name) {
  return dem_simd_find(name) < DEM_SIMD_SETS;
}

#endif
