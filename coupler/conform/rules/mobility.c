/* Rules of the reduced model (PROTOCOL.md, section 6): its matrices against each other, and against motions under loads
 * that differ. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/conform/meeting.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char none_told[] = "it tells Y alone";

/* A reduced model that is kept, and the twists that belong to it. */
typedef struct {
  tdm_mobility m;
  double *block; /* its numbers */
  double *twist; /* (k) */
  int k;         /* 6 nbody */
} picture;

static void picture_free(picture *p) {
  free(p->block);
  free(p->twist);
  *p = (picture){0};
}

static bool picture_make(picture *p, const tdm_mobility *m) {
  *p = (picture){.m = *m, .k = 6 * m->nbody};
  p->block = calloc(tdm_mobility_doubles(m) + 1, sizeof *p->block);
  p->twist = calloc((size_t)p->k + 1, sizeof *p->twist);
  if (!p->block || !p->twist)
    return false;
  tdm_mobility_copy(p->block, m);
  tdm_mobility_point(&p->m, p->block);
  return true;
}

static void put_twists(double *out, int n, const tdm_state *state) {
  for (int i = 0; i < n; i++)
    memcpy(out + 6 * i, &state[i].twist, 6 * sizeof *out);
}

/* A window of n steps under a constant load, (nbody), and the model at its end; *kept is the caller's to free. */
static bool take(cpl_meeting *m, long n, const tdm_wrench *load, picture *kept) {
  tdm_result r;
  tdm_step step = cpl_meeting_next(m, n);
  step.load = load;
  step.nload = 1;
  if (!cpl_meeting_solve(m, &step, &r) || !picture_make(kept, &r.mobility))
    return false;
  put_twists(kept->twist, step.nbody, r.state);
  return true;
}

/* The load that makes entry i alone 1 m/s2 or 1 rad/s2; 0: nothing moves it. */
static double size_of(const tdm_mobility *m, int i) {
  const int k = 6 * m->nbody;
  double largest = 0;
  for (int j = 0; j < k; j++)
    if ((j % 6 < 3) == (i % 6 < 3))
      largest = fmax(largest, m->Y[j * k + j]);
  return m->Y[i * k + i] > 1e-6 * largest ? 1 / m->Y[i * k + i] : 0;
}

/* sum_j a_ij b_jl of matrices with n in the middle, columns `c` of b */
static double product(const double *a, const double *b, int n, int c, int i, int l) {
  double sum = 0;
  for (int j = 0; j < n; j++)
    sum += a[i * n + j] * b[j * c + l];
  return sum;
}

/* ---- matrices ---- */

static void look_at_product(const tdm_mobility *m, cpl_verdict *v) {
  const int k = 6 * m->nbody;
  for (int i = 0; i < k; i++)
    for (int l = 0; l < k; l++) {
      const double is = product(m->J, m->B, m->nfree, k, i, l), due = m->Y[i * k + l];
      if (fabs(is - due) > 1e-6 * sqrt(fabs(m->Y[i * k + i] * m->Y[l * k + l])) + 1e-9 * fabs(due))
        cpl_broken(v, "Y = J B", "entry %d, %d: J B has %g, Y has %g", i, l, is, due);
    }
}

/* What a load adds to the twists is what it adds to J u'. */
static void look_at_velocities(const picture *with, const picture *without, cpl_verdict *v) {
  for (int i = 0; i < with->k; i++) {
    const double due = with->twist[i] - without->twist[i];
    const double is = product(with->m.J, with->m.velocity, with->m.nfree, 1, i, 0) -
                      product(without->m.J, without->m.velocity, without->m.nfree, 1, i, 0);
    double most = 0;
    for (int j = i - i % 3; j < i - i % 3 + 3; j++)
      most = fmax(most, fabs(with->twist[j] - without->twist[j]));
    if (fabs(is - due) > 0.02 * most + 1e-9)
      cpl_broken(v, "J u' to change as the twists do", "body %d, %s %c: J u' by %g, the twist by %g", i / 6,
                 i % 6 < 3 ? "along" : "about", "xyz"[i % 3], is, due);
  }
}

static void test_parts(cpl_candidate *c, cpl_verdict *v) {
  picture kept[2] = {0};
  cpl_meeting m;
  for (int loaded = 0; loaded < 2; loaded++) {
    if (!cpl_meeting_open(&m, c, v))
      break;
    const tdm_mobility *start = &m.session.mobility;
    tdm_wrench *load = calloc((size_t)m.settings.nbody + 1, sizeof *load);
    for (int i = 0; load && loaded && i < 6 * m.settings.nbody; i++)
      ((double *)(void *)load)[i] = size_of(start, i);
    if (start->nfree == 0)
      cpl_not_seen(v, none_told);
    look_at_product(start, v);
    const bool good = load && v->kind == CPL_KEPT && take(&m, 3, load, &kept[loaded]);
    free(load);
    cpl_meeting_drop(&m);
    if (!good)
      break;
    look_at_product(&kept[loaded].m, v);
    if (loaded)
      look_at_velocities(&kept[1], &kept[0], v);
  }
  picture_free(&kept[0]);
  picture_free(&kept[1]);
}

/* dY/dt = dJ/dt B + J dB/dt, whatever the basis of u is */
static double rate_of_mobility(const tdm_mobility *m, int i, int l) {
  const int k = 6 * m->nbody;
  return product(m->J_rate, m->B, m->nfree, k, i, l) + product(m->J, m->B_rate, m->nfree, k, i, l);
}

static void test_rates(cpl_candidate *c, cpl_verdict *v) {
  enum { WINDOWS = 12 };
  const long n = 5;
  picture before = {0}, now = {0};
  cpl_meeting m;
  if (!cpl_meeting_open(&m, c, v))
    return;
  const double h = (double)n * m.settings.dt;
  tdm_wrench *load = calloc((size_t)m.settings.nbody + 1, sizeof *load);
  for (int i = 0; load && i < 6 * m.settings.nbody; i++)
    ((double *)(void *)load)[i] = 30 * size_of(&m.session.mobility, i);
  bool good = load && take(&m, n, load, &before), seen = false;
  for (int w = 0; good && w < WINDOWS && (good = take(&m, n, load, &now)); w++) {
    const int k = now.k;
    double largest = 0, all = 0;
    for (int i = 0; i < k * k; i++) {
      all = fmax(all, fabs(now.m.Y[i]));
      largest = fmax(largest, fabs(now.m.Y[i] - before.m.Y[i]));
    }
    const bool looks = now.m.nfree == before.m.nfree && now.m.nfree > 0 && largest > 1e-6 * all;
    seen = seen || looks;
    for (int i = 0; looks && i < k; i++)
      for (int l = 0; l < k; l++) {
        const double is = now.m.Y[i * k + l] - before.m.Y[i * k + l];
        const double told = 0.5 * h * (rate_of_mobility(&before.m, i, l) + rate_of_mobility(&now.m, i, l));
        if (fabs(is - told) > 0.05 * largest)
          cpl_broken(v, "dJ/dt B + J dB/dt to be the rate of Y", "entry %d, %d in %g s: by %g, the rates say %g", i, l,
                     h, is, told);
      }
    picture_free(&before);
    before = now;
    now = (picture){0};
  }
  picture_free(&before);
  picture_free(&now);
  free(load);
  cpl_meeting_drop(&m);
  if (good && !seen)
    cpl_not_seen(v, "the mobility of this scene stays as it is");
}

/* ---- motions ---- */

enum { WINDOWS_MAX = 64, STEPS = 50 };
static const double close = 0.02, far = 0.1; /* shares that deviations may be off, and at which looking ends */

/* One run: what windows of STEPS steps come to under a load that is held. */
typedef struct {
  int nwindow;
  picture at[WINDOWS_MAX]; /* at their ends */
} flight;

static void flight_free(flight *f) {
  for (int w = 0; w < f->nwindow; w++)
    picture_free(&f->at[w]);
  f->nwindow = 0;
}

/* The whole flight; entry `which` has the load (-1: none). *start (may be NULL) is what READY tells. */
static bool fly(cpl_candidate *c, cpl_verdict *v, int which, double load, flight *f, picture *start, double *h) {
  cpl_meeting m;
  *f = (flight){0};
  if (!cpl_meeting_open(&m, c, v))
    return false;
  tdm_wrench *loads = calloc((size_t)m.settings.nbody + 1, sizeof *loads);
  bool good = loads && (!start || picture_make(start, &m.session.mobility));
  if (good && which >= 0)
    ((double *)(void *)loads)[which] = load;
  *h = STEPS * m.settings.dt;
  for (int w = 0; good && w < WINDOWS_MAX && (w + 1) * *h <= m.settings.time_end * (1 + 1e-9); w++) {
    good = take(&m, STEPS, loads, &f->at[w]);
    f->nwindow += good;
  }
  free(loads);
  cpl_meeting_drop(&m);
  return good;
}

/* u' that a unit load at `which`, held, leads to after h, 2 h, ... by B, A_k and A_c: (nwindow x nfree). The caller
 * frees it. */
static double *predict(const tdm_mobility *m, int which, double h, int nwindow) {
  const size_t f = (size_t)m->nfree, n = 2 * f + 1;
  const int k = 6 * m->nbody;
  gsl_matrix *L = gsl_matrix_calloc(n, n), *E = gsl_matrix_calloc(n, n);
  double *out = calloc((size_t)nwindow * f + 1, sizeof *out), *x = calloc(2 * n, sizeof *x), *next = x + n;
  for (size_t i = 0; L && i < f; i++) {
    gsl_matrix_set(L, i, f + i, h);
    for (size_t j = 0; j < f; j++) {
      gsl_matrix_set(L, f + i, j, -h * m->stiffness[i * f + j]);
      gsl_matrix_set(L, f + i, f + j, -h * m->damping[i * f + j]);
    }
    gsl_matrix_set(L, f + i, n - 1, h * m->B[i * (size_t)k + (size_t)which]);
  }
  const bool good = L && E && out && x && gsl_linalg_exponential_ss(L, E, GSL_PREC_DOUBLE) == 0;
  if (good)
    x[n - 1] = 1;
  for (int w = 0; good && w < nwindow; w++) {
    for (size_t i = 0; i < n; i++) {
      next[i] = 0;
      for (size_t j = 0; j < n; j++)
        next[i] += gsl_matrix_get(E, i, j) * x[j];
    }
    memcpy(x, next, n * sizeof *x);
    memcpy(out + (size_t)w * f, x + f, f * sizeof *out);
  }
  gsl_matrix_free(L);
  gsl_matrix_free(E);
  free(x);
  return out;
}

/* J A B: what stiffness (or damping) does to accelerations, whatever the basis of u is */
static double reach(const tdm_mobility *m, const double *A, int i, int l) {
  const int f = m->nfree, k = 6 * m->nbody;
  double sum = 0;
  for (int j = 0; j < f; j++)
    sum += m->J[i * f + j] * product(A, m->B, f, k, j, l);
  return sum;
}

/* How far, as a share of the motion that a load makes, a model that has changed since the start may lead after time t:
 * entries between which loads act are taken relative to sqrt(Y_ii Y_ll). */
static double change_of(const tdm_mobility *start, const tdm_mobility *now, double t) {
  const int k = 6 * start->nbody;
  double most = start->nfree == now->nfree ? 0 : INFINITY;
  for (int i = 0; i < k && isfinite(most); i++)
    for (int l = 0; l < k; l++) {
      const double size = sqrt(size_of(start, i) * size_of(start, l));
      const double Y = now->Y[i * k + l] - start->Y[i * k + l];
      const double K = reach(now, now->stiffness, i, l) - reach(start, start->stiffness, i, l);
      const double C = reach(now, now->damping, i, l) - reach(start, start->damping, i, l);
      most = fmax(most, size * (2 * fabs(Y) + fabs(K) * t * t / 6 + fabs(C) * t / 2));
    }
  return most;
}

/* Half the difference of flights under a load and its opposite, against the model's. True: further on is worth a look.
 */
static bool look_at_window(const picture *start, const flight f[2], int w, const double *u1, int which, double h,
                           cpl_verdict *v) {
  const int k = start->k, nfree = start->m.nfree;
  const double t = (w + 1) * h, load = size_of(&start->m, which);
  double slack = 0;
  for (int s = 0; s < 2; s++)
    slack = fmax(slack, close + change_of(&start->m, &f[s].at[w].m, t));
  if (!(slack < far))
    return false;
  for (int i = 0; i < k; i++) {
    const double size = size_of(&start->m, i);
    const double is = 0.5 * (f[0].at[w].twist[i] - f[1].at[w].twist[i]);
    const double due = load * product(start->m.J, u1, nfree, 1, i, 0);
    if (size > 0 && fabs(is - due) > slack * t * sqrt(load / size))
      cpl_broken(v, "the motion that B, A_k and A_c of READY say",
                 "after %g s under a %s %c of body %d: body %d moves %s %c at %g, they say %g", t,
                 which % 6 < 3 ? "force along" : "moment about", "xyz"[which % 3], which / 6, i / 6,
                 i % 6 < 3 ? "along" : "about", "xyz"[i % 3], is, due);
  }
  return v->kind == CPL_KEPT;
}

static void test_motion(cpl_candidate *c, cpl_verdict *v) {
  enum { LOADS_MAX = 12 };
  picture start = {0};
  flight f[2] = {{0}, {0}};
  double h = 0;
  bool seen = false;
  cpl_meeting m;
  if (!cpl_meeting_open(&m, c, v))
    return;
  const bool made = picture_make(&start, &m.session.mobility);
  cpl_meeting_drop(&m);
  if (made && start.m.nfree == 0)
    cpl_not_seen(v, none_told);
  for (int j = 0; made && j < start.k && j < LOADS_MAX && v->kind == CPL_KEPT; j++) {
    const double load = size_of(&start.m, j);
    if (load == 0)
      continue;
    double *u1 = NULL;
    if (fly(c, v, j, load, &f[0], NULL, &h) && fly(c, v, j, -load, &f[1], NULL, &h) &&
        (u1 = predict(&start.m, j, h, f[0].nwindow)) != NULL)
      for (int w = 0; w < f[0].nwindow && look_at_window(&start, f, w, u1 + w * start.m.nfree, j, h, v); w++)
        seen = true;
    free(u1);
    flight_free(&f[0]);
    flight_free(&f[1]);
  }
  picture_free(&start);
  if (!seen)
    cpl_not_seen(v, "no load moves a coupled body of this scene in 50 steps");
}

const cpl_rule cpl_rules_mobility[] = {{.name = "mobility.parts",
                                        .section = "6",
                                        .roles = CPL_OF_MBD,
                                        .capability = "mobility",
                                        .text = "Y = J B, and J u' changes as the twists do",
                                        .test = test_parts},
                                       {.name = "mobility.rates",
                                        .section = "6",
                                        .roles = CPL_OF_MBD,
                                        .capability = "mobility",
                                        .text = "dJ/dt and dB/dt agree with finite differences",
                                        .test = test_rates},
                                       {.name = "mobility.motion",
                                        .section = "6",
                                        .roles = CPL_OF_MBD,
                                        .capability = "mobility",
                                        .text = "bodies deviate under loads as B, A_k and A_c say",
                                        .test = test_motion},
                                       {.name = NULL}};
