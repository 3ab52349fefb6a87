/* The rules for a modelDescription.xml: see rules.h. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rules.h"

#include <expat.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ELEMENTS_MAX = 4096, ATTRIBUTES_MAX = 16 };

typedef struct {
  char name[32];
  int parent; /* -1: the root */
  int nattribute;
  char *attribute[ATTRIBUTES_MAX][2];
} element;

typedef struct {
  element e[ELEMENTS_MAX];
  int n, open, version;
  char *out;
  size_t size;
} document;

static void broken(document *d, const char *format, ...) {
  va_list args;
  if (d->out[0])
    return;
  va_start(args, format);
  vsnprintf(d->out, d->size, format, args);
  va_end(args);
}

/* ---- the document ---- */

static void XMLCALL begin(void *self, const char *name, const char **attributes) {
  document *d = self;
  if (d->n == ELEMENTS_MAX) {
    broken(d, "the test has no room for so many elements");
    return;
  }
  element *e = &d->e[d->n];
  *e = (element){.parent = d->open};
  snprintf(e->name, sizeof e->name, "%s", name);
  for (; *attributes && e->nattribute < ATTRIBUTES_MAX; attributes += 2, e->nattribute++)
    for (int k = 0; k < 2; k++)
      e->attribute[e->nattribute][k] = strdup(attributes[k]);
  d->open = d->n++;
}

static void XMLCALL end(void *self, const char *name) {
  document *d = self;
  (void)name;
  d->open = d->e[d->open].parent;
}

static const char *get(const element *e, const char *name) {
  for (int k = 0; k < e->nattribute; k++)
    if (strcmp(e->attribute[k][0], name) == 0)
      return e->attribute[k][1];
  return NULL;
}

static bool is(const element *e, const char *name, const char *value) {
  const char *text = get(e, name);
  return text && strcmp(text, value) == 0;
}

/* ---- the schema ---- */

static const char variable3[] = " name valueReference description causality variability initial "
                                "canHandleMultipleSetPerTimeInstant intermediateUpdate previous clocks declaredType ";

/* Elements in the order that their parent has them in, with the attributes that they may have. */
static const struct {
  int version; /* 0: both */
  const char *parent, *name, *attributes, *due;
} schema[] = {
    {2, "", "fmiModelDescription",
     " fmiVersion modelName guid description author version copyright license generationTool generationDateAndTime "
     "variableNamingConvention numberOfEventIndicators ",
     "fmiVersion modelName guid"},
    {3, "", "fmiModelDescription",
     " fmiVersion modelName instantiationToken description author version copyright license generationTool "
     "generationDateAndTime variableNamingConvention ",
     "fmiVersion modelName instantiationToken"},
    {2, "fmiModelDescription", "CoSimulation",
     " modelIdentifier needsExecutionTool canHandleVariableCommunicationStepSize canInterpolateInputs "
     "maxOutputDerivativeOrder canRunAsynchronuously canBeInstantiatedOnlyOncePerProcess "
     "canNotUseMemoryManagementFunctions canGetAndSetFMUstate canSerializeFMUstate providesDirectionalDerivative ",
     "modelIdentifier"},
    {3, "fmiModelDescription", "CoSimulation",
     " modelIdentifier needsExecutionTool canBeInstantiatedOnlyOncePerProcess canGetAndSetFMUState "
     "canSerializeFMUState providesDirectionalDerivatives providesAdjointDerivatives providesPerElementDependencies "
     "canHandleVariableCommunicationStepSize fixedInternalStepSize maxOutputDerivativeOrder "
     "recommendedIntermediateInputSmoothness providesIntermediateUpdate mightReturnEarlyFromDoStep "
     "canReturnEarlyAfterIntermediateUpdate hasEventMode providesEvaluateDiscreteStates ",
     "modelIdentifier"},
    {0, "fmiModelDescription", "UnitDefinitions", " ", ""},
    {0, "UnitDefinitions", "Unit", " name ", "name"},
    {0, "Unit", "BaseUnit", " kg m s A K mol cd rad factor offset ", ""},
    {0, "fmiModelDescription", "LogCategories", " ", ""},
    {0, "LogCategories", "Category", " name description ", "name"},
    {0, "fmiModelDescription", "DefaultExperiment", " startTime stopTime tolerance stepSize ", ""},
    {0, "fmiModelDescription", "ModelVariables", " ", ""},
    {2, "ModelVariables", "ScalarVariable",
     " name valueReference description causality variability initial canHandleMultipleSetPerTimeInstant ",
     "name valueReference"},
    {2, "ScalarVariable", "Real",
     " declaredType quantity unit displayUnit relativeQuantity min max nominal unbounded start derivative reinit ", ""},
    {2, "ScalarVariable", "Boolean", " declaredType start ", ""},
    {3, "ModelVariables", "Float64",
     " quantity unit displayUnit relativeQuantity unbounded min max nominal start derivative reinit ",
     "name valueReference"},
    {3, "ModelVariables", "Boolean", " start ", "name valueReference"},
    {0, "fmiModelDescription", "ModelStructure", " ", ""},
    {2, "ModelStructure", "Outputs", " ", ""},
    {2, "ModelStructure", "InitialUnknowns", " ", ""},
    {2, "Outputs", "Unknown", " index dependencies dependenciesKind ", "index"},
    {2, "InitialUnknowns", "Unknown", " index dependencies dependenciesKind ", "index"},
    {3, "ModelStructure", "Output", " valueReference dependencies dependenciesKind ", "valueReference"},
    {3, "ModelStructure", "InitialUnknown", " valueReference dependencies dependenciesKind ", "valueReference"}};
enum { NSCHEMA = sizeof schema / sizeof schema[0] };

static const char *parent_of(const document *d, const element *e) {
  return e->parent < 0 ? "" : d->e[e->parent].name;
}

static int row_of(const document *d, const element *e) {
  for (int k = 0; k < NSCHEMA; k++)
    if ((schema[k].version == 0 || schema[k].version == d->version) && strcmp(schema[k].name, e->name) == 0 &&
        strcmp(schema[k].parent, parent_of(d, e)) == 0)
      return k;
  return -1;
}

static void check_schema(document *d) {
  for (int i = 0; i < d->n; i++) {
    const element *e = &d->e[i];
    const int row = row_of(d, e);
    if (row < 0) {
      broken(d, "<%s> has no place in <%s>", e->name, parent_of(d, e));
      return;
    }
    for (int k = i - 1; k > e->parent; k--) /* the sibling before */
      if (d->e[k].parent == e->parent) {
        if (row_of(d, &d->e[k]) > row)
          broken(d, "<%s> comes before <%s>", e->name, d->e[k].name);
        break;
      }
    for (int k = 0; k < e->nattribute; k++) {
      char word[64];
      snprintf(word, sizeof word, " %s ", e->attribute[k][0]);
      if (!strstr(schema[row].attributes, word) &&
          !(d->version == 3 && strcmp(parent_of(d, e), "ModelVariables") == 0 && strstr(variable3, word)))
        broken(d, "<%s> may not have the attribute%s", e->name, word);
    }
    char due[128], *rest = NULL;
    snprintf(due, sizeof due, "%s", schema[row].due);
    for (char *word = strtok_r(due, " ", &rest); word; word = strtok_r(NULL, " ", &rest))
      if (!get(e, word) || !*get(e, word))
        broken(d, "<%s> needs the attribute %s", e->name, word);
  }
}

/* ---- variables ---- */

/* The element that has a variable's type, start and unit; NULL: this is no variable. */
static const element *typed(const document *d, int i) {
  const element *e = &d->e[i];
  if (strcmp(parent_of(d, e), "ModelVariables") != 0)
    return NULL;
  return d->version == 3 ? e : i + 1 < d->n && d->e[i + 1].parent == i ? &d->e[i + 1] : NULL;
}

/* The element of the variable that ModelStructure, or `derivative`, means by this number; -1: none. */
static int meant(const document *d, const char *number) {
  int count = 0;
  for (int i = 0; i < d->n; i++)
    if (typed(d, i)) {
      count++;
      if (d->version == 3 ? is(&d->e[i], "valueReference", number) : count == atoi(number))
        return i;
    }
  return -1;
}

static void check_unit(document *d, const element *e, const element *type) {
  const char *unit = get(type, "unit");
  bool found = !unit;
  for (int k = 0; k < d->n && !found; k++)
    found = strcmp(d->e[k].name, "Unit") == 0 && is(&d->e[k], "name", unit);
  if (!found)
    broken(d, "the unit \"%s\" of \"%s\" is not defined", unit, get(e, "name"));
}

static void check_kind(document *d, const element *e, const element *type) {
  const char *name = get(e, "name"), *initial = get(e, "initial");
  const bool start = get(type, "start") != NULL;
  if (is(e, "causality", "input")) {
    if (initial || !start || !is(e, "variability", "continuous"))
      broken(d, "the input \"%s\" must be continuous, have a start and no initial", name);
  } else if (is(e, "causality", "output")) {
    const bool calculated = !initial || is(e, "initial", "calculated");
    if (start == calculated || !is(e, "variability", "continuous"))
      broken(d, "the output \"%s\" must be continuous, with a start only if that is exact or approx", name);
  } else if (is(e, "causality", "parameter")) {
    if (!start || !(is(e, "variability", "fixed") || is(e, "variability", "tunable")) ||
        (initial && !is(e, "initial", "exact")))
      broken(d, "the parameter \"%s\" must be fixed or tunable, exact, with a start", name);
  } else if (is(e, "causality", "independent")) {
    if (start || initial || !is(e, "variability", "continuous"))
      broken(d, "\"%s\" is independent: continuous, without start and initial", name);
  } else
    broken(d, "\"%s\" has no causality that is looked at here", name);
}

static void check_variables(document *d) {
  int independent = 0;
  for (int i = 0; i < d->n; i++) {
    const element *e = &d->e[i], *type = typed(d, i);
    if (strcmp(parent_of(d, e), "ModelVariables") == 0 && !type)
      broken(d, "\"%s\" has no type", get(e, "name"));
    if (!type)
      continue;
    independent += is(e, "causality", "independent");
    check_kind(d, e, type);
    check_unit(d, e, type);
    if (get(type, "derivative") && meant(d, get(type, "derivative")) < 0)
      broken(d, "\"%s\" is the derivative of no variable", get(e, "name"));
    for (int k = 0; k < i; k++)
      if (typed(d, k) &&
          (is(&d->e[k], "name", get(e, "name")) || is(&d->e[k], "valueReference", get(e, "valueReference"))))
        broken(d, "\"%s\" and \"%s\" have one name or value reference", get(&d->e[k], "name"), get(e, "name"));
  }
  if (independent > 1 || (d->version == 3 && independent != 1))
    broken(d, "there are %d independent variables", independent);
}

/* ---- structure ---- */

static void check_dependencies(document *d, const element *e) {
  char text[4096], *rest = NULL;
  const char *list = get(e, "dependencies");
  snprintf(text, sizeof text, "%s", list ? list : "");
  for (char *word = strtok_r(text, " ", &rest); word; word = strtok_r(NULL, " ", &rest)) {
    const int of = meant(d, word);
    if (of < 0 || !is(&d->e[of], "causality", "input"))
      broken(d, "an unknown depends on %s, which is no input", word);
  }
}

/* A list of unknowns has each output once, in their order. */
static void check_list(document *d, bool initial) {
  const char *parent = d->version == 3 ? "ModelStructure" : initial ? "InitialUnknowns" : "Outputs";
  const char *name = d->version == 2 ? "Unknown" : initial ? "InitialUnknown" : "Output";
  int last = -1, listed = 0, outputs = 0;
  for (int i = 0; i < d->n; i++) {
    const element *e = &d->e[i];
    outputs += typed(d, i) && is(e, "causality", "output") && (!initial || !get(typed(d, i), "start"));
    if (strcmp(e->name, name) != 0 || strcmp(parent_of(d, e), parent) != 0)
      continue;
    const int of = meant(d, get(e, d->version == 2 ? "index" : "valueReference"));
    if (of < 0 || !is(&d->e[of], "causality", "output"))
      broken(d, "an entry of ModelStructure is no output");
    if (of <= last)
      broken(d, "the entries of ModelStructure do not ascend");
    last = of;
    listed++;
    check_dependencies(d, e);
  }
  if (listed != outputs)
    broken(d, "%d of %d outputs are in ModelStructure as %s", listed, outputs,
           initial ? "initial unknowns" : "outputs");
}

static void check_rest(document *d) {
  static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_0123456789";
  const char *due[] = {"CoSimulation", "ModelVariables", "ModelStructure"};
  for (size_t k = 0; k < sizeof due / sizeof due[0]; k++) {
    int count = 0;
    for (int i = 0; i < d->n; i++)
      count += strcmp(d->e[i].name, due[k]) == 0;
    if (count != 1)
      broken(d, "there are %d <%s>", count, due[k]);
  }
  for (int i = 0; i < d->n; i++) {
    const element *e = &d->e[i];
    const char *identifier = strcmp(e->name, "CoSimulation") == 0 ? get(e, "modelIdentifier") : NULL;
    if (identifier && (identifier[strspn(identifier, letters)] || (*identifier >= '0' && *identifier <= '9')))
      broken(d, "the modelIdentifier \"%s\" is no C identifier", identifier);
    if (strcmp(e->name, "DefaultExperiment") == 0 &&
        !(atof(get(e, "stopTime")) > atof(get(e, "startTime")) && atof(get(e, "stepSize")) > 0))
      broken(d, "the default experiment ends before it begins, or has no step");
  }
}

const char *fmu_rules_broken(const char *xml, char *out, size_t size) {
  document *d = calloc(1, sizeof *d);
  XML_Parser parser = XML_ParserCreate(NULL);
  *d = (document){.open = -1, .out = out, .size = size};
  out[0] = 0;
  XML_SetUserData(parser, d);
  XML_SetElementHandler(parser, begin, end);
  if (XML_Parse(parser, xml, (int)strlen(xml), 1) != XML_STATUS_OK)
    broken(d, "line %lu: %s", XML_GetCurrentLineNumber(parser), XML_ErrorString(XML_GetErrorCode(parser)));
  XML_ParserFree(parser);
  const char *version = d->n > 0 ? get(&d->e[0], "fmiVersion") : NULL;
  d->version = version ? atoi(version) : 0;
  if (d->version != 2 && d->version != 3)
    broken(d, "it has no fmiVersion 2.0 or 3.0");
  check_schema(d);
  if (!out[0]) {
    check_variables(d);
    check_list(d, false);
    check_list(d, true);
    check_rest(d);
  }
  for (int i = 0; i < d->n; i++)
    for (int k = 0; k < d->e[i].nattribute; k++)
      for (int j = 0; j < 2; j++)
        free(d->e[i].attribute[k][j]);
  free(d);
  return out;
}
