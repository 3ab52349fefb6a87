/* What an engine says of its start: see report.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/engine/report.h"

#include "mbd/integrate/integrator.h"
#include "mbd/joint/frame.h"

#include <math.h>
#include <stdio.h>

/* Say so when the assembly changed more than rounding does. */
static void warn_about_assembly(mbd_report *s) {
  char path[TDM_PATH_MAX];
  const mbd_assembly *a = s->assembly;
  if (a->translation > 1e-6 || a->rotation > 1e-6) {
    snprintf(path, sizeof path, "mbd.bodies[%d].position", a->body);
    tdm_warning_set(
        &s->warning[s->nwarning++], path,
        "the joints and drivers do not fit the given start: body \"%s\" was moved (largest changes %.3g m, %.3g "
        "rad); correct the "
        "position, the orientation, the joints or the drivers' laws at the start",
        s->model->body[a->body].name, a->translation, a->rotation);
  }
  if (a->velocity > 1e-6 || a->angular > 1e-6) {
    snprintf(path, sizeof path, "mbd.bodies[%d].velocity", a->body_velocity);
    tdm_warning_set(
        &s->warning[s->nwarning++], path,
        "the joints do not allow the given start velocities: those of body \"%s\" were changed (largest changes %.3g "
        "m/s, %.3g rad/s); give velocities that the joints allow",
        s->model->body[a->body_velocity].name, a->velocity, a->angular);
  }
  if (a->driver >= 0) {
    const mbd_driver *d = &s->model->driver[a->driver];
    const char *unit = mbd_coordinate_table[d->ops->coordinate].rate_unit;
    snprintf(path, sizeof path, "mbd.drivers[%d]", a->driver);
    tdm_warning_set(
        &s->warning[s->nwarning++], path,
        "the given start velocities move the coordinate of driver \"%s\" at %.6g %s, its law starts at %.6g %s: the "
        "driver holds; give velocities that fit it, or none",
        d->name, a->given, unit, a->prescribed, unit);
  }
}

/* Files in millimetres: the largest mesh, where it is larger than machines are. */
static void warn_about_size(mbd_report *s) {
  char path[TDM_PATH_MAX];
  const double large = 10; /* radius of gyration [m] */
  const mbd_model *m = s->model;
  double most = large;
  int largest = -1;
  for (int b = 0; b < m->nbody; b++) {
    const tdm_mat3 *I = &m->body[b].inertia;
    const double gyration = sqrt((I->m[0][0] + I->m[1][1] + I->m[2][2]) / (2 * m->body[b].mass));
    if (m->body[b].mesh && gyration > most) {
      most = gyration;
      largest = b;
    }
  }
  if (largest < 0)
    return;
  snprintf(path, sizeof path, "mbd.bodies[%d].shape", largest);
  tdm_warning_set(&s->warning[s->nwarning++], path,
                  "the mesh gives body \"%s\" a radius of gyration of %.3g m and a mass of %.3g kg; is the file in "
                  "millimetres? Give \"scale\": 0.001 beside \"file\"",
                  m->body[largest].name, most, m->body[largest].mass);
}

/* Say so when joints lock the mechanism, or may do so by rounding. */
static void warn_about_freedom(mbd_report *s) {
  if (s->assembly->near_row >= 0) {
    mbd_origin o = mbd_origin_of(s->model, s->assembly->near_row);
    tdm_warning_set(
        &s->warning[s->nwarning++], o.path,
        "the equation \"%s\" of %s \"%s\" follows nearly, but not exactly, from the joints before it, and takes a "
        "freedom away that the mechanism may need; make axes exactly parallel and points exactly fit, or use a "
        "joint with more freedom",
        o.equation, o.kind, o.name);
  }
  if (s->assembly->freedom <= 0 && s->model->ndriver == 0) {
    tdm_warning_set(
        &s->warning[s->nwarning++], "mbd.joints",
        "the joints leave no degree of freedom and there is no driver: nothing can move; use joints with more "
        "freedom where it should");
  }
}

/* mass, where the centre of mass is at the start, inertia as a scene gives it, and the origin of a mesh's file */
static json_t *report_body(const mbd_report *s, int i) {
  const mbd_body *b = &s->model->body[i];
  const double(*m)[3] = b->inertia.m, inertia[] = {m[0][0], m[1][1], m[2][2], m[0][1], m[0][2], m[1][2]};
  tdm_pose pose = mbd_body_state(s->data->y, i).pose;
  json_t *json = json_pack("{s:f, s:o, s:o}", "mass", b->mass, "centre", tdm_numbers_to_json(&pose.position.x, 3),
                           "inertia", tdm_numbers_to_json(inertia, 6));
  if (b->mesh)
    json_object_set_new(json, "origin_of_file", tdm_numbers_to_json(&b->origin.x, 3));
  return json;
}

json_t *mbd_report_json(const mbd_report *s) {
  const mbd_model *m = s->model;
  json_t *bodies = json_object(), *joints = json_object(), *drivers = json_object();
  double mass = 0;
  for (int i = 0; i < m->nbody; i++) {
    json_object_set_new(bodies, m->body[i].name, report_body(s, i));
    mass += m->body[i].mass;
  }
  for (int i = 0; i < m->njoint; i++)
    json_object_set_new(joints, m->joint[i].name, json_string(m->joint[i].ops->name));
  for (int i = 0; i < m->ndriver; i++)
    json_object_set_new(drivers, m->driver[i].name, json_string(m->driver[i].ops->name));
  json_t *dependent = json_array();
  for (int i = 0; i < m->nrow - m->nfriction; i++)
    if (s->data->dependent[i]) {
      mbd_origin o = mbd_origin_of(m, i);
      json_array_append_new(dependent, json_pack("{s:s, s:s}", o.kind, o.name, "equation", o.equation));
    }
  return json_pack("{s:i, s:o, s:s, s:f, s:o, s:o, s:o, s:i, s:{s:f, s:f, s:f, s:f}}", "degrees_of_freedom",
                   s->assembly->freedom, "redundant", dependent, "formulation",
                   mbd_formulation_table[m->solver.formulation].name, "mass", mass, "bodies", bodies, "joints", joints,
                   "drivers", drivers, "forces", m->nforce, "assembly", "translation", s->assembly->translation,
                   "rotation", s->assembly->rotation, "velocity", s->assembly->velocity, "angular_velocity",
                   s->assembly->angular);
}

void mbd_report_warn(mbd_report *s) {
  warn_about_assembly(s);
  warn_about_size(s);
  warn_about_freedom(s);
}
