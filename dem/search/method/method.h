/* What the searches share: the distance that decides, the lists of pairs they fill, and the row of the table.
 *
 * To add a search: a file with its `dem_search_method`, and one row in search.c. A search finds every near pair exactly
 * once, in any order and either way round, and puts it into the list of the thread that found it; search.c makes sorted
 * rows of them.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_SEARCH_METHOD_METHOD_H
#define DEM_SEARCH_METHOD_METHOD_H

#include "dem/base/near.h"
#include "dem/base/scratch.h"
#include "dem/base/sphere.h"
#include "protocol/base/status.h"

#include <stdbool.h>
#include <stddef.h>

/* What a search is given. */
typedef struct {
  const dem_sphere *sphere; /* (n), or more */
  int n;
  const int *number; /* (n) which of the spheres are searched, ascending, first `begin` ... end - 1; NULL: all */
  bool some;         /* only the rows of particles begin ... end - 1 are wanted; else of all */
  int begin, end;    /* (some) */
  const int *run;    /* (2 x nrun) these may be named besides: run[2 k] ... run[2 k + 1] - 1; NULL: all behind */
  int nrun;
  double skin; /* [m] */
  dem_domain domain;
  int nthread;          /* threads that may be used; the result does not depend on it */
  dem_scratch *scratch; /* for the rows and what it takes to find them; NULL: the search has its own */
} dem_search_input;

/* Sphere k of those that are searched. */
static inline const dem_sphere *dem_search_sphere(const dem_search_input *input, int k) {
  return &input->sphere[input->number ? input->number[k] : k];
}

/* of every kernel: specialised by its constant arguments */
#define DEM_SEARCH_KERNEL static inline __attribute__((always_inline))

typedef struct {
  int a, b;
} dem_found_pair;

typedef struct {
  dem_found_pair *pair; /* (capacity) */
  size_t count, capacity;
  dem_found_pair *own; /* the pairs, where they did not fit in the scratch memory; else NULL */
  bool failed;         /* there was no memory */
} dem_found;

/* `state` is the search's own, of state_size bytes and zero at first: with one, it gets all spheres every time, else
 * only those that the wanted rows can name (search/nearby.h). `found` has input->nthread lists, empty. What is
 * taken of input->scratch (there always is one) is given back by dem_search_run. */
typedef struct {
  size_t state_size;
  /* TDM_ERR_MEMORY: for the state */
  tdm_status (*find)(void *state, const dem_search_input *input, dem_found *found);
  void (*release)(void *state); /* may be NULL: nothing to free */
  double skin_radii;            /* the search's own skin in largest radii; 0: the one that is asked for */
  int interval;                 /* steps; 0: as the skin needs */
} dem_search_method;

extern const dem_search_method dem_search_cells, dem_search_sweep, dem_search_linked_linear, dem_search_grid,
    dem_search_verlet_1967, dem_search_all;

/* Is one grid of cells right for n spheres, of this largest radius and this sum of radii cubed, where a radius is that
 * with half the skin? In a packing a sphere has about 15 n r_max^3 / sum r^3 candidates in cells of the largest
 * diameter: 15 if all are equal, many more if small ones fill the cells of large ones; `worth` times as many are worth
 * one grid less. */
bool dem_cells_fit(int n, double largest, double cubes, double worth);

/* Room for `more` pairs beyond the count. TDM_ERR_MEMORY, which the list remembers for dem_search_run. */
tdm_status dem_found_grow(dem_found *pairs, size_t more);

static inline tdm_status dem_found_reserve(dem_found *pairs, size_t more) {
  return pairs->capacity - pairs->count >= more ? TDM_OK : dem_found_grow(pairs, more);
}

/* Call work(context, t) for t = 0 ... nthread - 1, side by side where OpenMP is there. */
void dem_search_parallel(int nthread, void (*work)(void *context, int t), void *context);

/* threads for n spheres; few are not worth starting any for */
static inline int dem_search_threads(const dem_search_input *input, int n) {
  return n < 1000 ? 1 : input->nthread;
}

/* the part of 0 ... n that is thread t's: from dem_search_part(n, t, nthread) up to dem_search_part(n, t + 1, nthread)
 */
static inline int dem_search_part(int n, int t, int nthread) {
  return (int)((long long)n * t / nthread);
}

/* What decides whether a pair is near. In a direction that does not repeat, length and inverse are zero. */
typedef struct {
  double skin, length[3], inverse[3];
  bool periodic; /* any direction */
} dem_near;

static inline dem_near dem_near_make(const dem_search_input *input) {
  dem_near near = {.skin = input->skin};
  for (int a = 0; a < 3; a++)
    if (input->domain.periodic[a]) {
      near.periodic = true;
      near.length[a] = input->domain.length[a];
      near.inverse[a] = 1 / input->domain.length[a];
    }
  return near;
}

/* d to the nearest image; adding and subtracting 1.5 * 2^52 rounds to the nearest integer with plain instructions */
DEM_SEARCH_KERNEL double dem_nearest(double d, double length, double inverse) {
  const double big = 6755399441055744.0;
  return d - length * ((d * inverse + big) - big);
}

/* Negative if the pair is near [m2]. All searches decide by this function, whose value does not depend on the order of
 * the two: so their rows agree to the last pair. NaN says no. `periodic` may be false only if no direction repeats. */
DEM_SEARCH_KERNEL double dem_excess(const dem_near *near, bool periodic, double dx, double dy, double dz,
                                    double radii) {
  if (periodic) {
    dx = dem_nearest(dx, near->length[0], near->inverse[0]);
    dy = dem_nearest(dy, near->length[1], near->inverse[1]);
    dz = dem_nearest(dz, near->length[2], near->inverse[2]);
  }
  double reach = radii + near->skin;
  return dx * dx + dy * dy + dz * dz - reach * reach;
}

static inline bool dem_spheres_near(const dem_near *near, const dem_sphere *a, const dem_sphere *b) {
  return dem_excess(near, near->periodic, a->position.x - b->position.x, a->position.y - b->position.y,
                    a->position.z - b->position.z, a->radius + b->radius) < 0;
}

#endif
