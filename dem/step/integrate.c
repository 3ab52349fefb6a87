/* The integrators: see integrate.h. A particle's records are vectors of eight: velocity and spin go together. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/step/integrate.h"

#include "dem/numbers/simd.h"
#include "dem/seam/crossings.h"

typedef double v8 __attribute__((vector_size(64)));
typedef double v4 __attribute__((vector_size(32)));
typedef long long v4i __attribute__((vector_size(32)));

DEM_INLINE v8 load8(const void *p) {
  v8 a;
  memcpy(&a, p, sizeof a);
  return a;
}

DEM_INLINE void store8(void *p, v8 a) {
  memcpy(p, &a, sizeof a);
}

/* t in the lanes of velocity and spin */
DEM_INLINE v8 span(double t) {
  return (v8){t, t, t, 0, t, t, t, 0};
}

/* first three lanes of a, others of b */
DEM_INLINE v8 join(v8 a, v8 b) {
  return __builtin_shufflevector(a, b, 0, 1, 2, 11, 12, 13, 14, 15);
}

/* ---- accelerations ---- */

/* What acts besides contacts; `driven` is known when a loop is compiled. */
typedef struct {
  v8 gravity, free; /* free: 0 for what must not change in two dimensions or without rotation, else 1 */
  const dem_pace *drive;
} field;

DEM_INLINE field field_of(const dem_data *d, const bool driven) {
  const dem_model *m = d->model;
  field f = {{m->gravity.x, m->gravity.y, m->gravity.z, 0, 0, 0, 0, 0}, {1, 1, 1, 1, 1, 1, 1, 1}, d->state.drive};
  for (int a = 0; driven && a < 3; a++)
    if (m->flat >= 0)
      f.free[a == m->flat ? a : 4 + a] = 0;
  for (int a = 0; driven && m->unturned && a < 3; a++)
    f.free[4 + a] = 0;
  return f;
}

/* of contacts alone: linear and angular */
DEM_INLINE v8 of_contacts(const dem_sphere *s, const dem_push *push) {
  double per_mass = s->inverse_mass, turn = -2.5 * per_mass / s->radius; /* I = 2/5 m R^2, torque = -R twist */
  v8 scale = {per_mass, per_mass, per_mass, 0, turn, turn, turn, 0};
  return load8(push) * scale;
}

DEM_INLINE v8 of_all(const dem_data *d, int i, const dem_push *push, const field *f, const bool driven) {
  v8 a = of_contacts(&d->state.sphere[i], &push[i]) + f->gravity;
  return driven ? (a + load8(&f->drive[i])) * f->free : a;
}

/* ---- what all share ---- */

#define EACH_PARTICLE(d, chunk, i) for (int i = (chunk)*DEM_CHUNK, end_ = dem_chunk_end(d, chunk); i < end_; i++)

/* How far particles of a chunk are from where they were listed: squares by component, the fourth means nothing. */
typedef struct {
  v4 most, sum; /* [m2]; the sum is NaN when one is */
} travel;

/* position, radius | velocity ahead, 1/mass; and the forces zeroed */
DEM_INLINE void put(dem_data *d, int i, v8 x, v8 ahead, tdm_vec3 shift, travel *moved) {
  const v8 zero = {0};
  dem_sphere *s = &d->state.sphere[i];
  double r = s->radius;
  v4 radius = {r, r, r, r}, listed;
  store8(&d->state.push[i], zero);
  store8(s, __builtin_shufflevector(x, ahead, 0, 1, 2, 3, 8, 9, 10, 7));
  v4 surface = radius * __builtin_shufflevector(ahead, ahead, 4, 5, 6, 7);
  surface = __builtin_shufflevector(surface, radius, 0, 1, 2, 7);
  memcpy(&d->state.rotor[i], &surface, sizeof surface);
  memcpy(&listed, &d->lists.position_at_list[i], sizeof listed); /* the next one's first, too: there is one more */
  v4 way = __builtin_shufflevector(x, x, 0, 1, 2, 3) - listed - (v4){shift.x, shift.y, shift.z, 0}, way2 = way * way;
  v4i more = way2 > moved->most;
  moved->most = (v4)((more & (v4i)way2) | (~more & (v4i)moved->most));
  moved->sum += way2;
}

/* a bound of the largest square of a way, NaN when a position is no number */
static double farthest(const travel *moved) {
  const v4 *m = &moved->most, *s = &moved->sum;
  return isfinite((*s)[0] + (*s)[1] + (*s)[2]) ? (*m)[0] + (*m)[1] + (*m)[2] : NAN;
}

static void add_crossings(dem_data *d, int chunk) {
  const dem_crossings *x = &d->lists.crossings;
  for (int k = x->chunk[chunk]; k < x->chunk[chunk + 1]; k++) {
    int place = x->order[k];
    dem_push *from = &d->state.push[dem_crossing_slot(d, place)], *to = &d->state.push[x->particle[place]];
    v8 zero = {0};
    store8(to, load8(to) + load8(from));
    store8(from, zero);
  }
}

/* time in the lanes of a position */
DEM_INLINE v8 drift_of(double dt) {
  return (v8){dt, dt, dt, 0, 0, 0, 0, 0};
}

/* ---- verlet ---- */

DEM_INLINE double begin_verlet(dem_data *d, int chunk, const dem_stride *stride, const bool driven) {
  const v8 half = span(0.5 * stride->dt), drift = drift_of(stride->dt);
  const field f = field_of(d, driven);
  travel moved = {{0}, {0}};
  EACH_PARTICLE(d, chunk, i) {
    v8 a = half * of_all(d, i, d->state.push, &f, driven);
    v8 v = load8(&d->state.pace[i]) + a, ahead = v + a;
    store8(&d->state.pace[i], v);
    put(d, i, load8(&d->state.sphere[i]) + drift * v, ahead, stride->shift, &moved);
  }
  return farthest(&moved);
}

DEM_INLINE void end_verlet(dem_data *d, int chunk, double dt, const bool driven) {
  const v8 half = span(0.5 * dt);
  const field f = field_of(d, driven);
  add_crossings(d, chunk);
  EACH_PARTICLE(d, chunk, i)
  store8(&d->state.pace[i], load8(&d->state.pace[i]) + half * of_all(d, i, d->state.push, &f, driven));
}

/* ---- leap-frog ---- */

DEM_INLINE double begin_leap_frog(dem_data *d, int chunk, const dem_stride *stride, const bool driven) {
  const v8 half = span(0.5 * stride->dt), drift = drift_of(stride->dt);
  const field f = field_of(d, driven);
  travel moved = {{0}, {0}};
  EACH_PARTICLE(d, chunk, i) {
    v8 a = half * of_all(d, i, d->state.push, &f, driven);
    v8 w = load8(&d->state.memory[i]) + (a + a);
    store8(&d->state.memory[i], w);
    store8(&d->state.pace[i], w);
    put(d, i, load8(&d->state.sphere[i]) + drift * w, w + a, stride->shift, &moved);
  }
  return farthest(&moved);
}

DEM_INLINE void end_leap_frog(dem_data *d, int chunk, double dt, const bool driven) {
  const v8 half = span(0.5 * dt);
  const field f = field_of(d, driven);
  add_crossings(d, chunk);
  EACH_PARTICLE(d, chunk, i)
  store8(&d->state.pace[i], load8(&d->state.memory[i]) + half * of_all(d, i, d->state.push, &f, driven));
}

DEM_INLINE void remember_leap_frog(dem_data *d, int first, int end, double dt, const bool driven) {
  const v8 half = span(0.5 * dt);
  const field f = field_of(d, driven);
  for (int i = first; i < end; i++)
    store8(&d->state.memory[i], load8(&d->state.pace[i]) - half * of_all(d, i, d->state.push, &f, driven));
}

/* ---- stormer-verlet: memory is position before | angle of the last step ---- */

DEM_INLINE double begin_stormer(dem_data *d, int chunk, const dem_stride *stride, const bool driven) {
  const double dt = stride->dt;
  const v8 half = span(0.5 * dt), square = span(dt * dt), rate = span(1 / dt), place = drift_of(1);
  const field f = field_of(d, driven);
  travel moved = {{0}, {0}};
  EACH_PARTICLE(d, chunk, i) {
    v8 a = of_all(d, i, d->state.push, &f, driven);
    v8 x = load8(&d->state.sphere[i]), before = load8(&d->state.memory[i]);
    v8 way = join(x - before, before) + square * a; /* moved and turned in this step */
    v8 v = rate * way;
    store8(&d->state.memory[i], join(x, way));
    store8(&d->state.pace[i], v);
    put(d, i, x + place * way, v + half * a, stride->shift, &moved);
  }
  return farthest(&moved);
}

DEM_INLINE void end_stormer(dem_data *d, int chunk, double dt, const bool driven) {
  const v8 half = span(0.5 * dt), rate = span(1 / dt);
  const field f = field_of(d, driven);
  add_crossings(d, chunk);
  EACH_PARTICLE(d, chunk, i) {
    v8 before = load8(&d->state.memory[i]), way = join(load8(&d->state.sphere[i]) - before, before);
    store8(&d->state.pace[i], rate * way + half * of_all(d, i, d->state.push, &f, driven));
  }
}

DEM_INLINE void remember_stormer(dem_data *d, int first, int end, double dt, const bool driven) {
  const v8 half = span(0.5 * dt), whole = span(dt);
  const field f = field_of(d, driven);
  for (int i = first; i < end; i++) {
    v8 way = whole * (load8(&d->state.pace[i]) - half * of_all(d, i, d->state.push, &f, driven));
    store8(&d->state.memory[i], join(load8(&d->state.sphere[i]) - way, way));
  }
}

/* ---- multi-step: push has the fast forces in a substep, spare_push the slow ones ---- */

DEM_INLINE double begin_multi(dem_data *d, int chunk, const dem_stride *stride, const bool driven) {
  const v8 half = span(0.5 * stride->dt), drift = drift_of(stride->dt), lead = span(stride->lead);
  const field f = field_of(d, driven);
  travel moved = {{0}, {0}};
  EACH_PARTICLE(d, chunk, i) {
    v8 fast = of_contacts(&d->state.sphere[i], &d->state.push[i]), slow = of_all(d, i, d->state.spare_push, &f, driven);
    v8 a = half * (driven ? fast * f.free : fast);
    v8 v = load8(&d->state.pace[i]) + a;
    store8(&d->state.pace[i], v);
    put(d, i, load8(&d->state.sphere[i]) + drift * v, v + a + lead * slow, stride->shift, &moved);
  }
  return farthest(&moved);
}

DEM_INLINE void end_multi(dem_data *d, int chunk, double dt, const bool driven) {
  const v8 half = span(0.5 * dt);
  const field f = field_of(d, driven);
  add_crossings(d, chunk);
  EACH_PARTICLE(d, chunk, i) {
    v8 fast = of_contacts(&d->state.sphere[i], &d->state.push[i]);
    store8(&d->state.pace[i], load8(&d->state.pace[i]) + half * (driven ? fast * f.free : fast));
  }
}

DEM_INLINE void kick_multi(dem_data *d, int chunk, double dt, const bool driven) {
  const v8 half = span(0.5 * dt);
  const field f = field_of(d, driven);
  add_crossings(d, chunk);
  EACH_PARTICLE(d, chunk, i)
  store8(&d->state.pace[i], load8(&d->state.pace[i]) + half * of_all(d, i, d->state.push, &f, driven));
}

/* ---- the table ---- */

#define FUNCTIONS(name, suffix, driven)                                                  \
  static double name##_begin##suffix(dem_data *d, int chunk, const dem_stride *stride) { \
    return begin_##name(d, chunk, stride, driven);                                       \
  }                                                                                      \
  static void name##_end##suffix(dem_data *d, int chunk, double dt) {                    \
    end_##name(d, chunk, dt, driven);                                                    \
  }
#define REMEMBER(name, suffix, driven)                                              \
  static void name##_remember##suffix(dem_data *d, int first, int end, double dt) { \
    remember_##name(d, first, end, dt, driven);                                     \
  }
#define X(title, name, keeps) FUNCTIONS(name, , false) FUNCTIONS(name, _driven, true)
DEM_INTEGRATOR_LIST(X)
#undef X
REMEMBER(leap_frog, , false)
REMEMBER(leap_frog, _driven, true)
REMEMBER(stormer, , false)
REMEMBER(stormer, _driven, true)

static void multi_kick(dem_data *d, int chunk, double dt) {
  kick_multi(d, chunk, dt, false);
}

static void multi_kick_driven(dem_data *d, int chunk, double dt) {
  kick_multi(d, chunk, dt, true);
}

/* what not all integrators have */
#define verlet_optional(suffix) .remember = NULL
#define leap_frog_optional(suffix) .remember = leap_frog_remember##suffix
#define stormer_optional(suffix) .remember = stormer_remember##suffix
#define multi_optional(suffix) .kick = multi_kick##suffix
#define ROW(title, integrator, keeping, with, suffix) \
  {.name = title,                                     \
   .driven = with,                                    \
   .keeps = keeping,                                  \
   .begin = integrator##_begin##suffix,               \
   .end = integrator##_end##suffix,                   \
   integrator##_optional(suffix)},

const dem_integrator DEM_ISA(dem_integrators)[] = {
#define X(title, name, keeps) ROW(title, name, keeps, false, ) ROW(title, name, keeps, true, _driven)
    DEM_INTEGRATOR_LIST(X)
#undef X
        {0}};
