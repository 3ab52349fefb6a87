/* The harmonic law x = mean + amplitude sin(omega t + phase), for who has its numbers already. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_MOTION_HARMONIC_H
#define TDM_MOTION_HARMONIC_H

#include "protocol/motion/motion.h"

typedef struct {
  double mean, amplitude; /* [rad], [m] or [1] */
  double omega;           /* [rad/s] */
  double phase;           /* [rad] */
} tdm_harmonic;

tdm_motion_value tdm_harmonic_at(const tdm_harmonic *harmonic, double t);

#endif
