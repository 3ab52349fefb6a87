/* Fingerprints of a model: see fingerprint.h. What is hashed, in which order, stands in the lists of model/fields.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/store/fingerprint.h"

#include "dem/contact/table.h"
#include "dem/model/fields.h"
#include "dem/model/integrator.h"
#include "protocol/math/hash.h"

#include <string.h>

/* ---- the parts ---- */

/* RUN: what decides only how the run goes on; PLACED: where a wall stands, unless it is a lid; EACH: members of
 * members, which have their own parts. */
#define X(part, name) PART_##part,
enum { DEM_BED_PART_LIST(X) PART_RUN, PART_PLACED, PART_EACH };
#undef X

#define X(part, name) name,
const char *const dem_bed_part_names[] = {DEM_BED_PART_LIST(X)};
#undef X

/* ---- ways to hash a member x: h is the hash so far, s the struct, k its number among its like ---- */

static uint64_t hash_number(uint64_t h, double x) {
  return tdm_hash_bytes(h, &x, sizeof x);
}

static uint64_t hash_name(uint64_t h, const char *name) {
  return tdm_hash_bytes(h, name, strlen(name) + 1);
}

/* the shape's own data, by the shape */
static uint64_t hash_data(uint64_t h, const dem_wall *wall) {
  unsigned long long data = wall->shape->hash ? wall->shape->hash(wall) : 0;
  return tdm_hash_bytes(h, &data, sizeof data);
}

static bool is_zero(const double *x, size_t size) {
  bool zero = true;
  for (size_t k = 0; k < size / sizeof *x; k++)
    zero = zero && x[k] == 0;
  return zero;
}

#define AS_NUMBER(x) hash_number(h, (double)(x))
#define AS_BYTES(x) tdm_hash_bytes(h, &(x), sizeof(x)) /* of doubles, or of one number */
#define AS_NAME(x) hash_name(h, (x)->name)
#define AS_LAW(x) hash_name(h, (x)->head.name)
#define AS_WALL_LAW(x) ((x) == s->normal ? h : AS_LAW(x))
#define AS_TAIL(x) hash_name(h, (x) ? "clip" : "keep")
#define AS_FLAT(x) (s->flat >= 0 ? AS_NUMBER(x) : h)
#define AS_OF_SHAPE(x) h /* hash_walls: where it is not the body's */
#define AS_AXIS(x) hash_number(h, (double)(x)[k])
#define AS_POSE(x) tdm_hash_bytes(h, &(x).pose, sizeof(x).pose)
#define AS_SHAPE(x) hash_number(h, (x)->number)
#define AS_SHAPE_DATA(x) hash_data(h, s)
#define AS_MULTI_STEP(x) hash_number(hash_number(h, (double)(x).substeps), (x).mass)
#define AS_OPTION(x) ((x) ? hash_name(h, "with " #x) : h) /* of a scene without it as if there were none */
#define AS_OPTION_LAW(x) ((x)->head.none ? h : AS_LAW(x))
#define AS_OPTION_BYTES(x) (is_zero(x, sizeof(x)) ? h : AS_BYTES(x))
#define AS_MULTI_SETTING(x) (s->multi->head.none ? h : AS_BYTES(x))
#define AS_OPTION_NUMBER(x) ((x) > 0 ? AS_NUMBER(x) : h)
#define AS_OPTIONAL(x) ((x) ? AS_PARTICLES(x) : h)
#define AS_PARTICLES(x) tdm_hash_bytes(h, x, (size_t)s->nparticle * sizeof *(x))

/* ---- a function of each list ---- */

/* HASHER makes hash_NAME, which hashes the members of one part. It does not compile when a member has two rows; that
 * each has one is tested. */
#define HASHED(member, how, of)                    \
  if (PART_##of == part || PART_##of == PART_EACH) \
    h = AS_##how(s->member);
#define FREE(member, why)
#define ROW(member, ...) row_of_##member,

#define HASHER(name, type, LIST)                                            \
  static uint64_t hash_##name(uint64_t h, const type *s, int part, int k) { \
    enum { LIST(ROW, ROW) rows };                                           \
    (void)k;                                                                \
    LIST(HASHED, FREE)                                                      \
    return h;                                                               \
  }

HASHER(material, dem_material, DEM_MATERIAL_FIELDS)
HASHER(pair, dem_pair, DEM_PAIR_FIELDS)
HASHER(drive, dem_drive, DEM_DRIVE_FIELDS)
#define AS_DRIVE(x) hash_drive(h, &(x), part, 0)
HASHER(body, dem_body, DEM_BODY_FIELDS)
HASHER(wall, dem_wall, DEM_WALL_FIELDS)
HASHER(box, dem_box, DEM_BOX_FIELDS)
HASHER(axis, dem_domain_def, DEM_DOMAIN_FIELDS)
HASHER(settling, dem_settling, DEM_SETTLING_FIELDS)
HASHER(group, dem_group, DEM_GROUP_FIELDS)
HASHER(pouring, dem_pouring, DEM_POURING_FIELDS)
HASHER(sizes, dem_sizes, DEM_SIZES_FIELDS)
#define AS_SIZES(x) hash_sizes(h, &(x), part, 0)
HASHER(source, dem_source, DEM_SOURCE_FIELDS)
HASHER(sink, dem_sink, DEM_SINK_FIELDS)
HASHER(container, dem_container, DEM_CONTAINER_FIELDS)
HASHER(trace, dem_trace, DEM_TRACE_FIELDS)
HASHER(deck, dem_screening_deck, DEM_DECK_FIELDS)

static uint64_t hash_decks(uint64_t h, const dem_screening_def *s, int part) {
  for (int i = 0; i < s->ndeck; i++)
    h = hash_deck(h, &s->deck[i], part, i);
  return h;
}

#define AS_DECKS(x) hash_decks(h, s, part)
HASHER(screening, dem_screening_def, DEM_SCREENING_FIELDS)
#define AS_SCREENING(x) ((x).ndeck > 0 ? hash_screening(h, &(x), part, 0) : h)

/* ---- those of which a model has several ---- */

#define SEVERAL(names, name, type, count)                                                 \
  static uint64_t hash_##names(uint64_t h, const dem_model *m, const type *x, int part) { \
    for (int i = 0; i < (count); i++)                                                     \
      h = hash_##name(h, &x[i], part, i);                                                 \
    return h;                                                                             \
  }

SEVERAL(materials, material, dem_material, m->nmaterial)
SEVERAL(bodies, body, dem_body, m->nbody)
SEVERAL(boxes, box, dem_box, m->nbox)
SEVERAL(groups, group, dem_group, m->driven ? m->ngroup : 0)
SEVERAL(pourings, pouring, dem_pouring, m->npouring)
SEVERAL(sources, source, dem_source, m->nsource)
SEVERAL(sinks, sink, dem_sink, m->nsink)
SEVERAL(containers, container, dem_container, m->ncontainer)
SEVERAL(traces, trace, dem_trace, m->ntrace)

/* pairs that the scene does not have have no coefficients */
static uint64_t hash_pairs(uint64_t h, const dem_model *m, const dem_pair *pair, int part) {
  for (int i = 0; i < m->nmaterial * m->nmaterial; i++) {
    h = hash_number(h, pair[i].given);
    h = pair[i].given ? hash_pair(h, &pair[i], part, i) : h;
  }
  return h;
}

/* lids are away while settling */
static uint64_t hash_walls(uint64_t h, const dem_model *m, const dem_wall *wall, int part) {
  for (int w = 0; w < m->nwall; w++) {
    h = hash_wall(h, &wall[w], part, w);
    if (part == PART_MATERIALS && wall[w].material != m->body[wall[w].body].material)
      h = hash_number(hash_number(h, w), wall[w].material);
    if (part != PART_SHAPES)
      continue;
    bool lid = false;
    for (int i = 0; i < m->nbox; i++)
      lid = lid || m->box[i].lid == w;
    h = hash_number(h, lid);
    h = lid ? h : hash_wall(h, &wall[w], PART_PLACED, w);
  }
  return h;
}

static uint64_t hash_domain(uint64_t h, const dem_domain_def *domain, int part) {
  for (int axis = 0; domain->wanted && axis < 3; axis++)
    h = hash_axis(h, domain, part, axis);
  return h;
}

#define AS_MATERIALS(x) hash_materials(h, s, x, part)
#define AS_BODIES(x) hash_bodies(h, s, x, part)
#define AS_WALLS(x) hash_walls(h, s, x, part)
#define AS_BOXES(x) hash_boxes(h, s, x, part)
#define AS_PAIRS(x) hash_pairs(h, s, x, part)
#define AS_GROUPS(x) hash_groups(h, s, x, part)
#define AS_POURINGS(x) hash_pourings(h, s, x, part)
#define AS_SOURCES(x) hash_sources(h, s, x, part)
#define AS_SINKS(x) hash_sinks(h, s, x, part)
#define AS_CONTAINERS(x) hash_containers(h, s, x, part)
#define AS_TRACES(x) hash_traces(h, s, x, part)
#define AS_DOMAIN(x) hash_domain(h, &(x), part)
#define AS_SETTLING(x) hash_settling(h, &(x), part, 0)
HASHER(model, dem_model, DEM_MODEL_FIELDS)

/* ---- the fingerprints ---- */

void dem_fingerprint_bed_parts(const dem_model *m, uint64_t part[DEM_BED_PARTS]) {
  for (int p = 0; p < DEM_BED_PARTS; p++)
    part[p] = hash_model(TDM_HASH_START, m, p, 0);
}

uint64_t dem_fingerprint_bed(const dem_model *m) {
  uint64_t part[DEM_BED_PARTS];
  dem_fingerprint_bed_parts(m, part);
  return tdm_hash_bytes(TDM_HASH_START, part, sizeof part);
}

uint64_t dem_fingerprint_start(const dem_model *m) {
  const bool *periodic = m->domain.periodic;
  const double counts[] = {m->nmaterial, m->nbody, m->nwall, periodic[0], periodic[1], periodic[2]};
  uint64_t h = hash_model(TDM_HASH_START, m, PART_LAWS, 0);
  h = tdm_hash_bytes(h, counts, sizeof counts);
  h = hash_materials(h, m, m->material, PART_MATERIALS);
  return hash_boxes(hash_walls(h, m, m->wall, PART_SHAPES), m, m->box, PART_SHAPES);
}

uint64_t dem_fingerprint_whole(const dem_model *m) {
  return hash_model(dem_fingerprint_bed(m), m, PART_RUN, 0);
}
