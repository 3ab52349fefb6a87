/* Who is at home, who visits, which forces return: the ten particles of [A07] Fig. 3.12 on three ranks. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "test_dem_support.h"

#include "dem/exchange/balance.h"
#include "dem/particles/particles.h"
#include "dem/seam/visits.h"
#include "test_ranks_support.h"
#include "tests/test_main.h"

/* The figure gives the homes and the halos (Eq. 3.15, 3.16) and no coordinates: these have the same, on slices of 1 m
 * along x. Particle g of the figure is number at[g] here: the homes are the chunks, which others fill up that touch
 * nothing. */
static const double radius = 0.1, stiffness = 1000;
static const double x[10] = {0.3, 2.5, 1.5, 0.76, 2.06, 0.95, 1.9, 1.14, 2.06, 2.5},
                    z[10] = {0.5, 0.5, 0.2, 0.9, 0.6, 0.9, 0.5, 0.9, 0.41, 0.69};
static const int home[3][4] = {{0, 3, 5, -1}, {2, 6, 7, -1}, {1, 4, 8, 9}}; /* Eq. 3.15 */

/* number of the figure's particle g */
static int at(int g) {
  for (int r = 0; r < 3; r++)
    for (int k = 0; k < 4; k++)
      if (home[r][k] == g)
        return r * DEM_CHUNK + k;
  return -1;
}

/* an entry of dem.particles with the home of rank r */
static const char *entry(char *text, size_t size, int r) {
  int n = snprintf(text, size, "{'type':'list','material':'a','mass':1,'radius':%g,'positions':[", radius);
  for (int k = 0; k < 4 && home[r][k] >= 0; k++)
    n += snprintf(text + n, size - (size_t)n, "%s[%g,0,%g]", k ? "," : "", x[home[r][k]], z[home[r][k]]);
  snprintf(text + n, size - (size_t)n, "]}");
  return text;
}

static json_t *figure(void) {
  char text[3][512];
  static const char more[] = "{'type':'block','material':'a','mass':1,'radius':0.1,'count':[5,409,1],'corner':[0,%d,0],"
                             "'spacing':1}";
  char fill[2][256];
  snprintf(fill[0], sizeof fill[0], more, 10);
  snprintf(fill[1], sizeof fill[1], more, 1000);
  return scene_json("{'gravity':[0,0,0],'skin':0.005,'contact':{'normal':'hooke','tangential':'none'},'materials':[{"
                    "'name':'a','density':1000}],'pairs':[{'materials':['a','a'],'stiffness':%g,'damping':0}],"
                    "'particles':[%s,%s,%s,%s,%s]}",
                    stiffness, entry(text[0], sizeof text[0], 0), fill[0], entry(text[1], sizeof text[1], 1), fill[1],
                    entry(text[2], sizeof text[2], 2));
}

/* force of b on a [N] */
static tdm_vec3 force(int a, int b) {
  const tdm_vec3 r = {x[a] - x[b], 0, z[a] - z[b]};
  const double d = tdm_norm(r);
  return d < 2 * radius ? tdm_scale(stiffness * (2 * radius - d) / d, r) : tdm_v3(0, 0, 0);
}

/* what the home rank of a finds itself (f of Eq. 3.19), and what returns from the rank before (s of Eq. 3.20) */
static void expected(int a, tdm_vec3 *f, tdm_vec3 *s) {
  const int of = at(a) / DEM_CHUNK;
  *f = *s = tdm_v3(0, 0, 0);
  for (int b = 0; b < 10; b++)
    if (b != a && at(b) / DEM_CHUNK >= of)
      *f = tdm_add(*f, force(a, b));
    else if (b != a)
      *s = tdm_add(*s, force(a, b));
}

/* A rig with the particles in the order of their ids: the engine would put them in that of their places. */
static rig *make(json_t *scene) {
  rig *r = rig_make(json_deep_copy(scene), 1e-4, 0, NULL);
  dem_data *d = r->data;
  int *from = calloc((size_t)d->state.nparticle, sizeof *from);
  for (int i = 0; i < d->state.nparticle; i++)
    from[d->state.id[i]] = i;
  ck_assert(!dem_data_permute(d, from));
  free(from);
  d->lists.valid = false;
  d->state.since_sort = 0;
  forces_now(d, false);
  return r;
}

/* are the parcels for rank r these particles of the figure? */
static void ck_parcels(const dem_parcels *p, int r, int n, const int *particle) {
  ck_assert_int_eq(p->first[r + 1] - p->first[r], n);
  for (int k = 0; k < n; k++)
    ck_assert_int_eq(p->item[p->first[r] + k], at(particle[k]));
}

static void look(const dem_ranks *ranks, void *context) {
  static const int visit_first[] = {7}, visit_second[] = {4, 8}; /* Eq. 3.16, 3.17 */
  rig *r = make(context);
  dem_data *d = r->data;
  const int rank = ranks->rank;
  dem_homes_begin(d, ranks);
  memset(d->lists.pairs.first, 0x7f, (size_t)(d->state.nparticle + 1) * sizeof *d->lists.pairs.first);
  forces_now(d, false);
  const dem_homes *h = &d->work.homes;

  /* rows of home particles, the last one with its end */
  for (int i = dem_home_first_particle(d); i < dem_home_end_particle(d); i++)
    ck_assert_int_le(d->lists.pairs.first[i], d->lists.pairs.first[i + 1]);
  ck_assert_int_eq(d->lists.pairs.first[dem_home_end_particle(d)], (int)d->lists.pairs.chunk[dem_home_end(d)]);

  /* homes, Eq. 3.15 */
  ck_assert_int_eq(d->lists.nchunk, 3);
  ck_assert(dem_home_first(d) == rank && dem_home_end(d) == rank + 1);
  ck_assert_int_eq(dem_home_end_particle(d) - dem_home_first_particle(d), rank < 2 ? DEM_CHUNK : 4);

  /* immigrants and visitors, Eq. 3.16 and 3.17; reactions return the other way */
  for (int q = 0; q < 3; q++) {
    ck_parcels(&h->immigrants, q,
               rank == 1 && q == 0   ? 1
               : rank == 2 && q == 1 ? 2
                                     : 0,
               rank == 1 ? visit_first : visit_second);
    ck_parcels(&h->visitors, q,
               rank == 0 && q == 1   ? 1
               : rank == 1 && q == 2 ? 2
                                     : 0,
               rank == 0 ? visit_first : visit_second);
  }
  ck_assert_int_eq(h->returning.first[3], rank < 2 ? rank + 1 : 0);
  ck_assert_int_eq(h->returned.first[3], rank);

  /* contacts: of two visitors (4 and 8 at rank 2's neighbour) only at their home, Eq. 3.18; forces, Eq. 3.21 */
  for (int k = 0; k < 4 && home[rank][k] >= 0; k++) {
    tdm_vec3 f, s;
    const int g = home[rank][k];
    expected(g, &f, &s);
    ck_vector(d->state.push[at(g)].force, tdm_add(f, s), 1e-9);
    ck_assert_int_eq(tdm_norm(s) > 0, g == 7 || g == 4 || g == 8);
  }
  ck_assert_int_eq(d->state.ncontact, 6);
  rig_free(r);
}

START_TEST(ten_particles_of_the_figure) {
  json_t *scene = figure();
  each_rank(3, look, scene);
  json_decref(scene);
}
END_TEST

/* the figure on a rank, after a step */
static rig *begun(const dem_ranks *ranks, const rig *of) {
  rig *r = make(of->json);
  dem_homes_begin(r->data, ranks);
  forces_now(r->data, false);
  rig_steps(r, 1);
  return r;
}

/* all particles have the bits that they have in a process that is alone */
static void ck_as_alone(dem_data *d, const dem_data *alone) {
  dem_unite(d, DEM_WHOLE);
  ck_assert_mem_eq(d->state.push, alone->state.push, (size_t)d->state.nparticle * sizeof *d->state.push);
  ck_assert_mem_eq(d->state.pace, alone->state.pace, (size_t)d->state.nparticle * sizeof *d->state.pace);
}

/* A step: visitors come with the places that they have at home then, and no place between chunks keeps a reaction. */
static void step(const dem_ranks *ranks, void *context) {
  const dem_data *alone = ((const rig *)context)->data;
  rig *r = begun(ranks, context);
  dem_data *d = r->data;
  for (int k = 0; k < d->work.homes.visitors.first[ranks->size]; k++) {
    const int j = d->work.homes.visitors.item[k];
    ck_assert_mem_eq(&d->state.sphere[j], &alone->state.sphere[j], sizeof(dem_sphere));
  }
  for (size_t p = (size_t)d->state.nparticle; p < (size_t)(d->state.nparticle + 1 + d->lists.crossings.count); p++)
    ck_assert(d->state.push[p].force.x == 0 && d->state.push[p].force.z == 0);
  ck_as_alone(d, alone);
  rig_free(r);
}

START_TEST(visitors_of_a_step) {
  json_t *scene = figure();
  rig *alone = make(scene);
  rig_steps(alone, 1);
  for (int size = 2; size <= 5; size++)
    each_rank(size, step, alone);
  rig_free(alone);
  json_decref(scene);
}
END_TEST

/* Homes move to where chunks cost alike; the steps after that have the same bits. */
static void balance(const dem_ranks *ranks, void *context) {
  static const double cost[3] = {4000, 1000, 1000}; /* of the chunks [s]; the steps' own time is nothing beside it */
  rig *r = begun(ranks, context);
  dem_data *d = r->data;
  const bool two = ranks->size == 2;
  for (int c = dem_home_first(d); c < dem_home_end(d); c++)
    d->work.homes.cost[c] = cost[c];
  ck_assert_int_eq(dem_chunk_of_rank(d, 1), two ? 2 : 1);
  rig_steps(r, 1);
  ck_assert_double_eq_tol(dem_homes_imbalance(d), (two ? 5000 : 4000) / (6000.0 / ranks->size) - 1, 0.01);
  d->lists.stale = true; /* lists are made, and homes looked at */
  rig_steps(r, 1);
  ck_assert_int_eq(d->work.homes.nmove, two); /* with more, the first chunk alone is the most */
  ck_assert_int_eq(dem_chunk_of_rank(d, 1), 1);
  ck_assert_int_eq(dem_chunk_of_rank(d, ranks->size), 3);
  rig_steps(r, 1);
  ck_as_alone(d, ((const rig *)context)->data);
  rig_free(r);
}

START_TEST(homes_that_move) {
  json_t *scene = figure();
  json_object_set_new(scene, "decomposition", json_pack("{s:{s:i}}", "balance", "every", 1));
  rig *alone = make(scene);
  rig_steps(alone, 4);
  for (int size = 2; size <= 5; size++)
    each_rank(size, balance, alone);
  rig_free(alone);
  json_decref(scene);
}
END_TEST

TEST_MAIN("dem_homes", ten_particles_of_the_figure, visitors_of_a_step, homes_that_move)
