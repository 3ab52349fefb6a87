/* What an FMU's variables are of the coupled bodies: the solver's section of the scene.
 *
 * In the FMU's frame F, whose origin o and axes (quaternion q_F) in the world the scene gives, and in its units,
 * outputs are the place of a point P of the body, the body's orientation in F, and their rates; inputs are the
 * components of the load. With r from the centre of mass C to P, body axes, R the body's orientation in the world:
 *
 *   x_C = x_P - R r
 *   v_C = v_P - w x R r
 *   a_C = a_P - alpha x R r - w x (w x R r)
 *   M_P = M_C - R r x F
 *   M_o = M_C + (x_C - o) x F
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_FOREIGN_FMU_MAPPING_H
#define MBD_FOREIGN_FMU_MAPPING_H

#include "protocol/fmi/fmu.h"
#include "protocol/scene/scene.h"
#include "protocol/wire/participant.h"

/* Variables whose values go together, each as often as it is named first. */
typedef struct {
  int nvariable, nvalue;
  const tdm_fmi_variable **variable; /* (nvariable) borrowed */
  uint32_t *reference;               /* (nvariable) */
  int *first;                        /* (nvariable) number of its first value */
} fmu_list;

/* One number of a body's: a value of a list, or its negative, or a constant. */
typedef struct {
  int at;       /* in the list; -1: a constant */
  double value; /* the constant; else 1 or -1, which the variable's value is multiplied with */
} fmu_slot;

typedef enum { FMU_FIXED, FMU_EULER313, FMU_QUATERNION, FMU_MATRIX, FMU_ANGLE } fmu_turn; /* kind of orientation */
typedef enum { FMU_ABOUT_CENTRE, FMU_ABOUT_POINT, FMU_ABOUT_ORIGIN } fmu_about;           /* of the moment */

/* A coupled body. */
typedef struct {
  const char *name;
  double mass;      /* [kg] */
  tdm_mat3 inertia; /* about the centre of mass, body axes [kg m2] */
  tdm_vec3 origin;  /* of F, world [m] */
  tdm_quat frame;   /* axes of F in the world */
  tdm_vec3 point;   /* r: P from the centre of mass, body axes [m] */
  /* inputs */
  fmu_slot load[6];  /* force, moment */
  bool load_in_body; /* their axes: the body's, else those of F */
  fmu_about about;
  /* outputs */
  fmu_slot position[3], velocity[3], acceleration[3]; /* of P */
  fmu_turn turn;
  fmu_slot orientation[9];              /* as many as `turn` has */
  tdm_vec3 axis;                        /* FMU_ANGLE: unit, F */
  fmu_slot angular[3], angular_rate[3]; /* angular velocity, angular acceleration */
  bool angular_in_body;                 /* their axes: the body's, else those of F */
} fmu_body;

/* A further output. */
typedef struct {
  tdm_channel channel;
  int at; /* in the list of outputs */
} fmu_channel;

typedef struct {
  tdm_fmu *fmu;         /* borrowed */
  double step;          /* longest communication step [s] */
  double tolerance;     /* of the FMU's integrator; 0: its own */
  double length, force; /* metres and newtons a unit of the FMU */
  double angle;         /* radians a unit */
  json_t *parameters;   /* borrowed: variables and their values */
  int nbody;
  fmu_body *body; /* (nbody) in the order of ASSIGN */
  fmu_list inputs, outputs;
  bool accelerates; /* all accelerations that may be other than zero are outputs */
  int nchannel;
  fmu_channel *channel; /* (nchannel) */
} fmu_mapping;

/* Read the section; the caller frees also after an error. */
tdm_status fmu_mapping_read(fmu_mapping *m, tdm_fmu *fmu, const tdm_assignment *assignment, tdm_error *err);
void fmu_mapping_free(fmu_mapping *m);

/* Set the parameters and start values that the section gives; before initialization. */
tdm_status fmu_mapping_start(const fmu_mapping *m, tdm_error *err);

/* Values of the inputs (inputs.nvalue) under loads (nbody) on bodies in these states (nbody). */
void fmu_mapping_inputs(const fmu_mapping *m, const tdm_state *state, const tdm_wrench *load, double *value);

/* States of the bodies (nbody) by values of the outputs. */
void fmu_mapping_states(const fmu_mapping *m, const double *value, tdm_state *state);

/* Accelerations (nbody x 6) by values of the outputs and the states: of bodies whose accelerations are mapped. With
 * `linear` without centripetal parts: values are changes. */
void fmu_mapping_accelerations(const fmu_mapping *m, const double *value, const tdm_state *state, bool linear,
                               double *out);

#endif
