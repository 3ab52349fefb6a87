/* What an FMU's variables are of the coupled bodies: see mapping.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/foreign/fmu/mapping.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- inputs ---- */

static double value_of(fmu_slot slot, const double *value) {
  return slot.at >= 0 ? slot.value * value[slot.at] : slot.value;
}

static tdm_vec3 vector_of(const fmu_slot slot[3], const double *value, double unit) {
  return tdm_v3(unit * value_of(slot[0], value), unit * value_of(slot[1], value), unit * value_of(slot[2], value));
}

void fmu_mapping_inputs(const fmu_mapping *m, const tdm_state *state, const tdm_wrench *load, double *value) {
  for (int i = 0; i < m->nbody; i++) {
    const fmu_body *b = &m->body[i];
    const tdm_pose pose = state[i].pose;
    tdm_vec3 moment = load[i].moment;
    if (b->about == FMU_ABOUT_POINT)
      moment = tdm_sub(moment, tdm_cross(tdm_quat_rotate(pose.orientation, b->point), load[i].force));
    else if (b->about == FMU_ABOUT_ORIGIN)
      moment = tdm_add(moment, tdm_cross(tdm_sub(pose.position, b->origin), load[i].force));
    const tdm_quat to = tdm_quat_conj(b->load_in_body ? pose.orientation : b->frame);
    const tdm_vec3 f = tdm_scale(1 / m->force, tdm_quat_rotate(to, load[i].force));
    const tdm_vec3 n = tdm_scale(1 / (m->force * m->length), tdm_quat_rotate(to, moment));
    const double all[6] = {f.x, f.y, f.z, n.x, n.y, n.z};
    for (int k = 0; k < 6; k++)
      if (b->load[k].at >= 0)
        value[b->load[k].at] = b->load[k].value * all[k];
  }
}

/* ---- outputs ---- */

/* The body's orientation in F. */
static tdm_quat orientation_of(const fmu_mapping *m, const fmu_body *b, const double *value) {
  double v[9];
  tdm_mat3 matrix;
  for (int k = 0; k < 9; k++)
    v[k] = value_of(b->orientation[k], value);
  switch (b->turn) {
  case FMU_EULER313:
    return tdm_euler313_to_quat(
        (tdm_euler313){.phi = m->angle * v[0], .theta = m->angle * v[1], .psi = m->angle * v[2]});
  case FMU_QUATERNION:
    return tdm_quat_unit((tdm_quat){v[0], v[1], v[2], v[3]});
  case FMU_MATRIX:
    memcpy(matrix.m, v, sizeof matrix.m);
    return tdm_quat_unit(tdm_quat_from_matrix(matrix));
  case FMU_ANGLE:
    return tdm_quat_from_rotvec(tdm_scale(m->angle * v[0], b->axis));
  case FMU_FIXED:
    break;
  }
  return tdm_quat_identity();
}

void fmu_mapping_states(const fmu_mapping *m, const double *value, tdm_state *state) {
  for (int i = 0; i < m->nbody; i++) {
    const fmu_body *b = &m->body[i];
    const tdm_quat q = tdm_quat_unit(tdm_quat_mul(b->frame, orientation_of(m, b, value)));
    const tdm_vec3 r = tdm_quat_rotate(q, b->point);
    const tdm_vec3 w = tdm_quat_rotate(b->angular_in_body ? q : b->frame, vector_of(b->angular, value, m->angle));
    const tdm_vec3 x = tdm_add(b->origin, tdm_quat_rotate(b->frame, vector_of(b->position, value, m->length)));
    const tdm_vec3 v = tdm_quat_rotate(b->frame, vector_of(b->velocity, value, m->length));
    state[i] = (tdm_state){.pose = {tdm_sub(x, r), q}, .twist = {tdm_sub(v, tdm_cross(w, r)), w}};
  }
}

void fmu_mapping_accelerations(const fmu_mapping *m, const double *value, const tdm_state *state, bool linear,
                               double *out) {
  for (int i = 0; i < m->nbody; i++) {
    const fmu_body *b = &m->body[i];
    const tdm_quat q = state[i].pose.orientation;
    const tdm_vec3 r = tdm_quat_rotate(q, b->point), w = state[i].twist.angular;
    const tdm_vec3 rate =
        tdm_quat_rotate(b->angular_in_body ? q : b->frame, vector_of(b->angular_rate, value, m->angle));
    tdm_vec3 a = tdm_quat_rotate(b->frame, vector_of(b->acceleration, value, m->length));
    a = tdm_sub(a, tdm_cross(rate, r));
    if (!linear)
      a = tdm_sub(a, tdm_cross(w, tdm_cross(w, r)));
    const double all[6] = {a.x, a.y, a.z, rate.x, rate.y, rate.z};
    memcpy(out + 6 * i, all, sizeof all);
  }
}

/* ---- start ---- */

tdm_status fmu_mapping_start(const fmu_mapping *m, tdm_error *err) {
  const char *name;
  json_t *value;
  json_object_foreach(m->parameters, name, value) {
    char path[TDM_PATH_MAX];
    const tdm_fmi_variable *v = tdm_description_find(&m->fmu->description, name);
    snprintf(path, sizeof path, "mbd.parameters.%s", name);
    if (tdm_fmu_set_start(m->fmu, v, value, path, err) != TDM_OK)
      break;
  }
  return err->status;
}

void fmu_mapping_free(fmu_mapping *m) {
  fmu_list *const lists[] = {&m->inputs, &m->outputs};
  for (int k = 0; k < 2; k++) {
    free(lists[k]->variable);
    free(lists[k]->reference);
    free(lists[k]->first);
  }
  free(m->body);
  free(m->channel);
  *m = (fmu_mapping){0};
}
