/* Kernel of normal law hertz, for the laws that build on it: see hertz.c. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_NORMAL_HERTZ_H
#define DEM_CONTACT_NORMAL_HERTZ_H

#include "dem/contact/law/contact.h"

/* pair.viscosity is eta [Pa s], pair.normal_damping 2 sqrt(5/6) beta; cohesion jkr reads them, too */

/* Elastic force of a contact with this overlap [N]; fills circle, stiffness and damping. */
DEM_KERNEL vd dem_hertz_elastic(dem_contact *c, vd overlap) {
  vd young = DEM_OF(c, effective_young);
  c->circle = vd_sqrt(c->radius * overlap);
  c->stiffness = (young + young) * c->circle; /* S_n */
  c->damping = vd_sqrt(c->stiffness * c->mass);
  return vd_set(2.0 / 3.0) * c->stiffness * overlap;
}

/* The force with its damping, from the elastic one. */
DEM_KERNEL void dem_hertz_damp(dem_contact *c, vd elastic) {
  vd damped = DEM_OF(c, normal_damping) * c->damping * c->rate;
  if (c->all_terms)
    damped = damped + DEM_OF(c, viscosity) * c->circle * c->rate;
  c->force = vd_max(elastic + damped, DEM_OF(c, floor));
}

#endif
