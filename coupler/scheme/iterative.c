/* iterative: the window of `proxy` is solved over and over until both solvers agree on its end.
 *
 *   SAVE both, then   DEM  carries the mechanism through the window, its bodies led to   E(c) + c   at the end, E where
 *                          its proxy went; returns E and the load's moments
 *                     MBD  integrates the same window under the polynomial with these moments: its end is Z(c)
 *                     R(c) = (Z(c) - E(c)) - c                     a fixed point; 12 numbers a body, all as lengths
 *                     |R| small: done; else RESTORE both, and again with a c that Aitken or IQN-ILS proposes
 *
 * c (way, turn, their rates) is what the linear model of the mechanism leaves out, so that DEM's bodies end where MBD's
 * do, at the same velocity, and the particles have felt the motion that MBD found. As the proxy answers to loads nearly
 * as the mechanism does, Z - E depends little on c. A window that does not converge goes on with the smallest residual.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/mismatch.h"
#include "coupler/loop/window.h"
#include "protocol/base/remark.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SLOT = 0 };

typedef struct {
  cpl_accelerator *accelerator;
  double *guess;      /* (nbody x 12) c as lengths: turns times the body's radius, rates times H */
  double *best;       /* (nbody x 12) that of the smallest residual */
  double *residual;   /* (nbody x 12) */
  double *correction; /* (nbody x 12) as it is sent */
} iteration;

static void end(cpl_loop *loop) {
  iteration *it = loop->own;
  cpl_accelerator_destroy(&it->accelerator);
  free(it->guess);
  free(it);
  loop->own = NULL;
}

static tdm_status begin(cpl_loop *loop, tdm_error *err) {
  const cpl_iterative *s = &loop->settings->iterative;
  const size_t n = CPL_APART * (size_t)loop->nbody;
  iteration *it = loop->own = calloc(1, sizeof *it);
  if (!it)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  it->accelerator = cpl_accelerator_create(s->accelerator, (int)n, s->reuse);
  it->guess = calloc(4 * n + 1, sizeof *it->guess);
  if (!it->accelerator || !it->guess)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  it->best = it->guess + n;
  it->residual = it->best + n;
  it->correction = it->residual + n;
  return TDM_OK;
}

static tdm_status save(cpl_loop *loop, tdm_error *err) {
  for (int r = 0; r < CPL_NROLE; r++)
    if (cpl_session_save(loop->session, (cpl_role)r, SLOT, err) != TDM_OK)
      return err->status;
  return TDM_OK;
}

static tdm_status restore(cpl_loop *loop, tdm_error *err) {
  for (int r = 0; r < CPL_NROLE; r++)
    if (cpl_session_restore(loop->session, (cpl_role)r, SLOT, err) != TDM_OK)
      return err->status;
  return TDM_OK;
}

/* Both solvers over the window with the correction c. Sets the residual, and *excess to its size beside what is
 * allowed. */
static tdm_status solve(cpl_loop *loop, const double *c, double *excess, tdm_error *err) {
  iteration *it = loop->own;
  const cpl_iterative *s = &loop->settings->iterative;
  const double H = loop->t1 - loop->t0;
  for (int i = 0; i < CPL_APART * loop->nbody; i++) {
    int part = i % CPL_APART / 3;
    double turns = part % 2 ? loop->radius[i / CPL_APART] : 1, rates = part >= 2 ? H : 1;
    it->correction[i] = c[i] / (turns * rates);
  }
  if (cpl_solve_dem_proxy(loop, it->correction, err) != TDM_OK || cpl_solve_mbd(loop, loop->nload, err) != TDM_OK)
    return err->status;
  *excess = 0;
  for (int i = 0; i < loop->nbody; i++) {
    double *residual = it->residual + CPL_APART * i;
    cpl_apart(&loop->state_end[i], &loop->dem_end[i], loop->radius[i], H, residual);
    for (int k = 0; k < CPL_APART; k++)
      residual[k] -= c[CPL_APART * i + k];
    double is = cpl_length(CPL_APART, residual);
    if (!isfinite(is))
      return tdm_fail(err, TDM_ERR_NUMERIC, NULL,
                      "the ends of body \"%s\" in the window from %g s to %g s are apart by more than any number: the "
                      "iterations have blown up; take a smaller coupling.n",
                      loop->settings->body[i].name[CPL_MBD], loop->t0, loop->t1);
    if (is > 0)
      *excess = fmax(*excess, is / (s->tolerance * cpl_motion(loop, i) + s->absolute));
  }
  return TDM_OK;
}

/* The window has come to its last iteration and its residual is too large: go on with the best one. */
static tdm_status settle_for(cpl_loop *loop, double excess, bool again, tdm_error *err) {
  iteration *it = loop->own;
  loop->iterations.not_converged++;
  tdm_remark(TDM_NOTICE, "not_converged", "coupling.iterative", loop->t0,
             "the %d iterations of the window from %.6g s on did not converge; the smallest residual, %.3g of the "
             "tolerance, was taken: take a smaller coupling.n, or a larger coupling.iterative.max or tolerance",
             loop->settings->iterative.most, loop->t0, excess);
  const uint64_t left = loop->iterations.not_converged, all = loop->iterations.windows;
  if (left >= 10 && 10 * left > all)
    tdm_remark(
        TDM_WARNING, "not_converging", "coupling.iterative", loop->t0,
        "%llu of the first %llu windows did not converge, more than a tenth: the results do not keep "
        "coupling.iterative.tolerance; take a smaller coupling.n, or a larger coupling.iterative.max or tolerance",
        (unsigned long long)left, (unsigned long long)all);
  if (!again)
    return TDM_OK;
  if (restore(loop, err) != TDM_OK)
    return err->status;
  return solve(loop, it->best, &excess, err);
}

static tdm_status advance(cpl_loop *loop, tdm_error *err) {
  iteration *it = loop->own;
  const int most = loop->settings->iterative.most;
  const size_t size = CPL_APART * (size_t)loop->nbody * sizeof *it->guess;
  double excess = INFINITY, least = INFINITY;
  int count = 0;
  if (save(loop, err) != TDM_OK)
    return err->status;
  memset(it->guess, 0, size);
  cpl_accelerator_begin(it->accelerator);
  while (true) {
    if (solve(loop, it->guess, &excess, err) != TDM_OK)
      return err->status;
    count++;
    if (excess < least) {
      least = excess;
      memcpy(it->best, it->guess, size);
    }
    if (excess <= 1 || count == most)
      break;
    cpl_accelerator_step(it->accelerator, it->guess, it->residual, it->guess);
    if (restore(loop, err) != TDM_OK)
      return err->status;
  }
  loop->iterations.windows++;
  loop->iterations.all += (uint64_t)count;
  loop->iterations.largest = count > loop->iterations.largest ? count : loop->iterations.largest;
  return excess <= 1 ? TDM_OK : settle_for(loop, least, excess > least, err);
}

static const char *const of_mbd[] = {"acceleration", "mobility", "restore", NULL};
static const char *const of_dem[] = {"interface", "proxy", "restore", NULL};

const cpl_scheme cpl_scheme_iterative = {
    .name = "iterative",
    .summary = "the window of proxy, repeated until both solvers agree on its end",
    .needs = {[CPL_MBD] = of_mbd, [CPL_DEM] = of_dem},
    .mismatch_order = 4,
    .open = begin,
    .close = end,
    .advance = advance,
};
