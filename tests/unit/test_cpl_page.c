/* The viewer's page: what it is shown as bytes, histories read on while they grow, pages of folders of any kind. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/page/channels.h"
#include "coupler/page/pack.h"
#include "tests/browser/invented.h"
#include "tests/command.h"
#include "tests/test_main.h"

#include <math.h>
#include <string.h>

/* ---- bytes ---- */

static double from_half(uint16_t h) {
  const int exponent = h >> 10 & 31, fraction = h & 1023;
  const double size = exponent ? ldexp(1024 + fraction, exponent - 25) : ldexp(fraction, -24);
  return h & 0x8000 ? -size : size;
}

START_TEST(halves_are_rounded) {
  for (int h = 0; h < 0x7c00; h++) {
    const double x = from_half((uint16_t)h), next = from_half((uint16_t)(h + 1));
    ck_assert_uint_eq(cpl_pack_half((float)x), (unsigned)h);
    ck_assert_uint_eq(cpl_pack_half((float)-x), (unsigned)h | 0x8000);
    if (h < 0x7bff) {
      ck_assert_uint_eq(cpl_pack_half((float)(x + 0.4 * (next - x))), (unsigned)h);
      ck_assert_uint_eq(cpl_pack_half((float)(x + 0.6 * (next - x))), (unsigned)h + 1);
    }
  }
  ck_assert_uint_eq(cpl_pack_half(INFINITY), 0x7c00);
  ck_assert_uint_eq(cpl_pack_half(1e9f), 0x7c00);
  ck_assert_uint_eq(cpl_pack_half(NAN), 0x7e00);
}
END_TEST

static float f32_at(const tdm_view_bytes *b, size_t at) {
  float x;
  memcpy(&x, b->data + at, sizeof x);
  return x;
}

static uint16_t u16_at(const tdm_view_bytes *b, size_t at) {
  uint16_t x;
  memcpy(&x, b->data + at, sizeof x);
  return x;
}

START_TEST(frames_come_back) {
  enum { N = 300, B = 3, L = 3, P = 5 };
  tdm_error err = {0};
  tdm_scenery scenery = {0};
  tdm_snapshot s = {0};
  tdm_view_bytes bytes = {0};
  ck_assert_int_eq(invented_scenery(&scenery, &err), TDM_OK);
  ck_assert_int_eq(invented_snapshot(&s, 0.25, N, &err), TDM_OK);
  s.velocity[7] = (tdm_vec3){1e-6, -300, 0};
  ck_assert_int_eq(cpl_pack_frame(&scenery, &s, 4, &bytes, &err), TDM_OK);
  const size_t places = 84 + 40 * B + 4 * L + 12 * P, velocities = places + 6 * N;
  ck_assert_uint_eq(bytes.size, places + 24 * N);
  ck_assert_float_eq_tol(f32_at(&bytes, 68), 300, 1e-3);
  ck_assert_float_eq_tol(f32_at(&bytes, 84 + 28 + 8), 0.8, 1e-6); /* z of the bucket: 0.7 + 0.4 t */
  ck_assert(isnan(f32_at(&bytes, 84 + 28 * B)));                  /* loads on the pit are not known */
  ck_assert_float_eq_tol(f32_at(&bytes, 84 + 28 * B + 12 + 8), (float)(-5 * (40 + 30 * sin(1.25))), 1e-3f);
  for (int i = 0; i < N; i++) {
    const double z = f32_at(&bytes, 40) + f32_at(&bytes, 52) / 65535. * u16_at(&bytes, places + 6 * (size_t)i + 4);
    ck_assert_double_eq_tol(z, s.position[i].z, f32_at(&bytes, 52) / 65535 + 1e-6);
    const double v = f32_at(&bytes, 56) * from_half(u16_at(&bytes, velocities + 6 * (size_t)i));
    ck_assert_double_eq_tol(v, s.velocity[i].x, 1e-3 * fabs(s.velocity[i].x) + 1e-9 * 300);
  }
  tdm_scenery_free(&scenery);
  tdm_snapshot_free(&s);
  tdm_view_bytes_free(&bytes);
}
END_TEST

/* NaN, infinite numbers, and nothing at all, are packed as well */
START_TEST(spoiled_frames_are_packed) {
  tdm_error err = {0};
  tdm_scenery scenery = {0};
  tdm_snapshot s = {0};
  tdm_view_bytes bytes = {0};
  ck_assert_int_eq(invented_scenery(&scenery, &err), TDM_OK);
  ck_assert_int_eq(invented_snapshot(&s, 0, 2, &err), TDM_OK);
  s.position[0] = s.velocity[0] = s.force[0] = (tdm_vec3){NAN, INFINITY, 1e300};
  s.radius[0] = 1e300;
  s.material[0] = -5, s.size_class[0] = 1000;
  ck_assert_int_eq(cpl_pack_frame(&scenery, &s, 0, &bytes, &err), TDM_OK);
  ck_assert_int_eq(cpl_pack_roster(&s, 0, &bytes, &err), TDM_OK);
  ck_assert_int_eq(invented_snapshot(&s, 0, 0, &err), TDM_OK);
  ck_assert_int_eq(cpl_pack_frame(&scenery, &s, 0, &bytes, &err), TDM_OK);
  ck_assert_int_eq(cpl_pack_roster(&s, 0, &bytes, &err), TDM_OK);
  ck_assert_uint_eq(bytes.size, 40);
  tdm_scenery_free(&scenery);
  tdm_snapshot_free(&s);
  tdm_view_bytes_free(&bytes);
}
END_TEST

/* ---- histories ---- */

START_TEST(histories_are_read_on) {
  const char *dir = directory_make();
  cpl_channels c = {0};
  tdm_view_bytes bytes = {0};
  tdm_error err = {0};
  write_file(dir, "a.csv", "time [s],x [m],y [N]\n0,1,2\n1,3,");
  write_file(dir, "time.csv", "part,time [s]\nstart,1\n");
  write_file(dir, "b.txt", "time [s],x\n0,0\n");
  ck_assert_int_eq(cpl_channels_read(&c, dir, &err), TDM_OK);
  ck_assert_int_eq(c.nfile, 2);
  ck_assert_int_eq(tdm_thin_rows(&c.file[0].thin), 1);
  write_file(dir, "a.csv", "time [s],x [m],y [N]\n0,1,2\n1,3,4\n2,5,6\n3,bad,7\n4,1,1\n");
  write_file(dir, "0.csv", "time [s],q [J]\n");
  ck_assert_int_eq(cpl_channels_read(&c, dir, &err), TDM_OK);
  ck_assert_int_eq(c.nfile, 3);
  ck_assert_str_eq(c.file[0].file, "a.csv");
  ck_assert_int_eq(tdm_thin_rows(&c.file[0].thin), 3);
  ck_assert_int_eq(cpl_channels_pack(&c, 0, &bytes, &err), TDM_OK);
  ck_assert_uint_eq(bytes.size, 16 + 4 * 3 * 3);
  ck_assert_float_eq(f32_at(&bytes, 16 + 4 * 2), 2);     /* the last time */
  ck_assert_float_eq(f32_at(&bytes, 16 + 4 * 3 * 2), 2); /* the second column's first value */
  json_t *names = cpl_channels_to_json(&c);
  ck_assert_str_eq(json_string_value(json_array_get(json_object_get(json_array_get(names, 0), "names"), 1)), "y [N]");
  ck_assert_uint_eq(json_array_size(json_object_get(json_array_get(names, 1), "names")), 0);
  json_decref(names);
  ck_assert_int_eq(cpl_channels_read(&c, "/nowhere", &err), TDM_ERR_FILE);
  cpl_channels_free(&c);
  tdm_view_bytes_free(&bytes);
  directory_remove(dir);
}
END_TEST

/* ---- tandem view ---- */

static int count_of(const char *dir, const char *what) {
  char line[512];
  snprintf(line, sizeof line, "grep -o '%s' %s/view.html | wc -l", what, dir);
  ck_assert_int_eq(command("sh -c \"%s\"", line), 0);
  return atoi(command_output);
}

START_TEST(pages_of_any_folder) {
  char run[256];
  tdm_error err = {0};
  const char *dir = directory_make();
  snprintf(run, sizeof run, "%s/run", dir);
  ck_assert_int_eq(invented_run(run, 400, 30, &err), TDM_OK);
  ck_assert_int_eq(command("tandem view %s", run), 0);
  ck_assert_int_eq(count_of(run, "id=.frame[0-9]*"), 30);
  ck_assert_int_eq(count_of(run, "id=.roster[0-9]*"), 1);
  /* within a budget, with a note */
  ck_assert_int_eq(command("tandem view %s --budget 0.1", run), 0);
  expect_output("Every");
  ck_assert_int_lt(count_of(run, "id=.frame[0-9]*"), 12);
  ck_assert_int_gt(count_of(run, "id=.frame[0-9]*"), 5);
  ck_assert_int_eq(count_of(run, "so that the page stays below"), 1);
  /* another file; the folder elsewhere; a run that was killed */
  ck_assert_int_eq(command("mv %s %s2", run, run), 0);
  ck_assert_int_eq(command("truncate -s -1000 %s2/frames.tdv", run), 0);
  ck_assert_int_eq(command("tandem view %s2 --out %s/page.html", run, dir), 0);
  expect_output("29 frames");
  ck_assert(is_there(dir, ".", "page.html"));
  ck_assert_int_eq(command("rm %s2/summary.json", run), 0);
  ck_assert_int_eq(command("tandem view %s2", run), 0);
  snprintf(run + strlen(run), 8, "2");
  ck_assert_int_eq(count_of(run, "ends inside a frame"), 1);
  ck_assert_int_eq(count_of(run, "no summary.json"), 1);
  directory_remove(dir);
}
END_TEST

START_TEST(folders_without_anything) {
  const char *dir = directory_make();
  ck_assert_int_eq(command("tandem view %s", dir), 1);
  expect_output("output.particles_interval");
  ck_assert(!is_there(dir, ".", "view.html"));
  ck_assert_int_eq(command("tandem view %s/none", dir), 1);
  expect_output("name the result directory of a run");
  ck_assert_int_eq(command("tandem view"), 2);
  ck_assert_int_eq(command("tandem view %s --budget much", dir), 2);
  ck_assert_int_eq(command("tandem run %s --budget 1", dir), 2);
  write_file(dir, "frames.tdv", "not frames at all, and more than a head");
  ck_assert_int_eq(command("tandem view %s", dir), 1);
  expect_output("frames.tdv");
  write_file(dir, "a.csv", "time [s],x [m]\n0,1\n");
  ck_assert_int_eq(command("tandem view %s --out /nowhere/page.html", dir), 1);
  expect_output("/nowhere/page.html: cannot be written");
  directory_remove(dir);
}
END_TEST

TEST_MAIN("page", halves_are_rounded, frames_come_back, spoiled_frames_are_packed, histories_are_read_on,
          pages_of_any_folder, folders_without_anything)
