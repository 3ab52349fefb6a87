/* The contact loops, over pairs of particles and over particles and walls.
 *
 * One source, compiled once for each instruction set, in it once for each row of the table: the kernels are constants
 * of an always-inlined function, so no call and no branch on a law is left in a loop. DEM_W contacts go at a time, one
 * a lane, whether they touch or not; what does not touch adds nothing. Forces are added lane after lane, in the order
 * of the list, so the sums are those of a loop over one contact at a time.
 */
#include "dem/contact/loop.h"

#include "dem/contact/normal.h"
#include "dem/contact/tangential.h"
#include "dem/data.h"

typedef void normal_law(dem_contact *, vd *history);
typedef dem_tangential tangential_law(const dem_contact *, vd *history);

/* what comes out of a law */
typedef struct {
  vd3 force, twist; /* twist: normal x force */
} outcome;

/* The laws on DEM_W contacts; `velocity` is the relative velocity at the contact, `history` their slots at stride. */
DEM_KERNEL outcome law(dem_contact *c, vd3 velocity, double *history, size_t stride, const int ncolumn,
                       normal_law *normal, tangential_law *tangential) {
  vd away = vd3_dot(velocity, c->normal);
  c->rate = -away;
  c->slip = vd3_axpy(-away, c->normal, velocity);
  vd h[DEM_HISTORY_MAX];
  for (int q = 0; q < ncolumn; q++)
    h[q] = vd_load(history + (size_t)q * stride);
  normal(c, h);
  dem_tangential t = tangential(c, h);
  for (int q = 0; q < ncolumn; q++)
    vd_store(history + (size_t)q * stride, vd_only(c->touching, h[q]));
  vd3 twist = vd3_cross(c->normal, t.force);
  return (outcome){vd3_only(c->touching, vd3_axpy(c->force, c->normal, t.force)), vd3_only(c->touching, twist)};
}

DEM_INLINE void close_history(double *history, size_t stride, const int ncolumn) {
  for (int q = 0; q < ncolumn; q++)
    vd_store(history + (size_t)q * stride, vd_set(0));
}

/* fetch the partners to come; there is room behind the list */
DEM_INLINE void fetch_ahead(const dem_data *d, const int *j) {
  for (int l = 0; l < DEM_W; l++) {
    __builtin_prefetch(&d->sphere[j[l]]);
    __builtin_prefetch(&d->rotor[j[l]]);
    __builtin_prefetch(&d->push[j[l]], 1);
  }
}

DEM_KERNEL void pair_loop(dem_loop_task *task, const int ncolumn, normal_law *normal, tangential_law *tangential) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_pairs *list = &d->pairs;
  const dem_sphere *sphere = d->sphere;
  const dem_rotor *rotor = d->rotor;
  dem_push *push = d->push;
  dem_contact c = {.dt = task->dt};
  c.pair.table = task->settling ? m->settle_pair : m->pair;
  c.pair.one = m->nmaterial == 1;
  long touching = 0;
  const bool far = d->nparticle > 20000; /* more than a cache of the second level holds */

  for (size_t k = list->chunk[task->chunk]; k < list->chunk[task->chunk + 1]; k += DEM_W) {
    const int *i = list->one + k, *j = list->other + k;
    if (far)
      fetch_ahead(d, j + 2 * DEM_W);
    vd s[8], b[4];
    vd_sphere_difference(sphere, i, j, s);
    vd_rotor_sum(rotor, i, j, b);
    vd3 x = {s[0], s[1], s[2]};
    vd r2 = vd3_dot(x, x), sum = b[3];
    c.touching = vm_less(r2, sum * sum);
    if (!vm_any(c.touching)) {
      close_history(list->history + k, list->capacity, ncolumn);
      continue;
    }
    touching += __builtin_popcount(vm_bits(c.touching));
    /* one division for the three reciprocals of the distance, the sum of the radii and of the inverse masses */
    vd r = vd_sqrt(vd_max(r2, vd_set(1e-200))), both = r * sum;
    vd per_all = vd_set(1) / (both * s[7]), per_r = per_all * (sum * s[7]), per_sum = per_all * (r * s[7]);
    c.normal = vd3_scale(per_r, x);
    c.normal.z = vd_pick(vm_equal(r2, vd_set(0)), vd_set(1), c.normal.z); /* coincident centres: any direction */
    c.overlap = sum - r;
    c.radius = vd_set(0.25) * (sum * sum - s[3] * s[3]) * per_sum;
    c.mass = per_all * both;
    if (!c.pair.one)
      for (int l = 0; l < DEM_W; l++)
        c.pair.index[l] = d->kind[i[l]] * m->nmaterial + d->kind[j[l]];

    /* the contact divides the distance of the centres as the radii: arms r_i r / (r_i + r_j) */
    vd share = r * per_sum;
    vd3 surface = {b[0], b[1], b[2]};
    c.turn = vd3_dot(surface, c.normal) * per_sum;
    vd3 velocity = vd3_axpy(-share, vd3_cross(surface, c.normal), (vd3){s[4], s[5], s[6]});
    outcome out = law(&c, velocity, list->history + k, list->capacity, ncolumn, normal, tangential);
    vd3 twist = vd3_scale(share, out.twist);
    vd_push_pairs(push, i, list->sink + k, (vd[3]){out.force.x, out.force.y, out.force.z},
                  (vd[3]){twist.x, twist.y, twist.z});
  }
  task->touching += touching;
}

/* ---- walls ---- */

/* contacts of walls, gathered until there are DEM_W; columns */
typedef struct {
  double number[14][DEM_W];
  double history[DEM_HISTORY_MAX][DEM_W];
  int entry[DEM_W], body[DEM_W], index[DEM_W];
  tdm_vec3 lever[DEM_W];
  int count;
} batch;
enum { NX, NY, NZ, OVERLAP, VX, VY, VZ, TURN, RADIUS, PER_MASS, ARM };

DEM_KERNEL void wall_batch(dem_loop_task *task, batch *b, const int ncolumn, normal_law *normal,
                           tangential_law *tangential) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_wall_contacts *list = &d->walls;
  dem_contact c = {.dt = task->dt, .touching = vm_first(b->count)};
  c.pair.table = task->settling ? m->settle_pair : m->pair;
  c.pair.one = m->nmaterial == 1;
  memcpy(c.pair.index, b->index, sizeof b->index);
  double(*v)[DEM_W] = b->number;
  c.normal = (vd3){vd_load(v[NX]), vd_load(v[NY]), vd_load(v[NZ])};
  c.overlap = vd_load(v[OVERLAP]);
  c.radius = vd_load(v[RADIUS]);
  c.mass = vd_set(1) / vd_load(v[PER_MASS]);
  c.turn = vd_load(v[TURN]);
  vd3 velocity = {vd_load(v[VX]), vd_load(v[VY]), vd_load(v[VZ])};
  outcome out = law(&c, velocity, b->history[0], DEM_W, ncolumn, normal, tangential);

  double f[6][DEM_W];
  vd_store(f[0], out.force.x), vd_store(f[1], out.force.y), vd_store(f[2], out.force.z);
  vd_store(f[3], out.twist.x), vd_store(f[4], out.twist.y), vd_store(f[5], out.twist.z);
  for (int l = 0; l < b->count; l++) {
    size_t k = (size_t)b->entry[l];
    for (int q = 0; q < ncolumn; q++)
      list->history[(size_t)q * list->capacity + k] = b->history[q][l];
    dem_push *push = &d->push[list->entry[k].particle];
    tdm_vec3 force = {f[0][l], f[1][l], f[2][l]}, twist = {f[3][l], f[4][l], f[5][l]};
    push->force = tdm_add(push->force, force);
    push->twist = tdm_axpy(v[ARM][l], twist, push->twist);
    tdm_wrench *load = &d->chunk_load[task->chunk * m->nbody + b->body[l]];
    load->force = tdm_sub(load->force, force);
    load->moment = tdm_sub(load->moment, tdm_cross(b->lever[l], force));
  }
  task->touching += b->count;
  b->count = 0;
}

DEM_KERNEL void wall_loop(dem_loop_task *task, const int ncolumn, normal_law *normal, tangential_law *tangential) {
  const dem_model *m = task->model;
  dem_data *d = task->data;
  const dem_wall_contacts *list = &d->walls;
  batch b = {0};
  for (int l = 0; l < DEM_W; l++) /* lanes that stay empty compute with harmless numbers */
    b.number[RADIUS][l] = b.number[PER_MASS][l] = b.number[OVERLAP][l] = 1;

  for (size_t k = list->chunk[task->chunk]; k < list->chunk[task->chunk + 1]; k++) {
    int i = list->entry[k].particle, w = list->entry[k].wall;
    const dem_wall *wall = &m->wall[w];
    const dem_sphere *s = &d->sphere[i];
    tdm_vec3 n;
    double gap = dem_wall_gap(wall, &d->wall[w], s->position, &n);
    bool through = wall->primitive == DEM_PLANE && gap <= -s->radius;
    if (gap >= s->radius || through) {
      for (int q = 0; q < ncolumn; q++)
        list->history[(size_t)q * list->capacity + k] = 0;
      continue;
    }

    /* the contact point lies on the wall's surface */
    int body = wall->body, l = b.count++;
    tdm_vec3 point = tdm_axpy(-gap, n, s->position), lever = tdm_sub(point, d->pose[body].position);
    tdm_twist now = d->twist[body];
    tdm_vec3 wall_v = tdm_add(now.velocity, tdm_cross(now.angular, lever));
    double arm = gap / s->radius;
    tdm_vec3 v = tdm_sub(tdm_axpy(-arm, tdm_cross(d->rotor[i].surface, n), s->velocity), wall_v);
    /* a held body is immovable; a coupled one has its own mass */
    double per_mass = s->inverse_mass + (task->settling ? 0 : d->body_inverse[body]);
    const double numbers[] = {n.x,       n.y,      n.z, s->radius - gap, v.x, v.y, v.z, tdm_dot(now.angular, n),
                              s->radius, per_mass, arm};
    for (int q = 0; q <= ARM; q++)
      b.number[q][l] = numbers[q];
    for (int q = 0; q < ncolumn; q++)
      b.history[q][l] = list->history[(size_t)q * list->capacity + k];
    b.entry[l] = (int)k;
    b.body[l] = body;
    b.index[l] = d->kind[i] * m->nmaterial + m->body[body].material;
    b.lever[l] = lever;
    if (b.count == DEM_W)
      wall_batch(task, &b, ncolumn, normal, tangential);
  }
  if (b.count > 0)
    wall_batch(task, &b, ncolumn, normal, tangential);
}

#define X(normal, tangential, ncolumn, vectors)                                 \
  static void pairs_##normal##_##tangential(dem_loop_task *task) {              \
    pair_loop(task, ncolumn, dem_normal_##normal, dem_tangential_##tangential); \
  }                                                                             \
  static void walls_##normal##_##tangential(dem_loop_task *task) {              \
    wall_loop(task, ncolumn, dem_normal_##normal, dem_tangential_##tangential); \
  }
DEM_LAW_LIST(X)
#undef X

const dem_law DEM_ISA(dem_laws)[] = {
#define X(normal, tangential, ncolumn, vectors) \
  {#normal, #tangential, ncolumn, vectors, pairs_##normal##_##tangential, walls_##normal##_##tangential},
    DEM_LAW_LIST(X)
#undef X
        {0}};
