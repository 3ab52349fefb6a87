/* The multibody model, once it is read: see model.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/model/model.h"

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
    const mbd_force *f = &model->force[i];
    snprintf(path, sizeof path, "mbd.forces[%d]", i);
    if (f->ops->check_times && f->ops->check_times(f, t0, t1, path, err))
      return err->status;
  }
  return TDM_OK;
}

static void clear_body(mbd_body *body) {
  free(body->marker);
  free(body->mesh);
}

void mbd_model_destroy(mbd_model **model) {
  mbd_model *m = model ? *model : NULL;
  if (!m)
    return;
  for (int i = 0; i < m->nbody; i++)
    clear_body(&m->body[i]);
  for (int i = 0; i < m->njoint; i++)
    free(m->joint[i].own);
  for (int i = 0; i < m->ndriver; i++)
    tdm_motion_clear(&m->driver[i].motion);
  for (int i = 0; i < m->nforce; i++) {
    mbd_force *f = &m->force[i];
    if (f->own && f->ops->clear)
      f->ops->clear(f);
    free(f->own);
  }
  free(m->body);
  free(m->joint);
  free(m->driver);
  free(m->force);
  free(m->part);
  free(m->friction);
  free(m->coupled);
  free(m);
  *model = NULL;
}
