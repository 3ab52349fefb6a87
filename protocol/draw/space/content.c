/* From what there is to see to what is drawn: see content.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/draw/space/content.h"

#include "protocol/draw/color.h"

#include <stdlib.h>
#include <string.h>

static const tdm_rgb wall_color = {176, 184, 194};
/* bodies that move: warm, as the particles' map has no such colours; neighbours differ a little */
static const tdm_rgb body_color[] = {{214, 120, 64}, {226, 158, 92}, {186, 92, 72}, {200, 140, 120}};
static const tdm_rgb edge_color = {52, 60, 70};
static const tdm_rgb line_color[] = {[TDM_VIEW_LINE_joint] = {178, 34, 52},
                                     [TDM_VIEW_LINE_spring] = {46, 125, 50},
                                     [TDM_VIEW_LINE_cable] = {40, 40, 44},
                                     [TDM_VIEW_LINE_cylinder] = {25, 90, 170},
                                     [TDM_VIEW_LINE_bar] = {200, 120, 60}};
static const tdm_rgb mark_color = {30, 34, 40};
enum { GLASS = 44, GLASS_EDGE = 120, OPAQUE = 255 };            /* opacities */
static const double line_half = 2.0, dot_half = 4.5, cross = 9; /* lines, dots and marks [pixels] */

tdm_vec3 tdm_scene_up(const tdm_scenery *s) {
  double g = tdm_norm(s->gravity);
  return g > 0 && isfinite(g) ? tdm_scale(-1 / g, s->gravity) : tdm_v3(0, 0, 1);
}

/* ---- what is shown ---- */

/* How a polygon is drawn in this picture. */
static tdm_surface_look look_of(const tdm_picture *p, const tdm_scenery *s, const tdm_view_polygon *polygon) {
  const tdm_view_body *body = &s->body[polygon->body];
  tdm_surface_look look = body->still ? p->walls : p->bodies;
  if (look != TDM_SURFACE_auto || p->view.flat)
    return look;
  return body->still || !polygon->solid ? TDM_SURFACE_translucent : TDM_SURFACE_solid;
}

static bool is_finite(tdm_vec3 v) {
  return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

/* what stands and has no surface is of no interest */
static bool has_mark(const tdm_view_body *body) {
  return body->marked && !body->still;
}

static bool whole(const tdm_view_polygon *polygon, tdm_pose pose) {
  for (int c = 0; c < polygon->ncorner; c++)
    if (!is_finite(tdm_pose_point(pose, polygon->corner[c])))
      return false;
  return polygon->ncorner > 1;
}

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* From where to where 99 in 100 of the numbers lie, or all of them if those are not much farther. Sorts them. */
static void trimmed(double *value, int n, double *low, double *high) {
  int cut = n / 200;
  qsort(value, (size_t)n, sizeof *value, ascending);
  *low = value[cut];
  *high = value[n - 1 - cut];
  double slack = 0.25 * (*high - *low);
  *low = value[0] < *low - slack ? *low : value[0];
  *high = value[n - 1] > *high + slack ? *high : value[n - 1];
}

/* Particles that have left, each on its way, must not make the picture of all others small. */
static tdm_status particle_bounds(tdm_bounds *b, const tdm_snapshot *s, tdm_error *err) {
  double *value = malloc(((size_t)s->nparticle + 1) * sizeof *value), low[3], high[3], radius = 0;
  int n = 0;
  if (!value)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a picture of %d particles", s->nparticle);
  for (int axis = 0; axis < 3; axis++) {
    n = 0;
    for (int i = 0; i < s->nparticle; i++) {
      if (!is_finite(s->position[i]) || !isfinite(s->radius[i]))
        continue;
      value[n++] = axis == 0 ? s->position[i].x : axis == 1 ? s->position[i].y : s->position[i].z;
      radius = fmax(radius, s->radius[i]);
    }
    if (n > 0)
      trimmed(value, n, &low[axis], &high[axis]);
  }
  if (n > 0) {
    tdm_bounds_add(b, tdm_v3(low[0], low[1], low[2]), radius);
    tdm_bounds_add(b, tdm_v3(high[0], high[1], high[2]), radius);
  }
  free(value);
  return TDM_OK;
}

tdm_status tdm_content_bounds(tdm_bounds *b, const tdm_picture *p, const tdm_scenery *scenery, const tdm_snapshot *s,
                              bool particles, tdm_error *err) {
  if (particles && particle_bounds(b, s, err) != TDM_OK)
    return err->status;
  for (int k = 0; k < scenery->npolygon; k++) {
    const tdm_view_polygon *polygon = &scenery->polygon[k];
    if (look_of(p, scenery, polygon) == TDM_SURFACE_hidden)
      continue;
    for (int c = 0; c < polygon->ncorner; c++)
      tdm_bounds_add(b, tdm_pose_point(s->pose[polygon->body], polygon->corner[c]), 0);
  }
  for (int i = 0; p->mechanism && i < s->npoint; i++)
    tdm_bounds_add(b, s->point[i], 0);
  for (int k = 0; p->mechanism && k < scenery->nbody; k++)
    if (has_mark(&scenery->body[k]))
      tdm_bounds_add(b, s->pose[k].position, 0);
  return TDM_OK;
}

/* ---- points ---- */

static void put(float out[3], tdm_vec3 v) {
  out[0] = (float)v.x;
  out[1] = (float)v.y;
  out[2] = (float)v.z;
}

/* a direction in the camera's axes */
static tdm_vec3 turn(const tdm_camera *c, tdm_vec3 v) {
  return tdm_v3(tdm_dot(v, c->right), tdm_dot(v, c->up), tdm_dot(v, c->back));
}

static tdm_vec3 seen(const tdm_content *c, double unit, tdm_vec3 world) {
  return tdm_scale(1 / unit, tdm_camera_see(c->camera, world));
}

static void paint(uint8_t out[4], tdm_rgb color, int opacity) {
  out[0] = color.r;
  out[1] = color.g;
  out[2] = color.b;
  out[3] = (uint8_t)opacity;
}

/* So many pixels as a length at a point, in the drawing's unit. */
static double pixels(const tdm_content *c, double unit, tdm_vec3 at, double n) {
  double scale = c->camera->perspective ? fmax(0, -at.z) * unit / c->camera->distance : 1;
  return n * 2 * c->camera->half[1] / c->height / unit * scale;
}

/* ---- surfaces ---- */

/* Numbers of bodies that move, so that neighbours of a mechanism differ. */
static tdm_rgb color_of_body(const tdm_scenery *s, int body) {
  int n = 0;
  if (s->body[body].still)
    return wall_color;
  for (int k = 0; k < body; k++)
    n += !s->body[k].still;
  return body_color[n % (int)(sizeof body_color / sizeof body_color[0])];
}

/* A polygon in the world, with the normals of its corners and the widths at its edges (surface.h). */
typedef struct {
  int n;
  tdm_vec3 at[TDM_VIEW_CORNERS_MAX + 1], normal[TDM_VIEW_CORNERS_MAX + 1];
  float edge[TDM_VIEW_CORNERS_MAX + 1];
} outline;

static outline outline_of(const tdm_content *c, int k) {
  const tdm_view_polygon *polygon = &c->scenery->polygon[k];
  const tdm_pose pose = c->snapshot->pose[polygon->body];
  const int first = c->surface->first[k];
  outline o = {.n = polygon->ncorner};
  for (int i = 0; i < o.n; i++) {
    o.at[i] = tdm_pose_point(pose, polygon->corner[i]);
    o.normal[i] = tdm_quat_rotate(pose.orientation, c->surface->round[first + i]);
    o.edge[i] = c->surface->edge[first + i];
  }
  return o;
}

/* How far a point is in front of the plane in which the picture is cut [m]: what is in front is left out. */
static double in_front(const tdm_picture *p, tdm_vec3 x) {
  return p->cut ? tdm_dot(tdm_sub(x, p->cut_point), p->cut_normal) : -1;
}

static void add_corner(outline *o, tdm_vec3 at, tdm_vec3 normal, float edge) {
  o->at[o->n] = at;
  o->normal[o->n] = normal;
  o->edge[o->n++] = edge;
}

/* What of a convex outline is not cut off (Sutherland and Hodgman 1974). */
static outline cut(const tdm_picture *p, const outline *o) {
  outline left = {.n = 0};
  for (int i = 0; i < o->n && left.n < TDM_VIEW_CORNERS_MAX; i++) {
    const int j = (i + 1) % o->n;
    const double a = in_front(p, o->at[i]), b = in_front(p, o->at[j]), s = a / (a - b);
    if (a <= 0)
      add_corner(&left, o->at[i], o->normal[i], o->edge[i]);
    if ((a <= 0) != (b <= 0))
      add_corner(&left, tdm_axpy(s, tdm_sub(o->at[j], o->at[i]), o->at[i]),
                 tdm_unit(tdm_axpy(s, tdm_sub(o->normal[j], o->normal[i]), o->normal[i])), a <= 0 ? 0 : o->edge[i]);
  }
  return left;
}

static const double narrow = 5; /* polygons of so many pixels or less have paler edges, or a fine net would be black */

static tdm_status add_edges(tdm_vertices *list, const tdm_content *c, double unit, const tdm_vertex *corner,
                            const outline *o, int opacity, tdm_error *err) {
  for (int k = 0; k < o->n; k++) {
    tdm_vertex ends[2] = {corner[k], corner[(k + 1) % o->n]};
    const tdm_vec3 at = {corner[k].position[0], corner[k].position[1], corner[k].position[2]};
    const double pale = fmin(1, (double)o->edge[k] / unit / pixels(c, unit, at, narrow));
    if (!(opacity * pale >= 1))
      continue;
    for (int e = 0; e < 2; e++) {
      memset(ends[e].normal, 0, sizeof ends[e].normal);
      paint(ends[e].color, edge_color, (int)(opacity * pale));
    }
    if (tdm_vertices_add(list, ends, 2, err) != TDM_OK)
      return err->status;
  }
  return TDM_OK;
}

/* In a flat view, a surface that is not a body's would hide what is behind it when seen from the front: its edges are
 * enough. */
static bool only_edges(const tdm_content *c, tdm_surface_look look, const tdm_view_polygon *polygon, tdm_vec3 normal) {
  return c->camera->flat && look == TDM_SURFACE_auto && !polygon->solid && fabs(tdm_dot(normal, c->camera->back)) > 0.1;
}

static tdm_status add_polygon(tdm_drawing *d, const tdm_content *c, int k, tdm_rgb color, tdm_error *err) {
  const tdm_view_polygon *polygon = &c->scenery->polygon[k];
  const tdm_pose pose = c->snapshot->pose[polygon->body];
  tdm_surface_look look = look_of(c->picture, c->scenery, polygon);
  tdm_vertex corner[TDM_VIEW_CORNERS_MAX + 1];
  if (look == TDM_SURFACE_hidden || !whole(polygon, pose))
    return TDM_OK;
  bool glass = look == TDM_SURFACE_translucent, plain = c->camera->flat && look == TDM_SURFACE_auto;
  outline o = outline_of(c, k);
  if (c->picture->cut && c->scenery->body[polygon->body].dem) /* others are solids, which would be seen to be hollow */
    o = cut(c->picture, &o);
  for (int i = 0; i < o.n; i++) {
    put(corner[i].position, seen(c, d->unit, o.at[i]));
    put(corner[i].normal, plain ? tdm_v3(0, 0, 0) : turn(c->camera, o.normal[i]));
    paint(corner[i].color, color, glass ? GLASS : OPAQUE);
  }
  tdm_vec3 normal = tdm_quat_rotate(pose.orientation, c->surface->flat[k]);
  for (int i = 2; i < o.n && !only_edges(c, look, polygon, normal); i++) {
    const tdm_vertex triangle[3] = {corner[0], corner[i - 1], corner[i]};
    if (tdm_vertices_add(glass ? &d->glass : &d->solid, triangle, 3, err) != TDM_OK)
      return err->status;
  }
  return add_edges(glass ? &d->glass_edges : &d->edges, c, d->unit, corner, &o, glass ? GLASS_EDGE : OPAQUE, err);
}

static tdm_status add_surfaces(tdm_drawing *d, const tdm_content *c, tdm_error *err) {
  int body = -1;
  tdm_rgb color = wall_color;
  for (int k = 0; k < c->scenery->npolygon && err->status == TDM_OK; k++) {
    if (c->scenery->polygon[k].body != body) {
      body = c->scenery->polygon[k].body;
      color = color_of_body(c->scenery, body);
      if (c->camera->flat && c->scenery->body[body].still)
        color = (tdm_rgb){200, 205, 211};
    }
    add_polygon(d, c, k, color, err);
  }
  return err->status;
}

/* ---- particles ---- */

/* of particle or contact i */
static tdm_rgb color_of(const tdm_content *c, int i) {
  double value = tdm_color_value(c->picture->color, c->snapshot, i, c->camera, c->up);
  if (tdm_color_has_kinds(c->picture->color))
    return tdm_color_of_kind((int)value);
  double span = c->range[1] - c->range[0];
  return tdm_color_map(span > 0 ? (value - c->range[0]) / span : 0.5);
}

static tdm_status add_particles(tdm_drawing *d, const tdm_content *c, tdm_error *err) {
  const tdm_snapshot *s = c->snapshot;
  for (int i = 0; i < s->nparticle && err->status == TDM_OK; i++) {
    tdm_ball ball;
    if (!is_finite(s->position[i]) || !(s->radius[i] > 0) || !isfinite(s->radius[i]) ||
        in_front(c->picture, s->position[i]) > 0)
      continue;
    put(ball.center, seen(c, d->unit, s->position[i]));
    ball.radius = (float)(s->radius[i] / d->unit);
    paint(ball.color, color_of(c, i), OPAQUE);
    tdm_balls_add(&d->balls, &ball, err);
  }
  return err->status;
}

/* ---- lines ---- */

enum { SIDES = 10 };

/* A tube between two points that are given as seen. */
static tdm_status add_tube(tdm_vertices *list, const tdm_vec3 end[2], const double radius[2], tdm_rgb color,
                           tdm_error *err) {
  tdm_vec3 along = tdm_unit(tdm_sub(end[1], end[0]));
  tdm_vec3 u = tdm_unit(tdm_cross(along, fabs(along.x) < 0.7 ? tdm_v3(1, 0, 0) : tdm_v3(0, 1, 0)));
  tdm_vec3 v = tdm_cross(along, u);
  tdm_vertex ring[2][SIDES];
  for (int e = 0; e < 2; e++)
    for (int k = 0; k < SIDES; k++) {
      double angle = 2 * 3.14159265358979 * k / SIDES;
      tdm_vec3 n = tdm_add(tdm_scale(cos(angle), u), tdm_scale(sin(angle), v));
      put(ring[e][k].position, tdm_axpy(radius[e], n, end[e]));
      put(ring[e][k].normal, n);
      paint(ring[e][k].color, color, OPAQUE);
    }
  for (int k = 0; k < SIDES && err->status == TDM_OK; k++) {
    int l = (k + 1) % SIDES;
    const tdm_vertex sides[6] = {ring[0][k], ring[1][k], ring[1][l], ring[0][k], ring[1][l], ring[0][l]};
    tdm_vertices_add(list, sides, 6, err);
  }
  return err->status;
}

static tdm_status add_dot(tdm_drawing *d, tdm_vec3 at, double radius, tdm_rgb color, tdm_error *err) {
  tdm_ball ball;
  put(ball.center, at);
  ball.radius = (float)radius;
  paint(ball.color, color, OPAQUE);
  return tdm_balls_add(&d->dots, &ball, err);
}

/* Contacts as tubes, as thick as their normal force is large. */
static tdm_status add_contacts(tdm_drawing *d, const tdm_content *c, tdm_error *err) {
  const tdm_snapshot *s = c->snapshot;
  const double thick = 0.3, thin = 0.02; /* radius of the tubes, in mean radii of the particles */
  double mean = 0;
  for (int i = 0; i < s->nparticle; i++)
    mean += s->radius[i] / s->nparticle;
  for (int k = 0; k < s->ncontact && err->status == TDM_OK; k++) {
    const tdm_view_contact *contact = &s->contact[k];
    if (!is_finite(contact->from) || !is_finite(contact->to) || in_front(c->picture, contact->from) > 0)
      continue;
    const tdm_vec3 end[2] = {seen(c, d->unit, contact->from), seen(c, d->unit, contact->to)};
    const double share = c->range[1] > 0 ? fmin(1, fabs(contact->force) / c->range[1]) : 0;
    const double radius = mean / d->unit * fmax(thin, thick * share);
    if (tdm_norm(tdm_sub(end[1], end[0])) > 0)
      add_tube(&d->solid, end, (const double[]){radius, radius}, color_of(c, k), err);
  }
  return err->status;
}

/* A line through points; joints have dots at their ends. */
static tdm_status add_line(tdm_drawing *d, const tdm_content *c, int k, tdm_error *err) {
  const tdm_snapshot *s = c->snapshot;
  tdm_view_line_kind kind = c->scenery->line[k].kind;
  int begin = k ? s->line_end[k - 1] : 0, end = s->line_end[k];
  tdm_vec3 before = {0, 0, 0};
  double before_radius = 0;
  for (int i = begin; i < end && err->status == TDM_OK; i++) {
    if (!is_finite(s->point[i]))
      return TDM_OK;
    tdm_vec3 at = seen(c, d->unit, s->point[i]);
    double radius = pixels(c, d->unit, at, kind == TDM_VIEW_LINE_cylinder ? 2 * line_half : line_half);
    if (i > begin && tdm_norm(tdm_sub(at, before)) > 0) {
      const tdm_vec3 ends[2] = {before, at};
      const double radii[2] = {before_radius, radius};
      add_tube(&d->lines, ends, radii, line_color[kind], err);
    }
    bool joint = kind == TDM_VIEW_LINE_joint && (i == begin || i == end - 1);
    add_dot(d, at, joint ? pixels(c, d->unit, at, dot_half) : radius, line_color[kind], err);
    before = at;
    before_radius = radius;
  }
  return err->status;
}

/* A centre of mass without a surface: a ball and the body's own axes, so that it is seen how it turns. */
static tdm_status add_mark(tdm_drawing *d, const tdm_content *c, int body, tdm_error *err) {
  const tdm_pose pose = c->snapshot->pose[body];
  if (!is_finite(pose.position))
    return TDM_OK;
  tdm_vec3 at = seen(c, d->unit, pose.position);
  double arm = pixels(c, d->unit, at, cross);
  const double radii[2] = {0.12 * arm, 0.12 * arm};
  for (int axis = 0; axis < 3 && err->status == TDM_OK; axis++) {
    tdm_vec3 e = tdm_quat_rotate(pose.orientation, tdm_v3(axis == 0, axis == 1, axis == 2));
    tdm_vec3 reach = tdm_scale(arm, turn(c->camera, e));
    const tdm_vec3 ends[2] = {tdm_sub(at, reach), tdm_add(at, reach)};
    if (is_finite(reach))
      add_tube(&d->lines, ends, radii, mark_color, err);
  }
  return add_dot(d, at, 0.4 * arm, mark_color, err);
}

static tdm_status add_mechanism(tdm_drawing *d, const tdm_content *c, tdm_error *err) {
  for (int k = 0; k < c->scenery->nline && err->status == TDM_OK; k++)
    add_line(d, c, k, err);
  for (int k = 0; k < c->scenery->nbody && err->status == TDM_OK; k++)
    if (has_mark(&c->scenery->body[k]))
      add_mark(d, c, k, err);
  return err->status;
}

/* ---- all ---- */

tdm_status tdm_content_make(tdm_drawing *d, const tdm_content *c, tdm_error *err) {
  tdm_drawing_clear(d);
  d->unit = c->camera->half[1];
  d->behind = c->camera->flat && c->picture->walls == TDM_SURFACE_auto && c->picture->bodies == TDM_SURFACE_auto;
  if (add_surfaces(d, c, err) != TDM_OK)
    return err->status;
  if ((tdm_color_of_contacts(c->picture->color) ? add_contacts : add_particles)(d, c, err) != TDM_OK)
    return err->status;
  return c->picture->mechanism ? add_mechanism(d, c, err) : TDM_OK;
}
