/* Size distributions: see sizes.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/model/sizes.h"

#include "protocol/math/random.h"

#include <gsl/gsl_cdf.h>
#include <string.h>

/* one row a distribution: its name, read by read_<name>, inverted by quantile_<name> */
#define DISTRIBUTION_LIST(X) \
  X(uniform)                 \
  X(list)                    \
  X(normal)                  \
  X(lognormal)

/* ---- quantiles ---- */

static double quantile_uniform(const dem_sizes *s, double u) {
  return s->min + (s->max - s->min) * u;
}

static double quantile_list(const dem_sizes *s, double u) {
  int k = 0;
  while (k < s->nradius - 1 && u >= s->upto[k])
    k++;
  return s->radius[k];
}

/* The share of the standard normal distribution between a and b. In the upper tail it comes from the complement, which
 * keeps its digits there. */
static double share_between(double a, double b) {
  return a > 0 ? gsl_cdf_ugaussian_Q(a) - gsl_cdf_ugaussian_Q(b) : gsl_cdf_ugaussian_P(b) - gsl_cdf_ugaussian_P(a);
}

/* quantile u of the normal distribution, cut to [low, high] */
static double quantile_cut(double mean, double deviation, double low, double high, double u) {
  double a = (low - mean) / deviation, b = (high - mean) / deviation, z;
  if (a > 0)
    z = gsl_cdf_ugaussian_Qinv(gsl_cdf_ugaussian_Q(a) - u * share_between(a, b));
  else
    z = gsl_cdf_ugaussian_Pinv(gsl_cdf_ugaussian_P(a) + u * share_between(a, b));
  return mean + deviation * z;
}

static double quantile_normal(const dem_sizes *s, double u) {
  return quantile_cut(s->mean, s->deviation, s->min, s->max, u);
}

static double quantile_lognormal(const dem_sizes *s, double u) {
  return exp(quantile_cut(s->mean, s->deviation, log(s->min), log(s->max), u));
}

/* ---- reading ---- */

/* "min" and "max" of a distribution object */
static void read_limits(tdm_object *o, dem_sizes *s) {
  s->min = tdm_get_number(o, "min", TDM_REQUIRED, TDM_POSITIVE);
  s->max = tdm_get_number(o, "max", TDM_REQUIRED, TDM_POSITIVE);
  if (!o->err->status && s->max < s->min)
    tdm_object_fail(o, "max", "is %g m, less than min, %g m", s->max, s->min);
}

static void read_uniform(tdm_object *o, dem_sizes *s) {
  read_limits(o, s);
}

/* n numbers of the array under `key`, at least 0 or greater than it */
static void read_numbers(tdm_object *o, const char *key, double *out, int n, bool positive) {
  json_t *array = tdm_get_array(o, key, true);
  for (int k = 0; k < n && !o->err->status; k++) {
    json_t *value = json_array_get(array, (size_t)k);
    out[k] = json_number_value(value);
    if (json_is_number(value) && isfinite(out[k]) && (positive ? out[k] > 0 : out[k] >= 0))
      continue;
    char path[TDM_PATH_MAX];
    tdm_fail(o->err, TDM_ERR_SCENE, tdm_path(path, o, key, k), "must be a number %s",
             positive ? "greater than 0" : "of 0 or greater");
  }
}

/* whole numbers that add up to the particles of a lot */
static void read_counts(tdm_object *o, dem_sizes *s) {
  enum { MOST = 1000000000 };
  if (tdm_has(o, "by"))
    tdm_object_fail(o, "by", "is of \"shares\"; counts are numbers of particles; remove it");
  double sum = 0;
  read_numbers(o, "counts", s->upto, s->nradius, false);
  for (int k = 0; k < s->nradius && !o->err->status; k++) {
    sum += s->upto[k];
    if (s->upto[k] != floor(s->upto[k]) || sum > MOST)
      tdm_object_fail(o, "counts", "has the entry %g; give whole numbers of particles, %d in all at most", s->upto[k],
                      MOST);
  }
  s->total = o->err->status ? 0 : (int)sum;
}

/* as many shares or counts as there are radii: their key; NULL after an error */
static const char *read_radii(tdm_object *o, dem_sizes *s) {
  const char *key = tdm_has(o, "counts") ? "counts" : "shares";
  if (tdm_has(o, "counts") && tdm_has(o, "shares"))
    tdm_object_fail(o, "counts", "excludes \"shares\"; give exact numbers or shares");
  size_t n = json_array_size(tdm_get_array(o, "radii", true));
  size_t nshare = json_array_size(tdm_get_array(o, key, true));
  if (!o->err->status && (n == 0 || n > DEM_SIZES_MAX))
    tdm_object_fail(o, "radii", "has %zu entries; give 1 to %d", n, DEM_SIZES_MAX);
  if (!o->err->status && nshare != n)
    tdm_object_fail(o, key, "has %zu entries for %zu radii; give one for each radius", nshare, n);
  s->nradius = o->err->status ? 0 : (int)n;
  read_numbers(o, "radii", s->radius, s->nradius, true);
  return o->err->status ? NULL : key;
}

static void read_list(tdm_object *o, dem_sizes *s) {
  static const char *const by[] = {"number", "mass"};
  const char *key = read_radii(o, s);
  bool by_mass = tdm_get_choice(o, "by", by, 2, 0) == 1;
  if (!key)
    return;
  if (strcmp(key, "counts") == 0)
    read_counts(o, s);
  else
    read_numbers(o, "shares", s->upto, s->nradius, false);
  double sum = 0;
  s->min = INFINITY;
  for (int k = 0; k < s->nradius; k++) {
    if (s->upto[k] > 0) {
      s->min = fmin(s->min, s->radius[k]);
      s->max = fmax(s->max, s->radius[k]);
    }
    sum += by_mass ? s->upto[k] / (s->radius[k] * s->radius[k] * s->radius[k]) : s->upto[k];
    s->upto[k] = sum;
  }
  if (!o->err->status && !(sum > 0 && isfinite(sum)))
    tdm_object_fail(o, key, "are all 0; give at least one that is greater");
  for (int k = 0; k < s->nradius; k++)
    s->upto[k] /= sum;
}

/* refuse limits between which there is nothing of the distribution */
static void check_share(tdm_object *o, const dem_sizes *s, double low, double high) {
  if (o->err->status || share_between((low - s->mean) / s->deviation, (high - s->mean) / s->deviation) > 1e-12)
    return;
  tdm_object_fail(o, "min",
                  "and max, %g and %g m, leave nothing of the distribution; set them on both sides of its middle",
                  s->min, s->max);
}

static void read_normal(tdm_object *o, dem_sizes *s) {
  s->mean = tdm_get_number(o, "mean", TDM_REQUIRED, TDM_POSITIVE);
  s->deviation = tdm_get_number(o, "deviation", TDM_REQUIRED, TDM_POSITIVE);
  read_limits(o, s);
  check_share(o, s, s->min, s->max);
}

static void read_lognormal(tdm_object *o, dem_sizes *s) {
  if (tdm_has(o, "median") || tdm_has(o, "sigma")) {
    if (tdm_has(o, "mean") || tdm_has(o, "deviation"))
      tdm_object_fail(o, tdm_has(o, "mean") ? "mean" : "deviation",
                      "excludes \"median\" and \"sigma\"; give mean and deviation of the radius, or its median and the "
                      "deviation sigma of its logarithm");
    s->mean = log(tdm_get_number(o, "median", TDM_REQUIRED, TDM_POSITIVE));
    s->deviation = tdm_get_number(o, "sigma", TDM_REQUIRED, TDM_POSITIVE);
  } else {
    double mean = tdm_get_number(o, "mean", TDM_REQUIRED, TDM_POSITIVE);
    double share = tdm_get_number(o, "deviation", TDM_REQUIRED, TDM_POSITIVE) / mean;
    double variance = log1p(share * share); /* of the logarithm */
    s->mean = log(mean) - 0.5 * variance;
    s->deviation = sqrt(variance);
  }
  read_limits(o, s);
  check_share(o, s, log(s->min), log(s->max));
}

/* ---- the table ---- */

static const struct {
  double (*quantile)(const dem_sizes *s, double u);
  void (*read)(tdm_object *o, dem_sizes *s);
} table[] = {
#define X(name) {quantile_##name, read_##name},
    DISTRIBUTION_LIST(X)
#undef X
};

static void read_distribution(tdm_object *o, dem_sizes *s) {
  static const char *const names[] = {
#define X(name) #name,
      DISTRIBUTION_LIST(X)
#undef X
  };
  int k = tdm_get_choice(o, "distribution", names, sizeof names / sizeof names[0], -1);
  if (k < 0)
    return;
  s->distribution = k;
  table[k].read(o, s);
  tdm_object_close(o);
}

void dem_sizes_read(tdm_object *o, dem_sizes *s) {
  *s = (dem_sizes){0};
  json_t *value = tdm_has(o, "radius") ? json_object_get(o->json, "radius") : NULL;
  if (json_is_object(value)) {
    tdm_object own = tdm_get_object(o, "radius", true);
    read_distribution(&own, s);
    return;
  }
  double range[2] = {0, 0};
  if (json_is_array(value))
    tdm_get_numbers(o, "radius", range, 2, true);
  else
    range[0] = range[1] = tdm_get_number(o, "radius", TDM_REQUIRED, TDM_POSITIVE);
  if (!o->err->status && !(range[0] > 0 && range[1] >= range[0]))
    tdm_object_fail(o, "radius", "is [%g, %g] but must be [smallest, largest], both greater than 0", range[0],
                    range[1]);
  s->min = range[0];
  s->max = range[1];
}

double dem_sizes_quantile(const dem_sizes *s, double u) {
  return fmin(s->max, fmax(s->min, table[s->distribution].quantile(s, u)));
}

/* the place of particle k in the sorted lot that it belongs to, as a share of the lot */
static double share_of_lot(const dem_sizes *s, uint64_t seed, uint64_t k) {
  uint64_t total = (uint64_t)s->total;
  return ((double)tdm_random_place(tdm_random_mix(seed) + k / total, k % total, total) + 0.5) / s->total;
}

double dem_sizes_draw(const dem_sizes *s, uint64_t seed, uint64_t k) {
  if (s->min == s->max)
    return s->min;
  return dem_sizes_quantile(s, s->total > 0 ? share_of_lot(s, seed, k) : tdm_random(seed, k, 0));
}

double dem_sizes_mean(const dem_sizes *s) {
  enum { N = 256 };
  if (s->min == s->max)
    return s->min;
  double sum = 0;
  for (int k = 0; k < N; k++)
    sum += dem_sizes_quantile(s, (k + 0.5) / N);
  return sum / N;
}
