/* Rules of the multibody side: a known load gives a known motion. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/conform/meeting.h"

#include <math.h>
#include <string.h>

enum { BODIES = 2, K = 6 * BODIES }; /* bodies that are looked at, and their loads */

static const double close = 0.01, rounding = 1e-3; /* shares that short windows, and integrators, may be off */

/* How the bodies answer to unit loads over one short window. */
typedef struct {
  int nbody, k;   /* k = 6 nbody */
  double R[K][K]; /* change of velocity i by load j, over the impulse */
  double free[K]; /* the most that a load moves its own body along itself: as if that were free */
  double size[K]; /* load that would give a free body 1 m/s2 or 1 rad/s2 */
} answer;

static void put_twist(double *out, const tdm_twist *t) {
  memcpy(out, t, 6 * sizeof *out);
}

/* One window from the start under W(s) = sum of c_j s^j; the velocities at its end. */
static bool first_window(cpl_candidate *c, cpl_verdict *v, long n, int nload, int at, double size, double *end) {
  cpl_meeting m;
  tdm_result r;
  if (!cpl_meeting_open(&m, c, v))
    return false;
  tdm_step step = cpl_meeting_next(&m, n);
  tdm_wrench *load = calloc((size_t)(step.nbody * nload) + 1, sizeof *load);
  step.load = load;
  step.nload = nload;
  if (at >= 0) /* the last coefficient, such that the mean is `size` */
    ((double *)(void *)&load[at / 6 * nload + nload - 1])[at % 6] = size * nload;
  const bool good = load && cpl_meeting_solve(&m, &step, &r);
  for (int i = 0; good && i < step.nbody && i < BODIES; i++)
    put_twist(end + 6 * i, &r.state[i].twist);
  free(load);
  cpl_meeting_drop(&m);
  return good;
}

/* Changes of velocities by unit loads over a window of n steps, over the impulses. */
static bool respond(cpl_candidate *c, cpl_verdict *v, const answer *a, double h, long n, double R[K][K]) {
  double none[K], end[K];
  bool good = first_window(c, v, n, 1, -1, 0, none);
  for (int j = 0; good && j < a->k; j++) {
    good = first_window(c, v, n, 1, j, a->size[j], end);
    for (int i = 0; good && i < a->k; i++)
      R[i][j] = (end[i] - none[i]) / (a->size[j] * (double)n * h);
  }
  return good;
}

/* At the start: from windows of one and of two steps, what a window of none would have. */
static bool find_answer(cpl_candidate *c, cpl_verdict *v, answer *a) {
  cpl_meeting m;
  double two[K][K];
  *a = (answer){0};
  if (!cpl_meeting_open(&m, c, v))
    return false;
  a->nbody = m.settings.nbody < BODIES ? m.settings.nbody : BODIES;
  a->k = 6 * a->nbody;
  const double h = m.settings.dt;
  for (int i = 0; i < a->nbody; i++) {
    const tdm_assigned_body *b = &m.session.body[i];
    const tdm_mat3 turn = tdm_quat_to_matrix(b->state.pose.orientation);
    const tdm_mat3 world = tdm_m3_mat(turn, tdm_m3_mat(b->inertia, tdm_m3_transpose(turn)));
    const bool some = isfinite(b->mass) && b->mass > 0;
    const tdm_mat3 inverse = some ? tdm_m3_inverse(world) : (tdm_mat3){0};
    for (int k = 0; k < 6; k++) {
      a->free[6 * i + k] = !some ? 0 : k < 3 ? 1 / b->mass : inverse.m[k - 3][k - 3];
      a->size[6 * i + k] = a->free[6 * i + k] > 0 && isfinite(a->free[6 * i + k]) ? 1 / a->free[6 * i + k] : 1;
    }
  }
  cpl_meeting_drop(&m);
  if (!respond(c, v, a, h, 1, a->R) || !respond(c, v, a, h, 2, two))
    return false;
  for (int i = 0; i < a->k; i++)
    for (int j = 0; j < a->k; j++)
      a->R[i][j] = 2 * a->R[i][j] - two[i][j];
  return true;
}

/* The same, found once. */
static bool ask(cpl_candidate *c, cpl_verdict *v, answer *a) {
  if (c->answer) {
    *a = *(answer *)c->answer;
    return true;
  }
  if (!find_answer(c, v, a))
    return false;
  c->answer = malloc(sizeof *a);
  if (c->answer)
    *(answer *)c->answer = *a;
  return true;
}

/* the body and axis of entry i in words */
static const char *name_of(int i, char *out, size_t size) {
  snprintf(out, size, "the %s %c of body %d", i % 6 < 3 ? "force along" : "moment about", "xyz"[i % 3], i / 6);
  return out;
}

static void test_load(cpl_candidate *c, cpl_verdict *v) {
  answer a;
  char word[64], other[64];
  if (!ask(c, v, &a))
    return;
  double most = 0;
  for (int i = 0; i < a.k; i++) {
    const double share = a.R[i][i] * a.size[i];
    most = fmax(most, share);
    if (share < -rounding)
      cpl_broken(v, "a motion along the load", "%s moves it the other way", name_of(i, word, sizeof word));
    if (a.R[i][i] > (1 + close) * a.free[i] + rounding * a.free[i])
      cpl_broken(v, "at most the motion of the free body (mass and inertia of READY)", "%s moves it %.4g times as far",
                 name_of(i, word, sizeof word), share);
  }
  for (int i = 0; i < a.k; i++)
    for (int j = 0; j < i; j++) {
      const double mean = 1 / sqrt(a.size[i] * a.size[j]);
      if (fabs(a.R[i][j] - a.R[j][i]) > (2 * close * sqrt(fabs(a.R[i][i] * a.R[j][j])) + rounding * mean))
        cpl_broken(v, "what load A does along B as B along A (frames, centre of mass)", "%s and %s: %g against %g",
                   name_of(i, word, sizeof word), name_of(j, other, sizeof other), a.R[i][j], a.R[j][i]);
    }
  if (a.k == 0 || most < rounding)
    cpl_not_seen(v, "no load moves a coupled body of this scene");
}

/* The entry that a load moves most, -1: none. */
static int movable(const answer *a) {
  int best = -1;
  for (int i = 0; i < a->k; i++)
    if (a->R[i][i] * a->size[i] > (best < 0 ? 0.01 : a->R[best][best] * a->size[best]))
      best = i;
  return best;
}

static void test_polynomial(cpl_candidate *c, cpl_verdict *v) {
  answer a;
  double flat[K], slope[K], none[K];
  char word[64];
  if (!ask(c, v, &a))
    return;
  const int i = movable(&a);
  if (i < 0) {
    cpl_not_seen(v, "no load moves a coupled body of this scene");
    return;
  }
  if (!first_window(c, v, 4, 1, -1, 0, none) || !first_window(c, v, 4, 1, i, a.size[i], flat) ||
      !first_window(c, v, 4, 2, i, a.size[i], slope))
    return;
  const double is = slope[i] - none[i], due = flat[i] - none[i];
  if (fabs(is - due) > 3 * close * fabs(due))
    cpl_broken(v, "2 s F to change the velocity as F does, s from 0 to 1", "%s: %g of it",
               name_of(i, word, sizeof word), is / due);
}

/* Two windows under a load: places by velocities, velocities by accelerations, work by ways. */
typedef struct {
  tdm_state start, mid, end;
  double a_mid[6], a_end[6], exchanged;
  double h, force[6];
  bool accelerations, energy;
} flight;

/* With `ramps` the load grows from zero through four windows, of which the last two are told: its values at start and
 * end of each differ, and what is extrapolated from windows before is as it should be. */
static bool fly(cpl_candidate *c, cpl_verdict *v, bool ramps, flight *f, int *body) {
  answer a;
  cpl_meeting m;
  tdm_result r;
  *f = (flight){0};
  if (!ask(c, v, &a))
    return false;
  const int i = movable(&a);
  if (i < 0) {
    cpl_not_seen(v, "no load moves a coupled body of this scene");
    return false;
  }
  if (!cpl_meeting_open(&m, c, v))
    return false;
  const int nwindow = ramps ? 4 : 2;
  tdm_wrench *load = calloc(2 * (size_t)m.settings.nbody, sizeof *load); /* (nbody x 2) */
  f->force[i % 6] = 10 * a.size[i];
  f->start = m.session.body[i / 6].state;
  f->h = m.settings.dt;
  *body = i / 6;
  bool good = load != NULL;
  for (int w = 0; good && w < nwindow; w++) {
    tdm_step step = cpl_meeting_next(&m, 1);
    step.load = load;
    step.nload = 2;
    for (int j = 0; j < 2; j++)
      ((double *)(void *)&load[2 * (i / 6) + j])[i % 6] = f->force[i % 6] * (ramps ? (j ? 0.25 : 0.25 * w) : !j);
    good = cpl_meeting_solve(&m, &step, &r);
    if (!good)
      break;
    *(w < nwindow - 1 ? &f->mid : &f->end) = r.state[*body];
    f->accelerations = r.nacceleration > 0;
    if (f->accelerations)
      memcpy(w < nwindow - 1 ? f->a_mid : f->a_end, r.acceleration + 6 * *body, sizeof f->a_mid);
    f->energy = r.has_energy;
    f->exchanged = r.has_energy ? r.energy->exchanged : 0;
  }
  free(load);
  cpl_meeting_drop(&m);
  return good;
}

static void test_places(cpl_candidate *c, cpl_verdict *v) {
  flight f;
  int body;
  if (!fly(c, v, false, &f, &body))
    return;
  const tdm_vec3 way = tdm_sub(f.end.pose.position, f.mid.pose.position);
  const tdm_vec3 due = tdm_scale(0.5 * f.h, tdm_add(f.mid.twist.velocity, f.end.twist.velocity));
  const tdm_vec3 turn = tdm_quat_turn(f.mid.pose.orientation, f.end.pose.orientation);
  const tdm_vec3 turn_due = tdm_scale(0.5 * f.h, tdm_add(f.mid.twist.angular, f.end.twist.angular));
  if (tdm_norm(tdm_sub(way, due)) > close * tdm_norm(due) + 1e-12 * (1 + tdm_norm(f.mid.pose.position)))
    cpl_broken(v, "positions that move by the velocities (world axes, m/s)",
               "body %d goes (%g, %g, %g) m, its velocities say (%g, %g, %g) m", body, way.x, way.y, way.z, due.x,
               due.y, due.z);
  if (tdm_norm(tdm_sub(turn, turn_due)) > close * tdm_norm(turn_due) + 1e-11)
    cpl_broken(v, "quaternions (w, x, y, z) that turn by the angular velocities (world axes, rad/s)",
               "body %d turns by (%g, %g, %g), its angular velocities say (%g, %g, %g)", body, turn.x, turn.y, turn.z,
               turn_due.x, turn_due.y, turn_due.z);
}

static void test_acceleration(cpl_candidate *c, cpl_verdict *v) {
  flight f;
  int body;
  if (!fly(c, v, true, &f, &body))
    return;
  double before[6], after[6], largest = 0;
  put_twist(before, &f.mid.twist);
  put_twist(after, &f.end.twist);
  for (int k = 0; k < 6; k++)
    largest = fmax(largest, fmax(fabs(f.a_mid[k]), fabs(f.a_end[k])));
  for (int k = 0; k < 6; k++) {
    const double is = (after[k] - before[k]) / f.h, told = 0.5 * (f.a_mid[k] + f.a_end[k]);
    if (fabs(is - told) > 2 * close * largest)
      cpl_broken(v, "accelerations that agree with the velocities", "body %d, %s %c: told %g, velocities say %g", body,
                 k < 3 ? "along" : "about", "xyz"[k % 3], told, is);
  }
}

static void test_work(cpl_candidate *c, cpl_verdict *v) {
  flight f;
  int body;
  if (!fly(c, v, false, &f, &body))
    return;
  const tdm_vec3 way = tdm_sub(f.end.pose.position, f.start.pose.position);
  const tdm_vec3 turn = tdm_quat_turn(f.start.pose.orientation, f.end.pose.orientation);
  const double due = f.force[0] * way.x + f.force[1] * way.y + f.force[2] * way.z + f.force[3] * turn.x +
                     f.force[4] * turn.y + f.force[5] * turn.z;
  if (fabs(f.exchanged - due) > 5 * close * fabs(due))
    cpl_broken(v, "the work of the coupling load as fourth energy: load times way", "%g J, load times way is %g J",
               f.exchanged, due);
}

/* Left to itself it gains no energy but by what supplies it: gravity's is among what is stored. */
static void test_energy(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  tdm_result r;
  double first = NAN, last = NAN, kinetic = 0;
  if (!cpl_meeting_open(&m, c, v))
    return;
  tdm_wrench *load = calloc((size_t)m.settings.nbody + 1, sizeof *load);
  for (int w = 0; load && w < 60; w++) {
    tdm_step step = cpl_meeting_next(&m, 50);
    step.load = load;
    step.nload = 1;
    if (step.t1 > m.settings.time_end * (1 + 1e-9) || !cpl_meeting_solve(&m, &step, &r))
      break;
    if (!r.has_energy || isnan(r.energy->stored))
      continue;
    kinetic = fmax(kinetic, r.energy->kinetic);
    last = r.energy->stored - r.energy->supplied;
    if (isnan(first))
      first = last;
    if (last - first > close * kinetic + 1e-12)
      cpl_broken(v, "stored less supplied energy not to grow without load",
                 "it grows by %g J until %g s, beside %g J of motion", last - first, step.t1, r.energy->kinetic);
  }
  if (isnan(first) || kinetic == 0)
    cpl_not_seen(v, isnan(first) ? "it does not look at its energy in this scene" : "nothing moves in this scene");
  free(load);
  cpl_meeting_drop(&m);
}

static void test_mobility(cpl_candidate *c, cpl_verdict *v) {
  answer a;
  cpl_meeting m;
  char word[64];
  if (!ask(c, v, &a) || !cpl_meeting_open(&m, c, v))
    return;
  const size_t row = 6 * (size_t)m.settings.nbody;
  for (int i = 0; i < a.k; i++)
    for (int j = 0; j < a.k; j++) {
      const double told = m.session.mobility.Y[(size_t)i * row + (size_t)j];
      const double most = sqrt(fabs(a.free[i] * a.free[j]));
      if (fabs(told - a.R[i][j]) > 2 * close * most)
        cpl_broken(v, "the mobility that finite differences give", "entry %d, %d (by %s): %g, told %g", i, j,
                   name_of(j, word, sizeof word), a.R[i][j], told);
    }
  cpl_meeting_drop(&m);
}

const cpl_rule cpl_rules_mbd[] = {{.name = "load",
                                   .section = "5",
                                   .roles = CPL_OF_MBD,
                                   .text = "a known load gives a known motion: sign, size, axes",
                                   .test = test_load},
                                  {.name = "load.polynomial",
                                   .section = "5",
                                   .roles = CPL_OF_MBD,
                                   .text = "coefficients of the load are powers of s",
                                   .test = test_polynomial},
                                  {.name = "states",
                                   .section = "3",
                                   .roles = CPL_OF_MBD,
                                   .text = "poses move by the velocities",
                                   .test = test_places},
                                  {.name = "acceleration",
                                   .section = "6",
                                   .roles = CPL_OF_MBD,
                                   .capability = "acceleration",
                                   .text = "accelerations agree with velocities",
                                   .test = test_acceleration},
                                  {.name = "mobility",
                                   .section = "6",
                                   .roles = CPL_OF_MBD,
                                   .capability = "mobility",
                                   .text = "the mobility agrees with finite differences",
                                   .test = test_mobility},
                                  {.name = "energy",
                                   .section = "7",
                                   .roles = CPL_OF_MBD,
                                   .capability = "energy",
                                   .text = "the coupling load's work is load times way",
                                   .test = test_work},
                                  {.name = "energy.stored",
                                   .section = "7",
                                   .roles = CPL_OF_MBD,
                                   .capability = "energy",
                                   .text = "without load no energy is gained, gravity's counted",
                                   .test = test_energy},
                                  {.name = NULL}};
