/* Finding an integrator: see integrate.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/step/integrate.h"

#include "dem/numbers/simd_set.h"

#include <string.h>

const char *const dem_integrator_names[] = {
#define X(name, function, keeps) name,
    DEM_INTEGRATOR_LIST(X)
#undef X
        NULL};

static const dem_integrator *const sets[DEM_SIMD_SETS] = {
#if DEM_SIMD_WIDEST >= 512
    [DEM_AVX512] = dem_integrators_avx512,
#endif
#if DEM_SIMD_WIDEST >= 256
    [DEM_AVX2] = dem_integrators_avx2,
#endif
    [DEM_PLAIN] = dem_integrators_plain,
};

const dem_integrator *dem_integrator_find(const char *simd, const char *name, bool driven) {
  const dem_integrator *all = sets[dem_simd_find(simd)];
  for (; all->name; all++)
    if (!strcmp(all->name, name) && all->driven == driven)
      return all;
  return NULL;
}
