/* The log: see log.h. */
/* SPDX-License-Identifier: MIT */
#include "protocol/base/log.h"

#include <stdarg.h>
#include <string.h>
#include <time.h>

static _Thread_local struct {
  FILE *file;
  char part[32];
  double start;
} sink;

static const char *const level_names[] = {"debug", "info", "warning", "error"};

double tdm_clock(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void tdm_log_open(FILE *file, const char *part) {
  sink.file = file;
  snprintf(sink.part, sizeof sink.part, "%s", part);
  sink.start = tdm_clock();
}

void tdm_log(tdm_log_level level, const char *event, const char *pairs, ...) {
  if (!sink.file)
    return;
  char text[1536]; /* one write a line, so that lines of several processes on one terminal stay whole */
  int n = snprintf(text, sizeof text, "time=%.3f level=%s part=%s event=%s ", tdm_clock() - sink.start,
                   level_names[level], sink.part, event);
  va_list args;
  va_start(args, pairs);
  int m = vsnprintf(text + n, sizeof text - (size_t)n - 1, pairs, args);
  va_end(args);
  n += m < 0 ? 0 : m;
  if ((size_t)n > sizeof text - 2)
    n = (int)sizeof text - 2;
  for (int i = 0; i < n; i++) /* a name may hold anything: one event stays one line */
    if ((unsigned char)text[i] < ' ' || text[i] == 127)
      text[i] = ' ';
  text[n] = '\n';
  fwrite(text, 1, (size_t)n + 1, sink.file);
  fflush(sink.file);
}

const char *tdm_log_quote(char *out, size_t size, const char *text) {
  size_t n = 0;
  if (size < 3)
    return "";
  out[n++] = '"';
  for (; *text && n + 2 < size; text++) {
    char c = *text;
    if (c == '"')
      c = '\'';
    if ((unsigned char)c < ' ')
      c = ' ';
    out[n++] = c;
  }
  out[n++] = '"';
  out[n] = 0;
  return out;
}
