/* Consistent states: positions and velocities on the constraints, accelerations and reactions that fit.
 *
 * All of them solve the same linear system in twist coordinates (Haug 1989, chapters 10 and 11):
 *   [M G^T; G 0] [x; l] = [f; b]
 * with (0, -g) for a correction of the positions, (0, -G V - g_t) for one of the velocities (both the smallest in the
 * sense of kinetic energy), and (Q, -Gdot V - g_tt) for accelerations and reactions.
 */
#ifndef MBD_ASSEMBLE_H
#define MBD_ASSEMBLE_H

#include "mbd/state.h"

/* A workspace for the linear system. */
typedef struct mbd_kkt mbd_kkt;

mbd_kkt *mbd_kkt_create(const mbd_model *model); /* NULL: out of memory */
void mbd_kkt_destroy(mbd_kkt **kkt);

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
} mbd_assembly;

/* Move data's start state onto the constraints at data->t. Refuses redundant constraints and mechanisms that cannot be
 * assembled, with the joints named. */
tdm_status mbd_assemble(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, mbd_assembly *assembly, tdm_error *err);

/* Put a state that is nearly consistent at time t onto the constraints, positions and velocities; no messages. false:
 * failed. */
bool mbd_project(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y);

/* Accelerations and lambda at the state y and time t, into data->acceleration and data->lambda; data->kin is the
 * kinematics of y then. false: the system is singular. */
bool mbd_accelerations(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, const double *y);

/* Multipliers and derivatives that make (t, y, yp) consistent; positions and velocities of y must be. */
bool mbd_consistent(const mbd_model *model, mbd_data *data, mbd_kkt *kkt, double t, double *y, double *yp);

#endif
