/* The tables of contact laws. The loops themselves are in loop.c. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/contact/table.h"

#include "dem/contact/loop.h"

#include <stddef.h>
#include <string.h>

#define X(law, name, ncolumn, vectors, keys) {name, ncolumn, vectors, keys},
const dem_law_row dem_normals[] = {DEM_NORMAL_LIST(X){0}};
const dem_law_row dem_tangentials[] = {DEM_TANGENTIAL_LIST(X){0}};
const dem_law_row dem_rollings[] = {DEM_ROLLING_LIST(X){0}};
const dem_law_row dem_twistings[] = {DEM_TWISTING_LIST(X){0}};
const dem_law_row dem_cohesions[] = {DEM_COHESION_LIST(X){0}};
#undef X

const char *const dem_tail_names[] = {"keep", "clip", NULL};
const char *const dem_simd_names[] = {"avx512", "avx2", "plain", NULL};

/* by instruction set as above, then by normal law */
#define X(law, name, ncolumn, vectors, keys) dem_laws_##law##_avx512,
#define Y(law, name, ncolumn, vectors, keys) dem_laws_##law##_avx2,
#define Z(law, name, ncolumn, vectors, keys) dem_laws_##law##_plain,
static const dem_law *const laws[][DEM_NORMALS] = {{DEM_NORMAL_LIST(X)}, {DEM_NORMAL_LIST(Y)}, {DEM_NORMAL_LIST(Z)}};
#undef X
#undef Y
#undef Z

static bool has_avx512(void) {
  return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq");
}

/* index of an instruction set that this machine has, -1: it has not */
static int simd_index(const char *simd) {
  const bool here[] = {has_avx512(), __builtin_cpu_supports("avx2"), true};
  for (int i = 0; dem_simd_names[i]; i++)
    if (!strcmp(simd, dem_simd_names[i]))
      return here[i] ? i : -1;
  return -1;
}

bool dem_simd_here(const char *simd) {
  return simd_index(simd) >= 0;
}

const char *dem_simd_best(void) {
  int i = 0;
  while (!dem_simd_here(dem_simd_names[i]))
    i++;
  return dem_simd_names[i];
}

const dem_law *dem_law_find(const char *simd, dem_normal normal, dem_tangential_law tangential, bool all_terms) {
  int s = simd_index(simd);
  for (const dem_law *law = s < 0 ? NULL : laws[s][normal]; law && law->pairs; law++)
    if (law->tangential == tangential && law->all_terms == all_terms)
      return law;
  return NULL;
}

/* append the columns of a row; the first of them, -1: it has none */
static int append(dem_columns *c, const dem_law_row *row) {
  int first = c->ncolumn;
  c->vectors |= row->vectors << first;
  c->ncolumn += row->ncolumn;
  return row->ncolumn > 0 ? first : -1;
}

dem_columns dem_columns_of(const dem_law *law, dem_rolling rolling, dem_cohesion cohesion, bool sliding) {
  dem_columns c = {0};
  append(&c, &dem_tangentials[law->tangential]);
  c.normal = append(&c, &dem_normals[law->normal]);
  c.rolling = append(&c, &dem_rollings[rolling]);
  c.cohesion = append(&c, &dem_cohesions[cohesion]);
  c.sliding = append(&c, &(dem_law_row){.ncolumn = sliding});
  return c;
}
