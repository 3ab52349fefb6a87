/* tandem-player: either solver of a recorded exchange, in its place. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/app/command_line.h"
#include "protocol/base/log.h"
#include "protocol/record/replay.h"
#include "protocol/version.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void usage(FILE *out) {
  fputs("tandem-player: plays a solver of an exchange that tandem run --record has stored\n\n"
        "  \"dem\": {\"solver\": \"tandem-player FILE\", ...}\n"
        "      in a scene: the server starts it, and DEM's part comes from the record; \"mbd\" likewise.\n\n"
        "  tandem-player FILE --connect ENDPOINT --name NAME [--timeout SECONDS] [--role dem|mbd]\n"
        "      --role   default: NAME, as the server starts solvers by their role\n",
        out);
}

int main(int argc, char **argv) {
  tdm_error err = {0};
  tdm_arguments given = {0};
  tdm_replay_report report = {0};
  const char *endpoint = NULL, *name = NULL, *seconds = "30", *role = NULL;
  const tdm_option options[] = {{.name = "--connect", .value = &endpoint},
                                {.name = "--name", .value = &name},
                                {.name = "--timeout", .value = &seconds},
                                {.name = "--role", .value = &role}};
  for (int i = 1; i < argc; i++) {
    if (strcmp(argv[i], "--help") == 0) {
      usage(stdout);
      return 0;
    }
    if (strcmp(argv[i], "--version") == 0) {
      printf("tandem-player %s, protocol %d\n", TDM_VERSION, TDM_PROTOCOL_VERSION);
      return 0;
    }
  }
  signal(SIGINT, SIG_IGN); /* the server ends it */
  if (tdm_arguments_read(&given, options, 4, "tandem-player", argc - 1, argv + 1, &err) == TDM_OK) {
    role = role ? role : name ? name : "";
    const int which = strcmp(role, "dem") == 0 ? 1 : strcmp(role, "mbd") == 0 ? 0 : -1;
    const double timeout = atof(seconds);
    if (given.nword != 1 || !endpoint || which < 0 || !(timeout > 0))
      tdm_fail(&err, TDM_ERR_ARGUMENT, NULL, "give one record, --connect and a role; see tandem-player --help");
    else {
      tdm_log_open(stderr, role);
      tdm_replay(given.word[0], which, endpoint, timeout, &report, &err);
      tdm_log(TDM_LOG_INFO, "played", "windows=%llu differ=%llu", (unsigned long long)report.windows,
              (unsigned long long)report.differ);
    }
  }
  tdm_arguments_free(&given);
  return tdm_finish("tandem-player", &err);
}
