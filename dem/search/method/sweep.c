/* The linked linear list: see sweep.h.
 *
 * A box is the sphere grown by half the skin. Between calls the marks keep their order, which changes little; they are
 * sorted again by exchanging neighbours, and every exchange says by its rule what becomes of the pair. A pair is stored
 * while its boxes overlap on all axes: when an overlap begins on one axis, the boxes' other axes are looked at. All
 * boxes are moved before the first exchange, so that the last exchange of a pair, on whichever axis, leaves it right.
 * If too much changed for that to pay (other particles, another numbering) all is made anew.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/search/method/sweep.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

dem_rule dem_sweep_rule(const dem_mark *left, const dem_mark *right) {
  if (left->end == right->end)
    return left->end ? DEM_RULE_ENDS : DEM_RULE_BEGINS;
  return left->end ? DEM_RULE_ADD : DEM_RULE_REMOVE;
}

/* Where ends coincide, a box that ends comes before one that begins: touching is not overlapping. So the order of the
 * marks says the same as comparing the boxes' ends. */
static bool before(const dem_mark *a, const dem_mark *b) {
  return a->x < b->x || (a->x == b->x && a->end && !b->end);
}

static double image(const dem_sweep *s, int axis, double x, int copy) {
  return copy ? x + s->length[axis] : x;
}

static bool overlap_on(const dem_sweep *s, int axis, int i, int j) {
  double low_i = s->low[3 * i + axis], high_i = s->high[3 * i + axis];
  double low_j = s->low[3 * j + axis], high_j = s->high[3 * j + axis];
  if (low_i < high_j && low_j < high_i)
    return true;
  if (s->copies[axis] == 1)
    return false;
  double far_i = image(s, axis, low_i, 1), far_j = image(s, axis, low_j, 1);
  return (low_i < image(s, axis, high_j, 1) && far_j < high_i) || (far_i < high_j && low_j < image(s, axis, high_i, 1));
}

static bool overlap(const dem_sweep *s, int i, int j) {
  return overlap_on(s, 0, i, j) && overlap_on(s, 1, i, j) && overlap_on(s, 2, i, j);
}

/* the link to the pair i < j, or the one at the end of i's chain */
static int *find_link(const dem_sweep *s, int i, int j) {
  int *at = &s->head[i];
  while (*at >= 0 && s->link[*at].other != j)
    at = &s->link[*at].next;
  return at;
}

bool dem_sweep_stored(const dem_sweep *s, int i, int j) {
  return *find_link(s, i < j ? i : j, i < j ? j : i) >= 0;
}

static tdm_status new_link(dem_sweep *s) {
  if (s->free_link >= 0)
    return TDM_OK;
  if (s->nlink == s->link_capacity) {
    int capacity = s->nlink + s->nlink / 2 + 64;
    dem_link *link = realloc(s->link, (size_t)capacity * sizeof *link);
    if (!link)
      return TDM_ERR_MEMORY;
    s->link = link;
    s->link_capacity = capacity;
  }
  s->link[s->nlink].next = -1;
  s->free_link = s->nlink++;
  return TDM_OK;
}

static tdm_status store(dem_sweep *s, int i, int j) {
  if (i > j)
    return store(s, j, i);
  if (*find_link(s, i, j) >= 0)
    return TDM_OK;
  if (new_link(s))
    return TDM_ERR_MEMORY;
  int link = s->free_link;
  s->free_link = s->link[link].next;
  s->link[link] = (dem_link){j, s->head[i]};
  s->head[i] = link;
  return TDM_OK;
}

static void forget(dem_sweep *s, int i, int j) {
  int *at = find_link(s, i < j ? i : j, i < j ? j : i), link = *at;
  if (link < 0)
    return;
  *at = s->link[link].next;
  s->link[link].next = s->free_link;
  s->free_link = link;
}

/* what becomes of the pair whose marks change places */
static tdm_status exchanged(dem_sweep *s, const dem_mark *left, const dem_mark *right) {
  int i = left->particle, j = right->particle;
  if (i == j)
    return TDM_OK;
  switch (dem_sweep_rule(left, right)) {
  case DEM_RULE_BEGINS:
  case DEM_RULE_ENDS:
    return TDM_OK;
  case DEM_RULE_REMOVE:
    if (!overlap(s, i, j)) /* another image may still overlap */
      forget(s, i, j);
    return TDM_OK;
  case DEM_RULE_ADD:
    return overlap(s, i, j) ? store(s, i, j) : TDM_OK;
  }
  return TDM_OK;
}

/* Boxes of the spheres; those of positions that are not finite are empty and lie behind all others. A little is added
 * so that round-off loses no pair. */
static void move_boxes(dem_sweep *s, const dem_search_input *input) {
  for (int i = 0; i < s->n; i++) {
    const dem_sphere *p = dem_search_sphere(input, i);
    double x[3] = {p->position.x, p->position.y, p->position.z};
    bool finite = isfinite(x[0]) && isfinite(x[1]) && isfinite(x[2]);
    for (int a = 0; a < 3; a++) {
      if (s->copies[a] == 2)
        x[a] -= s->length[a] * floor((x[a] - input->domain.low[a]) / s->length[a]);
      double half = (p->radius + input->skin / 2) * (1 + 1e-9) + 16 * DBL_EPSILON * (fabs(x[a]) + s->length[a]);
      s->low[3 * i + a] = finite ? x[a] - half : INFINITY;
      s->high[3 * i + a] = finite ? x[a] + half : INFINITY;
    }
  }
}

static int mark_count(const dem_sweep *s, int axis) {
  return 2 * s->n * s->copies[axis];
}

static void move_marks(dem_sweep *s, int axis) {
  for (int k = 0; k < mark_count(s, axis); k++) {
    dem_mark *m = &s->mark[axis][k];
    m->x = image(s, axis, (m->end ? s->high : s->low)[3 * m->particle + axis], m->image);
  }
}

typedef enum { DONE, TOO_MANY, NO_MEMORY } outcome;

/* insertion sort, of at most so many exchanges */
static outcome sort_marks(dem_sweep *s, int axis, long long *left) {
  dem_mark *mark = s->mark[axis];
  for (int k = 1; k < mark_count(s, axis); k++) {
    dem_mark moving = mark[k];
    int at = k;
    for (; at > 0 && before(&moving, &mark[at - 1]); at--) {
      if (exchanged(s, &mark[at - 1], &moving))
        return NO_MEMORY;
      mark[at] = mark[at - 1];
    }
    mark[at] = moving;
    *left -= k - at;
    if (*left < 0)
      return TOO_MANY;
  }
  return DONE;
}

static int compare_marks(const void *a, const void *b) {
  const dem_mark *x = a, *y = b;
  if (before(x, y))
    return -1;
  if (before(y, x))
    return 1;
  return (x->particle > y->particle) - (x->particle < y->particle);
}

static void all_marks(dem_sweep *s, int axis) {
  int k = 0;
  for (int i = 0; i < s->n; i++)
    for (int copy = 0; copy < s->copies[axis]; copy++)
      for (int end = 0; end < 2; end++)
        s->mark[axis][k++] = (dem_mark){.particle = i, .image = (uint8_t)copy, .end = end};
  move_marks(s, axis);
  qsort(s->mark[axis], (size_t)k, sizeof *s->mark[axis], compare_marks);
}

/* Pass along the axis with the boxes that have begun and not ended: each that begins overlaps all of these there. */
static tdm_status store_all(dem_sweep *s, int axis) {
  int *open = malloc(4 * (size_t)s->n * sizeof *open), *place = open + 2 * (size_t)s->n;
  tdm_status status = open ? TDM_OK : TDM_ERR_MEMORY;
  int nopen = 0;
  for (int k = 0; !status && k < mark_count(s, axis); k++) {
    const dem_mark *m = &s->mark[axis][k];
    int box = 2 * m->particle + m->image;
    if (!(s->low[3 * m->particle + axis] < s->high[3 * m->particle + axis]))
      continue; /* empty */
    if (!m->end) {
      s->anew += nopen;
      for (int o = 0; !status && o < nopen; o++)
        if (open[o] / 2 != m->particle && overlap(s, open[o] / 2, m->particle))
          status = store(s, open[o] / 2, m->particle);
      place[box] = nopen;
      open[nopen++] = box;
    } else {
      int last = open[--nopen];
      open[place[box]] = last;
      place[last] = place[box];
    }
  }
  free(open);
  return status;
}

static tdm_status make_anew(dem_sweep *s) {
  for (int i = 0; i < s->n; i++)
    s->head[i] = -1;
  s->nlink = 0;
  s->free_link = -1;
  s->anew = 0;
  for (int a = 0; a < 3; a++)
    all_marks(s, a);
  return s->n == 0 ? TDM_OK : store_all(s, 0);
}

static bool same_domain(const dem_sweep *s, const dem_domain *domain) {
  for (int a = 0; a < 3; a++)
    if (s->copies[a] != (domain->periodic[a] ? 2 : 1) || (domain->periodic[a] && s->length[a] != domain->length[a]))
      return false;
  return true;
}

/* memory for n boxes in this domain; nothing that was stored is kept */
static tdm_status reserve(dem_sweep *s, size_t n, const dem_domain *domain) {
  size_t capacity = n + n / 8 + 1;
  dem_sweep_free(s);
  s->low = malloc(3 * capacity * sizeof *s->low);
  s->high = malloc(3 * capacity * sizeof *s->high);
  s->head = malloc(capacity * sizeof *s->head);
  bool ok = s->low && s->high && s->head;
  for (int a = 0; a < 3; a++) {
    s->copies[a] = domain->periodic[a] ? 2 : 1;
    s->length[a] = domain->periodic[a] ? domain->length[a] : 0;
    s->mark[a] = malloc(2 * (size_t)s->copies[a] * capacity * sizeof *s->mark[a]);
    ok = ok && s->mark[a];
  }
  s->capacity = ok ? capacity : 0;
  return ok ? TDM_OK : TDM_ERR_MEMORY;
}

tdm_status dem_sweep_update(dem_sweep *s, const dem_search_input *input) {
  bool same = same_domain(s, &input->domain), known = same && s->n == input->n && s->capacity > 0;
  if ((!same || s->capacity <= (size_t)input->n) && reserve(s, (size_t)input->n, &input->domain))
    return TDM_ERR_MEMORY;
  s->n = input->n;
  move_boxes(s, input);
  if (!known)
    return make_anew(s);
  /* exchanges that take the time of making all anew: sorting costs some hundreds a particle, a comparison a few */
  long long left = 300LL * s->n + 2 * s->anew;
  for (int a = 0; a < 3; a++) {
    move_marks(s, a);
    outcome done = sort_marks(s, a, &left);
    if (done == NO_MEMORY)
      s->n = -1; /* what is stored is incomplete */
    if (done != DONE)
      return done == TOO_MANY ? make_anew(s) : TDM_ERR_MEMORY;
  }
  return TDM_OK;
}

void dem_sweep_free(dem_sweep *s) {
  free(s->low);
  free(s->high);
  free(s->head);
  free(s->link);
  for (int a = 0; a < 3; a++)
    free(s->mark[a]);
  *s = (dem_sweep){0};
}

static tdm_status find(void *state, const dem_search_input *input, dem_found *found) {
  dem_sweep *s = state;
  if (dem_sweep_update(s, input))
    return TDM_ERR_MEMORY;
  dem_near near = dem_near_make(input);
  for (int i = 0; i < s->n; i++)
    for (int l = s->head[i]; l >= 0; l = s->link[l].next)
      if (dem_spheres_near(&near, dem_search_sphere(input, i), dem_search_sphere(input, s->link[l].other))) {
        if (dem_found_reserve(found, 1))
          return TDM_ERR_MEMORY;
        found->pair[found->count++] = (dem_found_pair){i, s->link[l].other};
      }
  return TDM_OK;
}

static void release(void *state) {
  dem_sweep_free(state);
}

/* As [A07] has it: boxes without a skin, brought up to date in every step. Their skin here is round-off. */
const dem_search_method dem_search_linked_linear = {
    .state_size = sizeof(dem_sweep), .find = find, .release = release, .skin_radii = 1e-9, .interval = 1};

const dem_search_method dem_search_sweep = {.state_size = sizeof(dem_sweep), .find = find, .release = release};
