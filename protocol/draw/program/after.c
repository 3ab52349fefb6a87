/* Pictures and animations after a run: see after.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/draw/program/after.h"

#include "protocol/app/command_line.h"
#include "protocol/draw/color.h"
#include "protocol/draw/program/painter.h"
#include "protocol/parameters/load.h"
#include "protocol/results/mark.h"
#include "protocol/results/results.h"
#include "protocol/view/frames.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

enum { LOOKED_AT = 40 }; /* snapshots by which bounds and colours are chosen */

typedef struct {
  tdm_arguments given;
  const char *times, *view, *out, *fps, *size;
  bool all;
} arguments;

/* The pictures of one folder. */
typedef struct {
  char dir[4096]; /* of the file */
  tdm_frames frames;
  tdm_picture picture;
  tdm_painter painter;
  tdm_frame frame;
  tdm_snapshot snapshot;
} job;

/* ---- what to draw ---- */

static tdm_status open_frames(job *j, const char *name, tdm_error *err) {
  struct stat s;
  if (stat(name, &s) == 0 && S_ISREG(s.st_mode)) {
    const char *slash = strrchr(name, '/');
    snprintf(j->dir, sizeof j->dir, "%.*s", slash ? (int)(slash - name) : 1, slash ? name : ".");
    tdm_frames_open_file(&j->frames, name, err);
  } else {
    snprintf(j->dir, sizeof j->dir, "%s", name);
    tdm_frames_open(&j->frames, name, err);
  }
  if (err->status == TDM_OK && j->frames.count == 0)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: has no snapshot yet", j->frames.path);
  if (err->status == TDM_OK && j->frames.cut)
    fprintf(stderr, "tandem: %s ends within a snapshot, which is left out: the run goes on, or was ended\n",
            j->frames.path);
  return err->status;
}

/* The scene's own pictures, output.pictures, as a list (new reference); an empty one when there is no scene. */
static json_t *scene_pictures(const char *dir) {
  tdm_error none = {0};
  json_t *scene = tdm_scene_as_run(tdm_results_read(dir, "scene.json", &none)), *list = json_array();
  json_t *own = json_object_get(json_object_get(scene, "output"), "pictures");
  if (json_is_array(own))
    json_array_extend(list, own);
  else if (json_is_object(own))
    json_array_append(list, own);
  json_decref(scene);
  return list;
}

/* The picture of the scene by that name (NULL: the first, if there is one); borrowed. */
static json_t *named(json_t *list, const char *name) {
  size_t i;
  json_t *p;
  json_array_foreach(list, i, p) if (!name || strcmp(json_string_value(json_object_get(p, "name"))
                                                         ? json_string_value(json_object_get(p, "name"))
                                                         : "",
                                                     name) == 0) return p;
  return NULL;
}

/* With --view: a picture of the scene by its name, one of the words that a view may be, or JSON. Without: the scene's
 * first picture, or in space. New reference. */
static json_t *choose_picture(const job *j, const char *view) {
  json_t *list = scene_pictures(j->dir), *own = named(list, view), *picture;
  if (own)
    picture = json_deep_copy(own);
  else {
    json_t *first = named(list, NULL), *value = view ? json_loads(view, JSON_DECODE_ANY, NULL) : NULL;
    picture = view && first ? json_deep_copy(first) : json_object();
    json_object_del(picture, "min");
    json_object_del(picture, "max");
    json_object_del(picture, "size");
    json_object_set_new(picture, "view", value ? value : json_string(view ? view : "space"));
  }
  json_object_del(picture, "name");
  json_decref(list);
  return picture;
}

static tdm_status read_picture(job *j, const arguments *a, tdm_error *err) {
  tdm_scene scene = {.root = choose_picture(j, a->view)};
  tdm_error own = {0};
  for (int i = 0; i < a->given.nset && own.status == TDM_OK; i++)
    tdm_scene_set(&scene, a->given.set[i], &own);
  if (own.status == TDM_OK)
    tdm_picture_read(&j->picture, scene.root, "", &own);
  json_decref(scene.root);
  if (own.status != TDM_OK)
    tdm_fail(err, own.status, NULL, "%s%s%s", own.path, *own.path ? ": " : "", own.message);
  return err->status;
}

/* Bounds and colours that suit the whole run. */
static tdm_status look_at_all(job *j, tdm_error *err) {
  int n = j->frames.count, every = (n + LOOKED_AT - 1) / LOOKED_AT;
  j->frame = (tdm_frame){.bounds = tdm_bounds_empty(), .range = {INFINITY, -INFINITY}};
  const tdm_vec3 up = tdm_scene_up(&j->frames.scenery);
  for (int i = 0; i < n && err->status == TDM_OK; i += every)
    if (tdm_frames_load(&j->frames, i, &j->snapshot, err) == TDM_OK)
      tdm_content_bounds(&j->frame.bounds, &j->picture, &j->frames.scenery, &j->snapshot, i == 0 || i + every >= n,
                         err);
  const tdm_camera camera = tdm_camera_make(&j->picture.view, &j->frame.bounds, up, 1.4);
  for (int i = 0; i < n && err->status == TDM_OK; i += every)
    if (tdm_frames_load(&j->frames, i, &j->snapshot, err) == TDM_OK)
      tdm_color_widen(j->frame.range, j->picture.color, &j->snapshot, &camera, up, err);
  if (err->status == TDM_OK && tdm_color_of_contacts(j->picture.color) && j->frame.range[0] > j->frame.range[1])
    tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
             "%s: no contacts in these frames; they are there after a run with "
             "output.contacts true, or pictures whose color is \"contact_force\"",
             j->frames.path);
  return err->status;
}

static tdm_status begin(job *j, const arguments *a, const char *command, tdm_error *err) {
  if (a->given.nword != 1)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s: name one result directory", command);
  if (open_frames(j, a->given.word[0], err) != TDM_OK || read_picture(j, a, err) != TDM_OK ||
      look_at_all(j, err) != TDM_OK)
    return err->status;
  return tdm_painter_scenery(&j->painter, &j->frames.scenery, err);
}

static void finish(job *j) {
  tdm_painter_free(&j->painter);
  tdm_snapshot_free(&j->snapshot);
  tdm_frames_close(&j->frames);
}

static tdm_status draw_one(job *j, int k, const char *path, const int size[2], tdm_error *err) {
  cairo_surface_t *sheet = NULL;
  if (tdm_frames_load(&j->frames, k, &j->snapshot, err) == TDM_OK &&
      tdm_paint(&j->painter, &j->picture, &j->frames.scenery, &j->snapshot, &j->frame, size, &sheet, err) == TDM_OK)
    tdm_sheet_write(sheet, path, err);
  if (sheet)
    cairo_surface_destroy(sheet);
  return err->status;
}

/* ---- tandem draw ---- */

/* the snapshot nearest to a time */
static int nearest(const tdm_frames *f, double t) {
  int best = 0;
  for (int k = 1; k < f->count; k++)
    if (fabs(f->time[k] - t) < fabs(f->time[best] - t))
      best = k;
  return best;
}

/* Mark the snapshots of --times. */
static tdm_status choose_times(const job *j, const char *times, bool *wanted, tdm_error *err) {
  for (const char *p = times; *p;) {
    char *end;
    double t = strtod(p, &end), last = j->frames.time[j->frames.count - 1];
    if (end == p || (*end && *end != ',') || !(t >= 0))
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "draw: --times %s: give times [s] with commas between them", times);
    if (t > last * (1 + 1e-9) + 1e-12)
      fprintf(stderr, "tandem: --times: %g s is after the last snapshot, %g s: there is no such picture\n", t, last);
    else
      wanted[nearest(&j->frames, t)] = true;
    p = end + (*end == ',');
  }
  return TDM_OK;
}

/* PREFIX_NNN.png; of a file NAME.frame, NAME.png. */
static void picture_path(const job *j, const arguments *a, int number, char *out, size_t size) {
  const char *given = a->given.word[0], *frame = strstr(given, ".frame");
  if (!a->out && frame && !frame[6])
    snprintf(out, size, "%.*s.png", (int)(frame - given), given);
  else if (a->out)
    snprintf(out, size, "%s_%03d.png", a->out, number);
  else
    snprintf(out, size, "%s/drawn_%03d.png", j->dir, number);
}

static tdm_status draw_wanted(job *j, const arguments *a, const bool *wanted, tdm_error *err) {
  const int own[2] = {0, 0};
  int number = 0;
  for (int k = 0; k < j->frames.count && err->status == TDM_OK; k++) {
    char path[4352];
    if (!wanted[k])
      continue;
    picture_path(j, a, number++, path, sizeof path);
    if (!a->out)
      tdm_mark_add_in(j->dir, strrchr(path, '/') ? strrchr(path, '/') + 1 : path);
    if (draw_one(j, k, path, own, err) == TDM_OK)
      printf("%s: t = %g s\n", path, j->frames.time[k]);
  }
  if (err->status == TDM_OK && number == 0)
    tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "draw: nothing was drawn: no snapshot at these times");
  return err->status;
}

tdm_status draw_again(int argc, char **argv, tdm_error *err) {
  arguments a = {0};
  job j = {0};
  const tdm_option options[] = {{.name = "--times", .value = &a.times},
                                {.name = "--view", .value = &a.view},
                                {.name = "--out", .value = &a.out},
                                {.name = "--set"},
                                {.name = "--all", .flag = &a.all}};
  if (tdm_arguments_read(&a.given, options, 5, "tandem", argc, argv, err) == TDM_OK &&
      begin(&j, &a, "draw", err) == TDM_OK) {
    bool *wanted = calloc((size_t)j.frames.count, sizeof *wanted);
    if (!wanted)
      tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    else if (!a.times || choose_times(&j, a.times, wanted, err) == TDM_OK) {
      for (int k = 0; k < j.frames.count; k++)
        wanted[k] |= a.all || (!a.times && k == j.frames.count - 1);
      draw_wanted(&j, &a, wanted, err);
    }
    free(wanted);
  }
  finish(&j);
  tdm_arguments_free(&a.given);
  return err->status;
}

/* ---- tandem movie ---- */

/* --size WxH, even as video wants it; else the view's own made even */
static tdm_status movie_size(const job *j, const arguments *a, int size[2], tdm_error *err) {
  char rest;
  if (a->size && (sscanf(a->size, "%dx%d%c", &size[0], &size[1], &rest) != 2 || size[0] < 64 || size[1] < 64 ||
                  size[0] > 4096 || size[1] > 4096))
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "movie: --size %s: give WIDTHxHEIGHT, 64 to 4096 pixels each",
                    a->size);
  if (!a->size) {
    double low[2] = {0, 0}, high[2] = {1, 1};
    if (j->picture.view.flat)
      tdm_camera_limits(&j->picture.view, &j->frame.bounds, low, high);
    const tdm_layout layout = tdm_layout_make(&j->picture, j->picture.size, low, high);
    size[0] = layout.width;
    size[1] = layout.height;
  }
  size[0] -= size[0] % 2;
  size[1] -= size[1] % 2;
  return TDM_OK;
}

static tdm_status movie_rate(const arguments *a, double *fps, tdm_error *err) {
  char *end = NULL;
  *fps = a->fps ? strtod(a->fps, &end) : 25;
  if (!(*fps > 0 && *fps <= 240) || (end && *end))
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "movie: --fps %s: give pictures a second, more than 0 and at most 240",
                    a->fps);
  return TDM_OK;
}

/* Its exit status; 127: there is none. */
static int run_ffmpeg(const char *pattern, double fps, const char *out) {
  char rate[32];
  int status;
  snprintf(rate, sizeof rate, "%g", fps);
  pid_t pid = fork();
  if (pid == 0) {
    tdm_release_signals();
    execlp("ffmpeg", "ffmpeg", "-y", "-nostdin", "-loglevel", "error", "-framerate", rate, "-i", pattern, "-pix_fmt",
           "yuv420p", "-crf", "18", "-movflags", "+faststart", out, (char *)NULL);
    _exit(127);
  }
  while (pid > 0 && waitpid(pid, &status, 0) < 0)
    if (errno != EINTR)
      return -1;
  return pid > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static tdm_status make_movie(const job *j, const char *frames, double fps, const char *out, tdm_error *err) {
  char pattern[4200], path[4300];
  int n = j->frames.count;
  snprintf(pattern, sizeof pattern, "%s/%%06d.png", frames);
  int status = run_ffmpeg(pattern, fps, out);
  if (status == 127)
    return tdm_fail(err, TDM_ERR_FILE, NULL,
                    "no animation: ffmpeg is not installed (Debian package ffmpeg); its %d pictures are in %s", n,
                    frames);
  if (status != 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "no animation: ffmpeg failed on %s; the pictures are in %s", out, frames);
  for (int k = 0; k < n; k++) {
    snprintf(path, sizeof path, "%s/%06d.png", frames, k);
    unlink(path);
  }
  rmdir(frames);
  printf("%s: %d pictures, %g a second: %.3g s of animation for %.6g s of the run\n", out, n, fps, n / fps,
         j->frames.time[n - 1] - j->frames.time[0]);
  return TDM_OK;
}

tdm_status draw_movie(int argc, char **argv, tdm_error *err) {
  arguments a = {0};
  job j = {0};
  int size[2] = {0, 0};
  double fps = 25;
  char frames[4150], out[4150];
  const tdm_option options[] = {{.name = "--view", .value = &a.view},
                                {.name = "--out", .value = &a.out},
                                {.name = "--set"},
                                {.name = "--fps", .value = &a.fps},
                                {.name = "--size", .value = &a.size}};
  if (tdm_arguments_read(&a.given, options, 5, "tandem", argc, argv, err) == TDM_OK &&
      movie_rate(&a, &fps, err) == TDM_OK && begin(&j, &a, "movie", err) == TDM_OK &&
      movie_size(&j, &a, size, err) == TDM_OK) {
    snprintf(out, sizeof out, "%s%s", a.out ? a.out : j.dir, a.out ? "" : "/movie.mp4");
    snprintf(frames, sizeof frames, "%s.frames", out);
    if (!a.out)
      tdm_mark_add_in(j.dir, "movie.mp4");
    if (tdm_make_directory(frames, err) == TDM_OK) {
      for (int k = 0; k < j.frames.count && err->status == TDM_OK; k++) {
        char path[4200];
        snprintf(path, sizeof path, "%s/%06d.png", frames, k);
        draw_one(&j, k, path, size, err);
        if (isatty(2))
          fprintf(stderr, "\r%d of %d pictures%s", k + 1, j.frames.count, k + 1 == j.frames.count ? "\n" : "");
      }
      if (err->status == TDM_OK)
        make_movie(&j, frames, fps, out, err);
    }
  }
  finish(&j);
  tdm_arguments_free(&a.given);
  return err->status;
}
