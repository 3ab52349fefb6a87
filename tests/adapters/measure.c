/* Numbers of runs with other codes, against the scenarios' theory:
 *
 *   measure spring_damper DIR   nse of position and velocity of the box (scenarios/spring_damper)
 *   measure collision DIR MASS  errors of the velocities of particle and cube [%], restitution, momentum
 *                               (scenarios/collision)
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/collision/collision.h"
#include "scenarios/table.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static tdm_status spring_damper(const char *dir, tdm_error *err) {
  cpl_comparison c = {0};
  if (scn_spring_damper_compare(dir, &c, err) == TDM_OK)
    printf("%.6f %.6f\n", cpl_comparison_nse(&c, &c.curve[0]), cpl_comparison_nse(&c, &c.curve[1]));
  cpl_comparison_free(&c);
  return err->status;
}

static tdm_status collision(const char *dir, double mass, tdm_error *err) {
  scn_collision_errors e;
  if (scn_collision_read(dir, mass, &e, err) == TDM_OK)
    printf("%.4f %.4f %.5f %.5f\n", e.particle, e.body, e.restitution, e.momentum);
  return err->status;
}

int main(int argc, char **argv) {
  tdm_error err = {0};
  if (argc == 3 && strcmp(argv[1], "spring_damper") == 0)
    spring_damper(argv[2], &err);
  else if (argc == 4 && strcmp(argv[1], "collision") == 0)
    collision(argv[2], atof(argv[3]), &err);
  else
    tdm_fail(&err, TDM_ERR_ARGUMENT, NULL, "usage: measure spring_damper DIR | collision DIR MASS");
  if (err.status != TDM_OK)
    fprintf(stderr, "measure: %s\n", err.message);
  return err.status != TDM_OK;
}
