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
  unsigned run;                       /* of the solvers: another one after each time that they were stopped */
  bool slot[GUEST_SLOTS_MAX];         /* taken, of this run */
};

/* A state that is kept. Before the first step it is all here; later the solvers have a part of it, under a slot, as
 * long as their run lasts. */
typedef struct {
  guest_phase phase;
  int slot; /* -1: none */
  unsigned run;
  bool at_end;
  double start, stop, t;
  double *number; /* inputs, outputs, known, mobility */
} guest_kept;

/* Make an instance: NULL after an error, which was said. `resources` is a folder, `token` the description's. */
guest *guest_make(guest_say *say, void *owner, const char *token, const char *resources);
void guest_free(guest **g);

/* All that follow return GUEST_OK or what was said of the fault. */

/* Begin initialization, of an experiment from start to stop [s]; the solvers are started when an output is asked for,
 * or at its end. */
guest_status guest_enter(guest *g, double start, bool has_stop, double stop);

/* End initialization: the solvers are READY, steps may come. */
guest_status guest_leave(guest *g);

/* End the solvers; outputs stay. */
guest_status guest_terminate(guest *g);

/* Back to how the instance was when it was made, also after an error. */
guest_status guest_reset(guest *g);

/* Get or set n variables of type real or boolean by their value references. Real inputs can be set at any time, and
 * count from the next step on; outputs can be got from initialization on. */
guest_status guest_get(guest *g, const uint32_t *reference, size_t n, double *value);
guest_status guest_set(guest *g, const uint32_t *reference, size_t n, const double *value);
guest_status guest_get_flag(guest *g, const uint32_t *reference, size_t n, bool *value);
guest_status guest_set_flag(guest *g, const uint32_t *reference, size_t n, const bool *value);

/* Step from t, where the last one ended, by h [s]. GUEST_DISCARD: nothing was done, a step of another length or with
 * other inputs may go. GUEST_ERROR: go back to a state that was kept where the stop time was passed; else reset. */
guest_status guest_step(guest *g, double t, double h);

/* Keep the state in *kept, NULL or one that is overwritten; go back to one; free one (NULL: nothing). A state that was
 * kept between steps is refused once the solvers were stopped; one from before can be gone back to at any time. */
guest_status guest_keep(guest *g, guest_kept **kept);
guest_status guest_go_back(guest *g, const guest_kept *kept);
void guest_forget(guest *g, guest_kept **kept);

/* How (nunknown) outputs change when (nknown) inputs change by `seed`, into `derivative` (nunknown). */
guest_status guest_derivative(guest *g, const uint32_t *unknown, size_t nunknown, const uint32_t *known, size_t nknown,
                              const double *seed, double *derivative);

/* Say something with printf's arguments, and return the status. */
guest_status guest_fail(guest *g, guest_status status, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Types of variables that no tandem FMU has, and functions of capabilities that it does not claim. */
guest_status guest_lacks(guest *g, const char *function);

/* The folder of a "file:" URI, percent-decoded, into out; a path stays. False, and said: it is too long. */
bool guest_path_of(guest *g, const char *uri, char *out, size_t size);

#endif
