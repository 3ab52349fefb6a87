/* The report of READY: see report.h. Its keys are in docs/dem.md. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/adapter/report.h"

#include "dem/bodies/walls.h"
#include "dem/contact/table.h"
#include "dem/seam/homes.h"
#include "dem/seam/sums.h"
#include "dem/state/wall_gap.h"
#include "dem/step/integrate.h"
#include "protocol/scene/json.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* mass, mass times position */
static void add_mass(const dem_data *d, int chunk, const void *of, double *sums) {
  tdm_vec3 com = {0, 0, 0};
  (void)of;
  for (int i = dem_chunk_start(d, chunk); i < dem_chunk_start(d, chunk + 1); i++) {
    sums[0] += d->state.mass[i];
    com = tdm_axpy(d->state.mass[i], d->state.sphere[i].position, com);
  }
  memcpy(sums + 1, &com, sizeof com);
}

/* inertia about the centre `of`, row by row */
static void add_inertia(const dem_data *d, int chunk, const void *of, double *sums) {
  const tdm_vec3 *com = of;
  for (int i = dem_chunk_start(d, chunk); i < dem_chunk_start(d, chunk + 1); i++) {
    tdm_vec3 r = tdm_sub(d->state.sphere[i].position, *com);
    const double x[3] = {r.x, r.y, r.z};
    double own = 0.4 * d->state.mass[i] * d->state.sphere[i].radius * d->state.sphere[i].radius, r2 = tdm_dot(r, r);
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++)
        sums[3 * a + b] += (a == b ? own + d->state.mass[i] * r2 : 0) - d->state.mass[i] * x[a] * x[b];
  }
}

dem_fill dem_fill_now(dem_data *d) {
  double sums[4];
  dem_sum_chunks(d, 4, add_mass, NULL, sums);
  dem_fill f = {.mass = sums[0], .com = tdm_v3(sums[1], sums[2], sums[3])};
  f.com = f.mass > 0 ? tdm_scale(1 / f.mass, f.com) : f.com;
  dem_sum_chunks(d, 9, add_inertia, &f.com, &f.inertia.m[0][0]);
  return f;
}

/* ---- warnings and notes ---- */

static void warn(dem_report *r, const char *path, const char *format, ...) __attribute__((format(printf, 3, 4)));

static void warn(dem_report *r, const char *path, const char *format, ...) {
  const bool full = r->nwarning == DEM_WARNINGS_MAX;
  tdm_warning *w = &r->warning[full ? DEM_WARNINGS_MAX - 1 : r->nwarning++];
  if (full) { /* the last one stands for the rest */
    tdm_warning_set(w, "dem", "there are more than %d doubts about this scene; mend the first ones",
                    DEM_WARNINGS_MAX - 1);
    return;
  }
  va_list args;
  va_start(args, format);
  tdm_warning_vset(w, path, format, args);
  va_end(args);
}

/* a line for the reader of the report: worth knowing, no reason for doubt */
static void note(dem_report *r, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void note(dem_report *r, const char *format, ...) {
  char text[TDM_MESSAGE_MAX];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  json_array_append_new(json_object_get(r->json, "notes"), json_string(text));
}

static void warn_start(dem_report *r, const dem_data *d, const dem_settled *settled, int nbehind) {
  const dem_model *m = d->model;
  if (nbehind > 0)
    warn(r, "dem.particles",
         "%d particles are behind a plane, which does not act on them; planes are infinite, so move "
         "the particles or the plane unless this is meant",
         nbehind);
  if (!settled->rest)
    warn(r, "dem.settle",
         "the bed did not come to rest within max_time = %g s: a particle still moves at %.3g m/s; raise "
         "max_time or speed (%g m/s), or lower restitution",
         m->settle.max_time, settled->speed, m->settle.speed);
  if (!settled->pressed)
    warn(r, "dem.bodies",
         "a lid did not reach its force within dem.settle.max_time = %g s; lower \"press\", or raise max_time",
         m->settle.max_time);
  for (int k = 0; k < m->nbox; k++)
    if (m->box[k].lid >= 0 && m->box[k].press > 0 && dem_deepest(d, m->box[k].lid) > 0.1)
      warn(r, "dem.bodies",
           "a lid is pressed %.2g of a radius into a particle; lower \"press\", or raise the stiffness",
           dem_deepest(d, m->box[k].lid));
  const long lost = m->settle.wanted ? dem_count_lost(d) : 0;
  if (lost > 0)
    warn(r, "dem.settle",
         "%ld particles went through a wall while settling; reduce settle.dt (%g s) or start them with "
         "less overlap and speed",
         lost, settled->dt);
}

/* is a region for spheres up to this radius altogether behind a plane, or outside an endless cylinder? */
static bool behind(const dem_data *d, tdm_pose frame, tdm_vec3 low, tdm_vec3 high, double radius) {
  const dem_model *m = d->model;
  for (int w = 0; w < m->nwall; w++) {
    int out = 0;
    for (int k = 0; k < 9 && m->wall[w].endless; k++) {
      tdm_vec3 x = tdm_v3(k & 1 ? low.x : high.x, k & 2 ? low.y : high.y, k & 4 ? low.z : high.z);
      if (k == 8)
        x = tdm_scale(0.5, tdm_add(low, high));
      out += dem_wall_behind(&m->wall[w], dem_gap_at(d, w, tdm_pose_point(frame, x), NULL), radius);
    }
    if (out == 9)
      return true;
  }
  return false;
}

static void warn_behind(dem_report *r, const dem_data *d) {
  static const char says[] = "is altogether behind a plane, which does not act on what comes there; planes are "
                             "infinite, so move the region or the plane unless this is meant";
  const dem_model *m = d->model;
  char path[TDM_PATH_MAX];
  for (int s = 0; s < m->nsource; s++) {
    snprintf(path, sizeof path, "dem.sources[%d]", s);
    if (behind(d, (tdm_pose){.orientation = tdm_quat_identity()}, m->source[s].low, m->source[s].high,
               m->source[s].sizes.max))
      warn(r, path, "%s", says);
  }
  for (int k = 0; k < m->npouring; k++) {
    const dem_pouring *p = &m->pouring[k];
    snprintf(path, sizeof path, "dem.particles[%d]", p->entry);
    if (behind(d, p->frame, p->low, p->high, p->largest))
      warn(r, path, "%s", says);
  }
}

/* walls have no images: one that reaches a face of a box that repeats ends there */
static void warn_repeats(dem_report *r, const dem_data *d) {
  const dem_model *m = d->model;
  double radius = m->largest_radius;
  for (int w = 0; w < m->nwall; w++)
    for (int a = 0; a < 3; a++) {
      tdm_vec3 up = {0, 0, 0};
      (&up.x)[a] = 1;
      double low, high, begin = d->state.domain.low[a], end = begin + d->state.domain.length[a];
      if (!d->state.domain.periodic[a] || !dem_wall_extent(&m->wall[w], &d->state.wall[w], up, &low, &high) ||
          high < begin - radius || low > end + radius || (low >= begin + radius && high <= end - radius) ||
          (low <= begin - radius && high >= end + radius))
        continue;
      warn(r, "dem.bodies",
           "a wall of \"%s\" reaches a face of dem.domain, which repeats in %c, but walls do not repeat: what passes "
           "the face loses it; let the wall reach beyond both faces by a radius, or end before them",
           m->body[m->wall[w].body].name, "xyz"[a]);
      break;
    }
}

/* in two dimensions nothing falls out of the plane */
static void warn_plane(dem_report *r, const dem_model *m) {
  double across = m->flat >= 0 ? (&m->gravity.x)[m->flat] : 0;
  if (across != 0)
    warn(r, "dem.gravity",
         "its %c component, %g m/s2, is across the plane of dem.dimension 2 and does nothing; set it to 0, or choose "
         "another dem.plane",
         "xyz"[m->flat], across);
}

static void warn_triangles(dem_report *r, const dem_model *m) {
  if (m->triangle_forces && m->ncoupled > 0)
    warn(r, "dem.triangle_forces", "is for tandem-dem run, which writes files for ParaView; remove it");
}

static void warn_step(dem_report *r, const dem_model *m, const dem_limits *limits) {
  if (m->dt > limits->most)
    warn(r, "time.dt",
         "%g s is above %s, %.4g s (Rayleigh step %.4g s, contact time %.4g s at %.3g m/s); use at most "
         "%.3g s, softer or larger particles, or give dem.expected_speed if the speed is lower",
         m->dt, limits->by, limits->most, limits->rayleigh, limits->contact, limits->speed, limits->most);
  else if (m->dt > DEM_CONTACT_SHARE * limits->contact)
    note(r,
         "time.dt = %g s takes %.1f steps for the shortest contact, %.3g s at %.3g m/s: 20 are recommended, for fast "
         "impacts only",
         m->dt, limits->contact / m->dt, limits->contact, limits->speed);
}

/* largest overlap of an impact of a particle with its like or with a wall, as a share of the radius */
static double deepest_impact(const dem_model *m, int material, double radius, double mass, double speed) {
  const dem_pair *row = &m->pair[material * m->nmaterial];
  double deepest = 0;
  for (int k = 0; k < m->nmaterial; k++) {
    if (!row[k].given)
      continue;
    deepest = fmax(deepest, dem_normal_overlap(m, &row[k], (dem_impact){mass / 2, radius / 2, speed, 0}) / radius);
    if (m->nwall > 0)
      deepest = fmax(deepest, dem_normal_overlap(m, &row[k], (dem_impact){mass, radius, speed, 0}) / radius);
  }
  return deepest;
}

/* the deepest impact of any particle, and of which radius */
typedef struct {
  double share, radius, smallest; /* smallest radius of all [m] */
} sinking;

static void include_kind(sinking *s, const dem_model *m, int material, double radius, double mass, double speed) {
  const double share = deepest_impact(m, material, radius, mass, speed);
  s->radius = share > s->share ? radius : share == s->share ? fmax(s->radius, radius) : s->radius;
  s->share = fmax(s->share, share);
}

/* of the particles that are there, then of those that sources will make */
static sinking find_sinking(const dem_data *d, double speed) {
  const dem_model *m = d->model;
  const int first = dem_home_first_particle(d), end = dem_home_end_particle(d);
  sinking found = {.smallest = INFINITY};
  for (int i = first; i < end; i++) {
    const double radius = d->state.sphere[i].radius;
    found.smallest = fmin(found.smallest, radius);
    if (i == first || radius != d->state.sphere[i - 1].radius || d->state.mass[i] != d->state.mass[i - 1] ||
        d->state.material[i] != d->state.material[i - 1])
      include_kind(&found, m, d->state.material[i], radius, d->state.mass[i], speed);
  }
  found.smallest = dem_homes_smallest(d, found.smallest);
  const double share = dem_homes_largest(d, found.share);
  found.radius = dem_homes_largest(d, found.share == share ? found.radius : 0);
  found.share = share;
  for (int k = 0; k < m->nsource; k++) {
    const dem_source *s = &m->source[k];
    const double full = dem_sphere_mass(m->material[s->material].density, s->sizes.max);
    found.smallest = fmin(found.smallest, s->sizes.min);
    include_kind(&found, m, s->material, s->sizes.max, s->mass > 0 ? s->mass : full, speed);
  }
  return found;
}

/* impacts and motions that the guard would have to tell of */
static void warn_speed(dem_report *r, const dem_data *d, double speed) {
  const dem_model *m = d->model;
  if (m->guard.every == 0 || !(speed > 0))
    return;
  const sinking found = find_sinking(d, speed);
  if (found.share > m->guard.overlap)
    warn(r, "dem.guard.overlap",
         "is %g, but a particle of radius %g m that arrives at %.3g m/s sinks in by %.2g of it without damping, and "
         "may "
         "pass through walls and particles; use a stiffer material or lower speeds, or give dem.expected_speed if the "
         "speed is lower",
         m->guard.overlap, found.radius, speed, found.share);
  for (int b = 0; b < m->nbody; b++) {
    double way = m->body[b].drive.given ? m->dt * dem_drive_speed(&m->body[b].drive, 0) : 0;
    if (way > found.smallest)
      warn(r, "dem.bodies",
           "\"%s\" moves up to %.3g m in a step, more than the smallest radius %.3g m: it may pass through particles; "
           "reduce time.dt or its speed",
           m->body[b].name, way, found.smallest);
  }
}

/* ---- figures ---- */

static json_t *vector(tdm_vec3 v) {
  return json_pack("[f,f,f]", v.x, v.y, v.z);
}

static json_t *report_fill(const dem_data *d, const dem_fill *fill) {
  json_t *inertia = json_array(), *r = json_object();
  for (int k = 0; k < 9; k++)
    json_array_append_new(inertia, tdm_number_to_json(fill->inertia.m[k / 3][k % 3]));
  json_object_set_new(r, "number", json_integer(d->state.nparticle));
  json_object_set_new(r, "mass", tdm_number_to_json(fill->mass));
  json_object_set_new(r, "com", vector(fill->com));
  json_object_set_new(r, "inertia", inertia);
  return r;
}

/* one limit: the time, the share of it that the step takes, and the share it may take */
static json_t *report_limit(double time, double dt, double most) {
  json_t *r = json_object();
  json_object_set_new(r, "time", tdm_number_to_json(time));
  json_object_set_new(r, "share", tdm_number_to_json(dt / time));
  json_object_set_new(r, "recommended", tdm_number_to_json(most));
  json_object_set_new(r, "kept", json_boolean(!(dt > most * time)));
  return r;
}

static void report_limits(dem_report *r, const dem_model *m, const dem_limits *limits) {
  json_object_set_new(r->json, "rayleigh_step", tdm_number_to_json(limits->rayleigh));
  json_object_set_new(r->json, "contact_time", tdm_number_to_json(limits->contact));
  json_object_set_new(r->json, "contact_speed", tdm_number_to_json(limits->speed));
  json_object_set_new(r->json, "steps_per_contact", tdm_number_to_json(limits->contact / m->dt));
  json_object_set_new(r->json, "coordination", tdm_number_to_json(limits->coordination));
  json_object_set_new(r->json, "eigen_step", tdm_number_to_json(limits->eigen));
  json_object_set_new(r->json, "step_limit", tdm_number_to_json(limits->step));
  json_t *all = json_object();
  json_object_set_new(all, "rayleigh", report_limit(limits->rayleigh, m->dt, DEM_RAYLEIGH_SHARE));
  json_object_set_new(all, "eigenfrequency", report_limit(limits->eigen, m->dt, DEM_EIGEN_SHARE));
  json_object_set_new(all, "contact", report_limit(limits->contact, m->dt, DEM_CONTACT_SHARE));
  json_object_set_new(r->json, "limits", all);
}

/* of the particles that are there or that a source will make [kg] */
static double heaviest_particle(const dem_data *d) {
  const dem_model *m = d->model;
  double heaviest = 0;
  for (int i = dem_home_first_particle(d); i < dem_home_end_particle(d); i++)
    heaviest = fmax(heaviest, d->state.mass[i]);
  heaviest = dem_homes_largest(d, heaviest);
  for (int s = 0; s < m->nsource; s++) {
    double r = m->source[s].sizes.max, full = dem_sphere_mass(m->material[m->source[s].material].density, r);
    heaviest = fmax(heaviest, m->source[s].mass > 0 ? m->source[s].mass : full);
  }
  return heaviest;
}

/* particles against each coupled body */
static void report_ratios(dem_report *r, const dem_data *d, double mass) {
  const dem_model *m = d->model;
  double heaviest = heaviest_particle(d);
  json_t *all = json_array();
  for (int c = 0; c < m->ncoupled; c++) {
    const dem_body *b = &m->body[m->coupled_body[c]];
    json_t *one = json_object();
    json_object_set_new(one, "body", json_string(b->name));
    json_object_set_new(one, "mass", tdm_number_to_json(b->mass));
    json_object_set_new(one, "all_particles", tdm_number_to_json(mass / b->mass));
    json_object_set_new(one, "heaviest_particle", tdm_number_to_json(heaviest / b->mass));
    json_array_append_new(all, one);
    if (mass > b->mass && !m->proxy) /* which feels the mass within the window */
      note(r,
           "the particles (%.4g kg) are heavier than \"%s\" (%.4g kg): schemes that extrapolate the load lose "
           "stability as the window grows; keep coupling.n small",
           mass, b->name, b->mass);
    if (m->wall_mass > 0 && b->mass < 100 * heaviest)
      warn(r, "dem.contact.wall_mass",
           "takes %g kg for \"%s\" (%.4g kg), which is lighter than 100 times the heaviest particle (%.4g kg): the "
           "contacts damp too much; use \"body\"",
           m->wall_mass, b->name, b->mass, heaviest);
  }
  json_object_set_new(r->json, "mass_ratios", all);
}

static void report_lids(dem_report *r, const dem_data *d) {
  const dem_model *m = d->model;
  json_t *all = json_array();
  for (int k = 0; k < m->nbox; k++) {
    int w = m->box[k].lid;
    if (w < 0)
      continue;
    const dem_wall *wall = &m->wall[w];
    tdm_vec3 at = tdm_axpy(-d->state.lid[w], wall->normal, wall->point);
    json_t *one = json_object();
    json_object_set_new(one, "body", json_string(m->body[wall->body].name));
    json_object_set_new(one, "point", vector(at));
    json_object_set_new(one, "outward", vector(tdm_scale(-1, wall->normal)));
    json_object_set_new(one, "over_face", tdm_number_to_json(d->state.lid[w]));
    json_array_append_new(all, one);
  }
  json_object_set_new(r->json, "lids", all);
}

/* Files in millimetres, and scales that were applied twice: sizes that no machine has beside these particles. */
static void warn_scale(dem_report *r, const dem_data *d) {
  const double many = 1000, large = 20, few = 0.1; /* diameters; [m]; diameters */
  const dem_model *m = d->model;
  const double diameter = 2 * m->largest_radius;
  for (int w = 0; w < m->nwall; w++) {
    const dem_wall *wall = &m->wall[w];
    if (!wall->shape->file || !dem_wall_ends(wall) || wall->plates || diameter == 0)
      continue;
    const dem_geometry *g = &m->geometry[wall->geometry];
    const char *file = wall->shape->file(wall);
    tdm_vec3 low, high;
    wall->shape->box(wall, &low, &high);
    double size = fmax(high.x - low.x, fmax(high.y - low.y, high.z - low.z));
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.bodies[%d].shapes[%d].scale", g->body, g->number);
    if (size > many * diameter && size > large)
      warn(r, path,
           "makes \"%s\" %.3g m wide, %.3g diameters of the largest particle; is the file in millimetres? Give "
           "\"scale\": 0.001 then",
           file, size, size / diameter);
    else if (size < few * diameter)
      warn(r, path,
           "makes \"%s\" %.3g m wide, %.2g diameters of the largest particle; a file in metres needs \"scale\": 1",
           file, size, size / diameter);
  }
}

static void report_meshes(dem_report *r, const dem_model *m) {
  json_t *all = json_array(), *notes = json_object_get(r->json, "notes");
  for (int w = 0; w < m->nwall; w++) {
    const dem_wall *wall = &m->wall[w];
    if (!wall->shape->report)
      continue;
    json_t *one = wall->shape->report(wall, notes);
    json_object_set_new(one, "body", json_string(m->body[wall->body].name));
    json_array_append_new(all, one);
  }
  json_object_set_new(r->json, "meshes", all);
}

tdm_status dem_report_make(dem_report *r, dem_data *d, const dem_settled *settled, int nbehind, tdm_error *err) {
  const dem_model *m = d->model;
  *r = (dem_report){.json = json_object()};
  json_object_set_new(r->json, "notes", json_array());
  dem_fill fill = dem_fill_now(d);
  if (dem_limits_expected(d, &r->limits, err))
    return err->status;
  json_object_set_new(r->json, "particles", json_integer(d->state.nparticle));
  json_object_set_new(r->json, "particle_mass", tdm_number_to_json(fill.mass));
  json_object_set_new(r->json, "fill", report_fill(d, &fill));
  json_object_set_new(r->json, "bodies", json_integer(m->nbody));
  json_object_set_new(r->json, "walls", json_integer(m->nwall));
  json_object_set_new(r->json, "sources", json_integer(m->nsource));
  json_object_set_new(r->json, "sinks", json_integer(m->nsink));
  json_object_set_new(r->json, "contacts", json_integer(d->state.ncontact));
  for (dem_family f = 0; f < DEM_FAMILIES; f++)
    json_object_set_new(r->json, dem_family_names[f], json_string(dem_law_of(m, f)->name));
  if (m->wall_normal != m->normal)
    json_object_set_new(r->json, "wall_normal", json_string(m->wall_normal->head.name));
  json_object_set_new(r->json, "tail", json_string(m->clip ? "clip" : "keep"));
  json_object_set_new(r->json, "integrator", json_string(m->integrator->name));
  json_object_set_new(r->json, "simd", json_string(m->simd));
  json_object_set_new(r->json, "skin", m->skin > 0 ? tdm_number_to_json(m->skin) : json_string("auto"));
  warn_start(r, d, settled, nbehind);
  warn_behind(r, d);
  warn_repeats(r, d);
  if (m->start && m->settle.wanted)
    note(r, "the particles of dem.start settled again, as dem.settle asks for");
  report_limits(r, m, &r->limits);
  warn_step(r, m, &r->limits);
  warn_speed(r, d, r->limits.speed);
  warn_plane(r, m);
  warn_scale(r, d);
  warn_triangles(r, m);
  report_ratios(r, d, fill.mass);
  report_lids(r, d);
  report_meshes(r, m);
  if (m->settle.wanted)
    json_object_set_new(r->json, "settle",
                        json_pack("{s:b, s:b, s:f, s:f, s:f}", "rest", settled->rest, "stored", settled->stored, "time",
                                  settled->time, "dt", settled->dt, "speed", settled->speed));
  return TDM_OK;
}

void dem_report_flow(dem_report *r, const dem_data *d) {
  for (int s = 0; s < d->model->nsource; s++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.sources[%d]", s);
    if (d->state.source[s].blocked)
      warn(r, path,
           "has no room for its particle %llu at the start: a particle or a wall is there; it waits until there is, "
           "or "
           "move the source",
           (unsigned long long)d->state.source[s].made);
  }
}
