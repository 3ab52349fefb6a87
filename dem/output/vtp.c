/* Particles and walls for ParaView: see vtp.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/output/vtp.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "arrays are written as they lie in memory, which must be little-endian"
#endif

/* ---- base64 (RFC 4648) ---- */

typedef struct {
  FILE *file;
  uint8_t rest[3];
  int nrest;
} encoder;

static void put_group(encoder *e) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const uint8_t *b = e->rest;
  char out[4] = {digits[b[0] >> 2], digits[(b[0] & 3) << 4 | b[1] >> 4], digits[(b[1] & 15) << 2 | b[2] >> 6],
                 digits[b[2] & 63]};
  for (int k = e->nrest + 1; k < 4; k++)
    out[k] = '=';
  fwrite(out, 1, 4, e->file);
  memset(e->rest, 0, sizeof e->rest);
  e->nrest = 0;
}

static void encode(encoder *e, const void *bytes, size_t n) {
  const uint8_t *p = bytes;
  for (size_t i = 0; i < n; i++) {
    e->rest[e->nrest++] = p[i];
    if (e->nrest == 3)
      put_group(e);
  }
}

/* One DataArray: `n` tuples of `components` numbers of `size` bytes. */
static void write_array(FILE *f, const char *type, const char *name, int components, const void *values, size_t n,
                        size_t size) {
  uint64_t bytes = (uint64_t)n * (uint64_t)components * size;
  encoder e = {.file = f};
  fprintf(f, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"binary\">\n", type, name,
          components);
  encode(&e, &bytes, sizeof bytes);
  encode(&e, values, (size_t)bytes);
  if (e.nrest > 0)
    put_group(&e);
  fputs("\n</DataArray>\n", f);
}

/* ---- files ---- */

static const char head[] = "<?xml version=\"1.0\"?>\n"
                           "<VTKFile type=\"%s\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n";

static FILE *open_vtp(const tdm_results *r, const char *what, int number, char name[64], tdm_error *err) {
  snprintf(name, 64, "%s_%06d.vtp", what, number);
  FILE *f = tdm_results_file(r, name, err);
  if (f)
    fprintf(f, head, "PolyData");
  return f;
}

static tdm_status close_file(const tdm_results *r, const char *name, FILE *f, tdm_error *err) {
  bool bad = ferror(f);
  if (fclose(f) != 0 || bad)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s/%s: cannot be written: %s", r->dir, name, strerror(errno));
  return err->status;
}

tdm_status dem_vtp_particles(const tdm_results *r, int number, const dem_snapshot *s, tdm_error *err) {
  char name[64];
  size_t n = (size_t)s->count;
  int64_t *index = malloc((2 * n + 1) * sizeof *index);
  FILE *f = index ? open_vtp(r, "particles", number, name, err) : NULL;
  if (!f) {
    free(index);
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d particles", s->count);
  }
  for (size_t i = 0; i < n; i++) { /* vertex i is point i; it ends at i + 1 */
    index[i] = (int64_t)i;
    index[n + i] = (int64_t)i + 1;
  }
  fprintf(f, "<PolyData>\n<Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"%zu\">\n<PointData Scalars=\"radius\">\n", n,
          n);
  write_array(f, "Float64", "radius", 1, s->radius, n, sizeof(double));
  write_array(f, "Float64", "velocity", 3, s->velocity, n, sizeof(double));
  write_array(f, "Float64", "spin", 3, s->spin, n, sizeof(double));
  write_array(f, "Int64", "id", 1, s->id, n, sizeof(int64_t));
  write_array(f, "Int32", "material", 1, s->material, n, sizeof(int32_t));
  fputs("</PointData>\n<Points>\n", f);
  write_array(f, "Float64", "position", 3, s->position, n, sizeof(double));
  fputs("</Points>\n<Verts>\n", f);
  write_array(f, "Int64", "connectivity", 1, index, n, sizeof(int64_t));
  write_array(f, "Int64", "offsets", 1, index + n, n, sizeof(int64_t));
  fputs("</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n", f);
  free(index);
  return close_file(r, name, f, err);
}

/* force, pressure and shear of each polygon */
static tdm_status write_forces(FILE *f, const dem_polygons *all) {
  size_t n = (size_t)all->count;
  tdm_vec3 *force = malloc((2 * n + 1) * sizeof *force), *shear = force ? force + n : NULL;
  double *pressure = malloc((n + 1) * sizeof *pressure);
  bool good = force && pressure;
  for (size_t i = 0; i < n && good; i++) {
    const dem_polygon *p = &all->polygon[i];
    tdm_vec3 twice = tdm_cross(tdm_sub(p->corner[1], p->corner[0]), tdm_sub(p->corner[2], p->corner[0]));
    double per_area = 2 / tdm_norm(twice); /* of a triangle; the others have no force */
    tdm_vec3 normal = tdm_unit(twice), traction = tdm_scale(per_area, p->force);
    force[i] = p->force;
    pressure[i] = -tdm_dot(traction, normal);
    shear[i] = tdm_axpy(pressure[i], normal, traction);
  }
  if (good) {
    write_array(f, "Float64", "force", 3, force, n, sizeof(double));
    write_array(f, "Float64", "pressure", 1, pressure, n, sizeof(double));
    write_array(f, "Float64", "shear", 3, shear, n, sizeof(double));
  }
  free(force);
  free(pressure);
  return good ? TDM_OK : TDM_ERR_MEMORY;
}

tdm_status dem_vtp_walls(const tdm_results *r, int number, const dem_polygons *all, tdm_error *err) {
  char name[64];
  size_t npolygon = (size_t)all->count, npoint = 0;
  tdm_vec3 *point = malloc((npolygon * DEM_CORNERS_MAX + 1) * sizeof *point);
  int64_t *index = malloc((npolygon * (DEM_CORNERS_MAX + 1) + 1) * sizeof *index);
  int32_t *body = malloc((npolygon + 1) * sizeof *body);
  FILE *f = point && index && body ? open_vtp(r, "walls", number, name, err) : NULL;
  if (f) {
    int64_t *end = index + npolygon * DEM_CORNERS_MAX;
    for (size_t i = 0; i < npolygon; i++) {
      const dem_polygon *p = &all->polygon[i];
      for (int k = 0; k < p->ncorner; k++, npoint++) {
        point[npoint] = p->corner[k];
        index[npoint] = (int64_t)npoint;
      }
      end[i] = (int64_t)npoint;
      body[i] = p->body;
    }
    fprintf(f, "<PolyData>\n<Piece NumberOfPoints=\"%zu\" NumberOfPolys=\"%zu\">\n<CellData Scalars=\"body\">\n",
            npoint, npolygon);
    write_array(f, "Int32", "body", 1, body, npolygon, sizeof(int32_t));
    if (all->forces && write_forces(f, all))
      tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d walls", all->count);
    fputs("</CellData>\n<Points>\n", f);
    write_array(f, "Float64", "position", 3, point, npoint, sizeof(double));
    fputs("</Points>\n<Polys>\n", f);
    write_array(f, "Int64", "connectivity", 1, index, npoint, sizeof(int64_t));
    write_array(f, "Int64", "offsets", 1, end, npolygon, sizeof(int64_t));
    fputs("</Polys>\n</Piece>\n</PolyData>\n</VTKFile>\n", f);
    close_file(r, name, f, err);
  } else {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d walls", all->count);
  }
  free(point);
  free(index);
  free(body);
  return err->status;
}

tdm_status dem_pvd_write(const tdm_results *r, const double *times, int number, tdm_error *err) {
  FILE *f = tdm_results_file(r, "scene.pvd", err);
  if (!f)
    return err->status;
  fprintf(f, head, "Collection");
  fputs("<Collection>\n", f);
  for (int k = 0; k < number; k++)
    fprintf(f,
            "<DataSet timestep=\"%.12g\" part=\"0\" name=\"particles\" file=\"particles_%06d.vtp\"/>\n"
            "<DataSet timestep=\"%.12g\" part=\"1\" name=\"walls\" file=\"walls_%06d.vtp\"/>\n",
            times[k], k, times[k], k);
  fputs("</Collection>\n</VTKFile>\n", f);
  return close_file(r, "scene.pvd", f, err);
}
