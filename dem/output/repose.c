/* The angle of repose of a heap: see repose.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/output/repose.h"

#include <gsl/gsl_fit.h>
#include <stdlib.h>

static const double lower_share = 0.15, upper_share = 0.85; /* of the height: neither the toe nor the rounded top */

typedef struct {
  int n;
  double width, first; /* of a strip, and where strip 0 begins [m] */
  double *top;         /* (n) -inf: no particle */
  double foot, peak;   /* lowest and highest point of the heap [m] */
  double middle;       /* mean place of the particles along the axis [m] */
} profile;

static double along_axis(const tdm_vec3 *x, int along) {
  return along == 0 ? x->x : x->y;
}

static bool make_profile(profile *p, const tdm_snapshot *s, int along) {
  double low = INFINITY, high = -INFINITY;
  *p = (profile){.foot = INFINITY, .peak = -INFINITY};
  for (int i = 0; i < s->nparticle; i++) {
    double u = along_axis(&s->position[i], along);
    low = fmin(low, u);
    high = fmax(high, u);
    p->width = fmax(p->width, 2 * s->radius[i]);
    p->middle += u / s->nparticle;
    p->foot = fmin(p->foot, s->position[i].z - s->radius[i]);
    p->peak = fmax(p->peak, s->position[i].z + s->radius[i]);
  }
  if (s->nparticle == 0 || (high - low) / p->width > 1e6)
    return false;
  p->first = low;
  p->n = (int)((high - low) / p->width) + 1;
  p->top = malloc((size_t)p->n * sizeof *p->top);
  for (int k = 0; p->top && k < p->n; k++)
    p->top[k] = -INFINITY;
  for (int i = 0; p->top && i < s->nparticle; i++) {
    int k = (int)((along_axis(&s->position[i], along) - low) / p->width);
    p->top[k] = fmax(p->top[k], s->position[i].z + s->radius[i]);
  }
  return p->top != NULL;
}

/* slope of the surface on the side `sign` of the middle, as an angle [deg] */
static double flank(const profile *p, int sign) {
  double *u = malloc(2 * (size_t)p->n * sizeof *u), *z = u ? u + p->n : NULL;
  size_t n = 0;
  for (int k = 0; u && k < p->n; k++) {
    double at = p->first + (k + 0.5) * p->width, share = (p->top[k] - p->foot) / (p->peak - p->foot);
    if (sign * (at - p->middle) <= 0 || share < lower_share || share > upper_share)
      continue;
    u[n] = at;
    z[n++] = p->top[k];
  }
  double c0, slope = NAN, cov00, cov01, cov11, sum;
  if (n >= 3)
    gsl_fit_linear(u, 1, z, 1, n, &c0, &slope, &cov00, &cov01, &cov11, &sum);
  free(u);
  return tdm_degrees(atan(-sign * slope));
}

dem_repose dem_repose_of(const tdm_snapshot *s, int along) {
  profile p;
  dem_repose out = {NAN, NAN, NAN};
  if (!make_profile(&p, s, along))
    return out;
  out.low = flank(&p, -1);
  out.high = flank(&p, 1);
  out.mean = 0.5 * (out.low + out.high);
  free(p.top);
  return out;
}
