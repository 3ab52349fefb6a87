/* What an integrator does, and the table of formulations that a scene may choose: see integrator.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/integrate/integrator.h"

#include <stdio.h>

const mbd_formulation mbd_formulation_table[MBD_FORMULATIONS] = {
    [MBD_GGL] = {.name = "ggl", .integrator = &mbd_ida},
    [MBD_INDEX3] = {.name = "index3", .integrator = &mbd_ida},
    [MBD_ONE_STEP] = {.name = "one_step", .integrator = &mbd_one_step},
};

void mbd_advise(const mbd_model *m, char *out, size_t size) {
  const mbd_settings *s = &m->solver;
  const double finest = mbd_model_finest(m);
  char absolute[128] = "";
  if (s->absolute_tolerance < finest)
    snprintf(
        absolute, sizeof absolute,
        "a larger mbd.solver.absolute_tolerance (%.3g is below what rounding leaves of the positions: take %.1g), ",
        s->absolute_tolerance, finest);
  snprintf(out, size,
           "A load or a force jumped or grew without bound, or the mechanism is in or near a singular position: try "
           "%s%s%s%smbd.formulation \"one_step\"%s",
           s->max_step > 0 ? "a larger mbd.solver.max_step, " : "", absolute,
           s->modified ? "" : "mbd.corrector \"modified\", ",
           s->relative_tolerance < 1e-4 ? "a larger mbd.solver.relative_tolerance, " : "",
           m->ncoupled > 0 ? ", or shorter windows" : "");
}
