/* tandem-draw: pictures of a run, while it goes on (--orders, see drawer.c) or afterwards (tandem draw, tandem movie).
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/draw/program/after.h"
#include "protocol/draw/program/orders.h"

#include "protocol/app/command_line.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int argc, char **argv) {
  tdm_error err = {0};
  setenv("LP_NUM_THREADS", "1", 0); /* OSMesa's own threads would take the processors that the run is on */
  if (argc == 2 && strcmp(argv[1], "--orders") == 0)
    return draw_orders(stdin);
  if (argc > 1 && strcmp(argv[1], "draw") == 0)
    draw_again(argc - 2, argv + 2, &err);
  else if (argc > 1 && strcmp(argv[1], "movie") == 0)
    draw_movie(argc - 2, argv + 2, &err);
  else
    tdm_fail(&err, TDM_ERR_ARGUMENT, NULL, "tandem-draw belongs to tandem: see tandem --help, draw and movie");
  return tdm_finish("tandem", &err);
}
