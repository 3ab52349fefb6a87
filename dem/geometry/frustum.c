/* Cylinders and cones, in the half-plane (rho, z) through the axis and the point: see frustum.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/frustum.h"

/* a point or a direction in the half-plane */
typedef struct {
  double rho, z;
} half;

typedef struct {
  double gap;
  half normal;
} half_gap;

/* The slanted side: from (r0, 0) along (dr, length) / slant. The outward normal is (length, -dr) / slant. */
typedef struct {
  double r0, dr, length, slant;
  half outward;
} slope;

static slope slope_of(const double radius[2], double length) {
  slope s = {.r0 = radius[0], .dr = radius[1] - radius[0], .length = length};
  /* exact for a cylinder */
  s.slant = s.dr == 0 ? length : sqrt(s.dr * s.dr + length * length);
  s.outward = (half){length / s.slant, -s.dr / s.slant};
  return s;
}

/* signed distance from the cone that the side is a part of: positive outside */
static double beyond(const slope *s, half p) {
  return (p.rho - s->r0) * s->outward.rho + p.z * s->outward.z;
}

static half_gap to_point(half p, half q) {
  half d = {p.rho - q.rho, p.z - q.z};
  double gap = sqrt(d.rho * d.rho + d.z * d.z);
  if (!(gap > 0))
    return (half_gap){0, {0, 0}};
  return (half_gap){gap, {d.rho / gap, d.z / gap}};
}

/* distance from the slanted side, rims included */
static half_gap to_side(const slope *s, half p) {
  double along = ((p.rho - s->r0) * s->dr + p.z * s->length) / s->slant;
  half_gap g;
  if (along <= 0 || along >= s->slant) {
    g = to_point(p, along <= 0 ? (half){s->r0, 0} : (half){s->r0 + s->dr, s->length});
    if (g.gap > 0)
      return g;
  }
  g.gap = beyond(s, p);
  g.normal = s->outward;
  if (g.gap < 0)
    g = (half_gap){-g.gap, {-s->outward.rho, -s->outward.z}};
  return g;
}

/* distance from a flat end, seen from its open side */
static half_gap to_end(double radius, double z, double up, half p) {
  if (p.rho <= radius && up * (p.z - z) >= 0)
    return (half_gap){up * (p.z - z), {0, up}};
  return to_point(p, (half){fmin(p.rho, radius), z});
}

static half to_half(tdm_vec3 x) {
  return (half){sqrt(x.x * x.x + x.y * x.y), x.z};
}

static tdm_vec3 from_half(half n, double rho, tdm_vec3 x) {
  return rho > 0 ? tdm_v3(n.rho * (x.x / rho), n.rho * (x.y / rho), n.z) : tdm_v3(n.rho, 0, n.z);
}

double dem_shell_gap(const double radius[2], double length, tdm_vec3 x, tdm_vec3 *normal) {
  slope s = slope_of(radius, length);
  half p = to_half(x);
  half_gap g = to_side(&s, p);
  *normal = from_half(g.normal, p.rho, x);
  return g.gap;
}

double dem_frustum_gap(const double radius[2], double length, tdm_vec3 x, tdm_vec3 *normal) {
  slope s = slope_of(radius, length);
  half p = to_half(x);
  half_gap g = {beyond(&s, p), s.outward};
  if (g.gap <= 0 && p.z >= 0 && p.z <= length) { /* inside: the least deep of three */
    if (-p.z > g.gap)
      g = (half_gap){-p.z, {0, -1}};
    if (p.z - length > g.gap)
      g = (half_gap){p.z - length, {0, 1}};
  } else {
    half_gap end[2] = {to_end(radius[0], 0, -1, p), to_end(radius[1], length, 1, p)};
    g = to_side(&s, p);
    for (int k = 0; k < 2; k++)
      if (end[k].gap < g.gap)
        g = end[k];
  }
  *normal = from_half(g.normal, p.rho, x);
  return g.gap;
}

double dem_cylinder_gap(double radius, int inside, tdm_vec3 x, tdm_vec3 *normal) {
  double rho = sqrt(x.x * x.x + x.y * x.y);
  *normal = from_half((half){inside ? -1 : 1, 0}, rho, x);
  return inside ? radius - rho : rho - radius;
}
