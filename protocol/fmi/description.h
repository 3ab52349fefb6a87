/* modelDescription.xml: what an FMU says of itself, FMI 2.0 and 3.0. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef TDM_FMI_DESCRIPTION_H
#define TDM_FMI_DESCRIPTION_H

#include "protocol/base/status.h"

#include <stdbool.h>
#include <stdint.h>

typedef enum {
  TDM_FMI_REAL,        /* Real, Float64 */
  TDM_FMI_INTEGER,     /* Integer, Int32 */
  TDM_FMI_BOOLEAN,     /* Boolean */
  TDM_FMI_STRING,      /* String */
  TDM_FMI_ENUMERATION, /* Enumeration */
  TDM_FMI_OTHER        /* Float32, Int8, Binary, Clock ... : only told of */
} tdm_fmi_type;

typedef enum {
  TDM_FMI_LOCAL,
  TDM_FMI_INPUT,
  TDM_FMI_OUTPUT,
  TDM_FMI_PARAMETER,
  TDM_FMI_CALCULATED_PARAMETER,
  TDM_FMI_INDEPENDENT,
  TDM_FMI_STRUCTURAL_PARAMETER
} tdm_fmi_causality;

/* The standard's own words for causalities ("calculatedParameter"). */
extern const char *const tdm_fmi_causality_names[];

/* A variable. */
typedef struct {
  char *name;                  /* "body.x" */
  char *type_name;             /* as the standard has it: "Float64" */
  char *unit;                  /* NULL: none */
  uint32_t reference;          /* the standard's value reference */
  tdm_fmi_type type;           /* what can be set or got */
  tdm_fmi_causality causality; /* who sets it */
  bool constant;               /* of variability "constant" */
  long size;                   /* elements of an array; 1: a scalar; 0: known only to the FMU */
  long derivative_of;          /* FMI 2: number of a variable from 1; FMI 3: value reference; -1: of none */
} tdm_fmi_variable;

/* A description. Zero-initialise; free with tdm_description_free. */
typedef struct {
  int version;                /* 2 or 3 */
  char *model_name;           /* for messages */
  char *token;                /* guid, or instantiationToken */
  char *tool;                 /* that made it; NULL: does not say */
  char *identifier;           /* of the co-simulation: name of the binary; NULL: none */
  bool keeps_states;          /* canGetAndSetFMUstate */
  bool gives_derivatives;     /* providesDirectionalDerivative(s) */
  bool varies_step;           /* canHandleVariableCommunicationStepSize */
  bool once_per_process;      /* canBeInstantiatedOnlyOncePerProcess */
  bool needs_tool;            /* needsExecutionTool */
  int nvariable, room;        /* variables, and how many there is room for */
  tdm_fmi_variable *variable; /* (nvariable) */
} tdm_fmi_description;

/* Read a modelDescription.xml; `fmu` is named in errors. The caller frees also after an error. */
tdm_status tdm_description_read(tdm_fmi_description *d, const char *file, const char *fmu, tdm_error *err);

void tdm_description_free(tdm_fmi_description *d);

/* The variable of that name, NULL: none. */
const tdm_fmi_variable *tdm_description_find(const tdm_fmi_description *d, const char *name);

/* The variable that is the derivative of another, NULL: none is said to be. */
const tdm_fmi_variable *tdm_description_derivative(const tdm_fmi_description *d, const tdm_fmi_variable *of);

#endif
