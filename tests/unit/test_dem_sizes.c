/* Size distributions: against their distribution functions, cut at both ends, the same for the same seed. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "../numerics/test_dem_support.h"

#include "dem/model/sizes.h"
#include "protocol/math/random.h"
#include "tests/test_main.h"

#include <gsl/gsl_cdf.h>

static dem_sizes read_sizes(const char *radius) {
  json_t *json = scene_json("{'radius':%s}", radius);
  tdm_error err = {0};
  tdm_object o = tdm_object_open(json, "entry", &err);
  dem_sizes s;
  dem_sizes_read(&o, &s);
  ck_assert_msg(!err.status, "%s: %s", err.path, err.message);
  json_decref(json);
  return s;
}

static int ascending(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return x < y ? -1 : x > y;
}

enum { DRAWS = 20000 };

/* radii of DRAWS particles, ascending */
static double *draws(const dem_sizes *s, uint64_t seed) {
  double *r = calloc(DRAWS, sizeof *r);
  for (uint64_t k = 0; k < DRAWS; k++)
    r[k] = dem_sizes_draw(s, seed, k);
  qsort(r, DRAWS, sizeof *r, ascending);
  ck_assert(r[0] >= s->min && r[DRAWS - 1] <= s->max);
  return r;
}

/* Kolmogorov–Smirnov: sqrt(n) times the largest distance of the draws' distribution function from P */
static double distance(const dem_sizes *s, uint64_t seed, double (*p)(double)) {
  double *r = draws(s, seed), most = 0, low = p(s->min), all = p(s->max) - low;
  for (int k = 0; k < DRAWS; k++) {
    double expected = (p(r[k]) - low) / all;
    most = fmax(most, fmax(fabs((k + 1.0) / DRAWS - expected), fabs((double)k / DRAWS - expected)));
  }
  free(r);
  return most * sqrt(DRAWS);
}

static const double one_in_hundred = 1.628; /* Kolmogorov's distribution */

static double p_uniform(double r) {
  return r;
}
static double p_normal(double r) {
  return gsl_cdf_gaussian_P(r - 5e-3, 1e-3);
}
static double p_tail(double r) { /* minus the complement: it keeps its digits far above the mean */
  return -gsl_cdf_gaussian_Q(r - 1e-3, 1e-3);
}
static double p_lognormal(double r) {
  return gsl_cdf_lognormal_P(r, log(4e-3), 0.5);
}

START_TEST(test_distributions) {
  static const struct {
    const char *radius;
    double (*p)(double);
  } rows[] = {
      {"[0.004,0.006]", p_uniform},
      {"{'distribution':'uniform','min':0.001,'max':0.02}", p_uniform},
      {"{'distribution':'normal','mean':0.005,'deviation':0.001,'min':0.001,'max':0.009}", p_normal},
      {"{'distribution':'normal','mean':0.005,'deviation':0.001,'min':0.0045,'max':0.0052}", p_normal},
      {"{'distribution':'normal','mean':0.001,'deviation':0.001,'min':0.0065,'max':0.1}", p_tail},
      {"{'distribution':'lognormal','median':0.004,'sigma':0.5,'min':0.0005,'max':0.05}", p_lognormal},
      {"{'distribution':'lognormal','median':0.004,'sigma':0.5,'min':0.003,'max':0.006}", p_lognormal},
  };
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    dem_sizes s = read_sizes(rows[i].radius);
    for (uint64_t seed = 1; seed <= 3; seed++) {
      double d = distance(&s, seed, rows[i].p);
      ck_assert_msg(d < one_in_hundred, "%s, seed %d: %.3g", rows[i].radius, (int)seed, d);
    }
    /* the quantile is the inverse, to round-off, and the mean that of the draws to four standard errors */
    double low = rows[i].p(s.min), all = rows[i].p(s.max) - low, sum = 0, squares = 0;
    for (int k = 1; k < 100; k++)
      ck_near((rows[i].p(dem_sizes_quantile(&s, 0.01 * k)) - low) / all, 0.01 * k, 1e-8);
    for (uint64_t k = 0; k < DRAWS; k++) {
      double r = dem_sizes_draw(&s, 9, k);
      sum += r / DRAWS;
      squares += r * r / DRAWS;
    }
    ck_near(dem_sizes_mean(&s), sum, 4 * sqrt((squares - sum * sum) / DRAWS));
  }
}
END_TEST

START_TEST(test_lognormal_moments) {
  /* mean and deviation are those of the radius: with hardly anything cut away the draws have them */
  dem_sizes s = read_sizes("{'distribution':'lognormal','mean':0.005,'deviation':0.002,'min':1e-5,'max':1}");
  double sum = 0, squares = 0;
  enum { N = 200000 };
  for (uint64_t k = 0; k < N; k++) {
    double r = dem_sizes_draw(&s, 5, k);
    sum += r / N;
    squares += r * r / N;
  }
  ck_relative(sum, 0.005, 4 * 0.4 / sqrt(N));
  ck_relative(sqrt(squares - sum * sum), 0.002, 0.02);
  ck_relative(dem_sizes_quantile(&s, 0.5), 0.005 / sqrt(1.16), 1e-9); /* median = mean / sqrt(1 + (deviation/mean)^2) */
}
END_TEST

START_TEST(test_list) {
  dem_sizes s = read_sizes("{'distribution':'list','radii':[0.003,0.009,0.001,0.002],'shares':[5,0,2,1]}");
  ck_near(s.min, 0.001, 0);
  ck_near(s.max, 0.003, 0); /* no particle of 9 mm comes */
  int count[3] = {0};
  for (uint64_t k = 0; k < DRAWS; k++) {
    double r = dem_sizes_draw(&s, 3, k);
    int which = r == 0.003 ? 0 : r == 0.001 ? 1 : r == 0.002 ? 2 : -1;
    ck_assert_int_ge(which, 0);
    count[which]++;
  }
  const double share[] = {0.625, 0.25, 0.125};
  double chi2 = 0;
  for (int k = 0; k < 3; k++)
    chi2 += pow(count[k] - share[k] * DRAWS, 2) / (share[k] * DRAWS);
  ck_assert_msg(chi2 < 9.21, "%g", chi2); /* 1 %, two degrees of freedom */
  ck_relative(dem_sizes_mean(&s), 0.625 * 0.003 + 0.25 * 0.001 + 0.125 * 0.002, 1e-12);

  /* by mass: half of the mass is large, so 8 of 9 particles are small */
  s = read_sizes("{'distribution':'list','radii':[0.001,0.002],'shares':[0.5,0.5],'by':'mass'}");
  ck_near(dem_sizes_quantile(&s, 8.0 / 9 - 1e-12), 0.001, 0);
  ck_near(dem_sizes_quantile(&s, 8.0 / 9 + 1e-12), 0.002, 0);
}
END_TEST

START_TEST(test_counts) {
  /* every lot has exactly the counts, each in another order */
  dem_sizes s = read_sizes("{'distribution':'list','radii':[0.003,0.009,0.001,0.002],'counts':[50,0,21,10]}");
  ck_assert_int_eq(s.total, 81);
  ck_assert(s.min == 0.001 && s.max == 0.003);
  enum { LOTS = 400 };
  int same = 0, first = 0;
  for (uint64_t lot = 0; lot < LOTS; lot++) {
    int count[3] = {0};
    for (uint64_t k = 0; k < 81; k++) {
      double r = dem_sizes_draw(&s, 3, 81 * lot + k);
      count[r == 0.003 ? 0 : r == 0.001 ? 1 : 2]++;
      same += r == dem_sizes_draw(&s, 3, k) && lot > 0;
      first += k == 0 && r == 0.003;
    }
    ck_assert(count[0] == 50 && count[1] == 21 && count[2] == 10);
  }
  /* as often the same as by chance, and as often large at the front: four standard errors */
  double chance = (50.0 * 50 + 21.0 * 21 + 10.0 * 10) / (81.0 * 81), n = 81.0 * (LOTS - 1);
  ck_near(same / n, chance, 4 * sqrt(chance * (1 - chance) / n));
  ck_near((double)first / LOTS, 50.0 / 81, 4 * sqrt(50 * 31 / (81.0 * 81 * LOTS)));
  ck_relative(dem_sizes_mean(&s), (50 * 0.003 + 21 * 0.001 + 10 * 0.002) / 81, 0.01);
}
END_TEST

START_TEST(test_exact_fill) {
  /* a random fill has the counts, too: [A07] Fig. 2.16; and they are mixed in space */
  rig *r = rig_make(scene_json("{'materials':[{'name':'a','density':100,'young_modulus':1e6,'poisson_ratio':0.3}],"
                               "'pairs':[{'materials':['a','a'],'restitution':0.5,'friction':0}],'dimension':2,"
                               "'particles':[{'type':'random','material':'a','count':4336,'radius':{'distribution':"
                               "'list','radii':[0.01,0.015,0.02],'counts':[2278,1716,342]},'region':{'min':[0,-0.02,0],"
                               "'max':[2.68,0.02,2.68]}}]}"),
                    1e-4, 0, NULL);
  int count[3] = {0}, low[3] = {0};
  for (int i = 0; i < r->data->state.nparticle; i++) {
    double radius = r->data->state.sphere[i].radius;
    int k = radius == 0.01 ? 0 : radius == 0.015 ? 1 : 2;
    count[k]++;
    low[k] += r->data->state.sphere[i].position.z < 1.34;
  }
  ck_assert(count[0] == 2278 && count[1] == 1716 && count[2] == 342);
  for (int k = 0; k < 3; k++)
    ck_near(low[k], 0.5 * count[k], 4 * 0.5 * sqrt(count[k]));
  rig_free(r);
}
END_TEST

START_TEST(test_places) {
  /* a permutation of any length, by the seed; all orders of three are as likely */
  static const uint64_t lengths[] = {1, 2, 3, 4, 5, 16, 17, 1000, 4336};
  for (size_t i = 0; i < sizeof lengths / sizeof lengths[0]; i++) {
    uint64_t n = lengths[i];
    bool *seen = calloc(n, sizeof *seen);
    for (uint64_t k = 0; k < n; k++) {
      uint64_t place = tdm_random_place(i, k, n);
      ck_assert(place < n && !seen[place]);
      seen[place] = true;
    }
    free(seen);
  }
  enum { SEEDS = 6000 };
  int orders[9] = {0};
  for (uint64_t seed = 0; seed < SEEDS; seed++)
    orders[3 * tdm_random_place(seed, 0, 3) + tdm_random_place(seed, 1, 3)]++;
  double chi2 = 0;
  for (int k = 0; k < 9; k++)
    chi2 += k % 4 ? pow(orders[k] - SEEDS / 6.0, 2) / (SEEDS / 6.0) : orders[k];
  ck_assert_msg(chi2 < 15.09, "%g", chi2); /* 1 %, five degrees of freedom */
}
END_TEST

START_TEST(test_same_again) {
  /* a function of seed and number: no order, no state; other seeds and numbers give other radii */
  dem_sizes s = read_sizes("{'distribution':'lognormal','median':0.004,'sigma':0.5,'min':0.0005,'max':0.05}");
  double r = dem_sizes_draw(&s, 7, 1000);
  for (uint64_t k = 0; k < 50; k++)
    ck_assert(dem_sizes_draw(&s, 7, 2000 - k) != r);
  ck_assert(dem_sizes_draw(&s, 7, 1000) == r);
  ck_assert(dem_sizes_draw(&s, 8, 1000) != r);
  ck_assert(tdm_random(1, 2, 3) == tdm_random(1, 2, 3) && tdm_random(1, 2, 3) != tdm_random(2, 1, 3));
  s = read_sizes("0.004");
  ck_assert(dem_sizes_draw(&s, 7, 1) == 0.004 && dem_sizes_mean(&s) == 0.004 && dem_sizes_quantile(&s, 0.999) == 0.004);
  /* the ends are reached, never passed, whatever is cut away */
  s = read_sizes("{'distribution':'normal','mean':0.005,'deviation':1e-5,'min':0.00506,'max':1000}");
  ck_near(dem_sizes_quantile(&s, 0), 0.00506, 1e-12);
  ck_assert(dem_sizes_quantile(&s, 1 - 0x1p-53) <= 1000);
}
END_TEST

START_TEST(test_errors) {
  static const struct {
    const char *radius, *path, *says;
  } rows[] = {
      {"0", "e.radius", "greater than 0"},
      {"'x'", "e.radius", "number"},
      {"[0.2,0.1]", "e.radius", "smallest, largest"},
      {"[0,0.1]", "e.radius", "greater than 0"},
      {"{'min':1,'max':2}", "e.radius.distribution", "missing"},
      {"{'distribution':'gauss'}", "e.radius.distribution", "normal"},
      {"{'distribution':'uniform','min':0.2,'max':0.1}", "e.radius.max", "less than min"},
      {"{'distribution':'uniform','min':0,'max':0.1}", "e.radius.min", "greater than 0"},
      {"{'distribution':'uniform','min':0.1,'max':0.2,'mean':0.1}", "e.radius.mean", "unknown"},
      {"{'distribution':'list','radii':[1,2],'shares':[1]}", "e.radius.shares", "1 entries for 2"},
      {"{'distribution':'list','radii':[1,2],'shares':[0,0]}", "e.radius.shares", "all 0"},
      {"{'distribution':'list','radii':[1,2],'shares':[1,-1]}", "e.radius.shares[1]", "0 or greater"},
      {"{'distribution':'list','radii':[1,0],'shares':[1,1]}", "e.radius.radii[1]", "greater than 0"},
      {"{'distribution':'list','radii':[],'shares':[]}", "e.radius.radii", "1 to 64"},
      {"{'distribution':'list','radii':[1,2],'counts':[3]}", "e.radius.counts", "1 entries for 2"},
      {"{'distribution':'list','radii':[1,2],'counts':[3,2.5]}", "e.radius.counts", "whole numbers"},
      {"{'distribution':'list','radii':[1,2],'counts':[1e9,1]}", "e.radius.counts", "whole numbers"},
      {"{'distribution':'list','radii':[1,2],'counts':[0,0]}", "e.radius.counts", "all 0"},
      {"{'distribution':'list','radii':[1,2],'counts':[3,-1]}", "e.radius.counts[1]", "0 or greater"},
      {"{'distribution':'list','radii':[1,2],'counts':[3,1],'shares':[3,1]}", "e.radius.counts", "excludes"},
      {"{'distribution':'list','radii':[1,2],'counts':[3,1],'by':'mass'}", "e.radius.by", "remove"},
      {"{'distribution':'normal','mean':1,'deviation':0.1,'max':2}", "e.radius.min", "missing"},
      {"{'distribution':'normal','mean':1,'deviation':0,'min':1,'max':2}", "e.radius.deviation", "greater than 0"},
      {"{'distribution':'normal','mean':1,'deviation':0.1,'min':3,'max':4}", "e.radius.min", "nothing"},
      {"{'distribution':'normal','mean':1,'deviation':0.1,'min':1,'max':1}", "e.radius.min", "nothing"},
      {"{'distribution':'lognormal','median':1,'deviation':0.1,'min':1,'max':2}", "e.radius.deviation", "excludes"},
      {"{'distribution':'lognormal','median':1,'min':1,'max':2}", "e.radius.sigma", "missing"},
      {"{'distribution':'lognormal','mean':1,'deviation':0.1,'min':1,'max':0.5}", "e.radius.max", "less than min"},
  };
  for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
    json_t *json = scene_json("{'radius':%s}", rows[i].radius);
    tdm_error err = {0};
    tdm_object o = tdm_object_open(json, "e", &err);
    dem_sizes s;
    dem_sizes_read(&o, &s);
    ck_assert_msg(err.status == TDM_ERR_SCENE, "accepted: %s", rows[i].radius);
    ck_assert_str_eq(err.path, rows[i].path);
    ck_assert_msg(strstr(err.message, rows[i].says) != NULL, "%s: %s", err.path, err.message);
    json_decref(json);
  }
}
END_TEST

TEST_MAIN("dem sizes", test_distributions, test_lognormal_moments, test_list, test_counts, test_exact_fill, test_places,
          test_same_again, test_errors)
