/* FMI 3.0: see fmu.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fmi/fmi3.h"
#include "protocol/fmi/fmu.h"

#include <stdio.h>
#include <stdlib.h>

typedef struct {
#define X(result, name, parameters, need) result(*name) parameters;
  FMI3_FUNCTIONS(X)
#undef X
} table3;

static const tdm_fmu_function functions[] = {
#define X(result, name, parameters, need) {"fmi3" #name, offsetof(table3, name), need},
    FMI3_FUNCTIONS(X)
#undef X
        {NULL, 0, 0}};

#define CALL(f, function, ...) \
  (tdm_fmu_enter("fmi3" #function), tdm_fmu_leave((int)((table3 *)(f)->table)->function((f)->instance, __VA_ARGS__)))
#define CALL0(f, function) \
  (tdm_fmu_enter("fmi3" #function), tdm_fmu_leave((int)((table3 *)(f)->table)->function((f)->instance)))

static void logger(void *environment, fmi3_status status, const char *category, const char *message) {
  tdm_fmu_says(environment, (int)status, category, message);
}

static void *instantiate(tdm_fmu *f) {
  char resources[TDM_FMI_DIR_MAX + 32];
  snprintf(resources, sizeof resources, "%s/resources/", f->dir); /* a path that ends with its separator */
  tdm_fmu_enter("fmi3InstantiateCoSimulation");
  void *instance = ((table3 *)f->table)
                       ->InstantiateCoSimulation("tandem", f->description.token, resources, false, false, false, false,
                                                 NULL, 0, f, logger, NULL);
  tdm_fmu_leave(0);
  return instance;
}

static int enter(tdm_fmu *f, const tdm_fmu_experiment *e) {
  return CALL(f, EnterInitializationMode, e->tolerance > 0, e->tolerance, e->start, true, e->stop);
}

static int leave(tdm_fmu *f) {
  return CALL0(f, ExitInitializationMode);
}

static int get(tdm_fmu *f, const uint32_t *reference, int n, double *value, int nvalue) {
  return CALL(f, GetFloat64, reference, (size_t)n, value, (size_t)nvalue);
}

static int set(tdm_fmu *f, const uint32_t *reference, int n, const double *value, int nvalue) {
  return CALL(f, SetFloat64, reference, (size_t)n, value, (size_t)nvalue);
}

static int set_booleans(tdm_fmu *f, uint32_t reference, const long *value, int nvalue) {
  bool *copy = malloc((size_t)nvalue * sizeof *copy);
  for (int i = 0; copy && i < nvalue; i++)
    copy[i] = value[i] != 0;
  const int status = copy ? CALL(f, SetBoolean, &reference, 1, copy, (size_t)nvalue) : FMI3_ERROR;
  free(copy);
  return status;
}

static int set_integers(tdm_fmu *f, tdm_fmi_type type, uint32_t reference, const long *value, int nvalue) {
  if (type == TDM_FMI_BOOLEAN)
    return set_booleans(f, reference, value, nvalue);
  int64_t *wide = malloc((size_t)nvalue * sizeof *wide);
  int32_t *copy = malloc((size_t)nvalue * sizeof *copy);
  for (int i = 0; wide && copy && i < nvalue; i++) {
    wide[i] = value[i];
    copy[i] = (int32_t)value[i];
  }
  const int status = !wide || !copy                ? FMI3_ERROR
                     : type == TDM_FMI_ENUMERATION ? CALL(f, SetInt64, &reference, 1, wide, (size_t)nvalue)
                                                   : CALL(f, SetInt32, &reference, 1, copy, (size_t)nvalue);
  free(wide);
  free(copy);
  return status;
}

static int set_text(tdm_fmu *f, uint32_t reference, const char *text) {
  return CALL(f, SetString, &reference, 1, &text, 1);
}

static int step(tdm_fmu *f, double t, double h, bool never_back) {
  bool event = false, terminates = false, early = false;
  double reached = t;
  const int status = CALL(f, DoStep, t, h, never_back, &event, &terminates, &early, &reached);
  if (status > FMI3_WARNING || !terminates)
    return status;
  snprintf(f->said, sizeof f->said, "it asks to end the simulation at %.9g s", reached);
  return FMI3_DISCARD;
}

static int keep(tdm_fmu *f, void **state) {
  return CALL(f, GetFMUState, state);
}

static int go_back(tdm_fmu *f, void *state) {
  return CALL(f, SetFMUState, state);
}

static int forget(tdm_fmu *f, void **state) {
  return CALL(f, FreeFMUState, state);
}

static int derivative(tdm_fmu *f, const uint32_t *unknown, int nunknown, const uint32_t *known, int nknown,
                      const double *seed, int nseed, double *out, int nderivative) {
  return CALL(f, GetDirectionalDerivative, unknown, (size_t)nunknown, known, (size_t)nknown, seed, (size_t)nseed, out,
              (size_t)nderivative);
}

static int terminate(tdm_fmu *f) {
  return CALL0(f, Terminate);
}

static void release(tdm_fmu *f) {
  tdm_fmu_enter("fmi3FreeInstance");
  ((table3 *)f->table)->FreeInstance(f->instance);
  tdm_fmu_leave(0);
}

#if defined __aarch64__
#define MACHINE "aarch64"
#elif defined __x86_64__
#define MACHINE "x86_64"
#else
#define MACHINE "x86"
#endif

const tdm_fmu_version tdm_fmu_version3 = {
    .function = functions,
    .table_size = sizeof(table3),
    .platform = MACHINE "-linux",
    .make = "fmi3InstantiateCoSimulation",
    .instantiate = instantiate,
    .enter = enter,
    .leave = leave,
    .get = get,
    .set = set,
    .set_integers = set_integers,
    .set_text = set_text,
    .step = step,
    .keep = keep,
    .go_back = go_back,
    .forget = forget,
    .derivative = derivative,
    .terminate = terminate,
    .release = release,
};
