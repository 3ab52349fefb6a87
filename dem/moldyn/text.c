/* Text files of rows: see text.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/moldyn/text.h"

#include "protocol/scene/input.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

tdm_status dem_text_open(dem_text *t, const char *file, const char *path, tdm_error *err) {
  const char *why;
  *t = (dem_text){.file = file, .path = path, .err = err};
  if (err->status)
    return err->status;
  t->stream = tdm_open_input(file, false, &why);
  if (!t->stream)
    tdm_fail(err, TDM_ERR_FILE, path, "%s: cannot be opened: %s; check the name and the folder", file, why);
  return err->status;
}

tdm_status dem_text_fail(dem_text *t, long line, const char *format, ...) {
  char message[TDM_MESSAGE_MAX];
  va_list args;
  va_start(args, format);
  vsnprintf(message, sizeof message, format, args);
  va_end(args);
  return tdm_fail(t->err, TDM_ERR_FILE, t->path, "%s:%ld: %s", t->file, line, message);
}

bool dem_text_row(dem_text *t) {
  static const char blanks[] = " \t\r\n\f\v";
  while (t->stream && !t->err->status && getline(&t->text, &t->size, t->stream) >= 0) {
    char *rest = NULL;
    t->line++;
    t->nfield = 0;
    t->text[strcspn(t->text, "#")] = 0;
    for (char *at = strtok_r(t->text, blanks, &rest); at; at = strtok_r(NULL, blanks, &rest)) {
      if (t->nfield < DEM_FIELDS_MAX)
        t->field[t->nfield] = at;
      t->nfield++;
    }
    if (t->nfield > 0)
      return true;
  }
  if (t->stream && ferror(t->stream))
    tdm_fail(t->err, TDM_ERR_FILE, t->path, "%s: cannot be read: %s", t->file, strerror(errno));
  return false;
}

double dem_text_number(dem_text *t, int k, const char *what) {
  char *end;
  double x = strtod(t->field[k], &end);
  if (*end == 0 && end != t->field[k] && isfinite(x))
    return x;
  dem_text_fail(t, t->line, "\"%.40s\" (field %d, %s) is no finite number; correct it", t->field[k], k + 1, what);
  return 0;
}

void dem_text_close(dem_text *t) {
  if (t->stream)
    fclose(t->stream);
  free(t->text);
  *t = (dem_text){0};
}
