/* The models with the interface of FMI 2.0. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fmi/fmi2.h"

#include "model.h"

#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define X(result, name, parameters, need) result fmi2##name parameters;
FMI2_FUNCTIONS(X)
#undef X

typedef struct {
  model m;
  const fmi2_callbacks *callbacks;
  bool running; /* initialized */
} instance;

static fmi2_status tell(const instance *i, fmi2_status status, const char *message) {
  i->callbacks->logger(i->callbacks->environment, "model", status, "logStatus", "%s", message);
  return status;
}

fmi2_instance fmi2Instantiate(const char *name, int kind, const char *guid, const char *resources,
                              const fmi2_callbacks *callbacks, int visible, int logging) {
  instance *i = callbacks->allocate(1, sizeof *i);
  (void)visible;
  (void)logging;
  i->callbacks = callbacks;
  if (name && kind == FMI2_CO_SIMULATION && strncmp(resources, "file:///", 8) == 0 && !strchr(resources, ' ') &&
      model_make(&i->m, guid))
    return i;
  tell(i, FMI2_ERROR, "this GUID is not mine");
  callbacks->release(i);
  return NULL;
}

void fmi2FreeInstance(fmi2_instance c) {
  ((instance *)c)->callbacks->release(c);
}

fmi2_status fmi2SetupExperiment(fmi2_instance c, int has_tolerance, double tolerance, double start, int has_stop,
                                double stop) {
  (void)has_tolerance;
  (void)tolerance;
  (void)has_stop;
  (void)stop;
  ((instance *)c)->m.t = start;
  return FMI2_OK;
}

fmi2_status fmi2EnterInitializationMode(fmi2_instance c) {
  return model_fails(&((instance *)c)->m, "never") ? FMI2_ERROR : FMI2_OK;
}

fmi2_status fmi2ExitInitializationMode(fmi2_instance c) {
  model_look(&((instance *)c)->m);
  ((instance *)c)->running = true;
  return FMI2_OK;
}

fmi2_status fmi2Terminate(fmi2_instance c) {
  if (!((instance *)c)->running)
    abort(); /* the standard allows it after initialization only */
  return FMI2_OK;
}

fmi2_status fmi2GetReal(fmi2_instance c, const fmi2_reference *r, size_t n, double *value) {
  for (size_t k = 0; k < n; k++)
    value[k] = ((instance *)c)->m.value[r[k]];
  return FMI2_OK;
}

fmi2_status fmi2SetReal(fmi2_instance c, const fmi2_reference *r, size_t n, const double *value) {
  for (size_t k = 0; k < n; k++)
    ((instance *)c)->m.value[r[k]] = value[k];
  return FMI2_OK;
}

fmi2_status fmi2SetInteger(fmi2_instance c, const fmi2_reference *r, size_t n, const int *value) {
  for (size_t k = 0; k < n; k++)
    if (r[k] == V_COUNT)
      ((instance *)c)->m.count = value[k];
  return FMI2_OK;
}

fmi2_status fmi2SetBoolean(fmi2_instance c, const fmi2_reference *r, size_t n, const int *value) {
  for (size_t k = 0; k < n; k++)
    if (r[k] == V_SWITCH)
      ((instance *)c)->m.on = value[k];
  return FMI2_OK;
}

fmi2_status fmi2SetString(fmi2_instance c, const fmi2_reference *r, size_t n, const char *const *value) {
  if (n == 1 && r[0] == V_TEXT && strcmp(value[0], "wrong") == 0)
    return tell(c, FMI2_ERROR, "no such text");
  return FMI2_OK;
}

fmi2_status fmi2DoStep(fmi2_instance c, double t, double h, int never_back) {
  instance *i = c;
  (void)never_back;
  model_fails(&i->m, "hang");
  model_fails(&i->m, "crash");
  model_fails(&i->m, "overflow");
  model_fails(&i->m, "exit");
  if (model_fails(&i->m, "pending"))
    return FMI2_PENDING;
  if (model_fails(&i->m, "status7"))
    return (fmi2_status)7;
  if (model_fails(&i->m, "discard"))
    return tell(i, FMI2_DISCARD, "the valve sticks");
  if (model_fails(&i->m, "error"))
    return tell(i, FMI2_ERROR, "the oil boils");
  if (model_fails(&i->m, "fatal"))
    return tell(i, FMI2_FATAL, "the pump burst");
  if (t - i->m.t > 1e-9 || i->m.t - t > 1e-9)
    return tell(i, FMI2_ERROR, "this step does not begin where the last one ended");
  model_step(&i->m, h);
  if (model_fails(&i->m, "nan"))
    i->m.value[V_X] = 0.0 / i->m.value[V_Y];
  return FMI2_OK;
}

fmi2_status fmi2GetFMUstate(fmi2_instance c, fmi2_kept *state) {
  if (!*state)
    *state = malloc(sizeof(model));
  memcpy(*state, &((instance *)c)->m, sizeof(model));
  return FMI2_OK;
}

fmi2_status fmi2SetFMUstate(fmi2_instance c, fmi2_kept state) {
  memcpy(&((instance *)c)->m, state, sizeof(model));
  return FMI2_OK;
}

fmi2_status fmi2FreeFMUstate(fmi2_instance c, fmi2_kept *state) {
  (void)c;
  free(*state);
  *state = NULL;
  return FMI2_OK;
}

fmi2_status fmi2GetDirectionalDerivative(fmi2_instance c, const fmi2_reference *unknown, size_t nunknown,
                                         const fmi2_reference *known, size_t nknown, const double *seed,
                                         double *derivative) {
  for (size_t k = 0; k < nunknown; k++) {
    derivative[k] = 0;
    for (size_t j = 0; j < nknown; j++)
      derivative[k] += seed[j] * model_derivative(&((instance *)c)->m, unknown[k], known[j]);
  }
  return FMI2_OK;
}
