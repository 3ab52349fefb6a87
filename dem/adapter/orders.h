/* One engine on several ranks (base/ranks.h). Rank 0 is the one that a user or a server talks to: what its program
 * calls of dem.h it first tells the others, which do the same on engines of their own. So all of them take the same
 * steps and meet wherever a step needs the others (seam/homes.h).
 *
 * A call that fails everywhere alike ends like that on one rank. Where one rank alone fails, others wait for it in
 * vain: after some seconds it ends them all, with its message.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_ADAPTER_ORDERS_H
#define DEM_ADAPTER_ORDERS_H

#include "dem/base/ranks.h"
#include "dem/dem.h"

#include <stdint.h>

typedef enum {
  DEM_ORDER_CREATE,
  DEM_ORDER_ADVANCE,
  DEM_ORDER_SAVE,
  DEM_ORDER_RESTORE,
  DEM_ORDER_SCENERY,
  DEM_ORDER_SNAPSHOT,
  DEM_ORDER_SHARE,
  DEM_ORDER_WRITE,
  DEM_ORDER_WORK,
  DEM_ORDER_DESTROY,
  DEM_ORDER_END
} dem_order_kind;

/* What must be the same on all ranks, which send each other records as they lie in memory; no gaps. */
typedef struct {
  char version[32];
  uint64_t program;     /* of the bytes of the executable (dem_rank_build_program); 0: not known */
  double number;        /* that the functions of mathematics give here: processors may have others */
  uint32_t order, size; /* of bytes; of dem_state [bytes] */
} dem_rank_build;

/* Of this program, but for `program`. */
dem_rank_build dem_rank_build_here(void);

/* A number of the bytes of the executable that this process runs, which another build does not have. */
uint64_t dem_rank_build_program(void);

/* NULL: all ranks were built like rank 0. Else why they cannot work together, the same on all. `own`: of this one. */
const char *dem_ranks_differ(const dem_ranks *all, const dem_rank_build *own);

/* The engines of this thread belong to these ranks (borrowed) from now on; NULL: to none. */
void dem_orders_join(const dem_ranks *ranks);

/* The ranks of this thread; NULL: it is alone. */
const dem_ranks *dem_orders_ranks(void);

/* ---- rank 0; nothing on other ranks, or alone ---- */

/* Tell the others to do what this rank does next; `number`: of the slot, or whether contacts are wanted. */
void dem_orders_give(dem_order_kind kind, int number);
void dem_orders_create(const tdm_assignment *assignment);
void dem_orders_advance(const dem_window *window, const dem_outcome *outcome, int ncoupled);
void dem_orders_write(const tdm_shared_frame *frame);

/* ---- every rank ---- */

/* What was ordered is done here, with err; wait for the others. An error elsewhere becomes err. */
tdm_status dem_orders_done(tdm_error *err);

/* Likewise of an order in which ranks tell each other nothing, but may take long: all get here. */
tdm_status dem_orders_written(tdm_error *err);

/* A rank other than 0: do what rank 0 says until it says that it ends. */
void dem_orders_follow(void);

#endif
