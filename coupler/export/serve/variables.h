/* The variables of an exported FMU, in their order: inputs body by body, outputs body by body, then the solvers'
 * channels. World frame, SI units, points are centres of mass (docs/fmu.md).
 *
 *   side   inputs of a body                                        outputs of a body
 *   dem    position, orientation, velocity, angular_velocity,      force, moment
 *          acceleration, angular_acceleration
 *   mbd    force, moment                                           position ... angular_acceleration, as far as
 *                                                                  the solver tells accelerations
 *   both   force, moment                                           position ... angular_acceleration, force, moment
 *                                                                  (of the particles: particles.force ...)
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_EXPORT_SERVE_VARIABLES_H
#define CPL_EXPORT_SERVE_VARIABLES_H

#include "coupler/session/session.h"

/* What is packed: the particles alone, the bodies alone, or the whole co-simulation. */
typedef enum { CPL_EXPORT_DEM, CPL_EXPORT_MBD, CPL_EXPORT_BOTH, CPL_NEXPORT } cpl_export_side;
extern const char *const cpl_export_sides[CPL_NEXPORT]; /* "dem", "mbd", "both" */

/* Whether a role's solver is part of it. */
static inline bool cpl_export_has(cpl_export_side side, cpl_role role) {
  return side == CPL_EXPORT_BOTH || (side == CPL_EXPORT_MBD) == (role == CPL_MBD);
}

enum {
  CPL_MOTION = TDM_STATE_DOUBLES + 6, /* numbers of a body's motion: its state and its accelerations */
  CPL_LOAD = TDM_WRENCH_DOUBLES
};

/* Numbers of variables. */
typedef struct {
  int nbody;
  int input, output;       /* of a body */
  int nchannel[CPL_NROLE]; /* of the solvers that are part of it */
} cpl_export_layout;

cpl_export_layout cpl_export_layout_of(cpl_export_side side, const cpl_session *session);
static inline int cpl_export_ninput(const cpl_export_layout *l) {
  return l->nbody * l->input;
}
static inline int cpl_export_noutput(const cpl_export_layout *l) {
  return l->nbody * l->output + l->nchannel[CPL_MBD] + l->nchannel[CPL_DEM];
}

/* A variable of type real. */
typedef struct {
  char name[224]; /* "box.position.x", "dem.particles.count" */
  char unit[16];  /* "": none */
  char description[160];
  bool input;
  double start;      /* of an input */
  int derivative_of; /* of an output: number of the variable whose derivative it is, from 0; -1: of none */
  int follows;       /* of an output: it follows so many inputs at once, the first being 0; 0: none */
} cpl_export_variable;

/* All of them, inputs first; the caller frees the list. `session` is READY for the side. NULL: an error, also when two
 * have the same name. */
cpl_export_variable *cpl_export_variables(cpl_export_side side, const cpl_session *session, int *n, tdm_error *err);

/* The start values of the inputs. */
void cpl_export_starts(cpl_export_side side, const cpl_session *session, double *out);

#endif
