/* Closed surfaces, solids and cavities of STL files: the check that mbd and dem share. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/mesh/mesh.h"
#include "mbd/shape/inertia.h"
#include "protocol/surface/surface.h"
#include "tests/test_main.h"

#include <math.h>
#include <string.h>

enum { BOX = 12, ROOM = 8 * BOX };

static tdm_vec3 corner[3 * ROOM];
static tdm_stl stl;

static void begin(void) {
  stl = (tdm_stl){0, corner};
}

/* The box [low, low + size] as 12 triangles with their outer sides outside, or inside. */
static void add_box(tdm_vec3 low, double size, bool inverted) {
  static const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  static const int orders[2][6] = {{0, 1, 2, 0, 2, 3}, {0, 2, 1, 0, 3, 2}};
  for (int k = 0; k < 3 * BOX; k++) {
    int v = faces[k / 6][orders[inverted][k % 6]];
    corner[3 * stl.count + k] =
        tdm_v3(low.x + (v & 1 ? size : 0), low.y + (v & 2 ? size : 0), low.z + (v & 4 ? size : 0));
  }
  stl.count += BOX;
}

static tdm_surface look(void) {
  tdm_surface s;
  tdm_error err = {0};
  ck_assert(tdm_surface_look(&s, &stl, NULL, &err) == TDM_OK);
  return s;
}

/* mbd takes it, and dem calls it closed with the same volume; or mbd refuses it with these words */
static void expect(const char *refusal, bool closed) {
  mbd_shape shape;
  tdm_error err = {0}, none = {0};
  mbd_shape_of_mesh(&shape, &stl, "part.stl", "p", &err);
  dem_mesh *mesh = dem_mesh_make(&stl, "part.stl", DEM_MESH_FACET_ANGLE, "p", &none);
  ck_assert_ptr_nonnull(mesh);
  const dem_mesh_report *r = dem_mesh_figures(mesh);
  ck_assert_int_eq(r->closed, closed);
  if (refusal)
    ck_assert_msg(err.status == TDM_ERR_SCENE && strstr(err.message, refusal), "\"%s\", not: %s", err.message, refusal);
  else {
    ck_assert_msg(err.status == TDM_OK, "%s", err.message);
    ck_assert_double_eq_tol(shape.volume, r->volume, 1e-13);
    ck_assert_double_lt(tdm_norm(tdm_sub(shape.centre, r->centre)), 1e-13);
  }
  dem_mesh_destroy(&mesh);
}

START_TEST(one_box) {
  begin();
  add_box(tdm_v3(5, 6, 7), 2, false);
  tdm_surface s = look();
  ck_assert(s.closed && s.oriented);
  ck_assert_int_eq(s.edges, 18);
  ck_assert_int_eq(s.parts, 1);
  ck_assert_int_eq(s.inverted + s.nested + s.repeated, 0);
  ck_assert_double_eq_tol(s.volume, 8, 1e-13);
  ck_assert_double_lt(tdm_norm(tdm_sub(s.centre, tdm_v3(6, 7, 8))), 1e-13);
  tdm_surface_destroy(&s);
  expect(NULL, true);
  stl.count = BOX - 1;
  expect("is open: 3 of its 18 edges", false);
}
END_TEST

/* two solids of which one is inside out: what was called a thin rod */
START_TEST(one_of_two_is_inside_out) {
  begin();
  add_box(tdm_v3(0, 0, 0), 1, false);
  add_box(tdm_v3(3, 0, 0), 1, true);
  tdm_surface s = look();
  ck_assert_int_eq(s.parts, 2);
  ck_assert_int_eq(s.inverted, 1);
  ck_assert_double_eq(s.bad.x, 3);
  tdm_surface_destroy(&s);
  expect("has 2 parts, and 1 of them are inside out (one has a corner at [3, 0, 0] m)", true);
  begin();
  add_box(tdm_v3(0, 0, 0), 1, true);
  add_box(tdm_v3(3, 0, 0), 1, true);
  expect("has the volume -2 m3", true);
}
END_TEST

/* a cavity is inside out and right, a solid in a solid is not */
START_TEST(cavities) {
  begin();
  add_box(tdm_v3(0, 0, 0), 4, false);
  add_box(tdm_v3(1, 1, 1), 2, true);
  expect(NULL, true);
  tdm_surface s = look();
  ck_assert_int_eq(s.inverted + s.nested, 0);
  ck_assert_double_eq_tol(s.volume, 56, 1e-12);
  tdm_surface_destroy(&s);
  add_box(tdm_v3(1.5, 1.5, 1.5), 1, false); /* a core in the cavity */
  expect(NULL, true);
  begin();
  add_box(tdm_v3(0, 0, 0), 4, false);
  add_box(tdm_v3(1, 1, 1), 2, false);
  expect("1 of them lie inside another one (one has a corner at [1, 1, 1] m)", true);
}
END_TEST

/* two boxes that touch along an edge: four triangles have it */
START_TEST(a_common_edge) {
  begin();
  add_box(tdm_v3(0, 0, 0), 1, false);
  add_box(tdm_v3(1, 1, 0), 1, false);
  tdm_surface s = look();
  ck_assert_int_eq(s.parts, 2);
  tdm_surface_destroy(&s);
  expect(NULL, true);
}
END_TEST

/* a triangle that is there twice counts once, in both */
START_TEST(repeated_triangles) {
  begin();
  add_box(tdm_v3(0, 0, 0), 1, false);
  memcpy(&corner[3 * BOX], &corner[3], 3 * sizeof *corner);
  stl.count++;
  tdm_surface s = look();
  ck_assert_int_eq(s.repeated, 1);
  ck_assert_int_eq(s.triangles, 12);
  ck_assert_double_eq_tol(s.volume, 1, 1e-14);
  tdm_surface_destroy(&s);
  expect(NULL, true);
}
END_TEST

/* A triangle without an area that joins an edge to the two halves on its other side closes the surface, in both. */
START_TEST(triangles_without_area) {
  begin();
  add_box(tdm_v3(0, 0, 0), 1, false);
  tdm_vec3 *c = &corner[0], a = c[0], b = c[1], tip = c[2], middle = tdm_scale(0.5, tdm_add(a, b));
  c[1] = middle; /* the first triangle in two */
  const tdm_vec3 more[6] = {middle, b, tip, a, b, middle};
  memcpy(&corner[3 * BOX], more, sizeof more);
  stl.count += 2;
  expect(NULL, true);
  stl.count--; /* without it there is a crack */
  expect("is open: 3 of its", false);
}
END_TEST

TEST_MAIN("surfaces", one_box, one_of_two_is_inside_out, cavities, a_common_edge, repeated_triangles,
          triangles_without_area)
