/* Numbers of runs with other codes, against the scenarios' theory:
 *
 *   measure spring_damper DIR   nse of position and velocity of the box (scenarios/spring_damper)
 *   measure collision DIR MASS  errors of the velocities of particle and cube [%], restitution, momentum
 *                               (scenarios/collision)
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/results/table.h"
#include "scenarios/collision/collision.h"
#include "scenarios/spring_damper/reference.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static tdm_status spring_damper(const char *dir, tdm_error *err) {
  static const scn_spring_damper_parameters theory = {
      .mass = 361.8, .damping = 500, .stiffness = 5000, .preload = 100, .gravity = 9.81}; /* scene.json */
  char file[4096];
  cpl_table body = {0};
  snprintf(file, sizeof file, "%s/body_box.csv", dir);
  cpl_table_read(&body, file, err);
  const double *t = err->status ? NULL : cpl_table_column(&body, "time", err);
  const double *z = t ? cpl_table_column(&body, "z", err) : NULL, *vz = z ? cpl_table_column(&body, "vz", err) : NULL;
  double *curve = vz ? calloc(4 * (size_t)body.nrow, sizeof *curve) : NULL;
  if (vz && !curve)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  if (curve) {
    double *x = curve, *v = x + body.nrow, *exact_x = v + body.nrow, *exact_v = exact_x + body.nrow;
    for (int i = 0; i < body.nrow; i++) {
      x[i] = -z[i]; /* downward */
      v[i] = -vz[i];
      scn_spring_damper_exact(&theory, t[i], &exact_x[i], &exact_v[i]);
    }
    printf("%.6f %.6f\n", cpl_nse(x, exact_x, body.nrow), cpl_nse(v, exact_v, body.nrow));
  }
  free(curve);
  cpl_table_free(&body);
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
