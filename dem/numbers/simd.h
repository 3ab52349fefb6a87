/* Vectors of doubles, one lane a contact: the same few operations for each instruction set.
 *
 * A source that includes this is compiled once for each instruction set (CMakeLists.txt), with DEM_SIMD telling which:
 * 512 (AVX-512F/VL/DQ), 256 (AVX2) or 0 (plain C, four lanes). Every operation is the IEEE one and nothing is
 * contracted, so all three give the same bits.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_NUMBERS_SIMD_H
#define DEM_NUMBERS_SIMD_H

#include "dem/base/sphere.h"
#include "protocol/math/pose.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#ifndef DEM_SIMD
#error "DEM_SIMD is set by the build: 512, 256 or 0; DEM_SIMD_WIDEST, too: the largest that it compiles"
#endif

/* no vector is passed to or from a function that is compiled otherwise */
#pragma GCC diagnostic ignored "-Wpsabi"

/* a name for each instruction set */
#define DEM_ISA(name) DEM_ISA_(name)
#define DEM_INLINE static inline __attribute__((always_inline, unused))

#if DEM_SIMD == 512
#include <immintrin.h>
enum { DEM_W = 8 };
#define DEM_ISA_(name) name##_avx512
typedef __m512d vd;
typedef __mmask8 vm;

DEM_INLINE vd vd_set(double a) {
  return _mm512_set1_pd(a);
}
DEM_INLINE vd vd_load(const double *p) {
  return _mm512_loadu_pd(p);
}
DEM_INLINE void vd_store(double *p, vd a) {
  _mm512_storeu_pd(p, a);
}
DEM_INLINE vd vd_sqrt(vd a) {
  return _mm512_sqrt_pd(a);
}
DEM_INLINE vd vd_max(vd a, vd b) {
  return _mm512_max_pd(a, b);
}
DEM_INLINE vd vd_min(vd a, vd b) {
  return _mm512_min_pd(a, b);
}
DEM_INLINE vd vd_abs(vd a) {
  return _mm512_abs_pd(a);
}
DEM_INLINE vd vd_rint(vd a) {
  return _mm512_roundscale_pd(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}
DEM_INLINE vm vm_less(vd a, vd b) {
  return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ);
}
DEM_INLINE vm vm_equal(vd a, vd b) {
  return _mm512_cmp_pd_mask(a, b, _CMP_EQ_OQ);
}
DEM_INLINE vm vm_and(vm a, vm b) {
  return a & b;
}
DEM_INLINE vm vm_or(vm a, vm b) {
  return a | b;
}
DEM_INLINE vm vm_without(vm a, vm b) {
  return a & (vm)~b;
}
DEM_INLINE bool vm_any(vm a) {
  return a != 0;
}
DEM_INLINE unsigned vm_bits(vm a) {
  return a;
}
DEM_INLINE vm vm_first(int n) {
  return (vm)((1u << n) - 1);
}
DEM_INLINE vd vd_pick(vm m, vd yes, vd no) {
  return _mm512_mask_blend_pd(m, no, yes);
}
DEM_INLINE vd vd_only(vm m, vd a) {
  return _mm512_maskz_mov_pd(m, a);
}
DEM_INLINE vd vd_ratio_single(vd a, vd b) {
  return _mm512_cvtps_pd(_mm256_div_ps(_mm512_cvtpd_ps(a), _mm512_cvtpd_ps(b)));
}

/* eight rows of eight to eight columns */
DEM_INLINE void vd_transpose8(vd r[8]) {
  vd a0 = _mm512_unpacklo_pd(r[0], r[1]), a1 = _mm512_unpackhi_pd(r[0], r[1]);
  vd a2 = _mm512_unpacklo_pd(r[2], r[3]), a3 = _mm512_unpackhi_pd(r[2], r[3]);
  vd a4 = _mm512_unpacklo_pd(r[4], r[5]), a5 = _mm512_unpackhi_pd(r[4], r[5]);
  vd a6 = _mm512_unpacklo_pd(r[6], r[7]), a7 = _mm512_unpackhi_pd(r[6], r[7]);
  vd b0 = _mm512_shuffle_f64x2(a0, a2, 0x88), b1 = _mm512_shuffle_f64x2(a1, a3, 0x88);
  vd b2 = _mm512_shuffle_f64x2(a0, a2, 0xdd), b3 = _mm512_shuffle_f64x2(a1, a3, 0xdd);
  vd b4 = _mm512_shuffle_f64x2(a4, a6, 0x88), b5 = _mm512_shuffle_f64x2(a5, a7, 0x88);
  vd b6 = _mm512_shuffle_f64x2(a4, a6, 0xdd), b7 = _mm512_shuffle_f64x2(a5, a7, 0xdd);
  r[0] = _mm512_shuffle_f64x2(b0, b4, 0x88), r[4] = _mm512_shuffle_f64x2(b0, b4, 0xdd);
  r[1] = _mm512_shuffle_f64x2(b1, b5, 0x88), r[5] = _mm512_shuffle_f64x2(b1, b5, 0xdd);
  r[2] = _mm512_shuffle_f64x2(b2, b6, 0x88), r[6] = _mm512_shuffle_f64x2(b2, b6, 0xdd);
  r[3] = _mm512_shuffle_f64x2(b3, b7, 0x88), r[7] = _mm512_shuffle_f64x2(b3, b7, 0xdd);
}

DEM_INLINE void vd_sphere_difference(const dem_sphere *s, const int *i, const int *j, vd out[8]) {
  const vd sign = _mm512_setr_pd(-1, -1, -1, -1, -1, -1, -1, 1);
  for (int l = 0; l < 8; l++)
    out[l] = _mm512_fmadd_pd(vd_load(&s[j[l]].position.x), sign, vd_load(&s[i[l]].position.x));
  vd_transpose8(out);
}

DEM_INLINE void vd_records(const double *of, const int *i, vd out[8]) {
  for (int l = 0; l < 8; l++)
    out[l] = vd_load(of + 8 * (size_t)i[l]);
  vd_transpose8(out);
}

DEM_INLINE vd vd_lanes(const double *of, const int *i) {
  return _mm512_setr_pd(of[i[0]], of[i[1]], of[i[2]], of[i[3]], of[i[4]], of[i[5]], of[i[6]], of[i[7]]);
}

DEM_INLINE vd vd_radii(const dem_sphere *s, const int *i) {
  __m256i at = _mm256_slli_epi32(_mm256_loadu_si256((const __m256i *)i), 3); /* in doubles */
  return _mm512_i32gather_pd(at, &s->radius, 8);
}

DEM_INLINE void vd_push_forces(dem_push *push, const int *i, const int *j, const vd f[3]) {
  vd xy0 = _mm512_unpacklo_pd(f[0], f[1]), xy1 = _mm512_unpackhi_pd(f[0], f[1]);
  vd z0 = _mm512_unpacklo_pd(f[2], vd_set(0)), z1 = _mm512_unpackhi_pd(f[2], vd_set(0));
  const __m512i low = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13), high = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  vd rows[4] = {_mm512_permutex2var_pd(xy0, low, z0), _mm512_permutex2var_pd(xy1, low, z1),
                _mm512_permutex2var_pd(xy0, high, z0), _mm512_permutex2var_pd(xy1, high, z1)}; /* l and l + 4 */
  for (int l = 0; l < 8; l++) {
    __m256d r = l < 4 ? _mm512_castpd512_pd256(rows[l]) : _mm512_extractf64x4_pd(rows[l - 4], 1);
    double *one = &push[i[l]].force.x, *other = &push[j[l]].force.x;
    _mm256_storeu_pd(one, _mm256_add_pd(_mm256_loadu_pd(one), r));
    _mm256_storeu_pd(other, _mm256_sub_pd(_mm256_loadu_pd(other), r));
  }
}

DEM_INLINE void vd_push_walls(dem_push *push, const int *i, const vd f[3], const vd t[3], const vd m[3],
                              tdm_wrench *load) {
  vd r[8] = {f[0], f[1], f[2], vd_set(0), t[0], t[1], t[2], vd_set(0)};
  vd w[8] = {f[0], f[1], f[2], m[0], m[1], m[2], vd_set(0), vd_set(0)};
  vd_transpose8(r);
  vd_transpose8(w);
  const __mmask8 six = 0x3f;
  vd sum = _mm512_maskz_loadu_pd(six, &load->force.x);
  for (int l = 0; l < 8; l++) {
    double *one = &push[i[l]].force.x;
    vd_store(one, vd_load(one) + r[l]);
    sum = sum - w[l];
  }
  _mm512_mask_storeu_pd(&load->force.x, six, sum);
}

DEM_INLINE void vd_rotor_sum(const dem_rotor *s, const int *i, const int *j, vd out[4]) {
  vd r[4];
  for (int l = 0; l < 4; l++) {
    __m256d low = _mm256_add_pd(_mm256_loadu_pd(&s[i[l]].surface.x), _mm256_loadu_pd(&s[j[l]].surface.x));
    __m256d high = _mm256_add_pd(_mm256_loadu_pd(&s[i[l + 4]].surface.x), _mm256_loadu_pd(&s[j[l + 4]].surface.x));
    r[l] = _mm512_insertf64x4(_mm512_castpd256_pd512(low), high, 1); /* l and l + 4 */
  }
  vd a0 = _mm512_unpacklo_pd(r[0], r[1]), a1 = _mm512_unpackhi_pd(r[0], r[1]);
  vd a2 = _mm512_unpacklo_pd(r[2], r[3]), a3 = _mm512_unpackhi_pd(r[2], r[3]);
  const __m512i low = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13), high = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
  out[0] = _mm512_permutex2var_pd(a0, low, a2), out[2] = _mm512_permutex2var_pd(a0, high, a2);
  out[1] = _mm512_permutex2var_pd(a1, low, a3), out[3] = _mm512_permutex2var_pd(a1, high, a3);
}

DEM_INLINE void vd_push_pairs(dem_push *push, const int *i, const int *j, const vd f[3], const vd t[3]) {
  vd r[8] = {f[0], f[1], f[2], vd_set(0), t[0], t[1], t[2], vd_set(0)};
  vd_transpose8(r);
  const vd sign = _mm512_setr_pd(-0.0, -0.0, -0.0, 0, 0, 0, 0, 0);
  for (int l = 0; l < 8; l++) {
    double *one = &push[i[l]].force.x, *other = &push[j[l]].force.x;
    vd_store(one, vd_load(one) + r[l]);
    vd_store(other, vd_load(other) + _mm512_xor_pd(r[l], sign));
  }
}

#elif DEM_SIMD == 256
#include <immintrin.h>
enum { DEM_W = 4 };
#define DEM_ISA_(name) name##_avx2
typedef __m256d vd;
typedef __m256d vm;

DEM_INLINE vd vd_set(double a) {
  return _mm256_set1_pd(a);
}
DEM_INLINE vd vd_load(const double *p) {
  return _mm256_loadu_pd(p);
}
DEM_INLINE void vd_store(double *p, vd a) {
  _mm256_storeu_pd(p, a);
}
DEM_INLINE vd vd_sqrt(vd a) {
  return _mm256_sqrt_pd(a);
}
DEM_INLINE vd vd_max(vd a, vd b) {
  return _mm256_max_pd(a, b);
}
DEM_INLINE vd vd_min(vd a, vd b) {
  return _mm256_min_pd(a, b);
}
DEM_INLINE vd vd_abs(vd a) {
  return _mm256_andnot_pd(vd_set(-0.0), a);
}
DEM_INLINE vd vd_rint(vd a) {
  return _mm256_round_pd(a, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
}
DEM_INLINE vm vm_less(vd a, vd b) {
  return _mm256_cmp_pd(a, b, _CMP_LT_OQ);
}
DEM_INLINE vm vm_equal(vd a, vd b) {
  return _mm256_cmp_pd(a, b, _CMP_EQ_OQ);
}
DEM_INLINE vm vm_and(vm a, vm b) {
  return _mm256_and_pd(a, b);
}
DEM_INLINE vm vm_or(vm a, vm b) {
  return _mm256_or_pd(a, b);
}
DEM_INLINE vm vm_without(vm a, vm b) {
  return _mm256_andnot_pd(b, a);
}
DEM_INLINE bool vm_any(vm a) {
  return _mm256_movemask_pd(a) != 0;
}
DEM_INLINE unsigned vm_bits(vm a) {
  return (unsigned)_mm256_movemask_pd(a);
}
DEM_INLINE vm vm_first(int n) {
  return vm_less(_mm256_setr_pd(0, 1, 2, 3), vd_set(n));
}
DEM_INLINE vd vd_pick(vm m, vd yes, vd no) {
  return _mm256_blendv_pd(no, yes, m);
}
DEM_INLINE vd vd_only(vm m, vd a) {
  return _mm256_and_pd(m, a);
}
DEM_INLINE vd vd_ratio_single(vd a, vd b) {
  return _mm256_cvtps_pd(_mm_div_ps(_mm256_cvtpd_ps(a), _mm256_cvtpd_ps(b)));
}

/* four rows of four to four columns */
DEM_INLINE void vd_transpose4(vd r[4]) {
  vd a0 = _mm256_unpacklo_pd(r[0], r[1]), a1 = _mm256_unpackhi_pd(r[0], r[1]);
  vd a2 = _mm256_unpacklo_pd(r[2], r[3]), a3 = _mm256_unpackhi_pd(r[2], r[3]);
  r[0] = _mm256_permute2f128_pd(a0, a2, 0x20), r[2] = _mm256_permute2f128_pd(a0, a2, 0x31);
  r[1] = _mm256_permute2f128_pd(a1, a3, 0x20), r[3] = _mm256_permute2f128_pd(a1, a3, 0x31);
}

DEM_INLINE void vd_sphere_difference(const dem_sphere *s, const int *i, const int *j, vd out[8]) {
  for (int l = 0; l < 4; l++) {
    out[l] = vd_load(&s[i[l]].position.x) - vd_load(&s[j[l]].position.x);
    vd a = vd_load(&s[i[l]].velocity.x), b = vd_load(&s[j[l]].velocity.x);
    out[4 + l] = a + _mm256_xor_pd(b, _mm256_setr_pd(-0.0, -0.0, -0.0, 0));
  }
  vd_transpose4(out);
  vd_transpose4(out + 4);
}

DEM_INLINE void vd_records(const double *of, const int *i, vd out[8]) {
  for (int l = 0; l < 4; l++) {
    out[l] = vd_load(of + 8 * (size_t)i[l]);
    out[4 + l] = vd_load(of + 8 * (size_t)i[l] + 4);
  }
  vd_transpose4(out);
  vd_transpose4(out + 4);
}

DEM_INLINE vd vd_lanes(const double *of, const int *i) {
  return _mm256_setr_pd(of[i[0]], of[i[1]], of[i[2]], of[i[3]]);
}

DEM_INLINE vd vd_radii(const dem_sphere *s, const int *i) {
  return _mm256_setr_pd(s[i[0]].radius, s[i[1]].radius, s[i[2]].radius, s[i[3]].radius);
}

DEM_INLINE void vd_push_forces(dem_push *push, const int *i, const int *j, const vd f[3]) {
  vd a[4] = {f[0], f[1], f[2], vd_set(0)};
  vd_transpose4(a);
  for (int l = 0; l < 4; l++) {
    double *one = &push[i[l]].force.x, *other = &push[j[l]].force.x;
    vd_store(one, vd_load(one) + a[l]);
    vd_store(other, vd_load(other) - a[l]);
  }
}

DEM_INLINE void vd_push_walls(dem_push *push, const int *i, const vd f[3], const vd t[3], const vd m[3],
                              tdm_wrench *load) {
  vd a[4] = {f[0], f[1], f[2], vd_set(0)}, b[4] = {t[0], t[1], t[2], vd_set(0)}, c[4] = {m[0], m[1], m[2], vd_set(0)};
  vd_transpose4(a);
  vd_transpose4(b);
  vd_transpose4(c);
  double sum[8] = {load->force.x, load->force.y, load->force.z, 0, load->moment.x, load->moment.y, load->moment.z, 0};
  vd force = vd_load(sum), moment = vd_load(sum + 4);
  for (int l = 0; l < 4; l++) {
    double *one = &push[i[l]].force.x;
    vd_store(one, vd_load(one) + a[l]);
    vd_store(one + 4, vd_load(one + 4) + b[l]);
    force = force - a[l];
    moment = moment - c[l];
  }
  vd_store(sum, force), vd_store(sum + 4, moment);
  *load = (tdm_wrench){{sum[0], sum[1], sum[2]}, {sum[4], sum[5], sum[6]}};
}

DEM_INLINE void vd_rotor_sum(const dem_rotor *s, const int *i, const int *j, vd out[4]) {
  for (int l = 0; l < 4; l++)
    out[l] = vd_load(&s[i[l]].surface.x) + vd_load(&s[j[l]].surface.x);
  vd_transpose4(out);
}

DEM_INLINE void vd_push_pairs(dem_push *push, const int *i, const int *j, const vd f[3], const vd t[3]) {
  vd a[4] = {f[0], f[1], f[2], vd_set(0)}, b[4] = {t[0], t[1], t[2], vd_set(0)};
  vd_transpose4(a);
  vd_transpose4(b);
  for (int l = 0; l < 4; l++) {
    double *one = &push[i[l]].force.x, *other = &push[j[l]].force.x;
    vd_store(one, vd_load(one) + a[l]);
    vd_store(one + 4, vd_load(one + 4) + b[l]);
    vd_store(other, vd_load(other) - a[l]);
    vd_store(other + 4, vd_load(other + 4) + b[l]);
  }
}

#else
enum { DEM_W = 4 };
#define DEM_ISA_(name) name##_plain
typedef double vd __attribute__((vector_size(32)));
typedef long long vm __attribute__((vector_size(32)));

#define DEM_LANES(l) for (int l = 0; l < DEM_W; l++)
DEM_INLINE vd vd_set(double a) {
  return (vd){a, a, a, a};
}
DEM_INLINE vd vd_load(const double *p) {
  vd a;
  memcpy(&a, p, sizeof a);
  return a;
}
DEM_INLINE void vd_store(double *p, vd a) {
  memcpy(p, &a, sizeof a);
}
DEM_INLINE vm vm_less(vd a, vd b) {
  return a < b;
}
DEM_INLINE vm vm_equal(vd a, vd b) {
  return a == b;
}
DEM_INLINE vm vm_and(vm a, vm b) {
  return a & b;
}
DEM_INLINE vm vm_or(vm a, vm b) {
  return a | b;
}
DEM_INLINE vm vm_without(vm a, vm b) {
  return a & ~b;
}
DEM_INLINE bool vm_any(vm a) {
  return (a[0] | a[1] | a[2] | a[3]) != 0;
}
DEM_INLINE unsigned vm_bits(vm a) {
  return (unsigned)((a[0] & 1) | (a[1] & 2) | (a[2] & 4) | (a[3] & 8));
}
DEM_INLINE vm vm_first(int n) {
  return (vm){-(0 < n), -(1 < n), -(2 < n), -(3 < n)};
}
DEM_INLINE vd vd_pick(vm m, vd yes, vd no) {
  return (vd)((m & (vm)yes) | (~m & (vm)no));
}
DEM_INLINE vd vd_only(vm m, vd a) {
  return (vd)(m & (vm)a);
}
/* as the machine's: the second where they do not compare */
DEM_INLINE vd vd_max(vd a, vd b) {
  return vd_pick(a > b, a, b);
}
DEM_INLINE vd vd_min(vd a, vd b) {
  return vd_pick(a < b, a, b);
}
DEM_INLINE vd vd_abs(vd a) {
  return (vd)((vm)a & ~(vm)vd_set(-0.0));
}
DEM_INLINE vd vd_sqrt(vd a) {
  DEM_LANES(l) a[l] = sqrt(a[l]);
  return a;
}
DEM_INLINE vd vd_rint(vd a) {
  DEM_LANES(l) a[l] = rint(a[l]);
  return a;
}
DEM_INLINE vd vd_ratio_single(vd a, vd b) {
  DEM_LANES(l) a[l] = (float)a[l] / (float)b[l];
  return a;
}

DEM_INLINE void vd_sphere_difference(const dem_sphere *s, const int *i, const int *j, vd out[8]) {
  DEM_LANES(l) {
    const dem_sphere *a = &s[i[l]], *b = &s[j[l]];
    out[0][l] = a->position.x - b->position.x;
    out[1][l] = a->position.y - b->position.y;
    out[2][l] = a->position.z - b->position.z;
    out[3][l] = a->radius - b->radius;
    out[4][l] = a->velocity.x - b->velocity.x;
    out[5][l] = a->velocity.y - b->velocity.y;
    out[6][l] = a->velocity.z - b->velocity.z;
    out[7][l] = a->inverse_mass + b->inverse_mass;
  }
}

DEM_INLINE void vd_records(const double *of, const int *i, vd out[8]) {
  DEM_LANES(l) {
    const double *a = of + 8 * (size_t)i[l];
    for (int q = 0; q < 8; q++)
      out[q][l] = a[q];
  }
}

DEM_INLINE vd vd_lanes(const double *of, const int *i) {
  return (vd){of[i[0]], of[i[1]], of[i[2]], of[i[3]]};
}

DEM_INLINE vd vd_radii(const dem_sphere *s, const int *i) {
  vd a;
  DEM_LANES(l) a[l] = s[i[l]].radius;
  return a;
}

DEM_INLINE void vd_push_forces(dem_push *push, const int *i, const int *j, const vd f[3]) {
  DEM_LANES(l) {
    tdm_vec3 force = {f[0][l], f[1][l], f[2][l]};
    push[i[l]].force = tdm_add(push[i[l]].force, force);
    push[j[l]].force = tdm_sub(push[j[l]].force, force);
  }
}

DEM_INLINE void vd_push_walls(dem_push *push, const int *i, const vd f[3], const vd t[3], const vd m[3],
                              tdm_wrench *load) {
  DEM_LANES(l) {
    dem_push *one = &push[i[l]];
    tdm_vec3 force = {f[0][l], f[1][l], f[2][l]}, twist = {t[0][l], t[1][l], t[2][l]};
    one->force = tdm_add(one->force, force);
    one->twist = tdm_add(one->twist, twist);
    load->force = tdm_sub(load->force, force);
    load->moment = tdm_sub(load->moment, tdm_v3(m[0][l], m[1][l], m[2][l]));
  }
}

DEM_INLINE void vd_rotor_sum(const dem_rotor *s, const int *i, const int *j, vd out[4]) {
  DEM_LANES(l) {
    const dem_rotor *a = &s[i[l]], *b = &s[j[l]];
    out[0][l] = a->surface.x + b->surface.x;
    out[1][l] = a->surface.y + b->surface.y;
    out[2][l] = a->surface.z + b->surface.z;
    out[3][l] = a->radius + b->radius;
  }
}

DEM_INLINE void vd_push_pairs(dem_push *push, const int *i, const int *j, const vd f[3], const vd t[3]) {
  DEM_LANES(l) {
    dem_push *one = &push[i[l]], *other = &push[j[l]];
    tdm_vec3 force = {f[0][l], f[1][l], f[2][l]}, twist = {t[0][l], t[1][l], t[2][l]};
    one->force = tdm_add(one->force, force);
    one->twist = tdm_add(one->twist, twist);
    other->force = tdm_sub(other->force, force);
    other->twist = tdm_add(other->twist, twist);
  }
}
#endif

/* What the three above give:
 * vd_sphere_difference  columns dx dy dz dr dvx dvy dvz (i less j) and the sum of the inverse masses
 * vd_rotor_sum          columns of the sums of the surface velocities and of the radii
 * vd_records            columns of records of eight doubles each
 * vd_lanes              numbers of an array
 * vd_radii              of the spheres
 * vd_push_forces        as vd_push_pairs, without twist
 * vd_push_walls         particles i get force f and twist t, the wall's load -f and -m, lane after lane
 * vd_push_pairs         i gets force f and twist t, j gets -f and t, lane after lane
 * vd_ratio_single       a/b with the precision of a float, for small corrections
 */

/* columns of the records of spheres: position, radius, velocity, 1/mass */
DEM_INLINE void vd_spheres(const dem_sphere *s, const int *i, vd out[8]) {
  vd_records(&s->position.x, i, out);
}

/* ---- vectors in space, lane by lane ---- */

typedef struct {
  vd x, y, z;
} vd3;

DEM_INLINE vd3 vd3_set(tdm_vec3 a) {
  return (vd3){vd_set(a.x), vd_set(a.y), vd_set(a.z)};
}
/* m a, as tdm_m3_mul */
DEM_INLINE vd3 vd3_turn(const tdm_mat3 *m, vd3 a) {
  vd r[3];
  for (int k = 0; k < 3; k++)
    r[k] = vd_set(m->m[k][0]) * a.x + vd_set(m->m[k][1]) * a.y + vd_set(m->m[k][2]) * a.z;
  return (vd3){r[0], r[1], r[2]};
}
DEM_INLINE vd3 vd3_scale(vd s, vd3 a) {
  return (vd3){s * a.x, s * a.y, s * a.z};
}
DEM_INLINE vd3 vd3_add(vd3 a, vd3 b) {
  return (vd3){a.x + b.x, a.y + b.y, a.z + b.z};
}
DEM_INLINE vd3 vd3_sub(vd3 a, vd3 b) {
  return (vd3){a.x - b.x, a.y - b.y, a.z - b.z};
}
DEM_INLINE vd vd3_dot(vd3 a, vd3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
DEM_INLINE vd3 vd3_cross(vd3 a, vd3 b) {
  return (vd3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/* s a + b */
DEM_INLINE vd3 vd3_axpy(vd s, vd3 a, vd3 b) {
  return (vd3){s * a.x + b.x, s * a.y + b.y, s * a.z + b.z};
}
DEM_INLINE vd3 vd3_only(vm m, vd3 a) {
  return (vd3){vd_only(m, a.x), vd_only(m, a.y), vd_only(m, a.z)};
}
DEM_INLINE vd3 vd3_pick(vm m, vd3 a, vd3 b) {
  return (vd3){vd_pick(m, a.x, b.x), vd_pick(m, a.y, b.y), vd_pick(m, a.z, b.z)};
}

#endif
