/* The error of a run, estimated: see error.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/estimate/error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const cpl_quantity_names[CPL_QUANTITIES] = {"position", "velocity", "angle", "angular_velocity"};
const char *const cpl_quantity_units[CPL_QUANTITIES] = {"m", "m/s", "rad", "rad/s"};

enum { LEAST_ROWS = 8, TERMS = 3 };
static const double good_fit = 0.95;  /* share of the variance that a linear motion must explain to be gone by, of the
                                       * way and of the rate */
static const double pace_share = 0.2; /* of the motion's own time, spread of the way over that of the rate: faster than
                                       * that is jitter */
static const double least_spans = 0.05; /* ... and of the run */

/* ---- least squares ---- */

/* y = sum_j c[j] x[j] over rows: what is left of the sum of squares. */
typedef struct {
  int n; /* terms, at most TERMS */
  double xx[TERMS][TERMS], xy[TERMS], yy;
} fit;

static void fit_add(fit *f, const double *x, double y) {
  for (int i = 0; i < f->n; i++) {
    for (int j = 0; j < f->n; j++)
      f->xx[i][j] += x[i] * x[j];
    f->xy[i] += x[i] * y;
  }
  f->yy += y * y;
}

/* By Cholesky's factors of the scaled normal equations; a term that the ones before it tell is left out (0). Returns
 * the share of y's sum of squares that is explained. */
static double fit_solve(const fit *f, double *c) {
  double L[TERMS][TERMS] = {{0}}, z[TERMS] = {0}, scale[TERMS], explained = 0;
  for (int i = 0; i < f->n; i++) {
    scale[i] = f->xx[i][i] > 0 ? 1 / sqrt(f->xx[i][i]) : 0;
    double diagonal = scale[i] > 0 ? 1 : 0, right = scale[i] * f->xy[i];
    for (int j = 0; j < i; j++) {
      double sum = scale[i] * scale[j] * f->xx[i][j];
      for (int k = 0; k < j; k++)
        sum -= L[i][k] * L[j][k];
      L[i][j] = L[j][j] > 0 ? sum / L[j][j] : 0;
      diagonal -= L[i][j] * L[i][j];
      right -= L[i][j] * z[j];
    }
    L[i][i] = diagonal > 1e-9 ? sqrt(diagonal) : 0;
    z[i] = L[i][i] > 0 ? right / L[i][i] : 0;
    explained += z[i] * z[i];
  }
  for (int i = f->n - 1; i >= 0; i--) {
    double sum = z[i];
    for (int k = i + 1; k < f->n; k++)
      sum -= L[k][i] * c[k];
    c[i] = L[i][i] > 0 ? sum / L[i][i] : 0;
  }
  for (int i = 0; i < f->n; i++)
    c[i] *= scale[i];
  return f->yy > 0 ? explained / f->yy : 1;
}

/* ---- one part of the motion ---- */

/* Way along an axis or turn about it, at the rows of a trace. */
typedef struct {
  const cpl_trace *trace;
  int k, n;
} part;

static const cpl_trace_row *row_of(const part *p, int i) {
  return i < p->trace->nrow ? &p->trace->row[i] : &p->trace->last;
}

static part part_of(const cpl_trace *t, int k) {
  return (part){t, k, t->nrow + (t->last.t > t->row[t->nrow - 1].t)};
}

/* What the motion is like, by least squares over its integrals, in which noise counts less:
 *
 *   x'' = p + q x + s x'       the swing of body and particles; q = s = 0 where it is no such motion
 *   F = c - m (x'' - p0)       what the particles add to the inertia; their load */
typedef struct {
  double q, s, added, load;
  double wild; /* share of the rate's variance that no swing tells, as far as blows make it */
} linear;

/* The share of the rate's variance that the swing c does not tell, but for what the exchange itself shakes it by. The
 * integrals hide blows. */
static double untold_share(const part *p, const double c[TERMS]) {
  const cpl_trace_row *first = row_of(p, 0), *before = first;
  double once = 0, rest = 0, sum = 0, square = 0;
  for (int i = 1; i < p->n; i++) {
    const cpl_trace_row *r = row_of(p, i);
    const double h = r->t - before->t, rate = r->rate[p->k];
    once += 0.5 * h * (before->way[p->k] + r->way[p->k]);
    const double off = rate - first->rate[p->k] - c[0] * r->t - c[1] * once - c[2] * r->way[p->k];
    rest += h * off * off;
    sum += h * rate;
    square += h * rate * rate;
    before = r;
  }
  const double time = before->t - first->t, shaken = 4 * (before->jolt[p->k] - first->jolt[p->k]);
  const double variance = square - sum * sum / time;
  return variance > 0 ? fmin(1, fmax(0, (rest - shaken) / variance)) : 0;
}

/* How far the acceleration consists of blows, 0 to 1: its mean size squared is 2/pi of its mean square where it is
 * noise, more in swings of any number of frequencies that a few modes have, and but the blows' share of time where
 * nothing is between them. */
static double blows_share(const part *p) {
  const cpl_trace_row *first = row_of(p, 0), *last = row_of(p, p->n - 1), *before = first;
  const double time = last->t - first->t, mean = (last->rate[p->k] - first->rate[p->k]) / time;
  double size = 0, square = 0;
  for (int i = 1; i < p->n; i++) {
    const cpl_trace_row *r = row_of(p, i);
    const double h = r->t - before->t, off = (r->rate[p->k] - before->rate[p->k]) / h - mean;
    size += h * fabs(off);
    square += h * off * off;
    before = r;
  }
  return square > 0 ? fmax(0, 1 - M_PI / 2 * size * size / (time * square)) : 0;
}

static linear motion_of(const part *p) {
  linear l = {0};
  fit swing = {.n = 3}, weight = {.n = 2};
  double once = 0, twice = 0, c[TERMS];
  const cpl_trace_row *first = row_of(p, 0), *before = first;
  for (int i = 1; i < p->n; i++) {
    const cpl_trace_row *r = row_of(p, i);
    const double h = r->t - before->t, way = before->way[p->k], gained = r->rate[p->k] - first->rate[p->k];
    twice += h * once + h * h * (way / 3 + r->way[p->k] / 6);
    once += 0.5 * h * (way + r->way[p->k]);
    fit_add(&swing, (double[]){0.5 * r->t * r->t, twice, once}, r->way[p->k] - first->rate[p->k] * r->t);
    fit_add(&weight, (double[]){r->t, gained}, r->given[p->k]);
    before = r;
  }
  const bool swings = fit_solve(&swing, c) > good_fit;
  l.wild = untold_share(p, c) * blows_share(p);
  if (swings) {
    l.q = fmin(c[1], 0);
    l.s = fmin(c[2], 0);
  }
  fit_solve(&weight, c);
  l.load = c[0];
  l.added = fmax(0, -c[1]);
  return l;
}

/* e'' = q e + s e' over h, from (e, e'). */
static void swing_on(const linear *l, double h, double e[2]) {
  const double half = 0.5 * l->s, square = half * half + l->q, w = sqrt(fabs(square)), decay = exp(half * h);
  const double c = square > 0 ? cosh(w * h) : cos(w * h);
  const double s = w * h < 1e-9 ? h : (square > 0 ? sinh(w * h) : sin(w * h)) / w;
  const double place = decay * ((c - half * s) * e[0] + s * e[1]);
  const double rate = decay * (l->q * s * e[0] + (c + half * s) * e[1]);
  e[0] = place;
  e[1] = rate;
}

/* Means over time of squares, of way [0] and rate [1]. */
typedef struct {
  double spread[2], coupling[2], fill[2];
  double local; /* of the rate: of the windows' own defects, a part of the coupling's */
} squares;

/* Way [0] and rate [1] at a time, on a straight line between rows; *at: the row before, found from where it was. */
static void motion_at(const part *p, double t, int *at, double out[2]) {
  while (*at > 0 && row_of(p, *at)->t > t)
    --*at;
  while (*at < p->n - 2 && row_of(p, *at + 1)->t < t)
    ++*at;
  const cpl_trace_row *a = row_of(p, *at), *b = row_of(p, *at + 1);
  const double s = fmax(0, fmin(1, (t - a->t) / (b->t - a->t)));
  out[0] = a->way[p->k] + s * (b->way[p->k] - a->way[p->k]);
  out[1] = a->rate[p->k] + s * (b->rate[p->k] - a->rate[p->k]);
}

/* As far as the motion is no linear swing its pace depends on its energy, and blows come too early or too late. With
 * the share w of energy that the exchange has made of what the motion has, a body that flies between blows (between
 * walls, or up and down by its weight) goes faster by w/2 and needs so much more or less time for its way: it is ahead
 * by the integral of w/2 over time, and what it makes in that time is its error. Drivers that give and take as much
 * energy as the motion has set its pace themselves. `energy`: of the body's whole motion. Adds means times time of the
 * squares to `sum`, of way and rate. */
static void add_shift(const part *p, const linear *l, double energy, double sum[2]) {
  const int k = p->k;
  const cpl_trace_row *before = row_of(p, 0);
  double shift = 0, share = 0;
  int at = 0;
  for (int i = 1; energy > p->trace->driven && i < p->n; i++) {
    const cpl_trace_row *r = row_of(p, i);
    const double h = r->t - before->t, now = l->wild * r->made / energy;
    double there[2];
    shift += 0.25 * h * (share + now);
    share = now;
    motion_at(p, r->t + shift, &at, there);
    sum[0] += h * (pow(there[0] - r->way[k], 2) + pow(share * r->way[k], 2));
    sum[1] += h * (pow(there[1] - r->rate[k], 2) + pow(0.5 * share * r->rate[k], 2));
    before = r;
  }
}

/* The error of the exchange and the motion of the fill, carried on by the swing: impulses too much, over the inertia of
 * body and particles. To the first comes what a window's own defect does to the body alone, before the particles
 * answer. */
static squares carry(const part *p, const linear *l, double energy) {
  squares s = {0};
  const int k = p->k;
  const cpl_trace *t = p->trace;
  const double inertia = t->mass[k] + l->added, half_window = 0.5 * t->end.t / (double)t->windows;
  const cpl_trace_row *first = row_of(p, 0), *before = first;
  double coupling[2] = {0}, fill[2] = {0}, owed = 0, own = 0, mean[2] = {0}, square[2] = {0}, local[2] = {0};
  for (int i = 1; i < p->n; i++) {
    const cpl_trace_row *r = row_of(p, i);
    const double h = r->t - before->t, late = (r->late[k] - before->late[k]) / h;
    const double now_owed = (r->owed[k] + 0.5 * l->added * late) / inertia;
    const double now_own = (r->given[k] - l->load * r->t + l->added * (r->rate[k] - first->rate[k])) / inertia;
    const double value[2] = {r->way[k], r->rate[k]};
    swing_on(l, h, coupling);
    swing_on(l, h, fill);
    coupling[1] += now_owed - owed;
    fill[1] += now_own - own;
    owed = now_owed;
    own = now_own;
    for (int j = 0; j < 2; j++) {
      mean[j] += h * value[j];
      square[j] += h * value[j] * value[j];
      s.coupling[j] += h * coupling[j] * coupling[j];
      s.fill[j] += h * fill[j] * fill[j];
    }
    local[1] += r->jolt[k] - before->jolt[k];
    local[0] += r->slip[k] - before->slip[k] + half_window * half_window * (r->jolt[k] - before->jolt[k]);
    before = r;
  }
  add_shift(p, l, energy, s.coupling);
  const double time = before->t - first->t;
  for (int j = 0; j < 2; j++) {
    s.spread[j] = fmax(0, square[j] / time - mean[j] * mean[j] / (time * time));
    s.coupling[j] = (s.coupling[j] + local[j]) / time;
    s.fill[j] /= time;
  }
  s.local = local[1] / time;
  return s;
}

/* ---- rattle ---- */

static int by_size(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* The square of the jitter of the rate that the load makes [unit of the rate, squared]: what is left of the impulse
 * beside the parabola through 2 m + 1 rows around. Blocks of so many rows are looked at; the upper quartile of them
 * counts, so that single blows do not. `block` has room for n numbers. */
static double jitter(const part *p, int m, double *block) {
  const int rows = 2 * m + 1;
  double n = rows, s2 = 0, s4 = 0, sum = 0;
  int nblock = 0, inside = 0;
  for (int j = -m; j <= m; j++) {
    s2 += (double)j * j;
    s4 += (double)j * j * j * j;
  }
  for (int i = m; i + m < p->n; i++) {
    double smooth = 0;
    for (int j = -m; j <= m; j++)
      smooth += (s4 - s2 * j * j) / (n * s4 - s2 * s2) * row_of(p, i + j)->given[p->k];
    const double rest = (row_of(p, i)->given[p->k] - smooth) / p->trace->mass[p->k];
    sum += rest * rest;
    if (++inside == rows) {
      block[nblock++] = sum / rows;
      sum = 0;
      inside = 0;
    }
  }
  qsort(block, (size_t)nblock, sizeof *block, by_size);
  return nblock > 0 ? block[3 * nblock / 4] : NAN;
}

/* ---- all of them ---- */

/* Does the body move in this part? Else joints hold it there, and no error of a load matters. */
static bool moves(const cpl_trace *t, int k) {
  double energy = 0, all = 0;
  for (int i = 0; i < t->nrow; i++)
    for (int j = 0; j < CPL_PARTS; j++) {
      const double e = t->mass[j] * t->row[i].rate[j] * t->row[i].rate[j];
      energy += j == k ? e : 0;
      all += e;
    }
  return energy > 1e-12 * all;
}

/* All parts of a body. */
typedef struct {
  const cpl_trace *trace;
  bool moves[CPL_PARTS];
  linear motion[CPL_PARTS];
  double energy; /* of the motion: twice the mean of the kinetic one [J] */
} body;

/* Mean over time of the rate's square. */
static double square_of_rate(const part *p) {
  const cpl_trace_row *first = row_of(p, 0), *before = first;
  double sum = 0;
  for (int i = 1; i < p->n; i++) {
    const cpl_trace_row *r = row_of(p, i);
    sum += (r->t - before->t) * r->rate[p->k] * r->rate[p->k];
    before = r;
  }
  return sum / (before->t - first->t);
}

static body body_of(const cpl_trace *t) {
  body b = {.trace = t};
  for (int k = 0; k < CPL_PARTS; k++) {
    const part p = part_of(t, k);
    b.moves[k] = moves(t, k);
    if (!b.moves[k])
      continue;
    b.motion[k] = motion_of(&p);
    b.energy += (t->mass[k] + b.motion[k].added) * square_of_rate(&p);
  }
  return b;
}

/* The ways [0] or the turns [1] of the body: positions and velocities of them. */
static void estimate_half(const body *b, int half, double *block, cpl_error *error) {
  const cpl_trace *t = b->trace;
  squares all = {0};
  double rattle = 0;
  for (int k = 3 * half; k < 3 * half + 3; k++) {
    const part p = part_of(t, k);
    if (!b->moves[k])
      continue;
    const squares s = carry(&p, &b->motion[k], b->energy);
    error->added[k] = b->motion[k].added;
    for (int j = 0; j < 2; j++) {
      all.coupling[j] += s.coupling[j];
      all.fill[j] += s.fill[j];
      all.spread[j] += s.spread[j];
    }
    all.local += s.local;
  }
  /* jitter is what is faster than the motion itself */
  const double time = t->last.t, pace = sqrt(all.spread[0] / all.spread[1]);
  const double span = fmin(pace_share * (isfinite(pace) ? pace : time), least_spans * time);
  const int m = (int)fmax(2, round(0.5 * span * (t->nrow - 1) / time));
  for (int k = 3 * half; k < 3 * half + 3; k++) {
    const part p = part_of(t, k);
    if (b->moves[k])
      rattle += jitter(&p, m, block);
  }
  rattle = fmax(0, 2 * rattle - 4 * all.local); /* two runs; without what the exchange itself makes jitter */
  for (int j = 0; j < 2; j++) {
    cpl_error_of *of = &error->of[2 * half + j];
    const double jittered = j == 1 ? rattle : rattle * span * span;
    of->coupling = sqrt(all.coupling[j]);
    of->rattle = sqrt(jittered);
    of->rms = sqrt(all.coupling[j] + jittered);
    of->spread = sqrt(all.spread[j]);
    of->share = of->spread > 0 ? of->rms / of->spread : NAN;
    of->fill = sqrt(all.fill[j]);
  }
}

bool cpl_error_estimate(const cpl_trace *t, cpl_error *error) {
  *error = (cpl_error){0};
  for (int q = 0; q < CPL_QUANTITIES; q++)
    error->of[q] = (cpl_error_of){NAN, NAN, NAN, NAN, NAN, NAN};
  if (t->nrow < LEAST_ROWS)
    return true;
  double *block = malloc((size_t)t->nrow * sizeof *block);
  const body b = body_of(t);
  for (int half = 0; block && half < 2; half++)
    estimate_half(&b, half, block, error);
  free(block);
  return block != NULL;
}
