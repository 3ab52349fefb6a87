/* What the command lines of tandem and of the solvers share: options, signals, the exit status. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_APP_COMMAND_LINE_H
#define TDM_APP_COMMAND_LINE_H

#include "protocol/base/interrupt.h"
#include "protocol/base/status.h"

#include <stdbool.h>

enum { TDM_WORDS_MAX = 31 };

/* Values of an option that may come more than once. */
typedef struct {
  const char *word[TDM_WORDS_MAX + 1]; /* borrowed, NULL-terminated */
  int n;
} tdm_words;

/* An option "--name": with a value, a flag, a flag that a number may follow (both), with a value each time it
 * comes (words; `each` of them, 0 is 1), or (none of these) one of --set, which may come more than once. */
typedef struct {
  const char *name, **value;
  bool *flag;
  tdm_words *words;
  int each;
} tdm_option;

/* Words that are no options, and the values of --set; both NULL-terminated. Free with tdm_arguments_free. */
typedef struct {
  const char **word, **set;
  int nword, nset;
  char **rest; /* what stands behind "--", NULL-terminated, borrowed; NULL: there is no "--" */
} tdm_arguments;

/* Read `argc` words behind the command; `program` is named in errors. Strings are borrowed from argv. The caller frees
 * also after an error. */
tdm_status tdm_arguments_read(tdm_arguments *arguments, const tdm_option *options, int noption, const char *program,
                              int argc, char **argv, tdm_error *err);
void tdm_arguments_free(tdm_arguments *arguments);

/* An error for a command that is none of `names`. */
tdm_status tdm_unknown_command(const char *program, const char *command, const char *const *names, int nname,
                               tdm_error *err);

/* From now on signals set tdm_interrupted and so end a run in order; calls that wait are woken. */
void tdm_catch_signals(void);

/* In a child, right before exec: signals act as they do by default. One that came since the fork, which the new program
 * would never hear of, ends the child with 130. */
void tdm_release_signals(void);

/* Print the error, if it is set, and return the exit status: 0, 1, 2 (wrong command line), 130 (interrupted). */
int tdm_finish(const char *program, const tdm_error *err);

#endif
