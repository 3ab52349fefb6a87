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
#include "coupler/scheme/accelerate.h"
#include "protocol/base/remark.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SLOT = 0 };

/* coupling.iterative */
typedef struct {
  double tolerance; /* largest residual, as a share of cpl_motion */
  double absolute;  /* and beside that [m] */
  int most;         /* iterations a window */
  cpl_accelerator_kind accelerator;
  int reuse; /* windows whose differences IQN-ILS keeps */
} iterative_settings;

typedef struct {
  cpl_accelerator *accelerator;
  double *guess;      /* (nbody x 12) c as lengths: turns times the body's radius, rates times H */
  double *best;       /* (nbody x 12) that of the smallest residual */
  double *residual;   /* (nbody x 12) */
  double *correction; /* (nbody x 12) as it is sent */

  /* statistics */
  uint64_t windows, iterations; /* iterated on; in all of them */
  uint64_t not_converged;       /* windows */
  int largest;                  /* iterations in one window */
} iteration;

/* A number of things, at most `most`. */
static int read_count(tdm_object *o, const char *key, long absent, long least, long most) {
  long count = tdm_get_integer(o, key, absent, least);
  if (count > most)
    tdm_object_fail(o, key, "is %ld; take at most %ld", count, most);
  return (int)count;
}

static void read(void *settings, tdm_object *o) {
  static const char *const accelerators[] = {[CPL_IQN_ILS] = "iqn-ils", [CPL_AITKEN] = "aitken"};
  iterative_settings *s = settings;
  s->tolerance = tdm_get_number(o, "tolerance", 1e-4, TDM_POSITIVE);
  s->absolute = tdm_get_number(o, "absolute", 1e-10, TDM_NOT_NEGATIVE);
  s->most = read_count(o, "max", 20, 1, 1000);
  s->accelerator = (cpl_accelerator_kind)tdm_get_choice(o, "accelerator", accelerators, 2, CPL_IQN_ILS);
  s->reuse = read_count(o, "reuse", 3, 0, 100);
}

static void end(cpl_loop *loop) {
  iteration *it = loop->own;
  cpl_accelerator_destroy(&it->accelerator);
  free(it->guess);
  free(it);
  loop->own = NULL;
}

static tdm_status begin(cpl_loop *loop, tdm_error *err) {
  const iterative_settings *s = loop->scheme_settings;
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
  const iterative_settings *s = loop->scheme_settings;
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
  const int most = ((const iterative_settings *)loop->scheme_settings)->most;
  it->not_converged++;
  tdm_remark(TDM_NOTICE, "not_converged", "coupling.iterative", loop->t0,
             "the %d iterations of the window from %.6g s on did not converge; the smallest residual, %.3g of the "
             "tolerance, was taken: take a smaller coupling.n, or a larger coupling.iterative.max or tolerance",
             most, loop->t0, excess);
  const uint64_t left = it->not_converged, all = it->windows;
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
  const int most = ((const iterative_settings *)loop->scheme_settings)->most;
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
  it->windows++;
  it->iterations += (uint64_t)count;
  it->largest = count > it->largest ? count : it->largest;
  return excess <= 1 ? TDM_OK : settle_for(loop, least, excess > least, err);
}

static double mean_iterations(const iteration *it) {
  return (double)it->iterations / (double)it->windows;
}

static void enter(const cpl_loop *loop, json_t *summary) {
  const iteration *it = loop->own;
  if (it->windows > 0)
    json_object_set_new(summary, "iterations",
                        json_pack("{s:f, s:i, s:I}", "mean", mean_iterations(it), "largest", it->largest,
                                  "windows_not_converged", (json_int_t)it->not_converged));
}

static void tell(const cpl_loop *loop, char *line, size_t size) {
  const iteration *it = loop->own;
  if (it->windows > 0)
    snprintf(line, size, "iterations a window: %.2f in the mean, %d at most", mean_iterations(it), it->largest);
}

static const char *const of_mbd[] = {"acceleration", "mobility", "restore", NULL};
static const char *const of_dem[] = {"interface", "proxy", "restore", NULL};

const cpl_scheme cpl_scheme_iterative = {
    .name = "iterative",
    .summary = "the window of proxy, repeated until both solvers agree on its end",
    .needs = {[CPL_MBD] = of_mbd, [CPL_DEM] = of_dem},
    .mismatch_order = 4,
    .settings_size = sizeof(iterative_settings),
    .read = read,
    .open = begin,
    .close = end,
    .advance = advance,
    .enter = enter,
    .tell = tell,
};
