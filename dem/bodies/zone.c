/* Places of sinks: see zone.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/bodies/zone.h"

#include <math.h>

/* The point of a sector at radius r, angle a, height h, in the sink's frame. */
static tdm_vec3 sector_point(const dem_sink *s, double r, double a, double h) {
  const tdm_vec3 along = tdm_cross(s->normal, s->across);
  return tdm_axpy(r * cos(a), s->across, tdm_axpy(r * sin(a), along, tdm_axpy(h, s->normal, s->point)));
}

/* A sphere around a sector, about the middle of its chord; of more than half a turn about its axis. */
static void sector_sphere(const dem_sink *s, tdm_vec3 *middle, double *radius) {
  const double half = 0.5 * (s->angle[1] - s->angle[0]), towards = 0.5 * (s->angle[0] + s->angle[1]);
  const double h = 0.5 * (s->height[0] + s->height[1]);
  const bool wide = half > 0.5 * M_PI;
  *middle = sector_point(s, wide ? 0 : s->radius[1] * cos(half), towards, h);
  *radius = 0;
  const double angle[3] = {s->angle[0], towards, s->angle[1]};
  for (int k = 0; k < 3; k++)
    for (int end = 0; end < 2; end++) {
      const tdm_vec3 x = sector_point(s, s->radius[end], angle[k], s->height[1]);
      *radius = fmax(*radius, tdm_norm(tdm_sub(x, *middle)));
    }
  *radius *= 1 + 1e-12; /* round-off */
}

dem_zone dem_zone_now(const dem_data *d, int k) {
  const dem_sink *s = &d->model->sink[k];
  const bool moves = s->frame >= 0;
  const tdm_pose pose = moves ? d->state.pose[s->frame] : (tdm_pose){{0, 0, 0}, tdm_quat_identity()};
  dem_zone z = {.sink = s, .origin = pose.position, .axes = tdm_quat_to_matrix(pose.orientation), .radius2 = INFINITY};
  double radius;
  if (s->type == DEM_SINK_PLANE || s->type == DEM_SINK_AFTER_CONTACT)
    return z;
  if (s->type == DEM_SINK_SECTOR) {
    sector_sphere(s, &z.middle, &radius);
  } else {
    z.middle = tdm_scale(0.5, tdm_add(s->low, s->high));
    radius = 0.5 * tdm_norm(tdm_sub(s->high, s->low)) * (1 + 1e-12);
  }
  z.middle = tdm_add(z.origin, tdm_m3_mul(z.axes, z.middle));
  z.radius2 = radius * radius;
  return z;
}

static bool between(double x, const double range[2]) {
  return x >= range[0] && x <= range[1];
}

static bool in_sector(const dem_sink *s, tdm_vec3 x) {
  const tdm_vec3 r = tdm_sub(x, s->point);
  const double h = tdm_dot(r, s->normal);
  const double a = tdm_dot(r, s->across), b = tdm_dot(r, tdm_cross(s->normal, s->across));
  if (!between(h, s->height) || !between(sqrt(a * a + b * b), s->radius))
    return false;
  double angle = atan2(b, a);
  while (angle < s->angle[0])
    angle += 2 * M_PI;
  return angle <= s->angle[1];
}

bool dem_zone_inside(const dem_zone *z, tdm_vec3 x) {
  const dem_sink *s = z->sink;
  if (s->type == DEM_SINK_AFTER_CONTACT || !dem_zone_near(z, x))
    return false;
  if (s->frame >= 0)
    x = tdm_m3_tmul(z->axes, tdm_sub(x, z->origin));
  if (s->type == DEM_SINK_PLANE)
    return tdm_dot(tdm_sub(x, s->point), s->normal) < 0;
  if (s->type == DEM_SINK_SECTOR)
    return in_sector(s, x);
  return x.x >= s->low.x && x.x <= s->high.x && x.y >= s->low.y && x.y <= s->high.y && x.z >= s->low.z &&
         x.z <= s->high.z;
}

double dem_zone_lowest(const dem_zone *z, tdm_vec3 up) {
  const double level = 1e-9; /* of a normal's part along `up`: a plane that stands upright catches nothing */
  const dem_sink *s = z->sink;
  if (s->type == DEM_SINK_PLANE)
    return tdm_dot(tdm_m3_mul(z->axes, s->normal), up) > level ? -INFINITY : INFINITY;
  if (s->type == DEM_SINK_SECTOR)
    return tdm_dot(up, z->middle) - sqrt(z->radius2);
  double least = INFINITY;
  for (int corner = 0; corner < 8 && s->type == DEM_SINK_BOX; corner++) {
    const tdm_vec3 x =
        tdm_v3(corner & 1 ? s->low.x : s->high.x, corner & 2 ? s->low.y : s->high.y, corner & 4 ? s->low.z : s->high.z);
    least = fmin(least, tdm_dot(up, s->frame < 0 ? x : tdm_add(z->origin, tdm_m3_mul(z->axes, x))));
  }
  return least;
}
