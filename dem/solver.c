/* The coupling adapter: the DEM engine as a participant (see protocol/participant.h).
 *
 * create: load, settle, report. step: one window on the bodies' paths, loads averaged over the window and over the
 * output intervals.
 */
#include "dem/solver.h"

#include "dem/check.h"
#include "dem/geometry/walls.h"
#include "dem/limits.h"
#include "dem/settle.h"
#include "dem/step.h"
#include "protocol/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WARNINGS_MAX = 8 };

/* one row an output channel: name, unit. channel_values fills them in this order. */
#define CHANNEL_LIST(X)              \
  X("particles.count", "1")          \
  X("particles.com.x", "m")          \
  X("particles.com.y", "m")          \
  X("particles.com.z", "m")          \
  X("particles.velocity.x", "m/s")   \
  X("particles.velocity.y", "m/s")   \
  X("particles.velocity.z", "m/s")   \
  X("particles.kinetic_energy", "J") \
  X("particles.contacts", "1")       \
  X("particles.lost", "1")

static const tdm_channel channels[] = {
#define X(name, unit) {name, unit},
    CHANNEL_LIST(X)
#undef X
};
enum { NCHANNEL = sizeof channels / sizeof channels[0] };

typedef struct {
  dem_model *model;
  dem_data *data;
  tdm_participant *participant; /* borrowed */
  dem_motion *motion;           /* (ncoupled) paths of the present window */
  tdm_wrench *load;             /* (ncoupled) at the start; then sums over the window */
  double initial[NCHANNEL];
  tdm_warning warning[WARNINGS_MAX];
  int nwarning;
  json_t *report;
  long lost; /* particles through walls so far, as logged */
} dem_solver;

/* ---- outputs ---- */

static void channel_values(const dem_data *d, double out[NCHANNEL]) {
  const dem_model *m = d->model;
  tdm_vec3 x = {0, 0, 0}, p = {0, 0, 0};
  double mass = 0, energy = 0;
  for (int i = 0; i < m->nparticle; i++) {
    mass += m->mass[i];
    x = tdm_axpy(m->mass[i], d->position[i], x);
    p = tdm_axpy(m->mass[i], d->velocity[i], p);
    double inertia = 0.4 * m->mass[i] * m->radius[i] * m->radius[i];
    energy += 0.5 * m->mass[i] * tdm_dot(d->velocity[i], d->velocity[i]);
    energy += 0.5 * inertia * tdm_dot(d->spin[i], d->spin[i]);
  }
  double per_mass = mass > 0 ? 1 / mass : 0;
  double values[NCHANNEL] = {m->nparticle,        per_mass * x.x,           per_mass * x.y, per_mass * x.z,
                             per_mass * p.x,      per_mass * p.y,           per_mass * p.z, energy,
                             (double)d->ncontact, (double)dem_count_lost(d)};
  memcpy(out, values, sizeof values);
}

static void add_load(tdm_wrench *sum, const tdm_wrench *load) {
  sum->force = tdm_add(sum->force, load->force);
  sum->moment = tdm_add(sum->moment, load->moment);
}

static tdm_wrench mean_load(const tdm_wrench *sum, double n) {
  return (tdm_wrench){tdm_scale(1 / n, sum->force), tdm_scale(1 / n, sum->moment)};
}

static void note_lost(dem_solver *s, double t, long lost) {
  if (lost > s->lost)
    tdm_log(TDM_LOG_WARNING, "particles_lost", "t=%.9g particles=%ld", t, lost);
  s->lost = lost;
}

/* Close the output interval: means since the sample before (which repeats if no step lies between), and channels. */
static void close_sample(dem_solver *s, int j, double t, tdm_result *result) {
  dem_data *d = s->data;
  int nc = s->model->ncoupled;
  for (int c = 0; c < nc; c++) {
    if (d->sample_count > 0)
      d->sample_mean[c] = mean_load(&d->sample_sum[c], (double)d->sample_count);
    d->sample_sum[c] = (tdm_wrench){0};
    if (result->nload > 0)
      result->sample_load[j * nc + c] = d->sample_mean[c];
  }
  d->sample_count = 0;
  if (result->nchannel == NCHANNEL) {
    double *values = &result->channel[j * NCHANNEL];
    channel_values(d, values);
    note_lost(s, t, (long)values[NCHANNEL - 1]);
  }
}

/* ---- create ---- */

static void warn(dem_solver *s, const char *path, const char *format, ...) __attribute__((format(printf, 3, 4)));

static void warn(dem_solver *s, const char *path, const char *format, ...) {
  if (s->nwarning == WARNINGS_MAX)
    return;
  tdm_warning *w = &s->warning[s->nwarning++];
  snprintf(w->path, sizeof w->path, "%s", path);
  va_list args;
  va_start(args, format);
  vsnprintf(w->message, sizeof w->message, format, args);
  va_end(args);
}

/* a number for the report: null when it is not finite */
static json_t *number(double x) {
  return isfinite(x) ? json_real(x) : json_null();
}

static json_t *make_report(const dem_solver *s, const dem_limits *limits, const dem_settled *settled) {
  const dem_model *m = s->model;
  double mass = 0;
  for (int i = 0; i < m->nparticle; i++)
    mass += m->mass[i];
  json_t *r = json_object();
  json_object_set_new(r, "particles", json_integer(m->nparticle));
  json_object_set_new(r, "particle_mass", number(mass));
  json_object_set_new(r, "bodies", json_integer(m->nbody));
  json_object_set_new(r, "walls", json_integer(m->nwall));
  json_object_set_new(r, "contacts", json_integer(s->data->ncontact));
  json_object_set_new(r, "normal", json_string(m->law->normal));
  json_object_set_new(r, "tangential", json_string(m->law->tangential));
  json_object_set_new(r, "tail", json_string(m->law->tail));
  json_object_set_new(r, "skin", number(m->skin));
  json_object_set_new(r, "rayleigh_step", number(limits->rayleigh));
  json_object_set_new(r, "contact_time", number(limits->contact));
  json_object_set_new(r, "contact_speed", number(limits->speed));
  json_object_set_new(r, "steps_per_contact", number(limits->contact / m->dt));
  json_object_set_new(r, "eigen_step", number(limits->eigen));
  json_object_set_new(r, "step_limit", number(limits->step));
  if (m->settle.wanted)
    json_object_set_new(r, "settle",
                        json_pack("{s:b, s:f, s:f, s:f}", "rest", settled->rest, "time", settled->time, "dt",
                                  settled->dt, "speed", settled->speed));
  return r;
}

static void warn_start(dem_solver *s, const dem_limits *limits, const dem_settled *settled, int nbehind) {
  const dem_model *m = s->model;
  if (nbehind > 0)
    warn(s, "dem.particles",
         "%d particles are behind a plane, which does not act on them; planes are infinite, so move "
         "the particles or the plane unless this is meant",
         nbehind);
  if (!settled->rest)
    warn(s, "dem.settle",
         "the bed did not come to rest within max_time = %g s: a particle still moves at %.3g m/s; raise "
         "max_time or speed (%g m/s), or lower restitution",
         m->settle.max_time, settled->speed, m->settle.speed);
  if (m->settle.wanted && dem_count_lost(s->data) > 0)
    warn(s, "dem.settle",
         "%ld particles went through a wall while settling; reduce settle.dt (%g s) or start them with "
         "less overlap and speed",
         dem_count_lost(s->data), settled->dt);
  if (m->dt > limits->step)
    warn(s, "time.dt",
         "%g s is above %s, %.4g s (Rayleigh step %.4g s, contact time %.4g s at %.3g m/s); use at most "
         "%.3g s, or softer or larger particles",
         m->dt, limits->by, limits->step, limits->rayleigh, limits->contact, limits->speed, limits->step);
}

/* Particles in place and at rest; *ready told. */
static tdm_status start(dem_solver *s, tdm_ready *ready, tdm_error *err) {
  dem_model *m = s->model;
  int nbehind = 0;
  dem_settled settled = {.rest = true};
  if (dem_check_start(s->data, &nbehind, err))
    return err->status;
  if (m->settle.wanted && dem_settle(s->data, s->participant, &settled, err))
    return err->status;
  dem_limits limits = dem_limits_now(s->data);
  warn_start(s, &limits, &settled, nbehind);
  s->report = make_report(s, &limits, &settled);
  for (int c = 0; c < m->ncoupled; c++)
    s->load[c] = s->data->sample_mean[c] = s->data->body_load[m->coupled_body[c]];
  channel_values(s->data, s->initial);

  ready->load = s->load;
  ready->nchannel = NCHANNEL;
  ready->channel = channels;
  ready->initial = s->initial;
  ready->nwarning = s->nwarning;
  ready->warning = s->warning;
  ready->report = s->report;
  tdm_log(TDM_LOG_INFO, "loaded", "particles=%d walls=%d contacts=%ld settle_time=%.6g step_limit=%.4g", m->nparticle,
          m->nwall, s->data->ncontact, settled.time, limits.step);
  return TDM_OK;
}

static tdm_status create(void **self, const tdm_assignment *assignment, tdm_ready *ready, tdm_participant *p,
                         tdm_error *err) {
  dem_solver *s = calloc(1, sizeof *s);
  *self = s;
  if (!s)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the DEM solver");
  s->participant = p;
  if (dem_model_load(&s->model, assignment, err))
    return err->status;
  s->data = dem_data_create(s->model);
  s->motion = calloc((size_t)assignment->nbody + 1, sizeof *s->motion);
  s->load = calloc((size_t)assignment->nbody + 1, sizeof *s->load);
  if (!s->data || !s->motion || !s->load)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %d particles", s->model->nparticle);
  return start(s, ready, err);
}

/* ---- step ---- */

/* the bodies' paths of this window */
static tdm_status make_paths(dem_solver *s, const tdm_step *step, tdm_error *err) {
  const dem_model *m = s->model;
  if (step->nbody != m->ncoupled || step->nstate != m->ncoupled)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "STEP has states of %d bodies, ASSIGN had %d", step->nstate,
                    m->ncoupled);
  for (int c = 0; c < m->ncoupled; c++) /* the server sees to it that no body turns far in a window */
    s->motion[c] = dem_motion_make(&step->start[c], &step->end[c], step->t1 - step->t0, m->interpolation);
  return TDM_OK;
}

/* the step of this window: the scene's, unless the window is no whole number of them */
static double window_dt(const dem_model *m, const tdm_step *step) {
  double own = (step->t1 - step->t0) / (double)step->nstep;
  return fabs(own - m->dt) <= 1e-6 * m->dt ? m->dt : own;
}

static tdm_status solve(void *self, const tdm_step *step, tdm_result *result, tdm_error *err) {
  dem_solver *s = self;
  dem_data *d = s->data;
  const dem_model *m = s->model;
  if (make_paths(s, step, err))
    return err->status;
  double dt = window_dt(m, step);
  memset(s->load, 0, (size_t)m->ncoupled * sizeof *s->load);
  int sample = 0;

  for (uint64_t k = 1; k <= step->nstep; k++) {
    if (!dem_step(d, s->motion, k, step->nstep, false, dt))
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the neighbour lists");

    /* [L18] Eq. 2: the mean of the n samples after each step */
    for (int c = 0; c < m->ncoupled; c++) {
      add_load(&s->load[c], &d->body_load[m->coupled_body[c]]);
      add_load(&d->sample_sum[c], &d->body_load[m->coupled_body[c]]);
    }
    d->sample_count++;

    /* the last step closes what is left */
    double t = step->t0 + (double)k * dt;
    while (sample < step->nsample && (t >= step->sample_time[sample] - 1e-9 * dt || k == step->nstep))
      close_sample(s, sample++, t, result);
    if (k % 256 == 0 && s->participant && tdm_participant_alive(s->participant))
      return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted at t = %.9g s", t);
  }
  for (int c = 0; c < m->ncoupled && result->nload == 1; c++)
    result->load[c] = mean_load(&s->load[c], (double)step->nstep);
  return dem_check_finite(d, step->t1, err);
}

static void destroy(void *self) {
  dem_solver *s = self;
  if (!s)
    return;
  json_decref(s->report);
  dem_data_destroy(&s->data);
  dem_model_destroy(&s->model);
  free(s->motion);
  free(s->load);
  free(s);
}

const tdm_solver_ops dem_solver_ops = {
    .role = "dem",
    .software = "tandem-dem " TANDEM_VERSION,
    .create = create,
    .step = solve,
    .destroy = destroy,
};
