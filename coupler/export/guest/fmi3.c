/* The functions of FMI 3.0 for co-simulation, by their names in the standard: see guest.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fmi/fmi3.h"
#include "coupler/export/guest/guest.h"

#include <stdlib.h>

#define FMI3(result, name, ...)   \
  result fmi3##name(__VA_ARGS__); \
  __attribute__((visibility("default"))) result fmi3##name(__VA_ARGS__)

typedef struct {
  guest *g;
  fmi3_logger *logger;
  void *environment;
} instance;

#define GUEST(c) (((instance *)(c))->g)

static void say(guest *g, guest_status status, const char *text) {
  static const char *const categories[] = {"logEvents", "logStatusWarning", "logStatusDiscard", "logStatusError",
                                           "logStatusFatal"};
  const instance *i = g->owner;
  if (i->logger)
    i->logger(i->environment, (fmi3_status)status, categories[status], text);
}

/* ---- life ---- */

FMI3(const char *, GetVersion, void) {
  return "3.0";
}

FMI3(fmi3_status, SetDebugLogging, fmi3_instance c, bool on, size_t n, const char *const *categories) {
  (void)c, (void)on, (void)n, (void)categories; /* what the solvers remark is told, always */
  return FMI3_OK;
}

FMI3(fmi3_instance, InstantiateCoSimulation, const char *name, const char *token, const char *resources, bool visible,
     bool logging, bool events, bool early_return, const fmi3_reference *required, size_t nrequired, void *environment,
     fmi3_logger *logger, fmi3_intermediate *intermediate) {
  char folder[4096];
  instance *i = calloc(1, sizeof *i);
  (void)name, (void)visible, (void)logging, (void)early_return, (void)required, (void)intermediate;
  if (!i)
    return NULL;
  *i = (instance){.logger = logger, .environment = environment};
  guest teller = {.say = say, .owner = i};
  if (events || nrequired > 0)
    guest_fail(&teller, GUEST_ERROR, "this FMU has no event mode and no intermediate variables");
  else if (guest_path_of(&teller, resources ? resources : "", folder, sizeof folder))
    i->g = guest_make(say, i, token, folder);
  if (i->g)
    return i;
  free(i);
  return NULL;
}

FMI3(void, FreeInstance, fmi3_instance c) {
  instance *i = c;
  if (i)
    guest_free(&i->g);
  free(i);
}

FMI3(fmi3_status, EnterInitializationMode, fmi3_instance c, bool has_tolerance, double tolerance, double start,
     bool has_stop, double stop) {
  (void)has_tolerance, (void)tolerance; /* the scene has those of its solvers */
  return (fmi3_status)guest_enter(GUEST(c), start, has_stop, stop);
}

FMI3(fmi3_status, ExitInitializationMode, fmi3_instance c) {
  return (fmi3_status)guest_leave(GUEST(c));
}

FMI3(fmi3_status, Terminate, fmi3_instance c) {
  return (fmi3_status)guest_terminate(GUEST(c));
}

FMI3(fmi3_status, Reset, fmi3_instance c) {
  return (fmi3_status)guest_reset(GUEST(c));
}

/* ---- variables: all are scalars ---- */

static fmi3_status check_count(guest *g, size_t n, size_t nvalue) {
  return n == nvalue ? FMI3_OK : (fmi3_status)guest_fail(g, GUEST_ERROR, "%zu values for %zu scalars", nvalue, n);
}

FMI3(fmi3_status, GetFloat64, fmi3_instance c, const fmi3_reference *r, size_t n, double *value, size_t nvalue) {
  const fmi3_status status = check_count(GUEST(c), n, nvalue);
  return status == FMI3_OK ? (fmi3_status)guest_get(GUEST(c), r, n, value) : status;
}

FMI3(fmi3_status, SetFloat64, fmi3_instance c, const fmi3_reference *r, size_t n, const double *value, size_t nvalue) {
  const fmi3_status status = check_count(GUEST(c), n, nvalue);
  return status == FMI3_OK ? (fmi3_status)guest_set(GUEST(c), r, n, value) : status;
}

FMI3(fmi3_status, GetBoolean, fmi3_instance c, const fmi3_reference *r, size_t n, bool *value, size_t nvalue) {
  const fmi3_status status = check_count(GUEST(c), n, nvalue);
  return status == FMI3_OK ? (fmi3_status)guest_get_flag(GUEST(c), r, n, value) : status;
}

FMI3(fmi3_status, SetBoolean, fmi3_instance c, const fmi3_reference *r, size_t n, const bool *value, size_t nvalue) {
  const fmi3_status status = check_count(GUEST(c), n, nvalue);
  return status == FMI3_OK ? (fmi3_status)guest_set_flag(GUEST(c), r, n, value) : status;
}

/* Types of which there are no variables: nothing to do for none. */
#define NONE(name, type)                                                                                   \
  FMI3(fmi3_status, name, fmi3_instance c, const fmi3_reference *r, size_t n, type value, size_t nvalue) { \
    (void)r, (void)value, (void)nvalue;                                                                    \
    return n == 0 ? FMI3_OK : (fmi3_status)guest_lacks(GUEST(c), "fmi3" #name);                            \
  }
#define BOTH(name, type)  \
  NONE(Get##name, type *) \
  NONE(Set##name, const type *)
BOTH(Float32, float)
BOTH(Int8, int8_t)
BOTH(UInt8, uint8_t)
BOTH(Int16, int16_t)
BOTH(UInt16, uint16_t)
BOTH(Int32, int32_t)
BOTH(UInt32, uint32_t)
BOTH(Int64, int64_t)
BOTH(UInt64, uint64_t)
NONE(GetString, const char **)
NONE(SetString, const char *const *)

FMI3(fmi3_status, GetBinary, fmi3_instance c, const fmi3_reference *r, size_t n, size_t *size, const uint8_t **value,
     size_t nvalue) {
  (void)r, (void)size, (void)value, (void)nvalue;
  return n == 0 ? FMI3_OK : (fmi3_status)guest_lacks(GUEST(c), "fmi3GetBinary");
}

FMI3(fmi3_status, SetBinary, fmi3_instance c, const fmi3_reference *r, size_t n, const size_t *size,
     const uint8_t *const *value, size_t nvalue) {
  (void)r, (void)size, (void)value, (void)nvalue;
  return n == 0 ? FMI3_OK : (fmi3_status)guest_lacks(GUEST(c), "fmi3SetBinary");
}

FMI3(fmi3_status, GetDirectionalDerivative, fmi3_instance c, const fmi3_reference *unknown, size_t nunknown,
     const fmi3_reference *known, size_t nknown, const double *seed, size_t nseed, double *derivative,
     size_t nderivative) {
  if (nseed != nknown || nderivative != nunknown)
    return check_count(GUEST(c), nknown + nunknown, nseed + nderivative + 1);
  return (fmi3_status)guest_derivative(GUEST(c), unknown, nunknown, known, nknown, seed, derivative);
}

/* ---- steps ---- */

FMI3(fmi3_status, EnterStepMode, fmi3_instance c) {
  return (fmi3_status)guest_lacks(GUEST(c), "fmi3EnterStepMode");
}

FMI3(fmi3_status, DoStep, fmi3_instance c, double t, double h, bool never_back, bool *event, bool *terminate,
     bool *early, double *reached) {
  (void)never_back;
  const guest_status status = guest_step(GUEST(c), t, h);
  *event = *terminate = *early = false;
  *reached = GUEST(c)->t;
  return (fmi3_status)status;
}

FMI3(fmi3_status, GetOutputDerivatives, fmi3_instance c, const fmi3_reference *r, size_t n, const int32_t *order,
     double *value, size_t nvalue) {
  (void)r, (void)n, (void)order, (void)value, (void)nvalue;
  return (fmi3_status)guest_lacks(GUEST(c), "fmi3GetOutputDerivatives");
}

/* ---- states ---- */

FMI3(fmi3_status, GetFMUState, fmi3_instance c, fmi3_kept *state) {
  return (fmi3_status)guest_keep(GUEST(c), (guest_kept **)state);
}

FMI3(fmi3_status, SetFMUState, fmi3_instance c, fmi3_kept state) {
  return (fmi3_status)guest_go_back(GUEST(c), state);
}

FMI3(fmi3_status, FreeFMUState, fmi3_instance c, fmi3_kept *state) {
  if (state)
    guest_forget(GUEST(c), (guest_kept **)state);
  return FMI3_OK;
}

/* ---- what no tandem FMU has: other kinds of instances, other modes, clocks ---- */

/* The rest of the standard's functions. Whoever calls one has not read the description; parameters are not looked at,
 * which C's calling conventions on Linux allow. */
#define LACKS(name)                                          \
  FMI3(fmi3_status, name, fmi3_instance c) {                 \
    return (fmi3_status)guest_lacks(GUEST(c), "fmi3" #name); \
  }
LACKS(SerializedFMUStateSize)
LACKS(SerializeFMUState)
LACKS(DeserializeFMUState)
LACKS(GetAdjointDerivative)
LACKS(GetNumberOfVariableDependencies)
LACKS(GetVariableDependencies)
LACKS(EnterConfigurationMode)
LACKS(ExitConfigurationMode)
LACKS(EnterEventMode)
LACKS(UpdateDiscreteStates)
LACKS(EvaluateDiscreteStates)
LACKS(GetClock)
LACKS(SetClock)
LACKS(GetIntervalDecimal)
LACKS(GetIntervalFraction)
LACKS(GetShiftDecimal)
LACKS(GetShiftFraction)
LACKS(SetIntervalDecimal)
LACKS(SetIntervalFraction)
LACKS(SetShiftDecimal)
LACKS(SetShiftFraction)
LACKS(EnterContinuousTimeMode)
LACKS(CompletedIntegratorStep)
LACKS(SetTime)
LACKS(SetContinuousStates)
LACKS(GetContinuousStates)
LACKS(GetContinuousStateDerivatives)
LACKS(GetNominalsOfContinuousStates)
LACKS(GetEventIndicators)
LACKS(GetNumberOfEventIndicators)
LACKS(GetNumberOfContinuousStates)
LACKS(ActivateModelPartition)

FMI3(fmi3_instance, InstantiateModelExchange, void) {
  return NULL;
}

FMI3(fmi3_instance, InstantiateScheduledExecution, void) {
  return NULL;
}
