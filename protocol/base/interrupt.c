/* Signals that ask a program to end: see interrupt.h. */
/* SPDX-License-Identifier: MIT */
#include "protocol/base/interrupt.h"

volatile sig_atomic_t tdm_interrupted, tdm_signal_count;
