/* Results in the formats of MOLDYN's viewers: see moldyn_files.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/output/moldyn_files.h"

#include <errno.h>
#include <string.h>

static const char path[] = "output.moldyn";

/* ---- opening ---- */

static tdm_status check(bool xb, bool str, const dem_model *m, tdm_error *err) {
  if (!m->oriented)
    return tdm_fail(err, TDM_ERR_SCENE, path, "\"%s\" shows how particles are turned; set dem.orientation to true",
                    xb ? "xb" : "str");
  if (xb && m->flat < 0)
    return tdm_fail(err, TDM_ERR_SCENE, path, "\"xb\" is for two dimensions; set dem.dimension to 2, or use \"str\"");
  if (str && (m->nsource > 0 || m->nsink > 0 || m->domain.open))
    return tdm_fail(err, TDM_ERR_SCENE, path,
                    "\"str\" has the same particles at all times, but this scene has sources, sinks or an open "
                    "dem.domain; leave it out");
  return TDM_OK;
}

/* walls as rows: a wall with parts that have a middle has a row each */
static int parts_of(const dem_wall *w) {
  return w->shape->parts && w->shape->middle ? w->shape->parts(w) : 1;
}

static int wall_rows(const dem_model *m) {
  int n = 0;
  for (int w = 0; w < m->nwall; w++)
    n += parts_of(&m->wall[w]);
  return n;
}

tdm_status dem_moldyn_open(dem_moldyn_files *f, bool xb, bool str, const dem_data *d, double interval,
                           const tdm_results *r, tdm_error *err) {
  if (!xb && !str)
    return TDM_OK;
  if (check(xb, str, d->model, err))
    return err->status;
  f->xb = xb ? tdm_results_file(r, "particles.xb", err) : NULL;
  f->str = str ? tdm_results_file(r, "scene.str", err) : NULL;
  if (f->str)
    fprintf(f->str, "%.9g %d 12\n", interval, d->state.nparticle + wall_rows(d->model));
  return err->status;
}

/* ---- XBALLS ---- */

/* The ends of the box along an axis: planes across it, or else what the scene reaches. */
static void box_along(const dem_data *d, const dem_bounds *bounds, int axis, double *low, double *high) {
  *low = (&bounds->low.x)[axis];
  *high = (&bounds->high.x)[axis];
  for (int w = 0; w < d->model->nwall; w++) {
    double n = (&d->state.wall[w].normal.x)[axis], at = (&d->state.wall[w].point.x)[axis];
    if (!d->model->wall[w].shape->half_space || fabs(n) < 1 - 1e-9)
      continue;
    *(n > 0 ? low : high) = at;
  }
}

static void write_xb(FILE *f, const dem_data *d, const tdm_snapshot *s, const dem_bounds *bounds) {
  const int flat = d->model->flat, a = flat == 0 ? 1 : 0, b = flat == 2 ? 1 : 2;
  double low[2], high[2];
  box_along(d, bounds, a, &low[0], &high[0]);
  box_along(d, bounds, b, &low[1], &high[1]);
  fprintf(f, "%d %.9g %.9g %.9g %.9g %.9g\n", s->nparticle, s->time, low[0], low[1], high[0], high[1]);
  for (int i = 0; i < s->nparticle; i++) {
    const double *x = &s->position[i].x, *v = &s->velocity[i].x;
    const tdm_vec3 turn = tdm_quat_to_rotvec(s->orientation[i]);
    double angle = (&turn.x)[flat];
    fprintf(f, "%.9g %.9g %.9g %.9g %.9g %.9g\n", x[a], x[b], v[a], v[b], s->radius[i], angle);
  }
}

/* ---- ANIM ---- */

static void write_place(FILE *f, tdm_quat orientation, tdm_vec3 x) {
  tdm_mat3 m = tdm_quat_to_matrix(orientation);
  for (int k = 0; k < 9; k++)
    fprintf(f, "%.9g ", m.m[k / 3][k % 3]);
  fprintf(f, "%.9g %.9g %.9g\n", x.x, x.y, x.z);
}

static void write_str(FILE *f, const dem_data *d, const tdm_snapshot *s) {
  const dem_model *m = d->model;
  for (int i = 0; i < s->nparticle; i++)
    write_place(f, s->orientation[i], s->position[i]);
  for (int w = 0; w < m->nwall; w++) {
    const dem_wall *wall = &m->wall[w];
    const tdm_pose *pose = &d->state.pose[wall->body];
    bool parts = wall->shape->parts && wall->shape->middle;
    for (int p = 0; p < parts_of(wall); p++)
      write_place(f, pose->orientation,
                  parts ? dem_wall_world(&d->state.wall[w], wall->shape->middle(wall, p)) : d->state.wall[w].point);
  }
}

/* ---- both ---- */

static void begin(dem_moldyn_files *f, const dem_data *d, const tdm_snapshot *s) {
  f->bounds = dem_fixed_bounds(d);
  for (int i = 0; i < s->nparticle; i++)
    dem_bounds_add(&f->bounds, s->position[i], s->radius[i]);
  f->begun = true;
}

bool dem_moldyn_wanted(const dem_moldyn_files *f) {
  return f->xb || f->str;
}

tdm_status dem_moldyn_write(dem_moldyn_files *f, const dem_data *d, const tdm_snapshot *s, tdm_error *err) {
  if (dem_moldyn_wanted(f) && !f->begun)
    begin(f, d, s);
  if (f->xb)
    write_xb(f->xb, d, s, &f->bounds);
  if (f->str)
    write_str(f->str, d, s);
  if ((f->xb && (fflush(f->xb) || ferror(f->xb))) || (f->str && (fflush(f->str) || ferror(f->str))))
    return tdm_fail(err, TDM_ERR_FILE, path, "a result file cannot be written: %s", strerror(errno));
  return TDM_OK;
}

void dem_moldyn_close(dem_moldyn_files *f, tdm_error *err) {
  FILE *const files[] = {f->xb, f->str};
  for (int k = 0; k < 2; k++)
    if (files[k] && fclose(files[k]) != 0)
      tdm_fail(err, TDM_ERR_FILE, path, "a result file cannot be written: %s", strerror(errno));
  *f = (dem_moldyn_files){0};
}
