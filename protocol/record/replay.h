/* Plays one solver of a recorded exchange against a server: what it sent comes again, in the same order, whatever the
 * other side does now. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_RECORD_REPLAY_H
#define TDM_RECORD_REPLAY_H

#include "protocol/record/record.h"

/* How the replay went. */
typedef struct {
  uint64_t windows; /* STEPs that were answered */
  uint64_t differ;  /* of them those that are not as they were recorded */
  double first;     /* start of the first of these [s] */
} tdm_replay_report;

/* Play the role (0 mbd, 1 dem) until FINISH. `timeout` [s]: silence of the server after which it counts as lost.
 * Errors: the record is damaged or ends too early, the server asks for other windows or other things than were
 * recorded; they are sent to the server, too. */
tdm_status tdm_replay(const char *file, int role, const char *endpoint, double timeout, tdm_replay_report *report,
                      tdm_error *err);

#endif
