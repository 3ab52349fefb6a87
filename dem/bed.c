/* Storing settled beds: see bed.h. */
#include "dem/bed.h"

#include "dem/geometry/walls.h"
#include "dem/pour.h"
#include "dem/search/pairs.h"

#include <errno.h>
#include <libgen.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "stored beds are little-endian"
#endif

static const char magic[8] = {'T', 'N', 'D', 'M', 'B', 'E', 'D', '\n'};

/* Raise it when the format changes, or when the same inputs settle to another bed. */
enum { BED_VERSION = 2 };

static const char key[] = "dem.settle.store";

typedef struct {
  char magic[8];
  uint64_t version, fingerprint;
  uint64_t nparticle, npair, nwall; /* npair, nwall: contacts with a history */
  uint64_t ncolumn, since_sort;
  uint64_t rest;          /* bit 0: at rest, bit 1: lids pressed */
  double dt, time, speed; /* of dem_settled */
} header;

/* a particle, in the order of the settled bed */
typedef struct {
  uint64_t id;
  tdm_vec3 position;
} place;

/* a contact's history: particle and partner (particle or wall) */
typedef struct {
  uint32_t particle, other;
  double column[DEM_HISTORY_MAX];
} entry;
_Static_assert(sizeof(header) == 96 && sizeof(place) == 32 && sizeof(entry) == 8 + 8 * DEM_HISTORY_MAX,
               "no padding in the file");

/* ---- fingerprint ---- */

/* FNV-1a, 64 bits */
static uint64_t hash_bytes(uint64_t h, const void *bytes, size_t n) {
  const unsigned char *b = bytes;
  for (size_t i = 0; i < n; i++)
    h = (h ^ b[i]) * 0x100000001b3u;
  return h;
}

static uint64_t hash_numbers(uint64_t h, const double *x, size_t n) {
  return hash_bytes(h, x, n * sizeof *x);
}

static uint64_t hash_vectors(uint64_t h, const tdm_vec3 *x, size_t n) {
  return hash_bytes(h, x, n * sizeof *x);
}

static const uint64_t hash_start = 0xcbf29ce484222325u;

static uint64_t hash_walls(uint64_t h, const dem_model *m) {
  for (int w = 0; w < m->nwall; w++) {
    const dem_wall *wall = &m->wall[w];
    bool lid = false; /* away while settling */
    for (int k = 0; k < m->nbox; k++)
      lid = lid || m->box[k].lid == w;
    const double what[] = {wall->primitive, wall->body, lid};
    h = hash_numbers(h, what, 3);
    if (lid)
      continue;
    h = hash_vectors(h, &wall->point, 1);
    h = hash_vectors(h, &wall->normal, 1);
    h = hash_vectors(h, &wall->half, 1);
  }
  for (int k = 0; k < m->nbox; k++) {
    const double lid[] = {m->box[k].lid, m->box[k].gap, m->box[k].press};
    h = hash_numbers(h, lid, 3);
  }
  return h;
}

uint64_t dem_bed_fingerprint(const dem_model *m) {
  size_t np = (size_t)m->nparticle;
  uint64_t h = hash_start;
  const char *const laws[] = {m->law->normal, m->law->tangential, m->clip ? "clip" : "keep"};
  for (int k = 0; k < 3; k++)
    h = hash_bytes(h, laws[k], strlen(laws[k]) + 1);
  const dem_settling *s = &m->settle;
  const double counts[] = {m->nmaterial, m->nbody, m->nwall, m->nparticle};
  const double keys[] = {s->speed, s->max_time, s->dt, s->drag};
  h = hash_numbers(h, counts, 4);
  h = hash_numbers(h, keys, 4);
  h = hash_vectors(h, &m->gravity, 1);
  for (int k = 0; k < m->nmaterial; k++) {
    const double material[] = {m->material[k].young, m->material[k].poisson};
    h = hash_numbers(h, material, 2);
  }
  for (int k = 0; k < m->nmaterial * m->nmaterial; k++) {
    const dem_pair *p = &m->settle_pair[k];
    const double pair[] = {p->given, p->friction, p->young, p->shear, p->normal_damping, p->tangential_damping};
    h = hash_numbers(h, pair, p->given ? 6 : 1);
  }
  for (int b = 0; b < m->nbody; b++) { /* the twist: it decides settle.dt when that is not given */
    const double material = m->body[b].material;
    h = hash_numbers(h, &material, 1);
    h = hash_bytes(h, &m->body[b].start, sizeof m->body[b].start);
  }
  h = hash_walls(h, m);
  for (int k = 0; k < m->npouring; k++) {
    const dem_pouring *p = &m->pouring[k];
    const double numbers[] = {p->first, p->count, (double)p->seed};
    h = hash_numbers(h, numbers, 3);
    h = hash_bytes(h, &p->frame, sizeof p->frame);
    h = hash_vectors(h, &p->low, 1);
    h = hash_vectors(h, &p->high, 1);
  }
  h = hash_numbers(h, m->radius, np);
  h = hash_numbers(h, m->mass, np);
  h = hash_bytes(h, m->kind, np * sizeof *m->kind);
  h = hash_vectors(h, m->position, np);
  h = hash_vectors(h, m->velocity, np);
  return hash_vectors(h, m->spin, np);
}

/* ---- reading ---- */

/* read n bytes and add them to the checksum; false at the end of the file */
static bool get(FILE *f, void *bytes, size_t n, uint64_t *sum) {
  if (fread(bytes, 1, n, f) != n)
    return false;
  *sum = hash_bytes(*sum, bytes, n);
  return true;
}

static void put_columns(double *history, size_t capacity, size_t k, int ncolumn, const entry *e) {
  for (int q = 0; q < ncolumn; q++)
    history[(size_t)q * capacity + k] = e->column[q];
}

/* put a history into its place in the pairs; false when there is no such contact */
static bool put_pair(dem_data *d, const entry *e) {
  dem_pairs *list = &d->pairs;
  if (e->particle >= (uint32_t)d->nparticle)
    return false;
  for (int k = list->first[e->particle]; k < list->first[e->particle + 1]; k++)
    if ((uint32_t)list->other[k] == e->other) {
      put_columns(list->history, list->capacity, (size_t)k, d->model->law->ncolumn, e);
      return true;
    }
  return false;
}

static bool put_wall(dem_data *d, const entry *e) {
  dem_wall_contacts *list = &d->walls;
  for (size_t k = 0; k < list->count; k++)
    if ((uint32_t)list->entry[k].particle == e->particle && (uint32_t)list->entry[k].wall == e->other) {
      put_columns(list->history, list->capacity, k, d->model->law->ncolumn, e);
      return true;
    }
  return false;
}

static bool get_histories(FILE *f, dem_data *d, bool (*put)(dem_data *, const entry *), uint64_t n, uint64_t *sum,
                          bool *fits) {
  for (uint64_t k = 0; k < n; k++) {
    entry e;
    if (!get(f, &e, sizeof e, sum))
      return false;
    *fits = *fits && put(d, &e);
  }
  return true;
}

/* particles in the order and the places of the file; false: cut short, or (not *fits) other particles */
static bool get_places(FILE *f, dem_data *d, uint64_t *sum, bool *fits) {
  int np = d->nparticle, *at = malloc((size_t)np * 2 * sizeof *at), *from = at + np;
  place *places = malloc((size_t)np * sizeof *places);
  bool good = at && places && get(f, places, (size_t)np * sizeof *places, sum);
  for (int i = 0; good && i < np; i++)
    at[d->id[i]] = i;
  for (int i = 0; good && i < np; i++) {
    *fits = *fits && places[i].id < (uint64_t)np;
    from[i] = *fits ? at[places[i].id] : i;
  }
  good = good && dem_data_permute(d, from);
  for (int i = 0; good && i < np; i++)
    d->sphere[i].position = places[i].position;
  free(at);
  free(places);
  return good;
}

static tdm_status refuse(const dem_data *d, tdm_error *err, const char *what) {
  return tdm_fail(err, TDM_ERR_FILE, key,
                  "\"%s\" %s; delete the file to settle and store the bed anew, or give another name",
                  d->model->settle.store, what);
}

/* the file ended too early, or cannot be read at all (a folder) */
static tdm_status refuse_short(FILE *f, const dem_data *d, tdm_error *err) {
  if (ferror(f))
    return tdm_fail(err, TDM_ERR_FILE, key, "\"%s\" cannot be read: %s; name another file", d->model->settle.store,
                    strerror(errno));
  return refuse(d, err, "is cut short");
}

static tdm_status read_bed(FILE *f, dem_data *d, dem_settled *out, tdm_error *err) {
  header h;
  uint64_t sum = hash_start, stored;
  if (!get(f, &h, sizeof h, &sum))
    return refuse_short(f, d, err);
  if (memcmp(h.magic, magic, sizeof magic) != 0)
    return refuse(d, err, "is no stored bed");
  if (h.version != BED_VERSION)
    return refuse(d, err, "was written by another version of tandem");
  if (h.fingerprint != dem_bed_fingerprint(d->model) || h.nparticle != (uint64_t)d->model->nparticle)
    return refuse(d, err,
                  "holds the bed of another scene (particles, materials, shapes, poses, gravity or dem.settle differ)");
  if (!dem_pour_rest(d))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the particles of a stored bed");
  bool fits = h.ncolumn == (uint64_t)d->model->law->ncolumn;
  if (!get_places(f, d, &sum, &fits))
    return refuse_short(f, d, err);
  if (!get(f, d->lid, (size_t)d->model->nwall * sizeof *d->lid, &sum))
    return refuse_short(f, d, err);
  dem_walls_put(d);
  for (int i = 0; i < d->nparticle; i++)
    d->pace[i] = (dem_pace){0};
  d->list_valid = false; /* histories of the start are not these */
  d->since_sort = 0;     /* the order is the file's */
  if (!dem_lists_build(d))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the neighbour lists");
  d->since_sort = h.since_sort;
  if (!get_histories(f, d, put_pair, h.npair, &sum, &fits) || !get_histories(f, d, put_wall, h.nwall, &sum, &fits) ||
      fread(&stored, sizeof stored, 1, f) != 1)
    return refuse_short(f, d, err);
  if (stored != sum || !fits || fgetc(f) != EOF)
    return refuse(d, err, "is damaged");
  *out = (dem_settled){.rest = (h.rest & 1) != 0,
                       .pressed = (h.rest & 2) != 0,
                       .stored = true,
                       .dt = h.dt,
                       .time = h.time,
                       .speed = h.speed};
  return TDM_OK;
}

tdm_status dem_bed_read(dem_data *d, dem_settled *out, bool *found, tdm_error *err) {
  const char *name = d->model->settle.store;
  FILE *f = fopen(name, "rb");
  *found = f != NULL;
  if (!f)
    return errno == ENOENT ? TDM_OK
                           : tdm_fail(err, TDM_ERR_FILE, key, "\"%s\" cannot be read: %s", name, strerror(errno));
  read_bed(f, d, out, err);
  fclose(f);
  return err->status;
}

/* ---- writing ---- */

tdm_status dem_bed_check_writable(const dem_model *m, tdm_error *err) {
  char copy[4096];
  snprintf(copy, sizeof copy, "%s", m->settle.store);
  const char *folder = dirname(copy);
  if (access(folder, W_OK) != 0)
    return tdm_fail(err, TDM_ERR_FILE, key,
                    "\"%s\" cannot be written: folder \"%s\": %s; make the folder or name another one", m->settle.store,
                    folder, strerror(errno));
  return TDM_OK;
}

static bool put(FILE *f, const void *bytes, size_t n, uint64_t *sum) {
  *sum = hash_bytes(*sum, bytes, n);
  return fwrite(bytes, 1, n, f) == n;
}

/* the history of entry k; false when all of it is zero */
static bool history_of(const double *history, size_t capacity, size_t k, int ncolumn, entry *e) {
  bool any = false;
  *e = (entry){0};
  for (int q = 0; q < ncolumn; q++) {
    e->column[q] = history[(size_t)q * capacity + k];
    any = any || e->column[q] != 0;
  }
  return any;
}

/* the histories of all contacts; with f NULL only counted */
static bool put_histories(FILE *f, const dem_data *d, bool of_walls, uint64_t *count, uint64_t *sum) {
  const dem_pairs *p = &d->pairs;
  const dem_wall_contacts *w = &d->walls;
  int ncolumn = d->model->law->ncolumn;
  *count = 0;
  for (size_t k = 0; k < (of_walls ? w->count : p->count); k++) {
    entry e;
    if (!history_of(of_walls ? w->history : p->history, of_walls ? w->capacity : p->capacity, k, ncolumn, &e))
      continue;
    e.particle = (uint32_t)(of_walls ? w->entry[k].particle : p->one[k]);
    e.other = (uint32_t)(of_walls ? w->entry[k].wall : p->other[k]);
    ++*count;
    if (f && !put(f, &e, sizeof e, sum))
      return false;
  }
  return true;
}

static bool put_places(FILE *f, const dem_data *d, uint64_t *sum) {
  for (int i = 0; i < d->nparticle; i++) {
    place p = {d->id[i], d->sphere[i].position};
    if (!put(f, &p, sizeof p, sum))
      return false;
  }
  return true;
}

static bool write_bed(FILE *f, const dem_data *d, const dem_settled *settled) {
  uint64_t sum = hash_start;
  header h = {.version = BED_VERSION,
              .fingerprint = dem_bed_fingerprint(d->model),
              .nparticle = (uint64_t)d->nparticle,
              .ncolumn = (uint64_t)d->model->law->ncolumn,
              .since_sort = d->since_sort,
              .rest = (uint64_t)settled->rest + 2 * (uint64_t)settled->pressed,
              .dt = settled->dt,
              .time = settled->time,
              .speed = settled->speed};
  memcpy(h.magic, magic, sizeof magic);
  uint64_t count;
  put_histories(NULL, d, false, &h.npair, &sum);
  put_histories(NULL, d, true, &h.nwall, &sum);
  return put(f, &h, sizeof h, &sum) && put_places(f, d, &sum) &&
         put(f, d->lid, (size_t)d->model->nwall * sizeof *d->lid, &sum) && put_histories(f, d, false, &count, &sum) &&
         put_histories(f, d, true, &count, &sum) && fwrite(&sum, sizeof sum, 1, f) == 1;
}

tdm_status dem_bed_write(const dem_data *d, const dem_settled *settled, tdm_error *err) {
  const char *name = d->model->settle.store;
  char temporary[4200];
  snprintf(temporary, sizeof temporary, "%s.%ld.tmp", name, (long)getpid());
  FILE *f = fopen(temporary, "wb");
  bool good = f && write_bed(f, d, settled);
  good = f && fflush(f) == 0 && fsync(fileno(f)) == 0 && good;
  int error = errno;
  if (f && fclose(f) != 0 && good) {
    error = errno;
    good = false;
  }
  if (good && rename(temporary, name) != 0) {
    error = errno;
    good = false;
  }
  if (good)
    return TDM_OK;
  if (f)
    remove(temporary);
  return tdm_fail(err, TDM_ERR_FILE, key, "\"%s\" cannot be written: %s; make room or name another file", name,
                  strerror(error));
}
