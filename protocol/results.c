#include "protocol/results.h"

#include <errno.h>
#include <glob.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

const char *tdm_results_path(const tdm_results *r, const char *name, char *out, size_t size) {
  snprintf(out, size, "%s/%s", r->dir, name);
  return out;
}

static tdm_status cannot(const char *path, const char *what, tdm_error *err) {
  return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be %s: %s; give another directory with --out", path, what,
                  strerror(errno));
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

/* Time histories and pictures of an earlier run, maybe of another scene, would mix with the new ones. */
static void remove_old(const tdm_results *r, const char *const *patterns) {
  for (; *patterns; patterns++) {
    char pattern[4352];
    glob_t found;
    tdm_results_path(r, *patterns, pattern, sizeof pattern);
    if (glob(pattern, GLOB_NOSORT, NULL, &found) == 0) {
      for (size_t k = 0; k < found.gl_pathc; k++)
        unlink(found.gl_pathv[k]);
      globfree(&found);
    }
  }
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
  tdm_results_path(r, name, path, sizeof path);
  r->log = fopen(path, "ae"); /* e: solver processes do not inherit the lock */
  if (!r->log)
    return cannot(path, "written", err);
  if (flock(fileno(r->log), LOCK_EX | LOCK_NB) != 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: another run writes into this directory; give another one with --out",
                    r->dir);
  return ftruncate(fileno(r->log), 0) != 0 ? cannot(path, "written", err) : TDM_OK;
}

tdm_status tdm_results_open(tdm_results *r, const char *dir, const char *scene, const char *log_name,
                            const char *const *old, tdm_error *err) {
  *r = (tdm_results){0};
  if (tdm_make_directory(dir, err) != TDM_OK)
    return err->status;
  snprintf(r->dir, sizeof r->dir, "%s", dir);
  if (refuse_scene(r, scene, err) != TDM_OK || open_log(r, log_name, err) != TDM_OK) {
    tdm_results_close(r);
    return err->status;
  }
  remove_old(r, old);
  return TDM_OK;
}

void tdm_results_close(tdm_results *r) {
  if (r->log)
    fclose(r->log);
  *r = (tdm_results){0};
}

FILE *tdm_results_file(const tdm_results *r, const char *name, tdm_error *err) {
  char path[4352];
  FILE *f = fopen(tdm_results_path(r, name, path, sizeof path), "w");
  if (!f)
    cannot(path, "written", err);
  else
    setvbuf(f, NULL, _IOFBF, 1 << 16);
  return f;
}

void tdm_write_row(FILE *f, double time, const double *values, int n) {
  fprintf(f, "%.12g", time);
  for (int i = 0; i < n; i++)
    fprintf(f, ",%.17g", values[i]);
  fputc('\n', f);
}

tdm_status tdm_results_json(const tdm_results *r, const char *name, const json_t *json, tdm_error *err) {
  char path[4352];
  if (json_dump_file(json, tdm_results_path(r, name, path, sizeof path), JSON_INDENT(2)) != 0)
    return cannot(path, "written", err);
  return TDM_OK;
}

json_t *tdm_results_read(const char *dir, const char *name, tdm_error *err) {
  char path[4352];
  json_error_t where;
  snprintf(path, sizeof path, "%s/%s", dir, name);
  json_t *json = json_load_file(path, 0, &where);
  if (!json)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: %s; give the directory of a run (--out of tandem run)", path, where.text);
  return json;
}
