/* Walls with parts, the triangles of a mesh, which a sphere may touch at several places. Where they are dem_triangles,
 * DEM_W entries are looked at together, and dem_shape.touches is asked only where that leaves open what the contacts
 * are. Only loops.h includes it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LOOP_PART_LOOP_H
#define DEM_CONTACT_LOOP_PART_LOOP_H

#include "dem/contact/loop/batch.h"
#include "dem/contact/loop/triangles.h"
#include "dem/search/pairs.h"

/* The entries of one particle with one wall, [begin, end), and those among them, ascending, that are contacts now. */
typedef struct {
  size_t begin, end;
  int n;
  size_t at[DEM_TOUCHES_MAX];
  double gap[DEM_TOUCHES_MAX];
  tdm_vec3 normal[DEM_TOUCHES_MAX]; /* world */
} touching_parts;

/* ---- histories ---- */

static bool holds(const touching_parts *now, size_t k) {
  for (int c = 0; c < now->n; c++)
    if (now->at[c] == k)
      return true;
  return false;
}

static bool has_history(const dem_wall_contacts *list, size_t k, int ncolumn) {
  for (int q = 0; q < ncolumn; q++)
    if (list->history[(size_t)q * list->capacity + k] != 0)
      return true;
  return false;
}

/* Hand the history of a contact that ended on a part to the one that begins on a neighbour. */
static void pass_histories(const dem_wall *wall, const dem_wall_contacts *list, const touching_parts *now,
                           int ncolumn) {
  for (int c = 0; c < now->n && ncolumn > 0; c++) {
    const size_t to = now->at[c];
    bool fresh = !has_history(list, to, ncolumn);
    for (size_t from = now->begin; from < now->end && fresh; from++) {
      if (!has_history(list, from, ncolumn) || holds(now, from) ||
          !wall->shape->passes(wall, list->entry[from].part, list->entry[to].part))
        continue;
      for (int q = 0; q < ncolumn; q++) {
        double *column = list->history + (size_t)q * list->capacity;
        column[to] = column[from];
        column[from] = 0;
      }
      fresh = false;
    }
  }
}

/* ---- the contacts of one particle ---- */

/* as the shape says */
static void ask_shape(const dem_data *d, const dem_wall *wall, const dem_wall_place *place, double reach,
                      touching_parts *now) {
  const dem_wall_entry *entry = d->lists.walls.entry;
  const dem_sphere *s = &d->state.sphere[entry[now->begin].particle];
  dem_touch found[DEM_TOUCHES_MAX];
  now->n = wall->shape->touches(wall, &entry[now->begin].part, DEM_PART_STRIDE, (int)(now->end - now->begin),
                                dem_wall_own(place, s->position), s->radius + reach, found);
  size_t k = now->begin;
  for (int c = 0; c < now->n; c++) { /* both ascend */
    while (entry[k].part != found[c].part)
      k++;
    now->at[c] = k;
    now->gap[c] = found[c].gap;
    now->normal[c] = tdm_m3_mul(place->axes, found[c].normal);
  }
}

/* into the batch; what does not touch any more loses its history */
DEM_KERNEL void add_parts(dem_loop_task *task, batch *b, const touching_parts *now, const row r) {
  const dem_wall_contacts *list = &task->data->lists.walls;
  pass_histories(&task->model->wall[b->wall], list, now, r.ncolumn);
  int next = 0;
  for (size_t k = now->begin; k < now->end; k++) {
    if (next < now->n && now->at[next] == k)
      next++;
    else
      close_entry(list, k, r.ncolumn);
  }
  for (int c = 0; c < now->n; c++)
    add_to_batch(task, b, now->at[c], now->gap[c], now->normal[c], r);
}

/* ---- entries looked at together ---- */

enum { LOOK = 64, UNSEEN = -1, CLEAR_MAX = 4 }; /* entries; lane; contacts of a particle that are made out here */

typedef struct {
  size_t begin;
  int lane[LOOK];                       /* by entry, where it has the following; UNSEEN: it is apart */
  double at[LOOK];                      /* APART ... (triangles.h) */
  double height[LOOK], normal[3][LOOK]; /* inside: of the centre over the triangle [m]; towards it, world */
  double distance2[LOOK];               /* on an edge, at a corner: of the centre from that point [m2] */
} look;

/* what a look needs of its wall */
typedef struct {
  const dem_triangle *triangle;
  const dem_wall_place *place;
  double reach;   /* of forces, beyond the radii [m] */
  double way;     /* of the body since the list was made [m] */
  tdm_vec3 shift; /* of all, which is no way */
} look_task;

/* Entries that may touch, of begin ... end, as places from `begin` on: not those that were farther than both have moved
 * since the list was made. Their triangles are fetched. Returns how many they are. */
DEM_INLINE int choose_entries(const dem_data *d, const look_task *t, size_t begin, size_t end, int *chosen) {
  const dem_wall_entry *entry = d->lists.walls.entry;
  int n = 0, particle = -1;
  double way2 = 0, held = 0;
  for (size_t k = begin; k < end; k++) {
    if (entry[k].particle != particle) {
      particle = entry[k].particle;
      const dem_sphere *s = &d->state.sphere[particle];
      tdm_vec3 way = tdm_sub(tdm_sub(s->position, d->lists.position_at_list[particle]), t->shift);
      way2 = (1 + 1e-9) * tdm_dot(way, way);
      held = t->way + 1e-9 * s->radius; /* round-off must not hide a contact */
    }
    const double away = (double)entry[k].away - held;
    if (away > 0 && away * away > way2)
      continue;
    const char *line = (const char *)&t->triangle[entry[k].part];
    __builtin_prefetch(line), __builtin_prefetch(line + 64), __builtin_prefetch(line + 128);
    chosen[n++] = (int)(k - begin);
  }
  return n;
}

/* entries begin ... end, of whole particles, at most LOOK */
static __attribute__((noinline)) void look_at_entries(const dem_data *d, const look_task *t, size_t begin, size_t end,
                                                      look *out) {
  const dem_wall_entry *entry = d->lists.walls.entry + begin;
  const tdm_mat3 back = tdm_m3_transpose(t->place->axes);
  int chosen[LOOK + DEM_W];
  const int n = choose_entries(d, t, begin, end, chosen);
  out->begin = begin;
  for (size_t k = 0; k < end - begin; k++)
    out->lane[k] = UNSEEN;
  for (int c = 0; c < n; c++)
    out->lane[chosen[c]] = c;
  for (int l = 0; l < DEM_W && n > 0; l++) /* lanes that are left over */
    chosen[n + l] = chosen[n - 1];
  for (int to = 0; to < n; to += DEM_W) {
    int i[DEM_W], part[DEM_W];
    for (int l = 0; l < DEM_W; l++) {
      const int k = chosen[to + l];
      i[l] = entry[k].particle, part[l] = entry[k].part;
    }
    vd s[8];
    vd_spheres(d->state.sphere, i, s);
    vd3 own = vd3_turn(&back, vd3_sub((vd3){s[0], s[1], s[2]}, vd3_set(t->place->point)));
    const triangle_look seen = look_at_triangles(t->triangle, part, own, s[3] + vd_set(t->reach));
    vd_store(out->at + to, seen.at);
    vd_store(out->distance2 + to, seen.distance2);
    vd_store(out->height + to, seen.height);
    vd3 normal = vd3_pick(vm_less(seen.height, vd_set(0)), vd3_scale(vd_set(-1), seen.normal), seen.normal);
    normal = vd3_turn(&t->place->axes, normal);
    vd_store(out->normal[0] + to, normal.x), vd_store(out->normal[1] + to, normal.y);
    vd_store(out->normal[2] + to, normal.z);
  }
}

/* where the nearest point of an entry is */
DEM_INLINE int where(const look *seen, size_t k) {
  const int lane = seen->lane[k - seen->begin];
  return lane == UNSEEN ? APART : (int)seen->at[lane];
}

static tdm_vec3 own_normal(const dem_data *d, const dem_triangle *triangle, const look *seen, size_t k) {
  const tdm_vec3 n = triangle[d->lists.walls.entry[k].part].normal;
  return seen->height[seen->lane[k - seen->begin]] < 0 ? tdm_scale(-1, n) : n;
}

/* are no two contacts facets of one surface? */
static bool all_apart(const dem_data *d, const dem_triangles *of, const look *seen, const touching_parts *now) {
  for (int a = 0; a < now->n; a++)
    for (int b = 0; b < a; b++)
      if (!(tdm_dot(own_normal(d, of->triangle, seen, now->at[a]), own_normal(d, of->triangle, seen, now->at[b])) <
            of->facet_cos))
        return false;
  return true;
}

/* Has the triangle of contact c the corner of entry k, at which that one's nearest point is, and is it nearer? */
static bool corner_of_contact(const dem_data *d, const dem_triangle *triangle, const look *seen,
                              const touching_parts *now, int c, size_t k) {
  const dem_wall_entry *entry = d->lists.walls.entry;
  const tdm_vec3 corner = triangle[entry[k].part].corner[where(seen, k) - CORNER];
  bool has = false;
  for (int q = 0; q < 3; q++) {
    const tdm_vec3 *own = &triangle[entry[now->at[c]].part].corner[q];
    has = has || (own->x == corner.x && own->y == corner.y && own->z == corner.z);
  }
  return has && now->gap[c] * now->gap[c] < seen->distance2[seen->lane[k - seen->begin]];
}

/* Does entry k, whose nearest point is on an edge or at a corner, lead to one of the contacts, by ever nearer ones? */
static bool leads_to_contact(const dem_data *d, const dem_triangle *triangle, const look *seen,
                             const touching_parts *now, size_t k) {
  const dem_wall_entry *entry = d->lists.walls.entry;
  for (;;) {
    const int at = where(seen, k);
    const int beyond = at >= EDGE && at < CORNER ? triangle[entry[k].part].beyond[at - EDGE] : -1;
    for (int c = 0; c < now->n; c++)
      if (beyond == entry[now->at[c]].part || (at >= CORNER && corner_of_contact(d, triangle, seen, now, c, k)))
        return true;
    if (beyond < 0)
      return false;
    size_t next = now->begin;
    while (next < now->end && entry[next].part != beyond)
      next++;
    if (next == now->end || where(seen, next) == APART ||
        !(seen->distance2[seen->lane[next - seen->begin]] < seen->distance2[seen->lane[k - seen->begin]]))
      return false;
    k = next;
  }
}

/* Is it clear what the contacts of the particle with entries now->begin ... end are? */
static bool clear_contacts(const dem_data *d, const dem_triangles *of, const look *seen, touching_parts *now) {
  size_t other[LOOK];
  int nother = 0;
  now->n = 0;
  for (size_t k = now->begin; k < now->end; k++) {
    const int at = where(seen, k);
    if (at == APART)
      continue;
    if (at != INSIDE) {
      other[nother++] = k;
      continue;
    }
    if (now->n == CLEAR_MAX)
      return false;
    const int lane = seen->lane[k - seen->begin];
    now->at[now->n] = k;
    now->gap[now->n] = fabs(seen->height[lane]);
    now->normal[now->n++] = (tdm_vec3){seen->normal[0][lane], seen->normal[1][lane], seen->normal[2][lane]};
  }
  for (int o = 0; o < nother; o++)
    if (!leads_to_contact(d, of->triangle, seen, now, other[o]))
      return false;
  return now->n < 2 || all_apart(d, of, seen, now);
}

/* the entry after those of the particle of entry k */
DEM_INLINE size_t next_particle(const dem_wall_entry *entry, size_t k, size_t end) {
  size_t next = k + 1;
  while (next < end && entry[next].particle == entry[k].particle)
    next++;
  return next;
}

/* the end of as many whole particles' entries from `begin` on as are looked at together; begin: there are too many */
DEM_INLINE size_t end_of_look(const dem_wall_entry *entry, size_t begin, size_t end) {
  if (end - begin <= LOOK)
    return end;
  size_t at = begin + LOOK;
  while (at > begin && entry[at - 1].particle == entry[at].particle)
    at--;
  return at;
}

DEM_KERNEL void wall_with_parts(dem_loop_task *task, batch *b, size_t begin, size_t end, const row r) {
  const dem_data *d = task->data;
  const dem_wall *wall = &task->model->wall[b->wall];
  const dem_wall_place *place = &d->state.wall[b->wall];
  const dem_wall_entry *entry = d->lists.walls.entry;
  const dem_triangles *of = wall->shape->triangles ? wall->shape->triangles(wall) : NULL;
  const double reach = r.all_terms ? task->model->reach : 0;
  look_task task_of_look = {.place = place, .reach = reach};
  look seen;
  size_t looked = begin;
  if (of) {
    task_of_look.triangle = of->triangle;
    task_of_look.way = dem_lists_way_of_body(d, wall->body);
    task_of_look.shift = dem_lists_shift(d);
  }
  for (size_t k = begin, next; k < end; k = next) {
    if (of && k == looked) {
      looked = end_of_look(entry, k, end);
      look_at_entries(d, &task_of_look, k, looked, &seen);
    }
    next = next_particle(entry, k, end);
    const bool here = of && k < looked;
    looked = looked < next ? next : looked;
    if (left_out(task, &d->state.sphere[entry[k].particle], wall->body))
      continue;
    touching_parts now;
    now.begin = k, now.end = next;
    if (!here || !clear_contacts(d, of, &seen, &now))
      ask_shape(d, wall, place, reach, &now);
    add_parts(task, b, &now, r);
  }
}

#endif
