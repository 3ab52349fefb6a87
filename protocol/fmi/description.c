/* modelDescription.xml, by expat: see description.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "protocol/fmi/description.h"

#include <expat.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *const tdm_fmi_causality_names[] = {
    "local", "input", "output", "parameter", "calculatedParameter", "independent", "structuralParameter"};
enum { NCAUSALITY = sizeof tdm_fmi_causality_names / sizeof tdm_fmi_causality_names[0] };

/* elements of both versions that are, or tell, a variable's type */
static const struct {
  const char *name;
  tdm_fmi_type type;
  int version;
} types[] = {{"Real", TDM_FMI_REAL, 2},
             {"Integer", TDM_FMI_INTEGER, 2},
             {"Boolean", TDM_FMI_BOOLEAN, 2},
             {"String", TDM_FMI_STRING, 2},
             {"Enumeration", TDM_FMI_ENUMERATION, 2},
             {"Float64", TDM_FMI_REAL, 3},
             {"Int32", TDM_FMI_INTEGER, 3},
             {"Boolean", TDM_FMI_BOOLEAN, 3},
             {"String", TDM_FMI_STRING, 3},
             {"Enumeration", TDM_FMI_ENUMERATION, 3},
             {"Float32", TDM_FMI_OTHER, 3},
             {"Int8", TDM_FMI_OTHER, 3},
             {"UInt8", TDM_FMI_OTHER, 3},
             {"Int16", TDM_FMI_OTHER, 3},
             {"UInt16", TDM_FMI_OTHER, 3},
             {"UInt32", TDM_FMI_OTHER, 3},
             {"Int64", TDM_FMI_OTHER, 3},
             {"UInt64", TDM_FMI_OTHER, 3},
             {"Binary", TDM_FMI_OTHER, 3},
             {"Clock", TDM_FMI_OTHER, 3}};
enum { NTYPE = sizeof types / sizeof types[0] };

typedef struct {
  tdm_fmi_description *d;
  XML_Parser parser;
  bool in_variables, no_memory;
  char fault[256]; /* "": none */
} reader;

/* ---- attributes ---- */

static const char *attribute(const char **attributes, const char *name) {
  for (; *attributes; attributes += 2)
    if (strcmp(attributes[0], name) == 0)
      return attributes[1];
  return NULL;
}

static bool is_true(const char **attributes, const char *name) {
  const char *text = attribute(attributes, name);
  return text && (strcmp(text, "true") == 0 || strcmp(text, "1") == 0);
}

static void copy(reader *r, char **to, const char *text) {
  if (!text || *to)
    return;
  *to = strdup(text);
  r->no_memory = r->no_memory || !*to;
}

static void fault(reader *r, const char *format, const char *name) {
  if (!r->fault[0])
    snprintf(r->fault, sizeof r->fault, format, name);
}

/* ---- elements ---- */

static void read_root(reader *r, const char **a) {
  tdm_fmi_description *d = r->d;
  const char *version = attribute(a, "fmiVersion");
  d->version = !version ? 0 : strncmp(version, "2.", 2) == 0 ? 2 : strncmp(version, "3.", 2) == 0 ? 3 : 0;
  if (d->version == 0)
    fault(r, "its fmiVersion is %s; tandem-fmu takes 2.0 and 3.0", version ? version : "missing");
  copy(r, &d->model_name, attribute(a, "modelName"));
  copy(r, &d->tool, attribute(a, "generationTool"));
  copy(r, &d->token, attribute(a, d->version == 3 ? "instantiationToken" : "guid"));
  if (!d->token)
    fault(r, "it has no %s", d->version == 3 ? "instantiationToken" : "guid");
}

static void read_co_simulation(reader *r, const char **a) {
  tdm_fmi_description *d = r->d;
  copy(r, &d->identifier, attribute(a, "modelIdentifier"));
  d->keeps_states = is_true(a, d->version == 3 ? "canGetAndSetFMUState" : "canGetAndSetFMUstate");
  d->gives_derivatives =
      is_true(a, d->version == 3 ? "providesDirectionalDerivatives" : "providesDirectionalDerivative");
  d->varies_step = is_true(a, "canHandleVariableCommunicationStepSize");
  d->once_per_process = is_true(a, "canBeInstantiatedOnlyOncePerProcess");
  d->needs_tool = is_true(a, "needsExecutionTool");
}

static tdm_fmi_variable *add_variable(reader *r, const char **a) {
  tdm_fmi_description *d = r->d;
  if (d->nvariable == d->room) {
    const int room = 2 * d->room + 64;
    tdm_fmi_variable *grown = realloc(d->variable, (size_t)room * sizeof *grown);
    if (!grown) {
      r->no_memory = true;
      return NULL;
    }
    d->variable = grown;
    d->room = room;
  }
  const char *name = attribute(a, "name"), *reference = attribute(a, "valueReference");
  const char *causality = attribute(a, "causality"), *variability = attribute(a, "variability");
  char *end = NULL;
  tdm_fmi_variable *v = &d->variable[d->nvariable++];
  *v = (tdm_fmi_variable){.type = TDM_FMI_OTHER, .size = 1, .derivative_of = -1};
  copy(r, &v->name, name ? name : "");
  v->reference = reference ? (uint32_t)strtoul(reference, &end, 10) : 0;
  if (!name || !reference || end == reference || *end)
    fault(r, "variable \"%s\" has no name or no valueReference", name ? name : "");
  v->constant = variability && strcmp(variability, "constant") == 0;
  int k = 0;
  while (causality && k < NCAUSALITY && strcmp(causality, tdm_fmi_causality_names[k]) != 0)
    k++;
  if (k == NCAUSALITY)
    fault(r, "variable \"%s\" has a causality that the standard does not know", name ? name : "");
  v->causality = (tdm_fmi_causality)k;
  return v;
}

/* An element that tells a type, of variable v. */
static void read_type(reader *r, tdm_fmi_variable *v, const char *element, const char **a) {
  const char *of = attribute(a, "derivative");
  for (int k = 0; k < NTYPE; k++)
    if (types[k].version == r->d->version && strcmp(element, types[k].name) == 0)
      v->type = types[k].type;
  copy(r, &v->type_name, element);
  copy(r, &v->unit, attribute(a, "unit"));
  if (of)
    v->derivative_of = strtol(of, NULL, 10);
}

static bool is_type(const reader *r, const char *element) {
  for (int k = 0; k < NTYPE; k++)
    if (types[k].version == r->d->version && strcmp(element, types[k].name) == 0)
      return true;
  return false;
}

static void XMLCALL begin(void *self, const char *element, const char **a) {
  reader *r = self;
  tdm_fmi_description *d = r->d;
  if (strcmp(element, "fmiModelDescription") == 0)
    read_root(r, a);
  else if (d->version == 0)
    fault(r, "it begins with <%s>, not with <fmiModelDescription>", element);
  else if (strcmp(element, "CoSimulation") == 0)
    read_co_simulation(r, a);
  else if (strcmp(element, "ModelVariables") == 0)
    r->in_variables = true;
  else if (!r->in_variables)
    return;
  else if (d->version == 2 && strcmp(element, "ScalarVariable") == 0)
    add_variable(r, a);
  else if (d->version == 2 && d->nvariable > 0 && is_type(r, element))
    read_type(r, &d->variable[d->nvariable - 1], element, a);
  else if (d->version == 3 && is_type(r, element)) {
    tdm_fmi_variable *v = add_variable(r, a);
    if (v)
      read_type(r, v, element, a);
  } else if (d->version == 3 && d->nvariable > 0 && strcmp(element, "Dimension") == 0) {
    const char *start = attribute(a, "start"); /* else it is a structural parameter's */
    const long n = start ? strtol(start, NULL, 10) : 0;
    tdm_fmi_variable *v = &d->variable[d->nvariable - 1];
    v->size = n > 0 && n < 1000000 && v->size < 1000000 ? v->size * n : 0;
  }
}

static void XMLCALL end(void *self, const char *element) {
  if (strcmp(element, "ModelVariables") == 0)
    ((reader *)self)->in_variables = false;
}

/* Entities of the document's own can be made to explode; the standard needs none. */
static void XMLCALL refuse_doctype(void *self, const char *name, const char *system, const char *public, int inside) {
  reader *r = self;
  (void)name;
  (void)system;
  (void)public;
  (void)inside;
  fault(r, "it has a document type declaration%s", "");
  XML_StopParser(r->parser, XML_FALSE);
}

/* ---- the file ---- */

/* A C identifier, as the standard has it: it becomes part of a path. */
static bool is_identifier(const char *text) {
  static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_0123456789";
  return *text && !(*text >= '0' && *text <= '9') && text[strspn(text, letters)] == 0;
}

tdm_status tdm_description_read(tdm_fmi_description *d, const char *file, const char *fmu, tdm_error *err) {
  char block[16384];
  FILE *in = fopen(file, "re");
  if (!in)
    return tdm_fail(err, TDM_ERR_FILE, NULL, "%s: has no modelDescription.xml, so it is no FMU", fmu);
  reader r = {.d = d, .parser = XML_ParserCreate(NULL)};
  bool good = r.parser != NULL, last = false;
  if (good) {
    XML_SetUserData(r.parser, &r);
    XML_SetElementHandler(r.parser, begin, end);
    XML_SetStartDoctypeDeclHandler(r.parser, refuse_doctype);
  }
  while (good && !last) {
    const size_t n = fread(block, 1, sizeof block, in);
    last = n < sizeof block;
    good = XML_Parse(r.parser, block, (int)n, last) == XML_STATUS_OK && !r.fault[0];
  }
  if (!r.parser || r.no_memory)
    tdm_fail(err, TDM_ERR_MEMORY, NULL, "out of memory");
  else if (r.fault[0])
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: modelDescription.xml: %s", fmu, r.fault);
  else if (!good)
    tdm_fail(err, TDM_ERR_FILE, NULL, "%s: modelDescription.xml, line %lu: %s", fmu,
             (unsigned long)XML_GetCurrentLineNumber(r.parser), XML_ErrorString(XML_GetErrorCode(r.parser)));
  else if (!d->identifier)
    tdm_fail(err, TDM_ERR_FILE, NULL,
             "%s: is no co-simulation FMU (modelDescription.xml has no CoSimulation with a modelIdentifier); export it "
             "for co-simulation",
             fmu);
  else if (!is_identifier(d->identifier))
    tdm_fail(err, TDM_ERR_FILE, NULL,
             "%s: modelDescription.xml: its modelIdentifier \"%s\" is no C identifier (letters, digits, _); export it "
             "again",
             fmu, d->identifier);
  if (r.parser)
    XML_ParserFree(r.parser);
  fclose(in);
  return err->status;
}

void tdm_description_free(tdm_fmi_description *d) {
  for (int i = 0; i < d->nvariable; i++) {
    free(d->variable[i].name);
    free(d->variable[i].type_name);
    free(d->variable[i].unit);
  }
  free(d->variable);
  free(d->model_name);
  free(d->token);
  free(d->tool);
  free(d->identifier);
  *d = (tdm_fmi_description){0};
}

const tdm_fmi_variable *tdm_description_find(const tdm_fmi_description *d, const char *name) {
  for (int i = 0; i < d->nvariable; i++)
    if (strcmp(d->variable[i].name, name) == 0)
      return &d->variable[i];
  return NULL;
}

const tdm_fmi_variable *tdm_description_derivative(const tdm_fmi_description *d, const tdm_fmi_variable *of) {
  const long key = d->version == 2 ? of - d->variable + 1 : (long)of->reference;
  for (int i = 0; i < d->nvariable; i++)
    if (d->variable[i].derivative_of == key)
      return &d->variable[i];
  return NULL;
}
