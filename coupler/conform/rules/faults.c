/* Rules of what must not come: frames that are none, messages out of order, silence. A solver answers with ERROR where
 * it can, and ends with an exit status that is not 0; it does not crash, and does not wait for ever. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/conform/meeting.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* What was sent must be answered with ERROR, and the solver must end by itself, with an exit status that is not 0. */
static void expect_error(cpl_meeting *m, tdm_message_type otherwise, tdm_status wanted) {
  static const char expected[] = "ERROR, and an exit status that is not 0";
  const double grace = m->candidate->timeout;
  tdm_error err = {0};
  tdm_header header;
  char how[96];
  if (cpl_session_wait(&m->session, m->candidate->role, otherwise, &header, &err) == TDM_OK)
    cpl_broken(m->verdict, expected, "%s", tdm_message_name(otherwise));
  else if (err.status == TDM_ERR_LOST || err.status == TDM_ERR_TIMEOUT)
    cpl_broken(m->verdict, expected, "%s", err.message);
  else if (wanted != TDM_OK && err.status != wanted)
    cpl_broken(m->verdict, tdm_status_name(wanted), "%s: %s", tdm_status_name(err.status), err.message);
  else if (!cpl_meeting_ended(m, grace, how, sizeof how))
    cpl_broken(m->verdict, expected, "ERROR, but it goes on for more than %g s", grace);
  else if (strcmp(how, "exit status 0") == 0 || strncmp(how, "exit", 4) != 0)
    cpl_broken(m->verdict, expected, "ERROR, and: %s", how);
}

/* ---- frames ---- */

typedef enum { SHORT, MAGIC, VERSION, SIZE, TYPE, NFRAME } bad_frame;

static void spoil(tdm_frame *frame, bad_frame how) {
  switch (how) {
  case SHORT:
    frame->size = 10;
    break;
  case MAGIC:
    frame->data[0] = 'X';
    break;
  case VERSION:
    frame->data[4] = 99;
    break;
  case SIZE:
    frame->data[16] = 200;
    break;
  case TYPE:
    frame->data[6] = 77;
    break;
  case NFRAME:
    break;
  }
}

static void test_frames(cpl_candidate *c, cpl_verdict *v) {
  for (bad_frame how = 0; how < NFRAME; how++) {
    cpl_meeting m;
    tdm_frame frame = {0};
    if (!cpl_meeting_open(&m, c, v))
      return;
    if (tdm_control_write(&frame, TDM_HEARTBEAT, 0, NULL, NULL) == TDM_OK) {
      spoil(&frame, how);
      cpl_meeting_send(&m, &frame);
      expect_error(&m, TDM_RESULT, how == VERSION ? TDM_ERR_VERSION : TDM_OK);
    }
    tdm_frame_free(&frame);
    cpl_meeting_drop(&m);
  }
}

/* ---- steps ---- */

typedef enum {
  NAN_TIME,
  NAN_NUMBER,
  BACKWARDS,
  NO_STEPS,
  TOO_MANY_BODIES,
  CUT,
  LATE_SAMPLE,
  SAMPLES_REVERSED,
  NSTEP
} bad_step;

static void spoil_step(tdm_frame *frame, bad_step how) {
  uint8_t *payload = frame->data + TDM_HEADER_BYTES;
  const double not_a_number = NAN, before = -1;
  const uint64_t none = 0;
  switch (how) {
  case NAN_TIME:
    memcpy(payload + 8, &not_a_number, 8);
    break;
  case NAN_NUMBER: /* the first of a state, or of a load */
    memcpy(payload + TDM_STEP_BYTES, &not_a_number, 8);
    break;
  case BACKWARDS:
    memcpy(payload + 8, &before, 8);
    break;
  case NO_STEPS:
    memcpy(payload + 16, &none, 8);
    break;
  case TOO_MANY_BODIES:
    payload[24]++;
    break;
  case CUT: /* with a size in its header that fits */
    frame->size -= 8;
    frame->data[16] = (uint8_t)(frame->data[16] - 8);
    break;
  case LATE_SAMPLE: /* their times are wrong already */
  case SAMPLES_REVERSED:
  case NSTEP:
    break;
  }
}

static void test_steps(cpl_candidate *c, cpl_verdict *v) {
  for (bad_step how = 0; how < NSTEP; how++) {
    cpl_meeting m;
    tdm_frame frame = {0};
    tdm_wrench load = {0};
    tdm_state state = {.pose.orientation = {1, 0, 0, 0}};
    if (!cpl_meeting_open(&m, c, v))
      return;
    tdm_step step = cpl_meeting_next(&m, 3);
    const double half = 0.5 * step.t1;
    const double time[] = {how == SAMPLES_REVERSED ? step.t1 : half, how == SAMPLES_REVERSED ? half
                                                                     : how == LATE_SAMPLE    ? 1.5 * step.t1
                                                                                             : step.t1};
    step.nbody = 1; /* of a scene with more, that is another fault of the same kind */
    step.nsample = 2;
    step.sample_time = time;
    step.nstate = c->role == CPL_DEM;
    step.nload = c->role == CPL_MBD;
    step.start = step.end = &state;
    step.load = &load;
    if (tdm_step_write(&frame, &step, NULL) == TDM_OK) {
      spoil_step(&frame, how);
      cpl_meeting_send(&m, &frame);
      expect_error(&m, TDM_RESULT, TDM_OK);
    }
    tdm_frame_free(&frame);
    cpl_meeting_drop(&m);
  }
}

/* ---- order ---- */

static void test_early_step(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  tdm_frame frame = {0};
  if (!cpl_meeting_meet(&m, c, 0, v))
    return;
  const tdm_step step = {.t1 = m.settings.dt, .nstep = 1};
  if (tdm_step_write(&frame, &step, NULL) == TDM_OK && cpl_meeting_send(&m, &frame))
    expect_error(&m, TDM_READY, TDM_OK);
  tdm_frame_free(&frame);
  cpl_meeting_drop(&m);
}

/* What only solvers send, and ASSIGN for the second time. */
static void test_order(cpl_candidate *c, cpl_verdict *v) {
  static const tdm_message_type types[] = {TDM_ASSIGN, TDM_RESULT, TDM_READY, TDM_HELLO};
  for (size_t k = 0; k < sizeof types / sizeof types[0]; k++) {
    cpl_meeting m;
    tdm_frame frame = {0};
    json_t *empty = json_object();
    if (cpl_meeting_open(&m, c, v)) {
      if (tdm_control_write(&frame, types[k], 0, empty, NULL) == TDM_OK && cpl_meeting_send(&m, &frame))
        expect_error(&m, TDM_RESULT, TDM_OK);
      cpl_meeting_drop(&m);
    }
    tdm_frame_free(&frame);
    json_decref(empty);
  }
}

/* A body that the solver does not know must not go unnoticed. */
static void test_unknown_body(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  char name[] = "no_such_body";
  if (!cpl_meeting_meet(&m, c, 0, v))
    return;
  if (m.settings.nbody == 0) {
    cpl_not_seen(v, "the scene couples no body");
    cpl_meeting_drop(&m);
    return;
  }
  tdm_error err = {0};
  for (int r = 0; r < (int)c->role && err.status == TDM_OK; r++)
    cpl_session_assign(&m.session, (cpl_role)r, &m.scene, &err);
  m.settings.body[0].name[c->role] = name;
  if (err.status == TDM_OK && cpl_session_assign(&m.session, c->role, &m.scene, &err) == TDM_OK)
    cpl_not_seen(v, "it takes any name: make sure that a body it has not is an ERROR");
  else if (err.status == TDM_ERR_LOST || err.status == TDM_ERR_TIMEOUT)
    cpl_broken(v, "ERROR to an ASSIGN with a body that is not there", "%s", err.message);
  cpl_meeting_drop(&m);
}

/* ---- signals, silence ---- */

/* Ctrl-C goes to all processes of a terminal; the server ends the run in order. */
static void test_interrupt(cpl_candidate *c, cpl_verdict *v) {
  cpl_meeting m;
  char how[96];
  if (!cpl_meeting_open(&m, c, v))
    return;
  cpl_child_interrupt(m.session.partner[c->role].child);
  if (cpl_meeting_ended(&m, 0.5, how, sizeof how)) {
    cpl_broken(v, "a solver that goes on after SIGINT, until FINISH", "%s", how);
    cpl_meeting_drop(&m);
  } else {
    cpl_meeting_finish(&m);
  }
}

static void test_silence(cpl_candidate *c, cpl_verdict *v) {
  const double told = 1, grace = c->timeout;
  cpl_meeting m;
  char how[96];
  if (!cpl_meeting_meet(&m, c, told, v))
    return;
  m.settings.timeout = told;
  if (!cpl_meeting_assign(&m))
    return;
  if (!cpl_meeting_ended(&m, told + grace, how, sizeof how))
    cpl_broken(v, "its end when the server is silent for 1 s, as --timeout and ASSIGN have it",
               "it still waits after %g s", told + grace);
  else if (strcmp(how, "exit status 0") == 0 || strncmp(how, "exit", 4) != 0)
    cpl_broken(v, "an exit status that is not 0 after the server's silence", "%s", how);
  cpl_meeting_drop(&m);
}

const cpl_rule cpl_rules_faults[] = {{.name = "faults.frames",
                                      .section = "2",
                                      .roles = CPL_OF_BOTH,
                                      .text = "frames that are none are answered with ERROR",
                                      .test = test_frames},
                                     {.name = "faults.steps",
                                      .section = "5",
                                      .roles = CPL_OF_BOTH,
                                      .text = "STEPs that cannot be are answered with ERROR",
                                      .test = test_steps},
                                     {.name = "faults.early_step",
                                      .section = "2",
                                      .roles = CPL_OF_BOTH,
                                      .text = "a STEP before ASSIGN is an ERROR",
                                      .test = test_early_step},
                                     {.name = "faults.order",
                                      .section = "2",
                                      .roles = CPL_OF_BOTH,
                                      .text = "so is what the server does not send then",
                                      .test = test_order},
                                     {.name = "faults.body",
                                      .section = "4",
                                      .roles = CPL_OF_BOTH,
                                      .text = "a body that it does not know is an ERROR",
                                      .test = test_unknown_body},
                                     {.name = "faults.sigint",
                                      .section = "1",
                                      .roles = CPL_OF_BOTH,
                                      .text = "it leaves SIGINT to the server",
                                      .test = test_interrupt},
                                     {.name = "faults.silence",
                                      .section = "1",
                                      .roles = CPL_OF_BOTH,
                                      .text = "it leaves a server that is silent",
                                      .test = test_silence},
                                     {.name = NULL}};
