/* One step of generalised-alpha on the group of poses: see alpha.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/integrate/alpha/alpha.h"

#include "mbd/equations/residual.h"
#include "mbd/equations/tangent.h"
#include "mbd/linear/largest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ITERATIONS_MAX = 12 };

/* ---- evaluation ---- */

/* Kinematics, forces, inertia and rows at (t, y). */
static void evaluate(mbd_alpha *s, double t, const double *y) {
  const mbd_model *m = s->model;
  mbd_kinematics(m, s->data, t, y);
  mbd_generalised_forces(m, s->data, t, s->Q);
  for (int b = 0; b < m->nbody; b++)
    s->inertia[b] = mbd_inertia_world(&m->body[b], &s->data->kin[b + 1]);
  memset(s->g, 0, (size_t)m->nrow * sizeof(double));
  memset(s->g_t, 0, (size_t)m->nrow * sizeof(double));
  for (int i = 0; i < m->npart; i++) {
    const mbd_rows *rows = mbd_part_at(m, s->data, i, false);
    mbd_alpha_rows *p = &s->rows[i];
    *p = (mbd_alpha_rows){.body = {rows->body[0], rows->body[1]}, .first = rows->first, .n = rows->n};
    memset(p->G, 0, (size_t)rows->n * sizeof rows->G[0]);
    for (int k = 0; k < rows->n; k++) {
      if (s->data->dependent[rows->first + k]) /* no equation: lambda stays 0 */
        continue;
      memcpy(p->G[k], rows->G[k], sizeof rows->G[k]);
      s->g[rows->first + k] += rows->g[k];
      s->g_t[rows->first + k] += rows->g_t[k];
    }
  }
  s->data->stats.residuals++;
}

void mbd_alpha_multiply(const mbd_alpha *s, const double *in, double *out) {
  const double *lambda = in + s->nv;
  double *row = out + s->nv;
  memset(row, 0, (size_t)s->model->nrow * sizeof(double));
  for (int b = 0; b < s->model->nbody; b++) {
    mbd_set3(out + 6 * b, tdm_scale(s->model->body[b].mass, mbd_get3(in + 6 * b)));
    mbd_set3(out + 6 * b + 3, tdm_m3_mul(s->inertia[b], mbd_get3(in + 6 * b + 3)));
  }
  for (int i = 0; i < s->model->npart; i++) {
    const mbd_alpha_rows *p = &s->rows[i];
    for (int side = 0; side < 2; side++)
      for (int c = 0; c < 6 && p->body[side] != MBD_GROUND; c++)
        for (int k = 0; k < p->n; k++) {
          double G = p->G[k][6 * side + c];
          out[6 * p->body[side] + c] += G * lambda[p->first + k];
          row[p->first + k] += G * in[6 * p->body[side] + c];
        }
  }
}

/* An entry of a derivative by the poses into Newton's matrix, whose unknowns change D: dtheta = T dD. */
static void add_turned(void *context, int row, int col, double value) {
  mbd_alpha *s = context;
  if (!s->turns || col % 6 < 3) {
    mbd_lu_add(s->now.step, row, col, value);
    return;
  }
  for (int j = 0; j < 3; j++)
    mbd_lu_add(s->now.step, row, col - col % 6 + 3 + j, value * s->turned[col / 6].m[col % 6 - 3][j]);
}

/* G and G^T into a matrix; G by `add` */
static void add_rows(mbd_alpha *s, mbd_lu *to, mbd_entry_fn add, void *context) {
  for (int i = 0; i < s->model->npart; i++) {
    const mbd_alpha_rows *p = &s->rows[i];
    for (int side = 0; side < 2; side++)
      for (int c = 0; c < 6 && p->body[side] != MBD_GROUND; c++)
        for (int k = 0; k < p->n; k++) {
          int row = s->nv + p->first + k, col = 6 * p->body[side] + c;
          add(context, row, col, p->G[k][6 * side + c]);
          mbd_lu_add(to, col, row, p->G[k][6 * side + c]);
        }
  }
  for (int i = 0; i < s->model->nrow; i++)
    if (s->data->dependent[i])
      mbd_lu_add(to, s->nv + i, s->nv + i, 1);
}

static bool make_mass(mbd_alpha *s) {
  mbd_lu_clear(s->now.mass);
  mbd_tangent(s->model, s->data, s->vdot1, s->lambda1, (mbd_weights){.mass = 1}, mbd_lu_add, s->now.mass);
  add_rows(s, s->now.mass, mbd_lu_add, s->now.mass);
  s->data->stats.jacobians++;
  return s->now.mass_made = mbd_lu_factor(s->now.mass);
}

/* Solve [M G^T; G 0] x = r at the last evaluation into s->x: old factors, improved until the equations of now hold. */
static bool solve_mass(mbd_alpha *s, const double *r) {
  for (int attempt = 0; attempt < 2; attempt++) {
    if ((attempt == 1 || !s->now.mass_made) && !make_mass(s))
      return false;
    memset(s->x, 0, (size_t)s->n * sizeof(double));
    double last = INFINITY;
    for (int i = 0; i < 6; i++) {
      mbd_alpha_multiply(s, s->x, s->dx);
      for (int k = 0; k < s->n; k++)
        s->dx[k] = r[k] - s->dx[k];
      mbd_lu_solve(s->now.mass, s->dx);
      for (int k = 0; k < s->n; k++)
        s->x[k] += s->dx[k];
      double change = mbd_largest(s->dx, s->nv), size = mbd_largest(s->x, s->nv);
      if (change <= 1e-11 * size) {
        if (i > 3)
          s->now.mass_made = false; /* worn: the next solution makes its own */
        return true;
      }
      if (!(change < 0.1 * last))
        break;
      last = change;
    }
    if (attempt == 1) /* as good as rounding lets it be */
      return tdm_finite(s->x, s->n);
  }
  return false;
}

/* ---- the load ---- */

bool mbd_alpha_respond(mbd_alpha *s, double t) {
  const mbd_model *m = s->model;
  const mbd_data *d = s->data;
  s->responded = true;
  memset(s->X, 0, TDM_LOAD_MAX * (size_t)s->n * sizeof(double));
  if (m->ncoupled == 0 || d->nload == 0)
    return true;
  evaluate(s, t, s->y0);
  for (int j = 0; j < d->nload; j++) {
    memset(s->r, 0, (size_t)s->n * sizeof(double));
    for (int c = 0; c < m->ncoupled; c++)
      memcpy(s->r + 6 * m->coupled[c], &d->load[c * d->nload + j], sizeof(tdm_wrench));
    if (mbd_largest(s->r, s->nv) == 0)
      continue;
    if (!solve_mass(s, s->r))
      return false;
    memcpy(s->X + j * s->n, s->x, (size_t)s->n * sizeof(double));
  }
  return true;
}

void mbd_alpha_response(const mbd_alpha *s, double t, double *out) {
  const mbd_data *d = s->data;
  const double at = d->load_t1 > d->load_t0 ? (t - d->load_t0) / (d->load_t1 - d->load_t0) : 0;
  memset(out, 0, (size_t)s->n * sizeof(double));
  for (int j = d->nload - 1; j >= 0; j--)
    for (int k = 0; k < s->n; k++)
      out[k] = at * out[k] + s->X[j * s->n + k];
}

/* X, P and S of the step from t to t1 */
static void respond(mbd_alpha *s, double t, double t1) {
  const mbd_data *d = s->data;
  const double H = d->load_t1 - d->load_t0, from = H > 0 ? (t - d->load_t0) / H : 0,
               to = H > 0 ? (t1 - d->load_t0) / H : 0;
  double before = from, after = to; /* to the power of j + 1 */
  mbd_alpha_response(s, t, s->X0);
  mbd_alpha_response(s, t1, s->X1);
  memset(s->P, 0, (size_t)s->nv * sizeof(double));
  memset(s->S, 0, (size_t)s->nv * sizeof(double));
  for (int j = 0; j < d->nload; j++, before *= from, after *= to) {
    const double p = H * (after - before) / (j + 1);
    const double q = H * H * ((after * to - before * from) / (j + 2) - before * (to - from)) / (j + 1);
    for (int k = 0; k < s->nv; k++) {
      s->P[k] += p * s->X[j * s->n + k];
      s->S[k] += q * s->X[j * s->n + k];
    }
  }
}

/* ---- poses ---- */

void mbd_alpha_place(const mbd_model *model, double *y, const double *y0, const double *move) {
  for (int b = 0; b < model->nbody; b++) {
    const double *from = y0 + MBD_BODY_UNKNOWNS * b, *d = move + 6 * b;
    double *to = y + MBD_BODY_UNKNOWNS * b;
    for (int i = 0; i < 3; i++)
      to[MBD_R + i] = from[MBD_R + i] + d[i];
    tdm_quat q = tdm_quat_turned(mbd_quat_of(y0, b), mbd_get3(d + 3));
    to[MBD_P] = q.w;
    to[MBD_P + 1] = q.x;
    to[MBD_P + 2] = q.y;
    to[MBD_P + 3] = q.z;
  }
}

/* a at the end of the step, of component k */
static double next_a(const mbd_alpha *s, int k) {
  return ((1 - s->af) * (s->vdot1[k] - s->X1[k]) + s->af * s->now.w[k] - s->am * s->now.a[k]) / (1 - s->am);
}

/* y1 from y0 and vdot1 over h */
static void place_end(mbd_alpha *s, double h) {
  for (int b = 0; b < s->model->nbody; b++)
    for (int i = 0; i < 6; i++) {
      int k = 6 * b + i, v = MBD_BODY_UNKNOWNS * b + MBD_V + i;
      double a = s->now.a[k], a1 = next_a(s, k);
      s->move[k] = h * s->y0[v] + h * h * ((0.5 - s->beta) * a + s->beta * a1) + s->S[k];
      s->y1[v] = s->y0[v] + h * ((1 - s->gamma) * a + s->gamma * a1) + s->P[k];
    }
  mbd_alpha_place(s->model, s->y1, s->y0, s->move);
}

/* ---- a step ---- */

/* T of each body, T = 1 + (1 - cos a)/a^2 [D] + (a - sin a)/a^3 [D]^2, a = |D|, where it is far enough from 1 to slow
 * Newton down. */
static void turn_tangents(mbd_alpha *s) {
  s->turns = false;
  for (int b = 0; b < s->model->nbody; b++) {
    tdm_vec3 D = mbd_get3(s->move + 6 * b + 3);
    double a = tdm_norm(D), first = a > 1e-3 ? (1 - cos(a)) / (a * a) : 0.5;
    double second = a > 1e-2 ? (a - sin(a)) / (a * a * a) : 1.0 / 6;
    tdm_mat3 skew = tdm_m3_skew(D), square = mbd_skew2(D, D);
    for (int i = 0; i < 3; i++)
      for (int j = 0; j < 3; j++)
        s->turned[b].m[i][j] = (i == j) + first * skew.m[i][j] + second * square.m[i][j];
    s->turns = s->turns || a > 0.02;
  }
}

/* Newton's matrix at the last evaluation. */
static bool make_step(mbd_alpha *s, double h) {
  double b = h * (1 - s->af) / (1 - s->am);
  turn_tangents(s);
  mbd_weights all = {1, b * s->gamma, b * h * s->beta};
  mbd_lu_clear(s->now.step);
  if (s->turns) {
    mbd_tangent(s->model, s->data, s->vdot1, s->lambda1, (mbd_weights){.stiffness = all.stiffness}, add_turned, s);
    all.stiffness = 0;
  }
  mbd_tangent(s->model, s->data, s->vdot1, s->lambda1, all, mbd_lu_add, s->now.step);
  add_rows(s, s->now.step, add_turned, s);
  s->now.step_length = mbd_lu_factor(s->now.step) ? h : 0;
  s->data->stats.jacobians++;
  return s->now.step_length > 0;
}

/* The turn of a body by an error of 1 m in a row, whose part of this body is G [rad/m]: by its arm, or as its inertia
 * lets it. */
static double turn_by_shift(const mbd_body *body, const double *G) {
  double along = tdm_norm(mbd_get3(G)), about = tdm_norm(mbd_get3(G + 3));
  if (along == 0 || about == 0)
    return 0;
  const tdm_mat3 *inverse = &body->inverse_inertia;
  double give = body->mass * (inverse->m[0][0] + inverse->m[1][1] + inverse->m[2][2]);
  return fmin(along / about, give * about / along);
}

/* What rounding leaves of positions and angles, at the last evaluation. Newton's iteration goes down to it: what it
 * leaves would add up over the steps, and one iteration more costs little. */
static void find_rounding(mbd_alpha *s) {
  const mbd_model *m = s->model;
  double reach = 0, turn = 1;
  for (int b = 0; b < m->nbody; b++)
    reach = fmax(reach, mbd_largest(s->y0 + MBD_BODY_UNKNOWNS * b + MBD_R, 3));
  for (int i = 0; i < m->npart; i++) {
    const mbd_part *part = &m->part[i];
    const mbd_alpha_rows *p = &s->rows[i];
    if (part->turn >= 0 && (part->driver || part->joint->ops->counts))
      turn = fmax(turn, fabs(s->data->turn[part->turn]));
    for (int side = 0; side < 2; side++)
      for (int k = 0; k < p->n && p->body[side] != MBD_GROUND; k++)
        turn = fmax(turn, reach * turn_by_shift(&m->body[p->body[side]], p->G[k] + 6 * side));
  }
  s->rounding[0] = 4e-15 * fmax(1, reach);
  s->rounding[1] = 4e-15 * turn;
}

double mbd_alpha_by_mass(const mbd_alpha *s, int b, const double *x) {
  tdm_vec3 along = mbd_get3(x), about = mbd_get3(x + 3);
  return s->model->body[b].mass * tdm_dot(along, along) + tdm_dot(about, tdm_m3_mul(s->inertia[b], about));
}

double mbd_alpha_speed(const mbd_alpha *s, int b, const double *y) {
  return sqrt(mbd_alpha_by_mass(s, b, y + MBD_BODY_UNKNOWNS * b + MBD_V) / s->model->body[b].mass);
}

/* sqrt(x M x) of x (nv) */
static double size_of(const mbd_alpha *s, const double *x) {
  double sum = 0;
  for (int b = 0; b < s->model->nbody; b++)
    sum += mbd_alpha_by_mass(s, b, x + 6 * b);
  return sqrt(sum);
}

/* the same of the velocities in y */
static double motion_of(const mbd_alpha *s, const double *y) {
  double sum = 0;
  for (int b = 0; b < s->model->nbody; b++)
    sum += mbd_alpha_by_mass(s, b, y + MBD_BODY_UNKNOWNS * b + MBD_V);
  return sqrt(sum);
}

/* how far a correction went: in positions and angles, in units of what rounding leaves, and sqrt(dVdot M dVdot) */
typedef struct {
  double position, acceleration;
} correction;

/* One correction of vdot1, lambda1 and y1. `closed`: the constraints are closed to rounding, and what is left of them
 * does not count: divided by h^2 it would. */
static correction correct(mbd_alpha *s, double h, bool closed) {
  double by_position = h * h * s->beta * (1 - s->af) / (1 - s->am);
  memcpy(s->x, s->vdot1, (size_t)s->nv * sizeof(double));
  memcpy(s->x + s->nv, s->lambda1, (size_t)s->model->nrow * sizeof(double));
  mbd_alpha_multiply(s, s->x, s->dx);
  for (int k = 0; k < s->nv; k++)
    s->dx[k] = s->Q[k] - s->dx[k];
  for (int k = s->nv; k < s->n; k++)
    s->dx[k] = closed ? 0 : -s->g[k - s->nv] / by_position;
  mbd_lu_solve(s->now.step, s->dx);
  for (int k = 0; k < s->nv; k++)
    s->vdot1[k] += s->dx[k];
  for (int k = s->nv; k < s->n; k++)
    s->lambda1[k - s->nv] += s->dx[k];
  place_end(s, h);
  double size = 0;
  for (int k = 0; k < s->nv; k += 3)
    size = fmax(size, mbd_largest(s->dx + k, 3) / s->rounding[k % 6 / 3]);
  return (correction){by_position * size, size_of(s, s->dx)};
}

/* Where Newton starts. */
static void predict(mbd_alpha *s, double h) {
  for (int k = 0; k < s->nv; k++)
    s->guess[k] = s->vdot1[k] = s->now.w[k] + h * s->now.slope[k] + s->X1[k];
  for (int k = 0; k < s->model->nrow; k++)
    s->lambda1[k] = s->now.lambda[k] + h * s->now.lambda_slope[k] + s->X1[s->nv + k];
  place_end(s, h);
}

/* What of Vdot1 may be left, sqrt(dVdot M dVdot): little against the local error, or rounding. */
static double negligible(mbd_alpha *s, double h) {
  const double little = 0.02, rounding = 1e-13;
  double change = 0;
  for (int b = 0; b < s->model->nbody; b++) {
    double d[6];
    for (int i = 0; i < 6; i++)
      d[i] = s->vdot1[6 * b + i] - s->guess[6 * b + i];
    change += mbd_alpha_by_mass(s, b, d);
  }
  return fmax(little * fabs(s->c3) * sqrt(change), rounding * (size_of(s, s->vdot1) + 1e-4 * motion_of(s, s->y1) / h));
}

/* Solve for vdot1 and lambda1 at the end of the step; false: no convergence. Positions go down to what rounding leaves
 * first, then accelerations: what is left of them is no way to speak of in a short step, but adds up over many. */
static bool newton(mbd_alpha *s, double t1, double h) {
  /* Rates are not taken for better than these: rounding of the constraints may be in the change before; and what
   * factors do well with is gone after the first correction, with what is left of the constraints they may do worse. */
  const double fastest = 0.1, fastest_closing = 1e-3;
  correction last = {0, 0};
  bool closed = false, fresh = false;
  int since = 0; /* corrections with these factors on constraints that were closed */
  predict(s, h);
  for (int total = 0, i = 0; total < ITERATIONS_MAX; total++, i++) {
    evaluate(s, t1, s->y1);
    if (total == 0)
      find_rounding(s);
    if (fabs(s->now.step_length - h) > 1e-6 * h) { /* windows differ by rounding */
      if (!make_step(s, h))
        return false;
      fresh = true;
    }
    correction now = correct(s, h, closed);
    since += closed;
    double rate = i > 0 ? now.position / last.position : 0;
    double slower = i > 0 ? fmax(fastest, now.acceleration / last.acceleration) : 1;
    if (!(now.position < 1e18)) /* or not a number */
      return false;
    closed = closed || now.position <= 0.01 ||
             (i > 0 && (now.position <= 1 || (rate < 0.3 && fmax(rate, fastest_closing) * now.position <= 0.1)));
    if (closed && slower * now.acceleration <= negligible(s, h)) {
      if (i > 3)
        s->now.step_length = 0; /* worn out: the next step makes its own */
      return true;
    }
    last = now;
    if (since > 1 && slower > 0.3 && fresh) /* rounding does not let it go on */
      return true;
    if (closed ? since > 1 && slower > 0.3 : rate > 0.3) { /* the matrix does not fit here */
      s->now.step_length = 0;
      i = -1;
      since = 0;
    }
  }
  return closed || last.position <= 100; /* it stopped where rounding did not let it go on */
}

/* Put the velocities of y1 onto the constraints, at the last evaluation, which was there. */
static bool project(mbd_alpha *s) {
  if (s->model->nrow == 0)
    return true;
  for (int b = 0; b < s->model->nbody; b++)
    memcpy(s->x + 6 * b, s->y1 + MBD_BODY_UNKNOWNS * b + MBD_V, 6 * sizeof(double));
  memset(s->x + s->nv, 0, (size_t)s->model->nrow * sizeof(double));
  mbd_alpha_multiply(s, s->x, s->r);
  memset(s->r, 0, (size_t)s->nv * sizeof(double));
  for (int k = s->nv; k < s->n; k++)
    s->r[k] = -s->r[k] - s->g_t[k - s->nv];
  if (mbd_largest(s->r + s->nv, s->model->nrow) == 0)
    return true;
  if (!solve_mass(s, s->r))
    return false;
  for (int b = 0; b < s->model->nbody; b++)
    for (int i = 0; i < 6; i++)
      s->y1[MBD_BODY_UNKNOWNS * b + MBD_V + i] += s->x[6 * b + i];
  return true;
}

/* V^T H V + g_tt of row k of a part at the last evaluation */
static double row_bias(const mbd_alpha *s, const mbd_rows *rows, int k) {
  double V[MBD_PAIR], sum = rows->g_tt[k];
  mbd_pair_twist(&s->data->kin[rows->body[0] + 1], &s->data->kin[rows->body[1] + 1], V);
  for (int i = 0; i < MBD_PAIR; i++)
    for (int j = 0; j < MBD_PAIR; j++)
      sum += V[i] * rows->H[k][i][j] * V[j];
  return sum;
}

/* Newton's lambda1 has an error of first order: positions and the projected velocities leave none but the accelerations
 * to give way. Where drivers do work by it, it is that of the accelerations at y1 instead. */
static bool refine_reactions(mbd_alpha *s, double t1) {
  const mbd_model *m = s->model;
  if (m->ndriver == 0)
    return true;
  evaluate(s, t1, s->y1);
  memcpy(s->r, s->Q, (size_t)s->nv * sizeof(double));
  memset(s->r + s->nv, 0, (size_t)m->nrow * sizeof(double));
  for (int i = 0; i < m->npart; i++) {
    const mbd_rows *rows = mbd_part_at(m, s->data, i, true);
    for (int k = 0; k < rows->n; k++)
      if (!s->data->dependent[rows->first + k])
        s->r[s->nv + rows->first + k] -= row_bias(s, rows, k);
  }
  if (!solve_mass(s, s->r))
    return false;
  memcpy(s->lambda1, s->x + s->nv, (size_t)m->nrow * sizeof(double));
  return true;
}

/* Does the acceleration vdot of a body change by more than itself in a step h, at the rate `slope`? Bodies that hardly
 * take part do not count. */
static bool stiff(const mbd_alpha *s, double h, const double *vdot) {
  const double all = size_of(s, vdot);
  for (int b = 0; b < s->model->nbody; b++)
    if (h * h * mbd_alpha_by_mass(s, b, s->now.slope + 6 * b) >
        mbd_alpha_by_mass(s, b, vdot + 6 * b) + 1e-4 * all * all)
      return true;
  return false;
}

/* The first step after a start, where `slope` is dw/dt. Forces that are stiff in a step do not begin it with what they
 * are now, but with what Newton's matrix lets them become. */
static bool relax(mbd_alpha *s, double t, double h) {
  s->now.started = false;
  evaluate(s, t, s->y0);
  for (int k = 0; k < s->n; k++) /* Vdot and lambda */
    s->x[k] = s->X0[k] + (k < s->nv ? s->now.w[k] : s->now.lambda[k - s->nv]);
  if (!stiff(s, h, s->x))
    return true;
  memset(s->move, 0, (size_t)s->nv * sizeof(double));
  memset(s->now.slope, 0, (size_t)s->nv * sizeof(double));
  memset(s->now.lambda_slope, 0, (size_t)s->model->nrow * sizeof(double));
  memcpy(s->vdot1, s->x, (size_t)s->nv * sizeof(double));
  memcpy(s->lambda1, s->x + s->nv, (size_t)s->model->nrow * sizeof(double));
  mbd_alpha_multiply(s, s->x, s->dx);
  if (!make_step(s, h))
    return false;
  mbd_lu_solve(s->now.step, s->dx);
  for (int k = 0; k < s->nv; k++)
    s->now.w[k] = s->now.a[k] = s->dx[k] - s->X0[k];
  for (int k = s->nv; k < s->n; k++)
    s->now.lambda[k - s->nv] = s->dx[k] - s->X0[k];
  s->now.step_length = 0;
  return true;
}

/* Has no body turned too far for angles to be counted, by joints and springs to the nearest turn? Two bodies turn
 * against each other by the sum at most, so by less than half a turn. */
static bool turned_little(const mbd_alpha *s) {
  for (int b = 0; b < s->model->nbody; b++)
    if (!(tdm_norm(mbd_get3(s->move + 6 * b + 3)) <= mbd_turn_most))
      return false;
  return true;
}

/* a belongs to the step before. Of its distance from w the part that goes with the step is taken along; what is left
 * of a jump is not, and dies away: it would grow with growing steps. */
static void lengthen(mbd_alpha *s, double h) {
  const double by = (s->am - s->af) * (h - s->now.last);
  for (int k = 0; k < s->nv; k++)
    s->now.a[k] += by * s->now.slope[k];
}

/* y1 with the normal forces of frictions as they are. */
static bool solve_step(mbd_alpha *s, double t1, double h) {
  if (!newton(s, t1, h) || !turned_little(s))
    return false;
  evaluate(s, t1, s->y1);
  return project(s);
}

/* The normal forces of frictions that rub by reactions at the end of the step: those of the accelerations, since
 * Newton's reactions have an error of first order. They change little from pass to pass: by what the step makes of a
 * change of the friction. */
static bool solve_with_normals(mbd_alpha *s, double t1, double h) {
  enum { PASSES_MAX = 20 };
  const mbd_stick *stick = s->data->stick;
  for (int pass = 0; pass < PASSES_MAX; pass++) {
    double change = 0, most = 0;
    if (!solve_step(s, t1, h))
      return false;
    if (s->model->nreacting == 0)
      return true;
    for (int k = 0; k < s->model->nfriction; k++)
      s->normal[k] = stick[k].normal;
    if (!mbd_accelerations(s->model, s->data, s->kkt, t1, s->y1))
      return false;
    for (int k = 0; k < s->model->nfriction; k++) {
      change = fmax(change, fabs(stick[k].normal - s->normal[k]));
      most = fmax(most, fabs(stick[k].normal));
    }
    if (change <= 1e-11 * most)
      return true;
  }
  return false;
}

bool mbd_alpha_step(mbd_alpha *s, double t, double t1) {
  const double h = t1 - t;
  respond(s, t, t1);
  bool good = !s->now.started || relax(s, t, h);
  lengthen(s, h);
  good = good && solve_with_normals(s, t1, h) && refine_reactions(s, t1);
  if (!good)
    s->now.step_length = 0;
  return good;
}

void mbd_alpha_copy(const mbd_alpha *s, mbd_alpha_memory *to, const mbd_alpha_memory *from) {
  const mbd_model *m = s->model;
#define COPY_SCALAR(type, name) to->name = from->name;
#define COPY_ARRAY(type, name, count) memcpy(to->name, from->name, (size_t)(count) * sizeof *to->name);
  MBD_ALPHA_SCALARS(COPY_SCALAR)
  MBD_ALPHA_ARRAYS(COPY_ARRAY)
#undef COPY_SCALAR
#undef COPY_ARRAY
}

void mbd_alpha_accept(mbd_alpha *s, double t1, double h) {
  const mbd_model *m = s->model;
  for (int i = 0; i < s->nv; i++) {
    const double w = s->vdot1[i] - s->X1[i];
    s->Q[i] = s->now.w[i] + s->X0[i];
    s->now.a[i] = next_a(s, i);
    s->now.slope[i] = (w - s->now.w[i]) / h;
    s->now.w[i] = w;
  }
  for (int i = 0; i < m->nrow; i++) {
    const double lambda = s->lambda1[i] - s->X1[s->nv + i];
    s->lambda0[i] = s->now.lambda[i] + s->X0[s->nv + i];
    s->now.lambda_slope[i] = (lambda - s->now.lambda[i]) / h;
    s->now.lambda[i] = lambda;
  }
  memcpy(s->y1 + mbd_index_lambda(m, 0), s->lambda1, (size_t)m->nrow * sizeof(double));
  for (int b = 0; b < m->nbody; b++)
    s->now.speed[b] = fmax(s->now.speed[b], mbd_alpha_speed(s, b, s->y1));
  s->now.last = h;
  s->data->stats.steps++;
  mbd_accept(m, s->data, t1, s->y1);
}
