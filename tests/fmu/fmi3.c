/* The models with the interface of FMI 3.0. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fmi/fmi3.h"

#include "model.h"

#include <stdlib.h>
#include <string.h>

#define X(result, name, parameters, need) result fmi3##name parameters;
FMI3_FUNCTIONS(X)
#undef X

typedef struct {
  model m;
  fmi3_logger *logger;
  void *environment;
  bool running; /* initialized */
} instance;

static fmi3_status tell(const instance *i, fmi3_status status, const char *message) {
  i->logger(i->environment, status, "logStatus", message);
  return status;
}

/* Elements of a variable: how many, and the first; of arrays of three, the third is no value. */
static size_t elements(fmi3_reference r, unsigned at[3]) {
  static const unsigned arrays[3][3] = {{V_FX, V_FY, NVALUE}, {V_X, V_Y, NVALUE}, {V_VX, V_VY, NVALUE}};
  at[0] = r;
  if (r < V_FORCE3)
    return 1;
  memcpy(at, arrays[r - V_FORCE3], 3 * sizeof *at);
  return 3;
}

fmi3_instance fmi3InstantiateCoSimulation(const char *name, const char *token, const char *resources, bool visible,
                                          bool logging, bool events, bool early_return, const fmi3_reference *required,
                                          size_t nrequired, void *environment, fmi3_logger *logger,
                                          fmi3_intermediate *intermediate) {
  instance *i = calloc(1, sizeof *i);
  (void)visible;
  (void)logging;
  (void)required;
  (void)intermediate;
  i->logger = logger;
  i->environment = environment;
  if (name && resources[0] == '/' && resources[strlen(resources) - 1] == '/' && !events && !early_return &&
      nrequired == 0 && model_make(&i->m, token))
    return i;
  tell(i, FMI3_ERROR, "this token is not mine");
  free(i);
  return NULL;
}

void fmi3FreeInstance(fmi3_instance c) {
  free(c);
}

fmi3_status fmi3EnterInitializationMode(fmi3_instance c, bool has_tolerance, double tolerance, double start,
                                        bool has_stop, double stop) {
  (void)has_tolerance;
  (void)tolerance;
  (void)has_stop;
  (void)stop;
  ((instance *)c)->m.t = start;
  return FMI3_OK;
}

fmi3_status fmi3ExitInitializationMode(fmi3_instance c) {
  model_look(&((instance *)c)->m);
  ((instance *)c)->running = true;
  return FMI3_OK;
}

fmi3_status fmi3Terminate(fmi3_instance c) {
  if (!((instance *)c)->running)
    abort(); /* the standard allows it after initialization only */
  return FMI3_OK;
}

fmi3_status fmi3GetFloat64(fmi3_instance c, const fmi3_reference *r, size_t n, double *value, size_t nvalue) {
  size_t next = 0;
  for (size_t k = 0; k < n; k++) {
    unsigned at[3];
    const size_t count = elements(r[k], at);
    for (size_t j = 0; j < count && next < nvalue; j++)
      value[next++] = at[j] < NVALUE ? ((instance *)c)->m.value[at[j]] : 0;
  }
  return next == nvalue ? FMI3_OK : tell(c, FMI3_ERROR, "the number of values is wrong");
}

fmi3_status fmi3SetFloat64(fmi3_instance c, const fmi3_reference *r, size_t n, const double *value, size_t nvalue) {
  size_t next = 0;
  for (size_t k = 0; k < n; k++) {
    unsigned at[3];
    const size_t count = elements(r[k], at);
    for (size_t j = 0; j < count && next < nvalue; j++, next++)
      if (at[j] < NVALUE)
        ((instance *)c)->m.value[at[j]] = value[next];
  }
  return next == nvalue ? FMI3_OK : tell(c, FMI3_ERROR, "the number of values is wrong");
}

fmi3_status fmi3SetInt32(fmi3_instance c, const fmi3_reference *r, size_t n, const int32_t *value, size_t nvalue) {
  if (n == 1 && nvalue == 1 && r[0] == V_COUNT)
    ((instance *)c)->m.count = value[0];
  return FMI3_OK;
}

fmi3_status fmi3SetInt64(fmi3_instance c, const fmi3_reference *r, size_t n, const int64_t *value, size_t nvalue) {
  if (n == 1 && nvalue == 1 && r[0] == V_COUNT)
    ((instance *)c)->m.count = (int)value[0];
  return FMI3_OK;
}

fmi3_status fmi3SetBoolean(fmi3_instance c, const fmi3_reference *r, size_t n, const bool *value, size_t nvalue) {
  if (n == 1 && nvalue == 1 && r[0] == V_SWITCH)
    ((instance *)c)->m.on = value[0];
  return FMI3_OK;
}

fmi3_status fmi3SetString(fmi3_instance c, const fmi3_reference *r, size_t n, const char *const *value, size_t nvalue) {
  if (n == 1 && nvalue == 1 && r[0] == V_TEXT && strcmp(value[0], "wrong") == 0)
    return tell(c, FMI3_ERROR, "no such text");
  return FMI3_OK;
}

fmi3_status fmi3DoStep(fmi3_instance c, double t, double h, bool never_back, bool *event, bool *terminate, bool *early,
                       double *reached) {
  instance *i = c;
  (void)never_back;
  *event = *early = false;
  *terminate = model_fails(&i->m, "ends");
  *reached = t;
  model_fails(&i->m, "hang");
  model_fails(&i->m, "crash");
  if (model_fails(&i->m, "discard"))
    return tell(i, FMI3_DISCARD, "the valve sticks");
  if (model_fails(&i->m, "fatal"))
    return tell(i, FMI3_FATAL, "the pump burst");
  if (t - i->m.t > 1e-9 || i->m.t - t > 1e-9)
    return tell(i, FMI3_ERROR, "this step does not begin where the last one ended");
  model_step(&i->m, h);
  *reached = t + h;
  return FMI3_OK;
}

fmi3_status fmi3GetFMUState(fmi3_instance c, fmi3_kept *state) {
  if (!*state)
    *state = malloc(sizeof(model));
  memcpy(*state, &((instance *)c)->m, sizeof(model));
  return FMI3_OK;
}

fmi3_status fmi3SetFMUState(fmi3_instance c, fmi3_kept state) {
  memcpy(&((instance *)c)->m, state, sizeof(model));
  return FMI3_OK;
}

fmi3_status fmi3FreeFMUState(fmi3_instance c, fmi3_kept *state) {
  (void)c;
  free(*state);
  *state = NULL;
  return FMI3_OK;
}

fmi3_status fmi3GetDirectionalDerivative(fmi3_instance c, const fmi3_reference *unknown, size_t nunknown,
                                         const fmi3_reference *known, size_t nknown, const double *seed, size_t nseed,
                                         double *derivative, size_t nderivative) {
  size_t next = 0;
  for (size_t k = 0; k < nunknown; k++) {
    unsigned of[3], by[3];
    const size_t count = elements(unknown[k], of);
    for (size_t j = 0; j < count && next < nderivative; j++, next++) {
      derivative[next] = 0;
      for (size_t l = 0, s = 0; l < nknown; l++) {
        const size_t width = elements(known[l], by);
        for (size_t e = 0; e < width && s < nseed; e++, s++)
          if (of[j] < NVALUE && by[e] < NVALUE)
            derivative[next] += seed[s] * model_derivative(&((instance *)c)->m, of[j], by[e]);
      }
    }
  }
  return next == nderivative ? FMI3_OK : tell(c, FMI3_ERROR, "the number of derivatives is wrong");
}
