/* Momentum of the coupled bodies against the impulse of their loads: see momentum.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/observe/momentum.h"

#include "protocol/scene/remark.h"

#include <math.h>
#include <stdio.h>

static const double allowed = 1e-6; /* share */

void cpl_momentum_window(cpl_momentum *p, const cpl_loop *loop, int i) {
  const tdm_assigned_body *b = &loop->session->body[i];
  const double h = loop->t1 - loop->t0;
  for (int j = 0; j < loop->nload; j++)
    p->given = tdm_axpy(h / (j + 1), loop->load[i * TDM_LOAD_MAX + j].force, p->given);
  const tdm_vec3 v = loop->state_end[i].twist.velocity;
  const tdm_vec3 gained = tdm_scale(b->mass, tdm_sub(v, b->state.twist.velocity));
  const tdm_vec3 fallen = tdm_scale(b->mass * loop->t1, loop->session->partner[CPL_MBD].gravity);
  for (int k = 0; k < b->nfree; k++) {
    const double terms[] = {tdm_dot(b->free[k], p->given), -tdm_dot(b->free[k], gained), tdm_dot(b->free[k], fallen)};
    const double off = fabs(terms[0] + terms[1] + terms[2]);
    p->most = fmax(p->most, b->mass * fabs(tdm_dot(b->free[k], v)));
    for (int n = 0; n < 3; n++)
      p->most = fmax(p->most, fabs(terms[n]));
    if (off > p->off)
      p->off = off, p->at = loop->t1;
  }
}

double cpl_momentum_share(const cpl_momentum *p, const tdm_assigned_body *b) {
  return b->nfree == 0 ? NAN : p->most > 0 ? p->off / p->most : 0;
}

void cpl_momentum_end(const cpl_momentum *p, const cpl_loop *loop, int i) {
  char path[TDM_PATH_MAX];
  const double share = cpl_momentum_share(p, &loop->session->body[i]);
  if (!(share > allowed))
    return;
  snprintf(path, sizeof path, "coupling.bodies[%d]", i);
  tdm_remark(
      TDM_WARNING, "momentum", path, p->at,
      "the momentum of body \"%.100s\" is not that of the loads on it: they differ by up to %.3g N s, %.2g of the "
      "largest, most at t = %.9g s; the integration of %.80s gives impulses to other windows, or loses them: look "
      "at its formulation and tolerances",
      loop->settings->body[i].name[CPL_MBD], p->off, share, p->at, cpl_session_name(loop->session, CPL_MBD));
}
