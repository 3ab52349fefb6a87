/* Status codes and errors: see status.h. */
/* SPDX-License-Identifier: MIT */
#include "protocol/base/status.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

static const struct {
  const char *name, *text;
} status_table[TDM_STATUS_COUNT] = {
#define X(name, text) {#name, text},
    TDM_STATUS_LIST(X)
#undef X
};

const char *tdm_status_name(tdm_status status) {
  return (unsigned)status < TDM_STATUS_COUNT ? status_table[status].name : "TDM_ERR_UNKNOWN";
}

const char *tdm_status_text(tdm_status status) {
  return (unsigned)status < TDM_STATUS_COUNT ? status_table[status].text : "unknown status";
}

/* Bytes of the character at p: 0 when it is none, negative when the text ends within it. */
static int utf8_length(const unsigned char *p) {
  int n = *p < 0x80 ? 1 : *p >= 0xC2 && *p < 0xE0 ? 2 : (*p & 0xF0) == 0xE0 ? 3 : *p >= 0xF0 && *p < 0xF5 ? 4 : 0;
  for (int i = 1; i < n; i++) {
    if (!p[i])
      return -1;
    if ((p[i] & 0xC0) != 0x80)
      return 0;
  }
  /* overlong forms, surrogates, beyond U+10FFFF */
  if ((p[0] == 0xE0 && p[1] < 0xA0) || (p[0] == 0xED && p[1] >= 0xA0) || (p[0] == 0xF0 && p[1] < 0x90) ||
      (p[0] == 0xF4 && p[1] >= 0x90))
    return 0;
  return n;
}

void tdm_utf8_clean(char *text) {
  unsigned char *p = (unsigned char *)text;
  while (*p) {
    int n = utf8_length(p);
    if (n < 0) {
      *p = 0;
      return;
    }
    if (n == 0)
      *p = '?';
    if (*p < ' ' || *p == 127)
      *p = ' ';
    if (*p == 0xC2 && p[1] < 0xA0)
      p[0] = p[1] = ' ';
    p += n > 0 ? n : 1;
  }
}

tdm_status tdm_fail(tdm_error *err, tdm_status status, const char *path, const char *format, ...) {
  if (!err)
    return status;
  if (err->status != TDM_OK)
    return err->status;
  err->status = status;
  snprintf(err->path, sizeof err->path, "%s", path ? path : "");
  va_list args;
  va_start(args, format);
  vsnprintf(err->message, sizeof err->message, format, args);
  va_end(args);
  tdm_utf8_clean(err->path);
  tdm_utf8_clean(err->message);
  return status;
}

/* Levenshtein distance; words longer than the row count as far away. */
static int edit_distance(const char *a, const char *b) {
  enum { ROW = 64 };
  size_t na = strlen(a), nb = strlen(b);
  if (na >= ROW || nb >= ROW)
    return ROW;
  int row[ROW];
  for (size_t j = 0; j <= nb; j++)
    row[j] = (int)j;
  for (size_t i = 1; i <= na; i++) {
    int diagonal = row[0];
    row[0] = (int)i;
    for (size_t j = 1; j <= nb; j++) {
      int cost = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      if (row[j] + 1 < cost)
        cost = row[j] + 1;
      if (row[j - 1] + 1 < cost)
        cost = row[j - 1] + 1;
      row[j] = cost;
    }
  }
  return row[nb];
}

const char *tdm_nearest(const char *word, const char *const *candidates, int ncandidate) {
  const char *best = NULL;
  int limit = (int)strlen(word) / 3;
  int best_distance = (limit < 2 ? 2 : limit) + 1;
  for (int i = 0; i < ncandidate; i++) {
    if (!candidates[i])
      continue;
    int distance = edit_distance(word, candidates[i]);
    if (distance < best_distance && distance < (int)strlen(candidates[i])) {
      best_distance = distance;
      best = candidates[i];
    }
  }
  return best;
}
