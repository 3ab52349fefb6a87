/* The sum of forces on every body: see balance.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/assembly/balance.h"

#include <math.h>
#include <stdlib.h>

/* share of the largest force on a body that may be left of their sum */
static const double left_most = 1e-6;

/* the sum of forces (k = 0) and of moments (1) on a body, and the largest of them */
typedef struct {
  tdm_vec3 sum[2];
  double largest[2];
} balance;

static void add(balance *b, int k, double s, tdm_vec3 x) {
  b->sum[k] = tdm_axpy(s, x, b->sum[k]);
  b->largest[k] = fmax(b->largest[k], fabs(s) * tdm_norm(x));
}

/* s times a pair's 12 numbers */
static void add_pair(balance *of, const int body[2], double s, const double pair[MBD_PAIR]) {
  for (int side = 0; side < 2; side++)
    for (int k = 0; k < 2 && body[side] != MBD_GROUND; k++)
      add(&of[body[side]], k, s, mbd_get3(pair + 6 * side + 3 * k));
}

static void add_up(const mbd_model *model, mbd_data *data, balance *of) {
  for (int b = 0; b < model->nbody; b++) {
    const mbd_kin *k = &data->kin[b + 1];
    const mbd_body *body = &model->body[b];
    const double *a = data->acceleration + 6 * b;
    add(&of[b], 0, body->mass, model->gravity);
    add(&of[b], 1, 1, tdm_cross(mbd_inertia_mul(body, k, k->w), k->w));
    add(&of[b], 0, -body->mass, mbd_get3(a));
    add(&of[b], 1, -1, mbd_inertia_mul(body, k, mbd_get3(a + 3)));
  }
  for (int i = 0; i < model->ncoupled && data->nload > 0; i++) {
    tdm_wrench w = mbd_load_at(data, i, data->now);
    add(&of[model->coupled[i]], 0, 1, w.force);
    add(&of[model->coupled[i]], 1, 1, w.moment);
  }
  for (int i = 0; i < model->nforce; i++)
    add_pair(of, model->force[i].body, 1, mbd_force_at(model, data, i, false)->Q);
  for (int i = 0; i < model->npart; i++) {
    const mbd_rows *rows = mbd_part_at(model, data, i, false);
    for (int k = 0; k < rows->n; k++)
      add_pair(of, rows->body, -data->lambda[rows->first + k], rows->G[k]);
  }
}

/* A slim body (slim.h) that nothing holds about its axis takes no torque there. */
static tdm_status check_slim(const mbd_model *model, const mbd_data *data, int b, const balance *of, double floor,
                             tdm_error *err) {
  const double most = 1e-9; /* of the largest moment: what is more than rounding */
  const mbd_body *body = &model->body[b];
  const mbd_kin *k = &data->kin[b + 1];
  if (!body->spins)
    return TDM_OK;
  tdm_vec3 moment = mbd_inertia_mul(body, k, mbd_get3(data->acceleration + 6 * b + 3));
  double torque = fabs(tdm_dot(tdm_m3_mul(k->A, body->axis), moment));
  if (torque <= most * of->largest[1] || torque <= floor)
    return TDM_OK;
  char path[TDM_PATH_MAX];
  snprintf(path, sizeof path, "mbd.bodies[%d].inertia", b);
  return tdm_fail(
      err, TDM_ERR_NUMERIC, path,
      "the body \"%s\" has no inertia about its own axis, but a torque of %.3g N m turns it about it at t = "
      "%.9g s; give it an inertia there, or a joint that holds it",
      body->name, torque, data->now);
}

tdm_status mbd_check_balance(const mbd_model *model, mbd_data *data, tdm_error *err) {
  static const char *const unit[] = {"N", "N m"}, *const what[] = {"forces", "moments"};
  balance *of = calloc((size_t)model->nbody + 1, sizeof *of);
  if (!of)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the sums of forces on %d bodies", model->nbody);
  add_up(model, data, of);
  double most[2] = {0, 0}; /* what is below the rounding of the largest of all is none */
  for (int b = 0; b < model->nbody; b++)
    for (int k = 0; k < 2; k++)
      most[k] = fmax(most[k], of[b].largest[k]);
  const double still = 1e-12 * most[0] * mbd_model_extent(model);
  for (int b = 0; b < model->nbody && !err->status; b++)
    check_slim(model, data, b, &of[b], fmax(still, 1e-16 * most[1]), err);
  for (int b = 0; b < model->nbody && !err->status; b++)
    for (int k = 0; k < 2 && !err->status; k++) {
      double left = tdm_norm(of[b].sum[k]);
      char path[TDM_PATH_MAX];
      if (left <= left_most * of[b].largest[k] || left <= 1e-16 * most[k])
        continue;
      snprintf(path, sizeof path, "mbd.bodies[%d]", b);
      tdm_fail(err, TDM_ERR_NUMERIC, path,
               "the %s on body \"%s\" do not add up at t = %.9g s: %.3g %s are left of %.3g %s. The mechanism is too "
               "near a singular position there, or masses and inertias are too far apart for double precision: check "
               "those of this body and of its neighbours",
               what[k], model->body[b].name, data->now, left, unit[k], of[b].largest[k], unit[k]);
    }
  free(of);
  return err->status;
}
