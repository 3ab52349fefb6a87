/* A co-simulation FMU, FMI 2.0 or 3.0: unpacked, loaded into this process, instantiated and stepped.
 *
 *   tdm_fmu_open(&fmu, file, err);           unpack, read the description, load the binary
 *   tdm_fmu_instantiate(fmu, err);           then tdm_fmu_set_start for parameters and start values
 *   tdm_fmu_initialize(fmu, &experiment, err);
 *   ... tdm_fmu_set, tdm_fmu_step, tdm_fmu_get, tdm_fmu_keep, tdm_fmu_go_back ...
 *   tdm_fmu_end(fmu);                        may be instantiated again
 *   tdm_fmu_close(&fmu);
 *
 * A call that returns discard, error or fatal is an error that names the file, the call, the time, and what the FMU has
 * logged last. After "error" an instance is freed only, after "fatal" it is left alone, as the standard has it.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_FMI_FMU_H
#define TDM_FMI_FMU_H

#include "protocol/fmi/archive.h"
#include "protocol/fmi/description.h"

#include <jansson.h>
#include <stddef.h>

/* What is fixed of a run. */
typedef struct {
  double start, stop; /* [s] */
  double tolerance;   /* relative, of the FMU's own integrator; 0: its own choice */
} tdm_fmu_experiment;

struct tdm_fmu_version;

/* An open FMU. Fields are to be read only. */
typedef struct {
  const char *file;                      /* as it was given, borrowed */
  char dir[TDM_FMI_DIR_MAX];             /* where it is unpacked */
  tdm_fmi_description description;       /* what it says of itself */
  void *library;                         /* of dlopen */
  const struct tdm_fmu_version *version; /* of the standard */
  void *table;                           /* its functions (fmu2.c, fmu3.c) */
  void *instance;                        /* NULL: none */
  bool running;                          /* initialized, so to be terminated */
  int worst;                             /* status that a call has returned: 2 discard, 3 error, 4 fatal */
  char said[512];                        /* last message with which it complained, "": none */
  double t;                              /* time that it is at, for messages [s] */
} tdm_fmu;

/* The call that an FMU is in now ("fmi2DoStep"), NULL: none; and since when (tdm_clock). For signal handlers. */
extern const char *volatile tdm_fmu_calling;
extern volatile double tdm_fmu_called_at;

/* Open a file; *fmu is set also after an error, and to be closed. */
tdm_status tdm_fmu_open(tdm_fmu **fmu, const char *file, tdm_error *err);
void tdm_fmu_close(tdm_fmu **fmu);

/* Make the instance. */
tdm_status tdm_fmu_instantiate(tdm_fmu *fmu, tdm_error *err);

/* Set a parameter or start value before initialization: a number, true, false or text, as its type is; of an array, a
 * list. An error is at `path` of the scene. */
tdm_status tdm_fmu_set_start(tdm_fmu *fmu, const tdm_fmi_variable *v, json_t *value, const char *path, tdm_error *err);

/* Through initialization, until the first step may come. */
tdm_status tdm_fmu_initialize(tdm_fmu *fmu, const tdm_fmu_experiment *experiment, tdm_error *err);

/* Get or set n variables of type real; `value` has the elements of all of them, one variable behind the other. */
tdm_status tdm_fmu_get(tdm_fmu *fmu, const uint32_t *reference, int n, double *value, int nvalue, tdm_error *err);
tdm_status tdm_fmu_set(tdm_fmu *fmu, const uint32_t *reference, int n, const double *value, int nvalue, tdm_error *err);

/* Step from t by h [s]; never_back: no state from before t will be brought back. */
tdm_status tdm_fmu_step(tdm_fmu *fmu, double t, double h, bool never_back, tdm_error *err);

/* Keep the state in *state, which is NULL or one that may be overwritten; bring it back; free it. For FMUs whose
 * description says keeps_states. */
tdm_status tdm_fmu_keep(tdm_fmu *fmu, void **state, tdm_error *err);
tdm_status tdm_fmu_go_back(tdm_fmu *fmu, void *state, tdm_error *err);
void tdm_fmu_forget(tdm_fmu *fmu, void **state);

/* Derivatives of unknown variables along a change of known ones (seed: their elements). For FMUs whose description says
 * gives_derivatives. */
tdm_status tdm_fmu_derivative(tdm_fmu *fmu, const uint32_t *unknown, int nunknown, const uint32_t *known, int nknown,
                              const double *seed, int nseed, double *derivative, int nderivative, tdm_error *err);

/* Terminate and free the instance, if there is one. */
void tdm_fmu_end(tdm_fmu *fmu);

/* ---- for fmu2.c and fmu3.c ---- */

/* A function of the standard: where its pointer is in the table, and when an FMU must have it. */
typedef struct {
  const char *name; /* "fmi2DoStep" */
  size_t at;        /* offset in the table [bytes] */
  int need;         /* 1 always, 2 to keep states, 3 to give derivatives */
} tdm_fmu_function;

/* A version of the standard; its operations are those above, each returning the standard's status. */
typedef struct tdm_fmu_version {
  const tdm_fmu_function *function; /* ends with a NULL name */
  size_t table_size;                /* [bytes] */
  const char *platform;             /* folder of this platform's binary, below "binaries" */
  const char *make;                 /* name of the function that instantiates */
  void *(*instantiate)(tdm_fmu *fmu);
  int (*enter)(tdm_fmu *fmu, const tdm_fmu_experiment *experiment);
  int (*leave)(tdm_fmu *fmu);
  int (*get)(tdm_fmu *fmu, const uint32_t *reference, int n, double *value, int nvalue);
  int (*set)(tdm_fmu *fmu, const uint32_t *reference, int n, const double *value, int nvalue);
  int (*set_integers)(tdm_fmu *fmu, tdm_fmi_type type, uint32_t reference, const long *value, int nvalue);
  int (*set_text)(tdm_fmu *fmu, uint32_t reference, const char *text);
  int (*step)(tdm_fmu *fmu, double t, double h, bool never_back);
  int (*keep)(tdm_fmu *fmu, void **state);
  int (*go_back)(tdm_fmu *fmu, void *state);
  int (*forget)(tdm_fmu *fmu, void **state);
  int (*derivative)(tdm_fmu *fmu, const uint32_t *unknown, int nunknown, const uint32_t *known, int nknown,
                    const double *seed, int nseed, double *derivative, int nderivative);
  int (*terminate)(tdm_fmu *fmu);
  void (*release)(tdm_fmu *fmu);
} tdm_fmu_version;

extern const tdm_fmu_version tdm_fmu_version2, tdm_fmu_version3;

/* Around a call into the FMU, whose name it takes. */
void tdm_fmu_enter(const char *call);
int tdm_fmu_leave(int status);

/* What an FMU says by its logger: kept for messages where it complains (status 2 and above), and logged. */
void tdm_fmu_says(tdm_fmu *fmu, int status, const char *category, const char *message);

#endif
