/* Finding an integrator: see integrate.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/step/integrate.h"

#include <string.h>

const char *const dem_integrator_names[] = {
#define X(name, function, keeps) name,
    DEM_INTEGRATOR_LIST(X)
#undef X
        NULL};

const dem_integrator *dem_integrator_find(const char *simd, const char *name, bool driven) {
  const dem_integrator *all = !strcmp(simd, "avx512") ? dem_integrators_avx512
                              : !strcmp(simd, "avx2") ? dem_integrators_avx2
                                                      : dem_integrators_plain;
  for (; all->name; all++)
    if (!strcmp(all->name, name) && all->driven == driven)
      return all;
  return NULL;
}
