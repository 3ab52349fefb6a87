/* What the readers of bodies, joints, drivers and forces share: see read.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/model/read.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- names ---- */

void mbd_read_name(tdm_object *o, char *out) {
  const char *name = tdm_get_string(o, "name", NULL);
  out[0] = 0;
  if (o->err->status)
    return;
  size_t n = strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-");
  if (n == 0 || name[n] != 0)
    tdm_object_fail(o, "name",
                    "the name \"%s\" must be made of letters, digits, '_' and '-': it becomes part of a column name "
                    "in the results; rename it",
                    name);
  else if (n >= MBD_NAME_MAX)
    tdm_object_fail(o, "name", "the name \"%s\" is too long; use at most %d characters", name, MBD_NAME_MAX - 1);
  else
    memcpy(out, name, n + 1);
}

/* The index of body `name` (the ground counts if asked); -2 after an error at `path`. */
static int body_of(const mbd_model *model, const char *name, bool ground, const char *path, tdm_error *err) {
  int body = name ? mbd_model_find_body(model, name) : -2;
  if (!name)
    tdm_fail(err, TDM_ERR_SCENE, path, "must be the name of a body, in quotes");
  else if (body < (ground ? MBD_GROUND : 0)) {
    const char *near = mbd_model_nearest_body(model, name, ground);
    tdm_fail(err, TDM_ERR_SCENE, path, "%s \"%s\"%s%s%s; name one of mbd.bodies%s",
             body == MBD_GROUND ? "must be a body that moves, not" : "there is no body", name,
             near ? " (did you mean \"" : "", near ? near : "", near ? "\"?)" : "", ground ? " or \"ground\"" : "");
    body = -2;
  }
  return body;
}

void mbd_read_bodies(tdm_object *o, const mbd_model *model, int body[2]) {
  body[0] = body[1] = MBD_GROUND;
  json_t *array = tdm_get_array(o, "bodies", true);
  if (o->err->status)
    return;
  if (json_array_size(array) != 2) {
    tdm_object_fail(o, "bodies", "must name two bodies, such as [\"ground\", \"box\"]");
    return;
  }
  for (int i = 0; i < 2; i++) {
    char path[TDM_PATH_MAX];
    body[i] = body_of(model, json_string_value(json_array_get(array, (size_t)i)), true, tdm_path(path, o, "bodies", i),
                      o->err);
    if (o->err->status) {
      body[i] = MBD_GROUND; /* the reader goes on */
      return;
    }
  }
  if (body[0] == body[1])
    tdm_object_fail(o, "bodies", "connects \"%s\" to itself; name two different bodies",
                    json_string_value(json_array_get(array, 0)));
}

int mbd_read_body(tdm_object *o, const mbd_model *model) {
  const char *name = tdm_get_string(o, "body", NULL);
  char path[TDM_PATH_MAX];
  int body = o->err->status ? -2 : body_of(model, name, false, tdm_path(path, o, "body", -1), o->err);
  return body < 0 ? MBD_GROUND : body;
}

/* ---- joints ---- */

/* "revolute, cylindrical or screw": the types that have one of the coordinates. Returns out. */
static const char *types_with(const mbd_model *model, unsigned coordinates, char *out, size_t size) {
  int count = 0, left = 0;
  const mbd_joint_ops *type;
  for (int i = 0; (type = model->joint_types->row[i]); i++)
    count += (type->coordinates & coordinates) != 0;
  left = count;
  out[0] = 0;
  for (int i = 0; (type = model->joint_types->row[i]); i++) {
    if (!(type->coordinates & coordinates))
      continue;
    size_t used = strlen(out);
    snprintf(out + used, size - used, "%s%s", left == count ? "" : left == 1 ? " or " : ", ", type->name);
    left--;
  }
  return out;
}

/* true: mbd.joints has it behind the joint that is being read */
static bool stands_later(const mbd_model *model, const char *name) {
  const json_t *joints = json_object_get(model->section, "joints");
  for (size_t i = (size_t)model->njoint + 1; i < json_array_size(joints); i++) {
    const char *other = json_string_value(json_object_get(json_array_get(joints, i), "name"));
    if (other && strcmp(other, name) == 0)
      return true;
  }
  return false;
}

static const mbd_joint *joint_of(const mbd_model *model, const char *name, unsigned coordinates, const char *otherwise,
                                 const char *path, tdm_error *err) {
  char types[256];
  types_with(model, coordinates, types, sizeof types);
  for (int i = 0; i < model->njoint; i++) {
    const mbd_joint *j = &model->joint[i];
    if (strcmp(j->name, name) != 0)
      continue;
    if (j->ops->coordinates & coordinates)
      return j;
    tdm_fail(err, TDM_ERR_SCENE, path, "the joint \"%s\" is %s; name a %s joint", name, j->ops->name, types);
    return NULL;
  }
  if (stands_later(model, name)) {
    tdm_fail(err, TDM_ERR_SCENE, path,
             "the joint \"%s\" stands later in mbd.joints; move this joint behind those that it couples", name);
    return NULL;
  }
  const char **names = calloc((size_t)model->njoint + 1, sizeof *names);
  for (int i = 0; names && i < model->njoint; i++)
    names[i] = model->joint[i].name;
  const char *near = names ? tdm_nearest(name, names, model->njoint) : NULL;
  tdm_fail(err, TDM_ERR_SCENE, path, "there is no joint \"%s\"%s%s%s; name a %s joint of mbd.joints%s", name,
           near ? " (did you mean \"" : "", near ? near : "", near ? "\"?)" : "", types, otherwise);
  free(names);
  return NULL;
}

const mbd_joint *mbd_read_joint(tdm_object *o, const char *key, const mbd_model *model, unsigned coordinates,
                                const char *otherwise) {
  const char *name = tdm_get_string(o, key, NULL);
  char path[TDM_PATH_MAX];
  return o->err->status ? NULL : joint_of(model, name, coordinates, otherwise, tdm_path(path, o, key, -1), o->err);
}

const mbd_joint *mbd_read_joint_coordinate(tdm_object *o, const mbd_model *model, mbd_coordinate *coordinate) {
  static const char *const names[] = {"angle", "translation"};
  const mbd_joint *j = mbd_read_joint(o, "joint", model, MBD_HAS_ANGLE | MBD_HAS_TRANSLATION, "");
  if (!j)
    return NULL;
  unsigned has = j->ops->coordinates;
  int fallback = has == MBD_HAS_ANGLE ? MBD_ANGLE : has == MBD_HAS_TRANSLATION ? MBD_TRANSLATION : -1;
  int which = tdm_get_choice(o, "coordinate", names, 2, fallback);
  if (o->err->status)
    return NULL;
  if (!(has & (1u << which))) {
    tdm_object_fail(o, "coordinate", "the joint \"%s\" is %s and has no %s; give the other one, or leave it away",
                    j->name, j->ops->name, names[which]);
    return NULL;
  }
  *coordinate = (mbd_coordinate)which;
  return j;
}

int mbd_read_joints(tdm_object *o, const mbd_model *model, int most, const unsigned coordinates[],
                    const mbd_joint *out[]) {
  json_t *array = tdm_get_array(o, "joints", true);
  const int n = (int)json_array_size(array);
  if (!o->err->status && (n < 2 || n > most))
    tdm_object_fail(o, "joints", "must name two%s joints, such as [\"shaft\", \"wheel\"]", most > 2 ? " or three" : "");
  for (int i = 0; i < n && !o->err->status; i++) {
    char path[TDM_PATH_MAX];
    const char *name = json_string_value(json_array_get(array, (size_t)i));
    tdm_path(path, o, "joints", i);
    if (name)
      out[i] = joint_of(model, name, coordinates[i], " that stands before this one", path, o->err);
    else
      tdm_fail(o->err, TDM_ERR_SCENE, path, "must be the name of a joint, in quotes");
    for (int k = 0; k < i && !o->err->status; k++)
      if (out[k] == out[i])
        tdm_object_fail(o, "joints", "couples the joint \"%s\" to itself; name different joints", name);
  }
  return n;
}

/* ---- points and directions ---- */

/* Marker `name` of a body; NULL after an error at `path`. */
static const mbd_marker *marker_of(const mbd_body *body, const char *name, const char *path, tdm_error *err) {
  const char **names = calloc((size_t)body->nmarker + 1, sizeof *names);
  const mbd_marker *found = NULL;
  for (int i = 0; i < body->nmarker; i++) {
    if (strcmp(body->marker[i].name, name) == 0)
      found = &body->marker[i];
    if (names)
      names[i] = body->marker[i].name;
  }
  const char *near = found || !names ? NULL : tdm_nearest(name, names, body->nmarker);
  if (!found)
    tdm_fail(err, TDM_ERR_SCENE, path,
             "body \"%s\" has no marker \"%s\"%s%s%s; name one of its markers, or give numbers", body->name, name,
             near ? " (did you mean \"" : "", near ? near : "", near ? "\"?)" : "");
  free(names);
  return found;
}

/* "body.marker", or with `direction` "body.marker.x": its point or axis in the world at the start. */
static tdm_vec3 of_marker(const mbd_model *model, const char *text, bool direction, const char *path, tdm_error *err) {
  const tdm_vec3 nothing = {0, 0, 0};
  char name[3][2 * MBD_NAME_MAX] = {"", "", ""};
  int n = 0;
  for (const char *at = text; n < 3; n++) {
    size_t length = strcspn(at, ".");
    snprintf(name[n], sizeof name[n], "%.*s", (int)length, at);
    at += length;
    if (!*at++)
      break;
  }
  const char *axis = strchr("xyz", name[2][0]);
  if (n != (direction ? 2 : 1) || (direction && (!axis || strlen(name[2]) != 1))) {
    tdm_fail(err, TDM_ERR_SCENE, path, "\"%s\" names no %s; give [x, y, z] or \"body.marker%s\"", text,
             direction ? "direction" : "point", direction ? ".z" : "");
    return nothing;
  }
  int b = body_of(model, name[0], false, path, err);
  const mbd_marker *m = b < 0 ? NULL : marker_of(&model->body[b], name[1], path, err);
  if (!m)
    return nothing;
  tdm_pose pose = model->body[b].start.pose;
  if (!direction)
    return tdm_pose_point(pose, m->pose.position);
  const tdm_vec3 e[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  return tdm_quat_rotate(pose.orientation, tdm_quat_rotate(m->pose.orientation, e[name[2][0] - 'x']));
}

/* Three numbers or a marker; a direction is made a unit vector. `key` is for the messages of the numbers. */
static tdm_vec3 vector_of(const mbd_model *model, json_t *json, bool direction, const char *key, const char *path,
                          tdm_error *err) {
  if (json_is_string(json))
    return of_marker(model, json_string_value(json), direction, path, err);
  json_t *wrapped = json_pack("{s:O?}", key, json);
  tdm_error inner = {0};
  tdm_object o = tdm_object_open(wrapped, "(value)", &inner); /* what fails is told with `path` below */
  tdm_vec3 out = tdm_get_vec3(&o, key, NULL);
  if (inner.status)
    tdm_fail(err, inner.status, path, "%s", inner.message);
  else if (direction && tdm_norm(out) < 1e-12)
    tdm_fail(err, TDM_ERR_SCENE, path, "is zero; give a direction");
  json_decref(wrapped);
  return direction ? tdm_unit(out) : out;
}

static tdm_vec3 read_vector(tdm_object *o, const mbd_model *model, const char *key, bool direction) {
  char path[TDM_PATH_MAX];
  const tdm_vec3 nothing = {0, 0, 0};
  if (o->err->status)
    return nothing;
  if (!tdm_has(o, key)) /* its message says that it is missing */
    return tdm_get_vec3(o, key, NULL);
  return vector_of(model, json_object_get(o->json, key), direction, key, tdm_path(path, o, key, -1), o->err);
}

static void read_vectors(tdm_object *o, const mbd_model *model, const char *single, const char *twice, bool direction,
                         tdm_vec3 out[2]) {
  out[0] = out[1] = tdm_v3(0, 0, 0);
  if (single && !tdm_has(o, twice)) {
    out[0] = out[1] = read_vector(o, model, single, direction);
    return;
  }
  json_t *array = tdm_get_array(o, twice, true);
  if (o->err->status)
    return;
  if (single && tdm_has(o, single))
    tdm_object_fail(o, twice, "stands beside \"%s\"; keep one of the two", single);
  else if (json_array_size(array) != 2)
    tdm_object_fail(o, twice, "must be two vectors, one for each body: [[x, y, z], [x, y, z]]");
  for (int i = 0; i < 2 && !o->err->status; i++) {
    char path[TDM_PATH_MAX];
    out[i] = vector_of(model, json_array_get(array, (size_t)i), direction, twice, tdm_path(path, o, twice, i), o->err);
  }
}

tdm_vec3 mbd_read_point(tdm_object *o, const mbd_model *model, const char *key) {
  return read_vector(o, model, key, false);
}

tdm_vec3 mbd_read_direction(tdm_object *o, const mbd_model *model, const char *key) {
  return read_vector(o, model, key, true);
}

void mbd_read_points(tdm_object *o, const mbd_model *model, const char *single, const char *twice, tdm_vec3 out[2]) {
  read_vectors(o, model, single, twice, false, out);
}

void mbd_read_directions(tdm_object *o, const mbd_model *model, const char *single, const char *twice,
                         tdm_vec3 out[2]) {
  read_vectors(o, model, single, twice, true, out);
}
