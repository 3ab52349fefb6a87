/* tandem-mbd: the solver process of a co-simulation, and the command line of scenes of bodies alone. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/app/run.h"

int main(int argc, char **argv) {
  return tdm_standalone_main(&mbd_program, argc, argv);
}
