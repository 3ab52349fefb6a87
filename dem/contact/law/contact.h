/* What a contact law sees: DEM_W contacts, one a lane.
 *
 * The loop fills the upper part; the normal law then fills the lower one, which the other families read. Lanes whose
 * contact is open hold anything but traps: their results are thrown away.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_CONTACT_LAW_CONTACT_H
#define DEM_CONTACT_LAW_CONTACT_H

#include "dem/model/model.h"
#include "dem/numbers/simd.h"

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
  vm touching;     /* a law that acts over a gap takes lanes away here */
  vd3 normal;      /* unit, from the partner to the particle */
  vd overlap;      /* [m] */
  vd rate;         /* of the overlap, > 0 while approaching [m/s] */
  vd3 slip;        /* tangential velocity of the particle against the partner at the contact [m/s] */
  vd turn;         /* of the contact about its normal: radius-weighted mean spin [rad/s] */
  vd radius;       /* effective, R* [m] */
  vd mass;         /* effective, m* [kg] */
  vd inverse_mass; /* its inverse [1/kg] */
  double dt;       /* [s], 0: evaluate only */
  dem_coefficients pair;
  const dem_model *model;

  /* of a law with sums over the contacts of a particle */
  vd radii[2];          /* of the particle and of its partner, infinite of a wall [m] */
  const vd *own_sums;   /* (DEM_LAW_SUMS) of the particle; not while they are summed */
  const vd *other_sums; /* likewise of the partner, 0 of a wall */

  bool all_terms;     /* constant in each loop: the fields below are there */
  vd3 spin;           /* angular velocity of the particle against the partner [rad/s] */
  vd inverse_inertia; /* of rolling, 1/I_r: sum of 1/(I + m R^2) [1/(kg m2)] */
  vd sliding;         /* history: 1 while the contact slides, for a static friction of its own */

  /* by the normal law, cohesion may change it */
  vd force;     /* along the normal, > 0 repels [N]; what friction is limited by */
  vd circle;    /* contact radius, where the law has one [m] */
  vd stiffness; /* slope of the elastic force [N/m] */
  vd damping;   /* what damping of other families scales with (see the law) [kg/s] */
  vd elastic;   /* energy stored in the normal direction [J] */
  vd pull;      /* by cohesion: along the normal, besides `force` [N] */

  vd shift; /* of a law that takes notes, filled by the loop: by how much the others shift the overlap [m] */
} dem_contact;

/* What a contact tells the others of its particles. */
typedef struct {
  vd force;   /* elastic normal force, as they feel it [N] */
  bool again; /* the rest is there, for going over the notes again */
  vd hertz;   /* force at overlap 1 m */
  vd weight;  /* how much counts of what the sides give */
} dem_note;

/* What a tangential law gives. */
typedef struct {
  vd3 force;  /* on the particle; the partner gets the opposite [N] */
  vd elastic; /* energy stored [J] */
} dem_tangential;

/* What a rolling or twisting law gives. */
typedef struct {
  vd3 couple; /* on the particle; the partner gets the opposite [N m] */
  vd elastic; /* [J] */
} dem_couple;

/* What the kernel of a law that a program adds is called with: copies, so that the loops keep theirs in registers. */
typedef struct dem_call {
  dem_contact contact;         /* a tangential law or cohesion may change it */
  vd3 spin;                    /* of a rolling law: in the tangent plane, of a twisting law: about the normal [rad/s] */
  vd history[DEM_HISTORY_MAX]; /* the law's own columns */
  dem_tangential tangential;   /* out, of a tangential law */
  dem_couple couple;           /* out, of a rolling or twisting law */
} dem_call;

/* coefficient `field` of dem_pair in each lane, e.g. friction or normal[0] */
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

/* Turn a history vector with the contact: by the mean spin about the normal, then into the tangent plane at the same
 * length. The correction of the length is small: float precision of it is double precision of the result. */
DEM_KERNEL vd3 dem_turn_history(const dem_contact *c, vd3 f) {
  vd before = vd3_dot(f, f);
  f = vd3_axpy(c->turn * vd_set(c->dt), vd3_cross(c->normal, f), f);
  f = vd3_axpy(-vd3_dot(f, c->normal), c->normal, f);
  vd after = vd3_dot(f, f);
  vd change = vd_only(vm_less(vd_set(1e-36), after), vd_ratio_single(before - after, after));
  return vd3_scale(vd_set(1) + vd_set(0.5) * vd_min(change, vd_set(1)), f);
}

/* f where it is not over; there its direction times the limit. length2 = f.f */
DEM_KERNEL vd3 dem_clip(vd3 f, vd length2, vd limit, vm over) {
  vd scale = vd_pick(over, limit / vd_sqrt(vd_pick(over, length2, vd_set(1))), vd_set(1));
  return vd3_scale(scale, f);
}

/* Against v with this size, but no more than stops v within the step (a force of 1 changes v by per_mass a second); 0
 * where v is 0. */
DEM_KERNEL vd3 dem_against(const dem_contact *c, vd3 v, vd size, vd per_mass) {
  vd v2 = vd3_dot(v, v);
  vm moves = vm_less(vd_set(0), v2);
  vd share = size / vd_sqrt(vd_pick(moves, v2, vd_set(1)));
  if (c->dt > 0)
    share = vd_min(share, vd_set(1 / c->dt) / per_mass);
  return vd3_scale(vd_only(moves, -share), v);
}

#endif
