/* Velocity Verlet: see integrate.h. A particle's records are vectors of eight: velocity and spin go together. */
#include "dem/integrate.h"

#include "dem/simd.h"

typedef double v8 __attribute__((vector_size(64)));
typedef long long v8i __attribute__((vector_size(64)));

DEM_INLINE v8 load8(const void *p) {
  v8 a;
  memcpy(&a, p, sizeof a);
  return a;
}

DEM_INLINE void store8(void *p, v8 a) {
  memcpy(p, &a, sizeof a);
}

/* acceleration and angular acceleration of a particle */
DEM_INLINE v8 acceleration(const dem_sphere *s, const dem_push *push, v8 gravity) {
  double per_mass = s->inverse_mass, turn = -2.5 * per_mass / s->radius; /* I = 2/5 m R^2, torque = -R twist */
  v8 scale = {per_mass, per_mass, per_mass, 0, turn, turn, turn, 0};
  return load8(push) * scale + gravity;
}

DEM_INLINE v8 gravity_of(const dem_model *m) {
  return (v8){m->gravity.x, m->gravity.y, m->gravity.z, 0, 0, 0, 0, 0};
}

static double begin(dem_data *d, int chunk, double dt, tdm_vec3 shift) {
  const v8 half = {0.5 * dt, 0.5 * dt, 0.5 * dt, 0, 0.5 * dt, 0.5 * dt, 0.5 * dt, 0};
  const v8 drift = {dt, dt, dt, 0, 0, 0, 0, 0}, g = gravity_of(d->model), zero = {0};
  double moved2 = 0, sum = 0;
  for (int i = chunk * DEM_CHUNK, end = dem_chunk_end(d, chunk); i < end; i++) {
    dem_sphere *s = &d->sphere[i];
    v8 a = half * acceleration(s, &d->push[i], g);
    v8 v = load8(&d->pace[i]) + a, ahead = v + a;
    store8(&d->pace[i], v);
    store8(&d->push[i], zero);
    /* position, radius | velocity ahead, 1/mass */
    v8 x = load8(s) + drift * v;
    store8(s, __builtin_shuffle(x, ahead, (v8i){0, 1, 2, 3, 8, 9, 10, 7}));
    double radius = s->radius;
    d->rotor[i].surface = tdm_v3(radius * ahead[4], radius * ahead[5], radius * ahead[6]);
    tdm_vec3 moved = tdm_sub(tdm_sub(s->position, d->position_at_list[i]), shift);
    double r2 = tdm_dot(moved, moved);
    moved2 = r2 > moved2 ? r2 : moved2;
    sum += r2;
  }
  return isfinite(sum) ? moved2 : NAN;
}

static void add_crossings(dem_data *d, int chunk) {
  const dem_crossings *x = &d->crossings;
  for (int k = x->chunk[chunk]; k < x->chunk[chunk + 1]; k++) {
    int place = x->order[k];
    dem_push *from = &d->push[d->nparticle + 1 + place], *to = &d->push[x->particle[place]];
    v8 zero = {0};
    store8(to, load8(to) + load8(from));
    store8(from, zero);
  }
}

static void finish(dem_data *d, int chunk, double dt) {
  const v8 half = {0.5 * dt, 0.5 * dt, 0.5 * dt, 0, 0.5 * dt, 0.5 * dt, 0.5 * dt, 0}, g = gravity_of(d->model);
  add_crossings(d, chunk);
  for (int i = chunk * DEM_CHUNK, end = dem_chunk_end(d, chunk); i < end; i++)
    store8(&d->pace[i], load8(&d->pace[i]) + half * acceleration(&d->sphere[i], &d->push[i], g));
}

const dem_integrator DEM_ISA(dem_integrator) = {begin, finish};
