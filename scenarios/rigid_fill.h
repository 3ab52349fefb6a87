/* A box and its fill, taken as one rigid body that turns about the z axis through the origin: what the references of
 * pendulum and torsional need. Angles are counter-clockwise seen from +z; the arm lies along +x at the start.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef SCN_RIGID_FILL_H
#define SCN_RIGID_FILL_H

#include "scenarios/support.h"

typedef struct {
  double mass;    /* box and fill [kg] */
  double x, y;    /* centre of mass of both at the start, from the pivot [m] */
  double inertia; /* I_box + m_c r^2 + sum(m_i |x_i|^2 + 2/5 m_i R^2), about the pivot [kg m2] */
  double fill_mass, fill_x, fill_y, fill_inertia; /* of the fill alone, the same way */
  double radius;                                  /* r, from the pivot to the box's centre [m] */
  double gravity;                                 /* downward, -y [m/s2] */
} scn_rigid_fill;

/* From the scene, and from what dem reported of its fill at the start. */
tdm_status scn_rigid_fill_read(const scn_result *r, scn_rigid_fill *fill, tdm_error *err);

#endif
