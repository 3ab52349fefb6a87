/* Reading materials, contact laws and pairs: see contact_read.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dem/contact/contact_read.h"

#include "dem/contact/restitution.h"
#include "dem/contact/theory.h"
#include "dem/step/integrate.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void *allocate(size_t n, size_t size, tdm_error *err) {
  void *p = calloc(n ? n : 1, size);
  if (!p)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "no memory for %zu items of the DEM model", n);
  return p;
}

/* ---- laws ---- */

static int choose(tdm_object *o, const char *key, const char *const *names, int fallback) {
  int n = 0;
  while (names[n])
    n++;
  int i = tdm_get_choice(o, key, names, n, fallback);
  return i < 0 ? 0 : i;
}

/* the row of a family that the scene names */
static int choose_law(tdm_object *o, const char *family, const dem_law_row *rows, int fallback) {
  const char *names[16] = {0};
  for (int k = 0; rows[k].name; k++)
    names[k] = rows[k].name;
  return choose(o, family, names, fallback);
}

/* the instruction set: the best of this machine unless the scene names one */
static void read_simd(dem_model *m, tdm_object *section) {
  m->simd = tdm_has(section, "simd") ? dem_simd_names[choose(section, "simd", dem_simd_names, 0)] : dem_simd_best();
  if (dem_simd_here(m->simd))
    return;
  tdm_object_fail(section, "simd", "this machine has no \"%s\"; remove the key, or use \"%s\"", m->simd,
                  dem_simd_best());
  m->simd = "plain";
}

/* exponent and lambda of Hunt and Crossley's law */
static void read_hunt_crossley(dem_model *m, tdm_object *o) {
  static const char *const lambdas[] = {"exact", "printed", NULL}, *const keys[] = {"exponent", "lambda"};
  m->exponent = 1.5;
  if (m->law->normal != DEM_NORMAL_hunt_crossley) {
    for (int k = 0; k < 2; k++)
      if (tdm_has(o, keys[k]))
        tdm_object_fail(o, keys[k], "is for \"normal\": \"hunt-crossley\" only, not for \"%s\"; remove it",
                        dem_normals[m->law->normal].name);
    return;
  }
  m->exponent = tdm_get_number(o, "exponent", 1.5, TDM_POSITIVE);
  m->printed = choose(o, "lambda", lambdas, 0) == 1;
}

/* sets that have a row but do not go together otherwise */
static void check_laws(const dem_model *m, tdm_object *o) {
  const dem_law *law = m->law;
  const char *normal = dem_normals[law->normal].name;
  if (law->tangential == DEM_TANGENTIAL_mindlin && m->exponent != 1.5)
    tdm_object_fail(
        o, "tangential",
        "\"mindlin\" needs the contact circle of Hertz's force, but the exponent is %g; use 1.5, or \"spring\"",
        m->exponent);
  if (m->cohesion == DEM_COHESION_jkr && law->normal != DEM_NORMAL_hertz)
    tdm_object_fail(o, "cohesion", "\"jkr\" changes the contact circle of normal \"hertz\", not \"%s\"; use \"sjkr\"",
                    normal);
  if (m->cohesion == DEM_COHESION_dmt && law->normal != DEM_NORMAL_hertz)
    tdm_object_fail(o, "cohesion",
                    "\"dmt\" is Hertz's force with a constant pull, not with normal \"%s\"; use \"sjkr\"", normal);
  if (m->cohesion == DEM_COHESION_jkr && m->clip)
    tdm_object_fail(o, "tail", "\"clip\" cuts the attraction that cohesion \"jkr\" is there for; use \"keep\"");
  if (law->normal == DEM_NORMAL_hunt_crossley && m->clip)
    tdm_object_fail(o, "tail",
                    "\"clip\" has no meaning with normal \"hunt-crossley\", whose force ends at 0 and does not attract "
                    "before; use \"keep\"");
  if (law->normal == DEM_NORMAL_hysteretic && m->clip)
    tdm_object_fail(o, "tail",
                    "\"clip\" has no meaning with normal \"hysteretic\", which has no damping: only "
                    "adhesion_stiffness attracts; use \"keep\"");
}

static void read_wall_mass(dem_model *m, tdm_object *o) {
  if (tdm_has(o, "wall_mass") && json_is_string(json_object_get(o->json, "wall_mass"))) {
    static const char *const body[] = {"body"};
    tdm_get_choice(o, "wall_mass", body, 1, 0);
  } else {
    m->wall_mass = tdm_get_number(o, "wall_mass", 0, tdm_has(o, "wall_mass") ? TDM_POSITIVE : TDM_ANY);
  }
}

void dem_contact_read(dem_model *m, tdm_object *section) {
  read_simd(m, section);
  tdm_object o = tdm_get_object(section, "contact", false);
  dem_normal normal = (dem_normal)choose_law(&o, "normal", dem_normals, DEM_NORMAL_hertz);
  bool circle = dem_law_find(m->simd, normal, DEM_TANGENTIAL_mindlin, false) != NULL;
  dem_tangential_law tangential = (dem_tangential_law)choose_law(
      &o, "tangential", dem_tangentials, circle ? DEM_TANGENTIAL_mindlin : DEM_TANGENTIAL_spring);
  m->rolling = (dem_rolling)choose_law(&o, "rolling", dem_rollings, DEM_ROLLING_none);
  m->twisting = (dem_twisting)choose_law(&o, "twisting", dem_twistings, DEM_TWISTING_none);
  m->cohesion = (dem_cohesion)choose_law(&o, "cohesion", dem_cohesions, DEM_COHESION_none);
  m->clip = choose(&o, "tail", dem_tail_names, 0) == 1;
  m->law = dem_law_find(m->simd, normal, tangential, false);
  if (!m->law) {
    tdm_object_fail(&o, "tangential",
                    "\"%s\" needs the contact circle of normal \"hertz\", which \"%s\" does not have; use \"spring\"",
                    dem_tangentials[tangential].name, dem_normals[normal].name);
    m->law = dem_law_find(m->simd, normal, DEM_TANGENTIAL_none, false);
  }
  read_hunt_crossley(m, &o);
  check_laws(m, &o);
  read_wall_mass(m, &o);
  tdm_object_close(&o);
}

/* ---- materials ---- */

/* do all contacts follow from elastic constants? (hunt-crossley: those of pairs without a stiffness) */
static bool needs_young(const dem_model *m) {
  return m->law->normal == DEM_NORMAL_hertz || m->law->tangential == DEM_TANGENTIAL_mindlin;
}

static void read_material(dem_model *m, tdm_object *o) {
  const char *name = tdm_get_string(o, "name", NULL);
  int same = dem_find_material(m, name);
  if (same >= 0)
    tdm_object_fail(o, "name", "\"%s\" is the name of dem.materials[%d] already; give each material its own", name,
                    same);
  dem_material *material = &m->material[m->nmaterial++];
  material->name = strdup(name);
  material->density = tdm_get_number(o, "density", TDM_REQUIRED, TDM_POSITIVE);
  if (!needs_young(m) && !tdm_has(o, "young_modulus") && !tdm_has(o, "poisson_ratio"))
    return;
  material->young = tdm_get_number(o, "young_modulus", TDM_REQUIRED, TDM_POSITIVE);
  material->poisson = tdm_get_number(o, "poisson_ratio", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  if (material->poisson >= 0.5)
    tdm_object_fail(o, "poisson_ratio", "is %g but must be less than 0.5", material->poisson);
  material->shear = material->young / (2 * (1 + material->poisson));
}

void dem_materials_read(dem_model *m, json_t *array, tdm_error *err) {
  size_t n = json_array_size(array);
  m->material = allocate(n, sizeof *m->material, err);
  for (size_t i = 0; i < n && !err->status; i++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.materials[%zu]", i);
    tdm_object o = tdm_object_open(json_array_get(array, i), path, err);
    read_material(m, &o);
    tdm_object_close(&o);
  }
}

/* ---- coefficients of a pair ---- */

/* a coefficient that a law needs; says so when it is missing */
static double need(tdm_object *o, const char *key, const char *family, const dem_law_row *law, tdm_range range) {
  bool before = o->err->status != TDM_OK, missing = !tdm_has(o, key);
  double value = tdm_get_number(o, key, TDM_REQUIRED, range);
  if (missing && !before) {
    char *message = o->err->message;
    size_t used = strlen(message);
    snprintf(message + used, sizeof o->err->message - used, " (%s \"%s\" needs it)", family, law->name);
  }
  return value;
}

/* exactly one of two keys; true: the first */
static bool one_of(tdm_object *o, const char *first, const char *second, const char *law) {
  if (tdm_has(o, first) && tdm_has(o, second))
    tdm_object_fail(o, second, "excludes \"%s\"; normal \"%s\" takes one of them", first, law);
  return tdm_has(o, first) || !tdm_has(o, second);
}

static double read_restitution(tdm_object *o, double fallback) {
  double e = tdm_get_number(o, "restitution", fallback, TDM_UNIT_INTERVAL);
  if (e <= 0)
    tdm_object_fail(o, "restitution",
                    "is 0 but must be greater than 0 and at most 1; a small value such as 0.01 "
                    "takes nearly all the energy");
  return e > 0 ? e : 1;
}

/* ---- damping from the restitution ---- */

static bool damp_hooke(const dem_model *m, dem_pair *p) {
  p->normal_damping = 2 * dem_linear_ratio(p->restitution, m->clip);
  return true;
}

static bool damp_hertz(const dem_model *m, dem_pair *p) {
  double beta = dem_beta_keep(p->restitution);
  bool good = !m->clip || dem_beta_clip(p->restitution, &beta);
  p->normal_damping = 2 * sqrt(5.0 / 6) * beta;
  return good;
}

static bool damp_hunt_crossley(const dem_model *m, dem_pair *p) {
  double e = p->restitution;
  p->normal_damping = m->printed ? 0.75 * (1 - e * e) : dem_hunt_damping(e);
  return true;
}

static bool damp_hysteretic(const dem_model *m, dem_pair *p) {
  (void)m;
  p->unloading = p->stiffness / (p->restitution * p->restitution);
  p->plastic = 1 - p->stiffness / p->unloading;
  return true;
}

/* of the tangential law, from the restitution as well */
static void damp_tangential(const dem_model *m, dem_pair *p) {
  double beta = p->restitution > 0 ? dem_beta_keep(p->restitution) : 0;
  if (m->law->tangential == DEM_TANGENTIAL_mindlin) {
    double normal = m->law->normal == DEM_NORMAL_hertz ? p->normal_damping : 2 * sqrt(5.0 / 6) * beta;
    p->tangential_damping = normal * sqrt(8 * p->effective_shear / (2 * p->effective_young));
  }
  if (m->law->tangential == DEM_TANGENTIAL_spring)
    p->tangential_damping = p->damps_as_normal * 2 * beta * sqrt(p->tangential_stiffness);
}

/* by normal law: its coefficients, and those that follow from restitution (false: it is too small) */
typedef struct {
  void (*read)(dem_model *, tdm_object *, dem_pair *);
  bool (*damp)(const dem_model *, dem_pair *);
} normal_reader;
static const normal_reader normal_readers[DEM_NORMALS];

/* all that follows from restitution; false after an error */
static bool set_restitution(const dem_model *m, dem_pair *p, double e, tdm_error *err, const char *path) {
  p->restitution = e;
  p->viscosity = 0;
  if (!normal_readers[m->law->normal].damp(m, p))
    tdm_fail(err, TDM_ERR_SCENE, path, "is %g, too small for \"tail\": \"clip\"; give at least 0.001", e);
  damp_tangential(m, p);
  return !err->status;
}

/* the key "restitution" and what follows */
static void read_damping(const dem_model *m, tdm_object *o, dem_pair *p) {
  char place[TDM_PATH_MAX];
  double e = read_restitution(o, TDM_REQUIRED);
  if (!o->err->status)
    set_restitution(m, p, e, o->err, tdm_path(place, o, "restitution", -1));
}

/* ---- normal ---- */

static void read_hooke(dem_model *m, tdm_object *o, dem_pair *p) {
  const dem_law_row *law = &dem_normals[DEM_NORMAL_hooke];
  bool stiffness = one_of(o, "stiffness", "contact_time", law->name);
  bool restitution = one_of(o, "restitution", "damping", law->name);
  if (stiffness)
    p->stiffness = need(o, "stiffness", "normal", law, TDM_POSITIVE);
  if (restitution) {
    read_damping(m, o, p);
  } else if (!stiffness) {
    tdm_object_fail(o, "damping", "goes with \"stiffness\"; a contact_time needs \"restitution\"");
  } else if (json_is_string(json_object_get(o->json, "damping"))) {
    static const char *const critical[] = {"critical"};
    tdm_get_choice(o, "damping", critical, 1, 0);
    p->normal_damping = 2;
  } else {
    p->viscosity = tdm_get_number(o, "damping", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  }
  if (!stiffness) {
    double time = tdm_get_number(o, "contact_time", TDM_REQUIRED, TDM_POSITIVE);
    p->stiffness_per_mass = pow(dem_linear_time(0.5 * p->normal_damping, m->clip) / time, 2);
  }
}

static void read_hertz(dem_model *m, tdm_object *o, dem_pair *p) {
  if (one_of(o, "restitution", "viscosity", "hertz"))
    read_damping(m, o, p);
  else
    p->viscosity = tdm_get_number(o, "viscosity", TDM_REQUIRED, TDM_NOT_NEGATIVE);
}

static void read_hunt_pair(dem_model *m, tdm_object *o, dem_pair *p) {
  const dem_law_row *law = &dem_normals[DEM_NORMAL_hunt_crossley];
  if (tdm_has(o, "stiffness") && m->law->tangential == DEM_TANGENTIAL_mindlin)
    tdm_object_fail(
        o, "stiffness",
        "is not Hertz's, and tangential \"mindlin\" needs his contact circle; remove it, or use \"spring\"");
  else if (tdm_has(o, "stiffness") || !(p->effective_young > 0) || m->exponent != 1.5)
    p->stiffness = need(o, "stiffness", "without elastic constants and exponent 1.5, normal", law, TDM_POSITIVE);
  else
    p->hertzian = 4.0 / 3 * p->effective_young;
  p->speed_floor = tdm_get_number(o, "speed_floor", 1e-3, TDM_POSITIVE);
  read_damping(m, o, p);
}

static void read_hysteretic(dem_model *m, tdm_object *o, dem_pair *p) {
  const dem_law_row *law = &dem_normals[DEM_NORMAL_hysteretic];
  p->stiffness = need(o, "stiffness", "normal", law, TDM_POSITIVE);
  if (one_of(o, "restitution", "unloading_stiffness", law->name))
    read_damping(m, o, p);
  else
    p->unloading = tdm_get_number(o, "unloading_stiffness", TDM_REQUIRED, TDM_POSITIVE);
  if (p->unloading < p->stiffness)
    tdm_object_fail(o, "unloading_stiffness", "is %g N/m but must be at least the stiffness %g N/m", p->unloading,
                    p->stiffness);
  p->plastic = 1 - p->stiffness / p->unloading;
  p->adhesion_slope = tdm_get_number(o, "adhesion_stiffness", 0, TDM_NOT_NEGATIVE);
}

static const normal_reader normal_readers[DEM_NORMALS] = {
    [DEM_NORMAL_hooke] = {read_hooke, damp_hooke},
    [DEM_NORMAL_hertz] = {read_hertz, damp_hertz},
    [DEM_NORMAL_hunt_crossley] = {read_hunt_pair, damp_hunt_crossley},
    [DEM_NORMAL_hysteretic] = {read_hysteretic, damp_hysteretic},
};

/* ---- the other families ---- */

/* "friction": one number, or {"static", "dynamic"} */
static void read_friction(tdm_object *o, const char *law, double *dynamic, double *hold) {
  if (json_is_object(json_object_get(o->json, "friction"))) {
    tdm_object both = tdm_get_object(o, "friction", true);
    *dynamic = tdm_get_number(&both, "dynamic", TDM_REQUIRED, TDM_NOT_NEGATIVE);
    *hold = tdm_get_number(&both, "static", TDM_REQUIRED, TDM_NOT_NEGATIVE);
    if (*hold < *dynamic)
      tdm_object_fail(&both, "static", "is %g but must be at least the dynamic one, %g", *hold, *dynamic);
    if (*hold != *dynamic && strcmp(law, "coulomb") == 0)
      tdm_object_fail(&both, "static",
                      "has no meaning with tangential \"coulomb\", which never sticks; use \"spring\"");
    tdm_object_close(&both);
  } else {
    *dynamic = *hold = tdm_get_number(o, "friction", TDM_REQUIRED, TDM_NOT_NEGATIVE);
  }
}

static void read_tangential(const dem_model *m, tdm_object *o, dem_pair *p) {
  dem_tangential_law t = m->law->tangential;
  const dem_law_row *law = &dem_tangentials[t];
  bool rubs = t != DEM_TANGENTIAL_none && t != DEM_TANGENTIAL_viscous;
  if (rubs)
    read_friction(o, law->name, &p->friction, &p->static_friction);
  if (t == DEM_TANGENTIAL_viscous)
    p->tangential_viscosity = need(o, "tangential_damping", "tangential", law, TDM_NOT_NEGATIVE);
  if (t == DEM_TANGENTIAL_spring) {
    bool linear = m->law->normal == DEM_NORMAL_hooke || m->law->normal == DEM_NORMAL_hysteretic;
    if (linear && p->stiffness > 0)
      p->tangential_stiffness = tdm_get_number(o, "tangential_stiffness", 2.0 / 7 * p->stiffness, TDM_POSITIVE);
    else
      p->tangential_stiffness = need(o, "tangential_stiffness", "tangential", law, TDM_POSITIVE);
    p->damps_as_normal = !tdm_has(o, "tangential_damping");
    p->tangential_viscosity = tdm_get_number(o, "tangential_damping", 0, TDM_NOT_NEGATIVE);
  }
  damp_tangential(m, p);
}

static void read_others(const dem_model *m, tdm_object *o, dem_pair *p) {
  const dem_law_row *rolling = &dem_rollings[m->rolling];
  if (m->rolling != DEM_ROLLING_none)
    p->rolling_friction = need(o, "rolling_friction", "rolling", rolling, TDM_NOT_NEGATIVE);
  if (m->rolling == DEM_ROLLING_spring_dashpot)
    p->rolling_damping = tdm_get_number(o, "rolling_damping", 0.3, TDM_NOT_NEGATIVE);
  if (m->twisting != DEM_TWISTING_none)
    p->twisting_friction = need(o, "twisting_friction", "twisting", &dem_twistings[m->twisting], TDM_NOT_NEGATIVE);
  if (m->cohesion == DEM_COHESION_sjkr)
    p->cohesion_density = need(o, "cohesion_density", "cohesion", &dem_cohesions[m->cohesion], TDM_NOT_NEGATIVE);
  if (m->cohesion == DEM_COHESION_dmt)
    p->adhesion_energy = need(o, "adhesion_energy", "cohesion", &dem_cohesions[m->cohesion], TDM_NOT_NEGATIVE);
  if (m->cohesion == DEM_COHESION_jkr) {
    /* 0 would have no length of its own: so little that no contact feels it */
    double energy = need(o, "adhesion_energy", "cohesion", &dem_cohesions[m->cohesion], TDM_NOT_NEGATIVE);
    p->adhesion_energy = fmax(energy, 1e-18);
    p->adhesion_length = cbrt(M_PI * p->adhesion_energy / p->effective_young);
  }
}

/* keys of laws that the scene has not chosen are no typing errors: say what they are */
static void refuse_unused(const dem_model *m, tdm_object *o) {
  static const char *const keys[] = {"friction",
                                     "stiffness",
                                     "contact_time",
                                     "damping",
                                     "viscosity",
                                     "speed_floor",
                                     "unloading_stiffness",
                                     "adhesion_stiffness",
                                     "tangential_stiffness",
                                     "tangential_damping",
                                     "rolling_friction",
                                     "rolling_damping",
                                     "twisting_friction",
                                     "cohesion_density",
                                     "adhesion_energy"};
  for (size_t k = 0; k < sizeof keys / sizeof keys[0]; k++) {
    bool asked = false;
    for (int a = 0; a < o->nasked; a++)
      asked = asked || strcmp(o->asked[a], keys[k]) == 0;
    if (!asked && o->json && json_object_get(o->json, keys[k]))
      tdm_object_fail(o, keys[k],
                      "is read by none of the scene's laws (normal \"%s\", tangential \"%s\", rolling \"%s\", twisting "
                      "\"%s\", cohesion \"%s\"); remove it, or choose its law in dem.contact",
                      dem_normals[m->law->normal].name, dem_tangentials[m->law->tangential].name,
                      dem_rollings[m->rolling].name, dem_twistings[m->twisting].name, dem_cohesions[m->cohesion].name);
  }
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

static void read_pair(dem_model *m, tdm_object *o) {
  size_t n = (size_t)m->nmaterial;
  int which[2] = {0, 0};
  if (!read_pair_names(m, o, which))
    return;
  const dem_material *a = &m->material[which[0]], *b = &m->material[which[1]];
  dem_pair pair = {.given = true, .floor = m->clip ? 0 : -INFINITY};
  if (m->pair[(size_t)which[0] * n + (size_t)which[1]].given)
    tdm_object_fail(o, NULL, "the pair \"%s\", \"%s\" is given twice; remove one", a->name, b->name);
  elastic_constants(a, b, &pair);
  normal_readers[m->law->normal].read(m, o, &pair);
  read_tangential(m, o, &pair);
  read_others(m, o, &pair);
  refuse_unused(m, o);
  m->pair[(size_t)which[0] * n + (size_t)which[1]] = pair;
  m->pair[(size_t)which[1] * n + (size_t)which[0]] = pair;
}

void dem_pairs_read(dem_model *m, json_t *array, tdm_error *err) {
  size_t n = (size_t)m->nmaterial;
  m->pair = allocate(n * n, sizeof *m->pair, err);
  m->settle_pair = allocate(n * n, sizeof *m->settle_pair, err);
  for (size_t i = 0; i < json_array_size(array) && !err->status; i++) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "dem.pairs[%zu]", i);
    tdm_object o = tdm_object_open(json_array_get(array, i), path, err);
    read_pair(m, &o);
    tdm_object_close(&o);
  }
}

/* every pair that can meet must be given */
void dem_pairs_check(const dem_model *m, tdm_error *err) {
  int *many = allocate((size_t)m->nmaterial, sizeof *many, err); /* particles of a material */
  for (int i = 0; many && i < m->nparticle; i++)
    many[m->particle_material[i]]++;
  for (int s = 0; many && s < m->nsource; s++)
    many[m->source[s].material] += m->source[s].count > 1 ? 2 : (int)m->source[s].count;
  for (int a = 0; many && a < m->nmaterial; a++)
    for (int b = a; b < m->nmaterial; b++) {
      bool meet = a == b ? many[a] > 1 : many[a] > 0 && many[b] > 0;
      for (int w = 0; w < m->nwall; w++) {
        int of_wall = m->body[m->wall[w].body].material;
        meet = meet || (of_wall == a && many[b] > 0) || (of_wall == b && many[a] > 0);
      }
      if (meet && !m->pair[a * m->nmaterial + b].given)
        tdm_fail(err, TDM_ERR_SCENE, "dem.pairs",
                 "\"%s\" and \"%s\" can touch but have no entry; add {\"materials\": [\"%s\", \"%s\"], "
                 "\"restitution\": …, \"friction\": …}",
                 m->material[a].name, m->material[b].name, m->material[a].name, m->material[b].name);
    }
  free(many);
}

/* ---- settling ---- */

/* A hysteretic contact keeps its unloading stiffness unless dem.settle names a restitution: its history would mean
 * another force with another one. */
void dem_settle_pairs_read(dem_model *m, tdm_object *o) {
  bool keep = m->law->normal == DEM_NORMAL_hysteretic && !tdm_has(o, "restitution");
  double e = read_restitution(o, 0.3), dynamic = 0, hold = 0;
  dem_tangential_law t = m->law->tangential;
  bool rubs = tdm_has(o, "friction");
  if (rubs && (t == DEM_TANGENTIAL_none || t == DEM_TANGENTIAL_viscous))
    tdm_object_fail(o, "friction", "is not read by tangential \"%s\"; remove it", dem_tangentials[t].name);
  else if (rubs)
    read_friction(o, dem_tangentials[m->law->tangential].name, &dynamic, &hold);
  for (int k = 0; k < m->nmaterial * m->nmaterial && !o->err->status; k++) {
    dem_pair *pair = &m->settle_pair[k];
    *pair = m->pair[k];
    if (rubs)
      pair->friction = dynamic, pair->static_friction = hold;
    if (!keep && pair->given)
      set_restitution(m, pair, e, o->err, "dem.settle.restitution");
  }
}

/* ---- what follows ---- */

/* gap over which contacts act [m]: R* is largest at a wall */
static double law_reach(const dem_model *m) {
  double reach = 0;
  for (int k = 0; k < m->nmaterial * m->nmaterial; k++)
    if (m->cohesion == DEM_COHESION_jkr && m->pair[k].given)
      reach = fmax(reach, dem_jkr_reach(dem_largest_radius(m), m->pair[k].effective_young, m->pair[k].adhesion_energy));
  return reach;
}

void dem_contact_finish(dem_model *m) {
  bool sliding = false, viscous = false;
  for (int k = 0; k < m->nmaterial * m->nmaterial; k++)
    for (int settling = 0; settling < 2; settling++) {
      const dem_pair *p = settling ? &m->settle_pair[k] : &m->pair[k];
      sliding = sliding || p->static_friction != p->friction;
      viscous = viscous || p->viscosity > 0;
    }
  sliding = sliding && dem_tangentials[m->law->tangential].ncolumn > 0;
  viscous = viscous && m->law->normal == DEM_NORMAL_hertz;
  m->couples = m->rolling != DEM_ROLLING_none || m->twisting != DEM_TWISTING_none;
  bool shared = m->multi_step.substeps > 0; /* an evaluation may leave contacts out */
  bool all_terms = m->couples || m->cohesion != DEM_COHESION_none || m->energy || sliding || viscous || shared;
  m->law = dem_law_find(m->simd, m->law->normal, m->law->tangential, all_terms);
  m->columns = dem_columns_of(m->law, m->rolling, m->cohesion, sliding);
  m->reach = law_reach(m);
}
