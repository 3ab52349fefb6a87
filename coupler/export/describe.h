/* modelDescription.xml of an exported FMU, FMI 2.0 and 3.0: see describe.c for the rules that it keeps. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef CPL_EXPORT_DESCRIBE_H
#define CPL_EXPORT_DESCRIBE_H

#include "coupler/export/serve/variables.h"

typedef struct {
  int version;            /* 2 or 3 */
  const char *identifier; /* a C identifier: the binary's name */
  const char *name;       /* of the model */
  const char *title;      /* in words, "": none */
  const char *token;      /* guid or instantiationToken; NULL: left out, for its fingerprint */
  bool needs_tool;        /* a solver that is not packed */
  bool restores, derives; /* capabilities */
  bool has_flag;          /* the parameter inputs_at_end */
  double end, window;     /* of the default experiment [s] */
  double dt;              /* the DEM step; 0: steps of any length [s] */
  const cpl_export_variable *variable;
  int nvariable;
} cpl_description;

/* The text, which the caller frees; NULL: no memory. */
char *cpl_describe(const cpl_description *description);

#endif
