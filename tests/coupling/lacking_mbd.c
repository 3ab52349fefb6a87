/* tandem-mbd as it would be without the capability LACKS of the environment (matched_load: it takes no more than three
 * coefficients of a load): a foreign solver may be so. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/adapter/solver.h"

#include <stdlib.h>
#include <string.h>

int main(int argc, char **argv) {
  const char *capability[16];
  const char *lacks = getenv("LACKS") ? getenv("LACKS") : "matched_load";
  tdm_solver_ops ops = mbd_solver_ops;
  ops.ncapability = 0;
  for (int i = 0; i < mbd_solver_ops.ncapability && i < 16; i++)
    if (strcmp(mbd_solver_ops.capabilities[i], lacks) != 0)
      capability[ops.ncapability++] = mbd_solver_ops.capabilities[i];
  ops.capabilities = capability;
  return tdm_solver_main(&ops, argc, argv);
}
