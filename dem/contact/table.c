/* The table of contact laws. The loops themselves are in loop.c. */
#include "dem/contact/table.h"

#include "dem/contact/loop.h"
#include "dem/integrate.h"

#include <stddef.h>
#include <string.h>

const char *const dem_normal_names[] = {"hertz", NULL};
const char *const dem_tangential_names[] = {"none", "mindlin", NULL};
const char *const dem_tail_names[] = {"keep", "clip", NULL};
const char *const dem_simd_names[] = {"avx512", "avx2", "plain", NULL};

static bool has_avx512(void) {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
}

static const dem_law *laws_of(const char *simd) {
  if (!strcmp(simd, "avx512") && has_avx512())
    return dem_laws_avx512;
  if (!strcmp(simd, "avx2") && __builtin_cpu_supports("avx2"))
    return dem_laws_avx2;
  return strcmp(simd, "plain") ? NULL : dem_laws_plain;
}

const char *dem_simd_best(void) {
  int i = 0;
  while (!laws_of(dem_simd_names[i]))
    i++;
  return dem_simd_names[i];
}

const dem_law *dem_law_find(const char *simd, const char *normal, const char *tangential) {
  for (const dem_law *law = laws_of(simd); law && law->normal; law++)
    if (!strcmp(law->normal, normal) && !strcmp(law->tangential, tangential))
      return law;
  return NULL;
}

const dem_integrator *dem_integrator_find(const char *simd) {
  return !strcmp(simd, "avx512") ? &dem_integrator_avx512
         : !strcmp(simd, "avx2") ? &dem_integrator_avx2
                                 : &dem_integrator_plain;
}
