/* Settling: see settle.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/settle/settle.h"

#include "dem/bodies/walls.h"
#include "dem/seam/homes.h"
#include "dem/settle/bed.h"
#include "dem/settle/pour.h"
#include "dem/step/step.h"
#include "dem/watch/check.h"
#include "dem/watch/limits.h"

/* share: a double; the square of the largest speed that is left goes to chunk_sum */
static void drag_chunk(dem_data *d, int chunk, void *share) {
  const double keep = 1 - *(const double *)share;
  double v2 = 0;
  for (int i = dem_chunk_start(d, chunk), end = dem_chunk_start(d, chunk + 1); i < end; i++) {
    dem_pace *p = &d->state.pace[i];
    p->velocity = tdm_scale(keep, p->velocity);
    p->spin = tdm_scale(keep, p->spin);
    v2 = fmax(v2, tdm_dot(p->velocity, p->velocity));
  }
  d->work.chunk_sum[chunk] = v2;
}

/* Take a share of all velocities away: nothing else stops a sphere that rolls in a hollow. Returns the largest speed
 * that is left [m/s]. */
static double drag(dem_data *d, double share) {
  double v2 = 0;
  dem_parted(d, DEM_MOTION);
  dem_each_chunk(d, drag_chunk, &share);
  for (int c = dem_home_first(d); c < dem_home_end(d); c++)
    v2 = fmax(v2, d->work.chunk_sum[c]);
  return sqrt(dem_homes_largest(d, v2));
}

/* step k of the settling, which is at `what`; *speed: the largest after it */
static tdm_status step(dem_data *d, uint64_t k, double dt, tdm_participant *p, const char *what, double *speed,
                       tdm_error *err) {
  if (dem_step(d, &(dem_step_task){.dt = dt, .settling = true}, err))
    return err->status;
  *speed = drag(d, d->model->settle.drag * dt);
  if (dem_homes_alive(d, p))
    return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted while %s", what);
  return k % 1024 == 0 ? dem_check_finite(d, (double)k * dt, err) : TDM_OK;
}

/* what a user who waits is told */
static void say(const dem_data *d, tdm_participant *p, const dem_settled *out) {
  const dem_settling *settle = &d->model->settle;
  uint64_t all = (uint64_t)d->model->nparticle;
  if (d->state.ledger.created < all)
    tdm_participant_progress(p, "settling: %.3g s, %llu of %llu particles poured", out->time,
                             (unsigned long long)d->state.ledger.created, (unsigned long long)all);
  else
    tdm_participant_progress(p, "settling: %.3g of %.3g s at most, fastest %.2g m/s (at rest: %.2g)", out->time,
                             settle->max_time, out->speed, settle->speed);
}

/* step until all is poured and the bed was slow for `quiet` seconds, or max_time after the last particle came */
static tdm_status run(dem_data *d, double quiet, tdm_participant *p, dem_settled *out, tdm_error *err) {
  const dem_settling *settle = &d->model->settle;
  uint64_t slow = 0, most = (uint64_t)fmin(ceil(settle->max_time / out->dt), 1e15);
  dem_pour pour = {0};
  for (uint64_t k = 1, left = most; left > 0; k++) {
    if (dem_pour_now(d, &pour, (double)(k - 1) * out->dt, err))
      return err->status;
    bool poured = dem_pour_over(d);
    left -= poured;
    if (step(d, k, out->dt, p, "settling", &out->speed, err))
      return err->status;
    out->time = (double)k * out->dt;
    say(d, p, out);
    slow = poured && out->speed < settle->speed ? slow + 1 : 0;
    out->rest = (double)slow * out->dt >= quiet;
    if (out->rest)
      break;
  }
  return dem_check_finite(d, out->time, err);
}

/* step, and how long it must be quiet: longer than a particle lingers at the top of a bounce */
static tdm_status choose_times(dem_data *d, dem_settled *out, double *quiet, tdm_error *err) {
  const dem_model *m = d->model;
  dem_limits limits;
  if (dem_limits_now(d, &limits, err))
    return err->status;
  out->dt = m->settle.dt > 0 ? m->settle.dt : fmin(0.2 * limits.rayleigh, limits.contact / 30);
  double g = tdm_norm(m->gravity);
  *quiet = fmax(50 * out->dt, isfinite(limits.contact) ? 2 * limits.contact : 0);
  *quiet = fmax(*quiet, g > 0 ? 20 * m->settle.speed / g : 0);
  return TDM_OK;
}

static void hold_bodies(dem_data *d) {
  for (int b = 0; b < d->model->nbody; b++)
    d->state.twist[b] = (tdm_twist){0};
}

/* at rest, with the bodies' own twists again */
static void stand_still(dem_data *d) {
  for (int i = dem_home_first_particle(d), end = dem_home_end_particle(d); i < end; i++)
    d->state.pace[i].velocity = d->state.pace[i].spin = tdm_v3(0, 0, 0);
  for (int b = 0; b < d->model->nbody; b++)
    d->state.twist[b] = d->model->body[b].start.twist;
  dem_parted(d, DEM_MOTION);
  dem_bodies_drive(d, d->model->time_start);
  d->state.nstep = 0;
  dem_homes_measure(d);
}

/* let the particles come to rest with the bodies held */
static tdm_status settle(dem_data *d, tdm_participant *p, dem_settled *out, tdm_error *err) {
  hold_bodies(d); /* first: the bed does not depend on their speeds */
  double quiet;
  if (choose_times(d, out, &quiet, err))
    return err->status;
  if (d->model->settle.dt > 0 && dem_check_step(d, out->dt, "dem.settle.dt", err))
    return err->status;
  if (run(d, quiet, p, out, err))
    return err->status;
  stand_still(d);
  return TDM_OK;
}

/* ---- pressing lids ---- */

static const double press_speed = 0.05; /* of a lid on its way [m/s] */

/* Move each lid inward while the bed pushes less than it should, outward while it pushes too much. Returns the largest
 * deviation from the wanted force, as a share of it. */
static double move_lids(dem_data *d, double dt) {
  double worst = 0;
  for (int k = 0; k < d->model->nbox; k++) {
    const dem_box *box = &d->model->box[k];
    if (box->lid < 0 || !(box->press > 0))
      continue;
    double lack = 1 - dem_lid_force(d, box) / box->press;
    d->state.lid[box->lid] -= press_speed * dt * fmax(-1, fmin(1, 5 * lack)); /* slower when nearly there */
    worst = fmax(worst, fabs(lack));
  }
  dem_walls_put(d);
  return worst;
}

/* Press the lids on a settled bed until it is at rest under the wanted force: it has no free play then. */
static tdm_status press(dem_data *d, tdm_participant *p, dem_settled *out, tdm_error *err) {
  const dem_settling *settle = &d->model->settle;
  const double close_enough = 0.01; /* of the wanted force */
  hold_bodies(d);
  double quiet, moved = 0;
  if (choose_times(d, out, &quiet, err))
    return err->status;
  uint64_t still = 0, most = (uint64_t)fmin(ceil(settle->max_time / out->dt), 1e15);
  for (uint64_t k = 1; k <= most && (double)still * out->dt < quiet; k++) {
    bool pressed = move_lids(d, out->dt) < close_enough;
    moved += press_speed * out->dt;
    if (4 * moved > d->lists.skin) { /* no list margin knows of a wall that moves on its body */
      moved = 0;
      d->lists.stale = true;
    }
    double speed;
    if (step(d, k, out->dt, p, "pressing a lid", &speed, err))
      return err->status;
    still = pressed && speed < settle->speed ? still + 1 : 0;
    tdm_participant_progress(p, "pressing a lid: %.3g of %.3g s at most", (double)k * out->dt, settle->max_time);
  }
  out->pressed = (double)still * out->dt >= quiet;
  stand_still(d);
  return dem_check_finite(d, out->time, err);
}

static bool any_press(const dem_model *m) {
  for (int k = 0; k < m->nbox; k++)
    if (m->box[k].lid >= 0 && m->box[k].press > 0)
      return true;
  return false;
}

/* settle, then put the lids on the bed and press them */
static tdm_status settle_and_close(dem_data *d, tdm_participant *p, dem_settled *out, tdm_error *err) {
  if (settle(d, p, out, err))
    return err->status;
  dem_lids_place(d);
  if (!any_press(d->model))
    return TDM_OK;
  if (dem_forces_now(d, true, err))
    return err->status;
  return press(d, p, out, err);
}

/* settle, or read what was settled before */
static tdm_status settle_or_read(dem_data *d, tdm_participant *p, dem_settled *out, tdm_error *err) {
  if (!d->model->settle.store)
    return settle_and_close(d, p, out, err);
  bool found;
  if (dem_bed_read(d, out, &found, err) || found)
    return err->status;
  if (dem_bed_check_writable(d->model, err) || settle_and_close(d, p, out, err))
    return err->status;
  return dem_bed_write(d, out, err);
}

tdm_status dem_settle(dem_data *d, tdm_participant *p, dem_settled *out, tdm_error *err) {
  *out = (dem_settled){.rest = true, .pressed = true};
  if (d->model->nparticle == 0)
    dem_lids_place(d);
  else {
    settle_or_read(d, p, out, err);
    tdm_participant_progress_end(p);
    if (err->status)
      return err->status;
  }
  return dem_forces_now(d, false, err);
}
