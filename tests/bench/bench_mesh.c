/* The triangles near a point, and a sphere's contacts: microseconds a query over the size of a meshed plane. Not a
 * test. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/geometry/mesh/mesh.h"
#include "dem/geometry/mesh/mesh_contact.h"
#include "dem/geometry/mesh/mesh_tree.h"
#include "protocol/base/log.h"
#include "protocol/math/random.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

/* n x n squares of 1 m, two triangles each */
static dem_mesh *plane(int n) {
  tdm_stl s = {0, malloc(6 * (size_t)n * (size_t)n * sizeof *s.corner)};
  for (int i = 0; s.corner && i < n; i++)
    for (int j = 0; j < n; j++) {
      tdm_vec3 *to = &s.corner[3 * s.count];
      to[0] = to[3] = tdm_v3(i, j, 0);
      to[1] = tdm_v3(i + 1, j, 0);
      to[2] = to[4] = tdm_v3(i + 1, j + 1, 0);
      to[5] = tdm_v3(i, j + 1, 0);
      s.count += 2;
    }
  tdm_error err = {0};
  dem_mesh *mesh = s.corner ? dem_mesh_make(&s, "plane", DEM_MESH_FACET_ANGLE, "", &err) : NULL;
  free(s.corner);
  return mesh;
}

int main(void) {
  enum { QUERIES = 100000, ROOM = 64 };
  for (int n = 8; n <= 512; n *= 4) {
    dem_mesh *mesh = plane(n);
    if (!mesh)
      return EXIT_FAILURE;
    double near_time = 0, contact_time = 0;
    uint64_t draw = 1;
    for (int q = 0; q < QUERIES; q++) {
      double at[2];
      for (int a = 0; a < 2; a++)
        at[a] = 1 + (n - 2) * tdm_random_next(&draw);
      int near[ROOM];
      dem_touch contact[DEM_TOUCHES_MAX];
      tdm_vec3 x = {at[0], at[1], 0.9};
      double begin = tdm_clock();
      int many = dem_mesh_near(mesh, 0, x, 1, near, ROOM);
      double middle = tdm_clock();
      dem_mesh_contacts(mesh, near, 1, many, x, 1, contact, DEM_TOUCHES_MAX);
      near_time += middle - begin;
      contact_time += tdm_clock() - middle;
    }
    printf("%8d triangles  near %.2f us  contacts %.2f us\n", 2 * n * n, 1e6 * near_time / QUERIES,
           1e6 * contact_time / QUERIES);
    dem_mesh_destroy(&mesh);
  }
  return EXIT_SUCCESS;
}
