/* Energies of the contacts, by mechanism.
 *
 * The loops give the power that the bodies put into the contacts and the energy that is stored in them. What was put in
 * (trapezoidal rule, second order as velocity Verlet is) and is not stored has been dissipated. So no law needs a
 * formula for its losses, and what a contact holds when it is cut (adhesion at pull-off) counts as lost.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_BASE_ENERGY_H
#define DEM_BASE_ENERGY_H

/* Mechanisms: name in C, name of the channel. plastic: the normal direction of a law whose loss is no damping. */
#define DEM_ENERGY_LIST(X)              \
  X(NORMAL, "normal")                   \
  X(PLASTIC, "plastic")                 \
  X(TANGENTIAL, "tangential")           \
  X(ROLLING, "rolling")                 \
  X(WALL_NORMAL, "wall.normal")         \
  X(WALL_PLASTIC, "wall.plastic")       \
  X(WALL_TANGENTIAL, "wall.tangential") \
  X(WALL_ROLLING, "wall.rolling")

#define X(mechanism, name) DEM_ENERGY_##mechanism,
enum { DEM_ENERGY_LIST(X) DEM_ENERGIES };
#undef X

/* Of the contacts at one instant; sums over lanes, then chunks, in their order. */
typedef struct {
  double power[DEM_ENERGIES];   /* put into the contacts [W] */
  double elastic[DEM_ENERGIES]; /* stored [J]; negative where cohesion holds */
  double wall_power;            /* of the walls on particles and contacts [W] */
  double box_power;             /* of a strained box, through contacts with images [W] */
} dem_flux;

typedef struct {
  dem_flux now;                    /* at the last evaluation; with multi-step of the slow contacts */
  dem_flux fast;                   /* likewise of the fast ones, else 0 */
  double dissipated[DEM_ENERGIES]; /* since the start of the run [J] */
  double wall_work;                /* likewise */
  double supplied;                 /* likewise: by the box, where it repeats (domain.c) or is strained */
} dem_energy;

/* Add another chunk's. */
void dem_flux_add(dem_flux *sum, const dem_flux *chunk);

/* Go on by dt from the flux `of` of a share of the contacts, e->now or e->fast, to the one of now; dt = 0: only
 * remember it. */
void dem_energy_step(dem_energy *e, dem_flux *of, const dem_flux *now, double dt);

/* Forget what was dissipated. */
void dem_energy_begin(dem_energy *e);

/* Stored in all contacts [J]. */
double dem_energy_elastic(const dem_energy *e);

#endif
