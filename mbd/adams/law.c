/* Motion laws from functions of the time: see function.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/adams/function.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { POWERS = 16 };

/* A law while it is put together: powers of the time in seconds, and other laws. */
typedef struct {
  const adm_law_def *def;
  double power[POWERS];
  json_t *laws, *notes;
  const char *why;
} maker;

json_t *adm_real(double x) {
  char text[32];
  snprintf(text, sizeof text, "%.15g", x);
  x = strtod(text, NULL);
  if (!isfinite(x))
    return json_null();
  return x == floor(x) && fabs(x) < 1e15 ? json_integer((json_int_t)x) : json_real(x);
}

const adm_spline *adm_find_spline(const adm_spline *spline, int nspline, long id) {
  for (int i = 0; i < nspline; i++)
    if (spline[i].of->id == id)
      return &spline[i];
  return NULL;
}

/* a t^n and its integrals, as often as the form is a derivative; time in seconds */
static void add_power(maker *m, const adm_term *term) {
  int n = term->power;
  double factor = m->def->scale * term->factor * pow(m->def->time, -n - m->def->derivative);
  for (int k = 0; k < m->def->derivative; k++)
    factor /= ++n;
  m->power[n] += factor;
}

/* a sin(w t + phase) and its integrals, less what these are at t = 0 */
static void add_sine(maker *m, const adm_term *term) {
  const double w = term->a / m->def->time;
  double factor = m->def->scale * term->factor * pow(m->def->time, -m->def->derivative), phase = term->b;
  for (int k = 0; k < m->def->derivative; k++) {
    factor /= w;
    phase -= M_PI / 2;
  }
  if (m->def->derivative > 0)
    m->power[0] -= factor * sin(phase);
  if (m->def->derivative > 1)
    m->power[1] -= factor * w * cos(phase);
  json_array_append_new(m->laws, json_pack("{s:s, s:o, s:o, s:o}", "type", "harmonic", "amplitude", adm_real(factor),
                                           "omega", adm_real(w), "phase", adm_real(remainder(phase, 2 * M_PI))));
}

/* a step, or the ramp whose rate it is */
static void add_step(maker *m, const adm_term *term) {
  const double T = m->def->time, start = T * term->a, rise = T * (term->b - term->a);
  const char *shape = term->kind == ADM_STEP ? "cubic" : "quintic";
  if (m->def->derivative > 1)
    m->why = "has a step of the acceleration, for which a scene has no law";
  else if (m->def->derivative == 1 && start < 0)
    m->why = "has a step of the rate that begins before the run, for which a scene has no law";
  else
    json_array_append_new(m->laws, json_pack("{s:s, s:o, s:o, s:o, s:s}", "type", m->def->derivative ? "ramp" : "step",
                                             m->def->derivative ? "rate" : "to",
                                             adm_real(m->def->scale * term->factor / (m->def->derivative ? T : 1)),
                                             "start", adm_real(start), "rise", adm_real(rise), "shape", shape));
}

static void add_spline(maker *m, const adm_term *term) {
  const adm_spline *s = adm_find_spline(m->def->spline, m->def->nspline, term->spline);
  char note[160];
  if (!s) {
    m->why = "names a SPLINE that the data set does not have";
    return;
  }
  if (m->def->derivative > 0) {
    m->why = "has a spline of a rate, for which a scene has no law";
    return;
  }
  json_t *times = json_array(), *values = json_array();
  for (int i = 0; i < s->n; i++) {
    const int k = term->a > 0 ? i : s->n - 1 - i;
    json_array_append_new(times, adm_real(m->def->time * (s->x[k] - term->b) / term->a));
    json_array_append_new(values, adm_real(m->def->scale * term->factor * s->y[k]));
  }
  json_array_append_new(m->laws, json_pack("{s:s, s:o, s:o, s:s}", "type", "table", "times", times, "values", values,
                                           "interpolation", term->akima ? "steffen" : "cspline"));
  snprintf(note, sizeof note, "SPLINE/%ld: %s instead of Adams' %s spline: the same points, between them a little else",
           s->of->id, term->akima ? "Steffen's" : "a natural cubic", term->akima ? "Akima" : "cubic");
  json_array_append_new(m->notes, json_string(note));
}

/* The powers as a law of their own. With one other law that can hold a constant they are a part of it. */
static void add_powers(maker *m) {
  int highest = POWERS - 1;
  while (highest > 0 && m->power[highest] == 0)
    highest--;
  json_t *first = json_array_get(m->laws, 0), *law;
  const char *type = json_string_value(json_object_get(first, "type"));
  if (highest == 0 && m->power[0] == 0 && first)
    return;
  if (highest == 0 && json_array_size(m->laws) == 1 && type &&
      ((type[0] == 's' && json_is_number(json_object_get(first, "to"))) || type[0] == 'h')) {
    if (type[0] == 's')
      json_object_set_new(first, "to", adm_real(m->power[0] + json_number_value(json_object_get(first, "to"))));
    json_object_set_new(first, type[0] == 's' ? "from" : "mean", adm_real(m->power[0]));
    return;
  }
  if (highest == 0)
    law = json_pack("{s:s, s:o}", "type", "constant", "value", adm_real(m->power[0]));
  else if (highest == 1 && m->power[0] == 0)
    law = json_pack("{s:s, s:o, s:s}", "type", "constant_rate", "rate", adm_real(m->power[1]), "start", "step");
  else {
    json_t *coefficients = json_array();
    for (int n = 0; n <= highest; n++)
      json_array_append_new(coefficients, adm_real(m->power[n]));
    law = json_pack("{s:s, s:o}", "type", "polynomial", "coefficients", coefficients);
  }
  json_array_insert_new(m->laws, 0, law);
}

json_t *adm_law(const adm_form *form, const adm_law_def *def, json_t *notes, const char **why) {
  maker m = {.def = def, .laws = json_array(), .notes = notes};
  json_t *law = NULL;
  m.power[0] = def->scale * (def->offset + (def->derivative > 0 ? def->start[0] : 0));
  m.power[1] = def->derivative > 1 ? def->scale * def->start[1] / def->time : 0;
  for (int i = 0; i < form->n && !m.why; i++) {
    const adm_term *term = &form->term[i];
    if (term->factor == 0)
      continue;
    if (term->measure != ADM_TIME)
      m.why = "depends on where bodies are; a scene has laws of the time alone there";
    else if (term->kind == ADM_POWER)
      add_power(&m, term);
    else if (term->kind == ADM_SINE)
      add_sine(&m, term);
    else if (term->kind == ADM_SPLINE)
      add_spline(&m, term);
    else
      add_step(&m, term);
  }
  if (!m.why) {
    add_powers(&m);
    law = json_array_size(m.laws) == 1 ? json_incref(json_array_get(m.laws, 0))
                                       : json_pack("{s:s, s:O}", "type", "sum", "laws", m.laws);
  }
  *why = m.why;
  json_decref(m.laws);
  return law;
}
