/* Things that go to other ranks, or to other places on this one: particles, entries of lists. First it is said which
 * thing goes where, then array after array of them goes. All ranks call the same functions in the same order. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_EXCHANGE_TRANSFER_H
#define DEM_EXCHANGE_TRANSFER_H

#include "dem/base/ranks.h"
#include "protocol/base/status.h"

#include <stddef.h>

typedef struct {
  const dem_ranks *ranks;  /* NULL: there is this one alone */
  int size, here;          /* of ranks; this one's number */
  size_t nout, nin;        /* things that go from here and that come here, those that stay among both */
  size_t *sent, *received; /* (size + 1) first of each rank */
  int *from;               /* (nout) where they are, rank by rank, ascending for each */
  int *to;                 /* (nin) the caller fills in where they come to, in the order of arrival */
  dem_mail *mail;          /* (size) */
} dem_transfer;

/* Of the things in places first ... first + n - 1, thing k goes to rank[k]; < 0: nowhere. To be closed, also after an
 * error. Errors: TDM_ERR_MEMORY. */
tdm_status dem_transfer_open(dem_transfer *t, const dem_ranks *ranks, int first, int n, const int *rank);
void dem_transfer_close(dem_transfer *t);

/* An array of `size` bytes a thing goes: to arrived (nin), in the order of arrival; or within itself, by `from` and
 * `to`. Errors: TDM_ERR_MEMORY. */
tdm_status dem_transfer_fetch(const dem_transfer *t, const void *array, size_t size, void *arrived);
tdm_status dem_transfer_move(const dem_transfer *t, void *array, size_t size);

/* Of each thing `size` bytes go, which lie `stride` bytes apart from `first` on: to result (nin), by `to`. Likewise. */
tdm_status dem_transfer_pick(const dem_transfer *t, const void *first, size_t stride, size_t size, void *result);

/* An array of those that arrived (nin) goes back: to the places that they came from. */
tdm_status dem_transfer_answer(const dem_transfer *t, const void *arrived, size_t size, void *array);

#endif
