/* tandem-mbd: the multibody solver as a process. */
#include "mbd/solver.h"

int main(int argc, char **argv) {
  return tdm_solver_main(&mbd_solver_ops, argc, argv);
}
