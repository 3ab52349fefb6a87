/* proxy: DEM carries the mechanism through the window, MBD follows with the load of the same window.
 *
 *   window k:  DEM  integrates the f independent velocities of the mechanism, as MBD linearised it at t_k, beside the
 *                   particles, under the load that its contacts make (dem/proxy.h); returns the load's moments m_j
 *              MBD  integrates the same window under the parabola with these moments (cpl_solve_dem_proxy); its state
 *                   wins
 *
 * The particles feel the inertia, springs and dampers of what holds them within the window: no added-mass instability,
 * whatever their mass. What both sides make of the same window differs by what the linearisation leaves out: an
 * estimate of the error that costs nothing. Where the mechanism cannot move, this is `dem-first`.
 */
#include "coupler/window.h"

static tdm_status advance(cpl_loop *loop, tdm_error *err) {
  if (cpl_solve_dem_proxy(loop, NULL, err) != TDM_OK)
    return err->status;
  return cpl_solve_mbd(loop, loop->nload, err);
}

static const char *const of_mbd[] = {"acceleration", "mobility", NULL};
static const char *const of_dem[] = {"interface", "proxy", NULL};

const cpl_scheme cpl_scheme_proxy = {
    .name = "proxy",
    .summary = "DEM carries the mechanism through the window, MBD follows with the same load",
    .needs = {[CPL_MBD] = of_mbd, [CPL_DEM] = of_dem},
    .mismatch_order = 4,
    .advance = advance,
};
