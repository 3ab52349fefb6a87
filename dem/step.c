/* One DEM step: see step.h. */
#include "dem/step.h"

#include "dem/geometry/walls.h"
#include "dem/integrate.h"
#include "dem/search/pairs.h"

/* add up the forces on particles (zeroed before) and bodies */
static void evaluate(dem_data *d, bool settling, double dt) {
  d->ncontact = 0;
  for (int b = 0; b < d->model->nbody; b++)
    d->body_load[b] = (tdm_wrench){0};
  d->model->law->pairs(d->model, d, settling, dt);
  d->model->law->walls(d->model, d, settling, dt);
}

bool dem_step(dem_data *d, const dem_motion *motion, uint64_t k, uint64_t n, bool settling, double dt) {
  if (motion)
    dem_bodies_move(d, motion, k, n);
  double moved2 = dem_kick_drift(d, dt, dem_lists_shift(d));
  if (!dem_lists_update(d, moved2))
    return false;
  evaluate(d, settling, dt);
  dem_kick(d, dt);
  d->nstep++;
  return true;
}

bool dem_forces_now(dem_data *d, bool settling) {
  for (int i = 0; i < d->nparticle; i++) {
    d->velocity_ahead[i] = d->velocity[i];
    d->spin_ahead[i] = d->spin[i];
    d->force[i] = d->torque[i] = tdm_v3(0, 0, 0);
  }
  dem_walls_put(d);
  if (!dem_lists_build(d))
    return false;
  evaluate(d, settling, 0);
  return true;
}
