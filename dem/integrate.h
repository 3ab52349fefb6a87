/* Velocity Verlet for spheres.
 *
 *   v(t+dt/2) = v + a dt/2,   x(t+dt) = x + v(t+dt/2) dt,   a(t+dt) from the contacts,   v(t+dt) = v(t+dt/2) + a(t+dt)
 * dt/2
 *
 * Damping needs v(t+dt) before a(t+dt) is known: it takes the prediction v(t) + a(t) dt, so that it does not lag by
 * half a step. Rotation likewise, with I = 2/5 m R^2.
 */
#ifndef DEM_INTEGRATE_H
#define DEM_INTEGRATE_H

#include "dem/data.h"

/* First kick and drift; forces are set to 0 for the next evaluation. Returns the largest squared displacement since
 * the lists were built, less the shift [m2]. */
double dem_kick_drift(dem_data *data, double dt, tdm_vec3 shift);

/* Second kick, with the new forces. */
void dem_kick(dem_data *data, double dt);

#endif
