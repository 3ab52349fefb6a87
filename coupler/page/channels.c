/* The time histories of a result directory, thinned for the viewer's page: see channels.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/page/channels.h"

#include "coupler/page/pack.h"
#include "protocol/scene/input.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static tdm_status no_memory(tdm_error *err) {
  return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory for the time histories");
}

/* ---- which files ---- */

static int is_csv(const struct dirent *entry) {
  const size_t n = strlen(entry->d_name);
  return n > 4 && n < sizeof((cpl_channels_file){0}.file) && strcmp(entry->d_name + n - 4, ".csv") == 0;
}

static bool is_known(const cpl_channels *c, const char *name) {
  for (int k = 0; k < c->nfile; k++)
    if (strcmp(c->file[k].file, name) == 0)
      return true;
  return false;
}

/* New files go behind those that are there: their numbers stay as they are. */
static tdm_status find_files(cpl_channels *c, tdm_error *err) {
  struct dirent **entry;
  int n = scandir(c->dir, &entry, is_csv, alphasort);
  if (n < 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: %s; name the result directory of a run", c->dir, strerror(errno));
  for (int k = 0; k < n; k++) {
    if (err->status == TDM_OK && !is_known(c, entry[k]->d_name)) {
      cpl_channels_file *file = realloc(c->file, ((size_t)c->nfile + 1) * sizeof *file);
      if (file) {
        c->file = file;
        file[c->nfile] = (cpl_channels_file){0};
        snprintf(file[c->nfile++].file, sizeof file->file, "%s", entry[k]->d_name);
      } else {
        no_memory(err);
      }
    }
    free(entry[k]);
  }
  free(entry);
  return err->status;
}

/* ---- rows ---- */

/* The head line. Columns without a time in front are no history, and have no names. */
static tdm_status read_head(cpl_channels_file *f, char *line, tdm_error *err) {
  int column = 0;
  f->name = json_array();
  bool timed = strncmp(line, "time [s]", strlen("time [s]")) == 0;
  for (char *rest = line, *cell; timed && (cell = strsep(&rest, ",")) != NULL; column++) {
    cell[strcspn(cell, "\r\n")] = 0;
    tdm_utf8_clean(cell);
    if (column > 0 && json_array_append_new(f->name, json_string(cell)) != 0)
      return no_memory(err);
  }
  if (!f->name || !tdm_thin_begin(&f->thin, (int)json_array_size(f->name)))
    return no_memory(err);
  return TDM_OK;
}

/* false: no row of numbers */
static bool read_row(cpl_channels_file *f, char *line, double *values) {
  char *at = line, *end;
  const double time = strtod(at, &end);
  for (int c = 0; c < f->thin.ncolumn; c++) {
    if (end == at || *end != ',')
      return false;
    at = end + 1;
    values[c] = strtod(at, &end);
  }
  if (end == at || !isfinite(time))
    return false;
  tdm_thin_add(&f->thin, time, values);
  return true;
}

static tdm_status read_on(const char *dir, cpl_channels_file *f, tdm_error *err) {
  char path[4352], *line = NULL;
  size_t size = 0;
  ssize_t n;
  const char *why;
  double *values = NULL;
  snprintf(path, sizeof path, "%s/%s", dir, f->file);
  FILE *in = tdm_open_input(path, false, &why);
  if (!in || fseek(in, f->offset, SEEK_SET) != 0) {
    if (in)
      fclose(in);
    return TDM_OK;
  }
  while (err->status == TDM_OK && (n = getline(&line, &size, in)) > 0 && line[n - 1] == '\n') {
    if (f->offset == 0 && read_head(f, line, err) != TDM_OK)
      break;
    else if (f->offset > 0 && f->thin.ncolumn > 0) {
      values = values ? values : calloc((size_t)f->thin.ncolumn, sizeof *values);
      if (!values)
        no_memory(err);
      else if (!read_row(f, line, values))
        break;
    }
    f->offset += (long)n;
  }
  fclose(in);
  free(values);
  free(line);
  return err->status;
}

tdm_status cpl_channels_read(cpl_channels *c, const char *dir, tdm_error *err) {
  snprintf(c->dir, sizeof c->dir, "%s", dir);
  if (find_files(c, err) != TDM_OK)
    return err->status;
  for (int k = 0; k < c->nfile; k++)
    if (read_on(dir, &c->file[k], err) != TDM_OK)
      return err->status;
  return TDM_OK;
}

/* ---- what the page gets ---- */

json_t *cpl_channels_to_json(const cpl_channels *c) {
  json_t *all = json_array();
  for (int k = 0; k < c->nfile; k++)
    json_array_append_new(all, json_pack("{s:s, s:O?}", "file", c->file[k].file, "names", c->file[k].name));
  return all;
}

tdm_status cpl_channels_pack(const cpl_channels *c, int k, tdm_view_bytes *bytes, tdm_error *err) {
  const tdm_thin *t = &c->file[k].thin;
  const int nrow = t->time ? tdm_thin_rows(t) : 0, ncolumn = t->time ? t->ncolumn : 0;
  const size_t size = 16 + 4 * (size_t)nrow * ((size_t)ncolumn + 1);
  uint8_t *data = size <= bytes->capacity ? bytes->data : realloc(bytes->data, size);
  if (!data)
    return no_memory(err);
  bytes->data = data;
  bytes->capacity = size > bytes->capacity ? size : bytes->capacity;
  bytes->size = size;
  memcpy(data, (const uint32_t[]){CPL_PACK_VERSION, (uint32_t)ncolumn, (uint32_t)nrow, 0}, 16);
  float *out = (float *)(void *)(data + 16);
  for (int i = 0; i < nrow; i++)
    *out++ = (float)tdm_thin_time(t, i);
  for (int j = 0; j < ncolumn; j++)
    for (int i = 0; i < nrow; i++)
      *out++ = (float)tdm_thin_value(t, i, j);
  return TDM_OK;
}

void cpl_channels_free(cpl_channels *c) {
  for (int k = 0; k < c->nfile; k++) {
    json_decref(c->file[k].name);
    tdm_thin_free(&c->file[k].thin);
  }
  free(c->file);
  *c = (cpl_channels){0};
}
