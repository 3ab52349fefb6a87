/* Meshes: STL files, topology, and the search for triangles. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_mesh_support.h"
#include "tests/test_main.h"

#include <unistd.h>

/* ---- files ---- */

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

START_TEST(test_near) {
  dem_mesh *m = soup(3000);
  int n = dem_mesh_figures(m)->triangles, near[3000], all = 0, empty = 0, below = 0;
  for (int trial = 0; trial < 300; trial++) {
    tdm_vec3 x = tdm_v3(between(-1.5, 1.5), between(-1.5, 1.5), between(-1.5, 1.5)), normal;
    double range = pow(10, between(-2, 0.2)), least = INFINITY;
    int found = dem_mesh_near(m, 0, x, range, near, 3000), k = 0;
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
    ck_assert_int_eq(dem_mesh_near(m, 0, x, range, few, 2), found);
    const tdm_vec3 r = {range, range, range};
    const int from = dem_mesh_within(m, tdm_sub(x, r), tdm_add(x, r));
    ck_assert_int_eq(from < 0 ? 0 : dem_mesh_near(m, from, x, range, near, 3000), found);
    empty += from < 0;
    below += from > 0;
  }
  ck_assert_int_gt(all, 10000);
  ck_assert(empty > 10 && below > 10);
  dem_mesh_destroy(&m);
}
END_TEST

TEST_MAIN("dem_mesh", test_text, test_binary, test_odd_files, test_bad_files, test_report_closed, test_report_faults,
          test_near)
