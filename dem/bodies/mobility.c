/* Setting the mobility of a body: see mobility.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/bodies/mobility.h"

#include "dem/state/data.h"

#include <assert.h>

void dem_set_body_mobility(dem_data *d, int coupled, const double Y[36]) {
  const dem_model *m = d->model;
  assert(coupled >= 0 && coupled < m->ncoupled);
  if (m->wall_mass > 0)
    return;
  int b = m->coupled_body[coupled];
  dem_mobility *y = &d->state.mobility[b];
  y->full = false;
  for (int i = 0; i < 3; i++)
    for (int j = 0; j < 3; j++) {
      y->vv.m[i][j] = Y[6 * i + j];
      y->wv.m[i][j] = Y[6 * (3 + i) + j];
      y->ww.m[i][j] = Y[6 * (3 + i) + 3 + j];
      y->full = y->full || y->vv.m[i][j] != 0 || y->wv.m[i][j] != 0 || y->ww.m[i][j] != 0;
    }
  y->per_mass = y->full ? 1 / m->body[b].mass : 0;
}
