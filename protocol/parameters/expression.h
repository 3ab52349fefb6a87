/* One expression: "=eps*cos(phi)".
 *
 *   numbers, names of parameters, pi, deg, ( ) + - * / ^, comparisons, && ||, a ? b : c, and the functions below
 *
 * muParser reads and computes it, whatever the process's locale is. What names it may hold and what is said of a wrong
 * one is decided here. No state is shared: threads may each have a calculator.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_PARAMETERS_EXPRESSION_H
#define TDM_PARAMETERS_EXPRESSION_H

#include "protocol/base/status.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>

enum { TDM_EXPRESSION_MAX = 1000, TDM_NAME_MAX = 64 }; /* characters of an expression, of a name */

/* The text of an expression, with its "="; NULL: `value` is something else. */
const char *tdm_expression(const json_t *value);

/* A name in an expression. */
typedef struct {
  char text[TDM_NAME_MAX + 1]; /* cut, if it is longer than names may be */
  const char *at;              /* where it stands */
  bool called;                 /* "(" follows: a function */
} tdm_name;

/* The next name at or after `text` that is no constant; false at the end. Goes on behind name->at + strlen(text). */
bool tdm_expression_next_name(const char *text, tdm_name *name);

/* Whether pi, deg or a function has the name: then no parameter can. */
bool tdm_expression_knows(const char *name);

/* Names that an expression may hold beside parameters, i = 0, 1 …; NULL behind the last. */
const char *tdm_expression_word(int i);

/* An expression that cannot be read for its length, characters, brackets, or functions: an error at `path`. */
tdm_status tdm_expression_check(const char *text, const char *path, tdm_error *err);

/* An error of the expression `text` (cut if it is long) at `path`: "\"=text\" " and then printf's. */
tdm_status tdm_expression_fail(const char *text, const char *path, tdm_error *err, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* ---- computing ---- */

typedef struct tdm_calculator tdm_calculator;

/* A calculator, which the caller destroys; NULL and an error (TDM_ERR_MEMORY) when there is none. */
tdm_calculator *tdm_calculator_create(tdm_error *err);

/* Free it; *calculator is NULL then. */
void tdm_calculator_destroy(tdm_calculator **calculator);

/* Forget the values of all names. */
void tdm_calculator_clear(tdm_calculator *calculator);

/* The name has the value *value (borrowed until the names are cleared). */
void tdm_calculator_bind(tdm_calculator *calculator, const char *name, const double *value);

/* The value of an expression that tdm_expression_check has passed and whose names are bound. Not finite, or not to be
 * read: an error (TDM_ERR_SCENE) at `path`, and 0. */
double tdm_calculate(tdm_calculator *calculator, const char *text, const char *path, tdm_error *err);

#endif
