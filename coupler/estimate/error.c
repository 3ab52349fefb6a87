/* The error of a run, estimated: see error.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/estimate/error.h"
#include "coupler/estimate/response.h"

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

/* What the motion is like, by least squares over its integrals, in which noise counts less:
 *
 *   x'' = p + q x + s x'       the swing of body and particles; q = s = 0 where it is no such motion
 *   F = c - m (x'' - p0)       what the particles add to the inertia; their load
 *   F = c - K x - C x'         where they rather push back, as a bed does that is pressed */
typedef struct {
  double q, s, added, load;
  bool presses;              /* the particles push back: */
  double stiffness, damping; /* K, C of that */
  double wild;               /* share of the rate's variance that no swing tells, as far as blows make it */
} linear;

/* The share of the rate's variance that the swing c does not tell, but for what the exchange itself shakes it by. The
 * integrals hide blows. */
static double untold_share(const cpl_part *p, const double c[TERMS]) {
  const cpl_trace_row *first = cpl_part_row(p, 0), *before = first;
  double once = 0, rest = 0, sum = 0, square = 0;
  for (int i = 1; i < p->n; i++) {
    const cpl_trace_row *r = cpl_part_row(p, i);
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
static double blows_share(const cpl_part *p) {
  const cpl_trace_row *first = cpl_part_row(p, 0), *last = cpl_part_row(p, p->n - 1), *before = first;
  const double time = last->t - first->t, mean = (last->rate[p->k] - first->rate[p->k]) / time;
  double size = 0, square = 0;
  for (int i = 1; i < p->n; i++) {
    const cpl_trace_row *r = cpl_part_row(p, i);
    const double h = r->t - before->t, off = (r->rate[p->k] - before->rate[p->k]) / h - mean;
    size += h * fabs(off);
    square += h * off * off;
    before = r;
  }
  return square > 0 ? fmax(0, 1 - M_PI / 2 * size * size / (time * square)) : 0;
}

/* Whether the particles' load is rather that of a spring and damper than of a mass: a mass that swings with the body
 * pushes as a spring of negative stiffness would. */
static void bed_of(linear *l, const fit *still, const fit *weight, const fit *bed) {
  double c[TERMS];
  const double rest_still = 1 - fit_solve(still, c), rest_mass = 1 - fit_solve(weight, c), rest = 1 - fit_solve(bed, c);
  l->presses = c[1] < 0 && rest < rest_mass && rest < (1 - good_fit) * rest_still;
  l->stiffness = l->presses ? -c[1] : 0;
  l->damping = l->presses ? fmax(0, -c[2]) : 0;
}

/* How far the motion is to and fro: 0 where it goes one way, 1 where it comes back. Blows that come from elsewhere
 * drive a body one way, and do not wait for it. */
static double to_and_fro(const cpl_part *p) {
  double path = 0;
  for (int i = 1; i < p->n; i++)
    path += fabs(cpl_part_row(p, i)->way[p->k] - cpl_part_row(p, i - 1)->way[p->k]);
  return path > 0 ? 1 - fabs(cpl_part_row(p, p->n - 1)->way[p->k] - cpl_part_row(p, 0)->way[p->k]) / path : 0;
}

static linear motion_of(const cpl_part *p) {
  linear l = {0};
  fit swing = {.n = 3}, weight = {.n = 2}, still = {.n = 1}, bed = {.n = 3};
  double once = 0, twice = 0, c[TERMS];
  const cpl_trace_row *first = cpl_part_row(p, 0), *before = first;
  for (int i = 1; i < p->n; i++) {
    const cpl_trace_row *r = cpl_part_row(p, i);
    const double h = r->t - before->t, way = before->way[p->k], gained = r->rate[p->k] - first->rate[p->k];
    twice += h * once + h * h * (way / 3 + r->way[p->k] / 6);
    once += 0.5 * h * (way + r->way[p->k]);
    fit_add(&swing, (double[]){0.5 * r->t * r->t, twice, once}, r->way[p->k] - first->rate[p->k] * r->t);
    fit_add(&weight, (double[]){r->t, gained}, r->given[p->k]);
    fit_add(&still, (double[]){r->t}, r->given[p->k]);
    fit_add(&bed, (double[]){r->t, once, r->way[p->k]}, r->given[p->k]);
    before = r;
  }
  const bool swings = fit_solve(&swing, c) > good_fit;
  l.wild = untold_share(p, c) * blows_share(p) * to_and_fro(p);
  if (swings) {
    l.q = fmin(c[1], 0);
    l.s = fmin(c[2], 0);
  }
  fit_solve(&weight, c);
  l.load = c[0];
  l.added = fmax(0, -c[1]);
  bed_of(&l, &still, &weight, &bed);
  return l;
}

/* Means over time of squares, of way [0] and rate [1]. */
typedef struct {
  double spread[2], coupling[2], fill[2];
  double local; /* of the rate: of the windows' own defects, a part of the coupling's */
} squares;

/* Way [0] and rate [1] at a time, on a straight line between rows; *at: the row before, found from where it was. */
static void motion_at(const cpl_part *p, double t, int *at, double out[2]) {
  while (*at > 0 && cpl_part_row(p, *at)->t > t)
    --*at;
  while (*at < p->n - 2 && cpl_part_row(p, *at + 1)->t < t)
    ++*at;
  const cpl_trace_row *a = cpl_part_row(p, *at), *b = cpl_part_row(p, *at + 1);
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
static void add_shift(const cpl_part *p, const linear *l, double energy, double sum[2]) {
  const int k = p->k;
  const cpl_trace_row *before = cpl_part_row(p, 0);
  double shift = 0, share = 0;
  int at = 0;
  for (int i = 1; energy > p->trace->driven && i < p->n; i++) {
    const cpl_trace_row *r = cpl_part_row(p, i);
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

/* ---- carried on ---- */

/* Parts whose errors move each other, or one by itself. */
typedef struct {
  int n;
  cpl_part part[CPL_RESPONSE_PARTS];
  const linear *motion[CPL_RESPONSE_PARTS];
  double energy[CPL_RESPONSE_PARTS]; /* of the body's whole motion */
} group;

/* How the group answers: as the mechanism that was found and the particles do; NULL: as each part's own swing tells. */
static cpl_response response_of(const group *g, double stiffness[][CPL_RESPONSE_PARTS],
                                double damping[][CPL_RESPONSE_PARTS]) {
  cpl_response r = {.n = g->n};
  for (int i = 0; i < g->n; i++) {
    const linear *l = g->motion[i];
    const double own = g->part[i].trace->mass[g->part[i].k];
    r.inertia[i] = own + (l->presses ? 0 : l->added);
    for (int j = 0; j < g->n; j++) {
      r.stiffness[i][j] = stiffness ? stiffness[i][j] / r.inertia[i] : 0;
      r.damping[i][j] = stiffness ? damping[i][j] / r.inertia[i] : 0;
    }
    if (stiffness || (l->q == 0 && l->s == 0)) {
      r.stiffness[i][i] += l->stiffness / r.inertia[i];
      r.damping[i][i] += l->damping / r.inertia[i];
    } else {
      r.stiffness[i][i] = -l->q;
      r.damping[i][i] = -l->s;
    }
  }
  return r;
}

/* Impulses from one row to the next that part i of the group should not have felt, and those that its fill gave it
 * beside a mass that is fixed to it. */
static void impulses_at(const group *g, int i, int row, double *owed, double *fill) {
  const cpl_part *p = &g->part[i];
  const linear *l = g->motion[i];
  const cpl_trace_row *a = cpl_part_row(p, row - 1), *b = cpl_part_row(p, row);
  const double h = b->t - a->t, late = (b->late[p->k] - a->late[p->k]) / h;
  const double late_before =
      row > 1 ? (a->late[p->k] - cpl_part_row(p, row - 2)->late[p->k]) / (a->t - cpl_part_row(p, row - 2)->t) : 0;
  *owed = b->owed[p->k] - a->owed[p->k] + (l->presses ? 0 : 0.5 * l->added * (late - late_before));
  *fill = b->given[p->k] - a->given[p->k] - l->load * h + l->added * (b->rate[p->k] - a->rate[p->k]);
}

/* To the error that the exchange makes comes what a window's own defect does to the body alone, before the particles
 * answer, and what energy that the exchange made does to blows. */
static void close_part(const group *g, int i, squares *s) {
  const cpl_part *p = &g->part[i];
  const cpl_trace_row *first = cpl_part_row(p, 0), *last = cpl_part_row(p, p->n - 1);
  const double time = last->t - first->t, half_window = 0.5 * p->trace->end.t / (double)p->trace->windows;
  const double jolt = last->jolt[p->k] - first->jolt[p->k], slip = last->slip[p->k] - first->slip[p->k];
  double mean[2] = {0}, square[2] = {0}, made = 0;
  for (int row = 1; row < p->n; row++) {
    const cpl_trace_row *r = cpl_part_row(p, row);
    const double h = r->t - cpl_part_row(p, row - 1)->t, value[2] = {r->way[p->k], r->rate[p->k]};
    made += h / time * r->made;
    for (int j = 0; j < 2; j++) {
      mean[j] += h * value[j];
      square[j] += h * value[j] * value[j];
    }
  }
  add_shift(p, g->motion[i], g->energy[i], s->coupling);
  s->coupling[0] += slip + half_window * half_window * jolt;
  s->coupling[1] += jolt;
  /* the right motion has less energy by what the exchange made: both together are as far apart as they can be */
  const double farthest = pow(1 + sqrt(fmax(0, 1 - made / g->energy[i])), 2);
  for (int j = 0; j < 2; j++) {
    s->spread[j] = fmax(0, square[j] / time - mean[j] * mean[j] / (time * time));
    s->coupling[j] = fmin(s->coupling[j], farthest * square[j]) / time;
    s->fill[j] /= time;
  }
  s->local = jolt / time;
}

/* The error of the exchange and the motion of the fill, as the group's response carries them on: impulses too much.
 * Into s (n). False: no memory. */
static bool carry(const group *g, const cpl_response *r, squares *s) {
  cpl_carrier *carrier = cpl_carrier_create(r);
  double coupling[2 * CPL_RESPONSE_PARTS] = {0}, fill[2 * CPL_RESPONSE_PARTS] = {0};
  for (int i = 0; i < g->n; i++)
    s[i] = (squares){0};
  for (int row = 1; carrier && row < g->part[0].n; row++) {
    const double h = cpl_part_row(&g->part[0], row)->t - cpl_part_row(&g->part[0], row - 1)->t;
    double owed[CPL_RESPONSE_PARTS], own[CPL_RESPONSE_PARTS];
    for (int i = 0; i < g->n; i++)
      impulses_at(g, i, row, &owed[i], &own[i]);
    cpl_carrier_go(carrier, h, owed, coupling);
    cpl_carrier_go(carrier, h, own, fill);
    for (int i = 0; i < g->n; i++)
      for (int j = 0; j < 2; j++) {
        s[i].coupling[j] += h * pow(coupling[j * g->n + i], 2);
        s[i].fill[j] += h * pow(fill[j * g->n + i], 2);
      }
  }
  for (int i = 0; carrier && i < g->n; i++)
    close_part(g, i, &s[i]);
  const bool done = carrier != NULL;
  cpl_carrier_destroy(&carrier);
  return done;
}

/* ---- rattle ---- */

static int by_size(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* The square of the jitter of the rate that the load makes [unit of the rate, squared]: what is left of the impulse
 * beside the parabola through 2 m + 1 rows around. Blocks of so many rows are looked at; one in which the load acts for
 * less than half of the time has single blows, which come when the motion has them come, and none. The upper quartile
 * of blocks counts. `block` has room for n numbers. */
static double jitter(const cpl_part *p, int m, double *block) {
  const int rows = 2 * m + 1;
  double n = rows, s2 = 0, s4 = 0, sum = 0;
  int nblock = 0, inside = 0, loaded = 0;
  for (int j = -m; j <= m; j++) {
    s2 += (double)j * j;
    s4 += (double)j * j * j * j;
  }
  for (int i = m; i + m < p->n; i++) {
    double smooth = 0;
    for (int j = -m; j <= m; j++)
      smooth += (s4 - s2 * j * j) / (n * s4 - s2 * s2) * cpl_part_row(p, i + j)->given[p->k];
    const double rest = (cpl_part_row(p, i)->given[p->k] - smooth) / p->trace->mass[p->k];
    sum += rest * rest;
    loaded += cpl_part_row(p, i)->given[p->k] != cpl_part_row(p, i - 1)->given[p->k];
    if (++inside == rows) {
      block[nblock++] = 2 * loaded >= rows ? sum / rows : 0;
      sum = 0;
      inside = loaded = 0;
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
  squares square[CPL_PARTS];
  double energy; /* of the motion: twice the mean of the kinetic one [J] */
} body;

/* Mean over time of the rate's square. */
static double square_of_rate(const cpl_part *p) {
  const cpl_trace_row *first = cpl_part_row(p, 0), *before = first;
  double sum = 0;
  for (int i = 1; i < p->n; i++) {
    const cpl_trace_row *r = cpl_part_row(p, i);
    sum += (r->t - before->t) * r->rate[p->k] * r->rate[p->k];
    before = r;
  }
  return sum / (before->t - first->t);
}

static body body_of(const cpl_trace *t) {
  body b = {.trace = t};
  for (int k = 0; k < CPL_PARTS; k++) {
    const cpl_part p = cpl_part_of(t, k);
    b.moves[k] = moves(t, k);
    if (!b.moves[k])
      continue;
    b.motion[k] = motion_of(&p);
    b.energy += (t->mass[k] + b.motion[k].added) * square_of_rate(&p);
  }
  return b;
}

static void join(group *g, const body *b, int k) {
  g->part[g->n] = cpl_part_of(b->trace, k);
  g->motion[g->n] = &b->motion[k];
  g->energy[g->n++] = b->energy;
}

/* Does the response that was found say more than the swing that the motion shows, w^2 = `seen`? Not where something
 * else holds the body, as a bed below a free one does (the swing is the faster one); nor where both are the same, as
 * then the swing has what the exchange makes of it, too. Ties to other bodies no swing shows. */
static bool tells_more(const cpl_response *r, int i, double seen) {
  return r->stiffness[i][i] >= 0.5 * seen && (r->n > 1 || r->stiffness[i][i] > 2 * seen);
}

/* By the mechanism that ties all parts of all bodies, if there is one and it can be told. *told: it could. False: no
 * memory. */
static bool carry_together(int nbody, body *b, bool *told) {
  double stiffness[CPL_RESPONSE_PARTS][CPL_RESPONSE_PARTS], damping[CPL_RESPONSE_PARTS][CPL_RESPONSE_PARTS];
  squares s[CPL_RESPONSE_PARTS];
  group g = {0};
  int nmove = 0, at = 0;
  *told = false;
  for (int i = 0; i < nbody; i++)
    for (int k = 0; k < CPL_PARTS; k++)
      if (b[i].moves[k] && ++nmove <= CPL_RESPONSE_PARTS)
        join(&g, &b[i], k);
  if (nmove == 0 || nmove > CPL_RESPONSE_PARTS)
    return true;
  if (!cpl_response_mechanism(g.n, g.part, stiffness, damping, told))
    return false;
  const cpl_response r = response_of(&g, stiffness, damping);
  for (int i = 0; i < g.n; i++)
    *told = *told && tells_more(&r, i, -g.motion[i]->q);
  *told = *told && cpl_response_stable(&r, g.part[0].trace->last.t);
  if (!*told)
    return true;
  if (!carry(&g, &r, s))
    return false;
  for (int i = 0; i < nbody; i++)
    for (int k = 0; k < CPL_PARTS; k++)
      if (b[i].moves[k])
        b[i].square[k] = s[at++];
  return true;
}

/* Does one part of another body go with it, all but for a share that a good fit leaves? */
static bool goes_with(const cpl_part *a, const cpl_part *b) {
  double mean[2] = {0}, square[2] = {0}; /* of a, of the difference */
  for (int i = 0; i < a->n; i++) {
    const double way = cpl_part_row(a, i)->way[a->k], value[2] = {way, way - cpl_part_row(b, i)->way[b->k]};
    for (int j = 0; j < 2; j++) {
      mean[j] += value[j] / a->n;
      square[j] += value[j] * value[j] / a->n;
    }
  }
  return square[1] - mean[1] * mean[1] < (1 - good_fit) * (square[0] - mean[0] * mean[0]);
}

/* A tie that is too stiff for the rows to show how stiff: as stiff as they could show, and damped so that it does not
 * ring. */
static void tie(const group *g, cpl_response *r, int i, int j) {
  const cpl_part *p = &g->part[i];
  const double pace = (p->n - 1) / p->trace->last.t, mass = 1 / (1 / r->inertia[i] + 1 / r->inertia[j]);
  const int from[2] = {i, j}, to[2] = {j, i};
  for (int k = 0; k < 2; k++) {
    const double share = mass / r->inertia[from[k]];
    r->stiffness[from[k]][from[k]] += share * pace * pace;
    r->stiffness[from[k]][to[k]] -= share * pace * pace;
    r->damping[from[k]][from[k]] += 2 * share * pace;
    r->damping[from[k]][to[k]] -= 2 * share * pace;
  }
}

/* Each part of body `at` as its own swing tells, tied to those of other bodies that go the same way. False: no memory.
 */
static bool carry_alone(int nbody, body *b, int at) {
  for (int k = 0; k < CPL_PARTS; k++) {
    squares s[CPL_RESPONSE_PARTS];
    group g = {0};
    if (!b[at].moves[k])
      continue;
    join(&g, &b[at], k);
    for (int i = 0; i < nbody && g.n < CPL_RESPONSE_PARTS; i++) {
      const cpl_part other = cpl_part_of(b[i].trace, k);
      if (i != at && b[i].moves[k] && goes_with(&g.part[0], &other))
        join(&g, &b[i], k);
    }
    cpl_response r = response_of(&g, NULL, NULL);
    for (int i = 1; i < g.n; i++)
      tie(&g, &r, 0, i);
    if (!carry(&g, &r, s))
      return false;
    b[at].square[k] = s[0];
  }
  return true;
}

/* The ways [0] or the turns [1] of the body: positions and velocities of them. */
static void estimate_half(const body *b, int half, double *block, cpl_error *error) {
  const cpl_trace *t = b->trace;
  squares all = {0};
  double rattle = 0;
  for (int k = 3 * half; k < 3 * half + 3; k++) {
    const squares *s = &b->square[k];
    if (!b->moves[k])
      continue;
    error->added[k] = b->motion[k].added;
    for (int j = 0; j < 2; j++) {
      all.coupling[j] += s->coupling[j];
      all.fill[j] += s->fill[j];
      all.spread[j] += s->spread[j];
    }
    all.local += s->local;
  }
  /* jitter is what is faster than the motion itself */
  const double time = t->last.t, pace = sqrt(all.spread[0] / all.spread[1]);
  const double span = fmin(pace_share * (isfinite(pace) ? pace : time), least_spans * time);
  const int m = (int)fmax(2, round(0.5 * span * (t->nrow - 1) / time));
  for (int k = 3 * half; k < 3 * half + 3; k++) {
    const cpl_part p = cpl_part_of(t, k);
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

bool cpl_error_estimate(int nbody, const cpl_trace *trace, cpl_error *error) {
  for (int i = 0; i < nbody; i++) {
    error[i] = (cpl_error){0};
    for (int q = 0; q < CPL_QUANTITIES; q++)
      error[i].of[q] = (cpl_error_of){NAN, NAN, NAN, NAN, NAN, NAN};
  }
  if (nbody == 0 || trace[0].nrow < LEAST_ROWS)
    return true;
  double *block = malloc((size_t)trace[0].nrow * sizeof *block);
  body *b = calloc((size_t)nbody, sizeof *b);
  bool told = false, done = block && b;
  for (int i = 0; done && i < nbody; i++)
    b[i] = body_of(&trace[i]);
  done = done && carry_together(nbody, b, &told);
  for (int i = 0; done && !told && i < nbody; i++)
    done = carry_alone(nbody, b, i);
  for (int i = 0; done && i < nbody; i++)
    for (int half = 0; half < 2; half++)
      estimate_half(&b[i], half, block, &error[i]);
  free(block);
  free(b);
  return done;
}
