/* Reading the section of the scene: see mapping.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "mbd/foreign/fmu/mapping.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- variables ---- */

/* A variable of that name. An error at `path` names the nearest. */
static const tdm_fmi_variable *find(const tdm_fmu *fmu, const char *name, const char *path, tdm_error *err) {
  const tdm_fmi_description *d = &fmu->description;
  const tdm_fmi_variable *v = tdm_description_find(d, name);
  if (v)
    return v;
  const char **names = calloc((size_t)d->nvariable + 1, sizeof *names);
  for (int i = 0; names && i < d->nvariable; i++)
    names[i] = d->variable[i].name;
  const char *near = names ? tdm_nearest(name, names, d->nvariable) : NULL;
  tdm_fail(err, TDM_ERR_SCENE, path, "%s has no variable \"%s\"%s%s%s; \"tandem-fmu %s\" lists them", fmu->file, name,
           near ? "; did you mean \"" : "", near ? near : "", near ? "\"?" : "", fmu->file);
  free(names);
  return NULL;
}

/* Whether a list has the variable, maybe by another name. */
static bool is_taken(const fmu_list *l, const tdm_fmi_variable *v) {
  for (int i = 0; i < l->nvariable; i++)
    if (l->reference[i] == v->reference)
      return true;
  return false;
}

/* A variable of type real that is an input which nothing is mapped to yet, or else what can be looked at. */
static const tdm_fmi_variable *find_real(const fmu_mapping *m, const char *name, bool input, const char *path,
                                         tdm_error *err) {
  const tdm_fmi_variable *v = find(m->fmu, name, path, err);
  if (!v)
    return NULL;
  const bool fits =
      input ? v->causality == TDM_FMI_INPUT : v->causality == TDM_FMI_OUTPUT || v->causality == TDM_FMI_LOCAL;
  if (!fits)
    tdm_fail(err, TDM_ERR_SCENE, path, "the variable \"%s\" of %s has the causality \"%s\"; here it must be %s", name,
             m->fmu->file, tdm_fmi_causality_names[v->causality],
             input ? "an \"input\"" : "an \"output\" (or \"local\")");
  else if (v->type != TDM_FMI_REAL)
    tdm_fail(err, TDM_ERR_SCENE, path, "the variable \"%s\" of %s is of type %s; loads and motions are real (%s)", name,
             m->fmu->file, v->type_name ? v->type_name : "?", m->fmu->description.version == 3 ? "Float64" : "Real");
  else if (v->size == 0)
    tdm_fail(err, TDM_ERR_SCENE, path,
             "the size of the variable \"%s\" of %s depends on a structural parameter; "
             "tandem-fmu takes fixed sizes",
             name, m->fmu->file);
  else if (input && is_taken(&m->inputs, v))
    tdm_fail(err, TDM_ERR_SCENE, path, "the input \"%s\" of %s is mapped already; it can take one component of a load",
             name, m->fmu->file);
  else
    return v;
  return NULL;
}

/* The number of a variable's first value in a list, which it is added to; -1: no memory. */
static int add(fmu_list *l, const tdm_fmi_variable *v, tdm_error *err) {
  for (int i = 0; i < l->nvariable; i++)
    if (l->variable[i] == v)
      return l->first[i];
  const size_t n = (size_t)l->nvariable + 1;
  void *a = realloc(l->variable, n * sizeof *l->variable);
  l->variable = a ? a : l->variable;
  void *b = realloc(l->reference, n * sizeof *l->reference);
  l->reference = b ? b : l->reference;
  void *c = realloc(l->first, n * sizeof *l->first);
  l->first = c ? c : l->first;
  if (!a || !b || !c) {
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
    return -1;
  }
  l->variable[l->nvariable] = v;
  l->reference[l->nvariable] = v->reference;
  l->first[l->nvariable++] = l->nvalue;
  l->nvalue += (int)v->size;
  return l->first[l->nvariable - 1];
}

/* A slot of the variable that a text names; "-x" is the negative of x. */
static fmu_slot read_variable(fmu_mapping *m, const char *text, bool input, const char *path, tdm_error *err) {
  const bool negative = text[0] == '-' && !tdm_description_find(&m->fmu->description, text);
  const tdm_fmi_variable *v = find_real(m, text + negative, input, path, err);
  if (v && v->size != 1)
    tdm_fail(err, TDM_ERR_SCENE, path, "the variable \"%s\" of %s has %ld elements, here is one", v->name, m->fmu->file,
             v->size);
  const int at = err->status == TDM_OK ? add(input ? &m->inputs : &m->outputs, v, err) : -1;
  return (fmu_slot){.at = at, .value = negative ? -1 : 1};
}

/* The n numbers under `key`: the name of an array variable, or a list of names, constants and null (0; of an input:
 * the FMU does not get it). Missing: all zero. Whether any is a variable. */
static bool read_slots(fmu_mapping *m, tdm_object *o, const char *key, bool input, int n, fmu_slot *slot) {
  char path[TDM_PATH_MAX];
  bool any = false;
  for (int k = 0; k < n; k++)
    slot[k] = (fmu_slot){.at = -1};
  if (!tdm_has(o, key))
    return false;
  json_t *given = json_object_get(o->json, key);
  if (json_is_string(given)) {
    const tdm_fmi_variable *v = find_real(m, json_string_value(given), input, tdm_path(path, o, key, -1), o->err);
    if (v && v->size != n)
      tdm_object_fail(o, key, "the variable \"%s\" of %s has %ld elements, here are %d", v->name, m->fmu->file, v->size,
                      n);
    const int first = v && v->size == n ? add(input ? &m->inputs : &m->outputs, v, o->err) : -1;
    for (int k = 0; k < n && first >= 0; k++)
      slot[k] = (fmu_slot){.at = first + k, .value = 1};
    return true;
  }
  if (!json_is_array(given) || json_array_size(given) != (size_t)n) {
    tdm_object_fail(o, key,
                    "give a list of %d: names of variables of the FMU, %snull; or the name of one variable with "
                    "so many elements",
                    n, input ? "" : "numbers that do not change, ");
    return false;
  }
  for (int k = 0; k < n && o->err->status == TDM_OK; k++) {
    json_t *entry = json_array_get(given, (size_t)k);
    tdm_path(path, o, key, k);
    if (json_is_string(entry)) {
      slot[k] = read_variable(m, json_string_value(entry), input, path, o->err);
      any = true;
    } else if (json_is_number(entry) && !input) {
      slot[k].value = json_number_value(entry);
    } else if (!json_is_null(entry)) {
      tdm_fail(o->err, TDM_ERR_SCENE, path, "give the name of a variable of the FMU%s or null",
               input ? "" : ", a number that does not change");
    }
  }
  return any;
}

/* Rates by the standard's attribute "derivative", for what is not mapped. */
static void find_rates(fmu_mapping *m, const fmu_slot *of, fmu_slot *slot, tdm_error *err) {
  for (int k = 0; k < 3; k++) {
    slot[k] = (fmu_slot){.at = -1};
    for (int i = 0; i < m->outputs.nvariable && of[k].at >= 0; i++) {
      const int element = of[k].at - m->outputs.first[i];
      if (element < 0 || element >= m->outputs.variable[i]->size)
        continue;
      const tdm_fmi_variable *rate = tdm_description_derivative(&m->fmu->description, m->outputs.variable[i]);
      if (rate && rate->type == TDM_FMI_REAL && rate->size == m->outputs.variable[i]->size)
        slot[k] = (fmu_slot){.at = add(&m->outputs, rate, err) + element, .value = of[k].value};
      break;
    }
  }
}

/* ---- bodies ---- */

static int axes_of(tdm_object *o, const char *key) {
  static const char *const choices[] = {"frame", "body"};
  return tdm_get_choice(o, key, choices, 2, 0);
}

static void read_inputs(fmu_mapping *m, tdm_object *body, fmu_body *b) {
  static const char *const abouts[] = {"center", "point", "origin"};
  tdm_object o = tdm_get_object(body, "inputs", true);
  const bool force = read_slots(m, &o, "force", true, 3, b->load);
  const bool moment = read_slots(m, &o, "moment", true, 3, b->load + 3);
  b->load_in_body = axes_of(&o, "axes") == 1;
  const int about = tdm_get_choice(&o, "moment_about", abouts, 3, 0);
  b->about = about < 0 ? FMU_ABOUT_CENTRE : (fmu_about)about;
  if (o.err->status == TDM_OK && !force && !moment)
    tdm_object_fail(&o, NULL, "names no variable: the loads of the particles would go nowhere");
  tdm_object_close(&o);
}

/* Whether it changes. */
static bool read_orientation(fmu_mapping *m, tdm_object *outputs, fmu_body *b) {
  static const struct {
    const char *key;
    int n;
  } kinds[] = {[FMU_EULER313] = {"euler313", 3},
               [FMU_QUATERNION] = {"quaternion", 4},
               [FMU_MATRIX] = {"matrix", 9},
               [FMU_ANGLE] = {"angle", 1}};
  bool any = false;
  tdm_object o = tdm_get_object(outputs, "orientation", false);
  for (int k = FMU_EULER313; k <= FMU_ANGLE; k++)
    if (o.json && tdm_has(&o, kinds[k].key)) {
      if (b->turn != FMU_FIXED)
        tdm_object_fail(&o, NULL, "give one of euler313, quaternion, matrix, angle");
      b->turn = (fmu_turn)k;
      any = read_slots(m, &o, kinds[k].key, false, kinds[k].n, b->orientation);
    }
  if (b->turn == FMU_ANGLE) {
    b->axis = tdm_get_vec3(&o, "axis", NULL);
    if (o.err->status == TDM_OK && tdm_norm(b->axis) < 1e-12)
      tdm_object_fail(&o, "axis", "give a direction other than zero");
    b->axis = tdm_unit(b->axis);
  }
  if (o.json && b->turn == FMU_FIXED && o.err->status == TDM_OK)
    tdm_object_fail(&o, NULL, "give one of euler313, quaternion, matrix, angle (with axis)");
  tdm_object_close(&o);
  return any;
}

static void read_outputs(fmu_mapping *m, tdm_object *body, fmu_body *b) {
  tdm_object o = tdm_get_object(body, "outputs", true);
  const bool moves = read_slots(m, &o, "position", false, 3, b->position);
  const bool fast = read_slots(m, &o, "velocity", false, 3, b->velocity);
  const bool turns = read_orientation(m, &o, b);
  const bool spins = read_slots(m, &o, "angular_velocity", false, 3, b->angular);
  b->angular_in_body = axes_of(&o, "angular_axes") == 1;
  if (o.err->status == TDM_OK && moves && !fast)
    tdm_object_fail(&o, "velocity",
                    "is missing: the position changes, so contacts need the velocity; make it an output "
                    "of the FMU");
  if (o.err->status == TDM_OK && turns && !spins)
    tdm_object_fail(&o, "angular_velocity",
                    "is missing: the orientation changes, so contacts need the angular "
                    "velocity; make it an output of the FMU");
  if (o.err->status == TDM_OK && !moves && !turns)
    tdm_object_fail(&o, NULL, "names no variable of a position or an orientation: the body would never move");
  /* vectors along the body's axes change with those as well: their rates are not the components' */
  const bool a = read_slots(m, &o, "acceleration", false, 3, b->acceleration);
  const bool c = read_slots(m, &o, "angular_acceleration", false, 3, b->angular_rate);
  if (o.err->status == TDM_OK && !a)
    find_rates(m, b->velocity, b->acceleration, o.err);
  if (o.err->status == TDM_OK && !c && !b->angular_in_body)
    find_rates(m, b->angular, b->angular_rate, o.err);
  for (int k = 0; k < 3; k++)
    m->accelerates = m->accelerates && (b->velocity[k].at < 0 || b->acceleration[k].at >= 0) &&
                     (b->angular[k].at < 0 || b->angular_rate[k].at >= 0);
  tdm_object_close(&o);
}

static void read_body(fmu_mapping *m, tdm_object *o, fmu_body *b) {
  const tdm_vec3 zero = {0};
  double i[6] = {0};
  b->name = tdm_get_string(o, "name", NULL);
  b->mass = tdm_get_number(o, "mass", TDM_REQUIRED, TDM_POSITIVE);
  const bool full = json_array_size(tdm_get_array(o, "inertia", true)) == 6;
  tdm_get_numbers(o, "inertia", i, full ? 6 : 3, true);
  b->inertia = (tdm_mat3){{{i[0], i[3], i[4]}, {i[3], i[1], i[5]}, {i[4], i[5], i[2]}}};
  if (o->err->status == TDM_OK && !tdm_is_inertia(&b->inertia))
    tdm_object_fail(o, "inertia", "no body has such an inertia: give moments about the centre of mass, body axes");
  tdm_object frame = tdm_get_object(o, "frame", false);
  b->origin = tdm_get_vec3(&frame, "origin", &zero);
  b->frame = tdm_get_orientation(&frame, "orientation");
  tdm_object_close(&frame);
  b->point = tdm_get_vec3(o, "point", &zero);
  read_inputs(m, o, b);
  read_outputs(m, o, b);
  tdm_object_close(o);
}

/* The bodies that are coupled, in ASSIGN's order. */
static void read_bodies(fmu_mapping *m, tdm_object *o, const tdm_assignment *a) {
  char path[TDM_PATH_MAX];
  json_t *list = tdm_get_array(o, "bodies", true);
  const size_t n = json_array_size(list);
  m->nbody = a->nbody;
  m->body = calloc((size_t)a->nbody + 1, sizeof *m->body);
  if (!m->body)
    tdm_fail(o->err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (int i = 0; i < a->nbody && o->err->status == TDM_OK; i++) {
    size_t k = 0;
    const char *name = "";
    for (; k < n; k++) {
      name = json_string_value(json_object_get(json_array_get(list, k), "name"));
      if (name && strcmp(name, a->body[i].name) == 0)
        break;
    }
    if (k == n) {
      snprintf(path, sizeof path, "coupling.bodies[%d].mbd", i);
      tdm_fail(o->err, TDM_ERR_SCENE, path, "there is no body \"%s\" in mbd.bodies", a->body[i].name);
      return;
    }
    tdm_object body = tdm_object_open(json_array_get(list, k), tdm_path(path, o, "bodies", (int)k), o->err);
    read_body(m, &body, &m->body[i]);
  }
}

/* ---- the rest ---- */

static void read_units(fmu_mapping *m, tdm_object *o) {
  static const char *const angles[] = {"radian", "degree"};
  tdm_object units = tdm_get_object(o, "units", false);
  m->length = tdm_get_number(&units, "length", 1, TDM_POSITIVE);
  m->force = tdm_get_number(&units, "force", 1, TDM_POSITIVE);
  m->angle = tdm_get_choice(&units, "angle", angles, 2, 0) == 1 ? acos(-1.0) / 180 : 1;
  tdm_object_close(&units);
}

static void read_parameters(fmu_mapping *m, tdm_object *o) {
  const char *name;
  json_t *value;
  tdm_object parameters = tdm_get_object(o, "parameters", false);
  m->parameters = parameters.json;
  json_object_foreach(m->parameters, name, value) {
    char path[TDM_PATH_MAX];
    snprintf(path, sizeof path, "%s.%s", parameters.path, name);
    const tdm_fmi_variable *v = find(m->fmu, name, path, o->err);
    if (!v)
      return;
    if (v->constant || v->causality == TDM_FMI_CALCULATED_PARAMETER || v->causality == TDM_FMI_INDEPENDENT ||
        v->causality == TDM_FMI_STRUCTURAL_PARAMETER) {
      tdm_fail(o->err, TDM_ERR_SCENE, path, "the variable \"%s\" of %s is %s%s: it cannot be given a value", name,
               m->fmu->file, v->constant ? "constant" : "of causality ",
               v->constant ? "" : tdm_fmi_causality_names[v->causality]);
      return;
    }
  }
}

static void read_channels(fmu_mapping *m, tdm_object *o) {
  char path[TDM_PATH_MAX];
  json_t *list = tdm_get_array(o, "channels", false);
  const size_t n = json_array_size(list);
  m->channel = calloc(n + 1, sizeof *m->channel);
  if (!m->channel)
    tdm_fail(o->err, TDM_ERR_MEMORY, NULL, "out of memory");
  for (size_t i = 0; i < n && o->err->status == TDM_OK; i++) {
    fmu_channel *c = &m->channel[m->nchannel];
    tdm_object entry = tdm_object_open(json_array_get(list, i), tdm_path(path, o, "channels", (int)i), o->err);
    const char *name = tdm_get_string(&entry, "name", NULL), *variable = tdm_get_string(&entry, "variable", name);
    const char *unit = tdm_get_string(&entry, "unit", "-");
    const tdm_fmi_variable *v =
        o->err->status == TDM_OK ? find_real(m, variable, false, tdm_path(path, &entry, "variable", -1), o->err) : NULL;
    if (v && v->size != 1)
      tdm_object_fail(&entry, "variable", "is an array; a channel is a number");
    tdm_object_close(&entry);
    if (o->err->status != TDM_OK)
      return;
    if (strlen(name) >= sizeof c->channel.name || strlen(unit) >= sizeof c->channel.unit) {
      tdm_object_fail(&entry, "name", "a channel's name has at most 63 letters, its unit at most 15");
      return;
    }
    strcpy(c->channel.name, name);
    strcpy(c->channel.unit, unit);
    c->at = add(&m->outputs, v, o->err);
    m->nchannel++;
  }
}

tdm_status fmu_mapping_read(fmu_mapping *m, tdm_fmu *fmu, const tdm_assignment *a, tdm_error *err) {
  const tdm_vec3 zero = {0};
  *m = (fmu_mapping){.fmu = fmu, .accelerates = true};
  tdm_object o = tdm_object_open(a->scene, "mbd", err);
  m->step = tdm_get_number(&o, "step", a->dt, TDM_POSITIVE);
  m->tolerance = tdm_get_number(&o, "tolerance", 0, TDM_NOT_NEGATIVE);
  tdm_get_vec3(&o, "gravity", &zero); /* may come from the scene's root; the FMU has its own */
  read_units(m, &o);
  read_parameters(m, &o);
  read_bodies(m, &o, a);
  if (err->status == TDM_OK)
    read_channels(m, &o);
  tdm_object_close(&o);
  return err->status;
}
