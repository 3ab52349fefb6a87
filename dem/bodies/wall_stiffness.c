/* Stiffness of the contacts of coupled bodies: see wall_stiffness.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/bodies/wall_stiffness.h"

#include "dem/contact/law/theory.h"
#include "dem/seam/homes.h"
#include "dem/seam/notes.h"
#include "dem/state/wall_gap.h"

#include <gsl/gsl_eigen.h>
#include <stdlib.h>
#include <string.h>

typedef double matrix6[6][6];

/* ---- the stiffness of each body's contacts ---- */

/* a spring k along e at the lever: K += k g g^T with g = (e, lever x e) */
static void add_spring(matrix6 K, double k, tdm_vec3 lever, tdm_vec3 e) {
  tdm_vec3 a = tdm_cross(lever, e);
  const double g[6] = {e.x, e.y, e.z, a.x, a.y, a.z};
  for (int i = 0; i < 6; i++)
    for (int j = 0; j < 6; j++)
      K[i][j] += k * g[i] * g[j];
}

/* k_n n n^T + k_t (I - n n^T) at the contact of a particle and a wall */
static void add_contact(const dem_data *d, matrix6 K, size_t entry, double gap, tdm_vec3 n) {
  const dem_model *m = d->model;
  const int particle = d->lists.walls.entry[entry].particle;
  const dem_wall *wall = &m->wall[d->lists.walls.entry[entry].wall];
  const dem_sphere *s = &d->state.sphere[particle];
  const int body = wall->body;
  const dem_pair *pair = &m->pair[d->state.material[particle] * m->nmaterial + wall->material];
  tdm_vec3 lever = tdm_sub(tdm_axpy(-gap, n, s->position), d->state.pose[body].position);
  dem_impact at = {.mass = 1 / dem_per_effective_mass(&d->state.mobility[body], s->inverse_mass, lever, n),
                   .radius = s->radius};
  dem_among among = {pair, at, s->radius - gap, particle, -1, dem_note_of_contact(d, entry)};
  double normal = dem_stiffness_among(d, m, &among);
  double tangential = dem_tangential_stiffness(m, pair, at, dem_overlap_among(d, m, &among));
  add_spring(K, normal - tangential, lever, n);
  add_spring(K, tangential, lever, tdm_v3(1, 0, 0));
  add_spring(K, tangential, lever, tdm_v3(0, 1, 0));
  add_spring(K, tangential, lever, tdm_v3(0, 0, 1));
}

/* the contacts of a particle with a wall: entries begin ... end of the list */
static void add_entries(const dem_data *d, size_t begin, size_t end, matrix6 K) {
  int i = d->lists.walls.entry[begin].particle, w = d->lists.walls.entry[begin].wall;
  const dem_wall *wall = &d->model->wall[w];
  const dem_wall_place *place = &d->state.wall[w];
  const dem_sphere *s = &d->state.sphere[i];
  if (s->inverse_mass == 0 && d->state.mobility[wall->body].per_mass == 0) /* as the loops leave it out */
    return;
  if (!wall->shape->touches) {
    tdm_vec3 n;
    double gap = dem_gap(d, i, w, &n);
    if (dem_wall_touches(wall, gap, s->radius))
      add_contact(d, K, begin, gap, n);
    return;
  }
  dem_touch found[DEM_TOUCHES_MAX];
  int many = wall->shape->touches(wall, &d->lists.walls.entry[begin].part, DEM_PART_STRIDE, (int)(end - begin),
                                  dem_wall_own(place, s->position), s->radius, found);
  for (int c = 0; c < many; c++)
    add_contact(d, K, begin, found[c].gap, tdm_m3_mul(place->axes, found[c].normal));
}

/* the contacts of a chunk; K: of each coupled body */
static void add_chunk(const dem_data *d, int chunk, matrix6 *K) {
  const dem_wall_contacts *list = &d->lists.walls;
  const size_t end = list->chunk[chunk + 1];
  for (size_t k = list->chunk[chunk], next; k < end; k = next) {
    const dem_wall_entry *e = &list->entry[k];
    for (next = k + 1; next < end && list->entry[next].wall == e->wall && list->entry[next].particle == e->particle;)
      next++;
    int coupled = d->model->body[d->model->wall[e->wall].body].coupled;
    if (coupled >= 0)
      add_entries(d, k, next, K[coupled]);
  }
}

/* Likewise of all chunks: sums in their order, the same on all ranks. */
static tdm_status add_walls(dem_data *d, matrix6 *K) {
  const size_t k = (size_t)d->model->ncoupled;
  matrix6 *of_chunk = calloc((size_t)d->lists.nchunk * k, sizeof *of_chunk);
  if (!of_chunk)
    return TDM_ERR_MEMORY;
  for (int c = dem_home_first(d); c < dem_home_end(d); c++)
    add_chunk(d, c, of_chunk + (size_t)c * k);
  dem_unite_chunks(d, of_chunk, k * sizeof *of_chunk);
  for (size_t c = 0; c < (size_t)d->lists.nchunk; c++)
    for (size_t q = 0; q < 36 * k; q++)
      ((double *)K)[q] += ((double *)(of_chunk + c * k))[q];
  free(of_chunk);
  return TDM_OK;
}

/* ---- the eigenvalue ---- */

/* K = L L^T of a positive semidefinite matrix, in place, L lower; of a direction without stiffness the column is 0 */
static void factor(matrix6 K) {
  for (int j = 0; j < 6; j++) {
    double whole = K[j][j], pivot = whole;
    for (int q = 0; q < j; q++)
      pivot -= K[j][q] * K[j][q];
    bool stiff = pivot > 1e-14 * whole;
    K[j][j] = stiff ? sqrt(pivot) : 0;
    for (int i = j + 1; i < 6; i++) {
      double sum = K[i][j];
      for (int q = 0; q < j; q++)
        sum -= K[i][q] * K[j][q];
      K[i][j] = stiff ? sum / K[j][j] : 0;
      K[j][i] = 0;
    }
  }
}

/* L^T J and B L of one body's rows of J and columns of B, in place */
static void scale_body(const matrix6 L, int nfree, double *J, double *B, size_t wide) {
  for (int f = 0; f < nfree; f++)
    for (int i = 0; i < 6; i++) { /* row i of L^T, column i of L: only rows below are needed later */
      double twist = 0, rate = 0;
      for (int q = i; q < 6; q++) {
        twist += L[q][i] * J[q * nfree + f];
        rate += B[(size_t)f * wide + (size_t)q] * L[q][i];
      }
      J[i * nfree + f] = twist;
      B[(size_t)f * wide + (size_t)i] = rate;
    }
}

/* Largest eigenvalue of the symmetric matrix J B (wide x wide); NaN: the matrix has NaN or infinite numbers. */
static tdm_status largest_eigen(int nfree, const double *J, const double *B, size_t wide, double *product,
                                double *value, double *out) {
  for (size_t i = 0; i < wide; i++)
    for (size_t j = 0; j < wide; j++) {
      double sum = 0;
      for (size_t f = 0; f < (size_t)nfree; f++)
        sum += J[i * (size_t)nfree + f] * B[f * wide + j];
      product[i * wide + j] = sum;
    }
  gsl_eigen_symm_workspace *work = gsl_eigen_symm_alloc(wide);
  if (!work)
    return TDM_ERR_MEMORY;
  gsl_matrix_view matrix = gsl_matrix_view_array(product, wide, wide);
  gsl_vector_view values = gsl_vector_view_array(value, wide);
  int status = gsl_eigen_symm(&matrix.matrix, &values.vector, work);
  gsl_eigen_symm_free(work);
  double largest = 0;
  for (size_t i = 0; i < wide; i++)
    largest = value[i] <= largest ? largest : value[i]; /* keeps a NaN */
  *out = status == GSL_SUCCESS ? largest : NAN;
  return TDM_OK;
}

/* The eigenvalues of B K J that are not 0 are those of L^T J B L, K = L L^T, which is symmetric. */
tdm_status dem_walls_rate2(dem_data *d, int nfree, const double *J, const double *B, double *rate2, tdm_error *err) {
  size_t k = (size_t)d->model->ncoupled, wide = 6 * k, many = wide * (size_t)nfree;
  *rate2 = 0;
  if (many == 0)
    return TDM_OK;
  matrix6 *K = calloc(k, sizeof *K);
  double *room = malloc((2 * many + wide * wide + wide) * sizeof *room);
  bool good = K && room && !add_walls(d, K);
  if (good) {
    double *left = room, *right = left + many, *product = right + many, *value = product + wide * wide;
    memcpy(left, J, many * sizeof *J);
    memcpy(right, B, many * sizeof *B);
    for (size_t c = 0; c < k; c++) {
      factor(K[c]);
      scale_body(K[c], nfree, left + 6 * c * (size_t)nfree, right + 6 * c, wide);
    }
    good = !largest_eigen(nfree, left, right, wide, product, value, rate2);
  }
  free(K);
  free(room);
  return good ? TDM_OK : tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the stiffness of the coupled bodies");
}
