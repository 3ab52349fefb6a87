/* tandem-mbd: the solver process of a co-simulation, and the command line of scenes of bodies alone. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/app/run.h"

#include <gsl/gsl_errno.h>

int main(int argc, char **argv) {
  gsl_set_error_handler_off(); /* GSL's own aborts */
  return tdm_standalone_main(&mbd_program, argc, argv);
}
