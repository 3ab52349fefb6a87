/* Pictures, pixel by pixel: places and sizes, what hides what, and what there is nothing to see of. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/draw/color.h"
#include "protocol/draw/program/painter.h"
#include "tests/test_main.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

/* ---- scenes ---- */

typedef struct {
  tdm_scenery scenery;
  tdm_snapshot snapshot;
  tdm_picture picture;
  tdm_frame frame;
} scene;

/* Balls in front of one wall, each with a place and a radius. */
typedef struct {
  tdm_vec3 at;
  double radius;
} ball;

static scene scene_of(int nball, const ball *balls, int nwall, const tdm_vec3 *corner) {
  scene s = {.frame = {.bounds = {{-1, -1, -1}, {1, 1, 1}}, .range = {0, 1}}};
  tdm_view_body wall = {.name = "wall", .still = true, .dem = true};
  ck_assert_int_eq(tdm_scenery_add_body(&s.scenery, &wall, NULL), TDM_OK);
  for (int k = 0; k < nwall; k++) {
    tdm_view_polygon polygon = {.body = 0, .solid = true, .ncorner = 4};
    memcpy(polygon.corner, corner + 4 * k, 4 * sizeof *corner);
    ck_assert_int_eq(tdm_scenery_add_polygon(&s.scenery, &polygon, NULL), TDM_OK);
  }
  ck_assert_int_eq(tdm_snapshot_resize(&s.snapshot, 1, 0, 0, nball, NULL), TDM_OK);
  s.snapshot.time = 0.5;
  s.snapshot.pose[0] = (tdm_pose){{0, 0, 0}, {1, 0, 0, 0}};
  for (int i = 0; i < nball; i++) {
    s.snapshot.id[i] = i;
    s.snapshot.material[i] = s.snapshot.size_class[i] = 0;
    s.snapshot.radius[i] = balls[i].radius;
    s.snapshot.position[i] = s.snapshot.born[i] = balls[i].at;
    s.snapshot.velocity[i] = s.snapshot.spin[i] = s.snapshot.force[i] = (tdm_vec3){0, 0, 0};
  }
  s.picture = (tdm_picture){.view = {.flat = true, .across = 0, .up_axis = 2, .has_limits = true, .high = {1, 1}},
                            .mechanism = true,
                            .size = {600, 500}};
  return s;
}

static void in_space(scene *s, tdm_vec3 from, double angle, double height) {
  s->picture.view = (tdm_view){.has_from = true, .has_at = true, .from = from, .angle = angle, .height = height};
}

static void scene_free(scene *s) {
  tdm_scenery_free(&s->scenery);
  tdm_snapshot_free(&s->snapshot);
}

static tdm_painter painter;

/* The picture without what is written on it: (width x height). */
typedef struct {
  int width, height, left, top;
  uint8_t *pixel; /* blue, green, red, unused */
  cairo_surface_t *sheet;
  int stride;
} picture;

static picture paint(const scene *s) {
  tdm_error err = {0};
  picture p = {0};
  const int own[2] = {0, 0};
  ck_assert_msg(tdm_painter_scenery(&painter, &s->scenery, &err) == TDM_OK, "%s", err.message);
  ck_assert_msg(tdm_paint(&painter, &s->picture, &s->scenery, &s->snapshot, &s->frame, own, &p.sheet, &err) == TDM_OK,
                "%s", err.message);
  const tdm_layout l = tdm_layout_make(&s->picture, s->picture.size, s->picture.view.low, s->picture.view.high);
  p.width = l.image[0];
  p.height = l.image[1];
  p.left = l.x;
  p.top = l.y;
  p.pixel = cairo_image_surface_get_data(p.sheet);
  p.stride = cairo_image_surface_get_stride(p.sheet);
  return p;
}

static const uint8_t *at(const picture *p, int x, int y) {
  return p->pixel + (p->top + y) * p->stride + 4 * (p->left + x);
}

/* How much two pictures differ in a pixel: the largest of the three colours' differences. */
static int difference(const picture *a, const picture *b, int x, int y) {
  int largest = 0;
  for (int k = 0; k < 3; k++) {
    int d = abs(at(a, x, y)[k] - at(b, x, y)[k]);
    largest = d > largest ? d : largest;
  }
  return largest;
}

/* Where and how widely two pictures differ by more than `least`. */
typedef struct {
  double area, x, y; /* pixels; their middle */
} spot;

static spot compare(const picture *a, const picture *b, int least) {
  spot s = {0};
  ck_assert_int_eq(a->width, b->width);
  ck_assert_int_eq(a->height, b->height);
  for (int y = 0; y < a->height; y++)
    for (int x = 0; x < a->width; x++)
      if (difference(a, b, x, y) > least) {
        s.area++;
        s.x += x + 0.5;
        s.y += y + 0.5;
      }
  s.x /= fmax(1, s.area);
  s.y /= fmax(1, s.area);
  return s;
}

/* What the balls cover: the picture against the same without them, where they differ by more than `least`. */
static spot covered_by(const scene *s, int least) {
  scene empty = *s;
  empty.snapshot.nparticle = 0;
  picture with = paint(s), without = paint(&empty);
  /* the colour bar, which stands in pictures in space, is no ball */
  for (int y = 0; y < with.height; y++)
    for (int x = 0; x < with.width && !s->picture.view.flat; x++)
      if (x > with.width - 130 && y < with.height / 2 + 80)
        memcpy((uint8_t *)at(&with, x, y), at(&without, x, y), 4);
  spot result = compare(&with, &without, least);
  cairo_surface_destroy(with.sheet);
  cairo_surface_destroy(without.sheet);
  return result;
}

static void same(const scene *a, const scene *b, int least, double area, const char *what) {
  picture x = paint(a), y = paint(b);
  spot s = compare(&x, &y, least);
  ck_assert_msg(s.area <= area, "%s: %g pixels differ around (%g, %g)", what, s.area, s.x, s.y);
  cairo_surface_destroy(x.sheet);
  cairo_surface_destroy(y.sheet);
}

static spot covered(const scene *s) {
  return covered_by(s, 24);
}

/* ---- places and sizes ---- */

START_TEST(a_ball_in_a_flat_view) {
  const ball one = {{0.3, 5, 0.7}, 0.15};
  scene s = scene_of(1, &one, 0, NULL);
  picture p = paint(&s);
  /* the shorter side of the image shows 1 m, and its middle is (0.5, 0.5) */
  double scale = fmin(p.width, p.height), r = 0.15 * scale;
  double x = 0.5 * p.width + (0.3 - 0.5) * scale, y = 0.5 * p.height - (0.7 - 0.5) * scale;
  cairo_surface_destroy(p.sheet);
  spot c = covered(&s);
  ck_assert_double_eq_tol(c.area, pi * r * r, 0.015 * pi * r * r);
  ck_assert_double_eq_tol(c.x, x, 0.6);
  ck_assert_double_eq_tol(c.y, y, 0.6);
  scene_free(&s);
}
END_TEST

/* The cone that just holds the ball has the half angle asin(r / d). */
START_TEST(a_ball_in_perspective) {
  const ball one = {{0, 0, 0}, 0.3};
  scene s = scene_of(1, &one, 0, NULL);
  in_space(&s, tdm_v3(0, -2, 0), 40, 0);
  double r = tan(asin(0.3 / 2)) / tan(20 * pi / 180) * 250;
  spot c = covered(&s);
  ck_assert_double_eq_tol(c.area, pi * r * r, 0.015 * pi * r * r);
  ck_assert_double_eq_tol(c.x, 300, 0.6);
  ck_assert_double_eq_tol(c.y, 250, 0.6);
  in_space(&s, tdm_v3(0, -2, 0), 0, 1.5); /* and without perspective */
  r = 0.3 / 1.5 * 500;
  c = covered(&s);
  ck_assert_double_eq_tol(c.area, pi * r * r, 0.015 * pi * r * r);
  scene_free(&s);
}
END_TEST

/* Away from the middle it is an ellipse: half axes tan-differences along the line to the middle. */
START_TEST(a_ball_beside_the_middle_in_perspective) {
  const ball one = {{-0.5, 0, 0}, 0.1};
  scene s = scene_of(1, &one, 0, NULL);
  in_space(&s, tdm_v3(0, -2, 0), 45, 0);
  double d = hypot(0.5, 2), turn = atan2(0.5, 2), half = asin(0.1 / d), scale = 250 / tan(22.5 * pi / 180);
  double near = scale * tan(turn - half), far = scale * tan(turn + half), a = 0.5 * (far - near);
  /* across the line: the ellipse's half axes obey b^2 = a * cos-foreshortening of the cone's section */
  double b = scale * sin(half) / sqrt(cos(turn) * cos(turn) - sin(half) * sin(half));
  spot c = covered(&s);
  ck_assert_double_eq_tol(c.x, 300 - 0.5 * (near + far), 0.6);
  ck_assert_double_eq_tol(c.area, pi * a * b, 0.03 * pi * a * b);
  scene_free(&s);
}
END_TEST

/* ---- what hides what ---- */

static const tdm_vec3 upright[4] = {{-0.5, -0.6, -0.5}, {0.5, -0.6, -0.5}, {0.5, -0.6, 0.5}, {-0.5, -0.6, 0.5}};

START_TEST(walls_hide_and_let_through) {
  const ball one = {{0, 0, 0}, 0.2};
  scene s = scene_of(1, &one, 1, upright), bare = scene_of(1, &one, 0, NULL);
  double r = tan(asin(0.2 / 2)) / tan(20 * pi / 180) * 250, area = pi * r * r;
  in_space(&s, tdm_v3(0, -2, 0), 40, 0);
  in_space(&bare, tdm_v3(0, -2, 0), 40, 0);
  s.picture.walls = TDM_SURFACE_solid;
  ck_assert_double_eq(covered(&s).area, 0);
  s.picture.walls = TDM_SURFACE_translucent;
  ck_assert_double_eq_tol(covered(&s).area, area, 0.03 * area);
  s.picture.walls = TDM_SURFACE_auto; /* walls are translucent in space */
  ck_assert_double_eq_tol(covered(&s).area, area, 0.03 * area);
  s.picture.walls = TDM_SURFACE_hidden;
  same(&s, &bare, 2, 0, "a hidden wall");
  s.picture.walls = TDM_SURFACE_solid;
  in_space(&s, tdm_v3(0, 2, 0), 40, 0); /* from the other side the ball is in front of the wall */
  ck_assert_double_eq_tol(covered(&s).area, area, 0.015 * area);
  scene_free(&s);
  scene_free(&bare);
}
END_TEST

/* A flat view shows all particles in front of the walls, unless walls are asked for. */
START_TEST(flat_views_show_the_particles) {
  const ball one = {{0.5, 0, 0.5}, 0.1};
  const tdm_vec3 wall[4] = {{0, -1, 0}, {1, -1, 0}, {1, -1, 1}, {0, -1, 1}};
  scene s = scene_of(1, &one, 1, wall);
  ck_assert_double_gt(covered(&s).area, 1000);
  s.picture.walls = TDM_SURFACE_solid;
  ck_assert_double_eq(covered(&s).area, 0);
  scene_free(&s);
}
END_TEST

/* Seen from 30 degrees above: half of the disc, and half of the ellipse in which the plane cuts the ball. */
START_TEST(a_ball_half_in_a_plane) {
  const ball one = {{0, 0, 0}, 0.3};
  const tdm_vec3 floor[4] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  scene s = scene_of(1, &one, 1, floor);
  in_space(&s, tdm_v3(0, -2 * cos(pi / 6), 2 * sin(pi / 6)), 0, 1.2);
  s.picture.walls = TDM_SURFACE_solid;
  double r = 0.3 / 1.2 * 500, area = 0.5 * pi * r * r * (1 + sin(pi / 6));
  spot c = covered_by(&s, 100); /* it shades the floor around it, by less than that */
  ck_assert_msg(fabs(c.area - area) < 0.04 * area, "%g pixels of %g", c.area, area);
  scene_free(&s);
}
END_TEST

/* ---- cuts and nets ---- */

/* What the walls cover, against the same picture without them. */
static double wall_area(const scene *s, int least) {
  scene bare = *s;
  bare.picture.walls = TDM_SURFACE_hidden;
  picture with = paint(s), without = paint(&bare);
  double area = compare(&with, &without, least).area;
  cairo_surface_destroy(with.sheet);
  cairo_surface_destroy(without.sheet);
  return area;
}

/* What is in front of the plane is left out: balls whose centre is there, and that part of a wall. */
START_TEST(a_cut_shows_what_is_behind) {
  const ball two[2] = {{{0.2, -0.5, 0}, 0.1}, {{-0.2, 0.5, 0}, 0.1}};
  scene both = scene_of(2, two, 0, NULL), behind = scene_of(1, two + 1, 0, NULL), wall = scene_of(0, NULL, 1, upright);
  in_space(&both, tdm_v3(0, -2, 0), 40, 0);
  in_space(&behind, tdm_v3(0, -2, 0), 40, 0);
  in_space(&wall, tdm_v3(0, -2, 0), 0, 1.5);
  both.picture.cut = wall.picture.cut = true;
  both.picture.cut_normal = tdm_v3(0, -1, 0);
  behind.frame.range[1] = both.frame.range[1];
  ck_assert_double_eq_tol(covered(&both).x, covered(&behind).x, 0.01);
  ck_assert_double_eq(covered(&both).area, covered(&behind).area);
  wall.picture.walls = TDM_SURFACE_solid;
  double pixel = 500 / 1.5;
  wall.picture.cut_point = tdm_v3(0.1, 7, 7);
  wall.picture.cut_normal = tdm_v3(1, 0, 0);
  ck_assert_double_eq_tol(wall_area(&wall, 8), 0.6 * pixel * pixel, 0.01 * pixel * pixel);
  wall.picture.cut_normal = tdm_v3(-1, 0, 0);
  ck_assert_double_eq_tol(wall_area(&wall, 8), 0.4 * pixel * pixel, 0.01 * pixel * pixel);
  wall.picture.cut_normal = tdm_unit(tdm_v3(1, 0, 1)); /* a corner less */
  wall.picture.cut_point = tdm_v3(0.25, 0, 0.25);
  ck_assert_double_eq_tol(wall_area(&wall, 8), 0.875 * pixel * pixel, 0.01 * pixel * pixel);
  scene_free(&both);
  scene_free(&behind);
  scene_free(&wall);
}
END_TEST

/* Bars that are thinner than a pixel have no dark edges; one wide wall has. */
START_TEST(a_fine_net_is_pale) {
  enum { BARS = 100 };
  tdm_vec3 corner[4 * BARS];
  for (int k = 0; k < BARS; k++)
    for (int c = 0; c < 4; c++)
      corner[4 * k + c] = tdm_v3(-0.5 + 0.01 * k + (c == 1 || c == 2 ? 0.002 : 0), 0, c < 2 ? -0.5 : 0.5);
  scene net = scene_of(0, NULL, BARS, corner), wall = scene_of(0, NULL, 1, upright);
  in_space(&net, tdm_v3(0, -2, 0), 0, 1.5);
  in_space(&wall, tdm_v3(0, -2, 0), 0, 1.5);
  ck_assert_double_eq(wall_area(&net, 40), 0);
  ck_assert_double_gt(wall_area(&net, 2), 10000);
  ck_assert_double_gt(wall_area(&wall, 40), 4 * 300);
  scene_free(&net);
  scene_free(&wall);
}
END_TEST

/* ---- little to see ---- */

START_TEST(what_is_not_finite_is_left_out) {
  const ball two[2] = {{{0, 0, 0}, 0.2}, {{NAN, 0, 0}, 0.2}},
             odd[3] = {two[0], {{0, 0, 0.5}, NAN}, {{0, INFINITY, 0}, 1}};
  scene one = scene_of(1, two, 0, NULL), s = scene_of(2, two, 0, NULL), t = scene_of(3, odd, 0, NULL);
  in_space(&one, tdm_v3(0, -2, 0), 40, 0);
  s.picture = t.picture = one.picture;
  same(&one, &s, 0, 0, "a place that is no number");
  same(&one, &t, 0, 0, "a radius that is no number, a place without end");
  tdm_bounds b = tdm_bounds_empty();
  tdm_error err = {0};
  ck_assert_int_eq(tdm_content_bounds(&b, &t.picture, &t.scenery, &t.snapshot, true, &err), TDM_OK);
  ck_assert_double_eq_tol(b.high.y, 0.2, 1e-12);
  scene_free(&one);
  scene_free(&s);
  scene_free(&t);
}
END_TEST

/* Scenes with nothing, without a size, and far away: a picture, whatever the view. */
START_TEST(scenes_of_every_size) {
  const ball one = {{0, 0, 0}, 0.2}, point = {{3, 3, 3}, 0}, far = {{1e12, -1e12, 1e12}, 1e-3},
             wide = {{0, 0, 0}, 1e15};
  const ball *rows[] = {NULL, &one, &point, &far, &wide};
  for (int i = 0; i < 5; i++)
    for (int view = 0; view < 3; view++) {
      scene s = scene_of(rows[i] != NULL, rows[i] ? rows[i] : &one, 0, NULL);
      tdm_error err = {0};
      s.frame.bounds = tdm_bounds_empty();
      s.frame.range[0] = INFINITY;
      s.frame.range[1] = -INFINITY;
      s.picture.view = view == 0 ? (tdm_view){.flat = true, .across = 0, .up_axis = 2}
                                 : (tdm_view){.angle = 30, .has_from = view == 2, .from = {1, 0, 0}};
      ck_assert_int_eq(tdm_content_bounds(&s.frame.bounds, &s.picture, &s.scenery, &s.snapshot, true, &err), TDM_OK);
      picture p = paint(&s);
      cairo_surface_destroy(p.sheet);
      scene_free(&s);
    }
}
END_TEST

/* A scene a thousand kilometres away from the origin looks as it does there. */
START_TEST(far_from_the_origin) {
  const tdm_vec3 off = {1e6, -2e6, 3e5};
  const ball here[2] = {{{0, 0, 0}, 0.2}, {{0.15, 0.1, 0.2}, 0.1}};
  const ball there[2] = {{tdm_add(here[0].at, off), 0.2}, {tdm_add(here[1].at, off), 0.1}};
  scene s = scene_of(2, here, 0, NULL), t = scene_of(2, there, 0, NULL);
  in_space(&s, tdm_v3(0.5, -2, 1), 30, 0);
  in_space(&t, tdm_add(tdm_v3(0.5, -2, 1), off), 30, 0);
  t.picture.view.at = off;
  same(&s, &t, 3, 20, "far away");
  scene_free(&s);
  scene_free(&t);
}
END_TEST

/* The camera that nobody has set: all is in the picture, not much smaller than it could be, and up is up. */
START_TEST(the_usual_camera_shows_all) {
  static const tdm_bounds rows[] = {
      {{-1, -1, -1}, {1, 1, 1}}, {{0, 0, 0}, {10, 0.1, 0.1}}, {{0, 0, 0}, {0, 0, 5}}, {{4, 5, 6}, {5, 5, 8}}};
  static const tdm_vec3 ups[] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {0.6, 0, -0.8}};
  for (size_t i = 0; i < 4; i++)
    for (int u = 0; u < 4; u++) {
      const tdm_view view = {.angle = 30};
      const tdm_camera c = tdm_camera_make(&view, &rows[i], ups[u], 1.5);
      double largest = 0, x[2];
      for (int k = 0; k < 8; k++) {
        tdm_vec3 corner = {k & 1 ? rows[i].high.x : rows[i].low.x, k & 2 ? rows[i].high.y : rows[i].low.y,
                           k & 4 ? rows[i].high.z : rows[i].low.z};
        tdm_vec3 seen = tdm_camera_see(&c, corner);
        ck_assert_double_lt(seen.z, 0);
        tdm_camera_project(&c, seen, x);
        largest = fmax(largest, fmax(fabs(x[0]), fabs(x[1])));
      }
      ck_assert_double_le(largest, 1);
      ck_assert_double_ge(largest, 0.9);
      ck_assert_double_ge(tdm_dot(c.up, ups[u]), 0.8);
    }
}
END_TEST

/* ---- colours ---- */

START_TEST(colours_get_brighter) {
  double before = -1;
  for (int k = 0; k <= 100; k++) {
    tdm_rgb c = tdm_color_map(k / 100.0);
    double bright = 0.299 * c.r + 0.587 * c.g + 0.114 * c.b;
    ck_assert_double_gt(bright, before);
    before = bright;
  }
  ck_assert_int_eq(memcmp(&(tdm_rgb){68, 1, 84}, &(tdm_rgb){tdm_color_map(NAN).r, tdm_color_map(-3).g, 84}, 3), 0);
}
END_TEST

/* One contact that bears a hundred times more than all others does not make these look alike. */
START_TEST(ranges_of_colours) {
  ball many[200];
  for (int i = 0; i < 200; i++)
    many[i] = (ball){{0, 0, 0}, 0.1 + 0.001 * i};
  scene s = scene_of(200, many, 0, NULL);
  const tdm_camera camera = tdm_camera_make(&s.picture.view, &s.frame.bounds, tdm_v3(0, 0, 1), 1);
  tdm_error err = {0};
  double force[2] = {INFINITY, -INFINITY}, radius[2] = {INFINITY, -INFINITY};
  for (int i = 0; i < 200; i++)
    s.snapshot.force[i] = tdm_v3(0, 0, i == 7 ? 1000 : 1 + 0.01 * i);
  tdm_color_widen(force, TDM_COLOR_force, &s.snapshot, &camera, tdm_v3(0, 0, 1), &err);
  tdm_color_widen(radius, TDM_COLOR_radius, &s.snapshot, &camera, tdm_v3(0, 0, 1), &err);
  ck_assert_double_eq(force[0], 0);
  ck_assert_double_lt(force[1], 3);
  ck_assert_double_eq_tol(radius[0], 0.1, 1e-12);
  ck_assert_double_eq_tol(radius[1], 0.299, 1e-12);
  scene_free(&s);
}
END_TEST

TEST_MAIN("draw_picture", a_ball_in_a_flat_view, a_ball_in_perspective, a_ball_beside_the_middle_in_perspective,
          walls_hide_and_let_through, flat_views_show_the_particles, a_ball_half_in_a_plane, a_cut_shows_what_is_behind,
          a_fine_net_is_pale, what_is_not_finite_is_left_out, scenes_of_every_size, far_from_the_origin,
          the_usual_camera_shows_all, colours_get_brighter, ranges_of_colours)
