/* A result directory of a run that never was: see invented.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/browser/invented.h"

#include <errno.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

enum { GROUND, BUCKET, CARRIAGE, NBODY };
static const double interval = 0.01; /* between frames [s] */

static tdm_status add_body(tdm_scenery *s, const char *name, bool dem, bool mbd, bool still, tdm_error *err) {
  tdm_view_body body = {.dem = dem, .mbd = mbd, .still = still, .marked = !dem};
  snprintf(body.name, sizeof body.name, "%s", name);
  return tdm_scenery_add_body(s, &body, err);
}

static tdm_status add_face(tdm_scenery *s, int body, bool solid, const double corner[4][3], tdm_error *err) {
  tdm_view_polygon face = {.body = body, .solid = solid, .ncorner = 4};
  for (int c = 0; c < 4; c++)
    face.corner[c] = (tdm_vec3){corner[c][0], corner[c][1], corner[c][2]};
  return tdm_scenery_add_polygon(s, &face, err);
}

/* A box without a lid: the bottom, then the four sides. */
static tdm_status add_tub(tdm_scenery *s, int body, bool solid, double x, double y, double low, double high,
                          tdm_error *err) {
  const double corner[4][2] = {{-x, -y}, {x, -y}, {x, y}, {-x, y}};
  const double bottom[4][3] = {{-x, -y, low}, {x, -y, low}, {x, y, low}, {-x, y, low}};
  add_face(s, body, solid, bottom, err);
  for (int k = 0; k < 4; k++) {
    const double *a = corner[k], *b = corner[(k + 1) % 4];
    const double side[4][3] = {{a[0], a[1], low}, {b[0], b[1], low}, {b[0], b[1], high}, {a[0], a[1], high}};
    add_face(s, body, solid, side, err);
  }
  return err->status;
}

tdm_status invented_scenery(tdm_scenery *s, tdm_error *err) {
  s->gravity = (tdm_vec3){0, 0, -9.81};
  if (add_body(s, "pit", true, false, true, err) != TDM_OK || add_body(s, "bucket", true, true, false, err) != TDM_OK ||
      add_body(s, "carriage", false, true, false, err) != TDM_OK ||
      add_tub(s, GROUND, false, 1.2, 1.2, -0.05, 0.5, err) != TDM_OK ||
      add_tub(s, BUCKET, true, 0.3, 0.25, -0.15, 0.2, err) != TDM_OK)
    return err->status;
  tdm_scenery_add_line(s, "hoist", TDM_VIEW_LINE_cable, err);
  tdm_scenery_add_line(s, "hinge", TDM_VIEW_LINE_joint, err);
  tdm_scenery_add_line(s, "buffer", TDM_VIEW_LINE_spring, err);
  tdm_scenery_add_material(s, "gravel", err);
  tdm_scenery_add_material(s, "<b>sand</b></script>", err);
  return tdm_scenery_add_edge(s, 0.02, err);
}

static void place_bodies(tdm_snapshot *s, double t, tdm_error *err) {
  const double angle = 0.5 * sin(2 * M_PI * t), lift = 0.7 + 0.4 * t;
  const tdm_vec3 bucket = {0.3 * sin(3 * t), 0, lift}, carriage = {0.3 * sin(3 * t), 0, lift + 0.9};
  s->pose[GROUND] = (tdm_pose){{0, 0, 0}, {1, 0, 0, 0}};
  s->pose[BUCKET] = (tdm_pose){bucket, tdm_quat_from_rotvec((tdm_vec3){0, angle, 0})};
  s->pose[CARRIAGE] = (tdm_pose){carriage, {1, 0, 0, 0}};
  tdm_snapshot_add_point(s, carriage, err);
  tdm_snapshot_add_point(s, bucket, err);
  tdm_snapshot_end_line(s, 0);
  tdm_snapshot_add_point(s, bucket, err);
  tdm_snapshot_end_line(s, 1);
  tdm_snapshot_add_point(s, (tdm_vec3){1.2, 0, 0.4}, err);
  tdm_snapshot_add_point(s, (tdm_vec3){1.2 - 0.2 * t, 0, 0.9}, err);
  tdm_snapshot_end_line(s, 2);
  for (int i = 0; i < s->nforce; i++)
    s->force_on[i] = i < 5 ? (tdm_vec3){NAN, NAN, NAN} : (tdm_vec3){0, 0, -40 - 30 * sin(5 * t)};
}

tdm_status invented_snapshot(tdm_snapshot *s, double t, int n, tdm_error *err) {
  const int side = (int)ceil(cbrt(n)) + 1;
  const double step = 2.0 / side;
  if (tdm_snapshot_resize(s, NBODY, 3, 10, n, err) != TDM_OK)
    return err->status;
  s->time = t;
  place_bodies(s, t, err);
  for (int i = 0; i < n; i++) {
    const int a = i % side, b = i / side % side, c = i / side / side;
    const double wave = 0.15 * sin(4 * t + 3. * a / side);
    s->id[i] = 7 * i;
    s->material[i] = i % 2;
    s->size_class[i] = i % 3 ? 0 : 1;
    s->radius[i] = (i % 3 ? 0.45 : 0.35) * step;
    s->born[i] = (tdm_vec3){-0.95 + step * a, -0.95 + step * b, 0.5 * step * c};
    s->position[i] = tdm_add(s->born[i], (tdm_vec3){0.05 * wave, 0, wave + 0.15});
    s->velocity[i] = (tdm_vec3){0.2 * cos(4 * t + 3. * a / side), 0, 0.6 * cos(4 * t + 3. * a / side)};
    s->spin[i] = (tdm_vec3){0, 1 + a, 0};
    s->force[i] = (tdm_vec3){0, 0, 0.1 * (side - c)};
  }
  if (n > 0)
    s->position[0] = (tdm_vec3){0, -0.9, 0.1 + 0.5 * t};
  return err->status;
}

/* ---- files ---- */

static FILE *open_file(const char *dir, const char *name, tdm_error *err) {
  char path[4352];
  snprintf(path, sizeof path, "%s/%s", dir, name);
  FILE *f = fopen(path, "wb");
  if (!f)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: %s", path, strerror(errno));
  return f;
}

static tdm_status write_histories(const char *dir, int nframe, tdm_error *err) {
  FILE *body = open_file(dir, "body_bucket.csv", err), *mbd = open_file(dir, "mbd.csv", err);
  if (body && mbd) {
    fputs("time [s],x [m],z [m],vz [m/s],fz [N],my [N m]\n", body);
    fputs("time [s],joint.hinge.angle [rad],energy.kinetic [J],body.rail.x [m]\n", mbd);
    for (int k = 0; k < 5 * nframe; k++) {
      const double t = 0.2 * interval * k;
      fprintf(body, "%.17g,%.17g,%.17g,0.4,%.17g,%.17g\n", t, 0.3 * sin(3 * t), 0.7 + 0.4 * t,
              -200 - 150 * sin(5 * t) + 9 * sin(300 * t), 4 * cos(40 * t));
      fprintf(mbd, "%.17g,%.17g,%.17g,1.25\n", t, 0.5 * sin(2 * M_PI * t), 3 * cos(2 * M_PI * t) * cos(2 * M_PI * t));
    }
  }
  if (body)
    fclose(body);
  if (mbd)
    fclose(mbd);
  return err->status;
}

tdm_status invented_run(const char *dir, int nparticle, int nframe, tdm_error *err) {
  char path[4352];
  tdm_scenery scenery = {0};
  tdm_snapshot snapshot = {0};
  tdm_view_bytes bytes = {0};
  mkdir(dir, 0777);
  FILE *frames = open_file(dir, TDM_FRAMES_FILE, err), *summary = open_file(dir, "summary.json", err);
  snprintf(path, sizeof path, "%s/%s", dir, TDM_FRAMES_FILE);
  if (frames && invented_scenery(&scenery, err) == TDM_OK)
    tdm_frames_write_scenery(frames, path, &scenery, &bytes, err);
  for (int k = 0; k < nframe && err->status == TDM_OK; k++) {
    tdm_frame_place place;
    if (invented_snapshot(&snapshot, interval * k, nparticle, err) == TDM_OK &&
        tdm_frames_write(frames, path, &snapshot, &place, &bytes, err) == TDM_OK)
      tdm_frames_end(frames, path, &place, err);
  }
  if (summary)
    fputs("{\"scene\": \"invented.json\", \"status\": \"TDM_ERR_NUMERIC\", \"error\": \"the bucket </script> burst\",\n"
          " \"wall_s\": {\"all\": 2.5}, \"error_estimate\": {\"worst\": 0.012, \"worst_body\": \"bucket\", "
          "\"unknown\": null,\n"
          "  \"bodies\": {\"bucket\": {\"position\": {\"rms\": 0.003, \"share\": 0.012, \"spread\": 0.25}}}}}\n",
          summary);
  if (frames)
    fclose(frames);
  if (summary)
    fclose(summary);
  tdm_scenery_free(&scenery);
  tdm_snapshot_free(&snapshot);
  tdm_view_bytes_free(&bytes);
  return err->status == TDM_OK ? write_histories(dir, nframe, err) : err->status;
}
