/* Output channels at a time inside a step, from their values at both ends: see within.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/adapter/within.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

/* What happens to a channel inside a step. */
typedef enum {
  HELD,   /* a number that changes at the ends of steps: counts, and sums over what came and went */
  LINEAR, /* a quantity of first order: velocities, energies */
  CUBIC,  /* a place; its velocity is the third channel from it */
  MEAN    /* of the output interval already */
} course;

static course course_of(const char *channel) {
  static const struct {
    const char *begins;
    course course;
  } table[] = {{"particles.com.", CUBIC},
               {"particles.velocity.", LINEAR},
               {"particles.kinetic_energy", LINEAR},
               {"energy.", LINEAR},
               {"body.", MEAN},
               {"fixed.", MEAN}};
  for (size_t k = 0; k < sizeof table / sizeof *table; k++)
    if (strncmp(channel, table[k].begins, strlen(table[k].begins)) == 0)
      return table[k].course;
  return HELD;
}

/* The place between two ends, with the velocities there: Hermite's cubic, exact under constant forces. */
static double cubic(double f, double dt, double x0, double x1, double v0, double v1) {
  double back = 1 - f;
  return back * back * (1 + 2 * f) * x0 + f * f * (3 - 2 * f) * x1 + dt * f * back * (back * v0 - f * v1);
}

void dem_channels_within(int nchannel, const tdm_channel *channel, double share, double dt, const double *before,
                         double *now) {
  const bool same = now[0] == before[0];
  for (int c = 0; c < nchannel; c++)
    switch (course_of(channel[c].name)) {
    case CUBIC:
      now[c] = same ? cubic(share, dt, before[c], now[c], before[c + 3], now[c + 3])
                    : before[c] + share * dt * before[c + 3];
      break;
    case LINEAR:
      now[c] = same ? before[c] + share * (now[c] - before[c]) : before[c];
      break;
    case HELD:
      now[c] = before[c];
      break;
    case MEAN:
      break;
    }
}

double dem_share_of_step(double time, double t, double dt) {
  double share = 1 - (t - time) / dt;
  return share > 1 - 1e-6 ? 1 : fmax(share, 0);
}
