/* tandem-mbd: the solver process of a co-simulation, and the command line of scenes of bodies alone. */
#include "mbd/run.h"

int main(int argc, char **argv) {
  return tdm_alone_main(&mbd_program, argc, argv);
}
