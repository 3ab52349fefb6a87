/* One DEM step: see step.h. */
#include "dem/step.h"

#include "dem/geometry/walls.h"
#include "dem/integrate.h"
#include "dem/search/pairs.h"

/* every chunk on its own, on the threads there are */
#define EACH_CHUNK _Pragma("omp parallel for schedule(static) num_threads(d->nthread) if (d->nthread > 1)")

static double begin_step(dem_data *d, double dt) {
  tdm_vec3 shift = dem_lists_shift(d);
  const dem_integrator *integrator = d->model->integrator;
  double moved2 = 0;
  bool numbers = true;
#pragma omp parallel for schedule(static) num_threads(d->nthread) if (d->nthread > 1) reduction(max : moved2) reduction(&& : numbers)
  for (int c = 0; c < d->nchunk; c++) {
    double r2 = integrator->begin(d, c, dt, shift);
    numbers = numbers && r2 >= 0;
    moved2 = r2 > moved2 ? r2 : moved2;
  }
  return numbers ? moved2 : NAN;
}

/* add up the forces on particles (zeroed before) and bodies */
static void evaluate(dem_data *d, bool settling, double dt) {
  const dem_model *m = d->model;
  long touching = 0;
#pragma omp parallel for schedule(static) num_threads(d->nthread) if (d->nthread > 1) reduction(+ : touching)
  for (int c = 0; c < d->nchunk; c++) {
    for (int b = 0; b < m->nbody; b++)
      d->chunk_load[c * m->nbody + b] = (tdm_wrench){0};
    dem_loop_task task = {.model = m, .data = d, .chunk = c, .settling = settling, .dt = dt};
    m->law->pairs(&task);
    m->law->walls(&task);
    touching += task.touching;
  }
  d->ncontact = touching;
  for (int b = 0; b < m->nbody; b++) {
    tdm_wrench sum = {0};
    for (int c = 0; c < d->nchunk; c++) {
      sum.force = tdm_add(sum.force, d->chunk_load[c * m->nbody + b].force);
      sum.moment = tdm_add(sum.moment, d->chunk_load[c * m->nbody + b].moment);
    }
    d->body_load[b] = sum;
  }
}

static void end_step(dem_data *d, double dt) {
  const dem_integrator *integrator = d->model->integrator;
  EACH_CHUNK
  for (int c = 0; c < d->nchunk; c++)
    integrator->end(d, c, dt);
}

bool dem_step(dem_data *d, const dem_motion *motion, uint64_t k, uint64_t n, bool settling, double dt) {
  if (motion)
    dem_bodies_move(d, motion, k, n);
  double moved2 = begin_step(d, dt);
  if (!dem_lists_update(d, moved2))
    return false;
  evaluate(d, settling, dt);
  end_step(d, dt);
  d->nstep++;
  d->since_sort++;
  d->since_list++;
  return true;
}

void dem_forces_again(dem_data *d, bool settling, double dt) {
  for (int i = 0; i < d->nparticle; i++) {
    d->sphere[i].velocity = d->pace[i].velocity;
    d->rotor[i].surface = tdm_scale(d->sphere[i].radius, d->pace[i].spin);
    d->push[i] = (dem_push){0};
  }
  evaluate(d, settling, dt);
  end_step(d, 0);
}

bool dem_forces_now(dem_data *d, bool settling) {
  dem_walls_put(d);
  if (!dem_lists_build(d))
    return false;
  dem_forces_again(d, settling, 0);
  return true;
}
