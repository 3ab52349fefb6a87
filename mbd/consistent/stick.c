/* Friction that sticks: see stick.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/consistent/stick.h"

#include "mbd/consistent/consistent.h"
#include "mbd/joint/frame.h"
#include "mbd/mechanics/normal.h"
#include "protocol/base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A rate is past zero when it is this much beyond [m/s, rad/s], and this share of the velocities of which it is the
 * difference: rounding and the integrators' errors are not. Where modes are chosen ten times that is rest. */
static const double past_zero = 1e-10, past_share = 1e-9;
/* the share by which a multiplier must exceed its limit */
static const double excess = 1e-9;

static const mbd_force *friction_of(const mbd_model *model, int k) {
  return &model->force[model->friction[k]];
}

/* The coordinate's row at data->kin; its value in *x, the rate in *rate. */
static void coordinate_row(const mbd_model *model, mbd_data *data, int k, bool second, mbd_rows *rows, double *x,
                           double *rate) {
  const mbd_force *f = friction_of(model, k);
  const double from = f->coordinate == MBD_ANGLE ? data->angle[model->friction[k]] : 0;
  double twist[MBD_PAIR];
  rows->n = 0;
  rows->second = second;
  mbd_joint_coordinate(f->joint, f->coordinate, &data->kin[f->body[0] + 1], &data->kin[f->body[1] + 1], from, rows);
  memcpy(rows->body, f->body, sizeof rows->body);
  mbd_pair_twist(&data->kin[f->body[0] + 1], &data->kin[f->body[1] + 1], twist);
  *x = from + rows->g[0];
  *rate = 0;
  for (int c = 0; c < MBD_PAIR; c++)
    *rate += rows->G[0][c] * twist[c];
}

/* The rate of the coordinate at data->kin, and in *zero how much of it may be none. */
static double rate_of(const mbd_model *model, mbd_data *data, int k, double *zero) {
  mbd_rows rows;
  double x, rate, twist[MBD_PAIR];
  coordinate_row(model, data, k, false, &rows, &x, &rate);
  mbd_pair_twist(&data->kin[rows.body[0] + 1], &data->kin[rows.body[1] + 1], twist);
  *zero = past_zero;
  for (int c = 0; c < MBD_PAIR; c++)
    *zero += past_share * fabs(rows.G[0][c] * twist[c]);
  return rate;
}

/* The largest force that friction k holds, at the last accelerations. */
static double limit_of(const mbd_model *model, mbd_data *data, int k) {
  const mbd_force *f = friction_of(model, k);
  return f->rubbing->hold * mbd_normal_at(model, data, f, data->lambda, false).normal;
}

/* By how much of its limit the multiplier of what sticks stays below it; negative: it exceeds it. */
static double reserve(const mbd_model *model, mbd_data *data, int k) {
  double limit = limit_of(model, data, k), force = fabs(data->lambda[friction_of(model, k)->rubbing->row]);
  double size = limit + force;
  return size > 0 ? ((1 + excess) * limit - force) / size : 1;
}

double mbd_stick_margin(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, const double *y) {
  bool any = false;
  double margin = INFINITY;
  for (int k = 0; k < model->nfriction; k++)
    any = any || data->stick[k].stuck;
  if (any && !mbd_accelerations(model, data, kkt, t, y))
    return -1;
  if (!any && model->nfriction > 0)
    mbd_kinematics(model, data, t, y);
  for (int k = 0; k < model->nfriction; k++) {
    const mbd_stick *s = &data->stick[k];
    double zero = 0, rate = s->stuck ? 0 : rate_of(model, data, k, &zero);
    margin = fmin(margin, s->stuck ? reserve(model, data, k) : s->way != 0 ? s->way * rate + zero : zero - fabs(rate));
  }
  return margin;
}

double mbd_stick_locate(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double from, double to,
                        mbd_unknowns_fn unknowns, void *context) {
  enum { TRIALS_MAX = 60 };
  const double enough = 1e-11;
  const double *y = unknowns(context, from), resolution = 4e-16 * fmax(fabs(from), fabs(to));
  double before = y ? mbd_stick_margin(model, data, kkt, from, y) : 0, after;
  y = unknowns(context, to);
  after = y ? mbd_stick_margin(model, data, kkt, to, y) : -1;
  /* Illinois' false position, halving where it does not close in */
  for (int i = 0; i < TRIALS_MAX && to - from > resolution && !(after > -enough && after < 0); i++) {
    double share = i % 4 == 3 || !(before > 0) ? 0.5 : before / (before - after), middle = from + share * (to - from);
    if (!(middle > from && middle < to))
      middle = from + 0.5 * (to - from);
    y = unknowns(context, middle);
    double margin = y ? mbd_stick_margin(model, data, kkt, middle, y) : -1;
    if (margin >= 0) {
      from = middle;
      before = margin;
      after *= 0.5;
    } else {
      to = middle;
      after = margin;
      before *= 0.5;
    }
  }
  return to;
}

double mbd_stick_end(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double from, double to, int nsample,
                     const double *sample_time, const double *y, mbd_unknowns_fn unknowns, void *context) {
  const double middle = from + 0.5 * (to - from);
  if (model->nfriction == 0)
    return INFINITY;
  for (double before = from, at; before < to; before = at) {
    at = before < middle ? middle : to;
    while (nsample > 0 && *sample_time <= before)
      nsample--, sample_time++;
    at = !context ? to : nsample > 0 ? fmin(at, *sample_time) : at;
    const double *state = at < to ? unknowns(context, at) : y;
    if (state && mbd_stick_margin(model, data, kkt, at, state) < 0)
      return context ? mbd_stick_locate(model, data, kkt, before, at, unknowns, context) : to;
  }
  return INFINITY;
}

tdm_status mbd_stick_refuse(double t, tdm_error *err) {
  return tdm_fail(err, TDM_ERR_NUMERIC, "mbd",
                  "no accelerations at t = %.9g s where friction begins or ceases to stick; check the coefficients of "
                  "friction, which may jam a joint, and masses",
                  t);
}

/* ---- choosing modes ---- */

/* what is known of a friction while modes are chosen */
typedef struct {
  bool resting;  /* its rate is zero */
  bool released; /* it stuck, and its limit was exceeded */
  int turns;     /* how often it was made to stick again */
} choice;

/* Give friction k its row, unless the rows in use hold its coordinate already. false: the system is singular. */
static bool hold(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, int k, bool *held) {
  const double share = 1e-9; /* of its freedom that the other rows leave it at least */
  mbd_stick *s = &data->stick[k];
  mbd_rows rows;
  double x, rate, *f = data->shift, give = 0;
  *held = false;
  coordinate_row(model, data, k, false, &rows, &x, &rate);
  memset(f, 0, 6 * (size_t)model->nbody * sizeof *f);
  for (int c = 0; c < MBD_PAIR; c++)
    if (rows.body[c / 6] != MBD_GROUND)
      f[6 * rows.body[c / 6] + c % 6] += rows.G[0][c];
  if (!mbd_kkt_fill(kkt, model, data, MBD_VELOCITY))
    return false;
  memset(mbd_kkt_b(kkt), 0, (size_t)model->nrow * sizeof(double));
  const double *response = mbd_kkt_solve(kkt, f);
  for (int i = 0; i < 6 * model->nbody && response; i++)
    give += f[i] * response[i];
  if (give > share * mbd_row_mobility(model, data, &rows, 0)) {
    s->stuck = *held = true;
    s->hold = x;
    data->dependent[friction_of(model, k)->rubbing->row] = false;
  }
  return response != NULL;
}

static void let_go(const mbd_model *model, mbd_data *data, int k, int way) {
  data->stick[k].stuck = false;
  data->stick[k].way = way;
  data->dependent[friction_of(model, k)->rubbing->row] = true;
}

/* Modes to begin with: what moves slides, what rests sticks; what has stuck before comes first and keeps its place. */
static bool begin(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, const double *y, choice *c) {
  bool held, good = true;
  mbd_kinematics(model, data, t, y);
  for (int k = 0; k < model->nfriction; k++) {
    double zero, rate = rate_of(model, data, k, &zero);
    c[k].resting = data->stick[k].stuck || fabs(rate) <= 10 * zero;
    if (!c[k].resting)
      data->stick[k].way = rate > 0 ? 1 : -1;
    else if (!data->stick[k].stuck)
      data->stick[k].way = 0;
  }
  for (int k = 0; k < model->nfriction && good; k++)
    if (c[k].resting && !data->stick[k].stuck && friction_of(model, k)->rubbing->hold > 0)
      good = hold(model, data, kkt, k, &held);
  return good;
}

/* What sticks beyond its limit by most is let go; others that rest may then hold what it held. */
static bool let_go_worst(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, choice *c, bool *changed) {
  int worst = -1;
  double least = 0;
  bool held, good = true;
  for (int k = 0; k < model->nfriction; k++) {
    double left = data->stick[k].stuck ? reserve(model, data, k) : 0;
    if (left < least)
      least = left, worst = k;
  }
  *changed = worst >= 0;
  if (worst < 0)
    return true;
  c[worst].released = true;
  let_go(model, data, worst, data->lambda[friction_of(model, worst)->rubbing->row] > 0 ? 1 : -1);
  for (int k = 0; k < model->nfriction && good; k++)
    if (c[k].resting && !c[k].released && !data->stick[k].stuck && friction_of(model, k)->rubbing->hold > 0)
      good = hold(model, data, kkt, k, &held);
  return good;
}

/* Acceleration of the coordinate of friction k at the last accelerations, and what its limit would make of it. */
static double acceleration_of(const mbd_model *model, mbd_data *data, int k, double *scale) {
  mbd_rows rows;
  double x, rate, sum = 0, twist[MBD_PAIR];
  coordinate_row(model, data, k, true, &rows, &x, &rate);
  mbd_pair_twist(&data->kin[rows.body[0] + 1], &data->kin[rows.body[1] + 1], twist);
  for (int i = 0; i < MBD_PAIR; i++) {
    if (rows.body[i / 6] != MBD_GROUND)
      sum += rows.G[0][i] * data->acceleration[6 * rows.body[i / 6] + i % 6];
    for (int j = 0; j < MBD_PAIR; j++)
      sum += twist[i] * rows.H[0][i][j] * twist[j];
  }
  *scale = limit_of(model, data, k) * mbd_row_mobility(model, data, &rows, 0);
  return sum;
}

/* What rests without a row but is about to move against its way sticks, or turns its way where others move it. */
static bool turn_one(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, choice *c, bool *changed) {
  enum { TURNS_MAX = 2 };
  *changed = false;
  for (int k = 0; k < model->nfriction; k++) {
    mbd_stick *s = &data->stick[k];
    double scale, a = c[k].resting && !s->stuck ? acceleration_of(model, data, k, &scale) : 0;
    int way = a > 0 ? 1 : -1;
    bool held = false;
    if (!c[k].resting || s->stuck || s->way == way || !(fabs(a) > 1e-7 * scale))
      continue;
    if (c[k].turns++ < TURNS_MAX && friction_of(model, k)->rubbing->hold > 0 && !hold(model, data, kkt, k, &held))
      return false;
    if (held)
      c[k].released = false;
    else
      s->way = way;
    *changed = true;
    return true;
  }
  return true;
}

static bool choose(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, const double *y, choice *c) {
  bool changed = true, good = begin(model, data, kkt, t, y, c);
  for (int i = 0; i < 20 * (model->nfriction + 1) && changed && good; i++) {
    good = mbd_accelerations(model, data, kkt, t, y) && let_go_worst(model, data, kkt, c, &changed);
    if (good && !changed)
      good = turn_one(model, data, kkt, c, &changed);
  }
  return good;
}

bool mbd_stick_settle(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y, bool *changed) {
  if (changed)
    *changed = false;
  if (model->nfriction == 0)
    return true;
  const size_t n = (size_t)model->nfriction;
  choice *c = calloc(n, sizeof *c);
  mbd_stick *before = malloc(n * sizeof *before);
  bool good = c && before, sticks = false;
  if (!good)
    tdm_memory_note();
  if (good) {
    memcpy(before, data->stick, n * sizeof *before);
    good = choose(model, data, kkt, t, y, c);
  }
  for (size_t k = 0; k < n && good; k++) {
    const mbd_stick *now = &data->stick[k];
    sticks = sticks || (now->stuck && (!before[k].stuck || before[k].hold != now->hold));
    if (changed && (now->stuck != before[k].stuck || (!now->stuck && now->way != before[k].way)))
      *changed = true;
  }
  free(c);
  free(before);
  return good && (!sticks || mbd_project(model, data, kkt, t, y));
}

double mbd_stick_force(const mbd_model *model, const mbd_data *data, int k, const mbd_force_value *value) {
  return data->stick[k].stuck ? data->lambda[friction_of(model, k)->rubbing->row] : value->value;
}
