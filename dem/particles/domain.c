/* The box dem.domain: see domain.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/particles/domain.h"

#include "dem/model/integrator.h"
#include "dem/particles/field.h"
#include "dem/seam/homes.h"

void dem_domain_put(dem_data *d) {
  const dem_domain_def *box = &d->model->domain;
  double t = d->state.strained + (double)d->state.strain_steps * d->state.strain_dt;
  for (int a = 0; a < 3; a++) {
    double length = box->length[a] * (1 + box->rate[a] * t);
    d->state.domain.periodic[a] = box->periodic[a];
    d->state.domain.length[a] = length;
    d->state.domain.low[a] = box->low[a] - 0.5 * (length - box->length[a]);
    d->state.domain_rate[a] = box->length[a] * box->rate[a];
  }
}

void dem_domain_strain(dem_data *d, double dt) {
  if (dt != d->state.strain_dt) {
    d->state.strained += (double)d->state.strain_steps * d->state.strain_dt;
    d->state.strain_steps = 0;
    d->state.strain_dt = dt;
  }
  d->state.strain_steps++;
  dem_domain_put(d);
}

/* what a box that repeats puts into particle i when it goes on at the other side: potential and kinetic energy */
static double shift_energy(const dem_data *d, int i, int axis, double way, double speed) {
  tdm_vec3 field = dem_field(d, i);
  return d->state.mass[i] * (speed * ((&d->state.pace[i].velocity.x)[axis] + 0.5 * speed) - (&field.x)[axis] * way);
}

/* particle i, k boxes up along an axis; returns what that puts into it, if energies are counted [J] */
static double shift(dem_data *d, int i, int axis, double k) {
  double way = k * d->state.domain.length[axis], speed = k * d->state.domain_rate[axis];
  const double energy = d->model->energy ? shift_energy(d, i, axis, way, speed) : 0;
  (&d->state.sphere[i].position.x)[axis] += way;
  (&d->state.sphere[i].velocity.x)[axis] += speed;
  (&d->state.pace[i].velocity.x)[axis] += speed;
  (&d->lists.position_at_list[i].x)[axis] += way;
  dem_keeping keeps = d->model->integrator->keeps;
  if (keeps == DEM_KEEPS_VELOCITY)
    (&d->state.memory[i].velocity.x)[axis] += speed;
  if (keeps == DEM_KEEPS_PLACE)
    (&d->state.memory[i].velocity.x)[axis] += way - speed * d->state.memory_dt;
  return energy;
}

/* particles first ... end - 1; returns what that puts into them */
static double wrap(dem_data *d, int first, int end) {
  double energy = 0;
  for (int a = 0; a < 3; a++) {
    double low = d->state.domain.low[a], high = low + d->state.domain.length[a];
    for (int i = first; d->state.domain.periodic[a] && i < end; i++) {
      double x = (&d->state.sphere[i].position.x)[a];
      if (x >= low && x < high)
        continue;
      energy += shift(d, i, a, -floor((x - low) / d->state.domain.length[a]));
      double *now = &(&d->state.sphere[i].position.x)[a]; /* round-off may have put it on the far face */
      if (*now >= high)
        *now = low;
    }
  }
  return energy;
}

void dem_domain_begin(dem_data *d, int first, int end) {
  d->state.strained = d->state.strain_dt = 0;
  d->state.strain_steps = 0;
  dem_domain_put(d);
  if (d->model->domain.repeats)
    wrap(d, first, end);
}

static void wrap_chunk(dem_data *d, int c, void *supplied) {
  ((double *)supplied)[c] = wrap(d, dem_chunk_start(d, c), dem_chunk_start(d, c + 1));
}

void dem_domain_wrap(dem_data *d) {
  double *supplied = d->work.chunk_supplied;
  dem_each_chunk(d, wrap_chunk, supplied);
  if (!d->model->energy)
    return;
  dem_unite_chunks(d, supplied, sizeof *supplied);
  for (int c = 0; c < d->lists.nchunk; c++)
    d->state.energy.supplied += supplied[c];
}
