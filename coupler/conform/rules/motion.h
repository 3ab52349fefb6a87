/* For rules of the DEM side: coupled bodies that go known ways, from where they are at the start. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_CONFORM_RULES_MOTION_H
#define CPL_CONFORM_RULES_MOTION_H

#include "coupler/conform/meeting.h"

/* Where bodies are, (nbody) each: at the window's start, and at its end. */
typedef struct {
  tdm_state *start, *end;
} cpl_motion;

extern const double cpl_slow;            /* [m/s] that leaves contacts as they are for a while */
extern const char cpl_nothing_touches[]; /* why a rule is not seen */

/* Bodies at rest where they start, to be freed. False: no memory. */
bool cpl_motion_make(cpl_motion *motion, const cpl_meeting *meeting);
void cpl_motion_free(cpl_motion *motion);

/* The same in a meeting that is opened for it; false: there is neither a meeting nor a motion. End frees both, whatever
 * the solver does. */
bool cpl_motion_begin(cpl_motion *motion, cpl_meeting *meeting, cpl_candidate *candidate, cpl_verdict *verdict);
void cpl_motion_end(cpl_motion *motion, cpl_meeting *meeting);

/* Solve the step with the bodies as `motion` has them. */
bool cpl_motion_solve(cpl_meeting *meeting, const cpl_motion *motion, tdm_step *step, tdm_result *result);

/* From the end of the last window all bodies go on at `velocity` through n steps; or through a step that is given, body
 * i at `velocity` and i times `more`. */
bool cpl_motion_go(cpl_meeting *meeting, cpl_motion *motion, tdm_vec3 velocity, long n, tdm_result *result);
bool cpl_motion_go_apart(cpl_meeting *meeting, cpl_motion *motion, tdm_vec3 velocity, tdm_vec3 more, tdm_step *step,
                         tdm_result *result);

#endif
