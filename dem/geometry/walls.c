/* The walls of moving bodies: see walls.h. The contacts with them are in contact/loop.c. */
#include "dem/geometry/walls.h"

void dem_walls_put(dem_data *d) {
  for (int w = 0; w < d->model->nwall; w++)
    d->wall[w] = dem_wall_put(&d->model->wall[w], &d->pose[d->model->wall[w].body]);
}

void dem_bodies_move(dem_data *d, const dem_motion *motion, uint64_t k, uint64_t n) {
  const dem_model *m = d->model;
  double s = (double)k / (double)n, s_mid = ((double)k - 0.5) / (double)n;
  for (int c = 0; c < m->ncoupled; c++) {
    int b = m->coupled_body[c];
    d->pose[b] = dem_motion_pose(&motion[c], s);
    d->twist[b] = dem_motion_twist(&motion[c], s);
    d->twist_mid[b] = dem_motion_twist(&motion[c], s_mid);
  }
  for (int w = 0; w < m->nwall; w++)
    if (m->body[m->wall[w].body].coupled >= 0)
      d->wall[w] = dem_wall_put(&m->wall[w], &d->pose[m->wall[w].body]);
}

/* is particle i through plane w? */
static bool behind(const dem_data *d, int i, int w) {
  const dem_wall *wall = &d->model->wall[w];
  tdm_vec3 n;
  return wall->primitive == DEM_PLANE && dem_wall_gap(wall, &d->wall[w], d->position[i], &n) <= -d->model->radius[i];
}

void dem_mark_front(dem_data *d) {
  int nwall = d->model->nwall;
  for (int i = 0; i < d->model->nparticle; i++)
    for (int w = 0; w < nwall; w++)
      d->front[(size_t)i * (size_t)nwall + (size_t)w] = !behind(d, i, w);
}

long dem_count_lost(const dem_data *d) {
  int nwall = d->model->nwall;
  long lost = 0;
  for (int i = 0; i < d->model->nparticle; i++) {
    bool through = false;
    for (int w = 0; w < nwall && !through; w++)
      through = d->front[(size_t)i * (size_t)nwall + (size_t)w] && behind(d, i, w);
    lost += through;
  }
  return lost;
}
