/* The coupling adapter: the DEM engine as a participant (see protocol/participant.h).
 *
 * create: load, settle, report. step: one window on the bodies' paths, loads averaged over the window and over the
 * output intervals.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/adapter/solver.h"

#include "dem/adapter/report.h"
#include "dem/adapter/within.h"
#include "dem/bodies/proxy.h"
#include "dem/bodies/walls.h"
#include "dem/flow/flow.h"
#include "dem/model/group_options.h"
#include "dem/model/model_read.h"
#include "dem/settle/settle.h"
#include "dem/state/state_file.h"
#include "dem/step/integrate.h"
#include "dem/step/step.h"
#include "dem/watch/check.h"
#include "dem/watch/energy_balance.h"
#include "dem/watch/guard.h"
#include "dem/watch/limits.h"
#include "protocol/base/log.h"
#include "protocol/base/remark.h"
#include "protocol/version.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One row an output channel: name, unit. channel_values fills them in this order; then come the energies if the scene
 * asks for them, two for each source, two for each sink and for each of its size classes, what left dem.domain if
 * there is one, the balance if particles can come or go, and loads (has_channels says which). */
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
  X("particles.lost", "1")           \
  X("particles.mass", "kg")

static const tdm_channel channels[] = {
#define X(name, unit) {name, unit},
    CHANNEL_LIST(X)
#undef X
};
enum { NCHANNEL = sizeof channels / sizeof channels[0] };

typedef struct {
  dem_model *model;
  dem_data *data;
  tdm_participant *participant; /* borrowed; NULL: no server */
  dem_path *motion;             /* (ncoupled) paths of the present window */
  tdm_energy energy;            /* at the start */
  tdm_wrench *load;             /* (ncoupled) at the start; then sums over the window */
  dem_proxy *proxy;
  double contact_time; /* the shortest that is expected [s] */
  int nchannel;
  tdm_channel *channel; /* (nchannel) */
  double *initial;      /* (nchannel) */
  double *before;       /* (nchannel) at the beginning of a step that an output time lies inside of */
  dem_report report;
  dem_data *slot[TDM_SLOTS_MAX]; /* states that were saved; NULL: none */
} dem_solver;

/* ---- outputs ---- */

/* the energies' channels: what names them, and the values of the present state into out; returns how many */
static const char *const energy_channels[] = {"energy.potential", "energy.elastic", "energy.wall_work",
                                              "energy.supplied",
#define X(mechanism, name) "energy.dissipated." name,
                                              DEM_ENERGY_LIST(X)
#undef X
};
enum { NENERGY = sizeof energy_channels / sizeof energy_channels[0] };

static int energy_values(const dem_data *d, double *out) {
  double potential = 0;
  for (int i = 0; i < d->nparticle; i++)
    potential -= d->mass[i] * tdm_dot(dem_field(d, i), d->sphere[i].position);
  *out++ = potential;
  *out++ = dem_energy_elastic(&d->energy);
  *out++ = d->energy.wall_work;
  *out++ = d->energy.supplied;
  memcpy(out, d->energy.dissipated, sizeof d->energy.dissipated);
  return NENERGY;
}

/* the channels of a load: of a force alone the first three */
static const tdm_channel load_channels[] = {{"fx", "N"},   {"fy", "N"},   {"fz", "N"},
                                            {"mx", "N m"}, {"my", "N m"}, {"mz", "N m"}};
enum { NLOAD = sizeof load_channels / sizeof load_channels[0], NFORCE = 3 };

/* Has load l of the samples channels? Bodies that are not coupled and have walls; geometries of bodies that have
 * several; the last, of fixed particles, if there are any. */
static bool has_channels(const dem_model *m, int l) {
  if (l == m->nload)
    return m->fixes;
  int body = l < m->nbody ? l : m->geometry[l - m->nbody].body, many = 0;
  for (int g = 0; g < m->ngeometry; g++)
    many += m->geometry[g].body == body && m->geometry[g].nwall > 0;
  return l < m->nbody ? m->body[l].coupled < 0 && many > 0 : many > 1;
}

/* how many it has */
static int count_channels(const dem_model *m, int l) {
  return !has_channels(m, l) ? 0 : l == m->nload ? NFORCE : NLOAD;
}

/* the means of the last sample into out */
static void load_values(const dem_data *d, double *out) {
  for (int l = 0; l <= d->model->nload; l++) {
    const tdm_wrench *w = &d->sample_mean[l];
    const double values[NLOAD] = {w->force.x, w->force.y, w->force.z, w->moment.x, w->moment.y, w->moment.z};
    int n = count_channels(d->model, l);
    memcpy(out, values, (size_t)n * sizeof *out);
    out += n;
  }
}

static bool has_balance(const dem_model *m) {
  return m->nsource + m->nsink > 0 || m->domain.open;
}

/* (nchannel) values of the present state */
static void channel_values(const dem_data *d, double *out) {
  const dem_model *m = d->model;
  tdm_vec3 x = {0, 0, 0}, p = {0, 0, 0};
  double mass = 0, energy = 0;
  for (int i = 0; i < d->nparticle; i++) {
    mass += d->mass[i];
    x = tdm_axpy(d->mass[i], d->sphere[i].position, x);
    p = tdm_axpy(d->mass[i], d->pace[i].velocity, p);
    double inertia = 0.4 * d->mass[i] * d->sphere[i].radius * d->sphere[i].radius;
    energy += 0.5 * d->mass[i] * tdm_dot(d->pace[i].velocity, d->pace[i].velocity);
    energy += 0.5 * inertia * tdm_dot(d->pace[i].spin, d->pace[i].spin);
  }
  double per_mass = mass > 0 ? 1 / mass : 0;
  double values[NCHANNEL] = {d->nparticle,
                             per_mass * x.x,
                             per_mass * x.y,
                             per_mass * x.z,
                             per_mass * p.x,
                             per_mass * p.y,
                             per_mass * p.z,
                             energy,
                             (double)d->ncontact,
                             (double)dem_count_lost(d),
                             mass};
  memcpy(out, values, sizeof values);
  out += NCHANNEL;
  if (m->energy)
    out += energy_values(d, out);
  for (int s = 0; s < m->nsource; s++) {
    *out++ = (double)d->source[s].made;
    *out++ = (double)(d->source[s].due - d->source[s].made);
  }
  for (int s = 0; s < m->nsink; s++) {
    *out++ = (double)d->sink[s].removed;
    *out++ = d->sink[s].mass;
    for (int k = 0; k < dem_sink_classes(&m->sink[s]); k++) {
      *out++ = (double)d->sink[s].class_removed[k];
      *out++ = d->sink[s].class_mass[k];
    }
  }
  if (m->domain.wanted)
    *out++ = (double)d->ledger.left;
  if (has_balance(m)) {
    *out++ = dem_balance_number(d);
    *out++ = dem_balance_mass(d);
  }
  load_values(d, out);
}

static void name_channel(tdm_channel *c, const char *group, const char *name, const char *what, const char *unit) {
  snprintf(c->name, sizeof c->name, "%s.%s.%s", group, name, what);
  snprintf(c->unit, sizeof c->unit, "%s", unit);
}

/* the names of the channels of load l from c on; returns the channel after them */
static tdm_channel *name_load(tdm_channel *c, const dem_model *m, int l) {
  char shape[32] = "";
  int of = l;
  if (l >= m->nbody && l < m->nload) {
    of = m->geometry[l - m->nbody].body;
    snprintf(shape, sizeof shape, "shape%d.", m->geometry[l - m->nbody].number);
  }
  for (int k = 0, n = count_channels(m, l); k < n; k++, c++) {
    char what[64];
    snprintf(what, sizeof what, "%s%s", shape, load_channels[k].name);
    if (l == m->nload)
      snprintf(c->name, sizeof c->name, "fixed.%s", what);
    else
      name_channel(c, "body", m->body[of].name, what, load_channels[k].unit);
    snprintf(c->unit, sizeof c->unit, "%s", load_channels[k].unit);
  }
  return c;
}

/* the channels of this scene; false: no memory */
static bool make_channels(dem_solver *s) {
  const dem_model *m = s->model;
  int flows = m->nsource + m->nsink;
  for (int k = 0; k < m->nsink; k++)
    flows += dem_sink_classes(&m->sink[k]);
  s->nchannel =
      NCHANNEL + (m->energy ? NENERGY : 0) + 2 * flows + (m->domain.wanted ? 1 : 0) + (has_balance(m) ? 2 : 0);
  for (int l = 0; l <= m->nload; l++)
    s->nchannel += count_channels(m, l);
  s->channel = calloc((size_t)s->nchannel, sizeof *s->channel);
  s->initial = calloc((size_t)s->nchannel, sizeof *s->initial);
  s->before = calloc((size_t)s->nchannel, sizeof *s->before);
  if (!s->channel || !s->initial || !s->before)
    return false;
  memcpy(s->channel, channels, sizeof channels);
  tdm_channel *c = s->channel + NCHANNEL;
  for (int k = 0; m->energy && k < NENERGY; k++, c++) {
    snprintf(c->name, sizeof c->name, "%s", energy_channels[k]);
    snprintf(c->unit, sizeof c->unit, "J");
  }
  for (int k = 0; k < m->nsource; k++) {
    name_channel(c++, "source", m->source[k].name, "created", "1");
    name_channel(c++, "source", m->source[k].name, "waiting", "1");
  }
  for (int k = 0; k < m->nsink; k++) {
    name_channel(c++, "sink", m->sink[k].name, "removed", "1");
    name_channel(c++, "sink", m->sink[k].name, "mass", "kg");
    for (int j = 0; j < dem_sink_classes(&m->sink[k]); j++) {
      char what[32];
      snprintf(what, sizeof what, "class%d.removed", j);
      name_channel(c++, "sink", m->sink[k].name, what, "1");
      snprintf(what, sizeof what, "class%d.mass", j);
      name_channel(c++, "sink", m->sink[k].name, what, "kg");
    }
  }
  if (m->domain.wanted)
    *c++ = (tdm_channel){"particles.left", "1"};
  if (has_balance(m)) {
    *c++ = (tdm_channel){"balance.number", "1"};
    *c++ = (tdm_channel){"balance.mass", "kg"};
  }
  for (int l = 0; l <= m->nload; l++)
    c = name_load(c, m, l);
  return true;
}

static void add_load(tdm_wrench *sum, double weight, const tdm_wrench *load) {
  sum->force = tdm_axpy(weight, load->force, sum->force);
  sum->moment = tdm_axpy(weight, load->moment, sum->moment);
}

static tdm_wrench mean_load(const tdm_wrench *sum, double n) {
  return (tdm_wrench){tdm_scale(1 / n, sum->force), tdm_scale(1 / n, sum->moment)};
}

/* The share `share` of the present step, into the means of the output interval. */
static void sum_loads(dem_data *d, double share, tdm_vec3 fixed) {
  const int nload = d->model->nload;
  for (int l = 0; l < nload; l++)
    add_load(&d->sample_sum[l], share, &d->body_load[l]);
  add_load(&d->sample_sum[nload], share, &(tdm_wrench){.force = fixed});
  d->sample_steps += share;
}

/* Close the output interval: means since the sample before (which repeats if no time lies between), and channels, at
 * `share` of the present step. */
static void close_sample(dem_solver *s, int j, double share, double dt, tdm_result *result) {
  dem_data *d = s->data;
  int nc = s->model->ncoupled;
  for (int l = 0; l <= s->model->nload; l++) {
    if (d->sample_steps > 0)
      d->sample_mean[l] = mean_load(&d->sample_sum[l], d->sample_steps);
    d->sample_sum[l] = (tdm_wrench){0};
  }
  for (int c = 0; c < nc && result->nload > 0; c++)
    result->sample_load[j * nc + c] = d->sample_mean[s->model->coupled_body[c]];
  d->sample_steps = 0;
  if (result->nchannel == s->nchannel) {
    double *values = &result->channel[j * s->nchannel];
    channel_values(d, values);
    if (share < 1)
      dem_channels_within(s->nchannel, s->channel, share, dt, s->before, values);
  }
}

/* Step k of the window, which ended at t, is done: its loads into the means, and the output times up to t. The last
 * step closes what is left. `fixed`: force on fixed particles before any came or went. */
static void sample_step(dem_solver *s, const tdm_step *step, bool last, double t, double dt, tdm_vec3 fixed,
                        int *sample, tdm_result *result) {
  double from = 0;
  for (; *sample < step->nsample && (last || step->sample_time[*sample] <= t + 1e-6 * dt); ++*sample) {
    double share = dem_share_of_step(step->sample_time[*sample], t, dt);
    if (share > from)
      sum_loads(s->data, share - from, fixed);
    from = fmax(from, share);
    close_sample(s, *sample, share, dt, result);
  }
  if (from < 1)
    sum_loads(s->data, 1 - from, fixed);
}

/* ---- create ---- */

/* particles from elsewhere: pairs of materials that nobody gave, radii that the box is too narrow for */
static tdm_status check_started(const dem_data *d, tdm_error *err) {
  const dem_model *m = d->model;
  double largest = 0;
  for (int i = 0; i < d->nparticle && !err->status; i++) {
    largest = fmax(largest, d->sphere[i].radius);
    for (int j = i > 0 && d->material[i] == d->material[i - 1] ? m->nmaterial : 0; j < m->nmaterial; j++)
      if (!m->pair[d->material[i] * m->nmaterial + j].given) {
        const char *a = m->material[d->material[i]].name, *b = m->material[j].name;
        return tdm_fail(err, TDM_ERR_SCENE, "dem.pairs",
                        "\"%s\" and \"%s\" have no entry, but dem.start brings particles of \"%s\"; add one", a, b, a);
      }
  }
  dem_domain_check(m, largest, err);
  return err->status;
}

/* the particles of the stored state dem.start; lids stay where it has them unless there is settling to come */
static tdm_status start_from(dem_data *d, tdm_error *err) {
  if (dem_state_read(d, DEM_STATE_START, d->model->start, "dem.start", NULL, 0, err))
    return err->status;
  if (check_started(d, err))
    return err->status;
  if (d->model->settle.wanted)
    dem_lids_away(d);
  if (!dem_forces_now(d, false))
    return tdm_fail(err, TDM_ERR_MEMORY, "dem.start", "no memory for the neighbour lists");
  return TDM_OK;
}

/* Particles in place and at rest; *ready told. */
static tdm_status start(dem_solver *s, tdm_ready *ready, tdm_error *err) {
  dem_model *m = s->model;
  dem_data *d = s->data;
  int nbehind = 0;
  dem_settled settled = {.rest = true, .pressed = true};
  if (m->start && start_from(d, err))
    return err->status;
  if (dem_check_start(d, &nbehind, err))
    return err->status;
  if (dem_check_step(d, m->dt, "time.dt", err))
    return err->status;
  if (m->settle.wanted && dem_settle(d, s->participant, &settled, err))
    return err->status;
  if (!m->settle.wanted && !m->start && dem_lids_place(d) && !dem_forces_now(d, false))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the neighbour lists");
  dem_energy_begin(&d->energy);
  dem_guard_begin(d);
  dem_energy_balance_begin(d);
  if (dem_report_make(&s->report, d, &settled, nbehind, err))
    return err->status;
  s->contact_time = s->report.limits.contact;
  for (int c = 0; c < m->ncoupled; c++)
    s->load[c] = d->body_load[m->coupled_body[c]];
  for (int l = 0; l < m->nload; l++)
    d->sample_mean[l] = d->body_load[l];
  d->sample_mean[m->nload].force = dem_fixed_force(d);
  int nparticle = d->nparticle;
  if (!dem_flow(d, m->time_start, m->dt))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for particles of a source");
  dem_report_flow(&s->report, d);
  channel_values(d, s->initial);

  s->energy = dem_energy_balance_look(d);
  ready->energy = &s->energy;
  ready->rest = dem_rest_energy(d);
  ready->load = s->load;
  ready->nchannel = s->nchannel;
  ready->channel = s->channel;
  ready->initial = s->initial;
  ready->nwarning = s->report.nwarning;
  ready->warning = s->report.warning;
  ready->gravity = &m->gravity;
  ready->report = s->report.json;
  tdm_log(TDM_LOG_INFO, "loaded", "particles=%d walls=%d contacts=%ld settle_time=%.6g stored_bed=%s", nparticle,
          m->nwall, d->ncontact, settled.time, settled.stored ? "yes" : "no");
  return TDM_OK;
}

/* Multi-step's slow kicks would act on the mechanism once a step, its fast ones several times. */
static tdm_status check_proxy(const dem_model *m, tdm_error *err) {
  if (!m->integrator->kick)
    return TDM_OK;
  return tdm_fail(err, TDM_ERR_SCENE, "dem.integrator",
                  "\"%s\" cannot carry the mechanism of a scheme with a proxy; take \"verlet\", or \"dem-first\" or "
                  "\"lommen\" as coupling.scheme",
                  m->integrator->name);
}

static tdm_status create(void **self, const tdm_assignment *assignment, tdm_ready *ready, tdm_participant *p,
                         tdm_error *err) {
  dem_solver *s = calloc(1, sizeof *s);
  *self = s;
  if (!s)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the DEM solver");
  s->participant = p;
  if (dem_model_load(&s->model, assignment, err) || (assignment->proxy && check_proxy(s->model, err)))
    return err->status;
  s->data = dem_data_create(s->model);
  s->motion = calloc((size_t)assignment->nbody + 1, sizeof *s->motion);
  s->load = calloc((size_t)assignment->nbody + 1, sizeof *s->load);
  s->proxy = dem_proxy_create(s->model, assignment);
  if (!s->data || !s->motion || !s->load || !s->proxy || !make_channels(s))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %d particles", s->model->nparticle);
  return start(s, ready, err);
}

/* ---- step ---- */

/* the bodies' paths of this window, or the mechanism that carries them */
static tdm_status make_paths(dem_solver *s, const tdm_step *step, double dt, tdm_error *err) {
  const dem_model *m = s->model;
  if (step->nbody != m->ncoupled || step->nstate != m->ncoupled)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "STEP has states of %d bodies, ASSIGN had %d", step->nstate,
                    m->ncoupled);
  if (step->has_proxy && check_proxy(m, err)) /* of a server whose ASSIGN did not say so */
    return err->status;
  if (step->has_proxy)
    return dem_proxy_begin(s->proxy, s->data, step, dt, s->contact_time, err);
  for (int c = 0; c < m->ncoupled; c++) /* the server sees to it that no body turns far in a window without nodes */
    s->motion[c] = step->path.nnode > 0
                       ? dem_path_through(step, c)
                       : dem_path_make(&step->start[c], &step->end[c], step->t1 - step->t0, m->interpolation);
  return TDM_OK;
}

/* the step of this window: the scene's, unless the window is no whole number of them */
static double window_dt(const dem_model *m, const tdm_step *step) {
  double own = (step->t1 - step->t0) / (double)step->nstep;
  return fabs(own - m->dt) <= 1e-6 * m->dt ? m->dt : own;
}

/* The time at which step k, the next one, ends, from the number of steps since the start, so that sources do not depend
 * on how the run is cut into windows; from the window when that is not cut into the scene's steps. */
static double step_time(const dem_data *d, const tdm_step *step, uint64_t k, double dt) {
  double t = step->t0 + (double)k * dt, own = d->model->time_start + (double)(d->nstep + 1) * d->model->dt;
  return fabs(t - own) < 1e-3 * dt ? own : t;
}

static tdm_status solve(void *self, const tdm_step *step, tdm_result *result, tdm_error *err) {
  dem_solver *s = self;
  dem_data *d = s->data;
  const dem_model *m = s->model;
  double dt = window_dt(m, step);
  if (make_paths(s, step, dt, err))
    return err->status;
  memset(s->load, 0, (size_t)m->ncoupled * sizeof *s->load);
  dem_window_sums sums = {
      .duration = step->t1 - step->t0, .load = s->load, .body = result->ninterface > 0 ? result->body : NULL};
  dem_step_task task = {.dt = dt, .flow = true, .guard = true, .n = step->nstep, .sums = &sums};
  task.path = step->has_proxy ? NULL : s->motion;
  task.proxy = step->has_proxy ? s->proxy : NULL;
  int sample = 0;

  for (task.k = 1; task.k <= step->nstep; task.k++) {
    task.time = step_time(d, step, task.k, dt);
    if (sample < step->nsample && dem_share_of_step(step->sample_time[sample], task.time, dt) < 1)
      channel_values(d, s->before);
    d->traction.wanted = m->triangle_forces && task.k == step->nstep; /* runs end windows where they write files */
    if (dem_step(d, &task, err))
      return err->status;
    sample_step(s, step, task.k == step->nstep, task.time, dt, sums.fixed, &sample, result);
    if (tdm_participant_alive(s->participant))
      return tdm_fail(err, TDM_ERR_INTERRUPTED, NULL, "interrupted at t = %.9g s", task.time);
  }
  for (int c = 0; c < result->ninterface && !step->has_proxy; c++)
    result->body[c].end = step->end[c];
  if (step->has_proxy)
    dem_proxy_end(s->proxy, d, result->ninterface > 0 ? result->body : NULL,
                  result->nfurther > 0 ? result->further : NULL);
  for (int c = 0; c < m->ncoupled && result->nload == 1; c++)
    result->load[c] = mean_load(&s->load[c], (double)step->nstep);
  if (result->has_energy)
    *result->energy = dem_energy_balance_look(d);
  if (step->t1 >= m->time_end - 1e-3 * m->dt) {
    dem_guard_end(d, step->t1);
    dem_flow_end(d, step->t1);
  }
  return dem_check_finite(d, step->t1, err);
}

/* ---- states in memory ---- */

static tdm_status save(void *self, int slot, tdm_error *err) {
  dem_solver *s = self;
  dem_data **kept = &s->slot[slot];
  if (!*kept)
    *kept = dem_data_create(s->model);
  if (!*kept || !dem_data_copy(*kept, s->data))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory to save %d particles", s->data->nparticle);
  return TDM_OK;
}

static tdm_status restore(void *self, int slot, tdm_error *err) {
  dem_solver *s = self;
  if (!s->slot[slot])
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "RESTORE of slot %d, in which nothing was saved", slot);
  if (!dem_data_copy(s->data, s->slot[slot]))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory to restore %d particles", s->slot[slot]->nparticle);
  return TDM_OK;
}

static void destroy(void *self) {
  dem_solver *s = self;
  if (!s)
    return;
  for (int k = 0; k < TDM_SLOTS_MAX; k++)
    dem_data_destroy(&s->slot[k]);
  json_decref(s->report.json);
  dem_proxy_destroy(&s->proxy);
  dem_data_destroy(&s->data);
  dem_model_destroy(&s->model);
  free(s->channel);
  free(s->initial);
  free(s->before);
  free(s->motion);
  free(s->load);
  free(s);
}

const dem_data *dem_solver_data(const void *self) {
  const dem_solver *s = self;
  return s->data;
}
static const char *const capabilities[] = {"restore", "interface", "proxy", "matched_load", "energy", "path"};

const tdm_solver_ops dem_solver_ops = {
    .capabilities = capabilities,
    .ncapability = sizeof capabilities / sizeof capabilities[0],
    .role = "dem",
    .software = "tandem-dem " TDM_VERSION,
    .create = create,
    .step = solve,
    .save = save,
    .restore = restore,
    .destroy = destroy,
};
