/* Things that go to other ranks: see transfer.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/exchange/transfer.h"

#include <stdlib.h>
#include <string.h>

/* counts (1 ... size) become the first of each rank */
static size_t add_up(size_t *first, int size) {
  first[0] = 0;
  for (int r = 0; r < size; r++)
    first[r + 1] += first[r];
  return first[size];
}

/* the first n letters of t->mail */
static void exchange(const dem_transfer *t, int n) {
  if (!t->ranks)
    return;
  t->ranks->begin(t->mail, n);
  t->ranks->finish();
}

/* how many come from each rank: what each tells the others */
static void exchange_counts(dem_transfer *t) {
  int n = 0;
  for (int r = 0; r < t->size; r++)
    if (r != t->here)
      t->mail[n++] = (dem_mail){r, &t->sent[r + 1], &t->received[r + 1], sizeof *t->sent, sizeof *t->received};
  t->received[t->here + 1] = t->sent[t->here + 1];
  exchange(t, n);
}

tdm_status dem_transfer_open(dem_transfer *t, const dem_ranks *ranks, int first, int n, const int *rank) {
  const size_t size = ranks ? (size_t)ranks->size : 1;
  *t = (dem_transfer){.ranks = ranks,
                      .size = (int)size,
                      .here = ranks ? ranks->rank : 0,
                      .sent = calloc(size + 1, sizeof *t->sent),
                      .received = calloc(size + 1, sizeof *t->received),
                      .mail = malloc(size * sizeof *t->mail)};
  size_t *next = malloc((size + 1) * sizeof *next);
  if (!t->sent || !t->received || !t->mail || !next) {
    free(next);
    return TDM_ERR_MEMORY;
  }
  for (int k = 0; k < n; k++)
    if (rank[k] >= 0)
      t->sent[rank[k] + 1]++;
  exchange_counts(t);
  t->nout = add_up(t->sent, t->size);
  t->nin = add_up(t->received, t->size);
  t->from = malloc((t->nout + 1) * sizeof *t->from);
  t->to = malloc((t->nin + 1) * sizeof *t->to);
  memcpy(next, t->sent, (size + 1) * sizeof *next);
  for (int k = 0; t->from && k < n; k++)
    if (rank[k] >= 0)
      t->from[next[rank[k]]++] = first + k;
  free(next);
  return t->from && t->to ? TDM_OK : TDM_ERR_MEMORY;
}

void dem_transfer_close(dem_transfer *t) {
  free(t->sent);
  free(t->received);
  free(t->from);
  free(t->to);
  free(t->mail);
  *t = (dem_transfer){0};
}

/* From `array`, whose things are `stride` bytes apart, by `gather` (NULL: in order), to `result`, by `scatter`, which
 * may be the same array; going, coming: the first of each rank. What stays is not sent. */
static tdm_status go(const dem_transfer *t, const void *array, size_t stride, size_t size, const size_t *going,
                     const int *gather, void *result, const size_t *coming, const int *scatter) {
  const int ranks = t->size, here = t->here;
  const size_t stay = going[here + 1] - going[here];
  char *out = malloc(going[ranks] * size + 1), *in = malloc((coming[ranks] - stay) * size + 1);
  int n = 0;
  if (!out || !in) {
    free(out);
    free(in);
    return TDM_ERR_MEMORY;
  }
  for (size_t k = 0; k < going[ranks]; k++)
    memcpy(out + k * size, (const char *)array + (gather ? (size_t)gather[k] : k) * stride, size);
  for (int r = 0; r < ranks; r++) {
    const size_t sent = going[r + 1] - going[r], received = coming[r + 1] - coming[r],
                 at = coming[r] - (r > here ? stay : 0);
    if (r != here && sent + received > 0)
      t->mail[n++] = (dem_mail){r, out + going[r] * size, in + at * size, sent * size, received * size};
  }
  exchange(t, n);
  for (size_t k = 0; k < coming[ranks]; k++) {
    const char *item = k < coming[here]       ? in + k * size
                       : k < coming[here + 1] ? out + (going[here] + k - coming[here]) * size
                                              : in + (k - stay) * size;
    memcpy((char *)result + (scatter ? (size_t)scatter[k] : k) * size, item, size);
  }
  free(out);
  free(in);
  return TDM_OK;
}

tdm_status dem_transfer_fetch(const dem_transfer *t, const void *array, size_t size, void *arrived) {
  return go(t, array, size, size, t->sent, t->from, arrived, t->received, NULL);
}

tdm_status dem_transfer_move(const dem_transfer *t, void *array, size_t size) {
  return array && size > 0 ? dem_transfer_pick(t, array, size, size, array) : TDM_OK;
}

tdm_status dem_transfer_pick(const dem_transfer *t, const void *first, size_t stride, size_t size, void *result) {
  return go(t, first, stride, size, t->sent, t->from, result, t->received, t->to);
}

tdm_status dem_transfer_answer(const dem_transfer *t, const void *arrived, size_t size, void *array) {
  return go(t, arrived, size, size, t->received, NULL, array, t->sent, t->from);
}
