/* An FMU's run on its solvers.
 *
 *   dem    path of a body through the step: from where DEM left it to  r + H v + H^2/2 a,  exp(H w + H^2/2 alpha) q  by
 *          the inputs, which are the motion at the step's start; with inputs_at_end to the inputs themselves. Hermite's
 *          cubic and SLERP in between, so that bodies never jump. Outputs are the mean load: the impulse over H, as the
 *          kicks of DEM's integrator gave it, where DEM tells it; else the mean of its values after each DEM step.
 *   mbd    the inputs are held over the step.
 *   both   the coupled loop, with the inputs held beside the loads of the particles; as many windows as the step has.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/export/serve/perform.h"

#include "coupler/loop/window.h"
#include "coupler/state/path.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static cpl_session *session_of(const cpl_performance *p) {
  return &p->stage->session;
}

/* ---- inputs and outputs ---- */

tdm_status cpl_perform_states(const cpl_settings *settings, const double *input, tdm_state *out, tdm_error *err) {
  for (int i = 0; i < settings->nbody; i++) {
    memcpy(&out[i], input + i * CPL_MOTION, sizeof out[i]);
    const tdm_quat q = out[i].pose.orientation;
    const double norm = sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    if (!(fabs(norm - 1) < 0.1))
      return tdm_fail(err, TDM_ERR_NUMERIC, NULL,
                      "the orientation of body \"%s\" is a quaternion [%g, %g, %g, %g] of norm %g; give one of norm 1",
                      settings->body[i].name[CPL_DEM], q.w, q.x, q.y, q.z, norm);
    out[i].pose.orientation = tdm_quat_unit(q);
  }
  return TDM_OK;
}

static void put_motions(cpl_performance *p, const tdm_state *state, const double *acceleration) {
  for (int i = 0; i < p->layout.nbody; i++) {
    double *to = p->output + i * p->layout.output;
    memcpy(to, &state[i], sizeof state[i]);
    if (session_of(p)->acceleration)
      memcpy(to + TDM_STATE_DOUBLES, acceleration + 6 * i, 6 * sizeof *to);
  }
}

/* Loads of the particles: the last of each body's outputs. */
static void put_loads(cpl_performance *p, const tdm_wrench *load) {
  for (int i = 0; i < p->layout.nbody; i++)
    memcpy(p->output + (i + 1) * p->layout.output - CPL_LOAD, &load[i], sizeof load[i]);
}

/* Channels of a role: one sample, or the values at the start. */
static void put_channels(cpl_performance *p, cpl_role role, const double *channel) {
  double *to = p->output + p->layout.nbody * p->layout.output + (role == CPL_DEM ? p->layout.nchannel[CPL_MBD] : 0);
  if (p->layout.nchannel[role] > 0)
    memcpy(to, channel, (size_t)p->layout.nchannel[role] * sizeof *to);
}

static void put_mobility(cpl_performance *p, const tdm_mobility *mobility) {
  const size_t k = 6 * (size_t)p->layout.nbody;
  if (p->mobility)
    memcpy(p->mobility, mobility->Y, k * k * sizeof *p->mobility);
}

/* ---- start ---- */

/* Outputs at the start. Accelerations that mbd told are those without any load. */
static tdm_status look_at_start(cpl_performance *p, const double *input, tdm_error *err) {
  const cpl_session *s = session_of(p);
  const cpl_export_side side = p->stage->side;
  const size_t k = 6 * (size_t)p->layout.nbody;
  double *acceleration = calloc(k + 1, sizeof *acceleration);
  tdm_state *state = calloc((size_t)p->layout.nbody + 1, sizeof *state);
  if (!acceleration || !state) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  } else if (side != CPL_EXPORT_DEM) {
    if (s->acceleration)
      memcpy(acceleration, s->acceleration, k * sizeof *acceleration);
    put_mobility(p, &s->mobility);
    const double *particles = (const double *)(const void *)s->load;
    for (size_t i = 0; i < k && p->mobility; i++)
      for (size_t j = 0; j < k; j++)
        acceleration[i] += p->mobility[i * k + j] * (input[j] + (side == CPL_EXPORT_BOTH ? particles[j] : 0));
    for (int i = 0; i < p->layout.nbody; i++)
      state[i] = s->body[i].state;
    put_motions(p, state, acceleration);
  }
  free(acceleration);
  free(state);
  if (side != CPL_EXPORT_MBD)
    put_loads(p, s->load);
  for (int r = 0; r < CPL_NROLE; r++)
    if (cpl_export_has(side, (cpl_role)r))
      put_channels(p, (cpl_role)r, s->partner[r].initial);
  return err->status;
}

tdm_status cpl_perform_start(cpl_performance *p, cpl_stage *stage, bool inputs_at_end, const double *input,
                             tdm_error *err) {
  const size_t n = (size_t)stage->settings.nbody, k = 6 * n;
  *p = (cpl_performance){
      .stage = stage, .layout = cpl_export_layout_of(stage->side, &stage->session), .inputs_at_end = inputs_at_end};
  p->now.at = calloc(n + 1, sizeof *p->now.at);
  p->start = calloc(n + 1, sizeof *p->start);
  p->end = calloc(n + 1, sizeof *p->end);
  p->output = calloc((size_t)cpl_export_noutput(&p->layout) + 1, sizeof *p->output);
  const bool tells = stage->side != CPL_EXPORT_DEM && stage->session.mobility.Y;
  p->mobility = tells ? calloc(k * k + 1, sizeof *p->mobility) : NULL;
  if (!p->now.at || !p->start || !p->end || !p->output || (tells && !p->mobility))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (size_t i = 0; i < n; i++)
    p->now.at[i] = stage->session.body[i].state;
  if (stage->side == CPL_EXPORT_BOTH) {
    p->looping = true;
    if (cpl_loop_init(&p->loop, &stage->settings, &stage->session, err) != TDM_OK)
      return err->status;
  }
  return look_at_start(p, input, err);
}

void cpl_perform_free(cpl_performance *p) {
  if (p->looping)
    cpl_loop_free(&p->loop);
  for (int k = 0; k < GUEST_SLOTS_MAX; k++)
    free(p->kept[k].at);
  free(p->now.at);
  free(p->start);
  free(p->end);
  free(p->output);
  free(p->mobility);
  *p = (cpl_performance){0};
}

/* ---- steps ---- */

/* DEM steps of a step by h; 0: refused. */
static uint64_t count_steps(const cpl_performance *p, double h, bool *refused, tdm_error *err) {
  const cpl_settings *s = &p->stage->settings;
  const double n = h / s->dt, whole = round(n);
  *refused = !(whole >= 1) || fabs(n - whole) > 1e-4;
  if (*refused)
    tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
             "a communication step of %.9g s is no whole number of DEM steps of %.9g s (time.dt); the nearest that "
             "fits is %.9g s",
             h, s->dt, fmax(whole, 1) * s->dt);
  return *refused ? 0 : (uint64_t)whole;
}

static void count(cpl_performance *p, const tdm_step *step) {
  p->now.step += step->nstep;
  p->now.window++;
  p->now.t = step->t1;
}

/* SLERP takes the short way, and a linear prediction ends. */
static tdm_status check_turns(const cpl_performance *p, double h, bool *refused, tdm_error *err) {
  const double most = 1; /* [rad] */
  for (int i = 0; i < p->layout.nbody; i++) {
    const double turn = tdm_norm(tdm_quat_turn(p->start[i].pose.orientation, p->end[i].pose.orientation));
    *refused = turn > most || tdm_norm(p->end[i].twist.angular) * h > most;
    if (*refused)
      return tdm_fail(err, TDM_ERR_NUMERIC, NULL,
                      "body \"%s\" turns by %.3g rad in a communication step of %.9g s; up to %g rad is followed: take "
                      "a shorter step",
                      p->stage->settings.body[i].name[CPL_DEM], fmax(turn, tdm_norm(p->end[i].twist.angular) * h), h,
                      most);
  }
  return TDM_OK;
}

static tdm_status step_dem(cpl_performance *p, double h, const double *input, bool *refused, tdm_error *err) {
  const double dt = p->stage->settings.dt;
  const int nbody = p->layout.nbody;
  const uint64_t n = count_steps(p, h, refused, err);
  if (n == 0)
    return err->status;
  *refused = cpl_perform_states(&p->stage->settings, input, p->end, err) != TDM_OK;
  if (*refused)
    return err->status;
  for (int i = 0; i < nbody; i++) {
    p->start[i] = p->now.at[i];
    if (p->inputs_at_end)
      continue;
    p->start[i].twist = p->end[i].twist;
    p->end[i] = cpl_predict(&p->end[i], input + i * CPL_MOTION + TDM_STATE_DOUBLES, (double)n * dt);
  }
  if (check_turns(p, (double)n * dt, refused, err) != TDM_OK)
    return err->status;
  const double t1 = (double)(p->now.step + n) * dt;
  const tdm_step step = {.window = p->now.window,
                         .t0 = (double)p->now.step * dt,
                         .t1 = t1,
                         .nstep = n,
                         .nbody = nbody,
                         .nstate = nbody,
                         .start = p->start,
                         .end = p->end,
                         .nsample = 1,
                         .sample_time = &t1};
  tdm_result result;
  if (cpl_session_step(session_of(p), CPL_DEM, &step, &result, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < nbody && result.ninterface > 0; i++)
    result.load[i] = result.body[i].moment[0];
  put_loads(p, result.load);
  put_channels(p, CPL_DEM, result.channel);
  memcpy(p->now.at, p->end, (size_t)nbody * sizeof *p->end);
  count(p, &step);
  return TDM_OK;
}

static tdm_status step_mbd(cpl_performance *p, double h, const double *input, tdm_error *err) {
  const double t1 = p->now.t + h;
  const tdm_step step = {.window = p->now.window,
                         .t0 = p->now.t,
                         .t1 = t1,
                         .nstep = (uint64_t)fmax(round(h / p->stage->settings.dt), 1),
                         .nbody = p->layout.nbody,
                         .nload = 1,
                         .load = (const tdm_wrench *)(const void *)input,
                         .nsample = 1,
                         .sample_time = &t1};
  tdm_result result;
  if (cpl_session_step(session_of(p), CPL_MBD, &step, &result, err) != TDM_OK)
    return err->status;
  put_motions(p, result.state, result.acceleration);
  put_mobility(p, &result.mobility);
  put_channels(p, CPL_MBD, result.channel);
  count(p, &step);
  return TDM_OK;
}

static tdm_status step_both(cpl_performance *p, double h, const double *input, bool *refused, tdm_error *err) {
  static const cpl_observers nobody = {0};
  cpl_loop *loop = &p->loop;
  const bool adapts = p->stage->settings.adapt.on;
  const cpl_too_long *too_long = &loop->too_long;
  const uint64_t n = count_steps(p, h, refused, err), end = loop->step1 + n;
  if (n == 0)
    return err->status;
  cpl_loop_press(loop, (const tdm_wrench *)(const void *)input);
  loop->next_sample = end; /* the output interval is time.dt: one sample, at the end */
  while (loop->step1 < end) {
    const long wanted = adapts ? loop->n : p->stage->settings.n, left = (long)(end - loop->step1);
    const uint64_t before = too_long->taken_back + too_long->kept;
    loop->n = wanted < left ? wanted : left;
    if (cpl_loop_advance(loop, &nobody, err) != TDM_OK)
      return err->status;
    const bool too_far = too_long->taken_back + too_long->kept > before;
    if (adapts && wanted > left &&
        !too_far) /* a window that was cut, and not too long, tells nothing of the next one */
      loop->n = wanted;
  }
  p->now.t = loop->t1;
  put_motions(p, loop->state_end, loop->result[CPL_MBD].acceleration);
  put_mobility(p, &loop->result[CPL_MBD].mobility);
  put_loads(p, loop->result[CPL_DEM].sample_load);
  for (int r = 0; r < CPL_NROLE; r++)
    put_channels(p, (cpl_role)r, loop->result[r].channel);
  return TDM_OK;
}

tdm_status cpl_perform_step(cpl_performance *p, double t, double h, const double *input, bool *refused,
                            tdm_error *err) {
  const cpl_settings *s = &p->stage->settings;
  const double slack = 1e-3 * s->dt, end = (double)cpl_total_steps(s) * s->dt;
  *refused = true;
  if (!(h > 0) || !isfinite(h))
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "a communication step of %g s; its length must be above 0", h);
  if (!(fabs(t - p->now.t) <= fmax(slack, 1e-9 * fabs(t))))
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                    "a communication step begins %.9g s after the start, but the last one ended %.9g s after it", t,
                    p->now.t);
  if (p->now.t + h > end + 2 * slack) /* the tool's stop time the FMU's binary looks at, and never comes here */
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                    "a communication step of %.9g s leads beyond the end of the scene (time.end), %.9g s after the "
                    "start; give the experiment a stop time, or export the FMU with a later time.end",
                    h, end);
  *refused = false;
  return p->stage->side == CPL_EXPORT_DEM   ? step_dem(p, h, input, refused, err)
         : p->stage->side == CPL_EXPORT_MBD ? step_mbd(p, h, input, err)
                                            : step_both(p, h, input, refused, err);
}

/* ---- states ---- */

enum { FIRST_SLOT = CPL_SLOT_WINDOW + 1 }; /* those before are the loop's */

tdm_status cpl_perform_keep(cpl_performance *p, int slot, tdm_error *err) {
  cpl_performed *to = &p->kept[slot];
  const size_t n = (size_t)p->layout.nbody;
  tdm_state *at = to->at ? to->at : calloc(n + 1, sizeof *at);
  if (!at)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  *to = p->now;
  to->at = at;
  memcpy(at, p->now.at, n * sizeof *at);
  if (p->looping)
    return cpl_loop_save(&p->loop, FIRST_SLOT + slot, err);
  return cpl_session_save(session_of(p), p->stage->side == CPL_EXPORT_DEM ? CPL_DEM : CPL_MBD, FIRST_SLOT + slot, err);
}

tdm_status cpl_perform_restore(cpl_performance *p, int slot, tdm_error *err) {
  tdm_state *at = p->now.at;
  if (!p->kept[slot].at)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "nothing is kept there");
  if (p->looping)
    cpl_loop_restore(&p->loop, FIRST_SLOT + slot, err);
  else
    cpl_session_restore(session_of(p), p->stage->side == CPL_EXPORT_DEM ? CPL_DEM : CPL_MBD, FIRST_SLOT + slot, err);
  p->now = p->kept[slot];
  p->now.at = at;
  memcpy(at, p->kept[slot].at, (size_t)p->layout.nbody * sizeof *at);
  return err->status;
}
