/* One engine on several ranks: see orders.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/adapter/orders.h"

#include "dem/state/data.h"
#include "protocol/version.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double PATIENCE = 10; /* of a rank that failed, with those that did not [s] */

static _Thread_local const dem_ranks *ranks;

void dem_orders_join(const dem_ranks *own) {
  ranks = own;
}

const dem_ranks *dem_orders_ranks(void) {
  return ranks;
}

static bool leads(void) {
  return ranks && ranks->rank == 0;
}

/* ---- are the ranks alike? ---- */

dem_rank_build dem_rank_build_here(void) {
  dem_rank_build here = {.order = 0x01020304, .size = sizeof(dem_state)};
  for (int k = 1; k <= 100; k++) /* by which the bodies move that each rank moves */
    here.number += sin(k) + cos(3.1 * k) + exp(0.01 * k) + pow(k, 0.3) + atan2(k, 7);
  snprintf(here.version, sizeof here.version, "%s", TDM_VERSION);
  return here;
}

uint64_t dem_rank_build_program(void) {
  uint64_t hash = 0xcbf29ce484222325u; /* FNV-1a */
  unsigned char bytes[65536];
  FILE *f = fopen("/proc/self/exe", "rb");
  if (!f)
    return 0;
  for (size_t n; (n = fread(bytes, 1, sizeof bytes, f)) > 0;)
    for (size_t k = 0; k < n; k++)
      hash = (hash ^ bytes[k]) * 0x100000001b3u;
  fclose(f);
  return hash;
}

const char *dem_ranks_differ(const dem_ranks *all, const dem_rank_build *own) {
  dem_rank_build first = *own;
  all->broadcast(&first, sizeof first);
  double other = memcmp(&first, own, sizeof first) != 0;
  all->largest(&other, 1);
  return other > 0 ? "the ranks run different builds of tandem, or on machines of different kinds; install the same "
                     "program on machines of one kind"
                   : NULL; /* bytes of a 1 in another order are more than 0, too */
}

/* ---- an order as bytes: ranks run the same program on machines of one kind ---- */

typedef struct {
  dem_order_kind kind;
  int number;
} head;

/* An order that is being written, or read. */
typedef struct {
  FILE *file;
  char *data;
  size_t size;
} order;

static void no_memory(void) {
  ranks->abandon("no memory for the orders between ranks");
}

/* *o stays where it is until it is sent: the file writes to it */
static void order_write(order *o, dem_order_kind kind, int number) {
  const head h = {kind, number};
  *o = (order){0};
  o->file = open_memstream(&o->data, &o->size);
  if (!o->file)
    no_memory();
  fwrite(&h, sizeof h, 1, o->file);
}

static void put(order *o, const void *data, size_t size) {
  if (size > 0)
    fwrite(data, size, 1, o->file);
}

static void put_text(order *o, const char *text) {
  const size_t size = text ? strlen(text) + 1 : 0;
  put(o, &size, sizeof size);
  put(o, text, size);
}

static void order_send(order *o) {
  if (fclose(o->file) != 0)
    no_memory();
  ranks->broadcast(&o->size, sizeof o->size);
  ranks->broadcast(o->data, o->size);
  free(o->data);
}

static order order_receive(head *h) {
  order o = {0};
  ranks->broadcast(&o.size, sizeof o.size);
  o.data = malloc(o.size);
  if (!o.data)
    no_memory();
  ranks->broadcast(o.data, o.size);
  o.file = fmemopen(o.data, o.size, "r");
  if (!o.file)
    no_memory();
  if (fread(h, sizeof *h, 1, o.file) != 1)
    ranks->abandon("an order of rank 0 is incomplete");
  return o;
}

static void get(order *o, void *data, size_t size) {
  if (size > 0 && fread(data, size, 1, o->file) != 1)
    ranks->abandon("an order of rank 0 is incomplete");
}

/* an array, the caller's to free; never NULL */
static void *get_new(order *o, size_t n, size_t size) {
  void *data = calloc(n + 1, size);
  if (!data)
    no_memory();
  get(o, data, n * size);
  return data;
}

static char *get_text(order *o) {
  size_t size;
  get(o, &size, sizeof size);
  return size > 0 ? get_new(o, size, 1) : NULL;
}

static void order_free(order *o) {
  fclose(o->file);
  free(o->data);
}

void dem_orders_give(dem_order_kind kind, int number) {
  if (!leads())
    return;
  order o;
  order_write(&o, kind, number);
  order_send(&o);
}

/* ---- create ---- */

void dem_orders_create(const tdm_assignment *a) {
  if (!leads())
    return;
  order o;
  order_write(&o, DEM_ORDER_CREATE, 0);
  char *scene = json_dumps(a->scene, JSON_COMPACT | JSON_REAL_PRECISION(17));
  if (!scene)
    no_memory();
  put(&o, a, sizeof *a);
  put_text(&o, scene);
  put(&o, a->body, (size_t)a->nbody * sizeof *a->body);
  for (int b = 0; b < a->nbody; b++) {
    put_text(&o, a->body[b].name);
    put_text(&o, a->body[b].mesh);
  }
  free(scene);
  order_send(&o);
}

static void follow_create(order *o, dem_engine **engine) {
  tdm_assignment a;
  tdm_error err = {0};
  get(o, &a, sizeof a);
  char *scene = get_text(o);
  tdm_assigned_body *body = get_new(o, (size_t)a.nbody, sizeof *body);
  for (int b = 0; b < a.nbody; b++) {
    body[b].name = get_text(o);
    body[b].mesh = get_text(o);
  }
  a.body = body;
  a.scene = json_loads(scene, 0, NULL);
  if (!a.scene)
    no_memory();
  dem_engine_create(engine, &a, NULL, &err);
  json_decref(a.scene);
  for (int b = 0; b < a.nbody; b++) {
    free((char *)body[b].name);
    free((char *)body[b].mesh);
  }
  free(body);
  free(scene);
}

/* ---- advance ---- */

/* A window without what its pointers point to, and which results are wanted. */
typedef struct {
  dem_window window;
  int ncoupled, nnode;
  bool carried, followed, load, body, further, energy, channel, sample_load;
} window_head;

static void put_nodes(order *o, const tdm_nodes *nodes) {
  put(o, nodes, sizeof *nodes);
  put(o, nodes->time, (size_t)nodes->nnode * sizeof *nodes->time);
  put(o, nodes->state, (size_t)(nodes->nnode * nodes->nbody) * sizeof *nodes->state);
}

static tdm_nodes get_nodes(order *o) {
  tdm_nodes nodes;
  get(o, &nodes, sizeof nodes);
  nodes.time = get_new(o, (size_t)nodes.nnode, sizeof *nodes.time);
  nodes.state = get_new(o, (size_t)(nodes.nnode * nodes.nbody), sizeof *nodes.state);
  return nodes;
}

static void free_nodes(const tdm_nodes *nodes) {
  free(nodes->time);
  free(nodes->state);
}

static void put_mechanism(order *o, const dem_mechanism *m, int ncoupled) {
  const size_t k = (size_t)ncoupled, n = tdm_mobility_doubles(&m->proxy.mobility);
  double *block = malloc((n + 1) * sizeof *block);
  if (!block)
    no_memory();
  tdm_mobility_copy(block, &m->proxy.mobility);
  put(o, m->start, k * sizeof *m->start);
  put(o, m->proxy.acceleration, 6 * k * sizeof *m->proxy.acceleration);
  put(o, m->proxy.load, k * sizeof *m->proxy.load);
  put(o, m->proxy.correction, 12 * k * sizeof *m->proxy.correction);
  put(o, &m->proxy.mobility, sizeof m->proxy.mobility);
  put(o, block, n * sizeof *block);
  put_nodes(o, &m->path);
  free(block);
}

/* *block is the mobility's */
static dem_mechanism get_mechanism(order *o, int ncoupled, double **block) {
  const size_t k = (size_t)ncoupled;
  dem_mechanism m;
  m.start = get_new(o, k, sizeof *m.start);
  m.proxy.acceleration = get_new(o, 6 * k, sizeof *m.proxy.acceleration);
  m.proxy.load = get_new(o, k, sizeof *m.proxy.load);
  m.proxy.correction = get_new(o, 12 * k, sizeof *m.proxy.correction);
  get(o, &m.proxy.mobility, sizeof m.proxy.mobility);
  *block = get_new(o, tdm_mobility_doubles(&m.proxy.mobility), sizeof **block);
  tdm_mobility_point(&m.proxy.mobility, *block);
  m.path = get_nodes(o);
  return m;
}

static void free_mechanism(const dem_mechanism *m, double *block) {
  free((void *)m->start);
  free((void *)m->proxy.acceleration);
  free((void *)m->proxy.load);
  free((void *)m->proxy.correction);
  free(block);
  free_nodes(&m->path);
}

void dem_orders_advance(const dem_window *w, const dem_outcome *out, int ncoupled) {
  if (!leads())
    return;
  const bool followed = w->path && !w->mechanism;
  const window_head h = {.window = *w,
                         .ncoupled = ncoupled,
                         .carried = w->mechanism,
                         .followed = followed,
                         .nnode = followed && ncoupled > 0 ? w->path[0].path.nnode : 0,
                         .load = out->load,
                         .body = out->body,
                         .further = out->further,
                         .energy = out->energy,
                         .channel = out->channel,
                         .sample_load = out->sample_load};
  order o;
  order_write(&o, DEM_ORDER_ADVANCE, 0);
  put(&o, &h, sizeof h);
  put(&o, w->sample_time, (size_t)w->nsample * sizeof *w->sample_time);
  if (followed)
    put(&o, w->path, (size_t)ncoupled * sizeof *w->path);
  if (h.nnode > 0) /* the same of all bodies */
    put_nodes(&o, &w->path[0].path);
  if (w->mechanism)
    put_mechanism(&o, w->mechanism, ncoupled);
  order_send(&o);
}

static void *room(bool wanted, size_t n, size_t size) {
  void *array = wanted ? calloc(n + 1, size) : NULL;
  if (wanted && !array)
    no_memory();
  return array;
}

/* with results that nobody looks at: whether they are wanted is part of what is done */
static void advance(dem_engine *engine, const dem_window *w, const window_head *h) {
  const size_t k = (size_t)h->ncoupled, n = (size_t)w->nsample;
  tdm_energy energy;
  tdm_error err = {0};
  const dem_outcome out = {.load = room(h->load, k, sizeof *out.load),
                           .body = room(h->body, k, sizeof *out.body),
                           .further = room(h->further, k * TDM_FURTHER, sizeof *out.further),
                           .energy = h->energy ? &energy : NULL,
                           .channel =
                               room(h->channel, n * (size_t)dem_engine_start(engine)->nchannel, sizeof *out.channel),
                           .sample_load = room(h->sample_load, n * k, sizeof *out.sample_load)};
  dem_engine_advance(engine, w, &out, &err);
  free(out.load);
  free(out.body);
  free(out.further);
  free(out.channel);
  free(out.sample_load);
}

static void follow_advance(order *o, dem_engine *engine) {
  window_head h;
  get(o, &h, sizeof h);
  dem_window w = h.window;
  double *sample_time = get_new(o, (size_t)w.nsample, sizeof *sample_time), *block = NULL;
  dem_path *path = h.followed ? get_new(o, (size_t)h.ncoupled, sizeof *path) : NULL;
  tdm_nodes nodes = {0};
  dem_mechanism mechanism = {0};
  if (h.nnode > 0)
    nodes = get_nodes(o);
  for (int c = 0; path && c < h.ncoupled; c++)
    path[c].path = nodes;
  if (h.carried)
    mechanism = get_mechanism(o, h.ncoupled, &block);
  w.sample_time = sample_time;
  w.path = path;
  w.mechanism = h.carried ? &mechanism : NULL;
  advance(engine, &w, &h);
  free_mechanism(&mechanism, block);
  free_nodes(&nodes);
  free(path);
  free(sample_time);
}

/* ---- frames ---- */

void dem_orders_write(const tdm_shared_frame *frame) {
  if (!leads())
    return;
  order o;
  order_write(&o, DEM_ORDER_WRITE, 0);
  put(&o, frame, sizeof *frame);
  order_send(&o);
}

static void follow_write(order *o, dem_engine *engine, const tdm_snapshot *share) {
  tdm_shared_frame frame;
  tdm_error err = {0};
  get(o, &frame, sizeof frame);
  dem_engine_write_shares(engine, share, &frame, &err);
}

/* ---- both sides ---- */

/* All ranks get the error of the first one that has any. */
static void share_error(tdm_error *err) {
  double failed = err->status ? ranks->size - ranks->rank : 0;
  ranks->largest(&failed, 1);
  const int first = ranks->size - (int)failed;
  int *place = malloc(((size_t)ranks->size + 1) * sizeof *place);
  tdm_error its = *err;
  if (!place)
    no_memory();
  for (int r = 0; r <= ranks->size; r++)
    place[r] = r > first;
  ranks->gather(&its, sizeof its, place);
  free(place);
  tdm_fail(err, its.status, NULL, "rank %d of %d: %s%s%s", first, ranks->size, its.path, its.path[0] ? ": " : "",
           its.message);
}

/* patience: of a rank that failed, with those that did not [s]; < 0: it waits for ever */
static tdm_status meet(tdm_error *err, double patience) {
  if (!ranks)
    return err->status;
  int worst = err->status ? 1 : 0;
  char message[TDM_PATH_MAX + TDM_MESSAGE_MAX + 64];
  snprintf(message, sizeof message, "rank %d of %d: %s%s%s", ranks->rank, ranks->size, err->path,
           err->path[0] ? ": " : "", err->message);
  if (!ranks->meet(&worst, worst ? patience : -1))
    ranks->abandon(message);
  if (worst)
    share_error(err);
  return err->status;
}

tdm_status dem_orders_done(tdm_error *err) {
  return meet(err, PATIENCE);
}

tdm_status dem_orders_written(tdm_error *err) {
  return meet(err, -1);
}

/* what is to be seen: all ranks look together, and this one has its share until it is written */
typedef struct {
  tdm_scenery scenery;
  tdm_snapshot snapshot;
} sight;

static void follow_work(dem_engine *engine) {
  dem_rank_work *work = room(true, (size_t)ranks->size, sizeof *work);
  tdm_error err = {0};
  dem_engine_work(engine, work, &err);
  free(work);
}

static void obey(const head *h, order *o, dem_engine **engine, sight *seen) {
  tdm_error err = {0};
  switch (h->kind) {
  case DEM_ORDER_CREATE:
    follow_create(o, engine);
    break;
  case DEM_ORDER_ADVANCE:
    follow_advance(o, *engine);
    break;
  case DEM_ORDER_SAVE:
    dem_engine_save(*engine, h->number, &err);
    break;
  case DEM_ORDER_RESTORE:
    dem_engine_restore(*engine, h->number, &err);
    break;
  case DEM_ORDER_SCENERY:
    dem_engine_scenery(*engine, &seen->scenery, &err);
    break;
  case DEM_ORDER_SNAPSHOT:
    seen->snapshot.with_contacts = h->number;
    dem_engine_snapshot(*engine, &seen->snapshot, &err);
    break;
  case DEM_ORDER_SHARE:
    seen->snapshot.with_contacts = h->number;
    dem_engine_share(*engine, &seen->snapshot, &err);
    break;
  case DEM_ORDER_WRITE:
    follow_write(o, *engine, &seen->snapshot);
    break;
  case DEM_ORDER_WORK:
    follow_work(*engine);
    break;
  case DEM_ORDER_DESTROY:
    dem_engine_destroy(engine);
    break;
  case DEM_ORDER_END:
    break;
  }
}

void dem_orders_follow(void) {
  dem_engine *engine = NULL;
  sight seen = {0};
  head h;
  do {
    order o = order_receive(&h);
    obey(&h, &o, &engine, &seen);
    order_free(&o);
  } while (h.kind != DEM_ORDER_END);
  dem_engine_destroy(&engine);
  tdm_scenery_free(&seen.scenery);
  tdm_snapshot_free(&seen.snapshot);
}
