/* Time histories thinned for plots: see thin.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/results/thin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* twice as many, so that there are TDM_THIN_BINS after the next halving */
enum { ROOM = 2 * TDM_THIN_BINS };

bool tdm_thin_begin(tdm_thin *t, int ncolumn) {
  const size_t n = (size_t)ROOM * (size_t)(ncolumn > 0 ? ncolumn : 1);
  *t = (tdm_thin){.ncolumn = ncolumn, .per_bin = 1};
  t->time = calloc(2 * ROOM, sizeof *t->time);
  t->low = calloc(n, sizeof *t->low);
  t->high = calloc(n, sizeof *t->high);
  t->falls = calloc(n, sizeof *t->falls);
  return t->time && t->low && t->high && t->falls;
}

void tdm_thin_free(tdm_thin *t) {
  free(t->time);
  free(t->low);
  free(t->high);
  free(t->falls);
  *t = (tdm_thin){0};
}

/* Widen entry k to hold what comes later: `low` and `high`, the greater first if `falls`. */
static void widen(tdm_thin *t, size_t k, double low, double high, bool falls) {
  if (!isfinite(low))
    return;
  if (!isfinite(t->low[k])) {
    t->low[k] = low, t->high[k] = high, t->falls[k] = falls;
    return;
  }
  bool lower = low<t->low[k], higher = high> t->high[k];
  if (lower && higher)
    t->falls[k] = falls;
  else if (lower || higher)
    t->falls[k] = lower;
  t->low[k] = lower ? low : t->low[k];
  t->high[k] = higher ? high : t->high[k];
}

/* Two bins in one. */
static void halve(tdm_thin *t) {
  const size_t columns = (size_t)t->ncolumn;
  for (size_t b = 0; b < ROOM / 2; b++) {
    t->time[2 * b] = t->time[4 * b];
    t->time[2 * b + 1] = t->time[4 * b + 3];
    for (size_t c = 0; c < columns; c++) {
      const size_t to = b * columns + c, first = 2 * b * columns + c, second = first + columns;
      t->low[to] = t->low[first], t->high[to] = t->high[first], t->falls[to] = t->falls[first];
      widen(t, to, t->low[second], t->high[second], t->falls[second]);
    }
  }
  t->nbin = ROOM / 2;
  t->per_bin *= 2;
}

void tdm_thin_add(tdm_thin *t, double time, const double *values) {
  if (t->nbin == ROOM)
    halve(t);
  const size_t b = (size_t)t->nbin, columns = (size_t)t->ncolumn;
  t->time[2 * b] = t->filled == 0 ? time : t->time[2 * b];
  t->time[2 * b + 1] = time;
  for (size_t c = 0; c < columns; c++) {
    const size_t k = b * columns + c;
    if (t->filled == 0)
      t->low[k] = t->high[k] = values[c], t->falls[k] = false;
    else
      widen(t, k, values[c], values[c], false);
  }
  if (++t->filled == t->per_bin) {
    t->nbin++;
    t->filled = 0;
  }
}

int tdm_thin_rows(const tdm_thin *t) {
  return (t->nbin + (t->filled > 0)) * (t->per_bin > 1 ? 2 : 1);
}

double tdm_thin_time(const tdm_thin *t, int i) {
  return t->per_bin > 1 ? t->time[i] : t->time[2 * i];
}

double tdm_thin_value(const tdm_thin *t, int i, int c) {
  const bool two = t->per_bin > 1;
  const size_t k = (size_t)(two ? i / 2 : i) * (size_t)t->ncolumn + (size_t)c;
  return two && (i % 2 == 1) != t->falls[k] ? t->high[k] : t->low[k];
}

double *tdm_thin_table(const tdm_thin *t, const int *column, int n) {
  const int nrow = tdm_thin_rows(t);
  double *table = calloc((size_t)nrow * (size_t)(n + 1) + 1, sizeof *table), *at = table;
  bool some = false;
  for (int i = 0; i < nrow && table; i++) {
    *at++ = tdm_thin_time(t, i);
    for (int k = 0; k < n; k++, at++) {
      *at = tdm_thin_value(t, i, column[k]);
      some = some || isfinite(*at);
    }
  }
  if (some)
    return table;
  free(table);
  return NULL;
}
