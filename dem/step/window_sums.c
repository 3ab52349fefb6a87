/* Sums over a window: see window_sums.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/step/window_sums.h"

#include "dem/particles/field.h"

/* The load on a body as a kick at s in [0, 1], with the share `weight` of the window, into its moments. */
static void add_moments(tdm_interface *body, double weight, double s, const tdm_wrench *load) {
  const double x = 2 * s - 1, legendre[] = {1, x, 1.5 * x * x - 0.5};
  for (int j = 0; j < 3; j++) {
    body->moment[j].force = tdm_axpy(weight * legendre[j], load->force, body->moment[j].force);
    body->moment[j].moment = tdm_axpy(weight * legendre[j], load->moment, body->moment[j].moment);
  }
}

static void add_kicks(dem_window_sums *sums, const dem_data *d, uint64_t k, uint64_t n, const dem_path *path) {
  const double at = (double)k / (double)n, weight = (k == 0 || k == n ? 0.5 : 1) / (double)n;
  for (int c = 0; c < d->model->ncoupled; c++) {
    const tdm_wrench *load = &d->state.body_load[d->model->coupled_body[c]];
    add_moments(&sums->body[c], weight, at, load);
    if (!path)
      continue;
    tdm_twist twist = dem_path_twist(&path[c], at);
    sums->body[c].work +=
        weight * sums->duration * (tdm_dot(load->force, twist.velocity) + tdm_dot(load->moment, twist.angular));
  }
}

void dem_window_sums_add(dem_window_sums *sums, dem_data *d, uint64_t k, uint64_t n, const dem_path *path) {
  if (sums->body)
    add_kicks(sums, d, k, n, path);
  if (k == 0)
    return;
  for (int c = 0; c < d->model->ncoupled; c++) { /* [L18] Eq. 2: the mean of the n samples after each step */
    const tdm_wrench *load = &d->state.body_load[d->model->coupled_body[c]];
    sums->load[c].force = tdm_axpy(1, load->force, sums->load[c].force);
    sums->load[c].moment = tdm_axpy(1, load->moment, sums->load[c].moment);
  }
  sums->fixed = dem_fixed_force(d);
}
