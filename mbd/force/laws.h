/* Laws of one coordinate that several forces share: springs with dampers, contacts. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef MBD_FORCE_LAWS_H
#define MBD_FORCE_LAWS_H

#include "mbd/force/force.h"
#include "protocol/motion/spline.h"

typedef struct {
  double stiffness;            /* [N/m], [N m/rad] */
  double damping;              /* [N s/m], [N m s/rad] */
  double free;                 /* length [m] or angle [rad] without spring force */
  double preload;              /* tension [N] or torque [N m] at the free length or angle */
  tdm_spline *spring, *damper; /* tables that stand for stiffness and damping, NULL: none; owned */
} mbd_spring;

/* Read "stiffness" or "stiffness_table", "damping" or "damping_table", and "preload". */
void mbd_spring_read(mbd_spring *spring, tdm_object *o);

/* f = k (x - free) + c xdot + preload, or with the tables in place of k and c. */
mbd_scalar mbd_spring_law(const mbd_spring *spring, double x, double rate);

/* Free its tables. */
void mbd_spring_clear(mbd_spring *spring);

typedef struct {
  double stiffness; /* [N/m^exponent] */
  double exponent;  /* of the penetration */
  double damping;   /* [s/m] or [s/rad] */
} mbd_contact;

/* Read "stiffness", "exponent" and "damping" of a contact. */
void mbd_contact_read(mbd_contact *contact, tdm_object *o);

/* Push f = k d^n (1 + c ddot) at the penetration d, never negative (Hunt & Crossley, J. Appl. Mech. 42 (1975) 440-445);
 * derivatives are by d and ddot. */
mbd_scalar mbd_contact_law(const mbd_contact *contact, double penetration, double rate);

#endif
