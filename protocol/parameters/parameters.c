/* The parameters of a scene: see parameters.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/parameters/parameters.h"

#include "protocol/parameters/expression.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  const char *name; /* borrowed from the section */
  const char *text; /* its expression, NULL: a number */
  const char *at;   /* names of its expression before this are computed */
  double value;
  enum { NEW, WAITS, DONE } state; /* WAITS: for a parameter that it needs */
} parameter;

struct tdm_parameters {
  int count;
  parameter *all; /* (count) */
  json_t *index;  /* name -> its number in `all` */
  tdm_calculator *calculator;
};

/* ---- the section ---- */

static tdm_status check_name(const char *name, const char *path, tdm_error *err) {
  static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
  static const char more[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
  const size_t n = strlen(name);
  if (!*name || !strchr(letters, *name) || strspn(name, more) != n)
    return tdm_fail(err, TDM_ERR_SCENE, path,
                    "\"%.100s\" is no name of a parameter: it is a letter and then letters, digits and _", name);
  if (n > TDM_NAME_MAX)
    return tdm_fail(err, TDM_ERR_SCENE, path, "a name of %zu characters is too long; %d are allowed", n, TDM_NAME_MAX);
  if (tdm_expression_knows(name))
    return tdm_fail(err, TDM_ERR_SCENE, path,
                    "\"%s\" is a function or a constant of expressions; give the parameter another name", name);
  return TDM_OK;
}

static tdm_status enter(tdm_parameters *p, const char *name, const json_t *value, tdm_error *err) {
  char path[TDM_PATH_MAX];
  snprintf(path, sizeof path, "parameters.%s", name);
  if (check_name(name, path, err) != TDM_OK)
    return err->status;
  parameter *one = &p->all[p->count];
  *one = (parameter){.name = name, .text = tdm_expression(value)};
  if (json_is_number(value)) {
    one->value = json_number_value(value);
    one->state = DONE;
  } else if (one->text)
    one->at = one->text + 1;
  else
    return tdm_fail(err, TDM_ERR_SCENE, path, "must be a number or an expression \"=…\"%s",
                    json_is_string(value) ? "; put = before it" : "");
  if (json_object_set_new(p->index, name, json_integer(p->count++)) != 0)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  return one->text ? tdm_expression_check(one->text, path, err) : TDM_OK;
}

static tdm_status enter_all(tdm_parameters *p, const json_t *section, tdm_error *err) {
  const char *name;
  json_t *value;
  p->index = json_object();
  p->all = calloc(json_object_size(section) + 1, sizeof *p->all);
  if (!p->index || !p->all)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  if (section && !json_is_object(section))
    return tdm_fail(err, TDM_ERR_SCENE, "parameters", "must be an object of names and numbers, {\"rpm\": 50}");
  json_object_foreach((json_t *)section, name, value) if (enter(p, name, value, err) != TDM_OK) break;
  return err->status;
}

/* ---- one value ---- */

static parameter *find(const tdm_parameters *p, const char *name) {
  const json_t *number = json_object_get(p->index, name);
  return number ? &p->all[json_integer_value(number)] : NULL;
}

static tdm_status unknown_name(const tdm_parameters *p, const char *text, const char *name, const char *path,
                               tdm_error *err) {
  int n = 0;
  const char **known = calloc((size_t)p->count + 64, sizeof *known);
  if (!known)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (; n < p->count; n++)
    known[n] = p->all[n].name;
  for (int i = 0; tdm_expression_word(i) && i < 64; i++)
    known[n++] = tdm_expression_word(i);
  const char *near = strlen(name) > 2 ? tdm_nearest(name, known, n) : NULL; /* everything is near to "a" */
  if (near)
    tdm_expression_fail(text, path, err, "has the unknown name \"%s\"; did you mean \"%s\"?", name, near);
  else
    tdm_expression_fail(text, path, err, "has the unknown name \"%s\"; add it to the section parameters", name);
  free(known);
  return err->status;
}

/* What the names of an expression are worth, for a message. */
static void list_values(const tdm_parameters *p, const char *text, char *out, size_t size) {
  tdm_name name;
  size_t used = 0;
  out[0] = 0;
  for (const char *at = text + 1; tdm_expression_next_name(at, &name) && used < size;
       at = name.at + strlen(name.text)) {
    const parameter *one = name.called ? NULL : find(p, name.text);
    char word[TDM_NAME_MAX + 40];
    snprintf(word, sizeof word, "%s = %.6g", name.text, one ? one->value : 0);
    if (one && !strstr(out, word))
      used += (size_t)snprintf(out + used, size - used, "%s%s", used ? ", " : "", word);
  }
}

static tdm_status check_finite(const tdm_parameters *p, const char *text, double value, const char *path,
                               tdm_error *err) {
  char values[300];
  if (isfinite(value))
    return TDM_OK;
  list_values(p, text, values, sizeof values);
  return tdm_expression_fail(text, path, err, "%s%s%s%s; change it, or ask before: b == 0 ? 0 : a/b",
                             isnan(value) ? "is not a number" : "is infinite", *values ? " (" : "", values,
                             *values ? ")" : "");
}

/* The value of an expression all of whose parameters are computed. */
static double compute(tdm_parameters *p, const char *text, const char *path, tdm_error *err) {
  tdm_name name;
  tdm_calculator_clear(p->calculator);
  for (const char *at = text + 1; tdm_expression_next_name(at, &name); at = name.at + strlen(name.text)) {
    const parameter *one = name.called ? NULL : find(p, name.text);
    if (!one && !name.called) {
      unknown_name(p, text, name.text, path, err);
      return 0;
    }
    if (one)
      tdm_calculator_bind(p->calculator, one->name, &one->value);
  }
  const double value = tdm_calculate(p->calculator, text, path, err);
  if (err->status == TDM_OK)
    check_finite(p, text, value, path, err);
  return err->status == TDM_OK ? value : 0;
}

double tdm_parameters_evaluate(tdm_parameters *p, const char *expression, const char *path, tdm_error *err) {
  if (tdm_expression_check(expression, path, err) != TDM_OK)
    return 0;
  if (!p->calculator)
    p->calculator = tdm_calculator_create(err);
  return p->calculator ? compute(p, expression, path, err) : 0;
}

/* ---- all values, each after those that it needs ---- */

/* The next parameter that `one` needs and that is not computed; NULL: there is none. */
static parameter *next_needed(const tdm_parameters *p, parameter *one) {
  tdm_name name;
  while (tdm_expression_next_name(one->at, &name)) {
    parameter *other = name.called ? NULL : find(p, name.text);
    if (other && other->state != DONE)
      return other;
    one->at = name.at + strlen(name.text);
  }
  return NULL;
}

/* The stack from `first` to its top needs itself. */
static tdm_status cycle(parameter *const *stack, int depth, const parameter *first, tdm_error *err) {
  enum { TOLD = 6 };
  char names[TOLD * (TDM_NAME_MAX + 8) + 16] = "", path[TDM_PATH_MAX];
  int k = depth - 1;
  while (k > 0 && stack[k] != first)
    k--;
  for (int i = k; i < depth && i < k + TOLD; i++)
    snprintf(names + strlen(names), sizeof names - strlen(names), "%s needs ", stack[i]->name);
  snprintf(path, sizeof path, "parameters.%s", first->name);
  return tdm_expression_fail(first->text, path, err, "needs itself (%s%s%s); give one of them a number", names,
                             depth > k + TOLD ? "… needs " : "", first->name);
}

/* Compute one and what it needs: an explicit stack, as chains may be long. */
static tdm_status settle(tdm_parameters *p, parameter *one, parameter **stack, tdm_error *err) {
  int depth = 0;
  stack[depth++] = one;
  while (depth > 0 && err->status == TDM_OK) {
    parameter *top = stack[depth - 1];
    char path[TDM_PATH_MAX];
    top->state = WAITS;
    parameter *needed = next_needed(p, top);
    if (needed && needed->state == WAITS)
      return cycle(stack, depth, needed, err);
    if (needed) {
      stack[depth++] = needed;
      continue;
    }
    snprintf(path, sizeof path, "parameters.%s", top->name);
    top->value = tdm_parameters_evaluate(p, top->text, path, err);
    top->state = DONE;
    depth--;
  }
  return err->status;
}

tdm_status tdm_parameters_read(tdm_parameters **parameters, const json_t *section, tdm_error *err) {
  tdm_parameters *p = *parameters = calloc(1, sizeof *p);
  if (!p)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  if (enter_all(p, section, err) != TDM_OK)
    return err->status;
  parameter **stack = calloc((size_t)p->count + 1, sizeof *stack);
  if (!stack)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i < p->count && err->status == TDM_OK; i++)
    if (p->all[i].state == NEW)
      settle(p, &p->all[i], stack, err);
  free(stack);
  return err->status;
}

void tdm_parameters_destroy(tdm_parameters **parameters) {
  tdm_parameters *p = *parameters;
  if (!p)
    return;
  tdm_calculator_destroy(&p->calculator);
  json_decref(p->index);
  free(p->all);
  free(p);
  *parameters = NULL;
}

json_t *tdm_value_to_json(double value) {
  const bool whole = value == floor(value) && fabs(value) < 9007199254740992.0 && !(value == 0 && signbit(value));
  return whole ? json_integer((json_int_t)value) : json_real(value);
}

json_t *tdm_parameters_values(const tdm_parameters *p) {
  json_t *values = json_object();
  for (int i = 0; i < p->count; i++)
    json_object_set_new(values, p->all[i].name, tdm_value_to_json(p->all[i].value));
  return values;
}
