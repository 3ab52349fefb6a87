/* Records of an exchange: see record.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/record/record.h"

#include "protocol/scene/input.h"
#include "protocol/wire/message.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { HEAD = 16, ROW = 8 };
static const uint8_t head[HEAD] = {'T', 'N', 'D', 'M', 'R', 'E', 'C', 0, 1};

/* ---- writing ---- */

struct tdm_recorder {
  FILE *file;
  char name[4096];
  int failure; /* errno of the first write that failed */
};

static void put(tdm_recorder *r, const void *bytes, size_t size) {
  if (r->failure == 0 && fwrite(bytes, 1, size, r->file) != size)
    r->failure = errno ? errno : EIO;
}

tdm_status tdm_recorder_open(tdm_recorder **recorder, const char *file, tdm_error *err) {
  tdm_recorder *r = calloc(1, sizeof *r);
  if (!r)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  snprintf(r->name, sizeof r->name, "%s", file);
  r->file = fopen(file, "we");
  if (!r->file) {
    free(r);
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", file, strerror(errno));
  }
  put(r, head, HEAD);
  *recorder = r;
  return TDM_OK;
}

void tdm_recorder_add(tdm_recorder *r, int role, tdm_sender sender, const void *frame, size_t size) {
  if (!r || size < TDM_HEADER_BYTES || ((const uint8_t *)frame)[6] == TDM_HEARTBEAT)
    return;
  uint8_t row[ROW] = {(uint8_t)role, (uint8_t)sender};
  for (int k = 0; k < 4; k++)
    row[4 + k] = (uint8_t)(size >> 8 * k);
  put(r, row, ROW);
  put(r, frame, size);
}

tdm_status tdm_recorder_close(tdm_recorder **recorder, tdm_error *err) {
  tdm_recorder *r = *recorder;
  tdm_status status = TDM_OK;
  *recorder = NULL;
  if (!r)
    return TDM_OK;
  if (fclose(r->file) != 0 && r->failure == 0)
    r->failure = errno;
  if (r->failure != 0)
    status = tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s; the record ends before the run does",
                      r->name, strerror(r->failure));
  free(r);
  return status;
}

/* ---- reading ---- */

tdm_status tdm_record_open(tdm_record *record, const char *file, tdm_error *err) {
  uint8_t begin[HEAD];
  *record = (tdm_record){.name = file};
  const char *why;
  record->file = tdm_open_input(file, false, &why);
  if (!record->file)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be read: %s", file, why);
  if (fread(begin, 1, HEAD, record->file) == HEAD && memcmp(begin, head, HEAD) == 0)
    return TDM_OK;
  tdm_record_close(record);
  return tdm_fail(err, TDM_ERR_FILE, NULL,
                  "%s: is no record of an exchange (tandem run --record), or of another version", file);
}

static bool cut(const tdm_record *record, tdm_error *err) {
  tdm_fail(err, TDM_ERR_FILE, NULL, "%s: the record is cut, or damaged: record the run again", record->name);
  return false;
}

bool tdm_record_next(tdm_record *record, int role, tdm_recorded *next, tdm_error *err) {
  uint8_t row[ROW];
  while (true) {
    const size_t got = fread(row, 1, ROW, record->file);
    if (got == 0)
      return false;
    size_t size = 0;
    for (int k = 0; k < 4; k++)
      size |= (size_t)row[4 + k] << 8 * k;
    if (got != ROW || row[0] > 1 || row[1] > 1 || size < TDM_HEADER_BYTES || size > TDM_VIEW_MAX)
      return cut(record, err);
    if (size > record->capacity) {
      uint8_t *grown = realloc(record->frame, size);
      if (!grown) {
        tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
        return false;
      }
      record->frame = grown;
      record->capacity = size;
    }
    if (fread(record->frame, 1, size, record->file) != size)
      return cut(record, err);
    if (row[0] != role)
      continue;
    *next = (tdm_recorded){.role = row[0], .sender = (tdm_sender)row[1], .frame = record->frame, .size = size};
    return true;
  }
}

void tdm_record_close(tdm_record *record) {
  if (record->file)
    fclose(record->file);
  free(record->frame);
  *record = (tdm_record){0};
}
