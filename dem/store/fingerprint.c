/* Fingerprints of a model: see fingerprint.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/store/fingerprint.h"

#include "dem/contact/table.h"
#include "dem/model/integrator.h"
#include "protocol/base/hash.h"

#include <stddef.h>
#include <string.h>

static uint64_t hash_numbers(uint64_t h, const double *x, size_t n) {
  return tdm_hash_bytes(h, x, n * sizeof *x);
}

static uint64_t hash_vectors(uint64_t h, const tdm_vec3 *x, size_t n) {
  return tdm_hash_bytes(h, x, n * sizeof *x);
}

static uint64_t hash_walls(uint64_t h, const dem_model *m) {
  for (int w = 0; w < m->nwall; w++) {
    const dem_wall *wall = &m->wall[w];
    bool lid = false; /* away while settling */
    for (int k = 0; k < m->nbox; k++)
      lid = lid || m->box[k].lid == w;
    const double what[] = {wall->shape->number, wall->body, lid};
    h = hash_numbers(h, what, 3);
    if (lid)
      continue;
    h = hash_vectors(h, &wall->point, 1);
    h = hash_vectors(h, &wall->normal, 1);
    h = hash_vectors(h, &wall->half, 1);
    const double more[] = {wall->radius[0], wall->radius[1], wall->length, wall->inside,
                           wall->turn.w,    wall->turn.x,    wall->turn.y, wall->turn.z};
    h = hash_numbers(h, more, sizeof more / sizeof *more);
    unsigned long long data = wall->shape->hash ? wall->shape->hash(wall) : 0;
    h = tdm_hash_bytes(h, &data, sizeof data);
  }
  for (int k = 0; k < m->nbox; k++) {
    const double lid[] = {m->box[k].lid, m->box[k].gap, m->box[k].press};
    h = hash_numbers(h, lid, 3);
  }
  return h;
}

static uint64_t hash_name(uint64_t h, const char *name) {
  return tdm_hash_bytes(h, name, strlen(name) + 1);
}

static uint64_t hash_laws(uint64_t h, const dem_model *m) {
  for (dem_family f = 0; f < DEM_FAMILIES; f++)
    h = hash_name(h, dem_law_of(m, f)->name);
  h = hash_name(h, m->clip ? "clip" : "keep");
  return hash_numbers(h, m->normal_setting, DEM_SETTINGS_MAX);
}

/* dimension and domain; unchanged where the scene has neither */
static uint64_t hash_box(uint64_t h, const dem_model *m) {
  const dem_domain_def *box = &m->domain;
  const double flat[] = {m->flat, m->flat_at};
  if (m->flat >= 0)
    h = hash_numbers(h, flat, 2);
  for (int a = 0; box->wanted && a < 3; a++) {
    const double side[] = {box->periodic[a], box->low[a], box->length[a]};
    h = hash_numbers(h, side, 3);
  }
  return h;
}

static uint64_t hash_materials(uint64_t h, const dem_model *m) {
  for (int k = 0; k < m->nmaterial; k++) {
    const double material[] = {m->material[k].young, m->material[k].poisson};
    h = hash_numbers(h, material, 2);
  }
  return h;
}

static uint64_t hash_pairs(uint64_t h, const dem_model *m, const dem_pair *pairs) {
  for (int k = 0; k < m->nmaterial * m->nmaterial; k++) {
    const dem_pair *p = &pairs[k];
    const double given = p->given;
    h = hash_numbers(h, &given, 1);
    if (p->given) /* all coefficients, doubles from the first on */
      h = tdm_hash_bytes(h, &p->restitution, sizeof *p - offsetof(dem_pair, restitution));
  }
  return h;
}

static uint64_t hash_groups(uint64_t h, const dem_model *m) {
  for (int g = 0; m->driven && g < m->ngroup; g++) {
    const double of[] = {m->group[g].first, m->group[g].count, m->group[g].fixed};
    h = hash_numbers(h, of, 3);
    h = hash_vectors(h, &m->group[g].force, 1);
    h = hash_vectors(h, &m->group[g].acceleration, 1);
  }
  return h;
}

/* the particles that fall in while settling; unchanged where there are none */
static uint64_t hash_pourings(uint64_t h, const dem_model *m) {
  for (int k = 0; k < m->npouring; k++) {
    const dem_pouring *p = &m->pouring[k];
    const double numbers[] = {p->first, p->count, p->largest};
    h = hash_numbers(h, numbers, 3);
    h = tdm_hash_bytes(h, &p->seed, sizeof p->seed);
    h = tdm_hash_bytes(h, &p->frame, sizeof p->frame);
    h = hash_vectors(h, &p->low, 1);
    h = hash_vectors(h, &p->high, 1);
  }
  return h;
}

static uint64_t hash_sizes(uint64_t h, const dem_sizes *s) {
  const double numbers[] = {s->distribution, s->min, s->max, s->mean, s->deviation, s->nradius};
  h = hash_numbers(h, numbers, sizeof numbers / sizeof *numbers);
  h = hash_numbers(h, s->radius, (size_t)s->nradius);
  return hash_numbers(h, s->upto, (size_t)s->nradius);
}

/* belts: they rest while settling */
static uint64_t hash_surfaces(uint64_t h, const dem_model *m) {
  for (int w = 0; w < m->nwall; w++) {
    h = hash_vectors(h, &m->wall[w].surface.velocity, 1);
    h = hash_vectors(h, &m->wall[w].surface.angular, 1);
  }
  return h;
}

/* bodies are held while settling: their twists do not count */
static uint64_t hash_poses(uint64_t h, const dem_model *m) {
  for (int b = 0; b < m->nbody; b++)
    h = tdm_hash_bytes(h, &m->body[b].start.pose, sizeof m->body[b].start.pose);
  return h;
}

static uint64_t hash_particles(uint64_t h, const dem_model *m) {
  size_t np = (size_t)m->nparticle;
  h = hash_numbers(h, (const double[]){m->nparticle}, 1);
  h = hash_numbers(h, m->radius, np);
  h = hash_numbers(h, m->mass, np);
  h = tdm_hash_bytes(h, m->particle_material, np * sizeof *m->particle_material);
  h = hash_vectors(h, m->position, np);
  h = hash_vectors(h, m->velocity, np);
  return hash_vectors(h, m->spin, np);
}

static uint64_t hash_body_materials(uint64_t h, const dem_model *m) {
  for (int b = 0; b < m->nbody; b++)
    h = hash_numbers(h, (const double[]){m->body[b].material}, 1);
  return h;
}

#define X(part, name) name,
const char *const dem_bed_part_names[] = {DEM_BED_PART_LIST(X)};
#undef X

void dem_fingerprint_bed_parts(const dem_model *m, uint64_t part[DEM_BED_PARTS]) {
  const dem_settling *s = &m->settle;
  const double settle[] = {s->speed, s->max_time, s->dt, s->drag};
  const double counts[] = {m->nmaterial, m->nbody, m->nwall};
  part[DEM_BED_LAWS] = hash_laws(TDM_HASH_START, m);
  part[DEM_BED_BOX] = hash_box(TDM_HASH_START, m);
  part[DEM_BED_SETTLE] = hash_numbers(TDM_HASH_START, settle, sizeof settle / sizeof *settle);
  part[DEM_BED_GRAVITY] = hash_vectors(TDM_HASH_START, &m->gravity, 1);
  part[DEM_BED_MATERIALS] = hash_body_materials(hash_materials(TDM_HASH_START, m), m);
  part[DEM_BED_PAIRS] = hash_pairs(TDM_HASH_START, m, m->settle_pair);
  part[DEM_BED_POSES] = hash_poses(TDM_HASH_START, m);
  part[DEM_BED_SHAPES] = hash_walls(hash_numbers(TDM_HASH_START, counts, 3), m);
  part[DEM_BED_POURED] = hash_pourings(TDM_HASH_START, m);
  part[DEM_BED_PARTICLES] = hash_particles(TDM_HASH_START, m);
  part[DEM_BED_GROUPS] = hash_groups(TDM_HASH_START, m);
}

uint64_t dem_fingerprint_bed(const dem_model *m) {
  uint64_t part[DEM_BED_PARTS];
  dem_fingerprint_bed_parts(m, part);
  return tdm_hash_bytes(TDM_HASH_START, part, sizeof part);
}

uint64_t dem_fingerprint_start(const dem_model *m) {
  const double counts[] = {m->nmaterial,         m->nbody, m->nwall, m->domain.periodic[0], m->domain.periodic[1],
                           m->domain.periodic[2]};
  uint64_t h = hash_numbers(hash_laws(TDM_HASH_START, m), counts, 6);
  return hash_walls(hash_materials(h, m), m);
}

uint64_t dem_fingerprint_whole(const dem_model *m) {
  const double counts[] = {m->nsource,        m->nsink, m->ncoupled, m->nload, (double)m->multi_step.substeps,
                           m->multi_step.mass};
  uint64_t h = hash_numbers(dem_fingerprint_bed(m), counts, 6);
  h = hash_name(h, m->integrator->name);
  h = hash_numbers(h, m->domain.rate, 3);
  h = hash_surfaces(hash_pairs(h, m, m->pair), m);
  for (int s = 0; s < m->nsource; s++) {
    const dem_source *source = &m->source[s];
    const double numbers[] = {source->material,      source->mass,      source->rate,   source->mass_rate,
                              source->start,         source->end,       source->factor, source->relative,
                              (double)source->count, source->total_mass};
    h = hash_numbers(h, numbers, sizeof numbers / sizeof *numbers);
    h = hash_sizes(h, &source->sizes);
    h = hash_vectors(h, &source->low, 1);
    h = hash_vectors(h, &source->high, 1);
    h = hash_vectors(h, &source->velocity, 1);
    h = tdm_hash_bytes(h, &source->seed, sizeof source->seed);
  }
  for (int s = 0; s < m->nsink; s++) { /* what a sink has counted is by its classes */
    const double classes = m->sink[s].nedge;
    h = hash_numbers(hash_numbers(h, &classes, 1), m->sink[s].edge, (size_t)m->sink[s].nedge);
  }
  return h;
}
