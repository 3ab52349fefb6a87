/* What tandem uses of the C interface of FMI 3.0 for co-simulation (Functional Mock-up Interface Specification, version
 * 3.0.2), declared from the standard's text. Names of functions are found at run time, with the prefix "fmi3". */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_FMI_FMI3_H
#define TDM_FMI_FMI3_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* What became of a call. */
typedef enum { FMI3_OK, FMI3_WARNING, FMI3_DISCARD, FMI3_ERROR, FMI3_FATAL } fmi3_status;

typedef void *fmi3_instance, *fmi3_kept; /* an instance; a state of one */
typedef uint32_t fmi3_reference;         /* names a variable */

/* What an FMU calls to tell something. */
typedef void fmi3_logger(void *environment, fmi3_status status, const char *category, const char *message);

/* What an FMU calls within a step; tandem has none. */
typedef void fmi3_intermediate(void *environment, double time, bool sets, bool gets, bool finished, bool may_return,
                               bool *returns, double *return_time);

/* One row a function: result, name behind "fmi3", parameters, whether an FMU must have it (1), or only with the
 * capabilities to keep states (2) or to give derivatives (3). `nvalue` counts the elements of all variables. */
#define FMI3_FUNCTIONS(X)                                                                                              \
  X(fmi3_instance, InstantiateCoSimulation,                                                                            \
    (const char *name, const char *token, const char *resources, bool visible, bool logging, bool events,              \
     bool early_return, const fmi3_reference *required, size_t nrequired, void *environment, fmi3_logger *logger,      \
     fmi3_intermediate *intermediate),                                                                                 \
    1)                                                                                                                 \
  X(void, FreeInstance, (fmi3_instance c), 1)                                                                          \
  X(fmi3_status, EnterInitializationMode,                                                                              \
    (fmi3_instance c, bool has_tolerance, double tolerance, double start, bool has_stop, double stop), 1)              \
  X(fmi3_status, ExitInitializationMode, (fmi3_instance c), 1)                                                         \
  X(fmi3_status, Terminate, (fmi3_instance c), 1)                                                                      \
  X(fmi3_status, GetFloat64, (fmi3_instance c, const fmi3_reference *r, size_t n, double *value, size_t nvalue), 1)    \
  X(fmi3_status, SetFloat64, (fmi3_instance c, const fmi3_reference *r, size_t n, const double *value, size_t nvalue), \
    1)                                                                                                                 \
  X(fmi3_status, SetInt32, (fmi3_instance c, const fmi3_reference *r, size_t n, const int32_t *value, size_t nvalue),  \
    1)                                                                                                                 \
  X(fmi3_status, SetInt64, (fmi3_instance c, const fmi3_reference *r, size_t n, const int64_t *value, size_t nvalue),  \
    1)                                                                                                                 \
  X(fmi3_status, SetBoolean, (fmi3_instance c, const fmi3_reference *r, size_t n, const bool *value, size_t nvalue),   \
    1)                                                                                                                 \
  X(fmi3_status, SetString,                                                                                            \
    (fmi3_instance c, const fmi3_reference *r, size_t n, const char *const *value, size_t nvalue), 1)                  \
  X(fmi3_status, DoStep,                                                                                               \
    (fmi3_instance c, double t, double h, bool never_back, bool *event, bool *terminate, bool *early,                  \
     double *reached),                                                                                                 \
    1)                                                                                                                 \
  X(fmi3_status, GetFMUState, (fmi3_instance c, fmi3_kept * state), 2)                                                 \
  X(fmi3_status, SetFMUState, (fmi3_instance c, fmi3_kept state), 2)                                                   \
  X(fmi3_status, FreeFMUState, (fmi3_instance c, fmi3_kept * state), 2)                                                \
  X(fmi3_status, GetDirectionalDerivative,                                                                             \
    (fmi3_instance c, const fmi3_reference *unknown, size_t nunknown, const fmi3_reference *known, size_t nknown,      \
     const double *seed, size_t nseed, double *derivative, size_t nderivative),                                        \
    3)

#endif
