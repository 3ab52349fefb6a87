/* FMI 2.0: see fmu.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fmi/fmi2.h"
#include "protocol/fmi/fmu.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
#define X(result, name, parameters, need) result(*name) parameters;
  FMI2_FUNCTIONS(X)
#undef X
  fmi2_callbacks callbacks; /* must live as long as the instance */
} table2;

static const tdm_fmu_function functions[] = {
#define X(result, name, parameters, need) {"fmi2" #name, offsetof(table2, name), need},
    FMI2_FUNCTIONS(X)
#undef X
        {NULL, 0, 0}};

#define CALL(f, function, ...) \
  (tdm_fmu_enter("fmi2" #function), tdm_fmu_leave((int)((table2 *)(f)->table)->function((f)->instance, __VA_ARGS__)))
#define CALL0(f, function) \
  (tdm_fmu_enter("fmi2" #function), tdm_fmu_leave((int)((table2 *)(f)->table)->function((f)->instance)))

static void logger(void *environment, const char *instance, fmi2_status status, const char *category,
                   const char *message, ...) {
  char text[1024];
  va_list args;
  (void)instance;
  va_start(args, message);
  vsnprintf(text, sizeof text, message ? message : "", args);
  va_end(args);
  tdm_fmu_says(environment, (int)status, category, text);
}

/* The URI of a file by its absolute path: all but unreserved characters (RFC 3986) are percent-encoded. `out` has room
 * for three times the path, and 8 bytes. */
static void write_uri(char *out, const char *path) {
  static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~/";
  out += sprintf(out, "file://");
  for (; *path; path++)
    out += sprintf(out, strchr(plain, *path) ? "%c" : "%%%02X", (unsigned char)*path);
}

static void *instantiate(tdm_fmu *f) {
  char path[TDM_FMI_DIR_MAX + 16], resources[3 * sizeof path + 8];
  table2 *t = f->table;
  t->callbacks =
      (fmi2_callbacks){.logger = logger, .allocate = calloc, .release = free, .step_finished = NULL, .environment = f};
  snprintf(path, sizeof path, "%s/resources", f->dir);
  write_uri(resources, path);
  tdm_fmu_enter("fmi2Instantiate");
  void *instance = t->Instantiate("tandem", FMI2_CO_SIMULATION, f->description.token, resources, &t->callbacks,
                                  FMI2_FALSE, FMI2_FALSE);
  tdm_fmu_leave(0);
  return instance;
}

static int enter(tdm_fmu *f, const tdm_fmu_experiment *e) {
  const int status = CALL(f, SetupExperiment, e->tolerance > 0, e->tolerance, e->start, FMI2_TRUE, e->stop);
  return status > FMI2_WARNING ? status : CALL0(f, EnterInitializationMode);
}

static int leave(tdm_fmu *f) {
  return CALL0(f, ExitInitializationMode);
}

static int get(tdm_fmu *f, const uint32_t *reference, int n, double *value, int nvalue) {
  (void)nvalue; /* variables are scalars */
  return CALL(f, GetReal, reference, (size_t)n, value);
}

static int set(tdm_fmu *f, const uint32_t *reference, int n, const double *value, int nvalue) {
  (void)nvalue;
  return CALL(f, SetReal, reference, (size_t)n, value);
}

static int set_integers(tdm_fmu *f, tdm_fmi_type type, uint32_t reference, const long *value, int nvalue) {
  const int whole = (int)value[0];
  (void)nvalue;
  return type == TDM_FMI_BOOLEAN ? CALL(f, SetBoolean, &reference, 1, &whole)
                                 : CALL(f, SetInteger, &reference, 1, &whole);
}

static int set_text(tdm_fmu *f, uint32_t reference, const char *text) {
  return CALL(f, SetString, &reference, 1, &text);
}

static int step(tdm_fmu *f, double t, double h, bool never_back) {
  return CALL(f, DoStep, t, h, never_back);
}

static int keep(tdm_fmu *f, void **state) {
  return CALL(f, GetFMUstate, state);
}

static int go_back(tdm_fmu *f, void *state) {
  return CALL(f, SetFMUstate, state);
}

static int forget(tdm_fmu *f, void **state) {
  return CALL(f, FreeFMUstate, state);
}

static int derivative(tdm_fmu *f, const uint32_t *unknown, int nunknown, const uint32_t *known, int nknown,
                      const double *seed, int nseed, double *out, int nderivative) {
  (void)nseed;
  (void)nderivative;
  return CALL(f, GetDirectionalDerivative, unknown, (size_t)nunknown, known, (size_t)nknown, seed, out);
}

static int terminate(tdm_fmu *f) {
  return CALL0(f, Terminate);
}

static void release(tdm_fmu *f) {
  tdm_fmu_enter("fmi2FreeInstance");
  ((table2 *)f->table)->FreeInstance(f->instance);
  tdm_fmu_leave(0);
}

const tdm_fmu_version tdm_fmu_version2 = {
    .function = functions,
    .table_size = sizeof(table2),
    .platform = sizeof(void *) == 8 ? "linux64" : "linux32",
    .make = "fmi2Instantiate",
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
