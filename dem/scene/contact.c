/* Reading materials, contact laws and pairs: see contact.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/scene/contact.h"

#include "dem/contact/table.h"
#include "dem/scene/keys.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- laws ---- */

/* a law of a family that the scene names */
static const dem_law_head *choose_law(tdm_object *o, dem_family family, const char *fallback) {
  const char *names[32];
  int n = 0, first = dem_law_place(family, fallback);
  for (const dem_law_head *law; (law = dem_law_at(family, n)); n++)
    names[n] = law->name;
  int chosen = tdm_get_choice(o, dem_family_names[family], names, n, first);
  return dem_law_at(family, chosen < 0 ? first : chosen);
}

/* the instruction set: the best of this machine unless the scene names one */
static void read_simd(dem_model *m, tdm_object *section) {
  int set = tdm_has(section, "simd") ? tdm_get_choice(section, "simd", dem_simd_names, DEM_SIMD_SETS, 0) : -1;
  m->simd = set < 0 ? dem_simd_best() : dem_simd_names[set];
  if (dem_simd_here(m->simd))
    return;
  tdm_object_fail(section, "simd", "this machine, or this build, has no \"%s\"; remove the key, or use \"%s\"", m->simd,
                  dem_simd_best());
  m->simd = "plain";
}

/* The normal law of walls: that of the first pair which names another than the scene's. */
static void find_wall_law(dem_model *m, tdm_object *section) {
  json_t *pairs = json_object_get(section->json, "pairs");
  m->wall_normal = m->normal;
  for (size_t i = 0; i < json_array_size(pairs) && m->wall_normal == m->normal; i++) {
    const char *name = json_string_value(json_object_get(json_array_get(pairs, i), "normal"));
    int place = name ? dem_law_place(DEM_FAMILY_NORMAL, name) : -1;
    if (place >= 0)
      m->wall_normal = (const dem_normal_law *)dem_law_at(DEM_FAMILY_NORMAL, place);
  }
}

/* likewise of laws of many contacts */
static void read_multi_settings(dem_model *m, tdm_object *o) {
  const dem_law_head *row;
  for (int k = 0; (row = dem_law_at(DEM_FAMILY_MULTI, k)); k++) {
    const dem_multi_law *other = (const dem_multi_law *)row;
    for (int q = 0; other != m->multi && other->setting_keys[q]; q++)
      if (tdm_has(o, other->setting_keys[q]))
        tdm_object_fail(o, other->setting_keys[q], "is for \"multi_contact\": \"%s\" only, not for \"%s\"; remove it",
                        row->name, m->multi->head.name);
  }
  if (m->multi->read_settings)
    m->multi->read_settings(m, o);
}

/* settings of the normal laws; those of others are refused by name */
static void read_settings(dem_model *m, tdm_object *o) {
  const dem_law_head *row;
  for (int k = 0; (row = dem_law_at(DEM_FAMILY_NORMAL, k)); k++) {
    const dem_normal_law *other = (const dem_normal_law *)row;
    for (int q = 0; other != m->normal && other != m->wall_normal && other->setting_keys[q]; q++)
      if (tdm_has(o, other->setting_keys[q]))
        tdm_object_fail(o, other->setting_keys[q], "is for \"normal\": \"%s\" only, not for \"%s\"; remove it",
                        row->name, m->normal->head.name);
  }
  if (m->normal->read_settings)
    m->normal->read_settings(m, o);
  if (m->wall_normal != m->normal && m->wall_normal->read_settings)
    m->wall_normal->read_settings(m, o);
}

/* another law at walls: settings and sums are of one law */
static void check_wall_law(const dem_model *m, tdm_object *o) {
  const dem_normal_law *of[] = {m->normal, m->wall_normal};
  int settings = 0, sums = 0;
  for (int k = 0; k < 2 && m->normal != m->wall_normal; k++) {
    settings += of[k]->setting_keys[0] != NULL;
    sums += of[k]->loops[DEM_PLAIN]->nsum > 0;
  }
  if (settings > 1 || sums > 0)
    tdm_object_fail(o, "normal",
                    "\"%s\" does not go with the \"%s\" that dem.pairs name for walls; let walls have the law of the "
                    "particles",
                    m->normal->head.name, m->wall_normal->head.name);
}

/* what stands in the place of Hertz's law goes with what goes with that alone */
static void check_multi(const dem_model *m, tdm_object *o) {
  const char *key = dem_family_names[DEM_FAMILY_MULTI], *name = m->multi->head.name;
  if (m->multi->head.none)
    return;
  if (!m->normal->hertzian)
    tdm_object_fail(o, key, "\"%s\" corrects Hertz's force, and normal \"%s\" has another; use \"hertz\"", name,
                    m->normal->head.name);
  else if (m->wall_normal != m->normal)
    tdm_object_fail(o, key,
                    "\"%s\" corrects Hertz's force, and dem.pairs name \"%s\" for walls; let walls have the law of the "
                    "particles",
                    name, m->wall_normal->head.name);
  else if (!m->cohesion->head.none)
    tdm_object_fail(o, key,
                    "\"%s\" does not go with cohesion \"%s\": what pulls would count as pressure; use \"none\" for one "
                    "of them",
                    name, m->cohesion->head.name);
}

/* tail and cohesion that go with loops, but not with the other laws */
static void check_laws(const dem_model *m, tdm_object *o) {
  check_multi(m, o);
  if (m->cohesion->check)
    m->cohesion->check(m, o);
  if (m->clip && m->normal->why_not_clip && m->wall_normal->why_not_clip)
    tdm_object_fail(o, "tail", "\"clip\" has no meaning with normal \"%s\", %s; use \"keep\"", m->normal->head.name,
                    m->normal->why_not_clip);
}

/* what EDEM takes for every wall ([L18] Section 3.1, after Arumugan 2014) [kg] */
static const double edem_wall_mass = 1e8;

static void read_wall_mass(dem_model *m, tdm_object *o) {
  if (tdm_has(o, "wall_mass") && json_is_string(json_object_get(o->json, "wall_mass"))) {
    static const char *const words[] = {"body", "edem"};
    m->wall_mass = tdm_get_choice(o, "wall_mass", words, 2, 0) == 1 ? edem_wall_mass : 0;
  } else {
    m->wall_mass = tdm_get_number(o, "wall_mass", 0, tdm_has(o, "wall_mass") ? TDM_POSITIVE : TDM_ANY);
  }
}

void dem_contact_read(dem_model *m, tdm_object *section) {
  static const char *const tails[] = {"keep", "clip"};
  read_simd(m, section);
  tdm_object o = tdm_get_object(section, "contact", false);
  m->normal = (const dem_normal_law *)choose_law(&o, DEM_FAMILY_NORMAL, "hertz");
  find_wall_law(m, section);
  m->tangential = (const dem_tangential_law *)choose_law(&o, DEM_FAMILY_TANGENTIAL, m->normal->tangential);
  m->rolling = (const dem_rolling_law *)choose_law(&o, DEM_FAMILY_ROLLING, "none");
  m->twisting = (const dem_twisting_law *)choose_law(&o, DEM_FAMILY_TWISTING, "none");
  m->cohesion = (const dem_cohesion_law *)choose_law(&o, DEM_FAMILY_COHESION, "none");
  m->multi = (const dem_multi_law *)choose_law(&o, DEM_FAMILY_MULTI, "none");
  m->clip = tdm_get_choice(&o, "tail", tails, 2, 0) == 1;
  if (!dem_loops_choose(m))
    tdm_object_fail(&o, "tangential",
                    "\"%s\" needs a contact circle, which normal \"%s\" does not have; use \"spring\"",
                    m->tangential->head.name, (m->normal->circle ? m->wall_normal : m->normal)->head.name);
  check_wall_law(m, &o);
  read_settings(m, &o);
  read_multi_settings(m, &o);
  check_laws(m, &o);
  read_wall_mass(m, &o);
  tdm_object_close(&o);
}

/* ---- materials ---- */

/* do all contacts follow from elastic constants? (hunt-crossley: those of pairs without a stiffness) */
static bool needs_young(const dem_model *m) {
  bool needs = m->wall_normal->head.needs_young;
  for (dem_family f = 0; f < DEM_FAMILIES; f++)
    needs = needs || dem_law_of(m, f)->needs_young;
  return needs;
}

static void read_material(dem_model *m, tdm_object *o) {
  const char *name = tdm_get_string(o, "name", NULL);
  int same = dem_find_material(m, name);
  if (same >= 0)
    tdm_object_fail(o, "name", "\"%s\" is the name of dem.materials[%d] already; give each material its own", name,
                    same);
  dem_material *material = &m->material[m->nmaterial++];
  material->name = dem_copy_text(name, o->err);
  material->density = tdm_get_number(o, "density", TDM_REQUIRED, TDM_POSITIVE);
  if (!needs_young(m) && !tdm_has(o, "young_modulus") && !tdm_has(o, "poisson_ratio"))
    return;
  material->young = tdm_get_number(o, "young_modulus", TDM_REQUIRED, TDM_POSITIVE);
  material->poisson = tdm_get_number(o, "poisson_ratio", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  if (material->poisson > 0.5)
    tdm_object_fail(o, "poisson_ratio", "is %g but must be at most 0.5, that of what keeps its volume",
                    material->poisson);
  material->shear = material->young / (2 * (1 + material->poisson));
}

void dem_materials_read(dem_model *m, json_t *array, tdm_error *err) {
  size_t n = json_array_size(array);
  m->material = dem_allocate(n, sizeof *m->material, err);
  for (size_t i = 0; i < n && !err->status; i++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.materials[%zu]", i);
    tdm_object o = tdm_object_open(json_array_get(array, i), path, err);
    read_material(m, &o);
    tdm_object_close(&o);
  }
}

/* ---- coefficients of a pair ---- */

/* "friction": one number, or {"static", "dynamic"} */
static void read_friction(tdm_object *o, const dem_tangential_law *law, double *dynamic, double *hold) {
  if (json_is_object(json_object_get(o->json, "friction"))) {
    tdm_object both = tdm_get_object(o, "friction", true);
    *dynamic = tdm_get_number(&both, "dynamic", TDM_REQUIRED, TDM_NOT_NEGATIVE);
    *hold = tdm_get_number(&both, "static", TDM_REQUIRED, TDM_NOT_NEGATIVE);
    if (*hold < *dynamic)
      tdm_object_fail(&both, "static", "is %g but must be at least the dynamic one, %g", *hold, *dynamic);
    if (*hold != *dynamic && !law->sticks)
      tdm_object_fail(&both, "static", "has no meaning with tangential \"%s\", which never sticks; use \"spring\"",
                      law->head.name);
    tdm_object_close(&both);
  } else {
    *dynamic = *hold = tdm_get_number(o, "friction", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  }
}

static void read_tangential(const dem_model *m, tdm_object *o, dem_pair *p) {
  const dem_tangential_law *law = m->tangential;
  if (law->friction)
    read_friction(o, law, &p->friction, &p->static_friction);
  if (law->read)
    law->read(m, o, p);
  if (law->damp)
    law->damp(m, p);
}

static void read_others(const dem_model *m, tdm_object *o, dem_pair *p) {
  if (m->rolling->read)
    m->rolling->read(m, o, p);
  if (m->twisting->read)
    m->twisting->read(m, o, p);
  if (m->cohesion->read)
    m->cohesion->read(m, o, p);
}

static void refuse_if_unused(const dem_model *m, tdm_object *o, const dem_pair *p, const char *key) {
  bool asked = false;
  for (int a = 0; a < o->nasked; a++)
    asked = asked || strcmp(o->asked[a], key) == 0;
  if (!asked && o->json && json_object_get(o->json, key))
    tdm_object_fail(o, key,
                    "is read by none of the scene's laws (normal \"%s\", tangential \"%s\", rolling \"%s\", twisting "
                    "\"%s\", cohesion \"%s\", multi_contact \"%s\"); remove it, or choose its law in dem.contact",
                    dem_normal_of(m, p)->head.name, m->tangential->head.name, m->rolling->head.name,
                    m->twisting->head.name, m->cohesion->head.name, m->multi->head.name);
}

/* keys of laws that the scene has not chosen are no typing errors: say what they are */
static void refuse_unused(const dem_model *m, tdm_object *o, const dem_pair *p) {
  const dem_law_head *row;
  refuse_if_unused(m, o, p, "friction");
  for (dem_family f = 0; f < DEM_FAMILIES; f++)
    for (int k = 0; (row = dem_law_at(f, k)); k++)
      for (int q = 0; row->keys[q].name; q++)
        refuse_if_unused(m, o, p, row->keys[q].name);
}

/* ---- pairs ---- */

/* the two materials of a pair; false after an error */
static bool read_pair_names(const dem_model *m, tdm_object *o, int which[2]) {
  json_t *names = tdm_get_array(o, "materials", true);
  if (!o->err->status && json_array_size(names) != 2)
    tdm_object_fail(o, "materials", "has %zu entries but a pair needs two material names", json_array_size(names));
  for (int k = 0; k < 2 && !o->err->status; k++) {
    const char *name = json_string_value(json_array_get(names, (size_t)k));
    which[k] = name ? dem_find_material(m, name) : -1;
    char path[TDM_PATH_MAX];
    if (which[k] < 0)
      tdm_fail(o->err, TDM_ERR_SCENE, tdm_path(path, o, "materials", k), "\"%s\" is no material of dem.materials",
               name ? name : "(not a string)");
  }
  return !o->err->status;
}

static void elastic_constants(const dem_material *a, const dem_material *b, dem_pair *p) {
  if (!(a->young > 0) || !(b->young > 0))
    return;
  p->effective_young = 1 / ((1 - a->poisson * a->poisson) / a->young + (1 - b->poisson * b->poisson) / b->young);
  p->effective_shear = 1 / ((2 - a->poisson) / a->shear + (2 - b->poisson) / b->shear);
}

/* the pair's own normal law; walls have one */
static const dem_normal_law *read_wall_law(const dem_model *m, tdm_object *o) {
  if (!tdm_has(o, dem_family_names[DEM_FAMILY_NORMAL]))
    return NULL;
  const dem_normal_law *law = (const dem_normal_law *)choose_law(o, DEM_FAMILY_NORMAL, m->normal->head.name);
  if (law != m->normal && law != m->wall_normal)
    tdm_object_fail(o, "normal", "\"%s\" is not the law that another pair names for walls, \"%s\"; give all walls one",
                    law->head.name, m->wall_normal->head.name);
  return law;
}

static void read_pair(dem_model *m, tdm_object *o) {
  size_t n = (size_t)m->nmaterial;
  int which[2] = {0, 0};
  if (!read_pair_names(m, o, which))
    return;
  const dem_material *a = &m->material[which[0]], *b = &m->material[which[1]];
  dem_pair pair = {.law = read_wall_law(m, o), .given = true, .floor = m->clip ? 0 : -INFINITY};
  if (m->pair[(size_t)which[0] * n + (size_t)which[1]].given)
    tdm_object_fail(o, NULL, "the pair \"%s\", \"%s\" is given twice; remove one", a->name, b->name);
  elastic_constants(a, b, &pair);
  dem_normal_of(m, &pair)->read(m, o, &pair);
  read_tangential(m, o, &pair);
  read_others(m, o, &pair);
  dem_pair back = pair;
  if (m->multi->read) {
    m->multi->read(m, o, a, b, &pair);
    m->multi->read(m, o, b, a, &back);
  }
  refuse_unused(m, o, &pair);
  m->pair[(size_t)which[1] * n + (size_t)which[0]] = back;
  m->pair[(size_t)which[0] * n + (size_t)which[1]] = pair;
}

void dem_pairs_read(dem_model *m, json_t *array, tdm_error *err) {
  size_t n = (size_t)m->nmaterial;
  m->pair = dem_allocate(n * n, sizeof *m->pair, err);
  m->settle_pair = dem_allocate(n * n, sizeof *m->settle_pair, err);
  for (size_t i = 0; i < json_array_size(array) && !err->status; i++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.pairs[%zu]", i);
    tdm_object o = tdm_object_open(json_array_get(array, i), path, err);
    read_pair(m, &o);
    tdm_object_close(&o);
  }
}

/* the law of a pair must be that of the contacts that it has */
static void check_pair_law(const dem_model *m, int a, int b, bool particles, bool walls, tdm_error *err) {
  const dem_normal_law *law = dem_normal_of(m, &m->pair[a * m->nmaterial + b]);
  if (particles && law != m->normal)
    tdm_fail(
        err, TDM_ERR_SCENE, "dem.pairs",
        "\"%s\" and \"%s\" meet as particles, whose normal law is dem.contact.normal, \"%s\", and not \"%s\": that "
        "is for walls; give the walls a material of their own, or remove \"normal\" from the pair",
        m->material[a].name, m->material[b].name, m->normal->head.name, law->head.name);
  else if (walls && law != m->wall_normal)
    tdm_fail(err, TDM_ERR_SCENE, "dem.pairs",
             "\"%s\" and \"%s\" meet at walls, whose normal law is \"%s\" in another pair; give this pair the same "
             "\"normal\" and its coefficients",
             m->material[a].name, m->material[b].name, m->wall_normal->head.name);
}

/* every pair that can meet must be given */
void dem_pairs_check(const dem_model *m, tdm_error *err) {
  int *many = dem_allocate((size_t)m->nmaterial, sizeof *many, err); /* particles of a material */
  for (int i = 0; many && i < m->nparticle; i++)
    many[m->particle_material[i]]++;
  for (int s = 0; many && s < m->nsource; s++)
    many[m->source[s].material] += m->source[s].count > 1 ? 2 : (int)m->source[s].count;
  for (int a = 0; many && a < m->nmaterial; a++)
    for (int b = a; b < m->nmaterial; b++) {
      bool particles = a == b ? many[a] > 1 : many[a] > 0 && many[b] > 0, walls = false;
      for (int w = 0; w < m->nwall; w++) {
        int of_wall = m->wall[w].material;
        walls = walls || (of_wall == a && many[b] > 0) || (of_wall == b && many[a] > 0);
      }
      if ((particles || walls) && !m->pair[a * m->nmaterial + b].given)
        tdm_fail(err, TDM_ERR_SCENE, "dem.pairs",
                 "\"%s\" and \"%s\" can touch but have no entry; add {\"materials\": [\"%s\", \"%s\"], "
                 "\"restitution\": …, \"friction\": …}",
                 m->material[a].name, m->material[b].name, m->material[a].name, m->material[b].name);
      check_pair_law(m, a, b, particles, walls, err);
    }
  free(many);
}

/* ---- settling ---- */

void dem_settle_pairs_read(dem_model *m, tdm_object *o) {
  const dem_tangential_law *law = m->tangential;
  bool given = tdm_has(o, "restitution"), rubs = tdm_has(o, "friction");
  double e = dem_get_restitution(o, 0.3), dynamic = 0, hold = 0;
  if (rubs && !law->friction)
    tdm_object_fail(o, "friction", "is not read by tangential \"%s\"; remove it", law->head.name);
  else if (rubs)
    read_friction(o, law, &dynamic, &hold);
  for (int k = 0; k < m->nmaterial * m->nmaterial && !o->err->status; k++) {
    dem_pair *pair = &m->settle_pair[k];
    *pair = m->pair[k];
    if (rubs)
      pair->friction = dynamic, pair->static_friction = hold;
    bool keep = dem_normal_of(m, pair)->settles_as_it_is && !given;
    if (!keep && pair->given)
      dem_set_restitution(m, pair, e, o->err, "dem.settle.restitution");
  }
}

/* ---- what follows ---- */

/* gap over which contacts act [m]: R* is largest at a wall */
static double law_reach(const dem_model *m) {
  double reach = 0;
  for (int k = 0; k < m->nmaterial * m->nmaterial; k++)
    if (m->cohesion->reach && m->pair[k].given)
      reach = fmax(reach, m->cohesion->reach(&m->pair[k], m->largest_radius));
  return reach;
}

void dem_contact_finish(dem_model *m, tdm_error *err) {
  bool sliding = false, needs = false;
  for (int k = 0; k < m->nmaterial * m->nmaterial; k++)
    for (int settling = 0; settling < 2; settling++) {
      const dem_pair *p = settling ? &m->settle_pair[k] : &m->pair[k];
      sliding = sliding || (m->tangential->sticks && p->static_friction != p->friction);
      const dem_normal_law *law = dem_normal_of(m, p);
      needs = needs || (law->needs_all_terms && law->needs_all_terms(p));
      needs = needs || (m->tangential->needs_all_terms && m->tangential->needs_all_terms(p));
    }
  m->couples = !m->rolling->head.none || !m->twisting->head.none;
  bool shared = m->multi_step.substeps > 0; /* an evaluation may leave contacts out */
  if (shared && !m->multi->head.none)
    tdm_fail(
        err, TDM_ERR_SCENE, "dem.contact.multi_contact",
        "\"%s\" does not go with dem.multi_step, which takes the contacts of a particle at different times; remove one",
        m->multi->head.name);
  m->all_terms = m->couples || !m->cohesion->head.none || m->energy || sliding || needs || shared;
  dem_loops_choose(m);
  if (!dem_columns_choose(m, sliding))
    tdm_fail(err, TDM_ERR_SCENE, "dem.contact",
             "the history of these laws has %d numbers a contact, more than the %d that there is room for; choose laws "
             "that remember less",
             m->columns.ncolumn, DEM_HISTORY_MAX);
  m->reach = law_reach(m);
}
