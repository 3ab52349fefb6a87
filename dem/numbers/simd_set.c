/* Instruction sets of this machine: see simd_set.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/numbers/simd_set.h"

#include <stddef.h>
#include <string.h>

const char *const dem_simd_names[] = {
    [DEM_AVX512] = "avx512", [DEM_AVX2] = "avx2", [DEM_PLAIN] = "plain", [DEM_SIMD_SETS] = NULL};

static bool is_here(dem_simd_set set) {
#if DEM_SIMD_WIDEST >= 512
  if (set == DEM_AVX512)
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
           __builtin_cpu_supports("avx512dq");
#endif
#if DEM_SIMD_WIDEST >= 256
  if (set == DEM_AVX2)
    return __builtin_cpu_supports("avx2");
#endif
  return set == DEM_PLAIN;
}

dem_simd_set dem_simd_find(const char *name) {
  dem_simd_set set = 0;
  while (set < DEM_SIMD_SETS && (strcmp(name, dem_simd_names[set]) != 0 || !is_here(set)))
    set++;
  return set;
}

const char *dem_simd_best(void) {
  dem_simd_set set = 0;
  while (!is_here(set))
    set++;
  return dem_simd_names[set];
}
