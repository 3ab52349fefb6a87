/* GSL's errors. Its default is to abort the process where memory runs out or an argument is wrong.
 *
 * Every engine's create calls this once, so that GSL's functions return a status or NULL, which their callers check.
 * The handler is the process's own: a program that wants another one sets it after the create.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_MATH_GSL_ERRORS_H
#define TDM_MATH_GSL_ERRORS_H

#include <gsl/gsl_errno.h>

static inline void tdm_gsl_return_errors(void) {
  gsl_set_error_handler_off();
}

#endif
