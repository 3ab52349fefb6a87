#include "coupler/record.h"

#include "protocol/log.h"

#include <errno.h>
#include <glob.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

static const double flush_interval = 1; /* [s] wall clock: what a reader of a running run lags behind */

const char *cpl_record_path(const cpl_record *record, const char *name, char *out, size_t size) {
  snprintf(out, size, "%s/%s", record->dir, name);
  return out;
}

static tdm_status cannot(const char *path, const char *what, tdm_error *err) {
  return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be %s: %s; give another directory with --out", path, what,
                  strerror(errno));
}

tdm_status cpl_make_directory(const char *dir, tdm_error *err) {
  char path[4096];
  if (!*dir || strlen(dir) + 256 > sizeof path)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "--out: %s", *dir ? "the name is too long" : "the name is empty");
  snprintf(path, sizeof path, "%s/", dir);
  for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
    *slash = 0;
    if (mkdir(path, 0777) != 0 && errno != EEXIST)
      return cannot(path, "made", err);
    *slash = '/';
  }
  return TDM_OK;
}

/* Time histories and pictures of an earlier run, maybe of another scene, would mix with the new ones. */
static void remove_old(const cpl_record *record) {
  static const char *const patterns[] = {"body_*",       "mbd.*",  "dem.*",     "comparison.*",
                                         "summary.json", "time.*", "index.html"};
  for (size_t i = 0; i < sizeof patterns / sizeof patterns[0]; i++) {
    char pattern[4352];
    glob_t found;
    cpl_record_path(record, patterns[i], pattern, sizeof pattern);
    if (glob(pattern, GLOB_NOSORT, NULL, &found) == 0) {
      for (size_t k = 0; k < found.gl_pathc; k++)
        unlink(found.gl_pathv[k]);
      globfree(&found);
    }
  }
}

tdm_status cpl_record_open(cpl_record *record, const char *dir, const char *scene, FILE **log, tdm_error *err) {
  char path[4352];
  struct stat given, there;
  *record = (cpl_record){0};
  if (cpl_make_directory(dir, err) != TDM_OK)
    return err->status;
  snprintf(record->dir, sizeof record->dir, "%s", dir);
  cpl_record_path(record, "scene.json", path, sizeof path);
  if (stat(scene, &given) == 0 && stat(path, &there) == 0 && given.st_dev == there.st_dev &&
      given.st_ino == there.st_ino)
    return tdm_fail(
        err, TDM_ERR_FILE, NULL,
        "%s: is the scene itself, and a run writes its own scene.json there; give another directory with --out", path);
  cpl_record_path(record, "server.log", path, sizeof path);
  *log = fopen(path, "ae"); /* e: solver processes do not inherit the lock */
  if (!*log)
    return cannot(path, "written", err);
  if (flock(fileno(*log), LOCK_EX | LOCK_NB) != 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: another run writes into this directory; give another one with --out",
                    dir);
  if (ftruncate(fileno(*log), 0) != 0)
    return cannot(path, "written", err);
  remove_old(record);
  return TDM_OK;
}

static FILE *open_csv(const cpl_record *record, const char *name, tdm_error *err) {
  char path[4096];
  FILE *f = fopen(cpl_record_path(record, name, path, sizeof path), "w");
  if (!f)
    cannot(path, "written", err);
  else
    setvbuf(f, NULL, _IOFBF, 1 << 16);
  return f;
}

static void write_numbers(FILE *f, const double *values, int n) {
  for (int i = 0; i < n; i++)
    fprintf(f, ",%.17g", values[i]);
}

static void write_body_row(FILE *f, double time, const tdm_state *state, const tdm_wrench *load) {
  fprintf(f, "%.12g", time);
  write_numbers(f, (const double *)(const void *)state, TDM_STATE_DOUBLES);
  write_numbers(f, (const double *)(const void *)load, TDM_WRENCH_DOUBLES);
  fputc('\n', f);
}

static void write_channel_row(FILE *f, double time, const double *values, int n) {
  fprintf(f, "%.12g", time);
  write_numbers(f, values, n);
  fputc('\n', f);
}

tdm_status cpl_record_begin(cpl_record *record, const cpl_session *s, tdm_error *err) {
  char name[256];
  record->interval = s->settings->output_interval;
  record->body = calloc((size_t)s->settings->nbody + 1, sizeof *record->body);
  if (!record->body)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  record->nbody = s->settings->nbody;
  for (int i = 0; i < record->nbody; i++) {
    snprintf(name, sizeof name, "body_%.200s.csv", s->settings->body[i].name[CPL_MBD]);
    record->body[i] = open_csv(record, name, err);
    if (!record->body[i])
      return err->status;
    fputs("time [s],x [m],y [m],z [m],qw [-],qx [-],qy [-],qz [-],vx [m/s],vy [m/s],vz [m/s],wx [rad/s],wy [rad/s],"
          "wz [rad/s],fx [N],fy [N],fz [N],mx [N m],my [N m],mz [N m]\n",
          record->body[i]);
    write_body_row(record->body[i], 0, &s->body[i].state, &s->load[i]);
  }
  for (int r = 0; r < CPL_NROLE; r++) {
    const cpl_partner *p = &s->partner[r];
    record->nchannel[r] = p->nchannel;
    if (p->nchannel == 0)
      continue;
    snprintf(name, sizeof name, "%s.csv", cpl_role_names[r]);
    FILE *f = record->channel[r] = open_csv(record, name, err);
    if (!f)
      return err->status;
    fputs("time [s]", f);
    for (int c = 0; c < p->nchannel; c++)
      fprintf(f, ",%s [%s]", p->channel[c].name, p->channel[c].unit);
    fputc('\n', f);
    write_channel_row(f, 0, p->initial, p->nchannel);
  }
  return TDM_OK;
}

/* every open file of the record, NULLs among them; index 0 … nbody + CPL_NROLE - 1 */
static FILE **file_at(cpl_record *record, int i) {
  return i < record->nbody ? &record->body[i] : &record->channel[i - record->nbody];
}

static tdm_status flush_all(cpl_record *record, tdm_error *err) {
  for (int i = 0; i < record->nbody + CPL_NROLE; i++) {
    FILE *f = *file_at(record, i);
    if (f && (fflush(f) != 0 || ferror(f)))
      return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: a time history cannot be written: %s; what is there stays readable",
                      record->dir, strerror(errno));
  }
  return TDM_OK;
}

tdm_status cpl_record_samples(cpl_record *record, uint64_t first, int nsample, const tdm_result *result,
                              tdm_error *err) {
  const tdm_result *mbd = &result[CPL_MBD], *dem = &result[CPL_DEM];
  for (int k = 0; k < nsample; k++) {
    double time = (double)(first + (uint64_t)k) * record->interval;
    for (int i = 0; i < record->nbody; i++)
      write_body_row(record->body[i], time, &mbd->sample_state[k * record->nbody + i],
                     &dem->sample_load[k * record->nbody + i]);
    for (int r = 0; r < CPL_NROLE; r++)
      if (record->channel[r])
        write_channel_row(record->channel[r], time, &result[r].channel[k * record->nchannel[r]], record->nchannel[r]);
  }
  if (nsample > 0) {
    double now = tdm_clock();
    if (now - record->last_flush > flush_interval) {
      record->last_flush = now;
      return flush_all(record, err);
    }
  }
  return TDM_OK;
}

tdm_status cpl_record_json(const cpl_record *record, const char *name, const json_t *json, tdm_error *err) {
  char path[4096];
  if (json_dump_file(json, cpl_record_path(record, name, path, sizeof path), JSON_INDENT(2)) != 0)
    return cannot(path, "written", err);
  return TDM_OK;
}

json_t *cpl_record_read(const char *dir, const char *name, tdm_error *err) {
  char path[4352];
  json_error_t where;
  snprintf(path, sizeof path, "%s/%s", dir, name);
  json_t *json = json_load_file(path, 0, &where);
  if (!json)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: %s; give the directory of a run (--out of tandem run)", path, where.text);
  return json;
}

tdm_status cpl_record_close(cpl_record *record, tdm_error *err) {
  tdm_error late = {0};
  if (record->body)
    flush_all(record, &late);
  for (int i = 0; record->body && i < record->nbody + CPL_NROLE; i++)
    if (*file_at(record, i)) {
      fclose(*file_at(record, i));
      *file_at(record, i) = NULL;
    }
  free(record->body);
  record->body = NULL;
  return late.status == TDM_OK ? TDM_OK : tdm_fail(err, late.status, NULL, "%s", late.message);
}
