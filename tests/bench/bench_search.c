/* Speed of the searches: ns a particle to make the rows. Not a test.
 *
 *   bench_search [largest number of spheres [threads]]
 *
 * Beds: spheres at the points of a disturbed face-centred lattice, numbered along the lattice ("in order") or at
 * random; the share of touching neighbours is that of a settled bed. Then sets of [A07] Fig. 2.17: discs of 10, 15 and
 * 20 mm.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/search.h"
#include "protocol/base/log.h"
#include "protocol/math/random.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint64_t random_state = 1;

/* [0, 1) */
static double random_unit(void) {
  return tdm_random_next(&random_state);
}

static void shuffle(dem_sphere *s, int n) {
  for (int i = n - 1; i > 0; i--) {
    int j = (int)(random_unit() * (i + 1));
    dem_sphere t = s[i];
    s[i] = s[j];
    s[j] = t;
  }
}

static void shake(dem_sphere *s, int n, double size) {
  for (int i = 0; i < n; i++)
    s[i].position = tdm_add(s[i].position, tdm_v3(size * (random_unit() - 0.5), size * (random_unit() - 0.5),
                                                  size * (random_unit() - 0.5)));
}

/* n spheres of radius 1 */
static void lattice(dem_sphere *s, int n) {
  const double edge = 2.86; /* of the cube of four spheres: solid fraction 0.72, less what the disturbance undoes */
  int side = (int)ceil(cbrt(n / 4.0));
  static const double base[4][3] = {{0, 0, 0}, {0.5, 0.5, 0}, {0.5, 0, 0.5}, {0, 0.5, 0.5}};
  for (int i = 0; i < n; i++) {
    int cube = i / 4, x = cube % side, y = cube / side % side, z = cube / side / side;
    const double *b = base[i % 4];
    s[i] = (dem_sphere){.position = {edge * (x + b[0]), edge * (y + b[1]), edge * (z + b[2])}, .radius = 1};
  }
  shake(s, n, 0.3);
}

/* spheres whose volumes are shared equally by radii from 1 to `ratio`, at random places of a box that they fill to 0.6;
 * they interpenetrate */
static void mixture(dem_sphere *s, int n, double ratio) {
  double volume = 0;
  for (int i = 0; i < n; i++) {
    double u = random_unit(), small = 1, large = 1 / (ratio * ratio * ratio);
    s[i].radius = cbrt(1 / (small + u * (large - small)));
    volume += 4.0 / 3 * 3.14159265 * s[i].radius * s[i].radius * s[i].radius;
  }
  double side = cbrt(volume / 0.6);
  for (int i = 0; i < n; i++)
    s[i].position = tdm_v3(side * random_unit(), side * random_unit(), side * random_unit());
}

/* shortest time of a call [s], which other programs disturb least; small moves between calls */
static double measure(const char *name, dem_search_input *in, dem_sphere *s, double move, dem_rows *rows) {
  dem_search *search = dem_search_create(name);
  bool ok = !dem_search_run(search, in, rows);
  double shortest = INFINITY;
  for (int k = 0; ok && k < 10; k++) {
    shake(s, in->n, move);
    double begin = tdm_clock();
    ok = !dem_search_run(search, in, rows);
    shortest = fmin(shortest, tdm_clock() - begin);
  }
  dem_search_destroy(&search);
  return ok ? shortest : NAN;
}

static void report(const char *what, dem_search_input *in, dem_sphere *s, double move) {
  dem_rows rows = {0};
  printf("%-26s %8d", what, in->n);
  for (const char *const *name = dem_search_names; *name; name++) {
    bool squared = !strcmp(*name, "all") || !strcmp(*name, "verlet-1967");
    bool endless = (squared && in->n > 5000) || (!strcmp(*name, "sweep") && in->n > 200000);
    if (endless)
      printf(" %11s", "-");
    else
      printf(" %11.1f", 1e9 * measure(*name, in, s, move, &rows) / in->n);
    fflush(stdout);
  }
  printf("  %5.2f  %s\n", (double)rows.count / in->n, dem_search_choose(in));
}

/* groups of [A07] Section 2.3.2: 10, 15 and 20 mm in the shares of the largest group, at random in a circle that they
 * fill to 0.6 */
static int discs(dem_sphere *s, double share) {
  const double radius[3] = {0.010, 0.015, 0.020}, number[3] = {2278, 1716, 342};
  double area = 0;
  int n = 0;
  for (int k = 0; k < 3; k++)
    for (int i = 0; i < (int)round(share * number[k]); i++) {
      s[n++].radius = radius[k];
      area += 3.14159265 * radius[k] * radius[k];
    }
  double container = sqrt(area / 0.6 / 3.14159265);
  for (int i = 0; i < n; i++) {
    double r = container * sqrt(random_unit()), angle = 2 * 3.14159265 * random_unit();
    s[i].position = tdm_v3(r * cos(angle), 0, r * sin(angle));
  }
  return n;
}

int main(int argc, char **argv) {
  int most = argc > 1 ? atoi(argv[1]) : 100000;
  dem_sphere *s = calloc((size_t)most + 5000, sizeof *s);
  dem_search_input in = {.sphere = s, .skin = 0.1, .nthread = argc > 2 ? atoi(argv[2]) : 1};
  printf("%-26s %8s", "ns a particle", "spheres");
  for (const char *const *name = dem_search_names; *name; name++)
    printf(" %11s", *name);
  printf("  pairs  auto\n");
  for (int n = 1000; n <= most; n *= 10) {
    in.n = n;
    lattice(s, n);
    report("equal, in order", &in, s, 0.02);
    shuffle(s, n);
    report("equal, at random", &in, s, 0.02);
  }
  static const double ratio[] = {2, 3, 5, 10, 30, 100};
  for (size_t k = 0; k < sizeof ratio / sizeof *ratio; k++)
    for (int n = 10000; n <= most && n <= 100000; n *= 10) {
      char what[64];
      snprintf(what, sizeof what, "sizes 1:%g", ratio[k]);
      in.n = n;
      mixture(s, n, ratio[k]);
      report(what, &in, s, 0.02);
    }
  in.skin = 0.001;
  for (int k = 1; k <= 5; k++) {
    in.n = discs(s, k / 5.0);
    report("discs of 10, 15, 20 mm", &in, s, 1e-4);
  }
  free(s);
  return EXIT_SUCCESS;
}
