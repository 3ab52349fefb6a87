/* Reading the scene section into a model: see scene.h. docs/scene.md lists the keys. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/scene/scene.h"

#include "mbd/driver/table.h"
#include "mbd/force/table.h"
#include "mbd/joint/table.h"
#include "mbd/mechanics/slim.h"
#include "mbd/model/read.h"
#include "mbd/scene/body.h"
#include "mbd/scene/settings.h"

#include <stdlib.h>
#include <string.h>

/* ---- joints, drivers and forces: the common part; the table's entry reads the rest ---- */

/* A block for the parameters that a type keeps for itself. */
static void *own_of(tdm_object *o, size_t size) {
  void *own = size > 0 ? calloc(1, size) : NULL;
  if (size > 0 && !own)
    tdm_fail(o->err, TDM_ERR_MEMORY, o->path, "no memory for its parameters");
  return own;
}

static void read_joint(mbd_model *model, json_t *json, const char *path, tdm_error *err) {
  tdm_object o = tdm_object_open(json, path, err);
  mbd_joint *j = &model->joint[model->njoint]; /* counted below: the readers see those before it */
  mbd_read_name(&o, j->name);
  j->ops = tdm_get_type(&o, &mbd_joint_types);
  if (err->status)
    return;
  if (!j->ops->couples)
    mbd_read_bodies(&o, model, j->body);
  j->row = model->nrow;
  j->own = own_of(&o, j->ops->size);
  if (!err->status)
    j->ops->read(j, &o, model);
  tdm_object_close(&o);
  for (int i = 0; i < model->njoint; i++)
    if (strcmp(model->joint[i].name, j->name) == 0)
      tdm_object_fail(&o, "name", "a second joint is called \"%s\"; give every joint its own name", j->name);
  model->njoint++;
  model->nrow += j->ops->nrow;
}

static void read_driver(mbd_model *model, json_t *json, const char *path, tdm_error *err) {
  tdm_object o = tdm_object_open(json, path, err);
  mbd_driver *d = &model->driver[model->ndriver++];
  mbd_read_name(&o, d->name);
  d->ops = tdm_get_type(&o, &mbd_driver_types);
  if (err->status)
    return;
  d->row = model->nrow;
  d->ops->read(d, &o, model);
  tdm_motion_read(&d->motion, &o, "motion");
  tdm_object_close(&o);
  for (int i = 0; i < model->ndriver - 1 && !err->status; i++) {
    const mbd_driver *other = &model->driver[i];
    if (strcmp(other->name, d->name) == 0)
      tdm_object_fail(&o, "name", "a second driver is called \"%s\"; give every driver its own name", d->name);
    else if (other->joint == d->joint && other->ops->coordinate == d->ops->coordinate)
      tdm_object_fail(&o, "joint", "the %s of joint \"%s\" is driven by \"%s\" already; remove one of the two drivers",
                      mbd_coordinate_table[d->ops->coordinate].name, d->joint->name, other->name);
  }
  model->nrow++;
}

static void read_force(mbd_model *model, json_t *json, const char *path, tdm_error *err) {
  tdm_object o = tdm_object_open(json, path, err);
  mbd_force *f = &model->force[model->nforce];
  mbd_read_name(&o, f->name);
  f->ops = tdm_get_type(&o, &mbd_force_types);
  if (err->status)
    return;
  f->own = own_of(&o, f->ops->size);
  if (!err->status)
    f->ops->read(f, &o, model);
  tdm_object_close(&o);
  if (f->rubbing) {
    f->rubbing->stick = model->nfriction;
    f->rubbing->row = model->nrow++;
    model->friction[model->nfriction++] = model->nforce;
    model->nreacting += f->rubbing->reacts;
  }
  for (int i = 0; i < model->nforce; i++)
    if (strcmp(model->force[i].name, f->name) == 0)
      tdm_object_fail(&o, "name", "a second force is called \"%s\"; give every force its own name", f->name);
  model->nforce++;
}

/* Hand every element of the array `key` to `read`. */
static void read_array(tdm_object *o, const char *key, bool required, mbd_model *model,
                       void (*read)(mbd_model *, json_t *, const char *, tdm_error *)) {
  json_t *array = tdm_get_array(o, key, required);
  for (size_t i = 0; i < json_array_size(array) && !o->err->status; i++) {
    char path[TDM_PATH_MAX];
    read(model, json_array_get(array, i), tdm_path(path, o, key, (int)i), o->err);
  }
}

/* Elements of the array `key`, at least 1 so that calloc never gets 0. */
static size_t array_room(json_t *json, const char *key) {
  size_t n = json_array_size(json_object_get(json, key));
  return n > 0 ? n : 1;
}

/* List the pairs of bodies of all joints, drivers and frictions. */
static void list_parts(mbd_model *m) {
  for (int i = 0; i < m->njoint; i++) {
    const mbd_joint *j = &m->joint[i];
    for (int k = 0; k == 0 || (k < MBD_COUPLED_MAX && j->of[k]); k++) {
      const mbd_joint *pair = j->of[0] ? j->of[k] : j;
      m->part[m->npart++] = (mbd_part){.joint = j,
                                       .index = k,
                                       .turn = (int)(pair - m->joint),
                                       .body = {pair->body[0], pair->body[1]},
                                       .row = j->row};
    }
  }
  m->njointpart = m->npart;
  for (int i = 0; i < m->ndriver; i++) {
    const mbd_driver *d = &m->driver[i];
    const mbd_joint *j = d->joint;
    int turn = j == &d->frame ? -1 : (int)(j - m->joint);
    m->part[m->npart++] =
        (mbd_part){.joint = j, .driver = d, .turn = turn, .body = {j->body[0], j->body[1]}, .row = d->row};
  }
  for (int i = 0; i < m->nfriction; i++) {
    mbd_force *f = &m->force[m->friction[i]];
    for (f->rubbing->part = 0; m->part[f->rubbing->part].joint != f->joint;)
      f->rubbing->part++;
    m->part[m->npart++] = (mbd_part){
        .joint = f->joint, .friction = f, .turn = -1, .body = {f->body[0], f->body[1]}, .row = f->rubbing->row};
  }
}

tdm_status mbd_model_read(mbd_model **model, json_t *json, bool coupled, tdm_error *err) {
  mbd_model *m = *model = calloc(1, sizeof *m);
  if (!m)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the model");
  m->body = calloc(array_room(json, "bodies"), sizeof *m->body);
  m->joint = calloc(array_room(json, "joints"), sizeof *m->joint);
  m->driver = calloc(array_room(json, "drivers"), sizeof *m->driver);
  m->force = calloc(array_room(json, "forces"), sizeof *m->force);
  m->friction = calloc(array_room(json, "forces"), sizeof *m->friction);
  size_t parts =
      MBD_COUPLED_MAX * array_room(json, "joints") + array_room(json, "drivers") + array_room(json, "forces");
  m->part = calloc(parts, sizeof *m->part);
  if (!m->body || !m->joint || !m->driver || !m->force || !m->friction || !m->part)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the model");

  const tdm_vec3 earth = {0, 0, -9.81};
  m->section = json;
  m->joint_types = &mbd_joint_types;
  tdm_object o = tdm_object_open(json, "mbd", err);
  m->gravity = tdm_get_vec3(&o, "gravity", &earth);
  read_array(&o, "bodies", true, m, mbd_body_read);
  if (!err->status && m->nbody == 0)
    tdm_object_fail(&o, "bodies", "is empty; give at least one body");
  read_array(&o, "joints", false, m, read_joint);
  m->njointrow = m->nrow;
  read_array(&o, "drivers", false, m, read_driver);
  read_array(&o, "forces", false, m, read_force);
  if (!err->status) {
    list_parts(m);
    mbd_slim_settle(m, err);
  }
  mbd_settings_read(&m->solver, &o, m, coupled);
  m->section = NULL;
  m->joint_types = NULL;
  tdm_object_close(&o);
  return err->status;
}
