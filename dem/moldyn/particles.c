/* Particle files of MOLDYN: see particles.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/moldyn/particles.h"

#include "dem/moldyn/text.h"

#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 14, COUNT_MAX = 20000000 };

static const char *const columns[COLUMNS] = {"x",     "y",     "z",       "v_x",     "v_y",     "v_z",    "phi_x",
                                             "phi_y", "phi_z", "omega_x", "omega_y", "omega_z", "radius", "flag"};

/* the number of particles, in the first row */
static int read_count(dem_text *t) {
  if (!dem_text_row(t)) {
    dem_text_fail(t, t->line + 1, "holds nothing; begin with the number of particles");
    return 0;
  }
  double count = t->nfield == 1 ? dem_text_number(t, 0, "number of particles") : NAN;
  if (!(count >= 0 && count <= COUNT_MAX && count == floor(count)))
    dem_text_fail(t, t->line,
                  "the first row of a particle file is the number of particles alone, a whole number up to %d",
                  COUNT_MAX);
  return t->err->status ? 0 : (int)count;
}

static tdm_quat turned(double about_x, double about_y, double about_z) {
  tdm_quat q = tdm_quat_mul(tdm_quat_from_rotvec(tdm_v3(about_x, 0, 0)), tdm_quat_from_rotvec(tdm_v3(0, about_y, 0)));
  return tdm_quat_mul(q, tdm_quat_from_rotvec(tdm_v3(0, 0, about_z)));
}

static void read_row(dem_text *t, dem_pin_particle *p) {
  double v[COLUMNS];
  if (t->nfield != COLUMNS) {
    dem_text_fail(t, t->line,
                  "a particle has %d numbers, this row %d; give x y z v_x v_y v_z phi_x phi_y phi_z omega_x omega_y "
                  "omega_z radius flag",
                  COLUMNS, t->nfield);
    return;
  }
  for (int k = 0; k < COLUMNS; k++)
    v[k] = dem_text_number(t, k, columns[k]);
  if (t->err->status)
    return;
  *p = (dem_pin_particle){.position = {v[0], v[1], v[2]},
                          .velocity = {v[3], v[4], v[5]},
                          .orientation = turned(v[6], v[7], v[8]),
                          .spin = {v[9], v[10], v[11]},
                          .radius = v[12],
                          .moves = v[13] == 1};
  if (!(p->radius > 0))
    dem_text_fail(t, t->line, "the radius (field 13) is %g m but must be greater than 0", p->radius);
  if (v[13] != 0 && v[13] != 1)
    dem_text_fail(t, t->line, "the flag (field 14) is %g; give 1 for a particle that moves, 0 for one that never does",
                  v[13]);
  if (!p->moves && (tdm_norm(p->velocity) > 0 || tdm_norm(p->spin) > 0))
    dem_text_fail(
        t, t->line,
        "the particle never moves (field 14 is 0) but has a velocity; set fields 4 to 6 and 10 to 12 to 0, or "
        "the flag to 1");
}

tdm_status dem_pin_read(dem_pin *pin, const char *file, const char *path, tdm_error *err) {
  dem_text t;
  *pin = (dem_pin){0};
  if (dem_text_open(&t, file, path, err))
    return err->status;
  int count = read_count(&t);
  long first = t.line;
  pin->particle = calloc((size_t)count + 1, sizeof *pin->particle);
  if (!pin->particle)
    tdm_fail(err, TDM_ERR_MEMORY, path, "%s: no memory for %d particles", file, count);
  while (dem_text_row(&t)) {
    if (pin->count == count)
      dem_text_fail(&t, t.line, "is a particle too many: line %ld says %d; correct that number, or remove the row",
                    first, count);
    else
      read_row(&t, &pin->particle[pin->count++]);
  }
  if (pin->count < count)
    dem_text_fail(&t, first, "says %d particles, but the file has %d; correct the number, or add the rows", count,
                  pin->count);
  dem_text_close(&t);
  return err->status;
}

void dem_pin_free(dem_pin *pin) {
  free(pin->particle);
  *pin = (dem_pin){0};
}
