/* The functions of FMI 2.0 for co-simulation, by their names in the standard: see guest.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fmi/fmi2.h"
#include "coupler/export/guest/guest.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define FMI2(result, name, ...)   \
  result fmi2##name(__VA_ARGS__); \
  __attribute__((visibility("default"))) result fmi2##name(__VA_ARGS__)

typedef struct {
  guest *g;
  const fmi2_callbacks *callbacks;
  char name[128];
} instance;

#define GUEST(c) (((instance *)(c))->g)

static void say(guest *g, guest_status status, const char *text) {
  static const char *const categories[] = {"logAll", "logStatusWarning", "logStatusDiscard", "logStatusError",
                                           "logStatusFatal"};
  const instance *i = g->owner;
  if (i->callbacks && i->callbacks->logger)
    i->callbacks->logger(i->callbacks->environment, i->name, (fmi2_status)status, categories[status], "%s", text);
}

/* ---- life ---- */

FMI2(const char *, GetTypesPlatform, void) {
  return "default";
}

FMI2(const char *, GetVersion, void) {
  return "2.0";
}

FMI2(fmi2_status, SetDebugLogging, fmi2_instance c, int on, size_t n, const char *const *categories) {
  (void)c, (void)on, (void)n, (void)categories; /* what the solvers remark is told, always */
  return FMI2_OK;
}

FMI2(fmi2_instance, Instantiate, const char *name, int kind, const char *guid, const char *resources,
     const fmi2_callbacks *callbacks, int visible, int logging) {
  char folder[4096];
  instance *i = calloc(1, sizeof *i);
  (void)visible, (void)logging;
  if (!i)
    return NULL;
  i->callbacks = callbacks;
  snprintf(i->name, sizeof i->name, "%s", name ? name : "");
  guest teller = {.say = say, .owner = i};
  if (kind != FMI2_CO_SIMULATION)
    guest_fail(&teller, GUEST_ERROR, "this FMU is for co-simulation, not for model exchange");
  else if (guest_path_of(&teller, resources ? resources : "", folder, sizeof folder))
    i->g = guest_make(say, i, guid, folder);
  if (i->g)
    return i;
  free(i);
  return NULL;
}

FMI2(void, FreeInstance, fmi2_instance c) {
  instance *i = c;
  if (i)
    guest_free(&i->g);
  free(i);
}

FMI2(fmi2_status, SetupExperiment, fmi2_instance c, int has_tolerance, double tolerance, double start, int has_stop,
     double stop) {
  (void)has_tolerance, (void)tolerance; /* the scene has those of its solvers */
  guest *g = GUEST(c);
  if (g->phase != GUEST_INSTANTIATED)
    return (fmi2_status)guest_fail(g, GUEST_ERROR, "fmi2SetupExperiment comes before initialization");
  g->start = g->t = start;
  g->stop = has_stop ? stop : NAN;
  return FMI2_OK;
}

FMI2(fmi2_status, EnterInitializationMode, fmi2_instance c) {
  guest *g = GUEST(c);
  return (fmi2_status)guest_enter(g, g->start, isfinite(g->stop), g->stop);
}

FMI2(fmi2_status, ExitInitializationMode, fmi2_instance c) {
  return (fmi2_status)guest_leave(GUEST(c));
}

FMI2(fmi2_status, Terminate, fmi2_instance c) {
  return (fmi2_status)guest_terminate(GUEST(c));
}

FMI2(fmi2_status, Reset, fmi2_instance c) {
  return (fmi2_status)guest_reset(GUEST(c));
}

/* ---- variables ---- */

FMI2(fmi2_status, GetReal, fmi2_instance c, const fmi2_reference *r, size_t n, double *value) {
  return (fmi2_status)guest_get(GUEST(c), r, n, value);
}

FMI2(fmi2_status, SetReal, fmi2_instance c, const fmi2_reference *r, size_t n, const double *value) {
  return (fmi2_status)guest_set(GUEST(c), r, n, value);
}

FMI2(fmi2_status, GetBoolean, fmi2_instance c, const fmi2_reference *r, size_t n, int *value) {
  guest_status status = GUEST_OK;
  for (size_t i = 0; i < n && status == GUEST_OK; i++) {
    bool flag = false;
    status = guest_get_flag(GUEST(c), r + i, 1, &flag);
    value[i] = flag;
  }
  return (fmi2_status)status;
}

FMI2(fmi2_status, SetBoolean, fmi2_instance c, const fmi2_reference *r, size_t n, const int *value) {
  guest_status status = GUEST_OK;
  for (size_t i = 0; i < n && status == GUEST_OK; i++)
    status = guest_set_flag(GUEST(c), r + i, 1, &(bool){value[i] != 0});
  return (fmi2_status)status;
}

/* Types of which there are no variables: nothing to do for none. */
#define NONE(name, type)                                                                    \
  FMI2(fmi2_status, name, fmi2_instance c, const fmi2_reference *r, size_t n, type value) { \
    (void)r, (void)value;                                                                   \
    return n == 0 ? FMI2_OK : (fmi2_status)guest_lacks(GUEST(c), "fmi2" #name);             \
  }
NONE(GetInteger, int *)
NONE(SetInteger, const int *)
NONE(GetString, const char **)
NONE(SetString, const char *const *)

FMI2(fmi2_status, GetDirectionalDerivative, fmi2_instance c, const fmi2_reference *unknown, size_t nunknown,
     const fmi2_reference *known, size_t nknown, const double *seed, double *derivative) {
  return (fmi2_status)guest_derivative(GUEST(c), unknown, nunknown, known, nknown, seed, derivative);
}

/* ---- steps ---- */

FMI2(fmi2_status, DoStep, fmi2_instance c, double t, double h, int never_back) {
  (void)never_back;
  return (fmi2_status)guest_step(GUEST(c), t, h);
}

FMI2(fmi2_status, CancelStep, fmi2_instance c) {
  return (fmi2_status)guest_fail(GUEST(c), GUEST_ERROR, "fmi2CancelStep: no step is under way; steps are synchronous");
}

FMI2(fmi2_status, SetRealInputDerivatives, fmi2_instance c, const fmi2_reference *r, size_t n, const int *order,
     const double *value) {
  (void)r, (void)n, (void)order, (void)value;
  return (fmi2_status)guest_lacks(GUEST(c), "fmi2SetRealInputDerivatives");
}

FMI2(fmi2_status, GetRealOutputDerivatives, fmi2_instance c, const fmi2_reference *r, size_t n, const int *order,
     double *value) {
  (void)r, (void)n, (void)order, (void)value;
  return (fmi2_status)guest_lacks(GUEST(c), "fmi2GetRealOutputDerivatives");
}

enum { DO_STEP_STATUS, PENDING_STATUS, LAST_SUCCESSFUL_TIME, TERMINATED };

FMI2(fmi2_status, GetStatus, fmi2_instance c, int kind, fmi2_status *value) {
  (void)c;
  if (kind == DO_STEP_STATUS)
    *value = FMI2_OK; /* none is pending */
  return kind == DO_STEP_STATUS ? FMI2_OK : FMI2_DISCARD;
}

FMI2(fmi2_status, GetRealStatus, fmi2_instance c, int kind, double *value) {
  if (kind == LAST_SUCCESSFUL_TIME)
    *value = GUEST(c)->t;
  return kind == LAST_SUCCESSFUL_TIME ? FMI2_OK : FMI2_DISCARD;
}

FMI2(fmi2_status, GetIntegerStatus, fmi2_instance c, int kind, int *value) {
  (void)c, (void)kind, (void)value;
  return FMI2_DISCARD;
}

FMI2(fmi2_status, GetBooleanStatus, fmi2_instance c, int kind, int *value) {
  if (kind == TERMINATED)
    *value = GUEST(c)->lost;
  return kind == TERMINATED ? FMI2_OK : FMI2_DISCARD;
}

FMI2(fmi2_status, GetStringStatus, fmi2_instance c, int kind, const char **value) {
  (void)c, (void)kind;
  *value = "";
  return FMI2_DISCARD;
}

/* ---- states ---- */

FMI2(fmi2_status, GetFMUstate, fmi2_instance c, fmi2_kept *state) {
  return (fmi2_status)guest_keep(GUEST(c), (guest_kept **)state);
}

FMI2(fmi2_status, SetFMUstate, fmi2_instance c, fmi2_kept state) {
  return (fmi2_status)guest_go_back(GUEST(c), state);
}

FMI2(fmi2_status, FreeFMUstate, fmi2_instance c, fmi2_kept *state) {
  if (state)
    guest_forget(GUEST(c), (guest_kept **)state);
  return FMI2_OK;
}

FMI2(fmi2_status, SerializedFMUstateSize, fmi2_instance c, fmi2_kept state, size_t *size) {
  (void)state, (void)size;
  return (fmi2_status)guest_lacks(GUEST(c), "fmi2SerializedFMUstateSize");
}

FMI2(fmi2_status, SerializeFMUstate, fmi2_instance c, fmi2_kept state, char *bytes, size_t size) {
  (void)state, (void)bytes, (void)size;
  return (fmi2_status)guest_lacks(GUEST(c), "fmi2SerializeFMUstate");
}

FMI2(fmi2_status, DeSerializeFMUstate, fmi2_instance c, const char *bytes, size_t size, fmi2_kept *state) {
  (void)bytes, (void)size, (void)state;
  return (fmi2_status)guest_lacks(GUEST(c), "fmi2DeSerializeFMUstate");
}
