/* Checks of a state: see check.h. */
#include "dem/check.h"

#include <stdio.h>

static const double overlap_max = 0.1; /* of the smaller radius, at the start */

/* the scene's entry that made particle i, and its number there (its id, if it came from a source) */
static void where(const dem_data *d, int i, char path[TDM_PATH_MAX], int *number) {
  const dem_model *m = d->model;
  uint64_t id = d->id[i];
  int g = 0;
  *number = (int)id;
  snprintf(path, TDM_PATH_MAX, "dem.sources");
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
  where(d, i, other, &ni);
  where(d, j, path, &nj);
  tdm_fail(err, TDM_ERR_SCENE, path,
           "particle %d overlaps particle %d of %s by %.3g m (radii %g and %g m) and would shoot off; move them apart",
           nj, ni, other, overlap, d->sphere[j].radius, d->sphere[i].radius);
}

static void refuse_wall(const dem_data *d, int i, int w, double overlap, tdm_error *err) {
  char path[TDM_PATH_MAX];
  int n;
  where(d, i, path, &n);
  tdm_vec3 x = d->sphere[i].position;
  tdm_fail(
      err, TDM_ERR_SCENE, path,
      "particle %d at [%.6g, %.6g, %.6g] m (radius %g m) is in a wall of \"%s\" by %.3g m and would shoot off; move "
      "it or the body",
      n, x.x, x.y, x.z, d->sphere[i].radius, d->model->body[d->model->wall[w].body].name, overlap);
}

tdm_status dem_check_start(const dem_data *d, int *nbehind, tdm_error *err) {
  const dem_model *m = d->model;
  *nbehind = 0;
  for (int i = 0; i < d->nparticle && !err->status; i++) {
    for (int k = d->pairs.first[i]; k < d->pairs.first[i + 1]; k++) {
      int j = d->pairs.other[k];
      double overlap =
          d->sphere[i].radius + d->sphere[j].radius - tdm_norm(tdm_sub(d->sphere[i].position, d->sphere[j].position));
      if (overlap > overlap_max * fmin(d->sphere[i].radius, d->sphere[j].radius))
        refuse_pair(d, i, j, overlap, err);
    }
    bool behind = false;
    for (int w = 0; w < m->nwall; w++) {
      tdm_vec3 n;
      double gap = dem_wall_gap(&m->wall[w], &d->wall[w], d->sphere[i].position, &n);
      bool through = m->wall[w].primitive == DEM_PLANE && gap <= -d->sphere[i].radius;
      behind = behind || through;
      if (!through && d->sphere[i].radius - gap > overlap_max * d->sphere[i].radius)
        refuse_wall(d, i, w, d->sphere[i].radius - gap, err);
    }
    *nbehind += behind;
  }
  return err->status;
}

static bool finite_at(const dem_data *d, int i) {
  return tdm_finite(&d->sphere[i].position.x, 3) && tdm_finite(&d->pace[i].velocity.x, 3) &&
         tdm_finite(&d->pace[i].spin.x, 3);
}

tdm_status dem_check_finite(const dem_data *d, double t, tdm_error *err) {
  /* anything that is not finite makes the sum not finite */
  tdm_vec3 sum = {0, 0, 0};
  for (int i = 0; i < d->nparticle; i++)
    sum = tdm_add(sum, tdm_add(tdm_add(d->sphere[i].position, d->pace[i].velocity), d->pace[i].spin));
  if (isfinite(sum.x + sum.y + sum.z))
    return TDM_OK;
  for (int i = 0; i < d->nparticle; i++) {
    char path[TDM_PATH_MAX];
    int n;
    if (finite_at(d, i))
      continue;
    where(d, i, path, &n);
    return tdm_fail(
        err, TDM_ERR_NUMERIC, path,
        "particle %d (%d in all) has a position or velocity that is no number at t = %.9g s; reduce time.dt "
        "(now %g s) or the stiffness, and look for particles pressed into walls",
        n, (int)d->id[i], t, d->model->dt);
  }
  return TDM_OK;
}
