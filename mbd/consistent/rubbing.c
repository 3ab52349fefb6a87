/* Friction by reactions that depend on friction: see rubbing.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/consistent/rubbing.h"

#include "mbd/equations/residual.h"
#include "mbd/mechanics/normal.h"
#include "protocol/base/memory.h"

#include <gsl/gsl_linalg.h>
#include <stdlib.h>
#include <string.h>

/* frictions that slide by their joints' reactions */
typedef struct {
  int n;
  int *which;     /* (n) places in data->stick */
  double *factor; /* (n) way times level */
  double *normal; /* (n) sought */
  gsl_matrix *J;
  gsl_vector *F, *step;
  gsl_permutation *order;
} sliding;

static void release(sliding *s) {
  free(s->which);
  free(s->factor);
  free(s->normal);
  gsl_matrix_free(s->J);
  gsl_vector_free(s->F);
  gsl_vector_free(s->step);
  gsl_permutation_free(s->order);
}

/* Accelerations and lambda by each of them at 1 N (1 N m), into data->response. */
static bool find_responses(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, sliding *s) {
  const int nv = 6 * model->nbody, n = nv + model->nrow;
  memset(mbd_kkt_b(kkt), 0, (size_t)model->nrow * sizeof(double));
  for (int k = 0; k < model->nfriction; k++) {
    const mbd_force *f = &model->force[model->friction[k]];
    double slope;
    if (!f->rubbing->reacts || data->stick[k].stuck || data->stick[k].way == 0)
      continue;
    const mbd_force_value *value = mbd_force_at(model, data, model->friction[k], false);
    memset(data->shift, 0, (size_t)nv * sizeof(double));
    for (int c = 0; c < MBD_PAIR; c++)
      if (f->body[c / 6] != MBD_GROUND)
        data->shift[6 * f->body[c / 6] + c % 6] -= value->rows.G[0][c];
    const double *x = mbd_kkt_solve(kkt, data->shift);
    if (!x)
      return false;
    memcpy(data->response + s->n * n, x, (size_t)n * sizeof(double));
    s->factor[s->n] = data->stick[k].way * f->ops->level(f, value->rate, &slope);
    s->normal[s->n] = f->rubbing->base;
    s->which[s->n++] = k;
  }
  return true;
}

/* data's acceleration and lambda of the normal forces `normal` from those of `from` */
static void move(const mbd_model *model, mbd_data *data, const sliding *s, const double *by) {
  const int nv = 6 * model->nbody, n = nv + model->nrow;
  for (int i = 0; i < s->n; i++) {
    const double *response = data->response + i * n, more = s->factor[i] * by[i];
    for (int k = 0; k < nv; k++)
      data->acceleration[k] += more * response[k];
    for (int k = 0; k < model->nrow; k++)
      data->lambda[k] += more * response[nv + k];
  }
}

/* One step of Newton's on normal = normal_at(lambda(normal)). Returns the largest change over the largest normal force;
 * negative: it fails. */
static double iterate(const mbd_model *model, mbd_data *data, sliding *s) {
  const int nv = 6 * model->nbody, n = nv + model->nrow;
  double most = 0, change = 0;
  int sign;
  for (int i = 0; i < s->n; i++) {
    const mbd_force *f = &model->force[model->friction[s->which[i]]];
    mbd_normal now = mbd_normal_at(model, data, f, data->lambda, true);
    gsl_vector_set(s->F, (size_t)i, now.normal - s->normal[i]);
    for (int j = 0; j < s->n; j++) {
      double by = 0;
      for (int k = 0; k < now.nrow; k++)
        by += now.by_lambda[k] * s->factor[j] * data->response[j * n + nv + model->part[f->rubbing->part].row + k];
      gsl_matrix_set(s->J, (size_t)i, (size_t)j, (i == j) - by);
    }
  }
  gsl_linalg_LU_decomp(s->J, s->order, &sign);
  for (int i = 0; i < s->n; i++)
    if (gsl_matrix_get(s->J, (size_t)i, (size_t)i) == 0)
      return -1;
  gsl_linalg_LU_solve(s->J, s->order, s->F, s->step);
  for (int i = 0; i < s->n; i++) {
    s->normal[i] += gsl_vector_get(s->step, (size_t)i);
    most = fmax(most, fabs(s->normal[i]));
    change = fmax(change, fabs(gsl_vector_get(s->step, (size_t)i)));
  }
  move(model, data, s, s->step->data);
  return most > 0 ? change / most : 0;
}

/* Newton's method; what comes out must press, not pull. */
static bool find_normals(const mbd_model *model, mbd_data *data, sliding *s) {
  enum { ITERATIONS_MAX = 40 };
  const double good = 1e-14;
  double change = 1, last = INFINITY;
  for (int i = 0; i < ITERATIONS_MAX && change > good; i++) {
    change = iterate(model, data, s);
    if (!(change >= 0))
      return false;
    if (change < 1e-11 && change >= 0.5 * last) /* rounding */
      break;
    last = change;
  }
  for (int i = 0; i < s->n; i++)
    if (!(s->normal[i] >= 0))
      return false;
  return change < 1e-9;
}

bool mbd_rubbing_respond(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t) {
  if (model->nreacting == 0)
    return true;
  const size_t room = (size_t)model->nreacting;
  sliding s = {.which = calloc(room, sizeof(int)),
               .factor = calloc(room, sizeof(double)),
               .normal = calloc(room, sizeof(double))};
  bool good = s.which && s.factor && s.normal;
  if (!good)
    tdm_memory_note();
  good = good && find_responses(model, data, kkt, &s);
  if (good && s.n > 0) {
    const size_t n = (size_t)s.n;
    s.J = gsl_matrix_alloc(n, n);
    s.F = gsl_vector_alloc(n);
    s.step = gsl_vector_alloc(n);
    s.order = gsl_permutation_alloc(n);
    good = s.J && s.F && s.step && s.order && find_normals(model, data, &s);
  }
  if (good) {
    mbd_normals(model, data, data->lambda);
    if (s.n > 0)
      mbd_generalised_forces(model, data, t, data->wrench);
  }
  release(&s);
  return good;
}

/* ---- redundant rows ---- */

/* Does the friction feel multipliers that have no reaction on the whole? Those that differ from a unit one of a row of
 * its joint by what sharing out makes of it do not act on any body. */
static bool feels_nothing(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, const mbd_force *f, double *l) {
  const mbd_part *part = &model->part[f->rubbing->part];
  const double preload = f->rubbing->base;
  for (int k = 0; k < f->joint->ops->nrow; k++) {
    memset(l, 0, (size_t)model->nrow * sizeof(double));
    l[part->row + k] = 1;
    double size = mbd_normal_at(model, data, f, l, false).normal - preload;
    if (!mbd_kkt_share(kkt, model, data, l))
      return false;
    l[part->row + k] -= 1;
    if (mbd_normal_at(model, data, f, l, false).normal - preload > 1e-6 * fmax(size, f->rubbing->across))
      return true;
  }
  return false;
}

tdm_status mbd_rubbing_check(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, tdm_error *err) {
  if (data->ndependent == 0 || model->nreacting == 0)
    return TDM_OK;
  double *l = calloc((size_t)model->nrow + 1, sizeof *l);
  if (!l)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd.forces", "no memory for %d constraint rows", model->nrow);
  mbd_kinematics(model, data, data->t, data->y);
  for (int k = 0; k < model->nfriction && err->status == TDM_OK; k++) {
    const mbd_force *f = &model->force[model->friction[k]];
    char path[TDM_PATH_MAX];
    if (!f->rubbing->reacts || !feels_nothing(model, data, kkt, f, l))
      continue;
    snprintf(path, sizeof path, "mbd.forces[%d].coefficient", model->friction[k]);
    tdm_fail(err, TDM_ERR_SCENE, path,
             "the joint \"%s\" has redundant equations, so that its reaction, which the friction \"%s\" depends on, is "
             "not determined; use joints with more freedom, or a \"preload\" with \"reaction\": false",
             f->joint->name, f->name);
  }
  free(l);
  return err->status;
}
