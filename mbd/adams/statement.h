/* The statements of an Adams data set (.adm): what stands on which line, attributes and numbers.
 *
 *   title                       first line, no statement
 *   KEYWORD/id, NAME = value    a statement; keywords and names may be cut short where that is unique
 *   , NAME = value              goes on with it, as does a line behind one that ends in &
 *   ! comment                   anywhere; blank lines count for nothing
 *   END                         nothing behind it is read
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_ADAMS_STATEMENT_H
#define MBD_ADAMS_STATEMENT_H

#include "protocol/base/status.h"

#include <stdbool.h>
#include <stddef.h>

enum { ADM_WORD_MAX = 31, ADM_VIEW_NAME_MAX = 64, ADM_IDS_MAX = 3 };

/* What a statement is to a mechanism of rigid bodies. */
typedef enum {
  ADM_READ,  /* it is translated */
  ADM_SHOWN, /* it moves nothing: pictures, requests, settings of Adams */
  ADM_ACTS   /* it may move something */
} adm_meaning;

typedef struct {
  char keyword[ADM_WORD_MAX + 1]; /* in full where it is known, capitals */
  adm_meaning meaning;
  long id;                               /* 0: none */
  int line;                              /* where it begins, from 1 */
  char *text;                            /* behind the id; a '\n' for each further line; owned */
  char view_name[ADM_VIEW_NAME_MAX + 1]; /* of the comment adams_view_name='...' before it; "": none */
} adm_statement;

typedef struct {
  const char *file; /* borrowed */
  char title[128];
  int n;
  adm_statement *statement; /* (n), END left out */
} adm_dataset;

/* Read a file. Zero-initialise; free with adm_dataset_free, also after an error, which names file and line. */
tdm_status adm_dataset_read(adm_dataset *d, const char *file, tdm_error *err);
void adm_dataset_free(adm_dataset *d);

/* An error at a line of the data set: "FILE:LINE: " and printf's. */
tdm_status adm_fail(const adm_dataset *d, int line, tdm_error *err, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* ---- attributes ---- */

typedef struct {
  char name[ADM_WORD_MAX + 1]; /* as written, capitals */
  const char *known;           /* the same in full, one of the reader's names; NULL: it is none */
  char *value;                 /* behind the =, owned; NULL: there is none */
  int line;
} adm_attribute;

/* The attributes of a statement. */
typedef struct {
  const adm_dataset *dataset;
  const adm_statement *of;
  int n;
  adm_attribute *attribute; /* (n) */
  tdm_error *err;           /* where the functions below put their errors */
} adm_reader;

/* Part a statement into attributes that `names` (NULL-terminated, borrowed) may have. Free also after an error. */
tdm_status adm_open(adm_reader *r, const adm_dataset *d, const adm_statement *of, const char *const *names,
                    tdm_error *err);
void adm_close(adm_reader *r);

/* The attribute of this full name; NULL: it is not there. */
const adm_attribute *adm_find(const adm_reader *r, const char *name);

/* The place of its value, or of the attribute itself, in `words` (NULL-terminated; each may be cut short): -1 and an
 * error if there is none. */
int adm_choose(const adm_reader *r, const char *value, int line, const char *const *words);

/* Up to `most` numbers of an attribute into x: how many there are. 0: it is not there, or an error; fewer than `least`
 * are one. Angles in degrees ("30D") become radians. */
int adm_numbers(const adm_reader *r, const char *name, int least, int most, double *x);

/* A number, or `otherwise` where the attribute is not there. */
double adm_number(const adm_reader *r, const char *name, double otherwise);

/* As adm_numbers, for identifiers: whole numbers from 1. most: ADM_IDS_MAX or less. */
int adm_ids(const adm_reader *r, const char *name, int least, int most, long *id);

/* An identifier; 0: it is not there, which is an error if it is `required`. */
long adm_id(const adm_reader *r, const char *name, bool required);

/* All numbers of an attribute, in a new array that the caller frees; NULL: not there, or an error. */
double *adm_all_numbers(const adm_reader *r, const char *name, int *n);

/* The number at *at, which moves behind it: digits, exponent, D for degrees; false: there is none, or it is
 * above 1e60, so that products of a few numbers stay finite. */
bool adm_scan_number(const char **at, double *x);

#endif
