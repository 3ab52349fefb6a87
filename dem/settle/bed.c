/* Storing settled beds: see bed.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/settle/bed.h"

#include "dem/seam/homes.h"
#include "dem/store/state_file.h"

#include <errno.h>
#include <libgen.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const char key[] = "dem.settle.store";

/* dem_settled in the file */
typedef struct {
  uint64_t rest, pressed;
  double dt, time, speed;
} figures;

tdm_status dem_bed_read(dem_data *d, dem_settled *out, bool *found, tdm_error *err) {
  const char *name = d->model->settle.store;
  *found = access(name, F_OK) == 0 || errno != ENOENT;
  *found = !dem_homes_any(d, !*found); /* on every rank */
  figures f = {0};
  if (!*found || dem_state_read(d, DEM_STATE_BED, name, key, &f, sizeof f, err))
    return err->status;
  *out = (dem_settled){
      .rest = f.rest != 0, .pressed = f.pressed != 0, .stored = true, .dt = f.dt, .time = f.time, .speed = f.speed};
  return TDM_OK;
}

tdm_status dem_bed_check_writable(const dem_model *m, tdm_error *err) {
  char copy[4096];
  snprintf(copy, sizeof copy, "%s", m->settle.store);
  const char *folder = dirname(copy);
  if (access(folder, W_OK) != 0)
    return tdm_fail(err, TDM_ERR_FILE, key,
                    "\"%s\" cannot be written: folder \"%s\": %s; make the folder or name another one", m->settle.store,
                    folder, strerror(errno));
  return TDM_OK;
}

tdm_status dem_bed_write(dem_data *d, const dem_settled *settled, tdm_error *err) {
  const figures f = {settled->rest, settled->pressed, settled->dt, settled->time, settled->speed};
  dem_collect(d, DEM_WHOLE);
  if (dem_homes_writes(d))
    dem_state_write(d, d->model->settle.store, key, &f, sizeof f, err);
  if (dem_homes_any(d, err->status) && !err->status)
    tdm_fail(err, TDM_ERR_FILE, key, "\"%s\" could not be written by rank 0", d->model->settle.store);
  return err->status;
}
