/* What the command lines of tandem and of the solvers share: see command_line.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/app/command_line.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static tdm_status unknown_option(const tdm_option *options, int noption, const char *program, const char *word,
                                 tdm_error *err) {
  const char *names[64];
  int n = 0;
  for (; n < noption && n < 64; n++)
    names[n] = options[n].name;
  const char *near = tdm_nearest(word, names, n);
  if (strchr(word, '='))
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL,
                    "unknown option %s; a value is a word of its own, without =; see %s --help", word, program);
  return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "unknown option %s%s%s; see %s --help", word,
                  near ? "; did you mean " : "", near ? near : "", program);
}

tdm_status tdm_arguments_read(tdm_arguments *a, const tdm_option *options, int noption, const char *program, int argc,
                              char **argv, tdm_error *err) {
  a->word = calloc((size_t)argc + 1, sizeof *a->word);
  a->set = calloc((size_t)argc + 1, sizeof *a->set);
  if (!a->word || !a->set)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i < argc; i++) {
    if (strcmp(argv[i], "--") == 0) {
      a->rest = argv + i + 1;
      break;
    }
    if (strncmp(argv[i], "--", 2) != 0) {
      a->word[a->nword++] = argv[i];
      continue;
    }
    int k = 0;
    while (k < noption && strcmp(argv[i], options[k].name) != 0)
      k++;
    if (k == noption)
      return unknown_option(options, noption, program, argv[i], err);
    if (options[k].flag) {
      *options[k].flag = true;
      if (options[k].value && i + 1 < argc && strspn(argv[i + 1], "0123456789.") == strlen(argv[i + 1]))
        *options[k].value = argv[++i];
      continue;
    }
    const int each = options[k].each > 1 ? options[k].each : 1;
    if (each == 1 && i + 1 == argc)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s needs a value", argv[i]);
    for (int v = 1; each > 1 && v <= each; v++)
      if (i + v >= argc || strncmp(argv[i + v], "--", 2) == 0)
        return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s needs %d values", argv[i], each);
    if (options[k].words && options[k].words->n + each > TDM_WORDS_MAX)
      return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s comes more than %d times", argv[i], TDM_WORDS_MAX / each);
    if (options[k].value)
      *options[k].value = argv[++i];
    else if (options[k].words)
      for (int v = 0; v < each; v++)
        options[k].words->word[options[k].words->n++] = argv[++i];
    else
      a->set[a->nset++] = argv[++i];
  }
  return TDM_OK;
}

void tdm_arguments_free(tdm_arguments *a) {
  free(a->word);
  free(a->set);
  *a = (tdm_arguments){0};
}

tdm_status tdm_unknown_command(const char *program, const char *command, const char *const *names, int nname,
                               tdm_error *err) {
  const char *near = tdm_nearest(command, names, nname);
  return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "unknown command \"%s\"%s%s; see %s --help", command,
                  near ? "; did you mean " : "", near ? near : "", program);
}

static void on_signal(int number) {
  (void)number;
  tdm_interrupted = 1;
  tdm_signal_count++;
}

void tdm_catch_signals(void) {
  struct sigaction action = {.sa_handler = on_signal}, hangup;
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  sigaction(SIGHUP, NULL, &hangup);
  if (hangup.sa_handler != SIG_IGN) /* nohup */
    sigaction(SIGHUP, &action, NULL);
  signal(SIGPIPE, SIG_IGN);
  signal(SIGXFSZ, SIG_IGN); /* a file at its size limit is an error of the write, as on a full disk */
}

void tdm_release_signals(void) {
  struct sigaction action = {.sa_handler = SIG_DFL}, hangup;
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
  sigaction(SIGHUP, NULL, &hangup);
  if (hangup.sa_handler != SIG_IGN)
    sigaction(SIGHUP, &action, NULL);
  if (tdm_interrupted)
    _exit(130);
}

int tdm_finish(const char *program, const tdm_error *err) {
  if (err->status == TDM_OK)
    return 0;
  fprintf(stderr, "%s: error: %s\n", program, err->message);
  return err->status == TDM_ERR_ARGUMENT ? 2 : err->status == TDM_ERR_INTERRUPTED ? 130 : 1;
}
