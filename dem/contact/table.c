/* The tables of contact laws: see table.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#define DEM_LAW_ROWS /* compile the rows of families.h here */
#include "dem/contact/table.h"

#include "dem/contact/families.h"

#include <assert.h>
#include <stddef.h>
#include <string.h>

#define X(law) extern const dem_normal_law dem_normal_##law;
DEM_NORMALS(X)
#undef X
#define X(law) extern const dem_multi_law dem_multi_##law;
DEM_MULTIS(X)
#undef X

enum { LAWS_MAX = 16 };

#define N(law) &dem_normal_##law.head,
#define T(law) &dem_tangential_row_##law.head,
#define R(law) &dem_rolling_row_##law.head,
#define W(law) &dem_twisting_row_##law.head,
#define C(law) &dem_cohesion_row_##law.head,
#define M(law) &dem_multi_##law.head,
static const dem_law_head *table[DEM_FAMILIES][LAWS_MAX + 1] = {
    [DEM_FAMILY_NORMAL] = {DEM_NORMALS(N)},     [DEM_FAMILY_TANGENTIAL] = {DEM_TANGENTIALS(T)},
    [DEM_FAMILY_ROLLING] = {DEM_ROLLINGS(R)},   [DEM_FAMILY_TWISTING] = {DEM_TWISTINGS(W)},
    [DEM_FAMILY_COHESION] = {DEM_COHESIONS(C)}, [DEM_FAMILY_MULTI] = {DEM_MULTIS(M)},
};

const char *const dem_family_names[DEM_FAMILIES] = {
    [DEM_FAMILY_NORMAL] = "normal",     [DEM_FAMILY_TANGENTIAL] = "tangential", [DEM_FAMILY_ROLLING] = "rolling",
    [DEM_FAMILY_TWISTING] = "twisting", [DEM_FAMILY_COHESION] = "cohesion",     [DEM_FAMILY_MULTI] = "multi_contact",
};

const dem_law_head *dem_law_at(dem_family family, int place) {
  return table[family][place];
}

int dem_law_place(dem_family family, const char *name) {
  for (int k = 0; table[family][k]; k++)
    if (strcmp(table[family][k]->name, name) == 0)
      return k;
  return -1;
}

tdm_status dem_law_add(dem_family family, const dem_law_head *law, tdm_error *err) {
  int n = 0;
  assert(law->name && (family == DEM_FAMILY_NORMAL || family == DEM_FAMILY_MULTI) == !law->kernel);
  while (table[family][n])
    n++;
  if (dem_law_place(family, law->name) >= 0)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "there is a %s law \"%s\" already; give the new one another name",
                    dem_family_names[family], law->name);
  if (n == LAWS_MAX)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "no place for %s law \"%s\": the table has room for %d laws",
                    dem_family_names[family], law->name, LAWS_MAX);
  table[family][n] = law;
  return TDM_OK;
}

const dem_law_head *dem_law_of(const dem_model *m, dem_family family) {
  const dem_law_head *const of[] = {
      [DEM_FAMILY_NORMAL] = &m->normal->head,     [DEM_FAMILY_TANGENTIAL] = &m->tangential->head,
      [DEM_FAMILY_ROLLING] = &m->rolling->head,   [DEM_FAMILY_TWISTING] = &m->twisting->head,
      [DEM_FAMILY_COHESION] = &m->cohesion->head, [DEM_FAMILY_MULTI] = &m->multi->head,
  };
  return of[family];
}

static int place_of(const dem_model *m, dem_family family) {
  return dem_law_place(family, dem_law_of(m, family)->name);
}

/* is one of the laws, but the normal law, a program's own? */
static bool calls(const dem_model *m) {
  bool any = false;
  for (dem_family f = 0; f < DEM_FAMILIES; f++)
    any = any || dem_law_of(m, f)->kernel;
  return any;
}

/* The set of a normal law, or of the law of many contacts that stands in its place, for the scene's instruction set;
 * laws from elsewhere are called in plain C. */
static const dem_loop_set *set_of(const dem_model *m, const dem_normal_law *law) {
  const dem_loop_set *const *sets = m->multi->head.none ? law->loops : m->multi->loops;
  const dem_loop_set *set = sets[dem_simd_find(m->simd)];
  return set && !calls(m) ? set : sets[DEM_PLAIN];
}

static const dem_loops *loops_of(const dem_model *m, const dem_loop_set *set) {
  return calls(m) ? &set->called : m->all_terms ? &set->all_terms : &set->with[m->place.tangential];
}

bool dem_loops_choose(dem_model *m) {
  m->place.tangential = place_of(m, DEM_FAMILY_TANGENTIAL);
  m->place.rolling = place_of(m, DEM_FAMILY_ROLLING);
  m->place.twisting = place_of(m, DEM_FAMILY_TWISTING);
  m->place.cohesion = place_of(m, DEM_FAMILY_COHESION);
  const dem_loop_set *set = set_of(m, m->normal);
  m->loops = loops_of(m, set);
  m->wall_loops = loops_of(m, set_of(m, m->wall_normal));
  m->nsum = set->nsum;
  m->sum_loops = set->nsum > 0 ? &set->sums : NULL;
  m->noting = set->noting;
  return (m->normal->circle && m->wall_normal->circle) || !m->tangential->needs_circle;
}

/* append the columns of a row; the first of them, -1: it has none */
static int append(dem_columns *c, const dem_law_head *row) {
  int first = c->ncolumn;
  c->vectors |= row->vectors << first;
  c->ncolumn += row->ncolumn;
  return row->ncolumn > 0 ? first : -1;
}

bool dem_columns_choose(dem_model *m, bool sliding) {
  dem_columns c = {0};
  append(&c, &m->tangential->head);
  const dem_law_head *of = &m->normal->head, *of_walls = &m->wall_normal->head;
  if (!m->multi->head.none)
    of = of_walls = &m->multi->head; /* in the place of both */
  c.normal = append(&c, of->ncolumn < of_walls->ncolumn ? of_walls : of);
  c.rolling = append(&c, &m->rolling->head);
  c.twisting = append(&c, &m->twisting->head);
  c.cohesion = append(&c, &m->cohesion->head);
  c.sliding = append(&c, &(dem_law_head){.ncolumn = sliding});
  m->columns = c;
  return c.ncolumn <= DEM_HISTORY_MAX;
}
