/* Wall files of MOLDYN: see walls.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/moldyn/walls.h"

#include "dem/moldyn/text.h"

#include <stdlib.h>

enum { COUNT_MAX = 100000 };

static const double same = 1e-9; /* of a length: round-off */

/* ---- rows ---- */

/* number and thickness, in the first row */
static int read_head(dem_text *t, dem_win *win) {
  if (!dem_text_row(t)) {
    dem_text_fail(t, t->line + 1, "holds nothing; begin with the number of walls and their thickness");
    return 0;
  }
  if (t->nfield != 2) {
    dem_text_fail(t, t->line,
                  "the first row of a wall file has 2 numbers, this one %d; give the number of walls and "
                  "their thickness in m",
                  t->nfield);
    return 0;
  }
  double count = dem_text_number(t, 0, "number of walls");
  win->thickness = dem_text_number(t, 1, "thickness");
  if (!(count >= 0 && count <= COUNT_MAX && count == floor(count)))
    dem_text_fail(t, t->line, "the number of walls is %g; give a whole number up to %d", count, COUNT_MAX);
  if (!(win->thickness >= 0))
    dem_text_fail(t, t->line, "the thickness is %g m but must be 0 or greater", win->thickness);
  return t->err->status ? 0 : (int)count;
}

static void read_normal(dem_text *t, dem_win_wall *w, tdm_vec3 normal) {
  double length = tdm_norm(normal);
  if (!(fabs(length - 1) <= 0.01))
    dem_text_fail(
        t, t->line,
        "the normal [%g, %g, %g] (fields 1 to 3) has the length %.4g but must have 1; correct it, or say that "
        "the file has end points (\"form\": \"end_points\")",
        normal.x, normal.y, normal.z, length);
  else
    w->normal = tdm_scale(1 / length, normal);
}

static void read_ends(dem_text *t, dem_win_wall *w) {
  tdm_vec3 along = tdm_sub(w->to, w->at);
  double length = tdm_norm(along);
  if (along.y != 0)
    dem_text_fail(
        t, t->line,
        "the end points have y = %g and %g m; a wall by end points lies in the plane of x and z, so give both "
        "the same y, or walls by normals (\"form\": \"normals\")",
        w->at.y, w->to.y);
  else if (!(length > 0))
    dem_text_fail(t, t->line, "both ends are at [%g, %g] m; give two different points", w->at.x, w->at.z);
  else
    w->normal = tdm_v3(-along.z / length, 0, along.x / length);
}

static void read_row(dem_text *t, dem_win_form form, dem_win_wall *w) {
  const bool ends = form == DEM_WIN_END_POINTS, flat = ends && t->nfield == 4;
  static const char *const three[2] = {"n_x n_y n_z x y z", "a_x a_y a_z b_x b_y b_z, or a_x a_z b_x b_z"};
  double v[6] = {0};
  if (t->nfield != 6 && !flat) {
    dem_text_fail(t, t->line, "a wall has 6 numbers, this row %d; give %s", t->nfield, three[ends]);
    return;
  }
  for (int k = 0; k < t->nfield; k++)
    v[k] = dem_text_number(t, k, ends ? "of an end point" : k < 3 ? "of the normal" : "of the centre");
  if (t->err->status)
    return;
  tdm_vec3 first = flat ? tdm_v3(v[0], 0, v[1]) : tdm_v3(v[0], v[1], v[2]);
  tdm_vec3 second = flat ? tdm_v3(v[2], 0, v[3]) : tdm_v3(v[3], v[4], v[5]);
  *w = (dem_win_wall){.at = ends ? first : second, .to = second, .line = t->line};
  if (ends)
    read_ends(t, w);
  else
    read_normal(t, w, first);
}

/* ---- do walls by normals fit each other? ---- */

static bool opposite(const dem_win_wall *a, const dem_win_wall *b) {
  return tdm_dot(a->normal, b->normal) < -1 + 1e-6;
}

/* the only wall that is parallel to wall i and looks the other way, NULL: there is none, or several */
static const dem_win_wall *facing(const dem_win *win, int i) {
  const dem_win_wall *found = NULL;
  for (int j = 0; j < win->count; j++) {
    if (!opposite(&win->wall[i], &win->wall[j]))
      continue;
    if (found)
      return NULL;
    found = &win->wall[j];
  }
  return found;
}

/* Where, along the normal n, the centres of the walls across are. False: there are none, or they do not agree. */
static bool middle_across(const dem_win *win, tdm_vec3 n, double width, double *middle) {
  int many = 0;
  for (int k = 0; k < win->count; k++) {
    double at = tdm_dot(win->wall[k].at, n);
    if (fabs(tdm_dot(win->wall[k].normal, n)) > 1e-6)
      continue;
    if (many++ > 0 && fabs(at - *middle) > 1e-4 * width)
      return false;
    *middle = at;
  }
  return many > 1;
}

/* is half the distance of two walls that face each other this one? */
static bool half_of_others(const dem_win *win, double half) {
  for (int i = 0; i < win->count; i++) {
    const dem_win_wall *a = &win->wall[i], *b = facing(win, i);
    if (b && fabs(0.5 * tdm_dot(tdm_sub(b->at, a->at), a->normal) - half) <= 1e-4 * half)
      return true;
  }
  return false;
}

static void check_facing(dem_text *t, const dem_win *win, const dem_win_wall *a, const dem_win_wall *b) {
  double width = tdm_dot(tdm_sub(b->at, a->at), a->normal), middle = 0;
  if (!(width > win->thickness)) {
    dem_text_fail(t, b->line,
                  "the wall and that of line %ld look away from each other, and leave no room between them; turn a "
                  "normal round, or move one of them",
                  a->line);
    return;
  }
  if (!middle_across(win, a->normal, width, &middle))
    return;
  double before = middle - tdm_dot(a->at, a->normal), behind = width - before;
  if (fabs(before - behind) <= 1e-4 * width)
    return;
  bool first = !half_of_others(win, before) || half_of_others(win, behind);
  const dem_win_wall *bad = first ? a : b;
  tdm_vec3 to = tdm_axpy(first ? before - behind : behind - before, bad->normal, bad->at);
  dem_text_fail(
      t, bad->line,
      "the wall at [%g, %g, %g] m does not fit its neighbours: the centres of the walls across are %.6g m in "
      "front of it, but %.6g m in front of the wall that faces it (line %ld); move it to [%g, %g, %g], or, if "
      "that is meant, set \"fits\": false",
      bad->at.x, bad->at.y, bad->at.z, first ? before : behind, first ? behind : before, first ? b->line : a->line,
      to.x, to.y, to.z);
}

static void check_normals(dem_text *t, const dem_win *win) {
  for (int i = 0; i < win->count && !t->err->status; i++) {
    const dem_win_wall *a = &win->wall[i], *b = facing(win, i);
    for (int j = 0; j < i; j++)
      if (tdm_dot(a->normal, win->wall[j].normal) > 1 - same &&
          tdm_norm(tdm_sub(a->at, win->wall[j].at)) <= same * (win->thickness + tdm_norm(a->at)))
        dem_text_fail(t, a->line, "the wall is that of line %ld again; remove one of them", win->wall[j].line);
    if (b && b > a)
      check_facing(t, win, a, b);
  }
}

/* ---- do walls by end points fit each other? ---- */

static double length_of(const dem_win_wall *w) {
  return tdm_norm(tdm_sub(w->to, w->at));
}

/* an end of a that misses an end of b by little */
static void check_gap(dem_text *t, const dem_win_wall *a, const dem_win_wall *b) {
  double length = fmin(length_of(a), length_of(b));
  const tdm_vec3 ends[2][2] = {{a->at, a->to}, {b->at, b->to}};
  for (int k = 0; k < 4; k++) {
    tdm_vec3 p = ends[0][k / 2], q = ends[1][k % 2];
    double apart = tdm_norm(tdm_sub(p, q));
    if (apart > same * length && apart <= 1e-3 * length)
      dem_text_fail(
          t, b->line,
          "the end [%.9g, %.9g] m misses that of line %ld, [%.9g, %.9g], by %.3g m; let them meet, or, if the "
          "gap is meant, set \"fits\": false",
          q.x, q.z, a->line, p.x, p.z, apart);
  }
}

/* walls that end at b's end, less those that begin there, and how many there are */
static int balance_at(const dem_win *win, tdm_vec3 x, double tolerance, int *many) {
  int sum = 0;
  *many = 0;
  for (int k = 0; k < win->count; k++) {
    int ends = tdm_norm(tdm_sub(win->wall[k].to, x)) <= tolerance,
        begins = tdm_norm(tdm_sub(win->wall[k].at, x)) <= tolerance;
    sum += ends - begins;
    *many += ends + begins;
  }
  return sum;
}

static void check_end_points(dem_text *t, const dem_win *win) {
  for (int i = 0; i < win->count && !t->err->status; i++) {
    const dem_win_wall *w = &win->wall[i];
    for (int j = 0; j < i; j++)
      check_gap(t, &win->wall[j], w);
    for (int k = 0; k < 2; k++) {
      tdm_vec3 x = k ? w->to : w->at;
      int many, sum = balance_at(win, x, same * length_of(w), &many);
      if (many > 1 && abs(sum) == many)
        dem_text_fail(
            t, w->line,
            "all %d walls at [%g, %g] m %s there, so that neighbours look to opposite sides; turn one of them "
            "round, or, if that is meant, set \"fits\": false",
            many, x.x, x.z, sum > 0 ? "end" : "begin");
    }
  }
}

/* ---- the file ---- */

tdm_status dem_win_read(dem_win *win, const char *file, dem_win_form form, bool fits, const char *path,
                        tdm_error *err) {
  dem_text t;
  *win = (dem_win){0};
  if (dem_text_open(&t, file, path, err))
    return err->status;
  int count = read_head(&t, win);
  long first = t.line;
  win->wall = calloc((size_t)count + 1, sizeof *win->wall);
  if (!win->wall)
    tdm_fail(err, TDM_ERR_MEMORY, path, "%s: no memory for %d walls", file, count);
  while (dem_text_row(&t)) {
    if (win->count == count)
      dem_text_fail(&t, t.line, "is a wall too many: line %ld says %d; correct that number, or remove the row", first,
                    count);
    else
      read_row(&t, form, &win->wall[win->count++]);
  }
  if (win->count < count)
    dem_text_fail(&t, first, "says %d walls, but the file has %d; correct the number, or add the rows", count,
                  win->count);
  if (fits && !err->status && form == DEM_WIN_NORMALS)
    check_normals(&t, win);
  else if (fits && !err->status)
    check_end_points(&t, win);
  dem_text_close(&t);
  return err->status;
}

void dem_win_free(dem_win *win) {
  free(win->wall);
  *win = (dem_win){0};
}
