/* The line between an FMU's binary, which lives in another tool's process, and tandem-serve, a process of its own that
 * plays the server: messages over a pair of sockets, numbers as the machine has them.
 *
 * The binary asks, tandem-serve answers each question once, with the same kind. Before the first question it says what
 * there is (GUEST_HELLO). When either end is closed the other one ends.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_EXPORT_GUEST_LINK_H
#define CPL_EXPORT_GUEST_LINK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Kinds of messages; what their numbers are. A text comes with answers: the token (HELLO), or what is to be logged. */
typedef enum {
  GUEST_HELLO,   /* answer: GUEST_HELLO_NUMBERS, then the start values of the inputs */
  GUEST_START,   /* time the run may last [s] (NaN: not known), inputs_at_end, inputs. Answer: outputs, mobility */
  GUEST_STEP,    /* t and h [s], from the start on; inputs. Answer: outputs, mobility */
  GUEST_KEEP,    /* slot */
  GUEST_RESTORE, /* slot */
  GUEST_STOP     /* back to before GUEST_START */
} guest_kind;

/* The numbers of GUEST_HELLO: inputs, outputs, and of these the first that is an acceleration, how many follow each
 * other in a body's outputs, bodies whose accelerations follow the loads at once (0: none do, and no mobility comes),
 * whether outputs at the start depend on the inputs there. */
enum {
  GUEST_NINPUT,
  GUEST_NOUTPUT,
  GUEST_ACCELERATION, /* place of a body's first acceleration among its outputs */
  GUEST_STRIDE,       /* outputs a body */
  GUEST_NBODY,
  GUEST_STARTS_ANEW,
  GUEST_HELLO_NUMBERS
};

/* What became of a question: FMI's numbers. */
typedef enum { GUEST_OK, GUEST_WARNING, GUEST_DISCARD, GUEST_ERROR, GUEST_FATAL } guest_status;

enum { GUEST_SLOTS_MAX = 14 }; /* states that can be kept at a time; the coupled loop needs two slots for itself */

/* A message that was received. Zero-initialise; free with guest_message_free. */
typedef struct {
  guest_kind kind;
  guest_status status;
  char *text;     /* never NULL once one was received */
  double *number; /* (nnumber) */
  size_t nnumber;
  size_t text_room, number_room; /* bytes and numbers that there is room for */
} guest_message;

/* Send one; false: the other end is gone. */
bool guest_send(int fd, guest_kind kind, guest_status status, const char *text, const double *number, size_t nnumber);

/* Wait for one; false: the other end is gone, or memory is. */
bool guest_receive(int fd, guest_message *message);

void guest_message_free(guest_message *message);

#endif
