/* How the coupled bodies of an FMU answer to loads: see response.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/foreign/fmu/response.h"

#include <gsl/gsl_blas.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Answers of A along B and of B along A may differ by this share of them (an FMU's own tolerance), or by this share of
 * what free bodies do (rounding). */
static const double asymmetry = 0.02, rounding = 1e-4;

/* Accelerations that a trial's further load would give the bodies if they were free [m/s2, rad/s2]: far above rounding,
 * and small beside what an FMU's laws are bent by. */
static const double nudge = 10;

tdm_status fmu_response_init(fmu_response *r, const fmu_mapping *m, double h, tdm_error *err) {
  const size_t k = 6 * (size_t)m->nbody, nin = (size_t)m->inputs.nvalue;
  *r = (fmu_response){.m = m, .h = h, .by_derivatives = m->fmu->description.gives_derivatives && m->accelerates};
  r->inputs = calloc(nin + 1, sizeof(double));
  r->outputs = calloc((size_t)m->outputs.nvalue + 1, sizeof(double));
  r->P = calloc(nin * k + 1, sizeof(double));
  r->D = calloc(nin * k + 1, sizeof(double));
  r->base = calloc(2 * k + 1, sizeof(double));
  r->Y = calloc(k * k + 1, sizeof(double));
  for (int i = 0; i < 2; i++)
    r->state[i] = calloc((size_t)m->nbody + 1, sizeof(tdm_state));
  if (k > 0) {
    r->eigen = gsl_eigen_symmv_alloc(k);
    r->matrix = gsl_matrix_alloc(k, k);
    r->vectors = gsl_matrix_alloc(k, k);
    r->values = gsl_vector_alloc(k);
  }
  if (!r->inputs || !r->outputs || !r->P || !r->D || !r->base || !r->Y || !r->state[0] || !r->state[1] ||
      (k > 0 && (!r->eigen || !r->matrix || !r->vectors || !r->values)))
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  return err->status;
}

void fmu_response_free(fmu_response *r) {
  if (r->m)
    tdm_fmu_forget(r->m->fmu, &r->kept);
  free(r->inputs);
  free(r->outputs);
  free(r->P);
  free(r->D);
  free(r->base);
  free(r->Y);
  for (int i = 0; i < 2; i++)
    free(r->state[i]);
  gsl_eigen_symmv_free(r->eigen);
  gsl_matrix_free(r->matrix);
  gsl_matrix_free(r->vectors);
  gsl_vector_free(r->values);
  *r = (fmu_response){0};
}

/* Two steps from t with r->inputs held; states after each, and back again unless it is the last trial. */
static tdm_status try_steps(fmu_response *r, double t, bool last, tdm_error *err) {
  tdm_fmu *f = r->m->fmu;
  const fmu_list *in = &r->m->inputs, *out = &r->m->outputs;
  if (!last)
    tdm_fmu_keep(f, &r->kept, err);
  for (int k = 1; k <= 2 && err->status == TDM_OK; k++)
    if (tdm_fmu_set(f, in->reference, in->nvariable, r->inputs, in->nvalue, err) == TDM_OK &&
        tdm_fmu_step(f, t + (k - 1) * r->h, r->h, false, err) == TDM_OK &&
        tdm_fmu_get(f, out->reference, out->nvariable, r->outputs, out->nvalue, err) == TDM_OK)
      fmu_mapping_states(r->m, r->outputs, r->state[k - 1]);
  if (!last && err->status == TDM_OK && tdm_fmu_go_back(f, r->kept, err) == TDM_OK)
    f->t = t;
  return err->status;
}

static double twist_of(const tdm_state *state, int i) {
  return ((const double *)(const void *)&state[i / 6].twist)[i % 6];
}

tdm_status fmu_response_accelerations(fmu_response *r, double t, const tdm_state *state, const tdm_wrench *load,
                                      bool last, double *out, tdm_error *err) {
  fmu_mapping_inputs(r->m, state, load, r->inputs);
  if (try_steps(r, t, last, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < 6 * r->m->nbody; i++)
    out[i] = (4 * twist_of(r->state[0], i) - 3 * twist_of(state, i) - twist_of(r->state[1], i)) / (2 * r->h);
  return TDM_OK;
}

/* ---- mobility ---- */

/* P: inputs under unit loads, in these poses. */
static void find_inputs(fmu_response *r, const tdm_state *state) {
  const int k = 6 * r->m->nbody, nin = r->m->inputs.nvalue;
  tdm_wrench *load = (tdm_wrench *)(void *)r->base; /* room for 2 k numbers, free until the trials */
  memset(r->base, 0, (size_t)k * sizeof(double));
  for (int j = 0; j < k; j++) {
    ((double *)(void *)load)[j] = 1;
    fmu_mapping_inputs(r->m, state, load, r->inputs);
    for (int i = 0; i < nin; i++)
      r->P[i * k + j] = r->inputs[i];
    ((double *)(void *)load)[j] = 0;
  }
}

/* Mass, or moment of inertia in world axes, that belongs to entry j of a load. */
static double mass_of(const fmu_response *r, const tdm_state *state, int j) {
  const fmu_body *b = &r->m->body[j / 6];
  if (j % 6 < 3)
    return b->mass;
  const tdm_mat3 turn = tdm_quat_to_matrix(state[j / 6].pose.orientation);
  return tdm_m3_mat(turn, tdm_m3_mat(b->inertia, tdm_m3_transpose(turn))).m[j % 6 - 3][j % 6 - 3];
}

/* A change of input i by which free bodies would change their acceleration by `nudge` at most. */
static double nudge_of(const fmu_response *r, const tdm_state *state, int i) {
  const int k = 6 * r->m->nbody;
  double largest = 0;
  for (int j = 0; j < k; j++)
    largest = fmax(largest, fabs(r->P[i * k + j]) * mass_of(r, state, j));
  return largest > 0 ? nudge * largest : 1;
}

/* D by trials: two steps without and with a nudge of each input. */
static tdm_status answer_by_trials(fmu_response *r, double t, const tdm_state *state, const tdm_wrench *load,
                                   tdm_error *err) {
  const int k = 6 * r->m->nbody, nin = r->m->inputs.nvalue;
  for (int j = -1; j < nin && err->status == TDM_OK; j++) {
    const double du = j < 0 ? 0 : nudge_of(r, state, j);
    fmu_mapping_inputs(r->m, state, load, r->inputs);
    if (j >= 0)
      r->inputs[j] += du;
    if (try_steps(r, t, false, err) != TDM_OK)
      return err->status;
    for (int i = 0; i < k; i++) {
      const double one = twist_of(r->state[0], i), two = twist_of(r->state[1], i);
      if (j >= 0)
        r->D[i * nin + j] = (2 * (one - r->base[i]) - 0.5 * (two - r->base[k + i])) / (r->h * du);
      else
        r->base[i] = one, r->base[k + i] = two;
    }
  }
  return err->status;
}

/* D by the FMU's derivatives of its outputs, the accelerations among them, along each input. */
static tdm_status answer_by_derivatives(fmu_response *r, const tdm_state *state, tdm_error *err) {
  const int k = 6 * r->m->nbody, nin = r->m->inputs.nvalue;
  const fmu_list *in = &r->m->inputs, *out = &r->m->outputs;
  for (int j = 0; j < nin && err->status == TDM_OK; j++) {
    memset(r->inputs, 0, (size_t)nin * sizeof(double));
    r->inputs[j] = 1;
    if (tdm_fmu_derivative(r->m->fmu, out->reference, out->nvariable, in->reference, in->nvariable, r->inputs, nin,
                           r->outputs, out->nvalue, err) != TDM_OK)
      return err->status;
    fmu_mapping_accelerations(r->m, r->outputs, state, true, r->base);
    for (int i = 0; i < k; i++)
      r->D[i * nin + j] = r->base[i];
  }
  return err->status;
}

/* The name of entry i of a load. */
static const char *name_of(const fmu_response *r, int i, char *out, size_t size) {
  const char axis = "xyz"[i % 3];
  snprintf(out, size, "the %s %c of \"%s\"", i % 6 < 3 ? "force along" : "moment about", axis, r->m->body[i / 6].name);
  return out;
}

/* What a mechanism must do: answer to a load A along B as to B along A, and along each load. */
static tdm_status check(const fmu_response *r, const tdm_state *state, tdm_error *err) {
  const int k = 6 * r->m->nbody;
  char one[128], other[128];
  for (int i = 0; i < k; i++)
    for (int j = 0; j <= i; j++) {
      const double a = r->Y[i * k + j], b = r->Y[j * k + i];
      const double most = fmax(fmax(fabs(a), fabs(b)), sqrt(fabs(r->Y[i * k + i] * r->Y[j * k + j])));
      if (!isfinite(a) || !isfinite(b))
        return tdm_fail(err, TDM_ERR_NUMERIC, NULL, "%s: its answer to a load is no finite number", r->m->fmu->file);
      const double slack = asymmetry * most + rounding / sqrt(mass_of(r, state, i) * mass_of(r, state, j));
      if (fabs(a - b) > slack || (i == j && a < -slack))
        return tdm_fail(err, TDM_ERR_SCENE, "mbd.bodies",
                        "no mechanism answers to loads as %s does at t = %g s: %s moves it along %s by %g, the other "
                        "way round by %g [1/kg, 1/(kg m), 1/(kg m2)]; look at the points, axes, signs and units of "
                        "inputs and outputs",
                        r->m->fmu->file, r->m->fmu->t, name_of(r, j, one, sizeof one),
                        name_of(r, i, other, sizeof other), a, b);
    }
  return TDM_OK;
}

/* The symmetric part without negative eigenvalues, in place. */
static void make_semidefinite(fmu_response *r) {
  const size_t k = 6 * (size_t)r->m->nbody;
  for (size_t i = 0; i < k; i++)
    for (size_t j = 0; j < k; j++)
      gsl_matrix_set(r->matrix, i, j, 0.5 * (r->Y[i * k + j] + r->Y[j * k + i]));
  gsl_eigen_symmv(r->matrix, r->values, r->vectors, r->eigen);
  for (size_t i = 0; i < k; i++)
    for (size_t j = 0; j <= i; j++) {
      double sum = 0;
      for (size_t n = 0; n < k; n++)
        sum +=
            fmax(gsl_vector_get(r->values, n), 0) * gsl_matrix_get(r->vectors, i, n) * gsl_matrix_get(r->vectors, j, n);
      r->Y[i * k + j] = r->Y[j * k + i] = sum;
    }
}

tdm_status fmu_response_mobility(fmu_response *r, double t, const tdm_state *state, const tdm_wrench *load,
                                 tdm_error *err) {
  const int k = 6 * r->m->nbody, nin = r->m->inputs.nvalue;
  if (k == 0)
    return TDM_OK;
  find_inputs(r, state);
  if ((r->by_derivatives ? answer_by_derivatives(r, state, err) : answer_by_trials(r, t, state, load, err)) != TDM_OK)
    return err->status;
  for (int i = 0; i < k; i++)
    for (int j = 0; j < k; j++) {
      double sum = 0;
      for (int n = 0; n < nin; n++)
        sum += r->D[i * nin + n] * r->P[n * k + j];
      r->Y[i * k + j] = sum;
    }
  if (check(r, state, err) == TDM_OK)
    make_semidefinite(r);
  return err->status;
}
