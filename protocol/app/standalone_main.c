/* main() of a solver that also runs scenes alone. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/app/command_line.h"
#include "protocol/app/find.h"
#include "protocol/app/plot.h"
#include "protocol/app/standalone.h"

#include <stdio.h>
#include <string.h>

typedef struct {
  tdm_arguments given;
  const char *out, *scenarios;
  bool force, strict, no_plots;
} arguments;

static tdm_status parse(arguments *a, const char *program, int argc, char **argv, tdm_error *err) {
  const tdm_option options[] = {{.name = "--out", .value = &a->out},
                                {.name = "--scenarios", .value = &a->scenarios},
                                {.name = "--set"},
                                {.name = "--force", .flag = &a->force},
                                {.name = "--strict", .flag = &a->strict},
                                {.name = "--no-plots", .flag = &a->no_plots}};
  return tdm_arguments_read(&a->given, options, sizeof options / sizeof options[0], program, argc, argv, err);
}

/* one command on one scene */
static tdm_status perform(const tdm_standalone_program *p, const arguments *a, bool check, tdm_error *err) {
  const char *command = check ? "check" : "run";
  char scene[4096];
  if (check && (a->out || a->force || a->no_plots))
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "check: %s does not go with this command; see %s --help",
                    a->out     ? "--out"
                    : a->force ? "--force"
                               : "--no-plots",
                    p->name);
  if (a->given.nword != 1)
    return tdm_fail(err, TDM_ERR_ARGUMENT, NULL, "%s: name one scene; see %s --help", command, p->name);
  if (tdm_find_scene(scene, sizeof scene, p->ops->role, a->given.word[0], a->scenarios, err) != TDM_OK)
    return err->status;
  const tdm_standalone_options options = {.scene = scene,
                                          .set = a->given.set,
                                          .out = a->out ? a->out : "run-out",
                                          .force = a->force,
                                          .strict = a->strict,
                                          .no_plots = a->no_plots};
  return tdm_standalone_perform(p, &options, check, err);
}

int tdm_standalone_main(const tdm_standalone_program *p, int argc, char **argv) {
  static const char *const commands[] = {"run", "check"};
  tdm_error err = {0};
  arguments a = {0};
  for (int i = 1; i < argc; i++)
    if (strcmp(argv[i], "--help") == 0) {
      fputs(p->help, stdout);
      return 0;
    }
  if (argc < 2) {
    fputs(p->help, stderr);
    return 2;
  }
  if (strncmp(argv[1], "--", 2) == 0)
    return tdm_solver_main(p->ops, argc, argv);
  tdm_catch_signals();
  int k = 0;
  while (k < 2 && strcmp(argv[1], commands[k]) != 0)
    k++;
  if (k == 2)
    tdm_unknown_command(p->name, argv[1], commands, 2, &err);
  else if (parse(&a, p->name, argc - 2, argv + 2, &err) == TDM_OK)
    perform(p, &a, k == 1, &err);
  if (tdm_plot_interrupted())
    tdm_fail(&err, TDM_ERR_INTERRUPTED, NULL,
             "interrupted while plotting; the results are whole, not all plots are there");
  tdm_arguments_free(&a.given);
  return tdm_finish(p->name, &err);
}
