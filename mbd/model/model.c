/* Reading a model from its scene section. README.md lists the keys. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/model/model.h"
#include "mbd/adapter/guard.h"
#include "mbd/integrate/integrator.h"
#include "mbd/mechanics/slim.h"
#include "mbd/model/body.h"
#include "mbd/model/read.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- bodies ---- */

int mbd_model_find_body(const mbd_model *model, const char *name) {
  if (strcmp(name, "ground") == 0)
    return MBD_GROUND;
  for (int i = 0; i < model->nbody; i++)
    if (strcmp(model->body[i].name, name) == 0)
      return i;
  return -2;
}

const char *mbd_model_nearest_body(const mbd_model *model, const char *name, bool ground) {
  const char **names = calloc((size_t)model->nbody + 1, sizeof *names);
  if (!names)
    return NULL;
  for (int i = 0; i < model->nbody; i++)
    names[i] = model->body[i].name;
  if (ground)
    names[model->nbody] = "ground";
  const char *found = tdm_nearest(name, names, model->nbody + 1);
  free(names);
  return found;
}

tdm_pose mbd_model_pose(const mbd_model *model, int body) {
  if (body == MBD_GROUND)
    return (tdm_pose){{0, 0, 0}, {1, 0, 0, 0}};
  return model->body[body].start.pose;
}

tdm_vec3 mbd_model_arm(const mbd_model *model, int body, tdm_vec3 world_point) {
  return mbd_model_direction(model, body, tdm_sub(world_point, mbd_model_pose(model, body).position));
}

tdm_vec3 mbd_model_direction(const mbd_model *model, int body, tdm_vec3 world_direction) {
  return tdm_m3_tmul(tdm_quat_to_matrix(mbd_model_pose(model, body).orientation), world_direction);
}

/* a box around points */
typedef struct {
  tdm_vec3 low, high;
} box;

static void stretch(box *b, tdm_vec3 p) {
  b->low = tdm_v3(fmin(b->low.x, p.x), fmin(b->low.y, p.y), fmin(b->low.z, p.z));
  b->high = tdm_v3(fmax(b->high.x, p.x), fmax(b->high.y, p.y), fmax(b->high.z, p.z));
}

double mbd_model_extent(const mbd_model *model) {
  const box empty = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  box of[2] = {empty, empty}; /* points on the ground, and on bodies */
  double extent = 0;
  for (int b = 0; b < model->nbody; b++) {
    const mbd_body *body = &model->body[b];
    const tdm_mat3 *J = &body->inertia;
    stretch(&of[1], body->start.pose.position);
    extent = fmax(extent, sqrt(0.5 * (J->m[0][0] + J->m[1][1] + J->m[2][2]) / body->mass));
  }
  for (int i = 0; i < model->njoint; i++)
    for (int side = 0; side < 2; side++) {
      const mbd_joint *j = &model->joint[i];
      stretch(&of[j->body[side] != MBD_GROUND], tdm_pose_point(mbd_model_pose(model, j->body[side]), j->arm[side]));
    }
  for (int k = 0; k < 2; k++)
    if (of[k].low.x <= of[k].high.x)
      extent = fmax(extent, tdm_norm(tdm_sub(of[k].high, of[k].low)));
  return extent;
}

double mbd_model_finest(const mbd_model *model) {
  double reach = fmax(1, mbd_model_extent(model));
  for (int b = 0; b < model->nbody; b++) {
    tdm_vec3 r = model->body[b].start.pose.position;
    reach = fmax(reach, fmax(fabs(r.x), fmax(fabs(r.y), fabs(r.z))));
  }
  return 3e-14 * reach;
}

/* ---- joints, drivers and forces: the common part; the table's entry reads the rest ---- */

/* Read "type" and leave the index in the table; -1 after an error. */
static int load_type(tdm_object *o, const char *const *names, int n) {
  return tdm_get_choice(o, "type", names, n, -1);
}

static void load_joint(mbd_model *model, json_t *json, const char *path, tdm_error *err) {
  tdm_object o = tdm_object_open(json, path, err);
  mbd_joint *j = &model->joint[model->njoint];
  const char *names[MBD_JOINT_TYPES_MAX];
  for (int i = 0; i < mbd_joint_ntype; i++)
    names[i] = mbd_joint_table[i]->name;
  mbd_read_name(&o, j->name);
  int type = load_type(&o, names, mbd_joint_ntype);
  if (err->status)
    return;
  j->ops = mbd_joint_table[type];
  if (!j->ops->couples)
    mbd_read_bodies(&o, model, j->body);
  j->row = model->nrow;
  j->ops->load(j, &o, model);
  tdm_object_close(&o);
  for (int i = 0; i < model->njoint; i++)
    if (strcmp(model->joint[i].name, j->name) == 0)
      tdm_object_fail(&o, "name", "a second joint is called \"%s\"; give every joint its own name", j->name);
  model->njoint++;
  model->nrow += j->ops->nrow;
}

static void load_driver(mbd_model *model, json_t *json, const char *path, tdm_error *err) {
  tdm_object o = tdm_object_open(json, path, err);
  mbd_driver *d = &model->driver[model->ndriver++];
  const char *names[MBD_DRIVER_TYPES_MAX];
  for (int i = 0; i < mbd_driver_ntype; i++)
    names[i] = mbd_driver_table[i]->name;
  mbd_read_name(&o, d->name);
  int type = load_type(&o, names, mbd_driver_ntype);
  if (err->status)
    return;
  d->ops = mbd_driver_table[type];
  d->row = model->nrow;
  d->ops->load(d, &o, model);
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

static void load_force(mbd_model *model, json_t *json, const char *path, tdm_error *err) {
  tdm_object o = tdm_object_open(json, path, err);
  mbd_force *f = &model->force[model->nforce];
  const char *names[MBD_FORCE_TYPES_MAX];
  for (int i = 0; i < mbd_force_ntype; i++)
    names[i] = mbd_force_table[i]->name;
  mbd_read_name(&o, f->name);
  int type = load_type(&o, names, mbd_force_ntype);
  if (err->status)
    return;
  f->ops = mbd_force_table[type];
  f->ops->load(f, &o, model);
  tdm_object_close(&o);
  if (f->ops->sticks) {
    f->rubbing.stick = model->nfriction;
    f->rubbing.row = model->nrow++;
    model->friction[model->nfriction++] = model->nforce;
    model->nreacting += f->rubbing.reacts;
  }
  for (int i = 0; i < model->nforce; i++)
    if (strcmp(model->force[i].name, f->name) == 0)
      tdm_object_fail(&o, "name", "a second force is called \"%s\"; give every force its own name", f->name);
  model->nforce++;
}

static void load_solver(mbd_model *model, tdm_object *section) {
  mbd_settings *s = &model->solver;
  const char *formulations[MBD_FORMULATIONS];
  static const char *const correctors[] = {"original", "modified"};
  for (int i = 0; i < MBD_FORMULATIONS; i++)
    formulations[i] = mbd_formulation_table[i].name;
  s->named = tdm_has(section, "formulation") || tdm_has(section, "corrector");
  s->formulation = (mbd_formulation_id)tdm_get_choice(section, "formulation", formulations, MBD_FORMULATIONS, MBD_GGL);
  s->modified = tdm_get_choice(section, "corrector", correctors, 2, s->formulation == MBD_INDEX3) == 1;
  s->restart_each_window = tdm_get_bool(section, "restart_each_window", false);
  mbd_guard_read(&s->guard, section);
  tdm_object o = tdm_get_object(section, "solver", false);
  s->relative_tolerance = tdm_get_number(&o, "relative_tolerance", 1e-8, TDM_POSITIVE);
  s->absolute_tolerance = tdm_get_number(&o, "absolute_tolerance",
                                         fmax(0.01 * s->relative_tolerance, mbd_model_finest(model)), TDM_POSITIVE);
  s->max_order = (int)tdm_get_integer(&o, "max_order", 5, 1);
  s->max_step = tdm_get_number(&o, "max_step", 0, TDM_NOT_NEGATIVE);
  s->spectral_radius = tdm_get_number(&o, "spectral_radius", 0.8, TDM_NOT_NEGATIVE);
  tdm_object_close(&o);
  if (!o.err->status && s->modified && s->formulation == MBD_ONE_STEP)
    tdm_object_fail(section, "corrector",
                    "\"modified\" is for ggl and index3; one_step has no corrector of its own: remove the key, or use "
                    "\"original\"");
  if (!o.err->status && s->max_order > 5)
    tdm_object_fail(&o, "max_order", "must be 1 to 5: backward differentiation formulas above 5 are not stable enough");
  if (!o.err->status && s->spectral_radius > 1)
    tdm_object_fail(&o, "spectral_radius", "is %g; use 0 (most damping) to 1 (none)", s->spectral_radius);
  if (!o.err->status && (s->relative_tolerance < 1e-13 || s->relative_tolerance > 0.1))
    tdm_object_fail(&o, "relative_tolerance", "is %g; use 1e-13 to 0.1", s->relative_tolerance);
}

void mbd_model_prefer_one_step(mbd_model *model) {
  if (!model->solver.named)
    model->solver.formulation = MBD_ONE_STEP;
}

/* Hand every element of the array `key` to `load`. */
static void load_array(tdm_object *o, const char *key, bool required, mbd_model *model,
                       void (*load)(mbd_model *, json_t *, const char *, tdm_error *)) {
  json_t *array = tdm_get_array(o, key, required);
  for (size_t i = 0; i < json_array_size(array) && !o->err->status; i++) {
    char path[TDM_PATH_MAX];
    load(model, json_array_get(array, i), tdm_path(path, o, key, (int)i), o->err);
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
    for (int k = 0; k < (j->of[0] ? 2 : 1); k++) {
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
    for (f->rubbing.part = 0; m->part[f->rubbing.part].joint != f->joint;)
      f->rubbing.part++;
    m->part[m->npart++] = (mbd_part){
        .joint = f->joint, .friction = f, .turn = -1, .body = {f->body[0], f->body[1]}, .row = f->rubbing.row};
  }
}

tdm_status mbd_model_read(mbd_model **model, json_t *json, tdm_error *err) {
  mbd_model *m = *model = calloc(1, sizeof *m);
  if (!m)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the model");
  m->body = calloc(array_room(json, "bodies"), sizeof *m->body);
  m->joint = calloc(array_room(json, "joints"), sizeof *m->joint);
  m->driver = calloc(array_room(json, "drivers"), sizeof *m->driver);
  m->force = calloc(array_room(json, "forces"), sizeof *m->force);
  m->friction = calloc(array_room(json, "forces"), sizeof *m->friction);
  size_t parts = 2 * array_room(json, "joints") + array_room(json, "drivers") + array_room(json, "forces");
  m->part = calloc(parts, sizeof *m->part);
  if (!m->body || !m->joint || !m->driver || !m->force || !m->friction || !m->part)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the model");

  const tdm_vec3 earth = {0, 0, -9.81};
  m->section = json;
  tdm_object o = tdm_object_open(json, "mbd", err);
  m->gravity = tdm_get_vec3(&o, "gravity", &earth);
  load_array(&o, "bodies", true, m, mbd_body_read);
  if (!err->status && m->nbody == 0)
    tdm_object_fail(&o, "bodies", "is empty; give at least one body");
  load_array(&o, "joints", false, m, load_joint);
  m->njointrow = m->nrow;
  load_array(&o, "drivers", false, m, load_driver);
  load_array(&o, "forces", false, m, load_force);
  if (!err->status) {
    list_parts(m);
    mbd_slim_settle(m, err);
  }
  load_solver(m, &o);
  m->section = NULL;
  tdm_object_close(&o);
  return err->status;
}

tdm_status mbd_model_couple(mbd_model *model, const tdm_assigned_body *body, int nbody, tdm_error *err) {
  model->coupled = calloc((size_t)nbody + 1, sizeof *model->coupled);
  if (!model->coupled)
    return tdm_fail(err, TDM_ERR_MEMORY, "coupling.bodies", "no memory for %d coupled bodies", nbody);
  for (int i = 0; i < nbody; i++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "coupling.bodies[%d].mbd", i);
    int b = mbd_model_find_body(model, body[i].name);
    if (b == MBD_GROUND)
      return tdm_fail(err, TDM_ERR_SCENE, path, "the ground cannot be coupled; name one of mbd.bodies");
    if (b < 0) {
      const char *near = mbd_model_nearest_body(model, body[i].name, false);
      return tdm_fail(err, TDM_ERR_SCENE, path, "mbd.bodies has no body \"%s\"%s%s%s; name one of its bodies",
                      body[i].name, near ? " (did you mean \"" : "", near ? near : "", near ? "\"?)" : "");
    }
    if (model->body[b].slim)
      return tdm_fail(err, TDM_ERR_SCENE, path,
                      "the body \"%s\" has no inertia about its own axis, so that the particles' torque about it has "
                      "nothing to work on; give it one, or a \"shape\"",
                      body[i].name);
    for (int k = 0; k < i; k++)
      if (model->coupled[k] == b)
        return tdm_fail(err, TDM_ERR_SCENE, path, "the body \"%s\" is coupled already; couple every body once",
                        body[i].name);
    model->coupled[i] = b;
  }
  model->ncoupled = nbody;
  return TDM_OK;
}

tdm_status mbd_model_check_times(const mbd_model *model, double t0, double t1, tdm_error *err) {
  char path[TDM_PATH_MAX];
  for (int i = 0; i < model->ndriver; i++) {
    snprintf(path, sizeof path, "mbd.drivers[%d].motion", i);
    if (tdm_motion_check(&model->driver[i].motion, t0, t1, path, model->driver[i].name, err))
      return err->status;
  }
  for (int i = 0; i < model->nforce; i++) {
    snprintf(path, sizeof path, "mbd.forces[%d].factor", i);
    if (tdm_motion_check(&model->force[i].factor, t0, t1, path, model->force[i].name, err))
      return err->status;
  }
  return TDM_OK;
}

void mbd_model_destroy(mbd_model **model) {
  if (!model || !*model)
    return;
  for (int i = 0; i < (*model)->nbody; i++)
    mbd_body_clear(&(*model)->body[i]);
  free((*model)->body);
  free((*model)->joint);
  for (int i = 0; i < (*model)->ndriver; i++)
    tdm_motion_clear(&(*model)->driver[i].motion);
  free((*model)->driver);
  free((*model)->part);
  free((*model)->friction);
  for (int i = 0; i < (*model)->nforce; i++)
    mbd_force_clear(&(*model)->force[i]);
  free((*model)->force);
  free((*model)->coupled);
  free(*model);
  *model = NULL;
}
