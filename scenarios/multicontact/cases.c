/* What the cases of this folder share: see cases.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/multicontact/cases.h"

#include "dem/base/sphere.h"

#include <math.h>
#include <stdio.h>

const scn_soft scn_softs[SCN_SOFTS] = {
    [SCN_HYDROGEL] = {"hydrogel", 11.5, 23.3e3, 0.5, 0.95, 0.03},
    [SCN_RUBBER] = {"rubber", 2000, 1.85e6, 0.46, 0.7, 0.5},
    [SCN_GLASS] = {"glass", 2500, 65e9, 0.24, 0.98, 0.2},
};

const char *const scn_multi_names[SCN_MULTI_LAWS] = {"classical", "mc-strain", "mc-stress"};

const char *scn_multi_contact(int law) {
  static const char *const keys[SCN_MULTI_LAWS] = {"", ",'multi_contact':'mc-strain'", ",'multi_contact':'mc-stress'"};
  return keys[law];
}

const char *scn_multi_pair(int law, double factor) {
  static char text[64];
  text[0] = '\0';
  if (law == SCN_STRAIN)
    snprintf(text, sizeof text, ",'gamma':%.17g", factor);
  else if (law == SCN_STRESS)
    snprintf(text, sizeof text, ",'beta':%.17g", factor);
  return text;
}

/* restitution of x'' = -x^1.5 - c sqrt(x) x' from x = 0, x' = 1: until x is 0 again */
static double restitution_of(double c) {
  double x = 0, v = 1;
  const double h = 1e-3;
  for (int k = 0; k < 100000 && (k == 0 || x > 0); k++) {
    double kx[4], kv[4], at = x, speed = v;
    for (int s = 0; s < 4; s++) {
      double root = sqrt(fmax(at, 0));
      kx[s] = speed, kv[s] = -root * fmax(at, 0) - c * root * speed;
      double share = s < 2 ? 0.5 * h : h;
      at = x + share * kx[s], speed = v + share * kv[s];
    }
    x += h / 6 * (kx[0] + 2 * kx[1] + 2 * kx[2] + kx[3]);
    v += h / 6 * (kv[0] + 2 * kv[1] + 2 * kv[2] + kv[3]);
  }
  return -v;
}

double scn_viscosity(const scn_soft *of, double radius, double speed) {
  double low = 0, high = 10;
  for (int k = 0; k < 60; k++) {
    double middle = 0.5 * (low + high);
    if (restitution_of(middle) > of->restitution)
      low = middle;
    else
      high = middle;
  }
  /* m x'' = -k x^1.5 - eta sqrt(R x) x' with x = L X, t = T tau: c = eta sqrt(R L) T/m, T = L/v, L^2.5 = m v^2/k */
  double mass = dem_sphere_mass(of->density, radius) / 2, both = radius / 2;
  double stiffness = 4.0 / 3 * of->young / (2 * (1 - of->poisson * of->poisson)) * sqrt(both);
  double length = pow(mass * speed * speed / stiffness, 0.4);
  return low * mass / (sqrt(both * length) * (length / speed));
}
