/* What the viewer's page is shown, packed: see pack.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/page/pack.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- bytes ---- */

static tdm_status reserve(tdm_view_bytes *bytes, size_t size, tdm_error *err) {
  bytes->size = 0;
  if (size <= bytes->capacity)
    return TDM_OK;
  uint8_t *data = realloc(bytes->data, size);
  if (!data)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory for what the viewer is shown (%zu bytes)", size);
  bytes->data = data;
  bytes->capacity = size;
  return TDM_OK;
}

static void put(tdm_view_bytes *bytes, const void *from, size_t size) {
  if (size > 0)
    memcpy(bytes->data + bytes->size, from, size);
  bytes->size += size;
}

static void put_u32(tdm_view_bytes *bytes, uint32_t x) {
  put(bytes, &x, sizeof x);
}

static void put_f32(tdm_view_bytes *bytes, double x) {
  float single = (float)x;
  put(bytes, &single, sizeof single);
}

static void put_u16(tdm_view_bytes *bytes, uint16_t x) {
  put(bytes, &x, sizeof x);
}

static void put_vec(tdm_view_bytes *bytes, tdm_vec3 v) {
  put_f32(bytes, v.x);
  put_f32(bytes, v.y);
  put_f32(bytes, v.z);
}

uint16_t cpl_pack_half(float x) {
  if (isnan(x))
    return 0x7e00;
  const uint16_t sign = signbit(x) ? 0x8000 : 0;
  int exponent;
  const float mantissa = frexpf(fabsf(x), &exponent); /* in [0.5, 1) */
  if (x == 0)
    return sign;
  if (isinf(x) || exponent > 16)
    return sign | 0x7c00;
  /* multiples of 2^-24 below 2^-14, else 11 digits; a carry of rounding runs into the exponent as it should */
  if (exponent < -13)
    return (uint16_t)(sign + (uint16_t)lrintf(ldexpf(mantissa, exponent + 24)));
  return (uint16_t)(sign + ((exponent + 14) << 10) + (uint16_t)lrintf(ldexpf(mantissa, 11)) - 1024);
}

/* ---- boxes ---- */

typedef struct {
  tdm_vec3 low, size;
} box;

/* The box of all finite places; one without extent where there are none. */
static box box_of(const tdm_vec3 *place, int n) {
  tdm_vec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
  for (int i = 0; i < n; i++) {
    const tdm_vec3 p = place[i];
    if (!isfinite(p.x + p.y + p.z))
      continue;
    low = (tdm_vec3){fmin(low.x, p.x), fmin(low.y, p.y), fmin(low.z, p.z)};
    high = (tdm_vec3){fmax(high.x, p.x), fmax(high.y, p.y), fmax(high.z, p.z)};
  }
  if (!(low.x <= high.x))
    return (box){{0, 0, 0}, {0, 0, 0}};
  return (box){low, tdm_sub(high, low)};
}

static void put_box(tdm_view_bytes *bytes, const box *b) {
  put_vec(bytes, b->low);
  put_vec(bytes, b->size);
}

/* a share of the box's width in 65535 steps */
static uint16_t step_of(double x, double low, double size) {
  const double s = size > 0 ? (x - low) / size : 0;
  return (uint16_t)lrint(65535 * fmax(0, fmin(1, s))); /* fmax: NaN counts as 0 */
}

static void put_places(tdm_view_bytes *bytes, const box *b, const tdm_vec3 *place, int n) {
  for (int i = 0; i < n; i++) {
    put_u16(bytes, step_of(place[i].x, b->low.x, b->size.x));
    put_u16(bytes, step_of(place[i].y, b->low.y, b->size.y));
    put_u16(bytes, step_of(place[i].z, b->low.z, b->size.z));
  }
}

/* ---- vectors ---- */

static double greatest(const tdm_vec3 *v, int n) {
  double most = 0;
  for (int i = 0; i < n; i++) {
    const double size = tdm_norm(v[i]);
    most = isfinite(size) ? fmax(most, size) : most;
  }
  return most;
}

/* The power of two that brings numbers up to `most` below 2^15, so that small ones keep their digits as well. */
static double scale_of(double most) {
  int exponent = 0;
  frexp(most, &exponent);
  return most > 0 ? ldexp(1, exponent - 15 > -120 ? exponent - 15 : -120) : 1;
}

static void put_halves(tdm_view_bytes *bytes, const tdm_vec3 *v, int n, double scale) {
  for (int i = 0; i < n; i++) {
    put_u16(bytes, cpl_pack_half((float)(v[i].x / scale)));
    put_u16(bytes, cpl_pack_half((float)(v[i].y / scale)));
    put_u16(bytes, cpl_pack_half((float)(v[i].z / scale)));
  }
}

/* The load of the particles on each body, where it is known for one of its polygons. */
static void sum_loads(const tdm_scenery *scenery, const tdm_snapshot *s, tdm_vec3 *load) {
  for (int i = 0; i < s->nbody; i++)
    load[i] = (tdm_vec3){NAN, NAN, NAN};
  for (int i = 0; i < s->nforce; i++) {
    const tdm_vec3 f = s->force_on[i];
    tdm_vec3 *sum = &load[scenery->polygon[i].body];
    if (isfinite(f.x + f.y + f.z))
      *sum = isnan(sum->x) ? f : tdm_add(*sum, f);
  }
}

/* ---- frame, roster, surface ---- */

tdm_status cpl_pack_frame(const tdm_scenery *scenery, const tdm_snapshot *s, uint32_t roster, tdm_view_bytes *bytes,
                          tdm_error *err) {
  const size_t n = (size_t)s->nparticle, b = (size_t)s->nbody;
  tdm_vec3 *load = calloc(b + 1, sizeof *load);
  if (!load)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory for what the viewer is shown");
  if (reserve(bytes, 84 + 40 * b + 4 * (size_t)s->nline + 12 * (size_t)s->npoint + 24 * n, err) == TDM_OK) {
    const box places = box_of(s->position, s->nparticle);
    const tdm_vec3 *const vectors[] = {s->velocity, s->spin, s->force};
    double most[3];
    sum_loads(scenery, s, load);
    put_u32(bytes, CPL_PACK_VERSION);
    put_u32(bytes, roster);
    put(bytes, &s->time, sizeof s->time);
    put_u32(bytes, (uint32_t)s->nparticle);
    put_u32(bytes, (uint32_t)s->nbody);
    put_u32(bytes, (uint32_t)s->nline);
    put_u32(bytes, (uint32_t)s->npoint);
    put_box(bytes, &places);
    for (int k = 0; k < 3; k++)
      most[k] = greatest(vectors[k], s->nparticle);
    for (int k = 0; k < 3; k++)
      put_f32(bytes, scale_of(most[k]));
    for (int k = 0; k < 3; k++)
      put_f32(bytes, most[k]);
    put_f32(bytes, greatest(load, s->nbody));
    for (int i = 0; i < s->nbody; i++) {
      const tdm_quat q = s->pose[i].orientation;
      put_vec(bytes, s->pose[i].position);
      put_f32(bytes, q.w);
      put_vec(bytes, (tdm_vec3){q.x, q.y, q.z});
    }
    for (int i = 0; i < s->nbody; i++)
      put_vec(bytes, load[i]);
    put(bytes, s->line_end, (size_t)s->nline * sizeof *s->line_end);
    for (int i = 0; i < s->npoint; i++)
      put_vec(bytes, s->point[i]);
    put_places(bytes, &places, s->position, s->nparticle);
    for (int k = 0; k < 3; k++)
      put_halves(bytes, vectors[k], s->nparticle, scale_of(most[k]));
  }
  free(load);
  return err->status;
}

tdm_status cpl_pack_roster(const tdm_snapshot *s, uint32_t serial, tdm_view_bytes *bytes, tdm_error *err) {
  const int n = s->nparticle;
  if (reserve(bytes, 40 + 16 * (size_t)n, err) != TDM_OK)
    return err->status;
  const box births = box_of(s->born, n);
  put_u32(bytes, CPL_PACK_VERSION);
  put_u32(bytes, serial);
  put_u32(bytes, (uint32_t)n);
  put_u32(bytes, 0);
  put_box(bytes, &births);
  for (int i = 0; i < n; i++)
    put_u32(bytes, (uint32_t)s->id[i]);
  for (int i = 0; i < n; i++)
    put_f32(bytes, s->radius[i]);
  put_places(bytes, &births, s->born, n);
  for (int i = 0; i < n; i++)
    bytes->data[bytes->size++] = (uint8_t)(s->material[i] < 0 ? 0 : s->material[i] > 255 ? 255 : s->material[i]);
  for (int i = 0; i < n; i++)
    bytes->data[bytes->size++] = (uint8_t)(int8_t)(s->size_class[i] > 127 ? 127 : s->size_class[i]);
  return TDM_OK;
}

bool cpl_pack_same_roster(const tdm_snapshot *a, const tdm_snapshot *b) {
  const size_t n = (size_t)a->nparticle;
  return a->nparticle == b->nparticle &&
         (n == 0 ||
          (memcmp(a->id, b->id, n * sizeof *a->id) == 0 && memcmp(a->radius, b->radius, n * sizeof *a->radius) == 0 &&
           memcmp(a->material, b->material, n * sizeof *a->material) == 0 &&
           memcmp(a->size_class, b->size_class, n * sizeof *a->size_class) == 0));
}

tdm_status cpl_pack_surface(const tdm_scenery *scenery, tdm_view_bytes *bytes, tdm_error *err) {
  uint32_t corners = 0;
  for (int i = 0; i < scenery->npolygon; i++)
    corners += (uint32_t)scenery->polygon[i].ncorner;
  if (reserve(bytes, 16 + 8 * (size_t)scenery->npolygon + 12 * (size_t)corners, err) != TDM_OK)
    return err->status;
  put_u32(bytes, CPL_PACK_VERSION);
  put_u32(bytes, (uint32_t)scenery->npolygon);
  put_u32(bytes, corners);
  put_u32(bytes, 0);
  for (int i = 0; i < scenery->npolygon; i++)
    put_u32(bytes, (uint32_t)scenery->polygon[i].body);
  for (int i = 0; i < scenery->npolygon; i++)
    put_u32(bytes, (uint32_t)scenery->polygon[i].ncorner + (scenery->polygon[i].solid ? 256 : 0));
  for (int i = 0; i < scenery->npolygon; i++)
    for (int c = 0; c < scenery->polygon[i].ncorner; c++)
      put_vec(bytes, scenery->polygon[i].corner[c]);
  return TDM_OK;
}
