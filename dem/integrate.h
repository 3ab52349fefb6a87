/* Velocity Verlet, chunk by chunk; compiled once for each instruction set.
 *
 *   begin:  v += a dt/2, x += v dt; the contacts then see v + a dt/2, the velocity predicted for the end of the step,
 *           so that damping does not lag by half a step
 *   end:    v += a dt/2 with the new forces
 * and the same for the spin, with the torque about the centre.
 */
#ifndef DEM_INTEGRATE_H
#define DEM_INTEGRATE_H

#include "dem/data.h"

typedef struct dem_integrator {
  /* First half of a step for chunk c: kick, drift, forces zeroed. Returns the largest |x - x_list - shift|^2 [m2], NaN
   * when a position is no number. */
  double (*begin)(dem_data *data, int chunk, double dt, tdm_vec3 shift);
  /* Second half: reactions from other chunks added, kick. */
  void (*end)(dem_data *data, int chunk, double dt);
} dem_integrator;

extern const dem_integrator dem_integrator_avx512, dem_integrator_avx2, dem_integrator_plain;

/* The one compiled for an instruction set of dem_simd_names. */
const dem_integrator *dem_integrator_find(const char *simd);

#endif
