/* What there is to see for ParaView: see vtp.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/output/vtp.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "arrays are written as they lie in memory, which must be little-endian"
#endif

/* ---- base64 (RFC 4648) ---- */

enum { ENCODER_GROUPS = 1024 };

typedef struct {
  FILE *file;
  uint8_t rest[3];
  int nrest, ngroup;
  char text[4 * ENCODER_GROUPS];
} encoder;

static void put_group(encoder *e, const uint8_t b[3]) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  char *out = e->text + 4 * e->ngroup++;
  out[0] = digits[b[0] >> 2];
  out[1] = digits[(b[0] & 3) << 4 | b[1] >> 4];
  out[2] = digits[(b[1] & 15) << 2 | b[2] >> 6];
  out[3] = digits[b[2] & 63];
  if (e->ngroup == ENCODER_GROUPS) {
    fwrite(e->text, 4, ENCODER_GROUPS, e->file);
    e->ngroup = 0;
  }
}

static void encode(encoder *e, const void *bytes, size_t n) {
  const uint8_t *p = bytes, *stop = p + n;
  for (; p < stop && e->nrest > 0;) {
    e->rest[e->nrest++] = *p++;
    if (e->nrest == 3) {
      put_group(e, e->rest);
      e->nrest = 0;
    }
  }
  for (; stop - p >= 3; p += 3)
    put_group(e, p);
  while (p < stop)
    e->rest[e->nrest++] = *p++;
}

static void end_text(encoder *e) {
  const int nrest = e->nrest;
  if (nrest > 0) {
    memset(e->rest + nrest, 0, (size_t)(3 - nrest));
    if (e->ngroup == ENCODER_GROUPS - 1) { /* so that the last one stays to be changed */
      fwrite(e->text, 4, (size_t)e->ngroup, e->file);
      e->ngroup = 0;
    }
    put_group(e, e->rest);
    memset(e->text + 4 * e->ngroup - (3 - nrest), '=', (size_t)(3 - nrest));
  }
  fwrite(e->text, 4, (size_t)e->ngroup, e->file);
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
  end_text(&e);
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

/* A file that cannot be written to its end goes. */
static tdm_status close_file(const tdm_results *r, const char *name, FILE *f, tdm_error *err) {
  char path[4352];
  bool bad = ferror(f);
  if (fclose(f) == 0 && !bad)
    return err->status;
  tdm_fail(err, TDM_ERR_FILE, NULL, "%s/%s: cannot be written: %s", r->dir, name, strerror(errno));
  unlink(tdm_results_path(r, name, path, sizeof path));
  return err->status;
}

static tdm_status write_particles(const tdm_results *r, int number, const tdm_snapshot *s, tdm_error *err) {
  char name[64];
  size_t n = (size_t)s->nparticle;
  int64_t *index = malloc((2 * n + 1) * sizeof *index);
  if (!index)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d particles", s->nparticle);
  for (size_t i = 0; i < n; i++) { /* vertex i is point i; it ends at i + 1 */
    index[i] = (int64_t)i;
    index[n + i] = (int64_t)i + 1;
  }
  FILE *f = open_vtp(r, "particles", number, name, err);
  if (f) {
    fprintf(f, "<PolyData>\n<Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"%zu\">\n<PointData Scalars=\"radius\">\n", n,
            n);
    write_array(f, "Float64", "radius", 1, s->radius, n, sizeof(double));
    write_array(f, "Float64", "velocity", 3, s->velocity, n, sizeof(double));
    write_array(f, "Float64", "spin", 3, s->spin, n, sizeof(double));
    if (s->norientation > 0)
      write_array(f, "Float64", "orientation", 4, s->orientation, n, sizeof(double));
    write_array(f, "Int64", "id", 1, s->id, n, sizeof(int64_t));
    write_array(f, "Int32", "material", 1, s->material, n, sizeof(int32_t));
    write_array(f, "Float64", "force", 3, s->force, n, sizeof(double));
    write_array(f, "Int32", "size_class", 1, s->size_class, n, sizeof(int32_t));
    fputs("</PointData>\n<Points>\n", f);
    write_array(f, "Float64", "position", 3, s->position, n, sizeof(double));
    fputs("</Points>\n<Verts>\n", f);
    write_array(f, "Int64", "connectivity", 1, index, n, sizeof(int64_t));
    write_array(f, "Int64", "offsets", 1, index + n, n, sizeof(int64_t));
    fputs("</Verts>\n</Piece>\n</PolyData>\n</VTKFile>\n", f);
    close_file(r, name, f, err);
  }
  free(index);
  return err->status;
}

/* ---- contacts ---- */

static void write_contact_arrays(FILE *f, const tdm_snapshot *s, tdm_vec3 *point, double *force, int64_t *index) {
  const size_t n = (size_t)s->ncontact;
  for (size_t k = 0; k < n; k++) {
    force[k] = s->contact[k].force;
    index[k] = s->contact[k].particle;
    index[n + k] = s->contact[k].other;
  }
  fprintf(f, "<PolyData>\n<Piece NumberOfPoints=\"%zu\" NumberOfLines=\"%zu\">\n<CellData Scalars=\"normal_force\">\n",
          2 * n, n);
  write_array(f, "Float64", "normal_force", 1, force, n, sizeof(double));
  write_array(f, "Int64", "particle", 1, index, n, sizeof(int64_t));
  write_array(f, "Int64", "other", 1, index + n, n, sizeof(int64_t));
  for (size_t k = 0; k < n; k++) {
    point[2 * k] = s->contact[k].from;
    point[2 * k + 1] = s->contact[k].to;
  }
  fputs("</CellData>\n<Points>\n", f);
  write_array(f, "Float64", "position", 3, point, 2 * n, sizeof(double));
  fputs("</Points>\n<Lines>\n", f);
  for (size_t k = 0; k < 2 * n; k++)
    index[k] = (int64_t)k;
  write_array(f, "Int64", "connectivity", 1, index, 2 * n, sizeof(int64_t));
  for (size_t k = 0; k < n; k++) /* line k ends before point 2 k + 2 */
    index[k] = 2 * (int64_t)k + 2;
  write_array(f, "Int64", "offsets", 1, index, n, sizeof(int64_t));
  fputs("</Lines>\n</Piece>\n</PolyData>\n</VTKFile>\n", f);
}

static tdm_status write_contacts(const tdm_results *r, int number, const tdm_snapshot *s, tdm_error *err) {
  char name[64];
  const size_t n = (size_t)s->ncontact;
  tdm_vec3 *point = calloc(2 * n + 1, sizeof *point);
  double *force = calloc(n + 1, sizeof *force);
  int64_t *index = calloc(2 * n + 1, sizeof *index);
  if (!point || !force || !index)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d contacts", s->ncontact);
  FILE *f = err->status == TDM_OK ? open_vtp(r, "contacts", number, name, err) : NULL;
  if (f) {
    write_contact_arrays(f, s, point, force, index);
    close_file(r, name, f, err);
  }
  free(point);
  free(force);
  free(index);
  return err->status;
}

/* ---- cells ---- */

/* Points, and cells of each of three kinds, in VTK's order: vertices, lines, polygons. */
enum { VERTS, LINES, POLYS, NKIND };

typedef struct {
  int npoint, ncell[NKIND];
  tdm_vec3 *point;
  int64_t *end[NKIND];  /* (ncell) points up to the end of each */
  int32_t *body;        /* (all cells) -1: a line */
  int32_t *line, *kind; /* (all cells) -1: a body */
} cells;

static void free_cells(cells *c) {
  free(c->point);
  for (int k = 0; k < NKIND; k++)
    free(c->end[k]);
  free(c->body);
  free(c->line);
  free(c->kind);
}

static bool allocate(cells *c, size_t npoint, size_t ncell) {
  *c = (cells){0};
  c->point = malloc((npoint + 1) * sizeof *c->point);
  bool all = c->point;
  for (int k = 0; k < NKIND; k++)
    all = (c->end[k] = malloc((ncell + 1) * sizeof *c->end[k])) && all;
  c->body = malloc((ncell + 1) * sizeof *c->body);
  c->line = malloc((ncell + 1) * sizeof *c->line);
  c->kind = malloc((ncell + 1) * sizeof *c->kind);
  return all && c->body && c->line && c->kind;
}

/* The points since the last cell are one of this kind. Cells come kind by kind. */
static void end_cell(cells *c, int which, int body, int line, int kind) {
  const int k = c->ncell[VERTS] + c->ncell[LINES] + c->ncell[POLYS];
  c->end[which][c->ncell[which]++] = c->npoint;
  c->body[k] = body;
  c->line[k] = line;
  c->kind[k] = kind;
}

static void add_line(cells *c, const tdm_scenery *scenery, const tdm_snapshot *s, int k, int which) {
  const int first = k > 0 ? s->line_end[k - 1] : 0, n = s->line_end[k] - first;
  if (n == 0 || (n == 1) != (which == VERTS))
    return;
  for (int i = first; i < first + n; i++)
    c->point[c->npoint++] = s->point[i];
  end_cell(c, which, -1, k, (int)scenery->line[k].kind);
}

/* Polygons, and with `lines` also marks and lines, of the bodies that DEM computes with, or of the others. */
static tdm_status make_cells(cells *c, const tdm_scenery *scenery, const tdm_snapshot *s, bool dem, tdm_error *err) {
  const size_t npolygon = (size_t)scenery->npolygon, nbody = (size_t)scenery->nbody, nline = (size_t)scenery->nline;
  if (!allocate(c, npolygon * TDM_VIEW_CORNERS_MAX + nbody + (size_t)s->npoint, npolygon + nbody + nline))
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d polygons and %d lines",
                    scenery->npolygon, scenery->nline);
  for (int b = 0; b < scenery->nbody && !dem; b++)
    if (scenery->body[b].marked && !scenery->body[b].dem) {
      c->point[c->npoint++] = s->pose[b].position;
      end_cell(c, VERTS, b, -1, -1);
    }
  for (int which = VERTS; which <= LINES && !dem; which++)
    for (int k = 0; k < scenery->nline; k++)
      add_line(c, scenery, s, k, which);
  for (int k = 0; k < scenery->npolygon; k++) {
    const tdm_view_polygon *p = &scenery->polygon[k];
    if (scenery->body[p->body].dem != dem)
      continue;
    for (int i = 0; i < p->ncorner; i++)
      c->point[c->npoint++] = tdm_pose_point(s->pose[p->body], p->corner[i]);
    end_cell(c, POLYS, p->body, -1, -1);
  }
  return TDM_OK;
}

/* `which` cells as VTK has them: the numbers of their points, which count from `first` on */
static void write_cells(FILE *f, const char *tag, const cells *c, int which, int64_t *index) {
  int64_t first = 0;
  for (int k = 0; k < which; k++)
    first = c->ncell[k] > 0 ? c->end[k][c->ncell[k] - 1] : first;
  const int n = c->ncell[which];
  const int64_t npoint = n > 0 ? c->end[which][n - 1] - first : 0;
  for (int64_t i = 0; i < npoint; i++)
    index[i] = first + i;
  for (int k = 0; k < n; k++)
    c->end[which][k] -= first; /* offsets count the points of this kind alone */
  fprintf(f, "<%s>\n", tag);
  write_array(f, "Int64", "connectivity", 1, index, (size_t)npoint, sizeof(int64_t));
  write_array(f, "Int64", "offsets", 1, c->end[which], (size_t)n, sizeof(int64_t));
  fprintf(f, "</%s>\n", tag);
  for (int k = 0; k < n; k++)
    c->end[which][k] += first;
}

/* force, pressure and shear of each polygon of a body of DEM */
static tdm_status write_forces(FILE *f, const tdm_scenery *scenery, const tdm_snapshot *s, tdm_error *err) {
  size_t room = (size_t)scenery->npolygon + 1, n = 0;
  tdm_vec3 *force = malloc(2 * room * sizeof *force), *shear = force ? force + room : NULL;
  double *pressure = malloc(room * sizeof *pressure);
  for (int i = 0; i < scenery->npolygon && force && pressure; i++) {
    const tdm_view_polygon *p = &scenery->polygon[i];
    if (!scenery->body[p->body].dem)
      continue;
    tdm_vec3 twice = tdm_cross(tdm_sub(p->corner[1], p->corner[0]), tdm_sub(p->corner[2], p->corner[0]));
    twice = tdm_quat_rotate(s->pose[p->body].orientation, twice);
    double per_area = 2 / tdm_norm(twice); /* of a triangle; the others have no force */
    tdm_vec3 normal = tdm_unit(twice), traction = tdm_scale(per_area, s->force_on[i]);
    force[n] = s->force_on[i];
    pressure[n] = -tdm_dot(traction, normal);
    shear[n] = tdm_axpy(pressure[n], normal, traction);
    n++;
  }
  if (force && pressure) {
    write_array(f, "Float64", "force", 3, force, n, sizeof(double));
    write_array(f, "Float64", "pressure", 1, pressure, n, sizeof(double));
    write_array(f, "Float64", "shear", 3, shear, n, sizeof(double));
  } else {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d walls", scenery->npolygon);
  }
  free(force);
  free(pressure);
  return err->status;
}

/* ---- walls and mechanism ---- */

/* Names, as the codes of their characters with a zero behind each. */
static void write_names(FILE *f, const char *what, const void *first, size_t stride, int n) {
  fprintf(f, "<Array type=\"String\" Name=\"%s\" NumberOfTuples=\"%d\" format=\"ascii\">\n", what, n);
  for (int k = 0; k < n; k++) {
    for (const char *c = (const char *)first + (size_t)k * stride; *c; c++)
      fprintf(f, "%d ", (unsigned char)*c);
    fputs("0\n", f);
  }
  fputs("</Array>\n", f);
}

static void write_field(FILE *f, const tdm_scenery *s) {
  static const struct {
    char text[64];
  } kinds[] = {
#define X(name, text) {text},
      TDM_VIEW_LINE_LIST(X)
#undef X
  };
  fputs("<FieldData>\n", f);
  if (s->nbody > 0)
    write_names(f, "body_names", s->body[0].name, sizeof *s->body, s->nbody);
  if (s->nline > 0)
    write_names(f, "line_names", s->line[0].name, sizeof *s->line, s->nline);
  write_names(f, "kind_names", kinds[0].text, sizeof kinds[0], TDM_VIEW_LINE_COUNT);
  fputs("</FieldData>\n", f);
}

/* All of a file but its head: of the bodies that DEM computes with, or of the others and the lines. */
static void write_body(FILE *f, const tdm_scenery *scenery, const tdm_snapshot *s, bool dem, cells *c, int64_t *index,
                       tdm_error *err) {
  const size_t n = (size_t)(c->ncell[VERTS] + c->ncell[LINES] + c->ncell[POLYS]);
  fputs("<PolyData>\n", f);
  if (!dem)
    write_field(f, scenery);
  fprintf(f, "<Piece NumberOfPoints=\"%d\" ", c->npoint);
  if (!dem)
    fprintf(f, "NumberOfVerts=\"%d\" NumberOfLines=\"%d\" ", c->ncell[VERTS], c->ncell[LINES]);
  fprintf(f, "NumberOfPolys=\"%d\">\n<CellData Scalars=\"body\">\n", c->ncell[POLYS]);
  write_array(f, "Int32", "body", 1, c->body, n, sizeof(int32_t));
  if (!dem) {
    write_array(f, "Int32", "line", 1, c->line, n, sizeof(int32_t));
    write_array(f, "Int32", "kind", 1, c->kind, n, sizeof(int32_t));
  } else if (s->nforce > 0) {
    write_forces(f, scenery, s, err);
  }
  fputs("</CellData>\n<Points>\n", f);
  write_array(f, "Float64", "position", 3, c->point, (size_t)c->npoint, sizeof(double));
  fputs("</Points>\n", f);
  if (!dem) {
    write_cells(f, "Verts", c, VERTS, index);
    write_cells(f, "Lines", c, LINES, index);
  }
  write_cells(f, "Polys", c, POLYS, index);
  fputs("</Piece>\n</PolyData>\n</VTKFile>\n", f);
}

static tdm_status write_bodies(const tdm_results *r, int number, const tdm_scenery *scenery, const tdm_snapshot *s,
                               bool dem, tdm_error *err) {
  char name[64];
  cells c;
  make_cells(&c, scenery, s, dem, err);
  int64_t *index = err->status == TDM_OK ? malloc(((size_t)c.npoint + 1) * sizeof *index) : NULL;
  if (!index)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d polygons", scenery->npolygon);
  FILE *f = index ? open_vtp(r, dem ? "walls" : "mechanism", number, name, err) : NULL;
  if (f) {
    write_body(f, scenery, s, dem, &c, index, err);
    close_file(r, name, f, err);
  }
  free(index);
  free_cells(&c);
  return err->status;
}

tdm_vtp_parts tdm_vtp_parts_of(const tdm_scenery *s) {
  tdm_vtp_parts parts = {.particles = s->nmaterial > 0, .mechanism = s->nline > 0};
  for (int b = 0; b < s->nbody; b++) {
    parts.particles = parts.particles || s->body[b].dem;
    parts.mechanism = parts.mechanism || !s->body[b].dem;
  }
  return parts;
}

tdm_status tdm_vtp_write(const tdm_results *r, int number, const tdm_scenery *scenery, const tdm_snapshot *s,
                         tdm_vtp_parts parts, tdm_error *err) {
  if (parts.particles &&
      (write_particles(r, number, s, err) != TDM_OK || write_bodies(r, number, scenery, s, true, err) != TDM_OK))
    return err->status;
  if (parts.contacts && write_contacts(r, number, s, err) != TDM_OK)
    return err->status;
  return parts.mechanism ? write_bodies(r, number, scenery, s, false, err) : TDM_OK;
}

/* ---- the list of all files ---- */

/* The end of the list, over which the next entry goes. */
static tdm_status end_list(tdm_pvd *pvd, const tdm_results *r, tdm_error *err) {
  pvd->end = ftell(pvd->file);
  fputs("</Collection>\n</VTKFile>\n", pvd->file);
  if (fflush(pvd->file) != 0 || ferror(pvd->file))
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s/scene.pvd: cannot be written: %s", r->dir, strerror(errno));
  return TDM_OK;
}

tdm_status tdm_pvd_open(tdm_pvd *pvd, const tdm_results *r, tdm_error *err) {
  *pvd = (tdm_pvd){.file = tdm_results_file(r, "scene.pvd", err)};
  if (!pvd->file)
    return err->status;
  fprintf(pvd->file, head, "Collection");
  fputs("<Collection>\n", pvd->file);
  return end_list(pvd, r, err);
}

tdm_status tdm_pvd_add(tdm_pvd *pvd, const tdm_results *r, double t, tdm_vtp_parts parts, tdm_error *err) {
  static const char *const names[] = {"particles", "walls", "mechanism", "contacts"};
  const bool there[] = {parts.particles, parts.particles, parts.mechanism, parts.contacts};
  fseek(pvd->file, pvd->end, SEEK_SET);
  for (int k = 0; k < 4; k++)
    if (there[k])
      fprintf(pvd->file, "<DataSet timestep=\"%.12g\" part=\"%d\" name=\"%s\" file=\"%s_%06d.vtp\"/>\n", t, k, names[k],
              names[k], pvd->number);
  pvd->number++;
  return end_list(pvd, r, err);
}

void tdm_pvd_close(tdm_pvd *pvd) {
  if (pvd->file)
    fclose(pvd->file);
  *pvd = (tdm_pvd){0};
}
