/* Forces of an Adams data set: SFORCE, SPRINGDAMPER, BUSHING. See model.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/adams/model.h"

#include <math.h>
#include <string.h>

/* What pushes back below or above a limit: k d^exponent at d beyond it. Units of the data set. */
typedef struct {
  double limit, k, exponent;
  bool below;
  const adm_joint *joint; /* of an angle: the one that has it */
  double forward;         /* -1: the joint counts it the other way */
} stop;

enum { STOPS_MAX = 4 };

/* Force or torque of I and J on their distance or angle x (Adams' sign: a positive one pushes them apart, or turns I
 * forward): constant + by_x x + by_rate xdot + what the splines and stops give. Units of the data set. */
typedef struct {
  double constant, by_x, by_rate;
  const adm_term *spline[2]; /* of x, of xdot; NULL: none */
  double sign;               /* -1: x is counted from I to J */
  int nstop;
  stop stop[STOPS_MAX];
} law;

/* ---- between two parts ---- */

/* [[arguments], [values]] of a spline of a x + b: `x` and `value` are SI units a unit. */
static json_t *table(const adm_spline *s, const adm_term *term, double sign, double x, double value) {
  json_t *arguments = json_array(), *values = json_array();
  const double a = sign * term->a;
  for (int i = 0; i < s->n; i++) {
    const int k = a > 0 ? i : s->n - 1 - i;
    json_array_append_new(arguments, adm_real(x * (s->x[k] - term->b) / a));
    json_array_append_new(values, adm_real(-value * term->factor * s->y[k]));
  }
  return json_pack("[o, o]", arguments, values);
}

/* The coefficients of a spring: stiffness or a table, damping or a table; x, value, time: SI units a unit. `free` is
 * what x is at zero deflection, `key` its name. */
static void add_coefficients(adm_model *m, const adm_statement *of, json_t *force, const law *l, double x, double value,
                             const char *key, double free) {
  const double k = -l->by_x * value / x, rate = x / m->units.time;
  double rest = free, preload = -l->constant * value;
  for (int i = 0; i < 2; i++) {
    const adm_term *term = l->spline[i];
    if (!term)
      continue;
    const adm_spline *s = adm_find_spline(m->spline, m->nspline, term->spline);
    json_object_set_new(force, i == 0 ? "stiffness_table" : "damping_table",
                        table(s, term, l->sign, i == 0 ? x : rate, value));
    if (i == 0 && !term->akima)
      json_object_set_new(force, "interpolation", json_string("cspline"));
    adm_note(m, of, "the %s spline of SPLINE/%ld passes through the same points but differs slightly between them",
             i == 1 || term->akima ? "Steffen" : "natural cubic", term->spline);
  }
  if (!l->spline[0] && k > 0 && !(strcmp(key, "free_length") == 0 && rest - preload / k < 0)) {
    rest -= preload / k; /* the free length holds what else would be a preload */
    preload = 0;
  }
  if (!l->spline[0])
    json_object_set_new(force, "stiffness", adm_real(k));
  if (!l->spline[1])
    json_object_set_new(force, "damping", adm_real(-l->by_rate * value / rate));
  json_object_set_new(force, key, adm_real(fabs(rest) < 1e-15 ? 0 : rest));
  if (preload != 0)
    json_object_set_new(force, "preload", adm_real(preload));
}

static json_t *begin(adm_model *m, const adm_statement *of, const char *prefix, const char *type) {
  char name[ADM_NAME_MAX];
  adm_name(of, prefix, m->forces, name);
  return json_pack("{s:s, s:s}", "name", name, "type", type);
}

/* A force along the line of two markers. */
static json_t *begin_line(adm_model *m, const adm_statement *of, const char *prefix, const char *type,
                          const int marker[2]) {
  json_t *force = begin(m, of, prefix, type);
  json_object_set_new(force, "bodies", adm_bodies(m, marker));
  json_object_set_new(force, "points", json_pack("[o, o]", adm_place(m, marker[1], -1), adm_place(m, marker[0], -1)));
  return force;
}

static void add_translational(adm_model *m, const adm_statement *of, const int marker[2], const law *l) {
  json_t *force = begin_line(m, of, "spring", "spring_damper", marker);
  add_coefficients(m, of, force, l, m->units.length, m->units.force, "free_length", 0);
  json_array_append_new(m->forces, force);
}

static void add_rotational(adm_model *m, const adm_statement *of, const int marker[2], const law *l) {
  const double torque = m->units.force * m->units.length;
  json_t *force = begin(m, of, "torsion", "torsional_spring_damper");
  json_object_set_new(force, "bodies", adm_bodies(m, marker));
  json_object_set_new(force, "axis", adm_place(m, marker[1], 2));
  add_coefficients(m, of, force, l, 1, torque, "free_angle", -adm_angle(&m->marker[marker[0]], &m->marker[marker[1]]));
  json_array_append_new(m->forces, force);
}

/* ---- stops ---- */

/* The joint that turns the parts of I and J about the z axis of J; NULL: none. forward: as the law has it. */
static const adm_joint *joint_between(const adm_model *m, const int marker[2], double *forward) {
  const int of_i = m->marker[marker[0]].part, of_j = m->marker[marker[1]].part;
  for (int k = 0; k < m->njoint; k++) {
    const adm_joint *j = &m->joint[k];
    const int first = m->marker[j->marker[0]].part, second = m->marker[j->marker[1]].part;
    const bool same = first == of_i && second == of_j, swapped = first == of_j && second == of_i;
    const double along = tdm_dot(adm_axis(&m->marker[j->marker[1]], 2), adm_axis(&m->marker[marker[1]], 2));
    *forward = (same ? 1 : -1) * (along > 0 ? 1 : -1);
    if (j->turns && (same || swapped) && fabs(along) > 1 - 1e-9)
      return j;
  }
  return NULL;
}

/* A term that pushes back beyond a limit of x, sign: of x in it. NULL, or why it cannot be. */
static const char *add_stop(const adm_model *m, law *l, const adm_term *t, double sign, const int marker[2],
                            bool rotational) {
  const double a = sign * t->a;
  stop s = {
      .limit = t->b / a, .k = fabs(t->factor) * pow(fabs(a), t->exponent), .exponent = t->exponent, .below = a > 0};
  if (s.below != (t->factor > 0))
    return "has an IMPACT that pulls where a scene's stops push";
  if (l->nstop == STOPS_MAX)
    return "has more than four limits";
  if (rotational && !(s.joint = joint_between(m, marker, &s.forward)))
    return "has an IMPACT of an angle that no joint of its two parts has";
  if (!rotational && s.limit <= 0)
    return s.below ? NULL : "has an IMPACT above a distance that is not greater than 0";
  if (!rotational && !s.below && s.exponent != 2)
    return "has an IMPACT above a distance with an exponent other than 2, which a scene's cable does not have";
  l->stop[l->nstop++] = s;
  return NULL;
}

/* Between two spheres below a distance; above it by a cable whose force sets in with the square, k s^2. */
static void write_stop_of_distance(adm_model *m, const adm_statement *of, const int marker[2], const stop *s) {
  const double from = m->units.length * s->limit, smoothing = 1000 * from;
  const double k = s->k * m->units.force / pow(m->units.length, s->exponent);
  json_t *force = begin_line(m, of, "stop", s->below ? "bump" : "cable", marker);
  json_object_set_new(force, "stiffness", adm_real(s->below ? k : 2 * smoothing * k));
  if (s->below) {
    json_object_set_new(force, "radii", json_pack("[o, o]", adm_real(0.5 * from), adm_real(0.5 * from)));
    json_object_set_new(force, "exponent", adm_real(s->exponent));
  } else {
    json_object_set_new(force, "free_length", adm_real(from));
    json_object_set_new(force, "smoothing", adm_real(smoothing));
  }
  json_array_append_new(m->forces, force);
}

static void write_stop_of_angle(adm_model *m, const adm_statement *of, const int marker[2], const stop *s) {
  const double start = adm_angle(&m->marker[marker[0]], &m->marker[marker[1]]);
  json_t *force = begin(m, of, "stop", "stop");
  json_object_set_new(force, "joint", json_string(s->joint->name));
  json_object_set_new(force, "coordinate", json_string("angle"));
  json_object_set_new(force, s->below == (s->forward > 0) ? "lower" : "upper",
                      adm_real(s->forward * (s->limit - start)));
  json_object_set_new(force, "stiffness", adm_real(s->k * m->units.force * m->units.length));
  json_object_set_new(force, "exponent", adm_real(s->exponent));
  json_array_append_new(m->forces, force);
}

/* ---- on one part ---- */

/* A force or moment of the time along z of J, on the part of I at I: fixed in the world if J is on the ground, or in
 * the part if J is on it. `back`: J's part takes it, I is on the ground. NULL, or why it cannot be. */
static const char *add_wrench(adm_model *m, const adm_statement *of, const int marker[2], bool moment, bool back,
                              const adm_form *form) {
  const adm_marker *i = &m->marker[marker[back ? 1 : 0]], *j = &m->marker[marker[back ? 0 : 1]];
  const bool follows = i->part == j->part;
  const char *why = NULL;
  json_t *factor = NULL;
  if (m->part[i->part].ground)
    return "acts on the ground alone";
  if (!follows && !m->part[j->part].ground)
    return "acts along the axis of a third part, which moves";
  double size = (back ? -1 : 1) * m->units.force * (moment ? m->units.length : 1);
  const adm_law_def def = {.time = m->units.time, .scale = 1, .spline = m->spline, .nspline = m->nspline};
  factor = adm_law(form, &def, m->notes, &why);
  if (why)
    return why;
  if (strcmp(json_string_value(json_object_get(factor, "type")), "constant") == 0) {
    size *= adm_form_power(form, 0);
    json_decref(factor);
    factor = NULL;
  }
  if (size == 0) {
    adm_leave_out(m, of, "it is zero");
    return NULL;
  }
  tdm_vec3 z = tdm_scale(size, adm_axis(j, 2));
  if (follows) { /* axes of the body are those of its CM marker */
    const int cm = adm_find_marker(m, of, of->line, m->part[i->part].cm, &(tdm_error){0});
    z = tdm_quat_rotate(tdm_quat_conj(m->marker[cm].pose.orientation), z);
  }
  json_t *force = begin(m, of, "wrench", "wrench");
  json_object_set_new(force, "body", json_string(m->part[i->part].name));
  if (!moment)
    json_object_set_new(force, "point", adm_place(m, marker[0], -1));
  json_object_set_new(force, moment ? "moment" : "force",
                      json_pack("[o, o, o]", adm_real(z.x), adm_real(z.y), adm_real(z.z)));
  if (follows)
    json_object_set_new(force, "axes", json_string("body"));
  if (factor)
    json_object_set_new(force, "factor", factor);
  json_array_append_new(m->forces, force);
  return NULL;
}

/* ---- SFORCE ---- */

/* One term of a function of the markers I and J into the law; NULL, or why it cannot be. */
static const char *add_term(const adm_model *m, law *l, const adm_term *t, const int marker[2], bool rotational) {
  const long pair[2] = {m->marker[marker[0]].of->id, m->marker[marker[1]].of->id};
  static const char other[] =
      "depends on something other than the distance or the angle of its own markers and its rate";
  const adm_measure x = rotational ? ADM_AZ : ADM_DM, rate = rotational ? ADM_WZ : ADM_VR;
  if (t->kind == ADM_POWER && t->power == 0) {
    l->constant += t->factor;
    return NULL;
  }
  const bool forward = t->marker[0] == pair[0] && t->marker[1] == pair[1];
  const bool backward = t->marker[0] == pair[1] && t->marker[1] == pair[0];
  if ((t->measure != x && t->measure != rate) || (!forward && !backward))
    return other;
  const double sign = rotational && backward ? -1 : 1;
  const int k = t->measure == rate;
  if (t->kind == ADM_IMPACT)
    return add_stop(m, l, t, sign, marker, rotational);
  if (t->kind == ADM_MEASURE)
    *(k == 0 ? &l->by_x : &l->by_rate) += sign * t->factor;
  else if (!adm_find_spline(m->spline, m->nspline, t->spline))
    return "names a SPLINE that the data set does not have";
  else if (l->spline[k] || (l->sign != 0 && l->sign != sign))
    return "has two splines of the same quantity";
  else {
    l->spline[k] = t;
    l->sign = sign;
  }
  return NULL;
}

static const char *add_function(adm_model *m, const adm_statement *of, const int marker[2], bool rotational,
                                bool action_only, const adm_form *form) {
  law l = {0};
  bool changes = false;
  for (int i = 0; i < form->n; i++)
    changes = changes || (form->term[i].kind == ADM_POWER ? form->term[i].power != 0 && form->term[i].factor != 0
                                                          : form->term[i].measure == ADM_TIME);
  if (action_only)
    return add_wrench(m, of, marker, rotational, false, form);
  if (changes && rotational)
    return add_wrench(m, of, marker, true, m->part[m->marker[marker[0]].part].ground, form);
  if (changes)
    return "changes with the time along the line of two markers; a scene has such forces on one body alone, as "
           "ACTIONONLY gives";
  for (int i = 0; i < form->n; i++) {
    const char *why = form->term[i].factor != 0 ? add_term(m, &l, &form->term[i], marker, rotational) : NULL;
    if (why)
      return why;
  }
  if ((l.spline[0] && l.by_x != 0) || (l.spline[1] && l.by_rate != 0))
    return "has a spline and a linear term of the same quantity";
  const bool springs = l.constant != 0 || l.by_x != 0 || l.by_rate != 0 || l.spline[0] || l.spline[1];
  if (springs || l.nstop == 0)
    (rotational ? add_rotational : add_translational)(m, of, marker, &l);
  for (int i = 0; i < l.nstop; i++)
    (rotational ? write_stop_of_angle : write_stop_of_distance)(m, of, marker, &l.stop[i]);
  return NULL;
}

tdm_status adm_add_force(adm_model *m, const adm_statement *of, tdm_error *err) {
  static const char *const names[] = {"TRANSLATIONAL", "ROTATIONAL", "ACTIONONLY", "I", "J", "FUNCTION", NULL};
  adm_reader r;
  adm_form form = {0};
  int marker[2];
  adm_open(&r, &m->dataset, of, names, err);
  const bool rotational = adm_find(&r, "ROTATIONAL") != NULL, action_only = adm_find(&r, "ACTIONONLY") != NULL;
  if (!err->status && !rotational && !adm_find(&r, "TRANSLATIONAL"))
    adm_fail(&m->dataset, of->line, err, "SFORCE/%ld is neither TRANSLATIONAL nor ROTATIONAL; say which", of->id);
  if (action_only) {
    static const char *const ends[] = {"I", "J"};
    for (int k = 0; k < 2; k++)
      marker[k] = adm_find_marker(m, of, of->line, adm_id(&r, ends[k], true), err);
  } else
    adm_read_pair(m, &r, marker);
  if (!err->status) {
    const char *why = adm_read_function(&r, &form);
    why = why ? why : add_function(m, of, marker, rotational, action_only, &form);
    if (why)
      adm_leave_out(m, of, "its FUNCTION %s", why);
  }
  adm_note_unknown(m, &r);
  adm_close(&r);
  return err->status;
}

/* ---- SPRINGDAMPER, BUSHING ---- */

tdm_status adm_add_spring(adm_model *m, const adm_statement *of, tdm_error *err) {
  static const char *const names[] = {"TRANSLATIONAL", "ROTATIONAL", "I",  "J",     "K",      "C", "LENGTH",
                                      "FORCE",         "KT",         "CT", "ANGLE", "TORQUE", NULL};
  adm_reader r;
  int marker[2];
  adm_open(&r, &m->dataset, of, names, err);
  const bool rotational = adm_find(&r, "ROTATIONAL") != NULL;
  if (!err->status && !rotational && !adm_find(&r, "TRANSLATIONAL"))
    adm_fail(&m->dataset, of->line, err, "SPRINGDAMPER/%ld is neither TRANSLATIONAL nor ROTATIONAL; say which", of->id);
  if (adm_read_pair(m, &r, marker) == TDM_OK) {
    const double k = adm_number(&r, rotational ? "KT" : "K", 0), c = adm_number(&r, rotational ? "CT" : "C", 0);
    const double rest = adm_number(&r, rotational ? "ANGLE" : "LENGTH", 0);
    const law l = {
        .constant = k * rest + adm_number(&r, rotational ? "TORQUE" : "FORCE", 0), .by_x = -k, .by_rate = -c};
    if (!err->status && rotational)
      add_rotational(m, of, marker, &l);
    else if (!err->status)
      add_translational(m, of, marker, &l);
  }
  adm_note_unknown(m, &r);
  adm_close(&r);
  return err->status;
}

/* Three numbers of translation and three of rotation, a list of 6 in SI units; 0 where they are not given. */
static json_t *six(const adm_reader *r, const char *way, const char *angle, double si_way, double si_angle, bool *any) {
  double x[6] = {0};
  json_t *list = json_array();
  adm_numbers(r, way, 3, 3, x);
  adm_numbers(r, angle, 3, 3, x + 3);
  *any = false;
  for (int i = 0; i < 6; i++) {
    *any = *any || x[i] != 0;
    json_array_append_new(list, adm_real((i < 3 ? si_way : si_angle) * x[i]));
  }
  return list;
}

tdm_status adm_add_bushing(adm_model *m, const adm_statement *of, tdm_error *err) {
  static const char *const names[] = {"I", "J", "K", "KT", "C", "CT", "FORCE", "TORQUE", NULL};
  const adm_units *u = &m->units;
  adm_reader r;
  int marker[2];
  bool any;
  adm_open(&r, &m->dataset, of, names, err);
  if (adm_read_pair(m, &r, marker) == TDM_OK) {
    const adm_marker *i = &m->marker[marker[0]], *j = &m->marker[marker[1]];
    if (tdm_norm(tdm_quat_turn(i->pose.orientation, j->pose.orientation)) > 1e-9)
      adm_leave_out(m, of, "its markers are turned against each other at the start; a scene's bushing starts unturned");
    else {
      json_t *force = begin(m, of, "bushing", "bushing");
      json_object_set_new(force, "bodies", adm_bodies(m, marker));
      json_object_set_new(force, "points",
                          json_pack("[o, o]", adm_place(m, marker[1], -1), adm_place(m, marker[0], -1)));
      json_object_set_new(force, "orientation",
                          json_pack("{s:[o, o, o]}", "euler313", adm_real(j->euler.phi), adm_real(j->euler.theta),
                                    adm_real(j->euler.psi)));
      json_object_set_new(force, "stiffness", six(&r, "K", "KT", u->force / u->length, u->force * u->length, &any));
      json_object_set_new(force, "damping",
                          six(&r, "C", "CT", u->force * u->time / u->length, u->force * u->length * u->time, &any));
      json_t *preload = six(&r, "FORCE", "TORQUE", -u->force, -u->force * u->length, &any);
      if (any)
        json_object_set(force, "preload", preload);
      json_decref(preload);
      json_array_append_new(m->forces, force);
    }
  }
  adm_note_unknown(m, &r);
  adm_close(&r);
  return err->status;
}
