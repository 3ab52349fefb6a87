/* The solvers of an FMU's side, from their start until they are READY: for tandem export, which looks at them, and for
 * tandem-serve, which runs them. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_EXPORT_SERVE_STAGE_H
#define CPL_EXPORT_SERVE_STAGE_H

#include "coupler/export/serve/variables.h"
#include "coupler/run/private.h"
#include "coupler/settings/scheme.h"

typedef struct {
  cpl_export_side side;
  tdm_scene scene;
  cpl_settings settings;
  cpl_scheme alone; /* of a side with one solver */
  cpl_session session;
  cpl_private own; /* of the socket and the logs */
  bool open;       /* the session */
  bool restores;   /* the solvers of the side keep states, and were told that they will have to */
  bool talks;      /* what solvers are at until they are READY goes to the terminal; false at first */
} cpl_stage;

/* Read the scene as the side needs it; `roles`, flags 1 << role, are those whose solvers will be started. Freed by
 * cpl_stage_free, also after an error. */
tdm_status cpl_stage_load(cpl_stage *stage, cpl_export_side side, unsigned roles, const char *scene,
                          const char *const *set, tdm_error *err);

/* Start the solvers of the roles, flags 1 << role, by their commands (the scene's, else `program`), and wait until they
 * are READY. With dem and without mbd, stage->bodies of cpl_stage_bodies comes first. */
tdm_status cpl_stage_start(cpl_stage *stage, unsigned roles, const char *const program[CPL_NROLE], tdm_error *err);

/* Open the session, as cpl_stage_start does first, for who has something to put into it. */
tdm_status cpl_stage_open(cpl_stage *stage, tdm_error *err);

/* In place of mbd: what it said of the coupled bodies, "bodies" of its READY (borrowed). */
tdm_status cpl_stage_bodies(cpl_stage *stage, json_t *bodies, tdm_error *err);

/* End the solvers: in order, or (err set) whatever they do. */
void cpl_stage_stop(cpl_stage *stage, const tdm_error *err);

void cpl_stage_free(cpl_stage *stage);

#endif
