/* A result directory: see results.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/results/results.h"

#include "protocol/scene/input.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const char *tdm_results_path(const tdm_results *r, const char *name, char *out, size_t size) {
  snprintf(out, size, "%s/%s", r->dir, name);
  return out;
}

const char *tdm_results_claim(const tdm_results *r, const char *name, char *out, size_t size) {
  if (!r->staged)
    tdm_mark_add(&r->mark, name);
  return tdm_results_path(r, name, out, size);
}

static tdm_status cannot(const char *path, const char *what, tdm_error *err) {
  return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be %s: %s; give another directory with --out", path, what,
                  strerror(errno));
}

tdm_status tdm_check_writable(const char *file, tdm_error *err) {
  FILE *f = file ? fopen(file, "a") : NULL;
  if (file && !f)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
  if (f)
    fclose(f);
  return TDM_OK;
}

tdm_status tdm_make_directory(const char *dir, tdm_error *err) {
  char path[4096];
  if (!*dir || strlen(dir) + 256 > sizeof path)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "--out: %s", *dir ? "the name is too long" : "the name is empty");
  snprintf(path, sizeof path, "%s/", dir);
  for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
    *slash = 0;
    struct stat there;
    if (mkdir(path, 0777) != 0 && errno != EEXIST)
      return cannot(path, "made", err);
    if (stat(path, &there) == 0 && !S_ISDIR(there.st_mode))
      return tdm_fail(err, TDM_ERR_FILE, NULL,
                      "%s: cannot be the result directory, as it is a file; give another directory with --out", path);
    *slash = '/';
  }
  return TDM_OK;
}

static tdm_status refuse_scene(const tdm_results *r, const char *scene, tdm_error *err) {
  char path[4352];
  struct stat given, there;
  tdm_results_path(r, "scene.json", path, sizeof path);
  if (stat(scene, &given) == 0 && stat(path, &there) == 0 && given.st_dev == there.st_dev &&
      given.st_ino == there.st_ino)
    tdm_fail(err, TDM_ERR_FILE, NULL,
             "%s: is the scene itself, and a run writes its own scene.json there; give another directory with --out",
             path);
  return err->status;
}

static tdm_status open_log(tdm_results *r, const char *name, tdm_error *err) {
  char path[4352];
  r->log = fopen(tdm_results_claim(r, name, path, sizeof path), "we"); /* e: solver processes do not inherit it */
  return r->log ? TDM_OK : cannot(path, "written", err);
}

/* ---- the start of a run beside an earlier one's results ---- */

static const char stage[] = "start";

/* all that is written before a run has started */
static const char *const staged_files[] = {"scene.json", "summary.json", "server.log", "mbd.log", "dem.log"};
enum { NSTAGED = sizeof staged_files / sizeof staged_files[0] };

/* DIR/start, which is listed when it is ours; what an earlier start left there goes. */
static tdm_status open_stage(tdm_results *r, tdm_error *err) {
  char path[4352];
  snprintf(path, sizeof path, "%s/%s", r->home, stage);
  if (mkdir(path, 0777) != 0 && !(errno == EEXIST && tdm_mark_lists(&r->mark, stage)))
    return cannot(path, "made", err);
  tdm_mark_add(&r->mark, stage);
  snprintf(r->dir, sizeof r->dir, "%s", path);
  for (int i = 0; i < NSTAGED; i++)
    unlink(tdm_results_path(r, staged_files[i], path, sizeof path));
  r->staged = true;
  return TDM_OK;
}

/* Its files to where the results go. */
static void close_stage(tdm_results *r) {
  char from[4352], to[4352];
  for (int i = 0; i < NSTAGED; i++) {
    snprintf(to, sizeof to, "%s/%s", r->home, staged_files[i]);
    if (rename(tdm_results_path(r, staged_files[i], from, sizeof from), to) == 0)
      tdm_mark_add(&r->mark, staged_files[i]);
  }
  rmdir(r->dir);
  snprintf(r->dir, sizeof r->dir, "%s", r->home);
  r->staged = false;
}

/* ---- open and close ---- */

static void open_files(tdm_results *r, const tdm_results_def *def, tdm_error *err) {
  if (r->mark.results && !def->force && !def->beside) {
    tdm_fail(err, TDM_ERR_FILE, NULL,
             "%s: holds the results of an earlier run; give another directory with --out, %sor replace them with "
             "--force",
             def->dir, def->instead ? def->instead : "");
    return;
  }
  if (!def->log)
    return;
  if (!r->mark.results)
    tdm_mark_clear(&r->mark, def->dir); /* of a run that was refused */
  if (!r->mark.results || open_stage(r, err) == TDM_OK)
    open_log(r, def->log, err);
}

tdm_status tdm_results_open(tdm_results *r, const tdm_results_def *def, tdm_error *err) {
  *r = (tdm_results){0};
  if (tdm_make_directory(def->dir, err) != TDM_OK)
    return err->status;
  snprintf(r->home, sizeof r->home, "%s", def->dir);
  snprintf(r->dir, sizeof r->dir, "%s", def->dir);
  if ((!def->scene || refuse_scene(r, def->scene, err) == TDM_OK) &&
      tdm_mark_open(&r->mark, def->dir, def->force, err) == TDM_OK)
    open_files(r, def, err);
  if (err->status != TDM_OK)
    tdm_results_close(r);
  return err->status;
}

tdm_status tdm_results_start(tdm_results *r, tdm_error *err) {
  enum { ROOM = 1 << 16 }; /* for the summary, on a disk that will be full by then */
  static const char text[] =
      "{\"status\": \"unfinished\",\n \"error\": \"the run is under way, or was ended by force\"}";
  if (r->staged) {
    tdm_mark_clear(&r->mark, r->home);
    close_stage(r);
  }
  if (!r->mark.results)
    tdm_mark_results(&r->mark);
  FILE *f = r->log ? tdm_results_file(r, "summary.json", err) : NULL;
  if (!f)
    return err->status;
  fputs(text, f);
  for (int i = (int)sizeof text; i < ROOM; i++)
    fputc('\n', f);
  bool bad = ferror(f);
  if (fclose(f) != 0 || bad)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s/summary.json: cannot be written: %s; give another directory with --out",
             r->dir, strerror(errno));
  return err->status;
}

tdm_status tdm_results_there(const tdm_results *r, tdm_error *err) {
  if (!tdm_mark_there(&r->mark, r->home))
    tdm_fail(err, TDM_ERR_FILE, NULL,
             "%s: the result directory was removed or replaced while the run wrote into it; the run ends here",
             r->home);
  return err->status;
}

void tdm_results_close(tdm_results *r) {
  if (r->log)
    fclose(r->log);
  tdm_mark_close(&r->mark, r->home, !r->log && !r->mark.results);
  *r = (tdm_results){0};
}

/* ---- files ---- */

FILE *tdm_results_file(const tdm_results *r, const char *name, tdm_error *err) {
  char path[4352];
  FILE *f = fopen(tdm_results_claim(r, name, path, sizeof path), "we");
  if (!f)
    cannot(path, "written", err);
  else
    setvbuf(f, NULL, _IOFBF, 1 << 16);
  return f;
}

void tdm_write_row(FILE *f, double time, const double *values, int n) {
  fprintf(f, "%.12g", time);
  for (int i = 0; i < n; i++)
    if (isnan(values[i])) /* whatever its sign */
      fputs(",nan", f);
    else
      fprintf(f, ",%.17g", values[i]);
  fputc('\n', f);
}

/* A new file that takes the place of the old one when it is whole. */
static bool replace(const char *path, const char *text) {
  char part[4400];
  snprintf(part, sizeof part, "%s.part", path);
  FILE *f = fopen(part, "we");
  if (!f)
    return false;
  bool good = fputs(text, f) >= 0;
  good = fclose(f) == 0 && good && rename(part, path) == 0;
  int cause = errno;
  if (!good)
    unlink(part);
  errno = cause;
  return good;
}

/* Over the bytes of the old file, for which the disk has room even when it is full. */
static bool overwrite(const char *path, const char *text) {
  struct stat is;
  size_t n = strlen(text);
  int fd = open(path, O_WRONLY | O_CLOEXEC);
  bool good = fd >= 0 && fstat(fd, &is) == 0 && (size_t)is.st_size >= n && write(fd, text, n) == (ssize_t)n &&
              ftruncate(fd, (off_t)n) == 0;
  return (fd < 0 || close(fd) == 0) && good;
}

bool tdm_json_replace(const char *path, const json_t *json) {
  char *text = json_dumps(json, JSON_INDENT(2));
  const bool good = text && replace(path, text);
  free(text);
  return good;
}

tdm_status tdm_results_json(const tdm_results *r, const char *name, const json_t *json, tdm_error *err) {
  char path[4352];
  char *text = json_dumps(json, JSON_INDENT(2));
  tdm_results_claim(r, name, path, sizeof path);
  if (!text)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "%s: out of memory", path);
  else if (!replace(path, text)) {
    int cause = errno;
    if (!overwrite(path, text)) {
      errno = cause;
      cannot(path, "written", err);
    }
  }
  free(text);
  return err->status;
}

tdm_status tdm_results_summary(const tdm_results *r, const json_t *json, tdm_error *err) {
  static const char *const keys[] = {"tandem", "scene", "windows", "simulated_s", "wall_s", "status", "error"};
  tdm_error whole = {0};
  if (tdm_results_json(r, "summary.json", json, &whole) == TDM_OK)
    return err->status;
  json_t *less = json_object();
  for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++)
    if (json_object_get(json, keys[i]))
      json_object_set(less, keys[i], json_object_get(json, keys[i]));
  if (tdm_fail(err, whole.status, NULL, "%s", whole.message) == whole.status) {
    json_object_set_new(less, "status", json_string(tdm_status_name(err->status)));
    json_object_set_new(less, "error", json_string(err->message));
  }
  tdm_results_json(r, "summary.json", less, &(tdm_error){0});
  json_decref(less);
  return err->status;
}

json_t *tdm_results_read(const char *dir, const char *name, tdm_error *err) {
  char path[4352];
  json_error_t where;
  snprintf(path, sizeof path, "%s/%s", dir, name);
  const char *why;
  FILE *f = tdm_open_input(path, false, &why);
  json_t *json = f ? json_loadf(f, 0, &where) : NULL;
  if (f)
    fclose(f);
  if (!json)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: %s; give the directory of a run (--out of tandem run)", path,
             f ? where.text : why);
  return json;
}
