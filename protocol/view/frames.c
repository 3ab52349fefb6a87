/* The file frames.tdv: see frames.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/view/frames.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { HEAD_BYTES = 24, LENGTH_AT = 16, TIME_AT = 48 }; /* of a record; of its length and a snapshot's time in it */

static tdm_status cannot(const char *path, tdm_error *err) {
  return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", path, strerror(errno));
}

tdm_status tdm_frames_write_scenery(FILE *file, const char *path, const tdm_scenery *scenery, tdm_view_bytes *bytes,
                                    tdm_error *err) {
  bytes->size = 0;
  const tdm_status status = tdm_scenery_encode(scenery, true, bytes, err);
  if (status != TDM_OK)
    return status;
  errno = 0;
  if (fwrite(bytes->data, 1, bytes->size, file) != bytes->size || fflush(file) != 0)
    return cannot(path, err);
  return TDM_OK;
}

/* ---- shares ---- */

bool tdm_put_at(FILE *file, long at, const void *data, size_t size) {
  return size == 0 || (fseek(file, at, SEEK_SET) == 0 && fwrite(data, 1, size, file) == size);
}

bool tdm_put_share(FILE *file, long at, const tdm_snapshot *share, const void *values, size_t width) {
  const char *from = values;
  bool good = true;
  for (int k = 0; k < share->nrange && good; k++) {
    const size_t size = (size_t)share->range[k].count * width;
    good = tdm_put_at(file, at + (long)((size_t)share->range[k].first * width), from, size);
    from += size;
  }
  return good;
}

FILE *tdm_share_open(const char *path, tdm_error *err) {
  const int fd = open(path, O_WRONLY | O_CLOEXEC); /* fopen would cut the file, or read it */
  FILE *file = fd >= 0 ? fdopen(fd, "w") : NULL;
  if (!file && fd >= 0)
    close(fd);
  if (!file)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s%s", path, strerror(errno),
             errno == ENOENT ? "; processes on other machines need the result directory, too, under the same path"
                             : "");
  return file;
}

/* the arrays of a record in memory, to their places behind `at`, which becomes that behind them */
static bool put_arrays(FILE *file, long *at, const tdm_snapshot *s, const tdm_view_layout *l, const uint8_t *record) {
  const uint8_t *from = record + l->before;
  bool good = true;
  for (int a = 0; a < l->narray && good; a++) {
    good = tdm_put_share(file, *at, s, from, l->width[a]);
    from += (size_t)s->nparticle * l->width[a];
    *at += (long)((size_t)s->nall * l->width[a]);
  }
  return good;
}

/* bytes of the arrays of n particles */
static size_t array_bytes(const tdm_view_layout *l, int n) {
  size_t bytes = 0;
  for (int a = 0; a < l->narray; a++)
    bytes += (size_t)n * l->width[a];
  return bytes;
}

tdm_status tdm_frames_write(FILE *file, const char *path, const tdm_snapshot *s, tdm_frame_place *place,
                            tdm_view_bytes *bytes, tdm_error *err) {
  const tdm_view_layout l = tdm_snapshot_layout(s, true);
  bytes->size = 0;
  const tdm_status status = tdm_snapshot_encode(s, true, bytes, err);
  if (status != TDM_OK)
    return status;
  const size_t own = array_bytes(&l, s->nparticle), rest = bytes->size - l.before - own;
  *place = (tdm_frame_place){.start = ftell(file)};
  long at = place->arrays = place->start + (long)l.before;
  memset(bytes->data + LENGTH_AT, 0x7f, sizeof(uint64_t)); /* until tdm_frames_end */
  errno = 0;
  if (!tdm_put_at(file, place->start, bytes->data, l.before) || !put_arrays(file, &at, s, &l, bytes->data) ||
      !tdm_put_at(file, at, bytes->data + l.before + own, rest) || fflush(file) != 0)
    return cannot(path, err);
  place->end = at + (long)rest;
  if (s->nparticle < s->nall && ftruncate(fileno(file), place->end) != 0) /* the end may be another's share */
    return cannot(path, err);
  return TDM_OK;
}

tdm_status tdm_frames_end(FILE *file, const char *path, const tdm_frame_place *place, tdm_error *err) {
  const uint64_t length = (uint64_t)(place->end - place->start);
  errno = 0;
  if (!tdm_put_at(file, place->start + LENGTH_AT, &length, sizeof length) || fflush(file) != 0 ||
      fseek(file, place->end, SEEK_SET) != 0)
    return cannot(path, err);
  return TDM_OK;
}

tdm_status tdm_frames_write_share(const char *path, const tdm_snapshot *share, long arrays, tdm_error *err) {
  const tdm_view_layout l = tdm_snapshot_layout(share, true);
  tdm_view_bytes bytes = {0};
  if (tdm_snapshot_encode(share, true, &bytes, err) == TDM_OK) {
    FILE *file = tdm_share_open(path, err);
    errno = 0;
    const bool good = file && put_arrays(file, &arrays, share, &l, bytes.data);
    if (file && (fclose(file) != 0 || !good))
      cannot(path, err);
  }
  tdm_view_bytes_free(&bytes);
  return err->status;
}

/* ---- reading ---- */

void tdm_frames_close(tdm_frames *f) {
  if (f->file)
    fclose(f->file);
  tdm_scenery_free(&f->scenery);
  tdm_view_bytes_free(&f->bytes);
  free(f->time);
  free(f->offset);
  free(f->size);
  *f = (tdm_frames){0};
}

static tdm_status no_memory(const tdm_frames *f, tdm_error *err) {
  return tdm_fail(err, TDM_ERR_MEMORY, NULL, "%s: no memory to read it", f->path);
}

/* `size` bytes at `offset` into f->bytes */
static tdm_status load(tdm_frames *f, long offset, size_t size, tdm_error *err) {
  if (size > f->bytes.capacity) {
    uint8_t *data = realloc(f->bytes.data, size);
    if (!data)
      return no_memory(f, err);
    f->bytes.data = data;
    f->bytes.capacity = size;
  }
  if (fseek(f->file, offset, SEEK_SET) != 0 || fread(f->bytes.data, 1, size, f->file) != size)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be read", f->path);
  f->bytes.size = size;
  return TDM_OK;
}

static tdm_status note_snapshot(tdm_frames *f, long offset, size_t size, double time, tdm_error *err) {
  if (f->count == f->capacity) {
    size_t room = 2 * (size_t)f->capacity + 64;
    double *times = realloc(f->time, room * sizeof *times);
    f->time = times ? times : f->time;
    long *offsets = realloc(f->offset, room * sizeof *offsets);
    f->offset = offsets ? offsets : f->offset;
    size_t *sizes = realloc(f->size, room * sizeof *sizes);
    f->size = sizes ? sizes : f->size;
    if (!times || !offsets || !sizes)
      return no_memory(f, err);
    f->capacity = (int)room;
  }
  f->time[f->count] = time;
  f->offset[f->count] = offset;
  f->size[f->count++] = size;
  return TDM_OK;
}

/* The record at `offset`, of which all bytes are there. */
static tdm_status take_record(tdm_frames *f, long offset, size_t length, tdm_view_record record, tdm_error *err) {
  double time;
  if (record == TDM_VIEW_SCENERY)
    return f->count > 0 ? tdm_fail(err, TDM_ERR_FILE, NULL, "%s: a second scenery behind snapshots", f->path)
           : load(f, offset, length, err) == TDM_OK ? tdm_scenery_decode(&f->scenery, f->bytes.data, length, err)
                                                    : TDM_ERR_FILE;
  if (length < TIME_AT + sizeof time)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: a snapshot of %zu bytes", f->path, length);
  if (load(f, offset, TIME_AT + sizeof time, err) != TDM_OK)
    return TDM_ERR_FILE;
  memcpy(&time, f->bytes.data + TIME_AT, sizeof time);
  return note_snapshot(f, offset, length, time, err);
}

static tdm_status find_records(tdm_frames *f, tdm_error *err) {
  uint8_t head[HEAD_BYTES];
  long offset = 0, size = fseek(f->file, 0, SEEK_END) == 0 ? ftell(f->file) : -1;
  if (size < 0)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be read: %s", f->path, strerror(errno));
  while (offset < size) {
    tdm_error own = {0};
    tdm_view_record record;
    size_t length;
    if (size - offset < HEAD_BYTES)
      break;
    if (fseek(f->file, offset, SEEK_SET) != 0 || fread(head, 1, sizeof head, f->file) != sizeof head)
      return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be read", f->path);
    uint64_t announced;
    memcpy(&announced, head + 16, sizeof announced);
    if (tdm_view_peek(head, SIZE_MAX, &record, &length, &own) != TDM_OK)
      return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: at byte %ld: %s", f->path, offset, own.message);
    if (announced > (uint64_t)(size - offset))
      break;
    if (take_record(f, offset, length, record, err) != TDM_OK)
      return err->status;
    offset += (long)length;
  }
  f->cut = offset < size;
  return TDM_OK;
}

static tdm_status open_file(tdm_frames *f, const char *cure, tdm_error *err) {
  f->file = fopen(f->path, "rb");
  if (!f->file)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: %s%s", f->path, strerror(errno), cure);
  return find_records(f, err);
}

tdm_status tdm_frames_open(tdm_frames *f, const char *dir, tdm_error *err) {
  *f = (tdm_frames){0};
  snprintf(f->path, sizeof f->path, "%s/%s", dir, TDM_FRAMES_FILE);
  return open_file(f, "; a run writes it with output.particles_interval (seconds between what is seen)", err);
}

tdm_status tdm_frames_open_file(tdm_frames *f, const char *path, tdm_error *err) {
  *f = (tdm_frames){0};
  snprintf(f->path, sizeof f->path, "%s", path);
  return open_file(f, "", err);
}

tdm_status tdm_frames_load(tdm_frames *f, int k, tdm_snapshot *snapshot, tdm_error *err) {
  if (load(f, f->offset[k], f->size[k], err) != TDM_OK ||
      tdm_snapshot_decode(snapshot, f->bytes.data, f->bytes.size, err) != TDM_OK)
    return err->status;
  return tdm_snapshot_check(snapshot, &f->scenery, err);
}
