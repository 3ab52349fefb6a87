/* One set of laws on DEM_W contacts: the part of the loops that pairs and walls share. Only loops.h includes it. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LOOP_APPLY_H
#define DEM_CONTACT_LOOP_APPLY_H

#include "dem/contact/families.h"
#include "dem/contact/law/contact.h"
#include "dem/contact/law/law.h"
#include "dem/contact/law/task.h"
#include "dem/seam/notes.h"
#include "dem/state/data.h"

#define X(law) TANGENTIAL_##law,
enum { DEM_TANGENTIALS(X) };
#undef X
#define X(law) ROLLING_##law,
enum { DEM_ROLLINGS(X) };
#undef X
#define X(law) TWISTING_##law,
enum { DEM_TWISTINGS(X) };
#undef X
#define X(law) COHESION_##law,
enum { DEM_COHESIONS(X) };
#undef X

typedef void normal_law(dem_contact *, vd *history);
typedef dem_tangential tangential_law(dem_contact *, vd *history);

typedef struct batch batch;

/* one row: all of it constant in a loop, but `ncolumn` and `column` with all terms */
typedef struct {
  normal_law *normal;
  tangential_law *tangential;
  int ncolumn, column; /* of history; first of the normal law */
  bool all_terms;
  bool calls;                              /* with all terms: laws that a program adds, through their rows */
  bool rubs;                               /* there are tangential forces or more: spins matter */
  void (*flush)(dem_loop_task *, batch *); /* wall_batch of this row */
  void (*planes)(dem_loop_task *, size_t begin, size_t end); /* plane_loop of this row; not with all terms */
} row;

/* what comes out of a law */
typedef struct {
  vd3 force, twist; /* twist: normal x force */
  vd3 couple;       /* with all terms: rolling and twisting [N m] */
} outcome;

/* ---- what the loops with all terms add ---- */

/* call a law that a program adds */
DEM_INLINE void call_law(dem_call *call, const dem_law_head *law, const dem_contact *c, vd *history) {
  call->contact = *c;
  for (int q = 0; q < law->ncolumn; q++)
    call->history[q] = history[q];
  law->kernel(call);
  for (int q = 0; q < law->ncolumn; q++)
    history[q] = call->history[q];
}

DEM_KERNEL dem_tangential tangential_of_scene(dem_contact *c, vd *history) {
  switch (c->model->place.tangential) {
#define X(law)           \
  case TANGENTIAL_##law: \
    return dem_tangential_##law(c, history);
    DEM_TANGENTIALS(X)
#undef X
  default:
    return dem_tangential_none(c, history);
  }
}

DEM_KERNEL dem_tangential tangential_that_is_called(dem_contact *c, vd *history) {
  const dem_law_head *of = &c->model->tangential->head;
  dem_call call;
  if (!of->kernel)
    return tangential_of_scene(c, history);
  call_law(&call, of, c, history);
  *c = call.contact;
  return call.tangential;
}

DEM_KERNEL void cohesion_of_scene(dem_contact *c, vd *history, const bool calls) {
  const dem_law_head *of = &c->model->cohesion->head;
  if (calls && of->kernel) {
    dem_call call;
    call_law(&call, of, c, history);
    *c = call.contact;
    return;
  }
  switch (c->model->place.cohesion) {
#define X(law)                      \
  case COHESION_##law:              \
    dem_cohesion_##law(c, history); \
    break;
    DEM_COHESIONS(X)
#undef X
  default:
    break;
  }
}

DEM_KERNEL dem_couple rolling_of_scene(const dem_contact *c, vd3 roll, vd *history, const bool calls) {
  const dem_law_head *of = &c->model->rolling->head;
  if (calls && of->kernel) {
    dem_call call = {.spin = roll};
    call_law(&call, of, c, history);
    return call.couple;
  }
  switch (c->model->place.rolling) {
#define X(law)        \
  case ROLLING_##law: \
    return dem_rolling_##law(c, roll, history);
    DEM_ROLLINGS(X)
#undef X
  default:
    return dem_rolling_none(c, roll, history);
  }
}

DEM_KERNEL dem_couple twisting_of_scene(const dem_contact *c, vd3 twist, vd *history, const bool calls) {
  const dem_law_head *of = &c->model->twisting->head;
  if (calls && of->kernel) {
    dem_call call = {.spin = twist};
    call_law(&call, of, c, history);
    return call.couple;
  }
  switch (c->model->place.twisting) {
#define X(law)         \
  case TWISTING_##law: \
    return dem_twisting_##law(c, twist, history);
    DEM_TWISTINGS(X)
#undef X
  default:
    return dem_twisting_none(c, twist, history);
  }
}

/* add the lanes that touch to a mechanism's power and store */
DEM_INLINE void add_flux(dem_flux *flux, int mechanism, const dem_contact *c, vd power, vd elastic) {
  double p[DEM_W], e[DEM_W];
  vd_store(p, vd_only(c->touching, power));
  vd_store(e, vd_only(c->touching, elastic));
  for (int l = 0; l < DEM_W; l++) {
    flux->power[mechanism] += p[l];
    flux->elastic[mechanism] += e[l];
  }
}

DEM_KERNEL void energy_of_scene(dem_flux *flux, int walls, const dem_contact *c, const dem_tangential *t,
                                const dem_couple *couple) {
  const dem_normal_law *law = walls ? c->model->wall_normal : c->model->normal;
  int normal = law->plastic ? DEM_ENERGY_PLASTIC : DEM_ENERGY_NORMAL;
  add_flux(flux, walls + normal, c, (c->force + c->pull) * c->rate, c->elastic);
  add_flux(flux, walls + DEM_ENERGY_TANGENTIAL, c, -vd3_dot(t->force, c->slip), t->elastic);
  add_flux(flux, walls + DEM_ENERGY_ROLLING, c, -vd3_dot(couple->couple, c->spin), couple->elastic);
}

/* rolling and twisting, energies; `walls`: 0, or DEM_ENERGY_WALL_NORMAL for contacts with walls */
DEM_KERNEL vd3 law_all_terms(dem_loop_task *task, dem_contact *c, const dem_tangential *t, vd *h, int walls,
                             const bool calls) {
  const dem_columns *columns = &c->model->columns;
  vd along = vd3_dot(c->spin, c->normal);
  vd3 twist = vd3_scale(along, c->normal);
  dem_couple couple =
      rolling_of_scene(c, vd3_sub(c->spin, twist), h + (columns->rolling < 0 ? 0 : columns->rolling), calls);
  dem_couple twisting = twisting_of_scene(c, twist, h + (columns->twisting < 0 ? 0 : columns->twisting), calls);
  couple.couple = vd3_add(couple.couple, twisting.couple);
  couple.elastic = couple.elastic + twisting.elastic;
  if (columns->sliding >= 0)
    h[columns->sliding] = c->sliding;
  if (c->model->energy)
    energy_of_scene(&task->flux, walls, c, t, &couple);
  return vd3_only(c->touching, couple.couple);
}

/* ---- the laws ---- */

/* The laws on DEM_W contacts; `velocity` is the relative velocity at the contact, `history` their slots at stride. */
DEM_KERNEL outcome law(dem_loop_task *task, dem_contact *c, vd3 velocity, double *history, size_t stride, const row r,
                       int walls) {
  vd away = vd3_dot(velocity, c->normal);
  c->rate = -away;
  c->slip = vd3_axpy(-away, c->normal, velocity);
  vd h[DEM_HISTORY_MAX];
  for (int q = 0; q < r.ncolumn; q++)
    h[q] = vd_load(history + (size_t)q * stride);
  r.normal(c, h + r.column);
  if (r.all_terms) {
    const dem_columns *columns = &c->model->columns;
    c->pull = vd_set(0);
    cohesion_of_scene(c, h + (columns->cohesion < 0 ? 0 : columns->cohesion), r.calls);
    c->sliding = columns->sliding < 0 ? vd_set(0) : h[columns->sliding];
  }
  dem_tangential t = r.tangential(c, h);
  outcome out = {0};
  if (r.all_terms)
    out.couple = law_all_terms(task, c, &t, h, walls, r.calls);
  for (int q = 0; q < r.ncolumn; q++)
    vd_store(history + (size_t)q * stride, vd_only(c->touching, h[q]));
  vd along = c->force;
  if (r.all_terms)
    along = along + c->pull;
  out.force = vd3_only(c->touching, vd3_axpy(along, c->normal, t.force));
  out.twist = vd3_only(c->touching, vd3_cross(c->normal, t.force));
  return out;
}

/* a contact of which the lanes are still to be filled; no lane is touched */
DEM_INLINE void begin_contact(const dem_loop_task *task, const row r, dem_contact *c) {
  const dem_model *m = task->model;
  c->dt = task->dt;
  c->model = m;
  c->all_terms = r.all_terms;
  c->pair.table = task->settling ? m->settle_pair : m->pair;
  c->pair.one = m->nmaterial == 1;
}

/* likewise, all lanes zero */
DEM_INLINE dem_contact contact_of(const dem_loop_task *task, const row r) {
  dem_contact c = {0};
  begin_contact(task, r, &c);
  return c;
}

/* the sums of the particles of the lanes, for the law's kernel; nothing without a law that has them */
DEM_INLINE void load_sums(const dem_data *d, const int *particle, vd sum[]) {
  for (int q = 0; q < DEM_LAW_SUMS; q++) {
    double lane[DEM_W];
    for (int l = 0; l < DEM_W; l++)
      lane[l] = d->work.contact_sum[(size_t)particle[l] * DEM_LAW_SUMS + (size_t)q];
    sum[q] = vd_load(lane);
  }
}

DEM_INLINE double *note_column(const dem_data *d, int column) {
  return d->work.notes.column + (size_t)column * d->work.notes.stride;
}

/* the row as it is: with all terms the columns are the scene's */
DEM_INLINE row row_of(const dem_model *m, row r) {
  if (r.all_terms) {
    r.ncolumn = m->columns.ncolumn;
    r.column = m->columns.normal < 0 ? 0 : m->columns.normal;
  }
  return r;
}

DEM_INLINE void close_history(double *history, size_t stride, const int ncolumn) {
  for (int q = 0; q < ncolumn; q++)
    vd_store(history + (size_t)q * stride, vd_set(0));
}

#endif
