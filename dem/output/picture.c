/* Pictures by gnuplot: see picture.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/output/picture.h"

#include "protocol/app/plot.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { AREA = 250000, SIDE_MIN = 240, SIDE_MAX = 1200, MARGIN = 110, TIMES_MAX = 1000 }; /* pixels; pictures of a run */

static double component(tdm_vec3 x, int axis) {
  return axis == 0 ? x.x : axis == 1 ? x.y : x.z;
}

/* ---- settings ---- */

static void read_view(dem_picture_settings *s, tdm_object *o) {
  static const char *const views[] = {"xz", "yz", "xy", "zx", "zy", "yx"};
  int view = tdm_get_choice(o, "view", views, sizeof views / sizeof views[0], 0);
  const char *name = views[view < 0 ? 0 : view];
  s->across = name[0] - 'x';
  s->up = name[1] - 'x';
}

static void read_times(dem_picture_settings *s, tdm_object *o, double time_end) {
  json_t *times = tdm_get_array(o, "times", true);
  size_t n = json_array_size(times);
  if (!o->err->status && (n == 0 || n > TIMES_MAX))
    tdm_object_fail(o, "times", "has %zu entries; give 1 to %d times [s]", n, TIMES_MAX);
  s->time = calloc(n ? n : 1, sizeof *s->time);
  if (!s->time)
    tdm_fail(o->err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (size_t i = 0; i < n && !o->err->status; i++) {
    const json_t *value = json_array_get(times, i);
    double t = json_number_value(value), before = i ? s->time[i - 1] : -1;
    char path[TDM_PATH_MAX];
    if (!json_is_number(value) || !(t >= 0) || !(t > before))
      tdm_fail(o->err, TDM_ERR_SCENE, tdm_path(path, o, "times", (int)i),
               "must be a time of at least 0 s, later than the entry before");
    s->time[i] = t;
    s->late += t > time_end * (1 + 1e-9);
    s->ntime += s->late == 0;
  }
}

void dem_picture_settings_read(dem_picture_settings *s, tdm_object *output, double time_end) {
  static const char *const colors[] = {
#define X(name, label) #name,
      DEM_COLOR_LIST(X)
#undef X
  };
  *s = (dem_picture_settings){0};
  if (!tdm_has(output, "pictures"))
    return;
  tdm_object o = tdm_get_object(output, "pictures", true);
  read_times(s, &o, time_end);
  read_view(s, &o);
  int color = tdm_get_choice(&o, "color", colors, sizeof colors / sizeof colors[0], DEM_COLOR_speed);
  s->color = (dem_color)(color < 0 ? 0 : color);
  tdm_get_numbers(&o, "color_range", s->scale, 2, false);
  if (s->scale[0] > s->scale[1])
    tdm_object_fail(&o, "color_range", "is [%g, %g] but must be [smallest, largest]", s->scale[0], s->scale[1]);
  bool has_max = tdm_has(&o, "max");
  s->has_limits = tdm_get_numbers(&o, "min", s->low, 2, has_max);
  tdm_get_numbers(&o, "max", s->high, 2, s->has_limits);
  if (s->has_limits && !(s->low[0] < s->high[0] && s->low[1] < s->high[1]))
    tdm_object_fail(&o, "max", "must be greater than min in both directions");
  tdm_object_close(&o);
}

void dem_picture_settings_free(dem_picture_settings *s) {
  free(s->time);
  *s = (dem_picture_settings){0};
}

/* ---- the start of each particle ---- */

void dem_pictures_begin(dem_pictures *p, const dem_picture_settings *s, const tdm_results *results,
                        const dem_bounds *bounds) {
  const int axis[2] = {s->across, s->up};
  *p = (dem_pictures){.settings = s, .results = results};
  for (int k = 0; k < 2; k++) {
    double low = component(bounds->low, axis[k]), high = component(bounds->high, axis[k]);
    double margin = 0.02 * (high - low);
    p->low[k] = s->has_limits ? s->low[k] : low - margin;
    p->high[k] = s->has_limits ? s->high[k] : high + margin;
  }
}

tdm_status dem_pictures_watch(dem_pictures *p, const tdm_snapshot *s, tdm_error *err) {
  int64_t all = s->nparticle > 0 ? s->id[s->nparticle - 1] + 1 : 0;
  if (all <= p->nborn)
    return TDM_OK;
  if ((size_t)all > p->capacity) {
    size_t room = 2 * (size_t)all;
    tdm_vec3 *born = realloc(p->born, room * sizeof *born);
    if (!born)
      return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the pictures of %lld particles", (long long)all);
    p->born = born;
    p->capacity = room;
  }
  for (int i = s->nparticle - 1; i >= 0 && s->id[i] >= p->nborn; i--)
    p->born[s->id[i]] = s->position[i];
  p->nborn = all;
  return TDM_OK;
}

void dem_pictures_free(dem_pictures *p) {
  free(p->born);
  free(p->time);
  *p = (dem_pictures){0};
}

/* ---- drawing ---- */

static double color_of(const dem_pictures *p, const tdm_snapshot *s, int i) {
  switch (p->settings->color) {
  case DEM_COLOR_speed:
    return tdm_norm(s->velocity[i]);
  case DEM_COLOR_id:
    return (double)s->id[i];
  case DEM_COLOR_radius:
    return s->radius[i];
  case DEM_COLOR_material:
    return s->material[i];
  case DEM_COLOR_height0:
    return component(p->born[s->id[i]], p->settings->up);
  case DEM_COLOR_across0:
    return component(p->born[s->id[i]], p->settings->across);
  }
  return 0;
}

static tdm_vec3 unit(int axis) {
  return tdm_v3(axis == 0, axis == 1, axis == 2);
}

/* Solid faces; of the planes only what is seen from the side: one seen from the front would hide what is behind it. */
static void write_walls(FILE *f, const dem_pictures *p, const tdm_scenery *scenery, const tdm_snapshot *s) {
  tdm_vec3 view = tdm_cross(unit(p->settings->across), unit(p->settings->up));
  for (int k = 0; k < scenery->npolygon; k++) {
    const tdm_view_polygon *w = &scenery->polygon[k];
    const tdm_pose pose = s->pose[w->body];
    tdm_vec3 area = {0, 0, 0}; /* twice the polygon's, as a vector */
    for (int c = 2; c < w->ncorner; c++)
      area = tdm_add(area, tdm_cross(tdm_sub(w->corner[c - 1], w->corner[0]), tdm_sub(w->corner[c], w->corner[0])));
    area = tdm_quat_rotate(pose.orientation, area);
    if (!w->solid && fabs(tdm_dot(area, view)) > 0.1 * tdm_norm(area))
      continue;
    for (int c = 0; c <= w->ncorner; c++) {
      tdm_vec3 x = tdm_pose_point(pose, w->corner[c % w->ncorner]);
      fprintf(f, "%.7g %.7g\n", component(x, p->settings->across), component(x, p->settings->up));
    }
    fputs("\n", f);
  }
}

typedef struct {
  double toward; /* the viewer [m] */
  int particle;
} depth;

static int by_depth(const void *a, const void *b) {
  const depth *x = a, *y = b;
  return x->toward != y->toward ? (x->toward > y->toward) - (x->toward < y->toward)
                                : (x->particle > y->particle) - (x->particle < y->particle);
}

/* the particles, from the farthest to the nearest */
static tdm_status write_particles(FILE *f, const dem_pictures *p, const tdm_snapshot *s, tdm_error *err) {
  tdm_vec3 view = tdm_cross(unit(p->settings->across), unit(p->settings->up));
  depth *order = malloc(((size_t)s->nparticle + 1) * sizeof *order);
  if (!order)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for a picture of %d particles", s->nparticle);
  for (int i = 0; i < s->nparticle; i++)
    order[i] = (depth){tdm_dot(s->position[i], view), i};
  qsort(order, (size_t)s->nparticle, sizeof *order, by_depth);
  for (int k = 0; k < s->nparticle; k++) {
    int i = order[k].particle;
    fprintf(f, "%.7g %.7g %.7g %.7g\n", component(s->position[i], p->settings->across),
            component(s->position[i], p->settings->up), s->radius[i], color_of(p, s, i));
  }
  free(order);
  return TDM_OK;
}

/* The range of the starts along `axis`: one scale for the pictures of places. */
static void born_range(const dem_pictures *p, int axis, double range[2]) {
  range[0] = INFINITY;
  range[1] = -INFINITY;
  for (int64_t k = 0; k < p->nborn; k++) {
    range[0] = fmin(range[0], component(p->born[k], axis));
    range[1] = fmax(range[1], component(p->born[k], axis));
  }
}

static void write_scale(FILE *f, const dem_pictures *p) {
  static const char *const labels[] = {
#define X(name, label) label,
      DEM_COLOR_LIST(X)
#undef X
  };
  const dem_picture_settings *s = p->settings;
  double range[2] = {s->scale[0], s->scale[1]};
  if (!(range[0] < range[1]) && (s->color == DEM_COLOR_height0 || s->color == DEM_COLOR_across0))
    born_range(p, s->color == DEM_COLOR_height0 ? s->up : s->across, range);
  fprintf(f, "set cblabel \"%s\"\n", labels[s->color]);
  if (range[0] < range[1])
    fprintf(f, "set cbrange [%.6g:%.6g]\n", range[0], range[1]);
  else
    fputs(s->color == DEM_COLOR_speed ? "set cbrange [0:*]\n" : "set cbrange [*:*]\n", f);
}

static void write_style(FILE *f) {
  fputs("set encoding utf8\nunset key\nset size ratio -1\nset xlabel \"\"\nset tics out nomirror font ',9'\n"
        "set style fill solid 1 noborder\n"
        "set palette defined (0 '#30123b', 1 '#4662d7', 2 '#36aaf9', 3 '#1ae4b6', 4 '#72fe5e', 5 '#c8ef34', 6 "
        "'#faba39', 7 '#f66b19', 8 '#cb2a04')\n",
        f);
}

static void write_panel(FILE *f, const dem_pictures *p, int number) {
  fprintf(f,
          "set xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\nset title \"t = %.6g s\"\n"
          "plot 'picture_%03d.dat' index 0 using 1:2 with filledcurves closed fc rgb '#c4c4c4', \\\n"
          "  '' index 0 using 1:2 with lines lc rgb '#505050', \\\n"
          "  '' index 1 using 1:2:3:4 with circles lc palette\n",
          p->low[0], p->high[0], p->low[1], p->high[1], p->time[number], number);
}

/* pixels of a panel's drawing area */
static void panel_size(const dem_pictures *p, double size[2]) {
  double width = p->high[0] - p->low[0], height = p->high[1] - p->low[1], scale = sqrt(AREA / (width * height));
  size[0] = fmin(SIDE_MAX, fmax(SIDE_MIN, scale * width));
  size[1] = fmin(SIDE_MAX, fmax(SIDE_MIN, scale * height));
}

static FILE *open_script(const dem_pictures *p, const char *name, double width, double height, tdm_error *err) {
  char file[64];
  snprintf(file, sizeof file, "%s.gp", name);
  FILE *f = tdm_results_file(p->results, file, err);
  if (!f)
    return NULL;
  fprintf(f, "set terminal pngcairo noenhanced size %.0f,%.0f font ',10'\nset output '%s.png'\n", width, height, name);
  write_style(f);
  write_scale(f, p);
  return f;
}

static tdm_status close_file(const dem_pictures *p, FILE *f, tdm_error *err) {
  bool bad = ferror(f);
  if (fclose(f) != 0 || bad)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: a picture cannot be written: %s", p->results->dir, strerror(errno));
  return err->status;
}

static tdm_status write_data(const dem_pictures *p, const tdm_scenery *scenery, const tdm_snapshot *s, tdm_error *err) {
  char file[64];
  snprintf(file, sizeof file, "picture_%03d.dat", p->drawn);
  FILE *f = tdm_results_file(p->results, file, err);
  if (!f)
    return err->status;
  fputs("# walls: across [m], up [m]\n", f);
  write_walls(f, p, scenery, s);
  fputs("nan nan\n\n\n# particles: across [m], up [m], radius [m], color\nnan nan nan nan\n", f);
  write_particles(f, p, s, err);
  return close_file(p, f, err);
}

tdm_status dem_picture_draw(dem_pictures *p, double t, const tdm_scenery *scenery, const tdm_snapshot *s,
                            tdm_error *err) {
  char name[64];
  double size[2], *time = realloc(p->time, ((size_t)p->drawn + 1) * sizeof *time);
  if (!time)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  p->time = time;
  p->time[p->drawn] = t;
  snprintf(name, sizeof name, "picture_%03d", p->drawn);
  if (write_data(p, scenery, s, err) != TDM_OK)
    return err->status;
  panel_size(p, size);
  FILE *f = open_script(p, name, size[0] + 1.6 * MARGIN, size[1] + MARGIN, err);
  if (!f)
    return err->status;
  write_panel(f, p, p->drawn++);
  if (close_file(p, f, err) != TDM_OK)
    return err->status;
  return tdm_plot_run(p->results->dir, name, err);
}

tdm_status dem_pictures_row(const dem_pictures *p, tdm_error *err) {
  double size[2];
  panel_size(p, size);
  double scale = fmin(1, 1100 / (p->drawn * size[0]));
  FILE *f = open_script(p, "pictures", p->drawn * (scale * size[0] + MARGIN), scale * size[1] + MARGIN, err);
  if (!f)
    return err->status;
  fprintf(f, "set multiplot layout 1,%d\n", p->drawn);
  for (int k = 0; k < p->drawn; k++)
    write_panel(f, p, k);
  fputs("unset multiplot\n", f);
  if (close_file(p, f, err) != TDM_OK)
    return err->status;
  return tdm_plot_run(p->results->dir, "pictures", err);
}
