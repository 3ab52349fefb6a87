/* The table of contact laws. The loops themselves are in loop.c. */
#include "dem/contact/table.h"

#include "dem/contact/loop.h"

#include <stddef.h>
#include <string.h>

const char *const dem_normal_names[] = {"hertz", NULL};
const char *const dem_tangential_names[] = {"none", "mindlin", NULL};
const char *const dem_tail_names[] = {"keep", "clip", NULL};

static const dem_law laws[] = {
#define X(normal, tangential, tail, history)   \
  {#normal,                                    \
   #tangential,                                \
   #tail,                                      \
   history,                                    \
   DEM_TAIL_IS_##tail,                         \
   dem_pairs_##normal##_##tangential##_##tail, \
   dem_walls_##normal##_##tangential##_##tail},
    DEM_LAW_LIST(X)
#undef X
};

const dem_law *dem_law_find(const char *normal, const char *tangential, const char *tail) {
  for (size_t i = 0; i < sizeof laws / sizeof laws[0]; i++)
    if (!strcmp(laws[i].normal, normal) && !strcmp(laws[i].tangential, tangential) && !strcmp(laws[i].tail, tail))
      return &laws[i];
  return NULL;
}
