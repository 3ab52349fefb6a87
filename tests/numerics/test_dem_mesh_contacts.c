/* Meshes: the contacts of a sphere with surfaces whose analytic contact is known. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_mesh_support.h"
#include "tests/test_main.h"

/* ---- a meshed plane ---- */

enum { GRID = 12 };

/* A square [-6, 6]^2 in triangles of all shapes: vertices on a grid of quarters moved inside it, diagonals either way.
 * Mapped by `to_world` (columns); coordinates are binary fractions, so exact in float32. */
static dem_mesh *meshed_plane(tdm_mat3 to_world, bool turned) {
  tdm_stl s = {0};
  tdm_vec3 at[GRID + 1][GRID + 1];
  random_state = 11;
  for (int i = 0; i <= GRID; i++)
    for (int j = 0; j <= GRID; j++) {
      bool inner = i > 0 && j > 0 && i < GRID && j < GRID;
      double x = i - 6 + (inner ? floor(between(-2, 3)) / 8 : 0), y = j - 6 + (inner ? floor(between(-2, 3)) / 8 : 0);
      at[i][j] = tdm_m3_mul(to_world, tdm_v3(x, y, 0));
    }
  for (int i = 0; i < GRID; i++)
    for (int j = 0; j < GRID; j++) {
      tdm_vec3 a = at[i][j], b = at[i + 1][j], c = at[i + 1][j + 1], d = at[i][j + 1];
      if ((i * 7 + j * 3) % 5 < 2)
        add_quad(&s, b, c, d, a);
      else if (turned && (i + j) % 3 == 0)
        add_quad(&s, d, c, b, a);
      else
        add_quad(&s, a, b, c, d);
    }
  return mesh_of(&s, DEM_MESH_FACET_ANGLE);
}

/* points over the plane, many of them exactly over edges and vertices */
static tdm_vec3 over_plane(const dem_mesh *m, int trial) {
  tdm_vec3 c[3], n;
  dem_mesh_triangle(m, trial % dem_mesh_figures(m)->triangles, c, &n);
  double s = floor(between(0, 9)) / 8, t = between(0, 1);
  switch (trial % 5) {
  case 0:
    return c[trial / 5 % 3];
  case 1:
    return tdm_axpy(s, tdm_sub(c[1], c[0]), c[0]);
  case 2:
    return tdm_axpy(t, tdm_sub(c[2], c[1]), c[1]);
  case 3: /* beside an edge or a vertex by about the round-off */
    return tdm_axpy(t < 0.5 ? 1e-16 : 1e-9, tdm_v3(between(-1, 1), between(-1, 1), between(-1, 1)),
                    tdm_axpy(floor(2 * s), tdm_sub(c[0], c[2]), c[2]));
  default:
    return tdm_add(c[0], tdm_add(tdm_scale(s * t, tdm_sub(c[1], c[0])), tdm_scale((1 - s) * t, tdm_sub(c[2], c[0]))));
  }
}

/* always one contact, with the plane's gap and normal; `exact`: the mesh lies exactly in the plane */
static void sweep_plane(tdm_mat3 to_world, bool turned) {
  dem_mesh *m = meshed_plane(to_world, turned);
  const dem_mesh_report *r = dem_mesh_figures(m);
  ck_assert_int_eq(r->convex + r->concave + r->nonmanifold, 0);
  ck_assert_int_eq(r->open, 4 * GRID);
  tdm_vec3 up = tdm_unit(tdm_m3_mul(to_world, tdm_v3(0, 0, 1)));
  double side[] = {1, -1};
  for (int trial = 0; trial < 40000; trial++) {
    tdm_vec3 x = over_plane(m, trial);
    tdm_vec3 flat =
        tdm_v3(tdm_dot(x, tdm_m3_mul(to_world, tdm_v3(1, 0, 0))), tdm_dot(x, tdm_m3_mul(to_world, tdm_v3(0, 1, 0))), 0);
    double scale = tdm_dot(tdm_m3_mul(to_world, tdm_v3(1, 0, 0)), tdm_m3_mul(to_world, tdm_v3(1, 0, 0)));
    if (fmax(fabs(flat.x), fabs(flat.y)) > 5.9 * scale) /* the rim is not the plane's */
      continue;
    double radius = pow(10, between(-1, 0.5)), s = side[trial / 3 % 2];
    x = tdm_axpy(s * radius * between(0.7, 0.999), up, x);
    dem_touch out[DEM_TOUCHES_MAX];
    int n = contacts(m, x, radius, out);
    if (n != 1)
      ck_abort_msg("trial %d: %d contacts at [%.17g, %.17g, %.17g] radius %.17g", trial, n, x.x, x.y, x.z, radius);
    ck_relative(out[0].gap, s * tdm_dot(x, up), 1e-10);
    ck_vector(out[0].normal, tdm_scale(s, up), 1e-10);
  }
  dem_mesh_destroy(&m);
}

START_TEST(test_plane) {
  sweep_plane(tdm_m3_identity(), false);
  sweep_plane(tdm_m3_identity(), true);
}
END_TEST

/* inclined, with exact coordinates: the axes (2, 3, 6)/7, (3, -6, 2)/7, (6, 2, -3)/7 times 7/8 */
START_TEST(test_inclined_plane) {
  tdm_mat3 axes = {{{2 / 8., 3 / 8., 6 / 8.}, {3 / 8., -6 / 8., 2 / 8.}, {6 / 8., 2 / 8., -3 / 8.}}};
  sweep_plane(axes, false);
}
END_TEST

/* inclined, with rounded coordinates: still flat within the tolerance of an edge */
START_TEST(test_rounded_plane) {
  sweep_plane(tdm_quat_to_matrix(tdm_quat_from_rotvec(tdm_v3(0.3, -0.8, 1.1))), true);
}
END_TEST

/* The history of a contact passes from triangle to triangle all over a path. */
START_TEST(test_passes) {
  dem_mesh *m = meshed_plane(tdm_m3_identity(), false);
  dem_touch now[DEM_TOUCHES_MAX];
  int before = -1, changes = 0;
  for (int k = 0; k <= 200000; k++) {
    double s = k / 200000.0;
    ck_assert_int_eq(contacts(m, tdm_v3(-5 + 10 * s, -4.9 + 9.3 * s, 0.99), 1, now), 1);
    if (before >= 0 && now[0].part != before) {
      ck_assert(dem_mesh_passes(m, before, now[0].part));
      changes++;
    }
    before = now[0].part;
  }
  ck_assert_int_gt(changes, 20);
  ck_assert(!dem_mesh_passes(m, 0, dem_mesh_figures(m)->triangles - 1));
  dem_mesh_destroy(&m);
}
END_TEST

/* ---- edges and corners ---- */

/* A convex edge, corner: one contact, the nearest point; the gap and the normal are continuous. */
START_TEST(test_convex) {
  tdm_stl s = {0};
  add_cube(&s, tdm_v3(0, 0, 0), 63);
  dem_mesh *m = mesh_of(&s, DEM_MESH_FACET_ANGLE);
  random_state = 3;
  for (int trial = 0; trial < 20000; trial++) {
    tdm_vec3 x = tdm_v3(between(-1, 1), between(-1, 1), between(-1, 1));
    if (trial % 4 == 0)
      x.x = x.y = 0.5 + fabs(x.x); /* exactly over an edge */
    tdm_vec3 q = tdm_v3(fmax(-0.5, fmin(0.5, x.x)), fmax(-0.5, fmin(0.5, x.y)), fmax(-0.5, fmin(0.5, x.z)));
    tdm_vec3 d = tdm_sub(x, q);
    double gap = tdm_norm(d);
    if (gap < 1e-3)
      continue;
    dem_touch out[DEM_TOUCHES_MAX];
    ck_assert_int_eq(contacts(m, x, 1.05 * gap, out), 1);
    ck_relative(out[0].gap, gap, 1e-12);
    ck_vector(out[0].normal, tdm_scale(1 / gap, d), 1e-12);
  }
  dem_mesh_destroy(&m);
}
END_TEST

/* Rolling around a cube across two sharp edges: the history goes on, the normal turns without a jump. */
START_TEST(test_sharp_edge) {
  tdm_stl s = {0};
  add_cube(&s, tdm_v3(0, 0, 0), 63);
  dem_mesh *m = mesh_of(&s, DEM_MESH_FACET_ANGLE);
  dem_touch now[DEM_TOUCHES_MAX], before = {0};
  int changes = 0;
  for (int k = 0; k <= 10000; k++) {
    /* the centre's way, 0.09 off the surface: along the top, around the edge, down the side and around the next */
    double way = 3 * k / 10000.0 - 0.4, arc = 0.09 * M_PI / 2;
    tdm_vec3 x = tdm_v3(way, 0.1, 0.59);
    if (way > 0.5 && way < 0.5 + arc)
      x = tdm_v3(0.5 + 0.09 * sin((way - 0.5) / 0.09), 0.1, 0.5 + 0.09 * cos((way - 0.5) / 0.09));
    else if (way >= 0.5 + arc && way < 1.5 + arc)
      x = tdm_v3(0.59, 0.1, 0.5 - (way - 0.5 - arc));
    else if (way >= 1.5 + arc)
      break;
    ck_assert_int_eq(contacts(m, x, 0.1, now), 1);
    ck_near(now[0].gap, 0.09, 1e-14);
    if (k > 0) {
      ck_assert(dem_mesh_passes(m, before.part, now[0].part));
      ck_assert_double_le(tdm_norm(tdm_sub(now[0].normal, before.normal)), 4e-3);
      changes += now[0].part != before.part;
    }
    before = now[0];
  }
  ck_assert_int_ge(changes, 3);
  dem_mesh_destroy(&m);
}
END_TEST

/* The tip of a pyramid of many faces: one contact, the tip. */
START_TEST(test_fan) {
  tdm_stl s = {0};
  const int n = 500;
  for (int i = 0; i < n; i++) {
    double a = 2 * M_PI * i / n, b = 2 * M_PI * ((i + 1) % n) / n;
    add(&s, tdm_v3(0, 0, 0), tdm_v3(cos(a), sin(a), -0.2), tdm_v3(cos(b), sin(b), -0.2));
  }
  dem_mesh *m = mesh_of(&s, DEM_MESH_FACET_ANGLE);
  dem_touch out[DEM_TOUCHES_MAX];
  random_state = 17;
  for (int trial = 0; trial < 200; trial++) {
    double r = trial % 3 ? between(0, 0.015) : 0, a = between(0, 7);
    tdm_vec3 x = tdm_v3(r * cos(a), r * sin(a), 0.09);
    ck_assert_int_eq(contacts(m, x, 0.1, out), 1);
    ck_near(out[0].gap, tdm_norm(x), 1e-14);
    ck_vector(out[0].normal, tdm_unit(x), 1e-12);
  }
  dem_mesh_destroy(&m);
}
END_TEST

/* A concave corner of three faces, from inside: one contact a face in reach, none more. */
START_TEST(test_concave) {
  tdm_stl s = {0};
  add_cube(&s, tdm_v3(0.5, 0.5, 0.5), 1 | 4 | 16);
  dem_mesh *m = mesh_of(&s, DEM_MESH_FACET_ANGLE);
  ck_assert_int_eq(dem_mesh_figures(m)->open, 6);
  /* the corner's faces look outward, so the particles inside are behind them: convex as seen from the front */
  ck_assert_int_eq(dem_mesh_figures(m)->convex, 3);
  random_state = 5;
  for (int trial = 0; trial < 20000; trial++) {
    const double radius = 0.25, x[3] = {between(0.2, 0.5), between(0.2, 0.5), trial % 3 ? between(0.2, 0.5) : 0.2};
    dem_touch out[DEM_TOUCHES_MAX];
    int n = contacts(m, tdm_v3(x[0], x[1], x[2]), radius, out), touching = 0;
    double sum = 0;
    for (int k = 0; k < 3; k++)
      if (x[k] < radius) {
        touching++;
        sum += x[k];
      }
    ck_assert_int_eq(n, touching);
    for (int k = 0; k < n; k++) {
      sum -= out[k].gap;
      ck_near(out[k].normal.x + out[k].normal.y + out[k].normal.z, 1, 1e-15);
      ck_assert(k == 0 || out[k - 1].part < out[k].part);
    }
    ck_near(sum, 0, 1e-12);
  }
  dem_mesh_destroy(&m);
}
END_TEST

/* The order of the candidates does not matter, and more of them than needed do no harm. */
START_TEST(test_candidates) {
  dem_mesh *m = soup(400);
  int all[400], n = dem_mesh_figures(m)->triangles;
  dem_touch out[DEM_TOUCHES_MAX], other[DEM_TOUCHES_MAX];
  for (int trial = 0; trial < 200; trial++) {
    for (int t = 0; t < n; t++)
      all[t] = t;
    for (int t = n - 1; t > 0; t--) {
      int k = (int)(uniform() * (t + 1)), swap = all[t];
      all[t] = all[k];
      all[k] = swap;
    }
    tdm_vec3 x = tdm_v3(between(-1, 1), between(-1, 1), between(-1, 1));
    int a = contacts(m, x, 0.1, out), b = dem_mesh_contacts(m, all, 1, n, x, 0.1, other, DEM_TOUCHES_MAX);
    ck_assert_int_eq(a, b);
    for (int k = 0; k < a; k++) {
      ck_assert_int_eq(out[k].part, other[k].part);
      ck_assert_double_eq(out[k].gap, other[k].gap);
      ck_vector(out[k].normal, other[k].normal, 0);
    }
    if (a > 1) { /* with little room the deepest stay */
      double least = out[0].gap;
      for (int k = 1; k < a; k++)
        least = fmin(least, out[k].gap);
      ck_assert_int_eq(dem_mesh_contacts(m, all, 1, n, x, 0.1, other, 1), 1);
      ck_assert_double_eq(other[0].gap, least);
    }
  }
  dem_mesh_destroy(&m);
}
END_TEST

/* ---- bumps ---- */

enum { BUMPS = 10 };

/* The contacts with a rough surface, without merging, against all triangles: the nearest point of a triangle is a
 * contact when no triangle that has this point is nearer, and counts once. */
START_TEST(test_rough) {
  tdm_stl s = {0};
  random_state = 13;
  tdm_vec3 at[BUMPS + 1][BUMPS + 1];
  for (int i = 0; i <= BUMPS; i++)
    for (int j = 0; j <= BUMPS; j++)
      at[i][j] = tdm_v3(i, j, between(0, 0.8));
  for (int i = 0; i < BUMPS; i++)
    for (int j = 0; j < BUMPS; j++)
      add_quad(&s, at[i][j], at[i + 1][j], at[i + 1][j + 1], at[i][j + 1]);
  dem_mesh *m = mesh_of(&s, 0);
  int n = dem_mesh_figures(m)->triangles, several = 0;
  for (int trial = 0; trial < 3000; trial++) {
    tdm_vec3 x = tdm_v3(between(1, 9), between(1, 9), between(-0.5, 1.5)), c[3], normal;
    double radius = between(0.3, 1.2), gap[2 * BUMPS * BUMPS], expected[32];
    int count = 0;
    tdm_vec3 point[32];
    for (int t = 0; t < n; t++) {
      dem_mesh_triangle(m, t, c, &normal);
      gap[t] = distance_by_projection(c, x);
    }
    for (int t = 0; t < n; t++) {
      if (gap[t] >= radius)
        continue;
      dem_mesh_triangle(m, t, c, &normal);
      tdm_vec3 q = nearest_by_projection(c, x);
      bool lowest = true;
      for (int o = 0; o < n && lowest; o++) {
        dem_mesh_triangle(m, o, c, &normal);
        lowest = gap[o] >= gap[t] - 1e-12 || distance_by_projection(c, q) > 1e-9;
      }
      for (int k = 0; k < count && lowest; k++)
        lowest = tdm_norm(tdm_sub(point[k], q)) > 1e-9;
      if (lowest) {
        ck_assert_int_lt(count, 32);
        point[count] = q;
        expected[count++] = gap[t];
      }
    }
    dem_touch out[DEM_TOUCHES_MAX];
    ck_assert_int_eq(contacts(m, x, radius, out), count);
    several += count > 1;
    for (int k = 0; k < count; k++) {
      int same = 0;
      for (int i = 0; i < count; i++)
        same += tdm_norm(tdm_sub(tdm_axpy(-out[k].gap, out[k].normal, x), point[i])) < 1e-9 &&
                fabs(out[k].gap - expected[i]) < 1e-12;
      ck_assert_int_eq(same, 1);
    }
  }
  ck_assert_int_gt(several, 500);
  dem_mesh_destroy(&m);
}
END_TEST

/* ---- facets ---- */

/* the inside of a drum of radius 1 along z, n facets, in `rows` rows; normals inward */
static dem_mesh *drum(int n, int rows, double facet_angle) {
  tdm_stl s = {0};
  for (int i = 0; i < n; i++)
    for (int j = 0; j < rows; j++) {
      double a = 2 * M_PI * i / n, b = 2 * M_PI * ((i + 1) % n) / n, low = j, high = j + 1;
      add_quad(&s, tdm_v3(cos(a), sin(a), low), tdm_v3(cos(a), sin(a), high), tdm_v3(cos(b), sin(b), high),
               tdm_v3(cos(b), sin(b), low));
    }
  return mesh_of(&s, facet_angle);
}

/* One contact anywhere: the deepest facet's. The overlap is continuous, the normal jumps by the facets' angle. */
START_TEST(test_drum) {
  const double radius = 0.2, way = 0.79; /* of the centre's circle */
  const int facets[] = {36, 72, 180};
  for (int k = 0; k < 3; k++) {
    int n = facets[k], jumps = 0;
    double angle = 2 * M_PI / n, apothem = cos(M_PI / n), gap_before = 0;
    dem_mesh *m = drum(n, 4, DEM_MESH_FACET_ANGLE);
    ck_assert_int_eq(dem_mesh_figures(m)->concave, 4 * n);
    tdm_vec3 before = {0, 0, 0};
    const int steps = 40000;
    for (int i = 0; i <= steps; i++) {
      /* z passes rows: 2 is a row's edge */
      double at = 4 * angle * i / steps, turn = at - angle * (floor(at / angle) + 0.5);
      tdm_vec3 x = tdm_v3(way * cos(at), way * sin(at), 1.5 + 1.0 * i / steps);
      dem_touch out[DEM_TOUCHES_MAX];
      ck_assert_int_eq(contacts(m, x, radius + 0.03, out), 1);
      ck_near(out[0].gap, apothem - way * cos(turn), 1e-12);
      if (i > 0) {
        double jump = acos(fmin(1, tdm_dot(before, out[0].normal)));
        ck_assert(jump < 1e-7 || fabs(jump - angle) < 1e-7);
        jumps += jump > 1e-7;
        ck_assert(fabs(out[0].gap - gap_before) <= way * angle * 4 / steps);
      }
      before = out[0].normal;
      gap_before = out[0].gap;
    }
    ck_assert_int_ge(jumps, 3);
    ck_assert_int_le(jumps, 4);
    dem_mesh_destroy(&m);
  }
}
END_TEST

/* With facets at a larger angle than facet_angle the crease is a corner: two contacts. */
START_TEST(test_drum_corner) {
  dem_mesh *m = drum(36, 1, 0.1);
  double a = 2 * M_PI / 36;
  dem_touch out[DEM_TOUCHES_MAX];
  ck_assert_int_eq(contacts(m, tdm_v3(0.79 * cos(a), 0.79 * sin(a), 0.4), 0.22, out), 2);
  ck_near(out[0].gap, out[1].gap, 1e-14);
  ck_near(acos(tdm_dot(out[0].normal, out[1].normal)), a, 1e-7);
  dem_mesh_destroy(&m);
}
END_TEST

/* A sphere nearly as large as the drum touches opposite sides: they are never merged. */
START_TEST(test_tight_drum) {
  dem_mesh *m = drum(36, 1, DEM_MESH_FACET_ANGLE);
  dem_touch out[DEM_TOUCHES_MAX];
  tdm_vec3 sum = {0, 0, 0};
  int n = contacts(m, tdm_v3(0, 0, 0.5), 0.999, out);
  ck_assert_int_gt(n, 8);
  for (int k = 0; k < n; k++)
    sum = tdm_add(sum, out[k].normal);
  ck_assert_double_le(tdm_norm(sum), 0.2 * n);
  dem_mesh_destroy(&m);
}
END_TEST

/* From outside a drum is convex: one contact, at facets and edges, and the distance is the smallest there is. */
START_TEST(test_drum_outside) {
  dem_mesh *m = drum(36, 3, DEM_MESH_FACET_ANGLE);
  tdm_vec3 before = {0, 0, 0};
  for (int i = 0; i <= 20000; i++) {
    double at = 0.5 * i / 20000;
    tdm_vec3 x = tdm_v3(1.19 * cos(at), 1.19 * sin(at), 1.2 + at), n;
    dem_touch out[DEM_TOUCHES_MAX];
    ck_assert_int_eq(contacts(m, x, 0.2, out), 1);
    ck_near(out[0].gap, dem_mesh_gap(m, x, &n), 1e-14);
    ck_assert(i == 0 || tdm_norm(tdm_sub(out[0].normal, before)) < 2e-4);
    before = out[0].normal;
  }
  dem_mesh_destroy(&m);
}
END_TEST

/* ---- cracks ---- */

/* A plane of two halves that share no vertex on their common line, and one whose vertices differ in the last digit. */
START_TEST(test_cracks) {
  for (int kind = 0; kind < 2; kind++) {
    tdm_stl s = {0};
    double off = kind ? 1e-9 : 0;
    add_quad(&s, tdm_v3(-4, -4, 0), tdm_v3(0, -4, 0), tdm_v3(0, 4, 0), tdm_v3(-4, 4, 0));
    for (int j = 0; j < (kind ? 1 : 8); j++) {
      double low = kind ? -4 : j - 4, high = kind ? 4 : j - 3;
      add_quad(&s, tdm_v3(off, low, 0), tdm_v3(4, low, 0), tdm_v3(4, high, 0), tdm_v3(off, high, 0));
    }
    dem_mesh *m = mesh_of(&s, DEM_MESH_FACET_ANGLE);
    ck_assert_int_ge(dem_mesh_figures(m)->open, 8);
    for (int i = 0; i <= 20000; i++) {
      double x = i % 3 ? -1 + 2 * i / 20000. : (i % 7 - 3) * 1e-10;
      dem_touch out[DEM_TOUCHES_MAX];
      int n = contacts(m, tdm_v3(x, 1.5 * sin(i), 0.99), 1, out);
      ck_assert_msg(n == 1, "%d contacts at x = %.17g (%d)", n, x, kind);
      ck_near(out[0].gap, 0.99, 1e-12);
      ck_vector(out[0].normal, tdm_v3(0, 0, 1), 2e-9);
    }
    dem_mesh_destroy(&m);
  }
}
END_TEST

TEST_MAIN("dem_mesh_contacts", test_plane, test_inclined_plane, test_rounded_plane, test_passes, test_convex,
          test_sharp_edge, test_fan, test_concave, test_candidates, test_rough, test_drum, test_drum_corner,
          test_tight_drum, test_drum_outside, test_cracks)
