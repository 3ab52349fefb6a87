/* The variables of an exported FMU: see variables.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/export/serve/variables.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const cpl_export_sides[CPL_NEXPORT] = {"dem", "mbd", "both"};

/* A vector of a body: its components, and the vector among the motion whose derivative it is, from its own place back
 * (0: none). */
typedef struct {
  const char *name, *unit, *components;
  int back;
} vector;

static const vector motion[] = {{"position", "m", "xyz", 0},        {"orientation", "1", "wxyz", 0},
                                {"velocity", "m/s", "xyz", 7},      {"angular_velocity", "rad/s", "xyz", 0},
                                {"acceleration", "m/s2", "xyz", 6}, {"angular_acceleration", "rad/s2", "xyz", 6}};
static const vector load[] = {{"force", "N", "xyz", 0}, {"moment", "N.m", "xyz", 0}};
enum { NMOTION = sizeof motion / sizeof motion[0], NLOAD = sizeof load / sizeof load[0] };

cpl_export_layout cpl_export_layout_of(cpl_export_side side, const cpl_session *s) {
  const int motions = s->acceleration ? CPL_MOTION : TDM_STATE_DOUBLES;
  cpl_export_layout l = {.nbody = s->settings->nbody,
                         .input = side == CPL_EXPORT_DEM ? CPL_MOTION : CPL_LOAD,
                         .output = side == CPL_EXPORT_DEM   ? CPL_LOAD
                                   : side == CPL_EXPORT_MBD ? motions
                                                            : motions + CPL_LOAD};
  for (int r = 0; r < CPL_NROLE; r++)
    l.nchannel[r] = cpl_export_has(side, (cpl_role)r) ? s->partner[r].nchannel : 0;
  return l;
}

void cpl_export_starts(cpl_export_side side, const cpl_session *s, double *out) {
  const cpl_export_layout l = cpl_export_layout_of(side, s);
  memset(out, 0, (size_t)cpl_export_ninput(&l) * sizeof *out);
  for (int i = 0; i < l.nbody && side == CPL_EXPORT_DEM; i++)
    memcpy(out + i * CPL_MOTION, &s->body[i].state, sizeof s->body[i].state);
}

/* ---- the list ---- */

typedef struct {
  cpl_export_variable *variable;
  int n;
} list;

static void add_vectors(list *l, const vector *v, int nvector, const char *body, const char *whose, const char *what,
                        bool input) {
  for (int k = 0; k < nvector; k++)
    for (const char *c = v[k].components; *c; c++) {
      cpl_export_variable *to = &l->variable[l->n];
      *to = (cpl_export_variable){.input = input, .derivative_of = !input && v[k].back ? l->n - v[k].back : -1};
      snprintf(to->name, sizeof to->name, "%s.%s%s.%c", body, whose, v[k].name, *c);
      snprintf(to->unit, sizeof to->unit, "%s", v[k].unit);
      snprintf(to->description, sizeof to->description, "%s", what);
      l->n++;
    }
}

static void add_body(list *l, cpl_export_side side, const char *body, bool accelerates, bool input) {
  const bool dem = side == CPL_EXPORT_DEM;
  if (input && dem)
    add_vectors(l, motion, NMOTION, body, "", "motion of the body, centre of mass, world frame", true);
  else if (input)
    add_vectors(l, load, NLOAD, body, "", "load on the body, about its centre of mass, world frame", true);
  if (!input && !dem)
    add_vectors(l, motion, accelerates ? NMOTION : NMOTION - 2, body, "",
                "motion of the body, centre of mass, world frame", false);
  if (!input && side != CPL_EXPORT_MBD)
    add_vectors(l, load, NLOAD, body, dem ? "" : "particles.",
                "load of the particles on the body, about its centre of mass, world frame, mean over the step", false);
}

static void add_channels(list *l, const cpl_session *s, cpl_role role) {
  const cpl_partner *p = &s->partner[role];
  for (int k = 0; k < p->nchannel; k++) {
    cpl_export_variable *to = &l->variable[l->n++];
    *to = (cpl_export_variable){.derivative_of = -1};
    snprintf(to->name, sizeof to->name, "%s.%s", cpl_role_names[role], p->channel[k].name);
    snprintf(to->unit, sizeof to->unit, "%s", p->channel[k].unit);
    snprintf(to->description, sizeof to->description, "channel of the solver%s",
             p->channel[k].gaps ? "; NaN where it is not defined" : "");
  }
}

static int compare(const void *a, const void *b) {
  return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static tdm_status check_names(const list *l, tdm_error *err) {
  const char **name = calloc((size_t)l->n + 1, sizeof *name);
  if (!name)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i < l->n; i++)
    name[i] = l->variable[i].name;
  qsort(name, (size_t)l->n, sizeof *name, compare);
  for (int i = 1; i < l->n && err->status == TDM_OK; i++)
    if (strcmp(name[i - 1], name[i]) == 0)
      tdm_fail(err, TDM_ERR_SCENE, "coupling.bodies",
               "two variables of the FMU would be called \"%.200s\"; give the body another name", name[i]);
  free(name);
  return err->status;
}

cpl_export_variable *cpl_export_variables(cpl_export_side side, const cpl_session *s, int *n, tdm_error *err) {
  const cpl_export_layout layout = cpl_export_layout_of(side, s);
  const int ninput = cpl_export_ninput(&layout), noutput = cpl_export_noutput(&layout);
  const cpl_role role = side == CPL_EXPORT_DEM ? CPL_DEM : CPL_MBD;
  const bool follows = side != CPL_EXPORT_DEM && s->mobility.Y;
  double *start = calloc((size_t)ninput + 1, sizeof *start);
  list l = {.variable = calloc((size_t)(ninput + noutput) + 1, sizeof *l.variable)};
  if (!start || !l.variable) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  } else {
    cpl_export_starts(side, s, start);
    for (int i = 0; i < layout.nbody; i++)
      add_body(&l, side, s->settings->body[i].name[role], s->acceleration, true);
    for (int i = 0; i < ninput; i++)
      l.variable[i].start = start[i];
    for (int i = 0; i < layout.nbody; i++)
      add_body(&l, side, s->settings->body[i].name[role], s->acceleration, false);
    for (int i = 0; i < layout.nbody * layout.output && follows; i++) {
      const int at = i % layout.output;
      l.variable[ninput + i].follows = at >= TDM_STATE_DOUBLES && at < CPL_MOTION ? ninput : 0;
    }
    for (int r = 0; r < CPL_NROLE; r++)
      if (layout.nchannel[r] > 0)
        add_channels(&l, s, (cpl_role)r);
    check_names(&l, err);
  }
  free(start);
  *n = l.n;
  if (err->status == TDM_OK)
    return l.variable;
  free(l.variable);
  return NULL;
}
