/* `tandem export fmu`: a scene, or one side of it, as a co-simulation FMU that other tools run. See docs/fmu.md. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_EXPORT_EXPORT_H
#define CPL_EXPORT_EXPORT_H

#include "coupler/session/launch.h"

typedef struct {
  const char *scene;            /* file */
  const char *const *set;       /* NULL-terminated "path=value" overrides, may be NULL */
  const char *out;              /* the FMU; NULL: NAME.fmu, by the scene's name */
  const char *side;             /* "dem", "mbd", "both"; NULL: dem */
  const char *version;          /* of the standard: "2", "3"; NULL: 2 */
  bool force;                   /* replace a file that is there */
  cpl_solver solver[CPL_NROLE]; /* tandem's own */
} cpl_export_options;

/* Start the solvers, see what they have, pack the FMU, and print what is in it. */
tdm_status cpl_export_fmu(const cpl_export_options *options, tdm_error *err);

#endif
