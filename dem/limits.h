/* Limits of the DEM step.
 *
 * Rayleigh: dt_R = pi R sqrt(rho/G) / (0.1631 nu + 0.8766), the time a surface wave takes around a particle ([L18]
 * Eq. 26, where the parenthesis stands inside the root in print); 0.4 of it is a common limit.
 * Contact: an impact takes t_c = 2.868 (m*^2 / (R* E*^2 v))^(1/5) (Hertz) and needs at least ten steps.
 * Eigenfrequency: 2/omega, with omega^2 bounded by twice the stiffness at a particle over its mass (Gershgorin), of the
 * contacts that touch now; tangentially (1 + m R^2/I) S_t = 3.5 S_t acts. 0.8 of it is taken.
 */
#ifndef DEM_LIMITS_H
#define DEM_LIMITS_H

#include "dem/data.h"

typedef struct {
  double rayleigh; /* smallest dt_R [s]; inf without particles */
  double speed; /* at which the contact time is taken: the fastest of relative motion and a fall by a diameter [m/s] */
  double contact; /* shortest t_c [s]; inf when nothing can move */
  double eigen;   /* smallest 2/omega [s]; inf when nothing touches */
  double step;    /* the step that keeps all limits [s] */
  const char *by; /* which one decides, in words */
} dem_limits;

/* Rayleigh step of a sphere [s]: radius [m], density [kg/m3], shear modulus [Pa]. */
double dem_rayleigh(double radius, double density, double shear, double poisson);

/* Duration of an undamped Hertz impact [s] at speed v [m/s]; inf for v = 0. */
double dem_contact_time(double mass, double radius, double young, double speed);

/* The limits of the present state. */
dem_limits dem_limits_now(const dem_data *data);

#endif
