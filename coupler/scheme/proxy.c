/* proxy: DEM carries the mechanism through the window, MBD follows with the load of the same window.
 *
 *   window k:  DEM  integrates the f independent velocities of the mechanism, as MBD linearised it at t_k, beside the
 *                   particles, under the load that its contacts make (dem/proxy/proxy.h); returns the load's moments
 * m_j MBD  integrates the same window under the parabola with these moments (cpl_solve_dem_proxy); its state wins
 *
 * The particles feel the inertia, springs and dampers of what holds them within the window: no added-mass instability,
 * whatever their mass. What both sides make of the same window differs by what the linearisation leaves out: an
 * estimate of the error that costs nothing, and the sign of a stop, a slack cable or friction that turns inside a
 * window, where the linearisation ends. Where the mechanism cannot move, this is `dem-first`.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/solve.h"
#include "coupler/scheme/schemes.h"
#include "coupler/state/mismatch.h"
#include "protocol/scene/remark.h"

#include <math.h>

/* A mismatch of a tenth of the motion is more than curvature makes: the mechanism has changed within the window. */
static const double change = 0.1, least_change = 1e-7; /* of the motion; [m] */

/* Windows in which the mechanism changed. */
typedef struct {
  uint64_t count;
  double first; /* start of the first one [s] */
} mechanism_changes;

static size_t memory_size(int nbody) {
  (void)nbody;
  return sizeof(mechanism_changes);
}

static void look_for_change(cpl_loop *loop) {
  mechanism_changes *changes = (mechanism_changes *)(void *)loop->memory;
  double apart[CPL_APART];
  for (int i = 0; i < loop->nbody; i++) {
    cpl_apart(&loop->state_end[i], &loop->dem_end[i], loop->radius[i], loop->t1 - loop->t0, apart);
    double is = cpl_length(CPL_APART, apart);
    if (!(is > change * cpl_motion(loop, i) + least_change))
      continue;
    if (changes->count++ == 0)
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
  return cpl_solve_mbd(loop, loop->nload, err);
}

static void enter(const cpl_loop *loop, json_t *summary) {
  const mechanism_changes *changes = (const mechanism_changes *)(const void *)loop->memory;
  if (changes->count > 0)
    json_object_set_new(summary, "mechanism_changed",
                        json_pack("{s:I, s:f}", "windows", (json_int_t)changes->count, "first_s", changes->first));
}

const cpl_scheme cpl_scheme_proxy = {
    .name = "proxy",
    .summary = "DEM carries the mechanism through the window, MBD follows with the same load",
    .better = "iterative",
    .needs = {[CPL_MBD] = CPL_ACCELERATION | CPL_MOBILITY, [CPL_DEM] = CPL_INTERFACE | CPL_PROXY},
    .mismatch_order = 4,
    .order = 5,
    .memory = memory_size,
    .advance = advance,
    .keep = look_for_change,
    .enter = enter,
};
