/* The ledger: see ledger.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/observe/ledger.h"

#include "coupler/observe/histories.h"
#include "coupler/observe/momentum.h"
#include "coupler/observe/observers.h"
#include "coupler/state/path.h"
#include "protocol/scene/json.h"
#include "protocol/scene/remark.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
  LOOKS = 3, /* in a row before the guard speaks; one is enough at the end of the run */
  BODY_COLUMNS = 12,
  ENERGY_COLUMNS = 2
};
static const double round_off = 1e-9; /* of the sums that the balance is made of */

/* So many times the guard's share is allowed to what the exchange makes, which adds up over the run, while the balance
 * only has what dissipation leaves of it; and to a balance that rises by itself: DEM has a guard of its own, and what
 * is stored in tangential springs is not counted. */
static const double lenience = 5;

/* share of what the guard allows that is too little to call a run inexact */
static const double trifle = 0.1;

/* columns of a body, behind its name */
static const char *const body_columns[BODY_COLUMNS] = {"impulse.x [N s]",
                                                       "impulse.y [N s]",
                                                       "impulse.z [N s]",
                                                       "angular_impulse.x [N m s]",
                                                       "angular_impulse.y [N m s]",
                                                       "angular_impulse.z [N m s]",
                                                       "work.dem [J]",
                                                       "work.mbd [J]",
                                                       "residual [J]",
                                                       "blending [J]",
                                                       "drift [m]",
                                                       "drift_angle [rad]"};

/* Sums since the start, of one body. */
typedef struct {
  tdm_wrench impulse;               /* [N s], [N m s] */
  double work[CPL_NROLE], blending; /* [J] */
  double drift, angle;              /* largest since the row before [m], [rad] */
  double most_drift, most_angle;    /* largest of the run */
  cpl_momentum momentum;            /* of the loads that MBD was given */
} ledger_body;

typedef struct {
  const cpl_settings *settings;
  const tdm_assigned_body *of; /* (nbody) as MBD told them, borrowed */
  cpl_histories histories;
  FILE *file; /* ledger.csv */
  int nbody;
  ledger_body *body; /* (nbody) */
  double *row;       /* of the file */
  bool has_energy[CPL_NROLE];
  tdm_energy energy[CPL_NROLE]; /* as last looked at */
  uint64_t looks;               /* at both */
  double size;                  /* of the sums of the last one, for round-off [J] */
  double start, balance;        /* G at the first look, and its growth since [J] */
  double lowest;                /* G so far [J] */
  double own[CPL_NROLE];        /* lowest so far of stored - supplied - work of the coupling load, of each solver [J] */
  double rest;                  /* of both: less energy than that is no motion to judge by [J] */
  double kinetic;               /* largest of both so far [J] */
  double potential[2];          /* least and greatest of what is stored otherwise [J] */
  double rise;                  /* largest of G over its lowest [J] */
  double exchange;              /* energy that the exchange has made [J] */
  double drivers;               /* residuals - blending of the bodies whose motion is prescribed [J] */
  double exchange_lowest;       /* [J] */
  double exchange_rise;         /* largest over its lowest [J] */
  double residual;              /* largest magnitude of the exchange so far [J] */
  double worked;                /* sum over windows and bodies of |work on DEM's side|, but for prescribed bodies [J] */
  int rises;                    /* looks in a row with more than the guard allows */
  double gained_at;             /* when the guard first would have spoken [s]; NaN: never */
} ledger;

/* ---- one body ---- */

/* coefficients in s of the parabola with the values v0, v1 at the ends and a mean */
static void parabola(tdm_vec3 v0, tdm_vec3 v1, tdm_vec3 mean, tdm_vec3 *out) {
  out[0] = v0;
  out[1] = tdm_sub(tdm_scale(6, mean), tdm_add(tdm_scale(4, v0), tdm_scale(2, v1)));
  out[2] = tdm_sub(tdm_scale(3, tdm_add(v0, v1)), tdm_scale(6, mean));
}

double cpl_work_along(const tdm_state *start, const tdm_state *end, double duration, const tdm_wrench *load,
                      int nload) {
  tdm_vec3 velocity[3], angular[3];
  tdm_vec3 way = tdm_sub(end->pose.position, start->pose.position);
  tdm_vec3 turn = tdm_quat_turn(start->pose.orientation, end->pose.orientation);
  parabola(start->twist.velocity, end->twist.velocity, tdm_scale(1 / duration, way), velocity);
  parabola(start->twist.angular, end->twist.angular, tdm_scale(1 / duration, turn), angular);
  double work = 0;
  for (int j = 0; j < nload; j++)
    for (int k = 0; k < 3; k++)
      work += (tdm_dot(load[j].force, velocity[k]) + tdm_dot(load[j].moment, angular[k])) / (j + k + 1);
  return duration * work;
}

/* Gauss's points and weights on [0, 1] */
static const double gauss_at[] = {0.06943184420297371, 0.33000947820757187, 0.6699905217924281, 0.9305681557970263};
static const double gauss_weight[] = {0.17392742256872692, 0.32607257743127308, 0.32607257743127308,
                                      0.17392742256872692};

double cpl_work_through(const tdm_nodes *path, int body, const tdm_state *start, double t0, const tdm_wrench *load,
                        int nload) {
  const double duration = path->time[path->nnode - 1] - t0;
  double work = 0, from = t0;
  for (int k = 0; k < path->nnode; from = path->time[k++])
    for (int g = 0; g < 4; g++) {
      const double t = from + gauss_at[g] * (path->time[k] - from), s = (t - t0) / duration;
      const tdm_twist twist = tdm_nodes_at(path, body, start, t0, t).twist;
      double power = 0; /* Horner */
      for (int j = nload - 1; j >= 0; j--)
        power = s * power + tdm_dot(load[j].force, twist.velocity) + tdm_dot(load[j].moment, twist.angular);
      work += gauss_weight[g] * (path->time[k] - from) * power;
    }
  return work;
}

static void add_impulse(ledger_body *b, double h, const tdm_wrench *mean) {
  b->impulse.force = tdm_axpy(h, mean->force, b->impulse.force);
  b->impulse.moment = tdm_axpy(h, mean->moment, b->impulse.moment);
}

/* DEM's side without its own word: the mean load along the path that was asked for */
static double work_of_mean(const tdm_wrench *mean, const tdm_state *start, const tdm_state *end) {
  tdm_vec3 way = tdm_sub(end->pose.position, start->pose.position);
  tdm_vec3 turn = tdm_quat_turn(start->pose.orientation, end->pose.orientation);
  return tdm_dot(mean->force, way) + tdm_dot(mean->moment, turn);
}

double cpl_work_on_dem(const cpl_loop *loop, int i) {
  const tdm_result *dem = &loop->result[CPL_DEM];
  return dem->ninterface > 0 ? dem->body[i].work
                             : work_of_mean(&loop->mean[i], &loop->sent_start[i], &loop->sent_end[i]);
}

double cpl_work_on_mbd(const cpl_loop *loop, const tdm_nodes *through, int i) {
  const tdm_wrench *load = &loop->load[i * TDM_LOAD_MAX];
  return through->nnode > 0
             ? cpl_work_through(through, i, &loop->state_start[i], loop->t0, load, loop->nload)
             : cpl_work_along(&loop->state_start[i], &loop->state_end[i], loop->t1 - loop->t0, load, loop->nload);
}

/* through: MBD's path, with nodes if any were told. Returns the work on DEM's side. */
static double enter_body(ledger_body *b, const cpl_loop *loop, const tdm_nodes *through, int i) {
  const tdm_result *dem = &loop->result[CPL_DEM];
  const tdm_interface *own = dem->ninterface > 0 ? &dem->body[i] : NULL;
  const tdm_state *there = own ? &own->end : &loop->sent_end[i], *here = &loop->state_end[i];
  const double h = loop->t1 - loop->t0;
  add_impulse(b, h, own ? &own->moment[0] : &loop->mean[i]);
  const double work = cpl_work_on_dem(loop, i);
  b->work[CPL_DEM] += work;
  b->blending += own ? own->blending : 0;
  b->work[CPL_MBD] += cpl_work_on_mbd(loop, through, i);
  tdm_vec3 way = tdm_sub(here->pose.position, there->pose.position);
  tdm_vec3 turn = tdm_quat_turn(there->pose.orientation, here->pose.orientation);
  if (loop->correction) { /* DEM's body ended beside its proxy by that */
    const double *c = loop->correction + 12 * i;
    way = tdm_sub(way, tdm_v3(c[0], c[1], c[2]));
    turn = tdm_sub(turn, tdm_v3(c[3], c[4], c[5]));
  }
  double drift = tdm_norm(way), angle = tdm_norm(turn);
  b->drift = fmax(b->drift, drift);
  b->angle = fmax(b->angle, angle);
  b->most_drift = fmax(b->most_drift, drift);
  b->most_angle = fmax(b->most_angle, angle);
  return work;
}

static double residual_of(const ledger_body *b) {
  return b->work[CPL_MBD] - b->work[CPL_DEM];
}

/* All bodies: what the exchange has made. MBD's own account is exact; the closed form for a body takes its velocity in
 * the window for a parabola. */
static void enter_exchange(ledger *l, const cpl_loop *loop) {
  const tdm_result *mbd = &loop->result[CPL_MBD];
  double given = 0, felt = 0;
  l->drivers = 0;
  if (mbd->has_energy && l->nbody == 1)
    l->body[0].work[CPL_MBD] = mbd->energy->exchanged;
  for (int i = 0; i < l->nbody; i++) {
    given += l->body[i].work[CPL_DEM] + l->body[i].blending;
    felt += l->body[i].work[CPL_MBD];
    if (loop->prescribed[i])
      l->drivers += residual_of(&l->body[i]) - l->body[i].blending;
  }
  l->exchange = (mbd->has_energy ? mbd->energy->exchanged : felt) - given - l->drivers;
  l->exchange_lowest = fmin(l->exchange_lowest, l->exchange);
  l->exchange_rise = fmax(l->exchange_rise, l->exchange - l->exchange_lowest);
  l->residual = fmax(l->residual, fabs(l->exchange));
}

/* ---- energy ---- */

/* The largest energy so far, without the zero of the potentials, and not less than what all has at rest [J]. */
static double largest_energy(const ledger *l) {
  return l->looks > 0 ? fmax(l->kinetic + l->potential[1] - l->potential[0], l->rest) : NAN;
}

/* What a solver has and was not given, by whatever went through the interface too [J]: only its own errors raise it. */
static double own_balance(const ledger *l, int role) {
  double work = 0;
  for (int i = 0; i < l->nbody; i++)
    work += role == CPL_MBD ? l->body[i].work[CPL_MBD] : -l->body[i].work[CPL_DEM];
  return l->energy[role].stored - l->energy[role].supplied - work;
}

/* Has the exchange made most of this rise of the balance? */
static bool through_exchange(const ledger *l, double rise) {
  return l->exchange_rise >= 0.5 * rise;
}

/* Both solvers were looked at: the balance, and by how much it has risen. True: by more than the guard allows. */
static bool look(ledger *l) {
  double stored = 0, kinetic = 0, supplied = 0;
  l->size = 0;
  for (int r = 0; r < CPL_NROLE; r++) {
    stored += l->energy[r].stored;
    kinetic += l->energy[r].kinetic;
    supplied += l->energy[r].supplied;
    l->size += fabs(l->energy[r].stored) + fabs(l->energy[r].supplied);
  }
  double now = stored - supplied - l->drivers;
  for (int r = 0; r < CPL_NROLE; r++)
    l->own[r] = l->looks > 0 ? fmin(l->own[r], own_balance(l, r)) : own_balance(l, r);
  if (l->looks++ == 0)
    l->start = l->lowest = now;
  l->balance = now - l->start;
  l->lowest = fmin(l->lowest, now);
  l->kinetic = fmax(l->kinetic, kinetic);
  l->potential[0] = fmin(l->potential[0], stored - kinetic);
  l->potential[1] = fmax(l->potential[1], stored - kinetic);
  double rise = now - l->lowest;
  if (!(rise > round_off * l->size))
    rise = 0;
  l->rise = fmax(l->rise, rise);
  double allowed = l->settings->guard.energy * largest_energy(l) + round_off * l->size;
  double made = l->exchange - l->exchange_lowest;
  return made > lenience * allowed || rise > (through_exchange(l, rise) ? allowed : lenience * allowed);
}

/* ---- the file ---- */

static void write_row(ledger *l, double time) {
  double *at = l->row;
  for (int i = 0; i < l->nbody; i++) {
    ledger_body *b = &l->body[i];
    memcpy(at, &b->impulse, sizeof b->impulse);
    at += TDM_WRENCH_DOUBLES;
    *at++ = b->work[CPL_DEM];
    *at++ = b->work[CPL_MBD];
    *at++ = residual_of(b);
    *at++ = b->blending;
    *at++ = b->drift;
    *at++ = b->angle;
    b->drift = b->angle = 0;
  }
  for (int r = 0; r < CPL_NROLE; r++)
    if (l->has_energy[r])
      *at++ = l->energy[r].stored;
  for (int r = 0; r < CPL_NROLE; r++)
    if (l->has_energy[r])
      *at++ = l->energy[r].supplied;
  *at++ = l->exchange;
  if (l->has_energy[CPL_MBD] && l->has_energy[CPL_DEM])
    *at++ = l->looks > 0 ? l->balance : NAN;
  tdm_write_row(l->file, time, l->row, (int)(at - l->row));
}

static void write_header(const ledger *l) {
  static const char *const energy[ENERGY_COLUMNS] = {"energy", "supplied"};
  fputs("time [s]", l->file);
  for (int i = 0; i < l->nbody; i++)
    for (int c = 0; c < BODY_COLUMNS; c++)
      fprintf(l->file, ",%s.%s", l->settings->body[i].name[CPL_MBD], body_columns[c]);
  for (int c = 0; c < ENERGY_COLUMNS; c++)
    for (int r = 0; r < CPL_NROLE; r++)
      if (l->has_energy[r])
        fprintf(l->file, ",%s.%s [J]", energy[c], cpl_role_names[r]);
  fputs(",exchange [J]", l->file);
  if (l->has_energy[CPL_MBD] && l->has_energy[CPL_DEM])
    fputs(",balance [J]", l->file);
  fputc('\n', l->file);
}

/* Opens the books: the header and the row of t = 0. */
static tdm_status begin(const cpl_observer *self, const cpl_loop *loop, const cpl_outlet *outlet, void **own,
                        tdm_error *err) {
  (void)self;
  const cpl_session *session = loop->session;
  const size_t nbody = (size_t)loop->nbody;
  ledger *l = *own = calloc(1, sizeof *l);
  if (!l)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  *l = (ledger){.settings = loop->settings,
                .of = session->body,
                .gained_at = NAN,
                .potential = {INFINITY, -INFINITY},
                .histories.results = outlet->results};
  l->body = calloc(nbody + 1, sizeof *l->body);
  l->row = calloc(BODY_COLUMNS * nbody + CPL_NROLE * ENERGY_COLUMNS + 2, sizeof *l->row);
  if (!l->body || !l->row)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  l->file = cpl_histories_open(&l->histories, "ledger.csv", err);
  if (!l->file)
    return err->status;
  l->nbody = loop->nbody;
  for (int r = 0; r < CPL_NROLE; r++) {
    l->has_energy[r] = cpl_session_asks(session, (cpl_role)r, "energy");
    l->energy[r] = session->partner[r].energy;
    l->rest += session->partner[r].rest;
  }
  if (!isnan(l->energy[CPL_MBD].stored + l->energy[CPL_DEM].stored))
    look(l);
  write_header(l);
  write_row(l, 0);
  return TDM_OK;
}

/* ---- the guard ---- */

/* the body through which most energy came */
static int worst_body(const ledger *l) {
  int worst = 0;
  for (int i = 1; i < l->nbody; i++)
    if (residual_of(&l->body[i]) > residual_of(&l->body[worst]))
      worst = i;
  return worst;
}

enum { BETTER = 96 };

/* ", NAME as coupling.scheme": a better one, if there is; in `text` (BETTER bytes) */
static const char *better_scheme(const cpl_loop *loop, char *text) {
  text[0] = 0;
  if (loop->scheme->better)
    snprintf(text, BETTER, ", \"%s\" as coupling.scheme", loop->scheme->better);
  return text;
}

/* where the energy came from, and what helps; returns the place in the scene to look at */
static const char *find_cause(const ledger *l, const cpl_loop *loop, char *text, size_t size) {
  const double rise = l->start + l->balance - l->lowest;
  char better[BETTER];
  if (!through_exchange(l, rise)) {
    double made[CPL_NROLE];
    for (int r = 0; r < CPL_NROLE; r++)
      made[r] = own_balance(l, r) - l->own[r];
    const bool dem = made[CPL_DEM] >= made[CPL_MBD];
    snprintf(text, size, "it did not come through the exchange (%.3g J) but from %s (%.3g J): %s", l->exchange_rise,
             dem ? "the particles and their contacts" : "the bodies, their joints and forces",
             made[dem ? CPL_DEM : CPL_MBD],
             dem ? "take a smaller time.dt, or look at the warnings of dem"
                 : "take tighter tolerances or smaller steps in mbd.solver, or look at the warnings of mbd");
    return dem ? "dem" : "mbd";
  }
  int worst = worst_body(l);
  snprintf(text, size,
           "the exchange made it, most at body \"%.200s\": take a smaller coupling.n%s, or a smaller time.dt",
           l->settings->body[worst].name[CPL_MBD], better_scheme(loop, better));
  return "coupling.n";
}

static tdm_status tell(ledger *l, const cpl_loop *loop, tdm_error *err) {
  char text[TDM_MESSAGE_MAX], cause[512];
  const cpl_settings *s = l->settings;
  const double rise = l->start + l->balance - l->lowest, made = l->exchange - l->exchange_lowest;
  const char *path = find_cause(l, loop, cause, sizeof cause);
  snprintf(text, sizeof text,
           "energy without a source: that of bodies and particles rose by %.3g J, and the exchange made %.3g J; "
           "coupling.guard.energy = %g of the %.3g J there were allows %.3g and %.3g J, in the window %llu that ends "
           "at %.9g s; %s (\"coupling.guard.action\": \"warn\" goes on)",
           rise, made, s->guard.energy, largest_energy(l), s->guard.energy * largest_energy(l),
           lenience * s->guard.energy * largest_energy(l), (unsigned long long)loop->window, loop->t1, cause);
  if (s->guard.action == CPL_GUARD_STOP)
    return tdm_fail(err, TDM_ERR_NUMERIC, path, "%s", text);
  tdm_remark(TDM_WARNING, "guard", path, loop->t1, "%s", text);
  return TDM_OK;
}

static tdm_status judge(ledger *l, const cpl_loop *loop, tdm_error *err) {
  bool both = true;
  for (int r = 0; r < CPL_NROLE; r++) {
    const tdm_energy *e = l->has_energy[r] ? loop->result[r].energy : NULL;
    bool seen = e && !isnan(e->stored);
    if (seen)
      l->energy[r] = *e;
    both = both && seen;
  }
  if (!both)
    return TDM_OK;
  l->rises = look(l) ? l->rises + 1 : 0;
  if (l->rises < (cpl_loop_done(loop) ? 1 : LOOKS))
    return TDM_OK;
  if (isnan(l->gained_at))
    l->gained_at = loop->t1;
  return l->settings->guard.action != CPL_GUARD_OFF ? tell(l, loop, err) : TDM_OK;
}

/* ---- a window ---- */

static tdm_status window(void *own, const cpl_loop *loop, tdm_error *err) {
  ledger *l = own;
  const double end = loop->t1 - 1e-6 * l->settings->dt; /* times are multiples of two steps, which round apart */
  int k = 0;
  for (; k < loop->nsample && loop->sample_time[k] < end; k++)
    write_row(l, loop->row_time[k]);
  const tdm_nodes through = cpl_path_through(loop, loop->state_start, loop->state_end);
  for (int i = 0; i < l->nbody; i++) {
    const double work = enter_body(&l->body[i], loop, &through, i);
    l->worked += loop->prescribed[i] ? 0 : fabs(work);
    cpl_momentum_window(&l->body[i].momentum, loop, i);
  }
  enter_exchange(l, loop);
  judge(l, loop, err);
  for (; k < loop->nsample; k++)
    write_row(l, loop->row_time[k]);
  if (loop->nsample > 0)
    cpl_histories_written(&l->histories, err);
  return err->status;
}

/* ---- the final figures ---- */

/* What the exchange has made is more than coupling.guard.residual of the work that went through it (*share), and no
 * trifle: more than a tenth of the energy that the guard allows. False where a solver does not tell its energy. */
static bool inexact_run(const ledger *l, double *share) {
  const double most = largest_energy(l);
  *share = l->worked > 0 ? l->residual / l->worked : 0;
  return most > round_off * l->size && l->residual > trifle * l->settings->guard.energy * most &&
         *share > l->settings->guard.residual;
}

/* The run has come to its end: tell if it was inexact. */
static void done(void *own, const cpl_loop *loop) {
  const ledger *l = own;
  char better[BETTER];
  double share;
  for (int i = 0; i < l->nbody; i++)
    cpl_momentum_end(&l->body[i].momentum, loop, i);
  if (inexact_run(l, &share))
    tdm_remark(TDM_WARNING, "inexact", "coupling.n", loop->t1,
               "inexact: the works of the coupling loads on both sides differ by up to %.2g of all that went through "
               "the interface (coupling.guard.residual allows %g); velocities may be off by percents; take a smaller "
               "coupling.n%s",
               share, l->settings->guard.residual, better_scheme(loop, better));
}

static json_t *figures(const ledger *l) {
  json_t *bodies = json_object();
  for (int i = 0; i < l->nbody; i++) {
    const ledger_body *b = &l->body[i];
    json_object_set_new(
        bodies, l->settings->body[i].name[CPL_MBD],
        json_pack("{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "impulse_Ns",
                  tdm_numbers_to_json(&b->impulse.force.x, 3), "angular_impulse_Nms",
                  tdm_numbers_to_json(&b->impulse.moment.x, 3), "work_dem_J", tdm_number_to_json(b->work[CPL_DEM]),
                  "work_mbd_J", tdm_number_to_json(b->work[CPL_MBD]), "residual_J", tdm_number_to_json(residual_of(b)),
                  "blending_J", tdm_number_to_json(b->blending), "largest_drift_m", tdm_number_to_json(b->most_drift),
                  "largest_drift_rad", tdm_number_to_json(b->most_angle), "impulse_on_mbd_Ns",
                  tdm_numbers_to_json(&b->momentum.given.x, 3), "momentum_off",
                  tdm_number_to_json(cpl_momentum_share(&b->momentum, &l->of[i]))));
  }
  double share, most = largest_energy(l);
  const bool inexact = inexact_run(l, &share);
  double scale = most > round_off * l->size ? most : NAN; /* else all of it is round-off */
  double allowed = l->settings->guard.energy * scale;
  bool gained = !isnan(l->gained_at) || l->exchange_rise > lenience * allowed ||
                l->rise > (through_exchange(l, l->rise) ? allowed : lenience * allowed);
  return json_pack("{s:b, s:b, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "gained", (int)gained, "inexact",
                   (int)inexact, "residual_share", tdm_number_to_json(share), "energy_residual",
                   tdm_number_to_json(l->residual / scale), "energy_rise", tdm_number_to_json(l->rise / scale),
                   "exchange_rise", tdm_number_to_json(l->exchange_rise / scale), "largest_energy_J",
                   tdm_number_to_json(most), "exchange_J", tdm_number_to_json(l->exchange), "balance_J",
                   l->looks > 0 ? tdm_number_to_json(l->balance) : json_null(), "gained_at_s",
                   tdm_number_to_json(l->gained_at), "bodies", bodies);
}

static void enter(const void *own, json_t *summary) {
  const ledger *l = own;
  if (l && l->file)
    json_object_set_new(summary, "ledger", figures(l));
}

static tdm_status end(void *own, tdm_error *err) {
  ledger *l = own;
  return l ? cpl_histories_close(&l->histories, err) : TDM_OK;
}

static void let_go(void *own) {
  ledger *l = own;
  if (l) {
    free(l->body);
    free(l->row);
  }
  free(l);
}

const cpl_observer cpl_observer_ledger = {
    .name = "ledger",
    .open = begin,
    .window = window,
    .done = done,
    .close = end,
    .enter = enter,
    .free = let_go,
};
