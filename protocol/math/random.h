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

/* Where item k of n comes when they are mixed: below n, another place for each k < n, by the seed alone. A Feistel
 * network on the fewest bits, an even number, that hold n - 1, gone through until it comes out below n. n > 0, below
 * 2^62. */
static inline uint64_t tdm_random_place(uint64_t seed, uint64_t k, uint64_t n) {
  const uint64_t golden = 0x9e3779b97f4a7c15u;
  int half = 1;
  while ((n - 1) >> (2 * half))
    half++;
  const uint64_t mask = ((uint64_t)1 << half) - 1;
  do {
    for (uint64_t round = 1; round <= 8; round++) {
      uint64_t low = k & mask, key = tdm_random_mix(seed + golden * round);
      k = low << half | (((k >> half) ^ tdm_random_mix(key + golden * (low + 1))) & mask);
    }
  } while (k >= n);
  return k;
}

/* The next number in [0, 1) of the sequence SplitMix64, for tests and benchmarks; its state may begin as anything. */
static inline double tdm_random_next(uint64_t *state) {
  *state += 0x9e3779b97f4a7c15u;
  return (double)(tdm_random_mix(*state) >> 11) * 0x1p-53;
}

#endif
