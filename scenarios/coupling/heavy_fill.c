/* A fill 20 times as heavy as its box, on the spring and damper: which windows each scheme bears. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/coupling/cell.h"
#include "scenarios/table.h"

#include <stdio.h>

static const double box_mass = 261.8 / 20, end = 2; /* [kg], [s] */

static const scn_cell cells[] = {
    {.scheme = "proxy", .dt = "1e-4", .n = 20, .least_nse = 0.999},
    {.scheme = "proxy", .dt = "1e-4", .n = 100, .least_nse = 0.999},
    {.scheme = "iterative", .dt = "1e-4", .n = 100, .least_nse = 0.999},
    {.scheme = "lommen", .dt = "1e-4", .n = 20},
};
enum { NCELL = sizeof cells / sizeof cells[0] };

tdm_status scn_coupling_heavy_fill(cpl_verify *v, tdm_error *err) {
  static const char *const state[] = {"x", "v"};
  cpl_verify_case run[NCELL];
  tdm_error first = {0};
  for (int i = 0; i < NCELL; i++) {
    scn_cell_prepare(&cells[i], "spring_damper", &run[i]);
    cpl_verify_case_set(&run[i], "mbd.bodies[0].mass=%.10g", box_mass);
    cpl_verify_case_set(&run[i], "time.end=%g", end);
  }
  if (cpl_verify_run_many(v, NCELL, run, 0, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < NCELL; i++) {
    tdm_error own = {0};
    scn_cell cell = cells[i];
    if (scn_cell_judge(&cell, &run[i], scn_spring_damper_compare, &own) == TDM_OK)
      scn_cell_measure(v, &cell, &run[i], state, "F");
    else
      tdm_fail(&first, own.status, NULL, "%.100s: %.800s", run[i].name, own.message);
  }
  *err = first;
  return err->status;
}
