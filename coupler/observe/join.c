/* What there is to see of two solvers: see join.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/observe/join.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- sceneries ---- */

static int find_body(const tdm_scenery *scenery, const char *name) {
  for (int k = 0; k < scenery->nbody; k++)
    if (strncmp(scenery->body[k].name, name, TDM_VIEW_NAME_MAX - 1) == 0)
      return k;
  return -1;
}

/* Bodies of both, and where each went. */
static tdm_status join_bodies(cpl_join *j, const cpl_settings *s, const tdm_scenery of[CPL_NROLE], tdm_scenery *both,
                              tdm_error *err) {
  const tdm_scenery *mbd = &of[CPL_MBD], *dem = &of[CPL_DEM];
  for (int k = 0; k < dem->nbody; k++)
    j->body[CPL_DEM][k] = -1;
  for (int k = 0; k < mbd->nbody; k++) {
    j->body[CPL_MBD][k] = k;
    if (tdm_scenery_add_body(both, &mbd->body[k], err) != TDM_OK)
      return err->status;
  }
  for (int i = 0; i < s->nbody; i++) {
    const int m = find_body(mbd, s->body[i].name[CPL_MBD]), d = find_body(dem, s->body[i].name[CPL_DEM]);
    if (m >= 0 && d >= 0) {
      j->body[CPL_DEM][d] = m;
      both->body[m].dem = true;
    }
  }
  for (int k = 0; k < dem->nbody; k++) {
    if (j->body[CPL_DEM][k] >= 0)
      continue;
    j->body[CPL_DEM][k] = both->nbody;
    if (tdm_scenery_add_body(both, &dem->body[k], err) != TDM_OK)
      return err->status;
  }
  j->nbody = both->nbody;
  return TDM_OK;
}

/* All polygons of DEM, then those of mbd's bodies that have none of them. */
static tdm_status join_polygons(cpl_join *j, const tdm_scenery of[CPL_NROLE], tdm_scenery *both, tdm_error *err) {
  bool *drawn = calloc((size_t)j->nbody + 1, sizeof *drawn);
  if (!drawn)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int k = 0; k < j->nbody; k++)
    both->body[k].marked = true;
  static const cpl_role order[] = {CPL_DEM, CPL_MBD};
  for (int r = 0; r < CPL_NROLE && err->status == TDM_OK; r++) {
    const tdm_scenery *one = &of[order[r]];
    for (int k = 0; k < one->npolygon && err->status == TDM_OK; k++) {
      tdm_view_polygon p = one->polygon[k];
      p.body = j->body[order[r]][p.body];
      if (order[r] == CPL_MBD && drawn[p.body])
        continue;
      tdm_scenery_add_polygon(both, &p, err);
      both->body[p.body].marked = false;
    }
    for (int k = 0; k < both->npolygon; k++)
      drawn[both->polygon[k].body] = true;
    if (order[r] == CPL_DEM)
      j->npolygon_of_dem = both->npolygon;
  }
  j->npolygon = both->npolygon;
  free(drawn);
  return err->status;
}

static tdm_status join_rest(const tdm_scenery of[CPL_NROLE], tdm_scenery *both, tdm_error *err) {
  for (int r = 0; r < CPL_NROLE; r++) {
    const tdm_scenery *one = &of[r];
    for (int k = 0; k < one->nline && err->status == TDM_OK; k++)
      tdm_scenery_add_line(both, one->line[k].name, one->line[k].kind, err);
    for (int k = 0; k < one->nmaterial && err->status == TDM_OK; k++)
      tdm_scenery_add_material(both, one->material[k].name, err);
    for (int k = 0; k < one->nedge && err->status == TDM_OK; k++)
      tdm_scenery_add_edge(both, one->edge[k], err);
    if (tdm_norm(one->gravity) > 0)
      both->gravity = one->gravity;
  }
  return err->status;
}

tdm_status cpl_join_sceneries(cpl_join *j, const cpl_settings *s, const tdm_scenery of[CPL_NROLE], tdm_scenery *both,
                              tdm_error *err) {
  tdm_scenery_clear(both);
  for (int r = 0; r < CPL_NROLE; r++) {
    j->body[r] = calloc((size_t)of[r].nbody + 1, sizeof *j->body[r]);
    if (!j->body[r])
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  }
  return join_bodies(j, s, of, both, err) == TDM_OK && join_polygons(j, of, both, err) == TDM_OK
             ? join_rest(of, both, err)
             : err->status;
}

/* ---- snapshots ---- */

static tdm_status join_lines(const tdm_snapshot of[CPL_NROLE], tdm_snapshot *both, tdm_error *err) {
  for (int r = 0, line = 0; r < CPL_NROLE; r++)
    for (int k = 0, point = 0; k < of[r].nline; k++) {
      for (; point < of[r].line_end[k]; point++)
        if (tdm_snapshot_add_point(both, of[r].point[point], err) != TDM_OK)
          return err->status;
      tdm_snapshot_end_line(both, line++);
    }
  return TDM_OK;
}

tdm_status cpl_join_snapshots(const cpl_join *j, const tdm_snapshot of[CPL_NROLE], tdm_snapshot *both, tdm_error *err) {
  const tdm_snapshot *dem = &of[CPL_DEM], *mbd = &of[CPL_MBD];
  const int nforce = dem->nforce > 0 ? j->npolygon : 0;
  if (tdm_snapshot_resize(both, j->nbody, mbd->nline + dem->nline, nforce, mbd->nparticle + dem->nparticle, err) !=
          TDM_OK ||
      join_lines(of, both, err) != TDM_OK)
    return err->status;
  for (int k = 0; k < dem->nbody; k++)
    both->pose[j->body[CPL_DEM][k]] = dem->pose[k];
  for (int k = 0; k < mbd->nbody; k++) /* mbd's state wins */
    both->pose[j->body[CPL_MBD][k]] = mbd->pose[k];
  for (int k = 0; k < nforce; k++)
    both->force_on[k] = k < j->npolygon_of_dem ? dem->force_on[k] : (tdm_vec3){NAN, NAN, NAN};
#define X(type, name, numbers, unit, text)                                      \
  if (mbd->nparticle > 0)                                                       \
    memcpy(both->name, mbd->name, (size_t)mbd->nparticle * sizeof *both->name); \
  if (dem->nparticle > 0)                                                       \
    memcpy(both->name + mbd->nparticle, dem->name, (size_t)dem->nparticle * sizeof *both->name);
  TDM_VIEW_PARTICLE_LIST(X)
#undef X
  for (int k = 0; k < dem->ncontact; k++)
    if (tdm_snapshot_add_contact(both, &dem->contact[k], err) != TDM_OK)
      return err->status;
  if (dem->norientation == 0 || mbd->nparticle > 0)
    return TDM_OK;
  if (tdm_snapshot_orient(both, err) == TDM_OK)
    memcpy(both->orientation, dem->orientation, (size_t)dem->norientation * sizeof *both->orientation);
  return err->status;
}

void cpl_join_free(cpl_join *j) {
  for (int r = 0; r < CPL_NROLE; r++)
    free(j->body[r]);
  *j = (cpl_join){0};
}
