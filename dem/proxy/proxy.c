/* The mechanism inside a window: see proxy.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/proxy/proxy.h"

#include "dem/bodies/wall_stiffness.h"
#include "dem/bodies/walls.h"
#include "dem/proxy/matched.h"
#include "protocol/math/hermite.h"
#include "protocol/scene/remark.h"

#include <gsl/gsl_linalg.h>
#include <stdlib.h>
#include <string.h>

/* Hermite's cubic between two ends of an interval; rotations as rotation vectors. */
typedef struct {
  tdm_twist value0, rate0, value1, rate1; /* "velocity": way [m], "angular": turn [rad]; rates a second */
} cubic;

typedef struct {
  tdm_state start, now;  /* by the proxy alone */
  tdm_state path;        /* where the path is now, if there is one */
  tdm_quat before;       /* its orientation before the step under way */
  tdm_vec3 aside;        /* way away from it [m] */
  tdm_twist mid;         /* twist of the last step's middle */
  cubic drift, correct;  /* over blend_time, over the window */
  double work, blending; /* [J] */
} carried;

/* What a body is known by, window after window. */
typedef struct {
  const char *name;
  double radius;  /* by which turns count as ways [m] */
  double fastest; /* largest speed at the end of a window so far, its turning included [m/s] */
} known;

struct dem_proxy {
  int k6, f, capacity; /* 6 bodies; independent velocities; room for so many */
  double dt, H, blend_time, tau;
  bool turns;      /* J and B turn with the (one) body */
  bool turned_so;  /* they did when it last was seen to turn */
  bool path_turns; /* so does the velocity that drivers prescribe */
  tdm_nodes path;  /* of the window's STEP, whose arrays outlive it; no nodes: there is none */
  double t0;       /* [s] */
  carried *body;   /* (k6 / 6) */
  double *W0, *W;  /* (k6) loads at the start, now */
  double *V;       /* (k6) scratch */
  double *Vt, *at; /* (k6) prescribed part of the twists at the start, and its rate */
  double *J, *B, *J_rate, *B_rate;
  double *z;             /* (2f) delta u, dt (u' - u'_0) */
  double *u1;            /* (f) u'_0 */
  double *E;             /* (2f x 2f) flow over dt */
  double *p;             /* (2f) its constant part */
  double *work_area;     /* (2f) */
  double *J_now, *B_now; /* at the end of the step */
  double *block;         /* all of the above from W0 on */
  gsl_matrix *L, *exponential;
  dem_matched *matched; /* NULL: not wanted */
  known *known;         /* (k6 / 6) */
};

/* ---- memory ---- */

/* Room for f independent velocities. */
static tdm_status reserve(dem_proxy *x, int f) {
  if (x->block && f <= x->capacity)
    return TDM_OK;
  const size_t k = (size_t)x->k6, n = (size_t)f;
  free(x->block);
  gsl_matrix_free(x->L);
  gsl_matrix_free(x->exponential);
  x->L = gsl_matrix_alloc(2 * n + 1, 2 * n + 1);
  x->exponential = gsl_matrix_alloc(2 * n + 1, 2 * n + 1);
  const struct {
    double **at;
    size_t n;
  } arrays[] = {{&x->W0, k},         {&x->W, k},
                {&x->V, k},          {&x->Vt, k},
                {&x->at, k},         {&x->J, k * n},
                {&x->B, k * n},      {&x->J_rate, k * n},
                {&x->B_rate, k * n}, {&x->z, 2 * n},
                {&x->u1, n},         {&x->E, 4 * n * n},
                {&x->p, 2 * n},      {&x->work_area, 2 * n},
                {&x->J_now, k * n},  {&x->B_now, k * n}};
  size_t all = 1, narray = sizeof arrays / sizeof arrays[0];
  for (size_t i = 0; i < narray; i++)
    all += arrays[i].n;
  double *at = x->block = calloc(all, sizeof *x->block);
  for (size_t i = 0; i < narray && at; at += arrays[i++].n)
    *arrays[i].at = at;
  const bool good = x->block && x->L && x->exponential;
  x->capacity = good ? f : -1;
  return good ? TDM_OK : TDM_ERR_MEMORY;
}

/* radius of gyration; 1 m for a body that cannot be moved */
static double gyration(const tdm_assigned_body *body) {
  const double trace = body->inertia.m[0][0] + body->inertia.m[1][1] + body->inertia.m[2][2];
  const double radius = sqrt(trace / 3 / body->mass);
  return isfinite(radius) && radius > 0 ? radius : 1;
}

dem_proxy *dem_proxy_create(const dem_model *model, const tdm_assignment *assignment) {
  const bool matched = assignment->matched_load;
  dem_proxy *x = calloc(1, sizeof *x);
  if (!x)
    return NULL;
  x->k6 = 6 * model->ncoupled;
  x->body = calloc((size_t)model->ncoupled + 1, sizeof *x->body);
  x->matched = matched ? dem_matched_create(model->ncoupled) : NULL;
  x->known = calloc((size_t)model->ncoupled + 1, sizeof *x->known);
  for (int c = 0; x->known && c < model->ncoupled; c++)
    x->known[c] = (known){.name = model->body[model->coupled_body[c]].name, .radius = gyration(&assignment->body[c])};
  if (!x->body || !x->known || (matched && !x->matched))
    dem_proxy_destroy(&x);
  return x;
}

void dem_proxy_destroy(dem_proxy **proxy) {
  dem_proxy *x = *proxy;
  if (!x)
    return;
  gsl_matrix_free(x->L);
  gsl_matrix_free(x->exponential);
  dem_matched_destroy(&x->matched);
  free(x->known);
  free(x->body);
  free(x->block);
  free(x);
  *proxy = NULL;
}

/* ---- small pieces ---- */

static tdm_vec3 vec(const double *a) {
  return (tdm_vec3){a[0], a[1], a[2]};
}

static void set(double *a, tdm_vec3 v) {
  a[0] = v.x, a[1] = v.y, a[2] = v.z;
}

static tdm_twist twist_of(const double *a) {
  return (tdm_twist){vec(a), vec(a + 3)};
}

static tdm_twist add_twists(tdm_twist a, tdm_twist b) {
  return (tdm_twist){tdm_add(a.velocity, b.velocity), tdm_add(a.angular, b.angular)};
}

static tdm_twist along(double s, tdm_twist a, tdm_twist b) {
  return (tdm_twist){tdm_axpy(s, a.velocity, b.velocity), tdm_axpy(s, a.angular, b.angular)};
}

static double power(const double *load, tdm_twist t) {
  return tdm_dot(vec(load), t.velocity) + tdm_dot(vec(load + 3), t.angular);
}

static double speed(tdm_twist twist, double radius) {
  return hypot(tdm_norm(twist.velocity), radius * tdm_norm(twist.angular));
}

/* Value and rate at time t of the cubic over T. */
static void cubic_at(const cubic *c, double T, double t, tdm_twist *value, tdm_twist *rate) {
  const double s = t < T ? t / T : 1;
  const tdm_hermite_weights v = tdm_hermite_at(s, T), d = tdm_hermite_rate_at(s, T);
  const tdm_twist none = {0};
  *value = along(v.f0, c->value0, along(v.d0, c->rate0, along(v.f1, c->value1, along(v.d1, c->rate1, none))));
  *rate = along(d.f0, c->value0, along(d.d0, c->rate0, along(d.f1, c->value1, along(d.d1, c->rate1, none))));
}

static void gather(const dem_proxy *x, const dem_data *d) {
  for (int c = 0; 6 * c < x->k6; c++)
    memcpy(x->W + 6 * c, &d->state.body_load[d->model->coupled_body[c]], 6 * sizeof(double));
}

/* ---- the window's start ---- */

/* Is `rate` (6 rows, n columns, row by row) that of vectors that turn with omega? */
bool dem_proxy_turned(const dem_proxy *x) {
  return x->turned_so;
}

void dem_proxy_turn(dem_proxy *x, bool turned) {
  x->turned_so = turned;
}

static bool turns_with(tdm_vec3 omega, const double *a, const double *rate, int n) {
  double off = 0, all = 0;
  for (int half = 0; half < 2; half++)
    for (int j = 0; j < n; j++) {
      const double *row = a + 3 * half * n + j, *r = rate + 3 * half * n + j;
      tdm_vec3 turning = tdm_cross(omega, (tdm_vec3){row[0], row[n], row[2 * n]});
      tdm_vec3 apart = tdm_sub((tdm_vec3){r[0], r[n], r[2 * n]}, turning);
      off += tdm_dot(apart, apart);
      all += tdm_dot(turning, turning);
    }
  return off <= 1e-6 * all;
}

/* Does nothing within the window show how J goes along with the body: it neither turns nor changes J? */
static bool is_still(const dem_proxy *x, tdm_vec3 omega) {
  double J = 0, rate = 0;
  for (int i = 0; i < x->k6 * x->f; i++) {
    J = fmax(J, fabs(x->J[i]));
    rate = fmax(rate, fabs(x->J_rate[i]));
  }
  return tdm_norm(omega) * x->H <= 1e-9 && rate * x->H <= 1e-9 * J;
}

/* The reduced model; without one the mobility alone stands for a mechanism of 6k independent velocities. */
static tdm_status take_model(dem_proxy *x, const dem_mechanism *mechanism) {
  const tdm_proxy *in = &mechanism->proxy;
  const tdm_mobility *m = &in->mobility;
  const int k = x->k6;
  double any = 0;
  for (int i = 0; i < k * k; i++)
    any = fmax(any, fabs(m->Y[i]));
  const bool alone = m->nfree == 0 && any > 0;
  const int f = alone ? k : m->nfree;
  x->turned_so = x->turned_so && f == x->f;
  x->f = f;
  if (reserve(x, f))
    return TDM_ERR_MEMORY;
  memset(x->J, 0, 4 * (size_t)(k * f) * sizeof(double)); /* J, B and their rates */
  if (alone) {
    memcpy(x->B, m->Y, (size_t)(k * k) * sizeof(double));
    for (int i = 0; i < k; i++) {
      x->J[i * k + i] = 1;
      x->u1[i] = ((const double *)(const void *)&mechanism->start[i / 6].twist)[i % 6];
    }
  } else if (f > 0) {
    const size_t size = (size_t)(k * f) * sizeof(double);
    memcpy(x->J, m->J, size);
    memcpy(x->B, m->B, size);
    memcpy(x->J_rate, m->J_rate, size);
    memcpy(x->B_rate, m->B_rate, size);
    memcpy(x->u1, m->velocity, (size_t)f * sizeof(double));
  }
  memset(x->z, 0, 2 * (size_t)f * sizeof(double));
  return TDM_OK;
}

/* What drivers prescribe: V - J u', and its rate a - J u'' - (dJ/dt) u'. */
static void take_prescribed(dem_proxy *x, const dem_mechanism *mechanism, const double *u2) {
  const int k = x->k6, f = x->f;
  for (int i = 0; i < k; i++) {
    x->Vt[i] = ((const double *)(const void *)&mechanism->start[i / 6].twist)[i % 6];
    x->at[i] = mechanism->proxy.acceleration[i];
    for (int j = 0; j < f; j++) {
      x->Vt[i] -= x->J[i * f + j] * x->u1[j];
      x->at[i] -= x->J[i * f + j] * u2[j] + x->J_rate[i * f + j] * x->u1[j];
    }
  }
  const tdm_vec3 omega = mechanism->start[0].twist.angular;
  const bool rests = tdm_norm(omega) * x->H <= 1e-9, still = is_still(x, omega);
  if (!still) /* as last, which a hinge's turning points need; a body that moves on a circle and does not turn is none
               */
    x->turned_so = turns_with(omega, x->J, x->J_rate, f);
  x->turns = k == 6 && f > 0 && (x->turned_so || (still && f == 1));
  x->path_turns = k == 6 && !rests && turns_with(omega, x->Vt, x->at, 1);
}

/* Flow over dt of (delta u, dt (u' - u'_0), 1): increments of velocities times dt, so that all entries are lengths. */
static void take_flow(dem_proxy *x, const tdm_mobility *m, const double *u2) {
  const int f = x->f, n = 2 * f;
  const double dt = x->dt;
  const bool linear = m->nfree > 0; /* with stiffness and damping */
  gsl_matrix_set_zero(x->L);
  gsl_matrix_view view = gsl_matrix_submatrix(x->L, 0, 0, (size_t)n + 1, (size_t)n + 1);
  gsl_matrix_view out = gsl_matrix_submatrix(x->exponential, 0, 0, (size_t)n + 1, (size_t)n + 1);
  double any = 0;
  for (int i = 0; i < f; i++) {
    gsl_matrix_set(&view.matrix, (size_t)i, (size_t)(f + i), 1);
    gsl_matrix_set(&view.matrix, (size_t)i, (size_t)n, dt * x->u1[i]);
    gsl_matrix_set(&view.matrix, (size_t)(f + i), (size_t)n, dt * dt * u2[i]);
    for (int j = 0; linear && j < f; j++) {
      double stiffness = dt * dt * m->stiffness[i * f + j], damping = dt * m->damping[i * f + j];
      any = fmax(any, fmax(fabs(stiffness), fabs(damping)));
      gsl_matrix_set(&view.matrix, (size_t)(f + i), (size_t)j, -stiffness);
      gsl_matrix_set(&view.matrix, (size_t)(f + i), (size_t)(f + j), -damping);
    }
  }
  if (any > 0) {
    gsl_linalg_exponential_ss(&view.matrix, &out.matrix, GSL_PREC_DOUBLE);
  } else { /* I + L + L^2/2 is all of it */
    gsl_matrix_memcpy(&out.matrix, &view.matrix);
    for (int i = 0; i <= n; i++)
      *gsl_matrix_ptr(&out.matrix, (size_t)i, (size_t)i) += 1;
    for (int i = 0; i < f; i++)
      *gsl_matrix_ptr(&out.matrix, (size_t)i, (size_t)n) += 0.5 * dt * dt * u2[i];
  }
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++)
      x->E[i * n + j] = gsl_matrix_get(&out.matrix, (size_t)i, (size_t)j);
    x->p[i] = gsl_matrix_get(&out.matrix, (size_t)i, (size_t)n);
  }
}

/* Where the bodies stand away from the multibody solver's, and where they are to end beside the proxy. */
static void take_drift(dem_proxy *x, const dem_data *d, const dem_mechanism *mechanism) {
  for (int c = 0; 6 * c < x->k6; c++) {
    const int b = d->model->coupled_body[c];
    const tdm_state *start = &mechanism->start[c];
    const double *correction = mechanism->proxy.correction + 12 * c;
    carried *to = &x->body[c];
    *to = (carried){.start = *start, .now = *start, .path = *start, .mid = start->twist};
    to->drift.value0.velocity = tdm_sub(d->state.pose[b].position, start->pose.position);
    to->drift.value0.angular = tdm_quat_turn(start->pose.orientation, d->state.pose[b].orientation);
    to->drift.rate0.velocity = tdm_sub(d->state.twist[b].velocity, start->twist.velocity);
    to->drift.rate0.angular = tdm_sub(d->state.twist[b].angular, start->twist.angular);
    to->correct.value1 = twist_of(correction);
    to->correct.rate1 = twist_of(correction + 6);
  }
}

tdm_status dem_proxy_begin(dem_proxy *x, const dem_data *d, const dem_mechanism *mechanism,
                           const dem_proxy_window *window, tdm_error *err) {
  const tdm_proxy *in = &mechanism->proxy;
  const double dt = window->dt, contact_time = window->contact_time;
  x->dt = dt;
  x->H = dt * (double)window->nstep;
  x->tau = 0;
  x->blend_time = fmax(x->H, fmax(isfinite(contact_time) ? 0.5 * contact_time : 0, 10 * dt));
  if (take_model(x, mechanism))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a mechanism of %d degrees of freedom", x->f);
  const double *u2 = in->mobility.nfree > 0 ? in->mobility.acceleration : in->acceleration;
  memcpy(x->W0, in->load, (size_t)x->k6 * sizeof(double));
  if (x->k6 > 0)
    take_prescribed(x, mechanism, u2);
  x->path = mechanism->path;
  x->t0 = window->t0;
  if (x->path.nnode > 0 && x->f > 0) { /* the path has it all */
    memset(x->u1, 0, (size_t)x->f * sizeof *x->u1);
    memset(x->work_area, 0, (size_t)x->f * sizeof *x->work_area);
    u2 = x->work_area;
  }
  if (x->f > 0)
    take_flow(x, &in->mobility, u2);
  if (x->matched && dem_matched_begin(x->matched, &in->mobility, window->nstep, dt, x->E))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a mechanism of %d degrees of freedom", x->f);
  take_drift(x, d, mechanism);
  gather(x, d);
  return TDM_OK;
}

/* ---- in a step ---- */

/* J and B at time tau, the body turned by `turn` since the start, into J_now and B_now. */
static void turn_model(dem_proxy *x, double tau, tdm_quat turn) {
  const int k = x->k6, f = x->f;
  if (!x->turns) {
    for (int i = 0; i < k * f; i++) {
      x->J_now[i] = x->J[i] + tau * x->J_rate[i];
      x->B_now[i] = x->B[i] + tau * x->B_rate[i];
    }
    return;
  }
  for (int half = 0; half < 2; half++)
    for (int j = 0; j < f; j++) {
      const double *J = x->J + 3 * half * f + j;
      tdm_vec3 column = tdm_quat_rotate(turn, (tdm_vec3){J[0], J[f], J[2 * f]});
      double *now = x->J_now + 3 * half * f + j;
      now[0] = column.x, now[f] = column.y, now[2 * f] = column.z;
      set(x->B_now + j * k + 3 * half, tdm_quat_rotate(turn, vec(x->B + j * k + 3 * half)));
    }
}

/* What drivers prescribe of the twists at time tau, into V: by the path, which is put there, or from the start on. */
static void prescribed_twists(dem_proxy *x, double tau, tdm_quat turn) {
  for (int c = 0; x->path.nnode > 0 && 6 * c < x->k6; c++) {
    carried *b = &x->body[c];
    b->path = tdm_nodes_at(&x->path, c, &b->start, x->t0, x->t0 + tau);
    set(x->V + 6 * c, b->path.twist.velocity);
    set(x->V + 6 * c + 3, b->path.twist.angular);
  }
  if (x->path.nnode > 0)
    return;
  for (int i = 0; i < x->k6; i++)
    x->V[i] = x->path_turns ? 0 : x->Vt[i] + tau * x->at[i];
  for (int half = 0; half < 2 && x->path_turns; half++)
    set(x->V + 3 * half, tdm_quat_rotate(turn, vec(x->Vt + 3 * half)));
}

/* Twists of the bodies at time tau, with J_now, into V. */
static void twists(dem_proxy *x, double tau, tdm_quat turn) {
  const int k = x->k6, f = x->f;
  prescribed_twists(x, tau, turn);
  for (int i = 0; i < k; i++)
    for (int j = 0; j < f; j++)
      x->V[i] += x->J_now[i * f + j] * (x->u1[j] + x->z[f + j] / x->dt);
}

/* how far the (one) body has turned since the start */
static tdm_quat turn_so_far(const dem_proxy *x) {
  const carried *b = &x->body[0];
  return x->k6 == 6 ? tdm_quat_mul(b->now.pose.orientation, tdm_quat_conj(b->start.pose.orientation))
                    : tdm_quat_identity();
}

/* delta u' += h B (W - W_0) */
static void push(dem_proxy *x, double h) {
  const int k = x->k6, f = x->f;
  for (int j = 0; j < f; j++) {
    double sum = 0;
    for (int i = 0; i < k; i++)
      sum += x->B_now[j * k + i] * (x->W[i] - x->W0[i]);
    x->z[f + j] += h * x->dt * sum;
  }
}

/* What W_0 does over a step, along the flow that it is part of. Along a path it is not. */
static void work_along_flow(dem_proxy *x) {
  for (int c = 0; x->path.nnode == 0 && 6 * c < x->k6; c++)
    x->body[c].work += x->dt * power(x->W0 + 6 * c, x->body[c].mid);
}

/* Half a kick, and the works that it does: load times the mean of the twists before and after. What moves the bodies
 * is W - W_0, and the rest of its work is along the flow. */
static void half_kick(dem_proxy *x) {
  const tdm_quat turn = turn_so_far(x);
  const double h = 0.5 * x->dt;
  if (x->matched)
    dem_matched_half_kick(x->matched, x->W);
  turn_model(x, x->tau, turn);
  for (int after = 0; after < 2; after++) {
    if (after)
      push(x, h);
    twists(x, x->tau, turn);
    for (int c = 0; 6 * c < x->k6; c++) {
      tdm_twist value, rate;
      carried *b = &x->body[c];
      b->now.twist = twist_of(x->V + 6 * c);
      cubic_at(&b->correct, x->H, x->tau, &value, &rate);
      b->work += 0.5 * h * power(x->W + 6 * c, add_twists(b->now.twist, rate));
      if (x->path.nnode == 0)
        b->work -= 0.5 * h * power(x->W0 + 6 * c, b->now.twist);
      cubic_at(&b->drift, x->blend_time, x->tau, &value, &rate);
      b->blending += 0.5 * h * power(x->W + 6 * c, rate);
    }
  }
}

/* Put body c where the proxy, drift and correction have it, with a twist of the proxy. */
static void put(const dem_proxy *x, dem_data *d, int c, tdm_twist twist) {
  const carried *b = &x->body[c];
  const int to = d->model->coupled_body[c];
  tdm_twist drift, drift_rate, way, way_rate;
  cubic_at(&b->drift, x->blend_time, x->tau, &drift, &drift_rate);
  cubic_at(&b->correct, x->H, x->tau, &way, &way_rate);
  way = add_twists(drift, way);
  d->state.pose[to].position = tdm_add(b->now.pose.position, way.velocity);
  d->state.pose[to].orientation = tdm_quat_turned(b->now.pose.orientation, way.angular);
  d->state.twist[to] = add_twists(twist, add_twists(drift_rate, way_rate));
}

/* The contacts' effective mass: Y = J B of each body. */
static void tell_mobilities(const dem_proxy *x, dem_data *d) {
  const int k = x->k6, f = x->f;
  for (int c = 0; 6 * c < k; c++) {
    double Y[36] = {0};
    for (int i = 0; i < 6; i++)
      for (int l = 0; l < 6; l++)
        for (int j = 0; j < f; j++)
          Y[6 * i + l] += x->J_now[(6 * c + i) * f + j] * x->B_now[j * k + 6 * c + l];
    dem_set_body_mobility(d, c, Y);
  }
}

/* A body over the step at its twist in the middle. Along a path the step of the path is taken as it is, so that a body
 * that no load moves stays on it. */
static void move(const dem_proxy *x, carried *b, int c) {
  tdm_vec3 turn = b->mid.angular;
  if (x->path.nnode == 0)
    b->now.pose.position = tdm_axpy(x->dt, b->mid.velocity, b->now.pose.position);
  else {
    const tdm_twist along_path = b->path.twist; /* in the middle */
    b->path = tdm_nodes_at(&x->path, c, &b->start, x->t0, x->t0 + x->tau + x->dt);
    b->aside = tdm_axpy(x->dt, tdm_sub(b->mid.velocity, along_path.velocity), b->aside);
    b->now.pose.position = tdm_add(b->path.pose.position, b->aside);
    b->now.pose.orientation =
        tdm_quat_turned(b->now.pose.orientation, tdm_quat_turn(b->before, b->path.pose.orientation));
    turn = tdm_sub(turn, along_path.angular);
  }
  b->now.pose.orientation = tdm_quat_turned(b->now.pose.orientation, tdm_scale(x->dt, turn));
}

void dem_proxy_drift(dem_proxy *x, dem_data *d) {
  const int f = x->f, n = 2 * f;
  const double dt = x->dt;
  half_kick(x);

  /* the flow; the mean velocity over the step moves the poses */
  double *next = x->work_area;
  for (int i = 0; i < n; i++) {
    next[i] = x->p[i];
    for (int j = 0; j < n; j++)
      next[i] += x->E[i * n + j] * x->z[j];
  }
  for (int j = 0; j < f; j++) /* mean of u' - u'_0, times dt */
    x->z[f + j] = next[j] - x->z[j] - dt * x->u1[j];
  const double middle = x->tau + 0.5 * dt;
  tdm_quat turn =
      x->k6 > 0 ? tdm_quat_turned(turn_so_far(x), tdm_scale(0.5 * dt, x->body[0].mid.angular)) : tdm_quat_identity();
  turn_model(x, middle, turn);
  for (int c = 0; 6 * c < x->k6; c++)
    x->body[c].before = x->body[c].path.pose.orientation;
  twists(x, middle, turn);
  for (int c = 0; 6 * c < x->k6; c++) {
    x->body[c].mid = twist_of(x->V + 6 * c);
    move(x, &x->body[c], c);
  }
  work_along_flow(x);
  memcpy(x->z, next, (size_t)n * sizeof *next);
  if (x->matched)
    dem_matched_flow(x->matched);
  x->tau += dt;

  /* contacts see the velocity predicted for the end of the step */
  turn = turn_so_far(x);
  turn_model(x, x->tau, turn);
  push(x, 0.5 * dt);
  twists(x, x->tau, turn);
  memcpy(x->z, next, (size_t)n * sizeof *next);
  for (int c = 0; 6 * c < x->k6; c++)
    put(x, d, c, twist_of(x->V + 6 * c));
  dem_coupled_walls_put(d);
  tell_mobilities(x, d);
}

tdm_status dem_proxy_rate2(const dem_proxy *x, dem_data *d, double *rate2, tdm_error *err) {
  return dem_walls_rate2(d, x->f, x->J_now, x->B_now, rate2, err);
}

void dem_proxy_kick(dem_proxy *x, const dem_data *d) {
  gather(x, d);
  half_kick(x);
}

/* A mechanism that vibrates within the window faster than the load polynomial can: what is left of the load moves it.
 */
static void look_for_vibration(dem_proxy *x) {
  const double share = 0.5, least = 1e-7; /* of the largest speed so far; way within the window [m] */
  const double *rest = dem_matched_rest(x->matched);
  for (int c = 0; rest && 6 * c < x->k6; c++) {
    double V[6] = {0};
    for (int i = 0; i < 6; i++)
      for (int j = 0; j < x->f; j++)
        V[i] += x->J[(6 * c + i) * x->f + j] * rest[j];
    const double is = speed(twist_of(V), x->known[c].radius);
    if (!(is > share * x->known[c].fastest) || !(is * x->H > least))
      continue;
    tdm_remark(TDM_NOTICE, "vibration", NULL, x->t0,
               "the mechanism of \"%s\" vibrates too fast for the window from %.6g s to %.6g s: what a load polynomial "
               "leaves out of its contacts' load makes %.2g of its largest speed so far; take a smaller coupling.n",
               x->known[c].name, x->t0, x->t0 + x->H, is / x->known[c].fastest);
    return;
  }
}

void dem_proxy_end(dem_proxy *x, dem_data *d, tdm_interface *body, tdm_wrench *further) {
  for (int c = 0; 6 * c < x->k6; c++) {
    const carried *b = &x->body[c];
    put(x, d, c, b->now.twist);
    x->known[c].fastest = fmax(x->known[c].fastest, speed(b->now.twist, x->known[c].radius));
    if (body) {
      body[c].end = b->now;
      body[c].work = b->work;
      body[c].blending = b->blending;
    }
  }
  if (x->matched && body && further) {
    dem_matched_end(x->matched, body, further);
    look_for_vibration(x);
  }
}
