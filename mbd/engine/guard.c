/* The guard: see guard.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/engine/guard.h"

#include "protocol/scene/remark.h"

#include <math.h>
#include <stdio.h>

static const double told = 0.1;   /* of what stops */
static const double least = 1e-6; /* [J/kg] */

tdm_status mbd_guard_look(const mbd_model *model, mbd_data *data, double t, mbd_energies e, tdm_error *err) {
  const mbd_guard_settings *s = &model->solver.guard;
  mbd_guard_state *g = &data->guard;
  const double stored = e.potential + e.springs;
  const double balance = e.kinetic + stored + data->work.dissipated - data->work.supplied - data->energy_start;
  double mass = 0;
  for (int b = 0; b < model->nbody; b++)
    mass += model->body[b].mass;
  g->kinetic = fmax(g->kinetic, e.kinetic);
  g->stored[0] = g->looks ? fmin(g->stored[0], stored) : stored;
  g->stored[1] = g->looks ? fmax(g->stored[1], stored) : stored;
  g->passed = fmax(g->passed, fabs(data->work.supplied) + fabs(data->work.dissipated));
  g->looks = true;
  if (fabs(balance) > fabs(g->off))
    g->off = balance;
  const double scale = g->kinetic + g->stored[1] - g->stored[0] + g->passed;
  const double floor = fmax(least * mass, 1e-9 * fmax(fabs(g->stored[0]), fabs(g->stored[1])));
  g->share = fabs(g->off) > floor ? fabs(g->off) / fmax(scale, floor) : 0;
  if (s->action == MBD_GUARD_OFF || !(fabs(balance) > floor + told * s->energy * scale))
    return TDM_OK;
  char text[TDM_MESSAGE_MAX];
  bool too_much = fabs(balance) > floor + s->energy * scale;
  snprintf(text, sizeof text,
           "the bodies have %s %.3g J without a source by t = %.9g s, %.2g of the %.3g J there were%s: the integration "
           "is %s; take smaller tolerances (mbd.solver.relative_tolerance, absolute_tolerance) or a smaller "
           "mbd.solver.max_step%s",
           balance > 0 ? "gained" : "lost", fabs(balance), t, fabs(balance) / scale, scale,
           too_much ? " (mbd.guard.energy is exceeded)" : "", too_much ? "wrong" : "inexact",
           too_much ? " (\"mbd.guard.action\": \"warn\" goes on)" : "");
  if (too_much && s->action == MBD_GUARD_STOP)
    return tdm_fail(err, TDM_ERR_NUMERIC, "mbd", "%s", text);
  tdm_remark(TDM_WARNING, "guard.balance", "mbd", t, "%s", text);
  return TDM_OK;
}
