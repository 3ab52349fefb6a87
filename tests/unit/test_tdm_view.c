/* What there is to see: sceneries and snapshots as bytes and in files, whole, cut off and spoiled. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/view/frames.h"
#include "tests/test_main.h"

#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static tdm_scenery a_scenery(void) {
  tdm_scenery s = {.gravity = {0, 0, -9.81}};
  tdm_view_body ground = {.name = "ground", .dem = true, .still = true}, bucket = {.name = "bucket", .mbd = true};
  tdm_view_polygon face = {
      .body = 1, .solid = true, .ncorner = 4, .corner = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.1}}};
  ck_assert_int_eq(tdm_scenery_add_body(&s, &ground, NULL), TDM_OK);
  ck_assert_int_eq(tdm_scenery_add_body(&s, &bucket, NULL), TDM_OK);
  for (int k = 0; k < 50; k++)
    ck_assert_int_eq(tdm_scenery_add_polygon(&s, &face, NULL), TDM_OK);
  ck_assert_int_eq(tdm_scenery_add_line(&s, "hoist", TDM_VIEW_LINE_cable, NULL), TDM_OK);
  ck_assert_int_eq(tdm_scenery_add_line(&s, "hinge", TDM_VIEW_LINE_joint, NULL), TDM_OK);
  ck_assert_int_eq(tdm_scenery_add_material(&s, "gravel", NULL), TDM_OK);
  ck_assert_int_eq(tdm_scenery_add_edge(&s, 0.0625, NULL), TDM_OK);
  return s;
}

static tdm_snapshot a_snapshot(double time, int nparticle) {
  tdm_snapshot s = {0};
  ck_assert_int_eq(tdm_snapshot_resize(&s, 2, 2, 0, nparticle, NULL), TDM_OK);
  s.time = time;
  for (int k = 0; k < 2; k++)
    s.pose[k] = (tdm_pose){{k, 2, 3}, {1, 0, 0, 0}};
  for (int k = 0; k < 3; k++)
    ck_assert_int_eq(tdm_snapshot_add_point(&s, (tdm_vec3){k, 0.5, 0}, NULL), TDM_OK);
  tdm_snapshot_end_line(&s, 0);
  ck_assert_int_eq(tdm_snapshot_add_point(&s, (tdm_vec3){9, 9, 9}, NULL), TDM_OK);
  tdm_snapshot_end_line(&s, 1);
  for (int i = 0; i < nparticle; i++) {
    s.id[i] = 3 * i;
    s.material[i] = s.size_class[i] = i % 2;
    s.radius[i] = 0.01 * i;
    s.position[i] = s.velocity[i] = s.spin[i] = s.force[i] = s.born[i] = (tdm_vec3){i, -i, 0.1 * i};
  }
  for (int k = 0; k < nparticle / 2; k++) {
    const tdm_view_contact contact = {3 * k, k % 2 ? -1 : 3 * k + 3, {k, 0, 1}, {k, 0.5, 2}, 0.25 * k};
    ck_assert_int_eq(tdm_snapshot_add_contact(&s, &contact, NULL), TDM_OK);
  }
  return s;
}

static void expect_same(const tdm_snapshot *a, const tdm_snapshot *b, double off) {
  ck_assert_double_eq(a->time, b->time);
  ck_assert_int_eq(a->nparticle, b->nparticle);
  ck_assert_int_eq(a->npoint, b->npoint);
  ck_assert_int_eq(a->line_end[0], b->line_end[0]);
  ck_assert_double_eq(a->pose[1].position.x, b->pose[1].position.x);
  for (int i = 0; i < a->nparticle; i++) {
    ck_assert_int_eq(a->id[i], b->id[i]);
    ck_assert_double_le(fabs(a->radius[i] - b->radius[i]), off * (1 + i));
    ck_assert_double_le(fabs(a->born[i].z - b->born[i].z), off * (1 + i));
  }
  ck_assert_int_eq(a->ncontact, b->ncontact);
  for (int k = 0; k < a->ncontact; k++) { /* numbers that single precision has, too */
    ck_assert_int_eq(a->contact[k].particle, b->contact[k].particle);
    ck_assert_int_eq(a->contact[k].other, b->contact[k].other);
    ck_assert_double_eq(a->contact[k].from.x, b->contact[k].from.x);
    ck_assert_double_eq(a->contact[k].to.y, b->contact[k].to.y);
    ck_assert_double_eq(a->contact[k].force, b->contact[k].force);
  }
}

START_TEST(bytes_come_back) {
  for (int single = 0; single < 2; single++) {
    tdm_scenery a = a_scenery(), b = {0};
    tdm_snapshot s = a_snapshot(0.25, 200), t = {0};
    tdm_view_bytes bytes = {0};
    tdm_error err = {0};
    ck_assert_int_eq(tdm_scenery_encode(&a, single, &bytes, &err), TDM_OK);
    size_t first = bytes.size;
    ck_assert_int_eq(tdm_snapshot_encode(&s, single, &bytes, &err), TDM_OK);
    ck_assert_msg(tdm_scenery_decode(&b, bytes.data, bytes.size, &err) == TDM_OK, "%s", err.message);
    ck_assert_msg(tdm_snapshot_decode(&t, bytes.data + first, bytes.size - first, &err) == TDM_OK, "%s", err.message);
    ck_assert_int_eq(tdm_snapshot_check(&t, &b, &err), TDM_OK);
    ck_assert_int_eq(b.npolygon, 50);
    ck_assert(b.polygon[49].solid && b.body[0].still && !b.body[1].dem && b.body[1].mbd);
    ck_assert_str_eq(b.line[0].name, "hoist");
    ck_assert_str_eq(b.material[0].name, "gravel");
    ck_assert_double_eq(b.edge[0], 0.0625);
    expect_same(&s, &t, single ? 1e-7 : 0);
    tdm_scenery_free(&a);
    tdm_scenery_free(&b);
    tdm_snapshot_free(&s);
    tdm_snapshot_free(&t);
    tdm_view_bytes_free(&bytes);
  }
}
END_TEST

/* Whatever bytes come: a status, never a crash. Every byte of both records is spoiled once, and each length cut. */
START_TEST(spoiled_bytes_are_refused) {
  tdm_scenery a = a_scenery(), b = {0};
  tdm_snapshot s = a_snapshot(0.25, 3), t = {0};
  for (int kind = 0; kind < 2; kind++) {
    tdm_view_bytes bytes = {0};
    if (kind)
      tdm_snapshot_encode(&s, true, &bytes, NULL);
    else
      tdm_scenery_encode(&a, true, &bytes, NULL);
    for (size_t i = 0; i < bytes.size; i++) {
      tdm_error err = {0};
      bytes.data[i] ^= 0xa5;
      tdm_scenery_decode(&b, bytes.data, bytes.size, NULL);
      tdm_snapshot_decode(&t, bytes.data, bytes.size, NULL);
      bytes.data[i] ^= 0xa5;
      tdm_status status =
          kind ? tdm_snapshot_decode(&t, bytes.data, i, &err) : tdm_scenery_decode(&b, bytes.data, i, &err);
      ck_assert_int_ne(status, TDM_OK);
      ck_assert_int_eq(err.status, status);
    }
    tdm_view_bytes_free(&bytes);
  }
  tdm_scenery_free(&a);
  tdm_scenery_free(&b);
  tdm_snapshot_free(&s);
  tdm_snapshot_free(&t);
}
END_TEST

START_TEST(a_file_of_a_killed_run_shows_what_there_is) {
  const char *dir = TANDEM_TEST_DIR "/view", *path = TANDEM_TEST_DIR "/view/" TDM_FRAMES_FILE;
  tdm_scenery a = a_scenery();
  tdm_view_bytes bytes = {0};
  tdm_error err = {0};
  mkdir(dir, 0777);
  FILE *f = fopen(path, "wb");
  ck_assert_int_eq(tdm_frames_write_scenery(f, path, &a, &bytes, &err), TDM_OK);
  for (int k = 0; k < 70; k++) {
    tdm_snapshot s = a_snapshot(0.5 * k, k);
    tdm_frame_place place;
    ck_assert_int_eq(tdm_frames_write(f, path, &s, &place, &bytes, &err), TDM_OK);
    ck_assert_int_eq(tdm_frames_end(f, path, &place, &err), TDM_OK);
    tdm_snapshot_free(&s);
  }
  long size = ftell(f);
  fclose(f);
  ck_assert_int_eq(truncate(path, size - 7), 0);
  tdm_frames frames;
  tdm_snapshot t = {0}, expected = a_snapshot(34, 68);
  ck_assert_msg(tdm_frames_open(&frames, dir, &err) == TDM_OK, "%s", err.message);
  ck_assert(frames.cut);
  ck_assert_int_eq(frames.count, 69);
  ck_assert_double_eq(frames.time[68], 34);
  ck_assert_msg(tdm_frames_load(&frames, 68, &t, &err) == TDM_OK, "%s", err.message);
  expect_same(&expected, &t, 1e-7);
  tdm_frames_close(&frames);
  tdm_snapshot_free(&t);
  tdm_snapshot_free(&expected);
  tdm_scenery_free(&a);
  tdm_view_bytes_free(&bytes);

  f = fopen(path, "r+b");
  ck_assert_int_eq(fseek(f, 3, SEEK_SET), 0);
  fputs("nothing of the kind", f);
  fclose(f);
  ck_assert_int_eq(tdm_frames_open(&frames, dir, &err), TDM_ERR_FILE);
  ck_assert_ptr_nonnull(strstr(err.message, TDM_FRAMES_FILE));
  tdm_frames_close(&frames);
  unlink(path);
  err = (tdm_error){0};
  ck_assert_int_eq(tdm_frames_open(&frames, dir, &err), TDM_ERR_FILE);
  ck_assert_ptr_nonnull(strstr(err.message, "particles_interval"));
  tdm_frames_close(&frames);
}
END_TEST

TEST_MAIN("view", bytes_come_back, spoiled_bytes_are_refused, a_file_of_a_killed_run_shows_what_there_is)
