/* Random numbers, the same on all machines. Those of a run have no generator: each is a function of what it is for, so
 * a copy of the data needs no state. */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_MATH_RANDOM_H
#define TDM_MATH_RANDOM_H

#include <stdint.h>

/* SplitMix64's mixing function (Steele, Lea & Flood 2014) */
static inline uint64_t tdm_random_mix(uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/* A number in [0, 1) that depends on its arguments alone. */
static inline double tdm_random(uint64_t seed, uint64_t item, uint64_t draw) {
  const uint64_t golden = 0x9e3779b97f4a7c15u;
  uint64_t z = tdm_random_mix(seed + golden);
  z = tdm_random_mix(z + golden * (item + 1));
  z = tdm_random_mix(z + golden * (draw + 1));
  return (double)(z >> 11) * 0x1p-53;
}

/* The next number in [0, 1) of the sequence SplitMix64, for tests and benchmarks; its state may begin as anything. */
static inline double tdm_random_next(uint64_t *state) {
  *state += 0x9e3779b97f4a7c15u;
  return (double)(tdm_random_mix(*state) >> 11) * 0x1p-53;
}

#endif
