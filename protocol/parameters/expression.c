/* One expression: see expression.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/parameters/expression.h"

#include <math.h>
#include <muParserDLL.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct tdm_calculator {
  muParserHandle_t parser;
};

/* ---- what expressions may hold ---- */

static double sign(double x) {
  return (x > 0) - (x < 0);
}

static double least(const double *x, int n) {
  double y = x[0];
  for (int i = 1; i < n; i++)
    y = fmin(y, x[i]);
  return y;
}

static double greatest(const double *x, int n) {
  double y = x[0];
  for (int i = 1; i < n; i++)
    y = fmax(y, x[i]);
  return y;
}

static double sum(const double *x, int n) {
  double y = 0;
  for (int i = 0; i < n; i++)
    y += x[i];
  return y;
}

static double average(const double *x, int n) {
  return sum(x, n) / n;
}

/* one of them is there */
static const struct {
  const char *name;
  muFun1_t one;
  muFun2_t two;
  muMultFun_t many;
} functions[] = {{"sin", .one = sin},     {"cos", .one = cos},       {"tan", .one = tan},   {"asin", .one = asin},
                 {"acos", .one = acos},   {"atan", .one = atan},     {"sinh", .one = sinh}, {"cosh", .one = cosh},
                 {"tanh", .one = tanh},   {"exp", .one = exp},       {"ln", .one = log},    {"log10", .one = log10},
                 {"sqrt", .one = sqrt},   {"abs", .one = fabs},      {"sign", .one = sign}, {"rint", .one = round},
                 {"round", .one = round}, {"floor", .one = floor},   {"ceil", .one = ceil}, {"atan2", .two = atan2},
                 {"min", .many = least},  {"max", .many = greatest}, {"sum", .many = sum},  {"avg", .many = average}};
enum { NFUNCTION = sizeof functions / sizeof functions[0] };

static const struct {
  const char *name;
  double value;
} constants[] = {{"pi", M_PI}, {"deg", M_PI / 180}};
enum { NCONSTANT = sizeof constants / sizeof constants[0] };

const char *tdm_expression_word(int i) {
  return i < NCONSTANT ? constants[i].name : i < NCONSTANT + NFUNCTION ? functions[i - NCONSTANT].name : NULL;
}

static bool is_constant(const char *name) {
  for (int i = 0; i < NCONSTANT; i++)
    if (strcmp(constants[i].name, name) == 0)
      return true;
  return false;
}

static bool is_function(const char *name) {
  for (int i = 0; i < NFUNCTION; i++)
    if (strcmp(functions[i].name, name) == 0)
      return true;
  return false;
}

bool tdm_expression_knows(const char *name) {
  return is_constant(name) || is_function(name);
}

const char *tdm_expression(const json_t *value) {
  const char *text = json_string_value(value);
  return text && text[0] == '=' ? text : NULL;
}

/* ---- words ---- */

static bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/* behind the number at p: "2", ".5", "1e-3" */
static const char *skip_number(const char *p) {
  while (is_digit(*p) || *p == '.')
    p++;
  if (*p == 'e' || *p == 'E') {
    const char *power = p + 1 + (p[1] == '+' || p[1] == '-');
    if (is_digit(*power))
      for (p = power; is_digit(*p);)
        p++;
  }
  return p;
}

static const char *skip_name(const char *p) {
  while (is_letter(*p) || is_digit(*p))
    p++;
  return p;
}

static tdm_name name_at(const char *p) {
  const char *end = skip_name(p);
  tdm_name name = {.at = p, .called = end[strspn(end, " \t")] == '('};
  snprintf(name.text, sizeof name.text, "%.*s", (int)(end - p), p);
  return name;
}

bool tdm_expression_next_name(const char *p, tdm_name *name) {
  while (*p) {
    if (is_letter(*p)) {
      *name = name_at(p);
      if (!is_constant(name->text) || name->called)
        return true;
      p = skip_name(p);
    } else
      p = is_digit(*p) || *p == '.' ? skip_number(p) : p + 1;
  }
  return false;
}

/* ---- what is wrong with it ---- */

tdm_status tdm_expression_fail(const char *text, const char *path, tdm_error *err, const char *format, ...) {
  char message[TDM_MESSAGE_MAX];
  va_list args;
  va_start(args, format);
  vsnprintf(message, sizeof message, format, args);
  va_end(args);
  return tdm_fail(err, TDM_ERR_SCENE, path, "\"%.150s%s\" %s", text, strlen(text) > 150 ? "…" : "", message);
}

/* an operator of one or two characters; 0: none */
static size_t operator_at(const char *p) {
  static const char *const two[] = {"<=", ">=", "==", "!=", "&&", "||"};
  for (size_t i = 0; i < sizeof two / sizeof two[0]; i++)
    if (strncmp(p, two[i], 2) == 0)
      return 2;
  return *p && strchr("+-*/^<>?:,()", *p) ? 1 : 0;
}

static tdm_status check_function(const char *text, const tdm_name *name, const char *path, tdm_error *err) {
  const char *words[NFUNCTION];
  for (int i = 0; i < NFUNCTION; i++)
    words[i] = functions[i].name;
  if (name->called && !is_function(name->text)) {
    const char *near = strcmp(name->text, "log") == 0 ? "ln" : tdm_nearest(name->text, words, NFUNCTION);
    if (near)
      return tdm_expression_fail(text, path, err, "has the unknown function %s(); did you mean %s()?", name->text,
                                 near);
    return tdm_expression_fail(
        text, path, err, "has the unknown function %s(); docs/runs.md lists them (a product needs its *)", name->text);
  }
  if (!name->called && is_function(name->text))
    return tdm_expression_fail(text, path, err, "has %s without its arguments; write %s(…)", name->text, name->text);
  return TDM_OK;
}

tdm_status tdm_expression_check(const char *text, const char *path, tdm_error *err) {
  int depth = 0;
  const char *p = text + 1;
  if (strlen(p) > TDM_EXPRESSION_MAX)
    return tdm_expression_fail(text, path, err, "has %zu characters, more than %d; make parameters of its parts",
                               strlen(p), TDM_EXPRESSION_MAX);
  if (!p[strspn(p, " \t")])
    return tdm_expression_fail(text, path, err, "is empty; write a number or an expression after the =");
  while (*p) {
    const size_t n = operator_at(p);
    if (is_letter(*p)) {
      const tdm_name name = name_at(p);
      if (check_function(text, &name, path, err) != TDM_OK)
        return err->status;
      p = skip_name(p);
    } else if (is_digit(*p) || *p == '.')
      p = skip_number(p);
    else if (n == 0 && *p != ' ' && *p != '\t')
      return tdm_expression_fail(text, path, err, "cannot be read at \"%.30s\"%s", p,
                                 *p == '=' ? "; write == to compare" : "; use + - * / ^ ( ), names and numbers");
    else {
      depth += *p == '(';
      depth -= *p == ')';
      if (depth < 0)
        return tdm_expression_fail(text, path, err, "has a \")\" without its \"(\"");
      if (*p == ',' && depth == 0)
        return tdm_expression_fail(text, path, err, "has a comma outside of a function; the decimal sign is a point");
      p += n ? n : 1;
    }
  }
  if (depth > 0)
    return tdm_expression_fail(text, path, err, "has a \"(\" without its \")\"");
  return TDM_OK;
}

/* ---- computing ---- */

/* muParser throws when there is no memory, which C cannot catch, or calls it an internal error: look ourselves. */
static bool there_is_memory(void) {
  void *volatile room = malloc(1 << 18); /* volatile: compilers leave out what nobody looks at */
  free(room);
  return room != NULL;
}

tdm_calculator *tdm_calculator_create(tdm_error *err) {
  tdm_calculator *c = calloc(1, sizeof *c);
  if (!c || !there_is_memory()) {
    free(c);
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    return NULL;
  }
  c->parser = mupCreate(muBASETYPE_FLOAT);
  mupClearFun(c->parser);
  mupClearConst(c->parser);
  for (int i = 0; i < NCONSTANT; i++)
    mupDefineConst(c->parser, constants[i].name, constants[i].value);
  for (int i = 0; i < NFUNCTION; i++) {
    if (functions[i].one)
      mupDefineFun1(c->parser, functions[i].name, functions[i].one, 1);
    else if (functions[i].two)
      mupDefineFun2(c->parser, functions[i].name, functions[i].two, 1);
    else
      mupDefineMultFun(c->parser, functions[i].name, functions[i].many, 1);
  }
  return c;
}

void tdm_calculator_destroy(tdm_calculator **calculator) {
  if (*calculator)
    mupRelease((*calculator)->parser);
  free(*calculator);
  *calculator = NULL;
}

void tdm_calculator_clear(tdm_calculator *c) {
  mupClearVar(c->parser);
}

void tdm_calculator_bind(tdm_calculator *c, const char *name, const double *value) {
  mupDefineVar(c->parser, name, (double *)value); /* it is only read: assignments are refused */
}

/* muParser's codes, of muParserError.h, which is C++ */
enum { MU_TOO_MANY = 14, MU_TOO_FEW = 15, MU_INTERNAL = 39 /* a lone sign, or no memory */ };

static void tell_error(muParserHandle_t parser, const char *text, const char *path, tdm_error *err) {
  const int code = mupGetErrorCode(parser), at = mupGetErrorPos(parser);
  const int size = (int)strlen(text + 1);
  if (code == MU_INTERNAL && !there_is_memory())
    tdm_fail(err, TDM_ERR_MEMORY, path, "out of memory");
  else if (code == MU_TOO_MANY || code == MU_TOO_FEW)
    tdm_expression_fail(text, path, err, "has a function with too %s arguments", code == MU_TOO_MANY ? "many" : "few");
  else if (at < 0 || at >= size)
    tdm_expression_fail(text, path, err, "is not whole: a number, a name or the rest of a ? b : c is missing");
  else
    tdm_expression_fail(text, path, err, "cannot be read at \"%.30s\"; is an operator or a number missing there?",
                        text + 1 + at);
}

double tdm_calculate(tdm_calculator *c, const char *text, const char *path, tdm_error *err) {
  double value = 0;
  mupErrorReset(c->parser);
  mupSetExpr(c->parser, text + 1);
  if (!mupError(c->parser))
    value = mupEval(c->parser);
  if (mupError(c->parser))
    tell_error(c->parser, text, path, err);
  return err->status == TDM_OK ? value : 0;
}
