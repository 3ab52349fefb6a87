/* Velocity Verlet: see integrate.h. */
#include "dem/integrate.h"

double dem_kick_drift(dem_data *d, double dt, tdm_vec3 shift) {
  const dem_model *m = d->model;
  double moved2 = 0;
  for (int i = 0; i < d->nparticle; i++) {
    double half = 0.5 * dt, per_mass = 1 / d->mass[i];
    double per_inertia = 2.5 * per_mass / (d->radius[i] * d->radius[i]);
    tdm_vec3 a = tdm_axpy(per_mass, d->force[i], m->gravity);
    tdm_vec3 alpha = tdm_scale(per_inertia, d->torque[i]);
    tdm_vec3 v = tdm_axpy(half, a, d->velocity[i]), w = tdm_axpy(half, alpha, d->spin[i]);
    tdm_vec3 x = tdm_axpy(dt, v, d->position[i]);
    d->velocity[i] = v;
    d->spin[i] = w;
    d->velocity_ahead[i] = tdm_axpy(half, a, v);
    d->spin_ahead[i] = tdm_axpy(half, alpha, w);
    d->position[i] = x;
    d->force[i] = d->torque[i] = tdm_v3(0, 0, 0);
    tdm_vec3 moved = tdm_sub(tdm_sub(x, d->position_at_list[i]), shift);
    double r2 = tdm_dot(moved, moved);
    if (r2 > moved2)
      moved2 = r2;
  }
  return moved2;
}

void dem_kick(dem_data *d, double dt) {
  const dem_model *m = d->model;
  for (int i = 0; i < d->nparticle; i++) {
    double half = 0.5 * dt, per_mass = 1 / d->mass[i];
    double per_inertia = 2.5 * per_mass / (d->radius[i] * d->radius[i]);
    d->velocity[i] = tdm_axpy(half, tdm_axpy(per_mass, d->force[i], m->gravity), d->velocity[i]);
    d->spin[i] = tdm_axpy(half * per_inertia, d->torque[i], d->spin[i]);
  }
}
