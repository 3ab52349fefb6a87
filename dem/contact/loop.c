/* The loops over pairs and walls.
 *
 * One source, compiled once for each row of the table: the kernels are constants of an always-inlined function, so no
 * call and no branch on a law is left in a loop.
 *
 * The sums do not depend on the lists: particle i gets the forces of its partners in ascending order, then those of
 * its walls in ascending order, and a listed pair that does not touch adds nothing.
 */
#include "dem/contact/loop.h"

#include "dem/contact/normal.h"
#include "dem/contact/tangential.h"
#include "dem/data.h"

typedef dem_normal normal_law(const dem_pair *, double overlap, double rate, double radius, double mass);
typedef double tail_law(double force);
typedef tdm_vec3 tangential_law(const dem_pair *, dem_slot *, const dem_slip *);

/* The force on the particle from a contact with unit normal n (towards the particle), relative velocities v at the
 * contact now and v_mid in the middle of the step, and `turn` about the normal. */
DEM_KERNEL tdm_vec3 contact_force(const dem_pair *pair, dem_slot *slot, tdm_vec3 n, double overlap, double radius,
                                  double mass, tdm_vec3 v, tdm_vec3 v_mid, double turn, double dt, normal_law *normal,
                                  tail_law *tail, tangential_law *tangential) {
  double away = tdm_dot(v, n);
  dem_normal fn = normal(pair, overlap, -away, radius, mass);
  dem_slip slip = {.normal = n,
                   .velocity = tdm_axpy(-away, n, v),
                   .velocity_mid = v_mid,
                   .turn = turn,
                   .circle = fn.circle,
                   .root = fn.root,
                   .normal_force = tail(fn.force),
                   .dt = dt};
  return tdm_axpy(slip.normal_force, n, tangential(pair, slot, &slip));
}

DEM_KERNEL void pair_loop(const dem_model *m, dem_data *d, bool settling, double dt, normal_law *normal, tail_law *tail,
                          tangential_law *tangential, const bool history) {
  const dem_pair *table = settling ? m->settle_pair : m->pair;
  const double *restrict radius = d->radius, *restrict mass = d->mass;
  const int *restrict first = d->pairs.first, *restrict other = d->pairs.other, *restrict kind = d->kind;
  const tdm_vec3 *restrict x = d->position, *restrict v = d->velocity_ahead, *restrict w = d->spin_ahead;
  const tdm_vec3 *restrict v_mid = d->velocity, *restrict w_mid = d->spin;
  tdm_vec3 *restrict force = d->force, *restrict torque = d->torque;
  dem_slot *restrict slot = d->pairs.slot;
  long touching = 0;

  for (int i = 0; i < d->nparticle; i++) {
    tdm_vec3 xi = x[i], fi = force[i], ti = torque[i];
    for (int k = first[i]; k < first[i + 1]; k++) {
      int j = other[k];
      tdm_vec3 c = tdm_sub(xi, x[j]);
      double r2 = tdm_dot(c, c), sum = radius[i] + radius[j];
      if (r2 >= sum * sum) {
        if (history && slot[k].circle > 0)
          slot[k] = (dem_slot){0};
        continue;
      }
      touching++;
      double r = sqrt(r2), overlap = sum - r;
      tdm_vec3 n = r > 0 ? tdm_scale(1 / r, c) : tdm_v3(0, 0, 1);

      /* both arms end in the middle of the overlap */
      double arm_i = radius[i] - 0.5 * overlap, arm_j = radius[j] - 0.5 * overlap;
      tdm_vec3 roll = tdm_axpy(arm_j, w[j], tdm_scale(arm_i, w[i]));
      tdm_vec3 roll_mid = tdm_axpy(arm_j, w_mid[j], tdm_scale(arm_i, w_mid[i]));
      tdm_vec3 vc = tdm_sub(tdm_sub(v[i], v[j]), tdm_cross(roll, n));
      tdm_vec3 vc_mid = tdm_sub(tdm_sub(v_mid[i], v_mid[j]), tdm_cross(roll_mid, n));
      double turn = 0.5 * dt * tdm_dot(tdm_add(w_mid[i], w_mid[j]), n);
      tdm_vec3 f = contact_force(&table[kind[i] * m->nmaterial + kind[j]], history ? &slot[k] : NULL, n, overlap,
                                 radius[i] * radius[j] / sum, mass[i] * mass[j] / (mass[i] + mass[j]), vc, vc_mid, turn,
                                 dt, normal, tail, tangential);
      tdm_vec3 t = tdm_cross(n, f);
      fi = tdm_add(fi, f);
      ti = tdm_axpy(-arm_i, t, ti);
      force[j] = tdm_sub(force[j], f);
      torque[j] = tdm_axpy(-arm_j, t, torque[j]);
    }
    force[i] = fi;
    torque[i] = ti;
  }
  d->ncontact += touching;
}

DEM_KERNEL void wall_loop(const dem_model *m, dem_data *d, bool settling, double dt, normal_law *normal, tail_law *tail,
                          tangential_law *tangential, const bool history) {
  const dem_pair *table = settling ? m->settle_pair : m->pair;
  const int *first = d->walls.first, *other = d->walls.other;
  dem_slot *slot = d->walls.slot;

  for (int i = 0; i < d->nparticle; i++) {
    double radius = d->radius[i];
    for (int k = first[i]; k < first[i + 1]; k++) {
      const dem_wall *wall = &m->wall[other[k]];
      tdm_vec3 n;
      double gap = dem_wall_gap(wall, &d->wall[other[k]], d->position[i], &n);
      bool through = wall->primitive == DEM_PLANE && gap <= -radius;
      if (gap >= radius || through) {
        if (history && slot[k].circle > 0)
          slot[k] = (dem_slot){0};
        continue;
      }
      d->ncontact++;

      /* the contact point lies on the wall's surface */
      int b = wall->body;
      tdm_vec3 point = tdm_axpy(-gap, n, d->position[i]), lever = tdm_sub(point, d->pose[b].position);
      tdm_twist now = d->twist[b], mid = d->twist_mid[b];
      tdm_vec3 wall_v = tdm_add(now.velocity, tdm_cross(now.angular, lever));
      tdm_vec3 wall_mid = tdm_add(mid.velocity, tdm_cross(mid.angular, lever));
      tdm_vec3 vc = tdm_sub(tdm_axpy(-gap, tdm_cross(d->spin_ahead[i], n), d->velocity_ahead[i]), wall_v);
      tdm_vec3 vc_mid = tdm_sub(tdm_axpy(-gap, tdm_cross(d->spin[i], n), d->velocity[i]), wall_mid);
      double turn = 0.5 * dt * tdm_dot(tdm_add(d->spin[i], mid.angular), n);

      /* a held body is immovable; a coupled one has its own mass */
      double inverse = settling ? 0 : d->body_inverse[b];
      double mass = d->mass[i] / (1 + d->mass[i] * inverse);
      const dem_pair *pair = &table[d->kind[i] * m->nmaterial + m->body[b].material];
      tdm_vec3 f = contact_force(pair, history ? &slot[k] : NULL, n, radius - gap, radius, mass, vc, vc_mid, turn, dt,
                                 normal, tail, tangential);
      d->force[i] = tdm_add(d->force[i], f);
      d->torque[i] = tdm_axpy(-gap, tdm_cross(n, f), d->torque[i]);
      d->body_load[b].force = tdm_sub(d->body_load[b].force, f);
      d->body_load[b].moment = tdm_sub(d->body_load[b].moment, tdm_cross(lever, f));
    }
  }
}

#define X(normal, tangential, tail, history)                                                                   \
  void dem_pairs_##normal##_##tangential##_##tail(const dem_model *m, dem_data *d, bool settling, double dt) { \
    pair_loop(m, d, settling, dt, dem_normal_##normal, dem_tail_##tail, dem_tangential_##tangential, history); \
  }                                                                                                            \
  void dem_walls_##normal##_##tangential##_##tail(const dem_model *m, dem_data *d, bool settling, double dt) { \
    wall_loop(m, d, settling, dt, dem_normal_##normal, dem_tail_##tail, dem_tangential_##tangential, history); \
  }
DEM_LAW_LIST(X)
#undef X
