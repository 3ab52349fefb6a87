/* From where a picture is taken: see camera.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/draw/camera.h"

static const double pi = 3.14159265358979323846;
static const double margin = 1.04;

static double component(tdm_vec3 v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

static tdm_vec3 unit(int axis) {
  return tdm_v3(axis == 0, axis == 1, axis == 2);
}

/* ---- bounds ---- */

tdm_bounds tdm_bounds_empty(void) {
  return (tdm_bounds){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

bool tdm_bounds_are_empty(const tdm_bounds *b) {
  return !(b->low.x <= b->high.x);
}

void tdm_bounds_add(tdm_bounds *b, tdm_vec3 p, double r) {
  if (!isfinite(p.x) || !isfinite(p.y) || !isfinite(p.z) || !isfinite(r))
    return;
  b->low = tdm_v3(fmin(b->low.x, p.x - r), fmin(b->low.y, p.y - r), fmin(b->low.z, p.z - r));
  b->high = tdm_v3(fmax(b->high.x, p.x + r), fmax(b->high.y, p.y + r), fmax(b->high.z, p.z + r));
}

/* Of a scene without anything, or whose things have no size: a cube of 1 m, or one that a point can be seen in. */
static tdm_bounds not_flat(const tdm_bounds *bounds) {
  tdm_bounds b = tdm_bounds_are_empty(bounds) ? (tdm_bounds){{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}} : *bounds;
  double size = tdm_norm(tdm_sub(b.high, b.low)), far = fmax(tdm_norm(b.high), tdm_norm(b.low));
  double least = fmax(1e-9 * far, 1e-12);
  if (size < least) {
    double half = far > 0 ? fmax(1e-6 * far, 1e-9) : 0.5;
    tdm_bounds_add(&b, b.low, half);
  }
  return b;
}

static tdm_vec3 middle(const tdm_bounds *b) {
  return tdm_scale(0.5, tdm_add(b->low, b->high));
}

static tdm_vec3 corner(const tdm_bounds *b, int k) {
  return tdm_v3(k & 1 ? b->high.x : b->low.x, k & 2 ? b->high.y : b->low.y, k & 4 ? b->high.z : b->low.z);
}

/* ---- axes ---- */

/* across the vertical: as near to x as can be, and the one behind it */
static void horizontal(tdm_vec3 up, tdm_vec3 *e1, tdm_vec3 *e2) {
  tdm_vec3 x = fabs(up.x) > 0.9 ? unit(1) : unit(0);
  *e1 = tdm_unit(tdm_axpy(-tdm_dot(x, up), up, x));
  *e2 = tdm_cross(up, *e1);
}

/* Looking along -back, with `up` up as far as that is possible. */
static void turn(tdm_camera *c, tdm_vec3 back, tdm_vec3 up) {
  c->back = tdm_unit(back);
  tdm_vec3 right = tdm_cross(up, c->back);
  if (!(tdm_norm(right) > 1e-6 * tdm_norm(up))) { /* straight up or down: what is behind is up in the picture */
    tdm_vec3 e1, e2;
    horizontal(c->back, &e1, &e2);
    right = e1;
  }
  c->right = tdm_unit(right);
  c->up = tdm_cross(c->back, c->right);
}

/* ---- views ---- */

void tdm_camera_limits(const tdm_view *v, const tdm_bounds *bounds, double low[2], double high[2]) {
  const int axis[2] = {v->across, v->up_axis};
  const tdm_bounds b = not_flat(bounds);
  double size = tdm_norm(tdm_sub(b.high, b.low));
  for (int k = 0; k < 2; k++) {
    double from = component(b.low, axis[k]), to = component(b.high, axis[k]);
    double more = fmax(0.02 * (to - from), 0.005 * size);
    low[k] = v->has_limits ? v->low[k] : from - more;
    high[k] = v->has_limits ? v->high[k] : to + more;
  }
}

static tdm_camera flat_camera(const tdm_view *v, const tdm_bounds *bounds, double aspect) {
  tdm_camera c = {.flat = true, .right = unit(v->across), .up = unit(v->up_axis)};
  const tdm_bounds b = not_flat(bounds);
  double low[2], high[2];
  tdm_camera_limits(v, bounds, low, high);
  c.back = tdm_cross(c.right, c.up);
  tdm_vec3 depth = tdm_scale(tdm_dot(middle(&b), c.back), c.back);
  c.at =
      tdm_add(depth, tdm_add(tdm_scale(0.5 * (low[0] + high[0]), c.right), tdm_scale(0.5 * (low[1] + high[1]), c.up)));
  c.half[1] = fmax(0.5 * (high[1] - low[1]), 0.5 * (high[0] - low[0]) / aspect);
  c.half[0] = c.half[1] * aspect;
  c.distance = 2 * tdm_norm(tdm_sub(b.high, b.low)) + c.half[1];
  return c;
}

/* How far the eye must be for all of the bounds to be in the picture; `shift`: how far their middle in it is away from
 * the picture's, at the distance of `at` [m]. */
static double distance_for(const tdm_camera *c, const tdm_bounds *b, double tangent, double aspect, double shift[2]) {
  double distance = 0, low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (int k = 0; k < 8; k++) {
    tdm_vec3 d = tdm_sub(corner(b, k), c->at);
    double near = tdm_dot(d, c->back), x = tdm_dot(d, c->right), y = tdm_dot(d, c->up);
    distance = fmax(distance, near + margin * fmax(fabs(x) / aspect, fabs(y)) / tangent);
  }
  for (int k = 0; k < 8; k++) {
    tdm_vec3 d = tdm_sub(corner(b, k), c->at);
    double scale = distance / (distance - tdm_dot(d, c->back));
    double x = scale * tdm_dot(d, c->right), y = scale * tdm_dot(d, c->up);
    low[0] = fmin(low[0], x);
    low[1] = fmin(low[1], y);
    high[0] = fmax(high[0], x);
    high[1] = fmax(high[1], y);
  }
  for (int k = 0; k < 2; k++)
    shift[k] = 0.5 * (low[k] + high[k]);
  return distance;
}

/* Back off until all is seen; unless the scene says at what to look, its middle comes into the picture's. */
static void fit(tdm_camera *c, const tdm_view *v, const tdm_bounds *b, double tangent, double aspect) {
  double shift[2];
  for (int k = 0; k < 4; k++) {
    c->distance = distance_for(c, b, tangent, aspect, shift);
    if (!v->has_at)
      c->at = tdm_axpy(shift[0], c->right, tdm_axpy(shift[1], c->up, c->at));
  }
  c->distance = distance_for(c, b, tangent, aspect, shift);
}

static tdm_camera space_camera(const tdm_view *v, const tdm_bounds *bounds, tdm_vec3 up, double aspect) {
  tdm_camera c = {.perspective = v->angle > 0};
  const tdm_bounds b = not_flat(bounds);
  tdm_vec3 e1, e2;
  if (!(tdm_norm(up) > 0))
    up = unit(2);
  up = v->has_up ? tdm_unit(v->up) : tdm_unit(up);
  horizontal(up, &e1, &e2);
  tdm_vec3 obliquely = tdm_add(tdm_scale(0.42, up), tdm_axpy(0.45, e1, tdm_scale(-0.79, e2)));
  c.at = v->has_at ? v->at : middle(&b);
  tdm_vec3 back = v->has_from ? tdm_sub(v->from, c.at) : obliquely;
  bool far = tdm_norm(back) > 1e-9 * fmax(tdm_norm(c.at), tdm_norm(v->from));
  turn(&c, far ? back : obliquely, up); /* from where the middle of all is: there is no direction in that */
  double tangent = c.perspective ? tan(0.5 * v->angle * pi / 180) : 0.1;
  if (v->has_from && far)
    c.distance = tdm_norm(back);
  else
    fit(&c, v, &b, tangent, aspect);
  if (!c.perspective) /* far enough for all of it to be in front of the eye */
    c.distance = tdm_norm(tdm_sub(b.high, b.low)) + tdm_norm(tdm_sub(c.at, middle(&b)));
  c.half[1] = c.perspective ? c.distance * tangent : 0.5 * v->height;
  c.half[0] = c.half[1] * aspect;
  return c;
}

tdm_camera tdm_camera_make(const tdm_view *v, const tdm_bounds *bounds, tdm_vec3 up, double aspect) {
  return v->flat ? flat_camera(v, bounds, aspect) : space_camera(v, bounds, up, aspect);
}

/* ---- points ---- */

tdm_vec3 tdm_camera_see(const tdm_camera *c, tdm_vec3 p) {
  tdm_vec3 d = tdm_sub(p, c->at);
  return tdm_v3(tdm_dot(d, c->right), tdm_dot(d, c->up), tdm_dot(d, c->back) - c->distance);
}

void tdm_camera_project(const tdm_camera *c, tdm_vec3 seen, double out[2]) {
  double scale = c->perspective ? c->distance / -seen.z : 1;
  out[0] = scale * seen.x / c->half[0];
  out[1] = scale * seen.y / c->half[1];
}
