/* What partners send is looked at when it comes, so that what goes wrong with it later is not laid at another's door.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/session/session.h"

#include <math.h>
#include <stdio.h>

/* ---- single things ---- */

/* Why a state is none, for a sentence "... that ..."; NULL: it is good. */
static const char *bad_numbers(const double *x, int n) {
  return !tdm_finite(x, n) ? "is not finite" : !tdm_usable(x, n) ? "is too large to be squared" : NULL;
}

static const char *bad_state(const tdm_state *state) {
  const char *why = bad_numbers((const double *)(const void *)state, TDM_STATE_DOUBLES);
  return why ? why : tdm_quat_is_unit(state->pose.orientation) ? NULL : "has a quaternion that is not of norm 1";
}

/* Why a matrix Y (k x k) is no mobility: loads would get work from it whatever they do. Rounding against the largest
 * entry is allowed, as heavy and light bodies stand in it side by side. */
static const char *bad_mobility(const double *Y, size_t k) {
  double largest = 0;
  for (size_t i = 0; i < k * k; i++)
    largest = fmax(largest, fabs(Y[i]));
  const double rounding = 1e-9 * largest;
  for (size_t i = 0; i < k; i++) {
    if (Y[i * k + i] < -rounding)
      return "has a negative number on its diagonal";
    for (size_t j = 0; j < i; j++) {
      const double a = Y[i * k + j], b = Y[j * k + i];
      const double mean = sqrt(fmax(0, Y[i * k + i]) * fmax(0, Y[j * k + j]));
      if (fabs(a - b) > 1e-6 * mean + rounding)
        return "is not symmetric";
      if (fabs(a) > (1 + 1e-6) * mean + rounding)
        return "is not positive";
    }
  }
  return NULL;
}

/* ---- READY ---- */

static tdm_status bad_ready(const char *what, const char *body, const char *why, tdm_error *err) {
  return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed READY: %s%s%s%s %s", what, body ? " of body \"" : "",
                  body ? body : "", body ? "\"" : "", why);
}

static tdm_status check_bodies(const cpl_session *s, tdm_error *err) {
  const size_t k = 6 * (size_t)s->settings->nbody;
  const char *why = NULL;
  for (int i = 0; i < s->settings->nbody && !err->status; i++) {
    const tdm_assigned_body *b = &s->body[i];
    const char *name = s->settings->body[i].name[CPL_MBD];
    if ((why = bad_state(&b->state)) != NULL)
      bad_ready("the state", name, why, err);
    else if (isfinite(b->mass) && !tdm_usable(&b->mass, 1))
      bad_ready("the mass", name, "is too large to be squared", err);
    else if (isfinite(b->mass) && !tdm_is_inertia(&b->inertia))
      bad_ready("the inertia", name, "is not symmetric, or negative about some axis", err);
    else if (s->acceleration && (why = bad_numbers(s->acceleration + 6 * i, 6)) != NULL)
      bad_ready("the acceleration", name, why, err);
  }
  if (!s->mobility.Y || err->status)
    return err->status;
  why = bad_numbers(s->mobility.Y, (int)tdm_mobility_doubles(&s->mobility)); /* Y is the first in its block */
  why = why ? why : bad_mobility(s->mobility.Y, k);
  return why ? bad_ready("the mobility", NULL, why, err) : err->status;
}

tdm_status cpl_session_check_ready(const cpl_session *s, cpl_role role, tdm_error *err) {
  const cpl_partner *p = &s->partner[role];
  const char *why = NULL;
  if (role == CPL_MBD)
    check_bodies(s, err);
  for (int i = 0; i < s->path.nnode * s->path.nbody && role == CPL_MBD && !err->status; i++)
    if ((why = bad_state(&s->path.state[i])) != NULL)
      bad_ready("a state of the path", NULL, why, err);
  for (int i = 0; i < s->settings->nbody && role == CPL_DEM && !err->status; i++)
    if ((why = bad_numbers((const double *)(const void *)&s->load[i], TDM_WRENCH_DOUBLES)) != NULL)
      bad_ready("the load", s->settings->body[i].name[CPL_DEM], why, err);
  for (int c = 0; c < p->nchannel && !err->status; c++) /* NaN: not known at the start */
    if (!isnan(p->initial[c]) && (why = bad_numbers(&p->initial[c], 1)) != NULL)
      tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed READY: channel \"%s\" begins with %g, which %s",
               p->channel[c].name, p->initial[c], why);
  return err->status;
}

/* ---- RESULT ---- */

/* The nodes of a path: only where they were asked for, behind t1 and not beyond the time asked for. */
static tdm_status check_path(const tdm_step *step, const tdm_result *r, tdm_error *err) {
  const double slack = 1e-9 * (step->ahead - step->t1);
  double before = step->t1;
  for (int k = 0; k < r->path.nnode; before = r->path.time[k++])
    if (!(step->ahead > 0 && r->path.time[k] > before && r->path.time[k] <= step->ahead + slack))
      return tdm_fail(err, TDM_ERR_PROTOCOL, NULL,
                      "malformed RESULT: a path with a node at %g s, asked for from %g s to %g s", r->path.time[k],
                      step->t1, step->ahead);
  return TDM_OK;
}

static tdm_status bad_result(const tdm_step *step, const char *what, const char *body, const char *why,
                             tdm_error *err) {
  return tdm_fail(err, TDM_ERR_NUMERIC, NULL,
                  "returned %s%s%s%s that %s, in the window from %g s to %g s: the coupled motion has blown up, or the "
                  "solver is wrong; take a smaller coupling.n or time.dt",
                  what, body ? " of body \"" : "", body ? body : "", body ? "\"" : "", why, step->t0, step->t1);
}

/* Arrays of numbers, what moves bodies first: what is recorded blows up with it. */
static tdm_status check_numbers(const cpl_session *s, int role, const tdm_step *step, const tdm_result *r,
                                tdm_error *err) {
  const struct {
    const char *what;
    const void *at; /* (count x size) doubles */
    int size, count;
    bool per_body; /* entry i belongs to body i % nbody */
  } parts[] = {
      {.what = "a load", .at = r->load, .size = TDM_WRENCH_DOUBLES, .count = r->nbody * r->nload, .per_body = true},
      {.what = "an acceleration", .at = r->acceleration, .size = 6, .count = r->nacceleration, .per_body = true},
      {.what = "a mobility",
       .at = r->mobility.Y, /* the first of its arrays */
       .size = (int)tdm_mobility_doubles(&r->mobility),
       .count = r->has_mobility},
      {.what = "moments of the load, an end or a work",
       .at = r->body,
       .size = sizeof *r->body / sizeof(double),
       .count = r->ninterface,
       .per_body = true},
      {.what = "a further coefficient of the load",
       .at = r->further,
       .size = TDM_FURTHER * TDM_WRENCH_DOUBLES,
       .count = r->nfurther,
       .per_body = true},
      {.what = "a supplied energy",
       .at = r->has_energy ? &r->energy->supplied : NULL,
       .size = 2,
       .count = r->has_energy},
      {.what = "a recorded load",
       .at = r->sample_load,
       .size = TDM_WRENCH_DOUBLES,
       .count = r->nload > 0 ? r->nsample * r->nbody : 0,
       .per_body = true},
  };
  for (size_t k = 0; k < sizeof parts / sizeof parts[0]; k++)
    for (int i = 0; i < parts[k].count; i++) {
      const char *why = bad_numbers((const double *)parts[k].at + (size_t)i * (size_t)parts[k].size, parts[k].size);
      if (why)
        return bad_result(step, parts[k].what, parts[k].per_body ? s->settings->body[i % r->nbody].name[role] : NULL,
                          why, err);
    }
  return TDM_OK;
}

static tdm_status check_states(const cpl_session *s, int role, const tdm_step *step, const tdm_result *r,
                               tdm_error *err) {
  const struct {
    const char *what;
    const tdm_state *at;
    int count;
  } parts[] = {{"a state", r->state, r->nstate},
               {"a state of the path", r->path.state, r->path.nnode * r->nbody},
               {"a recorded state", r->sample_state, r->nsample * r->nstate}};
  const char *why = NULL;
  for (size_t k = 0; k < sizeof parts / sizeof parts[0]; k++)
    for (int i = 0; i < parts[k].count; i++)
      if ((why = bad_state(&parts[k].at[i])) != NULL)
        return bad_result(step, parts[k].what, s->settings->body[i % r->nbody].name[role], why, err);
  for (int i = 0; i < r->ninterface; i++)
    if ((why = bad_state(&r->body[i].end)) != NULL)
      return bad_result(step, "an end", s->settings->body[i].name[role], why, err);
  return TDM_OK;
}

static tdm_status check_scalars(const cpl_session *s, int role, const tdm_step *step, const tdm_result *r,
                                tdm_error *err) {
  const double *energies = r->has_energy ? &r->energy->kinetic : NULL;
  for (int i = 0; energies && i < 2; i++)
    if (!isnan(energies[i]) && !tdm_usable(&energies[i], 1)) /* NaN: it did not look */
      return tdm_fail(err, TDM_ERR_NUMERIC, NULL, "returned an infinite energy, in the window from %g s to %g s",
                      step->t0, step->t1);
  const cpl_partner *p = &s->partner[role];
  for (int i = 0; i < r->nsample * r->nchannel; i++) {
    const bool gap = isnan(r->channel[i]) && p->channel[i % r->nchannel].gaps;
    const char *why = gap ? NULL : bad_numbers(&r->channel[i], 1);
    if (why)
      return tdm_fail(err, TDM_ERR_NUMERIC, NULL, "returned %g for the channel \"%s\" at %g s, which %s", r->channel[i],
                      p->channel[i % r->nchannel].name, step->sample_time[i / r->nchannel], why);
  }
  const char *why = r->has_mobility ? bad_mobility(r->mobility.Y, 6 * (size_t)r->nbody) : NULL;
  return why ? bad_result(step, "a mobility", NULL, why, err) : TDM_OK;
}

/* Counts and times are as the STEP asked, and what follows as ASSIGN did. */
static tdm_status check_shape(const cpl_session *s, int role, const tdm_step *step, const tdm_result *r,
                              tdm_error *err) {
  int nstate = role == CPL_MBD ? step->nbody : 0, nload = role == CPL_DEM ? 1 : 0;
  if (r->window != step->window || r->nbody != step->nbody || r->nstate != nstate || r->nload != nload ||
      r->nsample != step->nsample || r->nchannel != s->partner[role].nchannel)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL,
                    "malformed RESULT: window %llu, %d bodies, %d states, %d loads, %d samples, %d channels; asked for "
                    "window %llu, %d, %d, %d, %d, %d",
                    (unsigned long long)r->window, r->nbody, r->nstate, r->nload, r->nsample, r->nchannel,
                    (unsigned long long)step->window, step->nbody, nstate, nload, step->nsample,
                    s->partner[role].nchannel);
  const bool came[CPL_NEXTRA] = {r->nacceleration > 0, r->has_mobility, r->ninterface > 0,
                                 r->has_energy,        r->nfurther > 0, r->path.nnode > 0};
  for (int i = 0; i < CPL_NEXTRA; i++) {
    const bool some = step->nbody > 0 || !cpl_extras[i].per_body;
    const bool due = some && cpl_session_asks(s, (cpl_role)role, cpl_extras[i].name);
    if (came[i] != due && (came[i] || !cpl_extras[i].may_lack))
      return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed RESULT: %s \"%s\", not as ASSIGN asked",
                      came[i] ? "with" : "without", cpl_extras[i].name);
  }
  if (!(fabs(r->t - step->t1) <= 1e-9 * (step->t1 - step->t0) + 1e-15 * fabs(step->t1)))
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed RESULT: it reached %g s, asked for %g s", r->t, step->t1);
  if (!(r->wall >= 0 && r->wall <= 1e9))
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed RESULT: a wall time of %g s", r->wall);
  return TDM_OK;
}

tdm_status cpl_session_check_result(const cpl_session *s, int role, const tdm_step *step, const tdm_result *r,
                                    tdm_error *err) {
  if (check_shape(s, role, step, r, err) != TDM_OK || check_path(step, r, err) != TDM_OK)
    return err->status;
  tdm_status status = role == CPL_MBD ? check_states(s, role, step, r, err) : TDM_OK;
  if (status == TDM_OK)
    status = check_numbers(s, role, step, r, err);
  if (status == TDM_OK && role == CPL_DEM)
    status = check_states(s, role, step, r, err);
  return status == TDM_OK ? check_scalars(s, role, step, r, err) : status;
}
