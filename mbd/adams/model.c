/* Units, parts, markers and splines of an Adams data set: see model.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/adams/model.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- units ---- */

typedef struct {
  const char *name;
  double si; /* of a unit */
} unit;

enum { MOST_UNITS = 16 };

/* pound force and inch by definition, slinch: one pound force s^2 an inch */
static const double pound = 0.45359237, pound_force = 0.45359237 * 9.80665, inch = 0.0254, foot = 0.3048;

static tdm_status read_unit(const adm_reader *r, const char *name, const unit *units, double *si) {
  const char *words[MOST_UNITS + 1] = {NULL};
  for (int i = 0; units[i].name; i++)
    words[i] = units[i].name;
  const adm_attribute *a = adm_find(r, name);
  if (!a)
    return adm_fail(r->dataset, r->of->line, r->err, "UNITS has no %s; give FORCE, MASS, LENGTH and TIME, or SYSTEM",
                    name);
  const int k = adm_choose(r, a->value, a->line, words);
  if (k >= 0)
    *si = units[k].si;
  return r->err->status;
}

static tdm_status read_units(adm_model *m, const adm_statement *of, tdm_error *err) {
  static const char *const names[] = {"FORCE", "MASS", "LENGTH", "TIME", "SYSTEM", NULL};
  static const char *const systems[] = {"MKS", "CGS", "FPS", "IPS", NULL};
  const adm_units preset[] = {
      {1, 1, 1, 1}, {1e-5, 1e-3, 1e-2, 1}, {pound_force, pound, foot, 1}, {pound_force, pound, inch, 1}};
  const unit forces[] = {{"NEWTON", 1},
                         {"KNEWTON", 1e3},
                         {"MEGANEWTON", 1e6},
                         {"CENTINEWTON", 1e-2},
                         {"MILLINEWTON", 1e-3},
                         {"MICRONEWTON", 1e-6},
                         {"NANONEWTON", 1e-9},
                         {"DYNE", 1e-5},
                         {"KILOGRAM_FORCE", 9.80665},
                         {"POUND_FORCE", pound_force},
                         {"KPOUND_FORCE", 1e3 * pound_force},
                         {"OUNCE_FORCE", pound_force / 16},
                         {"POUNDAL", pound * foot},
                         {NULL, 0}};
  const unit masses[] = {{"KILOGRAM", 1},
                         {"GRAM", 1e-3},
                         {"MILLIGRAM", 1e-6},
                         {"MICROGRAM", 1e-9},
                         {"NANOGRAM", 1e-12},
                         {"TONNE", 1e3},
                         {"US_TON", 2e3 * pound},
                         {"POUND_MASS", pound},
                         {"KPOUND_MASS", 1e3 * pound},
                         {"OUNCE_MASS", pound / 16},
                         {"SLUG", pound_force / foot},
                         {"SLINCH", pound_force / inch},
                         {NULL, 0}};
  const unit lengths[] = {{"METER", 1},
                          {"MILLIMETER", 1e-3},
                          {"CENTIMETER", 1e-2},
                          {"KILOMETER", 1e3},
                          {"MICROMETER", 1e-6},
                          {"NANOMETER", 1e-9},
                          {"ANGSTROM", 1e-10},
                          {"INCH", inch},
                          {"FOOT", foot},
                          {"MILE", 5280 * foot},
                          {"YARD", 3 * foot},
                          {"MILS", inch / 1e3},
                          {"MICROINCH", inch / 1e6},
                          {NULL, 0}};
  const unit times[] = {{"SECOND", 1},  {"MILLISECONDS", 1e-3}, {"MICROSECOND", 1e-6}, {"NANOSECOND", 1e-9},
                        {"MINUTE", 60}, {"HOUR", 3600},         {"DAY", 86400},        {NULL, 0}};
  adm_reader r;
  adm_open(&r, &m->dataset, of, names, err);
  const adm_attribute *a = adm_find(&r, "SYSTEM");
  if (!err->status && a) {
    const int k = adm_choose(&r, a->value, a->line, systems);
    if (k >= 0)
      m->units = preset[k];
  } else if (!err->status) {
    read_unit(&r, "FORCE", forces, &m->units.force);
    read_unit(&r, "MASS", masses, &m->units.mass);
    read_unit(&r, "LENGTH", lengths, &m->units.length);
    read_unit(&r, "TIME", times, &m->units.time);
  }
  adm_note_unknown(m, &r);
  adm_close(&r);
  return err->status;
}

static tdm_status read_gravity(adm_model *m, const adm_statement *of, tdm_error *err) {
  static const char *const names[] = {"IGRAV", "JGRAV", "KGRAV", NULL};
  const double si = m->units.length / (m->units.time * m->units.time);
  adm_reader r;
  if (adm_open(&r, &m->dataset, of, names, err) == TDM_OK)
    m->gravity =
        tdm_scale(si, tdm_v3(adm_number(&r, "IGRAV", 0), adm_number(&r, "JGRAV", 0), adm_number(&r, "KGRAV", 0)));
  adm_note_unknown(m, &r);
  adm_close(&r);
  return err->status;
}

/* ---- poses ---- */

static tdm_vec3 read_point(const adm_reader *r, const char *name, double length, bool *there) {
  double x[3] = {0};
  *there = adm_numbers(r, name, 3, 3, x) == 3;
  return tdm_scale(length, tdm_v3(x[0], x[1], x[2]));
}

/* The direction of the part of v that is perpendicular to the unit vector e. */
static tdm_vec3 across(tdm_vec3 v, tdm_vec3 e) {
  return tdm_unit(tdm_axpy(-tdm_dot(v, e), e, v));
}

/* Position and orientation by `origin` and REULER, or the points `z` on the z axis and `x` in the half plane of x; with
 * USEXP `x` is on the x axis and `z` in the half plane of z. */
static tdm_pose read_pose(const adm_reader *r, const adm_model *m, const char *origin, const char *z, const char *x,
                          tdm_euler313 *euler) {
  tdm_pose pose = {.orientation = tdm_quat_identity()};
  double angle[3] = {0};
  bool there, has_z, has_x;
  pose.position = read_point(r, origin, m->units.length, &there);
  const tdm_vec3 on_z = tdm_sub(read_point(r, z, m->units.length, &has_z), pose.position);
  const tdm_vec3 on_x = tdm_sub(read_point(r, x, m->units.length, &has_x), pose.position);
  adm_numbers(r, "REULER", 3, 3, angle);
  *euler = (tdm_euler313){angle[0], angle[1], angle[2]};
  pose.orientation = tdm_euler313_to_quat(*euler);
  if (r->err->status || (!has_z && !has_x))
    return pose;
  tdm_vec3 e3 = tdm_unit(has_z ? on_z : tdm_cross(on_x, tdm_v3(0, 1, 0)));
  const tdm_vec3 other = has_x ? on_x : fabs(e3.x) < 0.9 ? tdm_v3(1, 0, 0) : tdm_v3(0, 1, 0);
  tdm_vec3 e1 = across(other, e3);
  if (has_z && has_x && adm_find(r, "USEXP")) {
    e1 = tdm_unit(on_x);
    e3 = across(on_z, e1);
  }
  const tdm_vec3 e2 = tdm_cross(e3, e1);
  if (!(tdm_norm(e3) > 0.5 && tdm_norm(e1) > 0.5))
    adm_fail(r->dataset, r->of->line, r->err, "%s/%ld: %s, %s and %s are on one line, so that they give no axes",
             r->of->keyword, r->of->id, origin, z, x);
  pose.orientation = tdm_quat_from_matrix((tdm_mat3){{{e1.x, e2.x, e3.x}, {e1.y, e2.y, e3.y}, {e1.z, e2.z, e3.z}}});
  *euler = tdm_euler313_from_quat(pose.orientation);
  return pose;
}

/* ---- parts ---- */

static tdm_status read_part(adm_model *m, const adm_statement *of, adm_part *part, tdm_error *err) {
  static const char *const names[] = {"GROUND", "MASS", "CM", "IM", "IP", "QG", "REULER", "ZG",    "XG", "VX",
                                      "VY",     "VZ",   "WX", "WY", "WZ", "VM", "WM",     "EXACT", NULL};
  const adm_units *u = &m->units;
  const double speed = u->length / u->time;
  tdm_euler313 euler;
  adm_reader r;
  *part = (adm_part){.of = of, .pose.orientation = tdm_quat_identity()};
  if (adm_open(&r, &m->dataset, of, names, err) == TDM_OK && adm_find(&r, "GROUND"))
    part->ground = true;
  else if (!err->status) {
    part->pose = read_pose(&r, m, "QG", "ZG", "XG", &euler);
    part->mass = u->mass * adm_number(&r, "MASS", 0);
    if (!err->status && !(part->mass > 0))
      adm_fail(&m->dataset, of->line, err,
               "PART/%ld has no mass, and a body of a scene needs one; give it MASS, CM and IP, or put its markers on "
               "another part",
               of->id);
    part->cm = adm_id(&r, "CM", true);
    part->im = adm_id(&r, "IM", false);
    if (!err->status && adm_numbers(&r, "IP", 3, 6, part->inertia) == 0)
      adm_fail(&m->dataset, of->line, err, "PART/%ld has no IP, its moments of inertia; add them", of->id);
    for (int i = 0; i < 6; i++)
      part->inertia[i] *= u->mass * u->length * u->length;
    part->vm = adm_id(&r, "VM", false);
    part->wm = adm_id(&r, "WM", false);
    part->velocity =
        tdm_scale(speed, tdm_v3(adm_number(&r, "VX", 0), adm_number(&r, "VY", 0), adm_number(&r, "VZ", 0)));
    part->angular =
        tdm_scale(1 / u->time, tdm_v3(adm_number(&r, "WX", 0), adm_number(&r, "WY", 0), adm_number(&r, "WZ", 0)));
  }
  adm_note_unknown(m, &r);
  adm_close(&r);
  return err->status;
}

static int find_part(const adm_model *m, long id) {
  int low = 0, high = m->npart - 1;
  while (low <= high) {
    const int k = low + (high - low) / 2;
    if (m->part[k].of->id == id)
      return k;
    if (m->part[k].of->id < id)
      low = k + 1;
    else
      high = k - 1;
  }
  return -1;
}

/* ---- markers ---- */

/* `current` is the identifier of the part statement before it, whose it is unless it says another; 0: none. */
static tdm_status read_marker(adm_model *m, const adm_statement *of, long current, adm_marker *marker, tdm_error *err) {
  static const char *const names[] = {"PART",  "QP",       "REULER",    "ZP",         "XP",
                                      "USEXP", "FLOATING", "FLEX_BODY", "POINT_MASS", NULL};
  adm_reader r;
  *marker = (adm_marker){.of = of, .part = -1};
  if (adm_open(&r, &m->dataset, of, names, err) == TDM_OK && !adm_find(&r, "FLOATING") && !adm_find(&r, "FLEX_BODY") &&
      !adm_find(&r, "POINT_MASS")) {
    long id = adm_id(&r, "PART", false);
    id = id > 0 ? id : current;
    marker->part = find_part(m, id);
    if (!err->status && marker->part < 0 && id > 0)
      adm_fail(&m->dataset, of->line, err, "MARKER/%ld is on PART/%ld, which the data set does not have", of->id, id);
    else if (marker->part < 0)
      adm_fail(&m->dataset, of->line, err, "MARKER/%ld is on no part; give it PART", of->id);
    const tdm_pose own = read_pose(&r, m, "QP", "ZP", "XP", &marker->euler);
    if (!err->status) {
      const tdm_pose of_part = m->part[marker->part].pose;
      marker->pose.position = tdm_pose_point(of_part, own.position);
      marker->pose.orientation = tdm_quat_mul(of_part.orientation, own.orientation);
      const tdm_quat q = of_part.orientation;
      if (q.x != 0 || q.y != 0 || q.z != 0)
        marker->euler = tdm_euler313_from_quat(marker->pose.orientation);
    }
  }
  adm_note_unknown(m, &r);
  adm_close(&r);
  return err->status;
}

int adm_find_marker(const adm_model *m, const adm_statement *of, int line, long id, tdm_error *err) {
  int low = 0, high = m->nmarker - 1;
  while (low <= high && !err->status) {
    const int k = low + (high - low) / 2;
    if (m->marker[k].of->id == id) {
      if (m->marker[k].part >= 0)
        return k;
      adm_fail(&m->dataset, line, err, "%s/%ld names MARKER/%ld, which is fixed to no rigid PART", of->keyword, of->id,
               id);
    } else if (m->marker[k].of->id < id)
      low = k + 1;
    else
      high = k - 1;
  }
  adm_fail(&m->dataset, line, err, "%s/%ld names MARKER/%ld, which the data set does not have; add it or name another",
           of->keyword, of->id, id);
  return -1;
}

/* ---- splines ---- */

static tdm_status read_spline(adm_model *m, const adm_statement *of, adm_spline *spline, tdm_error *err) {
  static const char *const names[] = {"X", "Y", NULL};
  adm_reader r;
  int n = 0;
  *spline = (adm_spline){.of = of};
  if (adm_open(&r, &m->dataset, of, names, err) == TDM_OK) {
    spline->x = adm_all_numbers(&r, "X", &spline->n);
    spline->y = adm_all_numbers(&r, "Y", &n);
    if (!err->status && (spline->n < 4 || n != spline->n))
      adm_fail(&m->dataset, of->line, err,
               "SPLINE/%ld has %d values of X and %d of Y; give four or more of X and as many of Y (splines of two "
               "variables and from files cannot be read)",
               of->id, spline->n, n);
    for (int i = 1; i < spline->n && !err->status; i++)
      if (!(spline->x[i] > spline->x[i - 1]))
        adm_fail(&m->dataset, of->line, err, "SPLINE/%ld: X must rise, but %g follows %g", of->id, spline->x[i],
                 spline->x[i - 1]);
  }
  adm_note_unknown(m, &r);
  adm_close(&r);
  return err->status;
}

/* ---- all of them ---- */

static int by_part(const void *a, const void *b) {
  const long x = ((const adm_part *)a)->of->id, y = ((const adm_part *)b)->of->id;
  return (x > y) - (x < y);
}

static int by_marker(const void *a, const void *b) {
  const long x = ((const adm_marker *)a)->of->id, y = ((const adm_marker *)b)->of->id;
  return (x > y) - (x < y);
}

static int by_identifier(const void *a, const void *b) {
  const adm_statement *x = *(const adm_statement *const *)a, *y = *(const adm_statement *const *)b;
  const int order = strcmp(x->keyword, y->keyword);
  if (order != 0)
    return order;
  return x->id != y->id ? (x->id > y->id) - (x->id < y->id) : (x->line > y->line) - (x->line < y->line);
}

/* Statements that are translated have identifiers, and those of a keyword are different. */
static tdm_status check_identifiers(const adm_dataset *d, tdm_error *err) {
  const adm_statement **sorted = malloc(((size_t)d->n + 1) * sizeof *sorted);
  int n = 0;
  if (!sorted)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %s", d->file);
  for (int i = 0; i < d->n && !err->status; i++) {
    const adm_statement *of = &d->statement[i];
    if (of->meaning != ADM_READ || strcmp(of->keyword, "UNITS") == 0 || strcmp(of->keyword, "ACCGRAV") == 0)
      continue;
    sorted[n++] = of;
    if (of->id == 0)
      adm_fail(d, of->line, err, "%s has no identifier; write %s/1 or another that is free", of->keyword, of->keyword);
  }
  qsort(sorted, (size_t)n, sizeof *sorted, by_identifier);
  for (int i = 1; i < n && !err->status; i++)
    if (strcmp(sorted[i]->keyword, sorted[i - 1]->keyword) == 0 && sorted[i]->id == sorted[i - 1]->id)
      adm_fail(d, sorted[i]->line, err, "%s/%ld is there already, at line %d; give one of them another identifier",
               sorted[i]->keyword, sorted[i]->id, sorted[i - 1]->line);
  free(sorted);
  return err->status;
}

static int count(const adm_model *m, const char *keyword) {
  int n = 0;
  for (int i = 0; i < m->dataset.n; i++)
    n += strcmp(m->dataset.statement[i].keyword, keyword) == 0;
  return n;
}

static tdm_status read_system(adm_model *m, tdm_error *err) {
  const adm_dataset *d = &m->dataset;
  if (count(m, "UNITS") != 1)
    return adm_fail(d, 1, err, "has %d UNITS statements; it needs one", count(m, "UNITS"));
  for (int i = 0; i < d->n && !err->status; i++)
    if (strcmp(d->statement[i].keyword, "UNITS") == 0)
      read_units(m, &d->statement[i], err);
  for (int i = 0; i < d->n && !err->status; i++)
    if (strcmp(d->statement[i].keyword, "ACCGRAV") == 0)
      read_gravity(m, &d->statement[i], err);
  return err->status;
}

static tdm_status read_parts(adm_model *m, tdm_error *err) {
  const adm_dataset *d = &m->dataset;
  int grounds = 0;
  for (int i = 0; i < d->n && !err->status; i++)
    if (strcmp(d->statement[i].keyword, "PART") == 0) {
      read_part(m, &d->statement[i], &m->part[m->npart++], err);
      grounds += m->part[m->npart - 1].ground;
    }
  qsort(m->part, (size_t)m->npart, sizeof *m->part, by_part);
  if (!err->status && (grounds > 1 || m->npart - grounds < 1))
    adm_fail(d, 1, err, "has %d ground parts and %d that move; give at most one and at least one", grounds,
             m->npart - grounds);
  return err->status;
}

static tdm_status read_markers(adm_model *m, tdm_error *err) {
  const adm_dataset *d = &m->dataset;
  long current = 0;
  for (int i = 0; i < d->n && !err->status; i++) {
    const adm_statement *of = &d->statement[i];
    if (strcmp(of->keyword, "PART") == 0)
      current = of->id;
    else if (strcmp(of->keyword, "MARKER") == 0)
      read_marker(m, of, current, &m->marker[m->nmarker++], err);
  }
  qsort(m->marker, (size_t)m->nmarker, sizeof *m->marker, by_marker);
  return err->status;
}

tdm_status adm_model_read(adm_model *m, tdm_error *err) {
  const adm_dataset *d = &m->dataset;
  m->part = calloc((size_t)count(m, "PART") + 1, sizeof *m->part);
  m->marker = calloc((size_t)count(m, "MARKER") + 1, sizeof *m->marker);
  m->spline = calloc((size_t)count(m, "SPLINE") + 1, sizeof *m->spline);
  m->joint = calloc((size_t)count(m, "JOINT") + 1, sizeof *m->joint);
  if (!m->part || !m->marker || !m->spline || !m->joint)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %s", d->file);
  if (check_identifiers(d, err) != TDM_OK || read_system(m, err) != TDM_OK || read_parts(m, err) != TDM_OK ||
      read_markers(m, err) != TDM_OK)
    return err->status;
  for (int i = 0; i < d->n && !err->status; i++)
    if (strcmp(d->statement[i].keyword, "SPLINE") == 0)
      read_spline(m, &d->statement[i], &m->spline[m->nspline++], err);
  return err->status;
}

void adm_model_free(adm_model *m) {
  for (int i = 0; i < m->nspline; i++) {
    free(m->spline[i].x);
    free(m->spline[i].y);
  }
  free(m->part);
  free(m->marker);
  free(m->joint);
  free(m->spline);
  json_t *const owned[] = {m->bodies, m->joints, m->drivers, m->forces, m->left_out, m->shown, m->notes};
  for (size_t i = 0; i < sizeof owned / sizeof owned[0]; i++)
    json_decref(owned[i]);
  adm_dataset_free(&m->dataset);
  *m = (adm_model){0};
}
