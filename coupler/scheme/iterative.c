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
#include "coupler/loop/solve.h"
#include "coupler/scheme/accelerate.h"
#include "coupler/scheme/schemes.h"
#include "coupler/state/mismatch.h"
#include "protocol/scene/remark.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SLOT = CPL_SLOT_SCHEME };

/* coupling.iterative */
typedef struct {
  double tolerance; /* largest residual, as a share of cpl_motion */
  double absolute;  /* and beside that [m] */
  int most;         /* iterations a window */
  cpl_accelerator_kind accelerator;
  int reuse; /* windows whose differences IQN-ILS keeps */
} settings;

/* What is kept from window to window, beside what the accelerator has learned. */
typedef struct {
  uint64_t windows; /* iterated on */
  uint64_t all;     /* iterations in them */
  int largest;      /* in one window */
  uint64_t not_converged;
  double excess; /* of the last window, beside what is allowed */
} statistics;

typedef struct {
  cpl_accelerator *accelerator;
  double *guess;      /* (nbody x 12) c as lengths: turns times the body's radius, rates times H */
  double *best;       /* (nbody x 12) that of the smallest residual */
  double *residual;   /* (nbody x 12) */
  double *correction; /* (nbody x 12) as it is sent */
} iteration;

/* ---- settings and statistics ---- */

/* A number of things, at most `most`. */
static int read_count(tdm_object *o, const char *key, long absent, long least, long most) {
  long count = tdm_get_integer(o, key, absent, least);
  if (count > most)
    tdm_object_fail(o, key, "is %ld; take at most %ld", count, most);
  return (int)count;
}

static void read_settings(void *own, tdm_object *o) {
  static const char *const accelerators[] = {[CPL_IQN_ILS] = "iqn-ils", [CPL_AITKEN] = "aitken"};
  settings *s = own;
  s->tolerance = tdm_get_number(o, "tolerance", 1e-4, TDM_POSITIVE);
  s->absolute = tdm_get_number(o, "absolute", 1e-10, TDM_NOT_NEGATIVE);
  s->most = read_count(o, "max", 20, 1, 1000);
  s->accelerator = (cpl_accelerator_kind)tdm_get_choice(o, "accelerator", accelerators, 2, CPL_IQN_ILS);
  s->reuse = read_count(o, "reuse", 3, 0, 100);
}

static size_t memory_size(int nbody) {
  (void)nbody;
  return sizeof(statistics);
}

static statistics *statistics_of(const cpl_loop *loop) {
  return (statistics *)(void *)loop->memory;
}

static double mean_iterations(const statistics *t) {
  return (double)t->all / (double)t->windows;
}

static void enter(const cpl_loop *loop, json_t *summary) {
  const statistics *t = statistics_of(loop);
  if (t->windows > 0)
    json_object_set_new(summary, "iterations",
                        json_pack("{s:f, s:i, s:I}", "mean", mean_iterations(t), "largest", t->largest,
                                  "windows_not_converged", (json_int_t)t->not_converged));
}

static void tell(const cpl_loop *loop, char *line, size_t size) {
  const statistics *t = statistics_of(loop);
  if (t->windows > 0)
    snprintf(line, size, "iterations a window: %.2f in the mean, %d at most", mean_iterations(t), t->largest);
}

/* ---- the run ---- */

static void end(cpl_loop *loop) {
  iteration *it = loop->own;
  cpl_accelerator_destroy(&it->accelerator);
  free(it->guess);
  free(it);
  loop->own = NULL;
}

static tdm_status begin(cpl_loop *loop, tdm_error *err) {
  const settings *s = loop->scheme_settings;
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

/* ---- a window ---- */

/* Both solvers over the window with the correction c. Sets the residual, and *excess to its size beside what is
 * allowed. */
static tdm_status solve(cpl_loop *loop, const double *c, double *excess, tdm_error *err) {
  iteration *it = loop->own;
  const settings *s = loop->scheme_settings;
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

/* The windows that did not converge are told, and that there are too many of them. */
static void tell_not_converged(cpl_loop *loop) {
  const settings *s = loop->scheme_settings;
  statistics *t = statistics_of(loop);
  if (t->excess <= 1)
    return;
  t->not_converged++;
  tdm_remark(TDM_NOTICE, "not_converged", "coupling.iterative", loop->t0,
             "the %d iterations of the window from %.6g s on did not converge; the smallest residual, %.3g of the "
             "tolerance, was taken: take a smaller coupling.n, or a larger coupling.iterative.max or tolerance",
             s->most, loop->t0, t->excess);
  if (t->not_converged >= 10 && 10 * t->not_converged > t->windows)
    tdm_remark(
        TDM_WARNING, "not_converging", "coupling.iterative", loop->t0,
        "%llu of the first %llu windows did not converge, more than a tenth: the results do not keep "
        "coupling.iterative.tolerance; take a smaller coupling.n, or a larger coupling.iterative.max or tolerance",
        (unsigned long long)t->not_converged, (unsigned long long)t->windows);
}

/* Without a correction both ends were apart by more than a tenth of the motion: more than curvature makes. */
static void look_for_change(const cpl_loop *loop, double excess) {
  const settings *s = loop->scheme_settings;
  const double change = 0.1;
  if (excess * s->tolerance > change)
    tdm_remark(TDM_NOTICE, "acted_inside", "coupling.n", loop->t0,
               "a stop, a slack cable, friction that turns or the kink of a table acted inside the window from %.6g s "
               "on: iterations follow it, but for what a load polynomial cannot show; a smaller coupling.n tells more",
               loop->t0);
}

/* The last iteration, with a residual that is too large: go on with the best one. */
static tdm_status settle_for_best(cpl_loop *loop, tdm_error *err) {
  iteration *it = loop->own;
  double excess;
  if (cpl_loop_restore(loop, SLOT, err) != TDM_OK)
    return err->status;
  return solve(loop, it->best, &excess, err);
}

static tdm_status advance(cpl_loop *loop, tdm_error *err) {
  iteration *it = loop->own;
  statistics *t = statistics_of(loop);
  const int most = ((const settings *)loop->scheme_settings)->most;
  const size_t size = CPL_APART * (size_t)loop->nbody * sizeof *it->guess;
  double excess = INFINITY, least = INFINITY;
  int count = 0;
  if (cpl_loop_save(loop, SLOT, err) != TDM_OK)
    return err->status;
  memset(it->guess, 0, size);
  cpl_accelerator_begin(it->accelerator);
  while (true) {
    if (solve(loop, it->guess, &excess, err) != TDM_OK)
      return err->status;
    if (count++ == 0)
      look_for_change(loop, excess);
    if (excess < least) {
      least = excess;
      memcpy(it->best, it->guess, size);
    }
    if (excess <= 1 || count == most)
      break;
    cpl_accelerator_step(it->accelerator, it->guess, it->residual, it->guess);
    if (cpl_loop_restore(loop, SLOT, err) != TDM_OK)
      return err->status;
  }
  const bool converged = excess <= 1;
  if (!converged && excess > least && settle_for_best(loop, err) != TDM_OK)
    return err->status;
  t->windows++;
  t->all += (uint64_t)count;
  t->largest = count > t->largest ? count : t->largest;
  t->excess = least;
  return TDM_OK;
}

const cpl_scheme cpl_scheme_iterative = {
    .name = "iterative",
    .summary = "the window of proxy, repeated until both solvers agree on its end",
    .needs = {[CPL_MBD] = CPL_ACCELERATION | CPL_MOBILITY | CPL_RESTORE,
              [CPL_DEM] = CPL_INTERFACE | CPL_PROXY | CPL_RESTORE},
    .mismatch_order = 4,
    .order = 5,
    .settings_size = sizeof(settings),
    .read = read_settings,
    .memory = memory_size,
    .open = begin,
    .close = end,
    .advance = advance,
    .keep = tell_not_converged,
    .enter = enter,
    .tell = tell,
};
