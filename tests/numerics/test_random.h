/* Random numbers for tests, the same in every run. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_RANDOM_H
#define TEST_RANDOM_H

#include "protocol/math/random.h"

/* What the numbers that follow depend on. */
static uint64_t random_state;

/* uniform in [0, 1) */
static inline double uniform(void) {
  random_state += 0x9e3779b97f4a7c15u;
  return (double)(tdm_random_mix(random_state) >> 11) * 0x1p-53;
}

/* uniform from low to high */
static inline double between(double low, double high) {
  return low + (high - low) * uniform();
}

#endif
