/* The section `dem` of a scene whose particles LIGGGHTS computes. */
/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef DEM_FOREIGN_LIGGGHTS_SECTION_H
#define DEM_FOREIGN_LIGGGHTS_SECTION_H

#include "protocol/wire/participant.h"

/* A coupled body: a mesh fix of LIGGGHTS that has its name. */
typedef struct {
  const char *name;
  const char *mesh; /* STL file; NULL: the script places its mesh itself */
  double scale;     /* of the file: metres a unit */
  tdm_vec3 origin;  /* of the file, from the centre of mass, body axes [m] */
  long type;        /* LIGGGHTS' atom type, for the contact laws */
} lig_body;

/* A time history: an equal-style variable of the script. */
typedef struct {
  tdm_channel channel;
  const char *variable;
} lig_channel;

/* What the section says. Strings are borrowed from the scene. */
typedef struct {
  const char *script;
  json_t *variables; /* of the script, by their names; borrowed, may be NULL */
  int nbody;
  lig_body *body; /* (nbody) in the order of ASSIGN */
  int nchannel;
  lig_channel *channel; /* (nchannel) */
  bool has_gravity;
  tdm_vec3 gravity; /* [m/s2] */
  bool may_lose;    /* particles that leave LIGGGHTS' box are no error */
} lig_section;

/* Read the section; lig_section_free also after an error. */
tdm_status lig_section_read(lig_section *section, const tdm_assignment *assignment, tdm_error *err);
void lig_section_free(lig_section *section);

#endif
