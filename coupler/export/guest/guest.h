/* An instance of an exported FMU, whatever the version of the standard: its variables, and what it asks tandem-serve.
 * fmi2.c and fmi3.c give it the standards' names.
 *
 * Value references: 0 is time, then the inputs, then the outputs (coupler/export/serve/variables.h has their order);
 * the one behind them is the boolean parameter inputs_at_end. Instances share nothing; each has a process of its own.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_EXPORT_GUEST_GUEST_H
#define CPL_EXPORT_GUEST_GUEST_H

#include "coupler/export/guest/host.h"
#include "coupler/export/guest/link.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum { GUEST_INSTANTIATED, GUEST_INITIALIZING, GUEST_STEPPING, GUEST_ENDED } guest_phase;

typedef struct guest guest;

/* Tells the tool something. */
typedef void guest_say(guest *g, guest_status status, const char *text);

struct guest {
  guest_say *say;
  void *owner; /* of `say` */
  guest_host host;
  guest_message answer; /* the last one */
  guest_phase phase;
  bool lost;              /* tandem-serve is gone, or said that it cannot go on: only to be reset or freed */
  size_t ninput, noutput; /* variables */
  size_t nbody, stride, acceleration; /* of GUEST_HELLO; nbody 0: outputs never follow the inputs at once */
  bool starts_anew;                   /* outputs at the start depend on the inputs there */
  bool started, stale;                /* GUEST_START was answered; inputs have changed since */
  double *first;                      /* (ninput) start values of the inputs */
  double *input, *output;             /* (ninput), (noutput) */
  double *known;                      /* (ninput) inputs that the outputs belong to */
  double *mobility;                   /* (6 nbody x 6 nbody) accelerations by loads; zeros at first */
  bool at_end;                        /* inputs_at_end */
  double start, stop;                 /* of the experiment [s]; stop is NaN when not known */
  double t;                           /* where it is [s] */
  bool slot[GUEST_SLOTS_MAX];         /* taken */
};

/* A state that is kept. */
typedef struct {
  int slot;
  double t;
  double *number; /* inputs, outputs, known, mobility */
} guest_kept;

/* Make an instance: NULL after an error, which was said. `resources` is a folder, `token` the description's. */
guest *guest_make(guest_say *say, void *owner, const char *token, const char *resources);
void guest_free(guest **g);

/* All return GUEST_OK or what was said of the fault. */
guest_status guest_enter(guest *g, double start, bool has_stop, double stop);
guest_status guest_leave(guest *g);
guest_status guest_terminate(guest *g);
guest_status guest_reset(guest *g);
guest_status guest_get(guest *g, const uint32_t *reference, size_t n, double *value);
guest_status guest_set(guest *g, const uint32_t *reference, size_t n, const double *value);
guest_status guest_get_flag(guest *g, const uint32_t *reference, size_t n, bool *value);
guest_status guest_set_flag(guest *g, const uint32_t *reference, size_t n, const bool *value);
guest_status guest_step(guest *g, double t, double h);
guest_status guest_keep(guest *g, guest_kept **kept);
guest_status guest_go_back(guest *g, const guest_kept *kept);
void guest_forget(guest *g, guest_kept **kept);
guest_status guest_derivative(guest *g, const uint32_t *unknown, size_t nunknown, const uint32_t *known, size_t nknown,
                              const double *seed, double *derivative);

/* Say something with printf's arguments, and return the status. */
guest_status guest_fail(guest *g, guest_status status, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Types of variables that no tandem FMU has, and functions of capabilities that it does not claim. */
guest_status guest_lacks(guest *g, const char *function);

/* The folder of a "file:" URI, percent-decoded, into out; a path stays. */
void guest_path_of(const char *uri, char *out, size_t size);

#endif
