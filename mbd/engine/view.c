/* What there is to see of a mechanism: see view.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/engine/view.h"

#include "protocol/scene/remark.h"
#include "protocol/surface/stl.h"

#include <stdio.h>

/* ---- surfaces ---- */

static tdm_status draw_mesh(const mbd_body *b, int k, tdm_scenery *scenery, tdm_error *err) {
  tdm_stl stl = {0};
  tdm_error own = {0};
  tdm_status status = TDM_OK;
  if (tdm_stl_read(&stl, b->mesh, b->scale, NULL, &own) != TDM_OK) {
    tdm_remark(TDM_NOTICE, "mesh_gone", b->name, 0, "%s; body \"%s\" is drawn as a mark", own.message, b->name);
    stl.count = 0;
  }
  for (int t = 0; t < stl.count && status == TDM_OK; t++) {
    tdm_view_polygon piece = {.body = k, .solid = true, .ncorner = 3};
    for (int c = 0; c < 3; c++)
      piece.corner[c] = tdm_add(stl.corner[3 * t + c], b->origin);
    status = tdm_scenery_add_polygon(scenery, &piece, err);
  }
  tdm_stl_destroy(&stl);
  return status;
}

static tdm_status draw_body(const mbd_body *b, int k, tdm_scenery *scenery, tdm_error *err) {
  tdm_view_body body = {.mbd = true};
  int before = scenery->npolygon;
  snprintf(body.name, sizeof body.name, "%s", b->name);
  if (tdm_scenery_add_body(scenery, &body, err) != TDM_OK ||
      (b->mesh ? draw_mesh(b, k, scenery, err) : TDM_OK) != TDM_OK ||
      (b->outline.draw ? b->outline.draw(&b->outline, k, scenery, err) : TDM_OK) != TDM_OK)
    return err->status;
  scenery->body[k].marked = scenery->npolygon == before;
  return TDM_OK;
}

/* ---- lines ---- */

/* Where lines go: names and kinds to a scenery, or points to a snapshot. */
typedef struct {
  const mbd_model *model;
  tdm_scenery *scenery;   /* NULL: points are wanted */
  tdm_snapshot *snapshot; /* NULL: names are wanted */
  int nline;
  tdm_error *err;
} pen;

/* a point that is fixed to a body, or to the ground, in world axes */
static tdm_vec3 point_of(const pen *p, int body, tdm_vec3 arm) {
  if (body == MBD_GROUND)
    return arm;
  const tdm_pose *pose = &p->snapshot->pose[body];
  return tdm_add(pose->position, tdm_quat_rotate(pose->orientation, arm));
}

/* A line between two places on bodies; a dot where they coincide. */
static tdm_status line(pen *p, const char *name, tdm_view_line_kind kind, const int body[2], const tdm_vec3 arm[2]) {
  if (p->scenery)
    return tdm_scenery_add_line(p->scenery, name, kind, p->err);
  tdm_vec3 a = point_of(p, body[0], arm[0]), b = point_of(p, body[1], arm[1]);
  bool apart = tdm_norm(tdm_sub(b, a)) > 1e-9 * (1 + tdm_norm(a));
  if (tdm_snapshot_add_point(p->snapshot, a, p->err) != TDM_OK ||
      (apart && tdm_snapshot_add_point(p->snapshot, b, p->err) != TDM_OK))
    return p->err->status;
  tdm_snapshot_end_line(p->snapshot, p->nline++);
  return TDM_OK;
}

/* A short line along a joint's axis, through its point: what turns about it. */
static tdm_status axis(pen *p, const char *name, tdm_view_line_kind kind, const mbd_joint *j) {
  const double half = 0.04 * mbd_model_extent(p->model);
  const tdm_mat3 *e = &j->axes[0];
  const tdm_vec3 along = {e->m[0][2], e->m[1][2], e->m[2][2]};
  const int both[2] = {j->body[0], j->body[0]};
  const tdm_vec3 ends[2] = {tdm_axpy(-half, along, j->arm[0]), tdm_axpy(half, along, j->arm[0])};
  return line(p, name, kind, both, ends);
}

/* Bodies without a shape: a bar from the centre of mass to each place where something takes hold of it. */
static tdm_status bars(pen *p, const int body[2], const tdm_vec3 arm[2]) {
  for (int side = 0; side < 2; side++) {
    const mbd_body *b = body[side] == MBD_GROUND ? NULL : &p->model->body[body[side]];
    const int both[2] = {body[side], body[side]};
    const tdm_vec3 ends[2] = {{0, 0, 0}, arm[side]};
    if (b && !b->mesh && !b->outline.draw && line(p, b->name, TDM_VIEW_LINE_bar, both, ends) != TDM_OK)
      return p->err->status;
  }
  return TDM_OK;
}

static tdm_status lines(pen *p) {
  const mbd_model *m = p->model;
  for (int i = 0; i < m->njoint; i++) {
    const mbd_joint *j = &m->joint[i];
    if (j->ops->couples)
      continue;
    if (line(p, j->name, TDM_VIEW_LINE_joint, j->body, j->arm) != TDM_OK || bars(p, j->body, j->arm) != TDM_OK)
      return p->err->status;
  }
  for (int i = 0; i < m->ndriver; i++) {
    const mbd_driver *d = &m->driver[i];
    if (d->ops->coordinate == MBD_TRANSLATION &&
        line(p, d->name, TDM_VIEW_LINE_cylinder, d->joint->body, d->joint->arm) != TDM_OK)
      return p->err->status;
  }
  for (int i = 0; i < m->nforce; i++) {
    const mbd_force *f = &m->force[i];
    if (f->ops->spans &&
        (line(p, f->name, f->ops->line, f->body, f->frame.arm) != TDM_OK || bars(p, f->body, f->frame.arm) != TDM_OK))
      return p->err->status;
    if (f->ops->twists && f->joint != &f->frame && axis(p, f->name, f->ops->line, f->joint) != TDM_OK)
      return p->err->status;
  }
  return TDM_OK;
}

tdm_status mbd_view_scenery(const mbd_model *m, tdm_scenery *scenery, tdm_error *err) {
  tdm_scenery_clear(scenery);
  scenery->gravity = m->gravity;
  for (int k = 0; k < m->nbody; k++)
    if (draw_body(&m->body[k], k, scenery, err) != TDM_OK)
      return err->status;
  pen p = {.model = m, .scenery = scenery, .err = err};
  return lines(&p);
}

/* as many as mbd_view_scenery makes */
static int count_lines(const mbd_model *m, tdm_error *err) {
  tdm_scenery names = {0};
  pen p = {.model = m, .scenery = &names, .err = err};
  int n = lines(&p) == TDM_OK ? names.nline : -1;
  tdm_scenery_free(&names);
  return n;
}

tdm_status mbd_view_snapshot(const mbd_model *m, double t, const double *y, tdm_snapshot *snapshot, tdm_error *err) {
  int nline = count_lines(m, err);
  if (nline < 0 || tdm_snapshot_resize(snapshot, m->nbody, nline, 0, 0, err) != TDM_OK)
    return err->status;
  snapshot->time = t;
  for (int k = 0; k < m->nbody; k++)
    snapshot->pose[k] = mbd_body_state(y, k).pose;
  pen p = {.model = m, .snapshot = snapshot, .err = err};
  return lines(&p);
}
