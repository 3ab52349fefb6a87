/* What there is to see for ParaView: see vtp.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/output/vtp.h"

#include "protocol/view/frames.h"

#include <assert.h>
#include <errno.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "arrays are written as they lie in memory, which must be little-endian"
#endif

/* ---- files ---- */

static const char head[] = "<?xml version=\"1.0\"?>\n"
                           "<VTKFile type=\"%s\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n";

enum { ARRAYS_MAX = 16 };

/* A file that is being written. Arrays are declared in the text and stand behind it. */
typedef struct {
  char path[4352];
  FILE *file;
  bool leads;                /* writes all but the shares of other processes, who only count what the text takes */
  const tdm_snapshot *share; /* whose particles the arrays are of; NULL: they are whole */
  size_t text, data;         /* bytes of the text so far, and of arrays that were declared */
  int narray;
  struct {
    const void *values;
    size_t n, width; /* entries, of all particles in a share; bytes of each */
  } array[ARRAYS_MAX];
} vtp;

static void print(vtp *v, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void print(vtp *v, const char *format, ...) {
  va_list list;
  va_start(list, format);
  const int n = v->leads ? vfprintf(v->file, format, list) : vsnprintf(NULL, 0, format, list);
  va_end(list);
  v->text += n > 0 ? (size_t)n : 0;
}

/* what a file is called until all shares are in it */
static const char unfinished[] = ".part";

/* The file of rank 0, or of a process that runs alone; shared: others will write into it. False: it cannot be written.
 */
static bool begin(vtp *v, const tdm_results *r, const char *what, int number, bool shared, tdm_error *err) {
  char name[64];
  *v = (vtp){.leads = true};
  snprintf(name, sizeof name, "%s_%06d.vtp%s", what, number, shared ? unfinished : "");
  tdm_results_path(r, name, v->path, sizeof v->path);
  v->file = tdm_results_file(r, name, err);
  if (v->file)
    print(v, head, "PolyData");
  return v->file;
}

/* The same file as another process opens it, which has only a share to write. */
static bool join(vtp *v, const char *dir, const char *what, int number, tdm_error *err) {
  *v = (vtp){0};
  snprintf(v->path, sizeof v->path, "%s/%s_%06d.vtp%s", dir, what, number, unfinished);
  v->file = tdm_share_open(v->path, err);
  print(v, head, "PolyData");
  return v->file;
}

/* One DataArray: n entries of `components` numbers of `size` bytes. The values are borrowed until the end. */
static void array(vtp *v, const char *type, const char *name, int components, const void *values, size_t n,
                  size_t size) {
  assert(v->narray < ARRAYS_MAX);
  print(v, "<DataArray type=\"%s\" Name=\"%s\" NumberOfComponents=\"%d\" format=\"appended\" offset=\"%zu\"/>\n", type,
        name, components, v->data);
  v->array[v->narray].values = values;
  v->array[v->narray].n = n;
  v->array[v->narray++].width = (size_t)components * size;
  v->data += sizeof(uint64_t) + n * (size_t)components * size;
}

/* The arrays, behind the text; false: not all of them, and errno says why. */
static bool put_arrays(vtp *v) {
  bool good = true;
  size_t at = v->text;
  for (int k = 0; k < v->narray && good; k++) {
    const size_t width = v->array[k].width;
    const uint64_t bytes = v->array[k].n * width;
    if (v->leads)
      good = tdm_put_at(v->file, (long)at, &bytes, sizeof bytes);
    at += sizeof bytes;
    good = good && (v->share ? tdm_put_share(v->file, (long)at, v->share, v->array[k].values, width)
                             : tdm_put_at(v->file, (long)at, v->array[k].values, bytes));
    at += bytes;
  }
  static const char tail[] = "\n</AppendedData>\n</VTKFile>\n";
  return good && (!v->leads || tdm_put_at(v->file, (long)at, tail, sizeof tail - 1));
}

/* A file that cannot be written to its end goes; one of shares goes when all that write into it are done. */
static tdm_status end(vtp *v, tdm_error *err) {
  errno = 0;
  print(v, "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_");
  const bool good = put_arrays(v) && !ferror(v->file);
  const int why = good ? 0 : errno;
  if (fclose(v->file) == 0 && good)
    return err->status;
  tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be written: %s", v->path, strerror(why ? why : errno));
  if (v->leads)
    unlink(v->path);
  return err->status;
}

/* ---- particles ---- */

/* `index` (2 x nparticle): vertex i is point i; it ends at i + 1 */
static void number_vertices(const tdm_snapshot *s, int64_t *index) {
  for (int k = 0, i = 0; k < s->nrange; k++)
    for (int q = 0; q < s->range[k].count; q++, i++) {
      index[i] = s->range[k].first + q;
      index[s->nparticle + i] = index[i] + 1;
    }
}

static void put_particles(vtp *v, const tdm_snapshot *s, const int64_t *index) {
  const size_t n = (size_t)s->nall;
  v->share = s;
  print(v, "<PolyData>\n<Piece NumberOfPoints=\"%zu\" NumberOfVerts=\"%zu\">\n<PointData Scalars=\"radius\">\n", n, n);
  array(v, "Float64", "radius", 1, s->radius, n, sizeof(double));
  array(v, "Float64", "velocity", 3, s->velocity, n, sizeof(double));
  array(v, "Float64", "spin", 3, s->spin, n, sizeof(double));
  if (s->oriented)
    array(v, "Float64", "orientation", 4, s->orientation, n, sizeof(double));
  array(v, "Int64", "id", 1, s->id, n, sizeof(int64_t));
  array(v, "Int32", "material", 1, s->material, n, sizeof(int32_t));
  array(v, "Float64", "force", 3, s->force, n, sizeof(double));
  array(v, "Int32", "size_class", 1, s->size_class, n, sizeof(int32_t));
  print(v, "</PointData>\n<Points>\n");
  array(v, "Float64", "position", 3, s->position, n, sizeof(double));
  print(v, "</Points>\n<Verts>\n");
  array(v, "Int64", "connectivity", 1, index, n, sizeof(int64_t));
  array(v, "Int64", "offsets", 1, index + s->nparticle, n, sizeof(int64_t));
  print(v, "</Verts>\n");
}

/* r: of the process that leads, else NULL; dir: of the others */
static tdm_status write_particles(const tdm_results *r, const char *dir, int number, const tdm_snapshot *s,
                                  tdm_error *err) {
  vtp v = {0};
  int64_t *index = malloc((2 * (size_t)s->nparticle + 1) * sizeof *index);
  if (!index)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d particles", s->nparticle);
  number_vertices(s, index);
  if (r ? begin(&v, r, "particles", number, s->nparticle < s->nall, err) : join(&v, dir, "particles", number, err)) {
    put_particles(&v, s, index);
    end(&v, err);
  }
  free(index);
  return err->status;
}

tdm_status tdm_vtp_write_share(const char *dir, int number, const tdm_snapshot *share, tdm_error *err) {
  return write_particles(NULL, dir, number, share, err);
}

/* ---- contacts ---- */

/* What the arrays of contacts are made of, n of them. */
typedef struct {
  tdm_vec3 *point; /* (n x 2) */
  double *force;   /* (n) */
  int64_t *index;  /* (n x 5) ids of the first ones, of the others, numbers of points, the point behind each line */
} links;

static bool make_links(links *l, const tdm_snapshot *s) {
  const size_t n = (size_t)s->ncontact;
  *l = (links){.point = malloc((2 * n + 1) * sizeof *l->point),
               .force = malloc((n + 1) * sizeof *l->force),
               .index = malloc((5 * n + 1) * sizeof *l->index)};
  if (!l->point || !l->force || !l->index)
    return false;
  for (size_t k = 0; k < n; k++) {
    l->point[2 * k] = s->contact[k].from;
    l->point[2 * k + 1] = s->contact[k].to;
    l->force[k] = s->contact[k].force;
    l->index[k] = s->contact[k].particle;
    l->index[n + k] = s->contact[k].other;
    l->index[2 * n + 2 * k] = 2 * (int64_t)k;
    l->index[2 * n + 2 * k + 1] = 2 * (int64_t)k + 1;
    l->index[4 * n + k] = 2 * (int64_t)k + 2;
  }
  return true;
}

static void put_contacts(vtp *v, size_t n, const links *l) {
  print(v, "<PolyData>\n<Piece NumberOfPoints=\"%zu\" NumberOfLines=\"%zu\">\n<CellData Scalars=\"normal_force\">\n",
        2 * n, n);
  array(v, "Float64", "normal_force", 1, l->force, n, sizeof(double));
  array(v, "Int64", "particle", 1, l->index, n, sizeof(int64_t));
  array(v, "Int64", "other", 1, l->index + n, n, sizeof(int64_t));
  print(v, "</CellData>\n<Points>\n");
  array(v, "Float64", "position", 3, l->point, 2 * n, sizeof(double));
  print(v, "</Points>\n<Lines>\n");
  array(v, "Int64", "connectivity", 1, l->index + 2 * n, 2 * n, sizeof(int64_t));
  array(v, "Int64", "offsets", 1, l->index + 4 * n, n, sizeof(int64_t));
  print(v, "</Lines>\n");
}

static tdm_status write_contacts(const tdm_results *r, int number, const tdm_snapshot *s, tdm_error *err) {
  vtp v;
  links l;
  if (!make_links(&l, s))
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d contacts", s->ncontact);
  else if (begin(&v, r, "contacts", number, false, err)) {
    put_contacts(&v, (size_t)s->ncontact, &l);
    end(&v, err);
  }
  free(l.point);
  free(l.force);
  free(l.index);
  return err->status;
}

/* ---- cells ---- */

/* Points, and cells of each of three kinds, in VTK's order: vertices, lines, polygons. */
enum { VERTS, LINES, POLYS, NKIND };

typedef struct {
  int npoint, ncell[NKIND];
  int begin[NKIND]; /* first point of a kind that has cells */
  int closed;       /* points of cells */
  tdm_vec3 *point;
  int64_t *number;      /* (npoint) of each point */
  int64_t *end[NKIND];  /* (ncell) points of this kind up to the end of each */
  int32_t *body;        /* (all cells) -1: a line */
  int32_t *line, *kind; /* (all cells) -1: a body */
} cells;

static void free_cells(cells *c) {
  free(c->point);
  free(c->number);
  for (int k = 0; k < NKIND; k++)
    free(c->end[k]);
  free(c->body);
  free(c->line);
  free(c->kind);
}

static bool allocate(cells *c, size_t npoint, size_t ncell) {
  *c = (cells){0};
  c->point = malloc((npoint + 1) * sizeof *c->point);
  c->number = malloc((npoint + 1) * sizeof *c->number);
  bool all = c->point && c->number;
  for (size_t i = 0; i < npoint && all; i++)
    c->number[i] = (int64_t)i;
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
  if (c->ncell[which] == 0)
    c->begin[which] = c->closed;
  c->end[which][c->ncell[which]++] = c->npoint - c->begin[which];
  c->closed = c->npoint;
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

/* `which` cells as VTK has them: the numbers of their points, then how many there are up to the end of each */
static void put_cells(vtp *v, const char *tag, const cells *c, int which) {
  const size_t n = (size_t)c->ncell[which], npoint = n > 0 ? (size_t)c->end[which][n - 1] : 0;
  print(v, "<%s>\n", tag);
  array(v, "Int64", "connectivity", 1, c->number + c->begin[which], npoint, sizeof(int64_t));
  array(v, "Int64", "offsets", 1, c->end[which], n, sizeof(int64_t));
  print(v, "</%s>\n", tag);
}

/* What pushes the polygons of bodies of DEM. */
typedef struct {
  size_t n;
  tdm_vec3 *force, *shear;
  double *pressure;
} pushes;

static tdm_status make_pushes(pushes *p, const tdm_scenery *scenery, const tdm_snapshot *s, tdm_error *err) {
  const size_t room = (size_t)scenery->npolygon + 1;
  *p = (pushes){.force = malloc(room * sizeof *p->force),
                .shear = malloc(room * sizeof *p->shear),
                .pressure = malloc(room * sizeof *p->pressure)};
  if (!p->force || !p->shear || !p->pressure)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the output of %d walls", scenery->npolygon);
  for (int i = 0; i < s->nforce; i++) {
    const tdm_view_polygon *polygon = &scenery->polygon[i];
    if (!scenery->body[polygon->body].dem)
      continue;
    const tdm_vec3 *corner = polygon->corner;
    tdm_vec3 twice = tdm_cross(tdm_sub(corner[1], corner[0]), tdm_sub(corner[2], corner[0]));
    twice = tdm_quat_rotate(s->pose[polygon->body].orientation, twice);
    double per_area = 2 / tdm_norm(twice); /* of a triangle; the others have no force */
    tdm_vec3 normal = tdm_unit(twice), traction = tdm_scale(per_area, s->force_on[i]);
    p->force[p->n] = s->force_on[i];
    p->pressure[p->n] = -tdm_dot(traction, normal);
    p->shear[p->n] = tdm_axpy(p->pressure[p->n], normal, traction);
    p->n++;
  }
  return TDM_OK;
}

/* ---- walls and mechanism ---- */

/* Names, as the codes of their characters with a zero behind each. */
static void print_names(vtp *v, const char *what, const void *first, size_t stride, int n) {
  print(v, "<Array type=\"String\" Name=\"%s\" NumberOfTuples=\"%d\" format=\"ascii\">\n", what, n);
  for (int k = 0; k < n; k++) {
    for (const char *c = (const char *)first + (size_t)k * stride; *c; c++)
      print(v, "%d ", (unsigned char)*c);
    print(v, "0\n");
  }
  print(v, "</Array>\n");
}

static void print_field(vtp *v, const tdm_scenery *s) {
  static const struct {
    char text[64];
  } kinds[] = {
#define X(name, text) {text},
      TDM_VIEW_LINE_LIST(X)
#undef X
  };
  print(v, "<FieldData>\n");
  if (s->nbody > 0)
    print_names(v, "body_names", s->body[0].name, sizeof *s->body, s->nbody);
  if (s->nline > 0)
    print_names(v, "line_names", s->line[0].name, sizeof *s->line, s->nline);
  print_names(v, "kind_names", kinds[0].text, sizeof kinds[0], TDM_VIEW_LINE_COUNT);
  print(v, "</FieldData>\n");
}

/* Of the bodies that DEM computes with, or of the others and the lines. */
static void put_bodies(vtp *v, const tdm_scenery *scenery, bool dem, const cells *c, const pushes *p) {
  const size_t n = (size_t)(c->ncell[VERTS] + c->ncell[LINES] + c->ncell[POLYS]);
  print(v, "<PolyData>\n");
  if (!dem)
    print_field(v, scenery);
  print(v, "<Piece NumberOfPoints=\"%d\" ", c->npoint);
  if (!dem)
    print(v, "NumberOfVerts=\"%d\" NumberOfLines=\"%d\" ", c->ncell[VERTS], c->ncell[LINES]);
  print(v, "NumberOfPolys=\"%d\">\n<CellData Scalars=\"body\">\n", c->ncell[POLYS]);
  array(v, "Int32", "body", 1, c->body, n, sizeof(int32_t));
  if (!dem) {
    array(v, "Int32", "line", 1, c->line, n, sizeof(int32_t));
    array(v, "Int32", "kind", 1, c->kind, n, sizeof(int32_t));
  } else if (p->force) {
    array(v, "Float64", "force", 3, p->force, p->n, sizeof(double));
    array(v, "Float64", "pressure", 1, p->pressure, p->n, sizeof(double));
    array(v, "Float64", "shear", 3, p->shear, p->n, sizeof(double));
  }
  print(v, "</CellData>\n<Points>\n");
  array(v, "Float64", "position", 3, c->point, (size_t)c->npoint, sizeof(double));
  print(v, "</Points>\n");
  if (!dem) {
    put_cells(v, "Verts", c, VERTS);
    put_cells(v, "Lines", c, LINES);
  }
  put_cells(v, "Polys", c, POLYS);
}

static tdm_status write_bodies(const tdm_results *r, int number, const tdm_scenery *scenery, const tdm_snapshot *s,
                               bool dem, tdm_error *err) {
  vtp v;
  cells c;
  pushes p = {0};
  if (make_cells(&c, scenery, s, dem, err) == TDM_OK &&
      (!dem || s->nforce == 0 || make_pushes(&p, scenery, s, err) == TDM_OK) &&
      begin(&v, r, dem ? "walls" : "mechanism", number, false, err)) {
    put_bodies(&v, scenery, dem, &c, &p);
    end(&v, err);
  }
  free(p.force);
  free(p.shear);
  free(p.pressure);
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

tdm_status tdm_vtp_finish_shares(const tdm_results *r, int number, bool whole, tdm_error *err) {
  char name[64], part[80], path[4352], from[4352];
  snprintf(name, sizeof name, "particles_%06d.vtp", number);
  snprintf(part, sizeof part, "%s%s", name, unfinished);
  tdm_results_path(r, part, from, sizeof from);
  if (whole && rename(from, tdm_results_claim(r, name, path, sizeof path)) == 0)
    return TDM_OK;
  const int why = errno;
  unlink(from);
  return whole ? tdm_fail(err, TDM_ERR_FILE, NULL, "%s: cannot be renamed to %s: %s", from, name, strerror(why))
               : TDM_OK;
}

tdm_status tdm_vtp_write(const tdm_results *r, int number, const tdm_scenery *scenery, const tdm_snapshot *s,
                         tdm_vtp_parts parts, tdm_error *err) {
  if (parts.particles && (write_particles(r, r->dir, number, s, err) != TDM_OK ||
                          write_bodies(r, number, scenery, s, true, err) != TDM_OK))
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
