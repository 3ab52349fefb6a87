/* main() of a solver process. */
/* SPDX-License-Identifier: MIT */
#include "protocol/base/log.h"
#include "protocol/wire/participant.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void usage(const tdm_solver_ops *ops, const char *program) {
  printf("usage: %s --connect ENDPOINT [--name NAME] [--timeout SECONDS]\n\n"
         "%s, the %s side of a tandem co-simulation. \"tandem run SCENE\" starts it by itself.\n\n"
         "  --connect ENDPOINT  where the server listens, for example ipc:///tmp/dir/tandem\n"
         "  --name NAME         the name in messages and logs (default: %s)\n"
         "  --timeout SECONDS   give up when the server is silent for so long (default: 30)\n"
         "  --help, --version\n\n"
         "The log goes to standard error, one line of key=value pairs an event.\n",
         program, ops->software, ops->role, ops->role);
}

int tdm_solver_main(const tdm_solver_ops *ops, int argc, char **argv) {
  tdm_participant_def def = tdm_participant_default_def();
  def.name = def.role = ops->role;
  def.software = ops->software;
  def.capabilities = ops->capabilities;
  def.ncapability = ops->ncapability;
  for (int i = 1; i < argc; i++) {
    const char *option = argv[i];
    if (strcmp(option, "--help") == 0) {
      usage(ops, argv[0]);
      return 0;
    }
    if (strcmp(option, "--version") == 0) {
      printf("%s, protocol %d\n", ops->software, TDM_PROTOCOL_VERSION);
      return 0;
    }
    const char *value = i + 1 < argc ? argv[++i] : NULL;
    char *end = NULL;
    if (value && strcmp(option, "--connect") == 0)
      def.endpoint = value;
    else if (value && strcmp(option, "--name") == 0)
      def.name = value;
    else if (value && strcmp(option, "--timeout") == 0 && (def.timeout = strtod(value, &end)) > 0 && *end == 0)
      continue;
    else {
      fprintf(stderr, "%s: wrong option or value: %s %s; see %s --help\n", argv[0], option, value ? value : "",
              argv[0]);
      return 2;
    }
  }
  if (!def.endpoint) {
    fprintf(stderr, "%s: no server given; use --connect ENDPOINT, or let \"tandem run\" start this solver\n", argv[0]);
    return 2;
  }
  tdm_log_open(stderr, def.name);
  tdm_error err = {0};
  return tdm_participant_run(ops, &def, &err) == TDM_OK ? 0 : 1;
}
