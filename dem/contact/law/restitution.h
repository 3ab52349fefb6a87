/* From the coefficient of restitution to the damping ratio beta of the Hertz contact with Tsuji's damping.
 *
 * In units of the undamped impact (x = delta/L, L^2.5 = m v^2/K, t in L/v) the impact is
 *   x'' = -x^1.5 - sqrt(5) beta x^0.25 x',   x(0) = 0, x'(0) = 1,
 * so e depends on beta alone.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LAW_RESTITUTION_H
#define DEM_CONTACT_LAW_RESTITUTION_H

#include "protocol/base/status.h"

#include <stdbool.h>

/* beta when the attractive tail is kept: -ln e / sqrt(ln^2 e + pi^2), e in (0, 1]. */
double dem_beta_keep(double restitution);

/* e of an impact that ends when the force falls to 0, integrated with GSL (relative accuracy about 1e-9). NaN: no
 * memory. */
double dem_restitution_clip(double beta);

/* beta for which dem_restitution_clip gives e, to 1e-9 in e. TDM_ERR_NUMERIC: it cannot be found (e below 0.001);
 * TDM_ERR_MEMORY. */
tdm_status dem_beta_clip(double restitution, double *beta);

/* Damped linear impact, damping ratio zeta, kept or clipped tail: duration times the undamped frequency, and e. */
double dem_linear_time(double zeta, bool clip);
double dem_linear_restitution(double zeta, bool clip);

/* Damping ratio zeta of a linear contact for e in (0, 1]. */
double dem_linear_ratio(double restitution, bool clip);

/* X = lambda v_0 of Hunt and Crossley's contact for e in (0, 1]; and the e that an X gives. */
double dem_hunt_damping(double restitution);
double dem_hunt_restitution(double damping);

#endif
