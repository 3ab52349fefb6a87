/* Output channels: see output.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/adapter/output.h"

#include "mbd/assembly/balance.h"
#include "mbd/assembly/stick.h"
#include "mbd/joint/frame.h"
#include "mbd/mechanics/energy.h"

#include <stdio.h>
#include <string.h>

static bool is_coupled(const mbd_model *model, int body) {
  for (int i = 0; i < model->ncoupled; i++)
    if (model->coupled[i] == body)
      return true;
  return false;
}

enum {
  JOINT_CHANNELS = 6,
  DRIVER_CHANNELS = 3,
  FORCE_CHANNELS = 2 + 6,
  BODY_CHANNELS = 19,
  ENERGY_CHANNELS = 6,
  COMPONENT_CHANNELS = 6
};

/* one for each coordinate and rate that joints leave free */
static int coordinate_channels(const mbd_model *model) {
  int n = 0;
  for (int i = 0; i < model->njoint; i++)
    for (int which = 0; which < 2; which++)
      n += model->joint[i].ops->coordinates & (1u << which) ? 2 : 0;
  return n;
}

/* rotation and components of bushings, and which way frictions slide */
static int further_channels(const mbd_model *model) {
  int n = 0;
  for (int i = 0; i < model->nforce; i++)
    n += (model->force[i].ops->turns ? 1 + COMPONENT_CHANNELS : 0) + (model->force[i].rubbing != NULL);
  return n;
}

int mbd_output_count(const mbd_model *model) {
  return JOINT_CHANNELS * model->njoint + DRIVER_CHANNELS * model->ndriver + FORCE_CHANNELS * model->nforce +
         BODY_CHANNELS * (model->nbody - model->ncoupled) + ENERGY_CHANNELS + 1 + coordinate_channels(model) +
         further_channels(model);
}

static tdm_channel *name(tdm_channel *c, const char *group, const char *of, const char *what, const char *unit) {
  snprintf(c->name, sizeof c->name, "%s.%s%s%s", group, of, *of ? "." : "", what);
  snprintf(c->unit, sizeof c->unit, "%s", unit);
  return c + 1;
}

void mbd_output_names(const mbd_model *model, tdm_channel *c) {
  static const char *const wrench[JOINT_CHANNELS][2] = {{"fx", "N"},   {"fy", "N"},   {"fz", "N"},
                                                        {"mx", "N m"}, {"my", "N m"}, {"mz", "N m"}};
  static const char *const state[BODY_CHANNELS][2] = {
      {"x", "m"},      {"y", "m"},           {"z", "m"},           {"qw", "1"},         {"qx", "1"},
      {"qy", "1"},     {"qz", "1"},          {"vx", "m/s"},        {"vy", "m/s"},       {"vz", "m/s"},
      {"wx", "rad/s"}, {"wy", "rad/s"},      {"wz", "rad/s"},      {"ax", "m/s2"},      {"ay", "m/s2"},
      {"az", "m/s2"},  {"alphax", "rad/s2"}, {"alphay", "rad/s2"}, {"alphaz", "rad/s2"}};
  static const char *const component[COMPONENT_CHANNELS][2] = {{"ux", "m"},     {"uy", "m"},     {"uz", "m"},
                                                               {"phix", "rad"}, {"phiy", "rad"}, {"phiz", "rad"}};
  for (int i = 0; i < model->njoint; i++)
    for (int k = 0; k < JOINT_CHANNELS; k++)
      c = name(c, "joint", model->joint[i].name, wrench[k][0], wrench[k][1]);
  for (int i = 0; i < model->njoint; i++)
    for (int which = 0; which < 2; which++) {
      const mbd_coordinate_words *w = &mbd_coordinate_table[which];
      if (!(model->joint[i].ops->coordinates & (1u << which)))
        continue;
      c = name(c, "joint", model->joint[i].name, w->name, w->unit);
      c = name(c, "joint", model->joint[i].name, w->rate, w->rate_unit);
    }
  for (int i = 0; i < model->ndriver; i++) {
    const mbd_coordinate_words *w = &mbd_coordinate_table[model->driver[i].ops->coordinate];
    c = name(c, "driver", model->driver[i].name, w->effort, w->effort_unit);
    c = name(c, "driver", model->driver[i].name, w->name, w->unit);
    c = name(c, "driver", model->driver[i].name, w->rate, w->rate_unit);
  }
  for (int i = 0; i < model->nforce; i++) {
    const mbd_force *f = &model->force[i];
    const mbd_coordinate_words *w = f->ops->value_unit ? NULL : &mbd_coordinate_table[f->coordinate];
    c = name(c, "force", f->name, "value", w ? w->effort_unit : f->ops->value_unit);
    c = name(c, "force", f->name, w ? w->name : f->ops->coordinate_name, w ? w->unit : f->ops->coordinate_unit);
    if (f->ops->turns)
      c = name(c, "force", f->name, "rotation", "rad");
    for (int k = 0; k < COMPONENT_CHANNELS && f->ops->turns; k++)
      c = name(c, "force", f->name, component[k][0], component[k][1]);
    if (f->rubbing)
      c = name(c, "force", f->name, "sliding", "1");
    for (int k = 0; k < JOINT_CHANNELS; k++)
      c = name(c, "force", f->name, wrench[k][0], wrench[k][1]);
  }
  for (int b = 0; b < model->nbody; b++)
    for (int k = 0; k < BODY_CHANNELS && !is_coupled(model, b); k++)
      c = name(c, "body", model->body[b].name, state[k][0], state[k][1]);
  static const char *const energies[ENERGY_CHANNELS] = {"kinetic",  "potential",  "springs",
                                                        "supplied", "dissipated", "balance"};
  for (int k = 0; k < ENERGY_CHANNELS; k++)
    c = name(c, "energy", "", energies[k], "J");
  name(c, "constraint", "", "drift", "m");
}

/* Force and moment of a joint on its second body at its joint point, world axes: -G^T lambda, its moment moved from the
 * centre of mass to the point. Parts add up. */
static void reactions(const mbd_model *model, mbd_data *data, const double *lambda, double *out) {
  memset(out, 0, JOINT_CHANNELS * (size_t)model->njoint * sizeof(double));
  for (int i = 0; i < model->njointpart; i++) {
    const mbd_rows *rows = mbd_part_at(model, data, i, false);
    const mbd_joint *j = model->part[i].joint;
    for (int side = 0; side < 2; side++) {
      if (rows->body[side] != j->body[1])
        continue;
      double wrench[6] = {0}, *at = out + JOINT_CHANNELS * (j - model->joint);
      for (int k = 0; k < rows->n; k++)
        for (int c = 0; c < 6; c++)
          wrench[c] -= rows->G[k][6 * side + c] * lambda[rows->first + k];
      tdm_vec3 force = mbd_get3(wrench), arm = mbd_joint_arm(j, 1, &data->kin[j->body[1] + 1]);
      mbd_put3(at, 1, force);
      mbd_put3(at + 3, 1, tdm_sub(mbd_get3(wrench + 3), tdm_cross(arm, force)));
    }
  }
}

static double row_rate(const mbd_data *data, const mbd_rows *rows) {
  double twist[MBD_PAIR], rate = 0;
  mbd_pair_twist(&data->kin[rows->body[0] + 1], &data->kin[rows->body[1] + 1], twist);
  for (int k = 0; k < MBD_PAIR; k++)
    rate += rows->G[0][k] * twist[k];
  return rate;
}

/* Coordinates that joints leave free, and their rates. Returns the end of what it filled. */
static double *coordinates(const mbd_model *model, mbd_data *data, double *out) {
  for (int i = 0; i < model->njoint; i++)
    for (int which = 0; which < 2; which++) {
      const mbd_joint *j = &model->joint[i];
      if (!(j->ops->coordinates & (1u << which)))
        continue;
      double from = which == MBD_ANGLE ? data->turn[i] : 0;
      mbd_rows *rows = &data->rows;
      rows->n = 0;
      rows->second = false;
      memcpy(rows->body, j->body, sizeof rows->body);
      mbd_joint_coordinate(j, (mbd_coordinate)which, &data->kin[j->body[0] + 1], &data->kin[j->body[1] + 1], from,
                           rows);
      *out++ = from + rows->g[0];
      *out++ = row_rate(data, rows);
    }
  return out;
}

/* Effort on the second body, the coordinate where it is (not where it should be) and its rate. */
static void drive(const mbd_model *model, mbd_data *data, int index, const double *lambda, double *out) {
  const mbd_driver *d = &model->driver[index];
  const mbd_rows *rows = mbd_part_at(model, data, model->njointpart + index, false);
  out[0] = -lambda[d->row];
  out[1] = tdm_motion_at(&d->motion, data->now).value + rows->g[0];
  out[2] = row_rate(data, rows);
}

/* Force and moment of a force on its second body at its point there, world axes. A friction that sticks has them from
 * its row. */
static void force_wrench(const mbd_model *model, mbd_data *data, const mbd_force *f, const double *Q, double *out) {
  const mbd_joint *frame = f->joint ? f->joint : &f->frame;
  double at_centre[6];
  memcpy(at_centre, Q + MBD_RB, sizeof at_centre);
  if (f->rubbing) {
    const mbd_rows *rows = mbd_part_at(model, data, model->njointpart + model->ndriver + f->rubbing->stick, false);
    for (int k = 0; k < 6; k++)
      at_centre[k] -= rows->G[0][MBD_RB + k] * data->lambda[f->rubbing->row];
  }
  tdm_vec3 force = mbd_get3(at_centre), arm = mbd_joint_arm(frame, 1, &data->kin[f->body[1] + 1]);
  mbd_set3(out, force);
  mbd_set3(out + 3, tdm_sub(mbd_get3(at_centre + 3), tdm_cross(arm, force)));
}

/* Returns the end of what it filled. */
static double *force_values(const mbd_model *model, mbd_data *data, int index, double *out) {
  const mbd_force *f = &model->force[index];
  const mbd_force_value *value = mbd_force_at(model, data, index, false);
  double Q[MBD_PAIR];
  memcpy(Q, value->Q, sizeof Q);
  *out++ = f->rubbing ? mbd_stick_force(model, data, f->rubbing->stick, value) : value->value;
  *out++ = value->coordinate;
  if (f->ops->turns)
    *out++ = value->rotation;
  for (int k = 0; k < COMPONENT_CHANNELS && f->ops->turns; k++)
    *out++ = value->rows.g[k];
  if (f->rubbing)
    *out++ = value->way;
  force_wrench(model, data, f, Q, out);
  return out + JOINT_CHANNELS;
}

tdm_status mbd_output_values(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, const double *y,
                             double *out, tdm_error *err) {
  bool good = mbd_accelerations(model, data, kkt, t, y); /* sets data->kin and data->now */
  if (good && data->ndependent > 0)
    good = mbd_kkt_share(kkt, model, data, data->lambda);
  if (!good)
    return tdm_fail(err, TDM_ERR_NUMERIC, "mbd",
                    "no accelerations and joint reactions at t = %.9g s: the mechanism is in a singular position", t);
  if (mbd_check_balance(model, data, err))
    return err->status;
  reactions(model, data, data->lambda, out);
  out = coordinates(model, data, out + JOINT_CHANNELS * model->njoint);
  for (int i = 0; i < model->ndriver; i++, out += DRIVER_CHANNELS)
    drive(model, data, i, data->lambda, out);
  for (int i = 0; i < model->nforce; i++)
    out = force_values(model, data, i, out);
  for (int b = 0; b < model->nbody; b++) {
    if (is_coupled(model, b))
      continue;
    tdm_state s = mbd_body_state(y, b);
    tdm_quat q = s.pose.orientation;
    mbd_set3(out, s.pose.position);
    out[3] = q.w, out[4] = q.x, out[5] = q.y, out[6] = q.z;
    mbd_set3(out + 7, s.twist.velocity);
    mbd_set3(out + 10, s.twist.angular);
    memcpy(out + 13, data->acceleration + 6 * b, 6 * sizeof *out);
    out += BODY_CHANNELS;
  }
  mbd_energies e = mbd_energies_at(model, data);
  out[0] = e.kinetic;
  out[1] = e.potential;
  out[2] = e.springs;
  out[3] = data->work.supplied;
  out[4] = data->work.dissipated;
  out[5] = e.kinetic + e.potential + e.springs + data->work.dissipated - data->work.supplied - data->energy_start;
  out[6] = data->drift;
  data->drift = 0;
  return TDM_OK;
}
