/* The search: Brent's method for one parameter, Nelder and Mead's simplex for more, both GSL's, on the square of the
 * misfit, which is smooth where runs meet the target. See calibration.h.
 *
 * A try without a misfit counts as one far worse than all others, so both methods turn away from it.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/calibrate/calibration.h"

#include <gsl/gsl_min.h>
#include <gsl/gsl_multimin.h>
#include <gsl/gsl_qrng.h>
#include <stdlib.h>
#include <string.h>

static const double bad = 1e30;        /* of a try without a misfit; others are below */
static const double first_step = 0.2;  /* of the simplex */
static const double same_share = 1e-9; /* misfits that differ by less of the largest are the same */

typedef struct {
  cpl_calibration *c;
  tdm_error *err;
  bool spent;  /* no further try is allowed */
  double last; /* place of the only parameter that was asked for last */
} search;

static bool is_over(const search *s) {
  return s->spent || s->err->status != TDM_OK;
}

static int tries_left(const search *s) {
  int used = 0;
  for (int i = 0; i < s->c->ntry; i++)
    used += !s->c->tried[i].aside;
  return s->c->o->tries - used;
}

static double square_of(const cpl_try *t) {
  return isnan(t->misfit) ? bad : fmin(t->misfit * t->misfit, 0.1 * bad);
}

/* Try n places, of new ones as many as may be. */
static void look_at(search *s, int n, double (*place)[CPL_PARAMETERS]) {
  int which[64], most = 0;
  for (int left = tries_left(s); most < n; most++) {
    left -= cpl_try_find(s->c, place[most]) < 0;
    if (left < 0)
      break;
  }
  s->spent = s->spent || most < n;
  if (s->err->status == TDM_OK)
    cpl_try_all(s->c, most, place, false, which, s->err);
}

/* What the minimisers ask for. */
static double square_at(search *s, const double *place) {
  double one[1][CPL_PARAMETERS] = {{0}};
  for (int k = 0; k < s->c->nparameter; k++)
    one[0][k] = place[k];
  if (!is_over(s))
    look_at(s, 1, one);
  const int i = cpl_try_find(s->c, place);
  return i < 0 ? bad : square_of(&s->c->tried[i]);
}

/* All misfits are the same: nothing to go by. */
static bool is_flat(const cpl_calibration *c) {
  double least = INFINITY, most = -INFINITY;
  int n = 0;
  for (int i = 0; i < c->ntry; i++)
    if (!isnan(c->tried[i].misfit)) {
      least = fmin(least, c->tried[i].misfit);
      most = fmax(most, c->tried[i].misfit);
      n++;
    }
  return n > c->nparameter && most - least <= same_share * most;
}

/* The start. What a solver has against a key that is new in the scene ends the search: all tries would fail of it. */
static void look_at_start(search *s) {
  const cpl_calibration *c = s->c;
  double place[1][CPL_PARAMETERS] = {{0}};
  for (int k = 0; k < c->nparameter; k++)
    place[0][k] = cpl_place_of(&c->parameter[k], c->parameter[k].start);
  look_at(s, 1, place);
  const int first = is_over(s) ? -1 : cpl_try_find(c, place[0]);
  for (int k = 0; first >= 0 && isnan(c->tried[first].misfit) && k < c->nparameter && !is_over(s); k++) {
    const cpl_parameter *p = &c->parameter[k];
    const char *found = p->new ? strstr(c->tried[first].reason, p->path) : NULL;
    if (found && strncmp(found + strlen(p->path), ": ", 2) == 0)
      tdm_fail(s->err, TDM_ERR_ARGUMENT, NULL,
               "--parameter %s, which the scene does not have, was tried with %g: %s; name another path, or start "
               "elsewhere with --set %s=VALUE",
               p->path, p->start, c->tried[first].reason, p->path);
  }
}

/* ---- one parameter ---- */

/* Tries by their place. */
typedef struct {
  int n;
  double *u, *f; /* (n) owned */
} profile;

static tdm_status make_profile(const search *s, profile *p) {
  const cpl_calibration *c = s->c;
  *p = (profile){.u = malloc(((size_t)c->ntry + 1) * sizeof *p->u), .f = malloc(((size_t)c->ntry + 1) * sizeof *p->f)};
  if (!p->u || !p->f)
    return tdm_fail(s->err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i < c->ntry; i++) {
    int at = p->n++;
    for (; at > 0 && p->u[at - 1] > c->tried[i].place[0]; at--) {
      p->u[at] = p->u[at - 1];
      p->f[at] = p->f[at - 1];
    }
    p->u[at] = c->tried[i].place[0];
    p->f[at] = square_of(&c->tried[i]);
  }
  return TDM_OK;
}

static void free_profile(profile *p) {
  free(p->u);
  free(p->f);
}

/* Three places of which the middle one is the best, by halving towards an end that is; false: there are none. */
typedef struct {
  double u[3], f[3];
} bracket;

/* Of the tries so far; else the place to try next. */
static bool find_bracket(const profile *p, bracket *b, double *next) {
  int best = 0;
  for (int i = 1; i < p->n; i++)
    best = p->f[i] < p->f[best] ? i : best;
  int low = best, high = best;
  while (low >= 0 && !(p->f[low] > p->f[best]))
    low--;
  while (high < p->n && !(p->f[high] > p->f[best]))
    high++;
  const bool found = low >= 0 && high < p->n;
  const int beside = high < p->n ? best + 1 : best - 1;
  if (found)
    *b = (bracket){{p->u[low], p->u[best], p->u[high]}, {p->f[low], p->f[best], p->f[high]}};
  else
    *next = beside < 0 || beside >= p->n ? p->u[best] : 0.5 * (p->u[best] + p->u[beside]);
  return found;
}

/* The start, the ends and between them, then halves. Returns whether there is a bracket. */
static bool look_around(search *s, bracket *b) {
  double place[5][CPL_PARAMETERS] = {{0}};
  look_at_start(s);
  for (int i = 0; i < 5; i++)
    place[i][0] = 0.25 * i;
  if (!is_over(s))
    look_at(s, 5, place);
  for (int i = 0; i < 4; i++)
    place[i][0] = 0.125 + 0.25 * i;
  if (!is_over(s) && s->c->best < 0)
    look_at(s, 4, place);
  while (!is_over(s) && s->c->best >= 0 && !is_flat(s->c)) {
    profile p;
    double next[1][CPL_PARAMETERS] = {{0}};
    const bool found = make_profile(s, &p) == TDM_OK && find_bracket(&p, b, &next[0][0]);
    free_profile(&p);
    const double gap = fabs(next[0][0] - s->c->tried[s->c->best].place[0]);
    if (found || is_over(s) || gap < 0.5 * s->c->o->tolerance)
      return found;
    look_at(s, 1, next);
  }
  return false;
}

static double square_of_one(double u, void *context) {
  const double place[CPL_PARAMETERS] = {u};
  ((search *)context)->last = u;
  return square_at(context, place);
}

static void by_brent(search *s) {
  bracket b = {{0}, {0}};
  if (!look_around(s, &b))
    return;
  gsl_min_fminimizer *m = gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent);
  gsl_function f = {.function = square_of_one, .params = s};
  if (!m || gsl_min_fminimizer_set_with_values(m, &f, b.u[1], b.f[1], b.u[0], b.f[0], b.u[2], b.f[2]) != 0) {
    tdm_fail(s->err, TDM_ERR_MEMORY, NULL, "out of memory");
    gsl_min_fminimizer_free(m);
    return;
  }
  /* steps from the best place that have become small twice are an end, too: one side of the interval may stay where it
   * is. A long step that finds nothing better is none */
  for (int small = 0; !is_over(s) && small < 2;) {
    const double before = gsl_min_fminimizer_x_minimum(m);
    if (gsl_min_fminimizer_iterate(m) != 0)
      break;
    const double width = gsl_min_fminimizer_x_upper(m) - gsl_min_fminimizer_x_lower(m);
    small = fabs(s->last - before) < 0.2 * s->c->o->tolerance ? small + 1 : 0;
    if (width < s->c->o->tolerance)
      break;
  }
  gsl_min_fminimizer_free(m);
}

/* Places that are lower than all up to a hill half as high again on both sides, or to an end. */
static int count_valleys(const search *s) {
  profile p = {0};
  int n = 0, lowest = 0, highest = 0;
  bool down = true; /* since the last hill */
  if (make_profile(s, &p) == TDM_OK)
    for (int i = 0; i < p.n; i++) {
      lowest = p.f[i] < p.f[lowest] ? i : lowest;
      highest = p.f[i] > p.f[highest] ? i : highest;
      if (down && p.f[i] > 2.25 * p.f[lowest]) {
        down = false;
        highest = i;
        n++;
      } else if (!down && 2.25 * p.f[i] < p.f[highest]) {
        down = true;
        lowest = i;
      }
    }
  free_profile(&p);
  return n + (down && p.n > 0);
}

/* ---- more parameters ---- */

static double square_of_several(const gsl_vector *u, void *context) {
  double place[CPL_PARAMETERS] = {0};
  for (size_t k = 0; k < u->size; k++)
    place[k] = gsl_vector_get(u, k);
  return square_at(context, place);
}

/* Where runs at the start fail: others, spread over the ranges. */
static void look_elsewhere(search *s) {
  const int n = s->c->nparameter;
  double place[8][CPL_PARAMETERS] = {{0}};
  gsl_qrng *q = gsl_qrng_alloc(gsl_qrng_sobol, (unsigned)n);
  for (int i = 0; q && i < 8; i++)
    gsl_qrng_get(q, place[i]);
  if (q)
    look_at(s, 8, place);
  gsl_qrng_free(q);
}

/* The corners of the first simplex, side by side; the minimiser asks for the same ones. */
static void first_corners(search *s, const gsl_vector *u, const gsl_vector *step) {
  const int n = s->c->nparameter;
  double place[CPL_PARAMETERS][CPL_PARAMETERS] = {{0}};
  for (int i = 0; i < n; i++)
    for (int k = 0; k < n; k++)
      place[i][k] = gsl_vector_get(u, (size_t)k) + (i == k ? gsl_vector_get(step, (size_t)k) : 0);
  look_at(s, n, place);
}

static void go_on_with(search *s, gsl_multimin_fminimizer *m) {
  while (!is_over(s) && !is_flat(s->c)) {
    if (gsl_multimin_fminimizer_iterate(m) != 0 || gsl_multimin_fminimizer_size(m) < s->c->o->tolerance)
      return;
  }
}

static void by_simplex(search *s) {
  const size_t n = (size_t)s->c->nparameter;
  look_at_start(s);
  if (!is_over(s) && s->c->best < 0)
    look_elsewhere(s);
  if (s->c->best < 0)
    return;
  const double *from = s->c->tried[s->c->best].place;
  gsl_vector *u = gsl_vector_alloc(n), *step = gsl_vector_alloc(n);
  gsl_multimin_fminimizer *m = gsl_multimin_fminimizer_alloc(gsl_multimin_fminimizer_nmsimplex2, n);
  gsl_multimin_function f = {.f = square_of_several, .n = n, .params = s};
  if (u && step && m) {
    for (size_t k = 0; k < n; k++) {
      gsl_vector_set(u, k, from[k]);
      gsl_vector_set(step, k, from[k] + first_step > 1 ? -first_step : first_step);
    }
    first_corners(s, u, step);
    if (!is_over(s) && gsl_multimin_fminimizer_set(m, &f, u, step) == 0)
      go_on_with(s, m);
  } else {
    tdm_fail(s->err, TDM_ERR_MEMORY, NULL, "out of memory");
  }
  gsl_multimin_fminimizer_free(m);
  gsl_vector_free(u);
  gsl_vector_free(step);
}

/* ---- the end ---- */

/* The best value of some parameter lies at an end of its range. */
static bool mark_ends(cpl_calibration *c) {
  bool any = false;
  for (int k = 0; k < c->nparameter && c->best >= 0; k++) {
    const double u = c->tried[c->best].place[k];
    c->parameter[k].at_end = fmin(u, 1 - u) < c->o->tolerance;
    any = any || c->parameter[k].at_end;
  }
  return any;
}

tdm_status cpl_search(cpl_calibration *c, tdm_error *err) {
  search s = {.c = c, .err = err};
  if (c->nparameter == 1)
    by_brent(&s);
  else
    by_simplex(&s);
  const bool at_end = mark_ends(c);
  if (c->nparameter == 1 && err->status == TDM_OK)
    c->valleys = count_valleys(&s);
  c->ending = err->status == TDM_ERR_INTERRUPTED ? CPL_INTERRUPTED
              : err->status != TDM_OK            ? CPL_FAILED
              : c->best < 0                      ? CPL_FAILED
              : is_flat(c)                       ? CPL_FLAT
              : s.spent                          ? CPL_SPENT
              : at_end                           ? CPL_AT_LIMIT
                                                 : CPL_CONVERGED;
  return err->status;
}
