/* SUNDIALS IDA (variable-order, fixed-leading-coefficient BDF), which keeps its history over windows. The only file
 * that includes its headers.
 *
 * IDA's unknowns z are those of the mechanism, y, but that the velocities that the coupling loads have given are taken
 * out (impulse.h): loads jump between windows, and a BDF would mix what they were with what they are. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/consistent/stick.h"
#include "mbd/consistent/work.h"
#include "mbd/equations/jacobian.h"
#include "mbd/equations/residual.h"
#include "mbd/integrate/impulse.h"
#include "mbd/integrate/integrator.h"
#include "mbd/integrate/pace.h"
#include "mbd/integrate/past.h"
#include "mbd/linear/linear_solver.h"
#include "mbd/linear/vector.h"
#include "protocol/base/log.h"
#include "protocol/base/memory.h"
#include "protocol/scene/remark.h"

#include <float.h>
#include <ida/ida.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sunnonlinsol/sunnonlinsol_newton.h>

typedef struct {
  const mbd_model *model; /* borrowed */
  mbd_data *data;         /* borrowed */
  mbd_kkt *kkt;           /* borrowed */
  mbd_stop_fn stop_fn;    /* NULL: never stop early */
  void *stop_context;
  SUNContext context;
  void *mem;
  N_Vector z, zp;       /* IDA's unknowns at the end of the last step */
  N_Vector y, yp;       /* the mechanism's there */
  N_Vector trial, rate; /* the mechanism's where IDA asks for the residual */
  N_Vector sample, id, atol;
  mbd_impulse *impulse;
  mbd_pace pace;  /* IDA's clock; tau: a time by it [s] */
  mbd_past past;  /* ends of the last steps without trouble */
  long failures;  /* convergence failures up to then */
  double regular; /* spread of pivots at the start */
  mbd_sparse *jacobian;
  SUNMatrix matrix; /* stands for it */
  SUNLinearSolver solver;
  SUNNonlinearSolver newton;
  double first_correction; /* weighted norm, of the current step */
  bool over;               /* the last step went over a singular position */
  bool fresh;              /* the Jacobian belongs to the current step */
  bool started;
  mbd_stats before;  /* counters from before the last (re)start */
  char message[256]; /* IDA's last complaint */
} ida_solver;

/* The multipliers converge with the velocities they act on: loose weights leave them out of the Newton test too. */
static const double multiplier_tolerance = 1e10;
/* Newton's iteration stops at this share of the tolerances: smaller than IDA's 0.33 so that the constraints hold well.
 */
static const double newton_coefficient = 0.003;
/* and at this share of that where windows of one step follow each other. */
static const double short_steps = 1e-4;

/* The modified corrector's absolute tolerance of velocities, beside that of displacements: they follow from these. */
static const double loose = 1e4;
/* Corrections that rounding keeps from getting smaller may be this large: IDA's own coefficient. */
static const double stagnation = 0.33;
/* A position is near a singular one when the pivots of the linear system spread this much more than at the start. */
static const double singular = 1e-3;

/* ---- callbacks ---- */

/* Index 3 has velocities from positions alone. In a step of order 1 whose length is not that of the step before, the
 * accelerations of what is constrained, and so the reactions, are then off by their own size ((h + h0)/2h times what
 * they should be), and every longer step fails; and in a very short one, rounding of the positions over its length is
 * more than velocities may be off. Such steps hold the velocity constraints as well. */
static void choose_index(ida_solver *ida, const double *y) {
  const mbd_model *m = ida->model;
  const double rounding = 2.2e-16, share = 0.03;
  double h = 0;
  int order = 1;
  if (m->solver.formulation != MBD_INDEX3)
    return;
  IDAGetCurrentOrder(ida->mem, &order);
  IDAGetCurrentStep(ida->mem, &h);
  ida->data->index3 = order > 1 && rounding * mbd_reach(m, y) < share * loose * m->solver.absolute_tolerance * h;
}

/* y and yp of the mechanism at time t at IDA's unknowns (zp, yp: NULL) */
static void from_ida(const ida_solver *ida, double t, N_Vector z, N_Vector zp, N_Vector y, N_Vector yp) {
  const size_t size = (size_t)mbd_nunknown(ida->model) * sizeof(double);
  memcpy(N_VGetArrayPointer(y), N_VGetArrayPointer(z), size);
  if (yp)
    memcpy(N_VGetArrayPointer(yp), N_VGetArrayPointer(zp), size);
  mbd_impulse_add(ida->impulse, t, 1, N_VGetArrayPointer(y), yp ? N_VGetArrayPointer(yp) : NULL);
}

static int residual(realtype tau, N_Vector z, N_Vector zp, N_Vector r, void *user) {
  ida_solver *ida = user;
  const double t = mbd_pace_true(&ida->pace, tau);
  from_ida(ida, t, z, zp, ida->trial, ida->rate);
  choose_index(ida, N_VGetArrayPointer(ida->trial));
  mbd_residual(ida->model, ida->data, t, N_VGetArrayPointer(ida->trial), N_VGetArrayPointer(ida->rate),
               N_VGetArrayPointer(r));
  return 0;
}

static int jacobian(realtype tau, realtype cj, N_Vector z, N_Vector zp, N_Vector r, SUNMatrix matrix, void *user,
                    N_Vector w1, N_Vector w2, N_Vector w3) {
  (void)r, (void)matrix, (void)w1, (void)w2, (void)w3;
  ida_solver *ida = user;
  mbd_sparse *j = ida->jacobian;
  const double t = mbd_pace_true(&ida->pace, tau);
  ida->fresh = true;
  from_ida(ida, t, z, zp, ida->trial, ida->rate);
  choose_index(ida, N_VGetArrayPointer(ida->trial));
  mbd_sparse_begin(j);
  mbd_jacobian(ida->model, ida->data, t, cj, N_VGetArrayPointer(ida->trial), N_VGetArrayPointer(ida->rate), j);
  return mbd_sparse_end(j) == MBD_SPARSE_NO_MEMORY ? -1 : 0;
}

/* Weights of the error test: by the mechanism's unknowns, at the end of the last step. */
static int weigh(N_Vector z, N_Vector weight, void *user) {
  ida_solver *ida = user;
  from_ida(ida, ida->pace.t, z, NULL, ida->trial, NULL);
  const double *y = N_VGetArrayPointer(ida->trial), *atol = N_VGetArrayPointer(ida->atol);
  double *w = N_VGetArrayPointer(weight);
  for (int i = 0; i < mbd_nunknown(ida->model); i++)
    w[i] = 1 / (ida->model->solver.relative_tolerance * fabs(y[i]) + atol[i]);
  return 0;
}

/* Newton's convergence test. IDA's own takes the rate of an earlier step for the first iteration; on constraints, which
 * a stale Jacobian and a scaled correction leave open, that rate is too good. Here a step has two iterations unless the
 * first correction is rounding itself, and the rate is always its own. Where windows keep the steps short, what each of
 * them leaves adds up over many: there the iteration goes on almost to rounding. */
static int converged(SUNNonlinearSolver newton, N_Vector y, N_Vector correction, realtype tolerance, N_Vector weight,
                     void *user) {
  (void)y;
  ida_solver *ida = user;
  int iteration = 0;
  double norm = N_VWrmsNorm(correction, weight);
  const double rounding = 4 * DBL_EPSILON / ida->model->solver.relative_tolerance;
  const double enough = ida->pace.count > 0 ? fmin(tolerance, fmax(4 * rounding, short_steps * tolerance)) : tolerance;
  SUNNonlinSolGetCurIter(newton, &iteration);
  if (iteration == 0) {
    ida->first_correction = norm;
    return norm <= fmin(0.01 * tolerance, rounding) ? SUN_NLS_SUCCESS : SUN_NLS_CONTINUE;
  }
  if (norm <= fmin(0.01 * tolerance, rounding))
    return SUN_NLS_SUCCESS;
  double rate = pow(norm / ida->first_correction, 1.0 / iteration);
  if (ida->fresh && (rate > 0.9 || iteration >= 3) && norm <= stagnation)
    return SUN_NLS_SUCCESS;
  if (rate > 0.9)
    return SUN_NLS_CONV_RECVR;
  return rate / (1 - rate) * norm <= enough ? SUN_NLS_SUCCESS : SUN_NLS_CONTINUE;
}

static void complain(int code, const char *module, const char *function, char *text, void *user) {
  (void)code, (void)module, (void)function;
  ida_solver *ida = user;
  snprintf(ida->message, sizeof ida->message, "%s", text);
  for (char *c = ida->message; *c; c++)
    if (*c == '\n' || *c == '\r')
      *c = ' ';
}

/* ---- life ---- */

static void weights(ida_solver *ida) {
  const mbd_model *m = ida->model;
  double *id = N_VGetArrayPointer(ida->id), *atol = N_VGetArrayPointer(ida->atol);
  for (int i = 0; i < mbd_nunknown(m); i++) {
    bool differential = i < MBD_BODY_UNKNOWNS * m->nbody;
    bool velocity = differential && i % MBD_BODY_UNKNOWNS >= MBD_V;
    bool tested = differential && !(velocity && m->solver.modified);
    id[i] = tested;
    atol[i] = tested         ? m->solver.absolute_tolerance
              : differential ? loose * m->solver.absolute_tolerance
                             : multiplier_tolerance;
  }
}

enum { VECTORS = 9 };

static void list_vectors(ida_solver *ida, N_Vector *list[VECTORS]) {
  N_Vector *const all[VECTORS] = {&ida->z,    &ida->zp,     &ida->y,  &ida->yp,  &ida->trial,
                                  &ida->rate, &ida->sample, &ida->id, &ida->atol};
  memcpy(list, all, sizeof all);
}

static tdm_status create(void **out, const mbd_model *model, mbd_data *data, mbd_kkt *kkt, mbd_stop_fn stop,
                         void *context, tdm_error *err) {
  ida_solver *ida = *out = calloc(1, sizeof *ida);
  if (!ida || SUNContext_Create(NULL, &ida->context))
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the integrator");
  sunindextype n = mbd_nunknown(model);
  ida->model = model;
  ida->data = data;
  ida->kkt = kkt;
  ida->stop_fn = stop;
  ida->stop_context = context;
  N_Vector *vectors[VECTORS];
  list_vectors(ida, vectors);
  bool good = true;
  for (int i = 0; i < VECTORS; i++)
    good = (*vectors[i] = mbd_vector_create(n, ida->context)) && good;
  ida->impulse = mbd_impulse_create(model);
  ida->jacobian = mbd_sparse_create((int)n);
  ida->matrix = ida->jacobian ? mbd_matrix_create(ida->jacobian, ida->context) : NULL;
  good = mbd_past_create(&ida->past, (int)n) && good;
  if (!good || !ida->impulse || !ida->matrix || !ida->jacobian)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the integrator (%ld unknowns)", (long)n);
  ida->solver = mbd_linear_solver_create(ida->jacobian, ida->context);
  ida->newton = SUNNonlinSol_Newton(ida->z, ida->context);
  ida->mem = IDACreate(ida->context);
  if (!ida->solver || !ida->newton || !ida->mem)
    return tdm_fail(err, TDM_ERR_MEMORY, "mbd", "no memory for the integrator (%ld unknowns)", (long)n);
  weights(ida);
  return TDM_OK;
}

static void destroy(void *self) {
  ida_solver *ida = self;
  if (!ida)
    return;
  if (ida->mem)
    IDAFree(&ida->mem);
  if (ida->newton)
    SUNNonlinSolFree(ida->newton);
  if (ida->solver)
    SUNLinSolFree(ida->solver);
  if (ida->matrix)
    SUNMatDestroy(ida->matrix);
  mbd_sparse_destroy(&ida->jacobian);
  N_Vector *vectors[VECTORS];
  list_vectors(ida, vectors);
  for (int i = 0; i < VECTORS; i++)
    if (*vectors[i])
      N_VDestroy(*vectors[i]);
  mbd_impulse_destroy(&ida->impulse);
  mbd_past_free(&ida->past);
  if (ida->context)
    SUNContext_Free(&ida->context);
  free(ida);
}

/* ---- start ---- */

/* The settings that IDA takes after IDAInit; 0 on success. */
static int configure(ida_solver *ida) {
  const mbd_settings *s = &ida->model->solver;
  int bad = IDASetErrHandlerFn(ida->mem, complain, ida);
  bad |= IDASetUserData(ida->mem, ida);
  bad |= IDAWFtolerances(ida->mem, weigh);
  bad |= IDASetId(ida->mem, ida->id);
  bad |= IDASetSuppressAlg(ida->mem, SUNTRUE);
  bad |= IDASetNonlinearSolver(ida->mem, ida->newton);
  bad |= SUNNonlinSolSetConvTestFn(ida->newton, converged, ida); /* after IDA has set its own */
  const int solver = IDASetLinearSolver(ida->mem, ida->solver, ida->matrix);
  if (solver == IDALS_MEM_FAIL)
    tdm_memory_note();
  bad |= solver;
  bad |= IDASetJacFn(ida->mem, jacobian);
  bad |= IDASetMaxOrd(ida->mem, s->max_order);
  bad |= IDASetNonlinConvCoef(ida->mem, newton_coefficient);
  bad |= IDASetMaxErrTestFails(ida->mem, 30);
  bad |= IDASetMaxConvFails(ida->mem, 30);
  if (s->max_step > 0)
    bad |= IDASetMaxStep(ida->mem, s->max_step);
  return bad;
}

/* Bring data's counters up to IDA's. */
static void count(ida_solver *ida) {
  long steps = 0, residuals, setups, failures = 0, unconverged = 0;
  int last, current;
  realtype h0, hlast, hcur, tcur;
  if (!ida->started)
    return;
  IDAGetIntegratorStats(ida->mem, &steps, &residuals, &setups, &failures, &last, &current, &h0, &hlast, &hcur, &tcur);
  IDAGetNumStepSolveFails(ida->mem, &unconverged);
  ida->data->stats.steps = ida->before.steps + steps;
  ida->data->stats.error_failures = ida->before.error_failures + failures;
  ida->data->stats.convergence_failures = ida->before.convergence_failures + unconverged;
}

/* Length of the first step of index3, whose displacements alone are tested: where a step of order 1 makes
 * half of the error that they may have by the accelerations in ida->yp. IDA's own choice follows from the velocities,
 * and is so short that rounding of the positions, divided by it, is taken for velocities. 0: IDA's own. */
static double first_step(const ida_solver *ida) {
  const mbd_settings *s = &ida->model->solver;
  const double *y = N_VGetArrayPointer(ida->y), *yp = N_VGetArrayPointer(ida->yp);
  double sum = 0;
  for (int b = 0; b < ida->model->nbody && s->formulation == MBD_INDEX3; b++)
    for (int i = 0; i < 6; i++) {
      const int at = MBD_BODY_UNKNOWNS * b;
      double size = i < 3 ? fabs(y[at + MBD_R + i]) : 1, bends = (i < 3 ? 1 : 0.5) * yp[at + MBD_V + i];
      sum += pow(bends / (s->relative_tolerance * size + s->absolute_tolerance), 2);
    }
  return sum > 0 ? 1 / sqrt(sqrt(sum / mbd_nunknown(ida->model))) : 0;
}

/* Make ida->y consistent with the load at t and hand it to IDA. */
static bool restart(ida_solver *ida, double t) {
  const size_t size = (size_t)mbd_nunknown(ida->model) * sizeof(double);
  double *y = N_VGetArrayPointer(ida->y), *yp = N_VGetArrayPointer(ida->yp);
  mbd_sparse_reset(ida->jacobian); /* so that nothing depends on what was before */
  if (!mbd_consistent(ida->model, ida->data, ida->kkt, t, y, yp))
    return false;
  mbd_impulse_begin(ida->impulse, ida->model, ida->data, ida->kkt, t, y);
  mbd_impulse_zero_at(ida->impulse, t);
  mbd_pace_reset(&ida->pace, t);
  memcpy(N_VGetArrayPointer(ida->z), y, size);
  memcpy(N_VGetArrayPointer(ida->zp), yp, size);
  mbd_impulse_add(ida->impulse, t, -1, N_VGetArrayPointer(ida->z), N_VGetArrayPointer(ida->zp));
  ida->failures = 0;
  if (!ida->started)
    ida->regular = mbd_kkt_spread(ida->kkt);
  if (ida->started) {
    count(ida); /* IDAReInit clears IDA's counters */
    ida->before = ida->data->stats;
    return IDAReInit(ida->mem, t, ida->z, ida->zp) == IDA_SUCCESS &&
           IDASetInitStep(ida->mem, first_step(ida)) == IDA_SUCCESS;
  }
  ida->started = true;
  const int made = IDAInit(ida->mem, residual, t, ida->z, ida->zp);
  if (made == IDA_MEM_FAIL)
    tdm_memory_note();
  return made == IDA_SUCCESS && configure(ida) == 0 && IDASetInitStep(ida->mem, first_step(ida)) == IDA_SUCCESS;
}

static tdm_status start(void *self, double t, tdm_error *err) {
  ida_solver *ida = self;
  size_t size = (size_t)mbd_nunknown(ida->model) * sizeof(double);
  ida->past.n = 0;
  mbd_impulse_reset(ida->impulse);
  memcpy(N_VGetArrayPointer(ida->y), ida->data->y, size);
  mbd_sparse_reset(ida->jacobian); /* pivots depend on the pattern learnt: what follows must not depend on the past */
  mbd_kkt_reset(ida->kkt);
  if (!restart(ida, t))
    return tdm_fail(err, TDM_ERR_NUMERIC, "mbd",
                    "no consistent accelerations at the start, t = %g s %s; check joints and masses", t, ida->message);
  ida->data->t = t;
  memcpy(ida->data->yp, N_VGetArrayPointer(ida->yp), size);
  return TDM_OK;
}

/* ---- a window ---- */

/* Tell IDA where the next step must end at the latest, and how long it may be. Returns that time by its clock. */
static double set_stop(ida_solver *ida, double t0, double t1) {
  const double longest = ida->model->solver.max_step, before = ida->pace.longest;
  double wanted = 0;
  IDAGetCurrentStep(ida->mem, &wanted);
  double stop = mbd_pace_stop(&ida->pace, t0, t1, wanted);
  if (ida->pace.longest != before)
    IDASetMaxStep(ida->mem,
                  ida->pace.longest > 0 && !(longest > 0 && longest < ida->pace.longest) ? ida->pace.longest : longest);
  IDASetStopTime(ida->mem, stop);
  return stop;
}

/* Start IDA again from the last good state, which IDA left in ida->y. */
static tdm_status recover(ida_solver *ida, double t, double t1, int flag, bool again, tdm_error *err) {
  tdm_log(TDM_LOG_WARNING, "integrator_failed", "time_s=%.9g flag=%d retry=%s", t, flag, again ? "no" : "yes");
  double *y = N_VGetArrayPointer(ida->y);
  if (!again && tdm_finite(y, mbd_nunknown(ida->model)) && mbd_project(ida->model, ida->data, ida->kkt, t, y) &&
      restart(ida, t)) {
    ida->past.n = 0;
    ida->data->stats.restarts++;
    tdm_remark(TDM_NOTICE, "integrator_failed", "mbd.solver", t,
               "the integration failed at t = %.9g s (IDA %d: %.200s) and was started again from there; look at what "
               "happens then: a load or a force that jumps, or a singular position",
               t, flag, ida->message);
    return TDM_OK;
  }
  char advice[512];
  mbd_advise(ida->model, advice, sizeof advice);
  return tdm_fail(err, TDM_ERR_NUMERIC, "mbd",
                  "the integration failed at t = %.9g s in the window to %.9g s (IDA %d: %s). %s", t, t1, flag,
                  ida->message, advice);
}

/* ---- singular positions ---- */

/* Largest position multiplier in ida->y: they are zero but for errors. */
static double largest_mu(const ida_solver *ida) {
  const double *mu = N_VGetArrayPointer(ida->y) + mbd_index_mu(ida->model, 0);
  double most = 0;
  for (int i = 0; i < ida->model->nrow; i++)
    most = fmax(most, fabs(mu[i]));
  return most;
}

/* The last step went wrong at first, has become much shorter, or needs much larger position multipliers. */
static bool in_trouble(ida_solver *ida) {
  long failures = 0;
  realtype h = 0;
  IDAGetNumStepSolveFails(ida->mem, &failures);
  IDAGetLastStep(ida->mem, &h);
  bool failed = failures > ida->failures;
  ida->failures = failures;
  const double mu = mbd_past_mu(&ida->past);
  return failed || h < 0.1 * mbd_past_step(&ida->past) || (mu > 0 && largest_mu(ida) > 30 * mu);
}

static double spread_at(ida_solver *ida, double t, N_Vector y) {
  bool good = mbd_project(ida->model, ida->data, ida->kkt, t, N_VGetArrayPointer(y)) &&
              mbd_accelerations(ida->model, ida->data, ida->kkt, t, N_VGetArrayPointer(y));
  return good ? mbd_kkt_spread(ida->kkt) : 0;
}

/* Near a singular position rounding errors grow as the square of the distance to it falls, and smaller steps only lead
 * closer. Step over it: continue the solution from the last step without trouble, by one to six times its length, to
 * where the constraints are regular again. Returns the time reached; t when the position at t is not singular or the
 * window ends before. */
static double step_over(ida_solver *ida, double t, double t1) {
  const double lengths[] = {1, 1.4, 2, 2.8, 4, 5.6}, enough = 100;
  double best = 0, reached = t;
  const mbd_past *past = &ida->past;
  if (past->n < 2)
    return t;
  bool good = mbd_accelerations(ida->model, ida->data, ida->kkt, t, N_VGetArrayPointer(ida->y));
  double here = good ? mbd_kkt_spread(ida->kkt) : 0;
  for (int i = 0; i < 6 && here < singular * ida->regular && best < enough * here; i++) {
    double to = past->t[past->n - 1] + lengths[i] * mbd_past_step(past);
    if (to > t1 - 16 * DBL_EPSILON * fabs(t1)) /* IDA does not start for so short a rest */
      to = t1;
    mbd_past_at(past, to, N_VGetArrayPointer(ida->sample));
    double spread = to > t ? spread_at(ida, to, ida->sample) : 0;
    if (spread > best)
      best = spread, reached = to;
  }
  if (!(best > here))
    return t;
  mbd_past_at(past, reached, N_VGetArrayPointer(ida->y));
  if (!mbd_project(ida->model, ida->data, ida->kkt, reached, N_VGetArrayPointer(ida->y)) || !restart(ida, reached))
    return t;
  ida->data->stats.restarts++;
  return reached;
}

/* ---- samples ---- */

/* Time t of the last step by IDA's clock. */
static double inside(const ida_solver *ida, double t) {
  double length = 0, tau = ida->pace.tau - (ida->pace.t - t);
  IDAGetLastStep(ida->mem, &length);
  return fmax(tau, ida->pace.tau - length);
}

/* The unknowns at time t inside the last step, or in what was stepped over. */
static const double *unknowns_at(void *self, double t) {
  ida_solver *ida = self;
  if (ida->over)
    mbd_past_at(&ida->past, t, N_VGetArrayPointer(ida->sample));
  else if (IDAGetDky(ida->mem, inside(ida, t), 0, ida->sample) != IDA_SUCCESS)
    return NULL;
  else
    mbd_impulse_add(ida->impulse, t, 1, N_VGetArrayPointer(ida->sample), NULL);
  return N_VGetArrayPointer(ida->sample);
}

/* `work` and what is done from time `from` to `to` inside the last step. */
static mbd_work work_until(ida_solver *ida, mbd_work work, double from, double to) {
  return mbd_work_add(work, mbd_work_over(ida->model, ida->data, ida->kkt, from, to, unknowns_at, ida));
}

/* Hand out the samples in the last step, from time `from` to t. */
static tdm_status samples(ida_solver *ida, double from, double t, int *next, int nsample, const double *time,
                          mbd_sample_fn sample, void *context, tdm_error *err) {
  mbd_work before = ida->data->work, after = work_until(ida, before, from, t);
  for (; *next < nsample && time[*next] <= t; ++*next) {
    bool here = time[*next] == t; /* the same numbers as the state at the end of the window */
    ida->data->work = here ? after : work_until(ida, before, from, time[*next]);
    if (!here && !unknowns_at(ida, time[*next]))
      return tdm_fail(err, TDM_ERR_NUMERIC, "mbd", "no dense output at t = %.9g s (%s)", time[*next], ida->message);
    if (sample(context, *next, time[*next], N_VGetArrayPointer(here ? ida->y : ida->sample), err))
      return err->status;
  }
  ida->data->work = after;
  return TDM_OK;
}

/* One step from *t, or over a singular position; or a new start of the integrator there. */
static tdm_status step(ida_solver *ida, double *t, double t0, double t1, bool *again, tdm_error *err) {
  double tau = ida->pace.tau, stop = set_stop(ida, t0, t1);
  int flag = IDASolve(ida->mem, stop, &tau, ida->z, ida->zp, IDA_ONE_STEP);
  double reached = mbd_pace_reach(&ida->pace, tau, flag == IDA_TSTOP_RETURN);
  from_ida(ida, reached, ida->z, ida->zp, ida->y, ida->yp);
  double over = flag < 0 || in_trouble(ida) ? step_over(ida, reached, t1) : reached;
  ida->over = over > reached;
  ida->fresh = false;
  *t = over;
  if (flag < 0 && !ida->over) {
    if (recover(ida, reached, t1, flag, *again, err))
      return err->status;
    *again = true;
  } else if (!ida->over) {
    mbd_past_add(&ida->past, *t, N_VGetArrayPointer(ida->y), largest_mu(ida));
  }
  mbd_accept(ida->model, ida->data, *t, N_VGetArrayPointer(ida->y));
  return TDM_OK;
}

/* The load of the window that begins at t joins what is taken out of IDA's unknowns. When that has become so large that
 * its rounding shows, IDA starts again without it. */
static bool begin_window(ida_solver *ida, double t) {
  const double shows = 1e-3 * ida->model->solver.absolute_tolerance / DBL_EPSILON, much = 10; /* [m/s], [rad/s] */
  mbd_impulse_begin(ida->impulse, ida->model, ida->data, ida->kkt, t, N_VGetArrayPointer(ida->y));
  if (!(mbd_impulse_size(ida->impulse, t) > fmax(shows, much)))
    return true;
  ida->past.n = 0;
  return restart(ida, t);
}

/* ---- friction that begins or ceases to stick ---- */

/* Let frictions stick or slide as the state at t wants it, and start again from there if that changes anything or
 * `back`: IDA has been further already. */
static tdm_status settle(ida_solver *ida, double t, bool back, tdm_error *err) {
  bool changed;
  if (!mbd_stick_settle(ida->model, ida->data, ida->kkt, t, N_VGetArrayPointer(ida->y), &changed))
    return mbd_stick_refuse(t, err);
  if (!changed && !back)
    return TDM_OK;
  ida->past.n = 0;
  mbd_impulse_reset(ida->impulse); /* what sticks answers to loads in another way */
  bool good = mbd_project(ida->model, ida->data, ida->kkt, t, N_VGetArrayPointer(ida->y)); /* it was interpolated */
  return good && restart(ida, t) ? TDM_OK : mbd_stick_refuse(t, err);
}

/* A rest of a window after which a step would be too short [s]: index3 divides the rounding of positions by it, which
 * must stay well below the tolerance of velocities. */
static double sliver(const ida_solver *ida) {
  const double *y = N_VGetArrayPointer(ida->y), rounding = 4e-15;
  return rounding * mbd_reach(ida->model, y) / (loose * ida->model->solver.absolute_tolerance);
}

/* Go back to time t inside the last step. */
static void go_back(ida_solver *ida, double t) {
  const double *y = unknowns_at(ida, t);
  if (y)
    memcpy(N_VGetArrayPointer(ida->y), y, (size_t)mbd_nunknown(ida->model) * sizeof(double));
  mbd_accept(ida->model, ida->data, t, N_VGetArrayPointer(ida->y));
}

static tdm_status advance(void *self, double t1, int nsample, const double *sample_time, mbd_sample_fn sample,
                          void *context, tdm_error *err) {
  /* many steps that cover hardly any of the window go nowhere */
  const long many = 20000;
  const double hardly = 1e-5;
  ida_solver *ida = self;
  mbd_data *data = ida->data;
  const double *y = N_VGetArrayPointer(ida->y), start = data->t;
  double t = start, mark = start;
  int next = 0;
  bool again = false;
  ida->message[0] = 0;
  if (mbd_stick_margin(ida->model, data, ida->kkt, t, y) < 0 && settle(ida, t, false, err)) /* the load jumps */
    return err->status;
  if (!begin_window(ida, start))
    return tdm_fail(err, TDM_ERR_NUMERIC, "mbd", "no consistent accelerations at t = %.9g s %s", start, ida->message);
  for (long nstep = 1; t < t1; nstep++) {
    double from = t;
    if (step(ida, &t, start, t1, &again, err))
      return err->status;
    if (ida->stop_fn && ida->stop_fn(ida->stop_context))
      return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted at t = %.9g s", t);
    double end = mbd_stick_end(ida->model, data, ida->kkt, from, t, nsample - next, sample_time + next, y, unknowns_at,
                               ida->over ? NULL : ida);
    if (t1 - end < sliver(ida)) /* the next window begins with new modes */
      end = INFINITY;
    const bool back = end < t;
    if (back)
      go_back(ida, t = end);
    if (samples(ida, from, t, &next, nsample, sample_time, sample, context, err))
      return err->status;
    if (end <= t && settle(ida, t, back, err))
      return err->status;
    if (ida->over)
      ida->past.n = 0;
    if (nstep % many == 0 && t - mark < hardly * (t1 - start)) {
      char advice[512];
      mbd_advise(ida->model, advice, sizeof advice);
      return tdm_fail(err, TDM_ERR_NUMERIC, "mbd",
                      "the integration stands still at t = %.9g s: the last %ld steps cover %.3g s. %s", t, many,
                      t - mark, advice);
    }
    if (nstep % many == 0)
      mark = t;
  }
  data->t = t1;
  memcpy(data->y, y, (size_t)mbd_nunknown(ida->model) * sizeof(double));
  memcpy(data->yp, N_VGetArrayPointer(ida->yp), (size_t)mbd_nunknown(ida->model) * sizeof(double));
  return TDM_OK;
}

static void stats(void *self) {
  count(self);
}

const mbd_integrator_ops mbd_ida = {
    .create = create, .start = start, .advance = advance, .stats = stats, .destroy = destroy};
