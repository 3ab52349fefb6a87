/* GSL's errors. Its default is to abort the process where memory runs out or an argument is wrong.
 *
 * Every engine's create calls this once, so that GSL's functions return a status or NULL, which their callers check;
 * memory that runs out is noted (memory.h).
 * The handler is the process's own: a program that wants another one sets it after the create.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_MATH_GSL_ERRORS_H
#define TDM_MATH_GSL_ERRORS_H

#include "protocol/base/memory.h"

#include <gsl/gsl_errno.h>

/* also where GSL's own functions go on without what they wanted */
static inline void tdm_gsl_note(const char *reason, const char *file, int line, int gsl_errno) {
  (void)reason;
  (void)file;
  (void)line;
  if (gsl_errno == GSL_ENOMEM)
    tdm_memory_note();
}

static inline void tdm_gsl_return_errors(void) {
  gsl_set_error_handler(tdm_gsl_note);
}

#endif
