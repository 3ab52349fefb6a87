/* What tandem uses of the C interface of FMI 2.0 for co-simulation (Functional Mock-up Interface for Model Exchange and
 * Co-Simulation, version 2.0.4), declared from the standard's text. Names of functions are found at run time, with the
 * prefix "fmi2". */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_FMI_FMI2_H
#define TDM_FMI_FMI2_H

#include <stddef.h>

/* What became of a call. */
typedef enum { FMI2_OK, FMI2_WARNING, FMI2_DISCARD, FMI2_ERROR, FMI2_FATAL, FMI2_PENDING } fmi2_status;

enum { FMI2_CO_SIMULATION = 1 };         /* kind of instance */
enum { FMI2_FALSE = 0, FMI2_TRUE = 1 };  /* of the standard's own boolean, an int */
typedef void *fmi2_instance, *fmi2_kept; /* an instance; a state of one */
typedef unsigned int fmi2_reference;     /* names a variable */

/* What an FMU calls; it must live as long as the instance. */
typedef struct {
  void (*logger)(void *environment, const char *instance, fmi2_status status, const char *category, const char *message,
                 ...);
  void *(*allocate)(size_t count, size_t size);
  void (*release)(void *memory);
  void (*step_finished)(void *environment, fmi2_status status);
  void *environment; /* handed to the logger */
} fmi2_callbacks;

/* One row a function: result, name behind "fmi2", parameters, whether an FMU must have it (1), or only with the
 * capabilities to keep states (2) or to give derivatives (3). */
#define FMI2_FUNCTIONS(X)                                                                                         \
  X(fmi2_instance, Instantiate,                                                                                   \
    (const char *name, int kind, const char *guid, const char *resources, const fmi2_callbacks *callbacks,        \
     int visible, int logging),                                                                                   \
    1)                                                                                                            \
  X(void, FreeInstance, (fmi2_instance c), 1)                                                                     \
  X(fmi2_status, SetupExperiment,                                                                                 \
    (fmi2_instance c, int has_tolerance, double tolerance, double start, int has_stop, double stop), 1)           \
  X(fmi2_status, EnterInitializationMode, (fmi2_instance c), 1)                                                   \
  X(fmi2_status, ExitInitializationMode, (fmi2_instance c), 1)                                                    \
  X(fmi2_status, Terminate, (fmi2_instance c), 1)                                                                 \
  X(fmi2_status, GetReal, (fmi2_instance c, const fmi2_reference *r, size_t n, double *value), 1)                 \
  X(fmi2_status, SetReal, (fmi2_instance c, const fmi2_reference *r, size_t n, const double *value), 1)           \
  X(fmi2_status, SetInteger, (fmi2_instance c, const fmi2_reference *r, size_t n, const int *value), 1)           \
  X(fmi2_status, SetBoolean, (fmi2_instance c, const fmi2_reference *r, size_t n, const int *value), 1)           \
  X(fmi2_status, SetString, (fmi2_instance c, const fmi2_reference *r, size_t n, const char *const *value), 1)    \
  X(fmi2_status, DoStep, (fmi2_instance c, double t, double h, int never_back), 1)                                \
  X(fmi2_status, GetFMUstate, (fmi2_instance c, fmi2_kept * state), 2)                                            \
  X(fmi2_status, SetFMUstate, (fmi2_instance c, fmi2_kept state), 2)                                              \
  X(fmi2_status, FreeFMUstate, (fmi2_instance c, fmi2_kept * state), 2)                                           \
  X(fmi2_status, GetDirectionalDerivative,                                                                        \
    (fmi2_instance c, const fmi2_reference *unknown, size_t nunknown, const fmi2_reference *known, size_t nknown, \
     const double *seed, double *derivative),                                                                     \
    3)

#endif
