/* The local errors of a step: see alpha.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/integrate/alpha/alpha.h"

#include <math.h>
#include <string.h>

/* What Newton's matrix lets the accelerations in s->x (nv) be, into s->dx. */
static void let_be(mbd_alpha *s) {
  memset(s->x + s->nv, 0, (size_t)s->model->nrow * sizeof(double));
  mbd_alpha_multiply(s, s->x, s->dx);
  memset(s->dx + s->nv, 0, (size_t)s->model->nrow * sizeof(double));
  mbd_lu_solve(s->now.step, s->dx);
}

double mbd_alpha_error(mbd_alpha *s, double h) {
  const mbd_model *m = s->model;
  const double local = m->solver.relative_tolerance, place = pow(local, 2.0 / 3);
  const double of_velocity = fabs(s->c3) * h * 2 * h / (h + s->now.last), of_place = fabs(s->c2) * h * h;
  double worst = 0;
  for (int order = 2; order <= 3; order++) { /* e_q, then e_V */
    for (int k = 0; k < s->nv; k++)
      s->x[k] = s->vdot1[k] - (order == 2 ? s->now.w[k] + s->X1[k] : s->guess[k]);
    let_be(s);
    for (int b = 0; b < m->nbody; b++) {
      double speed = fmax(s->now.speed[b], fmax(mbd_alpha_speed(s, b, s->y0), mbd_alpha_speed(s, b, s->y1)));
      double error = sqrt(mbd_alpha_by_mass(s, b, s->dx + 6 * b) / m->body[b].mass);
      if (order == 2) /* goes with h^2 against the way: made to go with h^3, as the other one does */
        error = pow(of_place * error / (h * (place * speed + m->solver.absolute_tolerance)), 1.5);
      else
        error = of_velocity * error / (local * speed + m->solver.absolute_tolerance);
      worst = fmax(worst, error);
    }
  }
  return worst;
}
