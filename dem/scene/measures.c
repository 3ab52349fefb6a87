/* Reading what is measured: dem.screening and dem.paths. See docs/scene.md for their keys. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/scene/keys.h"

#include "dem/geometry/screen/screen.h"

#include <stdio.h>
#include <string.h>

enum { NAME_MAX_LENGTH = 36 }; /* so that "screening.NAME.undersized_mass" is a channel's name */

/* ---- names in lists ---- */

/* Entry i of the list of names `key`; NULL after an error. */
static const char *name_at(tdm_object *o, const char *key, json_t *names, size_t i) {
  const char *name = json_string_value(json_array_get(names, i));
  char path[TDM_PATH_MAX];
  if (!name && !o->err->status)
    tdm_fail(o->err, TDM_ERR_SCENE, tdm_path(path, o, key, (int)i), "must be a name, in quotes");
  return o->err->status ? NULL : name;
}

/* Refuse a name that `list` does not have. */
static void refuse_unknown(tdm_object *o, const char *key, size_t i, const char *name, const char *list,
                           const char *near) {
  char path[TDM_PATH_MAX];
  tdm_fail(o->err, TDM_ERR_SCENE, tdm_path(path, o, key, (int)i), "\"%s\" is none of %s; %s%s%s", name, list,
           near ? "did you mean \"" : "add it there or name one of them", near ? near : "", near ? "\"?" : "");
}

/* ---- the product ---- */

static void read_materials(dem_model *m, tdm_object *o) {
  json_t *names = tdm_get_array(o, "materials", false);
  if (names && json_array_size(names) == 0)
    tdm_object_fail(o, "materials", "is empty; name the materials that are screened, or remove the key: all are");
  for (int k = 0; !names && k < m->nmaterial; k++)
    m->material[k].product = true;
  for (size_t i = 0; i < json_array_size(names) && !o->err->status; i++) {
    const char *name = name_at(o, "materials", names, i), *known[64];
    const int k = name ? dem_find_material(m, name) : -1;
    int n = 0;
    for (; n < m->nmaterial && n < 64; n++)
      known[n] = m->material[n].name;
    if (k >= 0)
      m->material[k].product = true;
    else if (name)
      refuse_unknown(o, "materials", i, name, "dem.materials", tdm_nearest(name, known, n));
  }
}

/* ---- decks ---- */

static void read_outlets(dem_model *m, tdm_object *o, int deck) {
  json_t *names = tdm_get_array(o, "outlets", true);
  if (!o->err->status && json_array_size(names) == 0)
    tdm_object_fail(o, "outlets", "is empty; name the sinks by which particles leave the deck");
  for (size_t i = 0; i < json_array_size(names) && !o->err->status; i++) {
    const char *name = name_at(o, "outlets", names, i), *known[DEM_SINKS_MAX];
    int s = -1;
    for (int k = 0; k < m->nsink; k++) {
      known[k] = m->sink[k].name;
      s = name && strcmp(known[k], name) == 0 ? k : s;
    }
    if (name && s < 0)
      refuse_unknown(o, "outlets", i, name, "dem.sinks", tdm_nearest(name, known, m->nsink));
    else if (name && m->screening.deck_of[s] >= 0)
      tdm_object_fail(o, "outlets", "\"%s\" is an outlet of \"%s\" already; a sink belongs to one deck", name,
                      m->screening.deck[m->screening.deck_of[s]].name);
    else if (name)
      m->screening.deck_of[s] = deck;
  }
}

/* the screen that is watched for blocked holes: a shape of a body */
static void read_screen(const dem_model *m, tdm_object *o, dem_screening_deck *deck) {
  deck->screen = -1;
  if (!tdm_has(o, "screen")) {
    if (tdm_has(o, "blocking_time"))
      tdm_object_fail(o, "blocking_time", "is for decks whose \"screen\" is named; name it or remove this key");
    return;
  }
  deck->blocking_time = tdm_get_number(o, "blocking_time", 0.5, TDM_POSITIVE);
  tdm_object s = tdm_get_object(o, "screen", true);
  const int body = dem_read_body(m, &s, "body"), shape = (int)tdm_get_integer(&s, "shape", 0, 0);
  int many = 0;
  for (int g = 0; g < m->ngeometry && !o->err->status; g++) {
    const dem_geometry *one = &m->geometry[g];
    if (one->body != body || many++ != shape)
      continue;
    const dem_screen *screen = one->nwall == 1 ? dem_screen_of(&m->wall[one->first_wall]) : NULL;
    if (screen) {
      deck->screen = one->first_wall;
      deck->holes = dem_screen_holes(screen);
    } else
      tdm_object_fail(&s, "shape",
                      "is %d, but entry %d of the shapes of \"%s\" is no screen; give the number of one, "
                      "from 0",
                      shape, shape, m->body[body].name);
  }
  if (deck->screen < 0 && !o->err->status)
    tdm_object_fail(&s, "shape", "is %d, but \"%s\" has %d shapes; they are numbered from 0", shape, m->body[body].name,
                    many);
  tdm_object_close(&s);
}

static void read_deck(dem_model *m, tdm_object *o, int k, bool lowest) {
  dem_screening_deck *deck = &m->screening.deck[k];
  deck->name = dem_read_name(o, NAME_MAX_LENGTH);
  m->screening.ndeck = k + 1;
  for (int i = 0; i < k && !o->err->status; i++)
    if (strcmp(m->screening.deck[i].name, deck->name) == 0)
      tdm_object_fail(o, "name", "\"%s\" is the name of dem.screening.decks[%d] already; give each its own", deck->name,
                      i);
  read_outlets(m, o, k);
  read_screen(m, o, deck);
  for (int i = 0; i < k && !o->err->status; i++)
    if (deck->screen >= 0 && m->screening.deck[i].screen == deck->screen)
      tdm_object_fail(o, "screen", "is that of \"%s\" already; each deck has its own", m->screening.deck[i].name);
  const double given = tdm_has(o, "sorted") || !lowest ? TDM_REQUIRED : 0;
  deck->sorted = tdm_get_number(o, "sorted", given, TDM_NOT_NEGATIVE);
  if (k > 0 && !o->err->status && deck->sorted > deck[-1].sorted)
    tdm_object_fail(o, "sorted", "is %g m, more than the %g m of \"%s\" above it; name the highest deck first",
                    deck->sorted, deck[-1].sorted, deck[-1].name);
  tdm_object_close(o);
}

static void read_decks(dem_model *m, tdm_object *o) {
  json_t *decks = tdm_get_array(o, "decks", true);
  const size_t n = json_array_size(decks);
  if (!o->err->status && (n == 0 || n > DEM_SINKS_MAX))
    tdm_object_fail(o, "decks", "has %zu entries; give 1 to %d, the highest first", n, DEM_SINKS_MAX);
  if (o->err->status)
    return;
  m->screening.deck = dem_allocate(n, sizeof *m->screening.deck, o->err);
  for (int s = 0; s < DEM_SINKS_MAX; s++)
    m->screening.deck_of[s] = -1;
  for (size_t k = 0; k < n && !o->err->status; k++) {
    char path[TDM_PATH_MAX];
    tdm_object deck = tdm_object_open(json_array_get(decks, k), tdm_path(path, o, "decks", (int)k), o->err);
    read_deck(m, &deck, (int)k, k + 1 == n);
  }
}

/* Looks are so dense that the shortest blocking time has 20 of them. */
static void plan_looks(dem_model *m) {
  double shortest = INFINITY;
  for (int k = 0; k < m->screening.ndeck; k++)
    if (m->screening.deck[k].screen >= 0)
      shortest = fmin(shortest, m->screening.deck[k].blocking_time);
  m->screening.watched = isfinite(shortest);
  m->screening.every = m->screening.watched ? (uint64_t)fmin(fmax(shortest / (20 * m->dt), 1), 1e9) : 1;
}

void dem_screening_read(dem_model *m, tdm_object *section) {
  if (!tdm_has(section, "screening"))
    return;
  tdm_object o = tdm_get_object(section, "screening", true);
  read_materials(m, &o);
  read_decks(m, &o);
  plan_looks(m);
  m->screening.start = tdm_get_number(&o, "start", m->time_start, TDM_ANY);
  m->screening.smoothing = tdm_get_number(&o, "smoothing", 1, TDM_POSITIVE);
  if (m->screening.start < m->time_start)
    tdm_object_fail(&o, "start", "is %g s, before the run begins at %g s", m->screening.start, m->time_start);
  tdm_object_close(&o);
}

/* ---- paths ---- */

static void read_trace(dem_model *m, tdm_object *o) {
  dem_trace *trace = &m->trace[m->ntrace];
  trace->name = dem_read_name(o, NAME_MAX_LENGTH);
  for (int k = 0; k < m->ntrace && !o->err->status; k++)
    if (strcmp(m->trace[k].name, trace->name) == 0)
      tdm_object_fail(o, "name", "\"%s\" is the name of dem.paths[%d] already; give each its own", trace->name, k);
  m->ntrace++;
  trace->particle = (uint64_t)tdm_get_integer(o, "particle", TDM_REQUIRED_INT, 0);
  trace->body = tdm_has(o, "body") ? dem_read_body(m, o, "body") : -1;
  trace->source = -1;
  const char *source = tdm_has(o, "source") ? tdm_get_string(o, "source", NULL) : NULL, *known[64];
  int n = 0;
  for (int s = 0; source && s < m->nsource; s++) {
    if (n < 64)
      known[n++] = m->source[s].name;
    if (strcmp(source, m->source[s].name) == 0)
      trace->source = s;
  }
  if (source && trace->source < 0 && !o->err->status) {
    const char *near = tdm_nearest(source, known, n);
    tdm_object_fail(o, "source", "\"%s\" is none of dem.sources; %s%s%s", source,
                    near ? "did you mean \"" : "name one of them, or leave it out to count all particles",
                    near ? near : "", near ? "\"?" : "");
  }
  tdm_object_close(o);
}

void dem_traces_read(dem_model *m, json_t *paths, tdm_error *err) {
  const size_t n = json_array_size(paths);
  if (n > DEM_TRACES_MAX) {
    tdm_fail(err, TDM_ERR_SCENE, "dem.paths", "has %zu entries; at most %d are supported", n, DEM_TRACES_MAX);
    return;
  }
  m->trace = dem_allocate(n, sizeof *m->trace, err);
  for (size_t i = 0; i < n && !err->status; i++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.paths[%zu]", i);
    tdm_object o = tdm_object_open(json_array_get(paths, i), path, err);
    read_trace(m, &o);
  }
}
