/* Meshes: STL files, topology, search, and the contacts of a sphere with surfaces whose analytic contact is known. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/mesh.h"
#include "dem/geometry/mesh_contact.h"
#include "dem/geometry/mesh_tree.h"
#include "test_dem_support.h"
#include "tests/test_main.h"

#include <stdint.h>
#include <unistd.h>

/* ---- support ---- */

static uint64_t state;

/* uniform in [0, 1), the same in every run (splitmix64) */
static double uniform(void) {
  uint64_t z = state += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

static double between(double low, double high) {
  return low + (high - low) * uniform();
}

/* a growing list of triangles */
static void add(tdm_stl *s, tdm_vec3 a, tdm_vec3 b, tdm_vec3 c) {
  s->corner = realloc(s->corner, 3 * (size_t)(s->count + 1) * sizeof *s->corner);
  tdm_vec3 *to = &s->corner[3 * (size_t)s->count++];
  to[0] = a;
  to[1] = b;
  to[2] = c;
}

static void add_quad(tdm_stl *s, tdm_vec3 a, tdm_vec3 b, tdm_vec3 c, tdm_vec3 d) {
  add(s, a, b, c);
  add(s, a, c, d);
}

/* make a mesh and forget the triangles */
static dem_mesh *mesh_of(tdm_stl *s, double facet_angle) {
  tdm_error err = {0};
  dem_mesh *m = dem_mesh_make(s, "test", facet_angle, NULL, &err);
  ck_assert_msg(m != NULL, "%s", err.message);
  tdm_stl_destroy(s);
  return m;
}

/* the faces of a cube of edge 1 around `at`, outward; `faces`: bits of -x +x -y +y -z +z */
static void add_cube(tdm_stl *s, tdm_vec3 at, unsigned faces) {
  for (int face = 0; face < 6; face++) {
    if (!(faces >> face & 1))
      continue;
    int axis = face / 2;
    double out = face % 2 ? 0.5 : -0.5;
    tdm_vec3 c[4];
    for (int k = 0; k < 4; k++) {
      double u = k == 1 || k == 2 ? 0.5 : -0.5, v = k >= 2 ? 0.5 : -0.5, x[3];
      x[axis] = out;
      x[(axis + 1) % 3] = u;
      x[(axis + 2) % 3] = v;
      c[out > 0 ? k : 3 - k] = tdm_add(at, tdm_v3(x[0], x[1], x[2]));
    }
    add_quad(s, c[0], c[1], c[2], c[3]);
  }
}

static int contacts(const dem_mesh *m, tdm_vec3 x, double radius, dem_touch *out) {
  int near[4096], n = dem_mesh_near(m, x, radius, near, 4096);
  ck_assert_int_le(n, 4096);
  return dem_mesh_contacts(m, near, 1, n, x, radius, out, DEM_TOUCHES_MAX);
}

static void ck_vector(tdm_vec3 v, tdm_vec3 e, double tolerance) {
  double off = tdm_norm(tdm_sub(v, e));
  ck_assert_msg(off <= tolerance, "[%.17g, %.17g, %.17g] is off [%.17g, %.17g, %.17g] by %.3g", v.x, v.y, v.z, e.x, e.y,
                e.z, off);
}

static const char *file_of(const char *name) {
  static char path[256];
  snprintf(path, sizeof path, "%s/mesh_%d_%s", TANDEM_TEST_DIR, (int)getpid(), name);
  return path;
}

static const char *write_file(const char *bytes, size_t n) {
  const char *file = file_of("file.stl");
  FILE *f = fopen(file, "wb");
  ck_assert_ptr_nonnull(f);
  ck_assert_uint_eq(fwrite(bytes, 1, n, f), n);
  fclose(f);
  return file;
}

/* ---- files ---- */

#define FACET(a, b, c) "facet normal 0 0 1\n outer loop\n" a b c " endloop\nendfacet\n"
#define V(x) "  vertex " x "\n"
#define TRIANGLE FACET(V("0 0 0"), V("1 0 0"), V("0 2 0"))

START_TEST(test_text) {
  const char text[] = "solid a part\n" TRIANGLE
                      "endsolid a part\n  SOLID\n" FACET(V("1e3 0 0"), V("-1.5E+2 0 0"), V("0 20 .5")) "endsolid\n";
  tdm_stl s;
  tdm_error err = {0};
  ck_assert_msg(!tdm_stl_read(&s, write_file(text, sizeof text - 1), 0.001, NULL, &err), "%s", err.message);
  ck_assert_int_eq(s.count, 2);
  ck_vector(s.corner[2], tdm_v3(0, 2e-3, 0), 0);
  ck_vector(s.corner[3], tdm_v3(1, 0, 0), 0);
  ck_vector(s.corner[5], tdm_v3(0, 0.02, 5e-4), 1e-18);
  tdm_stl_destroy(&s);
  unlink(file_of("file.stl"));
}
END_TEST

/* a binary file that begins with "solid", written and read again */
START_TEST(test_binary) {
  tdm_stl s = {0}, back;
  add_cube(&s, tdm_v3(0.25, -1.5, 3), 63);
  tdm_error err = {0};
  const char *file = file_of("file.stl");
  ck_assert(!tdm_stl_write(&s, file, &err));
  FILE *f = fopen(file, "r+b");
  ck_assert_uint_eq(fwrite("solid cube", 1, 10, f), 10);
  fclose(f);
  ck_assert_msg(!tdm_stl_read(&back, file, 1, NULL, &err), "%s", err.message);
  ck_assert_int_eq(back.count, 12);
  for (int k = 0; k < 36; k++)
    ck_vector(back.corner[k], s.corner[k], 0);
  tdm_stl_destroy(&back);
  ck_assert(!tdm_stl_read(&back, file, 0.001, NULL, &err));
  ck_vector(back.corner[7], tdm_scale(0.001, s.corner[7]), 0);
  tdm_stl_destroy(&s);
  tdm_stl_destroy(&back);
  unlink(file);
}
END_TEST

START_TEST(test_odd_files) {
  /* a byte order mark; all in one line; a name that contains "facet" */
  static const char *const good[] = {
      "\xef\xbb\xbfsolid a part\n" TRIANGLE "endsolid a part\n",
      "solid a part facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 2 0 endloop endfacet endsolid a "
      "part",
      "solid\r\n" TRIANGLE "endsolid\r\n", "solid facet 7\n" TRIANGLE "endsolid facet 7\n"};
  tdm_stl s;
  for (size_t k = 0; k < sizeof good / sizeof *good; k++) {
    tdm_error err = {0};
    ck_assert_msg(!tdm_stl_read(&s, write_file(good[k], strlen(good[k])), 1, NULL, &err), "%zu: %s", k, err.message);
    ck_assert_int_eq(s.count, 1);
    ck_vector(s.corner[2], tdm_v3(0, 2, 0), 0);
    tdm_stl_destroy(&s);
  }
  tdm_error two = {0};
  static const char line[] = "solid a facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 2 0 endloop "
                             "endfacet endsolid a solid b facet normal 0 0 1 outer loop";
  ck_assert_int_eq(tdm_stl_read(&s, write_file(line, sizeof line - 1), 1, NULL, &two), TDM_ERR_FILE);
  ck_assert_ptr_nonnull(strstr(two.message, "another solid in the same line"));
  tdm_stl_destroy(&s);

  /* a binary file whose head is a text, cut */
  char bytes[84 + 120];
  memset(bytes, ' ', 80);
  memcpy(bytes, "solid from a program", 20);
  memcpy(bytes + 80, "\3\0\0\0", 4);
  memset(bytes + 84, 'x', 120);
  tdm_error cut = {0};
  ck_assert_int_eq(tdm_stl_read(&s, write_file(bytes, sizeof bytes), 1, NULL, &cut), TDM_ERR_FILE);
  ck_assert_msg(strstr(cut.message, "counts 3 triangles, which take 234 bytes, but it has 204") != NULL, "%s",
                cut.message);
  tdm_stl_destroy(&s);

  /* scales with which nothing can be computed */
  static const double scales[] = {1e20, 1e-20, 1e300, 1e-300};
  for (int k = 0; k < 4; k++) {
    tdm_error err = {0};
    ck_assert_int_eq(tdm_stl_read(&s, write_file(good[0], strlen(good[0])), scales[k], NULL, &err), TDM_ERR_SCENE);
    ck_assert_msg(strstr(err.message, "\"scale\" = 1e"), "%s", err.message);
    tdm_stl_destroy(&s);
  }
  unlink(file_of("file.stl"));
}
END_TEST

START_TEST(test_bad_files) {
  static const struct {
    const char *text, *says;
  } bads[] = {
      {"", "no STL file"},
      {"garbage", "no STL file"},
      {"{\"json\": [1, 2, 3], \"and\": \"more text so that it is longer than the head of a binary file is .......\"}",
       "export it again"},
      {"solid x\nendsolid x\n", "no triangles"},
      {"solid x\n", "line 2: the file ends"},
      {"solid x\n" TRIANGLE, "line 9: the file ends"},
      {"solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0\n", "line 6: the file ends"},
      {"solid x\n" FACET(V("0 0 0"), V("1 0 zero"), V("0 1 0")) "endsolid", "line 5: \"zero\""},
      {"solid x\n" FACET(V("0 0 0"), V("1 0 nan"), V("0 1 0")) "endsolid", "line 5: the vertex"},
      {"solid x\n" FACET(V("0 0 0"), V("1 0 1e400"), V("0 1 0")) "endsolid", "line 5: the vertex"},
      {"solid x\n" FACET(V("0 0 0"), V("1 0 0"), V("0 1 0") V("1 1 0")) "endsolid", "line 7: \"vertex\""},
      {"solid x\n" TRIANGLE "endsolid\nrubbish\n", "line 10: \"rubbish\""},
  };
  tdm_stl s;
  for (size_t i = 0; i < sizeof bads / sizeof *bads; i++) {
    tdm_error err = {0};
    const char *file = write_file(bads[i].text, strlen(bads[i].text));
    ck_assert_int_eq(tdm_stl_read(&s, file, 1, "dem.x", &err), TDM_ERR_FILE);
    ck_assert_msg(strstr(err.message, bads[i].says) && strstr(err.message, file), "%zu: %s", i, err.message);
    ck_assert_str_eq(err.path, "dem.x");
    tdm_stl_destroy(&s);
  }
  /* binary: cut, too long, a count beyond all bounds, no triangles, NaN */
  static const struct {
    uint32_t count;
    size_t size;
    bool nan;
    const char *says;
  } binaries[] = {{2, 84 + 99, false, "counts 2 triangles"},
                  {2, 84 + 101, false, "counts 2 triangles"},
                  {0xffffffffu, 84 + 50, false, "counts 4294967295"},
                  {0, 84, false, "no triangles"},
                  {1, 83, false, "no STL file"},
                  {2, 84 + 100, true, "byte 146: triangle 1"}};
  for (size_t i = 0; i < sizeof binaries / sizeof *binaries; i++) {
    char bytes[256] = "\1binary";
    for (int k = 0; k < 4; k++)
      bytes[80 + k] = (char)(binaries[i].count >> 8 * k);
    if (binaries[i].nan)
      memcpy(bytes + 146, "\0\0\xc0\x7f", 4);
    tdm_error err = {0};
    ck_assert_int_eq(tdm_stl_read(&s, write_file(bytes, binaries[i].size), 1, NULL, &err), TDM_ERR_FILE);
    ck_assert_msg(strstr(err.message, binaries[i].says), "%zu: %s", i, err.message);
    tdm_stl_destroy(&s);
  }
  unlink(file_of("file.stl"));
  tdm_error none = {0}, folder = {0};
  ck_assert_int_eq(tdm_stl_read(&s, "/nowhere/part.stl", 1, NULL, &none), TDM_ERR_FILE);
  ck_assert(strstr(none.message, "/nowhere/part.stl") != NULL);
  ck_assert_int_eq(tdm_stl_read(&s, "/tmp", 1, NULL, &folder), TDM_ERR_FILE);
}
END_TEST

/* ---- topology ---- */

START_TEST(test_report_closed) {
  tdm_stl s = {0};
  add_cube(&s, tdm_v3(3, 4, 5), 63);
  dem_mesh *m = mesh_of(&s, DEM_MESH_FACET_ANGLE);
  const dem_mesh_report *r = dem_mesh_figures(m);
  ck_assert_int_eq(r->triangles, 12);
  ck_assert_int_eq(r->vertices, 8);
  ck_assert_int_eq(r->edges, 18);
  ck_assert_int_eq(r->flat, 6);
  ck_assert_int_eq(r->convex, 12);
  ck_assert_int_eq(r->concave + r->open + r->nonmanifold + r->flipped + r->degenerate + r->duplicate, 0);
  ck_assert(r->closed);
  ck_near(r->area, 6, 1e-14);
  ck_near(r->volume, 1, 1e-14);
  ck_vector(r->low, tdm_v3(2.5, 3.5, 4.5), 0);
  ck_vector(r->high, tdm_v3(3.5, 4.5, 5.5), 0);
  json_t *json = dem_mesh_report_json(m);
  ck_near(json_real_value(json_object_get(json, "volume")), 1, 1e-14);
  ck_assert_str_eq(json_string_value(json_object_get(json, "file")), "test");
  json_decref(json);
  dem_mesh_destroy(&m);
}
END_TEST

/* a cube without its +z face, one triangle turned, one there twice (turned), two without area, a fin on an edge */
START_TEST(test_report_faults) {
  tdm_stl s = {0};
  add_cube(&s, tdm_v3(0, 0, 0), 31);
  add(&s, s.corner[2], s.corner[1], s.corner[0]);
  tdm_vec3 turned = s.corner[0];
  s.corner[0] = s.corner[1];
  s.corner[1] = turned;
  add(&s, tdm_v3(0, 0, 0), tdm_v3(1, 1, 1), tdm_v3(1, 1, 1));
  add(&s, tdm_v3(0, 0, 0), tdm_v3(0.1, 0.1, 0.3), tdm_v3(0.2, 0.2, 0.6));
  dem_mesh *m = mesh_of(&s, DEM_MESH_FACET_ANGLE);
  const dem_mesh_report *r = dem_mesh_figures(m);
  ck_assert_int_eq(r->triangles, 10);
  ck_assert_int_eq(r->duplicate, 1);
  ck_assert_int_eq(r->degenerate, 2);
  ck_assert_int_eq(r->vertices, 8);
  ck_assert_int_eq(r->open, 4);
  ck_assert_int_eq(r->flipped, 2); /* the third side of the turned one is open */
  ck_assert(!r->closed);
  ck_assert_double_eq(r->volume, 0);
  dem_mesh_destroy(&m);

  add_cube(&s, tdm_v3(0, 0, 0), 63);
  add(&s, tdm_v3(0.5, 0.5, -0.5), tdm_v3(0.5, 0.5, 0.5), tdm_v3(1, 1, 0));
  m = mesh_of(&s, DEM_MESH_FACET_ANGLE);
  ck_assert_int_eq(dem_mesh_figures(m)->nonmanifold, 1);
  ck_assert_int_eq(dem_mesh_figures(m)->open, 2);
  dem_mesh_destroy(&m);

  tdm_error err = {0};
  add(&s, tdm_v3(0, 0, 0), tdm_v3(1, 1, 1), tdm_v3(2, 2, 2));
  ck_assert_ptr_null(dem_mesh_make(&s, "needle", 0, "dem.x", &err));
  ck_assert(err.status == TDM_ERR_FILE && strstr(err.message, "needle"));
  tdm_stl_destroy(&s);
}
END_TEST

/* ---- search ---- */

/* a soup of triangles of very different sizes */
static dem_mesh *soup(int n) {
  tdm_stl s = {0};
  state = 7;
  for (int t = 0; t < n; t++) {
    tdm_vec3 a = tdm_v3(between(-1, 1), between(-1, 1), between(-1, 1));
    double size = pow(10, between(-2.5, 0));
    tdm_vec3 b = tdm_v3(a.x + size * uniform(), a.y + size * uniform(), a.z - size * uniform());
    tdm_vec3 c = tdm_v3(a.x - size * uniform(), a.y + size * uniform(), a.z + size * uniform());
    add(&s, a, b, c);
  }
  return mesh_of(&s, DEM_MESH_FACET_ANGLE);
}

/* the point of a triangle nearest to x: in its plane by the normal equations, else the best of the three sides */
static tdm_vec3 nearest_by_projection(const tdm_vec3 c[3], tdm_vec3 x) {
  tdm_vec3 u = tdm_sub(c[1], c[0]), v = tdm_sub(c[2], c[0]), r = tdm_sub(x, c[0]), best = c[0];
  double uu = tdm_dot(u, u), uv = tdm_dot(u, v), vv = tdm_dot(v, v), ru = tdm_dot(r, u), rv = tdm_dot(r, v);
  double det = uu * vv - uv * uv, p = (vv * ru - uv * rv) / det, q = (uu * rv - uv * ru) / det;
  if (p >= 0 && q >= 0 && p + q <= 1)
    return tdm_axpy(p, u, tdm_axpy(q, v, c[0]));
  for (int k = 0; k < 3; k++) {
    tdm_vec3 e = tdm_sub(c[(k + 1) % 3], c[k]), w = tdm_sub(x, c[k]);
    tdm_vec3 on = tdm_axpy(fmax(0, fmin(1, tdm_dot(w, e) / tdm_dot(e, e))), e, c[k]);
    if (tdm_norm(tdm_sub(x, on)) < tdm_norm(tdm_sub(x, best)))
      best = on;
  }
  return best;
}

static double distance_by_projection(const tdm_vec3 c[3], tdm_vec3 x) {
  return tdm_norm(tdm_sub(x, nearest_by_projection(c, x)));
}

START_TEST(test_near) {
  dem_mesh *m = soup(3000);
  int n = dem_mesh_figures(m)->triangles, near[3000], all = 0;
  for (int trial = 0; trial < 300; trial++) {
    tdm_vec3 x = tdm_v3(between(-1.5, 1.5), between(-1.5, 1.5), between(-1.5, 1.5)), normal;
    double range = pow(10, between(-2, 0.2)), least = INFINITY;
    int found = dem_mesh_near(m, x, range, near, 3000), k = 0;
    for (int t = 0; t < n; t++) {
      tdm_vec3 c[3];
      dem_mesh_triangle(m, t, c, &normal);
      double distance = distance_by_projection(c, x);
      least = fmin(least, distance);
      if (distance < range * (1 - 1e-12)) {
        ck_assert_int_lt(k, found);
        ck_assert_int_eq(near[k++], t);
      }
    }
    ck_assert_int_eq(k, found);
    all += found;
    ck_relative(dem_mesh_gap(m, x, &normal), least, 1e-12);
    ck_near(tdm_norm(normal), 1, 1e-14);
    ck_near(dem_mesh_gap(m, tdm_axpy(-0.5 * least, normal, x), &normal), 0.5 * least, 1e-12);
    int few[2];
    ck_assert_int_eq(dem_mesh_near(m, x, range, few, 2), found);
  }
  ck_assert_int_gt(all, 10000);
  dem_mesh_destroy(&m);
}
END_TEST

/* ---- a meshed plane ---- */

enum { GRID = 12 };

/* A square [-6, 6]^2 in triangles of all shapes: vertices on a grid of quarters moved inside it, diagonals either way.
 * Mapped by `to_world` (columns); coordinates are binary fractions, so exact in float32. */
static dem_mesh *meshed_plane(tdm_mat3 to_world, bool turned) {
  tdm_stl s = {0};
  tdm_vec3 at[GRID + 1][GRID + 1];
  state = 11;
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
  state = 3;
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
  state = 17;
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
  state = 5;
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
  state = 13;
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

/* ---- size ---- */

TEST_MAIN("dem_mesh", test_text, test_binary, test_odd_files, test_bad_files, test_report_closed, test_report_faults,
          test_near, test_plane, test_inclined_plane, test_rounded_plane, test_passes, test_convex, test_sharp_edge,
          test_fan, test_concave, test_candidates, test_rough, test_drum, test_drum_corner, test_tight_drum,
          test_drum_outside, test_cracks)
