/* One session of the server with the solver under test and its partner, from HELLO to FINISH. What goes wrong in one
 * breaks the rule that it was opened for. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_CONFORM_MEETING_H
#define CPL_CONFORM_MEETING_H

#include "coupler/conform/rules.h"
#include "coupler/session/session.h"
#include "coupler/settings/scheme.h"

typedef struct {
  cpl_candidate *candidate; /* borrowed */
  cpl_verdict *verdict;     /* borrowed */
  tdm_scene scene;
  cpl_settings settings;
  cpl_session session;
  cpl_scheme scheme; /* asks the solver for all that it has announced */
  uint64_t step;     /* DEM steps so far */
  uint64_t window;   /* windows so far */
  tdm_frame kept;    /* arrays of a RESULT that were kept (cpl_meeting_keep) */
} cpl_meeting;

/* Read the scene as meetings do, and forget it: what is wrong there is no fault of the solver. */
tdm_status cpl_meeting_check(cpl_candidate *candidate, tdm_error *err);

/* Start both and wait for their HELLO. `timeout` [s] is the one that the solver is told; 0: the candidate's. False: the
 * rule is broken, and the meeting is over. */
bool cpl_meeting_meet(cpl_meeting *meeting, cpl_candidate *candidate, double timeout, cpl_verdict *verdict);

/* The same, and ASSIGN until READY of both. */
bool cpl_meeting_open(cpl_meeting *meeting, cpl_candidate *candidate, cpl_verdict *verdict);
bool cpl_meeting_assign(cpl_meeting *meeting);

/* (nbody) the bodies of READY, at rest where they start. The caller frees them; NULL: no memory. */
tdm_state *cpl_meeting_rest(const cpl_meeting *meeting);

/* The next window of n steps, without load, path or samples. */
tdm_step cpl_meeting_next(const cpl_meeting *meeting, long n);

/* Send it to the solver under test. Arrays of the result live until the next one. */
bool cpl_meeting_solve(cpl_meeting *meeting, const tdm_step *step, tdm_result *result);

/* Send the solver a frame as it is; true when it went. */
bool cpl_meeting_send(cpl_meeting *meeting, const tdm_frame *frame);

/* Wait up to `seconds` for the solver's end. False: it goes on. `how` (size bytes): "exit status 0", "killed by …". */
bool cpl_meeting_ended(cpl_meeting *meeting, double seconds, char *how, size_t size);

/* FINISH; the solver is to end with exit status 0 (else the rule is broken). Frees all. */
void cpl_meeting_finish(cpl_meeting *meeting);

/* Give up, whatever the solver does. Frees all. */
void cpl_meeting_drop(cpl_meeting *meeting);

#endif
