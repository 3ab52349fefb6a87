/* Tangential forces: stateless kernels with a history slot a contact.
 *
 * Mindlin's no-slip stiffness with Coulomb's limit (Mindlin & Deresiewicz 1953, in the form of Tsuji et al. 1992):
 *   S_t = 8 G* a,   F_t = F_el - c_t v_t,   c_t = 2 sqrt(5/6) beta sqrt(m* S_t),   |F_t| <= mu F_n
 *
 * The slot keeps the elastic force F_el and the contact radius a of the step before. In a step F_el
 *   1. turns with the contact: with the mean spin about the normal, then into the current tangent plane at its length;
 *   2. is scaled by a/a_before when the contact unloads (a falls). When it loads, it stays. So a contact returns no
 * more elastic energy than it was given: with F = S_t(delta) xi at any time a spring loaded at small a and released at
 *      large a would create energy (Walton 1993; Thornton, Cummins & Cleary 2013);
 *   3. grows by -S_t v_t dt, with the velocity of the middle of the step, which is the displacement of velocity Verlet;
 *   4. is clipped to the limit when the contact slides. The sum with the damping is clipped as well.
 * An attracting contact (the tail) has no friction.
 */
#ifndef DEM_CONTACT_TANGENTIAL_H
#define DEM_CONTACT_TANGENTIAL_H

#include "dem/model.h"

#include <math.h>

/* History of a contact; all zero when it is open. */
typedef struct {
  tdm_vec3 force; /* elastic tangential force [N] */
  double circle;  /* contact radius of the step before [m], 0: the contact is new */
} dem_slot;

/* What a tangential law may use. */
typedef struct {
  tdm_vec3 normal;       /* unit, from the partner to the particle */
  tdm_vec3 velocity;     /* relative tangential velocity at the contact now [m/s] */
  tdm_vec3 velocity_mid; /* the same in the middle of the step; its normal part is removed here [m/s] */
  double turn;           /* angle by which the contact turned about its normal in the step [rad] */
  double circle, root;   /* of the normal law */
  double normal_force;   /* after the tail [N] */
  double dt;             /* [s] */
} dem_slip;

DEM_KERNEL tdm_vec3 dem_tangential_none(const dem_pair *pair, dem_slot *slot, const dem_slip *slip) {
  (void)pair, (void)slot, (void)slip;
  return tdm_v3(0, 0, 0);
}

/* Force on the particle [N]; the partner gets the opposite. */
DEM_KERNEL tdm_vec3 dem_tangential_mindlin(const dem_pair *pair, dem_slot *slot, const dem_slip *slip) {
  tdm_vec3 n = slip->normal, f = slot->force;

  /* 1. turn with the contact */
  f = tdm_axpy(slip->turn, tdm_cross(n, f), f);
  double before = tdm_dot(slot->force, slot->force);
  f = tdm_axpy(-tdm_dot(f, n), n, f);
  double after = tdm_dot(f, f);
  double scale = after > 0 ? sqrt(before / after) : 0;

  /* 2. unloading */
  if (slip->circle < slot->circle)
    scale *= slip->circle / slot->circle;

  /* 3. displacement of this step */
  double stiffness = 8 * pair->shear * slip->circle;
  tdm_vec3 v_mid = tdm_axpy(-tdm_dot(slip->velocity_mid, n), n, slip->velocity_mid);
  f = tdm_axpy(-stiffness * slip->dt, v_mid, tdm_scale(scale, f));

  /* 4. Coulomb's limit, for the spring and for the sum */
  double limit = slip->normal_force > 0 ? pair->friction * slip->normal_force : 0;
  double f2 = tdm_dot(f, f);
  if (f2 > limit * limit)
    f = tdm_scale(limit / sqrt(f2), f);
  slot->force = f;
  slot->circle = slip->circle;
  tdm_vec3 sum = tdm_axpy(-pair->tangential_damping * slip->root, slip->velocity, f);
  double sum2 = tdm_dot(sum, sum);
  if (sum2 > limit * limit)
    sum = tdm_scale(limit / sqrt(sum2), sum);
  return sum;
}

#endif
