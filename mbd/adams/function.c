/* Function expressions of an Adams data set: see function.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/adams/function.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { DEPTH = 32, ARGUMENTS = 16 };

typedef struct {
  const char *at;
  int depth;
  bool failed;
} parser;

static _Thread_local char reason[256];

static void refuse(parser *p, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void refuse(parser *p, const char *format, ...) {
  if (p->failed)
    return;
  p->failed = true;
  va_list args;
  va_start(args, format);
  vsnprintf(reason, sizeof reason, format, args);
  va_end(args);
}

/* ---- forms ---- */

static adm_form constant(double x) {
  return (adm_form){.n = 1, .term = {{.kind = ADM_POWER, .factor = x}}};
}

static bool alike(const adm_term *a, const adm_term *b) {
  return a->kind == b->kind && a->power == b->power && a->a == b->a && a->b == b->b && a->spline == b->spline &&
         a->akima == b->akima && a->exponent == b->exponent && a->measure == b->measure &&
         a->marker[0] == b->marker[0] && a->marker[1] == b->marker[1];
}

static void add_term(parser *p, adm_form *form, const adm_term *term) {
  if (!isfinite(term->factor) || !isfinite(term->a) || !isfinite(term->b))
    refuse(p, "has a number that is not finite");
  for (int i = 0; i < form->n; i++)
    if (alike(&form->term[i], term)) {
      form->term[i].factor += term->factor;
      return;
    }
  if (form->n == ADM_TERMS)
    refuse(p, "has more than %d terms", ADM_TERMS);
  else
    form->term[form->n++] = *term;
}

/* a + factor b */
static adm_form sum(parser *p, const adm_form *a, double factor, const adm_form *b) {
  adm_form out = *a;
  for (int i = 0; i < b->n && !p->failed; i++) {
    adm_term term = b->term[i];
    term.factor *= factor;
    add_term(p, &out, &term);
  }
  return out;
}

static bool only_powers(const adm_form *form) {
  for (int i = 0; i < form->n; i++)
    if (form->term[i].kind != ADM_POWER)
      return false;
  return true;
}

static bool is_constant(const adm_form *form, double *x) {
  *x = 0;
  for (int i = 0; i < form->n; i++) {
    if (form->term[i].kind != ADM_POWER || (form->term[i].power != 0 && form->term[i].factor != 0))
      return false;
    *x += form->term[i].power == 0 ? form->term[i].factor : 0;
  }
  return true;
}

double adm_form_power(const adm_form *form, int power) {
  for (int i = 0; i < form->n; i++)
    if (form->term[i].kind == ADM_POWER && form->term[i].power == power)
      return form->term[i].factor;
  return 0;
}

bool adm_form_of_time(const adm_form *form) {
  for (int i = 0; i < form->n; i++)
    if (form->term[i].measure != ADM_TIME)
      return false;
  return true;
}

static adm_form product(parser *p, const adm_form *a, const adm_form *b) {
  double x;
  const adm_form zero = {0};
  if (is_constant(a, &x))
    return sum(p, &zero, x, b);
  if (is_constant(b, &x))
    return sum(p, &zero, x, a);
  adm_form out = {0};
  if (!only_powers(a) || !only_powers(b)) {
    refuse(p, "multiplies two quantities that both change");
    return out;
  }
  for (int i = 0; i < a->n; i++)
    for (int k = 0; k < b->n && !p->failed; k++) {
      const adm_term term = {.kind = ADM_POWER,
                             .factor = a->term[i].factor * b->term[k].factor,
                             .power = a->term[i].power + b->term[k].power};
      if (term.power > 12)
        refuse(p, "has a power of the time above 12");
      else
        add_term(p, &out, &term);
    }
  return out;
}

static double number_of(parser *p, const adm_form *form, const char *what) {
  double x;
  if (!is_constant(form, &x))
    refuse(p, "has %s that changes; it must be a number", what);
  return x;
}

static adm_form power_of(parser *p, const adm_form *base, const adm_form *exponent) {
  double x, n = number_of(p, exponent, "an exponent");
  if (is_constant(base, &x))
    return constant(pow(x, n));
  adm_form out = constant(1);
  if (n != floor(n) || n < 0 || n > 12)
    refuse(p, "has a power other than 0, 1 ... 12 of what changes");
  for (int i = 0; i < n && !p->failed; i++)
    out = product(p, &out, base);
  return out;
}

/* ---- functions ---- */

typedef struct {
  int n;
  adm_form form[ARGUMENTS];
  long id[ARGUMENTS]; /* the argument as an identifier, 0: it is none */
} arguments;

/* a and b of an argument a t + b, or a x + b of a measure x; which one is in *term */
static void linear(parser *p, const adm_form *form, const char *name, adm_term *term) {
  *term = (adm_term){.measure = ADM_TIME};
  for (int i = 0; i < form->n && !p->failed; i++) {
    const adm_term *t = &form->term[i];
    if (t->factor == 0)
      continue;
    const bool time = t->kind == ADM_POWER && t->power == 1;
    if (t->kind == ADM_POWER && t->power == 0)
      term->b += t->factor;
    else if ((time || t->kind == ADM_MEASURE) && term->a == 0) {
      term->a = t->factor;
      term->measure = t->measure;
      memcpy(term->marker, t->marker, sizeof term->marker);
    } else
      refuse(p, "has %s of something other than a*TIME + b", name);
  }
}

static adm_form sine(parser *p, const char *name, const adm_form *of, double phase) {
  adm_term term;
  linear(p, of, name, &term);
  if (term.measure != ADM_TIME)
    refuse(p, "has %s of something other than a*TIME + b", name);
  if (term.a == 0)
    return constant(sin(term.b + phase));
  term.kind = ADM_SINE;
  term.factor = 1;
  term.b += phase;
  return (adm_form){.n = 1, .term = {term}};
}

/* STEP(a*TIME + b, x0, h0, x1, h1) */
static adm_form step(parser *p, const char *name, const arguments *a) {
  adm_term term;
  const double x0 = number_of(p, &a->form[1], "an end of a step"), h0 = number_of(p, &a->form[2], "a step"),
               x1 = number_of(p, &a->form[3], "an end of a step"), h1 = number_of(p, &a->form[4], "a step");
  linear(p, &a->form[0], name, &term);
  if (!p->failed && (term.measure != ADM_TIME || !(term.a > 0)))
    refuse(p, "has %s of something other than the time", name);
  if (!p->failed && !(x1 > x0))
    refuse(p, "has %s that does not rise: its x1 is not greater than its x0", name);
  adm_form out = constant(h0);
  const adm_term rise = {.kind = strcmp(name, "STEP5") == 0 ? ADM_STEP5 : ADM_STEP,
                         .factor = h1 - h0,
                         .a = (x0 - term.b) / term.a,
                         .b = (x1 - term.b) / term.a};
  if (!p->failed)
    add_term(p, &out, &rise);
  return out;
}

/* AKISPL(x, 0, id) and CUBSPL: value, of one variable */
static adm_form spline(parser *p, const char *name, const arguments *a) {
  adm_term term;
  linear(p, &a->form[0], name, &term);
  if (a->n > 3 && number_of(p, &a->form[3], "the order of a spline") != 0)
    refuse(p, "has a derivative of %s", name);
  if (number_of(p, &a->form[1], "the second variable of a spline") != 0)
    refuse(p, "has %s of two variables", name);
  if (a->id[2] == 0)
    refuse(p, "has %s without the identifier of a SPLINE", name);
  if (term.a == 0)
    refuse(p, "has %s of a constant", name);
  term.kind = ADM_SPLINE;
  term.factor = 1;
  term.spline = a->id[2];
  term.akima = name[0] == 'A';
  return (adm_form){.n = 1, .term = {term}};
}

/* One side of IMPACT or BISTOP: way k (way (limit - x))^e, with k, e and the damping behind the argument `last`. way: 1
 * below the limit, -1 above it. */
static adm_form one_side(parser *p, const char *name, const arguments *a, double way, int limit, int last) {
  adm_term term;
  linear(p, &a->form[0], name, &term);
  const double from = number_of(p, &a->form[limit], "a limit"), k = number_of(p, &a->form[last + 1], "a stiffness"),
               e = number_of(p, &a->form[last + 2], "an exponent"), c = number_of(p, &a->form[last + 3], "a damping");
  if (!p->failed && (term.a == 0 || (term.measure != ADM_DM && term.measure != ADM_AZ)))
    refuse(p, "has %s of something other than a distance DM or an angle AZ", name);
  if (!p->failed && c != 0)
    refuse(p, "has %s with damping, which a scene's stops have in another form", name);
  if (!p->failed && !(k >= 0 && e >= 1))
    refuse(p, "has %s with a stiffness below 0 or an exponent below 1", name);
  term.kind = ADM_IMPACT;
  term.factor = way * k;
  term.a *= way;
  term.b = way * (from - term.b);
  term.exponent = e;
  return (adm_form){.n = 1, .term = {term}};
}

/* IMPACT(x, xdot, x1, k, e, cmax, d) and BISTOP(x, xdot, x1, x2, k, e, cmax, d) without damping */
static adm_form impact(parser *p, const char *name, const arguments *a) {
  if (a->n == 7)
    return one_side(p, name, a, 1, 2, 2);
  const adm_form below = one_side(p, name, a, 1, 2, 3), above = one_side(p, name, a, -1, 3, 3);
  return sum(p, &below, 1, &above);
}

/* POLY(x, x0, a0, a1, ...): a0 + a1 (x - x0) + ... */
static adm_form poly(parser *p, const arguments *a) {
  adm_form s = sum(p, &a->form[0], -1, &a->form[1]), out = {0};
  for (int i = a->n - 1; i >= 2 && !p->failed; i--) {
    out = product(p, &out, &s);
    out = sum(p, &out, 1, &a->form[i]);
  }
  return out;
}

/* SHF(x, x0, a, w, phi, b): a sin(w (x - x0) - phi) + b */
static adm_form shf(parser *p, const arguments *a) {
  adm_form s = sum(p, &a->form[0], -1, &a->form[1]);
  s = product(p, &a->form[3], &s);
  s = sum(p, &s, -1, &a->form[4]);
  s = sine(p, "SHF", &s, 0);
  s = product(p, &a->form[2], &s);
  return sum(p, &s, 1, &a->form[5]);
}

static adm_form measured(parser *p, adm_measure which, const char *name, const arguments *a) {
  const bool more = which == ADM_WZ || which == ADM_VR;
  adm_term term = {.kind = ADM_MEASURE, .factor = 1, .measure = which, .marker = {a->id[0], a->id[1]}};
  if (a->n < 2 || a->id[0] == 0 || a->id[1] == 0)
    refuse(p, "has %s without two markers", name);
  else if (a->n > 2 && !(more && a->id[2] != 0))
    refuse(p, "has %s in axes or frames of another marker", name);
  else if (which == ADM_WZ && !(a->n == 3 && a->id[2] == a->id[1]) && !(a->n == 3 && a->id[2] == a->id[0]))
    refuse(p, "has WZ in axes that are not those of one of its two markers");
  return (adm_form){.n = 1, .term = {term}};
}

/* of constants alone */
static const struct {
  const char *name;
  double (*of)(double);
} plain[] = {{"ABS", fabs},  {"SQRT", sqrt}, {"EXP", exp},   {"LOG", log},   {"LOG10", log10}, {"TAN", tan},
             {"ASIN", asin}, {"ACOS", acos}, {"ATAN", atan}, {"SINH", sinh}, {"COSH", cosh},   {"TANH", tanh}};

/* IF(x: below, at, above zero) of a constant x */
static adm_form choice(parser *p, const arguments *a) {
  const double x = number_of(p, &a->form[0], "a condition of IF");
  return a->form[x < 0 ? 1 : x > 0 ? 3 : 2];
}

/* how many arguments a function takes */
static const struct {
  const char *name;
  int least, most;
} functions[] = {{"SIN", 1, 1},    {"COS", 1, 1},   {"STEP", 5, 5},   {"STEP5", 5, 5},  {"AKISPL", 3, 4},
                 {"CUBSPL", 3, 4}, {"POLY", 3, 16}, {"SHF", 6, 6},    {"IF", 4, 4},     {"MIN", 2, 2},
                 {"MAX", 2, 2},    {"MOD", 2, 2},   {"ATAN2", 2, 2},  {"DM", 2, 2},     {"VR", 2, 3},
                 {"AZ", 2, 2},     {"WZ", 2, 3},    {"IMPACT", 7, 7}, {"BISTOP", 8, 8}, {NULL, 0, 0}};

static adm_form of_two(parser *p, const char *name, const arguments *a) {
  const double x = number_of(p, &a->form[0], "MIN, MAX, MOD or ATAN2 of something"),
               y = number_of(p, &a->form[1], "MIN, MAX, MOD or ATAN2 of something");
  return constant(strcmp(name, "MIN") == 0   ? fmin(x, y)
                  : strcmp(name, "MAX") == 0 ? fmax(x, y)
                  : strcmp(name, "MOD") == 0 ? fmod(x, y)
                                             : atan2(x, y));
}

static adm_form call(parser *p, const char *name, const arguments *a) {
  static const char *const measures[] = {[ADM_DM] = "DM", [ADM_VR] = "VR", [ADM_AZ] = "AZ", [ADM_WZ] = "WZ"};
  for (size_t i = 0; i < sizeof plain / sizeof plain[0]; i++)
    if (strcmp(plain[i].name, name) == 0 && a->n == 1)
      return constant(plain[i].of(number_of(p, &a->form[0], "a function of something")));
  int k = 0;
  while (functions[k].name && strcmp(functions[k].name, name) != 0)
    k++;
  if (!functions[k].name)
    refuse(p, "has the function %s, which a scene does not have", name);
  else if (a->n < functions[k].least || a->n > functions[k].most)
    refuse(p, "has %s with %d arguments", name, a->n);
  if (p->failed)
    return constant(0);
  for (int m = ADM_DM; m <= ADM_WZ; m++)
    if (strcmp(name, measures[m]) == 0)
      return measured(p, (adm_measure)m, name, a);
  if (strcmp(name, "SIN") == 0)
    return sine(p, name, &a->form[0], 0);
  if (strcmp(name, "COS") == 0)
    return sine(p, name, &a->form[0], M_PI / 2);
  if (strncmp(name, "STEP", 4) == 0)
    return step(p, name, a);
  if (strcmp(name, "POLY") == 0)
    return poly(p, a);
  if (strcmp(name, "SHF") == 0)
    return shf(p, a);
  if (strcmp(name, "IF") == 0)
    return choice(p, a);
  if (strcmp(name, "IMPACT") == 0 || strcmp(name, "BISTOP") == 0)
    return impact(p, name, a);
  return a->n == 2 ? of_two(p, name, a) : spline(p, name, a);
}

/* ---- the grammar ---- */

static adm_form expression(parser *p);

static void skip(parser *p) {
  p->at += strspn(p->at, " \t\n\r&");
}

/* A whole number that stands alone, an identifier. */
static long identifier(const char *at) {
  long id = 0;
  const char *p = at;
  for (; isdigit((unsigned char)*p) && p - at < 10; p++)
    id = 10 * id + (*p - '0');
  p += strspn(p, " \t\n\r&");
  return p > at && (*p == ',' || *p == ')') ? id : 0;
}

static adm_form named(parser *p) {
  char name[ADM_WORD_MAX + 1];
  int n = 0;
  for (; isalnum((unsigned char)*p->at) || *p->at == '_'; p->at++)
    if (n < ADM_WORD_MAX)
      name[n++] = (char)toupper((unsigned char)*p->at);
  name[n] = 0;
  skip(p);
  if (*p->at != '(') {
    const adm_form time = {.n = 1, .term = {{.kind = ADM_POWER, .factor = 1, .power = 1}}};
    if (strcmp(name, "TIME") == 0)
      return time;
    if (strcmp(name, "PI") == 0)
      return constant(M_PI);
    if (strcmp(name, "RTOD") == 0)
      return constant(180 / M_PI);
    if (strcmp(name, "DTOR") == 0)
      return constant(M_PI / 180);
    refuse(p, "has the name %s, which a scene does not have", name);
    return constant(0);
  }
  arguments a = {0};
  do {
    p->at++;
    skip(p);
    if (a.n == ARGUMENTS) {
      refuse(p, "has %s with more than %d arguments", name, ARGUMENTS);
      break;
    }
    a.id[a.n] = identifier(p->at);
    a.form[a.n++] = expression(p);
    skip(p);
  } while (!p->failed && (*p->at == ',' || *p->at == ':'));
  if (*p->at != ')')
    refuse(p, "has %s( without its )", name);
  p->at += *p->at == ')';
  return p->failed ? constant(0) : call(p, name, &a);
}

static adm_form primary(parser *p) {
  double x;
  skip(p);
  if (adm_scan_number(&p->at, &x))
    return constant(x);
  if (*p->at == '(') {
    p->at++;
    adm_form out = expression(p);
    skip(p);
    if (*p->at != ')')
      refuse(p, "has a ( without its )");
    p->at += *p->at == ')';
    return out;
  }
  if (isalpha((unsigned char)*p->at))
    return named(p);
  refuse(p, *p->at ? "cannot be read at \"%.20s\"" : "is not whole%s", p->at);
  return constant(0);
}

/* signs and powers: -x**2 is -(x**2) */
static adm_form signed_power(parser *p) {
  if (++p->depth > DEPTH)
    refuse(p, "is nested more than %d deep", DEPTH);
  adm_form out = constant(0);
  skip(p);
  if (!p->failed && (*p->at == '-' || *p->at == '+')) {
    const double sign = *p->at++ == '-' ? -1 : 1;
    const adm_form of = signed_power(p);
    out = sum(p, &out, sign, &of);
  } else if (!p->failed) {
    out = primary(p);
    skip(p);
    const int sign = *p->at == '^' ? 1 : strncmp(p->at, "**", 2) == 0 ? 2 : 0;
    if (sign > 0) {
      p->at += sign;
      const adm_form exponent = signed_power(p);
      out = power_of(p, &out, &exponent);
    }
  }
  p->depth--;
  return out;
}

static adm_form factors(parser *p) {
  adm_form out = signed_power(p);
  for (skip(p); !p->failed && (*p->at == '*' || *p->at == '/'); skip(p)) {
    const bool divide = *p->at++ == '/';
    adm_form by = signed_power(p);
    if (divide)
      by = constant(1 / number_of(p, &by, "a divisor"));
    out = product(p, &out, &by);
  }
  return out;
}

static adm_form expression(parser *p) {
  adm_form out = factors(p);
  for (skip(p); !p->failed && (*p->at == '+' || *p->at == '-'); skip(p)) {
    const double sign = *p->at++ == '-' ? -1 : 1;
    const adm_form more = factors(p);
    out = sum(p, &out, sign, &more);
  }
  return out;
}

const char *adm_form_read(adm_form *form, const char *text) {
  parser p = {.at = text};
  *form = expression(&p);
  skip(&p);
  p.at += strspn(p.at, ", \t\n\r");
  if (*p.at)
    refuse(&p, "cannot be read at \"%.20s\"", p.at);
  for (int i = 0; i < form->n; i++)
    if (!isfinite(form->term[i].factor))
      refuse(&p, "has a number that is not finite");
  return p.failed ? reason : NULL;
}
