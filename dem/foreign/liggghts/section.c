/* Reading the section `dem`: see section.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/foreign/liggghts/section.h"

#include "protocol/scene/input.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* LIGGGHTS' words of commands: letters, digits and _ in names of fixes and variables. */
static bool is_id(const char *name) {
  for (const char *c = name; *c; c++)
    if (!isalnum((unsigned char)*c) && *c != '_')
      return false;
  return *name && strlen(name) < 64;
}

/* A file that can be read, and whose name LIGGGHTS can take as one word; errors at the key. */
static void check_file(tdm_object *o, const char *key, const char *name) {
  const char *why = NULL;
  if (o->err->status != TDM_OK)
    return;
  FILE *f = tdm_open_input(name, false, &why);
  if (!f)
    tdm_object_fail(o, key, "%s: %s", name, why);
  else if (strpbrk(name, "\"' \t&#$") || strlen(name) > 200) /* it copies the name of a mesh to 256 bytes */
    tdm_object_fail(o, key, "%s: LIGGGHTS takes names of up to 200 characters without blanks, quotes, $, & and #",
                    name);
  if (f)
    fclose(f);
}

static const char *get_file(tdm_object *o) {
  const char *name = tdm_get_string(o, "file", NULL);
  check_file(o, "file", name);
  return name;
}

/* Variables that tandem-liggghts gives the script by itself. */
static bool is_taken(const lig_section *s, const char *name) {
  bool taken = strcmp(name, "dt") == 0 || strcmp(name, "gravity") == 0 || strncmp(name, "tandem_", 7) == 0;
  for (int i = 0; i < s->nbody && !taken; i++) {
    const size_t n = strlen(s->body[i].name);
    taken = strncmp(name, s->body[i].name, n) == 0 && strcmp(name + n, "_mesh") == 0;
  }
  return taken;
}

static void read_script(lig_section *s, tdm_object *dem) {
  tdm_object o = tdm_get_object(dem, "script", true);
  const char *key;
  json_t *value;
  s->script = get_file(&o);
  tdm_object variables = tdm_get_object(&o, "variables", false);
  s->variables = variables.json;
  json_object_foreach(s->variables, key, value) {
    const char *text = json_string_value(value);
    if (!is_id(key))
      tdm_object_fail(&variables, key, "a variable of LIGGGHTS has a name of letters, digits and _");
    else if (is_taken(s, key))
      tdm_object_fail(&variables, key, "is a variable that tandem-liggghts gives the script itself; take another name");
    else if (!json_is_number(value) && !json_is_boolean(value) && !text)
      tdm_object_fail(&variables, key, "must be a number, a text, true or false");
    else if (text && (strpbrk(text, "\"'\n$") || !*text || strlen(text) > 1000))
      tdm_object_fail(&variables, key, "must have 1 to 1000 characters, and no quotes, line breaks or $");
  }
  tdm_object_close(&o);
}

static void read_mesh(lig_body *b, tdm_object *entry) {
  const tdm_vec3 nowhere = {0, 0, 0};
  const bool told = tdm_has(entry, "mesh");
  tdm_object o = tdm_get_object(entry, "mesh", false);
  if (!told && !b->mesh)
    tdm_object_fail(entry, "mesh", "is missing, and mbd names no file of this body either; give {\"file\": \"…\"}");
  if (!told)
    check_file(entry, "mesh", b->mesh);
  if (told) {
    b->mesh = get_file(&o);
    b->scale = tdm_get_number(&o, "scale", 1, TDM_POSITIVE);
    b->origin = tdm_get_vec3(&o, "origin", &nowhere);
  }
  tdm_object_close(&o);
}

/* The entry of a coupled body; one without has its whole mesh in the script. */
static void read_bodies(lig_section *s, tdm_object *dem, const tdm_assignment *a) {
  json_t *list = tdm_get_array(dem, "bodies", false);
  char path[TDM_PATH_MAX];
  bool *seen = calloc((size_t)a->nbody + 1, sizeof *seen);
  for (size_t k = 0; seen && k < json_array_size(list) && dem->err->status == TDM_OK; k++) {
    tdm_object o = tdm_object_open(json_array_get(list, k), tdm_path(path, dem, "bodies", (int)k), dem->err);
    const char *name = tdm_get_string(&o, "name", NULL);
    int i = 0;
    while (i < a->nbody && strcmp(a->body[i].name, name) != 0)
      i++;
    if (i == a->nbody)
      tdm_object_fail(&o, "name", "\"%s\" is not coupled (coupling.bodies); meshes that stand still are the script's",
                      name);
    else if (seen[i])
      tdm_object_fail(&o, "name", "\"%s\" stands here twice", name);
    if (dem->err->status != TDM_OK)
      break;
    seen[i] = true;
    lig_body *b = &s->body[i];
    b->mesh = a->body[i].mesh; /* where mbd has it */
    b->scale = a->body[i].scale;
    b->origin = a->body[i].origin;
    read_mesh(b, &o);
    b->type = tdm_get_integer(&o, "type", 1, 1);
    tdm_object_close(&o);
  }
  if (!seen)
    tdm_fail(dem->err, TDM_ERR_MEMORY, NULL, "out of memory");
  free(seen);
}

static void read_channels(lig_section *s, tdm_object *dem) {
  json_t *list = tdm_get_array(dem, "channels", false);
  char path[TDM_PATH_MAX];
  s->nchannel = (int)json_array_size(list);
  s->channel = calloc((size_t)s->nchannel + 1, sizeof *s->channel);
  if (!s->channel) {
    tdm_fail(dem->err, TDM_ERR_MEMORY, NULL, "out of memory");
    s->nchannel = 0;
  }
  for (int k = 0; k < s->nchannel; k++) {
    tdm_object o = tdm_object_open(json_array_get(list, (size_t)k), tdm_path(path, dem, "channels", k), dem->err);
    lig_channel *c = &s->channel[k];
    snprintf(c->channel.name, sizeof c->channel.name, "%s", tdm_get_string(&o, "name", NULL));
    snprintf(c->channel.unit, sizeof c->channel.unit, "%s", tdm_get_string(&o, "unit", ""));
    c->variable = tdm_get_string(&o, "variable", NULL);
    if (!is_id(c->variable))
      tdm_object_fail(&o, "variable", "\"%s\" is no name of a variable of LIGGGHTS", c->variable);
    tdm_object_close(&o);
  }
}

static tdm_status name_bodies(lig_section *s, const tdm_assignment *a, tdm_error *err) {
  s->nbody = a->nbody;
  s->body = calloc((size_t)a->nbody + 1, sizeof *s->body);
  if (!s->body)
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i < a->nbody; i++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "coupling.bodies[%d].dem", i);
    s->body[i].name = a->body[i].name;
    if (!is_id(a->body[i].name))
      return tdm_fail(err, TDM_ERR_SCENE, path,
                      "\"%s\" is the name of a fix of LIGGGHTS, which has at most 63 letters, digits and _",
                      a->body[i].name);
  }
  return TDM_OK;
}

tdm_status lig_section_read(lig_section *s, const tdm_assignment *a, tdm_error *err) {
  static const char *const lost[] = {"error", "ignore"};
  *s = (lig_section){0};
  if (name_bodies(s, a, err) != TDM_OK)
    return err->status;
  tdm_object o = tdm_object_open(a->scene, "dem", err);
  read_script(s, &o);
  read_bodies(s, &o, a);
  read_channels(s, &o);
  s->may_lose = tdm_get_choice(&o, "lost", lost, 2, 0) == 1;
  s->has_gravity = tdm_has(&o, "gravity");
  if (s->has_gravity)
    s->gravity = tdm_get_vec3(&o, "gravity", NULL);
  tdm_object_close(&o);
  return err->status;
}

void lig_section_free(lig_section *s) {
  free(s->body);
  free(s->channel);
  *s = (lig_section){0};
}
