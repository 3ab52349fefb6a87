/* dem-first: DEM goes first on a predicted path, MBD follows with the load of the same window.
 *
 *   window k:  path of a body from where DEM left it to   r + H v + H^2/2 a,  exp(H w + H^2/2 alpha) q,
 *              with pose, twist and acceleration that MBD has at t_k; where MBD tells the path ahead, since
 *              drivers bend it, to the end of that, by its nodes
 *              DEM  moves the bodies along it and returns the mean load of its steps: by their kicks if it has the
 *              capability "interface", else that of [L18] Eq. 2, which is late by half a step
 *              MBD  integrates the same window under that mean; its state wins
 *
 * No load is extrapolated, so nothing overshoots where loads jump. The prediction leaves DEM's bodies O(H^3) away from
 * MBD's; they never jump there: the next path begins where the last one ended. The first window is that of `hold`,
 * whose load at t = 0 is known, since MBD has no acceleration under a load before.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/solve.h"
#include "coupler/scheme/extrapolate.h"
#include "coupler/scheme/schemes.h"
#include "coupler/state/path.h"

#include <string.h>

/* What is kept from window to window; (nbody) each. */
typedef struct {
  cpl_history *history;
  tdm_state *start, *end; /* of the path through the last window: at its end DEM has left the bodies */
  double *acceleration;   /* (nbody x 6) that MBD has there */
} memory;

static size_t memory_size(int nbody) {
  return cpl_history_memory(nbody) + (size_t)nbody * (2 * sizeof(tdm_state) + 6 * sizeof(double));
}

static memory memory_of(const cpl_loop *loop) {
  memory m = {.history = (cpl_history *)(void *)loop->memory};
  m.start = (tdm_state *)(void *)(loop->memory + cpl_history_memory(loop->nbody));
  m.end = m.start + loop->nbody;
  m.acceleration = (double *)(void *)(m.end + loop->nbody);
  return m;
}

/* MBD over the window; what it says of the bodies' accelerations is for the next one. */
static tdm_status keep_acceleration(const cpl_loop *loop, tdm_status status) {
  if (status == TDM_OK && loop->nbody > 0)
    memcpy(memory_of(loop).acceleration, loop->result[CPL_MBD].acceleration, 6 * (size_t)loop->nbody * sizeof(double));
  return status;
}

static tdm_status first_window(cpl_loop *loop, tdm_error *err) {
  const memory m = memory_of(loop);
  if (cpl_mbd_first(loop, cpl_history_continue(loop, 1), err) != TDM_OK)
    return err->status;
  for (int i = 0; i < loop->nbody; i++)
    m.end[i] = loop->dem_end[i] = loop->state_end[i];
  return TDM_OK;
}

static tdm_status later_window(cpl_loop *loop, tdm_error *err) {
  const memory m = memory_of(loop);
  const tdm_nodes *path = &loop->told;
  for (int i = 0; i < loop->nbody; i++) {
    const double *acceleration = m.acceleration + 6 * i;
    m.start[i] = (tdm_state){m.end[i].pose, loop->state_start[i].twist};
    m.end[i] = loop->dem_end[i] = path->nnode > 0
                                      ? path->state[(path->nnode - 1) * loop->nbody + i]
                                      : cpl_predict(&loop->state_start[i], acceleration, loop->t1 - loop->t0);
  }
  if (cpl_solve_dem_along(loop, m.start, m.end, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < loop->nbody; i++) {
    bool told = loop->result[CPL_DEM].ninterface > 0;
    loop->load[i * TDM_LOAD_MAX] = told ? loop->result[CPL_DEM].body[i].moment[0] : loop->mean[i];
  }
  return cpl_solve_mbd(loop, 1, err);
}

static tdm_status advance(cpl_loop *loop, tdm_error *err) {
  return keep_acceleration(loop, loop->window == 0 ? first_window(loop, err) : later_window(loop, err));
}

const cpl_scheme cpl_scheme_dem_first = {
    .name = "dem-first",
    .summary = "DEM first on a predicted path, MBD on the mean load of the same window",
    .better = "proxy",
    .needs = {[CPL_MBD] = CPL_ACCELERATION},
    .interpolation = TDM_HERMITE, /* exactly the parabola of the prediction */
    .mismatch_order = 3,
    .order = 2,
    .memory = memory_size,
    .open = cpl_history_begin,
    .advance = advance,
};
