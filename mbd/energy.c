#include "mbd/energy.h"

double mbd_kinetic_energy(const mbd_model *model, const mbd_data *data) {
  double sum = 0;
  for (int b = 0; b < model->nbody; b++) {
    const mbd_kin *k = &data->kin[b + 1];
    const mbd_body *body = &model->body[b];
    sum += 0.5 * body->mass * tdm_dot(k->v, k->v) + 0.5 * tdm_dot(k->w, mbd_inertia_mul(body, k, k->w));
  }
  return sum;
}

double mbd_potential_energy(const mbd_model *model, mbd_data *data) {
  double sum = 0;
  for (int b = 0; b < model->nbody; b++)
    sum -= model->body[b].mass * tdm_dot(model->gravity, data->kin[b + 1].r);
  for (int i = 0; i < model->nforce; i++)
    sum += mbd_force_at(model, data, i, false)->potential;
  return sum;
}
