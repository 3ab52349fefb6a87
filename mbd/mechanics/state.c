/* The unknowns and the run's state: see state.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/mechanics/state.h"

#include "mbd/driver/driver.h"
#include "mbd/joint/rows.h"

#include <stdlib.h>
#include <string.h>

mbd_data *mbd_data_create(const mbd_model *m) {
  mbd_data *d = calloc(1, sizeof *d);
  if (!d)
    return NULL;
  bool good = true;
#define ALLOCATE(type, name, count) good = (d->name = calloc((size_t)(count) + 1, sizeof *d->name)) && good;
  MBD_STATE_ARRAYS(ALLOCATE)
  MBD_WORK_ARRAYS(ALLOCATE)
#undef ALLOCATE
  if (!good) {
    mbd_data_destroy(&d);
    return NULL;
  }
  for (int b = 0; b < m->nbody; b++)
    mbd_set_body_state(d->y, b, &m->body[b].start);
  for (int k = 0; k < m->nfriction; k++) {
    const mbd_rubbing *r = m->force[m->friction[k]].rubbing;
    d->stick[k].normal = r->base;
    d->dependent[r->row] = true;
  }
  d->kin[0].A = tdm_m3_identity();
  d->open_row = d->turned = -1;
  d->index3 = m->solver.formulation == MBD_INDEX3;
  return d;
}

void mbd_data_destroy(mbd_data **data) {
  mbd_data *d = data ? *data : NULL;
  if (!d)
    return;
#define RELEASE(type, name, count) free(d->name);
  MBD_STATE_ARRAYS(RELEASE)
  MBD_WORK_ARRAYS(RELEASE)
#undef RELEASE
  free(d);
  *data = NULL;
}

void mbd_data_copy(const mbd_model *m, mbd_data *to, const mbd_data *from) {
#define COPY_SCALAR(type, name) to->name = from->name;
#define COPY_ARRAY(type, name, count) memcpy(to->name, from->name, (size_t)(count) * sizeof *to->name);
  MBD_STATE_SCALARS(COPY_SCALAR)
  MBD_STATE_ARRAYS(COPY_ARRAY)
#undef COPY_SCALAR
#undef COPY_ARRAY
}

tdm_status mbd_data_set_load(mbd_data *data, const mbd_model *model, double t0, double t1, int nload,
                             const tdm_wrench *load, tdm_error *err) {
  if (nload > TDM_LOAD_MAX)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "the load polynomial has %d coefficients; at most %d are supported",
                    nload, TDM_LOAD_MAX);
  data->load_t0 = t0;
  data->load_t1 = t1;
  data->nload = nload;
  if (nload > 0 && model->ncoupled > 0)
    memcpy(data->load, load, (size_t)model->ncoupled * (size_t)nload * sizeof *data->load);
  return TDM_OK;
}

tdm_wrench mbd_load_at(const mbd_data *data, int i, double t) {
  tdm_wrench w = {{0, 0, 0}, {0, 0, 0}};
  double s = data->load_t1 > data->load_t0 ? (t - data->load_t0) / (data->load_t1 - data->load_t0) : 0;
  /* Horner */
  for (int j = data->nload - 1; j >= 0; j--) {
    const tdm_wrench *c = &data->load[i * data->nload + j];
    w.force = tdm_axpy(s, w.force, c->force);
    w.moment = tdm_axpy(s, w.moment, c->moment);
  }
  return w;
}

tdm_state mbd_body_state(const double *y, int body) {
  const double *u = y + MBD_BODY_UNKNOWNS * body;
  return (tdm_state){{mbd_get3(u + MBD_R), tdm_quat_unit(mbd_quat_of(y, body))},
                     {mbd_get3(u + MBD_V), mbd_get3(u + MBD_W)}};
}

void mbd_set_body_state(double *y, int body, const tdm_state *state) {
  double *u = y + MBD_BODY_UNKNOWNS * body;
  tdm_quat q = state->pose.orientation;
  mbd_set3(u + MBD_R, state->pose.position);
  u[MBD_P] = q.w;
  u[MBD_P + 1] = q.x;
  u[MBD_P + 2] = q.y;
  u[MBD_P + 3] = q.z;
  mbd_set3(u + MBD_V, state->twist.velocity);
  mbd_set3(u + MBD_W, state->twist.angular);
}

/* Rotation matrix of the direction of p, whatever its length. */
static tdm_mat3 rotation(tdm_quat p) {
  double n = p.w * p.w + p.x * p.x + p.y * p.y + p.z * p.z, s = n > 0 ? 2 / n : 0;
  double xx = s * p.x * p.x, yy = s * p.y * p.y, zz = s * p.z * p.z;
  double xy = s * p.x * p.y, xz = s * p.x * p.z, yz = s * p.y * p.z;
  double wx = s * p.w * p.x, wy = s * p.w * p.y, wz = s * p.w * p.z;
  return (tdm_mat3){
      {{1 - yy - zz, xy - wz, xz + wy}, {xy + wz, 1 - xx - zz, yz - wx}, {xz - wy, yz + wx, 1 - xx - yy}}};
}

void mbd_kinematics(const mbd_model *model, mbd_data *data, double t, const double *y) {
  data->now = t;
  for (int b = 0; b < model->nbody; b++) {
    const double *u = y + MBD_BODY_UNKNOWNS * b;
    mbd_kin *k = &data->kin[b + 1];
    k->r = mbd_get3(u + MBD_R);
    k->v = mbd_get3(u + MBD_V);
    k->w = mbd_get3(u + MBD_W);
    k->A = rotation(mbd_quat_of(y, b));
  }
}

const mbd_force_value *mbd_force_at(const mbd_model *model, mbd_data *data, int i, bool second) {
  const mbd_force *f = &model->force[i];
  mbd_force_value *value = &data->force;
  memset(value->Q, 0, sizeof value->Q);
  if (second) {
    memset(value->K, 0, sizeof value->K);
    memset(value->C, 0, sizeof value->C);
  }
  value->second = second;
  value->near = data->angle[i];
  value->now = data->now;
  if (f->rubbing) {
    const mbd_stick *stick = &data->stick[f->rubbing->stick];
    value->way = stick->stuck ? 0 : stick->way;
    value->normal = stick->normal;
  }
  value->value = value->coordinate = value->rotation = value->rate = value->potential = value->dissipated =
      value->supplied = 0;
  value->rows.n = 0;
  value->rows.second = second;
  f->ops->eval(f, &data->kin[f->body[0] + 1], &data->kin[f->body[1] + 1], value);
  return value;
}

const mbd_rows *mbd_part_at(const mbd_model *model, mbd_data *data, int i, bool second) {
  const mbd_part *p = &model->part[i];
  const mbd_kin *a = &data->kin[p->body[0] + 1], *b = &data->kin[p->body[1] + 1];
  mbd_rows *rows = &data->rows;
  rows->n = 0;
  rows->second = second;
  rows->part = p->index;
  rows->turn = p->turn < 0 ? 0 : data->turn[p->turn];
  memcpy(rows->body, p->body, sizeof rows->body);
  rows->first = p->row;
  if (p->friction) {
    const mbd_stick *stick = &data->stick[p->friction->rubbing->stick];
    if (stick->stuck)
      mbd_joint_coordinate(p->joint, p->friction->coordinate, a, b, stick->hold, rows);
    else
      mbd_rows_zero(rows);
    return rows;
  }
  if (!p->driver) {
    p->joint->ops->eval(p->joint, a, b, rows);
    return rows;
  }
  tdm_motion_value x = tdm_motion_at(&p->driver->motion, data->now);
  mbd_driver_row(p->driver, x.value, a, b, rows);
  rows->g_t[0] = -x.rate;
  rows->g_tt[0] = -x.acceleration;
  return rows;
}

double mbd_row_mobility(const mbd_model *model, const mbd_data *data, const mbd_rows *rows, int k) {
  double sum = 0;
  for (int side = 0; side < 2; side++) {
    if (rows->body[side] == MBD_GROUND)
      continue;
    const mbd_body *body = &model->body[rows->body[side]];
    tdm_vec3 along = mbd_get3(rows->G[k] + 6 * side);
    tdm_vec3 about = tdm_m3_tmul(data->kin[rows->body[side] + 1].A, mbd_get3(rows->G[k] + 6 * side + 3));
    sum += tdm_dot(along, along) / body->mass + tdm_dot(about, tdm_m3_mul(body->inverse_inertia, about));
  }
  return sum;
}

/* [m] or [rad] */
static const double open_limit = 1e-6;

/* Note the largest violation: rows of the same constraint add up over its parts. */
static void note_drift(const mbd_model *model, mbd_data *data) {
  memset(data->g, 0, (size_t)model->nrow * sizeof(double));
  for (int i = 0; i < model->npart; i++) {
    const mbd_rows *rows = mbd_part_at(model, data, i, false);
    for (int k = 0; k < rows->n; k++)
      data->g[rows->first + k] += rows->g[k];
  }
  for (int i = 0; i < model->nrow; i++) {
    data->drift = fmax(data->drift, fabs(data->g[i]));
    if (data->dependent[i] && fabs(data->g[i]) > open_limit)
      data->open_row = i;
  }
}

double mbd_reach(const mbd_model *model, const double *y) {
  double reach = 1;
  for (int b = 0; b < model->nbody; b++)
    reach = fmax(reach, tdm_norm(mbd_get3(y + MBD_BODY_UNKNOWNS * b + MBD_R)));
  return reach;
}

/* [rad]; the rotation vector of a force jumps at half a turn */
static const double rotation_limit = 3;

void mbd_accept(const mbd_model *model, mbd_data *data, double t, const double *y) {
  mbd_kinematics(model, data, t, y);
  for (int i = 0; i < model->nforce; i++) {
    const mbd_force_value *value = mbd_force_at(model, data, i, false);
    data->angle[i] = value->coordinate;
    if (value->rotation > rotation_limit && data->turned < 0) {
      data->turned = i;
      data->turned_at = t;
    }
  }
  for (int i = 0; i < model->njoint; i++) {
    const mbd_joint *j = &model->joint[i];
    data->turn[i] = mbd_joint_angle(j, &data->kin[j->body[0] + 1], &data->kin[j->body[1] + 1], data->turn[i]);
  }
  note_drift(model, data);
}
