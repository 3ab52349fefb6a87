/* Finding the triangles near a point: a tree of boxes in body axes, split at the median. See mesh_tree.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/mesh/mesh_tree.h"

#include "dem/geometry/mesh/mesh_nearest.h"

#include <assert.h>
#include <stdlib.h>

enum { LEAF = 4, DEPTH_MAX = 64 }; /* triangles of a leaf; halving 2^31 triangles is 31 levels */

static const double slack = 1e-12; /* round-off must not hide a triangle at exactly the range */

static double component(tdm_vec3 v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static tdm_vec3 lower(tdm_vec3 a, tdm_vec3 b) {
  return tdm_v3(fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z));
}

static tdm_vec3 upper(tdm_vec3 a, tdm_vec3 b) {
  return tdm_v3(fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z));
}

/* ---- planting ---- */

typedef struct {
  dem_mesh *mesh;
  tdm_vec3 *center; /* (nface) three times the centroid */
  int nnode;
} planter;

static bool before(const planter *p, int axis, int a, int b) {
  double xa = component(p->center[a], axis), xb = component(p->center[b], axis);
  return xa != xb ? xa < xb : a < b;
}

/* Order the triangles so that the first `middle` of them lie before the others along the axis. */
static void split(const planter *p, int axis, int *order, int n, int middle) {
  int low = 0, high = n - 1;
  while (low < high) {
    int pivot = order[low + (high - low) / 2], i = low, j = high;
    while (i <= j) {
      while (before(p, axis, order[i], pivot))
        i++;
      while (before(p, axis, pivot, order[j]))
        j--;
      if (i > j)
        break;
      int swap = order[i];
      order[i++] = order[j];
      order[j--] = swap;
    }
    if (middle <= j)
      high = j;
    else if (middle >= i)
      low = i;
    else
      return;
  }
}

static void grow(planter *p, int first, int count) {
  dem_mesh *m = p->mesh;
  int *order = m->order + first, self = p->nnode++;
  dem_mesh_node node = {.low = dem_corner(m, order[0], 0), .first = first, .count = count};
  node.high = node.low;
  tdm_vec3 low = p->center[order[0]], high = low;
  for (int i = 0; i < count; i++) {
    for (int k = 0; k < 3; k++) {
      node.low = lower(node.low, dem_corner(m, order[i], k));
      node.high = upper(node.high, dem_corner(m, order[i], k));
    }
    low = lower(low, p->center[order[i]]);
    high = upper(high, p->center[order[i]]);
  }
  if (count > LEAF) {
    tdm_vec3 size = tdm_sub(high, low);
    int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    split(p, axis, order, count, count / 2);
    grow(p, first, count / 2);
    node.right = p->nnode;
    grow(p, first + count / 2, count - count / 2);
  }
  m->node[self] = node;
}

tdm_status dem_mesh_plant(dem_mesh *m) {
  planter p = {.mesh = m, .center = malloc((size_t)m->nface * sizeof *p.center)};
  if (!p.center)
    return TDM_ERR_MEMORY;
  for (int t = 0; t < m->nface; t++) {
    p.center[t] = tdm_add(tdm_add(dem_corner(m, t, 0), dem_corner(m, t, 1)), dem_corner(m, t, 2));
    m->order[t] = t;
  }
  grow(&p, 0, m->nface);
  free(p.center);
  return TDM_OK;
}

/* ---- asking ---- */

/* of x from low ... high; 0 where x is no number */
static double outside(double x, double low, double high) {
  double below = low - x, above = x - high, away = below > above ? below : above;
  return away > 0 ? away : 0;
}

/* square of the distance of x from a box */
static double box_distance2(const dem_mesh_node *node, tdm_vec3 x) {
  double dx = outside(x.x, node->low.x, node->high.x);
  double dy = outside(x.y, node->low.y, node->high.y);
  double dz = outside(x.z, node->low.z, node->high.z);
  return dx * dx + dy * dy + dz * dz;
}

static int by_number(const void *pa, const void *pb) {
  int a = *(const int *)pa, b = *(const int *)pb;
  return (a > b) - (a < b);
}

static void sort(int *number, int n) {
  if (n > 32)
    qsort(number, (size_t)n, sizeof *number, by_number);
  for (int i = 1; i < n && n <= 32; i++) {
    int moved = number[i], k = i;
    for (; k > 0 && number[k - 1] > moved; k--)
      number[k] = number[k - 1];
    number[k] = moved;
  }
}

static bool overlaps(const dem_mesh_node *node, tdm_vec3 low, tdm_vec3 high) {
  return node->low.x <= high.x && node->low.y <= high.y && node->low.z <= high.z && node->high.x >= low.x &&
         node->high.y >= low.y && node->high.z >= low.z;
}

/* does a leaf below node `from` overlap a box? */
static bool any_leaf(const dem_mesh *m, int from, tdm_vec3 low, tdm_vec3 high) {
  int stack[DEPTH_MAX], top = 0;
  stack[top++] = from;
  while (top > 0) {
    int self = stack[--top];
    const dem_mesh_node *node = &m->node[self];
    if (!overlaps(node, low, high))
      continue;
    if (!node->right)
      return true;
    assert(top + 2 <= DEPTH_MAX);
    stack[top++] = node->right;
    stack[top++] = self + 1;
  }
  return false;
}

int dem_mesh_within(const dem_mesh *m, tdm_vec3 low, tdm_vec3 high) {
  int node = 0;
  while (m->node[node].right) { /* down, as long as only one child has triangles there */
    bool left = overlaps(&m->node[node + 1], low, high), right = overlaps(&m->node[m->node[node].right], low, high);
    if (left && right)
      break;
    if (!left && !right)
      return -1;
    node = left ? node + 1 : m->node[node].right;
  }
  return any_leaf(m, node, low, high) ? node : -1;
}

int dem_mesh_near(const dem_mesh *m, int from, tdm_vec3 x, double range, int *out, int max) {
  int stack[DEPTH_MAX], top = 0, found = 0;
  double range2 = range * range;
  stack[top++] = from;
  while (top > 0) {
    int self = stack[--top];
    const dem_mesh_node *node = &m->node[self];
    if (!(box_distance2(node, x) <= range2 * (1 + slack)))
      continue;
    if (node->right) {
      assert(top + 2 <= DEPTH_MAX);
      stack[top++] = node->right;
      stack[top++] = self + 1;
      continue;
    }
    for (int i = 0; i < node->count; i++) {
      int t = m->order[node->first + i];
      if (!(dem_triangle_distance2(&m->triangle[t], x) < range2))
        continue;
      if (found < max)
        out[found] = t;
      found++;
    }
  }
  if (found <= max)
    sort(out, found);
  return found;
}

double dem_mesh_gap(const dem_mesh *m, tdm_vec3 x, tdm_vec3 *normal) {
  int stack[DEPTH_MAX], top = 0, best = -1;
  dem_nearest nearest = {.distance2 = INFINITY};
  stack[top++] = 0;
  while (top > 0) {
    int self = stack[--top];
    const dem_mesh_node *node = &m->node[self];
    if (box_distance2(node, x) > nearest.distance2 * (1 + slack))
      continue;
    if (node->right) {
      assert(top + 2 <= DEPTH_MAX);
      bool left = box_distance2(node + 1, x) <= box_distance2(&m->node[node->right], x);
      stack[top++] = left ? node->right : self + 1; /* the nearer child is on top */
      stack[top++] = left ? self + 1 : node->right;
      continue;
    }
    for (int i = 0; i < node->count; i++) {
      int t = m->order[node->first + i];
      dem_nearest now = dem_mesh_nearest(m, t, x);
      if (best < 0 || now.distance2 < nearest.distance2 || (now.distance2 == nearest.distance2 && t < best)) {
        nearest = now;
        best = t;
      }
    }
  }
  return dem_mesh_normal(m, best, &nearest, x, normal);
}
