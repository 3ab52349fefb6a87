/* One solver over the window: see solve.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/solve.h"

#include "coupler/state/path.h"
#include "protocol/math/legendre.h"

#include <math.h>
#include <string.h>

/* Send a STEP and wait for its RESULT, with the counts that were asked for. */
static tdm_status exchange(cpl_loop *loop, cpl_role role, tdm_step *step, tdm_error *err) {
  step->window = loop->window;
  step->t0 = loop->t0;
  step->t1 = loop->t1;
  step->nstep = loop->step1 - loop->step0;
  step->nbody = loop->nbody;
  step->nsample = loop->nsample;
  step->sample_time = loop->sample_time;
  step->seen = cpl_session_sees(loop->session, role, loop->t1);
  return cpl_session_step(loop->session, role, step, &loop->result[role], err);
}

/* SLERP takes the short way, and the linear model of a mechanism ends: a body may not turn far within a window. Where
 * nodes tell how it turns they are gone by, and where no load moves it, it may turn as it likes. */
static tdm_status check_turn(cpl_loop *loop, int body, tdm_error *err) {
  const double most = 1; /* [rad] */
  double rate = fmax(tdm_norm(loop->state_start[body].twist.angular), tdm_norm(loop->state_end[body].twist.angular));
  double turn = rate * (loop->t1 - loop->t0), by_nodes = cpl_path_turn(loop, body);
  if (!isnan(by_nodes))
    turn = loop->prescribed[body] ? 0 : by_nodes;
  if (turn <= most)
    return TDM_OK;
  loop->too_far = true;
  return tdm_fail(
      err, TDM_ERR_NUMERIC, "coupling.n",
      "body \"%s\" turns by %.3g rad in the window from %g s to %g s; the path inside a window is followed up "
      "to %g rad: take a smaller n",
      loop->settings->body[body].name[CPL_MBD], turn, loop->t0, loop->t1, most);
}

tdm_status cpl_solve_mbd(cpl_loop *loop, int ncoefficient, tdm_error *err) {
  for (int i = 0; i < loop->nbody; i++) {
    for (int j = 0; j < ncoefficient; j++)
      loop->packed[i * ncoefficient + j] = loop->load[i * TDM_LOAD_MAX + j];
    tdm_wrench *held = &loop->packed[i * ncoefficient];
    held->force = tdm_add(held->force, loop->external[i].force);
    held->moment = tdm_add(held->moment, loop->external[i].moment);
  }
  loop->nload = ncoefficient;
  tdm_step step = {.nload = ncoefficient, .load = loop->packed, .ahead = cpl_path_ahead(loop)};
  tdm_status status = exchange(loop, CPL_MBD, &step, err);
  if (status != TDM_OK)
    return status;
  for (int i = 0; i < loop->nbody; i++) {
    loop->state_end[i] = loop->result[CPL_MBD].state[i];
    if (check_turn(loop, i, err) != TDM_OK)
      return err->status;
  }
  return TDM_OK;
}

static tdm_status solve_dem(cpl_loop *loop, tdm_step *step, tdm_error *err) {
  tdm_status status = exchange(loop, CPL_DEM, step, err);
  if (status != TDM_OK)
    return status;
  for (int i = 0; i < loop->nbody; i++)
    loop->mean[i] = loop->result[CPL_DEM].load[i];
  return TDM_OK;
}

tdm_status cpl_solve_dem_along(cpl_loop *loop, const tdm_state *start, const tdm_state *end, tdm_error *err) {
  tdm_step step = {.nstate = loop->nbody, .start = start, .end = end};
  if (loop->takes_path)
    step.path = cpl_path_through(loop, start, end);
  else if (cpl_path_check(loop, start, end, err) != TDM_OK)
    return err->status;
  loop->sent_start = start;
  loop->sent_end = end;
  return solve_dem(loop, &step, err);
}

/* Coefficients in s = (t - t0)/H of the load m0 + 3 m1 P1(x) + c2 P2(x), x = 2s - 1, that has the moments of nstep
 * steps' kicks. m0 and m1 are what a free body's velocity and place at the end depend on, and stay exact. Kicks of a
 * constant load have a second moment m0/nstep^2: it is taken out, and c2 is that of the parabola through kicks that lie
 * on one: c2 = (m2 - m0/nstep^2)/(9/4 (<x^4> - <x^2>^2)), <> the mean with the kicks' weights; 5 m2 for many steps. */
static void from_moments(const tdm_wrench *moment, uint64_t nstep, int ncoefficient, tdm_wrench *out) {
  const double *m0 = (const double *)(const void *)&moment[0], *m1 = (const double *)(const void *)&moment[1];
  const double *m2 = (const double *)(const void *)&moment[2];
  const double q = 1 / ((double)nstep * (double)nstep), x2 = 1.0 / 3 + 2 * q / 3;
  const double x4 = 0.2 + 4 * q / 3 - 8 * q * q / 15, norm = 2.25 * (x4 - x2 * x2);
  for (int i = 0; i < TDM_WRENCH_DOUBLES; i++) {
    double slope = ncoefficient > 1 ? 3 * m1[i] : 0, bend = ncoefficient > 2 ? (m2[i] - q * m0[i]) / norm : 0;
    const double c[3] = {m0[i] - slope + bend, 2 * slope - 6 * bend, 6 * bend};
    for (int j = 0; j < ncoefficient; j++)
      ((double *)(void *)&out[j])[i] = c[j];
  }
}

/* Add c_3 P_3 + c_4 P_4 + ... to the parabolas of all bodies, up to the last that is not zero; `further` (nbody x
 * TDM_FURTHER). */
static void add_further(cpl_loop *loop, const tdm_wrench *further) {
  for (int j = 3; j < TDM_LOAD_MAX; j++) {
    double power[TDM_LOAD_MAX];
    bool any = false;
    for (int i = 0; i < loop->nbody && !any; i++)
      for (int l = 0; l < TDM_WRENCH_DOUBLES; l++)
        any = any || ((const double *)(const void *)&further[i * TDM_FURTHER + j - 3])[l] != 0;
    if (!any)
      continue;
    for (int i = 0; i < loop->nbody; i++)
      memset(&loop->load[i * TDM_LOAD_MAX + loop->nload], 0, (size_t)(j + 1 - loop->nload) * sizeof *loop->load);
    loop->nload = j + 1;
    tdm_legendre_powers(j, power);
    for (int i = 0; i < loop->nbody; i++)
      for (int p = 0; p <= j; p++) {
        tdm_wrench *to = &loop->load[i * TDM_LOAD_MAX + p];
        const tdm_wrench *c = &further[i * TDM_FURTHER + j - 3];
        to->force = tdm_axpy(power[p], c->force, to->force);
        to->moment = tdm_axpy(power[p], c->moment, to->moment);
      }
  }
}

tdm_status cpl_solve_dem_proxy(cpl_loop *loop, const double *correction, tdm_error *err) {
  const uint64_t nstep = loop->step1 - loop->step0;
  tdm_step step = {
      .nstate = loop->nbody, .start = loop->state_start, .end = loop->state_start, .has_proxy = loop->nbody > 0};
  step.proxy = loop->proxy;
  loop->correction = correction;
  if (correction)
    step.proxy.correction = correction;
  if (loop->takes_path)
    step.path = loop->told;
  else if (cpl_path_check(loop, NULL, NULL, err) != TDM_OK)
    return err->status;
  if (solve_dem(loop, &step, err) != TDM_OK)
    return err->status;
  loop->nload = nstep == 1 ? 1 : nstep < 4 ? 2 : 3;
  for (int i = 0; i < loop->nbody; i++) {
    const tdm_interface *body = &loop->result[CPL_DEM].body[i];
    from_moments(body->moment, nstep, loop->nload, &loop->load[i * TDM_LOAD_MAX]);
    loop->dem_end[i] = body->end;
  }
  if (loop->nload == 3 && loop->result[CPL_DEM].nfurther > 0)
    add_further(loop, loop->result[CPL_DEM].further);
  return TDM_OK;
}
