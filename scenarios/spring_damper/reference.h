/* Closed form of the spring-damper of [L18] Eq. 24 with the preload that the equation leaves out:
 *
 *   m x'' + c x' + k x + F_pre = m g,   x(0) = x'(0) = 0,   x downward from the start
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_SPRING_DAMPER_REFERENCE_H
#define SCN_SPRING_DAMPER_REFERENCE_H

typedef struct {
  double mass;      /* box and particles [kg] */
  double damping;   /* [N s/m] */
  double stiffness; /* [N/m] */
  double preload;   /* [N] */
  double gravity;   /* [m/s2] */
} scn_spring_damper_parameters;

/* Position [m] and velocity [m/s] at time t [s], for an underdamped system (c^2 < 4 k m). */
void scn_spring_damper_exact(const scn_spring_damper_parameters *p, double t, double *x, double *v);

#endif
