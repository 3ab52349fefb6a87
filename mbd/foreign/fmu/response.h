/* How the coupled bodies of an FMU answer to loads: accelerations and mobility, at the time that it has reached.
 *
 * With states that can be brought back (H a short step, D the change of all twists under unit inputs u held over H and
 * over 2 H, P the inputs by loads):
 *   a = (4 V(H) - 3 V(0) - V(2H))/(2H),   Y = (2 D(H)/H - D(2H)/(2H)) P
 * With directional derivatives and accelerations as outputs: Y = (da/du) P. Both are symmetric but for the FMU's own
 * error; what is given away is the symmetric part without negative eigenvalues.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_FOREIGN_FMU_RESPONSE_H
#define MBD_FOREIGN_FMU_RESPONSE_H

#include "mbd/foreign/fmu/mapping.h"

#include <gsl/gsl_eigen.h>

typedef struct {
  const fmu_mapping *m; /* borrowed */
  double h;             /* step of trials [s] */
  bool by_derivatives;  /* Y by the FMU's directional derivatives */
  void *kept;           /* the FMU's state before a trial */
  double *inputs;       /* (ninput) held in trials */
  double *outputs;      /* (noutput) */
  tdm_state *state[2];  /* (nbody) in a trial, after 1 and 2 steps */
  double *P;            /* (ninput x 6k) inputs by loads */
  double *D;            /* (6k x ninput) accelerations by inputs */
  double *base;         /* (2 x 6k) twists of the trial without a further load, after 1 and 2 steps */
  double *Y;            /* (6k x 6k) */
  gsl_eigen_symmv_workspace *eigen;
  gsl_matrix *matrix, *vectors; /* (6k x 6k) */
  gsl_vector *values;           /* (6k) */
} fmu_response;

/* Room for all; `h` [s]. The caller frees also after an error. */
tdm_status fmu_response_init(fmu_response *r, const fmu_mapping *m, double h, tdm_error *err);
void fmu_response_free(fmu_response *r);

/* Accelerations (nbody x 6) under a load (nbody) that is held from time t on, by a trial of two steps that is taken
 * back; of a FMU that keeps states, or one that is thrown away (`last`). */
tdm_status fmu_response_accelerations(fmu_response *r, double t, const tdm_state *state, const tdm_wrench *load,
                                      bool last, double *out, tdm_error *err);

/* The mobility r->Y at time t, by trials around this load or by derivatives. An error where no mechanism answers so:
 * wrong points, axes or units of the mapping. */
tdm_status fmu_response_mobility(fmu_response *r, double t, const tdm_state *state, const tdm_wrench *load,
                                 tdm_error *err);

#endif
