/* modelDescription.xml of an exported FMU.
 *
 * FMI 2.0.4 Section 2.2 and 4.3, FMI 3.0.2 Section 2.4 and 4.4: elements in the schema's order; numbers of variables
 * from 1 (2.0) or value references (3.0) in ModelStructure; every unit that is used is defined; inputs have a start
 * value, outputs that the FMU calculates have none and are initial unknowns; one independent variable.
 */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupler/export/describe.h"

#include "protocol/version.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Powers of the base units of what tandem's solvers speak in. */
static const struct {
  const char *name;
  int kg, m, s, rad;
} units[] = {{"s", 0, 0, 1, 0},       {"m", 0, 1, 0, 0},    {"rad", 0, 0, 0, 1},   {"kg", 1, 0, 0, 0},
             {"1", 0, 0, 0, 0},       {"m/s", 0, 1, -1, 0}, {"m/s2", 0, 1, -2, 0}, {"rad/s", 0, 0, -1, 1},
             {"rad/s2", 0, 0, -2, 1}, {"N", 1, 1, -2, 0},   {"N.m", 1, 2, -2, 0},  {"N m", 1, 2, -2, 0},
             {"J", 1, 2, -2, 0},      {"W", 1, 2, -3, 0},   {"Pa", 1, -1, -2, 0},  {"kg/s", 1, 0, -1, 0},
             {"m2", 0, 2, 0, 0},      {"m3", 0, 3, 0, 0},   {"m3/s", 0, 3, -1, 0}, {"kg/m3", 1, -3, 0, 0},
             {"N/m", 1, 0, -2, 0},    {"1/s", 0, 0, -1, 0}, {"Hz", 0, 0, -1, 0}};
enum { NUNIT = sizeof units / sizeof units[0] };

/* ---- text ---- */

/* An attribute's value: markup and blanks that are no spaces as references. */
static void put_text(FILE *out, const char *text) {
  for (const unsigned char *c = (const unsigned char *)text; *c; c++) {
    const char *reference = *c == '&' ? "&amp;" : *c == '<' ? "&lt;" : *c == '>' ? "&gt;" : *c == '"' ? "&quot;" : NULL;
    if (reference)
      fputs(reference, out);
    else
      fputc(*c < ' ' || *c == 127 ? ' ' : *c, out);
  }
}

static void put_attribute(FILE *out, const char *name, const char *text) {
  fprintf(out, " %s=\"", name);
  put_text(out, text);
  fputc('"', out);
}

static void put_number(FILE *out, const char *name, double value) {
  fprintf(out, " %s=\"%.17g\"", name, value);
}

static void put_flag(FILE *out, const char *name, bool value) {
  fprintf(out, " %s=\"%s\"", name, value ? "true" : "false");
}

/* ---- elements ---- */

static void put_root(FILE *out, const cpl_description *d) {
  fprintf(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiModelDescription fmiVersion=\"%d.0\"", d->version);
  put_attribute(out, "modelName", d->name);
  if (d->token)
    put_attribute(out, d->version == 2 ? "guid" : "instantiationToken", d->token);
  if (d->title[0])
    put_attribute(out, "description", d->title);
  fputs(" license=\"GPL-3.0-or-later\" generationTool=\"tandem " TDM_VERSION "\" variableNamingConvention=\"flat\">\n",
        out);
}

static void put_co_simulation(FILE *out, const cpl_description *d) {
  const bool two = d->version == 2;
  fputs("  <CoSimulation", out);
  put_attribute(out, "modelIdentifier", d->identifier);
  put_flag(out, "needsExecutionTool", d->needs_tool);
  put_flag(out, "canHandleVariableCommunicationStepSize", true);
  put_flag(out, "canBeInstantiatedOnlyOncePerProcess", false);
  put_flag(out, two ? "canGetAndSetFMUstate" : "canGetAndSetFMUState", d->restores);
  put_flag(out, two ? "canSerializeFMUstate" : "canSerializeFMUState", false);
  put_flag(out, two ? "providesDirectionalDerivative" : "providesDirectionalDerivatives", d->derives);
  if (two)
    put_flag(out, "canNotUseMemoryManagementFunctions", true);
  else if (d->dt > 0)
    put_number(out, "fixedInternalStepSize", d->dt);
  fputs("/>\n", out);
}

static void put_unit(FILE *out, const char *name) {
  int k = 0;
  while (k < NUNIT && strcmp(units[k].name, name) != 0)
    k++;
  fputs("    <Unit", out);
  put_attribute(out, "name", name);
  if (k == NUNIT) { /* a solver's own; its base is not known */
    fputs("/>\n", out);
    return;
  }
  const struct {
    const char *name;
    int power;
  } base[] = {{"kg", units[k].kg}, {"m", units[k].m}, {"s", units[k].s}, {"rad", units[k].rad}};
  fputs("><BaseUnit", out);
  for (int b = 0; b < 4; b++)
    if (base[b].power != 0)
      fprintf(out, " %s=\"%d\"", base[b].name, base[b].power);
  fputs("/></Unit>\n", out);
}

/* Whether an earlier variable, or time, has the same unit. */
static bool is_seen(const cpl_description *d, int i) {
  bool seen = strcmp(d->variable[i].unit, "s") == 0;
  for (int k = 0; k < i && !seen; k++)
    seen = strcmp(d->variable[k].unit, d->variable[i].unit) == 0;
  return seen;
}

/* Each unit once; time's is always there. */
static void put_units(FILE *out, const cpl_description *d) {
  fputs("  <UnitDefinitions>\n", out);
  put_unit(out, "s");
  for (int i = 0; i < d->nvariable; i++)
    if (d->variable[i].unit[0] && !is_seen(d, i))
      put_unit(out, d->variable[i].unit);
  fputs("  </UnitDefinitions>\n", out);
}

static void put_logs(FILE *out, int version) {
  fputs("  <LogCategories>\n", out);
  for (const char *const *c = (const char *const[]){"logStatusWarning", "logStatusDiscard", "logStatusError",
                                                    "logStatusFatal", version == 2 ? "logAll" : "logEvents", NULL};
       *c; c++)
    fprintf(out, "    <Category name=\"%s\"/>\n", *c);
  fputs("  </LogCategories>\n", out);
}

/* A variable of type real: its number i from 0, the independent one being -1. */
static void put_variable(FILE *out, const cpl_description *d, int i) {
  static const cpl_export_variable time = {.name = "time", .unit = "s", .description = "time", .derivative_of = -1};
  const cpl_export_variable *v = i < 0 ? &time : &d->variable[i];
  const bool two = d->version == 2;
  fprintf(out, two ? "    <ScalarVariable" : "    <Float64");
  put_attribute(out, "name", v->name);
  fprintf(out, " valueReference=\"%d\" causality=\"%s\" variability=\"continuous\"", i + 1,
          i < 0      ? "independent"
          : v->input ? "input"
                     : "output");
  if (i >= 0 && !v->input)
    fputs(" initial=\"calculated\"", out);
  put_attribute(out, "description", v->description);
  if (two)
    fputs("><Real", out);
  if (v->unit[0])
    put_attribute(out, "unit", v->unit);
  if (v->input)
    put_number(out, "start", v->start);
  if (v->derivative_of >= 0)
    fprintf(out, " derivative=\"%d\"", v->derivative_of + (two ? 2 : 1));
  fputs(two ? "/></ScalarVariable>\n" : "/>\n", out);
}

static void put_variables(FILE *out, const cpl_description *d) {
  fputs("  <ModelVariables>\n", out);
  for (int i = -1; i < d->nvariable; i++)
    put_variable(out, d, i);
  if (d->has_flag)
    fprintf(out,
            d->version == 2
                ? "    <ScalarVariable name=\"inputs_at_end\" valueReference=\"%d\" causality=\"parameter\" "
                  "variability=\"fixed\" initial=\"exact\" description=\"inputs are the motion at the end of the step, "
                  "not at its start\"><Boolean start=\"false\"/></ScalarVariable>\n"
                : "    <Boolean name=\"inputs_at_end\" valueReference=\"%d\" causality=\"parameter\" "
                  "variability=\"fixed\" initial=\"exact\" description=\"inputs are the motion at the end of the step, "
                  "not at its start\" start=\"false\"/>\n",
            d->nvariable + 1);
  fputs("  </ModelVariables>\n", out);
}

/* An output in ModelStructure; `initial`: among the initial unknowns, where nothing is said of what it depends on. */
static void put_unknown(FILE *out, const cpl_description *d, int i, bool initial) {
  const bool two = d->version == 2;
  if (two)
    fprintf(out, "      <Unknown index=\"%d\"", i + 2);
  else
    fprintf(out, "    <%s valueReference=\"%d\"", initial ? "InitialUnknown" : "Output", i + 1);
  if (!initial) {
    fputs(" dependencies=\"", out);
    for (int k = 0; k < d->variable[i].follows; k++)
      fprintf(out, "%s%d", k ? " " : "", k + (two ? 2 : 1));
    fputc('"', out);
  }
  fputs("/>\n", out);
}

static void put_structure(FILE *out, const cpl_description *d) {
  static const char *const lists[] = {"Outputs", "InitialUnknowns"};
  fputs("  <ModelStructure>\n", out);
  for (int k = 0; k < 2; k++) {
    if (d->version == 2)
      fprintf(out, "    <%s>\n", lists[k]);
    for (int i = 0; i < d->nvariable; i++)
      if (!d->variable[i].input)
        put_unknown(out, d, i, k == 1);
    if (d->version == 2)
      fprintf(out, "    </%s>\n", lists[k]);
  }
  fputs("  </ModelStructure>\n</fmiModelDescription>\n", out);
}

char *cpl_describe(const cpl_description *d) {
  char *text = NULL;
  size_t size = 0;
  FILE *out = open_memstream(&text, &size);
  if (!out)
    return NULL;
  put_root(out, d);
  put_co_simulation(out, d);
  put_units(out, d);
  put_logs(out, d->version);
  fprintf(out, "  <DefaultExperiment startTime=\"0\" stopTime=\"%.17g\" stepSize=\"%.17g\"/>\n", d->end, d->window);
  put_variables(out, d);
  put_structure(out, d);
  if (fclose(out) == 0)
    return text;
  free(text);
  return NULL;
}
