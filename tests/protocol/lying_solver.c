/* tandem's own solver of the role LIE_ROLE (mbd or dem), but for one number that it gets wrong: LIE says which, at
 * READY or, from window 3 on, in RESULT. Numbers that look right and are not are wrong from the start on.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/adapter/solver.h"
#include "dem/model/model.h"
#include "dem/state/data.h"
#include "mbd/adapter/solver.h"
#include "protocol/base/log.h"
#include "protocol/math/gsl_errors.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *lie;
static const tdm_solver_ops *own;
static tdm_assigned_body body[4];
static tdm_vec3 place;  /* of the first body at the start */
static tdm_vec3 weight; /* of the first body [N] */

static bool is(const char *name) {
  return strcmp(lie, name) == 0;
}

/* Parts of the reduced model that are left out, or too large. */
static void bend_model(tdm_mobility *m) {
  const size_t f = (size_t)m->nfree, k = 6 * (size_t)m->nbody;
  if (is("without stiffness"))
    memset(m->stiffness, 0, f * f * sizeof *m->stiffness);
  if (is("without damping"))
    memset(m->damping, 0, f * f * sizeof *m->damping);
  if (is("without J"))
    memset(m->J, 0, k * f * sizeof *m->J);
  if (is("without velocity"))
    memset(m->velocity, 0, f * sizeof *m->velocity);
  if (is("without dB/dt"))
    memset(m->B_rate, 0, k * f * sizeof *m->B_rate);
  if (is("without dJ/dt"))
    memset(m->J_rate, 0, k * f * sizeof *m->J_rate);
  for (size_t i = 0; i < k * f && is("twice B"); i++)
    m->B[i] *= 2;
}

static tdm_status create(void **self, const tdm_assignment *given, tdm_ready *ready, tdm_participant *p,
                         tdm_error *err) {
  tdm_assignment bent = *given;
  const tdm_assignment *a = &bent;
  if (is("feels the path"))
    bent.sent_velocity = false;
  if (own->create(self, a, ready, p, err) != TDM_OK)
    return err->status;
  if (a->mobility)
    bend_model((tdm_mobility *)ready->mobility);
  if (ready->body && ready->gravity)
    weight = tdm_scale(ready->body[0].mass, *ready->gravity);
  if (is("lone") && !a->mobility)
    return tdm_fail(err, TDM_ERR_SCENE, NULL, "goes with all that it can alone");
  for (int i = 0; i < a->nbody && i < 4 && ready->body; i++)
    body[i] = ready->body[i];
  if (ready->body)
    ready->body = body;
  if (is("ready inertia"))
    body[0].inertia.m[1][1] = -1;
  if (is("ready lopsided inertia"))
    body[0].inertia.m[0][1] += 0.3;
  if (is("ready zero quaternion"))
    body[0].state.pose.orientation = (tdm_quat){0, 0, 0, 0};
  if (is("ready far away"))
    body[0].state.pose.position.x = 1e200;
  if (is("ready mobility"))
    ready->mobility->Y[14] = -1;
  if (is("sluggish"))
    ready->mobility->Y[14] *= 0.5;
  place = body[0].state.pose.position;
  if (is("ready channel"))
    ((double *)ready->initial)[0] = 1e300;
  if (is("ready load"))
    ((tdm_wrench *)ready->load)[0].force.x = -1e151;
  static const tdm_vec3 moon = {0, 0, -1.62};
  static const bool all[4] = {true, true, true, true};
  if (is("is on the moon"))
    ready->gravity = &moon;
  if (is("prescribes"))
    ready->prescribed = all;
  if (is("starts"))
    ((tdm_wrench *)ready->load)[0].force.x = 1e5;
  return TDM_OK;
}

/* a path of one node, as it should be but for what is said of it */
static void spoil_path(const tdm_step *in, tdm_result *r) {
  static double time;
  static tdm_state state[4];
  for (int i = 0; i < r->nbody && i < 4; i++)
    state[i] = r->state[i];
  time = is("backwards") ? 0 : in->ahead;
  if (is("path"))
    state[0].twist.velocity.x = NAN;
  r->path = (tdm_nodes){1, r->nbody, &time, state};
}

static void spoil_of_mbd(const tdm_step *in, tdm_result *r) {
  double *Y = r->mobility.Y;
  if (is("path") || is("backwards"))
    spoil_path(in, r);
  if (is("state"))
    r->state[0].twist.angular.y = NAN;
  if (is("zero quaternion"))
    r->state[0].pose.orientation = (tdm_quat){0, 0, 0, 0};
  if (is("long quaternion"))
    r->state[0].pose.orientation.w *= 100;
  if (is("recorded state") && r->nsample > 0)
    r->sample_state[0].pose.position.z = 1e300;
  if (is("recorded quaternion") && r->nsample > 0)
    r->sample_state[0].pose.orientation.x = 1;
  if (is("acceleration"))
    r->acceleration[3] = INFINITY;
  if (is("negative mobility"))
    Y[14] = -Y[14];
  if (is("lopsided mobility"))
    Y[2] = 0.5 * Y[14];
  if (is("indefinite mobility"))
    Y[2] = Y[12] = Y[14];
  if (is("exchanged"))
    r->energy->exchanged = NAN;
  if (is("kinetic"))
    r->energy->kinetic = 1e160;
}

static void spoil_of_dem(tdm_result *r) {
  if (is("load"))
    r->load[0].moment.x = 1e200;
  if (is("recorded load") && r->nsample > 0)
    r->sample_load[0].force.z = NAN;
  if (is("end"))
    r->body[0].end.pose.orientation = (tdm_quat){0, 0, 0, 0};
}

/* ---- what looks right ---- */

/* A path ahead that is not the one that comes. */
static void bend_path(tdm_nodes *path) {
  for (int k = 0; k + 1 < path->nnode && is("strays ahead"); k++) /* but at its end */
    path->state[k * path->nbody].pose.position.z += 1e-3;
  for (int k = 0; k < path->nnode && is("turns ahead"); k++)
    path->state[k * path->nbody].twist.angular.y += 1;
  if (is("tells no path"))
    path->nnode = 0;
}

static void bend_of_mbd(const tdm_step *in, tdm_result *r) {
  if (r->has_mobility)
    bend_model(&r->mobility);
  for (int j = 1; is("accelerates late") && j < in->nload; j++) /* as the load at the window's start has it */
    for (int i = 0; i < 3; i++)
      r->acceleration[i] -= r->mobility.Y[7 * i] * (&in->load[j].force.x)[i];
  if (is("weightless"))
    r->energy->stored += tdm_dot(weight, r->state[0].pose.position);
  if (is("mirrored"))
    r->state[0].twist.velocity = tdm_scale(-1, r->state[0].twist.velocity);
  if (is("light"))
    r->state[0].twist.velocity = tdm_scale(3, r->state[0].twist.velocity);
  if (is("stays"))
    r->state[0].pose.position = place;
  if (is("slack"))
    for (int k = 0; k < 6; k++)
      r->acceleration[k] *= 0.5;
  if (is("works twice"))
    r->energy->exchanged *= 2;
  bend_path(&r->path);
}

static void bend_of_dem(tdm_result *r) {
  if (is("attracts"))
    r->load[0].force = tdm_scale(-1, r->load[0].force);
  if (is("strikes"))
    r->body[0].moment[0].force.z *= 1.5;
  if (is("works twice"))
    r->body[0].work *= 2;
  if (is("swaps") && r->nbody > 1) {
    const tdm_interface first = r->body[0];
    r->body[0] = r->body[1];
    r->body[1] = first;
  }
  if (is("strays"))
    r->body[0].end.pose.position.x += 1e-3;
  if (is("forgets samples") && r->nsample > 0)
    r->sample_load[0] = r->load[0];
  if (is("has energy"))
    r->energy->stored *= 3;
  if (is("flattens"))
    r->body[0].moment[1].force = tdm_v3(0, 0, 0);
  if (is("pushes"))
    r->body[0].end.twist.velocity.z += 1e-3;
}

/* What a STEP's proxy has, left out; `zeros` are as many as it needs. */
static void bend_proxy(tdm_step *in) {
  static const double zeros[256];
  tdm_mobility *m = &in->proxy.mobility;
  const size_t k = 6 * (size_t)in->nbody, f = (size_t)m->nfree;
  if (is("ignores W(0)"))
    in->proxy.load = (const tdm_wrench *)(const void *)zeros;
  if (is("ignores corrections"))
    in->proxy.correction = zeros;
  if (is("without dJ/dt"))
    memset(m->J_rate, 0, k * f * sizeof *m->J_rate);
  if (is("without dB/dt"))
    memset(m->B_rate, 0, k * f * sizeof *m->B_rate);
  for (size_t i = 0; i < k && is("ignores drivers") && f == 1; i++)
    ((double *)in->proxy.acceleration)[i] = m->J[i] * m->acceleration[0] + m->J_rate[i] * m->velocity[0];
}

/* The bodies stay where they are, whatever is restored. */
static tdm_status leave_bodies(void *self, int slot, tdm_error *err) {
  const dem_data *d = dem_solver_data(self);
  tdm_pose kept[4];
  const int n = d->model->nbody < 4 ? d->model->nbody : 4;
  memcpy(kept, d->state.pose, (size_t)n * sizeof *kept);
  if (own->restore(self, slot, err) == TDM_OK)
    memcpy(d->state.pose, kept, (size_t)n * sizeof *kept);
  return err->status;
}

/* Contacts that point the other way. */
static tdm_status turn_contacts(void *self, tdm_snapshot *out, tdm_error *err) {
  if (own->snapshot(self, out, err) == TDM_OK)
    for (int i = 0; i < out->ncontact; i++)
      out->contact[i].to = tdm_axpy(-1, out->contact[i].to, tdm_scale(2, out->contact[i].from));
  return err->status;
}

/* A restore that does nothing. */
static tdm_status forget(void *self, int slot, tdm_error *err) {
  (void)self, (void)slot, (void)err;
  return TDM_OK;
}

static tdm_status step(void *self, const tdm_step *given, tdm_result *r, tdm_error *err) {
  tdm_step bent = *given;
  const tdm_step *in = &bent;
  if (is("flat"))
    bent.nload = bent.nload > 1 ? 1 : bent.nload;
  if (is("straight"))
    bent.path.nnode = 0;
  tdm_state ends[2][4];
  if (is("turns at once") && in->path.nnode == 1) /* rates of rotation vectors that are angular velocities */
    for (int i = 0; i < 4 && i < in->nbody; i++) {
      tdm_state *last = &bent.path.state[i];
      const tdm_vec3 turn = tdm_quat_turn(in->start[i].pose.orientation, last->pose.orientation);
      last->twist.angular = tdm_axpy(0.5, tdm_cross(turn, last->twist.angular), last->twist.angular);
    }
  if (is("stiff"))
    for (int i = 0; i < 4 && i < in->nstate; i++) {
      ends[0][i] = in->start[i];
      ends[1][i] = in->end[i];
      ends[0][i].twist = ends[1][i].twist = (tdm_twist){0};
      bent.start = ends[0];
      bent.end = ends[1];
    }
  if (bent.has_proxy)
    bend_proxy(&bent);
  if (own->step(self, in, r, err) != TDM_OK)
    return err->status;
  if (is("corrects for nothing") && bent.has_proxy && bent.proxy.correction[2] != 0)
    r->body[0].work = 0;
  if (is("jumps") && bent.has_proxy)
    r->body[0].blending = 0;
  if (own == &mbd_solver_ops)
    bend_of_mbd(in, r);
  else
    bend_of_dem(r);
  if (in->window < 3)
    return TDM_OK;
  if (own == &mbd_solver_ops)
    spoil_of_mbd(in, r);
  else
    spoil_of_dem(r);
  if (is("channel") && r->nsample > 0)
    r->channel[1] = NAN;
  if (is("huge channel") && r->nsample > 0)
    r->channel[1] = -1e155;
  return TDM_OK;
}

int main(int argc, char **argv) {
  const char *role = getenv("LIE_ROLE");
  lie = getenv("LIE") ? getenv("LIE") : "";
  own = role && strcmp(role, "mbd") == 0 ? &mbd_solver_ops : &dem_solver_ops;
  tdm_solver_ops ops = *own;
  ops.create = create;
  ops.step = step;
  if (is("forgets"))
    ops.restore = forget;
  if (is("leaves bodies"))
    ops.restore = leave_bodies;
  if (is("pulls"))
    ops.snapshot = turn_contacts;
  ops.software = "liar 1.0";
  tdm_gsl_return_errors();
  return tdm_solver_main(&ops, argc, argv);
}
