/* Limits of the DEM step.
 *
 * Rayleigh: dt_R = pi R sqrt(rho/G) / (0.1631 nu + 0.8766), the time a surface wave takes around a particle ([L18]
 * Eq. 26, where the parenthesis stands inside the root in print); a share of 0.2 to 0.4 is common.
 * Contact: the closed form of the normal law (contact/law/theory.h); 20 steps resolve it well, 10 are the least. An
 * overdamped linear contact counts with half a period of the undamped one.
 * Eigenfrequency: 2/omega, with omega^2 bounded by twice the stiffness at a particle over its mass (Gershgorin), of the
 * contacts that touch now; tangentially (1 + m R^2/I) k_t = 3.5 k_t acts. 0.8 of it is taken.
 * Of contacts that multi-step takes several times in a step, so many times the limit counts.
 * Particles that sources will make count for the first two.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_WATCH_LIMITS_H
#define DEM_WATCH_LIMITS_H

#include "dem/contact/law/theory.h"
#include "dem/state/data.h"

/* shares of the three times above that a step may take */
#define DEM_RAYLEIGH_SHARE 0.4
#define DEM_CONTACT_SHARE 0.05        /* recommended */
#define DEM_CONTACT_SHARE_MOST 0.1    /* more is doubtful */
#define DEM_CONTACT_SHARE_REFUSED 0.5 /* a contact would be over between two steps */
#define DEM_EIGEN_SHARE 0.8

typedef struct {
  double rayleigh;     /* smallest dt_R [s]; inf without particles */
  double speed;        /* at which the contact time is taken [m/s] */
  double contact;      /* shortest t_c [s]; inf when nothing can move */
  double eigen;        /* smallest 2/omega [s]; inf when nothing touches */
  double coordination; /* contacts of a particle with others and with walls, the mean over all; 0 without particles */
  double step;         /* the step that keeps all limits, with the recommended share of the contact [s] */
  double most;         /* the same with the largest share of the contact: a longer step is doubtful [s] */
  const char *by;      /* which one decides `most`, in words */
} dem_limits;

/* Rayleigh step of a sphere [s]: radius [m], density [kg/m3], shear modulus [Pa]. */
double dem_rayleigh(double radius, double density, double shear, double poisson);

/* The highest speed at which a contact may begin now [m/s]: of the fastest particle and the fastest body against each
 * other, but no less than after a fall by a diameter. All ranks ask for it. */
double dem_impact_speed(const dem_data *data);

/* The limits of the present state, with the contact time at the speed of the fastest relative motion or of a fall by a
 * diameter, whichever is higher. Errors: TDM_ERR_MEMORY. All ranks ask for it. */
tdm_status dem_limits_now(dem_data *data, dem_limits *limits, tdm_error *err);

/* The same with the contact time at dem_expected_speed. */
tdm_status dem_limits_expected(dem_data *data, dem_limits *limits, tdm_error *err);

/* The largest relative speed to be expected [m/s]: dem.expected_speed if the scene has it, else that of the fastest
 * motion now, or of a source, after a fall over the largest height that is there: of the particles and containers, and
 * of particles and sources above planes. All ranks ask for it. */
double dem_expected_speed(const dem_data *data);

#endif
