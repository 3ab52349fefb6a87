/* Reading the server's part of a scene: see settings.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/settings/settings.h"

#include "coupler/settings/scheme.h"
#include "protocol/scene/time_section.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SCHEMES_MAX = 32 };

/* A body's name becomes part of a file name and of a CSV header. */
static void check_name(tdm_object *o, const char *key, const char *name) {
  if (!*name)
    tdm_object_fail(o, key, "\"%s\" is no name of a body", name);
  else if (strlen(name) > 100)
    tdm_object_fail(o, key, "has %zu characters; take at most 100", strlen(name));
  else if (!cpl_name_fits_file(name))
    tdm_object_fail(
        o, key, "\"%s\" has a character that does not fit a file name; use letters, digits, _ - ., and no dot in front",
        name);
}

static void read_bodies(cpl_settings *s, tdm_object *coupling) {
  json_t *array = tdm_get_array(coupling, "bodies", true);
  char path[TDM_PATH_MAX];
  if (json_array_size(array) > CPL_BODIES_MAX) {
    tdm_object_fail(coupling, "bodies", "has %zu entries; at most %d bodies can be coupled", json_array_size(array),
                    CPL_BODIES_MAX);
    return;
  }
  s->nbody = (int)json_array_size(array);
  s->body = calloc((size_t)s->nbody + 1, sizeof *s->body);
  if (!s->body) {
    s->nbody = 0;
    tdm_fail(coupling->err, TDM_ERR_MEMORY, NULL, "out of memory");
    return;
  }
  json_t *const seen[CPL_NROLE] = {json_object(), json_object()}; /* names, with their numbers */
  for (int i = 0; i < s->nbody && !coupling->err->status; i++) {
    tdm_object o =
        tdm_object_open(json_array_get(array, (size_t)i), tdm_path(path, coupling, "bodies", i), coupling->err);
    for (int r = 0; r < CPL_NROLE; r++) {
      s->body[i].name[r] = tdm_get_string(&o, cpl_role_names[r], NULL);
      check_name(&o, cpl_role_names[r], s->body[i].name[r]);
      const json_t *other = json_object_get(seen[r], s->body[i].name[r]);
      if (other)
        tdm_object_fail(&o, cpl_role_names[r],
                        "\"%s\" is coupled twice (coupling.bodies[%lld] too); a body has one partner",
                        s->body[i].name[r], (long long)json_integer_value(other));
      json_object_set_new(seen[r], s->body[i].name[r], json_integer(i));
    }
    tdm_object_close(&o);
  }
  for (int r = 0; r < CPL_NROLE; r++)
    json_decref(seen[r]);
}

/* "tcp://127.0.0.1:PORT": this machine only, a link beyond it would need keys. */
static void read_address(cpl_settings *s, tdm_object *o) {
  static const char host[] = "tcp://127.0.0.1:";
  s->address = tdm_get_string(o, "address", "tcp://127.0.0.1:*");
  if (tdm_has(o, "address") && s->transport != CPL_TCP)
    tdm_object_fail(o, "address", "goes with \"transport\": \"tcp\"; set that, or leave the address out");
  const char *port = strncmp(s->address, host, strlen(host)) == 0 ? s->address + strlen(host) : "";
  bool number = *port && strspn(port, "0123456789") == strlen(port) && strlen(port) < 6 && atol(port) <= 65535;
  if (!number && strcmp(port, "*") != 0)
    tdm_object_fail(o, "address", "\"%s\" is no address on this machine; give tcp://127.0.0.1:PORT", s->address);
}

/* A foreign solver: a command, or null for one that somebody else starts. */
static void read_solver(cpl_settings *s, int role, tdm_object *o, const char *key) {
  if (!tdm_has(o, key))
    return;
  tdm_path(s->solver_path[role], o, key, -1);
  s->by_hand[role] = json_is_null(json_object_get(o->json, key));
  if (!s->by_hand[role])
    s->command[role] = tdm_get_string(o, key, NULL);
  else if (s->transport != CPL_TCP)
    tdm_object_fail(o, key, "is null: it is started by hand, which needs \"transport\": \"tcp\" and an \"address\"");
}

/* mbd.solver and dem.solver; or coupling.solvers, where they stood before. */
static void read_solvers(cpl_settings *s, tdm_object *root) {
  tdm_object coupling = tdm_object_open(json_object_get(root->json, "coupling"), "coupling", root->err);
  tdm_object before = tdm_get_object(&coupling, "solvers", false);
  for (int r = 0; r < CPL_NROLE; r++) {
    tdm_object section = tdm_get_object(root, cpl_role_names[r], true);
    read_solver(s, r, &before, cpl_role_names[r]);
    tdm_has(&section, "solver");
    if (!tdm_section_solver(section.json))
      continue;
    if (tdm_has(&before, cpl_role_names[r]))
      tdm_object_fail(&before, cpl_role_names[r], "names the solver that %s.solver names too; remove this one",
                      cpl_role_names[r]);
    read_solver(s, r, &section, "solver");
  }
  tdm_object_close(&before);
  s->ranks = tdm_section_ranks(json_object_get(root->json, "dem"));
  if (s->ranks > TDM_RANKS_MAX && !s->command[CPL_DEM])
    tdm_fail(root->err, TDM_ERR_SCENE, "dem.ranks", "is %d but must be at most %d", s->ranks, TDM_RANKS_MAX);
  if (s->ranks > 1 && s->transport == CPL_INPROC && !s->command[CPL_DEM])
    tdm_fail(root->err, TDM_ERR_SCENE, "dem.ranks",
             "is %d, but with coupling.transport \"inproc\" solvers are threads of one process; take \"ipc\", or "
             "dem.threads",
             s->ranks);
}

bool cpl_is_foreign(const json_t *root, cpl_role role) {
  char before[32];
  snprintf(before, sizeof before, "coupling.solvers.%s", cpl_role_names[role]);
  return tdm_section_solver(json_object_get(root, cpl_role_names[role])) || tdm_scene_value(root, before);
}

/* coupling.n: a number, or "auto", the default, with what coupling.auto says. */
static void read_n(cpl_settings *s, tdm_object *coupling) {
  const char *word = json_string_value(json_object_get(coupling->json, "n"));
  s->adapt.on = !tdm_has(coupling, "n") || (word && strcmp(word, "auto") == 0);
  tdm_object o = tdm_get_object(coupling, "auto", false);
  s->adapt.tolerance = tdm_get_number(&o, "tolerance", 1e-3, TDM_POSITIVE);
  s->adapt.absolute = tdm_get_number(&o, "absolute", 1e-7, TDM_NOT_NEGATIVE);
  s->adapt.n_min = tdm_get_integer(&o, "n_min", 1, 1);
  s->adapt.n_max = tdm_get_integer(&o, "n_max", 1000, 1);
  if (s->adapt.n_max < s->adapt.n_min)
    tdm_object_fail(&o, "n_max", "is less than n_min, %ld", s->adapt.n_min);
  tdm_object_close(&o);
  if (!s->adapt.on && o.json)
    tdm_object_fail(coupling, "auto", "goes with \"n\": \"auto\"; set that, or leave it out");
  if (word && !s->adapt.on)
    tdm_object_fail(coupling, "n", "\"%s\" is neither a whole number of DEM steps nor \"auto\"", word);
  s->n = s->adapt.on ? s->adapt.n_max : tdm_get_integer(coupling, "n", TDM_REQUIRED_INT, 1);
}

/* Every scheme's own object, coupling.<name>. */
static void read_schemes(cpl_settings *s, tdm_object *coupling) {
  int n = 0;
  while (s->schemes[n])
    n++;
  s->scheme_settings = calloc((size_t)n + 1, sizeof *s->scheme_settings);
  if (!s->scheme_settings)
    tdm_fail(coupling->err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int k = 0; k < n && !coupling->err->status; k++) {
    const cpl_scheme *scheme = s->schemes[k];
    if (!scheme->read)
      continue;
    s->scheme_settings[k] = calloc(1, scheme->settings_size + 1);
    if (!s->scheme_settings[k]) {
      tdm_fail(coupling->err, TDM_ERR_MEMORY, NULL, "out of memory");
      return;
    }
    tdm_object own = tdm_get_object(coupling, scheme->name, false);
    scheme->read(s->scheme_settings[k], &own);
    tdm_object_close(&own);
  }
}

const void *cpl_scheme_settings(const cpl_settings *s, const cpl_scheme *scheme) {
  for (int k = 0; s->schemes && s->schemes[k]; k++)
    if (s->scheme_settings && s->schemes[k] == scheme)
      return s->scheme_settings[k];
  return NULL;
}

const char *cpl_scheme_names(const cpl_settings *s, bool (*takes)(const cpl_scheme *), char *out, size_t size) {
  const char *name[SCHEMES_MAX];
  int n = 0, used = 0;
  for (int k = 0; s->schemes && s->schemes[k] && n < SCHEMES_MAX; k++)
    if (takes(s->schemes[k]))
      name[n++] = s->schemes[k]->name;
  out[0] = 0;
  for (int k = 0; k < n && used < (int)size; k++)
    used += snprintf(out + used, size - (size_t)used, "%s%s", k == 0 ? "" : k == n - 1 ? " or " : ", ", name[k]);
  return out;
}

static bool sees_mismatch(const cpl_scheme *scheme) {
  return scheme->mismatch_order > 0;
}

/* Only schemes that see the error of a window can choose its length by it. */
static void check_adaptive(const cpl_settings *s, tdm_object *coupling) {
  const cpl_scheme *const schemes[] = {s->scheme, s->fallback};
  char others[256];
  for (int i = 0; s->adapt.on && i < 2; i++)
    if (schemes[i] && schemes[i]->mismatch_order == 0)
      tdm_object_fail(coupling, "n",
                      "is \"auto\"%s, for which the scheme %s has no estimate of its error; give a number, or take %s",
                      tdm_has(coupling, "n") ? "" : " where it is not given", schemes[i]->name,
                      cpl_scheme_names(s, sees_mismatch, others, sizeof others));
}

static void read_guard(cpl_settings *s, tdm_object *coupling) {
  static const char *const actions[] = {"stop", "warn", "off"};
  tdm_object o = tdm_get_object(coupling, "guard", false);
  s->guard.energy = tdm_get_number(&o, "energy", 0.1, TDM_POSITIVE);
  s->guard.action = (cpl_guard_action)tdm_get_choice(&o, "action", actions, 3, CPL_GUARD_STOP);
  s->guard.residual = tdm_get_number(&o, "residual", 0.02, TDM_POSITIVE);
  tdm_object_close(&o);
}

static void read_coupling(cpl_settings *s, tdm_object *root) {
  static const char *const transports[] = {"ipc", "tcp", "inproc"};
  static const char *const interpolations[] = {"linear", "hermite"};
  const char *names[SCHEMES_MAX];
  int nscheme = 0;
  for (; s->schemes[nscheme] && nscheme < SCHEMES_MAX; nscheme++)
    names[nscheme] = s->schemes[nscheme]->name;
  tdm_object o = tdm_get_object(root, "coupling", true);
  read_n(s, &o);
  read_schemes(s, &o);
  int scheme = tdm_get_choice(&o, "scheme", names, nscheme, 0);
  s->scheme = s->schemes[scheme < 0 ? 0 : scheme];
  if (tdm_has(&o, "fallback")) {
    int fallback = tdm_get_choice(&o, "fallback", names, nscheme, 0);
    s->fallback = fallback < 0 ? NULL : s->schemes[fallback];
  }
  check_adaptive(s, &o);
  s->transport = (cpl_transport_kind)tdm_get_choice(&o, "transport", transports, 3, CPL_IPC);
  s->interpolates = tdm_has(&o, "interpolation");
  s->interpolation = (tdm_interpolation)tdm_get_choice(&o, "interpolation", interpolations, 2, TDM_LINEAR);
  s->timeout = tdm_get_number(&o, "timeout", 30, TDM_POSITIVE);
  if (s->timeout < 1)
    tdm_object_fail(&o, "timeout", "is %g s, but solvers give a sign of life every 0.5 s only; take at least 1",
                    s->timeout);
  s->join_timeout = tdm_get_number(&o, "join_timeout", 300, TDM_POSITIVE);
  read_guard(s, &o);
  read_address(s, &o);
  tdm_has(&o, "solvers"); /* with the sections */
  read_bodies(s, &o);
  tdm_object_close(&o);
}

/* Windows that choose their length leave no frame out: each shows the end of a window. */
static void limit_to_frames(cpl_settings *s) {
  const double most = floor(s->outputs.particles_interval / s->dt + 1e-6); /* steps; 0: no frames */
  if (!s->adapt.on || !(most >= 1 && most < (double)s->adapt.n_max))
    return;
  s->adapt.n_max = fmax(most, (double)s->adapt.n_min);
  s->n = s->adapt.n_max;
}

static void read_output(cpl_settings *s, tdm_object *root, const tdm_scene *scene) {
  tdm_object o = tdm_get_object(root, "output", false);
  s->output_interval = tdm_read_interval(&o, "interval", 1e-3, s->dt);
  tdm_outputs_settings_read(&s->outputs, &o, scene->root, s->dt, s->time_end);
  limit_to_frames(s);
  tdm_object_close(&o);
}

tdm_status cpl_settings_read(cpl_settings *s, const tdm_scene *scene, const cpl_scheme *const *schemes,
                             tdm_error *err) {
  *s = (cpl_settings){.schemes = schemes};
  tdm_object root = tdm_object_open(scene->root, "", err);
  tdm_has(&root, "$schema");    /* for editors */
  tdm_has(&root, "parameters"); /* which expressions have used */
  const json_t *sections = scene->root;
  if (json_object_get(sections, "dem") && !json_object_get(sections, "mbd") && !json_object_get(sections, "coupling"))
    tdm_object_fail(&root, "coupling",
                    "missing, and mbd too: particles alone are for tandem-dem run and tandem-dem check");
  if (json_object_get(sections, "mbd") && !json_object_get(sections, "dem") && !json_object_get(sections, "coupling"))
    tdm_object_fail(&root, "coupling",
                    "missing, and dem too: bodies alone are for tandem-mbd run and tandem-mbd check");
  tdm_get_string(&root, "title", "");
  tdm_get_string(&root, "scenario", "");
  tdm_check_gravity(&root);
  tdm_time time = tdm_read_time(&root);
  s->time_end = time.end;
  s->dt = time.dt;
  read_coupling(s, &root);
  read_output(s, &root, scene);
  read_solvers(s, &root);
  tdm_object_close(&root);
  return err->status;
}

void cpl_settings_free(cpl_settings *s) {
  for (int k = 0; s->scheme_settings && s->schemes[k]; k++)
    free(s->scheme_settings[k]);
  free(s->scheme_settings);
  free(s->body);
  tdm_outputs_settings_free(&s->outputs);
  s->scheme_settings = NULL;
  s->body = NULL;
  s->nbody = 0;
}
