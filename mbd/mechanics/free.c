/* Directions in which nothing holds a body: see free.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/mechanics/free.h"

int mbd_free_directions(const mbd_model *model, const mbd_data *data, int body, tdm_vec3 out[3]) {
  const mbd_part *holds = NULL;
  for (int i = 0; i < model->nforce; i++)
    if (model->force[i].body[0] == body || model->force[i].body[1] == body)
      return 0;
  for (int i = 0; i < model->npart; i++) {
    const mbd_part *p = &model->part[i];
    if (p->body[0] != body && p->body[1] != body)
      continue;
    if (holds || p->driver || !p->joint->ops->guides)
      return 0;
    holds = p;
  }
  if (!holds) {
    out[0] = tdm_v3(1, 0, 0), out[1] = tdm_v3(0, 1, 0), out[2] = tdm_v3(0, 0, 1);
    return 3;
  }
  const int side = holds->body[0] == body ? 0 : 1;
  if (holds->body[1 - side] != MBD_GROUND)
    return 0;
  const mbd_kin kin = {.A = tdm_quat_to_matrix(tdm_quat_unit(mbd_quat_of(data->y, body)))};
  out[0] = mbd_joint_axis(holds->joint, side, 2, &kin);
  return 1;
}
