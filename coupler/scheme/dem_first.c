/* dem-first: DEM goes first on a predicted path, MBD follows with the load of the same window.
 *
 *   window k:  path of a body from where DEM left it to   r + H v + H^2/2 a,  exp(H w + H^2/2 alpha) q,
 *              with pose, twist and acceleration that MBD has at t_k; where MBD tells the path ahead, since drivers
 * bend it, to the end of that, by its nodes DEM  moves the bodies along it and returns the mean load of its steps: by
 * their kicks if it has the capability "interface", else that of [L18] Eq. 2, which is late by half a step MBD
 * integrates the same window under that mean; its state wins
 *
 * No load is extrapolated, so nothing overshoots where loads jump. The prediction leaves DEM's bodies O(H^3) away from
 * MBD's; they never jump there: the next path begins where the last one ended. The first window is that of `hold`,
 * whose load at t = 0 is known, since MBD has no acceleration under a load before.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/path.h"
#include "coupler/loop/window.h"

#include <stdlib.h>

/* loop->own: the paths through the window, (nbody) states at its start and (nbody) at its end, where DEM leaves the
 * bodies. */
static tdm_status begin(cpl_loop *loop, tdm_error *err) {
  loop->own = calloc(2 * (size_t)loop->nbody + 1, sizeof(tdm_state));
  return loop->own ? TDM_OK : tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
}

static void finish(cpl_loop *loop) {
  free(loop->own);
  loop->own = NULL;
}

static tdm_status advance(cpl_loop *loop, tdm_error *err) {
  tdm_state *start = loop->own, *end = start + loop->nbody;
  const tdm_nodes *path = &loop->paths.told;
  if (loop->window == 0) {
    if (cpl_scheme_hold.advance(loop, err) != TDM_OK)
      return err->status;
    for (int i = 0; i < loop->nbody; i++)
      end[i] = loop->dem_end[i] = loop->state_end[i];
    return TDM_OK;
  }
  for (int i = 0; i < loop->nbody; i++) {
    const double *acceleration = loop->result[CPL_MBD].acceleration + 6 * i;
    start[i] = (tdm_state){end[i].pose, loop->state_start[i].twist};
    end[i] = loop->dem_end[i] = path->nnode > 0 ? path->state[(path->nnode - 1) * loop->nbody + i]
                                                : cpl_predict(&loop->state_start[i], acceleration, loop->t1 - loop->t0);
  }
  if (cpl_solve_dem_along(loop, start, end, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < loop->nbody; i++) {
    bool told = loop->result[CPL_DEM].ninterface > 0;
    loop->load[i * TDM_LOAD_MAX] = told ? loop->result[CPL_DEM].body[i].moment[0] : loop->mean[i];
    cpl_history_push(&loop->history[i], loop->t1, loop->mean[i]);
  }
  return cpl_solve_mbd(loop, 1, err);
}

static const char *const of_mbd[] = {"acceleration", NULL};

const cpl_scheme cpl_scheme_dem_first = {
    .name = "dem-first",
    .summary = "DEM first on a predicted path, MBD on the mean load of the same window",
    .better = "proxy",
    .needs = {[CPL_MBD] = of_mbd},
    .interpolation = TDM_HERMITE, /* exactly the parabola of the prediction */
    .mismatch_order = 3,
    .open = begin,
    .close = finish,
    .advance = advance,
};
