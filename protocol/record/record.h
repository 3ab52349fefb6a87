/* Records of an exchange: every frame between the server and its solvers, but for HEARTBEATs, in the order in which the
 * server sent and heard them.
 *
 * A file begins with 16 bytes: "TNDMREC", a zero, u32 version 1, u32 0. A frame follows 8 bytes: u8 role (0 mbd, 1
 * dem), u8 who sent it (0 the server, 1 the solver), u16 0, u32 bytes of the frame. All little-endian.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_RECORD_RECORD_H
#define TDM_RECORD_RECORD_H

#include "protocol/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef enum { TDM_FROM_SERVER, TDM_FROM_SOLVER } tdm_sender;

/* ---- writing ---- */

/* A record that is written; NULL: nothing is recorded. */
typedef struct tdm_recorder tdm_recorder;

/* Begin a file. TDM_ERR_FILE: it cannot be written. */
tdm_status tdm_recorder_open(tdm_recorder **recorder, const char *file, tdm_error *err);

/* Add a frame; HEARTBEATs are left out. What cannot be written is told by tdm_recorder_close. `recorder` may be NULL.
 */
void tdm_recorder_add(tdm_recorder *recorder, int role, tdm_sender sender, const void *frame, size_t size);

/* End the file. *recorder becomes NULL; it may be. TDM_ERR_FILE: something could not be written. */
tdm_status tdm_recorder_close(tdm_recorder **recorder, tdm_error *err);

/* ---- reading ---- */

/* A record that is read, frame by frame. */
typedef struct {
  FILE *file;
  const char *name; /* of the file, borrowed */
  uint8_t *frame;   /* of the last one, owned */
  size_t capacity;
} tdm_record;

/* A frame that was recorded. */
typedef struct {
  int role;
  tdm_sender sender;
  const uint8_t *frame; /* lives until the next one is read */
  size_t size;          /* [bytes] */
} tdm_recorded;

/* Open a file. TDM_ERR_FILE: it cannot be read, or is no record. */
tdm_status tdm_record_open(tdm_record *record, const char *file, tdm_error *err);

/* The next frame of a role. False at the end, or after an error (a file that is cut: TDM_ERR_FILE). */
bool tdm_record_next(tdm_record *record, int role, tdm_recorded *next, tdm_error *err);

void tdm_record_close(tdm_record *record);

#endif
