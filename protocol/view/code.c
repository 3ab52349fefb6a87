/* Sceneries and snapshots as bytes: see view.h and PROTOCOL.md. */
/* SPDX-License-Identifier: MIT */
#include "protocol/view/view.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "records are written as they lie in memory: little-endian");

static const uint8_t magic[4] = {'T', 'N', 'D', 'V'};
enum { VERSION = 1, HEAD_BYTES = 24, LENGTH_AT = 16, CONTACT_REALS = 7 };

/* ---- writing ---- */

typedef struct {
  tdm_view_bytes *bytes;
  bool single;
  tdm_error *err;
  tdm_status status;
} writer;

void tdm_view_bytes_free(tdm_view_bytes *bytes) {
  free(bytes->data);
  *bytes = (tdm_view_bytes){0};
}

/* room for `size` more bytes; NULL: none */
static uint8_t *reserve(writer *w, size_t size) {
  tdm_view_bytes *b = w->bytes;
  if (w->status != TDM_OK)
    return NULL;
  if (b->size + size > b->capacity || !b->data) {
    size_t capacity = b->size + size + b->size / 2 + 256;
    uint8_t *data = realloc(b->data, capacity);
    if (!data) {
      w->status = tdm_fail(w->err, TDM_ERR_MEMORY, NULL, "no memory for what there is to see: %zu bytes", capacity);
      return NULL;
    }
    b->data = data;
    b->capacity = capacity;
  }
  uint8_t *at = b->data + b->size;
  b->size += size;
  return at;
}

static void put(writer *w, const void *data, size_t size) {
  uint8_t *at = reserve(w, size);
  if (at && size)
    memcpy(at, data, size);
}

static void put_u32(writer *w, uint32_t value) {
  put(w, &value, sizeof value);
}

static void put_reals(writer *w, const double *value, size_t n) {
  if (!w->single) {
    put(w, value, n * sizeof *value);
    return;
  }
  uint8_t *at = reserve(w, n * sizeof(float));
  for (size_t i = 0; at && i < n; i++) {
    float narrow = (float)value[i];
    memcpy(at + i * sizeof narrow, &narrow, sizeof narrow);
  }
}

/* returns where the record begins */
static size_t begin(writer *w, tdm_view_record kind) {
  size_t start = w->bytes->size;
  const uint64_t unknown = 0;
  put(w, magic, sizeof magic);
  put_u32(w, VERSION);
  put_u32(w, (uint32_t)kind);
  put_u32(w, w->single ? 4 : 8);
  put(w, &unknown, sizeof unknown);
  return start;
}

static tdm_status end(writer *w, size_t start) {
  if (w->status != TDM_OK)
    return w->status;
  uint64_t length = w->bytes->size - start;
  memcpy(w->bytes->data + start + LENGTH_AT, &length, sizeof length);
  return TDM_OK;
}

tdm_status tdm_scenery_encode(const tdm_scenery *s, bool single, tdm_view_bytes *bytes, tdm_error *err) {
  writer w = {.bytes = bytes, .single = single, .err = err};
  size_t start = begin(&w, TDM_VIEW_SCENERY);
  const int counts[6] = {s->nbody, s->npolygon, s->nline, s->nmaterial, s->nedge, 0};
  for (int k = 0; k < 6; k++)
    put_u32(&w, (uint32_t)counts[k]);
  put_reals(&w, &s->gravity.x, 3);
  for (int k = 0; k < s->nbody; k++) {
    const tdm_view_body *b = &s->body[k];
    put(&w, b->name, sizeof b->name);
    put_u32(&w, (uint32_t)(b->dem | b->mbd << 1 | b->still << 2 | b->marked << 3));
  }
  for (int k = 0; k < s->nline; k++) {
    put(&w, s->line[k].name, sizeof s->line[k].name);
    put_u32(&w, (uint32_t)s->line[k].kind);
  }
  for (int k = 0; k < s->nmaterial; k++)
    put(&w, s->material[k].name, sizeof s->material[k].name);
  put_reals(&w, s->edge, (size_t)s->nedge);
  for (int k = 0; k < s->npolygon; k++) {
    const tdm_view_polygon *p = &s->polygon[k];
    put_u32(&w, (uint32_t)p->body);
    put_u32(&w, (uint32_t)(p->ncorner | p->solid << 8));
    put_reals(&w, &p->corner[0].x, 3 * (size_t)p->ncorner);
  }
  return end(&w, start);
}

#define PUT_double(w, array, count) put_reals(w, array, count)
#define PUT_tdm_vec3(w, array, count) put_reals(w, (const double *)(array), 3 * (count))
#define PUT_tdm_pose(w, array, count) put_reals(w, (const double *)(array), 7 * (count))
#define PUT_int32_t(w, array, count) put(w, array, (count) * sizeof(int32_t))
#define PUT_int64_t(w, array, count) put(w, array, (count) * sizeof(int64_t))

_Static_assert(sizeof(tdm_pose) == 7 * sizeof(double), "a pose is 7 doubles");

tdm_status tdm_snapshot_encode(const tdm_snapshot *s, bool single, tdm_view_bytes *bytes, tdm_error *err) {
  writer w = {.bytes = bytes, .single = single, .err = err};
  size_t start = begin(&w, TDM_VIEW_SNAPSHOT), n = (size_t)s->nparticle;
  const int counts[6] = {s->nbody, s->nline, s->npoint, s->nforce, s->nall, s->oriented ? s->nall : 0};
  for (int k = 0; k < 6; k++)
    put_u32(&w, (uint32_t)counts[k]);
  put(&w, &s->time, sizeof s->time);
  PUT_tdm_pose(&w, s->pose, (size_t)s->nbody);
  PUT_int32_t(&w, s->line_end, (size_t)s->nline);
  PUT_tdm_vec3(&w, s->point, (size_t)s->npoint);
  PUT_tdm_vec3(&w, s->force_on, (size_t)s->nforce);
#define X(type, name, numbers, unit, text) PUT_##type(&w, s->name, n);
  TDM_VIEW_PARTICLE_LIST(X)
#undef X
  put_reals(&w, (const double *)s->orientation, 4 * (size_t)s->norientation);
  if (s->ncontact > 0)
    put_u32(&w, (uint32_t)s->ncontact);
  for (int k = 0; k < s->ncontact; k++) {
    const tdm_view_contact *c = &s->contact[k];
    const int64_t ids[2] = {c->particle, c->other};
    const double numbers[CONTACT_REALS] = {c->from.x, c->from.y, c->from.z, c->to.x, c->to.y, c->to.z, c->force};
    put(&w, ids, sizeof ids);
    put_reals(&w, numbers, CONTACT_REALS);
  }
  return end(&w, start);
}

#define WIDTH_double(real) (real)
#define WIDTH_tdm_vec3(real) (3 * (real))
#define WIDTH_int32_t(real) sizeof(int32_t)
#define WIDTH_int64_t(real) sizeof(int64_t)

tdm_view_layout tdm_snapshot_layout(const tdm_snapshot *s, bool single) {
  const size_t real = single ? sizeof(float) : sizeof(double);
  tdm_view_layout l = {.before = HEAD_BYTES + 6 * sizeof(uint32_t) + sizeof s->time + 7 * real * (size_t)s->nbody +
                                 sizeof(int32_t) * (size_t)s->nline + 3 * real * (size_t)(s->npoint + s->nforce)};
#define X(type, name, numbers, unit, text) l.width[l.narray++] = WIDTH_##type(real);
  TDM_VIEW_PARTICLE_LIST(X)
#undef X
  if (s->oriented)
    l.width[l.narray++] = 4 * real;
  return l;
}

/* ---- reading ---- */

typedef struct {
  const uint8_t *at, *stop;
  bool single, bad;
} reader;

static void get(reader *r, void *out, size_t size) {
  if (r->bad || (size_t)(r->stop - r->at) < size) {
    r->bad = true;
    return;
  }
  if (size)
    memcpy(out, r->at, size);
  r->at += size;
}

static uint32_t get_u32(reader *r) {
  uint32_t value = 0;
  get(r, &value, sizeof value);
  return value;
}

/* a count of things that take at least `least` bytes each; 0 and bad when there are not so many bytes */
static int get_count(reader *r, size_t least) {
  uint32_t n = get_u32(r);
  if (n > TDM_VIEW_COUNT_MAX || (size_t)n * least > (size_t)(r->stop - r->at))
    r->bad = true;
  return r->bad ? 0 : (int)n;
}

static void get_reals(reader *r, double *out, size_t n) {
  if (!r->single) {
    get(r, out, n * sizeof *out);
    return;
  }
  for (size_t i = 0; i < n && !r->bad; i++) {
    float narrow = 0;
    get(r, &narrow, sizeof narrow);
    out[i] = (double)narrow;
  }
}

static void get_name(reader *r, char name[TDM_VIEW_NAME_MAX]) {
  get(r, name, TDM_VIEW_NAME_MAX);
  name[r->bad ? 0 : TDM_VIEW_NAME_MAX - 1] = '\0';
  tdm_utf8_clean(name);
}

tdm_status tdm_view_peek(const void *data, size_t size, tdm_view_record *record, size_t *length, tdm_error *err) {
  const uint8_t *at = data;
  uint32_t words[3];
  uint64_t all;
  if (size < HEAD_BYTES || memcmp(at, magic, sizeof magic) != 0)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "no scenery or snapshot: it does not begin with TNDV");
  memcpy(words, at + 4, sizeof words);
  memcpy(&all, at + LENGTH_AT, sizeof all);
  if (words[0] != VERSION)
    return tdm_fail(err, TDM_ERR_VERSION, NULL, "a scenery or snapshot of version %u, here it is %d", words[0],
                    VERSION);
  if ((words[1] != TDM_VIEW_SCENERY && words[1] != TDM_VIEW_SNAPSHOT) || (words[2] != 4 && words[2] != 8) ||
      all < HEAD_BYTES)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed scenery or snapshot: kind %u, numbers of %u bytes",
                    words[1], words[2]);
  if (all > size)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL,
                    "a scenery or snapshot is cut off: %llu bytes announced, %zu are there", (unsigned long long)all,
                    size);
  *record = (tdm_view_record)words[1];
  *length = (size_t)all;
  return TDM_OK;
}

static tdm_status open_record(reader *r, tdm_view_record wanted, const void *data, size_t size, tdm_error *err) {
  tdm_view_record record;
  size_t length;
  uint32_t real;
  if (tdm_view_peek(data, size, &record, &length, err) != TDM_OK)
    return err ? err->status : TDM_ERR_PROTOCOL;
  if (record != wanted)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "a %s where a %s was due",
                    record == TDM_VIEW_SCENERY ? "scenery" : "snapshot",
                    wanted == TDM_VIEW_SCENERY ? "scenery" : "snapshot");
  memcpy(&real, (const uint8_t *)data + 12, sizeof real);
  *r = (reader){.at = (const uint8_t *)data + HEAD_BYTES, .stop = (const uint8_t *)data + length, .single = real == 4};
  return TDM_OK;
}

static tdm_status close_record(const reader *r, const char *what, tdm_error *err) {
  if (r->bad || r->at != r->stop)
    return tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed %s: its counts and its length do not fit", what);
  return TDM_OK;
}

static void decode_bodies(reader *r, tdm_scenery *s, int nbody, tdm_error *err) {
  for (int k = 0; k < nbody && !r->bad; k++) {
    tdm_view_body b = {0};
    get_name(r, b.name);
    uint32_t flags = get_u32(r);
    b.dem = flags & 1;
    b.mbd = flags & 2;
    b.still = flags & 4;
    b.marked = flags & 8;
    r->bad = r->bad || tdm_scenery_add_body(s, &b, err) != TDM_OK;
  }
}

static void decode_polygons(reader *r, tdm_scenery *s, int npolygon, int nbody, tdm_error *err) {
  for (int k = 0; k < npolygon && !r->bad; k++) {
    tdm_view_polygon p = {.body = (int)get_u32(r)};
    uint32_t shape = get_u32(r);
    p.ncorner = (int)(shape & 255);
    p.solid = shape & 256;
    if (p.body < 0 || p.body >= nbody || p.ncorner < 3 || p.ncorner > TDM_VIEW_CORNERS_MAX) {
      r->bad = true;
      return;
    }
    get_reals(r, &p.corner[0].x, 3 * (size_t)p.ncorner);
    r->bad = r->bad || tdm_scenery_add_polygon(s, &p, err) != TDM_OK;
  }
}

tdm_status tdm_scenery_decode(tdm_scenery *s, const void *data, size_t size, tdm_error *err) {
  reader r;
  tdm_error own = {0};
  tdm_scenery_clear(s);
  if (open_record(&r, TDM_VIEW_SCENERY, data, size, &own) == TDM_OK) {
    int nbody = get_count(&r, TDM_VIEW_NAME_MAX), npolygon = get_count(&r, 8 + 9 * sizeof(float));
    int nline = get_count(&r, TDM_VIEW_NAME_MAX), nmaterial = get_count(&r, TDM_VIEW_NAME_MAX);
    int nedge = get_count(&r, sizeof(float));
    get_u32(&r);
    get_reals(&r, &s->gravity.x, 3);
    decode_bodies(&r, s, nbody, &own);
    for (int k = 0; k < nline && !r.bad; k++) {
      char name[TDM_VIEW_NAME_MAX];
      get_name(&r, name);
      uint32_t kind = get_u32(&r);
      r.bad = r.bad || kind >= TDM_VIEW_LINE_COUNT ||
              tdm_scenery_add_line(s, name, (tdm_view_line_kind)kind, &own) != TDM_OK;
    }
    for (int k = 0; k < nmaterial && !r.bad; k++) {
      char name[TDM_VIEW_NAME_MAX];
      get_name(&r, name);
      r.bad = r.bad || tdm_scenery_add_material(s, name, &own) != TDM_OK;
    }
    for (int k = 0; k < nedge && !r.bad; k++) {
      double radius = 0;
      get_reals(&r, &radius, 1);
      r.bad = r.bad || tdm_scenery_add_edge(s, radius, &own) != TDM_OK;
    }
    decode_polygons(&r, s, npolygon, nbody, &own);
    if (own.status == TDM_OK)
      close_record(&r, "scenery", &own);
  }
  if (own.status == TDM_OK)
    return TDM_OK;
  tdm_scenery_clear(s);
  return tdm_fail(err, own.status, NULL, "%s", own.message);
}

#define GET_double(r, array, count) get_reals(r, array, count)
#define GET_tdm_vec3(r, array, count) get_reals(r, (double *)(array), 3 * (count))
#define GET_tdm_pose(r, array, count) get_reals(r, (double *)(array), 7 * (count))
#define GET_int32_t(r, array, count) get(r, array, (count) * sizeof(int32_t))
#define GET_int64_t(r, array, count) get(r, array, (count) * sizeof(int64_t))

/* the rest of a snapshot's record, if there is more */
static tdm_status decode_contacts(reader *r, tdm_snapshot *s, tdm_error *err) {
  const int n = !r->bad && r->at < r->stop ? get_count(r, 2 * sizeof(int64_t) + CONTACT_REALS * sizeof(float)) : 0;
  for (int k = 0; k < n && !r->bad; k++) {
    int64_t ids[2] = {0, 0};
    double x[CONTACT_REALS] = {0};
    get(r, ids, sizeof ids);
    get_reals(r, x, CONTACT_REALS);
    const tdm_view_contact contact = {ids[0], ids[1], {x[0], x[1], x[2]}, {x[3], x[4], x[5]}, x[6]};
    if (!r->bad && tdm_snapshot_add_contact(s, &contact, err) != TDM_OK)
      return err ? err->status : TDM_ERR_MEMORY;
  }
  return TDM_OK;
}

tdm_status tdm_snapshot_decode(tdm_snapshot *s, const void *data, size_t size, tdm_error *err) {
  reader r;
  tdm_error own = {0};
  if (open_record(&r, TDM_VIEW_SNAPSHOT, data, size, &own) != TDM_OK)
    return tdm_fail(err, own.status, NULL, "%s", own.message);
  int nbody = get_count(&r, 7 * sizeof(float)), nline = get_count(&r, sizeof(int32_t));
  int npoint = get_count(&r, 3 * sizeof(float)), nforce = get_count(&r, 3 * sizeof(float));
  int nparticle = get_count(&r, 16 * sizeof(float)), norientation = get_count(&r, 4 * sizeof(float));
  r.bad = r.bad || (norientation > 0 && norientation != nparticle);
  if (!r.bad && tdm_snapshot_resize(s, nbody, nline, nforce, nparticle, err) != TDM_OK)
    return err ? err->status : TDM_ERR_MEMORY;
  if (!r.bad && norientation > 0 && tdm_snapshot_orient(s, err) != TDM_OK)
    return err ? err->status : TDM_ERR_MEMORY;
  s->npoint = 0;
  for (int k = 0; k < npoint && !r.bad; k++)
    if (tdm_snapshot_add_point(s, (tdm_vec3){0, 0, 0}, err) != TDM_OK)
      return err ? err->status : TDM_ERR_MEMORY;
  if (!r.bad) {
    get(&r, &s->time, sizeof s->time);
    GET_tdm_pose(&r, s->pose, (size_t)nbody);
    GET_int32_t(&r, s->line_end, (size_t)nline);
    GET_tdm_vec3(&r, s->point, (size_t)npoint);
    GET_tdm_vec3(&r, s->force_on, (size_t)nforce);
#define X(type, name, numbers, unit, text) GET_##type(&r, s->name, (size_t)nparticle);
    TDM_VIEW_PARTICLE_LIST(X)
#undef X
    get_reals(&r, (double *)s->orientation, 4 * (size_t)norientation);
    if (decode_contacts(&r, s, err) != TDM_OK)
      return err ? err->status : TDM_ERR_MEMORY;
    for (int k = 0, last = 0; k < nline && !r.bad; last = s->line_end[k++])
      r.bad = s->line_end[k] < last || s->line_end[k] > npoint || (k + 1 == nline && s->line_end[k] != npoint);
  }
  if (close_record(&r, "snapshot", err) == TDM_OK)
    return TDM_OK;
  s->nbody = s->nline = s->npoint = s->nforce = s->nparticle = s->norientation = s->ncontact = 0;
  tdm_snapshot_share(s, 0);
  return err ? err->status : TDM_ERR_PROTOCOL;
}
