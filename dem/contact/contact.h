/* What a contact law sees: DEM_W contacts, one a lane.
 *
 * The loop fills the upper part; the normal law then fills the lower one, which the other families read. Lanes whose
 * contact is open hold anything but traps: their results are thrown away.
 */
#ifndef DEM_CONTACT_CONTACT_H
#define DEM_CONTACT_CONTACT_H

#include "dem/model.h"
#include "dem/simd.h"

#include <stddef.h>

/* of every kernel: GCC leaves larger ones as calls otherwise */
#define DEM_KERNEL DEM_INLINE

/* The coefficients of the lanes' pairs of materials. */
typedef struct {
  const dem_pair *table;
  bool one;         /* the scene has one pair only: table[0] */
  int index[DEM_W]; /* else: of the lanes in the table */
} dem_coefficients;

typedef struct {
  vm touching;
  vd3 normal;      /* unit, from the partner to the particle */
  vd overlap;      /* [m] */
  vd rate;         /* of the overlap, > 0 while approaching [m/s] */
  vd3 slip;        /* tangential velocity of the particle against the partner at the contact [m/s] */
  vd turn;         /* of the contact about its normal: radius-weighted mean spin [rad/s] */
  vd radius;       /* effective, R* [m] */
  vd mass;         /* effective, m* [kg] */
  double dt;       /* [s], 0: evaluate only */
  dem_coefficients pair;

  /* by the normal law */
  vd force;     /* along the normal, > 0 repels [N] */
  vd circle;    /* contact radius, or 0 when the law has none [m] */
  vd damping;   /* what damping of other families scales with (see the law) [kg/s] */
  vd elastic;   /* energy stored in the normal direction [J] */
  vd dissipate; /* power lost by the normal law [W] */
} dem_contact;

/* coefficient `field` of dem_pair in each lane */
#define DEM_OF(contact, field) dem_coefficient(&(contact)->pair, offsetof(dem_pair, field))

DEM_INLINE vd dem_coefficient(const dem_coefficients *c, size_t offset) {
  const char *base = (const char *)c->table + offset;
  if (c->one)
    return vd_set(*(const double *)base);
  double lane[DEM_W];
  for (int l = 0; l < DEM_W; l++)
    lane[l] = *(const double *)(base + (size_t)c->index[l] * sizeof(dem_pair));
  return vd_load(lane);
}

#endif
