/* Settling: see settle.h. */
#include "dem/settle.h"

#include "dem/check.h"
#include "dem/limits.h"
#include "dem/step.h"

static double fastest(const dem_data *d) {
  double v2 = 0;
  for (int i = 0; i < d->model->nparticle; i++)
    v2 = fmax(v2, tdm_dot(d->velocity[i], d->velocity[i]));
  return sqrt(v2);
}

/* take a share of all velocities away: nothing else stops a sphere that rolls in a hollow */
static void drag(dem_data *d, double share) {
  for (int i = 0; i < d->model->nparticle; i++) {
    d->velocity[i] = tdm_scale(1 - share, d->velocity[i]);
    d->spin[i] = tdm_scale(1 - share, d->spin[i]);
  }
}

/* step until the bed was slow for `quiet` seconds, or max_time */
static tdm_status run(dem_data *d, double quiet, tdm_participant *p, dem_settled *out, tdm_error *err) {
  const dem_settling *settle = &d->model->settle;
  uint64_t slow = 0, most = (uint64_t)fmin(ceil(settle->max_time / out->dt), 1e15);
  for (uint64_t k = 1; k <= most; k++) {
    if (!dem_step(d, NULL, 0, 1, true, out->dt))
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the neighbour lists while settling");
    drag(d, settle->drag * out->dt);
    if (k % 256 == 0 && p && tdm_participant_alive(p))
      return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted while settling");
    if (k % 1024 == 0 && dem_check_finite(d, (double)k * out->dt, err))
      return err->status;
    out->time = (double)k * out->dt;
    out->speed = fastest(d);
    slow = out->speed < settle->speed ? slow + 1 : 0;
    out->rest = (double)slow * out->dt >= quiet;
    if (out->rest)
      break;
  }
  return dem_check_finite(d, out->time, err);
}

tdm_status dem_settle(dem_data *d, tdm_participant *p, dem_settled *out, tdm_error *err) {
  const dem_model *m = d->model;
  *out = (dem_settled){.rest = true};
  if (m->nparticle == 0)
    return TDM_OK;
  dem_limits limits = dem_limits_now(d);
  out->dt = m->settle.dt > 0 ? m->settle.dt : fmin(0.2 * limits.rayleigh, limits.contact / 30);
  double g = tdm_norm(m->gravity), quiet = 50 * out->dt;
  quiet = fmax(quiet, isfinite(limits.contact) ? 2 * limits.contact : 0);
  quiet = fmax(quiet, g > 0 ? 20 * m->settle.speed / g : 0);

  /* the bodies are held: at rest while settling */
  for (int b = 0; b < m->nbody; b++)
    d->twist[b] = d->twist_mid[b] = (tdm_twist){0};
  if (run(d, quiet, p, out, err))
    return err->status;
  for (int i = 0; i < m->nparticle; i++)
    d->velocity[i] = d->spin[i] = tdm_v3(0, 0, 0);
  for (int b = 0; b < m->nbody; b++)
    d->twist[b] = d->twist_mid[b] = m->body[b].start.twist;
  d->nstep = 0;
  if (!dem_forces_now(d, false))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the neighbour lists");
  return TDM_OK;
}
