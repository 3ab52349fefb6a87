/* Function expressions of an Adams data set, as far as a scene can hold them: a sum of terms, each a number times
 *
 *   a power of the time, a sine of it, a smooth step of it, a spline of it,
 *   the distance of two markers, its rate, the angle or the rate of rotation between them,
 *   a power of how far that distance or angle is beyond a limit (IMPACT, BISTOP).
 *
 * Numbers are in the data set's units, angles in radians, until a term is written.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_ADAMS_FUNCTION_H
#define MBD_ADAMS_FUNCTION_H

#include "mbd/adams/statement.h"

#include <jansson.h>

typedef enum {
  ADM_POWER,   /* t^n */
  ADM_SINE,    /* sin(a t + b) */
  ADM_STEP,    /* from 0 at t = a to 1 at t = b by the cubic 3 s^2 - 2 s^3 */
  ADM_STEP5,   /* the same by 10 s^3 - 15 s^4 + 6 s^5 */
  ADM_SPLINE,  /* SPLINE/id of a t + b, or of a x + b where x is a measure */
  ADM_MEASURE, /* of two markers */
  ADM_IMPACT   /* (b - a x)^exponent of a measure x where that is positive, else 0 */
} adm_term_kind;

typedef enum { ADM_TIME, ADM_DM, ADM_VR, ADM_AZ, ADM_WZ } adm_measure;

typedef struct {
  adm_term_kind kind;
  double factor;
  int power;           /* ADM_POWER */
  double a, b;         /* as above */
  long spline;         /* ADM_SPLINE: its identifier */
  bool akima;          /* ADM_SPLINE: Akima's, else a cubic spline */
  double exponent;     /* ADM_IMPACT */
  adm_measure measure; /* ADM_MEASURE, ADM_SPLINE, ADM_IMPACT */
  long marker[2];      /* I, J of the measure */
} adm_term;

enum { ADM_TERMS = 24 };

/* A sum of terms; no two powers are the same. */
typedef struct {
  int n;
  adm_term term[ADM_TERMS];
} adm_form;

/* Read `text` into *form. NULL, or why it is none of these ("what is wrong with it", to be completed by the caller), in
 * a buffer that lives until the next call of the thread. */
const char *adm_form_read(adm_form *form, const char *text);

/* The number in front of t^power, 0 where it is not there. */
double adm_form_power(const adm_form *form, int power);

/* Whether it has nothing but powers, sines, steps and splines of the time. */
bool adm_form_of_time(const adm_form *form);

/* ---- as a motion law (law.c) ---- */

/* A spline of the data set. */
typedef struct {
  const adm_statement *of;
  int n;
  double *x, *y; /* (n) owned */
} adm_spline;

/* What a law is made with. */
typedef struct {
  double time, scale;       /* seconds a unit of time; metres, newtons ... a unit of the value */
  double offset;            /* added to the value, in its unit there */
  int derivative;           /* 0: the form is the value; 1: its rate, 2: its second derivative */
  double start[2];          /* of the value and its rate at t = 0, where the form is a derivative; units of the file */
  const adm_spline *spline; /* (nspline) */
  int nspline;
} adm_law_def;

/* The motion law (new reference) of a form of the time. NULL and the reason in *why. `notes`: what a reader should know
 * of it is appended. */
json_t *adm_law(const adm_form *form, const adm_law_def *def, json_t *notes, const char **why);

/* A number as JSON: that many digits that a person reads it as it was meant, 15. null: it is not finite; adm_import
 * refuses a scene with one. */
json_t *adm_real(double x);

const adm_spline *adm_find_spline(const adm_spline *spline, int nspline, long id);

#endif
