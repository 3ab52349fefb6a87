/* Stored states: see state_file.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/store/state_file.h"

#include "dem/bodies/walls.h"
#include "dem/model/integrator.h"
#include "dem/particles/domain.h"
#include "dem/particles/field.h"
#include "dem/seam/homes.h"
#include "dem/search/pairs.h"
#include "dem/store/fingerprint.h"
#include "protocol/math/hash.h"
#include "protocol/scene/input.h"

#include <assert.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "stored states are little-endian"
#endif

static const char magic[8] = {'T', 'N', 'D', 'M', 'D', 'E', 'M', '\n'};

/* Raise it when the format or what the fingerprints are made of changes, or when the same inputs give another state. */
enum { STATE_VERSION = 6 };

typedef struct {
  char magic[8];
  uint64_t version;
  uint64_t bed; /* dem_fingerprint_bed */
  uint64_t nparticle;
  uint64_t size;                /* of all, checksum included [bytes] */
  uint64_t whole, start;        /* dem_fingerprint_whole, _start */
  uint64_t part[DEM_BED_PARTS]; /* dem_fingerprint_bed_parts: to say what differs */
} header;

/* in front of each section; the bytes are filled up to a multiple of 8 */
typedef struct {
  char name[24];
  uint64_t size; /* [bytes] */
} section;

/* numbers and records of the state */
typedef struct {
#define X(object, field, type) type field;
  DEM_NUMBER_STATE(X)
#undef X
} counters;

#define X(object, field, type) static_assert(sizeof(type) >= sizeof((dem_data *)0)->object.field, "too small: " #field);
DEM_NUMBER_STATE(X)
#undef X

/* a contact with a history; the columns follow */
typedef struct {
  int32_t particle, other, part, unused; /* other: particle or wall */
} contact;

/* ---- writing ---- */

typedef struct {
  char *bytes;
  size_t size, capacity;
  bool failed;
} writer;

/* n bytes at the end, NULL: no memory */
static void *append(writer *w, size_t n) {
  size_t padded = (n + 7) & ~(size_t)7;
  if (!w->failed && w->size + padded > w->capacity) {
    size_t capacity = w->size + padded + w->size / 2 + 4096;
    char *grown = realloc(w->bytes, capacity);
    w->failed = !grown;
    if (grown) {
      w->bytes = grown;
      w->capacity = capacity;
    }
  }
  if (w->failed)
    return NULL;
  char *at = w->bytes + w->size;
  memset(at, 0, padded);
  w->size += padded;
  return at;
}

static void put(writer *w, const void *bytes, size_t n) {
  void *at = append(w, n);
  if (at && n > 0)
    memcpy(at, bytes, n);
}

static void put_section(writer *w, const char *name, const void *bytes, size_t n) {
  section s = {.size = n};
  snprintf(s.name, sizeof s.name, "%s", name);
  put(w, &s, sizeof s);
  put(w, bytes, n);
}

/* begin a section whose size end_section will know */
static size_t begin_section(writer *w, const char *name) {
  put_section(w, name, NULL, 0);
  return w->size;
}

static void end_section(writer *w, size_t begin) {
  uint64_t size = w->size - begin;
  if (!w->failed)
    memcpy(w->bytes + begin - sizeof size, &size, sizeof size);
}

/* columns of entry k, unless all are zero, as those of contacts that do not touch are */
static void put_history(writer *w, contact c, const double *history, size_t capacity, size_t k, int ncolumn) {
  double column[DEM_HISTORY_MAX] = {0}, none[DEM_HISTORY_MAX] = {0};
  for (int q = 0; q < ncolumn; q++)
    column[q] = history[(size_t)q * capacity + k];
  if (memcmp(column, none, sizeof column) == 0)
    return;
  put(w, &c, sizeof c);
  put(w, column, (size_t)ncolumn * sizeof *column);
}

static void put_histories(writer *w, const dem_data *d) {
  const dem_pairs *p = &d->lists.pairs;
  int ncolumn = d->model->columns.ncolumn;
  size_t begin = begin_section(w, "pairs");
  for (int i = 0; i < d->state.nparticle && ncolumn > 0; i++)
    for (int k = p->first[i]; k < p->first[i + 1] && p->other[k] < d->state.nparticle; k++)
      put_history(w, (contact){i, p->other[k], 0, 0}, p->history, p->capacity, (size_t)k, ncolumn);
  end_section(w, begin);
  begin = begin_section(w, "walls");
  for (size_t k = 0; k < d->lists.walls.count && ncolumn > 0; k++) {
    const dem_wall_entry *e = &d->lists.walls.entry[k];
    put_history(w, (contact){e->particle, e->wall, e->part, 0}, d->lists.walls.history, d->lists.walls.capacity, k,
                ncolumn);
  }
  end_section(w, begin);
}

static counters counters_of(const dem_data *d) {
  counters c;
  memset(&c, 0, sizeof c);
#define X(object, field, type) memcpy(&c.field, &d->object.field, sizeof d->object.field); /* little-endian */
  DEM_NUMBER_STATE(X)
#undef X
  return c;
}

static void take_counters(dem_data *d, const counters *c) {
#define X(object, field, type) memcpy(&d->object.field, &c->field, sizeof d->object.field);
  DEM_NUMBER_STATE(X)
#undef X
}

static tdm_status save(const dem_data *d, const void *note, size_t note_size, void **bytes, size_t *size) {
  const dem_model *m = d->model;
  assert(m->nparticle == 0 || m->radius);
  writer w = {0};
  size_t np = (size_t)d->state.nparticle;
  header h = {.version = STATE_VERSION,
              .bed = dem_fingerprint_bed(m),
              .whole = dem_fingerprint_whole(m),
              .start = dem_fingerprint_start(m),
              .nparticle = np};
  memcpy(h.magic, magic, sizeof magic);
  dem_fingerprint_bed_parts(m, h.part);
  put(&w, &h, sizeof h);
#define X(field, n, name) put_section(&w, name, d->field, np *(size_t)(n) * sizeof *d->field);
  DEM_PARTICLE_STATE(X)
#undef X
#define X(field, name) put_section(&w, name, d->field, d->field ? np * sizeof *d->field : 0);
  DEM_FORCE_STATE(X)
#undef X
  put_histories(&w, d);
  put_section(&w, "lid", d->state.lid, (size_t)m->nwall * sizeof *d->state.lid);
  put_section(&w, "block", d->work.block, d->work.block_size);
  counters c = counters_of(d);
  put_section(&w, "counters", &c, sizeof c);
  put_section(&w, "note", note, note_size);
  uint64_t total = w.size + sizeof total;
  if (!w.failed)
    memcpy(w.bytes + offsetof(header, size), &total, sizeof total);
  uint64_t sum = w.failed ? 0 : tdm_hash_words(TDM_HASH_START, w.bytes, w.size);
  put(&w, &sum, sizeof sum);
  if (w.failed) {
    free(w.bytes);
    return TDM_ERR_MEMORY;
  }
  *bytes = w.bytes;
  *size = w.size;
  return TDM_OK;
}

tdm_status dem_state_save(const dem_data *d, void **bytes, size_t *size) {
  return save(d, NULL, 0, bytes, size);
}

/* ---- reading ---- */

typedef struct {
  const char *bytes;
  size_t size;
  dem_state_use use;
  const char *file, *key; /* file: NULL in memory */
  int nparticle;
} reader;

static tdm_status refuse(const reader *r, tdm_error *err, const char *what) {
  static const char *const cure[] = {"give a state that this version of tandem saved in this scene",
                                     "delete the file to settle and store the bed anew, or give another name",
                                     "give the file of a state that goes with this scene"};
  return tdm_fail(err, TDM_ERR_FILE, r->key, "%s%s%s %s; %s", r->file ? "\"" : "the state", r->file ? r->file : "",
                  r->file ? "\"" : "", what, cure[r->use]);
}

/* the bytes of a section, of exactly this size unless it is SIZE_MAX; NULL: there is none */
static const void *find(const reader *r, const char *name, size_t *size) {
  for (size_t at = sizeof(header); r->size - at > sizeof(section) + sizeof(uint64_t);) {
    section s;
    memcpy(&s, r->bytes + at, sizeof s);
    at += sizeof s;
    if (s.size > r->size - at)
      return NULL;
    if (strncmp(s.name, name, sizeof s.name) == 0) {
      bool fits = *size == SIZE_MAX || *size == s.size;
      *size = s.size;
      return fits ? r->bytes + at : NULL;
    }
    at += (s.size + 7) & ~(size_t)7;
  }
  return NULL;
}

/* The functions that follow take a part of a stored state; TDM_ERR_FILE, without a message: it is damaged. */

/* a section into an array of its size */
static tdm_status get(const reader *r, const char *name, void *to, size_t size) {
  const void *from = find(r, name, &size);
  if (from && size > 0)
    memcpy(to, from, size);
  return from ? TDM_OK : TDM_ERR_FILE;
}

/* a bed of another scene: what is not as it was */
static tdm_status refuse_bed(const reader *r, const header *h, const dem_model *m, tdm_error *err) {
  char says[512] = "holds the bed of another scene";
  uint64_t part[DEM_BED_PARTS];
  dem_fingerprint_bed_parts(m, part);
  const char *between = ": what differs is ";
  for (int k = 0; k < DEM_BED_PARTS; k++)
    if (part[k] != h->part[k]) {
      size_t n = strlen(says);
      snprintf(says + n, sizeof says - n, "%s%s", between, dem_bed_part_names[k]);
      between = ", ";
    }
  return refuse(r, err, says);
}

static tdm_status check_header(reader *r, const dem_data *d, tdm_error *err) {
  static const char *const foreign[] = {"is no stored state", "is no stored bed", "is no stored state"};
  header h;
  if (r->size < sizeof h)
    return refuse(r, err, "is cut short");
  memcpy(&h, r->bytes, sizeof h);
  if (memcmp(h.magic, magic, sizeof magic) != 0)
    return refuse(r, err, foreign[r->use]);
  if (h.version != STATE_VERSION)
    return refuse(r, err, "was written by another version of tandem");
  bool same = r->use == DEM_STATE_WHOLE ? h.whole == dem_fingerprint_whole(d->model)
              : r->use == DEM_STATE_BED ? h.bed == dem_fingerprint_bed(d->model)
                                        : h.start == dem_fingerprint_start(d->model);
  same = same && (r->use != DEM_STATE_BED || d->model->domain.open || h.nparticle == (uint64_t)d->model->nparticle);
  if (!same && r->use == DEM_STATE_START)
    return refuse(r, err, "is of a scene with other contact laws, elastic constants, shapes or periodic directions");
  if (!same && r->use == DEM_STATE_BED)
    return refuse_bed(r, &h, d->model, err);
  if (!same)
    return refuse(r, err, "is of another scene");
  if (h.size > r->size)
    return refuse(r, err, "is cut short");
  uint64_t sum;
  memcpy(&sum, r->bytes + r->size - sizeof sum, sizeof sum);
  if (h.size != r->size || r->size % 8 != 0 || sum != tdm_hash_words(TDM_HASH_START, r->bytes, r->size - sizeof sum) ||
      h.nparticle > (uint64_t)INT_MAX / 2)
    return refuse(r, err, "is damaged");
  r->nparticle = (int)h.nparticle;
  return TDM_OK;
}

static bool may_be_missing(const dem_data *d, const void *field) {
  return field == d->state.memory || field == d->state.drive || field == d->state.spot || field == d->state.held;
}

/* The arrays of particles. What hangs on the integrator, on the scene's groups or on its outputs may be missing unless
 * the scene is the same, and what is not wanted here may be in any case. */
static tdm_status get_particles(const reader *r, dem_data *d) {
  size_t np = (size_t)d->state.nparticle;
  bool good = true;
#define X(field, n, name)                                                     \
  if ((n) > 0 && get(r, name, d->field, np * (size_t)(n) * sizeof *d->field)) \
    good = good && r->use != DEM_STATE_WHOLE && may_be_missing(d, d->field);
  DEM_PARTICLE_STATE(X)
#undef X
  for (int i = 0; i < d->state.nparticle; i++)
    good = good && d->state.material[i] >= 0 && d->state.material[i] < d->model->nmaterial;
  return good ? TDM_OK : TDM_ERR_FILE;
}

/* The forces, after the lists, which are built in their memory. Those of multi-step may be missing unless the scene is
 * the same. */
static tdm_status get_forces(const reader *r, dem_data *d) {
  bool good = true;
#define X(field, name)                                                                   \
  if (d->field && get(r, name, d->field, (size_t)d->state.nparticle * sizeof *d->field)) \
    good = good && r->use != DEM_STATE_WHOLE && (void *)d->field == (void *)d->state.spare_push;
  DEM_FORCE_STATE(X)
#undef X
  return good ? TDM_OK : TDM_ERR_FILE;
}

/* place of a contact in the lists, -1: there is none; `from` is where the search among walls goes on */
static long place_of(const dem_data *d, const contact *c, bool of_wall, size_t *from) {
  if (c->particle < 0 || c->particle >= d->state.nparticle)
    return -1;
  for (int k = d->lists.pairs.first[c->particle]; !of_wall && k < d->lists.pairs.first[c->particle + 1]; k++)
    if (d->lists.pairs.other[k] == c->other)
      return k;
  for (; of_wall && *from < d->lists.walls.count; ++*from) { /* both ascend */
    const dem_wall_entry *e = &d->lists.walls.entry[*from];
    if (e->particle == c->particle && e->wall == c->other && e->part == c->part)
      return (long)*from;
  }
  return -1;
}

static tdm_status get_histories(const reader *r, dem_data *d, bool of_wall) {
  size_t size = SIZE_MAX, ncolumn = (size_t)d->model->columns.ncolumn, one = sizeof(contact) + ncolumn * sizeof(double);
  const char *from = find(r, of_wall ? "walls" : "pairs", &size);
  if (!from || size % one != 0)
    return TDM_ERR_FILE;
  double *history = of_wall ? d->lists.walls.history : d->lists.pairs.history;
  size_t capacity = of_wall ? d->lists.walls.capacity : d->lists.pairs.capacity, wall = 0;
  for (size_t at = 0; at < size; at += one) {
    contact c;
    memcpy(&c, from + at, sizeof c);
    long k = place_of(d, &c, of_wall, &wall);
    if (k < 0)
      return TDM_ERR_FILE;
    for (size_t q = 0; q < ncolumn; q++)
      memcpy(&history[q * capacity + (size_t)k], from + at + sizeof c + q * sizeof(double), sizeof(double));
  }
  return TDM_OK;
}

/* counters and bodies of the run that was saved */
static tdm_status get_run(const reader *r, dem_data *d, counters *c) {
  if (get(r, "block", d->work.block, d->work.block_size))
    return TDM_ERR_FILE;
  take_counters(d, c);
  dem_domain_put(d);
  return TDM_OK;
}

/* a run that begins with these particles */
static tdm_status get_beginning(const reader *r, dem_data *d) {
  if (get(r, "lid", d->state.lid, (size_t)d->model->nwall * sizeof *d->state.lid))
    return TDM_ERR_FILE;
  d->state.ledger = (dem_ledger){0};
  for (int i = 0; i < d->state.nparticle; i++) {
    d->state.touched[i] = 0;
    if (d->model->ncontainer > 0)
      d->state.held[i] = 0;
    if (d->model->screening.watched)
      d->state.spot[i] = (dem_spot){0};
    d->state.sphere[i].inverse_mass = 1 / d->state.mass[i];
    d->state.ledger.created =
        d->state.id[i] + 1 > d->state.ledger.created ? d->state.id[i] + 1 : d->state.ledger.created;
    dem_exact_sum_add(&d->state.ledger.mass, d->state.mass[i]);
  }
  if (d->state.ledger.created < (uint64_t)d->model->nparticle)
    d->state.ledger.created = (uint64_t)d->model->nparticle;
  d->state.ledger.removed = d->state.ledger.created - (uint64_t)d->state.nparticle;
  d->state.restart = true;
  dem_drive_particles(d, 0, d->state.nparticle);
  if (r->use == DEM_STATE_START)
    dem_domain_begin(d, 0, d->state.nparticle);
  return TDM_OK;
}

static tdm_status load(reader *r, dem_data *d, void *note, size_t note_size, tdm_error *err) {
  counters c;
  if (check_header(r, d, err))
    return err->status;
  if (dem_data_reserve(d, r->nparticle))
    return tdm_fail(err, TDM_ERR_MEMORY, r->key, "no memory for %d particles", r->nparticle);
  d->state.nparticle = r->nparticle;
  bool damaged =
      get_particles(r, d) || get(r, "counters", &c, sizeof c) || (note_size > 0 && get(r, "note", note, note_size));
  damaged = damaged || (r->use == DEM_STATE_WHOLE ? get_run(r, d, &c) : get_beginning(r, d));
  dem_data_end(d);
  if (damaged)
    return refuse(r, err, "is damaged");
  dem_walls_put(d);
  dem_united(d);
  d->lists.valid = false;  /* histories of before are not these */
  d->state.since_sort = 0; /* the order is the one that was saved */
  d->lists.skin = c.skin;
  if (dem_lists_build(d))
    return tdm_fail(err, TDM_ERR_MEMORY, r->key, "no memory for the neighbour lists");
  d->state.since_sort = c.since_sort;
  dem_unite(d, DEM_WHOLE); /* each rank reads all forces and histories */
  if (get_forces(r, d) || get_histories(r, d, false) || get_histories(r, d, true))
    return refuse(r, err, "is damaged");
  return TDM_OK;
}

tdm_status dem_state_load(dem_data *d, const void *bytes, size_t size, tdm_error *err) {
  reader r = {.bytes = bytes, .size = size, .use = DEM_STATE_WHOLE, .key = "dem"};
  return load(&r, d, NULL, 0, err);
}

/* ---- files ---- */

/* the whole file, the caller's to free */
static char *read_all(FILE *f, size_t *size) {
  char *bytes = NULL;
  *size = 0;
  for (size_t capacity = 1 << 16;; capacity *= 2) {
    char *grown = realloc(bytes, capacity);
    if (!grown) {
      errno = ENOMEM;
      break;
    }
    bytes = grown;
    *size += fread(bytes + *size, 1, capacity - *size, f);
    if (ferror(f))
      break;
    if (*size < capacity || memcmp(bytes, magic, sizeof magic) != 0) /* no more of what is no stored state */
      return bytes;
  }
  free(bytes);
  return NULL;
}

tdm_status dem_state_read(dem_data *d, dem_state_use use, const char *file, const char *key, void *note, size_t size,
                          tdm_error *err) {
  reader r = {.use = use, .file = file, .key = key};
  const char *why;
  FILE *f = tdm_open_input(file, false, &why);
  char *bytes = f ? read_all(f, &r.size) : NULL;
  if (!bytes)
    tdm_fail(err, TDM_ERR_FILE, key, "\"%s\" cannot be read: %s; name another file", file, f ? strerror(errno) : why);
  if (f)
    fclose(f);
  r.bytes = bytes;
  if (bytes)
    load(&r, d, note, size, err);
  free(bytes);
  return err->status;
}

/* to a file beside it, renamed at the end; TDM_ERR_FILE, without a message: see errno */
static tdm_status write_all(const char *file, const void *bytes, size_t size) {
  char temporary[4200];
  snprintf(temporary, sizeof temporary, "%s.%ld.tmp", file, (long)getpid());
  FILE *f = fopen(temporary, "wb");
  if (!f)
    return TDM_ERR_FILE;
  bool good = fwrite(bytes, 1, size, f) == size && fflush(f) == 0 && fsync(fileno(f)) == 0;
  int error = errno;
  if (fclose(f) != 0 && good) {
    error = errno;
    good = false;
  }
  if (good && rename(temporary, file) != 0) {
    error = errno;
    good = false;
  }
  if (!good)
    remove(temporary);
  errno = error;
  return good ? TDM_OK : TDM_ERR_FILE;
}

tdm_status dem_state_write(const dem_data *d, const char *file, const char *key, const void *note, size_t size,
                           tdm_error *err) {
  void *bytes;
  size_t n;
  if (save(d, note, size, &bytes, &n))
    return tdm_fail(err, TDM_ERR_MEMORY, key, "no memory to store the state");
  if (write_all(file, bytes, n))
    tdm_fail(err, TDM_ERR_FILE, key, "\"%s\" cannot be written: %s; make room or name another file", file,
             strerror(errno));
  free(bytes);
  return err->status;
}
