/* The engine's life: create, save and restore, destroy. See dem.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/adapter/engine.h"
#include "dem/adapter/orders.h"

#include "dem/base/energy.h"
#include "dem/bodies/walls.h"
#include "dem/flow/flow.h"
#include "dem/flow/screening.h"
#include "dem/particles/create.h"
#include "dem/particles/field.h"
#include "dem/scene/keys.h"
#include "dem/scene/scene.h"
#include "dem/seam/homes.h"
#include "dem/settle/settle.h"
#include "dem/step/forces.h"
#include "dem/store/state_file.h"
#include "dem/watch/check.h"
#include "dem/watch/energy_balance.h"
#include "dem/watch/guard.h"
#include "protocol/base/log.h"
#include "protocol/base/memory.h"
#include "protocol/math/gsl_errors.h"

#include <assert.h>
#include <stdlib.h>

/* ---- the start ---- */

/* particles of a stored state: pairs of materials that nobody gave, radii that the box is too narrow for */
static tdm_status check_started(const dem_data *d, tdm_error *err) {
  const dem_model *m = d->model;
  double largest = 0;
  for (int i = 0; i < d->state.nparticle && !err->status; i++) {
    largest = fmax(largest, d->state.sphere[i].radius);
    for (int j = i > 0 && d->state.material[i] == d->state.material[i - 1] ? m->nmaterial : 0; j < m->nmaterial; j++)
      if (!m->pair[d->state.material[i] * m->nmaterial + j].given) {
        const char *a = m->material[d->state.material[i]].name, *b = m->material[j].name;
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
  return dem_forces_now(d, false, err);
}

/* Particles in place and at rest. */
static tdm_status place_particles(dem_engine *e, dem_settled *settled, int *nbehind, tdm_error *err) {
  const dem_model *m = e->model;
  dem_data *d = e->data;
  if (m->start && start_from(d, err))
    return err->status;
  if (dem_check_start(d, nbehind, err) || dem_check_step(d, m->dt, "time.dt", err))
    return err->status;
  if (m->settle.wanted)
    return dem_settle(d, e->participant, settled, err);
  return !m->start && dem_lids_place(d) ? dem_forces_now(d, false, err) : TDM_OK;
}

/* The means of the output interval before the first sample are what acts at the start. */
static void begin_samples(dem_data *d) {
  const dem_model *m = d->model;
  for (int l = 0; l < m->nload; l++)
    d->state.sample_mean[l] = d->state.body_load[l];
  d->state.sample_mean[m->nload].force = dem_fixed_force(d);
}

static void tell_start(dem_engine *e) {
  dem_channels_sample(&e->channels, e->data, e->initial);
  e->start = (dem_start){.load = e->load,
                         .nchannel = e->channels.count,
                         .channel = e->channels.channel,
                         .initial = e->initial,
                         .nwarning = e->report.nwarning,
                         .warning = e->report.warning,
                         .energy = dem_energy_balance_look(e->data),
                         .rest = dem_rest_energy(e->model, dem_total_mass(e->data)),
                         .gravity = e->model->gravity,
                         .report = e->report.json};
}

static tdm_status start(dem_engine *e, tdm_error *err) {
  const dem_model *m = e->model;
  dem_data *d = e->data;
  int nbehind = 0;
  dem_settled settled = {.rest = true, .pressed = true};
  if (place_particles(e, &settled, &nbehind, err))
    return err->status;
  dem_energy_begin(&d->state.energy);
  dem_guard_begin(d);
  dem_energy_balance_begin(d);
  if (dem_report_make(&e->report, d, &settled, nbehind, err))
    return err->status;
  e->time = m->time_start;
  e->contact_time = e->report.limits.contact;
  for (int c = 0; c < m->ncoupled; c++)
    e->load[c] = d->state.body_load[m->coupled_body[c]];
  begin_samples(d);
  dem_screening_begin(d);
  int nparticle = d->state.nparticle;
  if (dem_flow(d, m->time_start, m->dt, err))
    return err->status;
  dem_report_flow(&e->report, d);
  tell_start(e);
  tdm_log(TDM_LOG_INFO, "loaded", "particles=%d walls=%d contacts=%ld settle_time=%.6g stored_bed=%s", nparticle,
          m->nwall, d->state.ncontact, settled.time, settled.stored ? "yes" : "no");
  return TDM_OK;
}

/* ---- create and destroy ---- */

tdm_status dem_engine_check_proxy(const dem_engine *e, tdm_error *err) {
  if (!e->model->integrator->kick) /* slow kicks would act on the mechanism once a step */
    return TDM_OK;
  return tdm_fail(
      err, TDM_ERR_SCENE, "dem.integrator",
      "\"%s\" cannot carry the mechanism of the coupled bodies, as coupling.scheme wants; take \"verlet\", or a "
      "scheme that leaves the mechanism to its own solver",
      e->model->integrator->name);
}

/* Refuse another number of ranks than the scene wants. */
static tdm_status check_ranks(const dem_model *m, tdm_error *err) {
  const int size = dem_orders_ranks() ? dem_orders_ranks()->size : 1;
  if (m->ranks && m->ranks != size)
    return tdm_fail(err, TDM_ERR_SCENE, "dem.ranks",
                    "is %d, but this solver was started as %d process%s; start it with mpirun -n %d tandem-dem, leave "
                    "the start to dem.ranks alone, or remove it",
                    m->ranks, size, size == 1 ? "" : "es", m->ranks);
  return TDM_OK;
}

/* Will nobody ask again how particles start? It is in the data of the ranks whose home they are; but some may still be
 * to come, and a stored state says what it is of. */
static bool placed(const dem_model *m) {
  return m->npoured == 0 && !m->settle.store && !m->start;
}

static tdm_status allocate(dem_engine *e, const tdm_assignment *assignment, tdm_error *err) {
  if (dem_channels_make(&e->channels, e->model, err))
    return err->status;
  const size_t n = (size_t)e->channels.count;
  e->data = dem_data_create_on(e->model, dem_orders_ranks());
  e->load = calloc((size_t)assignment->nbody + 1, sizeof *e->load);
  e->initial = calloc(n, sizeof *e->initial);
  e->before = calloc(n, sizeof *e->before);
  e->proxy = dem_proxy_create(e->model, assignment);
  if (!e->data || !e->load || !e->initial || !e->before || !e->proxy)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %d particles", e->model->nparticle);
  if (dem_orders_ranks() && placed(e->model))
    dem_model_forget_start(e->model);
  return dem_forces_begin(e->data, err);
}

static tdm_status make(dem_engine *e, const tdm_assignment *assignment, tdm_error *err) {
  if (dem_model_read_on(&e->model, assignment, dem_orders_ranks(), err) || check_ranks(e->model, err) ||
      (assignment->proxy && dem_engine_check_proxy(e, err)) || allocate(e, assignment, err))
    return err->status;
  if (start(e, err))
    return err->status;
  if (dem_orders_ranks())
    dem_model_forget_start(e->model);
  return TDM_OK;
}

static void let_go(dem_engine **engine) {
  dem_engine *e = *engine;
  for (int k = 0; k < TDM_SLOTS_MAX; k++)
    dem_data_destroy(&e->slot[k]);
  json_decref(e->report.json);
  dem_channels_free(&e->channels);
  dem_proxy_destroy(&e->proxy);
  dem_view_free(&e->view);
  dem_data_destroy(&e->data);
  dem_model_destroy(&e->model);
  free(e->initial);
  free(e->before);
  free(e->load);
  free(e);
  *engine = NULL;
}

tdm_status dem_engine_create(dem_engine **engine, const tdm_assignment *assignment, tdm_participant *participant,
                             tdm_error *err) {
  assert(!*engine);
  tdm_gsl_return_errors();
  tdm_memory_watch_json();
  dem_orders_create(assignment);
  const unsigned long before = tdm_memory_notes();
  dem_engine *e = calloc(1, sizeof *e);
  if (!e) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the DEM engine");
    return dem_orders_done(err);
  }
  e->participant = participant;
  make(e, assignment, err);
  tdm_memory_since(before, "dem", err);
  if (dem_orders_done(err)) {
    let_go(&e);
    return err->status;
  }
  *engine = e;
  return TDM_OK;
}

void dem_engine_destroy(dem_engine **engine) {
  if (!*engine)
    return;
  dem_orders_give(DEM_ORDER_DESTROY, 0);
  let_go(engine);
}

const dem_start *dem_engine_start(const dem_engine *e) {
  return &e->start;
}

const dem_data *dem_engine_data(const dem_engine *e) {
  return e->data;
}

/* ---- save and restore ---- */

tdm_status dem_engine_save(dem_engine *e, int slot, tdm_error *err) {
  assert(slot >= 0 && slot < TDM_SLOTS_MAX);
  dem_data **kept = &e->slot[slot];
  dem_orders_give(DEM_ORDER_SAVE, slot);
  if (!*kept)
    *kept = dem_data_allocate(e->model);
  if (!*kept || dem_data_copy(*kept, e->data))
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory to save %d particles", e->data->state.nparticle);
  e->turned[slot] = dem_proxy_turned(e->proxy);
  return dem_orders_done(err);
}

tdm_status dem_engine_restore(dem_engine *e, int slot, tdm_error *err) {
  assert(slot >= 0 && slot < TDM_SLOTS_MAX);
  if (!e->slot[slot])
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "RESTORE of slot %d, in which nothing was saved", slot);
  dem_orders_give(DEM_ORDER_RESTORE, slot);
  if (dem_data_copy(e->data, e->slot[slot]))
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory to restore %d particles", e->slot[slot]->state.nparticle);
  dem_proxy_turn(e->proxy, e->turned[slot]);
  dem_homes_restored(e->data);
  return dem_orders_done(err);
}

/* ---- what there is to see ---- */

tdm_status dem_engine_work(dem_engine *e, dem_rank_work *work, tdm_error *err) {
  const dem_ranks *ranks = e->data->work.homes.ranks;
  int own[DEM_RANKS_MAX + 1];
  if (!ranks)
    return TDM_OK;
  dem_orders_give(DEM_ORDER_WORK, 0);
  for (int r = 0; r <= ranks->size; r++)
    own[r] = r;
  work[ranks->rank] = e->data->work.homes.work;
  ranks->gather(work, sizeof *work, own);
  return dem_orders_done(err);
}

tdm_status dem_engine_scenery(dem_engine *e, tdm_scenery *scenery, tdm_error *err) {
  dem_orders_give(DEM_ORDER_SCENERY, 0);
  dem_view_scenery(&e->view, e->data, scenery, err);
  return dem_orders_done(err);
}

typedef tdm_status look(dem_view *view, const dem_data *data, double t, tdm_snapshot *snapshot, tdm_error *err);

/* all ranks look by this function; contacts are found on rank 0 */
static tdm_status take(dem_engine *e, dem_order_kind kind, look *by, tdm_snapshot *snapshot, tdm_error *err) {
  dem_orders_give(kind, snapshot->with_contacts);
  if (snapshot->with_contacts)
    dem_collect(e->data, DEM_WHOLE);
  by(&e->view, e->data, e->time, snapshot, err);
  return dem_orders_done(err);
}

tdm_status dem_engine_snapshot(dem_engine *e, tdm_snapshot *snapshot, tdm_error *err) {
  return take(e, DEM_ORDER_SNAPSHOT, dem_view_snapshot, snapshot, err);
}

tdm_status dem_engine_share(dem_engine *e, tdm_snapshot *snapshot, tdm_error *err) {
  return take(e, DEM_ORDER_SHARE, dem_view_share, snapshot, err);
}

tdm_status dem_engine_write_shares(dem_engine *e, const tdm_snapshot *share, const tdm_shared_frame *frame,
                                   tdm_error *err) {
  dem_orders_write(frame);
  if (!dem_homes_writes(e->data))
    tdm_share_write(frame, share, err);
  return dem_orders_written(err);
}
