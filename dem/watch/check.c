/* Checks of a state: see check.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/watch/check.h"

#include "dem/particles/domain.h"
#include "dem/seam/homes.h"
#include "dem/seam/sums.h"
#include "dem/state/wall_gap.h"
#include "dem/watch/limits.h"

#include <stdio.h>

/* At the start, of the smaller radius: what is deeper shoots off, unless the scene lets the guard pass deeper overlaps
 * than usual, as those of soft particles that are pressed together are. */
static double most_overlap(const dem_model *m) {
  const double usual = 0.3; /* of the guard */
  return m->guard.overlap > usual ? m->guard.overlap : 0.1;
}

void dem_where(const dem_data *d, int i, char path[TDM_PATH_MAX], int *number) {
  const dem_model *m = d->model;
  uint64_t id = d->state.id[i];
  int g = 0;
  *number = (int)id;
  uint64_t made = 0;
  for (int s = 0; s < m->nsource; s++)
    made += d->state.source[s].made;
  bool started = m->start && id < d->state.ledger.created - made;
  snprintf(path, TDM_PATH_MAX, started ? "dem.start" : "dem.sources");
  if (started)
    return;
  if (id >= (uint64_t)m->nparticle)
    return;
  while (g < m->ngroup - 1 && !(*number >= m->group[g].first && *number < m->group[g].first + m->group[g].count))
    g++;
  snprintf(path, TDM_PATH_MAX, "dem.particles[%d]", g);
  *number -= m->group[g].first;
}

static void refuse_pair(const dem_data *d, int i, int j, double overlap, tdm_error *err) {
  char path[TDM_PATH_MAX], other[TDM_PATH_MAX];
  int ni, nj;
  dem_where(d, i, other, &ni);
  dem_where(d, j, path, &nj);
  tdm_fail(err, TDM_ERR_SCENE, path,
           "particle %d overlaps particle %d of %s by %.3g m (radii %g and %g m) and would shoot off; move them apart",
           nj, ni, other, overlap, d->state.sphere[j].radius, d->state.sphere[i].radius);
}

static void refuse_wall(const dem_data *d, int i, int w, double overlap, tdm_error *err) {
  char path[TDM_PATH_MAX];
  int n;
  dem_where(d, i, path, &n);
  tdm_vec3 x = d->state.sphere[i].position;
  tdm_fail(
      err, TDM_ERR_SCENE, path,
      "particle %d at [%.6g, %.6g, %.6g] m (radius %g m) is in a wall of \"%s\" by %.3g m and would shoot off; move "
      "it or the body",
      n, x.x, x.y, x.z, d->state.sphere[i].radius, d->model->body[d->model->wall[w].body].name, overlap);
}

static void check_inside(const dem_data *d, int i, tdm_error *err) {
  for (int a = 0; d->model->domain.open && a < 3; a++) {
    double x = (&d->state.sphere[i].position.x)[a], low = d->state.domain.low[a],
           high = low + d->state.domain.length[a];
    if (d->state.domain.periodic[a] || (x >= low && x <= high))
      continue;
    char path[TDM_PATH_MAX];
    int n;
    dem_where(d, i, path, &n);
    tdm_fail(err, TDM_ERR_SCENE, path, "particle %d is outside dem.domain at %c = %g m (%g to %g m); move one of them",
             n, "xyz"[a], x, low, high);
    return;
  }
}

/* The particles first ... end - 1; returns how many are behind a plane. */
static int check_among(const dem_data *d, int first, int end, tdm_error *err) {
  const dem_model *m = d->model;
  int nbehind = 0;
  for (int i = first; i < end && !err->status; i++) {
    for (int k = d->lists.pairs.first[i]; k < d->lists.pairs.first[i + 1]; k++) {
      int j = d->lists.pairs.other[k];
      double overlap = d->state.sphere[i].radius + d->state.sphere[j].radius -
                       tdm_norm(dem_between(d, d->state.sphere[i].position, d->state.sphere[j].position));
      if (overlap > most_overlap(m) * fmin(d->state.sphere[i].radius, d->state.sphere[j].radius))
        refuse_pair(d, i, j, overlap, err);
    }
    check_inside(d, i, err);
    bool behind = false;
    for (int w = 0; w < m->nwall; w++) {
      double gap = dem_gap(d, i, w, NULL);
      bool through = dem_wall_behind(&m->wall[w], gap, d->state.sphere[i].radius);
      behind = behind || through;
      if (!through && d->state.sphere[i].radius - gap > most_overlap(m) * d->state.sphere[i].radius)
        refuse_wall(d, i, w, d->state.sphere[i].radius - gap, err);
    }
    nbehind += behind;
  }
  return nbehind;
}

tdm_status dem_check_start(dem_data *d, int *nbehind, tdm_error *err) {
  tdm_error found = {0};
  *nbehind = check_among(d, dem_home_first_particle(d), dem_home_end_particle(d), &found);
  *nbehind = (int)dem_homes_sum(d, *nbehind);
  if (!dem_homes_any(d, found.status))
    return TDM_OK;
  dem_unite(d, DEM_WHOLE); /* all ranks say the same */
  check_among(d, 0, d->state.nparticle, err);
  return err->status;
}

tdm_status dem_check_step(dem_data *d, double dt, const char *path, tdm_error *err) {
  const dem_guard_def *guard = &d->model->guard;
  if (guard->chosen && guard->action == DEM_GUARD_WARN)
    return TDM_OK;
  dem_limits limits;
  if (dem_limits_expected(d, &limits, err))
    return err->status;
  if (guard->chosen && dt > DEM_CONTACT_SHARE * limits.contact)
    return tdm_fail(
        err, TDM_ERR_SCENE, path,
        "%g s is more than a twentieth of the shortest contact, %.4g s at %.3g m/s, which dem.guard.action "
        "\"stop\" asks for; use at most %.3g s, softer particles, or dem.expected_speed if the speed is lower "
        "(to run all the same, remove \"action\" or set it to \"warn\")",
        dt, limits.contact, limits.speed, DEM_CONTACT_SHARE * limits.contact);
  if (dt > DEM_CONTACT_SHARE_REFUSED * limits.contact)
    tdm_fail(err, TDM_ERR_SCENE, path,
             "%g s is more than half of the shortest contact, %.4g s at %.3g m/s: particles would pass through each "
             "other and gain energy; use at most %.3g s, or softer particles (to run all the same, set "
             "dem.guard.action to \"warn\")",
             dt, limits.contact, limits.speed, limits.step);
  return err->status;
}

static bool finite_at(const dem_data *d, int i) {
  return tdm_finite(&d->state.sphere[i].position.x, 3) && tdm_finite(&d->state.pace[i].velocity.x, 3) &&
         tdm_finite(&d->state.pace[i].spin.x, 3);
}

/* " beside particle 7" or " at a wall of "box"": the first in the lists */
static void name_partner(const dem_data *d, int i, char out[256]) {
  out[0] = 0;
  for (int a = 0; a <= i; a++)
    for (int k = d->lists.pairs.first[a]; k < d->lists.pairs.first[a + 1]; k++) {
      int other = a == i ? d->lists.pairs.other[k] : a;
      if (other >= d->state.nparticle || (a != i && d->lists.pairs.other[k] != i))
        continue;
      snprintf(out, 256, " beside particle %llu (id)", (unsigned long long)d->state.id[other]);
      return;
    }
  for (size_t k = 0; k < d->lists.walls.count; k++)
    if (d->lists.walls.entry[k].particle == i) {
      const char *body = d->model->body[d->model->wall[d->lists.walls.entry[k].wall].body].name;
      snprintf(out, 256, " at a wall of \"%s\"", body);
      return;
    }
}

/* anything that is not finite makes the sum not finite */
static void add_numbers(const dem_data *d, int chunk, const void *of, double *number) {
  tdm_vec3 sum = {0, 0, 0};
  (void)of;
  for (int i = dem_chunk_start(d, chunk), end = dem_chunk_start(d, chunk + 1); i < end; i++)
    sum = tdm_add(sum, tdm_add(tdm_add(d->state.sphere[i].position, d->state.pace[i].velocity), d->state.pace[i].spin));
  *number = sum.x + sum.y + sum.z;
}

tdm_status dem_check_finite(dem_data *d, double t, tdm_error *err) {
  double sum;
  dem_sum_chunks(d, 1, add_numbers, NULL, &sum);
  if (isfinite(sum))
    return TDM_OK;
  dem_unite(d, DEM_WHOLE);
  for (int i = 0; i < d->state.nparticle; i++) {
    char path[TDM_PATH_MAX];
    int n;
    if (finite_at(d, i))
      continue;
    dem_where(d, i, path, &n);
    char partner[256];
    name_partner(d, i, partner);
    tdm_vec3 x = d->lists.position_at_list[i];
    return tdm_fail(err, TDM_ERR_NUMERIC, path,
                    "particle %d (id %llu) has a position or velocity that is no number at t = %.9g s, step %llu; it "
                    "was last listed "
                    "at [%.6g, %.6g, %.6g] m%s; reduce time.dt (now %g s) or the stiffness, and look for particles "
                    "pressed into walls",
                    n, (unsigned long long)d->state.id[i], t, (unsigned long long)d->state.nstep, x.x, x.y, x.z,
                    partner, d->model->dt);
  }
  return TDM_OK;
}
