/* Families of cases: see family.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scenarios/stability/family.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void scn_family_free(scn_family *f) {
  for (int i = 0; i < f->ncase; i++)
    json_decref(f->at[i].set);
  free(f->at);
  json_decref(f->json);
  *f = (scn_family){0};
}

/* "ratio=10 H=0.001": what distinguishes the case; how long it runs does not. */
static void name_case(scn_stability_case *c) {
  const char *key;
  json_t *value;
  json_object_foreach(c->set, key, value) {
    const size_t n = strlen(c->name);
    if (strcmp(key, "end") != 0)
      snprintf(c->name + n, sizeof c->name - n, "%s%.32s=%g", n ? " " : "", key, json_number_value(value));
  }
}

/* Do two cases differ in nothing but the window? */
static bool same_physics(const json_t *a, const json_t *b) {
  json_t *x = json_copy((json_t *)a), *y = json_copy((json_t *)b);
  json_object_del(x, "H");
  json_object_del(y, "H");
  const bool same = json_equal(x, y);
  json_decref(x);
  json_decref(y);
  return same;
}

static void number_case(scn_family *f, scn_stability_case *c) {
  for (const scn_stability_case *other = f->at; other < c; other++)
    if (same_physics(other->set, c->set)) {
      c->physics = other->physics;
      return;
    }
  c->physics = f->nphysics++;
}

/* Take a case; one with a list stands for a case of each of its values. Takes the reference. */
static tdm_status add_case(scn_family *f, json_t *set, tdm_error *err) {
  const char *key;
  json_t *value;
  json_object_foreach(set, key, value) if (json_is_array(value)) {
    size_t i;
    json_t *one;
    json_array_foreach(value, i, one) {
      json_t *single = json_copy(set);
      json_object_set(single, key, one);
      add_case(f, single, err);
    }
    json_decref(set);
    return err->status;
  }
  scn_stability_case *grown = realloc(f->at, (size_t)(f->ncase + 1) * sizeof *grown);
  if (!grown) {
    json_decref(set);
    return tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  }
  f->at = grown;
  f->at[f->ncase] = (scn_stability_case){.set = set};
  name_case(&f->at[f->ncase]);
  number_case(f, &f->at[f->ncase]);
  f->ncase++;
  return TDM_OK;
}

static tdm_status add_cases(scn_family *f, const char *list, tdm_error *err) {
  size_t i;
  json_t *set;
  json_array_foreach(json_object_get(f->json, list), i, set) add_case(f, json_copy(set), err);
  return err->status;
}

tdm_status scn_family_read(scn_family *f, const cpl_verify *v, const char *name, bool full, tdm_error *err) {
  char file[4096], own[128];
  const char *scene;
  json_error_t json;
  snprintf(own, sizeof own, "stability/families/%.64s.json", name);
  if (cpl_verify_find_file(v, own, file, sizeof file, err) != TDM_OK)
    return err->status;
  f->json = json_load_file(file, 0, &json);
  if (!f->json)
    return tdm_fail(err, TDM_ERR_JSON, NULL, "%s:%d:%d: %s", file, json.line, json.column, json.text);
  if (json_unpack_ex(f->json, &json, 0, "{s:s, s:s, s:s, s:s, s:F}", "title", &f->title, "scene", &scene, "file",
                     &f->file, "column", &f->column, "floor", &f->floor) != 0)
    return tdm_fail(err, TDM_ERR_JSON, NULL, "%s: %s", file, json.text);
  snprintf(own, sizeof own, "stability/%.64s", scene);
  if (cpl_verify_find_file(v, own, f->scene, sizeof f->scene, err) != TDM_OK || add_cases(f, "cases", err) != TDM_OK)
    return err->status;
  return full ? add_cases(f, "full", err) : TDM_OK;
}
