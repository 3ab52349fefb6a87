/* The key output.pictures: see settings.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/draw/settings.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TIMES_MAX = 1000, INTERVALS_MAX = 100000, VIEWS_MAX = 16 };
enum { SIDE_LEAST = 64, SIDE_MOST = 4096 }; /* pixels */
static const double angle_usual = 30;       /* [deg] */

static const char *const colors[] = {
#define X(name, label) #name,
    TDM_COLOR_LIST(X)
#undef X
};

static const char *const labels[] = {
#define X(name, label) label,
    TDM_COLOR_LIST(X)
#undef X
};

const char *tdm_color_name(tdm_color color) {
  return colors[color];
}

const char *tdm_color_label(tdm_color color) {
  return labels[color];
}

bool tdm_color_of_contacts(tdm_color color) {
  return color == TDM_COLOR_contact_force;
}

const char *tdm_picture_prefix(const tdm_picture *p, char *out, size_t size) {
  snprintf(out, size, "picture%s%s", *p->name ? "_" : "", p->name);
  return out;
}

const char *tdm_picture_row_name(const tdm_picture *p, char *out, size_t size) {
  snprintf(out, size, "pictures%s%s.png", *p->name ? "_" : "", p->name);
  return out;
}

/* ---- times ---- */

static tdm_status make_times(tdm_picture *p, size_t n, tdm_error *err) {
  p->time = calloc(n ? n : 1, sizeof *p->time);
  return p->time ? TDM_OK : tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for the times of %zu pictures", n);
}

static void read_list(tdm_picture *p, tdm_object *o, double time_end) {
  json_t *times = tdm_get_array(o, "times", true);
  size_t n = json_array_size(times);
  if (!o->err->status && (n == 0 || n > TIMES_MAX))
    tdm_object_fail(o, "times", "has %zu entries; give 1 to %d times [s], or \"interval\"", n, TIMES_MAX);
  if (o->err->status || make_times(p, n, o->err) != TDM_OK)
    return;
  for (size_t i = 0; i < n && !o->err->status; i++) {
    const json_t *value = json_array_get(times, i);
    double t = json_number_value(value), before = i ? p->time[i - 1] : -1;
    char path[TDM_PATH_MAX];
    if (!json_is_number(value) || !(t >= 0) || !(t > before))
      tdm_fail(o->err, TDM_ERR_SCENE, tdm_path(path, o, "times", (int)i),
               "must be a time of at least 0 s, later than the entry before");
    p->time[i] = t;
    p->late += t > time_end * (1 + 1e-9);
    p->ntime += p->late == 0;
  }
}

/* 0, interval, 2 interval ... up to the end */
static void read_interval(tdm_picture *p, tdm_object *o, double time_end) {
  double interval = tdm_get_number(o, "interval", TDM_REQUIRED, TDM_POSITIVE);
  if (o->err->status)
    return;
  double n = floor(time_end / interval * (1 + 1e-9)) + 1;
  if (!(n <= INTERVALS_MAX)) {
    tdm_object_fail(o, "interval", "is %g s, which makes %g pictures; give at least %g s", interval, n,
                    time_end / (INTERVALS_MAX - 1));
    return;
  }
  if (make_times(p, (size_t)n, o->err) != TDM_OK)
    return;
  for (int i = 0; i < (int)n; i++)
    p->time[i] = i * interval;
  p->ntime = (int)n;
}

static void read_times(tdm_picture *p, tdm_object *o, double time_end) {
  bool list = tdm_has(o, "times"), interval = tdm_has(o, "interval");
  if (list && interval)
    tdm_object_fail(o, "interval", "stands beside \"times\"; give one of the two");
  else if (interval)
    read_interval(p, o, time_end);
  else if (list)
    read_list(p, o, time_end);
  else
    tdm_object_fail(o, "times", "missing; give times [s], or \"interval\"");
}

/* ---- views ---- */

static const char *const views[] = {"xz", "yz", "xy", "zx", "zy", "yx", "space"};
enum { SPACE = 6, NVIEW };

static void in_space(tdm_view *v) {
  *v = (tdm_view){.angle = angle_usual};
}

static void read_camera(tdm_view *v, tdm_object *o) {
  const tdm_vec3 none = {0, 0, 0};
  in_space(v);
  v->has_from = tdm_has(o, "from");
  v->has_at = tdm_has(o, "at");
  v->has_up = tdm_has(o, "up");
  v->from = tdm_get_vec3(o, "from", &none);
  v->at = tdm_get_vec3(o, "at", &none);
  v->up = tdm_get_vec3(o, "up", &none);
  if (!tdm_has(o, "parallel"))
    v->angle = tdm_get_number(o, "angle", angle_usual, TDM_POSITIVE);
  else if (tdm_has(o, "angle"))
    tdm_object_fail(o, "parallel", "stands beside \"angle\"; give an angle for perspective, or a height without it");
  else {
    v->angle = 0;
    v->height = tdm_get_number(o, "parallel", TDM_REQUIRED, TDM_POSITIVE);
  }
  if (v->angle > 150)
    tdm_object_fail(o, "angle", "is %g but must be at most 150 degrees", v->angle);
  tdm_object_close(o);
}

/* A view of no length, or one whose up says nothing. */
static void check_camera(const tdm_view *v, tdm_object *o) {
  tdm_vec3 along = tdm_sub(v->at, v->from), up = tdm_unit(v->up);
  double size = fmax(tdm_norm(v->at), tdm_norm(v->from));
  if (v->has_from && v->has_at && !(tdm_norm(along) > 1e-9 * size))
    tdm_object_fail(o, "at", "is where \"from\" is; give the point to look at, away from the eye");
  else if (v->has_up && !(tdm_norm(v->up) > 0))
    tdm_object_fail(o, "up", "has no length; give the direction that is up in the picture");
  else if (v->has_up && v->has_from && v->has_at && !(tdm_norm(tdm_cross(tdm_unit(along), up)) > 1e-6))
    tdm_object_fail(o, "up", "is the direction in which one looks; give another one, across it");
}

static void read_limits(tdm_view *v, tdm_object *o) {
  if (!v->flat) {
    for (int k = 0; k < 2; k++)
      if (tdm_has(o, k ? "max" : "min"))
        tdm_object_fail(o, k ? "max" : "min",
                        "belongs to flat views; in space, give view.from, view.at and view.angle or view.parallel");
    return;
  }
  bool has_max = tdm_has(o, "max");
  v->has_limits = tdm_get_numbers(o, "min", v->low, 2, has_max);
  tdm_get_numbers(o, "max", v->high, 2, v->has_limits);
  if (v->has_limits && !(v->low[0] < v->high[0] && v->low[1] < v->high[1]))
    tdm_object_fail(o, "max", "must be greater than min in both directions");
}

static void read_view(tdm_view *v, tdm_object *o) {
  if (json_is_object(json_object_get(o->json, "view"))) {
    tdm_object camera = tdm_get_object(o, "view", true);
    read_camera(v, &camera);
    check_camera(v, &camera);
  } else {
    int view = tdm_get_choice(o, "view", views, NVIEW, 0);
    const char *name = views[view < 0 ? 0 : view];
    if (view == SPACE)
      in_space(v);
    else
      *v = (tdm_view){.flat = true, .across = name[0] - 'x', .up_axis = name[1] - 'x'};
  }
  read_limits(v, o);
}

/* ---- a picture ---- */

static tdm_surface_look read_look(tdm_object *o, const char *key) {
  static const char *const looks[] = {"auto", "solid", "translucent", "hidden"};
  int look = tdm_get_choice(o, key, looks, 4, TDM_SURFACE_auto);
  return look < 0 ? TDM_SURFACE_auto : (tdm_surface_look)look;
}

static void read_cut(tdm_picture *p, tdm_object *o) {
  const tdm_vec3 origin = {0, 0, 0};
  p->cut = tdm_has(o, "cut");
  if (!p->cut)
    return;
  tdm_object plane = tdm_get_object(o, "cut", true);
  p->cut_point = tdm_get_vec3(&plane, "point", &origin);
  p->cut_normal = tdm_get_vec3(&plane, "normal", NULL);
  if (!o->err->status && !(tdm_norm(p->cut_normal) > 0))
    tdm_object_fail(&plane, "normal", "has no length; give the direction towards what is left out");
  p->cut_normal = tdm_unit(p->cut_normal);
  tdm_object_close(&plane);
}

static void read_size(tdm_picture *p, tdm_object *o) {
  double size[2] = {0, 0};
  if (!tdm_get_numbers(o, "size", size, 2, false))
    return;
  for (int k = 0; k < 2; k++) {
    p->size[k] = (int)size[k];
    if (p->size[k] != size[k] || size[k] < SIDE_LEAST || size[k] > SIDE_MOST)
      tdm_object_fail(o, "size", "is [%g, %g] but must be two whole numbers of pixels from %d to %d", size[0], size[1],
                      SIDE_LEAST, SIDE_MOST);
  }
}

static void read_looks(tdm_picture *p, tdm_object *o) {
  read_view(&p->view, o);
  int color = tdm_get_choice(o, "color", colors, TDM_COLOR_COUNT, TDM_COLOR_speed);
  p->color = (tdm_color)(color < 0 ? 0 : color);
  tdm_get_numbers(o, "color_range", p->range, 2, false);
  if (p->range[0] > p->range[1])
    tdm_object_fail(o, "color_range", "is [%g, %g] but must be [smallest, largest]", p->range[0], p->range[1]);
  p->walls = read_look(o, "walls");
  p->bodies = read_look(o, "bodies");
  read_cut(p, o);
  p->mechanism = tdm_get_bool(o, "mechanism", true);
  read_size(p, o);
}

static void read_name(tdm_picture *p, tdm_object *o) {
  const char *name = tdm_get_string(o, "name", "");
  if (strlen(name) >= sizeof p->name / 2 ||
      name[strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-")] != 0)
    tdm_object_fail(o, "name", "is part of the names of files; give at most %zu letters, digits, _ and -",
                    sizeof p->name / 2 - 1);
  snprintf(p->name, sizeof p->name, "%s", name);
}

void tdm_picture_read(tdm_picture *p, json_t *json, const char *path, tdm_error *err) {
  tdm_object o = tdm_object_open(json, path, err);
  *p = (tdm_picture){0};
  tdm_has(&o, "times"); /* of the scene that it may come from */
  tdm_has(&o, "interval");
  read_name(p, &o);
  read_looks(p, &o);
  tdm_object_close(&o);
}

static void read_picture(tdm_picture *p, tdm_object *o, double time_end) {
  read_name(p, o);
  read_times(p, o, time_end);
  read_looks(p, o);
  tdm_object_close(o);
}

/* ---- all of them ---- */

static void read_all(tdm_pictures *all, tdm_object *output, json_t *list, double time_end) {
  for (int i = 0; i < (int)json_array_size(list) && !output->err->status; i++) {
    char path[TDM_PATH_MAX];
    tdm_object o = tdm_object_open(json_array_get(list, (size_t)i), tdm_path(path, output, "pictures", i), output->err);
    tdm_picture *p = &all->picture[all->count++];
    read_picture(p, &o, time_end);
    for (int k = 0; k < i; k++)
      if (strcmp(all->picture[k].name, p->name) == 0)
        tdm_object_fail(&o, "name", "is \"%s\" like that of pictures[%d]; give each view a name of its own", p->name,
                        k);
  }
}

void tdm_pictures_read(tdm_pictures *all, tdm_object *output, double time_end) {
  *all = (tdm_pictures){0};
  if (!tdm_has(output, "pictures"))
    return;
  json_t *value = json_object_get(output->json, "pictures");
  size_t n = json_is_array(value) ? json_array_size(value) : 1;
  if (n == 0 || n > VIEWS_MAX) {
    tdm_object_fail(output, "pictures", "has %zu entries; give 1 to %d views", n, VIEWS_MAX);
    return;
  }
  all->picture = calloc(n, sizeof *all->picture);
  if (!all->picture) {
    tdm_fail(output->err, TDM_ERR_MEMORY, NULL, "out of memory");
    return;
  }
  if (json_is_array(value)) {
    read_all(all, output, value, time_end);
    return;
  }
  tdm_object o = tdm_get_object(output, "pictures", true);
  all->count = 1;
  read_picture(&all->picture[0], &o, time_end);
}

void tdm_pictures_free(tdm_pictures *all) {
  for (int i = 0; i < all->count; i++)
    free(all->picture[i].time);
  free(all->picture);
  *all = (tdm_pictures){0};
}
