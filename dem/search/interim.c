/* interim: replaced by the searches */
#include "dem/search/search.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
struct dem_search {
  int *cell, *particle, *first;
  size_t np, nc;
};
dem_search *dem_search_create(const char *name) {
  (void)name;
  return calloc(1, sizeof(dem_search));
}
void dem_search_destroy(dem_search **s) {
  if (!*s)
    return;
  free((*s)->cell);
  free((*s)->particle);
  free((*s)->first);
  free(*s);
  *s = NULL;
}
void dem_rows_free(dem_rows *r) {
  free(r->first);
  free(r->other);
  *r = (dem_rows){0};
}
static int cmp(const void *a, const void *b) {
  return *(const int *)a - *(const int *)b;
}
bool dem_search_run(dem_search *s, const dem_search_input *in, dem_rows *r) {
  int n = in->n;
  double size = 0, lo[3] = {1e300, 1e300, 1e300}, hi[3] = {-1e300, -1e300, -1e300};
  for (int i = 0; i < n; i++) {
    size = fmax(size, 2 * in->sphere[i].radius);
    const double *x = &in->sphere[i].position.x;
    for (int a = 0; a < 3; a++) {
      lo[a] = fmin(lo[a], x[a]);
      hi[a] = fmax(hi[a], x[a]);
    }
  }
  size += in->skin;
  int c[3];
  for (int a = 0; a < 3; a++) {
    double m = (hi[a] - lo[a]) / size + 1;
    c[a] = m >= 1 && m < 200 ? (int)m : m >= 200 ? 200 : 1;
  }
  size_t nc = (size_t)c[0] * c[1] * c[2];
  s->cell = realloc(s->cell, (n + 1) * 4);
  s->particle = realloc(s->particle, (n + 1) * 4);
  s->first = realloc(s->first, (nc + 2) * 4);
  r->first = realloc(r->first, (n + 1) * 4);
  memset(s->first, 0, (nc + 2) * 4);
#define B(i, a) ((int)fmax(0, fmin(c[a] - 1, floor(((&in->sphere[i].position.x)[a] - lo[a]) / size))))
  for (int i = 0; i < n; i++) {
    s->cell[i] = (B(i, 2) * c[1] + B(i, 1)) * c[0] + B(i, 0);
    s->first[s->cell[i] + 2]++;
  }
  for (size_t k = 1; k <= nc; k++)
    s->first[k + 1] += s->first[k];
  for (int i = 0; i < n; i++)
    s->particle[s->first[s->cell[i] + 1]++] = i;
  r->count = 0;
  for (int i = 0; i < n; i++) {
    r->first[i] = (int)r->count;
    int b[3] = {B(i, 0), B(i, 1), B(i, 2)};
    if (r->capacity < r->count + 1000) {
      r->capacity = 2 * r->capacity + 4000;
      r->other = realloc(r->other, r->capacity * 4);
    }
    for (int z = b[2] - 1; z <= b[2] + 1; z++)
      for (int y = b[1] - 1; y <= b[1] + 1; y++)
        for (int x = b[0] - 1; x <= b[0] + 1; x++) {
          if (x < 0 || y < 0 || z < 0 || x >= c[0] || y >= c[1] || z >= c[2])
            continue;
          int cc = (z * c[1] + y) * c[0] + x;
          for (int k = s->first[cc]; k < s->first[cc + 1]; k++) {
            int j = s->particle[k];
            if (j <= i)
              continue;
            tdm_vec3 d = tdm_sub(in->sphere[i].position, in->sphere[j].position);
            double q = in->sphere[i].radius + in->sphere[j].radius + in->skin;
            if (tdm_dot(d, d) < q * q)
              r->other[r->count++] = j;
          }
        }
    qsort(r->other + r->first[i], r->count - r->first[i], 4, cmp);
  }
  r->first[n] = (int)r->count;
  return true;
}
