/* A particle that hits a cube ([L18] Table I): the cases, and how far a run is from momentum and restitution. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_COLLISION_H
#define SCN_COLLISION_H

#include "protocol/base/status.h"

enum { SCN_COLLISION_CASES = 6 };

extern const double scn_collision_mass[SCN_COLLISION_CASES];      /* of the particle [kg] */
extern const double scn_collision_body_mass, scn_collision_speed; /* of the cube [kg], of the particle [m/s] */

typedef struct {
  double particle, body; /* errors of the velocities after the collision, signed [%] */
  double restitution;    /* effective: (v_c - v_p)/u_p */
  double momentum;       /* after the collision, as a share of that before */
  int steps;             /* rows of the output grid in which the cube feels a load */
} scn_collision_errors;

tdm_status scn_collision_read(const char *dir, double m_p, scn_collision_errors *out, tdm_error *err);

#endif
