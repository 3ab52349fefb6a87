/* READY: what a solver says when it has loaded its scene. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/session/session.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Directions in which nothing holds the body, where the solver tells them. */
static void read_free(tdm_assigned_body *b, const json_t *json, tdm_object *o) {
  const size_t n = json_array_size(json_object_get(json, "free"));
  b->nfree = 0;
  if (!tdm_has(o, "free"))
    return;
  if (n % 3 != 0 || n > 9 || !isfinite(b->mass)) {
    tdm_object_fail(o, "free", "%zu numbers; up to three directions of three, for a body of finite mass", n);
    return;
  }
  b->nfree = (int)n / 3;
  tdm_get_numbers(o, "free", &b->free[0].x, (int)n, true);
}

static void read_bodies(cpl_session *s, tdm_object *ready, tdm_error *err) {
  json_t *bodies = tdm_get_array(ready, "bodies", true);
  json_decref(s->bodies);
  s->bodies = json_incref(bodies); /* names of files live there */
  if ((int)json_array_size(bodies) != s->settings->nbody)
    tdm_object_fail(ready, "bodies", "%zu bodies, expected %d", json_array_size(bodies), s->settings->nbody);
  for (int i = 0; i < s->settings->nbody && err->status == TDM_OK; i++) {
    char path[TDM_PATH_MAX];
    json_t *json = json_array_get(bodies, (size_t)i);
    tdm_object o = tdm_object_open(json, tdm_path(path, ready, "bodies", i), err);
    tdm_assigned_body *b = &s->body[i];
    b->name = s->settings->body[i].name[CPL_DEM];
    b->mass =
        json_is_null(json_object_get(json, "mass")) ? INFINITY : tdm_get_number(&o, "mass", TDM_REQUIRED, TDM_POSITIVE);
    tdm_get_numbers(&o, "inertia", &b->inertia.m[0][0], 9, true);
    tdm_get_numbers(&o, "state", (double *)(void *)&b->state, TDM_STATE_DOUBLES, true);
    tdm_part_read(b, &o);
    read_free(b, json, &o);
  }
}

static void read_loads(cpl_session *s, tdm_object *ready, tdm_error *err) {
  json_t *loads = tdm_get_array(ready, "loads", true);
  for (int i = 0; i < s->settings->nbody && err->status == TDM_OK; i++) {
    char key[32];
    snprintf(key, sizeof key, "loads[%d]", i);
    json_t *wrapped = json_pack("{s:O?}", key, json_array_get(loads, (size_t)i));
    tdm_object o = tdm_object_open(wrapped, ready->path, err);
    tdm_get_numbers(&o, key, (double *)(void *)&s->load[i], TDM_WRENCH_DOUBLES, true);
    json_decref(wrapped);
  }
}

/* Names and units become the head of a CSV file, titles of plots and text of pages. */
static void check_channel(tdm_object *ready, int i, const char *name, const char *unit) {
  static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-";
  const size_t name_max = sizeof((tdm_channel *)0)->name - 1, unit_max = sizeof((tdm_channel *)0)->unit - 1;
  if (!name || !*name || name[strspn(name, letters)] != 0 || strlen(name) > name_max)
    tdm_object_fail(ready, "channels",
                    "entry %d has no usable name: \"%.80s\"; take at most %zu letters, digits, dots, _ and -", i,
                    name ? name : "", name_max);
  bool good = !unit || strlen(unit) <= unit_max;
  for (const char *c = unit; good && c && *c; c++)
    good = strchr(letters, *c) || strchr(" /^*()%", *c) || (unsigned char)*c >= 0x80;
  if (!good)
    tdm_object_fail(ready, "channels",
                    "entry %d has no usable unit: \"%.80s\"; take at most %zu bytes of letters, digits and . _ - / ^ * "
                    "( ) %%, or none",
                    i, unit, unit_max);
}

static void read_channels(cpl_partner *p, tdm_object *ready, tdm_error *err) {
  json_t *channels = tdm_get_array(ready, "channels", false);
  p->nchannel = (int)json_array_size(channels);
  p->channel = calloc((size_t)p->nchannel + 1, sizeof *p->channel);
  p->initial = calloc((size_t)p->nchannel + 1, sizeof *p->initial);
  if (!p->channel || !p->initial) {
    p->nchannel = 0;
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    return;
  }
  json_t *names = json_object();
  for (int i = 0; i < p->nchannel; i++) {
    json_t *json = json_array_get(channels, (size_t)i), *initial = json_object_get(json, "initial");
    const char *name = json_string_value(json_object_get(json, "name"));
    const char *unit = json_string_value(json_object_get(json, "unit"));
    check_channel(ready, i, name, unit);
    if (name && json_object_get(names, name))
      tdm_object_fail(ready, "channels", "entry %d: a second one is called \"%s\"", i, name);
    json_object_set_new(names, name ? name : "", json_true());
    snprintf(p->channel[i].name, sizeof p->channel[i].name, "%s", name ? name : "");
    snprintf(p->channel[i].unit, sizeof p->channel[i].unit, "%s", unit ? unit : "");
    p->channel[i].gaps = json_is_true(json_object_get(json, "gaps"));
    p->initial[i] = json_is_number(initial) ? json_number_value(initial) : NAN;
  }
  json_decref(names);
}

/* What the scheme asked of mbd for the start. */
static void read_mobility(cpl_session *s, tdm_object *ready, tdm_error *err) {
  const int nbody = s->settings->nbody;
  if (cpl_session_asks(s, CPL_MBD, "acceleration")) {
    s->acceleration = calloc(6 * (size_t)nbody + 1, sizeof *s->acceleration);
    if (!s->acceleration)
      tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    else
      tdm_get_numbers(ready, "acceleration", s->acceleration, 6 * nbody, true);
  }
  if (!cpl_session_asks(s, CPL_MBD, "mobility") || err->status)
    return;
  tdm_object o = tdm_get_object(ready, "mobility", true);
  s->mobility = (tdm_mobility){.nbody = nbody, .nfree = (int)tdm_get_integer(&o, "nfree", TDM_REQUIRED_INT, 0)};
  if (!err->status && s->mobility.nfree > TDM_FREE_MAX)
    tdm_object_fail(&o, "nfree", "is more than %d", TDM_FREE_MAX);
  if (err->status)
    return;
  size_t n = tdm_mobility_doubles(&s->mobility);
  double *block = calloc(n + 1, sizeof *block);
  if (!block) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    return;
  }
  tdm_mobility_point(&s->mobility, block);
  tdm_get_numbers(&o, "numbers", block, (int)n, true);
}

/* The path until the first window's end, and which bodies no load moves; both may be missing. */
static void read_ahead(cpl_session *s, tdm_object *ready, tdm_error *err) {
  const size_t nbody = (size_t)s->settings->nbody;
  json_t *flags = tdm_get_array(ready, "prescribed", false);
  if (flags && json_array_size(flags) != nbody)
    tdm_object_fail(ready, "prescribed", "has %zu entries, expected %zu", json_array_size(flags), nbody);
  s->prescribed = flags && !err->status ? calloc(nbody + 1, sizeof *s->prescribed) : NULL;
  if (flags && !err->status && !s->prescribed)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (size_t i = 0; i < nbody && s->prescribed; i++)
    s->prescribed[i] = json_is_true(json_array_get(flags, i));
  if (!tdm_has(ready, "path") || err->status)
    return;
  tdm_object o = tdm_get_object(ready, "path", true);
  const size_t nnode = json_array_size(json_object_get(o.json, "times"));
  if (nnode > TDM_NODES_MAX)
    tdm_object_fail(&o, "times", "are %zu, more than %d", nnode, TDM_NODES_MAX);
  if (err->status)
    return;
  s->path = (tdm_nodes){(int)nnode, (int)nbody, calloc(nnode + 1, sizeof *s->path.time),
                        calloc(nnode * nbody + 1, sizeof *s->path.state)};
  if (!s->path.time || !s->path.state) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    return;
  }
  tdm_get_numbers(&o, "times", s->path.time, (int)nnode, true);
  tdm_get_numbers(&o, "states", (double *)(void *)s->path.state, (int)(nnode * nbody) * TDM_STATE_DOUBLES, true);
  for (size_t k = 0; k < nnode && !err->status; k++)
    if (!(s->path.time[k] > (k > 0 ? s->path.time[k - 1] : 0)))
      tdm_object_fail(&o, "times", "do not ascend from the start on");
}

static void read_energy(cpl_session *s, int role, tdm_object *ready) {
  double numbers[3] = {NAN, NAN, 0}; /* of a tdm_energy, in order */
  if (cpl_session_asks(s, (cpl_role)role, "energy") && tdm_has(ready, "energy"))
    tdm_get_numbers(ready, "energy", numbers, 3, true);
  s->partner[role].rest = tdm_get_number(ready, "rest", 0, TDM_NOT_NEGATIVE);
  s->partner[role].energy = (tdm_energy){numbers[0], numbers[1], numbers[2], 0};
}

tdm_status cpl_session_read_ready(cpl_session *s, cpl_role role, const tdm_header *header, tdm_error *err) {
  cpl_partner *p = &s->partner[role];
  json_t *json = NULL;
  if (tdm_control_read(header, &json, err) == TDM_OK) {
    tdm_object ready = tdm_object_open(json, "READY", err);
    if (role == CPL_MBD) {
      read_bodies(s, &ready, err);
      read_mobility(s, &ready, err);
      if (!err->status && cpl_session_asks(s, CPL_MBD, "ahead"))
        read_ahead(s, &ready, err);
    } else
      read_loads(s, &ready, err);
    read_channels(p, &ready, err);
    read_energy(s, role, &ready);
    p->has_gravity = tdm_has(&ready, "gravity");
    p->gravity = tdm_get_vec3(&ready, "gravity", &(tdm_vec3){0, 0, 0});
    json_t *warnings = tdm_get_array(&ready, "warnings", false);
    if (warnings)
      json_array_extend(s->warnings, warnings);
    p->report = json_incref(json_object_get(json, "report"));
    p->ready = true;
    if (!err->status)
      cpl_session_check_ready(s, role, err);
  }
  json_decref(json);
  if (err->status == TDM_OK)
    return TDM_OK;
  if (err->path[0]) { /* a path into the message, not into the scene */
    tdm_error place = *err;
    *err = (tdm_error){0};
    tdm_fail(err, TDM_ERR_PROTOCOL, NULL, "malformed READY: %s: %.700s", place.path, place.message);
  }
  return err->status;
}

void cpl_session_compare(cpl_session *s) {
  const cpl_partner *mbd = &s->partner[CPL_MBD], *dem = &s->partner[CPL_DEM];
  const tdm_vec3 a = mbd->gravity, b = dem->gravity;
  const double rounding = 1e-9 * fmax(tdm_norm(a), tdm_norm(b));
  char message[TDM_MESSAGE_MAX];
  if (!mbd->has_gravity || !dem->has_gravity || tdm_norm(tdm_sub(a, b)) <= rounding)
    return;
  snprintf(message, sizeof message,
           "gravity is [%g, %g, %g] m/s2 for the particles, but [%g, %g, %g] for the bodies of mbd (one that is not "
           "given is [0, 0, -9.81]); give \"gravity\" once, at the root of the scene, for both",
           b.x, b.y, b.z, a.x, a.y, a.z);
  json_array_append_new(s->warnings, json_pack("{s:s, s:s}", "path", "dem.gravity", "message", message));
}
