/* Windows of the coupled loop: see window.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/loop/window.h"

#include "coupler/state/mismatch.h"
#include "coupler/state/path.h"

#include <math.h>
#include <string.h>

/* A body that turns fast may have grown out of the window that its error allows: SLERP takes the short way. */
static long limit_turn(const cpl_loop *loop, long n) {
  const double most = 0.5; /* [rad] */
  double rate = 0;
  for (int i = 0; i < loop->nbody; i++)
    rate = fmax(rate, tdm_norm(loop->state_start[i].twist.angular));
  double limit = most / (rate * loop->settings->dt);
  return (double)n <= limit ? n : limit > 1 ? (long)limit : 1;
}

/* Work of the loads from elsewhere on a body over the window [J]. They are held: of a moment it is that about the axis
 * by which the body has turned, and a window's turn is below 1 rad. */
static double work_from_elsewhere(const cpl_loop *loop, int i) {
  const tdm_state *from = &loop->state_start[i], *to = &loop->state_end[i];
  const tdm_wrench *held = &loop->external[i];
  return tdm_dot(held->force, tdm_sub(to->pose.position, from->pose.position)) +
         tdm_dot(held->moment, tdm_quat_turn(from->pose.orientation, to->pose.orientation));
}

cpl_exchange cpl_loop_exchange(const cpl_loop *loop) {
  const tdm_result *mbd = &loop->result[CPL_MBD], *dem = &loop->result[CPL_DEM];
  cpl_exchange x = loop->exchange;
  for (int i = 0; i < loop->nbody; i++)
    if (loop->prescribed[i])
      return x;
  if (!mbd->has_energy || dem->ninterface == 0)
    return x;
  x.made += mbd->energy->exchanged - x.exchanged;
  x.exchanged = mbd->energy->exchanged;
  for (int i = 0; i < loop->nbody; i++) {
    x.made -= dem->body[i].work + dem->body[i].blending + work_from_elsewhere(loop, i);
    x.worked += fabs(dem->body[i].work);
  }
  return x;
}

/* The part of its tolerance that a window is allowed: all of it, unless the exchange has made more than half the
 * tolerance of all the work that went through it. */
static double allowance(const cpl_loop *loop) {
  const double least =
      0.2; /* windows two thirds as long: where DEM's step itself makes that energy they mend nothing */
  const double half = 0.5 * loop->settings->adapt.tolerance * loop->exchange.worked, made = fabs(loop->exchange.made);
  return made > half ? fmax(least, (half / made) * (half / made)) : 1;
}

/* The mismatch of the window beside what is allowed, of the worst body. */
static double excess_of(const cpl_loop *loop) {
  const cpl_auto *s = &loop->settings->adapt;
  const double part = allowance(loop);
  double worst = 0, apart[CPL_APART];
  for (int i = 0; i < loop->nbody; i++) {
    cpl_apart(&loop->state_end[i], &loop->dem_end[i], loop->radius[i], loop->t1 - loop->t0, apart);
    double is = cpl_length(CPL_APART, apart);
    if (is > 0)
      worst = fmax(worst, is / (part * (s->tolerance * cpl_motion(loop, i) + s->absolute)));
  }
  return worst;
}

static void add_sample(cpl_loop *loop, double time, double row) {
  loop->sample_time[loop->nsample] = time;
  loop->row_time[loop->nsample++] = row;
}

/* The ends of the next window, and the output times in it. */
static void open_window(cpl_loop *loop) {
  const cpl_settings *s = loop->settings;
  uint64_t total = cpl_total_steps(s);
  if (s->adapt.on) {
    const long reach = cpl_path_reach(loop);
    loop->n = limit_turn(loop, loop->n < reach ? loop->n : reach > 1 ? reach : 1);
  }
  const uint64_t n = (uint64_t)loop->n;
  loop->step0 = loop->step1;
  loop->step1 = n < total - loop->step0 ? loop->step0 + n : total;
  if (loop->step1 - loop->step0 == n) {
    loop->n_least = loop->n_least && loop->n_least < loop->n ? loop->n_least : loop->n;
    loop->n_most = loop->n_most > loop->n ? loop->n_most : loop->n;
  }
  loop->t0 = (double)loop->step0 * s->dt;
  loop->t1 = (double)loop->step1 * s->dt;
  loop->too_far = false;
  loop->sent_start = loop->sent_end = NULL;
  loop->correction = NULL;
  loop->nsample = 0;
  while (true) {
    double time = (double)loop->next_sample * s->output_interval;
    if (time > loop->t1 + 1e-6 * s->dt)
      break;
    add_sample(loop, time < loop->t1 ? time : loop->t1, time);
    loop->next_sample++;
  }
  /* the last state, on the grid or not */
  if (loop->step1 == total && (double)(loop->next_sample - 1) * s->output_interval < loop->t1 - 1e-6 * s->dt)
    add_sample(loop, loop->t1, loop->t1);
}

static tdm_status solve(cpl_loop *loop, tdm_error *err) {
  open_window(loop);
  if (cpl_path_open(loop, err) != TDM_OK)
    return err->status;
  return loop->scheme->advance(loop, err);
}

static void count_too_long(cpl_loop *loop, uint64_t *which) {
  if (loop->too_long.taken_back + loop->too_long.kept == 0)
    loop->too_long.first = loop->t0;
  ++*which;
}

/* A window of "n": "auto": solved again, shorter, as long as it is far too long and both solvers can go back; and the
 * length of the next one. */
static tdm_status solve_adaptive(cpl_loop *loop, tdm_error *err) {
  const cpl_auto *s = &loop->settings->adapt;
  const bool can_shrink = loop->goes_back && loop->n > s->n_min;
  if (can_shrink && cpl_loop_save(loop, CPL_SLOT_WINDOW, err) != TDM_OK)
    return err->status;
  while (true) {
    const tdm_status status = solve(loop, err);
    if (status != TDM_OK && !loop->too_far)
      return status;
    const double excess = status == TDM_OK ? excess_of(loop) : INFINITY;
    const long steps = (long)(loop->step1 - loop->step0);
    const bool shrinks = can_shrink && steps > s->n_min;
    if (!cpl_adapt_too_long(excess) || !shrinks) {
      if (cpl_adapt_too_long(excess))
        count_too_long(loop, &loop->too_long.kept);
      const long next = cpl_adapt_next(s, loop->scheme->mismatch_order, loop->n, excess);
      loop->growth = (double)next / (double)loop->n;
      loop->n = next;
      if (status == TDM_OK)
        loop->exchange = cpl_loop_exchange(loop);
      return status;
    }
    count_too_long(loop, &loop->too_long.taken_back);
    *err = (tdm_error){0};
    if (cpl_loop_restore(loop, CPL_SLOT_WINDOW, err) != TDM_OK)
      return err->status;
    loop->n = cpl_adapt_next(s, loop->scheme->mismatch_order, steps, excess);
  }
}

tdm_status cpl_loop_advance(cpl_loop *loop, const cpl_observers *observers, tdm_error *err) {
  if ((loop->settings->adapt.on ? solve_adaptive(loop, err) : solve(loop, err)) != TDM_OK)
    return err->status;
  if (loop->scheme->keep)
    loop->scheme->keep(loop);
  if (!cpl_session_has(loop->session, CPL_MBD, "ahead"))
    cpl_path_doubt(loop);
  for (int i = 0; i < loop->nbody; i++)
    loop->speed[i] = fmax(loop->speed[i], cpl_speed(&loop->state_end[i], loop->radius[i]));
  cpl_observers_window(observers, loop, err);
  memcpy(loop->state_start, loop->state_end, (size_t)loop->nbody * sizeof *loop->state_end);
  if (loop->proxy_size > 0)
    cpl_loop_keep_mechanism(loop, loop->result[CPL_MBD].acceleration, &loop->result[CPL_MBD].mobility);
  cpl_path_keep(loop, &loop->result[CPL_MBD].path);
  loop->window++;
  return err->status;
}
