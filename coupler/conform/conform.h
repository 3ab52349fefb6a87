/* `tandem conform`: plays the server against a solver, and tells which rules of PROTOCOL.md it keeps.
 *
 * Each rule is a row of a table (rules.h) with a test that starts the solver anew as often as it needs. A DEM solver
 * gets its bodies from tandem's multibody solver, or the one that the scene names.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_CONFORM_CONFORM_H
#define CPL_CONFORM_CONFORM_H

#include "coupler/session/launch.h"

typedef struct {
  const char *scene;       /* file; NULL: a small one, with an empty section for the solver */
  const char *const *set;  /* NULL-terminated "path=value" overrides, may be NULL */
  const char *command;     /* that starts the solver; blanks part its words */
  const char *role;        /* "dem" or "mbd"; NULL: what its HELLO says */
  const char *const *rule; /* NULL-terminated names of the only rules to test, beside "hello"; NULL: all */
  const char *json;        /* report as JSON; NULL: none */
  double timeout;          /* silence after which it counts as hanging [s] */
  cpl_solver solver[CPL_NROLE];
} cpl_conform_options;

/* Test all rules and print a row for each. TDM_ERR_PROTOCOL when one is broken. */
tdm_status cpl_conform(const cpl_conform_options *options, tdm_error *err);

#endif
