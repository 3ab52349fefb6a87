/* Messages: see message.h. */
/* SPDX-License-Identifier: MIT */
#include "protocol/wire/message.h"

#include "protocol/base/memory.h"
#include "protocol/scene/json.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "frames are written as they lie in memory: little-endian");

static const uint8_t magic[4] = {'T', 'N', 'D', 'M'};

/* ---- buffers ---- */

void tdm_frame_free(tdm_frame *frame) {
  free(frame->data);
  *frame = (tdm_frame){0};
}

/* Make room for `size` bytes; the content is kept. */
static tdm_status frame_reserve(tdm_frame *frame, size_t size, tdm_error *err) {
  if (size <= frame->capacity)
    return TDM_OK;
  size_t capacity = size + size / 2 + 256;
  uint8_t *data = realloc(frame->data, capacity);
  if (!data)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a message of %zu bytes", size);
  frame->data = data;
  frame->capacity = capacity;
  return TDM_OK;
}

/* A cursor over a buffer that is large enough. */
static uint8_t *put(uint8_t *at, const void *data, size_t size) {
  if (size)
    memcpy(at, data, size);
  return at + size;
}

static uint8_t *put_u32(uint8_t *at, uint32_t value) {
  return put(at, &value, 4);
}

static uint8_t *put_u64(uint8_t *at, uint64_t value) {
  return put(at, &value, 8);
}

static uint8_t *put_f64(uint8_t *at, double value) {
  return put(at, &value, 8);
}

static const uint8_t *get(const uint8_t *at, void *out, size_t size) {
  memcpy(out, at, size);
  return at + size;
}

/* ---- header ---- */

const char *tdm_message_name(int type) {
  switch (type) {
#define X(name, number, from) \
  case number:                \
    return #name;
    TDM_MESSAGE_LIST(X)
#undef X
  }
  return "?";
}

/* bytes of a frame at most */
static size_t largest(int type) {
  return type == TDM_VIEW ? TDM_VIEW_MAX : TDM_FRAME_MAX;
}

static tdm_status header_write(tdm_frame *frame, tdm_message_type type, uint64_t window, size_t payload,
                               tdm_error *err) {
  if (payload + TDM_HEADER_BYTES > largest(type))
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "a %s of %zu bytes is larger than the protocol's limit of %zu",
                    tdm_message_name(type), payload, largest(type));
  tdm_status status = frame_reserve(frame, TDM_HEADER_BYTES + payload, err);
  if (status != TDM_OK)
    return status;
  frame->size = TDM_HEADER_BYTES + payload;
  uint16_t words[2] = {TDM_PROTOCOL_VERSION, (uint16_t)type};
  uint8_t *at = put(frame->data, magic, 4);
  at = put(at, words, 4);
  at = put_u64(at, window);
  at = put_u32(at, (uint32_t)payload);
  put_u32(at, 0);
  return TDM_OK;
}

tdm_status tdm_header_read(tdm_header *header, const void *frame, size_t size, tdm_error *err) {
  uint16_t words[2];
  uint32_t payload, reserved;
  if (size < TDM_HEADER_BYTES)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed frame: %zu bytes, shorter than a header (%d)", size,
                    TDM_HEADER_BYTES);
  if (memcmp(frame, magic, 4) != 0)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed frame: it does not begin with TNDM");
  const uint8_t *at = (const uint8_t *)frame + 4;
  at = get(at, words, 4);
  at = get(at, &header->window, 8);
  at = get(at, &payload, 4);
  at = get(at, &reserved, 4);
  if (words[0] != TDM_PROTOCOL_VERSION)
    return tdm_fail(err, TDM_ERR_VERSION, NULL,
                    "it speaks protocol version %u, here it is %u; use a solver and a tandem of the same version",
                    words[0], TDM_PROTOCOL_VERSION);
  if (size > largest(words[1]))
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "oversized frame: %zu bytes, the limit is %zu", size,
                    largest(words[1]));
  if (payload != size - TDM_HEADER_BYTES)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed frame: %u bytes of payload announced, %zu came", payload,
                    size - TDM_HEADER_BYTES);
  if (tdm_message_name(words[1])[0] == '?')
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed frame: %u is no message type", words[1]);
  header->type = (tdm_message_type)words[1];
  header->payload = at;
  header->size = payload;
  return TDM_OK;
}

/* ---- control messages ---- */

/* A message of which a part could not be made, for lack of memory, is not sent: its receiver would take it for another
 * one. What ends a run is always sent. */
static tdm_status check_complete(tdm_message_type type, tdm_error *err) {
  static _Thread_local unsigned long before; /* notes when the last message was written */
  const unsigned long now = tdm_memory_notes();
  const bool complete = now == before || type == TDM_ERROR || type == TDM_FINISH || type == TDM_HEARTBEAT;
  before = type == TDM_HEARTBEAT ? before : now;
  return complete ? TDM_OK : tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a %s", tdm_message_name(type));
}

tdm_status tdm_control_write(tdm_frame *frame, tdm_message_type type, uint64_t window, const json_t *json,
                             tdm_error *err) {
  if (check_complete(type, err))
    return TDM_ERR_MEMORY;
  const unsigned long before = tdm_memory_notes();
  size_t n = json ? json_dumpb(json, NULL, 0, JSON_COMPACT) : 0;
  if (json && n == 0 && tdm_memory_notes() > before)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a %s", tdm_message_name(type));
  if (json && n == 0)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "a %s cannot be written as JSON", tdm_message_name(type));
  if (header_write(frame, type, window, n, err) != TDM_OK)
    return err ? err->status : TDM_ERR_PROTOCOL;
  if (n && json_dumpb(json, (char *)frame->data + TDM_HEADER_BYTES, n, JSON_COMPACT) != n)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a %s", tdm_message_name(type));
  return TDM_OK;
}

tdm_status tdm_control_read(const tdm_header *header, json_t **json, tdm_error *err) {
  json_error_t json_error;
  const unsigned long before = tdm_memory_notes();
  *json = header->size ? json_loadb((const char *)header->payload, header->size, JSON_REJECT_DUPLICATES, &json_error)
                       : json_object();
  if (!*json && tdm_memory_notes() > before)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory to read a %s", tdm_message_name(header->type));
  if (!*json)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed %s: its payload is not JSON: %s",
                    tdm_message_name(header->type), json_error.text);
  if (!json_is_object(*json)) {
    json_decref(*json);
    *json = NULL;
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed %s: its payload is not a JSON object",
                    tdm_message_name(header->type));
  }
  return TDM_OK;
}

json_t *tdm_numbers_to_json(const double *values, int n) {
  json_t *array = json_array();
  for (int i = 0; i < n; i++)
    json_array_append_new(array, tdm_number_to_json(values[i]));
  return array;
}

json_t *tdm_error_to_json(const tdm_error *err) {
  json_t *json = json_object();
  json_object_set_new(json, "status", json_string(tdm_status_name(err->status)));
  json_object_set_new(json, "path", json_string(err->path));
  json_object_set_new(json, "message", json_string(err->message));
  return json;
}

void tdm_error_from_json(const json_t *json, tdm_error *err) {
  const char *status = json_string_value(json_object_get(json, "status"));
  const char *path = json_string_value(json_object_get(json, "path"));
  const char *message = json_string_value(json_object_get(json, "message"));
  tdm_status code = TDM_ERR_NUMERIC;
  for (int i = 1; status && i < TDM_STATUS_COUNT; i++)
    if (strcmp(status, tdm_status_name((tdm_status)i)) == 0)
      code = (tdm_status)i;
  tdm_fail(err, code, path, "%s", message ? message : "no reason given");
}

/* ---- VIEW ---- */

tdm_status tdm_view_write(tdm_frame *frame, uint64_t window, const tdm_scenery *scenery, const tdm_snapshot *snapshot,
                          tdm_error *err) {
  if (frame_reserve(frame, TDM_HEADER_BYTES, err) != TDM_OK)
    return TDM_ERR_MEMORY;
  tdm_view_bytes bytes = {frame->data, TDM_HEADER_BYTES, frame->capacity};
  tdm_status status =
      scenery ? tdm_scenery_encode(scenery, false, &bytes, err) : tdm_snapshot_encode(snapshot, false, &bytes, err);
  frame->data = bytes.data;
  frame->capacity = bytes.capacity;
  if (status != TDM_OK)
    return status;
  return header_write(frame, TDM_VIEW, window, bytes.size - TDM_HEADER_BYTES, err);
}

/* ---- STEP and RESULT ---- */

/* what a RESULT has behind its channels: bits of the u16 at 36 */
enum {
  HAS_ACCELERATION = 1,
  HAS_MOBILITY = 2,
  HAS_INTERFACE = 4,
  HAS_ENERGY = 8,
  HAS_FURTHER = 16,
  HAS_PATH = 32,
  HAS_ALL = 63
};

/* what a STEP has behind its sample times: bits of the u16 at 40 */
enum { HAS_PROXY = 1, HAS_AHEAD = 2, IS_SEEN = 4, STEP_ALL = 7 };

_Static_assert(sizeof(tdm_interface) == TDM_INTERFACE_DOUBLES * sizeof(double), "sent as doubles");

/* Cut the next n doubles off a block. */
static void *cut(double **at, size_t n) {
  double *part = *at;
  *at += n;
  return part;
}

/* ---- the reduced model ---- */

enum { MOBILITY_PARTS = 9 };

/* The arrays of a reduced model in wire order, with their sizes. */
static void mobility_parts(tdm_mobility *m, double **part[MOBILITY_PARTS], size_t size[MOBILITY_PARTS]) {
  const size_t k = 6 * (size_t)m->nbody, f = (size_t)m->nfree;
  double **const parts[MOBILITY_PARTS] = {&m->Y,         &m->velocity, &m->acceleration, &m->J,     &m->B,
                                          &m->stiffness, &m->damping,  &m->J_rate,       &m->B_rate};
  const size_t sizes[MOBILITY_PARTS] = {k * k, f, f, k * f, f * k, f * f, f * f, k * f, f * k};
  memcpy(part, parts, sizeof parts);
  memcpy(size, sizes, sizeof sizes);
}

size_t tdm_mobility_doubles(const tdm_mobility *mobility) {
  tdm_mobility m = *mobility;
  double **part[MOBILITY_PARTS];
  size_t size[MOBILITY_PARTS], sum = 0;
  mobility_parts(&m, part, size);
  for (int i = 0; i < MOBILITY_PARTS; i++)
    sum += size[i];
  return sum;
}

void tdm_mobility_point(tdm_mobility *mobility, double *block) {
  double **part[MOBILITY_PARTS];
  size_t size[MOBILITY_PARTS];
  mobility_parts(mobility, part, size);
  for (int i = 0; i < MOBILITY_PARTS; i++)
    *part[i] = cut(&block, size[i]);
}

void tdm_mobility_copy(double *block, const tdm_mobility *mobility) {
  tdm_mobility m = *mobility;
  double **part[MOBILITY_PARTS];
  size_t size[MOBILITY_PARTS];
  mobility_parts(&m, part, size);
  for (int i = 0; i < MOBILITY_PARTS; i++)
    if (size[i] > 0)
      memcpy(cut(&block, size[i]), *part[i], size[i] * sizeof(double));
}

/* ---- paths ---- */

static size_t path_doubles(int nnode, int nbody) {
  return (size_t)nnode * (1 + (size_t)nbody * TDM_STATE_DOUBLES);
}

static uint8_t *put_path(uint8_t *at, const tdm_nodes *path) {
  at = put(at, path->time, (size_t)path->nnode * sizeof(double));
  return put(at, path->state, (size_t)path->nnode * (size_t)path->nbody * sizeof(tdm_state));
}

static tdm_nodes cut_path(double **at, int nnode, int nbody) {
  tdm_nodes path = {.nnode = nnode, .nbody = nbody};
  path.time = cut(at, (size_t)nnode);
  path.state = cut(at, (size_t)nnode * (size_t)nbody * TDM_STATE_DOUBLES);
  return path;
}

static double rounding_of(double t0, double t1) {
  return 1e-9 * (t1 - t0) + 1e-15 * fabs(t1);
}

/* Times come one after the other in (t0, t1], but for rounding at t1. */
static bool is_in_order(const double *time, int n, double t0, double t1) {
  double before = t0;
  for (int i = 0; i < n; before = time[i++])
    if (!(time[i] > before))
      return false;
  return n == 0 || before <= t1 + rounding_of(t0, t1);
}

/* ---- STEP ---- */

enum { PROXY_DOUBLES = 6 + TDM_WRENCH_DOUBLES + 12 }; /* a body, besides the reduced model */

/* doubles behind the fixed block */
static size_t step_doubles(const tdm_step *s) {
  size_t n = 2 * (size_t)s->nstate * TDM_STATE_DOUBLES + (size_t)s->nbody * (size_t)s->nload * TDM_WRENCH_DOUBLES +
             (size_t)s->nsample + (s->ahead > 0) + path_doubles(s->path.nnode, s->nbody);
  if (s->has_proxy)
    n += (size_t)s->nbody * PROXY_DOUBLES + tdm_mobility_doubles(&s->proxy.mobility);
  return n;
}

static tdm_status check_counts(const tdm_header *header, const uint32_t *counts, int n, tdm_error *err) {
  for (int i = 0; i < n; i++)
    if (counts[i] > TDM_COUNT_MAX)
      return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed %s: a count of %u", tdm_message_name(header->type),
                      counts[i]);
  return TDM_OK;
}

/* The arrays behind the fixed block, copied to where doubles are aligned. */
static tdm_status copy_doubles(tdm_frame *store, const tdm_header *header, size_t fixed, size_t ndouble,
                               tdm_error *err) {
  if (header->size != fixed + 8 * ndouble)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed %s: %zu bytes, its counts need %zu",
                    tdm_message_name(header->type), header->size, fixed + 8 * ndouble);
  if (frame_reserve(store, 8 * ndouble + 8, err) != TDM_OK)
    return TDM_ERR_MEMORY;
  store->size = 8 * ndouble;
  if (ndouble)
    memcpy(store->data, header->payload + fixed, 8 * ndouble);
  return TDM_OK;
}

tdm_status tdm_step_write(tdm_frame *frame, const tdm_step *s, tdm_error *err) {
  assert(s->nstate == 0 || s->nstate == s->nbody);
  assert(!s->has_proxy || (s->nstate == s->nbody && s->proxy.mobility.nbody == s->nbody));
  assert(s->path.nnode == 0 || (s->nstate > 0 && s->path.nbody == s->nbody));
  tdm_status status = header_write(frame, TDM_STEP, s->window, TDM_STEP_BYTES + 8 * step_doubles(s), err);
  if (status != TDM_OK)
    return status;
  uint8_t *at = frame->data + TDM_HEADER_BYTES;
  at = put_f64(at, s->t0);
  at = put_f64(at, s->t1);
  at = put_u64(at, s->nstep);
  at = put_u32(at, (uint32_t)s->nbody);
  at = put_u32(at, (uint32_t)s->nstate);
  at = put_u32(at, (uint32_t)s->nload);
  at = put_u32(at, (uint32_t)s->nsample);
  const uint16_t extra[2] = {
      (uint16_t)((s->has_proxy ? HAS_PROXY : 0) | (s->ahead > 0 ? HAS_AHEAD : 0) | (s->seen ? IS_SEEN : 0)),
      (uint16_t)(s->has_proxy ? s->proxy.mobility.nfree : 0)};
  at = put(at, extra, sizeof extra);
  at = put_u32(at, (uint32_t)s->path.nnode);
  at = put(at, s->start, (size_t)s->nstate * sizeof(tdm_state));
  at = put(at, s->end, (size_t)s->nstate * sizeof(tdm_state));
  at = put(at, s->load, (size_t)s->nbody * (size_t)s->nload * sizeof(tdm_wrench));
  at = put(at, s->sample_time, (size_t)s->nsample * sizeof(double));
  if (s->ahead > 0)
    at = put_f64(at, s->ahead);
  at = put_path(at, &s->path);
  if (!s->has_proxy)
    return TDM_OK;
  at = put(at, s->proxy.acceleration, 6 * (size_t)s->nbody * sizeof(double));
  at = put(at, s->proxy.load, (size_t)s->nbody * sizeof(tdm_wrench));
  at = put(at, s->proxy.correction, 12 * (size_t)s->nbody * sizeof(double));
  /* a frame's doubles lie at multiples of 8 behind malloc's alignment */
  tdm_mobility_copy((double *)(void *)at, &s->proxy.mobility);
  return TDM_OK;
}

tdm_status tdm_step_read(tdm_step *s, const tdm_header *header, tdm_frame *store, tdm_error *err) {
  uint32_t counts[4], nnode;
  uint16_t extra[2];
  *s = (tdm_step){.window = header->window};
  if (header->size < TDM_STEP_BYTES)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed STEP: %zu bytes", header->size);
  const uint8_t *at = get(header->payload, &s->t0, 8);
  at = get(at, &s->t1, 8);
  at = get(at, &s->nstep, 8);
  at = get(at, counts, sizeof counts);
  at = get(at, extra, sizeof extra);
  get(at, &nnode, sizeof nnode);
  tdm_status status = check_counts(header, counts, 4, err);
  if (status != TDM_OK)
    return status;
  s->nbody = (int)counts[0];
  s->nstate = (int)counts[1];
  s->nload = (int)counts[2];
  s->nsample = (int)counts[3];
  if (!(s->t1 > s->t0) || !isfinite(s->t1 - s->t0) || s->nstep == 0 || (s->nstate != 0 && s->nstate != s->nbody))
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed STEP: a window from %g s to %g s in %llu steps", s->t0,
                    s->t1, (unsigned long long)s->nstep);
  s->has_proxy = extra[0] & HAS_PROXY;
  s->proxy.mobility = (tdm_mobility){.nbody = s->nbody, .nfree = extra[1]};
  if (extra[0] > STEP_ALL || extra[1] > (s->has_proxy ? TDM_FREE_MAX : 0) || (s->has_proxy && s->nstate == 0))
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed STEP: %u, %u where the proxy is announced", extra[0],
                    extra[1]);
  if (nnode > TDM_NODES_MAX || (nnode > 0 && s->nstate == 0))
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed STEP: a path of %u nodes; at most %d", nnode,
                    TDM_NODES_MAX);
  s->seen = extra[0] & IS_SEEN;
  s->ahead = extra[0] & HAS_AHEAD; /* there is one: it counts */
  s->path.nnode = (int)nnode;
  status = copy_doubles(store, header, TDM_STEP_BYTES, step_doubles(s), err);
  if (status != TDM_OK)
    return status;
  double *data = (double *)(void *)store->data;
  if (!tdm_finite(data, (int)step_doubles(s)))
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed STEP: a number in it is not finite");
  s->start = cut(&data, (size_t)s->nstate * TDM_STATE_DOUBLES);
  s->end = cut(&data, (size_t)s->nstate * TDM_STATE_DOUBLES);
  s->load = cut(&data, (size_t)s->nbody * (size_t)s->nload * TDM_WRENCH_DOUBLES);
  s->sample_time = cut(&data, (size_t)s->nsample);
  if (s->ahead > 0)
    s->ahead = *(double *)cut(&data, 1);
  s->path = cut_path(&data, (int)nnode, s->nbody);
  if (extra[0] & HAS_AHEAD && !(s->ahead > s->t1))
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed STEP: a path ahead from %g s to %g s", s->t1, s->ahead);
  if (!is_in_order(s->sample_time, s->nsample, s->t0, s->t1))
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed STEP: its sample times are not in order, or not in it");
  if (!is_in_order(s->path.time, (int)nnode, s->t0, s->t1) ||
      (nnode > 0 && s->path.time[nnode - 1] < s->t1 - rounding_of(s->t0, s->t1)))
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed STEP: the nodes of its path are not in order");
  if (s->has_proxy) {
    s->proxy.acceleration = cut(&data, 6 * (size_t)s->nbody);
    s->proxy.load = cut(&data, (size_t)s->nbody * TDM_WRENCH_DOUBLES);
    s->proxy.correction = cut(&data, 12 * (size_t)s->nbody);
    tdm_mobility_point(&s->proxy.mobility, data);
  }
  return TDM_OK;
}

/* ---- RESULT ---- */

/* but for the reduced model and the path */
static size_t result_doubles(const tdm_result *r) {
  size_t sample = (size_t)r->nstate * TDM_STATE_DOUBLES + (size_t)r->nchannel;
  if (r->nload > 0)
    sample += (size_t)r->nbody * TDM_WRENCH_DOUBLES;
  return (size_t)r->nstate * TDM_STATE_DOUBLES + (size_t)r->nbody * (size_t)r->nload * TDM_WRENCH_DOUBLES +
         (size_t)r->nsample * sample + 6 * (size_t)r->nacceleration + (size_t)r->ninterface * TDM_INTERFACE_DOUBLES +
         (r->has_energy ? sizeof(tdm_energy) / sizeof(double) : 0) +
         (size_t)r->nfurther * TDM_FURTHER * TDM_WRENCH_DOUBLES;
}

/* Returns where the reduced model begins. */
static double *result_point(tdm_result *r, double *at) {
  r->state = cut(&at, (size_t)r->nstate * TDM_STATE_DOUBLES);
  r->load = cut(&at, (size_t)r->nbody * (size_t)r->nload * TDM_WRENCH_DOUBLES);
  r->sample_state = cut(&at, (size_t)r->nsample * (size_t)r->nstate * TDM_STATE_DOUBLES);
  r->sample_load = cut(&at, (size_t)r->nsample * (r->nload > 0 ? (size_t)r->nbody : 0) * TDM_WRENCH_DOUBLES);
  r->channel = cut(&at, (size_t)r->nsample * (size_t)r->nchannel);
  r->acceleration = cut(&at, 6 * (size_t)r->nacceleration);
  r->body = cut(&at, (size_t)r->ninterface * TDM_INTERFACE_DOUBLES);
  r->energy = cut(&at, r->has_energy ? sizeof(tdm_energy) / sizeof(double) : 0);
  r->further = cut(&at, (size_t)r->nfurther * TDM_FURTHER * TDM_WRENCH_DOUBLES);
  return at;
}

tdm_status tdm_result_layout(tdm_result *r, tdm_frame *store, tdm_error *err) {
  size_t n = result_doubles(r);
  if (frame_reserve(store, 8 * n + 8, err) != TDM_OK)
    return TDM_ERR_MEMORY;
  store->size = 8 * n;
  memset(store->data, 0, 8 * n);
  result_point(r, (double *)(void *)store->data);
  return TDM_OK;
}

tdm_status tdm_result_write(tdm_frame *frame, const tdm_result *r, tdm_error *err) {
  size_t n = result_doubles(r) + (r->has_mobility ? tdm_mobility_doubles(&r->mobility) : 0) +
             path_doubles(r->path.nnode, r->nbody);
  assert(!r->has_mobility || r->mobility.nbody == r->nbody);
  assert(r->path.nnode == 0 || r->path.nbody == r->nbody);
  tdm_status status = header_write(frame, TDM_RESULT, r->window, TDM_RESULT_BYTES + 8 * n, err);
  if (status != TDM_OK)
    return status;
  uint8_t *at = frame->data + TDM_HEADER_BYTES;
  at = put_f64(at, r->t);
  at = put_f64(at, r->wall);
  at = put_u32(at, (uint32_t)r->nbody);
  at = put_u32(at, (uint32_t)r->nstate);
  at = put_u32(at, (uint32_t)r->nload);
  at = put_u32(at, (uint32_t)r->nsample);
  at = put_u32(at, (uint32_t)r->nchannel);
  const uint16_t extra[2] = {(uint16_t)((r->nacceleration > 0 ? HAS_ACCELERATION : 0) |
                                        (r->has_mobility ? HAS_MOBILITY : 0) | (r->ninterface > 0 ? HAS_INTERFACE : 0) |
                                        (r->has_energy ? HAS_ENERGY : 0) | (r->nfurther > 0 ? HAS_FURTHER : 0) |
                                        (r->path.nnode > 0 ? HAS_PATH : 0)),
                             (uint16_t)(r->has_mobility ? r->mobility.nfree : 0)};
  at = put(at, extra, sizeof extra);
  at = put(at, r->state, (size_t)r->nstate * sizeof(tdm_state));
  at = put(at, r->load, (size_t)r->nbody * (size_t)r->nload * sizeof(tdm_wrench));
  at = put(at, r->sample_state, (size_t)r->nsample * (size_t)r->nstate * sizeof(tdm_state));
  if (r->nload > 0)
    at = put(at, r->sample_load, (size_t)r->nsample * (size_t)r->nbody * sizeof(tdm_wrench));
  at = put(at, r->channel, (size_t)r->nsample * (size_t)r->nchannel * sizeof(double));
  at = put(at, r->acceleration, 6 * (size_t)r->nacceleration * sizeof(double));
  at = put(at, r->body, (size_t)r->ninterface * sizeof *r->body);
  at = put(at, r->energy, r->has_energy ? sizeof *r->energy : 0);
  at = put(at, r->further, (size_t)r->nfurther * TDM_FURTHER * sizeof *r->further);
  if (r->has_mobility) {
    tdm_mobility_copy((double *)(void *)at, &r->mobility);
    at += 8 * tdm_mobility_doubles(&r->mobility);
  }
  put_path(at, &r->path);
  return TDM_OK;
}

/* The path is what is left of the frame behind n doubles: the number of its nodes follows. */
static tdm_status count_nodes(tdm_result *r, const tdm_header *header, size_t n, tdm_error *err) {
  const size_t known = TDM_RESULT_BYTES + 8 * n, node = 8 * path_doubles(1, r->nbody);
  const size_t left = header->size > known ? header->size - known : 0;
  if (left == 0 || left % node != 0 || left / node > TDM_NODES_MAX)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL,
                    "malformed RESULT: %zu bytes are left for a path, whose nodes have %zu bytes each; 1 to %d nodes",
                    left, node, TDM_NODES_MAX);
  r->path.nnode = (int)(left / node);
  return TDM_OK;
}

tdm_status tdm_result_read(tdm_result *r, const tdm_header *header, tdm_frame *store, tdm_error *err) {
  uint32_t counts[5];
  uint16_t extra[2];
  *r = (tdm_result){.window = header->window};
  if (header->size < TDM_RESULT_BYTES)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed RESULT: %zu bytes", header->size);
  const uint8_t *at = get(header->payload, &r->t, 8);
  at = get(at, &r->wall, 8);
  at = get(at, counts, sizeof counts);
  get(at, extra, sizeof extra);
  tdm_status status = check_counts(header, counts, 5, err);
  if (status != TDM_OK)
    return status;
  r->nbody = (int)counts[0];
  r->nstate = (int)counts[1];
  r->nload = (int)counts[2];
  r->nsample = (int)counts[3];
  r->nchannel = (int)counts[4];
  if (r->nstate != 0 && r->nstate != r->nbody)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed RESULT: %d states of %d bodies", r->nstate, r->nbody);
  r->nacceleration = extra[0] & HAS_ACCELERATION ? r->nstate : 0;
  r->has_mobility = extra[0] & HAS_MOBILITY;
  r->ninterface = extra[0] & HAS_INTERFACE ? r->nbody : 0;
  r->has_energy = extra[0] & HAS_ENERGY;
  r->nfurther = extra[0] & HAS_FURTHER ? r->nbody : 0;
  r->mobility = (tdm_mobility){.nbody = r->nbody, .nfree = extra[1]};
  if (extra[0] > HAS_ALL || extra[1] > (r->has_mobility ? TDM_FREE_MAX : 0))
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL,
                    "malformed RESULT: %u, %u where what follows the channels is announced", extra[0], extra[1]);
  size_t n = result_doubles(r) + (r->has_mobility ? tdm_mobility_doubles(&r->mobility) : 0);
  if (extra[0] & HAS_PATH && count_nodes(r, header, n, err) != TDM_OK)
    return err ? err->status : TDM_ERR_PROTOCOL;
  n += path_doubles(r->path.nnode, r->nbody);
  status = copy_doubles(store, header, TDM_RESULT_BYTES, n, err);
  if (status != TDM_OK)
    return status;
  double *rest = result_point(r, (double *)(void *)store->data);
  if (r->has_mobility) {
    tdm_mobility_point(&r->mobility, rest);
    rest += tdm_mobility_doubles(&r->mobility);
  }
  r->path = cut_path(&rest, r->path.nnode, r->nbody);
  return TDM_OK;
}
