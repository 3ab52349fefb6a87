/* An Adams data set as a scene: the order of things, bodies, and what is left out. See model.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/adams/model.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* ---- what is left out ---- */

static void remark(json_t *list, const adm_statement *of, const char *format, va_list args) {
  char text[TDM_MESSAGE_MAX], all[TDM_MESSAGE_MAX + 64];
  vsnprintf(text, sizeof text, format, args);
  snprintf(all, sizeof all, "line %d: %s/%ld: %s", of->line, of->keyword, of->id, text);
  tdm_utf8_clean(all);
  json_array_append_new(list, json_string(all));
}

void adm_leave_out(adm_model *m, const adm_statement *of, const char *format, ...) {
  va_list args;
  va_start(args, format);
  remark(m->left_out, of, format, args);
  va_end(args);
}

void adm_note(adm_model *m, const adm_statement *of, const char *format, ...) {
  va_list args;
  va_start(args, format);
  remark(m->notes, of, format, args);
  va_end(args);
}

void adm_note_unknown(adm_model *m, const adm_reader *r) {
  for (int i = 0; i < r->n && !r->err->status; i++)
    if (!r->attribute[i].known)
      adm_note(m, r->of, "its %s is left out", r->attribute[i].name);
}

/* ---- names and places ---- */

static bool has_name(const json_t *list, const char *name) {
  size_t i;
  json_t *element;
  json_array_foreach(list, i, element) {
    const char *other = json_string_value(json_object_get(element, "name"));
    if (other && strcmp(other, name) == 0)
      return true;
  }
  return false;
}

void adm_name(const adm_statement *of, const char *prefix, const json_t *list, char name[ADM_NAME_MAX]) {
  static const char good[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
  const char *view = of->view_name;
  char text[ADM_NAME_MAX] = "";
  for (int i = 0; view[i] && i < ADM_NAME_MAX - 16; i++)
    text[i] = strchr(good, view[i]) ? view[i] : '_';
  snprintf(name, ADM_NAME_MAX, "%s", text);
  if (!text[0])
    snprintf(name, ADM_NAME_MAX, "%s_%ld", prefix, of->id);
  if (strcmp(name, "ground") == 0 || has_name(list, name))
    snprintf(name, ADM_NAME_MAX, "%.22s_%ld", text[0] ? text : prefix, of->id);
  for (int n = 2; has_name(list, name); n++)
    snprintf(name, ADM_NAME_MAX, "%.18s_%ld_%d", prefix, of->id, n);
}

static json_t *vector(tdm_vec3 v) {
  double x[3] = {v.x, v.y, v.z};
  for (int k = 0; k < 3; k++)
    if (fabs(x[k]) < 1e-15 * tdm_norm(v)) /* rounding of a rotation by right angles */
      x[k] = 0;
  return json_pack("[o, o, o]", adm_real(x[0]), adm_real(x[1]), adm_real(x[2]));
}

static json_t *angles(tdm_euler313 e) {
  return json_pack("{s:[o, o, o]}", "euler313", adm_real(e.phi), adm_real(e.theta), adm_real(e.psi));
}

static bool turned(tdm_euler313 e) {
  return e.phi != 0 || e.theta != 0 || e.psi != 0;
}

json_t *adm_place(adm_model *m, int marker, int axis) {
  adm_marker *k = &m->marker[marker];
  const adm_part *part = &m->part[k->part];
  if (part->ground)
    return vector(axis < 0 ? k->pose.position : adm_axis(k, axis));
  char name[24], place[ADM_NAME_MAX + 32];
  snprintf(name, sizeof name, "m%ld", k->of->id);
  if (!k->written) {
    json_t *json = json_pack("{s:s, s:s, s:o}", "name", name, "frame", "world", "point", vector(k->pose.position));
    if (turned(k->euler))
      json_object_set_new(json, "orientation", angles(k->euler));
    json_array_append_new(part->markers, json);
    k->written = true;
  }
  snprintf(place, sizeof place, axis < 0 ? "%s.%s" : "%s.%s.%c", part->name, name, axis < 0 ? 0 : "xyz"[axis]);
  return json_string(place);
}

json_t *adm_bodies(const adm_model *m, const int marker[2]) {
  return json_pack("[s, s]", m->part[m->marker[marker[1]].part].name, m->part[m->marker[marker[0]].part].name);
}

double adm_angle(const adm_marker *i, const adm_marker *j) {
  const double angle = atan2(tdm_dot(adm_axis(i, 0), adm_axis(j, 1)), tdm_dot(adm_axis(i, 0), adm_axis(j, 0)));
  return fabs(angle) < 1e-14 ? 0 : angle;
}

tdm_status adm_read_pair(const adm_model *m, const adm_reader *r, int marker[2]) {
  static const char *const names[] = {"I", "J"};
  for (int k = 0; k < 2 && !r->err->status; k++) {
    const long id = adm_id(r, names[k], true);
    if (!r->err->status)
      marker[k] = adm_find_marker(m, r->of, adm_find(r, names[k])->line, id, r->err);
  }
  if (!r->err->status && m->marker[marker[0]].part == m->marker[marker[1]].part)
    adm_fail(r->dataset, r->of->line, r->err, "%s/%ld: its markers I and J are both on PART/%ld; give it two parts",
             r->of->keyword, r->of->id, m->part[m->marker[marker[0]].part].of->id);
  return r->err->status;
}

const char *adm_read_function(const adm_reader *r, adm_form *form) {
  const adm_attribute *a = adm_find(r, "FUNCTION");
  return a && a->value ? adm_form_read(form, a->value) : "is not there (a subroutine's, perhaps)";
}

/* ---- bodies ---- */

/* Inertia about the centre of mass in the axes of CM, from that about the origin of IM in its axes. */
static tdm_mat3 central_inertia(const adm_part *p, const adm_marker *cm, const adm_marker *im) {
  const double *x = p->inertia;
  const tdm_mat3 given = {{{x[0], -x[3], -x[4]}, {-x[3], x[1], -x[5]}, {-x[4], -x[5], x[2]}}};
  if (im == cm)
    return given;
  const tdm_mat3 turn = tdm_m3_mat(tdm_m3_transpose(adm_axes(cm)), adm_axes(im));
  tdm_mat3 inertia = tdm_m3_mat(tdm_m3_mat(turn, given), tdm_m3_transpose(turn));
  const tdm_vec3 arm = tdm_m3_tmul(adm_axes(cm), tdm_sub(im->pose.position, cm->pose.position));
  const double d[3] = {arm.x, arm.y, arm.z}, square = tdm_dot(arm, arm);
  for (int i = 0; i < 3; i++)
    for (int k = 0; k < 3; k++)
      inertia.m[i][k] -= p->mass * ((i == k ? square : 0) - d[i] * d[k]);
  return inertia;
}

/* [xx, yy, zz], and the products where there are some */
static json_t *inertia_json(tdm_mat3 a) {
  const double most = fmax(a.m[0][0], fmax(a.m[1][1], a.m[2][2]));
  const double off = fmax(fabs(a.m[0][1]), fmax(fabs(a.m[0][2]), fabs(a.m[1][2])));
  json_t *json = json_pack("[o, o, o]", adm_real(a.m[0][0]), adm_real(a.m[1][1]), adm_real(a.m[2][2]));
  if (off > 1e-15 * most) {
    json_array_append_new(json, adm_real(a.m[0][1]));
    json_array_append_new(json, adm_real(a.m[0][2]));
    json_array_append_new(json, adm_real(a.m[1][2]));
  }
  return json;
}

/* A velocity along the axes of a marker of the part; `otherwise` NULL: the world's. */
static tdm_status along(const adm_model *m, const adm_part *p, long id, const adm_marker *otherwise, tdm_vec3 *v,
                        tdm_error *err) {
  const adm_marker *axes = otherwise;
  if (id > 0) {
    const int k = adm_find_marker(m, p->of, p->of->line, id, err);
    axes = k >= 0 ? &m->marker[k] : NULL;
  }
  if (axes)
    *v = tdm_quat_rotate(axes->pose.orientation, *v);
  return err->status;
}

static tdm_status add_body(adm_model *m, adm_part *p, tdm_error *err) {
  const int cm = adm_find_marker(m, p->of, p->of->line, p->cm, err);
  const int im = !err->status && p->im > 0 ? adm_find_marker(m, p->of, p->of->line, p->im, err) : cm;
  if (err->status)
    return err->status;
  const adm_marker *k = &m->marker[cm];
  if (&m->part[k->part] != p || &m->part[m->marker[im].part] != p)
    return adm_fail(&m->dataset, p->of->line, err, "PART/%ld has CM or IM on another part; name markers of its own",
                    p->of->id);
  tdm_vec3 velocity = p->velocity, angular = p->angular;
  if (along(m, p, p->vm, NULL, &velocity, err) != TDM_OK || along(m, p, p->wm, k, &angular, err) != TDM_OK)
    return err->status;
  adm_name(p->of, "part", m->bodies, p->name);
  json_t *body = json_pack("{s:s, s:o, s:o, s:o}", "name", p->name, "mass", adm_real(p->mass), "inertia",
                           inertia_json(central_inertia(p, k, &m->marker[im])), "position", vector(k->pose.position));
  if (!body)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the bodies of %s", m->dataset.file);
  if (turned(k->euler))
    json_object_set_new(body, "orientation", angles(k->euler));
  if (tdm_norm(velocity) > 0)
    json_object_set_new(body, "velocity", vector(velocity));
  if (tdm_norm(angular) > 0)
    json_object_set_new(body, "angular_velocity", vector(angular));
  p->markers = json_array();
  json_object_set_new(body, "markers", p->markers);
  json_array_append_new(m->bodies, body);
  return TDM_OK;
}

static tdm_status add_bodies(adm_model *m, tdm_error *err) {
  for (int i = 0; i < m->npart && !err->status; i++) {
    adm_part *p = &m->part[i];
    if (p->ground)
      snprintf(p->name, sizeof p->name, "ground");
    else
      add_body(m, p, err);
  }
  return err->status;
}

/* ---- all of it ---- */

/* Statements that become elements, in the order in which a scene may name them. */
static const struct {
  const char *keyword;
  tdm_status (*add)(adm_model *m, const adm_statement *of, tdm_error *err);
} elements[] = {{"JOINT", adm_add_joint},   {"JPRIM", adm_add_joint},         {"GCON", adm_add_gcon},
                {"JOINT", adm_add_coupled}, {"COUPLER", adm_add_coupled},     {"MOTION", adm_add_motion},
                {"SFORCE", adm_add_force},  {"SPRINGDAMPER", adm_add_spring}, {"BUSHING", adm_add_bushing}};

static tdm_status add_elements(adm_model *m, tdm_error *err) {
  const adm_dataset *d = &m->dataset;
  for (size_t k = 0; k < sizeof elements / sizeof elements[0]; k++)
    for (int i = 0; i < d->n && !err->status; i++)
      if (strcmp(d->statement[i].keyword, elements[k].keyword) == 0)
        elements[k].add(m, &d->statement[i], err);
  for (int i = 0; i < d->n; i++) {
    const adm_statement *of = &d->statement[i];
    m->nread += of->meaning == ADM_READ;
    m->nshown += of->meaning == ADM_SHOWN;
    if (of->meaning == ADM_ACTS)
      adm_leave_out(m, of, "a scene has nothing that corresponds to this statement");
    else if (of->meaning == ADM_SHOWN) {
      char text[96];
      snprintf(text, sizeof text, "line %d: %s/%ld", of->line, of->keyword, of->id);
      json_array_append_new(m->shown, json_string(text));
    }
  }
  m->nread -= (int)json_array_size(m->left_out);
  for (int i = 0; i < d->n; i++)
    m->nread += d->statement[i].meaning == ADM_ACTS;
  return err->status;
}

/* Whether a number of an element was not finite (adm_real). */
static bool has_null(json_t *value) {
  const char *key;
  size_t i;
  json_t *inner;
  json_array_foreach(value, i, inner) if (has_null(inner)) return true;
  json_object_foreach(value, key, inner) if (has_null(inner)) return true;
  return json_is_null(value);
}

static tdm_status check_numbers(const adm_model *m, tdm_error *err) {
  const json_t *const lists[] = {m->bodies, m->joints, m->drivers, m->forces};
  size_t i;
  json_t *element;
  for (size_t k = 0; k < sizeof lists / sizeof lists[0]; k++)
    json_array_foreach(lists[k], i, element) if (has_null(element))
        tdm_fail(err, TDM_ERR_FILE, NULL, "%s: \"%s\" has a number that is too large in SI units; check its statement",
                 m->dataset.file, json_string_value(json_object_get(element, "name")));
  return err->status;
}

/* Elements have a place without what is empty. */
static void set_list(json_t *mbd, const char *key, json_t *list) {
  if (json_array_size(list) > 0)
    json_object_set(mbd, key, list);
}

static json_t *make_scene(const adm_model *m, double end) {
  size_t i;
  json_t *body;
  json_array_foreach(m->bodies, i, body) if (json_array_size(json_object_get(body, "markers")) == 0)
      json_object_del(body, "markers");
  json_t *mbd = json_pack("{s:o, s:O}", "gravity", vector(m->gravity), "bodies", m->bodies);
  set_list(mbd, "joints", m->joints);
  set_list(mbd, "drivers", m->drivers);
  set_list(mbd, "forces", m->forces);
  return json_pack("{s:s, s:{s:o}, s:{s:o}, s:o}", "title", m->dataset.title[0] ? m->dataset.title : "Adams data set",
                   "time", "end", adm_real(end), "output", "interval", adm_real(end / 500), "mbd", mbd);
}

tdm_status adm_import(adm_model *m, const char *file, double end, json_t **scene, tdm_error *err) {
  json_t **const lists[] = {&m->bodies, &m->joints, &m->drivers, &m->forces, &m->left_out, &m->shown, &m->notes};
  for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++)
    *lists[i] = json_array();
  *scene = NULL;
  if (adm_dataset_read(&m->dataset, file, err) == TDM_OK && adm_model_read(m, err) == TDM_OK &&
      add_bodies(m, err) == TDM_OK && add_elements(m, err) == TDM_OK && check_numbers(m, err) == TDM_OK)
    *scene = make_scene(m, end);
  if (!err->status && !*scene)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the scene of %s", file);
  return err->status;
}
