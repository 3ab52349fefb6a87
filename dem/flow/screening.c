/* Measures of screening: see screening.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/flow/screening.h"

#include "dem/seam/homes.h"
#include "protocol/scene/remark.h"

#include <inttypes.h>
#include <math.h>

/* round-off in step times may not decide which step begins to count */
static bool counting(const dem_data *d) {
  return d->state.screening->time >= d->model->screening.start - 1e-6 * d->model->dt;
}

static uint64_t product_inside(const dem_data *d) {
  const int first = dem_home_first_particle(d), end = dem_home_end_particle(d);
  long n = 0;
#pragma omp parallel for schedule(static) num_threads(d->work.nthread) if (d->work.nthread > 1) reduction(+ : n)
  for (int i = first; i < end; i++)
    n += d->model->material[d->state.material[i]].product;
  return (uint64_t)dem_homes_sum(d, n);
}

void dem_screening_begin(dem_data *d) {
  if (d->model->screening.ndeck == 0)
    return;
  d->state.screening->initial = product_inside(d);
  d->state.screening->time = d->model->time_start;
}

void dem_screening_step(dem_data *d, double t) {
  if (d->model->screening.ndeck > 0)
    d->state.screening->time = t;
}

/* how much of a smoothed rate is left after a time [s] */
static double decay(const dem_data *d, double age) {
  return exp(-age / d->model->screening.smoothing);
}

void dem_screening_count(dem_data *d, int sink, int i) {
  const dem_screening_def *s = &d->model->screening;
  const int k = s->ndeck > 0 ? s->deck_of[sink] : -1;
  if (k < 0 || !d->model->material[d->state.material[i]].product)
    return;
  if (!counting(d)) {
    d->state.screening->early++;
    return;
  }
  dem_deck_state *now = &d->state.deck[k];
  const double mass = d->state.mass[i], t = d->state.screening->time;
  const bool sorted = d->state.sphere[i].radius >= s->deck[k].sorted;
  now->sorted += sorted;
  now->undersized += !sorted;
  *(sorted ? &now->sorted_mass : &now->undersized_mass) += mass;
  now->rate = now->rate * decay(d, t - now->rate_time) + mass / s->smoothing;
  now->rate_time = t;
}

/* ---- measures ---- */

/* 100 a/(a + b), NaN for nothing */
static double percent(double a, double b) {
  return a + b > 0 ? 100 * a / (a + b) : NAN;
}

double dem_deck_efficiency(const dem_deck_state *k, bool by_mass) {
  return by_mass ? percent(k->sorted_mass, k->undersized_mass) : percent((double)k->sorted, (double)k->undersized);
}

double dem_deck_share(const dem_deck_state *k) {
  return percent(k->undersized_mass, k->sorted_mass);
}

double dem_deck_rate(const dem_data *d, int deck) {
  const dem_deck_state *k = &d->state.deck[deck];
  const double since = d->state.screening->time - d->model->screening.start;
  return since > 1e-6 * d->model->dt ? (k->sorted_mass + k->undersized_mass) / since : NAN;
}

double dem_deck_rate_now(const dem_data *d, int deck) {
  const dem_deck_state *k = &d->state.deck[deck];
  return k->rate * decay(d, d->state.screening->time - k->rate_time);
}

double dem_screening_efficiency(const dem_data *d, bool by_mass) {
  const int n = d->model->screening.ndeck;
  double sum = 0;
  for (int k = 0; k < n; k++)
    sum += dem_deck_efficiency(&d->state.deck[k], by_mass);
  return sum / n;
}

dem_screening_balance dem_screening_balance_of(const dem_data *d) {
  const dem_model *m = d->model;
  dem_screening_balance b = {.fed = d->state.screening->initial - d->state.screening->early,
                             .inside = product_inside(d)};
  for (int s = 0; s < m->nsource; s++)
    b.fed += m->material[m->source[s].material].product ? d->state.source[s].made : 0;
  for (int k = 0; k < m->screening.ndeck; k++)
    b.out += d->state.deck[k].sorted + d->state.deck[k].undersized;
  b.lost = (int64_t)(b.fed - b.inside - b.out);
  return b;
}

void dem_screening_watch(dem_data *d, double t) {
  if (d->model->screening.ndeck == 0)
    return;
  const dem_screening_balance b = dem_screening_balance_of(d);
  const uint64_t lost = (uint64_t)b.lost;
  if (lost == d->state.screening->lost)
    return;
  d->state.screening->lost = lost;
  tdm_remark(TDM_WARNING, "screening", "dem.screening", t,
             "of %" PRIu64 " particles fed %" PRIu64 " are inside and %" PRIu64 " left by the decks' outlets: %" PRId64
             " left in another way, by t = %.9g s; close the way, or make its sink an outlet of a deck",
             b.fed, b.inside, b.out, b.lost, t);
}
