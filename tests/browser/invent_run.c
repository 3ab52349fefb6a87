/* invent_run DIR PARTICLES FRAMES: a result directory to try the viewer on. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tests/browser/invented.h"

#include <stdlib.h>

int main(int argc, char **argv) {
  tdm_error err = {0};
  if (argc != 4) {
    fputs("usage: invent_run DIR PARTICLES FRAMES\n", stderr);
    return 2;
  }
  if (invented_run(argv[1], atoi(argv[2]), atoi(argv[3]), &err) != TDM_OK)
    fprintf(stderr, "invent_run: %s\n", err.message);
  return err.status != TDM_OK;
}
