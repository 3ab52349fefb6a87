/* The load that ends where the proxy ended, on mechanisms with an exact solution: the reduced model under the kicks of
 * n steps, and under the polynomial that stands for them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/proxy/matched.h"
#include "protocol/math/legendre.h"
#include "tests/test_main.h"

#include <gsl/gsl_linalg.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FREEDOMS = 8, BODIES = 2, LOADS = 6 * BODIES, COEFFICIENTS = TDM_LOAD_MAX };
static const double H = 0.1;

/* A mechanism, the loads on it and what comes of them. */
typedef struct {
  int f, k;
  uint64_t n;
  double Y[LOADS * LOADS], B[FREEDOMS * LOADS], B_rate[FREEDOMS * LOADS];
  double stiffness[FREEDOMS * FREEDOMS], damping[FREEDOMS * FREEDOMS];
  double (*load)(int component, double s); /* 0 <= s <= 1 */
  tdm_wrench further[BODIES * TDM_FURTHER];
  double c[LOADS][COEFFICIENTS];                        /* of P_j */
  double kicked[2 * FREEDOMS];                          /* u, u' at the end, by the kicks */
  double matched[2 * FREEDOMS], parabola[2 * FREEDOMS]; /* under the polynomial, and without what is further in it */
} model;

/* f oscillators of 1 kg, each on its load, omega H as given */
static model oscillators(int f, const double *swing, double damping) {
  model m = {.f = f, .k = (f + 5) / 6, .n = 4000};
  for (int i = 0; i < f; i++) {
    m.B[i * 6 * m.k + i] = m.Y[i * 6 * m.k + i] = 1;
    m.stiffness[i * f + i] = pow(swing[i] / H, 2);
    m.damping[i * f + i] = damping * swing[i] / H;
  }
  return m;
}

/* ---- what the kicks lead to ---- */

/* flow of (u, dt u') over a step */
static void flow(const model *m, double dt, double *E) {
  const size_t two = 2 * (size_t)m->f;
  gsl_matrix *L = gsl_matrix_calloc(two, two);
  gsl_matrix_view out = gsl_matrix_view_array(E, two, two);
  for (int i = 0; i < m->f; i++) {
    gsl_matrix_set(L, (size_t)i, (size_t)(m->f + i), 1);
    for (int j = 0; j < m->f; j++) {
      gsl_matrix_set(L, (size_t)(m->f + i), (size_t)j, -dt * dt * m->stiffness[i * m->f + j]);
      gsl_matrix_set(L, (size_t)(m->f + i), (size_t)(m->f + j), -dt * m->damping[i * m->f + j]);
    }
  }
  gsl_linalg_exponential_ss(L, &out.matrix, GSL_PREC_DOUBLE);
  gsl_matrix_free(L);
}

static void kick(const model *m, double dt, const double *W, double *z) {
  for (int i = 0; i < m->f; i++)
    for (int l = 0; l < 6 * m->k; l++)
      z[m->f + i] += 0.5 * dt * dt * m->B[i * 6 * m->k + l] * W[l];
}

/* The window's kicks, and from them moments, end and coefficients. */
static void go(model *m) {
  const double dt = H / (double)m->n;
  const int two = 2 * m->f, k6 = 6 * m->k;
  double E[4 * FREEDOMS * FREEDOMS], W[LOADS], z[2 * FREEDOMS] = {0};
  tdm_interface body[BODIES] = {0};
  tdm_mobility reduced = {.nbody = m->k,
                          .nfree = m->f,
                          .Y = m->Y,
                          .B = m->B,
                          .B_rate = m->B_rate,
                          .stiffness = m->stiffness,
                          .damping = m->damping};
  flow(m, dt, E);
  dem_matched *matched = dem_matched_create(m->k);
  ck_assert_int_eq(dem_matched_begin(matched, &reduced, m->n, dt, E), TDM_OK);
  for (uint64_t i = 0; i <= m->n; i++) {
    const double s = (double)i / (double)m->n, x = 2 * s - 1, P[3] = {1, x, 1.5 * x * x - 0.5};
    const int halves = i == 0 || i == m->n ? 1 : 2;
    for (int l = 0; l < k6; l++)
      W[l] = m->load(l, s);
    if (i > 0) {
      double next[2 * FREEDOMS] = {0};
      for (int a = 0; a < two; a++)
        for (int b = 0; b < two; b++)
          next[a] += E[a * two + b] * z[b];
      memcpy(z, next, sizeof z);
      dem_matched_flow(matched);
    }
    for (int h = 0; h < halves; h++) {
      kick(m, dt, W, z);
      dem_matched_half_kick(matched, W);
      for (int l = 0; l < k6; l++)
        for (int j = 0; j < 3; j++)
          ((double *)(void *)&body[l / 6].moment[j])[l % 6] += 0.5 / (double)m->n * P[j] * W[l];
    }
  }
  dem_matched_end(matched, body, m->further);
  dem_matched_destroy(&matched);
  for (int i = 0; i < m->f; i++) {
    m->kicked[i] = z[i];
    m->kicked[m->f + i] = z[m->f + i] / dt;
  }
  for (int l = 0; l < k6; l++) {
    for (int j = 0; j < 3; j++)
      m->c[l][j] = (2 * j + 1) * ((double *)(void *)&body[l / 6].moment[j])[l % 6];
    for (int j = 3; j < COEFFICIENTS; j++)
      m->c[l][j] = ((double *)(void *)&m->further[l / 6 * TDM_FURTHER + j - 3])[l % 6];
  }
}

/* ---- what the polynomial leads to ---- */

typedef struct {
  const model *m;
  int ncoefficient;
} under;

static double polynomial(const double *c, int n, double s) {
  const double x = 2 * s - 1;
  double before = 1, P = x, sum = c[0];
  for (int j = 1; j < n; j++) {
    sum += c[j] * P;
    const double next = ((2 * j + 1) * x * P - j * before) / (j + 1);
    before = P;
    P = next;
  }
  return sum;
}

static int rate(double t, const double *y, double *out, void *context) {
  const under *u = context;
  const model *m = u->m;
  for (int i = 0; i < m->f; i++) {
    out[i] = y[m->f + i];
    out[m->f + i] = 0;
    for (int j = 0; j < m->f; j++)
      out[m->f + i] -= m->stiffness[i * m->f + j] * y[j] + m->damping[i * m->f + j] * y[m->f + j];
    for (int l = 0; l < 6 * m->k; l++)
      if (m->B[i * 6 * m->k + l] != 0)
        out[m->f + i] += m->B[i * 6 * m->k + l] * polynomial(m->c[l], u->ncoefficient, t / H);
  }
  return GSL_SUCCESS;
}

static void follow(const model *m, int ncoefficient, double *end) {
  under u = {m, ncoefficient};
  gsl_odeiv2_system system = {rate, NULL, 2 * (size_t)m->f, &u};
  gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-4, 1e-14, 1e-11);
  double t = 0;
  memset(end, 0, 2 * (size_t)m->f * sizeof *end);
  ck_assert_int_eq(gsl_odeiv2_driver_apply(driver, &t, H, end), GSL_SUCCESS);
  gsl_odeiv2_driver_free(driver);
}

/* How far from the kicks' end, u as u' by omega, as a share of the largest of all freedoms. */
static double apart(const model *m, const double *end) {
  double most = 0, all = 0;
  for (int i = 0; i < m->f; i++) {
    const double omega = sqrt(m->stiffness[i * m->f + i]);
    most = fmax(most, hypot(omega * (end[i] - m->kicked[i]), end[m->f + i] - m->kicked[m->f + i]));
    all = fmax(all, hypot(omega * m->kicked[i], m->kicked[m->f + i]));
  }
  return most / all;
}

static void solve(model *m) {
  go(m);
  follow(m, COEFFICIENTS, m->matched);
  follow(m, 3, m->parabola);
}

/* ---- loads ---- */

/* a weight, a slow beat and what particles make of it: the same every time */
static double rattle(int l, double s) {
  static const double rate[] = {3, 7.3, 16.4, 31, 57, 91.7};
  double sum = l + 1;
  for (int i = 0; i < 6; i++)
    sum += cos(rate[i] * s + i * i + l);
  return sum;
}

static double bend(int l, double s) {
  return 3 + l - 2 * s + 5 * (l + 1) * s * s;
}

/* ---- tests ---- */

/* zeros of the spherical Bessel functions j_3, j_4, j_5, j_6, twice: where P_3 ... P_6 do not reach one of the two */
static const double swings[] = {0.5, 1.3, 4, 8, 16, 13.9758643, 16.3651231, 18.7116441, 21.0258551, 40};
enum { NSWING = sizeof swings / sizeof swings[0] };

START_TEST(ends_where_the_kicks_led) {
  for (int i = 0; i < NSWING; i++)
    for (int d = 0; d < 3; d++) {
      const double damping[] = {0, 0.05, 0.7};
      model m = oscillators(1, &swings[i], damping[d]);
      m.load = rattle;
      solve(&m);
      /* what DEM's step leaves, (omega dt)^2 / 12 of the load's response */
      const double step = pow(fmax(swings[i], 1) / (double)m.n, 2), is = apart(&m, m.matched);
      ck_assert_msg(is < 5 * step + 1e-9, "omega H = %g, damping %g: %g", swings[i], damping[d], is);
      if (swings[i] >= 4 && damping[d] < 0.5)
        ck_assert_msg(apart(&m, m.parabola) > 1e-2, "omega H = %g: the parabola does it too", swings[i]);
      for (int j = 0; j < TDM_FURTHER; j++) { /* nothing where nothing moves */
        ck_assert_double_eq(m.further[j].force.y, 0);
        ck_assert_double_eq(m.further[j].moment.z, 0);
      }
    }
}
END_TEST

START_TEST(as_close_as_the_step_allows) {
  const double swing = 16;
  double before = 0;
  for (int i = 0; i < 4; i++) {
    model m = oscillators(1, &swing, 0);
    m.n = 100u << i;
    m.load = rattle;
    solve(&m);
    const double is = apart(&m, m.matched);
    if (i > 0)
      ck_assert_msg(fabs(log2(before / is) - 2) < 0.2, "order %g, n = %d", log2(before / is), (int)m.n);
    before = is;
  }
}
END_TEST

START_TEST(several_freedoms_at_once) {
  const double swing[FREEDOMS] = {0.01, 1, 2.5, 4, 8, 16.3651231, 13.9758643, 12};
  model m = oscillators(FREEDOMS, swing, 0.01); /* two bodies */
  m.load = rattle;
  /* springs between neighbours, and a load that moves two */
  for (int i = 0; i + 1 < m.f; i++) {
    const double k = 200;
    m.stiffness[i * m.f + i] += k;
    m.stiffness[(i + 1) * m.f + i + 1] += k;
    m.stiffness[i * m.f + i + 1] -= k;
    m.stiffness[(i + 1) * m.f + i] -= k;
  }
  m.B[2 * 12 + 9] = m.B[5 * 12 + 9] = 0.5;
  m.Y[9 * 12 + 9] = 0.5;
  solve(&m);
  ck_assert_double_lt(apart(&m, m.matched), 1e-4);
  ck_assert_double_gt(apart(&m, m.parabola), 1e-2);
}
END_TEST

/* More freedoms than the polynomials of one load can lead: what they can do they do, and nothing grows. */
START_TEST(more_freedoms_than_the_load_can_lead) {
  model m = oscillators(FREEDOMS, (const double[FREEDOMS]){3, 4, 5, 6, 7, 8, 9, 10}, 0);
  m.k = 1;
  memset(m.B, 0, sizeof m.B);
  memset(m.Y, 0, sizeof m.Y);
  for (int i = 0; i < m.f; i++)
    m.B[i * 6] = 1;
  m.Y[0] = m.f;
  m.load = rattle;
  solve(&m);
  ck_assert_double_lt(apart(&m, m.matched), 0.1 * apart(&m, m.parabola));
  for (int j = 0; j < TDM_FURTHER; j++)
    ck_assert_double_lt(fabs(m.further[j].force.x), 10);
}
END_TEST

/* A load on a parabola needs nothing more, however few the steps. */
START_TEST(a_parabola_stays_one) {
  const uint64_t steps[] = {5, 6, 8, 9, 13, 100, 1001};
  for (int i = 0; i < 7; i++)
    for (int w = 0; w < NSWING; w++) {
      model m = oscillators(1, &swings[w], 0.1);
      m.n = steps[i];
      m.load = bend;
      go(&m);
      for (int j = 0; j < TDM_FURTHER; j++)
        ck_assert_msg(fabs(m.further[j].force.x) < 1e-6, "n = %d, omega H = %g: c_%d = %g", (int)m.n, swings[w], j + 3,
                      m.further[j].force.x);
    }
}
END_TEST

/* Vibrations of a few steps each, and far too many to a window, are none of the polynomial's business. */
START_TEST(what_no_polynomial_can_say_is_left_alone) {
  const double swing[] = {200, 1000, 3141.5, 1e5, 1e8};
  for (int i = 0; i < 5; i++)
    for (int d = 0; d < 2; d++) {
      model m = oscillators(1, &swing[i], d);
      m.n = 1000;
      m.load = rattle;
      go(&m);
      for (int j = 0; j < TDM_FURTHER; j++)
        ck_assert_msg(fabs(m.further[j].force.x) < 30, "omega H = %g: c_%d = %g", swing[i], j + 3,
                      m.further[j].force.x);
    }
}
END_TEST

START_TEST(a_mechanism_that_runs_away) {
  model m = oscillators(1, (const double[]){1}, 0);
  m.stiffness[0] = -1e12;
  m.n = 100;
  m.load = rattle;
  go(&m); /* comes back */
  for (int j = 0; j < TDM_FURTHER; j++)
    ck_assert(!(fabs(m.further[j].force.x) > 30));
}
END_TEST

START_TEST(hardly_a_swing_is_left_to_the_parabola) {
  model m = oscillators(1, (const double[]){0.08}, 0);
  m.load = rattle;
  solve(&m);
  for (int j = 0; j < TDM_FURTHER; j++)
    ck_assert_double_eq(m.further[j].force.x, 0);
  ck_assert_double_lt(apart(&m, m.parabola), 1e-6);
  m = oscillators(1, (const double[]){20}, 0); /* too few kicks for more than a parabola */
  m.n = 4;
  m.load = rattle;
  go(&m);
  for (int j = 0; j < TDM_FURTHER; j++)
    ck_assert_double_eq(m.further[j].force.x, 0);
}
END_TEST

START_TEST(powers_of_shifted_polynomials) {
  for (int degree = 0; degree <= 8; degree++) {
    double power[9], one[9] = {0};
    tdm_legendre_powers(degree, power);
    one[degree] = 1;
    for (int i = 0; i <= 10; i++) {
      double s = 0.1 * i, sum = 0;
      for (int p = degree; p >= 0; p--)
        sum = sum * s + power[p];
      ck_assert_double_eq_tol(sum, polynomial(one, 9, s), 1e-11);
    }
  }
}
END_TEST

TEST_MAIN("matched", ends_where_the_kicks_led, as_close_as_the_step_allows, several_freedoms_at_once,
          more_freedoms_than_the_load_can_lead, a_parabola_stays_one, what_no_polynomial_can_say_is_left_alone,
          a_mechanism_that_runs_away, hardly_a_swing_is_left_to_the_parabola, powers_of_shifted_polynomials)
