/* The solver process tandem-dem. */
#include "dem/solver.h"

int main(int argc, char **argv) {
  return tdm_solver_main(&dem_solver_ops, argc, argv);
}
