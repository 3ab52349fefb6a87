/* Whether to look for a message for a while before sleeping.
 *
 * Windows are short, and waking a thread may cost more than the exchange: looking first pays where the partner answers
 * soon and has a processor of its own. On a busy processor it costs: each look hands the processor to whoever else
 * wants it, for a slice of milliseconds, while a thread that sleeps is woken as soon as its message comes. So a look
 * that did not pay (nothing came, or others ran meanwhile) is followed by 1, 2, 4, ... TDM_SLEEPS_MAX waits without
 * one; one that paid makes the next wait look again.
 */
/* SPDX-License-Identifier: MIT */
#ifndef TDM_WIRE_PATIENCE_H
#define TDM_WIRE_PATIENCE_H

#include <stdbool.h>

enum { TDM_SLEEPS_MAX = 1024 };

/* zero: looks at first */
typedef struct {
  int sleeps; /* waits that sleep at once, before the next that looks */
  int lesson; /* so many were set the last time; 0: the last look paid */
} tdm_patience;

/* Before a wait: look first? */
static inline bool tdm_patience_looks(tdm_patience *p) {
  if (p->sleeps == 0)
    return true;
  p->sleeps--;
  return false;
}

/* After a look. */
static inline void tdm_patience_learn(tdm_patience *p, bool paid) {
  p->lesson = paid ? 0 : p->lesson == 0 ? 1 : p->lesson < TDM_SLEEPS_MAX ? 2 * p->lesson : TDM_SLEEPS_MAX;
  p->sleeps = p->lesson;
}

#endif
