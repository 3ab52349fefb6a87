/* The estimate of a run's error (coupler/estimate/error.h): the traces of the coupled bodies, and at the end what
 * comes of them, as `error_estimate` in summary.json. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/estimate/error.h"
#include "coupler/observe/ledger.h"
#include "coupler/observe/observers.h"
#include "coupler/state/mismatch.h"
#include "coupler/state/path.h"
#include "protocol/scene/json.h"
#include "protocol/wire/message.h"

#include <stdlib.h>

static const double large = 0.05; /* beside the spread: an error that the run is to be warned of */

typedef struct {
  const cpl_settings *settings;
  int nbody;
  cpl_trace *trace; /* (nbody) */
  bool *prescribed; /* (nbody) no load moves it */
  double supplied;  /* by drivers, when it was first told [J]; NaN: not yet */
  double exchanged; /* by the loads, as MBD accounts for it, until the last window [J] */
} estimate;

static tdm_status begin(const cpl_observer *self, const cpl_loop *loop, const cpl_outlet *outlet, void **own,
                        tdm_error *err) {
  (void)self, (void)outlet;
  estimate *e = *own = calloc(1, sizeof *e);
  if (!e)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  e->settings = loop->settings;
  e->supplied = NAN;
  e->trace = calloc((size_t)loop->nbody + 1, sizeof *e->trace);
  e->prescribed = calloc((size_t)loop->nbody + 1, sizeof *e->prescribed);
  if (!e->trace || !e->prescribed)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i < loop->nbody; i++) {
    const tdm_assigned_body *body = &loop->session->body[i];
    if (!cpl_trace_init(&e->trace[i], body->mass, &body->inertia, &loop->state_start[i]))
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    e->prescribed[i] = loop->prescribed[i];
    e->nbody++;
  }
  return TDM_OK;
}

/* Where DEM's body ended by what it knew of the window: beside its proxy by the correction, if there is one. */
static tdm_state other_end(const cpl_loop *loop, int i) {
  tdm_state end = loop->dem_end[i];
  if (loop->correction) {
    const double *c = loop->correction + CPL_APART * i;
    end.pose.position = tdm_add(end.pose.position, tdm_v3(c[0], c[1], c[2]));
    end.pose.orientation = tdm_quat_turned(end.pose.orientation, tdm_v3(c[3], c[4], c[5]));
    end.twist.velocity = tdm_add(end.twist.velocity, tdm_v3(c[6], c[7], c[8]));
    end.twist.angular = tdm_add(end.twist.angular, tdm_v3(c[9], c[10], c[11]));
  }
  return end;
}

/* What drivers have given or taken since it was first told [J]; 0 where it is not. */
static double driven(estimate *e, const tdm_energy *energy) {
  if (!energy || isnan(energy->supplied))
    return 0;
  if (isnan(e->supplied))
    e->supplied = energy->supplied;
  return fabs(energy->supplied - e->supplied);
}

/* What the exchange has made of energy at a body in the window. MBD's own account is exact where it is of one body. */
static double made(estimate *e, const cpl_loop *loop, const tdm_nodes *through, int i) {
  const tdm_result *mbd = &loop->result[CPL_MBD], *dem = &loop->result[CPL_DEM];
  const double blending = dem->ninterface > 0 ? dem->body[i].blending : 0;
  double felt = cpl_work_on_mbd(loop, through, i);
  if (mbd->has_energy && loop->nbody == 1) {
    felt = mbd->energy->exchanged - e->exchanged;
    e->exchanged = mbd->energy->exchanged;
  }
  return felt - cpl_work_on_dem(loop, i) - blending;
}

static tdm_status window(void *own, const cpl_loop *loop, tdm_error *err) {
  (void)err;
  estimate *e = own;
  const double by_drivers = driven(e, loop->result[CPL_MBD].energy);
  const tdm_nodes through = cpl_path_through(loop, loop->state_start, loop->state_end);
  const tdm_result *dem = &loop->result[CPL_DEM];
  for (int i = 0; i < e->nbody; i++) {
    const bool apart = loop->scheme->mismatch_order > 0;
    const tdm_state other = apart ? other_end(loop, i) : (tdm_state){0};
    cpl_trace_window w = {.t0 = loop->t0,
                          .t1 = loop->t1,
                          .start = &loop->state_start[i],
                          .end = &loop->state_end[i],
                          .found = dem->ninterface > 0 ? dem->body[i].moment[0] : loop->mean[i],
                          .made = made(e, loop, &through, i),
                          .other_end = apart ? &other : NULL,
                          .nsample = loop->nsample,
                          .sample_time = loop->sample_time,
                          .sample = loop->result[CPL_MBD].sample_state + i,
                          .sample_load = dem->sample_load + i,
                          .stride = loop->nbody,
                          .nload = loop->nload,
                          .load = &loop->load[i * TDM_LOAD_MAX]};
    for (int j = 0; j < loop->nload; j++) {
      const tdm_wrench *c = &loop->load[i * TDM_LOAD_MAX + j];
      w.given.force = tdm_axpy(1. / (j + 1), c->force, w.given.force);
      w.given.moment = tdm_axpy(1. / (j + 1), c->moment, w.given.moment);
    }
    cpl_trace_add(&e->trace[i], &w);
    e->trace[i].driven = fmax(e->trace[i].driven, by_drivers);
  }
  return TDM_OK;
}

static json_t *quantity(const cpl_error_of *of) {
  return json_pack("{s:o, s:o, s:o, s:o, s:o, s:o}", "rms", tdm_number_to_json(of->rms), "share",
                   tdm_number_to_json(of->share), "coupling", tdm_number_to_json(of->coupling), "rattle",
                   tdm_number_to_json(of->rattle), "fill", tdm_number_to_json(of->fill), "spread",
                   tdm_number_to_json(of->spread));
}

/* Errors of the bodies that loads can move, into error (nbody). False: no memory. */
static bool estimate_all(const estimate *e, cpl_error *error) {
  cpl_trace *moved = calloc((size_t)e->nbody + 1, sizeof *moved); /* their rows are those of e->trace */
  cpl_error *found = calloc((size_t)e->nbody + 1, sizeof *found);
  int n = 0;
  for (int i = 0; moved && i < e->nbody; i++)
    if (!e->prescribed[i])
      moved[n++] = e->trace[i];
  const bool done = moved && found && cpl_error_estimate(n, moved, found);
  for (int i = 0, at = 0; done && i < e->nbody; i++)
    if (!e->prescribed[i])
      error[i] = found[at++];
  free(moved);
  free(found);
  return done;
}

static void enter(const void *own, json_t *summary) {
  const estimate *e = own;
  cpl_error *error = e ? calloc((size_t)e->nbody + 1, sizeof *error) : NULL;
  if (!error || !estimate_all(e, error)) {
    free(error);
    return;
  }
  json_t *bodies = json_object();
  double worst = NAN, coupling = NAN;
  int at = -1;
  for (int i = 0; i < e->nbody; i++) {
    json_t *body = json_object();
    if (e->prescribed[i]) {
      json_object_set_new(body, "prescribed", json_true());
      json_object_set_new(bodies, e->settings->body[i].name[CPL_MBD], body);
      continue;
    }
    for (int q = 0; q < CPL_QUANTITIES; q++)
      json_object_set_new(body, cpl_quantity_names[q], quantity(&error[i].of[q]));
    for (int q = 0; q < CPL_QUANTITIES; q++)
      if (error[i].of[q].share > worst || (isnan(worst) && !isnan(error[i].of[q].share))) {
        worst = error[i].of[q].share;
        at = i;
      }
    for (int q = 0; q < CPL_QUANTITIES; q++)
      if (!isnan(error[i].of[q].share))
        coupling = fmax(coupling, error[i].of[q].coupling / error[i].of[q].spread);
    json_object_set_new(body, "added_mass_kg", tdm_numbers_to_json(error[i].added, 3));
    json_object_set_new(bodies, e->settings->body[i].name[CPL_MBD], body);
  }
  json_object_set_new(summary, "error_estimate",
                      json_pack("{s:o, s:b, s:o, s:s?, s:s?, s:o}", "worst", tdm_number_to_json(worst), "large",
                                worst > large, "worst_coupling", tdm_number_to_json(coupling), "worst_body",
                                at < 0 ? NULL : e->settings->body[at].name[CPL_MBD], "unknown",
                                at < 0 ? "too few windows, or no body that loads could move" : NULL, "bodies", bodies));
  free(error);
}

static void let_go(void *own) {
  estimate *e = own;
  for (int i = 0; e && i < e->nbody; i++)
    cpl_trace_free(&e->trace[i]);
  if (e) {
    free(e->trace);
    free(e->prescribed);
  }
  free(e);
}

const cpl_observer cpl_observer_estimate = {
    .name = "estimate",
    .open = begin,
    .window = window,
    .enter = enter,
    .free = let_go,
};
