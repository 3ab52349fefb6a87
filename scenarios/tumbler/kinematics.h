/* The tumbler screening machine's motion in closed form, and as Alkhaldi 2007 [A07], Section 4.3.2, prints it.
 *
 * The holder plate turns at omega about the world's z axis, through o. The plate on it is tilted by beta and alpha
 * about the point (u, eccentricity - e, 0) of the holder. Its frame K has the origin c, the foot of the auxiliary
 * shaft, which carries the barrel and stands across the plate. The barrel turns by psi about it: omega_b t where it
 * turns steadily, omega t where it stays in the plate, 0 where it does not turn. Angles in rad, times in s, lengths in
 * m.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_TUMBLER_KINEMATICS_H
#define SCN_TUMBLER_KINEMATICS_H

#include "protocol/math/pose.h"

typedef struct {
  double omega;       /* of the machine [rad/s] */
  double alpha, beta; /* tilt [rad] */
  double eccentricity, u, e;
} scn_tumbler;

/* A body's frame at one instant, and how it moves. */
typedef struct {
  tdm_vec3 r, v;  /* its origin from o, and its velocity, world axes */
  tdm_mat3 A, dA; /* world axes to the body's, A_lg of [A07], and its derivative by the time */
  tdm_vec3 w;     /* angular velocity, world axes */
} scn_tumbler_frame;

/* ---- closed form ---- */

scn_tumbler_frame scn_tumbler_holder(const scn_tumbler *m, double t);
scn_tumbler_frame scn_tumbler_plate(const scn_tumbler *m, double t);

/* psi and its rate at time t */
scn_tumbler_frame scn_tumbler_barrel(const scn_tumbler *m, double t, double psi, double rate);

/* psi of the oscillating barrel and its rate, off rounded corners: Eq. (4.7), its second branch mended; omega_b its
 * slope. */
void scn_tumbler_triangle(double omega_b, double period, double t, double *psi, double *rate);

/* A particle in a body's frame: Eq. (4.8), (4.10). */
tdm_vec3 scn_tumbler_relative_place(const scn_tumbler_frame *f, tdm_vec3 place);
tdm_vec3 scn_tumbler_relative_velocity(const scn_tumbler_frame *f, tdm_vec3 place, tdm_vec3 velocity);

/* ---- as printed ---- */

tdm_vec3 scn_tumbler_eq_4_1(const scn_tumbler *m, double t);                  /* r_oc; (4.16) is the same */
tdm_mat3 scn_tumbler_eq_4_3(const scn_tumbler *m, double t, double omega_b);  /* A_lg of the barrel */
tdm_mat3 scn_tumbler_eq_4_4(const scn_tumbler *m, double t);                  /* omega_b = omega; (4.17) is the same */
tdm_mat3 scn_tumbler_eq_4_5(const scn_tumbler *m, double t);                  /* omega_b = 0 */
tdm_vec3 scn_tumbler_eq_4_11(const scn_tumbler *m, double t);                 /* derivative of (4.1) */
tdm_mat3 scn_tumbler_eq_4_13(const scn_tumbler *m, double t, double omega_b); /* of (4.3); wrong in 11, 12, 22 */
tdm_mat3 scn_tumbler_eq_4_14(const scn_tumbler *m, double t);                 /* of (4.4) */
tdm_mat3 scn_tumbler_eq_4_15(const scn_tumbler *m, double t); /* of (4.5); without the line that repeats A22 */
tdm_mat3 scn_tumbler_eq_4_19(const scn_tumbler *m, double t); /* of the holder */

#endif
