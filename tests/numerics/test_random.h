/* Random numbers for tests, the same in every run. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_RANDOM_H
#define TEST_RANDOM_H

#include "protocol/math/random.h"

/* What the numbers that follow depend on. */
static uint64_t random_state;

/* uniform in [0, 1) */
static inline double uniform(void) {
  return tdm_random_next(&random_state);
}

/* uniform from low to high */
static inline double between(double low, double high) {
  return low + (high - low) * uniform();
}

#endif
