/* Energies and work: see energy.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/mechanics/energy.h"

mbd_energies mbd_energies_at(const mbd_model *model, mbd_data *data) {
  mbd_energies e = {0, 0, 0};
  for (int b = 0; b < model->nbody; b++) {
    const mbd_kin *k = &data->kin[b + 1];
    const mbd_body *body = &model->body[b];
    e.kinetic += 0.5 * body->mass * tdm_dot(k->v, k->v) + 0.5 * tdm_dot(k->w, mbd_inertia_mul(body, k, k->w));
    e.potential -= body->mass * tdm_dot(model->gravity, k->r);
  }
  for (int i = 0; i < model->nforce; i++)
    e.springs += mbd_force_at(model, data, i, false)->potential;
  return e;
}
