/* What can be chosen before any trial: see choice.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/choice/choice.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- the DEM step ---- */

const char *const cpl_limit_names[CPL_LIMITS] = {"rayleigh", "eigenfrequency", "contact"};

static const double dense = 4; /* coordination number above which a bed is stiff */

double cpl_round_down(double x) {
  static const double round[] = {1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9};
  const int power = (int)floor(log10(x * (1 + 1e-9)));
  const double mantissa = x / pow(10, power) * (1 + 1e-9);
  double best = 1;
  for (unsigned k = 0; k < sizeof round / sizeof round[0]; k++)
    if (round[k] <= mantissa)
      best = round[k];
  char text[32]; /* for the double nearest to what people write */
  snprintf(text, sizeof text, "%ge%d", best, power);
  return strtod(text, NULL);
}

cpl_step cpl_choose_step(const cpl_limits *l) {
  cpl_step s = {
      .share = {[CPL_RAYLEIGH] = l->coordination > dense ? 0.2 : 0.4, [CPL_EIGENFREQUENCY] = 0.8, [CPL_CONTACT] = 0.05},
      .exact = INFINITY};
  for (int k = 0; k < CPL_LIMITS; k++)
    if (s.share[k] * l->time[k] < s.exact) {
      s.exact = s.share[k] * l->time[k];
      s.by = (cpl_limit)k;
    }
  s.dt = isfinite(s.exact) && s.exact > 0 ? cpl_round_down(s.exact) : 0;
  return s;
}

/* ---- the mechanism ---- */

const char *const cpl_formulation_words[CPL_FORMULATIONS] = {
    "one_step", "ggl with orders up to 2 and the modified corrector", "ggl"};

cpl_formulation cpl_choose_formulation(const cpl_facts *f) {
  return f->abrupt || f->flows || !(f->coordination > dense) ? CPL_ONE_STEP : CPL_LOW_ORDER;
}

static const double heavy = 100, longest = 10; /* times the heaviest particle; times 5 */

long cpl_first_n(const cpl_facts *f, double dt, double rayleigh_share) {
  const bool is_heavy = f->body >= heavy * f->heaviest;
  const double ratio = is_heavy && isfinite(rayleigh_share) ? fmin(fmax(rayleigh_share / dt, 1), longest) : 1;
  return lround(5 * ratio);
}

double cpl_path_n(double acceleration, double radius, double dt) {
  return acceleration > 0 ? fmax(1, sqrt(8 * 0.01 * radius / acceleration) / dt) : INFINITY;
}

bool cpl_estimate_too_large(double estimate, double single, double wanted) {
  return estimate > fmax(wanted, 2 * single);
}

long cpl_cheap_n(double window, double step) {
  const double n = step > 0 && window > 0 ? ceil(window / (0.05 * step)) : 1;
  return (long)fmin(fmax(n, 1), 1e5);
}

enum { TRIES = 6 };
static const double worth = 1.3; /* times the n that did well: a smaller step is not worth a trial */

cpl_n_search cpl_n_search_from(long good, double most) {
  return (cpl_n_search){.good = good, .bad = INFINITY, .most = most, .left = TRIES};
}

long cpl_n_search_next(const cpl_n_search *s) {
  const double good = (double)s->good, n = isinf(s->bad) ? s->most : sqrt(good * s->bad);
  const long round = n < 10 ? lround(n) : lround(cpl_round_down(n));
  return s->left > 0 && n > worth * good && round > s->good ? round : 0;
}

void cpl_n_search_tell(cpl_n_search *s, long n, bool did_well) {
  s->left--;
  if (did_well)
    s->good = n;
  else
    s->bad = (double)n;
}
