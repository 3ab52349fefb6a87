/* What channels are called where people read them: "wx" of a body is "angular velocity", its component x. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_CONTENTS_WORDS_H
#define CPL_CONTENTS_WORDS_H

#include <stdbool.h>

typedef struct {
  char quantity[96];  /* "angular velocity" */
  char component[96]; /* "x", or what tells a scalar from others of its quantity: "kinetic" */
  bool vector;
  bool shared; /* a scalar whose panel has others of its quantity */
} cpl_words;

/* `name`: a channel's name without what it belongs to: "wx", "com.z", "drift_angle". */
cpl_words cpl_words_of(const char *name, const char *unit);

/* A unit as people write it, into out (size bytes): "m/s2" becomes "m/s²". Returns out. */
const char *cpl_words_unit(const char *unit, char *out, unsigned size);

#endif
