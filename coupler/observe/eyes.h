/* What both solvers have to see, asked by VIEW between windows and put together (join.h). Nothing of a run depends on
 * it: a solver that cannot be seen, or says what makes no sense, is a remark. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_OBSERVE_EYES_H
#define CPL_OBSERVE_EYES_H

#include "coupler/observe/join.h"
#include "coupler/session/session.h"

/* Zero-initialise; freed with cpl_eyes_free. */
typedef struct {
  cpl_session *session; /* borrowed */
  bool sees[CPL_NROLE];
  bool with_contacts; /* of the present question */
  tdm_scenery scenery[CPL_NROLE];
  tdm_snapshot snapshot[CPL_NROLE];
  cpl_join join;
} cpl_eyes;

/* Ask for the sceneries of those that have one, and make one scenery of them. An error is one of the session. */
tdm_status cpl_eyes_open(cpl_eyes *eyes, const cpl_settings *settings, cpl_session *session, tdm_scenery *both,
                         tdm_error *err);

/* The state of time t [s], with contacts if both->with_contacts. *seen is false when a solver has no answer: *both is
 * as it was. */
tdm_status cpl_eyes_look(cpl_eyes *eyes, double t, tdm_snapshot *both, bool *seen, tdm_error *err);

void cpl_eyes_free(cpl_eyes *eyes);

#endif
