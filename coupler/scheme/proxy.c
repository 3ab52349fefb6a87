/* proxy: DEM carries the mechanism through the window, MBD follows with the load of the same window.
 *
 *   window k:  DEM  integrates the f independent velocities of the mechanism, as MBD linearised it at t_k, beside the
 *                   particles, under the load that its contacts make (dem/proxy.h); returns the load's moments m_j
 *              MBD  integrates the same window under the parabola with these moments (cpl_solve_dem_proxy); its state
 *                   wins
 *
 * The particles feel the inertia, springs and dampers of what holds them within the window: no added-mass instability,
 * whatever their mass. What both sides make of the same window differs by what the linearisation leaves out: an
 * estimate of the error that costs nothing, and the sign of a stop, a slack cable or friction that turns inside a
 * window, where the linearisation ends. Where the mechanism cannot move, this is `dem-first`.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/mismatch.h"
#include "coupler/loop/window.h"
#include "protocol/base/remark.h"

#include <stdlib.h>

/* A mismatch of a tenth of the motion is more than curvature makes: the mechanism has changed within the window. */
static const double most_mismatch = 0.1, least_mismatch = 1e-7; /* of the motion; [m] */

/* loop->own: windows in which the mechanism changed. */
typedef struct {
  uint64_t windows;
  double first; /* the first one's start [s] */
} mechanism_changes;

static tdm_status begin(cpl_loop *loop, tdm_error *err) {
  loop->own = calloc(1, sizeof(mechanism_changes));
  return loop->own ? TDM_OK : tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
}

static void end(cpl_loop *loop) {
  free(loop->own);
  loop->own = NULL;
}

static void look_for_change(cpl_loop *loop) {
  mechanism_changes *changes = loop->own;
  double apart[CPL_APART];
  for (int i = 0; i < loop->nbody; i++) {
    cpl_apart(&loop->state_end[i], &loop->dem_end[i], loop->radius[i], loop->t1 - loop->t0, apart);
    double is = cpl_length(CPL_APART, apart);
    if (!(is > most_mismatch * cpl_motion(loop, i) + least_mismatch))
      continue;
    if (changes->windows++ == 0)
      changes->first = loop->t0;
    tdm_remark(
        TDM_NOTICE, "mechanism_changed", "coupling.n", loop->t0,
        "the mechanism changed inside the window from %.6g s on, at body \"%s\" (a stop, a slack cable, friction "
        "that turns, the kink of a table; %.3g m): there the particles felt it late; take a smaller coupling.n, or "
        "\"iterative\" as "
        "coupling.scheme",
        loop->t0, loop->settings->body[i].name[CPL_MBD], is);
    return;
  }
}

static tdm_status advance(cpl_loop *loop, tdm_error *err) {
  if (cpl_solve_dem_proxy(loop, NULL, err) != TDM_OK)
    return err->status;
  if (cpl_solve_mbd(loop, loop->nload, err) != TDM_OK)
    return err->status;
  look_for_change(loop);
  return TDM_OK;
}

static void enter(const cpl_loop *loop, json_t *summary) {
  const mechanism_changes *changes = loop->own;
  if (changes->windows > 0)
    json_object_set_new(summary, "mechanism_changed",
                        json_pack("{s:I, s:f}", "windows", (json_int_t)changes->windows, "first_s", changes->first));
}

static const char *const of_mbd[] = {"acceleration", "mobility", NULL};
static const char *const of_dem[] = {"interface", "proxy", NULL};

const cpl_scheme cpl_scheme_proxy = {
    .name = "proxy",
    .summary = "DEM carries the mechanism through the window, MBD follows with the same load",
    .needs = {[CPL_MBD] = of_mbd, [CPL_DEM] = of_dem},
    .mismatch_order = 4,
    .better = "iterative",
    .open = begin,
    .close = end,
    .advance = advance,
    .enter = enter,
};
