/* Control files of MOLDYN as scenes: see control.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/moldyn/control.h"

#include "dem/moldyn/text.h"

#include <stdlib.h>
#include <string.h>

/* the keys, and what each is; X(name, member, range): a is any number, p positive, n not negative, m not positive */
#define KEYS(X)                           \
  X("times.t0", start, a)                 \
  X("times.tend", end, a)                 \
  X("times.dt", dt, p)                    \
  X("control.grav", gravity, a)           \
  X("control.rho", density, p)            \
  X("control.mue_s", static_friction, n)  \
  X("control.mue_d", friction, n)         \
  X("sd.stiff_lo", loading, p)            \
  X("sd.stiff_k_un", unloading, p)        \
  X("sd.stiff_adh", adhesion, m)          \
  X("sd.damp_particle", damp_particle, n) \
  X("sd.damp_wall", damp_wall, n)         \
  X("sd.e", restitution, n)

enum {
#define X(name, member, range) KEY_##member,
  KEYS(X)
#undef X
      NKEY
};

static const char *const names[NKEY] = {
#define X(name, member, range) [KEY_##member] = name,
    KEYS(X)
#undef X
};

static const char ranges[] = {
#define X(name, member, range) #range[0],
    KEYS(X)
#undef X
};

typedef struct {
  double value[NKEY];
  long line[NKEY]; /* 0: not given */
} control;

/* ---- reading ---- */

static int find_key(dem_text *t) {
  for (int k = 0; k < NKEY; k++)
    if (strcmp(t->field[0], names[k]) == 0)
      return k;
  const char *near = tdm_nearest(t->field[0], names, NKEY);
  dem_text_fail(t, t->line, "\"%.40s\" is no key of a control file; %s%s%s", t->field[0],
                near ? "did you mean \"" : "remove the row", near ? near : "", near ? "\"?" : "");
  return 0;
}

static void check_range(dem_text *t, int k, double x) {
  const char *must = ranges[k] == 'p' && !(x > 0)    ? "greater than 0"
                     : ranges[k] == 'n' && !(x >= 0) ? "0 or greater"
                     : ranges[k] == 'm' && !(x <= 0) ? "0 or less: an adhesive stiffness is negative in this file"
                                                     : NULL;
  if (must)
    dem_text_fail(t, t->line, "%s is %g but must be %s", names[k], x, must);
}

static void read_row(dem_text *t, control *c) {
  if (t->nfield != 2) {
    dem_text_fail(t, t->line, "a row of a control file is a key and a number, this one has %d fields; correct it",
                  t->nfield);
    return;
  }
  int k = find_key(t);
  double x = t->err->status ? 0 : dem_text_number(t, 1, names[k]);
  check_range(t, k, x);
  if (c->line[k])
    dem_text_fail(t, t->line, "%s is given in line %ld already; remove one of the two", names[k], c->line[k]);
  c->value[k] = x;
  c->line[k] = t->line;
}

static void check_whole(dem_text *t, const control *c) {
  const double *v = c->value;
  for (int k = 0; k < NKEY; k++)
    if (!c->line[k])
      dem_text_fail(t, t->line, "ends without %s; add a row with it", names[k]);
  if (!(v[KEY_end] > v[KEY_start]))
    dem_text_fail(t, c->line[KEY_end], "times.tend is %g s but must be after times.t0 = %g s (line %ld)", v[KEY_end],
                  v[KEY_start], c->line[KEY_start]);
  if (v[KEY_dt] > v[KEY_end] - v[KEY_start])
    dem_text_fail(t, c->line[KEY_dt], "times.dt is %g s, longer than the run, %g s; shorten it", v[KEY_dt],
                  v[KEY_end] - v[KEY_start]);
  if (v[KEY_static_friction] < v[KEY_friction])
    dem_text_fail(t, c->line[KEY_static_friction],
                  "control.mue_s is %g but must be at least control.mue_d, %g (line %ld)", v[KEY_static_friction],
                  v[KEY_friction], c->line[KEY_friction]);
  if (v[KEY_unloading] < v[KEY_loading])
    dem_text_fail(t, c->line[KEY_unloading],
                  "sd.stiff_k_un is %g N/m but must be at least sd.stiff_lo, %g N/m (line %ld)", v[KEY_unloading],
                  v[KEY_loading], c->line[KEY_loading]);
  if (v[KEY_restitution] > 1)
    dem_text_fail(t, c->line[KEY_restitution], "sd.e is %g but must be at most 1", v[KEY_restitution]);
  if (v[KEY_restitution] == 0 &&
      (v[KEY_damp_wall] == 0 || (v[KEY_damp_particle] == 0 && v[KEY_unloading] == v[KEY_loading])))
    dem_text_fail(
        t, c->line[KEY_restitution],
        "sd.e is 0, and where no damping is given it must be greater than 0: a small value such as 0.01 takes "
        "nearly all the energy");
}

/* ---- the scene ---- */

static void note(json_t *notes, const char *text) {
  json_array_append_new(notes, json_string(text));
}

static bool hysteretic(const control *c) {
  return c->value[KEY_unloading] > c->value[KEY_loading];
}

static json_t *contact_of(const control *c, json_t *notes) {
  bool sticks = c->value[KEY_static_friction] > c->value[KEY_friction];
  if (sticks)
    note(notes,
         "control.mue_s is greater than control.mue_d: friction is held by a spring of 2/7 of the normal stiffness");
  return json_pack("{s:s, s:s}", "normal", hysteretic(c) ? "hysteretic" : "hooke", "tangential",
                   sticks ? "spring" : "coulomb");
}

static void set_friction(json_t *pair, const control *c) {
  double hold = c->value[KEY_static_friction], slide = c->value[KEY_friction];
  json_object_set_new(pair, "friction",
                      hold > slide ? json_pack("{s:f, s:f}", "static", hold, "dynamic", slide) : json_real(slide));
}

/* spring and dashpot: damping, or the restitution where it is 0 */
static void set_dashpot(json_t *pair, const control *c, int damping) {
  if (c->value[damping] > 0)
    json_object_set_new(pair, "damping", json_real(c->value[damping]));
  else
    json_object_set_new(pair, "restitution", json_real(c->value[KEY_restitution]));
}

static json_t *particle_pair(const control *c, json_t *notes) {
  const double *v = c->value;
  json_t *pair = json_pack("{s:[s, s], s:f}", "materials", "particle", "particle", "stiffness", v[KEY_loading]);
  if (hysteretic(c)) {
    json_object_set_new(pair, "unloading_stiffness", json_real(v[KEY_unloading]));
    json_object_set_new(pair, "adhesion_stiffness", json_real(v[KEY_adhesion] < 0 ? -v[KEY_adhesion] : 0));
    if (v[KEY_damp_particle] > 0)
      note(notes, "sd.damp_particle has no effect: sd.stiff_k_un > sd.stiff_lo dissipates instead ([A07] Eq. 2.41)");
  } else {
    set_dashpot(pair, c, KEY_damp_particle);
    if (v[KEY_adhesion] < 0)
      note(notes, "sd.stiff_adh has no effect: with sd.stiff_k_un = sd.stiff_lo a contact unloads to zero overlap");
  }
  set_friction(pair, c);
  return pair;
}

static json_t *wall_pair(const control *c) {
  json_t *pair = json_pack("{s:[s, s], s:f}", "materials", "particle", "wall", "stiffness", c->value[KEY_loading]);
  if (hysteretic(c))
    json_object_set_new(pair, "normal", json_string("hooke"));
  set_dashpot(pair, c, KEY_damp_wall);
  set_friction(pair, c);
  return pair;
}

static json_t *dem_of(const control *c, const dem_cin_options *o, json_t *notes) {
  const double density = c->value[KEY_density];
  json_t *dem = json_pack("{s:[f, f, f], s:o, s:[{s:s, s:f}, {s:s, s:f}], s:[o, o], s:b}", "gravity", 0.0, 0.0,
                          c->value[KEY_gravity], "contact", contact_of(c, notes), "materials", "name", "particle",
                          "density", density, "name", "wall", "density", density, "pairs", particle_pair(c, notes),
                          wall_pair(c), "orientation", true);
  if (o->flat)
    json_object_update_new(dem, json_pack("{s:i, s:s}", "dimension", 2, "plane", "xz"));
  if (o->walls)
    json_object_set_new(dem, "bodies",
                        json_pack("[{s:s, s:s, s:[{s:s, s:s, s:s}]}]", "name", "walls", "material", "wall", "shapes",
                                  "type", "moldyn", "file", o->walls, "form",
                                  o->form == DEM_WIN_NORMALS ? "normals" : "end_points"));
  json_object_set_new(dem, "particles",
                      json_pack("[{s:s, s:s, s:s}]", "type", "moldyn", "material", "particle", "file", o->particles));
  return dem;
}

static json_t *scene_of(const char *file, const control *c, const dem_cin_options *o, json_t *notes) {
  const double length = c->value[KEY_end] - c->value[KEY_start], dt = c->value[KEY_dt];
  char title[256];
  snprintf(title, sizeof title, "MOLDYN: %.200s", strrchr(file, '/') ? strrchr(file, '/') + 1 : file);
  if (c->value[KEY_start] != 0)
    note(notes, "times.t0 is not 0: the scene begins at 0 and is as long");
  return json_pack("{s:s, s:{s:f, s:f}, s:{s:f, s:f}, s:o}", "title", title, "time", "end", length, "dt", dt, "output",
                   "interval", fmax(dt, length / 1000), "particles_interval", fmax(dt, length / 100), "dem",
                   dem_of(c, o, notes));
}

json_t *dem_cin_read(const char *file, const dem_cin_options *options, json_t **notes, tdm_error *err) {
  dem_text t;
  control c = {0};
  *notes = json_array();
  if (dem_text_open(&t, file, NULL, err))
    return NULL;
  while (dem_text_row(&t))
    read_row(&t, &c);
  check_whole(&t, &c);
  dem_text_close(&t);
  json_t *scene = err->status ? NULL : scene_of(file, &c, options, *notes);
  if (!scene)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "%s: no memory for the scene", file);
  return scene;
}
