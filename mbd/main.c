/* tandem-mbd: the solver process of a co-simulation, and the command line of scenes of bodies alone. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/app/import.h"
#include "mbd/app/run.h"

#include <string.h>

int main(int argc, char **argv) {
  if (argc > 1 && strcmp(argv[1], "import") == 0)
    return mbd_import_main(argc - 2, argv + 2);
  return tdm_standalone_main(&mbd_program, argc, argv);
}
