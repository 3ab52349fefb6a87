/* Runs on ranks that are threads (test_ranks_support.h), compared with the run on one. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TEST_RANKS_RUNS_H
#define TEST_RANKS_RUNS_H

#include "test_dem_support.h"

#include "dem/dem.h"
#include "dem/exchange/keep.h"
#include "dem/seam/homes.h"
#include "dem/store/state_file.h"
#include "test_ranks_support.h"

/* ---- a run, and what it comes to ---- */

/* What is run, and how. */
typedef struct {
  json_t *(*scene)(int threads);
  double dt;
  int nwindow, nstep; /* so many windows of so many steps */
  int ncoupled;       /* 1: the body "box", or the other one, is led to and fro */
  const char *body;   /* NULL: "box", at the origin */
  tdm_pose rest;      /* where the other one is */
  bool carried;       /* the engine carries it instead: a free body */
  bool tries;         /* each window is made twice: saved, made, restored, made */
  bool contacts;      /* snapshots have contacts */
  bool stays;         /* lists hold for so long that homes cannot move */
  bool silent;        /* windows have no samples */
} kind;

typedef struct {
  const kind *kind;
  int threads;
  bool restless; /* homes move whenever lists are made and chunks seem to cost otherwise */
  /* out */
  int moves;
  dem_rank_work work[THREAD_RANKS_MAX]; /* of each rank */
  tdm_view_bytes seen;                  /* what there was to see */
  void *bytes;                          /* (size) the whole state at the end */
  size_t size;
  int nchannel, nparticle;
  double *channel;                      /* (nwindow x nchannel) */
  tdm_wrench *load;                     /* (nwindow) */
  tdm_interface *body;                  /* (nwindow) */
  double contact_force, triangle_force; /* sums over contacts and triangles of the last snapshot [N] */
} outcome;

static inline tdm_state led_at(const kind *k, double t) {
  tdm_state s = state_at(0, 0, 0);
  if (k->body)
    s.pose = k->rest;
  s.pose.position.x += 0.002 * sin(300 * t);
  s.twist.velocity.x = 0.6 * cos(300 * t);
  return s;
}

/* the mechanism of a free body of 1 kg that stands where it went in the window before; its numbers are in block */
static inline dem_mechanism free_body(const tdm_state *start, double block[512]) {
  memset(block, 0, 512 * sizeof *block);
  dem_mechanism m = {.start = start,
                     .proxy = {.acceleration = block,
                               .load = (const tdm_wrench *)(const void *)(block + 6),
                               .correction = block + 12,
                               .mobility = {.nbody = 1, .nfree = 6}}};
  tdm_mobility_point(&m.proxy.mobility, block + 24);
  block[2] = -9.81;
  for (int i = 0; i < 6; i++) {
    m.proxy.mobility.J[i * 6 + i] = 1;
    m.proxy.mobility.B[i * 6 + i] = m.proxy.mobility.Y[i * 6 + i] = i < 3 ? 1 : 100;
    m.proxy.mobility.velocity[i] = ((const double *)(const void *)&start->twist)[i];
  }
  return m;
}

/* window w of the run */
static inline void window(outcome *out, dem_engine *e, int w) {
  const kind *k = out->kind;
  const double h = k->nstep * k->dt, t0 = w * h, t1 = (w + 1) * h, sample[] = {t0 + 0.4 * h, t1};
  const tdm_state start = k->carried && w > 0 ? out->body[w - 1].end : led_at(k, t0), end = led_at(k, t1);
  double block[512];
  const dem_mechanism mechanism = free_body(&start, block);
  const dem_path path = dem_path_make(&start, &end, h, TDM_HERMITE);
  const dem_window window = {.t0 = t0,
                             .t1 = t1,
                             .nstep = (uint64_t)k->nstep,
                             .path = k->ncoupled && !k->carried ? &path : NULL,
                             .mechanism = k->carried ? &mechanism : NULL,
                             .nsample = k->silent ? 0 : 2,
                             .sample_time = sample,
                             .seen = w + 1 == k->nwindow};
  double *channel = calloc(2 * (size_t)out->nchannel + 1, sizeof *channel);
  tdm_energy energy;
  tdm_error err = {0};
  const int tries = k->tries ? 2 : 1;
  for (int try = 0; try < tries; try++) {
    out->body[w] = (tdm_interface){0};
    if (tries == 2)
      ck_assert_msg(!(try == 0 ? dem_engine_save(e, 3, &err) : dem_engine_restore(e, 3, &err)), "%s", err.message);
    tdm_wrench further[TDM_FURTHER];
    const dem_outcome wanted = {.load = &out->load[w],
                                .body = &out->body[w],
                                .further = k->carried ? further : NULL,
                                .energy = &energy,
                                .channel = channel};
    ck_assert_msg(!dem_engine_advance(e, &window, &wanted, &err), "%s: %s", err.path, err.message);
  }
  memcpy(out->channel + w * out->nchannel, channel + out->nchannel, (size_t)out->nchannel * sizeof *channel);
  free(channel);
}

/* the clock of restless runs: chunks seem to take very different times, others each time */
static inline double erratic_clock(void) {
  static _Thread_local uint32_t state = 1;
  static _Thread_local double now;
  state = state * 1664525u + 1013904223u;
  const double u = (state >> 8) / 16777216.0;
  return now += 1 / (1e-3 + u * u);
}

/* the scene, with homes that may move */
static inline json_t *scene_of(const outcome *out) {
  json_t *scene = out->kind->scene(out->threads), *decomposition = json_object_get(scene, "decomposition");
  if (!out->restless)
    return scene;
  if (!decomposition)
    json_object_set_new(scene, "decomposition", decomposition = json_object());
  json_object_set_new(decomposition, "balance", json_pack("{s:i,s:f}", "every", 1, "tolerance", 1e-6));
  return scene;
}

/* of a model that has the start of all particles, as a state says what it is of */
static inline void save_state(outcome *out, const dem_data *d, const tdm_assignment *assignment) {
  dem_data whole = *d;
  dem_model *model;
  tdm_error err = {0};
  ck_assert_msg(!dem_model_read(&model, assignment, &err), "%s: %s", err.path, err.message);
  whole.model = model;
  ck_assert(!dem_state_save(&whole, &out->bytes, &out->size));
  dem_model_destroy(&model);
}

static inline void lead(void *context) {
  outcome *out = context;
  const kind *k = out->kind;
  dem_keep_poisons = true; /* what is used of other ranks' particles without having come from them shows */
  const tdm_assigned_body box = {.name = k->body ? k->body : "box", .mass = 1, .state = led_at(k, 0)};
  const tdm_assignment assignment = {.scene = scene_of(out),
                                     .time_end = k->dt * k->nstep * k->nwindow,
                                     .dt = k->dt,
                                     .n = k->nstep,
                                     .nbody = k->ncoupled,
                                     .proxy = k->carried,
                                     .matched_load = k->carried,
                                     .body = &box};
  dem_engine *e = NULL;
  tdm_error err = {0};
  ck_assert_msg(!dem_engine_create(&e, &assignment, NULL, &err), "%s: %s", err.path, err.message);
  const size_t n = (size_t)k->nwindow;
  out->nchannel = dem_engine_start(e)->nchannel;
  out->channel = calloc(n * (size_t)out->nchannel + 1, sizeof *out->channel);
  out->load = calloc(n, sizeof *out->load);
  out->body = calloc(n, sizeof *out->body);
  tdm_scenery scenery = {0};
  tdm_snapshot s = {.with_contacts = k->contacts};
  ck_assert_msg(!dem_engine_scenery(e, &scenery, &err), "%s", err.message);
  for (int w = 0; w < k->nwindow; w++) {
    window(out, e, w);
    if (w % 2 == 1 || w + 1 == k->nwindow)
      ck_assert_msg(!dem_engine_snapshot(e, &s, &err) && !tdm_snapshot_encode(&s, false, &out->seen, &err), "%s",
                    err.message);
  }
  for (int f = 0; f < s.nforce; f++)
    out->triangle_force += isfinite(s.force_on[f].z) ? tdm_norm(s.force_on[f]) : 0;
  for (int c = 0; k->contacts && c < s.ncontact; c++)
    out->contact_force += fabs(s.contact[c].force);
  s.with_contacts = true; /* then rank 0 has the whole state */
  ck_assert_msg(!dem_engine_snapshot(e, &s, &err), "%s", err.message);
  save_state(out, dem_engine_data(e), &assignment);
  json_decref(assignment.scene);
  out->nparticle = dem_engine_data(e)->state.nparticle;
  out->moves = dem_engine_data(e)->work.homes.nmove;
  ck_assert(!dem_engine_work(e, out->work, &err));
  tdm_snapshot_free(&s);
  tdm_scenery_free(&scenery);
  dem_engine_destroy(&e);
}

static inline void let_go(outcome *out) {
  tdm_view_bytes_free(&out->seen);
  free(out->bytes);
  free(out->channel);
  free(out->load);
  free(out->body);
}

static inline void ck_same(const outcome *a, const outcome *b, int size) {
  const size_t n = (size_t)a->kind->nwindow;
  ck_assert_int_eq(a->nchannel, b->nchannel);
  for (size_t q = 0; q < n * (size_t)a->nchannel; q++)
    ck_assert_msg(memcmp(&a->channel[q], &b->channel[q], sizeof(double)) == 0,
                  "channel %zu of window %zu is %.17g on %d ranks, %.17g on one", q % (size_t)a->nchannel,
                  q / (size_t)a->nchannel, b->channel[q], size, a->channel[q]);
  ck_assert_mem_eq(a->load, b->load, n * sizeof *a->load);
  ck_assert_mem_eq(a->body, b->body, n * sizeof *a->body);
  ck_assert_uint_eq(a->size, b->size);
  ck_assert_msg(memcmp(a->bytes, b->bytes, a->size) == 0, "the states of 1 and %d ranks differ", size);
  ck_assert_uint_eq(a->seen.size, b->seen.size);
  ck_assert_msg(memcmp(a->seen.data, b->seen.data, a->seen.size) == 0, "what 1 and %d ranks show differs", size);
  ck_assert(a->contact_force == b->contact_force && a->triangle_force == b->triangle_force);
}

static inline void run_on(int size, outcome *on) {
  dem_homes_clock = on->restless ? erratic_clock : tdm_clock;
  on_ranks(size, lead, on);
  dem_homes_clock = tdm_clock;
}

/* What ranks did: each exchange has two sides, and homes add up to the whole, on any number of ranks: `sums`
 * (particles, contacts) are 0 at first. */
static inline void ck_work(const outcome *on, int size, double sums[2]) {
  double particles = 0, contacts = 0, messages = 0, visitors = 0;
  for (int r = 0; r < size; r++) {
    const dem_rank_work *w = &on->work[r], *first = &on->work[0];
    ck_assert_double_eq(w->steps, (on->kind->tries ? 2 : 1) * on->kind->nwindow * on->kind->nstep);
    ck_assert_double_ge(w->exchanged.reductions, w->steps);
    ck_assert_double_ge(w->exchanged.gathers, w->steps);
    ck_assert_double_eq(w->exchanged.reductions, first->exchanged.reductions);
    ck_assert_double_eq(w->exchanged.gathered_bytes, first->exchanged.gathered_bytes);
    ck_assert((w->exchanged.message_bytes > 0) == (w->exchanged.messages > 0));
    ck_assert_double_ge(w->near, w->contacts);
    ck_assert_double_gt(w->seconds, 0);
    particles += w->particles;
    contacts += w->contacts;
    messages += w->exchanged.messages;
    visitors += w->visitors;
  }
  ck_assert(messages > 0 && fmod(messages, 2) == 0 && visitors > 0);
  ck_assert_double_gt(particles, 4000 * on->work[0].steps);
  ck_assert(sums[0] == 0 || (sums[0] == particles && sums[1] == contacts));
  sums[0] = particles;
  sums[1] = contacts;
}

/* alone and on so many ranks (0: the end), with one or two threads each; `check` (may be NULL) sees the run alone */
static inline void compare_on(const int *sizes, const kind *k, void (*check)(const outcome *)) {
  outcome alone = {.kind = k, .threads = 1};
  double sums[2] = {0};
  lead(&alone);
  if (check)
    check(&alone);
  for (int s = 0; sizes[s]; s++) {
    outcome on = {.kind = k, .threads = 2 - s % 2, .restless = sizes[s] == 2};
    run_on(sizes[s], &on);
    ck_assert_msg(!on.restless || k->stays || on.moves > 1, "homes moved %d times", on.moves);
    ck_same(&alone, &on, sizes[s]);
    ck_work(&on, sizes[s], sums);
    let_go(&on);
  }
  let_go(&alone);
}

#endif
