/* Assembly: the start state onto the constraints, and which rows depend on others. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_ASSEMBLY_ASSEMBLE_H
#define MBD_ASSEMBLY_ASSEMBLE_H

#include "mbd/consistent/consistent.h"

/* how far the start was moved to satisfy the joints; velocities that a driver gives to bodies are not counted */
typedef struct {
  double translation; /* largest of a body [m] */
  double rotation;    /* [rad] */
  double velocity;    /* largest change of a velocity [m/s] */
  double angular;     /* [rad/s] */
  int body;           /* that moved most, -1: none */
  int body_velocity;  /* whose velocity changed most, -1: none */
  int freedom;        /* degrees of freedom that joints and drivers leave */
  int driver;         /* the one that contradicts the given velocities most, -1: none */
  double given;       /* rate of its coordinate in the given velocities [rad/s] */
  double prescribed;  /* and in its motion [rad/s] */
  int near_row;       /* the most nearly dependent row, -1: none is */
} mbd_assembly;

/* where a constraint row comes from, for messages and reports */
typedef struct {
  char path[TDM_PATH_MAX];
  const char *kind, *name, *equation; /* "joint", "driver" or "friction" */
} mbd_origin;

mbd_origin mbd_origin_of(const mbd_model *model, int row);

/* Move data's start state onto the constraints at data->t and find the dependent rows (data->dependent), which are left
 * out of the motion's equations from then on. Refuses, with the joints named: a mechanism that cannot be assembled or
 * contradicts itself, a start that is too far from an assembled position, a redundant driver, a start in a singular
 * position. */
tdm_status mbd_assemble(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, mbd_assembly *assembly, tdm_error *err);

#endif
