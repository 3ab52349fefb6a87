/* tandem-mbd as it would be if its answers had a scatter of SCATTER [m] (environment; uniform, of positions):
 * velocities follow as the quotient of differences over the window, as in a solver whose corrector ends at a tolerance
 * of positions. Its own state has none. A foreign solver may be so. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/adapter/solver.h"

#include <stdint.h>
#include <stdlib.h>

static double scatter;
static tdm_vec3 last; /* scatter of the window before [m] */

/* in [-scatter, scatter], the same in every run */
static double draw(void) {
  static uint64_t x = 88172645463325252u; /* Marsaglia's xorshift */
  x ^= x << 13;
  x ^= x >> 7;
  x ^= x << 17;
  return scatter * (2 * ((double)(x >> 11) / 9007199254740992.0) - 1);
}

static tdm_status step(void *self, const tdm_step *s, tdm_result *r, tdm_error *err) {
  if (mbd_solver_ops.step(self, s, r, err) != TDM_OK)
    return err->status;
  const double z = draw(), rate = (z - last.z) / (s->t1 - s->t0);
  for (int i = 0; i < r->nstate; i++) {
    r->state[i].pose.position.z += z;
    r->state[i].twist.velocity.z += rate;
  }
  for (int k = 0; k < r->nsample * r->nstate; k++) { /* records as at the window's end */
    r->sample_state[k].pose.position.z += z;
    r->sample_state[k].twist.velocity.z += rate;
  }
  last.z = z;
  return TDM_OK;
}

int main(int argc, char **argv) {
  scatter = getenv("SCATTER") ? strtod(getenv("SCATTER"), NULL) : 0;
  tdm_solver_ops ops = mbd_solver_ops;
  ops.step = step;
  return tdm_solver_main(&ops, argc, argv);
}
